"""Names of a source where what was written has others: steps, transitions, variables."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator

from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.model.types import DerivedType, StructType, Variable


def names_in_the_source(project: Project, copy: Project) -> dict[str, str]:
    """Return the paths in the source of what has another name in the `copy` that was written."""
    both = list(zip(project.pous, copy.pous, strict=False))  # blocks of libraries are added behind them
    called = {new.report_path: old.report_path for old, new in both}
    pairs = [
        (old, new)
        for a, b in both
        for old, new in zip(_charts_of(a), _charts_of(b), strict=False)  # a writer may have none in actions
    ]
    for old, new in pairs:
        steps, earlier = _elements_of(old, is_flat=not new.chart.partial_charts)
        labels = new.chart.labels()
        for step in new.chart.steps:  # a writer may add steps
            if step.id in steps:
                called[f"{new.report_path} / step {step.name}"] = steps[step.id]
        for transition in new.chart.transitions:
            if transition.id in earlier:
                called[f"{new.report_path} / transition {labels[transition.id]}"] = earlier[transition.id]
    called |= _without_lists(project, copy) | _renamed_variables(project, copy)
    return {path: old for path, old in called.items() if path != old}


def _elements_of(chart: Chart, *, is_flat: bool) -> tuple[dict[int, str], dict[int, str]]:
    """Return the paths of the steps and of the transitions of a chart by the ids that they have in what is written.

    `is_flat`: partial charts were put on one level, which numbers steps and transitions as the net of the chart does.
    """
    network, path = chart.chart, chart.report_path
    if is_flat and network.partial_charts:
        from plcopen_sfc.semantics.net import Net  # noqa: PLC0415  # only for GRAFCETs

        steps, transitions = Net.of(network).report_paths(path)
        return dict(enumerate(steps, 1)), dict(enumerate(transitions, len(steps) + 1))
    return (
        {step.id: f"{path} / step {step.name}" for step in network.steps},
        {number: f"{path} / transition {label}" for number, label in network.labels().items()},
    )


def _without_lists(project: Project, copy: Project) -> dict[str, str]:
    """Return the paths of variables of lists of CODESYS where the other side has none: ``GVL.x`` is ``x``, or a tag."""
    if family(project.dialect) is not Dialect.CODESYS or family(copy.dialect) is Dialect.CODESYS:
        return {}
    sections = [section for section in project.global_sections() if section.name]
    counts = Counter(variable.name.casefold() for section in sections for variable in section.variables)
    return {
        f"global variable {variable.name}": f"global variable {section.name}.{variable.name}"
        for section in sections
        for variable in section.variables
        if counts[variable.name.casefold()] == 1
    }


def _renamed_variables(project: Project, copy: Project) -> dict[str, str]:
    """Return the paths in the source of variables whose names the dialect of the other side does not take.

    Those of members of structures are as in programs: ``POU Main / motor.is_on``, ``global variable Data.is_on``.
    """
    from plcopen_sfc.languages.translation.renames import NameScope, kept_renames  # noqa: PLC0415  # brings the parser

    found = _renamed_for_matiec(project, copy)
    from_s7, to_s7 = kept_renames(copy), kept_renames(project)
    if not (len(from_s7) or len(to_s7)):
        return found

    def old_name(scope: NameScope, name: str) -> str:
        return from_s7.old_name(scope, name) or to_s7.new_name(scope, name) or name

    def paths(
        variables: Iterable[Variable], scope: NameScope, inside: tuple[int, ...] = ()
    ) -> Iterator[tuple[str, str]]:
        for variable in variables:
            before = old_name(scope, variable.name)
            yield variable.name, before
            kind = types.get(variable.type.name.casefold()) if isinstance(variable.type, DerivedType) else variable.type
            is_looked_into = len(inside) < _DEEPEST and id(kind) not in inside  # a type may contain itself
            members = kind.members if isinstance(kind, StructType) and is_looked_into else ()
            for inner, old in paths(members, NameScope.MEMBER, (*inside, id(kind))):
                yield f"{variable.name}.{inner}", f"{before}.{old}"

    types = {each.name.casefold(): each.type for each in copy.data_types}
    for old_pou, pou in zip(project.pous, copy.pous, strict=False):
        known = {variable.name.casefold(): variable.name for variable in old_pou.variables()}
        for name, before in paths(pou.variables(), NameScope.LOCAL):
            first, dot, rest = before.partition(".")
            if first.casefold() in known:
                found[f"{pou.report_path} / {name}"] = f"{old_pou.report_path} / {known[first.casefold()]}{dot}{rest}"
    lists = {block.name for block in project.data_blocks} | {each.name or "" for each in project.global_sections()}
    declared = [(section.name or "", section.variables) for section in copy.global_sections()]
    declared += [(b.name, b.interface.variables()) for b in copy.data_blocks if b.interface and b.type_name is None]
    for name, variables in declared:
        own = old_name(NameScope.GLOBAL, name)
        is_listed = own in lists  # tags are in no list
        for inner, before in paths(variables, NameScope.MEMBER if is_listed else NameScope.GLOBAL):
            old = f"global variable {own}.{before}" if is_listed else f"global variable {before}"
            found |= {f"global variable {name}.{inner}": old} | ({} if is_listed else {f"global variable {inner}": old})
    return found


def _renamed_for_matiec(project: Project, copy: Project) -> dict[str, str]:
    """Return the paths in the source of variables that matiec does not take by their names (``tRührzeit``)."""
    from plcopen_sfc.formats.matiec.matiec_declarations import matiec_name  # noqa: PLC0415  # few files are for matiec

    found: dict[str, str] = {}
    for old, new in zip(project.pous, copy.pous, strict=False):
        ours = {variable.name.casefold() for variable in old.variables()}
        theirs = {variable.name.casefold() for variable in new.variables()}
        others = [variable.name for variable in new.variables() if variable.name.casefold() not in ours]
        for variable in old.variables() if others else ():
            if variable.name.casefold() not in theirs:
                near = re.compile(rf"{re.escape(matiec_name(variable.name))}(_\d+)?", re.IGNORECASE)
                fits = [name for name in others if near.fullmatch(name)]
                if len(fits) == 1:
                    found[f"{new.report_path} / {fits[0]}"] = f"{old.report_path} / {variable.name}"
    return found


_DEEPEST = 8
"""Structures in structures that are looked into."""


def _charts_of(pou: Pou) -> list[Chart]:
    return [Chart(name, pou, body.chart) for name, _, body in pou.named_bodies() if isinstance(body, SfcBody)]
