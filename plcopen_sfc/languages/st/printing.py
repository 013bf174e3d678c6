"""Text of trees that have none, or no longer all of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.builder import ASSOCIATIVE, PRECEDENCE
from plcopen_sfc.languages.st.nodes import Node, Operator, Statement

INDENT = "    "

_UNARY = {Operator.NOT: "NOT ", Operator.NEGATE: "-", Operator.PLUS: "+"}


def print_node(node: Node, dialect: Dialect = Dialect.IEC, *, newline: str = "\n") -> str:
    """The text of an expression or of statements. Puts parentheses where the tree needs them to mean what it says."""
    return Printer(dialect, newline=newline).text(node)


def _nothing(_: Node) -> str | None:
    return None


def operands(node: n.Operation | n.Unary) -> tuple[n.Expression, ...]:
    """The operands of an operation, one or more."""
    return node.operands if isinstance(node, n.Operation) else (node.operand,)


def needs_parentheses(node: n.Operation | n.Unary, index: int) -> bool:
    """True if the operand at `index` has to stand in parentheses, so that the text means what the tree says."""
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

    def __init__(
        self, dialect: Dialect, *, newline: str = "\n", known: Callable[[Node], str | None] = _nothing
    ) -> None:
        self._codesys = dialect in (Dialect.CODESYS, Dialect.TWINCAT)
        self._newline = newline
        self._known = known

    def text(self, node: Node, indent: str = "") -> str:
        """The text of any node, without an indent before it and without a line end behind it."""
        known = self._known(node)
        if known is not None:
            return known
        match node:
            case n.Statements(statements):
                return self._newline.join(indent + self.text(statement, indent) for statement in statements)
            case n.Argument():
                return self._argument(node)
            case n.Range(lower, upper):
                return f"{self.text(lower)}..{self.text(upper)}"
            case n.CaseBranch():
                return self._case_branch(node, indent)
            case n.Branch():
                return self._branch("ELSIF", node, indent).removesuffix(self._newline)
            case _:
                return self._statement(node, indent) or self._expression(node)

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
                return self._operation(node)
            case n.Parenthesized(inner):
                return f"({self.text(inner)})"
            case n.AssignmentExpression(target, value):
                return f"{self.text(target)} := {self.text(value)}"
            case n.TypeOperand(words, bounds, base):
                limits = f"[{self._listed(bounds)}] OF" if bounds else ""
                return f"{words}{limits} {self.text(base)}"
            case _:
                raise TypeError(f"{type(node).__name__} is no node that can be printed")

    def _operation(self, node: n.Operation) -> str:
        return f" {node.operator.value} ".join(self._operand(node, index) for index in range(len(node.operands)))

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
            case n.Region(title, statements):
                return self._block(f"REGION {title}".rstrip(), statements, "END_REGION", indent)
            case n.Try():
                return self._try(node, indent)
            case n.Exit():
                return "EXIT;"
            case n.Continue():
                return "CONTINUE;"
            case n.Return(value):
                return "RETURN;" if value is None else f"RETURN {self.text(value)};"
            case n.Goto(label, keyword):
                return f"{keyword} {self.text(label)};"
            case n.Label(label):
                return f"{self.text(label)}:"
            case n.Empty():
                return ";"
            case n.EmbeddedCode(text):
                return text
            case _:
                return ""

    def _below(self, statements: Iterable[Statement], indent: str) -> str:
        deeper = indent + INDENT
        return "".join(f"{deeper}{self.text(statement, deeper)}{self._newline}" for statement in statements)

    def _block(self, head: str, statements: Iterable[Statement], end: str, indent: str) -> str:
        return f"{head}{self._newline}{self._below(statements, indent)}{indent}{end}"

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
        return f"{word} {self.text(node.condition)} THEN{self._newline}{self._below(node.statements, indent)}"

    def _case(self, node: n.Case, indent: str) -> str:
        text = f"CASE {self.text(node.selector)} OF{self._newline}"
        deeper = indent + INDENT
        for branch in node.branches:
            text += f"{deeper}{self.text(branch, deeper)}{self._newline}"
        return text + self._otherwise(node.otherwise, indent) + f"{indent}END_CASE;"

    def _case_branch(self, node: n.CaseBranch, indent: str) -> str:
        labels = f"{self._listed(node.labels)}:"
        return self._newline.join([labels, *self._below(node.statements, indent).split(self._newline)[:-1]])

    def _otherwise(self, statements: tuple[Statement, ...] | None, indent: str) -> str:
        return "" if statements is None else f"{indent}ELSE{self._newline}{self._below(statements, indent)}"

    def _try(self, node: n.Try, indent: str) -> str:
        text = f"__TRY{self._newline}{self._below(node.statements, indent)}"
        if node.handler is not None:
            error = "" if node.error is None else f"({self.text(node.error)})"
            text += f"{indent}__CATCH{error}{self._newline}{self._below(node.handler, indent)}"
        if node.finally_ is not None:
            text += f"{indent}__FINALLY{self._newline}{self._below(node.finally_, indent)}"
        return f"{text}{indent}__ENDTRY"
