"""Summaries of files and their charts, as numbers."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, cast

from plcopen_sfc.documents.sources import FileSource, FolderSource, documents_of
from plcopen_sfc.formats.registry import TIA_FORMAT, format_named
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.conditions import NamedCondition
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork, Step

if TYPE_CHECKING:
    from plcopen_sfc.formats.format_interface import Format, TextCodec

__all__ = ["ChartSummary", "FileSummary", "all_charts", "summarise"]


@dataclass(frozen=True)
class ChartSummary:
    """The numbers of one chart. `jumps`: None where the file has no drawing of the chart.

    The last four are those of S7-GRAPH, None for other charts.
    """

    name: str
    pou_kind: str
    initial_steps: list[str]
    steps: int
    macro_steps: int
    transitions: int
    selections: int
    simultaneous_branches: int
    jumps: int | None
    action_associations: int
    step_actions: int
    named_conditions: int
    sequences: int | None = None
    interlocks: int | None = None
    supervisions: int | None = None
    graph_version: str | None = None

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {key: value for key, value in asdict(self).items() if value is not None}


@dataclass(frozen=True)
class FileSummary:
    """Summary of a file. `documents`: how many a folder has.

    `blocks` are those with a number (``FB 10 FB_Drill``), `cultures` the languages of its texts (``de-DE``), both of
    TIA Portal only.
    """

    file: str
    format: str
    format_title: str
    dialect: str
    tool: str
    tool_version: str
    project: str
    encoding: str
    line_ends: str
    size: int
    pous: dict[str, int]
    languages: dict[str, int]
    documents: int | None = None
    blocks: list[str] | None = None
    cultures: list[str] | None = None
    charts: list[ChartSummary] = field(default_factory=list)

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        own = {each.name: getattr(self, each.name) for each in fields(self) if each.name != "charts"}
        own = {name: value for name, value in own.items() if value is not None}
        return own | {"charts": [chart.as_dict() for chart in self.charts], "totals": self.totals()}

    def totals(self) -> dict[str, int]:
        """The sums over all charts."""
        no_counts = {"name", "pou_kind", "initial_steps", "graph_version"}
        numbers = {each.name: [getattr(chart, each.name) for chart in self.charts] for each in fields(ChartSummary)}
        graph = ("sequences", "interlocks", "supervisions")
        counted = [name for name in numbers if name not in no_counts and (name not in graph or any(numbers[name]))]
        sums = {name: sum(number or 0 for number in numbers[name]) for name in counted}
        return {"charts": len(self.charts), **sums}


def summarise(file: str, project: Project) -> FileSummary:
    """Return the summary of `project`, which was read from `file`: a file or a folder."""
    contents: list[bytes] = []
    versions: dict[str, None] = {}
    name = "json"
    for document in documents_of(project):
        if isinstance(document.source, FileSource):
            name = document.source.format
            contents.append(document.source.content)
            versions[document.source.version] = None
    kind = format_named(name)[0]
    version = ", ".join(versions)
    characters = [_characters(content, kind) for content in contents]
    encoding, line_ends = (" or ".join(dict.fromkeys(texts)) for texts in zip(*characters, strict=True))
    return FileSummary(
        file=file,
        format=kind.name,
        format_title=kind.title,
        dialect=f"{kind.standard} {version}" if version and kind.standard else version,
        tool=project.header.product,
        tool_version=project.header.version,
        project=project.name,
        encoding=encoding,
        line_ends=line_ends,
        documents=len(contents) if isinstance(project.source, FolderSource) else None,
        blocks=_blocks(project) or None,
        cultures=_cultures(contents) or None if kind.name == TIA_FORMAT else None,
        size=sum(map(len, contents)),
        pous=dict(Counter(pou.kind.value for pou in project.pous)),
        languages=dict(Counter(body.language for _, _, body in project.bodies())),
        charts=[_chart(name, pou_kind, chart) for name, pou_kind, chart in all_charts(project)],
    )


def _blocks(project: Project) -> list[str]:
    """The blocks that have a number, by kind and number."""
    blocks = [(_LETTERS.get(pou.kind, "FB"), pou.number, pou.name) for pou in project.pous]
    blocks += [("DB", block.number, block.name) for block in project.data_blocks]
    numbered = [(letters, number, name) for letters, number, name in blocks if number is not None]
    order = {letters: place for place, letters in enumerate((*_LETTERS.values(), "DB"))}
    numbered.sort(key=lambda block: (order[block[0]], block[1]))
    return [f"{letters} {number} {name}" for letters, number, name in numbered]


_LETTERS = {PouKind.ORGANIZATION_BLOCK: "OB", PouKind.FUNCTION_BLOCK: "FB", PouKind.FUNCTION: "FC"}


def _cultures(contents: list[bytes]) -> list[str]:
    """The languages of the texts in documents of TIA Portal, the most frequent first."""
    found: Counter[str] = Counter()
    for content in contents:
        found.update(name.decode("ascii") for name in _CULTURE.findall(content))
    return sorted(found, key=lambda name: (-found[name], name))


_CULTURE = re.compile(rb"(?:<Culture>|\bLang=[\"'])([A-Za-z]+-[A-Za-z-]+)")


def all_charts(project: Project) -> Iterator[tuple[str, str, SfcNetwork]]:
    """Every chart, those inside of macro-steps and actions too: its name, the kind of its POU, the chart."""
    for chart in project.charts():
        yield from _with_inner(chart.name, chart.pou.kind.value, chart.chart)


def _with_inner(name: str, pou_kind: str, network: SfcNetwork) -> Iterator[tuple[str, str, SfcNetwork]]:
    yield name, pou_kind, network
    for step in network.steps:
        for body in _bodies_in(step):
            if isinstance(body, SfcBody):
                yield from _with_inner(f"{name} / {step.name}", pou_kind, body.chart)
    for part in network.partial_charts:
        yield from _with_inner(f"{name} / {part.name}", pou_kind, part.chart)


def _bodies_in(step: Step) -> Iterator[Body]:
    if step.macro is not None and step.macro.body is not None:
        yield step.macro.body
    yield from (a.body for a in step.actions if a.body is not None)
    yield from (a for a in _step_actions(step) if not isinstance(a, str))


def _step_actions(step: Step) -> list[str | Body]:
    return [action for action in (step.entry_action, step.main_action, step.exit_action) if action]


def _chart(name: str, pou_kind: str, chart: SfcNetwork) -> ChartSummary:
    leaving = Counter(step for transition in chart.transitions for step in set(transition.sources))
    symbols = chart.drawing.symbols if chart.drawing is not None else None
    return ChartSummary(
        name=name,
        pou_kind=pou_kind,
        initial_steps=[step.name for step in chart.initial_steps],
        steps=len(chart.steps),
        macro_steps=sum(step.macro is not None for step in chart.steps),
        transitions=len(chart.transitions),
        selections=sum(count > 1 for count in leaving.values()),
        simultaneous_branches=sum(len(transition.targets) > 1 for transition in chart.transitions),
        jumps=None if symbols is None else sum(symbol.kind is SymbolKind.JUMP for symbol in symbols),
        action_associations=sum(1 for _ in chart.associations()),
        step_actions=sum(len(_step_actions(step)) for step in chart.steps),
        named_conditions=sum(isinstance(transition.condition, NamedCondition) for transition in chart.transitions),
        sequences=len(chart.sequences) or None,
        interlocks=sum(step.interlock is not None for step in chart.steps) if chart.sequences else None,
        supervisions=sum(step.supervision is not None for step in chart.steps) if chart.sequences else None,
        graph_version=chart.graph_settings.version if chart.graph_settings is not None else None,
    )


def _characters(data: bytes, kind: Format) -> tuple[str, str]:
    """Encoding and line ends, as people name them."""
    codec, mark = "utf-8", data.startswith(b"\xef\xbb\xbf")
    if kind.text:
        codec = cast("TextCodec", kind.codec()).decode(data).encoding.removesuffix("-sig")
    if kind.xml:
        from plcopen_sfc.formats.xml.xml_parsing import detect_encoding  # noqa: PLC0415  # only for XML

        encoding = detect_encoding(data)
        codec, mark = encoding.codec, bool(encoding.bom)
    start = data[:100_000].replace(b"\0", b"")
    pairs, feeds = start.count(b"\r\n"), start.count(b"\n")
    line_ends = "LF" if not pairs else "CRLF" if pairs == feeds else "CRLF and LF"
    return codec.upper() + (" with BOM" if mark else ""), line_ends
