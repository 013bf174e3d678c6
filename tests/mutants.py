"""Damaged copies of XML documents, from a seed: for comparing what two schemas say about them."""

from __future__ import annotations

import copy
import random
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence

from lxml import etree

Mutation = Callable[["Mutator", etree._Element], None]

VALUES = (
    "", " ", "x", "0", "1", "-1", "65535", "65536", "18446744073709551616", "1.5", "1,5", " 2 ", "+3", "true",
    "TRUE", "none", " none", "set", "rising", "N", "DL", "P1", "program", "functionBlock", "preserve", "readOnly",
    "Main", "a b", "http://x/y", "%zz", "de-DE", "de DE", "12:00:00", "2024-01-31T08:30:00",
    "2024-01-31 08:30:00", "2024-13-31T08:30:00Z",
)  # fmt: skip
_ATTRIBUTES = """
    localId name globalId height width executionOrderId negated edge storage formalParameter refLocalId priority
    interval type typeName pouType x y qualifier duration indicator initialStep targetName label instanceName
    hidden value member repetitionValue lower upper length address constant retain WorksheetName handleUnknown
    alias direction unheardOf {http://example.org/own}mark
"""
_TAGS = """
    position relPosition connectionPointIn connectionPointOut connectionPointOutAction connection expression
    documentation addData data body ST IL FBD LD SFC step macroStep jumpStep transition condition reference inline
    actionBlock action vendorElement block inVariable variable type baseType initialValue simpleValue arrayValue
    structValue value BOOL ANY derived string pou interface actions transitions localVars globalVars accessVars
    configVars task resource pouInstance comment content label jump unheardOf
"""


ATTRIBUTES = tuple(_ATTRIBUTES.split())
TAGS = tuple(_TAGS.split())


class Mutator:
    """Makes mutants of one document. The seed decides which; tags, attributes and values are what it puts in."""

    def __init__(
        self,
        root: etree._Element,
        seed: str,
        *,
        tags: Sequence[str] = TAGS,
        attributes: Sequence[str] = ATTRIBUTES,
        values: Sequence[str] = VALUES,
    ) -> None:
        self.root = root
        self.tags, self.attributes, self.values = tags, attributes, values
        self.random = random.Random(seed)  # noqa: S311

    def mutant(self) -> etree._Element:
        """A copy of the document with one damage, or what may be one."""
        root = copy.deepcopy(self.root)
        self.random.choice(MUTATIONS)(self, root)
        return root

    def element(self, root: etree._Element) -> etree._Element:
        """An element below `root`; rare kinds are as likely as frequent ones."""
        kinds: dict[tuple[str, str], list[etree._Element]] = defaultdict(list)
        for each in root.iterdescendants(etree.Element):
            kinds[str(each.getparent().tag), str(each.tag)].append(each)
        return self.random.choice(kinds[self.random.choice(sorted(kinds))])

    def tag(self, root: etree._Element) -> str:
        return f"{{{etree.QName(root).namespace}}}{self.random.choice(self.tags)}"

    # The mutations

    def remove(self, root: etree._Element) -> None:
        element = self.element(root)
        element.getparent().remove(element)

    def empty(self, root: etree._Element) -> None:
        element = self.element(root)
        for child in list(element):
            element.remove(child)
        element.text = None

    def move(self, root: etree._Element) -> None:
        element = self.element(root)
        parent = element.getparent()
        parent.remove(element)
        parent.insert(self.random.randint(0, len(parent)), element)

    def transplant(self, root: etree._Element) -> None:
        graft = copy.deepcopy(self.element(root))
        place = self.element(root)
        place.insert(self.random.randint(0, len(place)), graft)

    def double(self, root: etree._Element) -> None:
        element = self.element(root)
        element.addnext(copy.deepcopy(element))

    def rename(self, root: etree._Element) -> None:
        self.element(root).tag = self.tag(root)

    def unqualify(self, root: etree._Element) -> None:
        element = self.element(root)
        element.tag = etree.QName(element).localname

    def add(self, root: etree._Element) -> None:
        place = self.element(root)
        place.insert(self.random.randint(0, len(place)), etree.Element(self.tag(root)))

    def add_attribute(self, root: etree._Element) -> None:
        self.element(root).set(self.random.choice(self.attributes), self.random.choice(self.values))

    def with_attribute(self, root: etree._Element) -> tuple[etree._Element, str]:
        kinds: dict[tuple[str, str], list[etree._Element]] = defaultdict(list)
        for each in root.iter(etree.Element):
            for name in each.attrib:
                kinds[str(each.tag), str(name)].append(each)
        kind = self.random.choice(sorted(kinds))
        return self.random.choice(kinds[kind]), kind[1]

    def remove_attribute(self, root: etree._Element) -> None:
        element, name = self.with_attribute(root)
        del element.attrib[name]

    def change_value(self, root: etree._Element) -> None:
        element, name = self.with_attribute(root)
        element.set(name, self.random.choice(self.values))

    def add_text(self, root: etree._Element) -> None:
        element = self.element(root)
        if self.random.random() < 0.5:
            element.text = (element.text or "") + self.random.choice(self.values)
        else:
            element.tail = (element.tail or "") + self.random.choice(self.values)


MUTATIONS: tuple[Mutation, ...] = (
    Mutator.remove,
    Mutator.empty,
    Mutator.move,
    Mutator.transplant,
    Mutator.double,
    Mutator.rename,
    Mutator.unqualify,
    Mutator.add,
    Mutator.add_attribute,
    Mutator.add_attribute,
    Mutator.remove_attribute,
    Mutator.change_value,
    Mutator.change_value,
    Mutator.add_text,
)


_TELLING = (
    "",
    " ",
    "x",
    "0",
    "-1",
    "70000",
    "1.5",
    " 1",
    "true",
    " none",
    "set",
    "rising",
    "N",
    "DL",
    "program",
    "readOnly",
)
_PLAUSIBLE = {"edge": "none", "storage": "none", "negated": "true", "pouType": "program", "qualifier": "N"}


def systematic_mutants(root: etree._Element) -> Iterator[tuple[str, etree._Element]]:
    """Every kind of change at the first element of every kind, with a name for it.

    The document is changed in place and restored before the next one, so a mutant is good until then only.
    """
    kinds: dict[str, etree._Element] = {}
    attributes: dict[tuple[str, str], etree._Element] = {}
    for each in root.iterdescendants(etree.Element):
        where = f"{etree.QName(each.getparent()).localname}/{etree.QName(each).localname}"
        kinds.setdefault(where, each)
        for name in each.attrib:
            attributes.setdefault((where, str(name)), each)
    for where, element in kinds.items():
        yield from _structural(root, element, where)
    for (where, name), element in attributes.items():
        yield from _of_attribute(root, element, name, where)
    tags: dict[str, etree._Element] = {}
    for each in root.iter(etree.Element):
        tags.setdefault(str(each.tag), each)
    for tag, element in tags.items():
        for name in ATTRIBUTES:
            if name not in element.attrib:
                element.set(name, _PLAUSIBLE.get(name, "1"))
                yield f"{etree.QName(tag).localname} with {name}", root
                del element.attrib[name]


def _structural(root: etree._Element, element: etree._Element, where: str) -> Iterator[tuple[str, etree._Element]]:
    parent, place = element.getparent(), element.getparent().index(element)
    # lxml moves the text behind an element with it; nothing but blanks is there.
    parent.remove(element)
    yield f"{where} removed", root
    for number in sorted({0, max(0, place - 1), min(place + 1, len(parent)), len(parent)} - {place}):
        parent.insert(number, element)
        yield f"{where} at {number} instead of {place}", root
        parent.remove(element)
    parent.insert(place, element)
    twin = copy.deepcopy(element)
    parent.insert(place, twin)
    yield f"{where} doubled", root
    parent.remove(twin)
    tag = element.tag
    for other in ("unheardOf", etree.QName(tag).localname):
        element.tag = other if other != "unheardOf" else f"{{{etree.QName(root).namespace}}}{other}"
        yield f"{where} as {element.tag}", root
    element.tag = tag
    text = element.text
    for other in (None, " ", "x"):
        element.text = other
        yield f"{where} with text {other!r}", root
    element.text = text
    children = list(element)
    for child in children:
        element.remove(child)
    yield f"{where} without children", root
    element.extend(children)


def _of_attribute(
    root: etree._Element, element: etree._Element, name: str, where: str
) -> Iterator[tuple[str, etree._Element]]:
    value = element.attrib.pop(name)
    yield f"{where} without {name}", root
    for other in _TELLING:
        element.set(name, other)
        yield f"{where} {name}={other!r}", root
    element.set(name, value)
