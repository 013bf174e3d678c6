"""Compile units, the networks of a code block: read and written.

TIA Portal divides every block into networks, each in a language of its own. Networks of LAD or FBD that follow each
other are one body.
"""

from __future__ import annotations

from typing import Any

from lxml import etree

from plcopen_sfc.formats.provenance import read_later
from plcopen_sfc.formats.simaticml.box_types import give_types
from plcopen_sfc.formats.simaticml.coils_and_contacts import lacks_power, put_assignments, put_in_series
from plcopen_sfc.formats.simaticml.element_reader import (
    DocumentReading,
    Fields,
    NotUnderstoodError,
    child_named,
    children,
    keep_attribute,
    keep_element,
    keep_rest,
    local,
    merge_fields,
    opaque_body,
    read_comments,
    read_model,
    read_objects,
)
from plcopen_sfc.formats.simaticml.element_writer import (
    ID,
    DocumentWriting,
    add_element,
    finish,
    keep_fields,
    kept_parts,
    sub,
    write_object_text,
)
from plcopen_sfc.formats.simaticml.graph_reader import read_graph
from plcopen_sfc.formats.simaticml.graph_writer import write_graph
from plcopen_sfc.formats.simaticml.lad_fbd_networks import read_network, report_network, write_network
from plcopen_sfc.formats.simaticml.replaced_elements import WRITTEN, code_digest, warn_of_edit
from plcopen_sfc.formats.simaticml.scl_tokens import InterfaceNames, read_code, write_code
from plcopen_sfc.formats.xml.extension_data import Markup, attributes, attributes_of, exchange_markup
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.network import LogicNetwork, OutputVariable
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork
from plcopen_sfc.report import Outcome

LANGUAGES = {"LAD": "LD", "FBD": "FBD", "SCL": "ST", "GRAPH": "SFC"}
NAMES = {language: name for name, language in LANGUAGES.items()}
_SHELLS = ("FlgNet", "Parts", "Wires", "StructuredText")
UNIT = "SW.Blocks.CompileUnit"


def read_units(ctx: DocumentReading, units: list[etree._Element], late: Fields) -> tuple[list[Fields | SfcBody], str]:
    """Return the bodies of a block, and its language by them. `late`: what its attributes tell about its chart."""
    bodies: list[Fields | SfcBody] = []
    languages: list[str] = []
    for unit in units:
        name, body = _read_unit(ctx, unit, late)
        languages.append(name)
        last = bodies[-1] if bodies else None
        if isinstance(last, dict) and isinstance(body, dict) and _continues(last, body):
            last["networks"].extend(body["networks"])
        else:
            bodies.append(body)
    return bodies, block_language(languages)


def write_units(ctx: DocumentWriting, parent: etree._Element, body: Body) -> None:
    """Write a body as one compile unit, or as one for each of its networks."""
    if isinstance(body, FbdBody | LdBody):
        for network in body.networks:
            _network(ctx, parent, body, network)
        ctx.keep(f"{body.language} body")
        return
    source, unit = _add_unit(ctx, parent, body, language_of(body) or ("" if isinstance(body, OpaqueBody) else "LAD"))
    native = {"language", "title", "comment"}
    also: dict[str, Any] = {}
    if isinstance(body, StBody):
        written = _without_calls(ctx, body)
        write_code(ctx, source, written)
        native |= {"text", "markup"}
        if written is not body:
            also |= {"text": body.text, WRITTEN: code_digest(source)}
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


def _without_calls(ctx: DocumentWriting, body: StBody) -> StBody:
    """Return a body with statements of actions in place of the calls of them; itself if there are none."""
    # a document of a folder has a copy of the block
    pou = next((each for each in ctx.project.pous if ctx.pou is not None and each.name == ctx.pou.name), None)
    if pou is None:
        return body  # it was added, and calls nothing that is not there
    found = ctx.action_calls.inlined(body.text, pou)
    if found.called:
        why = f"the statements of actions are in place of the calls of {', '.join(dict.fromkeys(found.called))}"
        ctx.note(Outcome.TRANSLATED, "code", why=why)
    if found.methods:
        why = f"functions are called in place of the methods {', '.join(dict.fromkeys(found.methods))}"
        ctx.note(Outcome.TRANSLATED, "code", why=why)
    if found.started:
        why = f"the calls of {', '.join(found.started)} pass the start values of inputs, which the instance cannot have"
        ctx.note(Outcome.TRANSLATED, "code", why=why)
    for problem in found.problems:
        why = f"a call stays that TIA Portal does not have, as blocks have no actions there: {problem}"
        ctx.note(Outcome.NOT_EXECUTED, "code", why=why)
    return body if found.text == body.text else body.model_copy(update={"text": found.text, "markup": None})


def block_language(languages: list[str]) -> str:
    """Language of a block with networks in these: LAD and FBD blocks may have networks in SCL, not the reverse."""
    graphical = (name for name in languages if name.removeprefix("F_") in ("LAD", "FBD"))
    return next(graphical, languages[0] if languages else "")


def language_of(body: Body | None) -> str:
    """Return the language of a body as TIA Portal calls it."""
    if body is None:
        return ""
    return attributes_of(body.extension_data).get("ProgrammingLanguage") or NAMES.get(body.language, "")


def _continues(last: Fields, body: Fields) -> bool:
    """True if the networks of `body` belong to the body before it: both are LAD, or both FBD."""
    if "networks" not in last or last.keys() != body.keys():
        return False
    return all(last[key] == body[key] for key in last if key != "networks")


def _read_unit(ctx: DocumentReading, unit: etree._Element, late: Fields) -> tuple[str, Fields | SfcBody]:
    """Read ``SW.Blocks.CompileUnit``: its language and its body."""
    own: Fields = {}
    source: etree._Element | None = None
    name = ""
    holder = child_named(unit, "AttributeList")
    for child in children(holder) if holder is not None else ():
        if local(child) == "NetworkSource" and source is None:
            source = child
            for key, value in attributes(child).items():
                keep_attribute(own, f"@NetworkSource@{key}", value)
        elif local(child) == "ProgrammingLanguage" and not child.attrib and not name:
            name = child.text or ""
        elif local(child) == "ProgrammingLanguage":
            keep_element(own, child)
        elif (
            not child.attrib
            and not len(child)
            and local(child) not in own.get("extension_data", {}).get("attributes", {})
        ):
            keep_attribute(own, local(child), child.text or "")
        else:
            keep_element(own, child)
    read_objects(unit, own)
    keep_rest(own, unit)
    for key, value in attributes(unit).items():
        if key not in ("ID", "CompositionName"):
            keep_attribute(own, f"@{key}", value)
    read_comments(ctx, unit, own)
    parts = children(source) if source is not None else []
    # `written` is the digest of what was written in place of a text or body of the source: the comment keeps that, and
    # it counts only while the network was not edited
    written = own.pop(WRITTEN, None)
    if written is not None and source is not None and written != code_digest(source):
        warn_of_edit(ctx, "the text", unit)
        own.pop("text", None)
    instead = own.pop("body", None)
    if instead is not None and _is_empty(parts):
        return name, instead
    if instead is not None:
        warn_of_edit(ctx, "the body", unit)
    if parts:
        ctx.note_schema(parts[0])
    if source is None:
        keep_attribute(own, "NetworkSource", "")
    return name, _body(ctx, name, parts, own, late)


def _add_unit(
    ctx: DocumentWriting, parent: etree._Element, thing: Element, language: str
) -> tuple[etree._Element, etree._Element]:
    """Return a new compile unit with the texts of `thing`: its ``NetworkSource`` and itself."""
    unit = sub(parent, UNIT, {ID: "", "CompositionName": "CompileUnits"})
    values = sub(unit, "AttributeList")
    kept = dict(attributes_of(thing.extension_data))
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
    for element in kept_parts(ctx, thing.extension_data):
        (objects if element.get(ID) is not None else values).append(element)
    if language:
        sub(values, "ProgrammingLanguage").text = language
    write_object_text(ctx, objects, "Comment", thing.comment)
    write_object_text(ctx, objects, "Title", getattr(thing, "title", None))
    if not len(objects):
        unit.remove(objects)
    return source, unit


def _network(ctx: DocumentWriting, parent: etree._Element, body: FbdBody | LdBody, network: LogicNetwork) -> None:
    source, unit = _add_unit(ctx, parent, network, language_of(body))
    if network.nodes or (network.extension_data is not None and network.extension_data.data):
        root = ctx.root("FlgNet", "FlgNet", source)
        if any(isinstance(node, OutputVariable) for node in network.nodes):  # drawn here since the file was read
            network = network.model_copy(deep=True)
            give_types(network, ctx.types)
            put_assignments(network, ctx.types, {pou.name.casefold() for pou in ctx.project.pous})
        if isinstance(body, LdBody) and lacks_power(network):
            network = network.model_copy(deep=True)
            put_in_series(network)
        instead = write_network(ctx, root, network)
        if instead is not None:
            source.replace(root, instead)
    left = LogicNetwork(global_id=network.global_id)
    finish(ctx, unit, left, frozenset())


def _is_empty(parts: list[etree._Element]) -> bool:
    """True if nothing is programmed in a compile unit."""
    return all(local(each) in _SHELLS for part in parts for each in part.iter(etree.Element))


def _body(ctx: DocumentReading, name: str, parts: list[etree._Element], own: Fields, late: Fields) -> Fields | SfcBody:
    kind = [local(part) for part in parts]
    plain = name.removeprefix("F_")
    marks: Fields = {} if plain == name else {"extension_data": {"attributes": {"ProgrammingLanguage": name}}}
    if name == "GRAPH" and kind == ["Graph"]:
        return _chart(ctx, parts[0], own, late)
    if plain in ("LAD", "FBD") and kind in ([], ["FlgNet"]):
        try:
            network = read_network(ctx, parts[0]) if parts else {"nodes": []}
        except NotUnderstoodError as error:
            report_network(ctx, error, parts[0])
        else:
            return {"language": LANGUAGES[plain], "networks": [merge_fields(network, own)], **marks}
    elif name == "SCL" and kind in ([], ["StructuredText"]):
        try:
            names = InterfaceNames(ctx.types, ctx.constants)
            return {"language": "ST", **merge_fields(read_code(parts[0], names) if parts else {}, own)}
        except NotUnderstoodError:
            pass
    keep_attribute(own, "ProgrammingLanguage", name)
    return {**opaque_body(*parts), **own}


def _chart(ctx: DocumentReading, element: etree._Element, own: Fields, late: Fields) -> SfcBody:
    place, types, constants = list(ctx.place), ctx.types, ctx.constants

    def read() -> SfcNetwork:
        outer, ctx.place = ctx.place, place
        others = ctx.types, ctx.constants
        ctx.types, ctx.constants = types, constants
        try:
            chart = read_model(ctx, element, SfcNetwork, lambda ctx, element: read_graph(ctx, element, late))
        finally:
            ctx.place, (ctx.types, ctx.constants) = outer, others
        if not ctx.of_tia:
            exchange_markup(chart, Markup.SIMATICML, Markup.TC6)
        return chart

    return SfcBody.model_validate({**own, "chart": read_later(SfcNetwork, {}, read)})
