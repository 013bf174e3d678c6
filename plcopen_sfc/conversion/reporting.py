"""Differences in what is executed as items of a `ConversionReport`, in the words of an engineer."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from plcopen_sfc.conversion.executed_parts import (
    BOOLEAN_ACTIONS,
    OPERATING_INPUT,
    OPERATING_KINDS,
    PLAIN_VARIABLES,
    PROGRAM_CALL,
    RESTING_INPUT,
    SHOWN_STATE,
    STORED,
    UNDECLARED,
    UNDECLARED_TYPE,
    UNUSED_INPUT,
)
from plcopen_sfc.conversion.execution_differences import OF_LIBRARY, ExecutionDifference
from plcopen_sfc.conversion.meaning import UNREAD_CONDITION, UNREAD_NETWORK
from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import (
    LOSSES,
    CauseKind,
    ConversionReport,
    Item,
    Outcome,
)

UNSAID = "; nothing was said of it while writing: please report this as a mistake of plcopen_sfc"
"""The end of what is said of a difference that the reader of the target found, and no writer had named."""

_SHOWN = 60
_LISTED = 5


def report_execution(
    report: ConversionReport, differences: Iterable[ExecutionDifference], tool: str, called: Mapping[str, str]
) -> None:
    """Add to `report` what the target `tool` does not execute, or executes otherwise.

    Items that a writer has listed as translated or as lost are not listed again. What it has noted as extension
    data is taken out where it is not executed. A difference at a place of which no writer has said anything is a
    mistake of this package, and the item names it so. `called` gives the paths in the source of what has another
    name in the target.
    """
    if called:
        report.items = [replace(item, path=in_the_source(item.path, called)) for item in report.items]
        differences = [_of_the_source(difference, called) for difference in differences]
    refused = {ObjectPath.of(item.path).owner for item in report.losses if item.what == "hierarchy"}
    # rules that change a chart report before its writer, which finds as it is what they could not change, and says so
    why_not = {item.path for item in report.with_outcome(Outcome.NOT_EXECUTED) if not _follows(item)}
    report.items = [
        item
        for item in report.items
        if not _is_of_refused(item, refused) and not (_follows(item) and item.path in why_not)
    ]
    settled = Counter(
        (_unnumbered(item.path), item.what)
        for item in report.items
        if item.outcome in LOSSES or item.outcome is Outcome.TRANSLATED
    )
    listed = _Listed.of(report, refused)
    # what is left was found by comparing source and result; most of it is told already, in the words of a writer
    found = list(_without_repetition(differences, {_last(path) for path, what in settled if what == "global variable"}))
    rewritten = _rewritten_steps(found, settled)
    changed = {(difference.path, difference.aspect) for difference in found}
    spelt = {around.casefold(): around for each in found for around in ObjectPath.of(each.path).outwards()}
    paths = (item.path for item in report.items if item.outcome is not Outcome.KEPT)
    noticed = {spelt.get(path.casefold(), path) for path in paths}  # a writer may spell a name as a use of it does
    around_noticed = {around for path in noticed for around in ObjectPath.of(path).outwards()}
    told = set()
    for difference in found:
        what = difference.aspect or difference.kind
        place = difference.path
        names = {
            (_unnumbered(place), each)
            for each in (what, *_ALSO_CALLED.get("code" if what.startswith("code ") else what, ()))
        }
        names |= {(_unnumbered(place), each) for each in OPERATING_KINDS if what in OPERATING_KINDS}
        if difference.kind == "method":
            names.add((ObjectPath.of(place).around, "methods"))
        if listed.has(difference) or names & settled.keys() or _is_rewritten(difference, rewritten, settled, changed):
            continue
        told |= names
        why = _why(difference, tool)
        is_box = difference.kind == UNDECLARED and difference.left not in (None, OF_LIBRARY)
        if not (
            is_box
            or _is_noticed(difference, noticed, around_noticed)
            or _is_final_scan(difference)
            or _is_later(difference)
        ):
            why += UNSAID
        report.items.append(Item(_outcome(difference), what, place, why))
    report.items = [item for item in report.items if not _is_superseded(item, told)]


@dataclass(frozen=True, slots=True)
class _Listed:
    """Losses that a writer has listed: differences that follow from them are told already.

    `refused` are the charts that the target cannot have at all, `lost` the paths and kinds of all losses. `instead` are
    names in the written text in the place of something, `replaced` the paths of that; `words` are names that the
    target lacks, `losing` the objects with something that is not executed.
    """

    refused: set[str]
    lost: set[tuple[str, str]]
    instead: set[str]
    replaced: set[str]
    words: set[str]
    losing: set[str]

    @classmethod
    def of(cls, report: ConversionReport, refused: set[str]) -> _Listed:
        losses = report.losses
        told = [(item.cause, item.path) for item in losses if item.cause is not None]
        instead = [each for each in told if each[0].kind is CauseKind.PLACEHOLDER]
        return cls(
            refused,
            {(item.path, item.what) for item in losses},
            {cause.name for cause, _ in instead},
            {_bare(path) for _, path in instead},
            {cause.name.casefold() for cause, _ in told if cause.kind is CauseKind.LACKING},
            {ObjectPath.of(item.path).owner for item in report.with_outcome(Outcome.NOT_EXECUTED)},
        )

    def has(self, difference: ExecutionDifference) -> bool:
        """True if a difference follows from a loss that is listed."""
        place, kind, name = difference.path, difference.kind, difference.name
        if (kind == "chart" and place in self.refused) or (f"{place} / {difference.aspect}", "flag") in self.lost:
            return True
        if difference.left is None and kind in (UNDECLARED, "action") and name in self.instead:
            return True
        if difference.aspect in _WRITTEN_OTHERWISE and (difference.right or "").partition(" ")[0] in self.instead:
            return True
        if kind in (UNDECLARED, UNDECLARED_TYPE) and name.casefold() in self.words:
            return True
        if kind == UNDECLARED and difference.left == "" and (place, "condition") in self.lost:  # it was not translated
            return True
        if kind == UNDECLARED and name.startswith(_PLACEHOLDERS) and ObjectPath.of(place).owner in self.losing:
            return True
        if kind == "action" and (
            self.lost & {(place, "action"), (place, "condition")} or _bare(place) in self.replaced
        ):
            return True
        if kind == "global variable":  # a variable of a program that is a tag
            return any(what == difference.aspect and path.endswith(f" / {name}") for path, what in self.lost)
        if kind == "transition" and (difference.left or "").upper() == "FALSE":
            # SFCTip alone fires it, of which it is told that the target does not obey it
            tip = f"{ObjectPath.of(place).around} / {SfcFlag.TIP.variable}"
            return any((tip, each) in self.lost for each in OPERATING_KINDS)
        return False


def _of_the_source(difference: ExecutionDifference, called: Mapping[str, str]) -> ExecutionDifference:
    """Return a difference with the paths that its parts have in the source."""
    steps = tuple(in_the_source(step, called) for step in difference.steps)
    return replace(difference, path=in_the_source(difference.path, called), steps=steps)


def _unnumbered(path: str) -> str:
    """Return a path without the number of a transition: between the same steps the target may count otherwise."""
    return _NUMBER.sub(r"\g<steps>", path)


_NUMBER = re.compile(r"(?<= -> )(?P<steps>[^/]+) \(\d+\)$")


def _is_of_refused(item: Item, refused: Iterable[str]) -> bool:
    """True for a loss that is that of the whole chart of a GRAFCET, whose hierarchy the target cannot have."""
    of_chart = item.what in _OF_PARTIAL_CHARTS and item.path in refused
    is_own_text = item.cause is not None and item.cause.kind is CauseKind.GRAFCET_TEXT
    return item.outcome in LOSSES and (
        of_chart or (is_own_text and any(item.path.startswith(f"{path} / ") for path in refused))
    )


def _follows(item: Item) -> bool:
    """True for what a writer tells of an action or a text that it finds as another tool has it: that it stays so.

    Where the rules for a GRAFCET could not rewrite something, they have given their own reason.
    """
    kinds = (CauseKind.AS_IT_IS, CauseKind.GRAFCET_TEXT)
    return item.outcome is Outcome.NOT_EXECUTED and item.cause is not None and item.cause.kind in kinds


_OF_PARTIAL_CHARTS = ("partial charts", "chart partial charts", "chart")


def report_errors(report: ConversionReport, found: Iterable[Diagnostic], tool: str, called: Mapping[str, str]) -> None:
    """Add the errors that reading the written file has `found`, where no loss at the same place tells them already."""
    lost = [ObjectPath.of(item.path) for item in report.items if item.outcome in LOSSES]
    for error in found:
        place = ObjectPath.of(in_the_source(error.location.path or "", called))
        is_told = any(path[: len(place.parts)] == place.parts for path in (each.parts for each in lost))
        # readers name a block as its tool does: FB Main
        is_told |= len(place.parts) == 1 and any(_name_of(path.owner) == _name_of(place) for path in lost)
        if not is_told:
            why = f"the written file has an error for {tool}: {error.message} ({error.code})"
            report.add(Outcome.NOT_EXECUTED, "error", place, why)


def _name_of(path: str) -> str:
    return path.partition(" ")[2]


_WRITTEN_OTHERWISE = ("condition", "interlock", "supervision", "code")
"""Aspects in whose place writers put an undeclared name."""
_PLACEHOLDERS = ("NOT_EXECUTED_", "NOT_TRANSLATED_")
"""Beginnings of such names: the loss in the same POU tells it, even where its cause does not have the name."""


def _rewritten_steps(differences: Iterable[ExecutionDifference], settled: Counter[tuple[str, str]]) -> set[str]:
    """Return the steps whose actions a writer has rewritten: it accounts for each of them that is not found again."""
    missing: dict[str, set[str]] = {}
    found = list(differences)
    changed = {(difference.path, difference.aspect) for difference in found}
    for difference in found:
        if difference.kind == "action" and _is_at_other_times(difference, changed):
            continue
        if difference.kind == "action" and difference.left is not None and len(difference.steps) == 1:
            missing.setdefault(difference.steps[0], set()).add(difference.path)
    told: Counter[str] = Counter()
    for (path, what), count in settled.items():
        if what in _ACTIONS:
            told[_step_of(path)] += count
    return {step for step, count in told.items() if count >= len(missing.get(step, ()))}


def _step_of(path: str) -> str:
    """Return the step that something belongs to; the path itself where it is in no step."""
    found = (each for each in reversed([*ObjectPath.of(path).outwards()]) if each.last.startswith("step "))
    return next(found, ObjectPath.of(path))


_ACTIONS = ("action", "action association", "entry action", "main action", "exit action")


def _is_rewritten(
    difference: ExecutionDifference,
    rewritten: set[str],
    settled: Counter[tuple[str, str]],
    changed: set[tuple[str, str]],
) -> bool:
    """True if a writer accounts for it: actions as statements, supervisions and times in the conditions behind them.

    `changed` are the aspects that differ, by the paths of their parts.
    """
    if _is_at_other_times(difference, changed):
        return False
    if difference.kind == "action" or difference.aspect == "interlock":
        return bool(difference.steps) and set(difference.steps) <= rewritten
    if difference.aspect == "condition" and difference.is_stronger:
        return any(settled[step, what] for step in difference.steps for what in ("supervision", "min time"))
    if difference.aspect == "type":
        owner = ObjectPath.of(difference.path).owner
        return any(what == "length of a string" and ObjectPath.of(path).owner == owner for path, what in settled)
    if difference.aspect in ("initial value", "start values", "retain"):
        return False
    if difference.kind in _OF_THE_PROJECT - _OF_THE_CONFIGURATION:
        name = difference.name.rpartition(".")[2]
        return any(path.replace(".", " ").split(" ")[-1] == name for path, _ in settled)
    if difference.aspect == "acknowledge errors required":
        return any(what == "supervision" and path.startswith(difference.path) for path, what in settled)
    if difference.kind in ("step", "transition") and difference.left is None:  # it stays, but does nothing
        chart = ObjectPath.of(difference.path).around
        return any(what == "exclude" and path.startswith(chart) for path, what in settled)
    return False


def _is_at_other_times(difference: ExecutionDifference, changed: set[tuple[str, str]]) -> bool:
    """True if an action is there, and executed at other times."""
    if _is_later(difference):
        return True
    return difference.aspect in ("trigger", "final scan") and (difference.path, "code") not in changed


def _is_superseded(item: Item, told: set[tuple[str, str]]) -> bool:
    """True for extension data of which it is said now that the target does not execute it."""
    if item.outcome is not Outcome.EXTENSION_DATA:
        return False
    return any(what == item.what and ObjectPath.of(path).is_in(item.path) for path, what in told)


_ALSO_CALLED = {
    "step": ("exclude",),
    "transition": ("exclude",),
    "kind": ("program",),
    "trigger": ("event", "qualifier"),
    "permanent instruction before the sequence": ("chart permanent pre", "permanent pre"),
    "permanent instruction after the sequence": ("chart permanent post", "permanent post"),
    "variable": ("section",),
    "type": ("data type", "length of a string", "instance"),
    "action of the POU": ("body",),
    "initial value": ("data type", "initial"),
    "max time": ("maximum time",),
    "min time": ("minimum time",),
    "code": ("body", "network", "IL body"),
    "drawn logic": ("logic",),
    "extends": ("type",),
    "union": ("type",),
    "macro-step": ("macro",),
}
"""Other names that writers have for an aspect or a part."""


def _without_repetition(differences: Iterable[ExecutionDifference], said: set[str]) -> Iterator[ExecutionDifference]:
    """Yield the differences, but of the interlock of a step only the actions that run without it, and lists as a whole.

    `said`: the global variables that a writer has listed already, as lost or with their values in texts.
    """
    found = list(differences)
    without = {ObjectPath.of(d.path).around for d in found if d.kind == "action" and d.aspect == "interlock"}
    lists: dict[str, list[str]] = {}
    # an operating input that a chart has no longer may be obeyed all the same: code that writes it needs a variable
    missing = {_last(d.name) for d in found if d.right is None and not d.aspect and d.kind not in OPERATING_KINDS}
    missing |= {d.name.partition(".")[0].casefold() for d in found if d.kind == "global variable"}
    for difference in found:
        if difference.kind == UNDECLARED and difference.name.casefold() in missing:
            continue
        if difference.aspect == "interlock" and difference.path in without:
            continue
        if difference.kind == "global variable" and not difference.aspect and "." in difference.name:
            around, _, name = difference.name.partition(".")
            if name.casefold() in said:
                continue
            lists.setdefault(around, []).append(name)
            continue
        yield difference
    for around, names in lists.items():
        shown = ", ".join(names[:_LISTED]) + (f" and {len(names) - _LISTED} more" if len(names) > _LISTED else "")
        yield ExecutionDifference(f"global variables {around}", "global variables", around, "", shown, None)


def _last(name: str) -> str:
    return name.rpartition(".")[2].casefold()


def _bare(path: str) -> str:
    """Return the path of an action without what not all writers say of it: its kind, and the signs of S7."""
    parts = ObjectPath.of(path).parts
    bare = (*parts[:1], *(part.removeprefix("action ") for part in parts[1:]))
    return ObjectPath(*(part.replace("#", "").replace('"', "") for part in bare))


def _a(noun: str) -> str:
    return f"an {noun}" if noun[:1] in "aeiou" else f"a {noun}"


def in_the_source(path: str, called: Mapping[str, str]) -> str:
    """Return the path of something in the source: names may be others in the target."""
    whole = ObjectPath.of(path)
    for around in whole.outwards():
        if around in called:
            return ObjectPath(*ObjectPath.of(called[around]).parts, *whole.inside(around).parts)
    return path


def _is_noticed(difference: ExecutionDifference, noticed: set[str], around_noticed: set[ObjectPath]) -> bool:
    """True if a writer said something of the part, of something in it, or of what it is in."""
    path = ObjectPath.of(difference.path)
    if (
        difference.kind in _OF_THE_PROJECT | _KEPT_AS_TEXT
        or (difference.kind == UNDECLARED and difference.right == "")
        or difference.aspect in _LEFT_TO_THE_READER
        or difference.aspect.startswith(STORED)
        or path in around_noticed
        or (difference.aspect == "condition" and difference.left == UNREAD_CONDITION)  # the reader kept it as it is
    ):
        return True
    return any(around in noticed for around in path.outwards())


_LEFT_TO_THE_READER = {"drawn logic", "order of transitions", "max time", BOOLEAN_ACTIONS}.union(
    "address static kept arguments edge extends implements union section attributes".split()
)
"""Aspects of which no writer speaks: what the target does not say is found when it is read back."""

_OF_THE_CONFIGURATION = frozenset({"task", "program instance", "VAR_CONFIG", PROGRAM_CALL})
_OF_THE_PROJECT = frozenset({"global variable", "global variables", "type"}) | _OF_THE_CONFIGURATION
"""Kinds of parts of which writers speak as a whole: "data blocks", "configurations"."""
_KEPT_AS_TEXT = frozenset({"unit", "property", "data of the tool", UNDECLARED_TYPE}) | OPERATING_KINDS
"""Kinds of parts that writers keep without looking into them."""


def _outcome(difference: ExecutionDifference) -> Outcome:
    """Outcome of a difference: approximated if something is executed once more or besides, else not executed."""
    if difference.kind in (UNDECLARED, UNDECLARED_TYPE) and difference.left == "":
        return Outcome.APPROXIMATED
    if difference.kind in _OPERATED:
        return _OPERATED[difference.kind]
    if difference.aspect == "type" and (difference.left or "").startswith(f"{difference.right} ("):
        return Outcome.APPROXIMATED  # without the bounds of a subrange
    if difference.aspect == BOOLEAN_ACTIONS or difference.aspect.startswith(STORED):  # it is executed, otherwise
        return Outcome.APPROXIMATED
    if difference.kind not in (UNDECLARED, UNDECLARED_TYPE) and (
        difference.left is None or _is_later(difference) or _is_final_scan(difference)
    ):
        return Outcome.APPROXIMATED
    return Outcome.NOT_EXECUTED


_OPERATED = {
    OPERATING_INPUT: Outcome.NOT_EXECUTED,
    UNUSED_INPUT: Outcome.APPROXIMATED,
    RESTING_INPUT: Outcome.TRANSLATED,
}


def _is_later(difference: ExecutionDifference) -> bool:
    """True for the chart of an action where one tool tests transitions and the other executes actions first."""
    return difference.is_of_chart and difference.right is not None


def _is_final_scan(difference: ExecutionDifference) -> bool:
    """True if tools differ in whether they execute an action once more after its step was left."""
    return difference.aspect == "final scan"


def _why(difference: ExecutionDifference, tool: str) -> str:
    left, right = _apart(difference.left, difference.right)
    short = replace(difference, left=_cut(left), right=_cut(right))
    if difference.aspect == "":
        return _whole(short, tool)
    if difference.kind == "action":
        return _action(short, tool)
    left, right, aspect = short.left, short.right, short.aspect
    template = _MISSING.get(aspect)
    if aspect.startswith("code ") and right is None:
        return f"the {aspect.removeprefix('code ')}. body of the POU, `{left}`, is NOT executed in {tool}"
    if template is not None and right is None:
        return template.format(left=left, tool=tool, name=short.name, kind=short.kind)
    if aspect == "kind" and left == "program":
        return f"the program is a {right} in {tool}, which nothing calls"
    if aspect == "address" and left == right:
        return f"{left} is another place in {tool}: one tool counts words where the other counts bytes"
    if aspect == "variables" and left == "its own":
        return f"{short.name} has no variables of its own in {tool}: a program has one set of them for all its calls"
    if aspect == "variables":
        return f"{short.name} has variables of its own in {tool}: in the source all calls of the program share them"
    if aspect == BOOLEAN_ACTIONS:
        return f"{short.name}: other code writes it, too; the chart does so {left} in the source, {right} in {tool}"
    if aspect.startswith(STORED):
        why = "S7-GRAPH executes the rows S and R of an operand in their order; elsewhere R counts"
        return f"{aspect.removeprefix(STORED)} is {right} in {tool} while the step is active, not {left}: {why}"
    if left is None and aspect == "max time":
        return f"exceeding the maximum time {right} sets SFCError in {tool}, and does nothing in the source"
    if left is None:
        return f"{aspect} `{right}` in {tool}, none in the source"
    if left == UNREAD_CONDITION:
        return f"the condition is in a form of its tool that is not read: {tool} does not execute it"
    if difference.left == difference.right and (difference.left or "").startswith(UNREAD_NETWORK):
        return f"it is not known whether the {aspect} does the same in {tool}: {difference.left}"
    if left == right:
        return f"the {aspect} does something else in {tool}: `{left}`"
    if right is None:
        return f"{aspect} has no effect in {tool}" if left in (aspect, "on") else f"{aspect} `{left}` is not in {tool}"
    return f"{aspect} is `{right}` in {tool} instead of `{left}`"


def _whole(difference: ExecutionDifference, tool: str) -> str:
    kind, name = difference.kind, difference.name
    if kind in (UNDECLARED, UNDECLARED_TYPE):
        what = "type" if kind == UNDECLARED_TYPE else "name"
        if difference.left == "":
            return f"the {what} `{name}` is declared neither in the source nor in {tool}, which does not compile it"
        if difference.left == OF_LIBRARY:
            why = "convert the file that declares it as well, or replace it if it is of a library"
            return f"the {what} `{name}` is declared neither in the source nor in {tool}: {why}"
        origin = "" if difference.left is None else f": it is {difference.left} of the library of its tool"
        return f"the {what} `{name}` is not declared in {tool}{origin}"
    if kind in OPERATING_KINDS:
        return f"{name} has no effect in {tool}{_OPERATED_BY[kind]}"
    if kind == "data of the tool":
        return f"only the tool of the source reads this: it is NOT executed in {tool}"
    if kind == "property":
        return f"property `{name}` is not declared in {tool}"
    if difference.left is None:
        return f"{tool} executes {_a(kind)} `{name}` that the source does not"
    if kind == "action":
        how = f" ({difference.left})" if difference.left else ""
        return f"{_called(name)}{how} is NOT executed in {tool}"
    if kind == PROGRAM_CALL:
        return f"`{name}` is a program: in {tool} others can neither call it nor read its variables"
    if kind == "global variables":
        return f"not declared in {tool}: {difference.left}"
    if kind == "start values":
        return f"the data block does not start with the values of its file in {tool}, some of which are not read"
    if kind in ("global variable", "variable", "type"):
        return f"{kind} `{name}` is not declared in {tool}"
    return f"{kind} `{name}` is NOT executed in {tool}" if name else f"the {kind} is NOT executed in {tool}"


_OPERATED_BY = {
    OPERATING_INPUT: "",
    UNUSED_INPUT: ", and nothing in the project operates it",
    RESTING_INPUT: ", and is inactive (--at-rest)",
}


def _called(action: str) -> str:
    return "the action in place" if action == "in place" else f"action `{action}`"


def _action(difference: ExecutionDifference, tool: str) -> str:
    left, right, aspect = difference.left, difference.right, difference.aspect
    name = _called(difference.name)
    if _is_final_scan(difference):
        return f"{name} runs {'once more' if left is None else 'not once more'} in {tool} after the step is left"
    if _is_later(difference):
        return f"the chart of {name} begins a scan earlier or later in {tool}: {right}, in the source {left}"
    if aspect == "trigger" and left == right:
        return f"{name} is controlled otherwise in {tool}: it also belongs to other steps"
    if aspect == "trigger":
        return f"{name} runs as {right} in {tool}, not as {left}"
    if right is None and aspect == "value":
        return f"{name} sets its variable to TRUE in {tool} instead of `{left}`"
    if right is None and aspect == "code":
        return f"{name} has no program in {tool}"
    if right is None:
        return f"{name} runs WITHOUT its {aspect} `{left}` in {tool}"
    if left is None:
        return f"{name} has the {aspect} `{right}` in {tool}, and none in the source"
    return f"the {aspect} of {name} is `{right}` in {tool} instead of `{left}`"


_MISSING = {
    "min time": "the step may be left before its minimum time {left} in {tool}",
    "max time": "exceeding the maximum time {left} is not reported in {tool}",
    "interlock": "the interlock `{left}` has no effect in {tool}",
    "supervision": "the supervision `{left}` does NOT hold the step in {tool}",
    "condition": "the transition has no condition in {tool} instead of `{left}`",
    "initial value": "`{name}` does not start as {left} in {tool}",
    "start values": "`{name}` does not start with its own values in {tool}: {left}",
    "address": "`{name}` is not at {left} in {tool}",
    "retain": "`{name}` does not keep its value over a power failure in {tool}",
    "constant": "`{name}` is no constant in {tool}",
    SHOWN_STATE: "nothing sets these outputs in {tool}: {left}",
    PLAIN_VARIABLES: "variables of this name operate the sequence or show its state in {tool}: {left}",
    "code": "the program of the {kind}, `{left}`, is NOT executed in {tool}",
    "drawn logic": "what is drawn beside the steps is NOT executed in {tool}: `{left}`",
    "extends": "the {kind} does not extend `{left}` in {tool}: nothing of that is in it",
    "implements": "the {kind} does not implement `{left}` in {tool}",
    "union": "the members of the UNION do not share their memory in {tool}",
    "negation": "the actions of the step do not act while it is NOT active in {tool}",
    "attributes": "attributes of the {kind} that have no effect in {tool}: {left}",
    "static": "each instance gets a `{name}` of its own: this file for {tool} has no VAR_STAT, which is one for all; "
    "declare a global variable instead",
    "kept": "`{name}` begins anew in each call of the method in {tool}, which has no {left}",
    "arguments": "the program instance does not get its arguments in {tool}: {left}",
    "interval": "{name} does not run every {left} in {tool}",
    "trigger": "{name} does not start at a rising edge of {left} in {tool}",
    "kind of task": "{name} is a task of the kind {left}: there is none in {tool}",
}
"""Consequences of an aspect that is missing in the target."""


def _apart(left: str | None, right: str | None) -> tuple[str | None, str | None]:
    """Return two long texts from a little before the place where they differ."""
    if left is None or right is None or len(min(left, right, key=len)) <= _SHOWN or left[:_SHOWN] != right[:_SHOWN]:
        return left, right
    same = next((at for at, (a, b) in enumerate(zip(left, right, strict=False)) if a != b), min(len(left), len(right)))
    start = max(left.rfind(" ", 0, max(same - _SHOWN // 4, 0)), 0)
    return f"..{left[start:]}", f"..{right[start:]}"


def _cut(text: str | None) -> str | None:
    if text is None:
        return None
    text = " ".join(text.split())
    return text if len(text) <= _SHOWN else text[: _SHOWN - 2] + ".."
