"""Traces as timing diagrams, and played on the page of their project."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from lxml import etree, html

import plcopen_sfc as sfc
from plcopen_sfc.pages import page
from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.semantics.simulation import Simulation
from plcopen_sfc.semantics.subjects import resolve
from tests.pages.browser import Browser
from tests.semantics.test_simulate import PLANT

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def project() -> sfc.Project:
    return sfc.loads(PLANT.encode(), format="iec-text")


@pytest.fixture(scope="module")
def trace(project: sfc.Project) -> sfc.Trace:
    def plant(scan: int, _values: object) -> dict[str, object]:
        return {"Start": scan == 2, "Selected": "Auto", "Level": 3.5 if scan >= 6 else 0.0}

    return sfc.simulate(project, inputs=plant, scans=20)


def lines(svg: str) -> dict[str, etree._Element]:
    tree = etree.fromstring(svg.encode("ascii"))
    return {g.findtext(f"{SVG}title"): g for g in tree.iter(f"{SVG}g")}


def test_the_diagram_shows_when_values_change(trace: sfc.Trace) -> None:
    svg = trace.to_svg()
    found = lines(svg)
    assert [*found][: len(trace.steps)] == ["Wait", "Fill", "Settle"]
    assert set(found) >= {"Start", "Level", "Valve"}
    # a scan is 24 pixels wide; Start is TRUE in the third one
    points = found["Start"].find(f"{SVG}path").get("d").strip("M").split("L")
    xs = [int(point.split()[0]) for point in points]
    assert [x - xs[0] for x in xs] == [0, 48, 48, 72, 72, 480]
    # Fill is a box while it is active
    (first, _), (last, _) = trace.situations()[1:3]
    (box,) = found["Fill"].findall(f"{SVG}rect")
    assert (int(box.get("x")) - xs[0], int(box.get("width"))) == (24 * first, 24 * (last - first))
    # numbers are written in their boxes
    assert [text.text for text in found["Level"].findall(f"{SVG}text")[1:]] == ["0.0", "3.5"]
    assert svg == trace.to_svg()
    assert "sfc-dark" in trace.to_svg(theme="dark")
    with pytest.raises(sfc.ModelError, match="no theme 'red'"):
        trace.to_svg(theme="red")


def test_numbers_that_change_too_often_to_be_read_are_a_curve_with_their_range(project: sfc.Project) -> None:
    """They were a row of empty boxes, so narrow that it looked black."""
    inputs = {"Start": False, "Selected": "Auto"}
    trace = sfc.simulate(project, inputs=lambda scan, _: inputs | {"Level": scan * 0.1}, scans=200)
    row = lines(trace.to_svg())["Level (0 .. 19.9)"]
    assert row.findall(f"{SVG}rect") == []
    heights = [int(point.split()[1]) for point in row.find(f"{SVG}path").get("d").strip("M").split("L")]
    assert heights == sorted(heights, reverse=True)
    assert heights[0] - heights[-1] > 10


def test_a_long_trace_is_not_wider_than_a_short_one(project: sfc.Project) -> None:
    widths = [int(etree.fromstring(sfc.simulate(project, scans=n).to_svg()).get("width")) for n in (100, 5000)]
    assert widths[0] == widths[1] < 1500


def test_names_of_variables_are_text_only() -> None:
    source = (
        "FUNCTION_BLOCK F VAR_OUTPUT text : STRING := '</script><script>x'; END_VAR text := text; END_FUNCTION_BLOCK"
    )
    project = sfc.loads(source.encode(), format="iec-text")
    tree = html.document_fromstring(sfc.page(project, trace=sfc.simulate(project, scans=20)))
    assert len(tree.xpath("//script")) == 2
    assert "</script><script>x" in tree.xpath("//*[@id='timing']")[0].text_content()


@pytest.mark.slow
def test_a_trace_is_played_on_the_chart(
    browser: Browser, project: sfc.Project, trace: sfc.Trace, tmp_path: Path
) -> None:
    page = tmp_path / "page.html"
    page.write_text(sfc.page(project, trace=trace), encoding="ascii")
    browser.open(page)

    def active() -> list[str]:
        """The steps that are coloured: in the picture beside the diagram, and alike in the section of the chart."""
        names = "map((each) => each.querySelector('title').textContent.split(/[. ]+/).at(-1))"
        shown = browser.evaluate(f"['#trace', '.pou'].map((where) => all(`${{where}} .now`).{names})")
        assert shown[0] == shown[1]
        return shown[0]  # type: ignore[no-any-return]

    def click(selector: str) -> None:
        browser.evaluate(f"document.querySelector({selector!r}).click()")

    assert browser.evaluate("byId('player').getBoundingClientRect().bottom === innerHeight")
    times = "all('#timing text.quiet').map((each) => each.getBoundingClientRect().bottom)"
    cursor = "document.querySelector('#timing .cursor').getBoundingClientRect().top"
    assert browser.evaluate(f"Math.max(...{times}) <= {cursor} + 4"), "the line hides no time"
    seen = [active()]
    for _ in trace.eventful_scans()[1:]:
        click("[data-move='1']")
        seen.append(active())
    assert seen == [[*trace.active(scan)] for scan in trace.eventful_scans()]
    assert browser.evaluate("all('#trace .value').map((each) => each.textContent)") == [
        column.signal.text(column[-1]) for column in trace.columns
    ]
    click("[data-move='-1']")
    assert active() == [*trace.active(trace.eventful_scans()[-2])]
    click("[data-move='0']")
    assert active() == [*trace.active(trace.eventful_scans()[-2])]
    browser.evaluate("new Promise((done) => setTimeout(done, 800))")
    assert active() == [*trace.active(-1)]
    assert browser.messages == []


@pytest.mark.slow
def test_the_line_of_a_trace_stays_in_sight_on_a_phone(browser: Browser, project: sfc.Project, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.write_text(
        sfc.page(project, trace=sfc.simulate(project, inputs=sfc.RandomInputs(1), scans=200)), encoding="ascii"
    )
    browser.open(page, width=390, height=800)
    assert browser.evaluate("byId('timing').scrollWidth > byId('timing').clientWidth")
    for end in ("max", "min"):
        browser.evaluate(f"range = byId('scan'); range.value = range.{end}; range.dispatchEvent(new Event('input'))")
        places = "['#timing .cursor', '#timing'].map((each) => document.querySelector(each).getBoundingClientRect())"
        line, shown = browser.evaluate(f"{places}.map((each) => [each.left, each.right])")
        assert shown[0] <= line[0] <= shown[1]


def test_notebooks_show_projects_and_verdicts(project: sfc.Project) -> None:
    rows = html.fromstring(project._repr_html_()).xpath("//tbody/tr")
    texts = [[cell.text_content() for cell in row] for row in rows]
    assert len(texts) == len(list(project.objects()))
    assert any(row[2] == "SFC" and f"{len(project.steps())} steps" in row[3] for row in texts)
    pou = next(each for each in project.pous if each.chart is not None)
    shown = html.fromstring(pou._repr_html_())
    names = [row[1].text_content() for row in shown.xpath("//table[@class='variables']/tbody/tr")]
    assert names == [variable.name for variable in pou.variables()]
    bodies = [row[0].text_content() for row in shown.xpath("//table[@class='bodies']/tbody/tr")]
    assert bodies == [body.name for body in pou.named_bodies()]
    other = sfc.loads(PLANT.replace("Valve", "Value").encode(), format="iec-text")
    other.pous[0].name += "<b>"
    assert "<b>" not in other._repr_html_() + other.pous[0]._repr_html_()
    changed = sfc.loads(PLANT.encode(), format="iec-text")
    link = next(iter(changed.charts())).chart.transitions[0]
    link.condition = "NOT Start"
    (proof,) = sfc.diff(project, changed, prove=True, limit=5).proofs
    assert proof.verdict is not None
    shown = proof.verdict._repr_html_()
    assert proof.verdict.different
    assert shown.startswith("<pre>")
    assert shown.count("<svg") == 2


def test_a_run_without_a_scan_and_one_that_ends_with_an_error_are_shown() -> None:
    text = "PROGRAM Main VAR_INPUT x : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR n := 1 / n; END_PROGRAM"
    project = sfc.loads(text.encode(), format="iec-text")
    simulation = Simulation(resolve(project, None))
    assert "0 scans" in simulation.trace.to_svg()
    with pytest.raises(sfc.SfcError):
        simulation.run(lambda _: {}, 5)
    assert simulation.trace.ended == "division by zero"
    for lang, told in (
        ("en", "The run ended with an error: division by zero"),
        ("de", "mit einem Fehler: Division durch null"),
    ):
        assert told in page(project, lang=lang, trace=simulation.trace)


def test_a_german_page_of_runs_tells_in_german_why_one_ended() -> None:
    text = "PROGRAM Main VAR_INPUT x : BOOL; END_VAR VAR n : INT := 9; a : ARRAY [1..3] OF INT; END_VAR "
    project = sfc.loads(f"{text} n := a[n]; END_PROGRAM".encode(), format="iec-text")
    simulation = Simulation(resolve(project, None))
    with pytest.raises(sfc.SfcError):
        simulation.run(lambda _: {}, 5)
    told = html.fromstring(page(project, lang="de", trace=simulation.trace)).text_content()
    assert "mit einem Fehler: der Index 9 liegt außerhalb von 1..3" in told
    verdict = sfc.equivalent(project, project)
    told = Words("de").verdict(str(verdict).splitlines()[0])
    assert "beide enden mit einem Fehler: Zeile 1 (Main): der Index 9 liegt außerhalb von 1..3" in told


def test_a_macro_step_is_active_while_a_step_of_its_expansion_is() -> None:
    text = "GRAFCET G\nINPUTS\n    a\nCHART G1\n    INITIAL STEP 1\n    1 -> M3 : a\n    MACRO M3\n    M3 -> 1 : /a\n"
    text += "EXPANSION M3\n    STEP E3\n    E3 -> S3 : a\n    STEP S3\n"
    project = sfc.loads(text.encode())
    trace = sfc.simulate(project, inputs=lambda scan, _: {"a": scan == 0}, scans=2)
    tree = html.fromstring(page(project, trace=trace))
    data = json.loads(tree.get_element_by_id("trace-data").text_content())
    (_, active), (_, later) = data["situations"]
    assert [name for name, _ in active] == ["G1.M3", "G1.M3.S3"]
    assert tree.get_element_by_id(active[0][1]).findtext("title").startswith("Macro")
    assert [name for name, _ in later] == ["G1.1"]
    rows = html.fromstring(trace.to_svg().encode()).xpath("//*[contains(@class, 'signal step')]/title/text()")
    assert rows == ["G1.M3", "G1.M3.S3", "G1.1"]
