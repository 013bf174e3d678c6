"""Where our XML schemas lie: `schemas/` of a source checkout, `plcopen_sfc/schemas/` of an installation."""

from __future__ import annotations

from functools import cache
from importlib import resources
from pathlib import Path

from plcopen_sfc.errors import FileAccessError


@cache
def schema_path(name: str) -> Path:
    """The file of the schema `name` (``plcopen-2.01``).

    Raises `FileAccessError` where the package was installed without its schemas.
    """
    package = resources.files("plcopen_sfc")
    for folder in (package / "schemas", Path(str(package)).parent / "schemas"):
        path = Path(str(folder)) / f"{name}.xsd"
        if path.is_file():
            return path
    raise FileAccessError(
        f"the schema {name}.xsd is missing from this installation of plcopen_sfc",
        hint="Install the package anew, unpacked: libxml2 cannot read schemas inside an archive.",
    )
