"""Reasons why an element is invalid, in words that tell what to do.

libxml2 finds the place; here the element is looked at once more with the grammar in hand. The grammar comes from
xmlschema, which is slow to load: `schema_validation` imports this module only for files that libxml2 found invalid.
Codes (docs/diagnostics.md):

======  ==============================================================
XSD002  an element that is unknown, or not allowed in its place
XSD003  an element is missing
XSD004  an attribute is missing
XSD005  an unknown attribute
XSD006  the value of an attribute is not of its type
XSD007  the text of an element is not of its type
XSD008  text where only elements are allowed, or nothing at all
XSD009  an id that two elements have
XSD019  anything else, in libxml2's words
======  ==============================================================
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import xmlschema
from lxml import etree

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


Explanation = tuple[str, str, etree._Element]
"""Code, message, and the element that it is about."""


_XSI = "{http://www.w3.org/2001/XMLSchema-instance}"
_XHTML = "http://www.w3.org/1999/xhtml"
_MANY = 12


def explain_fault(element: etree._Element, schema: Path, fallback: str) -> list[Explanation]:
    """Return the errors of an element that libxml2 objected to; `fallback` are libxml2's words for it."""
    grammar = Grammar.of(schema)
    declaration = grammar.declaration(element)
    found: list[Explanation] = []
    if declaration is not None:
        found += _attributes(grammar, declaration, element)
        found += _content(grammar, declaration, element)
    parent = element.getparent()
    if not found and parent is not None:
        # libxml2 objects to the child; the reason is in the parent.
        above = grammar.declaration(parent)
        if above is not None:
            found += _children(grammar, above, parent)
    return found or [("XSD019", fallback, element)]


# Attributes


def _attributes(grammar: Grammar, declaration: Any, element: etree._Element) -> Iterator[Explanation]:
    declared: dict[str | None, Any] = dict(declaration.attributes)
    tag = local_name(element.tag)
    present = {str(name): str(value) for name, value in element.attrib.items()}
    for name, attribute in declared.items():
        if name is not None and attribute.use == "required" and name not in present:
            near = _similar(name, (other for other in present if other not in declared))
            message = f"<{tag}> has no {name}, which it must have: {grammar.kind(attribute.type)}"
            if grammar.base(attribute.type) == "string" and not attribute.type.enumeration:
                message = f"<{tag}> has no {name}, which it must have"
            yield "XSD004", message + (f"; {near} may be meant for it" if near else ""), element
    for name, value in present.items():
        if name.startswith(_XSI):
            continue
        if name not in declared:
            if None not in declared:
                yield _unknown_attribute(tag, name, declared, element)
            continue
        simple_type = declared[name].type
        if not grammar.accepts(simple_type, value):
            yield "XSD006", _wrong_value(grammar, f"{name}={_quoted(value)} of <{tag}>", simple_type, value), element
        elif grammar.base(simple_type) == "ID":
            yield from _duplicate(tag, name, value, element)


def _unknown_attribute(tag: str, name: str, declared: Iterable[str | None], element: etree._Element) -> Explanation:
    known = [other for other in declared if other is not None]
    if name.startswith("{"):
        message = f"<{tag}> has the foreign attribute {local_name(name)}, which this format does not allow"
        return "XSD005", f"{message}; data of one's own belong into addData", element
    message = f"<{tag}> has an unknown attribute {name}"
    near = _similar(name, known)
    if near:
        return "XSD005", f"{message}; {near} may be meant", element
    listed = f"it may have {_list(known)}" if known else "it may have none"
    return "XSD005", f"{message}; {listed}", element


def _duplicate(tag: str, name: str, value: str, element: etree._Element) -> Iterator[Explanation]:
    same = element.getroottree().xpath("//*[@*[local-name() = $name] = $value]", name=name, value=value)
    others = [other for other in same if other is not element] if isinstance(same, list) else []
    first = next((other for other in others if isinstance(other, etree._Element)), None)
    if first is not None:
        place = f"<{local_name(first.tag)}> in line {first.sourceline}"
        yield "XSD009", f"{name}={_quoted(value)} of <{tag}> is also the {name} of {place}; ids must differ", element


def _wrong_value(grammar: Grammar, what: str, simple_type: Any, value: str) -> str:
    message = f"{what} must be {grammar.kind(simple_type)}"
    better = _repaired(grammar, simple_type, value)
    return f"{message}; write {_quoted(better)}" if better else message


def _repaired(grammar: Grammar, simple_type: Any, value: str) -> str | None:
    """Return the value that was most likely meant."""
    candidates = [value.strip(), value.strip().replace(" ", "T", 1), value.lower(), value.upper()]
    candidates += [str(known) for known in simple_type.enumeration or () if str(known).lower() == value.strip().lower()]
    if grammar.base(simple_type) == "decimal":
        candidates.append(value.replace(",", "."))
    return next((better for better in candidates if better and grammar.accepts(simple_type, better)), None)


# Content


def _content(grammar: Grammar, declaration: Any, element: etree._Element) -> Iterator[Explanation]:
    tag = local_name(element.tag)
    content = declaration.type
    children = [child for child in element if isinstance(child.tag, str)]
    if content.is_simple() or content.has_simple_content():
        if children:
            yield "XSD002", f"<{tag}> holds text only; it must not contain an element", children[0]
            return
        text = "".join(str(part) for part in element.itertext())
        simple_type = content if content.is_simple() else content.content
        if not grammar.accepts(simple_type, text):
            yield "XSD007", _wrong_value(grammar, f"the text {_quoted(text)} of <{tag}>", simple_type, text), element
        return
    if content.mixed:
        return
    texts = [element.text, *(child.tail for child in element)]
    text = " ".join(part.strip() for part in texts if part and part.strip())
    empty = content.is_empty()
    if text:
        yield "XSD008", _stray_text(grammar, declaration, tag, text), element
    elif empty and any(texts):
        yield "XSD008", f"<{tag}> must be empty; not even blanks or line breaks are allowed in it", element
    if empty and children:
        yield "XSD002", f"<{tag}> must be empty; <{local_name(children[0].tag)}> is not allowed in it", children[0]
    elif not empty and not (text and not children and _holds_xhtml(declaration)):
        yield from _children(grammar, declaration, element)


def _stray_text(grammar: Grammar, declaration: Any, tag: str, text: str) -> str:
    message = f"text {_quoted(text)} is directly in <{tag}>"
    if _holds_xhtml(declaration):
        return f'{message}; it belongs into an element of XHTML: <{tag}><xhtml xmlns="{_XHTML}">...</xhtml></{tag}>'
    known = grammar.children(declaration)
    return f"{message}, where only elements are allowed" + (f": {_list(known)}" if known else "")


def _holds_xhtml(declaration: Any) -> bool:
    content = declaration.type.content
    particles = list(content.iter_elements()) if hasattr(content, "iter_elements") else []
    return len(particles) == 1 and particles[0].name is None and _XHTML in (particles[0].namespace or ())


def _children(grammar: Grammar, declaration: Any, element: etree._Element) -> Iterator[Explanation]:
    rejection = grammar.rejection(declaration, element)
    if rejection is None:
        return
    tag = local_name(element.tag)
    if _holds_xhtml(declaration):
        yield from _xhtml(tag, rejection, element)
    elif rejection.child is None:
        names = rejection.required or rejection.expected
        yield "XSD003", f"{_missing(names, grammar.children(declaration))} in <{tag}>", element
    else:
        yield _misplaced(grammar.children(declaration), element, rejection.child, rejection)


def _xhtml(tag: str, rejection: RejectedChild, element: etree._Element) -> Iterator[Explanation]:
    form = f'<{tag}><xhtml xmlns="{_XHTML}">...</xhtml></{tag}>'
    if rejection.child is None:
        yield "XSD003", f"<{tag}> is empty; it must hold one element of XHTML: {form}", element
    elif etree.QName(rejection.child).namespace == _XHTML:
        yield "XSD002", f"<{tag}> holds more than one element; put all into one: {form}", rejection.child
    else:
        child = local_name(rejection.child.tag)
        yield "XSD002", f"<{child}> is not allowed in <{tag}>, only one element of XHTML: {form}", rejection.child


def _misplaced(
    known: list[str], element: etree._Element, child: etree._Element, rejection: RejectedChild
) -> Explanation:
    """Explain a child that stops the sequence: unknown, once too often, out of order, or behind a missing one."""
    tag, name = local_name(element.tag), local_name(child.tag)
    if child.tag not in known:
        return "XSD002", _unknown_child(tag, child, known), child
    order = {each: number for number, each in enumerate(known)}
    own = order[str(child.tag)]
    before = next((each for each in child.itersiblings(preceding=True) if isinstance(each.tag, str)), None)
    reached = -1 if before is None else order.get(str(before.tag), -1)
    earlier = next(child.itersiblings(str(child.tag), preceding=True), None)
    if reached == own or (reached > own and earlier is not None):
        return "XSD002", f"a second <{name}> in <{tag}>; only one is allowed", child
    if before is not None and reached > own:
        return "XSD002", f"<{name}> is too late in <{tag}>: it must come before <{local_name(before.tag)}>", child
    missing = [each for each in rejection.required or rejection.expected if order.get(each, own) != own]
    if not missing and before is None:
        # The whole sequence may be left out, but not begun in its middle.
        missing = known[:own]
    if not missing:
        excludes = f"; <{local_name(before.tag)}> excludes it" if before is not None else ""
        return "XSD002", f"<{name}> is not allowed here in <{tag}>{excludes}", child
    if {each.tag for each in child.itersiblings()}.isdisjoint(missing):
        listed = missing[:1] if before is None and not rejection.expected else missing
        return "XSD003", f"{_missing(listed, known)} in <{tag}>, before <{name}>", child
    return "XSD002", f"<{name}> is too early in <{tag}>: {_list(missing)} must come first", child


def _unknown_child(tag: str, child: etree._Element, known: list[str]) -> str:
    name = local_name(child.tag)
    namesake = next((each for each in known if local_name(each) == name), None)
    if namesake is not None:
        found, wanted = etree.QName(child).namespace or "none", etree.QName(namesake).namespace or "none"
        return f"<{name}> in <{tag}> is in the wrong namespace: {found} instead of {wanted}"
    message = f"<{tag}> knows no <{name}>"
    near = _similar(name, (local_name(each) for each in known))
    if near:
        return f"{message}; <{near}> may be meant"
    if not known:
        return f"{message}; it must be empty"
    return f"{message}; it may hold {_list(known)}"


def _missing(names: Iterable[str], known: list[str]) -> str:
    listed = list(names) or known
    if len(listed) == 1:
        return f"<{local_name(listed[0])}> is missing"
    return f"one of {_list(listed)} is missing"


# Words


def _similar(name: str, candidates: Iterable[str]) -> str | None:
    by_lower = {candidate.lower(): candidate for candidate in candidates}
    for lower, candidate in by_lower.items():
        if len(lower) > 3 and (lower.startswith(name.lower()) or name.lower().startswith(lower)):
            return candidate
    near = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=0.75)
    return by_lower[near[0]] if near else None


def _list(names: Iterable[str]) -> str:
    plain = [local_name(name) for name in names]
    if len(plain) > _MANY:
        return ", ".join(plain[:_MANY]) + f" and {len(plain) - _MANY} more"
    return ", ".join(plain)


def _quoted(text: str) -> str:
    short = " ".join(text.split(" "))
    short = short if len(short) <= 60 else short[:57] + "..."
    return '"' + short.replace("\n", "\\n") + '"'


_XS = "{http://www.w3.org/2001/XMLSchema}"
_KINDS = {
    "dateTime": "a date and time like 2024-01-31T08:30:00",
    "date": "a date like 2024-01-31",
    "time": "a time of day like 08:30:00",
    "boolean": "true or false",
    "decimal": "a number like 12.5",
    "integer": "a whole number",
    "long": "a whole number",
    "unsignedLong": "a whole number, 0 or greater",
    "anyURI": "a web address or other URI",
    "language": "a language code like de or en-US",
    "ID": "a name that no other element of the file has, beginning with a letter or an underscore",
}


def local_name(tag: object) -> str:
    """Return a tag without its namespace."""
    return str(tag).rpartition("}")[2]


@dataclass(frozen=True, slots=True)
class RejectedChild:
    """A child that is not allowed in its place, or (`child` None) the end of an element that came too early.

    `expected` are the tags that are allowed there, `required` those of them without which it does not go on.
    """

    child: etree._Element | None
    expected: tuple[str, ...]
    required: tuple[str, ...]


class Grammar:
    """One of our schemas, for asking."""

    def __init__(self, path: Path) -> None:
        # The file belongs to the package; still, nothing in it could make xmlschema look anywhere but on this disk.
        self._schema: Any = xmlschema.XMLSchema10(str(path), allow="local")

    @staticmethod
    @cache
    def of(path: Path) -> Grammar:
        """Return the grammar of a schema, loaded once."""
        return Grammar(path)

    def declaration(self, element: etree._Element) -> Any | None:
        """Return the declaration of an element in its place; None where the schema has none (foreign elements)."""
        parent = element.getparent()
        if parent is None:
            return self._schema.maps.elements.get(element.tag)
        above = self.declaration(parent)
        found = None
        if above is not None and not above.type.has_simple_content():
            found = next((child for child in _child_declarations(above) if child.name == element.tag), None)
        # In foreign data everything that is declared globally is checked in every place.
        wild = above is None or above.type.name == f"{_XS}anyType"
        wild = wild or any(child.name is None for child in _child_declarations(above))
        return self._schema.maps.elements.get(element.tag) if found is None and wild else found

    @staticmethod
    def children(declaration: Any) -> list[str]:
        """Return the tags that an element may contain, in the order of the schema."""
        return list(dict.fromkeys(child.name for child in _child_declarations(declaration) if child.name is not None))

    @staticmethod
    def rejection(declaration: Any, element: etree._Element) -> RejectedChild | None:
        """Return the first thing that is wrong with the children of an element; None if their order is right."""
        # The content of the children is not of interest here, so they are looked at without it.
        children = [child for child in element if isinstance(child.tag, str)]
        shell = etree.Element(element.tag)
        for each in children:
            shell.append(etree.Element(each.tag))
        for error in declaration.iter_errors(shell):
            if isinstance(error, xmlschema.XMLSchemaChildrenValidationError) and error.elem is cast("Any", shell):
                particles: list[Any] = list(error.expected or ())
                names = tuple(dict.fromkeys(particle.name for particle in particles if particle.name))
                required = tuple(p.name for p in particles if p.name and p.min_occurs > 0)
                child = children[error.index] if error.index < len(children) else None
                return RejectedChild(child, names, required)
        return None

    @staticmethod
    def kind(simple_type: Any) -> str:
        """Return the form of a value of this type, in words."""
        if simple_type.enumeration:
            return "one of " + ", ".join(str(value) for value in simple_type.enumeration)
        low, high = simple_type.min_value, simple_type.max_value
        base = _builtin(simple_type)
        if simple_type.name == _XS + base:
            return _KINDS.get(base, f"a value of type {base}")
        if base == "integer" and low is not None and high is not None:
            return f"a whole number from {low} to {high}"
        if simple_type.patterns:
            return "of the form " + " or ".join(simple_type.patterns.regexps)
        return _KINDS.get(base, f"a value of type {base}")

    @staticmethod
    def accepts(simple_type: Any, value: str) -> bool:
        """True if a value is one of this type."""
        return bool(simple_type.is_valid(value))

    @staticmethod
    def base(simple_type: Any) -> str:
        """Return the name of the type of XML Schema that a type is derived from (``dateTime``)."""
        return _builtin(simple_type)


def _child_declarations(declaration: Any) -> Iterator[Any]:
    content = declaration.type.content
    if hasattr(content, "iter_elements"):
        yield from content.iter_elements()


def _builtin(simple_type: Any) -> str:
    node = simple_type
    while node is not None and not str(node.name).startswith(_XS):
        node = node.base_type
    return local_name(node.name) if node is not None else "string"
