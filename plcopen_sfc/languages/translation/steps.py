"""References to steps: whether a step is active, and for how long."""

from __future__ import annotations

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Quoting
from plcopen_sfc.languages.translation.context import StepNotation, StepReferences
from plcopen_sfc.languages.translation.notes import Notes
from plcopen_sfc.languages.words import needs_quotes

_ACTIVE, _TIME, _OWN_TIME = "X", "T", "U"


class StepTranslator:
    """Finds references to steps and writes them in the notation of the target."""

    def __init__(self, references: StepReferences, notes: Notes) -> None:
        self._names = {name.casefold(): new for name, new in references.names.items()}
        self._references = references
        self._notes = notes

    def translated(self, node: n.Name | n.Member) -> Expression | None:
        """The reference in the notation of the target; None: `node` refers to no step."""
        found = self._read(node)
        if found is None:
            return None
        step, quantity = found
        new = self._names[step.casefold()]
        if self._references.source is self._references.target and self._stays(step, new):
            return node
        written = self._write(new, quantity)
        if written is None:
            reason = f"steps have no counterpart of .{quantity} in the notation of {self._references.target.value}"
            self._notes.add(Severity.ERROR, f"{reason}; left as it stands", node)
            return node
        if quantity == _OWN_TIME and self._references.target is not StepNotation.S7_GRAPH:
            self._notes.add(Severity.WARNING, ".U is the time without disturbances, .T also counts these", node)
        return written

    def _stays(self, step: str, new: str) -> bool:
        return step == new and self._references.source_block == self._references.target_block

    def _read(self, node: n.Name | n.Member) -> tuple[str, str] | None:
        """Name of the step and what is asked of it: ``X`` whether it is active, ``T`` its time, or a tool's own."""
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
