"""Spelling of the states of a CASE: numbers, constants, values of an enumeration."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.api import convert
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import lower
from plcopen_sfc.lowering.reading.chart_source import step_numbers
from plcopen_sfc.semantics.net import Net
from tests.analysis.nets import chart_of
from tests.lowering.charts import act, boolean, pou_with, training_chain
from tests.lowering.test_regions import PARALLEL, chain
from tests.sweeps import examples

DIALECTS = {
    "iec": m.Dialect.IEC,
    "codesys": m.Dialect.CODESYS,
    "scl": m.Dialect.SCL,
}


def project(*pous: m.Pou, dialect: m.Dialect = m.Dialect.IEC) -> m.Project:
    return m.Project(name="Anlage", dialect=dialect, pous=list(pous))


def text_of(pou: m.Pou) -> str:
    assert isinstance(pou.body, m.StBody)
    return pou.body.text


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("states", ["numbers", "constants", "enumeration"])
@pytest.mark.parametrize("dialect", DIALECTS)
def test_all_are_proven(dialect: str, states: str, profile: str) -> None:
    for pou in (chain(PARALLEL), chain("S1>S2 S2>S2 S2>S1")):
        original = project(pou, dialect=DIALECTS[dialect])
        if (dialect, states) == ("scl", "enumeration"):
            with pytest.raises(LoweringError, match="no enumerations"):
                lower(original, states=states, profile=profile)
            continue
        lowered = lower(original, states=states, profile=profile)
        assert lowered.proof is not None
        assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)
        assert "S1.X" in lowered.proof.compared


@pytest.mark.parametrize("form", ["plcopen-1.01", "plcopen-2.01", "codesys", "iec-text", "scl", "simaticml", "json"])
@pytest.mark.parametrize("states", ["constants", "enumeration"])
def test_what_was_written_and_read_again_is_proven_too(states: str, form: str) -> None:
    original = project(chain(PARALLEL))
    if form in ("scl", "simaticml") and states == "enumeration":
        with pytest.raises(LoweringError, match="no enumerations"):
            lower(original, states=states, target=form)
        return
    again = sfc.loads(sfc.dumps(lower(original, states=states, verify=False).project, format=form), format=form)
    found = equivalent(original, again, "iec")
    assert found.kind is VerdictKind.PROVEN, str(found)


def test_constants_are_those_of_the_block() -> None:
    lowered = lower(project(chain("Warten>S7 S7>Warten", "Warten")), states="constants", lang="de").pou
    assert lowered.interface is not None
    constants = [s for s in lowered.interface.sections if s.constant]
    assert [(v.name, v.initial.text) for v in constants[0].variables if isinstance(v.initial, m.SimpleValue)] == [
        ("SCHRITT_Warten", "1"),
        ("SCHRITT_7", "7"),
    ]
    assert "    SCHRITT_Warten: // Schritt Warten – Initialschritt\n" in text_of(lowered)


@pytest.mark.parametrize("target", ["scl", "simaticml", "codesys"])
def test_states_have_names_unless_asked_otherwise(target: str) -> None:
    original = project(chain("Warten>S7 S7>Warten", "Warten"))
    assert re.search(r"STEP_Warten:\s+(// |\{region ')Step Warten", text_of(lower(original, target=target).pou))
    numbered = text_of(lower(original, target=target, states="numbers").pou)
    assert re.search(r" 1:\s+(// |\{region ')Step Warten", numbered)
    classic = lower(original, "case", target=target, style="classic").pou
    assert "STEP_" not in text_of(classic)


@pytest.mark.parametrize("target", [None, "plcopen", "iec-text"])
def test_constants_are_no_labels_in_edition_2(target: str | None) -> None:
    """matiec: invalid case element(s) defined after 'OF' in ST 'CASE' statement. It takes values of enumerations."""
    branch = "    7: // Step 7" if target is None else "    Ablauf_Step#S7: (* Step 7 *)"
    assert branch in text_of(lower(project(chain("S1>S7 S7>S1")), target=target).pou)
    numbered = lower(project(chain("S1>S7 S7>S1")), target=target, states="numbers").pou
    assert "    7: " in text_of(numbered)


@pytest.mark.parametrize("target", ["plcopen", "iec-text"])
def test_code_for_all_tools_has_what_edition_2_has(target: str) -> None:
    """matiec: no ``//``, no empty statement."""
    text = text_of(lower(project(chain(PARALLEL)), target=target).pou)
    assert "//" not in text
    assert "active_step_S2 := active_step_S2; (* until the simultaneous branches are joined *)" in text


def test_constants_of_scl_are_local_names() -> None:
    lowered = lower(project(chain("S1>S2 S2>S1"), dialect=m.Dialect.SCL), states="constants", profile="iec").pou
    assert "CASE #step_number OF\n    #STEP_1:" in text_of(lowered)


@pytest.mark.parametrize("dialect", ["iec", "scl"])
def test_tia_portal_knows_them_as_constants(dialect: str) -> None:
    """A variable could not be the label of a CASE there."""
    original = project(chain("S1>S2 S2>S1"), dialect=DIALECTS[dialect])
    lowered = lower(original, states="constants", profile="iec", target="simaticml")
    written = sfc.dumps(lowered.project, format="simaticml").decode("utf-8-sig")
    assert written.index('<Section Name="Static">') < written.index('<Section Name="Constant">')
    assert written.count('<Access Scope="LocalConstant"') == 6
    assert written.count('<Constant Name="STEP_1"') == 3
    source, report = convert(lowered.project, "scl")
    assert "VAR CONSTANT" in source.decode("utf-8-sig")
    assert not [item for item in report.items if "section" in item.what]
    again = sfc.loads(written.encode(), format="simaticml")
    assert equivalent(original, again, "iec").kind is VerdictKind.PROVEN


def test_an_enumeration_is_a_type_of_its_own_whose_name_is_free() -> None:
    """Values are written with their type: other types and variables may have values of the same name."""
    pou = chain("S1>IF IF>S1")
    other = m.DataTypeDeclaration(name="ABLAUF_STEP", type=m.EnumType(values=[m.EnumValue(name="S1")]))
    original = project(pou)
    original.data_types.append(other)
    lowered = lower(original, states="enumeration")
    assert [each.name for each in lowered.project.data_types] == ["ABLAUF_STEP", "Ablauf_Step_2"]
    made = lowered.project.data_types[1].type
    assert isinstance(made, m.EnumType)
    assert [(value.name, value.value) for value in made.values] == [("S1", None), ("STEP_IF", None)]
    assert "active_step := Ablauf_Step_2#STEP_IF;" in text_of(lowered.pou)
    assert len(original.data_types) == 1
    codesys = lower(project(pou, dialect=m.Dialect.CODESYS), states="enumeration", profile="iec")
    assert "active_step := Ablauf_Step.STEP_IF;" in text_of(codesys.pou)


def test_forms_without_states_are_refused() -> None:
    for construction in ("bits", "flipflop"):
        with pytest.raises(LoweringError, match=f"{construction} has no states"):
            lower(project(chain("S1>S2 S2>S1")), construction, states="constants")
    with pytest.raises(LoweringError, match="has no states") as caught:
        lower(project(chain("S1>S2+S3 S2>S1 S3>S1")), states="enumeration")
    assert "connected with its outside" in (caught.value.hint or "")


def test_step_numbers_are_kept() -> None:
    chart = chart_of("S3>Fill Fill>S12 S12>Drain Drain>Wait Wait>S3", "S3")
    chart.step("Drain").number = 40
    chart.step("Wait").number = 3
    assert step_numbers(Net.of(chart)) == [3, 1, 12, 40, 2]
    assert step_numbers(Net.of(training_chain().sfc or m.SfcNetwork())) == [1, 2, 3, 4]


@pytest.mark.parametrize(
    ("arcs", "numbers"),
    [
        ("Init>S1 S1>S2 S2>Init", [0, 1, 2]),
        ("Init>S0 S0>S1 S1>Init", [2, 0, 1]),
        ("Init>Fill Fill>Drain Drain>Init", [1, 2, 3]),
    ],
)
def test_an_initial_step_without_a_number_is_before_those_that_have_one(arcs: str, numbers: list[int]) -> None:
    chart = chart_of(arcs, "Init")
    assert step_numbers(Net.of(chart)) == numbers
    lowered = lower(project(chain(arcs)))
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN


def test_big_numbers_need_a_bigger_type() -> None:
    pou = chain("S1>S40000 S40000>S1")
    lowered = lower(project(pou))
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    assert lowered.pou.interface is not None
    state = next(v for v in lowered.pou.interface.variables() if v.name == "step_number")
    assert state.type == m.ElementaryType(name=m.Elementary.DINT)


NUMBERS = st.none() | st.integers(-3, 9) | st.sampled_from([32_767, 2**31 - 1, 2**40])


@settings(deadline=None, max_examples=examples(60))
@given(st.lists(NUMBERS, min_size=1, max_size=8))
def test_numbers_differ_and_the_first_step_that_has_one_keeps_it(numbers: list[int | None]) -> None:
    chart = m.SfcNetwork()
    for index, number in enumerate(numbers):
        chart.add_step(chr(ord("A") + index), initial=index == 0).number = number
    found = step_numbers(Net.of(chart))
    assert len(set(found)) == len(found)
    assert all(0 <= number < 2**31 for number in found)
    for number in {number for number in numbers if number is not None and 0 <= number < 2**30}:
        assert found[numbers.index(number)] == number


def test_variables_of_these_names_are_not_hidden() -> None:
    chart = chart_of("S1>S2 S2>S1", "S1")
    chart.transitions[0].condition = m.Expression(text="step_number AND STEP_2 AND Ablauf_Step")
    chart.transitions[1].condition = m.Expression(text="NOT step_number")
    pou = pou_with(chart)
    assert pou.interface is not None
    pou.interface.sections[1].variables.append(boolean("q"))
    for states in ("numbers", "constants", "enumeration"):
        lowered = lower(project(pou), states=states)
        assert lowered.proof is not None
        assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)


def test_the_chart_of_an_action_has_an_enumeration_of_its_own() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    inner = m.SfcNetwork()
    first, second = inner.add_step("A", initial=True), inner.add_step("B")
    inner.add_transition(first, second, "B5")
    inner.add_transition(second, first, "B1")
    pou.actions.append(m.Action(name="Inner", body=m.SfcBody(chart=inner)))
    act(chart, chart.steps[1], "Inner")
    lowered = lower(project(pou), "case", pou="Ablauf", states="enumeration")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)
    assert [kind.name for kind in lowered.project.data_types] == ["Ablauf_Step", "Ablauf_Step_2"]


@pytest.mark.parametrize(("target", "numbered"), [("plcopen", False), ("iec-text", False), ("codesys", True)])
def test_values_have_numbers_only_where_the_tool_of_the_target_takes_them(target: str, numbered: bool) -> None:
    """Beremiz and matiec number values themselves, and do not compile others; the source may be one of CODESYS."""
    source = project(training_chain(), dialect=m.Dialect.CODESYS)
    made = lower(source, target=target, states="enumeration", profile="codesys")
    assert made.proof is not None
    assert made.proof.proven
    (states,) = made.data_types
    assert isinstance(states.type, m.EnumType)
    assert [value.value is not None for value in states.type.values] == [numbered] * len(states.type.values)
