"""Operations of the model that higher layers provide, such as renaming, which must understand program text.

`plcopen_sfc/__init__.py` provides them: it runs before any other module of the package and is above all of them. So
no module of the model names a higher layer. See decision 0010.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Operation = Callable[..., Any]

_providers: dict[str, Callable[[], Operation]] = {}


def provide(name: str, provider: Callable[[], Operation]) -> None:
    """Let `provider` import the operation called `name` when it is first asked for."""
    _providers[name] = provider


def provided(name: str) -> Operation:
    """Return the operation called `name`."""
    return _providers[name]()
