"""A batch on a cluster of Dask: a scheduler and two workers in processes of their own, one of which is killed."""

from __future__ import annotations

import os
import pickle
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.batch import apply

pytest.importorskip("distributed", reason="Dask is not installed: pip install plcopen-sfc[dask]")
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

ROOT = Path(__file__).resolve().parents[1]
FILES = 12
SCRIPT = """
import os, time
from pathlib import Path

def refactor(project, log: str):
    chart = next(iter(project.charts())).chart
    chart.rename_step(chart.steps[0].name, "Z_" + chart.steps[0].name)
    with Path(log).open("a") as file:
        file.write(f"{os.getpid()} {project.source.path}\\n")
    time.sleep(0.1)
"""


def start(*arguments: str) -> subprocess.Popen[str]:
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "dask", *arguments, "--no-dashboard"]
    return subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)


def wait_for(process: subprocess.Popen[str], pattern: str) -> str:
    assert process.stderr is not None
    for line in process.stderr:
        found = re.search(pattern, line)
        if found is not None:
            return found[1]
    raise AssertionError(f"{process.args} ended")


@pytest.fixture
def cluster() -> Iterator[tuple[str, list[subprocess.Popen[str]]]]:
    """The address of a scheduler, and its two workers."""
    scheduler = start("scheduler", "--host", "127.0.0.1", "--port", "0")
    address = wait_for(scheduler, r"Scheduler at:\s+(tcp://\S+)")
    workers = [start("worker", address, "--nthreads", "1", "--no-nanny") for _ in range(2)]
    for worker in workers:
        wait_for(worker, r"(Registered to)")
    yield address, workers
    for process in (*workers, scheduler):
        process.kill()
        process.wait()
        if process.stderr is not None:
            process.stderr.close()


def test_a_worker_that_is_killed_loses_nothing_and_nothing_is_done_twice(
    cluster: tuple[str, list[subprocess.Popen[str]]], tmp_path: Path
) -> None:
    address, workers = cluster
    paths = [str(tmp_path / f"chain{at}.xml") for at in range(FILES)]
    for path in paths:
        shutil.copy(ROOT / "fixtures" / "training-chain" / "codesys.xml", path)
    script, log = tmp_path / "script.py", tmp_path / "log"
    script.write_text(SCRIPT, encoding="utf-8")
    done = []
    for found in apply(str(script), paths, settings={"log": str(log)}, write=True, scheduler=address):
        if len(done) == 1:
            assert {line.split()[0] for line in log.read_text().splitlines()} == {str(each.pid) for each in workers}
            workers[0].kill()
            time.sleep(0.1)
        done.append(found)
    assert [each.path for each in done] == paths
    assert [each.error for each in done] == [""] * FILES
    for path in paths:
        (chart,) = sfc.load(path).charts()
        assert [step.name.count("Z_") for step in chart.chart.steps] == [1, *[0] * (len(chart.chart.steps) - 1)]


@pytest.mark.parametrize("data", [b"<a><b></a>", b'<?xml version="1.0" encoding="utf-8"?><a>\xe9</a>', b"<a>" * 400])
def test_errors_of_files_reach_another_machine(data: bytes) -> None:
    """Dask pickles an error with its context; those of lxml cannot be pickled."""
    with pytest.raises(sfc.SfcError) as caught:
        sfc.loads(data, format="plcopen")
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)  # noqa: S301  # our own bytes
