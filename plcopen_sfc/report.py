"""Results of conversions and renames: what became of each item, and which places were changed."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from types import MappingProxyType
from typing import Any, NamedTuple

from plcopen_sfc.object_path import ObjectPath


class Outcome(StrEnum):
    """Outcome of an item of the source."""

    KEPT = "kept"
    """Written exactly, in the target's own terms."""
    TRANSLATED = "translated"
    """Written in other terms that mean the same."""
    APPROXIMATED = "approximated"
    """Written in terms that mean nearly the same; the reason names the difference."""
    NOT_EXECUTED = "not executed"
    """The source tool executes it, the target tool does not, even if the file keeps it for the way back."""
    EXTENSION_DATA = "extension data"
    """Kept in the target's place for data of other tools. No machine executes it: titles, positions, ids."""
    DROPPED = "dropped"
    """Not in the target file."""


LOSSES = (Outcome.NOT_EXECUTED, Outcome.APPROXIMATED)
"""Outcomes that change the behaviour of the machine, the worst first: ``strict`` does not let them pass."""
CHART_OF_ACTION = "chart of an action"
"""Subject of items that tell of a block for the chart of an action; a run may show that it does the same."""
ORDER_OF_ACTIONS = "order of actions"
"""Subject of items that tell of actions that the target executes in another order in a scan; see `CHART_OF_ACTION`."""
FALLING_EDGE = "falling edge"
"""Subject of items on the first call of F_TRIG, which is an edge in some tools; see `CHART_OF_ACTION`."""
COUNTER = "counter"
"""Subject of items on counters that count below zero in some tools; see `CHART_OF_ACTION`."""
ARITHMETIC = "arithmetic"
"""Subject of items on results with more bits than operands, which only some tools cut off; see `CHART_OF_ACTION`."""
INPUTS_OF_ACTIONS = "inputs of actions"
"""Subject of items on actions that read inputs, and see others where the target executes them in another order with
transitions; see `CHART_OF_ACTION`."""
INPUTS_TOGETHER = "simultaneous inputs"
"""Subject of items on inputs that come in one scan with a flag that operates a chart; see `CHART_OF_ACTION`."""
START_OF_CHART = "start of the chart"
"""Subject of items on initial steps that do something for good, where tools differ in their first scan."""
SEQUENCE = "sequence"
"""Subject of items that tell which inputs, at rest, keep the form of the sequences of a chart."""
FIELD = "field"
"""Subject of items about a part of an object that no machine executes, found as the result is read again."""


class CauseKind(StrEnum):
    """Causes of losses that others follow from, or that follow from others."""

    PLACEHOLDER = "placeholder"
    """An undeclared name is in its place, so that the target refuses what would be wrong."""
    LACKING = "lacking"
    """The target has no function, block or type of a name."""
    AS_IT_IS = "as it is"
    """It is written as another tool has it. What changed the chart before may have told more of the same place."""
    GRAFCET_TEXT = "notation of GRAFCETs"
    """As `AS_IT_IS`, of a text that no other tool can read."""


@dataclass(frozen=True, slots=True)
class Cause:
    """Cause of a loss. `name`: the undeclared name in its place, or that which the target lacks."""

    kind: CauseKind
    name: str = ""


@dataclass(frozen=True, slots=True)
class Item:
    """One item of the source: what kind of thing, where, what became of it and why.

    `line` is that in the source, `file` the document that it is in, where the source may have several. `text_line` is
    that in the program text at `path`; `why` begins with it. `cause`: what other items may depend on.
    """

    outcome: Outcome
    what: str
    path: str
    why: str = ""
    line: int | None = None
    file: str | None = None
    text_line: int | None = None
    cause: Cause | None = None

    @property
    def reason(self) -> str:
        """Why, without the line of the program text."""
        return self.why if self.text_line is None else self.why.removeprefix(f"line {self.text_line}: ")

    @property
    def place(self) -> str:
        """Object and place, for people: ``action POU Main / step S3``, and not ``task task Fast``."""
        return self.path if self.path.startswith(f"{self.what} ") else f"{self.what} {self.path}".strip()


@dataclass(slots=True, repr=False)
class ConversionReport:
    """The outcomes of all items. `unchanged`: nothing was edited, the file is what was read.

    `written` are the files that were written. In a folder, `removed` are those whose objects are gone, and `left_alone`
    those that are none of the project's. `compared`: what came of simulating each chart for both tools, by its path;
    `untested` are those of these charts that could not be run, or of which not all was reached, with what was not.
    """

    source_format: str = ""
    target_format: str = ""
    items: list[Item] = field(default_factory=list)
    unchanged: bool = False
    written: list[str] = field(default_factory=list)
    removed: list[str] = field(default_factory=list)
    left_alone: list[str] = field(default_factory=list)
    compared: dict[str, str] = field(default_factory=dict)
    untested: dict[str, list[str]] = field(default_factory=dict)

    def __repr__(self) -> str:
        outcomes = Counter(item.outcome for item in self.items)
        counts = [f"{outcomes[outcome]} {outcome.value}" for outcome in Outcome if outcomes[outcome]]
        source = f"{self.source_format} to " if self.source_format else ""
        found = "unchanged" if self.unchanged else ", ".join(counts) or "no items"
        return f"ConversionReport({source}{self.target_format}: {found})"

    def add(self, outcome: Outcome, what: str, path: str, why: str = "", cause: Cause | None = None) -> None:
        """Note the outcome of an item."""
        self.items.append(Item(outcome, what, path, why, cause=cause))

    def with_outcome(self, *outcomes: Outcome) -> list[Item]:
        """Return the items with one of these outcomes."""
        return [item for item in self.items if item.outcome in outcomes]

    @property
    def losses(self) -> list[Item]:
        """Items that the target does not execute, or executes otherwise, the worst first."""
        return [item for outcome in LOSSES for item in self.with_outcome(outcome)]

    def counts(self) -> dict[tuple[str, Outcome], int]:
        """Return how many items of each kind had each outcome."""
        return dict(Counter((item.what, item.outcome) for item in self.items))

    def extend(self, items: Iterable[Item]) -> None:
        """Add items."""
        self.items.extend(items)

    def locate(
        self, lines: Mapping[str, int], file: str | None = None, *, called: Mapping[str, str] = MappingProxyType({})
    ) -> None:
        """Fill in the source line of items: that of their path, or of what is around it.

        With a `file`, the document of a folder, only of those items that are in it. `called`: paths in the source of
        what has got another name.
        """
        lines = {**lines, **{path: lines[old] for path, old in called.items() if old in lines}}
        found = ((item, line_of(item.path, lines)) for item in self.items)
        self.items = [
            item if line is None and file is not None else replace(item, line=line, file=file) for item, line in found
        ]

    def as_dict(self) -> dict[str, Any]:
        """Return the report as plain data, for JSON."""
        return {
            "source_format": self.source_format,
            "target_format": self.target_format,
            "unchanged": self.unchanged,
            "written": self.written,
            "removed": self.removed,
            "left_alone": self.left_alone,
            "compared": self.compared,
            "untested": self.untested,
            "items": [{k: v for k, v in asdict(item).items() if v not in ("", None)} for item in self.items],
        }


class ItemGroup(NamedTuple):
    """Items with one reason, but for the names in it: `reason` has an ellipsis in the place of each that differs.

    `differing` has for each item what its own reason names in these places, and `lines` the line of its text.
    """

    items: list[Item]
    reason: str
    differing: list[list[str]]
    lines: list[int | None]


def grouped_by_reason(items: Iterable[Item], message: Callable[[str], str] = str) -> list[ItemGroup]:
    """Return items that differ only in what their reasons name together, in the order of their first.

    `message` translates a reason.
    """
    found: dict[tuple[str, str, str], list[Item]] = {}
    for item in items:
        pattern = _QUOTED.sub(_ELLIPSIS, _without_own_name(item, item.reason))
        found.setdefault((item.outcome, item.what, pattern), []).append(item)
    return [_group(those, message) for those in found.values()]


def _group(items: list[Item], message: Callable[[str], str]) -> ItemGroup:
    lines = [item.text_line for item in items]
    reasons = [message(item.reason) for item in items]
    names = [_QUOTED.findall(reason) for reason in reasons]
    differ = [len(set(those)) > 1 for those in zip(*names, strict=False)]
    turns = iter(differ)
    reason = _QUOTED.sub(lambda found: _ELLIPSIS if next(turns, False) else found[0], reasons[0])
    if len(set(reasons)) > 1:
        reason = _without_own_name(items[0], reason)
    differing = [[name for name, is_one in zip(those, differ, strict=False) if is_one] for those in names]
    return ItemGroup(items, reason, differing, lines)


def _without_own_name(item: Item, text: str) -> str:
    """Return a text with an ellipsis in the place of the name of the object that an item is about."""
    name = ObjectPath.of(item.path).last.rpartition(" ")[2]
    return re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", _ELLIPSIS, text) if name else text


_ELLIPSIS = "\u2026"
_QUOTED = re.compile(r"`[^`]*`")
"""Names and program text in a reason: the markup that pages show as code."""


class Converted(NamedTuple):
    """A project in a format: the bytes of the file, and what became of each item."""

    data: bytes
    report: ConversionReport

    def __repr__(self) -> str:
        return f"Converted({len(self.data):,} bytes, {self.report!r})"


def line_of(path: str, lines: Mapping[str, int]) -> int | None:
    """Return the line of an object by its path, or of what is around it."""
    return next((lines[each] for each in ObjectPath.of(path).outwards() if each in lines), None)


@dataclass(frozen=True, slots=True)
class Use:
    """A place that names something.

    `path` is its place (``Main / step S3 / action Valve``), `language`: a language, or ``declaration``.
    `span` is that of the name in its text, `line` and `column` count from 1, `text` is the line.
    """

    path: str
    language: str
    span: tuple[int, int]
    line: int
    column: int
    text: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}:{self.column}: {self.text}"


@dataclass(frozen=True, slots=True)
class Undecided:
    """A place that has the old name, and why it is unknown whether it means what was renamed."""

    use: Use
    reason: str

    def __str__(self) -> str:
        return f"{self.use} ({self.reason})"


@dataclass(frozen=True, slots=True)
class RenameResult:
    """Result of a rename.

    `path` is that of the declaration before it (``Main.S3``). `changed` are the places that named it, with their text
    as it was, the declaration itself not among them. `undecided` are places that have the old name and were left as
    they are: look at them.
    """

    path: str
    old: str
    new: str
    changed: tuple[Use, ...] = ()
    undecided: tuple[Undecided, ...] = ()

    def __repr__(self) -> str:
        places = f"{len(self.changed)} places changed, {len(self.undecided)} undecided"
        return f"RenameResult({self.path!r} to {self.new!r}: {places})"
