"""How networks of TIA Portal remember: flip-flops and edges keep their state in a variable, not in an instance.

``Sr`` there is the flip-flop whose reset dominates, RS of IEC 61131-3; ``PBox`` and ``NBox`` are the edges.
"""

from __future__ import annotations

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import FALSE, assignment, call
from plcopen_sfc.lowering.code.memory import BlockMemory


class OperandMemory(BlockMemory):
    """Boxes with an operand. In the statements the operand is called, as if it were an instance."""

    has_instances = False

    def latch(
        self, wanted: str, set_: Expression, reset: Expression, into: list[Statement], flag: Expression | None = None
    ) -> Expression:
        """An ``Sr`` on the flag itself."""
        value = flag
        if value is None:
            value = self._code.declare(wanted)
            self.ends.append(assignment(value, FALSE))
        into.append(call(value, S=set_, R1=reset))
        self._code.operands[value] = "RS"
        return n.Member(value, n.Name("Q1")) if flag is None else flag

    def starting(self) -> Expression:
        """The flag is the memory itself."""
        return FALSE

    def rising(self, wanted: str, value: Expression, into: list[Statement], *, kept: bool = False) -> Expression:
        """A ``PBox``."""
        return self._edge("R_TRIG", wanted, value, into, kept=kept)

    def falling(self, wanted: str, value: Expression, into: list[Statement]) -> Expression:
        """An ``NBox``, which sees no edge in the first scan."""
        return self._edge("F_TRIG", wanted, value, into, kept=False)

    def _edge(self, block: str, wanted: str, value: Expression, into: list[Statement], *, kept: bool) -> Expression:
        pulse = self._code.declare(wanted)
        before = self._code.declare(self._code.texts.with_suffix(wanted, "old"))
        self._code.operands[before] = block
        into.append(call(before, CLK=value))
        into.append(assignment(pulse, n.Member(before, n.Name("Q"))))
        if not kept:
            self.ends.append(assignment(before, FALSE))
        return pulse
