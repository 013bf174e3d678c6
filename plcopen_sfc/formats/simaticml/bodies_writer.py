"""Writes the bodies of a code block as compile units. The reader is `bodies_reader`."""

from __future__ import annotations

from typing import Any

from lxml import etree

from plcopen_sfc.formats.simaticml.bodies_reader import NAMES
from plcopen_sfc.formats.simaticml.coils import put_assignments
from plcopen_sfc.formats.simaticml.graph_writer import write_graph
from plcopen_sfc.formats.simaticml.networks import write_network
from plcopen_sfc.formats.simaticml.power import lacks_power, put_in_series
from plcopen_sfc.formats.simaticml.structured_text_writer import write_code
from plcopen_sfc.formats.simaticml.writing import (
    ID,
    WriteContext,
    add_element,
    finish,
    keep_fields,
    sub,
    write_object_text,
)
from plcopen_sfc.model.base import Carried, Element
from plcopen_sfc.model.body import Body, FbdBody, IlBody, LdBody, OpaqueBody, SfcBody, StBody
from plcopen_sfc.model.network import LogicNetwork, OutputVariable
from plcopen_sfc.report import Outcome

UNIT = "SW.Blocks.CompileUnit"


def language_of(body: Body | None) -> str:
    """The language of a body as TIA Portal calls it."""
    if body is None:
        return ""
    kept = body.carried.attributes.get("ProgrammingLanguage") if body.carried is not None else None
    return kept or NAMES.get(body.language, "")


def write_units(ctx: WriteContext, parent: etree._Element, body: Body) -> None:
    """Write a body as one compile unit, or as one for each of its networks."""
    if isinstance(body, FbdBody | LdBody):
        for network in body.networks:
            _network(ctx, parent, body, network)
        ctx.keep(f"{body.language} body")
        return
    source, unit = _unit(ctx, parent, body, language_of(body) or ("" if isinstance(body, OpaqueBody) else "LAD"))
    native = {"language", "title", "comment"}
    also: dict[str, Any] = {}
    if isinstance(body, StBody):
        write_code(ctx, source, body)
        native |= {"text", "markup"}
        ctx.keep("ST body")
    elif isinstance(body, SfcBody):
        native.add("chart")
        if ctx.body_name not in ctx.options.untouched:
            write_graph(ctx, ctx.root("Graph", "Graph", source), body.chart)
        ctx.keep("chart")
    elif isinstance(body, OpaqueBody) and body.source == "simaticml":
        for content in [body.content] if body.content else []:
            add_element(ctx, source, content)
        native |= {"source", "content"}
    else:
        what = "IL body" if isinstance(body, IlBody) else "body"
        why = "the block is empty and does nothing: it is in no language that is written for TIA Portal"
        ctx.note(Outcome.NOT_EXECUTED, what, why=why)
        keep_fields(unit, {"body": body.model_dump(mode="json", exclude_none=True)})
        return
    finish(ctx, unit, body, frozenset(native), also=also)


def _unit(
    ctx: WriteContext, parent: etree._Element, thing: Element, language: str
) -> tuple[etree._Element, etree._Element]:
    """A new compile unit with the texts of `thing`: its ``NetworkSource`` and itself."""
    unit = sub(parent, UNIT, {ID: "", "CompositionName": "CompileUnits"})
    values = sub(unit, "AttributeList")
    kept = dict(thing.carried.attributes) if thing.carried is not None else {}
    source = sub(values, "NetworkSource")
    if kept.pop("NetworkSource", None) is not None:
        values.remove(source)
    objects = sub(unit, "ObjectList")
    for name, value in kept.items():
        if name.startswith("@"):
            owner, _, mark = name[1:].rpartition("@")
            {"AttributeList": values, "ObjectList": objects, "NetworkSource": source}.get(owner, unit).set(mark, value)
        elif " " not in name and name != "ProgrammingLanguage":
            sub(values, name).text = value or None
    _unknown(ctx, values, objects, thing.carried)
    if language:
        sub(values, "ProgrammingLanguage").text = language
    write_object_text(ctx, objects, "Comment", thing.comment)
    write_object_text(ctx, objects, "Title", getattr(thing, "title", None))
    if not len(objects):
        unit.remove(objects)
    return source, unit


def _unknown(ctx: WriteContext, values: etree._Element, objects: etree._Element, carried: Carried | None) -> None:
    for content in carried.elements if carried is not None else ():
        holder = etree.Element("holder")
        add_element(ctx, holder, content)
        for element in list(holder):
            (objects if element.get(ID) is not None else values).append(element)


def _network(ctx: WriteContext, parent: etree._Element, body: FbdBody | LdBody, network: LogicNetwork) -> None:
    source, unit = _unit(ctx, parent, network, language_of(body))
    if network.nodes or (network.carried is not None and network.carried.data):
        root = ctx.root("FlgNet", "FlgNet", source)
        if any(isinstance(node, OutputVariable) for node in network.nodes):  # drawn here since the file was read
            network = network.model_copy(deep=True)
            put_assignments(network, ctx.types, {pou.name.casefold() for pou in ctx.project.pous})
        if isinstance(body, LdBody) and lacks_power(network):
            network = network.model_copy(deep=True)
            put_in_series(network)
        instead = write_network(ctx, root, network)
        if instead is not None:
            source.replace(root, instead)
    left = LogicNetwork(global_id=network.global_id)
    finish(ctx, unit, left, frozenset())
