"""Reads ``SFC`` bodies: first the symbols as they are drawn, then what they mean. The writer is `chart_writer`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lxml import etree

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.plcopen.carrying import STEP_ACTION_FIELD
from plcopen_sfc.formats.plcopen.logic_reader import (
    IdKeeper,
    read_connection,
    read_geometry,
    read_input,
    read_node,
    read_output,
)
from plcopen_sfc.formats.plcopen.reading import (
    Fields,
    ReadContext,
    attributes,
    carried,
    carry_attributes,
    carry_element,
    markup,
    read_common,
    read_point,
    take_choice,
    take_flag,
    take_integer,
    take_required,
)
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.wiring import trace

QUALIFIERS = ("P1", "N", "P0", "R", "S", "L", "D", "P", "DS", "DL", "SD", "SL")

BARS = {
    kind.value: kind
    for kind in (
        SymbolKind.SELECTION_DIVERGENCE,
        SymbolKind.SELECTION_CONVERGENCE,
        SymbolKind.SIMULTANEOUS_DIVERGENCE,
        SymbolKind.SIMULTANEOUS_CONVERGENCE,
    )
}

BodyReader = Callable[[ReadContext, etree._Element], "Fields | None"]


class ChartReader:
    """Reads one chart. `read_body` reads the bodies inside it (inline actions and conditions, macro-steps)."""

    def __init__(self, ctx: ReadContext, read_body: BodyReader) -> None:
        self.ctx = ctx
        self.read_body = read_body
        self.ids = IdKeeper(ctx)
        self.steps: list[Fields] = []
        self.transitions: list[Fields] = []
        self.nodes: list[Fields] = []
        self.symbols: list[Fields] = []
        self.document_order: list[Fields] = []
        self.blocks: list[tuple[Fields, etree._Element, list[tuple[Fields, Fields, str | None]]]] = []
        self.lines: dict[int, etree._Element] = {}
        self.chart: Fields = {}

    def read(self, element: etree._Element) -> Fields:
        """Read ``SFC``."""
        tags = self.ctx.tags
        for child in element:
            local = tags.get(child.tag)
            if local in _SYMBOLS:
                _SYMBOLS[local](self, child)
            elif local in BARS:
                self.read_bar(child, BARS[local])
            elif local and (node := read_node(self.ctx, child, local)) is not None:
                self._place(child, node)
                self.nodes.append(node)
            else:
                carry_element(self.ctx, self.chart, child)
        self.ids.settle()
        self._settle_references()
        self._resolve_conditions()
        self._resolve_blocks()
        self._resolve_jumps()
        self._resolve_wiring()
        self._check()
        drawing: Fields = {"symbols": self.symbols}
        if self.nodes:
            drawing["order"] = [entry["id"] for entry in self.document_order]
        if self.ctx.finish_chart is not None:
            self.ctx.finish_chart(self.ctx, {"transitions": self.transitions})
        self.chart.update(steps=self.steps, transitions=self.transitions, logic=self.nodes, drawing=drawing)
        return self.chart

    def _place(self, element: etree._Element, fields: Fields) -> None:
        self.ids.claim(element, fields)
        self.document_order.append(fields)
        if "id" in fields:
            self.lines[fields["id"]] = element

    def _symbol(self, element: etree._Element, kind: SymbolKind, left: dict[str, str]) -> Fields:
        symbol: Fields = {"kind": kind}
        self._place(element, symbol)
        left.pop("localId", None)
        if left:
            read_geometry(self.ctx, element, left, symbol)
        self.symbols.append(symbol)
        return symbol

    # -- one method per element ---------------------------------------------------------------------------------------

    def read_step(self, element: etree._Element) -> None:
        """Read ``step``."""
        ctx, tags = self.ctx, self.ctx.tags
        left = attributes(element)
        step: Fields = {"name": take_required(ctx, element, left, "name"), "actions": []}
        if "initialStep" in left:
            step["initial"] = take_flag(ctx, element, left, "initialStep")
        if "negated" in left:
            step["negated"] = take_flag(ctx, element, left, "negated")
        symbol = self._symbol(element, SymbolKind.STEP, left)
        step["symbol_fields"] = symbol
        for child in element:
            local = tags.get(child.tag)
            if local == "position":
                _position(symbol, child)
            elif local == "connectionPointIn":
                symbol.setdefault("inputs", []).append(read_input(ctx, child))
            elif local == "connectionPointOut":
                symbol.setdefault("outputs", []).append(read_output(ctx, child))
            elif local == "connectionPointOutAction":
                symbol["action_output"] = read_output(ctx, child)
            else:
                read_common(ctx, step, child, local, "step")
        if left:
            carry_attributes(step, left)
        _hand_over(step, symbol)
        self.steps.append(step)

    def read_macro_step(self, element: etree._Element) -> None:
        """Read ``macroStep``."""
        ctx, tags = self.ctx, self.ctx.tags
        left = attributes(element)
        macro: Fields = {}
        step: Fields = {"name": left.pop("name", ""), "actions": [], "macro": macro}
        symbol = self._symbol(element, SymbolKind.MACRO_STEP, left)
        step["symbol_fields"] = symbol
        for child in element:
            local = tags.get(child.tag)
            if local == "position":
                _position(symbol, child)
            elif local == "connectionPointIn":
                symbol.setdefault("inputs", []).append(read_input(ctx, child))
            elif local == "connectionPointOut":
                symbol.setdefault("outputs", []).append(read_output(ctx, child))
            elif local == "body":
                macro["body"] = self.read_body(ctx, child)
            else:
                read_common(ctx, step, child, local, "macroStep")
        carry_attributes(step, left)
        _hand_over(step, symbol)
        self.steps.append(step)

    def read_transition(self, element: etree._Element) -> None:
        """Read ``transition``."""
        ctx, tags = self.ctx, self.ctx.tags
        left = attributes(element)
        transition: Fields = {}
        if "priority" in left:
            transition["priority"] = take_integer(ctx, element, left, "priority")
        symbol = self._symbol(element, SymbolKind.TRANSITION, left)
        transition["symbol_fields"] = symbol
        for child in element:
            local = tags.get(child.tag)
            if local == "position":
                _position(symbol, child)
            elif local == "connectionPointIn":
                symbol.setdefault("inputs", []).append(read_input(ctx, child))
            elif local == "connectionPointOut":
                symbol.setdefault("outputs", []).append(read_output(ctx, child))
            elif local == "condition":
                self.read_condition(child, transition, symbol)
            else:
                read_common(ctx, transition, child, local, "transition")
        if left:
            carry_attributes(transition, left)
        _hand_over(transition, symbol)
        self.transitions.append(transition)

    def read_condition(self, element: etree._Element, transition: Fields, symbol: Fields) -> None:
        """Read ``condition``. A wired one is looked at again when all elements are known."""
        ctx = self.ctx
        left = attributes(element)
        negated = take_flag(ctx, element, left, "negated")
        condition: Fields | None = None
        for child in element:
            local = ctx.tags.get(child.tag)
            if local == "reference" and condition is None:
                condition = {"kind": "named", "name": child.get("name", "")}
            elif local == "inline" and condition is None:
                condition = self._inline_condition(child, symbol)
            elif local == "connectionPointIn" and condition is None:
                condition = {"kind": "wired", "input": read_input(ctx, child)}
            elif local == "connection" and (connection := read_connection(ctx, child)) is not None:
                # TC6 1.01 has the wires directly below the condition
                if condition is None:
                    condition = {"kind": "wired", "input": {"connections": []}}
                condition["input"]["connections"].append(connection)
            else:
                carry_element(ctx, transition, child)
        if condition is not None:
            condition["negated"] = negated
            transition["condition"] = condition
        if left:
            carry_attributes(transition, left)

    def _inline_condition(self, element: etree._Element, symbol: Fields) -> Fields:
        body = self.read_body(self.ctx, element) or {"language": "ST", "text": ""}
        name = element.get("name", "")
        plain = set(body) <= {"language", "text"}
        if body["language"] == "ST" and plain:
            if name:
                symbol["name"] = name
            return {"kind": "expression", "text": body["text"]}
        return {"kind": "body", "body": body, "name": name}

    def read_jump(self, element: etree._Element) -> None:
        """Read ``jumpStep``."""
        left = attributes(element)
        target = take_required(self.ctx, element, left, "targetName")
        symbol = self._symbol(element, SymbolKind.JUMP, left)
        symbol["name"] = target
        self._read_flow(element, symbol, "jumpStep")
        if left:
            carry_attributes(symbol, left)

    def read_bar(self, element: etree._Element, kind: SymbolKind) -> None:
        """Read one of the four kinds of divergences and convergences."""
        left = attributes(element)
        name = left.pop("name", None) if kind is SymbolKind.SIMULTANEOUS_DIVERGENCE else None
        symbol = self._symbol(element, kind, left)
        if name is not None:
            symbol["name"] = name
        self._read_flow(element, symbol, kind.value)
        if left:
            carry_attributes(symbol, left)

    def _read_flow(self, element: etree._Element, symbol: Fields, owner: str) -> None:
        ctx = self.ctx
        for child in element:
            local = ctx.tags.get(child.tag)
            if local == "position":
                _position(symbol, child)
            elif local == "connectionPointIn":
                symbol.setdefault("inputs", []).append(read_input(ctx, child))
            elif local == "connectionPointOut" and owner != "jumpStep":
                symbol.setdefault("outputs", []).append(read_output(ctx, child))
            else:
                read_common(ctx, symbol, child, local, owner)

    def read_action_block(self, element: etree._Element) -> None:
        """Read ``actionBlock``. Its associations go to their step when all elements are known."""
        ctx = self.ctx
        left = attributes(element)
        negated = take_flag(ctx, element, left, "negated")
        symbol = self._symbol(element, SymbolKind.ACTION_BLOCK, left)
        entries: list[tuple[Fields, Fields, str | None]] = []
        for child in element:
            local = ctx.tags.get(child.tag)
            if local == "position":
                _position(symbol, child)
            elif local == "connectionPointIn":
                symbol.setdefault("inputs", []).append(read_input(ctx, child))
            elif local == "connectionPointOut":
                symbol.setdefault("outputs", []).append(read_output(ctx, child))
            elif local == "action":
                entries.append(self.read_action(child))
            else:
                read_common(ctx, symbol, child, local, "actionBlock")
        if left:
            carry_attributes(symbol, left)
        if negated:
            for association, _, _ in entries:
                association["negated"] = True
        self.blocks.append((symbol, element, entries))

    def read_action(self, element: etree._Element) -> tuple[Fields, Fields, str | None]:
        """Read ``action`` of a block: the association, where it is drawn, and its ``localId``."""
        ctx = self.ctx
        left = attributes(element)
        association: Fields = {}
        entry: Fields = {}
        local_id = left.pop("localId", None)
        qualifier = take_choice(ctx, element, left, "qualifier", QUALIFIERS)
        if qualifier is not None:
            association["qualifier"] = qualifier
        duration = left.pop("duration", None)
        if duration:
            association["duration"] = duration
        indicator = left.pop("indicator", None)
        if indicator:
            association["indicator"] = indicator
        read_geometry(ctx, element, left, entry)
        for child in element:
            local = ctx.tags.get(child.tag)
            if local == "relPosition":
                point = read_point(child)
                if point is not None and any(point):
                    entry["position"] = point
            elif local == "reference":
                association["target"] = child.get("name", "")
            elif local == "inline":
                association["body"] = self.read_body(ctx, child)
            elif local == "connectionPointOut":
                entry["output"] = read_output(ctx, child)
            else:
                read_common(ctx, association, child, local, "action")
        if left:
            carry_attributes(association, left)
        return association, entry, local_id

    # -- what the symbols mean ----------------------------------------------------------------------------------------

    def _settle_references(self) -> None:
        """Give steps and transitions the ids of their symbols, now that all ids are known."""
        for thing in (*self.steps, *self.transitions):
            thing["id"] = thing.pop("symbol_fields")["id"]

    def _resolve_conditions(self) -> None:
        """Tell expressions that only feed one condition from graphical logic."""
        consumers: dict[int, int] = {}
        for holder in (*self.symbols, *self.nodes):
            for connection in _connections(holder):
                consumers[connection["source"]] = consumers.get(connection["source"], 0) + 1
        wired: list[tuple[Fields, Fields, int]] = []
        symbol_of = {symbol["id"]: symbol for symbol in self.symbols}
        for transition in self.transitions:
            condition = transition.get("condition")
            if condition is None or condition["kind"] != "wired":
                continue
            connections = condition["input"].get("connections", ())
            for connection in connections:
                consumers[connection["source"]] = consumers.get(connection["source"], 0) + 1
            if len(connections) == 1:
                wired.append((transition, symbol_of[transition["id"]], connections[0]["source"]))
        expressions = {node["id"]: node for node in self.nodes if _is_plain_expression(node)}
        used: set[int] = set()
        for transition, symbol, source in wired:
            node = expressions.get(source)
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
                    node["kind"] = SymbolKind.EXPRESSION
                    node["outputs"] = [node.pop("output")] if "output" in node else []
                    for name in ("expression", "edge", "storage"):
                        node.pop(name, None)
            self.nodes = [node for node in self.nodes if node["id"] not in used]
            logic = {id(node) for node in self.nodes}
            self.symbols = [entry for entry in self.document_order if id(entry) not in logic]

    def _resolve_blocks(self) -> None:
        steps = {step["id"]: step for step in self.steps}
        for symbol, element, entries in self.blocks:
            owners = {c["source"] for c in _connections(symbol) if c["source"] in steps}
            if len(owners) != 1:
                self._carry_block(symbol, element, len(owners))
                continue
            step = steps[owners.pop()]
            carried_entries = symbol.pop("entries", None)
            symbol["entries"] = []
            for association, entry, local_id in entries:
                if self._is_step_action(step, association, entry):
                    if carried_entries is None:
                        entry["association"] = self._entry_id(entry, local_id)
                        symbol["entries"].append(entry)
                    continue
                if carried_entries is not None and "id" in association:
                    # TC6 1.01 has no ids at actions: both come back from what was carried
                    step["actions"].append(association)
                    self.ids.used.add(association["id"])
                    continue
                association["id"] = entry["association"] = self._entry_id(entry, local_id)
                step["actions"].append(association)
                symbol["entries"].append(entry)
            if carried_entries is not None:
                symbol["entries"] = carried_entries

    def _entry_id(self, entry: Fields, local_id: str | None) -> int:
        """The id of a line of a block: its ``localId``, or a new one where that is missing or taken."""
        number = int(local_id) if local_id and local_id.isascii() and local_id.isdigit() else None
        if number is None or number in self.ids.used:
            entry["local_id"] = number
            return self.ids.new()
        self.ids.used.add(number)
        return number

    def _is_step_action(self, step: Fields, association: Fields, entry: Fields) -> bool:
        """Make a marked association the step action again that it stands for."""
        kind = association.pop(STEP_ACTION_FIELD, None)
        if kind not in ("entry", "main", "exit"):
            return False
        entry["step_action"] = kind
        step[f"{kind}_action"] = association.get("target", association.get("body"))
        return True

    def _carry_block(self, symbol: Fields, element: etree._Element, owners: int) -> None:
        what = "is wired to no step" if not owners else f"is wired to {owners} steps"
        self.ctx.error("SFC108", f"an action block {what}; it is kept in the file but not part of the chart", element)
        self.symbols.remove(symbol)
        self.document_order.remove(symbol)
        carried(self.chart)["elements"].append(markup(element))

    def _resolve_jumps(self) -> None:
        by_name: dict[str, int] = {}
        names = {step["id"]: step["name"] for step in self.steps}
        for step in self.steps:
            by_name.setdefault(step["name"].casefold(), step["id"])
        for symbol in self.symbols:
            if symbol["kind"] is SymbolKind.SIMULTANEOUS_DIVERGENCE and symbol.get("name"):
                by_name.setdefault(symbol["name"].casefold(), symbol["id"])
                names.setdefault(symbol["id"], symbol["name"])
        for symbol in self.symbols:
            if symbol["kind"] is not SymbolKind.JUMP:
                continue
            target = by_name.get(symbol["name"].casefold())
            if target is None:
                self._error("SFC103", f"a jump leads to {symbol['name']!r}, which is no step of this chart", symbol)
                continue
            symbol["target"] = target
            if names[target] == symbol["name"]:
                del symbol["name"]

    def _resolve_wiring(self) -> None:
        kinds = {symbol["id"]: symbol["kind"] for symbol in self.symbols}
        wiring = trace(
            kinds,
            {
                s["id"]: [c["source"] for pin in s.get("inputs", ()) for c in pin.get("connections", ())]
                for s in self.symbols
            },
            {s["id"]: s.get("target") for s in self.symbols if s["kind"] is SymbolKind.JUMP},
        )
        symbol_of = {symbol["id"]: symbol for symbol in self.symbols}
        expanded: list[Fields] = []
        for transition in self.transitions:
            links = wiring.links[transition["id"]]
            for position, link in enumerate(links):
                one = transition if position == 0 else {**transition, "id": self.ids.new()}
                one["sources"], one["targets"] = link.sources, link.targets
                expanded.append(one)
            if len(links) > 1:
                symbol_of[transition["id"]]["transitions"] = [t["id"] for t in expanded[-len(links) :]]
        self.transitions = expanded
        for problem in wiring.problems:
            severity = Severity.WARNING if problem.code == "SFC104" else Severity.ERROR
            self._say(problem.code, severity, problem.detail, symbol_of[problem.symbol])

    # -- what is wrong with the chart ---------------------------------------------------------------------------------

    def _check(self) -> None:
        known = self.ids.used
        for holder in (*self.symbols, *self.nodes):
            for connection in _connections(holder):
                if connection["source"] not in known:
                    self._error(
                        "SFC102", f"a connection leads to element {connection['source']}, which does not exist", holder
                    )
        for transition in self.transitions:
            condition = transition.get("condition")
            if condition is None:
                self._error("SFC112", "a transition has no condition", transition)
        self._check_names()
        self._check_initial()

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
            parent: dict[int, int] = {step["id"]: step["id"] for step in self.steps}

            def root(node: int) -> int:
                while parent[node] != node:
                    parent[node] = node = parent[parent[node]]
                return node

            for transition in self.transitions:
                linked = [root(i) for i in (*transition["sources"], *transition["targets"])]
                for other in linked[1:]:
                    parent[root(other)] = root(linked[0])
            first: dict[int, Any] = {}
            for step in initial:
                other = first.setdefault(root(step["id"]), step)
                if other is not step:
                    self._error("SFC110", f"{step['name']!r} is a second initial step, besides {other['name']!r}", step)
        elif self.steps and not initial:
            self._say("SFC111", Severity.WARNING, "the chart has no initial step", self.steps[0])

    def _error(self, code: str, message: str, fields: Fields) -> None:
        self._say(code, Severity.ERROR, message, fields)

    def _say(self, code: str, severity: Severity, message: str, fields: Fields) -> None:
        element = self.lines.get(fields["id"])
        if element is None:
            element = next(iter(self.lines.values()))
        name = fields.get("name")
        subject = f"{etree.QName(element).localname} {name or fields['id']}"
        self.ctx.report(code, severity, message, element, subject)


_SYMBOLS: dict[str | None, Callable[[ChartReader, etree._Element], None]] = {
    "step": ChartReader.read_step,
    "macroStep": ChartReader.read_macro_step,
    "transition": ChartReader.read_transition,
    "jumpStep": ChartReader.read_jump,
    "actionBlock": ChartReader.read_action_block,
}


def _hand_over(thing: Fields, symbol: Fields) -> None:
    """Give the symbol what TC6 1.01 carries of it at the step or transition."""
    if "execution_order" in thing:
        symbol["execution_order"] = thing.pop("execution_order")


def _position(symbol: Fields, element: etree._Element) -> None:
    point = read_point(element)
    if point is not None:
        symbol["position"] = point


def _connections(holder: Fields) -> list[Fields]:
    """All wires that end at an element, whatever its pins are."""
    pins = [*holder.get("inputs", ())]
    if "input" in holder:
        pins.append(holder["input"])
    for group in (holder.get("parameters") or {}).values():
        pins.extend(parameter["input"] for parameter in group if "input" in parameter)
    return [connection for pin in pins for connection in pin.get("connections", ())]


def _is_plain_expression(node: Fields) -> bool:
    """Whether an ``inVariable`` says nothing but its expression, so that it can be the text of a condition."""
    return (
        node["kind"] == "input"
        and not node.get("negated")
        and node.get("edge") == "none"
        and node.get("storage") == "none"
        and not node.keys() & {"comment", "carried", "global_id", "local_id"}
    )
