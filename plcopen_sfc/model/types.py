"""IEC 61131-3 data types and initial values."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from plcopen_sfc.model.base import Element, ExtensionData, Model
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.owners import Owned, OwnedName
from plcopen_sfc.model.text import Text


class Elementary(StrEnum):
    """Elementary and generic types by their IEC 61131-3 names (ed. 3, tables 10 and 9)."""

    BOOL = "BOOL"
    BYTE = "BYTE"
    WORD = "WORD"
    DWORD = "DWORD"
    LWORD = "LWORD"
    SINT = "SINT"
    INT = "INT"
    DINT = "DINT"
    LINT = "LINT"
    USINT = "USINT"
    UINT = "UINT"
    UDINT = "UDINT"
    ULINT = "ULINT"
    REAL = "REAL"
    LREAL = "LREAL"
    TIME = "TIME"
    LTIME = "LTIME"
    DATE = "DATE"
    LDATE = "LDATE"
    TOD = "TOD"
    LTOD = "LTOD"
    DT = "DT"
    LDT = "LDT"
    CHAR = "CHAR"
    WCHAR = "WCHAR"
    ANY = "ANY"
    ANY_DERIVED = "ANY_DERIVED"
    ANY_ELEMENTARY = "ANY_ELEMENTARY"
    ANY_MAGNITUDE = "ANY_MAGNITUDE"
    ANY_NUM = "ANY_NUM"
    ANY_REAL = "ANY_REAL"
    ANY_INT = "ANY_INT"
    ANY_BIT = "ANY_BIT"
    ANY_STRING = "ANY_STRING"
    ANY_DATE = "ANY_DATE"


class ElementaryType(Model):
    """An elementary type such as ``BOOL``."""

    kind: Literal["elementary"] = "elementary"
    name: Elementary


class StringType(Model):
    """``STRING`` or ``WSTRING``. `length` is a literal or a constant's name, None for the tool's default."""

    kind: Literal["string"] = "string"
    wide: bool = False
    length: str | None = None


class DerivedType(Model):
    """A user type, a function block or a type this model does not list, by name."""

    kind: Literal["derived"] = "derived"
    name: str
    extension_data: ExtensionData | None = None


class Dimension(Model):
    """One dimension of an array or the bounds of a subrange: literals or constant names, both ends included."""

    lower: str
    upper: str


class ArrayType(Owned):
    """``ARRAY [..] OF base``."""

    kind: Literal["array"] = "array"
    dimensions: list[Dimension]
    base: DataType

    OWNS: ClassVar[tuple[str, ...]] = ("base",)


class StructType(Owned):
    """``STRUCT`` with its members."""

    kind: Literal["struct"] = "struct"
    members: list[Variable] = Field(default_factory=list)
    comment: Text | None = None
    extension_data: ExtensionData | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("members",)


class EnumValue(OwnedName):
    """One name of an enumeration, with its value where the file states one."""

    name: str
    value: str | None = None


class EnumType(Owned):
    """An enumeration."""

    kind: Literal["enum"] = "enum"
    values: list[EnumValue] = Field(default_factory=list)
    base: DataType | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("values",)


class SubrangeType(Model):
    """A subrange of an integer type."""

    kind: Literal["subrange"] = "subrange"
    bounds: Dimension
    base: DataType
    unsigned: bool = False


class PointerType(Owned):
    """A pointer (CODESYS ``POINTER TO``) or, with `reference`, an IEC ``REF_TO``."""

    kind: Literal["pointer"] = "pointer"
    base: DataType
    reference: bool = False

    OWNS: ClassVar[tuple[str, ...]] = ("base",)


def _named_type(value: Any) -> Any:
    """Accept ``type="BOOL"`` and ``type="MyStruct"``."""
    if not isinstance(value, str):
        return value
    upper = value.upper()
    if upper in Elementary.__members__:
        return {"kind": "elementary", "name": upper}
    if upper in ("STRING", "WSTRING"):
        return {"kind": "string", "wide": upper == "WSTRING"}
    return {"kind": "derived", "name": value}


DataType = Annotated[
    Annotated[
        ElementaryType | StringType | DerivedType | ArrayType | StructType | EnumType | SubrangeType | PointerType,
        Field(discriminator="kind"),
    ],
    BeforeValidator(_named_type),
]
"""Any data type. In Python a plain name is accepted for an elementary or a user type: ``Variable(type="BOOL")``."""


class SimpleValue(Model):
    """One literal or expression. None: the file has the place for a value but no value in it."""

    kind: Literal["simple"] = "simple"
    text: str | None = None


class RepeatedValue(Model):
    """A value of an array initialisation and how often it is repeated (``3(0)``)."""

    value: Value
    repetitions: str | None = None


class ArrayValue(Model):
    """``[1, 2, 3(0)]``."""

    kind: Literal["array"] = "array"
    items: list[RepeatedValue] = Field(default_factory=list)


class MemberValue(Model):
    """``member := value``."""

    member: str
    value: Value


class StructValue(Model):
    """``(a := 1, b := 2)``."""

    kind: Literal["struct"] = "struct"
    members: list[MemberValue] = Field(default_factory=list)


def _literal(value: Any) -> Any:
    return {"kind": "simple", "text": value} if isinstance(value, str) else value


Value = Annotated[
    Annotated[SimpleValue | ArrayValue | StructValue, Field(discriminator="kind")],
    BeforeValidator(_literal),
]
"""An initial value. In Python a plain string is accepted for a literal: ``Variable(initial="T#5s")``."""


class Variable(OwnedName, Element):
    """A declared variable or a member of a structure.

    `attributes` are other properties that a tool gives it, by name and as text: ``Remanence``, ``Accessibility``,
    ``ExternalVisible`` .. (TIA Portal).
    """

    name: str
    type: DataType
    address: str | None = None
    initial: Value | None = None
    attributes: dict[str, str] = Field(default_factory=dict)

    OWNS: ClassVar[tuple[str, ...]] = ("type",)


def element_type(kind: DataType) -> DataType:
    """Return the type of the elements of an array, also of arrays; any other type as it is."""
    while isinstance(kind, ArrayType):
        kind = kind.base
    return kind


def used_types(kind: DataType) -> list[str]:
    """Return the names of the types that a type names."""
    if isinstance(kind, DerivedType):
        return [kind.name]
    if isinstance(kind, ArrayType | PointerType):
        return used_types(kind.base)
    return [name for member in getattr(kind, "members", []) for name in used_types(member.type)]


class DataTypeDeclaration(ProjectObject):
    """``TYPE name : type := initial; END_TYPE``.

    `place` is where the declaration is, as `Pou.place` does.
    """

    kind_in_reports: ClassVar[str] = "type"
    OWNS: ClassVar[tuple[str, ...]] = ("type",)

    title: Text | None = None
    type: DataType
    initial: Value | None = None
    place: str = ""
    declaration: str | None = None
    object_id: str | None = None
