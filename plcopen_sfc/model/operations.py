"""Methods of the model that stand on higher layers.

``chart.rename_step`` must understand program text, which the model does not: it is looked up when it is called. This is
the only place where the model knows of anything above it; see decision 0008.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from plcopen_sfc.errors import Location
    from plcopen_sfc.model.project import Project
    from plcopen_sfc.model.sfc import SfcNetwork
    from plcopen_sfc.refactor.rename import RenameResult


def rename(project: Project, path: str, new: str) -> RenameResult:
    """`plcopen_sfc.refactor.rename.rename`."""
    result: RenameResult = import_module("plcopen_sfc.refactor.rename").rename(project, path, new)
    return result


def rename_step(chart: SfcNetwork, old: str, new: str) -> RenameResult:
    """`plcopen_sfc.refactor.rename.rename_step`."""
    result: RenameResult = import_module("plcopen_sfc.refactor.rename").rename_step(chart, old, new)
    return result


def locations_of(project: Project, paths: Iterable[str]) -> list[Location]:
    """`plcopen_sfc.documents.sources.locations_of`."""
    places: list[Location] = import_module("plcopen_sfc.documents.sources").locations_of(project, paths)
    return places
