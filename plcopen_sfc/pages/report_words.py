"""German for what reports of conversions, lines of `diff` and findings of `check` tell, by the English message.

``german/reports.json`` and ``german/rules.json`` have the messages, ``german/runs.json`` those of runs that end with an
error, with places as `plcopen_sfc.pages.phrases` has them. A message that is not there stays English. Tools are in the
dative: German puts them after `in` and `von`.
"""

from __future__ import annotations

import re
from functools import lru_cache

from plcopen_sfc.pages.phrases import Phrases, german_label, german_table, german_tables
from plcopen_sfc.pages.verdict_words import Verdicts

GERMAN = german_table("reports")
_KINDS = german_tables("reports")["kinds of things"]
_LINE = re.compile(r"line (\d+): ")
"""Beginnings of messages about program text of several lines."""
_PLACE = re.compile(r"(?:line ([\d:]+) \()?(\w+(?:\.\w+)*(?: / .+?)?)\)?")
"""Places that are before the reason for the end of a run: ``Band / transition S1 -> S2``, ``line 2 (Main)``."""
_RUN = ("it does something else after ", "it is not known to do the same")
"""Beginnings of what a run of both sides has shown."""


def german_place(path: str) -> str:
    """Return a path of a report with the kinds of things in German: ``POU Main / Schritt Fill``."""
    return " / ".join(map(_german_part, path.split(" / ")))


def _german_part(part: str) -> str:
    words = part.split(" ")
    for end in range(len(words), 0, -1):
        kind = " ".join(words[:end])
        if kind in _KINDS:
            name = " ".join(words[end:])
            return f"{_KINDS[kind]} {german_label(name) if kind == 'transition' else name}".rstrip()
    return part


@lru_cache(maxsize=4096)
def german(message: str) -> str:
    """Return a message in German; itself where the table does not have it."""
    if message in GERMAN:
        return GERMAN[message]
    if message.startswith(_RUN):
        return german_verdict(message)
    if line := _LINE.match(message):
        return f"Zeile {line[1]}: {german(message[line.end() :])}"
    return german_label(_REPORTS.find(message) or _FINDINGS.find(message) or message)


@lru_cache(maxsize=4096)
def german_finding(message: str) -> str:
    """Return the message or the hint of a finding in German; itself where no translation is known."""
    return german_label(_FINDINGS.find(message) or german(message))


@lru_cache(maxsize=4096)
def german_failure(message: str) -> str:
    """Return why a run ended with an error in German, where a place may be before it; itself where it is not known."""
    place, mark, reason = message.partition(": ")
    if mark and (at := _PLACE.fullmatch(place)) and (told := german_failure(reason)) != reason:
        path = german_place(at[2])
        return f"Zeile {at[1]} ({path}): {told}" if at[1] else f"{path}: {told}"
    return german_label(_RUNS(message))


_REPORTS = Phrases(GERMAN, german)
_FINDINGS = Phrases(german_table("rules"), german_finding)
_RUNS = Phrases({**german_table("runs"), **german_table("verdicts"), **GERMAN, **german_table("rules")}, german_failure)
german_verdict = Verdicts(german_failure, _REPORTS)
"""Return a line of a verdict in German, or why something was not reached; English stays what is not known."""
