"""Validation of documents of TIA Portal by the schemas of this package, and the version that a document needs.

A document is validated in parts: its frame, and each part by its namespace. The schemas also decide what a version can
express: content that one of them objects to and a later one accepts needs that later version.

Codes: those of `plcopen_sfc.formats.xml.schema_explanation`, and

======  ==============================================================
XSD001  no document of Openness, or of a version that is not known
XSD031  a part in no namespace, or in one that is not known
XSD032  a part of a schema version that this TIA Portal does not have
======  ==============================================================
"""

from __future__ import annotations

import copy
from dataclasses import replace

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import FormatError, Location, OldVersionError, VersionNeed
from plcopen_sfc.formats.simaticml.document_reader import find_version
from plcopen_sfc.formats.simaticml.graph_reader import ALL_CATEGORIES, USUAL_CATEGORIES
from plcopen_sfc.formats.simaticml.tia_versions import (
    LANGUAGES,
    SCHEMAS,
    VERSIONS,
    TiaVersion,
    namespace,
    schema_of,
    version_named,
)
from plcopen_sfc.formats.xml.schema_validation import MAX_FINDINGS, element_path, schema_faults, schema_findings
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse_xml
from plcopen_sfc.model.chart_settings import AlarmCategory
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.object_path import ObjectPath

_FRAME = "simaticml/document"
_ROOTS = {"Sections": "Interface", **{language: language for language in LANGUAGES}}
_HOLDERS = ("Interface", "NetworkSource")


def validate(data: bytes, *, file: str | None = None) -> list[Diagnostic]:
    """Return findings in a document by the schemas of its parts; empty for a valid one.

    Attributes and objects that are not known are warnings: of the frame of a document there is no published schema, and
    newer versions may write more. A valid document may still be wrong in ways that no schema sees, such as a wire to a
    part that does not exist.

    Raises `XmlSyntaxError`, `EncodingError` or `UnsafeXmlError` for what is not well-formed XML, or not safe to read.
    """
    root = parse_xml(data, file=file)
    try:
        version = find_version(root, file=file)
    except FormatError as error:
        message = error.message if not error.hint else f"{error.message}. {error.hint}"
        return [Diagnostic("XSD001", Severity.ERROR, message, error.location)]
    found = [_lenient(finding) for finding in schema_findings(root, _FRAME, data=data, file=file)]
    lines = SourceLines(root, data)
    for part in (part for holder in root.iter(*_HOLDERS) for part in holder.iterchildren(etree.Element)):
        if len(found) > MAX_FINDINGS:
            break
        name = etree.QName(part)
        known = schema_of(name.namespace or "")
        place = Location(file, lines.line(part), path=element_path(part))
        if known is None or _ROOTS.get(name.localname) != known[0] or known[1] not in SCHEMAS[known[0]]:
            found.append(_unknown(part, version, place))
            continue
        kind, number = known
        if number > version.schema(kind) and _names_its_version(root):
            found.append(_too_new(kind, number, version, place))
        found += schema_findings(part, f"simaticml/{kind}-v{number}", data=data, file=file)
    found.sort(key=lambda finding: (finding.location.line is None, finding.location.line or 0))
    return found


def _names_its_version(root: etree._Element) -> bool:
    engineering = root.find("Engineering")
    return engineering is not None and version_named(engineering.get("version", "")) is not None


def _unknown(part: etree._Element, version: TiaVersion, place: Location) -> Diagnostic:
    """Return a part that has no schema: misspelled, in no namespace, or newer than anything known."""
    name = etree.QName(part)
    kind = _ROOTS.get(name.localname)
    if kind is None:
        message = f"<{name.localname}> in {name.namespace or 'no namespace'} is held against no schema"
        return Diagnostic("XSD031", Severity.INFO, message, place)
    wanted = namespace(kind, version.schema(kind))
    message = f"<{name.localname}> is in {name.namespace or 'no namespace'}; TIA Portal {version.name} has {wanted}"
    return Diagnostic("XSD031", Severity.ERROR, message, place)


def _too_new(kind: str, number: int, version: TiaVersion, place: Location) -> Diagnostic:
    first = next((each for each in VERSIONS if each.schema(kind) >= number), None)
    since = f", which came with {first.name}" if first is not None else ""
    own = version.schema(kind)
    message = f"this is of schema {kind} v{number}{since}; TIA Portal {version.name} has " + (
        f"v{own}" if own else "none"
    )
    return Diagnostic("XSD032", Severity.ERROR, message, place)


def _lenient(finding: Diagnostic) -> Diagnostic:
    """Return a warning for an attribute or object that is not known: other versions than those seen may have it."""
    holder, _, name = (finding.location.path or "").rpartition("/")
    unknown = holder.endswith("/AttributeList") and "[" not in name
    unknown = unknown or (holder.endswith("/ObjectList") and name.partition("[")[0].startswith("SW."))
    return replace(finding, severity=Severity.WARNING) if unknown and finding.code == "XSD002" else finding


_OBJECTS = {
    "SW.Types.PlcStruct": "data type",
    "SW.Tags.PlcTagTable": "tag table",
    "SW.Blocks.GlobalDB": "data block",
    "SW.Blocks.InstanceDB": "data block",
    "SW.Blocks.ArrayDB": "data block",
}
_FEATURES = {
    "StructuredText": "a network in SCL",
    "StatementList": "a network in STL",
    "StepName": "the name of the step in several languages",
    "TransitionName": "the name of the transition in several languages",
    "AssignedProDiagFB": "supervision by ProDiag",
    "Blank": "a blank in the text of an operand",
    "MultiLanguageText": "a text in a language with a script (zh-Hans-CN)",
    "DataType": "a data type as operand",
    "Reference": "a reference as operand",
    "PredefinedVariable": "ENO as operand",
    "Component": "an index or a part of a variable in a network that is kept as it is",
}
_Category = tuple[str, int, int | None, str | None]


def fit_alarms(chart: SfcNetwork, version: TiaVersion) -> None:
    """Add the categories of alarms that `version` wants, and take out those that it lacks, as far as they are usual."""
    settings = chart.graph_settings
    if settings is None or not settings.alarm_categories:
        return
    usual: list[_Category] = list(USUAL_CATEGORIES[version.schema("Graph") >= ALL_CATEGORIES])
    every: dict[str, _Category] = {entry[0]: entry for entry in USUAL_CATEGORIES[True]}
    given: list[_Category] = [(one.name, one.id, one.display_class, one.text) for one in settings.alarm_categories]
    names = {name for name, *_ in usual}
    kept = [entry for entry in given if entry[0] in names or entry != every.get(entry[0])]
    missing = [entry for entry in usual if entry[0] not in {name for name, *_ in given}]
    order = {name: place for place, name in enumerate(every)}
    result = sorted([*kept, *missing], key=lambda entry: order.get(entry[0], len(order)))
    if result == given:
        return
    settings.alarm_categories = [
        AlarmCategory(name=name, id=number, display_class=display, text=text)
        for name, number, display, text in ([] if result == usual else result)
    ]


def refuse_older(root: etree._Element, version: TiaVersion, before: etree._Element | None = None) -> None:
    """Raise `OldVersionError` where a document written for `version` holds what came with a later one.

    `before` is the document before it was edited; newer content that it had already is accepted.
    """
    needs = _needs(root, version)
    if needs and before is not None:
        had = set(_needs(before, version))
        needs = [need for need in needs if need not in had]
    if needs:
        raise OldVersionError(f"TIA Portal {version.name}", needs)


def _needs(root: etree._Element, version: TiaVersion) -> list[VersionNeed]:
    found: dict[VersionNeed, None] = {}
    for holder in root.iter("Interface", "NetworkSource"):
        for part in holder.iterchildren(etree.Element):
            kind = _ROOTS.get(etree.QName(part).localname)
            if kind is None:
                continue
            number = version.schema(kind)
            if number == 0:
                found[_need(part, next(v for v in VERSIONS if v.schema(kind)))] = None
            elif part.tag == f"{{{namespace(kind, number)}}}{etree.QName(part).localname}":
                found |= dict.fromkeys(_needs_of_part(part, kind, version))
    return list(found)


def _needs_of_part(part: etree._Element, kind: str, version: TiaVersion) -> list[VersionNeed]:
    """Content that needs a later version, up to the last schema that objects; the newest objects to plain errors.

    Later ones are asked too because a schema that objects to an element does not look at what follows it.
    """
    needed: dict[tuple[int, ...], TiaVersion | None] = {}
    schemas = {later.schema(kind): later for later in reversed(VERSIONS[_index(version) :])}
    numbers = sorted(schemas)
    for place, number in enumerate(numbers):
        asked = part if number == version.schema(kind) else _in_schema(part, namespace(kind, number))
        wrong = [element for element, _ in schema_faults(asked, f"simaticml/{kind}-v{number}")]
        if not wrong and place == 0:
            return []
        following = schemas[numbers[place + 1]] if place + 1 < len(numbers) else None
        needed |= {_way(asked, element): following for element in wrong}
    return [
        _need(_at(part, way), later)
        for way, later in sorted(needed.items(), key=lambda item: item[0])
        if later is not None
    ]


def _way(top: etree._Element, element: etree._Element) -> tuple[int, ...]:
    """Return the way down from `top` to an element in it."""
    way: list[int] = []
    while element is not top:
        parent = element.getparent()
        if parent is None:
            break
        way.append(parent.index(element))
        element = parent
    return tuple(reversed(way))


def _at(top: etree._Element, way: tuple[int, ...]) -> etree._Element:
    """Return the element at the end of a way."""
    for place in way:
        top = top[place]
    return top


def _index(version: TiaVersion) -> int:
    """Return the place of a version among those that are known."""
    return VERSIONS.index(version) if version in VERSIONS else len(VERSIONS) - 1


def _in_schema(part: etree._Element, uri: str) -> etree._Element:
    """Return a copy of a part in another namespace."""
    copied = copy.deepcopy(part)
    own = etree.QName(part).namespace
    for element in copied.iter(etree.Element):
        name = etree.QName(element)
        if name.namespace == own:
            element.tag = f"{{{uri}}}{name.localname}"
    return copied


def _need(element: etree._Element, version: TiaVersion) -> VersionNeed:
    name = etree.QName(element).localname
    feature = _FEATURES.get(name, f"<{name}>")
    if name in {"Access", "Instance", "Symbol"}:
        feature = f"an operand of the scope {element.get('Scope', '')}"
    elif name.startswith("Alarm"):
        feature = "categories of alarms other than the usual ones"
    elif name == "Comment" and etree.QName(element.getparent()).localname == "LineComment":
        feature = "a comment in program text in several languages"
    return VersionNeed(_path(element), feature, f"TIA Portal {version.name}")


def _path(element: etree._Element) -> str:
    """Return the path of the model object that an element belongs to."""
    names: list[str] = []
    for node in (element, *element.iterancestors()):
        local = etree.QName(node).localname
        if local in {"Step", "Transition", "Member"}:
            kind = {"Step": "step", "Transition": "transition", "Member": "variable"}[local]
            names.append(f"{kind} {node.get('Name', '')}")
        elif local == "SW.Blocks.CompileUnit" and not element.xpath("ancestor-or-self::*[local-name() = 'Graph']"):
            number = 1 + sum(1 for _ in node.itersiblings(node.tag, preceding=True))
            names.append(f"network {number}")
        elif local.startswith("SW.") and local != "SW.Blocks.CompileUnit":
            names.append(f"{_OBJECTS.get(local, 'POU')} {node.findtext('AttributeList/Name', '')}")
    return ObjectPath(*reversed(names))
