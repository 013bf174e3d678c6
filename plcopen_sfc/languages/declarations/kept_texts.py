"""Declarations that one dialect has and another keeps in its extension data; what a POU extends and implements."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, NamedTuple
from xml.sax.saxutils import escape, unescape

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.declaration_nodes import PouHead
from plcopen_sfc.languages.st.parsing import parse_declarations
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.base import ExtensionData, ForeignData
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.variables import Interface

KEPT_DATA = "urn:plcopen-sfc:declaration"
_ENTRY = re.compile(r"<(?P<name>\w+)>(?P<text>[^<]*)</(?P=name)>")


def keep(texts: dict[str, str]) -> ExtensionData | None:
    """Foreign data that holds `texts`; None if there are none."""
    if not texts:
        return None
    entries = "".join(f"<{name}>{escape(text)}</{name}>" for name, text in texts.items())
    content = f'<declaration xmlns="{KEPT_DATA}">{entries}</declaration>'
    return ExtensionData(data=[ForeignData(name=KEPT_DATA, content=content)])


def kept_entries(markup: str) -> Iterator[tuple[str, str, int]]:
    """Yield the name, the text as it is written, and its place, of each text in what `keep` made."""
    for entry in _ENTRY.finditer(markup):
        yield entry["name"], entry["text"], entry.start("text")


def kept(extension_data: ExtensionData | None) -> dict[str, str]:
    """Return the texts that `keep` put there."""
    if extension_data is None:
        return {}
    entries = (entry for data in extension_data.data if data.name == KEPT_DATA for entry in kept_entries(data.content))
    return {name: unescape(text) for name, text, _ in entries}


def with_kept(extension_data: ExtensionData | None, texts: dict[str, str]) -> ExtensionData | None:
    """Return extension data with `texts` in the place of those that `keep` put there; None where nothing is left."""
    before, added = extension_data or ExtensionData(), keep(texts)
    rest = [data for data in before.data if data.name != KEPT_DATA] + (added.data if added is not None else [])
    left = before.model_copy(update={"data": rest})
    return left if left != ExtensionData() else None


TEXT_DATA = "urn:plcopen-sfc:iec-text"
"""Name of foreign data that holds text which the model has no place for."""
_WRAPPED = re.compile(rf'<text xmlns="{TEXT_DATA}" place="([^"]*)">(.*)</text>', re.DOTALL)


def wrapped(place: str, text: str) -> dict[str, Any]:
    """Foreign data that holds `text` from `place`: ``pragma``, ``from``, ``property`` ..."""
    content = f'<text xmlns="{TEXT_DATA}" place="{escape(place)}">{escape(text)}</text>'
    return {"name": TEXT_DATA, "content": content}


def unwrapped(content: str) -> tuple[str, str] | None:
    """Return the place and the text of foreign data that `wrapped` made; None for any other."""
    found = _WRAPPED.fullmatch(content)
    return (unescape(found.group(1)), unescape(found.group(2))) if found is not None else None


def texts_from(place: str, extension_data: ExtensionData | None) -> Iterator[str]:
    """Yield the texts from a place that `wrapped` put into extension data."""
    for data in extension_data.data if extension_data is not None else ():
        found = unwrapped(data.content)
        if found is not None and found[0] == place:
            yield found[1]


_PROPERTY = re.compile(r"\bPROPERTY\s+(?:(?:PUBLIC|PRIVATE|PROTECTED|INTERNAL|FINAL|ABSTRACT|OVERRIDE)\s+)*(\w+)", re.I)


def properties_of(pou: Pou) -> Iterator[tuple[str, str]]:
    """Yield the names and texts of the properties that a POU of CODESYS or TwinCAT keeps."""
    for text in texts_from("property", pou.extension_data):
        if named := _PROPERTY.search(text):
            yield named[1], text


class Inheritance(NamedTuple):
    """The names behind EXTENDS (at most one) and IMPLEMENTS."""

    extends: tuple[str, ...] = ()
    implements: tuple[str, ...] = ()

    def text(self) -> str:
        """As the header of the POU has it: ``EXTENDS Base IMPLEMENTS IValve, IDrive``."""
        parts = (("EXTENDS", self.extends), ("IMPLEMENTS", self.implements))
        return " ".join(f"{word} {', '.join(names)}" for word, names in parts if names)

    def keep(self) -> ExtensionData | None:
        """Return its content as an interface keeps it."""
        parts = (("extends", self.extends), ("implements", self.implements))
        return keep({name: ", ".join(names) for name, names in parts if names})


def inheritance(interface: Interface | None) -> Inheritance:
    """Return the base and the interfaces of the POU or method of this interface."""
    if interface is None:
        return Inheritance()
    text = (interface.declaration or "").casefold()
    if "extends" in text or "implements" in text:
        tree = parse_declarations(interface.declaration or "", Dialect.CODESYS).tree
        for head in (item for item in tree.items if isinstance(item, PouHead)):
            return Inheritance(_names(head.extends), _names(head.implements))
    return kept_inheritance(interface.extension_data)


def names_of_bases(pou: Pou) -> tuple[str, ...]:
    """Return the names of the blocks that one extends: one at most."""
    return inheritance(pou.interface).extends


def bases_of(
    pou: Pou, pous: Mapping[str, Pou], names: Callable[[Pou], Iterable[str]] = names_of_bases
) -> Iterator[Pou]:
    """Yield those of `pous`, which are by their names in lower case, that a POU extends, directly or not.

    `names` gives those of the bases of each.
    """
    waiting, seen = [pou], {pou.name.casefold()}
    while waiting:
        for base in names(waiting.pop()):
            name = base.rpartition(".")[2].casefold()  # behind that of a library
            if name in pous and name not in seen:
                seen.add(name)
                waiting.append(pous[name])
                yield pous[name]


def kept_inheritance(extension_data: ExtensionData | None) -> Inheritance:
    """Return the kept parts of EXTENDS and IMPLEMENTS of an object."""
    texts = kept(extension_data)
    return Inheritance(_listed(texts.get("extends", "")), _listed(texts.get("implements", "")))


def _listed(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _names(nodes: tuple[n.Expression, ...]) -> tuple[str, ...]:
    return tuple(map(print_node, nodes))
