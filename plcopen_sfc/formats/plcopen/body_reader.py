"""Reads bodies in any language, and POUs. The writer is `body_writer`."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.plcopen.chart_reader import ChartReader
from plcopen_sfc.formats.plcopen.logic_reader import read_logic_body
from plcopen_sfc.formats.plcopen.reading import (
    Fields,
    ReadContext,
    attributes,
    carry_attributes,
    carry_element,
    read_code,
    read_common,
    take_choice,
    take_required,
)
from plcopen_sfc.formats.plcopen.types_reader import read_interface

POU_KINDS = ("program", "functionBlock", "function")


def read_body(ctx: ReadContext, element: etree._Element) -> Fields | None:
    """Read ``body`` or ``inline``; None where it is in no language that TC6 knows (its content is then carried)."""
    left = attributes(element)
    left.pop("name", None)
    fields: Fields = {}
    for child in element:
        local = ctx.tags.get(child.tag)
        if "language" in fields or local not in ("ST", "SFC", "FBD", "LD", "IL"):
            read_common(ctx, fields, child, local, "body")
            continue
        fields["language"] = local
        if local == "SFC":
            fields["chart"] = ChartReader(ctx, read_body).read(child)
        elif local in ("FBD", "LD"):
            fields["networks"] = read_logic_body(ctx, child)
        else:
            fields["text"], markup = read_code(ctx, child)
            if markup is not None:
                fields["markup"] = markup
    if "WorksheetName" in left:
        fields["worksheet"] = left.pop("WorksheetName")
    if left:
        carry_attributes(fields, left)
    if "language" not in fields:
        ctx.error("XML206", "a body is in none of the languages ST, SFC, FBD, LD and IL", element)
        fields.update(language="opaque", source="plcopen", content="")
    return fields


def read_part(ctx: ReadContext, element: etree._Element, owner: str) -> Fields:
    """Read ``action`` or ``transition`` of a POU (`owner`): a name and a body."""
    left = attributes(element)
    fields: Fields = {"name": take_required(ctx, element, left, "name")}
    ctx.place.append(f"{owner} {fields['name']}")
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "body" and "body" not in fields:
            fields["body"] = read_body(ctx, child)
        else:
            read_common(ctx, fields, child, local, owner)
    carry_attributes(fields, left)
    ctx.place.pop()
    return fields


def read_pou(ctx: ReadContext, element: etree._Element, place: str) -> Fields:
    """Read ``pou``, wherever it stands."""
    left = attributes(element)
    fields: Fields = {
        "name": take_required(ctx, element, left, "name"),
        "place": place,
        "actions": [],
        "transitions": [],
        "methods": [],
        "bodies": [],
    }
    ctx.place.append(f"POU {fields['name']}")
    fields["kind"] = take_choice(ctx, element, left, "pouType", POU_KINDS) or "program"
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "body":
            fields["bodies"].append(read_body(ctx, child))
        elif local == "interface" and "interface" not in fields:
            fields["interface"] = read_interface(ctx, child)
        elif local in ("actions", "transitions"):
            for part in child:
                if ctx.tags.get(part.tag) == local[:-1]:
                    fields[local].append(read_part(ctx, part, local[:-1]))
                else:
                    carry_element(ctx, fields, part)
        else:
            read_common(ctx, fields, child, local, "pou")
    carry_attributes(fields, left)
    ctx.place.pop()
    return fields
