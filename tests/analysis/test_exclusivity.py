"""True if conditions exclude each other: against evaluation of every situation, and case by case."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import product
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.analysis.exclusivity import Truth, condition_of, covered, exclusive, truth
from plcopen_sfc.analysis.knowledge import ValueKind, VariableValues
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import LiteralKind, LiteralValue, literal_value
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import NamedCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import NamedTransition
from plcopen_sfc.model.sfc import BodyCondition
from tests.analysis.nets import chart_of
from tests.sweeps import examples

Evaluate = Callable[[dict[str, Any]], Any]

# -- conditions at random, each with a Python function that evaluates it

_COMPARISONS = {
    "=": operator.eq,
    "<>": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
    "<=": operator.le,
    ">=": operator.ge,
}
_CONNECTIVES: dict[str, Callable[[bool, bool], bool]] = {
    "AND": lambda a, b: a and b,
    "OR": lambda a, b: a or b,
    "XOR": lambda a, b: a is not b,
    "AND_THEN": lambda a, b: a and b,
    "=": lambda a, b: a is b,
    "<>": lambda a, b: a is not b,
}


@st.composite
def comparisons(draw: st.DrawFn) -> tuple[str, Evaluate]:
    left = draw(st.sampled_from("xy"))
    symbol = draw(st.sampled_from(sorted(_COMPARISONS)))
    compare = _COMPARISONS[symbol]
    right = draw(st.sampled_from("xy") | st.integers(-1, 4))
    text = f"({left} {symbol} {right})" if draw(st.booleans()) else f"(({right}) {symbol} {left})"
    swapped = not text.startswith(f"({left} ")

    def evaluate(values: dict[str, Any]) -> bool:
        other = values[right] if isinstance(right, str) else right
        return bool(compare(other, values[left]) if swapped else compare(values[left], other))

    return text, evaluate


def leaves() -> st.SearchStrategy[tuple[str, Evaluate]]:
    def variable(name: str) -> tuple[str, Evaluate]:
        return name, lambda values: values[name]

    def constant(value: bool) -> tuple[str, Evaluate]:
        return str(value).upper(), lambda _: value

    return st.sampled_from("abc").map(variable) | comparisons() | comparisons() | st.booleans().map(constant)


def joined(inner: st.SearchStrategy[tuple[str, Evaluate]]) -> st.SearchStrategy[tuple[str, Evaluate]]:
    def negate(part: tuple[str, Evaluate]) -> tuple[str, Evaluate]:
        return f"NOT ({part[0]})", lambda values: not part[1](values)

    def join(a: tuple[str, Evaluate], symbol: str, b: tuple[str, Evaluate]) -> tuple[str, Evaluate]:
        connect = _CONNECTIVES[symbol]
        # a leaf of two constants or names has no operand that tells that it is Boolean
        marked = f"(({a[0]}) OR FALSE)" if symbol in ("=", "<>") else f"({a[0]})"
        return f"({marked} {symbol} ({b[0]}))", lambda values: connect(bool(a[1](values)), bool(b[1](values)))

    return inner.map(negate) | st.builds(join, inner, st.sampled_from(sorted(_CONNECTIVES)), inner)


def conditions() -> st.SearchStrategy[tuple[str, Evaluate]]:
    return st.recursive(leaves(), joined, max_leaves=6)


def situations(numbers: list[Any]) -> Iterator[dict[str, Any]]:
    for values in product((False, True), (False, True), (False, True), numbers, numbers):
        yield dict(zip("abcxy", values, strict=True))


def integers(tree: Any) -> VariableValues | None:
    return VariableValues(ValueKind.INTEGER, 0, 3) if isinstance(tree, n.Name) and tree.identifier in "xy" else None


def of_witness(witness: dict[str, str]) -> dict[str, Any]:
    found: dict[str, Any] = {"a": False, "b": False, "c": False, "x": 0, "y": 0}
    return found | {name: literal_value(value).value for name, value in witness.items()}


@settings(deadline=None, max_examples=examples(60))
@given(conditions(), conditions())
def test_integers_of_a_known_range_are_decided_as_by_evaluation(
    a: tuple[str, Evaluate], b: tuple[str, Evaluate]
) -> None:
    both = any(a[1](values) and b[1](values) for values in situations([0, 1, 2, 3]))
    found = exclusive(a[0], b[0], knowledge=integers)
    assert found.answer is (Answer.NO if both else Answer.YES)
    if both:
        values = of_witness(dict(found.witness))
        assert a[1](values)
        assert b[1](values)


@settings(deadline=None, max_examples=examples(60))
@given(conditions())
def test_constants_are_found_as_by_evaluation(condition: tuple[str, Evaluate]) -> None:
    seen = {bool(condition[1](values)) for values in situations([0, 1, 2, 3])}
    expected = {frozenset({True}): Truth.ALWAYS, frozenset({False}): Truth.NEVER}.get(frozenset(seen), Truth.VARIES)
    assert truth(condition[0], knowledge=integers) is expected


@settings(deadline=None, max_examples=examples(60))
@given(conditions(), st.lists(conditions(), max_size=2))
def test_cover_is_found_as_by_evaluation(condition: tuple[str, Evaluate], others: list[tuple[str, Evaluate]]) -> None:
    left = any(condition[1](v) and not any(o[1](v) for o in others) for v in situations([0, 1, 2, 3]))
    found = covered(condition[0], [text for text, _ in others], knowledge=integers)
    assert found is (Answer.NO if left else Answer.YES)


@settings(deadline=None, max_examples=examples(80))
@given(conditions(), conditions())
def test_numbers_of_unknown_type_are_never_decided_wrongly(a: tuple[str, Evaluate], b: tuple[str, Evaluate]) -> None:
    # every order of two numbers among the constants -1 to 4, with fractions between them
    whole = any(a[1](v) and b[1](v) for v in situations(list(range(-4, 8))))
    thirds = [Fraction(i, 3) for i in range(-6, 16)]
    real = whole or any(a[1](v) and b[1](v) for v in situations(thirds))
    found = exclusive(a[0], b[0])
    expected = Answer.NO if whole else Answer.UNKNOWN if real else Answer.YES
    # two names that are compared with each other only may be of any type
    assert found.answer is expected or ("type of" in found.reason and found.answer is Answer.UNKNOWN)


# -- whatever people write


def ill_typed() -> st.SearchStrategy[str]:
    words = st.sampled_from(
        "a b i r t s e u 1 0 TRUE 2.5 T#5s 'x' E#one D#2024-01-01 %IX0.0 u.3 f(i) ABS(r) -i i+1 g.h l[2] W#16#F".split()
    )

    def combine(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
        operators = st.sampled_from("AND OR XOR AND_THEN OR_ELSE = <> < > <= >= + * MOD".split())
        joined = st.builds("({} {} {})".format, inner, operators, inner)
        return joined | inner.map("NOT ({})".format) | inner.map("-({})".format)

    return st.recursive(words, combine, max_leaves=6)


def of_all_kinds(tree: Any) -> VariableValues | None:
    domains = {
        "b": VariableValues(ValueKind.BOOL),
        "i": VariableValues(ValueKind.INTEGER, 0, 9),
        "r": VariableValues(ValueKind.REAL),
        "t": VariableValues(ValueKind.DURATION),
        "s": VariableValues(ValueKind.SYMBOL),
        "e": VariableValues(ValueKind.SYMBOL, symbols=("one", "two")),
    }
    return domains.get(tree.identifier) if isinstance(tree, n.Name) else None


@settings(deadline=None, max_examples=examples(80))
@given(ill_typed(), ill_typed(), st.sampled_from([None, of_all_kinds]))
def test_any_condition_gets_an_answer(a: str, b: str, knowledge: Any) -> None:
    found = exclusive(a, b, knowledge=knowledge)
    assert {exclusive(b, a, knowledge=knowledge).answer, found.answer} != {Answer.YES, Answer.NO}
    assert bool(found.reason) == (found.answer is Answer.UNKNOWN)
    if truth(a, knowledge=knowledge) is Truth.NEVER:
        assert found.answer is not Answer.NO


# -- case by case


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ("A", "NOT A"),
        ("Start AND NOT Fault", "fault"),
        ("A AND B", "NOT (A AND B)"),
        ("A OR B", "NOT A AND NOT B"),
        ("A XOR B", "A AND B"),
        ("Level > 50", "Level <= 50"),
        ("Level > 50", "50 >= Level"),
        ("x > 5.5", "x < 5.5"),
        ("x > -5", "x = -7"),
        ("x = 16#FF", "x = 254"),
        ("Fill.T >= T#5s", "Fill.T < T#4s"),
        ("now < TOD#12:00:00", "now > TOD#13:00:00"),
        ("day = D#2024-02-29", "day = D#2024-03-01"),
        ("Mode = E_Mode#Auto", "Mode = E_Mode#Hand"),
        ("Recipe = 'cake'", "Recipe = 'bread'"),
        ("Recipe = 'A'", "Recipe = '\\u{41}'"),
        ("LEN(Recipe) > 3", "Recipe = 'pie'"),
        ("LEN(Recipe) > 3", "LEN(Recipe) < 4"),
        ("LEN(Recipe) < 0", "TRUE"),
        ("a < b", "b < a"),
        ("a < b AND b < c", "c < a"),
        ("GT(a, b)", "LE(a, b)"),
        ("ABS(x) > 5", "ABS(x) < 4"),
        ("x + y > 5", "x + y < 4"),
        ("Q = TRUE", "NOT Q"),
        ("Q = FALSE", "Q"),
        ("%IX0.0", "NOT %IX0.0"),
        ("FALSE", "Tank.Valve[3].Open"),
    ],
)
def test_these_exclude_each_other(a: str, b: str) -> None:
    found = exclusive(a, b)
    assert found.answer is Answer.YES, found
    assert found
    assert not found.witness


@pytest.mark.parametrize(
    ("a", "b", "witness"),
    [
        ("A", "B", {"A": "TRUE", "B": "TRUE"}),
        ("A", "TRUE", {"A": "TRUE"}),
        ("x > 5", "x < 7", {"x": "6"}),
        ("x >= 5", "x <= 5", {"x": "5"}),
        ("t >= T#5s", "t <= T#5s", {"t": "T#5s"}),
        ("c = Color#red", "c <> Color#blue", {"c": "red"}),
        ("LEN(s) > 2", "s = 'Öl$$' OR s = 'a'", {"s": "'Öl$$'"}),
    ],
)
def test_these_do_not_and_here_is_when(a: str, b: str, witness: dict[str, str]) -> None:
    found = exclusive(a, b)
    assert found.answer is Answer.NO, found
    assert not found
    assert found.witness == witness


@pytest.mark.parametrize(
    ("a", "b", "reason"),
    [
        ("Check(x)", "NOT Check(x)", "the value of Check(x) is not known"),
        ("x + 1 > 5", "x < 3", "the value of x + 1 is not known"),
        ("Door[i]", "NOT Door[j]", "the value of Door[i] is not known"),
        ("x > 5", "x < 6", "it depends on whether x can be a fraction"),
        ("w.3", "w = 0", "w and w.3 depend on each other"),
        ("A", "B AND (C := TRUE)", "C := TRUE"),
        ("a = b", "a = c", "the type of a and b is not known"),
        ("A AND", "NOT A", "'A AND'"),
        ("T#5s", "A", "T#5s is no Boolean value"),
        ("s < 'b'", "s > 'a'", "s < 'b' compares texts or names by size"),
        ("x = 5", "x = T#5s", "compares values of different types"),
    ],
)
def test_of_these_nobody_knows(a: str, b: str, reason: str) -> None:
    found = exclusive(a, b, dialect=Dialect.CODESYS)
    assert found.answer is Answer.UNKNOWN, found
    assert reason in found.reason


def test_types_decide_what_use_does_not_show() -> None:
    integer = VariableValues(ValueKind.INTEGER, -32768, 32767)
    real = VariableValues(ValueKind.REAL)
    assert exclusive("x > 5", "x < 6", knowledge=lambda _: integer).answer is Answer.YES
    found = exclusive("x > 5", "x < 6", knowledge=lambda _: real)
    assert found.answer is Answer.NO
    assert 5 < float(found.witness["x"]) < 6


def test_ranges_of_types_count() -> None:
    unsigned = VariableValues(ValueKind.INTEGER, 0, 255)
    assert truth("x >= 0", knowledge=lambda _: unsigned) is Truth.ALWAYS
    assert truth("x > 255", knowledge=lambda _: unsigned) is Truth.NEVER
    assert truth("x >= 0") is Truth.VARIES


def test_named_constants_count() -> None:
    constants = {n.Name("MAX"): 90, n.Name("MIN"): 10}

    def known(tree: n.Expression) -> LiteralValue | None:
        value = constants.get(tree) if isinstance(tree, n.Name) else None
        return LiteralValue(LiteralKind.INTEGER, value) if value is not None else None

    assert exclusive("x > MAX", "x < MIN", knowledge=known).answer is Answer.YES
    assert exclusive("x > MAX", "x < MIN").answer is Answer.UNKNOWN


def test_an_enumeration_has_no_other_values() -> None:
    lamp = VariableValues(ValueKind.SYMBOL, symbols=("red", "green"))

    def known(tree: n.Expression) -> VariableValues | None:
        return lamp if tree == n.Name("Lamp") else None

    neither = "Lamp <> Color#red AND Lamp <> Color#green"
    assert truth(neither, knowledge=known) is Truth.NEVER
    assert truth(neither) is Truth.VARIES


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("TRUE", Truth.ALWAYS),
        ("1", Truth.ALWAYS),
        ("BOOL#0", Truth.NEVER),
        ("A OR NOT A", Truth.ALWAYS),
        ("x > 5 AND x < 3", Truth.NEVER),
        ("A", Truth.VARIES),
        ("Check(x)", Truth.UNKNOWN),
        ("ABS(x) = ABS(x)", Truth.ALWAYS),
        ("Check(x) OR NOT Check(x)", Truth.UNKNOWN),
        ("A AND FALSE AND Check(x)", Truth.NEVER),
        ("A B", Truth.UNKNOWN),
        (":= A OR TRUE;", Truth.ALWAYS),
    ],
)
def test_when_a_condition_is_true(condition: str, expected: Truth) -> None:
    assert truth(condition) is expected


def test_a_condition_behind_others() -> None:
    assert covered("x > 5", ["x > 3"]) is Answer.YES
    assert covered("x > 5", ["x > 7", "NOT (x > 8)"]) is Answer.YES
    assert covered("x > 5", ["x > 7"]) is Answer.NO
    assert covered("x > 5", []) is Answer.NO
    assert covered("x > 5", ["x > "]) is Answer.UNKNOWN


def test_conditions_of_transitions_are_read_however_they_are_given() -> None:
    chart = chart_of("1>2 1>3")
    first, second = chart.transitions
    first.condition = NamedCondition(name="Done")
    second.condition = BodyCondition(body=StBody(text="NOT Ready;"))
    done = NamedTransition(name="Done", body=StBody(text="Done := Ready AND Start;"))
    read = [condition_of(chart, t, transitions=[done]) for t in chart.transitions]
    assert exclusive(*read).answer is Answer.YES


def test_what_is_written_on_the_way_may_differ_between_conditions() -> None:
    chart = chart_of("1>2 1>3")
    first, second = chart.transitions
    first.condition = BodyCondition(body=StBody(text="h := Ready; Done := h AND Start;"), name="Done")
    second.condition = BodyCondition(body=StBody(text="h := Start; Other := NOT h;"), name="Other")
    found = exclusive(*(condition_of(chart, t) for t in chart.transitions))
    assert found.answer is Answer.UNKNOWN
    assert "written while the condition is evaluated" in found.reason


def test_a_transition_without_condition_is_unknown() -> None:
    chart = chart_of("1>2 1>3")
    chart.transitions[0].condition = None
    found = exclusive(*(condition_of(chart, t) for t in chart.transitions))
    assert found.reason == "the transition has no condition"
