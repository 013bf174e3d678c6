"""Documents without what an import does not look at: two exports of an unchanged block are the same bytes then.

`docs/formats/simaticml.md` lists what is left out.
"""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.simaticml.project_reader import find_version
from plcopen_sfc.formats.xml.xml_codec import XmlStyle, write_xml
from plcopen_sfc.formats.xml.xml_parsing import parse

_DATES = frozenset(
    """
    CodeModifiedDate CompileDate CreationDate InterfaceModifiedDate ModifiedDate ParameterModified StructureModified
    """.split()
)
"""Attributes of objects that no import looks at, marked or not."""
_INFORMATIVE = frozenset(
    """
    Address BooleanAttribute Comment DateAttribute IntegerAttribute Member RealAttribute StartValue StringAttribute
    """.split()
)
"""Elements that are complete without them. What else is marked as informative has to stand where it stands."""


def normalize(data: bytes, style: XmlStyle, *, file: str | None = None) -> bytes:
    """The document `data` in `style`, without what an import ignores. Normalising it again changes nothing.

    Raises `FormatError` for what is no document of TIA Portal Openness.
    """
    root = parse(data, file=file)
    find_version(root, file=file)
    for info in root.findall("DocumentInfo"):
        _remove(info)
    for element in [each for each in root.iter(etree.Element) if _ignored(each)]:
        _remove(element)
    for holder in root.findall(".//{*}Member/{*}AttributeList"):
        if not len(holder) and not holder.attrib:
            _remove(holder)
    return write_xml(root, style)


def _ignored(element: etree._Element) -> bool:
    name = etree.QName(element).localname
    parent = element.getparent()
    if parent is not None and parent.tag == "AttributeList" and (element.get("ReadOnly") == "true" or name in _DATES):
        return True
    return element.get("Informative") == "true" and name in _INFORMATIVE


def _remove(element: etree._Element) -> None:
    """Take an element out, but not the text behind it."""
    parent = element.getparent()
    if parent is None:
        return
    before, tail = element.getprevious(), (element.tail or "").strip()
    if tail and before is not None:
        before.tail = (before.tail or "") + tail
    elif tail:
        parent.text = (parent.text or "") + tail
    parent.remove(element)
