"""Versions of TC6 XML, how their grammars differ, and validation against the package's schemas of them.

Sources: the TC6 XML papers V1.01 and V2.01 and files of tools. 1.0 and 1.01 share a namespace, 2.0 and 2.01 differ in
theirs only.

Codes: ``XSD001`` no TC6 XML or an unknown version of it; ``XSD002`` to ``XSD019`` as in
`plcopen_sfc.formats.xml.schema_explanation`; ``XSD099`` that the list was cut off.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from functools import cached_property
from typing import cast

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location, StructureError, UnknownVersionError
from plcopen_sfc.formats.xml.schema_validation import element_path, schema_findings
from plcopen_sfc.formats.xml.xml_parsing import parse_xml

XHTML = "http://www.w3.org/1999/xhtml"
PREFIX = "http://www.plcopen.org/xml/tc6"


@dataclass(frozen=True)
class Tc6Version:
    """One version of TC6 XML."""

    name: str
    namespace: str

    @cached_property
    def first_generation(self) -> bool:
        """True if this is the grammar of 1.0 and 1.01: no foreign data, one body per POU, no ids at actions."""
        return self.namespace == f"{PREFIX}.xsd"

    @cached_property
    def elements(self) -> frozenset[str]:
        """The names of all elements of this version; of the first generation without the generic types."""
        return frozenset(e for e in ELEMENTS if not (self.first_generation and e.startswith("ANY")))

    @cached_property
    def tags(self) -> dict[str, str]:
        """Qualified names of all elements of TC6, mapped to their local names: the readers' dispatch table."""
        return {f"{{{self.namespace}}}{name}": name for name in ELEMENTS}

    @cached_property
    def qualified(self) -> dict[str, str]:
        """The reverse of `tags`."""
        return {name: tag for tag, name in self.tags.items()}


V1_01 = Tc6Version("1.01", f"{PREFIX}.xsd")
V2_0 = Tc6Version("2.0", f"{PREFIX}_0200")
V2_01 = Tc6Version("2.01", f"{PREFIX}_0201")
VERSIONS = (V1_01, V2_0, V2_01)


def version_of(namespace: str) -> Tc6Version | None:
    """Return the version with this namespace."""
    return next((version for version in VERSIONS if version.namespace == namespace), None)


def version_named(name: str) -> Tc6Version | None:
    """Return the version of this name; 1.0 is written as 1.01."""
    return next((version for version in VERSIONS if version.name == ("1.01" if name == "1.0" else name)), None)


ELEMENTS = frozenset(
    """
    project fileHeader contentHeader Comment coordinateInfo pageSize fbd ld sfc scaling addDataInfo info description
    types dataTypes dataType baseType initialValue pous pou interface returnType localVars tempVars inputVars outputVars
    inOutVars externalVars globalVars accessVars configVars actions action transitions transition body instances
    configurations configuration resource task pouInstance addData data documentation simpleValue arrayValue structValue
    value IL ST FBD LD SFC variable type accessVariable configVariable position connection connectionPointIn
    connectionPointOut connectionPointOutAction relPosition expression array dimension derived enum values struct
    subrangeSigned subrangeUnsigned range pointer string wstring comment content error connector continuation
    actionBlock reference inline vendorElement alternativeText inputVariables inOutVariables outputVariables block
    inVariable outVariable inOutVariable label jump return leftPowerRail rightPowerRail coil contact step macroStep
    jumpStep condition selectionDivergence selectionConvergence simultaneousDivergence simultaneousConvergence
    BOOL BYTE WORD DWORD LWORD SINT INT DINT LINT USINT UINT UDINT ULINT REAL LREAL TIME DATE DT TOD ANY ANY_DERIVED
    ANY_ELEMENTARY ANY_MAGNITUDE ANY_NUM ANY_REAL ANY_INT ANY_BIT ANY_STRING ANY_DATE
    """.split()
)
"""All element names of TC6 2.01; 1.01 uses a subset."""

NO_TIME = "1970-01-01T00:00:00"
"""Time of files whose model has none: the schema wants one."""


def find_version(root: etree._Element, *, file: str | None = None) -> Tc6Version:
    """Return the TC6 version of a document. Raises `StructureError` and `UnknownVersionError`."""
    name = etree.QName(root)
    place = Location(file, cast("int | None", root.sourceline), None, f"/{name.localname}")
    version = version_of(name.namespace or "")
    if version is None:
        if (name.namespace or "").startswith(PREFIX):
            known = ", ".join(v.namespace for v in VERSIONS)
            raise UnknownVersionError(
                f"PLCopen XML in the unknown namespace {name.namespace!r}", location=place, hint=f"Known are: {known}"
            )
        raise StructureError(
            f"this is not PLCopen XML: the root element is <{name.localname}>"
            + (f" in the namespace {name.namespace!r}" if name.namespace else ""),
            location=place,
            hint="PLCopen XML starts with <project> in a namespace such as http://www.plcopen.org/xml/tc6_0201.",
        )
    if name.localname != "project":
        raise StructureError(
            f"the root element is <{name.localname}>, not <project>",
            location=place,
            hint="This may be a part of a PLCopen XML file; load the whole file.",
        )
    return version


_IEC_61131_10 = "www.iec.ch/public/TC65SC65BWG7TF10"


def validate_tc6(data: bytes, *, file: str | None = None) -> list[Diagnostic]:
    """Return the errors of a TC6 XML file by the schema of its version; empty for a valid one.

    The version is that of the namespace of the root element. As in the schema, foreign data
    (`addData`) are not looked at: for files of CODESYS or TwinCAT use `codesys_codec.validate_codesys`.
    A valid file may still be wrong in ways that no schema sees, such as a wire to an object that does not exist.

    Raises `XmlSyntaxError`, `EncodingError` or `UnsafeXmlError` for what is not well-formed XML, or not safe to read.
    """
    root = parse_xml(data, file=file)
    version = tc6_version(root, file)
    if isinstance(version, Diagnostic):
        return [version]
    return schema_findings(root, f"plcopen-{version.name}", data=data, file=file)


def tc6_version(root: etree._Element, file: str | None = None) -> Tc6Version | Diagnostic:
    """Return the version of TC6 XML of a document, or the finding ``XSD001`` if it has no known one."""
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
        message = f"<project> is {found}; TC6 XML has one of {known}"
    else:
        message = f"this is no TC6 XML: it begins with <{name.localname}>, not with <project>"
    place = Location(file, cast("int | None", root.sourceline), path=element_path(root))
    return Diagnostic("XSD001", Severity.ERROR, message, place)
