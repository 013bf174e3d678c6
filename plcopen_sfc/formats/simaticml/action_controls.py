"""Action controls in permanent instructions: qualifiers and conditions that no row of S7-GRAPH expresses.

An action of IEC 61131-3 has one control for all its associations (ACTION_CONTROL, ed. 3, 6.7.4.6). Rows of S7-GRAPH act
for their step alone, with N, S, R, L and D for an operand. Where that is not enough, none of the associations becomes
a row: networks behind the sequence compute the control from the flags of the steps, as one would draw it by hand. A
stored action is a bit that holds itself, a delay a timer of the block, and what is executed is the coil of a variable
or the call of a function.

``K2`` with SD in Wait and R in Done::

    #K2_stored := (#K2_stored OR #Wait.X) AND NOT #Done.X;
    #K2_delay(IN := #K2_stored, PT := T#5s);
    #K2 := #K2_delay.Q AND NOT #Done.X;

In matiec associations act one after the other; `control_statements` has the statements of both.

The variables and the networks are added elements: a reader drops them, and comments keep the associations.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator

from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.simaticml.action_functions import ActionControls, ActionFunctions, ControlNetwork
from plcopen_sfc.formats.simaticml.added_elements import system_members
from plcopen_sfc.formats.simaticml.box_types import give_condition_types
from plcopen_sfc.formats.simaticml.coils_and_contacts import lacks_power, put_assignments, put_in_series, types_of
from plcopen_sfc.formats.simaticml.control_statements import (
    NO_FLAGS,
    PLAIN,
    RESETS,
    ControlDraft,
    FlagTexts,
    ImpossibleError,
    and_,
    flag_of,
    not_,
    or_,
)
from plcopen_sfc.formats.simaticml.declaration_spelling import write_type
from plcopen_sfc.formats.simaticml.graph_reader import CONTROLLED, control_label
from plcopen_sfc.formats.simaticml.network_boxes import mark_call
from plcopen_sfc.formats.simaticml.network_operands import parse_operand
from plcopen_sfc.formats.simaticml.row_tokens import AS_EVENTS, GRAPH_QUALIFIERS
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding import STORING, Effects, Row, SharedScans, bind, told_orders
from plcopen_sfc.languages.effects import ANYTHING, Path, may_change, path_of
from plcopen_sfc.languages.networks import condition_reader, draw_ld, draw_ld_expression
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules, declared_rules
from plcopen_sfc.languages.st import parse_expression, parse_statements
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model import network as net
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.body import LdBody, StBody
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcBody, SfcNetwork, Step
from plcopen_sfc.model.text import without_signs
from plcopen_sfc.model.types import DerivedType, Variable
from plcopen_sfc.model.variables import SectionKind, sections_of

Q = Qualifier
_IEC = frozenset({*RESETS, *PLAIN, Q.S, Q.L, Q.D, Q.P, Q.P1, Q.P0, Q.SD, Q.DS, Q.SL})
_OF_ROWS = GRAPH_QUALIFIERS | AS_EVENTS.keys() | {Q.R0}
_AT_ONCE = frozenset({Q.P1, Q.P0})
_KINDS = frozenset({None, ActionKind.CONTINUOUS})


def are_rows_alone(options: WriteOptions) -> Callable[[str], bool]:
    """Return which actions have no control of their own in the source, by the names that people see.

    In a file of TIA Portal those have one that this package has added.
    """
    if not options.same:
        return lambda _: options.of_graph
    found = _controlled(options)
    return lambda label: label not in found


def are_shared(options: WriteOptions) -> Callable[[str], bool]:
    """Return which actions write their variable only while they are executed, as in CODESYS, by the same names."""
    if not options.same:
        return lambda _: options.of_codesys
    found = _controlled(options)
    return lambda label: label in found


def _controlled(options: WriteOptions) -> set[str]:
    return {json.loads(text) for text in _CONTROLS.findall(options.source.decode("utf-8", "replace"))}


def told_late_actions(pou: Pou, chart: SfcNetwork, controls: ActionControls, options: WriteOptions) -> str:
    """Return which actions are executed after others that they precede in the source; empty if none."""
    if options.of_graph:
        return ""
    rows = [
        (step, row) for step in chart.steps for row in (step.actions if not step.exclude else ()) if not row.exclude
    ]
    ends: dict[str, list[Step]] = {}
    used: dict[str, int] = {}
    for step, row in rows:
        used.setdefault(_name(row), len(used))
        if row.qualifier in RESETS:
            ends.setdefault(_name(row), []).append(step)
    acting = [each for each in rows if each[1].qualifier not in RESETS]
    networks = {id(row) for step, row in acting if (step.id, row.id) in controls.controlled}
    places = {
        id(row): (id(row) in networks, used[_name(row)] if id(row) in networks else at)
        for at, (_, row) in enumerate(acting)
    }
    scans = SharedScans(chart, pou, Dialect.SCL)

    def is_late(one: Row, other: Row) -> bool:
        names = [_name(row) for _, row in (one, other)]
        if id(one[1]) not in networks:  # rows are executed in their order, and in CODESYS by their names
            is_plain = options.of_codesys and id(other[1]) not in networks and scans.are_together(one[0], other[0])
            return is_plain and places[id(one[1])] > places[id(other[1])] and names[0] < names[1]
        if places[id(one[1])] < places[id(other[1])]:
            return False
        if (names[0] < names[1]) if options.of_codesys else (used[names[0]] < used[names[1]]):
            return True
        if not options.final_scan or one[1].qualifier in _AT_ONCE:
            return False
        if other[1].qualifier in STORING:
            return True
        if one[1].qualifier in STORING:  # its final scan comes first in the source
            return any(scans.are_together(step, other[0]) for step in ends.get(names[0], ()))
        return scans.follow(one[0], other[0])

    return told_orders(scans, acting, is_late, "after") if networks or options.of_codesys else ""


_NO_MARKS = str.maketrans("", "", '#"')


def _name(row: ActionAssociation) -> str:
    return (row.target or f" {id(row)}").translate(_NO_MARKS).casefold()


def watching_flags(pou: Pou, chart: SfcNetwork) -> frozenset[SfcFlag]:
    """Return the flags of CODESYS that a network sets and reads in place of what its tool does with maximum times.

    They are variables of the block, and SFCError is none of its inputs.
    """
    declared = {v.name.casefold(): s.kind for s in sections_of(pou.interface) for v in s.variables}
    used = chart.flags_in_use(lambda name: name.casefold() in declared)
    kind = declared.get(SfcFlag.ERROR.variable.casefold())
    is_written = kind in (SectionKind.OUTPUT, SectionKind.LOCAL, SectionKind.IN_OUT)
    is_enabled = SfcFlag.ENABLE_LIMIT not in used or SfcFlag.ENABLE_LIMIT.variable.casefold() in declared
    if SfcFlag.ERROR not in used or not is_written or not is_enabled:
        return frozenset()
    return used & {SfcFlag.ERROR, SfcFlag.ENABLE_LIMIT}


FLAG_LABEL = "SFC flags"
"""The label of the networks that serve SFC flags."""
_CONTROLS = re.compile(rf'{{"{CONTROLLED}": ("(?:[^"\\]|\\.)*")}}')


class ControlPlanner:
    """Plans the action controls that the chart of a block needs.

    `alone`: True if each association of an action acts for its step alone already, as rows do. `shared`: True if an
    action writes its variable only while it is executed, so that other code may do so at other times. `flags`: those
    of the chart. `in_turn`: associations act one after the other, as in matiec.
    """

    def __init__(
        self,
        project: Project,
        pou: Pou,
        chart: SfcNetwork,
        functions: ActionFunctions,
        *,
        alone: Callable[[str], bool] = lambda _: False,
        shared: Callable[[str], bool] = lambda _: False,
        flags: FlagTexts = NO_FLAGS,
        in_turn: bool = False,
    ) -> None:
        self._flags, self._in_turn = flags, in_turn
        self._pou, self._chart, self._functions, self._alone, self._shared = pou, chart, functions, alone, shared
        self._written = self._writes()
        self._read = condition_reader(chart, Dialect.SCL, transitions=pou.transitions)
        variables = {variable.name.casefold() for variable in pou.variables()}
        self._taken = variables | system_members(variables)
        self._types = types_of(project, pou)
        self._taken |= {step.name.casefold() for step in chart.steps}
        self._taken |= {transition.name.casefold() for transition in chart.transitions}

    def plan(self) -> ActionControls:
        """Return the controls of all actions that need one."""
        found = ActionControls()
        for line in self._flags.lines:
            error = SfcFlag.ERROR.variable
            found.networks += self._drawn(self._draft(error if f"#{error} := " in line else FLAG_LABEL, line))
        for rows in self._actions():
            taken = set(self._taken)
            try:
                draft, networks = self._control(rows)
            except ImpossibleError:
                self._taken = taken
                if self._asks_flags(rows):
                    found.going_on.append(control_label(rows[0][0].name, rows[0][1].target))
                continue
            found.variables += draft.variables
            found.networks += networks
            for step, row in rows:
                reason = f"no row means {_shown(step, row)}"
                if self._is_shared(rows):
                    reason = "actions of other steps write it, too"
                elif self._asks_flags(rows):
                    reason = "rows go on where an SFC flag stops the chart, or ends a step"
                why = f"networks behind the sequence control {draft.label}: {reason}"
                found.controlled[step.id, row.id] = why
        found.networks += self._watch()
        return found

    def _watch(self) -> list[ControlNetwork]:
        """Return the network that sets SFCError when a step is active longer than its maximum time (CODESYS)."""
        error, enable = SfcFlag.ERROR.variable, SfcFlag.ENABLE_LIMIT.variable
        used = watching_flags(self._pou, self._chart)
        late = [
            and_([flag_of(step), f"{flag_of(step).removesuffix('.X')}.T > {step.max_time}"])
            for step in self._chart.steps
            if step.max_time is not None
        ]
        if not late or SfcFlag.ERROR not in used:
            return []
        too_long = and_([f"#{enable}" if SfcFlag.ENABLE_LIMIT in used else "", or_(late)])
        draft = self._draft(error, f"#{error} := {or_([f'#{error}', too_long])};")
        try:
            return self._drawn(draft)
        except ImpossibleError:
            return []

    def _actions(self) -> Iterator[list[tuple[Step, ActionAssociation]]]:
        """Yield the associations of each action that needs a control."""
        steps = [step for step in self._chart.steps if not step.exclude]
        executed = [(step, row) for step in steps for row in step.actions if not row.exclude]
        found = grouped(((row.target or f" {step.id} {row.id}").casefold(), (step, row)) for step, row in executed)
        for rows in found.values():
            if all(map(_is_of_iec, (row for _, row in rows))) and self._needs_control(rows):
                yield rows

    def _needs_control(self, rows: list[tuple[Step, ActionAssociation]]) -> bool:
        """True if rows of S7-GRAPH do not act as the associations together do."""
        used = {row.qualifier for _, row in rows}
        if used - _OF_ROWS or any(row.negated or step.negated or row.condition is not None for step, row in rows):
            return True
        if self._asks_flags(rows):
            return True
        if self._code(rows[0][1]) is not None:
            is_doubled = len({step.id for step, _ in rows}) < len(rows)  # a row of its own would execute it once more
            return is_doubled or bool(used - {*PLAIN, *_AT_ONCE}) or (len(rows) > 1 and used <= _AT_ONCE)
        label = control_label(rows[0][0].name, rows[0][1].target)
        if self._is_shared(rows):
            return True
        if len(rows) == 1 or self._alone(label):
            return False
        is_stored = bool(used & {Q.S, *RESETS})
        return any(row.qualifier.needs_duration for _, row in rows) or (is_stored and bool(used & {*PLAIN, Q.P}))

    def _asks_flags(self, rows: list[tuple[Step, ActionAssociation]]) -> bool:
        """True if rows would not do what the associations do where an SFC flag stops the chart, or ends a step.

        Statements ask the flags themselves.
        """
        used, code = {row.qualifier for _, row in rows}, self._code(rows[0][1])
        if isinstance(code, StBody):
            return False
        goes_on = not used <= ({*PLAIN, *RESETS, Q.S} if code is None else _AT_ONCE)
        ends_late = Q.P0 in used if code is None else used != {Q.P1}
        return (bool(self._flags.stops) and goes_on) or (bool(self._flags.ends) and ends_late)

    def _code(self, row: ActionAssociation) -> Body | None:
        if row.target is None:
            return row.body
        found = self._pou.find_action(without_signs(row.target))
        if found is not None:
            return found.body
        call = f"{row.target}();"  # the action of an instance, whose statements take the place of the call
        is_call = "." in row.target and bool(self._functions.calls.inlined(call, self._pou).called)
        return StBody(text=call) if is_call else None

    def _draft(self, label: str, *lines: str, operand: str = "") -> ControlDraft:
        return ControlDraft(label, operand, self._read, self._taken, self._flags, lines=[*lines])

    def _control(self, rows: list[tuple[Step, ActionAssociation]]) -> tuple[ControlDraft, list[ControlNetwork]]:
        step, row = rows[0]
        label = control_label(step.name, row.target)
        code = self._code(row)
        draft = self._draft(label, operand=row.target or "" if code is None else "")
        if code is None and (row.target is None or parse_operand(row.target) is None):
            raise ImpossibleError
        if self._in_turn:
            executed, after = draft.in_turn(rows), list[str]()
        else:
            executed, after = self._acting(draft, rows)
        if code is None:
            return draft, self._drawn(draft)
        block, instance = self._executed(row, label, code)
        networks = self._drawn(draft)
        networks.append(ControlNetwork(label, self._call(draft, executed, block, instance)))
        draft.lines = after
        return draft, [*networks, *self._drawn(draft)]

    def _acting(self, draft: ControlDraft, rows: list[tuple[Step, ActionAssociation]]) -> tuple[str, list[str]]:
        """Append the statements of IEC 61131-3 for an action.

        Return when its code is executed, and the statements behind it.
        """
        lasting, pulses = draft.together(rows)
        if draft.operand and not self._is_written_elsewhere(rows[0][1]):
            draft.lines.append(draft.kept(draft.operand, or_(filter(None, (lasting, pulses)))))
            return "", []
        active, ended = draft.bit("active"), draft.bit("ended")
        if draft.operand:  # what others write stays: TRUE while the action is on, and FALSE once when it ends
            draft.lines += [
                draft.kept(active, or_(filter(None, (lasting, pulses)))),
                f"IF {active} THEN {draft.operand} := TRUE; END_IF;",
                f"IF {and_([not_(active), ended])} THEN {draft.operand} := FALSE; END_IF;",
                f"{ended} := {active};",
            ]
            return "", []
        draft.lines.append(draft.kept(active, lasting or "FALSE"))
        return draft.executed(active, ended, pulses), [f"{ended} := {active};"]

    def _executed(self, row: ActionAssociation, label: str, code: Body) -> tuple[Pou, str | None]:
        """Return the block that executes an action, and the instance of one with a chart."""
        if not isinstance(code, SfcBody):
            function = self._functions.function(self._pou, label.replace(".", "_"), code)
            if isinstance(function, str):
                raise ImpossibleError
            return function, None
        action = self._pou.find_action(without_signs(row.target or ""))
        chart = self._functions.chart(self._pou, action) if action is not None else ""
        if isinstance(chart, str):
            raise ImpossibleError
        return chart.block, f"#{chart.instance.name}"

    def _writes(self) -> tuple[dict[int, frozenset[Path]], frozenset[Path]]:
        """Return what the entry, main and exit actions of each step write, and what other code of the block does.

        A block that is called writes no variable of this one that it is not given.
        """
        bodies = {action.name.casefold(): action.body for action in self._pou.actions}
        rows = {_name(row) for _, row in self._chart.associations()}
        of_steps: dict[int, list[Body]] = {}
        for step in self._chart.steps:
            for code in step.step_actions.values():
                name = code.translate(_NO_MARKS).casefold() if isinstance(code, str) else ""
                body = bodies.get(name) if isinstance(code, str) else code
                if body is not None and name not in rows:
                    of_steps.setdefault(step.id, []).append(body)
        own = {id(body) for each in of_steps.values() for body in each}
        named = [body for _, _, body in self._pou.named_bodies() if getattr(body, "chart", None) is not self._chart]
        others = [body for body in named if id(body) not in own]
        others += [row.body for _, row in self._chart.associations() if row.body is not None]
        return {number: _written(each) for number, each in of_steps.items()}, _written(others)

    def _is_shared(self, rows: list[tuple[Step, ActionAssociation]]) -> bool:
        """True if actions of other steps write the variable of an action too, and nothing else does.

        CODESYS executes them before all associations and their final scans; networks behind the sequence follow them.
        """
        step, row = rows[0]
        if not self._shared(control_label(step.name, row.target)) or self._code(row) is not None:
            return False
        if all(each.qualifier in RESETS for _, each in rows):
            return False
        path, (by_steps, others) = _path(row), self._written
        writing = {number for number, each in by_steps.items() if may_change(path, each, frozenset())}
        is_alone = writing.isdisjoint(step.id for step, _ in rows) and not may_change(path, others, frozenset())
        return bool(writing) and is_alone

    def _is_written_elsewhere(self, row: ActionAssociation) -> bool:
        """True if a text of the block may write the variable of an action too."""
        path, (by_steps, others) = _path(row), self._written
        return any(may_change(path, each, frozenset()) for each in (*by_steps.values(), others))

    # -- networks

    def _rules(self, draft: ControlDraft) -> DrawingRules:
        known = [*self._pou.variables(), *draft.variables]
        timers = [Variable(name=f"#{v.name}", type=DerivedType(name="TON")) for v in known if _is_timer(v)]
        return declared_rules(timers, Dialect.SCL, Tool.S7)

    def _drawn(self, draft: ControlDraft) -> list[ControlNetwork]:
        tree = parse_statements("\n".join(draft.lines), Dialect.SCL)
        drawn = draw_ld(tree.tree.statements, self._rules(draft), divided=True)
        if tree.problems or drawn.problems:
            raise ImpossibleError
        return [ControlNetwork(draft.label, self._typed(draft, network)) for network in drawn.body.networks]

    def _call(self, draft: ControlDraft, condition: str, called: Pou, instance: str | None) -> LdBody:
        """Return a network that calls a function or an instance while a condition is TRUE."""
        tree = parse_expression(condition, Dialect.SCL).tree
        if tree is None:
            raise ImpossibleError
        drawn = draw_ld_expression(tree, self._rules(draft))
        if drawn.problems or drawn.negated:
            raise ImpossibleError
        pins = [net.BlockVariable(name="EN", input=net.InputPin(connections=list(drawn.outputs)))]
        passed = self._functions.arguments(called)
        pins += [net.BlockVariable(name=name, input=net.InputPin(expression=value)) for name, value in passed.items()]
        outputs = [net.BlockVariable(name="ENO", output=net.OutputPin())]
        parameters = net.BlockParameters(inputs=pins, outputs=outputs)
        number = max(node.id for node in drawn.network.nodes) + 1
        kind = net.BlockCall.FUNCTION if instance is None else net.BlockCall.FUNCTION_BLOCK
        block = net.Block(id=number, type_name=called.name, instance=instance, call=kind, parameters=parameters)
        mark_call(block, called)
        return self._typed(draft, net.LogicNetwork(nodes=[*drawn.network.nodes, block]))

    def _typed(self, draft: ControlDraft, network: net.LogicNetwork) -> LdBody:
        types = self._types | {f"#{v.name.lower()}": write_type(v.type) for v in draft.variables if not _is_timer(v)}
        types |= {draft.operand.lower(): "Bool"} if draft.operand else {}
        boxes = [node.type_name for node in network.nodes if isinstance(node, net.Block)]
        if boxes != ["TON"] and give_condition_types(network, types) is not None:
            raise ImpossibleError
        put_assignments(network, types)
        if lacks_power(network):
            put_in_series(network)
        return LdBody(networks=[network])


def _written(bodies: Iterable[Body]) -> frozenset[Path]:
    return Effects.all(bind(body, Dialect.SCL).code for body in bodies).writes - {ANYTHING}


def _path(row: ActionAssociation) -> frozenset[Path]:
    return frozenset({path_of(parse_expression(row.target or "", Dialect.SCL).tree)})


def _is_of_iec(row: ActionAssociation) -> bool:
    """True if an association has nothing beside its qualifier, its time and its condition."""
    special = (row.event, row.value, row.forcing)
    return not row.interlock and row.kind in _KINDS and row.qualifier in _IEC and not any(special)


def _is_timer(variable: Variable) -> bool:
    return isinstance(variable.type, DerivedType) and variable.type.name.upper().startswith("TON")


def _shown(step: Step, row: ActionAssociation) -> str:
    if step.negated or row.negated:
        return "that it acts while its step is not active"
    if row.condition is not None:
        return "on which condition it acts"
    return f"{row.qualifier} as its other steps mean it" if row.qualifier in _OF_ROWS else str(row.qualifier)
