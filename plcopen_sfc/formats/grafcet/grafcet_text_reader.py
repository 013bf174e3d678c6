"""Reads ``grafcet-text``: the project, and the place of each object. `grafcet_text_codec` is the way back.

Each line is a statement of its own; `docs/formats/grafcet-text.md` has the grammar. A text in quotation marks is a
comment, as in drawings of GRAFCETs: at the end of a line, or in the lines below it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location, StructureError, nearest
from plcopen_sfc.formats.remainder_comments import DAMAGED, OUTDATED, put_back, read_entries
from plcopen_sfc.formats.text_encoding import SourceText
from plcopen_sfc.formats.text_patch import BlockSpan, Key, ReadText, numbered
from plcopen_sfc.languages.declarations import read_declarations
from plcopen_sfc.languages.grafcet_conditions import separated
from plcopen_sfc.languages.st.lexer import Comment, CommentKind
from plcopen_sfc.model import sfc
from plcopen_sfc.model.actions import ActionKind, ForcedSituation, ForcingOrder
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.times import objection
from plcopen_sfc.model.types import Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.whole_numbers import whole_number

TABLES = {"INPUTS": SectionKind.INPUT, "OUTPUTS": SectionKind.OUTPUT, "INTERNALS": SectionKind.LOCAL}
"""Heads of variable tables."""
CHARTS = {
    "CHART": sfc.PartialChartKind.GLOBAL,
    "EXPANSION": sfc.PartialChartKind.EXPANSION,
    "ENCLOSED": sfc.PartialChartKind.ENCLOSED,
}
"""Heads of partial charts."""
SITUATIONS = {"INIT": ForcedSituation.INITIAL, "": ForcedSituation.EMPTY, "*": ForcedSituation.CURRENT}
"""Forced situations as they are in braces; other words there are names of steps."""
STORED = {"ACTIVATION": ActionKind.ON_ACTIVATION, "DEACTIVATION": ActionKind.ON_DEACTIVATION}
"""Words behind ON."""

_LINE = re.compile(r"[^\r\n]*")
_COMMENT = re.compile(r'(?:^|(?<=\s))"(?P<comment>(?:[^"]|"")*)"$')
_OWN = re.compile(r"//\s*(\{plcopen_sfc\b.*)")
_NAMES = r"[^\s,{}()]+(?:\s*,\s*[^\s,{}()]+)*"
_HEAD = re.compile(r"GRAFCET\s+(?P<name>\S+)(?P<block>\s+AS\s+FUNCTION_BLOCK)?$")
_TABLE = re.compile(rf"(?P<word>{'|'.join(TABLES)})$")
_CHART = re.compile(
    rf"(?P<word>{'|'.join(CHARTS)})\s+(?P<name>\S+)(?:\s+FROM\s+(?P<entry>\S+))?(?:\s+TO\s+(?P<exit>\S+))?$"
)
_STEP = re.compile(
    r"(?P<initial>INITIAL\s+)?(?:STEP|(?P<macro>MACRO))\s+(?P<name>\S+?)(?:\s+#(?P<number>\d+))?"
    r"(?:\s+EXPANDS\s+(?P<expansion>\S+))?(?:\s+ENCLOSES\s+(?P<enclosed>.+))?$"
)
_TRANSITION = re.compile(
    rf"(?:\((?P<name>[^()]+)\)\s*)?(?P<sources>{_NAMES})?\s*->(?:\s*(?P<targets>{_NAMES}))?\s*(?::(?P<condition>.*))?$"
)
_OTHER_ARROW = re.compile(rf"(?P<before>(?:\([^()]+\)\s*)?(?:{_NAMES})?\s*)(?:--+>|=+>|[–—]>|→|⇒|➔)(?=\s*{_NAMES})")
_NO_COLON = re.compile(rf"(?P<steps>(?:{_NAMES})?\s*->\s*{_NAMES})\s+(?P<condition>[^:>]+)$")
_VARIABLE = re.compile(r"(?P<name>[^\s:]+)(?:\s+(?P<address>%\S+))?\s*(?::(?P<type>.*))?$")
_ADDRESS = re.compile(
    r"%(?:[EA][XBWDL]?\d+(?:\.[0-7])?|(?:[IQM][XBWDL]?|DB\d+\.DB[XBWD])(?:\*|\d+(?:\.\d+)*))", re.IGNORECASE
)
"""Tools that address words count bits up to 15; the German letters are of S7, which addresses bytes."""
_SEVERAL = re.compile(_NAMES)
_FORCE = re.compile(r"FORCE\s+(?P<chart>[^\s{}]+)\s*\{(?P<situation>[^{}]*)\}$")
_ON = re.compile(rf"ON\s+(?:(?P<when>{'|'.join(STORED)})|EVENT\s+(?P<event>.+?)\s*:(?!=))\s+(?P<done>.+)$")
_CONTINUOUS = re.compile(
    r"(?P<done>\{.*\}|.+?)(?:\s+IF\s+(?P<condition>.+?))?(?:\s+(?P<kind>AFTER|FOR)\s+(?P<duration>\S+(?:\s*\w+)?))?$"
)
_LATE = re.compile(rf"(?P<done>[^\s{{}}].*?)\s+ON\s+(?P<when>{'|'.join(STORED)}|EVENT\b.*)$")
_COUNTED = re.compile(r"(?P<on>ON\s+(?:ACTIVATION|DEACTIVATION)\s+)?(?P<name>\w+)\s*(?P<sign>[-+])(?P=sign)$")
_EQUAL = re.compile(r"(?P<on>ON\s+(?:ACTIVATION|DEACTIVATION)\s+)?(?P<name>\w+)\s*=\s*(?P<value>.+)$")
_EVENT = re.compile(r"ON\s+EVENT\s+(?P<event>[^\s:]+)\s+(?P<done>[^\s:]+\s*:=.*)$")
_NUMBER = re.compile(r"\d+(?:[.,]\d+)?")
_DONE = re.compile(r"(?:\{(?P<body>.*)\}|(?P<target>[^\s:={}]+)(?:\s*:=\s*(?P<value>.+))?)$")
_ENCLOSURE = re.compile(r"(?P<chart>[^\s{},]+)\s*(?:\{(?P<steps>[^{}]*)\})?")
_REMAINDER_CODES = {DAMAGED: "GRF202", OUTDATED: "GRF203"}


@dataclass
class GrafcetText(ReadText):
    """A GRAFCET that was read; `lines` has those of its objects by their paths."""

    lines: dict[str, int] = field(default_factory=dict)


@dataclass
class _Place:
    """An object in the text, while it grows."""

    key: Key
    start: int
    end: int
    inner: list[_Place] = field(default_factory=list)
    commented: Callable[[str], None] | None = None

    def span(self, key: Key) -> BlockSpan:
        inner = zip(self.inner, numbered([place.key for place in self.inner]), strict=True)
        return BlockSpan((key,), (self.start, self.end), tuple(place.span(own) for place, own in inner))


@dataclass
class _Chart:
    """A network, with what refers to steps by name until all are known."""

    network: sfc.SfcNetwork
    path: str
    place: _Place
    ids: dict[str, int] = field(default_factory=dict)
    waiting: list[tuple[sfc.Transition, list[str], list[str], int]] = field(default_factory=list)
    action_lines: list[int] = field(default_factory=list)
    last_id: int = 0

    def new_id(self) -> int:
        self.last_id += 1
        return self.last_id


def is_address(text: str) -> bool:
    """Return True if a variable can have an address."""
    return _ADDRESS.fullmatch(text) is not None


def read_text(source: SourceText, file: str | None = None) -> GrafcetText:
    """Read a text. Raises `StructureError` at the first line that is not valid in a GRAFCET."""
    return _Reader(source, file).run()


class _Reader:
    def __init__(self, source: SourceText, file: str | None) -> None:
        self._text = source.text
        self._file = file
        self._project = Project()
        self._diagnostics: list[Diagnostic] = []
        self._own: list[Comment] = []
        self._lines: dict[str, int] = {}
        self._number = 0
        self._file_place = _Place(("file", ""), 0, len(self._text))
        self._around: list[_Place] = [self._file_place]
        self._pou: Pou | None = None
        self._root: _Chart | None = None
        self._chart: _Chart | None = None
        self._section: VariableSection | None = None
        self._step: sfc.Step | None = None

    def run(self) -> GrafcetText:
        position = 1 if self._text.startswith("\ufeff") else 0
        while position < len(self._text):
            found = _LINE.match(self._text, position)
            line = found.group() if found is not None else ""
            self._number += 1
            stripped = line.strip()
            if stripped:
                start = position + line.index(stripped)
                self._statement(stripped, start)
            position += len(line)
            position += 2 if self._text.startswith("\r\n", position) else 1
        self._finish_grafcet()
        if not self._project.pous:
            raise self._wrong("a text begins with GRAFCET and its name", _BEGINNING)
        entries = read_entries(self._own, _OWN, self._remainder_note)
        project = put_back(self._project, entries, self._remainder_note) if entries else self._project
        return GrafcetText(project, self._file_place.span(("file", "")), self._diagnostics, self._lines)

    # -- lines

    def _statement(self, line: str, start: int) -> None:
        """Read a line, without blanks around it, that begins at an offset. Raises `StructureError` for any other."""
        end = start + len(line)
        if line.startswith("//"):
            if not _OWN.match(line):
                raise self._wrong('a comment is a text in quotation marks: ".."')
            self._own.append(Comment(CommentKind.LINE, line, (start, end)))
            if self._file_place.inner and self._file_place.inner[-1].key[0] == "rest":
                self._file_place.inner[-1].end = end
            else:
                self._file_place.inner.append(_Place(("rest", ""), start, end))
            return
        if line.count('"') % 2:
            raise self._wrong(f"a quotation mark is missing in {line!r}", 'Write comments as: a -> b : c "text"')
        comment = _COMMENT.search(line)
        if comment is not None and not line[: comment.start()].strip():
            self._comment_below(comment["comment"], end)
            return
        content = line[: comment.start()].rstrip() if comment is not None else line
        comment_text = comment["comment"].replace('""', '"') if comment is not None else None
        if (found := _HEAD.match(content)) is not None:
            self._grafcet(found, comment_text, start, end)
        elif self._root is None:
            what = f"a text begins with GRAFCET and its name, not with {content.split()[0]!r}"
            raise self._wrong(what, _BEGINNING)
        elif (found := _TABLE.match(content)) is not None:
            self._table(found, comment_text, start, end)
        elif (found := _CHART.match(content)) is not None:
            self._partial(found, comment_text, start, end)
        elif (found := _STEP.match(content)) is not None:
            self._new_step(found, comment_text, start, end)
        elif (found := _TRANSITION.match(content)) is not None:
            self._transition(found, comment_text, start, end)
        elif (found := _OTHER_ARROW.match(content)) is not None:
            rest = content[found.end() :].strip()
            shown = f"{found['before'].strip()} -> {rest}".strip()
            raise self._wrong(f"{content!r} is no transition", f"Write the arrow ->: {shown}")
        elif "->" in content.partition(":")[0]:
            hint = "A transition leads from steps to steps: 1 -> 2 : condition, 1, 2 -> 3 : condition"
            if (found := _NO_COLON.match(content)) is not None:
                hint = f"Write a colon before the condition: {found['steps']} : {found['condition']}"
            raise self._wrong(f"{content!r} is no transition", hint)
        elif self._section is not None and (found := _VARIABLE.match(content)) is not None:
            self._variable(found, comment_text, start, end)
        elif self._step is not None:
            self._action(content, comment_text, start, end)
        else:
            raise self._wrong(f"{content!r} belongs to no step and to no table of variables")

    def _comment_below(self, text: str, end: int) -> None:
        """Add a line to the comment of what is above it."""
        place = self._around[-1]
        while place.inner:
            place = place.inner[-1]
        if place.commented is None:
            raise self._wrong("this comment is of nothing: it belongs below what it is about")
        place.commented(text.replace('""', '"'))
        for each in [*self._around[1:], place]:
            each.end = max(each.end, end)
        self._extend(self._file_place, end)

    def _extend(self, place: _Place, end: int) -> None:
        if place.inner:
            place.inner[-1].end = max(place.inner[-1].end, end)
            self._extend(place.inner[-1], end)

    def _add(self, key: Key, start: int, end: int, depth: int) -> _Place:
        """Add a place below the first `depth` places that are open, and open it."""
        del self._around[depth:]
        place = _Place(key, start, end)
        self._around[-1].inner.append(place)
        self._around.append(place)
        for each in self._around[1:]:
            each.end = end
        return place

    def _head(self, place: _Place, owner: _Commented, comment_text: str | None, start: int, end: int) -> None:
        """Add the line that begins `place`."""
        owner.comment = comment_text
        head = _Place(("head", ""), start, end, commented=_adding(owner))
        place.inner.append(head)

    def _note_line(self, path: str) -> None:
        self._lines.setdefault(path, self._number)

    # -- statements

    def _grafcet(self, found: re.Match[str], comment_text: str | None, start: int, end: int) -> None:
        self._finish_grafcet()
        if any(each.name.casefold() == found["name"].casefold() for each in self._project.pous):
            raise self._wrong(f"there is a GRAFCET {found['name']} already", "Rename one of them.")
        network = sfc.SfcNetwork()
        kind = PouKind.FUNCTION_BLOCK if found["block"] else PouKind.PROGRAM
        self._pou = Pou(name=found["name"], kind=kind, bodies=[sfc.SfcBody(chart=network)])
        network = self._pou.chart or network
        if not self._project.pous:
            self._project.name = found["name"]
        self._project.pous.append(self._pou)
        place = self._add(("grafcet", found["name"]), start, end, 1)
        self._head(place, self._pou, comment_text, start, end)
        self._root = self._chart = _Chart(network, f"POU {found['name']}", place)
        self._note_line(self._root.path)

    def _table(self, found: re.Match[str], comment_text: str | None, start: int, end: int) -> None:
        if self._pou is None or self._chart is not self._root or self._step is not None:
            raise self._wrong("tables of variables come before steps and charts")
        self._section = VariableSection(kind=TABLES[found["word"]])
        if self._pou.interface is None:
            self._pou.interface = Interface()
        self._pou.interface.sections.append(self._section)
        place = self._add(("table", found["word"]), start, end, 2)
        self._head(place, self._section, comment_text, start, end)

    def _variable(self, found: re.Match[str], comment_text: str | None, start: int, end: int) -> None:
        assert self._section is not None  # noqa: S101  # the caller has looked
        if _NUMBER.fullmatch(found["name"]):
            raise self._wrong(f"{found['name']!r} is a number and no name", "Write: name %I0.0 : TYPE := value")
        if any(each.name.casefold() == found["name"].casefold() for each in self._variables()):
            raise self._wrong(f"there is a variable {found['name']} already", "Remove one of the lines, or rename it.")
        address = f" AT {found['address']}" if found["address"] else ""
        type_ = (found["type"] or "BOOL").strip()
        # a declaration of another name: people call variables what is no identifier (``2s/X3``)
        declared = read_declarations(f"VAR x{address} : {type_}; END_VAR")
        variables = [variable for section in declared.sections for variable in section.variables]
        if declared.problems or len(variables) != 1:
            why = declared.problems[0].message if declared.problems else "a line declares one variable"
            raise self._wrong(f"this is no declaration: {why}", "Write: name %I0.0 : TYPE := value")
        if found["address"] and not is_address(found["address"]):
            raise self._wrong(f"{found['address']!r} is no address", _ADDRESSES)
        variable: Variable = variables[0]
        variable.name = found["name"]
        self._section.variables.append(variable)
        self._note_line(f"{self._opened().path} / variable {variable.name}")
        place = self._add(("variable", variable.name), start, end, 3)
        variable.comment = comment_text
        place.commented = _adding(variable)

    def _variables(self) -> Iterator[Variable]:
        interface = self._pou.interface if self._pou is not None else None
        for section in sections_of(interface):
            yield from section.variables

    def _partial(self, found: re.Match[str], comment_text: str | None, start: int, end: int) -> None:
        assert self._root is not None  # noqa: S101  # the caller has looked
        self._finish_chart()
        partial = sfc.PartialChart(
            name=found["name"],
            kind=CHARTS[found["word"]],
            chart=sfc.SfcNetwork(),
            entry_step=found["entry"],
            exit_step=found["exit"],
        )
        if (found["entry"] or found["exit"]) and partial.kind is not sfc.PartialChartKind.EXPANSION:
            raise self._wrong("only an expansion has an entry and an exit step")
        if any(each.name.casefold() == partial.name.casefold() for each in self._root.network.partial_charts):
            raise self._wrong(f"there is a chart {partial.name} already")
        self._root.network.partial_charts.append(partial)
        place = self._add(("chart", partial.name), start, end, 2)
        self._head(place, partial, comment_text, start, end)
        self._chart = _Chart(partial.chart, f"{self._root.path} / {partial.name}", place)
        self._note_line(self._chart.path)

    def _new_step(self, found: re.Match[str], comment_text: str | None, start: int, end: int) -> None:
        chart = self._opened()
        name = found["name"]
        if name.casefold() in chart.ids:
            raise self._wrong(f"there is a step {name} in this chart already")
        step = sfc.Step(id=chart.new_id(), name=name, initial=found["initial"] is not None)
        step.number = whole_number(found["number"])
        if found["number"] and step.number is None:
            raise self._wrong(f"the number of the step {name} has more digits than any tool takes")
        if found["macro"] is not None:
            step.macro = sfc.Macro(expansion=found["expansion"] or name)
        elif found["expansion"] is not None:
            raise self._wrong("only a macro-step has an expansion", f"Write: MACRO {name} EXPANDS {found['expansion']}")
        if found["enclosed"] is not None:
            step.encloses = self._enclosures(found["enclosed"])
        chart.ids[name.casefold()] = step.id
        chart.network.steps.append(step)
        place = self._add(("step", name), start, end, self._depth())
        self._head(place, step, comment_text, start, end)
        self._step, self._section = step, None
        self._note_line(f"{chart.path} / step {name}")

    def _depth(self) -> int:
        return 2 if self._chart is self._root else 3

    def _opened(self) -> _Chart:
        assert self._chart is not None  # noqa: S101  # there is a head before every statement
        return self._chart

    def _enclosures(self, text: str) -> list[sfc.Enclosure]:
        rest = _ENCLOSURE.sub("", text).replace(",", "").strip()
        if rest:
            raise self._wrong(f"{rest!r} encloses nothing", "Write: ENCLOSES G2{10, 12}, G3")
        return [
            sfc.Enclosure(chart=found["chart"], activated_steps=_names(found["steps"]))
            for found in _ENCLOSURE.finditer(text)
        ]

    def _transition(self, found: re.Match[str], comment_text: str | None, start: int, end: int) -> None:
        chart = self._opened()
        condition = (found["condition"] or "").strip()
        transition = sfc.Transition(id=chart.new_id(), comment=comment_text)
        designation = (found["name"] or "").strip()
        transition.number = whole_number(designation)
        if transition.number is None:
            transition.name = designation
        transition.condition = Expression(text=condition) if condition else None
        sources, targets = _names(found["sources"]), _names(found["targets"])
        for names in (sources, targets):
            if twice := next((name for name in names if [*map(str.casefold, names)].count(name.casefold()) > 1), ""):
                raise self._wrong(f"the transition names the step {twice} twice", "Name it once.")
        if found["name"] is not None and not designation:
            raise self._wrong("the designation of the transition is empty", "Write: (name) 1 -> 2, or 1 -> 2.")
        chart.network.transitions.append(transition)
        chart.waiting.append((transition, sources, targets, self._number))
        place = self._add(("transition", f"{','.join(sources)} -> {','.join(targets)}"), start, end, self._depth())
        place.commented = _adding(transition)
        self._step, self._section = None, None

    def _action(self, content: str, comment_text: str | None, start: int, end: int) -> None:
        chart = self._opened()
        if instead := _instead(content):
            raise self._wrong(f"{content!r} is no action", instead)
        assert self._step is not None  # noqa: S101  # the caller has looked
        action = sfc.ActionAssociation(id=chart.new_id(), comment=comment_text)
        if (found := _FORCE.match(content)) is not None:
            inside = found["situation"].strip()
            situation = SITUATIONS.get(inside.upper(), ForcedSituation.EXPLICIT)
            steps = _names(inside) if situation is ForcedSituation.EXPLICIT else []
            if steps and not _SEVERAL.fullmatch(inside):
                raise self._wrong(f"{content!r} names no steps", "Write: FORCE G1{INIT}, {10, 12}, {*} or {}.")
            action.kind = ActionKind.FORCING
            action.forcing = ForcingOrder(chart=found["chart"], situation=situation, steps=steps)
        elif (found := _ON.match(content)) is not None:
            action.kind = STORED[found["when"]] if found["when"] else ActionKind.ON_EVENT
            if found["event"]:
                action.condition = Expression(text=found["event"])
            self._done(action, found["done"])
        elif content.split(maxsplit=1)[0] not in ("FORCE", "ON") and (found := _CONTINUOUS.match(content)) is not None:
            action.kind = ActionKind.CONDITIONAL if found["condition"] else ActionKind.CONTINUOUS
            if found["kind"]:
                action.kind = ActionKind.DELAYED if found["kind"] == "AFTER" else ActionKind.LIMITED
                duration = _literal(found["duration"])
                if why := objection(duration):
                    raise self._wrong(f"the time of {content!r} is wrong: {why}", _ACTIONS)
                action.duration = duration
            if found["condition"]:
                action.condition = Expression(text=found["condition"])
            self._done(action, found["done"])
        else:
            raise self._wrong(f"{content!r} is no action", _ACTIONS)
        self._step.actions.append(action)
        place = self._add(("action", ""), start, end, self._depth() + 1)
        place.commented = _adding(action)
        chart.action_lines.append(self._number)

    def _done(self, action: sfc.ActionAssociation, text: str) -> None:
        found = _DONE.match(text.strip())
        if found is None:
            raise self._wrong(f"{text!r} is no action", _ACTIONS)
        if found["target"] is not None and _NUMBER.fullmatch(found["target"]):
            raise self._wrong(f"{found['target']!r} is a number and no variable", _ACTIONS)
        if found["body"] is not None:
            action.body = StBody(text=found["body"].strip())
        else:
            action.target = found["target"]
            action.value = found["value"]

    # -- ends

    def _finish_chart(self) -> None:
        chart = self._chart
        if chart is not None:
            lines = iter(chart.action_lines)  # actions are in the order of the text, as their steps are
            for step in chart.network.steps:
                for label in step.action_labels():
                    self._lines[f"{chart.path} / step {step.name} / action {label}"] = next(lines)
            for transition, sources, targets, line in chart.waiting:
                transition.sources = [self._id_of(chart, name, line) for name in sources]
                transition.targets = [self._id_of(chart, name, line) for name in targets]
            labels = chart.network.labels()
            for transition, _, _, line in chart.waiting:
                self._lines.setdefault(f"{chart.path} / transition {labels[transition.id]}", line)
        self._step = self._section = None

    def _id_of(self, chart: _Chart, name: str, line: int) -> int:
        found = chart.ids.get(name.casefold())
        if found is None:
            known = [step.name for step in chart.network.steps]
            raise StructureError(
                f"unknown step {name!r}{nearest(name, known)}",
                location=Location(self._file, line, path=chart.path),
                hint=f"The steps of this chart are {', '.join(known) or 'missing'}.",
            )
        return found

    def _finish_grafcet(self) -> None:
        self._finish_chart()
        if self._root is None:
            return
        partials = {partial.name.casefold(): partial for partial in self._root.network.partial_charts}
        for partial in partials.values():
            if partial.kind is sfc.PartialChartKind.EXPANSION:
                names = [step.name for step in partial.chart.steps]
                partial.entry_step = partial.entry_step or next((each for each in names if each[:1] in "Ee"), None)
                partial.exit_step = partial.exit_step or next((each for each in names if each[:1] in "Ss"), None)
        self._separate(self._root.network)
        for variable in self._variables():  # findings in their types have no "variable"; charts come first
            line = self._lines[f"{self._root.path} / variable {variable.name}"]
            self._lines.setdefault(f"{self._root.path} / {variable.name}", line)
        self._root = self._chart = None

    def _separate(self, network: sfc.SfcNetwork) -> None:
        """Put blanks beside the dots between variables and flags, which are AND: ``a.b`` alone is a member of ``a``."""
        charts = [network, *(partial.chart for partial in network.partial_charts)]
        known = {f"x{step.name.casefold()}" for chart in charts for step in chart.steps}
        known |= {f"x{partial.name.casefold()}" for partial in network.partial_charts}
        for variable in self._variables():
            if variable.type == ElementaryType(name=Elementary.BOOL):
                known.add(variable.name.casefold())
            else:
                known.discard(variable.name.casefold())

        for chart in charts:
            conditions = [transition.condition for transition in chart.transitions]
            conditions += [action.condition for step in chart.steps for action in step.actions]
            for condition in conditions:
                if isinstance(condition, Expression) and '"' not in condition.text:
                    condition.text = separated(condition.text, known)

    def _wrong(self, message: str, hint: str = "") -> StructureError:
        return StructureError(message, location=Location(self._file, self._number or 1), hint=hint)

    def _remainder_note(self, kind: str, message: str, offset: int) -> None:
        line = self._text.count("\n", 0, offset) + 1
        where = Location(self._file, line)
        self._diagnostics.append(Diagnostic(_REMAINDER_CODES[kind], Severity.WARNING, message, where))


_ADDRESSES = "Addresses begin with %I, %Q or %M: %I0.0, %QW2, %M20.0; %E and %A are those of S7."
_BEGINNING = "Write a first line such as: GRAFCET Pump"
_ACTIONS = (
    "Actions are: Q | Q IF condition | Q AFTER 3s | Q FOR 3s | ON ACTIVATION Q := value | ON DEACTIVATION Q := value | "
    "ON EVENT ↑a : Q := value | FORCE G1{INIT}"
)


def _instead(content: str) -> str:
    """Return a hint for a line that people take for an action; empty if there is none."""
    if (found := _LATE.match(content)) is not None:
        return f"Write: ON {found['when']} {found['done']}"
    if (found := _COUNTED.match(content)) is not None:
        return f"Write: {found['on'] or 'ON ACTIVATION '}{found['name']} := {found['name']} {found['sign']} 1"
    if (found := _EQUAL.match(content)) is not None:
        return f"Write: {found['on'] or 'ON ACTIVATION '}{found['name']} := {found['value']}"
    if (found := _EVENT.match(content)) is not None:
        return f"Write a colon behind the event: ON EVENT {found['event']} : {found['done']}"
    return ""


_Commented = Pou | VariableSection | sfc.PartialChart | sfc.Step | sfc.Transition | sfc.ActionAssociation | Variable


def _adding(owner: _Commented) -> Callable[[str], None]:
    """Return a function that adds a line to the comment of `owner`."""

    def add(line: str) -> None:
        owner.comment = line if owner.comment is None else f"{owner.comment}\n{line}"

    return add


def _names(text: str | None) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()] if text else []


def _literal(text: str) -> str:
    compact = "".join(text.split())
    return f"T#{compact.replace(',', '.').replace('min', 'm')}" if re.match(r"\d", compact) else compact
