"""Statements: branches, loops, jumps, assignments."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as s

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs import Controller
from tests.semantics.programs.running import main, project_of
from tests.sweeps import examples


@pytest.mark.parametrize(("x", "y"), [(0, 1), (1, 2), (2, 3), (3, 3), (4, 3), (5, 4), (-1, 4), (9, 4)])
def test_branches(x: int, y: int) -> None:
    body = "CASE x OF 0: y := 1; 1: y := 2; 2..4: y := 3; ELSE y := 4; END_CASE"
    assert main(f"x : INT := {x}; y : INT;", body)["y"] == y
    chain = "IF x = 0 THEN y := 1; ELSIF x = 1 THEN y := 2; ELSIF x >= 2 AND x <= 4 THEN y := 3; ELSE y := 4; END_IF"
    assert main(f"x : INT := {x}; y : INT;", chain)["y"] == y


@settings(deadline=None, max_examples=examples(25))
@given(s.lists(s.lists(s.integers(-40, 40), min_size=1, max_size=3), min_size=1, max_size=25), s.booleans())
def test_the_first_label_of_many_is_taken(labels: list[list[int]], otherwise: bool) -> None:
    branches = "".join(f"{', '.join(map(str, own))}: y := {i + 1}; " for i, own in enumerate(labels))
    instance = main("x, y : INT;", f"y := 0; CASE x OF {branches}{'ELSE y := -1;' if otherwise else ''} END_CASE")
    for value in range(-41, 42):
        instance["x"] = value
        instance.scan()
        expected = next((i + 1 for i, own in enumerate(labels) if value in own), -1 if otherwise else 0)
        assert instance["y"] == expected


def test_loops() -> None:
    instance = main(
        "i, f, down, w, r, skipped, left : INT; steps : INT := 3;",
        """FOR i := 1 TO 10 BY steps DO f := f + i; END_FOR
        FOR i := 5 TO 1 BY -2 DO down := down * 10 + i; END_FOR
        WHILE w < 7 DO w := w + 2; END_WHILE
        REPEAT r := r + 1; UNTIL r >= 4 END_REPEAT
        FOR i := 1 TO 10 DO IF i MOD 2 = 0 THEN CONTINUE; END_IF skipped := skipped + i; END_FOR
        FOR i := 1 TO 10 DO IF i = 4 THEN EXIT; END_IF left := i; END_FOR""",
    )
    assert [instance[n] for n in ("f", "down", "w", "r", "skipped", "left", "i")] == [22, 531, 8, 4, 25, 3, 4]


def test_continue_in_repeat_goes_to_the_condition() -> None:
    body = "REPEAT n := n + 1; IF n < 3 THEN CONTINUE; END_IF m := m + 1; UNTIL n >= 5 END_REPEAT"
    instance = main("n, m : INT;", body)
    assert (instance["n"], instance["m"]) == (5, 3)


def test_exit_leaves_the_innermost_loop_only() -> None:
    body = "FOR i := 1 TO 3 DO FOR j := 1 TO 3 DO IF j = 2 THEN EXIT; END_IF n := n + 1; END_FOR END_FOR"
    assert main("i, j, n : INT;", body)["n"] == 3


def test_the_bound_of_for_is_taken_once() -> None:
    assert main("i, n : INT; last : INT := 3;", "FOR i := 1 TO last DO last := 10; n := n + 1; END_FOR")["n"] == 3


@pytest.mark.parametrize(
    "body",
    [
        "WHILE TRUE DO x := x + 1; END_WHILE",
        "REPEAT x := x + 1; UNTIL FALSE END_REPEAT",
        "FOR u := 0 TO 255 DO x := x + 1; END_FOR",
        "FOR x := 0 TO 10 DO x := x - 1; END_FOR",
    ],
)
def test_endless_loops_are_errors(body: str) -> None:
    with pytest.raises(SimulationError, match="the scan does not end") as caught:
        main("x : INT; u : USINT;", f"\n{body}")
    assert (caught.value.scan, caught.value.pou, caught.value.location.line) == (1, "Main", 1)


def test_return_leaves_the_body() -> None:
    assert main("x : INT;", "x := 1; IF x = 1 THEN RETURN; END_IF; x := 2;")["x"] == 1


def test_jumps_of_s7() -> None:
    body = """#n := 0;
    again: #n := #n + 1;
    IF #n < 5 THEN GOTO again; END_IF;
    IF #n = 5 THEN GOTO done; END_IF;
    #n := 100;
    done: #m := #n;"""
    instance = main("n, m : INT;", body, Dialect.SCL)
    assert (instance["n"], instance["m"]) == (5, 5)


def test_endless_jumps_are_errors() -> None:
    with pytest.raises(SimulationError, match="the scan does not end"):
        main("n : INT;", "a: #n := 1; GOTO a;", Dialect.SCL)


def test_assignments_of_the_dialects() -> None:
    instance = main("a, b : BOOL; c : BOOL := TRUE;", "a S= c; b R= c; c R= a;", Dialect.CODESYS)
    assert (instance["a"], instance["b"], instance["c"]) == (True, False, False)
    scl = main("i : INT := 5; k : INT := 3; n, m : INT;", "#i += 2; #k *= #i - 1; #n := #m := 9;", Dialect.SCL)
    assert (scl["i"], scl["k"], scl["n"], scl["m"]) == (7, 18, 9, 9)


def test_regions_mean_nothing() -> None:
    assert main("i : INT;", "REGION a\n#i := 3;\nEND_REGION", Dialect.SCL)["i"] == 3


def test_references() -> None:
    body = "p := ADR(a); p^ := 5; r REF= b; r := a + 1; ok := __ISVALIDREF(r); same := p = ADR(a);"
    instance = main("a, b : INT; p : POINTER TO INT; r : REFERENCE TO INT; ok, same : BOOL;", body, Dialect.CODESYS)
    assert [instance[n] for n in ("a", "b", "ok", "same")] == [5, 6, True, True]
    declared = "a : INT := 3; b : INT := 4; p : POINTER TO INT := ADR(b); s : Pair := (p := ADR(a)); c, d, e : INT; "
    declared += "l : ARRAY[0..1] OF POINTER TO INT := [ADR(a), ADR(b)];"
    more = "TYPE Pair : STRUCT p : POINTER TO INT; END_STRUCT; END_TYPE"
    instance = main(declared, "p^ := p^ + 1; c := s.p^; d := p^; e := l[1]^;", Dialect.CODESYS, more)
    assert [instance[n] for n in ("b", "c", "d", "e")] == [5, 3, 5, 5]
    with pytest.raises(SimulationError, match="leads to nothing"):
        main("p : POINTER TO INT;", "p^ := 5;", Dialect.CODESYS)


@pytest.mark.parametrize(("declared", "target"), [("a : INT;", "Get.Pump"), ("a : INT; Get : T_Get;", "Get.Pump")])
def test_a_reference_of_a_type_in_another_file_is_told_so(declared: str, target: str) -> None:
    """A single .TcPOU has none of the project's types: it said that the thing is no reference."""
    with pytest.raises((AssertionError, SimulationError), match=f"REF= needs the type of {target}, which nothing"):
        main(declared, f"{target} REF= a;", Dialect.CODESYS)


def test_logic_stops_early_but_calls_are_made() -> None:
    more = """FUNCTION Count : BOOL
    VAR_IN_OUT n : INT; END_VAR
    n := n + 1; Count := TRUE;
    END_FUNCTION"""
    instance = main("a, b : INT; f, x : BOOL;", "x := f AND Count(a); x := f AND_THEN Count(b);", Dialect.CODESYS, more)
    assert (instance["a"], instance["b"]) == (1, 0)


@pytest.mark.parametrize(
    ("variables", "body", "message"),
    [
        ("x : INT;", "WHILE x < 1 DO " * 30 + "x := 1;" + " END_WHILE;" * 30, "too deeply nested"),
        ("x : INT; a : ARRAY[0..1] OF INT;", "x := " + "a[" * 120 + "0" + "]" * 120 + "+ a[x];", "nested"),
        ("x : INT; a : ARRAY[0..9999, 0..9999] OF INT;", "a[1, 1] := 2;", "more than 1000000 elements"),
        ("a : ARRAY[0..999] OF ARRAY[0..999] OF ARRAY[0..9] OF INT;", "a[1][1][1] := 2;", "more than 1000000 elements"),
        ("x : INT;", "x := 99999999999999999999;", "fits no integer type"),
        ("x : INT;", "x := y[x];", "y is not declared, so its elements are not known"),
        ("x : INT;", "FOR x := 1 TO 5 BY 0 DO ; END_FOR", "would not end"),
        ("x : INT;", "EXIT;", "belong into a loop"),
        ("x : INT; b : BOOL;", "IF x THEN b := TRUE; END_IF", "a INT is where a BOOL must be"),
        ("x : INT; b : BOOL;", "x := b + 1;", "BOOL"),
        ("x : INT; s : STRING;", "s := x;", "INT cannot become STRING"),
        ("x : INT;", "CASE x OF x: x := 1; END_CASE", "no constant"),
    ],
)
def test_what_cannot_run_is_a_clear_error(variables: str, body: str, message: str) -> None:
    controller = Controller(project_of(f"PROGRAM Main\nVAR {variables} END_VAR\n{body}\nEND_PROGRAM"))
    instance = controller.instance("Main")
    assert controller.problems
    with pytest.raises(SimulationError, match=message) as caught:
        instance.scan()
    assert caught.value.pou == "Main"


@pytest.mark.slow
def test_long_chains_of_branches() -> None:
    chain = "".join(f"ELSIF x = {i} THEN y := {i}; " for i in range(1, 400))
    assert main("x : INT := 371; y : INT;", f"IF x = 0 THEN y := 0; {chain}END_IF")["y"] == 371


@pytest.mark.parametrize("dialect", [Dialect.IEC, Dialect.CODESYS, Dialect.SCL])
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1", True),
        ("0", False),
        ("NOT 0", True),
        ("on AND 1", True),
        ("0 OR (1)", True),
        ("on XOR 1", False),
        ("on = 1", True),
        ("0 <> on", True),
        ("n = 1", False),
        ("SEL(1, FALSE, on)", True),
    ],
)
def test_0_and_1_are_false_and_true_where_a_bool_must_be(text: str, expected: bool, dialect: Dialect) -> None:
    body = f"q := {text}; IF {text} THEN n := 2; END_IF;"
    instance = main("q : BOOL; on : BOOL := 1; n : INT;", body, dialect)
    assert (instance["q"], instance["n"]) == (expected, 2 if expected else 0)


def test_2_is_no_bool() -> None:
    controller = Controller(project_of("PROGRAM Main VAR q : BOOL; END_VAR IF 2 THEN q := TRUE; END_IF; END_PROGRAM"))
    with pytest.raises(SimulationError, match="is where a BOOL must be"):
        controller.instance("Main").scan()
