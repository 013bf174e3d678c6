"""Bodies, conditions and expressions of any language as functions of the frame that they work on.

POUs and methods are translated here: their variables are declared, then their bodies translated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.languages.declarations.conditional_declarations import CONDITION
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.declarations.type_names import is_unreserved
from plcopen_sfc.languages.method_calls import KEPT_IN_METHODS
from plcopen_sfc.languages.networks import body_statements, chart_statements, condition_expression
from plcopen_sfc.languages.networks.exported_networks import SOURCES, network_statements
from plcopen_sfc.languages.networks.results import NetworkText
from plcopen_sfc.languages.st import Parsed, parse_expression, parse_statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import CommentKind
from plcopen_sfc.model import types as m
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.declaration import Kind
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.sfc import Body, Condition, SfcBody, SfcNetwork, Transition
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.code_generation import Writer
from plcopen_sfc.semantics.programs.expressions import Translator
from plcopen_sfc.semantics.programs.instruction_list import InstructionTranslator
from plcopen_sfc.semantics.programs.places import Broken, Place, Unknown
from plcopen_sfc.semantics.programs.runtime_types import Direction, Frame, Layout
from plcopen_sfc.semantics.programs.scopes import Callee, ChartCompiler, Scope, TranslatedMethod, TranslatedPou
from plcopen_sfc.semantics.programs.statements import StatementTranslator
from plcopen_sfc.semantics.programs.value_code import Code, settled, truth

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
    keyword = kept(section.extension_data).get("keyword")
    if isinstance(callee, TranslatedMethod) and keyword in KEPT_IN_METHODS:
        raise SimulationError(f"{variable.name} keeps its value between calls of the method: the simulator forgets it")
    if keyword == "VAR_STAT" and isinstance(callee, TranslatedPou) and callee.pou.kind is not PouKind.PROGRAM:
        raise SimulationError(f"{variable.name} is one for all instances: the simulator keeps one for each")
    if "edge" in kept(variable.extension_data):
        raise SimulationError(f"{variable.name} is an input that watches for an edge: the simulator knows none")
    type_ = callee.library.read_type(variable.type, callee.scope)
    if variable.address and "*" not in variable.address:
        if not variable.address.startswith("%") or not isinstance(type_, t.ScalarType):
            raise SimulationError(f"{variable.name} lies over {variable.address}: the simulator keeps them apart")
        path = f"{callee.scope.path}.{variable.name}"
        callee.scope.aliases[variable.name.casefold()] = callee.library.at_address(
            variable.address, type_, path, variable.initial
        )
        return
    if isinstance(type_, t.ArrayOf) and not type_.dimensions and section.kind is not SectionKind.IN_OUT:
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
    """Return the function that executes one of several bodies, or a chart."""
    found = callee.executions.get(id(body)) if isinstance(callee, TranslatedPou) else None
    if found is not None:
        return found
    return Routines(callee.scope).body(body, callee.scope.path)


def _write_entry(callee: Callee, parameters: str, run: str) -> None:
    """Write the function that makes a frame, gives it arguments, runs it, and returns it."""
    writer = Writer()
    writer.write("p.left -= 1")  # a recursion that does not end is found as a loop is
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


def write_temporary_starts(layout: Layout, writer: Writer) -> None:
    """Set the variables of VAR_TEMP to their initial values, as at each call of their POU."""
    for field in layout.fields:
        if field.direction is Direction.TEMP:
            writer.write(f"v[{field.slot}] = {field.initial}")


class Routines:
    """Functions that execute the texts of a scope; they can be called when the controller is linked."""

    def __init__(self, scope: Scope) -> None:
        self._scope = scope
        self._names: list[str] = []
        self._library = scope.library
        self._parameters = "f, this" if scope.around is not None else "f"

    def body(self, body: Body, path: str, function: Callable[..., Any] | None = None) -> Callable[..., None]:
        """Return a body in any language. An untranslatable part raises a `SimulationError` when executed."""
        with self._written(path) as writer:
            statements, text, instances = self._statements(body) if not isinstance(body, IlBody) else ((), None, {})
            unit = self._scope.unit
            if unit is not None and function is unit.run and not unit.is_function:
                write_temporary_starts(self._scope.layout, writer)
            translator = Translator(self._scope, writer)
            translator.instances = instances
            if isinstance(body, IlBody):
                InstructionTranslator(translator, StatementTranslator(translator, path)).body(body.text)
            else:
                StatementTranslator(translator, path, text).body(statements)
        return self._routine(writer, path, function)

    def statements(self, text: str, path: str) -> Callable[[Frame], None]:
        """Return structured text."""
        return self.body(StBody(text=text), path)

    def chart_logic(self, chart: SfcNetwork, path: str) -> Callable[[Frame], None]:
        """Return the effects of the logic drawn in a chart besides feeding its conditions."""
        with self._written(path) as writer:
            read = chart_statements(chart, self._library.dialect, taken=self._taken())
            StatementTranslator(self._translator(read, writer), path).body(read.tree.statements)
        return self._routine(writer, path)

    def condition(self, condition: Condition, path: str, *, chart: SfcNetwork | None = None) -> Callable[[Frame], bool]:
        """Return any condition of the model."""
        with self._written(path) as writer:
            read = condition_expression(
                chart if chart is not None else SfcNetwork(),
                Transition(id=0, condition=condition),
                self._library.dialect,
                transitions=self._scope.unit.pou.transitions if self._scope.unit is not None else (),
                taken=() if condition.kind == "expression" else self._taken(),
            )
            translator = self._translator(read, writer)
            if read.tree is None:
                raise SimulationError("the condition has no value")
            StatementTranslator(translator, path).body(read.before)
            writer.write(f"return {truth(translator.value(read.tree, t.BOOL)).text}")
        return self._routine(writer, path)

    def expression(
        self, given: str | n.Expression, path: str, expected: t.Type | None = None
    ) -> Callable[[Frame], Any]:
        """Return an expression, a text or a tree; its value is of type `expected` where that is given."""
        with self._written(path) as writer:
            tree = given if not isinstance(given, str) else self._parsed(given)
            translator = Translator(self._scope, writer)
            code = translator.value(tree, expected)
            if expected is not None:
                code = translator.fitted(code, expected)
            writer.write(f"return {settled(code).text}")
        return self._routine(writer, path)

    def getter(self, text: str, expected: t.Type | None = None) -> Callable[[Frame], Any]:
        """Return the reader of a variable, of any path; an undeclared one is an external of `expected`, or BOOL."""
        return self.expression(text, self._scope.path, expected)

    def setter(self, text: str, type_: t.Type = t.BOOL) -> Callable[[Frame, Any], None]:
        """Return the writer of a variable, of any path; an undeclared one gets `type_`.

        Values are of the variable's type.
        """
        path = self._scope.path
        with self._written(path) as writer:
            translator = Translator(self._scope, writer)
            place = translator.place(self._parsed(text), type_)
            translator.note_write(place)
            if place.bits is not None:
                translator.write(place, Code("value", place.type))
            else:
                writer.write(f"{place.text} = value")
        return self._library.linker.routine(f"{self._parameters}, value", writer, path)

    def type_of(self, text: str) -> t.Type | None:
        """Return the type of a variable, of any path; None if it is not declared."""
        parsed = parse_expression(text, self._library.dialect)
        if parsed.problems:
            return None
        found = Translator(self._scope, Writer()).meaning(parsed.tree)
        return found.type if isinstance(found, Place) else None

    # -- parts

    def _parsed(self, text: str) -> n.Expression:
        parsed = parse_expression(text, self._library.dialect)
        _check_syntax(parsed)
        return parsed.tree

    @contextmanager
    def _written(self, path: str) -> Iterator[Writer]:
        """Write the source of a function. What cannot be translated in the `with` is an error where it is reached."""
        writer = Writer()
        writer.write("v = f.v")
        if self._scope.around is not None:
            writer.write("t = this.v")
        try:
            yield writer
        except SimulationError as error:
            if error.location.path is None:
                error.location = Location(path=path, line=error.location.line)
            self._library.problems.append(error)
            writer.write(f"fail({self._library.linker.name(error, 'e')})")

    def _routine(self, writer: Writer, path: str, function: Callable[..., Any] | None = None) -> Callable[..., Any]:
        return self._library.linker.routine(self._parameters, writer, path, function)

    def _translator(self, read: NetworkText, writer: Writer) -> Translator:
        """Return a translator of what was read of a network, whose variables are declared then."""
        self._declare(read)
        translator = Translator(self._scope, writer)
        translator.instances = _types(read)
        return translator

    def _statements(self, body: Body) -> tuple[Sequence[n.Statement], str | None, Mapping[str, str]]:
        if isinstance(body, StBody):
            parsed = parse_statements(body.text, self._library.dialect)
            _check_syntax(parsed)
            return parsed.tree.statements, body.text, {}
        if isinstance(body, FbdBody | LdBody):
            read = body_statements(body, self._library.dialect, taken=self._taken())
            self._declare(read)
            return read.tree.statements, None, _types(read)
        if isinstance(body, SfcBody):
            raise SimulationError("a chart cannot be executed here")
        text = network_statements(body.content) if isinstance(body, OpaqueBody) and body.source in SOURCES else None
        if text is not None:
            return parse_statements(text, self._library.dialect).tree.statements, text, {}
        source = body.source if isinstance(body, OpaqueBody) else body.language
        raise SimulationError(f"a body in {source} is not known to the simulator")

    def _taken(self) -> list[str]:
        fields, aliases = self._scope.layout.fields, self._scope.aliases
        new = fields[len(self._names) :]  # a chart asks for each of its conditions, and declares something for each
        self._names += [field.name for field in new]
        return [*self._names, *aliases]

    def _declare(self, read: NetworkText) -> None:
        for wrong in read.obstacles:
            place = f"element {wrong.node}: " if wrong.node is not None else ""
            raise SimulationError(f"the network cannot be executed: {place}{wrong.message}")
        for helper in read.helpers:
            type_: t.Type = t.ANY
            if helper.type_name is not None:
                type_ = self._library.named_type(helper.type_name, self._scope)
            self._scope.helper(helper.name, type_)
        for text, type_name in read.instances.items():
            # the drawing tells the type of an undeclared instance
            name = text.strip('"')
            is_global = name != text
            if not is_global and not is_unreserved(text):
                continue
            used = n.Name(name, n.Quoting.GLOBAL if is_global else n.Quoting.NONE)
            if isinstance(self._scope.resolve(used), Unknown):
                found = self._library.named_type(type_name, self._scope)
                if isinstance(found, t.StructureType) and is_global:
                    self._library.implicit(name, found)
                elif isinstance(found, t.StructureType):
                    self._scope.helper(name, found)
                    self._library.undeclared[name] = found


def _types(read: NetworkText) -> Mapping[str, str]:
    """Return the types of the instances in a network, by their paths without signs."""
    return {name.replace('"', "").replace("#", "").casefold(): type_ for name, type_ in read.instances.items()}


def _check_syntax(parsed: Parsed[Any]) -> None:
    if parsed.problems:
        line, column = parsed.place(parsed.problems[0].span[0])
        raise SimulationError(parsed.problems[0].message, location=Location(line=line, column=column))
    for comment in parsed.comments:
        if comment.kind is CommentKind.PRAGMA and CONDITION.match(comment.text):
            line, column = parsed.place(comment.span[0])
            why = f"which statements behind {comment.text} are compiled is not known to the simulator"
            raise SimulationError(why, location=Location(line=line, column=column))
