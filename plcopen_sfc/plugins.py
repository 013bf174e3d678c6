"""Plugins: formats, rules and refactorings of other installed packages, by their entry points."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any, TypeVar

from plcopen_sfc.errors import PluginError

FORMATS = "plcopen_sfc.formats"
"""Entry points that are a `Format`, the record of a file format."""
CHECKS = "plcopen_sfc.checks"
"""Entry points that are a `Rule` of `check`."""
REFACTORINGS = "plcopen_sfc.refactorings"
"""Entry points that are a function ``refactor(project)`` or a class, as scripts have them."""

Provided = TypeVar("Provided")


@cache
def _entries(group: str) -> tuple[EntryPoint, ...]:
    return tuple(sorted(entry_points(group=group), key=lambda entry: entry.name))


def names_of(group: str) -> list[str]:
    """Return the names of the entry points of a group, without importing what they are."""
    return [entry.name for entry in _entries(group)]


def loaded(group: str, name: str) -> Any:
    """Import and return what a plugin provides. Raises `PluginError`, and `KeyError` where none has this name."""
    entry = {each.name: each for each in _entries(group)}[name]
    try:
        return entry.load()
    except (Exception, SystemExit) as error:  # whatever another package does wrong
        message = f"{_called(entry)} cannot be imported: {type(error).__name__}: {error}"
        raise PluginError(message, hint="Mend the package, or uninstall it.") from error


def _called(entry: EntryPoint) -> str:
    return f"the plugin {entry.name} of the package {entry.dist.name if entry.dist is not None else entry.value}"


def provided_by_plugins(group: str, kind: type[Provided]) -> Iterator[Provided]:
    """Yield the objects that all plugins of a group provide. Raises `PluginError` for what is not of `kind`."""
    for entry in _entries(group):
        found = loaded(group, entry.name)
        if not isinstance(found, kind):
            message = f"{_called(entry)} is no {kind.__name__}, which {group} are"
            raise PluginError(message, hint="See docs/plugins.md for what a plugin is.")
        yield found
