"""Calls of actions in texts of SCL: S7 has no actions, so their statements take the place of the calls.

An action has no parameters and no variables of its own. Its statements do the same wherever they are, as long as their
names mean the same: those of the block get the path of the instance whose action is called. CODESYS has arguments in
such calls as well; they are assignments to inputs of the instance, before the statements (CODESYS V3, seen in
exports)::

    #Gripper.Release(Slow := TRUE);      #Gripper.Slow := TRUE;
                                         // action Release of #Gripper
                                         #Gripper.Valve := FALSE;

A method has parameters and variables of its own. It becomes a function that gets the variables of the block, too::

    #n := #Gripper.Lift(height := 3);    #n := "Gripper_Lift"(Valve := #Gripper.Valve, height := 3);

Calls of timers and counters pass the start values that their instances cannot have in S7 (`s7_start_values`).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import zip_longest

from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.name_sites import named
from plcopen_sfc.languages.binding.text_sites import Site, TextSite
from plcopen_sfc.languages.networks import body_statements
from plcopen_sfc.languages.s7_programs import names_of_programs
from plcopen_sfc.languages.s7_start_values import InstanceStarts
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, print_node, walk
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Method, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcBody, Step
from plcopen_sfc.model.types import SimpleValue, Variable
from plcopen_sfc.model.variables import SectionKind

_MOST_CHARACTERS = 100_000
_NO_FUNCTIONS = "it is no function here"
_INDENT = "    "
_OPENS = re.compile(r"\b(?:THEN|ELSE|DO|OF|REPEAT)\b|:(?!=)", re.IGNORECASE)
"""Words that statements are in, where they begin in the same line."""
_PLAIN = re.compile(r"[\w#.:]+|'[^']*'")
_UNSEEN = {
    SectionKind.TEMP: "a temporary variable",
    SectionKind.IN_OUT: "an in-out parameter",
    SectionKind.EXTERNAL: "an external variable",
}
"""Variables of a block that no other block reaches."""


@dataclass(frozen=True, slots=True)
class MethodFunction:
    """The function for a method: its name, the parameters of the method, and the variables of the block it gets."""

    name: str
    parameters: list[Variable]
    outputs: frozenset[str]
    around: list[str]


class _NoStatementsError(Exception):
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


class ActionCalls:
    """Puts the statements of the actions of a project in SCL in the place of calls of them."""

    def __init__(self, project: Project) -> None:
        self.call_of_chart: Callable[[Pou, Action], str | None] = lambda _owner, _action: None
        """Returns the statement that executes the chart of an action once; None where there is none."""
        self.function_of_method: Callable[[Pou, Method], MethodFunction | str] = lambda _owner, _method: _NO_FUNCTIONS
        """Returns the function for a method; a reason where there is none."""
        self.reached: set[int] = set()
        """Ids of the actions whose statements are in the place of a call."""
        self.starts = InstanceStarts(project)
        self._resolver = Resolver(project, Dialect.SCL)
        self._methods = frozenset(method.name.casefold() for pou in project.pous for method in pou.methods)
        self._names = self._methods | {action.name.casefold() for pou in project.pous for action in pou.actions}
        programs = names_of_programs(project) if self._names else {}
        called = [pou for pou in project.pous if pou.actions or pou.methods]
        self._programs = {programs[pou.name].casefold(): pou for pou in called if pou.name in programs}
        self._inlined: dict[tuple[int, int, str], InlinedText] = {}

    def inlined(self, text: str, pou: Pou, method: Method | None = None) -> InlinedText:
        """Return a text of `pou`, or of its `method`, without calls of actions and methods, where there are such.

        Statements are in place of actions, calls of functions in place of methods.
        """
        if not self._names and not self.starts.of(pou):
            return InlinedText(text)
        key = (id(pou), id(method), text)
        if key not in self._inlined:
            self._inlined[key] = self._inline(text, Site(pou=pou, place=pou.place, method=method), ())
        return self._inlined[key]

    def body(self, body: Body, pou: Pou) -> Body:
        """Return a body of `pou` without calls of actions, as far as statements do the same; itself if it has none."""
        if not isinstance(body, StBody):
            return body
        found = self.inlined(body.text, pou)
        return body if found.text == body.text else StBody(text=found.text)

    def is_replaced(self, text_site: TextSite) -> bool:
        """True for a text in which statements are in place of all calls of actions, and for actions of steps."""
        site = text_site.site
        if isinstance(text_site.holder, Step | ActionAssociation):
            return True  # the report tells each of them at its step
        if not isinstance(text_site.holder, StBody) or site.pou is None or site.method is not None:
            return False
        return not self.inlined(text_site.text, site.pou).problems

    def _inline(self, text: str, site: Site, around: tuple[Action, ...]) -> InlinedText:
        parsed = parse_statements(text, Dialect.SCL)
        if parsed.problems:
            is_suspect = any(name in text.casefold() for name in self._names)
            return InlinedText(text, problems=["the text cannot be read"] if is_suspect else [])
        started: list[str] = []
        if site.pou is not None:
            text, started = self.starts.completed(text, site.pou)
        found = self._without_methods(text, site)
        found.started = started
        if found.methods or started:
            text = found.text
            parsed = parse_statements(text, Dialect.SCL)
        edits: list[Edit] = []
        for statement in walk(parsed.tree):
            if not isinstance(statement, n.CallStatement) or statement.span is None:
                continue
            callee = statement.call.callee if isinstance(statement.call, n.Call) else statement.call
            declaration = self._declaration(callee, site)
            if declaration is None or declaration.kind is not Kind.ACTION:
                continue
            shown = text[slice(*callee.span)] if callee.span is not None else declaration.name
            start, end = statement.span
            try:
                statements = self._statements(declaration, callee, statement.call, text, around)
            except _NoStatementsError as error:
                found.problems.append(f"{shown}: {error}")
                continue
            end += len(text[end:]) - len(text[end:].lstrip(" ").removeprefix(";"))
            found.called.append(shown)
            least = edits[-1].end if edits else 0
            edits.append(_edit(statements, text, (least, start, end)))
        found.text = apply_edits(text, edits)
        if len(found.text) > _MOST_CHARACTERS:
            return InlinedText(text, problems=["with the statements of its actions it is too long"])
        return found

    def _without_methods(self, text: str, site: Site) -> InlinedText:
        """Return a text with calls of functions in place of those of methods, the inner ones first."""
        found = InlinedText(text)
        while any(name in found.text.casefold() for name in self._methods) and not found.problems:
            edits: list[Edit] = []
            for span, call, declaration in self._innermost(found.text, site):
                shown = found.text[slice(*(call.callee.span or span))]
                try:
                    edits.append(Edit(*span, self._function_call(declaration, call, found.text)))
                except _NoStatementsError as error:
                    found.problems.append(f"{shown}: {error}")
                else:
                    found.methods.append(shown)
            if not edits:
                break
            found.text = apply_edits(found.text, edits)
        return found

    def _innermost(self, text: str, site: Site) -> list[tuple[tuple[int, int], n.Call, Declaration]]:
        """Return the calls of methods in a text that have no others among their arguments, with their places."""
        found: list[tuple[tuple[int, int], n.Call, Declaration]] = []
        for call in walk(parse_statements(text, Dialect.SCL).tree):
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
            raise _NoStatementsError("it is no method of a block")
        function = self.function_of_method(owner, method)
        if isinstance(function, str):
            raise _NoStatementsError(function)
        path = self._path(call.callee, text)
        passed = {
            name.casefold(): f"{name} := {path}.{name}" if path else f"{name} := #{name}" for name in function.around
        }
        known = {parameter.name.casefold(): parameter.name for parameter in function.parameters}
        for argument, by_place in zip_longest(call.arguments, [*known.values()][: len(call.arguments)]):
            name = argument.name.identifier if argument.name is not None else by_place
            if name is None or name.casefold() not in known:
                raise _NoStatementsError(f"it has no parameter for {name or 'all that is passed'}")
            if argument.value is None or argument.value.span is None or argument.negated:
                raise _NoStatementsError(f"nothing is passed to {name}, or something negated")
            sign = "=>" if name.casefold() in function.outputs else ":="
            passed[name.casefold()] = f"{name} {sign} {text[slice(*argument.value.span)]}"
        for parameter in function.parameters:
            name = parameter.name
            if name.casefold() not in passed and name.casefold() not in function.outputs:
                if not isinstance(parameter.initial, SimpleValue) or not parameter.initial.text:
                    raise _NoStatementsError(f"nothing is passed to {name}")
                passed[name.casefold()] = f"{name} := {parameter.initial.text}"
        self.reached.add(id(method))
        return f'"{function.name}"({", ".join(passed.values())})'

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
                raise _NoStatementsError("the index of the instance may change while its action is executed")
        head = callee
        while isinstance(head, n.Member):
            head = head.base
        if isinstance(callee, n.Member) and isinstance(head, n.Name) and self._is_type(head):
            raise _NoStatementsError(f"{head.identifier} is a block without a data block of its own")
        return text[slice(*callee.base.span)] if isinstance(callee, n.Member) and callee.base.span is not None else ""

    def _program(self, base: n.Expression) -> Pou | None:
        """Return the program whose instance data block an expression names."""
        is_global = isinstance(base, n.Name) and base.quoting is n.Quoting.GLOBAL
        return self._programs.get(base.identifier.casefold()) if is_global else None  # type: ignore[union-attr]

    def _is_type(self, name: n.Name) -> bool:
        """True for the name of a block, which is no instance."""
        found = self._resolver.lookup(named(name), Site()).declaration if name.quoting is n.Quoting.GLOBAL else None
        return found is not None and found.kind is Kind.POU

    def _statements(
        self,
        declaration: Declaration,
        callee: n.Expression,
        call: n.Expression,
        text: str,
        around: tuple[Action, ...],
    ) -> str:
        """Return the statements in place of a call of an action."""
        action, owner = declaration.holder, declaration.pou
        if not isinstance(action, Action) or owner is None:
            raise _NoStatementsError("it is no action of a block")
        if any(action is each for each in around):
            raise _NoStatementsError("it calls itself")
        path = self._path(callee, text)
        inner = self._inline(self._code(action, owner), Site(pou=owner, place=owner.place), (*around, action))
        if inner.problems:
            raise _NoStatementsError(inner.problems[0])
        before, after = _arguments(call, path, text)
        code = self._at(inner.text, owner, path) if path else inner.text
        self.reached.add(id(action))
        of = f" of {path}" if path else ""
        is_empty = not parse_statements(code, Dialect.SCL).tree.statements  # TIA Portal wants a statement in a branch
        lines = [*before, f"// action {action.name}{of}", *([code.strip("\r\n")] if code.strip() else [])]
        lines += [*([";"] if is_empty else []), *after]
        return "\n".join(lines)

    def _code(self, action: Action, owner: Pou) -> str:
        """Return the statements of an action."""
        if not isinstance(action.body, SfcBody):
            return _code(action)
        call = self.call_of_chart(owner, action)
        if call is None:
            raise _NoStatementsError("its chart is no block of its own")
        return call

    def _at(self, text: str, owner: Pou, path: str) -> str:
        """Return statements of a block as others write them that have an instance of it."""
        interface = owner.interface
        known = {
            v.name.casefold(): (section.kind, section.constant or section.kind is SectionKind.CONSTANT, v)
            for section in (interface.sections if interface is not None else ())
            for v in section.variables
        }
        edits: list[Edit] = []
        for token in tokenize(text, Dialect.SCL).tokens:
            if not token.value.startswith("#"):
                continue
            name = token.value[1:].strip('"')
            kind, constant, variable = known.get(name.casefold(), (None, False, None))
            if kind in _UNSEEN:
                raise _NoStatementsError(f"it uses {name}, {_UNSEEN[kind]} of {owner.name}")
            new = f"{path}.{token.value[1:]}"
            if constant and variable is not None:
                new = _constant(variable)
            edits.append(Edit(*token.span, new))
        return apply_edits(text, edits)


def _stays(index: n.Expression) -> bool:
    """True for an index that statements of another block do not change: without calls and global variables."""
    return not any(
        isinstance(part, n.Call) or (isinstance(part, n.Name) and part.quoting is n.Quoting.GLOBAL)
        for part in walk(index)
    )


def _constant(variable: Variable) -> str:
    """Return the value of a constant, which other blocks cannot name."""
    if not isinstance(variable.initial, SimpleValue) or not variable.initial.text:
        raise _NoStatementsError(f"it uses {variable.name}, a constant without a plain value")
    value = variable.initial.text
    return value if _PLAIN.fullmatch(value) else f"({value})"


def _code(action: Action) -> str:
    """Return the statements of an action."""
    body = action.body
    if body is None:
        return ""
    if isinstance(body, FbdBody | LdBody):
        drawn = body_statements(body, Dialect.SCL)
        if drawn.obstacles or drawn.helpers or drawn.open_ends:
            raise _NoStatementsError("its network is no list of statements")
        return print_node(drawn.tree)
    if not isinstance(body, StBody):
        raise _NoStatementsError(f"it is a body in {body.language}")
    parsed = parse_statements(body.text, Dialect.SCL)
    if parsed.problems:
        raise _NoStatementsError("its text cannot be read")
    for node in walk(parsed.tree):
        if isinstance(node, n.ReturnStatement):
            raise _NoStatementsError("it ends with RETURN, which would end what calls it too")
        if isinstance(node, n.LabelStatement | n.Goto):
            raise _NoStatementsError("it has jumps")
    return body.text


def _arguments(call: n.Expression, path: str, text: str) -> tuple[list[str], list[str]]:
    """Return the assignments of arguments before and after the statements of an action."""
    before: list[str] = []
    after: list[str] = []
    for argument in call.arguments if isinstance(call, n.Call) else ():
        if argument.name is None:
            raise _NoStatementsError("it has an argument without a name")
        if argument.value is None or argument.value.span is None:
            continue
        member = f"{path}.{argument.name.identifier}" if path else f"#{argument.name.identifier}"
        value = text[slice(*argument.value.span)]
        if argument.output:
            after.append(f"{value} := {'NOT ' if argument.negated else ''}{member};")
        else:
            before.append(f"{member} := {value};")
    return before, after


def _edit(statements: str, text: str, place: tuple[int, int, int]) -> Edit:
    """Return the edit that puts statements into lines of their own; `place`: the least place, the start and the end."""
    least, start, end = place
    line = text[text.rfind("\n", 0, start) + 1 : start]
    indent = line[: len(line) - len(line.lstrip())]
    inner, before = indent, ""
    if line.strip():  # behind THEN or another statement
        inner = indent + _INDENT if _OPENS.search(line) else indent
        start = max(least, start - len(line) + len(line.rstrip()))
        # an edit right before this one ends with a new line
        before = f"\n{inner}" if start > least or not least else inner.removeprefix(indent)
    rest = text[end:].partition("\n")[0]
    after = "" if not rest.strip() else f"\n{indent}"
    end += len(rest) - len(rest.lstrip()) if after else 0
    lines = statements.replace("\r\n", "\n").split("\n")
    return Edit(start, end, before + "\n".join(lines).replace("\n", f"\n{inner}") + after)
