"""What starts a chain anew: an input for that, a general reset condition such as an emergency stop, or both."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import NoReturn

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, transform, walk
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.lowering.code.logic import assignment, disjunction
from plcopen_sfc.lowering.code.naming import free_name
from plcopen_sfc.lowering.code.program import BOOL, Code
from plcopen_sfc.lowering.forms import Style
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.rules import LoweringRules
from plcopen_sfc.model.variables import SectionKind


def names_in_conditions(rules: LoweringRules, dialect: Dialect) -> set[str]:
    """The names that the user gives in `init` and `stop`: nothing else may be called so."""
    texts = [text for text in (rules.init, rules.stop) if text is not None]
    trees = [parse_expression(text, dialect).tree for text in texts]
    return {node.identifier for tree in trees for node in walk(tree) if isinstance(node, n.Name)}


def with_usual_input(
    rules: LoweringRules, style: Style, source: ChartSource, surroundings: Collection[str]
) -> LoweringRules:
    """The rules with the name of the input that a textbook form has where none was asked for; or with none.

    An input of the POU that is called so is taken, unless the chart reads it: then it means something else.
    """
    if rules.init or (rules.init is None and style is Style.EXACT):
        return rules
    if rules.init is not None:
        return replace(rules, init=None)
    wanted = rules.texts.init_input
    inputs = (v.name for v in source.pou.variables(SectionKind.INPUT) if v.type == BOOL)
    own = next((name for name in inputs if name.casefold() == wanted.casefold()), None)
    if own is not None and own.casefold() not in map(str.casefold, source.names_in_texts()):
        return replace(rules, init=own)
    taken = {*surroundings, *map(str.casefold, source.names())}
    return replace(rules, init=free_name(wanted, taken))


def declare_restart(
    source: ChartSource, code: Code, rules: LoweringRules, surroundings: Collection[str]
) -> n.Name | None:
    """What is TRUE while the chain is to stand at its initial steps; None where nobody asked for it.

    Names that nothing has, neither the POU nor its `surroundings` (names of the project in lower case), become inputs
    of type BOOL. Raises `LoweringError` for a condition that cannot be read.
    """
    maker = _Conditions(source, code, {*surroundings, *(name.casefold() for name in source.names())})
    init = maker.named(rules.init, rules.texts.init) if rules.init is not None else None
    stop = maker.condition(rules.stop, rules.texts.stop) if rules.stop is not None else None
    if stop is None:
        return init
    if init is None and isinstance(stop, n.Name) and maker.rests(stop):
        return stop
    restart = code.declare(rules.texts.restart, comment=rules.texts.restart_comment)
    code.add(rules.texts.init, [assignment(restart, disjunction([init, stop] if init is not None else [stop]))])
    if not maker.rests(stop):
        code.left_out = restart
    return restart


class _Conditions:
    """Reads conditions and declares the inputs that they need."""

    def __init__(self, source: ChartSource, code: Code, known: Collection[str]) -> None:
        self._source, self._code, self._known = source, code, known
        self._inputs: dict[str, n.Name] = {}

    def rests(self, condition: Expression) -> bool:
        """Whether it is an input that was added, and so FALSE where the code is compared with the chart."""
        return isinstance(condition, n.Name) and condition.identifier in self._code.at_rest

    def named(self, name: str, comment: str) -> n.Name:
        """The input of this name, which is added if the POU has none."""
        tree = n.bare(self._parsed(name))
        if not isinstance(tree, n.Name) or tree.quoting is n.Quoting.GLOBAL:
            self._refuse(f"{name!r} is no name of an input")
        declared = self._declared(tree.identifier)
        if declared is not None:
            if declared != BOOL:
                self._refuse(f"{name} is there already, and is no BOOL")
            self._code.at_rest[tree.identifier] = False
            return self._code.naming.local(tree.identifier)
        if tree.identifier.casefold() in self._known:
            steps = {each.step.name.casefold() for each in self._source.net.steps}
            what = "a step" if tree.identifier.casefold() in steps else "something else"
            self._refuse(f"{name} is the name of {what} already", "Give the input another name.")
        return self._input(tree.identifier, comment, rests=True)

    def condition(self, text: str, comment: str) -> Expression:
        """A condition; what it names and nothing has becomes an input."""
        tree = n.bare(self._parsed(text))
        if isinstance(tree, n.Name) and self._is_new(tree):
            return self._input(tree.identifier, comment, rests=True)
        parts = [node.name for node in walk(tree) if isinstance(node, n.Member | n.Argument)]
        parts += [node.callee for node in walk(tree) if isinstance(node, n.Call) and isinstance(node.callee, n.Name)]
        kept = {id(part) for part in parts}

        def added(node: n.Node) -> n.Node:
            if isinstance(node, n.Name) and id(node) not in kept and self._is_new(node):
                return self._input(node.identifier, comment, rests=False)
            return node

        return transform(tree, added)

    def _is_new(self, name: n.Name) -> bool:
        if name.quoting is n.Quoting.GLOBAL:
            return False
        return name.identifier in self._inputs or name.identifier.casefold() not in self._known

    def _input(self, name: str, comment: str, *, rests: bool) -> n.Name:
        if name not in self._inputs:
            self._inputs[name] = self._code.declare_input(name, comment, at_rest=False if rests else None)
        return self._inputs[name]

    def _declared(self, name: str) -> object:
        return next((v.type for v in self._source.pou.variables() if v.name.casefold() == name.casefold()), None)

    def _parsed(self, text: str) -> Expression:
        parsed = parse_expression(text, self._source.dialect)
        if parsed.problems:
            self._refuse(f"{text!r} is no condition: {parsed.problems[0].message}")
        return parsed.tree

    def _refuse(self, message: str, hint: str = "") -> NoReturn:
        raise LoweringError(message, location=Location(path=self._source.pou.name), hint=hint)
