"""The table ``[tool.plcopen_sfc]`` of the nearest pyproject.toml: options of `check` for the files of a folder."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plcopen_sfc.errors import Location, SfcError
from plcopen_sfc.files import read_bytes

__all__ = ["CheckSettings", "ConfigurationError", "Configurations"]

_FILE = "pyproject.toml"
_TABLE = "plcopen_sfc"


class ConfigurationError(SfcError):
    """A configuration file that cannot be read, or with a key or value that is unknown."""


@dataclass(frozen=True)
class CheckSettings:
    """The values of the table, None for those that it does not have. `path` is its file."""

    path: str | None = None
    select: tuple[str, ...] | None = None
    ignore: tuple[str, ...] | None = None
    profile: str | None = None
    fail_on: str | None = None


class Configurations:
    """The configuration for each file: that of its folder or of the nearest one above that has the table."""

    def __init__(self) -> None:
        self._of_folder: dict[Path, CheckSettings] = {}

    def of(self, file: str) -> CheckSettings:
        """The configuration for a file or folder. Raises `ConfigurationError`."""
        path = Path(file).absolute()
        return self._of(path if path.is_dir() else path.parent)

    def _of(self, folder: Path) -> CheckSettings:
        found = self._of_folder.get(folder)
        if found is None:
            found = _read(folder / _FILE)
            if found is None:
                found = self._of(folder.parent) if folder.parent != folder else CheckSettings()
            self._of_folder[folder] = found
        return found


def _read(path: Path) -> CheckSettings | None:
    """The table in this file; None where there is no file or no table."""
    if not path.is_file():
        return None
    try:
        content = tomllib.loads(read_bytes(path).decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"this is no TOML: {error}", location=Location(str(path))) from None
    tools = content.get("tool")
    table = tools.get(_TABLE) if isinstance(tools, dict) else None
    if table is None:
        return None
    if not isinstance(table, dict):
        raise _wrong(path, _TABLE, "a table")
    return _checked(path, table)


def _checked(path: Path, table: Mapping[str, Any]) -> CheckSettings:
    known = {"select": "a list of codes", "ignore": "a list of codes", "profile": "a text", "fail-on": "a text"}
    for key, value in table.items():
        if key not in known:
            hint = "Known are: " + ", ".join(known)
            raise ConfigurationError(
                f"[tool.{_TABLE}] has an unknown key {key!r}", location=Location(str(path)), hint=hint
            )
        codes = known[key] == "a list of codes"
        fits = isinstance(value, list) and all(isinstance(i, str) for i in value) if codes else isinstance(value, str)
        if not fits:
            raise _wrong(path, key, known[key])
    return CheckSettings(
        path=str(path),
        select=tuple(table["select"]) if "select" in table else None,
        ignore=tuple(table["ignore"]) if "ignore" in table else None,
        profile=table.get("profile"),
        fail_on=table.get("fail-on"),
    )


def _wrong(path: Path, key: str, wanted: str) -> ConfigurationError:
    return ConfigurationError(f"{key!r} of [tool.{_TABLE}] is not {wanted}", location=Location(str(path)))
