"""Charts for the tests of lowering."""

from __future__ import annotations

import re

from plcopen_sfc import model as m


def training_chain() -> m.Pou:
    """Four steps in a ring that drive three outputs: continuously, stored, and under a condition."""
    chart = m.SfcNetwork()
    steps = [chart.add_step(f"S{number}", initial=number == 1) for number in range(1, 5)]
    for number, step in enumerate(steps, 1):
        step.number = number
        chart.add_transition(step, steps[number % 4], f"B{number}")
    act(chart, steps[0], "Q1")
    act(chart, steps[1], "Q2", m.Qualifier.S)
    act(chart, steps[2], "Q3", condition="B5")
    act(chart, steps[3], "Q2", m.Qualifier.R)
    return pou_with(chart)


def pou_with(chart: m.SfcNetwork) -> m.Pou:
    """A function block with a chart. The names in its conditions are inputs, the targets of its actions outputs."""
    texts = [t.condition.text for t in chart.transitions if isinstance(t.condition, m.Expression)]
    texts += [a.condition.text for _, a in chart.associations() if isinstance(a.condition, m.Expression)]
    read = {name for text in texts for name in re.findall(r"[A-Za-z]\w*", text)} - {"AND", "OR", "NOT", "TRUE", "FALSE"}
    written = {a.target for _, a in chart.associations() if a.target is not None}
    inputs = m.VariableSection(kind=m.SectionKind.INPUT, variables=[boolean(name) for name in sorted(read)])
    outputs = m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[boolean(name) for name in sorted(written)])
    return m.Pou(
        name="Ablauf",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=[inputs, outputs]),
        bodies=[m.SfcBody(chart=chart)],
    )


def act(
    chart: m.SfcNetwork,
    step: m.Step,
    target: str,
    qualifier: m.Qualifier = m.Qualifier.N,
    *,
    duration: str | None = None,
    condition: str | None = None,
) -> None:
    """Add an action to a step."""
    association = m.ActionAssociation.model_validate(
        {
            "id": chart.new_id(),
            "target": target,
            "qualifier": qualifier,
            "duration": duration,
            "condition": condition,
        }
    )
    step.actions.append(association)


def boolean(name: str) -> m.Variable:
    """A variable of type BOOL."""
    return m.Variable(name=name, type=m.ElementaryType(name=m.Elementary.BOOL))
