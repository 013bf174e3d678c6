"""Charts for tests of the rules, most of them as textual SFC."""

from __future__ import annotations

from collections.abc import Iterable

import plcopen_sfc as sfc
from plcopen_sfc.model import Project, SfcNetwork

RING = """
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
"""


def project_of(text: str, *, declarations: str = "") -> Project:
    """A project with a program of this body, written as textual SFC."""
    project = sfc.loads(f"PROGRAM P\n{declarations}{text}\nEND_PROGRAM\n".encode(), format="iec-text")
    assert not [d for d in project.diagnostics if d.code.startswith("IEC")], project.diagnostics
    return project


def chart_of(text: str) -> SfcNetwork:
    """The chart of a program of this body."""
    chart = project_of(text).pou("P").sfc
    assert chart is not None
    return chart


def ring(*names: str) -> SfcNetwork:
    """A chart of steps in a row that leads back to the first one, without any drawing."""
    chart = SfcNetwork()
    steps = [chart.add_step(name, initial=index == 0) for index, name in enumerate(names)]
    for index, step in enumerate(steps):
        chart.add_transition(step, steps[(index + 1) % len(steps)], f"c{index}")
    return chart


def codes(subject: Project | SfcNetwork, profile: str | None = None, select: Iterable[str] = ()) -> list[str]:
    """The codes of what is found."""
    return [finding.code for finding in sfc.check(subject, profile=profile, select=select)]
