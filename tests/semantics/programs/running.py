"""Programs of the tests: from text to an instance that runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import plcopen_sfc as sfc
from plcopen_sfc.model import Project
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs import Controller, Instance

MS = 1_000_000


def project_of(text: str, dialect: Dialect = Dialect.IEC) -> Project:
    """A project from its source; CODESYS and SCL texts are only marked as such."""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = dialect
    return project


def start(
    text: str,
    dialect: Dialect = Dialect.IEC,
    *,
    pou: str = "Main",
    functions: Mapping[str, Callable[..., Any]] | None = None,
    read_input: Callable[[str], Any] | None = None,
    max_steps: int = 10_000,
) -> Instance:
    """An instance of a POU of a source in which everything can be translated."""
    controller = Controller(project_of(text, dialect), functions=functions, read_input=read_input, max_steps=max_steps)
    instance = controller.instance(pou)
    assert not controller.problems, [str(problem) for problem in controller.problems]
    return instance


def main(variables: str, body: str, dialect: Dialect = Dialect.IEC, more: str = "", **options: Any) -> Instance:
    """An instance of a program with these variables and this body, after its first scan."""
    instance = start(f"{more}\nPROGRAM Main\nVAR {variables} END_VAR\n{body}\nEND_PROGRAM", dialect, **options)
    instance.scan()
    return instance


def scan_at(instance: Instance, milliseconds: int) -> None:
    """A scan at a time."""
    instance.controller.now = milliseconds * MS
    instance.scan()
