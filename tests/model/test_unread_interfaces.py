"""Declarations without faults are read when a script first looks at them, which no script sees."""

from __future__ import annotations

import random
import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Interface, Project
from tests.samples import FIXTURES

BELT = FIXTURES / "twincat-belt" / "POUs" / "Ablauf_Band.TcPOU"
UNIT = "FUNCTION_BLOCK Fill\n{}\n;\nEND_FUNCTION_BLOCK\n"
SECTION = """VAR_INPUT RETAIN
    {attribute 'hide'}
    Level, Limit : INT := -3; // of the tank
    Delay AT %MD4 : TIME := T#3S500MS;
    Pump : lib.FB_Pump := (Speed := 50, Direction := Up);
    Name : STRING(80) := 'A;B';
    (* all of them *)
    Values : ARRAY [0..9, 1..Last] OF POINTER TO REAL := [1.5, 2, other];
    Next : REFERENCE TO INT;
END_VAR"""


def interface_of(project: Project) -> Interface:
    interface = project.pous[0].interface
    assert interface is not None
    return interface


def test_a_chart_is_read_edited_and_saved_without_the_declarations() -> None:
    project = sfc.load(BELT)
    chart = project.pous[0].chart
    assert chart is not None
    assert len(chart.steps) > 2
    assert interface_of(project).is_unread
    assert sfc.dumps(project) == BELT.read_bytes()
    assert interface_of(project).is_unread
    variables = interface_of(project).variables()
    assert sfc.dumps(project) == BELT.read_bytes()
    variables[0].comment = "edited"
    assert b"edited" in sfc.dumps(project)


def test_late_declarations_are_as_declared() -> None:
    project = sfc.loads(UNIT.format(SECTION).encode(), format="iec-text")
    assert interface_of(project).is_unread
    (section,) = interface_of(project).sections
    assert (section.kind, section.retain) == ("input", True)
    assert [each.name for each in section.variables] == "Level Limit Delay Pump Name Values Next".split()
    assert [str(each.comment) for each in section.variables[:2]] == ["of the tank"] * 2
    assert section.variables[2].address == "%MD4"
    with_fault = sfc.loads(UNIT.format(SECTION + "\nVAR a : ; END_VAR").encode(), format="iec-text")
    assert not interface_of(with_fault).is_unread
    assert interface_of(with_fault).sections[0] == section


def test_a_variable_of_late_declarations_gets_another_name() -> None:
    text = UNIT.format(SECTION)
    project = sfc.loads(text.encode(), format="iec-text")
    project.rename("Fill.Pump", "Motor")
    assert sfc.dumps(project).decode() == text.replace(" Pump :", " Motor :")


def test_control_characters_in_late_declarations_are_refused_by_xml() -> None:
    text = UNIT.format(SECTION.replace("tank", "ta\x0bnk"))
    project = sfc.loads(text.encode(), format="iec-text")
    assert interface_of(project).is_unread
    with pytest.raises(sfc.ModelError, match=r"U\+000B"):
        sfc.dumps(project, format="plcopen")


@pytest.mark.parametrize(
    "fault",
    ["Level, : INT;", "Level : ;", "Level INT;", "Level : INT := (1;", "Level : ARRAY [0] OF INT;", "'"],
)
def test_a_fault_in_declarations_is_found_when_the_file_is_loaded(fault: str) -> None:
    text = BELT.read_bytes().decode("utf-8-sig").replace("END_VAR", f"\t{fault}\r\nEND_VAR", 1)
    project = sfc.loads(text.encode(), format="twincat")
    assert project.source is not None
    lines = [each.location.line for each in project.source.diagnostics]  # before anything is read
    assert text[: text.index(fault)].count("\n") + 1 in lines
    assert not interface_of(project).is_unread


def test_no_fault_is_found_in_late_declarations() -> None:
    """Change two tokens of a section: what is read late has no fault, and the same variables as when read at once."""
    numbers = random.Random(7)  # noqa: S311  # chance for a test
    tokens = re.findall(r"\(\*.*?\*\)|//.*|\w+|\s+|:=|\.\.|[^\w\s]", SECTION)
    other = [
        *tokens,
        *"IF NOT 16#ZZ 1.2 ' \" % ^ x OF TYPE TITLE REGION R_EDGE S= REF_TO STRUCT 1B1 AT ? + __TRY".split(),
    ]
    late = 0
    for _ in range(400):
        changed = list(tokens)
        for _ in range(numbers.randrange(1, 3)):
            place = numbers.randrange(2, len(changed) - 2)
            changed[place : place + numbers.randrange(2)] = numbers.choices(other, k=numbers.randrange(2))
        text = UNIT.format("".join(changed))
        project = sfc.loads(text.encode(), format="iec-text")
        if project.pous and interface_of(project).is_unread:
            late += 1
            at_once = sfc.loads(
                text.replace("END_FUNCTION", "VAR a : ; END_VAR END_FUNCTION").encode(), format="iec-text"
            )
            assert (
                interface_of(project).sections == interface_of(at_once).sections[: len(interface_of(project).sections)]
            )
            assert not [each for each in project.diagnostics if each.code == "IEC111"], text
    assert late > 50
