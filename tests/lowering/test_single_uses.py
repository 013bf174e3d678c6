"""Helper variables that are read once are not declared; those that something changes in between stay."""

from __future__ import annotations

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.languages.st import parse_statements, print_node
from plcopen_sfc.languages.st.nodes import Name, Remark, Statements
from plcopen_sfc.lowering.code.lowered_code import CodeNetwork, LoweredCode, Naming
from plcopen_sfc.lowering.code.single_use import inline_single_uses, remove_unread


def statements_of(text: str) -> Statements:
    return parse_statements(text, m.Dialect.IEC).tree


def inlined(text: str, *, helpers: str = "edge old", behind: str = "", kept: str = "") -> tuple[str, list[str]]:
    code = LoweredCode(Naming(m.Dialect.IEC, ()))
    for helper in helpers.split():
        code.declare(helper)
    for network in filter(None, (text, behind)):
        code.add("", statements_of(network).statements)
    inline_single_uses(code, [Name(name) for name in kept.split()])
    remove_unread(code, [Name(name) for name in kept.split()])
    first = code.networks[0]
    assert isinstance(first, CodeNetwork)
    shown = print_node(Statements(first.statements))
    return " ".join(shown.split()), [variable.name for variable in code.variables]


EDGE = "edge := a AND NOT old; old := a; "


def test_the_last_value_of_an_edge_is_kept_behind_its_reader() -> None:
    made, variables = inlined(EDGE + "IF edge THEN q := q + 1; END_IF;")
    assert made == "IF a AND NOT old THEN q := q + 1; END_IF; old := a;"
    assert variables == ["old"]


def test_what_changes_the_value_keeps_the_helper() -> None:
    for text in (
        EDGE + "IF edge THEN a := FALSE; END_IF;",  # the last value would be another one
        EDGE + "IF edge THEN RETURN; END_IF;",  # the last value would not be kept
        EDGE + "IF edge THEN foreign(); END_IF;",  # a call may write a
        EDGE + "c := old; IF edge THEN q := TRUE; END_IF;",
        "edge := a; a := b; c := a; IF edge THEN q := c; END_IF;",
        "edge := a; foreign(); IF edge THEN q := TRUE; END_IF;",
        "edge := foreign(); IF edge THEN q := TRUE; END_IF;",
        EDGE + "IF edge OR foreign() THEN q := TRUE; END_IF;",
        EDGE + "IF b THEN q := TRUE; ELSIF edge THEN q := FALSE; END_IF;",
        EDGE + "IF b THEN q := edge; END_IF;",
    ):
        helpers = "edge old" if "old" in text else "edge"
        made, variables = inlined(text, helpers=helpers)
        as_it_was = " ".join(print_node(statements_of(text)).split())
        assert (made, variables) == (as_it_was, helpers.split()), text


def test_helpers_that_others_read_stay() -> None:
    text = EDGE + "IF edge THEN q := TRUE; END_IF;"
    assert inlined(text, behind="p := edge;")[1] == ["edge", "old"]
    assert inlined(text, kept="edge")[1] == ["edge", "old"]


def test_a_second_name_for_a_value_goes() -> None:
    assert inlined("edge := a OR b; q := edge;")[0] == "q := a OR b;"


def test_a_helper_inside_of_branches_goes_where_nothing_before_it_changes_its_value() -> None:
    asked = "IF c THEN q := 2; ELSIF edge THEN q := 3; END_IF;"
    case = "edge := s = 2 AND a; CASE s OF 1: q := 1; 2: {before}" + asked + " END_CASE;"
    made, variables = inlined(case.format(before=""), helpers="edge")
    assert made == "CASE s OF 1: q := 1; 2: IF c THEN q := 2; ELSIF a THEN q := 3; END_IF; END_CASE;"
    assert variables == []
    for text in (
        case.format(before="a := FALSE; "),
        "edge := a; WHILE b DO a := edge AND NOT a; b := a; END_WHILE;",
        "edge := a; IF b THEN foreign(); IF edge THEN q := 1; END_IF; END_IF;",
    ):
        assert inlined(text, helpers="edge")[1] == ["edge"], text


def test_a_helper_of_another_network_goes_but_not_into_a_long_line() -> None:
    code = LoweredCode(Naming(m.Dialect.IEC, ()))
    code.declare("edge")
    code.add("", statements_of("edge := a AND b;").statements)
    code.add("", statements_of("q := c OR edge;").statements)
    inline_single_uses(code, [])
    remove_unread(code, [])
    assert [print_node(Statements(each.statements)) for each in code.networks] == ["q := c OR a AND b;"]
    long = " OR ".join(f"some_long_name_{i}" for i in range(6))
    assert inlined(f"edge := a AND b; q := {long} OR edge;", helpers="edge")[1] == ["edge"]


def test_a_loop_asks_in_its_end_for_what_its_last_statement_tells() -> None:
    made, variables = inlined("REPEAT s := s + 1; edge := s <> t; UNTIL NOT edge OR n END_REPEAT;", helpers="edge")
    assert made == "REPEAT s := s + 1; UNTIL s = t OR n END_REPEAT;"
    assert variables == []
    made, variables = inlined("REPEAT edge := a OR b; q := edge; UNTIL c END_REPEAT;", helpers="edge")
    assert (made, variables) == ("REPEAT q := a OR b; UNTIL c END_REPEAT;", [])


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("IF a THEN edge := b; END_IF; q := c;", "q := c;"),
        (
            "IF a THEN edge := b; ELSIF b THEN q := 1; ELSE q := 2; END_IF;",
            "IF NOT a AND b THEN q := 1; ELSIF NOT a THEN q := 2; END_IF;",
        ),
        ("IF foreign() THEN edge := b; END_IF; q := c;", "IF foreign() THEN END_IF; q := c;"),
        ("CASE s OF 1: edge := b; 2: q := c; END_CASE;", "CASE s OF 2: q := c; END_CASE;"),
        ("REPEAT q := c; edge := b; UNTIL a END_REPEAT;", "REPEAT q := c; UNTIL a END_REPEAT;"),
        ("old := a; edge := old; old := edge OR b; q := c;", "q := c;"),
        ("edge := foreign(); q := c;", "edge := foreign(); q := c;"),
    ],
)
def test_what_nothing_reads_is_not_assigned_inside_of_others_either(text: str, left: str) -> None:
    made, variables = inlined(text)
    assert made == left
    assert variables == (["edge"] if "edge" in left else [])


def test_comments_alone_stay_and_titles_of_what_is_gone_go() -> None:
    code = LoweredCode(Naming(m.Dialect.IEC, ()))
    code.declare("edge")
    code.declare("old")
    code.add("Nothing to do", [Remark("nothing yet")])
    code.add("Unread", statements_of("old := a;").statements)
    code.add("Gone", statements_of("edge := a AND b;").statements)
    code.add("Kept", statements_of("q := edge;").statements)
    inline_single_uses(code, [])
    remove_unread(code, [])
    assert [each.title for each in code.networks] == ["Nothing to do", "Kept"]
