"""What `convert` writes and says is the same in every run: nothing depends on the order in which sets are iterated."""

from __future__ import annotations

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
import sys
from plcopen_sfc.cli import main

for target in sys.argv[2:]:
    main(["convert", sys.argv[1], target, "--to", target, "--partial", "--limit", "0", "--report", f"{target}.json"])
"""


@pytest.mark.slow
@pytest.mark.parametrize("source", SOURCES)
def test_conversions_do_not_depend_on_the_seed_of_hashes(source: str, tmp_path: Path) -> None:
    runs = [_run(source, tmp_path / seed, seed) for seed in ("1", "7")]
    reports = {Path(f"{target}.json") for target in _targets(source)}
    assert runs[0].keys() == runs[1].keys() >= {Path("output"), *reports}
    assert {name: runs[1][name] for name in runs[0] if runs[0][name] != runs[1][name]} == {}


def _targets(source: str) -> list[str]:
    """Every second target of a source, another half of them for the next one."""
    first = list(SOURCES).index(source) % 2
    return [target for index, target in enumerate(TARGETS) if WHOLE or index % 2 == first]


def _run(source: str, folder: Path, seed: str) -> dict[Path, bytes]:
    """The written files and reports, and what the terminal shows as the file ``output``."""
    folder.mkdir()
    command = [sys.executable, "-c", CONVERT, str(FIXTURES / SOURCES[source]), *_targets(source)]
    environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, check=True)
    (folder / "output").write_bytes(done.stdout + done.stderr)
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
