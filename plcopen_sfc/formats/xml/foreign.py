"""Markup that objects carry, in files of a format that it is not of.

What an object carries and the model does not say is markup of TC6 or of SimaticML, never both as they are: that of the
product in the header of its project, which files of both formats keep. Where the other format is read or written, its
own markup changes places with that: what does not belong there is put away as one piece of data at the object, and
taken out again on the way home.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum
from typing import Any

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.formats.base import TIA_PORTAL
from plcopen_sfc.formats.xml.carrying import markup
from plcopen_sfc.model.base import Carried, ForeignData, Model
from plcopen_sfc.model.project import Project

PUT_AWAY = "urn:plcopen-sfc:carried"
"""The data that is put away has a name that begins so; the `Markup` that it is follows after a colon."""


class Markup(StrEnum):
    """Whose markup it is."""

    TC6 = "tc6"
    SIMATICML = "simaticml"


def markup_of(project: Project) -> Markup:
    """Whose markup the objects of a project carry as it is."""
    return Markup.SIMATICML if project.header.product == TIA_PORTAL else Markup.TC6


def exchange(thing: Model, own: Markup, wanted: Markup) -> None:
    """Change what `thing` and the objects in it carry: markup of `wanted` as it is, instead of that of `own`.

    Objects and charts that are unread stay so, and as they are.
    """
    if own is not wanted:
        for holder, name, carried in list(_carried_in(thing)):
            setattr(holder, name, _exchanged(carried, own, wanted))


def _carried_in(thing: Any) -> Iterator[tuple[Model, str, Carried]]:
    if isinstance(thing, Model):
        for name, value in thing.__dict__.items():
            if isinstance(value, Carried):
                yield thing, name, value
            else:
                yield from _carried_in(value)
    elif isinstance(thing, list):
        for item in thing:
            yield from _carried_in(item)


def _exchanged(carried: Carried, own: Markup, wanted: Markup) -> Carried:
    left = Carried(attributes=carried.attributes, elements=carried.elements)
    found = Carried()
    for data in carried.data:
        if data.name == f"{PUT_AWAY}:{wanted}" and (taken := _taken_out(data)) is not None:
            found.data += taken.data
            found.attributes |= taken.attributes
            found.elements += taken.elements
        elif data.name.startswith(PUT_AWAY):
            found.data.append(data)
        else:
            left.data.append(data)
    if left != Carried() or not carried.data:
        found.data.append(_put_away(left, own))
    return found


def _put_away(carried: Carried, own: Markup) -> ForeignData:
    element = etree.Element(f"{{{PUT_AWAY}}}carried", nsmap={None: PUT_AWAY})  # type: ignore[dict-item]  # lxml-stubs
    element.text = carried.model_dump_json(exclude_defaults=True)
    return ForeignData(name=f"{PUT_AWAY}:{own}", content=markup(element))


def _taken_out(data: ForeignData) -> Carried | None:
    """What was put away; None where somebody has damaged it."""
    try:
        return Carried.model_validate_json(etree.fromstring(data.content).text or "")
    except (etree.XMLSyntaxError, ValidationError):
        return None
