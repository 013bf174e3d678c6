"""One network of LAD or FBD: read with the parts that our writer would write differently, and written back."""

from __future__ import annotations

import marshal
from functools import lru_cache
from typing import Any
from xml.etree import ElementTree as ET

from lxml import etree

from plcopen_sfc.formats.simaticml.element_reader import (
    DocumentReading,
    Fields,
    NotUnderstoodError,
    XmlNode,
    carried,
    carry_attribute,
    child_named,
    keep_verbatim,
    merge_fields,
    opaque_body,
    read_comments,
)
from plcopen_sfc.formats.simaticml.element_writer import DocumentWriting, add_element, keep_fields, sub, verbatim
from plcopen_sfc.formats.simaticml.flgnet_reader import DamagedError, read_flgnet
from plcopen_sfc.formats.simaticml.flgnet_writer import write_flgnet
from plcopen_sfc.formats.simaticml.network_operands import operand_hints
from plcopen_sfc.formats.simaticml.program_comparison import (
    NUMBERS,
    is_identical,
    numbers_like,
    numbers_of,
    parse_program,
    program_text,
    shortened,
)
from plcopen_sfc.model.body import Body, FbdBody, LdBody, OpaqueBody
from plcopen_sfc.model.network import CommentBox, LogicNetwork
from plcopen_sfc.report import Outcome

TEXTS = "texts"
"""The field of a network for the texts in its drawing, each with its place among the elements."""
_LANGUAGES = {"LAD": "LD", "FBD": "FBD"}
_NAMES = {language: name for name, language in _LANGUAGES.items()}


def read_network(ctx: DocumentReading, element: etree._Element) -> Fields:
    """Return the fields of a `LogicNetwork`. Raises `NotUnderstoodError` where the model cannot express all of it.

    Parts that our writer would write differently are kept besides it as they are.
    """
    text = program_text(element)
    kept: dict[str, str] | None
    if next(element.iterchildren(etree.Comment), None) is None:
        found: tuple[Fields, dict[str, str] | None] = marshal.loads(_remembered(text))  # noqa: S302  # dumped below
        fields, kept = found
    else:
        net, fields, hints = _read_text(text)
        is_empty = child_named(net, "Wires") is None
        beside: Fields = {}
        read_comments(ctx, element, beside)
        texts = beside.pop(TEXTS, [])
        if is_empty:  # one that has been programmed since counts as it is
            merge_fields(fields, beside)
        is_from_comment = bool(fields["nodes"]) and is_empty
        kept = {} if is_from_comment else _beside(net, fields, hints)
        _insert(texts, fields["nodes"])
    if kept is None:
        fields.pop("carried", None)
        keep_verbatim(fields, element)
    elif kept:
        carried(fields)["attributes"].update(kept)
    return fields


@lru_cache(maxsize=512)
def _remembered(text: bytes) -> bytes:
    """Fields of a network and the result of `_beside`, as bytes: many are equal, each gets its own objects."""
    net, fields, hints = _read_text(text)
    return marshal.dumps((fields, _beside(net, fields, hints)))


def _read_text(text: bytes) -> tuple[XmlNode, Fields, dict[str, str]]:
    """Return the elements of a network, its fields, and the hints of its operands."""
    net = parse_program(text)
    texts: dict[str, str] = {}
    nodes = read_flgnet(net, texts)
    return net, {"nodes": nodes}, operand_hints(net, texts)


def _insert(texts: list[Any], nodes: list[Fields]) -> None:
    """Put the texts in a drawing back to their places among its elements."""
    for place, text in texts:
        used = {node["id"] for node in nodes}
        number = text["id"] if text["id"] not in used else max(used) + 1
        nodes.insert(place, {**text, "id": number})


def _beside(net: XmlNode, fields: Fields, hints: dict[str, str]) -> dict[str, str] | None:
    """Return the extension data besides `fields` from which `net` is written again; None where that is impossible."""
    if net.attrib or not fields["nodes"]:
        return None
    copy = ET.Element(str(net.tag))
    try:
        matter = write_flgnet(copy, LogicNetwork.model_validate({**fields, "carried": {"attributes": hints}}))
    except NotUnderstoodError:
        return None
    kept = hints if matter else {}  # hints that agree with the usual form need not be kept
    if is_identical(net, copy):
        return kept
    numbers = numbers_like(net, copy)
    if numbers is None:
        return None
    short = shortened(numbers, numbers_of(copy))
    return kept | ({NUMBERS: short} if short else {})


def write_network(ctx: DocumentWriting, root: etree._Element, network: LogicNetwork) -> etree._Element | None:
    """Fill the ``FlgNet`` element `root`, or give the one of the file, which takes its place.

    A network that TIA Portal cannot have is carried in a comment.
    """
    kept = verbatim(ctx, network.carried)
    if kept is not None and _nodes(kept) == network.nodes:
        return kept
    texts = [(at, node) for at, node in enumerate(network.nodes) if isinstance(node, CommentBox)]
    try:
        write_flgnet(root, _without_texts(network), ctx.types)
    except NotUnderstoodError as error:
        for child in list(root):
            root.remove(child)
        sub(root, "Parts")
        why = f"TIA Portal has no such element: {error}; the network is empty there"
        ctx.note(Outcome.NOT_EXECUTED, "network", why=why)
        nodes = network.model_dump(mode="json", exclude_none=True, include={"nodes"})
        keep_fields(root, nodes)
    else:
        if texts:
            dumped = [[at, node.model_dump(mode="json", exclude_none=True)] for at, node in texts]
            keep_fields(root, {TEXTS: dumped})
            ctx.note(Outcome.EXTENSION_DATA, "comment", why="TIA Portal draws no texts in networks")
    return None


def _without_texts(network: LogicNetwork) -> LogicNetwork:
    """The elements of a network that do something."""
    nodes = [node for node in network.nodes if not isinstance(node, CommentBox)]
    return network if len(nodes) == len(network.nodes) else network.model_copy(update={"nodes": nodes})


def has_all_elements(ctx: DocumentWriting, body: FbdBody | LdBody) -> bool:
    """True if TIA Portal has all elements of the networks of a body."""
    try:
        for network in body.networks:
            write_flgnet(etree.Element("FlgNet"), _without_texts(network), ctx.types)
    except NotUnderstoodError:
        return False
    return True


def _nodes(flgnet: etree._Element) -> object:
    try:
        return LogicNetwork.model_validate({"nodes": read_flgnet(flgnet)}).nodes
    except NotUnderstoodError:
        return None


def read_flgnet_body(ctx: DocumentReading, owner: etree._Element) -> Fields:
    """Return the body of an element of GRAPH that has its language as an attribute and one ``FlgNet``, or none."""
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
            fields = opaque_body(flgnet)
            carry_attribute(fields, "ProgrammingLanguage", language)
    return fields


def report_network(ctx: DocumentReading, error: NotUnderstoodError, element: etree._Element) -> None:
    """Report why a network is kept as it is and is no part of the model."""
    if isinstance(error, DamagedError):
        ctx.error("XML220", f"the network is damaged, and kept as it is: {error}", element)
    else:
        ctx.warn("XML221", f"the network is kept as it is, and not understood: {error}", element)


def write_flgnet_body(ctx: DocumentWriting, owner: etree._Element, body: Body) -> None:
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
            ctx.note(Outcome.NOT_EXECUTED, "network", why="GRAPH has one network here")
