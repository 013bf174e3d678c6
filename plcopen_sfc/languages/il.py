"""Instruction list, line by line: ``label: OPERATOR operand, operand`` (IEC 61131-3 ed. 3, 7.2).

Operands are expressions of structured text. Calls may go on over several lines, up to the closing parenthesis.

Instructions that only compute a value become an expression, those of a body statements, for tools that have no
instruction list. The current result is an expression that is written where it is stored or asked for. So it must still
mean the same there: what it reads may not have been written since it was computed, unless it is what was stored last.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.st import names_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import Token, tokenize
from plcopen_sfc.languages.st.nodes import Expression, Operator, Span
from plcopen_sfc.languages.st.parsing import Parsed, parse_expression
from plcopen_sfc.model.dialect import Dialect

JUMPS = frozenset({"JMP", "JMPC", "JMPCN"})
"""Operators whose operand is a label."""

OPERATORS = JUMPS | frozenset(
    """
    LD LDN ST STN STQ S R AND ANDN OR ORN XOR XORN NOT ADD SUB MUL DIV MOD GT GE EQ NE LE LT CAL CALC CALCN RET RETC
    RETCN
    """.split()
)
"""The operators of IEC 61131-3 (table 68) and CODESYS. Any other word at their place is the name of a function."""

CALLS = frozenset({"CAL", "CALC", "CALCN"})
"""Operators that call a function block."""

STORING = frozenset({"ST", "STN", "STQ", "S", "R"})
"""Operators that write their operand."""

LOGIC = {"AND": Operator.AND, "&": Operator.AND, "OR": Operator.OR, "XOR": Operator.XOR}
ARITHMETIC = {
    "ADD": Operator.ADD,
    "SUB": Operator.SUBTRACT,
    "MUL": Operator.MULTIPLY,
    "DIV": Operator.DIVIDE,
    "MOD": Operator.MODULO,
}
COMPARISONS = {
    "GT": Operator.GREATER,
    "GE": Operator.GREATER_OR_EQUAL,
    "EQ": Operator.EQUAL,
    "NE": Operator.UNEQUAL,
    "LE": Operator.LESS_OR_EQUAL,
    "LT": Operator.LESS,
}
"""Effect of operators on their operand and the current result."""

_SYMBOLS = frozenset({"OPERATOR", "NOT", "RPAR"})


@dataclass(frozen=True, slots=True)
class Operand:
    """An operand: its tree, whose spans count from `start` in the text of the body."""

    parsed: Parsed[Expression]
    start: int


@dataclass(frozen=True, slots=True)
class Instruction:
    """One instruction. `operator` is as written and may be empty: a label can be alone.

    `opens`: its operand goes on over several lines (``AND( ..``).
    """

    operator: str
    operator_span: Span
    operands: tuple[Operand, ...] = ()
    label: str = ""
    opens: bool = False

    @property
    def is_function(self) -> bool:
        """True if `operator` names a function."""
        word = self.operator.upper()
        return bool(word) and (word[0].isalpha() or word[0] == "_") and word not in OPERATORS


def is_il(tokens: list[Token]) -> bool:
    """True if these are instructions: no semicolon, and an operator at the start, perhaps behind a label."""
    first = 2 if len(tokens) > 2 and tokens[0].type == "NAME" and tokens[1].type == "COLON" else 0
    if first >= len(tokens) or tokens[first].value.upper() not in OPERATORS:
        return False
    if first + 1 < len(tokens) and tokens[first + 1].type in ("ASSIGN", "DOT", "LSQB"):
        return False
    return all(token.type != "SEMICOLON" for token in tokens)


def instructions(text: str, dialect: Dialect = Dialect.IEC) -> Iterator[Instruction]:
    """Yield the instructions of a body. Never raises: what is no instruction becomes operands with problems."""
    for line in _lines(text, tokenize(text, dialect).tokens):
        yield _instruction(text, line, dialect)


def _lines(text: str, tokens: list[Token]) -> Iterator[list[Token]]:
    """Yield the tokens of each instruction: those of a line, and further lines inside the parentheses of a call."""
    place = Lines(text).place
    line: list[Token] = []
    number = depth = 0
    for token in tokens:
        own, _ = place(token.span[0])
        if line and own != number and depth <= 0:
            yield line
            line, depth = [], 0
        number = own
        line.append(token)
        if _is_call(line):
            depth += (token.type == "LPAR") - (token.type == "RPAR")
    if line:
        yield line


def _is_call(line: list[Token]) -> bool:
    words = [token.value.upper() for token in line[:3]]
    return words[0] in CALLS or (len(words) == 3 and words[1] == ":" and words[2] in CALLS)


def _instruction(text: str, line: list[Token], dialect: Dialect) -> Instruction:
    label = ""
    if len(line) > 1 and line[0].type == "NAME" and line[1].type == "COLON":
        label = line[0].value
        line = line[2:]
    if not line:
        return Instruction("", (0, 0), label=label)
    first, rest = line[0], line[1:]
    span = first.span
    if first.type not in _SYMBOLS and not (first.value[0].isalpha() or first.value[0] == "_"):
        return Instruction("", first.span, tuple(_operands(text, line, dialect)), label)
    if rest and first.value == "&" and rest[0].value.upper() == "N" and rest[0].span[0] == first.span[1]:
        span = (first.span[0], rest[0].span[1])
        rest = rest[1:]
    opens = bool(rest) and rest[0].type == "LPAR" and not _closes(rest)
    if opens:
        rest = rest[1:]  # AND( .. up to a line with the closing parenthesis
    return Instruction(text[span[0] : span[1]], span, tuple(_operands(text, rest, dialect)), label, opens)


def _closes(tokens: list[Token]) -> bool:
    return sum((token.type == "LPAR") - (token.type == "RPAR") for token in tokens) == 0


def _operands(text: str, tokens: list[Token], dialect: Dialect) -> Iterator[Operand]:
    """Yield the operands between commas outside of parentheses."""
    depth = 0
    commas = [-1]
    for index, token in enumerate(tokens):
        depth += (token.type in ("LPAR", "LSQB")) - (token.type in ("RPAR", "RSQB"))
        if token.type == "COMMA" and depth == 0:
            commas.append(index)
    for before, comma in pairwise([*commas, len(tokens)]):
        own = [token for token in tokens[before + 1 : comma] if token.type != "SEMICOLON"]
        if own:
            start, end = own[0].span[0], own[-1].span[1]
            yield Operand(parse_expression(text[start:end], dialect), start)


_OPERATORS = {**LOGIC, **ARITHMETIC, **COMPARISONS}


def result_expression(text: str, dialect: Dialect, *, stored_in: str = "") -> n.Expression | None:
    """Return the Boolean result behind the last instruction; None where there are calls, stores or jumps back.

    `stored_in`: the last instruction of a way may store the result in this. Ways on from a conditional jump are joined:
    ``c AND .. OR NOT c AND ..``.
    """
    found = tuple(instructions(text, dialect))
    return _Result(found, stored_in).behind(0, CurrentResult()) if found else None


def statements_with_result(
    text: str, dialect: Dialect, *, stored_in: str = ""
) -> tuple[tuple[n.Statement, ...], n.Expression] | None:
    """Return the effects of instructions without jumps, such as calls, and their result; None where that is not known.

    `stored_in`: the last instruction may store the result in this.
    """
    found = [each for each in instructions(text, dialect) if each.operator or each.label or each.operands]
    if found and found[-1].operator.upper() == "ST" and _read_names(found[-1], stored_in):
        found.pop()
    done: list[n.Statement] = []
    result = CurrentResult()
    following = _Following(result, done)
    for each in found:
        if each.label or each.operator.upper() in JUMPS | _RETURNS or not following.follow(each):
            return None
    return (tuple(done), result.current) if result.current is not None and not result.waiting else None


_MOST_WAYS = 32
"""Number of ways through a list that are joined to one expression: each jump can double its size."""


class _Result:
    """Result of instructions that jump forward only, as an expression."""

    def __init__(self, found: tuple[Instruction, ...], stored_in: str) -> None:
        self._instructions, self._stored_in = found, stored_in
        self._jumps = _Statements(found, among_others=True)
        self._ways = 0

    def behind(self, place: int, result: CurrentResult) -> n.Expression | None:
        """Return the result at the end of a way that goes on at an instruction."""
        self._ways += 1
        if self._ways > _MOST_WAYS:
            return None
        for here in range(place, self._jumps.end):
            instruction, target = self._instructions[here], self._jumps.targets[here]
            if target is None:
                ends = self._is_end(here) and _read_names(instruction, self._stored_in)
                if instruction.operator.upper() == "ST" and ends:
                    break
                if instruction.operator and not result.take(replace(instruction, label="")):
                    return None
                continue
            if result.waiting or target <= here:
                return None
            word = instruction.operator.upper()
            # a way that was jumped to must load: tools do not agree on the result that a jump leaves
            if word == "JMP":
                return self._arriving(target, result)
            if word == "RET":
                break
            if result.current is None:
                return None
            jumping, going_on = self._arriving(target, result), self.behind(here + 1, result.copy())
            if jumping is None or going_on is None:
                return None
            leaps, stays = result.current, negated(result.current)
            if word.endswith("N"):
                leaps, stays = stays, leaps
            if jumping is result.current:  # it ends with what it was decided by
                return n.Operation(Operator.AND if word.endswith("N") else Operator.OR, (jumping, going_on))
            ways = (n.Operation(Operator.AND, (leaps, jumping)), n.Operation(Operator.AND, (stays, going_on)))
            return n.Operation(Operator.OR, ways)
        return result.current if not result.waiting else None

    def _arriving(self, target: int, result: CurrentResult) -> n.Expression | None:
        """Return the result of the way from a target on; at the end it is that of the jump."""
        return result.current if self._is_behind_all(target) else self.behind(target, CurrentResult())

    def _is_behind_all(self, place: int) -> bool:
        return not any(each.operator for each in self._instructions[place:])

    def _is_end(self, place: int) -> bool:
        """Return True if nothing follows an instruction on its way."""
        if self._is_behind_all(place + 1):
            return True
        word, target = self._instructions[place + 1].operator.upper(), self._jumps.targets[place + 1]
        return word == "RET" or (word == "JMP" and target is not None and self._is_behind_all(target))


def _read_names(store: Instruction, name: str) -> bool:
    trees = [operand.parsed.tree for operand in store.operands]
    return len(trees) == 1 and isinstance(trees[0], n.Name) and trees[0].identifier.casefold() == name.casefold()


class CurrentResult:
    """The current result of instructions, and the operations whose operands in parentheses are not closed yet."""

    def __init__(self) -> None:
        self.current: n.Expression | None = None
        self.waiting: list[tuple[str, n.Expression]] = []

    def copy(self) -> CurrentResult:
        """Return the same, to be followed on another way."""
        found = CurrentResult()
        found.current, found.waiting = self.current, [*self.waiting]
        return found

    def forget(self) -> None:
        """Forget the result, where the way that led here is not known."""
        self.current = None

    def take(self, instruction: Instruction) -> bool:
        """Follow an instruction; False if it is one that no expression has."""
        word = instruction.operator.upper()
        trees = [operand.parsed.tree for operand in instruction.operands]
        if instruction.label or any(operand.parsed.problems for operand in instruction.operands):
            return False
        if word in ("LD", "LDN") and len(trees) == 1:
            self.current = negated(trees[0]) if word == "LDN" else trees[0]
            return True
        if self.current is None:
            return False
        if word == "NOT" and not trees:
            self.current = negated(self.current)
        elif word == ")" and self.waiting:
            operator, before = self.waiting.pop()
            self.current = _combined(operator, before, self.current)
        elif word in _OPERATORS or word.removesuffix("N") in LOGIC:
            if instruction.opens:
                self.waiting.append((word, self.current))
                self.current = trees[0] if trees else None
            else:
                for tree in trees:
                    self.current = _combined(word, self.current, tree)
        elif instruction.is_function:
            arguments = tuple(n.Argument(tree) for tree in (self.current, *trees))
            self.current = n.Call(n.Name(instruction.operator), arguments)
        else:
            return False
        return True


def _combined(word: str, left: n.Expression, right: n.Expression) -> n.Expression:
    if word not in _OPERATORS:
        word, right = word.removesuffix("N"), negated(right)
    return n.Operation(_OPERATORS[word], (left, right))


def negated(tree: n.Expression) -> n.Expression:
    """Return ``NOT tree``."""
    return n.Unary(Operator.NOT, tree)


_OF_BLOCKS = frozenset({"S1", "R1", "CLK", "CU", "CD", "PV", "IN", "PT"})
"""Operators that are inputs of a function block in IEC 61131-3 (ed. 2, table 54): another word is a function."""


def statements(text: str, dialect: Dialect, *, among_others: bool = False) -> n.Statements | None:
    """Return the statements that do what the instructions do; None where none are known, or loops have other jumps.

    `among_others`: other statements follow, so that RET must not leave them too.
    """
    found = _Statements(tuple(instructions(text, dialect)), among_others=among_others)
    done = found.run(0, found.end, CurrentResult())
    return n.Statements(tuple(done)) if done is not None else None


_RETURNS = frozenset({"RET", "RETC", "RETCN"})

_MOST_RUNS = 1_000
"""Number of ways through a list that are tried: each jump can double them."""


class _Statements:
    """Statements of instructions. Jumps forward become IF and ELSE, which end where both ways meet again; back, loops.

    A loop is left behind its jump back only: at that jump itself (REPEAT), or by one jump before it (WHILE).
    """

    def __init__(self, found: tuple[Instruction, ...], *, among_others: bool) -> None:
        self._instructions, self._among_others = found, among_others
        self.end = len(found)
        labels = {each.label.casefold(): place for place, each in enumerate(found) if each.label}
        self.targets = {place: self._target(each, labels) for place, each in enumerate(found)}
        self._backs: dict[int, list[int]] = {}
        """The jumps back to an instruction, the last one first: it is the end of the outermost loop."""
        for place, target in reversed(self.targets.items()):
            if target is not None and target <= place:
                self._backs.setdefault(target, []).append(place)
        self._tried = 0
        self._joins = sorted({place for place in self.targets.values() if place is not None} | {self.end})

    def _target(self, instruction: Instruction, labels: Mapping[str, int]) -> int | None:
        """Return where an instruction jumps to, -1 if that is not known; None if it does not jump."""
        word = instruction.operator.upper()
        if word in _RETURNS and self._among_others:
            return self.end
        if word not in JUMPS:
            return None
        trees = [operand.parsed.tree for operand in instruction.operands]
        match trees:
            case [n.Name(label)]:
                return labels.get(label.casefold(), -1)
        return -1

    def run(self, start: int, end: int, result: CurrentResult) -> list[n.Statement] | None:
        """Return the statements from an instruction on until `end`; None if they leave that otherwise."""
        done: list[n.Statement] = []
        place = start
        self._tried += 1
        while place < end and self._tried <= _MOST_RUNS:
            instruction, target = self._instructions[place], self.targets[place]
            back = next((each for each in self._backs.get(place, ()) if each < end), None)
            if back is not None:
                loop = self._loop(place, back) if not result.waiting else None
                if loop is None:
                    return None
                done.append(loop)
                place = back + 1
                result.forget()
                continue
            if target is None:
                if not _Following(result, done).follow(replace(instruction, label="")):
                    return None
                place += 1
                continue
            word = instruction.operator.upper()
            if result.waiting or not place < target <= end:
                return None
            if word in ("JMP", "RET"):
                place = target
                continue
            rest = self._parted(place, target, end, result)
            return [*done, *rest] if rest is not None else None
        return done if not result.waiting and self._tried <= _MOST_RUNS else None

    def _parted(self, place: int, target: int, end: int, result: CurrentResult) -> list[n.Statement] | None:
        """Return both ways on from a conditional jump, and what follows where they meet; None if they do not.

        They meet as early as what follows needs the result of neither; else each has the rest for itself.
        """
        if result.current is None:
            return None
        for meeting in (each for each in self._joins if target <= each <= end):
            going_on = self.run(place + 1, meeting, result.copy())
            jumping = self.run(target, meeting, CurrentResult()) if going_on is not None else None
            behind = CurrentResult()
            rest = self.run(meeting, end, behind) if jumping is not None else None
            if going_on is None or jumping is None or rest is None:
                continue
            leaps = result.current if not self._instructions[place].operator.upper().endswith("N") else None
            condition = leaps if leaps is not None else negated(result.current)
            if jumping:
                otherwise = tuple(going_on) or None
                rest = [n.If((n.Branch(condition, tuple(jumping)),), otherwise), *rest]
            elif going_on:
                stays = negated(result.current) if leaps is not None else result.current
                rest = [n.If((n.Branch(stays, tuple(going_on)),)), *rest]
            result.current, result.waiting = behind.current, behind.waiting
            return rest
        return None

    def _loop(self, first: int, back: int) -> n.Statement | None:
        """Return the instructions from `first` to a jump back to it as a loop; None if they are left otherwise."""
        decided = CurrentResult()
        word = self._instructions[back].operator.upper()
        if word != "JMP":
            body = self.run(first, back, decided)
            if not body or decided.current is None:
                return None
            return n.Repeat(tuple(body), decided.current if word.endswith("N") else negated(decided.current))
        leaving = next((each for each in range(first, back) if self.targets[each] == back + 1), None)
        if leaving is None or self._instructions[leaving].operator.upper() not in ("JMPC", "JMPCN"):
            return None
        before = self.run(first, leaving, decided)
        if before is None or decided.current is None:
            return None
        leaves, stays = decided.current, negated(decided.current)
        if self._instructions[leaving].operator.upper() == "JMPCN":
            leaves, stays = stays, leaves
        body = self.run(leaving + 1, back, decided)
        if body is None:
            return None
        if not before:
            return n.While(stays, tuple(body))
        ends = n.If((n.Branch(leaves, (n.Exit(),)),))
        return n.While(n.Literal("TRUE"), (*before, ends, *body))


class _Following:
    """Instructions without jumps, one after the other: `statements` are those so far."""

    def __init__(self, result: CurrentResult, statements: list[n.Statement]) -> None:
        self.result, self.statements = result, statements

    def follow(self, instruction: Instruction) -> bool:
        """Follow an instruction; False if it is one that no statement has."""
        word = instruction.operator.upper()
        trees = [operand.parsed.tree for operand in instruction.operands]
        if any(operand.parsed.problems for operand in instruction.operands):
            return False
        if not word and not trees:  # a label alone
            return True
        if word in ("ST", "STN", "S", "R"):
            return len(trees) == 1 and self._store(word, trees[0])
        if word in CALLS:
            return len(trees) == 1 and self._call(word, trees[0])
        if word in _RETURNS:
            return self._when(word.removeprefix("RET"), n.ReturnStatement())
        return word not in _OF_BLOCKS and self.result.take(instruction)

    def _store(self, word: str, target: n.Expression) -> bool:
        current = self.result.current
        if current is None:
            return False
        if word in ("S", "R"):
            value = n.Literal("TRUE" if word == "S" else "FALSE")
            stored = self._when("C", n.Assignment(target, value))
        else:
            self.statements.append(n.Assignment(target, negated(current) if word == "STN" else current))
            stored = True
        if names_of(target) & names_of(current):
            # what was stored is the result itself; after another write it would be computed from other values
            self.result.current = target if word == "ST" and isinstance(target, n.Name) else None
        return stored and self._outlives(names_of(target))

    def _call(self, word: str, call: n.Expression) -> bool:
        # ``CAL t``: structured text needs the parentheses, ``t();``, of an instance as of an action
        called = call if isinstance(call, n.Call) else n.Call(call, ())
        done = self._when(word.removeprefix("CAL"), n.CallStatement(called))
        if self.result.current is not None and names_of(call) & names_of(self.result.current):
            self.result.current = None
        return done and self._outlives(names_of(call))

    def _outlives(self, written: frozenset[str]) -> bool:
        """True if no operation that waits for its operand in parentheses reads what was written."""
        return not any(written & names_of(before) for _, before in self.result.waiting)

    def _when(self, suffix: str, statement: n.Statement) -> bool:
        """Write what happens always, or only if the current result is TRUE (C) or FALSE (CN)."""
        current = self.result.current
        if not suffix:
            self.statements.append(statement)
            return True
        if current is None:
            return False
        condition = current if suffix == "C" else negated(current)
        self.statements.append(n.If((n.Branch(condition, (statement,)),)))
        return True
