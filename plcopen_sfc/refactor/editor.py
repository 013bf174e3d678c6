"""Edits as transactions: each is made whole or not at all, can be undone, and can be asked for a proof."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from types import TracebackType
from typing import Any, Self, TypeVar, cast

from plcopen_sfc.errors import ModelError, check_argument
from plcopen_sfc.languages.binding import Declaration, Names
from plcopen_sfc.languages.binding.name_uses import unique_declaration
from plcopen_sfc.languages.binding.text_sites import Site, text_sites_in
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.pou import Action, NamedTransition, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Condition, SfcNetwork, Step, Transition
from plcopen_sfc.operations import provided
from plcopen_sfc.refactor import called_charts, chart_edits, name_edits, runs_of_steps, step_kinds
from plcopen_sfc.refactor.argument_checks import bound_arguments
from plcopen_sfc.refactor.chart_edits import refused
from plcopen_sfc.refactor.journal import EDITS, Journal
from plcopen_sfc.refactor.queries import charts_of, pou_of
from plcopen_sfc.refactor.rename import rename, rename_many
from plcopen_sfc.report import RenameResult

_Method = TypeVar("_Method", bound=Callable[..., Any])


def _edit(method: _Method) -> _Method:
    """Make a method a transaction, or a part of the one that is open; it refuses arguments of other types."""

    @wraps(method)
    def transaction(self: Editor, *args: Any, **kwargs: Any) -> Any:
        with self:
            bound = bound_arguments(method, self, *args, **kwargs)
            return method(*bound.args, **bound.kwargs)

    return cast(_Method, transaction)


class Editor:
    """Edits of a project that keep every reference right; `Project.edit` makes one.

    Each method is a transaction: where it raises `ModelError`, the project is as it was before. In a ``with`` block all
    edits together are one. `undo` takes the last transaction back; what is saved then is the file that was read. What a
    script assigns itself (``step.max_time = ..``) stays: `set` does the same in the transaction.

    `clean`: after a transaction, actions, named transitions and local variables are removed that it left without a use;
    `removed` lists their paths. `prove`: the charts that a transaction changed are run against those before it as
    `plcopen_sfc.equivalent` does, each for at most `limit` (seconds, or a time), and where one does something else, or
    nothing tells, the transaction is refused; `proofs` has the verdicts.

    Steps are given as objects or by their paths (``Main.Fill``), transitions and actions as objects.
    """

    def __init__(
        self, project: Project, *, clean: bool = False, prove: bool = False, limit: float | str | None = None
    ) -> None:
        check_argument(project, Project, "an editor needs a project")
        check_argument(clean, bool, "clean is True or False")
        check_argument(prove, bool, "prove is True or False")
        check_argument(limit, (int, float, str, type(None)), "limit is a number of seconds, or a time")
        self.project = project
        self.removed: list[str] = []
        self.proofs: tuple[Any, ...] = ()
        self._clean, self._prove, self._limit = clean, prove, limit
        self._journal = Journal()
        self._open: list[int] = []
        self._done: list[tuple[int, int, int]] = []
        self._after = 0
        self._before: tuple[Project | None, set[str]] = (None, set())
        self._drawn: set[int] = set()

    # -- transactions

    def __enter__(self) -> Self:
        """Begin a transaction, or a part of the one that is open."""
        if not self._open:
            copy = self.project.model_copy(deep=True) if self._prove else None
            unused = {each.path for each in self._unused()} if self._clean else set()
            self._before = copy, unused
            self._drawn.clear()
            self._after = self.project.last_edit
        self._open.append(len(self._journal))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End it: take all back where there was an error, else clean up and prove where that was asked for."""
        start = self._open.pop()
        if error is not None:
            self._journal.take_back(start)
        elif not self._open:
            try:
                self._finish()
            except BaseException:
                self._journal.take_back(start)
                raise
            known, self.project.last_edit = self.project.last_edit, next(EDITS)
            # one that another edit was a part of cannot be undone alone
            self._done.append((start, self._after, self.project.last_edit if known == self._after else 0))

    def _finish(self) -> None:
        before, unused = self._before
        if self._clean:
            self._remove(lambda: [each for each in self._unused() if each.path not in unused])
        if before is not None:
            self.proofs = provided("diff")(before, self.project, prove=True, limit=self._limit).proofs
            failed = [str(each) for each in self.proofs if not each.equal]
            if failed:
                raise refused("the edit would change what the charts do, or nothing tells that it does not", failed)

    def undo(self) -> None:
        """Take the last transaction back. Raises `ModelError` where there is none, or another edit came after it."""
        if not self._done:
            raise ModelError("there is nothing to undo")
        start, before, number = self._done[-1]
        if number != self.project.last_edit:
            raise refused("the edit cannot be undone", "the project was edited in another way since it began")
        self._done.pop()
        self._journal.take_back(start)
        self.project.last_edit = before

    # -- names

    @_edit
    def rename(self, what: Declaration | Model | str, new: str) -> RenameResult:
        """Give a thing another name, as `Project.rename` does."""
        return rename(self.project, what, new, self._journal)

    @_edit
    def rename_many(self, table: Mapping[Declaration | str, str]) -> list[RenameResult]:
        """Give several things other names in one pass, as `Project.rename_many` does."""
        return rename_many(self.project, table, self._journal)

    @_edit
    def replace_variable(self, old: str, new: str) -> list[str]:
        """Replace a variable by another wherever it is used: ``edit.replace_variable("Main.bStart", "GVL.Start")``.

        Gives the paths of the changed texts. Refused where the types differ, or where a place does not see the other.
        """
        return name_edits.replace_variable(self._journal, self.project, old, new)

    @_edit
    def remove_unused(self) -> list[str]:
        """Remove all actions, named transitions and local variables that nothing uses; give their paths.

        Actions of a project without a task stay: it may be a part of another project, which calls them.
        """
        return self._remove(lambda: Names(self.project).unused())

    def _unused(self) -> list[Declaration]:
        return Names(self.project).unused(callable_elsewhere=True)

    def _remove(self, unused: Callable[[], list[Declaration]]) -> list[str]:
        gone: list[str] = []
        while found := unused():
            name_edits.remove_declared(self._journal, self.project, found)
            gone += [each.path for each in found]  # what only these named is without a use now
        self.removed += gone
        return gone

    # -- steps

    @_edit
    def set(self, things: Iterable[Model | str] | Model | str, **fields: Any) -> None:
        """Give fields of steps, actions, transitions .. other values: ``edit.set(steps, max_time="T#30s")``.

        Refused for fields that other edits keep right: names, ids, and where transitions lead.
        """
        for name in fields:
            if name in _STRUCTURE:
                raise refused(f"{name!r} cannot be set", "references would not follow", f"Use {_STRUCTURE[name]}.")
        names = Names(self.project)
        for thing in [things] if isinstance(things, Model | str) else things:
            each = self._step(thing, names)[0] if isinstance(thing, str) else thing
            if isinstance(each, ActionAssociation):
                name_edits.change_association(self._journal, each, fields)
                charts = (c for c in charts_of(self.project) if any(own is each for _, own in c.associations()))
                for chart in charts if "condition" in fields else ():
                    runs_of_steps.check_condition(chart, f"the condition of {each.text!r}", each.condition)
                continue
            if isinstance(each, Step):
                self._step(each)
                chart_edits.check_number(each, fields.get("number"))
            elif isinstance(each, Transition):
                self._chart_of(each)
            for name, value in fields.items():
                if name not in type(each).model_fields:
                    setattr(each, name, value)  # raises the error for it
                self._journal.put(each, name, value)
            if isinstance(each, Transition) and "condition" in fields:
                runs_of_steps.check_conditions(self._chart_of(each), [each])
            elif isinstance(each, Step):
                chart = self._step(each)[1]
                for name in sorted(_SUPERVISED & fields.keys()):
                    held = getattr(each, name)
                    condition = held.condition if held is not None else None
                    runs_of_steps.check_condition(chart, f"the {name} of {each.name}", condition)

    @_edit
    def insert_step(
        self, name: str, link: Transition, condition: Condition | str = "TRUE", *, before: bool = False, **fields: Any
    ) -> Step:
        """Put a step into a link: behind a transition, or `before` it; a transition with `condition` is added.

        `fields` are arguments of `SfcNetwork.add_step`: ``actions=["N Valve"]``.
        """
        chart = self._chart_of(link)
        with self._adding(chart):
            return chart_edits.insert_step(self._journal, chart, name, link, condition, before=before, fields=fields)

    @_edit
    def delete_step(self, step: Step | str, keep: str | None = None) -> None:
        """Take a step out. `keep` bridges it: the conditions that remain are ``incoming``, ``outgoing`` or ``both``.

        Refused where program text names it, where it is initial, and without `keep` where it is between others.
        """
        found, chart = self._step(step)
        with self._removing([found]):
            chart_edits.delete_step(self._journal, chart, found, keep)

    @_edit
    def renumber(
        self, start: int = 1, increment: int = 1, *, charts: Iterable[SfcNetwork] | None = None, names: str = ""
    ) -> None:
        """Number the steps along the flow, for tools that have numbers (S7-GRAPH, GRAFCET), and transitions with them.

        `names` renames the steps too: ``"S{number}"``, also ``"{number:03}_{name}"``. In a GRAFCET the numbers are
        names, over all its partial charts; M3, E3 and S3 of a macro-step stay without `names`. Refused where no step of
        a chart has a number and `names` is not given.
        """
        table: dict[Declaration | str, str] = {}
        declared = Names(self.project)
        by_holder = {id(each.holder): each for each in declared.declarations()}
        counts: Counter[int] = Counter()
        is_changed = False
        for chart in charts_of(self.project) if charts is None else charts:
            numbered = any(step.number is not None for step in chart.steps)
            pou = pou_of(chart)
            steps = chart_edits.along_the_flow(chart)
            form, before = names, 0
            if declared.is_in_grafcet(Site(pou, charts=(chart,))):
                form = names or "{number}"
                steps = steps if names else [step for step in steps if step.name.isdecimal()]
                before = counts[id(pou)]
                counts[id(pou)] += len(steps)
            if not numbered and not form:
                if charts is not None:
                    raise refused(
                        "the chart cannot be renumbered", "its steps have no numbers", 'Use names="S{number}".'
                    )
                continue
            is_changed = True
            for place, step in enumerate(steps, before):
                if form:
                    table[by_holder[id(step)]] = _name(form, start + place * increment, step.name)
            if numbered:
                chart_edits.renumber(self._journal, chart, start, increment)
        if not is_changed:
            raise refused("the steps cannot be renumbered", "no step has a number", 'Use names="S{number}".')
        if table:
            rename_many(self.project, table, self._journal)

    # -- transitions and branches

    @_edit
    def split_transition(self, link: Transition) -> list[Transition]:
        """Make competing transitions of one whose condition joins expressions by OR."""
        return chart_edits.split_transition(self._journal, self._chart_of(link), link)

    @_edit
    def join_transitions(self, links: Sequence[Transition]) -> Transition:
        """Make one transition of several between the same steps; their conditions are joined by OR."""
        if not links:
            raise ModelError("there are no transitions to join")
        return chart_edits.join_transitions(self._journal, self._chart_of(links[0]), links)

    @_edit
    def retarget(self, old: Step | str, new: Step | str, links: Iterable[Transition] | None = None) -> None:
        """Redirect transitions that lead to the step `old` to `new`: all of them, or `links`."""
        old, chart = self._step(old)
        new, other = self._step(new)
        if other is not chart:
            raise refused("the transitions cannot be retargeted", f"{old.name!r} and {new.name!r} are in two charts")
        chart_edits.retarget(self._journal, chart, old, new, links)

    @_edit
    def add_branch(self, start: Transition | Step | str, *parts: Any, end: Transition | None = None) -> None:
        """Add a branch: to a selection at a step, or to simultaneous sequences at a transition.

        `parts` are as for `SfcNetwork.add_sequence`. A branch of a selection begins with its condition and ends with a
        jump; a simultaneous one begins and ends with a step, for whose end the transition `end` waits.
        """
        found, chart = self._branching(start)
        with self._adding(chart):
            chart_edits.add_branch(self._journal, chart, found, parts, end)

    @_edit
    def remove_branch(self, start: Transition | Step | str) -> list[str]:
        """Remove a branch of a selection (its first transition) or of simultaneous sequences (its first step).

        Gives the names of the steps that are gone. Refused where program text outside of the branch names them.
        """
        found, chart = self._branching(start)
        gone = chart_edits.branch_of(chart, found)
        with self._removing(gone):
            chart_edits.remove_branch(self._journal, chart, found, gone)
        return [step.name for step in gone]

    # -- conditions and actions

    @_edit
    def extract_condition(self, link: Transition, name: str) -> NamedTransition:
        """Make the condition of a transition a named transition of its POU; one that is equal is used again."""
        return name_edits.extract_condition(self._journal, self._chart_of(link), link, name)

    @_edit
    def inline_condition(self, link: Transition) -> Condition:
        """Put what a named condition names in its place."""
        return name_edits.inline_condition(self._journal, self._chart_of(link), link)

    @_edit
    def extract_action(self, step: Step | str, name: str, at: str | int = 0) -> Action:
        """Make code in place of a step an action of its POU.

        `at` is the number of the association (0 is the first), or ``entry_action``, ``main_action``, ``exit_action``.
        """
        return name_edits.extract_action(self._journal, self._step(step)[0], name, at)

    @_edit
    def inline_action(self, action: Action) -> None:
        """Put the code of an action into the one step that executes it, and remove the action."""
        name_edits.inline_action(self._journal, self.project, action)

    @_edit
    def use_iec_steps(self, chart: SfcNetwork, *, guarded: bool = False) -> list[str]:
        """Make IEC steps of the simple steps of CoDeSys 2.3: the action of each becomes an association with N.

        Code in place becomes actions of the POU, ``Fill`` is ``Fill.x``. Returns the paths of the texts that say so. An
        action is executed once more when its step was left: `guarded` code asks for the step, and does nothing then.
        """
        return step_kinds.use_iec_steps(self._journal, chart, guarded=guarded)

    @_edit
    def use_simple_steps(self, chart: SfcNetwork) -> list[str]:
        """Make simple steps of the IEC steps of CoDeSys 2.3, whose associations have N, or S and R with variables."""
        return step_kinds.use_simple_steps(self._journal, chart)

    # -- larger parts

    @_edit
    def move_to_macro(self, steps: Sequence[Step | str], name: str) -> Step:
        """Move a run of steps, entered at one step and left at one, into a new macro-step."""
        moved, chart = self._run(steps)
        with self._adding(chart), self._leaving(moved, "moved"):
            return runs_of_steps.move_to_macro(self._journal, chart, moved, name)

    @_edit
    def dissolve_macro(self, macro: Step | str) -> list[Step]:
        """Put the steps of a macro-step into its place."""
        step, chart = self._step(macro)
        with self._leaving([step], "dissolved"):
            return runs_of_steps.dissolve_macro(self._journal, chart, step)

    @_edit
    def move_to_action(self, steps: Sequence[Step | str], name: str, action: str) -> Step:
        """Move a run of steps into the chart of a new action, which a new step called `name` executes.

        The chart begins and ends with that step, in the same scans as before.
        """
        moved, chart = self._run(steps)
        with self._adding(chart):
            return called_charts.move_to_action(self._journal, chart, moved, name, action)

    @_edit
    def move_to_block(self, steps: Sequence[Step | str], name: str, block: str) -> Step:
        """Move a run of steps into the chart of a new function block, which a new step called `name` executes.

        What only these steps use moves with them; the block gets other variables of the POU as VAR_INPUT (read) and
        VAR_IN_OUT (written, and instances).
        """
        moved, chart = self._run(steps)
        with self._adding(chart):
            return called_charts.move_to_block(self._journal, chart, moved, name, block)

    @_edit
    def dissolve_chart(self, step: Step | str) -> list[Step]:
        """Put the steps that `move_to_action` or `move_to_block` has moved into the place of the step."""
        found, chart = self._step(step)
        with self._removing([found]):
            return called_charts.dissolve_chart(self._journal, chart, found)

    @_edit
    def copy_pou(self, source: Project, name: str, names: Mapping[str, str] | None = None) -> Pou:
        """Put a copy of a POU of another project into this one.

        `names`: by paths in the source other names for what the POU, or its project, declares (``{"Main": "Main2"}``).
        Refused where it names what this project does not have, or what is something else here.
        """
        return name_edits.copy_pou(self._journal, source, name, self.project, names or {})

    @_edit
    def lay_out_texts(self) -> list[str]:
        """Lay structured text out: keywords in capitals, blanks between words, lines indented by their blocks.

        Comments, line breaks and names stay. Gives the paths of the texts that changed. What cannot be read stays, and
        so do texts of GRAFCETs.
        """
        return name_edits.lay_out_texts(self._journal, self.project)

    @_edit
    def redraw(self, chart: SfcNetwork) -> None:
        """Discard the drawing of a chart: it is drawn from its steps and transitions when it is saved."""
        self._journal.put(chart, "drawing", None)

    # -- what edits are about

    def _run(self, steps: Sequence[Step | str]) -> tuple[list[Step], SfcNetwork]:
        if not steps:
            raise ModelError("a run of steps has none")
        names = Names(self.project)
        found = [self._step(each, names)[0] for each in steps]
        return found, self._step(found[0])[1]

    def _step(self, what: Step | str, names: Names | None = None) -> tuple[Step, SfcNetwork]:
        """Return a step and its chart. `names`: those of the project, for who asks for many steps."""
        step: Any = what
        if isinstance(what, str):
            step = unique_declaration(names or Names(self.project), what).holder
        if not isinstance(step, Step):
            raise ModelError(f"{what!r} is no step")
        if step.chart is None or step.project is not self.project:
            raise ModelError(f"the step {step.name!r} is not in this project")
        return step, self._keep_drawing(step.chart)

    def _branching(self, what: Transition | Step | str) -> tuple[Transition | Step, SfcNetwork]:
        return (what, self._chart_of(what)) if isinstance(what, Transition) else self._step(what)

    def _chart_of(self, link: Transition) -> SfcNetwork:
        for chart in charts_of(self.project):
            if any(each is link for each in chart.transitions):
                return self._keep_drawing(chart)
        raise ModelError("the transition is not in this project")

    def _keep_drawing(self, chart: SfcNetwork) -> SfcNetwork:
        if id(chart) not in self._drawn:
            self._drawn.add(id(chart))
            self._journal.keep_drawing(chart)
        return chart

    @contextmanager
    def _adding(self, chart: SfcNetwork) -> Iterator[None]:
        """Refuse new steps of a chart whose names are taken, or would mean something else in the texts of the POU.

        Refuse transitions with new conditions that cannot be read, too.
        """
        pou = pou_of(chart)
        conditions = [transition.condition for transition in chart.transitions]
        known = {step.id for step in chart.steps}
        texts = {(id(each.holder), each.key): each.text for each in text_sites_in(pou)} if pou is not None else {}
        yield
        if pou is not None:
            made = [step for step in chart.steps if step.id not in known]
            name_edits.check_new_steps(Names(self.project), pou, made, texts)
        kept = {id(condition) for condition in conditions}
        runs_of_steps.check_conditions(chart, (each for each in chart.transitions if id(each.condition) not in kept))

    @contextmanager
    def _removing(self, steps: Sequence[Step]) -> Iterator[None]:
        """Remove the variables that the tool declares for steps; refuse to leave texts that name these steps."""
        names = Names(self.project)
        with self._leaving(steps, "removed"):
            for step in steps:
                repeated = names.resolver.repeated(names.declaration_of(step))
                name_edits.remove_objects(self._journal, self.project, repeated)
            yield

    @contextmanager
    def _leaving(self, steps: Sequence[Step], done: str) -> Iterator[None]:
        """Refuse to leave texts in which the names of steps mean nothing any more."""
        names = {step.name for step in steps}
        keys = names | {f"X{each.name}" for each in steps if each.chart and runs_of_steps.grafcet_of(each.chart)}
        before = name_edits.undeclared(Names(self.project), keys)
        yield
        if dangling := [use for use in name_edits.undeclared(Names(self.project), keys) if use not in before]:
            what = f"{', '.join(sorted(names))} cannot be {done}"
            raise refused(what, (f"it is named in {use}" for use in dangling))


def _name(form: str, number: int, name: str) -> str:
    try:
        if any(len(digits) > _DIGITS for digits in re.findall(r"\d+", form)):
            raise ValueError(form)  # a width that fills the memory
        return form.format(number=number, name=name)
    except (KeyError, IndexError, ValueError, AttributeError):
        raise ModelError(
            f"{form!r} is no form of names", hint="It may have {number}, {number:03} and {name} in it."
        ) from None


_DIGITS = 3
"""Digits of a width in a form of names: a name has fewer than 1,000 characters."""
_SUPERVISED = {"interlock", "supervision"}
"""Fields of a step with conditions."""
_STRUCTURE = {
    "name": "rename",
    "id": "no other: ids are the affair of the chart",
    "sources": "insert_step, retarget or the branches",
    "targets": "retarget",
    "macro": "move_to_macro",
}
"""Fields that cannot be set alone, and the edits that are for them."""


def edit(project: Project, *, clean: bool = False, prove: bool = False, limit: float | str | None = None) -> Editor:
    """Return the editor of a project; `Project.edit` is the same."""
    return Editor(project, clean=clean, prove=prove, limit=limit)
