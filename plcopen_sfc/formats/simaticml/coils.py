"""Coils and boxes where TIA Portal wants them: for the results of conditions, and for assignments in FBD and LAD.

Other tools, and code that was drawn here, have output variables; TIA Portal has coils for bits, ``Move`` for the rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from plcopen_sfc.formats.simaticml.bit_moves import BOOLEAN, keep_bits_by_contacts, keep_bits_by_logic
from plcopen_sfc.formats.simaticml.operands import literal_type, parse_operand
from plcopen_sfc.formats.simaticml.parts import RESULTS
from plcopen_sfc.formats.simaticml.power import put_in_series
from plcopen_sfc.formats.simaticml.types import write_type
from plcopen_sfc.languages.s7_types import s7_types
from plcopen_sfc.model.body import Body, FbdBody, LdBody
from plcopen_sfc.model.conditions import BodyCondition, Condition
from plcopen_sfc.model.network import (
    Block,
    BlockCall,
    BlockParameters,
    BlockVariable,
    Coil,
    Connection,
    Contact,
    InputPin,
    InputVariable,
    LeftPowerRail,
    LogicNetwork,
    Node,
    OutputPin,
    OutputVariable,
    Storage,
)
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project

_BITS = BOOLEAN | {"R_TRIG", "F_TRIG"}
"""Boxes whose result is a bit. Edges with an instance of their own are others."""
_CALLS = (BlockCall.FUNCTION, BlockCall.FUNCTION_BLOCK)


def types_of(project: Project, pou: Pou) -> dict[str, str]:
    """The types of the variables of a block (``#name``) and of the tags (``"name"``), as TIA Portal spells them.

    Names are in lower case.
    """
    tags = {f'"{tag.name.lower()}"': tag.type for table in project.tag_tables for tag in table.tags}
    types = s7_types(project)
    return tags | {f"#{variable.name.lower()}": write_type(types.type(variable.type)) for variable in pou.variables()}


def put_coils(project: Project) -> None:
    """Make coils of the output variables that other tools write instead.

    The results of conditions (``TrCoil``, ``IlCoil``, ``SvCoil``) are no variables, whatever a translation of names has
    made of them.
    """
    for chart in project.charts():
        conditions: list[Condition | None] = [t.condition for t in chart.chart.transitions]
        for step in chart.chart.steps:
            conditions += [each.condition for each in (step.interlock, step.supervision) if each is not None]
        for condition in conditions:
            if isinstance(condition, BodyCondition):
                for network in _networks(condition.body):
                    network.nodes = [_result(node) for node in network.nodes]
    blocks = {pou.name.casefold() for pou in project.pous}
    for _, pou, body in project.bodies():
        if isinstance(body, FbdBody | LdBody):
            types = types_of(project, pou)
            bits = {_plain(name) for name, kind in types.items() if name.startswith("#") and kind == "Bool"}
            keep_bits = keep_bits_by_logic if isinstance(body, FbdBody) else keep_bits_by_contacts
            for network in body.networks:
                keep_bits(network, bits)
                put_assignments(network, types, blocks)
                if isinstance(body, LdBody):
                    put_in_series(network)


def _networks(body: Body) -> Iterator[LogicNetwork]:
    if isinstance(body, FbdBody | LdBody):
        yield from body.networks


def _result(node: Node) -> Node:
    name = _target(node).removeprefix("#").strip('"')
    return _coil(node, name) if name in RESULTS else node


def put_assignments(network: LogicNetwork, types: Mapping[str, str], blocks: Iterable[str] = ()) -> None:
    """Make coils and ``Move`` boxes of the output variables of a network; `types` are those of `types_of`.

    What comes from a box that calls one of the `blocks` of the project (lower case), or from any other box that does
    not give a bit, stays at its pin.
    """
    if not any(isinstance(node, OutputVariable) for node in network.nodes):
        return
    own = frozenset(blocks)
    sources = {node.id: node for node in network.nodes}
    for index, node in enumerate(network.nodes):
        if not isinstance(node, OutputVariable) or node.input is None or not node.input.connections:
            continue
        givers = [sources.get(connection.source) for connection in node.input.connections]
        if _takes_bit(node, givers, types, own):
            network.nodes[index] = _coil(node, node.expression)
        elif len(givers) == 1 and isinstance(givers[0], InputVariable) and _is_value(node, givers[0], types):
            network.nodes[index] = _move(node)
    _put_contacts(network)


def _put_contacts(network: LogicNetwork) -> None:
    """Contacts of variables at coils, in a network with a power rail: LAD has no operands there."""
    rail = next((node for node in network.nodes if isinstance(node, LeftPowerRail)), None)
    coils = [node.input for node in network.nodes if isinstance(node, Coil) and node.input is not None]
    fed = {connection.source for pin in coils for connection in pin.connections}
    for index, node in enumerate(network.nodes):
        if rail is not None and isinstance(node, InputVariable) and node.id in fed:
            shared = {
                field: getattr(node, field) for field in InputVariable.model_fields if field in Contact.model_fields
            }
            power = InputPin(connections=[Connection(source=rail.id)])
            marks = {"kind": "contact", "variable": node.expression, "input": power}
            network.nodes[index] = Contact.model_validate(shared | marks)


def _takes_bit(
    node: OutputVariable, givers: list[Node | None], types: Mapping[str, str], blocks: frozenset[str]
) -> bool:
    if node.storage is not Storage.NONE:
        return True  # only bits are set and reset
    if all(_gives_bit(giver, types) for giver in givers):
        return True
    called = any(isinstance(g, Block) and (g.call in _CALLS or g.type_name.casefold() in blocks) for g in givers)
    return _type(node.expression, types) == "Bool" and not called


def _gives_bit(giver: Node | None, types: Mapping[str, str]) -> bool:
    if isinstance(giver, Block):
        return giver.type_name.upper() in _BITS
    return isinstance(giver, InputVariable) and _type(giver.expression, types) == "Bool"


def _is_value(node: OutputVariable, giver: InputVariable, types: Mapping[str, str]) -> bool:
    """Whether something else than a bit is assigned; of what nobody knows the type, that cannot be told."""
    return bool(_type(node.expression, types) or _type(giver.expression, types))


def _type(text: str, types: Mapping[str, str]) -> str:
    """The type of an operand; empty where it is not known."""
    name = f"#{_plain(text)}" if text.startswith("#") else text.lower()
    known = types.get(name) or types.get(f"#{name}", "")
    if known or text.startswith(("#", '"', "%")) or parse_operand(text) is None:
        return known
    return "Bool" if text.upper() in ("TRUE", "FALSE") else literal_type(text, "")


def _plain(text: str) -> str:
    return text.removeprefix("#").strip('"').lower()


def _target(node: Node) -> str:
    if isinstance(node, Coil):
        return node.variable
    return node.expression if isinstance(node, OutputVariable) else ""


def _coil(node: Node, variable: str) -> Node:
    shared = {field: getattr(node, field) for field in OutputVariable.model_fields if field in Coil.model_fields}
    return Coil.model_validate({**shared, "kind": "coil", "variable": variable})


def _move(node: OutputVariable) -> Node:
    shared = {field: getattr(node, field) for field in OutputVariable.model_fields if field in Block.model_fields}
    parameters = BlockParameters(
        inputs=[BlockVariable(name="IN", input=node.input)],
        outputs=[BlockVariable(name="OUT", output=OutputPin(expression=node.expression))],
    )
    return Block.model_validate({**shared, "kind": "block", "type_name": "MOVE", "parameters": parameters})
