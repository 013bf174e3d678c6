"""Writes a document of TIA Portal Openness: its frame, the objects in it, and their ids. `document_reader` reads it.

Ids of objects are hexadecimal numbers that mean nothing, and that an edit should not change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from difflib import SequenceMatcher

from lxml import etree

from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.simaticml.action_rows import action_functions
from plcopen_sfc.formats.simaticml.added_elements import mark_added, seal_marks
from plcopen_sfc.formats.simaticml.document_reader import IDS, PRODUCT, SCHEMA
from plcopen_sfc.formats.simaticml.element_writer import ID, DocumentWriting, add_element, finish, sub
from plcopen_sfc.formats.simaticml.openness_objects import (
    write_data_block,
    write_data_type,
    write_pou,
    write_tag_table,
)
from plcopen_sfc.formats.simaticml.openness_schemas import refuse_older
from plcopen_sfc.formats.simaticml.tia_versions import TiaVersion
from plcopen_sfc.languages.s7_globals import data_blocks_of, left_out, tag_tables_of, unconnected
from plcopen_sfc.languages.s7_programs import report_tasks, s7_programs
from plcopen_sfc.languages.s7_types import s7_types
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.body import FbdBody
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
    return project.carried.attributes.get(IDS, "").split() if project.carried is not None else []


def _tree(project: Project, version: TiaVersion, report: ConversionReport, options: WriteOptions) -> etree._Element:
    """Return the tree with all ids still empty."""
    kept = project.carried.attributes if project.carried is not None else {}
    schemas = {kind: version.schema(kind) for kind in ("Interface", "Graph", "FlgNet", "StructuredText")}
    schemas["StatementList"] = version.statement_list
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
        if isinstance(thing, Pou):
            write_pou(ctx, root, thing)
        elif isinstance(thing, DataBlock):
            write_data_block(ctx, root, thing)
        elif isinstance(thing, DataTypeDeclaration):
            write_data_type(ctx, root, thing)
        else:
            write_tag_table(ctx, root, thing)
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
    for content in project.carried.elements if project.carried is not None else ():
        add_element(ctx, root, content)
    finish(ctx, root, project, _NATIVE, reported=frozenset({"applications", "configurations"}))
    seal_marks(root)
    return root


def added_objects(project: Project) -> list[Pou | DataBlock | TagTable]:
    """Return the objects that only S7 has: those of enumerations, global variables, programs, tasks and actions."""
    programs = s7_programs(project)
    for caller in programs.callers:
        caller.block.carried = Carried(attributes={"SecondaryType": caller.event_class})
        caller.block.bodies = [FbdBody(networks=[_call(*each) for each in caller.called])]
    tables = [*s7_types(project).tables(), *tag_tables_of(project)]
    blocks = [*data_blocks_of(project), *programs.blocks]
    functions = action_functions(project).made
    return [*tables, *blocks, *functions, *(caller.block for caller in programs.callers)]


def _call(block: str, program: str) -> LogicNetwork:
    """Return a network that calls a data block: all versions of TIA Portal have networks, but not program text."""
    box = Block(id=1, type_name=program, instance=f'"{block}"', call=BlockCall.FUNCTION_BLOCK)
    return LogicNetwork(nodes=[box])


def _in_order(
    project: Project, added: Sequence[Pou | DataBlock | TagTable]
) -> list[Pou | DataBlock | DataTypeDeclaration | TagTable]:
    """Objects in the order of the file, else those that others need first; those that are `added` among them."""
    things: list[Pou | DataBlock | DataTypeDeclaration | TagTable]
    tables = [thing for thing in added if isinstance(thing, TagTable)]
    blocks = [thing for thing in added if isinstance(thing, DataBlock)]
    pous = [*project.pous, *(thing for thing in added if isinstance(thing, Pou))]
    things = [*project.tag_tables, *tables, *project.data_types, *project.data_blocks, *blocks, *pous]

    def rank(thing: Pou | DataBlock | DataTypeDeclaration | TagTable) -> int:
        text = thing.carried.attributes.get(ID, "") if thing.carried is not None else ""
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
    kept = header.carried.attributes if header.carried is not None else {}
    for name, value in kept.items():
        if name == "#text":
            root[0].text = value
        elif name != "DocumentInfo" and not name.startswith("@"):
            root[0].set(name, value)
    elements = header.carried.elements if header.carried is not None else []
    if not (header.created or header.description is not None or elements or "DocumentInfo" in kept):
        return
    info = sub(root, "DocumentInfo", {name[1:]: value for name, value in kept.items() if name.startswith("@")})
    if header.created:
        sub(info, "Created").text = header.created
    if header.description is not None:
        sub(info, "ExportSetting").text = header.description
    for content in elements:
        add_element(ctx, info, content)
