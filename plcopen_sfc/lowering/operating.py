"""Comparing lowered sequencers of S7-GRAPH with their charts, whose parameters multiply their states.

Each command that could just have risen doubles them, and a block has a dozen. So there are searches while the inputs
that operate a sequencer rest, and while only some of them are operated that act together: a sum instead of a product.
All of them at once are searched as far as that is quick. The verdict says what is proven.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from plcopen_sfc.analysis.verdict import Verdict
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.semantics.charts.graph.parameters import PARAMETERS
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.subjects import Subject

_AT_REST = 5_000
_TOGETHER = 1_000
_EACH = 2_000
"""States that are searched."""

_GROUPS = (
    ("OFF_SQ", "INIT_SQ"),
    ("ACK_EF", "REG_EF", "REG_S"),
    ("S_PREV", "S_NEXT"),
    ("SW_AUTO", "SW_TAP", "T_PUSH"),
    ("SW_AUTO", "SW_TOP", "T_PUSH"),
    ("SW_AUTO", "SW_MAN"),
)
"""Inputs that act together, in upper case: the start and the end, acknowledging, the display, each mode."""

_BY_HAND = frozenset({"SW_AUTO", "SW_MAN", "S_SEL", "S_ON", "S_OFF", "S_PREV", "S_NEXT"})
"""Inputs by which steps are switched one by one, and looked at.

They have too many states for a proof: each number of S_SEL is another one. But several steps of a sequence are active
in manual mode only, and runs in which everything is operated rarely stay in it: mutants of the display survived there.
"""


def operating_inputs(chart: Subject, profile: Profile) -> dict[str, int]:
    """The inputs of a block that operate its sequencer, and their values at rest."""
    if not profile.graph_parameters:
        return {}
    return {v.name: 0 for v in chart.pou.variables(SectionKind.INPUT) if v.name.upper() in PARAMETERS}


def compared_while_operated(
    compared: Callable[..., Verdict], operating: Mapping[str, int], fixed: Mapping[str, bool], cap: int, runs: int
) -> Verdict:
    """What `compared` comes to. `operating`: inputs that operate the sequencer; others as in `equivalent`."""
    operated = [name for name in operating if name not in fixed]
    if not operated:
        return compared(fixed=fixed, cap=cap, runs=runs)
    at_rest = compared(fixed={**operating, **fixed}, cap=min(cap, _AT_REST), runs=1)
    if at_rest.different or at_rest.interrupted:
        return at_rest
    groups = [group for group in _groups(operated) if len(group) < len(operated)]
    found = compared(fixed=fixed, cap=min(cap, _TOGETHER if groups else _EACH), runs=runs)
    if found.proven or found.different or found.interrupted:
        return found
    found = found.joined(at_rest)
    if not at_rest.proven:
        return found
    proven: list[str] = []
    for group in groups:
        others = {name: value for name, value in operating.items() if name not in group}
        each = compared(fixed={**others, **fixed}, cap=min(cap, _EACH), runs=1)
        if each.different or each.interrupted:
            return each
        found = found.joined(each)
        if each.proven:
            proven.append(f"{' and '.join(group)} ({each.states} states)")
    if any(name.upper() == "S_SEL" for name in operated):
        others = {name: value for name, value in operating.items() if name.upper() not in _BY_HAND}
        each = compared(fixed={**others, **fixed}, cap=1, runs=runs)
        if each.different or each.interrupted:
            return each
        found = found.joined(each)
    known = f"while {', '.join(operated)} are FALSE it is proven: {at_rest.states} states"
    if proven:
        known += f"; and while only these of them are operated: {'; '.join(proven)}"
    return replace(found, reason=f"{found.reason}; {known}")


def _groups(operated: Sequence[str]) -> list[list[str]]:
    """The groups of which a block has inputs, without those that are a part of another one."""
    found = dict.fromkeys(frozenset(name for name in operated if name.upper() in group) for group in _GROUPS)
    largest = [group for group in found if group and not any(group < other for other in found)]
    return [[name for name in operated if name in group] for group in largest]
