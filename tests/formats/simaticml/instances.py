"""Random documents made from a schema, with every element and attribute that it declares."""

from __future__ import annotations

import random
from typing import Any

import xmlschema
from lxml import etree

from plcopen_sfc.formats.xml.schema_validation import schema_path

DEEP = 6
_VALUES = {
    "boolean": ("true", "false", "1", "0"),
    "int": ("0", "7", "-3", "21"),
    "integer": ("0", "12", "-70000"),
    "positiveInteger": ("1", "4"),
    "unsignedShort": ("0", "9", "16"),
    "double": ("1.5", "-2E3", "INF"),
    "dateTime": ("2024-01-31T08:30:00", "2024-01-31T08:30:00.5Z"),
    "string": ("", "x", "a b", "Länge"),
    "anySimpleType": ("", "x"),
}
_BY_PATTERN = ("de-DE", "zh-Hans-CN", "undef", "x7", "None", "Periphery, ", "1.0", "1.0.3", "3", "1,-2", "1;2,3")


class Instances:
    """Random documents of one of our schemas, most of them valid by it. The seed decides which."""

    def __init__(self, schema: str, root: str, seed: str) -> None:
        self.schema: Any = xmlschema.XMLSchema10(str(schema_path(schema)), allow="local")
        self.root = self.schema.elements[root]
        self.nsmap: Any = {None: self.schema.target_namespace}
        self.random = random.Random(seed)  # noqa: S311

    def instance(self) -> etree._Element:
        """A document of its own, as another program would read it."""
        made = self._element(self.root, 0)
        return etree.fromstring(etree.tostring(made))

    def _element(self, declaration: Any, depth: int) -> etree._Element:
        element = etree.Element(declaration.name, nsmap=self.nsmap)
        for name, attribute in declaration.type.attributes.items() if declaration.type.is_complex() else ():
            if name is not None and (attribute.use == "required" or self.random.random() < 0.3):
                element.set(name, self._value(attribute.type))
        content = declaration.type
        if content.is_simple() or content.has_simple_content():
            element.text = self._value(content if content.is_simple() else content.content)
        elif hasattr(content.content, "model"):
            self._fill(element, content.content, depth)
        return element

    def _fill(self, element: etree._Element, group: Any, depth: int) -> None:
        for _ in range(self._times(group, depth)):
            particles = [self.random.choice(list(group))] if group.model == "choice" and len(group) else list(group)
            for particle in particles:
                if hasattr(particle, "model"):
                    self._fill(element, particle, depth)
                elif particle.name is not None:
                    for _ in range(self._times(particle, depth)):
                        element.append(self._element(particle, depth + 1))

    def _times(self, particle: Any, depth: int) -> int:
        least = int(particle.min_occurs)
        most = least + 2 if particle.max_occurs is None else int(particle.max_occurs)
        if depth > DEEP:
            return least
        return self.random.randint(least, max(least, min(most, least + 2)))

    def _value(self, simple_type: Any) -> str:
        if simple_type.enumeration:
            return str(self.random.choice(simple_type.enumeration))
        if hasattr(simple_type, "member_types"):
            return self._value(self.random.choice(simple_type.member_types))
        fitting = [value for value in _BY_PATTERN if simple_type.patterns and simple_type.is_valid(value)]
        if fitting:
            return self.random.choice(fitting)
        node = simple_type
        while not str(node.name).startswith("{http://www.w3.org/2001/XMLSchema}"):
            node = node.base_type
        values = _VALUES[str(node.name).rpartition("}")[2]]
        return self.random.choice([value for value in values if simple_type.is_valid(value)])
