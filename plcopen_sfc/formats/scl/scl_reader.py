"""Reads external source files of TIA Portal and STEP 7: blocks, data blocks and data types in SCL.

Besides the model it finds the place of each object in the text, so that edits can be put there. `scl_writer` is the way
back.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from pydantic import ValidationError

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.formats.scl.scl_start_values import DECLARED, can_be_assigned, start_values
from plcopen_sfc.formats.text_patch import BlockSpan, Key, SourceText, numbered
from plcopen_sfc.languages.declarations import Declared, DeclaredUnit, Found, Head, read_declarations, split_units
from plcopen_sfc.languages.declarations.declaration_comments import said
from plcopen_sfc.languages.declarations.declaration_writing import section_head, write_value
from plcopen_sfc.languages.declarations.kept_texts import keep, kept
from plcopen_sfc.languages.declarations.type_names import is_unit_quoted_in_scl
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.pragmas import (
    Fields,
    NotationError,
    PathError,
    RemainderEntry,
    Segment,
    StaleError,
    apply,
    format_value,
    parse_change,
    plain_fields,
    value_at,
)
from plcopen_sfc.languages.problems import Lines, Problem
from plcopen_sfc.languages.s7_types import s7_types
from plcopen_sfc.languages.st import declaration_nodes as d
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import Comment
from plcopen_sfc.languages.st.parsing import parse_statements
from plcopen_sfc.languages.start_values import Types
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import DataBlock, DataBlockKind, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DerivedType, StructType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection

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


_Place: TypeAlias = tuple[Key, tuple[int, int], tuple[BlockSpan, ...]]
"""Places in the text, each with the object in it."""


@dataclass
class SclFile:
    """A source that was read: the project, the places of its objects, and the findings."""

    project: Project
    spans: BlockSpan
    diagnostics: list[Diagnostic] = field(default_factory=list)


def read_source(source: SourceText, file: str | None = None) -> SclFile:
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
        self._found: list[_Place] = []
        self._begins: list[tuple[DataBlock, str, bool]] = []

    def run(self) -> SclFile:
        if self._source.guessed:
            message = f"not in UTF-8 and without a byte order mark; taken as {self._source.encoding}"
            self._note("SCL201", Severity.WARNING, message, 0)
        project = Project(dialect=Dialect.SCL)
        units = split_units(self._text, Dialect.SCL)
        strays = [problem for problem in units.problems if problem.span[0] < problem.span[1]]
        for problem in units.problems:
            self._problem("SCL101", problem, 0)
        self._kept += [self._text[problem.span[0] : problem.span[1]] for problem in strays]
        changes = self._own_changes(units.comments)
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
        project.comment = said(rest)
        if rest:
            self._found.append((("comment", ""), (rest[0].span[0], rest[-1].span[1]), ()))
        project.carried = keep(_texts(unreadable=_plain_lines("\n".join(self._kept))))
        if self._kept:
            self._found.append((("stray", ""), (len(self._text), len(self._text)), ()))
        # after all units: a data block may be above the types and blocks that it is made of
        for block, text, retain in self._begins:
            self._start_values(project, block, text, retain)
        if changes:
            project = self._changed(project, changes)
            self._found.append((("rest", ""), (changes[0][1].span[0], changes[-1][1].span[1]), ()))
        return SclFile(project, self._slices(), self._diagnostics)

    def _slices(self) -> BlockSpan:
        keys = numbered([key for key, _, _ in self._found])
        slices = [BlockSpan((key,), span, inner) for key, (_, span, inner) in zip(keys, self._found, strict=True)]
        slices.sort(key=lambda each: each.span)
        return BlockSpan((("file", ""),), (0, len(self._text)), tuple(slices))

    # -- content that SCL cannot express

    def _own_changes(self, comments: Sequence[Comment]) -> list[tuple[RemainderEntry, Comment]]:
        changes = []
        for comment in comments:
            found = OWN_COMMENT.match(comment.text)
            if found is None:
                continue
            try:
                changes.append((parse_change(found[1].strip()[1:-1].strip().removeprefix("plcopen_sfc")), comment))
            except NotationError as error:
                self._note(
                    "SCL202", Severity.WARNING, f"this comment of plcopen_sfc is damaged: {error}", comment.span[0]
                )
        return changes

    def _changed(self, project: Project, changes: Sequence[tuple[RemainderEntry, Comment]]) -> Project:
        fields, text = plain_fields(project), plain_fields(project)
        # without a start value, a variable of the kept type would start with that of the type
        outdated = [(*c.path[:-1], "type") for c, _ in changes if _is_taken_out(text, c)]
        made: list[tuple[Segment, ...]] = []
        for change, comment in changes:
            if _is_in(change.path, outdated):
                continue
            try:
                if not _is_in(change.path, made):
                    _check_text(text, change)
                apply(fields, change)
                made.append(change.path)
            except StaleError as error:
                *around, last = change.path
                if last in ("kind", "language"):
                    outdated.append(tuple(around))
                elif last == "type":  # a start value is one of the type
                    outdated.append((*around, "initial"))
                message = f"this comment of plcopen_sfc is for another text and left out: {error}"
                self._note("SCL203", Severity.WARNING, message, comment.span[0])
            except PathError as error:
                self._note(
                    "SCL202", Severity.WARNING, f"this comment of plcopen_sfc does not fit: {error}", comment.span[0]
                )
        try:
            return Project.model_validate(fields)
        except ValidationError as error:
            first = error.errors()[0]
            message = f"the comments of plcopen_sfc are left out: {'.'.join(map(str, first['loc']))}: {first['msg']}"
            self._note("SCL202", Severity.WARNING, message, changes[0][1].span[0])
            return project

    # -- units

    def _unit(self, project: Project, unit: DeclaredUnit, start: int) -> None:
        declared = read_declarations(self._text[start : unit.head[1]], Dialect.SCL)
        for problem in declared.problems:
            self._problem("SCL102", problem, start)
        pieces: list[_Place] = []
        thing: Pou | DataBlock
        if unit.keyword == "TYPE":
            self._types(project, declared, unit, start)
            return
        if not declared.heads:
            self._lost(unit)
            return
        head = declared.heads[0]
        pieces += self._heads(declared, start)
        if unit.keyword == "DATA_BLOCK":
            thing = self._data_block(declared, head, unit)
            project.data_blocks.append(thing)
        elif unit.keyword in KINDS:
            thing = self._pou(declared, head, unit)
            project.pous.append(thing)
        else:
            self._lost(unit)
            return
        pieces += self._sections(declared, start)
        pieces += self._body(unit)
        keys = numbered([key for key, _, _ in pieces])
        inner = sorted(
            (BlockSpan((key,), span, slices) for key, (_, span, slices) in zip(keys, pieces, strict=True)),
            key=lambda each: each.span,
        )
        kind = "POU" if isinstance(thing, Pou) else "data block"
        self._found.append(((kind, thing.name), (start, unit.span[1]), tuple(inner)))

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
            bodies=[StBody(text=_plain_lines(self._text[body[0] : body[1]]))],
            comment=head.comment,
            title=_title(head),
            carried=self._carried(declared, head),
        )

    def _data_block(self, declared: Declared, head: Head, unit: DeclaredUnit) -> DataBlock:
        body = self._body_span(unit)
        text = self._text[body[0] : body[1]]
        texts: dict[str, str] = {}
        if isinstance(head.return_type, DerivedType):
            texts |= dict.fromkeys(_quoting(head.return_type), "")
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
            carried=self._carried(declared, head, texts),
        )
        self._begins.append((block, _plain_lines(text), retain))
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
                variable.carried = keep(kept(variable.carried) | {DECLARED: declared})
            if value is not None:
                variable.initial = value
        if "begin" not in texts and found and not _holds_all(text, variables, types):
            texts["begin"] = text
        if texts:
            block.carried = keep(kept(block.carried) | texts)

    def _carried(self, declared: Declared, head: Head, texts: dict[str, str] | None = None) -> Carried | None:
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

    def _heads(self, declared: Declared, start: int) -> Iterator[_Place]:
        found = next(item for item in declared.items if isinstance(item.thing, Head))
        head: Head = found.thing
        if head.comment_span is not None:
            low, high = head.comment_span
            yield ("comment", ""), (start + low, start + high), ()
        yield ("head", ""), (start + found.span[0], start + found.span[1]), ()

    def _sections(self, declared: Declared, start: int) -> Iterator[_Place]:
        for found in declared.items:
            if isinstance(found.thing, VariableSection):
                low, high = found.span
                node_low, _ = _span(found.node)
                word = section_head(found.thing, Dialect.SCL)[-1]
                end_of_head = self._words_end(start + node_low, len(word.split()))
                closing = start + high - self._closing_length(start + high)
                slices = [
                    BlockSpan((("head", ""),), (start + low, end_of_head)),
                    *_variables(found, start),
                    BlockSpan((("end", ""),), (closing, start + high)),
                ]
                yield ("section", word), (start + low, start + high), tuple(slices)

    def _words_end(self, start: int, count: int) -> int:
        end = start
        for _ in range(count):
            while self._text[end : end + 1].isspace():
                end += 1
            while self._text[end : end + 1].isalnum() or self._text[end : end + 1] == "_":
                end += 1
        return end

    def _closing_length(self, end: int) -> int:
        return next((len(w) for w in ("END_VAR", "END_STRUCT") if self._text[end - len(w) : end].upper() == w), 0)

    def _body(self, unit: DeclaredUnit) -> Iterator[_Place]:
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

    def _note(self, code: str, severity: Severity, message: str, offset: int) -> None:
        line, column = self._lines.place(offset)
        self._diagnostics.append(Diagnostic(code, severity, message, Location(self._file, line, column)))


def _is_in(path: tuple[Segment, ...], places: Iterable[tuple[Segment, ...]]) -> bool:
    return any(path[: len(place)] == place for place in places)


def _is_taken_out(text: Fields, change: RemainderEntry) -> bool:
    return change.path[-1] == "initial" and change.instead is not None and value_at(text, change.path) is None


def _check_text(text: Fields, change: RemainderEntry) -> None:
    """Raise `StaleError` if `text` itself has by now what it left to a comment when that was written."""
    *around, last = change.path
    holder = value_at(text, tuple(around))
    if not isinstance(holder, dict):
        return
    if last == "language" and str(holder.get("text", "")).strip():
        raise StaleError("the block has statements now")
    present = holder.get(last) if isinstance(last, str) else None
    if change.instead is None and present is not None and present != change.value:
        raise StaleError(f"the text has {format_value(present)} now")


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
        block.carried = keep(kept(block.carried) | texts)


def _is_static(section: VariableSection) -> bool:
    """True if an instance of a block has the variables of a section."""
    return (
        section.kind in (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.LOCAL)
        and not section.constant
    )


def _span(node: Any) -> tuple[int, int]:
    span: tuple[int, int] = node.span
    return span


def _variables(section: Found, start: int) -> Iterator[BlockSpan]:
    """Yield the places of the variables; those of one declaration together."""
    parts = [part for part in section.parts if part.thing is not None]
    keys = numbered([("variable", part.thing.name) for part in parts])
    together: dict[int, list[Key]] = {}
    for key, part in zip(keys, parts, strict=True):
        together.setdefault(id(part.node), []).append(key)
    spans = {id(part.node): part.span for part in parts}
    for node, named in together.items():
        yield BlockSpan(tuple(named), (start + spans[node][0], start + spans[node][1]))


def _plain_lines(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _title(head: Head) -> str | None:
    return next((each.value for each in head.properties if each.name == "TITLE"), None)


def _texts(**texts: str) -> dict[str, str]:
    return {name: text for name, text in texts.items() if text}


def _quoting(type_: DerivedType) -> list[str]:
    return [name for name in ("quoted", "unquoted") if name in kept(type_.carried)]
