"""SimaticML in the table of formats: read, write, patch, and normalise documents.

`document_reader` reads a document of TIA Portal Openness; here its frame and the objects in it are written. Ids of
objects are hexadecimal numbers that mean nothing, and that an edit should not change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import SequenceMatcher

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.formats.format_interface import SOURCE_CHART_FIELD, ReadResult, WriteOptions, may_have
from plcopen_sfc.formats.simaticml.action_rows import action_functions
from plcopen_sfc.formats.simaticml.added_elements import mark_added, seal_marks
from plcopen_sfc.formats.simaticml.document_reader import IDS, PRODUCT, SCHEMA, find_version, read_project
from plcopen_sfc.formats.simaticml.element_reader import local
from plcopen_sfc.formats.simaticml.element_writer import ID, DocumentWriting, add_element, finish, sub
from plcopen_sfc.formats.simaticml.network_boxes import put_operands, put_standard_blocks
from plcopen_sfc.formats.simaticml.openness_objects import KINDS, Thing
from plcopen_sfc.formats.simaticml.openness_schemas import fit_alarms, refuse_older
from plcopen_sfc.formats.simaticml.tia_adaptation import adapt
from plcopen_sfc.formats.simaticml.tia_versions import DEFAULT, SCHEMAS, TiaVersion, version_like
from plcopen_sfc.formats.xml.extension_data import (
    Markup,
    attributes_of,
    elements_of,
    exchange_markup,
    markup_of,
    misfit,
)
from plcopen_sfc.formats.xml.xml_codec import FolderCodec, XmlStyle, write_xml
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse_xml
from plcopen_sfc.languages.library_blocks import library_blocks
from plcopen_sfc.languages.s7_actions import ActionCalls
from plcopen_sfc.languages.s7_boxes import put_boxes
from plcopen_sfc.languages.s7_globals import data_blocks_of, left_out, tag_tables_of, unconnected
from plcopen_sfc.languages.s7_programs import report_tasks, s7_programs
from plcopen_sfc.languages.s7_types import s7_types
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.body import FbdBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.network import Block, BlockCall, LogicNetwork
from plcopen_sfc.model.pou import DataBlock, DataBlockKind, Pou
from plcopen_sfc.model.project import FileHeader, Project, TagTable
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.report import ConversionReport, Outcome


def number_objects(root: etree._Element, given: list[str]) -> None:
    """Give every object its id: those of the file (`given`) where they are no running numbers, else these."""
    objects = _all_objects(root)
    ids = given if len(given) == len(objects) else [format(place, "X") for place in range(len(objects))]
    for element, text in zip(objects, ids, strict=True):
        element.set(ID, text)


def number_like(root: etree._Element, before: etree._Element, given: list[str]) -> None:
    """Give every object of an edited document the id that it had `before`; new ones get numbers above all others."""
    pairs: list[tuple[etree._Element, etree._Element]] = []
    _pair(before, root, pairs)
    number_objects(before, given)
    for old, new in pairs:
        new.set(ID, old.get(ID, ""))
    used = [_value(element.get(ID, "")) for element in _all_objects(before)]
    following = max(used, default=-1) + 1
    known = {new for _, new in pairs}
    for element in _all_objects(root):
        if element not in known:
            element.set(ID, format(following, "X"))
            following += 1


def _value(text: str) -> int:
    try:
        return int(text, 16)
    except ValueError:
        return -1


def _all_objects(root: etree._Element) -> list[etree._Element]:
    return [element for element in root.iter(etree.Element) if element.get(ID) is not None]


def _objects(element: etree._Element) -> list[etree._Element]:
    """Return the objects directly in an object."""
    found: list[etree._Element] = []
    for child in element:
        if isinstance(child.tag, str):
            found += [child] if child.get(ID) is not None else _objects(child)
    return found


def _pair(before: etree._Element, after: etree._Element, pairs: list[tuple[etree._Element, etree._Element]]) -> None:
    """Find the objects in `after` that are those of `before`; ids are not written yet."""
    old, new = _objects(before), _objects(after)
    # ranges that are equal fix the order; edited objects lie between them and are paired by place and tag. Without
    # autojunk, as many empty networks are equal
    matcher = SequenceMatcher(None, [_content(one) for one in old], [_content(one) for one in new], autojunk=False)
    for _, old_start, old_end, new_start, new_end in matcher.get_opcodes():
        for one, other in zip(old[old_start:old_end], new[new_start:new_end], strict=False):
            if one.tag == other.tag:
                pairs.append((one, other))
                _pair(one, other, pairs)


def _content(element: etree._Element) -> bytes:
    return etree.tostring(element, with_tail=False)


_NATIVE = frozenset({"header", "pous", "data_blocks", "data_types", "tag_tables", "dialect"})


def write_project(
    project: Project, version: TiaVersion, report: ConversionReport, options: WriteOptions
) -> etree._Element:
    """Return the tree of the document for `project`; the outcome of each item goes into `report`."""
    root = _tree(project, version, report, options)
    if options.baseline is None:
        if not options.same:
            refuse_older(root, version)
        number_objects(root, _ids(project))
    else:
        before = _tree(options.baseline, version, ConversionReport(), replace(options, baseline=None))
        refuse_older(root, version, before)
        number_like(root, before, _ids(options.baseline))
    return root


def _ids(project: Project) -> list[str]:
    """Return the ids that the file has, where they are no running numbers."""
    return attributes_of(project.extension_data).get(IDS, "").split()


def _tree(project: Project, version: TiaVersion, report: ConversionReport, options: WriteOptions) -> etree._Element:
    """Return the tree with all ids still empty."""
    kept = attributes_of(project.extension_data)
    schemas = {kind: version.schema(kind) for kind in SCHEMAS}
    if options.same:
        given = {name.removeprefix(SCHEMA): value for name, value in kept.items() if name.startswith(SCHEMA)}
        schemas.update({kind: int(number) for kind, number in given.items()})
    ctx = DocumentWriting(options.whole or project, version, schemas, report, options)
    root = etree.Element("Document")
    for name, value in kept.items():
        if name != IDS and not name.startswith(SCHEMA):
            root.set(name, value)
    sub(root, "Engineering", {"version": version.name})
    _document_info(ctx, root, project.header)
    apart = added_objects(project) if options.whole is None else []
    enumerations = {table.name for table in s7_types(project).tables()}
    added = {id(thing) for thing in (project.objects() if options.added else apart)}
    for thing in _in_order(project, apart):
        next(kind for kind in KINDS.values() if isinstance(thing, kind.model)).write(ctx, root, thing)
        if id(thing) in added:
            mark_added(root[-1])
            if isinstance(thing, DataBlock) and thing.kind is DataBlockKind.GLOBAL:
                ctx.note(Outcome.TRANSLATED, "global variables", thing.name, "a data block")
            elif isinstance(thing, TagTable) and thing.name not in enumerations:
                ctx.note(Outcome.TRANSLATED, "global variables", thing.name, "tags and constants")
    for what, name, why in left_out(project):
        ctx.note(Outcome.NOT_EXECUTED, what, name, why)
    for what, name, why in unconnected(project):
        ctx.note(Outcome.NOT_EXECUTED, what, name, why)
    if any(project.resources()):
        report_tasks(ctx.project, report)
    for content in elements_of(project.extension_data):
        add_element(ctx, root, content)
    finish(ctx, root, project, _NATIVE, reported=frozenset({"applications", "configurations"}))
    seal_marks(root)
    return root


def added_objects(project: Project) -> list[Pou | DataBlock | TagTable]:
    """Return the objects that only S7 has: for enumerations, global variables, programs, tasks, actions, libraries."""
    programs = s7_programs(project)
    for caller in programs.callers:
        caller.block.extension_data = ExtensionData(attributes={"SecondaryType": caller.event_class})
        caller.block.bodies = [FbdBody(networks=[_call(*each) for each in caller.called])]
    tables = [*s7_types(project).tables(), *tag_tables_of(project)]
    blocks = [*data_blocks_of(project), *programs.blocks]
    functions = action_functions(project, ActionCalls(project)).made
    return [*tables, *blocks, *library_blocks(project), *functions, *(caller.block for caller in programs.callers)]


def _call(block: str, program: str) -> LogicNetwork:
    """Return a network that calls a data block: all versions of TIA Portal have networks, but not program text."""
    box = Block(id=1, type_name=program, instance=f'"{block}"', call=BlockCall.FUNCTION_BLOCK)
    return LogicNetwork(nodes=[box])


def _in_order(project: Project, added: Sequence[Pou | DataBlock | TagTable]) -> list[Thing]:
    """Objects in the order of the file, else those that others need first; those that are `added` among them."""
    things: list[Thing] = []
    for kind in dict.fromkeys(KINDS.values()):
        things += getattr(project, kind.field)
        things += (thing for thing in added if isinstance(thing, kind.model))

    def rank(thing: Thing) -> int:
        text = attributes_of(thing.extension_data).get(ID, "")
        try:
            return int(text, 16)
        except ValueError:
            return _LAST

    return sorted(things, key=rank)


_LAST = 1 << 32


def _document_info(ctx: DocumentWriting, root: etree._Element, header: FileHeader) -> None:
    """Write the frame of a document that TIA Portal wrote; it needs none to import a file."""
    if header.product != PRODUCT:
        if any(value for name, value in header.model_dump(exclude_defaults=True).items()):
            finish(ctx, root, Project(header=header), frozenset())
        return
    kept = attributes_of(header.extension_data)
    for name, value in kept.items():
        if name == "#text":
            root[0].text = value
        elif name != "DocumentInfo" and not name.startswith("@"):
            root[0].set(name, value)
    elements = elements_of(header.extension_data)
    if not (header.created or header.description is not None or elements or "DocumentInfo" in kept):
        return
    info = sub(root, "DocumentInfo", {name[1:]: value for name, value in kept.items() if name.startswith("@")})
    if header.created:
        sub(info, "Created").text = header.created
    if header.description is not None:
        sub(info, "ExportSetting").text = header.description
    for content in elements:
        add_element(ctx, info, content)


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


def _version(project: Project, options: WriteOptions) -> TiaVersion:
    """Return the version to write."""
    given = options.version or (project.header.version if project.header.product == PRODUCT else "")
    return version_like(given) or DEFAULT


_STYLE = XmlStyle(encoding="utf-8", bom=True, newline="\r\n", self_closing=" />")


class SimaticmlCodec(FolderCodec):
    """SimaticML, the documents of TIA Portal Openness."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        with collecting_rarely():
            root = parse_xml(data, file=file)
            version = find_version(root, file=file)
            fields, diagnostics = read_project(root, version, data, file=file)
            try:
                project = Project.model_validate(fields)
            except ValidationError as error:
                lines = SourceLines(root, data)
                raise misfit(error, fields, root, file=file, lines=lines) from error
            exchange_markup(project, Markup.SIMATICML, markup_of(project))
        return ReadResult(project, diagnostics, version.name)

    def is_rewritten(self, project: Project, content: bytes) -> bool:
        """True if POUs have actions, which blocks of TIA Portal lack: an edit of one may change rows of a chart.

        Charts with SFC flags are written otherwise as well.
        """
        has_actions = may_have(content, "actions") and any(pou.actions for pou in project.pous)
        return has_actions or may_have(content, SOURCE_CHART_FIELD)

    def adapt(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        exchange_markup(project, markup_of(project), Markup.SIMATICML)
        if not options.same:
            if project.header.product == PRODUCT and options.version:
                project.header.version = options.version
            kept = attributes_of(project.extension_data)
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
            kind = KINDS.get(local(owner))
            name = next(owner.iterfind("{*}AttributeList/{*}Name"), None)
            if kind is None or name is None:
                continue
            path = f"{kind.model.kind_in_reports} {name.text or ''}"
            found.setdefault(path, line_of(owner) or 1)
            for member in owner.iterfind("{*}AttributeList/{*}Interface/*/*/{*}Member"):
                found.setdefault(f"{path} / {member.get('Name')}", line_of(member) or 1)
            for part in owner.iter("{*}Step", "{*}Transition"):
                found.setdefault(f"{path} / {local(part).lower()} {part.get('Name')}", line_of(part) or 1)
        return found

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Put boxes into `project`, a copy, where other tools have something else, or boxes with instances."""
        exchange_markup(project, markup_of(project), Markup.SIMATICML)
        put_boxes(project)
        put_standard_blocks(project)
        put_operands(project, report, of_charts=False)
        exchange_markup(project, Markup.SIMATICML, markup_of(project))

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        version = _version(project, options)
        # a document of a folder has objects of the project; those that are added to it for TIA Portal have its markup
        own = Markup.SIMATICML if options.added else markup_of(options.whole or project)
        # what is kept of the source is no part of the project; an object may be kept twice
        sources = [
            mark[field] for mark in options.marks.values() for field in (SOURCE_CHART_FIELD, "actions") if field in mark
        ]
        written = list({id(each): each for each in (project, *sources)}.values())
        for each in written:  # no copy: `options.marks` names its objects by their ids
            exchange_markup(each, own, Markup.SIMATICML)
        try:
            return write_project(project, version, report, options)
        finally:
            for each in written:
                exchange_markup(each, Markup.SIMATICML, own)

    def style(self) -> XmlStyle:
        """As TIA Portal writes: UTF-8 with a mark, CRLF, two blanks, ``<a />``."""
        return _STYLE

    def normalize(self, data: bytes) -> bytes:
        """Return the document without the parts that an import ignores."""
        return normalize(data, _STYLE)

    def validate(self, content: bytes, *, file: str | None = None) -> list[Diagnostic]:
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
