"""Names, types and flags that lowered code declares, and where: local, global at addresses, or in a data block.

Names are legal, free, and the same whenever the chart is lowered again.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Container, Iterable, Iterator
from typing import NoReturn

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.languages.standard_blocks import S7_INSTANCES, Tool
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import DataBlock
from plcopen_sfc.model.project import Configuration, Project, Tag, TagTable
from plcopen_sfc.model.text import Text
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, SimpleValue, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection


class Naming:
    """Source of names that nothing else in the POU has. `taken` are all names that occur in it."""

    def __init__(self, dialect: Dialect, taken: Iterable[str]) -> None:
        self._local = n.Quoting.LOCAL if dialect is Dialect.SCL else n.Quoting.NONE
        self._taken = {name.casefold() for name in taken}
        self._numbers: dict[str, int] = {}

    def system_type(self, kind: DerivedType) -> DerivedType:
        """Return the type of instances of a standard function block in the dialect: ``TON_TIME`` in SCL."""
        name = S7_INSTANCES.get(kind.name) if self._local is n.Quoting.LOCAL else None
        return DerivedType(name=name) if name is not None else kind

    def fresh(self, wanted: str) -> str:
        """Return `wanted` as an identifier, with a number behind it if that is taken."""
        name = candidate = _identifier(wanted)
        number = self._numbers.get(name.casefold(), 2)
        while candidate.casefold() in self._taken:
            candidate = f"{name}_{number}"
            number += 1
        self._numbers[name.casefold()] = number
        self._taken.add(candidate.casefold())
        return candidate

    def local(self, name: str) -> n.Name:
        """Return a name of the POU's interface as the dialect writes it."""
        return n.Name(name, self._local)


def free_name(wanted: str, taken: Container[str]) -> str:
    """Return `wanted`, with a number behind it if it is one of the names in lower case that are `taken`."""
    name, number = wanted, 2
    while name.casefold() in taken:
        name, number = f"{wanted}_{number}", number + 1
    return name


def _identifier(wanted: str) -> str:
    spelled = unicodedata.normalize("NFC", wanted)
    name = re.sub(r"_{2,}", "_", re.sub(r"\W", "_", spelled)).strip("_")
    return name if name and not name[0].isdigit() else f"x{name}"


def names_of(project: Project) -> set[str]:
    """Return the names of POUs, types, data blocks, tags, global variables and their lists, in lower case."""
    found = {pou.name for pou in project.pous} | {kind.name for kind in project.data_types}
    found |= {block.name for block in project.data_blocks}
    for table in project.tag_tables:
        found |= {tag.name for tag in table.tags} | {constant.name for constant in table.constants}
    for section in project.global_sections():
        found |= {section.name or "", *(variable.name for variable in section.variables)}
    return {name.casefold() for name in found}


BOOL = ElementaryType(name=Elementary.BOOL)
INT = ElementaryType(name=Elementary.INT)
TIME = ElementaryType(name=Elementary.TIME)
_LARGEST_INT = 32_767

LOCAL = "local"
_FIRST = re.compile(r"%?MX?(\d{1,9})\.([0-7])", re.IGNORECASE)
_ADDRESS = re.compile(r"%?M([XBWDL]?)(\d{1,9})(?:\.(\d{1,9}))?", re.IGNORECASE)
_WIDTHS = {"": 1, "X": 1, "B": 8, "W": 16, "D": 32, "L": 64}
_BYTE = 8


class FlagPlaces:
    """Declarations of the flags of one chart outside of its POU: as tags or global variables, or in a data block.

    `name` is that of the table, the list or the block; `tool` decides which of them. Raises `LoweringError` for a place
    that does not exist or that is taken.
    """

    def __init__(self, rules: LoweringRules, pou: str, project: Project, tool: Tool | None) -> None:
        self.tool = tool
        self.variables: list[Variable] = []
        self._pou = pou
        self._quoting = n.Quoting.GLOBAL if project.dialect is Dialect.SCL else n.Quoting.NONE
        self._surroundings = names_of(project)
        self._bit: int | None = None
        self._taken: dict[int, str] = {}
        first = _FIRST.fullmatch(rules.flags.strip())
        self.in_block = first is None
        if first is not None:
            self._bit = int(first[1]) * _BYTE + int(first[2])
            self._taken = dict(_taken_bits(project))
            self.name = self._free(f"{rules.texts.flag_list}_{pou}")
        else:
            self.name = rules.flags
            if re.fullmatch(r"[^\W\d]\w*", self.name) is None or _ADDRESS.fullmatch(self.name):
                hint = "There are: local, an address such as M20.0, the name of a data block."
                self._refuse(f"{self.name!r} is no place for flags", hint)
            if self.name.casefold() in self._surroundings:
                self._refuse(f"there is something called {self.name} already")

    @property
    def have_values(self) -> bool:
        """True if flags have their values at the start: tags have none."""
        return self.in_block or self.tool is not Tool.S7

    @property
    def following(self) -> str:
        """Address behind the last flag; empty for flags without addresses."""
        return f"M{self._bit // _BYTE}.{self._bit % _BYTE}" if self._bit is not None else ""

    @property
    def external(self) -> list[Variable]:
        """Variables that the POU must declare to see them (IEC 61131-3, VAR_EXTERNAL); tools do not ask for that."""
        if self.tool is not None:
            return []
        return [Variable(name=variable.name, type=variable.type) for variable in self.variables]

    def declare(self, wanted: str, naming: Naming, *, initial: bool, comment: Text | None) -> Expression:
        """Declare a flag, and return the expression that reads it."""
        is_member = self.in_block and self.tool is not None
        name = naming.fresh(wanted)
        if not is_member:
            name = self._free(name)
        variable = Variable(name=name, type=BOOL, comment=comment)
        if initial and self.have_values:
            variable.initial = SimpleValue(text="TRUE")
        if self._bit is not None:
            variable.address = self._next_address(name)
        self.variables.append(variable)
        if is_member:
            return n.Member(n.Name(self.name, self._quoting), n.Name(name))
        return n.Name(name, self._quoting)

    def put_into(self, project: Project) -> None:
        """Declare the flags in a project."""
        if self.tool is Tool.S7:
            self._put_into_s7(project)
            return
        section = VariableSection(kind=SectionKind.GLOBAL, name=self.name, variables=self.variables)
        if self.tool is Tool.CODESYS:
            lists = project.applications[0].global_variables if project.applications else project.global_variables
            lists.append(section)
            return
        if not project.configurations:
            project.configurations.append(Configuration(name="Configuration"))
        project.configurations[0].global_variables.append(section)

    def _put_into_s7(self, project: Project) -> None:
        if self.in_block:
            members = VariableSection(kind=SectionKind.LOCAL, variables=self.variables)
            project.data_blocks.append(DataBlock(name=self.name, interface=Interface(sections=[members])))
            return
        tags = [Tag(name=v.name, type="Bool", address=v.address, comment=v.comment) for v in self.variables]
        project.tag_tables.append(TagTable(name=self.name, tags=tags))

    def _next_address(self, name: str) -> str:
        bit = self._bit or 0
        if bit in self._taken:
            self._refuse(f"the address of the flag {name} belongs to {self._taken[bit]} already")
        self._bit = bit + 1
        place = f"{bit // _BYTE}.{bit % _BYTE}"
        return f"%M{place}" if self.tool is Tool.S7 else f"%MX{place}"

    def _free(self, wanted: str) -> str:
        name = free_name(wanted, self._surroundings)
        self._surroundings.add(name.casefold())
        return name

    def _refuse(self, message: str, hint: str = "") -> NoReturn:
        raise LoweringError(message, location=Location(path=self._pou), hint=hint)


def flags_of_several(flags: str, pou: str, following: str) -> str:
    """Return where the flags of one of several charts go: behind those before it, or into a block of their own."""
    if flags == LOCAL:
        return flags
    if _FIRST.fullmatch(flags.strip()) is not None:
        return following or flags
    return f"{flags}_{pou.replace('.', '_')}"


def _taken_bits(project: Project) -> Iterator[tuple[int, str]]:
    """Yield the bits of the memory that have names. Words count words in CODESYS, else bytes."""
    in_bytes = project.dialect in (Dialect.SCL, Dialect.TWINCAT)
    named = [(tag.address, tag.name) for table in project.tag_tables for tag in table.tags]
    sections = [*project.global_sections()]
    for pou in project.pous:
        sections += pou.interface.sections if pou.interface is not None else []
    named += [(variable.address, variable.name) for section in sections for variable in section.variables]
    for address, name in named:
        found = _ADDRESS.fullmatch((address or "").strip())
        if found is None:
            continue
        width, number = _WIDTHS[found[1].upper()], int(found[2])
        first = number * _BYTE + int(found[3] or 0) if width == 1 else number * (_BYTE if in_bytes else width)
        yield from ((bit, name) for bit in range(first, first + width))


def integer(largest: int) -> ElementaryType:
    """Return the type of numbers up to `largest`: INT where it holds them, else DINT."""
    return INT if largest <= _LARGEST_INT else ElementaryType(name=Elementary.DINT)
