"""SFC flags of CODESYS in blocks of S7-GRAPH: conditions of transitions that obey them, proven by running both."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.analysis.pairing import Delay
from plcopen_sfc.languages.networks import draw_ld
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.profile import default_profile
from tests.conversion.features import FEATURES, feature_project
from tests.conversion.matrix import same_behaviour
from tests.samples import FIXTURES

RETIMED = Delay(-1, retimed=True)
FLAGS = ("SFCInit", "SFCReset", "SFCPause")
CHART = """
PROGRAM Main
VAR_INPUT {flags} a, b, g : BOOL; END_VAR
VAR_OUTPUT q, r : BOOL; n : INT; END_VAR
{chart}
END_PROGRAM
"""
PLAIN = """
INITIAL_STEP Idle: {idle} END_STEP
STEP Work: {work} END_STEP
STEP Done: r(N); END_STEP
TRANSITION FROM Idle TO Work := a; END_TRANSITION
TRANSITION FROM Idle TO Done := b; END_TRANSITION
TRANSITION FROM Work TO Done := b OR g; END_TRANSITION
TRANSITION FROM Done TO Idle := g; END_TRANSITION
{actions}
"""
RING = """
INITIAL_STEP Idle: END_STEP
STEP Work: q(N); END_STEP
TRANSITION FROM Idle TO Work := a; END_TRANSITION
TRANSITION FROM Work TO Idle := b; END_TRANSITION
"""
BRANCHES = """
INITIAL_STEP Idle: END_STEP
STEP Left: q(N); END_STEP
STEP Right: r(N); END_STEP
TRANSITION FROM Idle TO (Left, Right) := a; END_TRANSITION
TRANSITION FROM (Left, Right) TO Idle := b; END_TRANSITION
"""


def chart_with(*flags: str, chart: str = PLAIN, idle: str = "", work: str = "q(N);", actions: str = "") -> m.Project:
    """A program of CODESYS with these flags as inputs."""
    declared = "".join(f"{flag} : BOOL; " for flag in flags)
    text = CHART.format(flags=declared, chart=chart.format(idle=idle, work=work, actions=actions))
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    return sfc.loads(sfc.dumps(project, format="codesys", partial=True), format="codesys")


def converted(source: m.Project, target: str = "simaticml") -> tuple[bytes, ConversionReport]:
    data, report = sfc.convert(source, target, partial=True)
    return data, report


def prove_whole(source: m.Project) -> bytes:
    """Convert a project of which all is executed in TIA Portal, and prove it; gives the file."""
    data, report = converted(source)
    assert losses(report) == beside(source)
    seen = sfc.loads(data, format="simaticml", as_tool=True)
    verdict = same_behaviour(source, seen, later_inputs=bool(beside(source)))
    assert verdict is not None
    assert verdict.proven, verdict
    return data


def beside(source: m.Project) -> list[tuple[str, str, str]]:
    """The losses of a chart with flags that stop it, or a push and flags that end: what comes with them in one scan."""
    flags = {variable.name for variable in source.pou("Main").variables()}
    pairs = ({"SFCPause", "SFCQuitError"}, set()), ({"SFCInit"}, {"SFCTip"})
    return [
        ("approximated", "simultaneous inputs", "POU Main")
        for any_of, all_of in pairs
        if flags & any_of and flags >= all_of
    ]


def losses(report: ConversionReport) -> list[tuple[str, str, str]]:
    return [(item.outcome.value, item.what, item.path) for item in report.losses]


@pytest.mark.slow
@pytest.mark.parametrize("flags", [FLAGS, FLAGS[:2]], ids=" ".join)
def test_flags_are_obeyed(flags: tuple[str, ...]) -> None:
    source = chart_with(*flags)
    prove_whole(source)


def test_flags_of_a_file_that_names_its_tool_are_obeyed() -> None:
    """The statements for flags belong to the copy that is written, which was copied once more for such a file."""
    source = chart_with("SFCPause")
    source.header.product = "CODESYS"
    data, report = converted(source)
    assert losses(report) == beside(source)
    seen = sfc.loads(data, format="simaticml", as_tool=True).pou("Main")
    assert seen.chart.permanent_post
    assert "SFC_stops" in {variable.name for variable in seen.variables()}
    assert len(sfc.loads(data, format="simaticml").pou("Main").chart.transitions) == 4


@pytest.mark.parametrize("flags", [("SFCInit",), ("SFCInit", "SFCPause")], ids=" ".join)
def test_nothing_of_the_initial_step_is_executed_during_sfcinit(flags: tuple[str, ...]) -> None:
    source = chart_with(*flags, idle="q(N);", work="")
    data, report = converted(source)
    assert losses(report) == beside(source)
    seen = sfc.loads(data, format="simaticml", as_tool=True)
    assert [step.name for step in seen.pou("Main").chart.steps][-1] == "SFCInit_holds"
    profiles = (default_profile(source), default_profile(seen))
    subjects = (source.pou("Main"), seen.pou("Main"))
    inputs = {flag: flag for flag in flags}
    # its step flag is FALSE then: of nothing else is there a difference
    assert equivalent(*subjects, profiles, delay=RETIMED, inputs=inputs, step_flags={}).proven
    example = equivalent(*subjects, profiles, delay=RETIMED, inputs=inputs).counterexample
    assert example is not None
    assert {difference.name for difference in example.differences} == {"Idle.X"}


@pytest.mark.slow
def test_a_pause_holds_simultaneous_branches() -> None:
    source = chart_with("SFCPause", chart=BRANCHES)
    prove_whole(source)


@pytest.mark.slow
@pytest.mark.parametrize("chart", [PLAIN, BRANCHES])
@pytest.mark.parametrize("flags", [("SFCTipMode",), ("SFCTip",), ("SFCTip", "SFCTipMode")], ids=" ".join)
def test_a_chart_is_stepped_through(flags: tuple[str, ...], chart: str) -> None:
    source = chart_with(*flags, chart=chart)
    prove_whole(source)


@pytest.mark.slow
@pytest.mark.parametrize("others", [("SFCInit",), ("SFCReset",), ("SFCPause",), FLAGS], ids=" ".join)
def test_a_push_counts_where_transitions_are_tested(others: tuple[str, ...]) -> None:
    source = chart_with("SFCTip", *others)
    prove_whole(source)


@pytest.mark.parametrize(
    ("flags", "is_other"),
    [(("SFCInit",), False), (("SFCPause",), True), (("SFCTip", "SFCReset"), False), (("SFCTip", "SFCInit"), True)],
)
def test_what_comes_with_a_flag_is_told_where_it_matters(flags: tuple[str, ...], *, is_other: bool) -> None:
    source = chart_with(*flags, chart=RING)
    data, report = converted(source)
    verdict = same_behaviour(source, sfc.loads(data, format="simaticml", as_tool=True))
    assert verdict is not None
    assert verdict.different is is_other
    assert bool(losses(report)) is is_other


@pytest.mark.slow
@pytest.mark.parametrize("work", ["q(S);", "q(SD, T#20ms);"])
@pytest.mark.parametrize("flags", [("SFCInit",), ("SFCReset",)], ids=" ".join)
def test_what_is_stored_ends(flags: tuple[str, ...], work: str) -> None:
    source = chart_with(*flags, work=work)
    prove_whole(source)


def test_a_push_fires_conditions_that_are_never_true() -> None:
    """Transitions with FALSE were told as ones that TIA Portal executes and the source does not."""
    source = chart_with("SFCTip", chart=PLAIN.replace(":= b OR g;", ":= FALSE;"))
    prove_whole(source)


PUSHED = """
INITIAL_STEP Idle: END_STEP
STEP Work: Push(N); END_STEP
STEP Done: END_STEP
TRANSITION FROM Idle TO Work := a; END_TRANSITION
TRANSITION FROM Work TO Done := FALSE; END_TRANSITION
TRANSITION FROM Done TO Idle := b; END_TRANSITION
ACTION Push:
r := g; SFCTip := g;
END_ACTION
"""


@pytest.mark.slow
@pytest.mark.parametrize("is_declared", [True, False])
def test_an_action_may_push(is_declared: bool) -> None:
    """A memory that was set behind the action hid the edge; a flag that only the tool declares was another variable.

    In TC6 no order of actions is certain: there it is refused.
    """
    source = chart_with("SFCTip", chart=PUSHED)
    (pou,) = source.pous
    assert pou.chart is not None
    if not is_declared:
        assert pou.interface is not None
        for section in pou.interface.sections:
            section.variables = [each for each in section.variables if each.name != "SFCTip"]
        pou.chart.settings = m.SfcSettings(flags={m.SfcFlag.TIP: m.FlagUse(use=True, declare=True)})
        assert pou.implicit_flags() == {"SFCTip"}
    data, report = converted(source)
    assert losses(report) == [("approximated", "inputs of actions", "POU Main")]
    verdict = same_behaviour(source, sfc.loads(data, as_tool=True), later_inputs=True)
    assert verdict is not None
    assert verdict.proven, verdict
    _, report = converted(source, "plcopen-2.01")
    assert ("not executed", "operating input", "POU Main / SFCTip") in losses(report)


TOGGLE = "ACTION Toggle: q := NOT q; END_ACTION "
USED_ELSEWHERE = f"{TOGGLE} ACTION Other: Toggle(); END_ACTION"
"""An action of which the statements may not ask the flags of one step, for other code executes them, too."""


@pytest.mark.slow
@pytest.mark.parametrize(
    "work",
    ["D, T#20ms", "L, T#20ms", "SD, T#20ms", "DS, T#20ms", "SL, T#20ms", "P", "P1", "P0"],
)
@pytest.mark.parametrize("flags", [("SFCPause",), FLAGS[:2]], ids=" ".join)
def test_actions_with_a_time_or_an_edge_stop_and_end(flags: tuple[str, ...], work: str) -> None:
    """Rows of S7-GRAPH go on during SFCPause: what is delayed would begin, and what is limited would end."""
    source = chart_with(*flags, work=f"q({work});")
    prove_whole(source)


@pytest.mark.slow
@pytest.mark.parametrize("work", ["N", "P", "P0", "D, T#20ms", "S"])
@pytest.mark.parametrize("flag", FLAGS)
@pytest.mark.parametrize("language", ["ST", "LD"])
def test_code_of_actions_stops_and_ends(flag: str, work: str, language: str) -> None:
    source = chart_with(flag, work=f"Toggle({work});", actions=TOGGLE)
    if language == "LD":
        source.pou("Main").actions[0].body = draw_ld(parse_statements("q := NOT q;").tree.statements).body
    prove_whole(source)


@pytest.mark.slow
@pytest.mark.parametrize("flag", FLAGS)
def test_actions_of_steps_stop_and_end(flag: str) -> None:
    source = chart_with(flag)
    step = source.pou("Main").chart.step("Work")
    step.entry_action, step.main_action, step.exit_action = (
        m.StBody(text=f"n := (n + {each}) MOD 5;") for each in (1, 2, 3)
    )
    data = prove_whole(source)
    back = sfc.loads(data, format="simaticml").pou("Main").chart.step("Work")
    assert "SFC" not in f"{back.entry_action!r} {back.main_action!r} {back.exit_action!r}"


def test_actions_whose_statements_ask_the_flags_come_back() -> None:
    source = chart_with(*FLAGS, work="Toggle(N);", actions=TOGGLE)
    data, _ = converted(source)
    assert b"SFCReset" in data
    back = sfc.loads(data, format="simaticml").pou("Main").actions[0].body
    assert isinstance(back, m.StBody)
    assert "SFC" not in back.text


def test_what_a_step_executes_at_its_end_is_told() -> None:
    source = chart_with("SFCReset", work="Toggle(N);", actions=USED_ELSEWHERE)
    report = converted(source)[1]
    assert losses(report) == [("approximated", "end of the step", "POU Main / step Work")]


@pytest.mark.parametrize(
    ("flag", "fields", "why"),
    [
        ("SFCReset", {"chart": BRANCHES}, "several of its steps may be active at a time"),
        ("SFCReset", {"work": "q(S);", "idle": "q(R);"}, "stored or delayed"),
        ("SFCInit", {"work": "q(SD, T#1s);", "idle": "q(SD, T#1s);"}, "stored or delayed"),
        ("SFCReset", {"idle": "Toggle(SD, T#1s);", "actions": TOGGLE}, "stored or delayed"),
        ("SFCPause", {"work": "Toggle(N);", "actions": USED_ELSEWHERE}, "the actions of the step Work go on"),
    ],
)
def test_flags_without_a_counterpart_are_refused(flag: str, fields: dict[str, str], why: str) -> None:
    report = converted(chart_with(flag, **fields))[1]
    (item,) = [item for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.path.endswith(flag)]
    assert why in item.why
    assert item.what == "operating input"
    rested = sfc.convert(chart_with(flag, **fields), "simaticml", partial=True, at_rest=[flag])[1]
    assert not [item for item in rested.losses if item.path.endswith(flag)]


@pytest.mark.parametrize(
    ("name", "refused"),
    [("distribution_belt", []), ("device_export", []), ("sorting_conveyor", ["POU PLC_PRG / SFCReset"])],
)
def test_flags_of_whole_machines_are_executed(name: str, refused: list[str], tmp_path: Path) -> None:
    project = sfc.load(FIXTURES / "codesys" / f"{name}.xml")
    report = sfc.save(project, f"{tmp_path}/out/", format="simaticml", partial=True, limit=0)
    assert [item.path for item in report.with_outcome(Outcome.NOT_EXECUTED)] == refused


def test_an_error_is_quitted() -> None:
    """SFCError falls, the chart stands still, and the maximum time begins again."""
    feature = next(each for each in FEATURES if each.name == "SFCQuitError")
    source = sfc.loads(sfc.dumps(feature_project(feature, "codesys"), format="codesys", partial=True), format="codesys")
    data, report = converted(source)
    assert losses(report) == [*beside(source), ("approximated", "max time", "POU Main / step Work")]
    seen = sfc.loads(data, format="simaticml", as_tool=True)

    def inputs(scan: int, _values: object) -> dict[str, object]:
        return {"a": True, "b": scan in (25, 26), "c": True, "SFCQuitError": scan in (9, 10, 15)}

    before, now = (sfc.simulate(each, pou="Main", inputs=inputs, scans=40) for each in (source, seen))
    assert list(before["SFCError"]) == list(now["SFCError"])
    assert [scan for scan in range(1, 40) if now["SFCError"][scan] and not now["SFCError"][scan - 1]] == [5, 20]
    assert list(before["q"])[20:] == list(now["q"])[19:-1]  # CODESYS shows a step a scan later


def test_an_error_that_a_caller_sets_is_not_quitted() -> None:
    report = converted(chart_with("SFCError", "SFCQuitError"))[1]
    (why,) = [item.why for item in report.losses if item.path.endswith("SFCQuitError")]
    assert why.endswith("SFCError is an input")


@pytest.mark.parametrize("language", ["ST", "LD", "IL"])
def test_no_flag_ends_what_code_writes_too(language: str) -> None:
    """A coil and an instruction write a stored operand as an assignment does."""
    source = chart_with("SFCInit", work="q(S);", actions="ACTION Act: q := g; END_ACTION")
    action = source.pou("Main").actions[0]
    if language == "LD":
        action.body = draw_ld(parse_statements("q := g;").tree.statements).body
    if language == "IL":
        action.body = m.IlBody(text="LD g\nST q")
    _, report = converted(source)
    assert any("stored or delayed" in each.why for each in report.losses if "SFCInit" in each.path), report.losses


@pytest.mark.slow
def test_the_source_comes_back_and_an_edit_is_written_in_its_terms() -> None:
    source = chart_with(*FLAGS)
    data, _ = converted(source)
    back = sfc.loads(data, format="simaticml")
    chart = back.pou("Main").chart
    assert [step.name for step in chart.steps] == ["Idle", "Work", "Done"]
    assert len(chart.transitions) == 4
    assert [variable.name for variable in back.pou("Main").variables()] == [
        variable.name for variable in source.pou("Main").variables()
    ]
    chart.rename_step("Work", "Fill")
    edited = io.BytesIO()
    sfc.save(back, edited, format="simaticml")
    seen = sfc.loads(edited.getvalue(), format="simaticml", as_tool=True)
    assert "Fill_to_Idle" in {transition.name for transition in seen.pou("Main").chart.transitions}
    again = sfc.loads(edited.getvalue(), format="simaticml").pou("Main").chart
    assert [step.name for step in again.steps] == ["Idle", "Fill", "Done"]


def test_the_source_comes_back_from_a_folder(tmp_path: Path) -> None:
    """Documents of a folder had the variables for the flags as if they were of the source, and told steps as lost."""
    source = chart_with("SFCInit", "SFCTip")
    report = sfc.save(source, f"{tmp_path}/out/", format="simaticml", partial=True, limit=0)
    assert report.with_outcome(Outcome.DROPPED) == []
    back = sfc.load(tmp_path / "out").pou("Main")
    assert [variable.name for variable in back.variables()] == [each.name for each in source.pou("Main").variables()]
    assert [step.name for step in back.chart.steps] == ["Idle", "Work", "Done"]


def test_an_edit_of_the_written_chart_counts() -> None:
    data, _ = converted(chart_with(*FLAGS))
    edited = data.replace(b'Name="Work"', b'Name="Fill"')
    back = sfc.loads(edited, format="simaticml")
    chart = back.pou("Main").chart
    assert "Fill" in {step.name for step in chart.steps}
    assert len(chart.transitions) == 6  # two of them for the flags
    assert chart.permanent_post
    assert {"SFC_stops", "SFCInit_before"} <= {variable.name for variable in back.pou("Main").variables()}
    assert "XML214" in {found.code for found in back.diagnostics}


def test_flags_that_only_the_source_tool_declares_are_variables() -> None:
    source = chart_with()
    flag = m.SfcFlag.RESET
    source.pou("Main").chart.settings = m.SfcSettings(flags={flag: m.FlagUse(use=True, declare=True)})
    data, report = converted(source)
    assert losses(report) == beside(source)
    seen = sfc.loads(data, format="simaticml", as_tool=True)
    assert "SFCReset" in {variable.name for variable in seen.pou("Main").variables()}
    back = sfc.loads(data, format="simaticml").pou("Main")
    assert "SFCReset" not in {variable.name for variable in back.variables()}
    assert back.chart.settings == source.pou("Main").chart.settings


def test_flags_of_charts_in_actions_have_their_memories_in_the_blocks_for_these() -> None:
    text = CHART.format(
        flags="SFCInit, SFCReset,",
        chart="INITIAL_STEP Idle: END_STEP STEP Work: Inner(N); Other(N); END_STEP"
        " TRANSITION FROM Idle TO Work := a; END_TRANSITION TRANSITION FROM Work TO Idle := g; END_TRANSITION",
    )
    project = sfc.loads(text.encode(), format="iec-text")
    for name, target in (("Inner", "q"), ("Other", "r")):
        chart = m.SfcNetwork()
        first, second = chart.add_step(f"{name}_1", initial=True), chart.add_step(f"{name}_2")
        chart.add_transition(first, second, "b")
        chart.add_transition(second, first, "NOT b")
        second.actions.append(m.ActionAssociation(id=chart.new_id(), target=target, qualifier="S"))
        project.pou("Main").actions.append(m.Action(name=name, body=m.SfcBody(chart=chart)))
    project.origin = "codesys"
    converted = sfc.convert(project, "simaticml", limit=1)
    assert not converted.report.with_outcome(Outcome.NOT_EXECUTED)
    told = "not compared: in TIA Portal it is no chart of an action, and its POU runs what is in its place"
    assert converted.report.compared["POU Main / action Inner"] == told
    blocks = {pou.name: [v.name for v in pou.variables()] for pou in sfc.loads(converted.data, as_tool=True).pous}
    assert "SFCReset_before" in blocks["Main_Inner"]
    assert "SFCReset_before_2" in blocks["Main_Other"]
