"""SimaticML: read, write, and the tree for patching."""

from __future__ import annotations

from lxml import etree
from pydantic import ValidationError

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.formats.base import Reading, WriteOptions
from plcopen_sfc.formats.simaticml import adapting, layout, normalizing
from plcopen_sfc.formats.simaticml.bodies_reader import misfit
from plcopen_sfc.formats.simaticml.fitting import fit_alarms
from plcopen_sfc.formats.simaticml.project_reader import PRODUCT, SCHEMA, find_version, read_project
from plcopen_sfc.formats.simaticml.project_writer import write_project
from plcopen_sfc.formats.simaticml.reading import local
from plcopen_sfc.formats.simaticml.versions import DEFAULT, TiaVersion, version_like
from plcopen_sfc.formats.xml import writing
from plcopen_sfc.formats.xml.source import SourceLines, parse
from plcopen_sfc.formats.xml.writing import XmlStyle
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport

standard_folder = layout.standard_folder
new_document = layout.new_document


def read(data: bytes, *, file: str | None = None) -> Reading:
    """Read a document of TIA Portal Openness. Raises `FormatError`."""
    with collector_paused():
        root = parse(data, file=file)
        version = find_version(root, file=file)
        fields, diagnostics = read_project(root, version, data, file=file)
        try:
            project = Project.model_validate(fields)
        except ValidationError as error:
            raise misfit(error, file) from error
    return Reading(project, diagnostics, version.name)


def adapt(project: Project, options: WriteOptions, report: ConversionReport) -> None:
    """Make of `project`, a copy, what this format makes of it."""
    if not options.same:
        if project.header.product == PRODUCT and options.version:
            project.header.version = options.version
        kept = project.carried.attributes if project.carried is not None else {}
        for name in [name for name in kept if name.startswith(SCHEMA)]:
            del kept[name]
        for chart in project.charts():
            fit_alarms(chart.network, _version(project, options))
    version = _version(project, options)
    adapting.adapt(project, report)
    if not project.header.product:  # a project made in Python: nothing is lost when the file says who reads it
        project.header.product, project.header.version = PRODUCT, version.name


def lines(content: bytes, project: Project) -> dict[str, int]:
    """The lines of the blocks of `project`, their steps and transitions in the file `content`.

    They are by the paths that the report gives them.
    """
    found: dict[str, int] = {}
    names = {pou.name for pou in project.pous}
    root = parse(content)
    line_of = SourceLines(root, content).line
    for element in root.iter("{*}Name"):
        holder = element.getparent()
        owner = holder.getparent() if holder is not None else None
        if owner is not None and element.text in names and local(owner).startswith("SW.Blocks."):
            path = f"POU {element.text}"
            found.setdefault(path, line_of(owner) or 1)
            for kind in ("Step", "Transition"):
                for part in owner.iter(f"{{*}}{kind}"):
                    found.setdefault(f"{path} / {kind.lower()} {part.get('Name')}", line_of(part) or 1)
    return found


def to_tree(project: Project, options: WriteOptions, report: ConversionReport) -> etree._Element:
    """The tree of the document for `project`."""
    return write_project(project, _version(project, options), report, options)


def _version(project: Project, options: WriteOptions) -> TiaVersion:
    """The version to write."""
    given = options.version or (project.header.version if project.header.product == PRODUCT else "")
    return version_like(given) or DEFAULT


def style(_project: Project, _options: WriteOptions) -> XmlStyle:
    """As TIA Portal writes: UTF-8 with a mark, CRLF, two blanks, ``<a />``."""
    return _STYLE


_STYLE = XmlStyle(encoding="utf-8", bom=True, newline="\r\n", self_closing=" />")


def normalize(data: bytes) -> bytes:
    """The document without what an import does not look at."""
    return normalizing.normalize(data, _STYLE)


def write(project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
    """Write a document anew."""
    return writing.write(to_tree(project, options, report), style(project, options))
