"""Every text of the model is looked at, or it is known why not."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from typing import Any, get_args

import plcopen_sfc.model
from plcopen_sfc.languages.binding.text_sites import NAMELESS, NAMING
from plcopen_sfc.model.base import Model

EVERYWHERE = frozenset({"comment", "global_id", "object_id", "kind", "language"})
"""Fields of many classes that hold no names."""


def classes(base: type[Model] = Model) -> Iterator[type[Model]]:
    for info in pkgutil.iter_modules(plcopen_sfc.model.__path__):
        importlib.import_module(f"plcopen_sfc.model.{info.name}")
    for found in base.__subclasses__():
        yield found
        yield from classes(found)


def holds_text(annotation: Any) -> bool:
    if annotation is str:
        return True
    return any(holds_text(argument) for argument in get_args(annotation) if isinstance(argument, type | object))


def is_text(annotation: Any) -> bool:
    """True if a field holds a text, or a list or table of texts."""
    return holds_text(annotation) and "Literal" not in str(annotation)


def test_every_text_of_the_model_is_in_one_of_the_tables() -> None:
    naming = {f"{cls.__name__}.{field}" for cls, fields in NAMING.items() for field in fields}
    nameless = set().union(*NAMELESS.values())
    texts = {
        f"{cls.__name__}.{name}"
        for cls in classes()
        for name, field in cls.model_fields.items()
        if name not in EVERYWHERE and is_text(field.annotation)
    }
    assert naming & nameless == set()
    assert sorted(texts - naming - nameless) == []
    assert sorted((naming | nameless) - texts) == []


def test_fields_of_the_tables_are_in_the_model() -> None:
    for cls, fields in NAMING.items():
        assert set(fields) <= cls.model_fields.keys(), cls
