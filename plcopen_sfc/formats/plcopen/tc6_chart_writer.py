"""Writer of ``SFC`` bodies. The reader is `tc6_chart_reader`.

A chart that is written has a drawing that fits it; `plcopen_sfc.drawing` sees to that before a writer is called.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lxml import etree

from plcopen_sfc.errors import ModelError
from plcopen_sfc.formats.plcopen.tc6_networks import is_known, write_node
from plcopen_sfc.formats.plcopen.tc6_pins import geometry, write_connection, write_input, write_output
from plcopen_sfc.formats.plcopen.tc6_reading import SHARED_FIELD, STEP_ACTION_FIELD, STEP_ACTION_QUALIFIERS
from plcopen_sfc.formats.plcopen.tc6_writing import (
    Tc6WriteContext,
    add_child,
    add_unknown,
    boolean,
    finish_element,
    write_point,
)
from plcopen_sfc.formats.xml.extension_data import fields_left
from plcopen_sfc.model.actions import ActionAssociation, Qualifier
from plcopen_sfc.model.body import Body, StBody
from plcopen_sfc.model.conditions import BodyCondition, Condition, Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.drawing import ActionEntry, Drawing, StepActionKind, Symbol, SymbolKind
from plcopen_sfc.model.network import Node
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.report import Outcome

BodyWriter = Callable[[Tc6WriteContext, etree._Element, str, Body, dict[str, str]], None]

_STEP = frozenset({"id", "name", "initial", "actions", "negated"})
_TRANSITION = frozenset({"id", "sources", "targets", "condition", "priority"})
_SYMBOL = frozenset(
    {"id", "kind", "position", "width", "height", "inputs", "outputs", "action_output", "condition", "transitions"}
    | {"target", "entries", "execution_order", "local_id"}
)
_ASSOCIATION = frozenset({"id", "target", "body", "duration", "indicator", "negated"})
_TC6_QUALIFIERS = frozenset({"P1", "N", "P0", "R", "S", "L", "D", "P", "DS", "DL", "SD", "SL"})


class Tc6ChartWriter:
    """Writes one chart. `write_body` writes the bodies inside it."""

    def __init__(self, ctx: Tc6WriteContext, chart: SfcNetwork, write_body: BodyWriter) -> None:
        self.ctx = ctx
        self.chart = chart
        self.write_body = write_body
        self.steps = {step.id: step for step in chart.steps}
        self.transitions = {transition.id: transition for transition in chart.transitions}
        self._labels = chart.labels()
        self.associations = {a.id: a for _, a in chart.associations()}
        self.owner = {a.id: step for step, a in chart.associations()}
        self.nodes: dict[int, Node] = {node.id: node for node in chart.logic if is_known(ctx, node)}
        # TC6 1.01 has no execution order at symbols of charts
        self.symbol_fields = _SYMBOL - ({"execution_order"} if ctx.version.first_generation else set())
        self.conditions = self._drawn_conditions()
        self.drawn_step_actions = self._drawn_step_actions()

    def _drawn_conditions(self) -> dict[int, str]:
        """Return the text of each drawn expression, by the id of its symbol."""
        texts: dict[int, str] = {}
        for symbol in self.drawing.symbols:
            if symbol.kind is SymbolKind.TRANSITION and symbol.condition is not None:
                condition = self.transition_of(symbol).condition
                if isinstance(condition, Expression) and symbol.condition.connections:
                    texts[symbol.condition.connections[0].source] = condition.text
        return texts

    def _drawn_step_actions(self) -> dict[int, set[StepActionKind]]:
        """Return the step actions of each step that are drawn in an action block."""
        drawn: dict[int, set[StepActionKind]] = {}
        for symbol in self.drawing.symbols:
            kinds = {entry.step_action for entry in symbol.entries or () if entry.step_action is not None}
            for pin in symbol.inputs if kinds else ():
                for connection in pin.connections:
                    drawn.setdefault(connection.source, set()).update(kinds)
        return drawn

    @property
    def drawing(self) -> Drawing:
        """The drawing; every chart that is written has one."""
        if self.chart.drawing is None:
            raise ModelError("a chart has to be drawn before it can be written as a picture")
        return self.chart.drawing

    def transition_of(self, symbol: Symbol) -> Transition:
        """Return the transition of a symbol, or the first of several."""
        return self.transitions[symbol.transitions[0] if symbol.transitions else symbol.id]

    def write(self, parent: etree._Element) -> None:
        """Write the chart's symbols and logic into ``SFC``."""
        symbols = {symbol.id: symbol for symbol in self.drawing.symbols}
        order = [i for i in self.drawing.order or () if i in symbols or i in self.nodes]
        placed = set(order)
        order += [i for i in (*symbols, *self.nodes) if i not in placed]
        for number in order:
            if number in symbols:
                self.write_symbol(parent, symbols[number])
            else:
                write_node(self.ctx, parent, self.nodes[number], "logic in a chart")
        if self.ctx.takes_markup:
            add_unknown(self.ctx, parent, self.chart.carried)

    def write_symbol(self, parent: etree._Element, symbol: Symbol) -> None:
        """Write one symbol with the element that it draws."""
        if symbol.kind is SymbolKind.STEP or symbol.kind is SymbolKind.MACRO_STEP:
            self.write_step(parent, symbol, self.steps[symbol.id])
        elif symbol.kind is SymbolKind.TRANSITION:
            self.write_transition(parent, symbol, self.transition_of(symbol))
        elif symbol.kind is SymbolKind.ACTION_BLOCK:
            self.write_action_block(parent, symbol)
        elif symbol.kind is SymbolKind.EXPRESSION:
            self.write_expression(parent, symbol)
        elif symbol.kind is SymbolKind.JUMP:
            self.write_jump(parent, symbol)
        else:
            self.write_bar(parent, symbol)

    def _element(self, parent: etree._Element, symbol: Symbol, attributes: dict[str, str]) -> etree._Element:
        local_id = symbol.id if symbol.local_id is None else symbol.local_id
        order = None if self.ctx.version.first_generation else symbol.execution_order
        size = geometry(symbol.width, symbol.height, order)
        element = add_child(self.ctx, parent, symbol.kind.value, {"localId": str(local_id)} | attributes | size)
        write_point(self.ctx, element, "position", symbol.position)
        return element

    def _pins(self, element: etree._Element, symbol: Symbol) -> None:
        for pin in symbol.inputs:
            write_input(self.ctx, element, pin)
        for output in symbol.outputs:
            write_output(self.ctx, element, output)

    def write_step(self, parent: etree._Element, symbol: Symbol, step: Step) -> None:
        """Write ``step`` or ``macroStep``."""
        ctx = self.ctx
        macro = symbol.kind is SymbolKind.MACRO_STEP
        attributes = {"name": step.name}
        if macro and not step.name:
            del attributes["name"]
        if step.initial and not macro:
            attributes["initialStep"] = "true"
        if step.negated and not macro:
            attributes["negated"] = "true"
        element = self._element(parent, symbol, attributes)
        self._pins(element, symbol)
        if symbol.action_output is not None:
            write_output(ctx, element, symbol.action_output, "connectionPointOutAction")
        native = _STEP
        if macro and step.macro is not None and step.macro.expansion is None:
            native = native | {"macro"}
            if step.macro.body is not None:
                self.write_body(ctx, element, "body", step.macro.body, {})
        if macro:
            native = native - ({"initial"} if step.initial else set()) - ({"negated"} if step.negated else set())
        if not macro:
            native = native | {f"{kind.value}_action" for kind in self.drawn_step_actions.get(step.id, ())}
        ctx.keep("macro-step" if macro else "step", step.name, *(["negated step output"] if step.negated else []))
        ctx.place.append(f"step {step.name}")
        finish_element(ctx, element, step, "macroStep" if macro else "step", native, also=self._order(symbol))
        ctx.place.pop()

    def write_transition(self, parent: etree._Element, symbol: Symbol, transition: Transition) -> None:
        """Write ``transition``."""
        ctx = self.ctx
        native = _TRANSITION
        attributes = {}
        if ctx.dialect.states_actions:
            # these tools go by the order of the branches
            native = native - {"priority"}
        elif transition.priority is not None:
            attributes["priority"] = str(transition.priority)
        element = self._element(parent, symbol, attributes)
        self._pins(element, symbol)
        label = self._labels[transition.id]
        if transition.condition is not None:
            self.write_condition(element, symbol, transition.condition)
        ctx.keep("transition", label, *_features(transition.condition))
        ctx.place.append(f"transition {label}")
        finish_element(
            ctx,
            element,
            transition,
            "transition",
            native,
            also=self._order(symbol) | self._shared(symbol) | self._left_of_wire(symbol, transition),
        )
        ctx.place.pop()

    def _order(self, symbol: Symbol) -> dict[str, Any]:
        """Return the execution order of a step or transition, where the version has no place for it."""
        if symbol.execution_order is None or not self.ctx.version.first_generation:
            return {}
        return {"execution_order": symbol.execution_order}

    def _shared(self, symbol: Symbol) -> dict[str, Any]:
        """Return the ids of the transitions that one symbol draws; tools that draw so get them by counting."""
        return {SHARED_FIELD: symbol.transitions} if symbol.transitions and not self.ctx.counts_ids else {}

    def _left_of_wire(self, symbol: Symbol, transition: Transition) -> dict[str, Any]:
        """Return fields of the pin of a wired condition, which has no element of its own in TC6 1.01."""
        condition = transition.condition
        pin = condition.input if isinstance(condition, WiredCondition) else symbol.condition
        if pin is None or not self.ctx.version.first_generation:
            return {}
        left = fields_left(pin, frozenset({"connections"}))
        return {"condition": {"input": left}} if left else {}

    def write_condition(self, parent: etree._Element, symbol: Symbol, condition: Condition) -> None:
        """Write ``condition`` in the form in which it is drawn."""
        ctx = self.ctx
        element = add_child(ctx, parent, "condition", {"negated": boolean(True)} if condition.negated else {})
        if isinstance(condition, NamedCondition):
            add_child(ctx, element, "reference", {"name": condition.name})
            return
        if isinstance(condition, BodyCondition):
            self.write_body(ctx, element, "inline", condition.body, {"name": condition.name})
            return
        pin = symbol.condition if isinstance(condition, Expression) else condition.input
        if pin is None:
            body = StBody(text="")
            if isinstance(condition, Expression):
                body = StBody(text=condition.text, markup=condition.markup)
            self.write_body(ctx, element, "inline", body, {"name": symbol.name or ""})
        elif ctx.version.first_generation:
            for connection in pin.connections:
                write_connection(ctx, element, connection)
        else:
            write_input(ctx, element, pin)

    def write_expression(self, parent: etree._Element, symbol: Symbol) -> None:
        """Write the ``inVariable`` that a condition is wired to."""
        element = self._element(parent, symbol, {})
        for output in symbol.outputs:
            write_output(self.ctx, element, output)
        add_child(self.ctx, element, "expression").text = self.conditions.get(symbol.id, symbol.name or "")
        finish_element(self.ctx, element, symbol, "inVariable", self.symbol_fields | {"name"})

    def write_jump(self, parent: etree._Element, symbol: Symbol) -> None:
        """Write ``jumpStep``."""
        self.ctx.jump_name = self.jump_target(symbol)
        element = self._element(parent, symbol, {"targetName": self.ctx.jump_name})
        for pin in symbol.inputs:
            write_input(self.ctx, element, pin)
        finish_element(self.ctx, element, symbol, "jumpStep", self.symbol_fields | {"name"})

    def jump_target(self, symbol: Symbol) -> str:
        """Return the name of what a jump leads to, in the spelling of the file where it means the same."""
        name = None
        if symbol.target in self.steps:
            name = self.steps[symbol.target].name
        elif symbol.target is not None:
            name = next((s.name for s in self.drawing.symbols if s.id == symbol.target), None)
        if name is None or (symbol.name is not None and symbol.name.casefold() == name.casefold()):
            return symbol.name or ""
        return name

    def write_bar(self, parent: etree._Element, symbol: Symbol) -> None:
        """Write a divergence or convergence."""
        native = self.symbol_fields
        attributes: dict[str, str] = {}
        if symbol.kind is SymbolKind.SIMULTANEOUS_DIVERGENCE:
            native = native | {"name"}
            if symbol.name is not None:
                attributes["name"] = symbol.name
        element = self._element(parent, symbol, attributes)
        self._pins(element, symbol)
        finish_element(self.ctx, element, symbol, symbol.kind.value, native)

    def write_action_block(self, parent: etree._Element, symbol: Symbol) -> None:
        """Write ``actionBlock`` with its associations."""
        ctx = self.ctx
        entries = [e for e in symbol.entries or () if e.step_action is not None or e.association in self.associations]
        native = self.symbol_fields
        negated = any(self.associations[e.association].negated for e in entries if e.step_action is None)
        element = self._element(parent, symbol, {"negated": "true"} if negated else {})
        for pin in symbol.inputs:
            write_input(ctx, element, pin)
        if ctx.version.first_generation:
            for output in symbol.outputs:
                write_output(ctx, element, output)
            native = native - ({"entries"} if not ctx.counts_ids else set())
        else:
            # TC6 2.0 moved the output from the block to its actions
            native = native - {"outputs"}
        for entry in entries:
            if entry.step_action is None:
                self.write_action(element, entry, self.associations[entry.association])
            else:
                self.write_step_action(element, symbol, entry, entry.step_action)
        finish_element(ctx, element, symbol, "actionBlock", native)

    def write_step_action(
        self, parent: etree._Element, symbol: Symbol, entry: ActionEntry, kind: StepActionKind
    ) -> None:
        """Write a step action as the association that comes nearest to it, with a mark by which it is read back."""
        sources = [c.source for pin in symbol.inputs for c in pin.connections]
        step = next((self.steps[source] for source in sources if source in self.steps), None)
        if step is None:
            return
        action = getattr(step, f"{kind.value}_action")
        if action is None:
            return
        qualifier = STEP_ACTION_QUALIFIERS[kind]
        association = ActionAssociation(
            id=entry.association,
            qualifier=qualifier,
            target=action if isinstance(action, str) else None,
            body=None if isinstance(action, str) else action,
        )
        self.associations[entry.association], self.owner[entry.association] = association, step
        self.write_action(parent, entry, association, {STEP_ACTION_FIELD: kind.value})
        why = f"an association with qualifier {qualifier.value}"
        outcome = Outcome.TRANSLATED
        if kind is StepActionKind.MAIN and isinstance(action, str):
            outcome = Outcome.APPROXIMATED
            why += "; other than a main action, it is executed once more when the step was left"
        elif kind is StepActionKind.MAIN:
            why += ", whose statements are executed only while the step is active"
        self.ctx.note(outcome, f"{kind.value} action", f"step {step.name}", why)

    def write_action(
        self,
        parent: etree._Element,
        entry: ActionEntry,
        association: ActionAssociation,
        also: dict[str, str] | None = None,
    ) -> None:
        """Write ``action`` of a block. `also` are more extension data."""
        ctx = self.ctx
        attributes: dict[str, str] = {}
        native = _ASSOCIATION - ({"id"} if ctx.version.first_generation and not ctx.counts_ids else set())
        if not ctx.version.first_generation:
            attributes["localId"] = str(entry.association if entry.local_id is None else entry.local_id)
        states = ctx.dialect.states_actions
        if association.qualifier in _TC6_QUALIFIERS:
            native = native | {"qualifier"}
            if association.qualifier is not Qualifier.N or states:
                attributes["qualifier"] = association.qualifier.value
        if association.duration or states:
            attributes["duration"] = association.duration or ""
        if association.indicator or states:
            attributes["indicator"] = association.indicator or ""
        if not ctx.version.first_generation:
            attributes |= geometry(entry.width, entry.height, entry.execution_order)
        element = add_child(ctx, parent, "action", attributes)
        if not ctx.version.first_generation:
            write_point(ctx, element, "relPosition", entry.position or (0, 0))
        if association.target is not None:
            add_child(ctx, element, "reference", {"name": association.target})
        if association.body is not None:
            self.write_body(ctx, element, "inline", association.body, {})
        if entry.output is not None and not ctx.version.first_generation:
            write_output(ctx, element, entry.output)
        owner = self.owner[association.id].name
        label = f"{owner} {association.qualifier.value} {association.target or 'inline'}"
        if not also:
            negated = ["negated action block"] if association.negated else []
            ctx.keep("action association", label, f"qualifier {association.qualifier.value}", *negated)
        ctx.place.append(f"step {owner} / action {association.target or 'inline'}")
        finish_element(ctx, element, association, "action", native, also=also)
        ctx.place.pop()


def _features(condition: Condition | None) -> list[str]:
    """Return what a condition asks of a reader."""
    if condition is None:
        return []
    kinds = {"body": "condition in a body", "wired": "condition wired to logic"}
    found = [kinds[condition.kind]] if condition.kind in kinds else []
    return [*found, "negated condition"] if condition.negated else found
