"""Reads bodies in any language, and POUs. The writer is `body_writer`."""

from __future__ import annotations

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.errors import Location, StructureError
from plcopen_sfc.formats.plcopen.chart_reader import ChartReader
from plcopen_sfc.formats.plcopen.logic_reader import read_logic_body
from plcopen_sfc.formats.plcopen.reading import (
    Fields,
    ReadContext,
    UnreadChart,
    attributes,
    carry_attributes,
    carry_element,
    merge,
    read_code,
    read_common,
    take_choice,
    take_required,
)
from plcopen_sfc.formats.plcopen.rewritten import added_parts, restore_chart, restore_texts, take_marks
from plcopen_sfc.formats.plcopen.types_reader import read_interface
from plcopen_sfc.formats.provenance import read_later
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.sfc import SfcNetwork

POU_KINDS = ("program", "functionBlock", "function")


def read_inner_body(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``inline``, or ``body`` of a macro-step: a body inside a chart that is being read."""
    fields = read_body(ctx, element)
    chart = fields.get("chart")
    if isinstance(chart, UnreadChart):
        fields["chart"] = _chart_fields(chart)
    return fields


def defer(fields: Fields) -> Fields | SfcBody:
    """The finished body, when all that its surroundings say of it is known."""
    chart = fields.get("chart")
    if not isinstance(chart, UnreadChart):
        return fields
    rest = {name: value for name, value in fields.items() if name != "chart"}
    return SfcBody.model_validate({**rest, "chart": read_later(SfcNetwork, {}, lambda: _read_chart(chart))})


def _read_chart(unread: UnreadChart) -> SfcNetwork:
    if unread.ahead is not None:
        chart, unread.ahead = unread.ahead, None
        return chart
    fields = _chart_fields(unread)
    marks = take_marks(fields)
    try:
        chart = SfcNetwork.model_validate(fields)
        unread.executed = restore_chart(chart, marks, unread.edited, unread.warn_of_edit)
        return chart
    except ValidationError as error:
        raise misfit(error, unread.ctx.file) from error


def _chart_fields(unread: UnreadChart) -> Fields:
    ctx = unread.ctx
    outer, ctx.place = ctx.place, unread.place
    fields = ChartReader(ctx, read_inner_body).read(unread.element)
    ctx.place = outer
    merge(fields, unread.late)
    return fields


def misfit(error: ValidationError, file: str | None) -> StructureError:
    """What to say where carried data, which anybody may have edited, does not fit the model."""
    first = error.errors()[0]
    path = ".".join(map(str, first["loc"]))
    return StructureError(f"carried data does not fit the model at {path}: {first['msg']}", location=Location(file))


def read_body(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read a body in any language, its chart left unread; `opaque` where it is in none that TC6 knows."""
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
            fields["chart"] = UnreadChart(ctx, child)
        elif local in ("FBD", "LD"):
            fields["networks"] = read_logic_body(ctx, child)
        else:
            fields["text"], markup = read_code(ctx, child)
            if markup is not None:
                fields["markup"] = markup
    restore_texts(fields)
    if fields.get("language") == "opaque":  # carried from another format; the empty ST is only there to be valid
        fields.pop("text", None)
        fields.pop("markup", None)
    if "WorksheetName" in left:
        fields["worksheet"] = left.pop("WorksheetName")
    if left:
        carry_attributes(fields, left)
    if "language" not in fields:
        ctx.error("XML206", "a body is in none of the languages ST, SFC, FBD, LD and IL", element)
        kept = fields.get("carried", {})
        fields.update(language="opaque", source="plcopen", content="".join(kept.pop("elements", [])))
        if not any(kept.values()):
            fields.pop("carried", None)
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
    if "body" in fields:
        fields["body"] = defer(fields["body"])
    return fields


def _drop_added(fields: Fields) -> None:
    """Leave out the parts of a POU that were added to it, but for those that were edited or are still executed.

    What an element executes that was edited itself, or that executes an edited part, is known when its chart is read.
    """
    charts = [body["chart"] for body in fields["bodies"] if isinstance(body.get("chart"), UnreadChart)]
    parts = [*fields["actions"], *fields["transitions"]]
    added, edited = added_parts(parts)
    for chart in charts:
        chart.edited |= edited
        if added:
            added -= chart.read_ahead(_read_chart)
    for name in ("actions", "transitions"):
        fields[name] = [part for part in fields[name] if str(part["name"]).casefold() not in added]


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
    _drop_added(fields)
    fields["bodies"] = [defer(body) for body in fields["bodies"]]
    return fields
