"""Terms of ``.grafcet`` files and conditions as text: each way in one place."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from lxml import etree

from plcopen_sfc.languages.grafcet_conditions import ConditionError, to_structured_text
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node
from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value

XSI_TYPE = "{http://www.w3.org/2001/XMLSchema-instance}type"
_INFIX = {"And": "AND", "Or": "OR", "Equality": "=", "GreaterThan": ">", "LessThan": "<", "Addition": "+"}
_INFIX["Substraction"] = "-"
_PREFIX = {"Not": "NOT ", "RisingEdge": "↑", "FallingEdge": "↓"}
_OPERATIONS = {n.Operator(word): name for name, word in _INFIX.items()}
_NEGATED = {
    n.Operator.UNEQUAL: n.Operator.EQUAL,
    n.Operator.GREATER_OR_EQUAL: n.Operator.LESS,
    n.Operator.LESS_OR_EQUAL: n.Operator.GREATER,
}
_INTEGERS = ("Addition", "Substraction", "IntegerConstant")
_MOST = 2**31 - 1


class TermError(ValueError):
    """A term that means nothing, or a condition that no term expresses."""


def kind_of(element: etree._Element) -> str:
    """Return the type of an element, without its prefix."""
    return element.get(XSI_TYPE, "").rpartition(":")[2]


def term_text(element: etree._Element, variable: Callable[[etree._Element], str]) -> str:
    """Return a term as text; `variable` gives the name that an element refers to. Raises `TermError`."""
    kind = kind_of(element) or "Variable"
    if kind == "Variable":
        return variable(element)
    if kind == "BooleanConstant":
        return "TRUE" if element.get("value") == "true" else "FALSE"
    if kind == "IntegerConstant":
        return element.get("value", "0")
    parts = [_operand(each, variable) for each in element.findall("subterm")]
    if kind in _PREFIX and len(parts) == 1:
        return _PREFIX[kind] + parts[0]
    if kind in _INFIX and len(parts) > 1:
        return f" {_INFIX[kind]} ".join(parts)
    raise TermError(f"the term {kind} has {len(parts)} operands" if kind in {**_PREFIX, **_INFIX} else f"{kind!r}")


def _operand(element: etree._Element, variable: Callable[[etree._Element], str]) -> str:
    text = term_text(element, variable)
    return f"({text})" if kind_of(element) in _INFIX else text


@dataclass(frozen=True, slots=True)
class DelayTerm:
    """A time in a condition: ``first/operand/last``."""

    first: str | None
    operand: str
    last: str | None


class ReadCondition:
    """A condition as a tree, with its edges; where it is a time as a whole, `delay` has that. Raises `TermError`."""

    def __init__(self, text: str) -> None:
        self._edges: dict[str, tuple[str, bool]] = {}
        self._delays: dict[str, DelayTerm] = {}
        try:
            read = to_structured_text(text, self)
        except ConditionError as error:
            raise TermError(f"{text!r}: {error}") from error
        self.delay_of_all = self._delays.get(read)
        self.tree = self._parsed(self.delay_of_all.operand if self.delay_of_all is not None else read)

    def edge(self, operand: str, *, rising: bool) -> str:
        """Return the name of an edge."""
        name = f"GRAFCET_EDGE_{len(self._edges) + 1}"
        self._edges[name] = (operand, rising)
        return name

    def delay(self, operand: str, first: str | None, last: str | None) -> str:
        """Return the name of a time."""
        name = f"GRAFCET_TIME_{len(self._delays) + 1}"
        self._delays[name] = DelayTerm(first, operand, last)
        return name

    def _parsed(self, text: str) -> n.Expression:
        parsed = parse_expression(text)
        if parsed.problems:
            raise TermError(f"{text!r}: {parsed.problems[0].message}")
        return parsed.tree

    def edge_of(self, name: str) -> tuple[n.Expression, bool] | None:
        """Return the operand and the direction of the edge that is called `name`."""
        found = self._edges.get(name)
        return (self._parsed(found[0]), found[1]) if found is not None else None

    def time_of(self, name: str) -> str | None:
        """Return the time that is called `name`, as people write it: ``2s/X3``."""
        found = self._delays.get(name)
        if found is None:
            return None
        parts = (found.first, found.operand, found.last)
        return "/".join(part.removeprefix("T#") for part in parts if part is not None)

    def times(self) -> list[str]:
        """Return the times in terms that a variable can be called after: those of operands without edges and times."""
        inner = [name for name, found in self._delays.items() if found is not self.delay_of_all]
        names = [name for name in inner if "GRAFCET_" not in self._delays[name].operand]
        return [name for name in map(self.time_of, names) if name is not None]


class TermWriter:
    """Writes terms. `positions` are the references to declared variables by their names in lower case."""

    def __init__(self, positions: Mapping[str, str]) -> None:
        self._positions = positions

    def write(self, parent: etree._Element, tag: str, tree: n.Expression, condition: ReadCondition, path: str) -> None:
        """Add a term with the name `tag`; `path` is its reference. Raises `TermError`."""
        element = etree.SubElement(parent, tag)
        number = parent.get("id", "0") + str(2 if parent.find("variable") is not None else 1)
        self._fill(element, n.bare(tree), condition, path, number)

    def variable(self, element: etree._Element, name: str, number: str) -> None:
        """Make `element` a reference to a variable. Raises `TermError`."""
        position = self._positions.get(name.casefold())
        if position is None:
            raise TermError(f"the variable {name} is not declared")
        element.set("sort", f"{position}/@sort")
        element.set("id", _number(number))
        element.set("variableDeclaration", position)

    def _fill(
        self, element: etree._Element, tree: n.Expression, condition: ReadCondition, path: str, number: str
    ) -> None:
        edge = condition.edge_of(tree.identifier) if isinstance(tree, n.Name) else None
        if isinstance(tree, n.Name) and edge is None:
            # the editor has no times in terms; people declare a variable that is called like one
            time = condition.time_of(tree.identifier)
            if time is not None and time.casefold() not in self._positions:
                shown = re.sub(r"GRAFCET_\w+", lambda name: self._shown(name[0], condition), time)
                raise TermError(f"{shown} is a time of an edge or of a time: no term has one, and no variable is one")
            element.set(XSI_TYPE, "terms:Variable")
            self.variable(element, time or tree.identifier, number)
            return
        kind, operands, value = self._operation(tree, edge)
        element.set(XSI_TYPE, f"terms:{kind}")
        element.set("sort", f"{path}/@output")
        element.set("id", _number(number))
        if value is not None:
            element.set("value", value)
        for index, operand in enumerate(operands):
            inner = etree.SubElement(element, "subterm")
            self._fill(inner, n.bare(operand), condition, f"{path}/@subterm.{index}", f"{number}{index + 2}")
        if operands:
            element.set("input", " ".join(each.get("sort", "") for each in element.findall("subterm")))
        output = etree.SubElement(element, "output")
        output.set(XSI_TYPE, "terms:Integer" if kind in _INTEGERS else "terms:Bool")
        output.set("id", _number(f"{number}1"))

    def _shown(self, name: str, condition: ReadCondition) -> str:
        edge = condition.edge_of(name)
        if edge is not None:
            return f"{'↑' if edge[1] else '↓'}{print_node(edge[0])}"
        return condition.time_of(name) or name

    def _operation(
        self, tree: n.Expression, edge: tuple[n.Expression, bool] | None
    ) -> tuple[str, tuple[n.Expression, ...], str | None]:
        if edge is not None:
            return ("RisingEdge" if edge[1] else "FallingEdge"), (edge[0],), None
        match tree:
            case n.Unary(n.Operator.NOT, operand):
                return "Not", (operand,), None
            case n.Operation(operator, operands) if operator in _NEGATED:
                return "Not", (n.Operation(_NEGATED[operator], operands),), None
            case n.Operation(operator, operands) if operator in _OPERATIONS:
                return _OPERATIONS[operator], operands, None
            case n.Literal(text):
                return _constant(text)
            case n.Unary(n.Operator.NEGATE, n.Literal(text)):
                return _constant(f"-{text}")
        raise TermError("no term of a .grafcet file expresses it")


def _constant(text: str) -> tuple[str, tuple[n.Expression, ...], str]:
    if re.fullmatch(r"-\d+", text):
        return "IntegerConstant", (), text
    try:
        value = literal_value(n.Literal(text))
    except LiteralError as error:
        raise TermError(f"{text} is no value of a .grafcet file") from error
    if value.kind is LiteralKind.BOOL:
        return "BooleanConstant", (), "true" if value.value else "false"
    if isinstance(value.value, int) and value.kind is not LiteralKind.DURATION:
        return "IntegerConstant", (), str(value.value)
    raise TermError(f"{text} is no value of a .grafcet file")


def _number(text: str) -> str:
    """Return an id that is an integer of 32 bits: those of the editor grow with the depth of the term."""
    digits = "".join(c for c in text if c.isdecimal()) or "0"
    return str(int(digits) % _MOST) if int(digits) > _MOST else digits
