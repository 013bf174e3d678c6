"""What was written, read again: it is the project that was meant, or the report tells the difference."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, nullcontext

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import EncodingError, Location, ModelError, StructureError, UnsafeXmlError, XmlSyntaxError
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.model.base import ExtensionData, Model
from plcopen_sfc.model.compare import differences, in_order_of
from plcopen_sfc.model.numbering import number_in_order, numbered_in_order
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import FIELD, ConversionReport, Outcome


@contextmanager
def writing(kind: Format) -> Iterator[None]:
    """Raise `ModelError` where what is written cannot be read again.

    Writers replace or refuse what their format does not have: the error is the last net under them.
    """
    try:
        yield
    except (StructureError, EncodingError, XmlSyntaxError, UnsafeXmlError) as error:
        place = Location(None, error.location.line, error.location.column, error.location.path)
        message = f"this project cannot be written as {kind.name}: the file could not be read again: {error.message}"
        hint = "Nothing was written. The line is that in the new file. Change what is there, or choose another format."
        raise ModelError(message, location=place, hint=hint) from error


def read_back(data: bytes, kind: Format, version: str) -> Project:
    """Return the project in the bytes that are to be written in a version, with all that is in it read."""
    with writing(kind):
        project = kind.codec(version).read(data).project
        project.read_all()
    return project


def report_reading_errors(project: Project, report: ConversionReport) -> None:
    """Report the errors that reading the source found: what was not understood may be missing in what is written."""
    report_diagnostics(report, (found for found in project.diagnostics if found.severity is Severity.ERROR))


def report_diagnostics(report: ConversionReport, errors: Iterable[Diagnostic]) -> None:
    """Report errors of a reader as places where the result does something else."""
    for found in errors:
        report.add(Outcome.APPROXIMATED, "error", found.location.path or "", f"{found.code}: {found.message}")


def verify(project: Project, kind: Format, back: Project, report: ConversionReport) -> None:
    """Compare what was written with what is read `back`: what does not come back is lost, whatever was reported.

    What the written file has besides, such as an id that the format asks for, is `translated`.
    Networks are compared by their meaning where the format draws them in its own way. Where the format has no ids,
    `back` is numbered in order.
    """
    from plcopen_sfc.languages.networks.network_equality import same_drawings  # noqa: PLC0415  # brings the parser

    with nullcontext() if kind.positions else same_drawings(project, back):
        _report_differences(project, kind, back, report)


def _report_differences(project: Project, kind: Format, back: Project, report: ConversionReport) -> None:
    if not kind.ids:
        project = numbered_in_order(project)
        number_in_order(back)
    if kind.used_first:
        project = in_order_of(project, back)
    for difference in differences(project, back, ignore=frozenset({"drawing"})):
        if difference.left is None:
            why = f"the written file has {_short(difference.right)}, and the source nothing"
            report.add(Outcome.TRANSLATED, FIELD, difference.path, why)
            continue
        why = f"{_short(difference.left)} comes back as {_short(difference.right)}"
        report.add(Outcome.DROPPED, FIELD, difference.path, why)


def _short(value: object) -> str:
    text = _shown(value)
    return text if len(text) <= _SHOWN else text[:_SHOWN] + ".."


def _shown(value: object) -> str:
    """Return a value of the model in words: the names and texts in it."""
    match value:
        case None:
            return "nothing"
        case ExtensionData():
            return "extension data"
        case Model():
            inner = [each for name in type(value).model_fields if (each := getattr(value, name)) not in (None, [], {})]
            return " ".join(_shown(each) for each in inner if isinstance(each, str | Model | list)) or "something"
        case list() | tuple():
            return ", ".join(map(_shown, value)) or "nothing"
        case _:
            return repr(value) if type(value) is str else str(value)


_SHOWN = 60
