"""The start of a file, by which its format is recognised."""

from __future__ import annotations

import re
from dataclasses import dataclass

_ROOT = re.compile(r"<(?![?!])(?:([\w.-]+):)?([\w.-]+)((?:\s+[\w:.-]+\s*=\s*(?:\"[^\"]*\"|'[^']*'))*)\s*/?>")
HEAD = 65536
"""How many bytes of a file are looked at to recognise its format."""


@dataclass(frozen=True)
class Head:
    """What recognising needs to know of a file: its first text, and the root element where it is XML."""

    text: str
    root: str = ""
    namespace: str = ""
    data: bytes = b""
    xhtml_prefix: bool = False

    def mentions(self, text: str) -> bool:
        """Whether `text` occurs anywhere in the file, in any of the encodings that XML uses."""
        return any(text.encode(codec) in self.data for codec in ("utf-8", "utf-16-le", "utf-16-be"))


def head_of(data: bytes) -> Head:
    """Return what is known of a file from its first `HEAD` bytes."""
    start = data[:HEAD]
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = start[: len(start) // 2 * 2].decode("utf-16", errors="replace")
    elif start[:2] in (b"<\0", b"\0<"):
        text = start[: len(start) // 2 * 2].decode("utf-16-le" if start[:1] == b"<" else "utf-16-be", errors="replace")
    else:
        text = start.decode("utf-8-sig", errors="replace")
    plain = re.sub(r"<!--.*?-->|<\?.*?\?>|<!DOCTYPE[^\[>]*(?:\[.*?\])?\s*>", "", text, flags=re.DOTALL)
    match = _ROOT.search(plain)
    if match is None or plain[: match.start()].strip():
        return Head(text, data=data)
    prefix, root, attributes = match.groups()
    name = f"xmlns:{prefix}" if prefix else "xmlns"
    declared = re.search(rf"\s{re.escape(name)}\s*=\s*(?:\"([^\"]*)\"|'([^']*)')", attributes)
    namespace = (declared.group(1) or declared.group(2) or "") if declared else ""
    return Head(text, root, namespace, data, "http://www.w3.org/1999/xhtml" in attributes)
