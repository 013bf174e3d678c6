"""Loading and saving: the functions that scripts call."""

from __future__ import annotations

import io
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.documents.file_documents import read_document
from plcopen_sfc.documents.sources import FileSource, FolderSource
from plcopen_sfc.documents.storage import OptionsBesideFormat, SaveOptions, Source, load_project, save_project
from plcopen_sfc.errors import (
    Location,
    UnknownFormatError,
    check_argument,
    nearest,
    refuse_unknown_options,
    told_when_exhausted,
)
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import ConversionReport, Converted, Item, Outcome

if TYPE_CHECKING:
    from plcopen_sfc.documents.folder_projects import Progress
    from plcopen_sfc.lowering.chart_lowering import LoweredPou


def load(
    source: Source, *, format: str | None = None, progress: Progress | None = None, as_tool: bool = False
) -> Project:
    """Load a project from a path, a binary file, or a folder of documents of TIA Portal Openness.

    The format is recognised from the content; `format` insists on one. Charts that are wrong are loaded too; what is
    wrong with them is in `Project.diagnostics`. With `as_tool` the file is read as the tool of its format sees it: what
    this package carries in files of a format that has no place for it (comments, pragmas and foreign data of its own)
    is ignored, and is gone where the project is saved. Raises `FileAccessError` or `FormatError`.
    """
    with told_when_exhausted(str(source) if isinstance(source, str | Path) else None):
        return load_project(source, format=format, progress=progress, as_tool=as_tool)


def loads(data: bytes, *, format: str | None = None, path: str | None = None, as_tool: bool = False) -> Project:
    """Load a project from bytes, as `load` does. `path` is what messages call them."""
    hint = "load takes a path. Text has to be encoded: text.encode()." if isinstance(data, str) else ""
    check_argument(data, (bytes, bytearray, memoryview), "loads needs bytes", hint)
    check_argument(path, (str, PathLike, type(None)), "the path of messages is a text")
    data = bytes(data)
    with told_when_exhausted(path):
        return read_document(data, format=format, path=path, as_tool=as_tool)


@told_when_exhausted()
def save(
    project: Project | LoweredPou,
    target: Source,
    **options: Unpack[SaveOptions],
) -> ConversionReport:
    """Save a project to a path or a binary file; return what became of each item.

    `options` are those of `SaveOptions`: `format`, `flavour`, `tia`, `strict`, `partial`, `fresh`, `normalize`, `limit`
    and `at_rest`.

    Saved in the format it was loaded from, the file is what was read with just the edits in it. `format` converts to
    another (see `plcopen-sfc formats`). Without it an extension that the format of the source does not have chooses
    one (``.scl``), or is an error where several formats have it. `flavour` writes for a family of readers
    (``beremiz``), `tia` for a version of TIA Portal (``V16``; the format is ``simaticml`` then), `fresh` writes from
    the model alone. With `normalize` what the tool ignores is left out, such as the time of an export: files can be
    compared then. A path is written to a temporary file and renamed: the old file stays whole whatever happens.

    Given what `lower` returned, the file is read back as its tool reads it and compared with the chart before it is put
    in place; `compared` of the report has the verdict. Code that was not to be verified is saved without that.

    With a `limit` (seconds, ``2m30s``, or ``auto``: a tenth of a second a step, at least five seconds) the charts of a
    conversion are also simulated for both, as `equivalent` does; a difference is an approximated item, and `compared`
    of the report has what was found of each chart.

    `at_rest` names inactive inputs of S7-GRAPH (``INIT_SQ``; ``all``): it is no loss that they have
    no effect in the target.

    Raises `LossError` and writes nothing where the target would not execute something that the source tool executes.
    With `partial` the rest is written, and the report lists what is not executed; with `strict` also what the
    target would execute otherwise is refused.

    Raises `OldVersionError` where the content needs a newer TIA Portal than the one that is written for,
    `DamagedSourceError` where reading the source found errors and it is written in another format (see
    `Project.accept_errors`), `LoweringError` and `UntestedError` where the written code of a chart is not proven.
    """
    refuse_unknown_options("save", options, SaveOptions.__annotations__)
    if not isinstance(project, Project):
        from plcopen_sfc.documents.lowered import save_lowered  # noqa: PLC0415  # brings the interpreter
        from plcopen_sfc.lowering import LoweredPou  # noqa: PLC0415

        hint = "Put it into a project, as `project.pous` and `pou.bodies`." if isinstance(project, Model) else ""
        hint = "Load the file first: load(path)." if isinstance(project, str | PathLike) else hint
        check_argument(project, LoweredPou, "a project, or what lower returned, is needed", hint)
        return save_lowered(project, target, **options)
    return save_project(project, target, **options)


def dumps(project: Project | LoweredPou, **options: Unpack[SaveOptions]) -> bytes:
    """Return the bytes that `save` would write. Takes the same options, and raises the same errors."""
    return convert(project, **options).data


def convert(
    project: Project | LoweredPou, format: str | None = None, **options: Unpack[OptionsBesideFormat]
) -> Converted:
    """Return the bytes that `save` would write, and its report, as `data` and `report`.

    Takes the same options, and raises the same errors.
    """
    content = io.BytesIO()
    report = save(project, content, format=format, **options)
    return Converted(content.getvalue(), report)


_IMPORTERS = {
    "codesys": ("codesys", ""),
    "twincat": ("codesys", ""),
    "codesys23": ("codesys23", ""),
    "beremiz": ("plcopen", "beremiz"),
    "openplc": ("plcopen", "beremiz"),
    "matiec": ("iec-text", "matiec"),
    "tia": ("simaticml", ""),
}
"""The format, and the flavour of it, that a tool imports."""
_DISTURBING = {Outcome.NOT_EXECUTED: Severity.ERROR, Outcome.APPROXIMATED: Severity.WARNING}


def check_import(project: Project, tool: str) -> list[Diagnostic]:
    """Return the parts of a project that a tool would not execute, or is not known to read, before an import.

    `tool` is ``codesys``, ``twincat``, ``codesys23``, ``beremiz``, ``openplc``, ``matiec``, ``tia``, or a version of it
    such as ``tia-V16``. What `convert` would lose is an error (IMP001), what it would approximate a warning (IMP002);
    what it would write in other terms is one note an object (IMP003): the tool reads that from the converted file only.
    A file in another format than that of the tool is an error (IMP004). No tool was asked: the conditions are those
    that are documented, or seen in exports. Raises `UnknownFormatError` for another tool.
    """
    check_argument(project, Project, "check_import needs a project", "Load the file first: load(path).")
    check_argument(tool, str, "check_import needs the name of a tool")
    name, _, version = tool.partition("-")
    if name not in _IMPORTERS:
        near = nearest(name, _IMPORTERS)
        raise UnknownFormatError(f"no tool is called {tool!r}{near}", hint=f"There are: {', '.join(_IMPORTERS)}.")
    format, flavour = _IMPORTERS[name]
    file = project.source.path if project.source is not None else None
    kind = project.source.format if project.source is not None else format
    has_lines = True
    if kind == format:
        imported = loads(dumps(project, format=kind, partial=True), format=kind, as_tool=True)
        if imported != project or project.origin is not None:  # the tool does not read the source that the file keeps
            has_lines = not isinstance(project.source, FolderSource)
            project = imported
    data, report = convert(project, format, flavour=flavour, tia=version, partial=True, fresh=True)
    losses = report.losses
    if kind == format:
        losses += _losses_of_file(project, format_named(format)[0], data)
    found = [
        Diagnostic(
            "IMP001" if item.outcome is Outcome.NOT_EXECUTED else "IMP002",
            _DISTURBING[item.outcome],
            f"{item.what}: {item.why}",
            Location(item.file or file, line=item.line if has_lines else None, path=item.path),
        )
        for item in losses
    ]
    if kind != format and not (kind == "twincat" == name):
        hint = f"plcopen-sfc convert --to {format}{f' --for {flavour}' if flavour else ''} writes one that it reads."
        text = f"the file is {kind}, and {tool} imports {format}"
        found.append(Diagnostic("IMP004", Severity.ERROR, text, Location(file), hint))
    else:
        others: dict[str, list[str]] = {}
        for item in report.with_outcome(Outcome.TRANSLATED):
            others.setdefault(ObjectPath.of(item.path).owner, []).append(item.what)
        for owner, kinds in others.items():
            text = f"convert writes something in other terms here: {', '.join(dict.fromkeys(kinds))}"
            found.append(Diagnostic("IMP003", Severity.INFO, text, Location(file, path=owner)))
    return found


def _losses_of_file(project: Project, own: Format, data: bytes) -> list[Item]:
    """Return what a tool refuses in a file of its own format, which it may not have written itself.

    A conversion mends that, so that its report has none of it. `data` is what the conversion wrote.
    """
    losses: list[Item] = []
    if own.charts is not None and own.charts.is_codesys:
        from plcopen_sfc.documents.writer_preparation import note_limits  # noqa: PLC0415  # to write, and here

        limits = ConversionReport()
        note_limits(project.charts(), own, limits)
        if limits.items:  # loops are in the place of some of these charts in the file
            limits.items.clear()
            note_limits(loads(data, format=own.name, as_tool=True).charts(), own, limits)
        losses += limits.with_outcome(Outcome.NOT_EXECUTED)
    if own.dialect is not None and own.dialect is project.dialect:
        from plcopen_sfc.documents.legal_names import illegal_names  # noqa: PLC0415  # brings the parser

        named = ConversionReport()
        for path, why in illegal_names(project, own):
            named.add(Outcome.NOT_EXECUTED, "name", path, why)
        losses += named.items
    if own.name == "simaticml":
        from plcopen_sfc.refactor.declaration_translation import compute_constants  # noqa: PLC0415  # here alone

        calculated = ConversionReport()
        for place in compute_constants(project.model_copy(deep=True)):
            calculated.add(Outcome.NOT_EXECUTED, place.what, place.path, place.notes[0].reason)
        losses += calculated.items
    return losses


def check_syntax(project: Project | Pou | SfcNetwork) -> list[Diagnostic]:
    """Return the faults of syntax in the bodies, conditions and declarations of a project, a POU or a chart.

    Each finding has the place in its text and, if the project was loaded from a file that it is still in, in the file.
    """
    from plcopen_sfc.languages.syntax_problems import TextFinder, syntax_problems  # noqa: PLC0415  # brings the parser
    from plcopen_sfc.semantics.profile import default_profile  # noqa: PLC0415

    if not isinstance(project, Project):
        from plcopen_sfc.semantics.subjects import resolve  # noqa: PLC0415

        found = resolve(project)
        pou = found.pou.model_copy(deep=True)
        if isinstance(project, SfcNetwork):  # its texts only
            pou = Pou(name=pou.name, kind=pou.kind, bodies=[SfcBody(chart=project.model_copy(deep=True))])
        part = Project(dialect=found.project.dialect, pous=[pou])
        return syntax_problems(part, grafcet=default_profile(found.project).grafcet_terms)
    source = project.source
    if isinstance(source, FolderSource):
        from plcopen_sfc.documents.sources import documents_of  # noqa: PLC0415

        return [finding for document in documents_of(project) for finding in check_syntax(document)]
    grafcet = default_profile(project).grafcet_terms
    if not isinstance(source, FileSource):
        return syntax_problems(project, grafcet=grafcet)
    kind = format_named(source.format)[0]
    finder = TextFinder(_text_of(source.content, kind), xml=kind.xml)
    return syntax_problems(project, grafcet=grafcet, file=source.path, finder=finder)


def _text_of(content: bytes, kind: Format) -> str:
    if kind.xml:
        from plcopen_sfc.formats.xml.xml_parsing import decode_xml  # noqa: PLC0415

        return decode_xml(content)[0]
    from plcopen_sfc.formats.text_encoding import decode_text  # noqa: PLC0415

    return decode_text(content).text
