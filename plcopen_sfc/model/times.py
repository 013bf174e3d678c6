"""Times in the model: duration literals or expressions, as program text."""

from __future__ import annotations

import re

_TOKEN = re.compile(
    r"""\s*(?:
        (?P<operand>
            (?:LTIME|TIME|LT|T|S5TIME|S5T)\#[-+]?(?:\d[\d_]*(?:\.\d+)?(?:ms|us|ns|d|h|m|s)_?)+(?!\w)
          | (?!(?:LTIME|TIME|LT|T|S5TIME|S5T)\#)\#?[^\W\d]\w*(?:\#[-+]?[\w.]+)?
          | \#?"[^"]*" | %\w[\w.]* | \d[\d_]*(?:\.\d+)?(?!\w)
        )
      | (?P<sign>\(\*.*?\*\)|//.*|[-+*/()<>=,.&^\[\]:;|])
    )\s*""",
    re.VERBOSE | re.IGNORECASE | re.DOTALL,
)
_OPERATORS = frozenset("AND OR XOR NOT MOD".split())
_BETWEEN = frozenset("* / & ^ , ; : | ) ]".split())
"""Signs that end what is before them: no operator comes before one, and an expression does not begin with it."""
_OPEN = frozenset("+ - * / & ( [ < > = , . : AND OR XOR NOT MOD".split())
"""Signs and words behind which an operand comes."""
_BRACKETS = {")": "(", "]": "["}
_PAIRS = frozenset({("*", "*"), ("(", ")")})
"""Signs that may follow each other though an operand would come: a power, a call without arguments."""
_NUMBER = re.compile(r"[\d_.]+")


def objection(text: str) -> str:
    """Return why `text` is neither a duration literal nor an expression; empty if it is one.

    Sees what no expression can be, such as ``5 s``; the parser finds what is wrong with an expression.
    """
    position, before, last = 0, "", "("
    brackets: list[str] = []
    while position < len(text):
        token = _TOKEN.match(text, position)
        if token is None:
            return _WRONG
        operand = token["operand"] or ""
        if operand.upper() in _OPERATORS:
            operand = ""
        if operand and before:
            return _WRONG
        position = token.end()
        if token["sign"] is not None and token["sign"].startswith(("(*", "//")):
            continue
        sign = "" if operand else (token["sign"] or token["operand"]).upper()
        if sign in _BETWEEN and last in _OPEN and (last, sign) not in _PAIRS:
            return _WRONG
        if sign in _BRACKETS.values():
            brackets.append(sign)
        elif sign in _BRACKETS and (not brackets or brackets.pop() != _BRACKETS[sign]):
            return _WRONG
        before, last = operand, sign
    is_empty = text.strip().strip("()") == ""
    return _WRONG if is_empty or brackets or last in _OPEN or _NUMBER.fullmatch(text.strip()) else ""


def interval_objection(text: str) -> str:
    """Return the same for the interval of a task, which is also a duration in a form that files of TC6 have."""
    return "" if _OF_FILES.fullmatch(text.strip()) else objection(text)


_OF_FILES = re.compile(
    r"PT(?=\d)(?:\d+H)?(?:\d+M)?(?:\d+(?:\.\d+)?S)?|\d+:\d+:\d+(?:\.\d+)?|(?:\d+(?:\.\d+)?(?:ms|us|ns|d|h|m|s)_?)+",
    re.IGNORECASE,
)
"""``PT0.1S`` (xsd:duration), ``00:00:00.1`` (xsd:time), ``10ms`` (an example of TC6 2.01)."""

_WRONG = "it is no duration, such as T#5s, and no expression"
