"""Equality of networks, however they are drawn.

Formats draw differently: some keep positions and some do not, and an operand is an element or belongs to the pin that
it is wired to.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from plcopen_sfc.languages.networks.network_reading import network_statements
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import LogicNetwork, Node
from plcopen_sfc.model.project import Project

_ANNOTATIONS = ("extension_data", "global_id", "comment")
"""Fields of elements that nothing executes."""


@contextmanager
def same_drawings(project: Project, other: Project) -> Iterator[None]:
    """Let networks in `other` have the drawings of those in `project` that mean the same, as long as this is open."""
    replaced: list[tuple[LogicNetwork, list[Node]]] = []
    pairs = zip(project.bodies(), other.bodies(), strict=False)  # a body may be missing in one: its drawing stays
    for body, found in ((body, found) for (name, _, body), (other_name, _, found) in pairs if name == other_name):
        if not isinstance(body, FbdBody | LdBody) or not isinstance(found, FbdBody | LdBody):
            continue
        if body.language == found.language and len(body.networks) == len(found.networks):
            for one, network in zip(body.networks, found.networks, strict=True):
                if one.nodes != network.nodes and mean_the_same(one, network, project.dialect):
                    replaced.append((network, network.nodes))
                    network.nodes = one.nodes
    try:
        yield
    finally:
        for network, nodes in replaced:
            network.nodes = nodes


def mean_the_same(one: LogicNetwork, other: LogicNetwork, dialect: Dialect) -> bool:
    """True if two networks have the same statements and texts; False also where one cannot be read completely."""
    mine, theirs = (_comparable(network, dialect) for network in (one, other))
    return mine is not None and mine == theirs


def _comparable(network: LogicNetwork, dialect: Dialect) -> Any:
    """Return what is compared of a network; None where it cannot be read completely."""
    found = network_statements([network], dialect)
    if not found.complete or found.open_ends:
        return None
    texts = sorted(text for _, text in found.comments)
    annotations = sorted(map(repr, _annotations(network.nodes)))
    return print_node(found.tree, dialect), found.helpers, dict(found.instances), texts, annotations


def _annotations(thing: Any) -> Iterator[Any]:
    """Yield the values of the fields that nothing executes, of all elements."""
    if isinstance(thing, list):
        for item in thing:
            yield from _annotations(item)
    elif isinstance(thing, Model):
        for name, value in thing.__dict__.items():
            if name not in _ANNOTATIONS:
                yield from _annotations(value)
            elif value is not None:
                yield value
