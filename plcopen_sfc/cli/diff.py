"""What an edit changes in a file, by lines."""

from __future__ import annotations

import difflib
from collections.abc import Iterator

from plcopen_sfc.formats.file_recognition import recognise

__all__ = ["difference"]


def difference(before: bytes, after: bytes, name: str) -> Iterator[str]:
    """The unified difference of two contents of the file `name`, without context."""
    codec = _codec(before or after, name)
    old, new = (data.decode(codec, "replace").lstrip("\ufeff").splitlines() for data in (before, after))
    yield from difflib.unified_diff(old, new, name, name, n=0, lineterm="")


def _codec(data: bytes, name: str) -> str:
    if not recognise(data, file=name).xml:
        return "utf-8"
    from plcopen_sfc.formats.xml.xml_parsing import detect_encoding  # noqa: PLC0415  # only for XML

    return detect_encoding(data, file=name).codec
