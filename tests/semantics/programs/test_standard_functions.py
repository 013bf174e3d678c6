"""Standard functions, each by what it gives."""

from __future__ import annotations

import math
from datetime import UTC, datetime

import pytest
from hypothesis import given, settings
from hypothesis import strategies as s

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.standard_blocks import BlockKind, standard_blocks
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs import Controller
from tests.semantics.programs.running import main, project_of
from tests.sweeps import examples

DAY = 86_400_000_000_000


def value(type_: str, expression: str, variables: str = "", dialect: Dialect = Dialect.IEC) -> object:
    return main(f"{variables} result : {type_};", f"result := {expression};", dialect)["result"]


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("LEN('abc')", 3),
        ("FIND('abcbc', 'bc')", 2),
        ("FIND('abc', 'x')", 0),
        ("ABS(-5)", 5),
        ("MAX(1, 7, 3)", 7),
        ("MIN(4, -2)", -2),
        ("LIMIT(0, 15, 10)", 10),
        ("LIMIT(MN := 0, IN := -1, MX := 10)", 0),
        ("SEL(TRUE, 1, 2)", 2),
        ("SEL(G := FALSE, IN0 := 1, IN1 := 2)", 1),
        ("MUX(2, 10, 20, 30)", 30),
        ("TRUNC(-2.9)", -2),
        ("REAL_TRUNC_INT(2.9)", 2),
        ("BOOL_TO_INT(TRUE)", 1),
        ("STRING_TO_INT('-12')", -12),
        ("STRING_TO_INT('x')", 0),
        ("TIME_TO_INT(T#1s250ms)", 1250),
        ("WORD_BCD_TO_INT(16#1234)", 1234),
        ("WORD_TO_INT(INT_TO_BCD_WORD(1234))", 0x1234),
        ("ADD(1, 2, 3)", 6),
        ("SUB(5, 2)", 3),
        ("DIV(7, 2)", 3),
        ("MOVE(5)", 5),
        ("DAY_OF_WEEK(D#2024-02-29)", 4),
        ("SIZEOF(w)", 4),
        ("DATE_TO_INT(D#1970-01-01)", 0),
    ],
)
def test_functions_of_integers(expression: str, expected: int) -> None:
    assert value("INT", expression, "w : DWORD;") == expected


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("LEFT('abcd', 2)", "ab"),
        ("RIGHT('abcd', 3)", "bcd"),
        ("MID('abcd', 2, 2)", "bc"),
        ("CONCAT('a', 'b', 'c')", "abc"),
        ("INSERT('abc', 'X', 1)", "aXbc"),
        ("DELETE('abcd', 2, 2)", "ad"),
        ("REPLACE('abcd', 'XY', 1, 2)", "aXYcd"),
        ("INT_TO_STRING(-5)", "-5"),
        ("REAL_TO_STRING(0.1)", "0.1"),
        ("BOOL_TO_STRING(TRUE)", "TRUE"),
        ("TIME_TO_STRING(T#90s)", "T#1m30s"),
        ("DATE_TO_STRING(D#2024-02-29)", "D#2024-02-29"),
    ],
)
def test_functions_of_strings(expression: str, expected: str) -> None:
    assert value("STRING", expression) == expected


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("SQRT(2.0)", math.sqrt(2)),
        ("LN(10.0)", math.log(10)),
        ("LOG(1000.0)", 3.0),
        ("EXP(1.0)", math.e),
        ("SIN(1.0)", math.sin(1)),
        ("ATAN2(1.0, -1.0)", math.atan2(1, -1)),
        ("EXPT(2.0, 0.5)", math.sqrt(2)),
        ("INT_TO_LREAL(3)", 3.0),
        ("STRING_TO_LREAL('2.5')", 2.5),
        ("TIME_TO_LREAL(T#1s)", 1000.0),
    ],
)
def test_functions_of_reals(expression: str, expected: float) -> None:
    assert value("LREAL", expression.replace("SQRT(2.0)", "SQRT(LREAL#2.0)"), "") == pytest.approx(expected, rel=1e-6)


def moment(*parts: int) -> int:
    return int(datetime(*parts, tzinfo=UTC).timestamp()) * 10**9  # type: ignore[arg-type,misc]


@pytest.mark.parametrize(
    ("type_", "expression", "expected"),
    [
        ("DT", "CONCAT_DATE_TOD(D#2024-02-29, TOD#12:00:00)", moment(2024, 2, 29, 12)),
        ("DT", "CONCAT_DT(2024, 2, 29, 12, 30, 15, 0)", moment(2024, 2, 29, 12, 30, 15)),
        ("DATE", "DT_TO_DATE(DT#2024-02-29-12:30:00)", moment(2024, 2, 29)),
        ("TOD", "DT_TO_TOD(DT#2024-02-29-12:30:00)", DAY // 48 * 25),
        ("DT", "DT#2024-02-28-23:00:00 + T#2h", moment(2024, 2, 29, 1)),
        ("TIME", "SUB_DT_DT(DT#2024-03-01-00:00:00, DT#2024-02-29-12:00:00)", DAY // 2),
        ("TIME", "D#2024-03-01 - D#2024-02-28", 2 * DAY),
        ("TOD", "TOD#23:30:00 + T#1h", DAY // 48),
        ("TIME", "MUL_TIME(T#1s, 2.5)", 2_500_000_000),
        ("DATE", "CONCAT_DATE(2024, 2, 29)", moment(2024, 2, 29)),
    ],
)
def test_dates_and_times(type_: str, expression: str, expected: int) -> None:
    assert value(type_, expression) == expected


@pytest.mark.parametrize(
    ("type_", "expression", "expected"),
    [
        ("INT", "ROUND(2.5)", 2),
        ("INT", "CEIL(2.1)", 3),
        ("INT", "FLOOR(-2.1)", -3),
        ("REAL", "SQR(3.0)", 9.0),
        ("REAL", "NORM_X(MIN := 0, VALUE := 25, MAX := 100)", 0.25),
        ("INT", "SCALE_X(MIN := 0, VALUE := 0.25, MAX := 100)", 25),
        ("WORD", "SWAP(W#16#1234)", 0x3412),
        ("Time", "T_ADD(IN1 := T#1s, IN2 := T#2s)", 3_000_000_000),
        ("Time", "T_SUB(T#1s, T#2s)", -1_000_000_000),
        ("REAL", "DWORD_TO_REAL(16#3F800000)", 1.0),
        ("BOOL", "IS_VALID(1.0)", True),
        ("REAL", "FRAC(2.75)", 0.75),
        ("INT", "CHAR_TO_INT('A')", 65),
        ("CHAR", "INT_TO_CHAR(66)", "B"),
        ("CHAR", "WORD_TO_CHAR(W#16#4143)", "C"),
    ],
)
def test_functions_of_s7(type_: str, expression: str, expected: object) -> None:
    assert value(type_, expression, dialect=Dialect.SCL) == expected


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        ("MUX(5, 1, 2)", "MUX has no input 5"),
        ("SHL(w, -1)", "a shift by -1"),
        ("LIMIT(1, 2)", "LIMIT is called without MX"),
        ("MAX(1, X := 2)", "MAX has no input X"),
        ("WORD_BCD_TO_INT(16#FF)", "16#FF is no number in BCD"),
        ("CONCAT_DATE(2024, 2, 30)", "no date"),
        ("REAL_TO_INT(LREAL#1e308 * LREAL#10.0)", "has no integer|not a|out of range"),
        ("BLINK(1)", "BLINK is not known"),
    ],
)
def test_wrong_calls_are_errors(expression: str, message: str) -> None:
    text = (
        f"PROGRAM Main\nVAR w : WORD; x : DINT; d : DATE; END_VAR\nx := {expression}; d := {expression};\nEND_PROGRAM"
    )
    with pytest.raises(SimulationError, match=message):
        Controller(project_of(text)).instance("Main").scan()


def test_all_functions_of_the_table_of_standard_blocks_are_known() -> None:
    samples = {
        "BOOL": "TRUE", "ANY_BIT": "w", "ANY_INT": "i", "ANY_NUM": "i", "ANY_REAL": "r", "ANY_STRING": "s",
        "ANY_CHARS": "s", "ANY_ELEMENTARY": "i", "ANY": "i", "TIME": "T#1s", "LTIME": "LTIME#1s",
        "DATE": "D#2024-01-02", "LDATE": "LD#2024-01-02", "TOD": "TOD#12:00:00", "LTOD": "LTOD#12:00:00",
        "DT": "DT#2024-01-02-00:00:00", "LDT": "LDT#2024-01-02-00:00:00",
    }  # fmt: skip
    unknown = []
    for block in standard_blocks():
        if block.kind is BlockKind.FUNCTION_BLOCK:
            continue
        arguments = ", ".join(f"{pin.name} := {samples[pin.type]}" for pin in block.inputs)
        text = "PROGRAM Main\nVAR w : WORD := 1; i : INT := 1; r : REAL := 0.5; s : STRING := 'a'; END_VAR\n"
        controller = Controller(project_of(f"{text}Result := {block.name}({arguments});\nEND_PROGRAM"))
        controller.instance("Main").scan()
        unknown += [str(problem) for problem in controller.problems]
    assert not unknown


@settings(deadline=None, max_examples=examples(40))
@given(s.text("abc", max_size=8), s.text("abc", max_size=3), s.integers(0, 9), s.integers(1, 9))
def test_strings_are_taken_apart_and_put_together(text: str, part: str, count: int, position: int) -> None:
    instance = STRINGS
    for name, given_ in (("t", text), ("p", part), ("n", count), ("at", position)):
        instance[name] = given_
    instance.scan()
    assert instance["whole"] == text
    assert instance["deleted"] == text[: position - 1] + text[position - 1 + count :]
    assert instance["replaced"] == instance["deleted"][: position - 1] + part + instance["deleted"][position - 1 :]
    assert instance["middle"] == text[position - 1 : position - 1 + count]


STRINGS = main(
    "t, p, whole, deleted, replaced, middle : STRING; n, at : INT := 1;",
    """whole := CONCAT(LEFT(t, n), MID(t, 20, n + 1)); deleted := DELETE(t, n, at); middle := MID(t, n, at);
    replaced := REPLACE(t, p, n, at);""",
)
