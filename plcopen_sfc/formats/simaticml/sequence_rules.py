"""Connections of a GRAPH sequence as records, and which of them S7-GRAPH allows.

Where it allows none, steps and transitions are put between. The connections that TIA Portal refuses were found by
importing into it (V20); nesting follows what its editor can draw.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from lxml import etree

from plcopen_sfc.formats.simaticml.element_reader import NotUnderstoodError, children, local
from plcopen_sfc.formats.simaticml.element_writer import sub
from plcopen_sfc.grouping import grouped
from plcopen_sfc.whole_numbers import whole_number

_LETTERS = {"StepRef": "S", "TransitionRef": "T", "BranchRef": "B"}
_NAMES = {letter: name for name, letter in _LETTERS.items()}
END = "end"
"""End of a sequence in the order of connections."""


@dataclass(frozen=True)
class ElementRef:
    """A step (``S``), a transition (``T``) or a branch (``B``) by its number; `path`: the in or output of a branch."""

    kind: str
    number: int
    path: int | None = None

    def __str__(self) -> str:
        return f"{self.kind}{self.number}" + (f".{self.path}" if self.path is not None else "")


@dataclass(frozen=True)
class SequenceLink:
    """A connection; `target` None: the sequence ends there."""

    source: ElementRef
    target: ElementRef | None
    is_jump: bool = False

    def __str__(self) -> str:
        return f"{self.source}{'~' if self.is_jump else '-'}{self.target if self.target is not None else END}"


def read_link(element: etree._Element) -> SequenceLink:
    """Read ``Connection``. Raises `NotUnderstoodError`."""
    parts = {local(child): child for child in children(element)}
    if element.attrib or any(part.attrib for part in parts.values()):
        raise NotUnderstoodError("connection")
    kind = (parts["LinkType"].text or "") if "LinkType" in parts else ""
    if (
        len(element) != len(parts)
        or parts.keys() != {"NodeFrom", "NodeTo", "LinkType"}
        or kind not in ("Direct", "Jump")
    ):
        raise NotUnderstoodError("connection")
    source = _node(parts["NodeFrom"], "Out")
    if source is None:
        raise NotUnderstoodError("connection")
    return SequenceLink(source, _node(parts["NodeTo"], "In"), kind == "Jump")


def _node(element: etree._Element, side: str) -> ElementRef | None:
    found = children(element)
    if len(found) == 1 and local(found[0]) == "EndConnection" and not found[0].attrib and not len(found[0]):
        return None
    letter = _LETTERS.get(local(found[0]), "") if len(found) == 1 else ""
    number, path = (whole_number(found[0].get("Number")), whole_number(found[0].get(side))) if letter else (None, None)
    usual = {"Number", side} if path is not None else {"Number"}
    if number is None or set(found[0].attrib) != usual:
        raise NotUnderstoodError("a node of a connection")
    return ElementRef(letter, number, path)


def write_link(parent: etree._Element, link: SequenceLink) -> None:
    """Write ``Connection``."""
    element = sub(parent, "Connection")
    _write_node(sub(element, "NodeFrom"), link.source, "Out")
    _write_node(sub(element, "NodeTo"), link.target, "In")
    sub(element, "LinkType").text = "Jump" if link.is_jump else "Direct"


def _write_node(parent: etree._Element, ref: ElementRef | None, side: str) -> None:
    if ref is None:
        sub(parent, "EndConnection")
        return
    path = {side: str(ref.path)} if ref.path is not None else {}
    sub(parent, _NAMES[ref.kind], {"Number": str(ref.number), **path})


_IN_WORDS = {
    "S": "a step",
    "T": "a transition",
    "AltBegin": "the begin of an alternative branch",
    "AltEnd": "the end of an alternative branch",
    "SimBegin": "the begin of a simultaneous branch",
    "SimEnd": "the end of a simultaneous branch",
    "": "the end of the sequence",
}
# TIA Portal V20 refuses to import a block with any other direct connection
_DIRECT = frozenset(
    {
        ("S", "T"),
        ("S", "AltBegin"),
        ("S", "SimEnd"),
        ("T", "S"),
        ("T", "AltEnd"),
        ("T", "SimBegin"),
        ("T", ""),
        ("AltBegin", "T"),
        ("AltEnd", "S"),
        ("SimBegin", "S"),
        ("SimEnd", "T"),
    }
)
MOST_SEQUENCES = 8
MOST_STEPS = 250
MOST_TRANSITIONS = 250
"""Limits of one block (S7-GRAPH V6, TIA Portal)."""


@dataclass(frozen=True)
class InsertedElements:
    """Steps and transitions of no chart, inserted where S7-GRAPH wants one. `never`: transitions that stay FALSE."""

    steps: tuple[int, ...] = ()
    transitions: tuple[int, ...] = ()
    never: tuple[int, ...] = ()


class Legaliser:
    """Puts steps and transitions between what S7-GRAPH does not connect; they get numbers from `step` and `transition`.

    * a selection behind a simultaneous convergence: a transition that is TRUE and a step between them;
    * a path of a simultaneous branch that begins with a jump, or at a step that others reach: a step and a transition
      that is TRUE before it;
    * a step that nothing follows: a transition that is FALSE, and the end of the sequence.
    """

    def __init__(self, types: Mapping[int, str], step: int, transition: int) -> None:
        self._types = types
        self._step = step
        self._transition = transition
        self._steps: list[int] = []
        self._transitions: list[int] = []
        self._never: list[int] = []

    @property
    def added(self) -> InsertedElements:
        """Elements inserted so far."""
        return InsertedElements(tuple(self._steps), tuple(self._transitions), tuple(self._never))

    def links(self, links: Iterable[SequenceLink], dead_ends: Iterable[int]) -> list[SequenceLink]:
        """Connections that mean the same, as far as S7-GRAPH has such. `dead_ends`: steps that nothing follows."""
        found: list[SequenceLink] = []
        for link in links:
            source, target = kind_of(link.source, self._types), kind_of(link.target, self._types)
            if source == "SimEnd" and target in ("AltBegin", "SimEnd"):
                # no branch follows a branch directly: the pair between costs one cycle, which the report lists
                step, transition = self._new_step(), self._new_transition()
                found += [
                    SequenceLink(link.source, transition),
                    SequenceLink(transition, step),
                    replace(link, source=step),
                ]
            elif source == "SimBegin" and (link.is_jump or target == "AltEnd"):
                # a simultaneous path begins with a step, and only a transition jumps
                step, transition = self._new_step(), self._new_transition()
                found += [
                    SequenceLink(link.source, step),
                    SequenceLink(step, transition),
                    replace(link, source=transition),
                ]
            else:
                found.append(link)
        for number in dead_ends:
            transition = self._new_transition()
            self._never.append(transition.number)
            found += [SequenceLink(ElementRef("S", number), transition), SequenceLink(transition, None)]
        return found

    def _new_step(self) -> ElementRef:
        self._step += 1
        self._steps.append(self._step)
        return ElementRef("S", self._step)

    def _new_transition(self) -> ElementRef:
        self._transition += 1
        self._transitions.append(self._transition)
        return ElementRef("T", self._transition)


def without_joined_jumps(links: list[SequenceLink], types: Mapping[int, str]) -> list[SequenceLink]:
    """Connections in which no alternative branch ends in a jump: S7-GRAPH has a jump behind each of its transitions."""
    while True:
        jumps = {link.source.number: link for link in links if link.is_jump and kind_of(link.source, types) == "AltEnd"}
        if not jumps:
            return links
        found: list[SequenceLink] = []
        for link in links:
            into = jumps.get(link.target.number) if link.target is not None and link.target.kind == "B" else None
            if into is not None:
                found.append(replace(into, source=link.source))
            elif link not in jumps.values():
                found.append(link)
        links = found


def with_competing_transitions_joined(links: list[SequenceLink], types: Mapping[int, str]) -> list[SequenceLink]:
    """Connections in which competing transitions that wait for the same steps part behind one simultaneous end.

    Drawings may part at each of the steps instead, and join once for each transition, which S7-GRAPH cannot express.
    """
    entering = {_key(link.target): link for link in links if link.target is not None and not link.is_jump}
    joins = grouped(
        (link.target.number, link)
        for link in links
        if link.target is not None and kind_of(link.target, types) == "SimEnd"
    )
    groups: dict[tuple[ElementRef, ...], list[int]] = {}
    for number, inputs in joins.items():
        begins = [link.source.number for link in inputs if kind_of(link.source, types) == "AltBegin"]
        before = [entering[("B", begin)].source for begin in begins if ("B", begin) in entering]
        if len(before) == len(inputs) and all(ref.kind == "S" for ref in before):
            groups.setdefault(tuple(sorted(before, key=lambda ref: ref.number)), []).append(number)
    for waiting, ends in groups.items():
        above = {link.source.number for end in ends for link in joins[end]}
        paths = [link for link in links if link.source.kind == "B" and link.source.number in above]
        only = all(link.target is not None and link.target.kind == "B" and link.target.number in ends for link in paths)
        if only and len(ends) > 1:
            links = _joined_once(links, waiting, ends, above)
    return links


def _joined_once(
    links: list[SequenceLink], waiting: tuple[ElementRef, ...], ends: list[int], begins: set[int]
) -> list[SequenceLink]:
    """Join the steps `waiting` in the first of `ends`, and divide the ways behind the `ends` there."""
    first = next(link.target.number for link in links if link.source == waiting[0] and link.target is not None)
    ranks = {
        link.target.number: link.source.path or 0
        for link in links
        if link.source.kind == "B" and link.source.number == first and link.target is not None
    }
    end = min(ends)
    found: list[SequenceLink] = []
    for link in links:
        source, target = link.source, link.target
        if source in waiting:
            found.append(SequenceLink(source, ElementRef("B", end, waiting.index(source))))
        elif source.kind == "B" and source.number in ends:
            if source.number == end:
                found.append(SequenceLink(ElementRef("B", end, 0), ElementRef("B", first, 0)))
            found.append(SequenceLink(ElementRef("B", first, ranks[source.number]), target))
        elif not (source.kind == "B" and source.number in begins):
            found.append(link)
    return found


def without_inserted(links: list[SequenceLink], added: frozenset[ElementRef]) -> list[SequenceLink]:
    """Links without the elements that `Legaliser` inserted; other structures stay."""
    leaving = {link.source: link for link in links if link.source in added}
    found: list[SequenceLink] = []
    for link in links:
        if link.source in added:
            continue
        last = link
        # several pairs may be in a row: a simultaneous end behind another one, and a selection behind both
        while last.target is not None and last.target in leaving and not last.is_jump:
            last = leaving[last.target]
        if last.target is None and link.source.kind == "S" and last is not link:
            continue
        found.append(replace(last, source=link.source))
    return found


def is_contractible(links: list[SequenceLink], added: frozenset[ElementRef]) -> bool:
    """True if all elements marked as added are between two others, as `Legaliser` inserts them."""
    # a jump to an inserted step, or a second connection at one, came later: the step is part of the chart now
    if any(link.is_jump and link.target in added for link in links):
        return False
    entering = [link.target for link in links if link.target in added]
    leaving = {link.source: link for link in links if link.source in added}
    if not len(entering) == len(leaving) == len(added) == sum(link.source in added for link in links):
        return False
    reached: set[ElementRef] = set()
    for link in links:
        if link.source in added or link.target not in added:
            continue
        target: ElementRef | None = link.target
        length = 0
        while target in leaving and target not in reached:
            reached.add(target)
            target = leaving[target].target
            length += 1
        if length != (_LAST if target is None and link.source.kind == "S" else _PAIR):
            return False
    return reached == added


_LAST = 1
_PAIR = 2
"""Elements that are inserted: a transition before the end of a sequence, else a step and a transition."""


def kind_of(ref: ElementRef | None, types: Mapping[int, str]) -> str:
    """Return the letter of a step or transition, the type of a branch, "" for the end of a sequence."""
    if ref is None:
        return ""
    return types.get(ref.number, "?") if ref.kind == "B" else ref.kind


def connection_problems(links: list[SequenceLink], types: Mapping[int, str]) -> list[str]:
    """Return the connections that S7-GRAPH does not allow, in words."""
    found: list[str] = []
    entered: dict[ElementRef, int] = {}
    left: dict[ElementRef, int] = {}
    for link in links:
        source, target = kind_of(link.source, types), kind_of(link.target, types)
        if link.is_jump and (source, target) != ("T", "S"):
            found.append(f"S7-GRAPH has no jump from {_IN_WORDS.get(source)} to {_IN_WORDS.get(target)} ({link})")
        elif not link.is_jump and (source, target) not in _DIRECT:
            found.append(f"S7-GRAPH has no connection from {_IN_WORDS.get(source)} to {_IN_WORDS.get(target)} ({link})")
        left[link.source] = left.get(link.source, 0) + 1
        if link.target is not None and not link.is_jump:
            entered[link.target] = entered.get(link.target, 0) + 1
    several = [(ref, "from") for ref, count in left.items() if count > 1]
    several += [(ref, "to") for ref, count in entered.items() if count > 1]
    found += [f"S7-GRAPH has one connection {way} {_IN_WORDS[r.kind]} ({r})" for r, way in several if r.kind != "B"]
    return found + _Nesting(links, types).problems()


_Context = tuple[tuple[int, int], ...]
"""Simultaneous branches around an element: number and path of each."""


class _Nesting:
    """Follows the direct connections from their begin, and knows the simultaneous paths around each element."""

    def __init__(self, links: list[SequenceLink], types: Mapping[int, str]) -> None:
        self.links = links
        self.types = types
        self.following: dict[tuple[str, int], list[tuple[ElementRef, ElementRef]]] = {}
        self.inputs: dict[tuple[str, int], int] = {}
        self.paths: dict[int, int] = {}
        for link in links:
            if link.is_jump or link.target is None:
                continue
            self.following.setdefault(_key(link.source), []).append((link.source, link.target))
            self.inputs[_key(link.target)] = self.inputs.get(_key(link.target), 0) + 1
            self.inputs.setdefault(_key(link.source), 0)
            if kind_of(link.source, types) == "SimBegin":
                self.paths[link.source.number] = self.paths.get(link.source.number, 0) + 1

    def problems(self) -> list[str]:
        """Problems: connections that do not nest."""
        found: list[str] = []
        contexts: dict[tuple[str, int], _Context] = {}
        arrived: dict[tuple[str, int], list[_Context]] = {}
        # topological order: an element follows when all its inputs have arrived, so those in a loop never do
        pending = [key for key, count in self.inputs.items() if count == 0]
        contexts.update(dict.fromkeys(pending, ()))
        while pending:
            key = pending.pop()
            for source, target in self.following.get(key, ()):
                opened = kind_of(source, self.types) == "SimBegin"
                path = ((source.number, source.path or 0),) if opened else ()
                reached = _key(target)
                arrived.setdefault(reached, []).append(contexts[key] + path)
                if len(arrived[reached]) == self.inputs[reached]:
                    contexts[reached], problem = self._joined(target, arrived[reached])
                    found += [problem] if problem else []
                    pending.append(reached)
        if contexts.keys() != self.inputs.keys():
            found.append("S7-GRAPH closes a loop with a jump only")
        for link in self.links:
            if link.is_jump and link.target is not None:
                inner, outer = contexts.get(_key(link.source)), contexts.get(_key(link.target))
                if inner is not None and outer is not None and inner != outer:
                    found.append(f"S7-GRAPH has no jump into or out of a simultaneous branch ({link})")
        return found

    def _joined(self, ref: ElementRef, contexts: list[_Context]) -> tuple[_Context, str]:
        """Return the context behind `ref`, and the problems with it."""
        if kind_of(ref, self.types) != "SimEnd":
            same = len(set(contexts)) == 1
            return contexts[0], "" if same else f"paths of different simultaneous branches meet ({ref})"
        outer = {context[:-1] for context in contexts if context}
        begins = {context[-1][0] for context in contexts if context}
        all_paths = all(contexts) and len(set(contexts)) == len(contexts) and len(outer) == len(begins) == 1
        if all_paths and self.paths.get(next(iter(begins))) == len(contexts):
            return next(iter(outer)), ""
        return min(contexts, key=len)[:-1], f"a simultaneous branch ends that did not begin as one ({ref})"


def _key(ref: ElementRef) -> tuple[str, int]:
    return ref.kind, ref.number
