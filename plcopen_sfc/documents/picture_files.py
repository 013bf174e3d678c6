"""Pictures of the charts and networks of a project in files: SVG, PNG and PDF of it, Mermaid and Graphviz."""

from __future__ import annotations

import os
import re
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

from plcopen_sfc.documents.folder_documents import FileNames
from plcopen_sfc.drawing.pictures import Theme, body_svg, chart_svg, dot_text, mermaid_text, sheets
from plcopen_sfc.errors import ModelError, SfcError, check_argument, nearest
from plcopen_sfc.files import folder_exists, refuse_empty, write_all
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.pou import NamedBody
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody

PICTURE_FORMATS = {"svg": ".svg", "png": ".png", "pdf": ".pdf", "mermaid": ".mmd", "dot": ".dot"}
"""The formats of pictures and their extensions."""
_DEFAULT = "svg"
_SHOWN = 20
_SIZE = re.compile(r' width="(\d+)" height="(\d+)"')
_OVERLINED = re.compile(r"(?:(?:[^<>&;]|&#\d+;)&#773;)+(?=[^<>]*</)")
"""Negated names of a GRAFCET in the text of a picture: cairo takes no other font for a sign that Arial may not have."""
_TEXT = re.compile(r"<text [^>]*>([^<]*)")
_LETTER = re.compile(r"&#(\d{3,});")
_PNG_PIXELS = 32_000
"""The images of cairo have at most 32 767 rows and columns."""
_PNG_SCALE = 2.0
_PDF_PIXELS = 19_200
"""The pages of Acrobat have at most 14 400 points, of which 72 are 96 pixels."""


class PictureFile(NamedTuple):
    """A picture in a file: the `name` of its chart or of its body in FBD or LD (``Main.Fill``) and the `path`.

    `missing`: letters that the font of this machine does not have. They are boxes in a PNG or PDF. `scale`: pixels for
    each of the SVG, below 1 where a PNG or PDF is made smaller because programs could not show it else.
    """

    name: str
    path: Path
    missing: str = ""
    scale: float = 1.0


def draw(
    project: Project,
    target: str | os.PathLike[str],
    *,
    pou: str | None = None,
    style: str | None = None,
    theme: str = Theme.LIGHT,
    format: str | None = None,
    paper: str | None = None,
    fresh: bool = False,
) -> list[PictureFile]:
    """Draw the charts and the bodies in FBD and LD of a project into files, or what is called `pou` of them.

    `pou` is ``Main``, or of an action ``Main.Fill``; without it bodies are drawn where the project has no charts.
    `target` is a file for one picture, or a folder, which exists or ends in a slash; there each picture has the name
    of its chart. `style`, `theme` and `fresh` as in `SfcNetwork.to_svg`. `format` is ``svg``, ``png`` (two pixels for
    one of the SVG), ``pdf`` (pages of the size of the picture), or a text for a program that draws graphs, without
    style and theme: ``mermaid`` or ``dot``. The default is by the extension of a file, else ``svg``. `paper` is
    ``A4``, ``A3`` or ``letter``: a picture that is larger is divided into sheets, the pages of a PDF, else
    files of their own (``Main-1``, ``Main-2`` ..). PNG and PDF need the extra ``pictures``. All pictures are written or
    none. Raises `ModelError` where there is no such chart, format, style, theme or paper, or several charts for one
    file, `SfcError` where the extra is missing, and `FileAccessError`.
    """
    check_argument(project, Project, "draw needs a project", "A chart draws itself: chart.to_svg().")
    check_argument(target, (str, os.PathLike), "draw needs the path of a file or a folder")
    path = os.fspath(target)
    refuse_empty(path)
    check_argument(pou, (str, type(None)), "a chart is named by a text")
    kind = _format(path, format)
    charts = drawn_bodies(project, pou, kind)
    paths = _paths(charts, path, PICTURE_FORMATS[kind])
    pairs = list(zip(charts, paths, strict=True))
    contents: dict[Path, bytes] = {}
    drawn = []
    for named, whole in pairs:
        data, missing, scale = _pictures(named, kind, style, theme, paper, fresh=fresh)
        files = _numbered(whole, data)
        contents |= files
        drawn += [PictureFile(named.name, file, missing, scale) for file, _ in files]
    write_all(contents)
    return drawn


def _numbered(path: Path, data: list[bytes]) -> list[tuple[Path, bytes]]:
    """Return the file of each sheet of a picture; the only one has its name."""
    if len(data) == 1:
        return [(path, data[0])]
    return [(path.with_name(f"{path.stem}-{at}{path.suffix}"), each) for at, each in enumerate(data, start=1)]


def _format(path: str, wanted: str | None) -> str:
    if wanted is None:
        extension = Path(path).suffix.lower()
        return next((kind for kind, each in PICTURE_FORMATS.items() if each == extension), _DEFAULT)
    check_argument(wanted, str, "the format of a picture is a text")
    if wanted.lower() not in PICTURE_FORMATS:
        hint = "There are: " + ", ".join(PICTURE_FORMATS)
        raise ModelError(f"there is no format {wanted!r} of pictures{nearest(wanted, PICTURE_FORMATS)}", hint=hint)
    return wanted.lower()


def _pictures(
    named: NamedBody, kind: str, style: str | None, theme: str, paper: str | None, *, fresh: bool
) -> tuple[list[bytes], str, float]:
    """Return a picture as the content of a file, or of one for each sheet, with its missing letters and its scale."""
    body = named.body
    if kind in _TEXTS and isinstance(body, SfcBody):
        return [_TEXTS[kind](body.chart).encode("utf-8")], "", 1.0
    if isinstance(body, SfcBody):
        svg = chart_svg(body.chart, style, theme, fresh=fresh)
    elif isinstance(body, FbdBody | LdBody):
        svg = body_svg(body, theme, named.name)
    parts = sheets(svg, paper) if paper is not None else [svg]
    if kind == "svg":
        return [each.encode("ascii") for each in parts], "", 1.0
    try:
        from cairosvg import surface as cairo_svg  # noqa: PLC0415  # an extra
    except (ImportError, OSError) as error:  # OSError: its library cairo is not on this machine
        missing = "CairoSVG" if isinstance(error, ImportError) else "the library cairo, which CairoSVG uses,"
        hint = "pip install plcopen-sfc[pictures]; on Windows cairo comes with GTK. SVG needs neither."
        raise SfcError(f"{missing} is missing: {kind.upper()} cannot be written", hint=hint) from None
    missing = _missing(cairo_svg.cairo, svg)
    parts = [_OVERLINED.sub(r'<tspan font-family="DejaVu Sans">\g<0></tspan>', each) for each in parts]
    usual, most = (1.0, _PDF_PIXELS) if kind == "pdf" else (_PNG_SCALE, _PNG_PIXELS)
    scales = [_scale(each, usual, most) for each in parts]
    if kind == "pdf":
        return [_pdf(cairo_svg, parts, scales)], missing, min(scales)
    made = (
        cairo_svg.PNGSurface.convert(each.encode("ascii"), scale=scale)
        for each, scale in zip(parts, scales, strict=True)
    )
    return list(made), missing, min(scales)


def _missing(cairo: Any, svg: str) -> str:
    """Return the letters of a picture that cairo shows as boxes: it takes no other font than that of the picture."""
    context = cairo.Context(cairo.ImageSurface(cairo.FORMAT_A8, 1, 1))
    context.select_font_face("Arial")
    font = context.get_scaled_font()
    texts = "".join(_TEXT.findall(_OVERLINED.sub("", svg)))
    letters = sorted({chr(int(number)) for number in _LETTER.findall(texts)})
    return "".join(letter for letter in letters if not font.text_to_glyphs(0, 0, letter, False)[0][0])


def _scale(svg: str, usual: float, most: int) -> float:
    """Return by how much a picture is enlarged so that it has at most so many pixels."""
    size = _SIZE.search(svg)
    return min(usual, most / max(map(int, size.groups()))) if size is not None else usual


_NO_DATE = "2000-01-01T00:00:00"


def _pdf(cairo_svg: Any, parts: list[str], scales: list[float]) -> bytes:
    """Return a PDF with a page for each picture, of its size."""
    output = BytesIO()
    document = cairo_svg.cairo.PDFSurface(output, 1, 1)
    document.set_metadata(cairo_svg.cairo.PDF_METADATA_CREATE_DATE, _NO_DATE)  # the same bytes in every run

    def page(_: object, width: float, height: float) -> Any:
        document.set_size(width, height)
        return document

    class Page(cairo_svg.PDFSurface):  # type: ignore[misc]  # the extra has no types
        surface_class = staticmethod(page)

    for part, scale in zip(parts, scales, strict=True):
        tree = cairo_svg.Tree(bytestring=part.encode("ascii"))
        Page(tree, None, 96, scale=scale)
        document.show_page()
    document.finish()
    return output.getvalue()


_TEXTS = {"mermaid": mermaid_text, "dot": dot_text}


def drawn_bodies(project: Project, pou: str | None, kind: str = _DEFAULT) -> list[NamedBody]:
    """Return the things that `draw` draws: what is called `pou`, else all charts, else all bodies in FBD and LD."""
    project.read_all()
    drawable = SfcBody if kind in _TEXTS else SfcBody | FbdBody | LdBody
    bodies = [found for found in project.bodies() if isinstance(found.body, drawable)]
    names = list(dict.fromkeys(each.name for each in bodies))
    listed = ", ".join(names[:_SHOWN]) + (" .." if len(names) > _SHOWN else "")
    if not bodies:
        raise ModelError("the project has no chart to draw" + ("" if kind in _TEXTS else ", and nothing in FBD or LD"))
    if pou is None:
        return [each for each in bodies if isinstance(each.body, SfcBody)] or bodies
    chosen = [each for each in bodies if each.name.casefold() == pou.casefold()]
    if not chosen:
        raise ModelError(f"the project has no chart {pou!r}{nearest(pou, names)}", hint=f"It has: {listed}")
    return chosen


def _paths(charts: list[NamedBody], path: str, extension: str) -> list[Path]:
    """Return the file of each chart."""
    if path.endswith(("/", os.sep)) or folder_exists(path):
        names = FileNames()
        return [Path(path, names.free("", each.name, extension)) for each in charts]
    if len(charts) > 1:
        hint = "Name a folder (pictures/), or one of the charts."
        what = "charts" if isinstance(charts[0].body, SfcBody) else "bodies"
        raise ModelError(f"{len(charts)} {what} do not fit into one picture", hint=hint)
    return [Path(path)]
