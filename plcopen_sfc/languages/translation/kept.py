"""The names that only SCL can write, kept with a project whose texts were translated from SCL."""

from __future__ import annotations

import json

from plcopen_sfc.languages.translation.renames import NameScope, Rename, Renames
from plcopen_sfc.model.base import Carried, ForeignData
from plcopen_sfc.model.project import Project

NAMES_DATA = "urn:plcopen-sfc:names"
"""The data of a project that keeps them."""


def keep_names(project: Project, renames: Renames) -> None:
    """Keep the renames with the project instead of those that it has kept before."""
    carried = project.carried or Carried()
    data = [one for one in carried.data if one.name != NAMES_DATA]
    if found := sorted((rename.scope.value, rename.old, rename.new) for rename in renames):
        text = json.dumps(found).replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
        data.append(ForeignData(name=NAMES_DATA, content=f'<names xmlns="{NAMES_DATA}">{text}</names>'))
    carried = carried.model_copy(update={"data": data})
    project.carried = carried if carried != Carried() else None


def kept_names(project: Project) -> Renames:
    """The renames that a project has kept since its texts were translated from SCL; none where they are damaged."""
    for data in project.carried.data if project.carried is not None else ():
        if data.name == NAMES_DATA:
            text = data.content.partition(">")[2].rpartition("</")[0]
            try:
                return Renames(Rename(NameScope(scope), old, new) for scope, old, new in json.loads(text))
            except (TypeError, ValueError):
                break
    return Renames()
