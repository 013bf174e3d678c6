"""Levels of declarations: names that are visible together, and the declarations that a name can refer to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.types import ArrayType, DataType, EnumType, PointerType, StructType, Variable
from plcopen_sfc.model.variables import Interface


class Level:
    """Names that are visible together: those of one scope, or the members of one type."""

    def __init__(self, declarations: Iterable[Declaration] = ()) -> None:
        self._by_name: dict[str, list[Declaration]] = {}
        for declaration in declarations:
            self.add(declaration)

    def add(self, declaration: Declaration) -> None:
        """Put a declaration in; a list of global variables joins the parts of it that are in already."""
        if not declaration.name:
            return
        there = self._by_name.setdefault(declaration.name.casefold(), [])
        if declaration.kind is Kind.GLOBAL_LIST:
            for index, other in enumerate(there):
                if other.kind is Kind.GLOBAL_LIST and other.path == declaration.path:
                    holders = (*other.holders, *declaration.holders)
                    there[index] = Declaration(other.kind, other.path, holders)
                    return
        if declaration not in there:
            there.append(declaration)

    def named(self, name: str) -> list[Declaration]:
        """Return the declarations of this name; case does not matter."""
        return self._by_name.get(name.casefold(), [])

    def __iter__(self) -> Iterator[Declaration]:
        return (declaration for declarations in self._by_name.values() for declaration in declarations)

    def __contains__(self, declaration: object) -> bool:
        return isinstance(declaration, Declaration) and declaration in self.named(declaration.name)


def members_of(type_: StructType, path: str, pou: Pou | None) -> Iterator[Declaration]:
    """Yield the members of a structure."""
    return (Declaration(Kind.MEMBER, f"{path}.{member.name}", (member,), pou) for member in type_.members)


def values_of(type_: EnumType, path: str, pou: Pou | None) -> Iterator[Declaration]:
    """Yield the values of an enumeration."""
    return (Declaration(Kind.ENUM_VALUE, f"{path}.{value.name}", (value,), pou) for value in type_.values)


def variables_of(interface: Interface | None, path: str, pou: Pou | None) -> Iterator[Declaration]:
    """Yield the variables of an interface, and the values of enumerations that are declared in place."""
    for variable in interface.variables() if interface is not None else ():
        yield variable_of(variable, path, pou)
        for type_ in inside(variable.type):
            if isinstance(type_, EnumType):
                yield from values_of(type_, path, pou)


def variable_of(variable: Variable, path: str, pou: Pou | None) -> Declaration:
    """Return a variable that is declared in `path`, which is empty for a global one that no list holds."""
    return Declaration(Kind.VARIABLE, f"{path}.{variable.name}" if path else variable.name, (variable,), pou)


def inside(type_: DataType) -> Iterator[DataType]:
    """Yield a type and the types that are declared in it, but for those of the members of structures."""
    yield type_
    if isinstance(type_, ArrayType | PointerType):
        yield from inside(type_.base)


@dataclass(frozen=True, slots=True)
class Binding:
    """Declaration that a name refers to. None: nothing of the project, or, with `doubt`, that is not known.

    `candidates` are the declarations that are in doubt; None: it can be any that has members or parameters.
    """

    declaration: Declaration | None = None
    doubt: str = ""
    candidates: tuple[Declaration, ...] | None = None


NOTHING = Binding()
"""Nothing of the project: a standard function, a library, a name that is declared nowhere."""
