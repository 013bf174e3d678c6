"""Where the objects of a project stand in their text."""

from __future__ import annotations

from plcopen_sfc.formats.iectext.outline import POUS, Kind, Part
from plcopen_sfc.formats.iectext.project_reader import read_project
from plcopen_sfc.formats.iectext.source import Source
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.pou import Pou


def source_lines(text: str) -> dict[str, int]:
    """The line of each object in a text, by the path that a `ConversionReport` gives it."""
    project, src = read_project(text, None)
    finder = _Finder(src)
    units = (part for part in src.outline.parts if part.kind in POUS)
    for part, pou in zip(units, project.pous, strict=False):
        finder.note(part, f"POU {pou.name}", pou.bodies, pou)
    return finder.found


class _Finder:
    def __init__(self, src: Source) -> None:
        self.found: dict[str, int] = {}
        self._src = src
        self._lines = Lines(src.text)

    def note(self, part: Part, path: str, bodies: list[Body], pou: Pou | None = None) -> None:
        """Note the line of a POU or an action, and those of the steps, transitions and actions in it."""
        self._put(path, part)
        chart = next((body.chart for body in bodies if isinstance(body, SfcBody)), None)
        steps = iter(chart.steps if chart is not None else ())
        labels = iter(chart.labels().values() if chart is not None else ())
        for inner in part.parts:
            if inner.kind is Kind.STEP and (step := next(steps, None)) is not None:
                self._put(f"{path} / step {step.name}", inner)
            elif inner.kind is Kind.TRANSITION and chart is not None and self._leads(inner):
                label = next(labels, None)
                if label is not None:
                    self._put(f"{path} / transition {label}", inner)
            elif inner.kind is Kind.ACTION and pou is not None and (action := pou.action(inner.name)) is not None:
                own = [action.body] if action.body is not None else []
                self.note(inner, f"{path} / action {action.name}", own)

    def _put(self, path: str, part: Part) -> None:
        self.found.setdefault(path, self._lines.place(part.start)[0])

    def _leads(self, part: Part) -> bool:
        """Whether a transition is one of the chart, rather than a transition object of the POU."""
        return any(token.value.upper() in ("FROM", "TO") for token in self._src.outline.tokens(part.tokens))
