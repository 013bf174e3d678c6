"""CODESYS and TwinCAT PLCopenXML: read, write, and the tree for patching."""

from __future__ import annotations

from dataclasses import replace

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.formats.codesys import names
from plcopen_sfc.formats.codesys.data_reader import DATA_READERS, finish_chart
from plcopen_sfc.formats.codesys.data_writer import mark_as_codesys
from plcopen_sfc.formats.codesys.declarations import drop_stale
from plcopen_sfc.formats.codesys.dialect import CODESYS
from plcopen_sfc.formats.format_interface import Marks, ReadResult, WriteOptions
from plcopen_sfc.formats.plcopen import host
from plcopen_sfc.formats.plcopen.codec import Tc6Codec
from plcopen_sfc.formats.plcopen.loading import load
from plcopen_sfc.formats.plcopen.project_writer import write_project
from plcopen_sfc.formats.plcopen.versions import V2_01
from plcopen_sfc.formats.xml.xml_codec import XmlStyle
from plcopen_sfc.languages.embedded_code import embedded_code
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome


class CodesysCodec(Tc6Codec):
    """CODESYS and TwinCAT PLCopenXML."""

    host = host.CODESYS

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read an export. Raises `FormatError`."""
        reading = load(
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
        """A copy of `project` in terms of the tool, and what the reader restores the source from."""
        for place in embedded_code(project):
            report.add(Outcome.NOT_EXECUTED, "code in C", place, "CODESYS and TwinCAT do not compile {{ .. }}")
        return super().rewrite(project, options, report)

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """The tree of the export. The tools write TC6 2.0; a file that was put into 2.01 by hand stays so."""
        stale = drop_stale(project, options.baseline, report) if options.baseline is not None else frozenset()
        dialect = replace(CODESYS, version=V2_01) if options.version == V2_01.name else CODESYS
        root = write_project(project, dialect, report, options, stale)
        mark_as_codesys(root)
        return root

    def style(self) -> XmlStyle:
        """As both tools write: UTF-8 with a mark, CRLF, two blanks, ``<a />``."""
        return XmlStyle(encoding="utf-8", bom=True, newline="\r\n", self_closing=" />")

    def validate(self, content: bytes, *, file: str | None = None) -> list[Diagnostic]:
        """What is wrong with a file by the schema of the format."""
        from plcopen_sfc.formats.codesys.schema import validate  # noqa: PLC0415  # brings xmlschema

        return validate(content, file=file)


CODEC = CodesysCodec()
