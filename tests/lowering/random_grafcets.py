"""Random charts of GRAFCET, small enough to be proven: all actions and terms, competing transitions, forcing."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

from plcopen_sfc import model as m
from tests.lowering.grafcets import pou_with
from tests.semantics.charts.test_grafcet import action

CONDITIONS = ["a", "b", "↑a", "↓b", "NOT a", "a AND NOT b", "↑(a OR b)", "NOT ↑b", "X{step}", "↑X{step}", "NOT X{step}"]
CALM = ["↑a", "↓b", "↑b AND a", "a AND 20ms/X{step}", "↑(a AND NOT b)", "b AND ↓a"]
TIMES = ["20ms/X{step}", "20ms/a", "NOT 20ms/X{step}", "X{step}/20ms", "20ms/b/20ms"]
VALUES = ["TRUE", "FALSE", "NOT {target}", "a"]


def random_calm_grafcet(seed: int) -> m.Pou:
    """A function block with a chart of which most transitions cannot follow each other with the same inputs."""
    random = Random(seed)  # noqa: S311
    steps = random.randint(2, 5)
    chart = _chart(random, 1, steps, times=seed % 2 == 0, conditions=CALM)
    return pou_with(chart, "a b", "Q R S")


def random_grafcet(seed: int) -> m.Pou:
    """A function block with one or two charts; the second one may force or enclose the first."""
    random = Random(seed)  # noqa: S311
    below = _chart(random, 1, random.randint(2, 4), times=seed % 3 == 0)
    partials = [m.PartialChart(name="G1", chart=below)]
    if random.random() < 0.5:
        above = _chart(random, 11, 2, times=False)
        partials.append(m.PartialChart(name="G2", chart=above))
        if random.random() < 0.7:
            situation = random.choice(list(m.ForcedSituation))
            names = random.sample([s.name for s in below.steps], 2) if situation is m.ForcedSituation.EXPLICIT else []
            order = m.ForcingOrder(chart="G1", situation=situation, steps=names)
            above.steps[1].actions.append(m.ActionAssociation(id=90, kind=m.ActionKind.FORCING, forcing=order))
        elif random.random() < 0.7:
            partials[0].kind = m.PartialChartKind.ENCLOSED
            above.steps[1].encloses = [m.Enclosure(chart="G1", activated_steps=[random.choice(below.steps).name])]
    return pou_with(m.SfcNetwork(partial_charts=partials), "a b", "Q R S")


def _chart(
    random: Random, first: int, count: int, *, times: bool, conditions: Sequence[str] = CONDITIONS
) -> m.SfcNetwork:
    chart = m.SfcNetwork()
    steps = [chart.add_step(str(first + index), initial=index == 0) for index in range(count)]

    def condition() -> m.Expression:
        text = random.choice([*conditions, *(TIMES if times else [])])
        return m.Expression(text=text.format(step=random.choice(steps).name))

    for source, target in zip(steps, [*steps[1:], steps[0]], strict=True):
        chart.add_transition(source, target, condition())
    for _ in range(random.randint(0, 2)):
        chart.add_transition(random.choice(steps), random.sample(steps, random.randint(1, 2)), condition())
    if random.random() < 0.2:
        chart.transitions.append(m.Transition(id=80, targets=[steps[1].id], condition=m.Expression(text="↑a")))
    for number, step in enumerate(steps):
        if random.random() < 0.7:
            step.actions.append(_action(random, number, condition(), times=times))
    return chart


def _action(random: Random, number: int, condition: m.Expression, *, times: bool) -> m.ActionAssociation:
    kinds = ["continuous", "conditional", "onActivation", "onDeactivation", "onEvent"]
    kind = random.choice(kinds + (["delayed", "limited"] if times else []))
    if kind in ("onActivation", "onDeactivation", "onEvent"):
        target = random.choice("QR")
        value = random.choice(VALUES).format(target=target)
        event = condition.text if kind == "onEvent" else None
        return action(kind, target, event, value=value, id=60 + number)
    guard = condition.text if kind == "conditional" else None
    duration = "T#20ms" if kind in ("delayed", "limited") else None
    return action(kind, "S", guard, duration=duration, id=60 + number)
