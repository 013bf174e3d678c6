"""What differs between what two projects execute."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from plcopen_sfc.conversion.meaning import Meaning, is_stronger, same
from plcopen_sfc.conversion.parts import UNDECLARED, Key, Part

__all__ = ["Difference", "compare"]


@dataclass(frozen=True, slots=True)
class Difference:
    """Something that one project executes and the other does not, or not in the same way.

    `kind` and `name` are those of the part, `path` its place in the words of reports, that of the first project where
    it is in both. `aspect` is what differs; empty: the whole part is missing on one side. `left` and `right` are what
    people read; None: nothing is there. `steps` are the paths of the step that the part belongs to, or of the steps
    that a transition leaves. `is_stronger`: a condition is the one of the source AND something else.
    """

    path: str
    kind: str
    name: str
    aspect: str
    left: str | None
    right: str | None
    steps: tuple[str, ...] = ()
    is_stronger: bool = False


_OF_NO_EFFECT = frozenset(
    {"type", "instance", "POU", "action of the POU", "global variable", "variable", "task", "program instance"}
)
"""Kinds of parts that may be added: what nothing names does nothing."""
_AT_REST = frozenset({"operating inputs", "order of transitions"})
"""Aspects that may be added: a chart runs as before as long as nobody operates it."""


def compare(left: Part, right: Part) -> Iterator[Difference]:
    """The differences between two trees of `plcopen_sfc.conversion.executed`, parts before what is in them."""
    yield from _compare(left, right, Key("project", ""), ())


def _compare(left: Part, right: Part, key: Key, steps: tuple[str, ...]) -> Iterator[Difference]:
    for aspect in dict.fromkeys((*left.aspects, *right.aspects)):
        mine, theirs = left.aspects.get(aspect), right.aspects.get(aspect)
        if aspect == "order of transitions":
            theirs = _in_order_of(mine, theirs)
        if not same(mine, theirs) and not (mine is None and aspect in _AT_REST):
            name, stronger = _name(left, key), aspect == "condition" and is_stronger(theirs, mine)
            yield Difference(left.path, key.kind, name, aspect, _show(mine), _show(theirs), steps, stronger)
    renamed = _renamed_actions(left, right) | _competing_transitions(left, right)
    if key.kind == "chart":
        _settle_minimum_times(left, right)
    for inner, part in left.parts.items():
        other = right.parts.get(renamed.get(inner, inner))
        if other is None and inner.kind in (UNDECLARED, "action of the POU"):
            continue  # whatever calls the action names what is not declared, or has no program
        if other is None:
            within = _steps(left, part, inner) or steps
            yield Difference(part.path, inner.kind, _name(part, inner), "", _trigger(part), None, within)
        else:
            yield from _compare(part, other, inner, _steps(left, part, inner) or steps)
    for inner, part in right.parts.items():
        if inner not in left.parts and inner.kind not in _OF_NO_EFFECT and inner not in renamed.values():
            within = _steps(right, part, inner) or steps
            box = "a box" if inner.kind == UNDECLARED and inner.name in left.boxes else None
            yield Difference(part.path, inner.kind, _name(part, inner), "", box, _trigger(part), within)


def _steps(owner: Part, part: Part, key: Key) -> tuple[str, ...]:
    """The paths of the step that a part is, or of the steps that a transition leaves."""
    if key.kind == "step":
        return (part.path,)
    return tuple(p.path for name in part.leaves for k, p in owner.parts.items() if k[:2] == ("step", name))


def _in_order_of(mine: Meaning | None, theirs: Meaning | None) -> Meaning | None:
    """The order of those transitions that both have."""
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


def _renamed_actions(left: Part, right: Part) -> dict[Key, Key]:
    """Actions of a step with the same program under another name: one in place may have got a name.

    Where several have it, first those that are executed at the same times.
    """
    found: dict[Key, Key] = {}
    mine = [key for key in left.parts if key.kind == "action" and key not in right.parts]
    others = [key for key in right.parts if key.kind == "action" and key not in left.parts]
    for aspects in (("code", "trigger"), ("code",)):
        for key in mine:
            part = left.parts[key]
            if key in found or "code" not in part.aspects:
                continue
            free = (other for other in others if other not in found.values())
            match = next((other for other in free if _alike(part, right.parts[other], aspects)), None)
            if match is not None:
                found[key] = match
    return found


def _competing_transitions(left: Part, right: Part) -> dict[Key, Key]:
    """Transitions between the same steps by their conditions: files may hold them in another order."""
    found: dict[Key, Key] = {}
    several = {key[:2] for key in left.parts if key.kind == "transition" and key.number}
    for key, part in left.parts.items():
        if key[:2] not in several:
            continue
        free = [other for other in right.parts if other[:2] == key[:2] and other not in found.values()]
        match = next((other for other in free if _alike(part, right.parts[other], ("condition",))), None)
        if match is not None:
            found[key] = match
    # those that have no match take what is left
    for key in (key for key in left.parts if key[:2] in several and key not in found):
        free = [other for other in right.parts if other[:2] == key[:2] and other not in found.values()]
        found[key] = free[0] if free else key
    return found


def _alike(left: Part, right: Part, aspects: Iterable[str]) -> bool:
    return all(same(left.aspects.get(a), right.aspects.get(a)) for a in aspects)


def _name(part: Part, key: Key) -> str:
    """The name of a part as its file spells it."""
    if key.kind == UNDECLARED:
        return part.aspects["name"].show()
    last = part.path.rpartition(" / ")[2]
    return last.removeprefix(f"{key.kind} ") if key.name else ""


def _trigger(part: Part) -> str:
    """What a part is in one word or two: the qualifier of an action, the type of a variable."""
    told = part.aspects.get("trigger") or part.aspects.get("type") or part.aspects.get("kind")
    return told.show() if told is not None else ""


def _show(meaning: Meaning | None) -> str | None:
    return None if meaning is None else meaning.show()
