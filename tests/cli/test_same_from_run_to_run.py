"""Output of `convert` and `page` is the same in every run, in whatever order sets are iterated."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.sweeps import WHOLE

FIXTURES = Path(__file__).parents[2] / "fixtures"
SOURCES = {
    "codesys": "codesys/sorting_conveyor.xml",
    "plcopen": "plcopen/every_element_2.01.xml",
    "simaticml": "simaticml/FB_Drill.xml",
    "folder": "simaticml-plc",
    "iec-text": "iectext/mixing_plant.st",
    "scl": "scl/filling_line.scl",
    "json": "training-chain/model.json",
}
TARGETS = ("codesys", "plcopen-1.01", "plcopen-2.01", "simaticml", "iec-text", "scl", "json")
CONVERT = """
import json, os, sys
from plcopen_sfc.cli import main

for name, source, targets in json.load(sys.stdin):
    os.mkdir(name)
    os.chdir(name)
    for target in targets:
        main(["convert", source, target, "--to", target, "--partial", "--limit", "0", "--report", f"{target}.json"])
    if name == "plcopen":
        main(["page", source, "page.html"])
    os.chdir("..")
"""


@pytest.mark.slow
def test_conversions_do_not_depend_on_the_seed_of_hashes(tmp_path: Path) -> None:
    """All sources in one process for each seed: to start one takes longer than a conversion."""
    runs = [_run(tmp_path / seed, seed) for seed in ("1", "7")]
    reports = {Path(source, f"{target}.json") for source in SOURCES for target in _targets(source)}
    assert runs[0].keys() == runs[1].keys() >= {Path("output"), *reports}
    assert {name: runs[1][name] for name in runs[0] if runs[0][name] != runs[1][name]} == {}


def _targets(source: str) -> list[str]:
    """Every third target of a source, others of them for the next one."""
    first = list(SOURCES).index(source) % 3
    return [target for index, target in enumerate(TARGETS) if WHOLE or index % 3 == first]


def _run(folder: Path, seed: str) -> dict[Path, bytes]:
    """The written files and reports, and what the terminal shows as the file ``output``."""
    folder.mkdir()
    jobs = [(name, str(FIXTURES / path), _targets(name)) for name, path in SOURCES.items()]
    environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run(
        [sys.executable, "-c", CONVERT],
        input=json.dumps(jobs).encode(),
        cwd=folder,
        env=environment,
        capture_output=True,
        check=True,
    )
    (folder / "output").write_bytes(done.stdout + done.stderr)
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
