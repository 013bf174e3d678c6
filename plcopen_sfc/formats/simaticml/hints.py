"""What operands of a network are, as far as their text does not say: carried attributes of the network.

The type of a literal, whether a name is one of a constant, and what is there for information: how a literal is shown,
where a symbol lies. A hint holds for all operands of a text; where those differ, for the one at a pin.
"""

from __future__ import annotations

import json
from collections.abc import Mapping

from plcopen_sfc.formats.simaticml.operands import CONSTANTS, read_operand, read_path
from plcopen_sfc.formats.simaticml.reading import NotUnderstoodError, XmlNode, attributes, child_named, children, local

HINT = "operand "
"""Carried attributes that begin so are hints: what follows is the text of an operand."""
_AT = "operand@"
_INDEX = "index "
_ADDRESS = {"Area", "Type", "BlockNumber", "BitOffset"}


def operand_hints(element: XmlNode, texts: Mapping[str, str]) -> dict[str, str]:
    """What there is to say of the operands of a network, as carried attributes. `texts` are theirs by number."""
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
    """The hints of a network that is being written."""

    def __init__(self, carried: Mapping[str, str]) -> None:
        self._found = {name: hint for name, hint in carried.items() if name.startswith((HINT, _AT))}

    def at(self, text: str, part: int, pin: str) -> str | None:
        """The hint for the operand `text` at a pin of a part."""
        if not self._found:
            return None
        hint = self._found.get(f"{_AT}{part}.{pin} {text}")
        return hint if hint is not None else self._found.get(HINT + text)

    def of(self, text: str) -> str | None:
        """The hint for an instance."""
        return self._found.get(HINT + text)

    def index(self, text: str) -> str | None:
        """The hint for an index of an array."""
        return self._found.get(HINT + _INDEX + text)


def is_hint(name: str) -> bool:
    """Whether a carried attribute is a hint."""
    return name.startswith((HINT, _AT))


def _pins(element: XmlNode) -> dict[str, str]:
    """The part and pin at which each operand stands."""
    found: dict[str, str] = {}
    for wire in (wire for group in children(element) if local(group) == "Wires" for wire in children(group)):
        ends = children(wire)
        for one, other in zip([*ends, *ends[1:]], [*ends[1:], *([ends[0]] * (len(ends) - 1))], strict=False):
            if local(one) == "IdentCon" and local(other) == "NameCon":
                found[one.get("UId", "")] = f"{other.get('UId', '')}.{other.get('Name', '')}"
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
    said = {local(child): child for child in children(inner)}
    kind = said["ConstantType"].text or "" if "ConstantType" in said else ""
    shown = said.get("StringAttribute")
    if shown is not None and attributes(shown) == {"Name": "Format", "Informative": "true"}:
        return f"{kind} {shown.text or ''}"
    return kind


def _place(symbol: XmlNode) -> str:
    """Where a symbol lies, where that is said for information."""
    address = child_named(symbol, "Address")
    if address is None:
        return ""
    said = attributes(address)
    if said.pop("Informative", "") != "true" or not said.keys() <= _ADDRESS:
        raise NotUnderstoodError("an address of another form")
    return json.dumps(said)
