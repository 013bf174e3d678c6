"""Says in words what a parser found and what it expected."""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.languages.st.lexer import Token

_SHOWN = {
    "SEMICOLON": "';'",
    "COLON": "':'",
    "COMMA": "','",
    "DOT": "'.'",
    "RANGE": "'..'",
    "LPAR": "'('",
    "RPAR": "')'",
    "LSQB": "'['",
    "RSQB": "']'",
    "ASSIGN": "':='",
    "ARROW": "'=>'",
    "$END": "the end of the text",
    "TRY": "__TRY",
    "CATCH": "__CATCH",
    "FINALLY": "__FINALLY",
    "ENDTRY": "__ENDTRY",
    "POU": "the head of a POU",
    "END_POU": "the end of a POU",
    "QUALIFIER": "CONSTANT or the like",
    "DIRECTION": "READ_ONLY or READ_WRITE",
    "EDGE": "R_EDGE or F_EDGE",
    "POINTER": "POINTER TO or REFERENCE TO",
}
_CONTINUATIONS = frozenset(
    {"OPERATOR", "SIGN", "DOT", "LSQB", "CARET", "PERIPHERAL", "COMPOUND_ASSIGN", "LPAR", "ARROW", "RANGE", "COLON"}
)
_STATEMENT_STARTS = frozenset({"IF", "CASE", "FOR", "WHILE", "REPEAT", "EXIT", "CONTINUE", "RETURN"})
_EXPRESSION_STARTS = frozenset({"NAME", "LITERAL", "ADDRESS", "NOT", "LPAR", "SIGN", "OPERATOR"})  # AND(a, b)
_SHOWN_TEXT = 30


def expectation(found: Token, accepted: Iterable[str]) -> str:
    """``found 'THEN', expected ';' or an operator``, of the terminals that the grammar accepts there."""
    left = set(accepted)
    words: list[str] = []
    if left >= _STATEMENT_STARTS:
        words.append("a statement")
        left -= _STATEMENT_STARTS | _EXPRESSION_STARTS | {"SEMICOLON", "GOTO", "JMP", "REGION", "TRY", "CODE"}
    elif left >= _EXPRESSION_STARTS:
        words.append("an expression")
        left -= _EXPRESSION_STARTS
    elif "NAME" in left:
        words.append("a name")
        left.discard("NAME")
    if "OPERATOR" in left:
        words.append("an operator")
        left -= _CONTINUATIONS
    words[:0] = sorted(_SHOWN.get(terminal, terminal) for terminal in left)
    expected = f"{', '.join(words[:-1])} or {words[-1]}" if len(words) > 1 else "".join(words)
    shown = found.value if len(found.value) <= _SHOWN_TEXT else found.value[:_SHOWN_TEXT] + ".."
    what = "the end of the text" if found.type == "$END" else f"'{shown}'"
    return f"found {what}, expected {expected}" if expected else f"{what} cannot stand here"
