"""Calls of blocks of the project in networks: TIA Portal says of each parameter which section and type it has."""

from __future__ import annotations

from collections.abc import Collection

from plcopen_sfc.formats.simaticml.results import RETURN
from plcopen_sfc.formats.simaticml.types import write_type
from plcopen_sfc.languages.networks.graph import wires_of
from plcopen_sfc.languages.s7_results import RESULT
from plcopen_sfc.languages.standard_blocks import StandardBlock, standard_block
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.network import Block, BlockCall, BlockVariable, LogicNetwork
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.variables import Interface, SectionKind

_CALLS = {PouKind.FUNCTION_BLOCK: BlockCall.FUNCTION_BLOCK, PouKind.FUNCTION: BlockCall.FUNCTION}
_PARAMETERS = (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT)


def say_calls(project: Project) -> None:
    """Say of each box that calls a function or function block of the project that it does, and what its pins are."""
    callable_ = {pou.name.casefold(): pou for pou in project.pous if pou.kind in _CALLS}
    for _, _, body in project.bodies():
        for network in body.networks if isinstance(body, FbdBody | LdBody) else ():
            for node in network.nodes:
                pou = callable_.get(node.type_name.casefold()) if isinstance(node, Block) else None
                if isinstance(node, Block) and pou is not None and node.call in (None, _CALLS[pou.kind]):
                    if pou.kind is PouKind.FUNCTION:
                        _name_pins(node, pou, network)
                    _say(node, pou)


def put_standard_blocks(project: Project) -> None:
    """Let standard blocks of other tools be parts, with the pins of IEC 61131-3: CODESYS says that they are called."""
    own = {pou.name.casefold() for pou in project.pous}
    for _, _, body in project.bodies():
        for network in body.networks if isinstance(body, FbdBody | LdBody) else ():
            changed = {
                node.id: standard
                for node in network.nodes
                if isinstance(node, Block) and (standard := _standard_of_others(node, own)) is not None
            }
            for node in network.nodes:
                for wire in wires_of(node):
                    standard = changed.get(wire.source)
                    if standard is not None and wire.pin is not None:
                        wire.pin = standard.output_name(wire.pin) or wire.pin


def _standard_of_others(block: Block, own: Collection[str]) -> StandardBlock | None:
    """The standard block that a box is, with its pins renamed; None for calls of blocks of the project."""
    standard = standard_block(block.type_name)
    parameters = (*block.parameters.inputs, *block.parameters.outputs)
    is_native = any(p.carried is not None and "Type" in p.carried.attributes for p in parameters)
    if standard is None or block.call is None or is_native or block.type_name.casefold() in own:
        return None
    block.call, block.type_name = None, standard.name
    for parameter in block.parameters.inputs:
        parameter.name = standard.input_name(parameter.name) or parameter.name
    for parameter in block.parameters.outputs:
        parameter.name = standard.output_name(parameter.name) or parameter.name
    return standard


def _name_pins(block: Block, pou: Pou, network: LogicNetwork) -> None:
    """Give the pins of a function the names of its declaration: other tools leave them out, or call the result OUT."""
    interface = pou.interface or Interface()
    declared = [v.name for v in interface.variables(SectionKind.INPUT)]
    inputs = [pin for pin in block.parameters.inputs if pin.name != "EN"]
    if len(inputs) <= len(declared) and not any(pin.name for pin in inputs):
        for pin, name in zip(inputs, declared, strict=False):
            pin.name = name
    known = {v.name.casefold() for v in interface.variables()}
    for pin in block.parameters.outputs:
        is_result = pin.name.casefold() in ("", "out", pou.name.casefold()) and pin.name.casefold() not in known
        if interface.return_type is not None and is_result:
            for wire in (wire for node in network.nodes for wire in wires_of(node)):
                if wire.source == block.id and wire.pin == pin.name:
                    wire.pin = RESULT
            pin.name = RESULT
            _mark(pin, Type=write_type(interface.return_type), Section=RETURN)


def _say(block: Block, pou: Pou) -> None:
    block.call = _CALLS[pou.kind]
    sections = pou.interface.sections if pou.interface is not None else []
    declared = {v.name.casefold(): (section.kind, v.type) for section in sections for v in section.variables}
    for group in (block.parameters.inputs, block.parameters.in_outs, block.parameters.outputs):
        for parameter in list(group):
            kind, type_ = declared.get(parameter.name.casefold(), (None, None))
            if kind not in _PARAMETERS or type_ is None:
                continue
            _mark(parameter, Type=write_type(type_))  # its section is that of the list that it is in
            if kind is SectionKind.IN_OUT and group is block.parameters.inputs:
                group.remove(parameter)
                block.parameters.in_outs.append(parameter)


def _mark(parameter: BlockVariable, **marks: str) -> None:
    parameter.carried = parameter.carried or Carried()
    parameter.carried.attributes = marks | parameter.carried.attributes
