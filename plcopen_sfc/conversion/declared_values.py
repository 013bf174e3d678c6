"""Declared values: start values of variables, and declarations that the model keeps as they were written.

A property, a class or the own data of a tool is executed by the tools that read it, and by no other.

The start value of every elementary member is from the declaration of its variable or from its type.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain, groupby, pairwise

from plcopen_sfc.conversion.executed_parts import UNDECLARED_TYPE, Part
from plcopen_sfc.conversion.meaning import Meaning, literal_form
from plcopen_sfc.formats.codesys import codesys_names as codesys
from plcopen_sfc.languages.binding.text_sites import Role, TextSite
from plcopen_sfc.languages.declarations.attributes import acting_attributes, attributes_of, typed_attributes
from plcopen_sfc.languages.declarations.kept_texts import inheritance, kept, properties_of, texts_from
from plcopen_sfc.languages.declarations.type_names import is_quoted_in_scl
from plcopen_sfc.languages.s7_types import S7Types, number_of
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model import types as t
from plcopen_sfc.model.base import Element, ForeignData
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import Project

_DEEPEST = 32
"""Structures are not nested more deeply: types that hold themselves are."""
_ZEROS = ((False,), (0,), ("",), ("", "wide"))


@dataclass(frozen=True, slots=True)
class _Start:
    """Start value: a `literal`, written as `text`, or `parts` by name; nothing: the usual values.

    The parts of an array are its elements from one place on that are alike, with how many they are.
    """

    literal: Hashable = None
    text: str = field(default="", compare=False)
    parts: tuple[tuple[Hashable, _Start], ...] = ()

    def __bool__(self) -> bool:
        return self.literal is not None or bool(self.parts)

    def shown(self, path: str = "") -> Iterator[str]:
        """Yield the values as people read them."""
        if self.literal is not None:
            yield f"{path} = {self.text}" if path else self.text
        for name, part in self.parts:
            if isinstance(name, tuple):
                first, count = name
                inner = f"{path}[{first}]" if count == 1 else f"{path}[{first}..{first + count - 1}]"
            else:
                inner = f"{path}.{name}" if path else str(name)
            yield from part.shown(inner)


class StartValues:
    """The start values of the variables of a project, as `number` resolves the names of constants in them."""

    def __init__(self, project: Project, number: Callable[[str], str | None]) -> None:
        self._types = S7Types(project.data_types)
        self._declared = {each.name.casefold(): each for each in project.data_types}
        self._blocks = {pou.name.casefold(): pou for pou in project.pous}
        self._number = number
        self._usual: dict[str, _Start] = {}  # of each type once: structures in structures have millions of members
        self._open: set[str] = set()

    def meaning(self, variable: t.Variable) -> Meaning | None:
        """Start value of a variable; None for the usual one, and for members that have no other."""
        given = () if variable.initial is None else (variable.initial,)
        found = self._of(variable.type, given, 0)
        return Meaning.of(found, ", ".join(found.shown())) if found else None

    def of_value(self, value: t.Value | None) -> Meaning | None:
        """Return a value that counts instead of another, so that the usual one is one too."""
        found = _Start() if value is None else self._plain(value, named=True)
        return Meaning.of(found, ", ".join(found.shown())) if found else None

    def _of(self, type_: t.DataType, given: Sequence[t.Value], depth: int) -> _Start:
        """Return the start of something of a type, of which the declarations say this much, the nearest first."""
        given = [value for value in given if not (isinstance(value, t.SimpleValue) and not (value.text or "").strip())]
        if depth > _DEEPEST:
            return _Start()
        if isinstance(type_, t.DerivedType):
            return self._of_named(type_, given, depth)
        if isinstance(type_, t.StructType):
            return self._of_members(type_.members, given, depth)
        if isinstance(type_, t.ArrayType):
            return self._of_array(type_, given, depth)
        if not given:
            start = self._types.start(t.Variable(name="x", type=type_))
            given = [] if start is None else [start]
        return self._plain(given[0]) if given else _Start()

    def _of_named(self, type_: t.DerivedType, given: Sequence[t.Value], depth: int) -> _Start:
        key = type_.name.replace('"', "").casefold()
        declared = self._declared.get(key)
        if declared is not None:
            if key in self._open:  # a type that contains itself
                return _Start()
            if given or key not in self._usual:
                self._open.add(key)
                found = self._of_declared(type_, declared, given, depth)
                self._open.remove(key)
                if given:
                    return found
                self._usual[key] = found
            return self._usual[key]
        block = self._blocks.get(key)
        if block is None:
            return self._plain(given[0], named=True) if given else _Start()
        own_values = {variable.name.casefold(): variable for variable in block.variables()}
        parts = []
        for name in sorted({m.member.casefold() for v in given if isinstance(v, t.StructValue) for m in v.members}):
            variable = own_values.get(name)
            values = _members(given, name)
            if variable is None:
                parts.append((name, self._plain(values[0])))
                continue
            usual = () if variable.initial is None else (variable.initial,)
            found = self._of(variable.type, (*values, *usual), depth + 1)
            if found != self._of(variable.type, usual, depth + 1):
                parts.append((name, found or _Start(0, "0")))
        return _Start(parts=tuple(parts))

    def _of_declared(
        self, type_: t.DerivedType, declared: t.DataTypeDeclaration, given: Sequence[t.Value], depth: int
    ) -> _Start:
        if isinstance(declared.type, t.StructType | t.ArrayType | t.DerivedType):
            own = () if declared.initial is None else (declared.initial,)
            return self._of(declared.type, (*given, *own), depth + 1)
        start = self._types.start(t.Variable(name="x", type=type_, initial=given[0] if given else None))
        return self._of(declared.type, () if start is None else (start,), depth + 1)

    def _of_members(self, members: Sequence[t.Variable], given: Sequence[t.Value], depth: int) -> _Start:
        whole = next((value for value in given if isinstance(value, t.SimpleValue)), None)
        if whole is not None:
            return self._plain(whole)
        parts = []
        for member in members:
            own = () if member.initial is None else (member.initial,)
            start = self._of(member.type, (*_members(given, member.name.casefold()), *own), depth + 1)
            if start:
                parts.append((member.name.casefold(), start))
        return _Start(parts=tuple(sorted(parts, key=lambda part: str(part[0]))))

    def _of_array(self, type_: t.ArrayType, given: Sequence[t.Value], depth: int) -> _Start:
        bounds = [(number_of(d.lower), number_of(d.upper)) for d in type_.dimensions]
        size = 1
        for lower, upper in bounds:
            if lower is None or upper is None:
                return self._plain(given[0]) if given else _Start()
            size *= max(upper - lower + 1, 0)
        first = (bounds[0][0] or 0) if len(bounds) == 1 else 0
        if any(isinstance(value, t.SimpleValue) for value in given):
            return self._plain(given[0])
        layers = [list(_runs(value)) for value in given]
        cuts = {0, size, *(place for layer in layers for place, _, _ in layer)}
        cuts |= {place + count for layer in layers for place, count, _ in layer}
        edges = sorted(place for place in cuts if place <= size)
        found: list[tuple[int, int, _Start]] = []
        for place, end in pairwise(edges):
            values = [v for layer in layers for start, count, v in layer if start <= place < start + count]
            found.append((place, end - place, self._of(type_.base, values, depth + 1)))
        parts: list[tuple[Hashable, _Start]] = []
        for element, group in groupby(found, key=lambda run: run[2]):
            runs = list(group)
            if element:
                parts.append(((first + runs[0][0], sum(count for _, count, _ in runs)), element))
        return _Start(parts=tuple(parts))

    def _plain(self, value: t.Value, *, named: bool = False) -> _Start:
        """Return a value as it is written; `named`: of a type that nothing declares, whose usual value is unknown."""
        if isinstance(value, t.StructValue):
            members = sorted(value.members, key=lambda each: each.member.casefold())
            parts = tuple((each.member.casefold(), self._plain(each.value, named=True)) for each in members)
            return _Start(parts=tuple(part for part in parts if part[1]))
        if isinstance(value, t.ArrayValue):
            runs = [(place, count, self._plain(each, named=True)) for place, count, each in _runs(value)]
            return _Start(parts=tuple(((place, count), start) for place, count, start in runs if start))
        text = (value.text or "").strip()
        if not text:
            return _Start()
        text = self._number(text) or text
        literal = literal_form(text)
        return _Start() if literal in _ZEROS and not named else _Start(literal, text)


def _members(given: Sequence[t.Value], name: str) -> list[t.Value]:
    """Start value of one member among those of a structure."""
    return [m.value for v in given if isinstance(v, t.StructValue) for m in v.members if m.member.casefold() == name]


def _runs(value: t.Value) -> Iterator[tuple[int, int, t.Value]]:
    """Yield the values of an array: the place of the first, how many, and the value.

    One value is for the first element.
    """
    place = 0
    for item in value.items if isinstance(value, t.ArrayValue) else ():
        count = number_of(item.repetitions) if item.repetitions is not None else 1
        yield place, count or 0, item.value
        place += count or 0


_HARMLESS = {
    "accessmodifiers": "the compiler alone looks at who may use a name",
    "attributes": "those that act are looked at where they are read",
    "buildproperties": "whether the linker keeps what nothing calls",
    "enumvaluedocumentation": "comments",
    "fbd/implementationattributes": "how the editor shows a network",
    "fbdelementtype": "how the editor shows an element",
    "inputparamtypes": "types of pins, which the called block has",
    "interfaceasplaintext": "the text of what the elements declare",
    "ldbranchid": "how the editor draws branches",
    "libraries": "what is used of them has a name that nothing declares",
    "objectid": "ids of the project tree",
    "outputparamtypes": "types of pins, which the called block has",
    "projectinformation": "texts for people",
    "projectstructure": "the project tree",
    "sfc/element": "what the editor shows of steps; what is executed of it is read",
}
"""The data of CODESYS and TwinCAT, where the model only keeps it, that no machine executes, each with the reason."""

_NAME = re.compile(r"""<(?:\w+:)?\w+[^>]*?\bname=["']([^"']+)["']""", re.IGNORECASE)
_UNIT = re.compile(
    r"\b(CLASS|INTERFACE|NAMESPACE|FUNCTION_BLOCK|FUNCTION|PROGRAM|TYPE)\s+"
    r"(?:(?:PUBLIC|INTERNAL|FINAL|ABSTRACT)\s+)*(\w[\w.]*)",
    re.IGNORECASE,
)
_TYPES_OF_TOOLS = {
    Dialect.CODESYS: frozenset(
        "BIT __XINT __UXINT __XWORD SFCSTEPTYPE SFCACTIONTYPE SEMA RTC LTON LTOF LTP VERSION".split()
    ),
    Dialect.IEC: frozenset({"SEMA", "RTC"}),
}
"""Types that tools have besides those of IEC 61131-3, in capitals. Those of S7 stand without quotes."""


def tell_type(part: Part, kind: t.DataType, declaration: t.DataTypeDeclaration | None = None) -> None:
    """Note that a type is a UNION, or has one in it, and what its declaration extends."""
    if _has_union(kind):
        part.tell("union", Meaning.of(True, "UNION"))
    base = kept(declaration.extension_data).get("extends") if declaration is not None else None
    part.tell("extends", Meaning.of(base.casefold(), base) if base else None)


def _has_union(kind: t.DataType) -> bool:
    kind = t.element_type(kind)
    if not isinstance(kind, t.StructType):
        return False
    return "union" in kept(kind.extension_data) or any(_has_union(member.type) for member in kind.members)


def tell_inheritance(part: Part, pou: Pou) -> None:
    """Note what a POU extends and implements."""
    found = inheritance(pou.interface)
    for aspect, names in (("extends", found.extends), ("implements", found.implements)):
        part.tell(aspect, Meaning.of(tuple(map(str.casefold, names)), ", ".join(names)) if names else None)


_MODIFIER = re.compile(r"<(Public|Private|Protected|Internal|Final|Abstract)\b", re.IGNORECASE)


_HEAD = re.compile(
    r"\b(?:FUNCTION_BLOCK|FUNCTION|METHOD)\s+((?:(?:PUBLIC|PRIVATE|PROTECTED|INTERNAL|FINAL|ABSTRACT)\s+)+)",
    re.IGNORECASE,
)


def tell_declaration(part: Part, thing: Element, typed: Sequence[str] = (), declaration: str | None = None) -> None:
    """Note the modifiers of access and the attributes of what is declared; `typed` are those in its `declaration`."""
    written = _HEAD.search(declaration or "")
    if written is not None:
        part.tell("modifiers", Meaning.of(" ".join(written[1].upper().split())))
    for text in texts_from("modifiers", thing.extension_data):
        part.tell("modifiers", Meaning.of(text.upper(), text))
    for data in thing.extension_data.data if thing.extension_data is not None else ():
        if data.name.endswith("/accessmodifiers") and written is None:
            words = " ".join(word.upper() for word in _MODIFIER.findall(data.content))
            part.tell("modifiers", Meaning.of(words) if words else None)
    found = " ".join(" ".join(attributes_of(thing, typed)).split())
    part.tell("attributes", Meaning.of(found) if found else None)


def tell_acting_attributes(part: Part, thing: Element, typed: Sequence[str] = ()) -> None:
    """Note the attributes of what is declared that change what a machine does; `typed` as in `tell_declaration`."""
    _tell_acting(part, acting_attributes(thing, typed))


def tell_acting_attributes_of_type(part: Part, declaration: t.DataTypeDeclaration) -> None:
    """Note the attributes of a type and of its members that change what a machine does."""
    typed = typed_attributes(declaration.declaration)
    found = acting_attributes(declaration, typed.get("", ()))
    for member in declaration.type.members if isinstance(declaration.type, t.StructType) else ():
        found += acting_attributes(member, typed.get(member.name.casefold(), ()))
    _tell_acting(part, found)


def _tell_acting(part: Part, found: Sequence[str]) -> None:
    part.tell("attributes", Meaning.of(frozenset(map(str.casefold, found)), ", ".join(found)) if found else None)


def add_kept(
    whole: Part, project: Project, text_sites: Iterable[TextSite], tool: Dialect, *, with_code: bool = False
) -> None:
    """Add what the `tool` of a project executes of what is kept as text, and each type that nothing declares.

    `with_code`: units with their texts; else only that they are there, for tools write them in forms of their own.
    """
    units = [(text, _declared_in(text)) for text in texts_from("unit", project.extension_data)]
    texts = [found for _, found in units]
    for text, (keyword, name) in ((text, found[0]) for text, found in units if found):
        part = whole.add("unit", name, f"{keyword} {name}")
        part.tell("kind", Meaning.of(keyword))
        part.tell("code", Meaning.of(" ".join(text.split()), text) if with_code else None)
    for pou in project.pous:
        for name, text in properties_of(pou):
            part = whole.add("property", f"{pou.name}.{name}", f"{pou.report_path} / property {name}")
            part.tell("code", Meaning.of(" ".join(text.split()).casefold(), text))
    types: dict[str, TextSite] = {}
    for text_site in text_sites:
        if isinstance(text_site.holder, ForeignData):
            _add_data(whole, text_site, tool)
        elif text_site.role is Role.TYPE and isinstance(text_site.holder, t.DerivedType | Block | DataBlock):
            types.setdefault(text_site.text.replace('"', ""), text_site)
    declared = {thing.name.casefold() for thing in (*project.pous, *project.data_types)}
    declared |= {name.rpartition(".")[2].casefold() for _, name in chain.from_iterable(texts)}
    used = [(name, text_site.report_path) for name, text_site in types.items()]
    for name, path in (*used, *_bases(project)):
        if name.rpartition(".")[2].casefold() not in declared and not _has(project.dialect, name):
            declared.add(name.rpartition(".")[2].casefold())
            whole.add(UNDECLARED_TYPE, name, path).tell("name", Meaning.of(name.casefold(), name))


def _declared_in(text: str) -> list[tuple[str, str]]:
    """Return what a unit that is kept as text declares, by keyword and name: itself first."""
    return [(found[1].upper(), found[2]) for found in _UNIT.finditer(text)]


def _bases(project: Project) -> Iterator[tuple[str, str]]:
    """Yield the names behind EXTENDS and IMPLEMENTS, with where they are."""
    for declaration in project.data_types:
        if base := kept(declaration.extension_data).get("extends"):
            yield base, declaration.report_path
    for pou in project.pous:
        for name in chain.from_iterable(inheritance(pou.interface)):
            yield name, pou.report_path


def _add_data(whole: Part, text_site: TextSite, tool: Dialect) -> None:
    """Add data of CODESYS that the model only keeps, where it is executed."""
    data: ForeignData = text_site.holder
    kind = data.name.removeprefix(codesys.PREFIX)
    if kind == data.name or family(tool) is not Dialect.CODESYS:
        return
    if kind in _HARMLESS and "ExcludeFromBuild" not in data.content:
        return
    named = _NAME.search(data.content)
    label = f"{kind} {named[1]}" if named is not None else kind
    path = f"{text_site.report_path} / {label}" if text_site.report_path else label
    whole.add("property" if kind == "property" else "data of the tool", path, path).tell(
        "code", Meaning.of(data.content)
    )


def _has(dialect: Dialect, name: str) -> bool:
    """True if tools of a dialect have a type without anybody declaring it."""
    word = name.upper()
    if not word or word in t.Elementary.__members__ or standard_block(word) is not None:
        return True
    return not is_quoted_in_scl(name) if dialect is Dialect.SCL else word in _TYPES_OF_TOOLS[family(dialect)]
