"""Declarations as text beside elements: what was edited in the elements is edited in the text.

CODESYS and TwinCAT compile the text, with its comments and pragmas, where a file has one. Variables are compared with
those that were read: only what differs is changed, so that the rest stays as it was typed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.iectext.object_declarations import METHOD, declaration_of, read, unit_of
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.declarations import write_type, write_value
from plcopen_sfc.model import types as t
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Method, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.variables import Interface, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

Declared = Interface | t.DataTypeDeclaration | VariableSection
"""What has a declaration as text."""

_SECTION = ("kind", "constant", "retain", "nonretain", "persistent", "nonpersistent")
_MERGED = ("type", "address", "initial", "comment")


class _UnfitError(Exception):
    """An edit that cannot be put into the text."""


def declaration_texts(project: Project, baseline: Project, report: ConversionReport) -> dict[int, str | None]:
    """Return the texts that are to be written instead of those in `project`, by the `id()` of what they declare.

    `baseline` is the project as it was read. None for a text into which an edit does not go: it is in the report.
    """
    # a list of global variables may have several sections, and its text at the first
    before, after = grouped(_declared(baseline)), grouped(_declared(project))
    gone, new = ([path for path in one if path not in other] for one, other in ((before, after), (after, before)))
    if len(gone) == len(new):  # renamed
        before |= {path: before[was] for was, path in zip(gone, new, strict=True)}
    texts: dict[int, str | None] = {}
    for path, things in after.items():
        text, old = things[0].declaration, before.get(path, [])
        same = [*map(_content, things)] == [*map(_content, old)]
        if text is None or (same and old[0].declaration == text):
            continue
        try:
            found = _edited(text, things, old)
        except _UnfitError:
            found = None
            why = "it no longer fits what is declared; the tool builds it again, without pragmas and comments between"
            report.add(Outcome.APPROXIMATED, "declaration text", path, why)
        if found != text:
            texts[id(things[0])] = found
    return texts


def _declared(project: Project) -> Iterator[tuple[str, Declared]]:
    for pou in project.pous:
        if pou.interface is not None:
            yield f"POU {pou.name}", pou.interface
        for method in pou.methods:
            if method.interface is not None:
                yield f"POU {pou.name} / method {method.name}", method.interface
    for declaration in project.data_types:
        yield f"type {declaration.name}", declaration
    for section in project.global_sections():
        yield f"global variables {section.name}", section


def _content(thing: Element, *without: str) -> dict[str, object]:
    return {name: value for name, value in vars(thing).items() if name not in ("declaration", *without)}


def _edited(text: str, things: Sequence[Declared], old: Sequence[Declared]) -> str:
    """Return `text` with all in which `things` differ from `old` and from it."""
    unit = METHOD if text.lstrip().upper().startswith("METHOD") else unit_of(text)
    reading = read(unit.around(text), None)
    if any(each.severity is Severity.ERROR for each in reading.diagnostics):
        raise _UnfitError
    declared = reading.project
    thing, before = things[0], old[0] if old else None
    if isinstance(thing, Interface):
        holders: list[Pou | Method] = [*declared.pous]
        holders = [each for pou in declared.pous for each in pou.methods] or holders
        interfaces = [each.interface for each in holders if each.interface is not None]
        if len(holders) != 1 or len(interfaces) != 1:
            raise _UnfitError
        [known] = interfaces
        if isinstance(before, Interface):
            if _content(thing, "sections", "return_type") != _content(before, "sections", "return_type"):
                raise _UnfitError
            if thing.return_type != before.return_type:
                known.return_type = thing.return_type
        sections = before.sections if isinstance(before, Interface) else []
        known.sections = _merged(known.sections, sections, thing.sections)
    elif isinstance(thing, VariableSection):
        lists = [[each for each in group if isinstance(each, VariableSection)] for group in (old, things)]
        declared.global_variables = _merged(declared.global_variables, *lists)
    else:
        if len(declared.data_types) != 1:
            raise _UnfitError
        _retype(declared.data_types[0], before if isinstance(before, t.DataTypeDeclaration) else None, thing)
    return declaration_of(declared, text)


def _retype(known: t.DataTypeDeclaration, old: t.DataTypeDeclaration | None, new: t.DataTypeDeclaration) -> None:
    if old is not None and _content(old, "name", "type", "initial") != _content(new, "name", "type", "initial"):
        raise _UnfitError
    if isinstance(known.type, t.StructType) and isinstance(new.type, t.StructType):
        members = old.type.members if old is not None and isinstance(old.type, t.StructType) else []
        groups = [[VariableSection(variables=each)] for each in (known.type.members, members, new.type.members)]
        known.type.members = [each for section in _merged(*groups) for each in section.variables]
    elif old is None or old.type != new.type:
        known.type = new.type
    if old is not None and old.initial != new.initial:
        known.initial = new.initial


_Place = tuple[tuple[object, ...], t.Variable]


def _places(sections: Iterable[VariableSection]) -> dict[str, _Place]:
    return {v.name.casefold(): (_kind(section), v) for section in sections for v in section.variables}


def _renamed(old: Sequence[VariableSection], new: Sequence[VariableSection]) -> list[tuple[t.Variable, t.Variable]]:
    """Return what renamed variables were, and are: those at the same place, where the old name is gone."""
    before, after = _places(old), _places(new)
    sections = zip(old, new, strict=False)
    pairs = [pair for two in sections for pair in zip(*(each.variables for each in two), strict=False)]
    return [(v, w) for v, w in pairs if v.name.casefold() not in after and w.name.casefold() not in before]


def _kind(section: VariableSection) -> tuple[object, ...]:
    return tuple(getattr(section, name) for name in _SECTION)


def _merged(
    known: list[VariableSection], old: Sequence[VariableSection], new: Sequence[VariableSection]
) -> list[VariableSection]:
    """Return the sections `known` of a text with all in which `new` differs from `old`, and from the text itself."""
    before, after, found = _places(old), _places(new), _places(known)
    for old_one, variable in _renamed(old, new):
        name = variable.name.casefold()
        before[name] = after[name][0], old_one
        there = found.get(old_one.name.casefold())
        if there is not None and name not in found:
            there[1].name = variable.name
            found[name] = there
            del found[old_one.name.casefold()]
    for section in known:
        kept = [v for v in section.variables if _stays(v.name.casefold(), before, after)]
        if len(kept) < len(section.variables):
            section.variables = kept
    result = [section for section in known if section.variables or not after]
    for section in new:
        previous: t.Variable | None = None
        for variable in section.variables:
            name = variable.name.casefold()
            was, mine = before.get(name), found.get(name)
            if mine is not None and mine[0] == _kind(section):
                _update(mine[1], was[1] if was is not None else None, variable)
                previous = mine[1]
            elif was != (_kind(section), variable):  # else the tool declares it without being asked: SFC flags
                previous = _insert(result, section, previous, variable)
    return result


def _stays(name: str, before: dict[str, _Place], after: dict[str, _Place]) -> bool:
    was, now = before.get(name), after.get(name)
    return was is None if now is None else was is None or was[0] == now[0]


def _insert(
    result: list[VariableSection], section: VariableSection, previous: t.Variable | None, variable: t.Variable
) -> t.Variable:
    """Put a variable behind `previous`, or at the end of the last section of its kind, or into a new one."""
    added = variable.model_copy(deep=True)
    alike = [each for each in result if _kind(each) == _kind(section)]
    for each in alike:
        place = next((i for i, v in enumerate(each.variables) if v is previous), None)
        if place is not None:
            each.variables = [*each.variables[: place + 1], added, *each.variables[place + 1 :]]
            return added
    if alike:
        alike[-1].variables = [*alike[-1].variables, added]
    else:
        result.append(section.model_copy(update={"variables": [added], "declaration": None, "object_id": None}))
    return added


def _update(known: t.Variable, old: t.Variable | None, new: t.Variable) -> None:
    """Give a variable of the text what was edited; of one that was not there before, what the text says otherwise."""
    if old is None:
        for name in ("type", "address", "initial"):
            if _written(getattr(known, name)) != _written(getattr(new, name)):
                setattr(known, name, getattr(new, name))
        return
    if _content(old, "name", *_MERGED) != _content(new, "name", *_MERGED):
        raise _UnfitError
    for name in _MERGED:
        if getattr(old, name) != getattr(new, name):
            setattr(known, name, getattr(new, name))


def _written(value: str | t.DataType | t.Value | None) -> str:
    if isinstance(value, t.SimpleValue | t.ArrayValue | t.StructValue):
        return write_value(value, Dialect.CODESYS).casefold()
    if value is None or isinstance(value, str):
        return (value or "").casefold()
    return write_type(value, Dialect.CODESYS).casefold()
