"""Meanings of names and paths in a scope, and what reads and writes the variables that they mean."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.declarations.kept_texts import properties_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.code_generation import Writer
from plcopen_sfc.semantics.programs.places import Place, Space, Unknown
from plcopen_sfc.semantics.programs.runtime_types import Direction
from plcopen_sfc.semantics.programs.scopes import Scope, TranslatedPou
from plcopen_sfc.semantics.programs.value_code import Code, constant, ranged, settled, wrapping

_PART = re.compile(r"%?(?P<size>[XBWD]?)(?P<number>\d+)", re.IGNORECASE)
_PART_WIDTHS = {"": 1, "X": 1, "B": 8, "W": 16, "D": 32}
_LIBRARIES = frozenset({"standard", "tc2_standard", "tc2_system", "util", "standard64"})
"""Names before a dot that mean a library of the tool."""


class PathTranslator(ABC):
    """Translates names and paths of a scope. `writer` gives names of temporary variables.

    An index may be any expression: `value` of those is what `Translator` adds.
    """

    def __init__(self, scope: Scope, writer: Writer) -> None:
        self.scope = scope
        self.library = scope.library
        self.writer = writer
        self.fitted = self.library.converter.fitted
        self._held: dict[str, Code] = {}
        self.instances: Mapping[str, str] = {}
        """The types of instances by their names in lower case, where a network tells what is called on them."""
        self.comparisons = 0
        """Number of comparisons of anything but Booleans that it has translated."""

    @abstractmethod
    def value(self, node: n.Expression, expected: t.Type | None = None) -> Code:
        """Return the value of an expression.

        `expected` is the type of undeclared variables, and of literals without a type of their own.
        """

    # -- what names and paths mean

    def meaning(self, node: n.Expression, expected: t.Type | None = None, *, called: bool = False) -> Any:
        """Meaning of a name or a path; see `Scope.resolve`."""
        match node:
            case n.Parenthesized(inner=inner):
                return self.meaning(inner, expected, called=called)
            case n.Name():
                return self._name(node, expected, called=called)
            case n.Address(text=text):
                return self.library.at_address(text, None, text, None)
            case n.Member(base=base, name=name):
                return self._member(self.meaning(base), name, node)
            case n.Index(base=base, indices=indices):
                return self._index(self.meaning(base), indices)
            case n.Dereference(base=base):
                return self._dereference(base)
            case n.Peripheral(base=base):
                return self.meaning(base, expected)
            case n.Call():
                code = self.value(node)
                if isinstance(code.type, t.StructureType | t.ArrayOf):
                    return Place(f"[{code.text}]", "0", code.type, print_node(node.callee), acts=True)
                return code
        return self.value(node, expected)

    def _name(self, node: n.Name, expected: t.Type | None, *, called: bool) -> Any:
        if node.identifier in self._held:
            return self._held[node.identifier]
        word = node.identifier.upper()
        found = self.scope.resolve(node, called=called)
        own = word in ("THIS", "SUPER") and self.library.dialect is not Dialect.SCL
        if own and isinstance(found, Unknown) and self.scope.unit is not None:
            return self._own(word, self.scope.unit)
        if isinstance(found, Unknown) and isinstance(expected, t.ScalarType):
            value = expected.names.get(node.identifier.casefold())
            if value is not None:
                return constant(value, expected)
        if isinstance(found, Unknown):
            known = self.library.implicit_type(found.path)
            if isinstance(known, t.StructureType):  # an instance of which a drawing tells the type
                return self.library.implicit(found.path, known)
        return found

    def _own(self, word: str, unit: TranslatedPou) -> Place:
        owner = unit if word == "THIS" else unit.base
        if owner is None:
            raise SimulationError(f"{unit.pou.name} extends nothing")
        frame = "this" if self.scope.around is not None else "f"
        type_ = t.StructureType(owner.pou.name, owner.layout)
        return Place(f"[{frame}]", "0", type_, word)

    def _dereference(self, base: n.Expression) -> Any:
        name = n.bare(base)
        if isinstance(name, n.Name) and name.identifier.upper() in ("THIS", "SUPER"):
            return self.meaning(base)
        code = self.value(base, t.ReferenceType("reference", t.ANY))
        if not isinstance(code.type, t.ReferenceType):
            raise SimulationError(f"{print_node(base)} is no reference")
        return self._pointed(code, code.type.base, print_node(base))

    def _pointed(self, code: Code, type_: t.Type, path: str) -> Place:
        # a place is `cells[index]` in code: the first half evaluates the pointer, which may be a call, once for both
        held = self.writer.temporary()
        return Place(f"({held} := {code.text}).cells", f"{held}.index", type_, f"{path}^", acts=code.acts)

    def _member(self, base: Any, name: n.Name, node: n.Member) -> Any:
        if isinstance(base, Unknown):
            if base.path.casefold() in _LIBRARIES:
                return Unknown(name.identifier)
            return Unknown(f"{base.path}.{name.identifier}")
        if isinstance(base, Space):
            found = base.level.named(name.identifier)
            return self.library.meaning(found[0]) if found else Unknown(f"{base.path}.{name.identifier}")
        if isinstance(base, t.ScalarType) and base.names:
            value = base.names.get(name.identifier.casefold())
            if value is None:
                raise SimulationError(f"{base.name} has no value {name.identifier}")
            return constant(value, base)
        if isinstance(base, TranslatedPou):
            if not base.is_program:
                raise SimulationError(f"{base.pou.name} is a type: only an instance of it has {name.identifier}")
            place, field = self.library.program(base), base.layout.find(name.identifier)
            if field is not None and base.layout in self.library.use.roots:  # its own texts name it without the program
                return base.scope.local_place(field, f"{place.text}.v")
            base = place
        if isinstance(base, Place):
            return self._member_of(self.followed(base, None), name, node)
        raise SimulationError(f"{print_node(node.base)} has no member {name.identifier}")

    def _member_of(self, base: Place, name: n.Name, node: n.Member) -> Any:
        type_ = base.type
        if isinstance(type_, t.StructureType):
            field = type_.layout.find(name.identifier)
            if field is not None:
                cells = f"{base.text}.v"
                if field.direction is Direction.IN_OUT and isinstance(field.type, t.ScalarType):
                    pointer = f"{cells}[{field.slot}]"
                    return Place(f"{pointer}.cells", f"{pointer}.index", field.type, f"{base.path}.{name.identifier}")
                return base.inner(cells, field.slot, field.type, name.identifier, field)
            unit = self.library.unit_of_layout(type_.layout)
            alias = unit.scope.aliases.get(name.identifier.casefold()) if unit is not None else None
            if isinstance(alias, Place) and alias.root.startswith("g"):
                return alias
            properties = properties_of(unit.pou) if unit is not None else ()
            if name.identifier.casefold() in {each.casefold() for each, _ in properties}:
                hint = "Write it as a method: a call of that is executed, in other tools too."
                why = f"{name.identifier} is a property of {type_.name}, whose code is not executed here"
                raise SimulationError(why, hint=hint)
            raise SimulationError(f"{base.path} of type {type_.name} has no {name.identifier}")
        if isinstance(type_, t.OpaqueType):
            owner = f"{self.scope.path}." if base.key and not base.key.startswith("g") else ""
            return Unknown(f"{owner}{base.path}.{name.identifier}")
        if isinstance(type_, t.ReferenceType):
            raise SimulationError(f"{base.path} is a reference: {base.path}^.{name.identifier} is its member")
        part = _PART.fullmatch(name.identifier)
        if part is None and self.library.is_codesys and isinstance(self.meaning(name), Place | Code):
            bit = self.value(name, t.DINT)  # CODESYS help, "Bit access in variables": a constant may name the bit
            part = _PART.fullmatch(str(bit.value)) if bit.constant else None
        if isinstance(type_, t.ScalarType) and type_.is_ranged and part is not None and base.bits is None:
            return self._part(base, type_, part)
        raise SimulationError(f"{print_node(node.base)} is a {type_.name}: it has no {name.identifier}")

    def _part(self, base: Place, word: t.ScalarType, part: re.Match[str]) -> Place:
        """Return a bit or another part of an integer (ed. 3, 6.5.2: ``.3``; ``.%X3``, ``.%B1``)."""
        width = _PART_WIDTHS[part["size"].upper()]
        start = int(part["number"]) * width
        self.library.use.shifts.setdefault(start)
        self.library.use.masks.setdefault(((1 << width) - 1) << start)
        if start + width > word.bits:
            raise SimulationError(f"{base.path} has {word.bits} bits, and no {part[0]}")
        type_ = t.BOOL if width == 1 else t.ELEMENTARY[{8: "BYTE", 16: "WORD", 32: "DWORD"}[width]]
        return Place(
            *(base.cells, base.index, type_, f"{base.path}.{part[0]}", "", base.root, (start, width), word),
            input=base.input,
            acts=base.acts,
            whole=base.known,
        )

    def _index(self, base: Any, indices: tuple[n.Expression, ...]) -> Any:
        codes = [settled(self.value(index, t.DINT)) for index in indices]
        if isinstance(base, Unknown):
            if all(code.constant for code in codes):
                return Unknown(f"{base.path}[{', '.join(str(code.value) for code in codes)}]")
            raise SimulationError(f"{base.path} is not declared, so its elements are not known")
        if not isinstance(base, Place):
            raise SimulationError("what has an index here is no array")
        base = self.followed(base, None)
        if isinstance(base.type, t.OpaqueType):
            return self._index(Unknown(f"{self.scope.path}.{base.path}"), indices)
        if isinstance(base.type, t.ScalarType) and base.type.family is t.Family.STRING and len(codes) == 1:
            return self._character(base, base.type, codes[0])
        if not isinstance(base.type, t.ArrayOf):
            raise SimulationError(f"{base.path} is a {base.type.name}, no array")
        return self._element(base, base.type, codes)

    def _character(self, base: Place, string: t.ScalarType, index: Code) -> Code:
        """Return a character of a string: in S7 one, counted from 1; in CODESYS its code, counted from 0.

        To read only.
        """
        self.note_read(base)
        if self.library.is_codesys:
            type_ = t.ELEMENTARY["BYTE" if string.bits == 8 else "WORD"]
            text = f"code_at({base.value}, {index.text}, {string.length})"
        else:
            type_ = t.ELEMENTARY["CHAR" if string.bits == 8 else "WCHAR"]
            text = f"character_at({base.value}, {index.text}, {string.length})"
        return ranged(text, type_, acts=index.acts)

    def _element(self, base: Place, array: t.ArrayOf, codes: list[Code]) -> Place:
        if not array.dimensions:
            indices = ", ".join(code.text for code in codes)
            acts = base.acts or any(code.acts for code in codes)
            path = f"{base.path}[?]"
            return Place(f"{base.text}.cells", f"{base.text}.at({indices})", array.base, path, "", base.root, acts=acts)
        if len(codes) < len(array.dimensions):
            raise SimulationError(f"{base.path} has {len(array.dimensions)} dimensions, but {len(codes)} indices")
        used, rest = codes[: len(array.dimensions)], codes[len(array.dimensions) :]
        offset, known, text = 0, True, ""
        for code, (lower, upper) in zip(used, array.dimensions, strict=True):
            if not isinstance(code.type, t.ScalarType) or code.type.family not in (
                t.Family.INTEGER,
                t.Family.BITS,
                t.Family.SPECIAL,
            ):
                raise SimulationError(f"an index is a {code.type.name}")
            size = upper - lower + 1
            if code.constant:
                if not lower <= code.value <= upper:
                    raise SimulationError(f"the index {code.value} is outside of {lower}..{upper}")
                step = str(code.value - lower)
            else:
                known = False
                step = self._checked(code, lower, upper)
            offset = offset * size + (code.value - lower if code.constant else 0)
            text = f"({text}) * {size} + {step}" if text else step
        # Only an element with constant indices has a key of its own. A write to any other may be to each element, so
        # these are followed as a whole.
        key = f"{base.key}.{offset}" if known and base.key else ""
        place = Place(
            base.text,
            str(offset) if known else text,
            array.base,
            f"{base.path}[{','.join(str(c.value) if c.constant else '?' for c in used)}]",
            key,
            key or base.root,
            input=base.input,
            field=base.field,
            acts=base.acts,
            whole=None if key else base.known,
        )
        if not rest:
            return place
        if not isinstance(array.base, t.ArrayOf):
            raise SimulationError(f"{base.path} has {len(array.dimensions)} dimensions, but {len(codes)} indices")
        return self._element(place, array.base, rest)

    def _checked(self, code: Code, lower: int, upper: int) -> str:
        # no check where the values that the index can have are known (they are not where `low` is `high`) and inside
        if lower <= code.low and code.high <= upper and code.low < code.high:
            return f"{code.text} - {lower}" if lower else code.text
        held = self.writer.temporary()
        inside = f"{held} - {lower}" if lower else held
        return (
            f"({inside} if {lower} <= ({held} := {code.text}) <= {upper} else out_of_bounds({held}, {lower}, {upper}))"
        )

    # -- variables

    def read(self, meaning: Any, node: n.Expression, expected: t.Type | None) -> Code:
        """Return the value of what a name or path means."""
        if isinstance(meaning, Code):
            return meaning
        if isinstance(meaning, Unknown):
            meaning = self.implicit(meaning, expected)
        if isinstance(meaning, Place):
            return self._read_place(self.followed(meaning, expected))
        raise SimulationError(f"{print_node(node)} is no value")

    def _read_place(self, place: Place) -> Code:
        self.note_read(place)
        return place.read()

    def note_read(self, place: Place) -> None:
        """Remember that something reads a variable."""
        known = place.known
        if known is not None and known.field is not None:
            (self.library.use.inputs if known.input else self.library.use.read).setdefault(
                known.key, (known.path, known.type)
            )

    def followed(self, place: Place, expected: t.Type | None) -> Place:
        """Return the target of a reference of CODESYS, or the reference where one is expected."""
        if isinstance(place.type, t.ReferenceType) and place.type.automatic:
            if isinstance(expected, t.ReferenceType):
                return place
            return self._pointed(place.read(), place.type.base, place.path)
        return place

    def implicit(self, unknown: Unknown, expected: t.Type | None) -> Place:
        """Return the external variable of an undeclared name."""
        told = isinstance(expected, t.ScalarType) and expected is not t.ANY
        type_ = expected if told else self.library.implicit_type(unknown.path)
        if type_ is None:
            self.library.assumed.add(unknown.path.casefold())
        return self.library.implicit(unknown.path, type_ or t.BOOL)

    def hold(self, code: Code) -> n.Name:
        """Return a name that means a value in this translation."""
        name = f"(value {len(self._held) + 1})"
        self._held[name] = code
        return n.Name(name)

    def guessed(self, value: n.Expression) -> t.Type:
        """Return the type of an undeclared variable, from what is assigned to it."""
        code = self.value(value)
        if isinstance(code.type, t.ScalarType) and code.loose and code.type.family is t.Family.INTEGER:
            return t.DINT if code.type in (t.INT, t.DINT) else t.LINT
        return code.type

    def place(self, node: n.Expression, expected: t.Type | None = None) -> Place:
        """Return the variable that an expression names. Raises `SimulationError` if it names none."""
        meaning = self.meaning(node, expected)
        if isinstance(meaning, Unknown):
            meaning = self.implicit(meaning, expected)
        if isinstance(meaning, TranslatedPou) and self.scope.layout is meaning.layout and meaning.result is not None:
            return self.scope.local_place(meaning.result)
        if not isinstance(meaning, Place):
            raise SimulationError(f"{print_node(node)} is no variable")
        return self.followed(meaning, expected)

    def write(self, place: Place, code: Code) -> None:
        """Write the statement that gives a variable a value of its type."""
        if place.bits is not None and place.word is not None:
            start, width = place.bits
            changed = "bit_set" if width == 1 else "bits_set"
            more = f"{start}, " if width == 1 else f"{start}, {width}, "
            cells, index = self.writer.temporary(), self.writer.temporary()
            self.writer.write(f"{cells} = {place.cells}; {index} = {place.index}")
            whole = replace(place, cells=cells, index=index, type=place.word, bits=None)
            text = f"{changed}({whole.value}, {more}{code.text})"
            if place.word.least < 0:
                text = wrapping(text, place.word)
            self.writer.write(f"{cells}[{index}] = {text}")
        elif isinstance(place.type, t.StructureType | t.ArrayOf):
            self.writer.write(f"assign({place.text}, {code.text})")
        else:
            self.writer.write(f"{place.text} = {code.text}")

    def note_pointed(self, place: Place) -> None:
        """Remember that a reference leads to a variable: it may be read and written by that."""
        self.note_read(place)
        self.library.use.pointed.add(place.root)

    def note_write(self, place: Place) -> None:
        """Remember that something gives a variable its value."""
        if place.field is not None and place.field.direction is Direction.CONSTANT and place.bits is None:
            raise SimulationError(f"{place.path} is a constant")
        self.library.use.written.add(place.root)
