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


def random_hierarchy(seed: int) -> m.Pou:
    """The same with a macro-step in its first chart, and often one more chart above it all; with comments and names."""
    pou, random = random_grafcet(seed), Random(seed)  # noqa: S311
    chart = pou.chart
    assert chart is not None
    below = chart.partial_charts[0].chart
    inner = _chart(random, 31, random.randint(2, 3), times=seed % 3 == 0)
    # what leads back to the first step of the expansion would be a loop around it
    inner.transitions = [each for each in inner.transitions if inner.steps[0].id not in each.targets]
    inner.steps[0].initial = False
    inner.steps[0].name = "E1"
    end = inner.add_step("S1")
    inner.add_transition(inner.steps[-2], end, m.Expression(text=random.choice(CONDITIONS).format(step="31")))
    for condition in _conditions(inner):
        condition.text = condition.text.replace("X31", "XE1")
    expansion = m.PartialChart(name="M1", kind=m.PartialChartKind.EXPANSION, chart=inner)
    expansion.entry_step, expansion.exit_step = "E1", "S1"
    chart.partial_charts.insert(1, expansion)
    macro = below.add_step("M1")
    macro.macro = m.Macro(expansion="M1")
    onward = random.choice(below.transitions[: len(below.steps) - 1])
    below.add_transition(macro, random.choice(below.steps[:-1]), m.Expression(text=random.choice(["a", "b", "1"])))
    onward.targets = [macro.id]
    onward.comment, onward.name = "zur Erweiterung", "hinein"
    below.steps[0].comment = 'Grundstellung "0"'
    above = chart.partial_charts[-1]
    if above.name == "G2" and random.random() < 0.7:
        top = _chart(random, 21, 2, times=False)
        order = m.ForcingOrder(chart="G2", situation=random.choice([*m.ForcedSituation][:2]), steps=[])
        if order.situation is m.ForcedSituation.EXPLICIT:
            order.steps = [above.chart.steps[1].name]
        top.steps[1].actions.append(m.ActionAssociation(id=91, kind=m.ActionKind.FORCING, forcing=order))
        chart.partial_charts.append(m.PartialChart(name="G3", chart=top))
    return pou


def _conditions(chart: m.SfcNetwork) -> list[m.Expression]:
    found = [each.condition for each in chart.transitions]
    found += [each.condition for step in chart.steps for each in step.actions]
    return [each for each in found if isinstance(each, m.Expression)]


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
