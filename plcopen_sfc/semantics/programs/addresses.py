"""Direct addresses: the memory image of a controller (ed. 3, 6.5.5)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.memory_addresses import MemoryAddress, memory_address
from plcopen_sfc.model import types as m
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.places import Place

_TYPES = {1: "BOOL", 8: "BYTE", 16: "WORD", 32: "DWORD", 64: "LWORD"}


def address_of(text: str, *, by_bytes: bool) -> MemoryAddress:
    """Return the address that a text names. Raises `SimulationError`."""
    found = memory_address(text, by_bytes=by_bytes)
    if found is None:
        raise SimulationError(f"{text} is no address that the simulator knows")
    return found


class Image:
    """The variables at direct addresses. Each address is a variable; those that overlap in part are refused.

    Words are numbered as words in IEC 61131-3 and CODESYS (``%MW1`` lies behind ``%MW0``), as bytes in TwinCAT and S7:
    `by_bytes`. `add` makes a new global variable.
    """

    def __init__(self, add: Callable[[str, t.Type, m.Value | None], Place], *, by_bytes: bool) -> None:
        self._add = add
        self._bytes = by_bytes
        self._places: dict[MemoryAddress, Place] = {}
        self._bits: dict[tuple[str, int], MemoryAddress] = {}

    def addresses(self) -> Mapping[str, MemoryAddress]:
        """Addresses of variables, by their paths."""
        return {place.path: address for address, place in self._places.items()}

    def place(self, address: str, type_: t.ScalarType | None, path: str, initial: m.Value | None) -> Place:
        """Return the variable at an address; the first one that names it gives it its type."""
        key = address_of(address, by_bytes=self._bytes)
        found = self._places.get(key)
        if found is not None and type_ is None:
            return found
        type_ = type_ or t.ELEMENTARY[_TYPES[key.width]]
        if found is None:
            for bit in range(key.start, key.start + key.width):
                other = self._bits.setdefault((key.area, bit), key)
                if other != key:
                    raise SimulationError(
                        f"{address} overlaps {self._places[other].path}, which the simulator keeps apart",
                        hint="use one of them with .%Xn for its bits",
                    )
            found = self._places[key] = self._add(path, type_, initial)
        elif found.type != type_ and isinstance(found.type, t.ScalarType):
            same = {found.type.family, type_.family} <= {t.Family.INTEGER, t.Family.BITS}
            if not same or found.type.least != type_.least:
                raise SimulationError(f"{address} is a {found.type.name} and a {type_.name} at once")
        return found
