"""The standard functions and function blocks of IEC 61131-3 ed. 3 (6.6.2.5 and 6.6.3.5), and what tools call them.

One table for all who must know a block by its name: the translation between networks and text, and whoever executes
either. Pins are in the order of IEC 61131-3, which is that of arguments without names.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache

from plcopen_sfc.languages.st.nodes import Operator


class BlockKind(StrEnum):
    """Kinds of standard blocks.

    OPERATOR: a function that structured text writes as an operator. FUNCTION: any other function. FUNCTION_BLOCK: it
    has a state, so each use needs an instance.
    """

    OPERATOR = "operator"
    FUNCTION = "function"
    FUNCTION_BLOCK = "function block"


class Tool(StrEnum):
    """A family of tools with names of its own. S7: the parts of LAD and FBD networks in TIA Portal (``FlgNet``)."""

    CODESYS = "codesys"
    S7 = "s7"


@dataclass(frozen=True, slots=True)
class Pin:
    """A parameter: its name and type. Types are those of IEC 61131-3, generic ones (``ANY_NUM``) included."""

    name: str
    type: str


@dataclass(frozen=True, slots=True)
class ToolNames:
    """Name of a block in a tool, and of those pins that it names otherwise: from the IEC name to its own."""

    name: str
    pins: dict[str, str]


@dataclass(frozen=True, slots=True, eq=False)
class StandardBlock:
    """A standard function or function block.

    `extensible`: the last input may be repeated (``IN1, IN2, IN3 ..``). `operator`: how structured text writes it.
    """

    name: str
    kind: BlockKind
    inputs: tuple[Pin, ...]
    outputs: tuple[Pin, ...]
    extensible: bool
    operator: Operator | None
    tools: dict[Tool, ToolNames]

    @property
    def stateful(self) -> bool:
        """True if it has a state, and so an instance."""
        return self.kind is BlockKind.FUNCTION_BLOCK

    @property
    def result(self) -> Pin:
        """The first output: the value of a function, and what a wire that names no output means."""
        return self.outputs[0]

    def input_pins(self, count: int) -> tuple[Pin, ...]:
        """The inputs of a use with `count` of them: those that an extensible function repeats are numbered on."""
        if not self.extensible or count <= len(self.inputs):
            return self.inputs
        last = self.inputs[-1]
        stem, number = _numbered(last.name)
        more = range(number + 1, number + 1 + count - len(self.inputs))
        return (*self.inputs, *(Pin(f"{stem}{n}", last.type) for n in more))

    def tool_pin(self, pin: str, tool: Tool) -> str:
        """Return the name of a pin in `tool`; `pin` is that of IEC 61131-3."""
        names = self.tools.get(tool)
        if names is None or pin in names.pins:
            return names.pins[pin] if names is not None else pin
        stem, number = _numbered(pin)
        own = names.pins.get(f"{stem}1")
        return f"{_numbered(own)[0]}{number}" if own is not None else pin

    def input_name(self, pin: str) -> str | None:
        """Return the IEC name of an input as any tool may call it; case does not matter. None: it is no input."""
        found = _names(self, inputs=True).get(pin.casefold())
        if found is None and self.extensible:
            stem, first = _numbered(self.inputs[-1].name)
            matched = re.fullmatch(rf"{stem}(\d{{1,9}})", pin, re.IGNORECASE)
            if matched and int(matched[1]) > first:
                return f"{stem}{int(matched[1])}"
        return found

    def output_name(self, pin: str) -> str | None:
        """Return the IEC name of an output as any tool may call it; case does not matter. None: it is no output."""
        return _names(self, inputs=False).get(pin.casefold())

    def pin_in(self, pin: str, tool: Tool | None) -> str | None:
        """Return what `tool` calls an input or output that any may name; None: IEC 61131-3. None where it has none."""
        found = self.input_name(pin) or self.output_name(pin)
        return found if found is None or tool is None else self.tool_pin(found, tool)


@lru_cache(maxsize=1024)
def _names(block: StandardBlock, *, inputs: bool) -> dict[str, str]:
    """Return the IEC names of the inputs or outputs of a block by all that tools call them, in lower case."""
    found: dict[str, str] = {}
    for pin in block.inputs if inputs else block.outputs:
        for name in (pin.name, *(names.pins.get(pin.name, "") for names in block.tools.values())):
            found.setdefault(name.casefold(), pin.name)
    return found


def standard_block(name: str, tool: Tool | None = None) -> StandardBlock | None:
    """The block of this name, case does not matter; conversions such as ``INT_TO_REAL`` and ``TO_REAL`` are made up.

    `tool`: the name is one of this tool where it has such; without, it is that of IEC 61131-3. The two differ where
    it hurts: ``SR`` is set dominant in IEC 61131-3, ``Sr`` reset dominant in S7.
    """
    key = name.casefold()
    if tool is not None and (tool, key) in _BY_TOOL:
        return _BY_TOOL[tool, key]
    found = _BY_NAME.get(key)
    return found if found is not None else _conversion(name.upper())


def operator_block(operator: Operator) -> StandardBlock | None:
    """Return the block that does what `operator` does; None for signs and for AND_THEN and OR_ELSE, which have none."""
    return _BY_OPERATOR.get(operator)


def standard_blocks() -> Iterator[StandardBlock]:
    """Yield all standard blocks, but for conversions."""
    return iter(_BY_NAME.values())


@lru_cache(maxsize=1024)
def _conversion(name: str) -> StandardBlock | None:
    matched = _CONVERSION.fullmatch(name)
    if matched is None or not {matched["source"] or "BOOL", matched["target"]} <= _TYPES:
        return None
    inputs, outputs = (Pin("IN", matched["source"] or "ANY"),), (Pin("OUT", matched["target"]),)
    is_convert = name == f"{matched['source']}_TO_{matched['target']}" and {*name.split("_TO_")} <= S7_CONVERTED.keys()
    tools = {Tool.S7: ToolNames("Convert", {"IN": "in", "OUT": "out"})} if is_convert else {}
    return StandardBlock(name, BlockKind.FUNCTION, inputs, outputs, extensible=False, operator=None, tools=tools)


S7_CONVERTED = {
    name.upper(): name
    for name in "Byte Word DWord LWord SInt Int DInt LInt USInt UInt UDInt ULInt Real LReal Time LTime".split()
}
"""The types between which the box ``Convert`` of TIA Portal converts as conversions of IEC 61131-3 do."""


BOUND_FUNCTIONS = frozenset({"LOWER_BOUND", "UPPER_BOUND"})
"""Functions that give the bounds of an array that has ``*`` for them (ed. 3, 6.6.1.4; TIA Portal from V14 on)."""
_CONVERSION = re.compile(r"(?:(?P<source>\w+)_(?:TRUNC|BCD_TO|TO(?:_BCD)?)|TO|TRUNC)_(?P<target>\w+)")
_TYPES = frozenset(
    """
    BOOL BYTE WORD DWORD LWORD SINT INT DINT LINT USINT UINT UDINT ULINT REAL LREAL TIME LTIME DATE LDATE
    TIME_OF_DAY TOD LTOD DATE_AND_TIME DT LDT STRING WSTRING CHAR WCHAR BCD
    """.split()
)


def _numbered(name: str) -> tuple[str, int]:
    matched = re.fullmatch(r"(\D*)(\d{1,9})", name)
    return (matched[1], int(matched[2])) if matched else (name, 0)


S7_INSTANCES = {
    **{timer: f"{timer}_TIME" for timer in ("TON", "TOF", "TP")},
    **{f"L{timer}": f"{timer}_LTIME" for timer in ("TON", "TOF", "TP")},
    **{counter: f"{counter}_INT" for counter in ("CTU", "CTD", "CTUD")},
}
"""Types of instances of standard function blocks in TIA Portal, where these are not named like the block."""
S7_COUNTERS_OF_CODESYS = {counter: f"{counter}_UINT" for counter in ("CTU", "CTD", "CTUD")}
"""Those for counters of CODESYS, which count in a WORD: from 0 to 65535 (help of CODESYS, library Standard)."""
BLOCKS_OF_S7 = {own: block for names in (S7_INSTANCES, S7_COUNTERS_OF_CODESYS) for block, own in names.items()}
"""The standard function blocks by the types of their instances in TIA Portal."""
S7_VERSION = "1.0"
"""The version of the timers, counters and edges of IEC 61131-3 in TIA Portal."""

_OPERATORS = """
    AND+   IN1:ANY_BIT IN2:ANY_BIT        > OUT:ANY_BIT
    OR+    IN1:ANY_BIT IN2:ANY_BIT        > OUT:ANY_BIT
    XOR+   IN1:ANY_BIT IN2:ANY_BIT        > OUT:ANY_BIT
    NOT    IN:ANY_BIT                     > OUT:ANY_BIT
    GT+    IN1:ANY_ELEMENTARY IN2:ANY_ELEMENTARY > OUT:BOOL
    GE+    IN1:ANY_ELEMENTARY IN2:ANY_ELEMENTARY > OUT:BOOL
    EQ+    IN1:ANY_ELEMENTARY IN2:ANY_ELEMENTARY > OUT:BOOL
    LE+    IN1:ANY_ELEMENTARY IN2:ANY_ELEMENTARY > OUT:BOOL
    LT+    IN1:ANY_ELEMENTARY IN2:ANY_ELEMENTARY > OUT:BOOL
    NE     IN1:ANY_ELEMENTARY IN2:ANY_ELEMENTARY > OUT:BOOL
    ADD+   IN1:ANY_NUM IN2:ANY_NUM        > OUT:ANY_NUM
    MUL+   IN1:ANY_NUM IN2:ANY_NUM        > OUT:ANY_NUM
    SUB    IN1:ANY_NUM IN2:ANY_NUM        > OUT:ANY_NUM
    DIV    IN1:ANY_NUM IN2:ANY_NUM        > OUT:ANY_NUM
    MOD    IN1:ANY_INT IN2:ANY_INT        > OUT:ANY_INT
    EXPT   IN1:ANY_REAL IN2:ANY_NUM       > OUT:ANY_REAL
"""
"""Name, inputs, outputs; ``+``: extensible. So all tables below."""

_OPERATOR_OF = {
    "AND": Operator.AND,
    "OR": Operator.OR,
    "XOR": Operator.XOR,
    "NOT": Operator.NOT,
    "GT": Operator.GREATER,
    "GE": Operator.GREATER_OR_EQUAL,
    "EQ": Operator.EQUAL,
    "LE": Operator.LESS_OR_EQUAL,
    "LT": Operator.LESS,
    "NE": Operator.UNEQUAL,
    "ADD": Operator.ADD,
    "MUL": Operator.MULTIPLY,
    "SUB": Operator.SUBTRACT,
    "DIV": Operator.DIVIDE,
    "MOD": Operator.MODULO,
    "EXPT": Operator.POWER,
}

_DAY = "YEAR:ANY_INT MONTH:ANY_INT DAY:ANY_INT"
_CLOCK = "HOUR:ANY_INT MINUTE:ANY_INT SECOND:ANY_INT MILLISECOND:ANY_INT"
_FUNCTIONS = f"""
    MOVE   IN:ANY                         > OUT:ANY
    ABS    IN:ANY_NUM                     > OUT:ANY_NUM
    SQRT   IN:ANY_REAL                    > OUT:ANY_REAL
    LN     IN:ANY_REAL                    > OUT:ANY_REAL
    LOG    IN:ANY_REAL                    > OUT:ANY_REAL
    EXP    IN:ANY_REAL                    > OUT:ANY_REAL
    SIN    IN:ANY_REAL                    > OUT:ANY_REAL
    COS    IN:ANY_REAL                    > OUT:ANY_REAL
    TAN    IN:ANY_REAL                    > OUT:ANY_REAL
    ASIN   IN:ANY_REAL                    > OUT:ANY_REAL
    ACOS   IN:ANY_REAL                    > OUT:ANY_REAL
    ATAN   IN:ANY_REAL                    > OUT:ANY_REAL
    ATAN2  Y:ANY_REAL X:ANY_REAL          > OUT:ANY_REAL
    TRUNC  IN:ANY_REAL                    > OUT:ANY_INT
    SHL    IN:ANY_BIT N:ANY_INT           > OUT:ANY_BIT
    SHR    IN:ANY_BIT N:ANY_INT           > OUT:ANY_BIT
    ROL    IN:ANY_BIT N:ANY_INT           > OUT:ANY_BIT
    ROR    IN:ANY_BIT N:ANY_INT           > OUT:ANY_BIT
    SEL    G:BOOL IN0:ANY IN1:ANY         > OUT:ANY
    MAX+   IN1:ANY_ELEMENTARY IN2:ANY_ELEMENTARY > OUT:ANY_ELEMENTARY
    MIN+   IN1:ANY_ELEMENTARY IN2:ANY_ELEMENTARY > OUT:ANY_ELEMENTARY
    LIMIT  MN:ANY_ELEMENTARY IN:ANY_ELEMENTARY MX:ANY_ELEMENTARY > OUT:ANY_ELEMENTARY
    MUX+   K:ANY_INT IN0:ANY IN1:ANY      > OUT:ANY
    LEN    IN:ANY_STRING                  > OUT:ANY_INT
    LEFT   IN:ANY_STRING L:ANY_INT        > OUT:ANY_STRING
    RIGHT  IN:ANY_STRING L:ANY_INT        > OUT:ANY_STRING
    MID    IN:ANY_STRING L:ANY_INT P:ANY_INT > OUT:ANY_STRING
    CONCAT+ IN1:ANY_CHARS IN2:ANY_CHARS   > OUT:ANY_STRING
    INSERT IN1:ANY_STRING IN2:ANY_CHARS P:ANY_INT > OUT:ANY_STRING
    DELETE IN:ANY_STRING L:ANY_INT P:ANY_INT > OUT:ANY_STRING
    REPLACE IN1:ANY_STRING IN2:ANY_CHARS L:ANY_INT P:ANY_INT > OUT:ANY_STRING
    FIND   IN1:ANY_STRING IN2:ANY_CHARS   > OUT:ANY_INT
    ADD_TIME IN1:TIME IN2:TIME            > OUT:TIME
    ADD_LTIME IN1:LTIME IN2:LTIME         > OUT:LTIME
    ADD_TOD_TIME IN1:TOD IN2:TIME         > OUT:TOD
    ADD_LTOD_LTIME IN1:LTOD IN2:LTIME     > OUT:LTOD
    ADD_DT_TIME IN1:DT IN2:TIME           > OUT:DT
    ADD_LDT_LTIME IN1:LDT IN2:LTIME       > OUT:LDT
    SUB_TIME IN1:TIME IN2:TIME            > OUT:TIME
    SUB_LTIME IN1:LTIME IN2:LTIME         > OUT:LTIME
    SUB_DATE_DATE IN1:DATE IN2:DATE       > OUT:TIME
    SUB_LDATE_LDATE IN1:LDATE IN2:LDATE   > OUT:LTIME
    SUB_TOD_TIME IN1:TOD IN2:TIME         > OUT:TOD
    SUB_LTOD_LTIME IN1:LTOD IN2:LTIME     > OUT:LTOD
    SUB_TOD_TOD IN1:TOD IN2:TOD           > OUT:TIME
    SUB_LTOD_LTOD IN1:LTOD IN2:LTOD       > OUT:LTIME
    SUB_DT_TIME IN1:DT IN2:TIME           > OUT:DT
    SUB_LDT_LTIME IN1:LDT IN2:LTIME       > OUT:LDT
    SUB_DT_DT IN1:DT IN2:DT               > OUT:TIME
    SUB_LDT_LDT IN1:LDT IN2:LDT           > OUT:LTIME
    MUL_TIME IN1:TIME IN2:ANY_NUM         > OUT:TIME
    MUL_LTIME IN1:LTIME IN2:ANY_NUM       > OUT:LTIME
    DIV_TIME IN1:TIME IN2:ANY_NUM         > OUT:TIME
    DIV_LTIME IN1:LTIME IN2:ANY_NUM       > OUT:LTIME
    CONCAT_DATE_TOD IN1:DATE IN2:TOD      > OUT:DT
    CONCAT_DATE_LTOD IN1:DATE IN2:LTOD    > OUT:LDT
    CONCAT_DATE {_DAY}                    > OUT:DATE
    CONCAT_TOD {_CLOCK}               > OUT:TOD
    CONCAT_LTOD {_CLOCK}               > OUT:LTOD
    CONCAT_DT {_DAY} {_CLOCK}             > OUT:DT
    CONCAT_LDT {_DAY} {_CLOCK}            > OUT:LDT
    DAY_OF_WEEK IN:DATE                   > OUT:ANY_INT
    TO_BIG_ENDIAN IN:ANY                  > OUT:ANY
    TO_LITTLE_ENDIAN IN:ANY               > OUT:ANY
    FROM_BIG_ENDIAN IN:ANY                > OUT:ANY
    FROM_LITTLE_ENDIAN IN:ANY             > OUT:ANY
    IS_VALID IN:ANY_REAL                  > OUT:BOOL
    IS_VALID_BCD IN:ANY_BIT               > OUT:BOOL
"""

_FUNCTION_BLOCKS = """
    SR     S1:BOOL R:BOOL                 > Q1:BOOL
    RS     S:BOOL R1:BOOL                 > Q1:BOOL
    R_TRIG CLK:BOOL                       > Q:BOOL
    F_TRIG CLK:BOOL                       > Q:BOOL
    CTU    CU:BOOL R:BOOL PV:ANY_INT      > Q:BOOL CV:ANY_INT
    CTD    CD:BOOL LD:BOOL PV:ANY_INT     > Q:BOOL CV:ANY_INT
    CTUD   CU:BOOL CD:BOOL R:BOOL LD:BOOL PV:ANY_INT > QU:BOOL QD:BOOL CV:ANY_INT
    TP     IN:BOOL PT:TIME                > Q:BOOL ET:TIME
    TON    IN:BOOL PT:TIME                > Q:BOOL ET:TIME
    TOF    IN:BOOL PT:TIME                > Q:BOOL ET:TIME
"""

_CODESYS = """
    AND  AND  IN1=In1 IN2=In2 OUT=Out1
    OR   OR   IN1=In1 IN2=In2 OUT=Out1
    XOR  XOR  IN1=In1 IN2=In2 OUT=Out1
    NOT  NOT  IN=In1 OUT=Out1
    GT   GT   IN1=In1 IN2=In2 OUT=Out1
    GE   GE   IN1=In1 IN2=In2 OUT=Out1
    EQ   EQ   IN1=In1 IN2=In2 OUT=Out1
    LE   LE   IN1=In1 IN2=In2 OUT=Out1
    LT   LT   IN1=In1 IN2=In2 OUT=Out1
    NE   NE   IN1=In1 IN2=In2 OUT=Out1
    ADD  ADD  IN1=In1 IN2=In2 OUT=Out1
    MUL  MUL  IN1=In1 IN2=In2 OUT=Out1
    SUB  SUB  IN1=In1 IN2=In2 OUT=Out1
    DIV  DIV  IN1=In1 IN2=In2 OUT=Out1
    MOD  MOD  IN1=In1 IN2=In2 OUT=Out1
    EXPT EXPT IN1=In1 IN2=In2 OUT=Out1
    MOVE MOVE IN=In1 OUT=Out1
    SR   SR   S1=SET1 R=RESET
    RS   RS   S=SET R1=RESET1
    CTU  CTU  R=RESET
    CTD  CTD  LD=LOAD
    CTUD CTUD R=RESET LD=LOAD
    LEN  LEN  IN=STR
    LEFT LEFT IN=STR L=SIZE
    RIGHT RIGHT IN=STR L=SIZE
    MID  MID  IN=STR L=LEN P=POS
    CONCAT CONCAT IN1=STR1 IN2=STR2
    INSERT INSERT IN1=STR1 IN2=STR2 P=POS
    DELETE DELETE IN=STR L=LEN P=POS
    REPLACE REPLACE IN1=STR1 IN2=STR2
    FIND FIND IN1=STR1 IN2=STR2
"""
"""IEC name, the tool's name, and pins of other names. CODESYS numbers the pins of operator boxes."""

_S7 = """
    AND  A    IN1=in1 IN2=in2 OUT=out
    OR   O    IN1=in1 IN2=in2 OUT=out
    XOR  X    IN1=in1 IN2=in2 OUT=out
    NOT  Not  IN=in OUT=out
    GT   Gt   IN1=in1 IN2=in2 OUT=out
    GE   Ge   IN1=in1 IN2=in2 OUT=out
    EQ   Eq   IN1=in1 IN2=in2 OUT=out
    LE   Le   IN1=in1 IN2=in2 OUT=out
    LT   Lt   IN1=in1 IN2=in2 OUT=out
    NE   Ne   IN1=in1 IN2=in2 OUT=out
    ADD  Add  IN1=in1 IN2=in2 OUT=out
    MUL  Mul  IN1=in1 IN2=in2 OUT=out
    SUB  Sub  IN1=in1 IN2=in2 OUT=out
    DIV  Div  IN1=in1 IN2=in2 OUT=out
    MOD  Mod  IN1=in1 IN2=in2 OUT=out
    MOVE Move IN=in OUT=out1
    SR   Rs   S1=s1 R=r Q1=q
    RS   Sr   S=s R1=r1 Q1=q
    R_TRIG PBox CLK=in Q=out
    F_TRIG NBox CLK=in Q=out
"""
"""Flip-flops and edges keep their state in an operand there, not in an instance: ``operand`` and ``bit``."""


def _pins(text: str) -> tuple[Pin, ...]:
    return tuple(Pin(*pin.split(":")) for pin in text.split())


def _tool(rows: str) -> dict[str, ToolNames]:
    names = {}
    for row in rows.strip().splitlines():
        iec, own, *pins = row.split()
        names[iec] = ToolNames(own, dict(pin.split("=") for pin in pins))
    return names


def _table() -> Iterator[StandardBlock]:
    tools = {Tool.CODESYS: _tool(_CODESYS), Tool.S7: _tool(_S7)}
    groups = ((BlockKind.OPERATOR, _OPERATORS), (BlockKind.FUNCTION, _FUNCTIONS))
    for kind, rows in (*groups, (BlockKind.FUNCTION_BLOCK, _FUNCTION_BLOCKS)):
        for row in rows.strip().splitlines():
            head, _, inputs = row.partition(">")[0].strip().partition(" ")
            name = head.rstrip("+")
            yield StandardBlock(
                name,
                kind,
                _pins(inputs),
                _pins(row.partition(">")[2]),
                head.endswith("+"),
                _OPERATOR_OF.get(name),
                {tool: names[name] for tool, names in tools.items() if name in names},
            )


_BY_NAME = {block.name.casefold(): block for block in _table()}
_BY_TOOL = {(t, names.name.casefold()): block for block in _BY_NAME.values() for t, names in block.tools.items()}
_BY_OPERATOR = {block.operator: block for block in _BY_NAME.values() if block.operator is not None}
