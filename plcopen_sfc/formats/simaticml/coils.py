"""Coils where TIA Portal wants them: for the results of conditions, and for Boolean assignments in FBD."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from plcopen_sfc.formats.simaticml.bit_moves import BOOLEAN, keep_bits_by_logic
from plcopen_sfc.formats.simaticml.parts import RESULTS
from plcopen_sfc.model.body import Body, FbdBody, LdBody
from plcopen_sfc.model.conditions import BodyCondition, Condition
from plcopen_sfc.model.network import Block, Coil, LogicNetwork, Node, OutputVariable
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import Elementary, ElementaryType


def put_coils(project: Project) -> None:
    """Make coils of the output variables that other tools write instead.

    The results of conditions (``TrCoil``, ``IlCoil``, ``SvCoil``) are no variables, whatever a translation of names has
    made of them.
    """
    for chart in project.charts():
        conditions: list[Condition | None] = [t.condition for t in chart.network.transitions]
        for step in chart.network.steps:
            conditions += [each.condition for each in (step.interlock, step.supervision) if each is not None]
        for condition in conditions:
            if isinstance(condition, BodyCondition):
                for network in _networks(condition.body):
                    network.nodes = [_result(node) for node in network.nodes]
    blocks = {pou.name.casefold() for pou in project.pous}
    for _, pou, body in project.bodies():
        if isinstance(body, FbdBody):
            variables = pou.interface.variables() if pou.interface is not None else []
            bits = {v.name.casefold() for v in variables if v.type == ElementaryType(name=Elementary.BOOL)}
            for network in body.networks:
                keep_bits_by_logic(network, bits)
                _assignments(network, bits, blocks)


def _networks(body: Body) -> Iterator[LogicNetwork]:
    if isinstance(body, FbdBody | LdBody):
        yield from body.networks


def _result(node: Node) -> Node:
    name = _target(node).removeprefix("#").strip('"')
    return _coil(node, name) if name in RESULTS else node


def _assignments(network: LogicNetwork, bits: Collection[str], blocks: Collection[str]) -> None:
    """Make coils of variables that are of type BOOL (`bits`: those of the block), or get the result of a logic box.

    What comes from one of the `blocks` of the project stays at its pin.
    """
    called = {node.id for node in network.nodes if isinstance(node, Block) and node.type_name.casefold() in blocks}
    boolean = {node.id for node in network.nodes if isinstance(node, Block) and node.type_name.upper() in BOOLEAN}
    for index, node in enumerate(network.nodes):
        if isinstance(node, OutputVariable) and node.input is not None:
            sources = {connection.source for connection in node.input.connections}
            name = node.expression.removeprefix("#").strip('"').casefold()
            if sources and (sources <= boolean or (name in bits and not sources & called)):
                network.nodes[index] = _coil(node, node.expression)


def _target(node: Node) -> str:
    if isinstance(node, Coil):
        return node.variable
    return node.expression if isinstance(node, OutputVariable) else ""


def _coil(node: Node, variable: str) -> Node:
    shared = {field: getattr(node, field) for field in OutputVariable.model_fields if field in Coil.model_fields}
    return Coil.model_validate({**shared, "kind": "coil", "variable": variable})
