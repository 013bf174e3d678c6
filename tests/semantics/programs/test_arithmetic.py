"""Numbers: widths, overflow, division, conversions, against arithmetic of our own."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as s

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.model.dialect import Dialect
from tests.semantics.programs.running import main
from tests.sweeps import examples

WIDTHS = {
    "SINT": (8, True),
    "USINT": (8, False),
    "BYTE": (8, False),
    "INT": (16, True),
    "UINT": (16, False),
    "WORD": (16, False),
    "DINT": (32, True),
    "UDINT": (32, False),
    "DWORD": (32, False),
    "LINT": (64, True),
    "ULINT": (64, False),
    "LWORD": (64, False),
}
"""From the narrowest to the widest; of two types the later one is that of their sum."""
ORDER = list(WIDTHS)


def wrap(value: int, type_: str) -> int:
    """Two's complement, by the bytes."""
    bits, signed = WIDTHS[type_]
    return int.from_bytes((value % (1 << bits)).to_bytes(bits // 8, "little"), "little", signed=signed)


def bounds(type_: str) -> tuple[int, int]:
    bits, signed = WIDTHS[type_]
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)


@dataclass(frozen=True)
class Sum:
    """A random expression, evaluated here step by step."""

    text: str
    type: str
    value: int | None  # None: a division by zero


def together(one: str, other: str, dialect: Dialect) -> str:
    """The type that two operands are brought to."""
    (bits, signed), (others, other_signed) = WIDTHS[one], WIDTHS[other]
    bit_string = {"BYTE", "WORD", "DWORD", "LWORD"} & {one, other}
    if dialect is Dialect.SCL and signed != other_signed and not bit_string:
        unsigned, size = (others, bits) if signed else (bits, others)
        width = min(max(2 * unsigned, size), 64)
        return next(type_ for type_ in ORDER if WIDTHS[type_] == (width, True))
    return max(one, other, key=ORDER.index)


def calculated(type_: str, dialect: Dialect) -> str:
    """The type in which a tool calculates."""
    return "DINT" if dialect is Dialect.CODESYS and WIDTHS[type_][0] < 32 else type_


@s.composite
def sums(draw: s.DrawFn, variables: dict[str, tuple[str, int]], dialect: Dialect, depth: int = 4) -> Sum:
    if depth == 0 or draw(s.integers(0, 3)) == 0:
        name = draw(s.sampled_from(sorted(variables)))
        type_, value = variables[name]
        return Sum(name, type_, value)
    operator = draw(s.sampled_from(["+", "-", "*", "/", "MOD", "neg", "AND", "OR", "XOR"]))
    left = draw(sums(variables, dialect, depth - 1))
    if operator == "neg":
        type_ = calculated(left.type, dialect)
        return Sum(f"(-{left.text})", type_, None if left.value is None else wrap(-left.value, type_))
    right = draw(sums(variables, dialect, depth - 1))
    type_ = together(left.type, right.type, dialect)
    if operator not in ("AND", "OR", "XOR"):
        type_ = calculated(type_, dialect)
    text = f"({left.text} {operator} {right.text})"
    if left.value is None or right.value is None:
        return Sum(text, type_, None)
    a, b = wrap(left.value, type_), wrap(right.value, type_)
    if operator in ("/", "MOD"):
        if b == 0:
            return Sum(text, type_, None)
        quotient = int(Fraction(abs(a), abs(b)).__floor__()) * (1 if (a < 0) == (b < 0) else -1)
        result = quotient if operator == "/" else a - quotient * b
    else:
        result = {"+": a + b, "-": a - b, "*": a * b, "AND": a & b, "OR": a | b, "XOR": a ^ b}[operator]
    return Sum(text, type_, wrap(result, type_))


@s.composite
def programs(draw: s.DrawFn, dialect: Dialect) -> tuple[dict[str, tuple[str, int]], Sum, str]:
    variables = {}
    for index in range(4):
        type_ = draw(s.sampled_from(ORDER))
        low, high = bounds(type_)
        edge = s.sampled_from([low, low + 1, high - 1, high, 0, 1, 2, 3, 7])
        variables[f"x{index}"] = (type_, draw(s.integers(low, high) | edge))
    return variables, draw(sums(variables, dialect)), draw(s.sampled_from(ORDER))


@pytest.mark.slow
@pytest.mark.parametrize("dialect", [Dialect.IEC, Dialect.CODESYS, Dialect.SCL])
@settings(deadline=None, max_examples=examples(80))
@given(s.data())
def test_integers_wrap_as_arithmetic_by_hand_says(dialect: Dialect, data: s.DataObject) -> None:
    variables, expected, target = data.draw(programs(dialect))
    declared = " ".join(f"{name} : {type_} := {value};" for name, (type_, value) in variables.items())
    declared += f" result : {target}; smaller : BOOL;"
    body = f"result := {expected.text}; smaller := {expected.text} < x0;"
    if expected.value is None:
        with pytest.raises(SimulationError, match="division by zero"):
            main(declared, body, dialect)
        return
    instance = main(declared, body, dialect)
    assert instance["result"] == wrap(expected.value, target)
    assert instance["smaller"] == (expected.value < variables["x0"][1])


def test_codesys_cuts_off_what_is_assigned_or_converted_only() -> None:
    """The examples of the help of CODESYS, "Operators": overflow in the data type."""
    declared = "w, v, z : WORD; d : DWORD; u : USINT; a, b, c, e, f : BOOL;"
    body = """w := 65535; v := 0; d := w + 1; a := w + 1 = v; b := v - 1 = w; z := w + 1; c := z = v;
    e := TO_WORD(w + 1) = v; f := u - 1 <> 255;"""
    instance = main(declared, body, Dialect.CODESYS)
    assert [instance[name] for name in "dabcef"] == [65536, False, False, True, True, True]


@pytest.mark.parametrize("type_", ORDER)
def test_every_integer_type_wraps_at_its_ends(type_: str) -> None:
    low, high = bounds(type_)
    declared = f"a : {type_} := {high}; b : {type_} := {low}; c : {type_} := {high}; one : {type_} := 1;"
    instance = main(declared, "a := a + 1; b := b - one; c := c * 2;")
    assert (instance["a"], instance["b"], instance["c"]) == (low, high, wrap(2 * high, type_))


def test_division_goes_to_zero_and_mod_has_the_sign_of_the_dividend() -> None:
    instance = main(
        "a : INT := -7; b : INT := 2; q1, q2, q3, m1, m2, m3 : INT;",
        "q1 := a / b; q2 := 7 / -b; q3 := a / -b; m1 := a MOD b; m2 := 7 MOD -b; m3 := a MOD -b;",
    )
    assert [instance[name] for name in ("q1", "q2", "q3", "m1", "m2", "m3")] == [-3, -3, 3, -1, 1, -1]


def test_the_quotient_of_the_least_value_by_minus_one_wraps() -> None:
    assert main("a : INT := -32768; b : INT := -1; q : INT;", "q := a / b;")["q"] == -32768


def as_single(value: float) -> float:
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


@settings(deadline=None, max_examples=examples(40))
@given(s.floats(-1e9, 1e9).map(as_single), s.floats(-1e9, 1e9).map(as_single), s.sampled_from(["+", "-", "*", "/"]))
def test_real_is_rounded_to_single_precision_and_lreal_is_not(a: float, b: float, operator: str) -> None:
    b = b or 1.0
    exact = {"+": a + b, "-": a - b, "*": a * b, "/": a / b}[operator]
    if abs(exact) > 1e38:
        return
    instance = main("x, y, r : REAL := 1.0; p, q, l : LREAL := 1.0;", f"r := x {operator} y; l := p {operator} q;")
    for name, value in (("x", a), ("y", b), ("p", a), ("q", b)):
        instance[name] = value
    instance.scan()
    assert instance["r"] == as_single(exact)
    assert instance["l"] == exact


def test_a_literal_is_rounded_when_a_real_is_compared_with_it() -> None:
    assert main("r : REAL := 0.1; same : BOOL;", "same := r = 0.1;")["same"] is True
    assert main("r : LREAL := 0.1; same : BOOL;", "same := r = 0.1;")["same"] is True


@pytest.mark.parametrize(
    ("value", "iec", "codesys"),
    [("0.5", 0, 1), ("1.5", 2, 2), ("2.5", 2, 3), ("-0.5", 0, -1), ("-2.5", -2, -3), ("2.4999", 2, 2)],
)
def test_reals_become_integers_by_rounding(value: str, iec: int, codesys: int) -> None:
    assert main(f"r : REAL := {value}; i : INT;", "i := REAL_TO_INT(r);")["i"] == iec
    assert main(f"r : REAL := {value}; i : INT;", "i := REAL_TO_INT(r);", Dialect.CODESYS)["i"] == codesys


@settings(deadline=None, max_examples=examples(40))
@given(s.sampled_from(ORDER), s.sampled_from(ORDER), s.data())
def test_conversions_between_integers_keep_the_low_bits(source: str, target: str, data: s.DataObject) -> None:
    value = data.draw(s.integers(*bounds(source)))
    instance = main(f"a : {source} := {value}; b, c : {target};", f"b := {source}_TO_{target}(a); c := TO_{target}(a);")
    assert instance["b"] == instance["c"] == wrap(value, target)


@settings(deadline=None, max_examples=examples(40))
@given(s.sampled_from(["BYTE", "WORD", "DWORD", "LWORD", "INT", "DINT"]), s.integers(0, 70), s.data())
def test_shifts_and_rotations(type_: str, count: int, data: s.DataObject) -> None:
    value = data.draw(s.integers(*bounds(type_)))
    instance = main(
        f"a : {type_} := {value}; l, r, tl, tr : {type_}; n : INT := {count};",
        "l := SHL(a, n); r := SHR(a, n); tl := ROL(a, n); tr := ROR(a, n);",
    )
    bits = WIDTHS[type_][0]
    word = format(value % (1 << bits), f"0{bits}b")
    turn = count % bits
    by_hand = {
        "l": (word + "0" * count)[-bits:],
        "r": ("0" * count + word)[:bits],
        "tl": word[turn:] + word[:turn],
        "tr": word[bits - turn :] + word[: bits - turn],
    }
    assert {name: instance[name] for name in by_hand} == {n: wrap(int(w, 2), type_) for n, w in by_hand.items()}


def test_times_wrap_at_32_bits_in_codesys_and_s7() -> None:
    declared = "a : TIME := T#1ms; b : TIME;"
    assert main(declared, "b := a - T#2ms;")["b"] == -1_000_000
    assert main(declared, "b := a - T#2ms;", Dialect.CODESYS)["b"] == 0xFFFF_FFFF * 1_000_000
    assert (
        main("a : TIME := T#24d20h31m23s647ms; b : TIME;", "b := a + T#1ms;", Dialect.SCL)["b"] == -(2**31) * 1_000_000
    )


def test_times_are_scaled_by_numbers() -> None:
    instance = main(
        "a : TIME := T#10s; b, c, d : TIME; n : INT := 3;", "b := a * n; c := a / n; d := a * 0.25;", Dialect.CODESYS
    )
    assert (instance["b"], instance["c"], instance["d"]) == (30_000_000_000, 3_333_000_000, 2_500_000_000)


def test_power_is_real() -> None:
    instance = main("a : REAL := 2.0; r : REAL; i : INT := 3; l : LREAL;", "r := a ** i; l := i ** 2;")
    assert (instance["r"], instance["l"]) == (8.0, 9.0)


def test_bit_strings_of_reals_in_iec_are_their_bits_and_numbers_in_codesys() -> None:
    declared = "r : REAL := 1.0; d : DWORD;"
    assert main(declared, "d := REAL_TO_DWORD(r);")["d"] == 0x3F80_0000
    assert main(declared, "d := REAL_TO_DWORD(r);", Dialect.CODESYS)["d"] == 1


def test_s7_takes_the_last_bit_for_a_bool_and_others_take_all() -> None:
    declared = "w : WORD := 2; a, b : BOOL;"
    for dialect, found in ((Dialect.IEC, True), (Dialect.CODESYS, True), (Dialect.SCL, False)):
        assert main(declared, "a := WORD_TO_BOOL(w);", dialect)["a"] is found
        assert main(declared, "a := WORD_TO_BOOL(w OR 16#1);", dialect)["a"] is True


def test_shifts_of_numbers_keep_their_sign_in_tools() -> None:
    declared = "n, m : INT := -8; w : WORD := 16#8000;"
    text = "m := SHR(n, 1); w := SHR(w, 1);"
    for dialect, found in ((Dialect.CODESYS, -4), (Dialect.SCL, -4), (Dialect.IEC, 0x7FFC)):
        instance = main(declared, text, dialect)
        assert (instance["m"], instance["w"]) == (found, 0x4000)
    assert main("n, m : INT := -8;", "m := SHR(n, 70);", Dialect.CODESYS)["m"] == -1


def test_subranges_are_checked() -> None:
    instance = main("a : INT (0..10) := 10; b : INT;", "b := a;")
    assert instance["b"] == 10
    with pytest.raises(SimulationError, match=r"11 is outside of the subrange 0\.\.10"):
        main("a : INT (0..10) := 10;", "a := a + 1;")
