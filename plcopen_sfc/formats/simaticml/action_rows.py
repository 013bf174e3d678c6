"""Rows of GRAPH steps for the actions of other tools: the exact ones, and the reasons where there is none.

A row is an operand, an assignment of one operand, or a call (TIA Portal rejects expressions at the right when it
compiles; seen with V20). An action of a POU has no counterpart: its statements become rows where each is such an
assignment, else a function of their own that the rows call. Other actions are not written: a row with an undeclared
operand would not compile.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from lxml import etree

from plcopen_sfc.formats.simaticml.action_controls import ControlPlanner
from plcopen_sfc.formats.simaticml.action_functions import ActionControls, ActionFunctions
from plcopen_sfc.formats.simaticml.added_elements import mark_added
from plcopen_sfc.formats.simaticml.element_reader import ASSOCIATION
from plcopen_sfc.formats.simaticml.element_writer import (
    DocumentWriting,
    add_element,
    finish,
    keep_fields,
    sub,
    verbatim,
)
from plcopen_sfc.formats.simaticml.network_operands import parse_operand
from plcopen_sfc.formats.simaticml.row_tokens import AS_EVENTS, GRAPH_QUALIFIERS, TIMED, row_fields, write_row
from plcopen_sfc.formats.xml.extension_data import Markup, fields_left, markup_of
from plcopen_sfc.languages.networks import body_statements
from plcopen_sfc.languages.s7_actions import ActionCalls
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node
from plcopen_sfc.model.actions import ActionEvent, ActionKind, Qualifier
from plcopen_sfc.model.body import FbdBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcBody, SfcNetwork, Step
from plcopen_sfc.model.text import without_signs
from plcopen_sfc.model.types import DerivedType, StructType, Variable
from plcopen_sfc.report import Cause, CauseKind, Outcome

_OTHER = re.compile(r'["#.]+')
_ONCE = frozenset({Qualifier.P, Qualifier.P1, Qualifier.P0})
_WHILE_ACTIVE = frozenset({Qualifier.NONE, Qualifier.N})
_NATIVE_KINDS = frozenset({None, ActionKind.CONTINUOUS})
_S1, _S0 = ActionEvent.S1, ActionEvent.S0
_LABELS = {_S1: "entry", None: "main", _S0: "exit"}
_STORED = {ActionKind.ON_ACTIVATION: ActionEvent.S1, ActionKind.ON_DEACTIVATION: ActionEvent.S0}


@dataclass(frozen=True, slots=True)
class PlannedRows:
    """Rows that an action becomes, the outcome, and its reason. No rows: it is not written."""

    rows: tuple[ActionAssociation, ...] = ()
    outcome: Outcome = Outcome.NOT_EXECUTED
    why: str = ""


class RowPlanner:
    """Decides for each action of the chart of a block which rows express it.

    Statements that are no rows are in `functions`, associations that need no rows in `controls`. `of_tia`: the block
    is one of TIA Portal; a row that no rule fits is written as it was read. `final_scan`: the tool of the source
    executes actions once more when they have ended.
    """

    def __init__(
        self,
        project: Project,
        pou: Pou | None,
        functions: ActionFunctions,
        controls: ActionControls | None,
        *,
        of_tia: bool,
        final_scan: bool = True,
    ) -> None:
        self._final_scan = final_scan
        self._project = project
        self._pou = pou
        self._functions = functions
        self._controlled = controls.controlled if controls is not None else {}
        self._of_tia = of_tia

    def association(self, action: ActionAssociation, step: Step) -> PlannedRows:
        """Return the rows of an association of `step`."""
        if action.exclude:
            return PlannedRows((), Outcome.TRANSLATED, "it is excluded from the build; it is not written")
        if (step.id, action.id) in self._controlled:
            return PlannedRows((), Outcome.TRANSLATED, self._controlled[step.id, action.id])
        reason = _reason_against_rows(action, inverted=step.negated)
        if reason:
            return PlannedRows(why=reason)
        if self._is_row(action):
            return PlannedRows((action,), Outcome.KEPT)
        code = self._code(action)
        if isinstance(code, PlannedRows):
            return code
        if code is None:
            return self._operand(action)
        rows = self._rows(code, action.target or f"{step.name}_action")
        return _timed(rows, action, final_scan=self._final_scan)

    def step_action(self, code: str | Body, step: Step, event: ActionEvent | None) -> PlannedRows:
        """Return the rows of an entry action (event S1), an exit action (S0) or a main action (none) of CODESYS."""
        body: Body | None
        if isinstance(code, str):
            found = self._action_named(code)
            if isinstance(found, PlannedRows):
                return found
            if found is None:
                return PlannedRows(why=f"the project has no action {code}")
            body = found
        else:
            body = code
        label = code if isinstance(code, str) else f"{step.name}_{_LABELS[event]}"
        rows = self._rows(body, label)
        row = {"event": event}
        return PlannedRows(tuple(each.model_copy(update=row) for each in rows.rows), rows.outcome, rows.why)

    def _rows(self, body: Body, label: str) -> PlannedRows:
        """Return the statements of a body as rows without a time: as assignments, or as the call of a function."""
        if self._pou is not None and isinstance(body, SfcBody):
            return self._chart(self._pou, body, label)
        if self._pou is not None:
            body = self._functions.calls.body(body, self._pou)
        rows = _assignments(body)
        if rows.outcome is not Outcome.NOT_EXECUTED or self._pou is None:
            return rows
        function = self._functions.function(self._pou, _OTHER.sub("_", without_signs(label)), body)
        if isinstance(function, str):
            return PlannedRows(why=f"{rows.why}, and no function holds them: {function}")
        row = ActionAssociation(id=0, qualifier=Qualifier.CALL, body=StBody(text=self._functions.call(function)))
        return PlannedRows(
            (row,), Outcome.TRANSLATED, f"its statements are the function {function.name}, which a row calls"
        )

    def _chart(self, pou: Pou, body: SfcBody, label: str) -> PlannedRows:
        """Return the row that executes the chart of an action once."""
        action = next((each for each in pou.actions if each.body is body), None)
        if action is None:
            return PlannedRows(why=f"S7-GRAPH has no charts in actions, and {label} is none of the block")
        chart = self._functions.chart(pou, action)
        if isinstance(chart, str):
            return PlannedRows(why=f"S7-GRAPH has no charts in actions, and no block holds it: {chart}")
        row = ActionAssociation(id=0, qualifier=Qualifier.CALL, body=StBody(text=chart.call))
        return PlannedRows((row,), Outcome.TRANSLATED, f"its chart is the block {chart.block.name}, which a row calls")

    def _is_row(self, action: ActionAssociation) -> bool:
        """True for a call, and for a row of TIA Portal that no rule fits."""
        if action.body is None or action.target is not None:
            return False
        if isinstance(action.body, OpaqueBody):
            return action.body.source == "simaticml"
        if not isinstance(action.body, StBody):
            return False
        if action.qualifier is Qualifier.CALL:
            return True
        return self._of_tia and bool(parse_statements(action.body.text, Dialect.SCL).problems)

    def _code(self, action: ActionAssociation) -> Body | PlannedRows | None:
        """Return the code that an association executes; None for one that drives a variable."""
        if action.target is None:
            return action.body if action.body is not None else None
        return self._action_named(action.target)

    def _action_named(self, name: str) -> Body | PlannedRows | None:
        """Body of an action of the POU, or the call of the action of an instance; None for anything else."""
        parsed = parse_expression(name, Dialect.SCL)
        path = _path(parsed.tree) if parsed.tree is not None and not parsed.problems else None
        if path is None or self._pou is None:
            return None
        if len(path) == 1:
            if not _is_action(self._pou, path[0]):
                return None
            own = self._pou.find_action(path[0])
            assert own is not None  # noqa: S101  # as was asked
            self._functions.told.add(id(own))
            return own.body if own.body is not None else StBody(text="")
        block = self._instance(path)
        if block is None:
            return None
        return StBody(text=f"{name}();")  # its statements take the place of the call

    def _instance(self, path: list[str]) -> str | None:
        """Return the instance whose action the last name of `path` is; None where it is no action of an instance."""
        variables, names = self._first(path)
        for number, name in enumerate(names[:-1], 2):
            found = next((v for v in variables if v.name.casefold() == name.casefold()), None)
            if found is None:
                return None
            block = self._block(found)
            if block is not None and number == len(names) and _is_action(block, names[-1]):
                return found.name
            variables = block.variables() if block is not None else self._members(found)
        return None

    def _first(self, path: list[str]) -> tuple[list[Variable], list[str]]:
        """Return the variables among which the first name of a path is looked for, and the path from there on."""
        lists = [*self._project.global_variables, *(s for a in self._project.applications for s in a.global_variables)]
        named: dict[str, list[Variable]] = {}
        for section in lists:
            if section.name:
                named.setdefault(section.name.casefold(), []).extend(section.variables)
        named |= {b.name.casefold(): b.interface.variables() for b in self._project.data_blocks if b.interface}
        own = self._pou.variables() if self._pou is not None else []
        if path[0].casefold() in named and not any(v.name.casefold() == path[0].casefold() for v in own):
            return named[path[0].casefold()], path[1:]
        return own, path

    def _block(self, variable: Variable) -> Pou | None:
        """Return the function block of which a variable is an instance."""
        name = variable.type.name.casefold() if isinstance(variable.type, DerivedType) else None
        return next((pou for pou in self._project.pous if pou.name.casefold() == name), None)

    def _members(self, variable: Variable) -> list[Variable]:
        """Return the members of a structure."""
        type_ = variable.type
        if isinstance(type_, DerivedType):
            name = type_.name.casefold()
            type_ = next((d.type for d in self._project.data_types if d.name.casefold() == name), type_)
        return type_.members if isinstance(type_, StructType) else []

    def _operand(self, action: ActionAssociation) -> PlannedRows:
        """Return the row of an association that drives a variable, assigns to it, or counts with it."""
        if action.target is None:
            return PlannedRows((action,), Outcome.KEPT)
        if not self._of_tia:
            if parse_operand(action.target) is None:
                return PlannedRows(why=f"{action.target} is no operand of S7-GRAPH")
            if action.value is not None and not _assigns_operand(action.value):
                return PlannedRows(why=f"a row of S7-GRAPH assigns one operand; {action.value} is an expression")
        if action.kind in _STORED and action.event is None:
            row = action.model_copy(update={"event": _STORED[action.kind], "qualifier": Qualifier.N})
            return PlannedRows((row,), Outcome.TRANSLATED, f"the event {_STORED[action.kind]} stores it")
        if action.qualifier in AS_EVENTS and action.event is None:
            event = AS_EVENTS[action.qualifier]
            row = action.model_copy(update={"event": event, "qualifier": Qualifier.N})
            return PlannedRows((row,), Outcome.TRANSLATED, f"{action.qualifier} is expressed with the event {event}")
        if action.qualifier is Qualifier.R0:
            row = action.model_copy(update={"qualifier": Qualifier.R})
            return PlannedRows((row,), Outcome.TRANSLATED, "R0 is R")
        return PlannedRows((action,), Outcome.KEPT)


def _is_action(pou: Pou, name: str) -> bool:
    """True if a name is that of an action of `pou`, and not of one of its variables."""
    return pou.find_action(name) is not None and not any(v.name.casefold() == name.casefold() for v in pou.variables())


def _reason_against_rows(action: ActionAssociation, *, inverted: bool) -> str:
    """Return the reason why no row expresses an association, whatever it executes; empty if there is none."""
    if inverted or action.negated:
        return "it acts while the step is not active, which S7-GRAPH cannot express"
    if action.condition is not None:
        return "it has a condition of its own, and in S7-GRAPH only steps have one: give it a step of its own"
    if action.forcing is not None:
        return "S7-GRAPH has no forcing orders"
    if action.kind not in _NATIVE_KINDS and action.kind not in _STORED:
        return f"S7-GRAPH has no {action.kind} actions of GRAFCET"
    if (
        action.qualifier not in GRAPH_QUALIFIERS
        and action.qualifier not in AS_EVENTS
        and action.qualifier is not Qualifier.R0
    ):
        return f"S7-GRAPH has no qualifier {action.qualifier}"
    return ""


def _timed(found: PlannedRows, action: ActionAssociation, *, final_scan: bool) -> PlannedRows:
    """Return the rows of the statements of an association, at the time that its qualifier means.

    `final_scan`: the source executes them once more when the action has ended. matiec does not, nor S7-GRAPH.
    """
    qualifier = action.qualifier
    if not found.rows:
        return found
    if qualifier not in _WHILE_ACTIVE and qualifier not in _ONCE:
        return PlannedRows(why=f"S7-GRAPH has {qualifier} for Boolean operands only, not for statements")

    event = action.event or AS_EVENTS.get(qualifier)
    rows = tuple(row.model_copy(update={"event": event, "interlock": action.interlock}) for row in found.rows)
    # P1, P0 and events happen once in both; N and P are executed once more in the final scan of IEC 61131-3
    if qualifier in (Qualifier.P1, Qualifier.P0) or action.event is not None or not final_scan:
        return PlannedRows(rows, found.outcome, found.why)
    # GRAPH executes rows with the event S0 in the cycle that leaves the step, as IEC 61131-3 does with the final scan
    if qualifier in _WHILE_ACTIVE:
        last = tuple(row.model_copy(update={"event": ActionEvent.S0}) for row in rows)
        more = "another one" if len(last) == 1 else "others"
        return PlannedRows((*rows, *last), found.outcome, f"{found.why}, and {more} for the final scan")
    why = "S7-GRAPH does not execute an action once more after it has ended, as the final scan of IEC 61131-3 does"
    return PlannedRows(rows, Outcome.APPROXIMATED, why)


def _assignments(body: Body) -> PlannedRows:
    """Return the statements of a body as rows without a time; no rows where one of them is none."""
    if isinstance(body, StBody):
        parsed = parse_statements(body.text, Dialect.SCL)
        if parsed.problems:
            return PlannedRows(why="its text cannot be read")
        tree = parsed.tree
    elif isinstance(body, FbdBody | LdBody):
        drawn = body_statements(body, Dialect.SCL)
        if drawn.obstacles or drawn.helpers:
            return PlannedRows(why="it is a network, and S7-GRAPH has no row for that")
        tree = drawn.tree
    else:
        return PlannedRows(why=f"a row of S7-GRAPH is an operand, an assignment or a call, no body in {body.language}")
    rows: list[ActionAssociation] = []
    for statement in tree.statements:
        row = _row(statement)
        if row is None:
            return PlannedRows(why="a row of S7-GRAPH assigns one operand; its statements are more than that")
        rows.append(row)
    if not rows:
        return PlannedRows((), Outcome.TRANSLATED, "it does nothing")
    return PlannedRows(tuple(rows), Outcome.TRANSLATED, "its assignments are rows of their own")


def _row(statement: n.Statement) -> ActionAssociation | None:
    if not isinstance(statement, n.Assignment) or statement.kind is not n.AssignmentKind.ASSIGN:
        return None
    value = n.bare(statement.value)
    if not _is_variable(statement.target) or not _is_operand(value):
        return None
    target, text = print_node(statement.target), print_node(value)
    return ActionAssociation(id=0, target=target, value=text)


def _is_operand(tree: n.Expression) -> bool:
    """True for a variable, a literal or an address: the operands that a row takes at the right of ``:=``."""
    tree = n.bare(tree)
    if isinstance(tree, n.Unary):
        return tree.operator is n.Operator.NEGATE and isinstance(tree.operand, n.Literal)
    return isinstance(tree, n.Literal | n.Address) or _is_variable(tree)


def _is_variable(tree: n.Expression) -> bool:
    while isinstance(tree, n.Member | n.Index):
        if isinstance(tree, n.Index) and not all(map(_is_operand, tree.indices)):
            return False
        tree = tree.base
    return isinstance(tree, n.Name)


def _assigns_operand(value: str) -> bool:
    parsed = parse_expression(value, Dialect.SCL)
    return parsed.tree is not None and not parsed.problems and _is_operand(parsed.tree)


def _path(tree: n.Expression) -> list[str] | None:
    """Return the names of ``#a.b.c``; None for anything else."""
    names: list[str] = []
    while isinstance(tree, n.Member):
        names.append(tree.name.identifier)
        tree = tree.base
    if not isinstance(tree, n.Name):
        return None
    return [tree.identifier, *reversed(names)]


class RowsWriter:
    """Writes the rows of the steps of a chart, and reports the outcome of their actions."""

    def __init__(self, ctx: DocumentWriting, planner: RowPlanner) -> None:
        self.ctx = ctx
        self.planner = planner
        self.blocks = {
            block.name.casefold(): f'"{block.type_name}"' for block in ctx.project.data_blocks if block.type_name
        }

    def write(self, parent: etree._Element, step: Step) -> list[str]:
        """Write the rows of a step: for its entry action, for its actions while it is active, and for its exit action.

        Returns the fields of the step which rows express in another way.
        """
        instead: list[str] = []
        if not step.exclude and self._step_action(parent, step, "entry action", step.entry_action, ActionEvent.S1):
            instead.append("entry_action")
        if not step.exclude and self._step_action(parent, step, "main action", step.main_action, None):
            instead.append("main_action")
        for action in step.actions:
            if self._action(parent, action, step) and "actions" not in instead:
                instead.append("actions")
        if not step.exclude and self._step_action(parent, step, "exit action", step.exit_action, ActionEvent.S0):
            instead.append("exit_action")
        return instead

    def _step_action(
        self, parent: etree._Element, step: Step, what: str, code: str | Body | None, event: ActionEvent | None
    ) -> bool:
        """Write the rows of an entry, main or exit action. Returns True if there are any."""
        if code is None:
            return False
        planned = self.planner.step_action(code, step, event)
        for row in planned.rows:
            element = sub(parent, "Action")
            write_row(element, row, self.blocks)
            mark_added(element)
        self._note_rows(planned, what, what, f"`{_bare(code)}`" if isinstance(code, str) else "it")
        return bool(planned.rows)

    def _note_rows(self, planned: PlannedRows, what: str, name: str, shown: str) -> None:
        if shown.startswith("`"):
            self.ctx.actions_reported.add(shown.strip("`").casefold())
        lost = planned.outcome is Outcome.NOT_EXECUTED
        why = f"{shown} is not executed: {planned.why}" if lost else planned.why
        self.ctx.note(planned.outcome, what, name, why, Cause(CauseKind.AS_IT_IS) if lost else None)

    def _action(self, parent: etree._Element, action: ActionAssociation, step: Step) -> bool:
        """Write the rows of an association. Returns True if they express it in another way."""
        kept = verbatim(self.ctx, action.extension_data)
        target = action.target or (action.body.text if isinstance(action.body, StBody) else "")
        if kept is not None and _still_means(kept, action):
            parent.append(kept)
            self.ctx.keep("action", target)
            return False
        if isinstance(action.body, OpaqueBody) and action.body.source == "simaticml":
            add_element(self.ctx, parent, action.body.content)
            self.ctx.keep("action")
            return False
        planned = self.planner.association(action, step)
        if step.exclude:
            planned = PlannedRows((), Outcome.TRANSLATED, "its step is excluded from the build")
        if planned.rows == (action,):
            element = sub(parent, "Action")
            write_row(element, action, self.blocks)
            native = {"id", "qualifier", "target", "value", "event", "interlock", "body"}
            native |= {"duration"} if action.qualifier in TIMED else set()
            self.ctx.keep("action", target)
            finish(self.ctx, element, action, frozenset(native))
            return False
        association = {ASSOCIATION: fields_left(action, frozenset({"id"}))}
        if not planned.rows:
            keep_fields(parent, association)
        for number, row in enumerate(planned.rows):
            element = sub(parent, "Action")
            write_row(element, row, self.blocks)
            if number:
                mark_added(element)
            else:
                keep_fields(element, association)
        shown = _bare(action.target) if action.target is not None else "in place"
        qualifier = f" with the qualifier {action.qualifier}" if action.target is None else ""
        self._note_rows(
            planned, "action", f"action {shown}", f"`{shown}`" if not qualifier else f"what it does{qualifier}"
        )
        return bool(planned.rows)


def _bare(name: str) -> str:
    """Return a name as other tools write it."""
    return name.replace("#", "").replace('"', "")


def _still_means(kept: etree._Element, action: ActionAssociation) -> bool:
    """True if a row of the file still means the same as the association."""
    same = ActionAssociation.model_validate({"id": action.id, **row_fields(kept), "extension_data": None})
    return same == action.model_copy(update={"extension_data": None})


def action_functions(project: Project, calls: ActionCalls) -> ActionFunctions:
    """Return the functions of all actions of `project` that the rows of its charts call."""
    functions = ActionFunctions(project, calls)
    for pou in project.pous:
        for method in pou.methods:
            functions.method(pou, method)
    for _, pou, body in project.bodies():
        if isinstance(body, StBody) and any(body is each for each in pou.bodies):
            calls.inlined(body.text, pou)
    waiting = [pou for pou in project.pous if any(isinstance(body, SfcBody) for body in pou.bodies)]
    waiting += [chart.block for chart in functions.charts.values()]
    for pou in waiting:  # it grows
        known = set(functions.charts)
        for body in pou.bodies:
            if isinstance(body, SfcBody):
                _plan(functions, project, pou, body.chart)
        waiting += [chart.block for name, chart in functions.charts.items() if name not in known]
    return functions


def _plan(functions: ActionFunctions, project: Project, pou: Pou, chart: SfcNetwork) -> None:
    """Make the functions and blocks of all actions of a chart."""
    controls = ControlPlanner(project, pou, chart, functions).plan()
    planner = RowPlanner(project, pou, functions, controls, of_tia=markup_of(project) is Markup.SIMATICML)
    for step in (each for each in chart.steps if not each.exclude):
        for code, event in ((step.entry_action, _S1), (step.main_action, None), (step.exit_action, _S0)):
            if code is not None:
                planner.step_action(code, step, event)
        for action in step.actions:
            planner.association(action, step)


def functions_of(ctx: DocumentWriting) -> ActionFunctions:
    """Return the functions of all actions of the project that is written; they are made once."""
    if ctx.action_functions is None:
        ctx.action_functions = action_functions(ctx.project, ctx.action_calls)
    return ctx.action_functions
