"""A project while it is translated: what all its texts share, the names visible in a POU, and the POUs themselves."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from typing import Any, Protocol, TypedDict

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.languages.binding.name_resolution import preferred
from plcopen_sfc.languages.binding.name_scopes import Scopes
from plcopen_sfc.languages.binding.symbols import Level
from plcopen_sfc.languages.binding.text_sites import Role
from plcopen_sfc.languages.method_calls import called_at_start
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Quoting
from plcopen_sfc.model import types as m
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Method, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.text import local_name
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.block_execution import BlockType, BlockTypes
from plcopen_sfc.semantics.programs.code_generation import Linker, Writer
from plcopen_sfc.semantics.programs.marks import Marks
from plcopen_sfc.semantics.programs.places import Broken, Place, Unknown
from plcopen_sfc.semantics.programs.runtime import Processor
from plcopen_sfc.semantics.programs.runtime_types import Direction, Field, Frame, Layout
from plcopen_sfc.semantics.programs.unknown_calls import UnknownBlocks, UnknownCalls
from plcopen_sfc.semantics.programs.value_code import Code, Converter
from plcopen_sfc.semantics.programs.variable_use import VariableUse

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


class RunOptions(TypedDict, total=False):
    """Options of a run of a project; see `Controller`."""

    functions: Mapping[str, Callable[..., Any]] | None
    chart_compiler: ChartCompiler | None
    read_input: Callable[[str], Any] | None
    free_inputs: Iterable[str]
    not_free: Iterable[str]
    marking: bool
    unknown_calls: UnknownCalls | None
    known_types: Mapping[str, t.Type] | None


class TranslatedProject(ABC):
    """Tables that the translations of all texts of a project share.

    The abstract methods give declarations a meaning, which needs translated constants; `Library` has them. `at_address`
    returns the variable at a direct address, `read_type` the type as it is seen in a scope, `named_type` that of a name
    (of the project, a standard block, an elementary one; else an opaque one). `give_initial` gives a variable the value
    of its declaration, or that of its type.
    """

    at_address: Callable[[str, t.ScalarType | None, str, m.Value | None], Place]
    read_type: Callable[[m.DataType, Scope], t.Type]
    named_type: Callable[[str, Scope], t.Type]
    give_initial: Callable[[Field, m.Value | None, Scope], None]

    def __init__(self, project: Project, profile: Profile, options: RunOptions) -> None:
        self.project = project
        self.profile = profile
        """For charts: how they are executed. The controller sets it."""
        self.dialect = project.dialect
        self.is_codesys = self.dialect in (Dialect.CODESYS, Dialect.TWINCAT)
        self.functions = {name.casefold(): each for name, each in (options.get("functions") or {}).items()}
        self.names = Scopes(project)
        self.processor = Processor()
        self.linker = Linker()
        self.converter = Converter(self.dialect, self.linker, in_seconds=profile.matiec_library)
        self.blocks = BlockTypes(self.dialect, self.processor, of_matiec=profile.matiec_library)
        self.globals = Layout("global variables")
        self.frame = Frame(self.globals, [])
        self.undeclared: dict[str, t.Type] = {}
        self.assumed: set[str] = set()
        """Undeclared paths, in lower case, that are BOOL because their first use tells no type."""
        self.known_types: Mapping[str, t.Type] = options.get("known_types") or {}
        """Types of undeclared paths, in lower case, that are known from elsewhere."""
        self.missing: dict[str, str] = {}
        self.problems: list[SimulationError] = []
        self.marks = Marks() if options.get("marking") else None
        self.implicits: dict[str, Place] = {}
        """External variables that the project does not declare, by their paths in lower case."""
        self._members: dict[str, list[tuple[str, int, t.ScalarType, bool]]] = {}
        self._known_members: Hashable = None
        self.is_complete = False
        """True while no external variable may be added: the frame of a running program has its size."""
        self.units: dict[int, TranslatedPou] = {}
        """The POUs that were needed so far, by the identity of their models."""
        self.unknown: UnknownBlocks | None = None
        unknown_calls = options.get("unknown_calls")
        if unknown_calls is not None:
            self.unknown = UnknownBlocks(self.globals, self.frame, self.processor, self._members_of, unknown_calls)
        self.use = VariableUse(
            self.linker,
            self.globals,
            asks=options.get("read_input") is not None,
            owned=self.unknown.owns if self.unknown is not None else lambda _: False,
            free_inputs=options.get("free_inputs", ()),
            not_free=options.get("not_free", ()),
        )
        self.scope = Scope(self, "", self.globals)
        """The scope of the global variables."""
        self._dispatching: dict[str, Callable[..., Frame]] = {}
        self._news: dict[Layout, Callable[..., Any]] = {}

    # -- meanings of declarations

    @abstractmethod
    def meaning(self, declaration: Declaration) -> Any:
        """Return the meaning of a global declaration: a `Place`, a `Code`, a `Space`, a `TranslatedPou` or a type."""

    @abstractmethod
    def variable(self, declaration: Declaration) -> Place:
        """Return the place of a global variable, a tag, a data block or a program instance."""

    @abstractmethod
    def implicit(self, path: str, type_: t.Type) -> Place:
        """Return the external variable for a path that the project does not declare."""

    @abstractmethod
    def program(self, unit: TranslatedPou) -> Place:
        """Return the only instance of a program."""

    @abstractmethod
    def unit(self, pou: Pou) -> TranslatedPou:
        """Return a POU, declared and waiting to be translated."""

    def implicit_type(self, path: str) -> t.Type | None:
        """Return the type of an implicit external variable, if it is known already."""
        found = self.implicits.get(path.casefold())
        return found.type if found is not None else self.known_types.get(path.casefold())

    def _members_of(self, path: str) -> Sequence[tuple[str, int, t.ScalarType, bool]]:
        """Return the members that programs use of an unknown instance: name, slot, type, and True if they write it."""
        known = len(self.implicits), self.use.writers
        if known != self._known_members:  # each call in each scan asks
            self._known_members = known
            self._members.clear()
        start = f"{path.casefold()}."
        if start not in self._members:
            self._members[start] = [
                (key.removeprefix(start), place.field.slot, place.type, self.use.is_written(place.key))
                for key, place in sorted(self.implicits.items())
                if key.startswith(start) and isinstance(place.type, t.ScalarType) and place.field is not None
            ]
        return self._members[start]

    # -- POUs

    def unit_of_layout(self, layout: Layout) -> TranslatedPou | None:
        """Return the POU whose variables a layout has."""
        return next((unit for unit in self.units.values() if unit.layout is layout), None)

    def block_of(self, layout: Layout) -> BlockType | None:
        """Return the standard function block whose variables a layout has."""
        return self.blocks.of_layout(layout)

    def is_overridden(self, method: TranslatedMethod) -> bool:
        """True if a POU that extends the one of a method has another one of its name."""
        key, owner = method.name.casefold(), method.pou
        others = (
            pou for pou in self.project.pous if pou is not owner and any(m.name.casefold() == key for m in pou.methods)
        )
        return any(self._extends(pou, owner) for pou in others)

    def _extends(self, pou: Pou, owner: Pou) -> bool:
        seen: list[Pou] = []
        base = self.names.base(pou)
        while base is not None and base is not owner and base not in seen:
            seen.append(base)
            base = self.names.base(base)
        return base is owner

    def dispatching(self, name: str) -> Callable[..., Frame]:
        """Return a function that enters the method of this name that the POU of a frame has."""
        found = self._dispatching.get(name.casefold())
        if found is None:
            known: dict[Layout, Callable[..., Frame]] = {}

            def enter(frame: Frame, *arguments: Any) -> Frame:
                if frame.layout not in known:
                    unit = self.unit_of_layout(frame.layout)
                    method = unit.method(name) if unit is not None else None
                    assert method is not None  # noqa: S101  # what is derived has it
                    known[frame.layout] = method.enter
                return known[frame.layout](frame, *arguments)

            found = self._dispatching[name.casefold()] = enter
        return found

    # -- new frames

    def default(self, type_: t.Type) -> str:
        """Return Python source of the value of a variable whose declaration gives none."""
        if type_.start:
            return type_.start
        if isinstance(type_, t.ScalarType):
            return repr(t.default(type_))
        if isinstance(type_, t.StructureType):
            return f"{self.new_name(type_.layout)}()"
        if isinstance(type_, t.ArrayOf):
            inner = self.default(type_.base)
            if isinstance(type_.base, t.ScalarType | t.ReferenceType | t.OpaqueType):
                return f"[{inner}] * {type_.size}"
            return f"[{inner} for _ in range({type_.size})]"
        return "None"

    def new_name(self, layout: Layout) -> str:
        """Return the name of the function that makes frames of a layout."""
        found = self._news.get(layout)
        if found is None:
            found = self._news[layout] = self.linker.reserve("new")
            layout.new = found
            layout.new_name = self.linker.name(found)
            if self.block_of(layout) is not None:  # nothing else will write it
                self.write_new(layout)
        return layout.new_name

    def write_new(self, layout: Layout) -> None:
        """Write the function that makes frames of a layout."""
        writer = Writer()
        items = ", ".join("None" if field.late else field.initial for field in layout.fields)
        writer.write(f"v = [{items}]")
        for field in layout.fields:
            if field.late:
                writer.write(f"v[{field.slot}] = {field.initial}")
        writer.write(f"return Frame({self.linker.name(layout, 'l')}, v)")
        self.new_name(layout)
        self.linker.routine("", writer, layout.name, self._news[layout])


class Scope:
    """The names that are visible in a POU or method, and where their variables are.

    `layout` are its own variables, in the slots `v` of the frame of a call. A method has an `around`: the scope of its
    POU, whose frame is `this`.
    """

    def __init__(
        self, library: TranslatedProject, path: str, layout: Layout, *, place: str = "", around: Scope | None = None
    ) -> None:
        self.library = library
        self.path = path
        self.layout = layout
        self.place = place
        self.around = around
        self.unit: TranslatedPou | None = around.unit if around is not None else None
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
        """Clock of the controller."""
        return self.library.processor

    def structure(self, name: str, members: Mapping[str, t.Type]) -> t.StructureType:
        """Return a new type of structure."""
        layout = Layout(name)
        for member, type_ in members.items():
            layout.add(member, type_).initial = self.library.default(type_)
        self.library.write_new(layout)
        return t.StructureType(name, layout)

    def declare(self, name: str, type_: t.Type, *, hidden: bool = False, direction: Direction = Direction.LOCAL) -> int:
        """Declare a variable of the simulator; return its slot in `v`. An existing one of the name stays what it is.

        Only while the POU is being declared, that is, in a chart compiler.
        """
        there = self.layout.find(name)
        if there is not None:
            return there.slot
        if not self.is_open:
            raise AssertionError(f"{name} is declared too late")
        made = self.layout.add(name, type_, direction, hidden=hidden)
        made.initial = self.library.default(type_)
        return made.slot

    def lookup(self, name: str) -> Field | None:
        """Return the variable of this name that the POU has; None if it has none."""
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
        made.initial = self.library.default(type_)
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
            self.library.write_new(self._late)
        elif self._late is not None:
            unused = self.layout.fields[self._late_slot]
            unused.type, unused.initial = t.OpaqueType("nothing"), "None"
        self.library.write_new(self.layout)

    # -- names

    def outer(self) -> Iterable[Level]:
        """Return the levels of global names, the nearest first."""
        return self.library.names.outer(self.place)

    def resolve(self, name: n.Name, *, called: bool = False) -> Any:
        """Meaning of a name on its own: a `Place`, a `Code`, a `Space`, a `TranslatedPou`, a type, or `Unknown`."""
        key = name.identifier.casefold()
        if name.quoting is not Quoting.GLOBAL:
            found = self._local(key, "v")
            if found is not None:
                return found
            if self.around is not None:
                found = self.around._local(key, "t")
                if found is not None:
                    return found
        if called and self.unit is not None and self.unit.method(name.identifier) is not None:
            return Unknown(name.identifier)  # a method of its own hides what is global
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
        """Return the place of a variable of the POU."""
        key = self.library.use.key(self.layout, field.slot)
        if field.direction is Direction.IN_OUT and isinstance(field.type, t.ScalarType | t.ReferenceType):
            pointer = f"{cells}[{field.slot}]"
            self.library.use.parameters[id(field)] = key
            return Place(f"{pointer}.cells", f"{pointer}.index", field.type, field.name, root=key, field=field)
        own = self.unit is not None and self.around is None
        is_input = own and (field.direction is Direction.INPUT or self.library.use.is_freed(field))
        if field.direction is Direction.IN_OUT:
            is_input = True
            self.library.use.references.add(key)
            self.library.use.parameters[id(field)] = key
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

    def action(self, name: str) -> Callable[[Frame], None] | None:
        """Return the action of this name of the POU, or of one that it extends; None if there is none."""
        return self.unit.action(name) if self.unit is not None else None


class CompiledChart(Protocol):
    """A chart as a chart compiler makes it."""

    def translate(self) -> None:
        """Translate conditions and actions: all POUs are declared now."""

    def initialise(self, frame: Frame) -> None:
        """Bring a new frame of the POU into the initial situation."""

    def execute(self, frame: Frame) -> None:
        """Execute the body once."""


ChartCompiler = Callable[[SfcNetwork, Scope, str], CompiledChart]
"""Makes the program of a chart of a POU; the text is the path of its body."""


class Callee:
    """POU or method: something with parameters and a body."""

    def __init__(self, library: TranslatedProject, name: str, scope: Scope) -> None:
        self.library = library
        self.name = name
        self.scope = scope
        self.layout = scope.layout
        self.result: Field | None = None
        self.run: Callable[..., None] = library.linker.reserve()
        self.enter: Callable[..., Frame] = library.linker.reserve("enter")
        """Makes a frame, gives it arguments, runs it, and returns it."""

    @property
    def parameters(self) -> list[Field]:
        """Inputs and in-outs in their order."""
        return [f for f in self.layout.fields if f.direction in (Direction.INPUT, Direction.IN_OUT)]


class TranslatedMethod(Callee):
    """A method of a function block: it has variables of its own for each call."""

    def __init__(self, unit: TranslatedPou, method: Method) -> None:
        path = f"{unit.pou.name}.{method.name}"
        scope = Scope(unit.library, path, Layout(path), place=unit.pou.place, around=unit.scope)
        super().__init__(unit.library, method.name, scope)
        self.method = method
        self.pou = unit.pou


class TranslatedPou(Callee):
    """A program, function block or function; `routines.declare` fills it, `routines.translate` translates it."""

    def __init__(self, library: TranslatedProject, pou: Pou, base: TranslatedPou | None) -> None:
        layout = Layout(pou.name, base.layout if base is not None else None)
        layout.is_instance = True
        super().__init__(library, pou.name, Scope(library, pou.name, layout, place=pou.place))
        self.scope.unit = self
        self.pou = pou
        self.base = base
        self.methods: dict[str, TranslatedMethod] = {}
        self.charts: list[tuple[str, CompiledChart]] = []
        self.executions: dict[int, Callable[[Frame], None]] = {}
        """Programs that execute the charts, by the identity of their bodies."""
        self.actions: dict[str, Callable[[Frame], None]] = {}

    @property
    def is_function(self) -> bool:
        """True if a call of it has variables of its own."""
        return self.pou.kind is PouKind.FUNCTION

    @property
    def is_program(self) -> bool:
        """True if there is one instance, which has its name."""
        return self.pou.kind in (PouKind.PROGRAM, PouKind.ORGANIZATION_BLOCK)

    def action(self, name: str) -> Callable[[Frame], None] | None:
        """Return the function of an action, its own or of a POU that it extends."""
        found = self.actions.get(local_name(name).casefold())
        return found if found is not None or self.base is None else self.base.action(name)

    def method(self, name: str) -> TranslatedMethod | None:
        """Return a method, its own or of a POU that it extends."""
        found = self.methods.get(name.casefold())
        return found if found is not None or self.base is None else self.base.method(name)

    def finish(self) -> None:
        """Write what makes new frames: nothing more will be declared in it."""
        self.scope.finish()
        for method in self.methods.values():
            method.scope.finish()

    def starting(self) -> list[Method]:
        """Return the methods that the tool calls when an instance is made."""
        return called_at_start(self.pou) if self.library.dialect in (Dialect.CODESYS, Dialect.TWINCAT) else []

    def _start(self, method: TranslatedMethod, frame: Frame) -> None:
        names = [field.name for field in method.parameters]
        unknown = next((name for name in names if name.casefold() not in _AT_START), None)
        if unknown is not None:
            message = (
                f"the declaration of an instance gives {method.name} its {unknown}: the simulator does not know it"
            )
            raise SimulationError(message, location=Location(path=method.scope.path))
        method.enter(frame, *(_AT_START[name.casefold()] for name in names))

    def initialise(self, frame: Frame) -> None:
        """Call what the tool calls for a new frame, and bring its charts into their initial situation."""
        if self.base is not None:
            self.base.initialise(frame)
        for method in self.starting():
            self._start(self.methods[method.name.casefold()], frame)
        for _, chart in self.charts:
            chart.initialise(frame)


_AT_START = {"binitretains": True, "bincopycode": False}
"""What ``FB_Init`` gets where a controller starts with fresh variables (CODESYS and TwinCAT 3, help on FB_Init)."""
