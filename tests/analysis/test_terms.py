"""Programs that calculate with numbers are proven where both do the same with them."""

from __future__ import annotations

from collections.abc import Callable
from operator import add, and_, ge, gt, le, lt, mul, ne, neg, or_, sub, xor
from random import Random
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalence, equivalent
from plcopen_sfc.analysis.domains import NotProvableError
from plcopen_sfc.analysis.number_terms import Answers, Term
from plcopen_sfc.analysis.product import Branching, Explored
from plcopen_sfc.model import ActionAssociation, Qualifier, SfcNetwork, StBody
from tests.analysis.schemes import chart_of, program, ring

VARIABLES = "n, m, k : INT; Q, b : BOOL; s : STRING; f : ARRAY [0..9] OF INT; d : DINT; x : LREAL; t : TON; l : TIME;"


def code(body: str) -> sfc.model.Pou:
    lines = ["PROGRAM Code", "VAR_INPUT i, j : INT; c : BOOL; p : TIME; r : LREAL; END_VAR"]
    lines += [f"VAR {VARIABLES} END_VAR", body, "END_PROGRAM", ""]
    return sfc.loads("\n".join(lines).encode(), format="iec-text").pous[0]


def compared(left: str, right: str, *outputs: str) -> Verdict:
    return equivalent(code(left), code(right), "iec", outputs=list(outputs), cap=60, runs=12, scans=30)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("n := n + 1;", "IF TRUE THEN n := n + 1; END_IF;"),
        ("n := i + j; Q := n > 7;", "m := i; n := m + j; Q := NOT (NOT (n > 7));"),
        ("IF c THEN n := n + i; END_IF; Q := n >= m; m := j;",
         "b := c; IF b THEN n := n + i; END_IF; Q := n >= m; m := j;"),
        ("n := i; Q := i > j;", "Q := i > j; n := i;"),
        ("IF c THEN n := 0; ELSE n := n + 1; END_IF;", "n := n + 1; IF c THEN n := 0; END_IF;"),
        ("n := n * 3 - i; m := -n; Q := m = n;", "n := n * 3 - i; Q := -n = n; m := -n;"),
        ("CASE n OF 1: Q := c; 2: Q := NOT c; ELSE Q := FALSE; END_CASE; n := n + i;",
         "b := c; CASE n OF 1: Q := b; 2: Q := NOT b; ELSE Q := FALSE; END_CASE; n := n + i;"),
        ("x := r * 2.0; Q := x > 1.0;", "x := r * 2.0; Q := x > 1.0;"),
    ],
)  # fmt: skip
def test_the_same_calculations_are_proven(left: str, right: str) -> None:
    names = [name for name in ("n", "m", "Q") if f"{name} :=" in left]
    verdict = compared(left, right, *names)
    assert verdict.proven, str(verdict)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("n := n + 1;", "n := n + 2;"),
        ("n := n + 1;", "IF n < 20 THEN n := n + 1; ELSE n := 0; END_IF;"),
        ("n := i + j;", "n := i - j;"),
        ("Q := i + 1 > j;", "Q := i + 1 >= j;"),
        ("n := n + i; IF n > 3 THEN n := 0; END_IF;", "n := n + i; IF n > 4 THEN n := 0; END_IF;"),
        ("n := i + 1; Q := n > 3; m := j;", "n := i + 1; Q := n > 3; m := n;"),
        ("CASE n OF 1: Q := c; 2: Q := NOT c; ELSE Q := FALSE; END_CASE; n := (n + 1) MOD 4;",
         "CASE n OF 1: Q := c; 3: Q := NOT c; ELSE Q := FALSE; END_CASE; n := (n + 1) MOD 4;"),
    ],
)  # fmt: skip
def test_other_calculations_are_different(left: str, right: str) -> None:
    names = [name for name in ("n", "m", "Q") if f"{name} :=" in left]
    assert compared(left, right, *names).kind is VerdictKind.DIFFERENT


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("n := i + j;", "n := j + i;"),
        ("n := i * 2;", "n := i + i;"),
        ("Q := i + 1 > 5;", "Q := i > 4;"),
        ("f[0] := i; n := f[0]; m := i + 1;", "n := i; m := i + 1; k := f[m AND 7];"),
        ("n := n / 3 + i;", "n := n / 3 + i;"),
        ("s := INT_TO_STRING(i + 1); Q := s = '5';", "s := INT_TO_STRING(i + 1); Q := s = '5';"),
    ],
)
def test_what_cannot_be_said_of_terms_is_tried(left: str, right: str) -> None:
    names = [name for name in ("n", "m", "Q") if f"{name} :=" in left]
    verdict = compared(left, right, *names)
    assert verdict.kind is not VerdictKind.PROVEN
    assert verdict.reason or verdict.counterexample is not None  # an overflow of Q := i + 1 > 5 is a difference


def test_a_chart_that_counts_is_proven() -> None:
    chart: SfcNetwork = chart_of(ring(2))
    counting = ActionAssociation(id=100, qualifier=Qualifier.P1, body=StBody(text="n := n + i;"))
    chart.steps[1].actions.append(counting)
    project = sfc.Project(pous=[code("").model_copy(update={"bodies": [sfc.model.SfcBody(chart=chart)]})])
    text = """
    IF X0 THEN IF c0 THEN X0 := FALSE; X1 := TRUE; n := n + {0}; END_IF;
    ELSIF c1 THEN X1 := FALSE; X0 := TRUE; END_IF;
    """
    variables = ["X0 : BOOL := TRUE", "X1 : BOOL", "n : INT"]
    for amount, outcome in (("i", VerdictKind.PROVEN), ("i + 1", VerdictKind.DIFFERENT)):
        other = program(text.format(amount), ["c0", "c1"], variables)
        other.interface.sections.append(project.pous[0].interface.sections[0])  # type: ignore[union-attr]
        flags = {"S0": "X0", "S1": "X1"}
        found = equivalent(project.pous[0], other, "iec", step_flags=flags, outputs=["n"], cap=60, runs=12, scans=20)
        assert found.kind is outcome, str(found)


COUNTING = """INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S1 := c; END_TRANSITION
STEP S1: Count(P1); b(N); END_STEP TRANSITION FROM S1 TO S0 := n > i; END_TRANSITION
ACTION Count: n := n + 1; m := n * 2; END_ACTION
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("n + 1", "n + 2"),
        ("n * 2", "n + n - 1"),
        ("n > i", "n >= i"),
        ("n > i", "n > i + 1"),
        ("n > i", "m > i"),
        ("Count(P1)", "Count(P)"),
        ("Count(P1)", "Count(N)"),
        ("FROM S0 TO S1 := c", "FROM S0 TO S1 := NOT c"),
        ("m := n * 2", "IF n > 3 THEN m := n * 2; END_IF"),
    ],
)
def test_a_counter_is_proven_though_one_tool_is_a_scan_later(old: str, new: str) -> None:
    """40 seconds were spent on the values of a counter, and behind them was no proof."""
    text = f"PROGRAM P VAR_INPUT c : BOOL; i : INT; END_VAR VAR_OUTPUT n, m : INT; b : BOOL; END_VAR {COUNTING}"
    text += "END_PROGRAM"
    one, other = (sfc.loads(each.encode(), format="iec-text").pous[0] for each in (text, text.replace(old, new)))
    same = equivalent(one, one, ("iec", "codesys"), delay=1, cap=300, runs=6, scans=30)
    assert same.proven, str(same)
    for tools in (("iec", "codesys"), ("codesys", "iec")):
        found = equivalent(one, other, tools, delay="auto", cap=300, runs=12, scans=60)
        assert found.kind is VerdictKind.DIFFERENT, str(found)


def test_a_delay_of_the_side_that_is_never_later_is_a_difference() -> None:
    """A given delay that no tool makes ended with an error of the library."""
    text = f"PROGRAM P VAR_INPUT c : BOOL; i : INT; END_VAR VAR_OUTPUT n, m : INT; b : BOOL; END_VAR {COUNTING}"
    one = sfc.loads(f"{text}END_PROGRAM".encode(), format="iec-text").pous[0]
    found = equivalent(one, one, ("iec", "codesys"), delay=-1, cap=300, runs=6, scans=30)
    assert found.kind is VerdictKind.DIFFERENT
    assert found.counterexample is not None


def test_whatever_is_asked_of_a_term_holds_for_its_numbers() -> None:
    """Terms and numbers side by side: a way through the answers is the one that the numbers take."""
    random = Random(1)  # noqa: S311
    compare, calculate = [lt, le, gt, ge, ne], [add, sub, mul, and_, or_, xor]
    for _ in range(200):
        numbers = [random.randint(-9, 9) for _ in range(3)]
        answers = Answers()
        terms: list[Term] = [Term(("input", str(i)), answers) for i in range(3)]
        steps = [(random.choice(calculate), random.randrange(3), random.choice([0, 1, 2, -4])) for _ in range(6)]
        questions = [(random.choice(compare), random.randrange(9), random.randrange(9)) for _ in range(4)]
        known: list[Any] = list(numbers)
        held: list[Any] = list(terms)
        for operation, place, other in steps:
            right = random.random() < 0.5
            known.append(operation(other, known[place]) if right else operation(known[place], other))
            held.append(operation(other, held[place]) if right else operation(held[place], other))
        held[0], known[0] = neg(held[0]), neg(known[0])
        wanted = [question(known[a], known[b]) for question, a, b in questions]
        branching = Branching({})
        answers.branching = branching
        ways = [[question(held[a], held[b]) for question, a, b in questions] for _ in branching.combinations()]
        assert wanted in ways


def test_a_term_has_no_value() -> None:
    term = Term(("input", "n"), Answers())
    uses: list[Callable[[Any], object]] = [bool, int, float, hash, str, repr, round]
    for use in (*uses, lambda t: t // 2, lambda t: [0][t], lambda t: f"{t}", lambda t: t < "a"):
        with pytest.raises((NotProvableError, TypeError)):
            use(term)


@pytest.mark.slow
def test_proofs_with_terms_agree_with_searches_of_all_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small counters can be searched as they are: what terms prove holds there."""
    random = Random(3)  # noqa: S311
    parts = ["n := n + 1;", "IF c THEN n := 0; END_IF;", "Q := n > 3;", "IF n >= 6 THEN n := 2; END_IF;", "m := n;"]
    others = ["b := TRUE; n := n + 1;", "b := c; IF b THEN n := 0; END_IF;", "Q := n > 3 AND (c OR NOT c);", *parts[3:]]
    proven = different = 0
    for _ in range(40):
        order = random.sample(range(5), 5)
        swapped = order if random.random() < 0.5 else random.sample(range(5), 5)
        bodies = [[parts[i] for i in order], [others[i] for i in swapped]]
        sides = [code(" ".join([*body, "IF n > 9 THEN n := 9; END_IF;"])) for body in bodies]
        exact = equivalent(sides[0], sides[1], "iec", outputs=["n", "m", "Q"], cap=1_000, runs=0)
        assert exact.kind is not VerdictKind.TESTED
        with monkeypatch.context() as patch:
            patch.setattr(equivalence, "race", lambda *_: Explored(0, 0, complete=False, capped=True))
            found = equivalent(sides[0], sides[1], "iec", outputs=["n", "m", "Q"], cap=1_000, runs=0)
        assert not found.proven or exact.proven, bodies
        proven += found.proven
        different += exact.kind is VerdictKind.DIFFERENT
    assert proven > 0
    assert different > 0


@pytest.mark.slow
@pytest.mark.parametrize("tools", [("iec", "codesys"), ("codesys", "iec")])
def test_proofs_with_terms_of_charts_a_scan_apart_agree_with_searches(
    tools: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where one side gets its inputs later no number may be taken for that of another scan."""
    random = Random(5)  # noqa: S311
    conditions = ["c", "NOT c", "n > i", "n > 2", "n = m", "c AND n >= i", "TRUE"]
    statements = [
        "n := n + 1;",
        "n := n + i;",
        "m := n;",
        "m := i;",
        "IF c THEN n := 0; END_IF;",
        "IF n > i THEN m := 1; END_IF;",
    ]
    head = "PROGRAM P VAR_INPUT c : BOOL; i : INT (0..2); END_VAR VAR_OUTPUT n, m : INT (0..4); b : BOOL; END_VAR "
    bound = " IF n > 4 THEN n := 0; END_IF; IF m > 4 THEN m := 4; END_IF;"

    def drawn() -> list[str]:
        steps = [f"s{place} ({random.choice(['N', 'P1', 'P'])})" for place in range(2)]
        return [*random.choices(conditions, k=2), *steps, *random.choices(statements, k=2)]

    def chart(parts: list[str]) -> sfc.model.Pou:
        first, second, one, other, *bodies = parts
        text = (
            f"INITIAL_STEP S0: {one.replace('s0', 'A0')}; END_STEP TRANSITION FROM S0 TO S1 := {first}; END_TRANSITION "
        )
        text += f"STEP S1: {other.replace('s1', 'A1')}; b(N); END_STEP "
        text += f"TRANSITION FROM S1 TO S0 := {second}; END_TRANSITION "
        text += " ".join(f"ACTION A{place}: {body}{bound} END_ACTION" for place, body in enumerate(bodies))
        return sfc.loads(f"{head}{text} END_PROGRAM".encode(), format="iec-text").pous[0]

    outcomes = {True: 0, False: 0}
    for _ in range(15):
        parts = drawn()
        changed = [*parts]
        if random.random() < 0.7:
            place = random.randrange(6)
            changed[place] = drawn()[place]
        for delay in (1, -1, "auto"):
            sides = chart(parts), chart(changed)
            with monkeypatch.context() as patch:
                patch.setattr(equivalence, "race", lambda *_: Explored(0, 0, complete=False, capped=True))
                found = equivalent(*sides, tools, delay=delay, cap=4_000, runs=0)
            if found.proven:
                exact = equivalent(*sides, tools, delay=found.delay, cap=4_000, runs=0)
                assert exact.kind is not VerdictKind.DIFFERENT, (parts, changed, str(exact))
            outcomes[found.proven] += 1
    assert min(outcomes.values()) > 0
