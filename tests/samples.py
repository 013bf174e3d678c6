"""The files that many tests run over, and how tests look at files without the code under test."""

from __future__ import annotations

import codecs
import difflib
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from xml.parsers import expat
from xml.sax.saxutils import escape

import pytest
from _pytest.mark import ParameterSet
from lxml import etree

from plcopen_sfc.model import Project
from tests.corpus import ROOT, corpus_files
from tests.sweeps import some_files

FIXTURES = ROOT / "fixtures"
UNREADABLE = frozenset(
    """
    not_xml.txt truncated.xml wrong_root.xml unknown_version.xml lying_encoding.xml entity_bomb.xml external_entity.xml
    empty.xml added_configuration_with_a_field_of_nobody.xml no_headings.csv quote_without_end.csv
    """.split()
)
TC6 = (
    "http://www.plcopen.org/xml/tc6.xsd",
    "http://www.plcopen.org/xml/tc6_0200",
    "http://www.plcopen.org/xml/tc6_0201",
)
NEW = "Zz9_Neuer_Schritt"
"""A name that no file has."""
NAME_GUID = "38391c6d-6d4a-42f8-8ee7-9f45e5adafa8"


def accepting(project: Project) -> Project:
    """Return `project`, its errors accepted: sweeps convert damaged files too."""
    project.accept_errors()
    return project


def fixture_files() -> list[Path]:
    """Every fixture of PLCopen XML that can be loaded."""
    found = (path for path in FIXTURES.rglob("*.xml") if path.name not in UNREADABLE)
    return sorted(path for path in found if not path.relative_to(FIXTURES).parts[0].startswith("simaticml"))


def real_files() -> list[Path]:
    """The PLCopen and CODESYS files of the corpus."""
    return [path for kind in ("plcopen", "codesys") for path in corpus_files(kind)]


def label(path: Path) -> str:
    """A short name for a file in the list of tests."""
    parts = path.parts
    return "/".join(parts[-2:]) if path.is_relative_to(FIXTURES) else f"corpus/{parts[-2][:14]}/{path.name}"


FIXTURE_PARAMS = [pytest.param(path, id=label(path)) for path in fixture_files()]
CORPUS_PARAMS = [
    pytest.param(path, id=f"{number:02}-{label(path)}", marks=pytest.mark.corpus)
    for number, path in enumerate(real_files())
] or [
    pytest.param(
        None, marks=[pytest.mark.corpus, pytest.mark.skip("no corpus beside the repository (see tests/corpus.py)")]
    )
]
ALL_PARAMS = [*FIXTURE_PARAMS, *CORPUS_PARAMS]


def params(number: int) -> list[ParameterSet]:
    """The fixtures, and some files of the corpus; sweeps with other numbers have others."""
    chosen = some_files(real_files(), number)
    return [*FIXTURE_PARAMS, *(param for param in CORPUS_PARAMS if param.values[0] in (None, *chosen))]


# -- bytes and text ---------------------------------------------------------------------------------------------------

_ENCODING = re.compile(r"(<\?xml[^>]*?encoding\s*=\s*)([\"'])([^\"']*)([\"'])")


def decoded(data: bytes) -> str:
    """The text of an XML file, without its byte order mark; line ends as they are."""
    for bom, codec in (
        (codecs.BOM_UTF8, "utf-8"),
        (codecs.BOM_UTF16_LE, "utf-16-le"),
        (codecs.BOM_UTF16_BE, "utf-16-be"),
    ):
        if data.startswith(bom):
            return data[len(bom) :].decode(codec)
    match = _ENCODING.match(data[:200].decode("latin-1"))
    return data.decode(match[3] if match else "utf-8")


def declared(text: str, encoding: str) -> str:
    """`text` with another encoding in its XML declaration."""
    return _ENCODING.sub(lambda m: f"{m[1]}{m[2]}{encoding}{m[4]}", text, count=1)


_RAW = re.compile(r"(<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>)", re.DOTALL)
_EMPTY = re.compile(r"(<[^\s<>/!?]+(?:\s+[^\s=<>]+\s*=\s*(?:\"[^\"]*\"|'[^']*'))*)(\s*)/>")


def swap_empty(text: str) -> str:
    """Every ``<a/>`` as ``<a />`` and every ``<a />`` as ``<a/>``."""
    parts = _RAW.split(text)
    parts[::2] = [_EMPTY.sub(lambda m: f"{m[1]}{'' if m[2] else ' '}/>", part) for part in parts[::2]]
    return "".join(parts)


def with_crlf(text: str) -> str:
    return with_lf(text).replace("\n", "\r\n")


def with_lf(text: str) -> str:
    return text.replace("\r\n", "\n")


def variants(data: bytes) -> dict[str, bytes]:
    """The same document in other handwritings, as tools and editors leave it."""
    plain = declared(decoded(data), "utf-8")
    has_declaration = plain.startswith("<?xml")
    found = {
        "no bom": plain.encode(),
        "bom": codecs.BOM_UTF8 + plain.encode(),
        "crlf": with_crlf(plain).encode(),
        "lf": with_lf(plain).encode(),
        "bom crlf": codecs.BOM_UTF8 + with_crlf(plain).encode(),
        "utf-16": codecs.BOM_UTF16_LE + declared(plain, "utf-16").encode("utf-16-le"),
        "utf-16 crlf": codecs.BOM_UTF16_LE + declared(with_crlf(plain), "utf-16").encode("utf-16-le"),
        "swapped": swap_empty(plain).encode(),
        "end": plain.rstrip().encode() + b"\n",
        "no end": plain.rstrip().encode(),
    }
    if has_declaration:
        head, mark, rest = plain.partition("?>")
        found["single quotes"] = (head.replace('"', "'") + mark + rest).encode()
        found["no declaration"] = rest.lstrip().encode()
    else:
        found["declaration"] = b"<?xml version='1.0' encoding='utf-8'?>\n" + plain.encode()
    return found


# -- where elements stand ---------------------------------------------------------------------------------------------


@dataclass
class Span:
    """An element of a file and the lines (from 0) in which it is."""

    tag: str
    attributes: dict[str, str]
    parent: Span | None
    start: int
    end: int = 0
    text: str = ""
    children: list[Span] = field(default_factory=list)

    def inside(self, tag: str) -> Iterator[Span]:
        """All elements of this local name in it, and itself."""
        if self.tag == tag:
            yield self
        for child in self.children:
            yield from child.inside(tag)

    def up(self, tag: str) -> Span:
        """The nearest element around it of this local name."""
        found = self.parent
        while found is not None and found.tag != tag:
            found = found.parent
        assert found is not None, tag
        return found


@lru_cache(maxsize=2)
def outline(data: bytes) -> Span:
    """The elements of a file with their lines, as expat sees them. Neighbouring tests ask for the same file."""
    root: list[Span] = []
    stack: list[Span] = []
    parser = expat.ParserCreate("utf-8")

    def start(name: str, attributes: dict[str, str]) -> None:
        parent = stack[-1] if stack else None
        span = Span(name.rpartition(":")[2], attributes, parent, parser.CurrentLineNumber - 1)
        (parent.children if parent else root).append(span)
        stack.append(span)

    def end(_name: str) -> None:
        stack.pop().end = parser.CurrentLineNumber - 1

    def text(content: str) -> None:
        stack[-1].text += content

    parser.StartElementHandler, parser.EndElementHandler, parser.CharacterDataHandler = start, end, text
    parser.Parse(declared(decoded(data), "utf-8").encode(), True)
    return root[0]


def charts_in(root: Span) -> list[Span]:
    """The ``SFC`` elements in the order in which `Project.charts` gives their charts."""
    found: list[Span] = []
    for pou in root.inside("pou"):
        bodies = [child for child in pou.children if child.tag == "body"]
        for name in ("actions", "transitions"):
            parts = [part for child in pou.children if child.tag == name for part in child.children]
            bodies += [body for part in parts for body in part.children if body.tag == "body"]
        bodies += [b for method in pou.inside("Method") for b in method.children if b.tag == "body"]
        found += [child for body in bodies for child in body.children if child.tag == "SFC"]
    return found


def name_places(sfc: Span, number: int) -> list[Span]:
    """The elements that name the step with this number (from 0) in a chart, one entry for each naming."""
    steps = [child for child in sfc.children if child.tag in ("step", "macroStep")]
    step = steps[number]
    name = step.attributes["name"]
    places = [step, *(a for a in _name_attributes(step) if a.text.strip() == name)]
    first = next(s for s in steps if s.attributes.get("name", "").casefold() == name.casefold())
    if first is step:
        for jump in sfc.children:
            if jump.tag == "jumpStep" and jump.attributes["targetName"].casefold() == name.casefold():
                places += [jump, *(a for a in _name_attributes(jump) if a.text.strip().casefold() == name.casefold())]
    return places


def _name_attributes(element: Span) -> Iterator[Span]:
    for data in (d for add in element.children if add.tag == "addData" for d in add.children):
        yield from (a for a in data.inside("attribute") if a.attributes.get("guid") == NAME_GUID)


# -- differences ------------------------------------------------------------------------------------------------------


def lines_of(data: bytes) -> list[str]:
    """Lines with their ends; only CR LF, LF and CR end a line."""
    return re.findall(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+", decoded(data))


@dataclass(frozen=True)
class Hunk:
    """`old[start:end]` became `new`; numbers of lines count from 0."""

    start: int
    end: int
    old: list[str]
    new: list[str]


def difference(before: bytes, after: bytes) -> list[Hunk]:
    """The lines that changed."""
    old, new = lines_of(before), lines_of(after)
    head = next((i for i, (a, b) in enumerate(zip(old, new, strict=False)) if a != b), min(len(old), len(new)))
    limit = min(len(old), len(new)) - head
    tail = next((i for i in range(limit) if old[-1 - i] != new[-1 - i]), limit)
    middle_old, middle_new = old[head : len(old) - tail], new[head : len(new) - tail]
    if len(middle_old) == len(middle_new) and len(middle_old) > 2000:
        return [
            Hunk(head + i, head + i + 1, [a], [b])
            for i, (a, b) in enumerate(zip(middle_old, middle_new, strict=True))
            if a != b
        ]
    codes = difflib.SequenceMatcher(None, middle_old, middle_new, autojunk=False).get_opcodes()
    return [Hunk(head + a, head + b, middle_old[a:b], middle_new[c:d]) for code, a, b, c, d in codes if code != "equal"]


def assert_within(hunks: Iterable[Hunk], *spans: Span) -> None:
    """Every change lies in the lines of one of the elements; text may also be inserted right behind one."""
    for hunk in hunks:
        assert any(s.start <= hunk.start and (hunk.end <= s.end + 1) for s in spans), (
            f"lines {hunk.start + 1}..{hunk.end} changed: {hunk.old} -> {hunk.new}"
        )


def assert_only_names_changed(
    before: bytes, after: bytes, old: str, places: list[Span], *, uses: int = 0, note: str = "", new: str = NEW
) -> None:
    """Only the lines of `places` differ, and of `uses` in program text; and there nothing but the name.

    Files of CODESYS say conditions twice.
    """
    old_lines, new_lines = lines_of(before), lines_of(after)
    assert len(old_lines) == len(new_lines), note
    changed = {i for i, (a, b) in enumerate(zip(old_lines, new_lines, strict=True)) if a != b}
    # what was rewritten names its step once more, and keeps a digest of what was written for it
    rewritten = any('rewritten"' in line for line in old_lines)
    changed = {i for i in changed if 'rewritten"' not in old_lines[i] and 'added"' not in old_lines[i]}
    pattern = re.compile(re.escape(escape(old)), re.IGNORECASE)
    # an element may go on over several lines: the name is in the first that has it
    naming = {next(i for i in range(place.start, len(old_lines)) if pattern.search(old_lines[i])) for place in places}
    assert changed >= naming, note
    assert bool(changed - naming) <= bool(uses or rewritten), note
    for number in changed:
        pieces = [re.escape(piece) for piece in pattern.split(old_lines[number])]
        wanted = f"(?:{pattern.pattern}|{re.escape(new)})".join(pieces)
        assert re.fullmatch(wanted, new_lines[number], re.IGNORECASE), (note, old_lines[number], new_lines[number])
    more = decoded(after).count(new) - decoded(before).count(new) - len(places)
    assert uses <= more <= 2 * uses or rewritten, note
    assert before[:4] == after[:4], note


# -- trees ------------------------------------------------------------------------------------------------------------


def local(element: etree._Element) -> str:
    return etree.QName(element).localname if isinstance(element.tag, str) else ""


def tree_of(data: bytes) -> etree._Element:
    """The tree of a file, by lxml alone."""
    return etree.fromstring(data, etree.XMLParser(huge_tree=True))


# -- projects ----------------------------------------------------------------------------------------------------------


def assert_same(mine: Project, theirs: Project) -> None:
    """Equal, but for the ids of associations: most tools give them none, and then they are numbered when read."""
    copies = [one.model_copy(deep=True) for one in (mine, theirs)]
    for copy in copies:
        for chart in copy.charts():
            new = {a.id: -number for number, (_, a) in enumerate(chart.chart.associations())}
            for _, association in chart.chart.associations():
                association.__dict__["id"] = new[association.id]
            for symbol in chart.chart.drawing.symbols if chart.chart.drawing is not None else ():
                for entry in symbol.entries or ():
                    entry.__dict__["association"] = new[entry.association]
                    entry.local_id = None
    assert copies[0] == copies[1]
