"""Charts of other tools in CODESYS and TC6: executed as before, or reported, and the same on the way back."""

from __future__ import annotations

import io
import re
from pathlib import Path
from random import Random
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.conversion import compare, executed, reporting
from plcopen_sfc.conversion.adaptation import rule_tables
from plcopen_sfc.model import (
    Action,
    ActionAssociation,
    ActionEvent,
    Dialect,
    Expression,
    Interface,
    Pou,
    Project,
    Qualifier,
    SfcBody,
    SfcNetwork,
    StBody,
    Variable,
    VariableSection,
)
from plcopen_sfc.model.chart_settings import FlagUse, GraphSettings, SfcFlag, SfcSettings
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.pou import DataBlock, DataBlockKind, PouKind
from plcopen_sfc.model.sfc import Supervised
from plcopen_sfc.model.types import StructType
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import ConversionReport, Outcome

FIXTURES = Path(__file__).parents[2] / "fixtures"
SCANS = 150
PROFILES = {"codesys": "codesys", "plcopen-2.01": "iec", "plcopen-1.01": "iec"}
TARGETS = list(PROFILES)
Row = dict[str, Any]


def block(rows: list[Row], *, dialect: Dialect = Dialect.SCL) -> Project:
    """A function block with three steps in a ring, whose second step has `rows`."""
    own = "#" if dialect is Dialect.SCL else ""
    chart = SfcNetwork()
    rest, work, done = chart.add_step("Rest", initial=True), chart.add_step("Work"), chart.add_step("Done")
    for number, (left, entered, condition) in enumerate(
        ((rest, work, "go"), (work, done, "next"), (done, rest, "next"))
    ):
        chart.add_transition(left, entered, own + condition).name = f"T{number}"
    work.actions = [ActionAssociation(id=50 + number, **row) for number, row in enumerate(rows)]
    inputs = [Variable(name=name, type="BOOL") for name in ("go", "next", "guard")]
    outputs = [Variable(name="q", type="BOOL"), Variable(name="r", type="BOOL"), Variable(name="n", type="INT")]
    sections = [
        VariableSection(kind=SectionKind.INPUT, variables=inputs),
        VariableSection(kind=SectionKind.OUTPUT, variables=outputs),
    ]
    pou = Pou(
        name="FB_Ring",
        kind=PouKind.FUNCTION_BLOCK,
        interface=Interface(sections=sections),
        bodies=[SfcBody(chart=chart)],
    )
    return Project(pous=[pou], dialect=dialect)


def chart_of(project: Project) -> SfcNetwork:
    chart = project.pous[0].sfc
    assert chart is not None
    return chart


def outputs(project: Project, profile: str, seed: int) -> list[tuple[Any, ...]]:
    """The outputs in every scan, with random inputs that rest in the first ones: S7-GRAPH tests no transition then."""
    random = Random(seed)  # noqa: S311  # inputs of a test
    scans = [{name: random.random() < 0.4 for name in ("go", "next", "guard")} for _ in range(SCANS)]
    scans[:2] = [dict.fromkeys(("go", "next", "guard"), False)] * 2

    def inputs(scan: int, _values: object) -> dict[str, bool]:
        return scans[min(scan, SCANS - 1)]

    trace = sfc.simulate(project, pou="FB_Ring", inputs=inputs, scans=SCANS, profile=profile)
    return list(zip(*(list(trace[name]) for name in ("q", "r", "n")), strict=True))


def assert_runs_the_same(source: Project, target: str, *, own: str = "s7graph") -> ConversionReport:
    """The target's tool sets the outputs of the source, in CODESYS a scan later than elsewhere."""
    data, report = sfc.convert(source, target)
    read = sfc.loads(data, as_tool=True)
    delay = int(target == "codesys") - int(own == "codesys")
    for seed in range(3):
        theirs = outputs(read, PROFILES[target], seed)
        ours = outputs(source, own, seed)
        first, second = (ours, theirs) if delay >= 0 else (theirs, ours)
        assert first[: SCANS - abs(delay)] == second[abs(delay) :]
        assert len(set(ours)) > 1, "the outputs never change"
    return report


def assert_comes_back(source: Project, target: str) -> None:
    there, report = sfc.convert(source, target, partial=True)
    assert report.with_outcome(Outcome.DROPPED) == []
    own = "simaticml" if source.dialect is Dialect.SCL else "codesys"
    assert (
        list(
            differences(
                sfc.loads(sfc.dumps(source, format=own, partial=True)),
                sfc.loads(sfc.dumps(sfc.loads(there), format=own, partial=True)),
            )
        )
        == []
    )


S1 = ActionEvent.S1
EXACT: dict[str, list[Row]] = {
    "set when entered": [{"qualifier": Qualifier.S, "target": "#q", "event": S1}],
    "set when entered, reset when left": [
        {"qualifier": Qualifier.S, "target": "#q", "event": S1},
        {"qualifier": Qualifier.R, "target": "#q", "event": ActionEvent.S0},
    ],
    "set, and reset by an event": [
        {"qualifier": Qualifier.S, "target": "#q"},
        {"qualifier": Qualifier.R, "target": "#q", "event": ActionEvent.S0},
    ],
    "assigned FALSE after it was set": [
        {"qualifier": Qualifier.S, "target": "#r", "event": S1},
        {"qualifier": Qualifier.N, "target": "#r", "value": "FALSE"},
        {"qualifier": Qualifier.N, "target": "#q", "value": "TRUE"},
    ],
    "counted in every cycle": [{"qualifier": Qualifier.N, "target": "#n", "value": "#n + 1"}],
    "counted when entered": [{"qualifier": Qualifier.N, "target": "#n", "value": "#n + 1", "event": S1}],
    "counted when left": [{"qualifier": Qualifier.N, "target": "#n", "value": "#n + 1", "event": ActionEvent.S0}],
    "called": [{"qualifier": Qualifier.CALL, "body": StBody(text="#n := #n + 1;")}],
    "called when entered": [{"qualifier": Qualifier.CALL, "body": StBody(text="#n := #n + 2;"), "event": S1}],
}


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("rows", EXACT.values(), ids=EXACT.keys())
def test_events_values_and_calls_run_as_in_the_source(rows: list[Row], target: str) -> None:
    source = block(rows)
    report = assert_runs_the_same(source, target)
    assert report.losses == []
    assert_comes_back(source, target)


LOCKED: dict[str, list[Row]] = {
    "N": [{"qualifier": Qualifier.N, "target": "#q", "interlock": True}],
    "S": [{"qualifier": Qualifier.S, "target": "#q", "interlock": True}],
    "L": [{"qualifier": Qualifier.L, "target": "#q", "interlock": True, "duration": "T#30ms"}],
    "D": [{"qualifier": Qualifier.D, "target": "#q", "interlock": True, "duration": "T#30ms"}],
    "value": [{"qualifier": Qualifier.N, "target": "#n", "value": "#n + 1", "interlock": True}],
    "CALL": [{"qualifier": Qualifier.CALL, "body": StBody(text="#n := #n + 1;"), "interlock": True}],
    "S1": [{"qualifier": Qualifier.S, "target": "#q", "event": S1, "interlock": True}],
}


@pytest.mark.slow
@pytest.mark.parametrize("rows", LOCKED.values(), ids=LOCKED.keys())
def test_nothing_runs_without_its_interlock(rows: list[Row]) -> None:
    source = block(rows)
    chart_of(source).step("Work").interlock = Supervised(condition="#guard")
    report = assert_runs_the_same(source, "plcopen-2.01")
    assert report.losses == []
    assert_comes_back(source, "plcopen-2.01")
    # CODESYS shows a step a scan later and the guard at once: there the guard rests
    data, report = sfc.convert(source, "codesys")
    assert [item.what for item in report.losses] == ["inputs of actions"]
    assert_comes_back(source, "codesys")
    read = sfc.loads(data, as_tool=True)

    def inputs(scan: int, _values: object) -> dict[str, object]:
        return {"go": True, "next": scan % 4 == 3, "guard": False}

    shut = sfc.simulate(read, pou="FB_Ring", inputs=inputs, scans=40, profile="codesys")
    assert set(shut["q"]) == {False}
    assert set(shut["n"]) == {0}

    def released(scan: int, _values: object) -> dict[str, object]:
        return {"go": True, "next": scan % 8 == 7, "guard": True}

    now = sfc.simulate(read, pou="FB_Ring", inputs=released, scans=40, profile="codesys")
    before = sfc.simulate(source, pou="FB_Ring", inputs=released, scans=40, profile="s7graph")
    for name in ("q", "n"):
        assert list(now[name])[2:] == list(before[name])[1:-1] or len(set(now[name])) > 1


UNSAID: dict[str, Row] = {
    "ON": {"qualifier": Qualifier.ON, "target": "Nowhere", "event": S1},
    "CU": {"qualifier": Qualifier.CU, "target": '"Parts"'},
    "TD": {"qualifier": Qualifier.TD, "target": '"Time"', "event": S1},
    "TF": {"qualifier": Qualifier.TF, "target": '"Time"', "interlock": True, "duration": "T#2s"},
}


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("row", UNSAID.values(), ids=UNSAID.keys())
def test_what_cannot_be_said_is_left_out_and_reported(row: Row, target: str) -> None:
    source = block([row])
    data, report = sfc.convert(source, target, partial=True)
    (item,) = report.losses
    assert item.outcome is Outcome.NOT_EXECUTED
    assert item.path.startswith("POU FB_Ring / step Work / action ")
    assert "is not executed in" in item.why
    assert chart_of(sfc.loads(data, as_tool=True)).step("Work").actions == []
    assert_comes_back(source, target)


def test_a_coil_that_two_steps_drive_is_true_if_one_of_them_wants_it() -> None:
    source = block([{"qualifier": Qualifier.N, "target": "#q", "interlock": True}])
    chart = chart_of(source)
    chart.step("Work").interlock = Supervised(condition="#guard")
    chart.step("Done").actions = [ActionAssociation(id=60, qualifier=Qualifier.N, target="#q")]
    assert_runs_the_same(source, "plcopen-2.01")
    assert_comes_back(source, "codesys")


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_a_supervision_holds_its_step(target: str) -> None:
    source = block([{"qualifier": Qualifier.N, "target": "#q"}])
    chart = chart_of(source)
    chart.step("Work").supervision = Supervised(condition="#guard")
    for acknowledge in (False, True):
        chart.graph_settings = GraphSettings(acknowledge_errors_required=acknowledge)
        report = assert_runs_the_same(source, target)
        assert report.losses == []
        assert_comes_back(source, target)


def test_an_edit_of_the_statements_wins_over_the_row_that_they_stand_for() -> None:
    data, _ = sfc.convert(block([{"qualifier": Qualifier.N, "target": "#n", "value": "#n + 1"}]), "codesys")
    assert chart_of(sfc.loads(data)).step("Work").actions[0].value == "n + 1"
    edited = data.replace(b"n := n + 1;", b"n := n + 5;")
    assert edited != data
    project = sfc.loads(edited)
    (row,) = chart_of(project).step("Work").actions
    assert row.value is None
    assert row.target is not None
    action = project.pous[0].action(row.target)
    assert action is not None
    assert isinstance(action.body, StBody)
    assert "n := n + 5;" in action.body.text


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(
    ("before", "after"), [(b"n := n + 10;", b"n := n + 11;"), (b'name="Work"', b'name="Busy"')], ids=["action", "step"]
)
def test_an_edit_of_one_action_keeps_the_others_of_its_step(before: bytes, after: bytes, target: str) -> None:
    """Whatever of a rewritten step is edited natively, the tool executes the rest, and so does what is read."""
    rows: list[Row] = [
        {"qualifier": Qualifier.N, "target": "#n", "value": "#n + 10", "event": S1},
        {"qualifier": Qualifier.R, "target": "#q", "event": ActionEvent.S0},
    ]
    data, _ = sfc.convert(block(rows), target)
    edited = data.replace(before, after)
    assert edited != data
    for as_tool in (False, True):
        project = sfc.loads(edited, as_tool=as_tool)
        texts = [action.body.text for action in project.pous[0].actions if isinstance(action.body, StBody)]
        shown = "".join(texts) + chart_of(project).model_dump_json()
        assert ("q := FALSE" in shown) or (not as_tool and '"event":"S0"' in shown)
    assert sfc.dumps(sfc.loads(edited)) == edited


def test_an_edited_file_is_written_with_its_statements_again() -> None:
    data, _ = sfc.convert(block([{"qualifier": Qualifier.S, "target": "#q", "event": S1}]), "codesys")
    project = sfc.loads(data)
    chart_of(project).step("Done").comment = "ready"
    (row,) = chart_of(project).step("Work").actions
    assert row.event is S1
    again = sfc.loads(sfc.dumps(project), as_tool=True)
    assert chart_of(again).step("Work").actions == []
    assert chart_of(again).step("Work").entry_action == "Work_entry"


def test_conditions_are_expressions_in_codesys() -> None:
    source = sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml")
    data, report = sfc.convert(source, "codesys", partial=True)
    pou = sfc.loads(data, as_tool=True).pou("FillingStation")
    chart = pou.sfc
    assert chart is not None
    texts = {t.condition.text for t in chart.transitions if isinstance(t.condition, Expression)}
    assert {"B1_BottleInPlace AND NOT S3_Door", "NOT B2_Clamped"} <= texts
    assert "DripTimer_Q_before" in texts, "it waits for a timer that is drawn in the chart"
    assert all(not t.condition.negated for t in chart.transitions if t.condition is not None)
    assert [item for item in report.items if item.outcome is Outcome.NOT_EXECUTED and item.what == "condition"] == []
    assert chart.logic == []
    called = next(action.body for action in pou.actions if action.name == "Z_timers_and_edges")
    assert isinstance(called, StBody)
    assert "DripTimer_Q_before := DripTimer.Q;\nDripTimer(IN := " in called.text


@pytest.mark.parametrize("file", ["simaticml/FB_Drill.xml", "simaticml-plc"])
def test_networks_of_tia_portal_are_expressions_in_codesys(file: str) -> None:
    data = sfc.dumps(sfc.load(FIXTURES / file), format="codesys", partial=True)
    for chart in sfc.loads(data, as_tool=True).charts():
        assert all(isinstance(transition.condition, Expression) for transition in chart.chart.transitions)
    assert b"TrCoil</attribute>" not in data


def test_the_comment_of_an_action_comes_back_from_codesys() -> None:
    source = codesys_block(main_action="Count")
    source.pous[0].actions[0].comment = "one more"
    _, report = sfc.convert(source, "codesys")
    assert report.with_outcome(Outcome.DROPPED) == []


def codesys_block(**fields: object) -> Project:
    source = block([], dialect=Dialect.CODESYS)
    pou = source.pous[0]
    pou.actions = [Action(name="Count", body=StBody(text="n := n + 1;"))]
    step = chart_of(source).step("Work")
    for name, value in fields.items():
        setattr(step, name, value)
    return source


@pytest.mark.parametrize("target", ["plcopen-2.01", "plcopen-1.01"])
@pytest.mark.parametrize("kind", ["entry_action", "main_action", "exit_action"])
def test_step_actions_of_codesys_run_as_often_in_tc6(kind: str, target: str) -> None:
    source = codesys_block(**{kind: "Count"})
    report = assert_runs_the_same(source, target, own="codesys")
    assert report.losses == []
    assert_comes_back(source, target)


def test_a_main_action_that_is_executed_once_more_is_approximated() -> None:
    source = codesys_block(main_action="Other.Run")
    _, report = sfc.convert(source, "plcopen")
    item, other = report.losses
    assert item.outcome is Outcome.APPROXIMATED
    assert "executed once more" in item.why
    assert other.why.startswith("the name `Other` is declared neither in the source nor in ")


@pytest.mark.parametrize("target", ["plcopen-2.01", "plcopen-1.01"])
def test_a_minimum_time_is_a_part_of_the_condition_in_tc6(target: str) -> None:
    source = codesys_block(min_time="T#40ms", main_action="Count")
    data, report = sfc.convert(source, target)
    assert report.losses == []
    for project, profile in ((source, "codesys"), (sfc.loads(data, as_tool=True), "iec")):
        inputs = {"go": True, "next": True, "guard": False}
        trace = sfc.simulate(project, pou="FB_Ring", inputs=lambda _s, _v, i=inputs: i, scans=60, profile=profile)  # type: ignore[misc]
        active = trace.is_active("Work")
        visits = "".join("1" if scan else "0" for scan in active).strip("1").split("0")
        assert {len(visit) >= 4 for visit in visits if visit} == {True}
    assert_comes_back(source, target)


def test_flags_and_maximum_times_in_use_are_statements_in_tc6() -> None:
    source = codesys_block(max_time="T#2s")
    _, report = sfc.convert(source, "plcopen")
    assert report.losses == []
    chart_of(source).settings = SfcSettings(flags={SfcFlag.ERROR: FlagUse(use=True), SfcFlag.INIT: FlagUse(use=True)})
    _, report = sfc.convert(source, "plcopen", partial=True)
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    found = [(item.what, item.path) for item in report.with_outcome(Outcome.TRANSLATED)]
    assert ("SFCError", "POU FB_Ring") in found
    assert ("max time", "POU FB_Ring / step Work") in found


def test_an_excluded_action_is_not_executed_in_tc6_either() -> None:
    source = block([{"qualifier": Qualifier.N, "target": "q", "exclude": True}], dialect=Dialect.CODESYS)
    data, report = sfc.convert(source, "plcopen")
    assert report.losses == []
    assert chart_of(sfc.loads(data, as_tool=True)).step("Work").actions == []
    assert_comes_back(source, "plcopen")


def test_the_body_of_an_action_in_place_becomes_an_action_in_codesys() -> None:
    source = block([{"qualifier": Qualifier.P1, "body": StBody(text="n := n + 1;")}], dialect=Dialect.IEC)
    data, _ = sfc.convert(source, "codesys")
    read = sfc.loads(data, as_tool=True)
    assert chart_of(read).step("Work").entry_action == "Work_entry"
    assert chart_of(read).step("Work").actions == []
    again = chart_of(sfc.loads(data)).step("Work")
    assert [row.qualifier for row in again.actions] == [Qualifier.P1]
    assert again.entry_action is None


@pytest.mark.parametrize("target", TARGETS)
def test_names_that_only_scl_can_write_come_back(target: str) -> None:
    source = block([{"qualifier": Qualifier.N, "target": '#"Ventil öffnen"'}])
    chart = chart_of(source)
    chart.rename_step("Work", "Füllen 1")
    chart.transitions[1].condition = '#"Füllen 1".T > T#2s AND "Not Aus"'  # type: ignore[assignment]  # a plain string
    interface = source.pous[0].interface
    assert interface is not None
    interface.sections[1].variables.append(Variable(name="Ventil öffnen", type="BOOL"))
    data, _ = sfc.convert(source, target)
    there = sfc.loads(data)
    assert chart_of(there).step("Fuellen_1").actions[0].target == "Ventil_oeffnen"
    assert_comes_back(source, target)


@pytest.mark.parametrize("target", ["plcopen-2.01", "plcopen-1.01"])
def test_what_codesys_excludes_does_nothing_in_tc6(target: str) -> None:
    source = codesys_block(main_action="Count")
    chart = chart_of(source)
    by_pass = chart.add_step("Bypass")
    by_pass.exclude = True
    by_pass.actions = [ActionAssociation(id=chart.new_id(), target="r")]
    chart.add_transition(chart.step("Rest"), by_pass, "go OR next").exclude = True
    lost = chart.add_step("Lost")
    lost.exclude = True
    lost.actions = [ActionAssociation(id=chart.new_id(), target="r")]
    chart.add_transition(chart.step("Rest"), lost, "n > 12")
    chart.add_transition(lost, chart.step("Done"), "TRUE")
    chart.add_transition(by_pass, chart.step("Done"), "TRUE")
    report = assert_runs_the_same(source, target, own="codesys")
    assert report.losses == []
    back = chart_of(sfc.loads(sfc.convert(source, target)[0]))
    assert [row.target for row in back.step("Lost").actions] == ["r"]
    (entering,) = [t for t in back.transitions if t.targets == [back.step("Bypass").id]]
    assert getattr(entering.condition, "text", "") == "go OR next"


EDITABLE = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR k, n : INT; END_VAR
INITIAL_STEP S1: Out(P0); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
STEP S2: END_STEP
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
ACTION Out: k := k + 1; END_ACTION
ACTION Work: n := n + 1; END_ACTION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("target", ["plcopen-2.01", "plcopen-1.01"])
@pytest.mark.parametrize(
    ("old", "new"),
    [
        (r'qualifier="P0"', 'qualifier="P1"'),
        (r'qualifier="P0"', 'qualifier="D" duration="T#1s"'),
        (r"S1\.T &gt;= T#50ms", "S1.T &gt;= T#40ms"),
        (r"a AND S1\.T &gt;= T#50ms", "a"),
        (r"<actionBlock ", '<actionBlock negated="true" '),
    ],
)
def test_a_native_edit_wins_over_what_extension_data_keep(old: str, new: str, target: str) -> None:
    """A digest covers all that is executed of an element, not some of its fields."""
    project = sfc.loads(EDITABLE.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    (chart,) = project.charts()
    first, second = chart.chart.steps
    first.actions, first.exit_action, first.min_time = [], "Out", "T#50ms"
    second.main_action = "Work"
    text = sfc.dumps(project, format=target, partial=True).decode()
    edited = re.sub(old, new, text, count=1)
    assert edited != text
    seen, read = (sfc.loads(edited.encode(), as_tool=tool) for tool in (True, False))
    before = sfc.loads(text.encode(), as_tool=True)
    changed = {(d.path, d.aspect, d.right) for d in compare(executed(before), executed(seen))}
    own = {(d.path, d.aspect, d.right) for d in compare(executed(sfc.loads(text.encode())), executed(read))}
    assert changed
    assert own
    assert not {d.aspect for d in compare(executed(read), executed(seen))} & {aspect for _, aspect, _ in changed}
    assert "XML214" in {finding.code for finding in read.diagnostics}


def test_inputs_that_become_flags_in_codesys_are_named() -> None:
    text = EDITABLE.replace("a, b : BOOL;", "a, b, SFCInit : BOOL;")
    content = sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="plcopen-2.01")
    _, report = sfc.convert(sfc.loads(content), "codesys", partial=True)
    (item,) = [item for item in report.items if item.what == "SFCInit"]
    assert item.outcome is Outcome.APPROXIMATED
    assert item.path == "POU Main"
    assert "controls the chart in CODESYS" in item.why


def test_nothing_of_the_way_back_to_codesys_is_called_a_mistake() -> None:
    project = sfc.loads(EDITABLE.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    (chart,) = project.charts()
    inner = SfcNetwork()
    inner.add_step("I1", initial=True)
    assert chart.pou.interface is not None
    chart.pou.interface.sections[0].variables.append(Variable(name="SFCInit", type="BOOL"))
    chart.pou.actions.append(Action(name="Nested", body=SfcBody(chart=inner)))
    chart.chart.steps[1].actions = [ActionAssociation(id=90, qualifier=Qualifier.N, target="Nested")]
    content = sfc.dumps(project, format="plcopen-2.01", partial=True)
    _, report = sfc.convert(sfc.loads(content), "codesys", partial=True)
    assert [item.why.partition(":")[0] for item in report.losses] == ["SFC131"]  # neither SFCInit nor the chart
    assert not [item for item in report.items if reporting.UNSAID in item.why]


def test_an_action_of_codesys_comes_back_from_tia_portal_with_its_final_scan() -> None:
    text = EDITABLE.replace("STEP S2: END_STEP", "STEP S2: Work(N); END_STEP")
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    first = sfc.dumps(project, format="codesys")
    away = sfc.dumps(sfc.loads(first), format="simaticml", partial=True)
    content, report = sfc.convert(sfc.loads(away), "codesys", partial=True)
    chart = next(iter(sfc.loads(content, as_tool=True).charts())).chart
    assert chart.step("S2").main_action is None
    assert [row.target for row in chart.step("S2").actions] == ["Work"]
    assert not [item.what for item in report.losses if item.what == "final scan"]


def test_the_page_has_the_tables_of_the_rules() -> None:
    page = Path(__file__).parents[2] / "docs" / "conversion.md"
    assert rule_tables() in page.read_text("utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_members_that_tia_portal_retains_come_back(target: str) -> None:
    """They are in a section of their own in the file, also after an edit of it, and in that of the others again."""
    source = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    data, _ = sfc.convert(source, target, partial=True)
    seen = sfc.loads(data, as_tool=True).pou("FB_Drill").interface
    assert [v.name for section in seen.sections if section.retain for v in section.variables] == ["Parts"]
    back = sfc.loads(data)
    assert not any(section.retain for section in back.pou("FB_Drill").interface.sections)
    back.rename("FB_Drill.DwellTime", "Dwelling")
    edited = sfc.dumps(back)
    seen = sfc.loads(edited, as_tool=True).pou("FB_Drill").interface
    assert [v.name for section in seen.sections if section.retain for v in section.variables] == ["Parts"]
    block = sfc.loads(edited).pou("FB_Drill")
    assert {"Parts", "Dwelling"} <= {variable.name for variable in block.variables()}
    assert not any(section.retain for section in block.interface.sections)


@pytest.mark.parametrize(
    ("target", "words"),
    [("codesys", {"Abstract", "This", "Property", "JMP"}), ("codesys23", {"This", "JMP"})],
    ids=["V3", "2.3"],
)
def test_keywords_of_the_target_are_other_names_there_and_come_back(target: str, words: set[str]) -> None:
    """TwinCAT and CODESYS V3 are object-oriented; no file of theirs declares such a name."""
    text = """PROGRAM Main
VAR Abstract : BOOL; This : BOOL; Step, JMP : INT; END_VAR
INITIAL_STEP Property: count(N); END_STEP
TRANSITION FROM Property TO Run := Abstract AND This; END_TRANSITION
STEP Run: END_STEP
TRANSITION FROM Run TO Property := TRUE; END_TRANSITION
ACTION count: JMP := JMP + 1; END_ACTION
END_PROGRAM
"""
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target)
    told = {item.why for item in report.items if item.what == "name"}
    tool = {"codesys": "CODESYS", "codesys23": "CoDeSys 2.3"}[target]
    assert told == {f"{word}_2 in {tool}: {word} is a keyword there" for word in words}
    written = sfc.loads(data, format=target)
    pou = written.pou("Main")
    assert pou.chart is not None
    declared = {*(v.name for v in pou.variables()), *(step.name for step in pou.chart.steps)}
    assert {f"{word}_2" for word in words} <= declared
    assert not declared & words
    back, report = sfc.convert(written, "plcopen")
    assert not report.losses
    again = sfc.loads(back).pou("Main")
    assert {"Abstract", "This", "Step", "JMP"} == {v.name for v in again.variables()}
    assert "JMP := JMP + 1" in again.actions[0].body.text  # type: ignore[union-attr]


@pytest.mark.parametrize("target", ["codesys", "twincat", "codesys-export"])
def test_names_of_codesys23_may_be_keywords_of_its_successor(target: str, tmp_path: Path) -> None:
    text = """(* @NESTEDCOMMENTS := 'Yes' *)
FUNCTION_BLOCK Main
VAR LInt, Super, Method, Other : INT; END_VAR
(* @END_DECLARATION := '0' *)
LInt := Super + Method + Other;
END_FUNCTION_BLOCK
"""
    path = tmp_path if target == "twincat" else tmp_path / "out.xml"
    report = sfc.save(sfc.loads(text.encode(), format="codesys23"), path, format=target)
    assert {item.path.split(" ")[-1] for item in report.items if item.what == "name"} == {"LInt", "Super", "Method"}
    written = sfc.load(path)
    assert [each.name for each in written.pou("Main").variables()] == ["LInt_2", "Super_2", "Method_2", "Other"]
    assert "LInt_2 := Super_2 + Method_2 + Other" in written.pou("Main").body.text  # type: ignore[union-attr]
    if target == "codesys":
        again = sfc.loads(sfc.dumps(written, format="codesys23")).pou("Main")
        assert [each.name for each in again.variables()] == ["LInt", "Super", "Method", "Other"]


@pytest.mark.parametrize("target", ["codesys", "codesys23", "twincat"])
def test_operators_of_the_target_are_no_names_there(target: str) -> None:
    """A step ``Move`` and a variable ``max`` were written, though a step of that name from S7-GRAPH was renamed."""
    text = """PROGRAM Main VAR max, Step, s : INT; END_VAR
INITIAL_STEP Move: Action(N); END_STEP TRANSITION FROM Move TO Limits := max > 3; END_TRANSITION
STEP Limits: END_STEP TRANSITION FROM Limits TO Move := TRUE; END_TRANSITION
ACTION Action: max := max + 1; END_ACTION END_PROGRAM
"""
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target)
    renamed = [item for item in report.items if item.what == "name"]
    assert {item.path.split(" ")[-1] for item in renamed} == {"max", "Move", "Action"}
    assert b"max_2 := max_2 + 1" in data


def test_what_only_codesys_compiles_is_told_in_files_of_tc6() -> None:
    """TC6 is read by tools of CODESYS and by others: the text stays, and the report has its lines."""
    text = "PROGRAM Main\nVAR w : WORD; i : INT; END_VAR\ni := i + 1;\nw := w + 1;\nw.0 := w.3;\nEND_PROGRAM\n"
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    _, report = sfc.convert(project, "plcopen-2.01", partial=True)
    losses = [(item.outcome, item.why.partition(":")[0]) for item in report.losses]
    assert [outcome for outcome, _ in losses] == [Outcome.APPROXIMATED] * 3
    assert {line for _, line in losses} == {"line 2", "line 3"}
    assert sfc.convert(project, "codesys")[1].losses == []


def test_inherited_names_are_declared_in_the_source() -> None:
    text = """FUNCTION_BLOCK Base
VAR_OUTPUT o : BOOL; END_VAR
o := TRUE;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Derived EXTENDS Base
VAR p : BOOL; END_VAR
p := o;
END_FUNCTION_BLOCK
"""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    _, report = sfc.convert(project, "simaticml", partial=True)
    (item,) = [item for item in report.losses if item.what == "undeclared name"]
    assert (item.outcome, item.why) == (Outcome.NOT_EXECUTED, "the name `o` is not declared in TIA Portal")


PARTIAL = """FUNCTION_BLOCK Fb
VAR_IN_OUT Io : ST_Io; END_VAR
VAR n : INT; END_VAR
INITIAL_STEP Idle: END_STEP
STEP Work: Both(N); END_STEP
TRANSITION FROM Idle TO Work := Io.Start; END_TRANSITION
TRANSITION FROM Work TO Idle := io.start; END_TRANSITION
ACTION Both:
Io.Valve := TRUE; Io.Lamp := FALSE; n := n * 0;
END_ACTION
END_FUNCTION_BLOCK
FUNCTION_BLOCK Other
VAR Io : st_io; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := Io.Start; END_TRANSITION
TRANSITION FROM S2 TO S1 := NOT Io.Start; END_TRANSITION
END_FUNCTION_BLOCK
"""


@pytest.mark.slow
def test_a_type_that_no_file_declares_is_one_loss_and_its_variables_are_passed() -> None:
    """Actions that use a variable of the type were lost as well, and a chart that shares it ran with another one.

    The other spelling of the type and of a name was a loss, too.
    """
    project = sfc.loads(PARTIAL.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    written = io.BytesIO()
    report = sfc.save(project, written, format="simaticml", partial=True, limit=8)
    lost = [(item.what, item.path) for item in report.losses if item.outcome is Outcome.NOT_EXECUTED]
    assert lost == [("undeclared type", "POU Fb / Io")]
    read = sfc.loads(written.getvalue(), as_tool=True)
    (function,) = [pou for pou in read.pous if pou.kind is PouKind.FUNCTION]
    assert [variable.name for variable in function.variables(SectionKind.IN_OUT)] == ["Io", "n"]
    assert all(each.startswith("equal") for each in report.compared.values()), report.compared
    told = "types that nothing declares have the members that are used of them"
    assert all(each.splitlines()[-1] == told for each in report.compared.values())
    project.pou("Other").chart.transitions[0].condition = Expression(text="Io.List[1].Start")
    report = sfc.save(project, io.BytesIO(), format="simaticml", partial=True, limit=1)
    told = "not compared: nothing declares the type `{}` of its variables; convert the file that does as well"
    assert report.compared == {"POU Fb": told.format("ST_Io"), "POU Other": told.format("st_io")}


@pytest.mark.parametrize("target", ["simaticml", "scl", "codesys"])
def test_arrays_of_any_length_are_kept(target: str) -> None:
    """The bounds ``*`` were told as texts that cannot be read."""
    text = """FUNCTION_BLOCK Clear
VAR_IN_OUT List : ARRAY[*] OF INT; END_VAR
VAR i : INT; END_VAR
FOR i := LOWER_BOUND(List, 1) TO UPPER_BOUND(List, 1) DO List[i] := 0; END_FOR
END_FUNCTION_BLOCK
"""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    data, report = sfc.convert(project, target, partial=True)
    assert report.losses == []
    assert b"[*]" in data or b'lower="*" upper="*"' in data
    there, _ = sfc.convert(sfc.loads(data), "iec-text", partial=True)
    assert b"ARRAY[*] OF INT" in there.replace(b"ARRAY [", b"ARRAY[").upper()


CROSSED = b"""PROGRAM Main
VAR_INPUT a, b, c, d : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
STEP P1: END_STEP
STEP P2: END_STEP
STEP P3: END_STEP
STEP P4: END_STEP
STEP P5: END_STEP
TRANSITION FROM S1 TO (P1, P2) := a; END_TRANSITION
TRANSITION FROM P1 TO (P3, P4) := b; END_TRANSITION
TRANSITION FROM (P2, P3) TO P5 := c; END_TRANSITION
TRANSITION FROM (P5, P4) TO S1 := d; END_TRANSITION
TRANSITION FROM P4 TO P4 := c; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.parametrize("target", ["codesys", "codesys-export", "twincat", "codesys23"])
def test_branches_that_do_not_nest_and_are_no_loops_are_refused_in_the_family_of_codesys(target: str) -> None:
    """Where they cannot become loops: a step is left and entered at once."""
    project = sfc.loads(CROSSED, format="iec-text")
    with pytest.raises(sfc.LossError) as caught:
        sfc.save(project, io.BytesIO(), format=target)
    told = [item for item in caught.value.report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "chart"]
    assert [item.path for item in told] == [f"POU Main / transition {name}" for name in ("P2+P3 -> P5", "P5+P4 -> S1")]
    assert "charts of" in told[0].why


@pytest.mark.parametrize(("value", "inner"), [("val 1", "in 2"), ("min", "max"), ("Limit", "Action")])
def test_renamed_members_of_data_blocks_and_structures_are_the_same_inputs_of_both_sides(
    value: str, inner: str
) -> None:
    """One was driven apart from the other, or was told to be missing: a chart was different that is the same."""
    project = block([{"qualifier": Qualifier.N, "target": "#q"}])
    (pou,) = project.pous
    assert pou.interface is not None

    def boolean(name: str) -> Variable:
        return Variable.model_validate({"name": name, "type": "BOOL"})

    section = VariableSection(
        variables=[boolean(value), Variable(name="st", type=StructType(members=[boolean(inner)]))]
    )
    project.data_blocks.append(
        DataBlock(name="My DB", kind=DataBlockKind.GLOBAL, interface=Interface(sections=[section]))
    )
    pou.interface.sections[0].variables.append(Variable(name="s", type=StructType(members=[boolean("on 3")])))
    condition = f'"My DB"."{value}" AND "My DB".st."{inner}" AND #s."on 3"'
    chart_of(project).transitions[0].condition = Expression(text=condition)
    _, report = sfc.convert(project, "codesys", limit=8)
    assert report.losses == []
    assert report.compared["POU FB_Ring"].startswith("equal, second 1 scan later (proof")
