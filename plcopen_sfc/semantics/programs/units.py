"""POUs and methods: their variables, bodies, actions, and how they are called."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.languages.binding.symbols import Kind
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.model import types as m
from plcopen_sfc.model.body import Body, OpaqueBody, SfcBody
from plcopen_sfc.model.pou import Method, Pou, PouKind
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.linking import Writer
from plcopen_sfc.semantics.programs.places import Broken, Place
from plcopen_sfc.semantics.programs.scopes import Scope
from plcopen_sfc.semantics.programs.types import Direction, Field, Frame, Layout

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.library import CompiledChart, Library

_DIRECTIONS = {
    SectionKind.INPUT: Direction.INPUT,
    SectionKind.OUTPUT: Direction.OUTPUT,
    SectionKind.IN_OUT: Direction.IN_OUT,
    SectionKind.TEMP: Direction.TEMP,
    SectionKind.CONSTANT: Direction.CONSTANT,
    SectionKind.RETURN: Direction.OUTPUT,
}


class Callee:
    """POU or method: something with parameters and a body."""

    def __init__(self, library: Library, name: str, scope: Scope) -> None:
        self.library = library
        self.name = name
        self.scope = scope
        self.layout = scope.layout
        self.result: Field | None = None
        self.run: Callable[..., None] = library.linker.reserve()
        self.enter: Callable[..., Frame] = library.linker.reserve("enter")

    @property
    def parameters(self) -> list[Field]:
        """Inputs and in-outs in their order."""
        return [f for f in self.layout.fields if f.direction in (Direction.INPUT, Direction.IN_OUT)]

    def declare_interface(self, interface: Interface | None) -> None:
        """Declare the variables of the sections, and the result."""
        if interface is None:
            return
        for section in interface.sections:
            for variable in section.variables:
                try:
                    self._variable(section, variable)
                except SimulationError as error:
                    place = Location(path=f"{self.scope.path}.{variable.name}")
                    broken = SimulationError(error.message, location=place, hint=error.hint)
                    self.scope.aliases[variable.name.casefold()] = Broken(broken)
                    unusable = self.layout.find(variable.name)
                    if unusable is not None:
                        unusable.hidden = True
                    self.library.problems.append(broken)
            if section.kind is SectionKind.RETURN and section.variables:  # of S7, without a result its type is Void
                field = self.layout.find(section.variables[0].name)
                self.result = field if field is not None and not isinstance(field.type, t.OpaqueType) else None
        if interface.return_type is not None:
            type_ = self.library.types.read(interface.return_type, self.scope)
            self.result = self.layout.find(self.name)
            if self.result is None:
                self.result = self.layout.add(self.name, type_, Direction.OUTPUT)
                self.result.initial = self.library.initials.default(type_)

    def _variable(self, section: VariableSection, variable: m.Variable) -> None:
        if not variable.name:
            return
        if section.kind is SectionKind.EXTERNAL:
            self.scope.aliases[variable.name.casefold()] = self._external(variable)
            return
        if section.kind is SectionKind.ACCESS:
            return
        if "edge" in kept(variable.carried):
            raise SimulationError(f"{variable.name} is an input that watches for an edge: the simulator knows none")
        type_ = self.library.types.read(variable.type, self.scope)
        if variable.address and "*" not in variable.address:
            if not variable.address.startswith("%") or not isinstance(type_, t.ElementaryType):
                raise SimulationError(f"{variable.name} lies over {variable.address}: the simulator keeps them apart")
            path = f"{self.scope.path}.{variable.name}"
            self.scope.aliases[variable.name.casefold()] = self.library.image.place(
                variable.address, type_, path, variable.initial
            )
            return
        if isinstance(type_, t.ArrayType) and not type_.dimensions and section.kind is not SectionKind.IN_OUT:
            raise SimulationError(f"{variable.name} is {type_.name}: the simulator knows that of VAR_IN_OUT only")
        direction = Direction.CONSTANT if section.constant else _DIRECTIONS.get(section.kind, Direction.LOCAL)
        field = self.layout.add(variable.name, type_, direction)
        field.declared = True
        field.retained = direction is not Direction.TEMP
        if direction is Direction.IN_OUT:
            field.initial = "None"
        else:
            self.library.initials.give(field, variable.initial, self.scope)
        if section.kind is SectionKind.RETURN and self.result is None:
            self.result = field

    def _external(self, variable: m.Variable) -> Place:
        for level in self.scope.outer():
            found = [d for d in level.named(variable.name) if d.kind is Kind.VARIABLE]
            if found:
                return self.library.variable(found[0])
        type_ = self.library.types.read(variable.type, self.scope)
        return self.library.implicit(variable.name, type_)

    def translate_bodies(self, bodies: list[Body], parameters: str) -> None:
        """The body as a function `run`."""
        texts = [body for body in bodies if not isinstance(body, SfcBody)]
        if len(bodies) == 1 and texts and not isinstance(texts[0], OpaqueBody):
            self.scope.body(texts[0], self.scope.path, function=self.run)
            return
        writer = Writer()
        for body in bodies:
            function = self.body_function(body)
            writer.write(f"{self.library.linker.name(function)}({parameters})")
        self.library.linker.routine(parameters, writer, self.scope.path, self.run)

    def body_function(self, body: Body) -> Callable[..., None]:
        """One of several bodies."""
        return self.scope.body(body, self.scope.path)

    def write_entry(self, parameters: str, run: str) -> None:
        """The function that makes a frame, gives it arguments, runs it, and returns it."""
        writer = Writer()
        writer.write("p.left -= 1")
        writer.write("if p.left < 0: endless()")
        writer.write(f"f = {self.library.new_name(self.layout)}()")
        arguments = [f"a{field.slot}" for field in self.parameters]
        if arguments:
            writer.write("v = f.v")
        for field in self.parameters:
            writer.write(f"v[{field.slot}] = a{field.slot}")
        writer.write(run)
        writer.write("return f")
        self.library.linker.routine(", ".join([*parameters.split(), *arguments]), writer, self.scope.path, self.enter)


class MethodUnit(Callee):
    """A method of a function block: it has variables of its own for each call."""

    def __init__(self, unit: Unit, method: Method) -> None:
        path = f"{unit.pou.name}.{method.name}"
        scope = Scope(unit.library, path, Layout(path), place=unit.pou.place, around=unit.scope)
        super().__init__(unit.library, method.name, scope)
        self.method = method
        self.pou = unit.pou

    def declare(self) -> None:
        """Declare its variables."""
        self.declare_interface(self.method.interface)
        self.scope.close()

    def translate(self) -> None:
        """Translate its body."""
        self.translate_bodies([self.method.body] if self.method.body is not None else [], "f, this")
        self.write_entry("this", f"{self.library.linker.name(self.run)}(f, this)")


class Unit(Callee):
    """A program, function block or function."""

    def __init__(self, library: Library, pou: Pou) -> None:
        pou.read()
        base = library.names.base(pou)
        self.base: Unit | None = library.unit(base) if base is not None and base is not pou else None
        layout = Layout(pou.name, self.base.layout if self.base is not None else None)
        layout.is_instance = True
        super().__init__(library, pou.name, Scope(library, pou.name, layout, place=pou.place))
        self.scope.unit = self
        self.pou = pou
        self.methods: dict[str, MethodUnit] = {}
        self.charts: list[tuple[str, CompiledChart]] = []
        self._executions: dict[int, Callable[[Frame], None]] = {}
        self._actions: dict[str, Callable[[Frame], None]] = {}

    @property
    def is_function(self) -> bool:
        """True if a call of it has variables of its own."""
        return self.pou.kind is PouKind.FUNCTION

    @property
    def is_program(self) -> bool:
        """True if there is one instance, which has its name."""
        return self.pou.kind in (PouKind.PROGRAM, PouKind.ORGANIZATION_BLOCK)

    def declare(self) -> None:
        """Declare its variables, those of its charts too."""
        if self.base is not None:
            self.scope.aliases.update(self.base.scope.aliases)
        self.declare_interface(self.pou.interface)
        for method in self.pou.methods:
            self.methods[method.name.casefold()] = MethodUnit(self, method)
            for section in method.interface.sections if method.interface is not None else ():
                if kept(section.carried).get("keyword") == "VAR_INST":
                    self.library.problems.append(SimulationError(f"VAR_INST of {method.name} does not keep its value"))
        for name, _, body in self.pou.named_bodies():
            if isinstance(body, SfcBody) and id(body) not in self._executions:  # that of an action may run as the body
                self._declare_chart(name, body)
        for action in self.pou.actions:
            self._actions[action.name.casefold()] = self.library.linker.reserve("act")
        self.scope.close()
        for method_unit in self.methods.values():
            method_unit.declare()

    def _declare_chart(self, name: str, body: SfcBody) -> None:
        compiler = self.library.chart_compiler
        if compiler is None:
            return
        chart = compiler(body.chart, self.scope, name)
        self.charts.append((name, chart))
        self._executions[id(body)] = chart.execute

    def translate(self) -> None:
        """Translate its bodies, actions and methods."""
        for _, chart in self.charts:
            chart.translate()
        self.translate_bodies(self.pou.bodies, "f")
        for action in self.pou.actions:
            function = self._actions[action.name.casefold()]
            path = f"{self.pou.name}.{action.name}"
            writer = Writer()
            if isinstance(action.body, SfcBody) or action.body is None:
                if action.body is not None:
                    writer.write(f"{self.library.linker.name(self.body_function(action.body))}(f)")
                self.library.linker.routine("f", writer, path, function)
            else:
                self.scope.body(action.body, path, function=function)
        for method in self.methods.values():
            method.translate()
        if self.is_function:
            self.write_entry("", f"{self.library.linker.name(self.run)}(f)")

    def finish(self) -> None:
        """Nothing more will be declared in it."""
        self.scope.finish()
        for method in self.methods.values():
            method.scope.finish()

    def body_function(self, body: Body) -> Callable[..., None]:
        """One of several bodies, or a chart."""
        found = self._executions.get(id(body))
        if found is not None:
            return found
        return super().body_function(body)

    def action(self, name: str) -> Callable[[Frame], None] | None:
        """The function of an action, its own or of a POU that it extends."""
        found = self._actions.get(name.casefold())
        return found if found is not None or self.base is None else self.base.action(name)

    def method(self, name: str) -> MethodUnit | None:
        """A method, its own or of a POU that it extends."""
        found = self.methods.get(name.casefold())
        return found if found is not None or self.base is None else self.base.method(name)

    def initialise(self, frame: Frame) -> None:
        """Bring the charts of a new frame into their initial situation."""
        if self.base is not None:
            self.base.initialise(frame)
        for _, chart in self.charts:
            chart.initialise(frame)


def unit_of(type_: t.Type, library: Library) -> Unit | None:
    """The POU that a type is of."""
    return library.unit_of_layout(type_.layout) if isinstance(type_, t.StructureType) else None
