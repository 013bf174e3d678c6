"""``plcopen-sfc draw``: charts and networks as pictures."""

from __future__ import annotations

from pathlib import Path

from plcopen_sfc.cli.reading import STANDARD_STREAM, exit_code_for, load_input, written_to_stdout
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.documents.picture_files import PICTURE_FORMATS, draw, drawn_bodies
from plcopen_sfc.files import folder_exists


def run(
    screen: Screen,
    source: str,
    target: str | None,
    *,
    pou: str | None,
    style: str | None,
    theme: str,
    format: str | None,
    paper: str | None,
) -> int:
    """Draw the charts of `source`, or what is called `pou`, into `target` (None: next to it, ``-``: standard output).

    From standard input (``-``) None is standard output.
    """
    extension = PICTURE_FORMATS.get((format or "svg").lower(), "")
    project = load_input(screen, source)
    for finding in project.diagnostics:
        screen.finding(finding, result=False)
    if target is None:
        several = len(drawn_bodies(project, pou)) > 1
        target = STANDARD_STREAM if source == STANDARD_STREAM else _beside(Path(source), extension, several=several)
    with written_to_stdout(screen, target, extension) as place:
        drawn = draw(project, place, pou=pou, style=style, theme=theme, format=format, paper=paper)
    written = [(name, target if target == STANDARD_STREAM else str(path)) for name, path in drawn]
    if not screen.as_json and not screen.quiet and target != STANDARD_STREAM:
        if len(written) == 1:
            screen.line("written: ", (written[0][1], "bold"))
        else:
            screen.line("written: ", (target, "bold"), f", {len(written)} pictures")
            for _, path in written:
                screen.detail(f"  {path}")
    screen.result({"file": source, "pictures": [{"chart": name, "file": path} for name, path in written]})
    return exit_code_for(screen, project.diagnostics)


def _beside(source: Path, extension: str, *, several: bool) -> str:
    """Return the name of a file next to `source`; of a folder if there are `several` charts."""
    place = source.resolve() if folder_exists(source) else source
    return f"{place.with_name(f'{place.stem}-charts')}/" if several else str(place.with_suffix(extension))
