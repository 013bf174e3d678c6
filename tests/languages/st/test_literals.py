"""Types and values of literals, and literals of values."""

from __future__ import annotations

from contextlib import suppress
from datetime import date
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from plcopen_sfc.languages.st import Parsed, parse_expression, parse_statements, walk
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import (
    INTEGER_RANGES,
    SECOND,
    LiteralError,
    LiteralKind,
    LiteralValue,
    date_and_time_literal,
    literal_value,
    real_literal,
    string_literal,
    time_literal,
    time_of_day_literal,
    write_literal,
)
from plcopen_sfc.model.dialect import Dialect
from tests.corpus import require_corpus
from tests.languages.st_corpus import TextKind, corpus_texts, distinct

MS = SECOND // 1000
HOUR = 3600 * SECOND
SCL = Dialect.SCL


@pytest.mark.parametrize(
    ("text", "value", "type"),
    [
        ("1_000", 1000, ""),
        ("16#FF_ff", 0xFFFF, ""),
        ("2#1010_1010", 0b10101010, ""),
        ("8#77", 0o77, ""),
        ("007", 7, ""),
        ("INT#16#FF", 255, "INT"),
        ("INT#16#FFFF", -1, "INT"),  # S7 and CODESYS: the bits of the type
        ("dint#-5", -5, "DINT"),
        ("WORD#16#00ff", 255, "WORD"),
        ("W#16#FF", 255, "WORD"),
        ("DW#16#FFFF_FFFF", 0xFFFFFFFF, "DWORD"),
        ("B#16#0", 0, "BYTE"),
        ("L#5", 5, "DINT"),
        ("C#100", 100, "COUNTER"),
    ],
)
def test_integers(text: str, value: int, type: str) -> None:
    assert literal_value(text) == LiteralValue(LiteralKind.INTEGER, value, type)


@pytest.mark.parametrize("dialect", list(Dialect))
@pytest.mark.parametrize("text", ["1E-3", "2e+4", "5E2", "1.5E-3", "1_0E-1"])
def test_a_number_with_an_exponent_is_one_literal(text: str, dialect: Dialect) -> None:
    parsed = parse_expression(f"x + {text}", dialect)
    assert not parsed.problems
    assert isinstance(parsed.tree, n.Operation)
    assert [each.text for each in walk(parsed.tree) if isinstance(each, n.Literal)] == [text]


@pytest.mark.parametrize(
    ("text", "kind", "value", "type"),
    [
        ("TRUE", LiteralKind.BOOL, True, ""),
        ("false", LiteralKind.BOOL, False, ""),
        ("BOOL#1", LiteralKind.BOOL, True, "BOOL"),
        ("BOOL#FALSE", LiteralKind.BOOL, False, "BOOL"),
        ("1.5", LiteralKind.REAL, 1.5, ""),
        ("1e5", LiteralKind.REAL, 1e5, ""),
        ("1_0.2_5E-3", LiteralKind.REAL, 10.25e-3, ""),
        ("REAL#-1.0", LiteralKind.REAL, -1.0, "REAL"),
        ("LREAL#5", LiteralKind.REAL, 5.0, "LREAL"),
        ("NULL", LiteralKind.NULL, "NULL", ""),
        ("Color#red", LiteralKind.ENUMERATED, "red", "Color"),
        ("D#2024-02-29", LiteralKind.DATE, date(2024, 2, 29), "DATE"),
        ("LD#2024-1-3", LiteralKind.DATE, date(2024, 1, 3), "LDATE"),
        ("TOD#12:30:00.5", LiteralKind.TIME_OF_DAY, 12 * HOUR + 30 * 60 * SECOND + 500 * MS, "TOD"),
        ("TIME_OF_DAY#0:0:1", LiteralKind.TIME_OF_DAY, SECOND, "TOD"),
        ("LTOD#00:00:00.000000001", LiteralKind.TIME_OF_DAY, 1, "LTOD"),
        ("DT#1970-01-02-00:00:01", LiteralKind.DATE_AND_TIME, 86401 * SECOND, "DT"),
        ("DATE_AND_TIME#1970-01-01-00:00", LiteralKind.DATE_AND_TIME, 0, "DT"),
        ("DTL#1969-12-31-23:59:59", LiteralKind.DATE_AND_TIME, -SECOND, "DTL"),
        ("P#DB1.DBX0.0 BYTE 10", LiteralKind.POINTER, "P#DB1.DBX0.0 BYTE 10", "POINTER"),
    ],
)
def test_other_values(text: str, kind: LiteralKind, value: Any, type: str) -> None:
    assert literal_value(text) == LiteralValue(kind, value, type)


@pytest.mark.parametrize(
    ("text", "nanoseconds", "type"),
    [
        ("T#1d2h3m4s5ms", (((24 + 2) * 60 + 3) * 60 + 4) * SECOND + 5 * MS, "TIME"),
        ("t#1d_2h_3m_4s_5ms", (((24 + 2) * 60 + 3) * 60 + 4) * SECOND + 5 * MS, "TIME"),
        ("TIME#1.5s", 1500 * MS, "TIME"),
        ("T#-2.5H", -(2 * HOUR + HOUR // 2), "TIME"),
        ("T#0.1s", 100 * MS, "TIME"),  # exactly: no float
        ("T#90m", 5400 * SECOND, "TIME"),
        ("LTIME#1us5ns", 1005, "LTIME"),
        ("LT#1ns", 1, "LTIME"),
        ("S5T#10s", 10 * SECOND, "S5TIME"),
        ("S5TIME#2h46m30s", 9990 * SECOND, "S5TIME"),
        ("S5T#9s995ms", 9990 * MS, "S5TIME"),  # three digits of 10 ms, rounded down
        ("S5T#10s50ms", 10 * SECOND, "S5TIME"),
        ("S5T#1h5s", 3600 * SECOND, "S5TIME"),
        ("T#1_000ms", SECOND, "TIME"),
    ],
)
def test_durations(text: str, nanoseconds: int, type: str) -> None:
    assert literal_value(text) == LiteralValue(LiteralKind.DURATION, nanoseconds, type)


@pytest.mark.parametrize(
    ("text", "value", "type"),
    [
        ("''", "", "STRING"),
        ("'a$'b$$c'", "a'b$c", "STRING"),
        ("'$N$R$T$P$L$41$c4'", "\n\r\t\f\nAÄ", "STRING"),
        ("'it \"is\"'", 'it "is"', "STRING"),
        ('"wide $00C4$""', 'wide Ä"', "WSTRING"),
        ("STRING#'x'", "x", "STRING"),
        ("WSTRING#'$0041'", "A", "WSTRING"),
        ("CHAR#'a'", "a", "CHAR"),
        ("WCHAR#'$20AC'", "€", "WCHAR"),
    ],
)
def test_strings(text: str, value: str, type: str) -> None:
    assert literal_value(text) == LiteralValue(LiteralKind.STRING, value, type)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("USINT#300", "does not fit USINT: it goes from 0 to 255"),
        ("INT#16#1FFFF", "does not fit INT"),
        ("BYTE#-1", "does not fit BYTE"),
        ("2#102", "digits that base 2"),
        ("7#1", "no integer"),
        ("abc", "digits that base 10"),
        ("BOOL#2", "no BOOL"),
        ("REAL#16#1", "no real"),
        ("T#", "no unit"),
        ("T#5", "no duration"),
        ("T#5s2h", "greater to smaller"),
        ("T#1.5h2s", "fraction before"),
        ("T#0.1ns", "finer than a nanosecond"),
        ("S5T#3h", "2h46m30s"),
        ("D#2023-02-29", "no date"),
        ("TOD#24:00:00", "no time of day"),
        ("DT#2023-01-01", "no date"),
        ("'open", "no string"),
        ("'a'b'", "quote inside"),
        ("'$Q'", "starts nothing"),
        ("'$", "no string"),
        ("CHAR#'ab'", "2 characters"),
        ("INT#'x'", "no literal"),
    ],
)
def test_what_is_no_literal_says_why(text: str, reason: str) -> None:
    with pytest.raises(LiteralError, match=reason):
        literal_value(text)


def test_double_quotes_are_names_in_scl() -> None:
    with pytest.raises(LiteralError, match="name in SCL"):
        literal_value('"Motor"', SCL)


@pytest.mark.parametrize(
    ("nanoseconds", "dialect", "type", "text"),
    [
        (0, Dialect.IEC, "TIME", "T#0s"),
        (93784 * SECOND + 5 * MS, Dialect.CODESYS, "TIME", "T#1d2h3m4s5ms"),
        (-1500 * MS, SCL, "TIME", "T#-1s500ms"),
        (1001, Dialect.IEC, "TIME", "T#1us1ns"),
        (1001, Dialect.TWINCAT, "LTIME", "LTIME#1us1ns"),
        (9990 * SECOND, SCL, "S5TIME", "S5T#2h46m30s"),
        (0, SCL, "S5TIME", "S5T#0s"),
    ],
)
def test_durations_are_written(nanoseconds: int, dialect: Dialect, type: str, text: str) -> None:
    assert time_literal(nanoseconds, dialect, type) == text


@pytest.mark.parametrize(
    ("nanoseconds", "dialect", "type"),
    [
        (1, SCL, "TIME"),
        (1, Dialect.CODESYS, "TIME"),
        (-MS, Dialect.CODESYS, "TIME"),
        (50 * 24 * HOUR, Dialect.TWINCAT, "TIME"),
        (25 * 24 * HOUR, SCL, "TIME"),
        (5 * MS, SCL, "S5TIME"),
        (10_010 * MS, SCL, "S5TIME"),  # 1001 times the base of 10 ms, no multiple of 100 ms
        (-10 * MS, SCL, "S5TIME"),
        (SECOND, Dialect.IEC, "S5TIME"),
        (SECOND, Dialect.IEC, "INT"),
    ],
)
def test_durations_that_a_type_cannot_say(nanoseconds: int, dialect: Dialect, type: str) -> None:
    with pytest.raises(LiteralError):
        time_literal(nanoseconds, dialect, type)


def test_other_values_that_have_no_literal() -> None:
    for value in (float("nan"), float("inf")):
        with pytest.raises(LiteralError):
            real_literal(value)
    with pytest.raises(LiteralError, match="fits no STRING"):
        string_literal("€")
    with pytest.raises(LiteralError, match="no literals of the type CHAR"):
        write_literal(LiteralValue(LiteralKind.STRING, "a", "CHAR"), Dialect.CODESYS)
    with pytest.raises(LiteralError, match="does not fit INT"):
        write_literal(LiteralValue(LiteralKind.INTEGER, 40000, "INT"))
    with pytest.raises(LiteralError, match="is no value of a date"):
        write_literal(LiteralValue(LiteralKind.DATE, 5, "DATE"))
    with pytest.raises(LiteralError, match="no time of a day"):
        time_of_day_literal(24 * HOUR)
    with pytest.raises(LiteralError, match="four digits"):
        date_and_time_literal(10**25)


# -- there and back ---------------------------------------------------------------------------------------------------

_TIME = {Dialect.IEC: (-(2**70), 2**70), SCL: (-(2**31), 2**31 - 1)}


def _durations(dialect: Dialect) -> st.SearchStrategy[LiteralValue]:
    unsigned = dialect in (Dialect.CODESYS, Dialect.TWINCAT)
    long = st.integers(0 if unsigned else -(2**63), 2**64 - 1 if unsigned else 2**63 - 1).map(lambda ns: (ns, "LTIME"))
    least, greatest = _TIME.get(dialect, (0, 2**32 - 1))
    found = long | st.integers(least, greatest).map(lambda ms: (ms * MS, "TIME"))
    if dialect is SCL:
        steps = st.tuples(st.integers(0, 999), st.sampled_from([10, 100, 1000, 10000]))
        found |= steps.map(lambda step: (step[0] * step[1] * MS, "S5TIME"))
    return found.map(lambda pair: LiteralValue(LiteralKind.DURATION, *pair))


def _strings(dialect: Dialect) -> st.SearchStrategy[LiteralValue]:
    narrow = st.text(st.characters(max_codepoint=0xFF), max_size=20)
    wide = st.text(st.characters(max_codepoint=0xFFFF, exclude_categories=["Cs"]), max_size=20)
    found = narrow.map(lambda text: (text, "STRING")) | wide.map(lambda text: (text, "WSTRING"))
    if dialect not in (Dialect.CODESYS, Dialect.TWINCAT):
        found |= st.characters(max_codepoint=0xFF).map(lambda text: (text, "CHAR"))
    return found.map(lambda pair: LiteralValue(LiteralKind.STRING, *pair))


def _integers(type: str) -> st.SearchStrategy[LiteralValue]:
    return st.integers(*INTEGER_RANGES[type]).map(lambda value: LiteralValue(LiteralKind.INTEGER, value, type))


def _values(dialect: Dialect) -> st.SearchStrategy[LiteralValue]:
    days = st.dates().map(lambda day: LiteralValue(LiteralKind.DATE, day, "DATE"))
    clocks = st.integers(0, 24 * HOUR - 1).map(lambda ns: LiteralValue(LiteralKind.TIME_OF_DAY, ns, "LTOD"))
    moments = st.integers(-(2**60), 2**62).map(lambda ns: LiteralValue(LiteralKind.DATE_AND_TIME, ns, "LDT"))
    reals = st.floats(allow_nan=False, allow_infinity=False).map(lambda x: LiteralValue(LiteralKind.REAL, x, "LREAL"))
    bits = st.booleans().map(lambda bit: LiteralValue(LiteralKind.BOOL, bit))
    integers = st.sampled_from(sorted(INTEGER_RANGES)).flatmap(_integers)
    return st.one_of(days, clocks, moments, reals, bits, integers, _durations(dialect), _strings(dialect))


@given(st.data(), st.sampled_from(Dialect))
def test_written_values_are_read_back_as_one_literal(data: st.DataObject, dialect: Dialect) -> None:
    value = data.draw(_values(dialect))
    text = write_literal(value, dialect)
    assert literal_value(text, dialect) == value
    parsed = parse_expression(text, dialect)
    assert parsed.problems == ()
    sign = value.kind is LiteralKind.REAL and not value.type
    assert sign or parsed.tree == n.Literal(text)


@given(st.text(max_size=12) | st.from_regex(r"(INT|T|D|TOD|DT|CHAR|S5T)#[-0-9a-z_:.'$]{0,12}", fullmatch=True))
def test_any_text_has_a_value_or_an_error(text: str) -> None:
    for dialect in Dialect:
        with suppress(LiteralError):
            assert literal_value(text, dialect).type == literal_value(f" {text} ", dialect).type


@pytest.mark.corpus
@pytest.mark.slow
def test_every_literal_of_the_corpus_has_a_value() -> None:
    require_corpus()
    unknown = set()
    count = 0
    for each in distinct(text for text in corpus_texts() if text.kind is not TextKind.DECLARATIONS):
        parse = parse_expression if each.kind is TextKind.EXPRESSION else parse_statements
        parsed: Parsed[Any] = parse(each.text, each.dialect)
        for node in walk(parsed.tree):
            if isinstance(node, n.Literal):
                count += 1
                try:
                    literal_value(node, each.dialect)
                except LiteralError as error:
                    unknown.add(f"{each}: {error}")
    assert count > 1000
    assert not unknown
