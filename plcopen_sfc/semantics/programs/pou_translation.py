"""Declaring the variables of POUs and methods, and translating their bodies."""

from __future__ import annotations

from collections.abc import Callable

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.languages.binding.symbols import Kind
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.model import types as m
from plcopen_sfc.model.body import Body, OpaqueBody, SfcBody
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.code_generation import Writer
from plcopen_sfc.semantics.programs.places import Broken, Place
from plcopen_sfc.semantics.programs.routines import Routines, write_temporary_starts
from plcopen_sfc.semantics.programs.scopes import Callee, CompiledChart, Scope, TranslatedMethod, TranslatedPou
from plcopen_sfc.semantics.programs.types import Direction

ChartCompiler = Callable[[SfcNetwork, Scope, str], CompiledChart]

_DIRECTIONS = {
    SectionKind.INPUT: Direction.INPUT,
    SectionKind.OUTPUT: Direction.OUTPUT,
    SectionKind.IN_OUT: Direction.IN_OUT,
    SectionKind.TEMP: Direction.TEMP,
    SectionKind.CONSTANT: Direction.CONSTANT,
    SectionKind.RETURN: Direction.OUTPUT,
}


def declare(unit: TranslatedPou, compiler: ChartCompiler | None) -> None:
    """Declare the variables of a POU, of its charts and of its methods."""
    if unit.base is not None:
        unit.scope.aliases.update(unit.base.scope.aliases)
    _declare_interface(unit, unit.pou.interface)
    for method in unit.pou.methods:
        unit.methods[method.name.casefold()] = TranslatedMethod(unit, method)
        for section in method.interface.sections if method.interface is not None else ():
            if kept(section.carried).get("keyword") == "VAR_INST":
                unit.library.problems.append(SimulationError(f"VAR_INST of {method.name} does not keep its value"))
    for name, _, body in unit.pou.named_bodies():
        if compiler is None or not isinstance(body, SfcBody) or id(body) in unit.executions:
            continue  # that of an action may run as the body
        chart = compiler(body.chart, unit.scope, name)
        unit.charts.append((name, chart))
        unit.executions[id(body)] = chart.execute
    for action in unit.pou.actions:
        unit.actions[action.name.casefold()] = unit.library.linker.reserve("act")
    unit.scope.close()
    for method_unit in unit.methods.values():
        _declare_interface(method_unit, method_unit.method.interface)
        method_unit.scope.close()


def _declare_interface(callee: Callee, interface: Interface | None) -> None:
    """Declare the variables of the sections, and the result."""
    if interface is None:
        return
    for section in interface.sections:
        for variable in section.variables:
            try:
                _declare_variable(callee, section, variable)
            except SimulationError as error:
                place = Location(path=f"{callee.scope.path}.{variable.name}")
                broken = SimulationError(error.message, location=place, hint=error.hint)
                callee.scope.aliases[variable.name.casefold()] = Broken(broken)
                unusable = callee.layout.find(variable.name)
                if unusable is not None:
                    unusable.hidden = True
                callee.library.problems.append(broken)
        if section.kind is SectionKind.RETURN and section.variables:  # of S7, without a result its type is Void
            field = callee.layout.find(section.variables[0].name)
            callee.result = field if field is not None and not isinstance(field.type, t.OpaqueType) else None
    if interface.return_type is not None:
        type_ = callee.library.read_type(interface.return_type, callee.scope)
        callee.result = callee.layout.find(callee.name)
        if callee.result is None:
            callee.result = callee.layout.add(callee.name, type_, Direction.OUTPUT)
            callee.result.initial = callee.library.default(type_)


def _declare_variable(callee: Callee, section: VariableSection, variable: m.Variable) -> None:
    if not variable.name:
        return
    if section.kind is SectionKind.EXTERNAL:
        callee.scope.aliases[variable.name.casefold()] = _external(callee, variable)
        return
    if section.kind is SectionKind.ACCESS:
        return
    if "edge" in kept(variable.carried):
        raise SimulationError(f"{variable.name} is an input that watches for an edge: the simulator knows none")
    type_ = callee.library.read_type(variable.type, callee.scope)
    if variable.address and "*" not in variable.address:
        if not variable.address.startswith("%") or not isinstance(type_, t.ElementaryType):
            raise SimulationError(f"{variable.name} lies over {variable.address}: the simulator keeps them apart")
        path = f"{callee.scope.path}.{variable.name}"
        callee.scope.aliases[variable.name.casefold()] = callee.library.at_address(
            variable.address, type_, path, variable.initial
        )
        return
    if isinstance(type_, t.ArrayType) and not type_.dimensions and section.kind is not SectionKind.IN_OUT:
        raise SimulationError(f"{variable.name} is {type_.name}: the simulator knows that of VAR_IN_OUT only")
    direction = Direction.CONSTANT if section.constant else _DIRECTIONS.get(section.kind, Direction.LOCAL)
    field = callee.layout.add(variable.name, type_, direction)
    field.declared = True
    field.given = variable.address is not None and variable.address.upper().startswith("%I")
    field.retained = direction is not Direction.TEMP
    if direction is Direction.IN_OUT:
        field.initial = "None"
    else:
        callee.library.give_initial(field, variable.initial, callee.scope)
    if section.kind is SectionKind.RETURN and callee.result is None:
        callee.result = field


def _external(callee: Callee, variable: m.Variable) -> Place:
    for level in callee.scope.outer():
        found = [d for d in level.named(variable.name) if d.kind is Kind.VARIABLE]
        if found:
            return callee.library.variable(found[0])
    type_ = callee.library.read_type(variable.type, callee.scope)
    return callee.library.implicit(variable.name, type_)


def translate(unit: TranslatedPou) -> None:
    """Translate the bodies, actions and methods of a POU."""
    linker = unit.library.linker
    for _, chart in unit.charts:
        chart.translate()
    _translate_bodies(unit, unit.pou.bodies, "f")
    for action in unit.pou.actions:
        function = unit.actions[action.name.casefold()]
        path = f"{unit.pou.name}.{action.name}"
        if isinstance(action.body, SfcBody) or action.body is None:
            writer = Writer()
            if action.body is not None:
                writer.write(f"{linker.name(_body_function(unit, action.body))}(f)")
            linker.routine("f", writer, path, function)
        else:
            Routines(unit.scope).body(action.body, path, function=function)
    for method in unit.methods.values():
        _translate_bodies(method, [method.method.body] if method.method.body is not None else [], "f, this")
        _write_entry(method, "this", f"{linker.name(method.run)}(f, this)")
    if unit.is_function:
        _write_entry(unit, "", f"{linker.name(unit.run)}(f)")


def _translate_bodies(callee: Callee, bodies: list[Body], parameters: str) -> None:
    """Write the body as the function `run`."""
    texts = [body for body in bodies if not isinstance(body, SfcBody)]
    if len(bodies) == 1 and texts and not isinstance(texts[0], OpaqueBody):
        Routines(callee.scope).body(texts[0], callee.scope.path, function=callee.run)
        return
    writer = Writer()
    if isinstance(callee, TranslatedPou) and not callee.is_function:
        writer.write("v = f.v")
        write_temporary_starts(callee.layout, writer)
    for body in bodies:
        function = _body_function(callee, body)
        writer.write(f"{callee.library.linker.name(function)}({parameters})")
    callee.library.linker.routine(parameters, writer, callee.scope.path, callee.run)


def _body_function(callee: Callee, body: Body) -> Callable[..., None]:
    """Return what executes one of several bodies, or a chart."""
    found = callee.executions.get(id(body)) if isinstance(callee, TranslatedPou) else None
    if found is not None:
        return found
    return Routines(callee.scope).body(body, callee.scope.path)


def _write_entry(callee: Callee, parameters: str, run: str) -> None:
    """Write the function that makes a frame, gives it arguments, runs it, and returns it."""
    writer = Writer()
    writer.write("p.left -= 1")
    writer.write("if p.left < 0: endless()")
    writer.write(f"f = {callee.library.new_name(callee.layout)}()")
    arguments = [f"a{field.slot}" for field in callee.parameters]
    if arguments:
        writer.write("v = f.v")
    for field in callee.parameters:
        writer.write(f"v[{field.slot}] = a{field.slot}")
    writer.write(run)
    writer.write("return f")
    callee.library.linker.routine(", ".join([*parameters.split(), *arguments]), writer, callee.scope.path, callee.enter)
