"""CODESYS and TwinCAT PLCopenXML in the table of formats: TC6 2.0 and the data of these tools.

Exports may hold a declaration twice, as elements and as the text that was typed. After an edit of the elements the text
would contradict them, so it is left out; the tools then build it again from the elements.

Validation includes this data. These tools keep whole POUs, data types and variable lists in `addData`, where the schema
of TC6 lets anything pass; exports of TwinCAT hold nothing else. Here they are checked in their place, as if they were
in `types/pous`.

Codes: those of `plcopen_sfc.formats.plcopen.tc6_versions`, and

======  ==============================================================
XSD020  foreign data without the content that its name promises
XSD021  an attribute of a chart element that is not known
XSD022  the value of an attribute of a chart element is none it can have
======  ==============================================================
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.formats.codesys import codesys_names as names
from plcopen_sfc.formats.codesys.declaration_texts import declaration_texts
from plcopen_sfc.formats.codesys.element_data import (
    CALLS,
    STEP_TEXTS,
    finish_chart,
    read_element_attributes,
    read_fbd_attributes,
    read_settings,
    text_reader,
)
from plcopen_sfc.formats.codesys.object_data import (
    mark_as_codesys,
    read_application,
    read_attributes,
    read_declaration,
    read_global_variables,
    read_hidden_data_type,
    read_hidden_pou,
    read_inheritance,
    read_method,
    read_mixed_list,
    read_object_id,
    read_project_structure,
    read_task_settings,
    write_data,
)
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.plcopen.tc6_codec import Tc6Codec, load_tc6, write_project
from plcopen_sfc.formats.plcopen.tc6_reading import DataReader, ToolData
from plcopen_sfc.formats.plcopen.tc6_versions import V2_0, V2_01, tc6_version
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6Dialect
from plcopen_sfc.formats.xml.schema_validation import MAX_FINDINGS, element_path, schema_findings
from plcopen_sfc.formats.xml.xml_codec import XmlStyle
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse_xml
from plcopen_sfc.languages.declarations.kept_texts import KEPT_DATA
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport

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


DATA_READERS: dict[str, DataReader] = {
    names.SFC_ELEMENT: read_element_attributes,
    names.SFC_SETTINGS: read_settings,
    names.PLAIN_TEXT: read_declaration,
    names.ATTRIBUTES: read_attributes,
    names.OBJECT_ID: read_object_id,
    names.POU: read_hidden_pou,
    names.DATA_TYPE: read_hidden_data_type,
    names.APPLICATION: read_application,
    names.GLOBAL_VARS: read_global_variables,
    names.MIXED_LIST: read_mixed_list,
    names.METHOD: read_method,
    names.POU_INHERITANCE: read_inheritance,
    names.TYPE_INHERITANCE: read_inheritance,
    names.PROJECT_STRUCTURE: read_project_structure,
    names.TASK_SETTINGS: read_task_settings,
    names.CALL_TYPE: text_reader("CallType", "block", "call", CALLS),
    names.ST_CODE: text_reader("STCode", "block", "code"),
    names.ELEMENT_TYPE: text_reader("ElementType", "vendorElement", "element_type"),
    names.FBD_ATTRIBUTES: read_fbd_attributes,
}
"""The reader of each kind of data."""
_TOOL_DATA = ToolData(DATA_READERS, finish_chart, text_element=names.XHTML_CHILD, placeless=True)


NATIVE_FIELDS = {
    "project": frozenset({"applications", "tree", "global_variables"}),
    "resource": frozenset({"object_id", "place"}),
    "configuration": frozenset({"object_id"}),
    "task": frozenset({"settings", "object_id"}),
    "pou": frozenset({"object_id", "methods"}),
    "interface": frozenset({"declaration"}),
    "action": frozenset({"object_id", "exclude", "symbol", "comment"}),
    "action_object": frozenset({"object_id"}),
    "transition_object": frozenset({"object_id"}),
    "method": frozenset({"object_id"}),
    "dataType": frozenset({"object_id", "declaration", "place"}),
    "globalVars": frozenset({"object_id", "declaration"}),
    "chart": frozenset({"settings"}),
    "step": frozenset({"exclude", "symbol", "duplicate", "comment", *STEP_TEXTS.values()}),
    "transition": frozenset({"exclude", "symbol", "duplicate", "monitoring", "comment"}),
    "selectionDivergence": frozenset({"exclude", "name", "comment"}),
    "simultaneousDivergence": frozenset({"exclude", "name", "comment"}),
    "jumpStep": frozenset({"exclude", "comment"}),
    "block": frozenset({"call", "code"}),
    "vendorElement": frozenset({"element_type", "attributes"}),
}
"""The fields that this module writes, by the kind of their owner."""

_INHERITANCE = frozenset({names.POU_INHERITANCE, names.TYPE_INHERITANCE})
NATIVE_TEXTS = {"extends": _INHERITANCE, "implements": _INHERITANCE, "pragmas": frozenset({names.ATTRIBUTES})}
"""The texts kept of declarations that this module writes, by the names of the data with them."""

DATA_RANK = {
    KEPT_DATA: 1,
    names.ATTRIBUTES: 2,
    names.POU_INHERITANCE: 5,
    names.TYPE_INHERITANCE: 5,
    names.DATA_TYPE: 5,
    names.POU: 6,
    names.METHOD: 7,
    names.SFC_SETTINGS: 10,
    names.TASK_SETTINGS: 10,
    names.APPLICATION: 10,
    names.GLOBAL_VARS: 10,
    names.CALL_TYPE: 10,
    names.ST_CODE: 60,
    names.PLAIN_TEXT: 60,
    names.PROJECT_STRUCTURE: 70,
    names.OBJECT_ID: 80,
    names.MIXED_LIST: 90,
}
"""The order of data at one owner; what is not named here is in the middle."""


_NO_QUALIFIER = "CODESYS and TwinCAT offer N R S L D P SD DS SL"
_NO_LOGIC = "CODESYS takes an expression or a transition object; its importer may not read this"

LACKS = {
    **{f"qualifier {name}": _NO_QUALIFIER for name in ("P0", "P1", "DL", "None", "CALL", "ON", "OFF")},
    **{f"qualifier {name}": _NO_QUALIFIER for name in ("CS", "CU", "CD", "CR", "TL", "TD", "TR", "TF")},
    "macro-step": "exports of CODESYS and TwinCAT have no macro-steps; their importers may not read it",
    "condition in a body": _NO_LOGIC,
    "condition wired to logic": _NO_LOGIC,
    "logic in a chart": "charts of CODESYS hold no logic elements; its importer may not read them",
    "negated condition": "CODESYS has no negated conditions; its importer may not see the negation",
    "negated step output": "CODESYS has no negated step outputs; its importer may not see the negation",
    "negated action block": "CODESYS has no negated action blocks; its importer may not see the negation",
}
"""Elements of charts that these tools do not know (82 exports of SP4 to SP21 and TwinCAT 3.5.6 to 3.5.13)."""

CODESYS_DIALECT = Tc6Dialect(
    version=V2_0,
    text_element=names.XHTML_CHILD,
    declares_xhtml=False,
    states_actions=True,
    tool=Tool.CODESYS,
    native_fields=NATIVE_FIELDS,
    native_texts=NATIVE_TEXTS,
    data_writer=write_data,
    data_rank=DATA_RANK,
    lacks=LACKS,
)


class CodesysCodec(Tc6Codec):
    """CODESYS and TwinCAT PLCopenXML."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        reading = load_tc6(data, _TOOL_DATA, file=file)
        reading.project.dialect = Dialect.CODESYS
        return reading

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the export. The tools write TC6 2.0; a file that was put into 2.01 by hand stays so."""
        texts = declaration_texts(project, options.baseline, report) if options.baseline is not None else {}
        dialect = replace(CODESYS_DIALECT, version=V2_01) if options.version == V2_01.name else CODESYS_DIALECT
        root = write_project(project, dialect, report, options, texts)
        mark_as_codesys(root)
        return root

    def style(self) -> XmlStyle:
        """As both tools write: UTF-8 with a mark, CRLF, two blanks, ``<a />``."""
        return XmlStyle(encoding="utf-8", bom=True, newline="\r\n", self_closing=" />")

    def validate(self, content: bytes, *, file: str | None = None) -> list[Diagnostic]:
        return validate_codesys(content, file=file)


CODEC = CodesysCodec()
