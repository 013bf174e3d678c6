"""Interface of a file format to the rest of the package: its record, its codec, and the options of writing."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from plcopen_sfc.model.dialect import Dialect

if TYPE_CHECKING:
    from plcopen_sfc.diagnostics import Diagnostic
    from plcopen_sfc.formats.text_patch import BlockSpan, SourceText, WrittenBlock
    from plcopen_sfc.model.project import Project
    from plcopen_sfc.report import ConversionReport


TIA_PORTAL = "TIA Portal"
"""The product in the header of a project that was SimaticML: the markup that its objects carry is not of TC6."""


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


@dataclass(frozen=True)
class WriteOptions:
    """Options of writing: `version` of the format, `flavour` of a family of readers (``beremiz``). Empty: the usual.

    `same`: the project was read from this format in this version; ids come back by themselves then. `source` is the
    file that it was read from, to keep to its habits.
    `untouched` names bodies (``Main``, ``Main.Fill``) whose charts are not written because they stay as they are in the
    file that is patched. `baseline` is the project as it was read, by which a writer sees what was edited.
    `whole` is the project of which the one that is written is a document of its own; `added`: its objects are those of
    `Codec.added_objects`.
    `marks` are what to keep beside objects that were rewritten, by their `id()`.
    `of_graph`: the project has the semantics of S7-GRAPH: a transition without condition is TRUE, each row of a step
    writes its operand for itself, in the order of the rows.
    `of_codesys`: it has the semantics of CODESYS, step actions and SFC flags too.
    `final_scan`: actions of the project are executed once more after their step was left (IEC 61131-3, 6.7.4.6).
    """

    version: str = ""
    flavour: str = ""
    same: bool = False
    source: bytes = b""
    untouched: frozenset[str] = frozenset()
    baseline: Project | None = None
    whole: Project | None = None
    added: bool = False
    marks: Marks = field(default_factory=dict)
    of_graph: bool = False
    of_codesys: bool = False
    final_scan: bool = True


class Codec(ABC):
    """Reads and writes a format. What only some formats need has a default."""

    @abstractmethod
    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file. Raises `FormatError`."""

    @abstractmethod
    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a file from the model alone."""

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

    def rewrite(self, project: Project, options: WriteOptions, report: ConversionReport) -> tuple[Project, Marks]:
        """Return a copy in terms of the tool that means the same, and what the reader restores the project from."""
        return project, {}

    def is_rewritten(self, project: Project, content: bytes) -> bool:
        """True if the file `content` of `project` is such a copy, or an edit made that necessary."""
        return False


class TextCodec(Codec):
    """Reads and writes a text format, whose files can be patched: see `formats.text_patch`."""

    @abstractmethod
    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        """Return the text of a project, object by object."""

    @abstractmethod
    def spans(self, content: bytes) -> tuple[SourceText, BlockSpan]:
        """Return the text of a file, and the places of the objects in it."""


@dataclass(frozen=True)
class Format:
    """One format in the table of formats.

    `tool` is what reports call the tools that execute its files; empty: none does. `module` is imported when the format
    is used. `recognises` looks at the start of a file (see
    `formats.registry.Head`). `capabilities` are for people: what charts keep in this format in its own terms. `dialect`
    is that of the structured text in its files; None: a file may hold any and names it. `xml`, `text`, `folders`: the
    codec is an `XmlCodec`, a `TextCodec`, a `FolderCodec`. `ids`: its files keep the ids of steps, transitions and
    elements of networks.
    """

    name: str
    title: str
    tool: str
    module: str
    extensions: tuple[str, ...]
    recognises: Callable[[Any], bool]
    capabilities: tuple[str, ...] = field(default=())
    versions: tuple[str, ...] = field(default=())
    flavours: tuple[str, ...] = field(default=())
    xml: bool = False
    text: bool = False
    drawing: DrawingNeed = DrawingNeed.NONE
    positions: bool = False
    dialect: Dialect | None = None
    ids: bool = True
    folders: bool = False

    def codec(self) -> Codec:
        """Import and return its codec: ``CODEC`` of its module."""
        codec: Codec = import_module(self.module).CODEC
        return codec
