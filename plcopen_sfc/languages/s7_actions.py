"""Calls of actions in texts of SCL: S7 has no actions, so their statements take the place of the calls.

An action has no parameters and no variables of its own. Its statements do the same wherever they are, as long as their
names mean the same: those of the block get the path of the instance whose action is called. CODESYS has arguments in
such calls as well; they are assignments to inputs of the instance, before the statements (CODESYS V3, seen in
exports)::

    #Gripper.Release(Slow := TRUE);      #Gripper.Slow := TRUE;
                                         // action Release of #Gripper
                                         #Gripper.Valve := FALSE;

Methods become functions (`method_calls`).

Calls of timers and counters pass the start values that their instances cannot have in S7 (`s7_start_values`).
"""

from __future__ import annotations

import re
from collections.abc import Callable

from plcopen_sfc.languages.binding.text_sites import Site, TextSite
from plcopen_sfc.languages.method_calls import InlinedText, MethodCalls, NoStatementsError
from plcopen_sfc.languages.networks import body_statements
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
from plcopen_sfc.model.variables import SectionKind, sections_of

_MOST_CHARACTERS = 100_000
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


class ActionCalls(MethodCalls):
    """Puts the statements of the actions of a project in SCL in the place of calls of them.

    Calls of methods are those of functions. `reached` has the ids of actions as well.
    """

    def __init__(self, project: Project) -> None:
        super().__init__(project, Dialect.SCL)
        self.call_of_chart: Callable[[Pou, Action], str | None] = lambda _owner, _action: None
        """Returns the statement that executes the chart of an action once; None where there is none."""
        self.starts = InstanceStarts(project)
        self._names = self._methods | {action.name.casefold() for pou in project.pous for action in pou.actions}
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
        found = self.without_methods(text, site)
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
            except NoStatementsError as error:
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
            raise NoStatementsError("it is no action of a block")
        if any(action is each for each in around):
            raise NoStatementsError("it calls itself")
        path = self._path(callee, text)
        inner = self._inline(self._code(action, owner), Site(pou=owner, place=owner.place), (*around, action))
        if inner.problems:
            raise NoStatementsError(inner.problems[0])
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
            raise NoStatementsError("its chart is no block of its own")
        return call

    def _at(self, text: str, owner: Pou, path: str) -> str:
        """Return statements of a block as others write them that have an instance of it."""
        interface = owner.interface
        known = {
            v.name.casefold(): (section.kind, section.constant or section.kind is SectionKind.CONSTANT, v)
            for section in sections_of(interface)
            for v in section.variables
        }
        edits: list[Edit] = []
        for token in tokenize(text, Dialect.SCL).tokens:
            if not token.value.startswith("#"):
                continue
            name = token.value[1:].strip('"')
            kind, constant, variable = known.get(name.casefold(), (None, False, None))
            if kind in _UNSEEN:
                raise NoStatementsError(f"it uses {name}, {_UNSEEN[kind]} of {owner.name}")
            new = f"{path}.{token.value[1:]}"
            if constant and variable is not None:
                new = _constant(variable)
            edits.append(Edit(*token.span, new))
        return apply_edits(text, edits)


def _constant(variable: Variable) -> str:
    """Return the value of a constant, which other blocks cannot name."""
    if not isinstance(variable.initial, SimpleValue) or not variable.initial.text:
        raise NoStatementsError(f"it uses {variable.name}, a constant without a plain value")
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
            raise NoStatementsError("its network is no list of statements")
        return print_node(drawn.tree)
    if not isinstance(body, StBody):
        raise NoStatementsError(f"it is a body in {body.language}")
    parsed = parse_statements(body.text, Dialect.SCL)
    if parsed.problems:
        raise NoStatementsError("its text cannot be read")
    for node in walk(parsed.tree):
        if isinstance(node, n.ReturnStatement):
            raise NoStatementsError("it ends with RETURN, which would end what calls it too")
        if isinstance(node, n.LabelStatement | n.Goto):
            raise NoStatementsError("it has jumps")
    return body.text


def _arguments(call: n.Expression, path: str, text: str) -> tuple[list[str], list[str]]:
    """Return the assignments of arguments before and after the statements of an action."""
    before: list[str] = []
    after: list[str] = []
    for argument in call.arguments if isinstance(call, n.Call) else ():
        if argument.name is None:
            raise NoStatementsError("it has an argument without a name")
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
