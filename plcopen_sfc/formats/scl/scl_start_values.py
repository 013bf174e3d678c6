"""Start values of data blocks: the assignments between BEGIN and END_DATA_BLOCK."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.languages.declarations import write_value
from plcopen_sfc.languages.declarations.type_names import is_identifier
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.s7_types import number_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_statements
from plcopen_sfc.languages.start_values import Path, Types, ValuePathError, apart, assembled
from plcopen_sfc.model.types import SimpleValue, Value, Variable

DECLARED = "declared"
"""Extension data of a variable whose declaration has another value than its assignment: that of the declaration."""


def start_values(text: str, variables: list[Variable], types: Types) -> dict[str, Value] | None:
    """Return the initial values that assignments give to `variables`, by name in lower case; None if they hold more.

    They count instead of those of the declarations, element by element.
    """
    parsed = parse_statements(text, Dialect.SCL)
    if parsed.problems:
        return None
    named = {variable.name.casefold(): variable for variable in variables}
    given: dict[str, dict[Path, tuple[Path, str]]] = {}
    for statement in parsed.tree.statements:
        if isinstance(statement, n.Empty):
            continue
        if not isinstance(statement, n.Assignment) or statement.kind is not n.AssignmentKind.ASSIGN:
            return None
        path, span = _path(statement.target), statement.value.span
        if not path or span is None or not isinstance(path[0], str) or path[0].casefold() not in named:
            return None
        entry = (path[1:], text[span[0] : span[1]])
        entries = given.setdefault(path[0].casefold(), {})
        if _folded(path[1:]) in entries:
            return None
        entries[_folded(path[1:])] = entry
    found: dict[str, Value] = {}
    try:
        for name, entries in given.items():
            variable = named[name]
            usual = (
                apart(variable.initial, variable.type, types)
                if variable.initial is not None and () not in entries
                else ()
            )
            all_ = {_folded(path): (path, value) for path, value in usual} | entries
            value = assembled(all_.values(), variable.type, types)
            if value is not None:
                found[name] = value
    except ValuePathError:
        return None
    return found


def _folded(path: Path) -> Path:
    return tuple(each.casefold() if isinstance(each, str) else each for each in path)


def _path(node: n.Expression) -> Path:
    """Return the way to an element; empty if it is another."""
    if isinstance(node, n.Name):
        return (node.identifier,)
    if isinstance(node, n.Member):
        base = _path(node.base)
        return (*base, node.name.identifier) if base else ()
    if isinstance(node, n.Index):
        base = _path(node.base)
        indices = [_index(each) for each in node.indices]
        return (*base, tuple(i for i in indices if i is not None)) if base and None not in indices else ()
    return ()


def _index(node: n.Expression) -> int | None:
    if isinstance(node, n.Unary) and node.operator is n.Operator.NEGATE:
        inner = _index(node.operand)
        return None if inner is None else -inner
    return number_of(node.text) if isinstance(node, n.Literal) else None


def can_be_assigned(variable: Variable, types: Types) -> bool:
    """True if assignments can give a variable its initial value."""
    if variable.initial is None:
        return True
    try:
        entries = list(apart(variable.initial, variable.type, types))
        value = assembled(entries, variable.type, types)
    except ValuePathError:
        return False
    written = all(write_value(SimpleValue(text=text), Dialect.SCL) for _, text in entries)
    return bool(entries) and written and value == variable.initial


def write_start_values(variables: list[Variable], types: Types) -> Iterator[str]:
    """Yield the assignments that give `variables` their initial values."""
    for variable in variables:
        for path, text in apart(variable.initial, variable.type, types) if variable.initial is not None else ():
            yield f"{_written(variable.name, path)} := {write_value(SimpleValue(text=text), Dialect.SCL)};"


def _written(name: str, path: Path) -> str:
    found = _name(name)
    for each in path:
        found += f".{_name(each)}" if isinstance(each, str) else f"[{', '.join(map(str, each))}]"
    return found


def _name(name: str) -> str:
    return name if is_identifier(name) else f'"{name}"'
