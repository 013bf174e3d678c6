"""Results of functions: S7 has a variable ``Ret_Val`` for them, other tools the name of the function."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.edits import Edit, apply_edits
from plcopen_sfc.languages.networks.network_graph import wires_of
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.model.body import Body, FbdBody, LdBody, StBody
from plcopen_sfc.model.network import Block, LogicNetwork
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

RESULT = "Ret_Val"
OPERANDS = ("expression", "variable")
"""Fields of elements of networks that hold operands."""


def is_void(section: VariableSection) -> bool:
    """True if S7 says in a section that a function has no result."""
    kinds = [variable.type for variable in section.variables if section.kind is SectionKind.RETURN]
    return len(kinds) == 1 and isinstance(kinds[0], DerivedType) and kinds[0].name.casefold() == "void"


def has_results(project: Project) -> bool:
    """True if a function of a project has its result as S7 has it."""
    return any(_result(pou) is not None for pou in project.pous)


def name_results(project: Project, report: ConversionReport) -> None:
    """Give results of functions of S7 the name of their function, in declarations, texts and networks."""
    named: dict[str, str] = {}
    for pou in project.pous:
        section = _result(pou)
        if section is None or pou.interface is None:
            continue
        pou.interface.return_type = section.variables[0].type
        pou.interface.sections = [other for other in pou.interface.sections if other is not section]
        for body in pou.bodies:
            rename_local(body, RESULT, pou.name)
        named[pou.name.casefold()] = pou.name
        report.add(Outcome.TRANSLATED, "result", pou.report_path, "it has the name of the function")
    for network in _networks(project) if named else ():
        for node in network.nodes:
            name = named.get(node.type_name.casefold()) if isinstance(node, Block) else None
            if isinstance(node, Block) and name is not None:
                _name_pin(network, node, name)


def _result(pou: Pou) -> VariableSection | None:
    """The section with the result of a function of S7; None where it has none, or not as S7 has it."""
    if pou.kind is not PouKind.FUNCTION or pou.interface is None or pou.interface.return_type is not None:
        return None
    found = [section for section in pou.interface.sections if section.kind is SectionKind.RETURN]
    if len(found) != 1 or [variable.name.casefold() for variable in found[0].variables] != [RESULT.casefold()]:
        return None
    type_ = found[0].variables[0].type
    return None if isinstance(type_, DerivedType) and type_.name.casefold() == "void" else found[0]


def _networks(project: Project) -> Iterator[LogicNetwork]:
    for _, _, body in project.bodies():
        if isinstance(body, FbdBody | LdBody):
            yield from body.networks


def _name_pin(network: LogicNetwork, block: Block, name: str) -> None:
    for pin in block.parameters.outputs:
        if pin.name.casefold() == RESULT.casefold():
            for wire in (wire for node in network.nodes for wire in wires_of(node)):
                if wire.source == block.id and wire.pin == pin.name:
                    wire.pin = name
            pin.name = name


def rename_local(body: Body, old: str, new: str) -> None:
    """Call the local variable `old` of a block in SCL `new`."""
    if isinstance(body, StBody):
        body.text = renamed_local(body.text, old, new)
    elif isinstance(body, FbdBody | LdBody):
        for node in (node for network in body.networks for node in network.nodes):
            for field in OPERANDS:
                if (text := getattr(node, field, None)) is not None:
                    setattr(node, field, renamed_local(text, old, new))


def renamed_local(text: str, old: str, new: str) -> str:
    """A text of SCL with the local variable `old` called `new`."""
    if old.casefold() not in text.casefold():
        return text
    spelled = (f"#{old}".casefold(), f'#"{old}"'.casefold())
    tokens = tokenize(text, Dialect.SCL).tokens
    return apply_edits(text, [Edit(*token.span, f"#{new}") for token in tokens if token.value.casefold() in spelled])
