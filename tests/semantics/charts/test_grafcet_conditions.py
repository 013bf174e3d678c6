"""Conditions as GRAFCETs have them: read, simulated, refused, renamed."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.grafcet_conditions import condition_problem
from plcopen_sfc.model import Expression, Project
from plcopen_sfc.semantics.charts.grafcet.term_evaluation import TermTexts
from plcopen_sfc.semantics.profile import default_profile
from tests.lowering.grafcets import pou_with
from tests.semantics.charts.rig import Rig, chain
from tests.semantics.charts.test_grafcet import action

READ = {
    "1B1 * 2B1 * START": "1B1 AND 2B1 AND START",
    "a . b": "a AND b",
    "a·b + c": "a AND b OR c",
    "/a": "NOT a",
    "a̅ * 1̅B̅1̅": "NOT a AND NOT 1B1",
    "!a & ¬b ∨ c": "NOT a AND NOT b OR c",
    "[C1>3]": "(C1>3)",
    "C1 + 2 ≥ 3 AND b": "C1 + 2 >= 3 AND b",
    "1": "TRUE",
    "=1": "TRUE",
    "0": "FALSE",
    "/PO.(Tel+/PF.Voit)": "NOT PO AND (Tel OR NOT PF.Voit)",
    "Timer.Q * x[2] * %IX0.3": "Timer.Q AND x[2] AND %IX0.3",
    "a AND NOT (b OR c)": "a AND NOT (b OR c)",
    "RE(a) + b": "RE(a) OR b",
}


@pytest.mark.parametrize("text", READ)
def test_a_condition_is_read(text: str) -> None:
    terms = TermTexts()
    assert terms.read(text) == READ[text]
    assert not terms.edges
    assert not terms.timers


def test_edges_and_times_are_taken_out() -> None:
    terms = TermTexts()
    assert terms.read("↑1B1 * ↓(a+b) * ↑/c + ↑ 1B1") == (
        "GRAFCET_EDGE_1 AND GRAFCET_EDGE_2 AND GRAFCET_EDGE_3 OR GRAFCET_EDGE_1"
    )
    assert [(e.operand, e.rising) for e in terms.edges] == [("1B1", True), ("(a OR b)", False), ("NOT c", True)]
    terms.read("3s/X2 * X2/5s * 1,5 min/a/300ms + 2s//b")
    assert [(t.first, t.operand, t.last) for t in terms.timers] == [
        ("T#3s", "X2", None),
        (None, "X2", "T#5s"),
        ("T#1.5m", "a", "T#300ms"),
        ("T#2s", "NOT b", None),
    ]


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("3s//b/2s", "3s/b̅/2s"),
        ("3s/!b/2s", "3s/(/b)/2s"),
        ("/b/2s", "b̅/2s"),
        ("NOT b/2s", "b̅/2s"),
        ("3s/↑b/2s", "3s/(↑b)/2s"),
        ("↓b/2s", "(↓b)/2s"),
        ("/3s/b/2s", "/(3s/b/2s)"),
        ("3s//↑b", "3s/(/(↑b))"),
    ],
)
def test_negations_and_edges_are_of_the_operand_of_a_time(text: str, same: str) -> None:
    found = TermTexts(), TermTexts()
    read = [terms.read(each) for terms, each in zip(found, (text, same), strict=True)]
    bare = str.maketrans("", "", "()")
    assert read[0].translate(bare) == read[1].translate(bare)
    times = [[(t.first, t.operand.translate(bare), t.last) for t in terms.timers] for terms in found]
    assert times[0] == times[1]


def test_messages_have_terms_as_they_are_written() -> None:
    chart = chain("1", "2", "3", conditions="↑a;3s/(b*↓a);c")
    chart.add_transition("1", "3", "X2/5s * ↑(a+b)")
    project = Project(name="p", pous=[pou_with(chart, "a b c", "Q")])
    (finding,) = sfc.check(project, profile="grafcet", select=["SEL01"])
    values = finding.message.partition(": ")[2].split(", ")  # those of a and b may be any
    assert {"↑a = TRUE", "↑(a OR b) = TRUE"} <= set(values)
    assert {value.partition(" ")[0] for value in values} <= {"↑a", "↑(a", "t/X2", "a", "b"}
    terms = TermTexts()
    assert terms.shown(terms.read("3s/(b*↓a)")) == "3s/(b AND ↓a)"


@pytest.mark.parametrize(
    ("text", "message", "place"),
    [
        ("a b", "an operator is missing before 'b'", 2),
        ("a * ", "an operand is missing", 4),
        ("* a", "an operand is missing before '*'", 0),
        ("(a + b", "')' is missing", 0),
        ("a) + b", "')' closes nothing", 1),
        ("5 * a", "5 is no Boolean value", 0),
        ("3s", "a time needs what it is the time of: 3s/X1", 0),
        ("a̅b", "the overline is not over the whole name: write /a or NOT (..)", 0),
        ("[a̅=b]", "an overline in a comparison: write NOT before it", 1),
        ("a ? b", "'?' is not of a condition", 2),
        ("", "an operand is missing", 0),
        (
            "/a * (n ≤ 5 + b*)",
            "'n ≤ 5 + b*' is no structured text: found the end of the text, expected an expression; "
            "write [..] around a comparison",
            16,
        ),
        (
            "n < 5 + ↑a",
            "'n < 5 + ↑a' is no structured text: '↑' cannot stand here: structured text has R_TRIG: "
            "`Edge(CLK := a);` and then `Edge.Q`; write [..] around a comparison",
            8,
        ),
        ("F(5 + b*) * a", "'F(5 + b*)' is no structured text: found ')', expected an expression", 8),
    ],
)
def test_what_is_none_is_told_with_its_place(text: str, message: str, place: int) -> None:
    problem = condition_problem(text)
    assert problem is not None
    assert (problem.message, problem.span[0]) == (message, place)


def test_names_with_digits_run_in_conditions_and_actions() -> None:
    chart = chain("1", "2", conditions="1B1*/2B1;↑1B2 + [n≥3]")
    chart.step("1").actions = [action("continuous", "1M1")]
    chart.step("2").actions = [action("conditional", "2M1", "¬2B1", id=2), action("onActivation", "n", value="n+1")]
    bench = Rig(chart, "grafcet", variables="1B1 1B2 2B1 1M1 2M1 n:INT")
    bench.scan()
    assert (bench.active, bench["1M1"]) == ("1", True)
    bench.scan().__setitem__("1B1", True)
    bench.scan()
    assert (bench.active, bench["1M1"], bench["2M1"], bench["n"]) == ("2", False, True, 1)


def test_a_grafcet_is_lowered_from_book_notation_and_proven() -> None:
    chart = chain("1", "2", conditions="1B1*/2B1;↑1B2+2B1")
    chart.step("2").actions = [action("continuous", "1M1")]
    pou = pou_with(chart, "1B1 1B2 2B1", "1M1")
    project = Project(name="p", pous=[pou])
    assert default_profile(project).name == "grafcet"
    result = sfc.lower(project, profile="grafcet")
    assert result.proof is not None
    assert result.proof.equal


def test_a_rename_follows_into_conditions_of_a_grafcet() -> None:
    chart = chain("1", "2", conditions="↑1B1 * /2B1;3s/1B1 + [n>1B1]")
    project = Project(name="p", pous=[pou_with(chart, "1B1 2B1 n:INT", "Q")])
    project.rename("Ablauf.1B1", "Taster")
    texts = [t.condition.text for t in chart.transitions if isinstance(t.condition, Expression)]
    assert texts == ["↑Taster * /2B1", "3s/Taster + [n>Taster]"]


def test_a_rename_draws_the_line_over_the_new_name() -> None:
    chart = chain("1", "2", conditions="1̅B̅1̅ * /2B1;a̅ + 1B1")
    project = Project(name="p", pous=[pou_with(chart, "1B1 2B1 a", "Q")])
    project.rename("Ablauf.1B1", "Ab")
    project.rename("Ablauf.a", "b")
    texts = [t.condition.text for t in chart.transitions if isinstance(t.condition, Expression)]
    assert texts == ["A̅b̅ * /2B1", "b̅ + Ab"]
