"""Sequential function charts (IEC 61131-3 SFC, GRAFCET, S7-GRAPH): one typed model, lossless files.

import plcopen_sfc as sfc

project = sfc.load("line24.xml")
project.pou("Main").chart.rename_step("S3", "Wait")
sfc.save(project, "line24.xml")
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from plcopen_sfc.version import __version__

if TYPE_CHECKING:
    from plcopen_sfc.api import check_syntax, convert, dumps, load, loads, save
    from plcopen_sfc.checking import check
    from plcopen_sfc.diagnostics import Diagnostic, Severity
    from plcopen_sfc.documents.lowered import LoweredFile, lower_to_file
    from plcopen_sfc.errors import FormatError, Location, LossError, ModelError, OldVersionError, SfcError
    from plcopen_sfc.lowering.lower import LoweredPou, lower
    from plcopen_sfc.model import Project, SfcNetwork, Step, Transition
    from plcopen_sfc.report import ConversionReport, Outcome
    from plcopen_sfc.semantics.inputs import RandomInputs
    from plcopen_sfc.semantics.simulation import simulate
    from plcopen_sfc.semantics.trace import Trace

_HOMES = {
    "check": "checking",
    "check_syntax": "api",
    "convert": "api",
    "dumps": "api",
    "load": "api",
    "loads": "api",
    "save": "api",
    "Diagnostic": "diagnostics",
    "Severity": "diagnostics",
    "FormatError": "errors",
    "Location": "errors",
    "LossError": "errors",
    "ModelError": "errors",
    "OldVersionError": "errors",
    "SfcError": "errors",
    "LoweredFile": "documents.lowered",
    "LoweredPou": "lowering.lower",
    "lower": "lowering.lower",
    "lower_to_file": "documents.lowered",
    "Project": "model",
    "SfcNetwork": "model",
    "Step": "model",
    "Transition": "model",
    "ConversionReport": "report",
    "Outcome": "report",
    "RandomInputs": "semantics.inputs",
    "simulate": "semantics.simulation",
    "Trace": "semantics.trace",
}

__all__ = [
    "ConversionReport",
    "Diagnostic",
    "FormatError",
    "Location",
    "LossError",
    "LoweredFile",
    "LoweredPou",
    "ModelError",
    "OldVersionError",
    "Outcome",
    "Project",
    "RandomInputs",
    "Severity",
    "SfcError",
    "SfcNetwork",
    "Step",
    "Trace",
    "Transition",
    "__version__",
    "check",
    "check_syntax",
    "convert",
    "dumps",
    "load",
    "loads",
    "lower",
    "lower_to_file",
    "save",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for: the version and the errors cost no model."""
    if name not in _HOMES:
        raise AttributeError(f"module 'plcopen_sfc' has no attribute {name!r}")
    return getattr(import_module(f"plcopen_sfc.{_HOMES[name]}"), name)
