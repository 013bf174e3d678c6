"""Reads compile units, the networks of a code block. The writer is `bodies_writer`.

TIA Portal divides every block into networks, each in a language of its own. Networks of LAD or FBD that follow each
other are one body.
"""

from __future__ import annotations

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.errors import Location, StructureError
from plcopen_sfc.formats.provenance import read_later
from plcopen_sfc.formats.simaticml.graph_reader import read_graph
from plcopen_sfc.formats.simaticml.networks import read_network, report_network
from plcopen_sfc.formats.simaticml.reading import (
    Fields,
    NotUnderstoodError,
    ReadContext,
    attributes,
    carry_attribute,
    carry_element,
    carry_rest,
    child_named,
    children,
    local,
    opaque,
    read_comments,
    read_model,
    read_object_text,
)
from plcopen_sfc.formats.simaticml.rewritten import warn_of_edit
from plcopen_sfc.formats.simaticml.structured_text_writer import Names, read_code
from plcopen_sfc.formats.xml.extension_data import Markup, exchange
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.sfc import SfcNetwork

LANGUAGES = {"LAD": "LD", "FBD": "FBD", "SCL": "ST", "GRAPH": "SFC"}
NAMES = {language: name for name, language in LANGUAGES.items()}


def read_units(ctx: ReadContext, units: list[etree._Element], late: Fields) -> tuple[list[Fields | SfcBody], str]:
    """The bodies of a block, and the language that the block has by them. `late` is what it says of its chart."""
    bodies: list[Fields | SfcBody] = []
    languages: list[str] = []
    for unit in units:
        name, body = _unit(ctx, unit, late)
        languages.append(name)
        last = bodies[-1] if bodies else None
        if isinstance(last, dict) and isinstance(body, dict) and _continues(last, body):
            last["networks"].extend(body["networks"])
        else:
            bodies.append(body)
    return bodies, block_language(languages)


def block_language(languages: list[str]) -> str:
    """The language of a block with networks in these: LAD and FBD blocks may have networks in SCL, not the reverse."""
    graphical = (name for name in languages if name.removeprefix("F_") in ("LAD", "FBD"))
    return next(graphical, languages[0] if languages else "")


def _continues(last: Fields, body: Fields) -> bool:
    """Whether the networks of `body` belong to the body before it: both are LAD, or both FBD."""
    if "networks" not in last or last.keys() != body.keys():
        return False
    return all(last[key] == body[key] for key in last if key != "networks")


def _unit(ctx: ReadContext, unit: etree._Element, late: Fields) -> tuple[str, Fields | SfcBody]:
    """Read ``SW.Blocks.CompileUnit``: its language and its body."""
    own: Fields = {}
    source: etree._Element | None = None
    name = ""
    holder = child_named(unit, "AttributeList")
    for child in children(holder) if holder is not None else ():
        if local(child) == "NetworkSource" and source is None:
            source = child
            for key, value in attributes(child).items():
                carry_attribute(own, f"@NetworkSource@{key}", value)
        elif local(child) == "ProgrammingLanguage" and not child.attrib and not name:
            name = child.text or ""
        elif local(child) == "ProgrammingLanguage":
            carry_element(own, child)
        elif not child.attrib and not len(child) and local(child) not in own.get("carried", {}).get("attributes", {}):
            carry_attribute(own, local(child), child.text or "")
        else:
            carry_element(own, child)
    holder = child_named(unit, "ObjectList")
    for child in children(holder) if holder is not None else ():
        field = {"Title": "title", "Comment": "comment"}.get(child.get("CompositionName", ""), "")
        text = read_object_text(child) if local(child) == "MultilingualText" and field and field not in own else None
        if text is not None:
            own[field] = text
        else:
            carry_element(own, child)
    carry_rest(own, unit)
    for key, value in attributes(unit).items():
        if key not in ("ID", "CompositionName"):
            carry_attribute(own, f"@{key}", value)
    read_comments(ctx, unit, own)
    parts = children(source) if source is not None else []
    instead = own.pop("body", None)
    if instead is not None and _is_empty(parts):
        return name, instead
    if instead is not None:
        warn_of_edit(ctx, "the body", unit)
    if parts:
        ctx.note_schema(parts[0])
    if source is None:
        carry_attribute(own, "NetworkSource", "")
    return name, _body(ctx, name, parts, own, late)


def _is_empty(parts: list[etree._Element]) -> bool:
    """True if nothing is programmed in a compile unit."""
    return all(local(each) in _SHELLS for part in parts for each in part.iter(etree.Element))


_SHELLS = ("FlgNet", "Parts", "Wires", "StructuredText")


def _body(ctx: ReadContext, name: str, parts: list[etree._Element], own: Fields, late: Fields) -> Fields | SfcBody:
    kind = [local(part) for part in parts]
    plain = name.removeprefix("F_")
    marks: Fields = {} if plain == name else {"carried": {"attributes": {"ProgrammingLanguage": name}}}
    if name == "GRAPH" and kind == ["Graph"]:
        return _chart(ctx, parts[0], own, late)
    if plain in ("LAD", "FBD") and kind in ([], ["FlgNet"]):
        try:
            network = read_network(ctx, parts[0]) if parts else {"nodes": []}
        except NotUnderstoodError as error:
            report_network(ctx, error, parts[0])
        else:
            return {"language": LANGUAGES[plain], "networks": [_merged(network, own)], **marks}
    elif name == "SCL" and kind in ([], ["StructuredText"]):
        try:
            names = Names(ctx.types, ctx.constants)
            return {"language": "ST", **_merged(read_code(parts[0], names) if parts else {}, own)}
        except NotUnderstoodError:
            pass
    carry_attribute(own, "ProgrammingLanguage", name)
    return {**opaque(*parts), **own}


def _merged(fields: Fields, own: Fields) -> Fields:
    """What was read of a program and what its compile unit says, in one."""
    merged = {**fields, **own}
    if "carried" in fields and "carried" in own:
        one, other = fields["carried"], own["carried"]
        merged["carried"] = {
            "data": [*one.get("data", []), *other.get("data", [])],
            "attributes": {**one.get("attributes", {}), **other.get("attributes", {})},
            "elements": [*one.get("elements", []), *other.get("elements", [])],
        }
    return merged


def _chart(ctx: ReadContext, element: etree._Element, own: Fields, late: Fields) -> SfcBody:
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
            exchange(chart, Markup.SIMATICML, Markup.TC6)
        return chart

    return SfcBody.model_validate({**own, "chart": read_later(SfcNetwork, {}, read)})


def misfit(error: ValidationError, file: str | None) -> StructureError:
    """What to say where carried data, which anybody may have edited, does not fit the model."""
    first = error.errors()[0]
    path = ".".join(map(str, first["loc"]))
    return StructureError(f"carried data does not fit the model at {path}: {first['msg']}", location=Location(file))
