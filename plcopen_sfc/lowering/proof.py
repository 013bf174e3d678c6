"""Comparison of lowered code with its chart.

The parameters of an S7-GRAPH block multiply the states of its sequencer: each command that could just have risen
doubles them, and a block has a dozen. So there are searches while the inputs that operate a sequencer have their values
at rest, and while only some of them are operated that act together: a sum instead of a product. All of them at once are
searched as far as that is quick. The verdict names what is proven.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, Unpack

from plcopen_sfc.analysis.equivalence import Searching, equivalent
from plcopen_sfc.analysis.pairing import with_commands
from plcopen_sfc.analysis.search_limits import seconds, spent
from plcopen_sfc.analysis.verdict import UntestedError, Verdict, VerdictKind
from plcopen_sfc.errors import Location, LoweringError, SfcError
from plcopen_sfc.languages.words import identifier, is_identifier, is_reserved
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.semantics.charts.graph.graph_parameters import PARAMETERS
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.simulation import Simulation
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
    """Return the inputs of a block that operate its sequencer, and their values at rest."""
    if not profile.graph_parameters:
        return {}
    return {v.name: 0 for v in chart.pou.variables(SectionKind.INPUT) if v.name.upper() in PARAMETERS}


def compared_while_operated(
    compared: Callable[..., Verdict], operating: Mapping[str, int], fixed: Mapping[str, bool], cap: int, runs: int
) -> Verdict:
    """Return the verdict of `compared`. `operating`: inputs that operate the sequencer; others as in `equivalent`."""
    operated = [name for name in operating if name not in fixed]
    if not operated:
        return compared(fixed=fixed, cap=cap, runs=runs)
    # the quick one first: a difference at rest is found in seconds, and its trace is the easiest to read
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
    """Return the groups of which a block has inputs, without those that are a part of another one."""
    found = dict.fromkeys(frozenset(name for name in operated if name.upper() in group) for group in _GROUPS)
    largest = [group for group in found if group and not any(group < other for other in found)]
    return [[name for name in operated if name in group] for group in largest]


_LEAST_LIMIT = 0.1
_STATES = 20_000
"""States that are searched in seconds to minutes, according to the size of the chart."""


class ProofOptions(NamedTuple):
    """Wishes for a proof: to take code of which not all was reached, and how to search (`equivalent`)."""

    accept_untested: bool = False
    searching: Searching = {}  # noqa: RUF012  # nothing writes it


def prove(
    chart: Subject,
    code: Subject,
    profile: Profile,
    *,
    fixed: Mapping[str, bool],
    left_out: str | None,
    step_flags: Mapping[str, str] | None,
    cap: int = _STATES,
    runs: int = 100,
    scans: int = 200,
    **searching: Unpack[Searching],
) -> Verdict:
    """Compare `code` with `chart`; arguments as in `equivalent`.

    Raises `LoweringError` where one of them cannot be executed: it calls what the simulator does not know, or its texts
    are wrong in their types.

    The parameters of an S7-GRAPH block multiply its states: see `compared_while_operated`.
    """
    chart, code = with_commands(chart, code, profile)
    try:
        inputs = _renamed_inputs(chart, code, profile)
        limit = seconds(searching.get("limit"))
        start = spent()

        def compared(**narrowed: Any) -> Verdict:
            if limit is not None:
                # the limit is for all searches together
                searching["limit"] = max(start + limit - spent(), min(limit, _LEAST_LIMIT))
            return equivalent(
                chart,
                code,
                profile,
                inputs=inputs,
                left_out=left_out,
                step_flags=step_flags,
                scans=scans,
                **searching,
                **narrowed,
            )

        operating = operating_inputs(chart, profile)
        found = compared_while_operated(compared, operating, fixed, cap, runs)
    except SfcError as error:
        raise _incomparable(chart, error.message) from error
    differences = found.counterexample.differences if found.counterexample is not None else ()
    failure = next((each.error for each in differences if each.error), "")
    if failure:
        raise _incomparable(chart, failure)
    return found


def refuse_untested(name: str, found: Verdict, *, accepted: bool = False) -> None:
    """Raise `UntestedError` where not all was reached, unless that is accepted; an interruption never is."""
    if found.kind is not VerdictKind.UNTESTED or (accepted and not found.interrupted):
        return
    ended = "the comparison was interrupted, so " if found.interrupted else ""
    hint = "Look at what was not reached: --accept-untested (accept_untested=True) takes the code as it is."
    hint += " --free NAME (free_inputs) makes inputs of frozen variables." if found.frozen else ""
    so_far = "the code is equal to the chart where both were run, but "
    if found.ran_nothing:
        so_far, hint = (
            "neither the chart nor the code can be run: ",
            "Mend what is wrong in the chart: check tells more.",
        )
    raise UntestedError(
        f"{so_far}{ended}{found}",
        verdict=found,
        location=Location(path=name),
        hint="" if found.interrupted else hint,
    )


def _renamed_inputs(chart: Subject, code: Subject, profile: Profile) -> dict[str, str]:
    """Return the names of undeclared variables in the chart, by their names in the code."""
    target = code.project.dialect
    if target in (chart.project.dialect, Dialect.SCL):
        return {}
    mine, theirs = (
        {name.casefold(): name for name in Simulation(each, profile=profile).undeclared} for each in (chart, code)
    )
    found: dict[str, str] = {}
    for old in (name for name in mine if name not in theirs):
        like = re.compile(r"\.".join(_renamed(part, target) for part in mine[old].split(".")), re.IGNORECASE)
        new = [name for key, name in theirs.items() if key not in mine and like.fullmatch(name)]
        if len(new) == 1:
            found[new[0]] = mine[old]
    return found


def _renamed(name: str, target: Dialect) -> str:
    """Return a pattern of the names that a variable can have in a dialect."""
    if is_identifier(name) and not is_reserved(name, target):
        return re.escape(name)
    return re.escape(identifier(name)) + "(_[0-9]+)?"


def _incomparable(chart: Subject, why: str) -> LoweringError:
    return LoweringError(
        f"the code cannot be compared with the chart: {why}",
        location=Location(path=chart.name),
        hint="It can be lowered without the proof: verify=False, --no-verify.",
    )
