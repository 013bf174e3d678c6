"""IF and CASE as statements for networks: conditions become bits first, then each statement is executed by its bit."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace

from plcopen_sfc.languages.effects import is_impure, targets
from plcopen_sfc.languages.networks.drawing_rules import constant_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform, walk
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, S7_INSTANCES, Tool
from plcopen_sfc.languages.translation.arithmetic_translation import comparison_as_logic
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    equal,
    is_constant,
    names_in,
    negation,
    when,
)
from plcopen_sfc.lowering.code.lowered_code import BOOL, LoweredCode
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DerivedType, Variable
from plcopen_sfc.model.variables import SectionKind

_RISKY = frozenset({Operator.DIVIDE, Operator.MODULO, Operator.POWER})


def flatten(code: LoweredCode, declared: Iterable[Variable] = ()) -> None:
    """Replace the statements of each network by those that a network can hold. What cannot be flat is left as it is.

    `declared` are variables besides those of `code`.
    """
    variables = [*declared, *code.variables, *code.inputs]
    flags = {variable.name.casefold() for variable in variables if variable.type == BOOL}
    timers = {variable.name.casefold() for variable in variables if _has_no_enable(variable)}
    numbers = {variable.name.casefold() for variable in variables} - flags - timers
    flattener = _Flattener(code, flags, timers, numbers)
    label: list[Statement] = []
    for place, network in enumerate(code.networks):
        flat = [*label, *flattener.statements(network.statements, TRUE)]
        following = code.networks[place + 1].statements if place + 1 < len(code.networks) else ()
        # in TIA Portal a label is that of a network with logic, which has no other
        moves = isinstance(flat[-1:][0] if flat else None, n.LabelStatement) and bool(following)
        moves = moves and not isinstance(following[0], n.LabelStatement)
        label = [flat.pop()] if moves else []
        code.networks[place] = replace(network, statements=tuple(flat))


def _has_no_enable(variable: Variable) -> bool:
    """Return True for instances of timers and counters: their boxes in TIA Portal have no EN and no ENO."""
    return isinstance(variable.type, DerivedType) and variable.type.name.upper() in {*S7_INSTANCES, *BLOCKS_OF_S7}


def name_inputs(code: LoweredCode, project: Project) -> None:
    """Call functions of the project with the names of their inputs, as boxes of S7 have them."""
    functions = {pou.name.casefold(): pou for pou in project.pous if pou.kind is PouKind.FUNCTION}

    def named(node: n.Node) -> n.Node:
        match node:
            case n.Call(n.Name(name), arguments) if name.casefold() in functions:
                inputs = functions[name.casefold()].variables(SectionKind.INPUT)
                if len(arguments) <= len(inputs) and not any(each.name or each.output for each in arguments):
                    pairs = zip(arguments, inputs, strict=False)
                    return n.Call(node.callee, tuple(n.Argument(a.value, n.Name(v.name)) for a, v in pairs))
        return node

    code.change(lambda statement: transform(statement, named))


def put_logic(code: LoweredCode, declared: Iterable[Variable], *, contacts: bool) -> None:
    """Write comparisons of BOOL as logic, as S7 has no boxes for them; with `contacts` also XOR of two variables.

    `declared` are variables besides those of `code`.
    """
    variables = [*declared, *code.variables, *code.inputs]
    flags = {variable.name.casefold() for variable in variables if variable.type == BOOL}

    def is_bit(node: Expression) -> bool:
        match n.bare(node):
            case n.Name(name):
                return name.casefold() in flags
            case n.Unary(Operator.NOT, operand):
                return is_bit(operand)
            case n.Operation(operator, operands):
                return operator in n.COMPARISONS or (operator in n.CONNECTIVES and all(map(is_bit, operands)))
            case inner:
                return constant_of(inner) is not None

    def changed(node: n.Node) -> n.Node:
        match node:
            case n.Operation(operator, (left, right)) if operator in n.COMPARISONS and is_bit(left) and is_bit(right):
                logic = transform(comparison_as_logic(operator, left, right), changed)
                return n.Parenthesized(logic) if isinstance(logic, n.Operation) else logic
            case n.Operation(Operator.XOR, (n.Name() as left, n.Name() as right)) if contacts and is_bit(node):
                one = conjunction([left, negation(right)])
                return n.Parenthesized(n.Operation(Operator.OR, (one, conjunction([negation(left), right]))))
        return node

    code.change(lambda statement: transform(statement, changed))


class _Flattener:
    def __init__(
        self, code: LoweredCode, flags: Collection[str], timers: Collection[str], numbers: Collection[str]
    ) -> None:
        self._code, self._flags, self._numbers = code, flags, numbers
        self._skipped = timers if code.tool is Tool.S7 else ()

    def _declare(self) -> n.Name:
        return self._code.declare(self._code.texts.condition)

    def statements(self, statements: Iterable[Statement], guard: Expression) -> Iterator[Statement]:
        """Yield statements that are executed while `guard` is TRUE."""
        for statement in statements:
            if isinstance(statement, n.Empty):
                continue
            branches = _branches(statement)
            if branches is not None:
                yield from self._decided(branches, guard)
            elif is_constant(guard, TRUE):
                yield statement
            elif isinstance(statement, n.Assignment) and self._is_switched(statement):
                yield from self._switched(statement, guard)
            elif self._is_skipped(statement):
                label = n.Name(self._code.naming.fresh(self._code.texts.skipped))
                yield when(negation(guard), n.Goto(label, "GOTO"))
                # the input of a timer in LAD takes power, not a constant: here the guard is TRUE
                yield transform(statement, lambda node: negation(guard) if node == FALSE else node)
                yield n.LabelStatement(label)
            else:
                yield when(guard, statement)

    def _is_skipped(self, statement: Statement) -> bool:
        """Return True if a box of TIA Portal cannot be enabled: a jump leads around it."""
        match statement:
            case n.CallStatement(n.Call(n.Name(name))):
                return name.casefold() in self._skipped
        return False

    def _decided(self, branches: Sequence[n.Branch], guard: Expression) -> Iterator[Statement]:
        """Yield branches. All conditions are evaluated first, where a branch could change one of them."""
        guards: list[Expression] = []
        for number, branch in enumerate(branches):
            # an ELSIF is only tried if all conditions before it were FALSE
            others = (negation(other.condition) for other in branches[:number])
            guards.append(conjunction([guard, *others, branch.condition]))
        if _needs_bits(branches, guards):
            bits: list[Expression] = []
            for branch in branches:
                bit = self._declare()
                yield assignment(bit, conjunction([guard, *map(negation, bits), branch.condition]))
                bits.append(bit)
            guards = bits
        for each, branch in zip(guards, branches, strict=True):
            yield from self.statements(branch.statements, each)

    def _is_switched(self, statement: n.Assignment) -> bool:
        """Return True if it assigns a Boolean value that is no constant."""
        value, target = n.bare(statement.value), statement.target
        if isinstance(target, n.Name) and target.identifier.casefold() in self._numbers:
            return False  # AND, OR, XOR and NOT are of words too
        match value:
            case n.Operation(operator):
                return operator in n.COMPARISONS | n.CONNECTIVES
            case n.Unary(operator):
                return operator is Operator.NOT
            case n.Name(name):
                return name.casefold() in self._flags
            case n.Member(_, n.Name(name)) if name.upper() in ("Q", "Q1"):
                return True
        # an output or function of another block has the type of the variable that gets it
        is_bit = isinstance(target, n.Name) and target.identifier.casefold() in self._flags
        return is_bit and not is_constant(value, TRUE) and not is_constant(value, FALSE)

    def _switched(self, statement: n.Assignment, guard: Expression) -> Iterator[Statement]:
        """Yield a set while it is TRUE and a reset while it is FALSE: TIA Portal has no box that moves a BOOL."""
        value = statement.value
        # the set would change what the reset reads; a call is executed once
        if set(names_in(value)) & set(names_in(statement.target)) or is_impure(value):
            value = self._declare()
            yield assignment(value, statement.value)
        yield when(conjunction([guard, value]), assignment(statement.target, TRUE))
        yield when(conjunction([guard, negation(value)]), assignment(statement.target, FALSE))


def _needs_bits(branches: Sequence[n.Branch], guards: Sequence[Expression]) -> bool:
    """Return True if a branch could change a condition, or long conditions would be repeated."""
    statements = [statement for branch in branches for statement in branch.statements]
    # one statement cannot change the condition of another one
    if len(statements) == 1 and not isinstance(statements[0], n.If | n.Case):
        return False
    if any(len(branch.statements) > 1 and not _is_short(g) for branch, g in zip(branches, guards, strict=True)):
        return True
    nodes = [node for statement in statements for node in walk(statement)]
    # what a call or an address changes is not known here
    if any(isinstance(node, n.CallStatement | n.Call | n.Address) for node in nodes):
        return True
    written = {name for statement in statements for target in targets(statement) for name in names_in(target)}
    return not written.isdisjoint(names_in(*guards))


def _is_short(guard: Expression) -> bool:
    return isinstance(guard, n.Name) or (isinstance(guard, n.Unary) and isinstance(guard.operand, n.Name))


def _branches(statement: Statement) -> list[n.Branch] | None:
    """Return the branches of an IF or CASE with ELSE; None for others, or if a condition cannot be evaluated early."""
    found: list[n.Branch]
    if isinstance(statement, n.If):
        found = list(statement.branches)
        otherwise = statement.otherwise
    elif isinstance(statement, n.Case):
        conditions = [_chosen(statement.selector, branch) for branch in statement.branches]
        found = [
            n.Branch(condition, branch.statements)
            for condition, branch in zip(conditions, statement.branches, strict=True)
        ]
        otherwise = statement.otherwise
    else:
        return None
    if otherwise:
        found.append(n.Branch(TRUE, otherwise))
    return found if all(_may_be_asked(branch.condition) for branch in found) else None


def _chosen(selector: Expression, branch: n.CaseBranch) -> Expression:
    """Return the condition that the value of a CASE is one of the labels of a branch."""
    found: list[Expression] = []
    for label in branch.labels:
        if isinstance(label, n.Range):
            lower = n.Operation(Operator.GREATER_OR_EQUAL, (selector, label.lower))
            found.append(conjunction([lower, n.Operation(Operator.LESS_OR_EQUAL, (selector, label.upper))]))
        else:
            found.append(equal(selector, label))
    return disjunction(found)


def _may_be_asked(condition: Expression) -> bool:
    """Return True if it does no harm to evaluate it also where the text would not."""
    # flat code evaluates all conditions in every scan: an index out of range, a division by zero or a call would then
    # happen where the text avoids it
    return not is_impure(condition) and not any(
        isinstance(node, n.Index | n.Dereference) or (isinstance(node, n.Operation) and node.operator in _RISKY)
        for node in walk(condition)
    )
