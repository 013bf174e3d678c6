"""The items of a report are what an engineer would find by comparing the source with the written file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.pages.page_words import german
from plcopen_sfc.report import Cause, CauseKind, Item, Outcome, grouped_by_reason
from tests.conversion.features import drawn
from tests.samples import FIXTURES

CHART = """{declared}FUNCTION_BLOCK Main
VAR_INPUT a, b, c : BOOL; END_VAR
VAR_OUTPUT q, r : BOOL; END_VAR
VAR n : INT; END_VAR
{chart}
END_FUNCTION_BLOCK
"""
PAIR = """INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := {condition}; END_TRANSITION
STEP S1: {actions} END_STEP
TRANSITION FROM S1 TO S0 := b; END_TRANSITION
"""


def project(chart: str, declared: str = "") -> m.Project:
    return sfc.loads(CHART.format(chart=chart, declared=declared).encode(), format="iec-text")


def losses(source: m.Project, target: str = "simaticml") -> list[Item]:
    """The losses of a conversion, but for those of the block around the chart."""
    report = sfc.convert(source, target, partial=True)[1]
    return [item for item in report.losses if item.what not in ("program", "task")]


def chart_of(source: m.Project) -> m.SfcNetwork:
    return next(source.charts()).chart


def test_rows_of_one_operand_are_compared_by_what_they_do() -> None:
    source = project(PAIR.format(condition="a", actions="q(N);"))
    step = chart_of(source).step("S1")
    step.entry_action = m.StBody(text="q := a;")
    step.exit_action = m.StBody(text="q := b;")
    source.dialect = m.Dialect.CODESYS
    found = losses(source)  # the coil comes before the entry action there
    assert [(item.what, item.path) for item in found] == [
        ("Boolean actions", "POU Main"),
        ("inputs of actions", "POU Main"),
    ]


def test_an_action_that_is_not_written_is_not_mistaken_for_a_row_of_another() -> None:
    source = project(PAIR.format(condition="a", actions="q(D, T#1s); r(N);"))
    chart_of(source).step("S1").actions[0].qualifier = m.Qualifier.DL
    chart_of(source).step("S1").entry_action = m.StBody(text="q := a;")
    source.dialect = m.Dialect.CODESYS
    found = losses(source)
    assert [(item.what, item.path) for item in found] == [
        ("action", "POU Main / step S1 / action q"),
        ("inputs of actions", "POU Main"),
    ]
    assert "no qualifier DL" in found[0].why


def test_steps_that_s7_graph_wants_between_branches_are_one_item_each() -> None:
    chart = """INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO (One, Two) := a; END_TRANSITION
STEP One: END_STEP
STEP Two: END_STEP
TRANSITION FROM (One, Two) TO S1 := b; END_TRANSITION
TRANSITION FROM (One, Two) TO S2 := c; END_TRANSITION
STEP S1: q(N); END_STEP
STEP S2: r(N); END_STEP
TRANSITION FROM S1 TO S0 := a; END_TRANSITION
TRANSITION FROM S2 TO S0 := a; END_TRANSITION
"""
    (item,) = losses(project(chart))
    assert (item.outcome, item.what) == (Outcome.APPROXIMATED, "step")
    assert item.path.startswith("POU Main / step Wait")
    assert "one cycle later" in item.why


def test_the_end_of_a_sequence_is_no_transition_that_the_source_does_not_have() -> None:
    chart = "INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S1 := a; END_TRANSITION STEP S1: q(N); END_STEP"
    assert losses(project(chart)) == []


def test_a_transition_that_got_a_name_is_still_compared() -> None:
    report = sfc.convert(project(PAIR.format(condition="a", actions="q(N);")), "simaticml", partial=True)[1]
    names = [item for item in report.with_outcome(Outcome.TRANSLATED) if "got a name" in item.why]
    assert names
    assert {item.what for item in names} == {"name"}


def test_a_condition_that_cannot_be_written_is_one_item() -> None:
    source = project(PAIR.format(condition="a", actions=""))
    chart_of(source).transitions[0].condition = m.BodyCondition(body=m.IlBody(text="LD a\nJMPC x"))
    (item,) = losses(source)
    assert item.what == "condition of the transition"
    assert "NOT_TRANSLATED_Trans1" in item.why


def test_a_constant_is_its_value() -> None:
    constant = m.VariableSection(
        constant=True,
        variables=[
            m.Variable(name="Most", type=m.ElementaryType(name=m.Elementary.INT), initial=m.SimpleValue(text="10"))
        ],
    )
    source = project(PAIR.format(condition="n < Most", actions="q(N);"))
    source.configurations = [m.Configuration(name="Plant", global_variables=[constant])]
    assert losses(source) == []


@pytest.mark.slow
def test_flags_of_codesys_are_reported_once() -> None:
    found = losses(sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml"))
    flags = [item for item in found if "SFCReset" in (item.what, item.path.rpartition(" / ")[2])]
    assert [item.what for item in flags] == ["operating input"]


@pytest.mark.slow
def test_lists_with_retain_keep_their_values() -> None:
    source = sfc.load(FIXTURES / "codesys" / "distribution_belt.xml")
    assert not [item for item in losses(source) if item.what == "retain"]
    data = sfc.convert(source, "simaticml", partial=True)[0].decode("utf-8-sig")
    assert 'Name="udiTeile" Datatype="UDInt" Remanence="Retain"' in data


@pytest.mark.slow
def test_long_texts_are_shown_where_they_differ() -> None:
    found = losses(sfc.load(FIXTURES / "plcopen" / "every_element_2.01.xml"))
    (item,) = [item for item in found if item.what == "type" and item.path == "type RecipeRecord"]
    assert "Next : Variant" in item.why
    assert "Next : POINTER" in item.why


@pytest.mark.slow
def test_generic_types_are_no_types_of_tia_portal() -> None:
    report = sfc.convert(sfc.load(FIXTURES / "plcopen" / "every_element_2.01.xml"), "simaticml", partial=True)[1]
    generic = [item for item in report.items if item.path == "POU Largest / InNum" and item.outcome is not Outcome.KEPT]
    assert [(item.outcome, item.what) for item in generic] == [(Outcome.NOT_EXECUTED, "data type")]


@pytest.mark.slow
def test_items_are_grammatical() -> None:
    for path in sorted((FIXTURES / "plcopen").glob("*.xml")):
        assert not [item for item in losses(sfc.load(path)) if " a action" in item.why or "action `#" in item.why]


@pytest.mark.parametrize(("target", "called"), [("simaticml", Outcome.TRANSLATED), ("scl", Outcome.NOT_EXECUTED)])
def test_an_action_that_nothing_executes_is_no_loss(target: str, called: Outcome) -> None:
    source = project(PAIR.format(condition="a", actions="Steps(N); In_text(N);"))
    source.pou("Main").actions = [
        m.Action(name=name, body=m.StBody(text=text))
        for name, text in (
            ("Steps", "n := n + 1;"),
            ("In_text", "Called();"),
            ("Called", "n := 2;"),
            ("Unused", "n := 3;"),
        )
    ]
    report = sfc.convert(source, target, partial=True)[1]
    told = {item.path.rpartition(" ")[2]: item.outcome for item in report.items if item.what == "POU action"}
    assert told["Called"] is called
    assert told["Unused"] is Outcome.EXTENSION_DATA
    back = sfc.loads(sfc.dumps(source, format=target, partial=True), format=target)
    assert [action.name for action in back.pou("Main").actions] == ["Steps", "In_text", "Called", "Unused"]


@pytest.mark.parametrize("section", ["VAR_INPUT", "VAR_OUTPUT", "VAR", "VAR_GLOBAL"])
@pytest.mark.parametrize("flag", ["SFCInit", "SFCReset", "SFCPause"])
def test_flags_that_operate_a_chart_of_codesys_count_wherever_they_are_declared(section: str, flag: str) -> None:
    declaration = f"{section} {flag} : BOOL; END_VAR\n"
    source = sfc.loads(
        CHART.format(
            declared=declaration if section == "VAR_GLOBAL" else "",
            chart=("" if section == "VAR_GLOBAL" else declaration) + PAIR.format(condition="a", actions="q(N);"),
        ).encode(),
        format="iec-text",
    )
    source.dialect = m.Dialect.CODESYS
    report = sfc.convert(source, "plcopen")[1]
    told = [
        item.outcome for item in report.items if (item.what, item.path) == ("operating input", f"POU Main / {flag}")
    ]
    assert told == [Outcome.TRANSLATED]


def test_a_body_that_cannot_be_written_is_one_item(tmp_path: Path) -> None:
    source = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    source.pou("PLC_PRG").kind = m.PouKind.FUNCTION  # which keeps no edges
    report = sfc.save(source, f"{tmp_path}/out/", format="twincat", partial=True)
    found = [item.path for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what in ("body", "code")]
    assert found == ["POU PLC_PRG / action ACT_Belt"]


def test_items_are_grouped_by_their_reason_whatever_it_names() -> None:
    def item(path: str, why: str, line: int | None = None) -> Item:
        return Item(Outcome.NOT_EXECUTED, "text", path, why, text_line=line)

    items = [
        item("POU A / action X", "line 3: no counterpart of `ADR`", 3),
        item("POU A / q", "q has no place"),
        item("POU A / action X", "line 7: no counterpart of `SIZEOF`", 7),
        item("POU B / r", "r has no place"),
        item("POU B", "no counterpart of `ADR`"),
    ]
    first, second = grouped_by_reason(items)
    assert first.items == [items[0], items[2], items[4]]
    assert (first.reason, first.lines) == ("no counterpart of \u2026", [3, 7, None])
    assert first.differing == [["`ADR`"], ["`SIZEOF`"], ["`ADR`"]]
    assert (second.reason, second.differing) == ("\u2026 has no place", [[], []])
    (alone,) = grouped_by_reason(items[:1], str.upper)
    assert (alone.reason, alone.differing) == ("NO COUNTERPART OF `ADR`", [[]])


def test_a_name_in_place_of_what_matiec_lacks_is_no_item_of_its_own() -> None:
    source = sfc.load(FIXTURES / "codesys23/distribution_belt.EXP")
    data, report = sfc.convert(source, "iec-text", flavour="matiec", partial=True)
    assert b"NOT_EXECUTED_" in data
    assert [item.path for item in report.losses if "NOT_EXECUTED" in item.why] == []


def test_an_item_names_what_the_target_lacks_and_where_that_is_in_the_text() -> None:
    source = project(PAIR.format(condition="a", actions="Act(N);"))
    source.dialect = m.Dialect.CODESYS
    source.pou("Main").actions.append(m.Action(name="Act", body=m.StBody(text="n := 1;\nn := SIZEOF(n);")))
    report = sfc.convert(source, "plcopen-2.01", partial=True)[1]
    (item,) = (item for item in report.losses if item.what == "text")
    assert (item.text_line, item.cause) == (2, Cause(CauseKind.LACKING, "SIZEOF"))
    (data,) = (each for each in report.as_dict()["items"] if each.get("why") == item.why)
    assert json.loads(json.dumps(data["cause"])) == {"kind": "lacking", "name": "SIZEOF"}


@pytest.mark.parametrize("target", ["codesys", "codesys-export", "codesys23", "iec-text", "plcopen-1.01", "simaticml"])
def test_all_bodies_but_the_first_are_told_where_a_pou_has_one(target: str) -> None:
    """Several are worksheets of TC6 2.01. One beside a chart was left out without a word for CoDeSys 2.3."""
    source = project(PAIR.format(condition="a", actions="q(N);"))
    source.pou("Main").bodies.append(drawn("r := b AND NOT c;", "LD"))
    (item,) = losses(source, target)
    assert (item.outcome, item.path) == (Outcome.NOT_EXECUTED, "POU Main")
    assert "(LD) is NOT executed" in item.why or "`r := b AND NOT c;`, is NOT executed in" in item.why, item.why
    assert german(item.why).endswith("NICHT ausgeführt")


@pytest.mark.slow
def test_of_a_network_that_no_tool_executes_nothing_is_known() -> None:
    source = sfc.load("fixtures/plcopen/every_element_2.01.xml")
    (item,) = (item for item in losses(source, "codesys") if item.what == "code")
    assert item.why == (
        "it is not known whether the code does the same in CODESYS: a network that cannot be executed: "
        "an input cannot set anything"
    )
    assert german(item.why).startswith("es ist nicht bekannt, ob ")


@pytest.mark.parametrize("target", ["codesys", "codesys23", "simaticml", "plcopen"])
def test_a_chart_without_an_initial_step_is_told(target: str) -> None:
    """Neither side enters a step, which is a proof of nothing."""
    source = project(PAIR.format(condition="a", actions="q(N);").replace("INITIAL_STEP", "STEP"))
    (item,) = losses(source, target)
    assert (item.outcome, item.what, item.path) == (Outcome.APPROXIMATED, "chart", "POU Main")
    assert item.why.startswith("it has no initial step")
    assert german(item.why).startswith("sie hat keinen Initialschritt")
