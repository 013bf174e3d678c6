"""GRAFCETs in the notations of grafcet2plc and of Grafcet_to_Automaton."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import StructureError
from tests.corpus import require_corpus

ARCS = """%PUMPE (X1, X4)
X1 "Becken \\
leer"
X2 [Q1; \\
Q2]
X3
X4 [Q3]
Y1 [start./stop]
Y2 [T/X2/5 d/ + >(a.b)] "voll"
Y3
Y4 [T/(a + /b)/1 z/]
X1 > Y1
Y1 > X2
Y1 > X3
X2 > Y2
X3 > Y2
Y2 > X1
X4 > Y4
Y4 > X4
Y3 > X2
"""
SECTIONS = """# a gate
<INFO>
  Author : Somebody
</INFO>
<GRAFCET>
<INPUTS>
  a (* first *) ;
  b ;
</INPUTS>
<OUTPUTS>
  Q1 ;
</OUTPUTS>
<CHARTS>
<PARTIAL Name = G1 >
<STEPS> 10 : Initial ; 11 ; </STEPS>
<TRANSITIONS>
  t1 : 10 : 11 : /a.(b+a) ;
  t2 : 11 : 10 : b ;
</TRANSITIONS>
<ACTIONS>
  A1 : Continuous : 11 : Q1 : /a ;
</ACTIONS>
</PARTIAL>
</CHARTS>
</GRAFCET>
"""


def as_text(text: str) -> list[str]:
    """Return a chart as lines of the text of this package."""
    written = sfc.convert(sfc.loads(sfc.dumps(sfc.loads(text.encode()), format="json")), "grafcet-text").data.decode()
    return [line.strip() for line in written.splitlines() if line and not line.startswith("//")]


def test_arcs_are_transitions() -> None:
    assert as_text(ARCS) == [
        "GRAFCET Grafcet",
        "CHART PUMPE",
        'INITIAL STEP 1 "Becken leer"',
        "(1) 1 -> 2, 3 : start * /stop",
        "STEP 2",
        "Q1",
        "Q2",
        "STEP 3",
        '(2) 2, 3 -> 1 : 500ms/X2 + ↑(a * b) "voll"',
        "(3) -> 2 : 1",
        "INITIAL STEP 4",
        "Q3",
        "(4) 4 -> 4 : 10s/(a + /b)",
    ]


def test_sections_are_charts_and_tables() -> None:
    assert as_text(SECTIONS) == [
        'GRAFCET Grafcet "Author : Somebody"',
        "INPUTS",
        'a "first"',
        "b",
        "OUTPUTS",
        "Q1",
        "CHART G1",
        "INITIAL STEP 10",
        "(t1) 10 -> 11 : /a * (b+a)",
        "STEP 11",
        "Q1 IF /a",
        "(t2) 11 -> 10 : b",
    ]


@pytest.mark.parametrize("text", [ARCS, SECTIONS])
def test_a_file_comes_back_and_an_edit_makes_a_text_of_it(text: str) -> None:
    data = text.replace("\n", "\r\n").encode()
    project = sfc.loads(data)
    assert sfc.dumps(project) == data
    chart = project.pous[0].chart
    assert chart is not None
    chart.partial_charts[0].chart.steps[1].comment = "changed"
    edited, report = sfc.convert(project, "grafcet-text")
    assert edited.decode().startswith("GRAFCET Grafcet")
    assert [item.what for item in report.items if item.what == "notation"] == ["notation"]
    assert sfc.loads(edited).pous == project.pous


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        (ARCS.replace("X3\n", "X3 Q1\n"), "'X3 Q1' is no line of this notation", 6),
        (ARCS.replace("Q3]", "Q3 := 1]"), "'Q3 := 1' is no action", 7),
        (ARCS.replace("X4 > Y4", "X4 > X4"), "joins no step with a transition", 18),
        (ARCS.replace("X4 > Y4", "X4 > Y9"), "Y9 is unknown", 18),
        (ARCS.replace("Y4 > X4", "Y4 > X7"), "unknown step '7'", 11),
        (SECTIONS.replace("Continuous", "Stored"), "is no action that is known", 21),
        (SECTIONS.replace(": 11 : Q1", ": 12 : Q1"), "is no action that is known", 21),
        (SECTIONS.replace("t2 : 11 : 10 :", "t2 : 11 :"), "is no transition that is known", 18),
        (SECTIONS.replace("Initial", "Final"), "is no step that is known", 15),
        (SECTIONS.replace("<INFO>", "<FORCING>"), "<FORCING> is no section that is known", 2),
        (SECTIONS.replace("</STEPS>", ""), "</STEPS> is missing", 15),
        (SECTIONS.replace(" 10 : 11 : /a", " 10 : 12 : /a"), "unknown step '12'", 17),
    ],
)
def test_what_is_not_known_is_refused_with_its_line(text: str, message: str, line: int) -> None:
    with pytest.raises(StructureError, match=message.replace("(", r"\(")) as caught:
        sfc.loads(text.encode())
    assert caught.value.location.line == line


def test_findings_have_the_lines_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "gate.txt"
    path.write_text(SECTIONS.replace(" : b ;", " : b.X77 ;"), encoding="utf-8")
    (finding,) = sfc.check(sfc.load(path), select=["VAR01"])
    assert finding.location.line == 18


@pytest.mark.corpus
def test_real_files_are_read() -> None:
    folder = require_corpus() / "grafcet"
    found = []
    for name in (
        "fdelaine__grafcet2plc/example/inputGrafcet.txt",
        "ocanis__Grafcet_to_Automaton/Grafcet_to_automaton/Examples/aSimpleGrafcet1.txt",
    ):
        if not (folder / name).is_file():
            pytest.skip(f"the corpus has no {name}")
        project = sfc.load(folder / name)
        assert sfc.dumps(project) == (folder / name).read_bytes()
        assert not sfc.check(project, select=["CND09", "CND10"])
        chart = project.pous[0].chart
        assert chart is not None
        found.append([(len(each.chart.steps), len(each.chart.transitions)) for each in chart.partial_charts])
    assert found == [[(45, 44)], [(2, 2)]]
