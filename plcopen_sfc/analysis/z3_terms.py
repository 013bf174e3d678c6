"""Terms of z3: texts, and arithmetic and standard functions for guesses, without overflow and rounding errors."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import reduce
from threading import local
from typing import Any

from plcopen_sfc.languages.st.nodes import Operator

_MOST_FACTORS = 4

FIRST_IS_TEXT = {"LEN": 1, "LEFT": 1, "RIGHT": 1, "MID": 1, "FIND": 2, "CONCAT": 99}
"""Functions by how many of their first arguments are texts."""

TEXT_RESULT = frozenset({"LEFT", "RIGHT", "MID", "CONCAT"})
OF_NUMBERS = frozenset({"ABS", "MIN", "MAX", "LIMIT"})
"""Functions whose result has the type of their arguments."""


def calculated(z3: Any, operator: Operator, terms: Sequence[Any]) -> Any:
    """The value of an operation; None for one that is not known."""
    match operator:
        case Operator.ADD:
            return reduce(lambda a, b: a + b, terms)
        case Operator.SUBTRACT:
            return terms[0] - terms[1]
        case Operator.MULTIPLY:
            return reduce(lambda a, b: a * b, terms)
        case Operator.DIVIDE:
            return _divided(z3, *terms)
        case Operator.MODULO if all(term.is_int() for term in terms):
            return terms[0] - _divided(z3, *terms) * terms[1]
        case Operator.POWER if z3.is_int_value(terms[1]) and 0 < terms[1].as_long() <= _MOST_FACTORS:
            return reduce(lambda a, b: a * b, [terms[0]] * terms[1].as_long())
    return None


def _divided(z3: Any, dividend: Any, divisor: Any) -> Any:
    """A quotient; of integers without its fraction."""
    if not (dividend.is_int() and divisor.is_int()):
        return dividend / divisor
    # z3 rounds so that the remainder is not negative: for a dividend that is not negative, towards zero
    return z3.If(dividend >= 0, dividend / divisor, -(-dividend / divisor))


def called(z3: Any, name: str, terms: Sequence[Any]) -> Any:
    """The value of a standard function; None for one that is not known, or that is not called so."""
    function = _FUNCTIONS.get(name)
    if function is None:
        return None
    try:
        return function(z3, *terms)
    except TypeError:  # too many or too few arguments: what is called so is refused elsewhere
        return None


def converted(z3: Any, term: Any, *, to_real: bool) -> Any:
    """A number as one of the other kind."""
    if term.is_int():
        return z3.ToReal(term) if to_real else term
    return term if to_real else z3.ToInt(term + z3.Q(1, 2, ctx=term.ctx))


def _least(z3: Any, *terms: Any) -> Any:
    return reduce(lambda a, b: z3.If(a <= b, a, b), terms)


def _greatest(z3: Any, *terms: Any) -> Any:
    return reduce(lambda a, b: z3.If(a >= b, a, b), terms)


_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "LEN": lambda z3, text: z3.Length(text),
    "LEFT": lambda z3, text, count: z3.SubString(text, 0, count),
    "RIGHT": lambda z3, text, count: z3.SubString(text, _greatest(z3, z3.Length(text) - count, 0 * count), count),
    "MID": lambda z3, text, count, place: z3.SubString(text, place - 1, count),
    "FIND": lambda z3, text, part: z3.IndexOf(text, part, 0) + 1,
    "CONCAT": lambda z3, *texts: z3.Concat(*texts),
    "ABS": lambda z3, number: z3.If(number >= 0, number, -number),
    "MIN": _least,
    "MAX": _greatest,
    "LIMIT": lambda z3, low, number, high: _least(z3, _greatest(z3, low, number), high),
}


_CONTEXTS = local()


def z3_context() -> tuple[Any, Any]:
    """The module, loaded when it is first needed, and a context for this thread."""
    import z3  # noqa: PLC0415  # takes a tenth of a second

    if not hasattr(_CONTEXTS, "context"):
        _CONTEXTS.context = z3.Context()
    return z3, _CONTEXTS.context


_ESCAPED = re.compile(r"\\u\{([0-9a-fA-F]+)\}")


def text_term(text: str) -> Any:
    """A text as a z3 term."""
    z3, context = z3_context()
    return z3.StringVal(text.replace("\\", "\\u{5c}"), ctx=context)  # else z3 reads the text \u{41} as A


def plain_text(value: Any) -> str:
    """The text of a z3 value, which escapes what is not ASCII."""
    text = value.as_string() if hasattr(value, "as_string") else ""
    return _ESCAPED.sub(lambda found: chr(int(found[1], 16)), text)


def negation(term: Any) -> Any:
    """The opposite of a z3 term."""
    return z3_context()[0].Not(term)


def disjunction(terms: list[Any]) -> Any:
    """That at least one of the z3 terms is true."""
    z3, context = z3_context()
    return z3.Or(*terms) if terms else z3.BoolVal(False, ctx=context)
