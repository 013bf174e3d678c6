"""Turns the elements of a SimaticML ``StructuredText`` back into the text that TIA Portal shows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lxml import etree


def scl_text(structured: Any) -> str:
    """The SCL of a ``StructuredText`` element (SW.Blocks of TIA Openness, versions 2 to 4)."""
    return _children(structured)


def _children(element: Any) -> str:
    return "".join(_WRITERS[etree.QName(child).localname](child) for child in element.iterchildren("{*}*"))


def _inner(element: Any) -> str:
    return element.text or ""


def _access(access: Any) -> str:
    symbol = access.find("{*}Symbol")
    scope = access.get("Scope")
    if symbol is None:
        return _children(access)
    first = symbol.find("{*}Component")
    prefix = "#" if scope == "LocalVariable" else ""
    is_global = scope == "GlobalVariable" and first is not None
    return prefix + "".join(
        _component(part, quoted=is_global and part is first) if part is first else _any(part)
        for part in symbol.iterchildren("{*}*")
    )


def _any(element: Any) -> str:
    return _WRITERS[etree.QName(element).localname](element)


def _component(component: Any, *, quoted: bool = False) -> str:
    quotes = component.find("{*}BooleanAttribute[@Name='HasQuotes']")
    if quotes is not None:
        quoted = _inner(quotes) == "true"
    name = component.get("Name")
    return (f'"{name}"' if quoted else name) + _children(component)


def _constant(constant: Any) -> str:
    name = constant.get("Name")
    return f"#{name}" if name else _children(constant)


def _line_comment(comment: Any) -> str:
    return "//" + "".join(_inner(text) for text in comment.iterchildren("{*}Text"))


def _comment(comment: Any) -> str:
    texts = comment.iter("{*}Text")
    return "(*" + _inner(next(texts, comment)) + "*)"


def _named(element: Any) -> str:
    return (element.get("Name") or "") + _children(element)


def _nothing(_: Any) -> str:
    return ""


_WRITERS: dict[str, Callable[[Any], str]] = {
    "Access": _access,
    "Token": lambda token: token.get("Text"),
    "Text": _inner,
    "Blank": lambda blank: " " * int(blank.get("Num") or 1),
    "NewLine": lambda line: "\n" * int(line.get("Num") or 1),
    "LineComment": _line_comment,
    "Comment": _comment,
    "Symbol": _children,
    "Component": _component,
    "Constant": _constant,
    "ConstantType": _nothing,
    "ConstantValue": _inner,
    "Instruction": _named,
    "CallInfo": _named,
    "Instance": _children,
    "Parameter": _named,
    "NamelessParameter": _children,
    "TemplateValue": _nothing,
    "BooleanAttribute": _nothing,
    "IntegerAttribute": _nothing,
    "StringAttribute": _nothing,
    "Label": _named,
}
