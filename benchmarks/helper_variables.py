"""How many helper variables lowered code has for each step of its chart.

    python -m benchmarks.helper_variables [--to FORMAT] FILE...

Every chart of the files is lowered as `auto` chooses, without the proof. A helper is a variable that the code declares
and the chart did not have; constants are none. Steps of partial charts and macro-steps count too; a chart
that is refused is counted as such, a file that cannot be read is named.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc.errors import SfcError
from plcopen_sfc.model import Pou
from plcopen_sfc.semantics.net import Net


def helpers(before: Pou, after: Pou) -> list[str]:
    """Return the variables of `after` that `before` does not declare, without constants."""
    known = {variable.name.casefold() for variable in before.variables()}
    sections = after.interface.sections if after.interface is not None else []
    variables = (variable for section in sections if not section.constant for variable in section.variables)
    return [variable.name for variable in variables if variable.name.casefold() not in known]


def main() -> None:
    """Print a line for each chart, and their sum."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--to", default=None, help="format that the code is for")
    parser.add_argument("files", nargs="+", type=Path)
    arguments = parser.parse_args()
    all_helpers = all_steps = refused = 0
    for path in arguments.files:
        try:
            project = sfc.load(path)
        except SfcError as error:
            print(f"{path.name}: not read: {str(error).splitlines()[0]}")
            continue
        for pou in project.pous:
            if pou.chart is None:
                continue
            try:
                lowered = sfc.lower(project, pou=pou.name, target=arguments.to, verify=False)
            except SfcError as error:
                print(f"{path.name} {pou.name}: refused: {str(error).splitlines()[0]}")
                refused += 1
                continue
            count, steps = len(helpers(pou, lowered.pou)), len(Net.of(pou.chart).steps)
            all_helpers, all_steps = all_helpers + count, all_steps + steps
            name = f"{path.name} {pou.name} ({lowered.construction})"
            print(f"{name:60} {count:4} helpers, {steps:4} steps: {count / max(steps, 1):.2f}")
    print(f"{all_helpers} helpers, {all_steps} steps: {all_helpers / max(all_steps, 1):.2f}; {refused} charts refused")


if __name__ == "__main__":
    main()
