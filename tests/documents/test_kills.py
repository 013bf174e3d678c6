"""Processes that are killed at random moments of a save, and several that save to one place at once."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest

import plcopen_sfc as sfc
from tests.samples import FIXTURES
from tests.sweeps import WHOLE

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs a POSIX system")

KILLS = 500 if WHOLE else 12
"""Of each test: of a file and of a folder."""
FILE = FIXTURES / "codesys" / "sorting_conveyor.xml"
FOLDER = FIXTURES / "simaticml-plc"


def child(deed: Callable[[], object]) -> int:
    """Start a process that repeats something until it is killed; returns its number."""
    number = os.fork()
    if number:
        return number
    try:
        while True:
            deed()
    finally:
        os._exit(1)


def kill_at_random(deed: Callable[[], object], chance: Random) -> None:
    number = child(deed)
    time.sleep(chance.uniform(0.001, 0.12))
    os.kill(number, signal.SIGKILL)
    assert os.WIFSIGNALED(os.waitpid(number, 0)[1]), "the process ended by itself"


def edited(project: sfc.Project, text: str) -> sfc.Project:
    """Charts of the first POU: the others are left out of what is written and verified, and put back."""
    for chart in project.charts():
        if chart.pou is project.pous[0]:
            chart.chart.steps[0].comment = text
    return project


@pytest.mark.slow
def test_a_killed_save_leaves_the_old_file_or_the_new_one(tmp_path: Path) -> None:
    target, chance = tmp_path / "line.xml", Random("kills")  # noqa: S311
    variants = [edited(sfc.loads(FILE.read_bytes()), text) for text in ("one", "other")]
    allowed = {sfc.dumps(variant) for variant in variants} | {FILE.read_bytes()}
    target.write_bytes(FILE.read_bytes())
    for _ in range(KILLS):
        kill_at_random(lambda: [sfc.save(variant, target) for variant in variants], chance)
        assert target.read_bytes() in allowed


@pytest.mark.slow
def test_a_killed_save_leaves_every_document_of_a_folder_whole(tmp_path: Path) -> None:
    target, chance = tmp_path / "plc", Random("kills of folders")  # noqa: S311
    variants = [edited(sfc.load(FOLDER), text) for text in ("one", "other")]
    allowed: dict[str, set[bytes]] = {}
    for variant in variants:
        sfc.save(variant, target)
        for path in target.rglob("*.xml"):
            allowed.setdefault(path.name, set()).add(path.read_bytes())
    for _ in range(KILLS):
        kill_at_random(lambda: [sfc.save(variant, target) for variant in variants], chance)
        found = {path.name: path.read_bytes() for path in target.rglob("*.xml") if not path.name.startswith(".")}
        assert found.keys() == allowed.keys()
        assert all(data in allowed[name] for name, data in found.items())


@pytest.mark.slow
def test_eight_processes_on_one_file(tmp_path: Path) -> None:
    target = tmp_path / "line.xml"
    variants = [edited(sfc.loads(FILE.read_bytes()), f"of process {number}") for number in range(8)]
    allowed = {sfc.dumps(variant) for variant in variants}
    sfc.save(variants[0], target)
    children = [child(lambda variant=variant: sfc.save(variant, target)) for variant in variants]  # type: ignore[misc]
    for _ in range(40):
        time.sleep(0.01)
        assert target.read_bytes() in allowed
    for number in children:
        os.kill(number, signal.SIGKILL)
        os.waitpid(number, 0)
    assert target.read_bytes() in allowed
