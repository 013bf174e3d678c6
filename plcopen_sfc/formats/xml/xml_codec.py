"""Codecs of XML formats: from a tree to bytes in the style of a tool, and a file as its tool sees it.

libxml2 does the work (indentation and escaping in C). Its text is corrected afterwards where needed: `<a />`
instead of `<a/>`, CRLF, a declaration in single quotes, characters that a code page does not have.
"""

from __future__ import annotations

import codecs
import re
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, NamedTuple, cast

from lxml import etree

from plcopen_sfc.formats.format_interface import Codec, WriteOptions
from plcopen_sfc.formats.xml.escaping import encode_text
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK, OWN_DATA, canonical_form
from plcopen_sfc.formats.xml.source_tree import COMMENT, SourceNode, SourceTree
from plcopen_sfc.formats.xml.xml_parsing import decode_xml, parse_xml
from plcopen_sfc.languages.s7_boxes import put_logic
from plcopen_sfc.languages.text_edits import without
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.report import ConversionReport


class XmlCodec(Codec):
    """Reads and writes an XML format, whose files can be patched.

    `pou_tag` is the name of the elements with the POUs, in their order, where a file may have many; empty: it has one.
    """

    pou_tag: ClassVar[str] = ""

    @abstractmethod
    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the file for `project`."""

    def unchanged_symbols(self, before: SfcNetwork, after: SfcNetwork) -> frozenset[int]:
        """Return ids of symbols whose elements are the same before and after an edit; a codec may know of none."""
        return frozenset()

    @abstractmethod
    def style(self) -> XmlStyle:
        """Style in which the tool writes XML."""

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a file from the model alone."""
        return write_xml(self.to_tree(project, options, report), self.style())

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Replace flip-flop boxes with an operand, which only TIA Portal has, by logic."""
        put_logic(project, report)

    def as_tool_sees(self, data: bytes, *, file: str | None = None) -> bytes:
        """Return the file without data and comments of this package."""
        return as_tool_sees(data, file=file)


class ProjectPart(NamedTuple):
    """A part of a project that has a document of its own, and no object: its name, and the folder for a new one."""

    name: str
    folder: str
    document: Project


class FolderCodec(XmlCodec):
    """Reads and writes a format in which a folder of files is one project."""

    @abstractmethod
    def standard_folder(self, thing: ProjectObject) -> str:
        """Return the folder of an object that has none yet."""

    @abstractmethod
    def new_document(self, version: str) -> Project:
        """Return a project without objects."""

    def added_objects(self, project: Project) -> Sequence[ProjectObject]:
        """Return objects for the tool that `project` has otherwise; a reader does not make them its own."""
        return ()

    def extension(self, document: Project) -> str:
        """Return the extension of the file for a document; empty: that of the format."""
        return ""

    def listed(self, data: bytes, *, file: str | None = None) -> list[str]:
        """Return the paths, with ``/``, that a file which lists those of a project names. Raises `FormatError`."""
        return []

    def relisted(self, data: bytes, added: Sequence[str], gone: Sequence[str]) -> bytes:
        """Return a file which lists those of a project, with others in it; paths as `listed` gives them."""
        return data

    def parts(self, project: Project) -> list[ProjectPart] | None:
        """Return documents of the parts that belong to no object of `project`; None: one has all of it."""
        return None

    def join(self, project: Project) -> None:
        """Put together in `project` what several such documents had."""


@dataclass(frozen=True, slots=True)
class XmlStyle:
    """Style of the files of a tool.

    `encoding` is spelt as the declaration shall spell it. `indent` is the unit of one level; None leaves all white
    space as it is. `declaration` is the quote of the XML declaration, or "" for no declaration.
    """

    encoding: str = "utf-8"
    bom: bool = False
    newline: Literal["\n", "\r\n"] = "\n"
    indent: str | None = "  "
    self_closing: Literal["/>", " />"] = " />"
    declaration: Literal['"', "'", ""] = '"'
    standalone: bool | None = None
    final_newline: bool = False


_BOMS = {
    "utf-8": ("utf-8", codecs.BOM_UTF8),
    "utf-16": ("utf-16-le", codecs.BOM_UTF16_LE),
    "utf-16-le": ("utf-16-le", codecs.BOM_UTF16_LE),
    "utf-16-be": ("utf-16-be", codecs.BOM_UTF16_BE),
    "utf-32": ("utf-32-le", codecs.BOM_UTF32_LE),
}
_DEFAULT = XmlStyle()
# Two paths, each a single walk in C; one path with "or" takes three times as long.
# not "//*", nor a condition on each element: libxml2 takes up to three times as long for those
_LOOSE_TEXT = etree.XPath("descendant-or-self::*[node()[2]]/text()[normalize-space()]")
_ONLY_COMMENTS = etree.XPath("descendant::comment()/parent::*[not(*)]")
_SPACES = etree.XPath("descendant-or-self::*/@xml:space")
_RAW = re.compile(r"(<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>)", re.DOTALL)


def write_xml(root: etree._Element, style: XmlStyle = _DEFAULT) -> bytes:
    """Return the file for the tree `root` in `style`. The tree is indented: a copy would take as long as its text.

    Elements with text are never reformatted, nor their content. Comments and processing instructions before
    and after the root element are written too. Raises `EncodingError` for a name or comment that the encoding cannot
    hold; in text such characters become references.
    """
    before, after = _siblings(root, before=True), _siblings(root, before=False)
    if style.indent is not None:
        _indent(root, style.indent)
    text = _self_closing(etree.tostring(root, encoding="unicode", with_tail=False), style.self_closing)
    text = "\n".join([*_declaration(style), *before, text, *after])
    if style.final_newline:
        text += "\n"
    if style.newline != "\n":
        text = text.replace("\n", style.newline)
    # Python's own utf-16 and utf-32 write a mark themselves, in the byte order of this machine.
    codec, bom = _BOMS.get(codecs.lookup(style.encoding).name, (style.encoding, b""))
    return (bom if style.bom else b"") + encode_text(text, codec)


def canonical(root: etree._Element) -> bytes:
    """Return the tree in canonical form, without comments: equal for trees of the same content."""
    return canonical_form(root, comments=False, exclusive=False)


def _indent(root: etree._Element, unit: str) -> None:
    """Indent, but leave mixed content as it is: `etree.indent` would put line ends between its elements."""
    kept = [(node, node.text, node.tail, node is mixed) for mixed in _untouchable(root) for node in mixed.iter()]
    etree.indent(root, unit)
    for node, text, tail, outermost in kept:
        if node.text != text:
            node.text = text
        if not outermost and node.tail != tail:
            node.tail = tail


def _untouchable(root: etree._Element) -> list[etree._Element]:
    """Return the elements in which white space counts: those with text beside other nodes, and those marked so."""
    spaces = cast("list[Any]", _SPACES(root))
    mixed: dict[etree._Element, None] = {space.getparent(): None for space in spaces if space == "preserve"}
    for node in cast("list[etree._Element]", _ONLY_COMMENTS(root)):
        # white space would give content to an element that may have none
        mixed[node] = None
    for text in cast("list[Any]", _LOOSE_TEXT(root)):
        node = text.getparent()
        mixed[node.getparent() if text.is_tail else node] = None
    return list(mixed)


def _declaration(style: XmlStyle) -> list[str]:
    quote = style.declaration
    if not quote:
        return []
    text = f"<?xml version={quote}1.0{quote} encoding={quote}{style.encoding}{quote}"
    if style.standalone is not None:
        text += f" standalone={quote}{'yes' if style.standalone else 'no'}{quote}"
    return [text + "?>"]


def _siblings(root: etree._Element, *, before: bool) -> list[str]:
    """Comments and processing instructions outside the root element."""
    if root.getparent() is not None:
        return []
    found = [etree.tostring(node, encoding="unicode", with_tail=False) for node in root.itersiblings(preceding=before)]
    return found[::-1] if before else found


def _self_closing(text: str, style: str) -> str:
    if style == "/>":
        return text
    if "<!" not in text and "<?" not in text:
        return text.replace("/>", style)  # libxml2 escapes every other ">"
    parts = _RAW.split(text)
    parts[::2] = [part.replace("/>", style) for part in parts[::2]]
    return "".join(parts)


def as_tool_sees(data: bytes, *, file: str | None = None) -> bytes:
    """Return the file `data` without the data and comments of this package, if it has any. Raises `FormatError`."""
    text, encoding = decode_xml(data, file=file)
    if COMMENT_MARK not in text and OWN_DATA not in text:
        return data
    parse_xml(data, file=file)  # tells what is wrong with a file that is no XML
    tree = SourceTree(text)
    return encoding.encode(without(text, [(node.start, node.end) for node in _own(tree, tree.root)]))


def _own(tree: SourceTree, node: SourceNode) -> Iterator[SourceNode]:
    for child in node.children:
        if _is_own(tree, child):
            yield child
        else:
            yield from _own(tree, child)


def _is_own(tree: SourceTree, node: SourceNode) -> bool:
    if node.name == COMMENT:
        return tree.inner(node).startswith(COMMENT_MARK)
    local = node.name.rpartition(":")[2]
    if local == "data":
        return tree.values(node).get("name", "").startswith(OWN_DATA)
    # a holder with nothing but our data was made for it
    return local == "addData" and bool(node.children) and all(_is_own(tree, child) for child in node.children)
