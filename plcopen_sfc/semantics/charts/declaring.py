"""Variables that a chart brings with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcopen_sfc.semantics.programs.types import Type

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs import Scope


def override(scope: Scope, name: str, type_: Type) -> int:
    """A variable of this type, also where the POU declares the name with a type of the tool that nobody knows."""
    made = scope.layout.add(name, type_)
    made.initial = scope.library.initials.default(type_)
    return made.slot
