"""Calls of functions and blocks that a project does not have: unknown functions of what they are given.

A function gives equal results for equal arguments. A block also depends on the calls before: equal calls at equal
intervals give equal results. A call writes its outputs and members of the instance, as far as is known.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from hashlib import blake2b
from typing import Any, TypeAlias

from plcopen_sfc.semantics.programs.runtime import Pointer, Processor
from plcopen_sfc.semantics.programs.runtime_types import INSTANT, LINT, Family, Frame, Layout, OpaqueType, ScalarType

_PLAIN = frozenset({bool, int, float, str, type(None)})
_SMALL = 12
"""Numbers below it are as likely as all others: programs compare with small ones."""


class UnknownCalls:
    """Results of calls that cannot be executed: values that are derived from all that they may depend on.

    `seed`: other values for another one. `log`: the calls that are statements, in the present scan.
    """

    def __init__(self) -> None:
        self.seed = 0
        self.log: list[tuple[str, str]] = []

    def begin(self) -> None:
        """Begin a scan."""
        self.log.clear()

    def value(self, name: str, arguments: Any, type_: ScalarType | OpaqueType) -> Any:
        """Return the result of a function, or an output of a block in a situation; equal for equal arguments."""
        return _of_type(self._number(name, self.key(arguments)), type_)

    def called(self, name: str, arguments: tuple[Any, ...], history: int, elapsed: int | None) -> Hashable:
        """Note the call of a block; its situation after that."""
        key = self.key(arguments)
        self.log.append((name, _text(key)))
        return self._number(name, (history, elapsed, key))

    @property
    def is_exact(self) -> bool:
        """True if instances keep what tells different histories apart."""
        return True

    def kept(self, situation: Hashable) -> int:
        """State that an instance keeps of its calls."""
        return situation if isinstance(situation, int) else 0

    def key(self, value: Any) -> Hashable:
        """Equal for equal values."""
        if type(value) in _PLAIN:  # most are, of hundreds in a scan
            return value  # type: ignore[no-any-return]
        if isinstance(value, Frame):
            return tuple(map(self.key, value.v))
        if isinstance(value, Pointer):
            return self.key(value.cells[value.index])
        return tuple(map(self.key, value)) if isinstance(value, tuple | list) else value

    def _number(self, *parts: object) -> int:
        digest = blake2b(repr((self.seed, parts)).encode(), digest_size=7).digest()
        return int.from_bytes(digest, "big")


def _text(key: Any) -> str:
    return ", ".join(map(_text, key)) if isinstance(key, tuple) else str(key)


def _of_type(number: int, type_: ScalarType | OpaqueType) -> Any:
    if isinstance(type_, OpaqueType):
        return number  # of its values nothing is known but which are equal
    small = number // 2 % _SMALL if number % 2 else number // 2
    match type_.family:
        case Family.BOOL:
            return number // 2 % 2 == 1
        case Family.REAL:
            return float(small % 100_000)
        case Family.STRING:
            return str(small % 100)[: type_.length]
        case Family.SPECIAL:
            return small
    if type_.names:
        return sorted(type_.names.values())[number % len(type_.names)]
    least, greatest = type_.narrowed or (type_.least, type_.greatest)
    if type_.family not in (Family.INTEGER, Family.BITS):
        small = small % 100_000 * type_.unit
    return least + (small - least) % (greatest - least + 1)


_MembersOf: TypeAlias = Callable[[str], Iterable[tuple[str, int, ScalarType, bool]]]


class UnknownBlocks:
    """The instances of blocks that a project does not have: their members, and what they keep of their calls.

    The state is in global variables: `globals_` is their layout, `frame` their values. `members_of` gives the members
    of an instance that programs use: name, slot, type, and True if they write it.
    """

    def __init__(
        self, globals_: Layout, frame: Frame, processor: Processor, members_of: _MembersOf, calls: UnknownCalls
    ) -> None:
        self.names: dict[str, None] = {}
        """The functions and types that are called."""
        self._globals = globals_
        self._frame = frame
        self._processor = processor
        self._members_of = members_of
        self._calls = calls
        self._slots: dict[str, int] = {}

    def slot(self, path: str) -> int:
        """Return where the history of an instance is; the time of its last call follows it."""
        key = path.casefold()
        if key not in self._slots:
            fields = [
                self._globals.add(f"(calls of {path})", LINT, hidden=True),
                self._globals.add(f"(last call of {path})", INSTANT, hidden=True),
            ]
            fields[0].initial = "0"
            self._slots[key] = fields[0].slot
        return self._slots[key]

    def owns(self, path: str) -> bool:
        """True if an undeclared path is a member of an instance that is called."""
        key = path.casefold()
        return any(key.startswith(f"{instance}.") for instance in self._slots)

    def __len__(self) -> int:
        return len(self._slots)

    def call(self, name: str, path: str, slot: int, arguments: tuple[Any, ...]) -> Hashable:
        """Call an instance; the situation that its outputs depend on."""
        calls = self._calls
        v, now = self._frame.v, self._processor.now
        members = list(self._members_of(path))
        given = tuple((member, v[at]) for member, at, _, written in members if written)
        last = v[slot + 1]
        situation = calls.called(name, (*arguments, *given), v[slot], None if last is None else now - last)
        v[slot], v[slot + 1] = calls.kept(situation), now if calls.is_exact else None
        for member, at, type_, written in members:
            if not written:
                v[at] = calls.value(f"{name}.{member}", situation, type_)
        return situation

    def value(self, name: str, arguments: Any, type_: ScalarType | OpaqueType, slot: int = -1) -> Any:
        """Return the result of a function, or of a method of the instance whose history is in `slot`."""
        history = self._frame.v[slot] if slot >= 0 else None
        return self._calls.value(name, (arguments, history), type_)
