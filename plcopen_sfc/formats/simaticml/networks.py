"""One network of LAD or FBD: read with what our writer would write otherwise, and written back."""

from __future__ import annotations

from xml.etree import ElementTree as ET

from lxml import etree

from plcopen_sfc.formats.simaticml.hints import operand_hints
from plcopen_sfc.formats.simaticml.light import is_complete, light, text_of
from plcopen_sfc.formats.simaticml.likeness import numbers_like
from plcopen_sfc.formats.simaticml.networks_reader import DamagedError, read_flgnet
from plcopen_sfc.formats.simaticml.networks_writer import write_flgnet
from plcopen_sfc.formats.simaticml.reading import (
    Fields,
    NotUnderstoodError,
    ReadContext,
    XmlNode,
    carried,
    carry_attribute,
    child_named,
    keep_verbatim,
    opaque,
    read_comments,
)
from plcopen_sfc.formats.simaticml.uids import NUMBERS, numbers_of, shortened
from plcopen_sfc.formats.simaticml.writing import WriteContext, add_element, keep_fields, sub, verbatim
from plcopen_sfc.model.body import Body, FbdBody, LdBody, OpaqueBody
from plcopen_sfc.model.network import LogicNetwork
from plcopen_sfc.report import Fate

_LANGUAGES = {"LAD": "LD", "FBD": "FBD"}
_NAMES = {language: name for name, language in _LANGUAGES.items()}


def read_network(ctx: ReadContext, element: etree._Element) -> Fields:
    """The fields of a `LogicNetwork`. Raises `NotUnderstoodError` where the model cannot say all of it.

    What our writer would write otherwise is kept as it stands beside it.
    """
    text = text_of(element)
    net = light(text)
    texts: dict[str, str] = {}
    fields: Fields = {"nodes": read_flgnet(net, texts)}
    read_comments(ctx, element, fields)
    if fields.get("nodes") and child_named(net, "Wires") is None:
        return fields  # from a comment
    if not fields["nodes"]:
        keep_verbatim(fields, element)
        return fields
    kept = _beside(net, fields, operand_hints(net, texts)) if is_complete(text) else None
    if kept is None:
        fields.pop("carried", None)
        keep_verbatim(fields, element)
    elif kept:
        carried(fields)["attributes"].update(kept)
    return fields


def _beside(net: XmlNode, fields: Fields, hints: dict[str, str]) -> dict[str, str] | None:
    """What must be carried beside `fields`, so that `net` is written from them; None where that cannot be."""
    if net.attrib:
        return None
    copy = ET.Element(str(net.tag))
    try:
        matter = write_flgnet(copy, LogicNetwork.model_validate({**fields, "carried": {"attributes": hints}}))
    except NotUnderstoodError:
        return None
    numbers = numbers_like(net, copy)
    if numbers is None:
        return None
    short = shortened(numbers, numbers_of(copy))
    return (hints if matter else {}) | ({NUMBERS: short} if short else {})


def write_network(ctx: WriteContext, root: etree._Element, network: LogicNetwork) -> etree._Element | None:
    """Fill the ``FlgNet`` element `root`, or give the one of the file, which takes its place.

    A network that TIA Portal cannot have is carried in a comment.
    """
    kept = verbatim(ctx, network.carried)
    if kept is not None and _nodes(kept) == network.nodes:
        return kept
    try:
        write_flgnet(root, network, ctx.types)
    except NotUnderstoodError as error:
        for child in list(root):
            root.remove(child)
        sub(root, "Parts")
        ctx.note(Fate.CARRIED, "network", why=f"TIA Portal has no such element: {error}")
        nodes = network.model_dump(mode="json", exclude_none=True, include={"nodes"})
        keep_fields(root, nodes)
    return None


def _nodes(flgnet: etree._Element) -> object:
    try:
        return LogicNetwork.model_validate({"nodes": read_flgnet(flgnet)}).nodes
    except NotUnderstoodError:
        return None


def read_flgnet_body(ctx: ReadContext, owner: etree._Element) -> Fields:
    """The body of an element of GRAPH that has its language as an attribute and one ``FlgNet``, or none."""
    language = owner.get("ProgrammingLanguage", "")
    flgnet = child_named(owner, "FlgNet")
    fields: Fields = {"language": _LANGUAGES.get(language, "LD"), "networks": []}
    if language not in _LANGUAGES:
        carry_attribute(fields, "ProgrammingLanguage", language)
    if flgnet is not None:
        try:
            fields["networks"].append(read_network(ctx, flgnet))
        except NotUnderstoodError as error:
            report_network(ctx, error, flgnet)
            fields = opaque(flgnet)
            carry_attribute(fields, "ProgrammingLanguage", language)
    return fields


def report_network(ctx: ReadContext, error: NotUnderstoodError, element: etree._Element) -> None:
    """Say why a network is kept as it is and is no part of the model."""
    if isinstance(error, DamagedError):
        ctx.error("XML220", f"the network is damaged, and kept as it is: {error}", element)
    else:
        ctx.warn("XML221", f"the network is kept as it is, and not understood: {error}", element)


def write_flgnet_body(ctx: WriteContext, owner: etree._Element, body: Body) -> None:
    """Write the body of an element of GRAPH: its language and its network."""
    kept = body.carried.attributes if body.carried is not None else {}
    owner.set("ProgrammingLanguage", kept.get("ProgrammingLanguage") or _NAMES.get(body.language, "LAD"))
    if isinstance(body, OpaqueBody):
        add_element(ctx, owner, body.content)
    elif isinstance(body, FbdBody | LdBody):
        for network in body.networks[:1]:
            element = sub(owner, "FlgNet")
            instead = write_network(ctx, element, network)
            if instead is not None:
                owner.replace(element, instead)
        if len(body.networks) > 1:
            ctx.note(Fate.DROPPED, "network", why="GRAPH has one network here")
