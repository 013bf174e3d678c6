"""Instruction list as statements."""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import nodes as n


def instruction_statements(text: str, dialect: Dialect) -> Sequence[n.Statement]:
    """The instructions of a body as statements."""
    if not text.strip():
        return ()
    raise SimulationError(f"instruction list ({dialect}) is not known to the simulator")
