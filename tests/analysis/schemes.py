"""Charts as programs in structured text: by schemes that are right, and by those that people write and that are wrong.

A chart here is a net of steps ``S0`` .. with the conditions ``c0`` .. of its transitions, which are inputs. Programs
have a flag ``X0`` .. for each step. Outputs are left to the tests.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.model import Pou, Project, SfcNetwork


@dataclass(frozen=True)
class Flow:
    """A net: for each transition its sources and targets. The order is that of priority."""

    steps: int
    transitions: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]
    conditions: tuple[str, ...] = field(default=())
    initial: tuple[int, ...] = (0,)

    def condition(self, transition: int) -> str:
        return self.conditions[transition] if self.conditions else f"c{transition}"

    def inputs(self) -> list[str]:
        return sorted({self.condition(t) for t in range(len(self.transitions))})

    def incoming(self, step: int) -> list[int]:
        return [t for t, (_, targets) in enumerate(self.transitions) if step in targets]

    def outgoing(self, step: int) -> list[int]:
        return [t for t, (sources, _) in enumerate(self.transitions) if step in sources]

    def competing(self, transition: int) -> list[int]:
        sources = set(self.transitions[transition][0])
        return [t for t in range(transition) if sources & set(self.transitions[t][0])]

    def single(self) -> bool:
        """True if one step is active at any time."""
        return all(len(sources) == len(targets) == 1 for sources, targets in self.transitions)


def chart_of(flow: Flow) -> SfcNetwork:
    chart = SfcNetwork()
    steps = [chart.add_step(f"S{number}", initial=number in flow.initial) for number in range(flow.steps)]
    for number, (sources, targets) in enumerate(flow.transitions):
        chart.add_transition(
            [steps[i] for i in sources], [steps[i] for i in targets], flow.condition(number), priority=number + 1
        )
    return chart


def program(body: Iterable[str] | str, inputs: Iterable[str] = (), variables: Iterable[str] = ()) -> Pou:
    """A POU, read as a file of IEC 61131-3 text is."""
    text = body if isinstance(body, str) else "\n".join(body)
    lines = ["PROGRAM Code", "VAR_INPUT", *(f"  {name} : BOOL;" for name in inputs), "END_VAR"]
    lines += ["VAR", *(f"  {line};" for line in variables), "END_VAR", text, "END_PROGRAM", ""]
    project: Project = sfc.loads("\n".join(lines).encode(), format="iec-text")
    return project.pous[0]


def flags(flow: Flow) -> list[str]:
    return [f"X{step} : BOOL := {'TRUE' if step in flow.initial else 'FALSE'}" for step in range(flow.steps)]


def bits(flow: Flow) -> list[str]:
    return [f"T{number} : BOOL" for number in range(len(flow.transitions))]


def step_flags(flow: Flow) -> dict[str, str]:
    return {f"S{step}": f"X{step}" for step in range(flow.steps)}


def _ored(terms: list[str]) -> str:
    return " OR ".join(f"({term})" for term in terms) or "FALSE"


# -- schemes that are right


def _guarded(flow: Flow) -> list[str]:
    lines = []
    for number, (sources, _) in enumerate(flow.transitions):
        terms = [f"X{i}" for i in sources] + [flow.condition(number)] + [f"NOT T{r}" for r in flow.competing(number)]
        lines.append(f"T{number} := {' AND '.join(terms)};")
    return lines


def _flip_flops(flow: Flow, *, dominant: str) -> list[str]:
    """One flip-flop for each step behind the transition bits; a step that a transition leaves and enters stays."""
    lines = []
    for step in range(flow.steps):
        loops = set(flow.incoming(step)) & set(flow.outgoing(step))
        enter = _ored([f"T{t}" for t in flow.incoming(step) if t not in loops])
        leave = _ored([f"T{t}" for t in flow.outgoing(step) if t not in loops])
        if dominant == "reset":
            lines.append(f"X{step} := ({enter} OR X{step}) AND NOT ({leave});")
        else:
            lines.append(f"X{step} := {enter} OR X{step} AND NOT ({leave});")
    return lines


def exact_reset_dominant(flow: Flow) -> Pou:
    lines = _guarded(flow) + _flip_flops(flow, dominant="reset")
    return program(lines, flow.inputs(), flags(flow) + bits(flow))


def exact_set_dominant(flow: Flow) -> Pou:
    lines = _guarded(flow) + _flip_flops(flow, dominant="set")
    return program(lines, flow.inputs(), flags(flow) + bits(flow))


def exact_two_phases(flow: Flow) -> Pou:
    lines = _guarded(flow)
    for number, (sources, _) in enumerate(flow.transitions):
        lines.append(f"IF T{number} THEN {' '.join(f'X{i} := FALSE;' for i in sources)} END_IF;")
    for number, (_, targets) in enumerate(flow.transitions):
        lines.append(f"IF T{number} THEN {' '.join(f'X{i} := TRUE;' for i in targets)} END_IF;")
    return program(lines, flow.inputs(), flags(flow) + bits(flow))


def exact_case(flow: Flow) -> Pou:
    """One state variable; for charts in which one step is active at any time."""
    assert flow.single()
    lines = ["CASE s OF"]
    for step in range(flow.steps):
        lines.append(f"  {step}:")
        for place, number in enumerate(flow.outgoing(step)):
            word = "IF" if place == 0 else "ELSIF"
            lines.append(f"    {word} {flow.condition(number)} THEN s := {flow.transitions[number][1][0]};")
        lines.append("    END_IF;" if flow.outgoing(step) else "    ;")
    lines += ["END_CASE;", *(f"X{step} := s = {step};" for step in range(flow.steps))]
    return program(lines, flow.inputs(), ["s : INT := 0", *flags(flow)])


EXACT: dict[str, Callable[[Flow], Pou]] = {
    "transition bits, reset-dominant": exact_reset_dominant,
    "transition bits, set-dominant": exact_set_dominant,
    "two phases": exact_two_phases,
}


# -- schemes that are wrong


def _textbook_line(flow: Flow, step: int, *, dominant: str) -> str:
    """Set by predecessor and condition, reset by the flag of the successor."""
    enter = _ored(
        [" AND ".join([*(f"X{i}" for i in flow.transitions[t][0]), flow.condition(t)]) for t in flow.incoming(step)]
    )
    after = sorted({target for t in flow.outgoing(step) for target in flow.transitions[t][1]})
    leave = _ored([f"X{i}" for i in after])
    if dominant == "reset":
        return f"X{step} := ({enter} OR X{step}) AND NOT ({leave});"
    return f"X{step} := {enter} OR X{step} AND NOT ({leave});"


def textbook(flow: Flow) -> Pou:
    lines = [_textbook_line(flow, step, dominant="reset") for step in range(flow.steps)]
    return program(lines, flow.inputs(), flags(flow))


def textbook_reversed(flow: Flow) -> Pou:
    lines = [_textbook_line(flow, step, dominant="reset") for step in reversed(range(flow.steps))]
    return program(lines, flow.inputs(), flags(flow))


def textbook_set_dominant(flow: Flow) -> Pou:
    lines = [_textbook_line(flow, step, dominant="set") for step in range(flow.steps)]
    return program(lines, flow.inputs(), flags(flow))


def _move(flow: Flow, number: int, test: str) -> str:
    sources, targets = flow.transitions[number]
    moves = [f"X{i} := FALSE;" for i in sources] + [f"X{i} := TRUE;" for i in targets]
    return f"IF {test} THEN {' '.join(moves)} END_IF;"


def if_chain(flow: Flow) -> Pou:
    numbers = range(len(flow.transitions))
    return program([_if(flow, number) for number in numbers], flow.inputs(), flags(flow))


def if_chain_reversed(flow: Flow) -> Pou:
    numbers = reversed(range(len(flow.transitions)))
    return program([_if(flow, number) for number in numbers], flow.inputs(), flags(flow))


def _if(flow: Flow, number: int) -> str:
    sources, _ = flow.transitions[number]
    return _move(flow, number, " AND ".join([*(f"X{i}" for i in sources), flow.condition(number)]))


def unguarded(flow: Flow) -> Pou:
    """Transition bits, but nothing that keeps two competing transitions apart."""
    lines = [
        f"T{number} := {' AND '.join([*(f'X{i}' for i in sources), flow.condition(number)])};"
        for number, (sources, _) in enumerate(flow.transitions)
    ]
    return program(lines + _flip_flops(flow, dominant="set"), flow.inputs(), flags(flow) + bits(flow))


def clear_then_set(flow: Flow) -> Pou:
    """Transition bits first, but every transition resets and sets on its own: a later one resets what was just set."""
    lines = _guarded(flow) + [_move(flow, number, f"T{number}") for number in range(len(flow.transitions))]
    return program(lines, flow.inputs(), flags(flow) + bits(flow))


WRONG_ANYWHERE: dict[str, Callable[[Flow], Pou]] = {
    "textbook": textbook,
    "textbook, networks reversed": textbook_reversed,
    "textbook, set-dominant": textbook_set_dominant,
}
"""Different for every chart that has a transition between two steps."""


# -- random charts


def ring(steps: int) -> Flow:
    return Flow(steps, tuple(((i,), ((i + 1) % steps,)) for i in range(steps)))


@st.composite
def flows(draw: st.DrawFn, *, parallel: bool = True, most: int = 9) -> Flow:
    """Random safe charts: sequences, selections, simultaneous branches, nested, that lead back to the initial step."""
    transitions: list[tuple[tuple[int, ...], tuple[int, ...]]] = []
    count = 1

    def step() -> int:
        nonlocal count
        count += 1
        return count - 1

    def block(start: int, depth: int) -> int:
        """Something that begins at step `start`; the step at which it ends."""
        kinds = ["step"] if depth == 0 or count >= most - 3 else ["step", "selection", "parallel", "sequence", "loop"]
        kind = draw(st.sampled_from([k for k in kinds if parallel or k != "parallel"]))
        if kind == "sequence":
            return block(block(start, depth - 1), depth - 1)
        if kind == "loop":
            inner = block(start, depth - 1)
            transitions.append(((inner,), (start,)))
            end = step()
            transitions.append(((inner,), (end,)))
            return end
        if kind == "selection":
            first, second = step(), step()
            transitions.append(((start,), (first,)))
            transitions.append(((start,), (second,)))
            ends = block(first, depth - 1), block(second, depth - 1)
            meeting = step()
            transitions.extend(((end,), (meeting,)) for end in ends)
            return meeting
        if kind == "parallel":
            first, second = step(), step()
            transitions.append(((start,), (first, second)))
            ends = block(first, depth - 1), block(second, depth - 1)
            after = step()
            transitions.append((ends, (after,)))
            return after
        end = step()
        transitions.append(((start,), (end,)))
        return end

    last = block(0, draw(st.integers(1, 3)))
    transitions.append(((last,), (0,)))
    return Flow(count, tuple(draw(st.permutations(transitions))))
