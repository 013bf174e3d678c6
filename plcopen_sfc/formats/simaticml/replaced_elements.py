"""Elements in place of source content that TIA Portal has in another form, and edits of them since.

A comment keeps the source beside an element that expresses it in another way, with a digest of its meaning. TIA Portal
imports no comments, but a file may be edited and keep them: after an edit the element counts, with a warning.
Numbers, blanks and the order of the elements of a network mean nothing.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Container, Iterable, Set
from typing import Any

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.formats.simaticml.element_reader import (
    DocumentReading,
    Fields,
    NotUnderstoodError,
    XmlNode,
    child_named,
    children,
    local,
)
from plcopen_sfc.formats.simaticml.flgnet_reader import read_flgnet
from plcopen_sfc.formats.simaticml.program_comparison import UID
from plcopen_sfc.formats.simaticml.row_tokens import row_fields
from plcopen_sfc.formats.xml.extension_data import attributes
from plcopen_sfc.languages.networks import condition_reader
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import LogicNetwork
from plcopen_sfc.model.sfc import BodyCondition, SfcNetwork

WRITTEN = "written"
"""Field in our comments that holds the digest. Files of older versions of this package have none."""
INSTEAD = "instead"
"""Field in our comments that holds the fields of a step which its rows express in another way."""


def condition_digest(element: etree._Element, result: str) -> str:
    """Return the digest of the network of a transition, interlock or supervision, which ends in the coil `result`."""
    network = child_named(element, "FlgNet")
    if network is None:
        return _digest([])
    return _digest(_expression(element, network, result) or _structure(network))


def rows_digest(actions: etree._Element) -> str:
    """Return the digest of the rows of a step; the empty row at the end does not count."""
    rows = [row for row in children(actions) if local(row) == "Action" and (len(row) or row.attrib)]
    return _digest([row_fields(row) for row in rows])


def chart_digest(graph: etree._Element) -> str:
    """Return the digest of a whole ``Graph``."""
    return _digest(_structure(graph))


def code_digest(source: etree._Element) -> str:
    """Return the digest of a text in SCL in a ``NetworkSource``; blanks between its tokens do not count."""
    code = [each for each in _structure(source) if each[0] not in ("Blank", "NewLine")]
    return _digest(code[1:])


def member_digests(element: etree._Element) -> dict[str, str]:
    """Return the digests of the type and of the start value of a member, by the fields that hold them."""
    starts: list[Any] = []
    for value in element.iter("{*}StartValue"):
        owners = value.iterancestors("{*}Member", "{*}Subelement")
        starts.append([value.text, *(owner.get("Name") or owner.get("Path") for owner in owners)])
    return {"type": _digest(element.get("Datatype", "")), "initial": _digest(starts)}


def interface_digest(element: etree._Element) -> str:
    """Return the digest of the members of a data type."""
    return _digest(_structure(element))


def warn_of_edit(ctx: DocumentReading, what: str, element: etree._Element) -> None:
    """Warn that a comment keeps something of the source which does not count any more."""
    ctx.warn(
        "XML214", f"what a comment keeps of {what} is outdated: it was edited in this file; the edit counts", element
    )


def counting_fields(ctx: DocumentReading, kept: Fields, digests: dict[str, str], element: etree._Element) -> Fields:
    """Fields in a comment at `element` without those whose native form was edited. `digests`: the present ones."""
    written = kept.pop(WRITTEN, None)
    if not isinstance(written, dict):
        return kept
    edited = [name for name, digest in digests.items() if name in kept and written.get(name) != digest]
    has_start = next(element.iter("{*}StartValue"), None) is not None
    if "type" in kept and "type" not in edited:
        # the values of its enumeration are others in this file, or without a start value it would be that of the type
        without = "initial" in edited and not has_start
        if without or not ctx.edited_copies.isdisjoint(_named_in(kept["type"], ctx.place)):
            edited.append("type")
    if "type" in edited and "initial" not in edited and "initial" in kept:
        edited.append("initial")  # a value of a type that the variable no longer has
    for name in edited:
        warn_of_edit(ctx, f"the {_SHOWN[name]} of {element.get('Name') or 'the data type'}", element)
    return {name: value for name, value in kept.items() if name not in edited}


def _named_in(type_: Any, place: list[str]) -> set[str]:
    """Types that a kept type is made of, in lower case; an enumeration is named after the `place` that has it."""
    if not isinstance(type_, dict):
        return set()
    names = {str(type_.get("name", "")).casefold()}
    if type_.get("kind") == "enum" and place:
        names.add(place[-1].partition(" ")[2].casefold())
    return names.union(*(_named_in(inner, place) for inner in type_.values()))


_SHOWN = {"type": "type", "initial": "start value"}


def edited_fields(kept: Fields, actions: etree._Element, copies: Set[str]) -> list[str]:
    """Return the fields of a step of which the rows count, as they are no longer as they were written.

    `kept`: the fields in the comment at the rows. `copies`: added objects that were edited; a row may call one.
    """
    fields = kept.get(INSTEAD)
    is_edited = kept.get(WRITTEN) != rows_digest(actions) or is_calling(actions, copies)
    return fields if isinstance(fields, list) and is_edited else []


def is_calling(element: etree._Element, names: Set[str]) -> bool:
    """True if rows in an element name one of these objects."""
    words = {token.get("Text", "").strip('"').casefold() for token in element.iter("{*}Token")}
    return not words.isdisjoint(names)


def forget_edited_exclusions(
    chart: Fields,
    excluded: dict[int, Fields],
    networks: dict[int, Fields],
    sourced: Container[int],
    edited: Iterable[int],
) -> list[int]:
    """Take the steps of the file that were excluded and have been programmed since. Returns their ids.

    `excluded`: these steps as the file has them, by id. `networks` and `sourced` are as in `forget_edited_times`;
    networks that count are taken out of the former. `edited`: the steps whose rows were edited.
    """
    waiting = [number for number in excluded if number in set(edited)]
    found: list[int] = []
    # a network that counts ends the exclusion of all steps that its transition leaves, and these have other transitions
    while True:
        for transition in chart["transitions"]:
            if transition["id"] in sourced and transition["id"] not in networks:
                waiting += [number for number in transition.get("sources", ()) if number in excluded]
        waiting = [number for number in dict.fromkeys(waiting) if number not in found]
        if not waiting:
            return found
        for place, step in enumerate(chart["steps"]):
            if step["id"] in waiting:
                chart["steps"][place] = excluded[step["id"]]
        for transition in chart["transitions"]:
            if transition["id"] in networks and not set(waiting).isdisjoint(transition.get("sources", ())):
                transition["condition"] = networks.pop(transition["id"])
        found += waiting


def forget_edited_times(chart: Fields, networks: dict[int, Fields], sourced: Container[int]) -> list[int]:
    """Drop the minimum times of steps that a transition no longer waits for: its networks count then.

    `networks`: the conditions as the file has them, by the ids of the transitions whose source is kept instead.
    `sourced`: the transitions of which a condition is kept at all; where none leaves a step, its time is kept beside it
    only. Returns the ids of the steps.
    """
    left = dict(networks)
    dropped: list[int] = []
    found = True
    while found:  # a network that counts waits for no step, which may end the time of another source of its transition
        found = False
        for step in (step for step in chart["steps"] if step.get("min_time") is not None):
            leaving = [each for each in chart["transitions"] if step["id"] in each.get("sources", ())]
            if all(each["id"] in left for each in leaving) or not any(each["id"] in sourced for each in leaving):
                continue
            found = True
            step["min_time"] = None
            dropped.append(step["id"])
            for transition in leaving:
                if transition["id"] in left:
                    transition["condition"] = left.pop(transition["id"])
    return dropped


def _expression(element: etree._Element, network: etree._Element, result: str) -> str | None:
    """Return the expression of a network; None where it holds more, or something that is not understood."""
    try:
        networks = [LogicNetwork.model_validate({"nodes": read_flgnet(network)})]
    except (NotUnderstoodError, ValidationError):
        return None
    is_ladder = element.get("ProgrammingLanguage") == "LAD"
    body = LdBody(networks=networks) if is_ladder else FbdBody(networks=networks)
    read = condition_reader(SfcNetwork(), Dialect.SCL)(BodyCondition(name=result, body=body))
    if read.tree is None or read.obstacles or read.before:
        return None
    return print_node(read.tree)


def _structure(network: XmlNode) -> list[Any]:
    """Return the elements of a network, numbered in the order in which they come."""
    numbers: dict[str, int] = {}
    found: list[Any] = []
    for each in network.iter():
        if local(each):
            marks = attributes(each)
            number = numbers.setdefault(marks.pop(UID), len(numbers)) if UID in marks else None
            inner = children(each)
            found.append([local(each), len(inner), number, sorted(marks.items()), "" if inner else each.text or ""])
    return found


def _digest(content: Any) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]
