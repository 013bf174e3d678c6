"""What can be said about charts: markings, structure, exclusive conditions; and whether two of them do the same."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from plcopen_sfc.analysis.equivalence import Verdict, equivalent

__all__ = ["Verdict", "equivalent"]


def __getattr__(name: str) -> Any:
    """Import the comparison when it is asked for: it brings the interpreters with it, which checks do not need."""
    if name not in __all__:
        raise AttributeError(f"module 'plcopen_sfc.analysis' has no attribute {name!r}")
    return getattr(import_module("plcopen_sfc.analysis.equivalence"), name)
