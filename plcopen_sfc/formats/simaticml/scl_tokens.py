"""SCL as the tokens of ``StructuredText``, and as the text that people read and write."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from xml.etree import ElementTree as ET

from lxml import etree

from plcopen_sfc.errors import ModelError
from plcopen_sfc.formats.simaticml.element_reader import (
    Fields,
    NotUnderstoodError,
    XmlNode,
    child_named,
    children,
    keep_attribute,
    local,
)
from plcopen_sfc.formats.simaticml.element_writer import DocumentWriting, add_element, sub
from plcopen_sfc.formats.simaticml.network_boxes import template_type
from plcopen_sfc.formats.simaticml.network_operands import CONSTANTS, HINT, hint_details, read_address, write_operand
from plcopen_sfc.formats.simaticml.program_comparison import (
    FIRST,
    NUMBERS,
    UID,
    are_numbers,
    is_identical,
    parse_program,
    program_text,
    renumber,
    shortened,
)
from plcopen_sfc.formats.simaticml.tia_versions import concrete, neutral
from plcopen_sfc.formats.xml.extension_data import attributes, attributes_of, legal_text, markup, parsed_markup
from plcopen_sfc.languages.st.lexer import Comment, Token, tokenize
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.text import without_signs
from plcopen_sfc.report import Outcome
from plcopen_sfc.whole_numbers import whole_number


def scl_text(element: XmlNode) -> str:
    """Return the text of a ``StructuredText``, or of a part of it, as TIA Portal shows it."""
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
    return (f'"{name}"' if quoted else name) + scl_text(component)


def _constant(constant: XmlNode, *, is_global: bool = False) -> str:
    name = constant.get("Name")
    if not name:
        return scl_text(constant)
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
    return (element.get("Name") or "") + scl_text(element)


def _call(element: XmlNode) -> str:
    name = element.get("Name")
    return (f'"{name}"' if name and element.get("BlockType") else name or "") + scl_text(element)


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
        count = whole_number(element.get("Num", "1"))
        if count is None or count > _MOST_BLANKS:
            raise NotUnderstoodError("blanks")
        return letter * count

    return write


_MOST_BLANKS = 100_000


def _address(element: XmlNode) -> str:
    return "" if element.get("Informative") == "true" else read_address(element)


_WRITERS: dict[str, Callable[[XmlNode], str]] = {
    "Access": _access,
    "Address": _address,
    "Token": lambda token: token.get("Text") or "",
    "Text": _inner,
    "Blank": _repeated(" "),
    "NewLine": _repeated("\n"),
    "LineComment": _line_comment,
    "Comment": _comment,
    "Symbol": scl_text,
    "Component": _component,
    "Constant": _constant,
    "ConstantValue": _inner,
    "Instruction": _named,
    "CallInfo": _call,
    "Instance": _instance,
    "Parameter": _named,
    "NamelessParameter": scl_text,
    "Label": _named,
    # what is no part of the text
    **dict.fromkeys(
        ("ConstantType", "TemplateValue", "BooleanAttribute", "IntegerAttribute", "StringAttribute", "DateAttribute"),
        lambda _: "",
    ),
}


_BOTH_ENDS = len("(**)")


def write_code(ctx: DocumentWriting, source: etree._Element, body: StBody) -> None:
    """Write a body into ``NetworkSource``: with its tokens as long as they mean the same."""
    if body.markup is not None and _text_of(ctx, body.markup) == body.text:
        add_element(ctx, source, body.markup)
        return
    if body.markup is not None and body.markup.count("<MultiLanguageText") > body.markup.count("<Comment"):
        ctx.note(Outcome.DROPPED, "comment", why="an edited text keeps only one language of a comment")
    if body.text:
        root = ctx.root("StructuredText", "StructuredText", source)
        kept = attributes_of(body.extension_data)
        write_text(root, legal_text(body.text), InterfaceNames(ctx.types, ctx.constants), ctx.culture, kept)
        if NUMBERS in kept:
            renumber(root, kept[NUMBERS])


def read_code(element: etree._Element, names: InterfaceNames) -> Fields:
    """Return the text of a ``StructuredText``, and its tokens as markup where we would write others.

    Raises `NotUnderstoodError`. `names` as in `write_text`.
    """
    program = parse_program(program_text(element))
    fields: Fields = {"text": scl_text(program)}
    copy = ET.Element(program.tag)
    hints = {name: hint for name, hint in _hints(program).items() if not names.implies(name, hint)}
    write_text(copy, fields["text"], names, _culture(program), hints)
    short = ""
    if not is_identical(program, copy):
        numbers = _numbers(program) if _alike(program, copy) else None
        if numbers is None:
            fields["markup"] = neutral(markup(element))
            return fields
        short = shortened(numbers, _numbers(copy) or [])
    for name, hint in hints.items():
        keep_attribute(fields, name, hint)
    if short:
        keep_attribute(fields, NUMBERS, short)
    return fields


def _hints(element: XmlNode) -> dict[str, str]:
    """Facts that the text of a program lacks: which names are constants or instances, the types of instructions."""
    found: dict[str, str] = {}
    of_kind: dict[str, list[XmlNode]] = {"Access": [], "Instruction": [], "CallInfo": []}
    for part in element.iter():
        if (parts := of_kind.get(local(part))) is not None:
            parts.append(part)
    for access in of_kind["Access"]:
        scope = access.get("Scope", "")
        constant = child_named(access, "Constant") if scope in CONSTANTS else None
        if constant is not None:
            name = constant.get("Name", "")
            found[HINT + (f'"{name}"' if scope == "GlobalConstant" else f"#{name}")] = scope
    for instruction in of_kind["Instruction"]:
        values = [part for part in children(instruction) if local(part) == "TemplateValue"]
        if values:
            types = {part.get("Name", ""): part.text or "" for part in values}
            found[_TYPES + instruction.get("Name", "")] = json.dumps(types)
    for info in of_kind["CallInfo"]:
        instance = child_named(info, "Instance")
        path = children(instance) if instance is not None and instance.get("Scope") == "GlobalVariable" else []
        if len(path) == 1 and info.get("BlockType") == "FB":
            found[f'{CALL}"{path[0].get("Name", "")}"'] = "FB"
    return found


CALL = "call "
"""Prefix of extension attributes: a call that looks like one of a function calls an instance data block."""
_TYPES = "types of "
"""Prefix of extension attributes: the types for which an instruction is called, as JSON."""


def _culture(element: XmlNode) -> str:
    """Return the language of the first comment that has one."""
    text = next((part for part in element.iter() if local(part) == "MultiLanguageText"), None)
    return text.get("Lang", "") if text is not None else ""


def _numbers(program: ET.Element) -> list[str] | None:
    """Return the numbers of a program in the order of its elements; None where they are no whole numbers that rise."""
    found = [part.get(UID, "") for part in program.iter() if part is not program]
    rising = are_numbers(found) and all(int(one) < int(next_) for one, next_ in pairwise(found))
    return found if rising else None


_USUAL = {"Num": "1", "Inserted": "false", "NoClosingBracket": "false"}
"""Values of absent attributes."""


def _alike(one: XmlNode, other: XmlNode) -> bool:
    """True if two programs have the same tokens; their numbers do not count, if they rise."""
    if (
        local(one) != local(other)
        or _own_attributes(one) != _own_attributes(other)
        or ((one.text or "") != (other.text or "") and not len(one))
    ):
        return False
    mine, theirs = children(one), children(other)
    return len(mine) == len(theirs) and all(map(_alike, mine, theirs))


def _own_attributes(element: XmlNode) -> dict[str, str]:
    return {name: value for name, value in attributes(element).items() if name != UID and _USUAL.get(name) != value}


def _text_of(ctx: DocumentWriting, markup: str) -> str | None:
    try:
        return scl_text(parsed_markup(concrete(markup, ctx.schemas)))
    except (NotUnderstoodError, ModelError):
        return None


@dataclass(frozen=True)
class InterfaceNames:
    """Facts of the interface of a block about the names in its texts, by ``#name`` in lower case.

    `types` are those of local variables: an instance of a block of the user is called otherwise than one of the system.
    `constants` are those of the block, which have a scope of their own.
    """

    types: Mapping[str, str]
    constants: frozenset[str] = frozenset()

    def implies(self, hint: str, value: str) -> bool:
        """True if a hint adds nothing."""
        return value == _LOCAL and hint.removeprefix(HINT).lower() in self.constants


_LOCAL = "LocalConstant"


def write_text(
    root: XmlNode, text: str, names: InterfaceNames, culture: str, hints: Mapping[str, str] | None = None
) -> None:
    """Fill ``StructuredText`` with the tokens of `text`.

    `hints` are the extension attributes of the body, with the facts that neither the text nor `names` have.
    """
    _Writer(root, text.replace("\r\n", "\n"), names, culture, hints or {}).run()


def _number(owner: XmlNode, following: int) -> int:
    """Number the elements below `owner`, in their order, and return the number behind them."""
    last = len(owner) - 1
    for place, element in enumerate(children(owner)):
        if local(element) == "ConstantValue" or (place == last and _is_end_of_function(owner, element)):
            following += 1  # that of the type of the constant, or of the result, which is left out
        element.set(UID, str(following))
        following = _number(element, following + 1)
    return following


def _is_end_of_function(owner: XmlNode, last: XmlNode) -> bool:
    """True if the last token of `owner` closes the call of an instruction that has a result."""
    name = owner.get("Name", "")
    if last.get("Text") != ")" or local(owner) != "Instruction" or not name:
        return False
    return not name.upper().startswith(_WITHOUT_RESULT)


_WITHOUT_RESULT = ("POKE",)
"""Instructions of SCL without a result: how their names begin."""


class _Writer:
    def __init__(self, root: XmlNode, text: str, names: InterfaceNames, culture: str, hints: Mapping[str, str]) -> None:
        self.root = root
        self.hints = hints
        self.text = text
        self.types = names.types
        self.constants = names.constants
        self.culture = culture
        found = tokenize(text, Dialect.SCL)
        self.items: list[Token | Comment] = sorted([*found.tokens, *found.comments], key=lambda item: item.span)
        self.index = 0
        self.position = 0

    def run(self) -> None:
        """Write everything, then number it."""
        while self.index < len(self.items):
            self._item(self.root)
        self._blanks(self.root, len(self.text))
        _number(self.root, FIRST)

    # -- blanks, comments, words

    def _blanks(self, parent: XmlNode, end: int) -> None:
        for run in re.finditer(r"\n+|[^\n]+", self.text[self.position : end]):
            name = "NewLine" if run[0].startswith("\n") else "Blank"
            sub(parent, name, {"Num": str(len(run[0]))} if len(run[0]) > 1 else {})
        self.position = end

    def _take(self, parent: XmlNode) -> Token | Comment:
        """Return the next item; the blanks before it are written."""
        item = self.items[self.index]
        self._blanks(parent, item.span[0])
        self.index += 1
        self.position = item.span[1]
        return item

    def _next_is(self, kind: str, ahead: int = 0, *, joined: bool = False) -> bool:
        """True if the item `ahead` is a token of this type; `joined`: without blanks before it."""
        place = self.index + ahead
        if place >= len(self.items):
            return False
        item = self.items[place]
        start = self.position if ahead == 0 else self.items[place - 1].span[1]
        return isinstance(item, Token) and item.type == kind and (not joined or item.span[0] == start)

    def _item(self, parent: XmlNode) -> None:
        """Write the next item, with the tokens that belong to it."""
        item = self._take(parent)
        if isinstance(item, Comment):
            self._comment(parent, item.text)
        elif item.type == "NAME":
            self._name(parent, item.value)
        elif item.type == "LITERAL" and "(" not in item.value:
            self._literal(parent, item.value)
        elif item.type == "ADDRESS":
            try:
                write_operand(parent, item.value, "")
            except NotUnderstoodError:
                sub(parent, "Token", {"Text": item.value})
        elif item.type == "REGION":
            self._region(parent, item.value)
        else:
            sub(parent, "Token", {"Text": item.value})

    def _region(self, parent: XmlNode, line: str) -> None:
        word = line[: len("REGION")]
        rest = line[len(word) :]
        title = rest.strip()
        sub(parent, "Token", {"Text": word})
        lead = len(rest) - len(rest.lstrip())
        if lead:
            sub(parent, "Blank", {"Num": str(lead)} if lead > 1 else {})
        if title:
            sub(parent, "Text").text = rest[lead:]

    def _comment(self, parent: XmlNode, text: str) -> None:
        if text.startswith("//"):
            sub(sub(parent, "LineComment"), "Text").text = text[2:]
        elif text.startswith("(/*") and text.endswith("*/)") and len(text) >= _BOTH_ENDS + 2:
            content = text[3:-3]
            element = sub(parent, "Comment", {"Inserted": "true"})
            sub(element, "MultiLanguageText", {"Lang": self.culture}).text = content
        elif text.startswith("(*") and text.endswith("*)") and len(text) >= _BOTH_ENDS:
            sub(sub(parent, "LineComment", {"Inserted": "true"}), "Text").text = text[2:-2]
        else:
            sub(parent, "Token", {"Text": text})

    def _literal(self, parent: XmlNode, value: str) -> None:
        typed = "#" in value and not value[0].isdigit() and not value.startswith("'")
        access = sub(parent, "Access", {"Scope": "TypedConstant" if typed else "LiteralConstant"})
        sub(sub(access, "Constant"), "ConstantValue").text = value

    # -- operands and calls

    def _name(self, parent: XmlNode, name: str) -> None:
        is_path = name.startswith(("#", '"'))
        # without # and quotes a called name is one of the system; names of users have quotes in SCL of TIA Portal
        if not is_path and self._next_is("LPAR", joined=True):
            call = sub(parent, "Access", {"Scope": "Call"})
            instruction = sub(call, "Instruction", {"Name": name})
            for key, value in hint_details(self.hints.get(_TYPES + name, "")).items():
                sub(instruction, "TemplateValue", {"Name": key, "Type": template_type(key)}).text = value or None
            self._arguments(instruction)
            return
        scope = "GlobalVariable" if name.startswith('"') else "LocalVariable"
        if not is_path:
            self._word(parent, name)
            return
        constant = self.hints.get(HINT + name, _LOCAL if name.lower() in self.constants else None)
        if constant in CONSTANTS:
            sub(sub(parent, "Access", {"Scope": constant}), "Constant", {"Name": name.lstrip("#").strip('"')})
            return
        start = len(parent)
        path = name
        access = sub(parent, "Access", {"Scope": scope})
        symbol = sub(access, "Symbol")
        self._component(symbol, name)
        while self._next_is("DOT", joined=True) and self._next_is("NAME", 1, joined=True):
            self._take(symbol)
            sub(symbol, "Token", {"Text": "."})
            part = self._take(symbol)
            value = part.value if isinstance(part, Token) else ""
            path += "." + value
            if value.startswith("%"):
                sub(symbol, "Token", {"Text": value})
            else:
                self._component(symbol, value)
        if self._next_is("LPAR", joined=True):
            self._call(parent, start, scope, path)

    def _word(self, parent: XmlNode, name: str) -> None:
        """Write a name that is not that of a variable: of a label behind GOTO or before a colon, else a word."""
        before = self.items[self.index - 2] if self.index > 1 else None
        is_target = isinstance(before, Token) and before.type == "GOTO"
        if not is_target and not (parent is self.root and self._next_is("COLON", joined=True)):
            sub(parent, "Token", {"Text": name})
            return
        label = sub(sub(parent, "Access", {"Scope": "Label"}), "Label", {"Name": name})
        if not is_target:
            sub(label, "Token", {"Text": self._value(self._take(label))})

    def _component(self, symbol: XmlNode, name: str) -> None:
        plain = without_signs(name)
        component = sub(symbol, "Component", {"Name": plain})
        if name.removeprefix("#").startswith('"'):
            sub(component, "BooleanAttribute", {"Name": "HasQuotes"}).text = "true"
        if self._next_is("LSQB", joined=True):
            depth = 0
            while self.index < len(self.items):
                depth += self._next_is("LSQB") - self._next_is("RSQB")
                self._item(component)
                if depth == 0:
                    break

    def _call(self, parent: XmlNode, start: int, scope: str, path: str) -> None:
        """Write the call of an instance, or of a block of the user by its name."""
        is_block = scope == "GlobalVariable" and "." not in path
        # an instance of a block of the system, such as a timer, is called by an instruction instead
        user_type = self.types.get(path.lower(), "").startswith('"')
        is_instance = is_block and self.hints.get(CALL + path) == "FB"
        if is_block or user_type:
            symbol = children(parent[start])[0]
            del parent[start]
            kind = "FB" if user_type or is_instance else "FC"
            info = sub(sub(parent, "Access", {"Scope": "Call"}), "CallInfo", {"BlockType": kind})
            if is_block and not is_instance:
                info.set("Name", path.strip('"'))
            else:
                instance = sub(info, "Instance", {"Scope": scope})
                for part in children(symbol):
                    instance.append(part)  # type: ignore[arg-type]  # both are of the kind of the root
            self._arguments(info)
        else:
            self._arguments(sub(sub(parent, "Access", {"Scope": "Call"}), "Instruction"))

    def _arguments(self, call: XmlNode) -> None:
        sub(call, "Token", {"Text": self._value(self._take(call))})
        while self.index < len(self.items) and not self._next_is("RPAR"):
            if self._next_is("COMMA"):
                sub(call, "Token", {"Text": self._value(self._take(call))})
            elif isinstance(self.items[self.index], Comment):
                self._item(call)
            elif self._next_is("NAME") and (self._next_is("ASSIGN", 1) or self._next_is("ARROW", 1)):
                self._blanks(call, self.items[self.index].span[0])
                name = self._value(self._take(call))
                self._argument(sub(call, "Parameter", {"Name": name}))
            else:
                self._blanks(call, self.items[self.index].span[0])
                self._argument(sub(call, "NamelessParameter"))
        if self.index < len(self.items):
            sub(call, "Token", {"Text": self._value(self._take(call))})

    def _argument(self, parameter: XmlNode) -> None:
        """Write the tokens of one argument: up to the comma or bracket behind it."""
        depth = 0
        while self.index < len(self.items):
            if depth == 0 and (self._next_is("COMMA") or self._next_is("RPAR")):
                return
            depth += self._next_is("LPAR") - self._next_is("RPAR")
            self._item(parameter)

    @staticmethod
    def _value(item: Token | Comment) -> str:
        return item.value if isinstance(item, Token) else item.text
