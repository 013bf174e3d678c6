"""Objects of a PLC project of TwinCAT 3, read and written: ``TcPlcObject`` with a POU, a type, variables or a task.

The declaration is text, the body text or an archive. Actions, methods and transition objects are elements of their POU.
``LineIds``, which the tool counts itself, stay in the file and are nothing in the model.

Declarations are structured text without the end of their unit. `iectext` reads and writes whole units. So a declaration
is put into one for it: the END that belongs to it is added, and taken away again.

Tasks have files of their own (``.TcTTO``): a cycle in microseconds, a priority, the programs called. No file of the
corpus is one. What is known of them is from programs of others that read and write them.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple, TypeAlias
from uuid import NAMESPACE_URL, uuid5

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.errors import FormatError, Location, ModelError, StructureError
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.iectext.iectext_codec import IecTextCodec
from plcopen_sfc.formats.iectext.text_source import unwrapped, wrapped
from plcopen_sfc.formats.plcopen.tc6_reading import Tc6ReadContext, line_of
from plcopen_sfc.formats.plcopen.tc6_versions import V2_0
from plcopen_sfc.formats.text_patch import patch_text
from plcopen_sfc.formats.twincat.archived_charts import ChartReader, ChartWriter, read_settings, write_settings
from plcopen_sfc.formats.twincat.kept_data import kept_data, kept_in
from plcopen_sfc.formats.twincat.object_archive import archived, unknown_type
from plcopen_sfc.formats.xml.extension_data import add_markup, markup
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse_xml
from plcopen_sfc.languages.networks.drawn_conditions import shown_body, shown_named_condition
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.task_schedules import FREEWHEELING, cycle_literal, nanoseconds, schedule_of
from plcopen_sfc.model.base import Carried, Element, ForeignData
from plcopen_sfc.model.body import Body, FbdBody, LdBody, OpaqueBody, SfcBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Method, NamedTransition, Pou, PouKind
from plcopen_sfc.model.project import PouInstance, Project, Resource, Task
from plcopen_sfc.model.sfc import SfcNetwork, SfcSettings
from plcopen_sfc.model.variables import Interface
from plcopen_sfc.report import ConversionReport, Outcome

_TEXT = IecTextCodec()
_DIALECT = "{plcopen_sfc project.dialect := 'codesys'} "
_KEYWORDS = frozenset({"PROGRAM", "FUNCTION_BLOCK", "FUNCTION", "INTERFACE"})
_HOLDER = "FUNCTION_BLOCK methods\n"
_END = "\nEND_"
PROPERTY = "property"
"""Place of a property in the text that is kept of it."""


class Unit(NamedTuple):
    """What a declaration is put between to make a whole unit of it."""

    head: str = _DIALECT
    tail: str = "\n"

    def around(self, text: str) -> str:
        """Return the unit with this declaration."""
        return f"{self.head}{text}{self.tail}"

    def inside(self, whole: str) -> str | None:
        """Return the declaration in a unit; None where the unit has another form."""
        if not (whole.startswith(self.head) and whole.endswith(self.tail)):
            return None
        return whole[len(self.head) : len(whole) - len(self.tail)]


def unit_of(declaration: str) -> Unit:
    """Return the unit that a declaration of a POU, an interface, a type or of variables begins."""
    words = (token.value.upper() for token in tokenize(declaration, Dialect.CODESYS, _KEYWORDS).tokens)
    keyword = next((word for word in words if word in _KEYWORDS or word.startswith(("VAR", "TYPE"))), "")
    return Unit(tail=f"{_END}{keyword}\n") if keyword in _KEYWORDS else Unit()


METHOD = Unit(f"{_DIALECT}{_HOLDER}", f"{_END}METHOD{_END}FUNCTION_BLOCK\n")
"""The unit for the declaration of a method."""


def read(unit: str, file: str | None) -> ReadResult:
    """Return the project in a unit."""
    return _TEXT.read(unit.encode(), file=file)


def bare(thing: Pou | Method) -> Project:
    """Return a project that has nothing but the declaration of a POU or a method."""
    if isinstance(thing, Method):
        method = Method(name=thing.name, interface=_interface(thing), comment=thing.comment, carried=_declared(thing))
        method.body = StBody()  # without one a pragma would say so
        pou = Pou(name="methods", kind=PouKind.FUNCTION_BLOCK, methods=[method])
    else:
        pou = Pou(name=thing.name, kind=thing.kind, interface=_interface(thing), comment=thing.comment)
        pou.carried = _declared(thing)
    pou.bodies = [StBody()]
    return Project(pous=[pou], dialect=Dialect.CODESYS)


def _interface(thing: Pou | Method) -> Interface | None:
    return thing.interface.model_copy(deep=True) if thing.interface is not None else None


def _declared(thing: Pou | Method) -> Carried | None:
    """Return what is kept of the declaration: pragmas, and words such as ABSTRACT."""
    kept = [(unwrapped(data.content), data) for data in (thing.carried.data if thing.carried is not None else ())]
    found = [data for text, data in kept if text is not None and text[0] != PROPERTY]
    return Carried(data=found) if found else None


def declaration_of(declared: Project, source: str | None) -> str:
    """Return the declaration of what `declared` has alone: `source`, where there is one, with what differs in it."""
    method = bool(declared.pous and declared.pous[0].methods)
    if source is not None:
        unit = METHOD if method else unit_of(source)
        if _is_declared_by(read(unit.around(source), None).project, declared):
            return source
        found = unit.inside(_patched(unit.around(source), declared))
        if found is not None and _meaning(unit.around(found)) == _meaning(_DIALECT + _written(declared)):
            return found
    text = _written(declared)
    if method:
        lines = text.splitlines()
        start = next(i for i, line in enumerate(lines) if i > 0 and line.strip())  # behind the line of the holder
        end = next(i for i, line in enumerate(lines) if line.split()[:1] == ["END_METHOD"])
        margin = len(lines[start]) - len(lines[start].lstrip())
        return "\n".join(line[margin:] for line in lines[start:end]) + "\n"
    return _OWN_END.sub("\n", text)


_OWN_END = re.compile(r"\s*\n\s*END_(?:PROGRAM|FUNCTION_BLOCK|FUNCTION)\s*\Z")
_OWN_HEAD = re.compile(r"\{plcopen_sfc (?:format|project\.dialect)\b[^}]*\}\s*")


def _is_declared_by(known: Project, declared: Project) -> bool:
    """True if a project that was read from a declaration has nothing otherwise than `declared`."""
    pous = [bare(pou.methods[0] if new.methods else pou) for pou, new in zip(known.pous, declared.pous, strict=False)]
    if [each.pous for each in pous] != [[pou] for pou in declared.pous]:
        return False
    return (known.data_types, known.global_variables) == (declared.data_types, declared.global_variables)


def _patched(whole: str, declared: Project) -> str:
    """Return the unit `whole` with what `declared` declares otherwise."""
    before, after = (read(whole, None).project for _ in range(2))
    after.data_types, after.global_variables = declared.data_types, declared.global_variables
    for old, new in zip(after.pous, declared.pous, strict=False):
        if not new.methods:
            _declare(old, new)
        for method, edited in zip(old.methods, new.methods, strict=False):
            _declare(method, edited)
    source, spans = _TEXT.spans(whole.encode())
    report = ConversionReport()
    blocks = [_TEXT.to_blocks(project, WriteOptions(), report) for project in (before, after)]
    return patch_text(source, spans, *blocks)


def _declare(old: Pou | Method, new: Pou | Method) -> None:
    old.name, old.interface, old.comment, old.carried = new.name, new.interface, new.comment, new.carried
    if isinstance(old, Pou) and isinstance(new, Pou):
        old.kind = new.kind


def _meaning(unit: str) -> object:
    """Return what a unit declares, without our pragmas in it."""
    found = read(_DIALECT + _without_own(unit), None).project
    return found.model_dump(exclude_none=True)


def _written(project: Project) -> str:
    return _without_own(_TEXT.write(project, WriteOptions(), ConversionReport()).decode())


def _without_own(text: str) -> str:
    """Return a text without pragmas of this package, which mean nothing to the tool."""
    return _OWN_HEAD.sub("", _TEXT.as_tool_sees(text.encode()).decode())


TASK = "Task"
_APPLICATION = "PLC"
_MICROSECOND = 1000
_USUAL_CYCLE = 10_000_000


def task_document(*tasks: Task) -> Project:
    """Return a project with nothing but an application that has these tasks."""
    resources = [Resource(name=_APPLICATION, tasks=list(tasks))] if tasks else []
    return Project(applications=resources, dialect=Dialect.CODESYS)


def read_task(element: etree._Element) -> Project:
    """Read ``Task``."""
    priority = (element.findtext("Priority") or "").strip()
    cycle = (element.findtext("CycleTime") or "").strip()
    task = Task(name=element.get("Name", ""))
    task.priority = int(priority) if priority.isdecimal() else 0
    task.interval = cycle_literal(int(cycle)) if cycle.isdecimal() else None
    programs = (name.text or "" for name in element.iterfind("PouCall/Name"))
    task.instances = [PouInstance(name=name.strip(), type_name="") for name in programs]
    return task_document(task)


def write_task(task: Task, identity: str) -> etree._Element:
    """Return ``Task``."""
    written = etree.Element(TASK, Name=task.name, Id=identity)
    length = nanoseconds(schedule_of(task).interval)
    if length is not None:
        etree.SubElement(written, "CycleTime").text = str(length // _MICROSECOND)
    etree.SubElement(written, "Priority").text = str(task.priority)
    for instance in task.instances:
        etree.SubElement(etree.SubElement(written, "PouCall"), "Name").text = instance.name
    return written


def adapted_task(task: Task, report: ConversionReport) -> Task | None:
    """Return a task in terms of TwinCAT, whose tasks are cyclic and call programs by name; None: there is none."""
    path = f"task {task.name}"
    schedule = schedule_of(task)
    length = nanoseconds(schedule.interval)
    if schedule.kind == FREEWHEELING:
        length = _USUAL_CYCLE
        why = "it begins again when it has ended, and tasks of TwinCAT are cyclic: here every 10 ms"
        report.add(Outcome.APPROXIMATED, "interval", path, why)
    elif length is None or schedule.event is not None or schedule.kind:
        report.add(Outcome.NOT_EXECUTED, "task", path, "tasks of TwinCAT are cyclic, with a cycle that is a constant")
        return None
    if task.settings is not None and task.settings.watchdog is not None and task.settings.watchdog.enabled:
        report.add(Outcome.APPROXIMATED, "watchdog", path, "no file of TwinCAT is known to hold it: set it there")
    report.add(Outcome.TRANSLATED, "task", path, "a file of its own: connect it with a real-time task in TwinCAT")
    adapted = Task(name=task.name, priority=task.priority, interval=cycle_literal(length // _MICROSECOND))
    adapted.instances = [PouInstance(name=each.type_name or each.name, type_name="") for each in task.instances]
    return adapted


ROOT = "TcPlcObject"
_FILE_VERSION = "1.1.0.1"
_KINDS = ("POU", "GVL", "DUT", "Itf", TASK)
_Part: TypeAlias = Action | Method | NamedTransition
_PART_NAMES = {Action: "action", Method: "method", NamedTransition: "transition"}
_NOT_SPECIAL = ("SpecialFunc", "None")


# -- reading ----------------------------------------------------------------------------------------------------------


def read_object(data: bytes, *, file: str | None) -> ReadResult:
    """Read a file. Raises `FormatError` where it is none of an object."""
    root = parse_xml(data, file=file)
    thing = next((child for child in root if child.tag in _KINDS), None)
    if root.tag != ROOT or thing is None:
        known = ", ".join(_KINDS)
        found = next((str(child.tag) for child in root if isinstance(child.tag, str)), "nothing")
        raise StructureError(
            f"<{root.tag}> holds {found}, and not an object that is read ({known})",
            location=Location(file, line_of(root)),
            hint="Give the .TcPOU, .TcGVL, .TcDUT, .TcIO and .TcTTO files of the project.",
        )
    ctx = Tc6ReadContext(V2_0, file=file, lines=SourceLines(root, data), placeless=True)
    try:
        project = _Reader(ctx, thing, file).read()
    except ValidationError as error:
        first = error.errors()[0]
        message = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        raise StructureError(message, location=Location(file, line_of(thing))) from error
    project.dialect = Dialect.CODESYS
    return ReadResult(project, ctx.diagnostics)


class _Reader:
    def __init__(self, ctx: Tc6ReadContext, thing: etree._Element, file: str | None) -> None:
        self._ctx = ctx
        self._thing = thing
        self._file = file

    def read(self) -> Project:
        thing = self._thing
        if thing.tag == TASK:
            return read_task(thing)
        declaration = _declaration(thing)
        if declaration is None:
            raise self._refused("has no declaration")
        project = self._declared(thing, declaration)
        if thing.tag != "POU":
            self._name(project)
            return project
        if len(project.pous) != 1:
            raise self._refused("does not declare one POU")
        pou = project.pous[0]
        self._fill(pou)
        return project

    def _refused(self, what: str) -> FormatError:
        name = self._thing.get("Name", "")
        place = Location(self._file, line_of(self._thing))
        return StructureError(f"the {self._thing.tag} {name} {what}", location=place)

    def _declared(self, thing: etree._Element, declaration: str) -> Project:
        """Return what an object declares, its methods too: one reading of all takes a third of the time."""
        holders = [thing, *thing.iterfind("Method")]
        texts = [declaration, *(_declaration(each) or "" for each in holders[1:])]
        unit = unit_of(declaration)
        methods = "".join(f"\n{text}\nEND_METHOD" for text in texts[1:])
        found = read(unit.around(f"{declaration}{methods}"), self._file)
        if thing.tag == "POU" and [len(pou.methods) for pou in found.project.pous] != [len(holders) - 1]:
            # one that is damaged takes its neighbours along
            return self._declared_apart(thing, declaration)
        lines = [text.count("\n") + 1 for text in texts]
        starts = [1, *(1 + lines[0] + sum(count + 1 for count in lines[1:i]) for i in range(1, len(lines)))]
        for each in found.diagnostics:
            line = each.location.line or 1
            number = max((i for i, start in enumerate(starts) if start <= line), default=0)
            self._report(each, holders[number], line - starts[number])
        return found.project

    def _declared_apart(self, thing: etree._Element, declaration: str) -> Project:
        found = read(unit_of(declaration).around(declaration), self._file)
        for each in found.diagnostics:
            self._report(each, thing, (each.location.line or 1) - 1)
        for element in thing.iterfind("Method"):
            method = read(METHOD.around(_declaration(element) or ""), self._file)
            for each in method.diagnostics:
                self._report(each, element, (each.location.line or 1) - 2)
            declared = method.project.pous[0].methods[:1] if method.project.pous else []
            for pou in found.project.pous:
                pou.methods += declared or [Method(name=element.get("Name", ""))]
        return found.project

    def _report(self, found: Diagnostic, thing: etree._Element, line: int) -> None:
        """Report what was found in a declaration, so many lines below its first."""
        holder = thing.find("Declaration")
        start = line_of(holder) if holder is not None else None
        place = Location(self._file, start + line if start is not None else None, None, found.location.path)
        self._ctx.diagnostics.append(Diagnostic(found.code, found.severity, found.message, place))

    def _name(self, project: Project) -> None:
        """Give types and lists of variables the name and the identity of their object."""
        guid = _identity_of(self._thing)
        for declared in project.data_types[:1]:
            declared.object_id = guid
        for section in project.global_variables:
            section.name = self._thing.get("Name", "")
            section.object_id = guid

    def _fill(self, pou: Pou) -> None:
        thing, ctx = self._thing, self._ctx
        ctx.place = [f"POU {pou.name}"]
        pou.object_id = _identity_of(thing)
        names = frozenset(str(each.get("Name", "")).casefold() for each in thing.iterfind("Transition"))
        body = self._body(thing, names)
        pou.bodies = [body] if body is not None else []
        methods = iter(pou.methods)
        for child in thing:
            if child.tag == "Method":
                self._part(next(methods), child, names)
            elif child.tag == "Action":
                pou.actions.append(Action(name=child.get("Name", "")))
                self._part(pou.actions[-1], child, names)
            elif child.tag == "Transition":
                pou.transitions.append(NamedTransition(name=child.get("Name", "")))
                self._part(pou.transitions[-1], child, names)
            elif child.tag == "Property":
                _carry(pou).data.append(_property(child))
        others = [child for child in thing if isinstance(child.tag, str) and child.tag not in _OWN_ELEMENTS]
        _keep(pou, dict(set(_attributes(thing).items()) - {_NOT_SPECIAL}), others)
        ctx.place = []

    def _part(self, part: _Part, element: etree._Element, names: frozenset[str]) -> None:
        self._ctx.place.append(f"{_PART_NAMES[type(part)]} {part.name}")
        part.object_id = _identity_of(element)
        _keep(part, _attributes(element))
        part.body = self._body(element, names)
        self._ctx.place.pop()

    def _body(self, owner: etree._Element, names: frozenset[str]) -> Body | None:
        held = owner.find("Implementation")
        body = next((child for child in held if isinstance(child.tag, str)), None) if held is not None else None
        if body is None:
            return None
        if body.tag == "ST" and not len(body):
            return StBody(text=body.text or "")
        archive = body.find("XmlArchive")
        chart = archived(archive) if archive is not None else None
        if body.tag == "SFC" and archive is not None and chart is not None:
            wrong = unknown_type(archive)
            if wrong is not None:
                self._ctx.error("TWC103", f"the type {wrong.get('n')} is another one than in any known file", wrong)
            fields = ChartReader(self._ctx, names).read(chart)
            settings = owner.find("ObjectProperties/XmlArchive")
            found = archived(settings) if settings is not None else None
            stated = read_settings(self._ctx, found) if found is not None else None
            network = SfcNetwork.model_validate(fields)
            if stated is not None:
                network.settings = SfcSettings.model_validate(stated)
            return SfcBody(chart=network)
        self._ctx.warn("TWC104", f"a body in {body.tag} is kept as it is, and not understood", body)
        return OpaqueBody(source="twincat", content=markup(body))


_OWN_ELEMENTS = frozenset(
    {"Declaration", "Implementation", "ObjectProperties", "LineIds", "Action", "Method", "Transition", "Property"}
)


def _declaration(element: etree._Element) -> str | None:
    found = element.find("Declaration")
    return (found.text or "") if found is not None else None


def _identity_of(element: etree._Element) -> str | None:
    found = element.get("Id")
    return str(found).strip("{}") if found is not None else None


def _attributes(element: etree._Element) -> dict[str, str]:
    """Return the attributes of an element but for its name and its identity."""
    return {str(name): str(value) for name, value in element.attrib.items() if name not in ("Name", "Id")}


def _carry(thing: Element) -> Carried:
    thing.carried = thing.carried or Carried()
    return thing.carried


def _keep(thing: Element, attributes: dict[str, str], elements: Iterable[etree._Element] = ()) -> None:
    """Keep what is nothing in the model."""
    data = kept_data(attributes, [copy.deepcopy(each) for each in elements])
    if data:
        _carry(thing).data += data


def _property(element: etree._Element) -> ForeignData:
    """Return a property as the text that is kept of one."""
    lines = [_declaration(element) or f"PROPERTY {element.get('Name')}"]
    for access in element:
        if access.tag in ("Get", "Set"):
            body = access.findtext("Implementation/ST") or ""
            lines += [str(access.tag).upper(), _declaration(access) or "", body, f"END_{str(access.tag).upper()}"]
    text = "\n".join([*(line.strip() for line in lines if line.strip()), "END_PROPERTY"])
    return ForeignData.model_validate(wrapped(PROPERTY, text))


# -- writing ----------------------------------------------------------------------------------------------------------


def write_object(project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
    """Return the tree of a file. Raises `ModelError` where the project is more, or less, than one object."""
    lists = list(dict.fromkeys(section.name or "" for section in project.global_variables))
    tasks = [task for resource in project.applications for task in resource.tasks]
    count = len(project.pous) + len(project.data_types) + len(lists) + len(tasks)
    if count != 1 or project.data_blocks or project.tag_tables:
        raise ModelError(
            f"a file of TwinCAT holds one POU, type, list of variables or task; the project has {count} of them",
            hint="Save it into a folder: each object gets its file there.",
        )
    root = etree.Element(ROOT)
    source = _source_of(options)
    patched = source.getparent() if source is not None else None
    for name, value in {"Version": _FILE_VERSION, **(_attributes(patched) if patched is not None else {})}.items():
        root.set(name, value)
    if project.pous:
        root.append(_PouWriter(project.pous[0], report, source).write())
    elif tasks:
        known = _identity_of(source) if source is not None else None
        root.append(write_task(tasks[0], _identity(known, tasks[0].name)))
        report.add(Outcome.KEPT, "task", f"task {tasks[0].name}")
    else:
        root.append(_declared_object(project, source))
        report.add(Outcome.KEPT, "data type" if project.data_types else "global variables", _path_of(project))
    return root


def _source_of(options: WriteOptions) -> etree._Element | None:
    """Return the object in the file that is patched."""
    if not (options.same and options.source):
        return None
    return next((child for child in parse_xml(options.source) if child.tag in _KINDS), None)


def _declared_object(project: Project, source: etree._Element | None) -> etree._Element:
    """Return a type or a list of variables."""
    declared = project.data_types[0] if project.data_types else None
    name = declared.name if declared is not None else project.global_variables[0].name or ""
    known = declared.object_id if declared is not None else project.global_variables[0].object_id
    text = declaration_of(_only_declared(project), _declaration(source) if source is not None else None)
    written = etree.Element("DUT" if declared is not None else "GVL", Name=name, Id=_identity(known, name))
    _add_code(written, "Declaration", text)
    return written


def _only_declared(project: Project) -> Project:
    """Return a project with nothing but its types and global variables, which say no identity."""
    types = [each.model_copy(update={"object_id": None}) for each in project.data_types]
    lists = [each.model_copy(update={"object_id": None, "name": None}) for each in project.global_variables]
    return Project(data_types=types, global_variables=lists, dialect=Dialect.CODESYS)


def _path_of(project: Project) -> str:
    if project.data_types:
        return project.data_types[0].report_path
    return f"global variables {project.global_variables[0].name}"


def _identity(known: str | None, *names: str) -> str:
    """Return the identity of an object: a new one follows from its name, so that it is the same in every run."""
    return f"{{{known or uuid5(NAMESPACE_URL, '/'.join(('twincat', *names)))}}}"


def _add_code(parent: etree._Element, name: str, text: str) -> None:
    child = etree.SubElement(parent, name)
    # text that ends such a section cannot stand in one
    child.text = etree.CDATA(text) if "]]>" not in text else text


class _PouWriter:
    def __init__(self, pou: Pou, report: ConversionReport, source: etree._Element | None) -> None:
        self._pou = pou
        self._report = report
        self._source = source
        children = list(source) if source is not None else []
        self._parts = {(str(child.tag), child.get("Name")): child for child in children if child.get("Name")}

    def write(self) -> etree._Element:
        """Return ``POU``."""
        pou = self._pou
        self._report.add(Outcome.KEPT, "POU", pou.report_path)
        known = kept_in(pou.carried)
        written = etree.Element("POU", Name=pou.name, Id=_identity(pou.object_id, pou.name))
        for name, value in {**dict([_NOT_SPECIAL]), **known.attributes}.items():
            written.set(name, value)
        self._declaration(written, pou, self._source)
        self._body(written, pou.body, pou.name, self._source)
        written.extend(known.elements)
        found: list[_Part] = [*pou.actions, *pou.methods, *pou.transitions]
        parts = [self._part(part) for part in found]
        place = {key: number for number, key in enumerate(self._parts)}
        written.extend(sorted(parts, key=lambda part: place.get((str(part.tag), part.get("Name")), len(place))))
        self._settings(written, pou.body)
        if len(pou.bodies) > 1:
            self._report.add(Outcome.NOT_EXECUTED, "body", pou.report_path, "a POU of TwinCAT has one body")
        self._report_properties()
        return written

    def _declaration(self, written: etree._Element, thing: Pou | Method, source: etree._Element | None) -> None:
        text = _declaration(source) if source is not None else None
        _add_code(written, "Declaration", declaration_of(bare(thing), text))

    def _part(self, part: _Part) -> etree._Element:
        tag = type(part).__name__.removeprefix("Named")
        what = _PART_NAMES[type(part)]
        source = self._parts.get((tag, part.name))
        written = etree.Element(tag, Name=part.name, Id=_identity(part.object_id, self._pou.name, part.name))
        for name, value in kept_in(part.carried).attributes.items():
            written.set(name, value)
        path = f"{self._pou.report_path} / {what} {part.name}"
        self._report.add(Outcome.KEPT, what, path)
        if isinstance(part, Method):
            self._declaration(written, part, source)
        self._body(written, part.body, f"{self._pou.name}.{part.name}", source, part)
        self._settings(written, part.body)
        return written

    def _body(
        self,
        owner: etree._Element,
        body: Body | None,
        name: str,
        source: etree._Element | None,
        part: _Part | None = None,
    ) -> None:
        held = etree.SubElement(owner, "Implementation")
        path = self._pou.report_path_of(name)
        match body:
            case None:
                if part is None:
                    _add_code(held, "ST", "")
            case StBody(text=text):
                _add_code(held, "ST", text)
            case SfcBody(chart=chart):
                old = source.find("Implementation/SFC/XmlArchive") if source is not None else None

                def note(outcome: Outcome, what: str, place: str, why: str) -> None:
                    self._report.add(outcome, what, f"{path} / {place}" if place else path, why)

                etree.SubElement(held, "SFC").append(ChartWriter(chart, old, note).write())
            case OpaqueBody(source="twincat", content=content):
                add_markup(held, content)
            case _:
                self._drawn_body(held, body, path, part)

    def _drawn_body(self, held: etree._Element, body: Body, path: str, part: _Part | None) -> None:
        """Write a body that is drawn as the structured text that does the same."""
        text: str | None = None
        if isinstance(body, FbdBody | LdBody) and isinstance(part, NamedTransition):
            shown = shown_named_condition(part, Dialect.CODESYS)
            text = shown[0] if shown is not None and not shown[1] else None
        elif isinstance(body, FbdBody | LdBody):
            text = shown_body(body, Dialect.CODESYS)
        if text is None:
            why = f"a body in {body.language} cannot be written, and is not executed"
            self._report.add(Outcome.NOT_EXECUTED, "body", path, why)
            text = "body_is_not_written := TRUE;"
        else:
            self._report.add(Outcome.TRANSLATED, "body", path, f"from {body.language} into structured text")
        _add_code(held, "ST", text)

    def _settings(self, owner: etree._Element, body: Body | None) -> None:
        if isinstance(body, SfcBody) and body.chart.settings is not None:
            etree.SubElement(owner, "ObjectProperties").append(write_settings(body.chart.settings))

    def _report_properties(self) -> None:
        """Properties stay in the file that is patched as they are; elsewhere they are not written."""
        stay = self._source.iterfind("Property") if self._source is not None else ()
        if list(_properties(self._pou)) != [unwrapped(_property(each).content) for each in stay]:
            why = "properties are not written: those of a file stay in it as they are"
            self._report.add(Outcome.NOT_EXECUTED, PROPERTY, self._pou.report_path, why)


def _properties(pou: Pou) -> Iterator[tuple[str, str]]:
    for data in pou.carried.data if pou.carried is not None else ():
        kept = unwrapped(data.content)
        if kept is not None and kept[0] == PROPERTY:
            yield kept
