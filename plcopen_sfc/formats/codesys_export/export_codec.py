"""Exports of CODESYS V3 in its own format in the table of formats: read, write and patch them.

What is not read of a file (devices, visualizations, libraries) stays in it. A new file has none of it.

======  ==========================================================================
CEX102  an object that cannot be read; the others are
CEX103  objects that are kept in the file as they are, and are nothing in the model
CEX104  an identity that two objects have
CEX105  an object that lacks something which all have, such as a name or the text of its body
CEX106  the file breaks off or is damaged: of its objects those before that place are read
======  ==========================================================================
"""

from __future__ import annotations

from collections import Counter
from functools import partial
from typing import NamedTuple

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import EncodingError, FormatError, Location, StructureError, XmlSyntaxError
from plcopen_sfc.formats.archives.object_elements import (
    identities_in,
    line_below,
    path_of,
    read_element,
    take_out_others,
    write_declared,
    write_pou,
)
from plcopen_sfc.formats.archives.object_identities import identity_of
from plcopen_sfc.formats.archives.object_lines import object_lines
from plcopen_sfc.formats.codesys_export.export_entries import (
    ACCESSOR,
    INNER,
    INTERFACE,
    LIST,
    PARTS,
    POU,
    PROPERTY,
    TASK,
    TREE,
    TYPE,
    Entry,
    ObjectPlace,
    around,
    damages,
    element_of,
    entries,
    entry_lists,
    inner_entries,
    move_inside,
    new_entry,
    new_file,
    put,
    unlisted,
    why_not_read,
)
from plcopen_sfc.formats.codesys_export.export_notation import SINGLE, line_elements, member, value
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.plcopen.tc6_reading import PLACELESS, Tc6ReadContext
from plcopen_sfc.formats.plcopen.tc6_versions import V2_0
from plcopen_sfc.formats.xml.source_tree import PatchError
from plcopen_sfc.formats.xml.xml_codec import XmlCodec, XmlStyle, write_xml
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, line_of, parse_broken_xml, parse_xml
from plcopen_sfc.grouping import grouped
from plcopen_sfc.model.checked import first_misfit
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import PouInstance, Project, Resource, Task, TaskSettings, TaskWatchdog
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.model.variables import VariableSection
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.whole_numbers import whole_number

_SETTINGS = {
    "kind": ("Kindoftask",),
    "interval": ("Interval", "Time"),
    "interval_unit": ("Interval", "Unit"),
    "event": ("Event",),
}
_WATCHDOG = {
    "time": ("Watchdog", "Time", "Time"),
    "time_unit": ("Watchdog", "Time", "Unit"),
    "sensitivity": ("Watchdog", "Sensitivity"),
}
_CALL_TYPE = "{f194d1ef-7376-42ce-a729-4a5485a97a46}"


def read_task(entry: Entry) -> Task:
    """Return the task of an entry."""
    content = entry.content
    task = Task(name=entry.name, object_id=entry.guid)
    task.priority = whole_number(value(content, "Priority").strip()) or 0
    stated = {name: value(content, *path) or None for name, path in _SETTINGS.items()}
    watched = {name: value(content, *path) or None for name, path in _WATCHDOG.items()}
    is_watched = value(content, "Watchdog", "Enabled").casefold() == "true"
    task.settings = TaskSettings(**stated, watchdog=TaskWatchdog(enabled=is_watched, **watched))
    calls = member(content, "PouList")
    names = [value(call, "Name") for call in calls] if calls is not None else []
    task.instances = [PouInstance(name=name, type_name="") for name in names if name]
    return task


def change_task(entry: Entry, task: Task) -> None:
    """Change an entry to its task in the model."""
    content = entry.content
    before = read_task(entry)
    if content is None or before == task:
        return
    named = member(entry.element, "MetaObject", "Name")
    if named is not None:
        named.text = task.name
    _set(entry, ("Priority",), str(task.priority))
    settings = task.settings or TaskSettings()
    interval = task.interval if task.interval != before.interval else settings.interval
    stated = {**settings.model_dump(include=set(_SETTINGS)), "interval": interval}
    for name, path in _SETTINGS.items():
        _set(entry, path, stated[name] or "")
    watchdog = settings.watchdog or TaskWatchdog()
    _set(entry, ("Watchdog", "Enabled"), str(watchdog.enabled))
    for name, path in _WATCHDOG.items():
        _set(entry, path, getattr(watchdog, name) or "")
    calls = member(content, "PouList")
    if calls is not None and [each.name for each in before.instances] != [each.name for each in task.instances]:
        old = {value(call, "Name"): call for call in calls}
        calls[:] = [old.get(each.name, _call(each.name)) for each in task.instances]


def _set(entry: Entry, path: tuple[str, ...], text: str) -> None:
    found = member(entry.content, *path)
    if found is not None and (found.text or "") != text:
        found.text = text


def _call(name: str) -> etree._Element:
    call = etree.Element(SINGLE, Type=_CALL_TYPE, Method="IArchivable")
    etree.SubElement(call, SINGLE, Name="Name", Type="string").text = name
    etree.SubElement(call, SINGLE, Name="Comment", Type="string").text = ""
    return call


_SOURCE = "codesys-export"
_READ = frozenset({POU, TYPE, LIST, INTERFACE, TASK})
_INDENT = "  "


class ExportCodec(XmlCodec):
    """Exports of CODESYS V3 in its own format."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        parsed = _parsed(data, file)
        root = parsed.root
        if root.tag != "ExportFile" or not entry_lists(root):
            raise StructureError(
                f"<{root.tag}> has no list of objects (EntryList)",
                location=Location(file, line_of(root)),
                hint="Export the objects again: in CODESYS, Project > Export.",
            )
        return _Reader(parsed, data, file).read()

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        return _Reader(_parsed(content), content, None).lines(project)

    def adapt(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Take out of `project`, a copy, what a new file does not hold."""
        if options.same:
            return
        for task in project.tasks():
            why = "the task configuration belongs to the device: make it in CODESYS"
            report.add(Outcome.NOT_EXECUTED, "task", f"task {task.name}", why)
        take_out_others(project)
        if any(project.charts()):
            why = "in the form that files of TwinCAT 3 have, unverified in CODESYS; see them after the import"
            report.add(Outcome.TRANSLATED, "charts", "project", why)

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the file for `project`: where it is patched, the one that it has, with the edits.

        Raises `PatchError` where the file is not read to its end.
        """
        source = _parsed(options.source) if options.same and options.source else None
        if source is not None and source.error is not None:
            raise PatchError(
                f"edits cannot be put into a file that is not read to its end: {source.error.message}",
                location=source.error.location,
                hint="Nothing was written. Export the objects again in CODESYS, and edit that file.",
            )
        return _Writer(project, source.root if source is not None else None, options, report).write()

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a file from the model, beside what only the source has where there is one."""
        root = self.to_tree(project, options, report)
        _lay_out(root)
        return write_xml(root, self.style())

    def style(self) -> XmlStyle:
        """As CODESYS writes: UTF-8 without a mark or a declaration, CRLF, two blanks, ``<a />``."""
        return XmlStyle(newline="\r\n", indent=None, self_closing=" />", declaration="", final_newline=True)


def _lay_out(root: etree._Element) -> None:
    """Lay out a file as the tool does: each archive begins again at the left."""
    root.text = f"\n{_INDENT}"
    for view in root:
        if len(view):  # else it is damaged, and something else
            etree.indent(view[0], _INDENT)
            view.text, view[0].tail = "\n", _INDENT
        view.tail = f"\n{_INDENT}" if view is not root[-1] else "\n"
    for each in root.iter("Single"):  # values without a text are closed by a tag of their own
        if each.get("Type") == "string" and not each.text:
            each.text = ""


class _Parsed(NamedTuple):
    """The tree of a file; with `error`, where the file is damaged, that of the whole objects before this place."""

    root: etree._Element
    error: FormatError | None = None


def _parsed(data: bytes, file: str | None = None) -> _Parsed:
    """Return the tree of a file. Raises `FormatError` where not even one object in it is whole."""
    try:
        return _Parsed(parse_xml(data, file=file))
    except (XmlSyntaxError, EncodingError) as error:  # a file breaks off inside of a character, too
        broken = parse_broken_xml(data, file=file)
        if broken is None:
            raise
        for entry in [*entries(broken.root)]:
            holder = entry.element.getparent()
            if entry.element in broken.begun and holder is not None:
                holder.remove(entry.element)
        if not any(entries(broken.root)):
            raise
        return _Parsed(broken.root, error)


class _Reader:
    def __init__(self, parsed: _Parsed, data: bytes, file: str | None) -> None:
        self._file = file
        self._error = parsed.error
        root = parsed.root
        self._ctx = Tc6ReadContext(V2_0, PLACELESS, file=file, lines=SourceLines(root, data))
        self._root = root
        self._entries = list(entries(root))
        self._inner = inner_entries(self._entries)

    def read(self) -> ReadResult:
        project = Project(dialect=Dialect.CODESYS)
        applications: dict[str, Resource] = {}
        kept: dict[str, list[Entry]] = {}
        known = {entry.guid: entry for entry in self._entries}
        for guid in (guid for guid, count in Counter(entry.guid for entry in self._entries).items() if count > 1):
            second = [entry for entry in self._entries if entry.guid == guid][1]
            message = f"the identity {guid} of {second.name} is that of another object"
            self._ctx.error("CEX104", message, second.element)
        for entry in unlisted(self._root):
            self._ctx.error("CEX102", f"{entry.name} is not read: it is in no list of objects", entry.element)
        for entry in self._entries:
            kind = entry.kind
            for lacking, element in damages(entry, known) if kind in _READ or kind in INNER else ():
                self._ctx.error(
                    "CEX105", f"{entry.name or '(none)'} lacks what all such objects have: {lacking}", element
                )
            if kind == TASK:
                holder = known.get(entry.parent)
                application = next(iter(ObjectPlace.of(entry).path[-2:-1]), holder.name if holder is not None else "")
                found = applications.setdefault(application, Resource(name=application))
                found.tasks.append(read_task(entry))
            elif kind in _READ:
                self._take(project, entry)
            elif why := why_not_read(entry, known, self._inner):
                self._ctx.error("CEX102", f"{entry.name} is not read: {why}", entry.element)
            elif kind not in INNER and kind not in TREE:
                kept.setdefault(kind, []).append(entry)
        project.applications = list(applications.values())
        project.adopt()  # each object was in a project of its own
        if kept:
            what = ", ".join(f"{len(held)} of {kind} ({held[0].name})" for kind, held in sorted(kept.items()))
            message = f"objects that are kept in the file as they are, and nowhere else: {what}"
            first = min((held[0] for held in kept.values()), key=self._entries.index)
            self._ctx.warn("CEX103", message, first.element)
        if self._error is not None:
            message = f"nothing behind {self._entries[-1].name} is read: {self._error.message}"
            place = self._error.location
            self._ctx.diagnostics.append(Diagnostic("CEX106", Severity.ERROR, message, place, self._error.hint))
        return ReadResult(project, self._ctx.diagnostics)

    def _take(self, project: Project, entry: Entry) -> None:
        """Read an object; where it cannot be read, the others are."""
        self._ctx.place = []
        try:
            thing = element_of(entry, self._inner)
            found = read_element(self._ctx, thing, self._file, source=_SOURCE, line_at=partial(self._line_in, entry))
        except (FormatError, ValidationError) as error:
            what = error.message if isinstance(error, FormatError) else first_misfit(error)
            self._ctx.error("CEX102", f"{entry.name} is not read: {what}", entry.element)
            return
        project.pous += found.pous
        project.data_types += found.data_types
        project.global_variables += found.global_variables
        if found.extension_data is not None:
            project.extension_data = project.extension_data or type(found.extension_data)()
            project.extension_data.data += found.extension_data.data

    def lines(self, project: Project) -> dict[str, int]:
        """Return the lines of the objects of a project that was read from the file."""
        found: dict[str, int] = {}
        for entry in (each for each in self._entries if each.kind in _READ):
            try:
                thing = element_of(entry, self._inner)
            except StructureError:  # it is not read
                continue
            found |= object_lines(thing, project, line_of, partial(self._line_in, entry))
        return found

    def _line_in(self, entry: Entry, holder: etree._Element, line: int) -> int | None:
        """Return the line of the file in which a line of a declaration is."""
        guid = (identity_of(holder) or "").casefold()
        owner = next((each for each in (entry, *self._inner.get(entry.guid, ())) if each.guid == guid), entry)
        lines = line_elements(member(owner.content, "Interface"))
        if lines:
            return line_of(lines[min(max(line, 0), len(lines) - 1)])
        return line_below(holder, line)


class _Writer:
    def __init__(
        self, project: Project, source: etree._Element | None, options: WriteOptions, report: ConversionReport
    ) -> None:
        self._project = project
        self._report = report
        self._options = options
        self._root = source if source is not None else new_file()
        found = list(entries(self._root))
        self._entries = {entry.guid: entry for entry in found}
        self._inner = inner_entries(found)
        self._written: set[str] = set()
        declared: list[DataTypeDeclaration | VariableSection] = [*project.data_types, *project.global_variables]
        known = {each.object_id for each in declared if each.object_id is not None}
        self._taken = known.union(*map(identities_in, project.pous))
        pous = [entry for entry in found if entry.kind == POU]
        self._usual = ObjectPlace.of(pous[0]) if pous else ObjectPlace()

    def write(self) -> etree._Element:
        project, report = self._project, self._report
        for pou in project.pous:
            old = self._entries.get((pou.object_id or "").casefold())
            source = element_of(old, self._inner) if old is not None else None
            written = write_pou(pou, report, source, format=_SOURCE, taken=self._taken)
            entry = self._put(POU, written, self._usual, pou.name)
            inside = ObjectPlace.inside(entry)
            for part in written:
                if part.tag in PARTS:
                    self._put(str(part.tag), part, inside, f"{pou.name}.{part.get('Name')}")
                if part.tag == PROPERTY:
                    around = ObjectPlace.inside(self._put(PROPERTY, part, inside, ""))
                    for accessor in part.iterchildren("Get", "Set"):
                        self._put(ACCESSOR, accessor, around, "")
            for each in self._inner.get(entry.guid, ()):
                move_inside(each, entry)
        for declared in project.data_types:
            self._declared(TYPE, Project(data_types=[declared]))
        for sections in grouped((section.name or "", section) for section in project.global_variables).values():
            self._declared(LIST, Project(global_variables=sections))
        for task in (task for resource in project.applications for task in resource.tasks):
            self._task(task)
        self._remove_others()
        return self._root

    def _declared(self, kind: str, alone: Project) -> None:
        thing = alone.data_types[0] if alone.data_types else alone.global_variables[0]
        old = self._entries.get((thing.object_id or "").casefold())
        self._put(
            kind,
            write_declared(alone, element_of(old, {}) if old is not None else None, taken=self._taken),
            self._usual,
            "",
        )
        what = "data type" if kind == TYPE else "global variables"
        self._report.add(Outcome.KEPT, what, path_of(alone))

    def _put(self, kind: str, written: etree._Element, place: ObjectPlace, body: str) -> Entry:
        guid = (identity_of(written) or "").casefold()
        entry = self._entries.get(guid)
        if entry is None or guid in self._written:
            entry = new_entry(kind, guid, written.get("Name", ""), place)
            owner = self._entries.get(place.guid)
            holder = owner.element.getparent() if owner is not None else None
            (holder if holder is not None else entry_lists(self._root)[0]).append(entry.element)
            self._entries[guid] = entry
        self._written.add(guid)
        put(entry, written, keep_body=body in self._options.untouched)
        return entry

    def _task(self, task: Task) -> None:
        entry = self._entries.get((task.object_id or "").casefold())
        if entry is None or entry.kind != TASK:
            why = "the task configuration belongs to the device: make it in CODESYS"
            self._report.add(Outcome.NOT_EXECUTED, "task", f"task {task.name}", why)
            return
        self._written.add(entry.guid)
        change_task(entry, task)
        self._report.add(Outcome.KEPT, "task", f"task {task.name}")

    def _remove_others(self) -> None:
        """Remove what the model has no more, with what is in it; what it never had stays."""
        for entry in self._entries.values():
            owner = around(entry, self._entries)
            if entry.kind == ACCESSOR and owner is not None:
                owner = around(owner, self._entries)
            gone = entry.kind in (POU, TYPE, LIST, TASK, *INNER) and entry.guid not in self._written
            if owner is not None and owner.kind == POU:
                gone = gone or owner.guid not in self._written  # a folder in it, too
            elif entry.kind in INNER:
                gone = False  # of an interface
            held = entry.element.getparent()
            if gone and held is not None:
                held.remove(entry.element)


CODEC = ExportCodec()
