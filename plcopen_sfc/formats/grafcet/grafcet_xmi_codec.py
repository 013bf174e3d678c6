"""``.grafcet`` files of the open editor for GRAFCETs (AGRAFE): EMF XMI, references by position.

``//@partialGrafcets.1/@steps.0`` is the first step of the second chart. References are resolved when a file is read,
and made of the positions when it is written. Arcs and synchronizations are the several steps of a transition.
"""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.grafcet.grafcet_xmi_reader import XmiOrder, XmiReader
from plcopen_sfc.formats.grafcet.grafcet_xmi_writer import XmiWriter
from plcopen_sfc.formats.remainder_comments import keys_of
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK
from plcopen_sfc.formats.xml.xml_codec import XmlCodec, XmlStyle
from plcopen_sfc.formats.xml.xml_parsing import parse_xml
from plcopen_sfc.languages.pragmas import changes, plain_fields
from plcopen_sfc.model.compare import path_of
from plcopen_sfc.model.numbering import take_ids
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome


class GrafcetXmiCodec(XmlCodec):
    """``.grafcet`` files."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file. Raises `FormatError` where a reference leads nowhere."""
        return XmiReader(parse_xml(data, file=file), file).run()

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the file for `project`; what it has no place for is in comments."""
        found = [pou for pou in project.pous if pou.chart is not None]
        order = XmiOrder()
        if options.source:  # references are positions: what the file has stays in its order
            reader = XmiReader(parse_xml(options.source), None)
            reader.run()
            order = reader.order
        root = XmiWriter(found[0] if found else None, report, order).run()
        for pou in found[1:]:
            report.add(Outcome.NOT_EXECUTED, "chart", f"POU {pou.name}", "a .grafcet file has one GRAFCET")
        back = XmiReader(root, None).run().project
        meant = project.model_copy(deep=True)
        take_ids(meant, back)
        for change in changes(plain_fields(back), plain_fields(meant), guarded=True):
            path = path_of(meant, keys_of(meant, change))
            name = next(segment for segment in reversed(change.path) if isinstance(segment, str)).replace("_", " ")
            report.add(Outcome.EXTENSION_DATA, name, path, "a .grafcet file has no place for it; it is in a comment")
            # XML allows no two hyphens in a comment
            root.append(etree.Comment(f"{COMMENT_MARK}{change} ".replace("--", "-$2D").replace("--", "-$2D")))
        return root

    def style(self) -> XmlStyle:
        """As EMF writes: UTF-8 without a mark, LF, two blanks, ``<a/>``."""
        return XmlStyle(encoding="UTF-8", newline="\n", self_closing="/>", final_newline=True)

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """Return the line of each object, by the path that a report gives it."""
        reader = XmiReader(parse_xml(content), None)
        reader.run()
        return reader.lines


CODEC = GrafcetXmiCodec()
