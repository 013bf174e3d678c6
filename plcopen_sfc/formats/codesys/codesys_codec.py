"""CODESYS and TwinCAT PLCopenXML in the table of formats: TC6 2.0 and the data of these tools.

Exports may hold a declaration twice, as elements and as the text that was typed. After an edit of the elements the text
would contradict them, so it is left out; the tools then build it again from the elements.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.formats.codesys import codesys_names as names
from plcopen_sfc.formats.codesys.codesys_schema import validate_codesys
from plcopen_sfc.formats.codesys.element_data import (
    finish_chart,
    read_call_type,
    read_element_attributes,
    read_element_type,
    read_fbd_attributes,
    read_settings,
    read_st_code,
)
from plcopen_sfc.formats.codesys.object_data import (
    mark_as_codesys,
    read_application,
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
from plcopen_sfc.formats.format_interface import Marks, ReadResult, WriteOptions
from plcopen_sfc.formats.plcopen.chart_hosts import CODESYS_CHARTS
from plcopen_sfc.formats.plcopen.tc6_codec import Tc6Codec
from plcopen_sfc.formats.plcopen.tc6_project import load_tc6, write_project
from plcopen_sfc.formats.plcopen.tc6_reading import DataReader
from plcopen_sfc.formats.plcopen.tc6_versions import V2_0, V2_01
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6Dialect
from plcopen_sfc.formats.xml.xml_codec import XmlStyle
from plcopen_sfc.languages.declarations.kept_texts import KEPT_DATA
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.languages.syntax_problems import embedded_code
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.model.variables import Interface, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

DATA_READERS: dict[str, DataReader] = {
    names.SFC_ELEMENT: read_element_attributes,
    names.SFC_SETTINGS: read_settings,
    names.PLAIN_TEXT: read_declaration,
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
    names.CALL_TYPE: read_call_type,
    names.ST_CODE: read_st_code,
    names.ELEMENT_TYPE: read_element_type,
    names.FBD_ATTRIBUTES: read_fbd_attributes,
}
"""The reader of each kind of data."""


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
    "step": frozenset(
        {
            "exclude",
            "symbol",
            "duplicate",
            "min_time",
            "max_time",
            "main_action",
            "entry_action",
            "exit_action",
            "comment",
        }
    ),
    "transition": frozenset({"exclude", "symbol", "duplicate", "monitoring", "comment"}),
    "selectionDivergence": frozenset({"exclude", "name", "comment"}),
    "simultaneousDivergence": frozenset({"exclude", "name", "comment"}),
    "jumpStep": frozenset({"exclude", "comment"}),
    "block": frozenset({"call", "code"}),
    "vendorElement": frozenset({"element_type", "attributes"}),
}
"""The fields that this module writes, by the kind of their owner."""

NATIVE_TEXTS = frozenset({"extends", "implements"})
"""The texts kept of declarations that this module writes."""

DATA_RANK = {
    KEPT_DATA: 1,
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

    host = CODESYS_CHARTS

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read an export. Raises `FormatError`."""
        reading = load_tc6(
            data,
            file=file,
            data_readers=DATA_READERS,
            usual_text_element=names.XHTML_CHILD,
            placeless=True,
            finish_chart=finish_chart,
        )
        reading.project.dialect = Dialect.CODESYS
        return reading

    def rewrite(self, project: Project, options: WriteOptions, report: ConversionReport) -> tuple[Project, Marks]:
        """Return a copy of `project` in terms of the tool, and what the reader restores the source from."""
        for place in embedded_code(project):
            report.add(Outcome.NOT_EXECUTED, "code in C", place, "CODESYS and TwinCAT do not compile {{ .. }}")
        return super().rewrite(project, options, report)

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the export. The tools write TC6 2.0; a file that was put into 2.01 by hand stays so."""
        stale = drop_stale(project, options.baseline, report) if options.baseline is not None else frozenset()
        dialect = replace(CODESYS_DIALECT, version=V2_01) if options.version == V2_01.name else CODESYS_DIALECT
        root = write_project(project, dialect, report, options, stale)
        mark_as_codesys(root)
        return root

    def style(self) -> XmlStyle:
        """As both tools write: UTF-8 with a mark, CRLF, two blanks, ``<a />``."""
        return XmlStyle(encoding="utf-8", bom=True, newline="\r\n", self_closing=" />")

    def validate(self, content: bytes, *, file: str | None = None) -> list[Diagnostic]:
        """Return the errors of a file by the schema of the format."""
        return validate_codesys(content, file=file)


CODEC = CodesysCodec()


_Declared = Interface | DataTypeDeclaration | VariableSection


def drop_stale(project: Project, baseline: Project, report: ConversionReport) -> frozenset[int]:
    """Return the objects (by `id()`) whose text was typed for what `baseline` declares; each is in the report."""
    before, after = _by_path(baseline), _by_path(project)
    stale: set[int] = set()
    for path, things in after.items():
        thing, old = things[0], before.get(path)
        if old is None or thing.declaration is None or thing.declaration != old[0].declaration:
            continue
        if list(map(_content, things)) != list(map(_content, old)):
            stale.add(id(thing))
            why = "it no longer fits what is declared; the tool builds it again, without pragmas and comments between"
            report.add(Outcome.APPROXIMATED, "declaration text", path, why)
    return frozenset(stale)


def _by_path(project: Project) -> dict[str, list[_Declared]]:
    """Return declarations by path; a list of global variables may have several sections, and its text at the first."""
    found: dict[str, list[_Declared]] = {}
    for path, thing in _declared(project):
        found.setdefault(path, []).append(thing)
    return found


def _content(thing: Element) -> dict[str, object]:
    return {name: value for name, value in vars(thing).items() if name != "declaration"}


def _declared(project: Project) -> Iterator[tuple[str, _Declared]]:
    for pou in project.pous:
        if pou.interface is not None:
            yield f"POU {pou.name}", pou.interface
        for method in pou.methods:
            if method.interface is not None:
                yield f"POU {pou.name} / method {method.name}", method.interface
    for declaration in project.data_types:
        yield f"type {declaration.name}", declaration
    for section in project.global_sections():
        yield f"global variables {section.name}", section
