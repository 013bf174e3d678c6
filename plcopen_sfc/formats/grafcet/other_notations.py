"""Notations of other tools for GRAFCETs, as the text that `grafcet_text_reader` reads: each line with its line there.

grafcet2plc (seen: one file of 46 steps)::

    %DETAILS (X1, X6)        a chart, and its initial steps
    X2 [Pump; Lamp] "full"   a step with actions and a comment; a line that ends with \\ goes on in the next
    Y3 [a.T/X3/5 d/]         a transition: . + / and, or, not; > < edges; T/x/5 d/ a delay (d, c, z: 0.1, 0.01, 10 s)
    X1 > Y3                  an arc

Grafcet_to_Automaton (seen: one file)::

    <PARTIAL Name = G1 > <STEPS> 10 : Initial ; 11 ; </STEPS>
    <TRANSITIONS> t1 : 10 : 11 : /a.b ; </TRANSITIONS> <ACTIONS> A1 : Continuous : 10 : Q : a ; </ACTIONS> </PARTIAL>

Both give a name of letters, digits and underscores everywhere. What was not seen in a file is refused with its line.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from plcopen_sfc.errors import Location, StructureError
from plcopen_sfc.languages.grafcet_conditions import NAME

GRAFCET2PLC = re.compile(r"\A\ufeff?\s*%\w+[ \t]*\([ \t]*X\d")
TO_AUTOMATON = re.compile(r"(?m)^[ \t]*<GRAFCET>[ \t]*\r?$")
"""Marks that only texts in these notations have."""


@dataclass
class ReadNotation:
    """A text in the words of this package. `lines` has the line in the file for each of its lines."""

    lines: list[int] = field(default_factory=list)
    parts: list[str] = field(default_factory=list)

    def add(self, text: str, line: int) -> None:
        """Append a line."""
        self.parts.append(text)
        self.lines.append(line)

    @property
    def text(self) -> str:
        """The whole text."""
        return "\n".join(self.parts) + "\n"


def translated(text: str, file: str | None = None) -> ReadNotation | None:
    """Return a text in another notation in the words of this package; None for one that is in no other.

    Raises `StructureError` at the first line that is not valid in the notation.
    """
    if GRAFCET2PLC.match(text):
        return _Grafcet2Plc(file).read(text)
    if TO_AUTOMATON.search(text):
        return _ToAutomaton(file).read(text)
    return None


def _quoted(text: str) -> str:
    doubled = " ".join(text.split()).replace('"', '""')
    return f' "{doubled}"' if doubled else ""


_UNITS = {"s": 1000, "d": 100, "c": 10, "z": 10_000}
_DELAY = re.compile(r"(?<!\w)T/(?P<operand>.+?)/\s*(?P<time>\d+(?:\.\d+)?)\s*(?P<unit>[sdcz])\s*/")
_ALONE = re.compile(rf"{NAME}|\([^()]*\)")
_EDGE = re.compile(r"(^|[.+(/*\s])([<>])(?=\s*[\w(/])")


def _condition(text: str) -> str:
    """Return a condition in the words of this package."""

    def delay(found: re.Match[str]) -> str:
        time = float(found["time"]) * _UNITS[found["unit"]]
        operand = _condition(found["operand"])
        shown = f"{time:g}ms" if time % 1000 else f"{time / 1000:g}s"
        return f"{shown}/{operand if _ALONE.fullmatch(operand) else f'({operand})'}"

    parts, end = [], 0
    for found in _DELAY.finditer(text):
        parts += [_plain(text[end : found.start()]), delay(found)]
        end = found.end()
    return "".join([*parts, _plain(text[end:])]).strip() or "1"


def _plain(text: str) -> str:
    edges = _EDGE.sub(lambda found: found[1] + ("↑" if found[2] == ">" else "↓"), text)
    return re.sub(r"(?<!\d)\.|\.(?!\d)", " * ", edges)


class _Notation:
    def __init__(self, file: str | None) -> None:
        self._file = file
        self._made = ReadNotation()

    def wrong(self, message: str, line: int, hint: str = "") -> StructureError:
        """Return the error for a line."""
        return StructureError(message, location=Location(self._file, line), hint=hint)


_STEP_LINE = re.compile(r'X(?P<name>\d+)\s*(?:\[(?P<actions>[^\]]*)\])?\s*(?:"(?P<comment>[^"]*)")?\s*$')
_TRANSITION_LINE = re.compile(r'Y(?P<name>\d+)\s*(?:\[(?P<condition>.*)\])?\s*(?:"(?P<comment>[^"]*)")?\s*$')
_ARC_LINE = re.compile(r"(?P<source>[XY]\d+)\s*>\s*(?P<target>[XY]\d+)$")
_CHART_LINE = re.compile(r"%(?P<name>\w+)\s*\((?P<initial>[^)]*)\)$")


@dataclass
class _Transition:
    line: int
    condition: str
    comment: str
    sources: list[str] = field(default_factory=list)
    targets: list[str] = field(default_factory=list)


class _Grafcet2Plc(_Notation):
    def read(self, text: str) -> ReadNotation:
        """Return the text; transitions are where the last of their arcs is known: behind all steps of their chart."""
        made = self._made
        made.add("GRAFCET Grafcet", 1)
        initial: set[str] = set()
        transitions: dict[str, _Transition] = {}
        for line, content in self._statements(text):
            if (found := _CHART_LINE.match(content)) is not None:
                self._transitions(transitions)
                transitions.clear()
                initial = {name.strip().removeprefix("X") for name in found["initial"].split(",")}
                made.add(f"CHART {found['name']}", line)
            elif (found := _STEP_LINE.match(content)) is not None:
                word = "INITIAL STEP" if found["name"] in initial else "STEP"
                made.add(f"    {word} {found['name']}{_quoted(found['comment'] or '')}", line)
                for action in filter(None, (each.strip() for each in (found["actions"] or "").split(";"))):
                    if not re.fullmatch(r"\w+", action):
                        raise self.wrong(f"{action!r} is no action: a name is one", line)
                    made.add(f"        {action}", line)
            elif (found := _TRANSITION_LINE.match(content)) is not None:
                comment_text = _quoted(found["comment"] or "")
                transitions[found["name"]] = _Transition(line, _condition(found["condition"] or ""), comment_text)
            elif (found := _ARC_LINE.match(content)) is not None:
                self._arc(found["source"], found["target"], transitions, line)
            else:
                hint = 'Lines are: %NAME (X1) | X2 [Action; Action] "comment" | Y3 [condition] | X1 > Y3 | Y3 > X2'
                raise self.wrong(f"{content!r} is no line of this notation", line, hint)
        self._transitions(transitions)
        return made

    def _statements(self, text: str) -> Iterator[tuple[int, str]]:
        """Yield the lines with their numbers; those that go on are one."""
        whole, start = "", 0
        for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), 1):
            start = start if whole else number
            whole = f"{whole} {line.strip()}".strip()
            if whole.endswith("\\"):
                whole = whole[:-1].rstrip()
            elif whole:
                yield start, whole
                whole = ""
        if whole:
            yield start, whole

    def _arc(self, source: str, target: str, transitions: dict[str, _Transition], line: int) -> None:
        from_step = source.startswith("X")
        name = (target if from_step else source)[1:]
        if from_step is target.startswith("X") or name not in transitions:
            why = "joins no step with a transition" if from_step is target.startswith("X") else f"Y{name} is unknown"
            raise self.wrong(f"{source} > {target}: {why}", line)
        ends = transitions[name].sources if from_step else transitions[name].targets
        ends.append((source if from_step else target)[1:])

    def _transitions(self, transitions: dict[str, _Transition]) -> None:
        for name, each in transitions.items():
            arrow = f"{', '.join(each.sources)} -> {', '.join(each.targets)}".strip()
            self._made.add(f"    ({name}) {arrow} : {each.condition}{each.comment}", each.line)


_TAG = re.compile(r"<(?P<end>/?)(?P<tag>\w+)(?P<rest>[^>]*)>")
_VARIABLES = ("INPUTS", "OUTPUTS")
_REMARK = re.compile(r"\(\*(.*?)\*\)", re.DOTALL)


class _ToAutomaton(_Notation):
    def read(self, text: str) -> ReadNotation:
        """Return the text."""
        made = self._made
        bare = re.sub(r"#[^\r\n]*", lambda found: " " * len(found[0]), text)
        info = re.search(r"<INFO>(.*?)</INFO>", bare, re.DOTALL)
        made.add("GRAFCET Grafcet" + _quoted(info[1] if info is not None else ""), 1)
        actions: list[tuple[int, list[str]]] = []
        steps: list[tuple[int, list[str]]] = []
        transitions: list[tuple[int, list[str]]] = []
        for tag, rest, inner, start in self._sections(bare):
            line = bare.count("\n", 0, start) + 1
            if tag in _VARIABLES:
                made.add(tag, line)
                for at, entry in self._entries(bare, inner):
                    comment_text = " ".join(each.strip() for each in _REMARK.findall(entry))
                    made.add(f"    {_REMARK.sub(' ', entry).strip()}{_quoted(comment_text)}", at)
            elif tag == "PARTIAL":
                name = re.search(r"=\s*(\S+)", rest)
                made.add(f"CHART {name[1] if name is not None else 'G'}", line)
            elif tag in ("STEPS", "TRANSITIONS", "ACTIONS"):
                found = {"STEPS": steps, "TRANSITIONS": transitions, "ACTIONS": actions}[tag]
                for at, entry in self._entries(bare, inner):
                    found.append((at, [part.strip() for part in _REMARK.sub(" ", entry).split(":")]))
            elif tag == "/PARTIAL":
                self._chart(steps, transitions, actions)
            elif tag not in ("INFO", "/INFO", "GRAFCET", "/GRAFCET", "CHARTS", "/CHARTS"):
                hint = "Sections are INFO, INPUTS, OUTPUTS, CHARTS, PARTIAL, STEPS, TRANSITIONS and ACTIONS."
                raise self.wrong(f"<{tag}> is no section that is known", line, hint)
        return made

    def _sections(self, text: str) -> Iterator[tuple[str, str, tuple[int, int], int]]:
        """Yield the tags: name, what else is in it, where its content is, and where it begins."""
        lists = (*_VARIABLES, "STEPS", "TRANSITIONS", "ACTIONS")
        found = _TAG.search(text)
        while found is not None:
            tag = found["end"] + found["tag"]
            end = found.end()
            if tag in (*lists, "INFO"):
                close = text.find(f"</{tag}>", end)
                if close < 0:
                    raise self.wrong(f"</{tag}> is missing", text.count("\n", 0, found.start()) + 1)
                yield tag, found["rest"], (end, close), found.start()
                end = close + len(tag) + 3
            else:
                yield tag, found["rest"], (end, end), found.start()
            found = _TAG.search(text, end)

    def _entries(self, text: str, inner: tuple[int, int]) -> Iterator[tuple[int, str]]:
        """Yield the texts that semicolons end, with their lines."""
        start, end = inner
        while start < end:
            stop = text.find(";", start, end)
            stop = stop if stop >= 0 else end
            entry = text[start:stop]
            if entry.strip():
                at = start + len(entry) - len(entry.lstrip())
                yield text.count("\n", 0, at) + 1, entry.strip()
            start = stop + 1

    def _chart(
        self,
        steps: list[tuple[int, list[str]]],
        transitions: list[tuple[int, list[str]]],
        actions: list[tuple[int, list[str]]],
    ) -> None:
        known = {fields[0] for _, fields in steps}
        for at, fields in actions:
            if len(fields) not in (4, 5) or fields[1] != "Continuous" or fields[2] not in known:
                hint = "Write: A1 : Continuous : step : output : condition ;"
                raise self.wrong(f"{' : '.join(fields)!r} is no action that is known", at, hint)
        for line, fields in steps:
            if fields[1:] not in ([], ["Initial"]):
                raise self.wrong(f"{' : '.join(fields)!r} is no step that is known", line, "Write: 10 : Initial ;")
            self._made.add(f"    {'INITIAL ' if fields[1:] else ''}STEP {fields[0]}", line)
            for at, (_, _, step, output, *guard) in actions:
                if step == fields[0]:
                    self._made.add(f"        {output}{f' IF {_condition(guard[0])}' if guard else ''}", at)
        for line, fields in transitions:
            if len(fields) != 4:
                hint = "Write: t1 : 10 : 11 : condition ;"
                raise self.wrong(f"{' : '.join(fields)!r} is no transition that is known", line, hint)
            name, sources, targets, condition = fields
            ends = [", ".join(filter(None, re.split(r"[\s,]+", each))) for each in (sources, targets)]
            self._made.add(f"    ({name}) {ends[0]} -> {ends[1]} : {_condition(condition)}", line)
        for each in (steps, transitions, actions):
            each.clear()
