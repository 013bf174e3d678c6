"""Comparing lowered code with its chart."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from time import monotonic
from typing import Any, NamedTuple, Unpack

from plcopen_sfc.analysis.equivalence import Searching, equivalent
from plcopen_sfc.analysis.limits import seconds
from plcopen_sfc.analysis.verdict import Verdict, VerdictKind
from plcopen_sfc.errors import Location, LoweringError, SfcError, UntestedError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.translation.renames import identifier, is_identifier, is_reserved
from plcopen_sfc.lowering.code.program import BOOL
from plcopen_sfc.lowering.code.surroundings import names_of
from plcopen_sfc.lowering.operating import compared_while_operated, operating_inputs
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.semantics.charts.flags import COMMANDS, flags_in_use
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.simulation import Simulation
from plcopen_sfc.semantics.subjects import Subject

_LEAST_LIMIT = 0.1
_STATES = 20_000
"""What is searched in seconds to minutes, according to the size of the chart."""


class ProofOptions(NamedTuple):
    """What a user wants of a proof: to take code of which not all was reached, and how to search (`equivalent`)."""

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
    """What comparing `code` with `chart` comes to; arguments as in `equivalent`.

    Raises `LoweringError` where one of them cannot be executed: it calls what the simulator does not know, or its texts
    are wrong in their types.

    The parameters of an S7-GRAPH block multiply its states: see `compared_while_operated`.
    """
    chart, code = compared_subjects(chart, code, profile)
    try:
        inputs = _renamed_inputs(chart, code, profile)
        limit = seconds(searching.get("limit"))
        start = monotonic()

        def compared(**narrowed: Any) -> Verdict:
            if limit is not None:
                searching["limit"] = max(start + limit - monotonic(), _LEAST_LIMIT)
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
    raise UntestedError(
        f"the code is equal to the chart where both were run, but not all was reached: {found}",
        verdict=found,
        location=Location(path=name),
        hint=""
        if found.interrupted
        else "accept_untested=True, --accept-untested takes it knowingly."
        + (" free_inputs, --free make inputs of frozen variables." if found.frozen else ""),
    )


def compared_subjects(chart: Subject, code: Subject, profile: Profile) -> tuple[Subject, Subject]:
    """The same with SFC flags of CODESYS that are local as inputs.

    A visualisation writes them, or a call of the chart from elsewhere.
    """
    commands = _commands(chart, profile)
    if not commands:
        return chart, code
    return _with_inputs(chart, commands), _with_inputs(code, commands)


def _renamed_inputs(chart: Subject, code: Subject, profile: Profile) -> dict[str, str]:
    """What variables that nobody declares are called in the code, if its dialect does not take their names."""
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
    """A pattern of what a name is called in a dialect."""
    if is_identifier(name) and not is_reserved(name, target):
        return re.escape(name)
    return re.escape(identifier(name)) + "(_[0-9]+)?"


def _incomparable(chart: Subject, why: str) -> LoweringError:
    return LoweringError(
        f"the code cannot be compared with the chart: {why}",
        location=Location(path=chart.name),
        hint="It can be lowered without the proof: verify=False, --no-verify.",
    )


def _commands(chart: Subject, profile: Profile) -> dict[str, str]:
    """The SFC flags that operate a chart, or charts of actions beside it, by their names in lower case."""
    charts = [body.chart for _, _, body in chart.pou.named_bodies() if isinstance(body, SfcBody)]
    own = {v.name.casefold() for v in chart.pou.variables()}
    known = own | names_of(chart.project)
    used = {flag for each in charts for flag in flags_in_use(each, profile, lambda name: name.casefold() in known)}
    around = known - own
    names = sorted(flag.variable for flag in used & COMMANDS)
    return {name.casefold(): name for name in names if name.casefold() not in around}


def _with_inputs(subject: Subject, names: Mapping[str, str]) -> Subject:
    """The same with variables of these names as inputs, if they are local, or if only the tool declares them."""
    old = subject.pou.interface
    interface = old.model_copy(deep=True, update={"declaration": None}) if old is not None else Interface()
    declared = {variable.name.casefold() for variable in interface.variables()}
    inputs = [Variable(name=name, type=BOOL) for key, name in names.items() if key not in declared]
    for section in interface.sections:
        if section.kind is SectionKind.LOCAL:
            inputs += [v for v in section.variables if v.name.casefold() in names]
            section.variables = [v for v in section.variables if v.name.casefold() not in names]
    interface.sections.append(VariableSection(kind=SectionKind.INPUT, variables=inputs))
    return replace(subject, pou=subject.pou.model_copy(update={"interface": interface}))
