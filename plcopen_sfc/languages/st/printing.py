"""Text of trees that have none, and of edited ones: what did not change stays as it was written, comments too."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from typing import Any

from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import Comment, CommentKind
from plcopen_sfc.languages.st.nodes import Branch, Node, Operation, Operator, Span, Statement, Statements, Unary
from plcopen_sfc.languages.st.parsing import Parsed
from plcopen_sfc.languages.st.tree_building import ASSOCIATIVE, PRECEDENCE
from plcopen_sfc.languages.st.walking import parts, walk
from plcopen_sfc.languages.text_edits import Edit, apply_edits

INDENT = "    "

_UNARY = {Operator.NOT: "NOT ", Operator.NEGATE: "-", Operator.PLUS: "+"}


def print_node(node: Node) -> str:
    """Return the text of an expression or of statements. Parentheses are put where the tree needs them."""
    if type(node) is n.Name and node.quoting is n.Quoting.NONE:  # most of what drawings and code print
        return node.identifier
    return Printer().text(node)


def _nothing(_: Node) -> str | None:
    return None


def operands(node: n.Operation | n.Unary) -> tuple[n.Expression, ...]:
    """Return the operands of an operation, one or more."""
    return node.operands if isinstance(node, n.Operation) else (node.operand,)


def needs_parentheses(node: n.Operation | n.Unary, index: int) -> bool:
    """True if the operand at `index` needs parentheses, so that the text means the same as the tree."""
    operand = operands(node)[index]
    if isinstance(operand, n.AssignmentExpression):
        return True
    if isinstance(operand, n.Unary):
        return node.operator is Operator.POWER
    if not isinstance(operand, n.Operation):
        return False
    if isinstance(node, n.Unary):
        return True
    inner, outer = PRECEDENCE[operand.operator], PRECEDENCE[node.operator]
    if inner == outer:  # read from the left; in a row of AND, OR, XOR, + and * parentheses make a difference
        return index > 0 or (operand.operator is node.operator and node.operator in ASSOCIATIVE)
    return inner < outer


class Printer:
    """Prints nodes; `known` gives the text of those that have one already, which is left as it is."""

    def __init__(self, *, newline: str = "\n", known: Callable[[Node], str | None] = _nothing) -> None:
        self._newline = newline
        self._known = known

    def text(self, node: Node, indent: str = "") -> str:
        """Return the text of any node, without an indent before it and without a line end behind it."""
        known = self._known(node)
        if known is not None:
            return known
        expression = self._expression(node)
        if expression:  # most nodes are
            return expression
        match node:
            case n.Statements(statements):
                return self.lines(statements, indent).removeprefix(self._newline)
            case n.Argument():
                return self._argument(node)
            case n.Range(lower, upper):
                return f"{self.text(lower)}..{self.text(upper)}"
            case n.CaseBranch():
                return f"{self._listed(node.labels)}:{self.lines(node.statements, indent + INDENT)}"
            case n.Branch():
                return self._branch("ELSIF", node, indent).removesuffix(self._newline)
            case _:
                return self._statement(node, indent)

    # -- expressions

    def _expression(self, node: Node) -> str:
        match node:
            case n.Name(identifier, quoting):
                return quoting.value + identifier + ('"' if quoting.value.endswith('"') else "")
            case n.Literal(text) | n.Address(text) | n.Unreadable(text):
                return text
            case n.Member(base, name):
                return f"{self.text(base)}.{self.text(name)}"
            case n.Index(base, indices):
                return f"{self.text(base)}[{self._listed(indices)}]"
            case n.Dereference(base):
                return f"{self.text(base)}^"
            case n.Peripheral(base):
                return f"{self.text(base)}:P"
            case n.Call(callee, arguments):
                return f"{self.text(callee)}({self._listed(arguments)})"
            case n.Unary(operator):
                return _UNARY[operator] + self._operand(node, 0)
            case n.Operation():
                return f" {node.operator.value} ".join(self._operand(node, at) for at in range(len(node.operands)))
            case n.Parenthesized(inner):
                return f"({self.text(inner)})"
            case n.AssignmentExpression(target, value):
                return f"{self.text(target)} := {self.text(value)}"
            case n.TypeOperand(words, bounds, base):
                limits = f"[{self._listed(bounds)}] OF" if bounds else ""
                return f"{words}{limits} {self.text(base)}"
            case _:
                return ""

    def _operand(self, node: n.Operation | n.Unary, index: int) -> str:
        text = self.text(operands(node)[index])
        return f"({text})" if needs_parentheses(node, index) else text

    def _argument(self, node: n.Argument) -> str:
        value = "" if node.value is None else self.text(node.value)
        if node.name is None:
            return value
        sign = "=>" if node.output else ":="
        return f"{'NOT ' if node.negated else ''}{self.text(node.name)} {sign} {value}".rstrip()

    def _listed(self, nodes: Iterable[Node]) -> str:
        return ", ".join(
            f"({self.text(node)})" if isinstance(node, n.AssignmentExpression) else self.text(node) for node in nodes
        )

    # -- statements

    def _statement(self, node: Node, indent: str) -> str:
        match node:
            case n.Assignment(target, value, kind):
                return f"{self.text(target)} {kind.value} {self.text(value)};"
            case n.CallStatement(call):
                return f"{self.text(call)};"
            case n.If():
                return self._if(node, indent)
            case n.Case():
                return self._case(node, indent)
            case n.For(variable, start, end, step, statements):
                by = "" if step is None else f" BY {self.text(step)}"
                head = f"FOR {self.text(variable)} := {self.text(start)} TO {self.text(end)}{by} DO"
                return self._block(head, statements, "END_FOR;", indent)
            case n.While(condition, statements):
                return self._block(f"WHILE {self.text(condition)} DO", statements, "END_WHILE;", indent)
            case n.Repeat(statements, condition):
                until = f"UNTIL {self.text(condition)}{self._newline}{indent}END_REPEAT;"
                return self._block("REPEAT", statements, until, indent)
            case n.RegionBlock(title, statements):
                return self._block(f"REGION {title}".rstrip(), statements, "END_REGION", indent)
            case n.Try():
                return self._try(node, indent)
            case n.Exit():
                return "EXIT;"
            case n.Continue():
                return "CONTINUE;"
            case n.ReturnStatement(value):
                return "RETURN;" if value is None else f"RETURN {self.text(value)};"
            case n.Goto(label, keyword):
                return f"{keyword} {self.text(label)};"
            case n.LabelStatement(label):
                return f"{self.text(label)}:"
            case n.Empty():
                return ";"
            case n.Remark(text):
                return f"{self._newline}{indent}".join(f"// {line}".rstrip() for line in text.splitlines())
            case n.EmbeddedCode(text):
                return text
            case n.Unreadable(text):
                return text
            case _:
                raise TypeError(f"{type(node).__name__} is no node that can be printed")

    def lines(self, statements: Iterable[Statement], indent: str) -> str:
        """Return the lines of statements, each behind a line end."""
        text = ""
        for each in statements:
            if isinstance(each, n.Remark) and (each.beside or not each.text):
                text += f" // {each.text}" if each.beside else self._newline
            else:
                text += self._newline + indent + self.text(each, indent)
        return text

    def _block(self, head: str, statements: Iterable[Statement], end: str, indent: str) -> str:
        return f"{head}{self.lines(statements, indent + INDENT)}{self._newline}{indent}{end}"

    def _if(self, node: n.If, indent: str) -> str:
        text = ""
        for word, branch in zip(("IF", *["ELSIF"] * len(node.branches)), node.branches, strict=False):
            known = self._known(branch)
            if known is not None and known[: len(word)].upper() == word:
                printed = known + self._newline
            else:
                printed = self._branch(word, branch, indent)
            text += (indent if text else "") + printed
        return text + self._otherwise(node.otherwise, indent) + f"{indent}END_IF;"

    def _branch(self, word: str, node: n.Branch, indent: str) -> str:
        above, below = _remarks_above(node.statements)
        head = self.lines((*above,), indent).removeprefix(self._newline + indent)
        head += f"{self._newline}{indent}" if above else ""
        return f"{head}{word} {self.text(node.condition)} THEN{self.lines(below, indent + INDENT)}{self._newline}"

    def _case(self, node: n.Case, indent: str) -> str:
        text = f"CASE {self.text(node.selector)} OF{self._newline}"
        deeper = indent + INDENT
        for branch in node.branches:
            text += f"{deeper}{self.text(branch, deeper)}{self._newline}"
        return text + self._otherwise(node.otherwise, indent) + f"{indent}END_CASE;"

    def _otherwise(self, statements: tuple[Statement, ...] | None, indent: str) -> str:
        if statements is None:
            return ""
        above, below = _remarks_above(statements)
        head = self.lines((*above,), indent).removeprefix(self._newline)
        head += self._newline if above else ""
        return f"{head}{indent}ELSE{self.lines(below, indent + INDENT)}{self._newline}"

    def _try(self, node: n.Try, indent: str) -> str:
        deeper = indent + INDENT
        text = f"__TRY{self.lines(node.statements, deeper)}{self._newline}"
        if node.handler is not None:
            error = "" if node.error is None else f"({self.text(node.error)})"
            text += f"{indent}__CATCH{error}{self.lines(node.handler, deeper)}{self._newline}"
        if node.finally_ is not None:
            text += f"{indent}__FINALLY{self.lines(node.finally_, deeper)}{self._newline}"
        return f"{text}{indent}__ENDTRY"


def _remarks_above(statements: Sequence[Statement]) -> tuple[Sequence[Statement], Sequence[Statement]]:
    """Return the comments that are printed above the condition of a branch, and its statements without them."""
    below = (place for place, each in enumerate(statements) if not isinstance(each, n.Remark) or each.beside)
    start = next(below, len(statements))
    return statements[:start], statements[start:]


def render(parsed: Parsed[Any], tree: Node) -> str:
    """Return the text of `tree`, which was made from `parsed.tree`.

    Of the unedited tree it is `parsed.text` exactly.
    """
    return apply_edits(parsed.text, tree_edits(parsed, tree))


def tree_edits(parsed: Parsed[Any], tree: Node) -> list[Edit]:
    """Return the edits that make `parsed.text` the text of `tree`."""
    return [] if tree is parsed.tree else _Comparison(parsed).edits(parsed.tree, tree)


_STATEMENTS = frozenset({"statements", "otherwise", "handler", "finally_"})


def _are_separate(name: str, before: tuple[Any, ...], after: tuple[Any, ...]) -> bool:
    """True if members of the list `name` can be taken out and put in: statements, and branches but the first."""
    return name in _STATEMENTS or (name == "branches" and before[:1] == after[:1])


class _Comparison:
    def __init__(self, parsed: Parsed[Any]) -> None:
        self._text = parsed.text
        self._comments = parsed.comments
        self._comment_starts = [comment.span[0] for comment in parsed.comments]
        self._lines = Lines(parsed.text)
        self._old = {id(node): node for node in walk(parsed.tree)}
        self._by_place = {(type(node), node.span): node for node in self._old.values()}
        self._used: list[Span] = []
        self._printed_anew: set[int] = set()
        newline = "\r\n" if "\r\n" in parsed.text else "\n"
        self._newline = newline
        self._printer = Printer(newline=newline, known=self._written)

    def _written(self, node: Node) -> str | None:
        """The text of a node that has some: of one that was edited with the edits made, so that its layout stays."""
        old = self._old.get(id(node)) or self._by_place.get((type(node), node.span))
        if old is None or old.span is None or id(node) in self._printed_anew:
            return None
        start, end = old.span
        self._used.append(old.span)
        edits = (Edit(first - start, last - start, new) for first, last, new in self.edits(old, node))
        return apply_edits(self._text[start:end], edits)

    def edits(self, old: Node, new: Node) -> list[Edit]:
        """Return the edits that make `new` of `old`."""
        if old is new:
            return []
        if type(old) is not type(new):
            return [self._replaced(old, new)]
        if isinstance(old, Operation | Unary) and isinstance(new, Operation | Unary):
            return self._operation_edits(old, new)
        found: list[Edit] = []
        for name in parts(type(old)):
            before, after = getattr(old, name), getattr(new, name)
            if before is after:
                continue
            if isinstance(before, Node) and isinstance(after, Node):
                found += self.edits(before, after)
            elif isinstance(before, tuple) and isinstance(after, tuple):
                inner = self._list_edits(before, after, separate=_are_separate(name, before, after))
                if inner is None:
                    return [self._replaced(old, new)]
                found += inner
            elif before != after:
                return [self._replaced(old, new)]
        return found

    def _operation_edits(self, old: Operation | Unary, new: Operation | Unary) -> list[Edit]:
        """As `edits`: what is new among the operands gets parentheses where it needs them."""
        before, after = operands(old), operands(new)
        if old.operator is not new.operator or len(before) != len(after):
            return [self._replaced(old, new)]
        found: list[Edit] = []
        for index, (a, b) in enumerate(zip(before, after, strict=True)):
            edits = self.edits(a, b)
            if edits and needs_parentheses(new, index):
                start, end, text = self._replaced(a, b)
                edits = [Edit(start, end, f"({text})")]
            found += edits
        return found

    def _replaced(self, old: Node, new: Node) -> Edit:
        start, end = old.span or (0, len(self._text))
        if isinstance(new, Statements):  # there were no statements, but perhaps comments
            before = self._newline if self._text.strip() and not self._text.endswith(("\n", "\r")) else ""
            return Edit(end, end, before + self._printer.text(new))
        indent = self._indent_at(start)
        used, self._used = self._used, []
        if id(new) not in self._old:
            self._printed_anew.add(id(new))
        text = self._printer.text(new, indent)
        if isinstance(new, Branch) and not self._text[start:end].upper().startswith("ELSIF"):
            text = text.removeprefix("ELS")  # a branch by itself is printed as one that is not the first
        text = self._lost_comments(start, end, indent) + text
        if text.startswith("/*") and self._text[:start].endswith("("):
            text = f" {text}"  # (/* starts a comment of SCL
        self._used = used
        return Edit(start, end, text)

    def _lost_comments(self, start: int, end: int, indent: str) -> str:
        """The comments from `start` to `end` that no part used again contains: they move before what is new there."""
        text = ""
        for comment in self._comments_from(start):
            first, last = comment.span
            if first >= end:
                break
            if last <= end and not any(a <= first and last <= b for a, b in self._used):
                text += comment.text + (f"{self._newline}{indent}" if comment.kind is CommentKind.LINE else " ")
        return text

    def _comments_from(self, offset: int) -> Iterator[Comment]:
        """Return the comments that start at `offset` or behind it."""
        return map(self._comments.__getitem__, range(bisect_left(self._comment_starts, offset), len(self._comments)))

    def _indent_at(self, offset: int) -> str:
        """Return the spaces at the start of the line that `offset` is in."""
        _, column = self._lines.place(offset)
        line = offset - column + 1
        found = re.compile(r"[ \t]*").match(self._text, line)
        return found.group() if found is not None else ""

    def _list_edits(self, old: tuple[Any, ...], new: tuple[Any, ...], *, separate: bool) -> list[Edit] | None:
        """Return the edits between two lists of nodes; None where the list has to be written again with its node.

        `separate`: see `_are_separate`.
        """
        same = 0
        while same < min(len(old), len(new)) and old[same] is new[same]:
            same += 1
        tail = 0
        while tail < min(len(old), len(new)) - same and old[-1 - tail] is new[-1 - tail]:
            tail += 1
        gone, come = old[same : len(old) - tail], new[same : len(new) - tail]
        if len(gone) == len(come):
            return [edit for a, b in zip(gone, come, strict=True) for edit in self.edits(a, b)]
        if not separate or not old:
            return None
        paired = min(len(gone), len(come))
        found = [edit for a, b in zip(gone[:paired], come[:paired], strict=True) for edit in self.edits(a, b)]
        found += [self._removed(node) for node in gone[paired:]]
        if come[paired:]:
            found.append(self._inserted(come[paired:], old, same + paired))
        return found

    def _removed(self, node: Node) -> Edit:
        """Takes a statement out, with its line where nothing else is in it."""
        start, end = node.span or (0, 0)
        before = re.compile(r"(?:^|(?<=[\r\n]))[ \t]*\Z").search(self._text[:start])
        after = re.compile(r"[ \t]*(\r\n|\r|\n|\Z)").match(self._text, end)
        if before is not None and after is not None:
            return Edit(before.start(), after.end(), "")
        return Edit(start, end, "")

    def _inserted(self, nodes: tuple[Any, ...], old: tuple[Any, ...], index: int) -> Edit:
        """Puts statements behind the one before them, or before the one behind them, each in a line of its own."""
        neighbour: Node = old[index - 1] if index else old[0]
        start, end = neighbour.span or (0, 0)
        indent = self._indent_at(start)
        texts = [self._printer.text(node, indent) for node in nodes]
        if index:
            end = self._end_with_comment(end)
            text = "".join(f"{self._newline}{indent}{text}" for text in texts)
            if self._text[end : end + 1].strip():  # what follows at once would become a part of it
                text += f"{self._newline}{indent}"
            return Edit(end, end, text)
        return Edit(start, start, "".join(f"{text}{self._newline}{indent}" for text in texts))

    def _end_with_comment(self, end: int) -> int:
        """`end`, or the end of the comment that follows it in its line."""
        for comment in islice(self._comments_from(end), 1):
            same_line = not self._text[end : comment.span[0]].strip(" \t") and not re.search(r"[\r\n]", comment.text)
            if same_line and comment.kind is not CommentKind.PRAGMA:
                return comment.span[1]
        return end
