"""What programs do with times: how far a search must follow them, and in which steps."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.charts.grafcet.terms import term_times
from plcopen_sfc.semantics.subjects import Subject

__all__ = ["Clocking", "StepTimes", "clocking", "step_times"]

_LITERAL = r"(?:TIME|LTIME|S5TIME|S5T|LT|T)\#[-+]?[0-9][0-9a-zA-Z_.]*"
_DURATION = re.compile(rf"\b{_LITERAL}", re.IGNORECASE)
_STEP_TIME = re.compile(r"""(?:\\?"[^"\\]+\\?"|(?<![\w.])[\w.\[\]]+)\s*\.\s*[TU]\b""", re.IGNORECASE)
_MEMBER_TIME = re.compile(r"\.\s*[TU]\b", re.IGNORECASE)  # quick to look for, and most texts have none
_COMPARED = re.compile(
    rf"""\s* (?:>=|<=|<>|>|<|=) \s* {_LITERAL} \s* (?:$ | [)"\\;,\]&] | (?:AND|OR|XOR|AND_THEN|OR_ELSE|THEN|DO)\b)""",
    re.IGNORECASE | re.VERBOSE,
)
_CLOCK = re.compile(r"\bTIME\s*\(\s*\)|\bRD_SYS_T\b|\bTIME_TCK\b", re.IGNORECASE)
_CALCULATED = re.compile(r"(?:[-+*/]|\bMOD)\s*$", re.IGNORECASE)
_TIME_PIN = '"pin":"T"'  # of a step that a wire leads from
_DEFAULT_SCAN = 10_000_000


@dataclass(frozen=True)
class Clocking:
    """How time goes on in a search.

    `scan_time` in nanoseconds; `constants` are the durations in the programs; `reason` says why no finite number of
    states can stand for all times.
    """

    scan_time: int
    constants: tuple[int, ...] = ()
    reason: str = ""


@dataclass(frozen=True)
class StepTimes:
    """What a program does with the times of the steps of its charts.

    Elapsed times beyond `limit` make no difference any more (None: they may). `read` are the steps of which a text
    reads the time, `anywhere` those of which one does elsewhere than in the conditions behind them. Names are in lower
    case.
    """

    limit: int | None
    anywhere: frozenset[str]
    read: frozenset[str]


def clocking(subjects: Sequence[Subject], scan_time: int | None) -> Clocking:
    """Look through programs for the durations in them.

    Without `scan_time` it is half of the greatest one that all durations are multiples of, so that every duration ends
    in a scan and there is one before and one after it; 10 ms without durations.
    """
    texts = [text for subject in subjects for text in _texts(subject)]
    charts = [chart for subject in subjects for chart in _own_charts(subject)]
    constants = sorted(_constants(texts, charts))
    if scan_time is None:
        common = math.gcd(*constants)
        scan_time = (common // 2 if common % 2 == 0 else common) or _DEFAULT_SCAN
    reason = "the program reads the clock" if any(_CLOCK.search(text) for text in texts) else ""
    return Clocking(scan_time, tuple(constants), reason)


def _constants(texts: Sequence[str], charts: Sequence[SfcNetwork]) -> set[int]:
    """The durations that times are compared with, or that timers are started with."""
    terms = [time for chart in charts for text in _conditions(chart) for time in term_times(text)]
    return {value for text in [*texts, *terms] for value in _durations(text)}


def _own_charts(subject: Subject) -> list[SfcNetwork]:
    return list(_charts(subject.pou.chart)) if subject.pou.chart is not None else []


def step_times(subject: Subject, scan_time: int) -> StepTimes:
    """Look through a program for what it does with the times of steps, which it alone sees."""
    texts = _texts(subject)
    charts = _own_charts(subject)
    plain = all(
        _COMPARED.match(text, match.end()) and not _CALCULATED.search(text[: match.start()][-8:])
        for text in texts
        for match in _reads_of_times(text)
    )
    steps = [step for chart in charts for step in chart.steps]
    durations = [a.duration for step in steps for a in step.actions]
    durations += [time for step in steps for time in (step.min_time, step.max_time, step.warning_time)]
    known = all(duration is None or _DURATION.fullmatch(duration.strip()) for duration in durations)
    limit = max(_constants(texts, charts), default=0) + scan_time if plain and known else None
    return StepTimes(limit, *_steps_read(charts, texts))


def _steps_read(charts: Sequence[SfcNetwork], texts: Sequence[str]) -> tuple[frozenset[str], frozenset[str]]:
    """The names of steps whose time is read when they are not active, and of those whose time is read."""
    read = Counter(name for text in texts for name in _times_read(text))
    own: Counter[str] = Counter()
    if any(_TIME_PIN in text for text in texts):
        read.update(step.name.casefold() for chart in charts for step in chart.steps)
    for chart in charts:
        for step in chart.steps:
            key = step.name.casefold()
            if key in read:
                conditions = [t.condition for t in chart.outgoing(step) if isinstance(t.condition, Expression)]
                own[key] += sum(_times_read(each.model_dump_json()).count(key) for each in conditions)
    anywhere = frozenset(name for name, count in read.items() if count != own[name])
    return anywhere, frozenset(read)


def _charts(chart: SfcNetwork) -> Iterator[SfcNetwork]:
    """The chart, its partial charts, and what stands in its macro-steps."""
    yield chart
    for partial in chart.partial_charts:
        yield from _charts(partial.chart)
    for step in chart.steps:
        if step.macro is not None and isinstance(step.macro.body, SfcBody):
            yield from _charts(step.macro.body.chart)


def _conditions(chart: SfcNetwork) -> Iterator[str]:
    """The texts of conditions, which may have times of IEC 60848 in them (``3s/X5``)."""
    conditions = [t.condition for t in chart.transitions] + [a.condition for _, a in chart.associations()]
    return (each.text for each in conditions if isinstance(each, Expression))


def _reads_of_times(text: str) -> Iterator[re.Match[str]]:
    return _STEP_TIME.finditer(text) if _MEMBER_TIME.search(text) else iter(())


def _times_read(text: str) -> list[str]:
    """The steps whose time a text reads, each as often as it does."""
    paths = (match.group().rpartition(".")[0].strip() for match in _reads_of_times(text))
    return [path.rpartition(".")[2].strip('"\\').casefold() for path in paths]


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
    found += [declared.model_dump_json(exclude_none=True) for declared in subject.project.data_types]
    return found


def _durations(text: str) -> Iterable[int]:
    for match in _DURATION.finditer(text):
        try:
            literal = literal_value(match.group())
        except LiteralError:
            continue
        if literal.kind is LiteralKind.DURATION and isinstance(literal.value, int) and literal.value > 0:
            yield literal.value
