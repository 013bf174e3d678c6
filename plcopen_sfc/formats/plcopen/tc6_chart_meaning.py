"""Meaning of the symbols of a chart, once all are read: its steps, transitions, conditions, and its errors.

`tc6_charts` fills a `DrawnChart` element by element; `DrawnChart.interpret` makes the fields of the chart of it.
"""

from __future__ import annotations

from collections import Counter
from itertools import chain
from typing import Any

from lxml import etree

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.plcopen.tc6_pins import IdKeeper
from plcopen_sfc.formats.plcopen.tc6_reading import (
    STEP_ACTION_FIELD,
    STEP_ACTION_QUALIFIERS,
    Fields,
    Tc6ReadContext,
    neutral,
)
from plcopen_sfc.formats.xml.extension_data import extension_data, markup
from plcopen_sfc.grouping import Clusters
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.drawing import Places, StepActionKind, SymbolKind
from plcopen_sfc.model.exclusion import HOLDERS
from plcopen_sfc.model.wiring import Branches, trace
from plcopen_sfc.whole_numbers import xml_number

Line = tuple[Fields, Fields, str | None]
"""A line of an action block: the association, where it is drawn, and its ``localId``."""

UNREAD = "\0unread"
"""At a symbol or a line of a block of which only what the chart does is read: the place of its element around it.

Elements themselves would be a quarter of the objects that reading a chart makes. No field in a file has such a name.
"""
_NOTHING: Fields = {}
_STEP_ACTION_KINDS = tuple(StepActionKind)
_JUMP, _DIVERGENCE = SymbolKind.JUMP.value, SymbolKind.SIMULTANEOUS_DIVERGENCE.value
"""Kinds in a loop: members of an enumeration take longer to get and to compare."""


class DrawnChart:
    """The symbols of one chart as they were read, with wires and names not yet followed."""

    def __init__(self, ctx: Tc6ReadContext) -> None:
        self.ctx = ctx
        self.ids = IdKeeper(ctx)
        self.chart: Fields = {}
        self.steps: list[Fields] = []
        self.transitions: list[Fields] = []
        self.nodes: list[Fields] = []
        self.symbols: list[Fields] = []
        self.blocks: list[tuple[Fields, etree._Element, list[Line]]] = []
        self.document_order: list[Fields] = []
        self.elements: dict[int, etree._Element] = {}
        self.wires: dict[int, list[int]] = {}
        """The ids that the wires into each element come from, by its `id()`."""

    def place(self, element: etree._Element, fields: Fields, local_id: str | None) -> None:
        """Take an element in: give it its id and its place in the order of the file."""
        self.ids.claim(element, fields, local_id)
        self.document_order.append(fields)
        if "id" in fields:
            self.elements[fields["id"]] = element

    def take(self, element: etree._Element, symbol: Fields) -> None:
        """Take in a symbol that has its id, which no other has."""
        self.ids.used.add(symbol["id"])
        self.document_order.append(symbol)
        self.symbols.append(symbol)
        self.elements.setdefault(symbol["id"], element)

    def interpret(self) -> Fields:
        """Return the fields of the chart; what is wrong with it goes to the context."""
        self.ids.settle()
        for holder in (*self.symbols, *self.nodes):
            if id(holder) not in self.wires:
                self.wires[id(holder)] = _sources(holder)
        for thing in (*self.steps, *self.transitions):  # all ids are known now
            thing["id"] = thing.pop("symbol_fields")["id"]
        self._resolve_conditions()
        self._resolve_blocks()
        self._resolve_jumps()
        self._resolve_exclusion()
        self._resolve_wiring()
        self._check()
        # a tool that exports no layout puts everything at 0, 0
        drawing: Fields = {"symbols": self.symbols, "places": Places.NONE if self.ctx.tool.placeless else Places.GIVEN}
        if self.nodes:
            drawing["order"] = [entry["id"] for entry in self.document_order]
        self.ctx.tool.finish_chart(self.ctx, {"transitions": self.transitions})
        self.chart.update(steps=self.steps, transitions=self.transitions, logic=self.nodes, drawing=drawing)
        return self.chart

    def _resolve_conditions(self) -> None:
        """Tell expressions that only feed one condition from graphical logic."""
        if not any(t.get("condition", _NOTHING).get("kind") == "wired" for t in self.transitions):
            return
        consumers = Counter(chain.from_iterable(self.wires.values()))
        wired: list[tuple[Fields, Fields, int]] = []
        symbol_of = {symbol["id"]: symbol for symbol in self.symbols}
        for transition in self.transitions:
            condition = transition.get("condition")
            if condition is None or condition.get("kind") != "wired":
                continue
            connections = condition["input"].get("connections", ())
            for connection in connections:
                consumers[connection["source"]] += 1
            if len(connections) == 1:
                wired.append((transition, symbol_of[transition["id"]], connections[0]["source"]))
        expressions = {node["id"]: node for node in self.nodes if _is_plain_expression(node)}
        used: set[int] = set()
        for transition, symbol, source in wired:
            node = expressions.get(source)
            # a box of text that feeds something else too is logic: an edit of this condition must not change the other
            if node is None or consumers[source] != 1:
                continue
            condition = transition["condition"]
            symbol["condition"] = condition["input"]
            transition["condition"] = {
                "kind": "expression",
                "text": node["expression"],
                "negated": condition["negated"],
            }
            used.add(source)
        if used:
            for node in self.nodes:
                if node["id"] in used:
                    node["kind"] = SymbolKind.EXPRESSION.value
                    node["outputs"] = [node.pop("output")] if "output" in node else []
                    for name in ("expression", "edge", "storage"):
                        node.pop(name, None)
            self.nodes = [node for node in self.nodes if node["id"] not in used]
            logic = {id(node) for node in self.nodes}
            self.symbols = [entry for entry in self.document_order if id(entry) not in logic]

    def _resolve_blocks(self) -> None:
        steps = {step["id"]: step for step in self.steps}
        for symbol, element, entries in self.blocks:
            owners = {source for source in self.wires[id(symbol)] if source in steps}
            if len(owners) != 1:
                self._keep_block(symbol, element, len(owners))
                continue
            step = steps[owners.pop()]
            kept_entries = symbol.pop("entries", None)
            symbol["entries"] = []
            for association, entry, local_id in entries:
                if self._is_step_action(step, association, entry, symbol):
                    if kept_entries is None:
                        entry["association"] = self._entry_id(entry, local_id)
                        symbol["entries"].append(entry)
                    continue
                if kept_entries is not None and "id" in association:
                    # TC6 1.01 has no ids at actions: both come back from extension data
                    step["actions"].append(association)
                    self.ids.used.add(association["id"])
                    continue
                association["id"] = entry["association"] = self._entry_id(entry, local_id)
                step["actions"].append(association)
                symbol["entries"].append(entry)
            if kept_entries is not None:
                symbol["entries"] = kept_entries

    def _entry_id(self, entry: Fields, local_id: str | None) -> int:
        """Return the id of a line of a block: its ``localId``, or a new one where that is missing or taken."""
        number = xml_number(local_id)
        if not number or number in self.ids.used:
            # 0 is what Beremiz writes at every action: an id without meaning
            entry["local_id"] = None if self.ctx.version.first_generation else number or 0
            return self.ids.new()
        self.ids.used.add(number)
        return number

    def _is_step_action(self, step: Fields, association: Fields, entry: Fields, symbol: Fields) -> bool:
        """Make a marked association the step action again that it replaces."""
        kind = association.pop(STEP_ACTION_FIELD, None)
        if kind not in _STEP_ACTION_KINDS:
            return False
        qualifier = association.get("qualifier", Qualifier.N)
        is_other = qualifier != STEP_ACTION_QUALIFIERS[StepActionKind(kind)]
        if is_other or any(association.get(name) for name in ("duration", "indicator", "negated")):
            what = f"a row of the step {step['name']} is no longer its {kind} action: it was edited in this file"
            self._say("XML214", Severity.WARNING, f"{what}; the edit counts", symbol)
            return False
        entry["step_action"] = kind
        step[f"{kind}_action"] = association.get("target", association.get("body"))
        return True

    def _keep_block(self, symbol: Fields, element: etree._Element, owners: int) -> None:
        what = "is wired to no step" if not owners else f"is wired to {owners} steps"
        self.ctx.error("SFC108", f"an action block {what}; it is kept in the file but not part of the chart", element)
        self.symbols.remove(symbol)
        self.document_order.remove(symbol)
        extension_data(self.chart)["elements"].append(neutral(markup(element), self.ctx.version))

    def _resolve_jumps(self) -> None:
        by_name: dict[str, int] = {}
        names = {step["id"]: step["name"] for step in self.steps}
        for step in self.steps:
            by_name.setdefault(step["name"].casefold(), step["id"])
        for symbol in self.symbols:
            if symbol["kind"] == _DIVERGENCE and symbol.get("name"):
                by_name.setdefault(symbol["name"].casefold(), symbol["id"])
                names.setdefault(symbol["id"], symbol["name"])
        for symbol in self.symbols:
            if symbol["kind"] != _JUMP:
                continue
            target = by_name.get(symbol["name"].casefold())
            if target is None:
                self._error("SFC103", f"a jump leads to {symbol['name']!r}, which is no step of this chart", symbol)
                continue
            symbol["target"] = target
            if names[target] == symbol["name"]:
                del symbol["name"]

    def _resolve_exclusion(self) -> None:
        holders = [symbol["id"] for symbol in self.symbols if symbol.get("exclude") and symbol["kind"] in HOLDERS]
        if not holders:
            return
        kinds = {symbol["id"]: symbol["kind"] for symbol in self.symbols}
        branches = Branches(kinds, {symbol["id"]: self.wires[id(symbol)] for symbol in self.symbols})
        held = set().union(*(branches.held_by(number) for number in holders))
        for thing in (*self.steps, *self.transitions):
            if thing["id"] in held:
                thing["exclude"] = True

    def _resolve_wiring(self) -> None:
        kinds = {symbol["id"]: symbol["kind"] for symbol in self.symbols}
        wiring = trace(
            kinds,
            {symbol["id"]: self.wires[id(symbol)] for symbol in self.symbols},
            {s["id"]: s.get("target") for s in self.symbols if s["kind"] == _JUMP},
        )
        symbol_of = {symbol["id"]: symbol for symbol in self.symbols}
        expanded: list[Fields] = []
        for transition in self.transitions:
            links = wiring.links[transition["id"]]
            kept = symbol_of[transition["id"]].pop("transitions", [])
            for position, link in enumerate(links):
                number = kept[position] if len(kept) == len(links) else self.ids.new() if position else transition["id"]
                one = transition if position == 0 else {**transition, "id": number}
                one["sources"], one["targets"] = link.sources, link.targets
                expanded.append(one)
            if len(links) > 1:
                symbol_of[transition["id"]]["transitions"] = [t["id"] for t in expanded[-len(links) :]]
        self.transitions = expanded
        for problem in wiring.problems:
            severity = Severity.WARNING if problem.code == "SFC104" else Severity.ERROR
            self._say(problem.code, severity, problem.detail, symbol_of[problem.symbol])

    def _check(self) -> None:
        known = self.ids.used
        leads_on = known.issuperset(chain.from_iterable(self.wires.values()))
        for holder in () if leads_on else (*self.symbols, *self.nodes):
            for source in self.wires[id(holder)]:
                if source not in known:
                    self._leads_to_nothing("a connection", source, holder)
        for transition in self.transitions:
            condition = transition.get("condition")
            if condition is None:
                self._error("SFC112", "a transition has no condition", transition)
            elif condition["kind"] == "wired":
                wires = condition["input"].get("connections", ())
                for connection in wires:
                    if connection["source"] not in known:
                        self._leads_to_nothing("the wire of a condition", connection["source"], transition)
                if not wires and "expression" not in condition["input"]:
                    self._error("SFC112", "the condition of a transition is wired to nothing", transition)
        self._check_names()
        self._check_initial()

    def _leads_to_nothing(self, what: str, source: int, holder: Fields) -> None:
        self._error("SFC102", f"{what} leads to element {source}, which does not exist", holder)

    def _check_names(self) -> None:
        seen: dict[str, str] = {}
        for step in self.steps:
            key = step["name"].casefold()
            if key in seen and key:
                self._error("SFC109", f"two steps have the name {step['name']!r}", step)
            seen[key] = step["name"]

    def _check_initial(self) -> None:
        initial = [step for step in self.steps if step.get("initial")]
        if len(initial) > 1:
            parts = Clusters(step["id"] for step in self.steps)
            for transition in self.transitions:
                parts.unite((*transition["sources"], *transition["targets"]))
            first: dict[int, Any] = {}
            for step in initial:
                other = first.setdefault(parts.root(step["id"]), step)
                if other is not step:
                    self._error("SFC110", f"{step['name']!r} is a second initial step, besides {other['name']!r}", step)
        elif self.steps and not initial:
            self._say("SFC111", Severity.WARNING, "the chart has no initial step", self.steps[0])

    def _error(self, code: str, message: str, fields: Fields) -> None:
        self._say(code, Severity.ERROR, message, fields)

    def _say(self, code: str, severity: Severity, message: str, fields: Fields) -> None:
        element = self.elements.get(fields["id"])
        if element is None:
            element = next(iter(self.elements.values()))
        name = fields.get("name")
        subject = f"{etree.QName(element).localname} {name or fields['id']}"
        self.ctx.report(code, severity, message, element, subject)


def _sources(holder: Fields) -> list[int]:
    """Return the ids that the wires into an element come from, whatever its pins are."""
    pins = [*holder.get("inputs", ())]
    if holder.get("kind") not in _SYMBOL_KINDS:
        if "input" in holder:
            pins.append(holder["input"])
        for group in (holder.get("parameters") or {}).values():
            pins.extend(parameter["input"] for parameter in group if "input" in parameter)
    return [wire["source"] for pin in pins for wire in pin.get("connections", ())]


_SYMBOL_KINDS = tuple(SymbolKind)


def _is_plain_expression(node: Fields) -> bool:
    """True if an ``inVariable`` has nothing but its expression, so that it can be the text of a condition."""
    return (
        node["kind"] == "input"
        and not node.get("negated")
        and node.get("edge") == "none"
        and node.get("storage") == "none"
        and not node.keys() & {"comment", "extension_data", "global_id", "local_id"}
    )
