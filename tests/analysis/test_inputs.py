"""Inputs, in whatever form a program reads them: a proof tries them, and directed runs drive them."""

from __future__ import annotations

from collections.abc import Mapping
from random import Random

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, equivalent
from plcopen_sfc.errors import ModelError
from plcopen_sfc.model import Project
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value
from plcopen_sfc.semantics.simulation import Simulation
from plcopen_sfc.semantics.subjects import resolve
from tests.sweeps import some_of

OUTPUT = "VAR_OUTPUT q : BOOL; END_VAR"
TYPES = """TYPE Pair : STRUCT x : BOOL; w : WORD; n : INT; a : ARRAY[0..1] OF BOOL; END_STRUCT;
Mode : (Off, Auto, Hand); Small : INT (-5..20); END_TYPE
FUNCTION_BLOCK Reader VAR_INPUT w : WORD; s : ARRAY[0..3] OF BOOL; p : Pair; END_VAR VAR_IN_OUT io : WORD; END_VAR
VAR_OUTPUT o : BOOL; END_VAR END_FUNCTION_BLOCK
"""


def program(declarations: str, body: str, around: str = "") -> Project:
    text = f"{around}\nPROGRAM Main\n{declarations}\n{body}\nEND_PROGRAM\n"
    project = sfc.loads(text.encode(), format="iec-text")
    assert not [each for each in project.diagnostics if str(each.severity) == "error"]
    return project


def compare(declarations: str, one: str, other: str, around: str = "", **options: object) -> Verdict:
    first, second = program(declarations, one, around), program(declarations, other, around)
    return equivalent(first.pou("Main"), second.pou("Main"), "iec", **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("type_", "BYTE WORD DWORD LWORD SINT INT DINT LINT USINT UINT UDINT ULINT".split())
@pytest.mark.parametrize("other", ["w.4", "w.%X4", "FALSE"])
def test_bits_of_numbers_are_inputs(type_: str, other: str) -> None:
    assert compare(f"VAR_INPUT w : {type_}; END_VAR {OUTPUT}", "q := w.3;", f"q := {other};").different


@pytest.mark.parametrize(
    ("declarations", "one", "other"),
    [
        ("VAR_INPUT w : WORD; END_VAR", "q := w.%B1 = 5;", "q := w.%B0 = 5;"),
        ("VAR_INPUT w : WORD; END_VAR", "q := w.13 AND w <> 16#2345;", "q := w.12 AND w <> 16#2345;"),
        ("VAR_INPUT s : Pair; END_VAR", "q := s.w.3;", "q := s.w.4;"),
        ("VAR_EXTERNAL g : WORD; END_VAR", "q := g.3;", "q := g.4;"),
        ("VAR z AT %IW0 : WORD; END_VAR", "q := z.1;", "q := z.2;"),
        ("VAR_INPUT w : WORD; a : BOOL; END_VAR VAR v : WORD; END_VAR", "v := w; q := v.13 AND a;", "q := v.12;"),
        ("VAR_INPUT w : WORD; END_VAR VAR f : Bits; END_VAR", "f(w := w); q := f.o;", "f(w := w); q := w.5;"),
        ("VAR_INPUT w : WORD; END_VAR", "q := Bit(w);", "q := w.6;"),
        ("VAR_IN_OUT w : WORD; END_VAR", "q := w.1;", "q := w.2;"),
        ("VAR_INPUT t : STRING; END_VAR", "q := LEN(t) = 1;", "q := FALSE;"),
    ],
)
def test_bits_of_what_has_its_value_from_an_input(declarations: str, one: str, other: str) -> None:
    around = f"""{TYPES} VAR_GLOBAL g AT %IW7 : WORD; END_VAR
    FUNCTION_BLOCK Bits VAR_INPUT w : WORD; END_VAR VAR_OUTPUT o : BOOL; END_VAR o := w.2; END_FUNCTION_BLOCK
    FUNCTION Bit : BOOL VAR_INPUT w : WORD; END_VAR Bit := w.2; END_FUNCTION"""
    assert compare(f"{declarations} {OUTPUT}", one, other, around).different


def any_of(name: str, last: int) -> str:
    return f"q := FALSE; FOR k := 0 TO {last} DO q := q OR {name}[k]; END_FOR; k := 0;"


@pytest.mark.slow
@pytest.mark.parametrize("section", some_of(["VAR_INPUT", "VAR_IN_OUT", "VAR_EXTERNAL"], 2))
@pytest.mark.parametrize(
    ("one", "other"),
    [
        (any_of("s", 3), any_of("s", 2)),
        ("q := s[1];", "q := s[2];"),
        ("q := s[i];", "q := s[3 - i];"),
        ("q := r[i].x;", "q := r[i].a[1];"),
        ("q := r[1].x;", "q := r[0].x;"),
        ("c := r[1]; q := c.x;", "c := r[0]; q := c.x;"),
        ("q := m[1,1];", "q := m[1,0];"),
        ("q := m[i,j];", "q := m[j,i];"),
        ("q := m[1,i];", "q := m[0,i];"),
    ],
)
def test_elements_of_arrays_are_inputs(section: str, one: str, other: str) -> None:
    declared = "s : ARRAY[0..3] OF BOOL; r : ARRAY[0..3] OF Pair; m : ARRAY[0..1, 0..1] OF BOOL;"
    declarations = f"VAR_INPUT i, j : INT; END_VAR VAR k : INT; c : Pair; END_VAR {section} {declared} END_VAR {OUTPUT}"
    placed = declared.replace("s :", "s AT %IX0.0 :")
    around = f"{TYPES} VAR_GLOBAL {placed} END_VAR" if section == "VAR_EXTERNAL" else TYPES
    assert compare(declarations, one, other, around).different
    assert not compare(declarations, one, one, around).different


def test_what_is_passed_by_reference_is_an_input() -> None:
    around = """FUNCTION_BLOCK Fill VAR_IN_OUT io : BOOL; s : ARRAY[0..1] OF BOOL; END_VAR VAR_OUTPUT o : BOOL; END_VAR
    o := io AND s[1]; END_FUNCTION_BLOCK"""
    declarations = f"VAR_INPUT a : BOOL; s : ARRAY[0..1] OF BOOL; END_VAR VAR f : Fill; END_VAR {OUTPUT}"
    call = "f(io := a, s := s);"
    assert compare(declarations, f"{call} q := f.o;", f"{call} q := FALSE;", around).different
    assert compare(declarations, f"{call} q := f.o;", f"{call} q := a AND s[1];", around).proven
    own = f"VAR_IN_OUT a : BOOL; s : ARRAY[0..1] OF BOOL; END_VAR VAR f : Fill; END_VAR {OUTPUT}"
    assert compare(own, f"{call} q := f.o;", f"{call} q := FALSE;", around).different
    assert compare(own, f"{call} q := f.o;", f"{call} q := s[1] AND a;", around).proven


def test_global_inputs_are_passed_by_reference() -> None:
    around = """VAR_GLOBAL g AT %IX0.0 : BOOL; s AT %IX4.0 : ARRAY[0..1] OF BOOL; END_VAR
    FUNCTION_BLOCK Look VAR_IN_OUT io : BOOL; s : ARRAY[0..1] OF BOOL; END_VAR VAR_OUTPUT o : BOOL; END_VAR
    o := io AND s[1]; END_FUNCTION_BLOCK
    FUNCTION_BLOCK Outer VAR_IN_OUT io : BOOL; s : ARRAY[0..1] OF BOOL; END_VAR VAR_OUTPUT o : BOOL; END_VAR
    VAR f : Look; END_VAR f(io := io, s := s); o := f.o; END_FUNCTION_BLOCK
    FUNCTION_BLOCK Clear VAR_IN_OUT io : BOOL; s : ARRAY[0..1] OF BOOL; END_VAR VAR_OUTPUT o : BOOL; END_VAR
    o := io; io := FALSE; s[0] := FALSE; END_FUNCTION_BLOCK"""
    for block, written in (("Look", False), ("Outer", False), ("Clear", True)):
        external = "VAR_EXTERNAL g : BOOL; s : ARRAY[0..1] OF BOOL; END_VAR"
        declarations = f"{external} VAR f : {block}; END_VAR {OUTPUT}"
        call = "f(io := g, s := s);"
        found = compare(declarations, f"{call} q := f.o;", f"{call} q := FALSE;", around)
        assert found.proven is written
        assert found.different is not written


def test_what_references_lead_to_is_no_proof_of_its_first_value() -> None:
    around = "VAR_GLOBAL g AT %IW0 : INT; END_VAR"
    for section in ("VAR_INPUT g : INT;", "VAR_EXTERNAL g : INT;"):
        declarations = f"{section} END_VAR VAR p : POINTER TO INT; END_VAR {OUTPUT}"
        texts = [f"p := ADR(g); q := {value};" for value in ("p^ > 3", "FALSE")]
        assert not compare(declarations, *texts, around).equal


def test_methods_read_the_inputs_of_their_block() -> None:
    text = """FUNCTION_BLOCK Main VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR
    METHOD Get : BOOL Get := %s; END_METHOD
    q := Get(); END_FUNCTION_BLOCK"""
    one, other = (sfc.loads((text % name).encode(), format="iec-text").pou("Main") for name in "ab")
    assert equivalent(one, other, "iec").different
    assert equivalent(one, one, "iec").proven


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("q := s;", "q := FALSE;"),
        ("q := n > 100; IF a THEN n := 0; END_IF;", "q := FALSE; IF a THEN n := 0; END_IF;"),
        ("IF a THEN n := n + 1; END_IF;", "IF a THEN n := n + 2; END_IF;"),
        ("IF a THEN s := TRUE; END_IF;", "s := s;"),
        ("r[1] := a;", "r[1] := NOT a;"),
        ("r[n] := a;", "r[1] := a;"),
        ("IF a THEN r[1] := TRUE; END_IF;", "r[1] := a;"),
    ],
)
def test_in_outs_are_inputs_and_outputs(one: str, other: str) -> None:
    declared = "VAR_IN_OUT s : BOOL; n : INT; r : ARRAY[0..1] OF BOOL; END_VAR VAR_INPUT a : BOOL; END_VAR"
    verdict = compare(f"{declared} {OUTPUT}", one, other)
    assert verdict.different
    assert not compare(f"{declared} {OUTPUT}", one, one).different
    assert verdict.counterexample is not None
    given = {name for row in verdict.counterexample.inputs for name in row}
    assert given <= {"s", "n", "a", "r[0]", "r[1]"}


def test_in_outs_that_a_program_does_not_write_stay_what_they_are() -> None:
    declared = "VAR_IN_OUT s : BOOL; r : ARRAY[0..99] OF BOOL; p : Pair; END_VAR VAR_INPUT a : BOOL; END_VAR"
    pairs = [
        ("IF a THEN s := TRUE; END_IF;", "s := s OR a;"),
        ("IF a THEN r[7] := FALSE; END_IF;", "r[7] := r[7] AND NOT a;"),
        ("p.x := p.a[1];", "IF p.a[1] THEN p.x := TRUE; ELSE p.x := FALSE; END_IF;"),
    ]
    for one, other in pairs:
        assert compare(f"{declared} {OUTPUT}", one, other, TYPES).proven


def test_blocks_that_extend_others_read_their_inputs() -> None:
    text = """FUNCTION_BLOCK Base VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR
    METHOD Get : BOOL Get := %s; END_METHOD
    q := %s; END_FUNCTION_BLOCK
    FUNCTION_BLOCK Main EXTENDS Base VAR_OUTPUT r : BOOL; END_VAR
    SUPER^(); r := Get(); END_FUNCTION_BLOCK"""
    for one, other in ((("a", "a"), ("b", "a")), (("a", "a"), ("a", "b"))):
        both = [sfc.loads((text % names).encode(), format="iec-text") for names in (one, other)]
        assert equivalent(both[0].pou("Main"), both[1].pou("Main"), "codesys").different
        assert equivalent(both[0].pou("Main"), both[0].pou("Main"), "codesys").proven


def test_inputs_that_a_program_writes_are_given_in_each_scan() -> None:
    declarations = f"VAR_INPUT a, b : BOOL; END_VAR {OUTPUT}"
    assert compare(declarations, "q := a; a := FALSE;", "q := FALSE; a := FALSE;").different
    assert compare(declarations, "q := a; a := FALSE;", "q := a;").proven


def test_arrays_that_nothing_writes_are_frozen_and_can_be_freed() -> None:
    declarations = f"VAR s : ARRAY[0..3] OF BOOL; p : Pair; i : INT; END_VAR {OUTPUT}"
    pairs = [
        ("q := s[1];", "q := s[2];", "s"),
        ("q := p.x;", "q := p.a[0];", "p"),
        (any_of("s", 3)[:-8], "q := s[0];", "s"),
    ]
    for one, other, name in pairs:
        body = declarations.replace("i :", "i, k :")
        assert compare(body, one, other, TYPES).frozen[0] == name
        assert compare(body, one, other, TYPES, free_inputs="all").different
        assert compare(body, one, other, TYPES, free_inputs=[name]).different
    written = compare(declarations, "s[0] := TRUE; q := s[1];", "s[0] := TRUE; q := s[2];", TYPES)
    assert written.frozen == ("s[1]", "s[2]")
    with pytest.raises(ModelError):
        compare(declarations, "q := s[1];", "q := s[2];", TYPES, free_inputs=["other"])


@pytest.mark.slow
def test_what_cannot_be_driven_is_no_proof() -> None:
    declarations = f"VAR_INPUT s : ARRAY[0..9999] OF BOOL; i : INT; END_VAR {OUTPUT}"
    verdict = compare(declarations, "q := s[i];", "q := s[9999 - i];")
    assert not verdict.equal
    assert "inputs that keep their values: s" in str(verdict)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("SHR(w, 8) = 5", "w = 16#500"),
        ("SHR(w, 8) = 5", "SHR(w, 8) = 6"),
        ("SHL(w, 8) = 16#4200", "w = 16#42"),
        ("ROL(w, 4) = 16#1234", "ROL(w, 4) = 16#1235"),
        ("ROR(w, 4) = 16#1234", "FALSE"),
        ("(w AND 16#0FF0) = 16#0AB0", "w = 16#0AB0"),
        ("(INT_TO_WORD(n) AND 16#F0F0) = 16#A0B0", "FALSE"),
        ("(w XOR 16#5A5A) = 0", "FALSE"),
        ("w.%B1 = 5", "w = 16#500"),
        ("w.13 AND w.4 AND NOT w.2", "w.13 AND w.4 AND NOT w.2 AND NOT w.9"),
        ("n MOD 16 = 5", "n MOD 16 = 5 AND n < 100"),
        ("INT_TO_BYTE(n) = 5", "n = 5"),
        ("INT_TO_SINT(n) = -5", "n = -5"),
        ("USINT_TO_INT(INT_TO_USINT(n)) + 1 = 6", "n = 5"),
        ("WORD_TO_INT(w) = -3", "FALSE"),
    ],
)
def test_masks_and_shifts_are_driven_towards_their_constants(one: str, other: str) -> None:
    declarations = f"VAR_INPUT w : WORD; n : INT; END_VAR {OUTPUT}"
    assert compare(declarations, f"q := {one};", f"q := {other};").different
    assert not compare(declarations, f"q := {one};", f"q := {one};").different


# -- random programs

ELEMENTARY = {
    **dict.fromkeys("BYTE WORD DWORD LWORD SINT INT DINT LINT USINT UINT UDINT ULINT".split(), "3"),
    "REAL": "1.5",
    "LREAL": "-2.5",
    "TIME": "T#2s",
    "DATE": "D#2024-02-03",
    "TOD": "TOD#12:00:00",
    "DT": "DT#2024-02-03-12:00:00",
    "STRING": "'A'",
    "Mode": "Auto",
    "Small": "7",
}
BITS = {"BYTE": 8, "WORD": 16, "DWORD": 32, "LWORD": 64, "INT": 16, "UINT": 16, "DINT": 32, "SINT": 8}
SECTIONS = ("VAR_INPUT", "VAR_INPUT", "VAR_IN_OUT", "VAR_EXTERNAL")


def random_reads(chance: Random) -> tuple[str, str, str]:
    """The declaration of inputs, and two conditions that read different ones, or different parts of one."""
    form = chance.choice(("elementary", "bit", "byte", "element", "index", "member", "copied"))
    if form == "elementary":
        type_, value = chance.choice(list(ELEMENTARY.items()))
        return f"u, v : {type_};", f"u = {value}", f"v = {value}"
    if form in ("bit", "byte", "copied"):
        type_ = chance.choice(list(BITS))
        one, other = chance.sample(range(BITS[type_]), 2)
        if form == "byte":
            return "u : DWORD;", f"u.%B{one % 2} = 7", f"u.%B{2 + other % 2} = 7"
        name = "word" if form == "copied" else "u"
        return f"u : {type_};", f"{name}.{one}", f"{name}.{other}"
    if form == "element":
        one, other = chance.sample(range(4), 2)
        return "u : ARRAY[0..3] OF BOOL;", f"u[{one}]", f"u[{other}]"
    if form == "index":
        element, test = chance.choice((("BOOL", ""), ("INT", " > 5"), ("WORD", ".2"), ("Pair", ".a[1]")))
        return f"u : ARRAY[0..3] OF {element}; i : INT;", f"u[LIMIT(0, i, 3)]{test}", f"u[LIMIT(0, i, 2)]{test}"
    one, other = chance.sample(("u.x", "u.w.4", "u.w.5", "u.n < 3", "u.a[0]", "u.a[1]"), 2)
    return "u : Pair;", one, other


def random_pair(chance: Random) -> tuple[str, str]:
    declared, one, other = random_reads(chance)
    section = chance.choice(SECTIONS)
    around = TYPES + (f"VAR_GLOBAL {declared} END_VAR" if section == "VAR_EXTERNAL" else "")
    word = f"word : {declared.partition(': ')[2]}" if "word." in one else ""
    own = f"VAR_INPUT go : BOOL; END_VAR VAR {word} seen : BOOL; END_VAR {OUTPUT}"
    head = f"PROGRAM Main {section} {declared} END_VAR {own}"
    copy = "word := u; " if word else ""
    body = chance.choice(
        (
            "%(copy)s q := %(read)s;",
            "%(copy)s IF go THEN seen := %(read)s; END_IF; q := seen;",
            """INITIAL_STEP S1: Act(N); END_STEP TRANSITION FROM S1 TO S2 := seen; END_TRANSITION
            STEP S2: q(N); END_STEP TRANSITION FROM S2 TO S1 := go; END_TRANSITION
            ACTION Act: %(copy)s seen := %(read)s; END_ACTION""",
        )
    )
    first, second = (f"{around} {head} {body % {'copy': copy, 'read': read}} END_PROGRAM" for read in (one, other))
    return first, second


def some_value(chance: Random, signal: Signal) -> Value:
    match signal.kind:
        case SignalKind.BOOL:
            return chance.random() < 0.5
        case SignalKind.REAL:
            return signal.accept(chance.choice((1.5, -2.5, chance.uniform(-9, 9))))
        case SignalKind.STRING:
            return chance.choice(("", "A", "B"))
        case SignalKind.ENUMERATION:
            return chance.choice(list(signal.names))
    near = [each for each in (0, 1, 2, 3, 4, 7) if signal.least <= each <= signal.greatest]
    return chance.choice((*near, chance.randint(signal.least, signal.greatest)))


def has_witness(pous: tuple[Project, Project], chance: Random) -> bool:
    """True if random inputs tell the two apart."""
    runs = [Simulation(resolve(each.pou("Main")), profile="iec") for each in pous]
    inputs: dict[str, Signal] = {}
    for run in runs:
        inputs |= run.variables.inputs
    for _ in range(300):
        row: Mapping[str, Value] = {name: some_value(chance, signal) for name, signal in inputs.items()}
        for run in runs:
            for name, value in row.items():
                run.set(name, value)
            run.scan()
        if runs[0].values()["q"] != runs[1].values()["q"]:
            return True
    return False


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(60))
def test_a_program_that_reads_another_input_is_not_proven_equal(seed: int) -> None:
    chance = Random(seed)  # noqa: S311  # no secret
    texts = random_pair(chance)
    one, other = (sfc.loads(text.encode(), format="iec-text") for text in texts)
    verdict = equivalent(one.pou("Main"), other.pou("Main"), "iec", runs=50)
    assert not verdict.proven, texts
    if has_witness((one, other), chance):
        assert not verdict.equal, texts
    same = sfc.loads(texts[0].encode(), format="iec-text")
    assert not equivalent(one.pou("Main"), same.pou("Main"), "iec", runs=5).different, texts


def test_flags_that_operate_a_chart_are_inputs_though_they_are_local_variables() -> None:
    text = """PROGRAM Main VAR_INPUT a : BOOL; END_VAR VAR SFCInit, SFCError : BOOL; END_VAR
    INITIAL_STEP S1: END_STEP STEP S2: END_STEP
    TRANSITION FROM S1 TO S2 := a OR SFCError; END_TRANSITION TRANSITION FROM S2 TO S1 := a; END_TRANSITION
    END_PROGRAM"""
    chart = sfc.loads(text.encode(), format="iec-text")
    assert set(equivalent(chart, chart, "codesys", free_inputs="all").inputs) == {"a", "SFCInit"}


@pytest.mark.parametrize(("last", "is_equal"), [("2", True), ("1", False)])
def test_an_enumeration_and_its_numbers_are_the_same_input(last: str, is_equal: bool) -> None:
    text = "PROGRAM Main VAR_INPUT m : {}; END_VAR VAR_OUTPUT q : BOOL; END_VAR q := m = {}; END_PROGRAM"
    types = "TYPE E_Mode : (Off, Slow, Fast); END_TYPE "
    names, numbers = (
        sfc.loads(each.encode(), format="iec-text")
        for each in (types + text.format("E_Mode", "E_Mode.Fast"), text.format("INT", last))
    )
    for sides in ((names, numbers), (numbers, names)):
        verdict = equivalent(*sides, "iec")
        assert (verdict.proven, verdict.different) == (is_equal, not is_equal), str(verdict)


@pytest.mark.parametrize("declared", ["VAR", "VAR_OUTPUT", "VAR_INPUT"])
@pytest.mark.parametrize("written", ["n := n + 1;", "m := m + 1;"])
def test_a_program_that_names_itself_before_its_variables_has_no_others(declared: str, written: str) -> None:
    text = f"""PROGRAM Main
{declared} n : INT; END_VAR
VAR m : INT; q : BOOL; END_VAR
INITIAL_STEP S0: Act(N); END_STEP
STEP S1: q(N); END_STEP
TRANSITION FROM S0 TO S1 := n >= 3; END_TRANSITION
TRANSITION FROM S1 TO S0 := n < 2; END_TRANSITION
ACTION Act: {written} END_ACTION
END_PROGRAM
"""
    plain, named = (
        sfc.loads(each.encode(), format="iec-text") for each in (text, text.replace(":= n >= 3", ":= Main.n >= 3"))
    )
    verdict = sfc.equivalent(plain, named, free_inputs="all")
    assert verdict.equal, verdict
    assert set(verdict.inputs) <= {"n"}


HIDDEN = """FUNCTION_BLOCK B {external} VAR_INPUT c : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR {code}
END_FUNCTION_BLOCK
PROGRAM Main VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT x : BOOL; END_VAR VAR b : B; END_VAR b(c := a); x := a; END_PROGRAM
CONFIGURATION C VAR_GLOBAL {shared} END_VAR RESOURCE R ON PLC END_RESOURCE END_CONFIGURATION"""


@pytest.mark.parametrize(
    ("external", "shared", "one", "other", "told"),
    [
        ("", "y : BOOL;", "q := c;", "q := a;", "b.q"),  # the file does not declare `a` of B
        ("VAR_EXTERNAL a : BOOL; END_VAR", "a : BOOL;", "q := c;", "q := a;", "b.q"),
        ("VAR_EXTERNAL x : BOOL; END_VAR", "x : BOOL;", "x := c;", "x := NOT c;", ".x"),
    ],
)
def test_variables_outside_of_a_program_that_has_their_names_are_others(
    external: str, shared: str, one: str, other: str, told: str
) -> None:
    """The input of the program was taken for both, and of two variables that are written only its own was compared."""
    texts = [HIDDEN.format(external=external, shared=shared, code=code) for code in (one, other)]
    first, second = (sfc.loads(text.encode(), format="iec-text") for text in texts)
    verdict = equivalent(first.pou("Main"), second.pou("Main"), "iec", free_inputs="all")
    assert verdict.counterexample is not None
    assert verdict.counterexample.differences[0].name == told
    assert equivalent(second.pou("Main"), second.pou("Main"), "iec", free_inputs="all").proven
