"""External source files in SCL: read, write, and put edits into the text. `scl_reader` reads them.

Content that SCL cannot express (charts, actions, tasks ..) is written in comments that the reader takes back, so that
nothing is lost: the text is read as it is, and the rest of the model is put behind it.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import pairwise

from plcopen_sfc.formats.declaration_blocks import section_block
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.remainder_comments import keys_of
from plcopen_sfc.formats.scl.scl_reader import (
    DECLARED,
    KEYWORDS,
    OWN_COMMENT,
    can_be_assigned,
    read_source,
    start_values,
    write_start_values,
)
from plcopen_sfc.formats.text_codec import TextCodec
from plcopen_sfc.formats.text_encoding import SourceText
from plcopen_sfc.formats.text_patch import BlockSpan, Key, WrittenBlock, numbered_blocks
from plcopen_sfc.languages.declarations import (
    read_declarations,
    split_units,
    write_data_type,
    write_type,
    write_variable,
)
from plcopen_sfc.languages.declarations.declaration_comments import LINE_END, comment_lines
from plcopen_sfc.languages.declarations.declaration_writing import indent_of, section_head, write_value
from plcopen_sfc.languages.declarations.kept_texts import keep, kept
from plcopen_sfc.languages.declarations.type_names import SECTION_KEYWORDS, is_unit_quoted_in_scl
from plcopen_sfc.languages.pragmas import DEFAULT, Named, RemainderEntry, changes, plain_fields
from plcopen_sfc.languages.s7_globals import (
    UNCALLED,
    by_retention,
    called_actions,
    data_blocks_of,
    is_retained,
    left_out,
    local_tags,
    open_address,
    tag_tables_of,
    unconnected,
)
from plcopen_sfc.languages.s7_programs import is_void, report_program, report_tasks, s7_programs
from plcopen_sfc.languages.s7_types import NO_START, S7Types, is_too_long, s7_types
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.text_edits import Edit, apply_edits, without
from plcopen_sfc.model import types as t
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.compare import in_order_of, path_of
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import DataBlock, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.model.text import Text, plain
from plcopen_sfc.model.variables import SectionKind, VariableSection, sections_of
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import Cause, CauseKind, ConversionReport, Outcome

_SCL = Dialect.SCL
_INDENT = indent_of(_SCL)


def write_pieces(project: Project, report: ConversionReport) -> WrittenBlock:
    """Return the text of a project, in the pieces that an edit replaces."""
    pieces = _in_order_of_use(numbered_blocks(_units(project, report)))
    unreadable = kept(project.extension_data).get("unreadable")
    if unreadable:
        pieces.append(WrittenBlock(("stray", ""), unreadable, apart=True))
    if plain(project.comment):
        pieces.append(WrittenBlock(("comment", ""), "\n".join(comment_lines(plain(project.comment), _SCL)), apart=True))
    # the text is read back, and whatever differs goes into comments: no list of what SCL lacks can be incomplete
    written = WrittenBlock(("file", ""), blocks=tuple(pieces))
    back = read_source(SourceText(written.whole() + "\n", "utf-8")).project
    meant = in_order_of(project, back)
    left = [] if back == meant else list(changes(plain_fields(back), plain_fields(meant), guarded=True))
    other = {change.path for change in changes(plain_fields(back), plain_fields(_as_written(meant, _types(project))))}
    told: set[str] = set()
    labels: dict[int, dict[int, str]] = {}
    for change in left:
        path = path_of(meant, keys_of(meant, change), labels)
        _report(meant, change, path, report, says_the_same=change.path not in other, told=told)
    if left:
        rest = "\n".join(f"// {{plcopen_sfc {change}}}" for change in left)
        pieces.append(WrittenBlock(("rest", ""), rest, apart=True))
    return WrittenBlock(("file", ""), blocks=tuple(pieces))


_EXECUTED = {
    "type": "SCL has no such type: what it declares instead does not compile, or is another type",
    "initial": "SCL has no place for this start value: it starts with the usual value of its type",
    "interface": "SCL has no such declaration",
    "tag_tables": "a source declares no tags and user constants: they must be in the project already",
}
"""Fields that a controller executes, and its behaviour without them."""
_REMARKS = frozenset({"comment", "extension_data", "global_id", "object_id", "title", "attributes", "declaration"})
"""Fields that change nothing of that, wherever they are."""
_REPORTED = frozenset(
    """global_variables configurations applications bodies actions methods transitions kind address""".split()
)
"""Fields whose effect on the execution the report lists elsewhere."""


def _report(
    project: Project,
    change: RemainderEntry,
    path: str,
    report: ConversionReport,
    *,
    says_the_same: bool,
    told: set[str],
) -> None:
    """Report a comment of the text. `told`: the lists of sections that are reported already, as one for each POU."""
    fields = [segment for segment in change.path if isinstance(segment, str)]
    if says_the_same and fields[-2:] in (["interface", "sections"], ["sections", "variables"]):
        owner = ObjectPath.of(path).owner
        if owner not in told:
            told.add(owner)
            report.add(Outcome.TRANSLATED, "sections", owner, "in the sections of S7")
        return
    why = next((_EXECUTED[field] for field in reversed(fields) if field in _EXECUTED), None)
    if says_the_same:
        report.add(Outcome.TRANSLATED, fields[-1], path, "in the types of S7")
    elif why is None or not (_REMARKS | _REPORTED).isdisjoint(fields) or _is_empty(change) or _is_copy(project, change):
        report.add(Outcome.EXTENSION_DATA, fields[-1], path, "SCL cannot express it; it is in a comment")
    else:
        report.add(Outcome.NOT_EXECUTED, fields[-1], path, why)


def _is_empty(change: RemainderEntry) -> bool:
    """True for a section without variables, and for the interface of a POU that has none."""
    if change.path[-1] == "interface":
        return change.value is DEFAULT and not change.instead
    is_section = len(change.path) > 1 and change.path[-2] == "sections"
    return is_section and isinstance(change.value, dict) and not change.value.get("variables")


def _is_copy(project: Project, change: RemainderEntry) -> bool:
    """True for a part of the interface of an instance, which repeats that of its block."""
    if change.path[0] != "data_blocks" or len(change.path) < _IN_A_BLOCK:
        return False
    name = change.path[1].name if isinstance(change.path[1], Named) else None
    return any(block.name == name and block.type_name is not None for block in project.data_blocks)


_IN_A_BLOCK = 2


def _as_written(project: Project, types: S7Types) -> Project:
    """Return a copy of `project` with the types, values and numbers that its text has for those of the project."""
    copy, literals, tags = project.model_copy(deep=True), _literals(project), local_tags(project)
    for pou in copy.pous:
        if pou.interface is not None:
            pou.interface.sections = list(_sections(pou, types, tags.get(pou.name.casefold(), ())))
    for block in copy.data_blocks:
        if block.interface is not None:
            block.interface.sections = [each for section in block.interface.sections for each in _by_retention(section)]
            for section in block.interface.sections:
                section.variables = [_in_block(variable, types) for variable in section.variables]
    for interface in (pou.interface for pou in copy.pous if pou.interface is not None):
        void = next((section for section in interface.sections if is_void(section)), None)
        if void is not None:
            interface.sections = [section for section in interface.sections if section is not void]
            interface.return_type = void.variables[0].type
        if interface.return_type is not None:
            interface.return_type = types.type(interface.return_type)
        for section in interface.sections:
            section.variables = [_in_s7(variable, types) for variable in section.variables]
    for declaration in copy.data_types:
        declaration.type, declaration.initial = _struct(declaration, types), None
    for body in (pou.body for pou in copy.pous):
        if isinstance(body, StBody):
            body.text = _with_literals(body.text, literals)
    return copy


def _units(project: Project, report: ConversionReport) -> Iterator[WrittenBlock]:
    types, called, tags = _types(project), called_actions(project), local_tags(project)
    literals = _literals(project)
    for declaration in project.data_types:
        report.add(Outcome.KEPT, "data type", f"type {declaration.name}")
        as_struct = declaration.model_copy(update={"type": _struct(declaration, types)})
        yield WrittenBlock(("type", declaration.name), write_data_type(as_struct, _SCL), apart=True)
    for pou in project.pous:
        report.add(Outcome.KEPT, "POU", f"POU {pou.name}")
        _note_foreign(project, pou, types, tags.get(pou.name.casefold(), ()), report)
        for what, name, why in _not_executed(pou, called):
            outcome = Outcome.EXTENSION_DATA if why == UNCALLED else Outcome.NOT_EXECUTED
            report.add(outcome, what, ObjectPath(f"POU {pou.name}", name), why)
        yield WrittenBlock(
            ("POU", pou.name),
            blocks=numbered_blocks(_pou(pou, types, tags.get(pou.name.casefold(), ()), literals)),
            apart=True,
        )
    for block in project.data_blocks:
        report.add(Outcome.KEPT, "data block", f"data block {block.name}")
        yield WrittenBlock(("data block", block.name), blocks=numbered_blocks(_data_block(block, types)), apart=True)
    for what, name, why in left_out(project):
        report.add(Outcome.NOT_EXECUTED, what, name, why)
    declared = _named_in_declarations(project, types)
    for table in tag_tables_of(project):
        for name in [*(tag.name for tag in table.tags), *(constant.name for constant in table.constants)]:
            if name.casefold() in literals and name.casefold() not in declared:
                report.add(Outcome.TRANSLATED, "global variable", name, "its value is in the texts")
            else:
                why = "a source declares no tags and user constants: it must be in the project already"
                report.add(Outcome.NOT_EXECUTED, "global variable", name, why)
    for what, name, why in unconnected(project):
        report.add(Outcome.NOT_EXECUTED, what, name, why)
    report_tasks(project, report)
    for pou in (pou for pou in project.pous if pou.kind is PouKind.PROGRAM):
        report_program(project, pou, report)
    programs = s7_programs(project)
    for block in data_blocks_of(project):
        report.add(Outcome.TRANSLATED, "global variables", block.name, "a data block")
    for block in (*data_blocks_of(project), *programs.blocks):
        yield WrittenBlock(("data block", block.name), blocks=numbered_blocks(_data_block(block, types)), apart=True)
    for caller in programs.callers:
        caller.block.bodies = [StBody(text="\n".join(f'"{name}"();' for name, _ in caller.called))]
        yield WrittenBlock(
            ("POU", caller.block.name), blocks=numbered_blocks(_pou(caller.block, types, (), literals)), apart=True
        )


def _in_order_of_use(units: Sequence[WrittenBlock]) -> list[WrittenBlock]:
    """Return units with each behind those that it names, else in their order.

    TIA Portal generates blocks from a source from its beginning to its end: what a block calls comes before it.
    """
    by_name = {unit.key[1].casefold(): unit for unit in units}
    waiting, found = list(reversed(units)), dict[Key, WrittenBlock]()
    begun: set[Key] = set()
    while waiting:
        unit = waiting.pop()
        if unit.key in begun:
            found.setdefault(unit.key, unit)
            continue
        begun.add(unit.key)
        words = [token.value for token in tokenize(unit.whole(), _SCL).tokens]
        # members and local variables may have the names of blocks
        named = {word.strip('"').casefold() for before, word in pairwise(["", *words]) if before not in ("#", ".")}
        used = [by_name[name] for name in by_name.keys() & named if by_name[name].key not in begun]
        waiting += [unit, *sorted(used, key=units.index, reverse=True)]
    return list(found.values())


def _named_in_declarations(project: Project, types: S7Types) -> set[str]:
    """Return the names, in lower case, that bounds and start values have in quotation marks when they are written."""
    interfaces = [*(pou.interface for pou in project.pous), *(block.interface for block in project.data_blocks)]
    variables = [variable for interface in interfaces if interface is not None for variable in interface.variables()]
    declared = [_struct(each, types) for each in project.data_types]
    texts = [write_variable(_in_s7(each, types), _SCL, "") for each in variables]
    texts += [write_type(each, _SCL) for each in declared]
    return {
        token.value.strip('"').casefold()
        for text in texts
        for token in tokenize(text, _SCL).tokens
        if token.value.startswith('"')
    }


def _not_executed(pou: Pou, called: frozenset[int]) -> Iterator[tuple[str, str, str]]:
    """Behaviour of a block in other tools that an SCL source does not have: kind, name, and the consequence.

    `called`: the ids of the actions that a step has or a program calls.
    """
    keyword = KEYWORDS.get(pou.kind, KEYWORDS[PouKind.FUNCTION_BLOCK])
    for number, body in enumerate(pou.bodies):
        if not isinstance(body, StBody) or number:
            what, why = "body", "SCL has programs in structured text only"
            if isinstance(body, SfcBody):
                what, why = "chart", "SCL has no charts; `plcopen-sfc lower --to scl` makes code of them"
            yield what, "", f"the block is empty and does nothing: {why}"
        elif not _stays_inside(body.text, keyword):
            yield "body", "", "the block is empty and does nothing: its text would end the block before its end"
    for action in pou.actions:
        if action.body is not None:
            why = "blocks of S7 have no actions: what calls it does not execute it"
            yield "POU action", f"action {action.name}", why if id(action) in called else UNCALLED
    for method in pou.methods:
        yield "method", f"method {method.name}", "blocks of S7 have no methods: what calls it does not execute it"


def _note_foreign(project: Project, pou: Pou, types: S7Types, tags: Container[str], report: ConversionReport) -> None:
    """Report the declarations of a block that are written although TIA Portal does not know them."""
    for section in (section for section in sections_of(pou.interface) if section.kind is not SectionKind.EXTERNAL):
        words = section_head(section, _SCL)[-1]
        if section.persistent:
            why = "its variables are kept when the power fails, and not when the block is loaded again"
            report.add(Outcome.APPROXIMATED, "section", f"POU {pou.name} / {words}", why)
        if section.kind in _FOREIGN_SECTIONS:
            report.add(Outcome.NOT_EXECUTED, "section", f"POU {pou.name} / {words}", "TIA Portal has no such section")
        for variable in section.variables:
            path = f"POU {pou.name} / {variable.name}"
            is_passed = section.kind in (SectionKind.INPUT, SectionKind.IN_OUT)  # in calls of the function
            own = variable.initial is not None or not is_passed
            if own and types.start(variable) is not None and not _has_start_values(section, pou):
                report.add(Outcome.NOT_EXECUTED, "initial", path, NO_START)
            if (told := open_address(project, variable)) is not None:
                report.add(Outcome.APPROXIMATED, "address", path, told)
            elif (variable.address or "").startswith("%") and variable.name.casefold() not in tags:
                why = f"variables of blocks have no address in S7: it is not connected to {variable.address}"
                report.add(Outcome.NOT_EXECUTED, "address", path, why)
            whole = types.type(variable.type)
            inner = t.element_type(whole)
            is_foreign = is_too_long(whole) or (isinstance(whole, t.ArrayType) and isinstance(whole.base, t.ArrayType))
            if isinstance(inner, t.PointerType) or is_foreign:
                lacking = write_type(inner if isinstance(inner, t.PointerType) else whole, _SCL)
                why = f"TIA Portal has no type {lacking}"
                report.add(Outcome.NOT_EXECUTED, "type", path, why, Cause(CauseKind.LACKING, lacking))


_FOREIGN_SECTIONS = frozenset({SectionKind.GLOBAL, SectionKind.ACCESS})


def _struct(declaration: t.DataTypeDeclaration, types: S7Types) -> t.StructType:
    """Return the structure for a data type: SCL declares no others."""
    if isinstance(declaration.type, t.StructType):
        members = [_in_s7(member, types) for member in declaration.type.members]
        return declaration.type.model_copy(update={"members": members})
    return t.StructType(members=[t.Variable(name="Value", type=types.type(declaration.type))])


def _in_s7(variable: t.Variable, types: S7Types) -> t.Variable:
    """Return a variable with the type and the start value that S7 has for its own."""
    type_ = types.type(variable.type)
    if isinstance(type_, t.StructType):
        type_ = type_.model_copy(update={"members": [_in_s7(member, types) for member in type_.members]})
    address = None if (variable.address or "").startswith("%") else variable.address  # AT names another variable in SCL
    return variable.model_copy(update={"type": type_, "initial": types.start(variable), "address": address})


def _in_block(variable: t.Variable, types: S7Types) -> t.Variable:
    """Return a variable of a data block in S7: assignments give the values of members that no declaration can have."""
    found = _in_s7(variable, types)
    if not isinstance(found.type, t.StructType) or found.initial is not None:
        return found
    type_, value = _without_elements(found.type)
    return found if value is None else found.model_copy(update={"type": type_, "initial": value})


def _without_elements(type_: t.StructType) -> tuple[t.StructType, t.StructValue | None]:
    """Return a structure without start values of single elements and of structures, and these values."""
    members: list[t.Variable] = []
    values: list[t.MemberValue] = []
    for member in type_.members:
        kind, value = _without_elements(member.type) if isinstance(member.type, t.StructType) else (member.type, None)
        own = member.initial if member.initial is not None and not write_value(member.initial, _SCL) else None
        given = own or value
        if given is not None:
            values.append(t.MemberValue(member=member.name, value=given))
        members.append(member.model_copy(update={"type": kind, "initial": None if own is not None else member.initial}))
    if not values:
        return type_, None
    return type_.model_copy(update={"members": members}), t.StructValue(members=values)


def _has_start_values(section: VariableSection, pou: Pou) -> bool:
    """True if S7 has start values of the variables of a section: function blocks have, but of temporary ones."""
    is_constant = section.constant or section.kind is SectionKind.CONSTANT
    return is_constant or (pou.kind is not PouKind.FUNCTION and section.kind is not SectionKind.TEMP)


def _in_scl(section: VariableSection, pou: Pou, types: S7Types) -> VariableSection:
    """Return a section as SCL has it: functions have no static variables and no start values."""
    texts = dict(kept(section.extension_data))
    if texts.get("keyword", "VAR") not in SECTION_KEYWORDS.values() and texts.get("keyword") != "STRUCT":
        section = section.model_copy(update={"extension_data": None})
    if section.persistent:
        section = section.model_copy(update={"persistent": False, "retain": True})
    temporary = pou.kind is PouKind.FUNCTION and section.kind is SectionKind.LOCAL and not section.constant
    if not _has_start_values(section, pou):
        variables = [_in_s7(v, types).model_copy(update={"initial": None}) for v in section.variables]
        section = section.model_copy(update={"variables": variables})
    return section.model_copy(update={"kind": SectionKind.TEMP, "retain": False}) if temporary else section


def _types(project: Project) -> S7Types:
    """Return the types of S7, with the values of constants in declarations."""
    return s7_types(project, _literals(project))


def _literals(project: Project) -> dict[str, str]:
    """Values of enumerations and of constants of lists, by their names in lower case: a source declares neither."""
    found = {each.name.casefold(): str(each.number) for each in s7_types(project).constants}
    for constant in (each for table in tag_tables_of(project) for each in table.constants):
        if isinstance(constant.initial, t.SimpleValue) and constant.initial.text:
            found[constant.name.casefold()] = constant.initial.text
    return found


def _with_literals(text: str, literals: Mapping[str, str]) -> str:
    """Return a text with values in place of the constants in `literals`."""
    edits = []
    for token in tokenize(text, _SCL).tokens if literals else ():
        value = literals.get(token.value.strip('"').casefold()) if token.value.startswith('"') else None
        if value is not None:
            edits.append(Edit(*token.span, value))
    return apply_edits(text, edits)


# -- blocks


def _pou(pou: Pou, types: S7Types, tags: Container[str], literals: Mapping[str, str]) -> Iterator[WrittenBlock]:
    keyword = KEYWORDS.get(pou.kind, KEYWORDS[PouKind.FUNCTION_BLOCK])
    result = pou.interface.return_type if pou.interface is not None else None
    written = f" : {write_type(types.type(result), _SCL) if result is not None else 'Void'}"
    yield from _head(keyword, pou.name, written if keyword == "FUNCTION" else "", pou.title, pou.extension_data)
    yield from _comment(pou.comment)
    yield from (_section(section, types) for section in _sections(pou, types, tags) if not is_void(section))
    yield WrittenBlock(("begin", ""), "BEGIN")
    text = _with_literals(pou.body.text, literals) if isinstance(pou.body, StBody) else ""
    yield WrittenBlock(("body", ""), text if _stays_inside(text, keyword) else "", verbatim=True)
    yield WrittenBlock(("end", ""), f"END_{keyword}")


def _sections(pou: Pou, types: S7Types, tags: Container[str]) -> Iterator[VariableSection]:
    """Yield the sections of a block as SCL has them. `tags`: the names of variables that are tags."""
    for section in sections_of(pou.interface):
        if section.kind is not SectionKind.EXTERNAL:  # S7 has no declarations of global variables in blocks
            members = [variable for variable in section.variables if variable.name.casefold() not in tags]
            if len(members) < len(section.variables):
                section = section.model_copy(update={"variables": members})  # noqa: PLW2901
            yield _in_scl(section, pou, types)


@lru_cache(maxsize=4)  # for the report and for the text
def _stays_inside(body: str, keyword: str) -> bool:
    """True if a block ends behind `body`: no comment in it is left open, no end of a block is in it."""
    end = f"END_{keyword}"
    text = f'{keyword} "x"\nBEGIN\n{body}\n{end}'
    units = split_units(f"{text}\n{keyword} y\n{end}", _SCL).units
    return len(units) == 2 and units[0].span == (0, len(text))


def _head(
    keyword: str, name: str, result: str, title: Text | None, extension_data: ExtensionData | None
) -> Iterator[WrittenBlock]:
    texts = kept(extension_data)
    quoted = texts.get("name", "quoted" if is_unit_quoted_in_scl(name) else "unquoted") == "quoted"
    written = '"' + LINE_END.sub("_", name).replace('"', "_") + '"' if quoted else name
    lines = [f"{keyword} {written}{result}"]
    if title is not None:
        lines.append(f"TITLE = {LINE_END.sub(' ', plain(title))}")
    lines += [*texts.get("attributes", "").splitlines(), *texts.get("properties", "").splitlines()]
    if texts.get("unreadable"):
        lines.append(texts["unreadable"])
    yield WrittenBlock(("head", ""), "\n".join(lines))


def _comment(comment: Text | None) -> Iterator[WrittenBlock]:
    text = plain(comment)
    if text:
        yield WrittenBlock(("comment", ""), "\n".join(comment_lines(text, _SCL)))


def _section(section: VariableSection, types: S7Types) -> WrittenBlock:
    variables = [_in_s7(variable, types) for variable in section.variables]
    return section_block(section.model_copy(update={"variables": variables}), _SCL)


# -- data blocks


def _data_block(block: DataBlock, types: S7Types) -> Iterator[WrittenBlock]:
    texts = kept(block.extension_data)
    sections = sections_of(block.interface)
    sections = [
        section.model_copy(update={"variables": [_in_block(variable, types) for variable in section.variables]})
        for section in sections
    ]
    variables = [variable for section in sections for variable in section.variables]
    type_name = ""
    if block.type_name is not None:
        quoting: dict[str, str] = {name: "" for name in ("quoted", "unquoted") if name in texts}
        type_name = "\n" + write_type(t.DerivedType(name=block.type_name, extension_data=keep(quoting)), _SCL)
    for piece in _head("DATA_BLOCK", block.name, "", block.title, _retained(block)):
        yield WrittenBlock(piece.key, piece.text + type_name)
    yield from _comment(block.comment)
    body = texts.get("unread", _begin(texts, variables, types))
    assigned = "inline" not in texts and all(can_be_assigned(variable, types.declared) for variable in variables)
    for section in sections if block.type_name is None else ():
        declared = section.variables
        if body is not None and "unread" not in texts:
            declared = [_declared(variable, texts) for variable in declared]
        elif body is None and assigned:
            declared = [_without_value(variable) for variable in declared]
        for written in _of_block(section.model_copy(update={"variables": declared})):
            yield _section(written, types)
    yield WrittenBlock(("begin", ""), "BEGIN")
    values = ""
    if assigned or block.type_name is not None:
        given = [variable for variable in variables if can_be_assigned(variable, types.declared)]
        values = "\n".join(_INDENT + line for line in write_start_values(given, types.declared))
    yield WrittenBlock(("body", ""), values if body is None else body, verbatim=body is not None)
    yield WrittenBlock(("end", ""), "END_DATA_BLOCK")


def _begin(texts: dict[str, str], variables: list[t.Variable], types: S7Types) -> str | None:
    """Return the text between BEGIN and END_DATA_BLOCK as it was read; None where the initial values are others now."""
    text = texts.get("begin")
    if text is None:
        return None
    declared = [_declared(variable, texts) for variable in variables]
    found = start_values(text, declared, types.declared)
    if found is None:
        return None
    values = [found.get(variable.name.casefold(), variable.initial) for variable in declared]
    return text if values == [variable.initial for variable in variables] else None


def _declared(variable: t.Variable, texts: dict[str, str]) -> t.Variable:
    """Return a variable of a data block with the value of its declaration, which assignments may replace."""
    if "inline" not in texts:
        return _without_value(variable)
    kept_texts = kept(variable.extension_data)
    if DECLARED not in kept_texts:
        return variable
    text = kept_texts[DECLARED]
    found = read_declarations(f"VAR x : INT := {text}; END_VAR", _SCL).sections if text else []
    initial = found[0].variables[0].initial if found and found[0].variables else None
    return variable.model_copy(update={"initial": initial})


def _without_value(variable: t.Variable) -> t.Variable:
    return variable.model_copy(update={"initial": None})


def _retained(block: DataBlock) -> ExtensionData | None:
    """Extension data of a data block. Its head has RETAIN where all variables of its structure are retained."""
    texts = kept(block.extension_data)
    sections = sections_of(block.interface)
    words = texts.get("properties", "").splitlines()
    if not sections or not (block.type_name is not None or "RETAIN" in words or any(map(_is_struct, sections))):
        return block.extension_data
    retain = all(is_retained(section, variable) for section in sections for variable in section.variables)
    if retain is not ("RETAIN" in words):
        words = [word for word in words if word not in ("RETAIN", "NON_RETAIN")] + ["RETAIN"] * retain
    return keep(texts | {"properties": "\n".join(words)} if words else texts)


def _is_struct(section: VariableSection) -> bool:
    return kept(section.extension_data).get("keyword") == "STRUCT"


def _of_block(section: VariableSection) -> list[VariableSection]:
    """Return a section of a data block: the head of the block tells that a structure is retained."""
    return [section.model_copy(update={"retain": False})] if _is_struct(section) else _by_retention(section)


def _by_retention(section: VariableSection) -> list[VariableSection]:
    """Return a section of a data block as the sections that are read back."""
    return [section] if _is_struct(section) else list(by_retention(section))


class SclCodec(TextCodec):
    """External source files in SCL, as TIA Portal writes them."""

    encoding = "utf-8-sig"
    newline = "\r\n"

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a source. What does not parse is kept and reported."""
        found = read_source(self.decode(data), file)
        return ReadResult(found.project, found.diagnostics)

    def without_own_comments(self, text: str) -> str:
        comments = split_units(text, Dialect.SCL).comments if OWN_COMMENT.search(text) else ()
        return without(text, [comment.span for comment in comments if OWN_COMMENT.match(comment.text)])

    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        return write_pieces(project, report)

    def located(self, content: bytes) -> tuple[Project, SourceText, BlockSpan]:
        source = self.decode(content)
        found = read_source(source)
        return found.project, source, found.spans


CODEC = SclCodec()
