"""Mutants of code: of structured text by its syntax tree, of networks and of declarations by their model.

Each is the code with one mistake of those that a generator, a converter or an engineer can make.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from plcopen_sfc import model as m
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node, render, transform, walk
from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value, time_literal
from plcopen_sfc.languages.st.nodes import Operator
from plcopen_sfc.model.dialect import Dialect

__all__ = ["Mutant", "body_mutants", "boolean_names", "doubled_time", "expression_mutants", "initial_value_mutants"]


@dataclass(frozen=True)
class Mutant:
    """A project with one mistake: `kind` of mistake, `place` in words, and how it is made in a copy of the project."""

    kind: str
    place: str
    project: m.Project
    change: Callable[[m.Project], None]

    def made(self) -> m.Project:
        """The copy with the mistake."""
        copy = self.project.model_copy(deep=True)
        self.change(copy)
        return copy

    def __str__(self) -> str:
        return f"{self.kind}: {self.place}"


TextMutant = tuple[str, str, Callable[[], str]]
"""Kind, place, and the text."""

_BOOLEAN = frozenset({Operator.OR, Operator.OR_ELSE, Operator.XOR, Operator.AND, Operator.AND_THEN, Operator.NOT})
_LIMITS = {
    Operator.LESS: Operator.LESS_OR_EQUAL,
    Operator.LESS_OR_EQUAL: Operator.LESS,
    Operator.GREATER: Operator.GREATER_OR_EQUAL,
    Operator.GREATER_OR_EQUAL: Operator.GREATER,
    Operator.EQUAL: Operator.UNEQUAL,
    Operator.UNEQUAL: Operator.EQUAL,
}
_SUMS = frozenset({Operator.ADD, Operator.SUBTRACT})
_TRUE, _FALSE = n.Literal("TRUE"), n.Literal("FALSE")
_SHOWN = 70


def boolean_names(pou: m.Pou) -> frozenset[str]:
    """The names of the Boolean variables of a POU, in lower case."""
    return frozenset(v.name.casefold() for v in pou.variables() if _elementary(v) == "BOOL")


def _elementary(variable: m.Variable) -> str:
    return variable.type.name.value if isinstance(variable.type, m.ElementaryType) else ""


# -- structured text


def body_mutants(project: m.Project, name: str, booleans: frozenset[str] = frozenset()) -> Iterator[Mutant]:
    """The mutants of the body of this name (``Main``, ``Main.Fill``): text, or networks."""
    for path, pou, body in project.bodies():
        if path.casefold() != name.casefold():
            continue
        known = booleans | boolean_names(pou)
        if isinstance(body, m.StBody):
            for kind, place, text in text_mutants(body.text, project.dialect, known):
                yield Mutant(kind, place, project, partial(_set_text, path, text))
        elif isinstance(body, m.FbdBody | m.LdBody):
            for kind, place, change in _network_mutants(body):
                yield Mutant(kind, place, project, partial(_change_body, path, change))
        return


def _body(project: m.Project, name: str) -> m.Body:
    return next(body for path, _, body in project.bodies() if path == name)


def _set_text(name: str, text: Callable[[], str], project: m.Project) -> None:
    body = _body(project, name)
    assert isinstance(body, m.StBody)
    body.text = text()


def _change_body(name: str, change: Callable[[Any], None], project: m.Project) -> None:
    change(_body(project, name))


def text_mutants(text: str, dialect: Dialect, booleans: frozenset[str] = frozenset()) -> Iterator[TextMutant]:
    """Mutants of the text of a body; `booleans`: names of Boolean variables, in lower case."""
    parsed = parse_statements(text, dialect)

    def shown(node: n.Node) -> str:
        words = " ".join(print_node(node).split())
        line = text.count("\n", 0, node.span[0]) + 1 if node.span else 0
        return f"line {line}, {words[:_SHOWN]}{'..' if len(words) > _SHOWN else ''}"

    def edited(old: n.Node, new: n.Node) -> str:
        return render(parsed, transform(parsed.tree, lambda node: new if node is old else node))

    tree = parsed.tree
    states = _states(tree)
    for node in walk(tree):
        for kind, told, new in _changes(node, booleans, states, dialect):
            yield kind, shown(told), partial(edited, node, new)


def _states(tree: n.Statements) -> dict[str, list[str]]:
    """The numbers that selectors of a CASE are given, and variables that selectors are copied from."""
    selectors = [node.selector for node in walk(tree) if isinstance(node, n.Case)]
    names = {each.identifier.casefold() for each in selectors if isinstance(each, n.Name)}
    for node in walk(tree):
        match node:
            case n.Assignment(target=n.Name(identifier=to), value=n.Name(identifier=source)) if to.casefold() in names:
                names.add(source.casefold())
    found: dict[str, list[str]] = {name: [] for name in names}
    for node in walk(tree):
        if isinstance(node, n.Assignment) and isinstance(node.target, n.Name) and isinstance(node.value, n.Literal):
            numbers = found.get(node.target.identifier.casefold())
            if numbers is not None and node.value.text.isdigit() and node.value.text not in numbers:
                numbers.append(node.value.text)
    return found


def _changes(
    node: n.Node, booleans: frozenset[str], states: dict[str, list[str]], dialect: Dialect
) -> Iterator[tuple[str, n.Node, n.Node]]:
    """Kind of mistake, the node that tells its place, and what stands instead of `node`."""
    yield from _of_lists(node)
    if isinstance(node, n.Branch):
        yield "condition negated", node.condition, replace(node, condition=_negated(node.condition))
        if node.condition != _TRUE:
            yield "condition TRUE", node.condition, replace(node, condition=_TRUE)
    if isinstance(node, n.Operation):
        yield from _of_operation(node)
    if isinstance(node, n.Assignment) and node.kind is n.AssignmentKind.ASSIGN:
        if _is_boolean(node.value, booleans):
            yield "assignment inverted", node, replace(node, value=_negated(node.value))
        elif isinstance(node.value, n.Literal) and node.value.text.isdigit():
            yield from _of_number(node, node.value, states)
    if isinstance(node, n.Literal) and (longer := doubled_time(node.text, dialect)):
        yield "time changed", node, n.Literal(longer)


def _of_lists(node: n.Node) -> Iterator[tuple[str, n.Node, n.Node]]:
    """Statements doubled and removed."""
    for name in ("statements", "otherwise"):
        inner = getattr(node, name, None) or ()
        for i, each in enumerate(inner):
            if isinstance(each, n.Empty):
                continue
            both = {"statement removed": (n.Empty(),), "statement doubled": (each, _copy(each))}
            for kind, put in both.items():
                yield kind, each, replace(node, **{name: (*inner[:i], *put, *inner[i + 1 :])})


def _copy(node: Any) -> Any:
    """The same statement without its place in the text, so that it is printed for itself."""
    return transform(node, lambda each: replace(each, span=None))


def _of_operation(node: n.Operation) -> Iterator[tuple[str, n.Node, n.Node]]:
    if node.operator in (Operator.AND, Operator.AND_THEN, Operator.OR, Operator.OR_ELSE):
        which = "conjunct dropped" if node.operator in (Operator.AND, Operator.AND_THEN) else "disjunct dropped"
        for i, each in enumerate(node.operands):
            rest = node.operands[:i] + node.operands[i + 1 :]
            yield which, each, rest[0] if len(rest) == 1 else replace(node, operands=rest)
    if (other := _LIMITS.get(node.operator)) is not None:
        yield "comparison changed", node, replace(node, operator=other)
    if node.operator in _SUMS and isinstance(node.operands[-1], n.Literal) and node.operands[-1].text == "1":
        yield "counts by two", node, replace(node, operands=(*node.operands[:-1], n.Literal("2")))


def _of_number(node: n.Assignment, value: n.Literal, states: dict[str, list[str]]) -> Iterator[Any]:
    numbers = states.get(node.target.identifier.casefold()) if isinstance(node.target, n.Name) else None
    if numbers is None:
        yield "number changed", node, replace(node, value=n.Literal(str(int(value.text) + 1)))
        return
    others = [each for each in numbers if each != value.text]
    if others:
        yield "goes elsewhere", node, replace(node, value=n.Literal(others[int(value.text) % len(others)]))
    yield "goes nowhere", node, replace(node, value=n.Literal(str(max(map(int, numbers)) + 7)))


def _negated(node: n.Expression) -> n.Expression:
    if node == _TRUE:
        return _FALSE
    if node == _FALSE:
        return _TRUE
    if isinstance(node, n.Unary) and node.operator is Operator.NOT:
        return node.operand
    return n.Unary(Operator.NOT, node)


def _is_boolean(node: n.Expression, booleans: frozenset[str]) -> bool:
    node = n.bare(node)
    if isinstance(node, n.Operation | n.Unary):
        return node.operator in _BOOLEAN or node.operator in _LIMITS
    if isinstance(node, n.Name):
        return node.identifier.casefold() in booleans
    return isinstance(node, n.Literal) and node.text.upper() in ("TRUE", "FALSE")


def doubled_time(text: str, dialect: Dialect) -> str:
    """The literal of twice the time; empty: the text is no such literal."""
    try:
        value = literal_value(text, dialect)
        if value.kind is not LiteralKind.DURATION or not isinstance(value.value, int):
            return ""
        return time_literal(2 * value.value or 10**9, dialect, value.type or "TIME")
    except LiteralError:
        return ""


def expression_mutants(text: str, dialect: Dialect) -> Iterator[TextMutant]:
    """Mutants of an expression: parts left out, other comparisons, other times."""
    parsed = parse_expression(text, dialect)

    def edited(old: n.Node, new: n.Node) -> str:
        return render(parsed, transform(parsed.tree, lambda node: new if node is old else node))

    for node in walk(parsed.tree):
        for kind, told, new in _changes(node, frozenset(), {}, dialect):
            yield kind, print_node(told), partial(edited, node, new)


# -- declarations


def initial_value_mutants(project: m.Project, name: str) -> Iterator[Mutant]:
    """Mutants of a POU in which a variable, that is no input, begins with another value."""
    pou = project.pou(name)
    kinds = (m.SectionKind.LOCAL, m.SectionKind.OUTPUT)
    for section in pou.interface.sections if pou.interface is not None else ():
        for variable in section.variables if section.kind in kinds else ():
            other = _other_value(variable, project.dialect)
            if other:
                place = f"{variable.name} := {other}"
                yield Mutant("initial value changed", place, project, partial(_set_initial, name, variable.name, other))


def _other_value(variable: m.Variable, dialect: Dialect) -> str:
    kind = _elementary(variable)
    given = variable.initial.text if isinstance(variable.initial, m.SimpleValue) else None
    if variable.initial is not None and given is None:
        return ""
    if kind == "BOOL":
        return "FALSE" if (given or "").upper() in ("TRUE", "1") else "TRUE"
    if kind in ("TIME", "LTIME"):
        return doubled_time(given, dialect) if given else "T#1s"
    if kind in ("SINT", "INT", "DINT", "LINT", "USINT", "UINT", "UDINT", "ULINT"):
        return str(int(given or 0) + 1) if given is None or given.isdigit() else ""
    return ""


def _set_initial(pou: str, name: str, value: str, project: m.Project) -> None:
    variable = next(v for v in project.pou(pou).variables() if v.name == name)
    variable.initial = m.SimpleValue(text=value)


# -- networks


_SWAPPED = {m.Storage.SET: m.Storage.RESET, m.Storage.RESET: m.Storage.SET}
_SWAPPED_BLOCKS = {"AND": "OR", "OR": "AND"}

Change = Callable[[Any], None]


def _network_mutants(body: m.FbdBody | m.LdBody) -> Iterator[tuple[str, str, Change]]:
    for i, network in enumerate(body.networks):
        where = f"network {i + 1}"
        if len(body.networks) > 1:
            yield "statement removed", where, partial(_remove_network, i)
        for k, node in enumerate(network.nodes):
            yield from _node_mutants(node, f"{where}, {node.kind} {_label(node)}", i, k)


def _label(node: Any) -> str:
    return next((v for v in (getattr(node, f, None) for f in ("variable", "expression", "type_name")) if v), "")


def _remove_network(index: int, body: m.FbdBody | m.LdBody) -> None:
    del body.networks[index]


def _node_mutants(node: Any, where: str, i: int, k: int) -> Iterator[tuple[str, str, Change]]:
    if isinstance(node, m.Contact | m.InputVariable):
        if (longer := doubled_time(getattr(node, "expression", ""), Dialect.IEC)) != "":
            yield "time changed", where, partial(_set_field, i, k, "expression", longer)
        else:
            yield "condition negated", where, partial(_set_field, i, k, "negated", not node.negated)
    if isinstance(node, m.Contact):
        yield "condition TRUE", where, partial(_set_field, i, k, "variable", "TRUE")
    if isinstance(node, m.Coil | m.OutputVariable):
        if node.storage in _SWAPPED:
            yield "set for reset", where, partial(_set_field, i, k, "storage", _SWAPPED[node.storage])
            yield "set not stored", where, partial(_set_field, i, k, "storage", m.Storage.NONE)
        else:
            yield "assignment inverted", where, partial(_set_field, i, k, "negated", not node.negated)
    if isinstance(node, m.Block):
        if (other := _SWAPPED_BLOCKS.get(node.type_name)) is not None:
            yield "other block", where, partial(_set_field, i, k, "type_name", other)
        for p, pin in enumerate(node.parameters.inputs):
            if node.type_name in ("AND", "OR"):
                yield "condition negated", f"{where}, input {pin.name}", partial(_negate_pin, i, k, p)


def _set_field(i: int, k: int, field: str, value: object, body: m.FbdBody | m.LdBody) -> None:
    setattr(body.networks[i].nodes[k], field, value)


def _negate_pin(i: int, k: int, p: int, body: m.FbdBody | m.LdBody) -> None:
    block = body.networks[i].nodes[k]
    assert isinstance(block, m.Block)
    pin = block.parameters.inputs[p]
    pin.negated = not pin.negated
