"""Words for a difference that a run of source and target found, with its cause as far as that is known."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.conversion.executed_charts import WRITTEN
from plcopen_sfc.conversion.executed_parts import BOOLEAN_ACTIONS, FIRST_SCAN, SELECTION, STABILITY, START
from plcopen_sfc.languages.binding import STORING, SharedScans, actions_by_name, names_in, step_effects
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action
from plcopen_sfc.model.project import Chart
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step
from plcopen_sfc.model.types import SimpleValue
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import INPUTS_OF_ACTIONS, ORDER_OF_ACTIONS, START_OF_CHART, Item
from plcopen_sfc.semantics.net import Competing
from plcopen_sfc.semantics.profile import Profile, ScanOrder
from plcopen_sfc.whole_numbers import counted

if TYPE_CHECKING:
    from plcopen_sfc.analysis.verdict import Counterexample, Verdict
    from plcopen_sfc.semantics.signals import Value


def told_difference(
    example: Counterexample,
    chart: Chart,
    losses: Sequence[Item],
    profiles: tuple[Profile, Profile],
    tool: str,
    *,
    rules: Sequence[str] = (),
) -> list[str]:
    """Return the difference of a chart of the source in `tool`, and its explanation: the first that applies.

    The `rules` of the tools without which both do the same; where the chart evolves otherwise, a rule or one of the
    `losses` on that; one of the other `losses`; when variables are written; else the parts of the chart that determine
    what differs.
    """
    more = [each.name.removesuffix(".X") for each in example.differences[1:] if not each.error]
    others = [f"{_listed(more)} {'differs' if len(more) == 1 else 'differ'}, too"] if more else []
    causes = rules or _causes(example, chart, losses, profiles, tool)
    return [told_example(example, tool), *others, *causes]


def told_example(example: Counterexample, tool: str) -> str:
    """Return the first difference of a run of the source and of what `tool` reads."""
    scans = counted(len(example.inputs), "scan")
    shown = str(example.differences[0]).replace("in the first", "in the source").replace("in the second", f"in {tool}")
    return f"it does something else after {scans}: {shown}"


def _written_at(chart: Chart, profiles: tuple[Profile, Profile], tool: str) -> Mapping[str, str]:
    """Return by the names of Boolean variables that are actions when two tools write them; empty if both do alike."""
    rules = [WRITTEN[each.boolean_targets] for each in profiles]
    if rules[0] == rules[1] or any(each.graph_parameters for each in profiles):
        return {}
    why = f"is written {rules[0]} in the source and {rules[1]} in {tool}"
    rows = [row for _, row in chart.chart.associations() if row.target and row.body is None and row.value is None]
    return {row.target: f"{row.target} {why}" for row in rows if row.target and not chart.pou.find_action(row.target)}


def _causes(
    example: Counterexample, chart: Chart, losses: Sequence[Item], profiles: tuple[Profile, Profile], tool: str
) -> list[str]:
    evolution: dict[str, None] = {}
    found: dict[str, None] = {}
    parts: dict[str, None] = {}
    # From the surest explanation to the vaguest. Only what the report lists and what can change what differs, or what
    # the profiles are known for, is called a cause; else these are places to look at.
    evolves = any(each.name.endswith(".X") for each in example.differences)
    if evolves and len(example.inputs) <= _FIRST_SCANS and (held := told_held(profiles, tool)):
        return [held]
    first = [item for item in losses if item.what == FIRST_SCAN and concerns(item, chart.report_path)]
    if first and not evolves and len(example.inputs) == 1:
        return [_told_item(FIRST_SCAN)]
    near = [item for item in losses if item.what not in _SEPARATE and concerns(item, chart.report_path)]
    for name in (each.name for each in example.differences if not each.error):
        influences = _Influences.on(name, example, chart)
        for item in near:
            if influences.include(item, chart.report_path):
                told = _told_item(item.what, "" if item.path == chart.report_path else ObjectPath.of(item.path).last)
                (evolution if evolves and item.what in _OF_EVOLUTION else found)[told] = None
        parts |= dict.fromkeys(map(_called, influences.places))
    if evolution or found:
        return [*evolution, *found][:_LISTED]
    if started := _told_start(example, chart, profiles, tool) or _told_begun(example, chart, profiles, tool):
        return [started]
    written = _written_at(chart, profiles, tool)
    for name in (each.name for each in example.differences if each.name in written):
        return [written[name]]
    if any(item.what == START and concerns(item, chart.report_path) for item in losses):
        return [f"{UNKNOWN_CAUSE}: look at the {START}, which the report names"]
    order = ": tools have an order of their own for what writes a variable in one scan"
    told = f"look at {_listed([*parts])}{order if len(parts) > 1 and not evolves else ''}" if parts else ""
    return [f"{UNKNOWN_CAUSE}: {told}" if told else UNKNOWN_CAUSE]


UNKNOWN_CAUSE = "the cause is not known"


def _told_item(what: str, place: str = "") -> str:
    return f"a cause is the {what}{f' at {place}' if place else ''}, which the report names"


class ToolRule(NamedTuple):
    """A rule that two tools have in another form: the source with that of the target, and what it is as a cause."""

    patched: Callable[[], Profile]
    subject: str
    words: str

    def told(self, losses: Iterable[Item], chart: Chart) -> str:
        """Return the rule as a cause: the item of the report on it where there is one, else in its words."""
        named = any(item.what == self.subject and concerns(item, chart.report_path) for item in losses)
        return _told_item(self.subject) if named else self.words


def differing_rules(
    example: Counterexample, chart: Chart, profiles: tuple[Profile, Profile], tool: str
) -> Iterator[ToolRule]:
    """Yield the rules for actions and competing transitions that a `tool` does not have as the source has them."""
    one, other = profiles
    written = _written_at(chart, profiles, tool)
    names = (each.name for each in example.differences if each.name in written)
    late = next((written[name] for name in names), f"{tool} writes variables that are actions at other times")
    once_more = tool if other.final_scan else "the source"
    all_together = tool if other.competing is Competing.ALL else "the source"
    words = {
        "boolean_targets": (BOOLEAN_ACTIONS, late),
        "action_order": (ORDER_OF_ACTIONS, f"{tool} executes the actions of a scan in another order"),
        "final_scan": ("final scan", f"{once_more} executes an action once more after its step is left"),
        "competing": (SELECTION, f"{all_together} fires all transitions together that can leave a step"),
    }
    for name, (subject, told) in words.items():
        if getattr(one, name) is not getattr(other, name):
            yield ToolRule(partial(replace, one, **{name: getattr(other, name)}), subject, told)


def _told_start(example: Counterexample, chart: Chart, profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return which tool takes its start for no activation of the initial steps, where that matters; else empty."""
    if profiles[0].initial_steps_entered is profiles[1].initial_steps_entered:
        return ""
    side = tool if profiles[0].initial_steps_entered else "the source"
    networks = [network for network, _ in _networks(chart)]
    begun = {step.name: {"entry action"} for network in networks for step in network.steps if step.initial}
    for step, row in (each for network in networks for each in network.associations()):
        if step.name in begun and row.qualifier is not Qualifier.N:
            begun[step.name].add(_told_row(row))
    for name in (each.name for each in example.differences if not each.error):
        if any(each.told in begun.get(each.step.name, ()) for each in _writers(name, chart)):
            return f"the start is no activation of the initial step in {side}: what begins with that is not executed"
    return ""


def _is_begun_once(step: Step, network: SfcNetwork, example: Counterexample, chart: Chart, scans: int) -> bool:
    """True if an initial step of the source is not entered again in as many `scans`."""
    active = (_is_shown(step, network, chart, example.left.active(scan)) for scan in range(scans))
    return step.initial and not any(now and not before for before, now in pairwise(active))


def _called(place: str) -> str:
    """Return the name of a part of a chart; an action of a step itself has that of the step."""
    path = ObjectPath.of(place)
    return f"{path.last} of {ObjectPath.of(path.around).last}" if path.last in _STEP_ACTIONS else path.last


_STEP_ACTIONS = ("entry action", "main action", "exit action")


_SEPARATE = frozenset({FIRST_SCAN, INPUTS_OF_ACTIONS, START_OF_CHART})
"""Subjects of items that explain no difference which stays with the same inputs behind the first scan."""
_FIRST_SCANS = 2
_OF_EVOLUTION = frozenset(
    {STABILITY, SELECTION, START, "initial step", "condition", "transition", "min time", "minimum time"}
)
"""Subjects of items that tell of steps which are active at other times, so that actions are, too."""


class _Influences(NamedTuple):
    """What can change a variable or the flag of a step in the scan in which two tools differ, as they did not before.

    `places`: the paths of its parts of the chart; see `_places`. `names`: in lower case the variable or step itself
    and the variables that these parts read, by which a cause may reach it in the same scan. `permanent`: permanent
    instructions have one of them.
    """

    places: tuple[str, ...]
    names: frozenset[str]
    permanent: bool
    is_step: bool

    @classmethod
    def on(cls, name: str, example: Counterexample, chart: Chart) -> _Influences:
        """Return what can change what has a `name` in a comparison."""
        places = tuple(dict.fromkeys(_places(name, example, chart)))
        bare = name.removesuffix(".X").rpartition(".")[2]
        names = frozenset({bare.casefold(), *_read_at(places, chart)})
        return cls(places, names, not names.isdisjoint(_permanent_names(chart)), name.endswith(".X"))

    def include(self, item: Item, chart: str) -> bool:
        """True if an item tells of a place, or names something, that can change what differs.

        Of the `chart` as a whole only those that tell of its evolution concern its steps without naming them.
        """
        if any(_is_related(item.path, place) for place in self.places) and item.path != chart:
            return True
        if item.what.startswith("permanent instruction"):
            return self.permanent
        told = f"{ObjectPath.of(item.path).last if item.path != chart else ''} {item.what}; {item.why}"
        return any(_names(told, name) for name in self.names) or (self.is_step and item.what in _OF_EVOLUTION)


def _is_related(path: str, place: str) -> bool:
    """True if one of two paths is in the other, or is the same."""
    return f"{place} / ".startswith(f"{path} / ") or f"{path} / ".startswith(f"{place} / ")


def _names(text: str, name: str) -> bool:
    """True if a text of the report has a name; one that is a word of English, too, where a name is expected only."""
    before, behind = (r"(?:^|[`(;]\s*)", r"(?=[`,):])") if name.casefold() in _WORDS else (r"(?<![\w.])", r"(?!\w)")
    return re.search(f"{before}{re.escape(name)}{behind}", text, re.IGNORECASE) is not None


_WORDS = frozenset(
    "a an and as at be by do done first go i in is it no not of off on one or out start step the then to".split()
)
"""Short words of reports that may be names of variables as well."""


def _permanent_names(chart: Chart) -> set[str]:
    project = chart.pou.project
    return (
        {name for each in chart.chart.permanent for name in names_in(each, project.dialect)}
        if project is not None
        else set()
    )


def _read_at(places: Iterable[str], chart: Chart) -> Iterator[str]:
    """Yield the variables that conditions and actions at some places of a chart read."""
    project = chart.pou.project
    if project is None:
        return
    wanted, actions = set(places), actions_by_name(chart.pou)
    for network, path in _networks(chart):
        labels = network.labels()
        for transition in network.transitions:
            if f"{path} / transition {labels.get(transition.id, '')}" in wanted:
                yield from names_in(transition, project.dialect)
        for step, row in network.associations():
            if f"{path} / step {step.name} / {_told_row(row)}" in wanted:
                yield from (name for read in _reads(step, row, actions, project.dialect) for name in read)


def _networks(chart: Chart) -> Iterator[tuple[SfcNetwork, str]]:
    """Yield a chart and the partial charts in it, with their paths."""
    yield chart.chart, chart.report_path
    for partial_chart in chart.chart.partial_charts:
        yield partial_chart.chart, f"{chart.report_path} / {partial_chart.name}"


def _places(name: str, example: Counterexample, chart: Chart) -> Iterator[str]:
    """Yield the paths of what determines something of a chart: transitions of a step, actions that write a variable."""
    for network, path in _networks(chart) if name.endswith(".X") else ():
        step = next((each for each in network.steps if _is_shown(each, network, chart, {name[:-2]})), None)
        if step is None:
            continue
        labels = network.labels()
        active = example.left.active(len(example.inputs) - 2) if len(example.inputs) > 1 else []
        is_active = {each.id: _is_shown(each, network, chart, active) for each in network.steps}
        before = {each.id for each in network.steps if is_active[each.id] or (not active and each.initial)}
        for transition in network.transitions:
            if step.id in (*transition.sources, *transition.targets) and before.issuperset(transition.sources):
                yield f"{path} / transition {labels[transition.id]}"
        return
    near = {step for scan in range(len(example.inputs))[-2:] for step in example.left.active(scan)}
    found = [(_is_shown(each.step, each.network, chart, near), each.place) for each in _writers(name, chart)]
    yield from [place for is_near, place in found if is_near] or [place for _, place in found]


def _is_shown(step: Step, network: SfcNetwork, chart: Chart, names: Collection[str]) -> bool:
    """True if a step of a chart, or of a partial chart in it (``G1.M2.E2``), is among names of steps in a trace."""
    if network is chart.chart:
        return step.name in names
    return any(step.name in name.split(".") for name in names)


class _Writer(NamedTuple):
    """A row that writes a variable, also of an action of a step; `told`: the action in words."""

    network: SfcNetwork
    step: Step
    row: ActionAssociation
    told: str
    place: str


def _writers(name: str, chart: Chart) -> Iterator[_Writer]:
    """Yield the writers of a variable."""
    if chart.pou.project is None:
        return
    for network, path in _networks(chart):
        scans = SharedScans(network, chart.pou, chart.pou.project.dialect)
        rows = [(step, row, _told_row(row)) for step, row in network.associations()]
        for step in network.steps:
            for kind in _STEP_ACTIONS:
                action = getattr(step, kind.replace(" ", "_"))
                own = {"target": action} if isinstance(action, str) else {"body": action}
                rows += [(step, ActionAssociation(id=0, **own), kind)] if action is not None else []
        for step, row, told in rows:
            if scans.writes((step, row), name):
                yield _Writer(network, step, row, told, f"{path} / step {step.name} / {told}")


def _told_row(row: ActionAssociation) -> str:
    return f"action {row.target or 'in place'}"


def _reads(
    step: Step, row: ActionAssociation, actions: Mapping[str, Action], dialect: Dialect
) -> frozenset[tuple[str, ...]]:
    """Return what a row of a step reads, by the paths of its variables in lower case."""
    none = dict.fromkeys(kind.replace(" ", "_") for kind in _STEP_ACTIONS)
    alone = step.model_copy(update={"actions": [row], "supervision": None, **none})
    return step_effects([alone], actions, dialect).reads


def _listed(names: Sequence[str]) -> str:
    """Return some names in one phrase."""
    shown = [*names[:_LISTED], *([f"{len(names) - _LISTED} more"] if len(names) > _LISTED else [])]
    return " and ".join(filter(None, [", ".join(shown[:-1]), shown[-1]]))


_LISTED = 3


def concerns(item: Item, path: str) -> bool:
    """True if an item is of a chart or of something in it, or of the object that the chart is in."""
    inside, place = f"{path} / ", f"{item.path} / "
    return place.startswith(inside) or inside.startswith(place)


class HeldInputs(NamedTuple):
    """Inputs that keep a value in another run, and what of the tools that run leaves out."""

    values: Mapping[str, Value]
    texts: Mapping[str, str]
    why: str
    is_changed: bool
    """True if one of them changes in the run that differs and determines what differs."""

    def told(self, verdict: Verdict, difference: Sequence[str]) -> list[str]:
        """Return what their changes have to do with a difference, by the `verdict` on the other run; empty if nothing.

        `difference`: that of the other run in words, where it has one.
        """
        held = " and ".join(f"`{name}` stays {text}" for name, text in self.texts.items())
        if not verdict.different:
            found = verdict.summary if verdict.equal else "equal as far as they ran"
            return [f"while {held}, both are {found}: {self.why}"]
        return [self.why, f"while {held}: {'; '.join(difference)}"] if self.is_changed and difference else []


def held_inputs(
    example: Counterexample, inputs: Iterable[str], chart: Chart, profiles: tuple[Profile, Profile], tool: str
) -> Iterator[HeldInputs]:
    """Yield inputs whose changes tools see at other times: times of actions of a chart, and what its actions read.

    Times keep the value of their start, or a second, others that of the scan before a difference.
    """
    rows = list(chart.chart.associations())
    durations = {(row.duration or "").casefold() for _, row in rows}
    known = {variable.name: variable.initial for variable in chart.pou.variables()}
    initial = {name: known.get(name) for name in inputs if name.casefold() in durations}
    if initial:
        start = {name: each.text if isinstance(each, SimpleValue) else "" for name, each in initial.items()}
        times = {name: text or "T#1s" for name, text in start.items()}
        differing = {each.name.rpartition(".")[2].casefold() for each in example.differences}
        used = {(row.duration or "").casefold() for _, row in rows if (row.target or "").casefold() in differing}
        changed = any(len({row.get(name) for row in example.inputs}) > 1 for name in times if name.casefold() in used)
        why = "tools differ in when they take up a new time of an action that runs"
        yield HeldInputs(times, times, why, changed)
    early = acting_early(profiles, tool)
    if early and len(example.inputs) > 1:
        from plcopen_sfc.analysis.verdict import shown_value  # noqa: PLC0415  # charts that differ have brought it

        before = example.inputs[-2]
        names = [name for name in _read_inputs(example, chart) if _is_changed(name, example)]
        values = {name: before[name] for name in names}
        texts = {name: shown_value(value, example.left[name].signal) for name, value in values.items()}
        if names:
            yield HeldInputs(values, texts, early, is_changed=False)


def _is_changed(name: str, example: Counterexample) -> bool:
    """True if an input changes in the scan of a difference."""
    last, before = example.inputs[-1], example.inputs[-2:][0]
    return last.get(name) != before.get(name, last.get(name))


def _read_inputs(example: Counterexample, chart: Chart) -> Iterator[str]:
    """Yield the inputs that the actions read which write what differs: those of active steps, and stored ones."""
    project = chart.pou.project
    if project is None:
        return
    near = {step for scan in range(len(example.inputs))[-2:] for step in example.left.active(scan)}
    actions, reads = actions_by_name(chart.pou), set[tuple[str, ...]]()
    for each in example.differences:
        for writer in _writers(each.name, chart):
            if _is_shown(writer.step, writer.network, chart, near) or writer.row.qualifier in STORING:
                reads |= _reads(writer.step, writer.row, actions, project.dialect)
    for name in example.inputs[-1]:
        wanted = tuple(name.casefold().split("."))
        if any(path and (path == wanted or path == wanted[-1:]) for path in reads):
            yield name


def told_apart(example: Counterexample, chart: Chart, profiles: tuple[Profile, Profile], tool: str) -> list[str]:
    """Return why tools differ that are equal with actions that see earlier inputs, and a first scan at rest."""
    held, early = told_held(profiles, tool), acting_early(profiles, tool)
    evolves = any(each.name.endswith(".X") for each in example.differences)
    if len(example.inputs) > _FIRST_SCANS and early:  # actions that see other inputs need a step that was entered
        held = ""
    elif held and evolves:  # steps are others because of a transition
        early = ""
    return [*([held] if held else []), *([_told_early(example, chart, profiles, tool)] if early else [])]


def _told_early(example: Counterexample, chart: Chart, profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return what shows that one of two tools executes the actions first: inputs, the start, or times of steps."""
    early = acting_early(profiles, tool)
    first = tool if profiles[1].order is ScanOrder.ACTIONS_FIRST else "the source"
    read = [*_read_inputs(example, chart)]
    if any(_is_changed(name, example) for name in read):
        return early
    if begun := _told_begun(example, chart, profiles, tool):
        return begun
    order = f"{first} executes the actions before the transitions"
    if not read and any(each.name.endswith(".X") for each in example.differences if not each.error):
        return f"{order}, and so compares the times of steps a scan later"
    return early if read else order


def _told_begun(example: Counterexample, chart: Chart, profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return which tool is a scan late but for its initial step, if an action of that differs; else empty."""
    if profiles[0].order is profiles[1].order:
        return ""
    is_late = profiles[1].order is ScanOrder.ACTIONS_FIRST
    first, other = (tool, "the source") if is_late else ("the source", tool)
    writers = (each for difference in example.differences for each in _writers(difference.name, chart))
    scans = len(example.inputs) - (1 if is_late else 0)
    if not any(_is_begun_once(each.step, each.network, example, chart, scans) for each in writers):
        return ""
    return f"{first} executes the actions of the initial step in its first scan, and others a scan later than {other}"


def only_one(profiles: tuple[Profile, Profile], tool: str, is_so: Callable[[Profile], bool]) -> str:
    """Return which of two tools alone does something: the source, or `tool`; empty where both or none do."""
    found = [name for name, each in zip(("the source", tool), profiles, strict=True) if is_so(each)]
    return found[0] if len(found) == 1 else ""


def acting_first(profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return which of two tools executes the actions first; empty where both or none do."""
    early = only_one(profiles, tool, lambda each: each.order is ScanOrder.ACTIONS_FIRST)
    return early and f"{early} executes the actions before the transitions"


def acting_early(profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return which of two tools executes the actions first, and what follows; empty where both or none do."""
    early = acting_first(profiles, tool)
    return early and f"{early}, and so sees other inputs in them"


def told_held_calls(profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return which of two tools holds the start of each chart when it is called first; empty where both or none do."""
    held = only_one(profiles, tool, lambda each: each.initial_situation_held)
    return held and f"{held} tests no transition of a chart in the scan that calls it first"


def told_held(profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return which of two tools holds the initial situation in the first scan; empty where both or none do."""
    held = only_one(profiles, tool, lambda each: each.initial_situation_held)
    return held and f"{held} tests no transition in its first scan"
