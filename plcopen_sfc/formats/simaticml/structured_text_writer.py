"""Writes SCL as the tokens of ``StructuredText``. The reader is `structured_text`."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.simaticml.reading import NotUnderstoodError
from plcopen_sfc.formats.simaticml.structured_text import scl_text
from plcopen_sfc.formats.simaticml.versions import concrete
from plcopen_sfc.formats.simaticml.writing import WriteContext, add_element
from plcopen_sfc.formats.xml.carrying import legal
from plcopen_sfc.model.body import StBody


def write_code(ctx: WriteContext, source: etree._Element, body: StBody) -> None:
    """Write a body into ``NetworkSource``: with its tokens as long as they say the same."""
    if body.markup is not None and _text_of(ctx, body.markup) == body.text:
        add_element(ctx, source, body.markup)
    elif body.text:
        write_text(ctx.root("StructuredText", "StructuredText", source), legal(body.text))


def _text_of(ctx: WriteContext, markup: str) -> str | None:
    try:
        return scl_text(etree.fromstring(concrete(markup, ctx.schemas)))
    except (NotUnderstoodError, etree.XMLSyntaxError):
        return None


def write_text(root: etree._Element, text: str) -> None:
    """Fill ``StructuredText`` with the tokens of `text`."""
    raise NotImplementedError
