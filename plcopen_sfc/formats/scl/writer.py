"""Writes SCL sources. `reader` is the way back.

What SCL has no words for (charts, actions, tasks ..) is written in comments that the reader takes back, so that nothing
is lost: the text is read as it stands, and what it does not say of the model is put behind it.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.formats.scl.blocks import KEYWORDS
from plcopen_sfc.formats.scl.reader import read_source
from plcopen_sfc.formats.scl.start_values import can_be_assigned, write_start_values
from plcopen_sfc.formats.text import Piece, SourceText, numbered
from plcopen_sfc.languages.declarations import split_units, write_data_type, write_type, write_variable
from plcopen_sfc.languages.declarations.comments import LINE_END, comment_lines
from plcopen_sfc.languages.declarations.kept import keep, kept
from plcopen_sfc.languages.declarations.names import is_quoted_in_scl
from plcopen_sfc.languages.declarations.writing import indent_of, section_head, section_rest
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.pragmas import Change, changes, plain_fields
from plcopen_sfc.languages.s7_globals import data_blocks_of
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import DataBlock, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.text import Text, plain
from plcopen_sfc.model.types import (
    ArrayType,
    DataTypeDeclaration,
    DerivedType,
    EnumType,
    PointerType,
    StructType,
    SubrangeType,
    Variable,
)
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Fate

_SCL = Dialect.SCL
_INDENT = indent_of(_SCL)


def write_pieces(project: Project, report: ConversionReport) -> Piece:
    """The text of a project, in the pieces that an edit replaces."""
    pieces = [*_named(_units(project, report))]
    unreadable = kept(project.carried).get("unreadable")
    if unreadable:
        pieces.append(Piece(("stray", ""), unreadable, apart=True))
    if plain(project.comment):
        pieces.append(Piece(("comment", ""), "\n".join(comment_lines(plain(project.comment), _SCL)), apart=True))
    written = Piece(("file", ""), pieces=tuple(pieces))
    back = read_source(SourceText(written.whole() + "\n", "utf-8")).project
    left = [] if back == project else list(changes(plain_fields(back), plain_fields(project)))
    for change in left:
        _report(change, report)
    if left:
        rest = "\n".join(f"// {{plcopen_sfc {change}}}" for change in left)
        pieces.append(Piece(("rest", ""), rest, apart=True))
    return Piece(("file", ""), pieces=tuple(pieces))


_PROGRAM = frozenset(
    """bodies actions transitions methods kind type initial interface dimensions base global_variables configurations
    applications tag_tables""".split()
)
"""Fields without which a controller does something else."""
_REMARKS = frozenset({"comment", "carried", "global_id", "object_id", "title", "attributes", "declaration"})
"""Fields that change nothing of that, wherever they stand."""


def _report(change: Change, report: ConversionReport) -> None:
    path, _, _ = str(change).partition(" := ")
    fields = [segment for segment in change.path if isinstance(segment, str)]
    if _PROGRAM.isdisjoint(fields) or not _REMARKS.isdisjoint(fields):
        report.add(Fate.CARRIED, fields[-1], path, "SCL has no words for it; it stands in a comment")
    else:
        why = "SCL has no words for it; it stands in a comment, of which TIA Portal takes no notice"
        report.add(Fate.APPROXIMATED, fields[-1], path, why)


def _named(pieces: Iterator[Piece]) -> Iterator[Piece]:
    """`pieces` with keys that differ."""
    made = list(pieces)
    for key, piece in zip(numbered([piece.key for piece in made]), made, strict=True):
        yield piece if key == piece.key else Piece(key, piece.text, piece.pieces, piece.apart, piece.verbatim)


def _units(project: Project, report: ConversionReport) -> Iterator[Piece]:
    for declaration in project.data_types:
        report.add(Fate.KEPT, "data type", f"type {declaration.name}")
        yield Piece(("type", declaration.name), _data_type(declaration), apart=True)
    for pou in project.pous:
        report.add(Fate.KEPT, "POU", f"POU {pou.name}")
        _note_foreign(pou, report)
        yield Piece(("POU", pou.name), pieces=tuple(_named(_pou(pou))), apart=True)
    for block in project.data_blocks:
        report.add(Fate.KEPT, "data block", f"data block {block.name}")
        yield Piece(("data block", block.name), pieces=tuple(_named(_data_block(block))), apart=True)
    for block in data_blocks_of(project):
        report.add(Fate.TRANSLATED, "global variables", block.name, "a data block")
        yield Piece(("data block", block.name), pieces=tuple(_named(_data_block(block))), apart=True)


def _note_foreign(pou: Pou, report: ConversionReport) -> None:
    """Say which declarations of a block are written although TIA Portal does not know them."""
    sections = pou.interface.sections if pou.interface is not None else []
    for section in (section for section in sections if section.kind is not SectionKind.EXTERNAL):
        words = section_head(section, _SCL)[-1]
        if section.kind in _FOREIGN_SECTIONS or section.persistent:
            report.add(Fate.APPROXIMATED, "section", f"POU {pou.name} / {words}", "TIA Portal has no such section")
        for variable in section.variables:
            inner = variable.type
            while isinstance(inner, ArrayType):
                inner = inner.base
            if isinstance(inner, EnumType | SubrangeType | PointerType):
                path = f"POU {pou.name} / {variable.name}"
                report.add(Fate.APPROXIMATED, "type", path, f"TIA Portal has no type {write_type(inner, _SCL)}")


_FOREIGN_SECTIONS = frozenset({SectionKind.GLOBAL, SectionKind.ACCESS})


def _data_type(declaration: DataTypeDeclaration) -> str:
    if not isinstance(declaration.type, StructType):  # SCL declares structures only
        declaration = declaration.model_copy(update={"type": StructType()})
    return write_data_type(declaration, _SCL)


# -- blocks


def _pou(pou: Pou) -> Iterator[Piece]:
    keyword = KEYWORDS.get(pou.kind, KEYWORDS[PouKind.FUNCTION_BLOCK])
    result = pou.interface.return_type if pou.interface is not None else None
    written = f" : {write_type(result, _SCL) if result is not None else 'Void'}"
    yield from _head(keyword, pou.name, written if keyword == "FUNCTION" else "", pou.title, pou.carried)
    yield from _comment(pou.comment)
    for section in pou.interface.sections if pou.interface is not None else []:
        if section.kind is not SectionKind.EXTERNAL:  # S7 declares in no block what is global
            yield _section(section)
    yield Piece(("begin", ""), "BEGIN")
    text = pou.body.text if isinstance(pou.body, StBody) else ""
    yield Piece(("body", ""), text if _stays_inside(text, keyword) else "", verbatim=True)
    yield Piece(("end", ""), f"END_{keyword}")


def _stays_inside(body: str, keyword: str) -> bool:
    """Whether a block ends behind `body`: no comment in it is left open, no end of a block stands in it."""
    end = f"END_{keyword}"
    text = f'{keyword} "x"\nBEGIN\n{body}\n{end}'
    units = split_units(f"{text}\n{keyword} y\n{end}", _SCL).units
    return len(units) == 2 and units[0].span == (0, len(text))


def _head(keyword: str, name: str, result: str, title: Text | None, carried: Carried | None) -> Iterator[Piece]:
    texts = kept(carried)
    quoted = texts.get("name", "quoted" if is_quoted_in_scl(name) else "unquoted") == "quoted"
    written = '"' + LINE_END.sub("_", name).replace('"', "_") + '"' if quoted else name
    lines = [f"{keyword} {written}{result}"]
    if title is not None:
        lines.append(f"TITLE = {LINE_END.sub(' ', plain(title))}")
    lines += [*texts.get("attributes", "").splitlines(), *texts.get("properties", "").splitlines()]
    if texts.get("unreadable"):
        lines.append(texts["unreadable"])
    yield Piece(("head", ""), "\n".join(lines))


def _comment(comment: Text | None) -> Iterator[Piece]:
    text = plain(comment)
    if text:
        yield Piece(("comment", ""), "\n".join(comment_lines(text, _SCL)))


def _section(section: VariableSection) -> Piece:
    head = section_head(section, _SCL)
    struct = kept(section.carried).get("keyword") == "STRUCT"
    words = "STRUCT" if struct else head[-1]
    lines = [*head[:-1], words]
    pieces = [Piece(("head", ""), "\n".join(_INDENT + line for line in lines))]
    pieces += _named(_variable(variable) for variable in section.variables)
    ending = [*section_rest(section, 2 * _INDENT), f"{_INDENT}{'END_STRUCT;' if struct else 'END_VAR'}"]
    pieces.append(Piece(("end", ""), "\n".join(ending)))
    return Piece(("section", head[-1]), pieces=tuple(pieces))


def _variable(variable: Variable) -> Piece:
    return Piece(("variable", variable.name), write_variable(variable, _SCL, 2 * _INDENT))


# -- data blocks


def _data_block(block: DataBlock) -> Iterator[Piece]:
    texts = kept(block.carried)
    sections = block.interface.sections if block.interface is not None else []
    type_name = ""
    if block.type_name is not None:
        quoting: dict[str, str] = {name: "" for name in ("quoted", "unquoted") if name in texts}
        type_name = "\n" + write_type(DerivedType(name=block.type_name, carried=keep(quoting)), _SCL)
    for piece in _head("DATA_BLOCK", block.name, "", block.title, block.carried):
        yield Piece(piece.key, piece.text + type_name)
    yield from _comment(block.comment)
    variables = [variable for section in sections for variable in section.variables]
    assigned = "inline" not in texts and all(can_be_assigned(variable.initial) for variable in variables)
    for section in sections:
        yield _section(_without_values(section) if assigned else section)
    yield Piece(("begin", ""), "BEGIN")
    values = "\n".join(_INDENT + line for line in write_start_values(variables)) if assigned else ""
    yield Piece(("body", ""), texts.get("begin", values), verbatim="begin" in texts)
    yield Piece(("end", ""), "END_DATA_BLOCK")


def _without_values(section: VariableSection) -> VariableSection:
    variables = [variable.model_copy(update={"initial": None}) for variable in section.variables]
    return section.model_copy(update={"variables": variables})
