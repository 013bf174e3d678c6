"""Names that the tool of a target cannot have: steps named as variables, letters that are none of its identifiers."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.s7_types import is_system_data
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome


def give_step_names(copy: Project, dialect: Dialect | None, tool: str, report: ConversionReport) -> None:
    """Rename the steps of a copy that have the name of a variable of their POU, where the tool has one for each step.

    Those of CODESYS and S7 do. The project keeps the names of the source, and its steps get them in other tools again.
    It is called before texts are translated, which a new name needs, and behind that, which the old one does.
    """
    from plcopen_sfc.languages.translation.renames import STEPS_DATA, keep_table, kept_table  # noqa: PLC0415  # bring the parser
    from plcopen_sfc.refactor.rename import rename_step, restore_step_name  # noqa: PLC0415

    kept = kept_table(copy, STEPS_DATA) if not (_has_steps(dialect) or _has_steps(copy.dialect)) else []
    renames = [(path, new, old) for path, old, new in kept]
    if _has_steps(dialect) and not _has_steps(copy.dialect):
        renames = [*_clashing_steps(copy)]
    charts = {chart.report_path: chart.chart for chart in copy.charts()}
    done: list[tuple[str, str, str]] = []
    for path, old, new in renames:
        if path not in charts or all(step.name != old for step in charts[path].steps):
            continue  # an edit has another chart or step there
        try:
            step = charts[path].step(old)
            found = restore_step_name(copy, step, new) if kept else rename_step(charts[path], old, new)
        except ModelError as error:
            why = f"a variable of the POU is called {old} too: {tool} does not compile it"
            outcome = Outcome.TRANSLATED if kept else Outcome.NOT_EXECUTED
            report.add(outcome, "step", f"{path} / step {old}", f"it keeps its name: {error.message}" if kept else why)
            continue
        why = "as in the file that it was converted from" if kept else "a variable of the POU has its name"
        report.add(Outcome.TRANSLATED, "name", f"{path} / step {old}", f"{new} in {tool}: {why}")
        for place in found.undecided:
            why = f"it is unknown whether `{old}` means the step {old}, which is called {new} in {tool}"
            report.add(Outcome.NOT_EXECUTED, "code", place.use.path, why)
        done.append((path, old, new))
    if done or kept:
        keep_table(copy, STEPS_DATA, [] if kept else done)


def give_legal_names(copy: Project, dialect: Dialect | None, tool: str, report: ConversionReport) -> None:
    """Rename what a copy declares under names that are no identifiers in CODESYS, CoDeSys 2.3 and TwinCAT.

    These take letters without accents, digits and underscores (CODESYS V3 online help, "Identifiers"; doubled
    underscores, which it excludes, are in real exports). The project keeps the names of the source, and what it
    declares gets them in tools of other dialects again.
    """
    from plcopen_sfc.languages.binding import Names  # noqa: PLC0415  # brings the parser
    from plcopen_sfc.languages.translation.renames import (  # noqa: PLC0415
        DECLARED_DATA,
        identifier,
        keep_table,
        kept_table,
    )
    from plcopen_sfc.refactor.rename import rename_many  # noqa: PLC0415

    there = dialect is not None and family(dialect) is Dialect.CODESYS and family(copy.dialect) is Dialect.IEC
    kept = [] if _has_steps(dialect) or _has_steps(copy.dialect) else kept_table(copy, DECLARED_DATA)
    names = Names(copy)
    declared = dict.fromkeys(map(names.resolver.original, names.declarations())) if there or kept else {}
    table: dict[Declaration | str, str] = {}
    if there:
        taken = {each.name.casefold() for each in declared}
        for each in declared:
            if each.name.isascii() or each.kind in (Kind.INSTANCE, Kind.NAMESPACE):
                continue
            stem = new = identifier(each.name)
            number = 1
            while new.casefold() in taken - {each.name.casefold()}:  # "ß" is "ss" there
                number += 1
                new = f"{stem}_{number}"
            taken.add(new.casefold())
            table[each] = new
    else:
        old_names = {(path.casefold(), new.casefold()): old for path, old, new in kept}
        table = {
            each: old_names[each.path.casefold(), each.name.casefold()]
            for each in declared
            if (each.path.casefold(), each.name.casefold()) in old_names
        }
    outcome = Outcome.NOT_EXECUTED if there else Outcome.TRANSLATED
    why = f"{tool} takes letters without accents, digits and underscores"
    why = why if there else "as in the file that it was converted from"
    done: list[tuple[Declaration, str]] = []
    for part in ([table] if table else []) + [{each: new} for each, new in table.items()]:
        old = [(each, each.path, each.name) for each in declared if each in part]
        try:
            results = rename_many(copy, part)
        except ModelError as error:  # one that cannot be renamed keeps no other from it
            if len(part) == 1 and part is not table:
                [(_, path, name)] = old
                report.add(outcome, "name", path, f"{name} in {tool}: {error.message}")
            continue
        for (each, path, name), result in zip(old, results, strict=True):
            done.append((each, name))
            report.add(Outcome.TRANSLATED, "name", path, f"{each.name} in {tool}: {why}")
            for place in result.undecided:
                doubt = f"it is unknown whether `{name}` means what is called {each.name} in {tool}"
                report.add(Outcome.NOT_EXECUTED, "code", place.use.path, doubt)
        if part is table:
            break
    if done or kept:
        paths = {id(each.holder): each.path for each in Names(copy).declarations()}
        rows = [(paths[id(each.holder)], name, each.name) for each, name in done] if there else []
        keep_table(copy, DECLARED_DATA, rows)


def _has_steps(dialect: Dialect | None) -> bool:
    """True if tools of a dialect declare a variable for each step."""
    return dialect is not None and family(dialect) is not Dialect.IEC


def _clashing_steps(project: Project) -> Iterator[tuple[str, str, str]]:
    """Yield the steps that are called as variables: the paths of their charts, their names, and free ones."""
    for chart in project.charts():
        own = [variable for variable in chart.pou.variables() if not is_system_data(variable)]
        variables = {variable.name.casefold() for variable in own}
        taken = variables | {action.name.casefold() for action in chart.pou.actions}
        taken |= {step.name.casefold() for step in chart.chart.steps}
        taken |= {(transition.name or "").casefold() for transition in chart.chart.transitions}
        for step in chart.chart.steps:
            if step.name.casefold() in variables:
                new = stem = f"{step.name}_step"
                number = 1
                while new.casefold() in taken:
                    number += 1
                    new = f"{stem}_{number}"
                taken.add(new.casefold())
                yield chart.report_path, step.name, new
