"""The parameters of an S7-GRAPH block as code: its commands, its operating mode, and what it reports.

A parameter that the block does not declare makes no code.
"""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, conjunction, equal, negation, when
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import INT, Code
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.graph.texts import GraphTexts
from plcopen_sfc.semantics.charts.graph.parameters import MODES, Mode


class Commands:
    """The commands and the mode of one cycle. Names are those of the parameters."""

    def __init__(self, source: GraphSource, code: Code, memory: Memory, texts: GraphTexts) -> None:
        self._parameters, self._code, self._texts = source.parameters, code, texts
        self._memory = memory
        self._edges: dict[str, Expression] = {}
        self._statements: list[Statement] = []
        switches = [name for name in MODES if name in source.parameters]
        self._modes = {MODES[name][0]: name for name in switches} if not source.locked else {}
        self._mode: n.Name | None = None
        if set(self._modes) - {Mode.AUTOMATIC}:
            self._mode = code.declare(texts.mode, INT, initial=str(int(Mode.AUTOMATIC)), comment=texts.mode_comment)
            for mode, name in self._modes.items():
                number = n.Literal(str(int(mode)))
                self._statements.append(when(self.edge(name), assignment(self._mode, number)))

    def variable(self, name: str) -> n.Name | None:
        """The variable of a parameter; None where the block does not have it."""
        declared = self._parameters.get(name)
        return self._code.naming.local(declared) if declared is not None else None

    def edge(self, name: str) -> Expression:
        """Whether a parameter rises; FALSE where the block does not have it."""
        if name not in self._edges:
            variable = self.variable(name)
            wanted = self._code.texts.with_suffix(name, "edge")
            self._edges[name] = FALSE if variable is None else self._memory.rising(wanted, variable, self._statements)
        return self._edges[name]

    @property
    def told(self) -> str:
        """What people must know of the mode, where there are several."""
        return self._texts.mode_comment if self._mode is not None else ""

    def statements(self) -> Sequence[Statement]:
        """Finds the edges that were asked for, and the mode. Stands before all that asks."""
        return self._statements

    def is_on(self, mode: Mode) -> Expression:
        """Whether the sequencer is in this mode."""
        if self._mode is None:
            return TRUE if mode is Mode.AUTOMATIC else FALSE
        if mode is not Mode.AUTOMATIC and mode not in self._modes:
            return FALSE
        return equal(self._mode, n.Literal(str(int(mode))))

    def permitted(self) -> Expression:
        """Whether transitions that are satisfied switch."""
        inching = negation(conjunction([self.is_on(Mode.INCHING), negation(self.edge("T_PUSH"))]))
        if Mode.INCHING not in self._modes:
            inching = TRUE
        return conjunction([negation(self.is_on(Mode.MANUAL)), inching])

    def pushed(self) -> Expression:
        """Whether transitions switch although they are not satisfied."""
        if Mode.AUTOMATIC_OR_STEP_BY_STEP not in self._modes:
            return FALSE
        return conjunction([self.is_on(Mode.AUTOMATIC_OR_STEP_BY_STEP), self.edge("T_PUSH")])
