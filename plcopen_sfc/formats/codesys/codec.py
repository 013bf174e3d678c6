"""CODESYS and TwinCAT PLCopenXML: read, write, and the tree for patching."""

from __future__ import annotations

from dataclasses import replace

from lxml import etree

from plcopen_sfc.formats.base import Reading, WriteOptions
from plcopen_sfc.formats.codesys import names
from plcopen_sfc.formats.codesys.data_reader import DATA_READERS, finish_chart
from plcopen_sfc.formats.codesys.declarations import drop_stale
from plcopen_sfc.formats.codesys.dialect import CODESYS
from plcopen_sfc.formats.plcopen import adapting, host
from plcopen_sfc.formats.plcopen.lines import source_lines
from plcopen_sfc.formats.plcopen.loading import load
from plcopen_sfc.formats.plcopen.project_writer import write_project
from plcopen_sfc.formats.plcopen.rewritten import Marks
from plcopen_sfc.formats.plcopen.versions import V2_01
from plcopen_sfc.formats.xml import tool_view, writing
from plcopen_sfc.formats.xml.writing import XmlStyle
from plcopen_sfc.languages.embedded_code import embedded_code
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome

as_tool_sees = tool_view.as_tool_sees


def read(data: bytes, *, file: str | None = None) -> Reading:
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


def lines(content: bytes, project: Project) -> dict[str, int]:
    """The line of each object of `project` in the file `content`, by the path that the report gives it."""
    return source_lines(content, project)


def rewrite(project: Project, options: WriteOptions, report: ConversionReport) -> tuple[Project, Marks]:
    """A copy of `project` that says what the tool is to execute in its terms, and what to keep of the source where."""
    for place in embedded_code(project):
        report.add(Outcome.NOT_EXECUTED, "code in C", place, "CODESYS and TwinCAT do not compile {{ .. }}")
    return adapting.rewrite(project, host.CODESYS, options, report)


def is_rewritten(project: Project, content: bytes) -> bool:
    """True if the file `content` of `project` holds what was rewritten, or an edit made that necessary."""
    return adapting.is_rewritten(project, content, host.CODESYS)


def to_tree(project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
    """The tree of the export for `project`. The tools write TC6 2.0; a file that was put into 2.01 by hand stays so."""
    stale = drop_stale(project, options.baseline, report) if options.baseline is not None else frozenset()
    dialect = replace(CODESYS, version=V2_01) if options.version == V2_01.name else CODESYS
    return write_project(project, dialect, report, options, stale)


def style(_project: Project, _options: WriteOptions) -> XmlStyle:
    """As both tools write: UTF-8 with a mark, CRLF, two blanks, ``<a />``."""
    return XmlStyle(encoding="utf-8", bom=True, newline="\r\n", self_closing=" />")


def write(project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
    """Write an export anew."""
    return writing.write(to_tree(project, options, report), style(project, options))
