"""Declarations in text formats that are patched: the blocks that an edit replaces, and their places in a text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, TypeAlias

from plcopen_sfc.formats.text_patch import BlockSpan, Key, WrittenBlock, numbered, numbered_blocks
from plcopen_sfc.languages.declarations import Declared, Found, Head, write_variable
from plcopen_sfc.languages.declarations.declaration_writing import indent_of, section_head, section_rest
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.model.variables import VariableSection

Place: TypeAlias = tuple[Key, tuple[int, int], tuple[BlockSpan, ...]]
"""Place of an object in a text, and those of what is in it."""


def block_span(key: Key, span: tuple[int, int], places: Iterable[Place]) -> BlockSpan:
    """Return the span of an object with `places` in it, their keys numbered where several are the same."""
    found = list(places)
    keys = numbered([each for each, _, _ in found])
    inner = [BlockSpan((own,), place, spans) for own, (_, place, spans) in zip(keys, found, strict=True)]
    return BlockSpan((key,), span, tuple(sorted(inner, key=lambda each: each.span)))


def section_block(section: VariableSection, dialect: Dialect) -> WrittenBlock:
    """Return the block of a section, each variable a block of its own."""
    indent = indent_of(dialect)
    head = section_head(section, dialect)
    struct = kept(section.carried).get("keyword") == "STRUCT"
    words = "STRUCT" if struct else head[-1]
    lines = [*head[:-1], words]
    blocks = [WrittenBlock(("head", ""), "\n".join(indent + line for line in lines))]
    blocks += numbered_blocks(
        WrittenBlock(("variable", variable.name), write_variable(variable, dialect, 2 * indent))
        for variable in section.variables
    )
    ending = [*section_rest(section, 2 * indent), f"{indent}{'END_STRUCT;' if struct else 'END_VAR'}"]
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
            yield ("section", word), (start + low, start + high), tuple(slices)


def plain_lines(text: str) -> str:
    """Return `text` with LF as its line end."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _words_end(text: str, start: int, count: int) -> int:
    end = start
    for _ in range(count):
        while text[end : end + 1].isspace():
            end += 1
        while text[end : end + 1].isalnum() or text[end : end + 1] == "_":
            end += 1
    return end


def _closing_length(text: str, end: int) -> int:
    return next((len(w) for w in ("END_VAR", "END_STRUCT") if text[end - len(w) : end].upper() == w), 0)


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
