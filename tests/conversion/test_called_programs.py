"""Programs of CODESYS that others call, or whose variables others name, in tools without such calls."""

from __future__ import annotations

import io

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.profile import PROFILES, default_profile
from plcopen_sfc.semantics.subjects import resolve

TARGETS = [("plcopen-2.01", ""), ("plcopen-1.01", ""), ("plcopen-2.01", "beremiz"), ("iec-text", "matiec")]
TEXT = """PROGRAM Line
VAR_INPUT go : BOOL; END_VAR
VAR_OUTPUT busy : BOOL; END_VAR
VAR n : INT; most : INT := 3; other : INT;{declared} END_VAR
INITIAL_STEP Idle: END_STEP
TRANSITION FROM Idle TO Work := go AND n < most; END_TRANSITION
STEP Work: busy(N); Count(P); END_STEP
TRANSITION FROM Work TO Idle := NOT go; END_TRANSITION
ACTION Count: n := n + 1;{counted} END_ACTION
END_PROGRAM
PROGRAM Main
VAR_INPUT start : BOOL; END_VAR
VAR_OUTPUT lamp : BOOL; parts : INT; END_VAR
Line.most := 5;
Line(go := start);
lamp := Line.busy; parts := Line.n;
END_PROGRAM
PROGRAM Watch
VAR seen : INT; END_VAR
seen := Main.parts;
END_PROGRAM
"""


def plant(declared: str = "", counted: str = "") -> m.Project:
    """A project of CODESYS: a task calls Main and Watch, Main calls Line, Watch reads Main."""
    project = sfc.loads(TEXT.format(declared=declared, counted=counted).encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    called = [m.PouInstance(name="Main"), m.PouInstance(name="Watch")]
    settings = m.TaskSettings(kind="Cyclic", interval="t#20ms")
    tasks = [m.Task(name="MainTask", settings=settings, instances=called)]
    project.applications = [m.Resource(name="Application", tasks=tasks)]
    return sfc.loads(sfc.dumps(project, format="codesys", partial=True), format="codesys")


def sections(pou: m.Pou) -> list[m.VariableSection]:
    return pou.interface.sections if pou.interface is not None else []


def kinds(project: m.Project) -> list[tuple[str, str]]:
    return [(pou.name, pou.kind.value) for pou in project.pous]


@pytest.mark.slow
@pytest.mark.parametrize(("target", "flavour"), TARGETS)
def test_a_called_program_is_a_block_with_one_instance(target: str, flavour: str) -> None:
    source, out = plant(), io.BytesIO()
    report = sfc.save(source, out, format=target, flavour=flavour, limit=8)
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []
    assert "equal" in report.compared["POU Line"]
    assert "(proof:" in report.compared["POU Line"]
    (item,) = [item for item in report.items if (item.what, item.path) == ("program", "POU Line")]
    assert item.why.startswith("the function block Line_block with the global instance Line")
    written = sfc.loads(out.getvalue(), format=target, as_tool=True)
    assert kinds(written) == [
        ("Line_block", "functionBlock"),
        ("Main_block", "functionBlock"),
        ("Watch", "program"),
        ("Main_task", "program"),
    ]
    verdict = equivalent(
        resolve(source, "Main"),
        resolve(written, "Main_block"),
        profile=(default_profile(source), PROFILES[flavour] if flavour else default_profile(written)),
        delay="auto",
        limit=5,
    )
    assert not verdict.different, verdict
    assert verdict.proven or verdict.scans


@pytest.mark.parametrize("target", ["plcopen-2.01", "plcopen-1.01"])
def test_a_called_program_comes_back_as_one(target: str) -> None:
    source = plant()
    there = sfc.loads(sfc.dumps(source, format=target), format=target)
    data, report = sfc.convert(there, "codesys")
    back = sfc.loads(data, format="codesys")
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []
    assert kinds(back) == kinds(source)
    for mine, found in zip(source.pous, back.pous, strict=True):  # others name `n` and `most`, and see them in TC6
        assert [(v.name, s.kind) for s in sections(mine) for v in s.variables] == [
            (v.name, s.kind) for s in sections(found) for v in s.variables
        ]
    assert [[each.name for each in task.instances] for place in back.resources() for task in place.tasks] == [
        ["Main", "Watch"]
    ]
    assert not any(section.variables for section in back.global_sections())


@pytest.mark.parametrize(
    "fields",
    [
        {"declared": " lamp AT %QX0.0 : BOOL;"},
        {"declared": " seen : INT;", "counted": " seen := Main.parts;"},
    ],
    ids=["a variable at an address", "two programs that name each other"],
)
def test_a_program_that_no_block_can_be_is_told(fields: dict[str, str]) -> None:
    report = sfc.convert(plant(**fields), "plcopen-2.01", partial=True)[1]
    lost = {(item.what, item.path) for item in report.with_outcome(Outcome.NOT_EXECUTED)}
    assert ("call of a program", "POU Main / call of a program Line") in lost
