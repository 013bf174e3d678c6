"""Lowered code as the body of a POU, in structured text, FBD, LD or IL, with the interface that it needs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import count, pairwise

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.formats.matiec.matiec_statements import compilable_comments
from plcopen_sfc.languages.il_printing import NoInstructionError, statement_instructions
from plcopen_sfc.languages.networks import DrawingRules, DrawnFbd, DrawnLd, declared_rules, draw_fbd, draw_ld
from plcopen_sfc.languages.networks.element_places import on_one_sheet
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.lexer import CommentKind, tokenize
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, Tool
from plcopen_sfc.languages.translation.text_translation import region_marks
from plcopen_sfc.lowering.code.lowered_code import CodeNetwork, LoweredCode, TextNetwork
from plcopen_sfc.lowering.lowering_options import Language
from plcopen_sfc.model.body import Body, FbdBody, IlBody, LdBody, SfcBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block, LogicNetwork, RightPowerRail
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection


def structured_text(code: LoweredCode, dialect: Dialect) -> StBody:
    """Return a paragraph for each network, its title and comment before it, or a region if it is long."""
    text = "\n\n".join(_section(network, dialect, regions=code.has_regions) for network in code.networks)
    has_pragmas = any(comment.kind is CommentKind.PRAGMA for comment in tokenize(text, dialect).comments)
    return StBody(text=compilable_comments(text, dialect) if code.is_portable and not has_pragmas else text)


def function_block_diagram(code: LoweredCode, dialect: Dialect, declared: list[Variable], pou: str) -> FbdBody:
    """Return a network of FBD for each network of `pou`. Raises `LoweringError` for what cannot be drawn."""
    return FbdBody(networks=_drawn(code, draw_fbd, _rules(code, dialect, declared), pou))


def ladder_diagram(code: LoweredCode, dialect: Dialect, declared: list[Variable], pou: str) -> LdBody:
    """Return a network of LD for each network of `pou`. Raises `LoweringError` for what cannot be drawn."""
    return LdBody(networks=_drawn(code, draw_ld, _rules(code, dialect, declared), pou))


def instruction_list(code: LoweredCode, pou: str) -> IlBody:
    """Return the instructions of each network of `pou`. Raises `LoweringError` for what has none."""
    labels = (i for i in count(1) if code.naming.taken.isdisjoint((f"end{i}", f"else{i}")))
    parts = []
    for network in code.networks:
        place = Location(path=f"{pou} / network {network.title}")
        remarks = [network.title, network.comment]
        if isinstance(network, TextNetwork):
            raise LoweringError("structured text is no instruction list", location=place)
        remarks += [text for _, text in sorted(network.remarks.items())]
        lines = [line.strip() for text in remarks for line in text.splitlines() if line.strip()]
        try:
            text = statement_instructions(network.statements, labels)
        except NoInstructionError as error:
            raise LoweringError(
                f"instruction list has no words for {error}", location=place, hint="Structured text can hold it."
            ) from error
        parts.append("\n".join([*(f"(* {line.replace('*)', '* )')} *)" for line in lines), text]))
    return IlBody(text="\n\n".join(parts))


def _rules(code: LoweredCode, dialect: Dialect, declared: list[Variable]) -> DrawingRules:
    """Return how networks are drawn. Boxes of S7 have the names of IEC 61131-3: the writer of the file renames them."""
    rules = declared_rules(declared, dialect, None if code.tool is Tool.S7 else code.tool)
    instances = {name: BLOCKS_OF_S7.get(kind, kind) for name, kind in {**code.instances, **rules.instances}.items()}
    operands = {print_node(name): block for name, block in code.operands.items()}
    return replace(rules, instances=instances, operands=operands)


_SHORT = 3
"""Lines that a reader sees at a glance: what is longer is a region, and apart from what is beside it."""
INDENT = "    "


def _section(network: CodeNetwork | TextNetwork, dialect: Dialect, *, regions: bool) -> str:
    text = paragraph(network)
    title = comment_lines(" ".join(network.title.split()))
    lines = text.splitlines()
    if not regions or not title or len(lines) <= _SHORT + 1:
        return text
    return "\n".join(region(network.title, lines[1:], dialect))


def region(title: str, lines: Sequence[str], dialect: Dialect) -> list[str]:
    """Return lines as a region, which the editor of TIA Portal folds and lists."""
    start, end = region_marks(" ".join(title.split()), dialect)
    return [start, *indented(lines), end]


def indented(lines: Iterable[str]) -> list[str]:
    """Return lines further to the right; empty ones stay empty."""
    return [(INDENT + line).rstrip() for line in lines]


def spaced(parts: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of all parts, with empty lines between them where one of them is long."""
    if all(len(part) <= _SHORT + 1 for part in parts):
        return [line for part in parts for line in part]
    return [line for place, part in enumerate(parts) for line in ([""] * (place > 0) + list(part))]


def paragraph(network: CodeNetwork | TextNetwork) -> str:
    """Return the text of a network, with its title and comment before it."""
    title = " ".join(network.title.split())  # a line break in a name would end the comment
    heading = [*comment_lines(title), *comment_lines(network.comment)]
    if isinstance(network, TextNetwork):
        return "\n".join([*heading, network.text])
    starts = sorted({0, *network.remarks})
    parts = pairwise([*starts, len(network.statements)])
    for start, end in parts:
        heading += comment_lines(network.remarks.get(start, ""))
        heading.append(print_node(n.Statements(network.statements[start:end])))
    return "\n".join(heading)


def comment_lines(text: str) -> list[str]:
    """Return a text as comments, a line each."""
    return [f"// {line}".rstrip() for line in text.splitlines() if line.strip()]


def _drawn(
    code: LoweredCode, draw: Callable[..., DrawnFbd | DrawnLd], rules: DrawingRules, pou: str
) -> list[LogicNetwork]:
    found: list[LogicNetwork] = []
    free = 1
    for network in code.networks:
        place = Location(path=f"{pou} / network {network.title}")
        if isinstance(network, TextNetwork):
            raise LoweringError("structured text is no network", location=place)
        # ids go on through all networks: formats with one sheet need them different
        drawn = draw(network.statements, rules, first_id=free, divided=code.tool is not None)
        for problem in drawn.problems:
            if code.tool is Tool.CODESYS and problem.severity is Severity.WARNING:
                continue  # the text of an EXECUTE box, which CODESYS executes
            boxes = (node for sheet in drawn.body.networks for node in sheet.nodes if node.id == problem.node)
            text = next((node.code for node in boxes if isinstance(node, Block) and node.code), "")
            raise LoweringError(
                f"this cannot be drawn: {' '.join(text.split()) or problem.message}",
                location=place,
                hint="Structured text can hold it, and so can the networks of CODESYS." if text else "",
            )
        if code.tool is Tool.S7:
            _refuse_unnamed_inputs(drawn.body.networks, place)
        free = max((node.id + 1 for sheet in drawn.body.networks for node in sheet.nodes), default=free)
        for sheet in drawn.body.networks:
            if code.tool is Tool.S7:  # where ladders end with their coils
                sheet.nodes = [node for node in sheet.nodes if not isinstance(node, RightPowerRail)]
            sheet.title = code.caption(network.title)
            sheet.comment = network.comment or None
            found.append(sheet)
    if code.one_sheet:
        return [on_one_sheet(found, code.tool)]
    return found


def _refuse_unnamed_inputs(networks: Sequence[LogicNetwork], place: Location) -> None:
    """Refuse boxes of functions that nothing declares: S7 wants the names of their inputs."""
    boxes = (node for network in networks for node in network.nodes if isinstance(node, Block))
    for box in boxes:
        if not all(pin.name for pin in box.parameters.inputs):
            raise LoweringError(
                f"this cannot be drawn for TIA Portal: the inputs of {box.type_name} have no names",
                location=place,
                hint=f"Add the function {box.type_name} to the project, or take structured text.",
            )


def assemble(original: Pou, code: LoweredCode, dialect: Dialect, language: Language) -> Pou:
    """Return a copy of `original` with `code` as its body instead of the chart."""
    interface = original.interface.model_copy(deep=True) if original.interface is not None else Interface()
    interface.declaration = None
    _declare(interface, SectionKind.INPUT, code.inputs)
    _declare(interface, SectionKind.OUTPUT, code.outputs)
    _declare(interface, SectionKind.LOCAL, code.variables)
    _declare(interface, SectionKind.LOCAL, code.constants, constant=True)  # behind the variables, as in TIA Portal
    _declare(interface, SectionKind.EXTERNAL, code.flags.external if code.flags is not None else [])
    body = body_of(code, dialect, language, interface.variables(), original.name)
    lowered = original.model_copy(deep=True, update={"bodies": [], "object_id": None})
    lowered.interface = interface
    lowered.bodies = [body, *(b for b in original.bodies if not isinstance(b, SfcBody))]
    return lowered


def body_of(code: LoweredCode, dialect: Dialect, language: Language, declared: list[Variable], pou: str) -> Body:
    """Return the code as a body in `language`; `declared` are the variables of the POU called `pou`."""
    if language is Language.ST:
        return structured_text(code, dialect)
    if language is Language.IL:
        return instruction_list(code, pou)
    if language is Language.FBD:
        return function_block_diagram(code, dialect, declared, pou)
    return ladder_diagram(code, dialect, declared, pou)


def _declare(interface: Interface, kind: SectionKind, variables: list[Variable], *, constant: bool = False) -> None:
    """Declare variables in the section of their kind: a block of TIA Portal has each section once."""
    if not variables:
        return
    plain = VariableSection(kind=kind, constant=constant)
    for section in interface.sections:
        if all(getattr(section, name) == getattr(plain, name) for name in _ATTRIBUTES):
            section.variables += variables
            section.declaration = None
            return
    plain.variables = variables
    interface.sections.append(plain)


_ATTRIBUTES = ("kind", "name", "constant", "retain", "nonretain", "persistent", "nonpersistent")
