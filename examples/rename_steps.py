"""Rename steps in all files of a folder, after a list of names.

python rename_steps.py NAMES.csv FOLDER [--dry-run]

NAMES.csv has lines OLD;NEW. With --dry-run the changes are shown as a diff and nothing is written. Names in program
text (`Step.t > T#5s`) are not changed; the script says where they occur.
"""

from __future__ import annotations

import argparse
import csv
import difflib
import re
import sys
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc.model import Expression, StBody


def mentions(project: sfc.Project, name: str) -> list[str]:
    """Program text in which `name` occurs."""
    word = re.compile(rf"\b{re.escape(name)}\b", re.IGNORECASE)
    texts = [body.text for _, _, body in project.bodies() if isinstance(body, StBody)]
    for _, _, chart in project.charts():
        texts += [t.condition.text for t in chart.transitions if isinstance(t.condition, Expression)]
    return [line.strip() for text in texts for line in text.splitlines() if word.search(line)]


def rename(project: sfc.Project, names: dict[str, str]) -> list[str]:
    """Rename the steps of every chart; returns the old names that occurred."""
    renamed = []
    for _, _, chart in project.charts():
        for old, new in names.items():
            if any(step.name == old for step in chart.steps):
                chart.rename_step(old, new)
                renamed.append(old)
    return renamed


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
            for old in renamed:
                for text in mentions(project, old):
                    print(f"{path}: {old} is still named in: {text}", file=sys.stderr)
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
