"""The canonical form of XML: the same text for the same content."""

from __future__ import annotations

from collections.abc import Sequence

from lxml import etree

__all__ = ["canonical_form"]


def canonical_form(
    element: etree._Element, *, comments: bool = True, exclusive: bool = True, prefixes: Sequence[str] | None = None
) -> bytes:
    """`element` without what follows it; `prefixes` are declared even where nothing but a value uses them.

    There is no canonical form of elements in namespaces whose names are relative (``xmlns:a="b"``): they come as they
    are, with comments.
    """
    try:
        form: bytes = etree.tostring(
            element,
            method="c14n",
            exclusive=exclusive,
            with_comments=comments,
            with_tail=False,
            inclusive_ns_prefixes=prefixes or None,
        )
    except etree.C14NError:
        return etree.tostring(element, encoding="utf-8", with_tail=False)
    return form
