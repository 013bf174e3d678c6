"""The jobs measured: for each contestant what it prepares from the path of a file, and what it then does with that."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from functools import cache
from importlib import import_module
from io import BytesIO
from pathlib import Path
from typing import Any

from lxml import etree

import plcopen_sfc as sfc
from benchmarks import structured_text
from plcopen_sfc.documents.sources import FolderSource
from plcopen_sfc.formats.file_recognition import recognise
from plcopen_sfc.formats.xml.schema_validation import schema_path
from plcopen_sfc.model import Project

SHARED = Path(__file__).resolve().parents[2] / "shared"
OFFICIAL = {
    b"http://www.plcopen.org/xml/tc6_0200": "tc6_xml_v200.xsd",
    b"http://www.plcopen.org/xml/tc6_0201": "tc6_xml_v201.xsd",
}


def parse_lxml(path: Path) -> Any:
    """The tree of lxml, and nothing done with it."""
    return etree.parse(path)


def load(path: Path) -> Project:
    """`load`: everything but the charts, which are read when somebody looks at them."""
    return sfc.load(path)


def load_charts(path: Path) -> Project:
    """`load`, and look at the steps of every chart; their drawings stay unread."""
    project = sfc.load(path)
    for chart in project.charts():
        _ = chart.chart.steps
    return project


def load_all(path: Path) -> Project:
    """`load`, and read every object, chart and drawing."""
    project = sfc.load(path)
    project.read_all()
    return project


def parse_folder(path: Path) -> int:
    """The trees of lxml of all documents below a folder, one after the other."""
    return sum(len(etree.parse(each).getroot()) for each in sorted(path.rglob("*.xml")))


def copy_folder(path: Path) -> Project:
    """A project read from a copy of a folder beside it, into which it can be saved."""
    copy = path.with_name(f"{path.name} copy")
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(path, copy)
    return sfc.load(copy)


def save_home(project: Project) -> list[str]:
    """`save` into the folder that the project was read from."""
    origin = project.source
    return sfc.save(project, origin.path).written if isinstance(origin, FolderSource) else []


def rename_and_save_home(project: Project) -> list[str]:
    """`save_home` after one step of one chart got another name: a document of all is written."""
    chart = next(pou.sfc for pou in project.pous if pou.name.startswith("FB_Drill") and pou.sfc is not None)
    chart.rename_step(chart.steps[0].name or "", "Renamed")
    return save_home(project)


def steps_of(project: Project) -> int:
    """How many steps the charts have."""
    return sum(len(chart.chart.steps) for chart in project.charts())


def steps_in_tree(tree: Any) -> int:
    """How many elements ``step`` a file has, wherever they stand."""
    return sum(1 for _ in tree.iter("{*}step"))


@cache
def _xsdata() -> tuple[Any, type]:
    parsers = import_module("xsdata.formats.dataclass.parsers")
    contexts = import_module("xsdata.formats.dataclass.context")
    return parsers.XmlParser(context=contexts.XmlContext()), import_module("plcopen").Project


def has_xsdata() -> bool:
    """Whether the packages `plcopen` and `xsdata` are installed."""
    try:
        _xsdata()
    except ImportError:
        return False
    return True


def for_xsdata(path: Path) -> bytes:
    """The content of a file as the classes of the package `plcopen` can read all of it. Not measured.

    They know TC6 2.01 only, so a file of 2.0 is presented as one of 2.01. They do not look for the POUs that CODESYS
    and TwinCAT hide in ``addData``, so these are moved to where TC6 has them.
    """
    content = path.read_bytes().replace(b"tc6_0200", b"tc6_0201")
    root = etree.fromstring(content, etree.XMLParser(huge_tree=True))
    tc6 = "{http://www.plcopen.org/xml/tc6_0201}"
    pous = root.find(f"{tc6}types/{tc6}pous")
    hidden = list(root.iterfind(f".//{tc6}data/{tc6}pou"))
    if pous is not None and hidden:
        pous.extend(hidden)
        content = etree.tostring(root)
    return content


def parse_xsdata(content: bytes) -> Any:
    """The objects of the package `plcopen`, read by xsdata as its README says."""
    parser, project = _xsdata()
    return parser.from_bytes(content, project)


def steps_of_xsdata(found: object) -> tuple[int, int]:
    """How many steps xsdata found anywhere in its objects: as objects of their class, and as elements of no class."""
    typed, untyped, heap, seen = 0, 0, [found], set()
    while heap:
        each = heap.pop()
        if isinstance(each, list | tuple):
            heap.extend(each)
        elif hasattr(each, "__dataclass_fields__") and id(each) not in seen:
            seen.add(id(each))
            typed += type(each).__qualname__.endswith("Sfc.Step")
            untyped += str(getattr(each, "qname", "")).endswith("}step")
            heap.extend(vars(each).values())
    return typed, untyped


def official_schema(path: Path) -> Path | None:
    """The published schema for a file; None where it is not at hand (``$PLCOPEN_SFC_XSD``, ``../shared/xsd``)."""
    with path.open("rb") as file:
        head = file.read(4096)
    name = next((name for namespace, name in OFFICIAL.items() if namespace in head), "none")
    schema = Path(os.environ.get("PLCOPEN_SFC_XSD") or SHARED / "xsd") / "plcopen" / name
    return schema if schema.is_file() else None


def our_schema(path: Path) -> Path:
    """Our schema of the version of TC6 that a file has, without the payloads of tools."""
    with path.open("rb") as file:
        head = file.read(4096)
    return schema_path("plcopen-2.0" if b"tc6_0200" in head else "plcopen-2.01")


def compile_schema(path: Path) -> tuple[etree.XMLSchema, Path]:
    """The compiled schema for a file: the published one, or else ours."""
    return etree.XMLSchema(etree.parse(official_schema(path) or our_schema(path))), path


def validate_libxml2(schema_and_path: tuple[etree.XMLSchema, Path]) -> bool:
    """Parsing, and libxml2's own validator."""
    schema, path = schema_and_path
    return schema.validate(etree.parse(path))


def validate(path: Path) -> list[Any]:
    """Our validation: what ``plcopen-sfc validate`` asks the schema of the file's format."""
    data = path.read_bytes()
    return recognise(data).codec().validate(data)


def write_lxml(tree: Any) -> bytes:
    """The bytes of a tree."""
    return etree.tostring(tree, encoding="utf-8", xml_declaration=True)


def save(project: Project) -> int:
    """`save`, into memory."""
    file = BytesIO()
    sfc.save(project, file)
    return file.tell()


def rename_and_save(project: Project) -> int:
    """`save` after a step of the first chart got another name."""
    chart = next(iter(project.charts())).chart
    chart.rename_step(chart.steps[0].name or "", "Renamed")
    return save(project)


def comment_and_save(project: Project) -> int:
    """`save` after a step of the first chart got a comment."""
    next(iter(project.charts())).chart.steps[-1].comment = "edited"
    return save(project)


def _itself(path: Path) -> Path:
    return path


JOBS: dict[str, tuple[Callable[[Path], Any], Callable[[Any], Any]]] = {
    "lxml": (_itself, parse_lxml),
    "load": (_itself, load),
    "load_charts": (_itself, load_charts),
    "load_all": (_itself, load_all),
    "xsdata": (for_xsdata, parse_xsdata),
    "tostring": (parse_lxml, write_lxml),
    "save": (load, save),
    "save_all": (load_all, save),
    "comment": (load, comment_and_save),
    "rename": (load, rename_and_save),
    "rename_all": (load_all, rename_and_save),
    "lxml_folder": (_itself, parse_folder),
    "save_home": (copy_folder, save_home),
    "rename_home": (copy_folder, rename_and_save_home),
    "libxml2": (compile_schema, validate_libxml2),
    "validate": (_itself, validate),
    "st": (structured_text.read, structured_text.parse),
    "st_anew": (structured_text.read, structured_text.parse_anew),
    "st_blark": (structured_text.for_blark, structured_text.parse_blark),
}
"""The contestants: what is prepared, and what is measured."""
