"""Texts with faults: what is wrong is said with its line and column, the rest is read, and nothing is dropped."""

from __future__ import annotations

import time
from contextlib import nullcontext

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.diagnostics import DamagedSourceError, Severity
from plcopen_sfc.errors import EncodingError
from plcopen_sfc.formats.file_recognition import recognise
from plcopen_sfc.report import Outcome

GOOD = """PROGRAM Main
INITIAL_STEP A: END_STEP
TRANSITION FROM A TO A := x; END_TRANSITION
END_PROGRAM
"""


def load(text: str | bytes) -> m.Project:
    data = text if isinstance(text, bytes) else text.encode()
    project = sfc.loads(data, format="iec-text", path="a.st")
    assert sfc.dumps(project) == data
    written = sfc.dumps(project, format="iec-text", fresh=True, partial=True)
    assert sfc.loads(written, format="iec-text") == project
    return project


def findings(project: m.Project) -> list[tuple[str, int | None, int | None]]:
    return [(d.code, d.location.line, d.location.column) for d in project.diagnostics]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("PROGRAM P\nINITIAL_STEP A:\n  Act(N);\nSTEP B:\nEND_STEP\nEND_PROGRAM\n", ("IEC101", 2, 1)),
        ("PROGRAM P\nINITIAL_STEP A: END_STEP\nTRANSITION FROM A TO A := x;\nEND_PROGRAM\n", ("IEC101", 3, 1)),
        ("PROGRAM P\nINITIAL_STEP A: END_STEP\n  ACTION Act: x := 1;\nEND_PROGRAM\n", ("IEC101", 3, 3)),
        ("PROGRAM P\nVAR x : INT;\nx := 1;\nEND_PROGRAM\n", ("IEC101", 2, 1)),
        ("PROGRAM P\nx := 1;\n", ("IEC101", 1, 1)),
        ("PROGRAM P\nx := 1;\nPROGRAM Q\ny := 1;\nEND_PROGRAM\n", ("IEC101", 1, 1)),
        ("TYPE T : INT;\nPROGRAM Q\ny := 1;\nEND_PROGRAM\n", ("IEC101", 1, 1)),
        ("CONFIGURATION C\nRESOURCE R ON P\nEND_CONFIGURATION\n", ("IEC101", 2, 1)),
        (GOOD.replace("TO A", "TO B"), ("SFC103", 3, 1)),
        (GOOD.replace("FROM A", "FROM (A, B)"), ("SFC103", 3, 1)),
        (GOOD.replace("TRANSITION F", "STEP A: END_STEP\nTRANSITION F"), ("SFC109", 3, 1)),
        (GOOD.replace("INITIAL_STEP", "STEP"), ("SFC111", 2, 1)),
        (GOOD.replace(" := x;", ""), ("SFC112", 3, 1)),
        (GOOD.replace("A: END", "A: Act(N; END"), ("IEC102", 2, 17)),
        (GOOD.replace("A: END", "A: Act(WRONG); END"), ("IEC102", 2, 17)),
        (GOOD.replace(":= x;", "x;"), ("IEC103", 3, 24)),
        (GOOD.replace(":= x;", ":= x; y;"), ("IEC103", 3, 24)),
        (GOOD.replace("TRANSITION F", "y := 1;\nTRANSITION F"), ("IEC104", 2, 25)),
        (GOOD.replace(":= x;", ":= x AND;"), ("IEC110", 3, 32)),
        ("PROGRAM P\nVAR\n  x : ;\nEND_VAR\nEND_PROGRAM\n", ("IEC111", 3, 7)),
        ("PROGRAM P\nx := (1;\nEND_PROGRAM\n", ("IEC110", 2, 8)),
        ("PROGRAM P\nx := 'open;\nEND_PROGRAM\n", ("IEC110", 2, 6)),
        (GOOD.replace("A: END", "A: {plcopen_sfc max_time = 5} END"), ("IEC210", 2, 38)),
        (GOOD.replace("A: END", "A: {plcopen_sfc actions[3].target := 'x'} END"), ("IEC211", 2, 17)),
        (GOOD.replace("A: END", "A: {plcopen_sfc symbol := 'sometimes'} END"), ("IEC212", 2, 17)),
        (GOOD.replace("A: END", "A: {plcopen_sfc name := 'B C' FOR 'B_C'} END"), ("IEC213", 2, 17)),
        ("stray words\n" + GOOD, ("IEC107", 1, 1)),
    ],
)
def test_what_is_wrong_is_said_with_its_place(text: str, expected: tuple[str, int, int]) -> None:
    found = findings(load(text))
    assert expected in found
    assert {code for code, _, _ in found if code.startswith("IEC")} <= {expected[0], "IEC110", "IEC111", "IEC104"}


def test_one_fault_does_not_lose_the_rest() -> None:
    project = load(
        "PROGRAM P\nINITIAL_STEP A:\n  Act(N);\nSTEP B: END_STEP\n"
        "TRANSITION FROM A TO B := ((x; END_TRANSITION\nACTION Act: IF x THEN END_ACTION\n"
        "FUNCTION F : INT\nF := 3;\nEND_FUNCTION\n"
    )
    assert [pou.name for pou in project.pous] == ["P", "F"]
    chart = project.pou("P").sfc
    assert chart is not None
    assert [step.name for step in chart.steps] == ["A", "B"]
    assert [a.target for a in chart.steps[0].actions] == ["Act"]
    assert chart.transitions[0].condition == m.Expression(text="((x")
    assert project.pou("P").actions[0].body == m.StBody(text="IF x THEN")


def test_a_pragma_that_does_not_fit_is_left_out_and_the_others_hold() -> None:
    text = GOOD.replace("A: END", "A:\n{plcopen_sfc max_time := 'T#5s'}\n{plcopen_sfc symbol := 'x'}\nEND")
    project = load(text)
    chart = project.pou("Main").sfc
    assert chart is not None
    assert chart.steps[0].max_time == "T#5s"
    assert findings(project) == [("IEC212", 4, 1)]


def test_a_pragma_of_the_project_that_does_not_fit_is_an_error_with_its_line() -> None:
    with pytest.raises(sfc.SfcError) as caught:
        sfc.loads(
            b"{plcopen_sfc format := 1}\n{plcopen_sfc project.scales.fbd.x := 'wide'}\n" + GOOD.encode(), path="a.st"
        )
    assert (caught.value.location.file, caught.value.location.line) == ("a.st", 2)


def test_a_comment_without_end() -> None:
    project = load("PROGRAM P\nx := 1;\nEND_PROGRAM\n\n(* not closed\nPROGRAM Q\nEND_PROGRAM\n")
    assert [pou.name for pou in project.pous] == ["P"]
    assert ("IEC100", 5, 1) in findings(project)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_encodings(encoding: str) -> None:
    data = GOOD.replace(" A", " Füllen").encode(encoding)
    project = sfc.loads(data)
    chart = project.pou("Main").sfc
    assert chart is not None
    assert chart.steps[0].name == "Füllen"
    assert [d.code for d in project.diagnostics] == (["IEC200"] if encoding == "cp1252" else [])
    assert sfc.dumps(project) == data


def test_a_text_full_of_nul_bytes_is_none() -> None:
    with pytest.raises(EncodingError, match="NUL"):
        sfc.loads(GOOD.encode("utf-16-le"), format="iec-text", path="a.st")


def test_damaged_utf_16_is_no_code_page() -> None:
    for data, line in (
        (GOOD.encode("utf-16")[:-1], 4),
        (GOOD.encode("utf-16").replace("A:".encode("utf-16-le"), b"\x00\xdc\x00\xd8", 1), 2),
    ):
        with pytest.raises(EncodingError, match="byte order mark of UTF-16") as caught:
            sfc.loads(data, format="iec-text", path="a.st")
        assert (caught.value.location.file, caught.value.location.line) == ("a.st", line)
    project = load(GOOD.replace("x;", "x\0;"))
    assert [code for code, _, _ in findings(project)] == ["IEC110"]


@pytest.mark.parametrize(
    "text", ["", "Program of today\n\n10:00 coffee\n", "x := 1;", '{"a": 1}', 'FUNCTION_BLOCK "x"\n']
)
def test_what_is_no_text_of_ours_is_not_taken_for_one(text: str) -> None:
    try:
        kind = recognise(text.encode()).name
    except sfc.SfcError:
        kind = "none"
    assert kind != "iec-text"


@pytest.mark.slow
def test_a_huge_line_is_read_in_linear_time() -> None:
    def seconds(count: int) -> float:
        text = "PROGRAM P " + "x := a AND (b OR c); " * count + "END_PROGRAM"
        start = time.process_time()
        load(text)
        return time.process_time() - start

    seconds(500)
    small, large = seconds(1000), seconds(4000)
    assert large < 16 * small


@pytest.mark.parametrize("target", ["plcopen", "json"])
@pytest.mark.parametrize(
    "text",
    [
        GOOD.replace("TO A", "TO Nowhere"),
        GOOD.replace(":= x;", "x;"),
        GOOD.replace(":= x;", ":= x; y;"),
        GOOD.replace("A: END", "A: Act(WRONG); END"),
        GOOD.replace("TRANSITION F", "words | here;\nTRANSITION F"),
        GOOD + "INTERFACE I END_INTERFACE\n",
    ],
)
def test_what_cannot_be_read_is_carried_through_other_formats(text: str, target: str) -> None:
    project = load(text)
    project.header.created = "2024-01-31T08:30:00"
    errors = [found for found in project.diagnostics if found.severity is Severity.ERROR]
    with pytest.raises(DamagedSourceError, match="found in reading") if errors else nullcontext():
        sfc.convert(project, target, partial=True)
    project.accept_errors()
    _, report = sfc.convert(project, target, partial=True)
    assert report.with_outcome(Outcome.DROPPED) == []
    assert len([item for item in report.losses if item.what == "error"]) == len(errors)
