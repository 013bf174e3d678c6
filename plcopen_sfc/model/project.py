"""The project: everything a file holds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self
from weakref import WeakValueDictionary

from pydantic import Field, PrivateAttr

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.errors import Location, ModelError, SfcError
from plcopen_sfc.model import operations
from plcopen_sfc.model.base import Carried, Element, Model
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project_object import ProjectObject
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.text import Text
from plcopen_sfc.model.types import DataTypeDeclaration, Variable
from plcopen_sfc.model.variables import AccessSection, ConfigSection, VariableSection

if TYPE_CHECKING:
    from plcopen_sfc.diagnostics import Diagnostic
    from plcopen_sfc.refactor.rename import RenameResult


class FileHeader(Model):
    """Which tool wrote the file, and when (TC6 ``fileHeader``). `created` is an ISO date and time as in the file."""

    company: str = ""
    company_url: str | None = None
    product: str = ""
    version: str = ""
    release: str | None = None
    created: str = ""
    description: str | None = None
    carried: Carried | None = None


class Scaling(Model):
    """Units of the drawings of one language; None: the file does not say."""

    x: float = 1.0
    y: float = 1.0


class DrawingScales(Model):
    """Page size and the scaling of each graphical language (TC6 ``coordinateInfo``)."""

    page: Scaling | None = None
    fbd: Scaling = Field(default_factory=Scaling)
    ld: Scaling = Field(default_factory=Scaling)
    sfc: Scaling = Field(default_factory=Scaling)


class ForeignDataInfo(Model):
    """A declaration of a kind of foreign data used in the file (TC6 ``addDataInfo/info``)."""

    name: str
    vendor: str
    version: str | None = None
    description: Text | None = None


class PouInstance(Element):
    """A program instance or function block instance that a task or resource runs."""

    name: str
    type_name: str = ""


class TaskWatchdog(Model):
    """The watchdog of a CODESYS task."""

    enabled: bool = False
    time: str | None = None
    time_unit: str | None = None
    sensitivity: str | None = None


class TaskSettings(Model):
    """How CODESYS runs a task: kind (``Cyclic``, ``Freewheeling`` ..), interval as typed and its unit."""

    kind: str | None = None
    interval: str | None = None
    interval_unit: str | None = None
    event: str | None = None
    watchdog: TaskWatchdog | None = None


class Task(Element):
    """A task. `single` is its trigger, `interval` a duration or a variable, `priority` 0 the highest."""

    name: str
    priority: int = 0
    interval: str | None = None
    single: str | None = None
    instances: list[PouInstance] = Field(default_factory=list)
    settings: TaskSettings | None = None
    object_id: str | None = None


class Resource(Element):
    """A resource: tasks, instances and global variables that run on one processor. A CODESYS application is one."""

    name: str
    tasks: list[Task] = Field(default_factory=list)
    global_variables: list[VariableSection] = Field(default_factory=list)
    instances: list[PouInstance] = Field(default_factory=list)
    object_id: str | None = None


class Configuration(Element):
    """A configuration: resources, global variables, access paths, VAR_CONFIG. A CODESYS device is one."""

    name: str
    resources: list[Resource] = Field(default_factory=list)
    global_variables: list[VariableSection] = Field(default_factory=list)
    access_variables: AccessSection | None = None
    config_variables: ConfigSection | None = None
    object_id: str | None = None


class Tag(Element):
    """A tag of a TIA tag table."""

    name: str
    type: str
    address: str | None = None


class TagTable(ProjectObject):
    """A tag table of TIA: tags and user constants."""

    kind_in_reports: ClassVar[str] = "tag table"

    tags: list[Tag] = Field(default_factory=list)
    constants: list[Variable] = Field(default_factory=list)


class TreeNode(Model):
    """A folder or an object in the project tree of the tool (CODESYS ``projectstructure``)."""

    name: str
    folder: bool = False
    object_id: str | None = None
    children: list[TreeNode] = Field(default_factory=list)


class Chart(NamedTuple):
    """A chart and where it stands: ``Main`` or, of an action, ``Main.Fill``."""

    name: str
    pou: Pou
    network: SfcNetwork

    @property
    def report_path(self) -> str:
        """Where it stands in the words of messages and reports: ``POU Main / action Fill``."""
        return self.pou.report_path_of(self.name)


class Origin(NamedTuple):
    """Where a project was read from; what saving needs to give the same file back. Belongs to `plcopen_sfc.api`."""

    format: str
    version: str
    content: bytes
    fingerprint: bytes
    path: str | None
    diagnostics: list[Diagnostic]

    def __deepcopy__(self, memo: dict[int, Any]) -> Origin:
        """Itself: copies of a project come from the same file."""
        return self


class SourceDocument(NamedTuple):
    """One document of a folder: a project with what is beside its objects, and how many objects it has."""

    frame: Project
    objects: int

    @property
    def origin(self) -> Origin:
        """What the document was read from."""
        if not isinstance(self.frame._origin, Origin):
            raise TypeError("a document is read from one file")
        return self.frame._origin


@dataclass
class FolderOrigin:
    """The folder that a project was read from; what saving needs to touch changed files only.

    `path` is the folder, `documents` are by their path in it. `version` is the newest of theirs. `shared` is what the
    project has beside its objects, as it was read. `unreadable` are documents that could not be read, and why; `others`
    the files that are none of the project's. Belongs to `plcopen_sfc.folders`.
    """

    format: str
    version: str
    path: str
    documents: dict[str, SourceDocument]
    shared: dict[str, Any]
    unreadable: dict[str, SfcError]
    others: list[str]
    own_diagnostics: list[Diagnostic]

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """What there is to say about the folder, and about its documents."""
        of_documents = (document.origin.diagnostics for document in self.documents.values())
        return [*self.own_diagnostics, *chain.from_iterable(of_documents)]

    def __deepcopy__(self, memo: dict[int, Any]) -> FolderOrigin:
        """Copies of a project come from the same files, but each is saved by itself."""
        return replace(self, documents=dict(self.documents))


class Project(Element):
    """Everything a file holds.

    `applications` are resources that stand in the project without a configuration (CODESYS and TwinCAT application
    exports). POUs and data types are in one list each, whatever their `place` is. `content_comment` and
    `content_carried` belong to the description of the content (TC6 ``contentHeader``). `dialect` is that of all
    structured text in it, expressions included.
    """

    name: str = ""
    header: FileHeader = Field(default_factory=FileHeader)
    version: str | None = None
    modified: str | None = None
    organization: str | None = None
    author: str | None = None
    language: str | None = None
    content_comment: str | None = None
    content_carried: Carried | None = None
    scales: DrawingScales = Field(default_factory=DrawingScales)
    foreign_data_infos: list[ForeignDataInfo] | None = None
    data_types: list[DataTypeDeclaration] = Field(default_factory=list)
    pous: list[Pou] = Field(default_factory=list)
    data_blocks: list[DataBlock] = Field(default_factory=list)
    global_variables: list[VariableSection] = Field(default_factory=list)
    tag_tables: list[TagTable] = Field(default_factory=list)
    configurations: list[Configuration] = Field(default_factory=list)
    applications: list[Resource] = Field(default_factory=list)
    tree: list[TreeNode] | None = None
    dialect: Dialect = Dialect.IEC

    _origin: Origin | FolderOrigin | None = PrivateAttr(default=None)
    _errors_accepted: bool = PrivateAttr(default=False)

    def __eq__(self, other: Any) -> bool:
        """Equal content; where the projects were read from does not matter."""
        return isinstance(other, Project) and self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]  # mutable, as every pydantic model

    def model_post_init(self, context: Any, /) -> None:
        """Remember that the project exists: see `projects_with`."""
        super().model_post_init(context)
        _remember(self)

    def __copy__(self) -> Self:
        """A copy that has the same POUs."""
        copy = super().__copy__()
        _remember(copy)
        return copy

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        """A copy with POUs of its own."""
        copy = super().__deepcopy__(memo)
        _remember(copy)
        return copy

    def __setstate__(self, state: dict[Any, Any]) -> None:
        super().__setstate__(state)
        _remember(self)

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """What the reader had to say about the file: charts that are wrong but could be loaded. Reads every chart."""
        if self._origin is None:
            return ()
        self.read_all()
        found = self._origin.diagnostics
        return tuple(sorted(found, key=lambda d: (d.location.file or "", d.location.line or 0)))

    def accept_errors(self) -> None:
        """Let the project be written in other formats although its reading found errors.

        Else that raises `DamagedSourceError`: what could not be read is missing in the result. The report lists each
        error as approximated then.
        """
        self._errors_accepted = True
        if isinstance(self._origin, FolderOrigin):
            for document in self._origin.documents.values():
                document.frame._errors_accepted = True

    def read_all(self) -> None:
        """Read every object and chart that nobody has looked at yet: quicker for all at once than one by one."""
        with collector_paused():
            for thing in self.objects():
                thing.read()
            for _ in self.charts():
                pass

    def pou(self, name: str) -> Pou:
        """The POU of this name; case does not matter. Raises `ModelError`."""
        for pou in self.pous:
            if pou.name.casefold() == name.casefold():
                return pou
        raise ModelError(
            f"the project has no POU {name!r}", hint="It has: " + ", ".join(p.name for p in self.pous[:20])
        )

    def rename(self, path: str, new: str) -> RenameResult:
        """Give a thing another name; every use of it in every body and declaration follows.

        `path` is ``Main``, ``Main.Step3``, ``GVL.x``, ``Type.member`` ..; case does not matter. Raises `ModelError`
        where there is no such thing, or the new name is no name or would mean something else somewhere. See
        `plcopen_sfc.refactor.rename`.
        """
        return operations.rename(self, path, new)

    def locations_of(self, paths: Iterable[str]) -> list[Location]:
        """Where objects stand in the files of the project, by their paths: ``POU Main / step S3``.

        Each place has the path, and the file and line as far as they are known: those of what is around the object
        where the format tells no more.
        """
        return operations.locations_of(self, paths)

    def objects(self) -> Iterator[ProjectObject]:
        """The objects that have files of their own in some tools; what others need comes first."""
        yield from self.tag_tables
        yield from self.data_types
        yield from self.data_blocks
        yield from self.pous

    def bodies_read(self) -> Iterator[tuple[str, Body]]:
        """Every body with its name, but for those of POUs that nobody has looked at."""
        for pou in self.pous:
            if not pou.is_unread:
                yield from pou.named_bodies()

    def bodies(self) -> Iterator[tuple[str, Pou, Body]]:
        """Every body in the project with its name (``Main.Fill``) and POU."""
        for pou in self.pous:
            for name, body in pou.named_bodies():
                yield name, pou, body

    def charts(self) -> Iterator[Chart]:
        """Every chart of the project: of POUs, actions, transitions and methods."""
        for name, pou, body in self.bodies():
            if isinstance(body, SfcBody):
                yield Chart(name, pou, body.chart)


_ALIVE: WeakValueDictionary[int, Project] = WeakValueDictionary()
"""Every project in this process, by its `id()`."""


def _remember(project: Project) -> None:
    _ALIVE[id(project)] = project


def projects_of(pou: Pou) -> Iterator[Project]:
    """Find the projects that have this very POU."""
    return (project for project in list(_ALIVE.values()) if any(each is pou for each in project.pous))


def projects_with(chart: SfcNetwork) -> Iterator[Project]:
    """The projects that have this very chart: in a body, or inside another chart. Charts stay unread."""
    for project in list(_ALIVE.values()):
        for _, body in project.bodies_read():
            if isinstance(body, SfcBody) and any(found is chart for found in body.charts_read()):
                yield project
                break
