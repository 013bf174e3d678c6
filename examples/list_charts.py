"""List every chart in the files of a folder: where it stands, how large it is, what the reader found.

python list_charts.py FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

import plcopen_sfc as sfc


def main(folder: str) -> int:
    """List the charts; 1 where a file could not be read."""
    failed = 0
    for path in sorted(p for p in Path(folder).rglob("*") if p.suffix.lower() in (".xml", ".json")):
        try:
            project = sfc.load(path)
        except sfc.SfcError as error:
            print(error, file=sys.stderr)
            failed += 1
            continue
        for name, pou, chart in project.charts():
            sizes = f"{len(chart.steps)} steps, {len(chart.transitions)} transitions"
            print(f"{path}: {name} ({pou.kind}): {sizes}")
        for finding in project.diagnostics:
            print(f"  {finding}")
    return 1 if failed else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
