"""Arguments of methods, checked by their annotations: a wrong one is told in words before anything is changed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from inspect import BoundArguments, signature
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from plcopen_sfc.errors import check_argument
from plcopen_sfc.model.base import Model


def bound_arguments(method: Callable[..., Any], *args: Any, **kwargs: Any) -> BoundArguments:
    """Return the arguments of a call by their names; what can be iterated as a list. Raises `ArgumentError`."""
    wanted = _argument_types(method)
    bound = signature(method).bind(*args, **kwargs)
    for name, value in bound.arguments.items():
        types, items = wanted.get(name, ((object,), ()))
        needs = " or ".join(each.__name__ for each in types if each is not type(None))
        several = f" of {' or '.join(each.__name__ for each in items)}" if items else ""
        need = f"{method.__name__} needs as {name}: {needs}{several}"
        alone = tuple(each for each in types if each not in _SEVERAL)
        if not items or isinstance(value, alone):
            check_argument(value, types, need)
            continue
        check_argument(value, alone if isinstance(value, str | Model) else types, need)  # both can be iterated
        bound.arguments[name] = things = list(value)
        for each in things:
            check_argument(each, items, need)
    return bound


@cache
def _argument_types(method: Callable[..., Any]) -> dict[str, tuple[tuple[type, ...], tuple[type, ...]]]:
    """Return the classes that each argument may have, by the annotations, and those of the things in it."""
    return {name: (_classes(hint), _item_classes(hint)) for name, hint in get_type_hints(method).items()}


_SEVERAL = (Iterable, Sequence)
"""Annotations of arguments that are several things."""


def _item_classes(hint: Any) -> tuple[type, ...]:
    options = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    several = (each for each in options if get_origin(each) in _SEVERAL)
    return tuple(kind for each in several for item in get_args(each) for kind in _classes(item))


def _classes(hint: Any) -> tuple[type, ...]:
    origin = get_origin(hint) or hint
    if origin in (Union, UnionType):
        return tuple(each for part in get_args(hint) for each in _classes(part))
    return (origin,) if isinstance(origin, type) and origin is not Any else (object,)
