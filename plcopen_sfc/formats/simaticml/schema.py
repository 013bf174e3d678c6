"""Validation of documents of TIA Portal Openness against our own schemas: the frame, and each part by its namespace.

Codes: those of `plcopen_sfc.formats.xml.schema_explanation`, and

======  ==============================================================
XSD001  no document of Openness, or of a version that is not known
XSD031  a part in no namespace, or in one that is not known
XSD032  a part of a schema version that this TIA Portal does not have
======  ==============================================================
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import FormatError, Location
from plcopen_sfc.formats.simaticml.project_reader import find_version
from plcopen_sfc.formats.simaticml.versions import (
    LANGUAGES,
    SCHEMAS,
    TiaVersion,
    first_with,
    namespace,
    schema_of,
    version_named,
)
from plcopen_sfc.formats.xml.schema_validation import MAX_FINDINGS, element_path, findings
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse

__all__ = ["validate"]

_FRAME = "simaticml/document"
_ROOTS = {"Sections": "Interface", **{language: language for language in LANGUAGES}}
_HOLDERS = ("Interface", "NetworkSource")


def validate(data: bytes, *, file: str | None = None) -> list[Diagnostic]:
    """What is wrong with a document by the schemas of its parts; empty for a valid one.

    Attributes and objects that are not known are warnings: of the frame of a document there is no published schema, and
    newer versions may write more. A valid document may still be wrong in ways that no schema sees, such as a wire to a
    part that does not exist.

    Raises `XmlSyntaxError`, `EncodingError` or `UnsafeXmlError` for what is not well-formed XML, or not safe to read.
    """
    root = parse(data, file=file)
    try:
        version = find_version(root, file=file)
    except FormatError as error:
        message = error.message if not error.hint else f"{error.message}. {error.hint}"
        return [Diagnostic("XSD001", Severity.ERROR, message, error.location)]
    found = [_lenient(finding) for finding in findings(root, _FRAME, data=data, file=file)]
    lines = SourceLines(root, data)
    for part in _parts(root):
        if len(found) > MAX_FINDINGS:
            break
        name = etree.QName(part)
        known = schema_of(name.namespace or "")
        place = Location(file, lines.line(part), path=element_path(part))
        if known is None or _ROOTS.get(name.localname) != known[0] or known[1] not in SCHEMAS[known[0]]:
            found.append(_unknown(part, version, place))
            continue
        kind, number = known
        if number > version.schema(kind) and _says_its_version(root):
            found.append(_too_new(kind, number, version, place))
        found += findings(part, f"simaticml/{kind}-v{number}", data=data, file=file)
    found.sort(key=lambda finding: (finding.location.line is None, finding.location.line or 0))
    return found


def _says_its_version(root: etree._Element) -> bool:
    engineering = root.find("Engineering")
    return engineering is not None and version_named(engineering.get("version", "")) is not None


def _parts(root: etree._Element) -> Iterator[etree._Element]:
    """What stands in interfaces and network sources."""
    for holder in root.iter(*_HOLDERS):
        yield from holder.iterchildren(etree.Element)


def _unknown(part: etree._Element, version: TiaVersion, place: Location) -> Diagnostic:
    """A part that has no schema: misspelled, in no namespace, or newer than anything known."""
    name = etree.QName(part)
    kind = _ROOTS.get(name.localname)
    if kind is None:
        message = f"<{name.localname}> in {name.namespace or 'no namespace'} is held against no schema"
        return Diagnostic("XSD031", Severity.INFO, message, place)
    wanted = namespace(kind, version.schema(kind))
    message = f"<{name.localname}> stands in {name.namespace or 'no namespace'}; TIA Portal {version.name} has {wanted}"
    return Diagnostic("XSD031", Severity.ERROR, message, place)


def _too_new(kind: str, number: int, version: TiaVersion, place: Location) -> Diagnostic:
    first = first_with(kind, number)
    since = f", which came with {first.name}" if first is not None else ""
    own = version.schema(kind)
    message = f"this is of schema {kind} v{number}{since}; TIA Portal {version.name} has " + (
        f"v{own}" if own else "none"
    )
    return Diagnostic("XSD032", Severity.ERROR, message, place)


def _lenient(finding: Diagnostic) -> Diagnostic:
    """A warning for an attribute or object that is not known: other versions than those seen may have it."""
    holder, _, name = (finding.location.path or "").rpartition("/")
    unknown = holder.endswith("/AttributeList") and "[" not in name
    unknown = unknown or (holder.endswith("/ObjectList") and name.partition("[")[0].startswith("SW."))
    return replace(finding, severity=Severity.WARNING) if unknown and finding.code == "XSD002" else finding
