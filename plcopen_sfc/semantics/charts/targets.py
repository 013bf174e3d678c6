"""What an association names: an action of the POU or of an instance, an instance or a program, a Boolean variable."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.model import PouKind
from plcopen_sfc.semantics.charts.plans import Run, Write
from plcopen_sfc.semantics.programs.layouts import Frame
from plcopen_sfc.semantics.programs.types import ElementaryType, Family, StructureType

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs import Scope


def execution(target: str, scope: Scope, where: str) -> tuple[Run | None, Write | None]:
    """How to execute it, or how to write it: one of both. A name that nobody declares is a Boolean variable."""
    action = scope.action(target)
    if action is not None:
        return action, None
    try:
        type_ = scope.type_of(target)
    except SimulationError:  # a member that is no variable: an action of the instance, or nothing that could be called
        return scope.statements(f"{target}();", where), None
    is_called = isinstance(type_, StructureType) or (type_ is None and _is_program(target, scope))
    if is_called:
        return scope.statements(f"{target}();", where), None
    if type_ is not None and not (isinstance(type_, ElementaryType) and type_.family is Family.BOOL):
        return None, _refusing(f"{target} is of type {type_.name}: only a Boolean variable can be an action", where)
    return None, scope.setter(target)


def _is_program(target: str, scope: Scope) -> bool:
    key = target.casefold()
    return any(pou.name.casefold() == key and pou.kind is PouKind.PROGRAM for pou in scope.library.project.pous)


def _refusing(message: str, where: str) -> Write:
    def fail(_: Frame, __: Any) -> None:
        raise SimulationError(message, location=Location(path=where))

    return fail
