"""The versions of TC6 XML and how their grammars differ.

Sources: the TC6 XML papers V1.01 and V2.01 and files of tools. 1.0 and 1.01 share a namespace, 2.0 and 2.01 differ in
theirs only.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

XHTML = "http://www.w3.org/1999/xhtml"
PREFIX = "http://www.plcopen.org/xml/tc6"


@dataclass(frozen=True)
class Tc6Version:
    """One version of TC6 XML."""

    name: str
    namespace: str

    @property
    def first_generation(self) -> bool:
        """Whether this is the grammar of 1.0 and 1.01: no foreign data, one body per POU, no ids at actions."""
        return self.namespace == f"{PREFIX}.xsd"

    @cached_property
    def elements(self) -> frozenset[str]:
        """The names of all elements of this version; of the first generation without the generic types."""
        return frozenset(e for e in ELEMENTS if not (self.first_generation and e.startswith("ANY")))

    @cached_property
    def tags(self) -> dict[str, str]:
        """Qualified names of all elements of TC6, mapped to their local names: the readers' dispatch table."""
        return {f"{{{self.namespace}}}{name}": name for name in ELEMENTS}

    @cached_property
    def qualified(self) -> dict[str, str]:
        """The reverse of `tags`."""
        return {name: tag for tag, name in self.tags.items()}


V1_01 = Tc6Version("1.01", f"{PREFIX}.xsd")
V2_0 = Tc6Version("2.0", f"{PREFIX}_0200")
V2_01 = Tc6Version("2.01", f"{PREFIX}_0201")
VERSIONS = (V1_01, V2_0, V2_01)


def version_of(namespace: str) -> Tc6Version | None:
    """The version with this namespace."""
    return next((version for version in VERSIONS if version.namespace == namespace), None)


def version_named(name: str) -> Tc6Version | None:
    """The version of this name; 1.0 is written as 1.01."""
    return next((version for version in VERSIONS if version.name == ("1.01" if name == "1.0" else name)), None)


ELEMENTS = frozenset(
    """
    project fileHeader contentHeader Comment coordinateInfo pageSize fbd ld sfc scaling addDataInfo info description
    types dataTypes dataType baseType initialValue pous pou interface returnType localVars tempVars inputVars outputVars
    inOutVars externalVars globalVars accessVars configVars actions action transitions transition body instances
    configurations configuration resource task pouInstance addData data documentation simpleValue arrayValue structValue
    value IL ST FBD LD SFC variable type accessVariable configVariable position connection connectionPointIn
    connectionPointOut connectionPointOutAction relPosition expression array dimension derived enum values struct
    subrangeSigned subrangeUnsigned range pointer string wstring comment content error connector continuation
    actionBlock reference inline vendorElement alternativeText inputVariables inOutVariables outputVariables block
    inVariable outVariable inOutVariable label jump return leftPowerRail rightPowerRail coil contact step macroStep
    jumpStep condition selectionDivergence selectionConvergence simultaneousDivergence simultaneousConvergence
    BOOL BYTE WORD DWORD LWORD SINT INT DINT LINT USINT UINT UDINT ULINT REAL LREAL TIME DATE DT TOD ANY ANY_DERIVED
    ANY_ELEMENTARY ANY_MAGNITUDE ANY_NUM ANY_REAL ANY_INT ANY_BIT ANY_STRING ANY_DATE
    """.split()
)
"""All element names of TC6 2.01; 1.01 uses a subset."""

NO_TIME = "1970-01-01T00:00:00"
"""Stands in a file whose model does not say when it was made: the schema wants a time."""
