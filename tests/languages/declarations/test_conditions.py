"""Conditions of CODESYS V3 around declarations: read, written, told where a tool has none, and kept in edits."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Project
from plcopen_sfc.report import Outcome

HEAD = "{plcopen_sfc format := 1}\n{plcopen_sfc project.dialect := 'codesys'}\n"
UNIT = """<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <POU Name="Fb" Id="{11111111-1111-1111-1111-111111111111}" SpecialFunc="None">
    <Declaration><![CDATA[FUNCTION_BLOCK Fb
@]]></Declaration>
    <Implementation>
      <ST><![CDATA[;]]></ST>
    </Implementation>
  </POU>
</TcPlcObject>"""
SECTION = """VAR
\ta : INT;
\t{IF defined (X)}
\td : INT;
\te : INT;
\t{ELSE}
\tf : INT;
\t{END_IF}
\tg : INT;
\t{IF defined (Y)}
\th : INT;
\t{END_IF}
END_VAR
"""
STRUCTURE = SECTION.replace("END_VAR", "END_STRUCT\nEND_TYPE").replace("VAR\n", "TYPE Rec :\nSTRUCT\n", 1)
LISTED = UNIT.replace("FUNCTION_BLOCK Fb\n", "").replace(' SpecialFunc="None"', "").split("    <Implementation>")[0]


def unit(text: str) -> bytes:
    """Return a file of TwinCAT with a section of a block, a list of global variables or a type."""
    if text.startswith("VAR\n"):
        return UNIT.replace("@", text).encode()
    kind = "GVL" if text.startswith("VAR_GLOBAL") else "DUT"
    return f"{LISTED.replace('POU', kind).replace('@', text)}  </{kind}>\n</TcPlcObject>".encode()


FORMS = [SECTION, SECTION.replace("VAR\n", "VAR_GLOBAL\n", 1), STRUCTURE]


def lines_of(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines()]


@pytest.mark.parametrize("text", FORMS, ids=["block", "list", "type"])
@pytest.mark.parametrize("target", ["codesys-export", "iec-text"])
def test_conditions_stay_around_what_they_are_about(text: str, target: str) -> None:
    data, report = sfc.convert(sfc.loads(unit(text)), target)
    assert not report.losses
    written = [line.partition(">")[2] or line for line in lines_of(data.decode("utf-8-sig"))]
    first = written.index("a : INT;")
    assert written[first : first + 11] == lines_of(text)[text.splitlines().index("\ta : INT;") :][:11]


@pytest.mark.parametrize("text", FORMS, ids=["block", "list", "type"])
@pytest.mark.parametrize("target", ["codesys23", "plcopen", "codesys", "scl", "simaticml"])
def test_tools_without_conditions_are_told(text: str, target: str) -> None:
    data, report = sfc.convert(sfc.loads(unit(text)), target, partial=True)
    found = [each.why for each in report.with_outcome(Outcome.NOT_EXECUTED) if "{IF defined" in each.why]
    assert len(found) == (1 if text is STRUCTURE else 2)
    if target == "codesys23":
        assert not [line for line in lines_of(data.decode()) if line.startswith(("{IF", "{END_IF", "{ELSE"))]


X = SECTION[SECTION.index("\t{IF") : SECTION.index("\tg")]
Y = SECTION[SECTION.index("\t{IF defined (Y)}") : SECTION.index("END_VAR")]


@pytest.mark.parametrize("text", FORMS, ids=["block", "list", "type"])
@pytest.mark.parametrize(
    ("taken_out", "gone"),
    [("d", ""), ("e", ""), ("f", ""), ("g", ""), ("h", Y), ("de", ""), ("def", X), ("defgh", X), ("efg", "")],
)
def test_a_variable_that_is_taken_out_leaves_a_whole_condition(text: str, taken_out: str, gone: str) -> None:
    project = sfc.loads(unit(text))
    for holder in variables_of(project):
        holder[:] = [each for each in holder if each.name not in taken_out]
    data, report = sfc.convert(project)
    assert not report.losses
    left = text.replace(gone, "")
    left = left.replace(Y, "") if "h" in taken_out else left
    for name in taken_out:
        left = left.replace(f"\t{name} : INT;\n", "")
    assert data == unit(left)
    assert sfc.loads(data).pous == project.pous
    assert sfc.loads(data).data_types == project.data_types


def variables_of(project: Project) -> list[list[sfc.model.Variable]]:
    sections = [section.variables for pou in project.pous for section in pou.interface.sections]
    sections += [section.variables for section in project.global_variables]
    return sections + [each.type.members for each in project.data_types]
