"""The net of a chart: steps and transitions as bits and indexes, for the interpreter and for analysis alike.

`Net.of(chart)` is a picture of the chart at that moment. Macro-steps are replaced by their expansions, elements
excluded from the build are missing, and all partial charts of a GRAFCET are in one net, to evolve together.
Enclosures and forcing orders are rules beyond firing; a net only tells that there are some (`Net.hierarchy`).
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property, lru_cache, reduce
from operator import or_
from typing import TypeAlias

from plcopen_sfc.model import sfc


class Competing(StrEnum):
    """Rule for transitions that share a source and could fire at once.

    PRIORITY: the first one in the order of `Net.transitions` fires (IEC 61131-3 ed. 3, 6.7.5, selection sequence; all
    PLC tools). ALL: all of them fire (IEC 60848:2013, evolution rule 4). ERROR: that is a mistake of the author.
    """

    PRIORITY = "priority"
    ALL = "all"
    ERROR = "error"


@dataclass(frozen=True)
class NetStep:
    """A step of the net. `path` is how people and programs name it: ``S3``, in a macro-step ``M1.E``."""

    index: int
    step: sfc.Step
    chart: sfc.SfcNetwork
    path: str

    @cached_property
    def bit(self) -> int:
        """Its bit in a marking."""
        return 1 << self.index

    @property
    def steps(self) -> int:
        """What is active while it is: its own bit."""
        return self.bit


@dataclass(frozen=True)
class NetTransition:
    """A transition of the net, from all steps `sources` to all steps `targets` (indexes, each once, ascending).

    `competing` are the transitions that share a source with it and are tried before it.
    """

    index: int
    transition: sfc.Transition
    chart: sfc.SfcNetwork
    path: str
    sources: tuple[int, ...]
    targets: tuple[int, ...]
    competing: tuple[int, ...]

    @cached_property
    def bit(self) -> int:
        """Its bit in a set of transitions."""
        return 1 << self.index

    @cached_property
    def pre(self) -> int:
        """Its sources as bits."""
        return mask(self.sources)

    @cached_property
    def post(self) -> int:
        """Its targets as bits."""
        return mask(self.targets)


@dataclass(frozen=True)
class NetMacro:
    """A macro-step that was replaced by its expansion. It is active while any step of `steps` (bits) is.

    `entry` and `exit` are the indexes of the entry and exit step, None where the expansion has none.
    """

    step: sfc.Step
    chart: sfc.SfcNetwork
    path: str
    steps: int
    entry: int | None
    exit: int | None


Owner: TypeAlias = NetStep | NetMacro
"""A step or a macro-step, with its associations."""


class NetProblemKind(StrEnum):
    """Reason why something of the chart is not in its net as it was meant."""

    MISSING_SOURCE = "missing source"
    MISSING_TARGET = "missing target"
    NO_EXPANSION = "macro-step without expansion"
    RECURSIVE_MACRO = "macro-step that contains itself"
    NO_ENTRY = "expansion without entry step"
    NO_EXIT = "expansion without exit step"
    SEVERAL_ENTRIES = "expansion with several entry steps"
    SEVERAL_EXITS = "expansion with several exit steps"


@dataclass(frozen=True)
class NetProblem:
    """Something broken in the chart, and what the net made of it. `path` names the step or transition."""

    kind: NetProblemKind
    chart: sfc.SfcNetwork
    element: sfc.Step | sfc.Transition
    path: str
    message: str


@dataclass(frozen=True)
class Net:
    """Steps and transitions of a chart. A marking is an `int` with the bits of the active steps.

    `transitions` are in the order in which they are tried: chart by chart, by priority, then as in the chart.
    `initial` is the marking at the start. `hierarchy`: the chart has enclosing steps or forcing orders, which rule the
    net beyond its transitions. `problems` tells what of a broken chart is missing here; a transition with a source that
    does not exist is left out, for it can never be enabled.
    """

    chart: sfc.SfcNetwork
    steps: tuple[NetStep, ...]
    transitions: tuple[NetTransition, ...]
    macros: tuple[NetMacro, ...]
    initial: int
    hierarchy: bool
    problems: tuple[NetProblem, ...]

    @staticmethod
    def of(chart: sfc.SfcNetwork) -> Net:
        """Return the net of a chart, whatever is broken in it."""
        return _Builder(chart).net()

    @staticmethod
    def of_sequencer(chart: sfc.SfcNetwork) -> Net:
        """Return the net of an S7-GRAPH chart: a sequence without an initial step starts with its first step."""
        net = Net.of(chart)
        of_id = {step.step.id: step.bit for step in reversed(net.steps) if step.chart is chart}
        initial = net.initial
        for ids in [sequence.steps for sequence in chart.sequences] or [[step.id for step in chart.steps]]:
            bits = [of_id[each] for each in ids if each in of_id]
            if bits and not any(bit & net.initial for bit in bits):
                initial |= bits[0]
        return net if initial == net.initial else replace(net, initial=initial)

    def report_paths(self, path: str) -> tuple[list[str], list[str]]:
        """Return the paths in reports of the steps and of the transitions; `path` is that of the chart."""
        around = {id(each.chart): f"{path} / {each.name}" for each in self.chart.partial_charts}
        labels = {id(chart): chart.labels() for chart in (self.chart, *(e.chart for e in self.chart.partial_charts))}
        steps = [f"{around.get(id(each.chart), path)} / step {each.step.name}" for each in self.steps]
        transitions = [
            f"{around.get(id(each.chart), path)} / transition {labels[id(each.chart)][each.transition.id]}"
            if id(each.chart) in labels
            else f"{path} / transition {each.path}"
            for each in self.transitions
        ]
        return steps, transitions

    @cached_property
    def flags(self) -> dict[str, int]:
        """The steps (bits) that the flags of IEC 60848 tell of: ``X12``, ``XM1`` of a macro-step, ``XG1`` of a chart.

        The first one with a name or number has it (IEC 60848:2013, 4.3, 7.1 and 7.4).
        """
        named = [(name, step.bit) for step in self.steps for name in (step.step.name, step.step.number)]
        named += [(name, macro.steps) for macro in self.macros for name in (macro.step.name, macro.step.number)]
        named += [(partial.name, self.steps_of(partial.chart)) for partial in self.chart.partial_charts]
        found: dict[str, tuple[str, int]] = {}
        for name, bits in named:
            if str(name).isalnum() and name is not None:
                found.setdefault(str(name).casefold(), (f"X{name}", bits))
        return dict(found.values())

    def owners(self) -> tuple[Owner, ...]:
        """Return its steps and macro-steps, which have associations."""
        return (*self.steps, *self.macros)

    def owned(self) -> list[tuple[Owner, sfc.ActionAssociation]]:
        """Return the associations that are not excluded, each with its step or macro-step."""
        return [(owner, model) for owner in self.owners() for model in owner.step.actions if not model.exclude]

    def named(self) -> dict[str, tuple[str, int]]:
        """Return what a name in lower case means: as it is written first, and the steps (bits) of all that have it."""
        found: dict[str, tuple[str, int]] = {}
        for owner in self.owners():
            name, bits = found.get(owner.step.name.casefold(), (owner.step.name, 0))
            found[name.casefold()] = name, bits | owner.steps
        return found

    def steps_of(self, chart: sfc.SfcNetwork) -> int:
        """Return the steps (bits) of a chart: its own, and those in its macro-steps."""
        steps = reduce(or_, (step.bit for step in self.steps if step.chart is chart), 0)
        return reduce(or_, (macro.steps for macro in self.macros if macro.chart is chart), steps)

    @cached_property
    def leaving(self) -> tuple[tuple[int, ...], ...]:
        """For each step the transitions that leave it, in the order in which they are tried."""
        return self._beside([t.sources for t in self.transitions])

    @cached_property
    def entering(self) -> tuple[tuple[int, ...], ...]:
        """For each step the transitions that lead to it."""
        return self._beside([t.targets for t in self.transitions])

    @cached_property
    def sourceless(self) -> tuple[int, ...]:
        """The transitions without any source, which are always enabled (IEC 60848:2013, source transition)."""
        return tuple(t.index for t in self.transitions if not t.sources)

    def enabled(self, marking: int) -> tuple[int, ...]:
        """Return the transitions all of whose sources are active, in the order in which they are tried."""
        beside = set(self.sourceless)
        for step in indexes(marking):
            beside.update(self.leaving[step])
        return tuple(i for i in sorted(beside) if not self.transitions[i].pre & ~marking)

    def reachable(self, start: int, never: Container[int] = ()) -> int:
        """Return the steps that tokens may come to if no two of them ever miss each other: never too few.

        A source counts when it was active at some time, not together with the others. Which steps are active together
        only the marking graph knows, at exponential cost. `never` are transitions (indexes) that do not fire.
        """
        found = start
        waiting = list(indexes(start))
        while waiting:
            for transition in (self.transitions[i] for i in self.leaving[waiting.pop()] if i not in never):
                if not transition.pre & ~found:
                    waiting += indexes(transition.post & ~found)
                    found |= transition.post
        return found

    def names(self, marking: int) -> tuple[str, ...]:
        """Return the paths of the active steps."""
        return tuple(self.steps[i].path for i in indexes(marking))

    def marking(self, paths: Iterable[str]) -> int:
        """The marking in which the steps with these paths are active; case does not matter. `KeyError` for others."""
        return mask(self._by_path[path.casefold()] for path in paths)

    @cached_property
    def _by_path(self) -> dict[str, int]:
        return {step.path.casefold(): step.index for step in reversed(self.steps)}

    def _beside(self, sides: Sequence[tuple[int, ...]]) -> tuple[tuple[int, ...], ...]:
        found: list[list[int]] = [[] for _ in self.steps]
        for index, side in enumerate(sides):
            for step in side:
                found[step].append(index)
        return tuple(tuple(transitions) for transitions in found)


def mask(indices: Iterable[int]) -> int:
    """Return the bits at these indexes."""
    bits = 0
    for index in indices:
        bits |= 1 << index
    return bits


@lru_cache(maxsize=4096)  # every scan asks for those of a few situations
def indexes(bits: int) -> tuple[int, ...]:
    """Return the indexes of the bits that are set, ascending."""
    found = []
    while bits:
        lowest = bits & -bits
        found.append(lowest.bit_length() - 1)
        bits ^= lowest
    return tuple(found)


@dataclass(frozen=True)
class _Place:
    """A chart at its place in the net: what its steps are called before their name, and the macro-steps it is in."""

    chart: sfc.SfcNetwork
    prefix: str
    inside: tuple[int, ...]


@dataclass(frozen=True)
class _Ends:
    """The steps of the net for a step of the model: where tokens enter it, and where they leave it; None: nowhere."""

    entry: int | None
    exit: int | None


class _Builder:
    def __init__(self, chart: sfc.SfcNetwork) -> None:
        self._root = chart
        self._partials = {p.name.casefold(): p for p in reversed(chart.partial_charts)}
        self._steps: list[NetStep] = []
        self._transitions: list[NetTransition] = []
        self._leaving: dict[int, list[int]] = {}
        self._macros: list[NetMacro] = []
        self._problems: list[NetProblem] = []
        self._initial: set[int] = set()
        self._hierarchy = False

    def net(self) -> Net:
        """Return the net of the chart and its partial charts."""
        self._add(_Place(self._root, "", ()), initial=True)
        enclosed: list[sfc.PartialChart] = []
        for partial in self._root.partial_charts:
            if partial.kind is sfc.PartialChartKind.GLOBAL:
                self._add(_Place(partial.chart, f"{partial.name}.", ()), initial=True)
            elif partial.kind is sfc.PartialChartKind.ENCLOSED:
                enclosed.append(partial)
        self._add_enclosed(enclosed)
        return Net(
            chart=self._root,
            steps=tuple(self._steps),
            transitions=tuple(self._transitions),
            macros=tuple(self._macros),
            initial=mask(self._initial),
            hierarchy=self._hierarchy,
            problems=tuple(self._problems),
        )

    def _add_enclosed(self, waiting: list[sfc.PartialChart]) -> None:
        """Enclosed charts start with their initial steps if their enclosing step is initial (IEC 60848:2013, 7.3)."""
        while waiting:
            active = {
                enclosure.chart.casefold()
                for step in self._steps
                if step.index in self._initial
                for enclosure in step.step.encloses or ()
            }
            partial = next((p for p in waiting if p.name.casefold() in active), waiting[0])
            waiting.remove(partial)
            self._hierarchy = True
            self._add(_Place(partial.chart, f"{partial.name}.", ()), initial=partial.name.casefold() in active)

    def _add(self, place: _Place, *, initial: bool) -> dict[int, _Ends]:
        """Add the steps and transitions of a chart; its own initial steps start where `initial`."""
        ends: dict[int, _Ends] = {}
        for step in place.chart.steps:
            if not step.exclude and step.id not in ends:
                ends[step.id] = self._add_step(place, step, initial=initial and step.initial)
        ordered = sfc.by_priority(place.chart.transitions)
        excluded = {step.id for step in place.chart.steps if step.exclude}
        labels = place.chart.labels()
        for transition in ordered:
            if not transition.exclude:
                self._add_transition(place, transition, ends, excluded, place.prefix + labels[transition.id])
        return ends

    def _add_step(self, place: _Place, step: sfc.Step, *, initial: bool) -> _Ends:
        path = place.prefix + step.name
        self._hierarchy = self._hierarchy or bool(step.encloses) or any(a.forcing is not None for a in step.actions)
        if step.macro is not None:
            expanded = self._expand(place, step, step.macro, path, initial=initial)
            if expanded is not None:
                return expanded
        index = len(self._steps)
        self._steps.append(NetStep(index, step, place.chart, path))
        if initial:
            self._initial.add(index)
        return _Ends(index, index)

    def _expand(self, place: _Place, step: sfc.Step, macro: sfc.Macro, path: str, *, initial: bool) -> _Ends | None:
        """The expansion of a macro-step in its place; None where there is none: then it is a step like others."""
        entry_name: str | None = None
        exit_name: str | None = None
        chart: sfc.SfcNetwork | None = None
        if isinstance(macro.body, sfc.SfcBody):
            chart = macro.body.chart
        elif (partial := self._partials.get((macro.expansion or "").casefold())) is not None:
            chart, entry_name, exit_name = partial.chart, partial.entry_step, partial.exit_step
        if chart is None or not chart.steps:
            self._report(NetProblemKind.NO_EXPANSION, place, step, path, "it is treated as a single step")
            return None
        if id(chart) in place.inside:
            self._report(NetProblemKind.RECURSIVE_MACRO, place, step, path, "it is treated as a single step")
            return None
        first = len(self._steps)
        inner = _Place(chart, f"{path}.", (*place.inside, id(chart)))
        # an entry step that is only known as the initial one starts with the macro-step, not with the program
        ends = self._add(inner, initial=entry_name is not None)
        entry = self._end(inner, step, path, entry_name, ends, entry=True)
        exit_ = self._end(inner, step, path, exit_name, ends, entry=False)
        if initial and entry is not None:
            self._initial.add(entry)
        inside = mask(range(first, len(self._steps)))
        self._macros.append(NetMacro(step, place.chart, path, inside, entry, exit_))
        return _Ends(entry, exit_)

    def _end(
        self, place: _Place, macro: sfc.Step, path: str, name: str | None, ends: dict[int, _Ends], *, entry: bool
    ) -> int | None:
        steps = [step for step in place.chart.steps if not step.exclude]
        transitions = [t for t in place.chart.transitions if not t.exclude]
        found = [step for step in steps if name is not None and step.name.casefold() == name.casefold()]
        # TC6 has no marks for the ends of a macro-step: they are the initial step, and steps without a way in or out
        if not found and entry:
            found = [step for step in steps if step.initial]
        if not found:
            used = {i for t in transitions for i in (t.targets if entry else t.sources)}
            found = [step for step in steps if step.id not in used]
        if not found:
            kind = NetProblemKind.NO_ENTRY if entry else NetProblemKind.NO_EXIT
            self._report(kind, place, macro, path, "it is never entered" if entry else "it is never left")
            return None
        chosen = found[0] if entry else found[-1]
        if len(found) > 1:
            kind = NetProblemKind.SEVERAL_ENTRIES if entry else NetProblemKind.SEVERAL_EXITS
            names = ", ".join(step.name for step in found)
            self._report(kind, place, macro, path, f"of {names}, {chosen.name} is taken")
        return ends[chosen.id].entry if entry else ends[chosen.id].exit

    def _add_transition(
        self, place: _Place, transition: sfc.Transition, ends: dict[int, _Ends], excluded: set[int], path: str
    ) -> None:
        sources = [ends[i].exit for i in transition.sources if i in ends]
        if len(sources) < len(transition.sources):
            if not excluded.intersection(transition.sources):
                self._report(NetProblemKind.MISSING_SOURCE, place, transition, path, "it can never be enabled")
            return
        if any(source is None for source in sources):
            return  # the macro-step before it has no exit step, which is reported there
        missing = [i for i in transition.targets if i not in ends and i not in excluded]
        if missing:
            self._report(NetProblemKind.MISSING_TARGET, place, transition, path, "it leads nowhere")
        before = sorted({source for source in sources if source is not None})
        after = {ends[i].entry for i in transition.targets if i in ends}
        index = len(self._transitions)
        competing = sorted({competitor for source in before for competitor in self._leaving.get(source, ())})
        for source in before:
            self._leaving.setdefault(source, []).append(index)
        targets = tuple(sorted(target for target in after if target is not None))
        self._transitions.append(
            NetTransition(index, transition, place.chart, path, tuple(before), targets, tuple(competing))
        )

    def _report(
        self, kind: NetProblemKind, place: _Place, element: sfc.Step | sfc.Transition, path: str, consequence: str
    ) -> None:
        self._problems.append(NetProblem(kind, place.chart, element, path, f"{path}: {kind}; {consequence}"))
