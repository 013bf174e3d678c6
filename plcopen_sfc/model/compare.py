"""Comparing models: what differs, and where."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import BodyBase
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.network import LogicNetwork
from plcopen_sfc.model.pou import Action, Method, NamedTransition
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, Tag, Task
from plcopen_sfc.model.sfc import ActionAssociation, PartialChart, SfcNetwork, Step, Transition, leaving_steps
from plcopen_sfc.model.text import MarkupText, MultilingualText
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import VariableSection

_UNORDERED = frozenset({"logic", "nodes", "steps", "transitions"})
"""Lists whose order has no meaning: wires make a net. The order of competing transitions is compared separately."""

_KINDS: tuple[tuple[type[Any], str], ...] = (
    (Step, "step"),
    (Transition, "transition"),
    (ActionAssociation, "action"),
    (Action, "action"),
    (NamedTransition, "transition"),
    (Method, "method"),
    (Variable, ""),
    (PartialChart, "partial chart"),
    (Configuration, "configuration"),
    (Resource, "resource"),
    (Task, "task"),
    (PouInstance, "instance"),
    (Tag, "tag"),
    (LogicNetwork, "network"),
)
"""Words for the objects of lists in messages and reports; variables have their names alone."""

_SECTION = "section"
_UNNAMED = frozenset({"body", "chart", "interface"})
"""Fields that no path names: what is in them is of the object around."""


def in_order_of(project: Project, other: Project) -> Project:
    """Return the project with its POUs, types and data blocks in the order that they have in another one."""
    lists: dict[str, list[ProjectObject]] = {}
    for field in ("pous", "data_types", "data_blocks"):
        places = {each.name: place for place, each in enumerate(getattr(other, field))}
        lists[field] = sorted(getattr(project, field), key=lambda each: places.get(each.name, len(places)))
    return project.model_copy(update=lists)


class ModelDifference(NamedTuple):
    """`path` names the place (``POU Main / action Fill / step S3 / max time``); one side may be None."""

    path: str
    left: Any
    right: Any


def differences(
    left: Any, right: Any, *, ignore: frozenset[str] = frozenset(), path: str = ""
) -> Iterator[ModelDifference]:
    """Return the differences between two model objects. Fields named in `ignore` are not looked at.

    The origin of a project is no content: projects are equal wherever they were converted from.
    """
    if isinstance(left, Project):
        ignore |= {"origin"}
    if type(left) is not type(right):
        yield ModelDifference(path, left, right)
    elif isinstance(left, Model | MarkupText | MultilingualText):
        labels = left.labels() if isinstance(left, SfcNetwork) else {}
        for name in type(left).__pydantic_fields__:
            if name not in ignore:
                a, b = getattr(left, name), getattr(right, name)
                if name in _UNORDERED and a and b and all(hasattr(thing, "id") for thing in (*a, *b)):
                    a, b = sorted(a, key=_id), sorted(b, key=_id)
                if a is b:
                    continue
                if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
                    for index, (one, other) in enumerate(zip(a, b, strict=True)):
                        if isinstance(one, Model) and one == other:
                            continue  # most of them; to walk through their fields takes several times as long
                        place = _place(path, name, one, index, labels, alone=len(a) == 1)
                        yield from differences(one, other, ignore=ignore, path=place)
                else:
                    unnamed = name in _UNNAMED and a is not None and b is not None and not isinstance(a, list)
                    place = path if unnamed else _joined(path, name.replace("_", " "))
                    yield from differences(a, b, ignore=ignore, path=place)
        if isinstance(left, SfcNetwork):
            orders = (_competing(each, by_id=_ids(left) == _ids(right)) for each in (left, right))
            yield from differences(*orders, path=_joined(path, "order of transitions"))
    elif isinstance(left, list):
        if len(left) != len(right):
            yield ModelDifference(path, _names(left), _names(right))
        else:
            for index, (a, b) in enumerate(zip(left, right, strict=True)):
                yield from differences(a, b, ignore=ignore, path=_joined(path, _label(a, index)))
    elif isinstance(left, dict):
        for key in {**left, **right}:  # in their order, and not in that of a set
            yield from differences(left.get(key), right.get(key), ignore=ignore, path=_joined(path, str(key)))
    elif left != right:
        yield ModelDifference(path, left, right)


def path_of(root: Any, keys: Iterable[str | int], known: dict[int, dict[int, str]] | None = None) -> str:
    """Return the path, as in a `ModelDifference`, of what the fields and indices `keys` lead to from `root`.

    `known` keeps the labels of the transitions of each chart (by its `id`), for who needs many paths of one model.
    """
    known = {} if known is None else known
    path, field, thing, owner = "", "", root, root
    for key in keys:
        if isinstance(key, int):
            labels: dict[int, str] = {}
            if isinstance(owner, SfcNetwork):
                labels = known.get(id(owner)) or known.setdefault(id(owner), owner.labels())
            path = _place(path, field, thing[key], key, labels, alone=len(thing) == 1)
            thing, field = thing[key], ""
            continue
        owner, thing = thing, thing.get(key) if isinstance(thing, dict) else getattr(thing, key, None)
        if isinstance(thing, list):
            field = key
        elif key not in _UNNAMED or thing is None:
            path = _joined(path, key.replace("_", " "))
    return _joined(path, field.replace("_", " ")) if field else path


def _place(path: str, name: str, thing: Any, index: int, labels: dict[int, str], *, alone: bool) -> str:
    """The path of `thing`, the element number `index` of the list in the field `name` of the object at `path`."""
    if isinstance(thing, ProjectObject):
        return _joined(path, thing.report_path)
    if isinstance(thing, VariableSection):
        word = "global variables" if name == "global_variables" else _SECTION
        return _joined(path, f"{word} {_label(thing, index)}")
    if isinstance(thing, BodyBase) and name == "bodies":
        return path if alone else _joined(path, f"body {index + 1}")
    if isinstance(thing, Variable):
        path = path.rpartition(f" / {_SECTION} ")[0] or path  # a variable belongs to the POU
    kind = next((word for known, word in _KINDS if isinstance(thing, known)), _singular(name))
    if isinstance(thing, Transition):
        return _joined(path, f"{kind} {labels.get(thing.id) or index + 1}")
    if isinstance(thing, ActionAssociation):
        return _joined(path, f"{kind} {thing.target or index + 1}")
    return _joined(path, f"{kind} {_label(thing, index)}".strip())


def _singular(field: str) -> str:
    word = field.replace("_", " ")
    return word[:-3] + "y" if word.endswith("ies") else word.removesuffix("s")


def _joined(path: str, part: str) -> str:
    return f"{path} / {part}" if path else part


def _competing(chart: SfcNetwork, *, by_id: bool) -> dict[str, list[str]]:
    """Return the transitions that leave each step, in the order in which they are tried.

    By their ids, or only by the names of the steps to which they lead: another file may give a chart other ids.
    """
    names = {step.id: step.name for step in chart.steps}

    def shown(transition: Transition) -> str:
        return str(transition.id) if by_id else ", ".join(names.get(target, "") for target in transition.targets)

    leaving = leaving_steps(chart.transitions).items()
    return {names.get(source, ""): [shown(each) for each in found] for source, found in leaving if len(found) > 1}


def _ids(chart: SfcNetwork) -> set[int]:
    return {transition.id for transition in chart.transitions}


def _id(thing: Any) -> int:
    number: int = thing.id
    return number


def _label(thing: Any, index: int) -> str:
    return getattr(thing, "name", None) or str(index + 1)


def _names(things: list[Any]) -> list[str]:
    return [_label(thing, index) for index, thing in enumerate(things)]
