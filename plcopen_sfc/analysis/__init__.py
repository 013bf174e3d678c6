"""What can be said about charts: markings, soundness, exclusive conditions; and whether two of them do the same."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from plcopen_sfc.analysis.equivalence import Searching, equivalent
    from plcopen_sfc.analysis.verdict import Counterexample, Difference, Verdict, VerdictKind

_HOMES = {
    "Counterexample": "verdict",
    "Difference": "verdict",
    "Searching": "equivalence",
    "Verdict": "verdict",
    "VerdictKind": "verdict",
    "equivalent": "equivalence",
}

__all__ = ["Counterexample", "Difference", "Searching", "Verdict", "VerdictKind", "equivalent"]


def __getattr__(name: str) -> Any:
    """Import the comparison when it is asked for: it brings the interpreters with it, which checks do not need."""
    if name not in _HOMES:
        raise AttributeError(f"module 'plcopen_sfc.analysis' has no attribute {name!r}")
    return getattr(import_module(f"plcopen_sfc.analysis.{_HOMES[name]}"), name)
