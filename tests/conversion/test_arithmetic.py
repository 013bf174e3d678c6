"""Calculations of tools that calculate in different types: source and result give the same, or the report differs.

Each table is run: the values of the source under the rules of its tool against those of the result under its own.
"""

from __future__ import annotations

import io
from itertools import product
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.languages.networks import DrawingRules, draw_fbd, draw_ld
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.pages.page_words import german
from plcopen_sfc.refactor.dialect_translation import translate_project
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.programs import Controller

RANGES = {
    "SINT": (-128, 127),
    "USINT": (0, 255),
    "INT": (-32768, 32767),
    "UINT": (0, 65535),
    "DINT": (-(1 << 31), (1 << 31) - 1),
    "BYTE": (0, 255),
    "WORD": (0, 65535),
    "DWORD": (0, (1 << 32) - 1),
}
OPERATORS = ["+", "-", "*", "/", "MOD"]
NARROW = ["SINT", "USINT", "INT", "UINT", "BYTE", "WORD"]
NO_ARITHMETIC = ("BYTE", "WORD", "DWORD")
ROUTES = [
    ("codesys", "scl", ""),
    ("codesys", "simaticml", ""),
    ("codesys", "iec-text", "matiec"),
    ("codesys", "plcopen-2.01", ""),
    ("scl", "codesys", ""),
    ("scl", "simaticml", ""),
]
DIALECTS = {"codesys": Dialect.CODESYS, "scl": Dialect.SCL, "iec": Dialect.IEC}
BODY = """stored := x {op} y;
wide := x {op} y;
is_greater := x {op} y > 100;
is_negative := x {op} y < 0;
half := ({op_of}) / 2;
IF x {op} y = wide THEN count := count + 1; END_IF;
negated := -x > 100;
"""


def source_of(tool: str, type_: str, body: str, more: str = "") -> sfc.Project:
    """A function block in text of a tool."""
    text = f"""FUNCTION_BLOCK Main
VAR_INPUT x, y : {type_}; t, u : TIME; r : REAL; {more} END_VAR
VAR_OUTPUT stored, half : {type_}; wide : DINT; is_greater, is_negative, negated : BOOL; count : INT; END_VAR
{body}
END_FUNCTION_BLOCK
"""
    project = sfc.loads(text.encode(), format="iec-text")
    if tool == "scl":  # its names carry signs
        return sfc.loads(sfc.dumps(project, format="scl", partial=True), format="scl")
    project.dialect = DIALECTS[tool]
    return project


def converted(project: sfc.Project, target: str, flavour: str) -> tuple[sfc.Project, sfc.ConversionReport]:
    data, report = sfc.convert(project, target, flavour=flavour, partial=True)
    return sfc.loads(data, format=target, as_tool=True), report


OUTPUTS = ("stored", "half", "wide", "is_greater", "is_negative", "count", "negated")


def assert_same_outputs(project: sfc.Project, result: sfc.Project, type_: str) -> None:
    """Run both with inputs from the ends of a type and between."""
    instances = []
    for each in (project, result):
        controller = Controller(each)
        instances.append(controller.instance("Main"))
        assert not controller.problems, [str(problem) for problem in controller.problems]
    for x, y in product(edges(type_), repeat=2):
        found = []
        for instance in instances if y != 0 else ():
            instance["x"], instance["y"] = x, y
            instance.scan()
            found.append({name: instance[name] for name in OUTPUTS})
        assert y == 0 or found[0] == found[1], (x, y)


def edges(type_: str) -> list[int]:
    low, high = RANGES[type_]
    return sorted({low, low + 1, max(low, -1), 0, 1, 2, 3, 100, high - 1, high})


@pytest.mark.slow
@pytest.mark.parametrize("operator", OPERATORS)
@pytest.mark.parametrize("type_", NARROW)
@pytest.mark.parametrize(("tool", "target", "flavour"), ROUTES)
def test_calculations_give_the_same_in_the_target(
    tool: str, target: str, flavour: str, type_: str, operator: str
) -> None:
    if type_ in NO_ARITHMETIC and (tool == "scl" or flavour or target.startswith("plcopen")):
        pytest.skip("neither S7 nor matiec nor IEC 61131-3 has arithmetic on bit strings")
    text = BODY.format(op=operator, op_of=f"x {operator} y")
    project = source_of(tool, type_, text)
    result, report = converted(project, target, flavour)
    doubts = [item for item in report.losses if "does not document how it compares" in item.why]
    assert [item for item in report.losses if item not in doubts] == []
    assert not doubts or (tool == "codesys" and RANGES[type_][0] == 0)
    assert_same_outputs(project, result, type_)


@pytest.mark.parametrize(
    ("body", "told"),
    [("IF x + 30000 > 32767 THEN count := 1; END_IF;", ["POU Main"]), ("stored := x + 30000;", [])],
)
def test_text_that_stays_is_told_where_other_tools_may_calculate_with_16_bits(body: str, told: list[str]) -> None:
    data, _ = sfc.convert(source_of("codesys", "INT", body), "codesys")
    _, report = sfc.convert(sfc.loads(data), "iec-text")
    assert [item.path for item in report.losses if "32 bits" in item.why] == told
    assert len(report.losses) == len(told)


@pytest.mark.parametrize(
    "body",
    [
        "is_negative := (x - y) < wide AND wide < (x + y);",
        "wide := INT_TO_DINT(x);",
        "wide := INT_TO_DINT(x) + count;",
    ],
)
def test_arithmetic_that_was_widened_for_tc6_comes_back(body: str) -> None:
    project = source_of("codesys", "INT", body)
    project.header.product = "CODESYS"
    data, _ = sfc.convert(project, "plcopen-2.01", partial=True)
    back, _ = sfc.convert(sfc.loads(data), "codesys", partial=True)
    found = sfc.loads(back).pous[0].body
    assert isinstance(found, StBody)
    assert found.text.strip() == body


def test_conversions_in_files_of_other_tools_stay() -> None:
    body = "is_negative := INT_TO_DINT(x) - INT_TO_DINT(y) < wide;"
    back, _ = sfc.convert(
        sfc.loads(sfc.dumps(source_of("iec", "INT", body), format="plcopen-2.01")), "codesys", partial=True
    )
    assert body.replace("<", "&lt;").encode() in back


@pytest.mark.parametrize("operator", OPERATORS)
def test_what_is_stored_at_once_stays_as_it_is(operator: str) -> None:
    """Sums and products are the same modulo a power of two, and a quotient fits."""
    data, report = sfc.convert(source_of("codesys", "INT", f"stored := x {operator} y;"), "scl")
    assert f"#stored := #x {operator} #y;" in data.decode()
    assert not report.losses


CHART = """FUNCTION_BLOCK Main
VAR_INPUT x, y : {type_}; d : DINT; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S1: q(N); END_STEP
TRANSITION FROM S1 TO S2 := {condition}; END_TRANSITION
STEP S2: END_STEP
TRANSITION FROM S2 TO S1 := TRUE; END_TRANSITION
END_FUNCTION_BLOCK
"""
CONDITIONS = ["x * y > d", "x + 1 > y", "x / y * 100 > d", "-x > y", "(x + y) / 2 > 100", "x * y = 16#FFFF"]


@pytest.mark.slow
@pytest.mark.parametrize(("type_", "condition"), [("INT", each) for each in CONDITIONS] + [("SINT", "x * y > 100")])
def test_transitions_give_the_same_in_boxes(type_: str, condition: str) -> None:
    project = sfc.loads(CHART.format(type_=type_, condition=condition).encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    report = sfc.save(project, io.BytesIO(), format="simaticml", strict=True, limit=20)
    divided = "not all was compared, " * ("/ y" in condition)  # both end with an error where 0 divides
    assert report.compared["POU Main"].startswith(f"{divided}equal")


def test_running_sees_that_a_product_is_cut_off() -> None:
    """The same text under the rules of both tools."""
    text = CHART.format(type_="INT", condition="x * y > d")
    one, other = (sfc.loads(text.encode(), format="iec-text") for _ in range(2))
    one.dialect, other.dialect = Dialect.CODESYS, Dialect.IEC
    verdict = equivalent(one, other)
    assert verdict.counterexample is not None


def test_a_difference_of_times_is_reported_in_bodies_as_in_transitions() -> None:
    for target in ("scl", "simaticml"):
        _, report = converted(source_of("codesys", "INT", "is_greater := t - u > T#5s;"), target, "")
        (item,) = report.losses
        assert item.outcome is Outcome.APPROXIMATED
        assert "TIME has no sign in CODESYS" in item.why
    _, report = converted(source_of("scl", "INT", "is_greater := t - u < T#0s;"), "codesys", "")
    assert ["TIME has no sign in CODESYS" in item.why for item in report.losses] == [True]


@pytest.mark.parametrize(
    ("statement", "is_told"),
    [
        ("is_greater := t - u < T#0s;", True),
        ("t := SUB_TIME(t, u);", True),
        ("t := -u;", True),
        ("t := u * x;", True),
        ("t := MUL_TIME(u, r);", True),
        ("t := INT_TO_TIME(x);", True),
        ("t := REAL_TO_TIME(r);", True),
        ("t := u * 2 + T#3s;", False),
        ("t := UINT_TO_TIME(z) + INT_TO_TIME(500);", False),
        ("is_greater := t < T#3s; x := y - 3;", False),
    ],
)
@pytest.mark.parametrize(
    ("tool", "target"),
    [(tool, target) for tool in ("iec", "scl") for target in ("codesys", "codesys23", "twincat", "codesys-export")]
    + [("codesys", target) for target in ("plcopen-2.01", "simaticml")],
)
def test_times_that_may_be_below_zero_are_told(tool: str, target: str, statement: str, is_told: bool) -> None:
    project = source_of(tool, "INT", statement, more="z : UINT;")
    _, report = sfc.convert(project, target)
    told = [item.outcome for item in report.losses if "TIME has no sign in CODESYS" in item.why]
    assert told == [Outcome.APPROXIMATED] * is_told


@pytest.mark.parametrize(
    ("statement", "is_told"),
    [
        ("t := t + u;", True),
        ("t := (u + T) - T#3s;", True),
        ("t := ADD_TIME(u, t);", True),
        ("t := 2 * t;", True),
        ("t := u * z;", True),
        ("t := u / r;", True),
        ("t := REAL_TO_TIME(r);", True),
        ("t := LINT_TO_TIME(l);", True),
        ("t := u + T#3s; x := x + 1;", False),
        ("t := u * 2 + T#3s;", False),
        ("t := UINT_TO_TIME(z);", False),
        ("t := t;", False),
    ],
)
@pytest.mark.parametrize(
    ("tool", "target", "end"),
    [
        ("codesys", "scl", "24 days in S7 and goes on below zero"),
        ("codesys", "plcopen-2.01", "49 days in CODESYS and goes on from zero"),
        ("iec", "codesys", "49 days in CODESYS and goes on from zero"),
        ("iec", "simaticml", "24 days in S7 and goes on below zero"),
        ("scl", "codesys", "24 days in S7 and goes on below zero"),
        ("scl", "plcopen-2.01", "24 days in S7 and goes on below zero"),
        ("iec", "plcopen-2.01", ""),
    ],
)
def test_times_that_grow_beyond_those_of_a_tool_are_told(
    tool: str, target: str, end: str, statement: str, is_told: bool
) -> None:
    project = source_of(tool, "INT", statement, more="z : UINT; l : LINT;")
    _, report = sfc.convert(project, target, partial=True)
    told = [item.outcome for item in report.losses if f"TIME ends after {end}" in item.why]
    is_whole = tool == "scl" and "REAL_TO_TIME" in statement  # a DINT of milliseconds there
    assert told == [Outcome.APPROXIMATED] * (is_told and bool(end) and not is_whole)
    assert all("TIME endet in" in german(item.why) for item in report.losses if "TIME ends" in item.why)


@pytest.mark.parametrize(
    ("tool", "target", "start", "is_same"),
    [
        ("codesys", "scl", "T#24d19h", True),
        ("codesys", "scl", "T#24d20h", False),
        ("iec", "scl", "T#24d20h", False),
        ("scl", "codesys", "T#24d20h", False),
        ("scl", "plcopen-2.01", "T#24d20h", False),
        ("iec", "codesys", "T#24d20h", True),
        ("iec", "codesys", "T#49d17h", False),
        ("codesys", "plcopen-2.01", "T#49d17h", False),
    ],
)
def test_times_that_grow_are_those_of_the_tool(tool: str, target: str, start: str, is_same: bool) -> None:
    """Both run: an hour is added to a time shortly before the end of TIME."""
    statement = f"t := {start}; t := t + T#1h; is_greater := t > T#1h;"
    project = source_of(tool, "INT", statement)
    result, report = converted(project, target, "")
    both = [sfc.simulate(each, pou="Main", scans=1, record=["is_greater"]) for each in (project, result)]
    assert (both[0]["is_greater"] == both[1]["is_greater"]) is is_same
    assert "TIME ends after" in " ".join(item.why for item in report.losses)


@pytest.mark.parametrize("target", ["codesys", "codesys23", "twincat", "codesys-export"])
@pytest.mark.parametrize("tool", ["iec", "scl"])
@pytest.mark.parametrize(
    ("body", "more"),
    [
        ("t := u + T#-3s;", ""),
        ("t := u;", "z : TIME := T#-3s;"),
        ("t := u;", "z : ARRAY[0..1] OF TIME := [T#1s, T#-3s];"),
    ],
)
def test_times_that_codesys_cannot_write_are_refused(tool: str, target: str, body: str, more: str) -> None:
    with pytest.raises(sfc.LossError, match=r"T#-3s: -3000000000 ns does not fit the TIME of codesys"):
        sfc.convert(source_of(tool, "INT", body, more=more), target)


def test_times_get_the_units_that_codesys_takes() -> None:
    data, report = sfc.convert(source_of("iec", "INT", "t := u + T#0.5h;", more="z : TIME := T#1.5s;"), "codesys")
    assert not report.losses
    assert b"u + T#30m;" in data
    assert b"T#1s500ms" in data


@pytest.mark.parametrize(("type_", "word"), [("INT", "WORD"), ("USINT", "BYTE"), ("DINT", "DWORD")])
def test_logic_of_integers_is_that_of_bit_strings_in_scl(type_: str, word: str) -> None:
    data, report = sfc.convert(source_of("codesys", type_, "stored := x AND 7 OR NOT y;"), "scl")
    assert not report.losses
    assert f"{type_}_TO_{word}(#x) AND 16#7" in data.decode()
    project, result = source_of("codesys", type_, "stored := x AND 7 OR NOT y;"), sfc.loads(data, format="scl")
    assert_same_outputs(project, result, type_)


def test_logic_of_integers_of_two_widths_is_refused() -> None:
    _, report = converted(source_of("codesys", "INT", "stored := x AND wide;"), "scl", "")
    assert [item.outcome for item in report.losses] == [Outcome.NOT_EXECUTED]


@pytest.mark.slow
@pytest.mark.parametrize(("tool", "target"), [("codesys", "simaticml"), ("codesys", "scl"), ("scl", "codesys")])
@pytest.mark.parametrize("draw", [draw_fbd, draw_ld])
@pytest.mark.parametrize(
    ("statement", "differs"),
    [("wide := x * y;", True), ("stored := x * y;", False), ("is_greater := x + y > 100;", True)],
)
def test_boxes_that_calculate_otherwise_are_reported(
    tool: str, target: str, draw: Any, statement: str, differs: bool
) -> None:
    """A box stays as it is: where it gives something else it is approximated, in bodies and conditions.

    SCL has no boxes: the statements get conversions.
    """
    project = source_of(tool, "INT", statement)
    body = project.pous[0].bodies[0]
    assert isinstance(body, StBody)
    tree = parse_statements(body.text, project.dialect).tree
    project.pous[0].bodies = [draw(tree.statements, DrawingRules(project.dialect)).body]
    _, report = converted(project, target, "")
    assert any("calculate in other types" in item.why for item in report.losses) is (differs and target != "scl")


@pytest.mark.parametrize("target", ["codesys", "twincat", "codesys23"])
@pytest.mark.parametrize(
    ("statement", "is_told"),
    [
        ("IF x + y > 100 THEN count := 1; END_IF;", True),
        ("wide := x * y;", True),
        ("half := (x + y) / 2;", True),
        ("stored := x + y * 3;", False),
        ("is_greater := x > y;", False),
    ],
)
def test_texts_that_stay_are_told_where_codesys_does_not_cut_off(statement: str, is_told: bool, target: str) -> None:
    _, report = sfc.convert(source_of("iec", "INT", statement), target, partial=True)
    assert [item.path for item in report.losses if item.what == "arithmetic"] == ["POU Main"] * is_told


@pytest.mark.parametrize(("tool", "target"), [("iec", "codesys"), ("codesys", "plcopen-2.01")])
@pytest.mark.parametrize("language", ["FBD", "LD", "IL"])
@pytest.mark.parametrize(("operator", "is_told"), [("GT", True), ("", False)])
def test_boxes_and_instructions_are_told_where_one_tool_does_not_cut_off(
    tool: str, target: str, language: str, operator: str, is_told: bool
) -> None:
    statement = "is_greater := x + y > 100;" if operator else "stored := x + y;"
    listed = "LD x\nADD y\nGT 100\nST is_greater" if operator else "LD x\nADD y\nST stored"
    project = source_of(tool, "INT", statement)
    tree, rules = parse_statements(statement, project.dialect).tree, DrawingRules(project.dialect)
    drawn = {"FBD": draw_fbd, "LD": draw_ld}
    body = drawn[language](tree.statements, rules).body if language in drawn else IlBody(text=listed)
    project.pous[0].bodies = [body]
    _, report = sfc.convert(project, target, partial=True)
    assert [item.path for item in report.losses if item.what == "arithmetic"] == ["POU Main"] * is_told


def test_a_proof_takes_back_that_calculations_differ() -> None:
    text = CHART.format(type_="INT", condition="n + 1 > 2").replace("q : BOOL;", "q : BOOL; n : INT;")
    project = sfc.loads(text.encode(), format="iec-text")
    for limit, outcomes in ((0, [Outcome.APPROXIMATED]), (20, [Outcome.TRANSLATED])):
        report = sfc.save(project, io.BytesIO(), format="codesys", limit=limit)
        assert [item.outcome for item in report.items if item.what == "arithmetic"] == outcomes


@pytest.mark.parametrize(("type_", "result"), [("INT", "#x + #c"), ("SINT", "#x + #c"), ("DINT", "INT_TO_DINT")])
def test_results_of_methods_are_calculated_in_their_type(type_: str, result: str) -> None:
    argument = "INT" if type_ == "DINT" else type_
    text = f"""FUNCTION_BLOCK FB
VAR c : {argument}; END_VAR
METHOD M : {type_}
VAR_INPUT x : {argument}; END_VAR
M := x + c;
END_METHOD
END_FUNCTION_BLOCK
"""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    translate_project(project, Dialect.SCL)
    body = project.pous[0].methods[0].body
    assert isinstance(body, StBody)
    assert result in body.text
    assert ("_TO_" in body.text) is (type_ == "DINT")


@pytest.mark.parametrize("condition", ["LEN(s) = 3", "SHR(w, 1) = 16#2"])
def test_boxes_that_no_network_is_written_with_are_told_with_the_remedy(condition: str) -> None:
    text = f"""FUNCTION_BLOCK Main
        VAR_INPUT s : STRING; w : WORD; END_VAR VAR_OUTPUT q : BOOL; END_VAR
        INITIAL_STEP S1: END_STEP
        STEP S2: q(N); END_STEP
        TRANSITION FROM S1 TO S2 := {condition}; END_TRANSITION
        TRANSITION FROM S2 TO S1 := q; END_TRANSITION
        END_FUNCTION_BLOCK"""
    report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "simaticml", partial=True).report
    (why,) = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)]
    assert why.endswith(f"written with {condition[:3]}: let statements calculate it into a variable before")
    remedy = "lassen Sie Anweisungen es vorher in eine Variable berechnen"
    assert german(why).endswith(f"mit {condition[:3]} geschrieben: {remedy}")
