"""Step lists: read from CSV and XLSX, written into the list that was read, refused cell by cell."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import openpyxl
import pytest
from hypothesis import given
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.errors import StructureError
from plcopen_sfc.model import Pou, PouKind, Project, Qualifier, SfcBody, SfcNetwork
from plcopen_sfc.model.numbering import numbered_in_order

FOLDER = Path("fixtures/steplist")
MIXER = FOLDER / "mixer.csv"


def table(text: str) -> bytes:
    return text.replace("|", ";").encode()


def mixer_chart(path: Path) -> tuple[Pou, SfcNetwork]:
    pou = sfc.load(path).pous[0]
    assert pou.chart is not None
    return pou, pou.chart


@pytest.mark.parametrize("name", ["mixer.csv", "mixer.xlsx"])
def test_the_template_is_read(name: str) -> None:
    project = sfc.load(FOLDER / name)
    pou, chart = mixer_chart(FOLDER / name)
    assert (pou.name, pou.kind) == ("Mixer", PouKind.PROGRAM)
    assert [(step.name, step.number, step.initial) for step in chart.steps] == [
        ("Idle", 1, True),
        ("Fill", 10, False),
        ("Heat", 20, False),
        ("Stir", 21, False),
        ("Drain", 30, False),
    ]
    fill = chart.step("Fill")
    assert [(a.qualifier, a.target, a.duration) for a in fill.actions] == [
        (Qualifier.N, "Valve_A", None),
        (Qualifier.L, "Valve_B", "T#2s"),
    ]
    assert chart.step("Stir").actions[1].body is not None
    labels = {chart.label(t): (getattr(t.condition, "text", None), t.priority) for t in chart.transitions}
    assert labels == {
        "Idle -> Fill": ("Start AND NOT Fault", None),
        "Fill -> Heat+Stir": ("Level_High", 1),
        "Fill -> Idle": ("Fault", 2),
        "Heat+Stir -> Drain": ("Temp_OK", None),
        "Drain -> Idle": ("NOT Level_Low", None),
    }
    variables = {v.name: (v.address, v.comment) for v in project.global_variables[0].variables}
    assert variables["Start"] == ("%I0.0", "push button")
    assert variables["Lamp"] == ("%Q4.5", "signal lamp")
    assert [v.name for v in pou.variables()] == ["Batches"]


def test_both_forms_are_the_same_project_and_come_back() -> None:
    text, book = sfc.load(MIXER), sfc.load(FOLDER / "mixer.xlsx")
    assert sfc.diff(text, book).equal
    assert sfc.dumps(text) == MIXER.read_bytes()
    assert sfc.dumps(book) == (FOLDER / "mixer.xlsx").read_bytes()
    assert sfc.dumps(text, format="xlsx") == sfc.dumps(text, format="xlsx"), "no time of the day in it"


@pytest.mark.parametrize("target", ["codesys", "simaticml", "plcopen"])
def test_a_list_becomes_a_file_of_each_tool(target: str) -> None:
    done = sfc.convert(sfc.load(MIXER), target)
    # the initial step resets the lamp, and tools begin with it in another scan
    assert {item.what for item in done.report.losses} == ({"start of the chart"} if target != "plcopen" else set())
    back = sfc.loads(done.data).pou("Mixer").chart
    assert back is not None
    assert [step.name for step in back.steps] == ["Idle", "Fill", "Heat", "Stir", "Drain"]


def test_an_edit_changes_one_cell_of_a_text() -> None:
    project = sfc.load(MIXER)
    project.pou("Mixer").sfc.step("Heat").comment = "=5 K"  # type: ignore[union-attr]
    old, new = MIXER.read_bytes().split(b"\r\n"), sfc.dumps(project).split(b"\r\n")
    changed = [b for a, b in zip(old, new, strict=True) if a != b]
    assert changed == [b";Heat;20;;'=5 K;N;Heater;;Temp_OK;Drain;;ready"]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_an_edited_text_keeps_its_encoding(encoding: str) -> None:
    data = MIXER.read_bytes().decode("utf-8-sig").encode(encoding)
    project = sfc.loads(data)
    project.rename("Mixer.Fill", "Befüllen")
    saved = sfc.dumps(project)
    assert saved[:2] == data[:2]
    assert "Befüllen" in saved.decode(encoding)
    assert sfc.loads(saved).pous[0].chart.step("Befüllen")


def test_an_edit_changes_one_cell_of_a_workbook_and_its_formats_stay() -> None:
    book = openpyxl.load_workbook(FOLDER / "mixer.xlsx")
    book["Steps"]["A2"].font = openpyxl.styles.Font(italic=True)
    book["Steps"]["N1"], book["Steps"]["N4"] = "Remark", "ask Karl"
    book.create_sheet("Notes")["A1"] = "do not lose me"
    saved = io.BytesIO()
    book.save(saved)
    project = sfc.loads(saved.getvalue())
    assert [finding.code for finding in project.diagnostics] == ["LST110"]
    project.pou("Mixer").sfc.step("Heat").comment = "=5 K"  # type: ignore[union-attr]
    after = openpyxl.load_workbook(io.BytesIO(sfc.dumps(project)))
    cells = {
        cell.coordinate: cell.value
        for row in after["Steps"].iter_rows()
        for cell in row
        if cell.value != book["Steps"][cell.coordinate].value
    }
    assert cells == {"E5": "=5 K"}
    assert after["Steps"]["E5"].data_type == "s", "no formula"
    assert after["Steps"]["A2"].font.italic
    assert after["Steps"]["N4"].value == "ask Karl"
    assert after["Notes"]["A1"].value == "do not lose me"


def test_a_cell_of_a_column_that_is_not_read_stays_beside_its_step() -> None:
    source = table("Step|Action|Condition|Next|Remark\nA|Lamp|x|B|first\nB||y|A|second\n")
    project = sfc.loads(source)
    chart = project.pous[0].chart
    assert chart is not None
    chart.steps.insert(1, chart.add_step("M"))
    chart.steps.pop()
    chart.add_transition("M", "B", "z")
    text = sfc.dumps(project).decode()
    assert [(row[0], row[4]) for row in csv.reader(io.StringIO(text), delimiter=";") if len(row) > 4] == [
        ("Step", "Remark"),
        ("A", "first"),
        ("M", ""),
        ("B", "second"),
    ]


def test_actions_and_transitions_in_rows_of_their_own_are_not_lost_by_an_edit() -> None:
    source = table("Step|Comment|Action|Condition|Next\nA||Lamp||\n|||x|B\n|||y|A\nB||Motor||\n||Horn||\n|||z|A\n")
    project = sfc.loads(source)
    assert project.pous[0].chart is not None
    project.pous[0].chart.step("A").comment = "new"
    back = sfc.loads(sfc.dumps(project))
    assert numbered_in_order(back).pous == numbered_in_order(project).pous


def test_german_headings_and_the_conventions_of_lists() -> None:
    source = table(
        "Schritt|Nr.|Aktion|Zeit|Kennung|Weiterschaltbedingung|Folgeschritt\n"
        "Start|1|Lampe|1,5 s|D|a|\nEnde|2||||b|1\nHalt|3||||c|(end)\n"
    )
    chart = sfc.loads(source).pous[0].chart
    assert chart is not None
    assert [chart.label(t) for t in chart.transitions] == ["Start -> Ende", "Ende -> Start", "Halt -> nowhere"]
    assert chart.step("Start").initial
    assert chart.step("Start").actions[0].duration == "T#1.5s"


def test_blocks_sections_actions_and_settings_of_s7_graph() -> None:
    source = table(
        "Program|Step|Qualifier|Action|Event|Interlocked|Interlock|Supervision|Max time|Condition|Next\n"
        "FUNCTION_BLOCK Chain|S1|N|A := B|S1|x|ok|fault|30s|go|S1\n||entry|Prepare||||||\n\n"
        "Program|Action|Statements\nChain|Prepare|n := 0;\n\n"
        "Program|Variable|Section|Type|Initial value\nChain|n|VAR_INPUT|INT|5\nGVL|k|VAR_GLOBAL CONSTANT|REAL|1.5\n"
    )
    project = sfc.loads(source)
    assert not project.diagnostics
    pou = project.pous[0]
    step = pou.chart.steps[0] if pou.chart is not None else None
    assert step is not None
    assert pou.kind is PouKind.FUNCTION_BLOCK
    assert (step.actions[0].target, step.actions[0].value, step.actions[0].event) == ("A", "B", "S1")
    assert step.actions[0].interlock
    assert (step.max_time, step.entry_action, pou.actions[0].name) == ("T#30s", "Prepare", "Prepare")
    assert step.interlock is not None
    assert step.supervision is not None
    assert project.global_variables[0].name == "GVL"
    assert project.global_variables[0].constant
    again = sfc.loads(sfc.dumps(project, format="csv", fresh=True))
    assert sfc.diff(project, again).equal


def test_what_rows_of_a_simultaneous_group_tell_is_in_any_of_them() -> None:
    head = "Step|Condition|Next|Simultaneous|Priority\nS|a|A, B||\n"
    there, below = (
        sfc.loads(table(f"{head}{rows}")).pous[0].chart for rows in ("A|b|S|j|1\nB|||j|\n", "A||S|j|\nB|b||j|1\n")
    )
    assert there == below
    assert there is not None
    assert there.transitions[1].priority == 1


@pytest.mark.parametrize(
    ("written", "in_s7", "in_codesys"),
    [("EW64", "%IW64", "%IW32"), ("%IW64", "%IW128", "%IW64"), ("md8", "%MD8", "%MD2"), ("A4.1", "%Q4.1", "%Q4.1")],
)
def test_addresses_of_s7_count_bytes(written: str, in_s7: str, in_codesys: str) -> None:
    """They went to TIA Portal as words, so that the machine read other terminals."""
    kind = {"D": "DINT", "W": "INT"}.get(written.strip("%")[1].upper(), "BOOL")
    project = sfc.loads(table(f"Variable|Type|Address\nx|{kind}|{written}\n"))
    s7 = sfc.loads(sfc.dumps(project, format="simaticml"), as_tool=True)
    assert [tag.address for each in s7.tag_tables for tag in each.tags] == [in_s7]
    codesys = sfc.loads(sfc.dumps(project, format="codesys"), as_tool=True)
    assert [each.address for section in codesys.global_sections() for each in section.variables] == [in_codesys]
    symbols = sfc.loads(sfc.dumps(project, format="sdf"))
    again = sfc.loads(sfc.dumps(symbols, format="csv", partial=True))
    assert sfc.loads(sfc.dumps(again, format="sdf")).tag_tables == symbols.tag_tables


WRONG = {
    "Program|Step|Next|Condition\nBLOCK X|A|A|x": ("LST101", 2, 1),
    "Step|Next|Condition\n|A|x\nA||": ("LST102", 2, 1),
    "Step|Next|Condition\nA|A|x\na|A|y": ("LST103", 3, 1),
    "Step|Action|Qualifier\nA|x|Q": ("LST104", 2, 3),
    "Step|Action|Event\nA|x|S7": ("LST104", 2, 3),
    "Step|Action|Qualifier\nA|x|D": ("LST105", 2, 1),
    "Step|Action|Time\nA|x|soon enough": ("LST105", 2, 3),
    "Step|Number|Action\nA|1a|x": ("LST105", 2, 2),
    "Step|Initial|Action\nA|perhaps|x": ("LST105", 2, 2),
    "Step|Action|Qualifier\nA||N": ("LST106", 2, 2),
    "Step|Next|Condition|Simultaneous\nA|B|x|1\nB|A|y|1": ("LST107", 3, 3),
    "Step|Next|Condition|Priority\nA|A|x|1\n|A|y|": ("LST111", 3, 4),
    "Step|Next|Condition|Priority|Simultaneous\nA|A|x||s\nB||||s\n|A|y|1|": ("LST111", 2, 4),
    "Step|Next|Condition\nA|C|x": ("LST108", 2, 2),
    "Step|Next|Condition\nA||x": ("LST108", 2, 2),
    "Variable|Type\nx|ARRAY INT": ("LST109", 2, 2),
    "Variable|Type|Section\nx|INT|VAR_SOMETHING": ("LST109", 2, 3),
    "Variable|Type|Address\nx|INT|over there": ("LST109", 2, 3),
    "Variable|Type|Address\nx|INT|EW65": ("LST109", 2, 3),
    "Variable|Type\na b|INT": ("LST109", 2, 1),
    "Variable|Type\nb|INT\nB|INT": ("LST103", 3, 1),
    "Program|Variable|Type\nMain|b|INT\nMain|c|INT\n|B|BOOL": ("LST103", 4, 2),
    "Program|Variable|Section|Type\nL|b|VAR_GLOBAL|INT\nL|b|VAR_GLOBAL CONSTANT|INT": ("LST103", 3, 2),
    "Program|Action|Statements\nMain|a|x := 1;\n|A|x := 2;": ("LST103", 3, 2),
    "Step|Qualifier|Action|Condition|Next\nA|N|v|x|A\n\n|||z|A": ("LST112", 4, 4),
    "Step|Action|Next|Condition\nA||A|x\n|||\n|S||": ("LST112", 4, 2),
    "Step|Action|Next|Condition\nA||A|x\n\n||A|y\n\nVariable|Type\nx|BOOL": ("LST112", 4, 3),
    "Step|Action|Next|Condition\nA||A|x\n\nwritten by Karl": ("LST112", 4, 1),
    "Step|Next|Number\nA|A|1\n|A|2": ("LST113", 3, 3),
    "Step|Next|Initial\nA|A|\n|A|x\n|A|0": ("LST113", 3, 3),
    "Step|Next|Max time\nA|A|\n|A|2s": ("LST113", 3, 3),
    "Step|Next|Supervision\nA|A|\n|A|x": ("LST113", 3, 3),
    "Step|Next|Comment\nA|A|first\n|A|second": ("LST113", 3, 3),
    "Step|Next|Qualifier|Action|Time\nA|A|main|x|2s": ("LST113", 2, 5),
    "Step|Next|Qualifier|Action|Event\nA|A|entry|x|S1": ("LST113", 2, 5),
    "Step|Next|Qualifier|Action|Interlocked\nA|A|exit|x|x": ("LST113", 2, 5),
    "Program|Variable|Section|Type\nL|a|VAR|INT\nL|b|VAR_GLOBAL|INT": ("LST109", 2, 3),
    "Program|Variable|Section|Type\nL|b|VAR_GLOBAL|INT\nL|a|VAR_INPUT|INT": ("LST109", 3, 3),
    "Stepp|Action|Qualifier\nA|x|N\n\nVariable|Type\nx|BOOL": ("LST112", 1, 1),
}


@pytest.mark.parametrize("source", WRONG)
def test_what_is_wrong_is_found_with_its_cell(source: str) -> None:
    data = io.StringIO()
    csv.writer(data).writerows(line.split("|") for line in source.splitlines())
    project = sfc.loads(data.getvalue().encode(), format="csv")
    found = [(each.code, each.location.line, each.location.column) for each in project.diagnostics]
    assert found == [WRONG[source]]


def test_titles_are_no_findings_and_notes_are_warnings() -> None:
    titled = "Mixer\n\nSteps\nStep|Next|Condition\nA|A|x\n\nVariables\nVariable|Type\nx|BOOL\n"
    assert not sfc.loads(table(titled)).diagnostics
    (note,) = sfc.loads(table(f"{titled}\nchecked by Karl\n")).diagnostics
    assert (note.code, note.severity) == ("LST112", "warning")


def test_a_workbook_tells_the_sheet_of_a_row_that_it_does_not_read() -> None:
    book = openpyxl.load_workbook(FOLDER / "mixer.xlsx")
    steps = book["Steps"]
    steps.insert_rows(5)
    book.create_sheet("IO").append(["Variabel", "Typ"])
    saved = io.BytesIO()
    book.save(saved)
    found = [each for each in sfc.loads(saved.getvalue(), path="list.xlsx").diagnostics if each.code == "LST112"]
    assert "list.xlsx:6:2 (Steps!B6)" in [str(each.location) for each in found if each.severity == "error"]
    assert [str(each.location) for each in found if each.severity == "warning"] == ["list.xlsx:1:1 (IO!A1)"]


def test_the_place_in_a_workbook_is_its_cell() -> None:
    project = sfc.loads(sfc.dumps(sfc.load(MIXER), format="xlsx"))
    book = openpyxl.load_workbook(io.BytesIO(sfc.dumps(project)))
    book["Steps"]["J3"] = "Haet"
    saved = io.BytesIO()
    book.save(saved)
    (finding,) = sfc.loads(saved.getvalue(), path="list.xlsx").diagnostics
    assert str(finding.location) == "list.xlsx:3:10 (Steps!J3)"
    assert "did you mean 'Heat'?" in finding.message
    with pytest.raises(sfc.DamagedSourceError):
        sfc.dumps(sfc.loads(saved.getvalue()), format="codesys")


def test_numbers_of_a_workbook_are_texts_and_formulas_count_with_their_value() -> None:
    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    for row in (["Step", "Number", "Next", "Condition"], ["A", 10.0, "A", True]):
        sheet.append(row)
    saved = io.BytesIO()
    book.save(saved)
    chart = sfc.loads(saved.getvalue()).pous[0].chart
    assert chart is not None
    assert chart.steps[0].number == 10
    assert getattr(chart.transitions[0].condition, "text", "") == "TRUE"
    sheet["B2"] = "=5+5"
    saved = io.BytesIO()
    book.save(saved)
    with pytest.raises(StructureError, match=r"Sheet!B2"):
        sfc.loads(saved.getvalue())


def test_a_lost_program_is_refused_and_a_file_without_a_table_is_an_error() -> None:
    with pytest.raises(sfc.LossError, match="merge"):
        sfc.dumps(sfc.load("fixtures/codesys/sorting_conveyor.xml"), format="csv")
    with pytest.raises(StructureError, match="headings"):
        sfc.loads(b"a;b\n1;2\n", format="csv")


CELLS = st.text(st.characters(blacklist_categories=("Cs", "Cc")), min_size=1, max_size=12).map(str.strip)


@pytest.mark.slow
@given(st.lists(st.sampled_from("=+-@'\"; ,x").map(str), min_size=1, max_size=6).map("".join), CELLS)
def test_any_comment_comes_back_from_a_text(start: str, rest: str) -> None:
    comment = start + rest
    chart = SfcNetwork()
    chart.add_step("A", initial=True).comment = comment
    project = Project(pous=[Pou(name="P", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])])
    data = sfc.dumps(project, format="csv")
    cells = next(csv.reader(io.StringIO(data.decode("utf-8-sig").splitlines()[1]), delimiter=";"))
    assert cells[4][0] not in "=+-@"
    back = sfc.loads(data).pous[0].chart
    assert back is not None
    assert back.steps[0].comment == comment
