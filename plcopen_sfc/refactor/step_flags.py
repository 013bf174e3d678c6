"""Active steps in program text: flags of CoDeSys 2.3, which are called like their steps, and members: ``Wait.x``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from plcopen_sfc.languages.binding.name_uses import Names, Occurrence
from plcopen_sfc.languages.binding.text_sites import SiteKind
from plcopen_sfc.languages.edits import Edit, apply_edits
from plcopen_sfc.model.declaration import Kind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork, Step
from plcopen_sfc.refactor.journal import Journal
from plcopen_sfc.refactor.rename import edit_markup

_MEMBER = re.compile(r"\s*\.\s*x\b", re.IGNORECASE)


def name_steps_by_flags(project: Project) -> list[str]:
    """Write ``Wait`` for ``Wait.x`` in `project`, and return the paths of the changed texts."""
    return write_notation(project, _of_simple_steps(project), Journal(), members=False)


def name_steps_by_members(project: Project) -> list[str]:
    """Write ``Wait.x`` for ``Wait`` in `project`, and return the paths of the changed texts."""
    return write_notation(project, _of_simple_steps(project), Journal(), members=True)


def _of_simple_steps(project: Project) -> list[SfcNetwork]:
    """Return the charts without associations, which alone have such flags."""
    return [chart.chart for chart in project.charts() if not any(chart.chart.associations())]


def step_occurrences(project: Project, charts: Iterable[SfcNetwork]) -> Iterator[Occurrence]:
    """Yield the places of program text that ask for steps of some charts."""
    steps = {id(step): step for chart in charts for step in chart.steps}
    names = Names(project) if steps else None
    for occurrence in names.occurrences(*{step.name for step in steps.values()}) if names is not None else ():
        declaration = occurrence.meaning.declaration
        is_step = declaration is not None and declaration.kind is Kind.STEP and isinstance(declaration.holder, Step)
        if is_step and declaration is not None and id(declaration.holder) in steps and _is_text(occurrence):
            yield occurrence


def write_notation(project: Project, charts: Iterable[SfcNetwork], journal: Journal, *, members: bool) -> list[str]:
    """Change the notation in texts that ask for steps of some charts, and return the paths of these texts."""
    found: dict[tuple[int, str | int], list[Occurrence]] = {}
    for occurrence in step_occurrences(project, charts):
        found.setdefault((id(occurrence.text_site.holder), occurrence.text_site.key), []).append(occurrence)
    changed: dict[str, None] = {}
    for occurrences in found.values():
        site, text = occurrences[0].text_site, occurrences[0].text_site.text
        edits = sorted(set(_edits(occurrences, text, members=members)))
        if not edits:
            continue
        journal.keep(site.holder, site.key)
        if getattr(site.holder, "markup", None) is not None:
            journal.keep(site.holder, "markup")
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
