"""The search of two systems, on systems of a few lines whose behaviour is plain to see."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.analysis.domains import Domain, NotProvableError, Probe
from plcopen_sfc.analysis.product import Branching, Explored, ended
from plcopen_sfc.analysis.product import search as search_product
from plcopen_sfc.errors import ModelError, UnknownBehaviourError, UnstableChartError
from plcopen_sfc.semantics.signals import Signal, SignalKind
from tests.sweeps import examples

Read = Callable[[str], Any]
Step = Callable[[Any, Read], tuple[Any, tuple[Any, ...]]]
BOOL = Signal.elementary("BOOL")


class Machine:
    """A system from a function: state and inputs to the next state and what is seen."""

    def __init__(self, step: Step, start: Any) -> None:
        self.step, self.start = step, start
        self.state, self.seen = start, ()
        self.scans = 0

    def reset(self) -> None:
        self.state = self.start

    def scan(self, read: Read, *, first: bool) -> None:
        self.scans += 1
        self.state, self.seen = self.step(self.state, read)

    def observed(self) -> tuple[Any, ...]:
        return self.seen

    def snapshot(self) -> Any:
        return self.state

    def restore(self, snapshot: Any) -> None:
        self.state = snapshot


def search(left: Step, right: Step, start: Any = (0,), cap: int = 1000, **signals: Signal) -> Explored:
    names = signals or {"a": BOOL, "b": BOOL, "c": BOOL}
    domains = {name: Domain(name, signal) for name, signal in names.items()}
    return ended(search_product(Machine(left, start), Machine(right, start), domains, cap))


def counter(limit: int) -> Step:
    def step(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        count = min(state[0] + 1, limit) if read("a") else 0
        return (count,), (count == limit,)

    return step


def test_equal_machines_are_proven_equal() -> None:
    found = search(counter(5), counter(5))
    assert found.complete
    assert found.states == 6
    assert found.inputs is None


def test_the_difference_that_is_found_is_the_shortest() -> None:
    found = search(counter(5), counter(7))
    assert found.inputs == [{"a": True}] * 5


def test_only_inputs_that_are_read_make_branches() -> None:
    names = {f"i{number}": BOOL for number in range(200)}

    def ring(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        place = (state[0] + bool(read(f"i{state[0]}"))) % 200
        return (place,), (place,)

    left = Machine(ring, (0,))
    found = ended(search_product(left, Machine(ring, (0,)), {n: Domain(n, s) for n, s in names.items()}, 1000))
    assert found.complete
    assert left.scans == 2 * 201


def test_a_search_that_is_too_large_says_how_far_it_came() -> None:
    def growing(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        return (state[0] * 2 + read("a"),), ()

    found = search(growing, growing, cap=500)
    assert not found.complete
    assert found.states == 500
    assert found.depth == 8  # 2 + 4 + .. + 2 ** 8 = 510 states after 8 scans
    assert "more than 500 states" in found.reason


def threshold(test: Callable[[Any], bool]) -> Step:
    return lambda state, read: (state, (test(read("n")),))


INT = Signal.elementary("INT")
REAL = Signal.elementary("REAL")


@pytest.mark.parametrize(
    ("left", "right", "equal"),
    [
        (lambda n: n > 5, lambda n: n >= 6, True),
        (lambda n: n > 5, lambda n: n >= 5, False),
        (lambda n: n > 5, lambda n: n > 5, True),
        (lambda n: 0 < n < 10, lambda n: 1 <= n <= 9, True),
        (lambda n: 0 < n < 10, lambda n: 1 <= n <= 10, False),
        (lambda n: n in (1, 2, 3), lambda n: 1 <= n <= 3, True),
        (lambda n: n in (1, 3), lambda n: 1 <= n <= 3, False),
        (lambda n: n > 32767, lambda n: False, True),
        (lambda n: n >= 2.5, lambda n: n >= 3, True),
        (lambda n: n != 7, lambda n: n != 7, True),
        (lambda n: n < -100, lambda n: n < -101, False),
    ],
)
def test_integers_are_compared_in_all_their_intervals(
    left: Callable[[Any], bool], right: Callable[[Any], bool], *, equal: bool
) -> None:
    found = search(threshold(left), threshold(right), n=INT)
    assert found.complete is equal
    assert (found.inputs is None) is equal
    if found.inputs is not None:
        n = found.inputs[0]["n"]
        assert left(n) != right(n)


@settings(deadline=None, max_examples=examples(150))
@given(st.data())
def test_intervals_decide_as_every_value_does(data: st.DataObject) -> None:
    signal = Signal("INT", INT.kind, least=-8, greatest=8)
    constants = st.integers(-10, 10)
    operators: list[Callable[[Any, Any], Any]] = [
        lambda a, b: a < b,
        lambda a, b: a <= b,
        lambda a, b: a == b,
        lambda a, b: a != b,
        lambda a, b: b > a,
    ]
    tests = st.lists(st.tuples(st.sampled_from(operators), constants), min_size=1, max_size=4)
    sides = [data.draw(tests), data.draw(tests)]

    def decide(side: list[Any], n: Any) -> bool:
        result = False
        for operator, constant in side:
            result = bool(operator(n, constant)) != result
        return result

    truly = all(decide(sides[0], n) == decide(sides[1], n) for n in range(-8, 9))
    found = search(threshold(lambda n: decide(sides[0], n)), threshold(lambda n: decide(sides[1], n)), n=signal)
    assert found.complete is truly


def test_reals_are_compared_in_all_their_intervals() -> None:
    assert search(threshold(lambda n: n > 2.5), threshold(lambda n: not n <= 2.5), n=REAL).complete
    found = search(threshold(lambda n: n > 2.5), threshold(lambda n: n > 2.6), n=REAL)
    assert found.inputs is not None
    value = found.inputs[0]["n"]
    assert isinstance(value, float)
    assert 2.5 < value <= 2.6


@pytest.mark.parametrize(
    "use",
    [
        lambda n: n + 1 > 3,
        lambda n: 3 - n > 3,
        lambda n: -n > 3,
        lambda n: abs(n) > 3,
        lambda n: int(n) > 3,
        bool,
        lambda n: [True, False][n],
        lambda n: {1: True}.get(n, False),
        lambda n: n & 1 == 0,
        lambda n: round(n) > 1,
        lambda n: n > "a",
        lambda n: n.bit_length() > 2,
    ],
)
def test_whatever_else_is_done_with_a_number_ends_the_proof(use: Callable[[Any], bool]) -> None:
    found = search(threshold(use), threshold(use), n=INT)
    assert not found.complete
    assert found.inputs is None
    assert "n is" in found.reason or "cannot be followed" in found.reason


def test_a_number_that_is_put_out_is_compared_with_care() -> None:
    def put_out(value: Callable[[Any], Any]) -> Step:
        return lambda state, read: (state, (value(read("n")),))

    copy = put_out(lambda n: n)
    assert search(copy, copy, n=INT).complete
    assert search(copy, put_out(lambda n: 6 if n == 6 else n), n=INT).complete
    found = search(copy, put_out(lambda n: 6 if n > 5 else n), n=INT)
    assert found.inputs == [{"n": 7}]
    found = search(copy, lambda state, read: (state, (read("m"),)), n=INT, m=INT)
    assert "n is compared with m" in found.reason


@pytest.mark.parametrize("signal", [Signal("n", SignalKind.INTEGER, least=-6, greatest=9), REAL])
@settings(deadline=None, max_examples=examples(200))
@given(
    questions=st.lists(
        st.tuples(
            st.sampled_from(["__lt__", "__le__", "__gt__", "__ge__", "__eq__", "__ne__"]),
            st.integers(-16, 20).map(lambda half: half / 2),
        ),
        min_size=1,
        max_size=7,
    )
)
def test_numbers_are_split_as_far_as_they_are_asked(signal: Signal, questions: list[tuple[str, float]]) -> None:
    """The answers of all runs are those that the numbers of the type give, each with a number that gives them."""
    branching = Branching({"n": Domain("n", signal)}, {"n"})
    found = {}
    runs = 0
    for values in branching.combinations():
        runs += 1
        answers = tuple(getattr(branching.read("n"), operator)(constant) for operator, constant in questions)
        found[answers] = values["n"].value
    assert runs <= 2 * len(questions) + 1
    numbers: list[float] = [n / 4 for n in range(-40, 50)] if signal is REAL else list(range(-6, 10))
    expected = {tuple(getattr(float(n), operator)(constant) for operator, constant in questions) for n in numbers}
    assert set(found) == expected
    for answers, number in found.items():
        assert answers == tuple(getattr(float(number), operator)(constant) for operator, constant in questions)


def test_bounds_of_reals_belong_to_one_side_only() -> None:
    branching = Branching({"n": Domain("n", Signal.elementary("REAL"))}, {"n"})
    found = []
    for _ in branching.combinations():
        n = branching.read("n")
        found.append((n < 0.1, n <= 0.1, n > 1e300, n >= 3.4028234663852886e38, n > 3.4028234663852886e38))
    # 0.1 is no number of 32 bits, so nothing is equal to it; 1e300 is beyond all of them, their greatest is one of them
    assert sorted(found) == [
        (False, False, False, False, False),
        (False, False, False, True, False),
        (True, True, False, False, False),
    ]


def test_a_number_that_is_kept_is_followed() -> None:
    def late(limit: int) -> Step:
        return lambda state, read: ((read("n"),), (state[0] > limit,))

    assert search(late(5), late(5), n=INT).complete
    found = search(late(5), late(6), n=INT)
    assert found.inputs is not None
    assert [row["n"] for row in found.inputs][:1] == [6]
    assert len(found.inputs) == 2


def test_two_inputs_that_are_compared_with_each_other_end_the_proof() -> None:
    def step(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        return state, (read("m") < read("n"),)

    found = search(step, step, n=INT, m=INT)
    assert "m is compared with n" in found.reason


def test_enumerations_have_their_names() -> None:
    mode = Signal.enumeration("E", {0: "Off", 1: "On", 7: "Auto"})
    assert Domain("n", mode).options == (0, 1, 7)
    found = search(threshold(lambda n: n == 7), threshold(lambda n: n > 0), n=mode)
    assert found.inputs == [{"n": 1}]


def test_errors_are_compared_too() -> None:
    def failing(when: str) -> Step:
        def step(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
            if read(when):
                raise ModelError("division by zero")
            return state, ()

        return step

    both = search(failing("a"), failing("a"))
    assert both.complete
    assert both.notes == ("both end with an error: division by zero",)
    assert search(failing("a"), failing("b")).inputs == [{"a": False, "b": True}]


def test_what_cannot_be_executed_is_no_proof() -> None:
    def never(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        raise ModelError("a text with a mistake")

    with pytest.raises(ModelError, match="a mistake"):
        search(never, never)

    def unknown(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        if state[0] and read("a"):
            raise UnknownBehaviourError("nobody knows")
        return (1,), ()

    with pytest.raises(UnknownBehaviourError):
        search(unknown, unknown)


def test_a_chart_that_never_becomes_stable_is_not_followed() -> None:
    def unstable(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        if read("a"):
            raise UnstableChartError("it goes on and on")
        return state, (False,)

    found = search(unstable, unstable)
    assert found.complete
    assert "never become stable" in found.notes[0]


def test_that_only_one_never_becomes_stable_is_a_difference() -> None:
    def unstable(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        if read("a"):
            raise UnstableChartError("it goes on and on")
        return state, (False,)

    def resting(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        return state, (read("a"),)

    for pair in ((unstable, resting), (resting, unstable)):
        assert search(*pair).inputs == [{"a": True}]


def test_a_text_ends_the_proof_only_where_it_is_used() -> None:
    text = Signal.elementary("STRING")
    assert search(counter(2), counter(2), a=BOOL, n=text).complete
    assert "n is a text" in search(threshold(lambda n: n == ""), threshold(lambda n: n == ""), n=text).reason


def test_too_many_constants_end_the_proof() -> None:
    found = search(threshold(lambda n: any(n == c for c in range(0, 1000, 10))), threshold(lambda n: True), n=INT)
    assert not found.complete or found.inputs is not None


def test_a_number_may_be_compared_with_any_number_of_constants_where_it_is_not_kept() -> None:
    def ring(state: Any, read: Read) -> tuple[Any, tuple[Any, ...]]:
        return ((state[0] + bool(read("n") > 10 * state[0])) % 100,), (state[0],)

    left, right = Machine(ring, (0,)), Machine(ring, (0,))
    found = ended(search_product(left, right, {"n": Domain("n", INT)}, 1000))
    assert found.complete
    assert left.scans == 2 * (1 + found.states)


def test_probes_tell_their_domain() -> None:
    domain = Domain("n", INT)
    with pytest.raises(NotProvableError, match="n is used otherwise"):
        _ = Probe(3, domain) + 1
    with pytest.raises(NotProvableError, match="values of n are compared with each other"):
        _ = Probe(3, domain) == Probe(3, domain)
    assert not domain.grown


def test_branching_gives_every_combination_once() -> None:
    branching = Branching({name: Domain(name, BOOL) for name in "abc"})
    found = []
    for values in branching.combinations():
        if branching.read("a"):
            branching.read("b")
            branching.read("a")
        else:
            branching.read("c")
        found.append(dict(values))
    assert found == [
        {"a": False, "c": False},
        {"a": False, "c": True},
        {"a": True, "b": False},
        {"a": True, "b": True},
    ]
