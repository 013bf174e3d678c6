"""Translation of instruction list (ed. 3, 7.2): the current result is kept in a variable of Python.

Its type is known at each instruction: behind a label it is that which it has at the jumps to it that come before
it, and at the end of the instructions before it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.il import ARITHMETIC, COMPARISONS, LOGIC, Instruction, instructions
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.expressions import Translator
from plcopen_sfc.semantics.programs.operators import Operators
from plcopen_sfc.semantics.programs.statements import StatementTranslator
from plcopen_sfc.semantics.programs.value_code import Code, ranged, settled, truth

_RESULT = "_cr"
_COMBINING = {*LOGIC, *ARITHMETIC, *COMPARISONS}


@dataclass(frozen=True, slots=True)
class _Open:
    """An operation whose operand is in parentheses over several lines: ``AND(``."""

    operator: str
    negated: bool
    before: Code


class InstructionTranslator:
    """Writes the instructions of a body, with the jumps, marks and calls of `statements`."""

    def __init__(self, translator: Translator, statements: StatementTranslator) -> None:
        self._translator = translator
        self._statements = statements
        self._writer = translator.writer
        self._operators = Operators(translator)
        self._result: Code | None = None
        self._open: list[_Open] = []
        self._behind: list[Instruction] = []
        self._at_labels: dict[str, list[Code]] = {}

    def body(self, text: str) -> None:
        """Write all instructions. An untranslatable one becomes an error when the body is executed."""
        self._statements.enter("")
        mark = self._writer.mark()
        try:
            self._instructions(text)
        except SimulationError as error:
            self._writer.rollback(mark)
            self._statements.fail(error, at_line=True)

    def _instructions(self, text: str) -> None:
        lines = Lines(text)
        labels: list[str] = []
        parts: list[list[Instruction]] = [[]]
        for instruction in instructions(text, self._translator.library.dialect):
            if instruction.label:
                labels.append(instruction.label)
                parts.append([])
            if instruction.operator or instruction.operands:
                parts[-1].append(instruction)

        self._statements.parts(
            labels, [partial(self._part, label, part, lines) for label, part in zip(["", *labels], parts, strict=True)]
        )

    def _part(self, label: str, part: list[Instruction], lines: Lines) -> None:
        coming = self._at_labels.get(label.casefold(), [])
        if self._result is not None:
            coming = [*coming, self._result]
        self._result = self._merged(coming)
        self._open.clear()
        for place, instruction in enumerate(part, 1):
            self._writer.origin = lines.place(instruction.operator_span[0])[0]
            self._behind = part[place:]
            self._one(instruction)

    def _one(self, instruction: Instruction) -> None:
        """Translate an instruction (ed. 3, table 68). Raises `SimulationError` for an unknown one.

        `_result` is None where nothing was loaded yet, or where no way leads to.
        """
        word = instruction.operator.upper()
        trees: list[n.Expression] = []
        for operand in instruction.operands:
            if operand.parsed.problems:
                raise SimulationError(operand.parsed.problems[0].message)
            trees.append(operand.parsed.tree)
        base = word.removesuffix("N")
        if word in ("LD", "LDN"):
            self._load(self._value(trees, word == "LDN", self._wanted(trees)))
        elif word in ("ST", "STN"):
            self._store(trees, negated=word == "STN")
        elif word in ("S", "R"):
            with self._writer.block(f"if {truth(self._current()).text}:"):
                place = self._translator.place(self._operand(trees), t.BOOL)
                self._translator.note_write(place)
                self._statements.note(f"{word} {place.path}")
                self._translator.write(place, Code(repr(word == "S"), t.BOOL))
        elif word == "NOT":
            self._load(self._operators.inverted(self._current()))
        elif word in _COMBINING or base in ("AND", "OR", "XOR", "&"):
            operator = word if word in _COMBINING else base
            self._combine(operator, trees, negated=operator != word, opens=instruction.opens)
        elif word == ")":
            self._close()
        elif word in ("JMP", "JMPC", "JMPCN"):
            label = self._operand(trees)
            if not isinstance(label, n.Name):
                raise SimulationError("what a jump leads to is no label")
            # the current result is that of the label too; behind a JMP without condition there is none
            if self._result is not None:
                self._at_labels.setdefault(label.identifier.casefold(), []).append(self._result)
            self._when(word.removeprefix("JMP"), lambda: self._statements.goto(label.identifier))
            if word == "JMP":
                self._result = None
        elif word in ("RET", "RETC", "RETCN"):
            self._when(word.removeprefix("RET"), lambda: self._writer.write("return"))
            if word == "RET":
                self._result = None
        elif word in ("CAL", "CALC", "CALCN"):
            call = self._operand(trees)
            self._when(word.removeprefix("CAL"), lambda: self._statements.call(call))
        elif instruction.is_function:
            self._function(instruction.operator, trees)
        else:
            raise SimulationError(f"{instruction.operator or 'this'} is no instruction that the simulator knows")

    def _wanted(self, trees: list[n.Expression]) -> t.Type | None:
        """The type of what is loaded: 0 and 1 are Booleans, or numbers where the instructions behind them calculate."""
        if len(trees) != 1 or not isinstance(trees[0], n.Literal) or trees[0].text not in ("0", "1"):
            return t.BOOL
        for instruction in self._behind:
            word = instruction.operator.upper()
            operands = [operand.parsed.tree for operand in instruction.operands if not operand.parsed.problems]
            if instruction.is_function:
                return None
            if word not in (*_COMBINING, "ANDN", "ORN", "XORN", "&N", "LD", "ST") or not operands:
                return None if word in (*ARITHMETIC, *COMPARISONS) else t.BOOL
            is_bare = isinstance(operands[0], n.Literal) and operands[0].text in ("0", "1")
            if not is_bare or word in ARITHMETIC or word in COMPARISONS:
                return self._operators.known_type(operands[0])
        return t.BOOL

    def _merged(self, results: list[Code]) -> Code | None:
        """Return the current result where several ways meet."""
        types = [code.type for code in results if isinstance(code.type, t.ScalarType)]
        if not types or len(types) < len(results):
            return None
        widest = max(types, key=lambda type_: type_.bits)
        if any(type_.is_number != widest.is_number for type_ in types):
            return None
        return ranged(_RESULT, widest)

    def _operand(self, trees: list[n.Expression]) -> n.Expression:
        if len(trees) != 1:
            raise SimulationError("the instruction wants one operand")
        return trees[0]

    def _value(self, trees: list[n.Expression], negated: bool, expected: t.Type | None = t.BOOL) -> Code:
        code = self._translator.value(self._operand(trees), expected)
        return self._operators.inverted(code) if negated else code

    def _current(self) -> Code:
        if self._result is None:
            raise SimulationError("the current result is used before it is loaded")
        return self._result

    def _load(self, code: Code) -> None:
        """Make a value the current result."""
        code = settled(code)
        self._writer.write(f"{_RESULT} = {code.text}")
        self._result = Code(_RESULT, code.type, code.low, code.high)

    def _store(self, trees: list[n.Expression], *, negated: bool) -> None:
        current = self._current()
        place = self._translator.place(self._operand(trees), current.type)
        self._translator.note_write(place)
        self._statements.note(f"ST {place.path}")
        value = self._operators.inverted(current) if negated else current
        self._translator.write(place, settled(self._translator.fitted(value, place.type)))

    def _combine(self, operator: str, trees: list[n.Expression], *, negated: bool, opens: bool) -> None:
        current = self._current()
        if opens:
            name = self._writer.temporary()
            self._writer.write(f"{name} = {current.text}")
            self._open.append(_Open(operator, negated, replace(current, text=name)))
            self._result = None
            if trees:
                self._load(self._value(trees, negated=False, expected=current.type))
            return
        for tree in trees:
            self._load(self._combined(operator, self._current(), self._value([tree], negated, current.type)))

    def _close(self) -> None:
        if not self._open:
            raise SimulationError("a parenthesis is closed that was not opened")
        opened = self._open.pop()
        operand = self._current()
        operand = self._operators.inverted(operand) if opened.negated else operand
        self._load(self._combined(opened.operator, opened.before, operand))

    def _combined(self, operator: str, left: Code, right: Code) -> Code:
        if operator in LOGIC:
            return self._operators.logic(LOGIC[operator], [left, right])
        if operator in COMPARISONS:
            return self._operators.comparison(COMPARISONS[operator], left, right)
        return self._operators.arithmetic(ARITHMETIC[operator], left, right)

    def _when(self, suffix: str, write: Callable[[], None]) -> None:
        """Write what happens always, or only if the current result is TRUE (C) or FALSE (CN)."""
        if not suffix:
            write()
            return
        current = truth(self._current()).text
        with self._writer.block(f"if {current}:" if suffix == "C" else f"if not {current}:"):
            write()

    def _function(self, name: str, trees: list[n.Expression]) -> None:
        """Call a function: the current result is its first argument."""
        current = self._current()
        held = self._translator.hold(current)
        arguments = tuple(n.Argument(tree) for tree in (held, *trees))
        self._load(self._translator.value(n.Call(n.Name(name), arguments), None))
