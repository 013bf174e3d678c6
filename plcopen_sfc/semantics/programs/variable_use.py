"""Variables that the texts of a controller read, write and pass on, and which of them get their values from outside."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator
from itertools import product
from typing import TypeGuard

from plcopen_sfc.model.chart_settings import OPERATING_FLAGS, SfcFlag
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.code_generation import Linker
from plcopen_sfc.semantics.programs.places import ANYWHERE
from plcopen_sfc.semantics.programs.runtime_types import MOST_ELEMENTS, Direction, Field, Layout

ALL_FREE = "all"
"""Stands for all variables that could be inputs."""

_INDICES = re.compile(r"\[[^\]]*\]")
_FLAGS = frozenset(flag.variable.casefold() for flag in SfcFlag)
_SHOWING = _FLAGS - {flag.variable.casefold() for flag in OPERATING_FLAGS}
"""Flags that are no inputs: charts write them, but for SFCEnableLimit, which keeps its first value."""


class VariableUse:
    """Reads and writes of variables, noted by their keys while texts are translated (see `Place.key`).

    `globals_` are the global variables. Where `asks`, free inputs are asked for when a scan reads them. `owned` is True
    of an undeclared path that is a member of an unknown block, which gives it its value.
    """

    def __init__(
        self,
        linker: Linker,
        globals_: Layout,
        *,
        asks: bool,
        owned: Callable[[str], bool],
        free_inputs: Iterable[str],
        not_free: Iterable[str],
    ) -> None:
        self._linker = linker
        self._globals = globals_
        self._asks = asks
        self._owned = owned
        self._freed = frozenset(name.casefold() for name in free_inputs)
        self._not_free = _SHOWING | {name.casefold() for name in not_free}
        self.written: set[str] = set()
        self.inputs: dict[str, tuple[str, t.Type]] = {}
        """Variables that are read and may be given from outside, by key: path and type; see `given`."""
        self.read: dict[str, tuple[str, t.Type]] = {}
        """Variables that are read besides inputs."""
        self.numbers: dict[int, None] = {}
        """The integers in the texts: what values of inputs may be compared with."""
        self.masks: dict[int, None] = {}
        """Bits of integers that are looked at: one that is read, or the constant of an AND, OR or XOR."""
        self.shifts: dict[int, None] = {}
        """By how many bits integers are shifted, and where parts of them begin; 0 where a remainder is taken."""
        self.passed: dict[str, dict[int, Field]] = {}
        """The VAR_IN_OUT that variables are passed to, by the keys of these."""
        self.parameters: dict[int, str] = {}
        """The keys of VAR_IN_OUT that a text uses."""
        self.pointed: set[str] = set()
        """The keys of what references lead to."""
        self.references: set[str] = set()
        """The keys of VAR_IN_OUT: what they refer to may be a free input."""
        self.in_outs: set[str] = set()
        """The keys of the variables that VAR_IN_OUT of what runs refer to."""
        self.roots: set[Layout] = set()
        """The layouts of the outermost instances."""
        self._asking: set[str] = set()

    @property
    def version(self) -> Hashable:
        """A value that changes when `is_free` may have changed; None where nothing is ever free."""
        return (self.writers, len(self.inputs), len(self.roots)) if self._asks else None

    @property
    def writers(self) -> Hashable:
        """A value that changes when `is_written` may have changed."""
        return len(self.written), sum(map(len, self.passed.values())) + len(self.pointed)

    # -- keys

    def key(self, layout: Layout, slot: int) -> str:
        """Return the key of a variable of a POU, the same in all that extend it."""
        return f"{self._linker.name(layout.owner(slot), 'l')}.{slot}"

    def is_key_of(self, layout: Layout, key: str) -> bool:
        """True if a key is that of a variable of a POU, or of a part of one."""
        start, slot = key.split(".")[:2]
        return start != "g" and int(slot) < len(layout.fields) and self.key(layout, int(slot)) == f"{start}.{slot}"

    def _is_root(self, key: str) -> bool:
        return key.startswith("g.") or any(self.is_key_of(layout, key) for layout in self.roots)

    def _field(self, key: str) -> Field:
        """Return the variable that the thing of a key is, or is a part of."""
        start, slot = key.split(".")[:2]
        layout = self._globals if start == "g" else self._linker.namespace[start]
        field: Field = layout.fields[int(slot)]
        return field

    # -- inputs

    def is_free(self, key: str) -> bool:
        """True if the variable of this key, or a part of it, is asked for."""
        if not self._asks:
            return False
        return key == ANYWHERE or ".".join(key.split(".")[:2]) in self.references or self._may_be_given(key)

    def _may_be_given(self, key: str) -> bool:
        """True if a variable is one of the surroundings: VAR_INPUT and VAR_IN_OUT, and others that nothing writes."""
        if key not in self.inputs or self._owned(self.inputs[key][0]):
            return False
        if self._is_given_inside(key):
            return True
        if not self._is_passed(key) and not (self._is_root(key) and not self.is_written(key)):
            return False
        return not _is_instance(self._field(key).type) or self._is_wanted(*self.inputs[key])

    def _is_wanted(self, path: str, type_: t.Type) -> bool:
        """True for a value of an instance that nothing calls which the user wants as an input."""
        first = path.partition(".")[0]
        return _is_value(type_) and not self._freed.isdisjoint((ALL_FREE, path.casefold(), first.casefold()))

    def _is_given_inside(self, key: str) -> bool:
        """True for a variable at an input address of a block: each instance has one, which its calls do not write."""
        start, *slots = key.split(".")
        layout, field = self._globals if start == "g" else self._linker.namespace[start], None
        for slot in slots:
            if layout is None:
                return False
            field = layout.fields[int(slot)]
            layout = field.type.layout if isinstance(field.type, t.StructureType) else None
        is_inside = len(slots) > 1 or not self._is_root(key)
        return is_inside and field is not None and field.given and key not in self.written

    def _is_named(self, key: str) -> bool:
        """True for a variable that is named as an input, and for a part of one."""
        if not self._freed or key not in self.inputs:
            return False
        parts = _INDICES.sub("", self.inputs[key][0]).casefold().split(".")
        return any(".".join(parts[:end]) in self._freed for end in range(1, len(parts) + 1))

    def _is_passed(self, key: str) -> bool:
        """True for parameters of what runs: each call gives them a value, whatever the call before has written.

        So it is with variables that are named as inputs: something else writes them as well.
        """
        field = self._field(key)
        given = field.direction in (Direction.INPUT, Direction.IN_OUT) or self._is_named(key)
        if not given or not self._is_root(key):
            return key in self.in_outs
        type_ = field.type
        for slot in key.split(".")[2:]:
            if isinstance(type_, t.StructureType):
                if type_.layout.is_instance:
                    return False  # what it does is known
                type_ = type_.layout.fields[int(slot)].type
            elif isinstance(type_, t.ArrayOf):
                type_ = type_.base
        return not (isinstance(type_, t.StructureType) and type_.layout.is_instance)

    def given(self) -> Iterator[tuple[str, str, t.ScalarType]]:
        """Yield variables with values from outside: single variables, members and elements, by key, with path and type.

        Each input of what runs that is read, and other variables that nothing writes and whose declaration gives no
        value. The one place that decides it: for proofs, for directed runs, and for simulation.
        """
        return ((key, path, type_) for key, path, type_ in self._parts_given() if _is_value(type_))

    def not_given(self) -> list[str]:
        """The paths of inputs that are read and keep their values: large arrays, references, what these lead to."""
        found = [path for _, path, type_ in self._parts_given() if not _is_value(type_)]
        pointed = [
            key for key in self.pointed if key in self.inputs and not self._is_passed(key) and self._is_root(key)
        ]
        return found + sorted(self.inputs[key][0] for key in pointed if key not in self.written)

    def _parts_given(self) -> Iterator[tuple[str, str, t.Type]]:
        seen: set[str] = set()
        around = [(self.key(layout, slot), field) for layout in self.roots for slot, field in enumerate(layout.fields)]
        around += [(f"g.{slot}", field) for slot, field in enumerate(self._globals.fields)]
        for key, field in around:
            yield from self._given_inside(key, field.name, field.type, seen)
        for key, (path, type_) in list(self.inputs.items()):
            if not self._may_be_given(key) or self._is_given_inside(key):
                continue
            for inner, name, part in _parts(key, path, type_):
                if inner not in seen and (self._is_passed(inner) or not self.is_written(inner)):
                    seen.add(inner)
                    yield inner, name, part

    def _given_inside(self, key: str, path: str, type_: t.Type, seen: set[str]) -> Iterator[tuple[str, str, t.Type]]:
        """Yield the variables at input addresses of an instance, and of those in it, as far as it is read."""
        if not isinstance(type_, t.StructureType) or not type_.layout.is_instance or type_.layout in self.roots:
            return
        for slot, field in enumerate(type_.layout.fields):
            inner, name, own = f"{key}.{slot}", f"{path}.{field.name}", self.key(type_.layout, slot)
            if field.given and (own in self.inputs or inner in self.inputs):
                if not self.written.intersection((inner, own)):
                    parts = [each for each in _parts(inner, name, field.type) if each[0] not in seen]
                    seen.update(part for part, _, _ in parts)
                    yield from parts
            elif not field.hidden:
                yield from self._given_inside(inner, name, field.type, seen)

    def is_freed(self, field: Field) -> bool:
        """True for a variable at an input address, and for one that the user wants as an input.

        Outputs of an instance may be wanted: what nothing calls is as what nothing writes.
        """
        is_instance = _is_instance(field.type)
        if not field.declared or not (is_instance or is_plain(field.type)):
            return False
        if field.given:
            return not is_instance
        if field.direction not in (Direction.LOCAL, Direction.EXTERNAL) or field.name.casefold() in self._not_free:
            return False
        name = field.name.casefold()
        inside = any(each.startswith(f"{name}.") for each in self._freed)
        return inside or ALL_FREE in self._freed or name in self._freed

    def frozen(self) -> Iterator[str]:
        """Yield the paths of declared variables that are read, that nothing writes, and that are no inputs.

        Values of instances that nothing calls are among them: other code of the POU may call these.
        """
        for key, (path, type_) in self.read.items():
            field = self._field(key)
            is_part = _is_instance(field.type) and _is_value(type_)
            plain = field.declared and field.name.casefold() not in _FLAGS and (is_part or is_plain(field.type))
            known = field.direction in (Direction.LOCAL, Direction.EXTERNAL)
            if plain and known and self._is_root(key) and not self.is_written(key):
                root = ".".join(key.split(".")[:2])
                yield path if is_part or self.is_written_inside(root) else field.name

    # -- writes

    def is_written_inside(self, key: str) -> bool:
        """True if anything writes a variable, a part of it, or what it is a part of."""
        inner = f"{key}."
        if self.is_written(key) or any(each.startswith(inner) for each in (*self.written, *self.pointed)):
            return True
        return any(self._is_passed_on(each) for each in self.passed if each.startswith(inner))

    def is_written(self, key: str) -> bool:
        """True if anything writes a variable, or what it is a part of."""
        parts = key.split(".")
        around = [".".join(parts[:end]) for end in range(1, len(parts) + 1)]
        return any(each in self.written or each in self.pointed or self._is_passed_on(each) for each in around)

    def _is_passed_on(self, key: str) -> bool:
        """True if a variable is passed to a VAR_IN_OUT that is written."""
        if key in self._asking:  # functions may call themselves
            return False
        self._asking.add(key)
        try:
            inner = [
                self.parameters[id(field)]
                for field in self.passed.get(key, {}).values()
                if id(field) in self.parameters
            ]
            return any(map(self.is_written_inside, inner))
        finally:
            self._asking.discard(key)


def is_plain(type_: t.Type) -> bool:
    """True for single values, and for structures and arrays of them."""
    if isinstance(type_, t.StructureType):
        return not type_.layout.is_instance and all(is_plain(field.type) for field in type_.layout.fields)
    return is_plain(type_.base) if isinstance(type_, t.ArrayOf) else isinstance(type_, t.ScalarType)


def _is_instance(type_: t.Type) -> bool:
    return isinstance(type_, t.StructureType) and type_.layout.is_instance


def _is_value(type_: t.Type) -> TypeGuard[t.ScalarType]:
    return isinstance(type_, t.ScalarType) and type_.family is not t.Family.SPECIAL


def _parts(key: str, path: str, type_: t.Type) -> Iterator[tuple[str, str, t.Type]]:
    """Yield the single values in a variable, and what of it has none, or too many: key, path and type."""
    if isinstance(type_, t.StructureType) and not type_.layout.is_instance:
        for field in type_.layout.fields:
            yield from _parts(f"{key}.{field.slot}", f"{path}.{field.name}", field.type)
    elif isinstance(type_, t.ArrayOf) and type_.size > 0 and type_.whole_size <= MOST_ELEMENTS:
        indices = product(*(range(lower, upper + 1) for lower, upper in type_.dimensions))
        for slot, index in enumerate(indices):
            yield from _parts(f"{key}.{slot}", f"{path}[{','.join(map(str, index))}]", type_.base)
    else:
        yield key, path, type_
