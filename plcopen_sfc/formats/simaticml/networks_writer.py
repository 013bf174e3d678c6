"""Writes logic elements as ``FlgNet``. The reader is `networks_reader`.

The order is that of TIA Portal: operands, parts, then wires, each in the order of the parts and their pins; a wire
stands where its first consumer does. ``UId`` count on from 21.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from lxml import etree

from plcopen_sfc.formats.simaticml.operands import parse_operand, write_operand, write_path
from plcopen_sfc.formats.simaticml.parts import (
    CALLS,
    COILS,
    HINT,
    RESULTS,
    s7_name,
    template_type,
)
from plcopen_sfc.formats.simaticml.reading import NotUnderstoodError
from plcopen_sfc.formats.simaticml.writing import sub
from plcopen_sfc.languages.standard_blocks import StandardBlock, Tool, standard_block
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.network import (
    Block,
    BlockVariable,
    Coil,
    Contact,
    Edge,
    InputPin,
    InputVariable,
    LeftPowerRail,
    LogicNetwork,
    Node,
    OutputVariable,
    Storage,
)

FIRST_UID = 21
_COIL_NAMES = {storage: name for name, storage in COILS.items()}
_CALL_NAMES = {call: name for name, call in CALLS.items()}
_PART_ATTRIBUTES = ("Version", "DisabledENO")


@dataclass
class _End:
    """A pin of a part that is being written, with what comes to it or goes from it."""

    name: str
    sources: list[tuple[int, str | None]] = field(default_factory=list)
    operand: str | None = None
    is_output: bool = False


@dataclass
class _Draft:
    """A part that is being written."""

    node: Node
    name: str
    ends: list[_End]
    kind: str = ""
    uid: str = ""


def write_flgnet(root: etree._Element, network: LogicNetwork) -> None:
    """Fill the ``FlgNet`` element `root`. Raises `NotUnderstoodError` where TIA Portal has no such network."""
    _Writer(root, network).run()


class _Writer:
    def __init__(self, root: etree._Element, network: LogicNetwork) -> None:
        self.root = root
        self.hints = {
            key.removeprefix(HINT): value for key, value in _kept(network.carried).items() if key.startswith(HINT)
        }
        self.rails = {node.id for node in network.nodes if isinstance(node, LeftPowerRail)}
        self.inputs = {node.id: node for node in network.nodes if isinstance(node, InputVariable)}
        plain = (LeftPowerRail, InputVariable, OutputVariable)
        self.drafts = [_draft(node) for node in network.nodes if not isinstance(node, plain)]
        self.by_node = {draft.node.id: draft for draft in self.drafts}
        for draft in self.drafts:
            for end in draft.ends:
                end.sources = [self._source(*source) for source in end.sources]
        self._outputs(network)
        self._wired_outputs()
        self.next = FIRST_UID
        self.access: dict[tuple[int, str], str] = {}

    def _source(self, number: int, pin: str | None) -> tuple[int, str | None]:
        """Where a wire starts, with the name that TIA Portal gives the pin."""
        draft = self.by_node.get(number)
        return (number, _s7_pin(draft.node, pin)) if draft is not None else (number, None)

    def _outputs(self, network: LogicNetwork) -> None:
        """Outputs that are elements of their own become operands at the pin that they are wired to."""
        for node in network.nodes:
            if isinstance(node, OutputVariable):
                wires = node.input.connections if node.input is not None else []
                draft = self.by_node.get(wires[0].source) if len(wires) == 1 else None
                if draft is None or node.negated or node.edge is not Edge.NONE or node.storage is not Storage.NONE:
                    raise NotUnderstoodError("an output variable")
                pin = _s7_pin(draft.node, wires[0].pin)
                end = next((e for e in draft.ends if e.is_output and e.name == pin), None)
                if end is None:
                    end = _End(pin, is_output=True)
                    draft.ends.append(end)
                if end.operand is not None:
                    raise NotUnderstoodError("two output variables at one pin")
                end.operand = node.expression

    def uid(self) -> str:
        """The next ``UId``."""
        self.next += 1
        return str(self.next - 1)

    def _wired_outputs(self) -> None:
        """Outputs that wires start from, of elements that do not list theirs, and a check that all start somewhere."""
        for source, pin in [source for draft in self.drafts for end in draft.ends for source in end.sources]:
            origin = self.by_node.get(source)
            if origin is None:
                if source not in self.rails and source not in self.inputs:
                    raise NotUnderstoodError("a wire from nothing")
            elif pin is not None and not any(e.is_output and e.name == pin for e in origin.ends):
                origin.ends.append(_End(pin, is_output=True))

    def run(self) -> None:
        """Write operands and parts, then the wires between them."""
        parts = sub(self.root, "Parts")
        for draft in self.drafts:
            for end in _in_operand_order(draft):
                if end.operand is not None:
                    self._access(parts, draft, end, end.operand)
                for source, _ in end.sources:
                    if source in self.inputs:
                        self._access(parts, draft, end, self.inputs[source].expression)
        for draft in self.drafts:
            self._part(parts, draft)
        opens = {(d.uid, e.name): self.uid() for d in self.drafts for e in d.ends if self._is_open(d, e)}
        wires = sub(self.root, "Wires") if any(draft.ends for draft in self.drafts) else None
        if wires is not None and (consumers := self._consumers((RAIL_KEY, None))):
            self._wire(wires, ("Powerrail", {}), *consumers)
        for draft in self.drafts:
            for end in draft.ends:
                if wires is not None:
                    self._wires(wires, draft, end, opens)

    def _is_open(self, draft: _Draft, end: _End) -> bool:
        if end.operand is not None or end.sources:
            return False
        return not end.is_output or not self._consumers((draft.node.id, end.name))

    def _access(self, parent: etree._Element, draft: _Draft, end: _End, text: str) -> None:
        number = self.uid()
        self.access[draft.node.id, end.name] = number
        write_operand(parent, text, draft.kind, {"UId": number}, hint=self.hints.get(text))

    def _part(self, parent: etree._Element, draft: _Draft) -> None:
        node = draft.node
        if isinstance(node, Block) and node.call is not None and node.call.value in _CALL_NAMES:
            self._call(parent, draft, node)
            return
        kept = _kept(node.carried)
        marks = {key: kept[key] for key in _PART_ATTRIBUTES if key in kept}
        draft.uid = self.uid()
        element = sub(parent, "Part", {"Name": draft.name, "UId": draft.uid, **marks})
        if isinstance(node, Block):
            if node.instance is not None:
                self._instance(element, node.instance)
            for key, value in kept.items():
                if key not in marks:
                    kind = template_type(key)
                    sub(element, "TemplateValue", {"Name": key, "Type": kind}).text = value
            for variable in (*node.parameters.inputs, *node.parameters.outputs):
                if variable.negated:
                    sub(element, "Negated", {"Name": _s7_pin(node, variable.name)})
        elif isinstance(node, Contact | Coil) and node.negated:
            sub(element, "Negated", {"Name": "operand"})

    def _call(self, parent: etree._Element, draft: _Draft, node: Block) -> None:
        draft.uid = self.uid()
        element = sub(parent, "Call", {"UId": draft.uid})
        call = _CALL_NAMES[node.call.value] if node.call is not None else "FC"
        info = sub(element, "CallInfo", {"Name": node.type_name, "BlockType": call})
        if node.instance is not None:
            self._instance(info, node.instance)
        groups = (("Input", node.parameters.inputs), ("InOut", node.parameters.in_outs))
        for section, variables in (*groups, ("Output", node.parameters.outputs)):
            for variable in variables:
                if variable.name in ("EN", "ENO"):
                    continue
                kept = _kept(variable.carried)
                marks = {"Name": variable.name, "Section": kept.get("Section", section)}
                sub(info, "Parameter", marks | {"Type": kept.get("Type", "Variant")})
                if variable.negated:
                    sub(element, "Negated", {"Name": variable.name})

    def _instance(self, parent: etree._Element, text: str) -> None:
        operand = parse_operand(text)
        if operand is None or not operand.path:
            raise NotUnderstoodError(text)
        write_path(sub(parent, "Instance", {"Scope": operand.scope, "UId": self.uid()}), operand.path)

    def _wires(self, parent: etree._Element, draft: _Draft, end: _End, opens: dict[tuple[str, str], str]) -> None:
        """Write the wires that start at a pin, or end at it from an operand or nowhere."""
        here = ("NameCon", {"UId": draft.uid, "Name": end.name})
        if end.is_output:
            ends = self._consumers((draft.node.id, end.name))
            if end.operand is not None:
                ends.append(("IdentCon", {"UId": self.access[draft.node.id, end.name]}))
            elif not ends:
                ends.append(("OpenCon", {"UId": opens[draft.uid, end.name]}))
            self._wire(parent, here, *ends)
        elif end.operand is not None or any(source in self.inputs for source, _ in end.sources):
            self._wire(parent, ("IdentCon", {"UId": self.access[draft.node.id, end.name]}), here)
        elif not end.sources:
            self._wire(parent, ("OpenCon", {"UId": opens[draft.uid, end.name]}), here)

    def _consumers(self, key: tuple[int, str | None]) -> list[tuple[str, dict[str, str]]]:
        found = []
        for draft in self.drafts:
            for end in draft.ends:
                for source, pin in end.sources:
                    if key == ((RAIL_KEY, None) if source in self.rails else (source, pin)):
                        found.append(("NameCon", {"UId": draft.uid, "Name": end.name}))
        return found

    def _wire(self, parent: etree._Element, *ends: tuple[str, dict[str, str]]) -> None:
        wire = sub(parent, "Wire", {"UId": self.uid()})
        for kind, marks in ends:
            sub(wire, kind, marks)


RAIL_KEY = -1


def _draft(node: Node) -> _Draft:
    if isinstance(node, Contact) and node.edge is Edge.NONE and node.storage is Storage.NONE:
        return _Draft(node, "Contact", [_inlet("in", node.input), _End("operand", operand=node.variable)])
    if isinstance(node, Coil) and node.edge is Edge.NONE:
        if node.variable in RESULTS:
            return _Draft(node, node.variable, [_inlet("in", node.input)])
        name = _COIL_NAMES[node.storage.value]
        return _Draft(node, name, [_inlet("in", node.input), _End("operand", operand=node.variable)])
    if isinstance(node, Block) and node.code is None:
        ends = [_inlet(_s7_pin(node, v.name), v.input) for v in node.parameters.inputs if v.input is not None]
        ends += [_inlet(v.name, v.input) for v in node.parameters.in_outs if v.input is not None]
        ends += [_outlet(node, v) for v in node.parameters.outputs if v.output is not None]
        if any(v.edge is not Edge.NONE or v.storage is not Storage.NONE for v in node.parameters.inputs):
            raise NotUnderstoodError("an edge at a pin")
        block = _standard(node)
        name = s7_name(block) if block is not None else node.type_name
        return _Draft(node, name, ends, _kept(node.carried).get("SrcType", ""))
    raise NotUnderstoodError(node.kind)


def _standard(node: Block) -> StandardBlock | None:
    """The standard block that a block is, if it has the name that IEC 61131-3 gives it."""
    block = standard_block(node.type_name) if node.call is None or node.call.value not in _CALL_NAMES else None
    return block if block is not None and block.name == node.type_name else None


def _s7_pin(node: Node, pin: str | None) -> str:
    """What TIA Portal calls a pin."""
    if not isinstance(node, Block):
        return "out"
    if pin in ("EN", "ENO"):
        return pin.lower()
    block = _standard(node)
    if block is None:
        return pin or "out"
    return block.tool_pin(pin or block.result.name, Tool.S7)


def _inlet(name: str, pin: InputPin | None) -> _End:
    if pin is None:
        return _End(name)
    return _End(name, [(wire.source, wire.pin) for wire in pin.connections], pin.expression)


def _outlet(node: Block, variable: BlockVariable) -> _End:
    operand = variable.output.expression if variable.output is not None else None
    return _End(_s7_pin(node, variable.name), operand=operand, is_output=True)


def _in_operand_order(draft: _Draft) -> list[_End]:
    """The pins in the order of their operands: an edge memory stands behind the operand that is watched."""
    return sorted(draft.ends, key=lambda end: end.name == "bit")


def _kept(carried: Carried | None) -> dict[str, str]:
    return carried.attributes if carried is not None else {}
