"""PLCopen TC6 XML: read, write, and the tree for patching."""

from __future__ import annotations

from typing import ClassVar

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.formats.format_interface import Marks, ReadResult, WriteOptions
from plcopen_sfc.formats.matiec.matiec_project import fit_project
from plcopen_sfc.formats.plcopen import adapting, host
from plcopen_sfc.formats.plcopen.beremiz import BEREMIZ
from plcopen_sfc.formats.plcopen.host import Host
from plcopen_sfc.formats.plcopen.lines import source_lines
from plcopen_sfc.formats.plcopen.loading import load
from plcopen_sfc.formats.plcopen.project_writer import write_project
from plcopen_sfc.formats.plcopen.versions import V2_01, version_named
from plcopen_sfc.formats.plcopen.writing import Dialect
from plcopen_sfc.formats.xml.xml_codec import XmlCodec, XmlStyle
from plcopen_sfc.languages.s7_flip_flops import put_logic
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport


class Tc6Codec(XmlCodec):
    """PLCopen TC6 XML, and what its dialects share; `host` tells what the charts of the tool can say."""

    host: ClassVar[Host] = host.TC6

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file of any TC6 version. Raises `FormatError`."""
        return load(data, file=file)

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """The line of each object of `project` in the file `content`, by the path that the report gives it."""
        return source_lines(content, project)

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Replace flip-flop boxes with an operand, which only TIA Portal has, by logic."""
        put_logic(project, report)

    def rewrite(self, project: Project, options: WriteOptions, report: ConversionReport) -> tuple[Project, Marks]:
        """A copy of `project` in terms of the tool, and what the reader restores the source from."""
        return adapting.rewrite(project, self.host, options, report)

    def is_rewritten(self, project: Project, content: bytes) -> bool:
        """True if the file `content` of `project` holds what was rewritten, or an edit made that necessary."""
        return adapting.is_rewritten(project, content, self.host)

    def fit(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Change `project`, a copy, into what Beremiz and OpenPLC execute."""
        fit_project(project, options, report, keeps_drawings=True)

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """The tree of the file for `project`."""
        if options.flavour == "beremiz":
            return write_project(project, BEREMIZ, report, options)
        version = version_named(options.version) or V2_01
        return write_project(project, Dialect(version), report, options)

    def style(self) -> XmlStyle:
        """As Beremiz and OpenPLC write: UTF-8 without a mark, LF, two blanks, ``<a/>``."""
        return XmlStyle(encoding="utf-8", newline="\n", self_closing="/>", final_newline=True)

    def validate(self, content: bytes, *, file: str | None = None) -> list[Diagnostic]:
        """What is wrong with a file by the schema of the format."""
        from plcopen_sfc.formats.plcopen.schema import validate  # noqa: PLC0415  # brings xmlschema

        return validate(content, file=file)


CODEC = Tc6Codec()
