"""``plcopen-sfc page``: a project as one HTML file."""

from __future__ import annotations

from pathlib import Path

from plcopen_sfc.cli.reading import STANDARD_STREAM, exit_code_for, load_input, written_to_stdout
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.files import folder_exists, refuse_empty, write_atomic
from plcopen_sfc.pages import page


def run(screen: Screen, source: str, target: str | None, *, lang: str) -> int:
    """Write the page of `source` to `target` (None: next to it, ``-``: standard output).

    From standard input (``-``) None is standard output.
    """
    project = load_input(screen, source)
    for finding in project.diagnostics:
        screen.finding(finding, result=False)
    if target is None:
        target = STANDARD_STREAM if source == STANDARD_STREAM else str(_beside(Path(source)))
    refuse_empty(target)
    text = page(project, lang=lang)
    with written_to_stdout(screen, target, ".html") as place:
        write_atomic(place, text.encode("ascii"))
    if not screen.as_json and not screen.quiet and target != STANDARD_STREAM:
        screen.line("written: ", (target, "bold"))
    screen.result({"file": source, "page": target})
    return exit_code_for(screen, project.diagnostics)


def _beside(source: Path) -> Path:
    place = source.resolve() if folder_exists(source) else source
    return place.with_name(f"{place.name}.html") if folder_exists(source) else place.with_suffix(".html")
