"""A batch over many generated exports: a rename in each, against a plain read and write of the same bytes.

    python -m benchmarks.batch                       100 exports of 1 MB, 1 and 2 processes, kill and resume
    python -m benchmarks.batch --files 1000

Times are wall times: what a batch is for. Memory is the peak of this process and of the largest of its children.
"""

from __future__ import annotations

import argparse
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.generate import generate
from plcopen_sfc.batch import apply

SCRIPT = """
def refactor(project):
    for chart in list(project.charts())[:1]:
        chart.chart.rename_step(chart.chart.steps[0].name, "Z_" + chart.chart.steps[0].name)
"""


def megabytes(who: int) -> float:
    """Return the peak memory in 10^6 bytes."""
    scale = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(who).ru_maxrss * scale / 1e6


def copies(template: Path, folder: Path, files: int) -> list[str]:
    """Fill a folder with copies of an export."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    paths = [folder / f"export{at:04}.xml" for at in range(files)]
    for path in paths:
        shutil.copy(template, path)
    return [str(path) for path in paths]


def renamed(paths: list[str]) -> list[int]:
    """How often each file has the new name in it at a step."""
    return [Path(path).read_bytes().count(b'name="Z_') for path in paths]


def killed_and_resumed(script: Path, folder: Path, paths: list[str], after: float) -> float:
    """Kill the command in the middle, run it again with the same journal; the seconds of the second run."""
    journal = str(folder.with_suffix(".journal"))
    arguments = [sys.executable, "-m", "plcopen_sfc", "apply", str(script), str(folder), "--write", "--jobs", "2"]
    arguments += ["--resume", journal, "--quiet"]
    first = subprocess.Popen(arguments, start_new_session=True)
    time.sleep(after)
    first.send_signal(signal.SIGKILL)
    first.wait()
    done = sum(count > 0 for count in renamed(paths))
    start = time.perf_counter()
    subprocess.run(arguments, check=True)
    print(f"killed after {done} of {len(paths)} files were written")
    return time.perf_counter() - start


def main() -> None:
    """Run all of it and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=int, default=100)
    parser.add_argument("--size", type=float, default=1.0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        script, template, folder = work / "script.py", work / "template.xml", work / "exports"
        script.write_text(SCRIPT, encoding="utf-8")
        generate(template, megabytes=options.size)
        paths = copies(template, folder, options.files)
        start = time.perf_counter()
        for path in paths:
            Path(path).write_bytes(Path(path).read_bytes())
        plain = time.perf_counter() - start
        print(
            f"{options.files} files of {template.stat().st_size / 1e6:.2f} MB; read and written plainly: {plain:.2f} s"
        )
        once = 0.0
        for jobs in (1, 2):
            paths = copies(template, folder, options.files)
            start = time.perf_counter()
            failed = [each.error for each in apply(str(script), paths, write=True, jobs=jobs) if each.error]
            seconds = time.perf_counter() - start
            once = once or seconds
            counts = set(renamed(paths))
            peaks = ", ".join(f"{megabytes(who):.0f} MB" for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
            print(f"{jobs} process(es): {seconds:.1f} s, {options.files / seconds:.1f} files/s, ", end="")
            print(f"{once / seconds:.2f} times as fast; {len(failed)} failed; Z_ in each: {counts}; peak {peaks}")
        paths = copies(template, folder, options.files)
        seconds = killed_and_resumed(script, folder, paths, max(3.0, once / 6))
        print(f"the rest: {seconds:.1f} s; Z_ in each: {set(renamed(paths))}")


if __name__ == "__main__":
    main()
