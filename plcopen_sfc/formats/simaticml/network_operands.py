"""Operands of networks: ``Access`` elements, the same as text in SCL (``#a.b[1]``, ``"DB".x``, ``T#5s``), and hints.

Hints hold what the text of an operand does not tell: the type of a literal, if a name is one of a constant, and
information such as how a literal is shown or where a symbol lies. They are extension attributes of the network; a hint
holds for all operands of a text, and where those differ, for the one at a pin.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

from plcopen_sfc.formats.simaticml.element_reader import NotUnderstoodError, XmlNode, child_named, children, local
from plcopen_sfc.formats.simaticml.element_writer import sub
from plcopen_sfc.formats.simaticml.tia_versions import schema_of
from plcopen_sfc.formats.xml.extension_data import attributes, legal_text
from plcopen_sfc.whole_numbers import whole_number

_PLAIN = re.compile(r"[^\W\d]\w*")
_VARIABLES = {"LocalVariable": "#", "GlobalVariable": ""}
CONSTANTS = {"LocalConstant": "#", "GlobalConstant": ""}


def quoted(name: str, *, always: bool = False) -> str:
    """Return a name as SCL writes it: in quotes where it is no plain identifier."""
    return name if not always and _PLAIN.fullmatch(name) else f'"{name}"'


def read_operand(access: XmlNode) -> str:
    """Return the text of an ``Access``. Raises `NotUnderstoodError`."""
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
    """Return the path of ``Component`` children: ``a.b[1].%X0``; the first name of a global one is in quotes."""
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
    """Return the text behind the name of a ``Component``: indices and a slice."""
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
    """Return the text of an absolute address: ``%I0.1``. Raises `NotUnderstoodError`."""
    area, kind = element.get("Area", ""), element.get("Type", "")
    offset = whole_number(element.get("BitOffset"))
    width = {name: letter for letter, name in _WIDTHS.items() if letter != "X"}.get(kind)
    if (
        not set(element.attrib) <= {"Area", "Type", "BitOffset", "UId"}
        or area not in _LETTERS
        or width is None
        or offset is None
        or len(element)
    ):
        raise NotUnderstoodError
    byte, bit = divmod(offset, 8)
    return f"%{_LETTERS[area]}{width}{byte}" + (f".{bit}" if kind == "Bool" else "")


@dataclass(frozen=True)
class AccessOperand:
    """An operand: its `scope`, and its `path` or `value`."""

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
_ADDRESS = re.compile(r"%([IQMEA])([XBWDL]?)(\d{1,9})(?:\.([0-7]))?", re.IGNORECASE)
_LITERAL = re.compile(r"(?i:TRUE|FALSE)|[-+]?\d.*|'.*'|[^\W\d]\w*#.*", re.DOTALL)


@lru_cache(maxsize=4096)
def parse_operand(text: str) -> AccessOperand | None:
    """Parse `text` as an operand; None where it is more than one (an expression)."""
    text = text.strip()
    if text.startswith("#"):
        path = _parse_path(text[1:])
        return AccessOperand("LocalVariable", text, path) if path else None
    if text.startswith("%"):
        return AccessOperand("Address", text) if _ADDRESS.fullmatch(text) else None
    if _LITERAL.fullmatch(text):
        typed = "#" in text and not text[0].isdigit() and not text.startswith("'")
        return AccessOperand("TypedConstant" if typed else "LiteralConstant", text)
    path = _parse_path(text)
    if not path:
        return None
    return AccessOperand("GlobalVariable" if text.startswith('"') else "LocalVariable", text, path)


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
    """Return the indices of an array from behind ``[``, and the place behind ``]``; () where they are no operands."""
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
    """Write an ``Access``; `kind` is the type of a number at its pin. Raises `NotUnderstoodError` for no operand.

    `hint` adds what the text lacks (see `Hints`), `index` gives that of an index of an array. Returns True if they
    made a difference.
    """
    operand = parse_operand(text)
    if operand is None:
        raise NotUnderstoodError(f"{text} is no operand")
    if hint in CONSTANTS and operand.path:  # the text of a constant looks like that of a variable
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
    """Return the type of a literal; of a number `kind`, if a number can be of that."""
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
    """Write the ``Component`` children of a symbol or an instance, with its place from `hint`.

    Returns True if a hint made a difference.
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
            own_hint = index(text) if index is not None else None
            differs |= write_operand(component, text, "DInt", hint=own_hint, index=index)
    if address := hint_details(hint or ""):
        sub(parent, "Address", {**address, "Informative": "true"})
        differs = True
    return differs


def _is_first_schema(element: XmlNode) -> bool:
    """True if an element is of the first schemas of programs (V14 SP1), where an index has no mark of its own."""
    found = schema_of(str(element.tag)[1:].partition("}")[0])
    return found is not None and found[1] == 1 and found[0] != "StructuredText"


def hint_details(hint: str) -> dict[str, str]:
    """Return the details in a hint by name; empty if it has none, or is damaged."""
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


HINT = "operand "
"""Prefix of extension attributes that are hints; the text of an operand follows."""
_AT = "operand@"
_INDEX = "index "
_PLACE_OF_SYMBOL = {"Area", "Type", "BlockNumber", "BitOffset"}


def operand_hints(element: XmlNode, texts: Mapping[str, str]) -> dict[str, str]:
    """Return the hints of the operands of a network, as extension attributes. `texts` are theirs by number."""
    found: dict[str, str] = {}
    instances: list[XmlNode] = []
    pins: dict[str, str] | None = None
    for part in (part for group in children(element) if local(group) == "Parts" for part in children(group)):
        if local(part) != "Access":
            instances += [each for each in part.iter() if local(each) == "Instance"]
        elif part.get("Scope") != "Label":
            text, hint = texts[part.get("UId", "")], _hint(part)
            if found.setdefault(HINT + text, hint) != hint:
                pins = _pins(element) if pins is None else pins
                found[f"{_AT}{pins.get(part.get('UId', ''), '')} {text}"] = hint
            for nested in part.iter() if "[" in text else ():
                if local(nested) == "Access" and nested is not part:
                    found[HINT + _INDEX + read_operand(nested)] = _hint(nested)
    for instance in instances:
        globally = instance.get("Scope") == "GlobalVariable"
        found[HINT + ("" if globally else "#") + read_path(instance, globally=globally)] = _place(instance)
    return {name: hint for name, hint in found.items() if hint or name.startswith(_AT)}


class Hints:
    """Hints of a network that is being written."""

    def __init__(self, extension_data: Mapping[str, str]) -> None:
        self._found = {name: hint for name, hint in extension_data.items() if name.startswith((HINT, _AT))}

    def at(self, text: str, part: int, pin: str) -> str | None:
        """Return the hint for the operand `text` at a pin of a part."""
        if not self._found:
            return None
        hint = self._found.get(f"{_AT}{part}.{pin} {text}")
        return hint if hint is not None else self._found.get(HINT + text)

    def of(self, text: str) -> str | None:
        """Return the hint for an instance."""
        return self._found.get(HINT + text)

    def index(self, text: str) -> str | None:
        """Return the hint for an index of an array."""
        return self._found.get(HINT + _INDEX + text)


def _pins(element: XmlNode) -> dict[str, str]:
    """Return the part and pin of each operand."""
    found: dict[str, str] = {}
    for wire in (wire for group in children(element) if local(group) == "Wires" for wire in children(group)):
        ends = children(wire)
        pin = next((end for end in ends if local(end) == "NameCon"), None)
        for operand in (end for end in ends if pin is not None and local(end) == "IdentCon"):
            found[operand.get("UId", "")] = f"{pin.get('UId', '')}.{pin.get('Name', '')}" if pin is not None else ""
    return found


def _hint(access: XmlNode) -> str:
    inner = next(iter(children(access)), None)
    if inner is None:
        raise NotUnderstoodError("an operand without content")
    if local(inner) == "Symbol":
        return _place(inner)
    scope = access.get("Scope", "")
    if scope in CONSTANTS:
        return scope
    parts = {local(child): child for child in children(inner)}
    kind = parts["ConstantType"].text or "" if "ConstantType" in parts else ""
    shown = parts.get("StringAttribute")
    if shown is not None and attributes(shown) == {"Name": "Format", "Informative": "true"}:
        return f"{kind} {shown.text or ''}"
    return kind


def _place(symbol: XmlNode) -> str:
    """Return the place of a symbol, where an element gives it for information."""
    address = child_named(symbol, "Address")
    if address is None:
        return ""
    place = attributes(address)
    if place.pop("Informative", "") != "true" or not place.keys() <= _PLACE_OF_SYMBOL:
        raise NotUnderstoodError("an address of another form")
    return json.dumps(place)
