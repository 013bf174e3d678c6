"""Boxes of TIA Portal in tools that have the functions of IEC 61131-3 only."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.api import convert
from plcopen_sfc.report import Outcome

_PART = '<Part Name="{name}" UId="26">{values}</Part>'
_MEMBERS = (("Input", "x", "Int"), ("Input", "r", "Real"), ("Input", "w", "Word"), ("Output", "o", "{result}"))


def block(name: str, inputs: tuple[tuple[str, str], ...], output: str, types: dict[str, str], result: str) -> bytes:
    """A function block in LAD with one box."""
    values = "".join(f'<TemplateValue Name="{key}" Type="Type">{kind}</TemplateValue>' for key, kind in types.items())
    parts, wires = [], ['<Wire UId="40"><Powerrail /><NameCon UId="26" Name="en" /></Wire>']
    for number, (pin, operand) in enumerate((*inputs, (output, "o"))):
        uid = 50 + number
        parts.append(
            f'<Access Scope="LocalVariable" UId="{uid}"><Symbol><Component Name="{operand}" /></Symbol></Access>'
        )
        ends = [f'<IdentCon UId="{uid}" />', f'<NameCon UId="26" Name="{pin}" />']
        wires.append(f'<Wire UId="{60 + number}">{"".join(ends if pin != output else ends[::-1])}</Wire>')
    network = (
        '<FlgNet xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/FlgNet/v4"><Parts>'
        f"{''.join(parts)}{_PART.format(name=name, values=values)}</Parts><Wires>{''.join(wires)}</Wires></FlgNet>"
    )
    sections = "".join(
        f'<Section Name="{section}">'
        + "".join(
            f'<Member Name="{member}" Datatype="{kind.format(result=result)}" />'
            for around, member, kind in _MEMBERS
            if around == section
        )
        + "</Section>"
        for section in ("Input", "Output")
    )
    return (
        '<?xml version="1.0" encoding="utf-8"?><Document><Engineering version="V20" /><SW.Blocks.FB ID="0">'
        '<AttributeList><Interface><Sections xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v5">'
        f"{sections}</Sections></Interface><Name>Lad</Name><ProgrammingLanguage>LAD</ProgrammingLanguage>"
        '</AttributeList><ObjectList><SW.Blocks.CompileUnit ID="1" CompositionName="CompileUnits"><AttributeList>'
        f"<NetworkSource>{network}</NetworkSource><ProgrammingLanguage>LAD</ProgrammingLanguage></AttributeList>"
        "</SW.Blocks.CompileUnit></ObjectList></SW.Blocks.FB></Document>"
    ).encode()


SAME = {
    "Convert": (block("Convert", (("in", "x"),), "out", {"SrcType": "Int", "DestType": "Real"}, "Real"), 7.0),
    "Convert to the same": (block("Convert", (("in", "x"),), "out", {"SrcType": "Int", "DestType": "Int"}, "Int"), 7),
    "Trunc": (block("Trunc", (("in", "r"),), "out", {"SrcType": "Real", "DestType": "Int"}, "Int"), 2),
    "Inc": (block("Inc", (), "operand", {"DestType": "Int"}, "Int"), 1),
    "Dec": (block("Dec", (), "operand", {"DestType": "Int"}, "Int"), -1),
    "Neg": (block("Neg", (("in", "x"),), "out", {"SrcType": "Int"}, "Int"), -7),
    "Sqr": (block("Sqr", (("in", "r"),), "out", {"SrcType": "Real"}, "Real"), 6.25),
    "Shl": (block("Shl", (("in", "w"), ("n", "x")), "out", {"SrcType": "Word"}, "Word"), 128),
}
"""Boxes that other tools have as functions, and what comes out of them for x = 7, r = 2.5, w = 1."""
LACKED = {
    "Ceil": block("Ceil", (("in", "r"),), "out", {"SrcType": "Real", "DestType": "Int"}, "Int"),
    "Norm_X": block("Norm_X", (("min", "r"), ("value", "r"), ("max", "r")), "out", {"SrcType": "Real"}, "Real"),
    "Swap": block("Swap", (("in", "w"),), "out", {"SrcType": "Word"}, "Word"),
    "Convert": block("Convert", (("in", "x"),), "out", {"SrcType": "BCD16", "DestType": "Int"}, "Int"),
}


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
@pytest.mark.parametrize("name", SAME)
def test_boxes_with_a_function_of_the_same_meaning_are_that(name: str, target: str) -> None:
    source, value = SAME[name]
    data, report = convert(sfc.loads(source), target)
    assert not report.losses
    seen = sfc.loads(data, as_tool=True)
    for variable in seen.pous[0].variables(m.SectionKind.INPUT):
        variable.initial = m.SimpleValue(text={"x": "7", "r": "2.5", "w": "1"}[variable.name])
    assert sfc.simulate(seen, pou="Lad", scans=1)["o"][0] == value


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
@pytest.mark.parametrize("name", LACKED)
def test_boxes_without_a_counterpart_are_not_executed(name: str, target: str) -> None:
    report = convert(sfc.loads(LACKED[name]), target, partial=True)[1]
    assert [item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)] == ["box"]


def test_what_rounds_otherwise_is_told() -> None:
    source = block("Round", (("in", "r"),), "out", {"SrcType": "Real", "DestType": "Int"}, "Int")
    report = convert(sfc.loads(source), "codesys")[1]
    assert "2.5 is 3 in CODESYS" in report.with_outcome(Outcome.APPROXIMATED)[0].why
    assert not convert(sfc.loads(source), "plcopen-2.01")[1].losses
