"""Rename steps in all files of a folder, after a list of names.

python rename_steps.py NAMES.csv FOLDER [--dry-run]

NAMES.csv has lines OLD;NEW. With --dry-run the changes are shown as a diff and nothing is written. Program text
follows; where nobody can tell what a name means, the script says so.
"""

from __future__ import annotations

import argparse
import csv
import difflib
import sys
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc.report import RenameResult


def rename(project: sfc.Project, names: dict[str, str]) -> list[RenameResult]:
    """Rename the steps of every chart."""
    return [
        chart.rename_step(old, new)
        for _, _, chart in project.charts()
        for old, new in names.items()
        if any(step.name == old for step in chart.steps)
    ]


def show(path: Path, new: bytes) -> None:
    """Print the difference between a file and its new content."""
    before, after = (data.decode("utf-8", errors="replace").splitlines() for data in (path.read_bytes(), new))
    for line in difflib.unified_diff(before, after, str(path), str(path), n=0, lineterm=""):
        print(line)


def main() -> int:
    """Rename in all files; 1 where one could not be read or a name is taken."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--dry-run", action="store_true")
    arguments = parser.parse_args()
    with arguments.names.open(encoding="utf-8-sig", newline="") as file:
        names = dict(csv.reader(file, delimiter=";"))
    failed = 0
    for path in sorted(arguments.folder.rglob("*.xml")):
        try:
            project = sfc.load(path)
            renamed = rename(project, names)
            if not renamed:
                continue
            for result in renamed:
                for undecided in result.undecided:
                    print(f"{path}: is this {result.path}? {undecided}", file=sys.stderr)
            if arguments.dry_run:
                show(path, sfc.dumps(project))
            else:
                sfc.save(project, path)
        except sfc.SfcError as error:
            print(error, file=sys.stderr)
            failed += 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
