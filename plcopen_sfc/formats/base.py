"""What a file format is to the rest of the package."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from plcopen_sfc.model.dialect import Dialect

if TYPE_CHECKING:
    from lxml import etree

    from plcopen_sfc.diagnostics import Diagnostic
    from plcopen_sfc.formats.text import Piece, Slice, SourceText
    from plcopen_sfc.formats.xml.writing import XmlStyle
    from plcopen_sfc.model.project import Project
    from plcopen_sfc.report import ConversionReport


TIA_PORTAL = "TIA Portal"
"""The product in the header of a project that was SimaticML: the markup that its objects carry is not of TC6."""


class Reading(NamedTuple):
    """A project that was read, what there is to say about its file, and the version of the format that it has."""

    project: Project
    diagnostics: list[Diagnostic]
    version: str = ""


class DrawingNeed(StrEnum):
    """What drawing of a chart a writer needs."""

    NONE = "none"
    PLAIN = "plain"
    STRUCTURED = "structured"


@dataclass(frozen=True)
class WriteOptions:
    """How to write: `version` of the format, `flavour` of a family of readers (``beremiz``). Empty: the usual.

    `same`: the project was read from this format in this version; ids come back by themselves then. `source` is the
    file that it was read from, to keep to its habits.
    `untouched` names bodies (``Main``, ``Main.Fill``) whose charts are not written because they stay as they are in the
    file that is patched. `baseline` is the project as it was read, by which a writer sees what was edited.
    `whole` is the project of which the one that is written is a document of its own; `added`: its objects are those of
    `Codec.added_objects`.
    `marks` are what to keep beside objects that were rewritten, by their `id()`.
    `of_graph`: the project says what S7-GRAPH executes: a transition without condition is TRUE, each row of a step
    writes its operand for itself, in the order of the rows.
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
    marks: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)
    of_graph: bool = False
    final_scan: bool = True


class Codec(Protocol):
    """The module of a format. One that does not write has no ``write``.

    One with ``adapt(project, options, report)`` changes a copy of the project, before it is written, into what the
    format makes of it: numbers that its tool requires, names that it gives. One with ``rewrite(project, options,
    report)`` gives a copy that says in terms of its tool what the project means, and marks for `WriteOptions`, from
    which its reader makes the project again; its ``is_rewritten(project, content)`` tells if a file is such a copy. One
    with ``normalize(data)`` takes out of a file what its tool does not look at. One with ``added_objects(project)``
    writes objects for its tool that the project has otherwise, and that are no objects of it when the file is read
    again. One with ``as_tool_sees(data,
    file=..)`` takes out what only this package reads; without it a file holds nothing of the kind.
    """

    def read(self, data: bytes, *, file: str | None = None) -> Reading:
        """Read a file. Raises `FormatError`."""

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a file anew."""


class TextCodec(Codec, Protocol):
    """The module of a text format, whose files can be patched: see `formats.text`."""

    def to_pieces(self, project: Project, options: WriteOptions, report: ConversionReport) -> Piece:
        """The text of a project, object by object."""

    def slices(self, content: bytes) -> tuple[SourceText, Slice]:
        """The text of a file, and where the objects stand in it."""


class XmlCodec(Codec, Protocol):
    """The module of an XML format, whose files can be patched."""

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """The tree of the file."""

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """The line of each object in the file, by the path that the report gives it."""

    def style(self, project: Project, options: WriteOptions) -> XmlStyle:
        """How the tool writes XML."""


@dataclass(frozen=True)
class Format:
    """One format in the table of formats.

    `tool` is what reports call the tools that execute its files; empty: none does. `module` is imported when the format
    is used. `recognises` looks at the start of a file (see
    `formats.registry.Head`). `capabilities` are for people: what charts keep in this format in its own terms. `dialect`
    is that of the structured text in its files; None: a file may hold any and says which. `xml`, `text`: the module is
    an `XmlCodec`, a `TextCodec`. `folders`: a folder of its files is one project; the module has
    ``standard_folder(thing)`` then, where an object belongs that has no folder yet, and ``new_document(version)``, a
    project without objects. `ids`: its files keep the ids of steps, transitions and elements of networks.
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

    def codec(self) -> Any:
        """The module that reads and writes it."""
        return import_module(self.module)
