"""Data of objects of TwinCAT that the model does not have: kept as one piece of extension data of the object."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import NamedTuple

from lxml import etree

from plcopen_sfc.formats.xml.extension_data import markup, parsed_markup
from plcopen_sfc.model.base import ExtensionData, ForeignData

_NAME = "urn:plcopen-sfc:twincat"
_PLAIN = re.compile(r"\w*")


class Kept(NamedTuple):
    """Attributes and elements that were kept."""

    attributes: dict[str, str]
    elements: list[etree._Element]


def kept_data(attributes: dict[str, str], elements: Collection[etree._Element] = ()) -> list[ForeignData]:
    """Return the extension data that keeps attributes and elements; none where there are none."""
    if len(attributes) == 1 and not elements:
        [(name, value)] = attributes.items()
        if _PLAIN.fullmatch(value):  # a name at each transition: an element for each takes a twentieth of the reading
            return [ForeignData(name=_NAME, content=f'<twincat xmlns="" {name}="{value}"></twincat>')]
    holder = etree.Element("twincat", attributes)
    holder.extend(elements)
    return [ForeignData(name=_NAME, content=markup(holder))] if attributes or len(holder) else []


def kept_in(extension_data: ExtensionData | None) -> Kept:
    """Return what the extension data of an object keeps."""
    for data in extension_data.data if extension_data is not None else ():
        if data.name == _NAME:
            holder = parsed_markup(data.content)
            return Kept({str(name): str(value) for name, value in holder.attrib.items()}, list(holder))
    return Kept({}, [])
