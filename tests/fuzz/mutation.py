"""Damaged copies of files of every format, each from a seed: structure-aware where the format has a structure."""

from __future__ import annotations

import copy
import io
import json
import re
import zipfile
import zlib
from collections.abc import Callable
from functools import cache
from random import Random
from typing import Any, NamedTuple

from lxml import etree

import plcopen_sfc as sfc
from tests import mutants
from tests.samples import FIXTURES

FORMATS = (
    *("plcopen", "codesys", "codesys-export", "codesys23", "twincat", "simaticml"),
    *("scl", "iec-text", "grafcet", "grafcet-text", "json", "csv", "xlsx"),
)
_LARGEST = 120_000
_SOURCES = {
    "plcopen": ("plcopen/*.xml", "training-chain/plcopen_*.xml"),
    "codesys": ("codesys/*.xml", "twincat/*.xml", "training-chain/c*codesys.xml"),
    "codesys-export": ("codesys-export/*.export",),
    "codesys23": ("codesys23/*",),
    "twincat": ("twincat-belt/*", "twincat-belt/*/*"),
    "simaticml": ("simaticml/*.xml", "simaticml-plc/*/*.xml", "simaticml-training-chain/*.xml"),
    "scl": ("scl/*.scl", "training-chain/*.scl"),
    "iec-text": ("iectext/*.st", "training-chain/*.st"),
    "grafcet-text": ("grafcet/*.gct",),
    "json": ("training-chain/*.json",),
    "csv": ("steplist/*.csv",),
    "xlsx": ("steplist/*.xlsx",),
}
_CONVERTED = {
    "plcopen": ("scl", "csv"),
    "codesys": ("scl", "csv"),
    "iec-text": ("scl", "csv"),
    "codesys-export": ("scl", "csv"),
    "codesys23": ("scl", "csv"),
    "twincat": ("scl", "iec-text"),
    "grafcet": ("grafcet-text",),
    "json": ("grafcet-text", "iec-text", "simaticml", "csv"),
    "xlsx": ("csv",),
}
"""Formats that are also made of fixtures of other formats."""

WRONG = (
    *("1" * 5000, "1E999", "-7", "²", "", "9" * 20, "0x1", "#", '"', "'", "$", "1.5.6", "\x0c", "T#99999999999999999d"),
    *("((((", "END_IF", "_", "a" * 300, ";", "(*", "*)", "{", "}", "//", "\u200b", "\x01", "\ufeff", "16#", "=", ":="),
    *("END_STRUCT", "END_VAR", "STRING[9999999999]", "ARRAY[0..2147483647] OF INT", "&amp;", "]]>", "A.B.C[1].D"),
)
_IN_XML = re.compile(r'(?<![A-Za-z0-9_])\d+(?![A-Za-z0-9_])|(?<==")[^"]*(?=")|(?<=>)[^<>]+(?=<)')
_TOKEN = re.compile(r"\w+|[^\w\s]")


class MutatedFile(NamedTuple):
    """A damaged file: its format, the file it was, and its bytes."""

    format: str
    source: str
    data: bytes


@cache
def sources(kind: str) -> tuple[tuple[str, bytes], ...]:
    """Names and bytes of the files that mutants of a format are made of."""
    found = [
        (path.relative_to(FIXTURES).as_posix(), path.read_bytes())
        for pattern in _SOURCES.get(kind, ())
        for path in sorted(FIXTURES.glob(pattern))
        if path.is_file() and path.stat().st_size < _LARGEST
    ]
    for other in _CONVERTED.get(kind, ()):
        for name, data in sources(other):
            project = sfc.loads(data, format=other)
            project.accept_errors()
            try:
                made = sfc.dumps(project, format=kind, partial=True)
            except sfc.ModelError:  # more than a file of this format holds
                continue
            if len(made) < _LARGEST:
                found.append((f"{name} as {kind}", made))
    return tuple(found)


def mutant(kind: str, seed: int) -> MutatedFile:
    """The mutant number `seed` of a format."""
    chance = Random(f"{kind} {seed}")  # noqa: S311  # no secret
    pool = sources(kind)
    name, data = chance.choices(pool, [1 / (_SMALL + len(each)) for _, each in pool])[0]
    others = [each for _, each in sources(kind)]
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        damage: Callable[[bytes, Random, list[bytes]], bytes]
        if chance.random() < _ROUGH:
            damage = _damaged_bytes
        elif kind == "xlsx":
            damage = _damaged_workbook
        elif kind == "json":
            damage = _damaged_json
        elif data.lstrip(b"\xef\xbb\xbf \r\n").startswith(b"<"):
            damage = _damaged_xml if chance.random() < _STRUCTURAL else _replaced_word
        else:
            damage = _damaged_text
        data = damage(data, chance, others)
    return MutatedFile(kind, name, data)


_ROUGH, _STRUCTURAL = 0.04, 0.6
_SMALL = 8000
"""Files much larger than this are taken less often, so that many mutants can be tried."""


def _damaged_bytes(data: bytes, chance: Random, others: list[bytes]) -> bytes:
    """A file that ends early, lacks a part, has one twice, or has some bytes of chance."""
    start = chance.randrange(len(data) + 1)
    end = min(len(data), start + chance.choice((1, 3, 40, 2000)))
    other = chance.choice(others)
    place = chance.randrange(len(other) + 1)
    put = chance.choice((b"", b"", data[start:end] * 2, chance.randbytes(3), other[place : place + 500]))
    return data[:start] if chance.random() < 0.2 else data[:start] + put + data[end:]


def _replaced_word(data: bytes, chance: Random, others: list[bytes]) -> bytes:
    """XML with another value of an attribute, or another word in a text."""
    text, encoding = _decoded(data)
    places = list(_IN_XML.finditer(text))
    if not places:
        return data
    place = chance.choice(places)
    start, end = place.span()
    words = list(_TOKEN.finditer(place.group()))
    if len(words) > 1 and chance.random() < 0.7:  # a program: one word of it
        word = chance.choice(words)
        start, end = start + word.start(), start + word.end()
    put = chance.choice(WRONG) if chance.random() < 0.7 else chance.choice(places).group()
    del others
    return (text[:start] + put + text[end:]).encode(encoding, "replace")


def _damaged_xml(data: bytes, chance: Random, others: list[bytes]) -> bytes:
    """XML with an element or attribute gone, doubled, moved, renamed, from another file, or new."""
    try:
        root = etree.fromstring(data)
    except etree.XMLSyntaxError:
        return _replaced_word(data, chance, others)
    elements = list(root.iter(etree.Element))
    tags = sorted({etree.QName(each).localname for each in elements})
    names = sorted({str(name) for each in elements for name in each.attrib})
    values = [*mutants.VALUES, *(word for word in WRONG if word.isprintable())]
    values += sorted({str(value) for each in elements for value in each.attrib.values()})[:200]
    mutator = mutants.Mutator(root, str(chance.random()), tags=tags, attributes=names, values=values)
    if chance.random() < 0.1:
        try:
            graft = etree.fromstring(chance.choice(others))
        except etree.XMLSyntaxError:
            return data
        place = chance.choice(elements)
        place.insert(chance.randint(0, len(place)), copy.deepcopy(chance.choice(list(graft.iter(etree.Element)))))
        changed = root
    else:
        try:
            changed = mutator.mutant()
        except (AttributeError, IndexError, ValueError):  # the root alone, or what XML does not have
            return _replaced_word(data, chance, others)
    return etree.tostring(changed, xml_declaration=True, encoding="utf-8")


def _damaged_workbook(data: bytes, chance: Random, others: list[bytes]) -> bytes:
    """A workbook with one part gone, doubled in another's place, or damaged; mostly cells and texts."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            parts = {name: archive.read(name) for name in archive.namelist()}
    except (zipfile.BadZipFile, zlib.error, ValueError, NotImplementedError, OSError, RuntimeError):
        return _damaged_bytes(data, chance, others)
    telling = [name for name in parts if "sheet" in name.casefold() or "strings" in name.casefold()]
    name = chance.choice(telling if telling and chance.random() < 0.8 else list(parts))
    match chance.choice(("remove", "exchange", *("damage",) * 18)):
        case "remove":
            del parts[name]
        case "exchange":
            parts[name] = parts[chance.choice(list(parts))]
        case _:
            damage = _damaged_xml if chance.random() < _STRUCTURAL else _replaced_word
            parts[name] = damage(parts[name], chance, [parts[name]])
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as archive:
        for each, content in parts.items():
            archive.writestr(zipfile.ZipInfo(each), content)
    return written.getvalue()


def _damaged_text(data: bytes, chance: Random, others: list[bytes]) -> bytes:
    """A text with words or lines gone, doubled, exchanged, from another file, or wrong ones."""
    text, encoding = _decoded(data)
    if chance.random() < 0.4:
        lines = text.splitlines(keepends=True) or [""]
        line = chance.randrange(len(lines))
        count = chance.choice((1, 1, 2, 5, 20))
        match chance.choice(("remove", "double", "move", "other")):
            case "remove":
                del lines[line : line + count]
            case "double":
                lines[line:line] = lines[line : line + count]
            case "move":
                moved = lines[line : line + count]
                del lines[line : line + count]
                place = chance.randint(0, len(lines))
                lines[place:place] = moved
            case "other":
                graft = _decoded(chance.choice(others))[0].splitlines(keepends=True)
                place = chance.randrange(len(graft) or 1)
                lines[line:line] = graft[place : place + count]
        return "".join(lines).encode(encoding, "replace")
    tokens = list(_TOKEN.finditer(text))
    if not tokens:
        return data
    one, other = chance.choice(tokens), chance.choice(tokens)
    put = chance.choice(("", f"{one.group()} {one.group()}", other.group(), chance.choice(WRONG), chance.choice(WRONG)))
    return (text[: one.start()] + put + text[one.end() :]).encode(encoding, "replace")


def _damaged_json(data: bytes, chance: Random, others: list[bytes]) -> bytes:
    """JSON with a value gone, doubled, moved, of another kind, or from another file."""
    try:
        root = json.loads(data)
        graft = json.loads(chance.choice(others))
    except ValueError:
        return _damaged_text(data, chance, others)
    holder, key = chance.choice(_places(root))
    match chance.choice(("remove", "wrong", "wrong", "double", "exchange", "graft")):
        case "remove":
            del holder[key]
        case "wrong":
            holder[key] = chance.choice(
                [None, True, 0, -1, 1.5, 10**30, [], {}, [None], {"x": 1}, "", "x", "N", "\ud800", *WRONG]
            )
        case "double" if isinstance(holder, list):
            holder.insert(key, copy.deepcopy(holder[key]))
        case "exchange":
            to, place = chance.choice(_places(root))
            holder[key] = copy.deepcopy(to[place])
        case _:
            to, place = chance.choice(_places(graft))
            holder[key] = copy.deepcopy(to[place])
    return json.dumps(root, indent=1).encode()


def _places(root: Any) -> list[tuple[Any, Any]]:
    """Every place of a value in a tree of JSON: what holds it and its key there."""
    found: list[tuple[Any, Any]] = []
    left = [root]
    while left:
        holder = left.pop()
        items = holder.items() if isinstance(holder, dict) else enumerate(holder)
        for key, value in items:
            found.append((holder, key))
            if isinstance(value, dict | list):
                left.append(value)
    return found or [({"": None}, "")]


def _decoded(data: bytes) -> tuple[str, str]:
    for encoding in ("utf-8-sig" if data.startswith(b"\xef\xbb\xbf") else "utf-8", "utf-16", "cp1252"):
        try:
            return data.decode(encoding), encoding
        except UnicodeDecodeError:
            continue
    return data.decode("latin-1"), "latin-1"
