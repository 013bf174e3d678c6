"""Sequential function charts (IEC 61131-3 SFC, GRAFCET, S7-GRAPH): one typed model, lossless files.

import plcopen_sfc as sfc

project = sfc.load("line24.xml")
project.pou("Main").chart.rename_step("S3", "Wait")
sfc.save(project, "line24.xml")

``dir(sfc)`` lists the public names; all classes of the model are in `plcopen_sfc.model`.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module, resources
from typing import Any

from plcopen_sfc.operations import Operation, provide
from plcopen_sfc.version import __version__ as __version__


@cache
def _exports() -> dict[str, str]:
    """Return the modules of all public names, by the names: ``__init__.pyi`` has the list."""
    import ast  # noqa: PLC0415  # the version and the command line need no names

    listed = ast.parse(resources.files(__name__).joinpath("__init__.pyi").read_text(encoding="utf-8"))
    imports = [node for node in listed.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: str(node.module) for node in imports for alias in node.names}


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for: the version and the errors cost no model."""
    if name == "__all__":
        return __dir__()
    if name.startswith("__") or name not in _exports():
        from plcopen_sfc.errors import nearest  # noqa: PLC0415

        raise AttributeError(f"module 'plcopen_sfc' has no attribute {name!r}{nearest(name, _exports())}")
    return getattr(import_module(_exports()[name]), name)


def __dir__() -> list[str]:
    return sorted(_exports())


def _rename() -> Operation:
    from plcopen_sfc.refactor.rename import rename  # noqa: PLC0415  # brings the parser with it

    return rename


def _rename_many() -> Operation:
    from plcopen_sfc.refactor.rename import rename_many  # noqa: PLC0415

    return rename_many


def _rename_step() -> Operation:
    from plcopen_sfc.refactor.rename import rename_step  # noqa: PLC0415

    return rename_step


def _locations_of() -> Operation:
    from plcopen_sfc.documents.sources import locations_of  # noqa: PLC0415  # brings the formats with it

    return locations_of


def _to_svg() -> Operation:
    from plcopen_sfc.drawing.pictures import chart_svg  # noqa: PLC0415  # brings the parser with it

    return chart_svg


def _body_svg() -> Operation:
    from plcopen_sfc.drawing.pictures import body_svg  # noqa: PLC0415

    return body_svg


def _trace_svg() -> Operation:
    from plcopen_sfc.pages.timing_diagram import trace_svg  # noqa: PLC0415

    return trace_svg


provide("rename", _rename)
provide("rename_many", _rename_many)
provide("rename_step", _rename_step)
provide("locations_of", _locations_of)
provide("to_svg", _to_svg)
provide("body_svg", _body_svg)
provide("trace_svg", _trace_svg)
