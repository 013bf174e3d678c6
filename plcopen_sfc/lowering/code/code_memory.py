"""Memory of lowered code: function blocks in networks, operands in those of TIA Portal, variables in text."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    call,
    conjunction,
    disjunction,
    is_constant,
    negation,
    not_all,
    when,
)
from plcopen_sfc.lowering.code.lowered_code import LoweredCode
from plcopen_sfc.model.types import DerivedType


class Memory(ABC):
    """Flip-flops, edges and timers of `code`.

    `ends`: a condition that sets all of them back to their start, but for those with a `flag` and edges that are
    `kept`.
    """

    has_instances: ClassVar[bool] = False
    """True if flip-flops keep a value of their own besides their `flag`, which is FALSE at the start."""

    def __init__(self, code: LoweredCode) -> None:
        self.code = code
        self.ends: list[Statement] = []

    @abstractmethod
    def latch(
        self, wanted: str, set_: Expression, reset: Expression, into: list[Statement], flag: Expression | None = None
    ) -> Expression:
        """Return a flip-flop whose reset dominates. `flag`: the variable that gets its value."""

    @abstractmethod
    def conditional(self, wanted: str, condition: Expression, statements: Sequence[Statement]) -> list[Statement]:
        """Return statements executed under a condition, which none of them changes unless it is `wanted` by name."""

    def starting(self) -> Expression:
        """Return the condition to set a flip-flop whose `flag` is TRUE at the start; FALSE: the flag is enough."""
        return self.code.first_scan_pulse() if self.has_instances else FALSE

    @abstractmethod
    def rising(self, wanted: str, value: Expression, into: list[Statement], *, kept: bool = False) -> Expression:
        """Return an expression that is TRUE in the scan in which `value` becomes TRUE."""

    def falling(self, wanted: str, value: Expression, into: list[Statement]) -> Expression:
        """Return an expression that is TRUE in the scan in which `value` becomes FALSE.

        A variable keeps the last value: an F_TRIG sees an edge in the first scan if its input is FALSE.
        """
        pulse, end = _edge(self.code, wanted, value, into, rising=False)
        self.ends.append(end)
        return pulse

    def ended(
        self,
        wanted: str,
        value: Expression,
        into: list[Statement],
        behind: list[Statement],  # noqa: ARG002
    ) -> tuple[Expression, Expression]:
        """Return the same, and what was TRUE in the last scan, of a value that stays the same until `behind`.

        Statements may be added to `behind`; a restart must end what is returned second.
        """
        return self.falling(self.code.texts.with_suffix(wanted, "end"), value, into), value

    def remembered(self, wanted: str, value: Expression, behind: list[Statement]) -> Expression:  # noqa: ARG002
        """Return the value in the last scan, of one that stays the same until `behind`."""
        return value

    def delayed(self, wanted: str, value: Expression, time: Expression, into: list[Statement]) -> Expression:
        """Return an expression that is TRUE when `value` has been TRUE for `time`.

        The TON is called in every scan: otherwise it would not notice that its input went FALSE.
        """
        timer = self.code.declare(wanted, DerivedType(name="TON"))
        into.append(call(timer, IN=value, PT=time))
        # a restart must end the time at once, and not with the next call
        self.ends.append(call(timer, IN=FALSE, PT=time))
        return n.Member(timer, n.Name("Q"))

    def named(self, wanted: str, value: Expression, into: list[Statement]) -> Expression:
        """Return the value as a variable, to be used several times."""
        flag = self.code.declare(wanted)
        into.append(assignment(flag, value))
        return flag


class BlockMemory(Memory):
    """Instances of RS, R_TRIG and TON (IEC 61131-3 ed. 3, 6.6.3.5)."""

    has_instances = True

    def latch(
        self, wanted: str, set_: Expression, reset: Expression, into: list[Statement], flag: Expression | None = None
    ) -> Expression:
        """Return an RS, whose inputs are ``S`` and ``R1``."""
        block = self.code.declare(wanted, DerivedType(name="RS"))
        into.append(call(block, **self._inputs(set_, reset)))
        value = n.Member(block, n.Name("Q1"))
        if flag is None:
            self.ends.append(call(block, **self._inputs(FALSE, TRUE)))
            return value
        into.append(assignment(flag, value))
        return flag

    def _inputs(self, set_: Expression, reset: Expression) -> dict[str, Expression]:
        """Return the inputs of an RS, which CODESYS calls ``SET`` and ``RESET1``."""
        # the block is the same one; at Siemens its name is SR, and RS is the set-dominant one
        names = ("SET", "RESET1") if self.code.tool is Tool.CODESYS else ("S", "R1")
        return dict(zip(names, (set_, reset), strict=True))

    def conditional(self, wanted: str, condition: Expression, statements: Sequence[Statement]) -> list[Statement]:
        """Return the statements one by one, as networks need them."""
        found: list[Statement] = []
        if wanted and len(statements) > 1 and not isinstance(condition, n.Name):
            # the statements could change what the condition reads, and each network has the condition again
            condition = self.named(wanted, condition, found)
        return [*found, *_apart(condition, statements)]

    def rising(self, wanted: str, value: Expression, into: list[Statement], *, kept: bool = False) -> Expression:
        """Return an R_TRIG."""
        block = self.code.declare(wanted, DerivedType(name="R_TRIG"))
        into.append(call(block, CLK=value))
        if not kept:
            self.ends.append(call(block, CLK=FALSE))
        return n.Member(block, n.Name("Q"))


class BitMemory(Memory):
    """Boolean variables, which every dialect of structured text knows, and TON."""

    def latch(
        self, wanted: str, set_: Expression, reset: Expression, into: list[Statement], flag: Expression | None = None
    ) -> Expression:
        """Return the flag, after ``flag := (set OR flag) AND NOT reset``."""
        value = flag or self.code.declare(wanted)
        # reset dominates: the same as RS, and no instance for every step
        into.append(assignment(value, conjunction([disjunction([set_, value]), negation(reset)])))
        if flag is None:
            self.ends.append(assignment(value, FALSE))
        return value

    def conditional(self, wanted: str, condition: Expression, statements: Sequence[Statement]) -> list[Statement]:  # noqa: ARG002
        """Return all statements in one IF."""
        if is_constant(condition, TRUE):
            return list(statements)
        return [when(condition, *statements)] if statements and not is_constant(condition, FALSE) else []

    def named(self, wanted: str, value: Expression, into: list[Statement]) -> Expression:
        """Return the value as a variable, which it may be already, or as the output of a timer."""
        variable = value.base if isinstance(value, n.Member) else value
        if isinstance(variable, n.Name) and variable.identifier.casefold() in self.code.own_names:
            return value
        return super().named(wanted, value, into)

    def ended(
        self,
        wanted: str,
        value: Expression,
        into: list[Statement],  # noqa: ARG002
        behind: list[Statement],
    ) -> tuple[Expression, Expression]:
        """Return ``before AND NOT value``, and ``before``; of ``a AND b`` that is ``before AND (NOT a OR NOT b)``."""
        before = self.remembered(wanted, value, behind)
        return conjunction([before, not_all(value)]), before

    def remembered(self, wanted: str, value: Expression, behind: list[Statement]) -> Expression:
        """Return a variable with the value of the last scan: the value itself may be reset first."""
        before = self.code.declare(self.code.texts.with_suffix(wanted, "before"))
        behind.append(assignment(before, value))
        return before

    def rising(self, wanted: str, value: Expression, into: list[Statement], *, kept: bool = False) -> Expression:
        """Return ``value AND NOT`` the value of the last scan."""
        pulse, end = _edge(self.code, wanted, value, into, rising=True)
        if not kept:
            self.ends.append(end)
        return pulse


def _edge(
    code: LoweredCode, wanted: str, value: Expression, into: list[Statement], *, rising: bool
) -> tuple[Expression, Statement]:
    """Return an edge, and the statement that forgets it."""
    pulse, before = code.declare(wanted), code.declare(code.texts.with_suffix(wanted, "old"))
    now, then = (value, negation(before)) if rising else (negation(value), before)
    # two variables instead of an R_TRIG: every dialect of structured text has them
    into.append(assignment(pulse, conjunction([now, then])))
    into.append(assignment(before, value))
    return pulse, assignment(before, FALSE)


def _apart(condition: Expression, statements: Sequence[Statement]) -> list[Statement]:
    """Return each statement under all its conditions: a network holds neither several nor nested ones."""
    found: list[Statement] = []
    for statement in statements:
        if isinstance(statement, n.If) and len(statement.branches) == 1 and statement.otherwise is None:
            inner = statement.branches[0]
            if len(inner.statements) == 1:
                found += _apart(conjunction([condition, inner.condition]), inner.statements)
                continue
        found.append(when(condition, statement))
    return found


class OperandMemory(BlockMemory):
    """Boxes with an operand. The statements call the operand, as if it were an instance."""

    has_instances = False

    def latch(
        self, wanted: str, set_: Expression, reset: Expression, into: list[Statement], flag: Expression | None = None
    ) -> Expression:
        """Return an ``Sr`` on the flag itself."""
        value = flag
        if value is None:
            value = self.code.declare(wanted)
            self.ends.append(assignment(value, FALSE))
        into.append(call(value, S=set_, R1=reset))
        self.code.operands[value] = "RS"
        return n.Member(value, n.Name("Q1")) if flag is None else flag

    def rising(self, wanted: str, value: Expression, into: list[Statement], *, kept: bool = False) -> Expression:
        """Return a ``PBox``."""
        return self._edge("R_TRIG", wanted, value, into, kept=kept)

    def falling(self, wanted: str, value: Expression, into: list[Statement]) -> Expression:
        """Return an ``NBox``, which sees no edge in the first scan."""
        return self._edge("F_TRIG", wanted, value, into, kept=False)

    def _edge(self, block: str, wanted: str, value: Expression, into: list[Statement], *, kept: bool) -> Expression:
        pulse = self.code.declare(wanted)
        before = self.code.declare(self.code.texts.with_suffix(wanted, "old"))
        self.code.operands[before] = block
        into.append(call(before, CLK=value))
        into.append(assignment(pulse, n.Member(before, n.Name("Q"))))
        if not kept:
            self.ends.append(assignment(before, FALSE))
        return pulse
