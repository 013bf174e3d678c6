"""An edit of a tree is an edit of its place in the text; nothing else moves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from plcopen_sfc.languages.st import (
    parse_expression,
    parse_statements,
    print_node,
    render,
    transform,
    without_parentheses,
)
from plcopen_sfc.languages.st.nodes import (
    Argument,
    Branch,
    Call,
    CallStatement,
    Exit,
    Expression,
    If,
    Literal,
    Name,
    Node,
    Operation,
    Operator,
    RegionBlock,
    Statement,
    Statements,
    Unary,
)
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.model.dialect import Dialect

TEXT = """\
IF  a AND b THEN (* why *)
\tx := 1 ;   // one
\tfb( IN := a,PT:=T#5s );
ELSIF c THEN ;
ELSE
\ty := (1+2)*3;
END_IF
CASE s OF
 1: z();
 2,3: x(); END_CASE;
"""


def renamed(old: str, new: str) -> Callable[[Node], Node]:
    return lambda node: Name(new) if isinstance(node, Name) and node.identifier == old else node


@pytest.mark.parametrize("text", [TEXT, TEXT.replace("\n", "\r\n"), "", "  ", "(* nothing *)", "a := ;", "\0"])
def test_an_unedited_tree_is_its_text(text: str) -> None:
    parsed = parse_statements(text)
    assert render(parsed, parsed.tree) == text
    assert render(parsed, transform(parsed.tree, lambda node: node)) == text


def test_a_name_changes_where_it_stands_and_nowhere_else() -> None:
    parsed = parse_statements(TEXT)
    assert render(parsed, transform(parsed.tree, renamed("a", "alpha"))) == TEXT.replace(" a ", " alpha ").replace(
        "= a,", "= alpha,"
    )


def test_an_expression_in_a_condition() -> None:
    parsed = parse_expression("a  AND  NOT b")
    assert render(parsed, Operation(Operator.OR, (parsed.tree, Name("c")))) == "a  AND  NOT b OR c"
    assert render(parsed, Unary(Operator.NOT, parsed.tree)) == "NOT (a  AND  NOT b)"


def edited(text: str, change: Callable[[tuple[Statement, ...]], tuple[Statement, ...]]) -> str:
    """`text` after a change of the statements below its first IF."""
    parsed = parse_statements(text)
    first = parsed.tree.statements[0]
    assert isinstance(first, If)
    branch = replace(first.branches[0], statements=change(first.branches[0].statements))
    changed = replace(first, branches=(branch, *first.branches[1:]))
    return render(parsed, replace(parsed.tree, statements=(changed, *parsed.tree.statements[1:])))


def test_a_statement_is_put_in_behind_the_comment_of_the_one_before() -> None:
    assert edited(TEXT, lambda old: (old[0], Exit(), old[1])) == TEXT.replace("// one\n", "// one\n\tEXIT;\n")
    assert edited(TEXT, lambda old: (Exit(), *old)) == TEXT.replace("\tx :=", "\tEXIT;\n\tx :=")
    crlf = TEXT.replace("\n", "\r\n")
    assert edited(crlf, lambda old: (*old, Exit())) == crlf.replace("T#5s );\r\n", "T#5s );\r\n\tEXIT;\r\n")


def test_what_stands_right_behind_a_new_statement_does_not_become_a_part_of_it() -> None:
    parsed = parse_statements("a();b();", Dialect.SCL)
    first, last = parsed.tree.statements
    assert render(parsed, Statements((first, RegionBlock("", ()), last))) == "a();\nREGION\nEND_REGION\nb();"


def test_a_statement_is_taken_out_with_its_line() -> None:
    assert edited(TEXT, lambda old: (old[0],)) == TEXT.replace("\tfb( IN := a,PT:=T#5s );\n", "")


def test_a_new_statement_has_the_indent_of_its_place() -> None:
    new = If((Branch(Name("k"), (Exit(),)),), ())
    put = "\tIF k THEN\n\t    EXIT;\n\tELSE\n\tEND_IF;\n"
    assert edited(TEXT, lambda old: (*old, new)) == TEXT.replace("ELSIF", put + "ELSIF")


def test_a_branch_is_taken_out_and_put_in() -> None:
    parsed = parse_statements(TEXT)
    first = parsed.tree.statements[0]
    assert isinstance(first, If)
    without = replace(first, branches=first.branches[:1])
    text = render(parsed, replace(parsed.tree, statements=(without, parsed.tree.statements[1])))
    assert text == TEXT.replace("ELSIF c THEN ;\n", "")


def test_comments_of_what_is_written_anew_move_before_it() -> None:
    parsed = parse_statements(TEXT)
    first = parsed.tree.statements[0]
    assert isinstance(first, If)
    changed = replace(first, otherwise=None)
    text = render(parsed, replace(parsed.tree, statements=(changed, parsed.tree.statements[1])))
    assert text == TEXT.replace("ELSE\n\ty := (1+2)*3;\nEND_IF\n", "END_IF;\n")
    commented = "IF a (* why *) THEN b; ELSE (* other *) c; END_IF;"
    parsed = parse_statements(commented)
    first = parsed.tree.statements[0]
    assert isinstance(first, If)
    text = render(parsed, Statements((replace(first, otherwise=None),)))
    assert text == "(* other *) IF a (* why *) THEN b;\nEND_IF;"


@pytest.mark.parametrize("dialect", Dialect)
def test_a_comment_that_moves_behind_a_parenthesis_is_none_of_scl(dialect: Dialect) -> None:
    parsed = parse_expression("f( /* why */ NOT /* not */ a)", dialect)
    assert parsed.problems == ()
    written = render(parsed, transform(parsed.tree, lambda node: Name("b") if isinstance(node, Unary) else node))
    assert written == "f( /* why */ /* not */ b)"
    moved = parse_expression("f(NOT /* not */ a)", dialect)
    written = render(moved, transform(moved.tree, lambda node: Name("b") if isinstance(node, Unary) else node))
    assert written == "f( /* not */ b)"
    assert parse_expression(written, dialect).problems == ()


def test_comments_in_parentheses_are_those_of_scl_only_in_scl() -> None:
    assert parse_statements("f(/* a */ x);", Dialect.CODESYS).tree == parse_statements("f(x);", Dialect.CODESYS).tree
    assert parse_statements("f(/* a */);", Dialect.CODESYS).tree == parse_statements("f();", Dialect.CODESYS).tree
    assert [c.text for c in parse_statements("f();(/* a */)", Dialect.SCL).comments] == ["(/* a */)"]


def test_an_argument_more() -> None:
    parsed = parse_statements("fb( a,  b );")
    statement = parsed.tree.statements[0]
    assert isinstance(statement, CallStatement)
    assert isinstance(statement.call, Call)
    more = replace(statement.call, arguments=(*statement.call.arguments, Argument(Literal("1"), Name("c"))))
    assert render(parsed, replace(parsed.tree, statements=(replace(statement, call=more),))) == "fb(a, b, c := 1);"


@pytest.mark.parametrize(
    ("tree", "text"),
    [
        (Operation(Operator.AND, (Name("a"), Operation(Operator.OR, (Name("b"), Name("c"))))), "a AND (b OR c)"),
        (
            Operation(Operator.SUBTRACT, (Name("a"), Operation(Operator.SUBTRACT, (Name("b"), Name("c"))))),
            "a - (b - c)",
        ),
        (Operation(Operator.SUBTRACT, (Operation(Operator.SUBTRACT, (Name("a"), Name("b"))), Name("c"))), "a - b - c"),
        (Operation(Operator.ADD, (Operation(Operator.ADD, (Name("a"), Name("b"))), Name("c"))), "(a + b) + c"),
        (Unary(Operator.NOT, Operation(Operator.AND, (Name("a"), Name("b")))), "NOT (a AND b)"),
        (Operation(Operator.POWER, (Unary(Operator.NEGATE, Name("a")), Name("b"))), "(-a) ** b"),
        (Unary(Operator.NEGATE, Operation(Operator.POWER, (Name("a"), Name("b")))), "-(a ** b)"),
    ],
)
def test_parentheses_stand_where_the_tree_needs_them(tree: Expression, text: str) -> None:
    assert print_node(tree) == text


def test_edits_that_overlap_are_refused() -> None:
    assert apply_edits("abc", [Edit(2, 3, "C"), Edit(0, 1, "A")]) == "AbC"
    with pytest.raises(ValueError, match="overlap"):
        apply_edits("abc", [Edit(0, 2, ""), Edit(1, 3, "")])


def rendered(text: str, change: Callable[[Node], Node]) -> str:
    parsed = parse_expression(text)
    return render(parsed, transform(parsed.tree, change))


def test_new_operands_get_the_parentheses_they_need() -> None:
    def to_sum(node: Node) -> Node:
        return Operation(Operator.ADD, (Name("p"), Name("q"))) if node == Name("x") else node

    assert rendered("x * b", to_sum) == "(p + q) * b"
    assert rendered("a  +  x", to_sum) == "a  +  (p + q)"
    assert rendered("x  <  b", to_sum) == "p + q  <  b"
    assert rendered("-x", to_sum) == "-(p + q)"
    assert rendered("(x) * b", to_sum) == "(p + q) * b"
    assert rendered("f(x)[x]", to_sum) == "f(p + q)[p + q]"


def test_parentheses_that_are_taken_away_come_back_where_they_are_needed() -> None:
    parsed = parse_expression("a * (b+c) AND (d)")
    assert render(parsed, without_parentheses(parsed.tree)) == "a * (b+c) AND d"


def test_layout_stays_inside_of_what_is_written_anew() -> None:
    def change(node: Node) -> Node:
        if isinstance(node, Operation) and node.operator is Operator.OR:
            return replace(node, operator=Operator.XOR)
        return Name("alpha") if node == Name("a") else node

    assert (
        rendered("f(a  ,b)(*x*) OR NOT g( 1+a ) (* y *)", change) == "(*x*) f(alpha  ,b) XOR NOT g( 1+alpha ) (* y *)"
    )


def test_comments_inside_of_what_is_kept_with_edits_are_not_doubled() -> None:
    def change(node: Node) -> Node:
        if isinstance(node, Operation) and node.operator is Operator.OR:
            return replace(node, operator=Operator.XOR)
        return Name("alpha") if node == Name("a") else node

    assert rendered("f(a (* 1 *), b) OR (a (* 2 *) OR b)", change) == "f(alpha (* 1 *), b) XOR ((* 2 *) alpha XOR b)"


def test_the_first_branch_that_gets_statements_stays_the_first() -> None:
    parsed = parse_statements("IF a THEN\nELSIF b THEN (* none *)\nEND_IF;", Dialect.CODESYS)
    new = Statements((CallStatement(Call(Name("Go"))),)).statements
    filled = transform(parsed.tree, lambda node: replace(node, statements=new) if isinstance(node, Branch) else node)
    text = render(parsed, filled)
    assert text.split()[:4] == ["IF", "a", "THEN", "Go();"]
    assert not parse_statements(text, Dialect.CODESYS).problems
    assert "(* none *)" in text
