"""Texts, drawings and names of actions, read for lowering: what is not understood completely is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import NoReturn

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.binding.compile_mistakes import type_mistakes
from plcopen_sfc.languages.binding.name_resolution import Resolver, Untyped
from plcopen_sfc.languages.binding.name_sites import named
from plcopen_sfc.languages.binding.text_sites import Role, Site
from plcopen_sfc.languages.il import statements as instruction_statements
from plcopen_sfc.languages.networks import (
    Helper,
    NetworkExpression,
    NetworkText,
    body_statements,
    chart_statements,
    condition_reader,
)
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, walk
from plcopen_sfc.lowering.code.boolean_logic import FALSE, TRUE
from plcopen_sfc.lowering.reading.chart_source import ConditionText
from plcopen_sfc.model import types as t
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.declaration import Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, Condition, SfcNetwork


class ActionTargets:
    """Kinds of the targets of a POU's actions; see `plcopen_sfc.semantics.charts.transition_firing`."""

    def __init__(self, pou: Pou, project: Project | None, dialect: Dialect) -> None:
        self._site = Site(pou, place=pou.place)
        self._project = project if project is not None else Project(pous=[pou])
        self._dialect = dialect

    @cached_property
    def _resolver(self) -> Resolver:
        return Resolver(self._project, self._dialect)

    def is_called(self, target: n.Expression) -> bool:
        """Return True if it is an instance, a program, or an action of one. An undeclared name is a variable."""
        if isinstance(target, n.Member):
            base = self._resolver.type_of(target.base, self._site, target.name.identifier)
            if base in (Untyped.FOREIGN, Untyped.ELSEWHERE):
                return False  # an output of a standard block, or of one of a library
            meaning = self._resolver.member(base, target.name.identifier)
            if meaning.declaration is None:
                return base is not Untyped.UNKNOWN
        elif isinstance(target, n.Name):
            meaning = self._resolver.lookup(named(target, role=Role.ACTION), self._site)
            if meaning.declaration is None:
                return False
        else:
            return False
        declaration = meaning.declaration
        if declaration.kind in (Kind.ACTION, Kind.METHOD):
            return True
        type_ = self._resolver.type_of_declaration(declaration)
        return isinstance(type_, Pou) or (declaration.kind is Kind.VARIABLE and type_ is Untyped.FOREIGN)

    def is_boolean(self, target: n.Expression) -> bool:
        """Return True if a variable is known to be Boolean."""
        return self._resolver.type_of(target, self._site) == t.ElementaryType(name=t.Elementary.BOOL)

    def mistakes(self, statement: n.Statement) -> Iterator[str]:
        """Yield what no tool compiles in a statement of the POU: values of another kind."""
        yield from type_mistakes(statement, self._resolver, self._site)

    def other_type(self, target: n.Expression) -> str:
        """Return the type of a variable that is known not to be Boolean; empty if it is, or can be."""
        type_ = self._resolver.type_of(target, self._site)
        if isinstance(type_, t.ElementaryType):
            return "" if type_.name is t.Elementary.BOOL else type_.name.value
        return type_.kind if isinstance(type_, _NEVER_BOOLEAN) else ""


_NEVER_BOOLEAN = (t.StringType, t.ArrayType, t.StructType, t.EnumType, t.SubrangeType)


REPAIR = "Repair it in its tool and export it again."


class TextReader:
    """Reader of the texts of a chart of `pou`. `helpers` are the variables that drawings need."""

    def __init__(self, pou: Pou, chart: SfcNetwork, dialect: Dialect, helpers: Iterable[Helper] = ()) -> None:
        self.pou = pou
        self.chart = chart
        self.dialect = dialect
        self.helpers = [*helpers]
        self.instances: dict[str, str] = {}
        """The types of the instances in drawings, as texts name them: of global ones only a drawing may tell."""
        self._taken = [helper.name for helper in self.helpers]
        self._readers: dict[int, Callable[[Condition], NetworkExpression]] = {}

    def refuse(self, message: str, path: str, hint: str) -> NoReturn:
        """Raise a `LoweringError` at `path` of the chart. `hint`: what a user can do."""
        place = f"{self.pou.name} / {path}" if path else self.pou.name
        raise LoweringError(message, location=Location(path=place), hint=hint)

    def refuse_any(self, path: str, *things: tuple[object, str, str]) -> None:
        """Refuse the first of some things that is there; each has a message, and what a user can do."""
        for thing, message, hint in things:
            if thing:
                self.refuse(message, path, hint)

    def variable(self, name: str, targets: ActionTargets, path: str) -> n.Expression:
        """Return the variable of an action, which its steps write. Refuses one that is known not to be Boolean."""
        variable = self.expression(name, path)
        other = targets.other_type(variable)
        if other:
            self.refuse(
                f"{name} is of type {other}: only a Boolean variable can be an action",
                path,
                f"Let an action assign it: {name} := ..",
            )
        return variable

    def _accept(self, found: NetworkText, path: str) -> None:
        """Take over the variables that a drawing needs. Refuses what could not be read completely."""
        for wrong in found.obstacles:
            self.refuse(f"it cannot be read: {wrong.message}", path, REPAIR)
        self.helpers += found.helpers
        self.instances |= found.instances
        self._taken += [helper.name for helper in found.helpers]

    def logic(self) -> tuple[n.Statement, ...]:
        """Return the logic that is drawn in the chart and executed in every scan."""
        if not self.chart.logic:
            return ()
        drawn = chart_statements(self.chart, self.dialect, taken=self._taken)
        self._accept(drawn, "logic of the chart")
        return drawn.tree.statements

    def condition(self, chart: SfcNetwork, condition: Condition | None, path: str) -> ConditionText:
        """Return the condition of a transition or an action, however it is given."""
        if condition is None:
            self.refuse(
                "it cannot be read: the transition has no condition", path, "Give it one; TRUE is always satisfied."
            )
        if id(chart) not in self._readers:
            self._readers[id(chart)] = condition_reader(
                chart, self.dialect, transitions=self.pou.transitions, taken=self._taken
            )
        found = self._readers[id(chart)](condition)
        self._accept(found, path)
        if found.tree is None:
            self.refuse("the condition has no value", path, "Its instructions must leave a value: LD, AND, OR ..")
        return ConditionText(_as_truth(n.bare(found.tree)), self._staying(found.before, path))

    def expression(self, text: str, path: str) -> n.Expression:
        """Return an expression."""
        parsed = parse_expression(text, self.dialect)
        if parsed.problems:
            self.refuse(f"{text!r}: {parsed.problems[0].message}", path, REPAIR)
        return n.bare(parsed.tree)

    def read(self, text: str, path: str) -> tuple[n.Statement, ...]:
        """Return statements in structured text."""
        parsed = parse_statements(text, self.dialect)
        if parsed.problems:
            self.refuse(f"{parsed.problems[0].message}", path, REPAIR)
        return parsed.tree.statements

    def statements(self, body: Body | None, path: str) -> tuple[n.Statement, ...]:
        """Return the code of a body."""
        if body is None:
            return ()
        if isinstance(body, StBody):
            return self._staying(self.read(body.text, path), path)
        if isinstance(body, IlBody):
            tree = instruction_statements(body.text, self.dialect, among_others=True)
            if tree is None:
                self.refuse(
                    "instruction list whose jumps are no loops, or whose result is no expression, is not lowered",
                    path,
                    "Write it as structured text.",
                )
            return self._staying(tree.statements, path)
        if not isinstance(body, FbdBody | LdBody):
            self.refuse(f"actions in {body.language} are not lowered", path, "Write it as structured text.")
        found = body_statements(body, self.dialect, taken=self._taken)
        self._accept(found, path)
        return self._staying(found.tree.statements, path)

    def _staying(self, statements: tuple[n.Statement, ...], path: str) -> tuple[n.Statement, ...]:
        """Return statements without RETURN and jumps out of them: among other code, these would leave that too."""
        for statement in statements:
            for node in walk(statement):
                if isinstance(node, n.ReturnStatement | n.Goto | n.LabelStatement):
                    self.refuse(
                        "RETURN and jumps are not lowered: in the code they would leave more than this",
                        path,
                        "Write IF around what they skip.",
                    )
                # only the compiler of the target could tell what the C code reads and writes
                if isinstance(node, n.EmbeddedCode):
                    self.refuse(
                        "code in C ({{ .. }}) is not lowered: it is not known what it does",
                        path,
                        "Write it as structured text, or in a block that is called.",
                    )
        return statements


_TRUTHS = {"0": FALSE, "1": TRUE}


def _as_truth(tree: n.Expression) -> n.Expression:
    """Return a condition with FALSE and TRUE for 0 and 1, as IEC 61131-3 ed. 2 allows and other dialects do not."""
    match tree:
        case n.Literal(text) if text in _TRUTHS:
            return _TRUTHS[text]
        case n.Parenthesized(inner):
            return replace(tree, inner=_as_truth(inner))
        case n.Unary(n.Operator.NOT, operand):
            return replace(tree, operand=_as_truth(operand))
        case n.Operation(operator, operands) if operator in n.CONNECTIVES:
            return replace(tree, operands=tuple(map(_as_truth, operands)))
    return tree
