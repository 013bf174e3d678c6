"""A chart as a lowering sees it: its net, its conditions and actions as syntax trees, and what only GRAFCET has."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import count
from typing import Any, NoReturn, Self, TypeAlias

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.networks import Helper
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.lowering.code_texts import step_digits
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.text import Text
from plcopen_sfc.semantics.charts.grafcet.partial_charts import RuledChart
from plcopen_sfc.semantics.net import Net, indexes

Change: TypeAlias = Callable[[Any], Any]
"""Makes another node of the same kind of a node."""


@dataclass(frozen=True)
class SourcePart:
    """Part of a chart that is lowered. Its fields are texts as syntax trees, other parts, and what is no text."""

    def changed(self, change: Change) -> Self:
        """Return the same with `change` applied to every text but the targets of actions."""

        def of(value: Any) -> Any:
            match value:
                case n.Node():
                    return change(value)
                case SourcePart():
                    return value.changed(change)
                case tuple():
                    return tuple(map(of, value))
                case dict():
                    return {key: of(each) for key, each in value.items()}
            return value

        return replace(
            self, **{each.name: of(getattr(self, each.name)) for each in fields(self) if each.name != "target"}
        )

    def trees(self) -> Iterator[n.Node]:
        """Yield every text."""
        waiting: list[Any] = [getattr(self, each.name) for each in fields(self)]
        while waiting:
            match waiting.pop():
                case n.Node() as tree:
                    yield tree
                case SourcePart() as part:
                    yield from part.trees()
                case tuple() as several:
                    waiting += several
                case dict() as several:
                    waiting += several.values()


@dataclass(frozen=True)
class ConditionText(SourcePart):
    """Condition, and what must be executed before it is evaluated."""

    value: n.Expression
    preparation: tuple[n.Statement, ...]


@dataclass(frozen=True)
class EdgeInCondition(SourcePart):
    """Edge ``↑operand``, or ``↓operand`` where it is not `rising`; conditions have `name` for it.

    `words` are the names in it, as they were written.
    """

    name: str
    operand: n.Expression
    rising: bool
    words: tuple[str, ...]


@dataclass(frozen=True)
class DelayInCondition(SourcePart):
    """Delay ``first/operand/last``: TRUE `first` after the operand became TRUE, until `last` after it became FALSE.

    Conditions have `name` for it. None: no delay at this end. `words` are the names in it, as they were written.
    """

    name: str
    operand: n.Expression
    first: n.Expression | None
    last: n.Expression | None
    words: tuple[str, ...]


@dataclass(frozen=True)
class StoredAction(SourcePart):
    """Action executed when `steps` (several in a macro-step) become active or no longer are, or on an `event`."""

    kind: ActionKind
    steps: tuple[int, ...]
    event: n.Expression | None
    statements: tuple[n.Statement, ...]


@dataclass(frozen=True)
class GrafcetSource(SourcePart):
    """Contents of a GRAFCET beyond IEC 61131-3: terms of conditions, `stored` and `continuous` actions, forced charts.

    `edges` and `delays` have an order in which each needs only those before it, `ruled` one in which each chart is
    forced or enclosed only by those before it. `step_variables` are the names that mean steps (``X5``), in lower case.
    """

    edges: tuple[EdgeInCondition, ...]
    delays: tuple[DelayInCondition, ...]
    stored: tuple[StoredAction, ...]
    continuous: tuple[ActionSource, ...]
    ruled: tuple[RuledChart, ...]
    step_variables: frozenset[str]


@dataclass(frozen=True)
class ActionUse(SourcePart):
    """One association of an action: `steps` (indexes of the net; several in a macro-step) drive it by `qualifier`.

    `inverted`: they drive it while none of them is active. `condition` is TRUE where there is none, `duration` None.
    `preparation` is executed before the condition is evaluated, once in each scan in which they drive it.
    """

    steps: tuple[int, ...]
    inverted: bool
    qualifier: Qualifier
    condition: n.Expression
    duration: n.Expression | None
    comment: Text | None = None
    preparation: tuple[n.Statement, ...] = ()


@dataclass(frozen=True)
class ActionSource(SourcePart):
    """Action: a Boolean variable (`target`) or code (`statements`), with its associations in the order of the chart.

    `in_place`: its code is that of its only association, and it has no name. `text`: its code as it was written, as
    long as it means the same; empty for code that is drawn. `comment` is that of the action, where it is one of the
    POU.
    """

    name: str
    target: n.Expression | None
    statements: tuple[n.Statement, ...]
    uses: tuple[ActionUse, ...]
    in_place: bool = False
    text: str = ""
    comment: Text | None = None

    def changed(self, change: Change) -> Self:
        """Return the same action with `change` applied to every text but its target."""
        found = super().changed(change)
        return found if found.statements == self.statements else replace(found, text="")


@dataclass(frozen=True)
class StepStatements(SourcePart):
    """Code that a step executes when it becomes active, while it is, and when it no longer is.

    `main_text` is the main one as it was written, as long as it means the same; empty for code that is drawn or called.
    """

    step: int
    entry: tuple[n.Statement, ...] = ()
    main: tuple[n.Statement, ...] = ()
    exit: tuple[n.Statement, ...] = ()
    main_text: str = ""

    def changed(self, change: Change) -> Self:
        """Return the same with `change` applied to every statement."""
        found = super().changed(change)
        return found if found.main == self.main else replace(found, main_text="")


@dataclass(frozen=True)
class HoldingOperand(SourcePart):
    """Operand that keeps a condition from its value: `text` names it, `holds` is TRUE while it does.

    `value` is that of the operand meanwhile.
    """

    text: str
    holds: n.Expression
    value: bool


@dataclass(frozen=True)
class StepTimeLimit(SourcePart):
    """Longest time that a step may be active, and the reasons why it still is."""

    step: int
    time: n.Expression
    reasons: tuple[HoldingOperand, ...] = ()


@dataclass(frozen=True)
class ChartSource(SourcePart):
    """Chart that is lowered, with its texts as syntax trees.

    `conditions` are those of `net.transitions`; `preparations` are executed before each of them is evaluated, `logic`
    is drawn in the chart and executed in every scan, `helpers` are the variables that both need. `minimum_times` are
    those of steps, by index; `watches` their longest times where these are watched. `flags` are the SFC flags in use,
    `undeclared_flags` those that only the tool declares. `waited` are, by transition, the minimum times of its steps
    that have passed; they are known when step variables are. `grafcet`: what only IEC 60848 has. `instances` are the
    types of the instances in drawings by name. `asked_outside`: another body of the POU may ask for its steps,
    `asked_by_contacts`: those for which a contact does.
    """

    pou: Pou
    dialect: Dialect
    net: Net
    conditions: tuple[n.Expression, ...]
    preparations: tuple[tuple[n.Statement, ...], ...]
    logic: tuple[n.Statement, ...]
    helpers: tuple[Helper, ...]
    actions: tuple[ActionSource, ...]
    step_code: tuple[StepStatements, ...]
    minimum_times: dict[int, n.Expression]
    watches: tuple[StepTimeLimit, ...] = ()
    flags: frozenset[SfcFlag] = frozenset()
    undeclared_flags: frozenset[SfcFlag] = frozenset()
    grafcet: GrafcetSource | None = None
    instances: Mapping[str, str] = field(default_factory=dict)
    asked_outside: bool = False
    asked_by_contacts: frozenset[int] = frozenset()

    def refuse(self, message: str, hint: str, path: str = "") -> NoReturn:
        """Raise `LoweringError` at `path` of the chart. `hint`: what a user can do."""
        place = f"{self.pou.name} / {path}" if path else self.pou.name
        raise LoweringError(message, location=Location(path=place), hint=hint)

    @property
    def starts_off(self) -> bool:
        """True if no step is active before the first scan, which starts the chart itself."""
        return False

    @property
    def ends_single_steps(self) -> bool:
        """True if something else than a transition can end one of several active steps."""
        return self.grafcet is not None

    @property
    def evaluates_all(self) -> bool:
        """True if all conditions behind active steps are evaluated, also behind one that lets its transition fire."""
        return False

    @property
    def region_net(self) -> Net:
        """Net in which the end of a sequence or a branch leads back to its own step: regions do not differ."""
        ends = (replace(t, targets=t.targets or t.sources) if len(t.sources) == 1 else t for t in self.net.transitions)
        return replace(self.net, transitions=tuple(ends))

    def names(self) -> set[str]:
        """Return every name that occurs in the POU or in its chart."""
        found = {self.pou.name, *(variable.name for variable in self.pou.variables())}
        found |= {action.name for action in self.pou.actions}
        found |= {step.step.name for step in self.net.steps} | {each.name for each in self.pou.transitions}
        found |= {helper.name for helper in self.helpers}
        steps = self.grafcet.step_variables if self.grafcet is not None else ()  # their flags may be called so
        return found | {name for name in self.names_in_texts() if name.casefold() not in steps}

    def names_in_texts(self) -> set[str]:
        """Return every name that conditions, actions and times have."""
        return {node.identifier for tree in self.trees() for node in walk(tree) if isinstance(node, n.Name)}


_LARGEST_DINT = 2_147_483_647
_MOST_DIGITS = 9
"""Numbers that every DINT holds."""
_SPARE = 100_000
"""Numbers that waits can have behind those of the steps."""


def step_numbers(net: Net) -> list[int]:
    """Return a number for each step: its own, else that in its name (``S3``), else the next one that is free.

    Of steps that have the same number the first one keeps it. An initial step without one, such as ``Init`` before
    ``S1``, has 0.
    """
    wanted = [
        step.step.number if step.step.number is not None else number_in_name(step.step.name) for step in net.steps
    ]
    kept: dict[int, int] = {}
    for step, number in enumerate(wanted):
        if number is not None and 0 <= number < _LARGEST_DINT - _SPARE:
            kept.setdefault(number, step)
    first = next(iter(indexes(net.initial)), None)
    by_name = all(step.step.number is None for step in net.steps)
    if by_name and 1 in kept and first is not None and wanted[first] is None:
        kept.setdefault(0, first)
    numbers = {step: number for number, step in kept.items()}
    free = (number for number in count(1) if number not in kept)
    return [numbers[step] if step in numbers else next(free) for step in range(len(wanted))]


def number_in_name(name: str) -> int | None:
    """Return the number in the name of a step (``S3``), if it has one."""
    digits = step_digits(name)
    return int(digits) if 0 < len(digits) <= _MOST_DIGITS else None
