"""Random charts as textual IEC 61131-3 for matiec: every qualifier, shared targets, competing transitions, step data.

A chart is grown from a loop by putting sequences, selections and simultaneous branches between two steps, so that
no step can get a second token but where competing transitions without priorities are TRUE together.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from tests.lowering.random_charts import random_chart as chart_of_every_shape

_PLAIN = ("N", "N", "N", "S", "R", "P", "P1", "P0")
_TIMED = ("L", "D", "SD", "DS", "SL")
INPUTS = tuple(f"b{number}" for number in range(5))


@dataclass
class RandomChart:
    """The text of a program ``Chart``, and the variables to compare."""

    text: str
    watch: list[str]
    steps: int


@dataclass
class _Grown:
    random: Random
    steps: list[str] = field(default_factory=list)
    links: list[tuple[list[str], list[str], int | None]] = field(default_factory=list)

    def step(self) -> str:
        self.steps.append(f"S{len(self.steps)}")
        return self.steps[-1]

    def link(self, sources: list[str], targets: list[str], priority: int | None = None) -> None:
        self.links.append((sources, targets, priority))

    def sequence(self, first: str, budget: int, depth: int) -> str:
        """Grow behind `first`; the result is the last step."""
        last = first
        while budget > 0:
            kind = self.random.choice(["step", "step", "selection", "simultaneous"])
            if kind == "step" or depth > 2 or budget < 4:
                following = self.step()
                self.link([last], [following])
                last, budget = following, budget - 1
                continue
            branches = self.random.choice((2, 2, 3))
            heads = [self.step() for _ in range(branches)]
            share = max(0, budget // branches - 2)
            if kind == "simultaneous":
                self.link([last], heads)
            else:
                numbered = self.random.random() < 0.7
                for number, head in enumerate(heads, 1):
                    self.link([last], [head], number if numbered else None)
            tails = [self.sequence(head, self.random.randint(0, share), depth + 1) for head in heads]
            last = self.step()
            if kind == "simultaneous":
                self.link(tails, [last])
            else:
                for tail in tails:
                    self.link([tail], [last])
            budget -= branches * (share + 1) + 1
        return last


def random_chart(seed: int, size: int) -> RandomChart:
    """A chart of about `size` steps."""
    random = Random(seed)  # noqa: S311
    grown = _Grown(random)
    first = grown.step()
    last = grown.sequence(first, size, 0)
    if last == first:
        last = grown.step()
        grown.link([first], [last])
    grown.link([last], [first])
    variables = [f"q{number}" for number in range(3 + size // 3)]
    actions = [f"A{number}" for number in range(2 + size // 4)]
    lines = ["PROGRAM Chart", "VAR_INPUT", f"  {', '.join(INPUTS)} : BOOL;", "END_VAR", "VAR"]
    lines.append(f"  {', '.join(variables)} : BOOL;")
    lines += [f"  n{number} : INT;" for number in range(len(actions))]
    lines += ["  order : DINT;", "  wait : TIME := T#30ms;", "END_VAR"]
    for index, step in enumerate(grown.steps):
        lines.append(f"{'STEP' if index else 'INITIAL_STEP'} {step}:")
        lines += [f"  {_association(random, variables, actions)};" for _ in range(random.choice((0, 1, 1, 2, 3)))]
        lines.append("END_STEP")
    for sources, targets, priority in grown.links:
        number = f" (PRIORITY := {priority})" if priority is not None else ""
        condition = _condition(random, grown.steps, sources[0])
        lines.append(f"TRANSITION{number} FROM {_set(sources)} TO {_set(targets)} := {condition}; END_TRANSITION")
    text = "\n".join(lines)
    shuffled = [(number, action) for number, action in enumerate(actions) if f"{action}(" in text]
    random.shuffle(shuffled)
    for number, action in shuffled:
        also = f" {random.choice(variables)} := {_atom(random)};" if random.random() < 0.4 else ""
        order = f"order := (order * 3 + {number + 1}) MOD 1000000;"
        lines += [f"ACTION {action}:", f"  n{number} := n{number} + 1; {order}{also}", "END_ACTION"]
    lines.append("END_PROGRAM")
    watch = [*variables, *(f"n{number}" for number in range(len(actions))), "order"]
    return RandomChart("\n".join(lines) + "\n", [*watch, *(f"{s}.X" for s in grown.steps)], len(grown.steps))


def random_inputs(seed: int, scans: int) -> list[dict[str, bool]]:
    """Which inputs change before each scan."""
    random = Random(seed)  # noqa: S311
    return [{name: random.random() < 0.5 for name in INPUTS if random.random() < 0.4} for _ in range(scans)]


def _association(random: Random, variables: list[str], actions: list[str]) -> str:
    target = random.choice(variables if random.random() < 0.6 else actions)
    qualifier = random.choice(_PLAIN if random.random() < 0.6 else _TIMED)
    time = random.choice(("T#0ms", "T#10ms", "T#20ms", "T#35ms", "T#50ms", "wait"))
    return f"{target}({qualifier}, {time})" if qualifier in _TIMED else f"{target}({qualifier})"


def _atom(random: Random) -> str:
    name = random.choice(INPUTS)
    return name if random.random() < 0.65 else f"NOT {name}"


def _condition(random: Random, steps: list[str], source: str) -> str:
    kind = random.random()
    if kind < 0.1:
        return f"{source}.T >= T#{random.randint(1, 5)}0ms"
    if kind < 0.15:
        return "TRUE"
    if kind < 0.25:
        return f"{_atom(random)} OR {random.choice(steps)}.X"
    return f" {random.choice(('AND', 'OR'))} ".join(_atom(random) for _ in range(random.choice((1, 1, 2, 3))))


def _set(steps: list[str]) -> str:
    return steps[0] if len(steps) == 1 else f"({', '.join(steps)})"


# -- as other tools have them -----------------------------------------------------------------------------------------


def random_codesys_chart(seed: int, size: int) -> sfc.Project:
    """The chart of `random_chart` as a file of CODESYS, with step actions in place and named, shared with others."""
    project = sfc.loads(random_chart(seed, size).text.encode(), format="iec-text")
    random = Random(seed)  # noqa: S311
    pou = project.pou("Chart")
    for number, step in enumerate(pou.sfc.steps if pou.sfc is not None else ()):
        for kind in ("entry_action", "main_action", "exit_action"):
            if random.random() < 0.3 or (step.initial and kind == "main_action"):
                name = random.choice(pou.actions).name if pou.actions else ""
                place = m.StBody(text=f"order := (order * 3 + {number + 5}) MOD 1000000;")
                setattr(step, kind, name if name and random.random() < 0.6 else place)
    return sfc.loads(sfc.dumps(project, format="codesys", partial=True), format="codesys")


def random_wired_chart(seed: int, size: int) -> sfc.Project:
    """The chart of `random_chart` as TC6, with the conditions of inputs drawn as wired blocks."""
    project = sfc.loads(random_chart(seed, size).text.encode(), format="iec-text")
    chart = project.pou("Chart").sfc
    for transition in chart.transitions if chart is not None else ():
        text = transition.condition.text if isinstance(transition.condition, m.Expression) else ""
        words = text.split()
        if chart is not None and words and set(words) <= {*INPUTS, "NOT", "AND", "OR"}:
            kind = "AND" if "AND" in words else "OR"
            pins = []
            for operand in text.split(f" {kind} "):
                name = operand.removeprefix("NOT ")
                source = m.InputVariable(id=chart.new_id(), expression=name, output=m.OutputPin())
                source.negated = operand != name
                chart.logic.append(source)
                pin = m.InputPin(connections=[m.Connection(source=source.id)])
                pins.append(m.BlockVariable(name=f"IN{len(pins) + 1}", input=pin))
            transition.condition = m.WiredCondition(input=_joined(chart, kind, pins))
    return sfc.loads(sfc.dumps(project, format="plcopen"), format="plcopen")


def random_model_chart(seed: int, size: int) -> sfc.Project:
    """A chart of every shape in memory: several initial steps, loops at a step, conditions of associations."""
    return m.Project(pous=[chart_of_every_shape(seed, size=size + 2)])


def random_codesys_model(seed: int, size: int) -> sfc.Project:
    """The same with step actions and minimum times, under the rules of CODESYS."""
    pou = chart_of_every_shape(seed, size=size + 2, codesys=True)
    for step in pou.sfc.initial_steps if pou.sfc is not None else ():
        step.main_action = step.main_action or m.StBody(text="e2 := c1;")
    return m.Project(pous=[pou], dialect=m.Dialect.CODESYS)


def _joined(chart: m.SfcNetwork, kind: str, pins: list[m.BlockVariable]) -> m.InputPin:
    """The source of the wire of a condition: a block, or the only input."""
    if len(pins) == 1 and pins[0].input is not None:
        return pins[0].input
    outputs = [m.BlockVariable(name="OUT", output=m.OutputPin())]
    block = m.Block(id=chart.new_id(), type_name=kind, parameters=m.BlockParameters(inputs=pins, outputs=outputs))
    chart.logic.append(block)
    return m.InputPin(connections=[m.Connection(source=block.id, pin="OUT")])
