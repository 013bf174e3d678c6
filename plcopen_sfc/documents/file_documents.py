"""One file as bytes: read into a project that keeps its source, and written with just the edits in it."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple, cast

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import DamagedSourceError, Diagnostic, Severity
from plcopen_sfc.documents.sources import FileSource, FolderSource
from plcopen_sfc.errors import (
    EncodingError,
    FormatError,
    Location,
    LossError,
    ModelError,
    StructureError,
    UnknownFormatError,
    UnsafeXmlError,
    XmlSyntaxError,
    nearest,
)
from plcopen_sfc.formats.file_recognition import recognise
from plcopen_sfc.formats.format_interface import DrawingNeed, Format, WriteOptions
from plcopen_sfc.formats.provenance import (
    Origin,
    content_digest,
    file_digest,
    is_edited,
    is_from,
    place_in_folder,
    remember_body,
    remember_object,
    without_edits,
)
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.languages.edits import Edit, apply_edits
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.base import ExtensionData, Model
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.compare import differences, in_order_of
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.numbering import number_in_order, numbered_in_order
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.types import DerivedType, StructType, Variable
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import FIELD, LOSSES, ConversionReport, Item, Outcome

if TYPE_CHECKING:
    from lxml import etree

    from plcopen_sfc.conversion import Part
    from plcopen_sfc.drawing import DrawingStyle
    from plcopen_sfc.formats.format_interface import TextCodec
    from plcopen_sfc.formats.xml.xml_codec import XmlCodec


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
    project.source = FileSource(
        kind.name, reading.version, data, digest, path, reading.diagnostics, origin=reading.origin
    )
    return project


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

    `limit`: for so many seconds the charts are run in both tools. `at_rest` is that of `WriteOptions`.
    """
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
                return (_patched if kind.xml else _patched_text)(project, source, kind, report), report
    same = source is not None and source.format == kind.name and source.version == version and not flavour
    if not same:
        refuse_reading_errors(project, report)
    elif kind.text:  # what was not understood of a text may be in its file only; the model keeps all of XML
        report_reading_errors(project, report)
    content = source.content if source is not None and same else b""
    options = WriteOptions(version, flavour, same=same, source=content, at_rest=at_rest)
    from plcopen_sfc.documents.writer_preparation import prepared  # noqa: PLC0415  # loading needs no interpreter

    with collecting_rarely():
        copy, meant, options, behaviour = prepared(project, kind, options, report)
        with writing(kind):
            data = kind.codec(version).write(copy, options, report)
        if not (options.flavour and kind.text):  # what a flavour leaves out is for people, and not read back
            verify(meant, kind, read_back(data, kind, version), report)
        called = names_in_the_source(project, copy)
    if behaviour is not None:
        seen = read_document(data, format=name, path=None, as_tool=True)
        report_behaviour(report, project, behaviour, seen, called, tool=kind.tool, flavour=flavour, limit=limit)
    elif limit:
        _report_without_tool(report, project, data, kind, called, limit=limit)
    if source is not None and format_named(source.format)[0].xml:
        report.locate(format_named(source.format)[0].codec().lines(source.content, project), called=called)
    locate_in_folder(project, report, called)
    return data, report


def _report_without_tool(
    report: ConversionReport, project: Project, data: bytes, kind: Format, called: Mapping[str, str], *, limit: float
) -> None:
    """Run the charts of a format that is no tool's: GRAFCETs by the rules of IEC 60848. Nothing executes step lists."""
    from plcopen_sfc.conversion.reporting import report_running  # noqa: PLC0415  # brings the interpreter
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
    from plcopen_sfc.conversion import compare, executed, report_errors, report_execution  # noqa: PLC0415
    from plcopen_sfc.semantics.profile import PROFILES  # noqa: PLC0415

    target = PROFILES[flavour] if flavour else None
    own = family(project.dialect)
    found = compare(
        behaviour,
        executed(seen, target, compared_with=behaviour),
        other_tool=bool(flavour) or own is not family(seen.dialect),
        has_libraries=own is not Dialect.IEC,
    )
    report_execution(report, found, flavour or tool, called)
    known = {each.code for each in project.diagnostics}
    errors = [each for each in seen.diagnostics if each.severity is Severity.ERROR and each.code not in known]
    report_errors(report, errors, flavour or tool, called)
    if limit:
        from plcopen_sfc.conversion.reporting import report_running  # noqa: PLC0415  # brings the interpreter

        report_running(report, project, seen, called, tool=flavour or tool, target=target, limit=limit)


def names_in_the_source(project: Project, copy: Project) -> dict[str, str]:
    """Return the paths in the source of what has another name in the `copy` that was written."""
    called = {new.report_path: old.report_path for old, new in zip(project.pous, copy.pous, strict=True)}
    pairs = [
        (old, new)
        for a, b in zip(project.pous, copy.pous, strict=True)
        for old, new in zip(_charts_of(a), _charts_of(b), strict=False)  # a writer may have none in actions
    ]
    for old, new in pairs:
        steps = {step.id: step for step in old.chart.steps}
        labels, earlier = new.chart.labels(), old.chart.labels()
        for step in new.chart.steps:  # a writer may add steps
            if step.id in steps:
                called[f"{new.report_path} / step {step.name}"] = f"{old.report_path} / step {steps[step.id].name}"
        for transition in new.chart.transitions:
            if transition.id in earlier:
                path = f"{new.report_path} / transition {labels[transition.id]}"
                called[path] = f"{old.report_path} / transition {earlier[transition.id]}"
    called |= _renamed_variables(project, copy)
    return {path: old for path, old in called.items() if path != old}


def _renamed_variables(project: Project, copy: Project) -> dict[str, str]:
    """Return the paths in the source of variables whose names the dialect of the other side does not take.

    Those of members of structures are as in programs: ``POU Main / motor.is_on``, ``global variable Data.is_on``.
    """
    from plcopen_sfc.languages.translation.renames import NameScope, kept_names  # noqa: PLC0415  # brings the parser

    from_s7, to_s7 = kept_names(copy), kept_names(project)
    if not (len(from_s7) or len(to_s7)):
        return {}

    def old_name(scope: NameScope, name: str) -> str:
        return from_s7.old_name(scope, name) or to_s7.new_name(scope, name) or name

    def paths(variables: Iterable[Variable], scope: NameScope, depth: int = 0) -> Iterator[tuple[str, str]]:
        for variable in variables:
            before = old_name(scope, variable.name)
            yield variable.name, before
            kind = types.get(variable.type.name.casefold()) if isinstance(variable.type, DerivedType) else variable.type
            members = kind.members if isinstance(kind, StructType) and depth < _DEEPEST else ()
            for inner, old in paths(members, NameScope.MEMBER, depth + 1):
                yield f"{variable.name}.{inner}", f"{before}.{old}"

    types = {each.name.casefold(): each.type for each in copy.data_types}
    found = {}
    for old_pou, pou in zip(project.pous, copy.pous, strict=True):
        known = {variable.name.casefold(): variable.name for variable in old_pou.variables()}
        for name, before in paths(pou.variables(), NameScope.LOCAL):
            first, dot, rest = before.partition(".")
            if first.casefold() in known:
                found[f"{pou.report_path} / {name}"] = f"{old_pou.report_path} / {known[first.casefold()]}{dot}{rest}"
    lists = {block.name for block in project.data_blocks} | {each.name or "" for each in project.global_sections()}
    declared = [(section.name or "", section.variables) for section in copy.global_sections()]
    declared += [(b.name, b.interface.variables()) for b in copy.data_blocks if b.interface and b.type_name is None]
    for name, variables in declared:
        own = old_name(NameScope.GLOBAL, name)
        is_listed = own in lists  # tags are in no list
        for inner, before in paths(variables, NameScope.MEMBER if is_listed else NameScope.GLOBAL):
            old = f"global variable {own}.{before}" if is_listed else f"global variable {before}"
            found |= {f"global variable {name}.{inner}": old} | ({} if is_listed else {f"global variable {inner}": old})
    return found


_DEEPEST = 8
"""Structures in structures that are looked into: a damaged type may contain itself."""


def _charts_of(pou: Pou) -> list[Chart]:
    return [Chart(name, pou, body.chart) for name, _, body in pou.named_bodies() if isinstance(body, SfcBody)]


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
    _report_errors(report, (found for found in errors if found not in own))


def report_reading_errors(project: Project, report: ConversionReport) -> None:
    """Report the errors that reading the source found: what was not understood may be missing in what is written."""
    _report_errors(report, (found for found in project.diagnostics if found.severity is Severity.ERROR))


def _report_errors(report: ConversionReport, errors: Iterable[Diagnostic]) -> None:
    for found in errors:
        report.add(Outcome.APPROXIMATED, "error", found.location.path or "", f"{found.code}: {found.message}")


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
            f" If nobody operates {names} on your machine: --at-rest NAME for each of them, or --at-rest all "
            f'(at_rest=["all"]) says so, and their items are none.{hint}'
        )
    count = "1 item" if len(refused) == 1 else f"{len(refused)} items"
    raise LossError(f"{count} {what}: {first}{more}", report, hint=f"Nothing was written.{hint}")


_NAMED = 3


def verify(project: Project, kind: Format, back: Project, report: ConversionReport) -> None:
    """Compare what was written with what is read `back`: what does not come back is lost, whatever was reported.

    What the written file has besides, such as an id that the format asks for, is `translated`.
    Networks are compared by their meaning where the format draws them in its own way. `back` is changed by that.
    """
    if not kind.positions:
        from plcopen_sfc.languages.networks.network_equality import keep_drawings  # noqa: PLC0415  # brings the parser

        keep_drawings(project, back)
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


def _patched(project: Project, source: FileSource, kind: Format, report: ConversionReport) -> bytes:
    """Return the file that was read with the edits in it. What has no edits is neither read nor drawn nor written."""
    _report_refused(report, project, source, kind)
    from plcopen_sfc.conversion.adaptation import (  # noqa: PLC0415
        has_rewritten_charts,
        is_rewritten_throughout,
        rewrite_project,
    )
    from plcopen_sfc.drawing import prepare  # noqa: PLC0415

    codec = cast("XmlCodec", kind.codec())
    throughout = is_rewritten_throughout(project, source.content, kind)
    is_other = throughout or has_rewritten_charts(project, kind)
    excerpt = None if throughout else _Excerpt.of(project, source, codec)
    if excerpt is not None:
        notes = ConversionReport(report.source_format, report.target_format)
        merged = _merged(excerpt.project, source, kind, notes, is_other=is_other, excerpt=excerpt)
        whole = excerpt.filled(merged.data) if merged is not None else None
        if merged is not None and whole is not None:
            report.items += notes.items
            if not merged.is_same_to_tool:
                _report_edits(report, excerpt.project, source, (excerpt.content, merged.data), kind)
            return whole
    merged = _merged(project, source, kind, report, is_other=is_other)
    meant = project
    if merged is not None:
        data = merged.data
    else:
        # rather a large diff than a lost edit
        report.add(
            Outcome.APPROXIMATED,
            "file",
            source.path or "",
            "the edits did not fit into its text; written from the model",
        )
        before = codec.read(source.content).project
        options = WriteOptions(source.version, same=True, source=source.content, baseline=before)
        if is_other:
            project, marks = rewrite_project(project, kind, options, ConversionReport())
            options = replace(options, marks=marks)
        prepare(project, _drawing_style(kind), positions=kind.positions)
        data = codec.write(project, options, report)
    if merged is None or not merged.is_same_to_tool:
        _report_edits(report, meant, source, (source.content, data), kind)
    return data


def _report_edits(
    report: ConversionReport,
    project: Project,
    source: FileSource,
    contents: tuple[bytes, bytes],
    kind: Format,
    *,
    back: Project | None = None,
) -> None:
    """Report where the tool executes something else in the POUs that were edited than `project`.

    `contents`: the file before and after. What the tool did not read before either is nothing that the edits have lost.
    `back` is the project in the file after, if it was read.
    """
    same = {pou.report_path for number, pou in enumerate(project.pous) if is_from(pou, number, source.content)}
    if not kind.tool or len(same) == len(project.pous):
        return
    from plcopen_sfc.conversion import compare, executed, report_execution  # noqa: PLC0415
    from plcopen_sfc.semantics.profile import default_profile  # noqa: PLC0415  # loading needs no interpreter

    codec, rules = kind.codec(source.version), default_profile(project)

    def notes(meant: Project, content: bytes, told: Sequence[Item], known: Project | None = None) -> ConversionReport:
        shown = codec.as_tool_sees(content)
        seen = known if known is not None and shown == content else codec.read(shown).project
        both = [
            each.model_copy(update={"pous": [pou for pou in each.pous if pou.report_path not in same]})
            for each in (meant, seen)
        ]
        behaviour = executed(both[0], rules)
        found = ConversionReport(report.source_format, report.target_format, list(told))
        report_execution(found, compare(behaviour, executed(both[1], rules, compared_with=behaviour)), kind.tool, {})
        return found

    before, after = contents
    found = notes(project, after, report.items, back)
    if found.losses != report.losses:
        _pass_known_losses(found, notes(codec.read(before).project, before, []))
        report.items = found.items


def _report_refused(report: ConversionReport, project: Project, source: FileSource, kind: Format) -> None:
    """Report charts that no tool compiles since they were edited; before an edit that is the matter of `check`.

    Paths have names, which edits change: it is the number of mistakes of a kind that tells whether one is new.
    """
    edited = [pou for number, pou in enumerate(project.pous) if not is_from(pou, number, source.content)]
    found = _refused(edited, kind) if kind.tool else []
    if not found:
        return
    before = _refused(kind.codec(source.version).read(source.content).project.pous, kind)
    more = Counter(each.code for each in _refused(project.pous, kind)) - Counter(each.code for each in before)
    known = {(each.location.path, each.message) for each in before}
    for each in found:
        path = each.location.path or ""
        if more[each.code] and (path, each.message) not in known:
            report.add(Outcome.NOT_EXECUTED, "chart", path, f"{kind.tool} does not compile it: {each.message}")


def _refused(pous: Iterable[Pou], kind: Format) -> list[Diagnostic]:
    """Return what no tool compiles in the charts of these POUs."""
    from plcopen_sfc.analysis.checks import check_charts  # noqa: PLC0415  # most edits are in no chart
    from plcopen_sfc.semantics.profile import profile_of_format  # noqa: PLC0415

    profile = profile_of_format(kind.name)  # that of the project would read all its charts
    charts = (pou for pou in pous if _charts_of(pou))
    found = [each for pou in charts for each in check_charts(pou, profile=profile, select=_NEVER_COMPILED)]
    return sorted((each for each in found if each.severity is Severity.ERROR), key=str)


_NEVER_COMPILED = ("STR02", "STR12", "CND01")
"""Rules on what is a chart for no tool: no initial step, several, a transition without a condition."""


def _drawing_style(kind: Format) -> DrawingStyle:
    from plcopen_sfc.drawing import DrawingStyle  # noqa: PLC0415

    return DrawingStyle.STRUCTURED if kind.drawing is DrawingNeed.STRUCTURED else DrawingStyle.PLAIN


@dataclass(frozen=True)
class _Excerpt:
    """A file with its untouched POUs emptied, and what it holds before an edit and after.

    An edit of one POU of many then costs what that POU costs. `content` is the file, `before` the project in it and
    `project` that with the edits; both have the emptied POUs. `contents` are what these have in the file, by their
    numbers among all POUs.
    """

    content: bytes
    before: Project
    project: Project
    tag: str
    contents: Mapping[int, str]

    @classmethod
    def of(cls, project: Project, source: FileSource, codec: XmlCodec) -> _Excerpt | None:
        """Return the excerpt with all that was edited; None where the file has nothing to leave out."""
        from plcopen_sfc.formats.xml.source_tree import outermost_elements  # noqa: PLC0415
        from plcopen_sfc.formats.xml.xml_parsing import decode_xml  # noqa: PLC0415

        same = [number for number, pou in enumerate(project.pous) if is_from(pou, number, source.content)]
        if not same or not codec.pou_tag:
            return None
        text, encoding = decode_xml(source.content)
        spans = outermost_elements(text, codec.pou_tag)
        if len(spans) != len(project.pous) or encoding.encode(text) != source.content:
            return None
        contents = {number: text[spans[number].open_end : spans[number].close_start] for number in same}
        edits = [Edit(spans[number].open_end, spans[number].close_start, "") for number in same]
        content = encoding.encode(apply_edits(text, edits))
        before = codec.read(content).project
        if len(before.pous) != len(project.pous):
            return None
        pous = list(project.pous)
        for number in same:
            emptied = before.pous[number]
            if emptied.name != pous[number].name or emptied.interface or emptied.bodies or emptied.actions:
                return None  # the tool lists its POUs in another order
            pous[number] = emptied
        return cls(content, before, project.model_copy(update={"pous": pous}), codec.pou_tag, contents)

    def filled(self, data: bytes) -> bytes | None:
        """Return the edited excerpt `data` with what was left out; None where an edit changed an emptied POU."""
        from plcopen_sfc.formats.xml.source_tree import outermost_elements  # noqa: PLC0415
        from plcopen_sfc.formats.xml.xml_parsing import decode_xml  # noqa: PLC0415

        old, _ = decode_xml(self.content)
        new, encoding = decode_xml(data)
        were, are = outermost_elements(old, self.tag), outermost_elements(new, self.tag)
        edits: list[Edit] = []
        for number, content in self.contents.items() if len(were) == len(are) else ():
            was, now = were[number], are[number]
            if old[was.start : was.end] != new[now.start : now.end]:
                return None
            edits.append(Edit(now.open_end, now.open_end, content))
        return encoding.encode(apply_edits(new, edits)) if len(were) == len(are) else None


class _Merged(NamedTuple):
    """A file with the edits in it. `is_same_to_tool`: the tool reads from it the very project that was to be saved."""

    data: bytes
    is_same_to_tool: bool


def _merged(
    project: Project,
    source: FileSource,
    kind: Format,
    report: ConversionReport,
    *,
    is_other: bool = False,
    excerpt: _Excerpt | None = None,
) -> _Merged | None:
    """Return the file, or an excerpt of it, with the edits in it; None where reading it again does not give them.

    `is_other`: what is written is not what the project has.
    """
    from plcopen_sfc.conversion.adaptation import rewrite_project  # noqa: PLC0415
    from plcopen_sfc.drawing import prepare_body  # noqa: PLC0415
    from plcopen_sfc.formats.xml.source_patch import patch_xml  # noqa: PLC0415
    from plcopen_sfc.formats.xml.xml_codec import canonical  # noqa: PLC0415

    style = _drawing_style(kind)
    codec = cast("XmlCodec", kind.codec())
    content = source.content if excerpt is None else excerpt.content
    touched, untouched = set(), set()
    for name, _, body in project.bodies():
        if isinstance(body, SfcBody) and is_from(body.chart, name, source.content):
            untouched.add(name)
        else:
            touched.add(name)
            if not is_other:  # what is written has another drawing
                prepare_body(body, style, positions=False)
    before = codec.read(content).project if excerpt is None else excerpt.before
    options = WriteOptions(source.version, same=True, source=content, untouched=frozenset(untouched - touched))
    if is_other:
        options = replace(options, untouched=frozenset())

    def tree(edited: Project, baseline: Project | None, notes: ConversionReport) -> etree._Element:
        """Return the tree of a project, in the terms of the tool where the file has or needs them."""
        written = replace(options, baseline=baseline)
        if options.untouched or not is_other:
            return codec.to_tree(edited, written, notes)
        copy, marks = rewrite_project(edited, kind, written, notes)
        for _, _, body in copy.bodies():
            if isinstance(body, SfcBody):
                prepare_body(body, style, positions=False)
        return codec.to_tree(copy, replace(written, marks=marks, rewritten=edited), notes)

    after, known = tree(project, before, report), ConversionReport()
    data = patch_xml(content, tree(before, None, known), after)
    _pass_known_losses(report, known)
    try:
        back = codec.read(data).project
        if back == project:
            return _Merged(data, not is_other and codec.as_tool_sees(data) is data)
        # equal to the tool, if not in the order of its drawing; comments carry ids in TC6 1.01, which may be others now
        is_same = canonical(tree(back, None, ConversionReport())) == canonical(after)
    except FormatError:  # references by position that lead elsewhere now
        return None
    return _Merged(data, is_same_to_tool=False) if is_same else None


def _pass_known_losses(report: ConversionReport, known: ConversionReport) -> None:
    """Let an edit of a file in its own format lose nothing that the file could not say before: it keeps that beside.

    `known` is the report on the file as it was. Where names are others now, losses of one kind are counted.
    """
    left = [item for item in known.items if item.outcome in LOSSES]
    kinds: tuple[Callable[[Item], Hashable], ...]
    kinds = (lambda item: (item.outcome, item.what, item.path), lambda item: (item.outcome, item.what))
    for same in kinds:
        counts = Counter(map(same, left))
        for place, item in enumerate(report.items):
            if item.outcome in LOSSES and counts[same(item)] > 0:
                counts[same(item)] -= 1
                left.remove(next(each for each in left if same(each) == same(item)))
                report.items[place] = replace(item, outcome=Outcome.EXTENSION_DATA)


def _read_as(project: Project, data: bytes, kind: Format, version: str) -> Project | None:
    """Return the project in `data`; None where it is another one than `project`."""
    back = read_back(data, kind, version)
    if not kind.ids:
        number_in_order(back)
    return back if next(differences(project, back), None) is None else None


def _patched_text(project: Project, source: FileSource, kind: Format, report: ConversionReport) -> bytes:
    """Return the text that was read with the edits in it."""
    _report_refused(report, project, source, kind)
    from plcopen_sfc.formats.text_patch import patch_text  # noqa: PLC0415  # only to save edits

    codec = cast("TextCodec", kind.codec(source.version))
    before, text, spans = codec.located(source.content)
    options = WriteOptions(source.version, same=True, source=source.content, baseline=before)
    after, known = codec.to_blocks(project, options, report), ConversionReport()
    old = codec.to_blocks(before, options, known)
    _pass_known_losses(report, known)
    meant = project if kind.ids else numbered_in_order(project)
    back: Project | None = None
    for by_words in (True, False):  # a word may stand for two things: `a, b : INT; (* comment *)`
        if back is None:
            data, recoded = text.encode(patch_text(text, spans, old, after, by_words=by_words))
            back = _read_as(meant, data, kind, source.version)
    if recoded:
        why = f"{text.encoding} does not have all of its characters; the file is in UTF-8 now"
        report.add(Outcome.TRANSLATED, "encoding", source.path or "", why)
    if back is None:
        # rather a large diff than a lost edit
        report.add(
            Outcome.APPROXIMATED,
            "file",
            source.path or "",
            "the edits did not fit into its text; written from the model",
        )
        report_reading_errors(project, report)
        data = codec.write(project, options, ConversionReport())
        back = read_back(data, kind, source.version)
        verify(project, kind, back, report)
    _report_edits(report, project, source, (source.content, data), kind, back=back)
    return data
