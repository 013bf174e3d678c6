"""References to steps between the notations of tools."""

from __future__ import annotations

import pytest

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.translation import (
    StepNotation,
    StepReferences,
    Translated,
    TranslationContext,
    translate_text,
)
from plcopen_sfc.model.dialect import Dialect

IEC, CODESYS, SCL = Dialect.IEC, Dialect.CODESYS, Dialect.SCL
S = StepNotation
DIALECTS = {S.IEC: IEC, S.CODESYS: CODESYS, S.FLAG: CODESYS, S.S7_GRAPH: SCL, S.GRAFCET: IEC}


def translated(
    text: str, source: StepNotation, target: StepNotation, names: dict[str, str], **blocks: str
) -> Translated:
    steps = StepReferences(names, source, target, **blocks)
    context = TranslationContext(locals=[], steps=steps)
    return translate_text(text, "expression", DIALECTS[source], DIALECTS[target], context)


@pytest.mark.parametrize(
    ("text", "source", "target", "expected"),
    [
        ("Fill.X AND Fill.T > T#5s", S.IEC, S.CODESYS, "Fill.x AND Fill.t > T#5s"),
        ("fill.x AND Fill.t > T#5s", S.CODESYS, S.IEC, "Fill.X AND Fill.T > T#5s"),
        ("Fill.x", S.CODESYS, S.S7_GRAPH, "#Fill.X"),
        ("#Fill.X AND #Fill.T > T#1s", S.S7_GRAPH, S.CODESYS, "Fill.x AND Fill.t > T#1s"),
        ("Fill.U > T#1s", S.S7_GRAPH, S.S7_GRAPH, "Fill.U > T#1s"),
        ("Fill AND NOT x", S.FLAG, S.IEC, "Fill.X AND NOT x"),
        ("Fill.x", S.CODESYS, S.FLAG, "Fill"),
        ("Fill.x AND Other.x", S.CODESYS, S.IEC, "Fill.X AND Other.x"),
        ("motor.Fill.x", S.CODESYS, S.IEC, "motor.Fill.x"),  # a member of that name, no step
    ],
)
def test_notations(text: str, source: StepNotation, target: StepNotation, expected: str) -> None:
    found = translated(text, source, target, {"Fill": "Fill"})
    assert (found.text, found.notes, found.parsed.problems) == (expected, (), ())


def test_grafcet_refers_by_number() -> None:
    found = translated("X3 AND NOT x4 AND X5", S.GRAFCET, S.CODESYS, {"3": "Fill", "4": "Heat"})
    assert (found.text, found.notes) == ("Fill.x AND NOT Heat.x AND X5", ())
    found = translated("Fill.x AND Heat.X", S.CODESYS, S.GRAFCET, {"Fill": "3", "Heat": "4"})
    assert (found.text, found.notes) == ("X3 AND X4", ())


def test_renamed_steps() -> None:
    found = translated("S1.X AND S2.T > T#1s", S.IEC, S.IEC, {"S1": "Fill", "S2": "S2"})
    assert (found.text, found.notes) == ("Fill.X AND S2.T > T#1s", ())


def test_steps_of_another_block() -> None:
    names = {"Fill": "Fill 1"}
    found = translated("Chart.Fill.x", S.CODESYS, S.S7_GRAPH, names, source_block="Chart", target_block="Chart_DB")
    assert found.text == '"Chart_DB"."Fill 1".X'
    back = translated(
        found.text, S.S7_GRAPH, S.CODESYS, {"Fill 1": "Fill"}, source_block="Chart_DB", target_block="Chart"
    )
    assert (back.text, back.notes) == ("Chart.Fill.x", ())
    found = translated("Fill.x", S.CODESYS, S.S7_GRAPH, names)
    assert found.text == '#"Fill 1".X'


@pytest.mark.parametrize(
    ("text", "source", "target", "expected", "severity"),
    [
        ("#Fill.U > T#1s", S.S7_GRAPH, S.IEC, "Fill.T > T#1s", Severity.WARNING),
        ("#Fill.S1", S.S7_GRAPH, S.CODESYS, "#Fill.S1", Severity.ERROR),
        ("Fill._x", S.CODESYS, S.IEC, "Fill._x", Severity.ERROR),
        ("Fill.t > T#1s", S.CODESYS, S.FLAG, "Fill.t > T#1s", Severity.ERROR),
        ("Fill.T > T#1s", S.IEC, S.GRAFCET, "Fill.T > T#1s", Severity.ERROR),
    ],
)
def test_what_a_notation_cannot_say(
    text: str, source: StepNotation, target: StepNotation, expected: str, severity: Severity
) -> None:
    found = translated(text, source, target, {"Fill": "Fill"})
    assert found.text == expected
    assert severity in [note.severity for note in found.notes]


def test_steps_are_not_known_without_context() -> None:
    found = translate_text("Fill.x", "expression", CODESYS, IEC)
    assert (found.text, found.notes) == ("Fill.x", ())
