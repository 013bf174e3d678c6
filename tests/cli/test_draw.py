"""``plcopen-sfc draw``: one chart or all, to a file, a folder or standard output."""

from __future__ import annotations

import io
import json
import re
import shutil
import struct
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import plcopen_sfc as sfc
from tests.drawing.nets import make


def test_the_default_is_beside_the_source(cli, fixtures, tmp_path):
    source = shutil.copy(fixtures / "iectext" / "mixing_plant.st", tmp_path)
    outcome = cli("draw", source)
    picture = tmp_path / "mixing_plant.svg"
    assert (outcome.code, outcome.out) == (0, f"written: {picture}\n")
    assert picture.read_text(encoding="ascii") == sfc.load(source).pou("Mixer").chart.to_svg()


def test_several_charts_are_a_folder(cli, fixtures, tmp_path):
    source = shutil.copy(fixtures / "codesys" / "sorting_conveyor.xml", tmp_path)
    outcome = cli("draw", source)
    folder = tmp_path / "sorting_conveyor-charts"
    assert outcome.out == f"written: {folder}/, 3 pictures\n"
    assert {path.name for path in folder.iterdir()} == {"PLC_PRG.svg", "PLC_PRG.ACT_Home.svg", "FB_Pusher.svg"}
    assert cli("draw", source, f"{tmp_path}/other/", "--quiet").out == ""
    assert len(list((tmp_path / "other").iterdir())) == 3


def test_one_of_several(cli, fixtures, tmp_path):
    target = tmp_path / "home.svg"
    assert cli("draw", "codesys/sorting_conveyor.xml", target, "--pou", "plc_prg.act_home").code == 0
    assert "<title>PLC_PRG.ACT_Home</title>" in target.read_text(encoding="ascii")


def test_options_choose_style_and_theme(cli, fixtures):
    chart = sfc.load("simaticml/FB_Drill.xml").pou("FB_Drill").chart
    outcome = cli("draw", "simaticml/FB_Drill.xml", "-", "--style", "grafcet", "--theme", "print")
    assert outcome.out == chart.to_svg(style="grafcet", theme="print")


def test_standard_streams(cli, fixtures, monkeypatch):
    data = Path("iectext/mixing_plant.st").read_bytes()
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(data)))
    outcome = cli("draw", "-")
    assert outcome.code == 0
    assert outcome.out == sfc.loads(data).pou("Mixer").chart.to_svg()


def test_json_lists_the_pictures(cli, fixtures, tmp_path):
    outcome = cli("draw", "iectext/mixing_plant.st", f"{tmp_path}/", "--json")
    file = str(tmp_path / "Mixer.svg")
    assert json.loads(outcome.out) == {
        "file": "iectext/mixing_plant.st",
        "pictures": [{"chart": "Mixer", "file": file}],
    }


@pytest.mark.slow
def test_letters_without_a_font_are_told(tmp_path: Path) -> None:
    pytest.importorskip("cairosvg")
    chart = sfc.SfcNetwork()
    chart.add_step("Größe", initial=True).comment = "\U000e0fff"  # a letter that no font will ever have
    pou = sfc.Pou(name="P", kind=sfc.PouKind.PROGRAM, bodies=[sfc.SfcBody(chart=chart)])
    project = sfc.Project(pous=[pou])
    assert [each.missing for each in sfc.draw(project, tmp_path / "x.png")] == ["\U000e0fff"]
    assert [each.missing for each in sfc.draw(project, tmp_path / "x.svg")] == [""]


@pytest.mark.slow
@pytest.mark.parametrize(("extension", "start"), [("png", b"\x89PNG"), ("pdf", b"%PDF")])
def test_other_formats(cli, fixtures, tmp_path, extension, start):
    require_cairo()
    target = tmp_path / f"x.{extension}"
    assert cli("draw", "iectext/mixing_plant.st", target).code == 0
    assert target.read_bytes().startswith(start)
    outcome = cli("draw", "codesys/sorting_conveyor.xml", f"{tmp_path}/all/", "--to", extension)
    assert outcome.code == 0
    assert {path.suffix for path in (tmp_path / "all").iterdir()} == {f".{extension}"}


@pytest.mark.slow
def test_a_pdf_has_a_page_for_each_sheet(cli, fixtures, tmp_path):
    require_cairo()
    paper = ("--pou", "PLC_PRG", "--paper", "A4")
    assert cli("draw", "codesys/sorting_conveyor.xml", f"{tmp_path}/svg/", *paper).code == 0
    assert cli("draw", "codesys/sorting_conveyor.xml", tmp_path / "x.pdf", *paper).code == 0
    sheets = len(list((tmp_path / "svg").iterdir()))
    data = (tmp_path / "x.pdf").read_bytes()
    assert re.findall(rb"/Count (\d+)", data) == [str(sheets).encode()]
    assert re.search(rb"/CreationDate \((D:)?20000101", data), "the same bytes in every run"
    assert sheets > 3


@pytest.mark.parametrize(("name", "extension"), [("mermaid", "mmd"), ("dot", "dot")])
def test_texts_for_other_programs(cli, fixtures, tmp_path, name, extension):
    piped = cli("draw", "iectext/mixing_plant.st", "-", "--to", name)
    assert piped.out.startswith({"mermaid": "flowchart TD", "dot": "digraph"}[name])
    assert cli("draw", "iectext/mixing_plant.st", tmp_path / f"x.{extension}").code == 0
    assert (tmp_path / f"x.{extension}").read_text(encoding="utf-8") == piped.out


@pytest.mark.slow
def test_long_charts_are_images_that_programs_can_show_and_draw_says_that_they_are_small(cli, tmp_path):
    require_cairo()
    chart = make(600, [([i], [(i + 1) % 600]) for i in range(600)])
    project = sfc.Project(pous=[sfc.Pou(name="A", kind=sfc.PouKind.PROGRAM, bodies=[sfc.SfcBody(chart=chart)])])
    sfc.save(project, tmp_path / "a.json")
    outcome = cli("draw", tmp_path / "a.json", tmp_path / "x.png")
    assert re.search(r"A is too long for one image, and drawn at \d\d%: .* --paper A4", " ".join(outcome.err.split()))
    width, height = struct.unpack(">II", (tmp_path / "x.png").read_bytes()[16:24])
    assert width < height <= 32_767
    assert "too long" not in cli("draw", tmp_path / "a.json", tmp_path / "x.svg").err


def require_cairo() -> None:
    try:
        import cairosvg  # noqa: F401, PLC0415
    except (ImportError, OSError) as error:
        pytest.skip(f"no CairoSVG with its library: {error}")


def test_without_cairo_the_error_says_what_to_do(cli, fixtures, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "cairosvg", None)
    outcome = cli("draw", "iectext/mixing_plant.st", tmp_path / "x.png")
    assert outcome.code == 2
    assert "CairoSVG is missing: PNG cannot be written" in outcome.err
    assert "pip install plcopen-sfc[pictures]" in outcome.err
    assert not list(tmp_path.iterdir())


def test_every_worksheet_is_drawn(tmp_path):
    charts = [make(count, []) for count in (1, 2)]
    pou = sfc.Pou(name="A", kind=sfc.PouKind.PROGRAM, bodies=[sfc.SfcBody(chart=chart) for chart in charts])
    drawn = sfc.draw(sfc.Project(pous=[pou]), f"{tmp_path}/")
    assert [(each.name, each.path.name) for each in drawn] == [("A", "A.svg"), ("A", "A_2.svg")]
    assert [each.path.read_text(encoding="ascii") for each in drawn] == [chart.to_svg() for chart in charts]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["codesys/sorting_conveyor.xml", "-"], "error: 3 charts do not fit into one picture"),
        (["codesys/sorting_conveyor.xml", "x.svg", "--pou", "PLC_PGR"], "chart 'PLC_PGR' (did you mean 'PLC_PRG'?)"),
        (["scl/conveyor_step7.scl", "x.svg"], "error: the project has no chart to draw"),
        (["iectext/mixing_plant.st", "x.svg", "--style", "iecc"], "there is no style 'iecc' of pictures"),
        (["iectext/mixing_plant.st", "x.svg", "--theme", "lihgt"], "there is no theme 'lihgt' of pictures"),
        (["iectext/mixing_plant.st", "x.svg", "--to", "gif"], "there is no format 'gif' of pictures"),
        (["iectext/mixing_plant.st", ""], "the path is empty"),
    ],
)
def test_what_cannot_be_drawn_is_an_error(cli, fixtures, arguments, message):
    outcome = cli("draw", *arguments)
    assert outcome.code == 2
    assert message in outcome.err
    assert not Path("x.svg").exists()


def test_errors_of_the_file_are_findings(cli, fixtures, tmp_path):
    outcome = cli("draw", "broken/jump_to_nowhere.xml", tmp_path / "x.svg")
    assert outcome.code == 1
    assert "SFC" in outcome.err
    assert (tmp_path / "x.svg").exists()


def test_names_of_charts_are_names_of_files(tmp_path):
    project = sfc.Project()
    for name in ("a/b", "a:b", "con"):
        chart = sfc.SfcNetwork()
        chart.add_step("S", initial=True)
        project.pous.append(sfc.Pou(name=name, kind=sfc.PouKind.PROGRAM, bodies=[sfc.SfcBody(chart=chart)]))
    files = sfc.draw(project, f"{tmp_path}/")
    assert [each.path.name for each in files] == ["a_b.svg", "a_b_2.svg", "_con.svg"]
    with pytest.raises(sfc.ArgumentError, match="draw needs a project"):
        sfc.draw(project.pous[0].chart, tmp_path)
