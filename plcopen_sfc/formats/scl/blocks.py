"""What reader and writer of SCL sources have in common."""

from __future__ import annotations

import re

from plcopen_sfc.model.pou import PouKind

KEYWORDS = {
    PouKind.FUNCTION_BLOCK: "FUNCTION_BLOCK",
    PouKind.FUNCTION: "FUNCTION",
    PouKind.ORGANIZATION_BLOCK: "ORGANIZATION_BLOCK",
}
KINDS = {word: kind for kind, word in KEYWORDS.items()}

OWN_COMMENT = re.compile(r"//\s*(\{plcopen_sfc\b.*)")
"""A comment of ours: what SCL has no words for, as in the pragmas of textual IEC 61131-3."""

BODY_START = re.compile(r"[ \t]*(?:\r\n|\r|\n)?")
BODY_END = re.compile(r"(?:\r\n|\r|\n)?[ \t]*\Z")
