"""Translation of calls: functions, function blocks, methods, actions and programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from plcopen_sfc.errors import SimulationError, UnknownFunctionError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.semantics.programs import runtime
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.paths import PathTranslator
from plcopen_sfc.semantics.programs.places import Place, Space, Unknown
from plcopen_sfc.semantics.programs.runtime_types import Direction, Field
from plcopen_sfc.semantics.programs.scopes import Callee, TranslatedMethod, TranslatedPou
from plcopen_sfc.semantics.programs.standard_functions import StandardFunctions
from plcopen_sfc.semantics.programs.value_code import Code, ranged, settled

_Given = tuple[Field, n.Argument]


class Calls:
    """Translates calls."""

    def __init__(self, translator: PathTranslator) -> None:
        self._translator = translator
        self._library = translator.library
        self._scope = translator.scope
        self._functions = StandardFunctions(translator)

    # -- in expressions

    def value(self, node: n.Call, expected: t.Type | None) -> Code:
        """Return the result of a call."""
        name = node.callee
        if isinstance(name, n.Name):
            meaning = self._called(name)
            if isinstance(meaning, TranslatedPou) and not meaning.is_program:
                return self._of_unit(meaning, node)
            method = self._own_method(name)
            if method is not None:
                return self._method(method, node, self._own_frame)
            if isinstance(meaning, Unknown):
                return self._by_name(name.identifier, node, expected)
        elif isinstance(name, n.Member):
            base = self._meant(name.base)
            if isinstance(base, Place):
                return self._of_instance(base, name.name.identifier, node, expected)
            if isinstance(base, Unknown | Space):
                found = self._translator.meaning(name)
                if isinstance(found, TranslatedPou) and not found.is_program:
                    return self._of_unit(found, node)
                return self._by_name(name.name.identifier, node, expected)
        raise SimulationError(f"{print_node(name)} is called inside an expression, but is no function")

    def _of_unit(self, unit: TranslatedPou, node: n.Call) -> Code:
        if not unit.is_function:
            raise SimulationError(f"{unit.pou.name} is a type: only an instance of it can be called")
        return self._function(unit, node, [])

    def _of_instance(self, place: Place, name: str, node: n.Call, expected: t.Type | None) -> Code:
        unit = self._unit_of(place.type)
        method = unit.method(name) if unit is not None else None
        if method is None and isinstance(place.type, t.OpaqueType):
            return self._uninterpreted(f"{place.path}.{name}", node, expected, self._path_of(place))
        if method is None:
            raise self._unknown(f"{place.path}.{name}")
        self._library.use.written.add(place.root)
        if place.path == "SUPER":
            return self._function(method, node, [place.text])
        return self._method(method, node, place.text)

    def _method(self, method: TranslatedMethod, node: n.Call, frame: str) -> Code:
        """Return a call of a method: of that which the instance has, where a POU that extends this one has another."""
        if not self._library.is_overridden(method):
            return self._function(method, node, [frame])
        return self._function(method, node, [frame], enter=self._library.dispatching(method.name))

    def _by_name(self, name: str, node: n.Call, expected: t.Type | None) -> Code:
        """Return a function that the project does not have."""
        supplied = self._library.functions.get(name.casefold())
        if supplied is not None:
            return self._supplied(supplied, node)
        found = self._functions.value(name, node.arguments, expected)
        return found if found is not None else self._uninterpreted(name, node, expected)

    def _uninterpreted(self, name: str, node: n.Call, expected: t.Type | None, path: str = "") -> Code:
        """Return the result of an unknown function; `path` is that of the instance whose method it is."""
        unknown = self._library.unknown
        if unknown is None:
            raise self._unknown(name)
        unknown.names.setdefault(name)
        inputs, outputs = self._given(node.arguments)
        if outputs:
            raise SimulationError(f"{name} is not known to the simulator: inside an expression it can have no outputs")
        given = isinstance(expected, t.ScalarType) and expected.family is not t.Family.SPECIAL
        type_ = expected if given and expected is not None else t.ANY
        slot = unknown.slot(path) if path else -1
        type_name = self._library.linker.name(type_, "type")
        return ranged(f"unknown_value({name.casefold()!r}, ({inputs}), {type_name}, {slot})", type_, acts=True)

    def _given(self, arguments: Sequence[n.Argument]) -> tuple[str, list[n.Argument]]:
        """Return source of the inputs of an unknown call, by their names, and its outputs."""
        texts: list[str] = []
        for argument in arguments:
            if argument.value is not None and not argument.output:
                text = settled(self._translator.value(argument.value)).text
                texts.append(f"({argument.name.identifier.lower()!r}, {text})" if argument.name is not None else text)
        outputs = [each for each in arguments if each.output and each.value is not None]
        return "".join(f"{text}, " for text in texts), outputs

    def _unknown_block(self, name: str, path: str, arguments: Sequence[n.Argument]) -> bool:
        """Write the call of an unknown block, or of a function that is a statement."""
        unknown = self._library.unknown
        if unknown is None:
            return False
        enable, enabled, rest = _without_enabling(arguments)
        if len(rest) < len(arguments):
            with self._enabled(enable, enabled):
                return self._unknown_block(name, path, rest)
        unknown.names.setdefault(name)
        short = path.removeprefix(f"{self._scope.path}.").casefold()
        inputs, outputs = self._given(arguments)
        writer = self._translator.writer
        held = writer.temporary()
        writer.write(f"{held} = unknown_call({short!r}, {path!r}, {unknown.slot(path)}, ({inputs}))")
        for argument in outputs:
            assert argument.name is not None and argument.value is not None  # noqa: S101, PT018  # it is an output
            target = self._translator.place(argument.value)
            if not isinstance(target.type, t.ScalarType | t.OpaqueType):
                pin = argument.name.identifier
                raise SimulationError(
                    f"{name} is not known to the simulator, nor what its output {pin} has for members"
                )
            self._translator.note_write(target)
            pin = f"{short}.{argument.name.identifier.casefold()}"
            text = f"unknown_value({pin!r}, {held}, {self._library.linker.name(target.type, 'type')})"
            self._translator.write(target, ranged(text, target.type))
        return True

    def _is_standard(self, name: str, arguments: Sequence[n.Argument]) -> bool:
        """True if a function that the project does not have is a standard function, or called as none can be."""
        mark = self._translator.writer.mark()
        try:
            return self._functions.value(name, arguments, None) is not None
        except SimulationError:
            return True
        finally:
            self._translator.writer.rollback(mark)

    def _path_of(self, place: Place) -> str:
        """Return the path of the members of an instance of an undeclared type."""
        return f"{self._scope.path}.{place.path}" if place.key and not place.key.startswith("g") else place.path

    def _unknown(self, name: str) -> UnknownFunctionError:
        self._library.missing.setdefault(name, self._scope.path)
        return UnknownFunctionError(
            name,
            f"{name} is not known to the simulator",
            hint="Supply it: a function by --functions FILE.py (functions={..}), a function block as a POU.",
        )

    def _supplied(self, function: Any, node: n.Call) -> Code:
        arguments: list[str] = []
        named: list[str] = []
        for argument in node.arguments:
            if argument.output:
                raise SimulationError(f"{print_node(node.callee)} is supplied: it has no outputs but its result")
            if argument.value is not None:
                text = settled(self._translator.value(argument.value)).text
                name = argument.name.identifier.lower() if argument.name is not None else ""
                (named if name else arguments).append(f"**{{{name!r}: {text}}}" if name else text)
        name = self._library.linker.name(runtime.checked(function), "supplied")
        return Code(f"{name}({', '.join([*arguments, *named])})", t.ANY, acts=True)

    def _function(
        self, callee: Callee, node: n.Call, first: list[str], enter: Callable[..., Any] | None = None
    ) -> Code:
        """Return a call of a function or method: it has a frame of its own. `enter` finds out which one it is."""
        inputs, outputs, enable, enabled = self._sorted(callee.layout, callee.parameters, node.arguments)
        if enable is not None or enabled is not None:
            raise SimulationError(f"{callee.name} is called with EN or ENO inside an expression")
        given = dict(inputs)
        texts = [*first]
        for field in callee.parameters:
            argument = given.get(field)
            if argument is not None and argument.value is not None:
                texts.append(self._argument(field, argument.value, copied=True))
            elif field.direction is Direction.IN_OUT:
                raise SimulationError(f"{callee.name} is called without its parameter {field.name}")
            else:
                texts.append(self._translator.library.default(field.type) if field.late else field.initial)
        call = f"{self._library.linker.name(enter or callee.enter)}({', '.join(texts)})"
        result = callee.result
        type_: t.Type = result.type if result is not None else t.ANY

        def member(frame: str, field: Field | None) -> str:
            if field is None:
                return f"{frame}.layout"
            return f"{frame}.v[{field.slot}]" if enter is None else f"named({frame}, {field.name.casefold()!r})"

        if not outputs:
            return ranged(member(call, result), type_, acts=True)
        held = self._translator.writer.temporary()
        steps = [f"({held} := {call})"]
        for field, argument in outputs:
            steps.append(self._put_output(field, argument, member(held, field)))
        return ranged(f"({', '.join(steps)}, {member(held, result)})[-1]", type_, acts=True)

    def _put_output(self, field: Field, argument: n.Argument, text: str) -> str:
        target, code = self._output(field, argument, text)
        if not isinstance(target.type, t.ScalarType | t.ReferenceType | t.OpaqueType):
            return f"assign({target.text}, {code.text})"
        if target.bits is not None:
            raise SimulationError(f"{field.name} is written to a part of {target.path} inside an expression")
        return f"put({target.cells}, {target.index}, {code.text})"

    def _output(self, field: Field, argument: n.Argument, text: str) -> tuple[Place, Code]:
        assert argument.value is not None  # noqa: S101  # the caller has left out others
        code = ranged(text, field.type)
        if argument.negated:
            code = Code(f"(not {text})", t.BOOL)
        target = self._translator.place(argument.value, field.type)
        self._translator.note_write(target)
        return target, settled(self._translator.fitted(code, target.type))

    def _argument(self, field: Field, value: n.Expression, *, copied: bool) -> str:
        """Source of what a parameter gets."""
        if field.direction is Direction.IN_OUT:
            return self._reference(field, value)
        code = settled(self._translator.fitted(self._translator.value(value, field.type), field.type))
        aggregate = isinstance(field.type, t.StructureType | t.ArrayOf)
        return f"cloned({code.text})" if aggregate and copied else code.text

    def _reference(self, field: Field, value: n.Expression) -> str:
        place = self._translator.place(value, field.type)
        if place.bits is not None:
            raise SimulationError(f"a part of {place.path} cannot be passed to {field.name}, which is VAR_IN_OUT")
        if not _can_refer(field.type, place.type):
            raise SimulationError(f"{place.path}, a {place.type.name}, is passed to {field.name}: {field.type.name}")
        self._translator.note_read(place)
        if field.declared and not isinstance(field.type, t.OpaqueType):
            self._library.use.passed.setdefault(place.root, {}).setdefault(id(field), field)
        else:
            self._library.use.written.add(place.root)
        if isinstance(field.type, t.ScalarType | t.ReferenceType | t.OpaqueType):
            return f"Pointer({place.cells}, {place.index})"
        of_any_length = isinstance(field.type, t.ArrayOf) and not field.type.dimensions
        if of_any_length and isinstance(place.type, t.ArrayOf) and place.type.dimensions:
            return f"View({place.text}, {place.type.dimensions!r})"
        return place.text

    # -- arguments

    def _sorted(
        self, layout: Any, parameters: Sequence[Field], arguments: Sequence[n.Argument]
    ) -> tuple[list[_Given], list[_Given], n.Expression | None, n.Expression | None]:
        """Inputs and outputs with the variables that they are of, EN and ENO."""
        inputs: list[_Given] = []
        outputs: list[_Given] = []
        enable = enabled = None
        position = 0
        for argument in arguments:
            if argument.name is None:
                if position >= len(parameters):
                    raise SimulationError(f"{layout.name} is called with too many arguments")
                inputs.append((parameters[position], argument))
                position += 1
                continue
            name = argument.name.identifier
            field = layout.find(name)
            if field is None and name.upper() == "EN":
                enable = argument.value
            elif field is None and name.upper() == "ENO":
                enabled = argument.value
            elif field is None:
                raise SimulationError(f"{layout.name} has no parameter {name}")
            elif not argument.output and field.direction not in (Direction.INPUT, Direction.IN_OUT):
                raise SimulationError(f"{layout.name} has no input {name}")
            elif argument.value is not None:
                (outputs if argument.output else inputs).append((field, argument))
        return inputs, outputs, enable, enabled

    # -- as statements

    def statement(self, node: n.Expression) -> None:
        """Write a call that is a statement."""
        node = n.bare(node)
        arguments = node.arguments if isinstance(node, n.Call) else ()
        callee = n.bare(node.callee) if isinstance(node, n.Call) else node
        if self._acting(callee, arguments):
            return
        call = node if isinstance(node, n.Call) else n.Call(node)
        enable, enabled, rest = _without_enabling(arguments)
        if len(rest) == len(arguments):
            self._translator.writer.write(self.value(call, None).text)
            return
        with self._enabled(enable, enabled):
            self.statement(n.Call(call.callee, rest))

    @contextmanager
    def _enabled(self, enable: n.Expression | None, enabled: n.Expression | None) -> Iterator[None]:
        """Execute what is written inside if EN is TRUE; ENO tells that it was."""
        if enable is None and enabled is None:
            yield
            return
        writer = self._translator.writer
        held = writer.temporary()
        condition = self._translator.value(enable, t.BOOL).text if enable is not None else "True"
        writer.write(f"{held} = {condition}")
        with writer.block(f"if {held}:"):
            yield
        if enabled is not None:
            target = self._translator.place(enabled, t.BOOL)
            self._translator.note_write(target)
            self._translator.write(target, self._translator.fitted(Code(held, t.BOOL, 0, 1), target.type))

    def _acting(self, callee: n.Expression, arguments: tuple[n.Argument, ...]) -> bool:
        """Write the call of an action, an instance or a program; False: it is none."""
        if isinstance(callee, n.Name) and self._scope.unit is not None:
            action = self._scope.unit.action(callee.identifier)
            if action is not None and self._scope.lookup(callee.identifier) is None:
                _check_bare(callee.identifier, arguments)
                self._translator.writer.write(f"{self._library.linker.name(action)}({self._own_frame})")
                return True
        if isinstance(callee, n.Member):
            base = self._meant(callee.base)
            if isinstance(base, Place) and self._act_of(base, callee.name.identifier, arguments):
                return True
            if isinstance(base, Place) and self._method_of(base, callee) is not None:
                return False
        meaning = self._meant(callee, called=True)
        if isinstance(meaning, Place):
            if isinstance(meaning.type, t.OpaqueType):
                if self._unknown_block(meaning.type.name, self._path_of(meaning), arguments):
                    return True
                raise self._unknown(meaning.type.name)
            self._instance(meaning, arguments)
            return True
        if isinstance(meaning, Unknown) and self._library.unknown is not None:
            name = meaning.path.rpartition(".")[2]
            own = isinstance(callee, n.Name) and self._own_method(callee) is not None
            if not own and name.casefold() not in self._library.functions and not self._is_standard(name, arguments):
                return self._unknown_block(meaning.path, meaning.path, arguments)
        return False

    def _act_of(self, place: Place, name: str, arguments: tuple[n.Argument, ...]) -> bool:
        """Write ``instance.action()`` or what S7 calls on timers and counters: ``timer.TON(..)``."""
        if isinstance(place.type, t.OpaqueType):
            called = f"{place.type.name}.{name}"
            if self._unknown_block(called, f"{self._path_of(place)}", (*_method(name), *arguments)):
                return True
            raise self._unknown(called)
        if not isinstance(place.type, t.StructureType):
            return False
        unit = self._unit_of(place.type)
        action = unit.action(name) if unit is not None else None
        if action is not None:  # arguments are those of the instance whose action it is (CODESYS)
            self._call(place, place.type.layout, self._library.linker.name(action), arguments)
            return True
        block = self._library.block_of(place.type.layout)
        run = block.methods.get(name.upper()) if block is not None else None
        if run is None:
            return False
        self._call(place, place.type.layout, self._library.linker.name(run), arguments)
        return True

    def _instance(self, place: Place, arguments: tuple[n.Argument, ...]) -> None:
        type_ = place.type
        if not isinstance(type_, t.StructureType):
            raise SimulationError(f"{place.path} is a {type_.name}, which cannot be called")
        unit = self._unit_of(type_)
        block = self._library.block_of(type_.layout)
        called = self._translator.instances.get(place.path.casefold(), "")
        if unit is not None:
            run: Any = unit.run
        elif block is not None and called.upper() in block.methods:
            run = block.methods[called.upper()]
        elif block is not None and block.run is not None:
            run = block.run
        else:
            raise SimulationError(f"{place.path} is a {type_.name}, which cannot be called")
        self._call(place, type_.layout, self._library.linker.name(run), arguments)

    def _call(self, place: Place, layout: Any, run: str, arguments: tuple[n.Argument, ...]) -> None:
        parameters = [f for f in layout.fields if f.direction in (Direction.INPUT, Direction.IN_OUT) and not f.hidden]
        inputs, outputs, enable, enabled = self._sorted(layout, parameters, arguments)
        self._library.use.written.add(place.root)
        writer = self._translator.writer
        with self._enabled(enable, enabled):
            held = writer.temporary()
            writer.write(f"{held} = {place.text}")
            cells = writer.temporary() if inputs else ""
            if inputs:
                writer.write(f"{cells} = {held}.v")
            for field, argument in inputs:
                assert argument.value is not None  # noqa: S101  # others were left out
                text = self._argument(field, argument.value, copied=False)
                aggregate = isinstance(field.type, t.StructureType | t.ArrayOf)
                if aggregate and field.direction is not Direction.IN_OUT:
                    writer.write(f"assign({cells}[{field.slot}], {text})")
                else:
                    writer.write(f"{cells}[{field.slot}] = {text}")
            writer.write(f"{run}({held})")
            for field, argument in outputs:
                target, code = self._output(field, argument, f"{held}.v[{field.slot}]")
                self._translator.write(target, code)

    # -- what is called

    @property
    def _own_frame(self) -> str:
        return "this" if self._scope.around is not None else "f"

    def _meant(self, node: n.Expression, *, called: bool = False) -> Any:
        """Meaning of a name or path: of a program its only instance, of a reference of CODESYS its target."""
        found = self._translator.meaning(node, called=called)
        if isinstance(found, TranslatedPou) and found.is_program:
            found = self._library.program(found)
        return self._translator.followed(found, None) if isinstance(found, Place) else found

    def _called(self, name: n.Name) -> Any:
        """Meaning of a name that is called: in a function its own name is that of its result, too."""
        unit = self._scope.unit
        if unit is not None and unit.is_function and unit.name.casefold() == name.identifier.casefold():
            return unit
        return self._scope.resolve(name, called=True)

    def _method_of(self, place: Place, callee: n.Member) -> TranslatedMethod | None:
        """Return the method that ``instance.name`` means; a variable of the name comes first."""
        unit = self._unit_of(place.type)
        if unit is None or unit.layout.find(callee.name.identifier) is not None:
            return None
        return unit.method(callee.name.identifier)

    def _own_method(self, name: n.Name) -> TranslatedMethod | None:
        return self._scope.unit.method(name.identifier) if self._scope.unit is not None else None

    def _unit_of(self, type_: t.Type) -> TranslatedPou | None:
        return self._library.unit_of_layout(type_.layout) if isinstance(type_, t.StructureType) else None


def _without_enabling(
    arguments: Sequence[n.Argument],
) -> tuple[n.Expression | None, n.Expression | None, tuple[n.Argument, ...]]:
    """Return EN, ENO, and the other arguments."""
    known = {a.name.identifier.upper(): a for a in arguments if a.name is not None and a.value is not None}
    enable, enabled = known.get("EN"), known.get("ENO")
    rest = tuple(a for a in arguments if a is not enable and a is not enabled)
    return enable.value if enable else None, enabled.value if enabled else None, rest


def _method(name: str) -> tuple[n.Argument, ...]:
    """Key that tells calls of several methods of an instance apart."""
    return (n.Argument(n.Literal(f"'{name.casefold()}'")),)


def _check_bare(name: str, arguments: Sequence[n.Argument]) -> None:
    if arguments:
        raise SimulationError(f"{name} is an action: it has no parameters")


def _can_refer(parameter: t.Type, type_: t.Type) -> bool:
    """True if a variable of a type can be passed to a VAR_IN_OUT: it has the same values, or more members."""
    if isinstance(parameter, t.OpaqueType) or isinstance(type_, t.OpaqueType):
        return True
    if isinstance(parameter, t.ScalarType):
        if not isinstance(type_, t.ScalarType):
            return False
        numbers = parameter.is_number and type_.is_number and t.Family.REAL not in (parameter.family, type_.family)
        same = parameter.family is type_.family or numbers
        return same and (parameter.least, parameter.greatest, parameter.bits) == (
            type_.least,
            type_.greatest,
            type_.bits,
        )
    if isinstance(parameter, t.StructureType):
        if not isinstance(type_, t.StructureType):
            return False
        members = parameter.layout.fields
        return parameter.layout is type_.layout or members == type_.layout.fields[: len(members)]
    if isinstance(parameter, t.ArrayOf):
        if not isinstance(type_, t.ArrayOf) or not _can_refer(parameter.base, type_.base):
            return False
        return not parameter.dimensions or parameter.size == type_.size
    return isinstance(type_, t.ReferenceType)
