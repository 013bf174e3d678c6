"""Actions that the target executes in another order in a scan: told without a run too."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import LossError
from plcopen_sfc.pages.page_words import german
from plcopen_sfc.report import START_OF_CHART, Item, Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project, variable
from tests.conversion.matrix import converted, same_behaviour

CHART = """PROGRAM Main
VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT n, m : INT; END_VAR
INITIAL_STEP Init: END_STEP
TRANSITION FROM Init TO Run := a; END_TRANSITION
STEP Run: Act({qualifier}); {other}(N); END_STEP
TRANSITION FROM Run TO Init := NOT a; END_TRANSITION
ACTION Act: n := n + 1; END_ACTION
ACTION {other}: {code} END_ACTION
END_PROGRAM
"""


def of_codesys(**words: str) -> sfc.Project:
    project = sfc.loads(CHART.format(**words).encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    return project


def orders(project: sfc.Project, target: str, limit: float = 0) -> list[Item]:
    items = sfc.convert(project, target, limit=limit).report.items
    return [item for item in items if item.what == "order of actions"]


@pytest.mark.parametrize("target", ["codesys", "codesys-export", "twincat", "codesys23"])
def test_an_entry_action_that_another_action_preceded_is_approximated(target: str) -> None:
    project = of_codesys(qualifier="P1", other="Aaa", code="m := m + n;")
    (item,) = orders(project, target)
    assert (item.outcome, item.path) == (Outcome.APPROXIMATED, "POU Main")
    assert item.why == "Act is executed before Aaa in one scan, in the source the other way round (n)"
    assert german(item.why) == "Act wird in einem Zyklus vor Aaa ausgeführt, in der Quelle umgekehrt (n)"
    with pytest.raises(LossError):
        sfc.convert(project, target, limit=0, strict=True)


@pytest.mark.parametrize(
    ("qualifier", "other", "code", "told"),
    [
        ("P0", "Aaa", "m := m + n;", True),
        ("P0", "Zzz", "m := m + n;", True),  # its final scan precedes P0, and follows an exit action
        ("P1", "Zzz", "m := m + n;", False),
        ("P1", "Aaa", "m := m + 1;", False),
        ("N", "Aaa", "m := m + n;", False),
    ],
)
def test_only_orders_that_differ_and_count_are_told(qualifier: str, other: str, code: str, told: bool) -> None:
    project = of_codesys(qualifier=qualifier, other=other, code=code)
    assert bool(orders(project, "codesys")) is told
    report = sfc.convert(project, "codesys", limit=8).report
    causes = [item.why.endswith("a cause is the order of actions, which the report names") for item in report.losses]
    assert any(causes) is told
    assert report.compared["POU Main"].startswith("different" if told else "equal")


@pytest.mark.parametrize(
    ("rows", "back", "executed"),
    [
        (("P1", "", "P0"), "S2", True),
        (("P1", "", "P0"), "S1", False),  # left and entered in one scan
        (("", "P1", "P1"), "S1", False),  # the second is no edge of the action
        (("P1", "", "P1"), "S2", True),
        (("", "P0", "P1"), "S1", False),
        (("P0", "", "P0"), "S2", True),
        (("P1", "", "N"), "S2", True),
        (("P1", "N", ""), "S2", False),
        (("P1", "", "S"), "S2", False),
    ],
)
def test_pulses_of_one_action_are_step_actions_where_no_scan_has_two(
    rows: tuple[str, ...], back: str, executed: bool
) -> None:
    acts = ["", *(f"Count({row});" if row else "" for row in rows)]
    text = f"""FUNCTION_BLOCK Main
        VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR
        INITIAL_STEP S0: END_STEP
        STEP S1: {acts[1]} END_STEP STEP S2: {acts[2]} END_STEP STEP S3: {acts[3]} END_STEP
        TRANSITION FROM S0 TO S1 := a; END_TRANSITION
        TRANSITION FROM S1 TO S2 := b; END_TRANSITION
        TRANSITION FROM S2 TO S3 := a; END_TRANSITION
        TRANSITION FROM S3 TO {back} := b; END_TRANSITION
        ACTION Count: n := (n + 1) MOD 4; END_ACTION
        END_FUNCTION_BLOCK"""
    report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "codesys", partial=True, limit=8).report
    assert (not report.losses) is executed
    assert re.match(r"equal.*\(proof" if executed else "not compared", report.compared["POU Main"])


def test_pulses_of_one_action_in_parallel_steps_are_not_executed() -> None:
    text = """PROGRAM Main
        VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR
        INITIAL_STEP S0: END_STEP
        STEP S1: Count(P1); END_STEP STEP S2: END_STEP STEP S3: Count(P1); END_STEP
        TRANSITION FROM S0 TO (S1, S2) := a; END_TRANSITION
        TRANSITION FROM S2 TO S3 := NOT a; END_TRANSITION
        TRANSITION FROM (S1, S3) TO S0 := a; END_TRANSITION
        ACTION Count: n := n + 1; END_ACTION
        END_PROGRAM"""
    project = sfc.loads(text.encode(), format="iec-text")
    found = sfc.convert(project, "codesys", partial=True).report.with_outcome(Outcome.NOT_EXECUTED)
    assert {item.path.rpartition(" / ")[0] for item in found} == {"POU Main / step S1", "POU Main / step S3"}


def test_an_action_on_a_variable_of_a_list_writes_it() -> None:
    project = of_codesys(qualifier="P1", other="Aaa", code="m := 1;")
    project.global_variables = [m.VariableSection(kind=m.SectionKind.GLOBAL, name="AA", variables=[variable("q")])]
    act = project.pous[0].actions[0]
    assert isinstance(act.body, m.StBody)
    act.body.text = "AA.q := FALSE;"
    project.pous[0].body.chart.steps[1].actions[1].target = "AA.q"
    (item,) = orders(project, "codesys")
    assert item.why == "Act is executed before AA.q in one scan, in the source the other way round (aa.q)"


BY_NAME = """PROGRAM Main
VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT m : INT; END_VAR
INITIAL_STEP Init: {first} END_STEP
TRANSITION FROM Init TO Run := a; END_TRANSITION
STEP Run: {second} END_STEP
TRANSITION FROM Run TO Init := NOT a; END_TRANSITION
ACTION Aa: m := 1; END_ACTION
ACTION Zz: m := 2; END_ACTION
END_PROGRAM
"""


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        ("Zz(N); Aa(N);", "", ("simaticml", "plcopen", "codesys", "twincat")),
        ("Zz(S);", "Aa(N);", ("plcopen", "codesys", "twincat")),
        ("Aa(N); Zz(N);", "", ()),
        ("Zz(N);", "Aa(N);", ()),  # never in one scan but for the final one, which comes first in both
    ],
)
@pytest.mark.parametrize("target", ["simaticml", "plcopen", "codesys", "twincat"])
def test_orders_by_names_and_by_first_use_are_told_without_a_run(
    first: str, second: str, told: tuple[str, ...], target: str
) -> None:
    project = sfc.loads(BY_NAME.format(first=first, second=second).encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS if target in ("plcopen", "simaticml") else m.Dialect.IEC
    assert bool(orders(project, target)) is (target in told)


def with_control(step: str, qualifier: str) -> m.Project:
    def build(rig: FeatureChart) -> None:
        sections = [m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[variable("count", "INT")])]
        turn = m.Action(name="Turn", body=m.StBody(text="count := 3 - count;"))
        interface = m.Interface(sections=sections)
        body = [m.StBody(text=";")]
        kind = m.PouKind.FUNCTION_BLOCK
        rig.project.pous.append(m.Pou(name="Motor", kind=kind, interface=interface, bodies=body, actions=[turn]))
        rig.declare(m.SectionKind.LOCAL, variable("drive", "Motor"))
        rig.act("Work", "drive.Turn", qualifier, **({"duration": "T#20ms"} if qualifier == "D" else {}))
        rig.act("Done", "drive.Turn", "R")
        rig.action("Copy", m.StBody(text="n := drive.count;"))
        rig.act(step, "Copy")

    return feature_project(Feature("x", ("codesys",), build), "codesys")


@pytest.mark.slow
@pytest.mark.parametrize("qualifier", ["S", "D"])
@pytest.mark.parametrize(("step", "told"), [("Done", True), ("Idle", False)])
def test_networks_that_execute_actions_after_the_rows_are_told(step: str, qualifier: str, told: bool) -> None:
    project = with_control(step, qualifier)
    items = orders(project, "simaticml")
    assert [(item.outcome, item.path) for item in items] == [(Outcome.APPROXIMATED, "POU Main")] * told
    for item in items:
        assert item.why == "drive.Turn is executed after Copy in one scan, in the source the other way round (drive)"
        assert german(item.why).startswith("drive.Turn wird in einem Zyklus nach Copy ausgeführt")
    compared = sfc.convert(project, "simaticml", limit=8).report.compared
    assert compared["POU Main"].startswith("different" if told else "equal")


@pytest.mark.parametrize("target", ["plcopen-2.01", "iec-text", pytest.param("simaticml", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("one", "other"),
    [
        (("entry", "Idle"), ("exit", "Done")),
        (("main", "Idle"), ("exit", "Done")),
        (("entry", "Work"), ("row", "Work")),
        (("exit", "Idle"), ("row", "Work")),
        (("exit", "Work"), ("entry", "Done")),
        (("main", "Idle"), ("exit", "Idle")),
        (("main", "Idle"), ("entry", "Work")),
    ],
)
def test_orders_of_step_actions_of_codesys_are_kept_or_told(
    one: tuple[str, str], other: tuple[str, str], target: str
) -> None:
    for names in (("Aa", "Bb"), ("Bb", "Aa")):

        def build(rig: FeatureChart, names: tuple[str, str] = names) -> None:
            for name, value in zip(names, ("0; ELSE n := n + 1", "1; ELSE n := n * 2"), strict=True):
                text = f"IF n > 2 THEN n := {value}; END_IF"  # few states, which all can be compared
                rig.action(name, m.StBody(text=text))
            for (kind, step), name in zip((one, other), names, strict=True):
                if kind == "row":
                    rig.act(step, name)
                else:
                    setattr(rig.chart.step(step), f"{kind}_action", name)

        project = feature_project(Feature("x", ("codesys",), build), "codesys")
        result, report = converted(project, target)
        verdict = same_behaviour(project, result)
        assert verdict is not None
        losses = [item for item in report.losses if item.what != START_OF_CHART]  # which the comparison allows for
        assert bool(losses) is not verdict.equal, f"{names}: {losses}, {verdict}"
