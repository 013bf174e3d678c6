"""Sequential function charts: their steps, actions, transitions and conditions, and the bodies that hold charts.

This is what a chart *does*; `plcopen_sfc.model.drawing` has how it is drawn.

A chart is a net of steps and transitions. A selection is several transitions that leave a step, a simultaneous
divergence is a transition with several targets, a simultaneous convergence one with several sources, a jump is a
transition to any step. (IEC 61131-3 ed. 3, 6.7; IEC 60848:2013, 4; S7-GRAPH V6.)
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Set
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, TypeAlias

from pydantic import BeforeValidator, Field

from plcopen_sfc.errors import ArgumentError, Location, ModelError, check_argument, nearest, shown
from plcopen_sfc.grouping import Clusters, grouped
from plcopen_sfc.model import times
from plcopen_sfc.model.actions import (
    STEP_ACTIONS,
    ActionEvent,
    ActionKind,
    ForcingOrder,
    Monitoring,
    Qualifier,
    SymbolAccess,
)
from plcopen_sfc.model.base import Element, ElementId, Model
from plcopen_sfc.model.body import BodyBase, FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.chart_settings import NEED_ERROR, GraphSettings, SfcFlag, SfcSettings
from plcopen_sfc.model.conditions import Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.drawing import Drawing
from plcopen_sfc.model.late import LateElement
from plcopen_sfc.model.network import Node
from plcopen_sfc.model.owners import Owned, OwnedName
from plcopen_sfc.model.text import Text
from plcopen_sfc.operations import provided

if TYPE_CHECKING:
    from plcopen_sfc.report import RenameResult


class BodyCondition(Model):
    """A condition programmed in place as a body: LD, FBD, IL, or ST that is more than an expression."""

    kind: Literal["body"] = "body"
    body: Body
    name: str = ""
    negated: bool = False


def _expression(value: Any) -> Any:
    return {"kind": "expression", "text": value} if isinstance(value, str) else value


Condition = Annotated[
    Annotated[Expression | NamedCondition | BodyCondition | WiredCondition, Field(discriminator="kind")],
    BeforeValidator(_expression),
]
"""Any condition. In Python a plain string is an expression: ``transition.condition = "Start AND NOT Fault"``."""


class ActionAssociation(Element):
    """One line of an action block: what is done, when, for how long.

    `target` names a Boolean variable, an action of the POU, or an action of an instance (``Motor.ACT_Stop``); `body`
    is an action programmed in place; TC6 allows both at once. `value` is what is assigned to the target (S7-GRAPH ``A
    := B``, GRAFCET stored actions). `duration` is a time literal or a variable. `indicator` is the variable that
    reports that the step is done. `negated` (TC6 action block): it acts while the step is *not* active.
    `event` and `interlock` are S7-GRAPH's, `kind`, `condition` and `forcing` are GRAFCET's.
    """

    id: ElementId
    qualifier: Qualifier = Qualifier.N
    target: str | None = None
    body: Body | None = None
    value: str | None = None
    duration: str | None = None
    indicator: str | None = None
    negated: bool = False
    event: ActionEvent | None = None
    interlock: bool = False
    kind: ActionKind | None = None
    condition: Condition | None = None
    forcing: ForcingOrder | None = None
    exclude: bool = False
    symbol: SymbolAccess = SymbolAccess.UNSPECIFIED

    TIMES: ClassVar[tuple[str, ...]] = ("duration",)

    @classmethod
    def parse(cls, text: str, id: int) -> Self:
        """Return the association that a text describes, as people write it into an action block.

        ``N Valve``, ``D T#2s Lamp``, ``S Count := Count + 1``; with an event of S7-GRAPH ``S1 R Valve`` (``C R Valve``
        or ``RC Valve``: it needs the interlock), with a timer ``S1 TL T#5s Wait``; ``Valve`` alone is N. Raises
        `ModelError` for a text that is no such line.
        """
        check_argument(text, str, 'an action is a text: "N Valve"')
        words = text.split(maxsplit=1)
        fields: dict[str, Any] = {}
        if len(words) == 2 and words[0].upper() in ActionEvent.__members__:
            event = ActionEvent(words[0].upper())
            fields |= {"interlock": True} if event is ActionEvent.C else {"event": event}
            words = words[1].split(maxsplit=1)
        sign = words[0].upper() if len(words) == 2 else ""
        if sign.endswith("C") and sign[:-1] in Qualifier.__members__:  # as S7-GRAPH V5 writes it: NC, DC
            fields["interlock"], sign = True, sign[:-1]
        if sign in Qualifier.__members__:
            qualifier = fields["qualifier"] = Qualifier(sign)
            words = words[1:]
            duration, _, target = words[0].partition(" ")
            if qualifier.needs_duration or duration.upper().startswith(("T#", "TIME#", "S5T#", "S5TIME#")):
                fields["duration"], words = duration, [target]
        target, assigns, value = " ".join(words).partition(":=")
        wrong = not target.strip() or (assigns and not value.strip()) or len(_ENCLOSED.sub("", target).split()) > 1
        if wrong or ("duration" in fields and times.objection(fields["duration"])):
            raise ModelError(
                f"{text!r} is no action of a step",
                hint='Write qualifier, time and target: "N Valve", "D T#2s Lamp", "S Count := Count + 1".',
            )
        return cls(id=id, target=target.strip(), value=value.strip() or None, **fields)

    @property
    def text(self) -> str:
        """The association as `parse` takes it; of a body in place its language, of a GRAFCET its kind."""
        event = "C" if self.interlock and self.event is None else self.event
        when = self.kind if self.kind is not None else self.qualifier
        target = self.target or (f"({self.body.language})" if self.body is not None else str(self.forcing or ""))
        parts = (event, when if when is not Qualifier.NONE else None, self.duration, target)
        return " ".join(str(part) for part in parts if part) + (f" := {self.value}" if self.value else "")


class Macro(Owned):
    """Content of a macro-step: a body of its own (TC6), or a partial chart by name (IEC 60848, expansion)."""

    body: Body | None = None
    expansion: str | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("body",)


class Enclosure(Model):
    """A partial chart inside an enclosing step (IEC 60848:2013, 7.3), and its steps with an activation link."""

    chart: str
    activated_steps: list[str] = Field(default_factory=list)


class Step(OwnedName, Element):
    """A step.

    `name` is its identifier in programs, `number` its number where the tool has one. Times are literals or
    expressions: `min_time` and `max_time` of CODESYS, `max_time` and `warning_time` of S7-GRAPH. `entry_action`,
    `main_action` and `exit_action` are the CODESYS step actions: the name of an action of the POU or of an instance
    (``Motor.ACT_Stop``), or a body in place. `negated`: the output to its action blocks is inverted (TC6).

    S7-GRAPH declares a static member of the block for each step, of its name (``G7_StepPlus``). Programs read: ``.X``
    active; ``.T`` how long it is active, ``.U`` the same without the time of disturbances; ``.S1`` ``.S0`` TRUE for
    the cycle in which it becomes active, inactive; ``.LA`` ``.VA`` the interlock is not satisfied, there is a
    supervision error; ``.L1`` ``.L0`` ``.V1`` ``.V0`` these come and go; ``.A1`` an error is acknowledged; ``.LS``
    ``.VS`` what the networks evaluate to now; ``.SNO`` its number; ``.T_MAX`` ``.T_WARN`` its times. For a transition
    (``G7_TransitionPlus``): ``.TV`` its steps are active, ``.TT`` its condition is satisfied, ``.TS`` it switches.
    From other blocks: ``"Instance_DB".Step1.X``. (S7-GRAPH V6)
    """

    id: ElementId
    name: str
    number: int | None = None
    title: Text | None = None
    initial: bool = False
    actions: list[ActionAssociation] = Field(default_factory=list)
    entry_action: str | Body | None = None
    main_action: str | Body | None = None
    exit_action: str | Body | None = None
    min_time: str | None = None
    max_time: str | None = None
    warning_time: str | None = None
    interlock: SupervisedOrText | None = None
    supervision: SupervisedOrText | None = None
    macro: Macro | None = None
    encloses: list[Enclosure] | None = None
    negated: bool = False
    exclude: bool = False
    symbol: SymbolAccess = SymbolAccess.UNSPECIFIED
    duplicate: bool = False

    OWNS: ClassVar[tuple[str, ...]] = ("macro", "actions")
    TIMES: ClassVar[tuple[str, ...]] = ("min_time", "max_time", "warning_time")

    @property
    def step_actions(self) -> dict[str, str | Body]:
        """The step actions that there are: by ``entry``, ``main`` and ``exit``, in this order."""
        found = {kind: getattr(self, f"{kind}_action") for kind in STEP_ACTIONS}
        return {kind: action for kind, action in found.items() if action is not None}

    @property
    def conditions(self) -> dict[str, Condition]:
        """The conditions that guard the step: by ``interlock`` and ``supervision``, as far as it has them."""
        found = {"interlock": self.interlock, "supervision": self.supervision}
        return {kind: check.condition for kind, check in found.items() if check is not None and check.condition}

    def action_labels(self) -> list[str]:
        """Return a label for each action: its target, what it forces, or ``inline``; numbered where several have it."""
        found: dict[str, int] = {}
        labels = []
        for action in self.actions:
            label = action.target or str(action.forcing or "inline")
            found[label] = found.get(label, 0) + 1
            labels.append(label if found[label] == 1 else f"{label} ({found[label]})")
        return labels

    @property
    def chart(self) -> SfcNetwork | None:
        """The chart that the step is in."""
        return self.owner if isinstance(self.owner, SfcNetwork) else None

    @property
    def predecessors(self) -> list[Step]:
        """The steps from which a transition leads to this one, in the order of the chart."""
        chart = self.chart
        return chart._those({i for t in chart.incoming(self) for i in t.sources}) if chart is not None else []

    @property
    def successors(self) -> list[Step]:
        """The steps to which a transition leads from this one, in the order of the chart."""
        chart = self.chart
        return chart._those({i for t in chart.outgoing(self) for i in t.targets}) if chart is not None else []


class Supervised(Model):
    """The interlock or the supervision of an S7-GRAPH step: a condition, its title and the text of its alarm.

    An interlock (C) is what the actions marked with it need: they are executed only while it is TRUE. It does not hold
    up the chart; while it is FALSE the step has an interlock error (events L1 when that comes, L0 when it goes). A
    supervision (V) is a fault: while it is TRUE the step has a supervision error (events V1 and V0), and the chart
    stays in the step until it is gone, and acknowledged where `GraphSettings.acknowledge_errors_required` is set.
    No condition: there is none, the interlock is always satisfied, the supervision never disturbed. (S7-GRAPH V6)
    """

    condition: Condition | None = None
    title: Text | None = None
    alarm: Text | None = None


def _supervised(value: Any) -> Any:
    return {"condition": value} if isinstance(value, str) else value


SupervisedOrText = Annotated[Supervised, BeforeValidator(_supervised)]
"""An interlock or a supervision. In Python a plain string is its condition: ``step.interlock = "NOT Fault"``."""


class Transition(Element):
    """A transition from all of `sources` to all of `targets` (ids of steps).

    Competing transitions, which share a source, are tried in the order of `priority` (1 before 2), those without one
    after them in the order of `SfcNetwork.transitions` (left to right). No condition: the file has
    none.
    """

    id: ElementId
    name: str = ""
    number: int | None = None
    title: Text | None = None
    sources: list[ElementId] = Field(default_factory=list)
    targets: list[ElementId] = Field(default_factory=list)
    condition: Condition | None = None
    priority: int | None = None
    exclude: bool = False
    symbol: SymbolAccess = SymbolAccess.UNSPECIFIED
    duplicate: bool = False
    monitoring: Monitoring = Monitoring.NONE

    @property
    def shown_condition(self) -> str:
        """The condition as an editor shows it beside the transition: an expression, or the name of what it names."""
        if isinstance(self.condition, Expression):
            return self.condition.text
        return self.condition.name if isinstance(self.condition, NamedCondition | BodyCondition) else ""


class PermanentOperation(Element):
    """A network or call that S7-GRAPH executes in every cycle, before or after the sequences.

    It does so always: in every operating mode, and while the sequences are off (``OFF_SQ``).
    """

    title: Text | None = None
    body: Body | None = None


class Sequence(Element):
    """A sequence of an S7-GRAPH block (up to 8): the steps that belong to it.

    It ends where a transition leads to no step; only INIT_SQ starts it again then. A transition may jump to a step of
    another sequence of the block.
    """

    title: Text | None = None
    steps: list[ElementId] = Field(default_factory=list)


class PartialChartKind(StrEnum):
    """The role of a partial chart (IEC 60848:2013, 7)."""

    GLOBAL = "global"
    EXPANSION = "expansion"
    ENCLOSED = "enclosed"


class PartialChart(Owned, Element):
    """A partial chart of a GRAFCET. An expansion names its entry and exit step."""

    name: str
    kind: PartialChartKind = PartialChartKind.GLOBAL
    chart: SfcNetwork
    entry_step: str | None = None
    exit_step: str | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("chart",)


StepKey: TypeAlias = Step | str | int
"""A step, its name or its id."""

_STEP_BY_NAME = 'The chart has it by its name: chart.step("Fill").'


def simple_steps(steps: Collection[Step]) -> list[Step]:
    """Return the simple ones among the steps of a chart of CoDeSys 2.3: their flag is a BOOL of their name.

    An IEC step has associations, and no action of its own. One that has neither is an IEC step where others are.
    """
    has_associations = any(step.actions for step in steps)
    return [step for step in steps if not step.actions and (step.main_action is not None or not has_associations)]


class SfcNetwork(LateElement):
    """A chart.

    `logic` are FBD and LD elements drawn in the chart, which conditions are wired to. `drawing` is how the file draws
    the chart; None where it has no drawing.
    """

    steps: list[Step] = Field(default_factory=list)
    transitions: list[Transition] = Field(default_factory=list)
    logic: list[Node] = Field(default_factory=list)
    settings: SfcSettings | None = None
    graph_settings: GraphSettings | None = None
    sequences: list[Sequence] = Field(default_factory=list)
    permanent_pre: list[PermanentOperation] = Field(default_factory=list)
    permanent_post: list[PermanentOperation] = Field(default_factory=list)
    partial_charts: list[PartialChart] = Field(default_factory=list)
    drawing: Drawing | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("steps", "transitions", "partial_charts")

    def step(self, key: str | int) -> Step:
        """Return the step with this name (case does not matter, as in IEC 61131-3) or id. Raises `ModelError`."""
        check_argument(key, (str, int), "the name or the id of a step is needed")
        for step in self.steps:
            if step.id == key or (isinstance(key, str) and step.name.casefold() == key.casefold()):
                return step
        raise _not_found("step", key, [step.name for step in self.steps])

    def transition(self, key: str | int) -> Transition:
        """Return the transition with this name, label (``Wait -> Fill``) or id; case does not matter.

        Raises `ModelError`.
        """
        check_argument(key, (str, int), "the name, the label or the id of a transition is needed")
        folded = key.casefold() if isinstance(key, str) else None
        for transition in self.transitions:
            if transition.id == key or (key != "" and transition.name.casefold() == folded):
                return transition
        labels = self.labels()
        for transition in self.transitions if folded is not None else ():
            if labels[transition.id].casefold() == folded:
                return transition
        raise _not_found("transition", key, list(labels.values()))

    @property
    def initial_steps(self) -> list[Step]:
        """The steps that are active at the start. IEC 61131-3 wants exactly one in each network."""
        return [step for step in self.steps if step.initial]

    def outgoing(self, step: Step) -> list[Transition]:
        """Return the transitions that leave `step`, in the order in which they are tried."""
        check_argument(step, Step, "a step is needed", _STEP_BY_NAME)
        return by_priority(t for t in self.transitions if step.id in t.sources)

    def incoming(self, step: Step) -> list[Transition]:
        """Return the transitions that lead to `step`."""
        check_argument(step, Step, "a step is needed", _STEP_BY_NAME)
        return [t for t in self.transitions if step.id in t.targets]

    def jumps_between_sequences(self) -> list[Transition]:
        """Return the transitions that lead from steps of one of `sequences` to a step of another one."""
        member = {step: index for index, sequence in enumerate(self.sequences) for step in sequence.steps}
        if len(self.sequences) == 1:
            return []

        def is_jump(transition: Transition) -> bool:
            origins = {member.get(step) for step in transition.sources}
            aims = [member.get(step) for step in transition.targets]
            return len(origins) == len(aims) == 1 and None not in {*origins, *aims} and origins != {*aims}

        return [transition for transition in self.transitions if is_jump(transition)]

    def find(
        self,
        where: Callable[[Step], bool] | None = None,
        *,
        drives: str | None = None,
        reads: str | None = None,
        calls: str | None = None,
        qualifier: str | Iterable[str] | None = None,
        reachable_from: StepKey | None = None,
        leading_to: StepKey | None = None,
        **fields: Any,
    ) -> list[Step]:
        """Return the steps of the chart that satisfy all conditions: ``chart.find(drives="*Valve*", max_time=None)``.

        `drives`, `reads`, `calls`: patterns (``*`` and ``?``) for what the actions of the step write, read and call,
        also through actions of the POU: a whole path (``GVL.Valve1``) or the end of one (``Valve1``); case does not
        matter. `qualifier`: one of its actions has it. `reachable_from`, `leading_to`: transitions lead there from or
        to a step, its name or path (``Main.Fill``). `where` is a function for all else. `fields` are those of a step:
        patterns for texts (``name="S*"``), or the value itself (``initial=True``, ``max_time=None``). Raises
        `ModelError` for a field that steps do not have.
        """
        found: list[Step] = provided("find_steps")(
            self,
            where,
            drives=drives,
            reads=reads,
            calls=calls,
            qualifier=qualifier,
            reachable_from=reachable_from,
            leading_to=leading_to,
            **fields,
        )
        return found

    def find_transitions(
        self, where: Callable[[Transition], bool] | None = None, **conditions: Any
    ) -> list[Transition]:
        """Return the transitions that satisfy all conditions: ``find_transitions(reads="*Guard*", leaving="Fill")``.

        `reads`, `calls`: patterns for what the condition reads and calls, also that of a named transition, as for
        `find`. `condition`: a pattern for its text. `leaving`, `entering`: patterns for the name or path of a step
        before or behind it. `where` is a function for all else. Others are fields of a transition: ``priority=1``.
        Raises `ModelError` for a field that transitions do not have.
        """
        found: list[Transition] = provided("find_transitions")(self, where, **conditions)
        return found

    def to_records(self) -> list[dict[str, Any]]:
        """Return the chart as a table: a dictionary with the same keys for each step; ``pandas.DataFrame`` takes it.

        `actions` are as `add_step` takes them, `next` are conditions and where they lead.
        """
        records: list[dict[str, Any]] = provided("chart_records")(self)
        return records

    def _those(self, ids: Set[int]) -> list[Step]:
        return [step for step in self.steps if step.id in ids]

    @property
    def permanent(self) -> list[PermanentOperation]:
        """Its permanent operations: those before the sequences, then those after them."""
        return [*self.permanent_pre, *self.permanent_post]

    def conditions(self) -> Iterator[Condition]:
        """Yield the conditions of its transitions, of its action associations, and those that guard its steps."""
        parts: list[Transition | ActionAssociation] = [*self.transitions, *(row for _, row in self.associations())]
        yield from (part.condition for part in parts if part.condition is not None)
        yield from (condition for step in self.steps for condition in step.conditions.values())

    def associations(self) -> Iterator[tuple[Step, ActionAssociation]]:
        """Yield every action association with its step."""
        for step in self.steps:
            for association in step.actions:
                yield step, association

    def flags_in_use(self, declared: Callable[[str], bool]) -> frozenset[SfcFlag]:
        """Return the flags that the chart obeys or sets in CODESYS.

        A flag is used where the settings of the chart state it. Where they do not mention it, or leave it to the
        settings of the project, it is used if `declared` is True: the POU or its project declares the variable.
        """
        settings = self.settings

        def is_used(flag: SfcFlag) -> bool:
            stated = settings.flags.get(flag) if settings is not None else None
            if stated is not None and (stated.use or not (settings is not None and settings.use_defaults)):
                return stated.use
            return declared(flag.variable)

        used = frozenset(flag for flag in SfcFlag if is_used(flag))
        return used if SfcFlag.ERROR in used else used - NEED_ERROR

    def label(self, transition: Transition) -> str:
        """Return the name of a transition, or from where to where it leads, numbered where several do."""
        check_argument(transition, Transition, "`label` needs a transition")
        names = {step.id: step.name for step in self.steps}
        number = 1
        for each in self.transitions:
            if each is transition:
                return _label(transition, names, number)
            number += not each.name and _ends(each) == _ends(transition)
        return _label(transition, names, 1)  # of another chart, or removed

    def labels(self, names: Mapping[int, str] | None = None) -> dict[int, str]:
        """Return the labels of all transitions by their ids: for who needs many of them.

        `names` are the steps by their ids, where they are to be called otherwise.
        """
        names = {step.id: step.name for step in self.steps} if names is None else names
        numbers = Counter[_Ends]()
        found = {}
        for transition in self.transitions:
            if transition.name:
                found[transition.id] = transition.name
            else:
                ends = _ends(transition)
                numbers[ends] += 1
                found[transition.id] = _label(transition, names, numbers[ends])
        return found

    def new_id(self) -> int:
        """Return an id that nothing in this chart or its drawing has."""
        used = [s.id for s in self.steps] + [t.id for t in self.transitions] + [n.id for n in self.logic]
        used += [a.id for _, a in self.associations()]
        if self.drawing is not None:
            used += [s.id for s in self.drawing.symbols]
            used += [i for s in self.drawing.symbols for e in s.entries or () for i in (e.local_id or 0, e.association)]
        return max(used, default=-1) + 1

    def add_step(
        self,
        name: str,
        *,
        initial: bool = False,
        actions: Iterable[str | tuple[str, str]] = (),
        declare: bool = True,
        **fields: Any,
    ) -> Step:
        """Append a step: ``chart.add_step("Fill", actions=["N Valve", "D T#2s Lamp"], max_time="T#30s")``.

        `actions` are texts as `ActionAssociation.parse` takes them; a pair of one with statements makes an action of
        the POU too: ``("N Pour", "Pump := Level < 9;")``. With `declare`, variables that they name and nothing declares
        are declared in the POU: BOOL outputs, and TIME inputs for durations. `fields` are those of `Step`. Raises
        `ModelError` where the name is taken, or a field or an action is wrong; then nothing is changed.
        """
        self._claim(name)
        if isinstance(actions, str):
            raise ArgumentError("`actions` is a list of texts", hint=f"Write it as [{actions!r}].")
        check_argument(actions, Iterable, "`actions` is a list of texts")
        lines = [line if isinstance(line, tuple) else (line, None) for line in actions]
        first = self.new_id()
        step = Step(id=first, name=name, initial=initial)
        step.actions = [ActionAssociation.parse(text, number) for number, (text, _) in enumerate(lines, first + 1)]
        for field, value in fields.items():
            setattr(step, field, value)
        self.steps.append(step)
        if lines and declare:
            provided("declare_named")(self, [step], [], dict(step_codes(step, lines)))
        return step

    def add_sequence(self, *parts: Any, after: StepKey | None = None, declare: bool = True) -> None:
        """Append steps and transitions in the order in which a person reads a chart: steps and conditions in turn.

        A condition is a text, or `transition` with a name or priority; `step`, `selection`, `simultaneous` and `jump`
        make the other parts. See `plcopen_sfc.refactor.builder`. `after` is the step of the chart that the first
        condition follows; without it the first part is a step. With `declare`, variables that nothing declares are
        declared in the POU: what actions name as `add_step` does, what conditions join by AND, OR and NOT as BOOL
        inputs. Raises `ModelError` where a part is out of place; then nothing is changed.
        """
        provided("add_sequence")(self, parts, after, declare=declare)

    def add_transition(
        self,
        sources: StepKey | Iterable[StepKey],
        targets: StepKey | Iterable[StepKey],
        condition: Condition | str | None = None,
        *,
        priority: int | None = None,
    ) -> Transition:
        """Append a transition from all `sources` to all `targets`: steps of this chart, or their names.

        Raises `ModelError` where the chart has no such step.
        """
        fields: dict[str, Any] = {"condition": condition, "priority": priority}
        transition = Transition(
            id=self.new_id(), sources=self._ids_of(sources), targets=self._ids_of(targets), **fields
        )
        self.transitions.append(transition)
        return transition

    def _ids_of(self, steps: StepKey | Iterable[StepKey]) -> list[int]:
        ids = []
        need = "a transition leads from steps to steps, or their names"
        check_argument(steps, (Step, str, int, Iterable), need)
        if isinstance(steps, bytes | bytearray):  # whose bytes are no ids of steps
            raise ArgumentError(f"{need}, not bytes")
        for step in [steps] if isinstance(steps, Step | str | int) else steps:
            if not isinstance(step, Step):
                ids.append(self.step(step).id)
            elif any(each is step for each in self.steps):
                ids.append(step.id)
            else:
                raise ModelError(f"the step {step.name!r} is not in this chart", hint="Append it to `steps` first.")
        return ids

    def rename_step(self, old: str, new: str) -> RenameResult:
        """Give a step another name. Every reference follows, in every body of the project that the chart is in.

        A chart that is in no project is renamed in itself. Raises `ModelError` where there is no such step, or the new
        name is no name or would mean something else somewhere. The result lists what was changed, and places of which
        no analysis finds the meaning: these stay as they are. See `plcopen_sfc.refactor.rename`.
        """
        result: RenameResult = provided("rename_step")(self, old, new)
        return result

    def to_svg(self, *, style: str | None = None, theme: str = "light", fresh: bool = False) -> str:
        """Draw the chart: the text of an SVG file.

        `style` draws it as in ``iec`` (IEC 61131-3), ``grafcet`` (IEC 60848) or ``s7graph`` (TIA Portal); the default
        is that of the standard or tool that the chart is of. `theme` is ``light``, ``dark`` or ``print`` (black on
        white). A chart that its file has drawn keeps the places that it has there; `fresh`: it gets a new layout, as
        charts without places do. The same chart gives the same text in every run. Raises `ModelError` for any other
        style or theme.
        """
        picture: str = provided("chart_svg")(self, style, theme, fresh=fresh)
        return picture

    def _repr_svg_(self) -> str:
        """Show the chart in Jupyter."""
        return self.to_svg()

    def _claim(self, name: str) -> None:
        check_argument(name, str, "the name of a step is a text")
        if any(step.name.casefold() == name.casefold() for step in self.steps):
            raise ModelError(f"this chart has a step {name!r} already", location=Location(path=f"step {name}"))


class SfcBody(BodyBase):
    """Sequential function chart (AS). A reader may leave the chart unread until a script first looks at it."""

    language: Literal["SFC"] = "SFC"
    chart: SfcNetwork = Field(default_factory=SfcNetwork)

    OWNS: ClassVar[tuple[str, ...]] = ("chart",)


Body = Annotated[StBody | IlBody | FbdBody | LdBody | SfcBody | OpaqueBody, Field(discriminator="language")]
"""A body in any language."""

# A body holds charts, a chart holds bodies: so these types are in one module, and are completed when all of them exist.
# Those with all others in them come first: each takes what is complete, and the other way round takes a fifth longer.
for _model in (SfcNetwork, SfcBody, BodyCondition, ActionAssociation, Macro, Step, PermanentOperation, PartialChart):
    _model.model_rebuild()


def by_priority(transitions: Iterable[Transition]) -> list[Transition]:
    """Return transitions in the order in which they are tried: by their priorities, those without one last."""
    return sorted(transitions, key=lambda each: (each.priority is None, each.priority or 0))


def leaving_steps(transitions: Iterable[Transition]) -> dict[int, list[Transition]]:
    """Return the transitions that leave each step, by its id, in the order in which they are tried."""
    return grouped((source, each) for each in by_priority(transitions) for source in dict.fromkeys(each.sources))


def placed_conditions(chart: SfcNetwork) -> Iterator[tuple[str, Condition]]:
    """Yield the conditions of transitions, interlocks and supervisions, each with its place in reports."""
    labels = chart.labels()
    for transition in chart.transitions:
        if transition.condition is not None:
            yield f"transition {labels[transition.id]}", transition.condition
    for step in chart.steps:
        yield from ((f"step {step.name} / {kind}", condition) for kind, condition in step.conditions.items())


def connected_parts(steps: Collection[Step], transitions: Iterable[Transition]) -> list[list[Step]]:
    """Return the steps of each part that no transition connects with another, in their order."""
    parts = Clusters(step.id for step in steps)
    for transition in transitions:
        parts.unite(i for i in (*transition.sources, *transition.targets) if i in parts)  # a damaged chart lacks some
    return list(grouped((parts.root(step.id), step) for step in steps).values())


def step_codes(step: Step, lines: Iterable[str | tuple[str, str | None]]) -> Iterator[tuple[str, str]]:
    """Yield statements of the actions of a step by the names of these, from the `lines` that `add_step` got for it."""
    for association, line in zip(step.actions, lines, strict=True):
        if isinstance(line, tuple) and line[1] is not None and association.target:
            yield association.target, line[1]


_Ends: TypeAlias = tuple[tuple[ElementId, ...], tuple[ElementId, ...]]


def _ends(transition: Transition) -> _Ends:
    return tuple(transition.sources), tuple(transition.targets)


def _label(transition: Transition, names: Mapping[int, str], number: int) -> str:
    """Return the label of a transition, of those without a name between the same steps the one with this number."""
    if transition.name:
        return transition.name
    text = f"{_together(transition.sources, names)} -> {_together(transition.targets, names)}"
    return text if number == 1 else f"{text} ({number})"


def _together(steps: list[ElementId], names: Mapping[int, str]) -> str:
    """Return the names of the steps on one side of a transition."""
    if len(steps) == 1:
        return names.get(steps[0], "?") or "nowhere"
    return "+".join([names.get(i, "?") for i in steps]) or "nowhere"


def _not_found(kind: str, key: str | int, names: list[str]) -> ModelError:
    listed = ", ".join(names[:_LISTED]) + (" .." if len(names) > _LISTED else "")
    return ModelError(
        f"this chart has no {kind} {shown(key)}{nearest(key, names)}",
        hint=f"Its {kind}s are: {listed}" if names else "It has none.",
    )


_LISTED = 12


_ENCLOSED = re.compile(r'"[^"]*"|\[[^\]]*\]')
"""Parts of a target that may have blanks in them: quoted names and indices."""
