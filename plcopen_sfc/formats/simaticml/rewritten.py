"""What is written instead of what the source says, and whether it is still as it was written.

A comment keeps the source beside a network or rows that say it otherwise, with a digest of what they mean. TIA Portal
imports no comments, but a file may be edited and keep them: after an edit the network and the rows count. Numbers,
blanks and the order of the elements of a network mean nothing.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Container
from typing import Any

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.formats.simaticml.actions_reader import row_fields
from plcopen_sfc.formats.simaticml.networks_reader import read_flgnet
from plcopen_sfc.formats.simaticml.reading import (
    Fields,
    NotUnderstoodError,
    XmlNode,
    attributes,
    child_named,
    children,
    local,
)
from plcopen_sfc.formats.simaticml.uids import UID
from plcopen_sfc.languages.networks import condition_reader
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.conditions import BodyCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import LogicNetwork
from plcopen_sfc.model.sfc import SfcNetwork

WRITTEN = "written"
"""The field in our comments that holds the digest. Files of older versions of this package have none."""
INSTEAD = "instead"
"""The field in our comments that holds the fields of a step which its rows say otherwise."""


def of_condition(element: etree._Element, result: str) -> str:
    """The digest of the network of a transition, interlock or supervision, which ends in the coil `result`."""
    network = child_named(element, "FlgNet")
    if network is None:
        return _digest([])
    return _digest(_expression(element, network, result) or _structure(network))


def of_rows(actions: etree._Element) -> str:
    """The digest of the rows of a step; the empty row at the end does not count."""
    rows = [row for row in children(actions) if local(row) == "Action" and (len(row) or row.attrib)]
    return _digest([row_fields(row) for row in rows])


def edited_fields(kept: Fields, actions: etree._Element) -> list[str]:
    """The fields of a step of which the rows count, as they are no longer as they were written.

    `kept`: what the comment at the rows says.
    """
    fields = kept.get(INSTEAD)
    return fields if isinstance(fields, list) and kept.get(WRITTEN) != of_rows(actions) else []


def forget_edited_times(chart: Fields, networks: dict[int, Fields], told: Container[int]) -> None:
    """Drop the minimum times of steps that a transition no longer waits for: its networks count then.

    `networks`: the conditions as the file has them, by the ids of the transitions whose source is kept instead. `told`:
    the transitions of which a condition is kept at all; where none leaves a step, its time is kept beside it only.
    """
    left = dict(networks)
    found = True
    while found:
        found = False
        for step in (step for step in chart["steps"] if step.get("min_time") is not None):
            leaving = [each for each in chart["transitions"] if step["id"] in each.get("sources", ())]
            if all(each["id"] in left for each in leaving) or not any(each["id"] in told for each in leaving):
                continue
            found = True
            step["min_time"] = None
            for transition in leaving:
                if transition["id"] in left:
                    transition["condition"] = left.pop(transition["id"])


def _expression(element: etree._Element, network: etree._Element, result: str) -> str | None:
    """The expression that a network says; None where it says more, or something that is not understood."""
    try:
        networks = [LogicNetwork.model_validate({"nodes": read_flgnet(network)})]
    except (NotUnderstoodError, ValidationError):
        return None
    is_ladder = element.get("ProgrammingLanguage") == "LAD"
    body = LdBody(networks=networks) if is_ladder else FbdBody(networks=networks)
    read = condition_reader(SfcNetwork(), Dialect.SCL)(BodyCondition(name=result, body=body))
    if read.tree is None or read.obstacles or read.before:
        return None
    return print_node(read.tree, Dialect.SCL)


def _structure(network: XmlNode) -> list[Any]:
    """The elements of a network, numbered in the order in which they come."""
    numbers: dict[str, int] = {}
    found: list[Any] = []
    for each in network.iter():
        if local(each):
            marks = attributes(each)
            number = numbers.setdefault(marks.pop(UID), len(numbers)) if UID in marks else None
            inner = children(each)
            found.append([local(each), len(inner), number, sorted(marks.items()), "" if inner else each.text or ""])
    return found


def _digest(said: Any) -> str:
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:16]
