"""POUs, types and lists of variables as elements: ``POU``, ``DUT``, ``GVL``, ``Itf``, read and written.

The declaration is text, the body text or an archive. Actions, methods and transition objects are elements of their POU.
Files of TwinCAT 3 hold such elements. Exports of CODESYS V3 hold the same in another form, of which their codec makes
such elements. ``LineIds``, which the tool counts itself, stay in the file and are nothing in the model.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Set
from itertools import chain
from typing import TypeAlias

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.errors import FormatError, Location, StructureError
from plcopen_sfc.formats.archives.archived_charts import ChartReader, ChartWriter, read_settings, write_settings
from plcopen_sfc.formats.archives.object_archive import (
    archived,
    has_types,
    kept_data,
    kept_in,
    unknown_type,
    unlisted_type,
)
from plcopen_sfc.formats.archives.object_identities import add_code, identity, identity_of
from plcopen_sfc.formats.archives.property_elements import (
    edited_property,
    kept_property,
    name_of_property,
    written_property,
)
from plcopen_sfc.formats.iectext.object_declarations import METHOD, PROPERTY, bare, declaration_of, read, unit_of
from plcopen_sfc.formats.plcopen.tc6_reading import Tc6ReadContext
from plcopen_sfc.formats.xml.extension_data import add_markup, markup
from plcopen_sfc.formats.xml.xml_parsing import line_of
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.declarations.kept_texts import texts_from
from plcopen_sfc.languages.networks.condition_reading import shown_body, shown_named_condition
from plcopen_sfc.languages.networks.exported_networks import SOURCES, network_statements
from plcopen_sfc.model.base import Element, ExtensionData
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.chart_settings import SfcSettings
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Method, NamedTransition, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork
from plcopen_sfc.report import Cause, CauseKind, ConversionReport, Outcome

KINDS = ("POU", "GVL", "DUT", "Itf")
"""The elements that are objects."""
_Part: TypeAlias = Action | Method | NamedTransition
_PART_NAMES = {Action: "action", Method: "method", NamedTransition: "transition"}
_NOT_SPECIAL = ("SpecialFunc", "None")


def _tag_of(part: _Part) -> str:
    return type(part).__name__.removeprefix("Named")


# -- reading ----------------------------------------------------------------------------------------------------------


LineAt: TypeAlias = Callable[[etree._Element, int], int | None]
"""Returns the line of the file in which a line of the declaration of an object is, counted from 0."""


def line_below(thing: etree._Element, line: int) -> int | None:
    """Return the line of a line of the declaration where that is one text: see `LineAt`."""
    holder = thing.find("Declaration")
    start = line_of(holder) if holder is not None else None
    return start + line if start is not None else None


def read_element(
    ctx: Tc6ReadContext,
    thing: etree._Element,
    file: str | None,
    *,
    source: str = "twincat",
    line_at: LineAt = line_below,
) -> Project:
    """Return a project with nothing but the object that an element is; `source` is the format that it is of.

    Raises `StructureError`.
    """
    return _Reader(ctx, thing, file, source, line_at).read()


class _Reader:
    def __init__(
        self, ctx: Tc6ReadContext, thing: etree._Element, file: str | None, source: str, line_at: LineAt
    ) -> None:
        self._ctx = ctx
        self._thing = thing
        self._file = file
        self._source = source
        self._line_at = line_at

    def read(self) -> Project:
        thing = self._thing
        declaration = declaration_in(thing)
        if declaration is None:
            raise self._refused("has no declaration")
        project = self._declared(thing, declaration)
        if thing.tag != "POU":
            if thing.tag == "GVL" and not thing.get("Name"):
                self._ctx.error("TWC108", "a list of global variables has no name", thing)
            self._name(project)
            return project
        if len(project.pous) != 1:
            raise self._refused("does not declare one POU")
        pou = project.pous[0]
        self._compare_names(pou.name, thing)
        self._fill(pou)
        return project

    def _compare_names(self, declared: str, element: etree._Element) -> None:
        """Report an object that has another name than its declaration, which is the one that other code uses."""
        name = element.get("Name", "")
        if name and name.casefold() != declared.casefold():
            self._ctx.warn("TWC107", f"the {element.tag} {name} declares {declared}, which is its name here", element)

    def _refused(self, what: str) -> FormatError:
        name = self._thing.get("Name", "")
        place = Location(self._file, line_of(self._thing))
        return StructureError(f"the {self._thing.tag} {name} {what}", location=place)

    def _declared(self, thing: etree._Element, declaration: str) -> Project:
        """Return the declarations of an object, its methods too: one reading of all takes a third of the time."""
        holders = [thing, *thing.iterfind("Method")]
        texts = [declaration, *(declaration_in(each) or "" for each in holders[1:])]
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
            method = read(METHOD.around(declaration_in(element) or ""), self._file)
            for each in method.diagnostics:
                self._report(each, element, (each.location.line or 1) - 2)
            declared = method.project.pous[0].methods[:1] if method.project.pous else []
            for pou in found.project.pous:
                pou.methods += declared or [Method(name=element.get("Name", ""))]
        return found.project

    def _report(self, found: Diagnostic, thing: etree._Element, line: int) -> None:
        """Report the findings in a declaration, so many lines below its first."""
        place = Location(self._file, self._line_at(thing, line), None, found.location.path)
        self._ctx.diagnostics.append(Diagnostic(found.code, found.severity, found.message, place))

    def _name(self, project: Project) -> None:
        """Give types and lists of variables the name and the identity of their object."""
        guid = identity_of(self._thing)
        for declared in project.data_types[:1]:
            declared.object_id = guid
            self._compare_names(declared.name, self._thing)
        for section in project.global_variables:
            section.name = self._thing.get("Name", "")
            section.object_id = guid

    def _fill(self, pou: Pou) -> None:
        thing, ctx = self._thing, self._ctx
        ctx.place = [f"POU {pou.name}"]
        pou.object_id = identity_of(thing)
        names = frozenset(str(each.get("Name", "")).casefold() for each in thing.iterfind("Transition"))
        body = self._body(thing, names)
        pou.bodies = [body] if body is not None else []
        methods = iter(pou.methods)
        for child in thing:
            if child.tag == "Method":
                method = next(methods)
                self._compare_names(method.name, child)
                self._part(method, child, names)
            elif child.tag == "Action":
                pou.actions.append(Action(name=child.get("Name", "")))
                self._part(pou.actions[-1], child, names)
            elif child.tag == "Transition":
                pou.transitions.append(NamedTransition(name=child.get("Name", "")))
                self._part(pou.transitions[-1], child, names)
            elif child.tag == "Property":
                self._check_accessors(child)
                _keep_data(pou).data.append(kept_property(child))
        for first, *others in grouped((identity_of(each), each) for each in (thing, *thing) if each.get("Id")).values():
            for each in others:
                ctx.warn("TWC105", f"{_called(each)} has the Id of {_called(first)}", each)
        named = [child for child in thing if child.tag in _PARTS]
        for child in named:
            if not child.get("Name"):
                ctx.error("TWC108", f"a part of the kind {child.tag} has no name", child)
        for first, *others in grouped((each.get("Name", "").casefold(), each) for each in named).values():
            for each in others:
                ctx.error("TWC109", f"{_called(each)} has the name of {_called(first)}", each)
        others = [child for child in thing if isinstance(child.tag, str) and child.tag not in _OWN_ELEMENTS]
        _keep(pou, dict(set(attributes_of(thing).items()) - {_NOT_SPECIAL}), others)
        ctx.place = []

    def _part(self, part: _Part, element: etree._Element, names: frozenset[str]) -> None:
        self._ctx.place.append(f"{_PART_NAMES[type(part)]} {part.name}")
        part.object_id = identity_of(element)
        _keep(part, attributes_of(element))
        part.body = self._body(element, names)
        self._ctx.place.pop()

    def _check_accessors(self, element: etree._Element) -> None:
        """Report accessors of a property whose code is no part of its text."""
        for access in element.iterchildren("Get", "Set"):
            if access.find("Implementation/ST") is None:
                name = f"{element.get('Name', '')}.{access.tag}"
                self._ctx.error("TWC108", f"the accessor {name} has no body in structured text", access)

    def _check_sections(self, owner: etree._Element) -> None:
        """Report sections of an object that are there twice."""
        for tag in ("Declaration", "Implementation", "ObjectProperties"):
            for other in owner.findall(tag)[1:]:
                self._ctx.error("TWC102", f"a second {tag} of {_called(owner)}, which is not read", other)

    def _body(self, owner: etree._Element, names: frozenset[str]) -> Body | None:
        self._check_sections(owner)
        held = owner.find("Implementation")
        bodies = [child for child in held if isinstance(child.tag, str)] if held is not None else []
        if not bodies:
            self._ctx.error("TWC108", f"{_called(owner)} has no body (Implementation)", owner)
            return None
        body, *others = bodies
        for other in others:
            self._ctx.error("TWC102", f"a second body in {other.tag}, which is not read", other)
        if body.tag == "ST" and not len(body):
            return StBody(text=body.text or "")
        archive = body.find("XmlArchive")
        chart = archived(archive) if archive is not None else None
        if body.tag == "SFC" and archive is not None and chart is not None:
            wrong = unknown_type(archive)
            if wrong is not None:
                self._ctx.error("TWC103", f"the type {wrong.get('n')} is another one than in any known file", wrong)
            unlisted = unlisted_type(archive)
            if not has_types(archive) and self._source == "twincat":
                self._ctx.error("TWC103", "the archive of the chart has no list of types (TypeList)", archive)
            elif unlisted:
                self._ctx.error("TWC103", f"the list of types lacks {unlisted}, which the archive uses", archive)
            fields = ChartReader(self._ctx, names).read(chart)
            properties = owner.find("ObjectProperties")
            settings = properties.find("XmlArchive") if properties is not None else None
            found = archived(settings) if settings is not None else None
            if properties is not None and found is None:
                self._ctx.error("TWC102", "the properties of a chart are no archive with an object", properties)
            for other in properties if properties is not None else ():
                if isinstance(other.tag, str) and other is not settings:
                    self._ctx.error("TWC102", f"{other.tag} in the properties of a chart is not understood", other)
            if len(archive.findall("Data/o")) > 1:
                self._ctx.error("TWC102", "a second object in the archive of a chart, which is not read", archive)
            stated = read_settings(self._ctx, found) if found is not None else None
            network = SfcNetwork.model_validate(fields)
            if stated is not None:
                network.settings = SfcSettings.model_validate(stated)
            return SfcBody(chart=network)
        kept = OpaqueBody(source=self._source, content=markup(body))
        if body.tag == "SFC":
            self._ctx.error("TWC101", "the archive of the chart has no objects (Data): nothing of it is read", body)
        elif kept.source not in SOURCES or network_statements(kept.content) is None:
            self._ctx.warn("TWC104", f"a body in {body.tag} is kept as it is, and not understood", body)
        return kept


_PARTS = frozenset({"Action", "Method", "Transition", "Property"})
_OWN_ELEMENTS = _PARTS | {"Declaration", "Implementation", "ObjectProperties", "LineIds"}


def _called(thing: etree._Element) -> str:
    """Return what an object is called in messages."""
    return f"the {thing.tag} {thing.get('Name', '')}"


def declaration_in(element: etree._Element) -> str | None:
    """Return the text with which an object is declared."""
    found = element.find("Declaration")
    return (found.text or "") if found is not None else None


def attributes_of(element: etree._Element) -> dict[str, str]:
    """Return the attributes of an element but for its name and its identity."""
    return {str(name): str(value) for name, value in element.attrib.items() if name not in ("Name", "Id")}


def _keep_data(thing: Element) -> ExtensionData:
    thing.extension_data = thing.extension_data or ExtensionData()
    return thing.extension_data


def _keep(thing: Element, attributes: dict[str, str], elements: Iterable[etree._Element] = ()) -> None:
    """Keep what is nothing in the model."""
    data = kept_data(attributes, [copy.deepcopy(each) for each in elements])
    if data:
        _keep_data(thing).data += data


# -- writing ----------------------------------------------------------------------------------------------------------


def write_declared(project: Project, source: etree._Element | None, *, taken: Set[str] = frozenset()) -> etree._Element:
    """Return the type or the list of variables that a project has alone; `taken` as for `write_pou`."""
    declared = project.data_types[0] if project.data_types else None
    name = declared.name if declared is not None else project.global_variables[0].name or ""
    known = declared.object_id if declared is not None else project.global_variables[0].object_id
    text = declaration_of(_only_declared(project), declaration_in(source) if source is not None else None)
    kind = "DUT" if declared is not None else "GVL"
    written = etree.Element(
        kind, Name=name, Id=identity(known, kind, name, taken=taken)
    )  # a POU may have the name, too
    add_code(written, "Declaration", text)
    return written


def _only_declared(project: Project) -> Project:
    """Return a project with nothing but its types and global variables, which say no identity."""
    types = [each.model_copy(update={"object_id": None}) for each in project.data_types]
    lists = [each.model_copy(update={"object_id": None, "name": None}) for each in project.global_variables]
    return Project(data_types=types, global_variables=lists, dialect=Dialect.CODESYS)


def take_out_others(project: Project) -> None:
    """Take out of `project` all but its POUs, types and lists of global variables, which are in one place then."""
    project.global_variables = list(project.global_sections())
    for section in project.global_variables:
        section.name = section.name or "GVL"
    plain = Project(dialect=Dialect.CODESYS)
    for name in Project.model_fields:
        if name not in ("pous", "data_types", "global_variables"):
            setattr(project, name, getattr(plain, name))


def path_of(project: Project) -> str:
    """Return the path in reports of a type or a list of variables."""
    if project.data_types:
        return project.data_types[0].report_path
    return f"global variables {project.global_variables[0].name}"


def identities_in(pou: Pou) -> set[str]:
    """Return the identities that a POU and its parts have."""
    return {each.object_id for each in (pou, *pou.parts) if each.object_id is not None}


def write_pou(
    pou: Pou,
    report: ConversionReport,
    source: etree._Element | None,
    *,
    format: str = "twincat",
    taken: Set[str] = frozenset(),
) -> etree._Element:
    """Return ``POU``; `source` is the element in the file that is patched, `format` that of the file.

    `taken` are identities of other objects in the file.
    """
    return _PouWriter(pou, report, source, format, taken).write()


class _PouWriter:
    def __init__(
        self, pou: Pou, report: ConversionReport, source: etree._Element | None, format: str, taken: Set[str]
    ) -> None:
        self._pou = pou
        self._taken = taken | identities_in(pou)
        self._report = report
        self._source = source
        self._format = format
        children = list(source) if source is not None else []
        self._children = [each for each in children if each.get("Name")]

    def write(self) -> etree._Element:
        pou = self._pou
        self._report.add(Outcome.KEPT, "POU", pou.report_path)
        known = kept_in(pou.extension_data)
        written = etree.Element("POU", Name=pou.name, Id=identity(pou.object_id, pou.name, taken=self._taken))
        for name, value in {**dict([_NOT_SPECIAL]), **known.attributes}.items():
            written.set(name, value)
        self._declaration(written, pou, self._source)
        self._body(written, pou.body, pou.name, self._source)
        written.extend(known.elements)
        found: list[_Part] = [*pou.actions, *pou.methods, *pou.transitions]
        placed: list[tuple[int, etree._Element]] = []
        for part in found:
            source = self._source_of(part)
            place = self._children.index(source) if source is not None else len(self._children)
            placed.append((place, self._part(part, source)))
        placed += self._properties()
        written.extend(element for _, element in sorted(placed, key=lambda each: each[0]))
        self._settings(written, pou.body)
        return written

    def _declaration(self, written: etree._Element, thing: Pou | Method, source: etree._Element | None) -> None:
        text = declaration_in(source) if source is not None else None
        add_code(written, "Declaration", declaration_of(bare(thing), text))

    def _source_of(self, part: _Part) -> etree._Element | None:
        """Return the element of a part in the file: by its id, which a rename leaves, or by its name."""
        alike = [each for each in self._children if each.tag == _tag_of(part)]
        named = (each for each in alike if each.get("Name", "").casefold() == part.name.casefold())
        own = (each for each in alike if part.object_id is not None and identity_of(each) == part.object_id)
        return next(chain(own, named), None)

    def _part(self, part: _Part, source: etree._Element | None) -> etree._Element:
        tag, what = _tag_of(part), _PART_NAMES[type(part)]
        name = part.name
        # a declaration may write the name of a method in another case than its object
        if source is not None and source.get("Name", "").casefold() == name.casefold():
            name = source.get("Name", "")
        written = etree.Element(
            tag, Name=name, Id=identity(part.object_id, self._pou.name, part.name, taken=self._taken)
        )
        for name, value in kept_in(part.extension_data).attributes.items():
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
                add_code(held, "ST", "")
            case StBody(text=text):
                add_code(held, "ST", text)
            case SfcBody(chart=chart):
                old = source.find("Implementation/SFC/XmlArchive") if source is not None else None

                def note(outcome: Outcome, what: str, place: str, why: str) -> None:
                    self._report.add(outcome, what, f"{path} / {place}" if place else path, why)

                etree.SubElement(held, "SFC").append(ChartWriter(chart, old, note).write())
            case OpaqueBody(source=kept, content=content) if kept == self._format:
                add_markup(held, content)
            case _:
                self._drawn_body(held, body, path, part)

    def _drawn_body(self, held: etree._Element, body: Body, path: str, part: _Part | None) -> None:
        """Write a body that is drawn, or a condition in IL, as the structured text that does the same."""
        text: str | None = None
        if isinstance(body, FbdBody | LdBody | IlBody) and isinstance(part, NamedTransition):
            shown = shown_named_condition(part, Dialect.CODESYS)
            text = shown[0] if shown is not None and not shown[1] else None
        elif isinstance(body, FbdBody | LdBody):
            text = shown_body(body, Dialect.CODESYS)
        if text is None:
            name = "body_is_not_written"
            instead = f"the undeclared name {name} is in its place"
            why = f"a body in {body.language} cannot be written, and is not executed: {instead}"
            self._report.add(Outcome.NOT_EXECUTED, "body", path, why, Cause(CauseKind.PLACEHOLDER, name))
            text = name if isinstance(part, NamedTransition) else f"{name} := TRUE;"
        else:
            self._report.add(Outcome.TRANSLATED, "body", path, f"from {body.language} into structured text")
        add_code(held, "ST", text)

    def _settings(self, owner: etree._Element, body: Body | None) -> None:
        if isinstance(body, SfcBody) and body.chart.settings is not None:
            etree.SubElement(owner, "ObjectProperties").append(write_settings(body.chart.settings))

    def _properties(self) -> list[tuple[int, etree._Element]]:
        """Return the properties: those of the file that is patched with other names in them, and new ones."""
        stay = [*self._source.iterfind("Property")] if self._source is not None else []
        texts = [*texts_from(PROPERTY, self._pou.extension_data)]
        sources: list[etree._Element | None] = [*stay]
        if len(texts) != len(stay):  # else one that has no source of its name was renamed
            named = {each.get("Name", "").casefold(): each for each in stay}
            sources = [named.get(name_of_property(text).casefold()) for text in texts]
        placed: list[tuple[int, etree._Element]] = []
        for source, text in zip(sources, texts, strict=True):
            made = edited_property(source, text) if source is not None else None
            made = made if made is not None else written_property(self._pou.name, text, source, self._taken)
            if made is None:
                path = f"{self._pou.report_path} / property {name_of_property(text)}"
                self._report.add(Outcome.NOT_EXECUTED, PROPERTY, path, _NO_PROPERTY)
                made = copy.deepcopy(source) if source is not None else None
            elif source is None:
                self._report.add(Outcome.KEPT, PROPERTY, f"{self._pou.report_path} / property {made.get('Name')}")
            place = self._children.index(source) if source is not None else len(self._children)
            placed += [(place, made)] if made is not None else []
        return placed


_NO_PROPERTY = "its text is not GET and SET with their code, so it is not written"
