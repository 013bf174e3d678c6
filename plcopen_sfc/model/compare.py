"""Comparing models: what differs, and where."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from plcopen_sfc.model.base import Model
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.text import MarkupText, MultilingualText

_UNORDERED = frozenset({"logic", "nodes", "steps", "transitions"})
"""Lists whose order says nothing as such: nets are what their wires are. The order of rivals is compared by itself."""


class Difference(NamedTuple):
    """`path` leads to the place (``pous[Main].bodies[0].chart.steps[S3].max_time``); one side may be None."""

    path: str
    left: Any
    right: Any


def differences(left: Any, right: Any, *, ignore: frozenset[str] = frozenset(), path: str = "") -> Iterator[Difference]:
    """What differs between two model objects. Fields named in `ignore` are not looked at."""
    if type(left) is not type(right):
        yield Difference(path, left, right)
    elif isinstance(left, Model | MarkupText | MultilingualText):
        for name in type(left).model_fields:
            if name not in ignore:
                a, b = getattr(left, name), getattr(right, name)
                if name in _UNORDERED and a and b and all(hasattr(thing, "id") for thing in (*a, *b)):
                    a, b = sorted(a, key=_id), sorted(b, key=_id)
                if a is not b:
                    yield from differences(a, b, ignore=ignore, path=f"{path}.{name}" if path else name)
        if isinstance(left, SfcNetwork):
            yield from differences(_rivals(left), _rivals(right), path=f"{path}.order of transitions")
    elif isinstance(left, list):
        if len(left) != len(right):
            yield Difference(path, _names(left), _names(right))
        else:
            for index, (a, b) in enumerate(zip(left, right, strict=True)):
                yield from differences(a, b, ignore=ignore, path=f"{path}[{_label(a, index)}]")
    elif isinstance(left, dict):
        for key in left.keys() | right.keys():
            yield from differences(left.get(key), right.get(key), ignore=ignore, path=f"{path}[{key}]")
    elif left != right:
        yield Difference(path, left, right)


def _rivals(chart: SfcNetwork) -> dict[int, list[int]]:
    """The transitions that leave each step, in the order in which they are tried."""
    leaving: dict[int, list[int]] = {}
    for transition in sorted(chart.transitions, key=lambda t: (t.priority is None, t.priority or 0)):
        for source in transition.sources:
            leaving.setdefault(source, []).append(transition.id)
    return leaving


def _id(thing: Any) -> int:
    number: int = thing.id
    return number


def _label(thing: Any, index: int) -> str:
    return getattr(thing, "name", None) or str(index)


def _names(things: list[Any]) -> list[str]:
    return [_label(thing, index) for index, thing in enumerate(things)]
