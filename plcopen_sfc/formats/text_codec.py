"""Codec of a text format, whose files can be patched (see `text_patch`), and the encodings of such files."""

from __future__ import annotations

import codecs
import re
from abc import abstractmethod
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.errors import EncodingError, Location
from plcopen_sfc.formats.format_interface import Codec, WriteOptions

if TYPE_CHECKING:
    from plcopen_sfc.formats.text_patch import BlockSpan, WrittenBlock
    from plcopen_sfc.model.project import Project
    from plcopen_sfc.report import ConversionReport


class SourceText(NamedTuple):
    """The text of a file as it is, with its line ends, its encoding, and whether that is only a guess."""

    text: str
    encoding: str
    guessed: bool = False

    @property
    def newline(self) -> str:
        """The first line end of the text."""
        found = re.search(r"\r\n|\r|\n", self.text)
        return found.group() if found is not None else "\n"

    def encode(self, text: str) -> tuple[bytes, bool]:
        """`text` in the encoding of the file, and False; True: it needs UTF-8, which has a byte order mark then."""
        try:
            return text.encode(self.encoding), False
        except UnicodeEncodeError:
            return text.encode("utf-8-sig", errors="replace"), True


_MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))


def decode_text(data: bytes) -> SourceText:
    """Return the text of a file: in the encoding of its byte order mark, in UTF-8, else in a code page (a guess).

    Raises `EncodingError` where a file with the mark of UTF-16 is damaged: no code page is meant by that.
    """
    marked = next((encoding for mark, encoding in _MARKS if data.startswith(mark)), "utf-8")
    # cp1252 leaves five bytes undefined (0x81, 0x8d, 0x8f, 0x90, 0x9d); Latin-1 below takes any.
    for encoding in (marked, "cp1252"):
        try:
            return SourceText(data.decode(encoding), encoding, guessed=encoding != marked)
        except UnicodeDecodeError as error:
            if encoding.startswith("utf-16"):
                line = data[: error.start].decode(encoding, errors="replace").count("\n") + 1
                message = f"the file has the byte order mark of UTF-16, and byte {error.start} is not valid in it"
                hint = "The file is damaged: export or copy it again."
                raise EncodingError(message, location=Location(line=line), hint=hint) from error
    return SourceText(data.decode("latin-1"), "latin-1", guessed=True)


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

    @abstractmethod
    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        """Return the text of a project, object by object."""

    @abstractmethod
    def located(self, content: bytes) -> tuple[Project, SourceText, BlockSpan]:
        """Return the project in a file, its text, and the places of the objects in that."""
