"""Arithmetic that does the same in a tool which calculates in other types.

CODESYS does not cut off ``x * y`` of two INT before it is compared, divided or assigned to a DINT; S7 and IEC 61131-3
do. A result that is stored in the narrow type at once is the same in all, for sums, differences and products are the
same modulo a power of two whenever they are cut off. Elsewhere operands become wider, or the result is cut off. SCL has
neither arithmetic on bit strings nor logic of integers: their operands are converted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar, cast

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.expression_types import (
    BIT_STRINGS,
    CALCULATING,
    CONVERSION,
    INSTANTS,
    OF_ONE_TYPE,
    ORDER,
    REALS,
    SUMS,
    UNSIGNED,
    ElementaryValue,
    ExpressionTypes,
    bits_as_wide_as,
    bits_of,
    calculated_type,
    fits,
    number_of,
    operand_type,
)
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Expression, Node, Operator
from plcopen_sfc.languages.st.walking import walk, with_children
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.translation.call_translation import operator_of
from plcopen_sfc.languages.translation.translation_context import TITLES, Notes, TranslationContext
from plcopen_sfc.model.dialect import Dialect

_SIGN_OF_TIME = "{type} has no sign in CODESYS: {what} below zero is very long there, and below zero in {tool}"
_SIGNED = frozenset({"TIME", "LTIME"})
_TIMES: dict[Operator | None, str] = {
    None: "a number",
    Operator.SUBTRACT: "a difference",
    Operator.MULTIPLY: "a product",
    Operator.DIVIDE: "a quotient",
}
_END_OF_TIME = "TIME ends after {days} days in {tool} and goes on {beyond}: {what} may be longer in {other}"
_ENDS_OF_TIME = {Dialect.SCL: (24, "below zero"), Dialect.CODESYS: (49, "from zero")}
"""The days that a TIME of 32 bits can last, and what follows, by families, that with the shortest first."""
_SIGN_OF_DIFFERENCE = "CODESYS does not document how it compares or divides a difference of {types} below zero"


NodeT = TypeVar("NodeT", bound=Node)


class ArithmeticTranslator:
    """Puts the arithmetic of a text into terms that do the same in the target. `source` and `target` are families."""

    def __init__(self, source: Dialect, target: Dialect, context: TranslationContext, notes: Notes) -> None:
        self._source, self._target = source, target
        self._context = context
        self._notes = notes
        self.types = ExpressionTypes(source, context.type_of)
        self._in_boxes = False

    def fitted(self, tree: NodeT) -> NodeT:
        """Return the whole tree, of statements or of one expression."""
        if isinstance(tree, n.Statements):
            return cast("NodeT", with_children(tree, self._node))
        expression = cast("Expression", tree)
        self._in_boxes = True  # SCL has a chart in S7-GRAPH only, whose conditions are networks
        if self._context.wanted:
            return cast("NodeT", self._stored(expression, self._context.wanted))
        is_value = self.types.value(expression).type != "BOOL"
        return cast("NodeT", self._fit(expression, 0 if is_value else None)[0])

    # -- statements

    def _node(self, node: Node) -> Node:
        match node:
            case n.Assignment(target, value) if not isinstance(value, n.AssignmentExpression):
                if self.types.value(target).type == "TIME" and self._grows(target, value):
                    self._note_end_of_time(node, "a sum that grows")
                place, _ = self._fit(target, None)
                new = self._stored(value, self.types.value(target).type)
                return node if place is target and new is value else replace(node, target=place, value=new)
            case n.For():
                return self._loop(node)
            case _ if isinstance(node, _EXPRESSIONS):
                return self._fit(cast("Expression", node), None)[0]
        return with_children(node, self._node)

    def _loop(self, node: n.For) -> n.For:
        kind = self.types.value(node.variable).type
        step = None if node.step is None else self._stored(node.step, kind)
        start, end = self._stored(node.start, kind), self._stored(node.end, kind)
        statements = tuple(cast("n.Statement", self._node(each)) for each in node.statements)
        same = all(a is b for a, b in zip(statements, node.statements, strict=True))
        if same and start is node.start and end is node.end and step is node.step:
            return node
        return replace(node, start=start, end=end, step=step, statements=statements)

    def _stored(self, value: Expression, kind: str) -> Expression:
        """Return the value to assign to a variable of a type."""
        if kind not in ORDER:
            new, made = self._fit(value, None)
            if kind in REALS and made in ORDER and new is not value:
                return _converted(new, made, kind)
            return new
        real = self.types.value(value).type
        if real in REALS and self._source is Dialect.SCL and self._target is not Dialect.SCL:
            call = _converted(self._fit(value, None)[0], real, kind)  # other tools do not convert such values
            return call if isinstance(value, n.Call) else replace(call, span=value.span)
        new, made = self._fit(value, bits_of(kind))
        if made not in ORDER or self._target is Dialect.CODESYS:
            return new
        is_bits = made in BIT_STRINGS
        narrower = bits_of(kind) < bits_of(made)
        if new is not value and (narrower or is_bits is not (kind in BIT_STRINGS)) and made != kind:
            return _converted(new, made, kind)
        own = self.types.value(value)
        if narrower and isinstance(n.bare(value), n.Operation | n.Unary) and not own.loose:
            return _converted(new, made, kind)  # CODESYS takes the result of an operation for one of its operands
        return new

    # -- expressions

    def _fit(self, node: Expression, want: int | None) -> tuple[Expression, str]:
        """Return an expression, and its type in the target, empty where it has none or that is not known.

        `want`: how many of its low bits matter; None: all, and 0: it stays as it is, whatever it may mean.
        """
        match node:
            case n.Parenthesized(inner):
                new, made = self._fit(inner, want)
                if new is inner:
                    return node, made
                return (new if isinstance(new, n.Call | n.Name) else replace(node, inner=new)), made
            case n.Operation(operator) if operator in CALCULATING:
                return self._calculation(node, operator, node.operands, want)
            case n.Unary(Operator.NEGATE, operand) if not self.types.value(node).loose:
                return self._calculation(node, Operator.SUBTRACT, (operand,), want)
            case n.Operation(operator, operands) if operator in n.COMPARISONS and len(operands) == 2:
                return self._comparison(node, operands), "BOOL"
            case n.Operation(operator) | n.Unary(operator) if operator in n.CONNECTIVES or operator is Operator.NOT:
                return self._logic(node)
            case n.Call():
                return self._call(node), self.types.value(node).type
            case n.Index(base, indices):
                found = tuple(self._fit(each, 0)[0] for each in indices)
                place = self._fit(base, 0)[0]
                same = place is base and all(a is b for a, b in zip(found, indices, strict=True))
                return (node if same else replace(node, base=place, indices=found)), self.types.value(node).type
        value = self.types.value(node)
        return with_children(node, self._node), "" if value.loose else value.type

    def _calculation(
        self, node: n.Operation | n.Unary, operator: Operator, operands: tuple[Expression, ...], want: int | None
    ) -> tuple[Expression, str]:
        value = self.types.value(node)
        if value.type not in ORDER:
            return self._other_calculation(node, operator, operands, value)
        source = value.type
        if operator in SUMS and not (want == 0 and any(map(self._divides, operands))):
            inner: int | None = bits_of(source) if want is None else want
        else:
            inner = None
        pairs = [self._fit(each, inner) for each in operands]
        values = [self.types.value(each) for each in operands]
        made = self._made(pairs, values)
        numbers = self._target is Dialect.SCL and any(kind in BIT_STRINGS for _, kind in pairs)
        lost = want is not None and (want <= min(bits_of(made), bits_of(source)))
        if bits_of(source) > bits_of(made) and not fits(value, made) and not lost:
            if inner is not None:  # the operands count with more bits now
                pairs = [self._fit(each, bits_of(source)) for each in operands]
            self._doubt_sign(node, operator, values, value)
            pairs = [self._wider(new, kind, number_of(source)) for new, kind in pairs]
            return self._with(node, pairs), self._made(pairs, values)
        if numbers:
            wide = number_of(made)
            pairs = [self._number(*each, wide) if each[1] in BIT_STRINGS else each for each in pairs]
            return self._with(node, pairs), self._made(pairs, values)
        new = self._with(node, pairs)
        is_cut = bits_of(source) < bits_of(made) and not fits(value, source) and not lost
        if is_cut and all(bits_of(each.type) <= bits_of(source) for each in values if not each.loose):
            return _converted(new, made, source), source
        return new, made

    def _divides(self, node: Expression) -> bool:
        node = n.bare(node)
        return isinstance(node, n.Operation) and node.operator in (Operator.DIVIDE, Operator.MODULO)

    def _made(self, pairs: list[tuple[Expression, str]], values: list[ElementaryValue]) -> str:
        """Return the type in which the target calculates with these operands."""
        types = [kind for _, kind in pairs if kind in ORDER]
        return calculated_type(self._target, operand_type(self._target, types, values))

    def _wider(self, node: Expression, kind: str, wide: str) -> tuple[Expression, str]:
        if kind not in ORDER or bits_of(kind) >= bits_of(wide):
            return node, kind
        return _converted(node, kind, wide), wide

    def _number(self, node: Expression, kind: str, wide: str) -> tuple[Expression, str]:
        """Return a bit string as an integer: SCL has no arithmetic on bit strings."""
        number = wide if bits_of(wide) > bits_of(kind) else number_of(kind)
        return _converted(node, kind, number), number

    def _with(self, node: n.Operation | n.Unary, pairs: list[tuple[Expression, str]]) -> Expression:
        """Return the operation with other operands."""
        new = tuple(each for each, _ in pairs)
        if isinstance(node, n.Unary):
            return node if new[0] is node.operand else replace(node, operand=new[0])
        if all(a is b for a, b in zip(new, node.operands, strict=True)):
            return node
        return replace(node, operands=new)

    def _doubt_sign(
        self, node: Node, operator: Operator, values: list[ElementaryValue], value: ElementaryValue
    ) -> None:
        types = {each.type for each in values if not each.loose}
        unsigned = types <= UNSIGNED | BIT_STRINGS
        if unsigned and value.low < 0 and operator is Operator.SUBTRACT and self._source is Dialect.CODESYS:
            self._notes.add(Severity.WARNING, _SIGN_OF_DIFFERENCE.format(types=" and ".join(sorted(types))), node)

    def _other_calculation(
        self, node: n.Operation | n.Unary, operator: Operator, operands: tuple[Expression, ...], value: ElementaryValue
    ) -> tuple[Expression, str]:
        """Return a calculation with real numbers, times or dates."""
        pairs = [self._fit(each, None) for each in operands]
        if value.type in REALS:
            pairs = [
                (_converted(new, kind, value.type), value.type) if kind in ORDER and new is not old else (new, kind)
                for (new, kind), old in zip(pairs, operands, strict=True)
            ]
        types = [self.types.value(each).type for each in operands]
        if value.type in _SIGNED and not INSTANTS & {*types}:
            self._doubt_time(node, operator, operands, value.type)
        if value.type in _SIGNED and not {*types}.isdisjoint(REALS) and self._target is Dialect.SCL is not self._source:
            reason = f"SCL multiplies and divides {value.type} by integers alone"
            self._notes.add(Severity.ERROR, f"{reason}; left unchanged", node)
        if INSTANTS & {*types} and Dialect.SCL in (self._source, self._target) and self._source is not self._target:
            names = " and ".join(sorted({*types} - {""}))
            reason = f"S7 calculates with {names} by T_ADD, T_SUB and T_DIFF"
            self._notes.add(Severity.ERROR, f"{reason}; left unchanged", node)
        return self._with(node, pairs), value.type

    def _doubt_time(self, node: Node, operator: Operator | None, operands: Sequence[Expression], type: str) -> None:
        """Note a TIME or LTIME that may be below zero, or a TIME that may be too long.

        `operator` None: it is a number that was converted.
        """
        is_known = operator is Operator.SUBTRACT or any(map(self._may_be_negative, operands))
        if Dialect.CODESYS in (self._source, self._target) and is_known and operator in _TIMES:
            other = self._target if self._source is Dialect.CODESYS else self._source
            tool = _TOOLS.get(other, TITLES[other])
            why = _SIGN_OF_TIME.format(type=type, what=_TIMES[operator], tool=tool)
            self._notes.add(Severity.WARNING, why, node)
        if type == "LTIME":  # which ends after centuries in all
            return
        numbers = [(self.types.value(each), n.bare(each)) for each in operands]
        is_varied = any(value.type in REALS and not isinstance(each, n.Literal) for value, each in numbers)
        if operator is Operator.MULTIPLY:
            is_varied |= any(value.low < value.high for value, _ in numbers)
        elif operator is None:
            longest = 0x7FFF_FFFF if Dialect.SCL in (self._source, self._target) else 0xFFFF_FFFF
            is_varied |= any(value.type == "LTIME" or value.high > longest for value, _ in numbers)
        if is_varied:
            self._note_end_of_time(node, _TIMES.get(operator, ""))

    def _note_end_of_time(self, node: Node, what: str) -> None:
        """Note a TIME that may be longer than the one of a tool, if the other tool has longer ones or no end."""
        tools = {self._source, self._target}
        short = next((each for each in _ENDS_OF_TIME if each in tools), None)
        if what and short is not None and len(tools) > 1:
            days, beyond = _ENDS_OF_TIME[short]
            (other,) = tools - {short}
            names = [_TOOLS.get(each, TITLES[each]) for each in (short, other)]
            why = _END_OF_TIME.format(days=days, tool=names[0], beyond=beyond, what=what, other=names[1])
            self._notes.add(Severity.WARNING, why, node)

    def _grows(self, target: Expression, value: Expression) -> bool:
        """True if a TIME is a sum or a product with what it was before."""
        name = print_node(target).casefold()
        sums = (node for node in walk(value) if isinstance(node, n.Operation | n.Call) and _is_sum(node))
        return any(print_node(part).casefold() == name for each in sums for part in walk(each))

    def _may_be_negative(self, operand: Expression) -> bool:
        value = self.types.value(operand)
        is_constant = isinstance(n.bare(operand), n.Literal)
        return value.low < 0 or (value.type in REALS and not is_constant)

    def _comparison(self, node: n.Operation, operands: tuple[Expression, ...]) -> Expression:
        pairs = [self._fit(each, None) for each in operands]
        values = [self.types.value(each) for each in operands]
        ordered = node.operator not in (Operator.EQUAL, Operator.UNEQUAL)
        if self._target is Dialect.SCL and {value.type for value in values} == {"BOOL"} and (ordered or self._in_boxes):
            return comparison_as_logic(node.operator, *(new for new, _ in pairs))
        if self._target is Dialect.SCL and all(value.is_whole for value in values):
            pairs = self._comparable(pairs, values, operands)
        return self._with(node, pairs)

    def _comparable(
        self, pairs: list[tuple[Expression, str]], values: list[ElementaryValue], operands: tuple[Expression, ...]
    ) -> list[tuple[Expression, str]]:
        """Operands of a comparison of S7: numbers or bit strings, and literals that fit the type of the other."""
        kinds = [kind for _, kind in pairs if kind in ORDER]
        is_changed = any(new is not old for (new, _), old in zip(pairs, operands, strict=True))
        if is_changed and len({kind in BIT_STRINGS for kind in kinds}) > 1:
            pairs = [self._number(*each, "DINT") if each[1] in BIT_STRINGS else each for each in pairs]
        for index, value in enumerate(values):
            kind = pairs[1 - index][1]
            if not value.loose or kind not in ORDER or fits(value, kind) or value.low != value.high:
                continue
            if kind in BIT_STRINGS:
                pairs[1 - index] = self._number(*pairs[1 - index], "DINT")
                kind = pairs[1 - index][1]
            least = next(each for each in ("DINT", "LINT", "ULINT") if fits(value, each))
            text = str(value.low) if fits(value, kind) else f"{least}#{value.low}"
            pairs[index] = (replace(cast("n.Literal", _plain(operands[index])), text=text), least)
        return pairs

    def _logic(self, node: n.Operation | n.Unary) -> tuple[Expression, str]:
        operands = node.operands if isinstance(node, n.Operation) else (node.operand,)
        pairs = [self._fit(each, None) for each in operands]
        value = self.types.value(node)
        kinds = {kind for _, kind in pairs if kind in ORDER}
        if self._target is not Dialect.SCL or value.type not in ORDER or not kinds - BIT_STRINGS:
            return self._with(node, pairs), value.type
        widths = {bits_of(kind) for kind in kinds}
        literals = [self.types.value(each) for each in operands]
        is_plain = all(each.low >= 0 for each in literals if each.loose)
        if len(widths) > 1 or not is_plain:
            word = node.operator.value
            reason = f"SCL has no {word} of {' and '.join(sorted(kinds))}; left unchanged"
            self._notes.add(Severity.ERROR, reason, node)
            return self._with(node, pairs), value.type
        bits = bits_as_wide_as(next(iter(kinds)))
        made: list[tuple[Expression, str]] = []
        for (new, kind), number in zip(pairs, literals, strict=True):
            if number.loose and isinstance(_plain(new), n.Literal):
                made.append((replace(cast("n.Literal", _plain(new)), text=f"16#{number.low:X}"), bits))
            else:
                made.append((new, kind) if kind in BIT_STRINGS else (_converted(new, kind, bits), bits))
        result = self._with(node, made)
        return (result, bits) if value.type in BIT_STRINGS else (_converted(result, bits, value.type), value.type)

    def _call(self, call: n.Call) -> n.Call:
        new = []
        name = call.called.upper()
        found = CONVERSION.fullmatch(name)
        operands = [argument.value for argument in call.arguments if argument.value is not None]
        block = standard_block(name)
        operator = block.operator or operator_of(block, Dialect.CODESYS) if block is not None else None
        types = {self.types.value(each).type for each in operands}
        if name.casefold() in self._context.functions:
            pass  # nothing is known of its result
        elif found is not None and found["result"] in _SIGNED:
            self._doubt_time(call, None, operands, found["result"])
        elif operator is not None and types & _SIGNED and not INSTANTS & types:
            self._doubt_time(call, operator, operands, "LTIME" if "LTIME" in types else "TIME")
        for position, argument in enumerate(call.arguments):
            value = argument.value
            if value is None or argument.output:
                new.append(argument)
                continue
            if found is not None and found["source"] in ORDER:
                widths = [bits_of(each) for each in (found["source"], found["result"]) if each in ORDER]
                changed, made = self._fit(value, min(widths))
                if changed is not value and made in ORDER and bits_of(made) > bits_of(found["source"]):
                    changed = _converted(changed, made, found["source"])
            elif found is not None or name in OF_ONE_TYPE:
                changed = self._fit(value, None)[0]
            else:
                kind = self._context.parameter_type(call, position) if self._context.parameter_type else ""
                changed = self._stored(value, kind) if kind in ORDER or kind in REALS else self._fit(value, 0)[0]
            new.append(argument if changed is value else replace(argument, value=changed))
        callee = call.callee if isinstance(call.callee, n.Name) else cast("Expression", self._node(call.callee))
        same = callee is call.callee and all(a is b for a, b in zip(new, call.arguments, strict=True))
        return call if same else replace(call, callee=callee, arguments=tuple(new))


def _is_sum(node: n.Operation | n.Call) -> bool:
    if isinstance(node, n.Call):
        return node.called.upper() in ("ADD", "ADD_TIME", "MUL", "MUL_TIME")
    return node.operator in (Operator.ADD, Operator.MULTIPLY)


def comparison_as_logic(operator: Operator, left: Expression, right: Expression) -> Expression:
    """Return a comparison of BOOL as logic: S7 has no order of them, and no box that compares them."""
    left, right = (n.Parenthesized(each) if isinstance(each, n.Operation) else each for each in (left, right))
    if operator in (Operator.EQUAL, Operator.UNEQUAL):
        constant = right.text.upper() if isinstance(right, n.Literal) else ""
        if constant in ("TRUE", "FALSE"):
            return left if (constant == "TRUE") is (operator is Operator.EQUAL) else n.Unary(Operator.NOT, left)
        different = n.Operation(Operator.XOR, (left, right))
        return n.Unary(Operator.NOT, n.Parenthesized(different)) if operator is Operator.EQUAL else different
    is_greater = operator in (Operator.GREATER, Operator.GREATER_OR_EQUAL)
    more, less = (left, right) if is_greater else (right, left)
    joined = Operator.AND if operator in (Operator.GREATER, Operator.LESS) else Operator.OR
    return n.Operation(joined, (more, n.Unary(Operator.NOT, less)))


_TOOLS = {Dialect.SCL: "S7"}
_EXPRESSIONS = (
    *(n.Name, n.Literal, n.Address, n.Member, n.Index, n.Dereference, n.Peripheral, n.Call, n.Unary, n.Operation),
    *(n.Parenthesized, n.AssignmentExpression),
)


def _plain(node: Expression) -> Expression:
    """Return a literal without the sign and the parentheses around it."""
    while isinstance(node, n.Parenthesized | n.Unary):
        node = node.inner if isinstance(node, n.Parenthesized) else node.operand
    return node


def _converted(node: Expression, source: str, result: str) -> Expression:
    inner = node.inner if isinstance(node, n.Parenthesized) else node
    back = f"{result}_TO_{source}"
    if isinstance(inner, n.Call) and inner.callee == n.Name(back) and bits_of(source) == bits_of(result):
        return cast("Expression", inner.arguments[0].value)
    return n.Call(n.Name(f"{source}_TO_{result}"), (n.Argument(inner),))
