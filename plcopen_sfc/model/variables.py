"""Declarations: the sections of an interface and lists of global variables."""

from __future__ import annotations

from enum import StrEnum
from typing import ClassVar

from pydantic import Field

from plcopen_sfc.errors import check_argument
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.late import LateElement
from plcopen_sfc.model.owners import OwnedName
from plcopen_sfc.model.types import DataType, Value, Variable


class SectionKind(StrEnum):
    """The variable sections of IEC 61131-3 (ed. 3, table 13), and those that TIA adds."""

    LOCAL = "local"
    TEMP = "temp"
    INPUT = "input"
    OUTPUT = "output"
    IN_OUT = "inOut"
    EXTERNAL = "external"
    GLOBAL = "global"
    ACCESS = "access"
    CONSTANT = "constant"
    RETURN = "return"


PASSED = frozenset({SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT})
"""The sections with the variables that a call passes."""


class VariableSection(OwnedName, Element):
    """Variables that share a section and its memory attributes (``VAR_INPUT RETAIN .. END_VAR``).

    A list of global variables is a section too; it may have a name, the text as declared (`declaration`, CODESYS) and a
    CODESYS object id. `place` is as in `Pou.place`.
    """

    kind: SectionKind = SectionKind.LOCAL
    name: str | None = None
    constant: bool = False
    retain: bool = False
    nonretain: bool = False
    persistent: bool = False
    nonpersistent: bool = False
    variables: list[Variable] = Field(default_factory=list)
    declaration: str | None = None
    object_id: str | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("variables",)

    def with_variables(self, variables: list[Variable]) -> VariableSection:
        """Return a section for other variables in the same memory (CONSTANT, RETAIN ..)."""
        fields = {name: getattr(self, name) for name in _MEMORY}
        return VariableSection(**fields, variables=variables)


class Interface(LateElement):
    """Declarations of a POU.

    `declaration` is the text as it was typed, where the file has it (CODESYS "interface as plain text"): the only form
    that keeps pragmas and comments between the variables.
    """

    return_type: DataType | None = None
    sections: list[VariableSection] = Field(default_factory=list)
    declaration: str | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("sections",)

    def variables(self, kind: SectionKind | None = None) -> list[Variable]:
        """Return all variables, or those of one kind of section, in the order of their declaration."""
        return [v for s in self.sections if kind is None or s.kind is kind for v in s.variables]

    def section(self, kind: SectionKind, *, constant: bool = False) -> VariableSection:
        """Return the section for new variables of a kind: one with nothing of its own, such as RETAIN or VAR_STAT.

        A new one at the end where there is none: a block of TIA Portal has each section once.
        """
        return self.section_like(VariableSection(kind=kind, constant=constant))

    def section_like(self, other: VariableSection) -> VariableSection:
        """Return the section for new variables in the same memory as those of another one."""
        check_argument(other, VariableSection, "a section of variables is needed")
        plain = other.with_variables([])
        for section in self.sections:
            is_kept = section.extension_data is not None and section.extension_data.data  # such as another keyword
            if not is_kept and all(getattr(section, name) == getattr(plain, name) for name in _MEMORY):
                return section
        self.sections.append(plain)
        return plain


_MEMORY = ("kind", "name", "constant", "retain", "nonretain", "persistent", "nonpersistent")


def sections_of(interface: Interface | None) -> list[VariableSection]:
    """Return the sections of an interface; none where nothing has one."""
    return interface.sections if interface is not None else []


class AccessDirection(StrEnum):
    """``READ_ONLY`` or ``READ_WRITE`` of an access path."""

    READ_ONLY = "readOnly"
    READ_WRITE = "readWrite"


class AccessVariable(Element):
    """An access path of ``VAR_ACCESS``: the name `alias` that a communication partner sees."""

    alias: str
    path: str
    type: DataType
    direction: AccessDirection | None = None


class ConfigVariable(Element):
    """An entry of ``VAR_CONFIG``: a located or initialised variable of an instance."""

    path: str
    type: DataType
    address: str | None = None
    initial: Value | None = None


class AccessSection(Element):
    """``VAR_ACCESS`` of a configuration."""

    variables: list[AccessVariable] = Field(default_factory=list)


class ConfigSection(Element):
    """``VAR_CONFIG`` of a configuration."""

    variables: list[ConfigVariable] = Field(default_factory=list)
