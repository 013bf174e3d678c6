"""GRAFCETs as text: read, simulated, written, edited, refused."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import LoweringError, StructureError
from plcopen_sfc.languages.grafcet_conditions import condition_problem
from plcopen_sfc.model import ActionKind, ForcedSituation, PartialChartKind, PouKind, Project, SfcNetwork, Variable
from plcopen_sfc.model.numbering import numbered_in_order
from plcopen_sfc.model.project import Tag
from plcopen_sfc.report import Outcome
from tests.lowering.random_grafcets import random_hierarchy

FIXTURES = Path("fixtures/grafcet")
NAMES = sorted(path.stem for path in FIXTURES.glob("*.gct"))


def path_of(name: str) -> Path:
    return FIXTURES / f"{name}.gct"


@pytest.mark.parametrize("name", NAMES)
def test_a_text_comes_back_and_the_model_makes_one_that_means_the_same(name: str) -> None:
    data = path_of(name).read_bytes()
    project = sfc.loads(data)
    assert project.source is not None
    assert project.source.format == "grafcet-text"
    assert sfc.dumps(project, format="grafcet-text") == data
    crlf = data.replace(b"\n", b"\r\n")
    assert sfc.dumps(sfc.loads(b"\xef\xbb\xbf" + crlf), format="grafcet-text") == b"\xef\xbb\xbf" + crlf
    fresh = sfc.dumps(sfc.loads(sfc.dumps(project, format="json")), format="grafcet-text")
    assert b"plcopen_sfc" not in fresh, "the text has words for all of it"
    assert numbered_in_order(sfc.loads(fresh)).pous == numbered_in_order(project).pous


def test_every_statement_is_read() -> None:
    project = sfc.load(path_of("every_symbol"))
    pou = project.pous[0]
    assert pou.comment == 'Alles, was eine Zeile haben kann\nEine zweite Zeile, mit "Anführungszeichen"'
    assert [(v.name, v.address, v.comment) for v in pou.variables()][2] == ("C1", "%IW2", "Füllstand")
    assert pou.chart is not None
    g1, m3, g3, g4 = pou.chart.partial_charts
    assert (m3.kind, m3.entry_step, m3.exit_step) == (PartialChartKind.EXPANSION, "E3", "S3")
    assert g3.kind is PartialChartKind.ENCLOSED
    labels = {g1.chart.label(t): (t.number, t.comment) for t in g1.chart.transitions}
    assert labels["1 -> 2+M3"] == (1, "zugleich")
    assert labels["4 -> 5"] == (None, "über zwei Zeilen")
    assert {"weiter", "5 -> nowhere", "nowhere -> 5"} < labels.keys()
    kinds = [action.kind for action in g1.chart.step("2").actions]
    assert kinds == [kind for kind in ActionKind if kind not in (ActionKind.CONTINUOUS, ActionKind.FORCING)]
    assert [a.duration for a in g1.chart.step("2").actions][1:3] == ["T#3s", "T#500ms"]
    enclosed = g1.chart.step("4").encloses
    assert enclosed is not None
    assert [(each.chart, each.activated_steps) for each in enclosed] == [("G3", ["20"])]
    orders = [a.forcing for _, a in g4.chart.associations() if a.forcing is not None]
    assert [order.situation for order in orders] == [
        ForcedSituation.CURRENT,
        ForcedSituation.EXPLICIT,
        ForcedSituation.EMPTY,
    ]
    assert orders[1].steps == ["1"]


def changed_lines(before: str, after: str) -> list[str]:
    lines = difflib.ndiff(before.splitlines(), after.splitlines())
    return [line[0] + line[1:].strip() for line in lines if line[0] in "+-"]


RUNS = [
    ("four_steps", "> Q1; B1 > Q2; /B1 > Q2; B2 > Q2; B5 > Q2 Q3; /B5 > Q2; B3 /B2 > ; B4 /B3 > Q1"),
    ("initialised_chain", "> Q1; B1 > Q2; /B1 Init > Q1; /Init > Q1; B1 > Q2; /B1 B2 > Q2; Init > Q1"),
    ("two_cylinders", "1B1 2B1 NOT_AUS > ; START > 1M1; 1B2 /1B1 > ; 1B1 /1B2 /START > 2M1"),
    # the emergency stop puts the cylinders into their initial step
    ("two_cylinders", "1B1 2B1 NOT_AUS > ; START > 1M1; /NOT_AUS > ; > ; NOT_AUS /START > "),
    # step 2 is left after two seconds, and for the part
    ("selection", "> Q1; I1 > Q2; /I1 > Q2; > Q1; I1 > Q2; I2 /I1 > Q2 Q3; /I2 > Q1"),
    # Q1 is that of two steps; an event together with the activation is none
    ("actions", "> Q1; S1 > Q1 Q2; I0 > Q1 Q3; /I0 > Q1 Q2 Q3; /S1 > Q4; S1 > Q1"),
    ("actions", "> Q1; S1 I0 > Q1; /I0 > Q1 Q2; I0 /S1 > Q4"),
    # an initial enclosing step, and the steps beside a macro-step
    ("press", "AUTO > BEREIT; START > K1 K2; B2 > K1 V1; B1 /B2 > ; /B1 /START > BEREIT"),
    ("press", "AUTO START > K1 K2; /AUTO > HAND; AUTO /START > BEREIT"),
    # initial steps, the present ones, none, and step 3, each until it is released
    ("forcing", "a > Q2; ANFANG > Q1; /ANFANG > Q2; b /a > Q3; HALT a > Q3; > Q3; /HALT > Q1"),
    ("forcing", "> Q1; LEER > ; /LEER > ; a > ; EINR > Q3; /EINR > Q3; b > Q1"),
    # once to and fro before it leaves
    (
        "belt",
        "Anzahl=1 B1 > H1; S1 > K1; /B1 /S1 > K1; B3 > ; > ; > ; > K2; /B3 > K2; B1 > K1; /B1 > K1; B3 > K2"
        "; /B3 B1 > K1; /B1 > K1; B4 > H1",
    ),
]
"""Charts of the books with what they describe: in each scan of a second the inputs that change, and the outputs."""


@pytest.mark.parametrize(("name", "run"), RUNS)
def test_a_chart_does_what_its_text_describes(name: str, run: str) -> None:
    inputs: list[dict[str, object]] = []
    for scan in run.split(";"):
        values = (each.partition("=") for each in scan.partition(">")[0].split())
        inputs.append({name.lstrip("/"): int(value) if value else name[0] != "/" for name, _, value in values})
    project = sfc.load(path_of(name))
    trace = sfc.simulate(project, inputs=lambda scan, _: inputs[scan], scans=len(inputs), scan_time="1s")
    columns = {column.name.rpartition(".")[2]: column for column in trace.columns}
    written = [each.name for each in project.pous[0].variables() if re.search(rf"> (\w+ )*{each.name}\b", run)]
    seen = [" ".join(each for each in written if columns[each][scan]) for scan in range(len(inputs))]
    assert seen == [scan.partition(">")[2].strip() for scan in run.split(";")]


PROOF, RUN_ONLY, TWO_STEPS = "equal (proof", "equal in ", "one CASE cannot hold the chart: it has 2 initial steps"
LOWERED = {
    ("four_steps", "flipflop"): PROOF,
    ("four_steps", "case"): PROOF,
    ("initialised_chain", "flipflop"): PROOF,
    ("initialised_chain", "case"): TWO_STEPS,
    ("two_cylinders", "flipflop"): PROOF,
    ("two_cylinders", "case"): TWO_STEPS,
    ("two_cylinders", "auto"): PROOF,
    ("selection", "flipflop"): PROOF,
    ("selection", "case"): PROOF,
    ("actions", "flipflop"): PROOF,
    ("actions", "case"): PROOF,
    ("press", "flipflop"): PROOF,
    ("press", "case"): TWO_STEPS,
    ("press", "auto"): PROOF,
    ("forcing", "flipflop"): PROOF,
    ("forcing", "case"): TWO_STEPS,
    ("forcing", "auto"): PROOF,
    ("belt", "flipflop"): RUN_ONLY,
    ("belt", "case"): RUN_ONLY,
}
"""What `lower` finds of the charts of the books; CASE holds a sequence with one active step."""


@pytest.mark.parametrize(("name", "construction"), LOWERED)
def test_a_text_is_lowered_and_proven(name: str, construction: str) -> None:
    project, verdict = sfc.load(path_of(name)), LOWERED[name, construction]
    if verdict == TWO_STEPS:
        with pytest.raises(LoweringError, match=verdict):
            sfc.lower(project, construction)
    else:
        # a number of strokes that is an input has too many values for a proof
        proof = sfc.lower(project, construction, **({"cap": 200, "runs": 4} if name == "belt" else {})).proof
        assert str(proof).startswith(verdict)


def test_two_transitions_between_the_same_steps_have_two_paths() -> None:
    """A finding on the second one named the first, as what competes with it and in its line."""
    project = sfc.loads(b"GRAFCET G\nINITIAL STEP 1\nSTEP 2\n1 -> 2 : a\n1 -> 2 : b\n2 -> 1 : \xe2\x86\x91c\n")
    chart = project.pous[0].chart
    assert chart is not None
    assert (
        [*chart.labels().values()]
        == [chart.label(each) for each in chart.transitions]
        == ["1 -> 2", "1 -> 2 (2)", "2 -> 1"]
    )
    assert [chart.transition(label).id for label in chart.labels().values()] == [each.id for each in chart.transitions]
    (found,) = sfc.check(project, select=["SEL01"])
    assert str(found).startswith(
        "line 5 (POU G / transition 1 -> 2 (2)): error SEL01: it can be true together with 1 -> 2,"
    )


COUNTER = """GRAFCET Zaehler
INPUTS
    a
    b
    NOT_AUS
OUTPUTS
    Q1
INTERNALS
    n : INT
CHART G1
    INITIAL STEP 1
        ON ACTIVATION n := 0
    1 -> 2 : a
    STEP 2
        Q1
        ON ACTIVATION n := n + 1
    2 -> 3 : ↑b
    STEP 3
    3 -> 2 : [n<3] * /a
    3 -> 4 : [n>=3]
    STEP 4
    4 -> 1 : a * b
CHART G2
    INITIAL STEP 10
        FORCE G1{INIT}
    10 -> 11 : NOT_AUS
    STEP 11
    11 -> 10 : /NOT_AUS
"""


@pytest.mark.parametrize("construction", ["flipflop", "bits"])
def test_a_counter_in_a_forced_chart_is_proven(construction: str) -> None:
    proof = sfc.lower(sfc.loads(COUNTER.encode()), construction).proof
    assert str(proof).startswith("equal (proof")


def extend(_: Project, chart: SfcNetwork) -> None:
    chart.add_step("7")
    chart.add_transition("5", "7", "a")


def change(_: Project, chart: SfcNetwork) -> None:
    chart.step("2").comment = "neu"
    chart.step("2").actions[1].duration = "T#4s"
    del chart.step("2").actions[3]


def declare(project: Project, _: SfcNetwork) -> None:
    interface = project.pous[0].interface
    assert interface is not None
    interface.sections[0].variables[2].address = "%IW4"
    interface.sections[0].variables.append(Variable(name="z", type="REAL"))


def renumber(_: Project, chart: SfcNetwork) -> None:
    chart.step("2").name = "22"


EDITS: dict[Callable[[Project, SfcNetwork], None], list[str]] = {
    extend: ["+5 -> 7 : a", "+STEP 7"],
    change: ["-STEP 2", '+STEP 2 "neu"', "-H1 AFTER 3s", "+H1 AFTER 4s", "-ON ACTIVATION n := n + 1"],
    declare: ['-C1 %IW2 : INT "Füllstand"', '+C1 %IW4 : INT "Füllstand"', "+z : REAL"],
    renumber: [
        '-(1) 1 -> 2, M3 : a · b̅ + [C1>3] "zugleich"',
        '+(1) 1 -> 22, M3 : a · b̅ + [C1>3] "zugleich"',
        "-STEP 2",
        "+STEP 22",
        "-2, M3 -> 4 : 2s/X2",
        "+22, M3 -> 4 : 2s/X2",
    ],
}


@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_changes_its_lines(edit: Callable[[Project, SfcNetwork], None]) -> None:
    project = sfc.load(path_of("every_symbol"))
    assert project.pous[0].chart is not None
    edit(project, project.pous[0].chart.partial_charts[0].chart)
    text = sfc.dumps(project, format="grafcet-text").decode()
    assert changed_lines(path_of("every_symbol").read_text(encoding="utf-8"), text) == EDITS[edit]


def test_what_the_text_has_no_words_for_comes_back_from_a_comment() -> None:
    project = sfc.load(path_of("every_symbol"))
    assert project.pous[0].chart is not None
    chart = project.pous[0].chart.partial_charts[0].chart
    chart.step("5").max_time = "T#9s"
    project.pous[0].kind = PouKind.FUNCTION_BLOCK
    data = sfc.dumps(project, format="grafcet-text")
    assert data.startswith(b"GRAFCET Symbole AS FUNCTION_BLOCK")
    read = sfc.loads(data)
    assert read.pous == project.pous
    assert sfc.dumps(read, format="grafcet-text") == data


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("GRAFCET G\nSTEP 1\n1 -> 3 : a\nSTEP 2\n", "unknown step '3'", 3),
        ("GRAFCET G\nSTEP 1\nSTEP 1\n", "there is a step 1", 3),
        ("GRAFCET G\nSTEP 1\n1 -> 2 -> 3 : a\n", "'1 -> 2 -> 3 : a' is no transition", 3),
        ("GRAFCET G\nSTEP 1\n    Q WHEN a\n", "'Q WHEN a' is no action", 3),
        ("GRAFCET G\nSTEP 1\n    FORCE G1\n", "'FORCE G1' is no action", 3),
        ("GRAFCET G\nSTEP 1\n    ON ACTIVATION 5 := 1\n", "'5' is a number and no variable", 3),
        ("GRAFCET G\nQ\n", "belongs to no step", 2),
        ("GRAFCET G\nINPUTS\n a : INT INT\n", "this is no declaration", 3),
        ("GRAFCET G\n\nSTEP 1\nINPUTS\n", "tables of variables come before", 4),
        ("GRAFCET G\nSTEP 1 EXPANDS M1\n", "only a macro-step", 2),
        ("GRAFCET G\n// words\n", 'a comment is a text in quotation marks: ".."', 2),
        ("GRAFCET G\nSTEP 1 ENCLOSES {1}\n", "encloses nothing", 2),
        ("GRAFCET G\nCHART A\nCHART A\n", "there is a chart A already", 3),
        ("GRAFCET G\nSTEP 1\nGRAFCET g\n", "there is a GRAFCET g already", 3),
        ("GRAFCET G\nSTEP 1\n1, 1 -> 1 : a\n", "names the step 1 twice", 3),
        ("GRAFCET G\nSTEP a\na -> a, A : a\n", "names the step a twice", 3),
        ("GRAFCET G\nSTEP 1\n( ) 1 -> 1 : a\n", "the designation of the transition is empty", 3),
        ("GRAFCET G\nSTEP 1\n    FORCE G2{11,}\n", "names no steps", 3),
        ("GRAFCET G\nINPUTS\n a\nOUTPUTS\n A : INT\n", "there is a variable A already", 5),
        ("GRAFCET G\nINPUTS\n a %X9.9\n", "'%X9.9' is no address", 3),
        ("GRAFCET G\nOUTPUTS\n a %A4.7\n b %A4.9\n", "'%A4.9' is no address", 4),
        ("GRAFCET G\nINPUTS\n 2.5 : REAL\n", "'2.5' is a number", 3),
        ('GRAFCET G\nSTEP 1\n1 -> 1 : a "words\n', "a quotation mark is missing", 3),
    ],
)
def test_a_line_that_is_none_is_refused_with_its_place(text: str, message: str, line: int) -> None:
    with pytest.raises(StructureError, match=message.replace("(", r"\(")) as caught:
        sfc.loads(text.encode())
    assert caught.value.location.line == line


@pytest.mark.parametrize(
    ("line", "instead"),
    [
        ("1 -> 1 a * b", "1 -> 1 : a * b"),
        ("-> 1 ↑b", "-> 1 : ↑b"),
        ("Q = TRUE", "ON ACTIVATION Q := TRUE"),
        ("ON DEACTIVATION Q = TRUE", "ON DEACTIVATION Q := TRUE"),
        ("C1 := 0 ON ACTIVATION", "ON ACTIVATION C1 := 0"),
        ("C1++", "ON ACTIVATION C1 := C1 + 1"),
        ("ON DEACTIVATION C1--", "ON DEACTIVATION C1 := C1 - 1"),
        ("ON EVENT ↑a Q := TRUE", "ON EVENT ↑a : Q := TRUE"),
        ("1 => 1 : a", "1 -> 1 : a"),
        ("(3) 1 --> 1 : a", "(3) 1 -> 1 : a"),
        ("1 → 1 : a", "1 -> 1 : a"),
    ],
)
def test_a_line_in_another_notation_is_told_as_it_is_written_here(line: str, instead: str) -> None:
    with pytest.raises(StructureError) as caught:
        sfc.loads(f"GRAFCET G\nSTEP 1\n    {line}\n".encode())
    assert caught.value.hint.endswith(f" {instead}")
    sfc.loads(f"GRAFCET G\nSTEP 1\n    {instead}\n".encode())


@pytest.mark.parametrize("text", ["INPUTS\n a\nSTEP 1\n", "CHART G1\n", "// G\n", "a -> b", ""])
def test_a_text_without_its_head_is_told_what_it_lacks(text: str, tmp_path: Path) -> None:
    path = tmp_path / "plan.gct"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StructureError, match=r"a text begins with GRAFCET|a comment is a text") as caught:
        sfc.load(path)
    assert caught.value.location.line == 1


@pytest.mark.parametrize("seed", range(12))
def test_random_grafcets_go_through_the_text(seed: int) -> None:
    project = Project(name="Ablauf", pous=[random_hierarchy(seed)])
    data = sfc.dumps(project, format="grafcet-text")
    assert numbered_in_order(sfc.loads(data)).pous == numbered_in_order(project).pous
    assert b"// {plcopen_sfc" not in data.replace(b"initial", b"")
    assert sfc.loads(sfc.dumps(project, format="json")).pous == project.pous


@pytest.mark.parametrize("form", ["grafcet-text", "grafcet"])
def test_drawn_conditions_and_interlocks_become_terms_and_come_back(form: str) -> None:
    source = sfc.load("fixtures/simaticml-training-chain/Ablauf.xml")
    data, _ = sfc.convert(source, form)
    text = sfc.dumps(sfc.loads(data, format=form, as_tool=True), format="grafcet-text").decode()
    assert "Q3 IF B5\n" in text
    assert " : B1\n" in text
    back, _ = sfc.convert(sfc.loads(data), "simaticml")
    assert sfc.loads(back).pous == source.pous


def test_a_drawn_condition_is_in_the_notation_of_iec_60848() -> None:
    source = sfc.load("fixtures/plcopen/filling_station_2.01.xml")
    text = sfc.convert(source, "grafcet-text", partial=True).data.decode()
    assert "Infeed -> Clamp : B1_BottleInPlace * /S3_Door\n" in text


def test_charts_of_tools_become_grafcets_and_come_back() -> None:
    source = sfc.load("fixtures/simaticml/FB_Drill.xml")
    data, report = sfc.convert(source, "grafcet-text", partial=True)
    text = data.decode()
    assert "(T_Clamped) Clamp_part -> Drill, Cool : PartClamped" in text
    assert "    FeedDown AFTER 500ms" in text
    lost = [item.path for item in report.items if item.outcome == "not executed"]
    assert "POU FB_Drill / step Drill / action Spindle" in lost, "its interlock has no word"
    back, _ = sfc.convert(sfc.loads(data), "simaticml", partial=True)
    assert sfc.loads(back).pous == source.pous


@pytest.mark.slow
@pytest.mark.parametrize("form", ["grafcet-text", "grafcet"])
def test_what_charts_of_tools_do_beside_their_actions_is_told(form: str) -> None:
    told: dict[str, set[str]] = {}
    for file in ("simaticml/FB_Drill.xml", "codesys/sorting_conveyor.xml", "iectext/distribution_belt.st"):
        report = sfc.convert(sfc.load(f"fixtures/{file}"), form, partial=True).report
        for item in report.losses:
            told.setdefault(item.what, set()).add(item.path)
    assert {"POU FB_Drill / step Drill"} <= told["supervision"]
    assert {"POU FB_Drill"} <= told["permanent instruction"]
    assert "POU PLC_PRG / step Measure" in told["minimum time"]
    assert "POU PLC_PRG / SFCReset" in told["SFC flag"]
    assert told["transition"]
    assert "POU FB_Drill / step Bottom" in told["selection"]


def test_not_is_of_the_operand_in_a_chart_and_of_the_comparison_in_a_grafcet() -> None:
    text = """PROGRAM Main
    VAR_INPUT w : WORD; n : INT; a, b : BOOL; END_VAR
    INITIAL_STEP A: END_STEP
    TRANSITION FROM A TO A := NOT w = 16#F AND NOT a AND n > 3; END_TRANSITION
END_PROGRAM
"""
    data, _ = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "grafcet-text")
    assert "A -> A : [(NOT w) = 16#F] * /a * [n > 3]\n" in data.decode()
    plan = "GRAFCET G\nINPUTS\n n : INT\nOUTPUTS\n Q\nINITIAL STEP 1\n1 -> 2 : {}\nSTEP 2\n Q\n2 -> 1 : /[n>3] * [n<9]"
    read = [sfc.loads(plan.format(each).encode()) for each in ("NOT n>3", "/[n>3]", "NOT NOT n<=3")]
    assert sfc.equivalent(read[0], read[1], "grafcet").kind == "equal (proof)"
    assert sfc.equivalent(read[0], read[2], "grafcet").kind == "equal (proof)"


@pytest.mark.parametrize(
    ("association", "line"),
    [
        ("Count(N)", "    { n := n + 1; }"),
        ("Count(P1)", "    ON ACTIVATION { n := n + 1; }"),
        ("Count(S)", ""),
        ("Count(R)", ""),
        ("Q(S)", "    ON ACTIVATION Q := TRUE"),
        ("Q(R)", "    ON ACTIVATION Q := FALSE"),
        ("Q(P)", ""),
        ("Q(P0)", ""),
    ],
)
def test_stored_actions_do_what_a_qualifier_does_or_are_not_written(association: str, line: str) -> None:
    """S executes a program until R ends it; P gives a variable TRUE for one scan."""
    text = f"""PROGRAM Main
    INITIAL_STEP A: {association}; END_STEP
    TRANSITION FROM A TO A := x; END_TRANSITION
    ACTION Count: n := n + 1; END_ACTION
END_PROGRAM
"""
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "grafcet-text", partial=True)
    outcome = "translated" if line else "not executed"
    assert {item.outcome for item in report.items if item.what == "action"} == {outcome}
    written = data.decode().partition("INITIAL STEP A")[2].splitlines()
    assert written[1] == (line or "A -> A : x")


@pytest.mark.parametrize("form", ["grafcet-text", "grafcet"])
def test_what_is_no_chart_of_a_project_is_told(form: str) -> None:
    text = """PROGRAM Main
    INITIAL_STEP A: END_STEP
    STEP B: Q(N); END_STEP
    TRANSITION FROM A TO B := x; END_TRANSITION
    TRANSITION FROM B TO A := y; END_TRANSITION
END_PROGRAM
PROGRAM Other
    g := NOT g;
END_PROGRAM
"""
    project = sfc.loads(text.encode(), format="iec-text")
    chart = project.pou("Main").chart
    with project.edit() as edit:
        edit.move_to_macro([chart.step("B")], "M1")
    chart.permanent_pre.append(m.PermanentOperation(body=m.OpaqueBody(source="step7", content="CALL FC 1")))
    report = sfc.convert(project, form, partial=True).report
    lost = {(item.what, item.path) for item in report.losses}
    assert {
        ("POU", "POU Other"),
        ("macro-step", "POU Main / step M1"),
        ("permanent instruction", "POU Main"),
    } <= lost


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["codesys", "codesys23", "iectext", "plcopen", "simaticml", "training-chain"])
def test_charts_of_all_tools_keep_their_steps_and_transitions_as_grafcets(folder: str) -> None:
    read = 0
    for path in sorted(Path("fixtures", folder).iterdir()):
        if path.suffix == ".txt":
            continue
        source = sfc.load(path)
        if any(finding.severity == "error" for finding in source.diagnostics) or not list(source.charts()):
            continue
        data, report = sfc.convert(source, "grafcet-text", partial=True, limit=0)
        found = {chart.report_path: chart.chart for chart in sfc.loads(data).charts()}
        for chart in source.charts():
            there = found[chart.report_path]
            assert [step.name for step in there.steps] == [step.name.replace(" ", "_") for step in chart.chart.steps], (
                path
            )
            assert len(there.transitions) == len(chart.chart.transitions), path
            told = {item.path for item in (*report.losses, *report.with_outcome(Outcome.TRANSLATED))}
            for step in chart.chart.steps if "." not in chart.name else ():
                if step.entry_action or step.exit_action or step.main_action:
                    assert any(f"step {step.name.replace(' ', '_')}" in place for place in told), (path, step.name)
        read += 1
    assert read


@pytest.mark.parametrize("form", ["grafcet-text", "grafcet"])
def test_declarations_that_no_grafcet_has_are_told(form: str) -> None:
    text = """TYPE Mode : (Off, On); END_TYPE
VAR_GLOBAL lamp : BOOL; END_VAR
FUNCTION_BLOCK Main
    VAR_IN_OUT shared : INT; END_VAR
    VAR_OUTPUT RETAIN kept : INT; END_VAR
    INITIAL_STEP A: END_STEP
    TRANSITION FROM A TO A := shared > 3; END_TRANSITION
END_FUNCTION_BLOCK
"""
    report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), form, partial=True).report
    lost = {(item.what, item.path) for item in report.losses}
    own = {("variable", "POU Main / shared"), ("retain", "POU Main / kept")}
    assert own | {("type", "type Mode"), ("global variables", "global variables")} <= lost


def test_a_quotation_mark_is_no_part_of_a_condition_or_a_value() -> None:
    """A comment begins with it: the condition would lack its second operand."""
    text = """FUNCTION_BLOCK Main
    VAR name : WSTRING := "abc"; END_VAR
    INITIAL_STEP A: END_STEP
    TRANSITION FROM A TO A := name = "xy"; END_TRANSITION
END_FUNCTION_BLOCK
"""
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "grafcet-text", partial=True)
    assert {item.what for item in report.losses} == {"condition", "initial value"}
    assert b"A -> A : FALSE" in data


def test_programs_that_have_a_final_scan_in_the_source_are_told() -> None:
    text = """FUNCTION_BLOCK F
VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT q, r : BOOL; n : INT; END_VAR
INITIAL_STEP S1: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
STEP S2: r(N); Follow(N); Once(P1); Twice(P); END_STEP
TRANSITION FROM S2 TO S1 := NOT a; END_TRANSITION
ACTION Follow: q := a; END_ACTION
ACTION Once: n := n + 1; END_ACTION
ACTION Twice: n := n + 2; END_ACTION
END_FUNCTION_BLOCK
"""
    source = sfc.loads(text.encode(), format="iec-text")
    _, report = sfc.convert(source, "grafcet-text", partial=True)
    told = [item.path for item in report.losses if item.what == "final scan"]
    assert told == ["POU F / step S2 / action Follow", "POU F / step S2 / action Twice"]


NOTATION = """PROGRAM P
    VAR_INPUT
        a : BOOL;
        b : BOOL;
        n : INT;
        XWait : BOOL;
    END_VAR
    VAR
        t : TON;
    END_VAR
    INITIAL_STEP Fill: END_STEP
    STEP Wait: END_STEP
    STEP Rest: END_STEP
    TRANSITION FROM Fill TO Wait := {condition}; END_TRANSITION
    TRANSITION FROM Wait TO Rest := Wait.T >= T#1m30s; END_TRANSITION
    TRANSITION FROM Rest TO Fill := TRUE; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.parametrize(
    ("condition", "written"),
    [
        ("a AND NOT b", "a * /b"),
        ("NOT (a OR b) AND (a OR (a AND b))", "/(a + b) * (a + a * b)"),
        ("NOT NOT a", "/(/a)"),
        ("Fill.T >= T#3s AND NOT (Fill.T >= T#4s)", "3s/XFill * /(4s/XFill)"),
        ("Rest.X AND a", "XRest * a"),
        ("Wait.X AND a", "Wait.X * a"),  # XWait is an input
        ("Rest.T >= T#3s", "[Rest.T >= T#3s]"),  # the time of another step stands still
        ("n > 3 OR t.Q", "[n > 3] + t.Q"),
        ("(NOT a) = b", "[(NOT a) = b]"),
        ("NOT (n + 1 > 3)", "/[n + 1 > 3]"),
        ("NOT (n = 0 OR a)", "/([n = 0] + a)"),
        ("NOT (n = 0 AND a) OR b", "/([n = 0] * a) + b"),
        ("a XOR b", "a XOR b"),
        ("a AND (b XOR a)", "a AND (b XOR a)"),
        ("n = ABS(n) AND a", "[n = ABS(n)] * a"),
    ],
)
def test_charts_of_tools_have_conditions_of_iec_60848(condition: str, written: str) -> None:
    """They were structured text: a GRAFCET for people to read had `a AND NOT b` and `Fill.T >= T#3s`."""
    source = sfc.loads(NOTATION.format(condition=condition).encode())
    text = sfc.convert(source, "grafcet-text", limit=0, partial=True).data
    lines = [line.partition(" : ")[2] for line in text.decode().splitlines() if " -> " in line]
    assert lines == [written, "[Wait.T >= T#1m30s]", "1"]
    assert all(condition_problem(line) is None for line in lines)
    back = sfc.loads(text).pous[0].chart
    assert back is not None
    conditions = [each.condition for each in back.transitions]
    assert next(isinstance(each, m.Expression) and each.text for each in conditions) == condition


def test_tags_that_a_chart_names_are_in_its_tables() -> None:
    """A chart of TIA Portal with a tag table was refused: a GRAFCET declares no variables of a project."""
    source = sfc.loads(sfc.convert(sfc.load(path_of("two_cylinders")), "simaticml", limit=0).data)
    source.tag_tables[0].tags += [
        Tag(name="Spare", type="Bool", address="%I9.0"),
        Tag(name="Level", type="Int", address="%MW30"),
        Tag(name="Clock", type="Timer", address="%T1"),
    ]
    chart = source.pous[0].chart
    assert chart is not None
    chart.transitions[-1].condition = m.Expression(text='"Level" > 3 AND "NOT_AUS"')
    data, report = sfc.convert(source, "grafcet-text", limit=0)
    head = data.decode().partition("INITIAL STEP")[0].split("\n\n")[1:-1]
    assert [table.splitlines()[0] for table in head] == ["INPUTS", "OUTPUTS", "INTERNALS"]
    assert head[0].splitlines()[1] == '    START %I0.0 "Taster (Schließer)"'
    assert head[2].splitlines()[1:] == ["    Level %MW30 : INT"]
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    assert sfc.loads(data).tag_tables == source.tag_tables
    editor, report = sfc.convert(source, "grafcet", limit=0)
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    assert editor.count(b"<variableDeclarations ") == sum(table.count("\n") for table in head)
    assert sfc.loads(editor).tag_tables == source.tag_tables
    chart.transitions[-1].condition = m.Expression(text='"Clock"')
    lost = sfc.convert(source, "grafcet-text", limit=0, partial=True).report.with_outcome(Outcome.NOT_EXECUTED)
    assert [item.path.rpartition(" / ")[2] for item in lost] == ["Clock"]
