"""Checking charts: the rules of `plcopen_sfc.analysis.checks`, with the places of their findings in the file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.errors import check_argument, listed_names
from plcopen_sfc.languages.st.parsing import sharing_trees
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork

if TYPE_CHECKING:
    from plcopen_sfc.semantics.profile import Profile


@collecting_rarely()
@sharing_trees()
def check(
    subject: Project | Pou | SfcNetwork,
    *,
    profile: str | Profile | None = None,
    select: Iterable[str] = (),
    ignore: Iterable[str] = (),
    externals: Iterable[str] = (),
) -> list[Diagnostic]:
    """Return the findings in the charts of a project, of a POU, or in one chart; docs/checks.md has the rules.

    Rules on names, types and values look at the code of POUs without charts too.

    `profile` is how the charts are executed (see `plcopen_sfc.semantics.profile`); without it that of the tool which
    the project is for. It decides which rules apply and how severe a breach is. `select` are the rules to apply, by
    their codes or by what their codes begin with (``STR``), and `ignore` those not to apply. Elements that are excluded
    from the program are not looked at, and ``plcopen-sfc: ignore STR09`` in the comment of a step, a transition, a
    chart or a POU suppresses findings there.

    `externals` are patterns (``GVL_*``) for names that are declared outside of a partial export: with them every other
    name that nothing declares is a finding, instead of one of what may be declared elsewhere.

    Findings of a project that was loaded have the file and, as far as its format has them, the line; in a folder, that
    of the document. Findings of the reader are in `Project.diagnostics`, not here. Raises `ModelError` for a rule or
    profile that does not exist.
    """
    from plcopen_sfc.analysis.checks import check_charts  # noqa: PLC0415  # brings the parser with it

    check_argument(subject, (Project, Pou, SfcNetwork), "check needs a chart, a POU or a project")
    externals = listed_names(externals, "externals are patterns for names")
    found = check_charts(subject, profile=profile, select=select, ignore=ignore, externals=externals)
    project = subject.project
    return _located(found, project) if found and project is not None else found


def _located(found: list[Diagnostic], project: Project) -> list[Diagnostic]:
    """Return the findings with their places in the file, by file and line."""
    if project.source is None:
        return found
    places = project.locations_of(each.location.path or "" for each in found)
    placed = [replace(each, location=place) for each, place in zip(found, places, strict=True)]
    return sorted(placed, key=lambda each: (each.location.file or "", each.location.line or 0))
