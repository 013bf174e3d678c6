"""Helper variables that are read once are not declared; those that something changes in between stay."""

from __future__ import annotations

from plcopen_sfc import model as m
from plcopen_sfc.languages.st import parse_statements, print_node
from plcopen_sfc.languages.st.nodes import Name, Statements
from plcopen_sfc.lowering.code.lowered_code import CodeNetwork, LoweredCode, Naming
from plcopen_sfc.lowering.code.single_use import inline_single_uses


def statements_of(text: str) -> Statements:
    return parse_statements(text, m.Dialect.IEC).tree


def inlined(text: str, *, helpers: str = "edge old", behind: str = "", kept: str = "") -> tuple[str, list[str]]:
    code = LoweredCode(Naming(m.Dialect.IEC, ()))
    for helper in helpers.split():
        code.declare(helper)
    for network in filter(None, (text, behind)):
        code.add("", statements_of(network).statements)
    inline_single_uses(code, [Name(name) for name in kept.split()])
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
