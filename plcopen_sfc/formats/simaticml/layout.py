"""Where TIA Portal shows the objects of a PLC; exports of Openness have folders of the same names."""

from __future__ import annotations

from plcopen_sfc.formats.simaticml.project_reader import PRODUCT
from plcopen_sfc.formats.simaticml.versions import DEFAULT
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import FileHeader, Project, TagTable
from plcopen_sfc.model.project_object import ProjectObject
from plcopen_sfc.model.types import DataTypeDeclaration

BLOCKS = "Program blocks"
TYPES = "PLC data types"
TAGS = "PLC tags"


def new_document(version: str) -> Project:
    """A document without objects, of a version of TIA Portal (empty: the usual)."""
    return Project(dialect=Dialect.SCL, header=FileHeader(product=PRODUCT, version=version or DEFAULT.name))


def standard_folder(thing: ProjectObject) -> str:
    """The folder for an object that has none yet."""
    if isinstance(thing, TagTable):
        return TAGS
    return TYPES if isinstance(thing, DataTypeDeclaration) else BLOCKS
