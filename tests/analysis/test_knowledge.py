"""Declarations of the names in conditions decide more conditions."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.exclusivity import Truth, exclusive, truth
from plcopen_sfc.analysis.knowledge import Knowledge, ValueKind, VariableValues, project_knowledge
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project, TagTable
from plcopen_sfc.model.types import Variable

SOURCE = """
TYPE E_Mode : (Idle, Auto, Hand); END_TYPE
TYPE E_Level : (Low := 1, High := 10); END_TYPE
TYPE E_Same : (One := 1, Uno := 1); END_TYPE
TYPE Valve : STRUCT Open : BOOL; Flow : REAL; END_STRUCT; END_TYPE
PROGRAM Main
VAR CONSTANT MIN_LEVEL : INT := 10; MAX_LEVEL : INT := 90; COLD : INT := -5; WAIT : TIME := T#5s; END_VAR
VAR
  level : INT; count : USINT; speed : REAL; since : TIME; mode : E_Mode; fill : E_Level; same : E_Same; v : Valve;
  list : ARRAY [0..9] OF INT; part : INT (0..3); on : BOOL; ready : BOOL; other : INT; name : STRING;
END_VAR
INITIAL_STEP S1: END_STEP
END_PROGRAM
"""


@pytest.fixture(scope="module")
def known() -> Knowledge:
    project = sfc.loads(SOURCE.encode(), format="iec-text")
    pou = project.pou("Main")
    return project_knowledge(project, pou, pou.sfc)


@pytest.mark.parametrize(
    ("a", "b", "answer"),
    [
        ("level > 5", "level < 6", Answer.YES),
        ("speed > 5", "speed < 6", Answer.NO),
        ("level > MAX_LEVEL", "level < MIN_LEVEL", Answer.YES),
        ("level < MAX_LEVEL", "level > MIN_LEVEL", Answer.NO),
        ("level < COLD", "level > -6", Answer.YES),
        ("since > WAIT", "since < T#5s", Answer.YES),
        ("mode = Auto", "mode = Hand", Answer.YES),
        ("mode = Auto", "mode <> Hand", Answer.NO),
        ("mode = E_Mode#Auto", "mode = E_Mode#Hand", Answer.YES),
        ("fill = Low", "fill = High", Answer.YES),
        ("same = One", "same = Uno", Answer.UNKNOWN),
        ("v.Open", "NOT v.Open", Answer.YES),
        ("v.Flow > 1", "v.Flow < 2", Answer.NO),
        ("list[1] > 5", "list[1] < 6", Answer.YES),
        ("on = ready", "on AND NOT ready", Answer.YES),
        ("level = other", "level = other", Answer.NO),
        ("S1.X", "NOT S1.X", Answer.YES),
        ("nobody > 5", "nobody < 6", Answer.UNKNOWN),
    ],
)
def test_what_is_declared_decides(known: Knowledge, a: str, b: str, answer: Answer) -> None:
    found = exclusive(a, b, knowledge=known)
    assert found.answer is answer, found


def test_ranges_and_enumerations_are_closed(known: Knowledge) -> None:
    assert truth("count >= 0", knowledge=known) is Truth.ALWAYS
    assert truth("part > 3", knowledge=known) is Truth.NEVER
    assert truth("mode = Idle OR mode = Auto OR mode = Hand", knowledge=known) is Truth.ALWAYS
    assert truth("MAX_LEVEL > 50", knowledge=known) is Truth.ALWAYS


def test_witnesses_are_of_the_type(known: Knowledge) -> None:
    found = exclusive("mode <> Idle", "mode <> Hand AND level >= 7 AND level < 8", knowledge=known)
    assert found.witness == {"mode": "Auto", "level": "7"}


def test_addresses_tell_their_type(known: Knowledge) -> None:
    for text, domain in (
        ("%IX0.0", VariableValues(ValueKind.BOOL)),
        ("%I0.1", VariableValues(ValueKind.BOOL)),
        ("%IW4", None),
    ):
        tree = parse_expression(text, Dialect.IEC).tree
        assert known(tree) == domain


def test_user_constants_of_tag_tables_count() -> None:
    variables = [Variable.model_validate({"name": n, "type": "INT", "initial": v}) for n, v in (("A", "5"), ("B", "7"))]
    project = Project(name="p", dialect=Dialect.SCL, tag_tables=[TagTable(name="t", constants=variables)])
    known = project_knowledge(project)
    found = exclusive('x = "A"', 'x = "B"', dialect=Dialect.SCL, knowledge=known)
    assert found.answer is Answer.YES, found
