"""Boxes of conditions of other tools: their types, and what TIA Portal has no network for."""

from __future__ import annotations

import io
import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.api import convert
from plcopen_sfc.languages.networks import DrawingRules, draw_fbd
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.report import Outcome

CHART = """TYPE Place : STRUCT x, t : INT; END_STRUCT; END_TYPE
FUNCTION_BLOCK Chart
  VAR_INPUT i : INT; d : DINT; u : UDINT; r : REAL; w : WORD; b : BYTE; t : TIME; x, y : BOOL; s : STRING[9]; END_VAR
  VAR_INPUT p : Place; END_VAR
  INITIAL_STEP S1: END_STEP
  TRANSITION FROM S1 TO S2 := {condition}; END_TRANSITION
  STEP S2: END_STEP
  TRANSITION FROM S2 TO S1 := x; END_TRANSITION
END_FUNCTION_BLOCK
"""
SAID = {
    "INT_TO_REAL(i) > r * 2.0 + 1.0": ["Convert Int Real", "Mul Real", "Add Real", "Gt Real"],
    "(w AND 16#0F) = 3": ["And Word", "Eq Word"],
    "i > d": ["Gt DInt"],
    "i > r": ["Gt Real"],
    "i > 2.5": ["Gt Real"],
    "(b OR w) <> w": ["Or Word", "Ne Word"],
    "REAL_TO_DINT(r) = d + 1": ["Convert Real DInt", "Add DInt", "Eq DInt"],
    "t > T#5s": ["Gt Time"],
    "p.x > 3": ["Gt Int"],
    "p.t > 3": ["Gt Int"],
    "S1.T > T#5s": ["Gt Time"],
    "x AND i + 1 > 3": ["Add Int", "Gt Int"],
    "i > 40000": ["Gt DInt"],
    "i = 16#FFFF": ["Eq DInt"],
    "i = 16#7F": ["Eq Int"],
    "b > 300": ["Convert Byte DInt", "Gt DInt"],
    "b + 1 > 3": ["Convert Byte USInt", "Add USInt", "Gt USInt"],
    "(i AND 7) = 3": ["Convert Int Word", "And Word", "Convert Word Int", "Eq Int"],
    "-i > 3": ["Sub Int", "Gt Int"],
    "s = 'abc'": ["Eq String"],
    "t <> T#0s": ["Ne Time"],
    "x = y": [],
    "x <> y": [],
    "x > y OR x <= y": [],
    "x = TRUE AND y <> TRUE AND FALSE = x": [],
}
"""Conditions, and the boxes that say them, each with its types."""
REFUSED = ["d > r", "u > i", "ABS(i) > 3", "SEL(x, i, 3) = 1", "(NOT w) = 1", "w = i", "DINT_TO_REAL(u) > r"]
REFUSED += ["t - T#1s > T#5s", "t / 2 > T#5s", "t * 2 > T#5s", "s > 1", "x AND t > 5"]
"""Conditions that no network of TIA Portal says as they are."""


def converted(condition: str) -> tuple[bytes, sfc.ConversionReport]:
    return convert(sfc.loads(CHART.format(condition=condition).encode(), format="iec-text"), "simaticml", partial=True)


@pytest.mark.parametrize("condition", SAID)
def test_boxes_have_one_type_that_holds_all_values(condition: str) -> None:
    data, report = converted(condition)
    assert not report.losses, report.losses
    parts = re.findall(r'<Part Name="(\w+)" UId="\d+">(.*?)</Part>', data.decode(), re.DOTALL)
    found = [" ".join([name, *re.findall(r'Type="Type">(\w+)<', inside)]) for name, inside in parts]
    assert [each for each in found if " " in each] == SAID[condition]


@pytest.mark.parametrize("condition", REFUSED)
def test_what_has_no_network_does_not_compile_and_is_reported(condition: str) -> None:
    data, report = converted(condition)
    assert [item.what for item in report.losses] == ["condition of the transition"], report.losses
    assert b"NOT_TRANSLATED" in data


TYPES = {"BOOL": [], "BYTE": ["EQ"], "INT": ["EQ", "ADD"], "REAL": ["EQ", "ADD"], "TIME": ["EQ"], "STRING": ["EQ"]}


@pytest.mark.parametrize("box", ["EQ", "ADD"])
@pytest.mark.parametrize("type_", TYPES)
def test_boxes_of_bodies_are_of_types_that_they_take(type_: str, box: str) -> None:
    """Box by type: what TIA Portal has not is not written."""
    result = "BOOL" if box == "EQ" else type_
    text = f"""FUNCTION_BLOCK Main
    VAR_INPUT a, b : {type_}; END_VAR VAR_OUTPUT q : {result}; END_VAR
    q := {"a = b" if box == "EQ" else "a + b"};
    END_FUNCTION_BLOCK"""
    project = sfc.loads(text.encode(), format="iec-text")
    body = project.pous[0].bodies[0]
    assert isinstance(body, StBody)
    drawn = draw_fbd(parse_statements(body.text, Dialect.IEC).tree.statements, DrawingRules(Dialect.IEC))
    project.pous[0].bodies = [drawn.body]
    data, report = convert(project, "simaticml", partial=True)
    assert {item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)} == (
        set() if box in TYPES[type_] else {"network"}
    )
    assert (f">{type_.title()}<" in data.decode()) is (box in TYPES[type_])


@pytest.mark.parametrize(("value", "is_known"), [("w AND v", True), ("p.w AND p.w", False), ("NOT w", False)])
def test_no_coil_is_of_a_word(value: str, is_known: bool) -> None:
    """The types of members are not known: AND of them would be a box of bits with a coil of a word."""
    text = f"""TYPE Place : STRUCT w : WORD; END_STRUCT; END_TYPE
    FUNCTION_BLOCK Main VAR_INPUT w, v : WORD; p : Place; END_VAR VAR_OUTPUT q : WORD; END_VAR
    q := {value};
    END_FUNCTION_BLOCK"""
    project = sfc.loads(text.encode(), format="iec-text")
    body = project.pous[0].bodies[0]
    assert isinstance(body, StBody)
    project.pous[0].bodies = [draw_fbd(parse_statements(body.text, Dialect.IEC).tree.statements).body]
    data, report = convert(project, "simaticml", partial=True)
    assert [item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)] == ([] if is_known else ["network"])
    assert (b'Name="And"' in data) is is_known


def test_conversions_come_back() -> None:
    data, _ = converted("INT_TO_REAL(i) > r")
    seen = sfc.loads(data, as_tool=True)
    back = convert(seen, "iec-text", partial=True)[0].decode()
    assert "INT_TO_REAL(" in back


@pytest.mark.slow
@pytest.mark.parametrize(
    "condition",
    [
        "x <> y AND NOT (y >= x)",
        "x = y OR x > y AND (y = FALSE)",
        "(x AND y) = (x OR y)",
        "(x < y) <> (y <= x)",
        "NOT (x = y)",
    ],
)
def test_comparisons_of_bool_give_the_same_as_logic(condition: str) -> None:
    project = sfc.loads(CHART.format(condition=condition).encode(), format="iec-text")
    report = sfc.save(project, io.BytesIO(), format="simaticml", strict=True, limit=20)
    assert report.compared["POU Chart"].startswith("equal")


def _variables(kind: str, **names: str) -> str:
    found = "".join(f'<variable name="{name}"><type><{type_}/></type></variable>' for name, type_ in names.items())
    return f"<{kind}>{found}</{kind}>"


def _input(pin: str, source: int) -> str:
    wired = f'<connectionPointIn><connection refLocalId="{source}"/></connectionPointIn>'
    return f'<variable formalParameter="{pin}">{wired}</variable>'


PLACE = '<position x="0" y="0"/>'
RUNG = f"""<LD>
<leftPowerRail localId="1">{PLACE}<connectionPointOut formalParameter=""/></leftPowerRail>
<contact localId="2">{PLACE}<connectionPointIn><connection refLocalId="1"/></connectionPointIn><connectionPointOut/>
<variable>a</variable></contact>
<inVariable localId="3">{PLACE}<connectionPointOut/><expression>i</expression></inVariable>
<block localId="5" typeName="ADD">{PLACE}
<inputVariables>{_input("EN", 2)}{_input("IN1", 3)}{_input("IN2", 3)}</inputVariables><inOutVariables/>
<outputVariables><variable formalParameter="ENO"><connectionPointOut/></variable>
<variable formalParameter="OUT"><connectionPointOut/></variable></outputVariables></block>
<coil localId="6"><position x="200" y="0"/><connectionPointIn><connection refLocalId="5" formalParameter="ENO"/>
</connectionPointIn><connectionPointOut/><variable>q</variable></coil>
<outVariable localId="7"><position x="200" y="90"/><connectionPointIn>
<connection refLocalId="5" formalParameter="OUT"/></connectionPointIn><expression>s</expression></outVariable></LD>"""
WITH_ENO = f"""<project xmlns="http://www.plcopen.org/xml/tc6_0201">
<fileHeader companyName="" productName="" productVersion="1" creationDateTime="2024-01-01T00:00:00"/>
<contentHeader name="x"><coordinateInfo><fbd><scaling x="1" y="1"/></fbd><ld><scaling x="1" y="1"/></ld>
<sfc><scaling x="1" y="1"/></sfc></coordinateInfo></contentHeader>
<types><dataTypes/><pous><pou name="Main" pouType="functionBlock">
<interface>{_variables("inputVars", a="BOOL", i="INT")}{_variables("outputVars", q="BOOL", s="INT")}</interface>
<body>{RUNG}</body></pou></pous></types><instances><configurations/></instances></project>"""


def test_the_eno_of_a_box_of_another_tool_is_its_en() -> None:
    """Of S7 it is FALSE where the result does not fit, unless that is switched off (``DisabledENO``)."""
    data, report = convert(sfc.loads(WITH_ENO.encode()), "simaticml", partial=True)
    assert not [item for item in report.losses if "ENO" in item.why]
    (add,) = re.findall(rb'<Part Name="Add"[^>]*>', data)
    assert b'DisabledENO="true"' in add
    assert b'Name="eno"' in data
    alone = WITH_ENO.replace('refLocalId="5" formalParameter="ENO"', 'refLocalId="2"')
    assert b"DisabledENO" not in convert(sfc.loads(alone.encode()), "simaticml", partial=True).data
    back = convert(sfc.loads(data), "plcopen-2.01", fresh=True, partial=True)
    assert not [item for item in back.report.losses if "its ENO is FALSE" in item.why]
