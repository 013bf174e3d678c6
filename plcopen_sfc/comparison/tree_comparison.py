"""Comparison of two listings of `plcopen_sfc.conversion`, part by part."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from plcopen_sfc.comparison.changes import Change, ChangeKind
from plcopen_sfc.conversion.comparison import alike, ends, matched_actions, renamed_tasks
from plcopen_sfc.conversion.executed_parts import (
    PLAIN_VARIABLES,
    SHOWN_STATE,
    STORED,
    UNDECLARED_TYPE,
    Key,
    Part,
)
from plcopen_sfc.conversion.meaning import Meaning, same
from plcopen_sfc.model.sfc import Transition
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.semantics.system_inputs import PARAMETER_NAMES

__all__ = ["TreeComparison", "word_of"]

_DERIVED = frozenset({PLAIN_VARIABLES, SHOWN_STATE, "operating inputs", "order of transitions", "final scan"})
"""Aspects that follow from others."""
_DERIVED_AS_WRITTEN = _DERIVED | {"variables"}
_WORDS = {
    "initial value": "start value",
    "max time": "maximum time",
    "min time": "minimum time",
    "trigger": "qualifier",
    "action of the POU": "action",
}
"""Aspects and kinds of the listing, in the words of an engineer."""
_TOLD = ("trigger", "condition", "type", "program", "kind")
"""Aspects by which something that was added or removed is told in short."""
_WANDER = frozenset({"action", "variable", "global variable", "program instance"})
"""Kinds of parts that are recognised at another place."""
_PLACES = frozenset({"section", "list", "number"})


class TreeComparison:
    """Finds the changes between two listings. `is_written`: both are of the same kind of tool, in detail.

    With `layout` program text that means the same is a change too.
    """

    def __init__(self, *, is_written: bool, layout: bool) -> None:
        self.derived = _DERIVED_AS_WRITTEN if is_written else _DERIVED
        self.is_written = is_written
        self.layout = layout
        self._found: list[tuple[Change, Key, Part]] = []

    def changes(self, left: Part, right: Part) -> list[Change]:
        """The changes from one listing to another."""
        self._compare(Key("project", ""), left, right)
        return list(self._with_moves())

    def _compare(self, key: Key, left: Part, right: Part) -> None:
        self._aspects(key, left, right)
        matched = matches(left, right)
        if key.kind in _CHARTS:
            self._moved_steps(left, right)
        self._orders(key, left, right, matched)
        for inner, part in left.parts.items():
            other = matched.get(inner)
            if self._is_of_tool(inner):
                continue
            if other is None:
                self._note(Change(ChangeKind.REMOVED, part.path, word_of(inner.kind), before=_told(part)), inner, part)
            else:
                self._name(inner, part, other, right.parts[other])
                self._compare(inner, part, right.parts[other])
        taken = set(matched.values())
        for inner, part in right.parts.items():
            if inner not in taken and not self._is_of_tool(inner):
                self._note(Change(ChangeKind.ADDED, part.path, word_of(inner.kind), after=_told(part)), inner, part)

    def _is_of_tool(self, key: Key) -> bool:
        """True for what is no part of a project, and for the parameters that every chart of S7-GRAPH has."""
        is_parameter = key.kind == "variable" and key.name in PARAMETER_NAMES and not self.is_written
        return key.kind == UNDECLARED_TYPE or is_parameter

    def _note(self, change: Change, key: Key, part: Part) -> None:
        self._found.append((change, key, part))

    def _aspects(self, key: Key, left: Part, right: Part) -> None:
        for aspect in dict.fromkeys((*left.aspects, *right.aspects)):
            if aspect in self.derived or aspect.startswith(STORED):
                continue
            mine, theirs = left.aspects.get(aspect), right.aspects.get(aspect)
            kind = ChangeKind.CHANGED
            if same(mine, theirs):
                if not self.layout or mine is None or theirs is None or mine.raw == theirs.raw:
                    continue
                kind = ChangeKind.LAYOUT
            change = _changed(Change(kind, left.path, word_of(key.kind), word_of(aspect)), mine, theirs)
            if kind is ChangeKind.CHANGED or change.before != change.after:
                self._note(change, key, left)

    def _name(self, key: Key, left: Part, other: Key, right: Part) -> None:
        """Note another name: another spelling of it, or that of a task or of an action that was found otherwise."""
        before, after = _name_of(left, key), _name_of(right, other)
        if key[:2] == other[:2]:
            if not self.is_written or left.subject is None or key.kind == "transition" or before == after:
                return
        elif key.kind == "transition":
            for aspect, mine, theirs in zip(("source", "target"), _ends_of(left), _ends_of(right), strict=True):
                if mine.casefold() != theirs.casefold():
                    change = Change(ChangeKind.CHANGED, left.path, key.kind, aspect, mine, theirs)
                    self._note(change, key, left)
            return
        self._note(Change(ChangeKind.RENAMED, right.path, word_of(key.kind), before=before, after=after), key, left)

    def _orders(self, key: Key, left: Part, right: Part, matched: dict[Key, Key]) -> None:
        """Note another order of the transitions that leave a step, and of the actions of a step."""
        if key.kind in _CHARTS:
            for inner, other in matched.items():
                if inner.kind == "step":
                    mine, theirs = left.parts[inner], right.parts[other]
                    before = [each for each in mine.order if matched.get(each) in theirs.order]
                    after = [each for each in theirs.order if each in map(matched.get, before)]
                    if [matched[each] for each in before] != after:
                        shown = _labels(left, before), _labels(right, after)
                        change = Change(ChangeKind.CHANGED, mine.path, "step", "order of transitions to", *shown)
                        self._note(change, inner, mine)
        if key.kind == "step":
            before = [each for each in left.parts if each.kind == "action" and each in matched]
            after = [each for each in right.parts if each.kind == "action" and each in matched.values()]
            if [matched[each] for each in before] != after:
                shown = _names(left, before), _names(right, after)
                self._note(Change(ChangeKind.CHANGED, left.path, "step", "order of actions", *shown), key, left)

    def _moved_steps(self, left: Part, right: Part) -> None:
        """Note the steps that are elsewhere in the flow: after others and before others than they were."""
        before, after = _Flow(left), _Flow(right)
        shared = [step for step in before.order if step in after.into]
        others = [step for step in after.order if step in before.into]
        blocks = difflib.SequenceMatcher(None, shared, others, autojunk=False).get_matching_blocks()
        stay = {step for block in blocks for step in shared[block.a : block.a + block.size]}
        for step in (step for step in shared if step not in stay):
            neighbours = [
                [each & set(shared) for each in (flow.into[step], flow.out_of[step])] for flow in (before, after)
            ]
            if any(old == new or not new for old, new in zip(*neighbours, strict=True)):
                continue
            part = left.parts[Key("step", step)]
            places = before.place(step), after.place(step)
            self._note(Change(ChangeKind.MOVED, part.path, "step", "", *places), Key("step", step), part)

    def _with_moves(self) -> Iterator[Change]:
        """The changes, with what was removed at one place and added at another as moved."""
        removed = [each for each in self._found if each[0].kind is ChangeKind.REMOVED and each[1].kind in _WANDER]
        origins: dict[int, Change] = {}
        for change, key, part in self._found:
            if change.kind is ChangeKind.ADDED and key.kind in _WANDER:
                found = (old for old, name, there in removed if name.name == key.name and _is_same(there, part))
                origin = next((old for old in found if all(old is not each for each in origins.values())), None)
                if origin is not None:
                    origins[id(change)] = origin
        gone = set(map(id, origins.values()))
        for change, _, _ in self._found:
            origin = origins.get(id(change))
            if origin is not None:
                yield Change(ChangeKind.MOVED, change.path, change.what, "", _around(origin), _around(change))
            elif id(change) not in gone:
                yield change


def matches(left: Part, right: Part) -> dict[Key, Key]:
    """The parts that are in both: their keys on the right by those on the left."""
    found = {key: key for key in left.parts if key in right.parts and key.kind not in ("action", "transition")}
    found |= renamed_tasks(left, right)
    found |= {key: other for key, other in matched_actions(left, right).items() if other in right.parts}
    return found | _matched_transitions(left, right)


def _matched_transitions(left: Part, right: Part) -> dict[Key, Key]:
    """Transitions by their ends and conditions, then by one end: the other may lead elsewhere now."""
    found: dict[Key, Key] = {}
    mine = [key for key in left.parts if key.kind == "transition"]
    others = [key for key in right.parts if key.kind == "transition"]

    def match(is_same: Callable[[Key, Key], bool], *aspects: str) -> None:
        for key in (key for key in mine if key not in found):
            for other in (other for other in others if other not in found.values()):
                if is_same(key, other) and alike(left.parts[key], right.parts[other], aspects):
                    found[key] = other
                    break

    def name(part: Part) -> str:
        return part.subject.name.casefold() if isinstance(part.subject, Transition) else ""

    match(lambda key, other: key == other, "condition")
    match(lambda key, other: key[:2] == other[:2], "condition")
    match(lambda key, other: key[:2] == other[:2])
    match(lambda key, other: name(left.parts[key]) == name(right.parts[other]) != "")
    match(lambda key, other: ends(key)[0] == ends(other)[0], "condition")
    match(lambda key, other: ends(key)[1] == ends(other)[1], "condition")
    return found


class _Flow:
    """The steps of a chart along the flow, and for each of them those before and after it."""

    def __init__(self, chart: Part) -> None:
        self.names = {key.name: _name_of(part, key) for key, part in chart.parts.items() if key.kind == "step"}
        self.into: dict[str, set[str]] = {step: set() for step in self.names}
        self.out_of: dict[str, set[str]] = {step: set() for step in self.names}
        for key in (key for key in chart.parts if key.kind == "transition"):
            sources, targets = ends(key)
            for source in sources:
                self.out_of.setdefault(source, set()).update(targets)
            for target in targets:
                self.into.setdefault(target, set()).update(sources)
        is_initial = {key.name for key, part in chart.parts.items() if "initial" in part.aspects and _starts(part)}
        self.order: list[str] = []
        found = [step for step in self.names if step in is_initial] or list(self.names)[:1]
        seen = set(found)
        while found:
            step = found.pop(0)
            self.order.append(step)
            new = [each for each in self.names if each in self.out_of[step] and each not in seen]
            seen.update(new)
            found += new

    def place(self, step: str) -> str:
        """Where a step is, in words."""
        before = [name for key, name in self.names.items() if key in self.into[step]]
        return f"after {', '.join(before)}"


def _starts(step: Part) -> bool:
    return step.aspects["initial"].raw is True


def _changed(change: Change, mine: Meaning | None, theirs: Meaning | None) -> Change:
    """The change with what was there before and after, of program text with the lines that differ."""
    before, after = (None if each is None or each.text is None else each.text() for each in (mine, theirs))
    if before is None and after is None:
        before, after = (None if each is None else each.show() for each in (mine, theirs))
        return replace(change, before=before, after=after)
    old, new = ((text or "").strip("\n").splitlines() for text in (before, after))
    lines = tuple(line.rstrip() for line in difflib.unified_diff(old, new, lineterm="", n=1))[2:]
    return replace(change, before=before, after=after, lines=lines)


def _told(part: Part) -> str | None:
    """A part in one word or two."""
    words = [part.aspects[each].show() for each in _TOLD if each in part.aspects]
    return words[0] if words else None


def _name_of(part: Part, key: Key) -> str:
    return ObjectPath.of(part.path).last.removeprefix(f"{word_of(key.kind)} ")


def _ends_of(transition: Part) -> tuple[str, str]:
    """The names of the steps that a transition leaves and of those it leads to, as its file spells them."""
    before, _, after = ObjectPath.of(transition.path).last.removeprefix("transition ").partition(" -> ")
    return before, after


def _names(owner: Part, keys: Iterable[Key]) -> str:
    return ", ".join(_name_of(owner.parts[key], key) for key in keys)


def _labels(chart: Part, transitions: Iterable[Key]) -> str:
    """Transitions that leave a step, by their names or by where they lead."""
    return ", ".join(_ends_of(chart.parts[key])[1] or _name_of(chart.parts[key], key) for key in transitions)


def word_of(kind: str) -> str:
    """A kind or an aspect of the listing in the words of an engineer."""
    return _WORDS.get(kind, kind)


def _is_same(left: Part, right: Part) -> bool:
    return alike(left, right, (left.aspects.keys() | right.aspects.keys()) - _PLACES)


def _around(change: Change) -> str:
    path = ObjectPath.of(change.path).around
    return path.last or "the project"


_CHARTS = ("chart", "partial chart", "macro-step")
