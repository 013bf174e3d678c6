"""Validation of PLCopen XML as CODESYS V3 and TwinCAT 3 write it, foreign data included.

These tools keep whole POUs, data types and variable lists in `addData`, where the schema of TC6 lets anything pass;
exports of TwinCAT hold nothing else. Here they are checked in their place, as if they were in `types/pous`.

Codes: those of `plcopen_sfc.formats.plcopen.tc6_versions`, and

======  ==============================================================
XSD020  foreign data without the content that its name promises
XSD021  an attribute of a chart element that is not known
XSD022  the value of an attribute of a chart element is none it can have
======  ==============================================================
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.formats.codesys import codesys_names as names
from plcopen_sfc.formats.plcopen.tc6_versions import tc6_version
from plcopen_sfc.formats.xml.schema_validation import MAX_FINDINGS, element_path, schema_findings
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse_xml

if TYPE_CHECKING:
    from collections.abc import Iterator


_OF_TC6 = {"application": "resource", "pou": "pou", "datatype": "dataType", "globalvars": "globalVars"}
_OF_VENDOR = {
    "sfc/element": "attributes",
    "sfcsettings": "SFCSettings",
    "interfaceasplaintext": "InterfaceAsPlainText",
    "objectid": "ObjectId",
    "projectstructure": "ProjectStructure",
    "projectinformation": "ProjectInformation",
    "libraries": "Libraries",
    "attributes": "Attributes",
    "buildproperties": "BuildProperties",
    "tasksettings": "TaskSettings",
    "method": "Method",
    "property": "Property",
    "fbd/implementationattributes": "fbdattributes",
    "fbdcalltype": "CallType",
    "fbdelementtype": "ElementType",
    "inputparamtypes": "InputParamTypes",
    "outputparamtypes": "OutputParamTypes",
    "ldbranchid": "BranchId",
    "stcode": "STCode",
}
_PAYLOADS = {names.PREFIX + key: tag for key, tag in (_OF_TC6 | _OF_VENDOR).items()}
# Where TC6's own grammar begins again inside of foreign data.
_TC6_AGAIN = frozenset(_OF_TC6.values()) | {"interface", "body", "addData"}

_ANY_TEXT = re.compile(r"[\s\S]*")
_SWITCH = re.compile(r"TRUE|FALSE", re.IGNORECASE)
_VALUES = {
    names.NAME: (_ANY_TEXT, ""),
    names.COMMENT: (_ANY_TEXT, ""),
    names.EXCLUDE: (_SWITCH, "TRUE or FALSE"),
    names.SYMBOL: (re.compile("[0-4]"), "0 (unspecified), 1 (none), 2 (read), 3 (write) or 4 (read and write)"),
    names.INITIAL: (_SWITCH, "TRUE or FALSE"),
    names.DUPLICATION: (_SWITCH, "TRUE or FALSE"),
    names.MIN_TIME: (_ANY_TEXT, ""),
    names.MAX_TIME: (_ANY_TEXT, ""),
    names.MAIN_ACTION: (_ANY_TEXT, ""),
    names.ENTRY_ACTION: (_ANY_TEXT, ""),
    names.EXIT_ACTION: (_ANY_TEXT, ""),
    names.QUALIFIER: (
        re.compile(r"(?:N|R|S|L|D|P|P0|P1|SD|DS|SL|DL)(?:\s.*)?", re.DOTALL),
        "a qualifier (N, R, S, L, D, P, P0, P1, SD, DS, SL, DL), with a time behind a blank where it needs one",
    ),
    names.PARALLEL: (_SWITCH, "TRUE or FALSE"),
    names.MONITORING: (re.compile("[0-2]"), "0 (none), 1 (variable) or 2 (call)"),
}


def validate_codesys(data: bytes, *, file: str | None = None) -> list[Diagnostic]:
    """Return the errors of a PLCopen XML file of CODESYS or TwinCAT, foreign data included; empty for a valid one.

    Deviations from TC6 are errors, in hidden POUs as well. Deviations in the vendor's own elements are warnings: there
    is no published schema of them, and newer versions of the tools may write more than is known here.

    Raises `XmlSyntaxError`, `EncodingError` or `UnsafeXmlError` for what is not well-formed XML, or not safe to read.
    """
    root = parse_xml(data, file=file)
    version = tc6_version(root, file)
    if isinstance(version, Diagnostic):
        return [version]
    if version.first_generation:  # has no foreign data
        return schema_findings(root, f"plcopen-{version.name}", data=data, file=file)
    found = schema_findings(root, f"codesys-{version.name}", data=data, file=file, judge=_judge)
    lines = SourceLines(root, data)
    for number, (element, code, severity, message) in enumerate(_payload_findings(root, version.namespace)):
        if number == MAX_FINDINGS:
            cut_off = "more faulty foreign data is not listed; repair this first"
            found.append(Diagnostic("XSD099", Severity.INFO, cut_off, Location(file)))
            break
        place = Location(file, lines.line(element), path=element_path(element))
        found.append(Diagnostic(code, severity, message, place))
    # Findings about the whole file come last.
    found.sort(key=lambda finding: (finding.location.line is None, finding.location.line or 0))
    return found


def _judge(element: etree._Element) -> Severity:
    """Return an error, unless the element belongs to the vendor and not to TC6, as the description of a device does."""
    node: etree._Element | None = element
    while node is not None:
        local = etree.QName(node).localname if isinstance(node.tag, str) else ""
        parent = node.getparent()
        in_data = parent is not None and isinstance(parent.tag, str) and etree.QName(parent).localname == "data"
        if in_data:
            return Severity.ERROR if local in _OF_TC6.values() else Severity.WARNING
        if local in _TC6_AGAIN:
            return Severity.ERROR
        node = parent
    return Severity.ERROR


_Finding = tuple[etree._Element, str, Severity, str]


def _payload_findings(root: etree._Element, namespace: str) -> Iterator[_Finding]:
    for data in root.iter(f"{{{namespace}}}data"):
        name = data.get("name")
        wanted = _PAYLOADS.get(name or "")
        if wanted is None or len(data) == 0:
            continue
        payload = data[0]
        if payload.tag == wanted and wanted == "attributes":
            yield from _attribute_findings(payload, "attribute")
        elif payload.tag not in {wanted, f"{{{namespace}}}{wanted}"}:
            if isinstance(payload.tag, str):
                yield payload, "XSD020", *_wrong_payload(payload, str(name), wanted)
        elif wanted == "attributes":
            yield from _attribute_findings(payload, f"{{{namespace}}}attribute")
        elif payload.tag == wanted and wanted in _OF_TC6.values():
            message = f"<{wanted}> of {name} is in no namespace and will not be found; it belongs into {namespace}"
            yield payload, "XSD020", Severity.ERROR, message


def _wrong_payload(payload: etree._Element, name: str, wanted: str) -> tuple[Severity, str]:
    severity = Severity.ERROR if wanted in _OF_TC6.values() else Severity.WARNING
    return severity, f"data of the name {name} must hold <{wanted}>, not <{etree.QName(payload).localname}>"


def _attribute_findings(payload: etree._Element, tag: str) -> Iterator[_Finding]:
    for attribute in payload.iterchildren(tag):
        guid = attribute.get("guid")
        if guid is None or guid in _FREE:
            continue  # the schema speaks for the first, and of the second every text will do
        # Blanks around the value are of no meaning: files that were indented by another program have them.
        objection = _objection(guid, (attribute.text or "").strip())
        if objection is not None:
            yield attribute, objection[0], Severity.WARNING, objection[1]


_FREE = frozenset(guid for guid, (pattern, _) in _VALUES.items() if pattern is _ANY_TEXT)


@lru_cache(maxsize=1024)
def _objection(guid: str, text: str) -> tuple[str, str] | None:
    """Return the error of an attribute of the SFC editor: code and message. The same few occur thousands of times."""
    rule = _VALUES.get(guid) or _VALUES.get(guid.lower())
    if rule is None:
        return "XSD021", f"the attribute {guid} is not known; it may be of a newer version, and is kept as it is"
    pattern, wanted = rule
    if pattern is _ANY_TEXT or pattern.fullmatch(text):
        return None
    return "XSD022", f'the value "{text}" of this attribute must be {wanted}'
