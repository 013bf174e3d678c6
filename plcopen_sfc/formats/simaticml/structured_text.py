"""SCL: the token form of ``StructuredText``, and the text that people read and write."""

from __future__ import annotations

from collections.abc import Callable

from lxml import etree

from plcopen_sfc.formats.simaticml.operands import read_address
from plcopen_sfc.formats.simaticml.reading import NotUnderstoodError, children, local


def scl_text(element: etree._Element) -> str:
    """The text of a ``StructuredText`` as TIA Portal shows it."""
    return _children(element)


def _children(element: etree._Element) -> str:
    return "".join(_text(child) for child in children(element))


def _text(element: etree._Element) -> str:
    writer = _WRITERS.get(local(element))
    if writer is None:
        raise NotUnderstoodError(local(element))
    return writer(element)


def _inner(element: etree._Element) -> str:
    return element.text or ""


def _access(access: etree._Element) -> str:
    symbol = next((child for child in children(access) if local(child) == "Symbol"), None)
    if symbol is None:
        return _children(access)
    return _path(symbol, access.get("Scope")) + "".join(
        _text(child) for child in children(access) if child is not symbol
    )


def _component(component: etree._Element, *, quoted: bool = False) -> str:
    marks = (child for child in children(component) if child.get("Name") == "HasQuotes")
    mark = next(marks, None)
    if mark is not None:
        quoted = _inner(mark) == "true"
    name = component.get("Name") or ""
    return (f'"{name}"' if quoted else name) + _children(component)


def _constant(constant: etree._Element) -> str:
    name = constant.get("Name")
    if not name:
        return _children(constant)
    owner = constant.getparent()
    if owner is not None and owner.get("Scope") == "GlobalConstant":
        return f'"{name}"'
    return f"#{name}"


def _line_comment(comment: etree._Element) -> str:
    if comment.get("NoClosingBracket", "false") != "false":
        raise NotUnderstoodError("a comment without its end")
    text = "".join(_inner(text) for text in children(comment) if local(text) == "Text")
    return f"(*{text}*)" if comment.get("Inserted") == "true" else f"//{text}"


def _comment(comment: etree._Element) -> str:
    texts = [text for text in children(comment) if local(text) == "MultiLanguageText"]
    if not texts or comment.get("Inserted") != "true":
        raise NotUnderstoodError("a comment without a text")
    return f"(/*{_inner(texts[0])}*/)"


def _named(element: etree._Element) -> str:
    return (element.get("Name") or "") + _children(element)


def _call(element: etree._Element) -> str:
    name = element.get("Name")
    return (f'"{name}"' if name and element.get("BlockType") else name or "") + _children(element)


def _instance(element: etree._Element) -> str:
    return _path(element, element.get("Scope"))


def _path(element: etree._Element, scope: str | None) -> str:
    text, first = "", True
    for part in children(element):
        if local(part) == "Component" and first:
            text += ("#" if scope == "LocalVariable" else "") + _component(part, quoted=scope == "GlobalVariable")
            first = False
        else:
            text += _text(part)
    return text


def _repeated(letter: str) -> Callable[[etree._Element], str]:
    def write(element: etree._Element) -> str:
        count = element.get("Num", "1")
        if not count.isdigit() or int(count) > _MOST_BLANKS:
            raise NotUnderstoodError("blanks")
        return letter * int(count)

    return write


_MOST_BLANKS = 100_000


def _address(element: etree._Element) -> str:
    return "" if element.get("Informative") == "true" else read_address(element)


def _nothing(_: etree._Element) -> str:
    return ""


_WRITERS: dict[str, Callable[[etree._Element], str]] = {
    "Access": _access,
    "Address": _address,
    "Token": lambda token: token.get("Text") or "",
    "Text": _inner,
    "Blank": _repeated(" "),
    "NewLine": _repeated("\n"),
    "LineComment": _line_comment,
    "Comment": _comment,
    "Symbol": _children,
    "Component": _component,
    "Constant": _constant,
    "ConstantType": _nothing,
    "ConstantValue": _inner,
    "Instruction": _named,
    "CallInfo": _call,
    "Instance": _instance,
    "Parameter": _named,
    "NamelessParameter": _children,
    "TemplateValue": _nothing,
    "BooleanAttribute": _nothing,
    "IntegerAttribute": _nothing,
    "StringAttribute": _nothing,
    "DateAttribute": _nothing,
    "Label": _named,
}
