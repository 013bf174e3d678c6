"""Loading and saving: the functions that scripts call."""

from __future__ import annotations

import hashlib
import os
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import LossError, UnknownFormatError
from plcopen_sfc.files import read_bytes, write_atomic
from plcopen_sfc.formats.base import DrawingNeed, Format, Reading, TextCodec, WriteOptions
from plcopen_sfc.formats.registry import FORMATS, format_named, recognise
from plcopen_sfc.model.base import FINGERPRINT
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.numbering import numbered_in_order
from plcopen_sfc.model.project import Origin, Project
from plcopen_sfc.report import ConversionReport, Fate

Source = str | os.PathLike[str] | BinaryIO


def load(source: Source, *, format: str | None = None) -> Project:  # the word that users look for
    """Load a project from a path or a binary file.

    The format is recognised from the content; `format` insists on one. Charts that are wrong are loaded too; what is
    wrong with them is in `Project.diagnostics`. Raises `FileAccessError` or `FormatError`.
    """
    if isinstance(source, str | os.PathLike):
        path = os.fspath(source)
        return loads(read_bytes(path), format=format, path=path)
    return loads(source.read(), format=format, path=getattr(source, "name", None))


def loads(data: bytes, *, format: str | None = None, path: str | None = None) -> Project:
    """Load a project from bytes. `path` is what messages call them."""
    kind = format_named(format)[0] if format is not None else recognise(data, file=path)
    with collector_paused():
        reading: Reading = kind.codec().read(data, file=path)
        project = reading.project
        for name, body in project.bodies_read():
            if isinstance(body, SfcBody):
                body.settle(name, data)
        digest = fingerprint(project)
    project._origin = Origin(kind.name, reading.version, data, digest, path, reading.diagnostics)
    return project


def save(
    project: Project,
    target: str | os.PathLike[str] | BinaryIO,
    *,
    format: str | None = None,
    flavour: str = "",
    strict: bool = False,
    fresh: bool = False,
) -> ConversionReport:
    """Save a project to a path or a binary file; returns what became of each item.

    Saved in the format it was loaded from, the file is what was read with just the edits in it. `format` converts to
    another (see `plcopen-sfc formats`), `flavour` writes for a family of readers (``beremiz``), `fresh` writes from the
    model alone. With `strict` a conversion that would drop or approximate anything raises `LossError` and writes
    nothing. A path is written to a temporary file and renamed: the old file stays whole whatever happens.
    """
    path = os.fspath(target) if isinstance(target, str | os.PathLike) else None
    name = format or _format_for(project, Path(path) if path is not None else None)
    data, report = _encode(project, name, flavour=flavour, fresh=fresh)
    if strict and report.losses:
        first = "; ".join(f"{item.what} {item.path}: {item.why}" for item in report.losses[:3])
        message = f"{len(report.losses)} items would be lost or changed: {first}"
        raise LossError(message, report, hint="Nothing was written.")
    if isinstance(target, str | os.PathLike):
        write_atomic(target, data)
        report.written.append(os.fspath(target))
    else:
        target.write(data)
    return report


def dumps(project: Project, *, format: str | None = None, flavour: str = "", fresh: bool = False) -> bytes:
    """The bytes that `save` would write."""
    return _encode(project, format or _format_for(project, None), flavour=flavour, fresh=fresh)[0]


def convert(
    project: Project,
    format: str,
    *,
    flavour: str = "",
) -> tuple[bytes, ConversionReport]:
    """The bytes of `project` in another format, and the report."""
    return _encode(project, format, flavour=flavour, fresh=False)


def fingerprint(project: Project) -> bytes:
    """A digest of everything in the model, to tell whether it was edited since it was read."""
    with collector_paused():
        content = project.__pydantic_serializer__.to_json(project, exclude_none=True, context=FINGERPRINT)
        return hashlib.blake2b(content).digest()


def _format_for(project: Project, path: Path | None) -> str:
    if project._origin is not None:
        return project._origin.format
    if path is not None:
        by_extension = [f.name for f in FORMATS if path.suffix.lower() in f.extensions]
        if len(by_extension) == 1:
            return by_extension[0]
    raise UnknownFormatError(
        "say in which format to save: the project was not loaded from a file", hint='For example format="plcopen".'
    )


def _encode(project: Project, name: str, *, flavour: str, fresh: bool) -> tuple[bytes, ConversionReport]:
    kind, version = format_named(name)
    if flavour and flavour not in kind.flavours:
        known = ", ".join(kind.flavours) or "none"
        raise UnknownFormatError(f"format {kind.name} has no flavour {flavour!r}", hint=f"Flavours are: {known}")
    origin = project._origin
    report = ConversionReport(origin.format if origin is not None else "", name)
    if origin is not None and origin.format == kind.name and version in ("", origin.version) and not flavour:
        version = origin.version
        if not fresh and fingerprint(project) == origin.fingerprint:
            report.unchanged = True
            return origin.content, report
        if not fresh and kind.xml:
            return _patched(project, origin, kind, report), report
        if not fresh and kind.text:
            return _patched_text(project, origin, kind, report), report
    same = origin is not None and origin.format == kind.name and origin.version == version and not flavour
    options = WriteOptions(version, flavour, same=same)
    prepared = _prepared(project, kind, options, report)
    data: bytes = kind.codec().write(prepared, options, report)
    _verify(prepared, kind, data, report)
    if origin is not None and format_named(origin.format)[0].xml:
        report.locate(format_named(origin.format)[0].codec().lines(origin.content, project))
    return data, report


def _verify(project: Project, kind: Format, data: bytes, report: ConversionReport) -> None:
    """Read back what was written: what does not come back is lost, whatever the writer thought, and is reported."""
    back: Project = kind.codec().read(data).project
    if not kind.ids:
        project, back = numbered_in_order(project), numbered_in_order(back)
    for difference in differences(project, back, ignore=frozenset({"drawing"})):
        why = f"{_short(difference.left)} comes back as {_short(difference.right)}"
        report.add(Fate.DROPPED, "field", difference.path, why)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else text[:_SHOWN] + ".."


_SHOWN = 60


def _prepared(project: Project, kind: Format, options: WriteOptions, report: ConversionReport) -> Project:
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
    anew = bool(options.flavour) or (not kind.ids and not options.same)
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


def check_syntax(project: Project) -> list[Diagnostic]:
    """What does not parse in the bodies, conditions and declarations of a project.

    Each finding has the place in its text and, if the project was loaded from a file that still says so, in the file.
    """
    from plcopen_sfc.languages.locating import TextFinder  # noqa: PLC0415  # brings the parser with it
    from plcopen_sfc.languages.syntax import syntax_problems  # noqa: PLC0415

    origin = project._origin
    if origin is None:
        return syntax_problems(project)
    kind = format_named(origin.format)[0]
    finder = TextFinder(_text_of(origin.content, kind), xml=kind.xml)
    return syntax_problems(project, file=origin.path, finder=finder)


def _text_of(content: bytes, kind: Format) -> str:
    if kind.xml:
        from plcopen_sfc.formats.xml.source import decode  # noqa: PLC0415

        return decode(content)[0]
    from plcopen_sfc.formats.text import decode as decode_text  # noqa: PLC0415

    return decode_text(content).text


def _note_limits(project: Project, report: ConversionReport) -> None:
    """Say which charts tools that know nested branches only may not take."""
    from plcopen_sfc.drawing import limits  # noqa: PLC0415

    for chart in project.charts():
        names = {step.id: f"step {step.name}" for step in chart.network.steps}
        names |= {t.id: f"transition {chart.network.label(t)}" for t in chart.network.transitions}
        place = (
            f"POU {chart.name}" if chart.name == chart.pou.name else f"POU {chart.name.replace('.', ' / action ', 1)}"
        )
        for problem in limits(chart.network):
            path = f"{place} / {names.get(problem.symbol, problem.symbol)}"
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
    options = WriteOptions(origin.version, same=True, untouched=frozenset(untouched - touched))
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
        _verify(project, kind, data, report)
    return data
