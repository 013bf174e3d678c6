"""Build a filling station as a chart, and write it for several tools.

python build_chart.py FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc import jump, selection, simultaneous, step


def filling_station() -> sfc.Project:
    """Return a project with one program."""
    project = sfc.Project(name="Filling")
    program = project.add_program(
        "Main",
        step("Wait", initial=True, actions=["N Ready"]),
        "Start AND NOT Fault",
        step("Fill", actions=["N InletValve", "D T#2s Lamp"], max_time="T#30s"),
        selection(
            [
                "Level > 80",
                simultaneous([step("Heat", actions=["N Heater"])], [step("Mix", actions=["N Mixer"])]),
                "Hot",
            ],
            ["Fault"],
        ),
        step("Drain", actions=["N OutletValve", ("P1 Count", "Batches := Batches + 1;")]),
        "Level = 0",
        jump("Wait"),
    )
    program.add_variable("Level", "INT", "input")
    program.add_variable("Batches", "INT")
    return project


def main(folder: str) -> None:
    """Write the project as TC6 XML, for CODESYS and as text."""
    project = filling_station()
    for name, extension in (("plcopen", "xml"), ("codesys", "xml"), ("iec-text", "st")):
        report = sfc.save(project, Path(folder, f"filling_{name}.{extension}"), format=name, partial=True)
        print(*report.written, f"{len(report.losses)} losses")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
