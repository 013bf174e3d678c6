"""Operators of CODESYS whose names begin with two underscores, and types as operands."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.languages.translation import translate
from plcopen_sfc.model.dialect import Dialect

TEXTS = """p := __NEW(INT);
p := __NEW(POINTER TO STRING, size);
p := __NEW(POINTER TO STRING(80), size);
p := __NEW(STRING(80), 10);
p := __NEW(ARRAY[0..3, 1..size] OF POINTER TO BYTE);
p := __NEW(REFERENCE TO INT, 3);
p := __NEW(POINTER TO POINTER TO lib.FB_Axis, 3);
p := __NEW(FB_Axis(a := 1, b := 2));
x := SIZEOF(ARRAY[0..3] OF INT);
__DELETE(p);
IF __ISVALIDREF(r) THEN x := 1; END_IF;
b := __QUERYINTERFACE(i, j);
b := NOT __QUERYPOINTER(i, p);
__TRY x := 1; __CATCH(exc) y := 2; __FINALLY z := 3; __ENDTRY
__TRY x := 1; __CATCH y := 2; __ENDTRY;
v := __VARINFO(x);
s := __POUNAME();
s := __POSITION();
b := __COMPARE_AND_SWAP(ADR(x), 1, 2);
x := __XADD(ADR(x), 1);""".splitlines()


@pytest.mark.parametrize("dialect", [Dialect.CODESYS, Dialect.TWINCAT])
@pytest.mark.parametrize("text", TEXTS)
def test_operators_are_read_and_printed(text: str, dialect: Dialect) -> None:
    parsed = parse_statements(text, dialect)
    assert parsed.problems == ()
    assert not any(isinstance(node, n.Unreadable) for node in walk(parsed.tree))
    again = parse_statements(print_node(parsed.tree), dialect)
    assert again.problems == ()
    assert again.tree == parsed.tree


@pytest.mark.parametrize("text", ["p := __NEW(POINTER TO T, 3);", "__DELETE(p);", "b := __ISVALIDREF(r);"])
def test_other_dialects_do_not_have_them(text: str) -> None:
    for target in (Dialect.SCL, Dialect.IEC):
        translated = translate(parse_statements(text, Dialect.CODESYS), target)
        assert not translated.exact
        assert any("left unchanged" in note.reason for note in translated.notes)


def test_names_in_types_are_names() -> None:
    source = (
        "TYPE T_Part : STRUCT a : INT; END_STRUCT; END_TYPE\nPROGRAM Main\n"
        "VAR p : POINTER TO T_Part; size : INT; END_VAR\n"
        "p := __NEW(POINTER TO T_Part, size);\np := __NEW(ARRAY[0..size] OF T_Part);\nEND_PROGRAM\n"
    )
    project = sfc.loads(source.encode())
    assert sfc.check_syntax(project) == []
    project.rename("T_Part", "T_Piece")
    project.rename("Main.size", "count")
    assert sfc.dumps(project).decode() == source.replace("T_Part", "T_Piece").replace("size", "count")
    with pytest.raises(SimulationError, match="__NEW is not known"):
        sfc.simulate(project, scans=1)
