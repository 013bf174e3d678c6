"""What programs do with times: how far a search must follow them, and in which steps."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass

from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value
from plcopen_sfc.semantics.subjects import Subject

__all__ = ["Clocking", "clocking"]

_LITERAL = r"(?:TIME|LTIME|S5TIME|S5T|LT|T)\#[-+]?[0-9][0-9a-zA-Z_.]*"
_DURATION = re.compile(rf"\b{_LITERAL}", re.IGNORECASE)
_STEP_TIME = re.compile(r"(?<![\w.])[\w.\[\]]+\s*\.\s*[TU]\b", re.IGNORECASE)
_COMPARED = re.compile(
    rf"""\s* (?:>=|<=|<>|>|<|=) \s* {_LITERAL} \s* (?:$ | [)"\\;,\]&] | (?:AND|OR|XOR|AND_THEN|OR_ELSE|THEN|DO)\b)""",
    re.IGNORECASE | re.VERBOSE,
)
_CLOCK = re.compile(r"\bTIME\s*\(\s*\)|\bRD_SYS_T\b|\bTIME_TCK\b", re.IGNORECASE)
_CALCULATED = re.compile(r"(?:[-+*/]|\bMOD)\s*$", re.IGNORECASE)
_DEFAULT_SCAN = 10_000_000


@dataclass(frozen=True)
class Clocking:
    """How time goes on in a search.

    `scan_time` in nanoseconds; `constants` are the durations in the programs; elapsed times beyond `limit` make no
    difference any more (None: they may); `reason` says why no finite number of states can stand for all times.
    """

    scan_time: int
    constants: tuple[int, ...] = ()
    limit: int | None = None
    reason: str = ""


def clocking(subjects: Iterable[Subject], scan_time: int | None) -> Clocking:
    """Look through programs for what they do with times.

    Without `scan_time` it is half of the greatest one that all durations are multiples of, so that every duration ends
    in a scan and there is one before and one after it; 10 ms without durations.
    """
    texts = [text for subject in subjects for text in _texts(subject)]
    constants = sorted({value for text in texts for value in _durations(text)})
    if scan_time is None:
        common = math.gcd(*constants)
        scan_time = (common // 2 if common % 2 == 0 else common) or _DEFAULT_SCAN
    reason = ""
    if any(_CLOCK.search(text) for text in texts):
        reason = "the program reads the clock"
    plain = all(
        _COMPARED.match(text, match.end()) and not _CALCULATED.search(text[: match.start()][-8:])
        for text in texts
        for match in _STEP_TIME.finditer(text)
    )
    durations = (a.duration for s in subjects if s.pou.sfc is not None for _, a in s.pou.sfc.associations())
    known = all(duration is None or _DURATION.fullmatch(duration.strip()) for duration in durations)
    limit = max(constants, default=0) + scan_time if plain and known else None
    return Clocking(scan_time, tuple(constants), limit, reason)


def _texts(subject: Subject) -> list[str]:
    """The POU with all that it may call, and the global variables, as text in which names and literals can be found."""
    own = subject.pou.model_dump_json(exclude_none=True)
    waiting, found = [own], [own]
    others = {pou.name: pou for pou in subject.project.pous if pou.name != subject.pou.name}
    while waiting:
        words = set(re.findall(r"\w+", waiting.pop().casefold()))
        for name in [each for each in others if each.casefold() in words]:
            text = others.pop(name).model_dump_json(exclude_none=True)
            waiting.append(text)
            found.append(text)
    found += [section.model_dump_json(exclude_none=True) for section in subject.project.global_variables]
    return found


def _durations(text: str) -> Iterable[int]:
    for match in _DURATION.finditer(text):
        try:
            literal = literal_value(match.group())
        except LiteralError:
            continue
        if literal.kind is LiteralKind.DURATION and isinstance(literal.value, int) and literal.value > 0:
            yield literal.value
