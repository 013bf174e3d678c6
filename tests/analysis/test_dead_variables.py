"""Variables whose old values no scan looks at are no part of a state."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.dead_variables import dead_cells
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.analysis.timers import clocking
from plcopen_sfc.semantics.profile import profile
from plcopen_sfc.semantics.programs.runtime_types import leaves
from plcopen_sfc.semantics.subjects import resolve

VARIABLES = (
    "a, b, c, d : BOOL; n : INT; w : WORD; t : TON; e : R_TRIG; s : RS; m : Pair; u : Inner; r : POINTER TO BOOL;"
)
AROUND = """
TYPE Pair : STRUCT x : BOOL; y : BOOL; END_STRUCT END_TYPE
FUNCTION_BLOCK Inner VAR_INPUT i : BOOL; END_VAR VAR_OUTPUT o : BOOL; END_VAR o := i; END_FUNCTION_BLOCK
"""


def scratch(text: str, *observed: str, others: str = "", kind: str = "FUNCTION_BLOCK") -> set[str]:
    source = f"{AROUND} {others} {kind} Code VAR_INPUT i, k : BOOL; END_VAR VAR {VARIABLES} END_VAR {text} END_{kind}"
    subject = resolve(sfc.loads(source.encode(), format="iec-text"), "Code")
    instance = ProgramSystem(subject, profile("iec"), clocking([subject], None)).instance
    found = {(id(cells), slot) for cells, slot, _ in dead_cells(instance, observed)}
    return {path.casefold() for path, _, cells, slot in leaves(instance.frame) if (id(cells), slot) in found}


PLAIN = {"a", "b", "c", "d", "n", "w", "t.in", "t.pt", "t.q", "t.et", "e.clk", "e.q", "s.s", "s.r1", "s.q1"}
PLAIN |= {"m.x", "m.y", "u.i", "u.o"}


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("a := i; b := a;", set()),
        ("b := a; a := i;", {"a"}),
        ("IF i THEN a := k; ELSE a := TRUE; END_IF; b := a;", set()),
        ("IF i THEN a := k; END_IF; b := a;", {"a"}),
        ("IF i THEN a := k; ELSE RETURN; END_IF; b := a;", set()),
        ("CASE n OF 1: a := k; ELSE a := i; END_CASE; b := a;", {"n"}),
        ("CASE n OF 1: a := k; END_CASE; b := a;", {"n", "a"}),
        ("WHILE i DO a := k; EXIT; END_WHILE; b := a;", {"a"}),
        ("a := i; WHILE a DO a := k; END_WHILE;", set()),
        ("FOR n := 1 TO 3 DO b := NOT b; END_FOR;", {"n", "b"}),
        ("t(IN := i, PT := T#1s); a := t.Q;", {"t.q"}),
        ("t(IN := i); a := t.ET > T#1s;", {"t.pt", "t.q", "t.et"}),
        ("a := t.Q; t(IN := i, PT := T#1s);", {"t.q"}),
        ("t(i, T#1s);", {"t.in", "t.pt", "t.q", "t.et"}),
        ("e(CLK := i); a := e.Q;", set()),
        ("a := e.Q; e(CLK := i);", {"e.q"}),
        ("s(S := i, R1 := k); a := s.Q1;", {"s.q1"}),
        ("IF i THEN s(S := i, R1 := k); END_IF;", {"s.q1"}),
        ("s(S := i); ", {"s.q1", "s.r1"}),
        ("m.x := i; a := m.x; b := m.y;", {"m.y"}),
        ("u(i := k); a := u.o;", {"u.i", "u.o"}),
        ("a := Code.b; b := i;", {"b"}),
        ("w := 16#1; a := w.%X0;", set()),
        ("a := w.%X0; w := 16#1;", {"w"}),
    ],
)
def test_what_is_read_before_it_is_written_is_kept(text: str, kept: set[str]) -> None:
    assert PLAIN - scratch(text) == kept


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("LD i ST a LD a ST b", set()),
        ("LD a ST b LD i ST a", {"a"}),
        ("LD i S a LD a ST b", {"a"}),
        ("LD i JMPC over LD k ST a over: LD a ST b", {"a"}),
        ("LD i JMPC other LD k ST a JMP both other: LD TRUE ST a both: LD a ST b", set()),
        ("CAL t(IN:=i,PT:=T#1s) LD t.Q ST a", {"t.q"}),
        ("back: LD i JMPC out LD k JMPC back LD a JMPC back out: LD a ST b", PLAIN),  # loops that nothing is known of
    ],
)
def test_instructions_are_looked_through_as_statements_are(text: str, kept: set[str]) -> None:
    lines = re.sub(r" (?=(?:LD|ST|S|JMPC?|CAL)\b|\w+:)|(?<=:) ", "\n", text)
    assert PLAIN - scratch(lines) == kept


def test_what_is_looked_at_behind_a_scan_must_be_written_in_every_scan() -> None:
    assert {"a", "b"} <= scratch("a := i; b := k;", "a", "b")
    assert "a" not in scratch("IF k THEN a := i; END_IF;", "a")
    assert "a" in scratch("IF k THEN a := i; END_IF;", "b")
    assert "a" not in scratch("IF k THEN RETURN; END_IF; a := i;", "a")
    assert "a" not in scratch("b := a; IF i THEN a := k; ELSE RETURN; END_IF;")
    assert "e.q" in scratch("e(CLK := i);", "e.Q")
    assert "t.q" not in scratch("t(IN := i, PT := T#1s);", "t.Q")


@pytest.mark.parametrize("text", ["r := ADR(a); a := i;", "a := i; b := r^;", "a := i; JMP there; there: b := a;"])
def test_nothing_is_known_where_references_or_jumps_are_used(text: str) -> None:
    assert scratch(text) == set()


def test_variables_of_a_program_may_be_seen_by_others() -> None:
    reading = "FUNCTION_BLOCK Other VAR x : BOOL; END_VAR x := Code.a; END_FUNCTION_BLOCK"
    assert "a" in scratch("a := i;", kind="PROGRAM")
    assert scratch("a := i;", others=reading, kind="PROGRAM") == set()
