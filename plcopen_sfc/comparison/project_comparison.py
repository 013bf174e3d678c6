"""Changes between two projects: `diff`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.comparison.changes import Change, ChangeKind, ProjectDiff
from plcopen_sfc.comparison.renamings import (
    Renaming,
    renamed_members,
    renamed_outer,
    renamed_steps,
    renamed_transitions,
)
from plcopen_sfc.comparison.tree_comparison import TreeComparison, word_of
from plcopen_sfc.conversion import Detail, Part, executed
from plcopen_sfc.errors import ModelError, check_argument
from plcopen_sfc.languages.binding import Declaration, Names
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.drawing import Places
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.refactor.dialect import translate_project
from plcopen_sfc.refactor.rename import rename_many
from plcopen_sfc.semantics.profile import default_profile

__all__ = ["diff"]


@collecting_rarely()
def diff(
    a: Project, b: Project, *, layout: bool = False, prove: bool = False, limit: float | str | None = None
) -> ProjectDiff:
    """Return what changed from the project `a` to the project `b`, in the charts and around them.

    Both are compared by their meaning, so they may come from files of different formats. What has another name is
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
    from plcopen_sfc.comparison.behaviour import proofs  # noqa: PLC0415  # brings the search

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
            translate_project(self.left, b.dialect)
        self.detail = Detail.WRITTEN if self.is_written else Detail.MEANT
        left = self._listing()
        self.listed = left, executed(b, compared_with=None if self.is_written else left, detail=self.detail)

    def _listing(self) -> Part:
        # a translated project has its tasks in the terms of another tool
        source = self.left if self.left.dialect is self.a.dialect else self.a
        return executed(self.left, default_profile(self.a), source=source, detail=self.detail)

    def changes(self, *, layout: bool) -> list[Change]:
        """The changes, those of a POU together."""
        for find in (renamed_outer, renamed_steps, renamed_transitions, self._renamed_members):
            self._rename(find)
        found = TreeComparison(is_written=self.is_written, layout=layout).changes(*self.listed)
        found = [*self.renamed, *found, *(self._positions() if layout else ())]
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
        there = {chart.report_path.casefold(): chart for chart in self.b.charts()}
        for chart in self.left.charts():
            other = there.get(chart.report_path.casefold())
            before, after = _places(chart.chart), _places(other.chart) if other is not None else {}
            for step in chart.chart.steps:
                old, new = before.get(step.name.casefold()), after.get(step.name.casefold())
                if old and new and old != new:
                    path = ObjectPath.of(chart.report_path) / f"step {step.name}"
                    yield Change(ChangeKind.LAYOUT, path, "step", "position", old, new)


def _grouped(changes: Iterable[Change], owners: Iterable[str]) -> list[Change]:
    """The changes of each thing together: of a POU, a chart in it, a step in that."""
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
