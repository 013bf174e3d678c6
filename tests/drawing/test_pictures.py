"""Pictures of charts: tidy, safe, the same in every run, with everything that a chart says."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.drawing import DrawingStyle, draw, fits, layout
from plcopen_sfc.errors import SfcError
from plcopen_sfc.model import SfcNetwork
from plcopen_sfc.model.actions import ActionKind, ForcedSituation, ForcingOrder
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.drawing import STEPS, Places
from plcopen_sfc.model.project import Chart
from plcopen_sfc.model.sfc import (
    ActionAssociation,
    BodyCondition,
    Enclosure,
    Macro,
    PartialChart,
    PartialChartKind,
    SfcBody,
    Supervised,
)
from plcopen_sfc.semantics.profile import Competing, default_profile
from tests.corpus import ROOT, corpus_files, require_corpus
from tests.drawing.nets import any_net, entered_net, make, nested_net
from tests.drawing.pictures import SVG, Picture, area, assert_tidy, links_in, points, read_picture
from tests.sweeps import examples

FIXTURES = ROOT / "fixtures"
CHARTS = st.one_of(any_net(), nested_net(), entered_net())
STYLES = ["iec", "grafcet", "s7graph"]


def charts_in(paths: list[Path]) -> Iterator[tuple[Path, Chart]]:
    for path in paths:
        try:
            project = sfc.load(path)
        except SfcError:
            continue
        for chart in project.charts():
            yield path, chart


def fixture_charts() -> list[tuple[Path, Chart]]:
    files = sorted(path for path in FIXTURES.rglob("*") if path.suffix in {".xml", ".st", ".json"})
    return list(charts_in([path for path in files if path.name != "entity_bomb.xml"]))


def drawn(chart: SfcNetwork, *, style: str | None = None, fresh: bool = False) -> Picture:
    picture = read_picture(chart.to_svg(style=style, fresh=fresh))
    assert_tidy(picture)
    return picture


def links_of(chart: SfcNetwork) -> set[tuple[str, str]]:
    into = {(f"step-{step}", f"transition-{t.id}") for t in chart.transitions for step in t.sources}
    return into | {(f"transition-{t.id}", f"step-{step}") for t in chart.transitions for step in t.targets}


def element(picture: Picture, identifier: str) -> object:
    (found,) = picture.root.xpath("//*[@id=$id]", id=identifier)
    return found


class TestEveryChart:
    @pytest.mark.slow
    @pytest.mark.parametrize("style", STYLES)
    def test_fixtures_are_drawn_whole_and_tidy(self, style: str) -> None:
        charts = fixture_charts()
        assert len(charts) > 30
        for path, chart in charts:
            picture = drawn(chart.chart, style=style)
            main = Picture(picture.root, wires=picture.wires)
            links = {link for link in links_in(main) if not link[0].startswith("part-")}
            assert links == links_of(chart.chart), path
            ids = picture.root.xpath("//@id")
            assert len(ids) == len(set(ids)), path
            wanted = {f"step-{step.id}" for step in chart.chart.steps}
            wanted |= {f"transition-{transition.id}" for transition in chart.chart.transitions}
            wanted |= {f"action-{association.id}" for _, association in chart.chart.associations()}
            assert wanted <= set(ids), path
            assert {link.removeprefix("#") for link in picture.root.xpath("//@href")} <= set(ids), path

    @pytest.mark.slow
    @given(chart=CHARTS, actions=st.integers(0, 3), style=st.sampled_from(STYLES))
    def test_any_chart_is_tidy(self, chart: SfcNetwork, actions: int, style: str) -> None:
        for step in chart.steps[::2]:
            for _ in range(actions):
                step.actions.append(ActionAssociation(id=chart.new_id(), target="ConveyorMotorForward"))
        picture = drawn(chart, style=style)
        assert len(picture.by_class("step")) == len(chart.steps)
        assert len(picture.by_class("transition")) == len(chart.transitions)

    @pytest.mark.slow
    @settings(max_examples=examples(20))
    @given(chart=nested_net())
    def test_places_of_a_file_are_kept_and_tidy(self, chart: SfcNetwork) -> None:
        """The order from left to right and down of symbols of one kind is that of the file, and nothing is lost."""
        for step in chart.steps[::2]:
            step.actions.append(ActionAssociation(id=chart.new_id(), target="ConveyorMotorForward"))
        chart.drawing = draw(chart, DrawingStyle.PLAIN)
        assert fits(chart)
        layout(chart)
        chart.drawing.places = Places.GIVEN
        picture = drawn(chart)
        assert links_in(picture) == links_of(chart)
        shown = {element.get("id"): area for element, area in picture.areas}
        assume(chart.to_svg() != chart.to_svg(fresh=True))  # laid out: its wires cross
        at = {f"step-{symbol.id}": symbol for symbol in chart.drawing.symbols if symbol.kind in STEPS}
        for one, other in pairwise(sorted(at, key=lambda step: at[step].position[1])):
            if at[one].position[1] < at[other].position[1]:
                assert shown[one][1] < shown[other][1]

    def test_places_of_a_file_have_the_arrows_of_jumps(self) -> None:
        chart = sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml").pous[0].chart
        picture = drawn(chart)
        assert chart.to_svg() != chart.to_svg(fresh=True)
        arrows = {g.findtext(f"{SVG}title") for g in picture.by_class("reference")}
        assert arrows == {"From Recover", "From CheckBatch", "From BatchDone"}

    def test_an_end_of_a_wire_that_leads_back_on_itself_is_not_drawn(self) -> None:
        chart = sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml").pous[0].chart
        before = chart.to_svg()
        pins = [pin for symbol in chart.drawing.symbols for pin in symbol.inputs]
        bent = [each for pin in pins for each in pin.connections if len(each.points or ()) > 3]
        assert bent
        for connection in bent:
            one, (x, y), *others = connection.points
            beyond = (x, y + 30) if x == one[0] and y > one[1] else (x, y - 30) if x == one[0] else (x + 30, y)
            connection.points = [one, beyond, (x, y), *others]
        assert chart.to_svg() == before

    @pytest.mark.slow
    @pytest.mark.corpus
    def test_real_charts_are_tidy(self) -> None:
        """A third of the files of each format, the same in every run; PLCOPEN_SFC_FULL draws all."""
        require_corpus()
        step = 1 if os.environ.get("PLCOPEN_SFC_FULL") else 3
        kinds = ("plcopen", "codesys", "twincat", "codesys23", "simaticml", "iectext")
        files = [path for kind in kinds for path in corpus_files(kind)[::step]]
        seen = 0
        for path, chart in charts_in(files):
            picture = read_picture(chart.chart.to_svg())
            assert len(picture.by_class("step")) >= len(chart.chart.steps), (path, chart.name)
            assert_tidy(picture)
            seen += 1
        assert seen > 50

    @pytest.mark.slow
    @given(chart=CHARTS)
    def test_a_picture_says_where_each_transition_leads(self, chart: SfcNetwork) -> None:
        """A reader of the wires, bars, jumps and references finds the links of the chart and no others."""
        assert links_in(read_picture(chart.to_svg())) == links_of(chart)

    def test_links_that_do_not_nest_are_references(self) -> None:
        chart = make(6, [([0], [1, 2]), ([1], [3]), ([2], [4]), ([3, 4], [5]), ([5], [0]), ([3], [1]), ([4], [5])])
        picture = drawn(chart)
        assert links_in(picture) == links_of(chart)
        assert sorted(text for jump in picture.by_class("jump") for text in picture.texts(jump)) == ["S0", "S1", "S5"]

    def test_a_step_that_two_jumps_come_from_is_named_once(self) -> None:
        chart = make(4, [([0], [1]), ([1], [2]), ([2], [0]), ([2], [0]), ([1], [3]), ([3], [0])])
        picture = drawn(chart)
        names = [name for part in picture.by_class("reference") for name in picture.texts(part)]
        assert sorted(names) == ["S2", "S3"]

    @pytest.mark.slow
    def test_a_long_chart_is_drawn(self) -> None:
        count = 10_000
        chart = make(count, [([i], [(i + 1) % count]) for i in range(count)])
        svg = chart.to_svg()
        assert svg.count('class="step') == count
        assert svg.count('class="transition"') == count

    @pytest.mark.parametrize(
        "edges",
        [
            [e for i in range(499) for e in (([i], [i + 1]), ([i], [i]), ([i], [0]))],
            [([i], [i + 1, 999 - i]) for i in range(499)] + [([i], [i + 1]) for i in range(500, 999)],
            [([0], [i]) for i in range(1, 1000)],
        ],
        ids=["comb", "deep", "wide"],
    )
    def test_large_charts_of_any_form(self, edges: list[tuple[list[int], list[int]]]) -> None:
        chart = make(1000, edges)
        assert chart.to_svg().count('class="step') == 1000


class TestSafety:
    NASTY = "</text><script>alert(1)</script> \"x\" 'y' & \x00\x08\ud800\ufffe\u2028 Größe \U0001f600 漢字"

    def test_nothing_from_a_file_is_markup(self) -> None:
        nasty = self.NASTY
        chart = SfcNetwork()
        for number in range(2):
            step = chart.add_step(f"{nasty}{number}", initial=not number)
            step.comment = step.title = nasty
            step.actions.append(
                ActionAssociation(id=chart.new_id(), target=nasty, duration=None, indicator=nasty, value=nasty)
            )
            step.entry_action = nasty
            step.interlock = Supervised(condition=nasty, title=nasty)
        for one, other in ((0, 1), (1, 0)):
            transition = chart.add_transition(chart.steps[one], chart.steps[other], nasty)
            transition.name = transition.comment = nasty
        for style in STYLES:
            picture = drawn(chart, style=style)
            tags = {etree.split("}")[-1] for etree in {each.tag for each in picture.root.iter()}}
            assert tags <= {"svg", "title", "desc", "style", "g", "rect", "path", "text", "a"}
            assert "\ufffd" in "".join(picture.texts())
            assert "Größe" in "".join(picture.texts())

    def test_nothing_is_loaded_from_elsewhere(self) -> None:
        svg = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml").pou("PLC_PRG").chart.to_svg()
        assert svg.isascii()
        assert not re.search(r"(?:src|url|@import|javascript|on\w+=)", svg)
        assert re.findall(r"https?://[^\"' ]*", svg) == ["http://www.w3.org/2000/svg"]
        assert all(link.startswith("#") for link in re.findall(r'href="([^"]*)"', svg))

    @pytest.mark.slow
    def test_the_same_bytes_in_every_process(self) -> None:
        path = FIXTURES / "plcopen" / "filling_station_2.01.xml"
        program = f"import plcopen_sfc as s; print(s.load({str(path)!r}).pou('FillingStation').chart.to_svg())"
        runs = {
            subprocess.run(
                [sys.executable, "-c", program],
                env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)},
                capture_output=True,
                check=True,
            ).stdout
            for seed in ("0", "1")
        }
        assert len(runs) == 1

    def test_drawing_changes_no_chart(self) -> None:
        path = FIXTURES / "plcopen" / "filling_station_2.01.xml"
        project = sfc.load(path)
        for chart in project.charts():
            chart.chart.to_svg()
        assert sfc.dumps(project) == path.read_bytes()


class TestSymbols:
    def test_initial_steps_have_two_frames(self) -> None:
        picture = drawn(make(2, [([0], [1])]))
        frames = [len(element(picture, f"step-{i}").findall(f"{SVG}rect")) for i in range(2)]
        assert frames == [2, 1]

    def test_simultaneous_branches_have_double_bars(self) -> None:
        simultaneous = drawn(make(4, [([0], [1, 2]), ([1, 2], [3]), ([3], [0])]))
        selection = drawn(make(4, [([0], [1]), ([0], [2]), ([1], [3]), ([2], [3]), ([3], [0])]))

        def bars(picture: Picture) -> list[int]:
            return sorted(y for x, y, end, below in picture.wires if y == below and end - x > 60)

        assert [b - a for a, b in zip(bars(simultaneous)[::2], bars(simultaneous)[1::2], strict=True)] == [4, 4]
        assert len(bars(selection)) == 2

    def test_branches_are_in_the_order_of_their_priority(self) -> None:
        chart = make(4, [([0], [1]), ([0], [2]), ([0], [3])])
        for transition, priority in zip(chart.transitions, (3, 1, 2), strict=True):
            transition.priority = priority
        picture = drawn(chart)
        places = {t.priority: area(element(picture, f"transition-{t.id}"))[0] for t in chart.transitions}
        assert places[1] < places[2] < places[3]
        for transition in chart.transitions:
            assert str(transition.priority) in picture.texts(element(picture, f"transition-{transition.id}"))
        assert "*" not in picture.texts()

    def test_without_priorities_a_selection_has_an_asterisk(self) -> None:
        for style, count in (("iec", 1), ("grafcet", 1), ("s7graph", 0)):  # GRAPH has this order for all
            assert drawn(make(3, [([0], [1]), ([0], [2])]), style=style).texts().count("*") == count
        grafcet = sfc.load(FIXTURES / "grafcet" / "every_symbol.gct").pous[0].chart
        assert 'class="star"' not in grafcet.to_svg(style="iec"), "in GRAFCET all of them fire together"

    @pytest.mark.parametrize(("tool", "count"), [("Beremiz", 0), ("Acme", 2)])
    def test_an_asterisk_says_what_the_tool_does(self, tool: str, count: int) -> None:
        """Charts of Beremiz had one, and there all transitions that are true fire."""
        project = sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml")
        project.header.company = project.header.product = tool
        assert (default_profile(project).competing is Competing.ALL) == (count == 0)
        chart = project.pou("FillingStation").chart
        for transition in chart.transitions:
            transition.priority = None
        assert drawn(chart, fresh=True).texts().count("*") == count

    @pytest.mark.parametrize("edge", ["\u2193", ""])
    def test_a_grafcet_without_actions_is_drawn_as_one(self, edge: str) -> None:
        """It was drawn as a chart of IEC 61131-3, with an asterisk, and all its transitions that are true fire."""
        text = f"GRAFCET G\nINPUTS\n    a\nINITIAL STEP 1\n1 -> 2 : a\n1 -> 3 : /a\nSTEP 2\nSTEP 3\n2 -> 1 : {edge}a\n"
        project = sfc.loads(text.encode())
        chart = project.pous[0].chart
        assert default_profile(project).competing is Competing.ALL
        assert chart.to_svg() == chart.to_svg(style="grafcet")
        assert drawn(chart).texts().count("*") == 0

    def test_a_branch_of_a_branch_has_one_line(self) -> None:
        """Where the last branch of one divergence goes on to the end of the one around it, two lines were drawn."""
        edges = [([0], [1]), ([0], [2]), ([1], [3]), ([2], [3]), ([2], [0]), ([0], [3]), ([3], [0])]
        drawn(make(4, edges))

    def test_branches_that_a_file_draws_in_another_order_have_their_turns(self) -> None:
        """Above them was the asterisk, by which they are tried from left to right, and they are not."""
        chart = make(3, [([0], [1]), ([0], [2]), ([1], [0]), ([2], [0])])
        chart.drawing = draw(chart, DrawingStyle.PLAIN)
        layout(chart)
        assert chart.drawing is not None
        chart.drawing.places = Places.GIVEN
        chart.transitions[:2] = chart.transitions[1::-1]
        for style in ("iec", "grafcet", "s7graph"):
            picture = drawn(chart, style=style)
            assert "*" not in picture.texts()
            for turn, transition in enumerate(chart.transitions[:2], 1):
                assert str(turn) in picture.texts(element(picture, f"transition-{transition.id}"))

    def test_an_action_block_says_when_what_and_until_when(self) -> None:
        chart = make(1, [])
        chart.steps[0].actions = [
            ActionAssociation(id=5, qualifier="D", duration="T#2s", target="Motor", indicator="xRunning"),
            ActionAssociation(id=6, qualifier="N", body=StBody(text="a := 1;\nb := 2;")),
        ]
        picture = drawn(chart)
        assert picture.texts(element(picture, "action-5")) == ["D T#2s", "Motor", "xRunning"]
        assert picture.texts(element(picture, "action-6")) == ["N", "a := 1;", "b := 2;"]

    @pytest.mark.parametrize("style", STYLES)
    def test_the_condition_of_an_action_is_above_it(self, style: str) -> None:
        """It was in the tooltip only: the picture said that the action is executed always."""
        chart = make(1, [])
        chart.steps[0].actions = [
            ActionAssociation(id=5, qualifier="N", target="Motor", condition="Ready AND Open"),
            ActionAssociation(id=6, qualifier="S", target="Lamp"),
        ]
        picture = drawn(chart, style=style)
        assert "Ready AND Open" in picture.texts(element(picture, "action-5"))
        assert "Ready AND Open" not in picture.texts(element(picture, "action-6"))

    def test_long_names_are_wrapped_wherever_they_are(self) -> None:
        """The line to an action block ended above it, and names of jumps were one line beside all the rest."""
        chart = make(3, [([0], [1]), ([1], [2]), ([1], [0]), ([2], [1])])
        name = chart.steps[1].name = "_".join(["a_name_that_is_long"] * 8)
        chart.steps[1].actions = [ActionAssociation(id=5, qualifier="N", target="Motor")]
        picture = drawn(chart)
        texts = [text.text or "" for text in picture.root.iter(f"{SVG}text")]
        assert max(map(len, texts)) < 50
        (reference,) = [
            each for each in picture.by_class("reference") if each.findtext(f"{SVG}title") == f"From {name}"
        ]
        assert "".join(picture.texts(reference)) == name
        _, top, _, bottom = area(element(picture, "action-5"))
        left = int(element(picture, "action-5").find(f"{SVG}rect").get("x"))
        (level,) = [y for x, y, end, below in picture.wires if y == below and left in (x, end)]
        assert top < level < bottom

    @pytest.mark.parametrize("operator", ["AND", "*", "+", "\u00b7"])
    def test_operators_begin_the_lines_of_long_conditions(self, operator: str) -> None:
        names = [f"LimitSwitchOfCylinder_{number}_reached" for number in range(4)]
        chart = make(1, [([0], [])])
        chart.transitions[0].condition = f" {operator} ".join(names)
        first, *rest = drawn(chart).texts()[-4:]
        assert [first, *rest] == [names[0], *(f"{operator} {name}" for name in names[1:])]

    def test_transitions_of_grafcet_have_their_numbers_in_parentheses(self) -> None:
        chart = make(2, [([0], [1]), ([1], [0])])
        chart.transitions[0].number, chart.transitions[1].name = 7, "back"
        texts = drawn(chart, style="grafcet").texts()
        assert {"(7)", "(back)"} <= set(texts)
        assert {"7", "back"} <= set(drawn(chart, style="iec").texts())

    def test_step_actions_of_codesys_are_marked(self) -> None:
        chart = make(1, [])
        chart.steps[0].entry_action, chart.steps[0].main_action, chart.steps[0].exit_action = "In", "Run", "Out"
        texts = drawn(chart).texts()
        assert {"E", "X", "entry", "main", "exit", "In", "Run", "Out"} <= set(texts)

    def test_steps_of_s7_graph_have_numbers_and_marks(self) -> None:
        chart = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml").pou("FB_Drill").chart
        picture = drawn(chart)
        drill = element(picture, f"step-{chart.step('Drill').id}")
        assert {"S3", "Drill", "V"} <= set(picture.texts(drill))
        assert "V: #Pressure < #MIN_PRESSURE (Druck)" in " ".join(picture.texts(drill))
        assert drill.findtext(f"{SVG}title") == "Step Drill. V: #Pressure < #MIN_PRESSURE (Druck)"
        assert "C" in picture.texts(element(picture, f"step-{chart.step('Clamp part').id}"))
        (deep,) = (t for t in chart.transitions if t.name == "T_Deep")
        assert {"T4", "T_Deep", "1", "#Deep"} <= set(picture.texts(element(picture, f"transition-{deep.id}")))

    def test_long_conditions_are_columns_of_operands(self) -> None:
        chart = make(2, [([0], [1])])
        names = [f"gStation.bSensor{i}_Activated" for i in range(8)]
        chart.transitions[0].condition = " AND ".join(names)
        picture = drawn(chart)
        lines = picture.texts(element(picture, "transition-2"))
        assert " ".join(lines) == " AND ".join(names)
        assert len(lines) > 2
        assert all(line.startswith("AND ") for line in lines[1:])

    def test_a_transition_without_condition_says_so(self) -> None:
        chart = make(2, [([0], [1])])
        chart.transitions[0].condition = None
        assert "(no condition)" in drawn(chart).texts()

    def test_conditions_in_bodies_are_shown(self) -> None:
        chart = make(2, [([0], [1])])
        chart.transitions[0].condition = BodyCondition(body=StBody(text="a AND b"), negated=True)
        assert "NOT ({a AND b})" in drawn(chart).texts()

    def test_branches_that_are_joined_in_two_places_begin_at_one_double_line(self) -> None:
        chart = make(6, [([0], [1, 2, 3]), ([1, 2], [4]), ([4, 3], [5])])
        picture = drawn(chart)
        assert links_in(picture) == links_of(chart)
        level = [wire for wire in picture.wires if wire[1] == wire[3] and abs(wire[2] - wire[0]) > 20]
        assert len(level) == 6

    @pytest.mark.parametrize("place", range(4))
    @pytest.mark.parametrize("source", [1, 2, 3])
    def test_a_transition_beside_a_convergence_leaves_the_convergence_whole(self, source: int, place: int) -> None:
        """A loop at the last step of a branch took all branches out of the double line."""
        edges = [([0], [1, 2, 3]), ([1, 2, 3], [4]), ([4], [0])]
        edges.insert(place, ([source], [source]))
        chart = make(5, edges)
        picture = drawn(chart)
        assert_tidy(picture)
        assert links_in(picture) == links_of(chart)
        assert not [g for g in picture.by_class("reference") if g.findtext(f"{SVG}title").startswith("Continues")]
        assert picture.texts().count("*") == 1

    def test_a_convergence_may_have_selections_above_all_its_branches(self) -> None:
        edges = [([0], [1, 2]), ([1], [3, 4]), ([3], [3]), ([4], [1]), ([3, 4], [5]), ([5], [0]), ([5, 2], [6])]
        chart = make(7, [*edges, ([2], [0])])
        picture = drawn(chart)
        assert_tidy(picture)
        assert links_in(picture) == links_of(chart)
        assert not [g for g in picture.by_class("reference") if g.findtext(f"{SVG}title").startswith("Continues")]

    def test_what_ends_nowhere_has_an_end(self) -> None:
        chart = make(1, [([0], [])])
        assert len(drawn(chart).wires) > len(drawn(make(1, [])).wires)


class TestGrafcet:
    @pytest.fixture
    def chart(self) -> SfcNetwork:
        chart = SfcNetwork()
        for number, name in enumerate(("Rest", "Clamp", "Drill", "M9"), 1):
            chart.add_step(name, initial=number == 1).number = number
        rest, clamp, drill, macro = chart.steps
        chart.add_transition(rest, [clamp, drill], "start")
        chart.add_transition([clamp, drill], macro, "5s/X2").name = "t7"
        chart.add_transition(macro, rest, "done")
        clamp.actions = [
            ActionAssociation(id=20, kind=ActionKind.CONDITIONAL, target="Valve", condition="pressure"),
            ActionAssociation(id=21, kind=ActionKind.DELAYED, target="Lamp", duration="3s"),
            ActionAssociation(id=22, kind=ActionKind.ON_ACTIVATION, target="n", value="n + 1"),
            ActionAssociation(
                id=23,
                kind=ActionKind.FORCING,
                forcing=ForcingOrder(chart="G5", situation=ForcedSituation.INITIAL),
            ),
        ]
        drill.encloses = [Enclosure(chart="G5", activated_steps=["E1"])]
        macro.macro = Macro(expansion="M9")
        inner, expansion = SfcNetwork(), SfcNetwork()
        inner.add_step("E1")
        inner.add_step("E2")
        expansion.add_step("In")
        chart.partial_charts = [
            PartialChart(name="G5", kind=PartialChartKind.ENCLOSED, chart=inner),
            PartialChart(name="M9", kind=PartialChartKind.EXPANSION, chart=expansion),
        ]
        return chart

    def test_it_is_drawn_as_grafcet_by_itself(self, chart: SfcNetwork) -> None:
        assert chart.to_svg() == chart.to_svg(style="grafcet")
        picture = drawn(chart)
        assert "1" in picture.texts(element(picture, "step-0"))
        assert "(t7)" in picture.texts()

    def test_actions_show_their_kind(self, chart: SfcNetwork) -> None:
        picture = drawn(chart)
        assert picture.texts(element(picture, "action-20")) == ["pressure", "Valve"]
        assert picture.texts(element(picture, "action-21")) == ["3s/X2", "Lamp"]
        arrow = element(picture, "action-22").findall(f"{SVG}path[@class='head']")
        tip, *back = points(arrow[0])
        assert all(y > tip[1] for _, y in back)
        assert picture.texts(element(picture, "action-23")) == ["G5{INIT}"]
        assert len(element(picture, "action-23").findall(f"{SVG}rect")) == 2

    @pytest.mark.parametrize(
        ("condition", "above"), [(None, "/(500ms/X2)"), ("a", "/(500ms/X2) * a"), ("a + b", "/(500ms/X2) * (a + b)")]
    )
    def test_limits_are_conditions_of_grafcet(self, chart: SfcNetwork, condition: str | None, above: str) -> None:
        limited = ActionAssociation(id=24, kind=ActionKind.LIMITED, target="Lamp", duration="T#500ms")
        limited.condition = condition
        chart.steps[1].actions.append(limited)
        picture = drawn(chart)
        assert picture.texts(element(picture, "action-24")) == [above, "Lamp"]

    @pytest.mark.parametrize("style", STYLES)
    def test_long_comments_of_actions_have_rows_of_their_height(self, chart: SfcNetwork, style: str) -> None:
        """Those of more than two lines lay on each other, and on the comment of the step."""
        step = chart.steps[1]
        step.comment = "step " * 30
        for number, association in enumerate(step.actions):
            association.comment = f"remark{number} " * 14
        picture = drawn(chart, style=style)
        remarks = [text for text in picture.root.iter(f"{SVG}text") if text.get("class") == "remark"]
        levels = sorted((int(text.get("y")), text.text.split()[0]) for text in remarks)
        words = list(dict.fromkeys(word for _, word in levels if word.startswith(("step", "remark"))))
        assert words == ["step", *(f"remark{number}" for number in range(4))]
        lines = [(level, word) for level, word in levels if word in words]
        for (one, word), (other, following) in pairwise(lines):
            assert other - one >= (13 if word == following else 16), (word, following)

    def test_a_comment_of_a_step_is_above_its_actions(self, chart: SfcNetwork) -> None:
        """Below them it was taken for the comment of the last one."""
        chart.steps[1].comment = "Two words"
        picture = drawn(chart)
        texts = {text.text: float(text.get("y")) for text in picture.root.iter(f"{SVG}text")}
        assert texts["Two words"] < texts["pressure"] < texts["Valve"] < texts["2"] + 44

    def test_the_name_of_a_numbered_step_is_above_its_actions(self, chart: SfcNetwork) -> None:
        """It was below the last action, and the tooltip had it twice and no number."""
        step = chart.steps[1]
        step.name, step.number, step.comment = "Fill", 88, "Two words"
        picture = drawn(chart)
        texts = {text.text: float(text.get("y")) for text in picture.root.iter(f"{SVG}text")}
        assert texts["Fill"] < texts["Two words"] < texts["pressure"] < texts["Valve"]
        assert element(picture, "step-1").findtext(f"{SVG}title") == "Step 88. Fill. Two words"
        chart.transitions[2].targets = [step.id]
        titles = [each.findtext(f"{SVG}title") for each in drawn(chart).by_class("jump")]
        assert titles == ["Jump to 88"]

    def test_what_a_step_encloses_is_above_its_actions(self, chart: SfcNetwork) -> None:
        chart.steps[1].encloses = [Enclosure(chart="G5", activated_steps=["50"])]
        picture = drawn(chart)
        texts = {text.text: float(text.get("y")) for text in picture.root.iter(f"{SVG}text")}
        assert texts["G5{50}"] < texts["pressure"]
        assert ["G5{50}"] in [[text.text for text in link.iter(f"{SVG}text")] for link in picture.root.iter(f"{SVG}a")]

    def test_partial_charts_are_in_frames_with_activation_links(self, chart: SfcNetwork) -> None:
        picture = drawn(chart)
        assert [picture.texts(part) for part in picture.by_class("part")] == [["G5 (enclosed)"], ["M9 (expansion)"]]
        assert "*" in picture.texts(element(picture, "part-1-step-0"))
        assert "*" not in picture.texts(element(picture, "part-1-step-1"))

    def test_what_has_a_chart_inside_or_forces_one_leads_to_its_frame(self, chart: SfcNetwork) -> None:
        picture = drawn(chart)

        def links(identifier: str) -> dict[str, str]:
            found = element(picture, identifier).findall(f".//{SVG}a")
            return {link.findtext(f"{SVG}text"): link.get("href") for link in found}

        assert links("action-23") == {"G5{INIT}": "#part-1"}
        assert links("step-2") == {"G5{E1}": "#part-1"}
        assert links("step-3") == {"4": "#part-2"}

    def test_content_of_macro_steps_is_drawn_too(self) -> None:
        chart = make(1, [])
        chart.steps[0].macro = Macro(body=SfcBody(chart=make(2, [([0], [1])])))
        assert element(drawn(chart), "part-1-transition-2") is not None


class TestChoices:
    def test_themes_differ_in_colours_only(self) -> None:
        chart = make(2, [([0], [1])])
        pictures = [chart.to_svg(theme=theme) for theme in ("light", "dark", "print")]
        assert len(set(pictures)) == 3
        assert len({re.sub(r"sfc-\w+|#[0-9a-f]{6}", "", svg) for svg in pictures}) == 1

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"style": "iek"}, r"there is no style 'iek' of pictures \(did you mean 'iec'\?\)"),
            ({"theme": "drak"}, r"there is no theme 'drak' of pictures \(did you mean 'dark'\?\)"),
        ],
    )
    def test_unknown_ones_are_named(self, options: dict[str, str], message: str) -> None:
        with pytest.raises(sfc.ModelError, match=message):
            make(1, []).to_svg(**options)

    def test_jupyter_shows_charts(self) -> None:
        chart = make(2, [([0], [1])])
        assert chart._repr_svg_() == chart.to_svg()
        (listed,) = sfc.load(FIXTURES / "iectext" / "mixing_plant.st").charts()
        assert listed._repr_svg_() == listed.to_svg() == listed.chart.to_svg()
        assert "sfc-print" in listed.to_svg(theme="print")

    def test_the_picture_names_itself_and_its_elements(self) -> None:
        project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
        chart = {each.name: each.chart for each in project.charts()}["PLC_PRG.ACT_Home"]
        root = read_picture(chart.to_svg()).root
        assert root.findtext(f"{SVG}title") == "PLC_PRG.ACT_Home"
        assert all(g.findtext(f"{SVG}title") for g in root.iter(f"{SVG}g"))
        ids = [g.get("id") for g in root.iter(f"{SVG}g")]
        assert all(ids)
        assert len(ids) == len(set(ids))
