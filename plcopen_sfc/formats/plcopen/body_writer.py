"""Writes bodies in any language, and POUs. The reader is `body_reader`."""

from __future__ import annotations

from typing import Any

from lxml import etree

from plcopen_sfc.formats.plcopen.chart_writer import ChartWriter
from plcopen_sfc.formats.plcopen.logic_writer import is_known, write_network
from plcopen_sfc.formats.plcopen.reading import NEUTRAL
from plcopen_sfc.formats.plcopen.types_writer import write_interface
from plcopen_sfc.formats.plcopen.writing import WriteContext, data_left, finish, sub, write_code, xhtml_child
from plcopen_sfc.formats.xml.extension_data import add_markup, fields_left
from plcopen_sfc.languages.networks.sheets import on_one_sheet
from plcopen_sfc.model.body import Body, FbdBody, IlBody, LdBody, OpaqueBody, SfcBody, StBody
from plcopen_sfc.model.drawing import Places
from plcopen_sfc.model.pou import Action, NamedTransition, Pou, PouKind
from plcopen_sfc.report import Outcome

_WHAT = {"ST": "ST body", "IL": "IL body", "FBD": "FBD body", "LD": "LD body", "SFC": "chart"}
_CHART = frozenset({"steps", "transitions", "logic", "drawing", "carried"})


def write_body(ctx: WriteContext, parent: etree._Element, name: str, body: Body, attributes: dict[str, str]) -> None:
    """Write ``body`` or ``inline`` (`name`)."""
    if body.worksheet is not None and not ctx.version.first_generation:
        attributes = attributes | {"WorksheetName": body.worksheet}
    element = sub(ctx, parent, name, attributes)
    also: dict[str, Any] = {}
    native = frozenset({"language"}) | (frozenset() if ctx.version.first_generation else {"worksheet"})
    if isinstance(body, StBody | IlBody):
        own = not ctx.is_foreign
        write_code(ctx, sub(ctx, element, body.language), body.text, body.markup if own else None)
        native = native | ({"text", "markup"} if own else {"text"})
    elif isinstance(body, SfcBody) and name == "body" and ctx.body_name in ctx.untouched:
        sub(ctx, element, "SFC")
        native = native | {"chart"}
    elif isinstance(body, SfcBody):
        ChartWriter(ctx, body.chart, write_body).write(sub(ctx, element, "SFC"))
        native = native | {"chart"}
        chart_native = _CHART | ctx.dialect.native_fields.get("chart", frozenset())
        if not ctx.takes_markup:
            # elements that TC6 2.0 does not know would not be valid in 1.01 either, and those of others nowhere
            chart_native = chart_native - {"carried"}
        if not all(is_known(ctx, node) for node in body.chart.logic):
            chart_native = chart_native - {"logic"}
        chart_left = fields_left(body.chart, chart_native) | data_left(ctx, body.chart.carried)
        for part in chart_left:
            why = f"TC6 {ctx.version.name} has no place for it"
            outcome = Outcome.NOT_EXECUTED if part == "partial_charts" else Outcome.EXTENSION_DATA
            ctx.note(outcome, f"chart {part.replace('_', ' ')}", why=why)
        if body.chart.drawing is not None and body.chart.drawing.places is Places.COMPUTED:
            chart_left["drawing"] = {"places": Places.COMPUTED.value}
        also = {"chart": chart_left} if chart_left else {}
    elif isinstance(body, FbdBody | LdBody):
        sheet = sub(ctx, element, body.language)
        several = len(body.networks) > 1
        for network in [on_one_sheet(body.networks, ctx.dialect.tool)] if several else body.networks:
            write_network(ctx, sheet, network)
        network_native = _NETWORK - (set() if ctx.takes_markup else {"carried"})
        known = all(is_known(ctx, node) for network in body.networks for node in network.nodes)
        known = known and not any(data_left(ctx, network.carried) for network in body.networks)
        if len(body.networks) == 1 and known and not fields_left(body.networks[0], network_native):
            native = native | {"networks"}
    elif isinstance(body, OpaqueBody):
        if body.source == "plcopen":  # it was in no language that TC6 knows, and is not now
            add_markup(element, body.content.replace(f'"{NEUTRAL}"', f'"{ctx.version.namespace}"'))
            native = native | {"source", "content"}
        else:  # of another format: carried, and said to be no ST
            xhtml_child(ctx, sub(ctx, element, "ST"))
            also = {"language": body.language}
            ctx.note(Outcome.EXTENSION_DATA, "body", "", f"a body of {body.source}; other tools see an empty one")
    if body.language in _WHAT:
        features = ["chart in an action"] if body.language == "SFC" and "." in ctx.body_name else []
        ctx.keep(_WHAT[body.language], "", *features)
    finish(ctx, element, body, "body", native, also=also)


_NETWORK = frozenset({"nodes", "carried"})


def write_part(ctx: WriteContext, parent: etree._Element, part: Action | NamedTransition, name: str) -> None:
    """Write ``action`` or ``transition`` of a POU."""
    element = sub(ctx, parent, name, {"name": part.name})
    ctx.place.append(f"{name} {part.name}")
    outer, ctx.body_name = ctx.body_name, f"{ctx.body_name}.{part.name}"
    # the schema requires a body
    write_body(ctx, element, "body", part.body if part.body is not None else StBody(), {})
    ctx.keep("action" if name == "action" else "transition object")
    finish(ctx, element, part, f"{name}_object", frozenset({"name", "body"}))
    ctx.body_name = outer
    ctx.place.pop()


_POU_KINDS = {PouKind.PROGRAM: "program", PouKind.FUNCTION_BLOCK: "functionBlock", PouKind.FUNCTION: "function"}


def write_pou(ctx: WriteContext, parent: etree._Element, pou: Pou, *, in_place: bool) -> None:
    """Write ``pou``. `in_place`: it stands where its `place` says, which then need not be carried."""
    element = sub(ctx, parent, "pou", {"name": pou.name, "pouType": _POU_KINDS.get(pou.kind, "program")})
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
        holder = sub(ctx, element, "actions")
        for action in pou.actions:
            write_part(ctx, holder, action, "action")
    if pou.transitions:
        holder = sub(ctx, element, "transitions")
        for transition in pou.transitions:
            write_part(ctx, holder, transition, "transition")
    bodies = pou.bodies[:1] if ctx.version.first_generation else pou.bodies
    for body in bodies:
        write_body(ctx, element, "body", body, {})
    if len(bodies) == len(pou.bodies):
        native.add("bodies")
    finish(ctx, element, pou, "pou", frozenset(native))
    ctx.place.pop()
