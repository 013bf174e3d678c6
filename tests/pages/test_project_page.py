"""A project as a page: what is in it, what its links lead to, and what cannot happen there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lxml import html

import plcopen_sfc as sfc
from benchmarks.lowering import blocks
from plcopen_sfc import model as sfc_model
from plcopen_sfc.analysis.checks import all_rules
from plcopen_sfc.drawing.pictures import dot_text
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.pages.phrases import german_table
from tests.pages.browser import Browser
from tests.pages.test_verdict_words import english_in

ROOT = Path(__file__).resolve().parents[2]
FIXTURES = ROOT / "fixtures"
SAMPLE = (
    "codesys/sorting_conveyor.xml",
    "simaticml-plc",
    "plcopen/every_element_2.01.xml",
    "iectext/mixing_plant.st",
    "twincat-belt",
)
NASTY = "</title><script>document.title='executed'</script><img src=x onerror=\"document.title='executed'\">"


def parse(text: str) -> html.HtmlElement:
    return html.document_fromstring(text)


def words_of(element: html.HtmlElement) -> str:
    return " ".join(element.text_content().split())


@pytest.fixture(scope="module")
def conveyor() -> str:
    return sfc.page(sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml"))


@pytest.mark.parametrize("name", SAMPLE)
def test_links_lead_to_one_element_each(name: str) -> None:
    path = FIXTURES / name
    text = sfc.page(sfc.load(path), lang="de")
    tree = parse(text)
    ids = tree.xpath("//@id")
    assert len(ids) == len(set(ids))
    links = {target.removeprefix("#") for target in tree.xpath("//a/@href")}
    assert links <= set(ids)
    assert not tree.xpath("//@src | //link | //*[@style]")
    assert text == sfc.page(sfc.load(path), lang="de")
    assert text.isascii()


def test_everything_of_a_chart_is_there(conveyor: str) -> None:
    tree = parse(conveyor)
    (pou,) = tree.xpath("//section[@data-name='FB_Pusher']")
    variables = [words_of(each) for each in pou.xpath(".//table[@class='variables']//tbody//th")]
    assert variables[:2] == ["xExtend", "xInterlock"]
    (row,) = pou.xpath(".//table[@class='steps']//tr[@data-name='Extending']")
    assert "qValve" in words_of(row)
    assert [link.text for link in row.xpath("td[2]//a")[-1:]] == ["Jammed"]
    svg_id = row.get("id").removesuffix("-row")
    (step,) = pou.xpath(f".//*[@id='{svg_id}']")
    assert step.findtext("title").startswith("Step Extending")


def test_steps_and_frames_of_pictures_lead_to_their_tables() -> None:
    """Only the script did that: not without it, and not by keyboard."""
    for name in ("grafcet/every_symbol.gct", "simaticml/FB_Drill.xml"):
        tree = parse(sfc.page(sfc.load(FIXTURES / name)))
        drawn = tree.xpath("//svg//g[@class='step' or starts-with(@class, 'step ')]")
        assert drawn
        for step in drawn:
            (own,) = {each.get("href") for each in step.xpath("a[text[@class='name']]")}
            assert tree.get_element_by_id(own[1:]).tag == "tr"
            assert step.get("id") in {link[1:] for link in tree.get_element_by_id(own[1:]).xpath("th/a/@href")}
        for frame in tree.xpath("//svg//g[@class='part']"):
            (heading,) = frame.xpath("a/@href")
            assert tree.get_element_by_id(heading[1:]).tag == "h4"
    named = tree.xpath("//svg//g[starts-with(@class, 'transition')]/a/@href")
    assert named
    assert {tree.get_element_by_id(link[1:]).tag for link in named} == {"li"}


def test_names_in_program_text_are_links_to_what_they_mean(conveyor: str) -> None:
    tree = parse(conveyor)
    (row,) = tree.xpath("//section[@data-name='PLC_PRG']//tr[@data-name='bFault']")
    users = [words_of(each) for each in row.xpath(".//li")]
    assert any("transition" in each for each in users)
    links = tree.xpath(f"//code//a[@href='#{row.get('id')}']")
    assert {each.text for each in links} == {"bFault"}
    # an action that a step names leads to its program, and that back to the step
    (action,) = tree.xpath("//div[@data-name='PLC_PRG.ACT_Belt']")
    assert tree.xpath(f"//table[@class='steps']//a[@href='#{action.get('id')}']")
    assert "POU PLC_PRG / step Init / action ACT_Belt" in words_of(action)


def test_findings_are_at_their_places() -> None:
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    expected = sfc.check(project)
    tree = parse(sfc.page(project))
    listed = tree.xpath("//section[@id='findings']//li")
    assert len(listed) == len(expected)
    finding = next(each for each in expected if each.code == "ACT04")
    (row,) = tree.xpath("//tr[@data-name='CheckSlide2']")
    assert finding.message in words_of(row)
    assert "found-warning" in tree.get_element_by_id(row.get("id").removesuffix("-row")).get("class").split()


class TestGrafcetPage:
    LINES = (
        "conditional Q1 [a * b]",
        "delayed T#3s H1",
        "limited T#500ms H2",
        "on activation n := n + 1",
        "on deactivation n := 0",
        "on event n := n + 2 [\u2191b]",
    )

    @pytest.fixture(scope="class")
    @staticmethod
    def project() -> sfc.Project:
        return sfc.load(FIXTURES / "grafcet" / "every_symbol.gct")

    @pytest.fixture(scope="class")
    @staticmethod
    def tree(project: sfc.Project) -> html.HtmlElement:
        return parse(sfc.page(project))

    def test_actions_say_what_they_are_everywhere_in_the_same_words(
        self, project: sfc.Project, tree: html.HtmlElement
    ) -> None:
        (row,) = tree.xpath("//table[@class='steps']//tr[@data-name='2']")
        lines = ("".join(each.xpath("text() | (b | a | code)//text()")) for each in row.xpath("td[1]//li"))
        assert tuple(lines) == self.LINES  # without comments
        titles = [each.text for each in tree.xpath("//*[@class='action']/title")]
        assert set(self.LINES) <= set(titles)
        assert {"forcing G1{*}", "forcing G1{1}", "forcing G1{}"} <= set(titles)
        chart = project.pous[0].chart
        assert chart is not None
        assert r"2\n" + r"\n".join(self.LINES) in dot_text(chart)
        german = parse(sfc.page(project, lang="de"))
        (row,) = german.xpath("//table[@class='steps']//tr[@data-name='2']")
        assert [words_of(each) for each in row.xpath("td[1]//li[2] | td[1]//li[4]")] == [
            "verz\u00f6gert T#3s H1",
            "bei Aktivierung n := n + 1",
        ]

    @pytest.mark.parametrize(
        ("step", "words", "chart"),
        [("M3", "macro M3", "M3 (expansion)"), ("4", "encloses G3{20}", "G3 (enclosed)")],
    )
    def test_steps_lead_to_the_charts_inside(self, tree: html.HtmlElement, step: str, words: str, chart: str) -> None:
        (inside,) = tree.xpath(f"//table[@class='steps']//tr[@data-name='{step}']/td[1]//li")
        assert words_of(inside) == words
        frame = tree.get_element_by_id(inside.find("a").get("href").removeprefix("#"))
        assert frame.findtext("title") == chart

    def test_tables_have_names_and_all_transitions(self, tree: html.HtmlElement) -> None:
        headings = [words_of(each) for each in tree.xpath("//h4")]
        assert headings == ["G1", "M3 (expansion)", "G3 (enclosed)", "G4"]
        (row,) = tree.xpath("//tr[th='Source transitions']")
        assert words_of(row).endswith("\u2191(a * b) \u2192 5")
        (joint,) = tree.xpath("//tr[@data-name='2']/td[2]//li")
        assert "(after M3 too) 2s/X2 \u2192 4" in words_of(joint)
        assert "From nowhere -> 5" in [each.text for each in tree.xpath("//*[@class='reference']/title")]
        (description,) = tree.xpath("//desc")
        assert description.text == "Sequential function chart: 13 steps, 13 transitions, 4 charts"

    def test_findings_are_at_steps_transitions_and_charts(self) -> None:
        text = """
GRAFCET G
CHART G1 "main <b>"
    INITIAL STEP 1
        Q1 IF \u2191a
    1 -> 1 : a * /a
EXPANSION M9
    STEP E9
    E9 -> S9 : b
    STEP S9
"""
        tree = parse(sfc.page(sfc.loads(text.encode())))
        found = tree.xpath("//svg//*[contains(@class, 'found-')]")
        titles = {each.findtext("title"): each.get("class").split()[0] for each in found}
        expected = {"Initial step 1": "step", "Transition 1 -> 1: a * /a": "transition", "M9 (expansion)": "part"}
        assert expected.items() <= titles.items()
        (row,) = tree.xpath("//tr[@data-name='1']")
        assert {"ACT12"} <= {words_of(each).split()[1] for each in row.xpath("th//li")}
        assert "main <b>" in [each.text for each in tree.xpath("//div[@class='comment']")]
        assert tree.xpath("//*[@class='part']/title")[0].text == "G1. main <b>"


def test_excluded_elements_say_so() -> None:
    chart = sfc.SfcNetwork()
    first, second = chart.add_step("S1", initial=True), chart.add_step("S2")
    second.exclude = chart.add_transition(first, second, "a").exclude = True
    pou = sfc.Pou(name="P", kind=sfc.PouKind.PROGRAM, bodies=[sfc.SfcBody(chart=chart)])
    tree = parse(sfc.page(sfc.Project(pous=[pou])))
    assert [words_of(each) for each in tree.xpath("//tr[@data-name]/th/em | //li/em")] == ["excluded", "excluded"]
    titles = [each.text for each in tree.xpath("//svg/*[contains(@class, 'excluded')]/title")]
    assert titles == ["Transition S1 -> S2 (excluded): a", "Step S2 (excluded)"]


def test_both_languages_have_all_words() -> None:
    project = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    german, english = (parse(sfc.page(project, lang=lang)) for lang in ("de", "en"))
    assert german.get("lang") == "de"
    assert "Verriegelung #GuardClosed" in words_of(german)
    assert "interlock #GuardClosed" in words_of(english)
    used: set[str] = set()
    for module in (ROOT / "plcopen_sfc" / "pages").glob("*.py"):
        used.update(re.findall(r'words\(f?"([^"]+)"', module.read_text(encoding="utf-8")))
    for module in (ROOT / "plcopen_sfc" / "drawing").rglob("*.py"):
        used.update(re.findall(r'told\("([^"]+)"', module.read_text(encoding="utf-8")))
    assert sorted(used - german_table("words").keys() - german_table("reports").keys()) == []
    with pytest.raises(sfc.ModelError, match="pages have no language 'fr'"):
        sfc.page(project, lang="fr")


def test_a_german_page_has_german_pictures_and_values() -> None:
    project = sfc.load(FIXTURES / "grafcet" / "every_symbol.gct")
    tree = parse(sfc.page(project, trace=sfc.simulate(project, scans=2), lang="de"))
    parts = [words_of(each) for each in tree.xpath("//section[@class='pou']//g[@class='part']//text[@class='name']")]
    assert parts == ["G1", "M3 (Expansion)", "G3 (eingeschlossen)", "G4"]
    titles = {
        each.text.split()[0]
        for each in tree.xpath("//figure[not(.//*[@id='timing'])]//g[contains(@class, 'step')]/title")
    }
    assert titles == {"Initialschritt", "Schritt", "Makroschritt", "Einschließender"}
    sources = {each.text for each in tree.xpath("//g[contains(@class, 'reference')]/title")}
    assert "Von nirgends -> 5" in sources
    directions = {words_of(row[1]) for row in tree.xpath("//section[@id='trace']//table//tr")}
    assert directions == {"Ausgang", "Eingang", "extern", "lokal"}
    places = words_of(tree.xpath("//section[@class='pou']")[0])
    assert "POU Symbole / M3 / Eingangsschritt" in places
    assert "POU Symbole / M3 / Ausgangsschritt" in places
    assert english_in(places) == []
    drill = parse(sfc.page(sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml"), lang="de"))
    assert "Warnung T#7S" in words_of(drill.xpath("//svg")[0])
    assert english_in(" ".join(map(words_of, drill.xpath("//svg")))) == []


def test_drawn_conditions_and_bodies_are_pictures() -> None:
    tree = parse(sfc.page(sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")))
    (row,) = tree.xpath("//table[@class='steps']//tr[@data-name='Dwell']")
    figures = row.xpath(".//details[summary='LD' or summary='FBD']/figure")
    assert figures
    assert "contact #DrillUp" in words_of(figures[0])
    conveyor = parse(sfc.page(sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")))
    (belt,) = conveyor.xpath("//div[@data-name='PLC_PRG.ACT_Belt']")
    assert "Ladder diagram: 1 network" in words_of(belt.find(".//figure"))


def test_variables_of_methods_are_with_their_methods() -> None:
    methods = [
        sfc_model.Method(
            name=name,
            interface=sfc.Interface(sections=[sfc.VariableSection(variables=[sfc.Variable(name="x", type="BOOL")])]),
            body=sfc.StBody(text="x := TRUE;"),
        )
        for name in ("Start", "Stop")
    ]
    pou = sfc.Pou(name="Motor", kind=sfc.PouKind.FUNCTION_BLOCK, methods=methods)
    tree = parse(sfc.page(sfc.Project(pous=[pou])))
    for name in ("Start", "Stop"):
        (method,) = tree.xpath(f"//div[@data-name='Motor.{name}']")
        (row,) = method.xpath(".//tr[@data-name='x']")
        assert method.xpath(".//code/a/@href") == [f"#{row.get('id')}"]


def nasty_project() -> sfc.Project:
    chart = sfc.SfcNetwork()
    step = chart.add_step(NASTY, initial=True)
    step.comment = NASTY
    step.actions = [sfc.ActionAssociation(id=5, target=NASTY, indicator=NASTY)]
    chart.add_transition(step, step, NASTY).comment = NASTY
    section = sfc.VariableSection(variables=[sfc.Variable(name=NASTY, type=NASTY, initial=NASTY, comment=NASTY)])
    pou = sfc.Pou(
        name=NASTY,
        kind=sfc.PouKind.PROGRAM,
        interface=sfc.Interface(sections=[section]),
        bodies=[sfc.SfcBody(chart=chart)],
        actions=[sfc.Action(name=NASTY, body=sfc.StBody(text=NASTY))],
    )
    return sfc.Project(name=NASTY, pous=[pou])


def test_nothing_of_a_project_becomes_html() -> None:
    text = sfc.page(nasty_project())
    tree = parse(text)
    assert NASTY in words_of(tree.find(".//h1"))
    assert len(tree.xpath("//script")) == 1
    assert not tree.xpath("//img")
    policy = tree.xpath("//meta[@http-equiv='Content-Security-Policy']/@content")[0]
    assert policy.startswith("default-src 'none'; style-src 'sha256-")
    assert "unsafe" not in policy


@pytest.mark.slow
class TestInChromium:
    def test_search_by_keys(self, browser: Browser, conveyor: str, tmp_path: Path) -> None:
        page = tmp_path / "page.html"
        page.write_text(conveyor, encoding="ascii")
        browser.open(page)
        for key in ("/", *"jammed"):
            browser.press(key)
        assert "Jammed" in browser.evaluate("document.querySelector('#found a').innerText")
        browser.press("ArrowDown")
        browser.press("Enter")
        assert browser.evaluate("document.querySelector(':target').dataset.name").startswith("Jammed")
        browser.evaluate("document.querySelector('g.step').dispatchEvent(new MouseEvent('click', {bubbles: true}))")
        assert browser.evaluate("document.querySelector(':target').localName") == "tr"
        assert browser.messages == []

    @pytest.mark.parametrize(
        ("wanted", "label", "place"),
        [
            ("bin_no", "Recipe: Bin_No : INT", "pre"),  # a member of a structure
            ("standby", "Mode: Mode : (Off, Standby, On)", "pre"),  # a value of an enumeration
            ("speed * 2", "P.Run: speed := speed * 2;", "pre"),  # text of a program
            ("every_cycle", "Every_Cycle", "li"),  # a task
            ("not a and", "A \u2013 P", "tr"),  # a condition of a transition
            ("emptied by hand", "P: Emptied by hand", "div"),  # a comment
            ("var03", "info VAR03 nothing uses the variable 'r'", "li"),
        ],
    )
    def test_search_finds_whatever_is_there(
        self, browser: Browser, tmp_path: Path, wanted: str, label: str, place: str
    ) -> None:
        text = """TYPE Recipe: STRUCT Bin_No: INT; END_STRUCT; END_TYPE
TYPE Mode: (Off, Standby, On); END_TYPE
(* Emptied by hand *)
PROGRAM P
VAR a, b: BOOL; speed: INT; r: Recipe; END_VAR
INITIAL_STEP A: Run(N); END_STEP
STEP B: END_STEP
TRANSITION FROM A TO B := NOT a AND b; END_TRANSITION
TRANSITION FROM B TO A := TRUE; END_TRANSITION
ACTION Run: b := a;
speed := speed * 2; END_ACTION
END_PROGRAM
CONFIGURATION C RESOURCE R ON PLC TASK Every_Cycle(INTERVAL := T#20ms, PRIORITY := 1);
PROGRAM I WITH Every_Cycle: P; END_RESOURCE END_CONFIGURATION
"""
        page = tmp_path / "page.html"
        page.write_text(sfc.page(sfc.loads(text.encode(), format="iec-text")), encoding="ascii")
        browser.open(page)
        browser.evaluate(f"field.value = '{wanted}'; look(); all('#found a')[0].click()")
        assert label in browser.evaluate("look(), document.querySelector('#found a').textContent")
        assert browser.evaluate("document.querySelector(':target').localName") == place
        assert browser.messages == []

    def test_a_search_tells_steps_of_one_name_and_the_parts_of_a_finding_apart(
        self, browser: Browser, tmp_path: Path
    ) -> None:
        text = "".join(f"CHART {name}\nINITIAL STEP 1\n1 -> 2 : a\nSTEP 2\n2 -> 1 : /a\n" for name in ("G1", "G2"))
        page = tmp_path / "page.html"
        page.write_text(sfc.page(sfc.loads(f"GRAFCET Z\nINPUTS\n    a\n{text}".encode())), encoding="ascii")
        browser.open(page)
        shown = "all('#found a').map((each) => each.textContent)"
        assert {"1 – Z / G1", "1 – Z / G2"} <= {*browser.evaluate(f"field.value = '1', look(), {shown}")}
        assert {"a – Z", "G1 – Z"} <= {*browser.evaluate(f"field.value = 'a', look(), {shown}")} | {
            *browser.evaluate(f"field.value = 'g1', look(), {shown}")
        }
        found = browser.evaluate(f"field.value = 'rename one', look(), {shown}")
        assert any(re.search(r"line \d+ Rename one of them", each) for each in found)

    def test_a_page_of_500_steps_opens_and_is_searched(self, browser: Browser, tmp_path: Path) -> None:
        page = tmp_path / "page.html"
        page.write_text(sfc.page(next(blocks(500).charts()).pou.project), encoding="ascii")
        browser.open(page)
        assert browser.evaluate("all('g.step').length") >= 500
        last = browser.evaluate("all('g.step')[499].querySelector('title').textContent.split(' ')[1]")
        browser.evaluate(f"field.value = '{last}'; look(); all('#found a')[0].click()")
        assert browser.evaluate("document.querySelector(':target').dataset.name") == last
        assert browser.messages == []

    def test_on_a_phone_and_on_paper_nothing_is_wider_than_there_is_room(
        self, browser: Browser, conveyor: str, tmp_path: Path
    ) -> None:
        page = tmp_path / "page.html"
        page.write_text(conveyor, encoding="ascii")
        browser.open(page, width=390, height=800)
        assert browser.evaluate("document.documentElement.scrollWidth") <= 390
        assert browser.evaluate("byId('contents').open") is False
        browser.open(page, width=720, printed=True)  # A4
        assert browser.evaluate("getComputedStyle(document.querySelector('.steps tr')).display") == "grid"
        wide = "all('.steps th, .steps td').filter((each) => each.scrollWidth > each.clientWidth)"
        assert browser.evaluate(f"{wide}.map((each) => each.textContent)") == []

    def test_a_long_chart_is_printed_in_the_width_of_the_paper(self, browser: Browser, tmp_path: Path) -> None:
        """It was on one sheet, with letters of a third of a point."""
        steps = "".join(f"STEP {n}\n{n} -> {n + 1} : a\n" for n in range(2, 60))
        page = tmp_path / "page.html"
        page.write_text(sfc.page(sfc.loads(f"GRAFCET H\nINITIAL STEP 1\n1 -> 2 : a\n{steps}STEP 60\n".encode())))
        browser.open(page, width=720, printed=True)  # A4
        assert browser.evaluate("document.querySelector('figure svg text').getBoundingClientRect().height") > 8

    def test_nothing_of_a_project_is_executed(self, browser: Browser, tmp_path: Path) -> None:
        page = tmp_path / "page.html"
        page.write_text(sfc.page(nasty_project()), encoding="ascii")
        browser.open(page)
        assert browser.evaluate("document.title") == NASTY
        assert browser.evaluate("document.querySelectorAll('img').length") == 0
        # what gets in all the same is stopped by the policy
        script = "document.head.append(Object.assign(document.createElement('script'), {text: 'document.title = 1'}))"
        browser.evaluate(script)
        assert browser.evaluate("document.title") == NASTY

    @pytest.mark.parametrize(
        ("file", "name", "image"),
        [
            ("codesys/sorting_conveyor.xml", "FB_Pusher", "pusher"),
            ("codesys/sorting_conveyor.xml", "FB_Pusher", "pusher-dark"),
            ("simaticml/FB_Drill.xml", "FB_Drill", "drill"),
            ("grafcet/two_cylinders.gct", "Zylinder", "cylinders"),
            ("training-chain/classic_flip-flops.xml", "Ablauf", "flip-flops"),
        ],
    )
    def test_pictures_look_in_pages_as_in_the_documentation(
        self, browser: Browser, tmp_path: Path, file: str, name: str, image: str
    ) -> None:
        alone = (ROOT / "docs" / "images" / f"{image}.svg").read_text(encoding="ascii")
        self.compare_screenshots(browser, tmp_path, sfc.load(FIXTURES / file), name, alone, dark="dark" in image)

    @pytest.mark.parametrize("printed", [False, True])
    @pytest.mark.parametrize("name", ["FB_Pusher", "PLC_PRG.ACT_Belt"])
    def test_pictures_look_in_pages_as_they_do_alone(
        self, browser: Browser, tmp_path: Path, name: str, *, printed: bool
    ) -> None:
        project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
        body = next(body for found, _, body in project.bodies() if found == name)
        of = body.chart if isinstance(body, sfc.SfcBody) else body
        alone = of.to_svg(theme="print" if printed else "light")
        self.compare_screenshots(browser, tmp_path, project, name, alone, printed=printed)

    @staticmethod
    def compare_screenshots(
        browser: Browser,
        folder: Path,
        project: sfc.Project,
        name: str,
        alone: str,
        *,
        dark: bool = False,
        printed: bool = False,
    ) -> None:
        texts = {"page.html": sfc.page(project), "alone.html": f"<!DOCTYPE html><body>{alone}"}
        shots = []
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="ascii")
            browser.open(folder / file, height=1600, dark=dark, printed=printed)
            picture = f"document.querySelector(`[data-name='{name}'] svg`) || document.querySelector('svg')"
            style = "'margin:0;display:block;background:white'"
            browser.evaluate(f"document.body.replaceChildren({picture}); document.body.style.cssText = {style}")
            browser.evaluate("document.documentElement.style.cssText = 'background:white;color-scheme:light'")
            # findings have colours in pages alone
            unmarked = "each.classList.remove(...[...each.classList].filter((kind) => kind.startsWith('found-')))"
            browser.evaluate(f"for (const each of document.querySelectorAll('svg g')) {unmarked}")
            # a text that is divided by links is shaped in pieces, some pixels of which may differ
            whole = "for (const a of document.querySelectorAll('svg text a')) a.replaceWith(a.textContent);"
            browser.evaluate(f"{whole} document.querySelectorAll('svg text').forEach(text => text.normalize())")
            shots.append(browser.screenshot())
        assert shots[0] == shots[1]


def test_names_in_a_picture_are_links(conveyor: str) -> None:
    tree = parse(conveyor)
    (variable,) = tree.xpath("//section[@data-name='FB_Pusher']//tr[@data-name='xExtend']/@id")
    links = tree.xpath(f"//svg//text/a[@href='#{variable}']")
    assert {each.text for each in links} == {"xExtend"}
    assert not tree.xpath("//svg//text[@class='remark']/a | //svg//text[@class='name']/a")


@pytest.mark.slow
def test_what_a_comparison_did_not_reach_is_marked() -> None:
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    pusher = project.pou("FB_Pusher")
    verdict = sfc.equivalent(pusher, pusher, runs=1, scans=5, cap=10)
    missing = {each.name for each in verdict.coverage[0].unreached if each.kind == "step"}
    assert missing == {"Release"}
    tree = parse(sfc.page(project, verdict=verdict, lang="de"))
    marked = tree.xpath("//*[contains(@class, 'step') and contains(@class, 'unreached')]/title")
    assert [each.text.splitlines()[0] for each in marked] == ["Schritt Release"]
    (section,) = tree.xpath("//section[@id='coverage']")
    assert english_in(words_of(section)) == []
    assert "nicht erreicht Schritt Release: braucht xQuit, nie eingetreten" in words_of(section)
    behind = [words_of(each) for each in section.findall(".//li") if "hinter diesen" in words_of(each)]
    assert behind == [
        "hinter diesen Schritten nicht erreicht: Transition Release -> Retracting, Zuweisung uiJams := uiJams + 1"
    ]
    assert not parse(sfc.page(project)).xpath("//*[contains(@class, 'unreached')]")


def test_transitions_of_several_steps_are_marked_too() -> None:
    text = """
PROGRAM P
VAR_INPUT a : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
STEP A: END_STEP
STEP B: END_STEP
TRANSITION FROM S1 TO (A, B) := a; END_TRANSITION
TRANSITION FROM (A, B) TO S1 := a AND NOT a; END_TRANSITION
END_PROGRAM
"""
    project = sfc.loads(text.encode(), format="iec-text")
    verdict = sfc.equivalent(project.pous[0], project.pous[0])
    tree = parse(sfc.page(project, verdict=verdict))
    (marked,) = tree.xpath("//*[contains(@class, 'impossible')]")
    assert marked.findtext("title") == "Transition A+B -> S1: a AND NOT a"
    assert tree.xpath("//section[@id='coverage']//li/a/@href") == [f"#{marked.get('id')}"]


def test_program_text_in_a_verdict_is_code() -> None:
    """It was in backquotes, and a semicolon stood before the reason."""
    text = """PROGRAM P
VAR a, b, q: BOOL; n: INT; END_VAR
INITIAL_STEP A: Act(N); END_STEP
TRANSITION FROM A TO A := a AND n = 7; END_TRANSITION
ACTION Act: IF n = 5 OR b THEN q := TRUE; END_IF; END_ACTION
END_PROGRAM
"""
    project, other = sfc.loads(text.encode()), sfc.loads(text.replace("n = 7", "n = 8").encode())
    for lang, words in (("en", "not reached assignment"), ("de", "nicht erreicht Zuweisung")):
        tree = parse(sfc.page(project, verdict=sfc.equivalent(project, other), lang=lang))
        section = tree.get_element_by_id("coverage")
        assert "`" not in words_of(section)
        (item,) = [each for each in section.iter("li") if words in words_of(each)]
        assert [each.text for each in item.iter("code")] == ["q := TRUE", "n = 5 OR b"]
        assert f"{words} q := TRUE: " in words_of(item)


def test_findings_of_readers_and_ends_of_charts_are_told_in_german() -> None:
    text = """PROGRAM P
INITIAL_STEP A: END_STEP
STEP B: END_STEP
TRANSITION FROM A TO B := x; END_TRANSITION
TRANSITION FROM A TO Nein := y; END_TRANSITION
END_PROGRAM
"""
    project = sfc.loads(text.encode(), format="iec-text")
    chart = project.pous[0].chart
    chart.add_transition(chart.step("B"), [], "z")
    page = parse(sfc.page(project, lang="de"))
    assert "TO nennt 'Nein': das ist kein Schritt dieser Ablaufkette" in words_of(page)
    assert "Transition B -> nirgendwohin: z" in [title.text for title in page.iter("title")]
    assert "Transition B -> nirgendwohin" in words_of(page.get_element_by_id("findings"))
    assert "nowhere" not in words_of(page)
    assert "nowhere" in words_of(parse(sfc.page(project)))


def test_findings_are_told_in_german() -> None:
    words = Words("de")
    assert {rule.code for rule in all_rules() if words.message(rule.hint) == rule.hint} == set()
    tree = parse(sfc.page(sfc.load(FIXTURES / "iectext" / "distribution_belt.st"), lang="de"))
    found = words_of(tree.xpath("//section[@id='findings']")[0])
    assert "Warnung ACT02 GVL_EA.K2_BandLinks wird hier gesetzt (SD), und Schritt Zurueck_Platz1 schreibt" in found, (
        found
    )


def test_a_grafcet_with_all_steps_in_partial_charts_is_no_chart_more() -> None:
    text = "GRAFCET G\n{}INITIAL STEP 1\n1 -> 2 : 1\nSTEP 2\n2 -> 1 : 1\n"
    for head, count in (("CHART G1\n", 1), ("", 1), ("CHART G0\nINITIAL STEP 9\n9 -> 9 : 1\nCHART G1\n", 2)):
        project = sfc.loads(text.format(head).encode(), format="grafcet-text")
        assert parse(sfc.page(project)).xpath("//tr[th='Charts']/td/text()") == [str(count)]


def test_verdicts_tell_transitions_that_lead_nowhere_in_german() -> None:
    text = b"GRAFCET G\nINPUTS\n    a\nINITIAL STEP 1\n1 -> 2 : a\nSTEP 2\n2 -> : a * /a\n2 -> 1 : a\n"
    project = sfc.loads(text, format="grafcet-text")
    verdict = sfc.equivalent(project, project)
    told = words_of(parse(sfc.page(project, verdict=verdict, lang="de")).get_element_by_id("coverage"))
    assert "Transition 2 -> nirgendwohin" in told
    assert "nowhere" not in told


def test_findings_tell_kinds_of_actions_in_german() -> None:
    words = Words("de")
    kinds = [kind.words for kind in ActionKind if kind is not ActionKind.FORCING]
    for form in (
        "is set here ({0}), and step 2 writes it while it is active ({0})",
        "is assigned here, and stored ({0}) in step 2",
    ):
        for kind in kinds:
            told = words.message(f"K2 {form.format(kind)}")
            assert "K2 wird hier" in told
            assert kind not in told
    project = sfc.loads(
        b"""GRAFCET G
INPUTS
    a
OUTPUTS
    K2
CHART G1
    INITIAL STEP 1
        ON DEACTIVATION K2 := FALSE
    1 -> 2 : a
    STEP 2
        K2 FOR 500ms
    2 -> 1 : /a
""",
        format="grafcet-text",
    )
    found = words_of(parse(sfc.page(project, lang="de")).xpath("//section[@id='findings']")[0])
    assert (
        "K2 wird hier gespeichert (bei Deaktivierung), und Schritt 2 schreibt es, solange er aktiv ist (zeitbegrenzt)"
        in found
    )


@pytest.mark.parametrize(
    ("message", "told"),
    [
        ("D is delayed in IEC 60848", "D ist verzögert in IEC 60848"),
        (
            "delayed with a condition has no qualifier: lower the GRAFCET, which makes proven code of it",
            "verzögert mit einer Bedingung hat kein Bestimmungszeichen: `lower` macht aus dem GRAFCET bewiesenen Code",
        ),
        (
            "a continuous action gives n the value 0: only Booleans have one",
            "eine kontinuierliche Aktion gibt n den Wert 0: das können nur boolesche Variable",
        ),
        ("the initial value of BOOL is a number: 4", "der Anfangswert von BOOL ist eine Zahl: 4"),
    ],
)
def test_messages_with_kinds_in_them_are_german_throughout(message: str, told: str) -> None:
    words = Words("de")
    assert words.message(message) == told
    assert "a continuous" not in words.verdict(message), "as a run ends with it"


def test_labels_of_source_transitions_are_german_in_reports() -> None:
    told = Words("de").message(
        "the target fires transitions once in a scan, code of `lower` until none can fire: "
        "nowhere -> Step1 may fire a scan later, for flags and stored variables are read"
    )
    assert "nirgends -> Step1 können" in told


def test_two_actions_of_a_step_on_one_variable_are_two_uses() -> None:
    text = "GRAFCET G\nINPUTS\n    a\nOUTPUTS\n    K2\nINITIAL STEP 1\n    ON ACTIVATION K2 := TRUE\n"
    text += "    ON DEACTIVATION K2 := FALSE\n1 -> 2 : a\nSTEP 2\n2 -> 1 : /a\n"
    page = parse(sfc.page(sfc.loads(text.encode(), format="grafcet-text")))
    told = [words_of(each) for each in page.xpath("//details[@class='uses']") if "action K2" in words_of(each)]
    (uses,) = told
    assert uses.startswith("Used in 2")
    assert "step 1 / action K2 (2)" in uses


def test_what_is_drawn_before_a_condition_is_used_at_its_transition() -> None:
    """It was used at "POU .. / block SettleTimer", and the page has no such place."""
    page = parse(sfc.page(sfc.load(FIXTURES / "plcopen" / "every_element_2.01.xml")))
    (row,) = page.xpath("//tr[@data-name='SettleTimer']")
    (place,) = row.xpath(".//details[@class='uses']//a")
    assert words_of(place) == "POU Mixer / transition HeatDone+StirSettle -> Sample"
    assert "transition" in page.get_element_by_id(place.get("href")[1:]).get("class")
    conditions = [words_of(each) for each in page.xpath("//code") if "with SettleTimer(" in words_of(each)]
    assert set(conditions) == {"SettleTimer.Q, with SettleTimer(IN := rising edge of StirSettle.X, PT := T#5s)"}
