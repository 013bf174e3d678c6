"""One file as bytes: reading it into a project that keeps its source, and writing it with just the edits in it."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import LossError, UnknownFormatError
from plcopen_sfc.formats.base import DrawingNeed, Format, Reading, TextCodec, WriteOptions
from plcopen_sfc.formats.registry import format_named, recognise
from plcopen_sfc.model.base import FINGERPRINT
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.numbering import numbered_in_order
from plcopen_sfc.model.project import FolderOrigin, Origin, Project
from plcopen_sfc.report import ConversionReport, Fate


def read_document(data: bytes, *, format: str | None, path: str | None, as_tool: bool = False) -> Project:
    """The project in the bytes of one file. `path` is what messages call them. Raises `FormatError`.

    `as_tool`: as the tool of the format sees it. See `as_tool_sees`.
    """
    kind = format_named(format)[0] if format is not None else recognise(data, file=path)
    if as_tool:
        data = as_tool_sees(data, kind, path)
    with collector_paused():
        reading: Reading = kind.codec().read(data, file=path)
        project = reading.project
        for name, body in project.bodies_read():
            if isinstance(body, SfcBody):
                body.settle(name, data)
        digest = fingerprint(project)
    project._origin = Origin(kind.name, reading.version, data, digest, path, reading.diagnostics)
    return project


def as_tool_sees(data: bytes, kind: Format, path: str | None = None) -> bytes:
    """A file of the format `kind` without what writers of this package carry in it, which no other tool reads.

    Data of vendors stays, as their tools read it. What else is there stays in its line.
    """
    seen = getattr(kind.codec(), "as_tool_sees", None)
    return data if seen is None else seen(data, file=path)


def fingerprint(project: Project) -> bytes:
    """A digest of everything in the model, to tell whether it was edited since it was read."""
    with collector_paused():
        content = project.__pydantic_serializer__.to_json(project, exclude_none=True, context=FINGERPRINT)
        return hashlib.blake2b(content).digest()


def encode(project: Project, name: str, *, flavour: str, fresh: bool) -> tuple[bytes, ConversionReport]:
    """The bytes of `project` in the format `name` (``simaticml-V16``), and what became of each item."""
    kind, version = format_named(name)
    if flavour and flavour not in kind.flavours:
        known = ", ".join(kind.flavours) or "none"
        raise UnknownFormatError(f"format {kind.name} has no flavour {flavour!r}", hint=f"Flavours are: {known}")
    report = ConversionReport(project._origin.format if project._origin is not None else "", name)
    origin = project._origin if isinstance(project._origin, Origin) else None
    if origin is not None and origin.format == kind.name and version in ("", origin.version) and not flavour:
        version = origin.version
        if not fresh and fingerprint(project) == origin.fingerprint:
            report.unchanged = True
            return origin.content, report
        if not fresh and kind.xml:
            return _patched(project, origin, kind, report), report
        if not fresh and kind.text:
            return _patched_text(project, origin, kind, report), report
    note_unreadable(project, report)
    same = origin is not None and origin.format == kind.name and origin.version == version and not flavour
    options = WriteOptions(version, flavour, same=same, source=origin.content if origin is not None and same else b"")
    copy = prepared(project, kind, options, report)
    data: bytes = kind.codec().write(copy, options, report)
    verify(copy, kind, kind.codec().read(data).project, report)
    called = _names_in_the_source(project, copy)
    if origin is not None and format_named(origin.format)[0].xml:
        report.locate(format_named(origin.format)[0].codec().lines(origin.content, project), called=called)
    locate_in_folder(project, report, called)
    return data, report


def _names_in_the_source(project: Project, copy: Project) -> dict[str, str]:
    """The paths in the source of what has another name in the `copy` that was written."""
    called = {new.report_path: old.report_path for old, new in zip(project.pous, copy.pous, strict=True)}
    for old, new in zip(project.charts(), copy.charts(), strict=True):
        for step, renamed in zip(old.network.steps, new.network.steps, strict=False):  # a writer may add steps
            called[f"{new.report_path} / step {renamed.name}"] = f"{old.report_path} / step {step.name}"
        for transition, renamed_ in zip(old.network.transitions, new.network.transitions, strict=False):
            path = f"{new.report_path} / transition {new.network.label(renamed_)}"
            called[path] = f"{old.report_path} / transition {old.network.label(transition)}"
    return {path: old for path, old in called.items() if path != old}


def locate_in_folder(project: Project, report: ConversionReport, called: Mapping[str, str]) -> None:
    """Fill in document and line of the items of `report` that are not simply kept, where the source was a folder.

    `called`: paths in the source of what has another one in the report.
    """
    origin = project._origin
    if not isinstance(origin, FolderOrigin):
        return
    told = {item.path.partition(" / ")[0] for item in report.items if item.fate is not Fate.KEPT}
    told |= {called[path] for path in told & called.keys()}
    told_in: dict[str, set[str]] = {}
    for thing in project.objects():
        if thing._home is not None and thing.report_path in told:
            told_in.setdefault(thing._home[0], set()).add(thing.report_path)
    codec = format_named(origin.format)[0].codec()
    for path, names in told_in.items():
        if path in origin.documents:
            source = origin.documents[path].origin
            lines = codec.lines(source.content, project)
            here = {place: line for place, line in lines.items() if place.partition(" / ")[0] in names}
            report.locate(here, source.path, called=called)


def normalized(data: bytes, name: str) -> bytes:
    """A file in the format `name` without what its tool ignores. Raises `UnknownFormatError`: there is nothing."""
    kind = format_named(name)[0]
    normalize = getattr(kind.codec(), "normalize", None)
    if normalize is None:
        raise UnknownFormatError(f"there is nothing to normalise in files of the format {kind.name}")
    result: bytes = normalize(data)
    return result


def note_unreadable(project: Project, report: ConversionReport) -> None:
    """Documents of a folder that could not be read are missing wherever else the project is written."""
    origin = project._origin
    for path, error in origin.unreadable.items() if isinstance(origin, FolderOrigin) else ():
        report.add(Fate.DROPPED, "file", path, f"it could not be read: {error.message}")


def refuse_losses(report: ConversionReport) -> None:
    """Raise `LossError` where something would be dropped or approximated."""
    if not report.losses:
        return
    first = "; ".join(f"{item.what} {item.path}: {item.why}" for item in report.losses[:3])
    message = f"{len(report.losses)} items would be lost or changed: {first}"
    raise LossError(message, report, hint="Nothing was written.")


def verify(project: Project, kind: Format, back: Project, report: ConversionReport) -> None:
    """Compare what was written with what is read `back`: what does not come back is lost, whatever the writer says.

    Networks are compared by what they say where the format draws them in its own way. `back` is changed by that.
    """
    if not kind.positions:
        from plcopen_sfc.languages.networks.alike import take_over_drawings  # noqa: PLC0415  # brings the parser

        take_over_drawings(project, back)
    if not kind.ids:
        project, back = numbered_in_order(project), numbered_in_order(back)
    for difference in differences(project, back, ignore=frozenset({"drawing"})):
        why = f"{_short(difference.left)} comes back as {_short(difference.right)}"
        report.add(Fate.DROPPED, "field", difference.path, why)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else text[:_SHOWN] + ".."


_SHOWN = 60


def prepared(project: Project, kind: Format, options: WriteOptions, report: ConversionReport) -> Project:
    """A copy of `project` with its texts in the dialect and with the drawings that the writer needs."""
    same_dialect = kind.dialect in (None, project.dialect)
    if kind.drawing is DrawingNeed.NONE and same_dialect:
        return project
    from plcopen_sfc.drawing import DrawingStyle, prepare  # noqa: PLC0415  # not needed to load and look

    copy = project.model_copy(deep=True)
    if kind.dialect is not None:
        _put_into_dialect(copy, kind.dialect, report)
    if kind.drawing is DrawingNeed.NONE:
        return copy
    style = DrawingStyle.STRUCTURED if kind.drawing is DrawingNeed.STRUCTURED else DrawingStyle.PLAIN
    if style.structured and (project._origin is None or project._origin.format != kind.name):
        _note_limits(copy, report)
    # a format without ids has branches of its own instead of the bars of others
    other = project._origin is None or project._origin.format != kind.name
    anew = bool(options.flavour) or (not kind.ids and other)
    prepare(copy, style, positions=kind.positions, anew=anew, foreign=True)
    adapt = getattr(kind.codec(), "adapt", None)
    if adapt is not None:
        adapt(copy, options, report)
    return copy


def _put_into_dialect(project: Project, dialect: Dialect, report: ConversionReport) -> None:
    """Translate the program text between SCL and the others.

    IEC 61131-3 and CODESYS are left as they stand: their tools read most of each other's text, and files of one often
    hold what is of the other.
    """
    if Dialect.SCL not in (project.dialect, dialect) or dialect is project.dialect:
        project.dialect = dialect
        return
    from plcopen_sfc.refactor.dialect import translate_project  # noqa: PLC0415  # rarely needed

    source = project.dialect
    for text in translate_project(project, dialect):
        for note in text.notes:
            fate = Fate.TRANSLATED if note.severity is Severity.INFO else Fate.APPROXIMATED
            report.add(fate, "text", text.path, f"line {note.line}: {note.reason}")
        if text.changed and not text.notes:
            report.add(Fate.TRANSLATED, "text", text.path, f"from {source} into {dialect}")


def _note_limits(project: Project, report: ConversionReport) -> None:
    """Say which charts tools that know nested branches only may not take."""
    from plcopen_sfc.drawing import limits  # noqa: PLC0415

    for chart in project.charts():
        names = {step.id: f"step {step.name}" for step in chart.network.steps}
        names |= {id_: f"transition {label}" for id_, label in chart.network.labels().items()}
        for problem in limits(chart.network):
            path = f"{chart.report_path} / {names.get(problem.symbol, problem.symbol)}"
            report.add(Fate.APPROXIMATED, "chart", path, f"{problem.code}: {problem.detail}")


def _patched(project: Project, origin: Origin, kind: Format, report: ConversionReport) -> bytes:
    """The file that was read with the edits in it. Charts that nobody touched are neither drawn nor written."""
    from plcopen_sfc.drawing import DrawingStyle, prepare, prepare_body  # noqa: PLC0415
    from plcopen_sfc.formats.xml.patch import patch  # noqa: PLC0415
    from plcopen_sfc.formats.xml.writing import canonical  # noqa: PLC0415

    style = DrawingStyle.STRUCTURED if kind.drawing is DrawingNeed.STRUCTURED else DrawingStyle.PLAIN
    touched, untouched = set(), set()
    for name, _, body in project.bodies():
        if isinstance(body, SfcBody) and body.is_as_in(origin.content, name):
            untouched.add(name)
        else:
            touched.add(name)
            prepare_body(body, style, positions=False)
    codec = kind.codec()
    before: Project = codec.read(origin.content).project
    options = WriteOptions(origin.version, same=True, source=origin.content, untouched=frozenset(untouched - touched))
    after = codec.to_tree(project, replace(options, baseline=before), report)
    data = patch(origin.content, codec.to_tree(before, options, ConversionReport()), after)
    back = codec.to_tree(codec.read(data).project, options, ConversionReport())
    # comments carry ids in TC6 1.01, which may be others now
    if canonical(back) != canonical(after):
        # rather a large diff than a lost edit
        report.add(Fate.APPROXIMATED, "file", origin.path or "", "the edits did not fit into its text; written anew")
        options = WriteOptions(origin.version, same=True, baseline=before)
        prepare(project, style, positions=kind.positions)
        data = codec.write(project, options, report)
    return data


def _patched_text(project: Project, origin: Origin, kind: Format, report: ConversionReport) -> bytes:
    """The text that was read with the edits in it."""
    from plcopen_sfc.formats.text import patch  # noqa: PLC0415  # only to save edits

    codec: TextCodec = kind.codec()
    before = codec.read(origin.content).project
    options = WriteOptions(origin.version, same=True, baseline=before)
    source, slices = codec.slices(origin.content)
    after = codec.to_pieces(project, options, report)
    data, recoded = source.encode(patch(source, slices, codec.to_pieces(before, options, ConversionReport()), after))
    if recoded:
        why = f"{source.encoding} does not have all of its characters; the file is in UTF-8 now"
        report.add(Fate.TRANSLATED, "encoding", origin.path or "", why)
    if next(differences(project, codec.read(data).project), None) is not None:
        # rather a large diff than a lost edit
        report.add(Fate.APPROXIMATED, "file", origin.path or "", "the edits did not fit into its text; written anew")
        data = codec.write(project, options, ConversionReport())
        verify(project, kind, codec.read(data).project, report)
    return data
