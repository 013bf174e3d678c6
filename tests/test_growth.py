"""Work that grows with its input as it should, by counting calls: times tell nothing on a busy machine."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import plcopen_sfc as sfc
from benchmarks.generate import generate
from plcopen_sfc.formats.plcopen import tc6_bodies
from plcopen_sfc.formats.plcopen.tc6_chart_writer import Tc6ChartWriter
from plcopen_sfc.formats.provenance import compared_only, is_untouched
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.languages.binding import Row, SharedScans, shared_scans, told_orders
from plcopen_sfc.languages.st import parsing
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.pages.page_words import german


def ring(steps: int, qualifier: str = "N") -> sfc.Project:
    """A chart of so many steps in a circle, each with an action of its own, all of which write one variable."""
    numbers = range(steps)
    lines = [
        f"{'INITIAL_' * (not each)}STEP S{each}: A{each}({qualifier}); END_STEP\n"
        f"TRANSITION FROM S{each} TO S{(each + 1) % steps} := a; END_TRANSITION"
        for each in numbers
    ]
    lines += [f"ACTION A{each}: n := n + 1; END_ACTION" for each in numbers]
    head = "PROGRAM Main\nVAR_INPUT a : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR\n"
    return sfc.loads(f"{head}{chr(10).join(lines)}\nEND_PROGRAM\n".encode(), format="iec-text")


def calls_of(operation: Callable[[], object]) -> int:
    """Return the number of Python functions, and of turns of generators, that an operation enters."""
    count = 0

    def profile(_frame: FrameType, event: str, _argument: object) -> None:
        nonlocal count
        count += event == "call"

    before = sys.getprofile()
    sys.setprofile(profile)
    try:
        operation()
    finally:
        sys.setprofile(before)
    return count


def orders(project: sfc.Project) -> tuple[int, str]:
    """Return how many pairs of actions are asked for their order, and what is told of them."""
    asked = 0

    def differ(_one: Row, _other: Row) -> bool:
        nonlocal asked
        asked += 1
        return True

    pou = project.pou("Main")
    assert pou.sfc is not None
    told = told_orders(SharedScans(pou.sfc, pou, Dialect.IEC), list(pou.sfc.associations()), differ, "before")
    return asked, told


def converted(project: sfc.Project) -> bytes:
    """Convert a project to CODESYS, with the comparison of both tools."""
    return sfc.dumps(project, format="codesys", partial=True)


def drawn(project: sfc.Project) -> str:
    """Draw a chart."""
    return project.pous[0].chart.to_svg()


@pytest.mark.parametrize(
    ("operation", "shortest"), [(sfc.check, 64), (orders, 12), (converted, 12), (drawn, 12), (sfc.page, 12)]
)
def test_a_chart_of_twice_the_length_takes_twice_the_work(
    operation: Callable[[sfc.Project], object], shortest: int
) -> None:
    operation(ring(3))  # what is imported and prepared once
    projects = [ring(steps) for steps in (shortest, 2 * shortest, 4 * shortest)]
    works = [calls_of(lambda project=project: operation(project)) for project in projects]  # type: ignore[misc]
    assert works[2] - works[1] < 2.2 * (works[1] - works[0]), "linear is 2, quadratic is 4"


def blocks(count: int) -> sfc.Project:
    """So many function blocks, each of which calls the one before it, and no chart."""
    block = "FUNCTION_BLOCK B{0}\nVAR a, b : BOOL; inner : B{1}; END_VAR\nb := a; inner();\nEND_FUNCTION_BLOCK\n"
    text = "".join(block.format(each, each - 1) for each in range(1, count))
    return sfc.loads(f"FUNCTION_BLOCK B0\nEND_FUNCTION_BLOCK\n{text}".encode(), format="iec-text")


def as_grafcet(project: sfc.Project) -> bytes:
    """Write a chart that is no GRAFCET as one, with all that the format has no place for in comments."""
    return sfc.dumps(project, format="grafcet", partial=True, limit=0)


def as_scl(project: sfc.Project) -> bytes:
    """Write a chart in SCL, which has its steps and names as variables of the block."""
    return sfc.dumps(project, format="scl", partial=True, limit=0)


def of_s7(steps: int) -> sfc.Project:
    """A block in S7-GRAPH, of a chart as `ring` makes it."""
    data = sfc.dumps(ring(steps), format="simaticml", partial=True, limit=0)
    return sfc.loads(data, format="simaticml")


def in_a_macro(project: sfc.Project) -> object:
    """Move half of the steps of a chart, which are named, into a macro-step."""
    steps = project.pous[0].chart.steps
    return project.edit().move_to_macro([f"Main.{step.name}" for step in steps[1 : 1 + len(steps) // 2]], "Half")


def aliases(count: int) -> sfc.Project:
    """So many names for one type, each with a variable that a program writes."""
    types = "".join(f"TYPE T{each} : T{each - 1}; END_TYPE\n" for each in range(1, count))
    variables = "".join(f"x{each} : T{each}; " for each in range(count))
    code = "".join(f"x{each} := x{each - 1};\n" for each in range(1, count))
    text = f"TYPE T0 : BOOL; END_TYPE\n{types}PROGRAM Main\nVAR {variables}END_VAR\n{code}END_PROGRAM\n"
    return sfc.loads(text.encode(), format="iec-text")


def with_new_names(project: sfc.Project) -> object:
    """Give each step of a chart another name, in one pass."""
    return project.rename_many({f"Main.{step.name}": f"New{step.name}" for step in project.pous[0].chart.steps})


@pytest.mark.parametrize(
    ("operation", "make", "least"),
    [
        (sfc.check, blocks, 40),
        (sfc.page, blocks, 40),
        (as_grafcet, ring, 40),
        (as_scl, ring, 40),
        (converted, of_s7, 20),
        (with_new_names, ring, 120),
        (converted, aliases, 40),
    ],
)
def test_twice_the_objects_take_twice_the_work(
    operation: Callable[[sfc.Project], object], make: Callable[[int], sfc.Project], least: int
) -> None:
    operation(make(3))
    works = []
    for count in (least, 2 * least, 4 * least):
        project = make(count)
        works.append(calls_of(lambda project=project: operation(project)))  # type: ignore[misc]
    assert works[2] - works[1] < 2.2 * (works[1] - works[0]), "linear is 2, quadratic is 4"


def test_a_macro_step_of_twice_the_steps_takes_twice_the_work() -> None:
    sizes = (220, 440, 880)  # of fewer names each is looked for in each text
    in_a_macro(ring(sizes[-1]))  # the names of its actions are parsed once
    works = [calls_of(lambda project=project: in_a_macro(project)) for project in map(ring, sizes)]  # type: ignore[misc]
    assert works[2] - works[1] < 2.2 * (works[1] - works[0]), "linear is 2, quadratic is 4"


def test_only_actions_of_neighbouring_steps_are_asked_for_their_order(monkeypatch: pytest.MonkeyPatch) -> None:
    assert [orders(ring(steps))[0] for steps in (10, 20)] == [20, 40]
    stored = ring(8, "S")
    assert orders(stored)[0] == 8 * 7, "they may all meet"
    monkeypatch.setattr(shared_scans, "_MOST_PAIRS", 20)
    told = orders(stored)[1].split("; ")
    assert told[-1] == "the orders of 20 pairs of actions were compared, there are more pairs"
    assert german("; ".join(told)).endswith(
        "; die Reihenfolgen von 20 Paaren von Aktionen wurden verglichen, es gibt mehr Paare"
    )
    assert german("; ".join(told)).startswith("A0 wird in einem Zyklus vor A1 ausgeführt")


@pytest.mark.parametrize("codesys", [False, True])
def test_an_edit_writes_what_it_touches_and_reads_no_other_drawing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, codesys: bool
) -> None:
    generate(tmp_path / "charts.xml", megabytes=0.3, steps=12, codesys=codesys)
    project = sfc.load(tmp_path / "charts.xml")
    charts = [each.chart for each in project.charts()]
    assert len(charts) > 1 or codesys, "its files have more around a chart"
    assert all(chart.steps for chart in charts)
    drawings = [chart.__dict__["drawing"] for chart in charts]
    assert all(drawing.is_unread for drawing in drawings)
    written: list[str] = []
    write_step = Tc6ChartWriter.write_step

    def counted(*arguments: Any) -> None:
        written.append(arguments[-1].name)
        write_step(*arguments)

    monkeypatch.setattr(Tc6ChartWriter, "write_step", counted)
    step = charts[0].steps[5]
    step.comment = "edited"
    data = sfc.dumps(project)
    assert written == [step.name, step.name], "as it was and as it is"
    assert [drawing.is_unread for drawing in drawings] == [False] + [True] * (len(drawings) - 1)
    back = next(sfc.loads(data).charts()).chart
    assert [(each.name, each.comment) for each in back.steps if each.comment == "edited"] == [(step.name, "edited")]
    name = step.name
    charts[0].rename_step(name, "Renamed")
    written.clear()
    assert b"Renamed" in sfc.dumps(project)
    assert sorted(written) == sorted([name, "Renamed"])


def test_the_drawing_of_an_edited_chart_is_read_by_the_edit_and_in_the_new_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It was read once more, as the file has it, wherever the file has other POUs without an edit."""
    generate(tmp_path / "charts.xml", megabytes=0.3, steps=12)
    project = sfc.load(tmp_path / "charts.xml")
    charts = [each.chart for each in project.charts()]
    assert len(charts) > 1
    read: list[object] = []
    read_drawing = tc6_bodies.read_drawing

    def counted(*arguments: Any) -> None:
        read.append(arguments)
        read_drawing(*arguments)

    monkeypatch.setattr(tc6_bodies, "read_drawing", counted)
    charts[0].steps[5].comment = "edited"
    assert b"edited" in sfc.dumps(project)
    assert len(read) == 2


def test_a_rename_looks_for_its_words_once_in_each_other_chart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    generate(tmp_path / "charts.xml", megabytes=0.3, steps=12)
    project = sfc.load(tmp_path / "charts.xml")
    charts = [each.chart for each in project.charts()]
    asked: list[sfc.SfcNetwork] = []
    may_mention = sfc.SfcNetwork.may_mention

    def counted(chart: sfc.SfcNetwork, words: Collection[str], *, as_members: bool = False) -> bool:
        asked.append(chart)
        return may_mention(chart, words, as_members=as_members)

    monkeypatch.setattr(sfc.SfcNetwork, "may_mention", counted)
    charts[0].rename_step(charts[0].steps[0].name, "Renamed")
    assert sorted(map(id, asked)) == sorted(map(id, charts))
    assert len(charts) > 1


def test_what_is_compared_only_gets_no_digest(tmp_path: Path) -> None:
    generate(tmp_path / "charts.xml", megabytes=0, steps=12)
    content = (tmp_path / "charts.xml").read_bytes()
    codec = format_named("plcopen")[0].codec()
    with compared_only():
        compared = next(codec.read(content).project.charts()).chart
    kept = next(codec.read(content).project.charts()).chart
    for chart, digested in ((compared, False), (kept, True)):
        assert chart.steps
        assert chart.drawing is not None
        assert chart.drawing.symbols
        # without a digest nothing tells that it was not edited
        assert is_untouched(chart) is is_untouched(chart.drawing) is digested
    assert compared == kept


@pytest.mark.parametrize("operation", [sfc.check, lambda project: sfc.dumps(project, format="scl")])
def test_a_long_body_is_parsed_once_in_each_dialect(
    monkeypatch: pytest.MonkeyPatch, operation: Callable[[sfc.Project], object]
) -> None:
    body = "x := x + 1;\n" * 200
    project = sfc.loads(f"PROGRAM Main\nVAR x : INT; END_VAR\n{body}END_PROGRAM\n".encode(), format="iec-text")
    parsed: list[tuple[str, Dialect]] = []
    parse = parsing.Parsed

    def counted(text: str, dialect: Dialect, *others: Any) -> object:
        parsed.append((text, dialect))
        return parse(text, dialect, *others)

    monkeypatch.setattr(parsing, "Parsed", counted)
    operation(project)
    long = [each for each in parsed if len(each[0]) >= len(body) - 1]
    assert long
    assert len(set(long)) == len(long)
    parsed.clear()
    operation(project)
    assert [each for each in parsed if len(each[0]) >= len(body) - 1] == long, "nothing is kept behind it"
