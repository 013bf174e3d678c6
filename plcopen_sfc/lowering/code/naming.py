"""Names that a lowering gives: legal, free, and the same whenever the chart is lowered again."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Container, Iterable

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.standard_blocks import S7_INSTANCES
from plcopen_sfc.model.types import DerivedType


class Naming:
    """Gives names that nothing else in the POU has. `taken` are all names that occur in it."""

    def __init__(self, dialect: Dialect, taken: Iterable[str]) -> None:
        self._local = n.Quoting.LOCAL if dialect is Dialect.SCL else n.Quoting.NONE
        self._taken = {name.casefold() for name in taken}
        self._numbers: dict[str, int] = {}

    def system_type(self, kind: DerivedType) -> DerivedType:
        """A function block of the standard as the dialect calls the type of its instances: ``TON_TIME`` in SCL."""
        name = S7_INSTANCES.get(kind.name) if self._local is n.Quoting.LOCAL else None
        return DerivedType(name=name) if name is not None else kind

    def fresh(self, wanted: str) -> str:
        """`wanted` as an identifier, with a number behind it if that is taken."""
        name = candidate = _identifier(wanted)
        number = self._numbers.get(name.casefold(), 2)
        while candidate.casefold() in self._taken:
            candidate = f"{name}_{number}"
            number += 1
        self._numbers[name.casefold()] = number
        self._taken.add(candidate.casefold())
        return candidate

    def local(self, name: str) -> n.Name:
        """A name of the POU's interface as the dialect writes it."""
        return n.Name(name, self._local)


def free_name(wanted: str, taken: Container[str]) -> str:
    """`wanted`, with a number behind it if that is among the names in lower case that are `taken`."""
    name, number = wanted, 2
    while name.casefold() in taken:
        name, number = f"{wanted}_{number}", number + 1
    return name


def _identifier(wanted: str) -> str:
    spelled = unicodedata.normalize("NFC", wanted)
    name = re.sub(r"_{2,}", "_", re.sub(r"\W", "_", spelled)).strip("_")
    return name if name and not name[0].isdigit() else f"x{name}"
