"""Reads external source files of TIA Portal and STEP 7: blocks, data blocks and data types in SCL.

Besides the model it finds the place of each object in the text, so that edits can be put there. Start values of data
blocks are the assignments between BEGIN and END_DATA_BLOCK. `scl_codec` is the way back.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator, Sequence

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.formats.declaration_blocks import head_places, section_places
from plcopen_sfc.formats.remainder_comments import DAMAGED, OUTDATED, put_back, read_entries
from plcopen_sfc.formats.text_encoding import SourceText
from plcopen_sfc.formats.text_patch import Place, ReadText, block_span, plain_lines
from plcopen_sfc.languages.declarations import Declared, DeclaredUnit, Head, read_declarations, split_units, write_value
from plcopen_sfc.languages.declarations.declaration_comments import comment_text
from plcopen_sfc.languages.declarations.kept_texts import keep, kept
from plcopen_sfc.languages.declarations.type_names import is_unit_quoted_in_scl, is_unreserved
from plcopen_sfc.languages.problems import Lines, Problem
from plcopen_sfc.languages.s7_types import number_of, s7_types
from plcopen_sfc.languages.st import declaration_nodes as d
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_statements
from plcopen_sfc.languages.start_values import Path, Types, ValuePathError, apart, assembled
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import DataBlock, DataBlockKind, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DerivedType, SimpleValue, StructType, Value, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection

DECLARED = "declared"
"""Extension data of a variable whose declaration has another value than its assignment: that of the declaration."""


def start_values(text: str, variables: list[Variable], types: Types) -> dict[str, Value] | None:
    """Return the initial values that assignments give to `variables`, by name in lower case; None if they hold more.

    They count instead of those of the declarations, element by element.
    """
    parsed = parse_statements(text, Dialect.SCL)
    if parsed.problems:
        return None
    named = {variable.name.casefold(): variable for variable in variables}
    given: dict[str, dict[Path, tuple[Path, str]]] = {}
    for statement in parsed.tree.statements:
        if isinstance(statement, n.Empty):
            continue
        if not isinstance(statement, n.Assignment) or statement.kind is not n.AssignmentKind.ASSIGN:
            return None
        path, span = _path(statement.target), statement.value.span
        if not path or span is None or not isinstance(path[0], str) or path[0].casefold() not in named:
            return None
        entry = (path[1:], text[span[0] : span[1]])
        entries = given.setdefault(path[0].casefold(), {})
        if _folded(path[1:]) in entries:
            return None
        entries[_folded(path[1:])] = entry
    found: dict[str, Value] = {}
    try:
        for name, entries in given.items():
            variable = named[name]
            usual = (
                apart(variable.initial, variable.type, types)
                if variable.initial is not None and () not in entries
                else ()
            )
            all_ = {_folded(path): (path, value) for path, value in usual} | entries
            value = assembled(all_.values(), variable.type, types)
            if value is not None:
                found[name] = value
    except ValuePathError:
        return None
    return found


def _folded(path: Path) -> Path:
    return tuple(each.casefold() if isinstance(each, str) else each for each in path)


def _path(node: n.Expression) -> Path:
    """Return the way to an element; empty if it is another."""
    if isinstance(node, n.Name):
        return (node.identifier,)
    if isinstance(node, n.Member):
        base = _path(node.base)
        return (*base, node.name.identifier) if base else ()
    if isinstance(node, n.Index):
        base = _path(node.base)
        indices = [_index(each) for each in node.indices]
        return (*base, tuple(i for i in indices if i is not None)) if base and None not in indices else ()
    return ()


def _index(node: n.Expression) -> int | None:
    if isinstance(node, n.Unary) and node.operator is n.Operator.NEGATE:
        inner = _index(node.operand)
        return None if inner is None else -inner
    return number_of(node.text) if isinstance(node, n.Literal) else None


def can_be_assigned(variable: Variable, types: Types) -> bool:
    """True if assignments can give a variable its initial value."""
    if variable.initial is None:
        return True
    try:
        entries = list(apart(variable.initial, variable.type, types))
        value = assembled(entries, variable.type, types)
    except ValuePathError:
        return False
    written = all(write_value(SimpleValue(text=text), Dialect.SCL) for _, text in entries)
    return bool(entries) and written and value == variable.initial


def write_start_values(variables: list[Variable], types: Types) -> Iterator[str]:
    """Yield the assignments that give `variables` their initial values."""
    for variable in variables:
        for path, text in apart(variable.initial, variable.type, types) if variable.initial is not None else ():
            yield f"{_written(variable.name, path)} := {write_value(SimpleValue(text=text), Dialect.SCL)};"


def _written(name: str, path: Path) -> str:
    found = _name(name)
    for each in path:
        found += f".{_name(each)}" if isinstance(each, str) else f"[{', '.join(map(str, each))}]"
    return found


def _name(name: str) -> str:
    return name if is_unreserved(name) else f'"{name}"'


KEYWORDS = {
    PouKind.FUNCTION_BLOCK: "FUNCTION_BLOCK",
    PouKind.FUNCTION: "FUNCTION",
    PouKind.ORGANIZATION_BLOCK: "ORGANIZATION_BLOCK",
}
KINDS = {word: kind for kind, word in KEYWORDS.items()}

OWN_COMMENT = re.compile(r"//\s*(\{plcopen_sfc\b.*)")
"""A comment of this package: content that SCL cannot express, as in the pragmas of textual IEC 61131-3."""

BODY_START = re.compile(r"[ \t]*(?:\r\n|\r|\n)?")
BODY_END = re.compile(r"(?:\r\n|\r|\n)?[ \t]*\Z")

_REMAINDER_CODES = {DAMAGED: "SCL202", OUTDATED: "SCL203"}


def read_source(source: SourceText, file: str | None = None) -> ReadText:
    """Read an SCL source. Never raises: what cannot be read is kept and reported."""
    return _Reader(source, file).run()


class _Reader:
    def __init__(self, source: SourceText, file: str | None) -> None:
        self._text = source.text
        self._source = source
        self._file = file
        self._lines = Lines(source.text)
        self._diagnostics: list[Diagnostic] = []
        self._kept: list[str] = []
        self._found: list[Place] = []
        self._begins: list[tuple[DataBlock, str, bool]] = []

    def run(self) -> ReadText:
        if self._source.guessed:
            message = f"not in UTF-8 and without a byte order mark; taken as {self._source.encoding}"
            self._note("SCL201", Severity.WARNING, message, 0)
        project = Project(dialect=Dialect.SCL)
        units = split_units(self._text, Dialect.SCL)
        strays = [problem for problem in units.problems if problem.span[0] < problem.span[1]]
        for problem in units.problems:
            self._problem("SCL101", problem, 0)
        self._kept += [self._text[problem.span[0] : problem.span[1]] for problem in strays]
        changes = read_entries(units.comments, OWN_COMMENT, self._remainder_note)
        comments = [c for c in units.comments if not OWN_COMMENT.match(c.text)]
        starts = [c.span[0] for c in comments]
        position = 0
        for unit in units.units:
            behind = max([position, *(p.span[1] for p in strays if p.span[1] <= unit.span[0])])
            first = bisect_left(starts, behind)
            start = min([unit.span[0], *starts[first : first + 1]])
            self._unit(project, unit, start)
            position = unit.span[1]
        rest = [comment for comment in comments if comment.span[0] >= position]
        project.comment = comment_text(rest)
        if rest:
            self._found.append((("comment", ""), (rest[0].span[0], rest[-1].span[1]), ()))
        project.extension_data = keep(_texts(unreadable=plain_lines("\n".join(self._kept))))
        if self._kept:
            self._found.append((("stray", ""), (len(self._text), len(self._text)), ()))
        # after all units: a data block may be above the types and blocks that it is made of
        for block, text, retain in self._begins:
            self._start_values(project, block, text, retain)
        if changes:
            project = put_back(project, changes, self._remainder_note)
            self._found.append((("rest", ""), (changes[0][1].span[0], changes[-1][1].span[1]), ()))
        return ReadText(project, block_span(("file", ""), (0, len(self._text)), self._found), self._diagnostics)

    # -- units

    def _unit(self, project: Project, unit: DeclaredUnit, start: int) -> None:
        declared = read_declarations(self._text[start : unit.head[1]], Dialect.SCL)
        for problem in declared.problems:
            self._problem("SCL102", problem, start)
        pieces: list[Place] = []
        thing: Pou | DataBlock
        if unit.keyword == "TYPE":
            self._types(project, declared, unit, start)
            return
        if not declared.heads:
            self._lost(unit)
            return
        head = declared.heads[0]
        pieces += head_places(declared, start)
        if unit.keyword == "DATA_BLOCK":
            thing = self._data_block(declared, head, unit)
            project.data_blocks.append(thing)
        elif unit.keyword in KINDS:
            thing = self._pou(declared, head, unit)
            project.pous.append(thing)
        else:
            self._lost(unit)
            return
        pieces += section_places(self._text, declared, start, Dialect.SCL)
        pieces += self._body(unit)
        kind = "POU" if isinstance(thing, Pou) else "data block"
        span = (start, unit.span[1])
        self._found.append(((kind, thing.name), span, block_span((kind, thing.name), span, pieces).spans))

    def _lost(self, unit: DeclaredUnit) -> None:
        self._note("SCL103", Severity.ERROR, f"this {unit.keyword} cannot be read; its text is kept", unit.span[0])
        self._kept.append(self._text[unit.span[0] : unit.span[1]])

    def _types(self, project: Project, declared: Declared, unit: DeclaredUnit, start: int) -> None:
        found = [part for item in declared.items for part in item.parts]
        if len(found) != 1 or found[0].thing is None:
            self._lost(unit)
            return
        project.data_types.append(found[0].thing)
        self._found.append((("type", found[0].thing.name), (start, unit.span[1]), ()))

    def _pou(self, declared: Declared, head: Head, unit: DeclaredUnit) -> Pou:
        body = self._body_span(unit)
        return Pou(
            name=head.name,
            kind=KINDS[unit.keyword],
            interface=Interface(return_type=head.return_type, sections=declared.sections),
            bodies=[StBody(text=plain_lines(self._text[body[0] : body[1]]))],
            comment=head.comment,
            title=_title(head),
            extension_data=self._extension_data(declared, head),
        )

    def _data_block(self, declared: Declared, head: Head, unit: DeclaredUnit) -> DataBlock:
        body = self._body_span(unit)
        text = self._text[body[0] : body[1]]
        texts: dict[str, str] = {}
        if isinstance(head.return_type, DerivedType):
            known = kept(head.return_type.extension_data)
            texts |= {name: "" for name in ("quoted", "unquoted") if name in known}
        retain = any(each.name == "RETAIN" for each in head.properties)
        for section in declared.sections if retain else ():
            section.retain = True
        block = DataBlock(
            name=head.name,
            kind=DataBlockKind.GLOBAL if head.return_type is None else DataBlockKind.INSTANCE,
            type_name=head.return_type.name if isinstance(head.return_type, DerivedType) else None,
            interface=Interface(sections=declared.sections) if declared.sections else None,
            comment=head.comment,
            title=_title(head),
            extension_data=self._extension_data(declared, head, texts),
        )
        self._begins.append((block, plain_lines(text), retain))
        return block

    @staticmethod
    def _start_values(project: Project, block: DataBlock, text: str, retain: bool) -> None:
        """Give the variables of a data block the values between BEGIN and END_DATA_BLOCK.

        They count, those of the declaration do not. Those of an instance are in its interface, which has the variables
        that have a value of their own; of a retained one all.
        """
        types = s7_types(project).declared
        if block.type_name is not None:
            _of_instance(project, block, text, retain)
            return
        variables = block.interface.variables() if block.interface is not None else []
        inline = any(variable.initial is not None for variable in variables)
        texts: dict[str, str] = {}
        found = start_values(text, variables, types)
        if inline and (text.strip() or all(can_be_assigned(variable, types) for variable in variables)):
            texts["inline"] = ""
        if found is None:
            texts["unread"] = text
        elif inline and text.strip():
            texts["begin"] = text
        for variable in variables:
            value = (found or {}).get(variable.name.casefold())
            if value is not None and inline:
                declared = write_value(variable.initial, Dialect.SCL) if variable.initial is not None else ""
                variable.extension_data = keep(kept(variable.extension_data) | {DECLARED: declared})
            if value is not None:
                variable.initial = value
        if "begin" not in texts and found and not _holds_all(text, variables, types):
            texts["begin"] = text
        if texts:
            block.extension_data = keep(kept(block.extension_data) | texts)

    def _extension_data(
        self, declared: Declared, head: Head, texts: dict[str, str] | None = None
    ) -> ExtensionData | None:
        properties = [self._property(each) for each in head.properties if each.name != "TITLE"]
        unreadable = [item.node.text for item in declared.items if isinstance(item.node, n.Unreadable)]
        # the name of a block is in quotes
        named = next(item.node.name for item in declared.items if isinstance(item.node, d.PouHead))
        quoted = not isinstance(named, n.Name) or named.quoting is n.Quoting.GLOBAL
        return keep(
            _texts(
                attributes=head.attributes,
                properties="\n".join(properties),
                qualifiers=" ".join(head.qualifiers),
                unreadable="\n".join(unreadable),
            )
            | ({} if quoted == is_unit_quoted_in_scl(head.name) else {"name": "quoted" if quoted else "unquoted"})
            | (texts or {})
        )

    @staticmethod
    def _property(each: d.Property) -> str:
        return each.name if each.value is None else f"{each.name} : {each.value}"

    # -- places

    def _body(self, unit: DeclaredUnit) -> Iterator[Place]:
        body = self._body_span(unit)
        begin = (unit.head[1], unit.body[0]) if unit.body is not None else (unit.span[1], unit.span[1])
        yield ("begin", ""), begin, ()
        yield ("body", ""), body, ()
        yield ("end", ""), unit.end or (unit.span[1], unit.span[1]), ()

    def _body_span(self, unit: DeclaredUnit) -> tuple[int, int]:
        if unit.body is None:
            return (unit.span[1], unit.span[1])
        low, high = unit.body
        first = BODY_START.match(self._text, low, high)
        low = first.end() if first is not None else low
        last = BODY_END.search(self._text, low, high)
        if unit.keyword == "DATA_BLOCK" and self._text[low:high].strip():  # the empty line behind them is layout
            return (low, low + len(self._text[low:high].rstrip()))
        return (low, last.start() if last is not None else high)

    # -- findings

    def _problem(self, code: str, problem: Problem, offset: int) -> None:
        self._note(code, Severity.ERROR, problem.message, offset + problem.span[0])

    def _remainder_note(self, kind: str, message: str, offset: int) -> None:
        self._note(_REMAINDER_CODES[kind], Severity.WARNING, message, offset)

    def _note(self, code: str, severity: Severity, message: str, offset: int) -> None:
        line, column = self._lines.place(offset)
        self._diagnostics.append(Diagnostic(code, severity, message, Location(self._file, line, column)))


def _holds_all(text: str, variables: Sequence[Variable], types: Types) -> bool:
    """True if a text holds nothing but the initial values of variables: no comments, in any order."""
    return not parse_statements(text, Dialect.SCL).comments and all(can_be_assigned(each, types) for each in variables)


def _of_instance(project: Project, block: DataBlock, text: str, retain: bool) -> None:
    """Give an instance data block, or one of a data type, an interface with its start values."""
    types = s7_types(project).declared
    name = (block.type_name or "").replace('"', "").casefold()
    pou = next((each for each in project.pous if each.name.casefold() == name), None)
    given = [each for each in pou.interface.sections if _is_static(each)] if pou and pou.interface is not None else []
    struct = types.get(name)
    if pou is None and isinstance(struct, StructType):
        given = [VariableSection(variables=struct.members)]
    sections = [
        VariableSection(
            kind=section.kind,
            retain=retain,
            variables=[Variable(name=variable.name, type=variable.type) for variable in section.variables],
        )
        for section in given
    ]
    variables = [variable for section in sections for variable in section.variables]
    found = start_values(text, variables, types)
    texts = {"unread": text} if found is None or (retain and not sections) else {}
    if found and not _holds_all(text, variables, types):
        texts["begin"] = text
    for variable in variables:
        variable.initial = (found or {}).get(variable.name.casefold())
    for section in sections if not retain else ():
        section.variables = [variable for variable in section.variables if variable.initial is not None]
    sections = [section for section in sections if section.variables]
    if sections:
        block.interface = Interface(sections=sections)
    if texts:
        block.extension_data = keep(kept(block.extension_data) | texts)


def _is_static(section: VariableSection) -> bool:
    """True if an instance of a block has the variables of a section."""
    return (
        section.kind in (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.LOCAL)
        and not section.constant
    )


def _title(head: Head) -> str | None:
    return next((each.value for each in head.properties if each.name == "TITLE"), None)


def _texts(**texts: str) -> dict[str, str]:
    return {name: text for name, text in texts.items() if text}
