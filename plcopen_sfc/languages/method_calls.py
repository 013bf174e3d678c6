"""Calls of methods as calls of functions that get the variables of the block, for tools without methods.

A method has parameters and variables of its own, and sees those of its block. A function sees its parameters alone::

    n := Gripper.Lift(height := 3);      n := Gripper_Lift(Valve := Gripper.Valve, height := 3);
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest

from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.name_scopes import parameters_of
from plcopen_sfc.languages.binding.name_sites import named
from plcopen_sfc.languages.binding.text_sites import Site
from plcopen_sfc.languages.declarations.attributes import acting_attributes, typed_attributes
from plcopen_sfc.languages.declarations.kept_texts import bases_of, kept, names_of_bases
from plcopen_sfc.languages.effects import Path, path_of
from plcopen_sfc.languages.s7_programs import names_of_programs
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, walk
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Method, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import SimpleValue, Variable
from plcopen_sfc.model.variables import PASSED, Interface, SectionKind, VariableSection, sections_of

_START = "fb_init"
_IMPLICIT = frozenset({_START, "fb_reinit", "fb_exit"})
"""Methods that CODESYS calls by itself."""
_AFTER_START = "call_after_init"
"""The attribute of a block, and of a method that CODESYS calls when all variables have their start values."""
_NO_FUNCTIONS = "it is no function here"
_ITSELF = frozenset({"this^", "super^"})
"""Paths by which a block names itself: the methods and variables of its base are its own."""


@dataclass(frozen=True, slots=True)
class MethodFunction:
    """The function for a method: its name, the parameters of the method, and the variables of the block it gets."""

    name: str
    parameters: list[Variable]
    outputs: frozenset[str]
    around: list[str]


def called_at_start(pou: Pou) -> list[Method]:
    """Return the methods of a block that CODESYS calls by itself when an instance is made, in their order.

    FB_Init comes first; those with the attribute ``call_after_init`` follow, if the block has it too. In a project of
    another tool nothing calls them.
    """
    first = [method for method in pou.methods if method.name.casefold() == _START]
    later = [method for method in pou.methods if _has_attribute(method)] if _has_attribute(pou) else []
    return first + later


def _has_attribute(thing: Pou | Method) -> bool:
    declaration = thing.interface.declaration if thing.interface is not None else None
    return _AFTER_START in acting_attributes(thing, typed_attributes(declaration).get("", ()))


KEPT_IN_METHODS = frozenset({"VAR_INST", "VAR_STAT"})
"""Sections of a method whose variables keep their values from call to call."""


def without_function(
    owner: Pou, method: Method, pous: Mapping[str, Pou], declared: Callable[[Pou], Pou] = lambda pou: pou
) -> str:
    """Return why no function can be called in the place of a method of `owner`, whatever it does; empty: one may.

    `pous` are those of `bases_of`; `declared` gives each as its tool declares it, where it keeps that in another form.
    """
    as_declared = declared(owner)
    starting = {each.name for each in called_at_start(as_declared)}
    if method.name.casefold() in _IMPLICIT or method.name in starting:
        return "its tool calls it when an instance is made or goes"
    sections = (s for each in as_declared.methods if each.name == method.name for s in sections_of(each.interface))
    if any(kept(section.extension_data).get("keyword") in KEPT_IN_METHODS for section in sections):
        return "its variables keep their values"
    key, around = method.name.casefold(), owner.name.casefold()
    for pou in pous.values():
        has_one = any(each.name.casefold() == key for each in pou.methods)
        if has_one and any(
            base.name.casefold() == around for base in bases_of(pou, pous, lambda each: names_of_bases(declared(each)))
        ):
            return f"{pou.name} has a method {method.name} too, and only the running program tells which one is called"
    return ""


def function_of_method(
    name: str, method: Method, around: Sequence[VariableSection]
) -> tuple[Interface, MethodFunction]:
    """Return the interface of the function `name` for a method, and what calls of it pass.

    It has the sections `around`, with the variables of its block that it uses, before those of the method.
    """
    interface = method.interface or Interface()
    sections = [section.model_copy(deep=True) for section in interface.sections if section.variables]
    parameters = parameters_of(interface)
    for variable in (v for section in sections if section.kind in PASSED for v in section.variables):
        variable.initial = None  # each call passes it
    outputs = frozenset(v.name.casefold() for s in sections if s.kind is SectionKind.OUTPUT for v in s.variables)
    passed = [v.name for section in around if section.kind in PASSED for v in section.variables]
    filled = Interface(sections=[*around, *sections], return_type=interface.return_type)
    return filled, MethodFunction(name, parameters, outputs, passed)


def passed_in_out(tree: n.Node, called: Mapping[Path, object]) -> Iterator[str]:
    """Yield the variables that a tree passes to in-out parameters of what it calls; `called` is that by its path."""
    for call in walk(tree):
        block = called.get(path_of(call.callee)) if isinstance(call, n.Call) else None
        if not isinstance(call, n.Call) or not isinstance(block, Pou):
            continue
        changed = {variable.name.casefold() for variable in block.variables(SectionKind.IN_OUT)}
        for argument in call.arguments:
            is_changed = argument.name is None or argument.name.identifier.casefold() in changed
            if changed and is_changed and argument.value is not None and (path := path_of(argument.value)):
                yield path[0]


class NoStatementsError(Exception):
    """No statements do what a call does."""


@dataclass(slots=True)
class InlinedText:
    """A text without calls of actions and methods: `text`, those that it called, and why a call is still there.

    `started` are the instances whose calls pass start values.
    """

    text: str
    called: list[str] = field(default_factory=list)
    methods: list[str] = field(default_factory=list)
    started: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


class MethodCalls:
    """Puts calls of functions in the place of calls of the methods of a project, in texts of a dialect."""

    def __init__(self, project: Project, dialect: Dialect) -> None:
        self.function_of_method: Callable[[Pou, Method, str], MethodFunction | str] = lambda *_: _NO_FUNCTIONS
        """Returns the function for a method of an instance, by its path; a reason where there is none."""
        self.reached: set[int] = set()
        """Ids of the methods in whose place a function is called."""
        self._dialect = dialect
        self._resolver = Resolver(project, dialect)
        self._methods = frozenset(method.name.casefold() for pou in project.pous for method in pou.methods)
        self._programs: dict[str, Pou] = {}
        if dialect is Dialect.SCL:
            called = [pou for pou in project.pous if pou.actions or pou.methods]
            programs = names_of_programs(project) if called else {}
            self._programs = {programs[pou.name].casefold(): pou for pou in called if pou.name in programs}

    def without_methods(self, text: str, site: Site, *, is_condition: bool = False) -> InlinedText:
        """Return a text with calls of functions in place of those of methods, the inner ones first."""
        # a call inside the arguments of another one is replaced first: the span of the outer one changes with it
        found = InlinedText(text)
        while any(name in found.text.casefold() for name in self._methods) and not found.problems:
            edits: list[Edit] = []
            for span, call, declaration in self._innermost(found.text, site, is_condition):
                shown = found.text[slice(*(call.callee.span or span))]
                try:
                    edits.append(Edit(*span, self._function_call(declaration, call, found.text)))
                except NoStatementsError as error:
                    found.problems.append(f"{shown}: {error}")
                else:
                    found.methods.append(shown)
            if not edits:
                break
            found.text = apply_edits(found.text, edits)
        return found

    def _innermost(
        self, text: str, site: Site, is_condition: bool
    ) -> list[tuple[tuple[int, int], n.Call, Declaration]]:
        """Return the calls of methods in a text that have no others among their arguments, with their places."""
        tree: n.Node = (
            parse_expression(text, self._dialect).tree if is_condition else parse_statements(text, self._dialect).tree
        )
        found: list[tuple[tuple[int, int], n.Call, Declaration]] = []
        for call in walk(tree):
            if isinstance(call, n.Call) and call.span is not None:
                declaration = self._declaration(call.callee, site)
                if declaration is not None and declaration.kind is Kind.METHOD:
                    found.append((call.span, call, declaration))
        spans = [span for span, _, _ in found]
        return [
            (own, call, declaration)
            for own, call, declaration in found
            if not any(own[0] <= start and end <= own[1] and (start, end) != own for start, end in spans)
        ]

    def _function_call(self, declaration: Declaration, call: n.Call, text: str) -> str:
        """Return the call of a function that does what a call of a method does."""
        method, owner = declaration.holder, declaration.pou
        if not isinstance(method, Method) or owner is None:
            raise NoStatementsError("it is no method of a block")
        path = self._path(call.callee, text)
        function = self.function_of_method(owner, method, path)
        if isinstance(function, str):
            raise NoStatementsError(function)
        passed = {name.casefold(): f"{name} := {self._variable(path, name)}" for name in function.around}
        known = {parameter.name.casefold(): parameter.name for parameter in function.parameters}
        for argument, by_place in zip_longest(call.arguments, [*known.values()][: len(call.arguments)]):
            name = argument.name.identifier if argument.name is not None else by_place
            if name is None or name.casefold() not in known:
                raise NoStatementsError(f"it has no parameter for {name or 'all that is passed'}")
            if argument.value is None or argument.value.span is None or argument.negated:
                raise NoStatementsError(f"nothing is passed to {name}, or something negated")
            sign = "=>" if name.casefold() in function.outputs else ":="
            passed[name.casefold()] = f"{name} {sign} {text[slice(*argument.value.span)]}"
        for parameter in function.parameters:
            name = parameter.name
            if name.casefold() not in passed and name.casefold() not in function.outputs:
                if not isinstance(parameter.initial, SimpleValue) or not parameter.initial.text:
                    raise NoStatementsError(f"nothing is passed to {name}")
                passed[name.casefold()] = f"{name} := {parameter.initial.text}"
        self.reached.add(id(method))
        called = f'"{function.name}"' if self._dialect is Dialect.SCL else function.name
        return f"{called}({', '.join(passed.values())})"

    def _variable(self, path: str, name: str) -> str:
        if path:
            return f"{path}.{name}"
        return f"#{name}" if self._dialect is Dialect.SCL else name

    def _declaration(self, callee: n.Expression, site: Site) -> Declaration | None:
        """Return the declaration of what an expression calls; None where it is not known."""
        program = self._program(callee.base) if isinstance(callee, n.Member) else None
        if program is not None and isinstance(callee, n.Member):
            return self._resolver.member(program, callee.name.identifier).declaration
        return self._resolver.called(callee, site)

    def _path(self, callee: n.Expression, text: str) -> str:
        """Return the path of the instance whose action or method is called; empty for the block itself."""
        for part in walk(callee):
            if isinstance(part, n.Index) and not all(map(_stays, part.indices)):
                raise NoStatementsError("the index of the instance may change while its action is executed")
        head = callee
        while isinstance(head, n.Member):
            head = head.base
        if isinstance(callee, n.Member) and isinstance(head, n.Name) and self._is_type(head):
            raise NoStatementsError(f"{head.identifier} is a block without a data block of its own")
        if not isinstance(callee, n.Member) or callee.base.span is None:
            return ""
        path = text[slice(*callee.base.span)]
        return "" if path.replace(" ", "").casefold() in _ITSELF else path

    def _program(self, base: n.Expression) -> Pou | None:
        """Return the program whose instance data block an expression names."""
        is_global = isinstance(base, n.Name) and base.quoting is n.Quoting.GLOBAL
        return self._programs.get(base.identifier.casefold()) if is_global else None  # type: ignore[union-attr]

    def _is_type(self, name: n.Name) -> bool:
        """True for the name of a block, which is no instance."""
        found = self._resolver.lookup(named(name), Site()).declaration if name.quoting is n.Quoting.GLOBAL else None
        return found is not None and found.kind is Kind.POU


def _stays(index: n.Expression) -> bool:
    """True for an index that statements of another block do not change: without calls and global variables."""
    return not any(
        isinstance(part, n.Call) or (isinstance(part, n.Name) and part.quoting is n.Quoting.GLOBAL)
        for part in walk(index)
    )
