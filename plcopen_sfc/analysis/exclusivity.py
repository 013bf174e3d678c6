"""Conditions that exclude each other, are always or never true, or are covered by others.

Boolean operations are decided exactly, and so are comparisons of variables with constants and with each other; of
anything else (arithmetic, calls) only as much is known as that equal expressions have equal values. Numbers are
numbers: NaN is not considered.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

from plcopen_sfc.analysis.formulas import COMPARING, Formula, JudgedCondition, Situation, negation
from plcopen_sfc.analysis.knowledge import Knowledge, ValueKind, VariableValues, constant_of
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.languages.effects import targets
from plcopen_sfc.languages.networks import NetworkExpression, condition_expression
from plcopen_sfc.languages.st import names_of, parse_condition, walk
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import LiteralKind
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.model.conditions import Expression as Condition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import NamedTransition
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Transition

AnyCondition: TypeAlias = str | NetworkExpression | n.Node
"""A condition as text, as a tree, or as `condition_of` gives it."""


@dataclass(frozen=True)
class Exclusivity:
    """Answer to whether two conditions exclude each other; its truth value is True if they do.

    NO: `witness` is a situation in which both are true. UNKNOWN: `reason` tells why.
    """

    answer: Answer
    witness: Situation = field(default_factory=dict)
    reason: str = ""

    def __bool__(self) -> bool:
        return bool(self.answer)


class Truth(StrEnum):
    """Truth of a condition. VARIES: it can be true and it can be false."""

    ALWAYS = "always"
    NEVER = "never"
    VARIES = "varies"
    UNKNOWN = "unknown"


def condition_of(
    chart: SfcNetwork,
    transition: Transition,
    dialect: Dialect = Dialect.IEC,
    *,
    transitions: Iterable[NamedTransition] = (),
) -> NetworkExpression:
    """Return the condition of a transition, however it is given.

    `transitions` are those of the POU (`Pou.transitions`).
    """
    return condition_expression(chart, transition, dialect, transitions=transitions)


def association_condition(association: ActionAssociation, dialect: Dialect = Dialect.IEC) -> Expression | None:
    """Return the condition of an action association as a tree; None: it has none, or none that is an expression."""
    if not isinstance(association.condition, Condition):
        return None
    parsed = parse_condition(association.condition.text, dialect)
    return None if parsed.problems else parsed.tree


def exclusive(
    a: AnyCondition, b: AnyCondition, *, dialect: Dialect = Dialect.IEC, knowledge: Knowledge | None = None
) -> Exclusivity:
    """Decide if two conditions exclude each other. `knowledge`: what is known of the variables in them.

    Without knowledge a name is what its use shows: Boolean, a number, a duration. See `project_knowledge`.
    """
    read = [_read(condition, dialect) for condition in (a, b)]
    problem = next((r for r in read if isinstance(r, str)), None)
    if problem is not None:
        return Exclusivity(Answer.UNKNOWN, reason=problem)
    formula = Formula(dialect, knowledge)
    possible, witness, reason = formula.check(formula.terms([r for r in read if isinstance(r, JudgedCondition)]))
    return Exclusivity(_not(possible), witness, reason)


def truth(condition: AnyCondition, *, dialect: Dialect = Dialect.IEC, knowledge: Knowledge | None = None) -> Truth:
    """Decide if a condition is true always, never, or sometimes."""
    read = _read(condition, dialect)
    if isinstance(read, str):
        return Truth.UNKNOWN
    constant = constant_of(read.tree, dialect, knowledge)
    if constant is not None and constant.kind is LiteralKind.BOOL:  # thousands in long charts, as comparisons are
        return Truth.ALWAYS if constant.value else Truth.NEVER
    if knowledge is not None and not read.own and _compares_within(read.tree, dialect, knowledge):
        return Truth.VARIES
    formula = Formula(dialect, knowledge)
    terms = formula.terms([read])
    can_be_true = formula.can_be_true(terms)
    if can_be_true is False:
        return Truth.NEVER
    can_be_false = formula.can_be_true([negation(terms[0])])
    if can_be_false is False:
        return Truth.ALWAYS
    return Truth.VARIES if can_be_true and can_be_false else Truth.UNKNOWN


def _compares_within(tree: Expression, dialect: Dialect, knowledge: Knowledge) -> bool:
    """True for a whole number that is compared with one between its least and its greatest value.

    Charts have thousands of such conditions, and asking the solver takes a millisecond each time.
    """
    tree = n.bare(tree)
    if not isinstance(tree, n.Operation) or tree.operator not in COMPARING or len(tree.operands) != 2:
        return False
    for one, other in (tree.operands, tree.operands[::-1]):
        name, constant = n.bare(one), constant_of(other, dialect, knowledge)
        values = knowledge(name) if isinstance(name, n.Name) and constant is not None else None
        if constant is None or not isinstance(values, VariableValues) or values.kind is not ValueKind.INTEGER:
            continue
        least, greatest, number = values.least, values.greatest, constant.value
        if least is not None and greatest is not None and type(number) is int:
            return least < number < greatest
    return False


def covered(
    condition: AnyCondition,
    others: Sequence[AnyCondition],
    *,
    dialect: Dialect = Dialect.IEC,
    knowledge: Knowledge | None = None,
) -> Answer:
    """Return True if one of `others` is true whenever `condition` is: behind them, its transition never fires."""
    read = [_read(each, dialect) for each in (condition, *others)]
    if any(isinstance(r, str) for r in read):
        return Answer.UNKNOWN
    formula = Formula(dialect, knowledge)
    first, *rest = formula.terms([r for r in read if isinstance(r, JudgedCondition)])
    return _not(formula.can_be_true([first, negation(formula.disjunction(rest))]))


def overlapping(
    conditions: Sequence[AnyCondition],
    *,
    most: int,
    dialect: Dialect = Dialect.IEC,
    knowledge: Knowledge | None = None,
) -> Iterator[tuple[int, int]]:
    """Yield the places of two conditions that are not known to exclude each other, for each later one at most `most`.

    Halves are compared as wholes first, so that a thousand conditions that exclude each other, as those that compare
    a number do, cost a thousand questions and not half a million. Where all are true together, half a million pairs
    are the answer: `most` bounds it.
    """
    read = [_read(condition, dialect) for condition in conditions]
    judged = {place: one for place, one in enumerate(read) if isinstance(one, JudgedCondition) and not one.own}
    formula = Formula(dialect, knowledge)
    terms = dict(zip(judged, formula.terms([*judged.values()]), strict=True))

    found: Counter[int] = Counter()

    def between(left: Sequence[int], right: Sequence[int]) -> Iterator[tuple[int, int]]:
        if all(found[place] >= most for place in right):
            return
        if terms.keys() >= {*left, *right}:
            either = [formula.disjunction([terms[place] for place in side]) for side in (left, right)]
            if formula.can_be_true(either) is False:
                return
        if len(left) == len(right) == 1:
            found[right[0]] += 1
            yield left[0], right[0]
        elif len(left) > len(right):
            for half in _halves(left):
                yield from between(half, right)
        else:
            for half in _halves(right):
                yield from between(left, half)

    def among(places: Sequence[int]) -> Iterator[tuple[int, int]]:
        if len(places) > 1:
            left, right = _halves(places)
            yield from among(left)
            yield from among(right)
            yield from between(left, right)

    return among(range(len(conditions)))


def _halves(places: Sequence[int]) -> tuple[Sequence[int], Sequence[int]]:
    middle = len(places) // 2
    return places[:middle], places[middle:]


def _not(possible: bool | None) -> Answer:
    if possible is None:
        return Answer.UNKNOWN
    return Answer.NO if possible else Answer.YES


def _read(condition: AnyCondition, dialect: Dialect) -> JudgedCondition | str:
    """Return a condition ready to be decided, or why it is not."""
    if isinstance(condition, str):
        parsed = parse_condition(condition, dialect)
        if parsed.problems:
            return f"{condition!r}: {parsed.problems[0].message}"
        return JudgedCondition(parsed.tree)
    if not isinstance(condition, NetworkExpression):
        return JudgedCondition(condition)  # type: ignore[arg-type]  # nodes that are no expressions are atoms
    if condition.tree is None or not condition.complete:
        return condition.problems[0].message if condition.problems else "the condition cannot be read"
    return JudgedCondition(condition.tree, _written(condition))


def _written(condition: NetworkExpression) -> frozenset[str]:
    """Return the variables that are written, and the instances that are called, before the condition has its value."""
    found = {helper.name.casefold() for helper in condition.helpers}
    for statement in condition.before:
        written = [*targets(statement), *(node.callee for node in walk(statement) if isinstance(node, n.Call))]
        found |= {name for each in written for name in names_of(each)}
    return frozenset(found)
