"""Files with the edits of their projects in them: only the places that changed are written."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple, cast

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.documents.reading_back import read_back, report_reading_errors, verify
from plcopen_sfc.documents.sources import FileSource
from plcopen_sfc.errors import FormatError
from plcopen_sfc.formats.format_interface import Codec, DrawingNeed, Format, WriteOptions
from plcopen_sfc.formats.provenance import compared_only, is_as_read, is_from, is_of_file
from plcopen_sfc.languages.declarations.conditional_declarations import CONDITION, leave_conditions
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.numbering import number_in_order, numbered_in_order
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.report import LOSSES, ConversionReport, Item, Outcome

if TYPE_CHECKING:
    from lxml import etree

    from plcopen_sfc.drawing import DrawingStyle
    from plcopen_sfc.formats.text_codec import TextCodec
    from plcopen_sfc.formats.text_patch import WrittenBlock
    from plcopen_sfc.formats.xml.xml_codec import XmlCodec


def patched(project: Project, source: FileSource, kind: Format, report: ConversionReport) -> bytes:
    """Return the file that was read with the edits in it. What has no edits is neither read nor drawn nor written."""
    _report_refused(report, project, source, kind)
    _leave_conditions(project, source, kind)
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
        report.add(Outcome.APPROXIMATED, "file", source.path or "", _UNFIT)  # rather a large diff than a lost edit
        before = _comparable(codec, source.content)
        options = WriteOptions(source.version, same=True, same_format=True, source=source.content, baseline=before)
        if is_other:
            project, marks = rewrite_project(project, kind, options, ConversionReport())
            options = replace(options, marks=marks)
        prepare(project, _drawing_style(kind), positions=kind.positions)
        data = codec.write(project, options, report)
        verify(meant, kind, _comparable(codec, data), report)
    if merged is None or not merged.is_same_to_tool:
        _report_edits(report, meant, source, (source.content, data), kind)
    return data


def _leave_conditions(project: Project, source: FileSource, kind: Format) -> None:
    """Leave the conditions of variables that were taken out to what is behind them in the file."""
    if CONDITION.search(source.content.decode("latin-1")):
        leave_conditions(_comparable(kind.codec(source.version), source.content), project)


def _comparable(codec: Codec, content: bytes) -> Project:
    """Return the project in a file, for comparisons: nothing edits it."""
    with compared_only():
        return codec.read(content).project


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
    from plcopen_sfc.semantics.profile import default_profile, profile_of_format  # noqa: PLC0415  # no interpreter

    codec, rules = kind.codec(source.version), default_profile(project)
    its = rules if not project.is_converted else profile_of_format(kind.name)

    def notes(meant: Project, content: bytes, told: Sequence[Item], known: Project | None = None) -> ConversionReport:
        shown = codec.as_tool_sees(content)
        seen = known if known is not None and shown == content else _comparable(codec, shown)
        both = [
            each.model_copy(update={"pous": [pou for pou in each.pous if pou.report_path not in same]})
            for each in (meant, seen)
        ]
        behaviour = executed(both[0], rules)
        found = ConversionReport(report.source_format, report.target_format, list(told))
        report_execution(found, compare(behaviour, executed(both[1], its, compared_with=behaviour)), kind.tool, {})
        return found

    before, after = contents
    found = notes(project, after, report.items, back)
    if found.losses != report.losses:
        _pass_known_losses(found, notes(_comparable(codec, before), before, []))
        report.items = found.items


def _report_refused(report: ConversionReport, project: Project, source: FileSource, kind: Format) -> None:
    """Report charts that no tool compiles since they were edited; before an edit that is the matter of `check`.

    Paths have names, which edits change: it is the number of mistakes of a kind that tells whether one is new.
    """
    edited = [pou for number, pou in enumerate(project.pous) if not is_from(pou, number, source.content)]
    found = _refused(edited, kind) if kind.tool else []
    if not found:
        return
    before = _refused(_comparable(kind.codec(source.version), source.content).pous, kind)
    more = Counter(each.code for each in _refused(project.pous, kind)) - Counter(each.code for each in before)
    known = {(each.location.path, each.message) for each in before}
    for each in found:
        path = each.location.path or ""
        if more[each.code] and (path, each.message) not in known:
            report.add(Outcome.NOT_EXECUTED, "chart", path, f"{kind.tool} does not compile it: {each.message}")


def _refused(pous: Iterable[Pou], kind: Format) -> list[Diagnostic]:
    """Return the mistakes that no tool compiles in the charts of these POUs."""
    from plcopen_sfc.analysis.checks import check_charts  # noqa: PLC0415  # most edits are in no chart
    from plcopen_sfc.semantics.profile import profile_of_format  # noqa: PLC0415

    profile = profile_of_format(kind.name)  # that of the project would read all its charts
    charts = (pou for pou in pous if any(isinstance(each.body, SfcBody) for each in pou.named_bodies()))
    found = [each for pou in charts for each in check_charts(pou, profile=profile, select=_NEVER_COMPILED)]
    return sorted((each for each in found if each.severity is Severity.ERROR), key=str)


_NEVER_COMPILED = ("STR02", "STR12", "CND01")
"""Rules on what is a chart for no tool: no initial step, several, a transition without a condition."""


def _drawing_style(kind: Format) -> DrawingStyle:
    from plcopen_sfc.drawing import DrawingStyle  # noqa: PLC0415

    return DrawingStyle.STRUCTURED if kind.drawing is DrawingNeed.STRUCTURED else DrawingStyle.PLAIN


_UNFIT = "the edits did not fit into its text; written from the model"


@dataclass(frozen=True)
class _Excerpt:
    """A file with its untouched POUs emptied, and what it holds before an edit and after.

    An edit of one POU of many then costs what that POU costs. `content` is the file, `before` the project in it and
    `project` that with the edits; both have the emptied POUs. `contents` are what these have in the file, by their
    numbers among all POUs, without copies of it.
    """

    content: bytes
    before: Project
    project: Project
    tag: str
    contents: Mapping[int, memoryview]

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
        if len(spans) != len(project.pous) or not encoding.is_reversible(text, source.content):
            return None
        places = iter(encoding.positions(text, [each for span in spans for each in (span.open_end, span.close_start)]))
        inner = [memoryview(source.content)[start:end] for start, end in zip(places, places, strict=True)]
        contents = {number: inner[number] for number in same}
        edits = [Edit(spans[number].open_end, spans[number].close_start, "") for number in same]
        content = encoding.encode(apply_edits(text, edits))
        before = _comparable(codec, content)
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
        if len(were) != len(are):
            return None
        parts: list[bytes | memoryview] = [encoding.bom]
        position = 0
        for number, content in sorted(self.contents.items()):
            was, now = were[number], are[number]
            if old[was.start : was.end] != new[now.start : now.end]:
                return None
            parts += (new[position : now.open_end].encode(encoding.codec), content)
            position = now.open_end
        return b"".join([*parts, new[position:].encode(encoding.codec)])


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
    from plcopen_sfc.formats.xml.source_patch import patch_xml  # noqa: PLC0415
    from plcopen_sfc.formats.xml.xml_codec import canonical  # noqa: PLC0415
    from plcopen_sfc.semantics.profile import default_profile  # noqa: PLC0415  # no interpreter

    codec = cast("XmlCodec", kind.codec())
    content = source.content if excerpt is None else excerpt.content
    touched, untouched = _bodies_by_edits(project, source, kind, is_other=is_other)
    before = _comparable(codec, content) if excerpt is None else excerpt.before
    options = WriteOptions(
        source.version,
        same=True,
        same_format=True,
        source=content,
        untouched=frozenset() if is_other else untouched,
        of_codesys=bool(default_profile(project).flags),  # a file of another tool may hold their replacement
    )
    trees = _Trees(codec, kind, options, touched, is_other)
    unchanged = {} if is_other else _unchanged(before, project, touched, codec, source)
    # What both trees have is left alone in the file: two writings of the same model differ in the edits alone, while a
    # written tree and the file of a tool also differ in all that tools spell in their own way.
    known = ConversionReport()
    after = trees.tree(project, before, report, unchanged)
    # what the file could not say before tells nothing on its own
    data = patch_xml(content, trees.tree(before, None, known, unchanged, limited=bool(report.losses)), after)
    _pass_known_losses(report, known)
    try:
        back = _comparable(codec, data)
        if back == project:
            return _Merged(data, not is_other and codec.as_tool_sees(data) is data)
        # equal to the tool, if not in the order of its drawing; comments carry ids in TC6 1.01, which may be others now
        after = trees.tree(project, before, ConversionReport()) if unchanged else after
        is_same = canonical(trees.tree(back, None, ConversionReport())) == canonical(after)
    except FormatError:  # references by position that lead elsewhere now
        return None
    if is_same:
        _report_lost(project, back, kind, report, only_beside=is_other or kind.extension_data)
    return _Merged(data, is_same_to_tool=False) if is_same else None


def _bodies_by_edits(
    project: Project, source: FileSource, kind: Format, *, is_other: bool
) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names of the bodies with edits, which are drawn where they are written, and of those without."""
    from plcopen_sfc.drawing import prepare_body  # noqa: PLC0415

    touched, untouched = set[str](), set[str]()
    for name, _, body in project.bodies():
        if isinstance(body, SfcBody) and is_from(body.chart, name, source.content):
            untouched.add(name)
        else:
            touched.add(name)
            if not is_other:  # what is written has another drawing
                foreign = isinstance(body, SfcBody) and not is_of_file(body.chart, source.content)
                prepare_body(body, _drawing_style(kind), positions=False, foreign=foreign)
    # two bodies may have one name: of those the name tells nothing
    return frozenset(touched), frozenset(untouched - touched)


@dataclass(frozen=True)
class _Trees:
    """Trees of projects in the terms of the tool, where the file has or needs them (`is_other`)."""

    codec: XmlCodec
    kind: Format
    options: WriteOptions
    touched: Collection[str]
    is_other: bool

    def tree(
        self,
        edited: Project,
        baseline: Project | None,
        notes: ConversionReport,
        unchanged: Mapping[int, frozenset[int]] = MappingProxyType({}),
        *,
        limited: bool = True,
    ) -> etree._Element:
        """Return the tree of a project; with `limited`, limits of its charts are noted."""
        from plcopen_sfc.conversion.adaptation import rewrite_project  # noqa: PLC0415
        from plcopen_sfc.drawing import prepare_body  # noqa: PLC0415

        options = replace(self.options, baseline=baseline, unchanged=unchanged)
        written = edited
        if self.is_other:
            written, marks = rewrite_project(edited, self.kind, options, notes)
            if baseline is not None and self.kind.flags_as_conditions:
                # blocks that SFC flags add are in the file with numbers of their own, which they keep
                baseline, more = rewrite_project(baseline, self.kind, options, ConversionReport())
                marks = {**more, **marks}
            options = replace(options, baseline=baseline, marks=marks, rewritten=edited)
        if limited:
            _note_limits(written, self.kind, self.touched, notes)
        for _, _, body in written.bodies() if self.is_other else ():
            if isinstance(body, SfcBody):
                prepare_body(body, _drawing_style(self.kind), positions=False)
        return self.codec.to_tree(written, options, notes)


def _report_lost(project: Project, back: Project, kind: Format, report: ConversionReport, *, only_beside: bool) -> None:
    """Report what a file does not bring back of a project, or `only_beside` its objects, such as its header.

    Writers report what they rewrite, and what they keep as extension data, in objects; some write nothing else.
    """
    empty: dict[str, list[object]] = {name: [] for name in Project.OBJECTS} if only_beside else {}
    verify(project.model_copy(update=empty), kind, back.model_copy(update=empty), report)


def _note_limits(written: Project, kind: Format, edited: Collection[str], report: ConversionReport) -> None:
    """Report edited charts that are no nested branches. TC6 has wires for any; other writers report what they lack."""
    if kind.drawing is DrawingNeed.STRUCTURED and kind.standard == "TC6":
        from plcopen_sfc.documents.writer_preparation import note_limits  # noqa: PLC0415  # only to save edits

        note_limits((chart for chart in written.charts() if chart.name in edited), kind, report)


def _unchanged(
    before: Project, after: Project, touched: Collection[str], codec: XmlCodec, source: FileSource
) -> dict[int, frozenset[int]]:
    """Return the symbols without edits in the charts of bodies with edits, by the `id()` of these charts.

    A patch of the file needs nothing of their elements. Data of tools depend on their version; and where the file has
    errors, such as an id of two elements, the others tell which one was edited.
    """
    if before.header != after.header or any(each.severity is Severity.ERROR for each in source.diagnostics):
        return {}
    found: dict[int, frozenset[int]] = {}
    charts = {name: body.chart for name, _, body in before.bodies() if isinstance(body, SfcBody) and name in touched}
    for name, _, body in after.bodies():
        if name in charts and isinstance(body, SfcBody):
            known, drawing = charts[name], body.chart.drawing
            # to read a drawing again that no edit has changed takes as long as to read the chart
            if drawing is not None and is_of_file(body.chart, source.content, name) and is_as_read(drawing):
                known.drawing = drawing
            found[id(known)] = found[id(body.chart)] = codec.unchanged_symbols(known, body.chart)
    return found


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


def _blocks(
    project: Project, codec: TextCodec, kind: Format, options: WriteOptions, report: ConversionReport
) -> WrittenBlock:
    """Return the text of a project, in the terms of the tool where the format has a place for the source beside it.

    A file of the tool itself that has something else, as a damaged one, keeps the terms that it has.
    """
    if kind.charts is None:
        return codec.to_blocks(project, options, report)
    from plcopen_sfc.conversion.adaptation import needs_rewriting, rewrite_project  # noqa: PLC0415  # for edits
    from plcopen_sfc.documents.writer_preparation import for_source  # noqa: PLC0415
    from plcopen_sfc.semantics.profile import default_profile  # noqa: PLC0415

    options = for_source(options, default_profile(project))
    is_of_tool = codec.as_tool_sees(options.source) == options.source
    before = options.baseline.charts() if options.baseline is not None and is_of_tool else ()
    if any(needs_rewriting(chart, kind.charts, options) for chart in before):
        return codec.to_blocks(project, options, report)
    written, _ = rewrite_project(project, kind, options, report)
    return codec.to_blocks(written, replace(options, rewritten=project), report)


def patched_text(project: Project, source: FileSource, kind: Format, report: ConversionReport) -> bytes:
    """Return the text that was read with the edits in it."""
    _report_refused(report, project, source, kind)
    from plcopen_sfc.formats.text_patch import patch_text  # noqa: PLC0415  # only to save edits

    codec = cast("TextCodec", kind.codec(source.version))
    before, text, spans = codec.located(source.content)
    leave_conditions(before, project)
    options = WriteOptions(source.version, same=True, same_format=True, source=source.content, baseline=before)
    known = ConversionReport()
    after, old = (_blocks(each, codec, kind, options, notes) for each, notes in ((project, report), (before, known)))
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
        report.add(Outcome.APPROXIMATED, "file", source.path or "", _UNFIT)  # rather a large diff than a lost edit
        report_reading_errors(project, report)
        data = codec.write(project, options, ConversionReport())
        back = read_back(data, kind, source.version)
        verify(project, kind, back, report)
    _report_edits(report, project, source, (source.content, data), kind, back=back)
    return data
