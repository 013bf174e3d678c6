"""Words that can be no names, because a language reads them as something else: for renames and for translations."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Container
from itertools import zip_longest

from plcopen_sfc.languages.st.lexer import STATEMENT_KEYWORDS
from plcopen_sfc.languages.standard_blocks import standard_blocks
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.types import Elementary

_GENERIC = frozenset(name for name in Elementary.__members__ if name.startswith("ANY"))

KEYWORDS = (
    STATEMENT_KEYWORDS
    | (Elementary.__members__.keys() - _GENERIC)
    | frozenset(
        """
    AND OR XOR MOD TRUE FALSE NULL THIS SUPER
    TIME_OF_DAY DATE_AND_TIME STRING WSTRING ARRAY STRUCT END_STRUCT TYPE END_TYPE POINTER REF_TO
    VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_TEMP VAR_GLOBAL VAR_EXTERNAL END_VAR CONSTANT RETAIN AT
    PROGRAM FUNCTION FUNCTION_BLOCK METHOD INTERFACE
    """.split()
    )
)
"""Words that IEC 61131-3 ed. 3 (annex A), CODESYS and SCL share."""

IEC_KEYWORDS = (
    KEYWORDS
    | _GENERIC
    | frozenset(
        """
    ABSTRACT ACTION CLASS CONFIGURATION END_ACTION END_CLASS END_CONFIGURATION END_FUNCTION END_FUNCTION_BLOCK
    END_INTERFACE END_METHOD END_NAMESPACE END_PROGRAM END_RESOURCE END_STEP END_TRANSITION EXTENDS FINAL FROM
    IMPLEMENTS INITIAL_STEP INTERNAL LDATE_AND_TIME LTIME_OF_DAY NAMESPACE NON_RETAIN OVERLAP OVERRIDE PRIVATE PROTECTED
    PUBLIC READ_ONLY READ_WRITE REFERENCE RESOURCE STEP TASK TRANSITION USING VAR_ACCESS VAR_CONFIG WITH
    """.split()
    )
)
"""Keywords of IEC 61131-3 ed. 3 (annex A) and CODESYS, but for words that tools take for names: ``ON``, ``R_EDGE``."""

EDGES = frozenset({"R_EDGE", "F_EDGE"})
"""Words of declarations that tools take for names elsewhere; a text that declares one is not read."""

TRANSLATED_KEYWORDS = KEYWORDS | frozenset("AND_THEN OR_ELSE GOTO JMP REGION END_REGION VAR_STAT EN ENO".split())
"""Words that are no names of variables in CODESYS or SCL; many tools take the others of IEC 61131-3 as names."""

CODESYS23_KEYWORDS = (KEYWORDS - {"CONTINUE"}) | frozenset(
    """
    ABS ACOS ACTION ADD ADR ASIN ATAN BITADR COS DIV END_ACTION END_FUNCTION END_FUNCTION_BLOCK END_PROGRAM EQ EXP
    EXPT GE GT INDEXOF INI JMP LE LIMIT LN LOG LT MAX MIN MOVE MUL MUX NE NOT PARAMS PERSISTENT READ_ONLY READ_WRITE
    ROL ROR SEL SHL SHR SIN SIZEOF SQRT SUB TAN TRUNC VAR_ACCESS VAR_CONFIG VAR_STAT
    """.split()
)
CODESYS_KEYWORDS = CODESYS23_KEYWORDS | frozenset(
    """
    ABSTRACT AND_THEN CONTINUE END_INTERFACE END_METHOD END_PROPERTY EXTENDS FINAL IMPLEMENTS INTERNAL OR_ELSE OVERRIDE
    PRIVATE PROPERTY PROTECTED PUBLIC REFERENCE TRUNC_INT UNION VAR_INST XSIZEOF
    """.split()
)
"""Words that are no names in CoDeSys 2.3, and in CODESYS V3 and TwinCAT 3: of scopes, types, and operators.

Documented by CODESYS and Beckhoff (keywords). ``Step`` is none: projects have that name. Operators of IL alone (``R``,
``ST``), which Beckhoff lists, are common names of variables elsewhere.
"""

_IEC_WORDS = frozenset(block.name for block in standard_blocks()) | frozenset(
    """STEP INITIAL_STEP END_STEP TRANSITION END_TRANSITION ACTION END_ACTION FROM WITH ON CONFIGURATION RESOURCE TASK
    PRIORITY READ_ONLY READ_WRITE R_EDGE F_EDGE""".split()
)
"""Standard functions and blocks, and words of textual charts and configurations; many tools take these as names."""
_SCL_WORDS = TRANSLATED_KEYWORDS | {"ANY", "BEGIN", "DB", "LABEL"}
"""Words that are names in quotes only in SCL, in declarations as in use; the last four are variables elsewhere."""


def is_plain(name: str) -> bool:
    """True if a name consists of letters of any alphabet, digits and underscores, and starts with no digit."""
    return re.fullmatch(r"[^\W\d]\w*", name) is not None


def needs_quotes(name: str) -> bool:
    """True if a name is in quotes in SCL wherever it is declared and used."""
    return not is_plain(name) or name.upper() in _SCL_WORDS


_UMLAUTS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ß": "ss", "ẞ": "SS"})


def is_identifier(name: str) -> bool:
    """True if a name is an identifier of IEC 61131-3 (6.1.2): letters, digits, and single underscores."""
    return re.fullmatch(r"(?!.*__)[A-Za-z_][A-Za-z0-9_]*", name) is not None


def without_accents(name: str) -> str:
    """Return a name in the letters of ASCII: those with accents without them, German ones as German writes them."""
    text = unicodedata.normalize("NFC", name).translate(_UMLAUTS)
    return unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()


def identifier(name: str) -> str:
    """Return an identifier like `name`: ``Füllstand 1`` is ``Fuellstand_1``."""
    text = re.sub(r"[^A-Za-z0-9]+", "_", without_accents(name)).strip("_")
    if not text:  # nothing left, as of a name in another script
        text = "_".join(f"u{ord(character):04X}" for character in name) or "unnamed"
    return f"_{text}" if text[0].isdigit() else text


def is_reserved(name: str, target: Dialect) -> bool:
    """True if `target` reads a name as something else, so that no variable and no member can have it."""
    word = name.upper()
    return word in TRANSLATED_KEYWORDS or word in (_IEC_WORDS if target is Dialect.IEC else CODESYS_KEYWORDS)


def objection(name: str, dialect: Dialect) -> str:
    """Return why `name` cannot be a name in `dialect` (IEC 61131-3 ed. 3, 6.1.2); empty if it can.

    Letters of any alphabet are taken, as tools do. In SCL a name can be anything, in quotes; it is given without.
    """
    if dialect is Dialect.SCL:
        printable = bool(name.strip()) and name.isprintable() and '"' not in name
        return "" if printable else "a name has no quotes and no control characters in it"
    if not is_plain(name):
        return "a name consists of letters, digits and underscores, and starts with no digit"
    if name.upper() in IEC_KEYWORDS | EDGES:
        return "it is a keyword"
    if "__" in name or name.endswith("_"):
        # tools take them, the standard does not: those that exist already stay as they are
        return "" if dialect is not Dialect.IEC else "underscores stand alone and not at the end of a name"
    return ""


_STRINGS = re.compile(r"""'(?:\$.|[^'$\r\n])*'|"(?:\$.|[^"$\r\n])*\"""")


def folded(text: str) -> str:
    """Return a text in lower case but for the strings in it: ``Mode = 'AUTO'`` is not ``mode = 'auto'``."""
    if "'" not in text and '"' not in text:
        return text.casefold()
    strings = _STRINGS.findall(text)
    between = [part.casefold() for part in _STRINGS.split(text)]
    return "".join(part for pair in zip_longest(between, strings, fillvalue="") for part in pair)


def free_name(wanted: str, taken: Container[str], first: int = 2) -> str:
    """Return `wanted`, with a number from `first` on behind it if that is one of the names `taken`, in lower case."""
    name, number = wanted, first
    while name.casefold() in taken:
        name, number = f"{wanted}_{number}", number + 1
    return name


def underscored_name(wanted: str, taken: set[str]) -> str:
    """Return `wanted`, with underscores behind it until it is none of the names that are `taken`; it is one then."""
    while wanted.casefold() in taken:
        wanted += "_"
    taken.add(wanted.casefold())
    return wanted


def take_name(wanted: str, taken: set[str], first: int = 2) -> str:
    """Return what `free_name` gives; it is one of the names that are `taken` then."""
    name = free_name(wanted, taken, first)
    taken.add(name.casefold())
    return name
