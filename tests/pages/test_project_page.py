"""A project as a page: what is in it, what its links lead to, and what cannot happen there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lxml import html

import plcopen_sfc as sfc
from plcopen_sfc import model as sfc_model
from plcopen_sfc.analysis.checks import all_rules
from plcopen_sfc.pages.page_words import Words
from tests.pages.browser import Browser

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


def test_both_languages_have_all_words() -> None:
    project = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    german, english = (parse(sfc.page(project, lang=lang)) for lang in ("de", "en"))
    assert german.get("lang") == "de"
    assert "Verriegelung #GuardClosed" in words_of(german)
    assert "interlock #GuardClosed" in words_of(english)
    used: set[str] = set()
    for module in (ROOT / "plcopen_sfc" / "pages").glob("*.py"):
        used.update(re.findall(r'words\(f?"([^"]+)"', module.read_text(encoding="utf-8")))
    tables = [ROOT / "plcopen_sfc" / "pages" / name for name in ("page_words.py", "report_words.py")]
    listed = "".join(table.read_text(encoding="utf-8") for table in tables)
    assert [word for word in sorted(used) if f'    "{word}": ' not in listed] == []
    with pytest.raises(sfc.ModelError, match="pages have no language 'fr'"):
        sfc.page(project, lang="fr")


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

    def test_on_a_phone_nothing_is_wider_than_the_screen(self, browser: Browser, conveyor: str, tmp_path: Path) -> None:
        page = tmp_path / "page.html"
        page.write_text(conveyor, encoding="ascii")
        browser.open(page, width=390, height=800)
        assert browser.evaluate("document.documentElement.scrollWidth") <= 390
        assert browser.evaluate("byId('contents').open") is False

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

    @pytest.mark.parametrize("name", ["FB_Pusher", "PLC_PRG.ACT_Belt"])
    def test_pictures_look_in_pages_as_they_do_alone(
        self, browser: Browser, conveyor: str, tmp_path: Path, name: str
    ) -> None:
        project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
        body = next(body for found, _, body in project.bodies() if found == name)
        alone = body.chart.to_svg() if isinstance(body, sfc.SfcBody) else body.to_svg()
        texts = {"page.html": conveyor, "alone.html": f"<!DOCTYPE html><body>{alone}"}
        shots = []
        for file, text in texts.items():
            (tmp_path / file).write_text(text, encoding="ascii")
            browser.open(tmp_path / file)
            picture = f"document.querySelector(`[data-name='{name}'] svg`) || document.querySelector('svg')"
            browser.evaluate(
                f"document.body.replaceChildren({picture}); document.body.style.cssText = 'margin:0;display:block'"
            )
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
    assert [each.text.splitlines()[0] for each in marked] == ["Step Release"]
    (section,) = tree.xpath("//section[@id='coverage']")
    assert "nicht erreicht Schritt Release: needs `xQuit`, never reached" in words_of(section)
    assert not parse(sfc.page(project)).xpath("//*[contains(@class, 'unreached')]")


def test_findings_are_told_in_german() -> None:
    words = Words("de")
    assert {rule.code for rule in all_rules() if words.finding(rule.hint) == rule.hint} == set()
    tree = parse(sfc.page(sfc.load(FIXTURES / "iectext" / "distribution_belt.st"), lang="de"))
    found = words_of(tree.xpath("//section[@id='findings']")[0])
    assert "Warnung ACT02 GVL_EA.K2_BandLinks wird hier gesetzt (SD), und Schritt Zurueck_Platz1 schreibt" in found, (
        found
    )
