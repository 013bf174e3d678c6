"""Blocks and spans of declarations in text formats: sections, heads of POUs and structures; see `text_patch`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from plcopen_sfc.formats.text_patch import BlockSpan, Place, WrittenBlock, numbered, numbered_blocks
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.declarations import Declared, Found, Head, write_variable
from plcopen_sfc.languages.declarations.declaration_writing import (
    indent_of,
    section_closing,
    section_head,
    section_rest,
)
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.st.declaration_nodes import TypeDeclaration
from plcopen_sfc.languages.st.lexer import CommentKind
from plcopen_sfc.model import types as t
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.variables import VariableSection


def section_block(section: VariableSection, dialect: Dialect, indent: str | None = None) -> WrittenBlock:
    """Return the block of a section, each variable a block of its own; `indent`: another one than in a POU."""
    indent = indent_of(dialect) if indent is None else indent
    deeper = indent + indent_of(dialect)
    head = section_head(section, dialect)
    struct = kept(section.extension_data).get("keyword") == "STRUCT"
    words = "STRUCT" if struct else head[-1]
    lines = [*head[:-1], words]
    blocks = [WrittenBlock(("head", ""), "\n".join(indent + line for line in lines))]
    blocks += numbered_blocks(
        WrittenBlock(("variable", variable.name), write_variable(variable, dialect, deeper))
        for variable in section.variables
    )
    closing = section_closing(section, deeper)
    blocks += [WrittenBlock(("closing", ""), "\n".join(closing))] if closing else []
    ending = [*section_rest(section, deeper), f"{indent}{'END_STRUCT;' if struct else 'END_VAR'}"]
    blocks.append(WrittenBlock(("end", ""), "\n".join(ending)))
    return WrittenBlock(("section", head[-1]), blocks=tuple(blocks))


def head_places(declared: Declared, start: int) -> Iterator[Place]:
    """Yield the places of the head of a POU and of the comment before it; `start`: that of the declarations."""
    found = next(item for item in declared.items if isinstance(item.thing, Head))
    head: Head = found.thing
    if head.comment_span is not None:
        low, high = head.comment_span
        yield ("comment", ""), (start + low, start + high), ()
    yield ("head", ""), (start + found.span[0], start + found.span[1]), ()


def section_places(text: str, declared: Declared, start: int, dialect: Dialect) -> Iterator[Place]:
    """Yield the places of the sections of variables in `text`, where the declarations begin at `start`."""
    for found in declared.items:
        if isinstance(found.thing, VariableSection):
            low, high = found.span
            node_low, _ = _span(found.node)
            word = section_head(found.thing, dialect)[-1]
            end_of_head = _words_end(text, start + node_low, len(word.split()))
            closing = start + high - _closing_length(text, start + high)
            slices = [
                BlockSpan((("head", ""),), (start + low, end_of_head)),
                *_variables(found, start),
                BlockSpan((("end", ""),), (closing, start + high)),
            ]
            if section_closing(found.thing, ""):
                slices.insert(-1, _closing_place(declared, found, start, (end_of_head, closing)))
            yield ("section", word), (start + low, start + high), tuple(slices)


def type_blocks(
    text: str, declaration: t.DataTypeDeclaration, written: Callable[[t.Variable], str]
) -> Iterator[WrittenBlock]:
    """Yield the blocks of a type that is written as `text`, if it is a structure: each member is one of them.

    `written` returns the declaration of a member as it is in that text.
    """
    type_ = declaration.type
    texts = [written(each) for each in type_.members] if isinstance(type_, t.StructType) else []
    head, _, end = text.partition("\n" + "\n".join(texts) + "\n")
    if not (isinstance(type_, t.StructType) and texts and end):
        return
    yield WrittenBlock(("head", ""), head)
    keys = numbered([("variable", each.name) for each in type_.members])
    yield from (WrittenBlock(key, one) for key, one in zip(keys, texts, strict=True))
    margin = texts[0][: len(texts[0]) - len(texts[0].lstrip())]
    closing = "\n".join(section_closing(type_, margin))
    if closing and end.startswith(f"{closing}\n"):
        yield WrittenBlock(("closing", ""), closing)
        end = end.removeprefix(f"{closing}\n")
    yield WrittenBlock(("end", ""), end)


def type_places(text: str, declared: Declared, start: int) -> tuple[BlockSpan, ...]:
    """Return the places of the head, the members and the end of a structure, which is all that is `declared`.

    The declarations begin at `start` in `text`.
    """
    found, *others = [part for item in declared.items for part in item.parts if isinstance(part.node, TypeDeclaration)]
    type_ = found.thing.type
    if others or not found.parts or not isinstance(type_, t.StructType) or not isinstance(found.node, TypeDeclaration):
        return ()
    low, high = _span(found.node.type)
    end_of_head = _words_end(text, start + low, 1)
    closing = start + high - _closing_length(text, start + high)
    places = [BlockSpan((("head", ""),), (start, end_of_head)), *_variables(found, start)]
    if section_closing(type_, ""):
        places.append(_closing_place(declared, found, start, (end_of_head, closing)))
    return (*places, BlockSpan((("end", ""),), (closing, start + found.span[1])))


def _closing_place(declared: Declared, found: Found, start: int, inside: tuple[int, int]) -> BlockSpan:
    """Return the place of the pragmas behind the last variable of what is `inside` a section or a structure."""
    last = max([inside[0] - start, *(part.span[1] for part in found.parts if part.thing is not None)])
    braces = (each.span for each in declared.parsed.comments if each.kind is CommentKind.PRAGMA)
    behind = [span for span in braces if last <= span[0] and span[1] <= inside[1] - start]
    return BlockSpan((("closing", ""),), (start + behind[0][0], start + behind[-1][1]))


def _words_end(text: str, start: int, count: int) -> int:
    end = start
    for _ in range(count):
        while text[end : end + 1].isspace():
            end += 1
        while text[end : end + 1].isalnum() or text[end : end + 1] == "_":
            end += 1
    return end


def _closing_length(text: str, end: int) -> int:
    return next((len(w) for w in ("END_VAR", "END_STRUCT", "END_UNION") if text[end - len(w) : end].upper() == w), 0)


def _span(node: Any) -> tuple[int, int]:
    span: tuple[int, int] = node.span
    return span


def _variables(section: Found, start: int) -> Iterator[BlockSpan]:
    """Yield the places of the variables; those of one declaration together."""
    parts = [part for part in section.parts if part.thing is not None]
    keys = numbered([("variable", part.thing.name) for part in parts])
    together = grouped((id(part.node), key) for key, part in zip(keys, parts, strict=True))
    spans = {id(part.node): part.span for part in parts}
    for node, named in together.items():
        yield BlockSpan(tuple(named), (start + spans[node][0], start + spans[node][1]))
