"""Comparison of two listings of `plcopen_sfc.conversion`, part by part."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations, product

from plcopen_sfc.comparison.changes import Change, ChangeKind
from plcopen_sfc.conversion.executed_parts import (
    OPERATING_KINDS,
    PLAIN_VARIABLES,
    SHOWN_STATE,
    STORED,
    UNDECLARED_TYPE,
    Key,
    Part,
)
from plcopen_sfc.conversion.execution_differences import alike, ends, matched_actions, renamed_tasks
from plcopen_sfc.conversion.meaning import Meaning, same
from plcopen_sfc.model.sfc import Transition
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.reachability import reached
from plcopen_sfc.semantics.inputs import PARAMETER_NAMES

_DERIVED = frozenset({PLAIN_VARIABLES, SHOWN_STATE, "order of transitions", "final scan"})
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
_CONDITION = ("condition",)
_IN_ORDER = ("input", "output", "inOut")
"""Sections of variables whose order counts: that of the arguments of a call."""
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
        self._there: dict[str, str] = {}

    def changes(self, left: Part, right: Part) -> list[Change]:
        """Return the changes from one listing to another."""
        self._compare(Key("project", ""), left, right)
        return list(self._with_moves())

    def _compare(self, key: Key, left: Part, right: Part) -> None:
        if left.path.casefold() != right.path.casefold():
            self._there[left.path] = right.path
        self._aspects(key, left, right)
        matched = matches(left, right)
        if key.kind in _CHARTS:
            self._moved_steps(left, right)
            self._order_of_simultaneous_steps(key, left, right, matched)
        self._orders(key, left, right, matched)
        for inner, part in left.parts.items():
            other = matched.get(inner)
            if self._is_of_tool(inner):
                continue
            if other is None:
                gone = Change(ChangeKind.REMOVED, _path(inner, part), word_of(inner.kind), before=_told(part))
                self._note(gone, inner, part)
            else:
                self._name(inner, left, other, right)
                self._compare(inner, part, right.parts[other])
        taken = set(matched.values())
        # what was added here and removed elsewhere becomes one move at the end, when all of both sides is known
        for inner, part in right.parts.items():
            if inner not in taken and not self._is_of_tool(inner):
                new = Change(ChangeKind.ADDED, _path(inner, part), word_of(inner.kind), after=_told(part))
                self._note(new, inner, part)

    def _is_of_tool(self, key: Key) -> bool:
        """True for what is no part of a project, and for the parameters that every chart of S7-GRAPH has."""
        is_parameter = key.kind == "variable" and key.name in PARAMETER_NAMES and not self.is_written
        return key.kind == UNDECLARED_TYPE or key.kind in OPERATING_KINDS or is_parameter

    def _note(self, change: Change, key: Key, part: Part) -> None:
        self._found.append((change, key, part))

    def _aspects(self, key: Key, left: Part, right: Part) -> None:
        for aspect in dict.fromkeys((*left.aspects, *right.aspects)):
            if aspect in self.derived or aspect.startswith(STORED):
                continue
            mine, theirs = left.aspects.get(aspect), right.aspects.get(aspect)
            if aspect.startswith(("language", "comments of ")) and None in (mine, theirs):
                continue  # the program itself was added or removed, or is no drawing on one side
            kind = ChangeKind.CHANGED
            if same(mine, theirs):
                if not self.layout or mine is None or theirs is None or mine.raw == theirs.raw:
                    continue
                kind = ChangeKind.LAYOUT
            word = aspect if key.kind == "task" else word_of(aspect)
            change = _changed(Change(kind, _path(key, left), word_of(key.kind), word), mine, theirs)
            if kind is ChangeKind.CHANGED or change.before != change.after:
                self._note(change, key, left)

    def _name(self, key: Key, around: Part, other: Key, there: Part) -> None:
        """Note another name: another spelling of it, or that of a task or of an action that was found otherwise.

        Of a transition also other ends. `around` and `there` are what the two are in.
        """
        left, right = around.parts[key], there.parts[other]
        before, after = _name_of(left, key), _name_of(right, other)
        if key.kind == "transition" and key[:2] != other[:2]:
            both = zip(("source", "target"), _ends_of(around, key), _ends_of(there, other), strict=True)
            for aspect, mine, theirs in both:
                if mine.casefold() != theirs.casefold():
                    self._note(Change(ChangeKind.CHANGED, left.path, key.kind, aspect, mine, theirs), key, left)
        if left.subject is not None and right.subject is not None and self.is_written:
            before, after = left.subject.name, right.subject.name
        elif key[:2] == other[:2] or key.kind == "transition":
            return
        if before != after:
            change = Change(ChangeKind.RENAMED, right.path, word_of(key.kind), before=before or None, after=after)
            self._note(change, key, left)

    def _orders(self, key: Key, left: Part, right: Part, matched: dict[Key, Key]) -> None:
        """Note another order of what is executed, called or stored in order."""
        found: list[tuple[str, Key, Part, tuple[Key, ...], tuple[Key, ...]]] = []
        for inner, other in matched.items() if key.kind in _CHARTS else ():
            if inner.kind == "step":
                mine, theirs = left.parts[inner], right.parts[other]
                found.append(("transitions to", inner, mine, mine.order, theirs.order))
        for kind, aspect in (("action", "actions"), ("member", "members"), ("program instance", "programs")):
            of_kind = [tuple(each for each in side.parts if each.kind == kind) for side in (left, right)]
            found.append((aspect, key, left, of_kind[0], of_kind[1]))
        for section in _IN_ORDER if key.kind in ("POU", "method") else ():
            declared = [tuple(_variables(side, section)) for side in (left, right)]
            found.append((f"{section} variables", key, left, declared[0], declared[1]))
        for aspect, owner, part, order, others in found:
            before, after = _in_other_order(order, others, matched)
            if before:
                was, now = (", ".join(_label(left, each) for each in keys) for keys in (before, after))
                change = Change(ChangeKind.CHANGED, part.path, word_of(owner.kind), f"order of {aspect}", was, now)
                self._note(change, owner, part)

    def _order_of_simultaneous_steps(self, key: Key, left: Part, right: Part, matched: dict[Key, Key]) -> None:
        """Note another order of steps that act in one scan: what they write is written in the order of the chart."""
        steps = [each for each in left.parts if each.kind == "step" and left.parts[each].parts and each in matched]
        there = {each: number for number, each in enumerate(right.parts)}
        places = {step.name: (number, there[matched[step]]) for number, step in enumerate(steps)}
        if not self.is_written or [new for _, new in places.values()] == sorted(new for _, new in places.values()):
            return
        names = {step.name: _label(left, step) for step in steps}
        pairs = (sorted(pair & places.keys(), key=lambda step: places[step]) for pair in _Flow(left).simultaneous())
        swapped = [pair for pair in pairs if len(pair) > 1 and places[pair[0]][1] > places[pair[1]][1]]
        for first, second in sorted(swapped, key=lambda pair: [places[step] for step in pair]):
            both = f"{names[first]}, {names[second]}", f"{names[second]}, {names[first]}"
            change = Change(ChangeKind.CHANGED, left.path, word_of(key.kind), "order of simultaneous steps", *both)
            self._note(change, key, left)

    def _moved_steps(self, left: Part, right: Part) -> None:
        """Note the steps that are elsewhere in the flow: after others and before others than they were."""
        before, after = _Flow(left), _Flow(right)
        shared = [step for step in before.order if step in after.into]
        others = [step for step in after.order if step in before.into]
        # the longest runs of steps that both have in one order stay; so the fewest others have moved
        blocks = difflib.SequenceMatcher(None, shared, others, autojunk=False).get_matching_blocks()
        stay = {step for block in blocks for step in shared[block.a : block.a + block.size]}
        for step in (step for step in shared if step not in stay):
            neighbours = [
                [each & set(shared) for each in (flow.into[step], flow.out_of[step])] for flow in (before, after)
            ]
            if any(old == new or not new for old, new in zip(*neighbours, strict=True)):
                continue  # on one side it has its neighbours still: something was put in, or taken out, beside it
            part = left.parts[Key("step", step)]
            places = before.place(step), after.place(step)
            self._note(Change(ChangeKind.MOVED, part.path, "step", "", *places), Key("step", step), part)

    def _with_moves(self) -> Iterator[Change]:
        """Yield the changes, with what was removed at one place and added at another as moved."""
        removed = [each for each in self._found if each[0].kind is ChangeKind.REMOVED and each[1].kind in _WANDER]
        origins: dict[int, Change] = {}
        for change, key, part in self._found:
            if change.kind is ChangeKind.ADDED and key.kind in _WANDER:
                found = (old for old, name, there in removed if name.name == key.name and _is_same(there, part))
                origin = next((old for old in found if all(old is not each for each in origins.values())), None)
                if origin is not None:
                    origins[id(change)] = origin
        gone = set(map(id, origins.values()))
        for change, _, part in self._found:
            origin = origins.get(id(change))
            if origin is not None:
                around = _around(origin), _around(change)
                yield Change(ChangeKind.MOVED, change.path, change.what, "", *around, path_before=origin.path)
            elif id(change) not in gone:
                there = self._there.get(part.path, "")
                is_known = change.kind in (ChangeKind.ADDED, ChangeKind.REMOVED) or change.path == there
                yield change if is_known else replace(change, path_after=there)


def matches(left: Part, right: Part) -> dict[Key, Key]:
    """Return the parts that are in both: their keys on the right by those on the left."""
    found = {key: key for key in left.parts if key in right.parts and key.kind not in ("action", "transition")}
    found |= renamed_tasks(left, right)
    found |= {key: other for key, other in matched_actions(left, right).items() if other in right.parts}
    return found | matched_transitions(left, right)


def matched_transitions(left: Part, right: Part) -> dict[Key, Key]:
    """Transitions by their ends and conditions, then by one end: the other may lead elsewhere now."""
    mine = [key for key in left.parts if key.kind == "transition"]
    found = {key: key for key in mine if key in right.parts and alike(left.parts[key], right.parts[key], _CONDITION)}
    mine = [key for key in mine if key not in found]
    others = [key for key in right.parts if key.kind == "transition" and key not in found]

    def match(is_same: Callable[[Key, Key], bool], *aspects: str) -> None:
        for key in list(mine):
            for other in others:
                if is_same(key, other) and alike(left.parts[key], right.parts[other], aspects):
                    found[key] = other
                    mine.remove(key)
                    others.remove(other)
                    break

    def name(part: Part) -> str:
        return part.subject.name.casefold() if isinstance(part.subject, Transition) else ""

    # the surest pairs first: what is matched is taken, and a weaker likeness must not take it
    match(lambda key, other: key[:2] == other[:2], *_CONDITION)
    match(lambda key, other: key[:2] == other[:2])
    match(lambda key, other: name(left.parts[key]) == name(right.parts[other]) != "")
    match(lambda key, other: ends(key)[0] == ends(other)[0], *_CONDITION)
    match(lambda key, other: ends(key)[1] == ends(other)[1], *_CONDITION)
    return found


class _Flow:
    """The steps of a chart along the flow, and for each of them those before and after it."""

    def __init__(self, chart: Part) -> None:
        self.names = {key.name: _name_of(part, key) for key, part in chart.parts.items() if key.kind == "step"}
        self.into: dict[str, set[str]] = {step: set() for step in self.names}
        self.out_of: dict[str, set[str]] = {step: set() for step in self.names}
        self.links = [ends(key) for key in chart.parts if key.kind == "transition"]
        for sources, targets in self.links:
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

    def simultaneous(self) -> set[frozenset[str]]:
        """Return the pairs of steps in different branches of simultaneous sequences."""
        joined = {step for sources, _ in self.links if len(sources) > 1 for step in sources}
        found: set[frozenset[str]] = set()
        for _, targets in self.links:
            branches = [
                reached([target], lambda each: () if each in joined else self.out_of.get(each, ()))
                for target in (targets if len(targets) > 1 else ())
            ]
            for one, other in combinations(branches, 2):
                found |= {frozenset(pair) for pair in product(one - other, other - one)}
        return found

    def place(self, step: str) -> str:
        """Return where a step is, in words."""
        before = [name for key, name in self.names.items() if key in self.into[step]]
        return f"after {', '.join(before)}"


def _starts(step: Part) -> bool:
    return step.aspects["initial"].raw is True


def _changed(change: Change, mine: Meaning | None, theirs: Meaning | None) -> Change:
    """Return the change with what was there before and after, of several lines with those that differ."""
    before, after = (None if each is None else (each.text or each.show)() for each in (mine, theirs))
    is_program = any(each is not None and each.text is not None for each in (mine, theirs))
    if not is_program and "\n" not in f"{before}{after}":
        return replace(change, before=before, after=after)
    old, new = ((text or "").strip("\n").splitlines() for text in (before, after))
    lines = tuple(line.rstrip() for line in difflib.unified_diff(old, new, lineterm="", n=1))[2:]
    return replace(change, before=before, after=after, lines=lines)


def _told(part: Part) -> str | None:
    """Return a part in one word or two; of a longer text the beginning."""
    words = next((part.aspects[each].show() for each in _TOLD if each in part.aspects), "")
    first, _, others = words.partition("\n")
    return f"{first} .." if others else first or None


def _name_of(part: Part, key: Key) -> str:
    return ObjectPath.of(part.path).last.removeprefix(f"{word_of(key.kind)} ")


def _ends_of(chart: Part, transition: Key) -> tuple[str, str]:
    """Return the names of the steps that a transition leaves and of those it leads to, as their file spells them."""
    before, after = (
        "+".join(_name_of(steps[0], Key("step", name)) if (steps := chart.steps_named(name)) else name for name in side)
        for side in ends(transition)
    )
    return before, after


def _label(around: Part, key: Key) -> str:
    """Return a part by its name; a transition without one by where it leads."""
    name = _name_of(around.parts[key], key)
    return _ends_of(around, key)[1] if key.kind == "transition" and " -> " in name else name


def _variables(owner: Part, section: str) -> Iterator[Key]:
    """Yield the variables of one kind of section."""
    for key, part in owner.parts.items():
        found = part.aspects.get("section")
        if key.kind == "variable" and found is not None and found.raw == section:
            yield key


def _in_other_order(left: Sequence[Key], right: Sequence[Key], matched: dict[Key, Key]) -> tuple[list[Key], list[Key]]:
    """Return the part of an order that is another on the right, of what both have, in both orders."""
    before = [each for each in left if matched.get(each) in right]
    there = {matched[each]: each for each in before}
    after = [there[each] for each in right if each in there]
    while before and before[0] == after[0]:
        del before[0], after[0]
    while before and before[-1] == after[-1]:
        del before[-1], after[-1]
    return before, after


def _path(key: Key, part: Part) -> str:
    """Return the place of a part: what has no name of its own has the path of what it is in."""
    return ObjectPath.of(part.path) / key.kind if key.kind in _UNNAMED else part.path


def word_of(kind: str) -> str:
    """Return a kind or an aspect of the listing in the words of an engineer."""
    return _WORDS.get(kind, kind)


def _is_same(left: Part, right: Part) -> bool:
    return alike(left, right, (left.aspects.keys() | right.aspects.keys()) - _PLACES)


def _around(change: Change) -> str:
    path = ObjectPath.of(change.path).around
    return path.last or "the project"


_CHARTS = ("chart", "partial chart", "macro-step")
_UNNAMED = frozenset(
    {"chart", "macro-step", "enclosed chart"}
    | {f"permanent instruction {when} the sequence" for when in ("before", "after")}
)
