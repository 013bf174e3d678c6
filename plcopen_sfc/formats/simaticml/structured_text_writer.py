"""Writes SCL as the tokens of ``StructuredText``. The reader is `structured_text`."""

from __future__ import annotations

import re

from lxml import etree

from plcopen_sfc.formats.simaticml.operands import write_operand
from plcopen_sfc.formats.simaticml.reading import Fields, NotUnderstoodError, same
from plcopen_sfc.formats.simaticml.structured_text import scl_text
from plcopen_sfc.formats.simaticml.versions import concrete, neutral
from plcopen_sfc.formats.simaticml.writing import WriteContext, add_element, sub
from plcopen_sfc.formats.xml.carrying import legal, markup
from plcopen_sfc.languages.st.lexer import Comment, Token, tokenize
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect

FIRST_UID = 21
_BOTH_ENDS = len("(**)")


def write_code(ctx: WriteContext, source: etree._Element, body: StBody) -> None:
    """Write a body into ``NetworkSource``: with its tokens as long as they say the same."""
    if body.markup is not None and _text_of(ctx, body.markup) == body.text:
        add_element(ctx, source, body.markup)
    elif body.text:
        write_text(ctx.root("StructuredText", "StructuredText", source), legal(body.text), ctx.types, ctx.culture)


def read_code(element: etree._Element, types: dict[str, str]) -> Fields:
    """The text of a ``StructuredText``, and its tokens as markup where we would write others.

    Raises `NotUnderstoodError`. `types` as in `write_text`.
    """
    fields: Fields = {"text": scl_text(element)}
    copy = etree.Element(element.tag)
    write_text(copy, fields["text"], types, "")
    if not same(element, copy):
        fields["markup"] = neutral(markup(element))
    return fields


def _text_of(ctx: WriteContext, markup: str) -> str | None:
    try:
        return scl_text(etree.fromstring(concrete(markup, ctx.schemas)))
    except (NotUnderstoodError, etree.XMLSyntaxError):
        return None


def write_text(root: etree._Element, text: str, types: dict[str, str], culture: str) -> None:
    """Fill ``StructuredText`` with the tokens of `text`.

    `types` are those of local variables: an instance of a block of the user is called otherwise than one of the system.
    """
    _Writer(root, text.replace("\r\n", "\n"), types, culture).run()


class _Writer:
    def __init__(self, root: etree._Element, text: str, types: dict[str, str], culture: str) -> None:
        self.root = root
        self.text = text
        self.types = types
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
        self._number()

    def _number(self) -> None:
        number = FIRST_UID
        for element in self.root.iterdescendants():
            if str(element.tag).endswith("}ConstantValue") or element.tag == "ConstantValue":
                number += 1  # that of the type, which is left out
            element.set("UId", str(number))
            number += 1

    # -- blanks, comments, words

    def _blanks(self, parent: etree._Element, end: int) -> None:
        for run in re.finditer(r"\n+|[^\n]+", self.text[self.position : end]):
            name = "NewLine" if run[0].startswith("\n") else "Blank"
            sub(parent, name, {"Num": str(len(run[0]))} if len(run[0]) > 1 else {})
        self.position = end

    def _take(self, parent: etree._Element) -> Token | Comment:
        """The next item; the blanks before it are written."""
        item = self.items[self.index]
        self._blanks(parent, item.span[0])
        self.index += 1
        self.position = item.span[1]
        return item

    def _next_is(self, kind: str, ahead: int = 0, *, joined: bool = False) -> bool:
        """Whether the item `ahead` is a token of this type; `joined`: without blanks before it."""
        place = self.index + ahead
        if place >= len(self.items):
            return False
        item = self.items[place]
        start = self.position if ahead == 0 else self.items[place - 1].span[1]
        return isinstance(item, Token) and item.type == kind and (not joined or item.span[0] == start)

    def _item(self, parent: etree._Element) -> None:
        """Write the next item, with what belongs to it."""
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

    def _region(self, parent: etree._Element, line: str) -> None:
        word = line[: len("REGION")]
        rest = line[len(word) :]
        title = rest.strip()
        sub(parent, "Token", {"Text": word})
        lead = len(rest) - len(rest.lstrip())
        if lead:
            sub(parent, "Blank", {"Num": str(lead)} if lead > 1 else {})
        if title:
            sub(parent, "Text").text = rest[lead:]

    def _comment(self, parent: etree._Element, text: str) -> None:
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

    def _literal(self, parent: etree._Element, value: str) -> None:
        typed = "#" in value and not value[0].isdigit() and not value.startswith("'")
        access = sub(parent, "Access", {"Scope": "TypedConstant" if typed else "LiteralConstant"})
        sub(sub(access, "Constant"), "ConstantValue").text = value

    # -- operands and calls

    def _name(self, parent: etree._Element, name: str) -> None:
        is_path = name.startswith(("#", '"'))
        if not is_path and self._next_is("LPAR", joined=True):
            call = sub(parent, "Access", {"Scope": "Call"})
            self._arguments(sub(call, "Instruction", {"Name": name}))
            return
        scope = "GlobalVariable" if name.startswith('"') else "LocalVariable"
        if not is_path:
            sub(parent, "Token", {"Text": name})
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

    def _component(self, symbol: etree._Element, name: str) -> None:
        plain = name.removeprefix("#").strip('"')
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

    def _call(self, parent: etree._Element, start: int, scope: str, path: str) -> None:
        """The call of an instance, or of a block of the user by its name."""
        is_block = scope == "GlobalVariable" and "." not in path
        user_type = self.types.get(path.lower(), "").startswith('"')
        if is_block or user_type:
            symbol = parent[start][0]
            parent.remove(parent[start])
            info = sub(sub(parent, "Access", {"Scope": "Call"}), "CallInfo", {"BlockType": "FB" if user_type else "FC"})
            if is_block:
                info.set("Name", path.strip('"'))
            else:
                instance = sub(info, "Instance", {"Scope": scope})
                instance.extend(list(symbol))
            self._arguments(info)
        else:
            self._arguments(sub(sub(parent, "Access", {"Scope": "Call"}), "Instruction"))

    def _arguments(self, call: etree._Element) -> None:
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

    def _argument(self, parameter: etree._Element) -> None:
        """Write what belongs to one argument: up to the comma or bracket behind it."""
        depth = 0
        while self.index < len(self.items):
            if depth == 0 and (self._next_is("COMMA") or self._next_is("RPAR")):
                return
            depth += self._next_is("LPAR") - self._next_is("RPAR")
            self._item(parameter)

    @staticmethod
    def _value(item: Token | Comment) -> str:
        return item.value if isinstance(item, Token) else item.text
