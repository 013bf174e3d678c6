"""Interface of a file format to the rest of the package: its record, its codec, and the options of writing."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from plcopen_sfc.languages.words import needs_quotes
from plcopen_sfc.model.dialect import Dialect

if TYPE_CHECKING:
    from plcopen_sfc.diagnostics import Diagnostic
    from plcopen_sfc.model.project import Project
    from plcopen_sfc.model.sfc import Step
    from plcopen_sfc.report import ConversionReport


TIA_PORTAL = "TIA Portal"
"""The product in the header of a project that was SimaticML: the markup that its objects carry is not of TC6."""


_ROOT = re.compile(r"<(?![?!])(?:([\w.-]+):)?([\w.-]+)((?:\s+[\w:.-]+\s*=\s*(?:\"[^\"]*\"|'[^']*'))*)\s*/?>")
HEAD = 65536
"""Bytes of a file that are looked at to recognise its format."""


@dataclass(frozen=True)
class FileHead:
    """Start of a file, for recognition: its first text, and the root element where it is XML."""

    text: str
    root: str = ""
    namespace: str = ""
    data: bytes = b""
    xhtml_prefix: bool = False

    def mentions(self, text: str) -> bool:
        """True if `text` occurs anywhere in the file, in any of the encodings that XML uses."""
        return any(text.encode(codec) in self.data for codec in ("utf-8", "utf-16-le", "utf-16-be"))


def head_of(data: bytes) -> FileHead:
    """Return the facts about a file from its first `HEAD` bytes."""
    start = data[:HEAD]
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = start[: len(start) // 2 * 2].decode("utf-16", errors="replace")
    # UTF-16 without a mark: XML begins with "<" in it.
    elif start[:2] in (b"<\0", b"\0<"):
        text = start[: len(start) // 2 * 2].decode("utf-16-le" if start[:1] == b"<" else "utf-16-be", errors="replace")
    else:
        text = start.decode("utf-8-sig", errors="replace")
    plain = re.sub(r"<!--.*?-->|<\?.*?\?>|<!DOCTYPE[^\[>]*(?:\[.*?\])?\s*>", "", text, flags=re.DOTALL)
    match = _ROOT.search(plain)
    if match is None or plain[: match.start()].strip():
        return FileHead(text, data=data)
    prefix, root, attributes = match.groups()
    name = f"xmlns:{prefix}" if prefix else "xmlns"
    declared = re.search(rf"\s{re.escape(name)}\s*=\s*(?:\"([^\"]*)\"|'([^']*)')", attributes)
    namespace = (declared.group(1) or declared.group(2) or "") if declared else ""
    return FileHead(text, root, namespace, data, "http://www.w3.org/1999/xhtml" in attributes)


SOURCE_CHART_FIELD = "source_chart"
"""In the mark of a chart: the chart of the source, in whose place another one is written."""


def may_have(content: bytes, field: str) -> bool:
    """True if data of this package in a file may have a field: it is asked before anything of that is read."""
    return f'"{field}"'.encode() in content


Marks: TypeAlias = Mapping[int, Mapping[str, Any]]
"""Fields to keep beside objects that were rewritten, by their `id()`."""


class ReadResult(NamedTuple):
    """A project that was read, the findings about its file, and the version of the format that it has."""

    project: Project
    diagnostics: list[Diagnostic]
    version: str = ""


class DrawingNeed(StrEnum):
    """Drawing of a chart that a writer needs."""

    NONE = "none"
    PLAIN = "plain"
    STRUCTURED = "structured"


class NetworkForm(StrEnum):
    """Form in which the files of a format hold networks.

    DRAWN: their elements. STATEMENTS: statements that mean the same. COMMENTS: nothing that a tool executes.
    """

    DRAWN = "drawn"
    STATEMENTS = "statements"
    COMMENTS = "comments"


@dataclass(frozen=True)
class WriteOptions:
    """Options of writing: `version` of the format, `flavour` of a family of readers (``beremiz``). Empty: the usual.

    `same`: the project was read from this format in this version; ids come back by themselves then. `source` is the
    file that it was read from, to keep to its habits.
    `same_format`: it was read from this format in whatever version, and is not written for a tool of its own.
    `untouched` names bodies (``Main``, ``Main.Fill``) whose charts are not written because they stay as they are in the
    file that is patched; `unchanged` has symbols of other charts, by the `id()` of the chart, whose elements stay so:
    they are not written either. `baseline` is the project as it was read, by which a writer sees what was
    edited.
    `whole` is the project of which the one that is written is a document of its own; `added`: its objects are those of
    `Codec.added_objects`.
    `marks` are what to keep beside objects that were rewritten, by their `id()`; `rewritten` is the project before.
    `of_graph`: the project has the semantics of S7-GRAPH: a transition without condition is TRUE, each row of a step
    writes its operand for itself, in the order of the rows.
    `of_codesys`: it has the semantics of CODESYS, step actions and SFC flags too.
    `of_matiec`: it is of Beremiz or OpenPLC, whose compiler matiec executes charts and FOR loops as they are.
    `of_grafcet`: its charts were a GRAFCET, whose outputs are those of its steps at the end of every scan.
    `final_scan`: actions of the project are executed once more after their step was left (IEC 61131-3, 6.7.4.6).
    `at_rest` are the inactive inputs of sequencers of S7-GRAPH, in upper case.
    """

    version: str = ""
    flavour: str = ""
    same: bool = False
    same_format: bool = False
    source: bytes = b""
    untouched: frozenset[str] = frozenset()
    unchanged: Mapping[int, frozenset[int]] = field(default_factory=dict)
    baseline: Project | None = None
    whole: Project | None = None
    added: bool = False
    marks: Marks = field(default_factory=dict)
    rewritten: Project | None = None
    of_graph: bool = False
    of_codesys: bool = False
    of_matiec: bool = False
    of_grafcet: bool = False
    final_scan: bool = True
    at_rest: Collection[str] = ()


class Codec(ABC):
    """Reads and writes a format. What only some formats need has a default."""

    @abstractmethod
    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file. Raises `FormatError`."""

    @abstractmethod
    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a file from the model alone."""

    def for_version(self, version: str) -> Codec:
        """Return the codec for files of a version that was asked for; most codecs find the version in the file."""
        return self

    def as_tool_sees(self, data: bytes, *, file: str | None = None) -> bytes:
        """Return the file without what only this package reads."""
        return data

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """Return the line of each object of `project` in the file `content`, by the path that the report gives it."""
        return {}

    def validate(self, content: bytes, *, file: str | None = None) -> list[Diagnostic]:
        """Return the errors of a file by the schema of the format; empty for a valid one, and without a schema."""
        return []

    def normalize(self, data: bytes) -> bytes | None:
        """Return the file without what its tool does not look at; None where the format has nothing of the kind."""
        return None

    def fit(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Change `project`, a copy, into what the readers of `WriteOptions.flavour` execute."""

    def adapt(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Change `project`, a copy, into what the format makes of it: numbers and names that its tool requires."""

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Replace in `project`, a copy, what the tool lacks by what does the same, and is read back as such."""

    def is_rewritten(self, project: Project, content: bytes) -> bool:
        """True if the writer put something else into the file `content` of `project`, and an edit may change that."""
        return False


@dataclass(frozen=True)
class ChartHost:
    """Abilities of the charts of a tool, whose charts are those of IEC 61131-3.

    `title` is what reports call it. `is_codesys`: associations take an action of the POU by its name, steps have entry,
    main and exit actions and minimum times, conditions are expressions or names of transition objects and never
    negated. Other tools take bodies in place, with the qualifiers P1 and P0. `has_tasks`: its files hold tasks.
    `has_main`: its controller executes the program PLC_PRG in every cycle where there is no task.
    `has_methods`: its language is object-oriented, with the keywords for that. `il_conditions`: conditions may be
    instruction list. `keeps_bodies`: a step without associations has its main action in place. `excludes`: its elements
    may be excluded from the program. `by_bytes`: words at direct addresses have the number of a byte. `names_lists`:
    texts name a variable with its list, ``GVL_IO.x``. `is_s7`: its texts are in SCL.
    """

    title: str
    is_codesys: bool = False
    is_s7: bool = False
    has_tasks: bool = True
    has_main: bool = False
    has_methods: bool = True
    il_conditions: bool = False
    keeps_bodies: bool = False
    excludes: bool = False
    by_bytes: bool = False
    names_lists: bool = True

    @property
    def addresses(self) -> Dialect:
        """The dialect of direct addresses in its files."""
        return Dialect.TWINCAT if self.by_bytes else self.dialect

    @property
    def dialect(self) -> Dialect:
        """The structured text of its files."""
        return Dialect.SCL if self.is_s7 else Dialect.CODESYS if self.is_codesys else Dialect.IEC

    def active(self, step: Step) -> str:
        """Return the variable that tells whether a step is active."""
        return f"{self._named(step)}.{'x' if self.is_codesys else 'X'}"

    def elapsed(self, step: Step) -> str:
        """Return the variable that tells for how long a step has been active."""
        return f"{self._named(step)}.{'t' if self.is_codesys else 'T'}"

    def _named(self, step: Step) -> str:
        name = f'"{step.name}"' if self.is_s7 and needs_quotes(step.name) else step.name
        return f"#{name}" if self.is_s7 else name


@dataclass(frozen=True)
class Format:
    """One format in the table of formats, with the facts about it and its tools that others need.

    `tool` is the name of the tools that execute its files, in reports; empty: none does. `module` is imported when the
    format is used. `recognises` looks at the start of a file. `capabilities` are for people: what charts keep in this
    format in its own terms. `dialect` is that of the structured text in its files; None: a file may hold any and names
    it. `xml`, `text`, `folders`: the codec is an `XmlCodec`, a `TextCodec`, a `FolderCodec`; `xml_texts`: texts are in
    XML inside its files all the same; `list_extension` is that
    of a file which lists the files of such a folder. `ids`: its files keep the
    ids of steps, transitions and elements of networks. `positions`: they keep positions. `networks` is the form of
    networks in its files, `one_sheet`: all networks of a body are on one. `il_conditions`, `il_bodies`: the conditions
    of its charts, and bodies, may be in IL. `used_first`: its files have each block behind those that it names, so that
    the order of blocks and types is not kept. `flags_as_conditions`: its charts have no SFC flags, and get conditions
    that obey them. `extends`: its tools know types that extend others. `extension_data`: its files keep what only this
    package reads. `charts` has the abilities of its charts, where other charts are put into their terms. `standard` is
    what its versions are of.
    """

    name: str
    title: str
    tool: str
    module: str
    extensions: tuple[str, ...]
    recognises: Callable[[FileHead], bool]
    capabilities: tuple[str, ...] = field(default=())
    versions: tuple[str, ...] = field(default=())
    flavours: tuple[str, ...] = field(default=())
    xml: bool = False
    xml_texts: bool = False
    text: bool = False
    drawing: DrawingNeed = DrawingNeed.NONE
    positions: bool = False
    dialect: Dialect | None = None
    ids: bool = True
    folders: bool = False
    list_extension: str = ""
    networks: NetworkForm = NetworkForm.DRAWN
    one_sheet: bool = False
    il_conditions: bool = True
    il_bodies: bool = True
    used_first: bool = False
    flags_as_conditions: bool = False
    extends: bool = False
    extension_data: bool = True
    charts: ChartHost | None = None
    standard: str = ""

    def codec(self, version: str = "") -> Codec:
        """Import and return its codec: ``CODEC`` of its module, for the version that was asked for."""
        codec: Codec = import_module(self.module).CODEC
        return codec.for_version(version)
