"""Analysis of charts, and comparison of charts and programs.

* `checks`: the numbered rules.
* Charts with free conditions: `marking` (the marking graph), `ruled_situations` (under forcing orders),
  `soundness`, `regions`, `unreachable`.
* Conditions: `exclusivity`, with `knowledge` of names, `formulas` for z3; `joint_firings` (situations that they leave).
* Comparisons: `equivalence` with its `verdict` and `coverage`; `systems` and `pairing` (what is compared),
  `system_comparison`, `product` (the search for a proof), `sequences` (what races with a transition), `directed`
  (the search without a proof) with `goals`, their `distances`, `assigned_values` (of what variables are computed) and
  `stimuli`, `decomposition` into `program_parts`, `search_limits`.
* State of a search: `domains` and `number_terms` (values of inputs), `dead_variables` and `timers` (what is no part of
  it), `deciding_parts` (MC/DC).
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from plcopen_sfc.analysis.equivalence import Searching, equivalent
    from plcopen_sfc.analysis.pairing import Delay
    from plcopen_sfc.analysis.verdict import Counterexample, Difference, Verdict, VerdictKind

_HOMES = {
    "Counterexample": "verdict",
    "Delay": "pairing",
    "Difference": "verdict",
    "Searching": "equivalence",
    "Verdict": "verdict",
    "VerdictKind": "verdict",
    "equivalent": "equivalence",
}

__all__ = ["Counterexample", "Delay", "Difference", "Searching", "Verdict", "VerdictKind", "equivalent"]


def __getattr__(name: str) -> Any:
    """Import the comparison when it is asked for: it brings the interpreters with it, which checks do not need."""
    if name not in _HOMES:
        raise AttributeError(f"module 'plcopen_sfc.analysis' has no attribute {name!r}")
    return getattr(import_module(f"plcopen_sfc.analysis.{_HOMES[name]}"), name)
