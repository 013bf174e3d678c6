"""Validation of SimaticML. There is no schema of ours yet: what the reader finds is all that is checked."""

from __future__ import annotations

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.formats.simaticml.project_reader import find_version
from plcopen_sfc.formats.xml.source import parse

__all__ = ["validate"]


def validate(data: bytes, *, file: str | None = None) -> list[Diagnostic]:
    """Say that a document was not held against a schema (``XSD030``). Raises `FormatError` for what is no document."""
    version = find_version(parse(data, file=file), file=file)
    message = f"there is no schema of TIA Portal {version.name} here; checked is what the reader understands"
    return [Diagnostic("XSD030", Severity.INFO, message, Location(file))]
