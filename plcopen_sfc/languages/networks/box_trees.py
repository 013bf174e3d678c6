"""Networks of TwinCAT 3 (``NWL``, archives of box trees) as structured text.

One file at hand has such a body: a network that assigns an OR of operands. So read are networks of assignments with
trees of standard operators; AND, XOR, NOT and comparisons by analogy with OR. Flags of pins, of which no file shows the
meaning of another number than 0, calls of blocks, instruction list, labels and jumps are not understood.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.nodes import Operator
from plcopen_sfc.model.dialect import Dialect

_TAG = re.compile(r"<(?P<end>/?)(?P<tag>\w+)(?P<attributes>(?:\s+[\w:]+=\"[^\"]*\")*)\s*(?P<empty>/?)>(?P<text>[^<]*)")
_ATTRIBUTE = re.compile(r'([\w:]+)="([^"]*)"')
_MANY = {"AND": Operator.AND, "OR": Operator.OR, "XOR": Operator.XOR}
_TWO = {
    **{"GT": Operator.GREATER, "GE": Operator.GREATER_OR_EQUAL, "EQ": Operator.EQUAL},
    **{"LE": Operator.LESS_OR_EQUAL, "LT": Operator.LESS, "NE": Operator.UNEQUAL},
}
_COMPARED = 2
"""The inputs of a box that compares."""


class UnknownNetworkError(Exception):
    """Something that no known file has in a network."""


@dataclass(slots=True)
class _Element:
    tag: str
    attributes: dict[str, str]
    text: str
    start: int
    children: list[_Element] = field(default_factory=list)

    def child(self, name: str) -> _Element:
        found = [each for each in self.children if each.attributes.get("n") == name]
        if len(found) != 1:
            raise UnknownNetworkError
        return found[0]

    def value(self, name: str) -> str:
        return self.child(name).text

    def items(self, name: str) -> Iterator[tuple[str, _Element]]:
        """Yield the elements of a list with their types: their own, or the one of all in it."""
        held = self.child(name)
        return ((each.attributes.get("t", held.attributes.get("cet", "")), each) for each in held.children)


def is_box_tree(content: str) -> bool:
    """True for a body in the form of ``NWL``."""
    return content.startswith("<NWL")


class BoxTrees:
    """The networks of a body. Raises `UnknownNetworkError`."""

    def __init__(self, content: str) -> None:
        self.done: list[n.Statement] = []
        self.operands: list[tuple[int, n.Expression]] = []
        (root,) = _tree(content).children
        held = _only(_only(_only(root, "XmlArchive"), "Data"), "o")
        if held.attributes.get("t") != "NWLImplementationObject":
            raise UnknownNetworkError
        for kind, network in held.items("NetworkList"):
            if kind != "Network":
                raise UnknownNetworkError
            executed = self._network(network)
            if network.value("OutCommented") == "false":  # the names in others are names, too
                self.done += executed

    def _network(self, network: _Element) -> list[n.Statement]:
        found: list[n.Statement] = []
        plain = {"ILActive": "false", "Label": '""'}
        if any(network.value(name) != value for name, value in plain.items()) or network.child("Connectors").children:
            raise UnknownNetworkError
        for kind, item in network.items("NetworkItems"):
            if kind != "BoxTreeAssign":
                raise UnknownNetworkError
            _refuse_flags(item)
            value = self._value(item.child("RValue").attributes.get("t", ""), item.child("RValue"))
            for what, target in item.child("OutputItems").items("OutputItems"):
                if what != "Operand":
                    raise UnknownNetworkError
                found.append(n.Assignment(self._operand(target), value))
        return found

    def _value(self, kind: str, element: _Element) -> n.Expression:
        if kind == "BoxTreeOperand":
            return self._operand(element.child("Operand"))
        if kind != "BoxTreeBox":
            raise UnknownNetworkError
        _refuse_flags(element)
        called = element.child("Instance").child("Operand").tag != "n"
        outputs = [each.tag for _, each in element.child("OutputItems").items("OutputItems")]
        plain = element.value("EN") == element.value("ENO") == "false" and element.child("STSnippet").tag == "n"
        if called or not plain or outputs not in ([], ["n"]) or element.child("InputFlags").children:
            raise UnknownNetworkError
        inputs = tuple(self._value(*each) for each in element.items("InputItems"))
        box = element.value("BoxType").strip('"')
        if box in _MANY and len(inputs) > 1:
            return n.Operation(_MANY[box], inputs)
        if box in _TWO and len(inputs) == _COMPARED:
            return n.Operation(_TWO[box], inputs)
        if box == "NOT" and len(inputs) == 1:
            return n.Unary(Operator.NOT, inputs[0])
        raise UnknownNetworkError

    def _operand(self, element: _Element) -> n.Expression:
        _refuse_flags(element)
        held = element.child("Operand")
        text = held.text[1:-1]  # the quotes around it
        if held.tag != "v" or not text or "&" in text or '"' in text:
            raise UnknownNetworkError
        parsed = parse_expression(text, Dialect.CODESYS)
        if parsed.problems:
            raise UnknownNetworkError
        self.operands.append((held.start + 1, parsed.tree))
        return parsed.tree


def _refuse_flags(element: _Element) -> None:
    if element.child("Flags").value("Flags") != "0":
        raise UnknownNetworkError


def _only(element: _Element, tag: str) -> _Element:
    found = [each for each in element.children if each.tag == tag]
    if len(found) != 1:
        raise UnknownNetworkError
    return found[0]


def _tree(content: str) -> _Element:
    """Return the elements of an archive, which has no comments and no sections of text."""
    root = _Element("", {}, "", 0)
    around: list[_Element] = [root]
    place = 0
    for found in _TAG.finditer(content):
        if found.start() != place:
            raise UnknownNetworkError
        place = found.end()
        if found["end"]:
            if len(around) == 1 or around.pop().tag != found["tag"]:
                raise UnknownNetworkError
            continue
        element = _Element(
            found["tag"], dict(_ATTRIBUTE.findall(found["attributes"])), found["text"], found.start("text")
        )
        around[-1].children.append(element)
        if not found["empty"]:
            around.append(element)
    if place != len(content) or len(around) != 1 or len(root.children) != 1:
        raise UnknownNetworkError
    return root
