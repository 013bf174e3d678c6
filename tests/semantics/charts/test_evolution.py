"""Steps and transitions: which transitions are cleared in a scan, and what becomes of the steps."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.errors import CompetingTransitionsError, SimulationError, UnstableChartError
from plcopen_sfc.model import ActionAssociation, Macro, Qualifier, SfcBody, SfcNetwork, Step
from plcopen_sfc.semantics.net import Competing
from plcopen_sfc.semantics.profile import PROFILES, Evolution, Profile
from tests.semantics.charts.rig import MS, Rig, chain
from tests.sweeps import examples

IEC = PROFILES["iec"]


def selection(priorities: tuple[int | None, int | None] = (None, None)) -> SfcNetwork:
    chart = SfcNetwork()
    start, left, right = (chart.add_step(name, initial=name == "S") for name in ("S", "L", "R"))
    chart.add_transition(start, left, "c1", priority=priorities[0])
    chart.add_transition(start, right, "c2", priority=priorities[1])
    return chart


def test_one_step_in_a_scan_also_when_all_conditions_are_true() -> None:
    rig = Rig(chain("A", "B", "C", conditions="TRUE TRUE TRUE"), variables="")
    seen = [rig.scan().active for _ in range(6)]
    assert seen == ["B", "C", "A", "B", "C", "A"]


def test_two_steps_in_a_ring_alternate() -> None:
    rig = Rig(chain("A", "B", conditions="TRUE TRUE"))
    assert [rig.scan().active for _ in range(4)] == ["B", "A", "B", "A"]


def test_the_chain_waits_for_its_conditions() -> None:
    rig = Rig(chain("A", "B", "C"), variables="c1 c2 c3")
    assert rig.scan(5).active == "A"
    assert rig.scan(c2=True, c3=True).active == "A", "conditions of steps that are not active do nothing"
    assert rig.scan(c1=True).active == "B"
    assert rig.scan().active == "C"


def test_the_first_of_two_competing_transitions_is_cleared() -> None:
    assert Rig(selection(), variables="c1 c2").scan(c1=True, c2=True).active == "L"
    assert Rig(selection(), variables="c1 c2").scan(c2=True).active == "R"


def test_a_priority_comes_before_the_place() -> None:
    assert Rig(selection((2, 1)), variables="c1 c2").scan(c1=True, c2=True).active == "R"
    assert Rig(selection((None, 1)), variables="c1 c2").scan(c1=True, c2=True).active == "R"


def test_all_competing_transitions_are_cleared_together_in_grafcet() -> None:
    assert Rig(selection(), "grafcet", variables="c1 c2").scan(c1=True, c2=True).active == "L R"


def test_competing_transitions_can_be_an_error() -> None:
    strict = replace(IEC, competing=Competing.ERROR)
    assert Rig(selection(), strict, variables="c1 c2").scan(c1=True).active == "L"
    with pytest.raises(CompetingTransitionsError) as error:
        Rig(selection(), strict, variables="c1 c2").scan(c1=True, c2=True)
    assert error.value.transitions == ("S -> L", "S -> R")


def test_matiec_excludes_competing_transitions_only_by_priority_numbers() -> None:
    assert Rig(selection(), "matiec", variables="c1 c2").scan(c1=True, c2=True).active == "L R"
    assert Rig(selection((1, 2)), "matiec", variables="c1 c2").scan(c1=True, c2=True).active == "L"
    assert Rig(selection((2, 1)), "matiec", variables="c1 c2").scan(c1=True, c2=True).active == "R"


def test_a_simultaneous_sequence_starts_and_ends_together() -> None:
    chart = SfcNetwork()
    a, b, c, d, e = (chart.add_step(name, initial=name == "A") for name in "ABCDE")
    chart.add_transition(a, [b, c], "c1")
    chart.add_transition(b, d, "c2")
    chart.add_transition([d, c], e, "c3")
    rig = Rig(chart, variables="c1 c2 c3")
    assert rig.scan(c1=True).active == "B C"
    assert rig.scan(c3=True).active == "B C", "the convergence waits for all of its steps"
    assert rig.scan(c2=True).active == "C D"
    assert rig.scan().active == "E"


def test_two_parallel_steps_both_move_in_one_scan() -> None:
    chart = SfcNetwork()
    a, b, c, d = (chart.add_step(name, initial=name in "AB") for name in "ABCD")
    chart.add_transition(a, c, "c1")
    chart.add_transition(b, d, "c1")
    assert Rig(chart, variables="c1").scan(c1=True).active == "C D"


def test_a_step_that_is_left_and_entered_at_once_stays_active() -> None:
    """Set wins over reset: 1 -> 2 and 2 -> 3 together give 2 and 3 (IEC 60848, rule 5)."""
    chart = SfcNetwork()
    a, b, c = (chart.add_step(name, initial=name in "AB") for name in "ABC")
    chart.add_transition(a, b, "TRUE")
    chart.add_transition(b, c, "TRUE")
    assert Rig(chart).scan().active == "B C"


def test_a_loop_on_itself_starts_the_time_anew() -> None:
    chart = SfcNetwork()
    a = chart.add_step("A", initial=True)
    chart.add_transition(a, a, "again")
    rig = Rig(chart, variables="again").scan(4)
    assert rig["A.T"] == 30 * MS
    rig.scan(again=True)
    assert (rig.active, rig["A.X"], rig["A.T"]) == ("A", True, 0)
    assert rig.scan(2, again=False)["A.T"] == 20 * MS


def test_step_variables() -> None:
    rig = Rig(chain("A", "B"), variables="c1 c2")
    rig.scan(3)
    assert (rig["A.X"], rig["A.T"], rig["B.X"], rig["B.T"]) == (True, 20 * MS, False, 0)
    rig.scan(c1=True)
    assert (rig["A.X"], rig["a.t"], rig["B.X"], rig["b.x"]) == (False, 30 * MS, True, True)
    rig.scan(3)
    assert (rig["A.T"], rig["B.T"]) == (30 * MS, 30 * MS), "T stays as it was when the step was left"


@pytest.mark.parametrize(("limit", "scans"), [(20, 2), (21, 3), (19, 2), (30, 3)])
def test_a_condition_on_the_time_of_its_step(limit: int, scans: int) -> None:
    """A scan takes 10 ms; the step is active for `scans` of them after the first."""
    rig = Rig(chain("A", "B", conditions=f"A.T>=T#{limit}ms FALSE"))
    assert rig.scan(scans).active == "A"
    assert rig.scan().active == "B"


def test_conditions_see_the_steps_before_the_scan() -> None:
    """All of them the same situation: the order in which they are written does not matter."""
    for order in ((0, 1), (1, 0)):
        chart = SfcNetwork()
        a, b, c, d = (chart.add_step(name, initial=name in "AC") for name in "ABCD")
        pairs = [(a, b, "c1"), (c, d, "B.X")]
        for index in order:
            chart.add_transition(*pairs[index])
        rig = Rig(chart, variables="c1")
        assert rig.scan(c1=True).active == "B C"
        assert rig.scan().active == "B D"


def test_a_source_transition_fires_whenever_it_is_true_and_a_sink_only_clears() -> None:
    chart = SfcNetwork()
    a = chart.add_step("A")
    chart.add_transition([], a, "c1")
    chart.add_transition(a, [], "c2")
    rig = Rig(chart, variables="c1 c2")
    assert rig.scan().active == ""
    assert rig.scan(c1=True).active == "A"
    assert rig.scan(c1=False, c2=True).active == ""


def test_a_transition_without_a_condition_says_so_when_it_is_enabled() -> None:
    chart = chain("A", "B", ring=False)
    chart.transitions[0].condition = None
    with pytest.raises(SimulationError, match="the transition has no condition"):
        Rig(chart).scan()


def test_excluded_elements_do_nothing() -> None:
    chart = chain("A", "B", conditions="TRUE TRUE")
    chart.transitions[0].exclude = True
    assert Rig(chart).scan(3).active == "A"


def test_until_stable_runs_through_steps() -> None:
    chart = chain("A", "B", "C", conditions="c1 TRUE FALSE")
    chart.step("B").actions = [ActionAssociation(id=1, qualifier=Qualifier.S, target="stored")]
    chart.step("B").actions.append(ActionAssociation(id=2, qualifier=Qualifier.N, target="continuous"))
    stable = replace(IEC, evolution=Evolution.UNTIL_STABLE)
    rig = Rig(chart, stable, variables="c1 stored continuous")
    assert rig.scan(c1=True).active == "C"
    assert rig["stored"] is True, "what is stored happens in every situation"
    assert rig["continuous"] is False, "what is continuous only in the stable one"


def test_a_chart_that_never_gets_stable_is_an_error() -> None:
    stable = replace(IEC, evolution=Evolution.UNTIL_STABLE, max_evolutions=50)
    with pytest.raises(UnstableChartError, match="50 evolutions"):
        Rig(chain("A", "B", conditions="TRUE TRUE"), stable).scan()


@pytest.mark.parametrize("profile", [*PROFILES.values(), replace(IEC, competing=Competing.ALL)], ids=lambda p: p.name)
def test_one_chart_under_all_profiles(profile: Profile) -> None:
    """A -> B -> C -> A, all conditions true: what is active after scans 1, 2 and 3."""
    rig = Rig(chain("A", "B", "C", "D", conditions="TRUE TRUE c1 FALSE"), profile, variables="c1")
    expected = {
        "iec": ["B", "C", "C"],
        "matiec": ["B", "C", "C"],
        "beremiz": ["B", "C", "C"],
        "codesys": ["A", "B", "C"],
        "codesys23": ["A", "B", "C"],
        "s7graph": ["A", "B", "C"],
        "grafcet": ["C", "C", "C"],
    }
    assert [rig.scan().active for _ in range(3)] == expected[profile.name]


def test_macro_steps_run_their_expansion() -> None:
    inner = chain("E", "M", "S", conditions="c2 c3", ring=False)
    chart = SfcNetwork(
        steps=[Step(id=0, name="A", initial=True), Step(id=1, name="M1", macro=Macro(body=SfcBody(chart=inner)))]
    )
    chart.add_transition(chart.step("A"), chart.step("M1"), "c1")
    chart.add_transition(chart.step("M1"), chart.step("A"), "TRUE")
    chart.step("M1").actions = [ActionAssociation(id=1, target="Q")]
    rig = Rig(chart, variables="c1 c2 c3 Q")
    assert rig.scan(c1=True).active == "M1.E"
    assert (rig["M1.X"], rig["Q"], rig["E.X"], rig["M.X"]) == (True, True, True, False)
    assert rig.scan(3, c2=True, c1=False).active == "M1.M"
    assert (rig["M1.X"], rig["M1.T"]) == (True, 30 * MS)
    rig.scan(c3=True)
    assert (rig.active, rig["M1.X"], rig["M1.T"], rig["S.T"]) == ("M1.S", True, 40 * MS, 0)
    rig.scan()
    assert (rig.active, rig["M1.X"], rig["Q"]) == ("A", False, False)


def _reference(
    marking: frozenset[int],
    transitions: list[tuple[tuple[int, ...], tuple[int, ...]]],
    true: frozenset[int],
    *,
    exclusive: bool,
) -> frozenset[int]:
    """One evolution as the rules say it, with sets instead of bits, and without any cleverness."""
    fired: list[int] = []
    for index, (sources, _) in enumerate(transitions):
        enabled = all(source in marking for source in sources)
        competitor = exclusive and any(set(transitions[other][0]) & set(sources) for other in fired)
        if enabled and index in true and not competitor:
            fired.append(index)
    after = set(marking)
    for index in fired:
        after -= set(transitions[index][0])
    for index in fired:
        after |= set(transitions[index][1])
    return frozenset(after)


@pytest.mark.parametrize("exclusive", [True, False])
@settings(deadline=None, max_examples=examples(60))
@given(seed=st.integers(0, 10**9))
def test_random_nets_do_what_the_rules_say(exclusive: bool, seed: int) -> None:
    random = Random(seed)  # noqa: S311
    size = random.randint(1, 8)
    chart = SfcNetwork()
    steps = [chart.add_step(f"S{index}", initial=random.random() < 0.4) for index in range(size)]
    shapes = [(1, 1)] * 6 + [(1, 2), (2, 1), (2, 2), (1, 0)]
    transitions = []
    for index in range(random.randint(1, 12)):
        before, after = random.choice(shapes)
        sources = tuple(random.sample(range(size), min(before, size)))
        targets = tuple(random.sample(range(size), min(after, size)))
        transitions.append((sources, targets))
        chart.add_transition([steps[i] for i in sources], [steps[i] for i in targets], f"c{index}")
    profile = IEC if exclusive else replace(IEC, competing=Competing.ALL)
    rig = Rig(chart, profile, variables=" ".join(f"c{index}" for index in range(len(transitions))))
    marking = frozenset(index for index, step in enumerate(steps) if step.initial)
    for _ in range(15):
        true = frozenset(index for index in range(len(transitions)) if random.random() < 0.5)
        rig.scan(**{f"c{index}": index in true for index in range(len(transitions))})
        marking = _reference(marking, transitions, true, exclusive=exclusive)
        assert rig.active.split() == [f"S{index}" for index in sorted(marking)]
        assert all(rig[f"S{index}.X"] is (index in marking) for index in range(size))


def test_errors_say_the_scan_the_pou_and_the_place() -> None:
    chart = chain("A", "B", conditions="c1;n/m>0")
    rig = Rig(chart, variables="c1 n:INT m:INT").scan(3)
    rig.scan(c1=True)
    with pytest.raises(SimulationError) as found:
        rig.scan()
    assert (found.value.pou, found.value.location.path) == ("Main", "Main / transition B -> A")
    assert "division by zero" in str(found.value)


@settings(deadline=None, max_examples=examples(60))
@given(seed=st.integers(0, 10**9))
def test_random_nets_become_stable_as_the_rules_say(seed: int) -> None:
    """The evolutions of one scan, with the same inputs, until nothing is cleared."""
    random = Random(seed)  # noqa: S311
    size = random.randint(2, 7)
    chart = SfcNetwork()
    steps = [chart.add_step(f"S{index}", initial=random.random() < 0.4) for index in range(size)]
    transitions = []
    for index in range(random.randint(1, 10)):
        before, after = random.choice([(1, 1)] * 5 + [(1, 2), (2, 1), (1, 0)])
        sources = tuple(random.sample(range(size), before))
        targets = tuple(random.sample(range(size), after))
        transitions.append((sources, targets))
        chart.add_transition([steps[i] for i in sources], [steps[i] for i in targets], f"c{index}")
    rig = Rig(chart, "grafcet", variables=" ".join(f"c{index}" for index in range(len(transitions))))
    marking = frozenset(index for index, step in enumerate(steps) if step.initial)
    for _ in range(12):
        true = frozenset(index for index in range(len(transitions)) if random.random() < 0.3)
        stable = False
        for _ in range(1000):
            enabled = any(index in true and set(transitions[index][0]) <= marking for index in range(len(transitions)))
            if not enabled:
                stable = True
                break
            marking = _reference(marking, transitions, true, exclusive=False)
        values = {f"c{index}": index in true for index in range(len(transitions))}
        if not stable:
            with pytest.raises(UnstableChartError):
                rig.scan(**values)
            return
        rig.scan(**values)
        assert rig.active.split() == [f"S{index}" for index in sorted(marking)]
