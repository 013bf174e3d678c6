"""Errors name the chart that they are about as messages and reports do."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from plcopen_sfc.errors import LoweringError
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project


@contextmanager
def errors_of(project: Project, pou: Pou, name: str) -> Iterator[None]:
    """Errors of lowering the chart called `name`, that of the POU or of an action, get the place of that chart.

    Whoever raises them sees a POU with a chart, and knows nothing of actions and files.
    """
    try:
        yield
    except LoweringError as error:
        path = error.location.path or pou.name
        if not path.startswith("POU "):  # else it is the error of a chart that this one brings along
            inside = "" if path in (pou.name, name) else path.removeprefix(f"{pou.name} / ")
            path = " / ".join(filter(None, [pou.report_path_of(name), inside]))
            (error.location,) = project.locations_of([path])
        raise
