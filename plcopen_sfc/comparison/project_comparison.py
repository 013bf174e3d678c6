"""Changes between two projects: `diff`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.analysis.verdict import Verdict
from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.comparison.changes import Change, ChangeKind, ProjectDiff, Proof
from plcopen_sfc.comparison.renamings import (
    Renaming,
    renamed_members,
    renamed_outer,
    renamed_steps,
    renamed_transitions,
)
from plcopen_sfc.comparison.tree_comparison import TreeComparison, word_of
from plcopen_sfc.conversion import Detail, Part, executed
from plcopen_sfc.errors import ModelError, SfcError, check_argument
from plcopen_sfc.languages.binding import Declaration, Names
from plcopen_sfc.languages.executed_names import reordered, shows_names_of_steps
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.drawing import Places
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.types import used_types
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.refactor.dialect_translation import rename_pins, translate_project
from plcopen_sfc.refactor.rename import rename_many
from plcopen_sfc.semantics.profile import default_profile
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from plcopen_sfc.semantics.subjects import resolve


@collecting_rarely()
def diff(
    a: Project, b: Project, *, layout: bool = False, prove: bool = False, limit: float | str | None = None
) -> ProjectDiff:
    """Return the changes from the project `a` to the project `b`, in the charts and around them.

    Both are compared by their meaning, so they may come from files of different formats. An object with another name is
    recognised by what it does and where it is. With `layout` also what is not executed is listed: positions, and
    program text that means the same. With `prove` the changed charts are run against each other as `equivalent` does,
    each for at most `limit` (seconds, or a time). Raises `InputError` for a limit that is not valid.
    """
    check_argument(a, Project, "diff needs two projects", "Load the files first.")
    check_argument(b, Project, "diff needs two projects", "Load the files first.")
    if prove:
        from plcopen_sfc.analysis.search_limits import seconds  # noqa: PLC0415  # brings the simulation

        seconds(limit)  # a wrong one is a mistake of the call, not of a chart
    comparison = _Comparison(a, b)
    changes = comparison.changes(layout=layout)
    if not prove:
        return ProjectDiff(tuple(changes))

    return ProjectDiff(tuple(changes), tuple(proofs((comparison.left, b), changes, limit)))


class _Comparison:
    """Two projects: the first gets the names of the second, so that what still differs are changes."""

    def __init__(self, a: Project, b: Project) -> None:
        self.a, self.b = a, b
        self.is_written = family(a.dialect) is family(b.dialect)
        self.left = a
        self.renamed: list[Change] = []
        if Dialect.SCL in (a.dialect, b.dialect) and not self.is_written:
            self.left = a.model_copy(deep=True)
            translate_project(self.left, b.dialect, addresses=b.address_dialect)
        elif not self.is_written:
            self.left = a.model_copy(deep=True)
            rename_pins(self.left, b.dialect)
        self.detail = Detail.WRITTEN if self.is_written else Detail.MEANT
        left = self._listing()
        self.listed = left, executed(b, compared_with=None if self.is_written else left, detail=self.detail)

    def _listing(self) -> Part:
        # a translated project has its tasks in the terms of another tool
        source = self.left if self.left.dialect is self.a.dialect else self.a
        addresses = self.b.address_dialect if source is self.a and self.left is not self.a else None
        return executed(self.left, default_profile(self.a), source=source, detail=self.detail, addresses=addresses)

    def changes(self, *, layout: bool) -> list[Change]:
        """Return the changes, those of a POU together."""
        for find in (renamed_outer, renamed_steps, renamed_transitions, self._renamed_members):
            self._rename(find)
        found = TreeComparison(is_written=self.is_written, layout=layout).changes(*self.listed)
        found = [*self.renamed, *found]
        if layout:
            found += [*self._positions(), *self._priorities()]
        owners = dict.fromkeys(ObjectPath.of(part.path).owner for side in self.listed for part in side.parts.values())
        return _grouped(found, owners)

    def _renamed_members(self, left: Part, right: Part) -> Iterator[Renaming]:
        return renamed_members((self.left, self.b), left, right)

    def _rename(self, find: Callable[[Part, Part], Iterable[Renaming]]) -> None:
        """Give what has another name in the second project this name in the first."""
        pairs = list(find(*self.listed))
        if not pairs:
            return
        listed = list(Names(self.left).declarations())
        if self.left is self.a:
            self.left = self.a.model_copy(deep=True)
        names = Names(self.left)
        own: dict[int, Declaration] = {}
        for listed_one, declaration in zip(listed, names.declarations(), strict=True):
            own |= {id(holder): names.resolver.original(declaration) for holder in listed_one.holders}
        table: dict[Declaration, Renaming] = {}
        for pair in pairs:
            if id(pair.old.subject) in own:  # the first is the thing itself, others are what repeats it: VAR_EXTERNAL
                table.setdefault(own[id(pair.old.subject)], pair)
        for declaration, old_name in self._with_new_names(table):
            kind, _, new = table[declaration]
            change = Change(ChangeKind.RENAMED, new.path, word_of(kind), before=old_name, after=declaration.name)
            self.renamed.append(change)
        self.listed = self._listing(), self.listed[1]

    def _with_new_names(self, table: dict[Declaration, Renaming]) -> list[tuple[Declaration, str]]:
        """Rename the declarations and return those that could be, with their old names: all at once, or one by one."""
        wanted: dict[Declaration | str, str] = {
            declaration: pair.new.subject.name for declaration, pair in table.items() if pair.new.subject is not None
        }
        old = {declaration: declaration.name for declaration in table}
        for part in (wanted, *({declaration: new} for declaration, new in wanted.items())):
            try:
                rename_many(self.left, part)
            except ModelError:
                continue  # another thing has the name, or a place cannot be decided: one removed, one added
            if part is wanted:
                break
        return [(declaration, name) for declaration, name in old.items() if declaration.name != name]

    def _positions(self) -> Iterator[Change]:
        """Symbols of charts that are drawn elsewhere."""
        for chart, other in self._charts():
            before, after = _places(chart.chart), _places(other.chart)
            for step in chart.chart.steps:
                old, new = before.get(step.name.casefold()), after.get(step.name.casefold())
                if old and new and old != new:
                    path = ObjectPath.of(chart.report_path) / f"step {step.name}"
                    yield Change(ChangeKind.LAYOUT, path, "step", "position", old, new)

    def _priorities(self) -> Iterator[Change]:
        """Priorities that are other numbers. What is executed is the order that they make, which is compared itself."""
        for chart, other in self._charts():
            labels = {label: number for number, label in other.chart.labels().items()}
            after = {transition.id: transition.priority for transition in other.chart.transitions}
            own = chart.chart.labels()
            for transition in chart.chart.transitions:
                path = ObjectPath.of(chart.report_path) / f"transition {own[transition.id]}"
                old, new = transition.priority, after.get(labels.get(own[transition.id], -1))
                if old is not None and new is not None and old != new:
                    yield Change(ChangeKind.LAYOUT, path, "transition", "priority", str(old), str(new))

    def _charts(self) -> Iterator[tuple[Chart, Chart]]:
        """Charts of the first project, each with that of the second."""
        there = {chart.report_path.casefold(): chart for chart in self.b.charts()}
        for chart in self.left.charts():
            other = there.get(chart.report_path.casefold())
            if other is not None:
                yield chart, other


def _grouped(changes: Iterable[Change], owners: Iterable[str]) -> list[Change]:
    """Return the changes of each thing together: of a POU, a chart in it, a step in that."""
    places: dict[tuple[str, ...], int] = {(owner,): place for place, owner in enumerate(owners)}

    def place(change: Change) -> list[int]:
        parts = ObjectPath.of(change.path).parts
        return [places.setdefault(parts[:end], len(places)) for end in range(1, len(parts) + 1)]

    return sorted(changes, key=place)


def _places(chart: SfcNetwork) -> dict[str, str]:
    """Return where the file draws the steps, by their names."""
    if chart.drawing is None or chart.drawing.places is not Places.GIVEN:
        return {}
    places = {symbol.id: symbol.position for symbol in chart.drawing.symbols}
    return {step.name.casefold(): "{:g}, {:g}".format(*places[step.id]) for step in chart.steps if step.id in places}


_NEVER_EXECUTED = ("comment", "title", "number", "warning time", "alarm of the ")
"""What aspects begin with that nothing executes."""
_TERMINALS = "no run shows at which terminal or in which memory a variable is"
_TASKS = "tasks are not run"
_NOT_RUN: Mapping[str, str] = {
    "address": _TERMINALS,
    "VAR_CONFIG": _TERMINALS,
    "retain": "no run ends and starts again",
    "persistent": "no run ends and starts again",
    "task": _TASKS,
    "program instance": _TASKS,
}
"""Why runs do not show a change, by what has changed."""


class _Runnable(NamedTuple):
    """Something that can be run: its name in the project, its path in reports, and that of its POU."""

    name: str
    path: str
    owner: str
    is_block: bool = False


def proofs(projects: tuple[Project, Project], changes: Iterable[Change], limit: float | str | None) -> Iterator[Proof]:
    """Run what may do something else in the second project, each for at most `limit` (seconds, or a time).

    These are the programs, function blocks and charts that have changed, and all of them where something has changed
    that is in none: they may use it. So may what has instances of a block that is equal in itself. Where no run can
    show it, the proof has no verdict.
    """
    changes = list(changes)
    renamed = _executed_renames(projects, changes)
    if renamed:
        projects = _with_old_names(projects[0], renamed), projects[1]
    executed = [change for change in changes if change in renamed or _is_executed(change)]
    shown = []
    for change in executed:
        reason = _NOT_RUN.get(change.aspect) or _NOT_RUN.get(change.what) or _not_called(projects, change)
        if reason:
            yield Proof(change.place, reason=reason)
        else:
            shown.append(change)
    changed = {ObjectPath.of(change.path).owner.casefold() for change in shown}
    here, there = map(_runnable, projects)
    outside = changed - {each.owner.casefold() for each in here.values()}
    starts = any(change.aspect == "start value" for change in shown)
    found: dict[str, Proof] = {}
    for key, each in here.items():
        if key in there and (outside or each.owner.casefold() in changed):
            found[key] = _run(projects, (each, there[key]), limit, starts=starts)
    # runs of a block begin with any inputs: what uses it sees their start values, and in which order they come
    for key in [key for key, proof in found.items() if proof.equal and here[key].is_block]:
        users = _users(projects, here[key]) & there.keys() & here.keys()
        for user in [each for each in here if each in users and each not in found]:
            found[user] = _run(projects, (here[user], there[user]), limit, starts=starts)
        own = [
            change for change in shown if ObjectPath.of(change.path).owner == here[key].path and change.aspect != "code"
        ]
        if not users and own:
            found[key] = replace(found[key], reason=_NO_USERS)
    yield from found.values()


_NO_USERS = "nothing uses the block: what users see of its start values and the order of its inputs was not run"


def _users(projects: tuple[Project, Project], block: _Runnable) -> set[str]:
    """Return the paths, in lower case, of what declares instances of a block, also by global variables."""
    name, found = block.name.casefold(), set[str]()
    for project in projects:
        declared = [(variable, [pou]) for pou in project.pous for variable in pou.variables()]
        everywhere = [pou for pou in project.pous if _is_run(pou)]
        declared += [(variable, everywhere) for section in project.global_sections() for variable in section.variables]
        for variable, pous in declared:
            if any(name == kind.casefold() for kind in used_types(variable.type)):
                found |= {pou.report_path.casefold() for pou in pous}
    return found - {block.path.casefold()}


def _is_executed(change: Change) -> bool:
    is_behaviour = change.kind not in (ChangeKind.LAYOUT, ChangeKind.RENAMED)
    return is_behaviour and not change.aspect.startswith(_NEVER_EXECUTED)


def _executed_renames(projects: tuple[Project, Project], changes: Sequence[Change]) -> list[Change]:
    """Return the other names of steps and actions that a tool executes. `projects` have the new ones both."""
    renamed = [change for change in changes if change.kind is ChangeKind.RENAMED and change.before and change.after]
    found = [change for change in renamed if change.what == "step"]
    if found and not any(shows_names_of_steps(Names(project)) for project in projects):
        found = []
    for pou in projects[0].pous:
        own = [change for change in renamed if change.what == "action" and _is_in(change, pou)]
        passing = reordered(pou, {c.after or "": c.before or "" for c in own}, projects[0].dialect) if own else {}
        found += [change for change in own if change.after in passing]
    return found


def _is_in(change: Change, pou: Pou) -> bool:
    return ObjectPath.of(change.path).owner.casefold() == pou.report_path.casefold()


def _with_old_names(project: Project, renamed: Iterable[Change]) -> Project:
    """Return a project with the names that it had before it was compared, where a tool executes them."""
    found = project.model_copy(deep=True)
    steps = {f"{chart.report_path} / step {s.name}": s for chart in found.charts() for s in chart.chart.steps}
    names = Names(found)
    table: dict[Declaration | str, str] = {}
    for change in renamed:
        thing = steps.get(change.path)
        pous = (pou for pou in found.pous if _is_in(change, pou))
        held = thing if thing is not None else next(pou.find_action(change.after or "") for pou in pous)
        if held is not None:
            table[names.declaration_of(held)] = change.before or ""
    rename_many(found, table)
    return found


def _runnable(project: Project) -> dict[str, _Runnable]:
    """Return programs, function blocks and the charts of their actions, by their paths in lower case."""
    charts = [_Runnable(chart.name, chart.report_path, chart.pou.report_path) for chart in project.charts()]
    pous = [
        _Runnable(pou.name, pou.report_path, pou.report_path, pou.kind is PouKind.FUNCTION_BLOCK)
        for pou in project.pous
        if _is_run(pou)
    ]
    return {each.path.casefold(): each for each in (*pous, *charts)}


def _is_run(pou: Pou) -> bool:
    return pou.kind is not PouKind.FUNCTION and bool(pou.bodies)


def _not_called(projects: tuple[Project, Project], change: Change) -> str:
    """Return why nothing runs what has changed, such as that nothing calls it; empty if something does."""
    path = ObjectPath.of(change.path)
    if change.what in ("property", "unit"):
        return "it is kept as text, and no run executes it"
    for project in projects:
        pou = next((each for each in project.pous if each.report_path.casefold() == path.owner.casefold()), None)
        if pou is None:
            continue
        if change.path == pou.report_path and change.kind in (ChangeKind.ADDED, ChangeKind.REMOVED) and _is_run(pou):
            return "it is only in one of the two" if pou.kind is PouKind.PROGRAM else ""
        names = [pou.name] if pou.kind is PouKind.FUNCTION else _methods_at(pou, change.path)
        if names and all(each.text_site.site.pou is pou for each in Names(project).occurrences(*names)):
            return "it is run only where it is called, and nothing calls it"
        return ""
    return ""


def _methods_at(pou: Pou, path: str) -> list[str]:
    start = f"{pou.report_path} / method "
    return [each.name for each in pou.methods if f"{path} / ".startswith(f"{start}{each.name} / ")]


def _run(
    projects: tuple[Project, Project], both: tuple[_Runnable, _Runnable], limit: float | str | None, *, starts: bool
) -> Proof:
    """Run something in both projects, with any values of what nothing writes: it may be an input of the machine.

    `starts`: start values have changed, so that it also runs while nothing outside writes these.
    """
    left, right = map(default_profile, projects)

    def verdict(*free: str) -> Verdict:
        return equivalent(
            resolve(projects[0], both[0].name),
            resolve(projects[1], both[1].name),
            (left, right),
            delay=0 if left == right else "auto",
            free_inputs=free,
            limit=limit,
        )

    try:
        found = verdict(ALL_FREE)
        frozen = verdict() if found.different or (starts and found.equal) else found
    except SfcError as error:
        return Proof(both[0].path, reason=error.message)
    if found.different and frozen.equal and frozen.frozen:
        names = ", ".join(frozen.frozen)
        why = f"only if something outside writes {names}; while they keep their start values, both do the same"
    elif found.equal and frozen.different:
        found, why = frozen, "while variables that nothing in the project writes keep their start values"
    else:
        why = ""
    return Proof(both[0].path, found, why)
