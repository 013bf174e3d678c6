"""Reading TC6 elements: dispatch by name, attribute values, texts, and extension data.

Readers turn elements into plain dictionaries of model fields; the whole project is validated into the model at the
end, in one go, which is several times faster than building object by object. A reader takes attributes out of a
dictionary one by one: what is left in it at the end is not known, and is kept as extension data. The same holds for
child elements.

Fields without a place in TC6 are in data under a name of this package, in 1.01 in XML comments:
``<data name="urn:plcopen-sfc:fields"><fields><field name="max_time">"T#5s"</field></fields></data>`` are fields of the
model object that belongs to the element, each as JSON.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from lxml import etree

from plcopen_sfc.formats.plcopen.tc6_versions import XHTML, Tc6Version
from plcopen_sfc.formats.xml.extension_data import COMMENT_MARK, extension_data, inner_markup, markup
from plcopen_sfc.formats.xml.xml_parsing import ElementReading, SourceLines
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.drawing import StepActionKind
from plcopen_sfc.model.late import Mention
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.whole_numbers import xml_number

Fields = dict[str, Any]
"""Fields of a model object that is being read."""

DataReader = Callable[["Tc6ReadContext", etree._Element, Fields, str], bool]
"""Reads one ``addData/data`` element into the fields of its owner (an element of the given local name).

Returns False where it does not understand the content; the data is then kept as extension data.
"""

_XHTML_TAG = f"{{{XHTML}}}"


class UnreadChart:
    """An ``SFC`` element that is not read yet.

    `late` are fields of the chart from other elements, `edited` the added actions and transition objects of its POU
    that were changed since, `executed` those that the chart executes all the same
    (`plcopen_sfc.formats.plcopen.source_marks`). `ahead` is the chart where it had to be read at once.
    """

    def __init__(self, ctx: Tc6ReadContext, element: etree._Element) -> None:
        self.ctx = ctx
        self.element = element
        self.place = list(ctx.place)
        self.late: Fields = {}
        self.edited: set[str] = set()
        self.executed: set[str] = set()
        self.ahead: SfcNetwork | None = None

    def read_ahead(self, read: Callable[[UnreadChart], SfcNetwork]) -> set[str]:
        """Read the chart now; return the added parts that it executes."""
        self.ahead = read(self)
        return self.executed

    def may_have(self, mention: Mention) -> bool:
        """False where no text of the chart has what is searched for: written, or without markup inside of words."""
        if mention.as_members and not self.ctx.may_have(mention):  # other words are in some chart, as they are declared
            return False
        written = etree.tostring(self.element, encoding="unicode")
        plain = etree.tostring(self.element, encoding="unicode", method="text")
        return any(map(mention.is_in, (written, plain, repr(self.late))))

    def warn_of_edit(self, what: str) -> None:
        """Warn that extension data keep something of the source which counts no more."""
        outer, self.ctx.place = self.ctx.place, self.place
        message = f"what extension data keep of {what} is outdated: it was edited in this file; the edit counts"
        self.ctx.warn("XML214", message, self.element)
        self.ctx.place = outer

    def update(self, fields: Fields) -> None:
        """Add what was found outside of the chart's own element."""
        merge_fields(self.late, fields)


def merge_fields(fields: Fields, found: Fields) -> None:
    """Add `found` to `fields`; what is a part of an object is added to that object."""
    for name, value in found.items():
        present = fields.get(name)
        if isinstance(value, dict) and isinstance(present, dict):
            merge_fields(present, value)
        elif isinstance(value, dict) and isinstance(present, UnreadChart):
            present.update(value)
        else:
            fields[name] = value


@dataclass(frozen=True)
class ToolData:
    """Content of the files of one tool beyond TC6.

    `readers` understand its data, by their names; `finish_chart` is called when a chart is read. `text_element` is its
    usual XHTML element of a text. `placeless`: it exports no layout.
    """

    readers: Mapping[str, DataReader] = field(default_factory=dict)
    finish_chart: Callable[[Tc6ReadContext, Fields], None] = lambda _ctx, _fields: None
    text_element: str = "p"
    placeless: bool = False


PLACELESS = ToolData(placeless=True)
"""For charts of a tool that exports no layout, with nothing beyond TC6."""


class Tc6ReadContext(ElementReading):
    """State of reading one file: its version, the findings so far, and who understands which foreign data."""

    def __init__(
        self, version: Tc6Version, tool: ToolData, *, file: str | None = None, lines: SourceLines | None = None
    ) -> None:
        super().__init__(file, lines)
        self.version = version
        self.tags = version.tags
        self.tool = tool
        self.data_readers = {FIELDS_DATA: read_fields, **tool.readers}
        self.text_element = _XHTML_TAG + tool.text_element
        self.pous: list[Fields] = []
        self.data_types: list[Fields] = []
        self.global_variables: list[Fields] = []
        """Lists of global variables of the project that those of a configuration replace."""
        self.resource_place = ""
        """`Pou.place` of POUs in the resource being read."""
        self._mentions: dict[Mention, bool] = {}

    def may_have(self, mention: Mention) -> bool:
        """False where nothing in the file has what is searched for: to write all charts as text takes three times."""
        found = self._mentions.get(mention)
        if found is None:
            found = self._mentions[mention] = self.lines is None or self.lines.may_have(mention.is_in)
        return found


def keep_attributes(fields: Fields, left: dict[str, str]) -> None:
    """Keep the attributes that no reader took."""
    global_id = left.pop("globalId", None)
    if global_id is not None:
        fields["global_id"] = global_id
    if left:
        extension_data(fields)["attributes"].update(left)


def neutral(content: str, version: Tc6Version) -> str:
    """Markup of TC6 elements that fits every version: the namespace is written as ``tc6``."""
    return content.replace(f'"{version.namespace}"', f'"{NEUTRAL}"')


NEUTRAL = "tc6"


def keep_element(ctx: Tc6ReadContext, fields: Fields, element: etree._Element) -> None:
    """Keep a child element that no reader knows, with a warning. Comments stay in the file only."""
    if not isinstance(element.tag, str):
        read_comment(ctx, element, fields, "")
        return
    extension_data(fields)["elements"].append(neutral(markup(element), ctx.version))
    ctx.warn("XML201", f"<{etree.QName(element).localname}> is not expected here; it is kept as it is", element)


def read_common(ctx: Tc6ReadContext, fields: Fields, element: etree._Element, local: str | None, owner: str) -> None:
    """Read a child that every element may have: ``addData``, ``documentation``; keep anything else."""
    if local == "addData":
        read_foreign_data(ctx, fields, element, owner)
    elif local == "documentation":
        text = read_text(ctx, element)
        languages = fields.get("comment")
        texts = languages.get("texts") if isinstance(languages, dict) else None
        if not isinstance(texts, dict) or all_languages(texts) != text:  # or it was edited since
            fields["comment"] = text
    else:
        keep_element(ctx, fields, element)


def all_languages(texts: dict[str, str]) -> str:
    """Return a text in several languages as TC6 writes it: one below the other. Extension data keep them apart."""
    return "\n".join(map(str, texts.values()))


def read_foreign_data(ctx: Tc6ReadContext, fields: Fields, add_data: etree._Element, owner: str) -> None:
    """Read ``addData``: what a reader understands goes into the fields, the rest is extension data."""
    for data in add_data:
        if ctx.tags.get(data.tag) != "data":
            keep_element(ctx, fields, data)
            continue
        name = data.get("name", "")
        reader = ctx.data_readers.get(name)
        if reader is not None and reader(ctx, data, fields, owner):
            continue
        rule = data.get("handleUnknown", "implementation")
        if rule not in ("preserve", "discard", "implementation"):
            ctx.warn("XML203", f"handleUnknown={rule!r} is none of preserve, discard, implementation", data)
            rule = "implementation"
        extension_data(fields)["data"].append({"name": name, "rule": rule, "content": inner_markup(data)})


def read_text(ctx: Tc6ReadContext, element: etree._Element) -> str | Fields:
    """Read ``formattedText``: a plain string where it is one XHTML element without markup, else text and markup."""
    children = list(element)
    if len(children) == 1 and not len(children[0]) and children[0].tag == ctx.text_element and not children[0].attrib:
        return children[0].text or ""
    loose = [element.text or "", *(child.tail or "" for child in children)]
    # blanks around the XHTML element are the indentation of the file
    of = [element] if any(text.strip() for text in loose) else [c for c in children if isinstance(c.tag, str)]
    return {"text": "".join(str(t) for e in of for t in e.itertext()), "markup": inner_markup(element)}


def read_code(ctx: Tc6ReadContext, element: etree._Element) -> tuple[str, str | None]:
    """Read the program text of ``ST`` or ``IL``: the text, and the markup where it is not one plain element."""
    text = read_text(ctx, element)
    if isinstance(text, str):
        return text, None
    return text["text"].strip("\n") if not element.text or not element.text.strip() else text["text"], text["markup"]


def decimal_or_none(text: str | None) -> float | None:
    """Return a decimal; None where it is missing or none."""
    # Python reads 1_000 as a number, XML Schema does not.
    if text is None or "_" in text:
        return None
    try:
        return int(text)
    except ValueError:
        pass
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def read_point(element: etree._Element) -> tuple[float, float] | None:
    """Return a ``position`` or ``relPosition``; None where its numbers are damaged."""
    # Wires of a chart may have ten thousands of points: this is the fastest way to their two attributes.
    values = element.items()
    if len(values) != 2:
        return None
    (first, one), (second, other) = values
    if first == "y":
        first, one, second, other = second, other, first, one
    x, y = decimal_or_none(str(one)), decimal_or_none(str(other))
    return None if x is None or y is None or first != "x" or second != "y" else (x, y)


def take_number(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], name: str) -> float | None:
    """Take a decimal attribute. A damaged one is left, and so kept, with a warning."""
    return _taken(ctx, element, left, name, read=decimal_or_none, wanted="a number")


def take_integer(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], name: str) -> int | None:
    """Take a whole, non-negative number. A damaged one is left, and so kept, with a warning."""
    return _taken(ctx, element, left, name, read=xml_number, wanted="a whole number")


_N = TypeVar("_N", int, float)


def _taken(
    ctx: Tc6ReadContext,
    element: etree._Element,
    left: dict[str, str],
    name: str,
    *,
    read: Callable[[str], _N | None],
    wanted: str,
) -> _N | None:
    text = left.get(name)
    if text is None:
        return None
    value = read(text)
    if value is None:
        ctx.warn("XML202", f"{name}={text!r} is not {wanted}; it is kept as it is", element)
        return None
    del left[name]
    return value


def take_flag(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], name: str) -> bool:
    """Take a Boolean attribute that is false by default."""
    text = left.get(name)
    if text is None:
        return False
    if text.strip() not in ("true", "false", "1", "0"):
        ctx.warn("XML202", f"{name}={text!r} is neither true nor false; it is kept as it is", element)
        return False
    del left[name]
    return text.strip() in ("true", "1")


def take_choice(
    ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], name: str, choices: Iterable[str]
) -> str | None:
    """Take an attribute that has one of `choices`. Another value is left, and so kept, with a warning.

    One that differs by its case only is taken, with a warning: some tools write ``pouType="PROGRAM"``.
    """
    text = left.get(name)
    if text is None:
        return None
    if text not in choices:
        meant = next((choice for choice in choices if choice.casefold() == text.casefold()), None)
        if meant is not None:
            ctx.warn("XML202", f"{name}={text!r} is spelled {meant!r}; it is taken for that", element)
            del left[name]
            return meant
        ctx.warn("XML202", f"{name}={text!r} is none of {', '.join(choices)}; it is kept as it is", element)
        return None
    del left[name]
    return text


def take_required(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], name: str) -> str:
    """Take an attribute that the schema requires; an empty one replaces a missing one, with a warning."""
    text = left.pop(name, None)
    if text is None:
        ctx.warn("XML204", f"<{etree.QName(element).localname}> has no {name}", element)
        return ""
    return text


FIELDS_DATA = "urn:plcopen-sfc:fields"
STEP_ACTION_FIELD = "step_action"
"""At an association: the step action that it replaces."""
STEP_ACTION_QUALIFIERS = {
    StepActionKind.ENTRY: Qualifier.P1,
    StepActionKind.MAIN: Qualifier.N,
    StepActionKind.EXIT: Qualifier.P0,
}
"""The qualifier that does what a step action does (IEC 61131-3 ed. 3, table 59)."""
APPLICATION_FIELD = "application"
"""At a configuration: it only holds an application."""
SCHEDULE_FIELD = "schedule"
"""At a task: its schedule in the source, and what was written for that."""
INSTANCE_FIELD = "instance"
"""At a program instance: its name and type in the source, and what was written for them."""
SHARED_FIELD = "shared_ids"
"""At a transition below a convergence of steps: the ids of the transitions that it is drawn for."""


def read_fields(ctx: Tc6ReadContext, data: etree._Element, fields: Fields, owner: str) -> bool:
    """Put our own data back into the fields of the element's object."""
    found: Fields = {}
    for entry in data.iterfind(f"{{{FIELDS_DATA}}}fields/{{{FIELDS_DATA}}}field"):
        try:
            found[entry.get("name", "")] = json.loads(entry.text or "")
        except json.JSONDecodeError as error:
            ctx.warn("XML208", f"the extension data field {entry.get('name')!r} is damaged: {error}", entry, owner)
            return False
    merge_fields(fields, found)
    return True


def read_comment(ctx: Tc6ReadContext, comment: etree._Element, fields: Fields, owner: str) -> bool:
    """Put fields back from an XML comment; False where the comment is not of this package."""
    text = comment.text or ""
    if not isinstance(comment, etree._Comment) or not text.startswith(COMMENT_MARK):
        return False
    try:
        merge_fields(fields, json.loads(text.removeprefix(COMMENT_MARK)))
    except (ValueError, AttributeError) as error:
        ctx.warn("XML208", f"extension data fields are damaged: {error}", comment, owner)
        return False
    return True
