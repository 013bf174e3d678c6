"""Queries: steps and transitions by what they do, declarations by name, and charts and uses of names as tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from enum import Enum
from fnmatch import fnmatchcase
from functools import cache
from inspect import signature
from typing import Annotated, Any, get_args, get_origin

from plcopen_sfc.errors import ModelError, check_argument, nearest, shown
from plcopen_sfc.languages.binding import Declaration, Effects, Kind, Names, actions_by_name, step_effects
from plcopen_sfc.languages.binding.name_scopes import every_chart
from plcopen_sfc.languages.binding.name_uses import dialect_of
from plcopen_sfc.languages.effects import effects
from plcopen_sfc.languages.networks.condition_reading import condition_reader, shown_condition
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.declaration import check_kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.owners import Owned
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork, Step, StepKey, Transition
from plcopen_sfc.model.text import plain
from plcopen_sfc.reachability import reached


def matches(pattern: str, path: str) -> bool:
    """True if a pattern (``*`` and ``?``) is that of a whole path, or of its end: ``S*`` of ``Main.S1``."""
    pattern, names = pattern.casefold(), path.casefold().split(".")
    return any(fnmatchcase(".".join(names[start:]), pattern) for start in range(len(names)))


def find_steps(
    where: Project | SfcNetwork,
    predicate: Callable[[Step], bool] | None = None,
    *,
    drives: str | None = None,
    reads: str | None = None,
    calls: str | None = None,
    qualifier: str | Iterable[str] | None = None,
    reachable_from: StepKey | None = None,
    leading_to: StepKey | None = None,
    **fields: Any,
) -> list[Step]:
    """Return the steps of a chart, or of all charts of a project; `SfcNetwork.find` has the conditions."""
    wanted_fields = _checked_fields(fields, Step, "steps", find_steps)
    _check_predicate(predicate)
    _check_patterns("drives, reads and calls", drives, reads, calls)
    qualifiers = _qualifiers(qualifier)
    found: list[Step] = []
    charts = [where] if isinstance(where, SfcNetwork) else list(charts_of(where))
    first, last = (_steps_meant(charts, key) for key in (reachable_from, leading_to))
    for chart in charts:
        ids = _reached(chart, first, last)
        actions, dialect = actions_by_name(pou_of(chart)), dialect_in(chart)
        for step in chart.steps:
            if step.id not in ids or not _has(step, wanted_fields):
                continue
            if qualifiers is not None and not any(each.qualifier in qualifiers for each in step.actions):
                continue
            wanted = (drives, reads, calls)
            if any(wanted) and not _acts(step_effects([step], actions, dialect), wanted):
                continue
            if predicate is None or predicate(step):
                found.append(step)
    return found


def find_transitions(
    where: Project | SfcNetwork,
    predicate: Callable[[Transition], bool] | None = None,
    *,
    reads: str | None = None,
    calls: str | None = None,
    condition: str | None = None,
    leaving: str | None = None,
    entering: str | None = None,
    **fields: Any,
) -> list[Transition]:
    """Return the transitions of a chart or of all charts; `SfcNetwork.find_transitions` has the conditions."""
    wanted_fields = _checked_fields(fields, Transition, "transitions", find_transitions)
    _check_predicate(predicate)
    _check_patterns("reads, calls, condition, leaving and entering", reads, calls, condition, leaving, entering)
    found: list[Transition] = []
    for chart in [where] if isinstance(where, SfcNetwork) else charts_of(where):
        pou, dialect = pou_of(chart), dialect_in(chart)
        named = pou.transitions if pou is not None else ()
        read = condition_reader(chart, dialect, transitions=named)
        steps = {step.id: step for step in chart.steps}
        for transition in chart.transitions:
            sides = ((leaving, transition.sources), (entering, transition.targets))
            if not all(
                wanted is None or any(_is_called(chart, steps.get(i), wanted) for i in ids) for wanted, ids in sides
            ):
                continue
            if not _has(transition, wanted_fields):
                continue
            if condition is not None:
                shown = shown_condition(chart, transition, dialect, named)
                if shown is None or not _fits(shown[0], condition):
                    continue
            if reads or calls:
                result = read(transition.condition) if transition.condition is not None else None
                trees = [*result.before, *([result.tree] if result.tree is not None else [])] if result else []
                if not _acts(effects(trees), (None, reads, calls)):
                    continue
            if predicate is None or predicate(transition):
                found.append(transition)
    return found


def where(
    owner: Owned, field: str, things: Sequence[Any], predicate: Callable[[Any], bool] | None, conditions: dict[str, Any]
) -> list[Any]:
    """Return those of the list `field` of an object that satisfy conditions: of steps and transitions as `find`."""
    if isinstance(owner, SfcNetwork) and field in ("steps", "transitions"):
        find: Callable[..., list[Any]] = find_steps if field == "steps" else find_transitions
        return find(owner, predicate, **conditions)
    _check_predicate(predicate)
    wanted = {kind: _checked_fields(conditions, kind, field, where) for kind in {type(thing) for thing in things}}
    found = [each for each in things if _has(each, wanted[type(each)])]
    return [each for each in found if predicate is None or predicate(each)]


def charts_of(project: Project) -> Iterator[SfcNetwork]:
    """Yield every chart of a project, those of macro-steps and partial charts too."""
    return (chart for pou in project.pous for chart in every_chart(pou))


def pou_of(thing: Owned) -> Pou | None:
    """Return the POU that an object is in."""
    owner = thing.owner
    while owner is not None and not isinstance(owner, Pou):
        owner = owner.owner
    return owner


def owners(chart: SfcNetwork) -> tuple[Project, Pou]:
    """Return the project and the POU that a chart is in. Raises `ModelError` where it is in none."""
    pou = pou_of(chart)
    if pou is None:
        raise ModelError("the chart is in no POU", hint="Put it into a POU of a project first.")
    return chart.project or Project(pous=[pou]), pou


def dialect_in(chart: SfcNetwork) -> Dialect:
    """Return the dialect of the texts of a chart."""
    return dialect_of(chart.project) if chart.project is not None else Dialect.CODESYS


_Fields = dict[str, Sequence[Any]]
"""The values of which each field shall have one."""


def _checked_fields(fields: dict[str, Any], kind: type[Model], called: str, query: Callable[..., object]) -> _Fields:
    """Return conditions on fields. Raises `ModelError` for a field that there is not, or that never has such a value.

    Several values may be wanted of a field that is no list itself.
    """
    options: _Fields = {}
    conditions = signature(query).parameters
    for name, wanted in fields.items():
        if name not in kind.model_fields:
            near = nearest(name, [*kind.model_fields, *conditions])
            raise ModelError(f"{called} have no field {name!r}{near}")
        is_several = isinstance(wanted, list | tuple | set | frozenset) and list not in _types_of(kind, name)
        options[name] = [*wanted] if is_several else [wanted]
        for each in options[name]:
            _check_value(kind, name, each)
    return options


def _check_value(kind: type[Model], name: str, wanted: Any) -> None:
    """Raise `ModelError` for a condition that no object fulfils, because its field never has such a value."""
    types = _types_of(kind, name)
    choices = [*(each for each in types if issubclass(each, Enum))]
    if isinstance(wanted, str) and choices and str not in types:
        known = [str(member.value) for each in choices for member in each]
        if not any(_fits(each, wanted) for each in known):
            raise ModelError(f"{name} is never {wanted!r}{nearest(wanted, known)}", hint=f"It is: {', '.join(known)}")
    elif (types and not isinstance(wanted, types)) or (isinstance(wanted, bool) and bool not in types):
        raise ModelError(f"{name} is never {shown(wanted)} ({type(wanted).__name__})")


@cache
def _types_of(kind: type[Model], field: str) -> tuple[type, ...]:
    """Return the classes of the values of a field; none where it may have any."""

    def within(annotation: Any) -> tuple[type, ...]:
        if get_origin(annotation) in (list, dict, tuple):
            return (get_origin(annotation),)
        arguments = get_args(annotation)
        if get_origin(annotation) is Annotated:
            arguments = arguments[:1]
        return (annotation,) if isinstance(annotation, type) else tuple(t for each in arguments for t in within(each))

    return within(kind.model_fields[field].annotation)


def _qualifiers(wanted: str | Iterable[str] | None) -> Set[Qualifier] | None:
    if wanted is None:
        return None
    check_argument(wanted, Iterable, 'a query needs a qualifier, or several: "N"')
    try:
        return {Qualifier(each) for each in ([wanted] if isinstance(wanted, str) else wanted)}
    except ValueError:
        known = ", ".join(Qualifier)
        raise ModelError(f"{wanted!r} is no qualifier", hint=f"The qualifiers are: {known}") from None


def _has(thing: Model, fields: _Fields) -> bool:
    """True if each field has one of the values that are wanted of it."""
    return all(any(_fits(getattr(thing, name), each) for each in options) for name, options in fields.items())


def _fits(value: Any, wanted: Any) -> bool:
    if isinstance(value, str) and isinstance(wanted, str):
        return fnmatchcase(value.casefold(), wanted.casefold())
    return bool(value == wanted)


def _acts(effects: Effects, wanted: tuple[str | None, str | None, str | None]) -> bool:
    found = (effects.writes, effects.reads, effects.calls)
    return all(
        pattern is None or any(matches(pattern, ".".join(path)) for path in paths if path)
        for pattern, paths in zip(wanted, found, strict=True)
    )


def _path(chart: SfcNetwork, step: Step) -> str:
    pou = pou_of(chart)
    return step.name if pou is None else f"{pou.name}.{step.name}"


def _is_called(chart: SfcNetwork, step: Step | None, pattern: str) -> bool:
    """True if a pattern is that of the name of a step, or with a dot of its path."""
    return step is not None and _fits(_path(chart, step) if "." in pattern else step.name, pattern)


def _steps_meant(charts: Sequence[SfcNetwork], key: StepKey | None) -> list[Step] | None:
    """Return the steps with a name (``Fill``, ``Main.Fill``) or an id in some charts. Raises `ModelError` for none."""
    if key is None or isinstance(key, Step):
        return key if key is None else [key]
    check_argument(key, (str, int), "the name or the id of a step is needed")
    steps = [(chart, step) for chart in charts for step in chart.steps]
    end = f".{key.casefold()}" if isinstance(key, str) else None
    found = [
        step
        for chart, step in steps
        if step.id == key or (end is not None and f".{_path(chart, step).casefold()}".endswith(end))
    ]
    if not found:
        place = "this chart" if len(charts) == 1 else "the project"
        near = nearest(key, [step.name for _, step in steps])
        raise ModelError(f"{place} has no step {shown(key)}{near}")
    return found


def _reached(chart: SfcNetwork, first: list[Step] | None, last: list[Step] | None) -> set[int]:
    """Return the ids of the steps to which transitions lead from `first`, and from which they lead to `last`."""
    ids = {step.id for step in chart.steps}
    if first is not None:
        ids &= _closure(chart, first, lambda t: (t.sources, t.targets))
    if last is not None:
        ids &= _closure(chart, last, lambda t: (t.targets, t.sources))
    return ids


def _closure(
    chart: SfcNetwork, starts: Sequence[Step], sides: Callable[[Transition], tuple[list[int], list[int]]]
) -> set[int]:
    leading: dict[int, list[int]] = {}
    for transition in chart.transitions:
        before, after = sides(transition)
        for each in before:
            leading.setdefault(each, []).extend(after)
    own = [step.id for step in chart.steps if any(step is each for each in starts)]
    return reached((target for each in own for target in leading.get(each, ())), lambda step: leading.get(step, ()))


def _check_predicate(predicate: object) -> None:
    if predicate is not None:
        check_argument(predicate, Callable, "a query needs a function", 'Look for a name by a pattern: name="Fill*".')  # type: ignore[arg-type]  # an abstract class


def _check_patterns(called: str, *patterns: str | None) -> None:
    for pattern in patterns:
        check_argument(pattern, (str, type(None)), f'{called} are patterns: "*Valve*"')


def find_declared(project: Project, pattern: str, kind: str | None = None) -> list[Declaration]:
    """Return the declarations of a project that fit a pattern, by the path or the end of it."""
    check_argument(pattern, str, 'find needs a pattern: "Motor*"')
    if kind is not None:
        check_kind(kind)
    names = Names(project)
    found = (each for each in names.declarations() if kind is None or each.kind == kind)
    return list(dict.fromkeys(names.resolver.original(each) for each in found if matches(pattern, each.path)))


# -- tables


def chart_records(chart: SfcNetwork) -> list[dict[str, Any]]:
    """Return the rows of `SfcNetwork.to_records`."""
    pou, dialect = pou_of(chart), dialect_in(chart)
    names = {step.id: step.name for step in chart.steps}

    def condition(transition: Transition) -> str:
        shown = shown_condition(chart, transition, dialect, pou.transitions if pou is not None else ())
        return shown[0] if shown is not None else "?"

    return [
        {
            "step": step.name,
            "number": step.number,
            "initial": step.initial,
            "comment": plain(step.comment),
            "actions": [association.text for association in step.actions],
            **{name: _code(getattr(step, name)) for name in ("entry_action", "main_action", "exit_action")},
            **{name: getattr(step, name) for name in Step.TIMES},
            "next": [
                f"{condition(transition)} -> {'+'.join(names.get(i, '?') for i in transition.targets)}"
                for transition in chart.outgoing(step)
            ],
        }
        for step in chart.steps
    ]


def _code(action: Any) -> str | None:
    """Return the name of a step action, the text of one in place, or its language."""
    return action if action is None or isinstance(action, str) else getattr(action, "text", f"({action.language})")


def cross_references(project: Project, kind: str | None = Kind.VARIABLE) -> list[dict[str, Any]]:
    """Return the rows of `Project.cross_references`, in the order of the texts."""
    if kind is not None:
        check_kind(kind)
    rows: list[dict[str, Any]] = []
    for occurrence in Names(project).everything:
        declaration = occurrence.meaning.declaration
        if declaration is not None and kind in (None, declaration.kind) and not occurrence.reference.declares:
            use = occurrence.use
            rows.append(
                {
                    "name": declaration.path,
                    "kind": str(declaration.kind),
                    "place": use.path,
                    "language": use.language,
                    "line": use.line,
                    "column": use.column,
                    "text": use.text,
                }
            )
    return rows
