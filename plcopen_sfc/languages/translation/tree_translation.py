"""Translates the syntax tree: what a dialect writes otherwise, it writes in another way."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import cast

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.effects import conditional_assignment
from plcopen_sfc.languages.expression_types import ExpressionTypes
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import LiteralKind, known_literal
from plcopen_sfc.languages.st.nodes import AssignmentKind, Expression, Node, Operator, Quoting, Statement
from plcopen_sfc.languages.st.walking import transform, walk, with_children
from plcopen_sfc.languages.translation.call_translation import CallTranslator
from plcopen_sfc.languages.translation.literal_translation import (
    translated_address,
    translated_literal,
    translated_part,
)
from plcopen_sfc.languages.translation.name_translation import NameTranslator
from plcopen_sfc.languages.translation.translation_context import (
    TITLES,
    NameTable,
    Notes,
    StepNotation,
    StepReferences,
    TranslationContext,
)
from plcopen_sfc.languages.words import needs_quotes
from plcopen_sfc.model.dialect import Dialect

_ACTIVE, _TIME, _OWN_TIME = "X", "T", "U"


class StepTranslator:
    """Finds references to steps and writes them in the notation of the target."""

    def __init__(self, references: StepReferences, notes: Notes) -> None:
        self._names = NameTable.of(references.names)
        self._references = references
        self._notes = notes

    def translated(self, node: n.Name | n.Member) -> Expression | None:
        """Return the reference in the notation of the target; None: `node` refers to no step."""
        found = self._read(node)
        if found is None:
            return None
        step, quantity = found
        new = self._names[step.casefold()]
        stays = step == new and self._references.source_block == self._references.target_block
        if self._references.source is self._references.target and stays:
            return node
        written = self._write(new, quantity)
        if written is None:
            reason = f"steps have no counterpart of .{quantity} in the notation of {self._references.target.value}"
            self._notes.add(Severity.ERROR, f"{reason}; left unchanged", node)
            return node
        disturbed = self._references.disturbed
        differs = quantity == _OWN_TIME and (disturbed is None or step.casefold() in disturbed)
        if differs and self._references.target is not StepNotation.S7_GRAPH:
            self._notes.add(Severity.WARNING, ".U is the time without disturbances, .T also counts these", node)
        return written

    def _read(self, node: n.Name | n.Member) -> tuple[str, str] | None:
        """Name of a step and of its variable: ``X`` (active), ``T`` (elapsed time), or a tool's own."""
        notation = self._references.source
        if notation is StepNotation.GRAFCET:
            number = node.identifier[1:] if isinstance(node, n.Name) and node.identifier[:1] in "Xx" else ""
            return (number, _ACTIVE) if number.casefold() in self._names else None
        if notation is StepNotation.FLAG:
            step = self._step(node)
            return (step, _ACTIVE) if step is not None else None
        if not isinstance(node, n.Member) or not isinstance(node.base, n.Name | n.Member):
            return None
        step = self._step(node.base)
        if step is None:
            return None
        quantity = node.name.identifier
        return step, quantity.upper() if quantity.upper() in (_ACTIVE, _TIME, _OWN_TIME) else quantity

    def _step(self, node: n.Name | n.Member) -> str | None:
        block = self._references.source_block
        if isinstance(node, n.Member):
            if not block or not isinstance(node.base, n.Name) or node.base.identifier.casefold() != block.casefold():
                return None
            name = node.name
        else:
            name = node
            if block:
                return None
        return name.identifier if name.identifier.casefold() in self._names else None

    def _write(self, step: str, quantity: str) -> Expression | None:
        notation = self._references.target
        if notation is StepNotation.GRAFCET:
            return n.Name(f"X{step}") if quantity == _ACTIVE else None
        graph = notation is StepNotation.S7_GRAPH
        variable = self._variable(step, graph)
        if notation is StepNotation.FLAG:
            return variable if quantity == _ACTIVE else None
        if quantity == _OWN_TIME and not graph:
            quantity = _TIME
        if quantity not in (_ACTIVE, _TIME, _OWN_TIME):
            return n.Member(variable, n.Name(quantity)) if self._references.source is notation else None
        return n.Member(variable, n.Name(quantity.lower() if notation is StepNotation.CODESYS else quantity))

    def _variable(self, step: str, graph: bool) -> n.Name | n.Member:
        block = self._references.target_block
        if block:
            plain = not graph or not needs_quotes(step)
            name = n.Name(step, Quoting.NONE if plain else Quoting.GLOBAL)
            return n.Member(n.Name(block, Quoting.GLOBAL if graph else Quoting.NONE), name)
        if not graph:
            return n.Name(step)
        return n.Name(step, Quoting.LOCAL_QUOTED if needs_quotes(step) else Quoting.LOCAL)


BOTH_SIDES = {Operator.AND_THEN: Operator.AND, Operator.OR_ELSE: Operator.OR}
"""Operators that end with the operand that decides, and those that need not."""
_JUMPS = {Dialect.SCL: "GOTO", Dialect.CODESYS: "JMP"}


class TreeTranslator:
    """Makes the tree of the target dialect. `source` and `target` are families; nodes equal in both stay."""

    def __init__(self, tree: Node, source: Dialect, target: Dialect, context: TranslationContext, notes: Notes) -> None:
        self._tree = tree
        self._source, self._target = source, target
        self._notes = notes
        self._names = NameTranslator(tree, source, target, context, notes)
        self._types = ExpressionTypes(source, context.type_of)
        self._calls = CallTranslator(source, target, self._names, notes, self._expression, types=self._types)
        self._steps = StepTranslator(context.steps, notes) if context.steps is not None else None
        self._addresses = context.addresses or (source, target)
        self._enumerations = NameTable.of(context.enumerations)
        self._s7_types = context.s7_types
        self._hidden = NameTable.of(context.hidden)

    def translated(self) -> Node:
        """Return the whole tree."""
        return self._node(self._tree)

    def _expression(self, node: Expression) -> Expression:
        return cast("Expression", self._node(node))

    def _node(self, node: Node) -> Node:
        match node:
            case n.Name() if self._is_pointed_at(node):
                return n.Dereference(node, span=node.span)
            case n.Name():
                return (
                    self._step(node) or self._enumerated(node) or self._names.listed(node) or self._names.variable(node)
                )
            case n.Member():
                return self._step(node) or self._names.listed(node) or self._member(node)
            case n.Literal():
                return self._literal(node)
            case n.Address(text):
                new = self._notes.take(translated_address(text, *self._addresses), node)
                return node if new == text else replace(node, text=new)
            case n.Dereference():
                return self._dereference(node)
            case n.Peripheral() if self._target is not self._source:
                self._lacks("direct access to the periphery (:P)", node)
                return with_children(node, self._node)
            case n.Call(callee=n.Name() as callee) if self._is_pointed_at(callee):
                return self._calls.call(replace(node, callee=n.Dereference(callee, span=callee.span)))
            case n.Call():
                return self._calls.call(node)
            case n.TypeOperand() if self._target is not self._source:
                self._lacks("types as operands", node)
                return node
            case n.Unary():
                return self._unary(with_children(node, self._node))
            case n.Operation():
                return self._operation(with_children(node, self._node))
            case n.AssignmentExpression() if self._target is Dialect.IEC and self._source is not Dialect.IEC:
                self._lacks("assignments inside expressions", node)
                return with_children(node, self._node)
            case _:
                return self._statement(node)

    def _statement(self, node: Node) -> Node:
        changes = self._target is not self._source
        match node:
            case n.Assignment():
                return self._assignment(self._with_truncation(node) if changes else node)
            case n.CallStatement(call) if changes and self._source is Dialect.CODESYS and not isinstance(call, n.Call):
                return replace(node, call=self._calls.action(call))
            case n.Goto(_, keyword) if changes:
                if self._target not in _JUMPS:
                    self._lacks("jumps", node)
                    return node
                return replace(node, keyword=_JUMPS.get(self._target, keyword))
            case n.LabelStatement() if changes:
                if self._target not in _JUMPS:
                    self._lacks("labels to jump to", node)
                return node
            case n.EmbeddedCode() if changes:
                self._lacks("code in C", node)
                return node
            case n.Try() if changes:
                self._lacks("__TRY", node)
                return with_children(node, self._node)
            case n.ReturnStatement(value) if changes and value is not None:
                self._lacks("RETURN with a value", node)
                return with_children(node, self._node)
            case _:
                return with_children(node, self._node)

    # -- going down ---------------------------------------------------------------------------------------------------

    def _lacks(self, what: str, node: Node) -> None:
        self._notes.add(Severity.ERROR, f"{TITLES[self._target]} has no {what}; left unchanged", node)

    # -- expressions --------------------------------------------------------------------------------------------------

    def _step(self, node: n.Name | n.Member) -> Expression | None:
        return None if self._steps is None else self._steps.translated(node)

    def _enumerated(self, node: n.Name) -> Expression | None:
        """Return a value of an enumeration: a user constant in SCL, a name with or without its type elsewhere."""
        if self._source is self._target or self._s7_types is None:
            return None
        if self._target is Dialect.SCL:
            value = self._s7_types.alone(node.identifier)
            is_other = node.identifier.casefold() in self._hidden
            if value is None or is_other or self._names.is_local(node) is not False:
                return None
            return n.Name(value.name, n.Quoting.GLOBAL, span=node.span)
        value = self._s7_types.named(node.identifier) if node.quoting is n.Quoting.GLOBAL else None
        if value is None:
            return None
        if self._target is Dialect.CODESYS:
            return n.Member(n.Name(value.type), n.Name(value.value), span=node.span)
        return n.Literal(f"{value.type}#{value.value}", span=node.span)

    def _constant(self, text: str, node: Expression) -> Expression:
        """Return the user constant for a value of an enumeration."""
        value = self._s7_types.constant(text) if self._s7_types is not None else None
        if value is not None:
            return n.Name(value.name, n.Quoting.GLOBAL, span=node.span)
        self._lacks("enumerations", node)
        return node

    def _literal(self, node: n.Literal) -> Expression:
        if self._target is self._source:
            return node
        if _is_enumerated(node, self._source):
            type, _, value = node.text.partition("#")
            if self._target is Dialect.CODESYS:
                return n.Member(n.Name(type), n.Name(value), span=node.span)
            if self._target is Dialect.SCL:
                return self._constant(f"{type}.{value}", node)
            return node
        new = self._notes.take(translated_literal(node.text, self._source, self._target), node)
        return node if new == node.text else replace(node, text=new)

    def _member(self, node: n.Member) -> Expression:
        if self._target is self._source:
            return with_children(node, self._node)
        base = node.base
        if self._target is Dialect.SCL and _is_this(base) and self._names.is_local(node.name):
            return self._names.variable(node.name)
        if isinstance(base, n.Name) and base.identifier.casefold() in self._enumerations:
            if self._target is Dialect.IEC:
                return n.Literal(f"{base.identifier}#{node.name.identifier}", span=node.span)
            return self._constant(f"{base.identifier}.{node.name.identifier}", node)
        new_base = self._expression(base)
        name = self._member_name(node)
        return node if new_base is base and name is node.name else replace(node, base=new_base, name=name)

    def _member_name(self, node: n.Member) -> n.Name:
        part = translated_part(node.name.identifier, self._source, self._target) if not node.name.quoting else None
        if part is not None:
            new = self._notes.take(part, node)
            return node.name if new == node.name.identifier else replace(node.name, identifier=new)
        return self._calls.pin(node.base, node.name) or self._names.member(node.name)

    def _is_pointed_at(self, node: n.Name) -> bool:
        """True for ``THIS`` and ``SUPER`` of IEC 61131-3, which get a ``^`` in CODESYS."""
        return self._source is Dialect.IEC and self._target is Dialect.CODESYS and is_object(node)

    def _dereference(self, node: n.Dereference) -> Expression:
        if is_object(node.base) and Dialect.IEC in (self._source, self._target):
            # THIS and SUPER are no pointers there (6.6.5.7)
            return node.base if self._source is not Dialect.IEC else node
        one_has_pointers = (self._source is Dialect.CODESYS) is not (self._target is Dialect.CODESYS)
        if one_has_pointers and not is_object(node.base):
            reason = "CODESYS follows pointers with ^, IEC 61131-3 and S7 follow references (REF_TO)"
            self._notes.add(Severity.WARNING, reason, node)
        return with_children(node, self._node)

    def _unary(self, node: n.Unary) -> Expression:
        inner = node.operand
        is_power = isinstance(inner, n.Operation) and inner.operator is Operator.POWER
        if self._source is Dialect.SCL and self._target is not Dialect.SCL and is_power:
            return replace(node, operand=n.Parenthesized(inner, span=inner.span))
        return node

    def _operation(self, node: n.Operation) -> Expression:
        if node.operator is Operator.POWER:
            return self._power(node)
        if node.operator in BOTH_SIDES and self._target is not Dialect.CODESYS and self._source is Dialect.CODESYS:
            if any(_may_fail(operand) for operand in node.operands[1:]):
                reason = f"{node.operator.value} became {BOTH_SIDES[node.operator].value}"
                self._notes.add(Severity.WARNING, f"{reason}, which may evaluate its right side in any case", node)
            node = replace(node, operator=BOTH_SIDES[node.operator])
        return _in_one_row(node)

    def _power(self, node: n.Operation) -> Expression:
        if self._target is self._source:
            return node
        base, exponent = node.operands
        if self._target is Dialect.CODESYS:
            arguments = (n.Argument(_without_enclosure(base)), n.Argument(_without_enclosure(exponent)))
            return n.Call(n.Name("EXPT"), arguments, span=node.span)
        if self._target is Dialect.SCL and isinstance(base, n.Unary):  # a sign is before the power there
            return replace(node, operands=(n.Parenthesized(base, span=base.span), exponent))
        return node

    # -- assignments --------------------------------------------------------------------------------------------------

    def _with_truncation(self, node: n.Assignment) -> n.Assignment:
        """Name the result of TRUNC, which is any integer in IEC 61131-3 and a DINT in other tools."""
        call, kind = n.bare(node.value), self._types.value(node.target).type
        if self._source is not Dialect.IEC or not kind.endswith("INT") or not isinstance(call, n.Call):
            return node
        if not isinstance(call.callee, n.Name) or call.callee.identifier.upper() != "TRUNC":
            return node
        if self._target is Dialect.CODESYS and kind not in ("INT", "DINT"):
            return replace(node, value=n.Call(n.Name(f"DINT_TO_{kind}"), (n.Argument(call),)))
        return replace(node, value=replace(call, callee=replace(call.callee, identifier=f"REAL_TRUNC_{kind}")))

    def _assignment(self, node: n.Assignment) -> Statement:
        if self._target is self._source or node.kind is AssignmentKind.ASSIGN:
            return self._plain_assignment(node)
        new = with_children(node, self._node)
        if (setting := conditional_assignment(new)) is not None:
            return setting
        if node.kind in n.CALCULATING_ASSIGNMENTS and not isinstance(node.value, n.AssignmentExpression):
            if any(isinstance(part, n.Call) for part in walk(node.target)):
                self._notes.add(Severity.WARNING, f"{node.kind.value} was written out: the target is read twice", node)
            read = transform(new.target, lambda part: replace(part, span=None))  # its comments are those of the target
            operation = n.Operation(n.CALCULATING_ASSIGNMENTS[node.kind], (read, _grouped(new.value)))
            return n.Assignment(new.target, operation, span=node.span)
        self._lacks(f"assignments with {node.kind.value}", node)
        return new

    def _plain_assignment(self, node: n.Assignment) -> Statement:
        """``a := b := c`` stays for now: see `split_chains`."""
        target, value = self._expression(node.target), self._chained(node.value)
        return node if target is node.target and value is node.value else replace(node, target=target, value=value)

    def _chained(self, node: Expression) -> Expression:
        if not isinstance(node, n.AssignmentExpression):
            return self._expression(node)
        target, value = self._expression(node.target), self._chained(node.value)
        return node if target is node.target and value is node.value else replace(node, target=target, value=value)


def _in_one_row(node: n.Operation) -> n.Operation:
    """``(a AND b) AND c`` where the first AND was another operator, as one row of operands."""
    first = node.operands[0]
    if isinstance(first, n.Operation) and first.operator is node.operator and node.operator in BOTH_SIDES.values():
        return replace(node, operands=(*first.operands, *node.operands[1:]))
    return node


def _grouped(value: Expression) -> Expression:
    return n.Parenthesized(value) if isinstance(value, n.Operation | n.Unary) else value


def _without_enclosure(operand: Expression) -> Expression:
    return operand.inner if isinstance(operand, n.Parenthesized) else operand


def _is_enumerated(node: n.Literal, source: Dialect) -> bool:
    found = known_literal(node, source)
    return found is not None and found.kind is LiteralKind.ENUMERATED


def is_object(node: Expression) -> bool:
    """True for ``THIS`` and ``SUPER`` without a ``^``, which they have in CODESYS."""
    return isinstance(node, n.Name) and node.identifier.upper() in ("THIS", "SUPER")


def _is_this(node: Expression) -> bool:
    """True for ``THIS^`` and ``THIS``: the instance that executes the text."""
    base = node.base if isinstance(node, n.Dereference) else node
    return isinstance(base, n.Name) and base.identifier.upper() == "THIS"


def _may_fail(node: Expression) -> bool:
    """True if an expression can have an effect or stop the program, so that it matters whether it is evaluated."""
    risky = (n.Call, n.Dereference, n.Index, n.AssignmentExpression)
    return any(
        isinstance(part, risky)
        or (isinstance(part, n.Operation) and part.operator in (Operator.DIVIDE, Operator.MODULO, Operator.POWER))
        for part in walk(node)
    )


def split_chains(statements: Iterable[Statement]) -> tuple[Statement, ...]:
    """``a := b := c`` as ``b := c; a := b``, which does the same (IEC 61131-3 has no chains)."""
    found: list[Statement] = []
    for statement in statements:
        links = [statement.target] if isinstance(statement, n.Assignment) else []
        value = statement.value if isinstance(statement, n.Assignment) else None
        while isinstance(value, n.AssignmentExpression):
            links.append(value.target)
            value = value.value
        if len(links) < 2 or value is None:
            found.append(statement)
            continue
        for link in reversed(links):
            found.append(n.Assignment(link, value))
            value = link
    return tuple(found)
