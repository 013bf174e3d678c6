"""Types of the boxes of networks.

A box of TIA Portal has one type for all its inputs. Narrower types are converted to it implicitly; where no type holds
all values, or TIA Portal has no such box, there is no network. AND, OR and XOR of words are other boxes than those of
Booleans, and there is none for NOT.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping

from plcopen_sfc.formats.simaticml.element_reader import NotUnderstoodError
from plcopen_sfc.formats.simaticml.network_operands import literal_type
from plcopen_sfc.formats.xml.extension_data import attributes_of
from plcopen_sfc.languages.networks.network_graph import wires_from
from plcopen_sfc.languages.st.literals import INTEGER_RANGES, SHORT_TYPES, LiteralKind, known_literal
from plcopen_sfc.languages.standard_blocks import Tool, standard_block
from plcopen_sfc.model import network as net
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.dialect import Dialect

_SIGNED = frozenset({"SInt", "Int", "DInt", "LInt"})
_UNSIGNED = frozenset({"USInt", "UInt", "UDInt", "ULInt"})
BIT_STRINGS = frozenset({"Byte", "Word", "DWord", "LWord"})
_WHOLE = _SIGNED | _UNSIGNED
_NUMBERS = _WHOLE | {"Real", "LReal"}
_COMPARED = (
    _NUMBERS
    | BIT_STRINGS
    | {"Time", "LTime", "Date", "Time_Of_Day", "LTime_Of_Day", "Date_And_Time", "LDT", "DTL"}
    | {"String", "WString", "Char", "WChar"}
)
BOX_TYPES: Mapping[str, frozenset[str]] = (
    dict.fromkeys(("EQ", "NE", "GT", "GE", "LT", "LE"), _COMPARED)
    | dict.fromkeys(("ADD", "SUB", "MUL", "DIV"), _NUMBERS)
    | {"MOD": _WHOLE}
)
"""The types that boxes of TIA Portal take, by the names of IEC 61131-3; TIA Portal V19 help, basic instructions."""
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
    "Char": "String",
    "WChar": "WString",
}
"""The types that hold all values of a type; TIA Portal V19 help, "Implicit conversion"."""


def type_of_box(name: str, kinds: Collection[str], literals: Iterable[str]) -> str | None:
    """The type of the box of an operator for operands of these types and for `literals`; None where it is not known.

    Raises `NotUnderstoodError` where TIA Portal has no such box.
    """
    kinds = set(kinds)
    found = next((a for a in kinds if all(b == a or a in _WIDER.get(b, "").split() for b in kinds)), None)
    numbers = [number for text in literals if (number := _number(text)) is not None]
    if kinds and found is None:
        names = " and ".join(sorted(kinds))
        raise NotUnderstoodError(f"a box {name} of TIA Portal has one type, and this one {names}")
    if found is not None and found not in BOX_TYPES.get(name, {found}):
        raise NotUnderstoodError(f"TIA Portal has no box {name} of {found}")
    if found is not None and numbers and found not in _NUMBERS | BIT_STRINGS:
        raise NotUnderstoodError(f"TIA Portal has no box {name} of {found} and a number")
    if found is not None and not all(_holds(found, number) for number in numbers):
        wider = (each for each in _WIDER.get(found, "").split() if all(_holds(each, number) for number in numbers))
        found = next(wider, None)
        if found is None:
            raise NotUnderstoodError(f"a literal does not fit the type of its box {name}")
    return found


def type_of_literal(text: str) -> str | None:
    """Return the type that a literal names; None: it names none."""
    prefix, mark, _ = text.partition("#")
    name = prefix.upper()
    return _PREFIXES.get(SHORT_TYPES.get(name, name)) if mark else None


_PREFIXES = {each.upper(): each for each in _COMPARED} | {
    "T": "Time",
    "LT": "LTime",
    "D": "Date",
    "TOD": "Time_Of_Day",
    "LTOD": "LTime_Of_Day",
    "DT": "Date_And_Time",
    "BOOL": "Bool",
}


def _number(text: str) -> int | None:
    """Return a whole number without a type."""
    found = known_literal(text, Dialect.SCL)
    is_number = found is not None and found.kind is LiteralKind.INTEGER and not found.type
    return found.value if is_number and isinstance(found.value, int) else None  # type: ignore[union-attr]


def _holds(kind: str, number: int) -> bool:
    least, greatest = INTEGER_RANGES.get(kind.upper(), (number, number))
    return least <= number <= greatest


_WORD_BOXES = {"AND": "And", "OR": "Or", "XOR": "Xor"}
_COMPARING = frozenset({"GT", "GE", "EQ", "LE", "LT", "NE"})
_COUNTED = frozenset({"ADD", "MUL"})
_COMPUTING = frozenset({"ADD", "MUL", "SUB", "DIV", "MOD"})
_NUMBER = re.compile(r"\d[\d_]{0,400}")
_STEP_DATA = {".t": "Time", ".u": "Time", ".x": "Bool"}


def give_types(network: net.LogicNetwork, types: Mapping[str, str]) -> str | None:
    """Give the boxes of a network, a copy, their types; or return the reason why TIA Portal has no such network.

    Boxes that have their type keep it; those whose type cannot be told get none.

    `types`: those of variables as operands name them, in lower case.
    """
    return _Typing(network, types).run()


def give_condition_types(network: net.LogicNetwork, types: Mapping[str, str]) -> str | None:
    """Do the same for a condition: all its boxes must be known, and numbers beside words become ``16#..``."""
    typing = _Typing(network, types)
    blocks = [node for node in network.nodes if isinstance(node, net.Block)]
    for block in blocks:
        standard = standard_block(block.type_name)
        is_call = standard is None and block.call in (net.BlockCall.FUNCTION_BLOCK, net.BlockCall.FUNCTION)
        if not is_call and (standard is None or Tool.S7 not in standard.tools):
            name = block.type_name
            return f"networks are not written with {name}: let statements calculate it into a variable before"
    reason = typing.run()
    for block in blocks:
        if attributes_of(block.extension_data).get("SrcType") in BIT_STRINGS:
            typing.write_as_words(block)
    return reason


class _Typing:
    def __init__(self, network: net.LogicNetwork, types: Mapping[str, str]) -> None:
        self.network = network
        self.types = types
        self.nodes: dict[int, net.Node] = {node.id: node for node in network.nodes}
        self.results: dict[int, str | None] = {}
        self.problem: str | None = None

    def run(self) -> str | None:
        for node in self.network.nodes:
            if isinstance(node, net.Block):
                self._result(node)
                if any(pin.negated and self._type_of(pin) in BIT_STRINGS for pin in node.parameters.inputs):
                    self.problem = self.problem or f"TIA Portal negates no word, and a box {node.type_name} has one"
            kind = self._type_of_text(node.variable) if isinstance(node, net.Contact | net.Coil) else None
            if isinstance(node, net.Contact | net.Coil) and kind not in (None, "Bool"):
                self.problem = self.problem or f"contacts and coils are of BOOL, and {node.variable} is {kind}"
        return self.problem

    def _result(self, block: net.Block) -> str | None:
        """Return the type of the output of a box, which gets its types."""
        if block.id not in self.results:
            self.results[block.id] = None
            self.results[block.id] = self._typed(block)
        return self.results[block.id]

    def _typed(self, block: net.Block) -> str | None:
        standard = standard_block(block.type_name)
        if standard is None:
            return None
        given = attributes_of(block.extension_data).get("SrcType")
        if given is not None and standard.name in _COMPARING | _COMPUTING | {*_WORD_BOXES}:
            return "Bool" if standard.name in _COMPARING else given
        inputs = [pin for pin in block.parameters.inputs if pin.name not in ("EN", "pre", "operand")]
        known = {kind for pin in inputs if (kind := self._type_of(pin)) is not None}
        if standard.name in ("AND", "OR", "XOR", "NOT"):
            return self._logic(block, known, inputs)
        if standard.name in _COMPARING | _COMPUTING:
            kind = self._common(block, known, inputs)
            if any(pin.negated for pin in inputs) and known != {"Bool"}:
                self.problem = self.problem or f"TIA Portal negates no input of a box {block.type_name}"
            elif kind is not None:
                self._set_type(block, kind, inputs)
            return "Bool" if standard.name in _COMPARING else kind
        result = standard.name.partition("_TO_")
        if result[2]:
            source, target = (_SPELLED.get(name) for name in (result[0], result[2]))
            if source is not None and self._common(block, known | {source}) != source:
                self.problem = self.problem or f"{block.type_name} of a value of another type"
            return target
        return None

    def _common(
        self, block: net.Block, known: Iterable[str], inputs: list[net.BlockVariable] | None = None
    ) -> str | None:
        """Return the type of a box for values of the types `known` and for the literals among its `inputs`."""
        try:
            return type_of_box(block.type_name, set(known), [h.expression or "" for h in self._holders(inputs or [])])
        except NotUnderstoodError as error:
            self.problem = self.problem or str(error)
            return None

    def _holders(self, inputs: list[net.BlockVariable]) -> list[net.InputPin | net.InputVariable]:
        """Return the pins and variables with the operands of a box."""
        found: list[net.InputPin | net.InputVariable] = []
        for pin in (pin.input for pin in inputs if pin.input is not None):
            found += [pin] if pin.expression is not None else []
            found += [each for w in pin.connections if isinstance(each := self.nodes.get(w.source), net.InputVariable)]
        return found

    def _logic(self, block: net.Block, known: set[str], inputs: list[net.BlockVariable]) -> str | None:
        if known <= {"Bool"}:
            return "Bool"
        kind = self._common(block, known)
        name = _WORD_BOXES.get(block.type_name)
        if kind is None or kind not in BIT_STRINGS or name is None or any(pin.negated for pin in inputs):
            self.problem = self.problem or f"TIA Portal has no box {block.type_name} of {' and '.join(sorted(known))}"
            return kind
        self._set_type(block, kind, inputs)
        _mark(block, SrcType=kind, Card=str(len(inputs)))
        block.type_name = name
        for pin in (*inputs, *block.parameters.outputs):
            pin.name = pin.name.lower()
        for wire in wires_from(self.network, block.id):
            if wire.pin is not None:
                wire.pin = wire.pin.lower()
        return kind

    def _set_type(self, block: net.Block, kind: str, inputs: list[net.BlockVariable]) -> None:
        """Write the type of a box. Its ENO is EN as in other tools, also where the result does not fit the type."""
        if block.type_name in _COMPUTING and any(wire.pin == "ENO" for wire in wires_from(self.network, block.id)):
            _mark(block, DisabledENO="true")
        _mark(block, SrcType=kind, **({"Card": str(len(inputs))} if block.type_name in _COUNTED else {}))

    def write_as_words(self, block: net.Block) -> None:
        """Write the numbers at a box of words as those."""
        for holder in self._holders(block.parameters.inputs):
            if holder.expression is not None and _NUMBER.fullmatch(holder.expression):
                holder.expression = f"16#{int(holder.expression.replace('_', '')):X}"

    def _type_of(self, pin: net.BlockVariable) -> str | None:
        """Type of the value at an input; None for numbers, which may be of several, and for unknown types."""
        if pin.input is None:
            return None
        if pin.input.expression is not None:
            return self._type_of_text(pin.input.expression)
        for wire in pin.input.connections:
            node = self.nodes.get(wire.source)
            if isinstance(node, net.Block):
                return self._result(node) or _declared_type(node, wire.pin)
            if isinstance(node, net.Contact):
                return "Bool"
            if isinstance(node, net.InputVariable):
                return self._type_of_text(node.expression)
        return None

    def _type_of_text(self, text: str) -> str | None:
        key = text.lower()
        if key in self.types:
            kind = self.types[key].partition("[")[0]
            return kind if kind in _KINDS else None
        if type_of_literal(text) is not None:
            return type_of_literal(text)
        if text.startswith("#"):
            base = self.types.get(key.rpartition(".")[0], "G7_")
            if not base.upper().startswith("G7_"):
                return None  # a variable, and no step
            return next((kind for end, kind in _STEP_DATA.items() if key.endswith(end)), None)
        if text[:1].isdigit() and "#" not in text:
            return "Real" if literal_type(text, "") == "Real" else None
        return "Bool" if key in ("true", "false") else None


def _mark(block: net.Block, **marks: str) -> None:
    block.extension_data = block.extension_data or ExtensionData()
    block.extension_data.attributes = block.extension_data.attributes | marks


def _declared_type(block: net.Block, pin: str | None) -> str | None:
    """Return the type of an output of a function block: a timer has a BOOL and a TIME."""
    standard = standard_block(block.type_name)
    if standard is None or not standard.stateful:
        return None
    name = standard.output_name(pin or standard.result.name)
    kind = next((each.type for each in standard.outputs if each.name == name), "")
    return "Bool" if kind == "BOOL" else _SPELLED.get(kind)


_KINDS = frozenset({"Bool", *BOX_TYPES["EQ"]})
_SPELLED = {kind.upper(): kind for kind in _KINDS - {"Bool"}}
