"""``plcopen-sfc draw`` and ``page``: charts and networks as pictures, and projects as HTML pages."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.analysis.verdict import Verdict
from plcopen_sfc.cli.command_files import STANDARD_STREAM, exit_code_for, load_and_tell, load_input, written_to_stdout
from plcopen_sfc.cli.many_files import ManyFiles, for_each, targets
from plcopen_sfc.cli.options import PageOptions
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.documents.picture_files import PICTURE_FORMATS, draw, drawn_bodies
from plcopen_sfc.files import folder_exists, refuse_empty, write_atomic
from plcopen_sfc.model.project import Project
from plcopen_sfc.semantics.profile import default_profile
from plcopen_sfc.semantics.subjects import resolve


def pictures(screen: Screen, files: ManyFiles, *, to: str | None, **options: Any) -> int:
    """Draw charts into the last file that is named (none: next to each, ``-``: standard output).

    `options` are those of `plcopen_sfc.documents.picture_files.draw`, `to` the format.
    """
    sources, target = files.with_target()
    work = partial(_draw, {**options, "format": to})
    if sources.alone:
        screen.result(work(screen, sources.named[0], target))
        return screen.exit_code
    made = targets(sources, target, lambda path: f"{_folder_beside(path)}/", lambda _, name: f"{Path(name).stem}/")
    return _listed(screen, files, made, work, "Drawing")


def _draw(options: dict[str, Any], screen: Screen, source: str, target: str | None) -> dict[str, Any]:
    extension = PICTURE_FORMATS.get((options["format"] or "svg").lower(), "")
    project = load_and_tell(screen, source)
    if target is None and source == STANDARD_STREAM:
        target = STANDARD_STREAM
    elif target is None:
        several = len(drawn_bodies(project, options["pou"])) > 1
        target = f"{_folder_beside(Path(source))}/" if several else str(Path(source).with_suffix(extension))
    with written_to_stdout(screen, target, extension) as place:
        drawn = draw(project, place, **options)
    written = [(each.name, target if target == STANDARD_STREAM else str(each.path)) for each in drawn]
    missing = "".join(sorted({letter for each in drawn for letter in each.missing}))
    if missing:
        screen.note(f"no font of this machine shows these letters, they are boxes: {missing}; SVG has them as text")
    for each in drawn:
        if each.scale < 1:  # letters of less than 12 pixels
            what = f"{each.name} is too long for one image, and drawn at {each.scale:.0%}"
            screen.note(
                f"{what}: its texts may be too small to read; --paper A4 divides it into sheets, SVG has any size"
            )
    if not screen.as_json and not screen.quiet and target != STANDARD_STREAM:
        if len(written) == 1:
            screen.line("written: ", (written[0][1], "bold"))
        else:
            screen.line("written: ", (target, "bold"), f", {len(written)} pictures")
            for _, path in written:
                screen.detail(f"  {path}")
    screen.exit_code = exit_code_for(screen, project.diagnostics)
    return {"file": source, "pictures": [{"chart": name, "file": path} for name, path in written]}


def pages(screen: Screen, files: ManyFiles, how: PageOptions) -> int:
    """Write pages to the last file that is named (none: next to each, ``-``: standard output)."""
    sources, target = files.with_target()
    if sources.alone:
        screen.result(_write_page(how, screen, sources.named[0], target))
        return screen.exit_code
    made = targets(
        sources, target, lambda path: str(_page_beside(path)), lambda _, name: f"{Path(name).with_suffix('')}.html"
    )
    return _listed(screen, files, made, partial(_write_page, how), "Writing")


def _write_page(how: PageOptions, screen: Screen, source: str, target: str | None) -> dict[str, Any]:
    from plcopen_sfc.pages import page  # noqa: PLC0415  # brings the checks with it

    project = load_and_tell(screen, source)
    if target is None:
        target = STANDARD_STREAM if source == STANDARD_STREAM else str(_page_beside(Path(source)))
    refuse_empty(target)
    verdict = None if how.against is None else _verdict(screen, project, how.against, how)
    text = page(project, lang=how.lang, verdict=verdict)
    with written_to_stdout(screen, target, ".html") as place:
        write_atomic(place, text.encode("ascii"))
    if not screen.as_json and not screen.quiet and target != STANDARD_STREAM:
        screen.line("written: ", (target, "bold"))
    screen.exit_code = exit_code_for(screen, project.diagnostics)
    return {"file": source, "page": target} | ({} if verdict is None else {"verdict": verdict.as_dict()})


def _verdict(screen: Screen, project: Project, against: str, how: PageOptions) -> Verdict:
    """Compare a chart or program with that of the same name in another file, each as its own tool executes it."""
    other = load_input(screen, against)
    profiles = default_profile(project), default_profile(other)
    delay = 0 if profiles[0] == profiles[1] else "auto"
    subject = resolve(project, how.pou)
    verdict = equivalent(subject, resolve(other, how.pou), profiles, delay=delay, limit=how.limit)
    if not screen.as_json and not screen.quiet:
        screen.note(f"{subject.name}: {str(verdict).splitlines()[0]}")
    return verdict


def _listed(screen: Screen, files: ManyFiles, made: dict[str, str], work: Any, doing: str) -> int:
    for target in made.values():
        Path(target).parent.mkdir(parents=True, exist_ok=True)
    outcomes = for_each(screen, made, work, doing, jobs=files.jobs)
    screen.result({"files": [each.as_dict() for each in outcomes]})
    return screen.exit_code


def _folder_beside(source: Path) -> Path:
    """Return a folder next to a source, called after it: after what a folder is called, also as ``.``."""
    place = source.resolve() if folder_exists(source) else source
    return place.with_name(f"{place.stem}-charts")


def _page_beside(source: Path) -> Path:
    place = source.resolve() if folder_exists(source) else source
    return place.with_name(f"{place.name}.html") if folder_exists(source) else place.with_suffix(".html")
