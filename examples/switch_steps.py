"""Switch the charts of CoDeSys 2.3 between simple steps and IEC steps.

plcopen-sfc apply switch_steps.py FOLDER --set kind=iec --prove --diff changes.patch

`kind` is ``iec`` or ``simple``. IEC steps execute an action once more when they were left: ``--set guarded=true`` lets
the code ask for its step first. With --prove a file stays as it is where a chart would do something else.
"""

from __future__ import annotations

import plcopen_sfc as sfc


def refactor(project: sfc.Project, kind: str = "iec", guarded: bool = False) -> None:
    """Switch every chart that is of the other kind."""
    editor = project.edit(clean=True)
    for _, _, chart in project.charts():
        if kind == "iec" and any(step.main_action is not None for step in chart.steps):
            editor.use_iec_steps(chart, guarded=guarded)
        elif kind == "simple" and any(chart.associations()):
            editor.use_simple_steps(chart)
