"""German for what comparisons tell: verdicts, what was not reached and why, and differences with their causes.

Such a text is composed: of clauses with "; " between, of lists, and of alternatives with " or ". So it is translated in
parts. ``german/verdicts.json`` has the messages, with places as `plcopen_sfc.pages.phrases` has them.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from plcopen_sfc.pages.phrases import Phrases, german_label, german_table

_HEAD = {"scan": "Zyklus", "time": "Zeit", "first: ": "erstes: ", "second: ": "zweites: ", "active": "aktiv"}
"""Columns of the table of a difference."""
_COLUMNS = re.compile(r"^scan|(?<=^scan  )time|(?<=  )(?:first|second): |(?<=first: )active\b|(?<=second: )active\b")
_CODE = re.compile("`[^`]*`")
_NUMBERED = re.compile(r"`(\d+)`")
_MISSED = re.compile(
    "not reached: (step|transition|action|assignment|part of condition|outcome of comparison|outcome of condition)(s?) "
    "(.+): ([^:]+)",
    re.DOTALL,
)
_DECIDED = re.compile(
    "not reached: (transition|assignment|condition) (.+) "
    "((?:is|was) never (?:TRUE|FALSE).*|can never decide it.*|never decided it.*|the code around it .*|needs [^:]*)",
    re.DOTALL,
)
_OTHERWISE = re.compile(r"it does something else after (\d+) scan(s?): (.+)", re.DOTALL)
_GIVEN = "given: "
_FAILED = {"both end with an error: ": "beide enden mit einem Fehler: ", "not run: ": "nicht ausgeführt: "}
"""What is before the reason for the end of a run."""
_MORE = re.compile(r" and (\d+) more$")
_MISSED_KINDS = {
    "step": ("Schritt", "Schritte"),
    "transition": ("Transition", "Transitionen"),
    "action": ("Aktion", "Aktionen"),
    "assignment": ("Zuweisung", "Zuweisungen"),
    "condition": ("Bedingung", "Bedingungen"),
    "part of condition": ("Teil einer Bedingung", "Teile von Bedingungen"),
    "outcome of comparison": ("Ergebnis eines Vergleichs", "Ergebnisse von Vergleichen"),
    "outcome of condition": ("Ergebnis einer Bedingung", "Ergebnisse von Bedingungen"),
}


class Verdicts:
    """German for lines of verdicts and reasons of them.

    `failure` translates why a run ended, `other` what is in it besides, such as tools.
    """

    def __init__(self, failure: Callable[[str], str], other: Callable[[str], str]) -> None:
        self._failure, self._other = failure, other
        table = german_table("verdicts")
        self._phrases = Phrases(table, self._clauses)
        self._whole = Phrases({english: german for english, german in table.items() if "; " in english}, self._clauses)

    def __call__(self, line: str) -> str:
        """Return a line in German, code in backquotes as it is; what is not known stays English."""
        if line.startswith("scan  time"):  # the head of a table
            return _COLUMNS.sub(lambda found: _HEAD[found[0]], line)
        codes: list[str] = []

        def number(found: re.Match[str]) -> str:
            codes.append(found[0])
            return f"`{len(codes) - 1}`"

        told = self._clauses(_CODE.sub(number, line))
        return _NUMBERED.sub(lambda found: codes[int(found[1])], german_label(told))

    def _clauses(self, text: str) -> str:
        if (told := self._whole.find(text)) is not None:
            return told
        return "; ".join(self._clause(clause) or self._other(clause) for clause in _divided(text, "; "))

    def _clause(self, text: str) -> str | None:
        """Return a clause in German; None where it is not known."""
        if text.startswith(_GIVEN):  # no list: what is given may have an "and"
            return f"dabei: {self._clauses(text.removeprefix(_GIVEN))}"
        if found := _DECIDED.fullmatch(text):
            return f"nicht erreicht: {_MISSED_KINDS[found[1]][0]} {found[2]} {self._clauses(found[3])}"
        if found := _MISSED.fullmatch(text):
            names = _MORE.sub(r" und \1 weitere", found[3])
            if found[1] == "action":
                names = ", ".join(map(self._phrases, names.split(", ")))
            return f"nicht erreicht: {_MISSED_KINDS[found[1]][bool(found[2])]} {names}: {self._clauses(found[4])}"
        if found := _OTHERWISE.fullmatch(text):
            return f"es tut nach {found[1]} Zyk{'len' if found[2] else 'lus'} etwas anderes: {self._clauses(found[3])}"
        lists = (self._listed(text, mark, german) for mark, german in _MARKS)
        return next(filter(None, lists), None) or self._phrases.find(text) or self._failed(text)

    def _failed(self, text: str) -> str | None:
        begins = next((begins for begins in _FAILED if text.startswith(begins)), None)
        return f"{_FAILED[begins]}{self._failure(text.removeprefix(begins))}" if begins is not None else None

    def _listed(self, text: str, mark: str, german: str) -> str | None:
        """Return a list in German; None where it is none, or something in it is not known."""
        parts = _divided(text, mark)
        told = [self._clause(part) for part in parts] if len(parts) > 1 else [None]
        return None if None in told else german.join(filter(None, told))


_MARKS = ((" or ", " oder "), (" and ", " und "), (", ", ", "))


def _divided(text: str, mark: str) -> list[str]:
    """Return the parts that a mark divides outside of parentheses."""
    parts, depth = [""], 0
    for piece in re.split(rf"([()]|{mark})", text):
        depth += {"(": 1, ")": -1}.get(piece, 0)
        if piece == mark and depth <= 0:
            parts.append("")
        else:
            parts[-1] += piece
    return parts
