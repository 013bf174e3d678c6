"""Conversions of values, dates, times and texts that mean something else in the other tool."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.networks import draw_fbd
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.programs import Controller

WHOLE = ["SINT", "USINT", "INT", "UINT", "DINT", "UDINT", "BYTE", "WORD", "DWORD"]


def block(variables: str, body: str, tool: str = "codesys", more: str = "") -> sfc.Project:
    text = f"{more}\nFUNCTION_BLOCK Main\n{variables}\n{body}\nEND_FUNCTION_BLOCK"
    project = sfc.loads(text.encode(), format="iec-text")
    if tool == "scl":
        return sfc.loads(sfc.dumps(project, format="scl", partial=True), format="scl")
    project.dialect = Dialect.CODESYS
    return project


def losses(project: sfc.Project, target: str, flavour: str = "") -> list[tuple[Outcome, str]]:
    report = sfc.convert(project, target, flavour=flavour, partial=True).report
    return [(item.outcome, item.why) for item in report.losses]


@pytest.mark.slow
@pytest.mark.parametrize("call", ["REAL_TO_{}(r)", "TO_{}(r)", "LREAL_TO_{}(p)", "TO_{}(p)", "TO_{}(r * 2.0)"])
@pytest.mark.parametrize("whole", WHOLE)
@pytest.mark.parametrize(("target", "flavour"), [("scl", ""), ("simaticml", ""), ("iec-text", "matiec")])
def test_every_conversion_that_rounds_is_approximated(target: str, flavour: str, whole: str, call: str) -> None:
    variables = f"VAR_INPUT r : REAL; p : LREAL; END_VAR VAR_OUTPUT n : {whole}; END_VAR"
    found = losses(block(variables, f"n := {call.format(whole)};"), target, flavour)
    rounded = [outcome for outcome, why in found if "rounds halves away from zero" in why]
    assert rounded == [Outcome.APPROXIMATED]
    assert len(found) == 1 or (flavour and "*" in call)  # matiec does not know the type of an operation


@pytest.mark.parametrize("target", ["codesys", "twincat"])
def test_a_condition_of_iec_that_rounds_is_approximated_in_codesys(target: str) -> None:
    text = """FUNCTION_BLOCK Main
        VAR_INPUT r : REAL; END_VAR VAR_OUTPUT q, p : BOOL; END_VAR
        INITIAL_STEP S1: END_STEP
        STEP S2: q(N); END_STEP
        TRANSITION FROM S1 TO S2 := REAL_TO_INT(r) = 2; END_TRANSITION
        TRANSITION FROM S2 TO S1 := INT_TO_REAL(2) > r; END_TRANSITION
        END_FUNCTION_BLOCK"""
    report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target, partial=True, limit=0).report
    rounded = [item for item in report.losses if "rounds halves away from zero" in item.why]
    assert [(item.outcome, item.path) for item in rounded] == [(Outcome.APPROXIMATED, "POU Main / transition S1 -> S2")]


@pytest.mark.parametrize(("dialect", "target"), [(Dialect.IEC, "codesys"), (Dialect.CODESYS, "plcopen-2.01")])
@pytest.mark.parametrize(("call", "told"), [("REAL_TO_INT(r)", True), ("LREAL_TO_DINT(r)", True), ("TRUNC(r)", False)])
def test_a_box_that_rounds_is_approximated(dialect: Dialect, target: str, call: str, told: bool) -> None:
    drawn = draw_fbd(parse_statements(f"n := {call};").tree.statements).body
    project = block("VAR_INPUT r : LREAL; END_VAR VAR_OUTPUT n : DINT; END_VAR", "n := 0;")
    project.dialect, project.pous[0].bodies = dialect, [drawn]
    found = [outcome for outcome, why in losses(project, target) if "rounds halves away from zero" in why]
    assert found == [Outcome.APPROXIMATED] * told


def test_a_conversion_to_the_same_type_is_the_value() -> None:
    data, report = sfc.convert(block("VAR_INPUT i : INT; END_VAR VAR n : INT; END_VAR", "n := TO_INT(i);"), "scl")
    assert "#n := (#i);" in data.decode()
    assert not report.losses


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_a_real_number_that_s7_takes_for_an_integer_is_converted(target: str) -> None:
    project = block("VAR_INPUT r : REAL; END_VAR VAR_OUTPUT i : INT; END_VAR", "i := r;", "scl")
    data, report = sfc.convert(project, target)
    assert "i := REAL_TO_INT(r);" in data.decode()
    assert len(report.losses) == (target == "codesys")


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_the_eno_of_a_block_is_not_executed_elsewhere(target: str) -> None:
    found = losses(block("VAR_OUTPUT q : BOOL; END_VAR", "q := ENO;", "scl"), target)
    assert [outcome for outcome, why in found if "ENO" in why] == [Outcome.NOT_EXECUTED]


DATES = [
    "n := DATE_TO_DINT(d);",
    "n := DWORD_TO_DINT(DT_TO_DWORD(t));",
    "q := d = D#1970-01-01;",
    "q := t > DT#1985-05-05-00:00:00;",
    "q := t - DT#2019-12-31-00:00:00 > T#1h;",
    "q := d - D#2019-12-31 > T#1h;",
]
DECLARED = "VAR_INPUT d : DATE := D#2000-01-01; t : DT := DT#2000-01-01-00:00:00; END_VAR"
OUTPUTS = "VAR_OUTPUT n : DINT; q : BOOL; END_VAR"


@pytest.mark.parametrize("target", ["scl", "simaticml"])
@pytest.mark.parametrize("body", DATES)
def test_what_s7_does_not_do_with_dates_is_not_executed(body: str, target: str) -> None:
    found = losses(block(f"{DECLARED} {OUTPUTS}", body), target)
    assert [outcome for outcome, _ in found] == [Outcome.NOT_EXECUTED]


@pytest.mark.parametrize("body", ["#n := DATE_TO_DINT(#d);", "#n := DATE_TO_INT(#d);"])
def test_days_of_s7_are_no_seconds(body: str) -> None:
    project = block(f"{DECLARED} {OUTPUTS}", "n := 0;", "scl")
    project.pous[0].bodies[0].text = body  # type: ignore[union-attr]  # it is structured text
    assert [outcome for outcome, _ in losses(project, "codesys")] == [Outcome.NOT_EXECUTED]


def test_dates_of_s7_start_in_1990_elsewhere() -> None:
    more = "TYPE Part : STRUCT made : DATE; END_STRUCT; END_TYPE"
    project = block("VAR d : DATE; t : DT; p : Part; END_VAR VAR_OUTPUT q : BOOL; END_VAR", "q := TRUE;", "scl", more)
    controller = Controller(project)
    starts = controller.instance("Main")
    data, report = sfc.convert(project, "codesys")
    assert not report.losses
    instance = Controller(sfc.loads(data, as_tool=True)).instance("Main")
    for name in ("d", "t", "p.made"):
        assert instance[name] == starts[name] == 7305 * 86_400 * 10**9


@pytest.mark.parametrize("type_", ["DATE", "DT"])
@pytest.mark.parametrize("target", ["scl", "simaticml"])
def test_dates_of_codesys_start_later_in_s7(type_: str, target: str) -> None:
    found = losses(block(f"VAR d : {type_}; END_VAR VAR_OUTPUT q : BOOL; END_VAR", "q := TRUE;"), target)
    assert [outcome for outcome, why in found if "starts as" in why and "in S7" in why] == [Outcome.APPROXIMATED]
    assert len(found) == 1


@pytest.mark.parametrize("target", ["scl", "simaticml"])
def test_a_text_that_is_too_long_for_its_variable_is_cut_off(target: str) -> None:
    data, report = sfc.convert(block("VAR s : STRING(5) := 'abcdefgh'; END_VAR", "s := s;"), target)
    assert b"'abcde'" in data
    assert not report.losses


COUNTER = """FUNCTION_BLOCK Main
VAR_INPUT up, down : BOOL; END_VAR
VAR_OUTPUT count : DINT; END_VAR
VAR c : CTUD; END_VAR
c(CU := up, CD := down, PV := 3); count := c.CV;
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(
    ("source", "target", "flavour"),
    [
        ("iec-text", "codesys", ""),
        ("iec-text", "codesys23", ""),
        ("iec-text", "plcopen", ""),
        ("iec-text", "simaticml", ""),
        ("simaticml", "codesys", ""),
        ("simaticml", "plcopen", ""),
        ("codesys", "plcopen", ""),
        ("codesys", "iec-text", "matiec"),
        ("codesys", "simaticml", ""),
        ("codesys", "codesys23", ""),
    ],
)
def test_a_counter_that_stops_at_zero_is_reported(source: str, target: str, flavour: str) -> None:
    project = sfc.loads(COUNTER.encode(), format="iec-text")
    if source != "iec-text":
        project = sfc.loads(sfc.convert(project, source, partial=True).data, format=source, as_tool=True)
    data, report = sfc.convert(project, target, flavour=flavour)
    counts = [
        list(
            sfc.simulate(each, pou="Main", scans=4, inputs=lambda scan, _: {"down": scan == 1, "up": scan == 3})[
                "count"
            ]
        )
        for each in (project, sfc.loads(data, format=target, as_tool=True))
    ]
    assert [item.what for item in report.losses] == ["counter"] * (counts[0] != counts[1])


@pytest.mark.parametrize(("target", "told"), [("codesys", []), ("plcopen", ["counter"]), ("simaticml", [])])
@pytest.mark.parametrize("counter", ["CTD_UINT", "CTUD_UINT"])
def test_a_counter_of_s7_without_a_sign_is_reported_where_it_gets_one(
    counter: str, target: str, told: list[str]
) -> None:
    text = COUNTER.replace("CTUD", counter).replace("c.CV", "UINT_TO_DINT(c.CV)")
    text = text.replace("CU := up, ", "") if counter == "CTD_UINT" else text
    given = sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="simaticml")
    assert [item.what for item in sfc.convert(sfc.loads(given), target).report.losses] == told


RAW = "VAR_INPUT d : DWORD; w : LWORD; r : REAL; l : LREAL; END_VAR VAR_OUTPUT n, m : REAL; k : DWORD; END_VAR"


@pytest.mark.parametrize("target", ["scl", "simaticml", "plcopen-2.01"])
@pytest.mark.parametrize("body", ["n := DWORD_TO_REAL(d);", "n := TO_REAL(d);", "k := REAL_TO_DWORD(r);"])
def test_bit_strings_of_codesys_are_numbers_where_others_take_their_bits(body: str, target: str) -> None:
    project = block(RAW, body)
    data, report = sfc.convert(project, target)
    assert {item.outcome for item in report.losses} <= {Outcome.APPROXIMATED}  # halves are rounded otherwise
    values = []
    for each in (project, sfc.loads(data, as_tool=True)):
        instance = Controller(each).instance("Main")
        instance["d"] = 1024
        instance["r"] = 2048.0
        instance.scan()
        values.append((instance["n"], instance["k"]))
    assert values[0] == values[1]
    assert values[0] in ((1024.0, 0), (0.0, 2048))


@pytest.mark.parametrize("body", ["n := DWORD_TO_REAL(d);", "k := REAL_TO_DWORD(r);", "l := LWORD_TO_LREAL(w);"])
@pytest.mark.parametrize("tool", ["scl", "iec"])
def test_bits_of_others_are_no_numbers_in_codesys(tool: str, body: str) -> None:
    project = block(RAW, body, tool)
    project.dialect = Dialect.IEC if tool == "iec" else project.dialect
    target, flavour = ("codesys", "") if tool == "scl" else ("iec-text", "matiec")
    assert Outcome.NOT_EXECUTED in [outcome for outcome, why in losses(project, target, flavour) if "the number" in why]


def test_line_ends_in_strings_have_as_many_characters_in_s7() -> None:
    body = "n := LEN('a$Nb$$N'); q := s = '$n';"
    variables = "VAR_INPUT s : STRING := 'x$N'; END_VAR VAR_OUTPUT n : INT; q : BOOL; END_VAR"
    project = block(variables, body)
    data, _ = sfc.convert(project, "scl", partial=True)
    assert "'a$Lb$$N'" in data.decode()
    back, _ = sfc.convert(sfc.loads(data, format="scl"), "codesys", partial=True)
    assert "'a$Lb$$N'" in back.decode()
    for each in (project, sfc.loads(data, format="scl", as_tool=True), sfc.loads(back, as_tool=True)):
        instance = Controller(each).instance("Main")
        instance.scan()
        assert instance["n"] == 5
    of_s7 = block("VAR_OUTPUT n : INT; END_VAR", "n := 0;", "scl")
    of_s7.pous[0].bodies[0].text = "#n := LEN('a$Nb');"  # type: ignore[union-attr]  # it is structured text
    assert "'a$R$Lb'" in sfc.dumps(of_s7, format="codesys").decode()
    instance = Controller(of_s7).instance("Main")
    instance.scan()
    assert instance["n"] == 4


CHOICES = (
    "FUNCTION Tick : INT VAR_INPUT x : INT; END_VAR VAR_EXTERNAL g : INT; END_VAR g := g + x; Tick := x; END_FUNCTION"
)


@pytest.mark.parametrize("target", ["scl", "simaticml", "plcopen-2.01"])
@pytest.mark.parametrize(
    ("body", "is_told"),
    [
        ("n := SEL(a, Tick(1), Tick(10));", True),
        ("n := SEL(k = 0, 100 / k, 0);", True),
        ("n := MUX(0, Tick(1), k);", True),
        ("n := SEL(a, k + 1, 100 / 7);", False),
        ("n := SEL(a, ABS(k), INT_TO_DINT(3));", False),
    ],
)
def test_arguments_that_only_codesys_leaves_out_are_told(body: str, is_told: bool, target: str) -> None:
    variables = "VAR_INPUT a : BOOL; k : INT; END_VAR VAR_OUTPUT n : DINT; END_VAR"
    project = block(variables, body, more=f"VAR_GLOBAL g : INT; END_VAR {CHOICES}")
    told = [outcome for outcome, why in losses(project, target) if "alone that is taken" in why]
    assert told == [Outcome.APPROXIMATED] * is_told


@pytest.mark.parametrize("target", ["scl", "simaticml", "plcopen-2.01"])
def test_a_selector_beyond_the_inputs_takes_the_last_of_them(target: str) -> None:
    project = block("VAR_INPUT k : INT; END_VAR VAR_OUTPUT n : INT; END_VAR", "n := MUX(k, 10, 20, 30);")
    data, report = sfc.convert(project, target)
    assert not report.losses
    for each in (project, sfc.loads(data, as_tool=True)):
        instance = Controller(each).instance("Main")
        found = []
        for value in (0, 1, 2, 3, 1000):
            instance["k"] = value
            instance.scan()
            found.append(instance["n"])
        assert found == [10, 20, 30, 30, 30]


def test_codesys_evaluates_the_argument_alone_that_is_taken() -> None:
    text = "VAR_INPUT k : INT; END_VAR VAR_OUTPUT n, m : INT; END_VAR"
    project = block(text, "n := SEL(k = 0, 100 / k, 7); m := MUX(k, 1, 100 / k);")
    instance = Controller(project).instance("Main")
    instance.scan()
    assert (instance["n"], instance["m"]) == (7, 1)


@pytest.mark.parametrize(
    ("body", "written"),
    [
        ("r := TIME_TO_REAL(t);", "#r := DINT_TO_REAL(TIME_TO_DINT(#t));"),
        ("t := REAL_TO_TIME(r);", "#t := DINT_TO_TIME(REAL_TO_DINT(#r));"),
        ("s := BOOL_TO_STRING(a);", "#s := SEL(G := #a, IN0 := 'FALSE', IN1 := 'TRUE');"),
        ("s := TIME_TO_STRING(t);", ""),
        ("a := STRING_TO_BOOL(s);", ""),
        ("t := t * 1.5;", ""),
        ("t := t / r;", ""),
    ],
)
@pytest.mark.parametrize("tool", ["iec", "codesys"])
def test_conversions_that_scl_lacks_are_others_or_not_executed(tool: str, body: str, written: str) -> None:
    project = block("VAR_IN_OUT a : BOOL; r : REAL; t : TIME; s : STRING; END_VAR", body)
    project.dialect = Dialect.CODESYS if tool == "codesys" else Dialect.IEC
    data, report = sfc.convert(project, "scl", partial=True)
    assert (written or body.partition("(")[0].rpartition(" ")[2]) in data.decode()
    assert bool(report.with_outcome(Outcome.NOT_EXECUTED)) is not bool(written)


def test_a_number_becomes_a_time_of_whole_milliseconds_in_codesys() -> None:
    project = block("VAR_INPUT r : REAL; END_VAR VAR_OUTPUT t : TIME; END_VAR", "t := REAL_TO_TIME(r);")
    for target in ("plcopen-2.01", "iec-text"):
        flavour = "matiec" if target == "iec-text" else ""
        assert [why for _, why in losses(project, target, flavour) if "keeps the fraction" in why]
    instance = Controller(project).instance("Main")
    for given, milliseconds in ((1.7, 2), (2.5, 3), (0.4, 0)):
        instance["r"] = given
        instance.scan()
        assert instance["t"] == milliseconds * 1_000_000


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01", "codesys23", "iec-text"])
def test_views_of_other_variables_are_not_executed_elsewhere(target: str) -> None:
    text = """FUNCTION_BLOCK "Blk"
VERSION : 0.1
VAR_OUTPUT q : Bool; END_VAR
VAR
  d : DWord;
  b AT d : Array[0..31] of Bool;
END_VAR
BEGIN
#q := #b[24];
END_FUNCTION_BLOCK
"""
    project = sfc.loads(text.encode(), format="scl")
    flavour = "matiec" if target == "iec-text" else ""
    report = sfc.convert(project, target, flavour=flavour, partial=True).report
    assert [item for item in report.with_outcome(Outcome.NOT_EXECUTED) if "`d`" in item.why]
