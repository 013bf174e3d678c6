"""Types of the boxes of networks that come from other tools.

A box of TIA Portal has one type for all its inputs. Narrower types are converted to it without a word; where no type
holds all values, or TIA Portal has no such box, there is no network. AND, OR and XOR of words are other boxes than
those of Booleans.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from plcopen_sfc.formats.simaticml.operands import literal_type
from plcopen_sfc.languages.networks.graph import wires_of
from plcopen_sfc.languages.standard_blocks import Tool, standard_block
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.network import Block, BlockVariable, InputPin, InputVariable, LogicNetwork, Node

__all__ = ["give_types"]

_WIDER = {
    "SInt": "Int DInt LInt Real LReal",
    "Int": "DInt LInt Real LReal",
    "DInt": "LInt LReal",
    "USInt": "UInt UDInt ULInt Int DInt LInt Real LReal",
    "UInt": "UDInt ULInt DInt LInt Real LReal",
    "UDInt": "ULInt LInt LReal",
    "Real": "LReal",
    "Byte": "Word DWord LWord",
    "Word": "DWord LWord",
    "DWord": "LWord",
}
"""The types that hold all values of a type; TIA Portal V19 help, "Implicit conversion"."""
_BITS = frozenset({"Byte", "Word", "DWord", "LWord"})
_WORD_BOXES = {"AND": "And", "OR": "Or", "XOR": "Xor"}
_COMPARING = frozenset({"GT", "GE", "EQ", "LE", "LT", "NE"})
_COUNTED = frozenset({"ADD", "MUL"})
_COMPUTING = frozenset({"ADD", "MUL", "SUB", "DIV", "MOD"})
_NUMBER = re.compile(r"\d[\d_]*")
_STEP_DATA = {".t": "Time", ".u": "Time", ".x": "Bool"}


def give_types(network: LogicNetwork, types: Mapping[str, str]) -> str | None:
    """Give the boxes of a network, a copy, their types; or tell why TIA Portal has no such network.

    `types`: those of variables as operands name them, in lower case.
    """
    return _Typing(network, types).run()


class _Typing:
    def __init__(self, network: LogicNetwork, types: Mapping[str, str]) -> None:
        self.network = network
        self.types = types
        self.nodes: dict[int, Node] = {node.id: node for node in network.nodes}
        self.results: dict[int, str | None] = {}
        self.problem: str | None = None

    def run(self) -> str | None:
        for node in self.network.nodes:
            if isinstance(node, Block):
                self._result(node)
        return self.problem

    def _result(self, block: Block) -> str | None:
        """The type of what comes out of a box, which gets its types."""
        if block.id not in self.results:
            self.results[block.id] = None
            self.results[block.id] = self._typed(block)
        return self.results[block.id]

    def _typed(self, block: Block) -> str | None:
        standard = standard_block(block.type_name)
        if block.call is not None and block.call.value in ("functionblock", "function") and standard is None:
            return None
        if standard is None or Tool.S7 not in standard.tools:
            self.problem = self.problem or f"TIA Portal has no box {block.type_name}"
            return None
        inputs = [pin for pin in block.parameters.inputs if pin.name not in ("EN", "operand")]
        known = {kind for pin in inputs if (kind := self._type_of(pin)) is not None}
        if standard.name in ("AND", "OR", "XOR", "NOT"):
            return self._logic(block, known, inputs)
        if standard.name in _COMPARING | _COMPUTING:
            kind = self._common(block, known)
            if any(pin.negated for pin in inputs) and known != {"Bool"}:
                self.problem = self.problem or f"TIA Portal negates no input of a box {block.type_name}"
            if kind is not None:
                self._say(block, kind, inputs)
            return "Bool" if standard.name in _COMPARING else kind
        result = standard.name.partition("_TO_")
        if result[2]:
            source, target = (_SPELLED.get(name) for name in (result[0], result[2]))
            if source is not None and self._common(block, known | {source}) != source:
                self.problem = self.problem or f"{block.type_name} of a value of another type"
            return target
        return "Bool" if standard.stateful else None

    def _common(self, block: Block, known: Iterable[str]) -> str | None:
        kinds = set(known)
        found = next((a for a in kinds if all(b == a or a in _WIDER.get(b, "").split() for b in kinds)), None)
        if kinds and found is None:
            names = " and ".join(sorted(kinds))
            self.problem = self.problem or f"a box {block.type_name} of TIA Portal has one type, and this one {names}"
        return found

    def _logic(self, block: Block, known: set[str], inputs: list[BlockVariable]) -> str | None:
        if known <= {"Bool"}:
            return "Bool"
        kind = self._common(block, known)
        name = _WORD_BOXES.get(block.type_name)
        if kind is None or kind not in _BITS or name is None or any(pin.negated for pin in inputs):
            self.problem = self.problem or f"TIA Portal has no box {block.type_name} of {' and '.join(sorted(known))}"
            return None
        block.type_name = name
        self._say(block, kind, inputs)
        block.carried = Carried(attributes={"SrcType": kind, "Card": str(len(inputs))})
        for pin in (*inputs, *block.parameters.outputs):
            pin.name = pin.name.lower()
        for wire in (wire for node in self.network.nodes for wire in wires_of(node)):
            if wire.source == block.id and wire.pin is not None:
                wire.pin = wire.pin.lower()
        return kind

    def _say(self, block: Block, kind: str, inputs: list[BlockVariable]) -> None:
        """Write the type of a box, and its constants in a form that is of this type."""
        said = {"SrcType": kind}
        if block.type_name in _COUNTED:
            said["Card"] = str(len(inputs))
        block.carried = Carried(attributes=said)
        if kind not in _BITS:
            return
        for pin in inputs:
            if pin.input is None:
                continue
            holders: list[InputPin | InputVariable] = [pin.input] if pin.input.expression is not None else []
            holders += [n for w in pin.input.connections if isinstance(n := self.nodes.get(w.source), InputVariable)]
            for holder in holders:
                if holder.expression is not None and _NUMBER.fullmatch(holder.expression):
                    holder.expression = f"16#{int(holder.expression.replace('_', '')):X}"

    def _type_of(self, pin: BlockVariable) -> str | None:
        """The type of what comes to an input; None for numbers, which may be of several, and for what is not known."""
        if pin.input is None:
            return None
        if pin.input.expression is not None:
            return self._type_of_text(pin.input.expression)
        for wire in pin.input.connections:
            node = self.nodes.get(wire.source)
            if isinstance(node, Block):
                return self._result(node)
            if isinstance(node, InputVariable):
                return self._type_of_text(node.expression)
        return None

    def _type_of_text(self, text: str) -> str | None:
        key = text.lower()
        if key in self.types:
            return self.types[key] if self.types[key] in _KINDS else None
        if key.startswith(("t#", "time#")):
            return "Time"
        if text.startswith("#"):
            return next((kind for end, kind in _STEP_DATA.items() if key.endswith(end)), None)
        if text[:1].isdigit() and "#" not in text:
            return "Real" if literal_type(text, "") == "Real" else None
        return "Bool" if key in ("true", "false") else None


_KINDS = frozenset({"Bool", "LWord", "LInt", "ULInt", "LReal", "Time", "LTime", *_WIDER})
_SPELLED = {kind.upper(): kind for kind in _KINDS - {"Bool"}}
