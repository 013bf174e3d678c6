"""Variable sections, types and headers of units, as text.

Whatever the declarations of another tool hold, it is written and read back; what did not come back goes into pragmas.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from plcopen_sfc.formats.declaration_blocks import section_block
from plcopen_sfc.formats.iectext.text_outline import PartKind, TextPart, outline
from plcopen_sfc.formats.iectext.text_printing import TextPrinter
from plcopen_sfc.formats.iectext.text_source import INDENT, TextSource, keep_data, kept_texts
from plcopen_sfc.formats.matiec.matiec_declarations import with_quotes
from plcopen_sfc.formats.provenance import read_later
from plcopen_sfc.formats.text_patch import WrittenBlock, plain_lines
from plcopen_sfc.languages.declarations import Declared, read_declarations, write_data_type, write_section, write_type
from plcopen_sfc.languages.declarations.kept_texts import inheritance
from plcopen_sfc.languages.pragmas import Fields, plain_fields
from plcopen_sfc.languages.st.declaration_nodes import KEYWORDS as DECLARATION_KEYWORDS
from plcopen_sfc.languages.st.lexer import Token
from plcopen_sfc.languages.st.nodes import Span
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.late import Mention
from plcopen_sfc.model.types import DataTypeDeclaration, Variable
from plcopen_sfc.model.variables import Interface, VariableSection


def read_section(src: TextSource, part: TextPart, gap: tuple[int, int], place: str) -> list[VariableSection]:
    """``VAR .. END_VAR`` with the comments before it; nothing where it is a section of configurations."""
    return [section for section in _sections(src, part, gap, place) if isinstance(section, VariableSection)]


def are_plain(src: TextSource, parts: Iterable[TextPart]) -> bool:
    """True if sections are certainly without faults, and `late_interface` may read them when a script looks at them.

    They have simple types and values, as 92 of 99 sections of real files of TwinCAT and text.
    """
    return not src.has_changes and all(part.closed and _is_plain(src.outline.tokens(part.tokens)) for part in parts)


def _is_plain(tokens: list[Token]) -> bool:
    marks = [
        _WORDS.get(each.value.upper(), "n") if each.type == "NAME" else _MARKS.get(each.type, "!") for each in tokens
    ]
    return _PLAIN.fullmatch("".join(marks)) is not None


_MARKS = {
    "LITERAL": "l",
    "ADDRESS": "%",
    "ASSIGN": "=",
    "SIGN": "-",
    "RANGE": "~",
    "OF": "o",
    "TO": "t",
    "SEMICOLON": ";",
    "COLON": ":",
    "COMMA": ",",
    "DOT": ".",
    "LPAR": "(",
    "RPAR": ")",
    "LSQB": "[",
    "RSQB": "]",
}
_WORDS = (
    dict.fromkeys(DECLARATION_KEYWORDS, "!")
    | dict.fromkeys(("CONSTANT", "RETAIN", "PERSISTENT"), "q")
    | {"ARRAY": "a", "POINTER": "p", "REFERENCE": "p", "AT": "@"}
)


def _plain_sections() -> re.Pattern[str]:
    """Return the pattern of the marks of the tokens of a plain section."""
    path = r"n(?:\.n)*+"
    value = rf"-?(?:l|{path})"
    array = rf"a\[{value}~{value}(?:,{value}~{value})*+\]o"
    type_ = rf"(?:{array}|pt)*+{path}(?:\({value}\))?+"
    call = rf"\((?:n={value}(?:,n={value})*+)?\)"
    initial = rf"={value}|={call}|=\[{value}(?:,{value})*+\]"
    return re.compile(rf"q*+(?:n(?:,n)*+(?:@%)?+:{type_}(?:{initial})?+;)*+")


_PLAIN = _plain_sections()


def late_interface(src: TextSource, fields: Fields, places: list[tuple[TextPart, Span]]) -> Interface:
    """Return an interface with `fields` whose sections, plain ones, are read when a script looks at them.

    `places` are the parts of the text and the gaps before them.
    """
    starts = [(src.core(*gap)[0], part.end) for part, gap in places]
    src.checked += starts
    texts = [plain_lines(src.text[slice(*span)]) for span in starts]
    dialect = src.outline.dialect

    def whole() -> Interface:
        sections = [section for text in texts for section in read_declarations(text, dialect).sections]
        return Interface.model_validate(fields | {"sections": sections})

    def mentions(wanted: Mention) -> bool:
        return wanted.is_in("\n".join([*texts, head.model_dump_json()]))

    head = Interface.model_validate(fields)
    known = {name: value for name, value in head if name != "sections"}
    return read_later(Interface, known, whole, mentions)


def read_listing(src: TextSource, part: TextPart, gap: tuple[int, int], place: str) -> list[Fields]:
    """``VAR_ACCESS`` or ``VAR_CONFIG`` of a configuration."""
    found = _sections(src, part, gap, place)
    return [plain_fields(section) for section in found if not isinstance(section, VariableSection)]


def _sections(src: TextSource, part: TextPart, gap: tuple[int, int], place: str) -> list[Element]:
    declared = _declared(src, src.core(*gap)[0], part.end, place, "" if part.closed else "\nEND_VAR")
    return [found.thing for found in declared.items if isinstance(found.thing, Element)]


def read_types(src: TextSource, part: TextPart, gap: tuple[int, int]) -> list[Fields]:
    """``TYPE name : .. END_TYPE`` with the comments before it."""
    return [plain_fields(thing) for thing in _declared(src, src.core(*gap)[0], part.end, "", "").types]


def read_return_type(src: TextSource, span: tuple[int, int], place: str) -> Fields:
    """Return the type of the result of a function."""
    text = plain_lines(src.text[slice(*span)])
    heads = read_declarations(f"FUNCTION x : {text}\n", src.outline.dialect).heads
    if heads and heads[0].return_type is not None:
        return plain_fields(heads[0].return_type)
    src.note("IEC111", f"{text!r} is no type", span[0], place)
    return {"kind": "derived", "name": text}


def _declared(src: TextSource, start: int, end: int, place: str, missing: str) -> Declared:
    text = plain_lines(src.text[start:end])
    declared = read_declarations(text + missing, src.outline.dialect)
    src.check(declared.problems, start, end, text, code="IEC111", path=place)
    return declared


_WITHOUT_INTERFACE = frozenset({"ACTION", "TRANSITION"})


def write_interface(
    printer: TextPrinter,
    keyword: str,
    name: str,
    interface: Interface | None,
    *,
    indent: str,
    intended: Fields,
    read_back: Fields,
) -> tuple[str, list[WrittenBlock]]:
    """Header of a unit and its sections; `intended` gets fields of the model, `read_back` those of the text."""
    if keyword in _WITHOUT_INTERFACE:
        return f"{indent}{keyword} {name}{':' if keyword == 'ACTION' else ''}", []
    read_back["interface"] = {}
    if interface is None:
        return _header(printer, keyword, name, None, indent=indent, intended=intended, read_back=read_back), []
    intended["interface"] = plain_fields(interface)
    typed = _as_typed(printer, keyword, name, interface)
    if typed is not None:
        text, read_back["interface"] = typed
        _keep_as_typed(intended["interface"], interface.declaration or "", text)
        return text, []
    header = _header(printer, keyword, name, interface, indent=indent, intended=intended, read_back=read_back)
    sections = [write_section_block(printer, section, indent + INDENT) for section in interface.sections]
    if sections:
        read_back["interface"]["sections"] = [fields for _, fields in sections]
    return header, [block for block, _ in sections]


def _header(
    printer: TextPrinter,
    keyword: str,
    name: str,
    interface: Interface | None,
    *,
    indent: str,
    intended: Fields,
    read_back: Fields,
) -> str:
    words = [keyword, name]
    for place, modifiers, data in kept_texts(intended):
        if place == "modifiers":
            words.insert(1, modifiers)
            keep_data(read_back, data)
    bases = inheritance(interface)
    extension_data = bases.keep()
    if extension_data is not None:
        words.append(bases.text())
        read_back["interface"]["extension_data"] = plain_fields(extension_data)
    header = f"{indent}{' '.join(words)}"
    type_ = interface.return_type if interface is not None else None
    if type_ is None or keyword not in ("FUNCTION", "METHOD"):
        return header
    text = f"{header} : {write_type(type_, printer.dialect)}"
    part, src = _read_back(printer, f"{text}\nEND_{keyword}", keyword)
    if part is None or part.return_type is None or part.parts or "\n" in text:
        return header
    fields = read_return_type(src, part.return_type, "")
    if src.diagnostics:
        return header
    read_back["interface"]["return_type"] = fields
    return text


def _read_back(printer: TextPrinter, text: str, keyword: str) -> tuple[TextPart | None, TextSource]:
    """Return the unit or method that `text` is, if it is just that."""
    whole = text if keyword != "METHOD" else f"FUNCTION_BLOCK x\n{text}\nEND_FUNCTION_BLOCK"
    src = TextSource(outline(whole, printer.dialect))
    parts = src.outline.parts
    if keyword == "METHOD":
        parts = parts[0].parts if len(parts) == 1 else []
    if src.outline.problems or len(parts) != 1 or parts[0].keyword != keyword or not parts[0].closed:
        return None, src
    return parts[0], src


# -- declarations as they were typed ----------------------------------------------------------------------------------


def _as_typed(printer: TextPrinter, keyword: str, name: str, interface: Interface) -> tuple[str, Fields] | None:
    """Return the text of a declaration that can be written as it was typed, and its fields.

    A text without some variable cannot: exports of CODESYS have the variables of SFC flags that the tool declares.
    """
    declaration = interface.declaration
    if declaration is None or "\r" in declaration or "plcopen_sfc" in declaration:
        return None
    text = declaration.rstrip()
    part, src = _read_back(printer, f"{text}\nEND_{keyword}", keyword)
    if part is None or part.name != name or any(inner.kind is not PartKind.VAR for inner in part.parts):
        return None
    end = part.parts[-1].end if part.parts else part.inside[0]
    if src.text[end : part.inside[1]].strip() or text != text.lstrip():
        return None
    read_back: Fields = {}
    if part.return_type is not None:
        read_back["return_type"] = read_return_type(src, part.return_type, "")
    position = part.inside[0]
    for inner in part.parts:
        sections = [plain_fields(section) for section in read_section(src, inner, (position, inner.start), "")]
        position = inner.end
        if any(section.get("variables") for section in sections):
            read_back.setdefault("sections", []).extend(sections)
    declared = {variable["name"] for section in read_back.get("sections", ()) for variable in section["variables"]}
    is_whole = all(variable.name in declared for variable in interface.variables())
    return (text, read_back) if is_whole and not src.diagnostics else None


def _keep_as_typed(fields: Fields, declaration: str, text: str) -> None:
    del fields["declaration"]
    fields["declaration_ends"] = declaration[len(text) :]


# -- sections and types -----------------------------------------------------------------------------------------------


def write_section_block(printer: TextPrinter, section: VariableSection, indent: str) -> tuple[WrittenBlock, Fields]:
    """Return a section as a block, and the fields that a reader takes from it."""
    quoted = [with_quotes(variable, printer.variables) for variable in section.variables]
    section = section.model_copy(update={"variables": quoted})
    variables = [_expressible(printer, variable) for variable in section.variables]
    simple = section.model_copy(update={"variables": variables, "comment": None, "extension_data": None})
    for each in (section, simple):
        block = replace(section_block(each, printer.dialect, indent), key=("section", ""))
        read_back = _section_read_back(printer, block.whole())
        if read_back is not None and len(read_back.get("variables", [])) == len(section.variables):
            return block, read_back
    text = f"{indent}VAR\n{indent}END_VAR"
    return WrittenBlock(("section", ""), text), _section_read_back(printer, text) or {}


def listing_text(printer: TextPrinter, section: VariableSection, intended: Fields) -> tuple[str, Fields] | None:
    """Return a list of global variables as it was typed, and its fields; None where that cannot be in the text."""
    declaration = section.declaration
    if declaration is None or "\r" in declaration or "plcopen_sfc" in declaration:
        return None
    text = declaration.rstrip()
    read_back = _section_read_back(printer, text)
    if read_back is None or text != text.lstrip():
        return None
    read_back.pop("comment", None)
    read_back.pop("extension_data", None)
    _keep_as_typed(intended, declaration, text)
    return text, read_back


def _section_read_back(printer: TextPrinter, text: str) -> Fields | None:
    found = outline(f"PROGRAM x\n{text}\nEND_PROGRAM\n", printer.dialect)
    if found.problems or len(found.parts) != 1 or [p.kind for p in found.parts[0].parts] != [PartKind.VAR]:
        return None
    src = TextSource(found)
    part = found.parts[0].parts[0]
    sections = read_section(src, part, (found.parts[0].inside[0], part.start), "")
    return plain_fields(sections[0]) if len(sections) == 1 and not src.diagnostics else None


def _expressible(printer: TextPrinter, variable: Variable) -> Variable:
    """Return the variable, or one in its place where its declaration does not come back from text."""
    alone = VariableSection(variables=[variable])
    read_back = _section_read_back(printer, write_section(alone, printer.dialect))
    if read_back is not None and len(read_back.get("variables", [])) == 1:
        return variable
    name = variable.name if printer.is_name(variable.name) else printer.new_name(variable.name)
    return Variable.model_validate({"name": name, "type": "BOOL"})


def write_type_text(printer: TextPrinter, declaration: DataTypeDeclaration) -> tuple[str, Fields, Fields]:
    """Return a declaration of a type as text, the fields that a reader takes from it, and those of the model."""
    intended = plain_fields(declaration)
    if declaration.declaration is not None and "plcopen_sfc" not in declaration.declaration:
        text = declaration.declaration.rstrip()
        read_back = _type_read_back(printer, text)
        if read_back is not None and read_back.get("name") == declaration.name and plain_lines(text) == text.lstrip():
            _keep_as_typed(intended, declaration.declaration, text)
            return text, read_back, intended
    text = write_data_type(declaration, printer.dialect)
    read_back = _type_read_back(printer, text)
    if read_back is None:
        name = declaration.name if printer.is_name(declaration.name) else printer.new_name(declaration.name)
        simple = DataTypeDeclaration.model_validate({"name": name, "type": "BOOL"})
        text = write_data_type(simple, printer.dialect)
        read_back = _type_read_back(printer, text) or {}
    return text, read_back, intended


def _type_read_back(printer: TextPrinter, text: str) -> Fields | None:
    found = outline(text + "\n", printer.dialect)
    if found.problems or len(found.parts) != 1 or found.parts[0].kind is not PartKind.TYPE:
        return None
    src = TextSource(found)
    types = read_types(src, found.parts[0], (0, found.parts[0].start))
    return types[0] if len(types) == 1 and not src.diagnostics else None
