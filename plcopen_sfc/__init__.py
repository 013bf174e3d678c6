"""Sequential function charts (IEC 61131-3 SFC, GRAFCET, S7-GRAPH): one typed model, lossless files.

import plcopen_sfc as sfc

project = sfc.load("line24.xml")
project.pou("Main").chart.rename_step("S3", "Wait")
sfc.save(project, "line24.xml")

``dir(sfc)`` lists the public names; all classes of the model are in `plcopen_sfc.model`.
"""

from __future__ import annotations

from functools import cache, partial
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
    if name.startswith("_") or name not in _exports():
        from plcopen_sfc.errors import nearest  # noqa: PLC0415

        near = "" if name.startswith("_") else nearest(name, _exports())  # introspection asks for such names, often
        raise AttributeError(f"module 'plcopen_sfc' has no attribute {name!r}{near}")
    return getattr(import_module(_exports()[name]), name)


def __dir__() -> list[str]:
    return sorted(_exports())


_PROVIDERS = {
    "rename": "refactor.rename",
    "rename_many": "refactor.rename",
    "rename_step": "refactor.rename",
    "find_steps": "refactor.queries",
    "find_transitions": "refactor.queries",
    "where": "refactor.queries",
    "find_declared": "refactor.queries",
    "find_uses": "languages.binding",
    "cross_references": "refactor.queries",
    "edit": "refactor.editor",
    "diff": "comparison",
    "default_profile": "semantics.profile",
    "add_sequence": "refactor.builder",
    "declare_named": "refactor.builder",
    "chart_records": "refactor.queries",
    "locations_of": "documents.sources",
    "chart_svg": "drawing.pictures",
    "body_svg": "drawing.pictures",
    "trace_svg": "pages.timing_diagram",
    "project_table": "pages.project_page",
    "pou_table": "pages.project_page",
}
"""The modules of the operations that the model offers: they bring the parser or the formats with them."""


def _operation(name: str) -> Operation:
    operation: Operation = getattr(import_module(f"{__name__}.{_PROVIDERS[name]}"), name)
    return operation


for _name in _PROVIDERS:
    provide(_name, partial(_operation, _name))
