"""Random charts in which no step can get a second token, of every shape and with every action that lowering knows.

A chart is grown from an empty loop: pieces between two steps are filled with sequences, selections, loops and
simultaneous branches. Every step belongs to a region: what can be active only one at a time. So a transition between
two steps of one region, such as a jump or a loop at one step, keeps the chart safe.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from random import Random

from plcopen_sfc import model as m
from plcopen_sfc.model.sfc import SfcNetwork
from tests.lowering.charts import act, boolean


class Shape(StrEnum):
    """The main feature of a chart."""

    LINEAR = "linear"
    SELECTIONS = "selections"
    SIMULTANEOUS = "simultaneous branches"
    NESTED = "nested"
    JUMPS = "jumps"
    SELF_LOOPS = "loops at one step"
    TWO_STEP_LOOPS = "loops of two steps"
    SEVERAL_INITIAL = "several initial steps"


_BLOCKS = {
    Shape.LINEAR: ("sequence",),
    Shape.SELECTIONS: ("sequence", "selection", "selection"),
    Shape.SIMULTANEOUS: ("sequence", "simultaneous", "simultaneous"),
    Shape.TWO_STEP_LOOPS: ("sequence", "loop", "loop"),
}
_ALL_BLOCKS = ("sequence", "sequence", "selection", "simultaneous", "loop")
_NAMES = ("Start", "Fill", "Heat", "Drain", "Wait", "Rinse", "Stir", "Cool")
_INPUTS = ("c1", "c2", "c3", "c4")
_OUTPUTS = ("q1", "q2", "q3", "t1", "e1", "e2", "e3")
_TIMED = ("L", "D", "SD", "DS", "SL")
QUALIFIERS = ("N", "N", "N", "S", "R", "P", "P1", "P0", *_TIMED)


@dataclass
class _Grown:
    """Steps by their regions, and transitions as their sources and targets."""

    random: Random
    regions: list[int] = field(default_factory=list)
    arcs: list[tuple[list[int], list[int]]] = field(default_factory=list)
    initial: list[int] = field(default_factory=list)
    _next_region: int = 0

    def region(self) -> int:
        """A new region."""
        self._next_region += 1
        return self._next_region

    def step(self, region: int) -> int:
        """A new step."""
        self.regions.append(region)
        return len(self.regions) - 1

    def grow(self, size: int, blocks: tuple[str, ...]) -> None:
        """Add a chart of about so many steps, with one initial step."""
        region = self.region()
        first = self.step(region)
        self.initial.append(first)
        waiting = [(first, first, size - 1, region)]
        while waiting:
            begin, end, left, region = waiting.pop()
            if left <= 0 and begin != end:
                self.arcs.append(([begin], [end]))
                continue
            kind = self.random.choice(blocks)
            if kind == "sequence" or left < 3 or begin == end:
                middle = self.step(region)
                half = self.random.randint(0, max(0, left - 1)) if begin != end else 0
                waiting += [(begin, middle, half, region), (middle, end, left - 1 - half, region)]
            elif kind == "selection":
                parts = self.random.randint(2, 3)
                waiting += [(begin, end, left // parts, region)] * parts
            elif kind == "loop":
                middle, back = self.step(region), self.step(region)
                waiting += [(begin, middle, left // 2 - 1, region), (middle, end, left // 2 - 1, region)]
                self.arcs += [([middle], [back]), ([back], [middle])]
            else:
                inner = [self.region() for _ in range(self.random.randint(2, 3))]
                firsts, lasts = ([self.step(each) for each in inner] for _ in range(2))
                self.arcs += [([begin], firsts), (lasts, [end])]
                share = (left - 2 * len(inner)) // len(inner)
                waiting += [(a, b, share, each) for a, b, each in zip(firsts, lasts, inner, strict=True)]

    def jump(self) -> None:
        """A transition from any step to another one of its region, or to itself where it has no other."""
        source = self.random.randrange(len(self.regions))
        others = [i for i, region in enumerate(self.regions) if region == self.regions[source] and i != source]
        self.arcs.append(([source], [self.random.choice(others or [source])]))

    def self_loop(self) -> None:
        """A transition that leaves and enters one step."""
        step = self.random.randrange(len(self.regions))
        self.arcs.insert(self.random.randrange(len(self.arcs)), ([step], [step]))


def random_chart(seed: int, *, size: int = 10, shape: Shape | None = None, codesys: bool = False) -> m.Pou:
    """A function block with a safe chart. `codesys`: with step actions and minimum times."""
    random = Random(seed)  # noqa: S311
    wanted = shape or list(Shape)[seed % len(Shape)]
    grown = _Grown(random)
    for _ in range(random.randint(2, 3) if wanted is Shape.SEVERAL_INITIAL else 1):
        most = size // 2 if wanted is Shape.SEVERAL_INITIAL else size
        grown.grow(random.randint(most // 2, most), _BLOCKS.get(wanted, _ALL_BLOCKS))
    for _ in range(random.randint(1, 3) if wanted is Shape.JUMPS else 0):
        grown.jump()
    for _ in range(random.randint(1, 2) if wanted is Shape.SELF_LOOPS else 0):
        grown.self_loop()
    chart = _chart(grown)
    _add_conditions(chart, random)
    _add_actions(chart, random)
    if codesys:
        _add_step_actions(chart, random)
    level = m.Variable(name="Level", type=m.ElementaryType(name=m.Elementary.INT))
    inputs = [*(boolean(name) for name in _INPUTS), level]
    sections = [
        m.VariableSection(kind=m.SectionKind.INPUT, variables=inputs),
        m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[boolean(name) for name in _OUTPUTS]),
    ]
    return m.Pou(
        name=f"Chart_{seed}",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=sections),
        bodies=[m.SfcBody(chart=chart)],
    )


def _chart(grown: _Grown) -> SfcNetwork:
    random = grown.random
    chart = SfcNetwork()
    steps = []
    for index in range(len(grown.regions)):
        name = random.choice(_NAMES) if random.random() < 0.3 else f"S{index + 1}"
        if any(step.name == name for step in steps):
            name = f"{name}_{index + 1}"
        steps.append(chart.add_step(name, initial=index in grown.initial))
    if random.random() < 0.3:
        for number, step in enumerate(steps, 1):
            step.number = 10 * number
    for number, (sources, targets) in enumerate(grown.arcs, 1):
        transition = chart.add_transition([steps[i] for i in sources], [steps[i] for i in targets], "TRUE")
        if random.random() < 0.1:
            transition.name = f"T{number}"
        if random.random() < 0.2:
            transition.priority = random.randint(1, 3)
    return chart


def _add_conditions(chart: SfcNetwork, random: Random) -> None:
    names = [step.name for step in chart.steps]
    by_id = {step.id: step for step in chart.steps}
    timed = random.random() < 0.3
    for transition in chart.transitions:
        kind = random.random()
        text = _boolean(random)
        if kind < 0.08:
            text = "TRUE"
        elif kind < 0.16:
            text = f"{random.choice(names)}.X AND {text}"
        elif kind < 0.24:
            text = f"{text} OR NOT {random.choice(names)}.X"
        elif kind < 0.32:
            text = f"Level {random.choice(['>', '<=', '='])} {random.randint(1, 3) * 10}"
        elif kind < 0.4 and timed:
            text = f"{by_id[transition.sources[0]].name}.T >= T#20ms"
        transition.condition = m.Expression(text=text)


def _boolean(random: Random) -> str:
    literals = [f"{random.choice(['', '', 'NOT '])}{name}" for name in random.sample(_INPUTS, random.randint(1, 2))]
    return random.choice([" AND ", " OR "]).join(literals)


def _add_actions(chart: SfcNetwork, random: Random) -> None:
    """Actions on a few outputs; not many with times, for each of them multiplies the situations."""
    timed = 2
    for step in chart.steps:
        for target in random.sample(_OUTPUTS[:3], random.choice((0, 1, 1, 2))):
            qualifier = random.choice(QUALIFIERS)
            if qualifier in _TIMED:
                if not timed:
                    continue
                timed -= 1
            duration = "T#20ms" if qualifier in _TIMED else None
            condition = _boolean(random) if random.random() < 0.2 else None
            act(chart, step, target, m.Qualifier(qualifier), duration=duration, condition=condition)
        if random.random() < 0.1:
            action = m.ActionAssociation(
                id=chart.new_id(),
                qualifier=m.Qualifier(random.choice(("N", "P", "P1", "P0", "S"))),
                body=m.StBody(text="t1 := NOT t1;"),
            )
            step.actions.append(action)


def _add_step_actions(chart: SfcNetwork, random: Random) -> None:
    for step in chart.steps:
        if random.random() < 0.15:
            step.entry_action = m.StBody(text="e1 := NOT e1;")
        if random.random() < 0.15:
            step.main_action = m.StBody(text="e2 := c1;")
        if random.random() < 0.15:
            step.exit_action = m.StBody(text="e3 := NOT e3;")
        if random.random() < 0.1:
            step.min_time = "T#20ms"
