"""Projects in paths, binary files and folders: loading them, and saving them in a format.

`plcopen_sfc.load` and `plcopen_sfc.save` are these functions, and describe their arguments.
"""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, NamedTuple, Protocol, TypedDict, runtime_checkable

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.documents.file_documents import encode, normalized, read_document, refuse_losses
from plcopen_sfc.documents.sources import FileSource, FolderSource
from plcopen_sfc.errors import FileAccessError, Location, ModelError, UnknownFormatError, check_argument
from plcopen_sfc.files import file_exists, folder_exists, path_exists, read_bytes, refuse_empty, write_atomic
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.provenance import is_untouched, may_have_controls, texts_of, without_edits
from plcopen_sfc.formats.registry import TIA_FORMAT, all_formats, for_tia, format_named
from plcopen_sfc.languages.st.parsing import sharing_trees
from plcopen_sfc.languages.words import IEC_KEYWORDS, is_plain, objection
from plcopen_sfc.model import times
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import Project, TagTable
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork
from plcopen_sfc.model.types import DataTypeDeclaration, EnumType, StructType
from plcopen_sfc.model.variables import Interface
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import ConversionReport

if TYPE_CHECKING:
    from plcopen_sfc.documents.folder_projects import Progress


class _Named(Protocol):
    name: str


class Mistake(NamedTuple):
    """Something that cannot be saved, and the path of the object that has it."""

    path: str
    message: str

    @property
    def owner(self) -> str:
        """The object of the project that has it."""
        return ObjectPath.of(self.path).owner

    @property
    def inside(self) -> tuple[str, str]:
        """The mistake, whatever the owner is called."""
        return ObjectPath.of(self.path).inside(self.owner), self.message


def refuse_mistakes(project: Project, kind: Format, *, of_grafcet: bool = False) -> None:
    """Raise `ModelError` for what cannot be saved; `of_grafcet`: the steps get other names in the target (``Step1``).

    That are ids that two objects and names that two steps of a chart have, times that are not valid, and names and
    characters that the target cannot have.
    """
    # what was not edited has the mistakes of its source, which are taken out again, but for those of GRAFCETs
    grafcet = any(_has_numbers_for_names(source.format) for source in _sources(project))
    things = [each for each in project.objects() if grafcet or not is_untouched(each)]
    found = set(_mistakes(project, kind, things, of_grafcet=of_grafcet))
    present = {each.report_path for each in project.objects()} if found else set()
    for source in _sources(project) if found else ():
        before = format_named(source.format)[0].codec().read(source.content).project
        gone = {each.report_path for each in before.objects()} - present  # some have other names now
        _read_some(before, gone | {mistake.path for mistake in found})
        known = set(_mistakes(before, kind, list(before.objects())))
        if _has_numbers_for_names(source.format):  # right there, and not in the target
            known = {mistake for mistake in known if " / step " in mistake.path}
        renamed = {mistake.inside for mistake in known if mistake.owner in gone}
        new = present - {each.report_path for each in before.objects()}
        found = {each for each in found - known if each.owner not in new or each.inside not in renamed}
    found |= set(_unwritable_texts(project, kind))
    if found:
        first, *others = sorted(found)
        more = f" (and {len(others)} more of such mistakes)" if others else ""
        raise ModelError(f"{first.message}{more}", location=Location(path=first.path), hint="Nothing was written.")


def _has_numbers_for_names(form: str) -> bool:
    """True for formats of GRAFCETs, whose names may begin with a digit (``1B1``)."""
    return form.startswith("grafcet")


def _read_some(project: Project, paths: Iterable[str]) -> None:
    """Read the objects that have these paths in them: to read a whole source takes longer than to save an edit."""
    for thing in project.objects():
        around = thing.report_path
        if any(path == around or path.startswith(f"{around} / ") for path in paths):
            thing.read()
            for body in thing.named_bodies() if isinstance(thing, Pou) else ():
                if isinstance(body.body, SfcBody):
                    body.body.chart.read()


def _sources(project: Project) -> list[FileSource]:
    source = project.source
    if isinstance(source, FolderSource):
        return [document.source for document in source.documents.values()]
    return [source] if isinstance(source, FileSource) else []


def _mistakes(
    project: Project, kind: Format, things: Collection[ProjectObject], *, of_grafcet: bool = False
) -> Iterator[Mistake]:
    """Yield the mistakes in what was read of a project and its `things`; what is unread is as it is in its file."""
    names: Dialect | None = None
    if kind.xml and not _has_numbers_for_names(
        kind.name
    ):  # json has any name, and writers of text replace names and report that
        # in SCL any name can be in quotes; other tools get another one for it
        names = Dialect.SCL if Dialect.SCL in (kind.dialect, project.dialect) else Dialect.IEC
        for path, name in _names(project, things):
            yield from _name(name, path, names)
    for path, task in ((f"task {task.name}", task) for each in project.resources() for task in each.tasks):
        why = times.interval_objection(task.interval) if task.interval is not None else ""
        if why:
            yield Mistake(path, f"the interval {task.interval!r} cannot be saved: {why}")
    for pou in (each for each in things if isinstance(each, Pou) and not each.is_unread):
        for body in pou.named_bodies():
            chart = getattr(body.body, "chart", None)
            if isinstance(chart, SfcNetwork) and not chart.is_unread:
                yield from _chart_mistakes(chart, pou.report_path_of(body.name), None if of_grafcet else names)


def _unwritable_texts(project: Project, kind: Format) -> Iterator[Mistake]:
    """Yield texts with characters that a file of a format cannot hold: no file holds surrogates, XML no controls."""
    forbidden, holder = (_NOT_IN_XML, "XML") if kind.xml or kind.xml_texts else (_SURROGATES, "a file")
    texts = [("project", text) for text in texts_of(project, exclude=set(Project.OBJECTS))]
    come_from_xml = all(format_named(source.format)[0].xml for source in _sources(project))
    for thing in project.objects():
        if come_from_xml and is_untouched(thing):
            continue  # XML has neither
        if (not thing.is_unread or kind.xml) and may_have_controls(thing):
            texts += [(thing.report_path, text) for text in texts_of(thing)]
    for path, text in texts:
        found = forbidden.search(text)
        if found is not None:
            what = f"{text[:_SHOWN]!r} has the character U+{ord(found[0]):04X}"
            yield Mistake(path, f"{what}, which {holder} cannot hold")


_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_SURROGATES = re.compile("[\ud800-\udfff]")
_SHOWN = 40


def _names(project: Project, things: Iterable[ProjectObject]) -> Iterator[tuple[str, str]]:
    """Yield the paths and names of what a project and its `things` declare, but for steps."""
    for thing in things:
        if thing.is_unread:
            continue
        yield thing.report_path, thing.name
        inside: list[tuple[str, Iterable[_Named]]] = []
        match thing:
            case Pou():
                inside = [("action", thing.actions), ("method", thing.methods), ("variable", thing.variables())]
            case DataBlock(interface=Interface() as interface):
                inside = [("variable", interface.variables())]
            case TagTable():
                inside = [("tag", thing.tags), ("constant", thing.constants)]
            case DataTypeDeclaration(type=StructType(members=members)):
                inside = [("member", members)]
            case DataTypeDeclaration(type=EnumType(values=values)):
                inside = [("value", values)]
        for kind, parts in inside:
            yield from ((f"{thing.report_path} / {kind} {each.name}", each.name) for each in parts)
    for section in project.global_sections():
        yield from ((f"global variable {each.name}", each.name) for each in section.variables)


def _name(name: str, path: str, dialect: Dialect) -> Iterator[Mistake]:
    if dialect is Dialect.SCL:
        why = objection(name, dialect)
        if why:
            yield Mistake(path, f"{name!r} is no name: {why}" if name else "the name is empty")
    elif not is_plain(name):
        yield Mistake(path, f"{name!r} is no name: it needs letters, digits and underscores, and no digit at the start")
    elif name.upper() in IEC_KEYWORDS:
        yield Mistake(path, f"{name!r} is a keyword and no name: give it another one")


def _time(field: str, value: str | None, path: str) -> Iterator[Mistake]:
    why = times.objection(value) if value is not None else ""
    if why and times.objection(f"T#{value}"):  # files of TC6 have 10s
        yield Mistake(path, f"the {field.replace('_', ' ')} {value!r} cannot be saved: {why}")


def _chart_mistakes(chart: SfcNetwork, path: str, names: Dialect | None) -> Iterator[Mistake]:
    things = [(step.id, f"step {step.name}") for step in chart.steps]
    labels = chart.labels()
    things += [(each.id, f"transition {labels[each.id]}") for each in chart.transitions]
    things += [(node.id, f"element {node.kind}") for node in chart.logic]
    counts = Counter(number for number, _ in things)
    for number, thing in things:
        if counts[number] > 1:
            yield Mistake(f"{path} / {thing}", f"the id {number} belongs to another object of the chart too")
    spelled = Counter(step.name.casefold() for step in chart.steps)
    for step in chart.steps:
        if step.name and spelled[step.name.casefold()] > 1:
            yield Mistake(f"{path} / step {step.name}", f"another step of the chart is called {step.name} too")
        place = f"{path} / step {step.name}"
        if names is not None:
            yield from _name(step.name, place, names)
        for name in step.TIMES:
            yield from _time(name, getattr(step, name), place)
        for each in step.actions:
            yield from _time("duration", each.duration, place)


Source = str | os.PathLike[str] | BinaryIO


@runtime_checkable
class _Readable(Protocol):
    def read(self) -> bytes: ...


@runtime_checkable
class _Writable(Protocol):
    def write(self, data: bytes, /) -> int: ...


class OptionsBesideFormat(TypedDict, total=False):
    """Options of `convert`, which takes the format by its position, too; `save` explains them."""

    flavour: str
    tia: str
    strict: bool
    partial: bool
    fresh: bool
    normalize: bool
    limit: float | str
    at_rest: Collection[str]


class SaveOptions(OptionsBesideFormat, total=False):
    """Options of `save`."""

    format: str | None


def load_project(
    source: Source, *, format: str | None = None, progress: Progress | None = None, as_tool: bool = False
) -> Project:
    """Load a project from a path, a binary file, or a folder of documents of TIA Portal Openness or TwinCAT."""
    if isinstance(source, str | os.PathLike):
        path = os.fspath(source)
        refuse_empty(path)
        if folder_exists(path):
            from plcopen_sfc.documents.folder_projects import load_folder  # noqa: PLC0415  # most projects are files

            return load_folder(path, format=format, progress=progress, as_tool=as_tool)
        listing = _format_of_list(path)
        if listing is not None and format in (None, listing.name):
            from plcopen_sfc.documents.folder_projects import load_listed  # noqa: PLC0415

            return load_listed(path, listing, progress=progress, as_tool=as_tool)
        return read_document(read_bytes(path), format=format, path=path, as_tool=as_tool)
    hint = "loads takes bytes." if isinstance(source, bytes | bytearray) else ""
    check_argument(source, _Readable, "load needs a path or a binary file", hint)
    content = source.read()
    check_argument(content, bytes, "load needs a file that is opened as binary", 'Open it with open(path, "rb").')
    name = getattr(source, "name", None)
    return read_document(content, format=format, path=name if isinstance(name, str) else None, as_tool=as_tool)


def _format_of_list(path: str) -> Format | None:
    """Return the format of the project whose files the file at `path` lists, by its extension."""
    extension = Path(path).suffix.casefold()
    return next((kind for kind in all_formats() if kind.list_extension and kind.list_extension == extension), None)


def _seconds(limit: float | str, project: Project) -> float:
    """Return a limit in seconds; ``auto`` are those that suffice for the charts of a project, as their sizes tell."""
    if not isinstance(limit, str):
        return limit
    if limit.strip() == "0":
        return 0
    from plcopen_sfc.analysis.search_limits import seconds  # noqa: PLC0415  # brings the interpreter
    from plcopen_sfc.conversion.running import usual_limit  # noqa: PLC0415  # brings the interpreter

    return usual_limit(project) if limit.strip().casefold() == "auto" else seconds(limit) or 0


@collecting_rarely()
@sharing_trees()
@without_edits()
def save_project(
    project: Project,
    target: Source,
    *,
    format: str | None = None,
    flavour: str = "",
    tia: str = "",
    strict: bool = False,
    partial: bool = False,
    fresh: bool = False,
    normalize: bool = False,
    limit: float | str = 0,
    at_rest: Collection[str] = (),
) -> ConversionReport:
    """Save a project to a path, a folder or a binary file; return what became of each item."""
    path = os.fspath(target) if isinstance(target, str | os.PathLike) else None
    if path is not None:
        refuse_empty(path)
    elif not isinstance(target, _Writable):
        check_argument(target, _Writable, "save needs a path or a binary file")
    name = format_to_write(project, format, tia, path)
    seconds = _seconds(limit, project)
    if at_rest:
        from plcopen_sfc.semantics.charts.graph.graph_parameters import operating_inputs  # noqa: PLC0415  # interpreter

        at_rest = operating_inputs(at_rest)
    kind, declared, of_grafcet = format_named(name)[0], ConversionReport(), False
    if project.source is None or project.source.format != kind.name:
        from plcopen_sfc.conversion.adaptation.grafcet_variables import (  # noqa: PLC0415  # for conversions only
            with_declarable_variables,
        )
        from plcopen_sfc.documents.writer_preparation import is_put_into_sfc  # noqa: PLC0415  # loading needs none

        of_grafcet = is_put_into_sfc(project, kind)
        if of_grafcet:
            project, declared = with_declarable_variables(project, kind)
    refuse_mistakes(project, kind, of_grafcet=of_grafcet)
    if path is not None and _format_of_list(path) is kind and path_exists(path):
        path = str(Path(path).parent)  # the documents that it lists are beside it
    if path is not None and is_folder(path, project, name):
        from plcopen_sfc.documents.folder_projects import save_folder  # noqa: PLC0415  # most projects are files

        report = save_folder(
            project,
            path,
            name,
            flavour=flavour,
            strict=strict,
            partial=partial,
            fresh=fresh,
            normalize=normalize,
            limit=seconds,
            at_rest=at_rest,
        )
        report.items += declared.items
        return report
    data, report = encode(project, name, flavour=flavour, fresh=fresh, limit=seconds, at_rest=at_rest)
    report.items += declared.items
    if normalize:
        before, data = data, normalized(data, name)
        report.unchanged = report.unchanged and data == before
    refuse_losses(report, strict=strict, partial=partial)
    if isinstance(target, str | os.PathLike):
        _write_where_it_was(project, os.fspath(target), data)
        report.written.append(os.fspath(target))
    else:
        target.write(data)
    return report


def _write_where_it_was(project: Project, path: str, data: bytes) -> None:
    """Write a file; refuse to overwrite the one that the project was read from if it was changed since."""
    source = project.source if isinstance(project.source, FileSource) else None
    if source is None or source.path is None or os.path.realpath(source.path) != os.path.realpath(path):
        write_atomic(path, data)
        return
    if file_exists(path) and read_bytes(path) not in (source.content, source.saved):
        raise FileAccessError(
            "the file was changed since the project was read",
            location=Location(path),
            hint="Nothing was written. Load the file again and repeat the edit, or save to another path.",
        )
    write_atomic(path, data)
    source.saved = data


def format_to_write(project: Project, format: str | None, tia: str = "", path: str | None = None) -> str:
    """Return the name of the format to write: the one asked for, else that of the source or of the extension of `path`.

    An extension that the format of the source does not have decides, unless no format has it.
    """
    if tia:
        return for_tia(format or TIA_FORMAT, tia)
    if format:
        return format
    named = _formats_by_extension(path)
    own = project.source.format if project.source is not None else None
    if own is not None and (not named or own in named):
        return own
    if named:
        return format_of_extension(path or "")
    raise UnknownFormatError(
        "the format to save in is not known: the project was not loaded from a file",
        location=Location(path),
        hint='Name one, such as format="plcopen", or save to a file with the extension of a format (.scl, .json).',
    )


def _formats_by_extension(path: str | None) -> list[str]:
    extension = Path(path).suffix.lower() if path is not None else ""
    return [kind.name for kind in all_formats() if extension in kind.extensions]


def format_of_extension(path: str) -> str:
    """Return the one format whose files have the extension of `path`; `UnknownFormatError` where that is not one."""
    named = _formats_by_extension(path)
    if len(named) == 1:
        return named[0]
    what, hint = f"the extension {Path(path).suffix or '(none)'} is of no format", "`plcopen-sfc formats` lists them"
    if named:
        what = f"files with the extension {Path(path).suffix} are of several formats: {', '.join(named)}"
        hint = f'Name one of them: format="{named[0]}", --to {named[0]}'
    raise UnknownFormatError(what, location=Location(path), hint=f"{hint}.")


def is_folder(path: str, project: Project, name: str) -> bool:
    """Return True if `path` is a folder, or is meant to become one, for `project` in the format `name`."""
    if path_exists(path):
        return folder_exists(path)
    if path.endswith(("/", os.sep)):
        return True
    folders = isinstance(project.source, FolderSource) and format_named(name)[0].folders
    return folders and not Path(path).suffix
