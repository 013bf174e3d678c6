"""Bodies in any language and POUs of TC6 XML, read and written."""

from __future__ import annotations

from typing import Any, cast

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.formats.plcopen.source_marks import (
    DRAWING_FIELD,
    added_parts,
    added_variables,
    restore_chart,
    restore_texts,
    take_marks,
)
from plcopen_sfc.formats.plcopen.tc6_chart_writer import Tc6ChartWriter
from plcopen_sfc.formats.plcopen.tc6_charts import Tc6ChartReader, read_drawing
from plcopen_sfc.formats.plcopen.tc6_declarations import read_interface, write_interface
from plcopen_sfc.formats.plcopen.tc6_networks import is_known, read_logic_body, write_network
from plcopen_sfc.formats.plcopen.tc6_reading import (
    NEUTRAL,
    Fields,
    Tc6ReadContext,
    UnreadChart,
    keep_attributes,
    keep_element,
    merge_fields,
    read_code,
    read_common,
    take_choice,
    take_required,
)
from plcopen_sfc.formats.plcopen.tc6_writing import (
    Tc6WriteContext,
    add_child,
    data_left,
    finish_element,
    write_code,
    xhtml_child,
)
from plcopen_sfc.formats.provenance import read_later
from plcopen_sfc.formats.xml.extension_data import add_markup, attributes, fields_left, misfit
from plcopen_sfc.languages.networks.element_places import on_one_sheet
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.drawing import Drawing, Places
from plcopen_sfc.model.pou import Action, NamedTransition, Pou, PouKind
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork
from plcopen_sfc.report import Outcome

POU_KINDS = ("program", "functionBlock", "function")


def read_inner_body(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    """Read ``inline``, or ``body`` of a macro-step: a body inside a chart that is being read."""
    fields = read_body(ctx, element)
    chart = fields.get("chart")
    if isinstance(chart, UnreadChart):
        fields["chart"] = found = _chart_fields(chart)
        if isinstance(found["drawing"], dict):
            read_drawing(ctx, chart.element, found["drawing"])
    return fields


def finished_body(fields: Fields) -> Fields | SfcBody:
    """Return the finished body, when all that belongs to it is read."""
    chart = fields.get("chart")
    if not isinstance(chart, UnreadChart):
        return fields
    rest = {name: value for name, value in fields.items() if name != "chart"}
    unread = read_later(SfcNetwork, {}, lambda: _read_chart(chart), chart.may_have)
    try:
        return SfcBody.model_validate({**rest, "chart": unread})
    except ValidationError as error:
        ctx = chart.ctx
        raise misfit(error, rest, chart.element, file=ctx.file, lines=ctx.lines, place=chart.place) from None


def _read_chart(unread: UnreadChart) -> SfcNetwork:
    if unread.ahead is not None:
        chart, unread.ahead = unread.ahead, None
        return chart
    fields = _chart_fields(unread)
    marks, of_source = take_marks(fields), fields.pop(DRAWING_FIELD, None)
    drawing = fields["drawing"]
    if isinstance(drawing, dict):
        fields["drawing"] = read_later(Drawing, {}, lambda: _read_drawing(unread, drawing), unread.may_have)
    try:
        chart = SfcNetwork.model_validate(fields)
        unread.executed = restore_chart(chart, marks, of_source, unread.edited, unread.warn_of_edit)
        return chart
    except ValidationError as error:
        ctx = unread.ctx
        raise misfit(error, fields, unread.element, file=ctx.file, lines=ctx.lines, place=unread.place) from error


def _read_drawing(unread: UnreadChart, drawing: Fields) -> Drawing:
    ctx = unread.ctx
    outer, ctx.place = ctx.place, unread.place
    read_drawing(ctx, unread.element, drawing)
    ctx.place = outer
    fields: Fields = {"drawing": drawing}
    try:
        return cast("Drawing", SfcNetwork.model_validate(fields).drawing)
    except ValidationError as error:
        raise misfit(error, fields, unread.element, file=ctx.file, lines=ctx.lines, place=unread.place) from error


def _chart_fields(unread: UnreadChart) -> Fields:
    ctx = unread.ctx
    outer, ctx.place = ctx.place, unread.place
    fields = Tc6ChartReader(ctx, read_inner_body).read(unread.element)
    ctx.place = outer
    merge_fields(fields, unread.late)
    return fields


def read_body(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
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
    if fields.get("language") == "opaque":  # kept from another format; the empty ST is only there to be valid
        fields.pop("text", None)
        fields.pop("markup", None)
    if "WorksheetName" in left:
        fields["worksheet"] = left.pop("WorksheetName")
    if left:
        keep_attributes(fields, left)
    if "language" not in fields:
        ctx.error("XML206", "a body is in none of the languages ST, SFC, FBD, LD and IL", element)
        kept = fields.get("extension_data", {})
        fields.update(language="opaque", source="plcopen", content="".join(kept.pop("elements", [])))
        if not any(kept.values()):
            fields.pop("extension_data", None)
    return fields


def read_part(ctx: Tc6ReadContext, element: etree._Element, owner: str) -> Fields:
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
    keep_attributes(fields, left)
    ctx.place.pop()
    if "body" in fields:
        fields["body"] = finished_body(fields["body"])
    return fields


def _drop_added(fields: Fields) -> None:
    """Leave out the parts of a POU that were added to it, but for those that were edited or are still executed.

    Only a chart that is read tells which parts an element executes that was edited itself or executes an edited part.
    """
    charts = [body["chart"] for body in fields["bodies"] if isinstance(body.get("chart"), UnreadChart)]
    parts = [*fields["actions"], *fields["transitions"]]
    added, edited = added_parts(parts)
    sections = fields.get("interface", {}).get("sections", [])
    variables = {id(section): names for section in sections if (names := added_variables(section))}
    for names in variables.values():
        added |= names
    for chart in charts:
        chart.edited |= edited
        if added:
            added -= chart.read_ahead(_read_chart)
    for name in ("actions", "transitions"):
        fields[name] = [part for part in fields[name] if str(part["name"]).casefold() not in added]
    for section in [each for each in sections if id(each) in variables]:
        if variables[id(section)] <= added:
            sections.remove(section)


def read_pou(ctx: Tc6ReadContext, element: etree._Element, place: str) -> Fields:
    """Read ``pou``, in any place."""
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
                    keep_element(ctx, fields, part)
        else:
            read_common(ctx, fields, child, local, "pou")
    keep_attributes(fields, left)
    ctx.place.pop()
    _drop_added(fields)
    fields["bodies"] = [finished_body(body) for body in fields["bodies"]]
    return fields


_LABELS = {"ST": "ST body", "IL": "IL body", "FBD": "FBD body", "LD": "LD body", "SFC": "chart"}
_CHART_FIELDS = frozenset({"steps", "transitions", "logic", "drawing", "extension_data"})


def write_body(ctx: Tc6WriteContext, parent: etree._Element, name: str, body: Body, attributes: dict[str, str]) -> None:
    """Write ``body`` or ``inline`` (`name`)."""
    if body.worksheet is not None and not ctx.version.first_generation:
        attributes = attributes | {"WorksheetName": body.worksheet}
    element = add_child(ctx, parent, name, attributes)
    also: dict[str, Any] = {}
    native = frozenset({"language"}) | (frozenset() if ctx.version.first_generation else {"worksheet"})
    if isinstance(body, StBody | IlBody):
        own = not ctx.is_foreign
        write_code(ctx, add_child(ctx, element, body.language), body.text, body.markup if own else None)
        native = native | ({"text", "markup"} if own else {"text"})
    elif isinstance(body, SfcBody) and name == "body" and ctx.body_name in ctx.untouched:
        add_child(ctx, element, "SFC")
        native = native | {"chart"}
    elif isinstance(body, SfcBody):
        Tc6ChartWriter(ctx, body.chart, write_body).write(add_child(ctx, element, "SFC"))
        native = native | {"chart"}
        chart_native = _CHART_FIELDS | ctx.dialect.native_fields.get("chart", frozenset())
        if not ctx.takes_markup:
            # elements that TC6 2.0 does not know would not be valid in 1.01 either, and those of others nowhere
            chart_native = chart_native - {"extension_data"}
        if not all(is_known(ctx, node) for node in body.chart.logic):
            chart_native = chart_native - {"logic"}
        chart_left = fields_left(body.chart, chart_native) | data_left(ctx, body.chart.extension_data)
        for part in chart_left:
            why = f"TC6 {ctx.version.name} has no place for it"
            outcome = Outcome.NOT_EXECUTED if part == "partial_charts" else Outcome.EXTENSION_DATA
            ctx.note(outcome, f"chart {part.replace('_', ' ')}", why=why)
        if body.chart.drawing is not None and body.chart.drawing.places is Places.COMPUTED:
            chart_left["drawing"] = {"places": Places.COMPUTED.value}
        chart_left |= ctx.marks.get(id(body.chart), {})
        also = {"chart": chart_left} if chart_left else {}
    elif isinstance(body, FbdBody | LdBody):
        sheet = add_child(ctx, element, body.language)
        several = len(body.networks) > 1
        for network in [on_one_sheet(body.networks, ctx.dialect.tool)] if several else body.networks:
            write_network(ctx, sheet, network)
        network_native = _NETWORK_FIELDS - (set() if ctx.takes_markup else {"extension_data"})
        known = all(is_known(ctx, node) for network in body.networks for node in network.nodes)
        known = known and not any(data_left(ctx, network.extension_data) for network in body.networks)
        if len(body.networks) == 1 and known and not fields_left(body.networks[0], network_native):
            native = native | {"networks"}
    elif isinstance(body, OpaqueBody):
        if body.source == "plcopen":  # it was in no language that TC6 knows, and is not now
            add_markup(element, body.content.replace(f'"{NEUTRAL}"', f'"{ctx.version.namespace}"'))
            native = native | {"source", "content"}
        else:  # of another format: kept, and marked as no ST
            xhtml_child(ctx, add_child(ctx, element, "ST"))
            also = {"language": body.language}
            ctx.note(Outcome.EXTENSION_DATA, "body", "", f"a body of {body.source}; other tools see an empty one")
    if body.language in _LABELS:
        features = ["chart in an action"] if body.language == "SFC" and "." in ctx.body_name else []
        ctx.keep(_LABELS[body.language], "", *features)
    finish_element(ctx, element, body, "body", native, also=also)


_NETWORK_FIELDS = frozenset({"nodes", "extension_data"})


def write_part(ctx: Tc6WriteContext, parent: etree._Element, part: Action | NamedTransition, name: str) -> None:
    """Write ``action`` or ``transition`` of a POU."""
    element = add_child(ctx, parent, name, {"name": part.name})
    ctx.place.append(f"{name} {part.name}")
    outer, ctx.body_name = ctx.body_name, f"{ctx.body_name}.{part.name}"
    # the schema requires a body
    write_body(ctx, element, "body", part.body if part.body is not None else StBody(), {})
    ctx.keep("action" if name == "action" else "transition object")
    finish_element(ctx, element, part, f"{name}_object", frozenset({"name", "body"}))
    ctx.body_name = outer
    ctx.place.pop()


_POU_KINDS = {PouKind.PROGRAM: "program", PouKind.FUNCTION_BLOCK: "functionBlock", PouKind.FUNCTION: "function"}


def write_pou(ctx: Tc6WriteContext, parent: etree._Element, pou: Pou, *, in_place: bool) -> None:
    """Write ``pou``. `in_place`: it is in its `place`, which then need not be kept."""
    element = add_child(ctx, parent, "pou", {"name": pou.name, "pouType": _POU_KINDS.get(pou.kind, "program")})
    ctx.place.append(f"POU {pou.name}")
    ctx.body_name = pou.name
    ctx.keep("POU")
    native = {"name", "interface", "actions", "transitions"}
    if pou.kind in _POU_KINDS:
        native.add("kind")
    if in_place:
        native.add("place")
    if pou.interface is not None:
        write_interface(ctx, element, pou.interface)
    if pou.actions:
        holder = add_child(ctx, element, "actions")
        for action in pou.actions:
            write_part(ctx, holder, action, "action")
    if pou.transitions:
        holder = add_child(ctx, element, "transitions")
        for transition in pou.transitions:
            write_part(ctx, holder, transition, "transition")
    bodies = pou.bodies[:1] if ctx.version.first_generation else pou.bodies
    for body in bodies:
        write_body(ctx, element, "body", body, {})
    if len(bodies) == len(pou.bodies):
        native.add("bodies")
    finish_element(ctx, element, pou, "pou", frozenset(native))
    ctx.place.pop()
