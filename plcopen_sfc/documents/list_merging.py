"""A step list merged back into the project that it was written from: only what was edited in the list changes.

The list as it would be written of the project now is compared with the list that was edited. What is the same in both
stays as it is in the project, whatever a list can hold of it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from itertools import count
from typing import Any, NamedTuple, Self

from plcopen_sfc.diagnostics import DamagedSourceError, Severity
from plcopen_sfc.documents.file_documents import encode, read_document
from plcopen_sfc.documents.sources import FileSource
from plcopen_sfc.errors import ArgumentError, ModelError, check_argument
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.formats.steplist.list_codec import CODEC, ListCodec
from plcopen_sfc.formats.steplist.list_tables import NAMES, Sheet, TableKind, tables_in
from plcopen_sfc.formats.steplist.list_writer import is_listed, listed_transitions, tables_of
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.declarations import write_type
from plcopen_sfc.model.pou import Action, Pou
from plcopen_sfc.model.project import Project, Tag, TagTable
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step, Transition
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.refactor.dialect_translation import translate_project
from plcopen_sfc.refactor.name_edits import undeclared
from plcopen_sfc.report import ConversionReport

_STEP_FIELDS = {
    "number": "Number",
    "initial": "Initial",
    "comment": "Comment",
    "min_time": "Min time",
    "max_time": "Max time",
    "warning_time": "Warning time",
    "interlock": "Interlock",
    "supervision": "Supervision",
    "entry_action": "Action",
    "main_action": "Action",
    "exit_action": "Action",
}
_ACTION_FIELDS = {
    "qualifier": "Qualifier",
    "target": "Action",
    "value": "Action",
    "body": "Action",
    "duration": "Time",
    "event": "Event",
    "interlock": "Interlocked",
}
_TRANSITION_FIELDS = {
    "name": "Transition",
    "condition": "Condition",
    "priority": "Priority",
    "comment": "Transition comment",
}
_VARIABLE_FIELDS = {"type": "Type", "address": "Address", "initial": "Initial value", "comment": "Comment"}
_TAG_FIELDS = {"type": "Type", "address": "Address", "comment": "Comment"}
"""Fields that a list has, and their columns: a list without the column changes none of them."""


def merge_list(project: Project, edited: Project) -> list[str]:
    """Put what was edited in a step list into `project`, and return what changed, in words.

    `edited` was loaded from the list. Steps, programs and variables belong together by their names; a step that has
    another name and the number of one that is gone is renamed, wherever the project names it. What has no row in the
    list any more is removed; a program without any row stays, as do variables and actions of a list without their
    table. Raises `DamagedSourceError` where the list has errors, `ArgumentError` for what is no list, `ModelError`
    where something still names what was removed, or the project has no place for what is new; then nothing changes.
    """
    for each in (project, edited):
        check_argument(each, Project, "merge_list needs a project and a step list", "Load the files first.")
    source = edited.source
    codec = format_named(source.format)[0].codec() if isinstance(source, FileSource) else None
    if not isinstance(source, FileSource) or not isinstance(codec, ListCodec):
        raise ArgumentError("only a step list can be merged", hint="Load it from a file .xlsx or .csv.")
    errors = [found for found in edited.diagnostics if found.severity is Severity.ERROR]
    if errors:
        raise DamagedSourceError(errors)
    data = encode(project, "csv", flavour="", fresh=True)[0]
    columns = _columns(codec.sheets(source.content))
    # on a copy first: what is refused on the way must change nothing
    trial = project.model_copy(deep=True)
    _merging(trial, edited, data, columns).run()
    if _listed_names(read_document(data, format="csv", path=None)) - _listed_names(edited):
        _refuse_lost_names(project, trial)
    return _merging(project, edited, data, columns).run()


def _merging(project: Project, edited: Project, data: bytes, columns: Mapping[TableKind, Collection[str]]) -> _Merging:
    """Return the merging of an edited list; `data` is the list of the project as it is."""
    before = read_document(data, format="csv", path=None)
    names = _own_names(project, CODEC.sheets(data))
    after = edited.model_copy(deep=True)
    if after.dialect is not project.dialect:
        translate_project(after, project.dialect)
    after.rename_many(dict(_renamed_back(after, names)))
    return _Merging(project, before, edited, after, names, columns)


def _listed_names(project: Project) -> set[tuple[str, str]]:
    """Return the names of steps, actions and variables of a list, each with that of its program, in lower case."""
    found: set[tuple[str, str]] = set()
    for pou in project.pous:
        steps = pou.chart.steps if pou.chart is not None else []
        names = [*(s.name for s in steps), *(a.name for a in pou.actions), *(v.name for v in pou.variables())]
        found |= {(_name(pou), name.casefold()) for name in names}
    sections = project.global_sections()
    return found | {((s.name or "").casefold(), each.name.casefold()) for s in sections for each in s.variables}


def _refuse_lost_names(project: Project, merged: Project) -> None:
    """Raise `ModelError` where something in `merged` names what only `project` declares."""
    before, after = Names(project), Names(merged)
    kept = {each.path.casefold() for each in after.declarations()}
    removed = sorted({each.name for each in before.declarations() if each.path.casefold() not in kept})
    known = set(undeclared(before, removed))
    lost = [(name, use) for name in removed for use in undeclared(after, [name]) if use not in known]
    if lost:
        name, use = lost[0]
        message = f"{name} has no row any more, and {use} still names it"
        others = sorted({each for each, _ in lost} - {name})
        hint = "Put its row back, or change what names it."
        raise ModelError(message, hint=f"{hint} The same holds for: {', '.join(others)}." if others else hint)


_Names = dict[tuple[TableKind, str, str], str]
"""Names in a project by table, program and name in the list, where a name of S7 becomes one of IEC 61131-3."""


def _own_names(project: Project, sheets: Sequence[Sheet]) -> _Names:
    """Return the names in the project of programs, steps, actions and variables of a list."""
    names: _Names = {}
    shown = {table.kind: table for table in tables_in(sheets)}
    for table in tables_of(project, ConversionReport()):
        heading = NAMES[table.kind]
        own, program = "", ""
        for mine, row in zip(table.rows, shown[table.kind].rows if table.rows else (), strict=True):
            own, program = mine["Program"].rpartition(" ")[2], row["Program"].rpartition(" ")[2].casefold()
            names[table.kind, program, ""] = own
            if row[heading]:
                names[table.kind, program, row[heading].casefold()] = mine[heading]
    return names


def _renamed_back(after: Project, names: _Names) -> Iterator[tuple[str, str]]:
    for pou in after.pous:
        for step in pou.chart.steps if pou.chart is not None else ():
            own = names.get((TableKind.STEPS, _name(pou), _name(step)), step.name)
            if own != step.name:
                yield f"{pou.name}.{step.name}", own
        for variable in pou.variables():
            own = names.get((TableKind.VARIABLES, _name(pou), variable.name.casefold()), variable.name)
            if own != variable.name:
                yield f"{pou.name}.{variable.name}", own
    for section in after.global_variables:
        for variable in section.variables:
            place = (TableKind.VARIABLES, (section.name or "").casefold(), variable.name.casefold())
            if names.get(place, variable.name) != variable.name:
                yield variable.name, names[place]


def _columns(sheets: Sequence[Sheet]) -> dict[TableKind, set[str]]:
    columns: dict[TableKind, set[str]] = {}
    for table in tables_in(sheets):
        columns.setdefault(table.kind, set()).update(table.columns)
    return columns


class _Versions(NamedTuple):
    """A thing in the project, in the list of it, in the edited list, and there in the dialect of the project."""

    mine: Any
    shown: Any
    now: Any
    then: Any

    @property
    def charts(self) -> Self:
        """The same of the charts of POUs."""
        return type(self)(*(pou.chart or SfcNetwork() for pou in self))


class _Merging:
    """The versions of a project, and what becomes of it.

    `before` is the list of the project as it is, `edited` the list that was edited, `after` the same in the dialect of
    the project: their objects correspond one to one.
    """

    def __init__(  # noqa: PLR0917  # the versions are in their order in time
        self,
        project: Project,
        before: Project,
        edited: Project,
        after: Project,
        names: _Names,
        columns: Mapping[TableKind, Collection[str]],
    ) -> None:
        self._project = project
        self._before = before
        self._edited = edited
        self._after = after
        self._names = names
        self._columns = columns
        self._changes: list[str] = []

    def run(self) -> list[str]:
        """Change the project, and return the changes in words."""
        for now, then in zip(self._edited.pous, self._after.pous, strict=True):
            called = self._names.get((TableKind.STEPS, _name(now), ""), now.name).casefold()
            mine = next((pou for pou in self._project.pous if _name(pou) == called), None)
            shown = next((pou for pou in self._before.pous if _name(pou) == _name(now)), None)
            if mine is None or shown is None:
                if mine is not None:
                    hint = "A list is merged into programs and function blocks with a chart."
                    raise ModelError(f"{mine.report_path} has no chart in the project", hint=hint)
                if now.chart is None or not now.chart.steps:
                    hint = "Variables of a list of global ones have the section VAR_GLOBAL, all of them."
                    raise ModelError(f"neither the project nor the list has a program {now.name} with steps", hint=hint)
                self._project.pous.append(then)
                self._changes.append(f"{then.report_path}: new")
                continue
            pou = _Versions(mine, shown, now, then)
            if now.chart is not None and now.chart.steps:
                # renamed first: the rows are matched to steps by their names
                self._rename(pou.charts, mine.report_path)
                _Charts(pou.charts, self._columns[TableKind.STEPS], mine.report_path, self._changes).run()
            if TableKind.ACTIONS in self._columns:
                self._actions(pou)
            if TableKind.VARIABLES in self._columns:
                interface = mine.interface or Interface()
                others = (sections_of(each.interface) for each in (shown, now, then))
                versions = _Versions(interface.sections, *others)
                self._variables(versions, mine.report_path, _name(now))
                if interface.sections:
                    mine.interface = interface
        if TableKind.VARIABLES in self._columns:
            holders = [*self._project.global_sections(), *self._project.tag_tables]
            lists = (list(each.global_sections()) for each in (self._before, self._edited, self._after))
            self._variables(_Versions(holders, *lists), "")
        return self._changes

    def _rename(self, charts: _Versions, path: str) -> None:
        """Rename steps that have another name in the list and the number of one that is gone."""
        gone = {step.number: step.name for step in charts.shown.steps if not _named(charts.now.steps, step)}
        for step in charts.now.steps:
            old = gone.get(step.number) if step.number is not None else None
            if old is not None and not _named(charts.shown.steps, step):
                own = charts.mine.steps[[each.name for each in charts.shown.steps].index(old)]
                charts.mine.rename_step(own.name, step.name)
                charts.shown.rename_step(old, step.name)
                self._changes.append(f"{path} / step {old}: renamed to {step.name}")

    def _actions(self, pou: _Versions) -> None:
        path = pou.mine.report_path
        for now, then in zip(pou.now.actions, pou.then.actions, strict=True):
            mine, shown = pou.mine.find_action(self._action_name(pou, now)), pou.shown.find_action(now.name)
            where = f"{path} / action {now.name}"
            if mine is None:
                pou.mine.actions.append(then)
                self._changes.append(f"{where}: new")
            elif shown is not None:
                fields = {"body": "Statements", "comment": "Comment"}
                columns = self._columns[TableKind.ACTIONS]
                self._changes += _put(_Versions(mine, shown, now, then), fields, columns, where)
        for action in pou.shown.actions:
            if pou.now.find_action(action.name) is None:
                pou.mine.actions.remove(pou.mine.action(self._action_name(pou, action)))
                self._changes.append(f"{path} / action {action.name}: removed")

    def _action_name(self, pou: _Versions, action: Action) -> str:
        return self._names.get((TableKind.ACTIONS, _name(pou.shown), action.name.casefold()), action.name)

    def _variables(self, sections: _Versions, path: str, program: str = "") -> None:
        """Change, add and remove variables of a program, or global ones, whose `sections` may be tag tables."""
        columns = self._columns[TableKind.VARIABLES]
        own, old, new = (
            {
                ("" if program else (each.name or "").casefold(), thing.name.casefold()): (each, thing)
                for each in side
                for thing in _content(each)
            }
            for side in sections[:3]
        )
        written = [(section, each) for section in sections.then for each in section.variables]
        around: VariableSection | TagTable | None = None
        for (key, (place, now)), (section, then) in zip(new.items(), written, strict=True):
            where = f"{path} / variable {now.name}" if path else f"global variable {now.name}"
            found = own.get(self._own_key(program, key)) if key in old else None
            if found is None:
                self._add(section, then, around, sections.mine)
                self._changes.append(f"{where}: new")
                continue
            around, mine = found
            if "Section" in columns and _head(place) != _head(old[key][0]):
                around = self._moved(mine, around, section, sections.mine, where)
                self._changes.append(f"{where}: section")
            if isinstance(mine, Tag):
                self._changes += _put(
                    _Versions(mine, *map(_tag, (old[key][1], now, then))), _TAG_FIELDS, columns, where
                )
            else:
                self._changes += _put(_Versions(mine, old[key][1], now, then), _VARIABLE_FIELDS, columns, where)
        for key in (key for key in old if key not in new):
            found = own.get(self._own_key(program, key))
            if found is not None:
                _content(found[0]).remove(found[1])
                where = f"{path} / variable {old[key][1].name}" if path else f"global variable {old[key][1].name}"
                self._changes.append(f"{where}: removed")

    def _moved(
        self,
        variable: Variable | Tag,
        around: VariableSection | TagTable,
        section: VariableSection,
        mine: list[VariableSection | TagTable],
        where: str,
    ) -> VariableSection:
        """Move a variable to the section like `section` beside the one that it is in, and return that."""
        is_global = section.kind is SectionKind.GLOBAL
        if (
            isinstance(around, TagTable)
            or isinstance(variable, Tag)
            or is_global != (around.kind is SectionKind.GLOBAL)
        ):
            hint = "A global variable has a row of its own, with the name of its list as Program."
            raise ModelError(f"{where}: it cannot have this section", hint=hint)
        known = [each for each in mine if isinstance(each, VariableSection) and each.name == around.name]
        found = next((each for each in known if _fits(each, section)), None)
        if found is None:
            if is_global and around.name:
                raise ModelError(f"{where}: the list {around.name} has no such section")
            found = section.model_copy(update={"variables": [], "name": around.name})
            if is_global:
                self._project.global_variables.append(found)
            mine.append(found)
        around.variables = [each for each in around.variables if each is not variable]
        found.variables.append(variable)
        return found

    def _own_key(self, program: str, key: tuple[str, str]) -> tuple[str, str]:
        """Return the names of list and variable in the project for those in the step list."""
        own = self._names.get((TableKind.VARIABLES, program or key[0], key[1]), key[1])
        group = self._names.get((TableKind.VARIABLES, key[0], ""), key[0]) if key[0] else ""
        return group.casefold(), own.casefold()

    def _add(
        self,
        section: VariableSection,
        variable: Variable,
        around: VariableSection | TagTable | None,
        mine: list[VariableSection | TagTable],
    ) -> None:
        """Add a variable to the section or table of what is above it in the list, or to the first one of its kind."""
        fits = [each for each in (around, *mine) if each is not None and _fits(each, section)]
        if fits:
            _content(fits[0]).append(_tag(variable) if isinstance(fits[0], TagTable) else variable)
            return
        own = section.model_copy(update={"variables": [variable]})
        if section.kind is SectionKind.GLOBAL:
            self._project.global_variables.append(own)
        mine.append(own)


class _Charts:
    """The chart of one program in the four versions of `_Merging`."""

    def __init__(self, charts: _Versions, columns: Collection[str], path: str, changes: list[str]) -> None:
        self._mine, self._shown, self._now, self._then = charts
        self._path = path
        self._columns = columns
        self._changes = changes

    def run(self) -> None:
        """Change the chart of the project."""
        pairs = list(zip(listed_transitions(self._mine), self._shown.transitions, strict=True))
        self._own = {_name(shown): mine for mine, shown in zip(self._mine.steps, self._shown.steps, strict=True)}
        self._steps()
        self._transitions(pairs)

    # -- steps

    def _steps(self) -> None:
        above: Step | None = None
        for step, wanted in zip(self._now.steps, self._then.steps, strict=True):
            path = f"{self._path} / step {step.name}"
            mine, shown = self._own.get(_name(step)), _named(self._shown.steps, step)
            if mine is None or shown is None:
                above = self._own[_name(step)] = self._new_step(wanted, above)
                self._changes.append(f"{path}: new")
                continue
            above = mine
            versions = _Versions(mine, shown, step, wanted)
            self._changes += _put(versions, _STEP_FIELDS, self._columns, path)
            if "Action" in self._columns:
                self._step_actions(versions, path)
        for step in self._shown.steps:
            if _named(self._now.steps, step) is None:
                gone = self._own[_name(step)]
                self._mine.steps = [each for each in self._mine.steps if each is not gone]
                for sequence in self._mine.sequences:
                    sequence.steps = [each for each in sequence.steps if each != gone.id]
                self._changes.append(f"{self._path} / step {step.name}: removed")

    def _new_step(self, wanted: Step, above: Step | None) -> Step:
        chart = self._mine
        step = wanted.model_copy(update={"id": chart.new_id(), "actions": []}, deep=True)
        numbers = [each.number for each in chart.steps]
        if step.number is None and numbers and all(each is not None for each in numbers):
            step.number = max(each or 0 for each in numbers) + 1
        place = next((at for at, each in enumerate(chart.steps) if each is above), -1)
        chart.steps.insert(place + 1, step)
        for sequence in chart.sequences:
            if above is not None and above.id in sequence.steps:
                sequence.steps.insert(sequence.steps.index(above.id) + 1, step.id)
        for action in wanted.actions:
            step.actions.append(action.model_copy(update={"id": chart.new_id()}, deep=True))
        return step

    def _step_actions(self, step: _Versions, path: str) -> None:
        mine, shown, now, then = step
        own = [action for action in mine.actions if is_listed(action)]
        aligned = SequenceMatcher(None, [*map(_key, shown.actions)], [*map(_key, now.actions)], autojunk=False)
        for _, a, b, c, d in reversed(aligned.get_opcodes()):  # from behind, so that places stay
            both = min(b - a, d - c)
            for at in range(both):
                where = f"{path} / action {shown.actions[a + at].target or 'in place'}"
                action = _Versions(own[a + at], shown.actions[a + at], now.actions[c + at], then.actions[c + at])
                self._changes += _put(action, _ACTION_FIELDS, self._columns, where)
            for gone in own[a + both : b]:
                mine.actions = [each for each in mine.actions if each is not gone]
                self._changes.append(f"{path} / action {gone.target or 'in place'}: removed")
            place = 1 + next((at for at, each in enumerate(mine.actions) if b and each is own[b - 1]), -1)
            for new in then.actions[c + both : d]:
                mine.actions.insert(place, new.model_copy(update={"id": self._mine.new_id()}, deep=True))
                place += 1
                self._changes.append(f"{path} / action {new.target or 'in place'}: new")

    # -- transitions

    def _transitions(self, pairs: list[tuple[Transition, Transition]]) -> None:
        """Change, remove and add transitions. `pairs` are those of the project with those that a list shows of it."""
        olds, news = _Ends(self._shown), _Ends(self._now)
        waiting = list(pairs)
        found: dict[int, tuple[Transition, Transition]] = {}
        # the most alike first: an edit of a condition leaves both ends alike, one of where it leads the start
        for likeness in (_Ends.all, _Ends.ends, _Ends.start, _Ends.sources):
            for transition in self._now.transitions:
                if transition.id in found:
                    continue
                same = next((p for p in waiting if likeness(olds, p[1]) == likeness(news, transition)), None)
                if same is not None:
                    waiting.remove(same)
                    found[transition.id] = same
        for gone, shown in waiting:
            self._mine.transitions = [each for each in self._mine.transitions if each is not gone]
            self._changes.append(f"{self._path} / transition {self._shown.label(shown)}: removed")
        above: Transition | None = None
        placed: dict[int, Transition] = {}
        is_reordered = any(
            each.id not in found or each.priority != found[each.id][1].priority for each in self._now.transitions
        )
        for transition, wanted in zip(self._now.transitions, self._then.transitions, strict=True):
            path = f"{self._path} / transition {self._now.label(transition)}"
            if transition.id not in found:
                above = placed[transition.id] = self._new_transition(transition, wanted, above)
                self._changes.append(f"{path}: new")
                continue
            above, shown = found[transition.id]
            placed[transition.id] = above
            if is_reordered and above.priority is None is not shown.priority and "Priority" in self._columns:
                above.priority = shown.priority  # the list numbers all that compete with a numbered one
                if transition.priority == shown.priority:
                    self._changes.append(f"{path}: priority")
            versions = _Versions(above, shown, transition, wanted)
            self._changes += _put(versions, _TRANSITION_FIELDS, self._columns, path)
            if olds.ends(shown) != news.ends(transition):
                above.sources, above.targets = self._ids(news.ends(transition))
                self._changes.append(f"{path}: leads elsewhere")
        self._order(placed, {id(mine): shown for mine, shown in found.values()})

    def _order(self, placed: Mapping[int, Transition], shown: Mapping[int, Transition]) -> None:
        """Put competing transitions without priorities into the order of their rows, where it is another one."""
        for step in self._now.steps:
            wanted = [placed[each.id] for each in self._now.outgoing(step)]
            before = _named(self._shown.steps, step)
            known = self._shown.outgoing(before) if before is not None else []
            is_same = [id(shown.get(id(each))) for each in wanted] == [id(each) for each in known]
            if is_same or any(each.priority is not None for each in wanted):
                continue
            transitions = self._mine.transitions
            places = [at for at, each in enumerate(transitions) if any(each is one for one in wanted)]
            if any(transitions[at] is not each for at, each in zip(places, wanted, strict=True)):
                for at, each in zip(places, wanted, strict=True):
                    transitions[at] = each
                self._changes.append(f"{self._path} / step {step.name}: order of transitions")

    def _new_transition(self, now: Transition, then: Transition, above: Transition | None) -> Transition:
        chart = self._mine
        sources, targets = self._ids(_Ends(self._now).ends(now))
        new = then.model_copy(update={"id": chart.new_id(), "sources": sources, "targets": targets}, deep=True)
        numbers = [each.number for each in chart.transitions]
        if numbers and all(each is not None for each in numbers):
            new.number = max(each or 0 for each in numbers) + 1
        names = {each.name.casefold() for each in chart.transitions}
        if names and "" not in names and not new.name:
            new.name = next(name for n in count(len(names) + 1) if (name := f"Trans{n}").casefold() not in names)
        place = next((at for at, each in enumerate(chart.transitions) if each is above), -1)
        chart.transitions.insert(place + 1, new)
        return new

    def _ids(self, ends: Iterable[tuple[str, ...]]) -> list[list[int]]:
        return [[self._own[name].id for name in side] for side in ends]


class _Ends:
    """The steps before and after the transitions of a chart, by name."""

    def __init__(self, chart: SfcNetwork) -> None:
        self._names = {step.id: step.name.casefold() for step in chart.steps}

    def ends(self, transition: Transition) -> tuple[tuple[str, ...], tuple[str, ...]]:
        return self.sources(transition), tuple(self._names.get(each, "") for each in transition.targets)

    def sources(self, transition: Transition) -> tuple[str, ...]:
        return tuple(self._names.get(each, "") for each in transition.sources)

    def start(self, transition: Transition) -> object:
        return self.sources(transition), transition.name, repr(transition.condition)

    def all(self, transition: Transition) -> object:
        return self.ends(transition), transition.name, repr(transition.condition)


def _put(versions: _Versions, fields: Mapping[str, str], columns: Collection[str], path: str) -> Iterator[str]:
    """Set the fields that the edited list has otherwise, as they are in the dialect of the project; yield what."""
    mine, shown, now, then = versions
    for field, heading in fields.items():
        if heading in columns and getattr(shown, field) != getattr(now, field) and _is_stated(field, now):
            setattr(mine, field, getattr(then, field))
            yield f"{path}: {field.replace('_', ' ')}"


def _is_stated(field: str, now: Any) -> bool:
    """False for an empty number or name: the project keeps its own, as tools number what is new."""
    return field not in ("number", "name") or bool(getattr(now, field))


def _key(action: ActionAssociation) -> str:
    return repr([getattr(action, field) for field in _ACTION_FIELDS])


def _name(thing: Pou | Step) -> str:
    return thing.name.casefold()


def _named(steps: Iterable[Step], step: Step) -> Step | None:
    return next((each for each in steps if _name(each) == _name(step)), None)


def _content(holder: VariableSection | TagTable) -> list[Any]:
    return holder.tags if isinstance(holder, TagTable) else holder.variables


def _tag(variable: Variable) -> Tag:
    return Tag(name=variable.name, type=write_type(variable.type), address=variable.address, comment=variable.comment)


def _fits(holder: VariableSection | TagTable, section: VariableSection) -> bool:
    if isinstance(holder, TagTable):
        return section.kind is SectionKind.GLOBAL
    return _head(holder) == _head(section)


def _head(section: VariableSection) -> tuple[object, ...]:
    return section.kind, section.constant, section.retain, section.persistent
