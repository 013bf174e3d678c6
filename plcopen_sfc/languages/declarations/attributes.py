"""Attributes of SCL: ``{ S7_HMI := 'x'; ExternalWritable := 'False' }``."""

from __future__ import annotations

import re

_ATTRIBUTE = r"\s*(\w+)\s*:=\s*'((?:\$[\s\S]|[^$'])*)'\s*"
_LIST = re.compile(rf"\{{{_ATTRIBUTE}(?:;{_ATTRIBUTE})*;?\s*\}}")


def read_attributes(text: str) -> dict[str, str] | None:
    """The attributes by name; None if they are written otherwise, or twice."""
    if _LIST.fullmatch(text) is None:
        return None
    found = re.findall(_ATTRIBUTE, text)
    attributes = {name: value.replace("$$", "$") for name, value in found}
    return attributes if len(attributes) == len(found) and write_attributes(attributes) else None


def write_attributes(attributes: dict[str, str]) -> str:
    """The attributes in braces; empty where one of them could not be read back."""
    listed = "; ".join(f"{name} := '{value.replace('$', '$$')}'" for name, value in attributes.items())
    return f"{{ {listed} }}" if _sayable(attributes) else ""


def _sayable(attributes: dict[str, str]) -> bool:
    return all(re.fullmatch(r"\w+", name) and not re.search(r"['{}\r\n]", value) for name, value in attributes.items())
