"""Codec of a text format, whose files can be patched: see `text_patch`."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping

from plcopen_sfc.formats.format_interface import Codec, WriteOptions
from plcopen_sfc.formats.text_encoding import SourceText, decode_text
from plcopen_sfc.formats.text_patch import BlockSpan, WrittenBlock
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.model.project import Project
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import ConversionReport


class TextCodec(Codec):
    """Reads and writes a text format. New files have `encoding` and `newline`."""

    encoding = "utf-8"
    newline = "\n"

    def decode(self, content: bytes) -> SourceText:
        """Return the text of a file, and its encoding."""
        return decode_text(content)

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a whole file; characters that its encoding does not have are replaced."""
        text = self.to_blocks(project, options, report).whole() + "\n"
        return text.replace("\n", self.newline).encode(self.encoding, errors="replace")

    def as_tool_sees(self, data: bytes, *, file: str | None = None) -> bytes:
        """Return the file without what only this package reads."""
        source = self.decode(data)
        text = self.without_own_comments(source.text)
        return source.encode(text)[0] if text != source.text else data

    def without_own_comments(self, text: str) -> str:
        """Return the text of a file without comments of this package."""
        return text

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        before, source, whole = self.located(content)
        labels = {pou.name: iter(pou.chart.labels().values()) for pou in before.pous if pou.chart is not None}
        return dict(_lines(whole, "", labels, Lines(source.text)))

    @abstractmethod
    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        """Return the text of a project, object by object."""

    @abstractmethod
    def located(self, content: bytes) -> tuple[Project, SourceText, BlockSpan]:
        """Return the project in a file, its text, and the places of the objects in that."""


_NAMED = frozenset({"type", "POU", "data block", "action", "step"})
"""Kinds of blocks that are a part of the paths of objects in reports."""


def _lines(
    block: BlockSpan, around: str, labels: Mapping[str, Iterator[str]], lines: Lines
) -> Iterator[tuple[str, int]]:
    """Yield the paths of the objects in a block with their lines; `labels` are those of the transitions of POUs."""
    for kind, name in block.keys:
        path = around
        if kind in _NAMED and name:
            path = ObjectPath(around, f"{kind} {name}")
        elif kind == "variable":
            path = ObjectPath(around, name)
        elif kind == "transition":
            label = next(labels.get(ObjectPath.of(around).last.removeprefix("POU "), iter(())), "")
            path = ObjectPath(around, f"transition {label}")
        if path != around:
            head = next((each for each in block.spans if each.keys[0] == ("head", "")), block)
            yield path, lines.place(head.span[0])[0]
        for inner in block.spans:
            yield from _lines(inner, path, labels, lines)
