"""What a schema says about one element: what may stand in it, and what its values may be.

The knowledge comes from xmlschema, which is slow to load: only `schema_explain` imports this module, and only for
files that libxml2 found invalid.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, cast

import xmlschema
from lxml import etree

from plcopen_sfc.formats.xml.schema_files import schema_path

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Grammar", "Rejection", "local_name"]

_XS = "{http://www.w3.org/2001/XMLSchema}"
_KINDS = {
    "dateTime": "a date and time like 2024-01-31T08:30:00",
    "date": "a date like 2024-01-31",
    "time": "a time of day like 08:30:00",
    "boolean": "true or false",
    "decimal": "a number like 12.5",
    "integer": "a whole number",
    "long": "a whole number",
    "unsignedLong": "a whole number, 0 or greater",
    "anyURI": "a web address or other URI",
    "language": "a language code like de or en-US",
    "ID": "a name that no other element of the file has, beginning with a letter or an underscore",
}


def local_name(tag: object) -> str:
    """A tag without its namespace."""
    return str(tag).rpartition("}")[2]


@dataclass(frozen=True, slots=True)
class Rejection:
    """A child that may not stand where it stands, or (`child` None) the end of an element that came too early.

    `expected` are the tags that could have stood there, `required` those of them without which it does not go on.
    """

    child: etree._Element | None
    expected: tuple[str, ...]
    required: tuple[str, ...]


class Grammar:
    """One of our schemas, for asking."""

    def __init__(self, name: str) -> None:
        # Our own file; still, nothing in it could make xmlschema look anywhere but on this disk.
        self._schema: Any = xmlschema.XMLSchema10(str(schema_path(name)), allow="local")

    @staticmethod
    @cache
    def of(name: str) -> Grammar:
        """The grammar of the schema with this name, loaded once."""
        return Grammar(name)

    def declaration(self, element: etree._Element) -> Any | None:
        """The declaration that an element has by its place; None where the schema has none (foreign elements)."""
        parent = element.getparent()
        if parent is None:
            return self._schema.maps.elements.get(element.tag)
        above = self.declaration(parent)
        found = None
        if above is not None and not above.type.has_simple_content():
            found = next((child for child in _children(above) if child.name == element.tag), None)
        # In foreign data everything that is declared globally is checked, wherever it stands.
        wild = above is None or any(child.name is None for child in _children(above)) or _is_anything(above)
        return self._schema.maps.elements.get(element.tag) if found is None and wild else found

    @staticmethod
    def children(declaration: Any) -> list[str]:
        """The tags that may stand in an element, in the order of the schema."""
        return list(dict.fromkeys(child.name for child in _children(declaration) if child.name is not None))

    @staticmethod
    def rejection(declaration: Any, element: etree._Element) -> Rejection | None:
        """The first thing that is wrong with the children of an element; None if their order is right."""
        # The content of the children is not of interest here, so they are looked at without it.
        children = [child for child in element if isinstance(child.tag, str)]
        shell = etree.Element(element.tag)
        for each in children:
            shell.append(etree.Element(each.tag))
        for error in declaration.iter_errors(shell):
            if isinstance(error, xmlschema.XMLSchemaChildrenValidationError) and error.elem is cast("Any", shell):
                particles: list[Any] = list(error.expected or ())
                names = tuple(dict.fromkeys(particle.name for particle in particles if particle.name))
                required = tuple(p.name for p in particles if p.name and p.min_occurs > 0)
                child = children[error.index] if error.index < len(children) else None
                return Rejection(child, names, required)
        return None

    @staticmethod
    def kind(simple_type: Any) -> str:
        """What a value of this type looks like, in words."""
        if simple_type.enumeration:
            return "one of " + ", ".join(str(value) for value in simple_type.enumeration)
        low, high = simple_type.min_value, simple_type.max_value
        base = _builtin(simple_type)
        if simple_type.name == _XS + base:
            return _KINDS.get(base, f"a value of type {base}")
        if base == "integer" and low is not None and high is not None:
            return f"a whole number from {low} to {high}"
        if simple_type.patterns:
            return "of the form " + " or ".join(simple_type.patterns.regexps)
        return _KINDS.get(base, f"a value of type {base}")

    @staticmethod
    def accepts(simple_type: Any, value: str) -> bool:
        """Whether a value is one of this type."""
        return bool(simple_type.is_valid(value))

    @staticmethod
    def base(simple_type: Any) -> str:
        """The name of the type of XML Schema that a type stands on (``dateTime``)."""
        return _builtin(simple_type)


def _children(declaration: Any) -> Iterator[Any]:
    content = declaration.type.content
    if hasattr(content, "iter_elements"):
        yield from content.iter_elements()


def _is_anything(declaration: Any) -> bool:
    return bool(declaration.type.name == f"{_XS}anyType")


def _builtin(simple_type: Any) -> str:
    node = simple_type
    while node is not None and not str(node.name).startswith(_XS):
        node = node.base_type
    return local_name(node.name) if node is not None else "string"
