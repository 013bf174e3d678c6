"""Code pages of ``.EXP`` files: CoDeSys 2.3 writes that of its Windows, and no file names it."""

from __future__ import annotations

import codecs
import re

from plcopen_sfc.errors import EncodingError
from plcopen_sfc.formats.text_patch import SourceText, decode_text

USUAL = "cp1252"
_CODE_PAGES = (USUAL, "cp1250", "cp1251", "cp1253", "cp1254", "cp1257", "cp932", "cp936", "cp949", "cp950")
_NAMED = re.compile(rb"\{plcopen_sfc code_page := '(cp\d{3,4})'\}")
_LETTERS = re.compile(rb"[\x80-\xff]")
_LONG_RUN = re.compile(rb"[\xa8\xb8\xc0-\xff]{3,}")
"""Letters of Cyrillic words. In Western and Central European words such letters are alone or in pairs."""


class CodePageText(SourceText):
    """Text of a file in a code page, which it keeps."""

    __slots__ = ()

    def encode(self, text: str) -> tuple[bytes, bool]:
        """Return `text` in the code page of the file, and False. Raises `EncodingError`."""
        try:
            return text.encode(self.encoding), False
        except UnicodeEncodeError as error:
            raise EncodingError(
                f"{text[error.start]!r} is not in the code page {self.encoding} of this file",
                hint="CoDeSys 2.3 has one code page in a file, and no Unicode. Use characters of that code page.",
            ) from error


def decode_export(data: bytes) -> CodePageText:
    """Return the text of a file: in UTF-8 where it is that, else in the code page that it has, which is a guess."""
    named = _NAMED.search(data)
    encoding = named[1].decode() if named is not None and named[1].decode() in _CODE_PAGES else ""
    marked = data.startswith((codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if not encoding and not marked:
        if data.isascii():
            return CodePageText(data.decode("ascii"), USUAL)
        encoding = "cp1251" if _is_cyrillic(data) else USUAL
        encoding = "utf-8" if _is_utf8(data) else encoding
    try:
        return CodePageText(data.decode(encoding), encoding, guessed=named is None)
    except (UnicodeDecodeError, LookupError):
        found = decode_text(data)
        return CodePageText(found.text, found.encoding, guessed=found.guessed)


def code_page_for(text: str) -> str:
    """Return the first code page that has all characters of `text`, or the usual one if none has."""
    return next((page for page in _CODE_PAGES if _has_all(page, text)), USUAL)


def _has_all(page: str, text: str) -> bool:
    try:
        text.encode(page)
    except UnicodeEncodeError:
        return False
    return True


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _is_cyrillic(data: bytes) -> bool:
    return 2 * sum(map(len, _LONG_RUN.findall(data))) > len(_LETTERS.findall(data))
