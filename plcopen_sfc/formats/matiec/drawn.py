"""Drawn logic as the converters before matiec take it.

They know blocks, variables, contacts, coils, rails and connectors, and see the negation, storage and edge of a contact,
a coil and a pin, but not those of a variable (read from the converter of OpenPLC, and tried).
"""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.words import is_plain
from plcopen_sfc.model.network import (
    Block,
    Coil,
    CommentBox,
    Connector,
    Contact,
    Continuation,
    Edge,
    InOutVariable,
    InputVariable,
    LeftPowerRail,
    Node,
    OutputVariable,
    RightPowerRail,
    Storage,
)

_TAKEN = (
    Block
    | Coil
    | CommentBox
    | Connector
    | Contact
    | Continuation
    | InOutVariable
    | InputVariable
    | LeftPowerRail
    | OutputVariable
    | RightPowerRail
)


def is_taken(nodes: Iterable[Node], dialect: Dialect) -> bool:
    """True if the converters translate these elements to what they mean."""
    return all(_is_taken(node, dialect) for node in nodes)


def _is_taken(node: Node, dialect: Dialect) -> bool:
    if isinstance(node, Block) and node.code is not None:
        return False
    if isinstance(node, InOutVariable):
        return not (node.negated_in or node.negated_out)
    if isinstance(node, InputVariable):
        return node.edge is Edge.NONE and not parse_expression(node.expression, dialect).problems
    if isinstance(node, OutputVariable):
        return not node.negated and node.edge is Edge.NONE and node.storage is Storage.NONE
    return isinstance(node, _TAKEN)


def give_iec_pins(nodes: Iterable[Node]) -> None:
    """Give the pins of standard function blocks the names of IEC 61131-3: CODESYS has ``SET`` and ``RESET1``."""
    for node in nodes:
        block = standard_block(node.type_name) if isinstance(node, Block) else None
        if isinstance(node, Block) and block is not None and block.stateful:
            for pin in node.parameters.inputs:
                pin.name = block.input_name(pin.name) or pin.name
            for pin in node.parameters.outputs:
                pin.name = block.output_name(pin.name) or pin.name


def write_negations_out(nodes: Iterable[Node]) -> int:
    """Write ``NOT x`` for a negated variable ``x`` that is read; returns how many there were."""
    negated = [node for node in nodes if isinstance(node, InputVariable) and node.negated]
    for node in negated:
        node.expression = f"NOT {node.expression}" if is_plain(node.expression) else f"NOT ({node.expression})"
        node.negated = False
    return len(negated)
