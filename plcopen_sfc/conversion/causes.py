"""Words for a difference that a run of source and target found, with its cause as far as that is known."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.conversion.executed_charts import WRITTEN
from plcopen_sfc.conversion.executed_parts import FIRST_SCAN, SELECTION, STABILITY, START
from plcopen_sfc.languages.binding import STORING, SharedScans, actions_by_name, step_effects
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.project import Chart
from plcopen_sfc.model.sfc import ActionAssociation, Step
from plcopen_sfc.model.types import SimpleValue
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import INPUTS_OF_ACTIONS, START_OF_CHART, Item
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
    rule: str = "",
) -> str:
    """Return the difference of a chart of the source in `tool`, and its explanation: the first that applies.

    The `rule` of the tools without which both do the same; where the chart evolves otherwise, a rule or one of the
    `losses` on that; one of the other `losses`; when variables are written; the parts of the chart that determine what
    differs.
    """
    scans = counted(len(example.inputs), "scan")
    shown = str(example.differences[0]).replace("in the first", "in the source").replace("in the second", f"in {tool}")
    more = [each.name.removesuffix(".X") for each in example.differences[1:] if not each.error]
    others = f"; {_listed(more)} {'differs' if len(more) == 1 else 'differ'}, too" if more else ""
    causes = rule or _causes(example, chart, losses, profiles, tool)
    return f"it does something else after {scans}: {shown}{others}{causes}"


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
) -> str:
    evolution: dict[str, None] = {}
    found: dict[str, None] = {}
    parts: dict[str, None] = {}
    # From the surest explanation to the vaguest. Only what the report lists, or what the profiles are known for, is
    # called a cause; else these are places to look at.
    evolves = any(each.name.endswith(".X") for each in example.differences)
    if evolves and len(example.inputs) <= _FIRST_SCANS and (held := _told_held(profiles, tool)):
        return held
    first = [item for item in losses if item.what == FIRST_SCAN and concerns(item, chart.report_path)]
    if first and not evolves and len(example.inputs) == 1:
        return f"; a cause is the {FIRST_SCAN}, which the report names"
    for name in (each.name for each in example.differences if not each.error):
        places = dict.fromkeys(_places(name, example, chart))
        for item in losses:
            if item.what not in _SEPARATE and _explains(item, name, places, chart.report_path):
                part = "" if item.path == chart.report_path else f" at {ObjectPath.of(item.path).last}"
                told = f"; a cause is the {item.what}{part}, which the report names"
                (evolution if evolves and item.what in _OF_EVOLUTION else found)[told] = None
        parts |= dict.fromkeys(map(_called, places))
    if evolution or found:
        return "".join([*evolution, *found][:_LISTED])
    if started := _told_start(example, chart, profiles, tool):
        return started
    written = _written_at(chart, profiles, tool)
    for name in (each.name for each in example.differences if each.name in written):
        return f"; {written[name]}"
    if any(item.what == START and concerns(item, chart.report_path) for item in losses):
        return f"; look at the {START}, which the report names"
    order = ": tools have an order of their own for what writes a variable in one scan"
    return f"; look at {_listed([*parts])}{order if len(parts) > 1 and not evolves else ''}" if parts else ""


def _told_start(example: Counterexample, chart: Chart, profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return which tool takes its start for no activation of the initial steps, where that matters; else empty."""
    if profiles[0].initial_steps_entered is profiles[1].initial_steps_entered:
        return ""
    side = tool if profiles[0].initial_steps_entered else "the source"
    begun = {step.name: {"entry action"} for step in chart.chart.steps if step.initial}
    for step, row in chart.chart.associations():
        if step.name in begun and row.qualifier is not Qualifier.N:
            begun[step.name].add(f"action {row.target or 'in place'}")
    for name in (each.name for each in example.differences if not each.error):
        if any(last in begun.get(step, ()) for step, last in _writers(name, chart)):
            return f"; the start is no activation of the initial step in {side}: what begins with that is not executed"
    return ""


def _is_begun_once(step: str, example: Counterexample, *, is_late: bool) -> bool:
    """True if a step is active from the first scan, and not entered again, on the second side where `is_late`."""
    trace = example.right if is_late else example.left
    active = [step in trace.active(scan) for scan in range(len(example.inputs))]
    return active[0] and not any(now and not before for before, now in pairwise(active))


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


def _explains(item: Item, name: str, places: Iterable[str], chart: str) -> bool:
    """True if an item is of the chart as a whole, of one of some `places` in it, or names what differs."""
    if not concerns(item, chart):
        return False
    bare = re.escape(name.removesuffix(".X").rpartition(".")[2])
    if item.path == chart or re.search(rf"\b{bare}\b", f"{item.path.rpartition(' / ')[2]} {item.why}"):
        return True
    return any(
        f"{place} / ".startswith(f"{item.path} / ") or f"{item.path} / ".startswith(f"{place} / ") for place in places
    )


def _places(name: str, example: Counterexample, chart: Chart) -> Iterator[str]:
    """Yield the paths of what determines something of a chart: transitions of a step, actions that write a variable."""
    sfc, path = chart.chart, chart.report_path
    step = next((each for each in sfc.steps if f"{each.name}.X" == name), None)
    if step is not None:
        labels = sfc.labels()
        active = example.left.active(len(example.inputs) - 2) if len(example.inputs) > 1 else []
        before = {each.id for each in sfc.steps if each.name in active or (not active and each.initial)}
        for transition in sfc.transitions:
            if step.id in (*transition.sources, *transition.targets) and before.issuperset(transition.sources):
                yield f"{path} / transition {labels[transition.id]}"
    else:
        near = {step for scan in range(len(example.inputs))[-2:] for step in example.left.active(scan)}
        found = [(step, f"{path} / step {step} / {last}") for step, last in _writers(name, chart)]
        yield from [place for step, place in found if step in near] or [place for _, place in found]


def _writers(name: str, chart: Chart) -> Iterator[tuple[str, str]]:
    """Yield the writers of a variable: the name of a step, and the action."""
    return ((step.name, called) for step, called, _ in _writing_rows(name, chart))


def _writing_rows(name: str, chart: Chart) -> Iterator[tuple[Step, str, ActionAssociation]]:
    """Yield the rows that write a variable: the step, the action in words, and the row, also of an action of a step."""
    if chart.pou.project is None:
        return
    scans = SharedScans(chart.chart, chart.pou, chart.pou.project.dialect)
    for owner, row in chart.chart.associations():
        if scans.writes((owner, row), name):
            yield owner, f"action {row.target or 'in place'}", row
    for owner in chart.chart.steps:
        for kind in _STEP_ACTIONS:
            action = getattr(owner, kind.replace(" ", "_"))
            own = {"target": action} if isinstance(action, str) else {"body": action}
            row = ActionAssociation(id=0, **own)
            if action is not None and scans.writes((owner, row), name):
                yield owner, kind, row


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

    def told(self, verdict: Verdict, difference: str) -> str:
        """Return what their changes have to do with a difference, by the `verdict` on the other run; empty if nothing.

        `difference`: that of the other run in words, where it has one.
        """
        held = " and ".join(f"`{name}` stays {text}" for name, text in self.texts.items())
        if not verdict.different:
            found = str(verdict).splitlines()[0] if verdict.equal else "equal as far as they ran"
            return f"; while {held}, both are {found}: {self.why}"
        return f"; {self.why}; while {held}: {difference}" if self.is_changed and difference else ""


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
        for step, _, row in _writing_rows(each.name, chart):
            if step.name in near or row.qualifier in STORING:
                none = dict.fromkeys(kind.replace(" ", "_") for kind in _STEP_ACTIONS)
                alone = step.model_copy(update={"actions": [row], "supervision": None, **none})
                reads |= step_effects([alone], actions, project.dialect).reads
    for name in example.inputs[-1]:
        wanted = tuple(name.casefold().split("."))
        if any(path and (path == wanted or path == wanted[-1:]) for path in reads):
            yield name


def told_apart(example: Counterexample, chart: Chart, profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return why tools differ that are equal with actions that see earlier inputs, and a first scan at rest."""
    held, early = _told_held(profiles, tool), acting_early(profiles, tool)
    evolves = any(each.name.endswith(".X") for each in example.differences)
    if len(example.inputs) > _FIRST_SCANS and early:  # actions that see other inputs need a step that was entered
        held = ""
    elif held and evolves:  # steps are others because of a transition
        early = ""
    return held + (f"; {_told_early(example, chart, profiles, tool)}" if early else "")


def _told_early(example: Counterexample, chart: Chart, profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return what shows that one of two tools executes the actions first: inputs, the start, or times of steps."""
    early = acting_early(profiles, tool)
    is_late = profiles[1].order is ScanOrder.ACTIONS_FIRST
    first, other = (tool, "the source") if is_late else ("the source", tool)
    read = [*_read_inputs(example, chart)]
    if any(_is_changed(name, example) for name in read):
        return early
    names = [each.name for each in example.differences if not each.error]
    begun = {step.name for step in chart.chart.initial_steps if _is_begun_once(step.name, example, is_late=is_late)}
    if any(step in begun for name in names for step, _ in _writers(name, chart)):
        what = "the actions of the initial step in its first scan, and others a scan later than"
        return f"{first} executes {what} {other}"
    order = f"{first} executes the actions before the transitions"
    if not read and any(name.endswith(".X") for name in names):
        return f"{order}, and so compares the times of steps a scan later"
    return early if read else order


def acting_early(profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return which of two tools executes the actions first; empty where both or none do."""
    sides = {True: "the source", False: tool}
    early = [sides[each is profiles[0]] for each in profiles if each.order is ScanOrder.ACTIONS_FIRST]
    why = "executes the actions before the transitions, and so sees other inputs in them"
    return f"{early[0]} {why}" if len(early) == 1 else ""


def _told_held(profiles: tuple[Profile, Profile], tool: str) -> str:
    sides = {True: "the source", False: tool}
    held = [sides[each is profiles[0]] for each in profiles if each.initial_situation_held]
    return f"; {held[0]} tests no transition in its first scan" if len(held) == 1 else ""
