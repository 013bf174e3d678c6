"""Names visible in a POU, and the translation of the texts in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.languages.binding.name_resolution import preferred
from plcopen_sfc.languages.binding.symbols import Declaration, Kind, Level
from plcopen_sfc.languages.binding.text_sites import Role
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.nodes import Quoting
from plcopen_sfc.model.body import Body
from plcopen_sfc.model.conditions import Condition
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.linking import Writer
from plcopen_sfc.semantics.programs.places import Broken, Place, Unknown
from plcopen_sfc.semantics.programs.types import Direction, Field, Frame, Layout

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.code import Code
    from plcopen_sfc.semantics.programs.expressions import Translator
    from plcopen_sfc.semantics.programs.library import Library
    from plcopen_sfc.semantics.programs.runtime import Processor
    from plcopen_sfc.semantics.programs.units import Unit

_GLOBAL = frozenset(
    {
        Kind.VARIABLE,
        Kind.DATA_BLOCK,
        Kind.INSTANCE,
        Kind.ENUM_VALUE,
        Kind.GLOBAL_LIST,
        Kind.POU,
        Kind.DATA_TYPE,
        Kind.NAMESPACE,
    }
)
_VALUES = frozenset({Kind.VARIABLE, Kind.DATA_BLOCK, Kind.INSTANCE, Kind.ENUM_VALUE})


class Scope:
    """The names that are visible in a POU or method, and where their variables are.

    `layout` are its own variables, in the slots `v` of the frame of a call. A method has an `around`: the scope of its
    POU, whose frame is `this`.
    """

    def __init__(
        self, library: Library, path: str, layout: Layout, *, place: str = "", around: Scope | None = None
    ) -> None:
        self.library = library
        self.path = path
        self.layout = layout
        self.place = place
        self.around = around
        self.unit: Unit | None = around.unit if around is not None else None
        self.aliases: dict[str, Place | Broken] = {}
        self.constants: dict[str, Code] = {}
        """The values of enumerations that are declared in place."""
        self._late: Layout | None = None
        self._late_slot = -1
        self.is_open = True
        """True if slots can still be added: later ones are in a frame of their own."""

    # -- declaring

    @property
    def clock(self) -> Processor:
        """The clock of the controller."""
        return self.library.processor

    def structure(self, name: str, members: Mapping[str, t.Type]) -> t.StructureType:
        """A new type of structure."""
        layout = Layout(name)
        for member, type_ in members.items():
            layout.add(member, type_).initial = self.library.initials.default(type_)
        self.library.initials.link(layout)
        return t.StructureType(name, layout)

    def declare(self, name: str, type_: t.Type, *, hidden: bool = False, direction: Direction = Direction.LOCAL) -> int:
        """A variable that nobody has declared: its slot in `v`. An existing one of the name stays what it is.

        Only while the POU is being declared, that is, in a chart compiler.
        """
        there = self.layout.find(name)
        if there is not None:
            return there.slot
        if not self.is_open:
            raise AssertionError(f"{name} is declared too late")
        made = self.layout.add(name, type_, direction, hidden=hidden)
        made.initial = self.library.initials.default(type_)
        return made.slot

    def lookup(self, name: str) -> Field | None:
        """The variable of this name that the POU has; None if it has none."""
        return self.layout.find(name)

    def helper(self, name: str, type_: t.Type) -> None:
        """A variable that the translation of a network needs, found by its name from now on."""
        if self.layout.find(name) is not None or name.casefold() in self.aliases:
            return
        if self.is_open:
            self.declare(name, type_, hidden=True)
            return
        if self._late is None:
            raise AssertionError("the scope was never closed")
        made = self._late.add(name, type_)
        made.initial = self.library.initials.default(type_)
        made.hidden = True
        cells = f"v[{self._late_slot}].v"
        self.aliases[name.casefold()] = Place(cells, str(made.slot), type_, name, field=made)

    def close(self) -> None:
        """No more slots: frames of other types may count them."""
        if self.is_open:
            self._late = Layout(self.path)
            self._late_slot = self.declare("(helpers)", t.StructureType("helpers", self._late), hidden=True)
            self.is_open = False

    def finish(self) -> None:
        """Nothing more will be translated: write what makes new frames."""
        if self._late is not None and self._late.fields:
            self.library.initials.link(self._late)
        elif self._late is not None:
            unused = self.layout.fields[self._late_slot]
            unused.type, unused.initial = t.OpaqueType("nothing"), "None"
        self.library.initials.link(self.layout)

    # -- names

    def outer(self) -> Iterable[Level]:
        """The levels of global names, the nearest first."""
        return self.library.names.outer(self.place)

    def resolve(self, name: n.Name, *, called: bool = False) -> Any:
        """Meaning of a name on its own: a `Place`, a `Code`, a `Space`, a `Unit`, a type, or `Unknown`."""
        key = name.identifier.casefold()
        if name.quoting is not Quoting.GLOBAL:
            found = self._local(key, "v")
            if found is not None:
                return found
            if self.around is not None:
                found = self.around._local(key, "t")
                if found is not None:
                    return found
        if name.quoting in (Quoting.LOCAL, Quoting.LOCAL_QUOTED):
            return Unknown(name.identifier)
        for level in self.outer():
            declarations = level.named(name.identifier)
            if declarations:
                return self._global(declarations, Role.ACTION if called else Role.VALUE, name.identifier)
        return Unknown(name.identifier)

    def _local(self, key: str, cells: str) -> Place | Code | None:
        alias = self.aliases.get(key)
        if isinstance(alias, Broken):
            raise alias.error
        if alias is not None:
            if cells == "v" or not alias.cells.startswith("v["):
                return alias
            return Place("t" + alias.cells[1:], alias.index, alias.type, alias.path, field=alias.field)
        field = self.layout.by_name.get(key)
        return self.local_place(field, cells) if field is not None else self.constants.get(key)

    def local_place(self, field: Field, cells: str = "v") -> Place:
        """The place of a variable of the POU."""
        key = self.library.key(self.layout, field.slot)
        if field.direction is Direction.IN_OUT and isinstance(field.type, t.ElementaryType | t.ReferenceType):
            pointer = f"{cells}[{field.slot}]"
            self.library.parameters[id(field)] = key
            return Place(f"{pointer}.cells", f"{pointer}.index", field.type, field.name, root=key, field=field)
        own = self.unit is not None and self.around is None
        is_input = own and (field.direction is Direction.INPUT or self.library.is_freed(field))
        if field.direction is Direction.IN_OUT:
            is_input = True
            self.library.references.add(key)
            self.library.parameters[id(field)] = key
        return Place(cells, str(field.slot), field.type, field.name, key, key, field=field, input=is_input)

    def _global(self, declarations: list[Declaration], role: Role, name: str) -> Any:
        known = [d for d in declarations if d.kind in _GLOBAL]
        if not known:
            return Unknown(name)
        chosen = preferred(known, role)
        if len({id(d.holder) for d in chosen}) > 1 and chosen[0].kind in _VALUES:
            near = [d for d in chosen if d.path.casefold() == name.casefold()]
            if len(near) != 1:
                paths = ", ".join(d.path for d in chosen)
                raise SimulationError(f"{name} can be several things: {paths}")
            chosen = near
        return self.library.meaning(chosen[0])

    # -- translating

    def translator(self, writer: Writer) -> Translator:
        """Translator of expressions in this scope."""
        from plcopen_sfc.semantics.programs.expressions import Translator  # noqa: PLC0415  # they need each other

        return Translator(self, writer)

    def constant_integer(self, text: str) -> int:
        """The value of a constant expression. Raises `SimulationError`."""
        parsed = parse_expression(text, self.library.dialect)
        if not parsed.problems:
            code = self.translator(Writer()).value(parsed.tree, t.DINT)
            if code.constant and isinstance(code.value, int):
                return int(code.value)
        raise SimulationError(f"{text!r} is no constant", location=Location(path=self.path))

    def condition(self, condition: Condition, path: str, *, chart: SfcNetwork | None = None) -> Callable[[Frame], bool]:
        """Any condition of the model as a function. It can be called when the controller is linked."""
        from plcopen_sfc.semantics.programs.bodies import Bodies  # noqa: PLC0415  # they need each other

        return Bodies(self).condition(condition, path, chart)

    def expression(
        self, given: str | n.Expression, path: str, expected: t.Type | None = None
    ) -> Callable[[Frame], Any]:
        """An expression, a text or a tree, as a function; its value is of type `expected` where that is given."""
        from plcopen_sfc.semantics.programs.bodies import Bodies  # noqa: PLC0415

        return Bodies(self).expression(given, path, expected)

    def statements(self, text: str, path: str) -> Callable[[Frame], None]:
        """Structured text as a function."""
        from plcopen_sfc.semantics.programs.bodies import Bodies  # noqa: PLC0415

        return Bodies(self).text(text, path)

    def body(self, body: Body, path: str, function: Callable[..., Any] | None = None) -> Callable[[Frame], None]:
        """A body in any language as a function."""
        from plcopen_sfc.semantics.programs.bodies import Bodies  # noqa: PLC0415

        return Bodies(self).body(body, path, function)

    def chart_logic(self, chart: SfcNetwork, path: str) -> Callable[[Frame], None]:
        """Effects of the logic drawn in a chart besides feeding its conditions."""
        from plcopen_sfc.semantics.programs.bodies import Bodies  # noqa: PLC0415

        return Bodies(self).chart_logic(chart, path)

    def action(self, name: str) -> Callable[[Frame], None] | None:
        """The action of this name of the POU, or of one that it extends; None if there is none."""
        return self.unit.action(name) if self.unit is not None else None

    def getter(self, text: str, expected: t.Type | None = None) -> Callable[[Frame], Any]:
        """Reads a variable, of any path. One that nobody declares is an external of type `expected`, else BOOL."""
        return self.expression(text, self.path, expected)

    def setter(self, text: str, type_: t.Type = t.BOOL) -> Callable[[Frame, Any], None]:
        """Writes a variable, of any path. One that nobody declares gets `type_`; values are of the variable's type."""
        from plcopen_sfc.semantics.programs.bodies import Bodies  # noqa: PLC0415

        return Bodies(self).setter(text, type_)

    def type_of(self, text: str) -> t.Type | None:
        """The type of a variable, of any path; None if nobody declares it."""
        parsed = parse_expression(text, self.library.dialect)
        if parsed.problems:
            return None
        found = self.translator(Writer()).meaning(parsed.tree)
        return found.type if isinstance(found, Place) else None
