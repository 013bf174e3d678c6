"""A comparison in parts says what the comparison as a whole says."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plcopen_sfc import model as m
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalence, equivalent
from plcopen_sfc.analysis.product import Explored, Search, ended
from plcopen_sfc.lowering import Construction
from plcopen_sfc.lowering.construction import construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model import Qualifier
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.profile import PROFILES
from tests.analysis.schemes import EXACT, Flow, chart_of, program, step_flags
from tests.lowering.random_charts import random_chart
from tests.lowering.random_sequencers import sequencers
from tests.lowering.sequencers import block
from tests.sweeps import examples

Divided = Callable[[], Search | None]
Accepted = Callable[[Explored], bool]
Look = Callable[[int], str]


def as_a_whole(whole: Search, size: int, divided: Divided, accepted: Accepted, look: Look) -> Explored:
    return ended(whole)


def in_parts(whole: Search, size: int, divided: Divided, accepted: Accepted, look: Look) -> Explored:
    searching = divided()
    if searching is None:
        return ended(whole)
    found = ended(searching)
    assert found.inputs is None or accepted(found), "a difference of a part is none of the whole"
    return found


def verdicts(patch: pytest.MonkeyPatch, compare: Callable[[], Verdict]) -> tuple[Verdict, Verdict]:
    found = []
    for race in (as_a_whole, in_parts):
        patch.setattr(equivalence, "race", race)
        found.append(compare())
    patch.undo()
    return found[0], found[1]


def mutated(text: str, random: Random) -> str:
    """A program with one mistake, as people make them; it may still do the same."""
    lines = text.split("\n")
    assignments = [i for i, line in enumerate(lines) if ":=" in line and line.endswith(";")]
    i, j = random.choice(assignments), random.choice(assignments)
    match random.randrange(5):
        case 0:
            lines[i] = lines[i].replace(" AND ", " OR ", 1)
        case 1:
            lines[i] = lines[i].replace("NOT ", "", 1)
        case 2:
            lines[i] = lines[i].replace("20ms", "30ms")
        case 3:
            lines[i], lines[j] = lines[j], lines[i]
        case _:
            lines[i] = re.sub(r":=.*", ":= FALSE;" if "TRUE" in lines[i] else ":= TRUE;", lines[i])
    return "\n".join(lines)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["iec", "codesys"])
def test_random_charts_and_programs_with_mistakes(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    outcomes: Counter[tuple[VerdictKind, bool]] = Counter()
    for seed in range(14):
        random = Random(seed)  # noqa: S311
        pou = random_chart(seed, size=5, codesys=name == "codesys")
        assert pou.sfc is not None
        rules = LoweringRules(PROFILES[name], construction=Construction.BITS)
        made = construct(pou, pou.sfc, Dialect.IEC, rules)
        assert isinstance(made.pou.body, m.StBody)
        body = made.pou.body if seed % 4 == 0 else m.StBody(text=mutated(made.pou.body.text, random))
        code = made.pou.model_copy(update={"bodies": [body]})

        def compare(pou: m.Pou = pou, code: m.Pou = code, flags: dict[str, str] = made.step_flags) -> Verdict:
            return equivalent(pou, code, name, step_flags=flags, cap=600, runs=0)

        whole, parts = verdicts(monkeypatch, compare)
        if whole.kind is not VerdictKind.TESTED:
            assert parts.kind is whole.kind, f"{seed}\n{whole}\n{parts}\n{body.text}"
        if whole.counterexample is not None and parts.counterexample is not None:
            assert len(parts.counterexample.inputs) == len(whole.counterexample.inputs), f"{seed}\n{whole}\n{parts}"
            assert parts.counterexample.shortest
        outcomes[parts.kind, parts.parts > 1] += 1
    assert outcomes[VerdictKind.DIFFERENT, True] >= 4, outcomes
    assert outcomes[VerdictKind.PROVEN, True] >= 4, outcomes


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(60), derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(sequencers(switching=False), st.integers(0, 999))
def test_random_sequencers_of_s7_graph_with_mistakes(drawn: tuple[m.SfcNetwork, str, str], seed: int) -> None:
    """What is left out of states and of parts changes no verdict: nothing that is proven differs in random runs."""
    chart, inputs, outputs = drawn
    project = block(chart, inputs, outputs)
    other = project.model_copy(deep=True)
    with_mistake(other.pous[0].chart, Random(seed))  # noqa: S311
    with pytest.MonkeyPatch.context() as patch:
        whole, parts = verdicts(patch, lambda: equivalent(project, other, "s7graph", cap=300, runs=0))
    if VerdictKind.TESTED not in (whole.kind, parts.kind):
        assert parts.kind is whole.kind, f"{whole}\n{parts}"
    if whole.counterexample is not None and parts.counterexample is not None:
        assert len(parts.counterexample.inputs) == len(whole.counterexample.inputs)
    if VerdictKind.PROVEN in (whole.kind, parts.kind):
        assert not equivalent(project, other, "s7graph", cap=1, runs=12, scans=60, seed=seed).different


def with_mistake(chart: m.SfcNetwork, random: Random) -> None:
    """Change something of a sequencer, or nothing that counts."""
    step = random.choice(chart.steps)
    transition = random.choice(chart.transitions) if chart.transitions else None
    match random.randrange(6):
        case 0 if transition is not None:
            transition.condition = m.Expression(text="#c1 OR #c2")
        case 1:
            step.interlock = None
        case 2:
            step.supervision = None
        case 3 | 4 if step.actions:
            action = random.choice(step.actions)
            action.interlock = not action.interlock
            if random.randrange(2):
                step.actions = [each for each in step.actions if each is not action]
        case _:
            step.comment = "nothing"


def test_a_part_that_counts_is_proven_whatever_the_number_is() -> None:
    """The counter has too many values, what stands beside it too many states for terms alone."""
    waits = "t(IN := c0, PT := T#3s); IF c1 THEN n := n + m; END_IF; late := n > 7; Q := t.Q; R_ := c1 AND t.Q;"
    variables = ["t : TON; n, m : INT; Q, R_, late : BOOL"]
    sides = [program(f"{waits} n := n + {step}; m := 1;", ["c0", "c1"], variables) for step in ("1", "1", "2")]
    names = ["Q", "R_", "late", "n"]
    found = equivalent(sides[0], sides[1], "iec", outputs=names, scan_time="100ms", cap=200, runs=0)
    assert found.proven, str(found)
    assert found.parts > 1
    assert equivalent(sides[0], sides[2], "iec", outputs=names, cap=200, runs=0).kind is VerdictKind.DIFFERENT


# -- rings that do not know of each other


def rings(number: int, *, actions: bool = False) -> tuple[m.SfcNetwork, Flow]:
    moves = [each for n in range(0, 2 * number, 2) for each in (((n,), (n + 1,)), ((n + 1,), (n,)))]
    flow = Flow(2 * number, tuple(moves), (), tuple(range(0, 2 * number, 2)))
    chart = chart_of(flow)
    for n in range(number if actions else 0):
        association = m.ActionAssociation(id=1000 + n, qualifier=Qualifier.S, target=f"q{n}")
        chart.steps[2 * n + 1].actions.append(association)
    return chart, flow


def text_of(pou: m.Pou) -> str:
    assert isinstance(pou.body, m.StBody)
    return pou.body.text


@pytest.mark.slow
def test_independent_sequences_add_up() -> None:
    """Eight rings of two steps have 256 situations, each with 256 combinations of inputs."""
    chart, flow = rings(8)
    verdict = equivalent(chart, EXACT["two phases"](flow), "iec", step_flags=step_flags(flow), cap=3_000, runs=0)
    assert verdict.proven, str(verdict)
    assert verdict.parts == 8
    assert verdict.states == 2 * 8
    assert str(verdict).splitlines() == [
        "equal (proof: 16 states in 8 parts, all inputs)",
        "covered: 16 of 16 steps, 16 of 16 transitions; 48 of 48 assignments",
    ]
    assert verdict.as_dict()["parts"] == 8


def test_a_difference_of_a_part_is_the_shortest_and_is_shown_on_the_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(equivalence, "race", in_parts)
    chart, flow = rings(6, actions=True)
    variables = [f"X{n} : BOOL := {'TRUE' if n in flow.initial else 'FALSE'}" for n in range(flow.steps)]
    variables += [f"T{n} : BOOL" for n in range(len(flow.transitions))] + [f"q{n} : BOOL" for n in range(6)]
    stored = [f"IF X{2 * n + 1} THEN q{n} := TRUE; END_IF;" for n in range(6)]
    stored[4] = "q4 := X9;"  # not stored: that shows when the step is left again
    wrong = program([text_of(EXACT["two phases"](flow)), *stored], flow.inputs(), variables)
    verdict = equivalent(chart, wrong, "iec", step_flags=step_flags(flow), cap=100, runs=0)
    assert verdict.counterexample is not None
    assert verdict.counterexample.shortest
    assert [d.name for d in verdict.counterexample.differences] == ["q4"]
    assert verdict.counterexample.inputs == ({"c8": True, "c9": False}, {"c8": True, "c9": True})


@pytest.mark.parametrize(("cap", "shortest"), [(12, False), (100, True)])
def test_a_difference_is_called_the_shortest_where_all_parts_were_searched_as_far(
    cap: int, monkeypatch: pytest.MonkeyPatch, *, shortest: bool
) -> None:
    """Six delayed inputs have too many states for the small cap, a counter to eight has not."""
    monkeypatch.setattr(equivalence, "race", in_parts)
    delay = "s6 := s5; s5 := s4; s4 := s3; s3 := s2; s2 := s1; s1 := c0; IF n < 8 THEN n := n + 1; END_IF; late := "
    variables = ["s1, s2, s3, s4, s5, s6, late : BOOL; n : INT"]
    sides = [program(f"{delay} n >= {limit};", ["c0"], variables) for limit in (7, 8)]
    verdict = equivalent(sides[0], sides[1], "iec", outputs=["s6", "late"], cap=cap, runs=0)
    assert verdict.counterexample is not None
    assert len(verdict.counterexample.inputs) == 7
    assert verdict.counterexample.shortest is shortest
