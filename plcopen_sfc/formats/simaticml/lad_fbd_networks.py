"""One network of LAD or FBD: read with the parts that our writer would write differently, and written as ``FlgNet``.

`flgnet_reader` reads ``FlgNet``. The order of what is written is that of TIA Portal: operands, parts, then wires, each
in the order of the parts and their pins; a wire is where its first consumer is. ``UId`` count on from 21.
"""

from __future__ import annotations

import marshal
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any
from xml.etree import ElementTree as ET

from lxml import etree

from plcopen_sfc.formats.simaticml.box_types import give_types, type_of_box, type_of_literal
from plcopen_sfc.formats.simaticml.coils_and_contacts import writes_bits_on_a_condition
from plcopen_sfc.formats.simaticml.element_reader import (
    DocumentReading,
    Fields,
    NotUnderstoodError,
    XmlNode,
    child_named,
    keep_attribute,
    keep_verbatim,
    merge_fields,
    opaque_body,
    read_comments,
)
from plcopen_sfc.formats.simaticml.element_writer import DocumentWriting, add_element, keep_fields, sub, verbatim
from plcopen_sfc.formats.simaticml.flgnet_reader import JUMP_PIN, DamagedError, read_flgnet
from plcopen_sfc.formats.simaticml.network_boxes import (
    CALL_MARKS,
    CALLS,
    COILS,
    CONVERT,
    INVERTED,
    LISTS,
    PART_NAME,
    RESULTS,
    s7_name,
    template_type,
)
from plcopen_sfc.formats.simaticml.network_operands import (
    Hints,
    literal_type,
    operand_hints,
    parse_operand,
    write_operand,
    write_path,
)
from plcopen_sfc.formats.simaticml.program_comparison import (
    FIRST,
    NUMBERS,
    is_identical,
    numbers_like,
    numbers_of,
    parse_program,
    program_text,
    renumber,
    shortened,
)
from plcopen_sfc.formats.xml.extension_data import attributes_of, extension_data
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.standard_blocks import S7_CONVERTED, S7_VERSION, StandardBlock, Tool, standard_block
from plcopen_sfc.model.body import FbdBody, LdBody, OpaqueBody
from plcopen_sfc.model.network import (
    Block,
    BlockVariable,
    Coil,
    CommentBox,
    Contact,
    Edge,
    InputPin,
    InputVariable,
    Jump,
    Label,
    LeftPowerRail,
    LogicNetwork,
    Node,
    OutputVariable,
    Return,
    RightPowerRail,
    Storage,
)
from plcopen_sfc.model.sfc import Body
from plcopen_sfc.report import Outcome

_COIL_NAMES = {storage: name for name, storage in COILS.items()}
_CALL_NAMES = {call: name for name, call in CALLS.items()}
_PART_ATTRIBUTES = ("Version", "DisabledENO")
_NO_TEMPLATES = frozenset({*_PART_ATTRIBUTES, *LISTS, *CALL_MARKS, "Equation", INVERTED, PART_NAME})
_TIMERS = frozenset({"TON", "TOF", "TP"})
_MOVE = "Move"
_UNTYPED = frozenset({"A", "O", "X", "Not"})
"""Operators that are Boolean as such."""
_COUNTED = frozenset({"AND", "OR", "XOR", "ADD", "MUL"})
"""Operators with any number of inputs."""


@dataclass(slots=True)
class _End:
    """A pin of a part that is being written, with the wires and the operand at it."""

    name: str
    sources: list[tuple[int, str | None]] = field(default_factory=list)
    operand: str | None = None
    is_output: bool = False


@dataclass(slots=True)
class _Draft:
    """A part that is being written."""

    node: Node
    name: str
    ends: list[_End]
    kind: str = ""
    uid: str = ""
    number: int = -1
    """Id of the element, or one below all ids where the element is none of the network."""
    is_inverted: bool = False
    """True if the input of a coil is negated."""


def write_flgnet(root: XmlNode, network: LogicNetwork, types: Mapping[str, str] | None = None) -> bool:
    """Fill the ``FlgNet`` element `root`. Raises `NotUnderstoodError` where TIA Portal has no such network.

    `types` are those of variables (``#x``) as TIA Portal spells them, for boxes that need their type.
    Returns True if the hints of the network made a difference.
    """
    if writes_bits_on_a_condition(network):
        raise NotUnderstoodError("a box with EN that writes a bit")
    writer = _Writer(root, network, types or {})
    writer.run()
    return writer.hints_matter


class _Writer:
    def __init__(self, root: XmlNode, network: LogicNetwork, types: Mapping[str, str]) -> None:
        self.root = root
        self.types = types
        self.numbers = attributes_of(network.extension_data).get(NUMBERS, "")
        self.hints = Hints(attributes_of(network.extension_data))
        self.hints_matter = False
        self.labels = [node for node in network.nodes if isinstance(node, Label)]
        self.rails = {node.id for node in network.nodes if isinstance(node, LeftPowerRail)}
        self.inputs = {node.id: node for node in network.nodes if isinstance(node, InputVariable)}
        plain = (LeftPowerRail, RightPowerRail, InputVariable, OutputVariable, Label)
        self.drafts = [_draft(node) for node in network.nodes if not isinstance(node, plain)]
        for draft in self.drafts:
            draft.number = draft.node.id
        self.by_node = {draft.number: draft for draft in self.drafts}
        for draft in self.drafts:
            for end in draft.ends:
                end.sources = [self._source(*source) for source in end.sources]
        # in this order: a join is made of the wires that are left, and gets the pins that it needs last
        self._fold_inverters()
        self._enable_moves()
        self._outputs(network)
        self._join()
        self._wired_outputs()  # last: it needs the sources as the others leave them
        self.consumers = grouped(
            ((RAIL_KEY, None) if source in self.rails else (source, pin), (draft, end))
            for draft in self.drafts
            for end in draft.ends
            for source, pin in end.sources
        )
        self.next = FIRST
        self.access: dict[tuple[int, str], str] = {}

    def _source(self, number: int, pin: str | None) -> tuple[int, str | None]:
        """Return the source of a wire, with the name that TIA Portal gives the pin."""
        draft = self.by_node.get(number)
        return (number, _s7_pin(draft.node, pin)) if draft is not None else (number, None)

    def _fold_inverters(self) -> None:
        """Turn a NOT that was read from the negated input of a coil into that again."""
        for draft in [draft for draft in self.drafts if INVERTED in attributes_of(draft.node.extension_data)]:
            ends = [(d, end) for d in self.drafts for end in d.ends if any(s == draft.number for s, _ in end.sources)]
            inlet = next((end for end in draft.ends if not end.is_output), None)
            if len(ends) == 1 and inlet is not None:
                coil, end = ends[0]
                if isinstance(coil.node, Coil) and end.name == "in" and len(end.sources) == 1:
                    end.sources, end.operand = inlet.sources, inlet.operand
                    coil.is_inverted = True
                    self.drafts.remove(draft)
                    del self.by_node[draft.number]

    def _enable_moves(self) -> None:
        """Give new ``Move`` boxes the pins that all have: EN, on the rail in LAD, and ENO only where it is wired."""
        wired = {source for draft in self.drafts for end in draft.ends for source in end.sources}
        for draft in self.drafts:
            if draft.name != _MOVE or attributes_of(draft.node.extension_data):
                continue
            if not any(end.name == "en" for end in draft.ends):
                rails: list[tuple[int, str | None]] = [(number, None) for number in sorted(self.rails)[:1]]
                draft.ends.insert(0, _End("en", rails))
            draft.ends = [
                end for end in draft.ends if end.name != "eno" or end.operand or (draft.number, "eno") in wired
            ]

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
        """Return the next ``UId``."""
        self.next += 1
        return str(self.next - 1)

    def _join(self) -> None:
        """Put an OR where wires meet: TIA Portal has one wire at a pin."""
        joined: list[_Draft] = []
        for draft in self.drafts:
            for end in draft.ends:
                if len(end.sources) > 1:
                    number = JOIN - len(joined)
                    ends = [_End(f"in{place}", [source]) for place, source in enumerate(end.sources, 1)]
                    join = _Draft(Block(id=0, type_name="OR"), "O", [*ends, _End("out", is_output=True)], number=number)
                    self.by_node[number] = join
                    joined.append(join)
                    end.sources = [(number, "out")]
            joined.append(draft)
        self.drafts = joined

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
        if self.labels:
            labels = sub(self.root, "Labels")
            for label in self.labels:
                sub(sub(labels, "LabelDeclaration", {"UId": self.uid()}), "Label", {"Name": label.label})
        parts = sub(self.root, "Parts")
        for draft in self.drafts:
            if isinstance(draft.node, Block):
                self._template_values(draft, draft.node, attributes_of(draft.node.extension_data))
            # in the order of their operands: an edge memory is behind the operand that is watched
            for end in sorted(draft.ends, key=lambda end: end.name == "bit"):
                if end.operand is not None:
                    self._access(parts, draft, end, end.operand)
                for source, _ in end.sources:
                    if source in self.inputs:
                        self._access(parts, draft, end, self.inputs[source].expression)
        for draft in self.drafts:
            self._part(parts, draft)
        # TIA Portal numbers operands and parts, then open ends, then wires
        opens = {(d.uid, e.name): self.uid() for d in self.drafts for e in d.ends if self._is_open(d, e)}
        wires = sub(self.root, "Wires") if any(draft.ends for draft in self.drafts) else None
        if wires is not None and (consumers := self._consumers((RAIL_KEY, None))):
            self._wire(wires, ("Powerrail", {}), *consumers)
        for draft in self.drafts:
            for end in draft.ends:
                if wires is not None:
                    self._wires(wires, draft, end, opens)
        if self.numbers:
            renumber(self.root, self.numbers)

    def _is_open(self, draft: _Draft, end: _End) -> bool:
        if end.operand is not None or end.sources:
            return False
        return not end.is_output or not self._consumers((draft.number, end.name))

    def _access(self, parent: XmlNode, draft: _Draft, end: _End, text: str) -> None:
        number = self.uid()
        self.access[draft.number, end.name] = number
        if isinstance(draft.node, Jump) and end.name == JUMP_PIN:
            sub(sub(parent, "Access", {"Scope": "Label", "UId": number}), "Label", {"Name": text})
            return
        hint = self.hints.at(text, draft.number, end.name)
        self.hints_matter |= write_operand(parent, text, draft.kind, {"UId": number}, hint=hint, index=self.hints.index)

    def _part(self, parent: XmlNode, draft: _Draft) -> None:
        node = draft.node
        if isinstance(node, Block) and node.call is not None and node.call.value in _CALL_NAMES:
            self._call(parent, draft, node)
            return
        kept = attributes_of(node.extension_data)
        marks = {key: kept[key] for key in _PART_ATTRIBUTES if key in kept}
        if not kept and draft.name in _TIMERS:
            marks["Version"] = S7_VERSION
        if not kept and draft.name == _MOVE:
            marks["DisabledENO"] = "true"
        draft.uid = self.uid()
        element = sub(parent, "Part", {"Name": draft.name, "UId": draft.uid, **marks})
        if isinstance(node, Block):
            if "Equation" in kept:
                sub(element, "Equation").text = kept["Equation"] or None
            if node.instance is not None:
                self._instance(element, node.instance)
            for key, value in self._template_values(draft, node, kept).items():
                sub(element, "TemplateValue", {"Name": key, "Type": template_type(key)}).text = value
            for kind in LISTS:
                for name in filter(None, kept.get(kind, "").split(",")):
                    sub(element, kind, {"Name": name})
            for variable in (*node.parameters.inputs, *node.parameters.outputs):
                if variable.negated:
                    sub(element, "Negated", {"Name": _s7_pin(node, variable.name)})
        elif isinstance(node, Contact | Coil) and node.negated:
            sub(element, "Negated", {"Name": "operand"})
        if draft.is_inverted:
            sub(element, "Negated", {"Name": "in"})

    def _template_values(self, draft: _Draft, node: Block, kept: dict[str, str]) -> dict[str, str]:
        """Return the template values of a box: the number of its inputs, and their type."""
        values = {key: value for key, value in kept.items() if key not in _NO_TEMPLATES}
        block = _standard(node)
        if not values and block is not None and block.name in _TIMERS:
            return {"time_type": "Time"}
        if not values and draft.name == _MOVE:
            return {"Card": "1"}
        if block is not None and draft.name == CONVERT:
            source, _, target = block.name.partition("_TO_")
            draft.kind = S7_CONVERTED[source]
            return values | {"SrcType": S7_CONVERTED[source], "DestType": S7_CONVERTED[target]}
        if values or block is None or block.operator is None:
            return values
        inputs = [end for end in draft.ends if not end.is_output and end.name != "en"]
        if draft.name not in _UNTYPED:
            values["SrcType"] = self._type_of(block.name, inputs)
            draft.kind = values["SrcType"]
        if block.name in _COUNTED:
            values["Card"] = str(len(inputs))
        return values

    def _type_of(self, name: str, inputs: list[_End]) -> str:
        """Return the type of the values that a box compares or computes: that of known variables, else of a literal."""
        texts = [end.operand for end in inputs if end.operand is not None]
        texts += [self.inputs[s].expression for end in inputs for s, _ in end.sources if s in self.inputs]
        known = [self.types[text.lower()].partition("[")[0] for text in texts if text.lower() in self.types]
        literals = [text for text in texts if parse_operand(text) is not None and not text.startswith(("#", '"', "%"))]
        known += [kind for text in literals if (kind := type_of_literal(text)) is not None]
        found = type_of_box(name, known, literals)
        return found or (literal_type(literals[0], "") if literals else "Int")

    def _call(self, parent: XmlNode, draft: _Draft, node: Block) -> None:
        draft.uid = self.uid()
        element = sub(parent, "Call", {"UId": draft.uid})
        call = _CALL_NAMES[node.call.value] if node.call is not None else "FC"
        info = sub(element, "CallInfo", {"Name": node.type_name, "BlockType": call})
        for name, kind in CALL_MARKS.items():
            if name in attributes_of(node.extension_data):
                text = attributes_of(node.extension_data)[name]
                sub(info, kind, {"Name": name, "Informative": "true"}).text = text or None
        if node.instance is not None:
            self._instance(info, node.instance)
        groups = (("Input", node.parameters.inputs), ("Output", node.parameters.outputs))
        for section, variables in (*groups, ("InOut", node.parameters.in_outs)):
            for variable in variables:
                if variable.name in ("EN", "ENO"):
                    continue
                kept = attributes_of(variable.extension_data)
                marks = {"Name": variable.name, "Section": kept.get("Section", section)}
                parameter = sub(info, "Parameter", marks | {"Type": kept.get("Type", "Variant")})
                if "InterfaceFlags" in kept:
                    flags = {"Name": "InterfaceFlags", "Informative": "true"}
                    sub(parameter, "StringAttribute", flags).text = kept["InterfaceFlags"] or None
                if variable.negated:
                    sub(element, "Negated", {"Name": variable.name})

    def _instance(self, parent: XmlNode, text: str) -> None:
        operand = parse_operand(text)
        if operand is None or not operand.path:
            raise NotUnderstoodError(f"{text} is no instance")
        instance = sub(parent, "Instance", {"Scope": operand.scope, "UId": self.uid()})
        self.hints_matter |= write_path(instance, operand.path, hint=self.hints.of(text), index=self.hints.index)

    def _wires(self, parent: XmlNode, draft: _Draft, end: _End, opens: dict[tuple[str, str], str]) -> None:
        """Write the wires that start at a pin, or end at it from an operand or nowhere."""
        here = ("NameCon", {"UId": draft.uid, "Name": end.name})
        if end.is_output:
            ends = self._consumers((draft.number, end.name))
            if end.operand is not None:
                ends.append(("IdentCon", {"UId": self.access[draft.number, end.name]}))
            elif not ends:
                ends.append(("OpenCon", {"UId": opens[draft.uid, end.name]}))
            self._wire(parent, here, *ends)
        elif end.operand is not None or any(source in self.inputs for source, _ in end.sources):
            self._wire(parent, ("IdentCon", {"UId": self.access[draft.number, end.name]}), here)
        elif not end.sources:
            self._wire(parent, ("OpenCon", {"UId": opens[draft.uid, end.name]}), here)

    def _consumers(self, key: tuple[int, str | None]) -> list[tuple[str, dict[str, str]]]:
        return [("NameCon", {"UId": draft.uid, "Name": end.name}) for draft, end in self.consumers.get(key, ())]

    def _wire(self, parent: XmlNode, *ends: tuple[str, dict[str, str]]) -> None:
        wire = sub(parent, "Wire", {"UId": self.uid()})
        for kind, marks in ends:
            sub(wire, kind, marks)


RAIL_KEY = -1
JOIN = -2
"""First id of the ORs that are put where wires meet; the following go down."""


def _draft(node: Node) -> _Draft:
    if isinstance(node, Contact) and node.edge is Edge.NONE and node.storage is Storage.NONE:
        return _Draft(node, "Contact", [_inlet("in", node.input), _End("operand", operand=node.variable)])
    if isinstance(node, Coil) and node.edge is Edge.NONE:
        if node.variable in RESULTS:
            return _Draft(node, node.variable, [_inlet("in", node.input)])
        name = _COIL_NAMES[node.storage.value]
        return _Draft(node, name, [_inlet("in", node.input), _End("operand", operand=node.variable)])
    if isinstance(node, Jump):
        return _Draft(node, "Jump", [_inlet("in", node.input), _End(JUMP_PIN, operand=node.label)])
    if isinstance(node, Return):
        return _Draft(node, "Return", [_inlet("in", node.input)])
    if isinstance(node, Block) and node.code is None:
        ends = [_inlet(_s7_pin(node, v.name), v.input) for v in node.parameters.inputs if v.input is not None]
        ends += [_inlet(v.name, v.input) for v in node.parameters.in_outs if v.input is not None]
        ends += [_outlet(node, v) for v in node.parameters.outputs if v.output is not None]
        if any(v.edge is not Edge.NONE or v.storage is not Storage.NONE for v in node.parameters.inputs):
            raise NotUnderstoodError("an edge at a pin")
        block = _standard(node)
        name = s7_name(block) if block is not None else node.type_name
        name = attributes_of(node.extension_data).get(PART_NAME, name)
        return _Draft(node, name, ends, attributes_of(node.extension_data).get("SrcType", ""))
    raise NotUnderstoodError(node.kind)


def _standard(node: Block) -> StandardBlock | None:
    """Return the standard block that a block is, if it has the name that IEC 61131-3 gives it."""
    if PART_NAME in attributes_of(node.extension_data) or (node.call is not None and node.call.value in _CALL_NAMES):
        return None
    block = standard_block(node.type_name)
    return block if block is not None and block.name == node.type_name else None


def _s7_pin(node: Node, pin: str | None) -> str:
    """Return the name of TIA Portal for a pin."""
    if not isinstance(node, Block):
        return "out"
    if pin in ("EN", "ENO"):
        return pin.lower()
    block = _standard(node)
    if block is None:
        return pin or "out"
    pin = pin or block.result.name  # texts of CODESYS call those of flip-flops SET and RESET1
    return block.pin_in(pin, Tool.S7) or pin


def _inlet(name: str, pin: InputPin | None) -> _End:
    if pin is None:
        return _End(name)
    return _End(name, [(wire.source, wire.pin) for wire in pin.connections], pin.expression)


def _outlet(node: Block, variable: BlockVariable) -> _End:
    operand = variable.output.expression if variable.output is not None else None
    return _End(_s7_pin(node, variable.name), operand=operand, is_output=True)


TEXTS = "texts"
"""The field of a network for the texts in its drawing, each with its place among the elements."""
_LANGUAGES = {"LAD": "LD", "FBD": "FBD"}
_NAMES = {language: name for name, language in _LANGUAGES.items()}


def read_network(ctx: DocumentReading, element: etree._Element) -> Fields:
    """Return the fields of a `LogicNetwork`. Raises `NotUnderstoodError` where the model cannot express all of it.

    Parts that our writer would write differently are kept besides it as they are.
    """
    text = program_text(element)
    kept: dict[str, str] | None
    if next(element.iterchildren(etree.Comment), None) is None:
        found: tuple[Fields, dict[str, str] | None] = marshal.loads(_remembered(text))  # noqa: S302  # dumped below
        fields, kept = found
    else:
        net, fields, hints = _read_text(text)
        is_empty = child_named(net, "Wires") is None
        beside: Fields = {}
        read_comments(ctx, element, beside)
        texts = beside.pop(TEXTS, [])
        if is_empty:  # one that has been programmed since counts as it is
            merge_fields(fields, beside)
        is_from_comment = bool(fields["nodes"]) and is_empty
        kept = {} if is_from_comment else _beside(net, fields, hints)
        _insert(texts, fields["nodes"])
    if kept is None:
        fields.pop("extension_data", None)
        keep_verbatim(fields, element)
    elif kept:
        extension_data(fields)["attributes"].update(kept)
    return fields


@lru_cache(maxsize=512)
def _remembered(text: bytes) -> bytes:
    """Fields of a network and the result of `_beside`, as bytes: many are equal, each gets its own objects."""
    net, fields, hints = _read_text(text)
    return marshal.dumps((fields, _beside(net, fields, hints)))


def _read_text(text: bytes) -> tuple[XmlNode, Fields, dict[str, str]]:
    """Return the elements of a network, its fields, and the hints of its operands."""
    net = parse_program(text)
    texts: dict[str, str] = {}
    nodes = read_flgnet(net, texts)
    return net, {"nodes": nodes}, operand_hints(net, texts)


def _insert(texts: list[Any], nodes: list[Fields]) -> None:
    """Put the texts in a drawing back to their places among its elements."""
    for place, text in texts:
        used = {node["id"] for node in nodes}
        number = text["id"] if text["id"] not in used else max(used) + 1
        nodes.insert(place, {**text, "id": number})


def _beside(net: XmlNode, fields: Fields, hints: dict[str, str]) -> dict[str, str] | None:
    """Return the extension data besides `fields` from which `net` is written again; None where that is impossible."""
    if net.attrib or not fields["nodes"]:
        return None
    copy = ET.Element(str(net.tag))
    try:
        matter = write_flgnet(copy, LogicNetwork.model_validate({**fields, "extension_data": {"attributes": hints}}))
    except NotUnderstoodError:
        return None
    kept = hints if matter else {}  # hints that agree with the usual form need not be kept
    if is_identical(net, copy):
        return kept
    numbers = numbers_like(net, copy)
    if numbers is None:
        return None
    short = shortened(numbers, numbers_of(copy))
    return kept | ({NUMBERS: short} if short else {})


def write_network(ctx: DocumentWriting, root: etree._Element, network: LogicNetwork) -> etree._Element | None:
    """Fill the ``FlgNet`` element `root`, or give the one of the file, which takes its place.

    A network that TIA Portal cannot have is kept in a comment.
    """
    kept = verbatim(ctx, network.extension_data)
    if kept is not None and _nodes(kept) == network.nodes:
        return kept
    texts = [(at, node) for at, node in enumerate(network.nodes) if isinstance(node, CommentBox)]
    typed = _without_texts(network).model_copy(deep=True)
    try:
        reason = give_types(typed, ctx.types)
        if reason is not None:
            raise NotUnderstoodError(reason)
        write_flgnet(root, typed, ctx.types)
    except NotUnderstoodError as error:
        for child in list(root):
            root.remove(child)
        sub(root, "Parts")
        why = f"TIA Portal has no such element: {error}; the network is empty there"
        ctx.note(Outcome.NOT_EXECUTED, "network", why=why)
        nodes = network.model_dump(mode="json", exclude_none=True, include={"nodes"})
        keep_fields(root, nodes)
    else:
        if texts:
            dumped = [[at, node.model_dump(mode="json", exclude_none=True)] for at, node in texts]
            keep_fields(root, {TEXTS: dumped})
            ctx.note(Outcome.EXTENSION_DATA, "comment", why="TIA Portal draws no texts in networks")
    return None


def _without_texts(network: LogicNetwork) -> LogicNetwork:
    """Return the elements of a network that do something."""
    nodes = [node for node in network.nodes if not isinstance(node, CommentBox)]
    return network if len(nodes) == len(network.nodes) else network.model_copy(update={"nodes": nodes})


def has_all_elements(ctx: DocumentWriting, body: FbdBody | LdBody) -> bool:
    """True if TIA Portal has all elements of the networks of a body."""
    try:
        for network in body.networks:
            write_flgnet(etree.Element("FlgNet"), _without_texts(network), ctx.types)
    except NotUnderstoodError:
        return False
    return True


def _nodes(flgnet: etree._Element) -> object:
    try:
        return LogicNetwork.model_validate({"nodes": read_flgnet(flgnet)}).nodes
    except NotUnderstoodError:
        return None


def read_flgnet_body(ctx: DocumentReading, owner: etree._Element) -> Fields:
    """Return the body of an element of GRAPH that has its language as an attribute and one ``FlgNet``, or none."""
    language = owner.get("ProgrammingLanguage", "")
    flgnet = child_named(owner, "FlgNet")
    fields: Fields = {"language": _LANGUAGES.get(language, "LD"), "networks": []}
    if language not in _LANGUAGES:
        keep_attribute(fields, "ProgrammingLanguage", language)
    if flgnet is not None:
        try:
            fields["networks"].append(read_network(ctx, flgnet))
        except NotUnderstoodError as error:
            report_network(ctx, error, flgnet)
            fields = opaque_body(flgnet)
            keep_attribute(fields, "ProgrammingLanguage", language)
    return fields


def report_network(ctx: DocumentReading, error: NotUnderstoodError, element: etree._Element) -> None:
    """Report why a network is kept as it is and is no part of the model."""
    if isinstance(error, DamagedError):
        ctx.error("XML220", f"the network is damaged, and kept as it is: {error}", element)
    else:
        ctx.warn("XML221", f"the network is kept as it is, and not understood: {error}", element)


def write_flgnet_body(ctx: DocumentWriting, owner: etree._Element, body: Body) -> None:
    """Write the body of an element of GRAPH: its language and its network."""
    kept = attributes_of(body.extension_data)
    owner.set("ProgrammingLanguage", kept.get("ProgrammingLanguage") or _NAMES.get(body.language, "LAD"))
    if isinstance(body, OpaqueBody):
        add_element(ctx, owner, body.content)
    elif isinstance(body, FbdBody | LdBody):
        for network in body.networks[:1]:
            element = sub(owner, "FlgNet")
            instead = write_network(ctx, element, network)
            if instead is not None:
                owner.replace(element, instead)
        if len(body.networks) > 1:
            ctx.note(Outcome.NOT_EXECUTED, "network", why="GRAPH has one network here")
