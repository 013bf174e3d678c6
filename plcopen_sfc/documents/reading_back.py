"""Reading back of a written file: it has the project that was meant, or the report lists the difference.

Networks are equal however they are drawn: some formats keep positions and some do not, and an operand is an element or
belongs to the pin that it is wired to.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import EncodingError, Location, ModelError, StructureError, UnsafeXmlError, XmlSyntaxError
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.provenance import compared_only
from plcopen_sfc.languages.networks.network_reading import network_statements
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.base import ExtensionData, Model
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.compare import differences, in_order_of
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import models_in
from plcopen_sfc.model.network import LogicNetwork, Node
from plcopen_sfc.model.numbering import number_in_order, numbered_in_order
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.text import MarkupText, MultilingualText, plain
from plcopen_sfc.report import FIELD, ConversionReport, Outcome
from plcopen_sfc.whole_numbers import counted


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
    with writing(kind), compared_only():
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
    with nullcontext() if kind.positions else same_drawings(project, back):
        _report_differences(project, kind, back, report)


def keep_step_names(seen: Project, back: Project, report: ConversionReport) -> None:
    """Give steps in what a tool sees of a text the names of the source, which the text has in pragmas (`back`).

    Texts spell ``1 Fill`` as ``_1_Fill``. A step that other texts name keeps the name that the tool sees: these texts
    mean no step there, unless they quote names, as those of S7 do.
    """
    from plcopen_sfc.languages.binding import names_in  # noqa: PLC0415  # brings the parser

    for chart, named in zip(seen.charts(), back.charts(), strict=False):
        steps = list(zip(chart.chart.steps, named.chart.steps, strict=False))
        other = [(step, own) for step, own in steps if step.name.casefold() != own.name.casefold()]
        if not other or len(chart.chart.steps) != len(named.chart.steps):
            continue
        used = set() if seen.dialect is Dialect.SCL else names_in(chart.pou, seen.dialect)
        for step, own in other:
            if own.name.casefold() not in used:
                place = f"{named.report_path} / step {own.name}"
                report.add(Outcome.TRANSLATED, "name", place, f"the text spells it {step.name}")
                step.name = own.name


def _report_differences(project: Project, kind: Format, back: Project, report: ConversionReport) -> None:
    if not kind.ids:
        project = numbered_in_order(project)
        number_in_order(back)
    if kind.used_first:
        project = in_order_of(project, back)
    _order_ends(project, back)
    drawn: dict[str, int] = {}
    for difference in differences(project, back, ignore=frozenset({"drawing"})):
        if inside := _NETWORK.match(difference.path):  # ids of elements, and what has a place in one drawing only
            drawn[inside[1]] = drawn.get(inside[1], 0) + 1
            continue
        if difference.left in (None, []):
            why = f"the written file has {_short(difference.right)}, and the source nothing"
            report.add(Outcome.TRANSLATED, FIELD, difference.path, why)
            continue
        left, right = _short(difference.left), _short(difference.right)
        why = f"{left} comes back as {right if right != left else 'plain text'}"  # without its languages or its markup
        if right == _NOTHING:
            why = f"{left} is not in the written file"
        report.add(Outcome.DROPPED, FIELD, difference.path, why)
    for path, count in drawn.items():
        report.add(Outcome.DROPPED, FIELD, path, f"it is drawn otherwise: {counted(count, 'difference')}")


_NETWORK = re.compile(r"(.* / network \d+) / ")
"""A path in a network. What it means is compared as what is executed."""


def _order_ends(project: Project, back: Project) -> None:
    """Give transitions of `back` their steps in the order of the source: it has no meaning, a drawing may have another.

    As differences, they would be ids, which people take for names of steps.
    """
    for one, other in zip(project.charts(), back.charts(), strict=False):
        known = {transition.id: transition for transition in one.chart.transitions}
        for transition in other.chart.transitions:
            same = known.get(transition.id, transition)
            if sorted(same.sources) == sorted(transition.sources):
                transition.sources = [*same.sources]
            if sorted(same.targets) == sorted(transition.targets):
                transition.targets = [*same.targets]


def _short(value: object) -> str:
    text = _shown(value)
    return text if len(text) <= _SHOWN else text[:_SHOWN] + ".."


def _shown(value: object) -> str:
    """Return a value of the model in words: the names and texts in it."""
    match value:
        case None:
            return _NOTHING
        case ExtensionData():
            return "extension data"
        case MarkupText() | MultilingualText():
            return repr(plain(value))
        case Model():
            inner = [each for name in type(value).model_fields if (each := getattr(value, name)) not in (None, [], {})]
            told = [
                each for each in inner if isinstance(each, str | Model | list) and not isinstance(each, ExtensionData)
            ]
            return " ".join(map(_shown, told)) or "something"
        case list() | tuple():
            return ", ".join(map(_shown, value)) or _NOTHING
        case _:
            return repr(value) if type(value) is str else str(value)


_SHOWN = 60
_NOTHING = "nothing"


_ANNOTATIONS = ("extension_data", "global_id", "comment")
"""Fields of elements that nothing executes."""


@contextmanager
def same_drawings(project: Project, other: Project) -> Iterator[None]:
    """Let networks in `other` have the drawings of those in `project` that mean the same, as long as this is open."""
    replaced: list[tuple[LogicNetwork, list[Node]]] = []
    pairs = zip(project.bodies(), other.bodies(), strict=False)  # a body may be missing in one: its drawing stays
    for body, found in ((body, found) for (name, _, body), (other_name, _, found) in pairs if name == other_name):
        if not isinstance(body, FbdBody | LdBody) or not isinstance(found, FbdBody | LdBody):
            continue
        if body.language == found.language and len(body.networks) == len(found.networks):
            for one, network in zip(body.networks, found.networks, strict=True):
                if one.nodes != network.nodes and mean_the_same(one, network, project.dialect):
                    replaced.append((network, network.nodes))
                    network.nodes = one.nodes
    try:
        yield
    finally:
        for network, nodes in replaced:
            network.nodes = nodes


def mean_the_same(one: LogicNetwork, other: LogicNetwork, dialect: Dialect) -> bool:
    """True if two networks have the same statements and texts; False also where one cannot be read completely."""
    mine, theirs = (_comparable(network, dialect) for network in (one, other))
    return mine is not None and mine == theirs


def _comparable(network: LogicNetwork, dialect: Dialect) -> Any:
    """Return the content of a network that is compared; None where it cannot be read completely."""
    found = network_statements([network], dialect)
    if not found.complete or found.open_ends:
        return None
    texts = sorted(text for _, text in found.comments)
    values = (each.__dict__.get(name) for each in models_in(network.nodes) for name in _ANNOTATIONS)
    annotations = sorted(repr(value) for value in values if value is not None)
    return print_node(found.tree), found.helpers, dict(found.instances), texts, annotations
