"""The faults that textbook chains have are found, each with the shortest inputs that show it; and no others are."""

from __future__ import annotations

import json
from random import Random

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.lowering import Fault, FaultKind, LoweredPou, lower
from plcopen_sfc.lowering.faults.fault_search import find_faults
from plcopen_sfc.lowering.reading.chart_reading import read_chart
from plcopen_sfc.semantics.subjects import Subject, resolve
from tests.analysis.nets import block_chart
from tests.lowering.charts import act, pou_with, training_chain

FLIP_FLOPS = [FaultKind.OVERLAP, FaultKind.RUN_THROUGH]
USUAL = [*FLIP_FLOPS, FaultKind.INIT_EMPTIES]
"""Of a chain with an input that starts it again."""


def lowered(pou: m.Pou, construction: str, **options: str) -> LoweredPou:
    return lower(m.Project(pous=[pou]), construction, style="classic", **{"language": "ST", **options})


def faults(pou: m.Pou, construction: str, **options: str) -> dict[FaultKind, Fault]:
    return {fault.kind: fault for fault in lowered(pou, construction, **options).faults}


def ring(*conditions: str, driven: tuple[int, ...] = (1,)) -> m.Pou:
    """A chain of as many steps as conditions, closed to a ring; Q in the steps with the numbers `driven`."""
    chart = m.SfcNetwork()
    steps = [chart.add_step(f"S{number}", initial=number == 1) for number in range(1, len(conditions) + 1)]
    for number, condition in enumerate(conditions):
        chart.add_transition(steps[number], steps[(number + 1) % len(steps)], condition)
    for number in driven:
        act(chart, steps[number - 1], "Q")
    return pou_with(chart)


def chart_of(pou: m.Pou) -> m.SfcNetwork:
    assert pou.sfc is not None
    return pou.sfc


def table(fault: Fault) -> list[str]:
    return [" ".join(line.split()) for line in fault.table()]


HEADER = "scan | inputs | chart | code"


# -- flip-flops


def test_the_training_chain_as_flip_flops_overlaps_and_runs_through() -> None:
    found = faults(training_chain(), "fup")
    assert list(found) == USUAL
    overlap, through, empties = found.values()
    assert (overlap.place, overlap.shortest) == (("S1", "S2"), True)
    assert overlap.others == (("S2", "S3"), ("S3", "S4"))  # S4 is behind S1, which resets it in the same scan
    assert table(overlap) == [HEADER, "1 | B1 | S2 | S1 S2"]
    assert (through.place, through.shortest) == (("S1", "S2", "S3"), True)
    assert table(through) == [HEADER, "1 | B1 B2 | S2 | S1 S2 S3"]
    assert empties.place == ("S1", "S2")
    assert table(empties) == [HEADER, "1 | B1 | S2 | S1 S2", "2 | Init | S1 | -"]


@pytest.mark.parametrize("language", ["FBD", "LD", "ST", "IL"])
def test_all_languages_have_the_same_faults(language: str) -> None:
    waiting = [] if language in ("ST", "IL") else [FaultKind.NOT_STARTED]  # the blocks keep their own value
    assert list(faults(training_chain(), "fup", language=language)) == [*USUAL, *waiting]


@pytest.mark.parametrize("language", ["FBD", "LD", "ST", "IL"])
def test_without_an_input_to_start_it_the_first_scan_starts_the_chain(language: str) -> None:
    assert list(faults(training_chain(), "fup", language=language, init="")) == FLIP_FLOPS


def test_two_steps_that_lead_to_each_other_block() -> None:
    found = faults(ring("a", "b"), "fup")
    assert list(found) == [FaultKind.BLOCKED_LOOP]
    assert (found[FaultKind.BLOCKED_LOOP].place, found[FaultKind.BLOCKED_LOOP].shortest) == (("S1", "S2"), True)
    assert table(found[FaultKind.BLOCKED_LOOP]) == [HEADER, "1 | a | S2 | S1"]


@pytest.mark.slow
def test_a_loop_far_down_a_long_chain_is_found_too() -> None:
    pou = ring(*(f"c{number}" for number in range(30)))
    steps = chart_of(pou).steps
    chart_of(pou).add_transition(steps[28], steps[27], "back")
    found = faults(pou, "fup")[FaultKind.BLOCKED_LOOP]
    assert found.place == ("S28", "S29")
    assert not found.shortest
    assert [scan.code for scan in found.trace[-2:]] == [("S27", "S28"), ("S28",)]
    assert found.trace[-1].chart == ("S29",)


def test_a_step_that_leads_to_itself_ends_at_once() -> None:
    pou = ring("a", "b", "c")
    steps = chart_of(pou).steps
    chart_of(pou).add_transition(steps[1], steps[1], "again")
    found = faults(pou, "fup")[FaultKind.LOST]
    assert found.place == ("S2",)
    assert table(found) == [HEADER, "1 | a | S2 | S1 S2", "2 | - | S2 | -"]


def test_a_selection_without_priorities_activates_both_legs() -> None:
    chart = m.SfcNetwork()
    wait, left, right = chart.add_step("Wait", initial=True), chart.add_step("Left"), chart.add_step("Right")
    for step, condition in ((left, "l"), (right, "r")):
        chart.add_transition(wait, step, condition)
        act(chart, step, f"q{condition}")
    end = chart.add_step("End")
    chart.add_transition(left, end, "e")
    chart.add_transition(right, end, "e")
    chart.add_transition(end, wait, "w")
    found = faults(pou_with(chart), "fup")[FaultKind.DUPLICATED]
    assert found.place == ("Wait", "Left", "Right")
    assert table(found) == [HEADER, "1 | l r | Left | Wait Left Right"]
    exclusive = chart.transitions[1]
    exclusive.condition = m.Expression(text="r AND NOT l")
    assert FaultKind.DUPLICATED not in faults(pou_with(chart), "fup")


def test_steps_of_simultaneous_branches_do_not_overlap() -> None:
    chart = m.SfcNetwork()
    begin, a, b, end = (chart.add_step(name, initial=name == "Begin") for name in ("Begin", "A", "B", "End"))
    chart.add_transition(begin, [a, b], "x")
    chart.add_transition([a, b], end, "y")
    chart.add_transition(end, begin, "z")
    for step in chart.steps:
        act(chart, step, f"q{step.name}")
    found = faults(pou_with(chart), "fup")
    assert found[FaultKind.OVERLAP].place == ("Begin", "A")
    assert ("A", "B") not in found[FaultKind.OVERLAP].others


def test_conditions_with_times_and_numbers_are_followed() -> None:
    pou = ring("S1.T >= T#30ms", "level > 5", "c", "c")
    pou.interface.sections[0].variables = [  # type: ignore[union-attr]
        m.Variable(name="level", type=m.ElementaryType(name=m.Elementary.INT)),
        m.Variable(name="c", type=m.ElementaryType(name=m.Elementary.BOOL)),
    ]
    found = faults(pou, "fup", init="")
    assert list(found) == FLIP_FLOPS
    assert found[FaultKind.RUN_THROUGH].shortest
    assert found[FaultKind.RUN_THROUGH].trace[-1].inputs["level"] == 6
    assert len(found[FaultKind.OVERLAP].trace) == 3  # 15 ms a scan: 30 ms are over in the third


@pytest.mark.parametrize(
    "options",
    [{"flags": "M20.0"}, {"flags": "Merker", "target": "simaticml"}, {"actions": "block"}, {"stop": "NOT NotAus"}],
)
def test_faults_are_found_wherever_the_flags_are(options: dict[str, str]) -> None:
    found = faults(training_chain(), "fup", language="FBD", **options)
    assert [kind for kind in found if kind is not FaultKind.NOT_STARTED] == USUAL


def test_the_query_of_the_step_before_the_last_ends_the_running_through() -> None:
    """Which textbooks add for stepping by hand; neighbours still overlap."""
    project = m.Project(pous=[training_chain()])
    stepped = lower(project, "fup", style="classic", language="ST", modes=["single-step"])
    assert [fault.kind for fault in stepped.faults] == [FaultKind.OVERLAP, FaultKind.INIT_EMPTIES]


# -- CASE


def test_outputs_of_a_case_are_late_swallowed_or_stuck() -> None:
    found = faults(training_chain(), "case")
    kinds = [FaultKind.SHIFTED, FaultKind.SWALLOWED, FaultKind.STUCK, FaultKind.INIT_IGNORED, FaultKind.LATE]
    assert list(found) == kinds
    assert found[FaultKind.LATE].place == ("S2", "Q2")
    assert table(found[FaultKind.SHIFTED])[-1] == "4 | B4 | S1 1 | S1 0"
    assert found[FaultKind.SWALLOWED].place == ("S1", "Q1")
    assert table(found[FaultKind.SWALLOWED])[-2:] == ["4 | B4 | S1 1 | S1 0", "5 | B1 | S2 0 | S2 0"]
    assert found[FaultKind.STUCK].place == ("S3", "Q3")
    assert table(found[FaultKind.STUCK])[-1] == "4 | Init | S1 0 | S1 1"
    assert table(found[FaultKind.INIT_IGNORED]) == [HEADER, "1 | B1 Init | S1 | S2"]


@pytest.mark.slow
def test_code_of_a_step_is_executed_a_scan_late() -> None:
    pou = ring("a", "b", "c")
    chart_of(pou).steps[1].actions.append(
        m.ActionAssociation(id=chart_of(pou).new_id(), body=m.StBody(text="n := n + 1;"))
    )
    local = m.Variable(name="n", type=m.ElementaryType(name=m.Elementary.INT))
    pou.interface.sections.append(m.VariableSection(variables=[local]))  # type: ignore[union-attr]
    found = faults(pou, "case")[FaultKind.LATE]
    assert found.place[0] == "S2"
    assert table(found) == [HEADER, "1 | a | S2 | S2"]
    assert FaultKind.LATE not in faults(pou, "case", profile="codesys")


def test_a_step_alone_that_leads_to_itself_is_lost_at_once() -> None:
    chart = m.SfcNetwork()
    only = chart.add_step("S1", initial=True)
    chart.add_transition(only, only, "a")
    act(chart, only, "Q")
    assert list(faults(pou_with(chart), "fup", init="")) == [FaultKind.LOST]
    assert list(faults(pou_with(chart), "fup")) == [FaultKind.LOST, FaultKind.NOT_STARTED]  # until, and a scan long


def test_an_output_of_two_neighbours_has_a_gap() -> None:
    found = faults(ring("a", "b", "c", driven=(1, 2)), "case")
    assert found[FaultKind.GAP].place == ("S1", "S2", "Q")
    assert table(found[FaultKind.GAP]) == ["scan | inputs | chart Q | code Q", "1 | a | S2 1 | S2 0"]


def test_under_codesys_outputs_of_a_case_end_early() -> None:
    found = faults(training_chain(), "case", profile="codesys")[FaultKind.SHIFTED]
    assert table(found) == ["scan | inputs | chart Q1 | code Q1", "1 | B1 | S1 1 | S2 0"]


# -- GRAFCET


@pytest.mark.parametrize("construction", ["case", "fup"])
def test_textbook_code_of_a_grafcet_does_not_search_for_stability(construction: str) -> None:
    found = faults(ring("a", "b", "c"), construction, profile="grafcet")
    assert FaultKind.RUN_THROUGH not in found  # the chart does so too
    late = found[FaultKind.NOT_STABLE]
    assert (late.place, late.shortest) == (("S2", "S3"), True)
    assert [scan.chart for scan in late.trace] == [("S3",)]
    assert "S3" not in late.trace[0].code


# -- reports


def test_a_fault_as_text_as_data_and_as_finding() -> None:
    result = lowered(training_chain(), "fup")
    empties = result.faults[-1]
    assert str(empties).splitlines() == [
        "LOW104: an initialisation of one scan leaves no initial step active: S1, S2",
        "  The initial step is reset by the step behind it, still active in that scan; then that is reset too.",
        "  scan | inputs | chart | code",
        "  1    | B1     | S2    | S1 S2",
        "  2    | Init   | S1    | -",
    ]
    assert str(empties) in str(result)
    data = json.loads(json.dumps(result.as_dict()))
    assert [fault["code"] for fault in data["faults"]] == ["LOW101", "LOW102", "LOW104"]
    assert data["faults"][-1]["place"] == ["S1", "S2"]
    assert data["faults"][-1]["trace"][-1] == {
        "inputs": {"B1": False, "B2": False, "Init": True},
        "chart": {"active": ["S1"], "outputs": {}, "stable": True},
        "code": {"active": [], "outputs": {}},
    }
    finding = empties.diagnostic("Ablauf")
    assert (finding.code, finding.severity, str(finding.location)) == ("LOW104", Severity.WARNING, "Ablauf")


def test_codes_are_unique() -> None:
    codes = [kind.code for kind in FaultKind]
    assert len(set(codes)) == len(codes)
    assert codes == sorted(codes)


# -- neither too many nor too few


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("construction", ["flipflop", "case"])
def test_textbook_code_is_different_just_where_it_has_faults_and_exact_code_has_none(
    construction: str, seed: int
) -> None:
    random = Random(seed)  # noqa: S311
    chart = block_chart(seed, 7)
    for number, transition in enumerate(chart.transitions, 1):
        transition.condition = m.Expression(text=f"c{number}")
    for step in chart.steps:
        if random.random() < 0.6:
            act(chart, step, random.choice(["q1", "q2"]))
    project = m.Project(pous=[pou_with(chart)])
    if construction == "case" and any(len(t.sources) + len(t.targets) > 2 for t in chart.transitions):
        pytest.skip("several steps are active at a time")
    textbook = lower(project, construction, style="classic", language="ST")
    assert textbook.proof is not None
    assert (textbook.proof.kind is VerdictKind.DIFFERENT) == bool(textbook.faults)
    exact = lower(project, construction, language="ST", init="Init", verify=False)
    assert not same_rules(resolve(project), exact)


def same_rules(chart: Subject, code: LoweredPou) -> tuple[Fault, ...]:
    """Faults that the search finds in exact code."""
    network = chart.pou.sfc
    assert network is not None
    return find_faults(
        chart,
        Subject(code.project, code.pou, chart.name),
        read_chart(chart.pou, network, chart.project.dialect, code.profile),
        code.rules,
        situation=code.situation,
        at_rest=code.at_rest,
        left_out=code.left_out,
    )
