"""Boxes of networks: the names TIA Portal has for standard blocks, flip-flops, and calls of blocks of the project.

TIA Portal keeps the state of a flip-flop in a variable at its box, so an instance of another tool becomes that
variable. Edges have instances there too, but other boxes than those with a variable. Of a call TIA Portal gives the
section and type of each parameter.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from functools import lru_cache

from plcopen_sfc.formats.simaticml.added_elements import RETURN
from plcopen_sfc.formats.simaticml.declaration_spelling import write_type
from plcopen_sfc.languages.binding.text_sites import TextSite, text_sites
from plcopen_sfc.languages.library_blocks import FLIP_FLOPS, flip_flop_instances, is_output, more_than_outputs
from plcopen_sfc.languages.networks.network_graph import wires_from, wires_of
from plcopen_sfc.languages.s7_programs import RESULT
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import render, transform
from plcopen_sfc.languages.standard_blocks import S7_CONVERTED, S7_VERSION, StandardBlock, Tool, standard_block
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.body import networks_of
from plcopen_sfc.model.network import Block, BlockCall, BlockVariable, InputPin, LogicNetwork
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.text import without_signs
from plcopen_sfc.model.types import Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import PASSED, Interface, SectionKind, sections_of
from plcopen_sfc.report import ConversionReport, Outcome

RAIL = 0
"""Id of the power rail; those of other elements are their ``UId``, which begin at 21."""
RESULTS = ("TrCoil", "IlCoil", "SvCoil")
"""Coils in which the networks of transitions, interlocks and supervisions end."""
COILS = {"Coil": "none", "SCoil": "set", "RCoil": "reset"}
CARDINALITIES = ("Card", "card")
CONVERT = "Convert"
"""Box of all conversions: its types tell which one it is."""
COUNTED = ("A", "O", "X")
"""Boxes whose only template value is the number of their inputs."""
LISTS = ("AutomaticTyped", "Invisible")
"""Lists of names in a ``Part``: types that follow from the operands, pins that are not shown. Carried with commas."""
PART_NAME = "Part"
"""Extension attribute of a block: the name of its part, where that is another than TIA Portal has for the block."""
INVERTED = "Negated"
"""Extension attribute of a NOT that was the negated input of the coil behind it, as FBD draws it."""
CALL_MARKS = {"BlockNumber": "IntegerAttribute", "ParameterModifiedTS": "DateAttribute"}
"""Attributes of ``CallInfo`` that inform about the called block."""
CALLS = {"FB": "functionblock", "FC": "function"}


@lru_cache(maxsize=1024)
def part_block(name: str) -> StandardBlock | None:
    """Return the standard block that TIA Portal calls `name`, spelled just so."""
    block = standard_block(name, Tool.S7)
    if block is None or s7_name(block) != name:
        return None
    return block


def converting_block(source: str, target: str) -> StandardBlock | None:
    """Conversion that a ``Convert`` is between these types, which it spells just so; None where it is another."""
    if S7_CONVERTED.get(source.upper()) != source or S7_CONVERTED.get(target.upper()) != target or source == target:
        return None
    return standard_block(f"{source}_TO_{target}".upper())


def s7_name(block: StandardBlock) -> str:
    """Return the name of TIA Portal for a standard block."""
    names = block.tools.get(Tool.S7)
    return names.name if names is not None else block.name


def model_pin(block: StandardBlock | None, pin: str) -> str:
    """Return the name of a pin in the model: that of IEC 61131-3 for a standard block."""
    if pin in ("en", "eno"):
        return pin.upper()
    return _standard_pin(block.name, pin) if block is not None else pin


@lru_cache(maxsize=4096)
def _standard_pin(block_name: str, pin: str) -> str:
    block = standard_block(block_name)
    if block is None:
        return pin
    name = block.input_name(pin) or block.output_name(pin)
    return name if name is not None and block.tool_pin(name, Tool.S7) == pin else pin


def template_type(name: str) -> str:
    """Return the type of a ``TemplateValue`` of this name."""
    return "Cardinality" if name in CARDINALITIES else "Type"


_EDGES = frozenset({"R_TRIG", "F_TRIG"})


def put_operands(project: Project, report: ConversionReport, *, of_charts: bool = True) -> None:
    """Make variables of the instances of flip-flops, and boxes with an instance of edges that have one.

    `of_charts`: also of POUs with charts, whose drawn conditions are networks by then.
    """
    own = {pou.name.upper() for pou in project.pous}
    flip_flops, edges = FLIP_FLOPS - own, _EDGES - own
    texts: dict[int, list[TextSite]] = {}
    for text_site in text_sites(project) if any(flip_flop_instances(pou, flip_flops) for pou in project.pous) else ():
        if text_site.is_program_text and text_site.site.pou is not None:
            texts.setdefault(id(text_site.site.pou), []).append(text_site)
    for pou in project.pous if of_charts else [each for each in project.pous if each.chart is None]:
        _put_flip_flops(project, pou, flip_flop_instances(pou, flip_flops), texts.get(id(pou), []), report)
    for _, block in _boxes(project):
        if block.type_name.upper() in edges and block.instance:
            _mark(block, **{PART_NAME: block.type_name.upper(), "Version": S7_VERSION})


def _put_flip_flops(
    project: Project,
    pou: Pou,
    instances: Mapping[str, Variable],
    texts: list[TextSite],
    report: ConversionReport,
) -> None:
    if not instances:
        return
    texts = [
        text_site for text_site in texts if not (isinstance(text_site.holder, Block) and text_site.key == "instance")
    ]
    parsed = [(text_site, text_site.parsed(project.dialect)) for text_site in texts]
    kept = {name for _, found in parsed for name in more_than_outputs(found.tree, instances)}
    for name in sorted(kept):
        why = "TIA Portal has no such function block, and the text uses it otherwise than a box could"
        path = f"POU {pou.name} / {instances[name].name}"
        if not any(each.path == path and each.why == why for each in report.items):  # told before charts were rewritten
            report.add(Outcome.APPROXIMATED, "instance", path, why)
    changed = {name: variable for name, variable in instances.items() if name not in kept}
    for text_site, found in parsed:
        new = render(found, transform(found.tree, lambda node: _value(node, changed)))
        if new != text_site.text:
            text_site.put(new)
    for owner, block in _boxes(project):
        if owner is pou and _name(block.instance) in changed:
            operand = InputPin(expression=block.instance)
            block.parameters.inputs.append(BlockVariable(name="operand", input=operand))
            block.instance = None
    for variable in changed.values():
        variable.type, variable.initial = ElementaryType(name=Elementary.BOOL), None
        why = "flip-flops of TIA Portal keep their state in a variable of type BOOL"
        report.add(Outcome.TRANSLATED, "instance", f"POU {pou.name} / {variable.name}", why)


def _boxes(project: Project) -> Iterator[tuple[Pou, Block]]:
    """Yield the boxes in blocks and in permanent instructions, each with its block."""
    drawn: list[tuple[Pou, object]] = [(pou, body) for _, pou, body in project.bodies()]
    for chart in project.charts():
        drawn += [(chart.pou, each.body) for each in chart.chart.permanent]
    for pou, body in drawn:
        yield from ((pou, node) for network in networks_of(body) for node in network.nodes if isinstance(node, Block))


def _name(instance: str | None) -> str:
    return without_signs(instance or "").casefold()


def _value(node: n.Node, instances: Mapping[str, Variable]) -> n.Node:
    """Return the variable itself for its output ``Q1``."""
    return node.base if isinstance(node, n.Member) and is_output(node, instances) else node


_CALLS = {PouKind.FUNCTION_BLOCK: BlockCall.FUNCTION_BLOCK, PouKind.FUNCTION: BlockCall.FUNCTION}


def mark_calls(project: Project) -> None:
    """Mark each box that calls a function or function block of the project as a call, with the kinds of its pins."""
    callable_ = {pou.name.casefold(): pou for pou in project.pous if pou.kind in _CALLS}
    for _, _, body in project.bodies():
        for network in networks_of(body):
            for node in network.nodes:
                pou = callable_.get(node.type_name.casefold()) if isinstance(node, Block) else None
                if isinstance(node, Block) and pou is not None and node.call in (None, _CALLS[pou.kind]):
                    if pou.kind is PouKind.FUNCTION:
                        _name_pins(node, pou, network)
                    mark_call(node, pou)


def put_standard_blocks(project: Project) -> None:
    """Make standard blocks of other tools parts, with the pins of IEC 61131-3: CODESYS has them as calls."""
    own = {pou.name.casefold() for pou in project.pous}
    for _, _, body in project.bodies():
        for network in networks_of(body):
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
    """Return the standard block that a box is, with its pins renamed; None for calls of blocks of the project."""
    standard = standard_block(block.type_name)
    parameters = (*block.parameters.inputs, *block.parameters.outputs)
    is_native = any(p.extension_data is not None and "Type" in p.extension_data.attributes for p in parameters)
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
            for wire in wires_from(network, block.id):
                if wire.pin == pin.name:
                    wire.pin = RESULT
            pin.name = RESULT
            _mark(pin, Type=write_type(interface.return_type), Section=RETURN)


def mark_call(block: Block, pou: Pou) -> None:
    """Mark a box as a call of a block, with the types and sections of its pins."""
    block.call = _CALLS[pou.kind]
    sections = sections_of(pou.interface)
    declared = {v.name.casefold(): (section.kind, v.type) for section in sections for v in section.variables}
    for group in (block.parameters.inputs, block.parameters.in_outs, block.parameters.outputs):
        for parameter in list(group):
            kind, type_ = declared.get(parameter.name.casefold(), (None, None))
            if kind not in PASSED or type_ is None:
                continue
            _mark(parameter, Type=write_type(type_))  # its section is that of the list that it is in
            if kind is SectionKind.IN_OUT and group is block.parameters.inputs:
                group.remove(parameter)
                block.parameters.in_outs.append(parameter)


def _mark(thing: Block | BlockVariable, **marks: str) -> None:
    thing.extension_data = thing.extension_data or ExtensionData()
    thing.extension_data.attributes = marks | thing.extension_data.attributes
