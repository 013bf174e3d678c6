"""A chart on a test bench: a project of one POU, a controller, and a clock that goes on by a fixed time a scan."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from plcopen_sfc.model import (
    Action,
    Dialect,
    Interface,
    Pou,
    PouKind,
    Project,
    SfcBody,
    SfcNetwork,
    StBody,
    Variable,
    VariableSection,
)
from plcopen_sfc.semantics import profile as profiles
from plcopen_sfc.semantics.charts import ChartProgram, GraphProgram, compiler
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs import Controller

MS = 1_000_000


class Rig:
    """Runs a chart scan by scan. Times are in milliseconds, a scan takes `step` of them."""

    def __init__(
        self,
        chart: SfcNetwork,
        profile: str | Profile = "iec",
        *,
        variables: str = "",
        actions: Mapping[str, str] | None = None,
        dialect: Dialect = Dialect.IEC,
        step: int = 10,
    ) -> None:
        declared = [Variable(name=name, type=type_ or "BOOL") for name, type_ in _split(variables)]
        self.pou = Pou(
            name="Main",
            kind=PouKind.PROGRAM,
            interface=Interface(sections=[VariableSection(variables=declared)]),
            actions=[Action(name=n, body=StBody(text=text)) for n, text in (actions or {}).items()],
            bodies=[SfcBody(chart=chart)],
        )
        self.project = Project(name="test", pous=[self.pou], dialect=dialect)
        rules = profiles.profile(profile)
        self.controller = Controller(self.project, rules, chart_compiler=compiler(rules))
        self.instance = self.controller.instance("Main")
        self._step = step * MS
        self._scans = 0

    def scan(self, times: int = 1, **values: Any) -> Rig:
        """Set variables and run some scans; the clock is at 0 in the first."""
        for name, value in values.items():
            self[name.replace("__", ".")] = value
        for _ in range(times):
            self.controller.now = self._scans * self._step
            self.instance.scan()
            self._scans += 1
        return self

    @property
    def active(self) -> str:
        """The names of the active steps."""
        ((_, chart, frame),) = self.instance.charts()
        assert isinstance(chart, ChartProgram | GraphProgram)
        return " ".join(chart.active(frame))

    def __getitem__(self, path: str) -> Any:
        return self.instance[path]

    def __setitem__(self, path: str, value: Any) -> None:
        self.instance[path] = value

    def log(self, path: str, scans: int, **values: Any) -> str:
        """The values of a Boolean variable in the next scans, as ``1`` and ``0``."""
        found = ""
        for _ in range(scans):
            self.scan(**values)
            values = {}
            found += str(int(self[path]))
        return found


def _split(variables: str) -> list[tuple[str, str]]:
    """``"a b:INT"``: BOOL without a type."""
    return [(name, type_) for name, _, type_ in (word.partition(":") for word in variables.split())]


def chain(*steps: str, conditions: str = "", ring: bool = True) -> SfcNetwork:
    """Steps in a row, the first one initial, with conditions in between; `ring`: the last leads to the first.

    `conditions` are divided by blanks, or by semicolons.
    """
    chart = SfcNetwork()
    made = [chart.add_step(name, initial=index == 0) for index, name in enumerate(steps)]
    words = conditions.split(";") if ";" in conditions else conditions.split()
    words = words or [f"c{index + 1}" for index in range(len(steps))]
    pairs = list(zip(made, [*made[1:], made[0]], strict=True))
    for (source, target), condition in zip(pairs if ring else pairs[:-1], words, strict=False):
        chart.add_transition(source, target, condition)
    return chart
