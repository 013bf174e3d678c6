"""SFC flags of CODESYS that nothing in a project uses: the chart runs as if it had none."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.s7_programs import instance_types
from plcopen_sfc.model.chart_settings import OPERATING_FLAGS, SfcFlag
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import SimpleValue


def named_flags(names: Names) -> frozenset[str]:
    """Return the flags that something in a project reads or writes, in lower case; a declaration as text does not."""
    words = [flag.variable for flag in SfcFlag]
    found = (each for each in names.occurrences(*words) if not each.reference.declares)
    return frozenset(each.reference.name.casefold() for each in found)


def flags_at_rest(project: Project, pou: Pou, flags: Iterable[SfcFlag], named: Collection[str]) -> set[SfcFlag]:
    """Return those `flags` of the charts of `pou` that nothing in the project uses.

    `named` are the names of the `named_flags`. An input that operates a chart is inactive only where the project has an
    instance of the block, and where it does not start with TRUE: people may operate a program, as may other projects.
    """
    declared = {variable.name.casefold(): variable for variable in pou.variables()}
    unnamed = [flag for flag in flags if flag.variable.casefold() not in named]
    is_closed = bool(unnamed) and pou.name.casefold() in instance_types(project)
    found: set[SfcFlag] = set()
    for flag in unnamed:
        variable = declared.get(flag.variable.casefold())
        start = variable.initial if variable is not None else None
        starts_on = isinstance(start, SimpleValue) and (start.text or "").strip().upper() in _TRUE
        if flag not in OPERATING_FLAGS or (is_closed and not starts_on):
            found.add(flag)
    return found


_TRUE = ("TRUE", "1", "BOOL#TRUE", "BOOL#1")
