"""The project: everything a file holds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

from pydantic import Field, PrivateAttr

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import OUTDATED, Diagnostic
from plcopen_sfc.errors import Location, ModelError, check_argument, nearest
from plcopen_sfc.model.base import Element, ExtensionData, Model
from plcopen_sfc.model.declaration import Declaration
from plcopen_sfc.model.dialect import Dialect, address_dialect
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.owners import Owned, OwnedName
from plcopen_sfc.model.pou import DataBlock, NamedBody, Pou, PouKind
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork, Step, Transition
from plcopen_sfc.model.text import Text
from plcopen_sfc.model.types import DataTypeDeclaration, Variable
from plcopen_sfc.model.variables import AccessSection, ConfigSection, Interface, VariableSection
from plcopen_sfc.operations import provided

if TYPE_CHECKING:
    import plcopen_sfc as sfc  # it provides the operation, and its public names have the result: decision 0010
    from plcopen_sfc.report import RenameResult, Use


class FileHeader(Model):
    """Tool that wrote the file, and the time (TC6 ``fileHeader``). `created` is an ISO date and time as in the file."""

    company: str = ""
    company_url: str | None = None
    product: str = ""
    version: str = ""
    release: str | None = None
    created: str = ""
    description: str | None = None
    extension_data: ExtensionData | None = None

    @property
    def tool(self) -> str:
        """The tool and its version in one text, in which no name is twice: ``CODESYS V3.5 SP18``."""
        repeated = self.product and self.version.startswith(self.product)
        return self.version if repeated else f"{self.product} {self.version}".strip()

    @property
    def is_of_beremiz(self) -> bool:
        """True if Beremiz or OpenPLC Editor writes such a header.

        They name no tool: the header is the user's. Those of their examples name Beremiz as company or product; a
        project without a name has the product ``Unnamed``, in the language of the editor, and the version 1. Files
        that this package writes for them have the release ``for Beremiz``.
        """
        named = f"{self.company} {self.product} {self.release or ''}".casefold()
        return "beremiz" in named or "openplc" in named or (self.product.casefold() in _UNNAMED and self.version == "1")


_UNNAMED = {"unnamed", "unbenannt"}


class Scaling(Model):
    """Units of the drawings of one language; None where the file has none."""

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


class PouInstance(OwnedName, Element):
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
    """Settings of a task in CODESYS: kind (``Cyclic``, ``Freewheeling`` ..), interval as typed and its unit.

    `attributes` are others that its file has.
    """

    kind: str | None = None
    interval: str | None = None
    interval_unit: str | None = None
    event: str | None = None
    watchdog: TaskWatchdog | None = None
    attributes: dict[str, str] = Field(default_factory=dict)


class Task(Owned, Element):
    """A task. `single` is its trigger, `priority` 0 the highest.

    `interval` is a duration or a variable; files of TC6 have durations such as ``PT0.01S``, ``10ms``, ``00:00:01``.
    """

    name: str
    priority: int = 0
    interval: str | None = None
    single: str | None = None
    instances: list[PouInstance] = Field(default_factory=list)
    settings: TaskSettings | None = None
    object_id: str | None = None

    INTERVALS: ClassVar[tuple[str, ...]] = ("interval",)
    OWNS: ClassVar[tuple[str, ...]] = ("instances",)


class Resource(OwnedName, Element):
    """A resource: tasks, instances and global variables that run on one processor. A CODESYS application is one."""

    name: str
    tasks: list[Task] = Field(default_factory=list)
    global_variables: list[VariableSection] = Field(default_factory=list)
    instances: list[PouInstance] = Field(default_factory=list)
    object_id: str | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("tasks", "global_variables", "instances")

    def every_instance(self) -> list[PouInstance]:
        """Return the instances without a task, then those of each task."""
        return [*self.instances, *(instance for task in self.tasks for instance in task.instances)]


class Configuration(OwnedName, Element):
    """A configuration: resources, global variables, access paths, VAR_CONFIG. A CODESYS device is one."""

    name: str
    resources: list[Resource] = Field(default_factory=list)
    global_variables: list[VariableSection] = Field(default_factory=list)
    access_variables: AccessSection | None = None
    config_variables: ConfigSection | None = None
    object_id: str | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("resources", "global_variables")


class Tag(OwnedName, Element):
    """A tag of a TIA tag table."""

    name: str
    type: str
    address: str | None = None


class TagTable(ProjectObject):
    """A tag table of TIA: tags and user constants."""

    kind_in_reports: ClassVar[str] = "tag table"
    OWNS: ClassVar[tuple[str, ...]] = ("tags", "constants")

    tags: list[Tag] = Field(default_factory=list)
    constants: list[Variable] = Field(default_factory=list)


class TreeNode(Model):
    """A folder or an object in the project tree of the tool (CODESYS ``projectstructure``)."""

    name: str
    folder: bool = False
    object_id: str | None = None
    children: list[TreeNode] = Field(default_factory=list)


class Chart(NamedTuple):
    """A chart and what it belongs to: ``Main`` or, of an action, ``Main.Fill``."""

    name: str
    pou: Pou
    chart: SfcNetwork

    @property
    def report_path(self) -> str:
        """Its place in the words of messages and reports: ``POU Main / action Fill``."""
        return self.pou.report_path_of(self.name)

    def to_svg(self, *, style: str | None = None, theme: str = "light", fresh: bool = False) -> str:
        """Return a picture of the chart, see `SfcNetwork.to_svg`."""
        return self.chart.to_svg(style=style, theme=theme, fresh=fresh)

    def _repr_svg_(self) -> str:
        """Show the chart as a picture in Jupyter."""
        return self.to_svg()


class Source(Protocol):
    """The file or folder that a project was read from, as the model needs it; see `plcopen_sfc.documents`."""

    format: str
    version: str
    errors_accepted: bool

    @property
    def is_folder(self) -> bool:
        """True if each object has a file of its own."""

    @property
    def path(self) -> str | None:
        """The file or folder; None for bytes without a name."""

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """Findings of the reader."""

    def accept_errors(self) -> None:
        """See `Project.accept_errors`."""


class Project(Owned, Element):
    """Everything a file holds.

    `applications` are resources of the project without a configuration (CODESYS and TwinCAT application
    exports). `config_variables` are outside of a configuration, as in CODESYS. POUs and data types are in one list
    each, whatever their `place` is. `content_comment` and `content_extension_data` belong to the description of the
    content (TC6 ``contentHeader``). `dialect` is that of all structured text in it, expressions included. `origin` is
    the format that the project was converted from: its file is of another tool, and keeps the charts as they were.
    """

    name: str = ""
    header: FileHeader = Field(default_factory=FileHeader)
    version: str | None = None
    modified: str | None = None
    organization: str | None = None
    author: str | None = None
    language: str | None = None
    content_comment: str | None = None
    content_extension_data: ExtensionData | None = None
    scales: DrawingScales = Field(default_factory=DrawingScales)
    foreign_data_infos: list[ForeignDataInfo] | None = None
    data_types: list[DataTypeDeclaration] = Field(default_factory=list)
    pous: list[Pou] = Field(default_factory=list)
    data_blocks: list[DataBlock] = Field(default_factory=list)
    global_variables: list[VariableSection] = Field(default_factory=list)
    config_variables: ConfigSection | None = None
    tag_tables: list[TagTable] = Field(default_factory=list)
    configurations: list[Configuration] = Field(default_factory=list)
    applications: list[Resource] = Field(default_factory=list)
    tree: list[TreeNode] | None = None
    dialect: Dialect = Dialect.IEC
    origin: str | None = None

    OBJECTS: ClassVar[tuple[str, ...]] = ("tag_tables", "data_types", "data_blocks", "pous")
    """The fields with objects that have files of their own in some tools."""

    OWNS: ClassVar[tuple[str, ...]] = (*OBJECTS, "global_variables", "configurations", "applications")

    _source: Source | None = PrivateAttr(default=None)
    _last_edit: int = PrivateAttr(default=0)

    def __eq__(self, other: object) -> bool:
        """Equal content, whatever it was read or converted from."""
        if type(self) is not type(other):
            return False
        mine, its = ({**each.__dict__, "origin": None} for each in (self, other))
        return mine == its

    __hash__ = None  # type: ignore[assignment]  # mutable, as every pydantic model

    @property
    def project(self) -> Project:
        """The project itself: what is in it asks what it is in."""
        return self

    @property
    def source(self) -> Source | None:
        """The file or folder that the project was read from; None for one that was built by a script."""
        # as the attribute it would take ten times as long
        source: Source | None = (self.__pydantic_private__ or {}).get("_source")
        return source

    @source.setter
    def source(self, source: Source | None) -> None:
        self._source = source

    @property
    def last_edit(self) -> int:
        """The number of the last edit by an editor or a rename: only that one can be undone."""
        return self._last_edit

    @last_edit.setter
    def last_edit(self, number: int) -> None:
        self._last_edit = number

    @property
    def tool_format(self) -> str:
        """The format by whose tool the project is executed: not that of a file which keeps it for the way back."""
        if self.origin is not None and self.is_converted:
            return self.origin
        return self.source.format if self.source is not None else ""

    @property
    def address_dialect(self) -> Dialect:
        """The dialect of direct addresses: that of the texts, but TwinCAT counts bytes where CODESYS counts words.

        The file decides, also one that keeps what another tool executes: its tool gives the addresses their places.
        """
        own = self.source.format if self.source is not None else ""
        own = self.origin or "" if own == "json" else own
        return address_dialect(own, self.dialect, self.header.product)

    @property
    def is_converted(self) -> bool:
        """True if the project is what its file keeps of its origin. Reads every chart of a project with an origin.

        Where the tool of the file has edited what the file keeps, the edit counts, and so do its rules.
        """
        return self.origin is not None and not any(each.code == OUTDATED for each in self.diagnostics)

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Findings of the reader about the file: charts that are wrong but could be loaded. Reads every chart."""
        if self.source is None:
            return ()
        self.read_all()
        found = self.source.diagnostics
        return tuple(sorted(found, key=lambda d: (d.location.file or "", d.location.line or 0)))

    def accept_errors(self) -> None:
        """Allow the project to be written in other formats although its reading found errors.

        Else that raises `DamagedSourceError`: what could not be read is missing in the result. The report lists each
        error as approximated then.
        """
        if self.source is not None:
            self.source.accept_errors()

    def read_all(self) -> None:
        """Read every object, interface, chart and drawing that is unread: quicker for all at once than one by one."""
        with collecting_rarely():
            for thing in self.objects():
                thing.read()
            for interface in self.interfaces():
                interface.read()
            for chart in self.charts():
                if chart.chart.drawing is not None:
                    chart.chart.drawing.read()

    def pou(self, name: str) -> Pou:
        """Return the POU of this name; case does not matter. Raises `ModelError`."""
        check_argument(name, str, "the name of a POU is needed")
        for pou in self.pous:
            if pou.name.casefold() == name.casefold():
                return pou
        names = [pou.name for pou in self.pous]
        raise ModelError(
            f"the project has no POU {name!r}{nearest(name, names)}",
            hint="It has: " + (", ".join(names[:20]) or "none"),
        )

    def add_program(self, name: str, *parts: Any, place: str = "") -> Pou:
        """Append a program with a chart of these parts; see `SfcNetwork.add_sequence`. `place` as in `Pou`.

        Raises `ModelError` where the name is taken or a part is out of place; then nothing is changed.
        """
        return self._add_pou(name, PouKind.PROGRAM, parts, place)

    def add_function_block(self, name: str, *parts: Any, place: str = "") -> Pou:
        """Append a function block with a chart, as `add_program` does."""
        return self._add_pou(name, PouKind.FUNCTION_BLOCK, parts, place)

    def _add_pou(self, name: str, kind: PouKind, parts: tuple[Any, ...], place: str) -> Pou:
        check_argument(name, str, "the name of a POU is a text")
        if any(pou.name.casefold() == name.casefold() for pou in self.pous):
            raise ModelError(f"the project has a POU {name!r} already")
        chart = SfcNetwork()
        pou = Pou(name=name, kind=kind, interface=Interface(), bodies=[SfcBody(chart=chart)], place=place)
        self.pous.append(pou)
        try:
            if parts:
                chart.add_sequence(*parts)
        except ModelError:
            self.pous.remove(pou)
            raise
        return pou

    def edit(self, *, clean: bool = False, prove: bool = False, limit: float | str | None = None) -> sfc.Editor:
        """Return the editor of the project: edits that are made whole or not at all, and can be undone.

        `clean`: remove what an edit leaves without a use. `prove`: refuse an edit that changes what charts do, after
        running them for at most `limit` each. See `plcopen_sfc.refactor.editor.Editor`.
        """
        editor: sfc.Editor = provided("edit")(self, clean=clean, prove=prove, limit=limit)
        return editor

    def rename(self, path: str, new: str) -> RenameResult:
        """Give a thing another name; every use of it in every body and declaration follows.

        `path` is ``Main``, ``Main.Step3``, ``GVL.x``, ``Type.member`` ..; case does not matter. Raises `ModelError`
        where there is no such thing, or the new name is no name or would mean something else somewhere. See
        `plcopen_sfc.refactor.rename`.
        """
        result: RenameResult = provided("rename")(self, path, new)
        return result

    def rename_many(self, table: Mapping[Any, str]) -> list[RenameResult]:
        """Give several things new names in one pass, all of them or none: ``{"Main.S1": "Fill", "Main.S2": "Mix"}``.

        Names may be exchanged. Gives a result for each entry. Raises `ModelError` as `rename` does. See
        `plcopen_sfc.refactor.rename`, also for tables by pattern.
        """
        results: list[RenameResult] = provided("rename_many")(self, table)
        return results

    def find(self, pattern: str, kind: str | None = None) -> list[Declaration]:
        """Return the declarations that fit a pattern (``*`` and ``?``): ``project.find("Motor*", "variable")``.

        It is compared with the whole path (``Main.Motor1``) and with its end (``Motor1``); case does not matter. `kind`
        is one of `plcopen_sfc.model.declaration.Kind`. Each has its `kind`, `path`, and the object (`holder`).
        """
        found: list[Declaration] = provided("find_declared")(self, pattern, kind)
        return found

    def steps(self, where: Callable[[Step], bool] | None = None, **conditions: Any) -> list[Step]:
        """Return the steps of all charts, those in macro-steps too, that satisfy conditions; see `SfcNetwork.find`."""
        found: list[Step] = provided("find_steps")(self, where, **conditions)
        return found

    def find_transitions(
        self, where: Callable[[Transition], bool] | None = None, **conditions: Any
    ) -> list[Transition]:
        """Return the transitions of all charts that satisfy the conditions; see `SfcNetwork.find_transitions`."""
        found: list[Transition] = provided("find_transitions")(self, where, **conditions)
        return found

    def uses(self, what: Declaration | Model | str) -> list[Use]:
        """Return every place that names a thing: a path (``Main.S3``), an object of the model, or what `find` gave.

        The place of its declaration is not among them. Raises `ModelError` where the project declares no such thing.
        """
        found: list[Use] = provided("find_uses")(self, what)
        return found

    def cross_references(self, kind: str | None = "variable") -> list[dict[str, Any]]:
        """Return the cross references as a table: a dictionary for each use of a variable, or of an object of `kind`.

        None: of everything. Keys: `name`, `kind`, `place`, `language`, `line`, `column`, `text`.
        """
        records: list[dict[str, Any]] = provided("cross_references")(self, kind)
        return records

    def locations_of(self, paths: Iterable[str]) -> list[Location]:
        """Places of objects in the files of the project, by their paths: ``POU Main / step S3``.

        Each place has the path, and the file and line as far as they are known: those of what is around the object
        where the format has no more.
        """
        places: list[Location] = provided("locations_of")(self, paths)
        return places

    def _repr_html_(self) -> str:
        """Show what is in the project in Jupyter: a row for each POU, type, list of variables and task."""
        table: str = provided("project_table")(self)
        return table

    def objects(self) -> Iterator[ProjectObject]:
        """Yield the objects that have files of their own in some tools; what others need comes first."""
        for name in self.OBJECTS:
            yield from getattr(self, name)

    def resources(self) -> Iterator[Resource]:
        """Yield every resource: those without a configuration, then those of each configuration."""
        yield from self.applications
        for configuration in self.configurations:
            yield from configuration.resources

    def tasks(self) -> list[Task]:
        """Return the tasks of all resources."""
        return [task for resource in self.resources() for task in resource.tasks]

    def global_sections(self) -> Iterator[VariableSection]:
        """Yield every list of global variables: of the project, its resources and its configurations."""
        yield from self.global_variables
        for application in self.applications:
            yield from application.global_variables
        for configuration in self.configurations:
            yield from configuration.global_variables
            for resource in configuration.resources:
                yield from resource.global_variables

    def bodies(self) -> Iterator[NamedBody]:
        """Yield every body in the project with its name (``Main.Fill``) and POU."""
        for pou in self.pous:
            yield from pou.named_bodies()

    def interfaces(self) -> Iterator[Interface]:
        """Yield the interfaces of its POUs and of their methods."""
        for pou in self.pous:
            yield from pou.interfaces()

    def charts(self) -> Iterator[Chart]:
        """Yield every chart of the project: of POUs, actions, transitions and methods."""
        for name, pou, body in self.bodies():
            if isinstance(body, SfcBody):
                yield Chart(name, pou, body.chart)
