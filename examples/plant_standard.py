"""Bring charts to the standard of a plant: steps numbered by tens in their names, valves supervised.

Run it over exports, first without `--write`::

    plcopen-sfc apply examples/plant_standard.py "exports/*.xml" --set supervision=T#20s --diff changes.patch
"""

from __future__ import annotations

import plcopen_sfc as sfc


def refactor(project: sfc.Project, supervision: str = "T#30s") -> None:
    """Name steps ``S010_Fill`` in the order of the flow; supervise every step that drives a valve."""
    with project.edit() as edit:
        edit.renumber(10, 10, names="S{number:03}_{name}")
        edit.set(project.steps(drives="*Valve*"), max_time=supervision)
