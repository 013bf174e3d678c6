"""Python in the texts of a project is not executed: a sample of the attempts of `tests.fuzz.injection`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.sweeps import WHOLE


def test_no_text_of_a_project_reaches_python() -> None:
    command = [sys.executable, "-m", "tests.fuzz.injection", "--every", "1" if WHOLE else "97"]
    # a process of its own: an audit hook cannot be taken out
    done = subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parents[2], check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "simulation: ran" in done.stdout
    assert "lowering: " in done.stdout
