"""Which words can be names."""

from __future__ import annotations

import re

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.model.types import Elementary


def objection(name: str, dialect: Dialect) -> str:
    """Why `name` cannot be a name in `dialect` (IEC 61131-3 ed. 3, 6.1.2); empty if it can.

    Letters of any alphabet are taken, as tools do. In SCL a name can be anything, in quotes; it is given without.
    """
    if dialect is Dialect.SCL:
        printable = bool(name.strip()) and name.isprintable() and '"' not in name
        return "" if printable else "a name has no quotes and no control characters in it"
    if not re.fullmatch(r"[^\W\d]\w*", name):
        return "a name consists of letters, digits and underscores, and starts with no digit"
    if name.upper() in RESERVED:
        return "it is a keyword"
    if "__" in name or name.endswith("_"):
        # tools take them, the standard does not: those that exist already stay as they are
        return "" if dialect is not Dialect.IEC else "underscores stand alone and not at the end of a name"
    return ""


def needs_quotes(name: str) -> bool:
    """Whether a name stands in quotes in SCL wherever it is used."""
    return not re.fullmatch(r"[^\W\d]\w*", name) or name.upper() in RESERVED


RESERVED = (
    frozenset(
        """
    ABSTRACT ACTION AND ARRAY AT BY CASE CLASS CONFIGURATION CONSTANT CONTINUE DO ELSE ELSIF END_ACTION END_CASE
    END_CLASS END_CONFIGURATION END_FOR END_FUNCTION END_FUNCTION_BLOCK END_IF END_INTERFACE END_METHOD END_NAMESPACE
    END_PROGRAM END_REPEAT END_RESOURCE END_STEP END_STRUCT END_TRANSITION END_TYPE END_VAR END_WHILE EXIT EXTENDS
    FALSE FINAL FOR FROM FUNCTION FUNCTION_BLOCK IF IMPLEMENTS INITIAL_STEP INTERFACE INTERNAL METHOD MOD NAMESPACE
    NON_RETAIN NOT NULL OF OR OVERLAP OVERRIDE PRIVATE PROGRAM PROTECTED PUBLIC READ_ONLY READ_WRITE REF_TO REPEAT
    RESOURCE RETAIN RETURN STEP STRING STRUCT SUPER TASK THEN THIS TO TRANSITION TRUE TYPE UNTIL USING VAR VAR_ACCESS
    VAR_CONFIG VAR_EXTERNAL VAR_GLOBAL VAR_IN_OUT VAR_INPUT VAR_OUTPUT VAR_TEMP WHILE WITH WSTRING XOR
    DATE_AND_TIME LDATE_AND_TIME TIME_OF_DAY LTIME_OF_DAY POINTER REFERENCE
    """.split()
    )
    | Elementary.__members__.keys()
)
"""Keywords of IEC 61131-3 ed. 3 (annex A) and CODESYS, but for words that tools take for names: ``ON``, ``R_EDGE``."""
