"""Structured text and instructions in the form that matiec compiles.

matiec has neither ``//`` nor comments in comments, wants ``;`` behind every ``END_IF`` and the like, and compiles
neither an empty statement nor an empty list of statements (all tried with iec2c).
Expressions are in `matiec_expressions`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

from plcopen_sfc.languages.binding.text_sites import SiteKind, text_sites
from plcopen_sfc.languages.il import CALLS
from plcopen_sfc.languages.st import names_of, parse_statements, print_node, render, transform, walk
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import Comment, CommentKind, Token, tokenize
from plcopen_sfc.languages.st.walking import with_statements
from plcopen_sfc.languages.text_edits import Edit, apply_edits, without
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.whole_numbers import whole_number

Idle = Callable[[], str]
"""Gives the name of a BOOL that may be written where a list of statements would be empty."""


_ENDS = frozenset({"END_IF", "END_CASE", "END_FOR", "END_WHILE", "END_REPEAT"})


Result = Callable[[str], str | None]
"""Gives the variable for the result of a function that is called as a statement; None for what is no function."""


def compilable_statements(text: str, dialect: Dialect, idle: Idle, result: Result) -> str:
    """Return statements in the form that matiec takes; a text with syntax errors gets plain comments only."""
    parsed = parse_statements(text, dialect)
    if not parsed.problems:
        if not _working(parsed.tree.statements):
            comments = "\n".join(comment.text for comment in parsed.comments)
            text = f"{comments}\n{idle()} := FALSE;".lstrip()
        else:
            text = render(parsed, transform(parsed.tree, lambda node: _filled(_used(node, result), idle)))
    return compilable_comments(_with_semicolons(text, dialect), dialect)


def _used(node: n.Node, result: Result) -> n.Node:
    """Return a call of a function as an assignment: matiec knows no other."""
    call = node.call if isinstance(node, n.CallStatement) else None
    if isinstance(call, n.Call) and isinstance(call.callee, n.Name):
        name = result(call.callee.identifier)
        if name is not None:
            return n.Assignment(n.Name(name), call)
    return node


def _filled(node: n.Node, idle: Idle) -> n.Node:
    """Return a node whose lists of statements have no empty statement and are not empty."""
    new: dict[str, tuple[n.Statement, ...] | None] = {}
    for name in ("statements", "otherwise"):
        found = getattr(node, name, None)
        if not isinstance(found, tuple):
            continue
        working = _working(found)
        if name == "otherwise" and not working:
            new[name] = None
        elif not working and not isinstance(node, n.Statements):
            new[name] = (n.Assignment(n.Name(idle()), n.Literal("FALSE")),)
        elif len(working) < len(found):
            new[name] = working
    return replace(node, **new) if new else node  # type: ignore[arg-type]  # fields of several kinds of nodes


def _working(statements: tuple[n.Statement, ...]) -> tuple[n.Statement, ...]:
    return tuple(one for one in statements if not isinstance(one, n.Empty))


# -- loops ------------------------------------------------------------------------------------------------------------


def without_for(text: str, dialect: Dialect) -> tuple[str, list[str]]:
    """Return statements whose FOR loops do the same in matiec, and the reasons why some could not be rewritten.

    matiec compiles ``FOR i := a TO b`` into ``while (i < b)`` with the first turn not counted: a loop of exactly one
    turn is not executed at all, and `i` ends a turn earlier than elsewhere (seen in the C code of 2024, also with BY).
    Loops of projects for matiec are not given to this function: they do there what they did before.
    Only loops of literals whose variable nothing else uses are left as they are.
    """
    parsed = parse_statements(text, dialect)
    if parsed.problems or not any(isinstance(node, n.For) for node in walk(parsed.tree)):
        return text, []
    obstacles: list[str] = []
    named = Counter(node.identifier.casefold() for node in walk(parsed.tree) if isinstance(node, n.Name))

    def unrolled(statement: n.Statement) -> tuple[n.Statement, ...]:
        if not isinstance(statement, n.For) or _is_executed_alike(statement, named):
            return (statement,)
        obstacle = _obstacle(statement)
        if obstacle:
            obstacles.append(f"FOR {print_node(statement.variable)}: matiec leaves out a single turn; {obstacle}")
            return (statement,)
        return _as_while(statement)

    def without(found: tuple[n.Statement, ...]) -> tuple[n.Statement, ...]:
        return tuple(one for each in found for one in unrolled(each))

    tree = transform(parsed.tree, partial(with_statements, change=without))
    return (render(parsed, tree) if tree is not parsed.tree else text), obstacles


def note_loops(project: Project, report: ConversionReport, tool: str) -> None:
    """Report the FOR loops of a project for matiec that `tool` executes as IEC 61131-3 defines: with the last turn."""
    for text_site in text_sites(project):
        if not (text_site.is_program_text and text_site.reading is SiteKind.STATEMENTS):
            continue
        tree = parse_statements(text_site.text, project.dialect).tree
        named = Counter(node.identifier.casefold() for node in walk(tree) if isinstance(node, n.Name))
        for node in walk(tree):
            if isinstance(node, n.For) and not _is_executed_alike(node, named):
                loop = f"FOR {print_node(node.variable)}"
                why = f"{loop}: matiec leaves out a single turn and ends a turn earlier, {tool} does not"
                report.add(Outcome.APPROXIMATED, "loop", text_site.report_path, why)


def _is_executed_alike(loop: n.For, named: Mapping[str, int]) -> bool:
    """True for a loop with two turns or more whose variable is used inside only."""
    start, end, step = (literal_number(node) for node in (loop.start, loop.end, loop.step))
    if start is None or end is None or not step or not isinstance(loop.variable, n.Name):
        return False
    name = loop.variable.identifier.casefold()
    inside = sum(isinstance(node, n.Name) and node.identifier.casefold() == name for node in walk(loop))
    return (end - start) // step >= 1 and inside == named[name]


def literal_number(node: n.Expression | None) -> int | None:
    """Return the value of a literal; that of a step which is not given."""
    if node is None:
        return 1
    bare = n.bare(node)
    if isinstance(bare, n.Unary) and bare.operator is n.Operator.NEGATE:
        value = literal_number(bare.operand)
        return None if value is None else -value
    return whole_number(bare.text) if isinstance(bare, n.Literal) else None


def _obstacle(loop: n.For) -> str:
    """Return the reason why a loop cannot be written with WHILE; empty if it can."""
    inside = [node for statement in loop.statements for node in walk(statement)]
    if any(isinstance(node, n.Continue) for node in inside):
        return "it has CONTINUE"
    if not literal_number(loop.step):
        return "its step is no literal"
    fixed = names_of(loop.end)
    if fixed and any(isinstance(node, n.Call) for node in inside):
        return "what it calls may change its end"
    targets = [node.target for node in inside if isinstance(node, n.Assignment)] + [loop.variable]
    written = {node.identifier.casefold() for target in targets for node in walk(target) if isinstance(node, n.Name)}
    if fixed & written or any(isinstance(node, n.Call) for node in walk(loop.end)):
        return "it changes its end"
    return ""


def _as_while(loop: n.For) -> tuple[n.Statement, ...]:
    # The turn that reaches the end leaves the loop before its variable is compared again: behind the greatest value of
    # its type a WHILE would not end.
    step = literal_number(loop.step) or 1
    forth, amount = step > 0, n.Literal(str(abs(step)))
    within, beyond = (
        (n.Operator.LESS_OR_EQUAL, n.Operator.GREATER) if forth else (n.Operator.GREATER_OR_EQUAL, n.Operator.LESS)
    )
    if abs(step) == 1:
        is_last = n.Operation(
            n.Operator.GREATER_OR_EQUAL if forth else n.Operator.LESS_OR_EQUAL, (loop.variable, loop.end)
        )
    else:
        back = n.Operation(n.Operator.SUBTRACT if forth else n.Operator.ADD, (loop.end, amount))
        is_last = n.Operation(beyond, (loop.variable, back))
    sign = n.Operator.ADD if forth else n.Operator.SUBTRACT
    counted = n.Assignment(loop.variable, n.Operation(sign, (loop.variable, amount)))
    last = n.If((n.Branch(is_last, (counted, n.Exit())),))
    turns = n.While(n.Literal("TRUE"), (*loop.statements, last, counted))
    entered = n.If((n.Branch(n.Operation(within, (loop.variable, loop.end)), (turns,)),))
    return (n.Assignment(loop.variable, loop.start), entered)


def _with_semicolons(text: str, dialect: Dialect) -> str:
    tokens = tokenize(text, dialect).tokens
    ends = [
        token.span[1]
        for token, following in zip(tokens, [*tokens[1:], None], strict=True)
        if token.type in _ENDS and (following is None or following.type != "SEMICOLON")
    ]
    return apply_edits(text, [Edit(end, end, ";") for end in ends])


def compilable_instructions(text: str, dialect: Dialect) -> str:
    """Return instructions in the form that matiec takes: the parameters of a call on lines of their own."""
    edits = []
    for token, following in _separators_of_calls(text, dialect):
        place = token.span[0] if following is None else token.span[1]
        edits.append(Edit(place, place, "\n"))
    return compilable_comments(apply_edits(text, edits), dialect)


def gives_to_operators(text: str, dialect: Dialect) -> bool:
    """True if a call in instructions has a parameter R or S, which are operators of IL."""
    found = [following.value.upper() for _, following in _separators_of_calls(text, dialect) if following is not None]
    return not {"R", "S"}.isdisjoint(found)


def _separators_of_calls(text: str, dialect: Dialect) -> Iterator[tuple[Token, Token | None]]:
    """Yield what is before each parameter of calls in instructions, with its name, and the ends of calls with None."""
    tokens = tokenize(text, dialect).tokens
    for index, token in enumerate(tokens):
        if token.value.upper() not in CALLS or index + 2 >= len(tokens) or tokens[index + 2].type != "LPAR":
            continue
        depth = 0
        for inner, following in zip(tokens[index + 2 :], tokens[index + 3 :], strict=False):
            depth += (inner.type == "LPAR") - (inner.type == "RPAR")
            if depth == 0:
                yield inner, None
                break
            if depth == 1 and inner.type in ("LPAR", "COMMA"):
                yield inner, following
        else:
            if depth == 1 and tokens[-1].type == "RPAR":
                yield tokens[-1], None


def compilable_comments(text: str, dialect: Dialect) -> str:
    """Return the text with ``(* *)`` as its only comments and without pragmas."""
    comments = tokenize(text, dialect).comments
    pragmas = [c for c in comments if c.kind is CommentKind.PRAGMA]
    others = [Edit(*c.span, _as_block(c)) for c in comments if c.kind is not CommentKind.PRAGMA]
    changed = apply_edits(text, [one for one in others if text[one.start : one.end] != one.text])
    if not pragmas:
        return changed
    spans = [c.span for c in tokenize(changed, dialect).comments if c.text in {p.text for p in pragmas}]
    return "\n".join(line.rstrip() for line in without(changed, spans).split("\n"))


def _as_block(comment: Comment) -> str:
    if comment.kind is CommentKind.LINE:
        inner = f" {comment.text[2:].strip()} "
    else:
        opening = 3 if comment.text.startswith("(/*") else 2
        inner = comment.text[opening : -3 if comment.text.endswith("*/)") else -2]
    return f"(*{plain_comment(inner)}*)"


def plain_comment(text: str) -> str:
    """Return the inside of a comment without the marks of another: matiec has no comments in comments."""
    while "(*" in text or "*)" in text:
        text = text.replace("(*", "( *").replace("*)", "* )")
    return f"{text} " if text.endswith("*") else text
