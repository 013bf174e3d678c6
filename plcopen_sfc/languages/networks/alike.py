"""Comparison of two networks, however they are drawn.

Formats draw in their own ways: some have places for elements, some none; an operand is an element of its own or stands
at the pin that it is wired to.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from plcopen_sfc.languages.networks.network_reading import network_statements
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import LogicNetwork
from plcopen_sfc.model.project import Project

_BESIDE = ("carried", "global_id", "comment")
"""What elements have beside what they do."""


def take_over_drawings(project: Project, other: Project) -> None:
    """Let the networks of `other` be drawn as those of `project` where they say the same."""
    pairs = zip(project.bodies(), other.bodies(), strict=False)
    for body, found in ((body, found) for (name, _, body), (other_name, _, found) in pairs if name == other_name):
        if not isinstance(body, FbdBody | LdBody) or not isinstance(found, FbdBody | LdBody):
            continue
        if body.language == found.language and len(body.networks) == len(found.networks):
            for one, network in zip(body.networks, found.networks, strict=True):
                if one.nodes != network.nodes and say_the_same(one, network, project.dialect):
                    network.nodes = one.nodes


def say_the_same(one: LogicNetwork, other: LogicNetwork, dialect: Dialect) -> bool:
    """True if two networks mean the same statements and have the same texts; False where that cannot be told."""
    mine, theirs = (_said(network, dialect) for network in (one, other))
    return mine is not None and mine == theirs


def _said(network: LogicNetwork, dialect: Dialect) -> Any:
    found = network_statements([network], dialect)
    if not found.complete or found.open_ends:
        return None
    texts = sorted(text for _, text in found.comments)
    beside = sorted(map(repr, _beside(network.nodes)))
    return print_node(found.tree, dialect), found.helpers, dict(found.instances), texts, beside


def _beside(thing: Any) -> Iterator[Any]:
    if isinstance(thing, list):
        for item in thing:
            yield from _beside(item)
    elif isinstance(thing, Model):
        for name, value in thing.__dict__.items():
            if name not in _BESIDE:
                yield from _beside(value)
            elif value is not None:
                yield value
