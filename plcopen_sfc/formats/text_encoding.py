"""Encodings of text formats."""

from __future__ import annotations

import codecs
import re
from typing import NamedTuple

from plcopen_sfc.errors import EncodingError, Location


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
