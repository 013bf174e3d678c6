"""SCL: the token form of ``StructuredText``, and the text that people read and write."""

from __future__ import annotations

from collections.abc import Callable

from plcopen_sfc.formats.simaticml.element_reader import NotUnderstoodError, XmlNode, children, local
from plcopen_sfc.formats.simaticml.network_operands import read_address


def scl_text(element: XmlNode) -> str:
    """Return the text of a ``StructuredText`` as TIA Portal shows it."""
    return _children(element)


def _children(element: XmlNode) -> str:
    return "".join(_text(child) for child in children(element))


def _text(element: XmlNode) -> str:
    writer = _WRITERS.get(local(element))
    if writer is None:
        raise NotUnderstoodError(local(element))
    return writer(element)


def _inner(element: XmlNode) -> str:
    return element.text or ""


def _access(access: XmlNode) -> str:
    symbol = next((child for child in children(access) if local(child) == "Symbol"), None)
    if symbol is None:
        is_global = access.get("Scope") == "GlobalConstant"
        return "".join(
            _constant(child, is_global=is_global) if local(child) == "Constant" else _text(child)
            for child in children(access)
        )
    return _path(symbol, access.get("Scope")) + "".join(
        _text(child) for child in children(access) if child is not symbol
    )


def _component(component: XmlNode, *, quoted: bool = False) -> str:
    marks = (child for child in children(component) if child.get("Name") == "HasQuotes")
    mark = next(marks, None)
    if mark is not None:
        quoted = _inner(mark) == "true"
    name = component.get("Name") or ""
    return (f'"{name}"' if quoted else name) + _children(component)


def _constant(constant: XmlNode, *, is_global: bool = False) -> str:
    name = constant.get("Name")
    if not name:
        return _children(constant)
    return f'"{name}"' if is_global else f"#{name}"


def _line_comment(comment: XmlNode) -> str:
    if comment.get("NoClosingBracket", "false") != "false":
        raise NotUnderstoodError("a comment without its end")
    text = "".join(_inner(text) for text in children(comment) if local(text) == "Text")
    return f"(*{text}*)" if comment.get("Inserted") == "true" else f"//{text}"


def _comment(comment: XmlNode) -> str:
    texts = [text for text in children(comment) if local(text) == "MultiLanguageText"]
    if not texts or comment.get("Inserted") != "true":
        raise NotUnderstoodError("a comment without a text")
    return f"(/*{_inner(texts[0])}*/)"


def _named(element: XmlNode) -> str:
    return (element.get("Name") or "") + _children(element)


def _call(element: XmlNode) -> str:
    name = element.get("Name")
    return (f'"{name}"' if name and element.get("BlockType") else name or "") + _children(element)


def _instance(element: XmlNode) -> str:
    return _path(element, element.get("Scope"))


def _path(element: XmlNode, scope: str | None) -> str:
    text, first = "", True
    for part in children(element):
        if local(part) == "Component" and first:
            text += ("#" if scope == "LocalVariable" else "") + _component(part, quoted=scope == "GlobalVariable")
            first = False
        else:
            text += _text(part)
    return text


def _repeated(letter: str) -> Callable[[XmlNode], str]:
    def write(element: XmlNode) -> str:
        count = element.get("Num", "1")
        if not count.isdigit() or int(count) > _MOST_BLANKS:
            raise NotUnderstoodError("blanks")
        return letter * int(count)

    return write


_MOST_BLANKS = 100_000


def _address(element: XmlNode) -> str:
    return "" if element.get("Informative") == "true" else read_address(element)


def _nothing(_: XmlNode) -> str:
    return ""


_WRITERS: dict[str, Callable[[XmlNode], str]] = {
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
