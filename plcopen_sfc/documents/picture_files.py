"""Pictures of the charts of a project, written to files."""

from __future__ import annotations

import os
from pathlib import Path

from plcopen_sfc.documents.folder_documents import FileNames
from plcopen_sfc.drawing.pictures import Theme, chart_svg
from plcopen_sfc.errors import ModelError, check_argument, nearest
from plcopen_sfc.files import refuse_empty, write_all
from plcopen_sfc.model.project import Chart, Project

__all__ = ["draw"]

_EXTENSION = ".svg"
_SHOWN = 20


def draw(
    project: Project,
    target: str | os.PathLike[str],
    *,
    pou: str | None = None,
    style: str | None = None,
    theme: str = Theme.LIGHT,
) -> dict[str, Path]:
    """Draw the charts of a project, or the one called `pou` (``Main``, ``Main.Fill``), as SVG files.

    `target` is a file for one chart, or a folder, which exists or ends in a slash; there each picture has the name of
    its chart. `style` and `theme` as in `SfcNetwork.to_svg`. Returns the files by the names of the charts. All are
    written or none. Raises `ModelError` where there is no such chart, or several for one file, and `FileAccessError`.
    """
    check_argument(project, Project, "draw needs a project", "A chart draws itself: chart.to_svg().")
    path = os.fspath(target)
    refuse_empty(path)
    charts = _chosen(project, pou)
    files = _files(charts, path)
    write_all({files[each.name]: chart_svg(each.chart, style, theme).encode("ascii") for each in charts})
    return files


def _chosen(project: Project, pou: str | None) -> list[Chart]:
    charts = list(project.charts())
    names = [each.name for each in charts]
    listed = ", ".join(names[:_SHOWN]) + (" .." if len(names) > _SHOWN else "")
    if not charts:
        raise ModelError("the project has no chart to draw")
    if pou is None:
        return charts
    chosen = [each for each in charts if each.name.casefold() == pou.casefold()]
    if not chosen:
        raise ModelError(f"the project has no chart {pou!r}{nearest(pou, names)}", hint=f"Its charts are: {listed}")
    return chosen


def _files(charts: list[Chart], path: str) -> dict[str, Path]:
    """Return the files for the charts, by their names."""
    if path.endswith(("/", os.sep)) or Path(path).is_dir():
        names = FileNames()
        return {each.name: Path(path, names.free("", each.name, _EXTENSION)) for each in charts}
    if len(charts) > 1:
        hint = "Name a folder (pictures/), or one of the charts."
        raise ModelError(f"{len(charts)} charts do not fit into one picture", hint=hint)
    return {charts[0].name: Path(path)}
