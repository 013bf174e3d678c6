"""Parts of conditions that decided them: a part behind an alternative is not tested when its transition fires.

A part of OR decides while it is TRUE and all others are FALSE, a part of AND while it is FALSE and all others are TRUE,
and nothing outside of that operation decides already (masking MC/DC). That is asked of parts that compare numbers or
times. A Boolean must only have been TRUE and FALSE where it was tested: of it alone it is often proven that it cannot
change there, such as the flag of the own step, but seldom that it cannot decide.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from plcopen_sfc.analysis.exclusivity import condition_of
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.networks import normal_form
from plcopen_sfc.languages.networks.wires import inverted
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.semantics.charts.running_chart import RunningChart
from plcopen_sfc.semantics.net import NetTransition
from plcopen_sfc.semantics.programs.marks import deciding_booleans, deciding_parts, may_act
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import Frame


@dataclass(eq=False)
class ConditionPart:
    """A part of the condition of a transition: its text, when it decides, and if it has done so.

    `value`: a Boolean that is to have this value when it is tested, if it decides or not.
    """

    owner: str
    chart: RunningChart
    transition: NetTransition
    text: str
    deciding: Expression
    value: bool | None = None
    is_seen: bool = False
    is_readable: bool = True

    @property
    def label(self) -> str:
        """Label that tells it from the other parts of the condition."""
        return self.text if self.value is None else f"{self.text} = {self.value}".upper()

    @property
    def is_open(self) -> bool:
        """True if it has not decided yet, as far as that can be seen."""
        return self.is_readable and not self.is_seen


class ConditionParts:
    """The parts of the conditions of some charts of a system. They are looked at from now on, whatever runs.

    `seen`: how many have decided; it only grows.
    """

    def __init__(self, system: ProgramSystem, charts: Iterable[tuple[str, RunningChart]]) -> None:
        self._system = system
        self.seen = 0
        self._found: list[ConditionPart] = []
        for name, chart in charts:
            looks: dict[int, Callable[[Frame], None]] = {}
            for transition in chart.net.transitions:
                tree = self._condition(transition)
                own = [
                    ConditionPart(name, chart, transition, print_node(part), deciding)
                    for part, deciding in deciding_parts(tree)
                ]
                own += [
                    ConditionPart(name, chart, transition, print_node(leaf), leaf if value else inverted(leaf), value)
                    for leaf in deciding_booleans(tree)
                    for value in (True, False)
                ]
                if own:
                    self._found += own
                    looks[transition.index] = self._looking(own)
            chart.watch(looks)

    def __iter__(self) -> Iterator[ConditionPart]:
        return (part for part in self._found if part.is_readable)

    def _condition(self, transition: NetTransition) -> Expression | None:
        """Return the condition of a transition; None where evaluating it again could do something."""
        subject = self._system.subject
        if transition.transition.condition is None or self._system.profile.grafcet_terms:
            return None
        read = condition_of(
            transition.chart,
            transition.transition,
            subject.project.dialect,
            transitions=subject.pou.transitions,
        )
        if read.tree is None or not read.complete or read.before:
            return None
        tree = normal_form(read.tree)
        return None if any(map(may_act, walk(tree))) else tree

    def _looking(self, parts: Sequence[ConditionPart]) -> Callable[[Frame], None]:
        waiting: list[tuple[ConditionPart, Callable[[Frame], bool]]] | None = None

        def look(frame: Frame) -> None:
            nonlocal waiting
            if waiting is None:  # most conditions of large charts are never tested
                waiting = self._prepared(parts)
            if waiting:
                seen = [each for each in waiting if _is_true(each[1], frame)]
                for each in seen:
                    each[0].is_seen = True
                    self.seen += 1
                    waiting.remove(each)

        return look

    def _prepared(self, parts: Sequence[ConditionPart]) -> list[tuple[ConditionPart, Callable[[Frame], bool]]]:
        instance = self._system.instance
        library = instance.controller.library
        prepared = []
        for part in parts:
            before = len(library.problems)
            function = Routines(instance.unit.scope).expression(part.deciding, part.owner)
            part.is_readable = len(library.problems) == before
            if part.is_readable:
                prepared.append((part, function))
            del library.problems[before:]
        library.link()
        return prepared


def _is_true(function: Callable[[Frame], bool], frame: Frame) -> bool:
    try:
        return bool(function(frame))
    except (SfcError, ArithmeticError, TypeError, AttributeError, IndexError):
        return False
