"""The textbook forms are those of the textbook."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, Language, Style, lower
from plcopen_sfc.lowering.code_texts import TEXTS
from plcopen_sfc.lowering.construction import construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model import FbdBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.text import plain
from plcopen_sfc.semantics.profile import PROFILES
from tests.corpus import CORPUS
from tests.lowering.charts import act, boolean, pou_with, training_chain
from tests.samples import FIXTURES

RULES = LoweringRules(PROFILES["iec"], TEXTS["de"], style=Style.CLASSIC)


def squeezed(text: str) -> list[str]:
    """The lines of a program, but for the case of letters, spaces and empty lines."""
    lines = (re.sub(r"\s+", "", line).casefold() for line in text.splitlines())
    return [line for line in lines if line]


def lowered(construction: Construction, language: Language) -> object:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    result = construct(pou, chart, Dialect.IEC, replace(RULES, construction=construction, language=language))
    return result.pou.body


def test_case_is_the_listing_of_the_textbook() -> None:
    seeds = sorted((CORPUS.parent / "seeds").glob("000_*.txt"))
    if not seeds:
        pytest.skip("the textbook is not here")
    listing = re.findall(r"```\n(//Kette.*?)```", seeds[0].read_text(encoding="utf-8"), re.DOTALL)[-1]
    body = lowered(Construction.CASE, Language.ST)
    assert isinstance(body, StBody)
    assert squeezed(body.text) == squeezed(listing)


def test_flip_flops_are_set_by_the_step_before_and_reset_by_the_step_behind() -> None:
    body = lowered(Construction.FLIPFLOP, Language.FBD)
    assert isinstance(body, FbdBody)
    assert [network.title for network in body.networks] == [
        "Schritt 1 – Initialschritt",
        "Schritt 2",
        "Schritt 3",
        "Schritt 4",
        "Aktion Q1",
        "Aktion Q2",
        "Aktion Q3",
    ]
    text = lowered(Construction.FLIPFLOP, Language.ST)
    assert isinstance(text, StBody)
    assert [line for line in text.text.splitlines() if line and not line.startswith("//")] == [
        "X1 := (Init OR X4 AND B4 OR X1) AND NOT X2;",
        "X2 := (X1 AND B1 OR X2) AND NOT (X3 OR Init);",
        "X3 := (X2 AND B2 OR X3) AND NOT (X4 OR Init);",
        "X4 := (X3 AND B3 OR X4) AND NOT (X1 OR Init);",
        "Q1 := X1;",
        "Q2 := (X2 OR Q2) AND NOT X4;",
        "Q3 := X3 AND B5;",
    ]


@pytest.mark.parametrize(("construction", "line"), [("fup", 0), ("case", 1)])
def test_the_input_that_starts_the_chain_is_a_part_of_the_textbook_forms(construction: str, line: int) -> None:
    def first_line(project: m.Project, **options: str) -> str:
        made = lower(project, construction, style="classic", language="ST", verify=False, **options)
        assert isinstance(made.pou.body, StBody)
        return next(row for row in made.pou.body.text.splitlines() if not row.startswith("//"))

    usual = {"fup": "X1 := ({} OR X4 AND B4 OR X1) AND NOT X2;", "case": "IF {} THEN"}[construction]
    chain = m.Project(pous=[training_chain()])
    assert first_line(chain) == usual.format("Init")
    assert first_line(chain, init="Start") == usual.format("Start")
    assert first_line(chain, init="") != usual.format("Init")
    assert "Init" not in first_line(chain, init="")


def test_an_input_of_the_block_that_is_called_so_starts_the_chain() -> None:
    pou = training_chain()
    assert pou.interface is not None
    pou.interface.sections[0].variables.append(boolean("INIT"))
    made = lower(m.Project(pous=[pou]), "fup", style="classic", verify=False)
    assert made.at_rest == {"INIT": False}
    assert [v.name for v in made.pou.variables() if v.name.casefold() == "init"] == ["INIT"]


def test_a_name_that_means_something_else_is_not_taken_for_the_start_of_the_chain() -> None:
    asked, stepped, number, output = (training_chain() for _ in range(4))
    integer = m.Variable(name="Init", type=m.ElementaryType(name=m.Elementary.INT))
    for pou, section, variable in ((asked, 0, boolean("Init")), (number, 0, integer), (output, 1, boolean("Init"))):
        assert pou.interface is not None
        pou.interface.sections[section].variables.append(variable)
    assert asked.sfc is not None
    asked.sfc.transitions[0].condition = m.Expression(text="init AND B1")
    assert stepped.sfc is not None
    stepped.sfc.steps[0].name = "Init"
    for pou in (asked, stepped, number, output):
        made = lower(m.Project(pous=[pou]), "fup", style="classic", verify=False)
        assert made.at_rest == {"Init_2": False}
    tagged = m.Project(pous=[training_chain(), m.Pou(name="Init", kind=m.PouKind.PROGRAM)])
    assert lower(tagged, "fup", pou="Ablauf", style="classic", verify=False).at_rest == {"Init_2": False}


def refused(pou: m.Pou, construction: Construction, **options: str) -> str:
    with pytest.raises(LoweringError) as found:
        lower(m.Project(pous=[pou]), construction, style="classic", verify=False, **options)
    assert found.value.hint == "The exact form has."
    return found.value.message


def test_what_a_textbook_form_cannot_hold_is_refused() -> None:
    entered = training_chain()
    assert entered.sfc is not None
    entered.sfc.steps[1].entry_action = m.StBody(text="Q1 := TRUE;")
    assert "entry and exit actions" in refused(entered, Construction.CASE)
    pulsed = training_chain()
    assert pulsed.sfc is not None
    act(pulsed.sfc, pulsed.sfc.steps[1], "Q1", m.Qualifier.P)
    assert "qualifier P" in refused(pulsed, Construction.CASE)
    for construction in (Construction.CASE, Construction.FLIPFLOP):
        flagged = training_chain()
        assert flagged.interface is not None
        flagged.interface.sections[0].variables.append(boolean("SFCInit"))
        assert "SFC flags, and the chart uses SFCInit" in refused(flagged, construction, profile="codesys")


def test_times_and_blocks_of_conditions_are_part_of_textbook_forms() -> None:
    pou = training_chain()
    assert pou.sfc is not None
    pou.sfc.transitions[1].condition = m.Expression(text="S2.T >= T#2s")
    for construction, expected in (
        (Construction.FLIPFLOP, "X2_zeit(IN := X2,"),
        (Construction.CASE, "X2_zeit(IN := schrittnummer = 2,"),
    ):
        made = lower(m.Project(pous=[pou]), construction, style="classic", language="ST", lang="de", verify=False)
        assert isinstance(made.pou.body, StBody)
        assert expected in made.pou.body.text


@pytest.mark.parametrize("text", ["", "// nothing yet"])
def test_a_step_of_which_nothing_is_executed_has_an_empty_statement(text: str) -> None:
    chart = m.SfcNetwork()
    first, last = chart.add_step("S1", initial=True), chart.add_step("S2")
    chart.add_transition(first, last, "B1")
    chart.step("S2").actions = [m.ActionAssociation(id=90, body=m.StBody(text=text))]
    for style in ("classic", "exact"):
        made = lower(m.Project(pous=[pou_with(chart)]), "case", style=style, verify=False)
        assert isinstance(made.pou.body, StBody)
        lines = [line.strip() for line in made.pou.body.text.splitlines()]
        assert lines[lines.index("2: // Step 2") + 1] == ";"


def test_a_selection_in_a_textbook_case_tries_its_legs_in_order() -> None:
    pou = training_chain()
    assert pou.sfc is not None
    pou.sfc.add_transition(pou.sfc.steps[0], pou.sfc.steps[3], "B5")
    made = lower(m.Project(pous=[pou]), "case", style="classic", lang="de", verify=False)
    assert isinstance(made.pou.body, StBody)
    lines = [line.strip() for line in made.pou.body.text.splitlines()]
    at = lines.index("IF B1 THEN")
    assert lines[at : at + 8] == [
        "IF B1 THEN",
        "Q1 := false; // Aktionen zurücksetzen",
        "schrittnummer := 2; // In den nächsten Schritt schalten",
        "// Transition",
        "ELSIF B5 THEN",
        "Q1 := false; // Aktionen zurücksetzen",
        "schrittnummer := 4; // In den nächsten Schritt schalten",
        "END_IF;",
    ]


def test_a_chart_of_an_emergency_stop_is_the_reset_of_the_textbook() -> None:
    """Each step is set by the one before, reset by the one behind or the button; the initial step is set by that."""
    project = sfc.load(FIXTURES / "grafcet" / "two_cylinders.gct")
    made = sfc.lower(project, "fup", style="classic", language="ST", flag_names="SR01")
    assert made.faults
    body = made.pou.body
    assert isinstance(body, StBody)
    assert [line for line in body.text.splitlines() if line and not line.startswith("//")] == [
        "SR01 := (NOT NOT_AUS OR SR05 AND 2B1 OR SR01) AND NOT SR02;",
        "SR02 := (SR01 AND 1B1 AND 2B1 AND START OR SR02) AND NOT (SR03 OR NOT NOT_AUS);",
        "SR03 := (SR02 AND 1B2 OR SR03) AND NOT (SR04 OR NOT NOT_AUS);",
        "SR04 := (SR03 AND 1B1 OR SR04) AND NOT (SR05 OR NOT NOT_AUS);",
        "SR05 := (SR04 AND 2B2 OR SR05) AND NOT (SR01 OR NOT NOT_AUS);",
        "1M1 := SR02;",
        "2M1 := SR04;",
    ]
    titles = [line for line in body.text.splitlines() if line.startswith("// Step")]
    assert titles == ["// Step 1 – initial step", *(f"// Step {number}" for number in range(2, 6))]
    assert made.left_out == "NOT NOT_AUS"
    assert made.proof is not None
    assert {"G1.1", "G1.5"} <= made.step_flags.keys(), "by the names in the chart"


def test_the_first_network_of_textbook_code_is_that_of_the_first_step() -> None:
    """TIA Portal has no start values for bit memory: networks for each flag, and one for the button, came before."""
    project = sfc.load(FIXTURES / "grafcet" / "two_cylinders.gct")
    options: dict[str, Any] = {"style": "classic", "lang": "de", "flags": "M20.0", "target": "simaticml"}
    made = sfc.lower(project, "fup", **options)
    assert isinstance(made.pou.body, FbdBody)
    titles = [plain(network.title) for network in made.pou.body.networks]
    steps = [f"Schrittmerker X{number} (M20.{number - 1})" for number in range(1, 6)]
    assert titles == [*steps, "Aktion 1M1", "Aktion 2M1", "Ende des Richtimpulses"]
    assert [fault.code for fault in made.faults] == ["LOW101", "LOW104", "LOW108"]
    told = [line for line in made.faults[2].table() if all(name in line for name in ("1B2", "2B2", "START"))]
    assert [line.split("|")[2].strip() for line in told] == ["never stable"]
    # with an input that starts it, the textbook waits for that
    chain = sfc.lower(sfc.load(FIXTURES / "grafcet" / "four_steps.gct"), "fup", **options)
    assert isinstance(chain.pou.body, FbdBody)
    assert plain(chain.pou.body.networks[0].title) == "Schrittmerker X1 (M20.0)"
    assert "LOW107" in [fault.code for fault in chain.faults]


@pytest.mark.parametrize("stop", ["NOT NOT_AUS", "/NOT_AUS", "¬NOT_AUS", "!NOT_AUS"])
def test_the_stop_of_a_grafcet_is_written_as_its_conditions(stop: str) -> None:
    project = sfc.load(FIXTURES / "grafcet" / "four_steps.gct")
    made = sfc.lower(project, "fup", style="classic", language="ST", stop=stop, verify=False)
    assert isinstance(made.pou.body, StBody)
    assert "Restart := Init OR NOT NOT_AUS;" in made.pou.body.text
    with pytest.raises(LoweringError, match="it has an edge or a time"):
        sfc.lower(project, "fup", style="classic", stop="↑NOT_AUS", verify=False)


def test_a_chart_of_an_emergency_stop_that_does_more_is_refused() -> None:
    text = (FIXTURES / "grafcet" / "two_cylinders.gct").read_text(encoding="utf-8")
    for old, new in (
        ("FORCE G1{INIT}", "FORCE G1{}"),
        ("11 -> 10 : /NOT_AUS", "11 -> 10 : START"),  # not the opposite
        ("2 -> 3 : 1B2", "2 -> 3 : 1B2 * X11"),  # something asks for its steps
        ("FORCE G1{INIT}", "FORCE G1{INIT}\n        1M1"),
    ):
        project = sfc.loads(text.replace(old, new).encode(), format="grafcet-text")
        with pytest.raises(LoweringError, match="charts that others force or enclose"):
            sfc.lower(project, "fup", style="classic", language="ST", verify=False)


@pytest.mark.parametrize("pattern", ["SR", "1", "SR02", "S R1"])
def test_a_pattern_of_flags_names_that_of_step_1(pattern: str) -> None:
    with pytest.raises(LoweringError, match="is no name of the flag of step 1"):
        sfc.lower(pou_with(training_chain().sfc or m.SfcNetwork()), "bits", flag_names=pattern, verify=False)
