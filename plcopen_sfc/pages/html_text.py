"""HTML: elements whose content is escaped unless it is HTML already, and the document around them.

A document is one file in ASCII that loads nothing. Its Content-Security-Policy allows the one style sheet and the one
script of this package, by their hashes, and nothing else: what a file brings along is text and stays text.
"""

from __future__ import annotations

import json
import re
from base64 import b64encode
from functools import cache
from hashlib import sha256
from importlib import resources
from typing import Any

from plcopen_sfc.drawing.pictures import Theme, escape, style_rules
from plcopen_sfc.pages.page_words import Words

_EMPTY = frozenset({"meta", "input", "br"})
"""Elements without content and end tag."""


class Html(str):
    """Text that is HTML already: it is not escaped again."""

    __slots__ = ()


def element(name: str, /, *content: str, **attributes: str | bool) -> Html:
    """Return an element with its content, which is escaped where it is no `Html`.

    Attributes are written in their order, ``data_name`` as ``data-name`` and ``class_`` as ``class``; those that are
    empty or False are left out, True has no value.
    """
    parts = [name]
    for key, value in attributes.items():
        label = key.rstrip("_").replace("_", "-")
        if value is True:
            parts.append(label)
        elif value:
            parts.append(f'{label}="{escape(str(value))}"')
    start = f"<{' '.join(parts)}>"
    return Html(start if name in _EMPTY else f"{start}{joined(*content)}</{name}>")


def joined(*content: str) -> Html:
    """Return contents after each other, escaped where they are no `Html`."""
    return Html("".join(each if isinstance(each, Html) else escape(each) for each in content))


def link(anchor: str, *content: str, class_: str = "") -> Html:
    """Return a link to an element of the same page; without an `anchor` the content alone."""
    return element("a", *content, href=f"#{anchor}", class_=class_) if anchor else joined(*content)


def data_element(identifier: str, data: Any) -> Html:
    """Return `data` for the script of the page, as JSON that no browser takes for a script or for a tag."""
    text = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c").replace(">", "\\u003e")
    return element("script", Html(text.replace("&", "\\u0026")), type="application/json", id=identifier)


def with_code(text: str) -> Html:
    """Return a message in which what is between backticks is code."""
    parts = text.split("`")
    if not len(parts) % 2:
        return joined(text)
    return joined(*(element("code", part) if number % 2 else part for number, part in enumerate(parts)))


def document(title: str, words: Words, tree: Html, *content: Html, wide: bool = False) -> str:
    """Return a whole page: a head line with the search, the `tree` of what is in it beside the content.

    `wide`: the content needs the whole width, and the tree is a line above it.
    """
    style, script = _style(), _text("page.js")
    policy = f"default-src 'none'; style-src '{_hash(style)}'; script-src '{_hash(script)}'; base-uri 'none'; "
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=policy + "form-action 'none'"),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("title", title),
        element("style", Html(style)),
    )
    search = element(
        "div",
        element("input", type="search", id="search", placeholder=words("Search (key /)"), aria_label=words("Search")),
        element("ul", id="found", data_nothing=words("nothing found")),
        class_="search",
        hidden=True,
    )
    contents = element("details", element("summary", words("Contents")), tree, open=True, id="contents")
    body = element(
        "body",
        element("header", element("strong", title), search),
        element("nav", contents, aria_label=words("Contents")),
        element("main", *content),
        element("script", Html(script)),
        class_="wide" if wide else "",
    )
    return "<!DOCTYPE html>\n" + element("html", head, "\n", body, lang=words.lang) + "\n"


def picture_figure(picture: str, words: Words, caption: str = "") -> Html:
    """Return a picture in its size, to be scrolled, or in the width of the page: a button changes between them.

    A picture with a `caption` is set beside another one: both begin smaller, and in the width that is there unless
    they are so wide that nothing could be read.
    """
    fit = element("button", words("fit / full size"), type="button", class_="fit", hidden=True)
    head = element("figcaption", caption, " ", fit) if caption else fit
    size = _SIZE.search(picture)
    fitted = is_long = False
    if size is not None:
        width, height = map(int, size.groups())
        is_long = height > _LONG * max(width, _SHEET)
    if caption and size is not None:
        width, height = (round(int(length) * _BESIDE) for length in size.groups())
        picture = _SIZE.sub(f' width="{width}" height="{height}"', picture, count=1)
        fitted = width <= _READABLE
    scroll = element("div", Html(picture), class_="scroll", tabindex="0")
    return element("figure", head, scroll, class_=" ".join(["fitted"] * fitted + ["long"] * is_long))


_SIZE = re.compile(r' width="(\d+)" height="(\d+)"')
_SHEET = 700
"""Width of a printed page, in pixels."""
_LONG = 2.5
"""A picture that is so much higher than a page is wide is printed on several: on one its letters are too small."""
_BESIDE = 0.75
"""Scale of pictures beside each other: letters of 9 pixels. The script of a page gives them the room that is there."""
_READABLE = 1_600
"""A picture that is wider, in pixels, cannot be read in the width of a screen."""


@cache
def _style() -> str:
    dark, paper = (style_rules(theme, ".sfc-picture") for theme in (Theme.DARK, Theme.PRINT))
    pictures = style_rules(Theme.LIGHT, ".sfc-picture")
    media = f"@media screen and (prefers-color-scheme:dark){{{dark}}}@media print{{{paper}}}"
    return f"{pictures}{media}\n{_text('page.css')}"


def _text(name: str) -> str:
    """Return a file of this package; CSP hashes are of the text as HTML reads it, with LF."""
    return resources.files("plcopen_sfc.pages").joinpath(name).read_text(encoding="ascii").replace("\r\n", "\n")


def _hash(text: str) -> str:
    return f"sha256-{b64encode(sha256(text.encode()).digest()).decode()}"
