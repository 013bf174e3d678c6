"""Declarations of a project: everything in it that has a name which program text can use."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from plcopen_sfc.errors import ModelError, nearest, shown
from plcopen_sfc.model.pou import Pou


class Kind(StrEnum):
    """The kinds of things that have names."""

    POU = "POU"
    METHOD = "method"
    ACTION = "action"
    TRANSITION = "transition"
    STEP = "step"
    VARIABLE = "variable"
    MEMBER = "member"
    ENUM_VALUE = "enumeration value"
    DATA_TYPE = "data type"
    DATA_BLOCK = "data block"
    GLOBAL_LIST = "list of global variables"
    INSTANCE = "program instance"
    NAMESPACE = "application"


def check_kind(kind: str) -> None:
    """Raise `ModelError` for what is no kind of declaration."""
    if kind not in [*Kind]:
        hint = f"The kinds are: {', '.join(Kind)}"
        raise ModelError(f"{shown(kind)} is no kind of declaration{nearest(kind, [*Kind])}", hint=hint)


class NamedObject(Protocol):
    """An object of the model that has a name."""

    name: str


@dataclass(frozen=True, slots=True, eq=False)
class Declaration:
    """A thing that is declared: a step, a variable, a POU ..

    `path` is its name with those of what it is in (``Main.S3``). `pou` is the POU that it belongs to, None for what
    is global. `holders` are the objects of the model that have the name: more than one where a list of global variables
    is in several parts. Two declarations are equal when they are of the same object.
    """

    kind: Kind
    path: str
    holders: tuple[NamedObject, ...]
    pou: Pou | None = None

    @property
    def holder(self) -> NamedObject:
        """The object of the model that has the name."""
        return self.holders[0]

    @property
    def name(self) -> str:
        """Its name."""
        return self.holder.name

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Declaration) and self.holder is other.holder

    def __hash__(self) -> int:
        return id(self.holder)

    def __str__(self) -> str:
        return f"{self.kind} {self.path}"
