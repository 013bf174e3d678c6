"""Going through a tree, and making a changed one of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from functools import partial
from operator import is_not
from typing import Any, TypeVar, cast

from plcopen_sfc.languages.st.nodes import Name, Node, Parenthesized

AnyNode = TypeVar("AnyNode", bound=Node)


_PARTS: dict[type[Node], tuple[str, ...]] = {}


def parts(kind: type[Node]) -> tuple[str, ...]:
    """Return the names of the fields that hold the content of a node: all but its span."""
    names = _PARTS.get(kind)
    if names is None:
        names = _PARTS[kind] = tuple(field.name for field in fields(kind) if field.name != "span")
    return names


def children(node: Node) -> Iterator[Node]:
    """Yield the nodes directly inside `node`, field by field."""
    for name in parts(type(node)):
        value = getattr(node, name)
        if isinstance(value, Node):
            yield value
        elif isinstance(value, tuple):
            yield from (item for item in value if isinstance(item, Node))


def walk(node: Node) -> Iterator[Node]:
    """`node` and all nodes inside it, outer ones first."""
    waiting = [node]
    while waiting:
        found = waiting.pop()
        yield found
        inner: list[Node] = []
        for name in parts(type(found)):  # as `children` does, without a generator for each node
            value = getattr(found, name)
            if isinstance(value, Node):
                inner.append(value)
            elif isinstance(value, tuple):
                inner += [item for item in value if isinstance(item, Node)]
        inner.reverse()
        waiting += inner


def names_of(node: Node) -> frozenset[str]:
    """Return the names in a tree, in lower case, those of members and parameters too."""
    return frozenset([found.identifier.casefold() for found in walk(node) if isinstance(found, Name)])


def transform(node: AnyNode, change: Callable[[Node], Node]) -> AnyNode:
    """Return the tree in which `change` has been applied to every node, inner ones first.

    Where `change` gives back what it got, nodes stay the same objects, so that `render` finds what is new.
    """
    # no function that calls itself by a name of this one: each would wait for the collector of garbage
    return cast("AnyNode", change(with_children(node, partial(transform, change=change))))


def with_children(node: AnyNode, change: Callable[[Node], Node]) -> AnyNode:
    """Return a node with `change` applied to those directly inside it; itself where that changes none of them."""
    new: dict[str, Any] = {}
    for name in parts(type(node)):
        value = getattr(node, name)
        if isinstance(value, Node):
            changed = change(value)
            if changed is not value:
                new[name] = changed
        elif isinstance(value, tuple):
            members = tuple(change(item) if isinstance(item, Node) else item for item in value)
            if any(a is not b for a, b in zip(members, value, strict=True)):
                new[name] = members
    return replace(node, **new) if new else node


def with_statements(node: AnyNode, change: Callable[[tuple[Any, ...]], tuple[Any, ...]]) -> AnyNode:
    """Return a node with `change` applied to the lists of statements in it; itself where none is another then."""
    new: dict[str, Any] = {}
    for name in ("statements", "otherwise"):
        found = getattr(node, name, None)
        if found:
            changed = change(found)
            if len(changed) != len(found) or any(map(is_not, changed, found)):
                new[name] = changed
    return replace(node, **new) if new else node


def without_parentheses(node: AnyNode) -> AnyNode:
    """Return the tree without written parentheses. It means the same: its structure already has the precedence."""
    return transform(node, lambda found: found.inner if isinstance(found, Parenthesized) else found)
