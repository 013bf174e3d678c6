"""What to say about XML of TIA Portal that is no document with PLC objects, and of blocks that keep their program."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.simaticml.reading import ReadContext, local

_PARTS = {
    "FlgNet": "a network in LAD or FBD",
    "Graph": "a chart of S7-GRAPH",
    "StructuredText": "a network in SCL",
    "StatementList": "a network in STL",
    "Sections": "the interface of a block",
    "Interface": "the interface of a block",
    "NetworkSource": "the program of a network",
    "AttributeList": "the attributes of an object",
    "MultilingualText": "a text in several languages",
}
_KINDS = (
    ("Hmi.", "an object of an operator panel"),
    ("Siemens.Simatic.Hmi", "an object of an operator panel"),
    ("SW.TechnologicalObjects.", "a technology object"),
    ("SW.WatchAndForceTables.", "a watch or force table"),
    ("SW.Alarm", "alarms of a PLC"),
    ("SW.Blocks.", "a block of a kind that is not known"),
    ("SW.Types.", "a type of a kind that is not known"),
    ("SW.", "an object of a PLC of a kind that is not known"),
    ("HW.", "hardware"),
)
_HARDWARE = "CAEXFile"
_WHOLE = "Exports of Openness start with <Document>; parts of them cannot be loaded by themselves."


def no_document(root: etree._Element) -> tuple[str, str]:
    """What the root of XML that is no document is, and what to do."""
    name = local(root)
    if name == _HARDWARE:
        return (
            "this is AutomationML: it describes hardware, and has no blocks",
            "Export the blocks of the PLC, with Openness or into a version control interface.",
        )
    what = _PARTS.get(name) or ("an object" if name.startswith("SW.") else "")
    if not what:
        return f"this is no document of TIA Portal Openness: the root element is <{name}>", _WHOLE
    message = f"this is a part of a document of TIA Portal Openness only: {what} (<{name}>)"
    return message, f"Export the whole block. {_WHOLE}"


def no_object(kind: str) -> str:
    """What an object of a document is that is none of those that are read."""
    what = next((words for start, words in _KINDS if kind.startswith(start)), "none of the objects that can be read")
    return f"<{kind}> is {what}; it is kept as it is"


def look_at_object(ctx: ReadContext, element: etree._Element) -> None:
    """Say of an object that its program is hidden (``XML211``), or was not compiled (``XML212``)."""
    name = element.findtext("AttributeList/Name", "")
    if (element.findtext("AttributeList/IsKnowHowProtected") or "").lower() == "true":
        message = f"{name} is know-how protected: what it does is not in the file"
        ctx.warn("XML211", message, element)
    if (element.findtext("AttributeList/IsConsistent") or "").lower() == "false":
        message = f"{name} was not consistent when it was exported: it may not fit the blocks and types that it uses"
        ctx.warn("XML212", message, element)
