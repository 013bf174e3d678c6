"""PLCopen TC6 XML: read, write, and the tree for patching."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.base import Reading, WriteOptions
from plcopen_sfc.formats.matiec.fitting import fit_project
from plcopen_sfc.formats.plcopen import adapting, host
from plcopen_sfc.formats.plcopen.beremiz import BEREMIZ
from plcopen_sfc.formats.plcopen.lines import source_lines
from plcopen_sfc.formats.plcopen.loading import load
from plcopen_sfc.formats.plcopen.project_writer import write_project
from plcopen_sfc.formats.plcopen.rewritten import Marks
from plcopen_sfc.formats.plcopen.versions import V2_01, version_named
from plcopen_sfc.formats.plcopen.writing import Dialect
from plcopen_sfc.formats.xml import tool_view, writing
from plcopen_sfc.formats.xml.writing import XmlStyle
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport

as_tool_sees = tool_view.as_tool_sees


def read(data: bytes, *, file: str | None = None) -> Reading:
    """Read a file of any TC6 version. Raises `FormatError`."""
    return load(data, file=file)


def lines(content: bytes, project: Project) -> dict[str, int]:
    """The line of each object of `project` in the file `content`, by the path that the report gives it."""
    return source_lines(content, project)


def rewrite(project: Project, options: WriteOptions, report: ConversionReport) -> tuple[Project, Marks]:
    """A copy of `project` that says what the tool is to execute in its terms, and what to keep of the source where."""
    return adapting.rewrite(project, host.TC6, options, report)


def is_rewritten(project: Project, content: bytes) -> bool:
    """True if the file `content` of `project` holds what was rewritten, or an edit made that necessary."""
    return adapting.is_rewritten(project, content, host.TC6)


def fit(project: Project, _flavour: str, report: ConversionReport) -> None:
    """Change `project`, a copy, into what Beremiz and OpenPLC execute."""
    fit_project(project, report, keeps_drawings=True)


def to_tree(project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
    """The tree of the file for `project`."""
    if options.flavour == "beremiz":
        return write_project(project, BEREMIZ, report, options)
    version = version_named(options.version) or V2_01
    return write_project(project, Dialect(version), report, options)


def style(_project: Project, _options: WriteOptions) -> XmlStyle:
    """As Beremiz and OpenPLC write: UTF-8 without a mark, LF, two blanks, ``<a/>``."""
    return XmlStyle(encoding="utf-8", newline="\n", self_closing="/>", final_newline=True)


def write(project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
    """Write a file anew."""
    return writing.write(to_tree(project, options, report), style(project, options))
