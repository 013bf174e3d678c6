"""Conditions as GRAFCETs have them, as structured text: ``1B1 * /a``, ``a · b + c̅``, ``↑a``, ``[C1>3]``, ``3s/X2``.

IEC 60848:2013 writes conditions as Boolean algebra (4.6), and people write that in many ways. All are read here, the
words of structured text too, since every GRAFCET's condition comes through here:

| meaning | written |
|---|---|
| and | ``*`` ``·`` (``∙`` ``•``) ``.`` ``∧`` ``&`` ``AND`` |
| or | ``+`` ``∨`` ``OR`` |
| not | ``/a`` ``!a`` ``¬a`` ``NOT a``, an overline on every character of a name |
| edges | ``↑a`` ``↓a`` |
| predicate | ``[C1>3]``, also without brackets; ``<>`` ``≠`` ``!=`` |
| time | ``3s/X2`` ``X2/5s`` ``2s/a/3s``; ``1M`` is a name |
| always, never | ``1`` ``0`` |

A dot between two names without a blank is that of a member (``Timer.Q``); `grafcet-text`, which knows what the GRAFCET
declares, puts blanks between BOOLs and flags of steps (`separated`). Up to the next word operator or parenthesis a
comparison makes ``+ - * /`` arithmetic, as in structured text; NOT before it negates all of it. Names may begin with
a digit (``1B1``).
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Protocol

from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.languages.st import parse_condition, parse_expression
from plcopen_sfc.languages.words import IEC_KEYWORDS
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import SfcNetwork


class ConditionError(ValueError):
    """A condition that cannot be read. `problem` has its place."""

    def __init__(self, message: str, span: tuple[int, int]) -> None:
        super().__init__(message)
        self.problem = Problem(message, span)


class Terms(Protocol):
    """Replacements of edges and times, which structured text does not have. Operands are structured text."""

    def edge(self, operand: str, *, rising: bool) -> str:
        """Return the replacement of ``↑operand`` or ``↓operand``."""

    def delay(self, operand: str, first: str | None, last: str | None) -> str:
        """Return the replacement of ``first/operand/last``."""


@dataclass(frozen=True, slots=True)
class _Token:
    kind: str
    text: str
    span: tuple[int, int]


OVERLINE = "\u0305"
"""The character that draws a line over the one before it."""
_TIME = r"(?i:L?T(?:IME)?)\#\w+(?:\.\d+\w*)*|\d+(?:[.,]\d+)?[ \t]*(?:ms|min|s|m|h|d)(?![\w\u0305])"
_LIKE_A_TIME = re.compile(r"(?i:(?:\d+(?:ms|min|[uµμ]s|s|m|h|d))+)")
"""A name such as ``2S`` or ``1m30s``, in the place of a time."""
_DIGITS = r"\d+(?:_\d+)*"
_NUMBER = rf"{_DIGITS}(?:\.\d+)?(?:[eE]\d+)?"
NAME = (
    rf"(?!{_DIGITS}(?:[eE]\d+)?(?![\w{OVERLINE}]))"
    rf"(?:\d*[^\W\d](?:\w|{OVERLINE})*|\d(?:{OVERLINE}\w|\w)*{OVERLINE}(?:\w|{OVERLINE})*)"
)
"""A name: it may begin with digits, but ``1E5`` and ``1_1`` are numbers, as everywhere in structured text."""
_PATH = re.compile(rf"(?<![\w.{OVERLINE}])(?:{NAME})(?:\.(?:{NAME}))+(?![\w(\[{OVERLINE}]|\.\d)")
_TOKEN = re.compile(
    rf"""\s*(?:
    (?P<time>{_TIME})
  | (?P<literal>\d+\#\w+|[^\W\d]\w*\#(?:'[^']*'|[-+]?\d[\w.#]*|\w+)|'[^']*')
  | (?P<name>"[^"\r\n]+"|%\w+(?:\.\d+)*|{NAME})
  | (?P<number>{_NUMBER})
  | (?P<compare><>|<=|>=|!=|[=<>≤≥≠])
  | (?P<not>[!¬])
  | (?P<and>[·∧&⋅∙•])
  | (?P<or>∨)
  | (?P<mark>\*\*|[-*+/.()\[\]↑↓^,]|:=|=>)
    )""",
    re.VERBOSE,
)
_COMPARISON = re.compile(r"[^\s(]+ [<>=]")
_WORDS = {"AND": "and", "OR": "or", "XOR": "xor", "NOT": "not", "MOD": "mark"}
_COMPARISONS = {"≤": "<=", "≥": ">=", "≠": "<>", "!=": "<>"}
_SAME_LENGTH = str.maketrans("≤≥≠", "<>=")
"""Comparisons of structured text that are as long as those written, so that offsets are the same."""
_BOOLEAN = {"and": "AND", "or": "OR", "xor": "XOR"}
_OPEN = {"(": ")", "[": "]"}


def to_structured_text(text: str, terms: Terms) -> str:
    """Return a condition as structured text. Raises `ConditionError`."""
    reader = _Reader(text, terms)
    if [token.text for token in reader.tokens] == ["=", "1"]:  # "always true", as drawings label it
        return "TRUE"
    return reader.level(0, len(reader.tokens))


def has_parts_of_grafcet(chart: SfcNetwork) -> bool:
    """Return True if a chart has what only IEC 60848 has: partial charts, enclosing steps, kinds of actions."""
    is_partial = bool(chart.partial_charts) or any(step.encloses for step in chart.steps)
    return is_partial or any(each.kind is not None or each.forcing is not None for _, each in chart.associations())


def is_grafcet(chart: SfcNetwork) -> bool:
    """Return True if a chart has what only GRAFCETs have, also signs in its conditions."""
    if has_parts_of_grafcet(chart):
        return True
    conditions = (transition.condition for transition in chart.transitions)
    return any(isinstance(each, Expression) and _SIGNS.search(each.text) for each in conditions)


_SIGNS = re.compile(r"[↑↓·⋅∙•¬!]|(?<![\w.])\d+[ \t]*(?:ms|min|[smhd])[ \t]*/")


def condition_problem(text: str, dialect: Dialect = Dialect.IEC) -> Problem | None:
    """Return why a condition cannot be read; None where it can."""
    try:
        read = to_structured_text(text, _Operands())
    except ConditionError as error:
        return error.problem
    problems = parse_condition(read, dialect).problems
    if not problems:
        return None
    parts = (text[start:end] for start, end in program_parts(text))
    keyword = next((part for part in parts if part.upper() in IEC_KEYWORDS), "")
    message = f"{keyword!r} is a keyword and no name: give it another one" if keyword else problems[0].message
    return Problem(message, (0, len(text)))


def is_operand(name: str) -> bool:
    """Return True if a condition reads `name` as one operand.

    That of a variable may be ``2s/X202``: AGRAFE has no times in terms, and people declare inputs of such names there.
    """
    return re.fullmatch(NAME, name) is not None or ("/" in name and condition_problem(name) is None)


def separated(text: str, known: Collection[str]) -> str:
    """Return a condition with blanks beside the dots between `known` names (in lower case), which are AND then."""

    def apart(found: re.Match[str]) -> str:
        names = found[0].split(".")
        are_known = all(name.replace(OVERLINE, "").casefold() in known for name in names)
        return " . ".join(names) if are_known else found[0]

    return _PATH.sub(apart, text)


def program_parts(text: str) -> list[tuple[int, int]]:
    """Return the spans of a condition that are structured text by themselves: operands and comparisons.

    Empty where it cannot be read. A span may be that of an overlined name.
    """
    try:
        reader = _Reader(text, _Operands())
        reader.level(0, len(reader.tokens))
    except ConditionError:
        return []
    return reader.parts


class _Operands:
    """Gives the operand for each term."""

    def edge(self, operand: str, *, rising: bool) -> str:  # noqa: ARG002  # as the protocol has it
        return f"({operand})"

    def delay(self, operand: str, first: str | None, last: str | None) -> str:  # noqa: ARG002  # as the protocol has it
        return f"({operand})"


class _Reader:
    def __init__(self, text: str, terms: Terms) -> None:
        self._text = text
        self._terms = terms
        self.tokens = list(self._tokens())
        self._closed = self._pairs()
        self.parts: list[tuple[int, int]] = []

    def _tokens(self) -> Sequence[_Token]:
        found, position = [], 0
        end = len(self._text.rstrip())
        while position < end:
            match = _TOKEN.match(self._text, position)
            if match is None:
                start = position + len(self._text[position:]) - len(self._text[position:].lstrip())
                raise ConditionError(f"{self._text[start]!r} is not of a condition", (start, start + 1))
            kind = match.lastgroup or ""
            text = match[kind]
            if kind == "name":
                kind = _WORDS.get(text.upper(), "name")
            found.append(_Token(kind, text, match.span(match.lastgroup or 0)))
            position = match.end()
        return found

    def _pairs(self) -> dict[int, int]:
        """Return the index of each closing parenthesis by that of the opening one."""
        waiting: list[int] = []
        found = {}
        for index, token in enumerate(self.tokens):
            if token.text in _OPEN and token.kind == "mark":
                waiting.append(index)
            elif token.text in _OPEN.values() and token.kind == "mark":
                if not waiting or _OPEN[self.tokens[waiting[-1]].text] != token.text:
                    raise ConditionError(f"{token.text!r} closes nothing", token.span)
                found[waiting.pop()] = index
        if waiting:
            opening = self.tokens[waiting[-1]]
            raise ConditionError(f"{_OPEN[opening.text]!r} is missing", opening.span)
        return found

    # -- levels of parentheses

    def level(self, start: int, end: int) -> str:
        """Read the text between two parentheses: Boolean parts, and comparisons between word operators."""
        parts, position = [], start
        while True:
            split = self._next(position, end, set(_BOOLEAN))
            parts.append(self._segment(position, split))
            if split == end:
                return " ".join(parts)
            parts.append(_BOOLEAN[self.tokens[split].kind])
            position = split + 1

    def _next(self, position: int, end: int, kinds: set[str]) -> int:
        """Return the index of the next token of `kinds` in no parentheses."""
        while position < end and self.tokens[position].kind not in kinds:
            position = self._closed.get(position, position) + 1
        return min(position, end)

    def _segment(self, start: int, end: int) -> str:
        if self._next(start, end, {"compare"}) < end:
            return self._verbatim(start, end)
        text, position = self._operand(start, end)
        while position < end:
            word = {"*": "AND", ".": "AND", "+": "OR"}.get(self.tokens[position].text)
            if word is None:
                why = f"an operator is missing before {self.tokens[position].text!r}"
                beside = (self.tokens[i].text for i in (position - 1, position + 1) if i < end)
                if (time := next((each for each in beside if _LIKE_A_TIME.fullmatch(each)), None)) is not None:
                    is_one = re.fullmatch(_TIME, time.lower()) is not None
                    means = f"has small letters, {time.lower()}" if is_one else "is one number with one unit, as 90s"
                    why += f": {time} is a name, and a time {means}"
                raise ConditionError(why, self.tokens[position].span)
            operand, position = self._operand(position + 1, end)
            text += f" {word} {operand}"
        return text

    def _verbatim(self, start: int, end: int) -> str:
        """Return a comparison: it is structured text already."""
        if start == end or self.tokens[start].kind == "compare" or self.tokens[end - 1].kind == "compare":
            raise self._missing(end)
        if self.tokens[start].text.upper() == "NOT":  # of its first operand in structured text, of all of it to people
            return f"NOT ({self._verbatim(start + 1, end)})"
        parts, last = [], self.tokens[start].span[0]
        for token in self.tokens[start:end]:
            if OVERLINE in token.text:
                raise ConditionError("an overline in a comparison: write NOT before it", token.span)
            text = _COMPARISONS.get(token.text, token.text) if token.kind == "compare" else token.text
            parts.append(self._text[last : token.span[0]] + text)
            last = token.span[1]
        self._keep_part(start, end)
        return "".join(parts)

    def _keep_part(self, start: int, end: int) -> None:
        """Keep the span of a part that is structured text. Raises `ConditionError` where it is none."""
        first, last = self.tokens[start].span[0], self.tokens[end - 1].span[1]
        text = self._text[first:last]
        dialect = Dialect.SCL if '"' in text else Dialect.IEC  # "DB".x: this notation has names of S7 in every file
        readable = text.translate(_SAME_LENGTH).replace("!=", "<>")
        problems = parse_expression(readable, dialect).problems if end > start + 1 else ()
        if problems:
            why = f"{' '.join(text.split())!r} is no structured text: {problems[0].message}"
            if self._next(start, end, {"compare"}) < end:
                why += "; write [..] around a comparison"
            place = first + problems[0].span[0]
            raise ConditionError(why, (place, place))
        self.parts.append((first, last))

    # -- operands

    def _operand(self, start: int, end: int) -> tuple[str, int]:
        """Return an operand with its times, negations and edges, and the index behind it."""
        first = None
        if start < end and self.tokens[start].kind == "time":
            token = self.tokens[start]
            if not self._is_slash(start + 1, end):
                raise ConditionError(f"a time needs what it is the time of: {token.text}/X1", token.span)
            first, start = token.text, start + 2
        operand, behind = self._signed(start, end)
        last = None
        if self._is_slash(behind, end) and behind + 1 < end and self.tokens[behind + 1].kind == "time":
            last, behind = self.tokens[behind + 1].text, behind + 2
        if first is None and last is None:
            return operand, behind
        return self._terms.delay(operand, _time(first), _time(last)), behind

    def _signed(self, start: int, end: int) -> tuple[str, int]:
        """Return an operand with its negations and edges, which are of it alone: ``3s//a/2s`` is ``3s/a̅/2s``."""
        if start == end:
            raise self._missing(start)
        token = self.tokens[start]
        negates = token.kind == "not" or token.text == "/"
        if not negates and token.text not in ("↑", "↓"):
            return self._primary(start, end)
        is_time = start + 1 < end and self.tokens[start + 1].kind == "time"
        operand, behind = (self._operand if is_time else self._signed)(start + 1, end)
        if not negates:
            return self._terms.edge(operand, rising=token.text == "↑"), behind
        # a time may become a comparison (Step1.T >= T#3s), of which NOT alone would take the first operand
        return f"NOT ({operand})" if _COMPARISON.match(operand) else f"NOT {operand}", behind

    def _is_slash(self, index: int, end: int) -> bool:
        return index < end and self.tokens[index].text == "/"

    def _primary(self, start: int, end: int) -> tuple[str, int]:
        token = self.tokens[start]
        if token.kind == "number":
            if token.text not in ("0", "1"):
                raise ConditionError(f"{token.text} is no Boolean value", token.span)
            return ("TRUE" if token.text == "1" else "FALSE"), start + 1
        if token.text in _OPEN:
            close = self._closed[start]
            return f"({self.level(start + 1, close)})", close + 1
        if token.kind == "literal":
            return token.text, start + 1
        if token.kind != "name":
            raise ConditionError(f"an operand is missing before {token.text!r}", token.span)
        behind = self._path(start + 1, end)
        if OVERLINE in token.text:
            return f"NOT {self._overlined(start, behind)}", behind
        self._keep_part(start, behind)
        return self._text[slice(*self.parts[-1])], behind

    def _overlined(self, start: int, behind: int) -> str:
        token = self.tokens[start]
        bare = token.text.replace(OVERLINE, "")
        if behind > start + 1 or token.text != "".join(character + OVERLINE for character in bare):
            raise ConditionError("the overline is not over the whole name: write /a or NOT (..)", token.span)
        self.parts.append(token.span)
        return bare

    def _path(self, position: int, end: int) -> int:
        """Return the index behind the members, indexes and arguments that follow a name."""
        while position < end:
            token = self.tokens[position]
            touches = token.span[0] == self.tokens[position - 1].span[1]
            follows = position + 1 < end and self.tokens[position + 1].span[0] == token.span[1]
            if token.text in _OPEN and touches:
                position = self._closed[position] + 1
            elif token.text == "^" and touches:
                position += 1
            elif token.text == "." and touches and follows and self.tokens[position + 1].kind in ("name", "number"):
                position += 2
            else:
                break
        return position

    def _missing(self, index: int) -> ConditionError:
        place = self.tokens[index].span[0] if index < len(self.tokens) else len(self._text)
        return ConditionError("an operand is missing", (place, place))


def _time(text: str | None) -> str | None:
    if text is None or "#" in text:
        return text
    return "T#" + "".join(text.split()).replace(",", ".").replace("min", "m")
