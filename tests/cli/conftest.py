from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from plcopen_sfc.cli import main

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class CommandRun:
    code: int
    out: str
    err: str


@pytest.fixture
def fixtures(monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of example files, as the working folder: messages name files as they were given."""
    folder = ROOT / "fixtures"
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def cli(capsys: pytest.CaptureFixture[str]) -> Callable[..., CommandRun]:
    """Run a command in this process, as in a pipe."""

    def run(*arguments: object) -> CommandRun:
        capsys.readouterr()
        code = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return CommandRun(code, captured.out, captured.err)

    return run


@pytest.fixture
def command() -> Callable[..., subprocess.CompletedProcess[bytes]]:
    """Run the real command in a process of its own."""

    def run(
        *arguments: object, env: dict[str, str] | None = None, **options: Any
    ) -> subprocess.CompletedProcess[bytes]:
        return subprocess.run(
            [sys.executable, "-m", "plcopen_sfc", *map(str, arguments)],
            capture_output=True,
            check=False,
            timeout=60,
            env={**os.environ, "PYTHONPATH": str(ROOT), **(env or {})},
            **options,
        )

    return run
