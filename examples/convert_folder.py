"""Convert all files of a folder, with a report beside each.

python convert_folder.py SOURCE TARGET --to FORMAT [--strict | --partial]
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from pathlib import Path

import plcopen_sfc as sfc


def main() -> int:
    """Convert all files; 1 where one could not be converted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path)
    parser.add_argument("target", type=Path)
    parser.add_argument("--to", required=True, metavar="FORMAT")
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--strict", action="store_true", help="write no file that the target executes otherwise")
    how.add_argument("--partial", action="store_true", help="write also where the target does not execute all")
    arguments = parser.parse_args()
    arguments.target.mkdir(parents=True, exist_ok=True)
    failed = 0
    for path in sorted(arguments.source.glob("*.xml")):
        target = arguments.target / path.name
        try:
            project = sfc.load(path)
            strict, partial = arguments.strict, arguments.partial
            report = sfc.save(project, target, format=arguments.to, strict=strict, partial=partial)
        except sfc.SfcError as error:
            print(error, file=sys.stderr)
            failed += 1
            continue
        content = json.dumps(report.as_dict(), indent=1, ensure_ascii=False)
        target.with_suffix(".report.json").write_text(content, encoding="utf-8")
        outcomes = Counter(item.outcome for item in report.items)
        print(f"{path} -> {target}: " + ", ".join(f"{count} {outcome}" for outcome, count in sorted(outcomes.items())))
        for item in report.losses:
            print(f"  {item.outcome}: {item.what} {item.path}: {item.why}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
