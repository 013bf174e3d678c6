"""SimaticML in the table of formats: read, write, patch, and normalise documents."""

from __future__ import annotations

from collections.abc import Sequence

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.simaticml.compile_units import misfit
from plcopen_sfc.formats.simaticml.document_reader import PRODUCT, SCHEMA, find_version, read_project
from plcopen_sfc.formats.simaticml.document_writer import added_objects, write_project
from plcopen_sfc.formats.simaticml.element_reader import local
from plcopen_sfc.formats.simaticml.openness_objects import DATA_BLOCKS, DATA_TYPE, POUS, TAG_TABLE
from plcopen_sfc.formats.simaticml.openness_schemas import fit_alarms
from plcopen_sfc.formats.simaticml.tia_adaptation import adapt
from plcopen_sfc.formats.simaticml.tia_versions import DEFAULT, TiaVersion, version_like
from plcopen_sfc.formats.xml.extension_data import Markup, exchange_markup, markup_of
from plcopen_sfc.formats.xml.xml_codec import FolderCodec, XmlStyle, write_xml
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse_xml
from plcopen_sfc.languages.s7_flip_flops import put_boxes
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import FileHeader, Project, TagTable
from plcopen_sfc.model.project_object import ProjectObject
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.report import ConversionReport

BLOCKS = "Program blocks"
TYPES = "PLC data types"
TAGS = "PLC tags"


def new_document(version: str) -> Project:
    """Return a document without objects, of a version of TIA Portal (empty: the usual)."""
    return Project(dialect=Dialect.SCL, header=FileHeader(product=PRODUCT, version=version or DEFAULT.name))


def standard_folder(thing: ProjectObject) -> str:
    """Return the folder for an object that has none yet."""
    if isinstance(thing, TagTable):
        return TAGS
    return TYPES if isinstance(thing, DataTypeDeclaration) else BLOCKS


_DATES = frozenset(
    """
    CodeModifiedDate CompileDate CreationDate InterfaceModifiedDate ModifiedDate ParameterModified StructureModified
    """.split()
)
"""Attributes of objects that no import looks at, marked or not."""
_INFORMATIVE = frozenset(
    """
    Address BooleanAttribute Comment DateAttribute IntegerAttribute Member RealAttribute StartValue StringAttribute
    """.split()
)
"""Elements that are complete without them. Other elements marked as informative have to stay."""


def normalize(data: bytes, style: XmlStyle, *, file: str | None = None) -> bytes:
    """Document `data` in `style`, without the parts that an import ignores. Normalising it again changes nothing.

    Raises `FormatError` for data that is no document of TIA Portal Openness.
    """
    root = parse_xml(data, file=file)
    find_version(root, file=file)
    for info in root.findall("DocumentInfo"):
        _remove(info)
    for element in [each for each in root.iter(etree.Element) if _ignored(each)]:
        _remove(element)
    for holder in root.findall(".//{*}Member/{*}AttributeList"):
        if not len(holder) and not holder.attrib:
            _remove(holder)
    return write_xml(root, style)


def _ignored(element: etree._Element) -> bool:
    name = etree.QName(element).localname
    parent = element.getparent()
    if parent is not None and parent.tag == "AttributeList" and (element.get("ReadOnly") == "true" or name in _DATES):
        return True
    return element.get("Informative") == "true" and name in _INFORMATIVE


def _remove(element: etree._Element) -> None:
    """Take an element out, but not the text behind it."""
    parent = element.getparent()
    if parent is None:
        return
    before, tail = element.getprevious(), (element.tail or "").strip()
    if tail and before is not None:
        before.tail = (before.tail or "") + tail
    elif tail:
        parent.text = (parent.text or "") + tail
    parent.remove(element)


_KINDS = {
    **dict.fromkeys(POUS, Pou.kind_in_reports),
    **dict.fromkeys(DATA_BLOCKS, DataBlock.kind_in_reports),
    DATA_TYPE: DataTypeDeclaration.kind_in_reports,
    TAG_TABLE: TagTable.kind_in_reports,
}
"""Names of the objects of a document in reports."""


def _version(project: Project, options: WriteOptions) -> TiaVersion:
    """Return the version to write."""
    given = options.version or (project.header.version if project.header.product == PRODUCT else "")
    return version_like(given) or DEFAULT


_STYLE = XmlStyle(encoding="utf-8", bom=True, newline="\r\n", self_closing=" />")


class SimaticmlCodec(FolderCodec):
    """SimaticML, the documents of TIA Portal Openness."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a document of TIA Portal Openness. Raises `FormatError`."""
        with collecting_rarely():
            root = parse_xml(data, file=file)
            version = find_version(root, file=file)
            fields, diagnostics = read_project(root, version, data, file=file)
            try:
                project = Project.model_validate(fields)
            except ValidationError as error:
                raise misfit(error, file) from error
            exchange_markup(project, Markup.SIMATICML, markup_of(project))
        return ReadResult(project, diagnostics, version.name)

    def is_rewritten(self, project: Project, content: bytes) -> bool:
        """True if POUs have actions, which blocks of TIA Portal lack: an edit of one may change rows of a chart."""
        return b'"actions"' in content and any(pou.actions for pou in project.pous)

    def adapt(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Adapt `project`, a copy, to this format."""
        exchange_markup(project, markup_of(project), Markup.SIMATICML)
        if not options.same:
            if project.header.product == PRODUCT and options.version:
                project.header.version = options.version
            kept = project.carried.attributes if project.carried is not None else {}
            for name in [name for name in kept if name.startswith(SCHEMA)]:
                del kept[name]
            for chart in project.charts():
                fit_alarms(chart.chart, _version(project, options))
        version = _version(project, options)
        adapt(project, report, foreign=not options.same)
        if not project.header.product:  # a project made in Python: nothing is lost when the file names its reader
            project.header.product, project.header.version = PRODUCT, version.name
        exchange_markup(project, Markup.SIMATICML, markup_of(project))

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        """Return the lines of the objects in the file `content`, with the variables, steps and transitions of blocks.

        They are by the paths that the report gives them.
        """
        found: dict[str, int] = {}
        root = parse_xml(content)
        line_of = SourceLines(root, content).line
        for owner in root:
            kind = _KINDS.get(local(owner))
            name = next(owner.iterfind("{*}AttributeList/{*}Name"), None)
            if kind is None or name is None:
                continue
            path = f"{kind} {name.text or ''}"
            found.setdefault(path, line_of(owner) or 1)
            for member in owner.iterfind("{*}AttributeList/{*}Interface/*/*/{*}Member"):
                found.setdefault(f"{path} / {member.get('Name')}", line_of(member) or 1)
            for part in owner.iter("{*}Step", "{*}Transition"):
                found.setdefault(f"{path} / {local(part).lower()} {part.get('Name')}", line_of(part) or 1)
        return found

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Put boxes back into `project`, a copy, where tools without them had something else."""
        exchange_markup(project, markup_of(project), Markup.SIMATICML)
        put_boxes(project)
        exchange_markup(project, Markup.SIMATICML, markup_of(project))

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the document for `project`."""
        version = _version(project, options)
        if markup_of(project) is not Markup.SIMATICML:
            project = project.model_copy(deep=True)
            exchange_markup(project, markup_of(project), Markup.SIMATICML)
        return write_project(project, version, report, options)

    def style(self) -> XmlStyle:
        """As TIA Portal writes: UTF-8 with a mark, CRLF, two blanks, ``<a />``."""
        return _STYLE

    def normalize(self, data: bytes) -> bytes:
        """Return the document without the parts that an import ignores."""
        return normalize(data, _STYLE)

    def validate(self, content: bytes, *, file: str | None = None) -> list[Diagnostic]:
        """Findings in a file by the schemas of the format."""
        from plcopen_sfc.formats.simaticml.openness_schemas import validate  # noqa: PLC0415  # brings xmlschema

        return validate(content, file=file)

    def standard_folder(self, thing: ProjectObject) -> str:
        """Return the folder in which TIA Portal puts an object of this kind."""
        return standard_folder(thing)

    def new_document(self, version: str) -> Project:
        """Return a document of TIA Portal without objects."""
        return new_document(version)

    def added_objects(self, project: Project) -> Sequence[ProjectObject]:
        """Objects for TIA Portal alone, such as tag tables of addresses."""
        return added_objects(project)


CODEC = SimaticmlCodec()
