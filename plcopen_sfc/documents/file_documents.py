"""One file as bytes: read into a project that keeps its source, and written with just the edits in it."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import DamagedSourceError, Severity
from plcopen_sfc.documents.edited_files import patched, patched_text
from plcopen_sfc.documents.reading_back import (
    keep_step_names,
    read_back,
    report_diagnostics,
    report_reading_errors,
    verify,
    writing,
)
from plcopen_sfc.documents.source_names import names_in_the_source
from plcopen_sfc.documents.sources import FileSource, FolderSource
from plcopen_sfc.errors import FormatError, LossError, UnknownFormatError, check_argument, nearest
from plcopen_sfc.formats.file_recognition import recognise
from plcopen_sfc.formats.format_interface import Format, WriteOptions
from plcopen_sfc.formats.provenance import (
    Origin,
    compared_only,
    content_digest,
    file_digest,
    is_edited,
    place_in_folder,
    remember_body,
    remember_object,
    without_edits,
)
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.languages.library_blocks import library_blocks
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import ConversionReport, Outcome

if TYPE_CHECKING:
    from plcopen_sfc.conversion import Part


def read_document(data: bytes, *, format: str | None, path: str | None, as_tool: bool = False) -> Project:
    """Return the project in the bytes of one file. `path` is what messages call them. Raises `FormatError`.

    `as_tool`: as the tool of the format sees it. See `as_tool_sees`.
    """
    kind, version = format_named(format) if format is not None else (recognise(data, file=path), "")
    if as_tool:
        data = as_tool_sees(data, kind, path)
    with collecting_rarely():
        try:
            reading = kind.codec(version).read(data, file=path)
        except FormatError as error:
            error.location = error.location if error.location.file else replace(error.location, file=path)
            raise
        project, mark = reading.project, file_digest(data)
        for pou in project.pous:
            for name, _, body in () if pou.is_unread else pou.named_bodies():
                if isinstance(body, SfcBody):
                    remember_body(body, Origin(name, data, mark))
        with without_edits():
            for things in (getattr(project, name) for name in Project.OBJECTS):
                for number, thing in enumerate(things):
                    remember_object(thing, Origin(number, data, mark))
            digest = fingerprint(project)
    project.source = FileSource(kind.name, reading.version, data, digest, path, reading.diagnostics)
    return project


def as_tool_sees(data: bytes, kind: Format, path: str | None = None) -> bytes:
    """Return a file of the format `kind` without what writers of this package carry in it, which no other tool reads.

    Data of vendors stays, as their tools read it. What else is there stays in its line.
    """
    return kind.codec().as_tool_sees(data, file=path)


def fingerprint(project: Project) -> bytes:
    """Return a digest of everything in the model, to tell whether it was edited since it was read."""
    with collecting_rarely():
        content = project.__pydantic_serializer__.to_json(project, exclude_none=True, exclude=set(Project.OBJECTS))
        digest = hashlib.blake2b(content)
        for thing in project.objects():
            digest.update(content_digest(thing))
        return digest.digest()


def encode(
    project: Project, name: str, *, flavour: str, fresh: bool, limit: float = 0, at_rest: Collection[str] = ()
) -> tuple[bytes, ConversionReport]:
    """Return the bytes of `project` in the format `name` (``simaticml-V16``), and what became of each item.

    `limit`: for so many seconds the charts are simulated for both. `at_rest` is that of `WriteOptions`.
    """
    check_argument(flavour, str, "a flavour is named by a text")
    kind, version = format_named(name)
    if flavour and flavour not in kind.flavours:
        near = nearest(flavour, kind.flavours)
        known = ", ".join(kind.flavours) or "none"
        raise UnknownFormatError(f"format {kind.name} has no flavour {flavour!r}{near}", hint=f"Flavours are: {known}")
    report = ConversionReport(project.source.format if project.source is not None else "", name)
    source = project.source if isinstance(project.source, FileSource) else None
    if source is not None and source.format == kind.name and version in ("", source.version) and not flavour:
        version = source.version
        edited = any(map(is_edited, project.objects()))  # takes less than to look at all of an edited object
        if not fresh and not edited and fingerprint(project) == source.fingerprint:
            report.unchanged = True
            return source.content, report
        if not fresh and (kind.xml or kind.text):
            with collecting_rarely():
                return (patched if kind.xml else patched_text)(project, source, kind, report), report
    same_format = source is not None and source.format == kind.name and not flavour
    same = same_format and source is not None and source.version == version
    if not same:
        refuse_reading_errors(project, report)
    elif kind.text:  # what was not understood of a text may be in its file only; the model keeps all of XML
        report_reading_errors(project, report)
    content = source.content if source is not None and same else b""
    options = WriteOptions(version, flavour, same=same, same_format=same_format, source=content, at_rest=at_rest)
    from plcopen_sfc.documents.writer_preparation import prepared  # noqa: PLC0415  # loading needs no interpreter

    with collecting_rarely():
        copy, meant, options, behaviour = prepared(project, kind, options, report)
        with writing(kind):
            data = kind.codec(version).write(copy, options, report)
        seen, back, shown = None, None, as_tool_sees(data, kind) if behaviour is not None else data
        if behaviour is not None and kind.ids and not same and shown is data:
            with writing(kind), compared_only():  # the tool sees what is read back, and comparing leaves it as it is
                seen = read_document(data, format=name, path=None)
                seen.read_all()
        if not (options.flavour and kind.text):  # what a flavour leaves out is for people, and not read back
            back = seen if seen is not None else read_back(data, kind, version)
            verify(meant, kind, back, report)
        called = names_in_the_source(project, copy)
    if behaviour is not None:
        if seen is None:
            seen = read_document(shown, format=name, path=None)
            if kind.text and back is not None:
                keep_step_names(seen, back, report)
        report_behaviour(report, project, behaviour, seen, called, tool=kind.tool, flavour=flavour, limit=limit)
    elif limit:
        _report_without_tool(report, project, data, kind, called, limit=limit)
    if source is not None:
        report.locate(format_named(source.format)[0].codec().lines(source.content, project), called=called)
    locate_in_folder(project, report, called)
    return data, report


def _report_without_tool(
    report: ConversionReport, project: Project, data: bytes, kind: Format, called: Mapping[str, str], *, limit: float
) -> None:
    """Run the charts of a format that is no tool's: GRAFCETs by the rules of IEC 60848. Nothing executes step lists."""
    from plcopen_sfc.conversion.running import report_running  # noqa: PLC0415  # brings the interpreter
    from plcopen_sfc.semantics.profile import profile_of_format  # noqa: PLC0415

    if profile_of_format(kind.name).grafcet_terms:
        seen = read_document(data, format=kind.name, path=None, as_tool=True)
        report_running(report, project, seen, called, tool="GRAFCET", target=None, limit=limit)
    elif kind.name != "json":  # the model itself
        told = f"not compared, as nothing executes a {kind.title}"
        charts = [chart.report_path for chart in project.charts() if chart.chart.steps]
        report.compared |= dict.fromkeys(charts, told)
        report.untested |= {path: [] for path in charts}


def report_behaviour(
    report: ConversionReport,
    project: Project,
    behaviour: Part,
    seen: Project,
    called: Mapping[str, str],
    *,
    tool: str,
    flavour: str = "",
    limit: float,
) -> None:
    """Add to `report` where what the target `tool` sees of `project` differs from its `behaviour`.

    `called` gives the paths in the source of what has another name in the target; for `limit` seconds the charts run.
    """
    from plcopen_sfc.conversion import (  # noqa: PLC0415
        compare,
        executed,
        report_errors,
        report_execution,
        report_scan_order,
    )
    from plcopen_sfc.semantics.profile import PROFILES, default_profile  # noqa: PLC0415

    target = PROFILES[flavour] if flavour else None
    own = family(project.dialect)
    # CODESYS, CoDeSys 2.3 and TwinCAT have libraries of their own; text is read by the tool of its source
    formats = {project.tool_format or "codesys", seen.tool_format} - {"iec-text"}
    tools = {format_named(each)[0].tool for each in formats}
    has_other_libraries = own is Dialect.CODESYS and len(tools) > 1
    # a plan need not declare what it names, a program of any tool must
    is_plan = default_profile(project).name == "grafcet" != default_profile(seen).name
    found = compare(
        behaviour,
        executed(seen, target, compared_with=behaviour),
        other_tool=bool(flavour) or is_plan or has_other_libraries or own is not family(seen.dialect),
        has_libraries=own is not Dialect.IEC,
        known={block.name.casefold() for block in library_blocks(project) if library_blocks(seen)},  # of both tools
    )
    report_execution(report, found, flavour or tool, called)
    known = {each.code for each in project.diagnostics}
    errors = [each for each in seen.diagnostics if each.severity is Severity.ERROR and each.code not in known]
    report_errors(report, errors, flavour or tool, called)
    profiles = default_profile(project), target or default_profile(seen)
    report_scan_order(report, project, seen, called, profiles=profiles, tool=flavour or tool)
    if limit:
        from plcopen_sfc.conversion.running import report_running  # noqa: PLC0415  # brings the interpreter

        report_running(report, project, seen, called, tool=flavour or tool, target=target, limit=limit)


def locate_in_folder(project: Project, report: ConversionReport, called: Mapping[str, str]) -> None:
    """Fill in document and line of the items of `report` that are not simply kept, where the source was a folder.

    `called`: paths in the source of what has another one in the report.
    """
    source = project.source
    if not isinstance(source, FolderSource):
        return
    told = {ObjectPath.of(item.path).owner for item in report.items if item.outcome is not Outcome.KEPT}
    told |= {called[path] for path in told & called.keys()}
    told_in: dict[str, set[str]] = {}
    for thing in project.objects():
        place = place_in_folder(thing)
        if place is not None and thing.report_path in told:
            told_in.setdefault(place[0], set()).add(thing.report_path)
    codec = format_named(source.format)[0].codec()
    for path, names in told_in.items():
        if path in source.documents:
            document = source.documents[path].source
            lines = codec.lines(document.content, project)
            here = {place: line for place, line in lines.items() if ObjectPath.of(place).owner in names}
            report.locate(here, document.path, called=called)


def normalized(data: bytes, name: str) -> bytes:
    """Return a file in the format `name` without what its tool ignores; `UnknownFormatError`: that is nothing."""
    kind = format_named(name)[0]
    result = kind.codec().normalize(data)
    if result is None:
        raise UnknownFormatError(f"there is nothing to normalise in files of the format {kind.name}")
    return result


def refuse_reading_errors(project: Project, report: ConversionReport) -> None:
    """Raise `DamagedSourceError` where reading the source found errors; where they are accepted, report them.

    A folder that stays in its format keeps its documents as they are: only those that could not be read are missing.
    """
    source = project.source
    folder = source if isinstance(source, FolderSource) else None
    stays = folder is not None and format_named(report.target_format)[0].name == folder.format
    findings = folder.own_diagnostics if stays and folder is not None else project.diagnostics
    errors = [found for found in findings if found.severity is Severity.ERROR]
    if errors and source is not None and not source.errors_accepted:
        raise DamagedSourceError(errors)
    for path, error in folder.unreadable.items() if folder is not None else ():
        report.add(Outcome.NOT_EXECUTED, "file", path, f"it could not be read: {error.message}")
    own = folder.own_diagnostics if folder is not None else ()
    report_diagnostics(report, (found for found in errors if found not in own))


def refuse_losses(report: ConversionReport, *, strict: bool, partial: bool) -> None:
    """Raise `LossError` where the target does not execute something, unless `partial`; `strict`: or otherwise."""
    refused = report.losses if strict else [] if partial else report.with_outcome(Outcome.NOT_EXECUTED)
    if not refused:
        return
    from plcopen_sfc.conversion.executed_parts import OPERATING_KINDS  # noqa: PLC0415  # not needed to load and look

    first = "; ".join(f"{item.place}: {item.why}" for item in refused[:_NAMED])
    more = f"; and {len(refused) - _NAMED} more" if len(refused) > _NAMED else ""
    what = "would be executed otherwise or not at all" if strict else "would not be executed"
    hint = "" if strict else " --partial (partial=True) writes the rest, and keeps what it can for the way back."
    inputs = dict.fromkeys(ObjectPath.of(item.path).last for item in refused if item.what in OPERATING_KINDS)
    if inputs:
        names = ", ".join(inputs)
        hint = (
            f" If {names} are never operated on your machine, state it by --at-rest NAME for each of them, or "
            f'--at-rest all (at_rest=["all"]): then they are no losses.{hint}'
        )
    count = "1 item" if len(refused) == 1 else f"{len(refused)} items"
    raise LossError(f"{count} {what}", report, items=f"{first}{more}", hint=f"Nothing was written.{hint}")


_NAMED = 3
