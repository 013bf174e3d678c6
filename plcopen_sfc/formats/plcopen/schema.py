"""Validation of PLCopen TC6 XML against our own schemas of its versions.

Codes: ``XSD001`` no TC6 XML or no version of it that we know; ``XSD002`` to ``XSD019`` as in
`plcopen_sfc.formats.xml.schema_explanation`; ``XSD099`` that the list was cut off.
"""

from __future__ import annotations

import difflib
from typing import cast

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.formats.plcopen.versions import PREFIX, VERSIONS, Tc6Version, version_of
from plcopen_sfc.formats.xml.schema_validation import element_path, findings
from plcopen_sfc.formats.xml.xml_parsing import parse

__all__ = ["tc6_version", "validate"]

_IEC_61131_10 = "www.iec.ch/public/TC65SC65BWG7TF10"


def validate(data: bytes, *, file: str | None = None) -> list[Diagnostic]:
    """What is wrong with a TC6 XML file by the schema of its version; empty for a valid one.

    The version is that of the namespace of the root element. As the schema wants it, what stands in foreign data
    (`addData`) is not looked at: for files of CODESYS or TwinCAT use `plcopen_sfc.formats.codesys.schema.validate`.
    A valid file may still be wrong in ways that no schema sees, such as a wire to an object that does not exist.

    Raises `XmlSyntaxError`, `EncodingError` or `UnsafeXmlError` for what is not well-formed XML, or not safe to read.
    """
    root = parse(data, file=file)
    version = tc6_version(root, file)
    if isinstance(version, Diagnostic):
        return [version]
    return findings(root, f"plcopen-{version.name}", data=data, file=file)


def tc6_version(root: etree._Element, file: str | None = None) -> Tc6Version | Diagnostic:
    """The version of TC6 XML of a document, or what there is to say (``XSD001``) if it has none that we know."""
    name = etree.QName(root)
    namespace = name.namespace or ""
    version = version_of(namespace)
    if version is not None and name.localname == "project":
        return version
    known = ", ".join(f"{each.namespace} ({each.name})" for each in VERSIONS)
    if version is not None:
        message = f"a file of TC6 XML begins with <project>, not with <{name.localname}>"
    elif namespace.startswith(_IEC_61131_10):
        message = "this is XML of IEC 61131-10, the successor of TC6 XML, which is another format"
    elif namespace.startswith(PREFIX):
        near = difflib.get_close_matches(namespace, [each.namespace for each in VERSIONS], n=1)
        message = f"the version of TC6 XML with the namespace {namespace} is not known; known are {known}"
        message += f". If it is one of these, correct xmlns to {near[0]}" if near else ""
    elif name.localname == "project":
        found = f"in the namespace {namespace}" if namespace else "in no namespace"
        message = f"<project> stands {found}; TC6 XML has one of {known}"
    else:
        message = f"this is no TC6 XML: it begins with <{name.localname}>, not with <project>"
    place = Location(file, cast("int | None", root.sourceline), path=element_path(root))
    return Diagnostic("XSD001", Severity.ERROR, message, place)
