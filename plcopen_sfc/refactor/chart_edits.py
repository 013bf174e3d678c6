"""Edits of the steps, transitions and macro-steps of a chart; `plcopen_sfc.refactor.editor` has them as methods."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import count
from typing import Any

from plcopen_sfc.errors import Location, ModelError
from plcopen_sfc.languages.networks import wired_steps
from plcopen_sfc.languages.st import bare_condition, parse_condition
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.translation.text_translation import with_block_comments
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import Condition, SfcNetwork, Step, Transition, by_priority
from plcopen_sfc.reachability import needed_first, reached
from plcopen_sfc.refactor.builder import append_branch
from plcopen_sfc.refactor.journal import Journal
from plcopen_sfc.refactor.queries import dialect_in, pou_of


def refused(what: str, why: Iterable[str] | str, hint: str = "", place: str = "") -> ModelError:
    """Return the error of an edit that would break something: the first reason, the others in the hint."""
    reasons = [why] if isinstance(why, str) else [*dict.fromkeys(why)]
    shown = reasons[1:_SHOWN] + [f".. and {len(reasons) - _SHOWN} more"] * (len(reasons) > _SHOWN)
    return ModelError(
        f"{what}: {reasons[0]}", hint="\n  ".join([*shown, *filter(None, [hint])]), location=Location(path=place)
    )


_SHOWN = 10


def keep_chart(journal: Journal, chart: SfcNetwork) -> None:
    """Remember the lists of a chart, and what its POU declares, before something is added."""
    journal.keep(chart, "steps", "transitions", "sequences")
    for sequence in chart.sequences:
        journal.keep(sequence, "steps")
    pou = pou_of(chart)
    if pou is not None:
        journal.keep_declarations(pou)


# -- steps


def insert_step(
    journal: Journal,
    chart: SfcNetwork,
    name: str,
    link: Transition,
    condition: Condition | str,
    *,
    before: bool,
    fields: Mapping[str, Any],
) -> Step:
    """Put a step behind (or before) a transition, and a transition with `condition` on its other side."""
    keep_chart(journal, chart)
    step = chart.add_step(name, **fields)
    sides: dict[str, Any] = (
        {"sources": link.sources, "targets": [step.id], "priority": link.priority}
        if before
        else {"sources": [step.id], "targets": link.targets}
    )
    neighbours = {*link.sources, *link.targets}
    added = Transition(id=chart.new_id(), **sides)
    added.condition = condition  # type: ignore[assignment]  # a text becomes an expression
    if before:
        journal.put(link, "priority", None)
    journal.put(link, "sources" if before else "targets", [step.id])
    _put_beside(journal, chart, link, [added], behind=not before)
    if _tool_format(chart) == "codesys23":  # its files have steps and transitions as they follow each other
        sources = link.sources if not before else added.sources
        place = max((index for index, each in enumerate(chart.steps) if each.id in sources), default=-1)
        if place >= 0:
            journal.put(chart, "steps", [*chart.steps[: place + 1], step, *chart.steps[place + 1 : -1]])
    for sequence in chart.sequences:
        near = next((index for index, each in enumerate(sequence.steps) if each in neighbours), None)
        if near is not None:
            sequence.steps.insert(near + 1, step.id)
            break
    return step


def _tool_format(chart: SfcNetwork) -> str:
    return chart.project.tool_format if chart.project is not None else ""


def _put_beside(
    journal: Journal, chart: SfcNetwork, link: Transition, added: Sequence[Transition], *, behind: bool
) -> None:
    """Put transitions beside another into the list of a chart: its order is that of competing transitions.

    A `.grafcet` file refers to transitions by their places, and none is tried before another: there they come last.
    """
    place = next(index for index, each in enumerate(chart.transitions) if each is link) + behind
    if _tool_format(chart) == "grafcet":
        place = len(chart.transitions)
    journal.put(chart, "transitions", [*chart.transitions[:place], *added, *chart.transitions[place:]])


def delete_step(journal: Journal, chart: SfcNetwork, step: Step, keep: str | None) -> None:
    """Take a step out, and join its predecessors to its successors with the conditions that `keep` selects."""
    what = f"the step {step.name!r} cannot be deleted"
    if keep not in (None, "incoming", "outgoing", "both"):
        raise ModelError(f"{keep!r} is none of incoming, outgoing and both", hint="It tells which conditions remain.")
    if step.initial:
        raise refused(what, "it is the initial step", "Let another step be initial first.")
    incoming = [each for each in chart.incoming(step) if step.id not in each.sources]
    outgoing = [each for each in chart.outgoing(step) if step.id not in each.targets]
    loops = [each for each in chart.transitions if step.id in each.sources and step.id in each.targets]
    if any(len(each.sources) > 1 or len(each.targets) > 1 for each in loops):
        raise refused(what, f"the transition {chart.label(loops[0])} leads from it to itself and elsewhere")
    if incoming and outgoing:
        if keep is None:
            labels = ", ".join(chart.label(each) for each in (*incoming, *outgoing))
            hint = 'Tell which conditions remain: keep="incoming", "outgoing" or "both".'
            raise refused(what, f"it is between other steps ({labels})", hint)
        _bridge(journal, chart, step, (incoming, outgoing), keep)
    elif incoming or outgoing:
        # at an end of the chart: transitions of simultaneous sequences lose one side, all others lead nowhere and go
        # too
        joining = [each for each in (*incoming, *outgoing) if each.sources != [step.id] and each.targets != [step.id]]
        for each in joining:
            side = "sources" if step.id in each.sources else "targets"
            journal.put(each, side, [i for i in getattr(each, side) if i != step.id])
        loops += [each for each in (*incoming, *outgoing) if not any(each is other for other in joining)]
    _take_out(journal, chart, [step], loops)


def _bridge(
    journal: Journal,
    chart: SfcNetwork,
    step: Step,
    sides: tuple[list[Transition], list[Transition]],
    keep: str,
) -> None:
    incoming, outgoing = sides
    what = f"the step {step.name!r} cannot be bridged"
    if len(outgoing) == 1 and outgoing[0].sources == [step.id]:
        gone, staying, side, behind = outgoing[0], incoming, "targets", True
    elif len(incoming) == 1 and incoming[0].targets == [step.id]:
        gone, staying, side, behind = incoming[0], outgoing, "sources", False
    else:
        raise refused(what, "several transitions lead to it and several leave it, or it is joined with other steps")
    others = getattr(gone, side)
    for each in staying:
        own = getattr(each, side)
        bridged = [i for old in own for i in (others if old == step.id else [old])]
        if len(set(bridged)) < len(bridged):
            raise refused(what, f"the transition {chart.label(each)} would name a step twice")
        if not behind and each.sources != [step.id] and keep == "incoming":
            raise refused(
                what, f"the transition {chart.label(each)} waits for other steps too, its condition must remain"
            )
        if behind and each.targets != [step.id] and keep == "outgoing":
            raise refused(
                what, f"the transition {chart.label(each)} activates other steps too, its condition must remain"
            )
        conditions = (each.condition, gone.condition) if behind else (gone.condition, each.condition)
        journal.put(each, "condition", _kept(what, conditions, keep, dialect_in(chart)))
        journal.put(each, side, bridged)
    journal.put(chart, "transitions", [each for each in chart.transitions if each is not gone])


def _kept(what: str, conditions: tuple[Condition | None, Condition | None], keep: str, dialect: Dialect) -> Any:
    if keep != "both":
        return conditions[keep == "outgoing"]
    return joined(what, [each for each in conditions if each is not None], "AND", dialect)


def joined(what: str, conditions: Sequence[Condition], operator: str, dialect: Dialect) -> Condition:
    """Several conditions as one, joined by AND or OR. Raises `ModelError` where one is no expression."""
    parts: list[str] = []
    for each in conditions:
        if not isinstance(each, Expression):
            raise refused(what, "a condition is no expression", "Inline named conditions first.")
        tree = parse_condition(each.text, dialect).tree
        text = with_block_comments(bare_condition(each.text, dialect), dialect)
        if isinstance(tree, n.Literal) and tree.text.upper() == "TRUE" and operator == "AND" and not each.negated:
            continue
        plain = isinstance(tree, n.Name | n.Member | n.Literal | n.Call | n.Parenthesized | n.Index | n.Address)
        text = text if plain else f"({text})"
        parts.append(f"NOT {text}" if each.negated else text)
    return Expression(text=f" {operator} ".join(parts) or "TRUE")


def _take_out(journal: Journal, chart: SfcNetwork, steps: Sequence[Step], transitions: Sequence[Transition]) -> None:
    """Remove steps and transitions. Refused where drawn logic, or a condition that stays, has a wire from a step."""
    ids = {step.id for step in steps}
    journal.put(chart, "steps", [each for each in chart.steps if each.id not in ids])
    gone = {id(each) for each in transitions}
    journal.put(chart, "transitions", [each for each in chart.transitions if id(each) not in gone])
    needed = wired_steps(chart)
    for step in steps:
        if step.id in needed:
            raise refused(
                f"the step {step.name!r} cannot be removed", "a wire leads from it to logic that is drawn in the chart"
            )
    for sequence in chart.sequences:
        if not ids.isdisjoint(sequence.steps):
            journal.put(sequence, "steps", [each for each in sequence.steps if each not in ids])


def check_number(step: Step, number: int | None) -> None:
    """Raise `ModelError` where another step of the chart has this number: tools know steps by them."""
    others = [each for each in step.chart.steps if each is not step] if step.chart is not None else []
    taken = next((each for each in others if number is not None and each.number == number), None)
    if taken is not None:
        raise refused(f"the step {step.name!r} cannot have the number {number}", f"the step {taken.name!r} has it")


# -- transitions


def split_transition(journal: Journal, chart: SfcNetwork, link: Transition) -> list[Transition]:
    """Make a transition for each operand of OR in the condition, which compete in their order."""
    what = f"the transition {chart.label(link)} cannot be split"
    condition = link.condition
    if not isinstance(condition, Expression) or condition.negated:
        raise refused(what, "its condition is no expression, or negated as a whole")
    parsed = parse_condition(condition.text, dialect_in(chart))
    tree = n.bare(parsed.tree)
    if parsed.problems or not isinstance(tree, n.Operation) or tree.operator is not n.Operator.OR:
        raise refused(what, f"{condition.text!r} has no OR outside of parentheses")
    if link.name:
        raise refused(what, "it has a name, and two transitions cannot share it")
    first, *others = (condition.text[part.span[0] : part.span[1]].strip() for part in tree.operands if part.span)
    fields: dict[str, Any] = {"sources": link.sources, "targets": link.targets, "priority": link.priority}
    numbers = count(chart.new_id())
    added = [Transition(id=next(numbers), **fields, condition=Expression(text=text)) for text in others]
    journal.put(link, "condition", first)
    _put_beside(journal, chart, link, added, behind=True)
    _order(journal, chart, link)
    return [link, *added]


def _order(journal: Journal, chart: SfcNetwork, link: Transition) -> None:
    """Number the priorities of transitions that compete with one, where they have some."""
    for source in link.sources:
        competing = by_priority(t for t in chart.transitions if source in t.sources)
        if any(each.priority is not None for each in competing):
            for number, each in enumerate(competing, 1):
                if each.priority is not None and each.priority != number:
                    journal.put(each, "priority", number)


def join_transitions(journal: Journal, chart: SfcNetwork, links: Sequence[Transition]) -> Transition:
    """Make one transition of several between the same steps, by OR."""
    what = "the transitions cannot be joined"
    if len(links) < 2:
        raise refused(what, "at least two are needed")
    first = links[0]
    if any({*each.sources} != {*first.sources} or {*each.targets} != {*first.targets} for each in links):
        raise refused(what, "they are not all between the same steps")
    order = chart.outgoing(next(step for step in chart.steps if step.id in first.sources))
    places = sorted(next(i for i, each in enumerate(order) if each is link) for link in links)
    if places != list(range(places[0], places[0] + len(places))):
        raise refused(what, "a competing transition is tried between them")
    first, *others = [order[place] for place in places]
    conditions = [each.condition for each in (first, *others) if each.condition is not None]
    condition = joined(what, conditions, "OR", dialect_in(chart))
    journal.put(first, "condition", condition)
    gone = {id(each) for each in others}
    journal.put(chart, "transitions", [each for each in chart.transitions if id(each) not in gone])
    return first


def retarget(journal: Journal, chart: SfcNetwork, old: Step, new: Step, links: Iterable[Transition] | None) -> None:
    """Redirect transitions that lead to a step to another one."""
    for each in chart.incoming(old) if links is None else links:
        if old.id not in each.targets:
            raise refused(
                f"the transition {chart.label(each)} cannot be retargeted", f"it does not lead to {old.name!r}"
            )
        if new.id in each.targets:
            raise refused(
                f"the transition {chart.label(each)} cannot be retargeted", f"it leads to {new.name!r} already"
            )
        journal.put(each, "targets", [new.id if i == old.id else i for i in each.targets])


# -- branches


def add_branch(
    journal: Journal, chart: SfcNetwork, start: Step | Transition, parts: Sequence[Any], end: Transition | None
) -> None:
    """Append a branch to a selection at a step, or to simultaneous sequences at a transition, up to `end`."""
    keep_chart(journal, chart)
    if isinstance(start, Step):
        if end is not None:
            raise ModelError("a branch of a selection ends with a jump", hint='Append jump("..") to its parts.')
        chart.add_sequence(*parts, after=start)
        return
    journal.keep(start, "targets")
    if end is not None:
        journal.keep(end, "sources")
    first, last = append_branch(chart, parts)
    start.targets = [*start.targets, first]
    if end is not None:
        end.sources = [*end.sources, *last]


def branch_of(chart: SfcNetwork, start: Transition | Step) -> list[Step]:
    """Return the steps of the branch that begins with a transition or a step: those that nothing else leads to.

    Raises `ModelError` where none begins there, or the chart needs it.
    """
    if isinstance(start, Step):
        what, cut = f"the branch of {start.name!r} cannot be removed", chart.incoming(start)
        if not cut or any(len(each.targets) < 2 for each in cut):
            raise refused(what, "it does not begin simultaneous sequences", "Give the transition of a selection.")
        without = {id(each): {start.id} for each in cut}
    else:
        what, without = f"the branch of {chart.label(start)} cannot be removed", {id(start): {*start.targets}}
        if not any({*each.sources} & {*start.sources} and each is not start for each in chart.transitions):
            raise refused(what, "no other transition leaves the step before it")
    gone = _reachable(chart, {}) - _reachable(chart, without)
    for each in chart.transitions if isinstance(start, Transition) else ():
        if not gone.isdisjoint(each.sources) and not gone.issuperset(each.sources):
            raise refused(what, f"the transition {chart.label(each)} waits for steps of it and for others")
    return [step for step in chart.steps if step.id in gone]


def remove_branch(journal: Journal, chart: SfcNetwork, start: Transition | Step, gone: Sequence[Step]) -> None:
    """Take out the branch that begins with a transition or a step, and that has the steps `gone`."""
    ids = {step.id for step in gone}
    transitions = [start] if isinstance(start, Transition) else []
    for each in chart.transitions:
        if each.sources and ids.issuperset(each.sources):
            transitions.append(each)
            continue
        for side in ("sources", "targets"):
            own: list[int] = getattr(each, side)
            if each is not start and not ids.isdisjoint(own):
                journal.put(each, side, [i for i in own if i not in ids])
    _take_out(journal, chart, gone, transitions)


def _reachable(chart: SfcNetwork, without: Mapping[int, set[int]]) -> set[int]:
    """The ids of the steps that transitions lead to from initial ones; `without` targets, by `id` of the transition."""
    leaving: dict[int, list[int]] = {}
    for each in chart.transitions:
        targets = [i for i in each.targets if i not in without.get(id(each), ())]
        for source in each.sources:
            leaving.setdefault(source, []).extend(targets)
    first = [step.id for step in chart.initial_steps or chart.steps[:1]]
    return reached(first, lambda number: leaving.get(number, ()))


# -- numbers


def along_the_flow(chart: SfcNetwork) -> list[Step]:
    """Return the steps in the order in which a person meets them: from the initial ones down, branch by branch.

    Where branches come together, the steps below follow the last of them; a jump back changes nothing.
    """
    steps = {step.id: step for step in chart.steps}
    after: dict[int, list[int]] = {}
    for step in chart.steps:
        after[step.id] = [i for each in chart.outgoing(step) for i in each.targets if i in steps]
    found: list[Step] = []
    done: set[int] = set()
    for start in (*chart.initial_steps, *chart.steps):
        below = [steps[i] for i in needed_first([start.id], lambda number: reversed(after[number]), done)]
        found += reversed(below)
    return found


def renumber(journal: Journal, chart: SfcNetwork, start: int, increment: int) -> dict[str, int]:
    """Number the steps along the flow, and the transitions with them.

    Gives the numbers by the names of the steps.
    """
    numbers = {step.name: start + place * increment for place, step in enumerate(along_the_flow(chart))}
    for step in chart.steps:
        journal.put(step, "number", numbers[step.name])
    ordered = sorted(
        chart.transitions,
        key=lambda t: min((numbers[s.name] for s in chart.steps if s.id in t.sources), default=0),
    )
    for place, transition in enumerate(ordered):
        if transition.number is not None:
            journal.put(transition, "number", start + place * increment)
    return numbers
