"""Pragmas of ours, ``{plcopen_sfc path := value}``: what IEC 61131-3 cannot say, in a form to read and to diff.

Other tools ignore them. `notation` writes and reads values, `remainder` finds what is to be said and applies it.
"""

from plcopen_sfc.languages.pragmas.notation import DEFAULT, NotationError, format_value
from plcopen_sfc.languages.pragmas.remainder import (
    Fields,
    PathError,
    RemainderEntry,
    Segment,
    StaleError,
    apply,
    changes,
    parse_change,
    plain_fields,
    plain_value,
    value_at,
)

__all__ = [
    "DEFAULT",
    "Fields",
    "NotationError",
    "PathError",
    "RemainderEntry",
    "Segment",
    "StaleError",
    "apply",
    "changes",
    "format_value",
    "parse_change",
    "plain_fields",
    "plain_value",
    "value_at",
]
