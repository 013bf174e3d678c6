"""What a translation has to say about places where the dialects differ."""

from __future__ import annotations

from dataclasses import dataclass

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.st.nodes import Node, Span


@dataclass(frozen=True, slots=True)
class Note:
    """A place in the source text, and what is to say about it.

    `severity`: ERROR: it has no counterpart in the target dialect and was left as it stands. WARNING: it was
    translated, or left, but may mean something else there. INFO: it means the same but is worth knowing, such as a new
    name. `span`: offsets into the source text; `line` and `column` of its start, from 1.
    """

    severity: Severity
    reason: str
    span: Span
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Outcome:
    """The text of something in the target dialect. `severity` None: it means the same, and there is nothing to say."""

    text: str
    severity: Severity | None = None
    reason: str = ""


class Notes:
    """Collects the notes on a text."""

    def __init__(self, text: str) -> None:
        self._end = len(text)
        self._lines = Lines(text)
        self._found: dict[Note, None] = {}

    def add(self, severity: Severity, reason: str, place: Node | Span) -> None:
        """Note something about a node of the source text, or about a place in it."""
        span = place.span if isinstance(place, Node) else place
        start, end = span or (0, self._end)
        line, column = self._lines.place(start)
        self._found[Note(severity, reason, (start, end), line, column)] = None

    def take(self, outcome: Outcome, place: Node | Span) -> str:
        """The text of an outcome, after noting what it has to say."""
        if outcome.severity is not None:
            self.add(outcome.severity, outcome.reason, place)
        return outcome.text

    @property
    def has_errors(self) -> bool:
        """Whether something has no counterpart."""
        return any(note.severity is Severity.ERROR for note in self._found)

    def in_order(self) -> tuple[Note, ...]:
        """The notes in the order of the text."""
        return tuple(sorted(self._found, key=lambda note: note.span))
