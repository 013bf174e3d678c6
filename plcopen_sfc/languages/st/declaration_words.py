"""The words of declarations. In statements all of them are names."""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st.lexer import STATEMENT_KEYWORDS, Token, Tokens, tokenize

POUS = frozenset(
    """PROGRAM FUNCTION_BLOCK FUNCTION METHOD PROPERTY INTERFACE ACTION CLASS NAMESPACE USING CONFIGURATION RESOURCE
    ORGANIZATION_BLOCK DATA_BLOCK""".split()
)
VARIABLES = frozenset(
    "VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_TEMP VAR_EXTERNAL VAR_GLOBAL VAR_STAT VAR_INST VAR_GENERIC".split()
)
_QUALIFIERS = frozenset(
    """CONSTANT RETAIN NON_RETAIN PERSISTENT DB_SPECIFIC ABSTRACT FINAL PUBLIC PRIVATE PROTECTED INTERNAL OVERRIDE
    KNOW_HOW_PROTECT UNLINKED""".split()
)
_OWN = frozenset(
    """VAR_ACCESS VAR_CONFIG END_VAR TYPE END_TYPE TASK WITH ON EXTENDS IMPLEMENTS TITLE AT STRUCT END_STRUCT UNION
    END_UNION ARRAY REF_TO""".split()
)
_TERMINALS = (
    dict.fromkeys(POUS, "POU")
    | dict.fromkeys((f"END_{word}" for word in POUS), "END_POU")
    | dict.fromkeys(VARIABLES, "VAR")
    | dict.fromkeys(_QUALIFIERS, "QUALIFIER")
    | dict.fromkeys(("R_EDGE", "F_EDGE"), "EDGE")
    | dict.fromkeys(("READ_ONLY", "READ_WRITE"), "DIRECTION")
    | dict.fromkeys(("POINTER", "REFERENCE"), "POINTER")
    | {word: word for word in _OWN}
)
KEYWORDS = frozenset(_TERMINALS)
_STATEMENTS_ONLY = STATEMENT_KEYWORDS - {"OF", "TO", "NOT"} | {"REGION", "END_REGION", "GOTO", "JMP"}
_FIRM = frozenset({"VAR", "VAR_ACCESS", "VAR_CONFIG", "EDGE", "DIRECTION", "TITLE"})
_BEHIND_NAMES = frozenset(
    "COLON COMMA ASSIGN RPAR SEMICOLON DOT RSQB RANGE OPERATOR SIGN COMPOUND_ASSIGN CARET".split()
)
"""What may stand behind a name, but not behind a word of declarations."""


def tokenize_declarations(text: str, dialect: Dialect) -> Tokens:
    """The tokens of declarations.

    A word counts as one of declarations only where it can be one: ``Type : INT;`` declares a variable.
    """
    found = tokenize(text, dialect, KEYWORDS)
    tokens = found.tokens
    for token, following in zip(tokens, [*tokens[1:], Token("$END", "", (0, 0))], strict=False):
        if token.type in _STATEMENTS_ONLY:
            token.type = "NAME"
        elif token.type in KEYWORDS:
            terminal = _TERMINALS[token.type]
            token.type = terminal if _is_word(terminal, following) else "NAME"
    return found


def _is_word(terminal: str, following: Token) -> bool:
    if terminal in _FIRM or terminal.startswith("END"):
        return True
    if terminal == "POINTER":
        return following.type == "TO"
    return following.type not in _BEHIND_NAMES
