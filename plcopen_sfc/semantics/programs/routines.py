"""Bodies, conditions and expressions of any language as functions of the frame that they work on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.languages.declarations.type_names import is_identifier
from plcopen_sfc.languages.networks import body_statements, chart_statements, condition_expression
from plcopen_sfc.languages.networks.results import NetworkText
from plcopen_sfc.languages.st import Parsed, parse_expression, parse_statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.model.body import Body, FbdBody, IlBody, LdBody, OpaqueBody, SfcBody, StBody
from plcopen_sfc.model.conditions import Condition
from plcopen_sfc.model.sfc import SfcNetwork, Transition
from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.code_generation import Writer
from plcopen_sfc.semantics.programs.expressions import Translator
from plcopen_sfc.semantics.programs.instruction_list import InstructionTranslator
from plcopen_sfc.semantics.programs.places import Place, Unknown
from plcopen_sfc.semantics.programs.scopes import Scope
from plcopen_sfc.semantics.programs.statements import StatementTranslator
from plcopen_sfc.semantics.programs.types import Direction, Frame, Layout
from plcopen_sfc.semantics.programs.value_code import Code, settled, truth


def write_temporary_starts(layout: Layout, writer: Writer) -> None:
    """Let the variables of VAR_TEMP start with their initial values, as at each call of their POU."""
    for field in layout.fields:
        if field.direction is Direction.TEMP:
            writer.write(f"v[{field.slot}] = {field.initial}")


class Routines:
    """Functions that execute the texts of a scope; they can be called when the controller is linked."""

    def __init__(self, scope: Scope) -> None:
        self._scope = scope
        self._library = scope.library
        self._parameters = "f, this" if scope.around is not None else "f"

    def body(self, body: Body, path: str, function: Callable[..., Any] | None = None) -> Callable[..., None]:
        """Return a body in any language. What cannot be translated raises a `SimulationError` when it is executed."""
        writer = self._writer()
        try:
            statements, text, instances = self._statements(body) if not isinstance(body, IlBody) else ((), None, {})
        except SimulationError as error:
            self._refuse(error, path, writer)
            return self._routine(writer, path, function)
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
        writer = self._writer()
        try:
            read = chart_statements(chart, self._library.dialect, taken=self._taken())
            self._check(read)
        except SimulationError as error:
            self._refuse(error, path, writer)
            return self._routine(writer, path)
        self._declare(read)
        translator = Translator(self._scope, writer)
        translator.instances = _types(read)
        StatementTranslator(translator, path).body(read.tree.statements)
        return self._routine(writer, path)

    def condition(self, condition: Condition, path: str, *, chart: SfcNetwork | None = None) -> Callable[[Frame], bool]:
        """Return any condition of the model."""
        writer = self._writer()
        transitions = self._scope.unit.pou.transitions if self._scope.unit is not None else ()
        transition = Transition(id=0, condition=condition)
        try:
            read = condition_expression(
                chart if chart is not None else SfcNetwork(),
                transition,
                self._library.dialect,
                transitions=transitions,
                taken=self._taken(),
            )
            self._check(read)
            if read.tree is None:
                raise SimulationError("the condition has no value")
            self._declare(read)
            translator = Translator(self._scope, writer)
            translator.instances = _types(read)
            StatementTranslator(translator, path).body(read.before)
            code = truth(translator.value(read.tree, t.BOOL))
            writer.write(f"return {code.text}")
        except SimulationError as error:
            self._refuse(error, path, writer)
        return self._routine(writer, path)

    def expression(
        self, given: str | n.Expression, path: str, expected: t.Type | None = None
    ) -> Callable[[Frame], Any]:
        """Return an expression, a text or a tree; its value is of type `expected` where that is given."""
        writer = self._writer()
        try:
            tree = given if not isinstance(given, str) else self._parsed(given)
            translator = Translator(self._scope, writer)
            code = translator.value(tree, expected)
            if expected is not None:
                code = translator.fitted(code, expected)
            writer.write(f"return {settled(code).text}")
        except SimulationError as error:
            self._refuse(error, path, writer)
        return self._routine(writer, path)

    def getter(self, text: str, expected: t.Type | None = None) -> Callable[[Frame], Any]:
        """Return what reads a variable, of any path; an undeclared one is an external of type `expected`, else BOOL."""
        return self.expression(text, self._scope.path, expected)

    def setter(self, text: str, type_: t.Type = t.BOOL) -> Callable[[Frame, Any], None]:
        """Return what writes a variable, of any path; an undeclared one gets `type_`.

        Values are of the variable's type.
        """
        writer = self._writer()
        path = self._scope.path
        try:
            translator = Translator(self._scope, writer)
            place = translator.place(self._parsed(text), type_)
            translator.note_write(place)
            if place.bits is not None:
                translator.write(place, Code("value", place.type))
            else:
                writer.write(f"{place.text} = value")
        except SimulationError as error:
            self._refuse(error, path, writer)
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

    def _writer(self) -> Writer:
        writer = Writer()
        writer.write("v = f.v")
        if self._scope.around is not None:
            writer.write("t = this.v")
        return writer

    def _routine(self, writer: Writer, path: str, function: Callable[..., Any] | None = None) -> Callable[..., Any]:
        return self._library.linker.routine(self._parameters, writer, path, function)

    def _refuse(self, error: SimulationError, path: str, writer: Writer) -> None:
        if error.location.path is None:
            error.location = Location(path=path, line=error.location.line)
        self._library.problems.append(error)
        writer.write(f"fail({self._library.linker.name(error, 'e')})")

    def _statements(self, body: Body) -> tuple[Sequence[n.Statement], str | None, Mapping[str, str]]:
        if isinstance(body, StBody):
            parsed = parse_statements(body.text, self._library.dialect)
            _check_syntax(parsed)
            return parsed.tree.statements, body.text, {}
        if isinstance(body, FbdBody | LdBody):
            read = body_statements(body, self._library.dialect, taken=self._taken())
            self._check(read)
            self._declare(read)
            return read.tree.statements, None, _types(read)
        if isinstance(body, SfcBody):
            raise SimulationError("a chart cannot be executed here")
        source = body.source if isinstance(body, OpaqueBody) else body.language
        raise SimulationError(f"a body in {source} is not known to the simulator")

    def _taken(self) -> list[str]:
        names = [field.name for field in self._scope.layout.fields]
        return [*names, *self._scope.aliases]

    def _check(self, read: NetworkText) -> None:
        for wrong in read.obstacles:
            place = f"element {wrong.node}: " if wrong.node is not None else ""
            raise SimulationError(f"the network cannot be executed: {place}{wrong.message}")

    def _declare(self, read: NetworkText) -> None:
        for helper in read.helpers:
            type_: t.Type = t.ANY
            if helper.type_name is not None:
                type_ = self._library.named_type(helper.type_name, self._scope)
            self._scope.helper(helper.name, type_)
        for text, type_name in read.instances.items():
            # the drawing tells the type of an undeclared instance
            name = text.strip('"')
            if name != text and isinstance(self._scope.resolve(n.Name(name, n.Quoting.GLOBAL)), Unknown):
                found = self._library.named_type(type_name, self._scope)
                if isinstance(found, t.StructureType):
                    self._library.implicit(name, found)
            elif is_identifier(text) and isinstance(self._scope.resolve(n.Name(text)), Unknown):
                found = self._library.named_type(type_name, self._scope)
                if isinstance(found, t.StructureType):
                    self._scope.helper(name, found)
                    self._library.undeclared[name] = found


def _types(read: NetworkText) -> Mapping[str, str]:
    """The types of the instances in a network, by their paths without signs."""
    return {name.replace('"', "").replace("#", "").casefold(): type_ for name, type_ in read.instances.items()}


def _check_syntax(parsed: Parsed[Any]) -> None:
    if parsed.problems:
        line, column = parsed.place(parsed.problems[0].span[0])
        raise SimulationError(parsed.problems[0].message, location=Location(line=line, column=column))
