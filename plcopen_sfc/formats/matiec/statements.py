"""Structured text as matiec compiles it.

matiec has neither ``//`` nor comments in comments, wants ``;`` behind every ``END_IF`` and the like, and compiles
neither an empty statement nor an empty list of statements (all tried with iec2c).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

from plcopen_sfc.formats.matiec.conversions import REAL_LITERAL, Converter
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.edits import Edit, apply_edits, without
from plcopen_sfc.languages.il import CALLS
from plcopen_sfc.languages.names.pieces import Piece, Reading, pieces
from plcopen_sfc.languages.names.resolving import Resolver
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, render, transform
from plcopen_sfc.languages.st.lexer import Comment, CommentKind, tokenize
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import ElementaryType, SimpleValue
from plcopen_sfc.report import ConversionReport, Outcome

Idle = Callable[[], str]
"""Gives the name of a BOOL that may be written where a list of statements would be empty."""

_ENDS = frozenset({"END_IF", "END_CASE", "END_FOR", "END_WHILE", "END_REPEAT"})


Result = Callable[[str], str | None]
"""Gives the variable for the result of a function that is called as a statement; None for what is no function."""


def compilable_statements(text: str, dialect: Dialect, idle: Idle, result: Result) -> str:
    """Statements in the form that matiec takes; a text with syntax errors gets plain comments only."""
    parsed = parse_statements(text, dialect)
    if not parsed.problems:
        if not _working(parsed.tree.statements):
            comments = "\n".join(comment.text for comment in parsed.comments)
            text = f"{comments}\n{idle()} := FALSE;".lstrip()
        else:
            text = render(parsed, transform(parsed.tree, lambda node: _filled(_used(node, result), idle)))
    return compilable_comments(_with_semicolons(text, dialect), dialect)


def _used(node: n.Node, result: Result) -> n.Node:
    """A call of a function as an assignment: matiec knows no other."""
    call = node.call if isinstance(node, n.CallStatement) else None
    if isinstance(call, n.Call) and isinstance(call.callee, n.Name):
        name = result(call.callee.identifier)
        if name is not None:
            return n.Assignment(n.Name(name), call)
    return node


def _filled(node: n.Node, idle: Idle) -> n.Node:
    """A node whose lists of statements have no empty statement and are not empty."""
    new: dict[str, tuple[n.Statement, ...] | None] = {}
    for name in ("statements", "otherwise"):
        found = getattr(node, name, None)
        if not isinstance(found, tuple):
            continue
        working = _working(found)
        if name == "otherwise" and not working:
            new[name] = None
        elif not working and not isinstance(node, n.Statements):
            new[name] = (_idle(idle),)
        elif len(working) < len(found):
            new[name] = working
    return replace(node, **new) if new else node  # type: ignore[arg-type]  # fields of several kinds of nodes


def _working(statements: tuple[n.Statement, ...]) -> tuple[n.Statement, ...]:
    return tuple(one for one in statements if not isinstance(one, n.Empty))


def _idle(idle: Idle) -> n.Statement:
    return n.Assignment(n.Name(idle()), n.Literal("FALSE"))


def _with_semicolons(text: str, dialect: Dialect) -> str:
    tokens = tokenize(text, dialect).tokens
    ends = [
        token.span[1]
        for token, following in zip(tokens, [*tokens[1:], None], strict=True)
        if token.type in _ENDS and (following is None or following.type != "SEMICOLON")
    ]
    return apply_edits(text, [Edit(end, end, ";") for end in ends])


def compilable_instructions(text: str, dialect: Dialect) -> str:
    """Instructions in the form that matiec takes: the parameters of a call stand on lines of their own."""
    edits = []
    tokens = tokenize(text, dialect).tokens
    for index, token in enumerate(tokens):
        if token.value.upper() not in CALLS or index + 2 >= len(tokens) or tokens[index + 2].type != "LPAR":
            continue
        depth = 0
        for inner in tokens[index + 2 :]:
            depth += (inner.type == "LPAR") - (inner.type == "RPAR")
            if depth == 0:
                edits.append(Edit(inner.span[0], inner.span[0], "\n"))
                break
            if depth == 1 and inner.type in ("LPAR", "COMMA"):
                edits.append(Edit(inner.span[1], inner.span[1], "\n"))
    return compilable_comments(apply_edits(text, edits), dialect)


def compilable_comments(text: str, dialect: Dialect) -> str:
    """The text with ``(* *)`` as its only comments and without pragmas."""
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
    """The inside of a comment without the marks of another: matiec has no comments in comments."""
    while "(*" in text or "*)" in text:
        text = text.replace("(*", "( *").replace("*)", "* )")
    return f"{text} " if text.endswith("*") else text


# -- expressions ------------------------------------------------------------------------------------------------------


def fit_expressions(project: Project, report: ConversionReport) -> None:
    """Write what matiec spells otherwise in all texts of a project, and report what it has no words for."""
    resolver = Resolver(project, project.dialect)
    for piece in list(pieces(project)):
        if not piece.is_program_text:
            continue
        parsed = (parse_statements if piece.reading is Reading.STATEMENTS else parse_expression)(
            piece.text, project.dialect
        )
        if parsed.problems:
            continue
        fitter = _ExpressionFitter(piece, resolver)
        tree = transform(parsed.tree, fitter)
        if tree is not parsed.tree:
            piece.put(render(parsed, tree))
        for what, why in dict.fromkeys(fitter.missing):
            report.add(Outcome.NOT_EXECUTED, what, piece.report_path, f"{why}; the text does not compile there")


class _ExpressionFitter:
    def __init__(self, piece: Piece, resolver: Resolver) -> None:
        self.piece = piece
        self.resolver = resolver
        self.missing: list[tuple[str, str]] = []
        self.converter = Converter(self._type, self.missing)

    def __call__(self, node: n.Node) -> n.Node:
        if isinstance(node, n.Literal):
            return self._literal(node)
        if isinstance(node, n.Address):
            self.missing.append(("address", f"matiec takes {node.text} in declarations only"))
        if isinstance(node, n.Operation):
            return self.converter.operation(node)
        if isinstance(node, n.Assignment):
            return self.converter.assignment(node)
        if isinstance(node, n.Member) and _BIT.fullmatch(node.name.identifier):
            self.missing.append(("bit access", f"matiec has no bits of variables, here .{node.name.identifier}"))
        if isinstance(node, n.Call) and isinstance(node.callee, n.Name):
            return self._conversion(node, node.callee)
        return node

    def _literal(self, node: n.Literal) -> n.Node:
        text = node.text
        if _LONG.match(text) and not isinstance(self.piece.holder, SimpleValue):  # its type is reported
            self.missing.append(("literal", f"matiec has no {text}"))
        if text.startswith("'"):
            text = _LINE_FEED.sub(lambda found: "$0A" if found[1] in "Ll" else found[0], text)  # its C code is wrong
        if text.startswith("'") and not text.isascii():
            if any(ord(character) > _LATIN_1 for character in text):
                self.missing.append(("literal", f"matiec has no {text}"))
            else:
                text = "".join(c if c.isascii() else f"${ord(c):02X}" for c in text)
        elif not text.startswith("'"):
            text = _POINTLESS.sub(r"\g<0>.0", text)
        return node if text == node.text else replace(node, text=text)

    def _conversion(self, call: n.Call, callee: n.Name) -> n.Node:
        """``TO_INT(x)`` as ``REAL_TO_INT(x)``: matiec has the type of the argument in the name."""
        name = callee.identifier.upper()
        if not _CONVERSION.fullmatch(name) or len(call.arguments) != 1 or call.arguments[0].value is None:
            return call
        kind = self._type(call.arguments[0].value)
        if not kind:
            self.missing.append(("function", f"matiec has no {name}, and the type of its argument is not known"))
            return call
        if f"TO_{kind}" == name:
            return n.Parenthesized(call.arguments[0].value)
        return n.Call(n.Name(f"{kind}_{name}"), call.arguments)

    def _type(self, value: n.Expression) -> str:
        if isinstance(value, n.Literal):
            return "REAL" if REAL_LITERAL.fullmatch(value.text) else "DINT" if value.text.isdigit() else ""
        found = self.resolver.type_of(value, self.piece.site)
        return found.name.value if isinstance(found, ElementaryType) else ""


_POINTLESS = re.compile(r"^(?:L?REAL#)?[+-]?\d[\d_]*(?=[eE][+-]?\d)|^L?REAL#[+-]?\d[\d_]*$", re.IGNORECASE)
_LINE_FEED = re.compile(r"\$(.)")
_LATIN_1 = 255
_LONG = re.compile(r"(?:LTIME|LT|LD|LDATE|LTOD|LDT|LTIME_OF_DAY|LDATE_AND_TIME|W?CHAR|WSTRING)#|\"", re.IGNORECASE)
_BIT = re.compile(r"%?[XBWDL]?\d+", re.IGNORECASE)
_CONVERSION = re.compile(r"TO_(?:[SDL]?INT|U[SDL]?INT|L?REAL|BOOL|BYTE|[DL]?WORD|TIME|STRING)")
