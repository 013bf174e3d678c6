"""Whatever the file looks like and whatever is edited: the edit arrives, and nothing else text_edits.

Random trees, written as files in random handwritings, with and without things that the trees do not know; random edits.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from lxml import etree

from plcopen_sfc.formats.xml.source_patch import patch_xml
from plcopen_sfc.formats.xml.source_tree import text_edits
from plcopen_sfc.formats.xml.xml_parsing import decode_xml, parse_xml
from plcopen_sfc.languages.text_edits import Edit

if TYPE_CHECKING:
    from collections.abc import Callable

NAMESPACES = ("", "urn:one", "urn:two")
VENDOR = "urn:vendor"
_PREFIXES = {"urn:one": "o", "urn:two": "t", VENDOR: "v"}

texts = st.text(alphabet="ab <>&\"'\n]ä€;=#", min_size=1, max_size=12).filter(lambda text: text.strip() == text)
values = st.text(alphabet="ab <>&\"'\nä€", max_size=6)
tags = st.builds(
    lambda uri, local: f"{{{uri}}}{local}" if uri else local,
    st.sampled_from(NAMESPACES),
    st.sampled_from(["step", "transition", "body", "p"]),
)
attribute_names = st.sampled_from(["name", "width", "{urn:two}hint", "refLocalId"])


@st.composite
def elements(draw: st.DrawFn, depth: int = 3) -> etree._Element:
    """A tree as a writer makes it: text or children, now and then both; no white space of its own."""
    # With prefixes of its own: lxml gives every detached element "ns0" and then mixes them up when they are joined.
    element = etree.Element(draw(tags), nsmap={"a": "urn:one", "b": "urn:two"})
    if draw(st.booleans()):
        element.set("localId", str(draw(st.integers(0, 6))))
    for name, value in draw(st.dictionaries(attribute_names, values, max_size=2)).items():
        element.set(name, value)
    shape = draw(st.sampled_from(["empty", "text", "children", "children", "children", "mixed"])) if depth else "text"
    if shape == "text":
        element.text = draw(texts)
    if shape in {"children", "mixed"}:
        for child in draw(st.lists(elements(depth=depth - 1), max_size=4)):
            element.append(child)
            if shape == "mixed":
                child.tail = draw(texts)
    return element


@dataclass
class WritingStyle:
    """How the source is written, and what it says that the trees do not."""

    choose: Callable[[int], int]
    newline: str
    indent: str | None
    unknown: bool
    encoding: str
    bom: bytes
    declaration: str


_ENCODINGS = (
    ("utf-8", b"", ""),
    ("utf-8", b"\xef\xbb\xbf", '<?xml version="1.0" encoding="utf-8"?>'),
    ("utf-16-le", b"\xff\xfe", "<?xml version='1.0' encoding='UTF-16' standalone='yes' ?>"),
    ("iso-8859-1", b"", '<?xml version="1.0" encoding="ISO-8859-1"?>'),
    ("windows-1252", b"", '<?xml version="1.0" encoding="windows-1252"?>'),
)


@st.composite
def styles(draw: st.DrawFn, *, unknown: bool) -> WritingStyle:
    encoding, bom, declaration = draw(st.sampled_from(_ENCODINGS))
    random = draw(st.randoms(use_true_random=False))
    return WritingStyle(
        choose=random.randrange,
        newline=draw(st.sampled_from(["\n", "\r\n"])),
        indent=draw(st.sampled_from(["  ", "\t", "    ", None])),
        unknown=unknown,
        encoding=encoding,
        bom=bom,
        declaration=declaration,
    )


def write(root: etree._Element, style: WritingStyle) -> bytes:
    """The tree as a file in an untidy handwriting."""
    newline = style.newline if style.indent is not None else ""
    text = _written(root, style, {}, 0)
    head = style.declaration + newline if style.declaration else ""
    if style.unknown:
        head += "<!-- written by <tool> /> -->" + newline
    text = head + text + newline
    return style.bom + text.encode(style.encoding, "xmlcharrefreplace")


def _written(element: etree._Element, style: WritingStyle, scope: dict[str, str], level: int) -> str:
    scope = dict(scope)
    parts: list[str] = []
    name = _name(element.tag, scope, parts, style, attribute=False)
    for key, value in element.attrib.items():
        parts.append(_attribute(_name(key, scope, parts, style, attribute=True), value, style))
    if style.unknown and style.choose(3) == 0:
        plain = _name(f"{{{VENDOR}}}note", scope, parts, style, attribute=True)
        parts.insert(style.choose(len(parts) + 1), _attribute(plain, "</keep>", style))
    blank = (" ", "  ", "\n   ")[max(0, style.choose(6) - 3)]
    head = blank.join([name, *parts])
    inner = _inner(element, style, scope, level)
    if inner:
        return f"<{head}>{inner}</{name}>"
    return f"<{head}{('/>', ' />', f'></{name}>')[style.choose(3)]}"


def _inner(element: etree._Element, style: WritingStyle, scope: dict[str, str], level: int) -> str:
    mixed = bool((element.text or "").strip()) or any((child.tail or "").strip() for child in element)
    pieces: list[str] = []
    for child in element:
        if style.unknown and style.choose(4) == 0:
            pieces.append(("<!-- a <b/> -->", "<?pi x?>", f'<u:x xmlns:u="{VENDOR}">\n?</u:x>')[style.choose(3)])
        text = _written(child, style, scope, level + 1)
        pieces.append(text + _text(child.tail or "", style) if mixed else text)
    if mixed or not pieces:
        return _text(element.text or "", style) + "".join(pieces)
    if style.indent is None:
        return "".join(pieces)
    lines = "".join(style.newline + style.indent * (level + 1) + piece for piece in pieces)
    return lines + style.newline + style.indent * level


def _name(tag: str, scope: dict[str, str], parts: list[str], style: WritingStyle, *, attribute: bool) -> str:
    uri, _, local = tag.rpartition("}")
    uri = uri[1:]
    if not uri:
        if not attribute and scope.get(""):
            scope[""] = ""
            parts.append('xmlns=""')
        return local
    known = [prefix for prefix, value in scope.items() if value == uri and (prefix or not attribute)]
    if known:
        return f"{known[0]}:{local}" if known[0] else local
    prefix = "" if not attribute and style.choose(2) else _PREFIXES[uri]
    scope[prefix] = uri
    parts.append(f'xmlns:{prefix}="{uri}"' if prefix else f'xmlns="{uri}"')
    return f"{prefix}:{local}" if prefix else local


def _attribute(name: str, value: str, style: WritingStyle) -> str:
    quote = "\"'"[style.choose(2)]
    table = {"&": "&amp;", "<": "&lt;", "\n": "&#xA;", quote: "&quot;" if quote == '"' else "&apos;"}
    if style.choose(2):
        table |= {">": "&gt;", "a": "&#97;"}
    raw = value.translate(str.maketrans(table))
    return f"{name}{('=', ' = ')[style.choose(8) == 0]}{quote}{raw}{quote}"


def _text(value: str, style: WritingStyle) -> str:
    encodable = value.encode(style.encoding, "ignore").decode(style.encoding) == value
    if style.choose(3) == 0 and "]]>" not in value and encodable:
        cut = style.choose(len(value) + 1) if style.unknown else 0
        raw = (_escaped(value[:cut], style), value[cut:].replace("\n", style.newline))
        return raw[0] + f"<![CDATA[{raw[1]}]]>" if value else ""
    return _escaped(value, style)


def _escaped(value: str, style: WritingStyle) -> str:
    raw = value.replace("&", "&amp;").replace("<", "&lt;")
    raw = raw.replace(">", "&gt;") if style.choose(2) else raw.replace("]]>", "]]&gt;")
    if style.choose(2):
        raw = raw.replace('"', "&quot;").replace("ä", "&#xe4;")
    return raw.replace("\n", style.newline)


@st.composite
def edited(draw: st.DrawFn, before: etree._Element, *, most: int = 4) -> etree._Element:
    """A copy of the tree with some edits."""
    after = copy.deepcopy(before)
    for _ in range(draw(st.integers(0, most))):
        nodes = list(after.iter())
        _edit(draw, nodes[draw(st.integers(0, len(nodes) - 1))], after)
    return after


def _edit(draw: st.DrawFn, node: etree._Element, root: etree._Element) -> None:
    kind = draw(st.sampled_from(["set", "delete", "text", "insert", "remove", "move", "swap", "clear"]))
    parent = node.getparent()
    if kind == "set":
        node.set(draw(st.sampled_from(["name", "width", "localId", "{urn:two}hint", "new"])), draw(values))
    elif kind == "delete" and node.attrib:
        del node.attrib[draw(st.sampled_from(sorted(node.attrib)))]
    elif kind == "text" and len(node) == 0:
        node.text = draw(st.none() | texts)
    elif kind == "insert" and not node.text:
        node.insert(draw(st.integers(0, len(node))), draw(elements(depth=1)))
    elif kind in {"remove", "move"} and parent is not None:
        tail, node.tail = node.tail, None
        parent.remove(node)
        if kind == "move":
            targets = [other for other in root.iter() if not other.text]
            if targets:
                target = targets[draw(st.integers(0, len(targets) - 1))]
                target.insert(draw(st.integers(0, len(target))), node)
        del tail
    elif kind == "swap" and len(node) > 1:
        node.append(node[0])
    elif kind == "clear":
        for child in list(node):
            node.remove(child)
        node.text = None


def meaning(element: etree._Element, *, known_only: bool = False) -> tuple[object, ...]:
    """The content of a tree: without comments, instructions, blanks between elements and the choice of prefixes."""
    text = element.text or ""
    parts: list[object] = []
    for child in element:
        if not isinstance(child.tag, str) or (known_only and child.tag.startswith(f"{{{VENDOR}}}")):
            text += child.tail or ""
            continue
        parts += [text, meaning(child, known_only=known_only)]
        text = child.tail or ""
    parts.append(text)
    if len(parts) > 1 and not any(part.strip() for part in parts if isinstance(part, str)):
        parts = [part for part in parts if not isinstance(part, str)]
    elif known_only and isinstance(parts[0], str) and len(parts) == 1 and not parts[0].strip():
        parts = [""]
    attributes = sorted(
        (str(name), str(value))
        for name, value in element.attrib.items()
        if not (known_only and str(name).startswith(f"{{{VENDOR}}}"))
    )
    return (element.tag, tuple(attributes), tuple(parts))


_SETTINGS = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


@pytest.mark.slow
@_SETTINGS
@given(st.data())
def test_no_edit_gives_the_same_bytes(data: st.DataObject) -> None:
    tree = data.draw(elements())
    source = write(tree, data.draw(styles(unknown=True)))
    assert patch_xml(source, tree, etree.fromstring(etree.tostring(tree))) == source


@pytest.mark.slow
@_SETTINGS
@given(st.data())
def test_the_result_says_what_the_edited_tree_says(data: st.DataObject) -> None:
    before = data.draw(elements())
    source = write(before, data.draw(styles(unknown=False)))
    assert meaning(parse_xml(source)) == meaning(before)
    after = data.draw(edited(before))
    assert meaning(parse_xml(patch_xml(source, before, after))) == meaning(after)


@_SETTINGS
@given(st.data())
def test_with_unknown_parts_the_known_ones_say_what_the_edited_tree_says(data: st.DataObject) -> None:
    before = data.draw(elements())
    source = write(before, data.draw(styles(unknown=True)))
    after = data.draw(edited(before))
    result = parse_xml(patch_xml(source, before, after))
    assert meaning(result, known_only=True) == meaning(after, known_only=True)


def _middles(old: str, new: str) -> tuple[str, str]:
    """The middle of two texts, without their common beginning and end."""
    (change,) = text_edits(old.replace("\n", " "), new.replace("\n", " ")) or [Edit(0, 0, "")]
    return old[change.start : change.end], change.text


@_SETTINGS
@given(st.data())
def test_an_attribute_edit_stays_inside_the_tag(data: st.DataObject) -> None:
    before = data.draw(elements())
    source = write(before, data.draw(styles(unknown=True)))
    after = copy.deepcopy(before)
    nodes = list(after.iter())
    node = nodes[data.draw(st.integers(0, len(nodes) - 1))]
    node.set("name", data.draw(values))
    old, new = _middles(decode_xml(source)[0], decode_xml(patch_xml(source, before, after))[0])
    assert "<" not in old
    assert "<" not in new


@pytest.mark.slow
@_SETTINGS
@given(st.data())
def test_a_new_child_only_adds(data: st.DataObject) -> None:
    before = data.draw(elements())
    source = write(before, data.draw(styles(unknown=True)))
    after = copy.deepcopy(before)
    parents = [node for node in after.iter() if len(node) and not _has_text(node)]
    assume(parents)
    parent = parents[data.draw(st.integers(0, len(parents) - 1))]
    parent.insert(data.draw(st.integers(0, len(parent))), etree.Element("added"))
    result = patch_xml(source, before, after)
    old, new = _middles(decode_xml(source)[0], decode_xml(result)[0])
    assert old == ""
    assert new.count("<") <= 2  # `<added/>` or `<added></added>`


@pytest.mark.slow
@_SETTINGS
@given(st.data())
def test_a_removed_child_is_only_cut_out(data: st.DataObject) -> None:
    before = data.draw(elements())
    source = write(before, data.draw(styles(unknown=True)))
    after = copy.deepcopy(before)
    nodes = [node for node in after.iter() if node is not after and not _has_text(node.getparent())]
    nodes = [node for node in nodes if len(node.getparent()) > 1]
    assume(nodes)
    node = nodes[data.draw(st.integers(0, len(nodes) - 1))]
    node.getparent().remove(node)
    _, new = _middles(decode_xml(source)[0], decode_xml(patch_xml(source, before, after))[0])
    assert new == ""


def _has_text(element: etree._Element | None) -> bool:
    return element is not None and bool(element.text or any(child.tail for child in element))


@pytest.mark.slow
@_SETTINGS
@given(st.data())
def test_what_only_the_source_knows_survives_every_edit_but_removal(data: st.DataObject) -> None:
    """Where every element has a key of its own. Elements without one that change places can be taken for each other."""
    before = data.draw(elements())
    for number, node in enumerate(before.iter()):
        node.set("localId", str(number))
    source = write(before, data.draw(styles(unknown=True)))
    after = copy.deepcopy(before)
    for node in list(after.iter()):
        if data.draw(st.integers(0, 2)) == 0:
            node.set("width", data.draw(values))
        if node.getparent() is not None and not node.tail and data.draw(st.integers(0, 5)) == 0:
            node.getparent().append(node)
        if node.text and data.draw(st.booleans()):
            node.text = data.draw(texts)
    result = patch_xml(source, before, after)

    def unknown(root: etree._Element) -> list[str]:
        notes = [node.get(f"{{{VENDOR}}}note", "") for node in root.iter(etree.Element)]
        others = [
            etree.tostring(node, encoding="unicode", with_tail=False)
            for node in root.iter()
            if not isinstance(node.tag, str) or node.tag.startswith(f"{{{VENDOR}}}")
        ]
        return sorted(note for note in notes if note) + sorted(text[:20] for text in others)

    assert unknown(parse_xml(result)) == unknown(parse_xml(source))


@_SETTINGS
@given(st.data())
def test_there_and_back(data: st.DataObject) -> None:
    """An edit and its opposite give a file that says what the first one said."""
    before = data.draw(elements())
    source = write(before, data.draw(styles(unknown=False)))
    after = data.draw(edited(before))
    back = patch_xml(patch_xml(source, before, after), after, before)
    assert meaning(parse_xml(back)) == meaning(before)
