"""Differences between two projects in what they execute."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set
from dataclasses import dataclass

from plcopen_sfc.conversion.executed_parts import (
    ALONE,
    BOOLEAN_ACTIONS,
    OPERATING_KINDS,
    PLAIN_VARIABLES,
    PROGRAM_CALL,
    SHOWN_STATE,
    STORED,
    TOGETHER,
    UNDECLARED,
    UNDECLARED_TYPE,
    BooleanActions,
    Key,
    Part,
)
from plcopen_sfc.conversion.meaning import Meaning, is_stronger, same
from plcopen_sfc.object_path import ObjectPath


@dataclass(frozen=True, slots=True)
class ExecutionDifference:
    """Something that one project executes and the other does not, or not in the same way.

    `kind` and `name` are those of the part, `path` its place in the words of reports, that of the first project where
    it is in both. `aspect` is what differs; empty: the whole part is missing on one side. `left` and `right` are what
    people read; None: nothing is there. `steps` are the paths of the step that the part belongs to, or of the steps
    that a transition leaves. `is_stronger`: a condition is the one of the source AND something else. `is_of_chart`: the
    code of the source is a chart of an action.
    """

    path: str
    kind: str
    name: str
    aspect: str
    left: str | None
    right: str | None
    steps: tuple[str, ...] = ()
    is_stronger: bool = False
    is_of_chart: bool = False


_OF_NO_EFFECT = frozenset(
    {"type", "POU", "action of the POU", "global variable", "variable", "task", "program instance"}
    | {"unit", "property", "data of the tool", PROGRAM_CALL}
    | OPERATING_KINDS
)
"""Kinds of parts that may be added: what nothing names does nothing."""
OF_LIBRARY = "of a library"
"""Left side of a difference about a name that nothing declares, and that a library of the source tool may have."""
_OF_EVERY_BLOCK = frozenset({"en", "eno"})
"""Names that nothing declares: a tool has them in every block, or has nothing like them."""
_MAY_BE_ADDED = frozenset({SHOWN_STATE, "order of transitions"})
"""Aspects that may be added: a chart runs as before."""


def compare(
    left: Part, right: Part, *, other_tool: bool = False, has_libraries: bool = False, known: Set[str] = frozenset()
) -> Iterator[ExecutionDifference]:
    """Yield the differences between two trees of `plcopen_sfc.conversion.executed`, parts before what is in them.

    `other_tool`: the second is for another tool, which does not have the libraries of the first. `has_libraries`: the
    first is of a tool that has some, so that functions and types which it does not declare may come from there.
    `known`: names, in lower case, of what those of the second declare.
    """
    yield from _compare(left, right, Key("project", ""), ())
    for key, part in left.parts.items() if other_tool else ():
        other = right.parts.get(key)
        if other is not None and key.kind in (UNDECLARED, UNDECLARED_TYPE) and key.name not in _OF_EVERY_BLOCK | known:
            is_of_library = has_libraries and (key.kind == UNDECLARED_TYPE or other.is_called)
            yield ExecutionDifference(
                part.path, key.kind, _name(part, key), "", OF_LIBRARY if is_of_library else "", ""
            )


def _compare(left: Part, right: Part, key: Key, steps: tuple[str, ...]) -> Iterator[ExecutionDifference]:
    """Yield the differences between two parts and all inside them; `steps` are those around, for the report."""
    for aspect in dict.fromkeys((*left.aspects, *right.aspects)):
        mine, theirs = left.aspects.get(aspect), right.aspects.get(aspect)
        if aspect == "order of transitions":
            theirs = _in_order_of(mine, theirs)
        if aspect == PLAIN_VARIABLES:
            taken = mine is not None and isinstance(mine.raw, frozenset) and mine.raw & right.parameters
            theirs = None if taken else mine
        if aspect == BOOLEAN_ACTIONS:
            yield from _boolean_actions(left, key, mine, theirs)
            continue
        if aspect.startswith(STORED) and None in (mine, theirs):
            continue  # rows that are missing on one side are told as such
        if not same(mine, theirs) and not (mine is None and aspect in _MAY_BE_ADDED):
            name, stronger = _name(left, key), aspect == "condition" and is_stronger(theirs, mine)
            before, after = _show(mine), _show(theirs)
            # both are executed then, but one control counts the steps together: words for them would tell no difference
            if aspect == "trigger" and mine is not None and theirs is not None and _are_controlled(mine, theirs):
                after = before
            raw = mine.raw if mine is not None and aspect == "code" else None
            of_chart = isinstance(raw, tuple) and raw[:1] == ("chart",)
            yield ExecutionDifference(left.path, key.kind, name, aspect, before, after, steps, stronger, of_chart)
    if key.kind in ("chart", "partial chart"):
        _pass_added_steps(left, right)
        _settle_minimum_times(left, right)
    renamed = (
        matched_actions(left, right)
        | _variables_of_lists(left, right)
        | _competing_transitions(left, right)
        | renamed_tasks(left, right)
    )
    reached = {ObjectPath.of(part.path).last for name, part in right.parts.items() if name.kind == PROGRAM_CALL}
    for inner, part in left.parts.items():
        other = right.parts.get(renamed.get(inner, inner))
        if other is None and inner.kind == PROGRAM_CALL and ObjectPath.of(part.path).last in reached:
            continue  # others do reach it, and the texts are compared themselves
        if other is None and inner.kind in (UNDECLARED, UNDECLARED_TYPE, "action of the POU"):
            continue  # whatever calls the action names what is not declared, or has no program
        if other is None:
            within = _steps(left, part, inner) or steps
            yield ExecutionDifference(part.path, inner.kind, _name(part, inner), "", _trigger(part), None, within)
        else:
            yield from _compare(part, other, inner, _steps(left, part, inner) or steps)
    matched = {renamed.get(inner, inner) for inner in left.parts}
    for inner, part in right.parts.items():
        if inner not in matched and inner.kind not in _OF_NO_EFFECT:
            within = _steps(right, part, inner) or steps
            box = "a box" if inner.kind == UNDECLARED and inner.name in left.boxes else None
            yield ExecutionDifference(part.path, inner.kind, _name(part, inner), "", box, _trigger(part), within)


def _are_controlled(mine: Meaning, theirs: Meaning) -> bool:
    """True if actions are executed at the same time, one by a control of several steps and one by that of its own."""
    (when, control), (other, by) = (each.raw if isinstance(each.raw, tuple) else ("", "") for each in (mine, theirs))
    return when == other and {control, by} == {ALONE, TOGETHER}


def _boolean_actions(
    left: Part, key: Key, mine: Meaning | None, theirs: Meaning | None
) -> Iterator[ExecutionDifference]:
    """Actions of a chart that are variables which other code writes too, and which the two sides write otherwise."""
    one, other = mine and mine.raw, theirs and theirs.raw
    if not isinstance(one, BooleanActions) or not isinstance(other, BooleanActions):
        return
    found: dict[tuple[str, str], list[str]] = {}
    written = [(0, name) for name in one.by_code] + [(1, name) for name in one.elsewhere]
    for which, name in sorted(written):
        if name in other.rules:
            rules = one.rules[name][which] if name in one.rules else "never", other.rules[name][which]
            found.setdefault(rules, []).append(one.spelled.get(name, name))
    for (before, after), names in found.items():
        if before != after:
            yield ExecutionDifference(left.path, key.kind, ", ".join(names), BOOLEAN_ACTIONS, before, after)


def _variables_of_lists(left: Part, right: Part) -> dict[Key, Key]:
    """Return the counterparts of global variables whose name is in several lists: that of the list with its name."""
    kind = "global variable"
    found: dict[Key, Key] = {}
    for name in {key.name for key in left.parts if key.kind == kind and key.number}:
        mine, theirs = ([k for k in side.parts if k[:2] == (kind, name)] for side in (left, right))
        by_path = {right.parts[key].path.casefold(): key for key in theirs}
        sure = {key: by_path[path] for key in mine if (path := left.parts[key].path.casefold()) in by_path}
        others = [key for key in theirs if key not in sure.values()]
        found |= sure | dict(zip((key for key in mine if key not in sure), others, strict=False))
    return found


def _steps(owner: Part, part: Part, key: Key) -> tuple[str, ...]:
    """Return the paths of the step that a part is, or of the steps that a transition leaves."""
    if key.kind == "step":
        return (part.path,)
    return tuple(step.path for name in part.leaves for step in owner.steps_named(name))


def _in_order_of(mine: Meaning | None, theirs: Meaning | None) -> Meaning | None:
    """Return the order of those transitions that both have."""
    if mine is None or theirs is None or not isinstance(mine.raw, tuple) or not isinstance(theirs.raw, tuple):
        return theirs
    shared = tuple(each for each in theirs.raw if each in mine.raw)
    return Meaning.of(shared, ", ".join(shared))


def _settle_minimum_times(left: Part, right: Part) -> None:
    """Forget minimum times that the other side has in the conditions of all transitions which leave the step."""
    for name, step in left.parts.items():
        if name.kind != "step" or "min time" not in step.aspects or "min time" in right.parts.get(name, step).aspects:
            continue
        leaving = [each for each, part in left.parts.items() if name.name in part.leaves]
        if leaving and all(_waits(left.parts[each], right.parts.get(each)) for each in leaving):
            del step.aspects["min time"]
            for each in leaving:
                left.parts[each].aspects.pop("condition", None)
                right.parts[each].aspects.pop("condition", None)


def _waits(left: Part, right: Part | None) -> bool:
    return right is not None and left.waiting is not None and same(left.waiting, right.aspects.get("condition"))


def _pass_added_steps(left: Part, right: Part) -> None:
    """Lead transitions past the steps that only the other side has and that do nothing but wait one cycle.

    A transition that is always TRUE leads to such a step, or away from it.
    """
    for key, step in list(right.parts.items()):
        does = step.parts or step.aspects.keys() - {"initial", "order of transitions"}
        if key.kind != "step" or key in left.parts or does or same(step.aspects.get("initial"), _YES):
            continue
        ways = {each: ends(each) for each in right.parts if each.kind == "transition"}
        to = [each for each, (_, targets) in ways.items() if key.name in targets]
        away = [each for each, (sources, _) in ways.items() if sources == (key.name,)]
        if len(away) == 1 and _is_always(right.parts[away[0]]):
            targets = ways[away[0]][1]
            new = {each: (ways[each][0], (*(t for t in ways[each][1] if t != key.name), *targets)) for each in to}
            gone = away[0]
        elif len(to) == 1 and ways[to[0]][1] == (key.name,) and _is_always(right.parts[to[0]]):
            new = {each: (ways[to[0]][0], ways[each][1]) for each in away}
            gone = to[0]
            for source in ways[gone][0]:
                owner = right.parts.get(Key("step", source))
                if owner is not None and "order of transitions" in step.aspects:
                    owner.aspects["order of transitions"] = step.aspects["order of transitions"]
        else:
            continue
        _rename_transitions(right, new, gone)


_YES = Meaning.of(True)


def ends(transition: Key) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the steps that a transition leaves, and those to which it leads, as its key names them."""
    sources, _, targets = transition.name.partition(" -> ")
    return tuple(sources.split("+")), tuple(targets.split("+"))


def _is_always(transition: Part) -> bool:
    condition = transition.aspects.get("condition")
    return condition is not None and condition.show().upper() == "TRUE"


def _rename_transitions(chart: Part, new: dict[Key, tuple[tuple[str, ...], tuple[str, ...]]], gone: Key) -> None:
    """Give transitions of a chart other ends, and take one out."""
    names: dict[str, str] = {}
    parts = [(key, part) for key, part in chart.parts.items() if key != gone]
    chart.parts.clear()
    for key, part in parts:
        if key in new:
            sources, targets = new[key]
            names[key.name] = f"{'+'.join(sorted(sources))} -> {'+'.join(sorted(targets))}"
            part.leaves = sources
            place = Key(key.kind, names[key.name])
            while place in chart.parts:
                place = place._replace(number=place.number + 1)
            chart.parts[place] = part
        else:
            chart.parts[key] = part
    for part in chart.parts.values():
        order = part.aspects.get("order of transitions")
        if order is not None and isinstance(order.raw, tuple):
            renamed = tuple(names.get(str(each), str(each)) for each in order.raw)
            part.aspects["order of transitions"] = Meaning.of(renamed, ", ".join(renamed))


def matched_actions(left: Part, right: Part) -> dict[Key, Key]:
    """Return the key that each action of a step has on the other side.

    Several of one name are found by everything that they do, then by when they act. Others may have the same program
    under another name: one in place may have got a name.
    """
    mine = [key for key in left.parts if key.kind == "action"]
    others = [key for key in right.parts if key.kind == "action"]
    found: dict[Key, Key] = {}

    def match(aspects: Iterable[str] | None, *, named: bool) -> None:
        for key in (key for key in mine if key not in found):
            part = left.parts[key]
            if not named and "code" not in part.aspects:
                continue
            for other in (other for other in others if other not in found.values()):
                is_named = key[:2] == other[:2]
                if is_named is named and alike(part, right.parts[other], aspects):
                    found[key] = other
                    break

    if any(key.number for key in (*mine, *others)):
        match(None, named=True)
        match(("trigger", "value"), named=True)
        match(("trigger",), named=True)
    match((), named=True)
    match(("code", "trigger"), named=False)
    match(("code",), named=False)
    return dict.fromkeys(mine, _NONE) | found


def renamed_tasks(left: Part, right: Part) -> dict[Key, Key]:
    """The tasks that have another name on the other side: they run the same programs, if possible at the same times."""
    found: dict[Key, Key] = {}
    mine = [key for key in left.parts if key.kind == "task" and key not in right.parts]
    others = [key for key in right.parts if key.kind == "task" and key not in left.parts]
    for aspects in (None, ()):
        for key in (key for key in mine if key not in found):
            part = left.parts[key]
            for other in (other for other in others if other not in found.values()):
                task = right.parts[other]
                if part.parts.keys() == task.parts.keys() and alike(part, task, aspects):
                    found[key] = other
                    break
    return found


_NONE = Key("", "")
"""No part has this key."""


def _competing_transitions(left: Part, right: Part) -> dict[Key, Key]:
    """Transitions between the same steps by their conditions: files may hold them in another order."""
    found: dict[Key, Key] = {}
    several = {key[:2] for key in (*left.parts, *right.parts) if key.kind == "transition" and key.number}
    for key, part in left.parts.items():
        if key[:2] not in several:
            continue
        free = [other for other in right.parts if other[:2] == key[:2] and other not in found.values()]
        match = next((other for other in free if alike(part, right.parts[other], ("condition",))), None)
        if match is not None:
            found[key] = match
    # those that have no match take what is left
    for key in (key for key in left.parts if key[:2] in several and key not in found):
        free = [other for other in right.parts if other[:2] == key[:2] and other not in found.values()]
        found[key] = free[0] if free else _NONE
    return found


def alike(left: Part, right: Part, aspects: Iterable[str] | None) -> bool:
    """True if these aspects are the same; None: all."""
    if aspects is None:
        aspects = (*left.aspects, *right.aspects)
    return all(same(left.aspects.get(a), right.aspects.get(a)) for a in aspects)


def _name(part: Part, key: Key) -> str:
    """Return the name of a part as its file spells it."""
    if key.kind in (UNDECLARED, UNDECLARED_TYPE):
        return part.aspects["name"].show()
    last = ObjectPath.of(part.path).last
    return last.removeprefix(f"{key.kind} ") if key.name else ""


def _trigger(part: Part) -> str:
    """Part in one word or two: the qualifier of an action, the type of a variable, the condition of a transition."""
    found = (part.aspects.get(aspect) for aspect in ("trigger", "type", "kind", "condition"))
    told = next((each for each in found if each is not None), None)
    return told.show() if told is not None else ""


def _show(meaning: Meaning | None) -> str | None:
    return None if meaning is None else meaning.show()
