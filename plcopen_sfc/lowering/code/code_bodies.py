"""Lowered code as the body of a POU, in structured text, FBD, LD or IL, with the interface that it needs."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import count

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.formats.matiec.matiec_statements import compilable_comments
from plcopen_sfc.languages.il_printing import NoInstructionError, statement_instructions
from plcopen_sfc.languages.networks import DrawingRules, DrawnBody, declared_rules, draw_fbd, draw_ld
from plcopen_sfc.languages.networks.element_places import on_one_sheet
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.lexer import CommentKind, tokenize
from plcopen_sfc.languages.st.printing import INDENT, Printer
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, Tool
from plcopen_sfc.languages.translation.text_translation import region_marks
from plcopen_sfc.lowering.code.boolean_logic import remark
from plcopen_sfc.lowering.code.lowered_code import CodeNetwork, LoweredCode
from plcopen_sfc.lowering.lowering_options import Language
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block, LogicNetwork, RightPowerRail
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import Body, SfcBody
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import Interface, SectionKind


def structured_text(code: LoweredCode, dialect: Dialect) -> StBody:
    """Return a paragraph for each network, its title and comment before it, or a region if it is long."""
    printer = _CodePrinter(code, dialect)
    text = "\n\n".join(printer.paragraph(network) for network in code.networks)
    has_pragmas = any(comment.kind is CommentKind.PRAGMA for comment in tokenize(text, dialect).comments)
    return StBody(text=compilable_comments(text, dialect) if not (code.has_line_comments or has_pragmas) else text)


def instruction_list(code: LoweredCode, pou: str) -> IlBody:
    """Return the instructions of each network of `pou`. Raises `LoweringError` for what has none."""
    labels = (i for i in count(1) if code.naming.taken.isdisjoint((f"end{i}", f"else{i}")))
    parts = []
    for network in code.networks:
        place = Location(path=f"{pou} / network {network.title}")
        lines = [line.strip() for line in f"{network.title}\n{network.comment}".splitlines() if line.strip()]
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


class _CodePrinter(Printer):
    """Printer of lowered code: with texts of the chart as they were written, long branches apart, and regions."""

    def __init__(self, code: LoweredCode, dialect: Dialect) -> None:
        super().__init__()
        self._code, self._dialect = code, dialect

    def paragraph(self, network: CodeNetwork) -> str:
        """Return the text of a network."""
        text = self.text(n.Statements(titled(network)))
        if not self._code.has_regions or not network.title or text.count("\n") <= _SHORT:
            return text
        return self.text(n.RegionBlock(network.title, (*remark(network.comment), *network.statements)))

    def lines(self, statements: Iterable[n.Statement], indent: str) -> str:
        """Return the lines of statements, with their text where they have one."""
        left, text = [*statements], ""
        while left:
            count, written = self._code.text_of(left)
            if count:
                text += "".join(f"\n{indent}{line}".rstrip(" ") for line in written.split("\n"))
            else:
                text += super().lines(left[:1], indent)
            del left[: count or 1]
        return text

    def _case(self, node: n.Case, indent: str) -> str:
        # textbooks have an empty line behind each branch, and labels right below their CASE
        is_listing = any(branch.statements[-1:] == (n.Remark(""),) for branch in node.branches)
        deeper = indent if is_listing else indent + INDENT
        texts = [self._with_short_labels(self.text(branch, deeper), deeper) for branch in node.branches]
        apart = not is_listing and any(text.count("\n") > _SHORT for text in texts)
        branches = ("\n\n" if apart else "\n").join(deeper + text for text in texts)
        end = f"\n{self._otherwise(node.otherwise, indent)}{indent}END_CASE;"
        return f"CASE {self.text(node.selector)} OF\n{branches}{end}"

    def _with_short_labels(self, branch: str, indent: str) -> str:
        labels, line_end, statements = branch.partition("\n")
        return (labels if " " not in labels.partition(":")[0] else wrapped(labels, indent)) + line_end + statements

    def _statement(self, node: n.Node, indent: str) -> str:
        if isinstance(node, n.RegionBlock):
            start, end = region_marks(" ".join(node.title.split()), self._dialect)
            return self._block(start, node.statements, end, indent)
        text = super()._statement(node, indent)
        return wrapped(text, indent) if isinstance(node, n.Assignment | n.CallStatement) else text

    def _branch(self, word: str, node: n.Branch, indent: str) -> str:
        head, then, below = super()._branch(word, node, indent).partition(" THEN")
        above, line_end, condition = head.rpartition("\n")
        return above + line_end + wrapped(condition, indent, deeper=2 * INDENT, ends=len(then)) + then + below


_WIDTH = 120
_BREAKS = re.compile(r"""'[^']*'|"[^"]*"|[()\[\]]| (?=(?:OR|XOR|AND) )|(?<=,) """)
_RANKS = {"O": 0, "X": 0, "A": 1}


def wrapped(line: str, indent: str, *, deeper: str = INDENT, ends: int = 0) -> str:
    """Return a line that is too long as several, broken where a person would: before OR, then AND, outer ones first.

    `ends`: so many characters follow it. Lines behind the first one are further to the right.
    """
    room = _WIDTH - len(indent) - len(deeper) - ends
    if len(line.lstrip()) <= _WIDTH - len(indent) - ends:
        return line
    return f"\n{indent}{deeper}".join(_broken(line, room))


def _broken(text: str, room: int) -> list[str]:
    depth = 0
    places: dict[tuple[int, int], list[int]] = {}
    for found in _BREAKS.finditer(text):
        sign = found.group()
        depth += (sign in "([") - (sign in ")]")
        if sign == " ":
            rank = _RANKS.get(text[found.end()], 0)
            places.setdefault((depth, rank), []).append(found.end())
    if len(text.strip()) <= room or not places:
        return [text]
    lines: list[str] = []
    start = 0
    ends = [*places[min(places)], len(text)]
    for end, following in zip(ends, [*ends[1:], None], strict=True):
        if following is None or len(text[start:following].strip()) > room:
            lines += _broken(text[start:end].rstrip(), room)
            start = end
    return lines


def titled(network: CodeNetwork) -> tuple[n.Statement, ...]:
    """Return the statements of a network behind its title and comment; a line break in a name would end the title."""
    return (*remark(" ".join(network.title.split())), *remark(network.comment), *network.statements)


def _drawn(
    code: LoweredCode, draw: Callable[..., DrawnBody[FbdBody] | DrawnBody[LdBody]], rules: DrawingRules, pou: str
) -> list[LogicNetwork]:
    found: list[LogicNetwork] = []
    free = 1
    for network in code.networks:
        place = Location(path=f"{pou} / network {network.title}")
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
    """Return the code as a body in `language`; `declared` are the variables of the POU called `pou`.

    Raises `LoweringError` for what cannot be drawn or has no instructions.
    """
    if language is Language.ST:
        return structured_text(code, dialect)
    if language is Language.IL:
        return instruction_list(code, pou)
    rules = _rules(code, dialect, declared)
    if language is Language.FBD:
        return FbdBody(networks=_drawn(code, draw_fbd, rules, pou))
    return LdBody(networks=_drawn(code, draw_ld, rules, pou))


def _declare(interface: Interface, kind: SectionKind, variables: list[Variable], *, constant: bool = False) -> None:
    if variables:
        section = interface.section(kind, constant=constant)
        section.variables += variables
        section.declaration = None
