"""Inputs, modes and permanent operations of S7-GRAPH, executed by charts of CODESYS and TC6, or reported."""

from __future__ import annotations

import io
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.conversion.chart_runs import SHIFTED
from plcopen_sfc.model.compare import differences
from plcopen_sfc.report import START_OF_CHART, Outcome
from tests.conversion.features import FEATURES, Feature, FeatureChart, drawn, feature_project
from tests.conversion.matrix import same_behaviour
from tests.sweeps import in_turn

TARGETS = ("codesys", "plcopen-2.01")


def sequencer(
    *,
    before: str | None = None,
    after: str | None = None,
    rows: tuple[dict[str, Any], ...] = (),
    condition: str | None = None,
    acknowledge: bool = False,
    inputs: tuple[str, ...] = (),
    outputs: tuple[str, ...] = (),
) -> m.Project:
    """A sequencer as TIA Portal would read it; its step Work has the conditions that `rows` need."""

    def build(rig: FeatureChart) -> None:
        for text, operations in ((before, rig.chart.permanent_pre), (after, rig.chart.permanent_post)):
            if text is not None:
                operations.append(m.PermanentOperation(body=drawn(text, "LD", m.Dialect.SCL)))
        rig.act("Done" if rows else "Work", "r" if rows else "q")
        events = {row.get("event") for row in rows}
        work = rig.chart.step("Work")
        if acknowledge or events & {"V1", "V0", "A1"}:
            work.supervision = m.Supervised(condition=m.Expression(text="#g"))
        if events & {"L1", "L0", "C"}:
            work.interlock = m.Supervised(condition=m.Expression(text="#g"))
        rig.chart.graph_settings = m.GraphSettings(acknowledge_errors_required=acknowledge)
        rig.declare(m.SectionKind.INPUT, *(m.Variable(name=name, type="BOOL") for name in inputs))
        kinds = {name: "INT" if name == "S_NO" else "BOOL" for name in outputs}
        rig.declare(
            m.SectionKind.OUTPUT, *(m.Variable.model_validate({"name": n, "type": k}) for n, k in kinds.items())
        )
        for row in rows:
            rig.act(**row)
        if condition is not None:
            rig.chart.transitions[1].condition = m.Expression(text=condition)

    return as_file(feature_project(Feature("sequencer", ("simaticml",), build), "simaticml"))


def as_file(project: m.Project) -> m.Project:
    return sfc.loads(sfc.dumps(project, format="simaticml", partial=True), format="simaticml")


COUNTED: tuple[dict[str, Any], ...] = ({"step": "Done", "target": "n", "value": "n + 1"},)
PERMANENT: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "for actions": ({"before": "#n := 3;", "rows": COUNTED}, TARGETS),
    "of actions": ({"after": "#r := #q;"}, ("codesys",)),
    "of the new situation": ({"after": "#r := #Work.X;", "condition": "#r"}, TARGETS),
    "for conditions": ({"before": "#r := #g;", "condition": "#r AND #b"}, ()),
    "of the situation before": ({"before": "#r := #Work.X;"}, ()),
}
"""Permanent instructions, and the targets in which they do exactly the same."""


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(("fields", "exact"), PERMANENT.values(), ids=PERMANENT.keys())
def test_permanent_instructions_run_as_reported(fields: dict[str, Any], exact: tuple[str, ...], target: str) -> None:
    source = sequencer(**fields)
    data, report = sfc.convert(source, target)
    [told] = [item for item in report.items if item.what.startswith("permanent instruction")]
    verdict = same_behaviour(source, sfc.loads(data, format=target, as_tool=True))
    assert verdict is not None
    assert verdict.equal is (target in exact), verdict
    assert told.outcome is (Outcome.TRANSLATED if target in exact else Outcome.APPROXIMATED)
    assert report.losses == [each for each in (told,) if target not in exact]
    assert list(differences(source, as_file(sfc.loads(data, format=target)))) == []


@pytest.mark.parametrize("target", TARGETS)
def test_permanent_instructions_that_nothing_reads_are_told(target: str) -> None:
    """They were taken for empty ones, and left out without a word."""
    project = sequencer(before="#r := #g;")
    project.pou("Main").chart.permanent_pre[0].body = m.OpaqueBody(source="STL", content="<Statement/>")
    report = sfc.convert(project, target, partial=True)[1]
    [told] = [item for item in report.items if item.what == "permanent instruction before the sequence"]
    assert told.outcome is Outcome.NOT_EXECUTED


@pytest.mark.parametrize("target", TARGETS)
def test_permanent_instructions_are_executed_once_after_an_edit_of_the_actions(target: str) -> None:
    data, _ = sfc.convert(sequencer(before="#r := #g;", after="#n := #n + 1;"), target)
    edited = data.replace(b"n + 1", b"n + 2")  # by a tool that keeps the extension data
    chart = sfc.loads(edited, format=target).pou("Main").chart
    assert chart is not None
    assert (chart.permanent_pre, chart.permanent_post) == ([], [])
    rows = [row for row in chart.step("Idle").actions if row.target != "sequence_started"]
    assert [row.qualifier for row in rows] == [m.Qualifier.S, m.Qualifier.S]


def leaving_at_once(*parts: Any, inputs: tuple[str, ...] = ()) -> m.Project:
    """A sequencer whose first condition is TRUE from the first scan on."""
    project = sfc.Project(name="Plant", dialect=m.Dialect.SCL)
    pou = project.add_function_block("Main", sfc.step("Idle", initial=True), "NOT #a", *parts)
    for name in inputs:
        pou.add_variable(name, "BOOL", "input")
    pou.add_variable("S_NO", "INT", "output")
    return sfc.loads(sfc.dumps(project, format="simaticml", partial=True), format="simaticml", as_tool=True)


LEAVING = {
    "one step at a time": leaving_at_once(sfc.step("Work", actions=["N #q"]), "#b", sfc.jump("Idle")),
    "loops": leaving_at_once(
        sfc.simultaneous([sfc.step("Left", actions=["N #q"])], [sfc.step("Right", actions=["N #r"])]),
        "#b",
        sfc.jump("Idle"),
        inputs=("INIT_SQ", "OFF_SQ"),
    ),
}


@pytest.mark.parametrize("project", LEAVING.values(), ids=LEAVING.keys())
@pytest.mark.parametrize(
    ("target", "flavour", "profile"),
    [("plcopen-2.01", "", "iec"), ("plcopen-2.01", "beremiz", "beremiz"), ("iec-text", "matiec", "matiec")],
)
def test_what_is_stored_is_executed_from_the_first_scan_on(
    project: m.Project, target: str, flavour: str, profile: str
) -> None:
    """The initial step was left before it stored anything: outputs stayed, and in Beremiz no step was active again."""
    data, report = sfc.convert(project, target, flavour=flavour, strict=True)
    written = sfc.loads(data, format=target.removesuffix("-2.01"), as_tool=True)
    inputs = {"a": [False] * 4 + [True] * 2, "b": [False] * 3 + [True] * 3}
    traces = [
        sfc.simulate(each, pou="Main", inputs=lambda scan, _: {n: v[scan] for n, v in inputs.items()}, **more)
        for each, more in ((project, {"scans": 6}), (written, {"scans": 6, "profile": profile}))
    ]
    assert list(traces[0]["S_NO"])[:2] == [1, 2]
    for name in ("S_NO", "q"):
        assert list(traces[1][name]) == list(traces[0][name]), name
    assert report.losses == []
    if target == "plcopen-2.01" and not flavour:
        assert list(differences(project, as_file(sfc.loads(data, format=target)))) == []


def test_flags_of_initial_steps_are_true_in_the_first_scan_of_beremiz() -> None:
    """Conditions that ask for such a step were FALSE in the first scan."""
    text = """FUNCTION_BLOCK Main VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR
        INITIAL_STEP A1: END_STEP TRANSITION FROM A1 TO A2 := NOT a; END_TRANSITION STEP A2: END_STEP
        INITIAL_STEP B1: END_STEP TRANSITION FROM B1 TO B2 := A1.X; END_TRANSITION STEP B2: q(N); END_STEP
        END_FUNCTION_BLOCK"""
    data, _ = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "plcopen-2.01", flavour="beremiz", strict=True)
    written = sfc.loads(data, format="plcopen", as_tool=True)
    assert sfc.simulate(written, pou="Main", scans=2, profile="beremiz").active(0) == ("A2", "B2")


ONCE = {"step": "Work", "target": "q"}
"""A coil that is TRUE in the scan of its event."""
AGAIN = {"step": "Work", "target": "r"}
EVENTS: dict[str, dict[str, Any]] = {
    "L1 L0": {"rows": ({**ONCE, "event": "L1"}, {**AGAIN, "event": "L0"})},
    "V1 V0": {"rows": ({**ONCE, "event": "V1"}, {**AGAIN, "event": "V0"})},
    "stored": {"rows": ({**ONCE, "qualifier": "S", "event": "L1"}, {**ONCE, "qualifier": "R", "event": "L0"})},
    "coils of one operand": {"rows": tuple({**ONCE, "event": event} for event in ("S1", "L1", "V0"))},
    "coils of two steps": {"rows": ({**ONCE, "event": "S1"}, {**ONCE, "step": "Done"})},
    "a coil that is never TRUE": {"rows": ({**ONCE, "qualifier": "S"}, {**ONCE, "step": "Done", "event": "L1"})},
    "C and V1": {"rows": ({**ONCE, "event": "V1", "interlock": True}, {**AGAIN, "event": "C"})},
    "a value": {"rows": ({"step": "Work", "target": "n", "value": "5", "event": "V1"},)},
    "held until acknowledged": {"rows": ({**ONCE, "event": "V1"},), "acknowledge": True, "inputs": ("ACK_EF",)},
    "A1": {"rows": ({**ONCE, "event": "A1"},), "inputs": ("ACK_EF",)},
    "A1 where required": {"rows": ({**ONCE, "event": "A1"},), "acknowledge": True, "inputs": ("ACK_EF",)},
    "R1": {"rows": ({**ONCE, "event": "R1"},), "inputs": ("REG_EF", "REG_S")},
}


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_what_a_step_does_at_its_end_is_reported_where_the_next_one_is_first(target: str) -> None:
    last = {"step": "Done", "target": "n", "value": "3", "event": "S0"}
    source = sequencer(rows=(last, {"step": "Idle", "target": "n", "value": "n + 1"}))
    data, report = sfc.convert(source, target)
    verdict = same_behaviour(source, sfc.loads(data, format=target, as_tool=True))
    assert verdict is not None
    assert verdict.different is (target != "codesys")
    losses = [item for item in report.losses if item.what != START_OF_CHART]  # which the comparison allows for
    assert [item.outcome for item in losses] == [Outcome.APPROXIMATED] * verdict.different


@pytest.mark.parametrize("target", TARGETS)
def test_an_operand_that_two_active_steps_write_in_another_order_is_reported(target: str) -> None:
    """S7-GRAPH drives coils before it sets anything; Work comes before Side in TC6, and after it in CODESYS."""

    def build(rig: FeatureChart) -> None:
        side = rig.chart.add_step("Side")
        rig.chart.transitions[0].targets.append(side.id)
        rig.chart.transitions[1].sources.append(side.id)
        rig.act("Side", "q", event="S1")
        rig.act("Work", "q", "S")
        rig.act("Done", "q", "R")

    source = as_file(feature_project(Feature("order", ("simaticml",), build), "simaticml"))
    data, report = sfc.convert(source, target)
    verdict = same_behaviour(source, sfc.loads(data, format=target, as_tool=True))
    assert verdict is not None
    assert verdict.different is (target != "codesys"), verdict
    assert [item.outcome for item in report.losses] == [Outcome.APPROXIMATED] * verdict.different


def test_a_step_that_the_first_scan_does_not_leave_is_told_as_that_alone() -> None:
    """No action reads what differs, in a tool that executes actions first."""
    report = sfc.convert(sequencer(**EVENTS["held until acknowledged"]), "codesys", limit=8).report
    (item,) = [item for item in report.losses if item.what == "chart"]
    assert item.why.endswith("; the source tests no transition in its first scan")


@pytest.mark.slow
@pytest.mark.parametrize(("number", "fields"), [*enumerate(EVENTS.values())], ids=[*EVENTS])
def test_events_and_acknowledgements_run_as_in_the_source(number: int, fields: dict[str, Any]) -> None:
    """One target for each case, all with PLCOPEN_SFC_FULL."""
    source = sequencer(**fields)
    for target in in_turn(TARGETS, number):
        data, report = sfc.convert(source, target)
        told = [item.what for item in report.losses]
        assert told in ([], ["inputs of actions"] if target == "codesys" else [])
        result = sfc.loads(data, format=target, as_tool=True)
        verdict = same_behaviour(source, result, operated=fields.get("inputs", ()), later_inputs=True)
        assert verdict is not None
        assert verdict.proven, verdict
        assert list(differences(source, as_file(sfc.loads(data, format=target)))) == []


@pytest.mark.parametrize("target", ["codesys", pytest.param("plcopen-2.01", marks=pytest.mark.slow)])
def test_several_sequences_do_the_same_behind_the_step_that_begins_them(target: str) -> None:
    """What is executed in every scan begins with the step Start: no chart with it was compared from there on."""

    def build(rig: FeatureChart) -> None:
        rig.chart.permanent_pre.append(m.PermanentOperation(body=drawn("#r := NOT #g;", "LD", m.Dialect.SCL)))
        rig.act("Work", "q")
        rig.chart.step("Work").supervision = m.Supervised(condition=m.Expression(text="#g"))
        rig.chart.graph_settings = m.GraphSettings(acknowledge_errors_required=True)
        rig.declare(m.SectionKind.INPUT, m.Variable.model_validate({"name": "ACK_EF", "type": "BOOL"}))
        rig.chart.add_step("Dark", initial=True)
        rig.chart.add_step("Bright")
        rig.chart.add_transition("Dark", "Bright", "#b")
        rig.chart.add_transition("Bright", "Dark", "NOT #b")

    source = as_file(feature_project(Feature("sequences", ("simaticml",), build), "simaticml"))
    data, report = sfc.convert(source, target, limit=5)
    chart = sfc.loads(data, format=target, as_tool=True).pou("Main").chart
    assert chart is not None
    initial = chart.initial_steps[0]
    if target == "codesys":
        assert {row.target for row in initial.actions} == {"A_edges_of_inputs", "before_sequence"}
    (verdict,) = report.compared.values()
    assert verdict.startswith("equal") or verdict.splitlines()[0].endswith(SHIFTED), verdict


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
def test_members_of_a_data_block_are_the_same_inputs_in_both_tools(target: str) -> None:
    """In TC6 the block is a variable in a list of its own: its members were other inputs there, and all differed."""
    source = sequencer(condition='"Data".go AND #b')
    go = m.VariableSection(
        kind=m.SectionKind.LOCAL, variables=[m.Variable.model_validate({"name": "go", "type": "BOOL"})]
    )
    source.data_blocks.append(m.DataBlock(name="Data", interface=m.Interface(sections=[go])))
    report = sfc.convert(source, target, limit=8)[1]
    (verdict,) = report.compared.values()
    assert verdict.startswith("equal") or verdict.splitlines()[0].endswith(SHIFTED), verdict


@pytest.mark.parametrize("target", TARGETS)
def test_variables_are_computed_as_long_as_an_edited_condition_reads_them(target: str) -> None:
    data, _ = sfc.convert(sequencer(acknowledge=True, inputs=("ACK_EF",)), target)
    edited = data.replace(b"b AND NOT (g OR", b"b AND c AND NOT (g OR")
    assert edited != data
    project = sfc.loads(edited, format=target)
    pou = project.pou("Main")
    assert "Work_VA" in [variable.name for variable in pou.variables()]
    assert project.pou("Main").chart is not None
    same = same_behaviour(project, sfc.loads(edited, format=target, as_tool=True), operated=("ACK_EF",))
    assert same is not None
    assert same.proven


@pytest.mark.parametrize("target", TARGETS)
def test_the_data_of_tia_portal_for_steps_are_left_out_and_come_back(target: str) -> None:
    source = sequencer(condition="#Work.T > T#1s")
    kinds = {"RT_DATA": "G7_RTDataPlus_V6", "Trans1": "G7_TransitionPlus_V6", "Work": "G7_StepPlus_V6"}
    interface = source.pou("Main").interface
    assert interface is not None
    own = [m.Variable.model_validate({"name": name, "type": kind}) for name, kind in kinds.items()]
    own.insert(1, m.Variable(name="mine", type="INT"))
    interface.sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=own))
    source = as_file(source)
    data, report = sfc.convert(source, target)
    assert report.losses == []
    assert {item.path for item in report.items if item.what == "variable" and item.outcome is Outcome.TRANSLATED} == {
        f"POU Main / {name}" for name in kinds
    }
    declared = {each.name for each in sfc.loads(data, format=target, as_tool=True).pou("Main").variables()}
    assert "mine" in declared
    assert declared.isdisjoint(kinds)
    assert list(differences(source, as_file(sfc.loads(data, format=target)))) == []


SHOWN: dict[str, dict[str, Any]] = {
    "one step": {"outputs": ("S_NO", "S_MORE", "S_ACTIVE", "AUTO_ON", "MAN_ON")},
    "errors": {"rows": ({**ONCE, "event": "C"}, {**AGAIN, "event": "V1"}), "outputs": ("ERR_FLT",)},
    "errors until acknowledged": {"acknowledge": True, "inputs": ("ACK_EF",), "outputs": ("ERR_FLT",)},
}


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("fields", SHOWN.values(), ids=[*SHOWN])
def test_outputs_show_the_state_of_the_sequence(fields: dict[str, Any], target: str) -> None:
    source = sequencer(**fields)
    data, report = sfc.convert(source, target)
    told = [item.what for item in report.losses]
    assert told in ([], ["inputs of actions"] if target == "codesys" else [])
    result = sfc.loads(data, format=target, as_tool=True)
    verdict = same_behaviour(
        *(source, result),
        operated=fields.get("inputs", ()),
        outputs=fields["outputs"],
        later_inputs=True,
    )
    assert verdict is not None
    assert verdict.proven, verdict
    assert list(differences(source, as_file(sfc.loads(data, format=target)))) == []


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_the_step_displayed_stays_while_it_is_active(target: str) -> None:
    def build(rig: FeatureChart) -> None:
        chart = rig.chart
        side = chart.add_step("Side")
        chart.transitions[0].targets = [chart.step("Work").id, side.id]
        chart.add_transition(side, chart.step("Side"), "#g")
        chart.transitions[-1].targets = []
        chart.graph_settings = m.GraphSettings(acknowledge_errors_required=False)
        kinds = {"S_NO": "INT", "S_MORE": "BOOL", "S_ACTIVE": "BOOL"}
        rig.declare(
            m.SectionKind.OUTPUT, *(m.Variable.model_validate({"name": n, "type": k}) for n, k in kinds.items())
        )
        rig.act("Side", "q")

    source = as_file(feature_project(Feature("display", ("simaticml",), build), "simaticml"))
    data, _ = sfc.convert(source, target)
    result = sfc.loads(data, format=target, as_tool=True)
    verdict = same_behaviour(source, result, outputs=("S_NO", "S_MORE", "S_ACTIVE"))
    assert verdict is not None
    assert verdict.equal, verdict


@pytest.mark.slow
@pytest.mark.parametrize("fits", [True, False], ids=["patched", "written from the model"])
@pytest.mark.parametrize("target", TARGETS)
def test_an_edit_of_the_source_keeps_what_is_executed(target: str, fits: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = ({**ONCE, "event": "L1"}, {**AGAIN, "event": "V1"})
    source = sequencer(before="#n := 3;", rows=rows, acknowledge=True, inputs=("ACK_EF",), outputs=("S_NO", "ERR_FLT"))
    data, _ = sfc.convert(source, target)
    project = sfc.loads(data, format=target)
    chart = project.pou("Main").chart
    assert chart is not None
    chart.rename_step("Done", "Ready")
    if not fits:
        monkeypatch.setattr("plcopen_sfc.formats.xml.source_patch.patch_xml", lambda content, *_: content)
    edited = sfc.dumps(project, format=target)
    if fits:
        assert len(set(edited.splitlines()) - set(data.splitlines())) < 20
    result = sfc.loads(edited, format=target, as_tool=True)
    verdict = same_behaviour(
        source, result, operated=("ACK_EF",), outputs=("S_NO", "ERR_FLT"), later_inputs=target == "codesys"
    )
    assert verdict is not None
    assert verdict.proven, verdict


@pytest.mark.parametrize("target", TARGETS)
def test_inputs_that_operate_a_sequencer_are_lost_unless_nobody_uses_them(target: str) -> None:
    source = sequencer(inputs=("HALT_SQ", "ZERO_OP"))
    assert _operating(source, target) == {"HALT_SQ": "not executed", "ZERO_OP": "not executed"}
    assert _operating(source, target, "halt_sq") == {"HALT_SQ": "translated", "ZERO_OP": "not executed"}
    assert _operating(source, target, "all") == {"HALT_SQ": "translated", "ZERO_OP": "translated"}
    with pytest.raises(sfc.ModelError, match="Q does not operate sequencers"):
        sfc.convert(source, target, partial=True, at_rest=["q"])


def test_inputs_that_nothing_in_a_project_operates_are_approximated() -> None:
    source = sequencer(inputs=("HALT_SQ", "ZERO_OP"))
    (block,) = source.pous
    source.data_blocks.append(m.DataBlock(name="Line_DB", kind=m.DataBlockKind.INSTANCE, type_name=f'"{block.name}"'))
    assert _operating(source, "codesys") == {"HALT_SQ": "approximated", "ZERO_OP": "approximated"}
    text = '"Line_DB"(ZERO_OP := TRUE);'
    source.pous.append(m.Pou(name="Main", kind=m.PouKind.ORGANIZATION_BLOCK, number=1, bodies=[m.StBody(text=text)]))
    assert _operating(source, "codesys") == {"HALT_SQ": "approximated", "ZERO_OP": "not executed"}


def _operating(project: m.Project, target: str, *at_rest: str) -> dict[str, str]:
    """Items of a report on each operating input, by its name."""
    report = sfc.convert(project, target, partial=True, at_rest=at_rest).report
    return {item.path.split(" / ")[-1]: item.outcome.value for item in report.items if "operating" in item.what}


def test_the_cyclic_organization_block_is_called_by_a_task_and_comes_back() -> None:
    text = b"FUNCTION_BLOCK Lamp VAR n : INT; END_VAR n := n + 1; END_FUNCTION_BLOCK"
    source = sfc.loads(text, format="iec-text")
    source = as_file(source)
    source.pous.append(
        m.Pou(name="Main", kind=m.PouKind.ORGANIZATION_BLOCK, number=1, bodies=[m.StBody(text="#x := TRUE;")])
    )
    data, report = sfc.convert(source, "codesys", partial=True)
    assert [item.path for item in report.items if item.what == "program"] == ["POU Main"]
    seen = sfc.loads(data, as_tool=True)
    tasks = [(task.name, [each.name for each in task.instances]) for res in seen.resources() for task in res.tasks]
    assert tasks == [("MainTask", ["Main"])]
    assert not list(sfc.loads(data).resources())
    edited = sfc.loads(data.replace(b'name="MainTask"', b'name="Fast"'))
    assert [task.name for resource in edited.resources() for task in resource.tasks] == ["Fast"]


OPERATED: dict[str, dict[str, Any]] = {
    "both": {"inputs": ("INIT_SQ", "OFF_SQ")},
    "state": {"inputs": ("INIT_SQ", "OFF_SQ"), "outputs": ("S_NO", "S_ACTIVE")},
    "faults": {"inputs": ("INIT_SQ", "ACK_EF"), "acknowledge": True, "rows": ({**ONCE, "event": "V1"},)},
    "rows": {
        "inputs": ("OFF_SQ", "INIT_SQ"),
        "rows": ({**ONCE, "event": "S1"}, {**AGAIN, "qualifier": "S", "event": "S0"}),
    },
}


@pytest.mark.slow
@pytest.mark.parametrize("ends", [False, True], ids=["in a ring", "with an end"])
@pytest.mark.parametrize(("number", "fields"), [*enumerate(OPERATED.values())], ids=[*OPERATED])
def test_a_sequence_is_switched_off_and_begun_again(number: int, fields: dict[str, Any], ends: bool) -> None:
    """One target for each case, all with PLCOPEN_SFC_FULL."""
    source = sequencer(**fields)
    if ends:
        source.pou("Main").chart.transitions[-1].targets = []
        source = as_file(source)
    # actions of CODESYS see other inputs than the conditions before them, which no constant delay makes up for
    targets = ("plcopen-2.01",) if "acknowledge" in fields else (*TARGETS, "codesys23")
    for target in in_turn(targets, number + ends):
        data = sfc.dumps(source, format=target, strict=True)
        result = sfc.loads(data, format=target, as_tool=True)
        verdict = same_behaviour(source, result, operated=fields.get("inputs", ()), outputs=fields.get("outputs", ()))
        assert verdict is not None
        assert verdict.proven, verdict
        if target in TARGETS:
            assert list(differences(source, as_file(sfc.loads(data, format=target)))) == []


@pytest.mark.slow
def test_inputs_that_are_executed_are_operated_where_both_are_run() -> None:
    """In CODESYS actions see other inputs than the conditions before them, and V1 tells that."""
    source = sequencer(**OPERATED["faults"])
    equal = sfc.save(source, io.BytesIO(), format="plcopen-2.01", limit=8, strict=True)
    assert equal.compared["POU Main"].startswith("equal (proof")
    with pytest.raises(sfc.LossError, match="it does something else"):
        sfc.save(source, io.BytesIO(), format="codesys", limit=8, strict=True)
    shifted = sfc.save(source, io.BytesIO(), format="codesys", limit=8).compared["POU Main"]
    first, second = shifted.splitlines()[:2]
    assert first.endswith(SHIFTED)
    assert second.startswith("but for these: equal, second 1 scan later (proof")
    assert "the first gets INIT_SQ 1 scan later" in shifted


def test_the_refusal_tells_how_to_say_that_nobody_operates_an_input() -> None:
    source = sequencer(inputs=("HALT_SQ", "ZERO_OP"))
    with pytest.raises(sfc.LossError, match=r"If HALT_SQ, ZERO_OP .*--at-rest NAME"):
        sfc.dumps(source, format="codesys")


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_what_begins_a_sequence_again_survives_edits(target: str) -> None:
    source = sequencer(inputs=("INIT_SQ", "OFF_SQ"))
    data, _ = sfc.convert(source, target)
    project = sfc.loads(data, format=target)
    project.pou("Main").chart.rename_step("Done", "Ready")
    edited = sfc.dumps(project, format=target)
    assert len(set(edited.splitlines()) - set(data.splitlines())) < 20
    for text in (edited, data.replace(b"INIT_SQ AND NOT OFF", b"INIT_SQ AND c AND NOT OFF")):
        kept = sfc.dumps(sfc.loads(text, format=target), format=target, fresh=True)
        results = [sfc.loads(each, format=target, as_tool=True) for each in (text, kept)]
        same = same_behaviour(*results, operated=("INIT_SQ", "OFF_SQ"))
        assert same is not None
        assert same.proven, same


@pytest.mark.parametrize("target", TARGETS)
def test_nothing_is_added_for_inputs_at_rest(target: str) -> None:
    source = sequencer(inputs=("INIT_SQ", "OFF_SQ"))
    data = sfc.dumps(source, format=target, strict=True, at_rest=["all"])
    assert len(sfc.loads(data, as_tool=True).pou("Main").chart.transitions) == 3
    assert [
        len(sfc.loads(sfc.dumps(source, format=target, at_rest=[name]), as_tool=True).pou("Main").chart.steps)
        for name in ("OFF_SQ", "INIT_SQ")
    ] == [3, 4]


@pytest.mark.parametrize("source", ["simaticml", "plcopen"])
def test_an_end_is_a_step_that_does_nothing(source: str) -> None:
    (feature,) = (each for each in FEATURES if each.name == "end of a sequence")
    original = sfc.loads(sfc.dumps(feature_project(feature, source), format=source), format=source)
    before = original.pou("Main").chart
    data, report = sfc.convert(original, "codesys")
    assert not report.losses
    written = sfc.loads(data, format="codesys", as_tool=True).pou("Main").chart
    assert [step.name for step in written.steps if step.name == "End"] == ["End"]
    back = sfc.loads(data, format="codesys").pou("Main").chart
    assert [step.name for step in back.steps] == [step.name for step in before.steps]
    assert [bool(each.targets) for each in back.transitions].count(False) == 1
    assert (back.graph_settings is None) is (before.graph_settings is None)


@pytest.mark.parametrize("rows", [(), ({"step": "Idle", "target": "r"},)], ids=["alone", "behind the start"])
def test_inputs_that_actions_see_are_told_behind_another_difference(rows: tuple[dict[str, Any], ...]) -> None:
    """A chart that differs from its first scan on hid that its actions see other inputs later."""
    source = sequencer(rows=(*rows, {**AGAIN, "target": "m", "qualifier": "S", "event": "V0"}))
    report = sfc.save(source, io.BytesIO(), format="codesys", limit=8)
    [told] = [item for item in report.losses if item.what == "inputs of actions"]
    assert told.why.startswith("its actions read g: ")
    assert START_OF_CHART not in {item.what for item in report.losses}
