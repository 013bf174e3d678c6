"""Faults of syntax in instruction lists: operands that are none or missing, parentheses, jumps to nowhere."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from plcopen_sfc.languages.il import (
    ARITHMETIC,
    CALLS,
    COMPARISONS,
    JUMPS,
    LOGIC,
    STORING,
    Instruction,
    instructions,
)
from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Span
from plcopen_sfc.model.dialect import Dialect

_COMBINING = frozenset({*LOGIC, *ARITHMETIC, *COMPARISONS, *(f"{word}N" for word in LOGIC)})
_WITH_OPERAND = frozenset({"LD", "LDN", *STORING, *CALLS, *JUMPS, *_COMBINING})


def instruction_problems(text: str, dialect: Dialect = Dialect.IEC) -> list[Problem]:
    """Return the faults of syntax in a body in instruction list, in the order of their places."""
    found = list(instructions(text, dialect))
    labels = {each.label.casefold() for each in found if each.label}
    problems = [problem for each in found for problem in _of_instruction(each, labels)]
    return sorted([*problems, *_of_parentheses(found)], key=lambda problem: problem.span)


def _of_instruction(instruction: Instruction, labels: set[str]) -> Iterator[Problem]:
    word, operands = instruction.operator.upper(), instruction.operands
    for operand in operands:
        for problem in operand.parsed.problems:
            start, end = problem.span
            yield replace(problem, span=(start + operand.start, end + operand.start))
    if not word and operands:
        yield Problem("expected an operator", instruction.operator_span)
    if word in _WITH_OPERAND and not operands and not instruction.opens:
        yield Problem(f"{word} has no operand", instruction.operator_span)
    if word not in JUMPS:
        return
    match [operand.parsed.tree for operand in operands]:
        case [n.Name(label)] if label.casefold() not in labels:
            yield Problem(f"{word} leads to {label}, which is no label here", instruction.operator_span)


def _of_parentheses(found: list[Instruction]) -> Iterator[Problem]:
    opened: list[tuple[str, Span]] = []
    for each in found:
        if each.opens:
            opened.append((each.operator, each.operator_span))
        elif each.operator == ")" and opened:
            opened.pop()
        elif each.operator == ")":
            yield Problem("found ')', which no operator has opened", each.operator_span)
    for word, span in opened:
        yield Problem(f"{word}( has no closing parenthesis", span)
