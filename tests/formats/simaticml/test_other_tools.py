"""Networks of other tools become networks of TIA Portal: boxes, pins and types that it has."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import equivalent
from plcopen_sfc.api import convert
from plcopen_sfc.formats.simaticml.coils_and_contacts import writes_bits_on_a_condition
from plcopen_sfc.formats.simaticml.network_boxes import put_operands
from plcopen_sfc.languages.networks import DrawingRules, declared_rules, draw_fbd, draw_ld
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.charts import boolean

BOOL = m.ElementaryType(name=m.Elementary.BOOL)


def pou_with(text: str, language: str, tool: Tool | None, kinds: dict[str, str]) -> m.Pou:
    """A function block with inputs a, b, c, outputs p, q, and instances; drawn as `tool` has it."""

    def section(kind: m.SectionKind, names: str) -> m.VariableSection:
        return m.VariableSection(kind=kind, variables=[m.Variable(name=name, type=BOOL) for name in names])

    local = m.VariableSection(
        kind=m.SectionKind.LOCAL,
        variables=[m.Variable(name=name, type=m.DerivedType(name=kind)) for name, kind in kinds.items()],
    )
    interface = m.Interface(sections=[section(m.SectionKind.INPUT, "abc"), section(m.SectionKind.OUTPUT, "pq"), local])
    rules: DrawingRules = declared_rules(interface.variables(), tool=tool)
    statements = parse_statements(text).tree.statements
    body: m.Body
    if language == "FBD":
        body = draw_fbd(statements, rules, divided=True).body
    else:
        body = draw_ld(statements, rules, divided=True).body
    return m.Pou(name="FB_Box", kind=m.PouKind.FUNCTION_BLOCK, interface=interface, bodies=[body])


CASES = [
    (None, {"ff": "RS"}, "ff(S := a, R1 := b); q := ff.Q1; p := ff.Q1 AND c;", {"Bool"}),
    (Tool.CODESYS, {"ff": "RS"}, "ff(SET := a, RESET1 := b); q := ff.Q1;", {"Bool"}),
    (None, {"ff": "SR"}, "ff(S1 := a, R := b); q := ff.Q1;", {"Bool"}),
    (None, {"up": "R_TRIG"}, "up(CLK := a); q := up.Q;", {"Bool", "R_TRIG"}),
    (Tool.CODESYS, {"late": "TON"}, "late(IN := a AND b, PT := T#20ms); q := late.Q;", {"Bool", "TON_TIME"}),
]


@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize(("tool", "kinds", "text", "types"), CASES)
def test_blocks_of_the_standard(
    tool: Tool | None, kinds: dict[str, str], text: str, types: set[str], language: str
) -> None:
    project = m.Project(pous=[pou_with(text, language, tool, kinds)])
    data, report = convert(project, "simaticml", partial=True)
    content = data.decode("utf-8-sig")
    assert set(re.findall(r'Datatype="([^"]+)"', content)) == types
    assert [item for item in report.items if item.what == "network" and item.outcome is not Outcome.KEPT] == []
    names = set(re.findall(r'Part Name="([^"]+)"', content))
    kind = next(iter(kinds.values()))
    assert {"RS": "Sr", "SR": "Rs"}.get(kind, kind) in names, "the dominance stays; the name does not"
    assert "CallInfo" not in content
    found = equivalent(project, sfc.loads(data), "iec")
    assert found.proven, str(found)


def test_an_instance_that_text_calls_keeps_its_type_and_the_report_says_so() -> None:
    project = m.Project(pous=[pou_with("ff(S := a, R1 := b); q := ff.Q1;", "FBD", None, {"ff": "RS"})])
    project.pous[0].actions.append(m.Action(name="Reset", body=m.StBody(text="ff(S := FALSE, R1 := TRUE);")))
    _, report = convert(project, "simaticml", partial=True)
    (item,) = [item for item in report.items if item.what == "instance"]
    assert item.outcome is Outcome.APPROXIMATED
    assert item.path == "POU FB_Box / ff"


def test_reads_of_the_output_elsewhere_name_the_variable() -> None:
    project = m.Project(pous=[pou_with("ff(S := a, R1 := b); q := ff.Q1;", "FBD", None, {"ff": "RS"})])
    project.pous[0].actions.append(m.Action(name="Look", body=m.StBody(text="p := NOT ff.Q1; // why")))
    put_operands(project, ConversionReport("plcopen", "simaticml"))
    body = project.pous[0].actions[0].body
    assert isinstance(body, m.StBody)
    assert body.text == "p := NOT ff; // why"


def test_calls_of_blocks_of_the_project_say_what_their_parameters_are() -> None:
    inner = pou_with("q := a AND b; p := c;", "FBD", None, {})
    outer = pou_with("box(a := b, b := c, q => q);", "FBD", None, {"box": "FB_Box"})
    outer.name = "FB_Outer"
    project = m.Project(pous=[outer, inner])
    data, _ = convert(project, "simaticml")
    content = data.decode("utf-8-sig")
    assert '<Parameter Name="a" Section="Input" Type="Bool" />' in content
    assert '<Parameter Name="q" Section="Output" Type="Bool" />' in content
    found = equivalent(resolve(project, "FB_Outer"), resolve(sfc.loads(data), "FB_Outer"), "iec")
    assert found.proven, str(found)


@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize("tool", [None, Tool.S7])
@pytest.mark.parametrize("value", ["NOT Q", "a", "NOT a", "a AND NOT b", "a OR b", "k > 3", "TRUE", "0"])
def test_a_bit_that_is_written_on_a_condition_is_kept_otherwise(value: str, tool: Tool | None, language: str) -> None:
    """No box of TIA Portal with EN writes bits: without a word it would be written in every cycle."""
    declared = [boolean("c"), boolean("d"), boolean("Q"), boolean("a"), boolean("b")]
    declared.append(m.Variable(name="k", type=m.ElementaryType(name=m.Elementary.INT)))
    statements = parse_statements(f"Q := d; IF c THEN Q := {value}; END_IF;", Dialect.IEC).tree.statements
    rules = declared_rules(declared, Dialect.IEC, tool)
    body = draw_fbd(statements, rules).body if language == "FBD" else draw_ld(statements, rules).body
    sections = [m.VariableSection(kind=m.SectionKind.INPUT, variables=[v for v in declared if v.name != "Q"])]
    sections.append(m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[boolean("Q")]))
    pou = m.Pou(name="F", kind=m.PouKind.FUNCTION_BLOCK, interface=m.Interface(sections=sections), bodies=[body])
    project = m.Project(name="Anlage", pous=[pou])
    data, report = convert(project, "simaticml", partial=True)
    assert not [item for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what in ("network", "body")]
    verdict = equivalent(project, sfc.loads(data, format="simaticml"), "iec")
    assert verdict.proven, str(verdict)


def test_a_ladder_of_boxes_with_en_that_contacts_cannot_say_is_reported() -> None:
    declared = [boolean("c"), boolean("Q"), boolean("a"), boolean("b")]
    statements = parse_statements("IF c THEN Q := a XOR b; END_IF;", Dialect.IEC).tree.statements
    interface = m.Interface(sections=[m.VariableSection(kind=m.SectionKind.OUTPUT, variables=declared)])
    body = draw_ld(statements, declared_rules(declared, Dialect.IEC)).body
    pou = m.Pou(name="F", kind=m.PouKind.FUNCTION_BLOCK, interface=interface, bodies=[body])
    _, report = convert(m.Project(name="Anlage", pous=[pou]), "simaticml", partial=True)
    assert [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "network"]


@pytest.mark.parametrize(("name", "writes_a_bit"), [("AND", True), ("And", False), ("Xor", False), ("XOR", True)])
def test_boxes_for_words_have_en_in_tia_portal(name: str, writes_a_bit: bool) -> None:
    pins = [m.BlockVariable(name=pin) for pin in ("EN", "in1", "in2")]
    box = m.Block(id=1, type_name=name, parameters=m.BlockParameters(inputs=pins))
    assert writes_bits_on_a_condition(m.LogicNetwork(nodes=[box])) is writes_a_bit
