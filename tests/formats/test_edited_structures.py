"""Edits of the members of a structure change the lines of their declarations, in all texts that have one."""

from __future__ import annotations

import difflib
from collections.abc import Callable

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.types import StructType

STRUCTURE = """TYPE S :
STRUCT
	a,b : INT;   (* both *)
	c:INT := 3; (* third *)

	d, e, f:ARRAY[0..3] OF INT;
	g:BOOL;
END_STRUCT
END_TYPE
"""
FILES = {
    "codesys23": "(* @NESTEDCOMMENTS := 'Yes' *)\n(* @PATH := '' *)\n{}(* @END_DECLARATION := '0' *)\n",
    "iec-text": "{{plcopen_sfc project.dialect := 'codesys'}}\n\n{}",
    "twincat": """<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <DUT Name="S" Id="{{83f34227-1874-5d99-951d-78b5361783ab}}">
    <Declaration><![CDATA[{}]]></Declaration>
  </DUT>
</TcPlcObject>""",
}
EDITS: dict[str, tuple[Callable[[list[m.Variable]], object], list[str], int]] = {
    "name": (lambda of: setattr(of[0], "name", "x"), ["-a,b : INT;"], 1),
    "type": (lambda of: setattr(of[0], "type", "REAL"), ["-a,b : INT;"], 2),
    "start value": (lambda of: setattr(of[1], "initial", "7"), ["-a,b : INT;"], 2),
    "comment": (lambda of: setattr(of[0], "comment", "first"), ["-a,b : INT;"], 2),
    "start value of one alone": (lambda of: setattr(of[2], "initial", "7"), ["-c:INT := 3;"], 1),
    "one of a list less": (lambda of: of.pop(0), ["-a,b : INT;"], 1),
    "one less": (lambda of: of.pop(2), ["-c:INT := 3;"], 0),
    "one of a longer list less": (lambda of: of.pop(4), ["-d, e, f:ARRAY[0..3] OF INT;"], 2),
    "one more": (lambda of: of.append(m.Variable(name="new", type="INT")), [], 1),
    "one more in a list": (lambda of: of.insert(1, m.Variable(name="new", type="INT")), ["-a,b : INT;"], 3),
}


@pytest.mark.parametrize("format", FILES)
@pytest.mark.parametrize("edit", EDITS)
def test_an_edited_member_changes_the_lines_of_its_declaration(format: str, edit: str) -> None:
    """The whole type was laid out anew for one member of a list."""
    change, removed, count = EDITS[edit]
    text = FILES[format].format(STRUCTURE)
    project = sfc.loads(text.encode(), format=format)
    type_ = project.data_types[0].type
    assert isinstance(type_, StructType)
    change(type_.members)
    after = sfc.dumps(project)
    assert sfc.loads(after, format=format).data_types == project.data_types
    lines = [*difflib.unified_diff(text.splitlines(), after.decode().splitlines(), lineterm="", n=0)][2:]
    gone = [f"-{line[1:].partition('(*')[0].strip()}" for line in lines if line.startswith("-")]
    assert gone == removed
    assert len([line for line in lines if line.startswith("+")]) == count
