"""Start values of data blocks: the assignments between BEGIN and END_DATA_BLOCK."""

from __future__ import annotations

from plcopen_sfc.languages.declarations import write_value
from plcopen_sfc.languages.declarations.names import is_identifier
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_statements
from plcopen_sfc.model.types import ArrayValue, MemberValue, SimpleValue, StructValue, Value, Variable


def read_start_values(text: str, variables: list[Variable]) -> bool:
    """Give `variables` the initial values that the assignments say. False if they say more than that: nothing is done.

    Only plain assignments to variables and members that have no initial value are understood: no comments, no elements
    of arrays.
    """
    parsed = parse_statements(text, Dialect.SCL)
    if parsed.problems or parsed.comments:
        return False
    named = {variable.name.casefold(): variable for variable in variables}
    values: dict[str, Value] = {}
    for statement in parsed.tree.statements:
        if not isinstance(statement, n.Assignment) or statement.kind is not n.AssignmentKind.ASSIGN:
            return False
        path = _path(statement.target)
        span = statement.value.span
        if not path or span is None or path[0].casefold() not in named:
            return False
        if not _put(values, [path[0].casefold(), *path[1:]], SimpleValue(text=text[span[0] : span[1]])):
            return False
    if any(named[name].initial is not None for name in values):
        return False
    for name, value in values.items():
        named[name].initial = value
    return True


def _path(node: n.Expression) -> list[str]:
    """The names that lead to a member; empty if the way is another."""
    if isinstance(node, n.Name):
        return [node.identifier]
    if isinstance(node, n.Member):
        base = _path(node.base)
        return [*base, node.name.identifier] if base else []
    return []


def _put(values: dict[str, Value], path: list[str], value: SimpleValue) -> bool:
    """Put `value` in; False if there is one already, or one of what it is a part of."""
    if len(path) == 1:
        if path[0] in values:
            return False
        values[path[0]] = value
        return True
    struct = values.setdefault(path[0], StructValue())
    for number, name in enumerate(path[1:], 1):
        if not isinstance(struct, StructValue):
            return False
        found = next((m for m in struct.members if m.member.casefold() == name.casefold()), None)
        last = number == len(path) - 1
        if found is not None and last:
            return False
        if found is None:
            found = MemberValue(member=name, value=value if last else StructValue())
            struct.members.append(found)
            found = struct.members[-1]
        struct = found.value
    return True


def can_be_assigned(value: Value | None) -> bool:
    """Whether assignments can say `value`."""
    match value:
        case None:
            return True
        case ArrayValue():
            return False
        case StructValue(members=members):
            return bool(members) and all(can_be_assigned(member.value) for member in members)
        case SimpleValue():
            return bool(write_value(value, Dialect.SCL))


def write_start_values(variables: list[Variable]) -> list[str]:
    """The assignments that give `variables` their initial values."""
    return [line for v in variables if v.initial is not None for line in _assignments(_name(v.name), v.initial)]


def _assignments(path: str, value: Value) -> list[str]:
    if isinstance(value, StructValue):
        return [line for m in value.members for line in _assignments(f"{path}.{_name(m.member)}", m.value)]
    return [f"{path} := {write_value(value, Dialect.SCL)};"]


def _name(name: str) -> str:
    return name if is_identifier(name) else f'"{name}"'
