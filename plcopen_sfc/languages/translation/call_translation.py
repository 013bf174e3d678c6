"""Calls: standard functions and what replaces them, instances and their pins, and how arguments are written.

Pins and names of standard functions come from `plcopen_sfc.languages.standard_blocks`. Evidence for each row:
docs/dialects.md.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import replace

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.expression_types import ExpressionTypes
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Argument, Expression, Operator
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.languages.standard_blocks import (
    BOUND_FUNCTIONS,
    BlockKind,
    StandardBlock,
    Tool,
    standard_block,
    standard_blocks,
)
from plcopen_sfc.languages.translation.name_translation import NameTranslator
from plcopen_sfc.languages.translation.translation_context import TITLES, Notes, family
from plcopen_sfc.model.dialect import Dialect

S7_TIMERS_AND_COUNTERS = frozenset({"TON", "TOF", "TP", "CTU", "CTD", "CTUD"})
"""Blocks that S7 calls on an instance data block by name: ``"DB".TON(..)``."""

LACKED_BY_SCL = frozenset(
    """LOG ATAN2 IS_VALID IS_VALID_BCD TO_BIG_ENDIAN TO_LITTLE_ENDIAN FROM_BIG_ENDIAN FROM_LITTLE_ENDIAN DAY_OF_WEEK
    CONCAT_DATE CONCAT_TOD CONCAT_LTOD CONCAT_DT CONCAT_LDT CONCAT_DATE_LTOD SUB_DATE_DATE SUB_LDATE_LDATE
    SUB_TOD_TOD SUB_LTOD_LTOD SUB_DT_DT SUB_LDT_LDT ADD_TOD_TIME ADD_LTOD_LTIME ADD_DT_TIME ADD_LDT_LTIME
    SUB_TOD_TIME SUB_LTOD_LTIME SUB_DT_TIME SUB_LDT_LTIME SR RS""".split()
)
LACKED_BY_CODESYS = frozenset(
    """ATAN2 IS_VALID IS_VALID_BCD TO_BIG_ENDIAN TO_LITTLE_ENDIAN FROM_BIG_ENDIAN FROM_LITTLE_ENDIAN DAY_OF_WEEK
    CONCAT_DATE CONCAT_TOD CONCAT_LTOD CONCAT_DT CONCAT_LDT CONCAT_DATE_TOD CONCAT_DATE_LTOD""".split()
)
_ONLY_CODESYS = frozenset("ADR SIZEOF XSIZEOF BITADR INDEXOF INI TIME LTIME TEST_AND_SET".split())

_TIME_OPERATORS = {"ADD": Operator.ADD, "SUB": Operator.SUBTRACT, "MUL": Operator.MULTIPLY, "DIV": Operator.DIVIDE}
_TIME_FUNCTION = re.compile(r"(ADD|SUB|MUL|DIV)_(L?)(TIME|TOD|DT|DATE)(?:_L?(?:TIME|TOD|DT|DATE))?")


def is_of_codesys_alone(name: str) -> bool:
    """True for operators and functions of CODESYS that IEC 61131-3 and SCL do not have."""
    return name.upper() in _ONLY_CODESYS or name.startswith("__")


def has_function(dialect: Dialect, name: str) -> bool:
    """True for functions, operators and blocks that no project declares: standard ones, and those of CODESYS in it."""
    if family(dialect) is Dialect.CODESYS and is_of_codesys_alone(name):
        return True
    return standard_block(name) is not None or name.upper() in BOUND_FUNCTIONS


def operator_of(block: StandardBlock, target: Dialect) -> Operator | None:
    """Return the operator that `target` has in place of a function; None: it has the function, or has neither.

    SCL has no functional form of operators; neither SCL nor CODESYS has the functions for times, such as ``ADD_TIME``.
    """
    if target is Dialect.SCL and block.kind is BlockKind.OPERATOR:
        return block.operator
    found = _TIME_FUNCTION.fullmatch(block.name)
    if found is None or target is Dialect.IEC:
        return None
    lacked = LACKED_BY_SCL if target is Dialect.SCL else LACKED_BY_CODESYS
    return None if block.name in lacked else _TIME_OPERATORS[found[1]]


def is_called_otherwise(call: n.Call, target: Dialect) -> bool:
    """True for a call of a standard function that `target`, CODESYS or IEC 61131-3, writes otherwise, or lacks."""
    name = call.called.upper()
    if translated_truncation(name, target, "REAL") not in (None, name) or (
        name == "TRUNC" and target is not Dialect.IEC
    ):
        return True
    if _takes_bits(name) or name == "MUX" or (name in _CHOICES and any(map(_acts, call.arguments))):
        return True
    block = standard_block(name)
    if block is None or block.stateful:
        return False
    is_long = name == "CONCAT" and len(call.arguments) > 2 and target is not Dialect.IEC
    is_named = any(each.name is not None for each in call.arguments)
    return is_long or is_named or operator_of(block, target) is not None or is_lacking(name, target)


def _takes_bits(name: str) -> bool:
    """True for conversions that may take the bits as they are in some tools, and the number in others."""
    converted = _CONVERSION.fullmatch(name)
    if converted is None or converted[2] not in _NUMBERS.keys() | {"REAL", "LREAL"}:
        return False
    return converted[1] is None or converted.groups() in TAKING_BITS


def _counted_value(call: n.Call, name: str) -> n.Member | None:
    """Return the value of ``WORD_TO_X(counter.CV)``, if it is of a counter; None for other calls."""
    given = call.arguments[0].value if name.startswith("WORD_TO_") and len(call.arguments) == 1 else None
    value = n.bare(given) if given is not None else None
    return value if isinstance(value, n.Member) and value.name.identifier.upper() == "CV" else None


def is_lacking(name: str, target: Dialect) -> bool:
    """True if `target` is not known to have the standard function or block `name`."""
    return name in {Dialect.SCL: LACKED_BY_SCL, Dialect.CODESYS: LACKED_BY_CODESYS}.get(target, frozenset())


_TRUNCATION = re.compile(r"(?:(L?REAL)_)?TRUNC(?:_(S?INT|DINT|LINT|U\w+))?")


def translated_truncation(name: str, target: Dialect, real: str) -> str | None:
    """Return the name in `target` of a function that cuts off decimals; None: `name` is none, or it has none.

    ``REAL_TRUNC_DINT`` of IEC 61131-3 ed. 3 is ``TRUNC`` in SCL and CODESYS, ``REAL_TRUNC_INT`` is ``TRUNC_INT``.
    `real`: the type of the argument.
    """
    found = _TRUNCATION.fullmatch(name.upper())
    if found is None or name.upper() == "TRUNC":
        return None
    result = found[2]
    if target is Dialect.IEC:
        return f"{found[1] or real}_TRUNC_{result}"
    if target is Dialect.SCL:
        return "TRUNC" if result == "DINT" else f"TRUNC_{result}"
    return {"DINT": "TRUNC", "INT": "TRUNC_INT"}.get(result)


def block_of_type(type: str) -> StandardBlock | None:
    """The standard function block of an instance by its type; S7 tells types of times and counts behind the name."""
    name = re.sub(r"_(TIME|LTIME|U?[SDL]?INT)$", "", type.upper()).rpartition(".")[2].strip('"')
    return _BLOCKS.get(name)


_BLOCKS = {block.name: block for block in standard_blocks() if block.stateful}


_COMPARISONS = frozenset({"GT", "GE", "EQ", "LE", "LT"})
_CODESYS_PINS = frozenset({"SET", "SET1", "RESET", "RESET1", "LOAD"})
_IEC_PINS = frozenset({"S", "S1", "R", "R1", "LD"})
_ENABLING = frozenset({"EN", "ENO"})


_INEXACT = re.compile(
    r"L?REAL_TO_(?:U?[SDL]?INT|BYTE|[DL]?WORD)|(?P<text>(?:L?REAL|U?[SDL]?INT|L?TIME|DATE|TOD|DT)_TO_W?STRING)"
)
"""Conversions whose results are others in S7."""
_OF_DATES = re.compile(r"(?P<source>[A-Z]+)_TO_(?P<result>[A-Z]+)")
_DATES = frozenset({"DATE", "LDATE", "DT", "LDT"})
_FROM_DATES = frozenset({"DT_TO_DATE", "DT_TO_TOD", "LDT_TO_DATE", "LDT_TO_TOD", "LDT_TO_LTOD"})
"""Conversions of dates that S7 has, and that give the same there."""
_OF_S5 = re.compile(r"S_(?:PULSE|PEXT|ODTS?|OFFDT|CU|CD|CUD)")
"""Functions of S7 that act on timers and counters of S5."""
_TO_BOOL = re.compile(r"(?:[A-Z]+_)?TO_BOOL")
_BIT_STRINGS = frozenset({"BYTE", "WORD", "DWORD", "LWORD"})
_SHIFTS = frozenset({"SHL", "SHR", "ROL", "ROR"})
_HALVES = "CODESYS rounds halves away from zero, {tool} to even numbers: 2.5 is 3 in CODESYS and 2 in {tool}"
HALVES = _HALVES.format(tool="S7")
"""Difference where a number with decimals becomes one without."""


TAKING_BITS = {("DWORD", "REAL"), ("REAL", "DWORD"), ("LWORD", "LREAL"), ("LREAL", "LWORD")}
"""Conversions that take the bits as they are in IEC 61131-3 (ed. 3, table 22) and in S7, and the number in CODESYS."""
_NUMBERS = {"DWORD": "UDINT", "LWORD": "ULINT"}
_LACKED_CONVERSIONS = {("TIME", "STRING"), ("LTIME", "STRING"), ("STRING", "BOOL"), ("STRING", "TIME")}
"""Conversions that SCL has no words for."""
_CONVERSION = re.compile(r"(?:([A-Z]+)_)?TO_([A-Z]+)")
_TO_TIMES = frozenset({"REAL_TO_TIME", "LREAL_TO_TIME"})
_QUOTIENTS = frozenset({Operator.DIVIDE, Operator.MODULO})
_CHOICES = {"SEL": 1, "MUX": 1}
"""Functions of which CODESYS evaluates the argument alone that is taken, and how many others come before these."""


def is_mixed(node: n.Call) -> bool:
    """True for a call with inputs by position and others, or outputs, by name: only CODESYS V3 takes one."""
    return len({argument.name is None for argument in node.arguments}) > 1


def other_rounding(name: str, source: Dialect, target: Dialect) -> str:
    """Return what a function for numbers gives otherwise in another family of dialects; empty: nothing."""
    tools, matched = {source, target}, _INEXACT.fullmatch(name)
    if matched is None or matched["text"] or Dialect.CODESYS not in tools or len(tools) == 1:
        return ""
    return f"{name}: {_HALVES.format(tool=_other_tool(tools))}"


def other_bits(name: str, source: Dialect, target: Dialect) -> str:
    """Return what a function for bit strings and real numbers gives otherwise in another family; empty: nothing."""
    tools = {source, target}
    if tuple(name.split("_TO_")) not in TAKING_BITS or Dialect.CODESYS not in tools or len(tools) == 1:
        return ""
    return f"{name}: CODESYS converts the number, {_other_tool(tools)} takes its bits as they are"


def _other_tool(tools: Collection[Dialect]) -> str:
    """Return the one that is not CODESYS."""
    return "S7" if Dialect.SCL in tools else TITLES[Dialect.IEC]


class CallTranslator:
    """Translates calls. `translated` does so with the expressions inside them."""

    def __init__(
        self,
        source: Dialect,
        target: Dialect,
        names: NameTranslator,
        notes: Notes,
        translated: Callable[[Expression], Expression],
        *,
        types: ExpressionTypes,
    ) -> None:
        self._types = types
        self._source, self._target = source, target
        self._names = names
        self._notes = notes
        self._translated = translated

    def call(self, node: n.Call) -> Expression:
        """Return a call in the target dialect; where that has an operator instead, an expression with it."""
        callee = node.callee
        if self._target is Dialect.SCL and self._source is not Dialect.SCL and isinstance(callee, n.Name):
            inputs = self._names.inputs_of(callee)
            if inputs is not None:
                return self._with(node, self._names.function(callee), self._by_name(node, inputs))
            if self._names.is_action(callee) and not self._names.is_instance(callee):
                self._notes.add(Severity.ERROR, f"S7 has no actions and methods to call: {callee.identifier}", callee)
        if self._target is Dialect.IEC is not self._source and isinstance(callee, n.Name) and is_mixed(node):
            inputs = self._names.inputs_of(callee)
            if inputs is not None:
                return self._with(node, callee, self._by_name(node, inputs))
        if isinstance(callee, n.Name) and self._is_function(callee):
            return self._function(node, callee)
        if isinstance(callee, n.Member) and self._names_timer(callee.name):
            block = standard_block(callee.name.identifier)
            return self._with(node, self._translated(callee.base), self._instance_arguments(node, block))
        block = block_of_type(self._names.type_of(callee))
        arguments = self._instance_arguments(node, block)
        return self._with(node, self._instance(callee, block), arguments)

    def action(self, callee: Expression) -> Expression:
        """Return the action that is called without parentheses, as in CODESYS."""
        if self._target is Dialect.SCL and not self._names.is_instance(callee):
            self._notes.add(Severity.ERROR, "SCL has no actions to call", callee)
        return n.Call(self._callee(callee), span=callee.span)

    # -- instances ----------------------------------------------------------------------------------------------------

    def _names_timer(self, name: n.Name) -> bool:
        """True if this is the TON of ``"DB".TON(..)`` of SCL, which calls the instance and not a part of it."""
        leaves_scl = self._source is Dialect.SCL and self._target is not Dialect.SCL
        return leaves_scl and name.identifier.upper() in S7_TIMERS_AND_COUNTERS

    def _instance(self, callee: Expression, block: StandardBlock | None) -> Expression:
        if self._target is not Dialect.SCL or self._source is Dialect.SCL:
            return self._callee(callee)
        if block is None:
            is_known = self._names.type_of(callee) or self._names.is_instance(callee)
            if isinstance(callee, n.Member) and not is_known:
                reason = "S7 calls instances, neither methods nor actions: this is right only if it is an instance"
                self._notes.add(Severity.WARNING, reason, callee)
            return self._callee(callee)
        if is_lacking(block.name, self._target):
            reason = f"SCL has no function block {block.name}: LAD and FBD have it as a box with an operand"
            self._notes.add_lacking(reason, block.name, callee)
        elif block.name in S7_TIMERS_AND_COUNTERS and self._is_global(callee):
            return n.Member(self._callee(callee), n.Name(block.name), span=callee.span)
        return self._callee(callee)

    def _is_global(self, callee: Expression) -> bool:
        return isinstance(callee, n.Name) and self._names.is_local(callee) is False

    def _callee(self, callee: Expression) -> Expression:
        if isinstance(callee, n.Name):
            return self._names.listed(callee) or self._names.block(callee)
        return self._translated(callee)

    def _instance_arguments(self, node: n.Call, block: StandardBlock | None) -> tuple[Argument, ...]:
        if block is None:
            self._note_unknown_pins(node)
            return self._arguments(node.arguments, self._names.member)
        return self._arguments(node.arguments, self._pins_of(block))

    def _note_unknown_pins(self, node: n.Call) -> None:
        """CODESYS has other pins at flip-flops and counters: whose type is not known, those cannot be translated."""
        if Dialect.CODESYS not in (self._source, self._target):
            return
        pins = _CODESYS_PINS if self._source is Dialect.CODESYS else _IEC_PINS
        used = [a.name.identifier for a in node.arguments if a.name and a.name.identifier.upper() in pins]
        if used and not self._names.type_of(node.callee):
            reason = f"the type of this instance is not known: {', '.join(used)} may have another name in the target"
            self._notes.add(Severity.WARNING, reason, node.callee)

    def pin(self, base: Expression, name: n.Name) -> n.Name | None:
        """Return the name of a pin of a standard block behind its instance (``counter.RESET``); None: it is none."""
        block = block_of_type(self._names.type_of(base))
        return None if block is None else self._pin(name, block)

    def _pin(self, name: n.Name, block: StandardBlock) -> n.Name | None:
        new = block.pin_in(name.identifier, Tool.CODESYS if self._target is Dialect.CODESYS else None)
        if new is None:
            return None
        return name if new.casefold() == name.identifier.casefold() else n.Name(new, span=name.span)

    def _by_name(self, node: n.Call, inputs: Sequence[str]) -> tuple[Argument, ...]:
        """Return the arguments of a function of the project with the names of its inputs, those by position first."""
        arguments = self._arguments(node.arguments, self._names.member)
        by_position = [argument for argument in arguments if argument.name is None]
        if len(by_position) > len(inputs):
            self._notes.add(Severity.ERROR, "there are more arguments than inputs; left as they stand", node)
            return arguments
        names = iter(inputs)
        return tuple(
            argument if argument.name is not None else replace(argument, name=self._names.member(n.Name(next(names))))
            for argument in arguments
        )

    # -- functions ----------------------------------------------------------------------------------------------------

    def _is_function(self, callee: n.Name) -> bool:
        """True if a name is that of a function which the language brings along."""
        if callee.quoting is not n.Quoting.NONE or self._names.is_local(callee) is True:
            return False
        if self._names.inputs_of(callee) is not None:
            return False
        block = standard_block(callee.identifier)
        if block is not None:
            return not block.stateful
        word = callee.identifier.upper()
        if self._source is Dialect.SCL:  # others are in quotes, but local instances of a source file may be without
            return self._names.is_local(callee) is False or not self._names.type_of(callee)
        if self._source is Dialect.CODESYS and is_of_codesys_alone(word):
            return True
        return word in BOUND_FUNCTIONS or translated_truncation(word, self._target, "REAL") is not None

    def _function(self, node: n.Call, callee: n.Name) -> Expression:
        name = callee.identifier.upper()
        counted = self._counted(node, name)
        if counted is not None:
            return counted
        block = standard_block(name)
        arguments = self._arguments(node.arguments, self._pins_of(block) if block is not None else lambda name: name)
        truncated = translated_truncation(name, self._target, self._type_of_first(node) or "REAL")
        if truncated is not None:
            return self._with(node, self._named(callee, truncated), arguments)
        converted = _CONVERSION.fullmatch(name)
        if converted is not None and len(arguments) == 1 and arguments[0].value is not None:
            kinds = converted[1] or self._type_of_first(node), converted[2]
            if (other := self._other_conversion(node, *kinds, arguments[0].value)) is not None:
                return other
        if name in _CHOICES:
            arguments = self._chosen(node, name, arguments)
        if _TO_BOOL.fullmatch(name) and (asked := self._as_bool(node, name)) is not None:
            return asked
        if re.fullmatch(r"TO_\w+", name):
            if self._target is Dialect.SCL:
                return self._converted(node, callee, name, arguments)
            self._note_conversion(node, f"{self._type_of_first(node)}_{name}")
        if block is None:
            return self._unknown(node, callee, name, arguments)
        self._note_conversion(node, name)
        if name in _SHIFTS and self._target is Dialect.IEC is not self._source and "INT" in self._type_of_first(node):
            reason = f"{TITLES[Dialect.IEC]} has {name} of bit strings only, not of {self._type_of_first(node)}"
            self._notes.add(Severity.ERROR, f"{reason}; left unchanged", node)
        values = self._in_order(block, arguments)
        operator = operator_of(block, self._target)
        if values is not None and operator is not None and (len(values) == 2 or name not in _COMPARISONS):
            return _operation(operator, values, node)
        if name == "MOVE" and self._target is Dialect.SCL and values is not None and len(values) == 1:
            return values[0]
        if operator is not None or is_lacking(name, self._target) or (name == "MOVE" and self._target is Dialect.SCL):
            self._notes.add_lacking(f"{TITLES[self._target]} has no function {name}", name, callee)
            return self._with(node, callee, arguments)
        if name == "CONCAT" and self._target is not Dialect.IEC and values is not None and len(values) > 2:
            return self._nested(node, callee, block, values)
        return self._with(node, callee, self._in_style(node, block, arguments, values))

    def _counted(self, node: n.Call, name: str) -> Expression | None:
        """Return a conversion of what a counter has counted, which is INT in IEC 61131-3 and WORD in CODESYS."""
        value = _counted_value(node, name)
        if value is None or self._target is not Dialect.IEC or self._source is not Dialect.CODESYS:
            return None
        block = block_of_type(self._names.type_of(value.base))
        if block is None or block.output_name("CV") is None:
            return None
        own = f"INT_{name.removeprefix('WORD_')}"
        counted = self._translated(value)
        return counted if own == "INT_TO_INT" else n.Call(n.Name(own), (Argument(counted),), span=node.span)

    def _as_bool(self, node: n.Call, name: str) -> Expression | None:
        """Return a number or bit string as a Boolean, as the source takes it; None where the target takes it so too.

        S7-SCL manual, conversions of class B: the least significant bit counts. CODESYS help, "BOOL Conversions", and
        matiec: all that is not 0 is TRUE.
        """
        tools = {self._source, self._target}
        if Dialect.SCL not in tools or len(tools) == 1 or len(node.arguments) != 1 or node.arguments[0].value is None:
            return None
        type_ = name.removesuffix("TO_BOOL").removesuffix("_") or self._type_of_first(node)
        value = self._translated(node.arguments[0].value)
        zero = "16#0" if type_ in _BIT_STRINGS else "0.0" if type_.endswith("REAL") else "0"
        if type_ in _BIT_STRINGS and self._source is Dialect.SCL:
            bit = _operation(Operator.AND, [value, n.Literal("16#1")], node)
            return n.Call(n.Name(f"{type_}_TO_BOOL"), (Argument(bit),), span=node.span)
        if (type_ in _BIT_STRINGS or type_.endswith(("INT", "REAL"))) and self._target is Dialect.SCL:
            return n.Parenthesized(_operation(Operator.UNEQUAL, [value, n.Literal(zero)], node), span=node.span)
        return None

    def _other_conversion(self, node: n.Call, source: str, result: str, value: Expression) -> Expression | None:
        """Return a conversion by others where the target does something else, or has none; None where it does."""
        name = f"{source}_TO_{result}"
        if (source, result) in TAKING_BITS and self._source is not self._target:
            if self._source is Dialect.CODESYS:
                if reason := other_rounding(name, self._source, self._target):
                    self._notes.add(Severity.WARNING, reason, node)
                return number_of_bits(source, result, value, node)
            if self._target is Dialect.CODESYS:
                reason = other_bits(name, self._source, self._target)
                self._notes.add(Severity.ERROR, f"{reason}; left unchanged", node)
            return None
        if self._target is not Dialect.SCL or self._source is Dialect.SCL:
            return None
        if (source == "TIME" and result in ("REAL", "LREAL")) or (source in ("REAL", "LREAL") and result == "TIME"):
            if source != "TIME" and (reason := other_rounding(f"{source}_TO_DINT", self._source, self._target)):
                self._notes.add(Severity.WARNING, reason, node)
            return _by_way_of("DINT", source, result, value, node)
        if (source, result) == ("BOOL", "STRING"):
            pairs = (("G", value), ("IN0", n.Literal("'FALSE'")), ("IN1", n.Literal("'TRUE'")))
            return n.Call(n.Name("SEL"), tuple(Argument(each, n.Name(pin)) for pin, each in pairs), span=node.span)
        if (source in ("TIME", "LTIME") and result == "STRING") or (source == "STRING" and result in ("BOOL", "TIME")):
            self._notes.add_lacking(f"SCL has no {name}", name, node)
        return None

    def _chosen(self, node: n.Call, name: str, arguments: tuple[Argument, ...]) -> tuple[Argument, ...]:
        """Return the arguments of SEL and MUX; where the selector of MUX is greater, CODESYS takes the last."""
        tools = {self._source, self._target}
        if Dialect.CODESYS not in tools or len(tools) == 1 or len(node.arguments) < _CHOICES[name] + 1:
            return arguments
        other = _other_tool(tools)
        if any(map(_acts, node.arguments[_CHOICES[name] :])):
            reason = f"CODESYS evaluates the argument of {name} alone that is taken, {other} all of them"
            self._notes.add(Severity.WARNING, reason, node)
        selector, last = node.arguments[0].value, len(node.arguments) - 2
        if name != "MUX" or selector is None:
            return arguments
        known = self._types.value(selector)
        if known.is_whole and 0 <= known.low <= known.high <= last:
            return arguments
        if self._target is Dialect.CODESYS:
            reason = f"MUX of CODESYS takes the last argument where its selector is greater, {other} none"
            self._notes.add(Severity.WARNING, reason, node)
            return arguments
        pins = ("IN1", "IN2") if self._target is Dialect.SCL else (None, None)
        values = (arguments[0].value or selector, n.Literal(str(last)))
        limited = tuple(Argument(each, n.Name(pin) if pin else None) for pin, each in zip(pins, values, strict=True))
        return (replace(arguments[0], value=n.Call(n.Name("MIN"), limited)), *arguments[1:])

    def _note_conversion(self, node: n.Call, name: str) -> None:
        """Say what a conversion gives otherwise in S7 and in other tools."""
        tools = {self._source, self._target}
        matched = _INEXACT.fullmatch(name)
        if matched is not None and matched["text"] and Dialect.SCL in tools:
            reason = f"S7 writes the text of {name} otherwise: signs, blanks and exponents differ"
            self._notes.add(Severity.WARNING, reason, node)
        elif reason := other_rounding(name, self._source, self._target):
            self._notes.add(Severity.WARNING, reason, node)
        elif name in _TO_TIMES and Dialect.SCL not in tools and len(tools) > 1:
            reason = "CODESYS rounds to whole milliseconds, IEC 61131-3 keeps the fraction"
            self._notes.add(Severity.WARNING, f"{name}: {reason}", node)
        dated = _OF_DATES.fullmatch(name)
        if dated is not None and Dialect.SCL in tools and len(tools) > 1 and name not in _FROM_DATES:
            kinds = {dated["source"], dated["result"]}
            if kinds & {"DT", "LDT"}:
                reason = f"S7 has no {name}: its DATE_AND_TIME is no number"
                self._notes.add(Severity.ERROR, f"{reason}; left unchanged", node)
            elif kinds & _DATES and not (matched is not None and matched["text"]):
                reason = "S7 counts days since 1990-01-01, CODESYS seconds since 1970-01-01"
                self._notes.add(Severity.ERROR, f"{name}: {reason}; left unchanged", node)

    def _unknown(self, node: n.Call, callee: n.Name, name: str, arguments: tuple[Argument, ...]) -> Expression:
        """Return a function that IEC 61131-3 does not have."""
        target = TITLES[self._target]
        if name in BOUND_FUNCTIONS:
            return self._with(node, callee, self._bound_arguments(arguments))
        if self._source is Dialect.SCL and len(arguments) == 1 and arguments[0].value is not None:
            if name == "S5TIME_TO_TIME":  # variables of that type are a TIME elsewhere
                return arguments[0].value
            if name == "SQR":
                return self._square(node, arguments[0].value)
            if name == "ROUND":
                type = self._type_of_first(node)
                severity = Severity.WARNING if self._target is Dialect.CODESYS else Severity.INFO
                reason = "ROUND became a conversion: halves are rounded to even numbers by S7 and IEC 61131-3"
                self._notes.add(severity, reason, node)
                return self._with(node, self._named(callee, f"{type}_TO_DINT" if type else "TO_DINT"), arguments)
        if self._source is not Dialect.SCL:
            reason = f"{target} has no counterpart of {name}"
        elif _OF_S5.fullmatch(name):
            reason = f"{name} is no standard function of {target}, which has no timers and counters of S5"
        else:
            reason = f"{name} is no standard function of {target}, which needs one of this name"
        self._notes.add_lacking(reason, name, callee)
        return self._with(node, callee, arguments)

    def _square(self, node: n.Call, value: Expression) -> Expression:
        if isinstance(n.bare(value), n.Name | n.Member | n.Literal):
            return _operation(Operator.MULTIPLY, [value, value], node)
        self._notes.add(Severity.WARNING, "SQR became a power, which is REAL", node)
        if self._target is Dialect.IEC:
            return _operation(Operator.POWER, [value, n.Literal("2")], node)
        return n.Call(n.Name("EXPT"), (Argument(value), Argument(n.Literal("2"))), span=node.span)

    def _converted(self, node: n.Call, callee: n.Name, name: str, arguments: tuple[Argument, ...]) -> Expression:
        type = self._type_of_first(node)
        if f"TO_{type}" == name and len(arguments) == 1 and arguments[0].value is not None:
            return n.Parenthesized(arguments[0].value, span=node.span)
        if type:
            self._note_conversion(node, f"{type}_{name}")
            return self._with(node, self._named(callee, f"{type}_{name}"), arguments)
        reason = f"SCL has no {callee.identifier}: there the name of a conversion tells the source type too"
        self._notes.add(Severity.ERROR, f"{reason}, which is not known; left unchanged", callee)
        return self._with(node, callee, arguments)

    def _type_of_first(self, node: n.Call) -> str:
        value = node.arguments[0].value if node.arguments else None
        if value is None:
            return ""
        type = self._names.type_of(n.bare(value)).upper() or self._types.value(value).type
        return type if type.isalpha() else ""

    # -- arguments ----------------------------------------------------------------------------------------------------

    def _arguments(
        self, arguments: tuple[Argument, ...], parameter: Callable[[n.Name], n.Name]
    ) -> tuple[Argument, ...]:
        """Translated arguments; `parameter` gives the names of parameters in the target."""
        found = []
        for argument in arguments:
            if self._says_nothing(argument):
                self._notes.add(
                    Severity.INFO, "a parameter without a value was left out: it keeps what it has", argument
                )
            else:
                found.append(self._argument(argument, parameter))
        same = len(found) == len(arguments) and all(a is b for a, b in zip(found, arguments, strict=True))
        return arguments if same else tuple(found)

    def _says_nothing(self, argument: Argument) -> bool:
        """``IN := ,`` keeps the value that IN has: only CODESYS writes that."""
        return argument.value is None and self._source is Dialect.CODESYS and self._target is not Dialect.CODESYS

    def _argument(self, argument: Argument, parameter: Callable[[n.Name], n.Name]) -> Argument:
        value = None if argument.value is None else self._translated(argument.value)
        name = argument.name
        if name is not None and self._source is not self._target:
            name = self._enabling(name) or parameter(name)
        if argument.negated and self._target is not Dialect.IEC and self._source is not self._target:
            self._notes.add(Severity.ERROR, f"{TITLES[self._target]} has no negated outputs; left unchanged", argument)
        if value is argument.value and name is argument.name:
            return argument
        return replace(argument, value=value, name=name)

    def _enabling(self, name: n.Name) -> n.Name | None:
        if name.identifier.upper() not in _ENABLING:
            return None
        if self._target is Dialect.CODESYS:
            reason = f"CODESYS has no {name.identifier.upper()} in structured text; left unchanged"
            self._notes.add(Severity.ERROR, reason, name)
        return name

    def _pins_of(self, block: StandardBlock) -> Callable[[n.Name], n.Name]:
        def pin(name: n.Name) -> n.Name:
            found = self._pin(name, block)
            if found is None:
                reason = f"{block.name} of {TITLES[self._target]} has no parameter {name.identifier}; left unchanged"
                self._notes.add(Severity.ERROR, reason, name)
            return found or name

        return pin

    def _in_order(self, block: StandardBlock, arguments: tuple[Argument, ...]) -> list[Expression] | None:
        """Return the values of all inputs in their order; None: some are missing, or there is more than inputs."""
        count = len(arguments)
        pins = block.input_pins(count)[:count]
        values: dict[str, Expression] = {}
        for argument, position in zip(arguments, pins, strict=False):
            if argument.value is None or argument.output:
                return None
            name = position.name if argument.name is None else block.input_name(argument.name.identifier)
            if name is None:
                return None
            values[name] = argument.value
        ordered = [values[pin.name] for pin in pins if pin.name in values]
        return ordered if len(ordered) == count and count >= len(block.inputs) else None

    def _in_style(
        self, node: n.Call, block: StandardBlock, arguments: tuple[Argument, ...], values: list[Expression] | None
    ) -> tuple[Argument, ...]:
        """Arguments as the target takes them: CODESYS by position, SCL by name where there are several."""
        if self._source is self._target or self._target is Dialect.IEC:
            return arguments
        named = any(argument.name is not None for argument in arguments)
        if values is None:
            if named and self._target is Dialect.CODESYS:
                reason = f"CODESYS takes the arguments of {block.name} by position, here that cannot be done"
                self._notes.add(Severity.ERROR, f"{reason}; left unchanged", node)
            elif not named:
                reason = f"the arguments of {block.name} are not its inputs; left as they stand"
                self._notes.add(Severity.ERROR, reason, node)
            return arguments
        if self._target is Dialect.CODESYS:
            return tuple(n.Argument(value, span=value.span) for value in values) if named else arguments
        if len(arguments) < 2 or named:
            return arguments
        pins = block.input_pins(len(arguments))
        pairs = zip(arguments, pins, strict=True)
        return tuple(replace(argument, name=n.Name(pin.name)) for argument, pin in pairs)

    def _bound_arguments(self, arguments: tuple[Argument, ...]) -> tuple[Argument, ...]:
        if self._target is Dialect.SCL and len(arguments) == 2 and all(a.name is None for a in arguments):
            pairs = zip(arguments, ("ARR", "DIM"), strict=True)
            return tuple(replace(argument, name=n.Name(name)) for argument, name in pairs)
        if self._source is Dialect.SCL and [a.name and a.name.identifier.upper() for a in arguments] == ["ARR", "DIM"]:
            return tuple(replace(argument, name=None) for argument in arguments)
        return arguments

    def _nested(self, node: n.Call, callee: n.Name, block: StandardBlock, values: list[Expression]) -> Expression:
        """CONCAT of two at a time, where the target takes no more."""
        joined = values[0]
        for value in values[1:]:
            pair = (Argument(joined), Argument(value))
            joined = n.Call(callee, self._in_style(node, block, pair, [joined, value]))
        return joined

    def _named(self, callee: n.Name, name: str) -> n.Name:
        return callee if name == callee.identifier.upper() else n.Name(name, span=callee.span)

    def _with(self, node: n.Call, callee: Expression, arguments: tuple[Argument, ...]) -> n.Call:
        if callee is node.callee and arguments is node.arguments:
            return node
        return replace(node, callee=callee, arguments=arguments)


def number_of_bits(source: str, result: str, value: Expression, node: n.Call) -> Expression:
    """Return a conversion of a bit string and a real number, one of `TAKING_BITS`, by the number that the bits are."""
    return _by_way_of(_NUMBERS.get(source) or _NUMBERS[result], source, result, value, node)


def _by_way_of(between: str, source: str, result: str, value: Expression, node: n.Call) -> Expression:
    """Return a conversion by way of another type."""
    inner = n.Call(n.Name(f"{source}_TO_{between}"), (Argument(n.bare(value)),))
    return n.Call(n.Name(f"{between}_TO_{result}"), (Argument(inner),), span=node.span)


def _acts(argument: Argument) -> bool:
    """True if it may make a difference whether an argument is evaluated: calls of programs, and divisions."""
    for node in walk(argument.value) if argument.value is not None else ():
        if isinstance(node, n.Call) and standard_block(node.called) is None:
            return True
        divisors = node.operands[1:] if isinstance(node, n.Operation) and node.operator in _QUOTIENTS else ()
        if not all(isinstance(each, n.Literal) for each in divisors):
            return True
    return False


def _operation(operator: Operator, values: list[Expression], node: n.Call) -> Expression:
    """Return an operation in place of a call."""
    if len(values) == 1:
        return n.Unary(operator, values[0], span=node.span)
    if operator is Operator.POWER:  # not all tools agree on what powers of powers are
        values = [n.Parenthesized(value) if isinstance(value, n.Operation) else value for value in values]
    return n.Operation(operator, tuple(values), span=node.span)
