"""``SFC`` bodies, written element by element; `tc6_charts` reads them.

A chart that is written has a drawing that fits it; `plcopen_sfc.drawing` sees to that before a writer is called.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar

from lxml import etree

from plcopen_sfc.errors import ModelError
from plcopen_sfc.formats.plcopen.tc6_charts import QUALIFIERS
from plcopen_sfc.formats.plcopen.tc6_networks import is_known, write_node
from plcopen_sfc.formats.plcopen.tc6_pins import (
    geometry,
    write_connection,
    write_input,
    write_output,
)
from plcopen_sfc.formats.plcopen.tc6_reading import (
    SHARED_FIELD,
    STEP_ACTION_FIELD,
    STEP_ACTION_QUALIFIERS,
)
from plcopen_sfc.formats.plcopen.tc6_writing import (
    Tc6WriteContext,
    add_child,
    add_unknown,
    finish_element,
    write_point,
)
from plcopen_sfc.formats.xml.extension_data import fields_left
from plcopen_sfc.model import sfc
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.drawing import STEPS, ActionEntry, Drawing, StepActionKind, Symbol, SymbolKind
from plcopen_sfc.model.exclusion import told_by_others
from plcopen_sfc.model.network import Node
from plcopen_sfc.report import Outcome

BodyWriter = Callable[[Tc6WriteContext, etree._Element, str, sfc.Body, dict[str, str]], None]

_STEP = frozenset({"id", "name", "initial", "actions", "negated"})
_TRANSITION = frozenset({"id", "sources", "targets", "condition", "priority"})
_SYMBOL = frozenset(
    {"id", "kind", "position", "width", "height", "inputs", "outputs", "action_output", "condition", "transitions"}
    | {"target", "entries", "execution_order", "local_id"}
)
_ASSOCIATION = frozenset({"id", "target", "body", "duration", "indicator", "negated"})


class Tc6ChartWriter:
    """Writes one chart. `write_body` writes the bodies inside it."""

    def __init__(self, ctx: Tc6WriteContext, chart: sfc.SfcNetwork, write_body: BodyWriter) -> None:
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
        told = told_by_others(chart)
        drawn = chart.drawing.symbols if chart.drawing is not None else []
        things = {**{symbol.id: symbol for symbol in drawn}, **self.steps, **self.transitions} if told else {}
        ctx.told_by_others |= {id(things[number]) for number in told}
        self.unchanged = ctx.unchanged.get(id(chart), _NONE)
        self.conditions = _drawn_conditions(chart)
        self.drawn_step_actions = self._drawn_step_actions()
        self.priorities = self._priorities()

    def _priorities(self) -> dict[int, int]:
        """Return the priorities of transitions that need one; what competes is tried in the order of the document else.

        The drawing gives that order. It cannot be the one of the chart where a convergence of simultaneous branches
        competes with a transition of one of them.
        """
        given = {transition.id: transition.priority for transition in self.chart.transitions}
        drawn: dict[int, None] = {}
        symbols = self._symbols
        for number in self._document_order():
            symbol = symbols.get(number)
            if symbol is not None and symbol.kind is SymbolKind.TRANSITION:
                drawn.update(dict.fromkeys(symbol.transitions or [symbol.id]))
        place = {number: position for position, number in enumerate(drawn)}
        leaving = sfc.leaving_steps(self.chart.transitions).values()
        competing = [[each.id for each in order] for order in leaving if len(order) > 1]

        def tried(number: int) -> tuple[bool, int, int]:
            priority = given[number]
            return priority is None, priority or 0, place.get(number, 0)

        if all(order == sorted(order, key=tried) for order in competing):
            return {number: priority for number, priority in given.items() if priority is not None}
        every = {number for order in competing for number in order}
        return {
            t.id: rank
            for rank, t in enumerate((t for t in sfc.by_priority(self.chart.transitions) if t.id in every), 1)
        }

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

    def transition_of(self, symbol: Symbol) -> sfc.Transition:
        """Return the transition of a symbol, or the first of several."""
        return self.transitions[symbol.transitions[0] if symbol.transitions else symbol.id]

    @property
    def _symbols(self) -> dict[int, Symbol]:
        return {symbol.id: symbol for symbol in self.drawing.symbols}

    def _document_order(self) -> list[int]:
        """Return the ids of symbols and elements of logic in the order of the document."""
        symbols = self._symbols
        order = [i for i in self.drawing.order or () if i in symbols or i in self.nodes]
        placed = set(order)
        return order + [i for i in (*symbols, *self.nodes) if i not in placed]

    def write(self, parent: etree._Element) -> None:
        """Write the chart's symbols and logic into ``SFC``."""
        symbols = self._symbols
        for number in self._document_order():
            if number in symbols:
                self.write_symbol(parent, symbols[number])
            else:
                write_node(self.ctx, parent, self.nodes[number], "logic in a chart")
        if self.ctx.takes_markup:
            add_unknown(self.ctx, parent, self.chart.extension_data)

    def write_symbol(self, parent: etree._Element, symbol: Symbol) -> None:
        """Write one symbol with the element that it draws, but nothing where that stays as it is."""
        if symbol.id in self.unchanged:
            return
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

    def _element(self, parent: etree._Element, symbol: Symbol, attributes: Mapping[str, str | None]) -> etree._Element:
        local_id = symbol.id if symbol.local_id is None else symbol.local_id
        order = None if self.ctx.version.first_generation else symbol.execution_order
        size = geometry(symbol.width, symbol.height, order)
        element = add_child(self.ctx, parent, symbol.kind.value, {"localId": str(local_id), **attributes, **size})
        write_point(self.ctx, element, "position", symbol.position)
        return element

    def _pins(self, element: etree._Element, symbol: Symbol) -> None:
        for pin in symbol.inputs:
            write_input(self.ctx, element, pin)
        for output in symbol.outputs:
            write_output(self.ctx, element, output)

    def write_step(self, parent: etree._Element, symbol: Symbol, step: sfc.Step) -> None:
        """Write ``step`` or ``macroStep``."""
        ctx = self.ctx
        macro = symbol.kind is SymbolKind.MACRO_STEP
        marks: dict[str, str | None] = {"name": step.name if step.name or not macro else None}
        marks["initialStep"] = "true" if step.initial and not macro else None
        marks["negated"] = "true" if step.negated and not macro else None
        element = self._element(parent, symbol, marks)
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

    def write_transition(self, parent: etree._Element, symbol: Symbol, transition: sfc.Transition) -> None:
        """Write ``transition``."""
        ctx = self.ctx
        native = _TRANSITION
        attributes = {}
        ranked: dict[str, Any] = {}
        if ctx.dialect.states_actions:
            # these tools go by the order of the branches
            native = native - {"priority"}
        elif transition.id in self.priorities:
            attributes["priority"] = str(self.priorities[transition.id])
            ranked = {"priority": None} if transition.priority is None and not ctx.same else {}
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
            also=self._order(symbol) | self._shared(symbol) | self._left_of_wire(symbol, transition) | ranked,
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

    def _left_of_wire(self, symbol: Symbol, transition: sfc.Transition) -> dict[str, Any]:
        """Return fields of the pin of a wired condition, which has no element of its own in TC6 1.01."""
        condition = transition.condition
        pin = condition.input if isinstance(condition, WiredCondition) else symbol.condition
        if pin is None or not self.ctx.version.first_generation:
            return {}
        left: dict[str, Any] = {"input": fields_left(pin, frozenset({"connections"}))}
        if isinstance(condition, WiredCondition) and not pin.connections:  # nothing below <condition> tells its kind
            left |= {"kind": condition.kind, "negated": condition.negated}
        return {"condition": left} if left["input"] or len(left) > 1 else {}

    def write_condition(self, parent: etree._Element, symbol: Symbol, condition: sfc.Condition) -> None:
        """Write ``condition`` in the form in which it is drawn."""
        ctx = self.ctx
        element = add_child(ctx, parent, "condition", {"negated": "true" if condition.negated else None})
        if isinstance(condition, NamedCondition):
            add_child(ctx, element, "reference", {"name": condition.name})
            return
        if isinstance(condition, sfc.BodyCondition):
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
        is_named = symbol.kind is SymbolKind.SIMULTANEOUS_DIVERGENCE
        element = self._element(parent, symbol, {"name": symbol.name if is_named else None})
        self._pins(element, symbol)
        native = self.symbol_fields | ({"name"} if is_named else set())
        finish_element(self.ctx, element, symbol, symbol.kind.value, native)

    def write_action_block(self, parent: etree._Element, symbol: Symbol) -> None:
        """Write ``actionBlock`` with its associations."""
        ctx = self.ctx
        entries = [e for e in symbol.entries or () if e.step_action is not None or e.association in self.associations]
        native = self.symbol_fields
        negated = any(self.associations[e.association].negated for e in entries if e.step_action is None)
        element = self._element(parent, symbol, {"negated": "true" if negated else None})
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
        association = sfc.ActionAssociation(
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
        association: sfc.ActionAssociation,
        also: dict[str, str] | None = None,
    ) -> None:
        """Write ``action`` of a block. `also` are more extension data."""
        ctx = self.ctx
        attributes: dict[str, str] = {}
        native = _ASSOCIATION - ({"id"} if ctx.version.first_generation and not ctx.counts_ids else set())
        if not ctx.version.first_generation:
            attributes["localId"] = str(entry.association if entry.local_id is None else entry.local_id)
        states = ctx.dialect.states_actions
        if association.qualifier in QUALIFIERS:
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


def unchanged_symbols(before: sfc.SfcNetwork, after: sfc.SfcNetwork) -> frozenset[int]:
    """Return the ids of symbols whose elements are the same in the file, whichever of two charts is written.

    None where what an element has may depend on all others: symbols, transitions or ids are others, or a step action
    is drawn in a block that has changed.
    """
    old, new = before.drawing, after.drawing
    if old is None or new is None or _skeleton(before, old) != _skeleton(after, new):
        return _NONE
    steps, every_step = _equal_by_id(before.steps, after.steps), {step.id for step in after.steps}
    transitions = _equal_by_id(before.transitions, after.transitions)
    symbols = _equal_by_id(old.symbols, new.symbols)
    actions = _equal_by_id([a for _, a in before.associations()], [a for _, a in after.associations()])
    texts, others = _drawn_conditions(before), _drawn_conditions(after)
    found: set[int] = set()
    for symbol in new.symbols:
        if symbol.kind is SymbolKind.ACTION_BLOCK:
            entries = symbol.entries or ()
            sources = [wire.source for pin in symbol.inputs for wire in pin.connections]
            same = all(each.association in actions for each in entries) and steps.issuperset(
                every_step.intersection(sources)
            )
            if any(each.step_action is not None for each in entries):
                return _NONE
        elif symbol.kind is SymbolKind.TRANSITION:
            same = transitions.issuperset(symbol.transitions or [symbol.id])
        elif symbol.kind is SymbolKind.EXPRESSION:
            same = texts.get(symbol.id) == others.get(symbol.id)
        elif symbol.kind is SymbolKind.JUMP:
            # the element of a jump has the name of its target: a rename of that step changes it
            same = symbol.target is None or symbol.target in (steps if symbol.target in every_step else symbols)
        else:
            same = symbol.kind not in STEPS or symbol.id in steps
        if same and symbol.id in symbols and symbol.local_id is None:
            found.add(symbol.id)
    return frozenset(found)


_NONE: frozenset[int] = frozenset()


def _skeleton(chart: sfc.SfcNetwork, drawing: Drawing) -> list[object]:
    """Return what elements there are in a chart, in which order, and their references to each other."""
    symbols = [(symbol.id, symbol.local_id, symbol.kind, symbol.transitions) for symbol in drawing.symbols]
    links = [(each.id, each.priority, each.sources, each.targets) for each in chart.transitions]
    nodes = [(node.id, node.kind) for node in chart.logic]
    return [symbols, links, [step.id for step in chart.steps], nodes, drawing.order, chart.extension_data]


T = TypeVar("T", sfc.Step, sfc.Transition, sfc.ActionAssociation, Symbol)


def _equal_by_id(before: Iterable[T], after: Iterable[T]) -> frozenset[int]:
    """Return the ids of what is equal on both sides."""
    known = {thing.id: thing for thing in before}
    return frozenset(thing.id for thing in after if known.get(thing.id) == thing)


def _drawn_conditions(chart: sfc.SfcNetwork) -> dict[int, str]:
    """Return the text of each drawn expression, by the id of its symbol."""
    texts: dict[int, str] = {}
    transitions = {transition.id: transition for transition in chart.transitions}
    for symbol in chart.drawing.symbols if chart.drawing is not None else ():
        if symbol.kind is SymbolKind.TRANSITION and symbol.condition is not None:
            condition = transitions[symbol.transitions[0] if symbol.transitions else symbol.id].condition
            if isinstance(condition, Expression) and symbol.condition.connections:
                texts[symbol.condition.connections[0].source] = condition.text
    return texts


def _features(condition: sfc.Condition | None) -> list[str]:
    """Return the features that a condition needs in a reader."""
    if condition is None:
        return []
    kinds = {"body": "condition in a body", "wired": "condition wired to logic"}
    found = [kinds[condition.kind]] if condition.kind in kinds else []
    return [*found, "negated condition"] if condition.negated else found
