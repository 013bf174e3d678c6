"""Conditions of CODESYS V3 around declarations, ``{IF defined (X)} .. {END_IF}``, when variables are taken out."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.declarations.kept_texts import kept, with_kept
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import StructType, Variable
from plcopen_sfc.model.variables import VariableSection, sections_of

CONDITION = re.compile(r"\{\s*(?:(?P<start>IF)|ELSIF|ELSE|(?P<end>END_IF))\b", re.IGNORECASE)
"""A pragma that leaves out what is behind it, or ends that."""


def starts_condition(pragma: str) -> bool:
    """True for the first of the pragmas with which CODESYS compiles something or not."""
    found = CONDITION.match(pragma)
    return found is not None and found["start"] is not None


def without_conditions(text: str) -> str:
    """Return declarations without the lines that are conditions."""
    return "\n".join(line for line in text.split("\n") if CONDITION.match(line.strip()) is None)


def leave_conditions(before: Project, after: Project) -> None:
    """Leave the conditions before variables of `before` that `after` does not have any more to what is behind them.

    Pragmas are kept at the variable behind them: else ``{END_IF}`` would be alone. A condition of nothing is left out.
    """
    scopes = grouped(_scopes(after))
    for owner, olds in grouped(_scopes(before)).items():
        now = scopes.get(owner, [])
        for number, old in enumerate(olds):
            names = {each.name.casefold() for each in _variables(old)}
            shared = (new for new in now if names & {each.name.casefold() for each in _variables(new)})
            new = next(shared, now[number] if len(now) == len(olds) else None)
            if new is not None:
                _leave(_variables(old), new)


def _scopes(project: Project) -> Iterator[tuple[tuple[str, ...], VariableSection | StructType]]:
    """Yield each section and structure with the names of what it is declared in."""
    for pou in project.pous:
        yield from ((("POU", pou.name), section) for section in sections_of(pou.interface))
        for method in pou.methods:
            yield from ((("POU", pou.name, method.name), section) for section in sections_of(method.interface))
    yield from ((("list", section.name or ""), section) for section in project.global_sections())
    for each in project.data_types:
        if isinstance(each.type, StructType):
            yield ("type", each.name), each.type


def _variables(scope: VariableSection | StructType) -> Sequence[Variable]:
    return scope.members if isinstance(scope, StructType) else scope.variables


def _conditions(variable: Variable) -> list[str]:
    lines = kept(variable.extension_data).get("pragmas", "").splitlines()
    return [line for line in lines if CONDITION.match(line)]


def _leave(before: Sequence[Variable], scope: VariableSection | StructType) -> None:
    old = {each.name.casefold() for each in before}
    now = {each.name.casefold(): each for each in _variables(scope)}
    renamed = [_conditions(each) for name, each in now.items() if name not in old]
    left: list[str] = []
    for variable in before:
        here, conditions = now.get(variable.name.casefold()), _conditions(variable)
        if here is not None and left:
            _put(here, "pragmas", left)
            left = []
        elif here is None and conditions in renamed:
            renamed.remove(conditions)
        elif here is None:
            left += conditions
    if left:
        _put(scope, "closing", left)


def _put(holder: Variable | VariableSection | StructType, place: str, conditions: Sequence[str]) -> None:
    texts = kept(holder.extension_data)
    lines: list[str] = []
    for line in (*conditions, *texts.pop(place, "").splitlines()):
        found = CONDITION.match(line)
        start = _start_of_nothing(lines) if found is not None and found["end"] else None
        if start is None:
            lines.append(line)
        else:
            del lines[start:]
    holder.extension_data = with_kept(holder.extension_data, texts | ({place: "\n".join(lines)} if lines else {}))


def _start_of_nothing(lines: Sequence[str]) -> int | None:
    """Return where the condition begins that ends behind `lines` and has nothing in it; None without one."""
    for number in range(len(lines) - 1, -1, -1):
        found = CONDITION.match(lines[number])
        if found is None or found["end"]:
            return None
        if re.match(r"\{\s*IF\b", lines[number], re.IGNORECASE):
            return number
    return None
