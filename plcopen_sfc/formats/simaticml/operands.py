"""Operands of networks: ``Access`` elements, and the same as text in SCL (``#a.b[1]``, ``"DB".x``, ``T#5s``)."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from plcopen_sfc.formats.simaticml.reading import NotUnderstoodError, XmlNode, attributes, children, local
from plcopen_sfc.formats.simaticml.versions import schema_of
from plcopen_sfc.formats.simaticml.writing import sub
from plcopen_sfc.formats.xml.extension_data import legal_text

_PLAIN = re.compile(r"[^\W\d]\w*")
_VARIABLES = {"LocalVariable": "#", "GlobalVariable": ""}
CONSTANTS = {"LocalConstant": "#", "GlobalConstant": ""}


def quoted(name: str, *, always: bool = False) -> str:
    """A name as SCL writes it: in quotes where it is no plain identifier."""
    return name if not always and _PLAIN.fullmatch(name) else f'"{name}"'


def read_operand(access: XmlNode) -> str:
    """The text of an ``Access``. Raises `NotUnderstoodError`."""
    scope = access.get("Scope", "")
    inner = children(access)
    if len(inner) != 1:
        raise NotUnderstoodError
    part = inner[0]
    kind = local(part)
    if kind == "Symbol" and scope in _VARIABLES and not part.attrib:
        return _VARIABLES[scope] + read_path(part, globally=scope == "GlobalVariable")
    if kind == "Constant" and scope in CONSTANTS:
        return CONSTANTS[scope] + quoted(part.get("Name", ""), always=scope == "GlobalConstant")
    if kind == "Constant" and scope in ("LiteralConstant", "TypedConstant"):
        value = next((child.text or "" for child in children(part) if local(child) == "ConstantValue"), "")
        if not value or value[0] in '"#%':
            raise NotUnderstoodError
        return value
    if kind == "Address" and scope == "Address":
        return read_address(part)
    raise NotUnderstoodError


def read_path(element: XmlNode, *, globally: bool) -> str:
    """The path of ``Component`` children: ``a.b[1].%X0``; the first name of a global one is in quotes."""
    parts: list[str] = []
    for child in children(element):
        if local(child) == "Address":  # informative: where the symbol lies
            if child.get("Informative") != "true":
                raise NotUnderstoodError
            continue
        if local(child) != "Component":
            raise NotUnderstoodError
        name = child.get("Name", "")
        if '"' in name or not name:
            raise NotUnderstoodError
        text = quoted(name, always=globally and not parts)
        if len(child) or len(child.attrib) > 1:
            text += _read_details(child)
        parts.append(text)
    if not parts:
        raise NotUnderstoodError
    return ".".join(parts)


def _read_details(component: XmlNode) -> str:
    """What stands behind the name of a ``Component``: indices and a slice."""
    left = attributes(component)
    del left["Name"]
    bits = left.pop("SliceAccessModifier", None)
    indices = [read_operand(index) for index in children(component) if local(index) == "Access"]
    if len(indices) != len(component) or left not in ({}, {"AccessModifier": "Array"}):
        raise NotUnderstoodError
    return (f"[{', '.join(indices)}]" if indices else "") + (f".%{bits.upper()}" if bits else "")


_AREAS = {"I": "Input", "E": "Input", "Q": "Output", "A": "Output", "M": "Memory"}
_LETTERS = {"Input": "I", "Output": "Q", "Memory": "M"}
_WIDTHS = {"": "Bool", "X": "Bool", "B": "Byte", "W": "Word", "D": "DWord", "L": "LWord"}


def read_address(element: XmlNode) -> str:
    """The text of an absolute address: ``%I0.1``. Raises `NotUnderstoodError`."""
    area, kind = element.get("Area", ""), element.get("Type", "")
    offset = element.get("BitOffset", "")
    width = {name: letter for letter, name in _WIDTHS.items() if letter != "X"}.get(kind)
    if (
        not set(element.attrib) <= {"Area", "Type", "BitOffset", "UId"}
        or area not in _LETTERS
        or width is None
        or not offset.isdigit()
        or len(element)
    ):
        raise NotUnderstoodError
    byte, bit = divmod(int(offset), 8)
    return f"%{_LETTERS[area]}{width}{byte}" + (f".{bit}" if kind == "Bool" else "")


@dataclass(frozen=True)
class Operand:
    """What an operand is: its `scope`, and its `path` or `value`."""

    scope: str
    value: str
    path: tuple[PathPart, ...] = ()


@dataclass(frozen=True)
class PathPart:
    """A name in a path with the indices behind it and the slice (``x0``)."""

    name: str
    indices: tuple[str, ...] = ()
    slice: str | None = None


_TOKEN = re.compile(r'"([^"]*)"|([^\W\d]\w*)|\.%([XBWDxbwd]\d+)|(\.)|(\[)')
_ADDRESS = re.compile(r"%([IQMEA])([XBWDL]?)(\d+)(?:\.([0-7]))?", re.IGNORECASE)
_LITERAL = re.compile(r"(?i:TRUE|FALSE)|[-+]?\d.*|'.*'|[^\W\d]\w*#.*", re.DOTALL)


@lru_cache(maxsize=4096)
def parse_operand(text: str) -> Operand | None:
    """What `text` means as an operand; None where it is more than one (an expression)."""
    text = text.strip()
    if text.startswith("#"):
        path = _parse_path(text[1:])
        return Operand("LocalVariable", text, path) if path else None
    if text.startswith("%"):
        return Operand("Address", text) if _ADDRESS.fullmatch(text) else None
    if _LITERAL.fullmatch(text):
        typed = "#" in text and not text[0].isdigit() and not text.startswith("'")
        return Operand("TypedConstant" if typed else "LiteralConstant", text)
    path = _parse_path(text)
    if not path:
        return None
    return Operand("GlobalVariable" if text.startswith('"') else "LocalVariable", text, path)


def _parse_path(text: str) -> tuple[PathPart, ...]:
    parts: list[PathPart] = []
    position, expects_name = 0, True
    while position < len(text):
        found = _TOKEN.match(text, position)
        if found is None:
            return ()
        position = found.end()
        if found[1] is not None or found[2] is not None:
            if not expects_name:
                return ()
            parts.append(PathPart(found[1] if found[1] is not None else found[2]))
            expects_name = False
        elif expects_name:
            return ()
        elif found[3] is not None:
            parts[-1] = PathPart(parts[-1].name, parts[-1].indices, found[3])
        elif found[4] is not None:
            expects_name = True
        else:
            indices, position = _parse_indices(text, position)
            if not indices or parts[-1].indices:
                return ()
            parts[-1] = PathPart(parts[-1].name, indices)
    return () if expects_name else tuple(parts)


def _parse_indices(text: str, position: int) -> tuple[tuple[str, ...], int]:
    """The indices of an array from behind ``[``, and the place behind ``]``; () where they are no operands."""
    indices: list[str] = []
    depth, start = 0, position
    for place in range(position, len(text)):
        letter = text[place]
        if letter == "[":
            depth += 1
        elif letter in ",]" and depth == 0:
            indices.append(text[start:place].strip())
            start = place + 1
            if letter == "]":
                sayable = all(parse_operand(index) is not None for index in indices)
                return (tuple(indices) if sayable else ()), place + 1
        elif letter == "]":
            depth -= 1
    return (), len(text)


def write_operand(
    parent: XmlNode,
    text: str,
    kind: str,
    attributes: dict[str, str] | None = None,
    *,
    hint: str | None = None,
    index: Callable[[str], str | None] | None = None,
) -> bool:
    """Write an ``Access``; `kind` is the type of a number where it stands. Raises `NotUnderstoodError` for no operand.

    `hint` says what the text does not (see `hints`), `index` gives that of an index of an array. Returns whether they
    made a difference.
    """
    operand = parse_operand(text)
    if operand is None:
        raise NotUnderstoodError(f"{text} is no operand")
    if hint in CONSTANTS and operand.path:
        constant = sub(parent, "Access", {"Scope": hint, **(attributes or {})})
        sub(constant, "Constant", {"Name": operand.path[0].name})
        return True
    element = sub(parent, "Access", {"Scope": operand.scope, **(attributes or {})})
    if operand.path:
        return write_path(sub(element, "Symbol"), operand.path, hint=hint, index=index)
    if operand.scope == "Address":
        _write_address(element, text.strip())
        return False
    constant = sub(element, "Constant")
    given, _, shown = (hint or "").partition(" ")
    differs = bool(shown)
    if operand.scope == "LiteralConstant":
        usual = literal_type(operand.value, kind)
        sub(constant, "ConstantType").text = given or usual
        differs |= given not in ("", usual)
    sub(constant, "ConstantValue").text = operand.value
    if shown:
        sub(constant, "StringAttribute", {"Name": "Format", "Informative": "true"}).text = shown
    return differs


def literal_type(value: str, kind: str) -> str:
    """The type of a literal; of a number `kind`, if a number can be of that."""
    if value.upper() in ("TRUE", "FALSE"):
        return "Bool"
    if value.startswith("'"):
        return "Char" if len(value) == _ONE_CHARACTER and kind != "String" else "String"
    if re.fullmatch(r"[-+]?\d[\d_]*\.\d.*", value):
        return kind if kind in ("Real", "LReal") else "Real"
    if value[:3] == "16#" and kind not in _NUMBERS:
        return {4: "Byte", 6: "Word", 8: "Word"}.get(len(value), "DWord") if kind == "" else kind
    return kind or "Int"


_ONE_CHARACTER = 3
_NUMBERS = frozenset(
    {"SInt", "Int", "DInt", "LInt", "USInt", "UInt", "UDInt", "ULInt", "Byte", "Word", "DWord", "LWord"}
)


def write_path(
    parent: XmlNode,
    path: tuple[PathPart, ...],
    *,
    hint: str | None = None,
    index: Callable[[str], str | None] | None = None,
) -> bool:
    """Write the ``Component`` children of a symbol or an instance, with where it lies where `hint` says so.

    Returns whether a hint made a difference.
    """
    differs = False
    for part in path:
        marks = {"Name": part.name}
        if part.slice is not None:
            marks["SliceAccessModifier"] = part.slice.lower()
        if part.indices and not _is_first_schema(parent):
            marks["AccessModifier"] = "Array"
        component = sub(parent, "Component", marks)
        for text in part.indices:
            said = index(text) if index is not None else None
            differs |= write_operand(component, text, "DInt", hint=said, index=index)
    if address := details(hint or ""):
        sub(parent, "Address", {**address, "Informative": "true"})
        differs = True
    return differs


def _is_first_schema(element: XmlNode) -> bool:
    """Whether an element is of the first schemas of programs (V14 SP1), where an index has no mark of its own."""
    found = schema_of(str(element.tag)[1:].partition("}")[0])
    return found is not None and found[1] == 1 and found[0] != "StructuredText"


def details(hint: str) -> dict[str, str]:
    """What a hint says by name; nothing where it says no such thing, or is damaged."""
    try:
        found = json.loads(hint) if hint.startswith("{") else {}
    except ValueError:
        return {}
    return {
        name: legal_text(value) for name, value in found.items() if isinstance(value, str) and _PLAIN.fullmatch(name)
    }


def _write_address(parent: XmlNode, text: str) -> None:
    found = _ADDRESS.fullmatch(text)
    if found is None:
        raise NotUnderstoodError(text)
    kind = _WIDTHS[found[2].upper()]
    offset = int(found[3]) * 8 + int(found[4] or 0)
    sub(parent, "Address", {"Area": _AREAS[found[1].upper()], "Type": kind, "BitOffset": str(offset)})
