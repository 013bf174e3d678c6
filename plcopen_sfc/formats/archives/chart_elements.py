"""Elements of charts in archives of TwinCAT 3: the attributes of each, and the field of the model that each one is.

Declared once, for reading and writing. The editor describes its attributes in every archive: in categories, with the
values of enumerations. (14 files of TwinCAT 3.1.4024, which agree in all of this)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from lxml import etree

from plcopen_sfc.formats.archives.object_archive import (
    add_array,
    add_dictionary,
    add_none,
    add_text,
    add_value,
    identity,
    items,
    member,
    new_object,
    number_of,
    text_of,
    type_of,
    type_of_items,
)
from plcopen_sfc.formats.codesys import codesys_names as names

Fields = dict[str, Any]
"""Fields of a model object that is being read."""

STEP, TRANSITION, BRANCH, JUMP, MACRO = "SFCStep", "SFCTransition", "SFCBranch", "SFCJump", "SFCMacro"
SEGMENT, ASSOCIATION = "SFCSegment", "SFCActionAssociation"


@dataclass(frozen=True)
class Category:
    """A group of attributes in the editor; `parent` is the one around it."""

    guid: str
    name: str
    description: str
    parent: str = "00000000-0000-0000-0000-000000000000"


_COMMON = Category("6f37ae05-4d8f-4ddc-9e69-c0e6bd6962c2", "Common", "Common properties")
_SPECIFIC = Category("1c5c6e05-2bb7-4258-bcee-fd16a540c63c", "Specific", "Element type specific properties")
_TIMES = Category("d336ba06-8a67-4e6b-9697-50f83ba6bdde", "Times", "Time definitions", _SPECIFIC.guid)
_ACTIONS = Category("20f0fc67-978d-438b-979f-eef294f34ee4", "Actions", "Action definitions", _SPECIFIC.guid)
_CATEGORIES = (_SPECIFIC, _ACTIONS, _COMMON, _TIMES)
_FACTORY = "11e03a9d-fc7b-4112-850c-ae33fb04a2b4"


@dataclass(frozen=True)
class Choices:
    """An enumeration: the words of the editor, and those of the model, each with its place as its number."""

    guid: str
    words: tuple[str, ...]
    values: tuple[str, ...]


_ACCESS = Choices(
    "79a4fdd5-c859-4de4-aa8d-c03372c880c2", ("Unspecified", "None", "Read", "Write", "ReadWrite"), names.SYMBOL_VALUES
)
_WATCH = Choices("6ecff51c-9b8f-4338-aab0-67c2b31b07e9", ("None", "Variable", "Call"), names.MONITORING_VALUES)
_CHOICES = (_WATCH, _ACCESS)


@dataclass(frozen=True)
class Attribute:
    """An attribute of the editor: a text, a truth (`is_truth`) or one of `choices`.

    `hidden`, `shown` (in the chart itself) and `lines` (several) are how the editor offers it.
    """

    guid: str
    name: str
    category: Category
    description: str
    is_truth: bool = False
    choices: Choices | None = None
    hidden: bool = False
    shown: bool = False
    lines: bool = False

    @property
    def kind(self) -> str:
        """The type of its value in archives."""
        return "BoolValue" if self.is_truth else "EnumValue" if self.choices is not None else "StringValue"

    @property
    def default(self) -> str:
        """Its value where nothing was entered."""
        return "FALSE" if self.is_truth else "0" if self.choices is not None else ""

    def value(self, text: str) -> Any:
        """Return the value for the model; None where the text is no value of it, or the default."""
        if self.is_truth:
            return True if text == "TRUE" else None
        if self.choices is not None:
            known = text.isascii() and text.isdigit() and 0 < int(text[:9]) < len(self.choices.values)
            return self.choices.values[int(text)] if known else None
        return text or None

    def text(self, value: object) -> str:
        """Return the text for a value of the model."""
        if self.is_truth:
            return "TRUE" if value else "FALSE"
        if self.choices is not None:
            return str(self.choices.values.index(str(value))) if value is not None else "0"
        return str(value) if value is not None else ""


NAME = Attribute(names.NAME, "Name", _COMMON, "Name of the element")
COMMENT = Attribute(names.COMMENT, "Comment", _COMMON, "Comment of the element", shown=True, lines=True)
EXCLUDE = Attribute(
    names.EXCLUDE, "Exclude", _COMMON, "Exclude this element from build", is_truth=True, hidden=True
)  # fmt: skip
_SYMBOL = Attribute(
    names.SYMBOL, "Symbol", _COMMON, "Symbol configuration setting of the element", choices=_ACCESS, shown=True
)
_INITIAL = Attribute(names.INITIAL, "InitStep", _SPECIFIC, "Sets the step as the initial step", is_truth=True)
_DUPLICATION = Attribute(
    names.DUPLICATION,
    "Duplication",
    _SPECIFIC,
    "Copies the implementation of step actions or transitions with the element. Otherwise, copies the reference to an "
    "existing implementation.",
    is_truth=True,
)
_MIN_TIME = Attribute(names.MIN_TIME, "MinTime", _TIMES, "Defines the minimal active time for the step", shown=True)
_MAX_TIME = Attribute(names.MAX_TIME, "MaxTime", _TIMES, "Defines the maximal active time for the step", shown=True)
_MAIN = Attribute(
    names.MAIN_ACTION, "MainAction", _ACTIONS, "Name of the action to be called if the step is active", shown=True
)
_ENTRY = Attribute(
    names.ENTRY_ACTION, "EntryAction", _ACTIONS, "Name of the action to be called if the step is activated", shown=True
)
_EXIT = Attribute(
    names.EXIT_ACTION, "ExitAction", _ACTIONS, "Name of the action to be called if the step is deactivated", shown=True
)
_QUALIFIER = Attribute(names.QUALIFIER, "Qualifier", _SPECIFIC, "Qualifier of the action association")
PARALLEL = Attribute(names.PARALLEL, "Parallel", _SPECIFIC, "Sets the branch to parallel mode", is_truth=True)
_MONITORING = Attribute(
    names.MONITORING, "Monitoring", _SPECIFIC, "Indicates transition monitoring setting.", choices=_WATCH
)

_SHARED = {"name": NAME, "comment": COMMENT, "exclude": EXCLUDE}

ELEMENTS: Mapping[str, Mapping[str, Attribute]] = {
    STEP: {
        **_SHARED,
        "symbol": _SYMBOL,
        "initial": _INITIAL,
        "duplicate": _DUPLICATION,
        "min_time": _MIN_TIME,
        "max_time": _MAX_TIME,
        "main_action": _MAIN,
        "entry_action": _ENTRY,
        "exit_action": _EXIT,
    },
    TRANSITION: {**_SHARED, "symbol": _SYMBOL, "duplicate": _DUPLICATION, "monitoring": _MONITORING},
    ASSOCIATION: {**_SHARED, "symbol": _SYMBOL, "qualifier": _QUALIFIER},
    BRANCH: {**_SHARED, "parallel": PARALLEL},
    JUMP: _SHARED,
    SEGMENT: _SHARED,
    MACRO: _SHARED,
}
"""The attributes of each element in their order, by the field of the model.

``name`` is the condition of a transition, the target of an association and of a jump; ``qualifier`` has the duration
behind it.
"""

_BY_GUID = {kind: {each.guid: (field, each) for field, each in table.items()} for kind, table in ELEMENTS.items()}
ATTRIBUTES = {each.guid: each for table in ELEMENTS.values() for each in table.values()}


# -- reading ----------------------------------------------------------------------------------------------------------


def read_attributes(element: etree._Element, kind: str) -> tuple[Fields, list[etree._Element]]:
    """Return the fields that the attributes of an element state, without defaults, and what is not understood."""
    fields: Fields = {}
    unknown: list[etree._Element] = []
    given: set[str] = set()
    table = _BY_GUID[kind]
    found_in = items(element, "Attributes")
    shared = type_of_items(found_in[0]) if found_in else ""
    for attribute in found_in:
        guid, kind_of_value, text = _stated(attribute)
        field, known = table.get(guid.strip("{}").casefold(), ("", None))
        if known is None or kind_of_value != known.kind or text is None or field in given:
            unknown.append(attribute)
            continue
        given.add(field)
        if attribute.get("t", shared) != "SFCAttribute":
            unknown.append(attribute)
            continue
        found = known.value(text)
        if found is not None:
            fields[field] = found
        elif text != known.default:
            unknown.append(attribute)
    return fields, unknown


def _stated(attribute: etree._Element) -> tuple[str, str, str | None]:
    """Return identity, type and text of the value of an attribute, which are most of an archive: in one walk."""
    guid, kind, text = "", "", None
    for child in attribute:
        name = child.get("n")
        if name == "AttributeId":
            guid = text_of(child) or ""
        elif name == "Value":
            kind, text = child.get("t", ""), _quoted(member(child, "Value"))
            if guid:  # the rest are numbers
                break
    return guid, kind, text


def _quoted(value: etree._Element | None) -> str | None:
    """Return the text of a string; None where it has no quotes, which no file has shown."""
    text = (value.text or "") if value is not None and value.tag == "v" else ""
    return text[1:-1] if text[:1] == text[-1:] == '"' and len(text) > 1 else None


def objection(attribute: etree._Element, kind: str) -> str:
    """Return why an attribute of an element is not understood."""
    guid, kind_of_value, text = _stated(attribute)
    _, known = _BY_GUID[kind].get(guid.strip("{}").casefold(), ("", None))
    if not type_of(attribute):
        return f"the attribute {guid}: its list does not tell the type of its items"
    if known is None:
        return f"the attribute {guid} of an element is not understood: no file has shown it"
    if any(_stated(each)[0].casefold() == guid.casefold() for each in attribute.itersiblings("o", preceding=True)):
        return f"the attribute {known.name} is given twice"
    if kind_of_value != known.kind:
        return f"the attribute {known.name} is a {kind_of_value or 'value without a type'}, and not a {known.kind}"
    if text is not None:
        return f"the attribute {known.name} cannot be {text or 'without a value'}"
    value = next((text_of(member(each, "Value")) for each in attribute if each.get("n") == "Value"), None)
    return f"the value of the attribute {known.name} is no text in quotes, but {value or 'nothing'}"


def missing_attributes(element: etree._Element, kind: str) -> list[str]:
    """Return the names of the attributes that an element lacks; all known files have each, but for segments."""
    found = items(element, "Attributes")
    if len(found) >= len(ELEMENTS[kind]) or (kind == SEGMENT and not found):  # others are given in the place of some
        return []
    given = {_stated(each)[0].strip("{}").casefold() for each in found}
    return [each.name for each in ELEMENTS[kind].values() if each.guid not in given]


def attribute_numbers(element: etree._Element) -> Iterator[tuple[str, int]]:
    """Yield the number of each attribute of an element, by its GUID."""
    for attribute in items(element, "Attributes"):
        number = number_of(member(attribute, "Id"))
        if number is not None:
            yield (text_of(member(attribute, "AttributeId")) or "").strip("{}").casefold(), number


# -- writing ----------------------------------------------------------------------------------------------------------


def written_attribute(attribute: Attribute, value: object, *, number: int, parent: int) -> etree._Element:
    """Return an attribute of an element."""
    written = new_object("SFCAttribute")
    add_value(written, "AttributeId", identity(attribute.guid))
    holder = new_object(attribute.kind, "Value")
    if attribute.choices is not None:
        add_value(holder, "TemplateGuid", identity(attribute.choices.guid))
        add_none(holder, "BaseType")
    add_text(holder, "Value", attribute.text(value))
    add_text(holder, "DefaultValue", attribute.default)
    written.append(holder)
    add_value(written, "Id", f"{number}L")
    add_value(written, "IdParent", f"{parent}L")
    return written


def add_descriptions(chart: etree._Element) -> None:
    """Append the editor's data on its attributes."""
    add_dictionary(
        chart, "Categories", ("Guid", "SFCAttributeCategory"), {each.guid: _described(each) for each in _CATEGORIES}
    )
    known = {guid: _described_attribute(ATTRIBUTES[guid]) for guid in sorted(ATTRIBUTES)}
    add_dictionary(chart, "Attributes", ("Guid", "SFCAttributeDescription"), known)
    add_dictionary(
        chart,
        "EnumTemplates",
        ("Guid", "EnumValueTemplate"),
        {each.guid: _described_choices(each) for each in _CHOICES},
    )


def _described(category: Category) -> etree._Element:
    written = new_object("SFCAttributeCategory")
    _add_identity(written, category.guid, category.name, category.parent, category.description)
    return written


def _described_attribute(attribute: Attribute) -> etree._Element:
    written = new_object("SFCAttributeDescription")
    add_value(written, "ReadOnly", "false")
    add_value(written, "Hidden", str(attribute.hidden).lower())
    add_value(written, "EditorVisibility", str(attribute.shown).lower())
    add_value(written, "MultiLineEdit", str(attribute.lines).lower())
    _add_identity(written, attribute.guid, attribute.name, attribute.category.guid, attribute.description)
    return written


def _add_identity(written: etree._Element, guid: str, name: str, parent: str, description: str) -> None:
    add_value(written, "Factory", identity(_FACTORY))
    add_value(written, "Id", identity(guid))
    add_text(written, "Identifier", name)
    add_value(written, "Parent", identity(parent))
    add_text(written, "Description", description)


def _described_choices(choices: Choices) -> etree._Element:
    written = new_object("EnumValueTemplate")
    add_value(written, "TemplateGuid", identity(choices.guid))
    listed: list[etree._Element] = []
    for number, word in enumerate(choices.words):
        entry = new_object("EnumEntry")
        add_text(entry, "Identifier", word)
        add_value(entry, "Value", f"{number}L")
        add_text(entry, "Key", word)
        listed.append(entry)
    add_array(written, "Values", listed)
    add_text(written, "BaseType", "INT")
    return written
