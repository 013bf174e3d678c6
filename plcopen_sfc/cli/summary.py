"""Summaries of files and their charts: as numbers, and a chart as indented text.

The text goes from the top to the bottom of a chart, with branches indented:

[[Init]]
 |  Start AND NOT Fault
[Fill]  N Y1_Fill
 +-- Full
 |   [Stir]  D T#2s M1
 |    |  Stir.t > T#10s
 |   -> Drain
 +-- Stop
 |   -> Drain
[Drain]
 |  Empty
-> Init
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, cast

from plcopen_sfc.cli.screen import Line
from plcopen_sfc.documents.sources import FileSource, FolderSource, documents_of
from plcopen_sfc.drawing.wording import EXCLUDED, Wording
from plcopen_sfc.formats.registry import TIA_FORMAT, format_named
from plcopen_sfc.model.conditions import NamedCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork, Step, Transition, leaving_steps
from plcopen_sfc.semantics.profile import default_profile

if TYPE_CHECKING:
    from plcopen_sfc.formats.format_interface import Format
    from plcopen_sfc.formats.text_codec import TextCodec

_DEEPEST = 40
"""Branches inside of branches; what is deeper is printed at the end."""


@dataclass(frozen=True)
class _Signs:
    """The signs of the drawing: ``bar`` and ``last_bar`` begin a simultaneous branch, ``beside_bar`` runs along it."""

    down: str
    branch: str
    last_branch: str
    beside_branch: str
    bar: str
    last_bar: str
    beside_bar: str
    meet: str
    arrow: str


_ASCII = _Signs(" |  ", " +-- ", " +-- ", " |   ", " #== ", " #== ", " #   ", " === ", "-> ")
_UNICODE = _Signs(" │  ", " ├─ ", " └─ ", " │  ", " ╠═ ", " ╚═ ", " ║  ", " ═╦═ ", "→ ")
_MARGIN = "  "


def outline(chart: SfcNetwork, *, unicode: bool = False, dialect: Dialect = Dialect.IEC) -> list[Line]:
    """Return the lines of the outline of `chart`; with `unicode` in line-drawing characters, else in ASCII.

    `dialect` is that of the names in its networks.
    """
    return _Outline(chart, _UNICODE if unicode else _ASCII, dialect).run()


class _Outline:
    def __init__(self, chart: SfcNetwork, signs: _Signs, dialect: Dialect) -> None:
        self.chart = chart
        self.signs = signs
        self.words = Wording(chart, dialect)
        self.flow = _Flow(chart)
        self.steps = {step.id: step for step in chart.steps}
        self.lines: list[Line] = []
        self.told: dict[int, _Path] = {}  # steps
        self.told_transitions: set[int] = set()
        self.arrived: dict[int, dict[int, _Path]] = {}  # step: transition: where
        self.divergences = 0

    def run(self) -> list[Line]:
        for root in self.flow.roots:
            if root not in self.told:
                self._begin(root)
        for step in self.chart.steps:
            if step.id not in self.told:
                self._begin(step.id)
        for transition in self.chart.transitions:
            if transition.id not in self.told_transitions:
                self._orphan(transition)
        if not self.lines:
            self._line(_MARGIN, ("(empty)", "dim"))
        return self.lines

    # -- the walk -----------------------------------------------------------------------------------------------------

    def _begin(self, step: int) -> None:
        if self.lines:
            self._line("")
        entering = [t for t in self.chart.transitions if not t.sources and step in t.targets]
        for transition in entering:
            self._line(_MARGIN, ("(no step)", "red"))
            self._condition(transition, _MARGIN + self.signs.down)
            if len(transition.targets) > 1:
                self._line(_MARGIN, (self.signs.arrow, "dim"), self._names(transition.targets))
        self._sequence(step, _MARGIN, ())

    def _sequence(self, step: int, indent: str, path: _Path, first: str | None = None) -> None:
        """Print `step` and what follows in this branch. `first`: what is printed before it instead of `indent`."""
        following: int | None = step
        while following is not None:
            self._step(following, first if first is not None else indent, path)
            first = None
            leaving = self.flow.leaving[following]
            alone = [t for t in leaving if len(set(t.sources)) == 1]
            if len(leaving) == 1 and alone:
                self._condition(alone[0], indent + self.signs.down)
                following = self._after(alone[0], indent, path)
            elif leaving:
                self._branches(leaving, indent, path)
                following = self._going_on(indent, path)
            else:
                following = None
            if following is None:
                following = self._going_on(indent, path)

    def _branches(self, leaving: list[Transition], indent: str, path: _Path) -> None:
        """Print the branches of a selection. A transition that waits for other steps too is printed where they meet."""
        if len(leaving) == 1:
            return
        self.divergences += 1
        branch = self.divergences
        for number, transition in enumerate(leaving):
            last = number == len(leaving) - 1
            lead = indent + (self.signs.last_branch if last else self.signs.branch)
            inner = indent + (" " * len(self.signs.beside_branch) if last else self.signs.beside_branch)
            if len(set(transition.sources)) > 1:
                self._line(lead, ("together with ", "dim"), self._names(transition.sources))
                continue
            self._condition(transition, lead)
            where = (*path, (branch, number))
            following = self._after(transition, inner, where)
            if following is not None:
                self._sequence(following, inner, where)

    def _after(self, transition: Transition, indent: str, path: _Path) -> int | None:
        """Print what follows a transition; return the step to go on with in this branch, or None."""
        targets = list(dict.fromkeys(transition.targets))
        if len(targets) > 1:
            self._simultaneous(transition, targets, indent, path)
            return self._going_on(indent, path)
        if not targets:
            self._line(indent, (self.signs.arrow, "dim"), ("nowhere", "red"))
            return None
        target = targets[0]
        if self._arrives(transition, target, path):
            return target
        self._arrow(target, indent)
        return None

    def _simultaneous(self, transition: Transition, targets: list[int], indent: str, path: _Path) -> None:
        self.divergences += 1
        branch = self.divergences
        for number, target in enumerate(targets):
            last = number == len(targets) - 1
            lead = indent + (self.signs.last_bar if last else self.signs.bar)
            inner = indent + (" " * len(self.signs.beside_bar) if last else self.signs.beside_bar)
            where = (*path, (branch, number))
            if self._arrives(transition, target, where):
                self._sequence(target, inner, where, lead)
            else:
                self._arrow(target, lead)

    def _going_on(self, indent: str, path: _Path) -> int | None:
        """Return the step or the transition at which branches that were printed meet, to go on with."""
        for transition in self.chart.transitions:
            sources = set(transition.sources)
            if len(sources) < 2 or transition.id in self.told_transitions or not sources <= self.told.keys():
                continue
            if _common(self.told[source] for source in sources) != path:
                continue
            self._line(indent, (self.signs.meet, "dim"), self._names(transition.sources))
            self._condition(transition, indent + self.signs.down)
            following = self._after(transition, indent, path)
            if following is not None:
                return following
        for step, ways in self.arrived.items():
            if step not in self.told and self._complete(step) and _common(ways.values()) == path:
                return step
        return None

    def _arrives(self, transition: Transition, target: int, path: _Path) -> bool:
        """Note that a way leads to `target`; True if the outline goes on with it right here."""
        if target in self.told or target not in self.steps:
            return False
        ways = self.arrived.setdefault(target, {})
        ways[transition.id] = path
        return len(path) < _DEEPEST and self._complete(target) and _common(ways.values()) == path

    def _complete(self, step: int) -> bool:
        return self.flow.waits.get(step, set()) <= self.arrived.get(step, {}).keys()

    # -- the lines ----------------------------------------------------------------------------------------------------

    def _step(self, number: int, indent: str, path: _Path) -> None:
        step = self.steps[number]
        self.told[number] = path
        name = f"[[{step.name}]]" if step.initial else f"[{step.name}]"
        name = f"{name} {EXCLUDED}" if step.exclude else name
        actions = ", ".join(map(str, self.words.actions(step)))
        self._line(
            indent, (name, "bold green" if step.initial else "bold"), (f"  {actions}" if actions else "", "cyan")
        )

    def _condition(self, transition: Transition, lead: str) -> None:
        self.told_transitions.add(transition.id)
        text = self.words.condition(transition.condition)
        excluded = [(f" {EXCLUDED}", "dim")] if transition.exclude else []
        self._line(lead, (text, "") if text else ("(no condition)", "red"), *excluded)

    def _arrow(self, target: int, indent: str) -> None:
        self._line(indent, (self.signs.arrow, "dim"), self._names([target]))

    def _orphan(self, transition: Transition) -> None:
        """Print a transition that no way has reached: from steps that exist nowhere, or never meet."""
        self._line("")
        self._line(_MARGIN, self._names(transition.sources) if transition.sources else ("(no step)", "red"))
        self._condition(transition, _MARGIN + self.signs.down)
        self._line(
            _MARGIN,
            (self.signs.arrow, "dim"),
            self._names(transition.targets) if transition.targets else ("nowhere", "red"),
        )

    def _names(self, steps: list[int]) -> tuple[str, str]:
        names = (self.steps[step].name if step in self.steps else "(no step)" for step in dict.fromkeys(steps))
        return " & ".join(names), "bold"

    def _line(self, indent: str, *pieces: tuple[str, str]) -> None:
        self.lines.append([(indent, "dim"), *pieces])


_Path = tuple[tuple[int, int], ...]
"""The branches around something, outermost first: numbers of the divergence and of the branch in it."""


@dataclass
class _Flow:
    """The chart as a walk from its initial steps.

    `roots` are the steps where the walk begins. `waits` has for each step how many transitions lead to it without
    leading back: the outline goes on with it where the last of them has arrived.
    """

    chart: SfcNetwork
    leaving: dict[int, list[Transition]] = field(default_factory=dict)
    roots: list[int] = field(default_factory=list)
    waits: dict[int, set[int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        ids = {step.id for step in self.chart.steps}
        found = leaving_steps(self.chart.transitions)
        self.leaving = {step: found.get(step, []) for step in ids}
        self._walk(ids)

    def _starts(self) -> Iterable[int]:
        yield from (step.id for step in self.chart.steps if step.initial)
        for transition in self.chart.transitions:
            if not transition.sources:
                yield from transition.targets
        yield from (step.id for step in self.chart.steps)

    def _walk(self, ids: set[int]) -> None:
        """Depth first from every start that no earlier one reaches; a way to a step still being walked leads back."""
        group: dict[int, int] = {}
        for start in self._starts():
            if start in group or start not in ids:
                continue
            self.roots.append(start)
            group[start] = start
            active = {start}
            back: set[tuple[int, int]] = set()
            members = [start]
            stack = [(start, self._onward(start))]
            while stack:
                step, onward = stack[-1]
                if not onward:
                    active.discard(step)
                    stack.pop()
                    continue
                transition, target = onward.pop()
                if target in active:
                    back.add((transition, target))
                elif target in ids and target not in group:
                    group[target] = start
                    active.add(target)
                    members.append(target)
                    stack.append((target, self._onward(target)))
            for member in members:
                for transition, target in self._onward(member):
                    if group.get(target) == start and (transition, target) not in back:
                        self.waits.setdefault(target, set()).add(transition)

    def _onward(self, step: int) -> list[tuple[int, int]]:
        return [(t.id, target) for t in reversed(self.leaving[step]) for target in reversed(t.targets)]


def _common(paths: Iterable[_Path]) -> _Path:
    """Return the innermost place that all `paths` lie in."""
    shared: _Path | None = None
    for path in paths:
        if shared is None:
            shared = path
            continue
        length = next((i for i, (a, b) in enumerate(zip(shared, path, strict=False)) if a != b), None)
        shared = shared[: min(len(shared), len(path)) if length is None else length]
    return shared or ()


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
    TIA Portal only. `rules` is the name of the execution profile of its charts, `kept_of` that of the format whose tool
    had charts that a converted file keeps.
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
    rules: str | None = None
    kept_of: str | None = None
    charts: list[ChartSummary] = field(default_factory=list)

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        own = {each.name: getattr(self, each.name) for each in fields(self) if each.name != "charts"}
        own = {name: value for name, value in own.items() if value is not None}
        return own | {"charts": [chart.as_dict() for chart in self.charts], "totals": self.totals()}

    def totals(self) -> dict[str, int]:
        """Return the sums over all charts."""
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
        rules=default_profile(project).name if any(project.charts()) else None,
        kept_of=project.tool_format if project.is_converted else None,
        size=sum(map(len, contents)),
        pous=dict(Counter(pou.kind.value for pou in project.pous)),
        languages=dict(Counter(body.language for _, _, body in project.bodies())),
        charts=[_chart(name, pou_kind, chart) for name, pou_kind, chart in all_charts(project)],
    )


def _blocks(project: Project) -> list[str]:
    """Return the blocks that have a number, by kind and number."""
    blocks = [(_LETTERS.get(pou.kind, "FB"), pou.number, pou.name) for pou in project.pous]
    blocks += [("DB", block.number, block.name) for block in project.data_blocks]
    numbered = [(letters, number, name) for letters, number, name in blocks if number is not None]
    order = {letters: place for place, letters in enumerate((*_LETTERS.values(), "DB"))}
    numbered.sort(key=lambda block: (order[block[0]], block[1]))
    return [f"{letters} {number} {name}" for letters, number, name in numbered]


_LETTERS = {PouKind.ORGANIZATION_BLOCK: "OB", PouKind.FUNCTION_BLOCK: "FB", PouKind.FUNCTION: "FC"}


def _cultures(contents: list[bytes]) -> list[str]:
    """Return the languages of the texts in documents of TIA Portal, the most frequent first."""
    found: Counter[str] = Counter()
    for content in contents:
        found.update(name.decode("ascii") for name in _CULTURE.findall(content))
    return sorted(found, key=lambda name: (-found[name], name))


_CULTURE = re.compile(rb"(?:<Culture>|\bLang=[\"'])([A-Za-z]+-[A-Za-z-]+)")


def all_charts(project: Project) -> Iterator[tuple[str, str, SfcNetwork]]:
    """Yield every chart, those inside of macro-steps and actions too: its name, the kind of its POU, the chart."""
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
    yield from (a for a in step.step_actions.values() if not isinstance(a, str))


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
        step_actions=sum(1 for step in chart.steps for action in step.step_actions.values() if action),
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
