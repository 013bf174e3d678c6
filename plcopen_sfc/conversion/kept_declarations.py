"""Declarations that the model keeps as they were written, and the types that nothing declares.

A property, a class or the own data of a tool is executed by the tools that read it, and by no other.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import chain

from plcopen_sfc.conversion.executed_parts import UNDECLARED_TYPE, Part
from plcopen_sfc.conversion.meaning import Meaning
from plcopen_sfc.formats.codesys import codesys_names as codesys
from plcopen_sfc.formats.iectext.text_source import unwrapped
from plcopen_sfc.languages.binding.text_sites import Role, TextSite
from plcopen_sfc.languages.declarations.kept_texts import inheritance, kept
from plcopen_sfc.languages.declarations.type_names import is_quoted_in_scl
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.base import Carried, ForeignData
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import ArrayType, DataType, DataTypeDeclaration, DerivedType, Elementary, StructType

__all__ = ["add_kept", "tell_inheritance", "tell_type"]

_HARMLESS = {
    "accessmodifiers": "the compiler alone looks at who may use a name",
    "attributes": "pragmas for the compiler and for what shows variables",
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
"""The data of CODESYS and TwinCAT, where the model only carries it, that no machine executes, each with the reason."""

_PROPERTY = re.compile(r"\bPROPERTY\s+(?:(?:PUBLIC|PRIVATE|PROTECTED|INTERNAL|FINAL|ABSTRACT|OVERRIDE)\s+)*(\w+)", re.I)
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


def tell_type(part: Part, kind: DataType, declaration: DataTypeDeclaration | None = None) -> None:
    """Note that a type is a UNION, or has one in it, and what its declaration extends."""
    if _has_union(kind):
        part.tell("union", Meaning.of(True, "UNION"))
    base = kept(declaration.carried).get("extends") if declaration is not None else None
    part.tell("extends", Meaning.of(base.casefold(), base) if base else None)


def _has_union(kind: DataType) -> bool:
    while isinstance(kind, ArrayType):
        kind = kind.base
    if not isinstance(kind, StructType):
        return False
    return "union" in kept(kind.carried) or any(_has_union(member.type) for member in kind.members)


def tell_inheritance(part: Part, pou: Pou) -> None:
    """Note what a POU extends and implements."""
    found = inheritance(pou.interface)
    for aspect, names in (("extends", found.extends), ("implements", found.implements)):
        part.tell(aspect, Meaning.of(tuple(map(str.casefold, names)), ", ".join(names)) if names else None)


def add_kept(whole: Part, project: Project, text_sites: Iterable[TextSite], tool: Dialect) -> None:
    """Add what the `tool` of a project executes of what is kept as text, and each type that nothing declares."""
    texts = list(_units(project.carried))
    for keyword, name in (found[0] for found in texts if found):
        whole.add("unit", name, f"{keyword} {name}").tell("kind", Meaning.of(keyword))
    for pou in project.pous:
        for data in pou.carried.data if pou.carried is not None else ():
            place, text = unwrapped(data.content) or ("", "")
            if place == "property" and (named := _PROPERTY.search(text)):
                name = named.group(1)
                part = whole.add("property", f"{pou.name}.{name}", f"{pou.report_path} / property {name}")
                part.tell("code", Meaning.of(" ".join(text.split()).casefold(), "its text"))
    types: dict[str, TextSite] = {}
    for text_site in text_sites:
        if isinstance(text_site.holder, ForeignData):
            _add_data(whole, text_site, tool)
        elif text_site.role is Role.TYPE and isinstance(text_site.holder, DerivedType | Block | DataBlock):
            types.setdefault(text_site.text.replace('"', ""), text_site)
    declared = {thing.name.casefold() for thing in (*project.pous, *project.data_types)}
    declared |= {name.rpartition(".")[2].casefold() for _, name in chain.from_iterable(texts)}
    used = [(name, text_site.report_path) for name, text_site in types.items()]
    for name, path in (*used, *_bases(project)):
        if name.rpartition(".")[2].casefold() not in declared and not _has(project.dialect, name):
            declared.add(name.rpartition(".")[2].casefold())
            whole.add(UNDECLARED_TYPE, name, path).tell("name", Meaning.of(name))


def _units(carried: Carried | None) -> Iterator[list[tuple[str, str]]]:
    """Declarations of each unit that is kept as text: the unit first, then what is in it, by keyword and name."""
    for data in carried.data if carried is not None else ():
        place, text = unwrapped(data.content) or ("", "")
        if place == "unit":
            yield [(found[1].upper(), found[2]) for found in _UNIT.finditer(text)]


def _bases(project: Project) -> Iterator[tuple[str, str]]:
    """The names behind EXTENDS and IMPLEMENTS, with where they stand."""
    for declaration in project.data_types:
        if base := kept(declaration.carried).get("extends"):
            yield base, declaration.report_path
    for pou in project.pous:
        for name in chain.from_iterable(inheritance(pou.interface)):
            yield name, pou.report_path


def _add_data(whole: Part, text_site: TextSite, tool: Dialect) -> None:
    """Add data of CODESYS that the model only carries, where it is executed."""
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
    if not word or word in Elementary.__members__ or standard_block(word) is not None:
        return True
    return not is_quoted_in_scl(name) if dialect is Dialect.SCL else word in _TYPES_OF_TOOLS[family(dialect)]
