"""Conversion between the dialects: there and back gives an equal model, and what is written is valid."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.errors import LossError
from plcopen_sfc.formats.plcopen.tc6_versions import validate_tc6
from plcopen_sfc.model import FbdBody, LdBody, Project, Qualifier, SfcNetwork
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.pages.page_words import german
from plcopen_sfc.report import Outcome
from tests.corpus import corpus_files, require_corpus
from tests.samples import accepting
from tests.sweeps import in_turn, some_files, some_of

FIXTURES = Path(__file__).parents[2] / "fixtures"
OWN = sorted(path for folder in ("codesys", "twincat", "plcopen") for path in (FIXTURES / folder).glob("*.xml"))
TC6 = ("plcopen-1.01", "plcopen-2.0", "plcopen-2.01")


def own_name(project: Project) -> str:
    """The format and version a project was read from, as `convert` wants it."""
    origin = project.source
    assert origin is not None
    return origin.format if origin.format == "codesys" else f"plcopen-{origin.version}"


def assert_valid_and_there_and_back(path: Path, targets: Sequence[str] = (*TC6, "json")) -> None:
    """A file written for each target is valid, where its source is, and comes back equal."""
    project = accepting(sfc.load(path))
    is_valid = not any(d.severity == "error" for d in validate_tc6(path.read_bytes()))
    own = own_name(project)
    others = [target for target in targets if target != own]
    assert others
    for target in others:
        there, report = sfc.convert(project, target, partial=True)
        assert report.with_outcome(Outcome.DROPPED) == []
        if target in TC6 and is_valid:
            assert_valid(there, target)
        back, _ = sfc.convert(accepting(sfc.loads(there)), own, partial=True)
        found = differences(project, sfc.loads(back))
        # other formats write text that is in <ST> itself as their tools do, and boxes that only CODESYS has as text
        texts = {item.path for item in report.with_outcome(Outcome.TRANSLATED) if item.why.endswith("structured text")}
        found = [d for d in found if not (d.path.endswith("markup") and "<" not in d.left) and d.path not in texts]
        assert found == [], f"{target} and back"
    if is_valid and "json" in targets:
        written, _ = sfc.convert(project, "plcopen", flavour="beremiz", partial=True)
        assert_valid(written, "beremiz")


def assert_valid(written: bytes, target: str) -> None:
    assert [str(d) for d in validate_tc6(written) if d.severity == "error"] == [], target


@pytest.mark.slow
@pytest.mark.parametrize("path", OWN, ids=lambda p: p.name)
def test_what_is_written_is_valid_and_comes_back(path: Path) -> None:
    """Two targets for each file, all with PLCOPEN_SFC_FULL."""
    targets = [target for target in (*TC6, "json") if target != own_name(sfc.load(path))]
    assert_valid_and_there_and_back(path, in_turn(targets, OWN.index(path), 2))


CORPUS = some_files([*corpus_files("codesys"), *corpus_files("plcopen")], 1, 3)
LARGE = [path for path in CORPUS if path.stat().st_size > 300_000]
"""Of these there are several, mostly of the same tool: each goes to one target only, the next to another."""


@pytest.mark.corpus
@pytest.mark.slow
@pytest.mark.parametrize("path", some_of(CORPUS, 2), ids=lambda p: p.name)
def test_what_is_written_is_valid_and_comes_back_on_the_corpus(path: Path) -> None:
    require_corpus()
    targets = [target for target in (*TC6, "json") if target != own_name(sfc.load(path))]
    assert_valid_and_there_and_back(path, in_turn(targets, CORPUS.index(path), 1 if path in LARGE else 2))


def first_chart(project: Project) -> SfcNetwork:
    return next(iter(project.charts())).chart


@pytest.mark.slow
def test_step_actions_become_associations_and_step_actions_again() -> None:
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    stepped = {s.name: s for s in first_chart(project).steps if s.entry_action or s.main_action or s.exit_action}
    assert stepped
    data, report = sfc.convert(project, "plcopen-2.01", partial=True)
    root = etree.fromstring(data)
    tc6 = "{http://www.plcopen.org/xml/tc6_0201}"
    pairs = set()
    guarded = []
    for action in root.iter(f"{tc6}action"):
        reference = action.find(f"{tc6}reference")
        if reference is not None:
            pairs.add((action.get("qualifier", "N"), reference.get("name")))
        else:
            guarded.append((action.get("qualifier", "N"), "".join(map(str, action.itertext())).strip()))
    for step in stepped.values():
        for qualifier, name in (("P1", step.entry_action), ("P0", step.exit_action)):
            # not executed where SFCReset ends the step
            asks = [text for each, text in guarded if each == qualifier and text.startswith("IF NOT (SFCReset) THEN")]
            assert name is None or (qualifier, name) in pairs or asks
        if step.main_action is not None:
            assert any(f"IF {step.name}.X THEN" in text for _, text in guarded)  # within what asks the SFC flags
    back = first_chart(sfc.loads(data))
    for name, step in stepped.items():
        found = back.step(name)
        assert (found.entry_action, found.main_action, found.exit_action) == (
            step.entry_action,
            step.main_action,
            step.exit_action,
        )
        assert found.actions == step.actions
    assert {i.what for i in report.with_outcome(Outcome.TRANSLATED)} >= {"entry action", "main action", "exit action"}


@pytest.mark.parametrize("target", ["plcopen-1.01", "plcopen-2.0", "plcopen-2.01"])
def test_titles_of_networks_are_comments_for_other_tools_and_titles_again(target: str) -> None:
    """CODESYS has elements of its own for them, of which no other tool knows that they do nothing."""
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    data, _ = sfc.convert(project, target, partial=True)
    assert b"<vendorElement" not in data
    seen, own = sfc.loads(data, as_tool=True).pou("PLC_PRG"), project.pou("PLC_PRG")
    for action in (action for action in own.actions if isinstance(action.body, FbdBody | LdBody)):
        there = seen.action(action.name).body
        assert isinstance(there, FbdBody | LdBody)
        titles = [
            node.alternative_text for n in action.body.networks for node in n.nodes if node.kind == "vendorElement"
        ]
        comments = [str(node.content) for n in there.networks for node in n.nodes if node.kind == "comment"]
        assert {str(each) for each in titles} - {"FBD Implementation Attributes"} <= set(comments)
    back = sfc.convert(sfc.loads(data), "codesys", partial=True)[0]
    assert list(differences(project, sfc.loads(back))) == []


@pytest.mark.slow
def test_times_and_flags_are_carried_and_in_the_report() -> None:
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    data, report = sfc.convert(project, "plcopen-2.01")
    translated = report.with_outcome(Outcome.TRANSLATED)
    assert "max time" in {item.what for item in translated}
    assert "POU PLC_PRG / SFCReset" in {item.path for item in translated}
    assert "chart settings" in {item.what for item in report.with_outcome(Outcome.EXTENSION_DATA)}
    assert first_chart(sfc.loads(data)).settings == first_chart(project).settings


@pytest.mark.slow
def test_every_item_of_a_report_says_where() -> None:
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    _, report = sfc.convert(project, "plcopen-2.01", partial=True)
    lines = (FIXTURES / "codesys" / "sorting_conveyor.xml").read_text("utf-8-sig").splitlines()
    steps = [item for item in report.with_outcome(Outcome.KEPT) if item.what == "step"]
    added = [item for item in steps if item.path.endswith(" / SFCReset_begins")]
    assert len(steps) == sum(len(chart.chart.steps) for chart in project.charts()) + len(added)
    assert len(added) == 1
    for item in (each for each in steps if each not in added):
        assert item.line is not None
        assert f'name="{item.path.rpartition(" / ")[2]}"' in lines[item.line - 1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("source", "target"),
    [
        ("simaticml/FB_Drill.xml", "codesys"),
        ("codesys/sorting_conveyor.xml", "simaticml"),
        ("codesys/sorting_conveyor.xml", "scl"),
        ("twincat/press_station.xml", "simaticml"),
    ],
)
def test_what_is_in_an_object_has_its_line(source: str, target: str) -> None:
    """Translated texts too: all items of an object are called as the object is, with the kind before the name."""
    project = accepting(sfc.load(FIXTURES / source))
    _, report = sfc.convert(project, target, partial=True)
    texts = [item for item in report.items if item.what == "text"]
    assert texts
    kinds = ("POU ", "type ", "data block ", "tag table ")
    assert [item.path for item in texts if item.line is None and item.path.startswith(kinds)] == []
    names = {thing.name for thing in project.objects()}
    assert [item.path for item in report.items if item.path.split(" / ")[0] in names and item.what != "POU"] == []
    lines = (FIXTURES / source).read_text("utf-8-sig").splitlines()
    steps = {step.name for chart in project.charts() for step in chart.chart.steps}
    told = [item for item in report.items if item.path.rpartition(" / step ")[2] in steps]
    assert told or target == "scl"  # which has no steps
    for item in told:
        assert item.line is not None
        assert f'ame="{item.path.rpartition(" / step ")[2]}"' in lines[item.line - 1]


def bars_in(chart: SfcNetwork) -> Iterator[tuple[SymbolKind, SymbolKind | None]]:
    """The kinds at both ends of every wire of a chart: from, to."""
    assert chart.drawing is not None
    kinds = {symbol.id: symbol.kind for symbol in chart.drawing.symbols}
    for symbol in chart.drawing.symbols:
        for pin in symbol.inputs:
            for connection in pin.connections:
                yield symbol.kind, kinds.get(connection.source)


@pytest.mark.slow
@pytest.mark.parametrize("path", [p for p in OWN if p.parent.name != "plcopen"], ids=lambda p: p.name)
def test_beremiz_flavour(path: Path) -> None:
    project = accepting(sfc.load(path))
    data, report = sfc.convert(project, "plcopen", flavour="beremiz", partial=True)
    root = etree.fromstring(data)
    tc6, xhtml = "{http://www.plcopen.org/xml/tc6_0201}", "{http://www.w3.org/1999/xhtml}"
    assert root.tag == f"{tc6}project"
    pous = [pou.get("name") for pou in root.iterfind(f"{tc6}types/{tc6}pous/{tc6}pou")]
    added = {"BLINK", *(f"{pou.name}_{method.name}" for pou in project.pous for method in pou.methods)}
    blocks = {f"{place.pou.name}_{place.name.rpartition('.')[2]}" for place in project.charts() if "." in place.name}
    added |= blocks
    assert len([name for name in pous if name not in added]) == len(project.pous), (
        "library blocks, methods and blocks for the charts of actions are added"
    )
    assert all(len(st) == 1 and st[0].tag == f"{xhtml}p" for st in root.iter(f"{tc6}ST"))
    flavoured = sfc.loads(data)
    originals = [chart for chart in project.charts() if "." not in chart.name and chart.chart.initial_steps]
    written = [chart for chart in flavoured.charts() if chart.name not in blocks]
    for chart, original in zip(written, originals, strict=True):
        built = original.chart.model_copy(deep=True)
        gone = {step.id for step in built.steps if step.exclude}
        built.transitions = [
            t for t in built.transitions if not t.exclude and gone.isdisjoint((*t.sources, *t.targets))
        ]
        added = {step.id for step in chart.chart.steps} - {step.id for step in built.steps}  # ends, and for SFC flags
        for_added = {t.id for t in chart.chart.transitions if added & {*t.sources, *t.targets}}
        for transition in chart.chart.transitions:
            transition.targets = [target for target in transition.targets if target not in added]
        wires = list(bars_in(chart.chart))
        assert all(source is not SymbolKind.JUMP for _, source in wires), "no wire leaves a jump"
        convergences = (SymbolKind.SELECTION_CONVERGENCE, SymbolKind.SELECTION_DIVERGENCE)
        assert all(consumer is not source for consumer, source in wires if consumer in convergences), "no nested bars"
        meaning = [Counter((*t.sources, "->", *t.targets) for t in n.transitions) for n in (chart.chart, built)]
        more = Counter((*t.sources, "->", *t.targets) for t in chart.chart.transitions if t.id in for_added)
        assert meaning[1] - meaning[0] == Counter()
        assert meaning[0] - meaning[1] - more == Counter()
        assert chart.chart.drawing is not None
        assert any(symbol.position != (0, 0) for symbol in chart.chart.drawing.symbols)
    assert report.with_outcome(Outcome.DROPPED) == []


def test_codesys_gets_its_own_form_of_a_chart_from_elsewhere() -> None:
    project = sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml")
    data, _ = sfc.convert(project, "codesys", partial=True)
    assert data.startswith(b"\xef\xbb\xbf<?xml")
    assert b"\r\n" in data
    back = sfc.loads(data)
    assert back.source is not None
    assert back.source.format == "codesys"
    for chart, original in zip(back.charts(), project.charts(), strict=True):
        assert [s.name for s in chart.chart.steps] != []
        called = {"Fault": "Fault_step"}  # a variable has the name of this step
        links = [
            {
                tuple(frozenset(names.get(name := n.step(i).name, name) for i in ids) for ids in (t.sources, t.targets))
                for t in n.transitions
            }
            for n, names in ((chart.chart, {}), (original.chart, called))
        ]
        assert links[0] == links[1]
        drawing = chart.chart.drawing
        assert drawing is not None
        kinds = [symbol.kind for symbol in drawing.symbols]
        assert kinds.count(SymbolKind.SELECTION_DIVERGENCE) == kinds.count(SymbolKind.SELECTION_CONVERGENCE)


@pytest.mark.slow
def test_strict_stops_before_anything_is_written(tmp_path: Path) -> None:
    project = sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml")
    first_chart(project).steps[1].actions[0].qualifier = Qualifier.DL
    target = tmp_path / "out.xml"
    with pytest.raises(LossError, match="would be executed otherwise or not at all"):
        sfc.save(project, target, format="codesys", strict=True)
    assert not target.exists()
    assert sfc.save(project, target, format="codesys", partial=True).losses
    assert target.exists()


@pytest.mark.slow
def test_excluded_elements_are_no_silent_matter() -> None:
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    excluded = [t for chart in project.charts() for t in chart.chart.transitions if t.exclude]
    assert excluded
    data, report = sfc.convert(project, "plcopen-2.01", partial=True)
    found = [item for item in report.items if item.what == "exclude" and item.outcome is Outcome.TRANSLATED]
    assert len(found) >= len(excluded)
    chart = first_chart(sfc.loads(data, as_tool=True))
    (entering,) = [t for t in chart.transitions if t.targets == [chart.step("LampTest").id]]
    assert getattr(entering.condition, "text", "") == "FALSE"


def test_what_a_conversion_gives_an_id_or_what_the_source_lacks_is_not_called_dropped() -> None:
    """The report had `25 comes back as 49` (ids of transitions), and actions where the source has none."""
    _, report = sfc.convert(sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml"), "codesys-export", partial=True, limit=0)
    lines = {item.path.rpartition(" / ")[2]: item for item in report.items if item.what == "field"}
    assert not [item for item in report.items if "order of transitions" in item.path and item.why[:1].isdigit()]
    assert lines["actions"].outcome == "translated"
    assert "Drill_actions" in lines["actions"].why
    assert lines["steps"].outcome == "dropped"  # those of one name are not compared where there are more
    assert lines["title"].outcome == "dropped"


def test_a_network_that_is_drawn_otherwise_is_one_line() -> None:
    """Each id of an element was one: `4 comes back as 5`."""
    source = sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml")
    _, report = sfc.convert(source, "simaticml", partial=True)
    fields = [item for item in report.items if item.what == "field"]
    assert not [item for item in fields if " / node " in item.path]
    (drawn,) = [item for item in fields if item.path == "POU DripValve / network 1"]
    assert re.fullmatch("it is drawn otherwise: [0-9]+ differences", drawn.why)
    assert german(drawn.why).startswith("es ist anders gezeichnet: ")


def test_a_text_that_loses_its_languages_is_not_told_as_itself() -> None:
    source = sfc.load(FIXTURES / "simaticml-training-chain" / "classic_flip-flops.xml")
    _, report = sfc.convert(source, "twincat", partial=True)
    whys = [item.why for item in report.items if item.what == "field"]
    assert "'Sensor 1' comes back as plain text" in whys
    assert not [why for why in whys for left, _, right in [why.partition(" comes back as ")] if left == right]
