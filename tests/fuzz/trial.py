"""Operations on a damaged file, and the invariants that must hold whatever its content."""

from __future__ import annotations

import pickle
import signal
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from random import Random
from types import FrameType
from typing import Any

import plcopen_sfc as sfc
from plcopen_sfc.errors import EncodingError, FormatError, UnknownFormatError
from plcopen_sfc.model.compare import differences
from tests.fuzz.mutation import FORMATS, MutatedFile

CPU_SECONDS = 10
"""More than this is a hang."""
_HOUSE = Path(sfc.__file__).parent
_VERSIONS = (
    "plcopen-1.01",
    "plcopen-2.01",
    "codesys",
    "simaticml",
    "scl",
    "iec-text",
    "codesys23",
    "twincat",
    "json",
    "codesys-export",
    "csv",
    "xlsx",
)
_WITHOUT_LINES = ("xlsx",)
"""A cell of a workbook has its place; an archive that cannot be opened has none."""
_TARGETS = {**dict.fromkeys(FORMATS, _VERSIONS), "grafcet": ("grafcet-text", "json"), "grafcet-text": ("grafcet",)}


@dataclass(frozen=True)
class FuzzFault:
    """Something that must not be. `kind` is short and the same for the same cause."""

    kind: str
    text: str = ""


class HangError(BaseException):
    """More than `CPU_SECONDS` of the processor."""


def faults(mutant: MutatedFile, *seeds: int) -> list[FuzzFault]:
    """Do everything with a mutant and return what must not be. A seed chooses a target, and what is run and edited."""
    return _Trial(mutant).run(seeds)


class _Trial:
    def __init__(self, mutant: MutatedFile) -> None:
        self.mutant = mutant
        self.found: list[FuzzFault] = []
        self.tried: set[tuple[str | int, ...]] = set()

    def run(self, seeds: Sequence[int]) -> list[FuzzFault]:
        data = self.mutant.data
        project = self.attempt("load", lambda: self.load(data), placed=True)
        if project is None:
            return self.found
        project.accept_errors()
        is_read = self.attempt("read all", lambda: project.read_all() or True, placed=True)
        written = self.attempt("dumps", lambda: sfc.dumps(project))
        if written is not None and written != data:
            self.found.append(FuzzFault("identity", f"{len(data)} bytes came back as {len(written)} others"))
        if not is_read:
            return self.found
        self.attempt("check", lambda: sfc.check(project))
        fresh = self.attempt("fresh", lambda: sfc.convert(project, fresh=True))
        if fresh is not None:
            self.compared("fresh", project, fresh, self.mutant.format)
        as_json = self.attempt("to json", lambda: sfc.convert(project, "json", partial=True))
        if as_json is not None:
            self.compared("json", project, as_json, "json")
        for seed in seeds:
            chance = Random(seed)  # noqa: S311  # no secret
            self.converted(project, chance.choice(_TARGETS[self.mutant.format]))
            self.executed(project, chance)
            if self.edited(project, chance):
                project = self.load(data)
                project.accept_errors()
        return self.found

    def is_new(self, *choice: str | int) -> bool:
        """Return whether no seed before has chosen this."""
        known = choice in self.tried
        self.tried.add(choice)
        return not known

    def load(self, data: bytes, format: str = "") -> sfc.Project:
        """Load bytes in a format, or in that of the mutant."""
        return sfc.loads(data, format=format or self.mutant.format, path="mutant")

    def compared(self, what: str, project: sfc.Project, written: Any, kind: str) -> None:
        """A file written from the model has all of it, or the report names the rest."""
        back = self.attempt(f"load {what}", lambda: self.load(written.data, kind), must=True)
        if back is None or written.report.items:
            named = " ".join(f"{item.path} {item.why}" for item in written.report.items)
            if back is None or named:
                return
        if kind == "json":
            for difference in differences(project, back):
                self.found.append(FuzzFault(f"loss {what}", str(difference)[:300]))
                break

    def converted(self, project: sfc.Project, target: str) -> None:
        """A file in another format can be read."""
        if not self.is_new("to", target):
            return
        converted = self.attempt(f"to {target}", lambda: sfc.convert(project, target, partial=True))
        if converted is not None:
            self.attempt(f"load {target}", lambda: self.load(converted.data, target).read_all(), must=True)

    def executed(self, project: sfc.Project, chance: Random) -> None:
        charts = list(project.charts())
        if charts and self.is_new("run", name := chance.choice(charts).pou.name):
            self.attempt("simulate", lambda: sfc.simulate(project, pou=name, scans=3))
            self.attempt("lower", lambda: sfc.lower(project, pou=name, verify=False))

    def edited(self, project: sfc.Project, chance: Random) -> bool:
        """A name and a comment changed: both are in what is saved, and nothing else is lost. False: nothing done."""
        steps = [(chart, step) for chart in project.charts() for step in chart.chart.steps]
        if not steps:
            return False
        number = chance.choice(range(len(steps)))
        chart, step = steps[number]
        other = chance.choice(range(len(chart.chart.steps)))
        if not self.is_new("edit", number, other):
            return False
        self.renamed(project, chart.chart, step, chart.chart.steps[other])
        return True

    def renamed(self, project: sfc.Project, chart: sfc.SfcNetwork, step: sfc.Step, other: sfc.Step) -> None:
        old = step.name
        if self.attempt("rename", lambda: chart.rename_step(old, "Zz9_New")) is None:
            return
        if isinstance(other.comment, str | type(None)):
            other.comment = "changed (* here *) < & ä"
        saved = self.attempt("save edit", lambda: sfc.convert(project, partial=True))
        if saved is None:
            return
        back = self.attempt("load edit", lambda: self.load(saved.data), must=True)
        if back is None:
            return
        names = [each.name for one in back.charts() for each in one.chart.steps]
        if "Zz9_New" not in names and not saved.report.items:
            self.found.append(FuzzFault("loss edit", f"the new name of {old} is gone"))
        elif not saved.report.items:
            wanted, got = self.content(project), self.content(back)
            if wanted != got:
                self.found.append(FuzzFault("loss around an edit", f"{[a for a in wanted if a not in got][:3]}"))

    @staticmethod
    def content(project: sfc.Project) -> list[str]:
        """The names of everything, which an edit of one step must keep."""
        found = [f"POU {pou.name}" for pou in project.pous]
        for chart in project.charts():
            found += [f"{chart.name} {step.name} {step.initial}" for step in chart.chart.steps]
            found += [f"{chart.name} {len(chart.chart.transitions)} transitions"]
        return sorted(found)

    def attempt(self, what: str, deed: Callable[[], Any], *, placed: bool = False, must: bool = False) -> Any:
        """Do something: only errors of this package may come of it, with a place if they are of the file.

        `must`: none may come.
        """
        try:
            with limited():
                return deed()
        except sfc.SfcError as error:
            self.judge(what, error, placed=placed, must=must)
        except HangError as error:
            self.found.append(FuzzFault(f"hang: {what} in {_where(error, 4)}", _trace(error)))
        except Exception as error:
            self.found.append(FuzzFault(f"raw: {what}: {type(error).__name__} in {_where(error, 2)}", _trace(error)))
        return None

    def judge(self, what: str, error: sfc.SfcError, *, placed: bool, must: bool) -> None:
        if must:
            kind = f"not read back: {what}: {type(error).__name__} in {_where(error, 1)}"
            self.found.append(FuzzFault(kind, f"{error}\n{_trace(error)}"))
        elif (
            isinstance(error, FormatError)
            and not placed
            and not isinstance(error, UnknownFormatError | EncodingError)  # the file's code page lacks a character
        ):
            self.found.append(
                FuzzFault(f"unreadable result: {what}: {type(error).__name__} in {_where(error, 1)}", str(error))
            )
        elif (
            placed
            and error.location.line is None
            and self.mutant.format not in _WITHOUT_LINES
            and not isinstance(error, UnknownFormatError)
        ):
            self.found.append(FuzzFault(f"no line: {what}: {type(error).__name__} in {_where(error, 1)}", str(error)))
        elif placed and error.location.file is None:
            self.found.append(FuzzFault(f"no file: {what}: {type(error).__name__} in {_where(error, 1)}", str(error)))
        twin = pickle.loads(pickle.dumps(error))  # noqa: S301  # our own
        if str(twin) != str(error):
            self.found.append(FuzzFault("pickle", f"{error} became {twin}"))


@contextmanager
def limited() -> Iterator[None]:
    """Raise `HangError` after `CPU_SECONDS`, where the system can do that."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(_number: int, _frame: FrameType | None) -> None:
        raise HangError

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, CPU_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def _where(error: BaseException, frames: int) -> str:
    """The innermost functions of this package that an error came through."""
    found = [
        f"{Path(frame.filename).stem}.{frame.name}"
        for frame in traceback.extract_tb(error.__traceback__)
        if Path(frame.filename).is_relative_to(_HOUSE)
    ]
    return " < ".join(reversed(found[-frames:]))


def _trace(error: BaseException) -> str:
    return "".join(traceback.format_exception(error))[-6000:]
