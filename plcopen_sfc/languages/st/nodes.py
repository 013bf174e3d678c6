"""The syntax tree of structured text: expressions and statements (IEC 61131-3 ed. 3, 7.3).

Nodes cannot be changed; an edited tree is made of new nodes (`dataclasses.replace`) and of those that stay. `span` is
the place of a node in the text it was read from, None for one that was made; it does not count in comparisons, so two
trees are equal when they mean the same, whatever their layout.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

Span: TypeAlias = tuple[int, int]
"""Start and end of a node as offsets into the text; the end is not included."""


@dataclass(frozen=True, slots=True)
class Node:
    """Base of all nodes."""

    span: Span | None = field(default=None, compare=False, repr=False, kw_only=True)


class Quoting(StrEnum):
    """Spelling of a name: ``name``, ``#name``, ``"name"``, ``#"name"``. All but the first are SCL."""

    NONE = ""
    LOCAL = "#"
    GLOBAL = '"'
    LOCAL_QUOTED = '#"'


@dataclass(frozen=True, slots=True)
class Name(Node):
    """A name on its own: of a variable, a function, an instance, an enumeration's value.

    `identifier` is the bare name. ``THIS`` and ``SUPER`` of CODESYS are names too.
    """

    identifier: str
    quoting: Quoting = Quoting.NONE


@dataclass(frozen=True, slots=True)
class Literal(Node):
    """A literal as written, of any type: ``16#FF``, ``T#5s``, ``'text'``, ``Color#red``, ``TRUE``.

    `plcopen_sfc.languages.st.literals` tells its type and value.
    """

    text: str


@dataclass(frozen=True, slots=True)
class Address(Node):
    """A direct address with its percent sign: ``%IX0.0``, ``%M20.0``, ``%IW4:P``."""

    text: str


@dataclass(frozen=True, slots=True)
class Member(Node):
    """``base.name``. A bit is named by its number (``word.3``) or as SCL does (``word.%X3``)."""

    base: Expression
    name: Name


@dataclass(frozen=True, slots=True)
class Index(Node):
    """``base[i, j]``."""

    base: Expression
    indices: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Dereference(Node):
    """``pointer^``."""

    base: Expression


@dataclass(frozen=True, slots=True)
class Peripheral(Node):
    """``variable:P``: past the process image (SCL)."""

    base: Expression


@dataclass(frozen=True, slots=True)
class Argument(Node):
    """An argument of a call.

    By position (`name` None), by name (``IN := x``), or an output (``Q => x``, ``NOT Q => x``). `value` None: nothing
    is there (``IN := ,``), which CODESYS writes for parameters that keep their value.
    """

    value: Expression | None
    name: Name | None = None
    output: bool = False
    negated: bool = False


@dataclass(frozen=True, slots=True)
class Call(Node):
    """A call of a function, a function block instance, a method or an action, or a conversion."""

    callee: Expression
    arguments: tuple[Argument, ...] = ()

    @property
    def called(self) -> str:
        """The name that is called; empty for a path, as to a method."""
        return self.callee.identifier if isinstance(self.callee, Name) else ""


class Operator(StrEnum):
    """Operators by the name that IEC 61131-3 gives them. ``&`` reads as AND."""

    OR = "OR"
    OR_ELSE = "OR_ELSE"
    XOR = "XOR"
    AND = "AND"
    AND_THEN = "AND_THEN"
    EQUAL = "="
    UNEQUAL = "<>"
    LESS = "<"
    GREATER = ">"
    LESS_OR_EQUAL = "<="
    GREATER_OR_EQUAL = ">="
    ADD = "+"
    SUBTRACT = "-"
    MULTIPLY = "*"
    DIVIDE = "/"
    MODULO = "MOD"
    POWER = "**"
    NOT = "NOT"
    NEGATE = "neg"
    PLUS = "pos"


OPPOSITES = {
    Operator.EQUAL: Operator.UNEQUAL,
    Operator.UNEQUAL: Operator.EQUAL,
    Operator.LESS: Operator.GREATER_OR_EQUAL,
    Operator.GREATER_OR_EQUAL: Operator.LESS,
    Operator.GREATER: Operator.LESS_OR_EQUAL,
    Operator.LESS_OR_EQUAL: Operator.GREATER,
}
"""Comparisons, each with the one that is FALSE where it is TRUE, but for values without an order such as NaN."""
COMPARISONS = frozenset(OPPOSITES)
CONNECTIVES = frozenset({Operator.AND, Operator.OR, Operator.XOR, Operator.AND_THEN, Operator.OR_ELSE})


@dataclass(frozen=True, slots=True)
class Unary(Node):
    """``NOT x``, ``-x``, ``+x``."""

    operator: Operator
    operand: Expression


@dataclass(frozen=True, slots=True)
class Operation(Node):
    """Operands joined by one operator.

    AND, OR, XOR, + and * hold all operands of a row without parentheses; all others exactly two, the left
    one first.
    """

    operator: Operator
    operands: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Parenthesized(Node):
    """``(x)``. Kept because people set parentheses to be understood; `bare` looks through them."""

    inner: Expression


@dataclass(frozen=True, slots=True)
class TypeOperand(Node):
    """A type as an operand of ``__NEW`` or ``SIZEOF`` (CODESYS): ``POINTER TO base``, ``ARRAY[bounds] OF base``.

    `words` are ``POINTER TO``, ``REFERENCE TO`` or ``ARRAY``. A type that is a name alone is a `Name`.
    """

    words: str
    bounds: tuple[Range, ...]
    base: Expression


Expression: TypeAlias = (
    "Name | Literal | Address | Member | Index | Dereference | Peripheral | Call | Unary | Operation"
    " | Parenthesized | AssignmentExpression | TypeOperand"
)
"""Any expression."""
Operand: TypeAlias = Name | Member | Index | Address
"""What has the value of a variable or of a part of one, but for pointers."""


@dataclass(frozen=True, slots=True)
class AssignmentExpression(Node):
    """``target := value`` inside an expression (CODESYS; SCL for ``a := b := c``)."""

    target: Expression
    value: Expression


class AssignmentKind(StrEnum):
    """Operator of an assignment: ``:=``; ``S=``, ``R=``, ``REF=`` of CODESYS; ``+=`` and the like of SCL; ``?=``."""

    ASSIGN = ":="
    SET = "S="
    RESET = "R="
    REFERENCE = "REF="
    ATTEMPT = "?="
    ADD = "+="
    SUBTRACT = "-="
    MULTIPLY = "*="
    DIVIDE = "/="


CALCULATING_ASSIGNMENTS = {
    AssignmentKind.ADD: Operator.ADD,
    AssignmentKind.SUBTRACT: Operator.SUBTRACT,
    AssignmentKind.MULTIPLY: Operator.MULTIPLY,
    AssignmentKind.DIVIDE: Operator.DIVIDE,
}
"""The operations of ``a += b`` and the like."""


@dataclass(frozen=True, slots=True)
class Assignment(Node):
    """``target := value;``"""

    target: Expression
    value: Expression
    kind: AssignmentKind = AssignmentKind.ASSIGN


@dataclass(frozen=True, slots=True)
class CallStatement(Node):
    """A call as a statement. In CODESYS an action may be called without parentheses: then it is no `Call`."""

    call: Expression


@dataclass(frozen=True, slots=True)
class Branch(Node):
    """One condition of an IF with the statements below it."""

    condition: Expression
    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class If(Node):
    """``IF .. THEN .. ELSIF .. ELSE .. END_IF``. `otherwise` None: there is no ELSE."""

    branches: tuple[Branch, ...]
    otherwise: tuple[Statement, ...] | None = None


@dataclass(frozen=True, slots=True)
class Range(Node):
    """``lower..upper``, both included: in a label of a CASE."""

    lower: Expression
    upper: Expression


@dataclass(frozen=True, slots=True)
class CaseBranch(Node):
    """The labels of one branch of a CASE and its statements."""

    labels: tuple[Expression | Range, ...]
    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Case(Node):
    """``CASE selector OF .. ELSE .. END_CASE``. `otherwise` None: there is no ELSE."""

    selector: Expression
    branches: tuple[CaseBranch, ...]
    otherwise: tuple[Statement, ...] | None = None


@dataclass(frozen=True, slots=True)
class For(Node):
    """``FOR variable := start TO end BY step DO .. END_FOR``."""

    variable: Expression
    start: Expression
    end: Expression
    step: Expression | None
    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class While(Node):
    """``WHILE condition DO .. END_WHILE``."""

    condition: Expression
    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Repeat(Node):
    """``REPEAT .. UNTIL condition END_REPEAT``."""

    statements: tuple[Statement, ...]
    condition: Expression


@dataclass(frozen=True, slots=True)
class RegionBlock(Node):
    """``REGION title .. END_REGION`` (SCL): folds in the editor, means nothing."""

    title: str
    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Try(Node):
    """``__TRY .. __CATCH(error) .. __FINALLY .. __ENDTRY`` (CODESYS)."""

    statements: tuple[Statement, ...]
    error: Expression | None
    handler: tuple[Statement, ...] | None
    finally_: tuple[Statement, ...] | None


@dataclass(frozen=True, slots=True)
class Exit(Node):
    """``EXIT``: leaves the innermost loop."""


@dataclass(frozen=True, slots=True)
class Continue(Node):
    """``CONTINUE``: goes on with the next turn of the innermost loop."""


@dataclass(frozen=True, slots=True)
class ReturnStatement(Node):
    """``RETURN``: leaves the POU. `value`: CODESYS allows none, newer IEC dialects do."""

    value: Expression | None = None


@dataclass(frozen=True, slots=True)
class Goto(Node):
    """``GOTO label`` (SCL), ``JMP label`` (CODESYS)."""

    label: Name
    keyword: str = "GOTO"


@dataclass(frozen=True, slots=True)
class LabelStatement(Node):
    """``label:``, where GOTO goes."""

    label: Name


@dataclass(frozen=True, slots=True)
class Empty(Node):
    """A semicolon on its own."""


@dataclass(frozen=True, slots=True)
class Remark(Node):
    """A comment of statements that are made; of a text that is read comments are no part of the tree.

    `beside`: at the end of the line before it. At the beginning of a branch of an IF it is printed above the condition.
    Without text it is an empty line.
    """

    text: str
    beside: bool = False


@dataclass(frozen=True, slots=True)
class EmbeddedCode(Node):
    """Code in C among statements, ``{{ .. }}`` with its braces (Beremiz, OpenPLC): the compiler passes it on."""

    text: str


@dataclass(frozen=True, slots=True)
class Unreadable(Node):
    """Text that does not parse, kept unchanged. A problem tells why."""

    text: str


Statement: TypeAlias = (
    "Assignment | CallStatement | If | Case | For | While | Repeat | RegionBlock | Try | Exit | Continue"
    " | ReturnStatement | Goto | LabelStatement | Empty | Remark | EmbeddedCode | Unreadable"
)
"""Any statement."""


@dataclass(frozen=True, slots=True)
class Statements(Node):
    """The statements of a body."""

    statements: tuple[Statement, ...]


def bare(expression: Expression) -> Expression:
    """Return the expression inside any parentheses around it."""
    while isinstance(expression, Parenthesized):
        expression = expression.inner
    return expression
