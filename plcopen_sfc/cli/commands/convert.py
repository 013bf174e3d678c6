"""``plcopen-sfc convert``: write a file in another format and report every item."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from datetime import date
from functools import partial
from pathlib import Path

from plcopen_sfc.api import load, save
from plcopen_sfc.batch import is_folder_in, known_format
from plcopen_sfc.cli.command_files import (
    STANDARD_STREAM,
    exit_code_for,
    format_of_target,
    load_and_tell,
    names_in,
    written_to_stdout,
)
from plcopen_sfc.cli.many_files import ManyFiles, for_each, targets
from plcopen_sfc.cli.options import ConvertOptions
from plcopen_sfc.cli.report_items import show_counts, show_items, show_not_executed
from plcopen_sfc.cli.screen import INTERRUPTED, Screen
from plcopen_sfc.errors import ComparisonInterrupt, InputError, Location, LossError
from plcopen_sfc.files import folder_exists, refuse_empty, refuse_unwritable, write_atomic
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.registry import TIA_FORMAT, format_named
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import FIELD, LOSSES, SEQUENCE, ConversionReport, Outcome
from plcopen_sfc.whole_numbers import counted

_FINDINGS = 1


def run(screen: Screen, files: ManyFiles, how: ConvertOptions) -> int:
    """Convert files to the last one that is named (none: next to each, ``-``: standard output).

    From standard input (``-``) none is standard output. Several files are written into a folder, and so is a file in
    several formats, or one whose target is a folder: by the name of the source. Output without a name is a folder for
    tools that import one object a file.
    """
    if how.page is not None:
        screen.report = None  # that is a report in JSON
        refuse_unwritable(how.page)
    formats = names_in(how.to)
    if len(formats) < 2:
        screen.result(_in_format(screen, files, how, "".join(formats)))
        return screen.exit_code
    if how.resume is not None or how.page is not None or STANDARD_STREAM in files.named:
        hint = "Leave out --resume, --report FILE.html and -, or name one format."
        raise InputError("several formats are written of files, one after the other", hint=hint)
    kinds = {name: format_named(name)[0] for name in formats}
    results: dict[str, object] = {}
    for name, kind in kinds.items():
        own = how if kind.name == TIA_FORMAT else replace(how, tia="")
        if not screen.as_json and not screen.quiet:
            screen.line((f"{name}:", "bold"))
        results[name] = _in_format(screen, files, own, name, is_one_of_several=True)
    screen.result({"formats": results})
    return screen.exit_code


def _in_format(
    screen: Screen, files: ManyFiles, how: ConvertOptions, name: str, *, is_one_of_several: bool = False
) -> dict[str, object]:
    """Convert files to one format; return the result. One of several has its name in those of the files."""
    sources, target = files.with_target()
    name = format_of_target(name, target if sources.alone else None, how.tia)
    how = replace(how, to=[name])
    kind = format_named(name)[0]
    extension = kind.extensions[0]
    for each in sources.named:
        refuse_empty(each)

    def inside(path: Path, inner: str) -> str:
        if is_one_of_several:
            return _beside(Path(inner), name, kind)
        return _folder(inner) if is_folder_in(kind, path) else str(Path(inner).with_suffix(extension))

    if sources.alone and how.resume is None:
        (source,) = sources.named
        if target is None:
            from_stdin = source == STANDARD_STREAM
            target = STANDARD_STREAM if from_stdin else _beside(Path(source), name, kind)
        elif is_one_of_several or (source != STANDARD_STREAM and _is_folder_for_files(target, kind)):
            target = targets(sources, target, str, inside)[source]
            Path(target).parent.mkdir(parents=True, exist_ok=True)
        _refuse_another_source(source, target, kind.name)
        try:
            with written_to_stdout(screen, target, extension) as place:
                return _convert(how, target, screen, source, place)
        except ComparisonInterrupt as stop:
            _show(screen, stop.report)
            screen.complain("interrupted: nothing is written")
            screen.exit_code = INTERRUPTED
            return stop.report.as_dict()
    if how.page is not None:
        raise InputError("a report with charts is about one file", hint="Convert that file alone.")
    made = targets(sources, target, lambda path: _beside(path, name, kind), inside)
    work = partial(_convert_one_of_many, how)
    asked = repr(replace(how, report=how.page, resume=None))  # not where a report and the journal are
    kept = (how.resume, ["convert", asked, target]) if how.resume is not None else None
    outcomes = for_each(screen, made, work, "Converting", jobs=files.jobs, journal=kept)
    return {"files": [{"file": each.path, **each.as_dict()} for each in outcomes]}


def _is_folder_for_files(target: str, kind: Format) -> bool:
    """True for a folder into which files of a format go; one of a format with folders is a project itself."""
    return not kind.folders and (target.endswith((os.sep, "/")) or folder_exists(target))


def _refuse_another_source(source: str, target: str, written: str) -> None:
    """Refuse to write over a file of the format of the source: a shell may have made two names of a pattern."""
    read, there = (known_format(Path(each)) for each in (source, target))
    if read is not None and read is there and read.name != written and not Path(source).samefile(target):
        hint = "To convert both, name a folder last: out/. To write over it, remove it first."
        raise InputError(f"this is a file of {read.name} too, as {source} is", location=Location(target), hint=hint)


def _convert_one_of_many(how: ConvertOptions, screen: Screen, source: str, target: str) -> object:
    Path(target).parent.mkdir(parents=True, exist_ok=True)
    if not screen.as_json and not screen.quiet:
        screen.line((f"{source}:", "bold"))
    return _convert(how, target, screen, source, target)


def _convert(how: ConvertOptions, target: str, screen: Screen, source: str, place: str) -> dict[str, object]:
    """Convert one file to `target`, in place of which `place` is written; return the report."""
    project = load_and_tell(screen, source, as_tool=how.as_tool)
    if how.accept_errors:
        project.accept_errors()
    page, lang, limit = how.page, how.lang, how.limit if how.verify and how.limit.strip() != "0" else 0
    try:
        report = save(
            project,
            place,
            format="".join(how.to or ()),
            flavour=how.flavour,
            tia=how.tia,
            partial=how.partial,
            strict=how.strict,
            fresh=how.fresh,
            normalize=how.normalize,
            limit=limit,
            at_rest=names_in(how.at_rest),
        )
    except LossError as loss:
        _show(screen, loss.report)
        if page is not None:
            _write_page(screen, page, project, loss.report, None, lang=lang)
        screen.exit_code = _FINDINGS
        is_listed = not screen.quiet and not screen.as_json
        screen.error(LossError(loss.summary, loss.report, hint=loss.hint) if is_listed else loss)
        return _as_data(loss.report)
    report.written = [target] if target == STANDARD_STREAM else report.written
    if page is not None:
        _write_page(screen, page, project, report, load(place, as_tool=True), lang=lang)
    _show(screen, report)
    if not screen.as_json and not screen.quiet and target != STANDARD_STREAM:
        _show_written(screen, target, report)
    if not limit and not report.unchanged and not report.compared and any(project.charts()):
        screen.note("no chart was simulated for both tools (--no-verify): the report rests on what was written alone")
    if report.untested and not how.accept_untested:
        is_run = any(not report.compared[path].startswith("not compared") for path in report.untested)
        longer = "a longer --limit, or " if is_run else ""
        charts = counted(len(report.untested), "chart")
        told = (
            f"of {charts} not all was simulated for both tools" if is_run else f"not simulated for both tools: {charts}"
        )
        screen.note(f"{told}: {longer}--accept-untested if you have looked")
        screen.exit_code = _FINDINGS
    screen.exit_code = exit_code_for(screen, project.diagnostics)
    return _as_data(report)


def _as_data(report: ConversionReport) -> dict[str, object]:
    return report.as_dict() | {"to_lower": _to_lower(report)}


def _to_lower(report: ConversionReport) -> list[str]:
    if not report.compared:
        return []
    from plcopen_sfc.pages.conversion_overview import pous_to_lower  # noqa: PLC0415  # brings the checks with it

    return pous_to_lower(report)


def _write_page(
    screen: Screen, page: Path, source: Project, report: ConversionReport, target: Project | None, *, lang: str
) -> None:
    from plcopen_sfc.pages import conversion_page  # noqa: PLC0415  # brings the checks with it

    text = conversion_page(
        source, report, target, lang=lang, made_on=date.today()
    )  # as the clock of the reader shows it
    write_atomic(page, text.encode("ascii"))
    screen.note(f"written: {page}")


def _show_written(screen: Screen, target: str, report: ConversionReport) -> None:
    """Print what is new on the disk: the file, or how many files of a folder."""
    if not folder_exists(target):
        screen.line("written: ", (target, "bold"))
        if report.target_format.startswith("simaticml") and not report.source_format.startswith("simaticml"):
            form = f"{Path(target).stem}/ --to simaticml"
            screen.note(f"all objects are in this file: for the import into TIA Portal write a folder ({form})")
        return
    screen.line("written: ", (target, "bold"), f", {len(report.written)} files")
    for name in report.removed:
        screen.line("removed: ", (name, "bold"))
    if report.left_alone:
        screen.note(f"{len(report.left_alone)} other files in the folder are left as they are")
        for name in report.left_alone:
            screen.detail(f"  {name}")


def _beside(source: Path, format_name: str, kind: Format) -> str:
    """Return a name next to `source` that is not its own, even where upper and lower case are the same."""
    extension = kind.extensions[0]
    if folder_exists(source):
        place = source.resolve().with_name(f"{source.resolve().name}.{format_name}")
        return f"{place}/" if kind.folders else f"{place}{extension}"
    if is_folder_in(kind, source):
        return f"{source.with_suffix(f'.{format_name}')}/"
    plain = source.with_suffix(extension)
    own = f".{format_name}" != extension or plain.name.casefold() == source.name.casefold()
    return str(source.with_suffix(f".{format_name}{extension}") if own else plain)


def _folder(name: str) -> str:
    """Return the name of a folder for the file or folder `name`."""
    return f"{Path(name).with_suffix('')}/"


def _by_result(report: ConversionReport) -> Iterator[tuple[str, list[str]]]:
    """Yield what came of charts, and their paths: those that were not run for one reason are together."""
    together: dict[str, list[str]] = {}
    for path, found in report.compared.items():
        if found.startswith("not compared"):
            together.setdefault(found, []).append(path)
        else:
            yield found, [path]
    yield from together.items()


def _show(screen: Screen, report: ConversionReport) -> None:
    if screen.as_json or screen.quiet:
        return
    if report.unchanged:
        screen.line("the format is the same and nothing was edited: the file as it was read")
        return
    show_not_executed(screen, report.with_outcome(Outcome.NOT_EXECUTED))
    for found, paths in _by_result(report):
        is_run = not found.startswith(("not compared", "not run"))
        verdict, *details = found.splitlines()
        screen.line(f"{'simulated for both tools: ' if is_run else ''}{', '.join(paths)}: {verdict}")
        for line in (*details, *report.untested.get(paths[0], ())):
            screen.line(f"  {line}")
    if report.compared:
        screen.line()
    # with --verbose every item that is not simply kept; else what differs for a machine, or for the way back
    items = [item for item in report.items if item.outcome not in (Outcome.KEPT, Outcome.NOT_EXECUTED)]
    if not screen.verbose:
        items = [
            item for item in items if item.outcome in LOSSES or (item.outcome is Outcome.DROPPED and item.what != FIELD)
        ]
    show_items(screen, items)
    if items:
        screen.line()
    show_counts(screen, report)
    target = format_named(report.target_format)[0]
    for name in _to_lower(report):
        command = f"plcopen-sfc lower FILE DST --to {target.name} --pou {name}"
        screen.note(
            f"{name}: {target.tool} has no chart that does exactly the same; `{command}` makes code, and proves it"
        )
    for item in report.items:
        if item.what == SEQUENCE:
            screen.note(f"{item.path}: {item.why}")
