"""Files of PLC projects of TwinCAT 3 in the table of formats: read, write and patch them."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from pathlib import PurePosixPath

from lxml import etree

from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.twincat.object_files import adapted_task, read_object, task_document, write_object
from plcopen_sfc.formats.xml.source_patch import patch_xml
from plcopen_sfc.formats.xml.xml_codec import FolderCodec, ProjectPart, XmlStyle, write_xml
from plcopen_sfc.formats.xml.xml_parsing import parse_xml
from plcopen_sfc.languages.s7_boxes import put_logic
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataTypeDeclaration
from plcopen_sfc.model.variables import VariableSection
from plcopen_sfc.report import ConversionReport

_INDENT = "  "


class TwincatCodec(FolderCodec):
    """Files of TwinCAT 3 with one object each."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file. Raises `FormatError`."""
        return read_object(data, file=file)

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Replace flip-flop boxes with an operand, which only TIA Portal has, by logic."""
        put_logic(project, report)

    def to_tree(self, project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
        """Return the tree of the file for `project`."""
        return write_object(project, options, report)

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a file from the model alone."""
        root = self.to_tree(project, options, report)
        # archives are marked as preserving blanks, and the tool indents them all the same
        etree.indent(root, _INDENT)
        return write_xml(root, self.style())

    def style(self) -> XmlStyle:
        """As TwinCAT writes: UTF-8 with a mark, CRLF, two blanks, ``<a />``."""
        return XmlStyle(encoding="utf-8", bom=True, newline="\r\n", indent=None, self_closing=" />")

    def standard_folder(self, thing: ProjectObject) -> str:
        """Return the folder in which TwinCAT puts an object of this kind."""
        return "DUTs" if isinstance(thing, DataTypeDeclaration) else "POUs"

    def listed(self, data: bytes, *, file: str | None = None) -> list[str]:
        """Return the files that a ``.plcproj`` compiles."""
        return [_path_in(each) for each in parse_xml(data, file=file).iterfind("{*}ItemGroup/{*}Compile")]

    def relisted(self, data: bytes, added: Sequence[str], gone: Sequence[str]) -> bytes:
        """Return a ``.plcproj`` that compiles other files, and lists their folders."""
        before = parse_xml(data)
        after = copy.deepcopy(before)
        space = str(after.tag)[: str(after.tag).rfind("}") + 1]
        compiled = list(after.iterfind("{*}ItemGroup/{*}Compile"))
        group = compiled[-1].getparent() if compiled else None
        without = {name.casefold() for name in gone}
        for each in compiled:
            holder = each.getparent()
            if _path_in(each).casefold() in without and holder is not None:
                holder.remove(each)
        if group is None:
            group = etree.SubElement(after, f"{space}ItemGroup")
        for name in added:
            entry = etree.SubElement(group, f"{space}Compile", Include=name.replace("/", "\\"))
            etree.SubElement(entry, f"{space}SubType").text = "Code"
        folders = list(after.iterfind("{*}ItemGroup/{*}Folder"))
        known = {_path_in(each).casefold() for each in folders}
        wanted = {str(PurePosixPath(name).parent) for name in added} - {"."}
        for name in sorted(folder for folder in wanted if folder.casefold() not in known):
            holder = folders[-1].getparent() if folders else etree.SubElement(after, f"{space}ItemGroup")
            if holder is not None:
                folders.append(etree.SubElement(holder, f"{space}Folder", Include=name.replace("/", "\\")))
        return patch_xml(data, before, after)

    def parts(self, project: Project) -> list[ProjectPart]:
        """Return the lists of global variables and the tasks of `project`."""
        lists: dict[str, list[VariableSection]] = {}
        for section in project.global_variables:
            lists.setdefault(section.name or "", []).append(section)
        found = [
            ProjectPart(name, "GVLs", Project(global_variables=sections, dialect=Dialect.CODESYS))
            for name, sections in lists.items()
        ]
        tasks = [task for resource in project.applications for task in resource.tasks]
        return found + [ProjectPart(task.name, "", task_document(task)) for task in tasks]

    def join(self, project: Project) -> None:
        """Put the tasks of several files into one application."""
        tasks = [task for resource in project.applications for task in resource.tasks]
        project.applications = task_document(*tasks).applications if tasks else []

    def extension(self, document: Project) -> str:
        """Return the extension of the file for a document."""
        kinds = {".TcDUT": document.data_types, ".TcGVL": document.global_variables, ".TcTTO": document.applications}
        return next((extension for extension, found in kinds.items() if found), ".TcPOU")

    def new_document(self, version: str) -> Project:
        """Return a project without objects."""
        return Project(dialect=Dialect.CODESYS)

    def adapt(self, project: Project, options: WriteOptions, report: ConversionReport) -> None:
        """Take out of `project`, a copy, what files of objects do not hold, such as how the project is filed."""
        if options.same:
            return
        project.global_variables = list(project.global_sections())
        tasks = [adapted_task(task, report) for resource in project.resources() for task in resource.tasks]
        project.applications = task_document(*(task for task in tasks if task is not None)).applications
        for section in project.global_variables:
            section.name = section.name or "GVL"
        plain = self.new_document("")
        for name in Project.model_fields:
            if name not in ("pous", "data_types", "global_variables", "applications"):
                setattr(project, name, getattr(plain, name))


def _path_in(element: etree._Element) -> str:
    """Return the path that an element of a ``.plcproj`` names, with ``/``."""
    return str(element.get("Include", "")).replace("\\", "/")


CODEC = TwincatCodec()
