"""Active steps in program text: flags of CoDeSys 2.3, which are called like their steps, and members: ``Wait.x``."""

from __future__ import annotations

import re
from collections.abc import Iterator

from plcopen_sfc.languages.binding.name_uses import Names, Occurrence
from plcopen_sfc.languages.binding.symbols import Kind
from plcopen_sfc.languages.binding.text_sites import SiteKind
from plcopen_sfc.languages.edits import Edit, apply_edits
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Step
from plcopen_sfc.refactor.rename import edit_markup

_MEMBER = re.compile(r"\s*\.\s*x\b", re.IGNORECASE)


def name_steps_by_flags(project: Project) -> list[str]:
    """Write ``Wait`` for ``Wait.x`` in `project`, and return the paths of the changed texts."""
    return _written(project, members=False)


def name_steps_by_members(project: Project) -> list[str]:
    """Write ``Wait.x`` for ``Wait`` in `project`, and return the paths of the changed texts."""
    return _written(project, members=True)


def _written(project: Project, *, members: bool) -> list[str]:
    """Change the notation in texts that ask for steps of charts without associations, which alone have such flags."""
    charts = [chart.chart for chart in project.charts() if not any(chart.chart.associations())]
    steps = {id(step): step for chart in charts for step in chart.steps}
    if not steps:
        return []
    names = Names(project)
    found: dict[tuple[int, str | int], list[Occurrence]] = {}
    for occurrence in names.occurrences(*{step.name for step in steps.values()}):
        declaration = occurrence.meaning.declaration
        is_step = declaration is not None and declaration.kind is Kind.STEP and isinstance(declaration.holder, Step)
        if is_step and declaration is not None and id(declaration.holder) in steps and _is_text(occurrence):
            found.setdefault((id(occurrence.text_site.holder), occurrence.text_site.key), []).append(occurrence)
    changed: dict[str, None] = {}
    for occurrences in found.values():
        site, text = occurrences[0].text_site, occurrences[0].text_site.text
        edits = sorted(set(_edits(occurrences, text, members=members)))
        if not edits:
            continue
        if getattr(site.holder, "markup", None) is not None:
            site.holder.markup = edit_markup(site.holder.markup, text, edits)
        site.put(apply_edits(text, edits))
        changed[site.report_path] = None
    return list(changed)


def _is_text(occurrence: Occurrence) -> bool:
    return occurrence.text_site.is_program_text or occurrence.text_site.reading is SiteKind.INSTRUCTIONS


def _edits(occurrences: list[Occurrence], text: str, *, members: bool) -> Iterator[Edit]:
    for occurrence in occurrences:
        end = occurrence.reference.span[1]
        member = _MEMBER.match(text, end)
        if members and not text[end:].lstrip().startswith("."):
            yield Edit(end, end, ".x")
        elif not members and member is not None:
            yield Edit(end, member.end(), "")
