"""Instruction list."""

from __future__ import annotations

import pytest

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.model import IlBody
from plcopen_sfc.semantics.programs import Controller, Instance
from tests.semantics.programs.running import project_of

VARIABLES = "a, b, c, q, s : BOOL; x, y, z : INT; r : REAL; t : TON; e : R_TRIG;"
MORE = "FUNCTION Twice : INT\nVAR_INPUT v : INT; END_VAR\nTwice := v * 2;\nEND_FUNCTION\n"


def run(text: str, **values: object) -> Instance:
    project = project_of(f"{MORE}PROGRAM Main\nVAR {VARIABLES} END_VAR\n;\nEND_PROGRAM")
    project.pou("Main").bodies = [IlBody(text=text)]
    instance = Controller(project, max_steps=1000).instance("Main")
    for name, value in values.items():
        instance[name] = value
    instance.scan()
    return instance


@pytest.mark.parametrize("a", [False, True])
@pytest.mark.parametrize("b", [False, True])
@pytest.mark.parametrize("c", [False, True])
def test_logic(a: bool, b: bool, c: bool) -> None:
    instance = run("LD a\nANDN b\nOR( c\nAND b\n)\nST q\nLD a\nXOR b\nNOT\nST s", a=a, b=b, c=c)
    assert instance["q"] is ((a and not b) or (c and b))
    assert instance["s"] is (a == b)


def test_the_operand_in_parentheses_may_start_behind_them() -> None:
    assert run("LD a\nOR(\nLD b\nAND c\n)\nST q", b=True, c=True)["q"] is True


def test_arithmetic_goes_on_with_what_was_stored() -> None:
    instance = run("LD x\nADD 5\nST y\nMUL 2\nSUB x\nST z\nGT 10\nST q\nLD 7\nDIV 2\nMOD 2\nST x", x=3)
    assert (instance["y"], instance["z"], instance["q"], instance["x"]) == (8, 13, True, 1)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("LD 1\nSUB x\nST y", {"y": -2}),
        ("LD 1\nST y\nLD 0\nST z", {"y": 1, "z": 0}),
        ("LD 1\nADD 1\nST y", {"y": 2}),
        ("LD 1\nADD r\nST r", {"r": 1.5}),
        ("LD 1\nLT x\nST q", {"q": True}),
        ("LD 1\nTwice\nST y", {"y": 2}),
        ("LD 1\nSUB( x\nADD 1\n)\nST y", {"y": -3}),
        ("LD 1\nAND 1\nST q\nLD 0\nORN a\nST s", {"q": True, "s": True}),
        ("LD 1\nST q\nLD 1\nS s\nLD 0\nNOT\nST c", {"q": True, "s": True, "c": True}),
    ],
)
def test_one_and_zero_are_numbers_where_the_instructions_behind_calculate(
    text: str, expected: dict[str, object]
) -> None:
    instance = run(text, x=3, r=0.5)
    assert {name: instance[name] for name in expected} == expected
    assert {name: type(instance[name]) for name in expected} == {n: type(v) for n, v in expected.items()}


def test_set_reset_and_calls() -> None:
    instance = run(
        "LD a\nS s\nR q\nCAL t(IN := a, PT := T#0s)\nLD t.Q\nST c\nLD x\nTwice\nST y\nLD 3\nMAX x\nST z",
        a=True,
        q=True,
        x=4,
    )
    assert [instance[n] for n in ("s", "q", "c", "y", "z")] == [True, False, True, 8, 4]


@pytest.mark.parametrize(("a", "expected"), [(False, 6), (True, 100)])
def test_jumps(a: bool, expected: int) -> None:
    text = "LD a\nJMPC reset\nLD x\nADD 1\nJMP done\nreset:\nLD 100\ndone:\nST x\nST y"
    instance = run(text, a=a, x=5)
    assert (instance["x"], instance["y"]) == (expected, expected)


def test_conditional_calls_and_returns() -> None:
    instance = run("LD a\nCALCN e(CLK := TRUE)\nRETCN\nLD TRUE\nST q", a=False)
    assert (instance["e.Q"], instance["q"]) == (True, False)


def test_endless_jumps_are_errors() -> None:
    with pytest.raises(SimulationError, match="does not end"):
        run("again: LD x\nJMP again")


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("ST x", "used before it is loaded", 1),
        ("LD x\nFOO y", "FOO is not known", 2),
        ("LD x\nDIV 0\nST x", "division by zero", 2),
        ("LD a\n)", "was not opened", 2),
        ("LD x\nST", "wants one operand", 2),
    ],
)
def test_errors_tell_the_line(text: str, message: str, line: int) -> None:
    with pytest.raises(SimulationError, match=message) as caught:
        run(text)
    assert (caught.value.pou, caught.value.location.line) == ("Main", line)
