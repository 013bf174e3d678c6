"""The syntax tree of declarations: heads of POUs, variable sections and types (IEC 61131-3 ed. 3, 6.4 to 6.8).

What CODESYS and SCL add is here too. Comments, pragmas and the attributes of SCL (``{ S7_HMI := 'x' }``) are not in the
tree: they are among the comments of the parsed text, and their place tells what they belong to.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from plcopen_sfc.languages.st.lexer import STATEMENT_KEYWORDS, Token, Tokens, tokenize
from plcopen_sfc.languages.st.nodes import Argument, Expression, Name, Node, Range, Unreadable
from plcopen_sfc.model.dialect import Dialect

# -- types


@dataclass(frozen=True, slots=True)
class NamedType(Node):
    """A type by its name, which may be qualified: ``INT``, ``Library.FB``, ``"UDT"``.

    `arguments` is what is in parentheses behind it: those of a constructor (CODESYS ``FB(5)``), else None.
    """

    name: Expression
    arguments: tuple[Argument, ...] | None = None


@dataclass(frozen=True, slots=True)
class StringTypeNode(Node):
    """``STRING``, ``STRING[80]``, ``WSTRING(80)``."""

    name: Name
    length: Expression | None = None


@dataclass(frozen=True, slots=True)
class SubrangeTypeNode(Node):
    """``INT(0..10)``."""

    base: NamedType
    bounds: Range


@dataclass(frozen=True, slots=True)
class OpenDimension(Node):
    """``*``: an array of any length."""


@dataclass(frozen=True, slots=True)
class ArrayTypeNode(Node):
    """``ARRAY [1..3, 0..9] OF base``, ``ARRAY [*] OF base``."""

    dimensions: tuple[Range | OpenDimension, ...]
    base: TypeNode


@dataclass(frozen=True, slots=True)
class PointerTypeNode(Node):
    """``POINTER TO base``, ``REFERENCE TO base``, ``REF_TO base``: `keyword` is the first word, in capitals."""

    keyword: str
    base: TypeNode


@dataclass(frozen=True, slots=True)
class StructTypeNode(Node):
    """``STRUCT .. END_STRUCT`` or, with `union`, ``UNION .. END_UNION``."""

    members: tuple[VariableDeclaration | Unreadable, ...]
    union: bool = False


@dataclass(frozen=True, slots=True)
class EnumValueNode(Node):
    """One name of an enumeration."""

    name: Name
    value: Expression | None = None


@dataclass(frozen=True, slots=True)
class EnumTypeNode(Node):
    """``(Red, Green := 5) BYTE`` or, with the base before it, ``BYTE (Red, Green := 5)``."""

    values: tuple[EnumValueNode, ...]
    base: TypeNode | None = None


TypeNode: TypeAlias = (
    "NamedType | StringTypeNode | SubrangeTypeNode | ArrayTypeNode | PointerTypeNode | StructTypeNode | EnumTypeNode"
)
"""Any type."""

# -- initial values


@dataclass(frozen=True, slots=True)
class Repetition(Node):
    """``3(0)`` in the value of an array. `value` None: nothing is in the parentheses."""

    count: Expression
    value: InitialValue | None


@dataclass(frozen=True, slots=True)
class ArrayValueNode(Node):
    """``[1, 2, 3(0)]``, or without brackets as CoDeSys V2.3 has it."""

    items: tuple[InitialValue | Repetition, ...]


@dataclass(frozen=True, slots=True)
class MemberValueNode(Node):
    """``member := value``."""

    member: Name
    value: InitialValue


@dataclass(frozen=True, slots=True)
class StructValueNode(Node):
    """``(a := 1, b := [2, 3])`` of a structure or an instance; in SCL also by position, ``(1, (2, 3))``."""

    members: tuple[MemberValueNode | InitialValue, ...]


InitialValue: TypeAlias = "Expression | ArrayValueNode | StructValueNode"
"""Any initial value."""

# -- variables and sections


@dataclass(frozen=True, slots=True)
class VariableDeclaration(Node):
    """``a, b AT %IX0.0 : INT := 5;`` with its semicolon.

    `names` is empty for a direct address without a name. `address` is a direct address, incomplete ones (``%I*``) too,
    or the variable that an SCL variable overlays. `edge`: ``R_EDGE`` or ``F_EDGE``.
    """

    names: tuple[Name, ...]
    type: TypeNode
    address: Expression | None = None
    initial: InitialValue | None = None
    edge: str = ""


@dataclass(frozen=True, slots=True)
class Section(Node):
    """``VAR_INPUT RETAIN .. END_VAR``. `keyword` and `qualifiers` are in capitals."""

    keyword: str
    qualifiers: tuple[str, ...]
    variables: tuple[VariableDeclaration | Unreadable, ...]


@dataclass(frozen=True, slots=True)
class AccessPath(Node):
    """``alias : path : type READ_ONLY;``"""

    alias: Name
    path: Expression
    type: TypeNode
    direction: str = ""


@dataclass(frozen=True, slots=True)
class AccessSectionNode(Node):
    """``VAR_ACCESS .. END_VAR``."""

    paths: tuple[AccessPath | Unreadable, ...]


@dataclass(frozen=True, slots=True)
class ConfigEntry(Node):
    """``resource.program.variable AT %IX0.0 : BOOL := TRUE;``"""

    path: Expression
    type: TypeNode
    address: Expression | None = None
    initial: InitialValue | None = None


@dataclass(frozen=True, slots=True)
class ConfigSectionNode(Node):
    """``VAR_CONFIG .. END_VAR``."""

    entries: tuple[ConfigEntry | Unreadable, ...]


@dataclass(frozen=True, slots=True)
class Property(Node):
    """A line of the head of an SCL block: ``VERSION : 0.1``, ``TITLE = text``, ``NON_RETAIN``.

    `name` is in capitals; `value` as written, None where the word is alone.
    """

    name: str
    value: str | None = None


@dataclass(frozen=True, slots=True)
class TypeDeclaration(Node):
    """``name : type := initial;`` between TYPE and END_TYPE."""

    name: Name
    type: TypeNode
    initial: InitialValue | None = None
    extends: Expression | None = None
    properties: tuple[Property, ...] = ()


@dataclass(frozen=True, slots=True)
class TypeSection(Node):
    """``TYPE .. END_TYPE``."""

    types: tuple[TypeDeclaration | Unreadable, ...]


# -- heads


@dataclass(frozen=True, slots=True)
class PouHead(Node):
    """The head of a POU, before the sections: ``FUNCTION_BLOCK ABSTRACT name EXTENDS base IMPLEMENTS i, j``.

    `keyword` and `qualifiers` are in capitals. `type` is that of the result, of a property, or of what an SCL instance
    DB belongs to; of a resource the processor that it runs ``ON``.
    """

    keyword: str
    name: Expression
    qualifiers: tuple[str, ...] = ()
    type: TypeNode | None = None
    extends: tuple[Expression, ...] = ()
    implements: tuple[Expression, ...] = ()
    properties: tuple[Property, ...] = ()


@dataclass(frozen=True, slots=True)
class TaskNode(Node):
    """``TASK name(INTERVAL := T#20ms, PRIORITY := 1);``"""

    name: Name
    arguments: tuple[Argument, ...]


@dataclass(frozen=True, slots=True)
class ProgramInstance(Node):
    """``PROGRAM name WITH task : type (a := b);``"""

    name: Name
    task: Name | None
    type: NamedType


@dataclass(frozen=True, slots=True)
class StructBody(Node):
    """The ``STRUCT .. END_STRUCT`` that declares a data block (SCL)."""

    type: StructTypeNode


@dataclass(frozen=True, slots=True)
class EndNode(Node):
    """``END_FUNCTION_BLOCK`` and the like. `keyword` is in capitals."""

    keyword: str


Declaration: TypeAlias = (
    "PouHead | Section | AccessSectionNode | ConfigSectionNode | TypeSection | TaskNode | ProgramInstance"
    " | StructBody | EndNode | Unreadable"
)
"""The kinds of node at the outermost level of declarations."""


@dataclass(frozen=True, slots=True)
class Declarations(Node):
    """A text of declarations, in its order. A head and what follows it are separate items."""

    items: tuple[Declaration, ...]


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
    "AT COLON COMMA ASSIGN RPAR SEMICOLON DOT RSQB RANGE OPERATOR SIGN COMPOUND_ASSIGN CARET".split()
)
"""Tokens that may follow a name, but not a word of declarations."""


def tokenize_declarations(text: str, dialect: Dialect) -> Tokens:
    """Return the tokens of declarations.

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
