"""Two projects on a page: which steps and transitions are marked, on which side, and what the lists lead to."""

from __future__ import annotations

import hashlib
from datetime import date
from pathlib import Path

import pytest
from lxml import html

import plcopen_sfc as sfc
from plcopen_sfc.conversion.executed_parts import UNUSED_INPUT
from plcopen_sfc.pages.page_words import Words
from tests.pages.browser import Browser
from tests.pages.test_project_page import NASTY, nasty_project, parse, words_of
from tests.pages.test_verdict_words import english_in

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"


@pytest.fixture(scope="module")
def conveyors() -> tuple[sfc.Project, sfc.Project]:
    before, after = (sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml") for _ in range(2))
    chart = after.pou("FB_Pusher").chart
    chart.rename_step("Jammed", "Blocked")
    chart.step("Extending").max_time = "T#3s"
    leaving = next(each for each in chart.transitions if chart.label(each) == "Extending -> Blocked")
    leaving.condition = "FALSE"
    chart.add_step("Extra")
    chart.add_transition("Extra", "Blocked", "TRUE")
    after.rename("FB_Pusher", "FB_Push")
    return before, after


def marked(tree: html.HtmlElement, side: str, kind: str) -> list[str]:
    """The titles of what has this mark in the picture on this side, up to the first sentence."""
    groups = tree.xpath(f"//svg//g[starts-with(@id, '{side}-') and contains(@class, 'diff-{kind}')]")
    return [group.findtext("title").split(".")[0].split(":")[0] for group in groups]


@pytest.mark.slow
def test_a_diff_marks_what_changed_on_both_sides(conveyors: tuple[sfc.Project, sfc.Project]) -> None:
    before, after = conveyors
    text = sfc.diff_page(before, after, sfc.diff(before, after))
    tree = parse(text)
    # the other charts are the same
    assert [link.text for link in tree.xpath("//nav//a")] == ["Differences", "POU FB_Push"]
    assert marked(tree, "a", "renamed") == ["Step Jammed"]
    assert marked(tree, "b", "renamed") == ["Step Blocked"]
    assert marked(tree, "a", "changed") == ["Step Extending", "Transition Extending -> Jammed"]
    assert marked(tree, "b", "changed") == ["Step Extending", "Transition Extending -> Blocked"]
    assert marked(tree, "a", "added") == []
    assert marked(tree, "b", "added") == ["Step Extra", "Transition Extra -> Blocked"]
    ids = tree.xpath("//@id")
    assert len(ids) == len(set(ids))
    links = [link.removeprefix("#") for link in tree.xpath("//a/@href")]
    assert set(links) <= set(ids)
    (item,) = [item for item in tree.xpath("//li") if "step Blocked: renamed" in words_of(item)]
    titles = [tree.get_element_by_id(link[1:]).findtext("title") for link in item.xpath(".//a/@href")]
    assert [title.split(".")[0] for title in titles] == ["Step Jammed", "Step Blocked"]
    assert text == sfc.diff_page(before, after, sfc.diff(before, after))


def test_a_chart_that_only_one_side_has() -> None:
    before, after = (sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml") for _ in range(2))
    before.pous = [pou for pou in before.pous if pou.name != "FB_Pusher"]
    tree = parse(sfc.diff_page(before, after, sfc.diff(before, after), lang="de"))
    (section,) = tree.xpath("//section[@data-name='POU FB_Pusher']")
    assert "keine solche Ablaufkette" in words_of(section)
    assert "POU FB_Pusher: neu (Funktionsbaustein)" in words_of(tree)
    assert len(section.findall(".//svg")) == 1


def test_a_diff_marks_partial_charts_and_what_changed_in_them() -> None:
    text = (FIXTURES / "grafcet" / "every_symbol.gct").read_text(encoding="utf-8")
    changed = text.partition("CHART G4")[0].replace("H1 AFTER 3s", "H1 AFTER 9s")
    a, b = sfc.loads(text.encode()), sfc.loads(changed.encode())
    changes = sfc.diff(a, b)
    found = [(str(change.kind), change.path) for change in changes.changes]
    assert found == [("changed", "POU Symbole / G1 / step 2 / action H1"), ("removed", "POU Symbole / G4")]
    tree = parse(sfc.diff_page(a, b, changes))
    marked = tree.xpath("//svg//*[contains(@class, 'diff-')]")
    assert [(each.get("class"), each.findtext("title")) for each in marked] == [
        ("step diff-changed", "Step 2"),
        ("part diff-removed", "G4"),
        ("step diff-changed", "Step 2"),
    ]


def test_a_diff_marks_and_links_transitions_that_lead_elsewhere_on_both_sides() -> None:
    text = """PROGRAM P
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
TRANSITION FROM S3 TO S1 := c; END_TRANSITION
END_PROGRAM
"""
    a, b = (sfc.loads(each.encode()) for each in (text, text.replace("S2 TO S1", "S2 TO S3")))
    changes = sfc.diff(a, b)
    tree = parse(sfc.diff_page(a, b, changes))
    assert marked(tree, "a", "changed") == ["Transition S2 -> S1"]
    assert marked(tree, "b", "changed") == ["Transition S2 -> S3"]
    (item,) = tree.xpath("//li[contains(@class, 'change')]")
    titles = [tree.get_element_by_id(link[1:]).findtext("title") for link in item.xpath(".//a/@href")]
    assert titles == ["Transition S2 -> S1: b", "Transition S2 -> S3: b"]
    (told,) = changes.as_dict()["changes"]
    assert (told["path"], told["path_after"]) == ("POU P / transition S2 -> S1", "POU P / transition S2 -> S3")


def test_a_step_that_gains_or_loses_an_action_is_marked_on_both_sides() -> None:
    text = """PROGRAM P
INITIAL_STEP S1: q(N); END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
END_PROGRAM
"""
    a, b = (sfc.loads(each.encode()) for each in (text, text.replace("q(N)", "").replace("S2:", "S2: q(S);")))
    changes = sfc.diff(a, b)
    tree = parse(sfc.diff_page(a, b, changes))
    assert marked(tree, "a", "changed") == marked(tree, "b", "changed") == ["Initial step S1", "Step S2"]
    assert marked(tree, "a", "removed") == marked(tree, "b", "added") == []
    for item in tree.xpath("//li[contains(@class, 'change')]"):
        assert [link.text for link in item.xpath(".//a")] == ["A", "B"]
    # what is new as a whole is on one side
    c = sfc.loads(text.replace("STEP S2:", "STEP S3: q(N); END_STEP\nSTEP S2:").encode())
    tree = parse(sfc.diff_page(a, c, sfc.diff(a, c)))
    assert (marked(tree, "a", "changed"), marked(tree, "b", "added")) == ([], ["Step S3"])


def test_equal_projects() -> None:
    project = sfc.load(FIXTURES / "iectext" / "mixing_plant.st")
    tree = parse(sfc.diff_page(project, project, sfc.diff(project, project)))
    assert "no differences" in words_of(tree.find(".//main"))
    assert not tree.xpath("//svg")


@pytest.mark.slow
def test_a_conversion_shows_both_charts_and_what_is_not_executed() -> None:
    source = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    with pytest.raises(sfc.LossError) as refused:
        sfc.convert(source, "codesys")
    data, report = sfc.convert(source, "codesys", partial=True)
    tree = parse(sfc.conversion_page(source, report, sfc.loads(data, as_tool=True), lang="de"))
    (losses,) = tree.xpath("//section[@id='not_executed']")
    assert len(losses.findall(".//li")) == len(report.with_outcome(sfc.Outcome.NOT_EXECUTED)) > 0
    ids = tree.xpath("//@id")
    assert len(ids) == len(set(ids))
    assert {target.removeprefix("#") for target in tree.xpath("//a/@href")} <= set(ids)
    assert [svg.findtext("title") for svg in tree.xpath("//div[@class='pair']//svg")] == ["FB_Drill", "FB_Drill"]
    assert "Schritt Drill / Aktion" in words_of(losses)
    (step,) = tree.xpath("//g[starts-with(@id, 'a-') and contains(@class, 'found-error')]")
    assert step.findtext("title").startswith("Schritt Drill")
    # nothing was written: the source alone
    tree = parse(sfc.conversion_page(source, refused.value.report))
    assert "nothing was written" in words_of(tree)
    assert len(tree.xpath("//svg")) == 1


def test_pictures_side_by_side_begin_in_the_width_that_is_there_unless_they_are_very_wide() -> None:
    narrow, wide = sfc.SfcNetwork(), sfc.SfcNetwork()
    for chart, count in ((narrow, 2), (wide, 30)):
        chart.add_step("S1", initial=True)
        for number in range(2, count):
            chart.add_step(f"S{number}")
            chart.add_transition("S1", f"S{number}", "a")
    projects = [
        sfc.Project(name="p", pous=[sfc.Pou(name="Main", kind="program", bodies=[sfc.SfcBody(chart=chart)])])
        for chart in (narrow, wide)
    ]
    tree = parse(sfc.diff_page(*projects, sfc.diff(*projects)))
    assert [figure.get("class") for figure in tree.xpath("//figure")] == ["fitted", None]


def converted_page(name: str, **options: object) -> html.HtmlElement:
    source = sfc.load(FIXTURES / "grafcet" / name)
    data, report = sfc.convert(source, "codesys", partial=True, limit=0)
    return parse(sfc.conversion_page(source, report, sfc.loads(data, as_tool=True), **options))


def test_steps_of_all_partial_charts_are_beside_those_of_the_one_chart_of_the_target() -> None:
    """The table had the whole chart of the source, which has no steps of its own: nothing but dashes was in it."""
    tree = converted_page("two_cylinders.gct", lang="de")
    (table,) = tree.xpath("//table[@class='side']")
    rows = [[words_of(cell) for cell in row] for row in table.findall(".//tbody/tr")]
    assert [row[0] for row in rows if len(row) == 1] == ["G1", "G2"]
    names = [[cell.findtext("div[@class='name']/a") for cell in row] for row in table.xpath(".//tr[td]")]
    assert names == [
        *([number, f"Step{number}"] for number in ("1", "2", "3", "4", "5", "10", "11")),
        [None, "Start_2"],
    ]
    (order,) = [left for left, *_ in rows if left.startswith("10")]
    assert "zwangssteuernd G1{INIT}" in order
    (table,) = converted_page("every_symbol.gct", lang="de").xpath("//table[@class='side']")
    headings = [words_of(row) for row in table.xpath(".//tr[not(td)]/th")][2:]
    assert headings == ["G1", "M3 (Expansion)", "G3 (eingeschlossen)", "G4"]
    assert "Quelltransitionen" in words_of(table)


def test_orders_and_enclosing_steps_that_are_not_executed_are_marked_and_named() -> None:
    """Only the POU was told of: pictures showed steps without their orders in the usual colour."""
    tree = converted_page("every_symbol.gct")
    marked = tree.xpath("//g[starts-with(@id, 'a-') and contains(@class, 'found-error')]")
    assert [group.findtext("title").split(".")[0] for group in marked] == ["Step 41", "Step 42", "Step 43"]
    (losses,) = tree.xpath("//section[@id='not_executed']")
    for order in ("G1{*}", "G1{1}", "G1{}"):
        assert f"action {order}" in words_of(losses)
    assert "forcing order: the hierarchy is not executed: nothing forces G1" in words_of(losses)
    assert "nothing starts G3" not in words_of(losses), "G3 can be ruled, and is"


def test_a_chart_is_beside_that_of_the_target_which_has_another_name() -> None:
    """Each of them was beside "no such chart"."""
    text = "GRAFCET 1_Anlage\nINPUTS\n    a\nINITIAL STEP 1\n1 -> 2 : a\nSTEP 2\n2 -> 1 : /a\n"
    source = sfc.loads(text.encode(), format="grafcet-text")
    data, report = sfc.convert(source, "codesys", partial=True, limit=0)
    target = sfc.loads(data, as_tool=True)
    assert target.pous[0].name == "_1_Anlage"
    tree = parse(sfc.conversion_page(source, report, target))
    assert len(tree.xpath("//section[starts-with(@id, 'chart-')]")) == 1
    assert "no such chart" not in words_of(tree)
    assert tree.xpath("//table[@class='side']")


@pytest.mark.slow
def test_a_conversion_begins_with_verdicts_tasks_and_files() -> None:
    source = sfc.load(FIXTURES / "codesys" / "distribution_belt.xml")
    data, report = sfc.convert(source, "simaticml", partial=True)
    report.add(sfc.Outcome.APPROXIMATED, UNUSED_INPUT, "POU Unused / INIT_SQ", "as a test has it")
    for flag in ("SFCReset", "SFCPause"):
        report.add(sfc.Outcome.NOT_EXECUTED, "operating input", f"POU Ablauf_Band / {flag}", "as a test has it")
    report.compared = {
        "POU Ablauf_Band": "equal, first 1 scan later (proof: 8 states)",
        "POU Other": "different after 3",
        "POU Second": "not all was reached, no scan was run (no proof: interrupted)\nnot reached: `#a` was never TRUE",
        "POU Third": "not compared: nothing in TIA Portal has its name; test it there",
    }
    tree = parse(sfc.conversion_page(source, report, sfc.loads(data, as_tool=True)))
    (overview,) = tree.xpath("//section[@id='project']")
    files, verdicts, _ = overview.findall(".//table")
    rows = {words_of(row[0]): row[1].text for row in verdicts.findall(".//tbody/tr")}
    assert rows == {
        "POU Ablauf_Band": "the same, a scan later",
        "POU Other": "differs",
        "POU Second": "not all was reached",
        "POU Third": "not compared",
    }
    (own,) = verdicts.xpath(".//th/a/@href")
    assert "Ablauf_Band" in words_of(tree.get_element_by_id(own[1:]).find("h2"))
    assert words_of(verdicts.find(".//details")).endswith("not reached: #a was never TRUE"), "folded, without its marks"
    assert hashlib.sha256(source.source.content).hexdigest() in words_of(files)
    assert words_of(files).count(source.header.tool) == 1, "the tool of the source does not open the target"
    tasks = words_of(overview.xpath("ul[@class='tasks']")[0])
    assert "Decide who operates these inputsPOU Ablauf_Band / SFC" in tasks
    assert "POU Unused / INIT_SQ" in tasks.partition("Decide who operates")[2].partition("\u2610")[0]
    assert "Import into TIA Portal" in tasks
    assert "Test the charts that were not shown to do the samePOU Other, POU Second, POU Third" in tasks
    lost = report.with_outcome(sfc.Outcome.NOT_EXECUTED)
    (listed,) = tree.xpath("//section[@id='not_executed']")
    assert len(listed.findall(".//li")) == len(lost) > 1


def test_the_report_of_a_folder_has_the_digest_of_each_file_and_the_day() -> None:
    folder = FIXTURES / "simaticml"
    source = sfc.load(folder)
    _, report = sfc.convert(source, "codesys", partial=True)
    text = words_of(parse(sfc.conversion_page(source, report, lang="de", made_on=date(2026, 11, 28))))
    assert "TIA Portal \u2192 CODESYS" in text
    assert "Datum2026-11-28" in "".join(text.split())
    for path in folder.glob("*.xml"):
        assert f"{hashlib.sha256(path.read_bytes()).hexdigest()} {path.name}" in text


@pytest.fixture(scope="module")
def station(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of the conversion of a whole project of TIA Portal to CODESYS."""
    folder = tmp_path_factory.mktemp("station")
    source = sfc.load(FIXTURES / "simaticml")
    report = sfc.save(source, folder / "line.xml", format="codesys")
    page = folder / "report.html"
    text = sfc.conversion_page(source, report, sfc.load(folder / "line.xml", as_tool=True))
    page.write_text(text, encoding="ascii")
    return page


@pytest.mark.slow
def test_a_report_can_be_handed_over(station: Path) -> None:
    tree = parse(station.read_text(encoding="ascii"))
    text = words_of(tree.find(".//main"))
    assert str(station.parent) not in text, "where the files were is of no interest to others"
    assert "`" not in text
    assert "Boolean actions: FeedDown: other code writes it" in text, "as the chart has the name"
    assert [words_of(each) for each in tree.xpath("//figcaption")] == [
        "Source: TIA Portal, simaticml fit / full size",
        "Target: CODESYS, line.xml fit / full size",
    ]
    (tasks,) = tree.xpath("//ul[@class='tasks']")
    assert {tree.get_element_by_id(link[1:]).tag for link in tasks.xpath(".//a/@href")} == {"li"}
    # each step beside that of the target, with the program text of its actions
    rows = {row[0].xpath("string(.//a[1])"): words_of(row[1]) for row in tree.xpath("//table[@class='side']/tbody/tr")}
    assert "Clamp_part_actionsIF Clamp_part.x THEN IF GuardClosed THEN Clamp := TRUE;" in rows["2 Clamp part"]
    assert rows["8 Release"].startswith("Release")


@pytest.mark.slow
@pytest.mark.parametrize("width", [390, 500, 1400, 1900])
def test_a_report_fits_in_its_window(browser: Browser, station: Path, width: int) -> None:
    browser.open(station, width=width)
    assert browser.evaluate("document.documentElement.scrollWidth") <= width
    cut = "all('td, th, h1, h2, li').filter((each) => each.scrollWidth > each.clientWidth + 1 && each.clientWidth)"
    assert browser.evaluate(f"{cut}.map((each) => each.textContent)") == []
    assert browser.messages == []
    shown = "all('figure').filter((each) => each.offsetParent && !each.querySelector('.fit').hidden)"
    whole = "each.querySelector('svg').viewBox.baseVal.width <= each.querySelector('.scroll').clientWidth"
    assert browser.evaluate(f"{shown}.some((each) => {whole})") is False, "a button that changes nothing"
    if width < 1000:
        return  # pictures are scrolled there
    browser.evaluate("document.querySelector('.pair').scrollIntoView()")
    assert browser.evaluate("all('.pair .scroll').every((each) => each.scrollWidth <= each.clientWidth)")
    for one, other in (("Clamp part", "Clamp_part"), ("Drill", "Drill"), ("Lift", "Lift"), ("Release", "Release")):
        tops = [
            browser.evaluate(
                f"all('[id^={side}-] > title').find((each) => /step {name}\\b/i.test(each.textContent))"
                ".parentNode.querySelector('.box').getBoundingClientRect().top"
            )
            for side, name in (("a", one), ("b", other))
        ]
        assert tops[0] == pytest.approx(tops[1], abs=1), one


@pytest.mark.slow
@pytest.mark.parametrize("width", [1280, 1920])
def test_a_chart_that_is_far_wider_is_scrolled_beside_the_other(browser: Browser, tmp_path: Path, width: int) -> None:
    source = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    report = sfc.save(source, tmp_path / "drill.xml", format="codesys", partial=True)
    page = tmp_path / "drill.html"
    text = sfc.conversion_page(source, report, sfc.load(tmp_path / "drill.xml", as_tool=True))
    page.write_text(text, encoding="ascii")
    browser.open(page, width=width)
    browser.evaluate("document.querySelector('.pair').scrollIntoView()")
    places = "all('.pair figure').map((each) => each.getBoundingClientRect())"
    assert browser.evaluate(f"{places}.map((each) => each.top).filter((each, at, tops) => each !== tops[0])") == []
    left, right = browser.evaluate(f"{places}.map((each) => each.width)")
    assert min(left, right) > 0.3 * width
    assert browser.evaluate("document.documentElement.scrollWidth") <= width
    assert browser.evaluate("all('.pair .scroll').map((each) => each.scrollWidth > each.clientWidth)") == [False, True]
    assert (
        words_of(parse(text).xpath("//section[starts-with(@id, 'chart-')]/p")[0]) == "Colours: not executed translated"
    )
    browser.evaluate("all('.pair .fit').at(-1).click()")
    tops = browser.evaluate(f"{places}.map((each) => each.top)")
    assert tops[0] < tops[1], "in full size it has the width of the window"
    browser.open(page, width=390)
    cut = "all('li').filter((each) => each.scrollWidth > each.clientWidth + 1 && each.clientWidth)"
    assert browser.evaluate(f"{cut}.map((each) => each.textContent)") == []
    browser.open(page, width=width, printed=True)
    cut = "all('.pair figure').filter((each) => each.querySelector('svg').clientWidth > each.clientWidth)"
    assert browser.evaluate(f"{cut}.length") == 0
    tops = browser.evaluate(f"{places}.map((each) => each.top)")
    assert tops[0] < tops[1], "on paper each has a page"
    assert browser.messages == []


@pytest.mark.slow
def test_nothing_of_a_report_is_cut_off_on_paper(browser: Browser, station: Path) -> None:
    browser.open(station, width=700, printed=True)  # the width of A4
    browser.evaluate("for (const each of all('details')) each.open = true")
    cut = "all('pre, .scroll, td, li').filter((each) => each.scrollWidth > each.clientWidth + 1 && each.clientWidth)"
    assert browser.evaluate(f"{cut}.map((each) => each.textContent)") == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "target"),
    [
        ("simaticml/FB_Drill.xml", "codesys"),
        ("simaticml/FB_Drill.xml", "iec-text"),
        ("codesys/sorting_conveyor.xml", "simaticml"),
        ("codesys/sorting_conveyor.xml", "codesys23"),
        ("codesys/distribution_belt.xml", "simaticml"),
        ("iectext/mixing_plant.st", "scl"),
        ("iectext/mixing_plant.st", "codesys"),
        ("training-chain/codesys.xml", "plcopen-2.01"),
        ("grafcet/two_cylinders.gct", "simaticml"),
        ("simaticml/FB_Drill.xml", "grafcet-text"),
    ],
)
def test_reasons_are_german_on_a_german_page(file: str, target: str) -> None:
    source = sfc.load(FIXTURES / file)
    try:
        data, report = sfc.convert(source, target, partial=True, limit=0)
    except sfc.LossError as refused:
        data, report = b"", refused.report
    written = sfc.loads(data, as_tool=True) if data else None
    english, german = (
        words_of(parse(sfc.conversion_page(source, report, written, lang=lang))) for lang in ("en", "de")
    )
    assert [told for item in report.items if english_in(told := Words("de").message(item.why))] == []
    reasons = {item.why for item in report.items if item.why and item.why in english}
    assert reasons
    assert {why for why in reasons if why in german} == set()


def test_what_a_written_file_does_not_have_is_told_in_german() -> None:
    """It was "extension data wird als nothing wieder gelesen": half of it, and no sentence in English either."""
    source = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    _, report = sfc.convert(source, "twincat", partial=True, limit=0)
    missing = [item for item in report.items if "is not in the written file" in item.why]
    assert {"extension data", "'Bohrmaschine'"} <= {
        item.why.removesuffix(" is not in the written file") for item in missing
    }
    assert not [item for item in report.items if item.why.endswith("comes back as nothing")]
    words = Words("de")
    told = {f"{words.place(item.path)}: {words.message(item.why)}" for item in missing}
    assert "POU FB_Drill / Erweiterungsdaten: nicht in der geschriebenen Datei: Erweiterungsdaten" in told
    assert {line for line in told if english_in(line)} == set()


def test_a_german_diff_tells_changes_in_german(conveyors: tuple[sfc.Project, sfc.Project]) -> None:
    before, after = conveyors
    tree = parse(sfc.diff_page(before, after, sfc.diff(before, after), lang="de"))
    lines = [words_of(item) for item in tree.xpath("//li[contains(@class, 'change')]")]
    assert lines == [
        "POU FB_Push: umbenannt, hieß FB_Pusher",
        "POU FB_Push / Schritt Blocked: umbenannt, hieß Jammed A B",
        "POU FB_Push / Schritt Extending: Maximalzeit tMaxStroke -> T#3s A B",
        "POU FB_Push / Transition Extending -> Blocked: Bedingung Extending.t > tMaxStroke -> FALSE A B",
        "POU FB_Push / Schritt Extra: neu B",
        "POU FB_Push / Transition Extra -> Blocked: neu (TRUE) B",
    ]


def test_nothing_of_a_project_becomes_html() -> None:
    nasty, other = nasty_project(), nasty_project()
    other.pous[0].chart.steps[0].comment = None
    other.pous[0].actions[0].body.text += "</script>"
    tree = parse(sfc.diff_page(nasty, other, sfc.diff(nasty, other)))
    assert len(tree.xpath("//script")) == 1
    assert not tree.xpath("//img")
    assert NASTY in words_of(tree.find(".//h1"))


@pytest.mark.slow
def test_links_in_chromium(browser: Browser, conveyors: tuple[sfc.Project, sfc.Project], tmp_path: Path) -> None:
    page = tmp_path / "diff.html"
    page.write_text(sfc.diff_page(*conveyors, sfc.diff(*conveyors)), encoding="ascii")
    browser.open(page)
    browser.evaluate("all('li.is-renamed a').at(-1).click()")
    assert browser.evaluate("document.querySelector(':target').querySelector('title').textContent").startswith(
        "Step Blo"
    )
    tops = browser.evaluate("all('.pair figure').map((each) => each.getBoundingClientRect().top)")
    assert tops[0] == tops[1]
    assert browser.messages == []
