"""One file as bytes: reading it into a project that keeps its source, and writing it with just the edits in it."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.conversion import Part, compare, executed, report_execution
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import DamagedSourceError, LossError, UnknownFormatError
from plcopen_sfc.formats.base import DrawingNeed, Format, Reading, TextCodec, WriteOptions
from plcopen_sfc.formats.registry import format_named, recognise
from plcopen_sfc.model.base import FINGERPRINT
from plcopen_sfc.model.body import IlBody, SfcBody, StBody
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.numbering import numbered_in_order
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, FolderOrigin, Origin, Project
from plcopen_sfc.model.text import is_direct
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.profile import PROFILES, default_profile

if TYPE_CHECKING:
    from lxml import etree


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


def encode(
    project: Project, name: str, *, flavour: str, fresh: bool, limit: float = 0
) -> tuple[bytes, ConversionReport]:
    """The bytes of `project` in the format `name` (``simaticml-V16``), and what became of each item.

    `limit`: for so many seconds the charts are run in both tools.
    """
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
    same = origin is not None and origin.format == kind.name and origin.version == version and not flavour
    if not same:
        refuse_reading_errors(project, report)
    options = WriteOptions(version, flavour, same=same, source=origin.content if origin is not None and same else b"")
    copy, meant, options, source = prepared(project, kind, options, report)
    data: bytes = kind.codec().write(copy, options, report)
    if not (options.flavour and kind.text):  # what a flavour leaves out is for people, and not read back
        verify(meant, kind, kind.codec().read(data).project, report)
    called = names_in_the_source(project, copy)
    if source is not None:
        seen = read_document(data, format=kind.name, path=None, as_tool=True)
        target = PROFILES[flavour] if flavour else None
        report_execution(
            report, compare(source, executed(seen, target, lists=source.lists)), flavour or kind.tool, called
        )
        if limit:
            from plcopen_sfc.conversion.running import report_running  # noqa: PLC0415  # brings the interpreter

            report_running(report, project, seen, called, tool=flavour or kind.tool, target=target, limit=limit)
    if origin is not None and format_named(origin.format)[0].xml:
        report.locate(format_named(origin.format)[0].codec().lines(origin.content, project), called=called)
    locate_in_folder(project, report, called)
    return data, report


def _is_rewritten(project: Project, kind: Format, content: bytes) -> bool:
    """True if the file says, or has to say, something else than the model in terms of its tool: no patch knows that."""
    is_rewritten = getattr(kind.codec(), "is_rewritten", None)
    return is_rewritten is not None and is_rewritten(project, content)


def names_in_the_source(project: Project, copy: Project) -> dict[str, str]:
    """The paths in the source of what has another name in the `copy` that was written."""
    called = {new.report_path: old.report_path for old, new in zip(project.pous, copy.pous, strict=True)}
    pairs = [
        (old, new)
        for a, b in zip(project.pous, copy.pous, strict=True)
        for old, new in zip(_charts_of(a), _charts_of(b), strict=False)  # a writer may have none in actions
    ]
    for old, new in pairs:
        steps = {step.id: step for step in old.network.steps}
        transitions = {transition.id: transition for transition in old.network.transitions}
        for step in new.network.steps:  # a writer may add steps
            if step.id in steps:
                called[f"{new.report_path} / step {step.name}"] = f"{old.report_path} / step {steps[step.id].name}"
        for transition in new.network.transitions:
            if transition.id in transitions:
                path = f"{new.report_path} / transition {new.network.label(transition)}"
                label = old.network.label(transitions[transition.id])
                called[path] = f"{old.report_path} / transition {label}"
    return {path: old for path, old in called.items() if path != old}


def _charts_of(pou: Pou) -> list[Chart]:
    return [Chart(name, pou, body.chart) for name, body in pou.named_bodies() if isinstance(body, SfcBody)]


def locate_in_folder(project: Project, report: ConversionReport, called: Mapping[str, str]) -> None:
    """Fill in document and line of the items of `report` that are not simply kept, where the source was a folder.

    `called`: paths in the source of what has another one in the report.
    """
    origin = project._origin
    if not isinstance(origin, FolderOrigin):
        return
    told = {item.path.partition(" / ")[0] for item in report.items if item.outcome is not Outcome.KEPT}
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


def refuse_reading_errors(project: Project, report: ConversionReport) -> None:
    """Raise `DamagedSourceError` where reading the source found errors; where they are accepted, report them.

    A folder that stays in its format keeps its documents as they are: only those that could not be read are missing.
    """
    origin = project._origin
    folder = origin if isinstance(origin, FolderOrigin) else None
    stays = folder is not None and format_named(report.target_format)[0].name == folder.format
    findings = folder.own_diagnostics if stays and folder is not None else project.diagnostics
    errors = [found for found in findings if found.severity is Severity.ERROR]
    if errors and not project._errors_accepted:
        raise DamagedSourceError(errors)
    for path, error in folder.unreadable.items() if folder is not None else ():
        report.add(Outcome.NOT_EXECUTED, "file", path, f"it could not be read: {error.message}")
    for found in errors:
        if folder is None or found not in folder.own_diagnostics:
            report.add(Outcome.APPROXIMATED, "error", found.location.path or "", f"{found.code}: {found.message}")


def refuse_losses(report: ConversionReport, *, strict: bool, partial: bool) -> None:
    """Raise `LossError` where the target does not execute something, unless `partial`; `strict`: or otherwise."""
    refused = report.losses if strict else [] if partial else report.with_outcome(Outcome.NOT_EXECUTED)
    if not refused:
        return
    first = "; ".join(f"{item.what} {item.path}: {item.why}" for item in refused[:_NAMED])
    more = f"; and {len(refused) - _NAMED} more" if len(refused) > _NAMED else ""
    what = "would be executed otherwise or not at all" if strict else "would not be executed"
    hint = "" if strict else " --partial (partial=True) writes the rest, and keeps what it can for the way back."
    count = "1 item" if len(refused) == 1 else f"{len(refused)} items"
    raise LossError(f"{count} {what}: {first}{more}", report, hint=f"Nothing was written.{hint}")


_NAMED = 3


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
        report.add(Outcome.DROPPED, "field", difference.path, why)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else text[:_SHOWN] + ".."


_SHOWN = 60


class Prepared(NamedTuple):
    """A project for a writer: a copy with its texts in the dialect of the target, and with the drawings it needs.

    `meant` is what the written file means when this package reads it, which is the copy itself unless the format says
    some things in other terms; `options` are those to write with. `source` is everything that is executed of the
    project, before anything but the dialect was adapted to the target; None where no tool executes such files.
    """

    project: Project
    meant: Project
    options: WriteOptions
    source: Part | None


def prepared(project: Project, kind: Format, options: WriteOptions, report: ConversionReport) -> Prepared:
    """A copy of `project` for the writer of the format `kind`."""
    dialect = kind.dialect or (Dialect.IEC if options.flavour else None)
    same_dialect = dialect in (None, project.dialect)
    if kind.drawing is DrawingNeed.NONE and same_dialect and not options.flavour:
        source = executed(project) if kind.tool else None
        return Prepared(project, project, options, source)
    from plcopen_sfc.drawing import DrawingStyle, prepare  # noqa: PLC0415  # not needed to load and look

    copy = project.model_copy(deep=True)
    profile = default_profile(project)
    options = replace(options, of_graph=profile.graph_parameters, final_scan=profile.final_scan)
    if kind.xml and not options.same:
        _forget_direct_text(copy)
    if dialect is not None:
        _put_into_dialect(copy, dialect, report, wholly=bool(options.flavour))
    if options.flavour:
        kind.codec().fit(copy, options.flavour, report)
        # what its rules would do otherwise is written out, or reported
        rules = PROFILES[options.flavour]
        profile = replace(
            profile,
            final_scan=rules.final_scan,
            action_control=rules.action_control,
            boolean_targets=rules.boolean_targets,
        )
    # the writer changes its copy, and what is executed is looked at when source and result are compared
    unchanged = copy.model_copy(deep=True)
    source = executed(unchanged, profile, addresses=project.dialect) if kind.tool else None
    if kind.drawing is DrawingNeed.NONE:
        return Prepared(copy, copy, options, source)
    style = DrawingStyle.STRUCTURED if kind.drawing is DrawingNeed.STRUCTURED else DrawingStyle.PLAIN
    if style.structured and (project._origin is None or project._origin.format != kind.name):
        _note_limits(copy, report)
    meant = copy
    rewrite = getattr(kind.codec(), "rewrite", None)
    if rewrite is not None:
        copy, marks = rewrite(meant, options, report)
        options = replace(options, marks=marks)
    # a format without ids has branches of its own instead of the bars of others
    other = project._origin is None or project._origin.format != kind.name
    anew = bool(options.flavour) or (not kind.ids and other)
    prepare(copy, style, positions=kind.positions, anew=anew, foreign=True)
    adapt = getattr(kind.codec(), "adapt", None)
    if adapt is not None:
        adapt(copy, options, report)
    return Prepared(copy, meant, options, source)


def _forget_direct_text(project: Project) -> None:
    """Forget that program text stands in ``ST`` itself: every format writes its text as its tool does."""
    for _, _, body in project.bodies():
        if isinstance(body, StBody | IlBody) and is_direct(body.markup):
            body.markup = None
    for chart in project.charts():
        for transition in chart.network.transitions:
            if isinstance(transition.condition, Expression):
                transition.condition.markup = None


def _put_into_dialect(project: Project, dialect: Dialect, report: ConversionReport, *, wholly: bool) -> None:
    """Translate the program text between SCL and the others.

    IEC 61131-3 and CODESYS are left as they stand unless `wholly`: their tools read most of each other's text, and
    files of one often hold what is of the other. Only the operator ``**`` is EXPT in CODESYS.
    """
    source = project.dialect
    if dialect is source:
        return
    from plcopen_sfc.refactor.dialect import translate_powers, translate_project  # noqa: PLC0415  # rarely needed

    if Dialect.SCL not in (source, dialect) and not wholly:
        texts = translate_powers(project) if (source, dialect) == (Dialect.IEC, Dialect.CODESYS) else []
        project.dialect = dialect
    else:
        texts = translate_project(project, dialect)
    for text in texts:
        for note in text.notes:
            outcome = _OUTCOMES[note.severity]
            report.add(outcome, "text", text.path, f"line {note.line}: {note.reason}")
        if text.changed and not text.notes:
            report.add(Outcome.TRANSLATED, "text", text.path, f"from {source} into {dialect}")


_OUTCOMES = {
    Severity.INFO: Outcome.TRANSLATED,
    Severity.WARNING: Outcome.APPROXIMATED,
    Severity.ERROR: Outcome.NOT_EXECUTED,
}
"""What became of a text by what its translation has to say: without a counterpart it is left as it stands."""


def _note_limits(project: Project, report: ConversionReport) -> None:
    """Say which charts tools that know nested branches only may not take."""
    from plcopen_sfc.drawing import limits  # noqa: PLC0415

    for chart in project.charts():
        names = {step.id: f"step {step.name}" for step in chart.network.steps}
        names |= {id_: f"transition {label}" for id_, label in chart.network.labels().items()}
        for problem in limits(chart.network):
            path = f"{chart.report_path} / {names.get(problem.symbol, problem.symbol)}"
            report.add(Outcome.APPROXIMATED, "chart", path, f"{problem.code}: {problem.detail}")


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
    if _is_rewritten(project, kind, origin.content):
        options = replace(options, untouched=frozenset())

    def tree(said: Project, baseline: Project | None, notes: ConversionReport) -> etree._Element:
        """The tree of a project, in the terms of the tool where the file has or needs them."""
        written = replace(options, baseline=baseline)
        if options.untouched or not hasattr(codec, "rewrite") or not _is_rewritten(project, kind, origin.content):
            plain: etree._Element = codec.to_tree(said, written, notes)
            return plain
        copy, marks = codec.rewrite(said, written, notes)
        for _, _, body in copy.bodies():
            if isinstance(body, SfcBody):
                prepare_body(body, style, positions=False)
        made: etree._Element = codec.to_tree(copy, replace(written, marks=marks), notes)
        return made

    after = tree(project, before, report)
    data = patch(origin.content, tree(before, None, ConversionReport()), after)
    back = tree(codec.read(data).project, None, ConversionReport())
    # comments carry ids in TC6 1.01, which may be others now
    if canonical(back) != canonical(after):
        # rather a large diff than a lost edit
        report.add(Outcome.APPROXIMATED, "file", origin.path or "", "the edits did not fit into its text; written anew")
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
        report.add(Outcome.TRANSLATED, "encoding", origin.path or "", why)
    if next(differences(project, codec.read(data).project), None) is not None:
        # rather a large diff than a lost edit
        report.add(Outcome.APPROXIMATED, "file", origin.path or "", "the edits did not fit into its text; written anew")
        data = codec.write(project, options, ConversionReport())
        verify(project, kind, codec.read(data).project, report)
    return data
