"""Translation of the standard functions (ed. 3, 6.6.2.5) and of those that CODESYS and S7 have besides.

Arguments are in the order of `languages.standard_blocks`; `function_runtime` has the functions themselves.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from itertools import pairwise

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Operator
from plcopen_sfc.languages.standard_blocks import BlockKind, StandardBlock, standard_block
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs import function_runtime, matiec_runtime
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.operators import Operators
from plcopen_sfc.semantics.programs.paths import PathTranslator
from plcopen_sfc.semantics.programs.places import Place
from plcopen_sfc.semantics.programs.value_code import Code, constant, ranged, settled

_CONVERSION = re.compile(r"(?:(?P<source>\w+?)_)?TO_(?P<target>\w+)")
_TRUNCATION = re.compile(r"(?:(?P<source>L?REAL)_)?TRUNC_(?P<target>\w+)")
_BCD = re.compile(
    r"(?:(?P<from>\w+)_)?BCD(?:\d*)_TO_(?P<target>\w+)|(?:(?P<source>\w+)_)?TO_BCD(?:\d+|_(?P<word>\w+))?"
)
_ORDINARY = {
    "CEIL": ("IN",),
    "FLOOR": ("IN",),
    "ROUND": ("IN",),
    "SQR": ("IN",),
    "FRAC": ("IN",),
    "NORM_X": ("MIN", "VALUE", "MAX"),
    "SCALE_X": ("MIN", "VALUE", "MAX"),
    "T_ADD": ("IN1", "IN2"),
    "T_SUB": ("IN1", "IN2"),
    "T_DIFF": ("IN1", "IN2"),
    "T_COMBINE": ("IN1", "IN2"),
    "CONCAT_DATE_TOD": ("IN1", "IN2"),
    "SWAP": ("IN",),
    "CONVERT": ("IN",),
    "S_MOVE": ("IN",),
    "TIME": (),
    "LTIME": (),
}
"""Functions that the table of standard blocks does not have, and their inputs."""


class StandardFunctions:
    """Translates calls of functions that the project does not have."""

    def __init__(self, translator: PathTranslator) -> None:
        self._translator = translator
        self._library = translator.library
        self._converter = translator.library.converter
        self._operators = Operators(translator)

    def value(self, name: str, arguments: Sequence[n.Argument], expected: t.Type | None) -> Code | None:
        """Return the result of a call; None if the function is not known."""
        key = name.upper()
        special = self._special(key, arguments)
        if special is not None:
            return special
        block = standard_block(key)
        if block is not None and block.kind is BlockKind.FUNCTION_BLOCK:
            raise SimulationError(f"{name} is a function block: only an instance of it can be called")
        inputs = [a for a in arguments if not (a.name is not None and a.name.identifier.upper() in ("EN", "ENO"))]
        if len(inputs) < len(arguments):
            raise SimulationError(f"{name} is called with EN or ENO inside an expression")
        converted = self._conversion(key, inputs)
        if converted is not None:
            return converted
        if block is None or not block.inputs:
            if key not in _ORDINARY:
                return None
            return self._ordinary(key, self._named(key, inputs, _ORDINARY[key]), expected)
        values = self._in_order(block, inputs)
        if block.operator is not None:
            return self._operator(block.operator, values, expected)
        return self._ordinary(block.name, values, expected)

    # -- arguments

    def _in_order(self, block: StandardBlock, arguments: Sequence[n.Argument]) -> list[n.Expression]:
        pins = [pin.name for pin in block.input_pins(len(arguments))]
        given: dict[str, n.Expression] = {}
        for index, argument in enumerate(arguments):
            if argument.output:
                raise SimulationError(f"{block.name} has no such output")
            pin = block.input_name(argument.name.identifier) if argument.name is not None else None
            if argument.name is not None and pin is None:
                raise SimulationError(f"{block.name} has no input {argument.name.identifier}")
            pin = pin or (pins[index] if index < len(pins) else None)
            if pin is None:
                raise SimulationError(f"{block.name} is called with too many arguments")
            if argument.value is not None:
                given[pin] = argument.value
        missing = [pin for pin in pins if pin not in given]
        if missing:
            raise SimulationError(f"{block.name} is called without {missing[0]}")
        return [given[pin] for pin in pins]

    def _named(self, name: str, arguments: Sequence[n.Argument], pins: Sequence[str]) -> list[n.Expression]:
        given: dict[str, n.Expression] = {}
        for pin, argument in zip(pins, arguments, strict=False):
            own = argument.name.identifier.upper() if argument.name is not None else pin
            if argument.value is not None:
                given[own] = argument.value
        if sorted(given) != sorted(pins) or len(arguments) != len(pins):
            raise SimulationError(f"{name} wants the arguments {', '.join(pins) or '(none)'}")
        return [given[pin] for pin in pins]

    def _codes(self, nodes: Sequence[n.Expression], expected: t.Type | None) -> list[Code]:
        """Return the values; an undeclared variable takes the type of the first that has one."""
        known = [self._operators.known_type(node) for node in nodes]
        wanted = next((type_ for type_ in known if type_ is not None), expected)
        return [self._translator.value(node, wanted) for node in nodes]

    def _helper(self, name: str) -> str:
        is_other = self._library.profile.matiec_library and hasattr(matiec_runtime, name)
        return self._library.linker.name(getattr(matiec_runtime if is_other else function_runtime, name), "h")

    def _call(self, name: str, codes: Sequence[Code], type_: t.Type, *extra: object) -> Code:
        texts = [settled(code).text for code in codes] + [repr(item) for item in extra]
        acts = any(code.acts for code in codes)
        return ranged(f"{self._helper(name)}({', '.join(texts)})", type_, acts=acts)

    def _as(self, node: n.Expression, type_: t.ScalarType) -> Code:
        return settled(self._converter.converted(self._translator.value(node, type_), type_))

    # -- groups

    def _special(self, key: str, arguments: Sequence[n.Argument]) -> Code | None:
        """Translate what looks like a function and is none."""
        if key in ("ADR", "REF", "__NEW", "__DELETE", "__QUERYINTERFACE", "BITADR", "__ISVALIDREF"):
            value = arguments[0].value if len(arguments) == 1 else None
            if value is not None and key in ("ADR", "REF"):
                place = self._translator.place(value)
                if place.bits is not None:
                    raise SimulationError(f"a part of {place.path} has no address here")
                self._translator.note_pointed(place)
                return Code(f"Pointer({place.cells}, {place.index})", t.ReferenceType("reference", place.type))
            if value is not None and key == "__ISVALIDREF":
                held = self._translator.meaning(value)
                if isinstance(held, Place) and isinstance(held.type, t.ReferenceType):
                    return Code(f"({held.text} is not None)", t.BOOL)
            raise SimulationError(f"{key} is not known to the simulator")
        if key in ("SIZEOF", "XSIZEOF") and len(arguments) == 1 and arguments[0].value is not None:
            found = self._translator.meaning(arguments[0].value)
            type_ = found.type if isinstance(found, Place) else found
            if not isinstance(type_, t.Type):
                raise SimulationError("SIZEOF of something that is no variable")
            return constant(_size(type_), t.ELEMENTARY["UDINT"])
        if key in ("LOWER_BOUND", "UPPER_BOUND") and len(arguments) == 2:
            return self._bound(key, arguments)
        return None

    def _bound(self, key: str, arguments: Sequence[n.Argument]) -> Code:
        array, dimension = (argument.value for argument in arguments)
        if array is None or dimension is None:
            raise SimulationError(f"{key} is called without an argument")
        place, code = self._translator.place(array), self._translator.value(dimension, t.DINT)
        if not isinstance(place.type, t.ArrayOf):
            raise SimulationError(f"{key} of something that is no array")
        if not place.type.dimensions:
            return ranged(f"{place.text}.bound({settled(code).text}, {int(key == 'UPPER_BOUND')})", t.DINT)
        if not code.constant:
            raise SimulationError(f"{key} of a dimension that is no constant")
        if not 1 <= code.value <= len(place.type.dimensions):
            raise SimulationError(f"{place.path} has no dimension {code.value}")
        return constant(place.type.dimensions[code.value - 1][key == "UPPER_BOUND"], t.DINT)

    def _operator(self, operator: Operator, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        if operator is Operator.NOT:
            return self._operators.value(n.Unary(operator, nodes[0]), expected)
        if operator in (Operator.AND, Operator.OR, Operator.XOR, Operator.ADD, Operator.MULTIPLY) or len(nodes) == 2:
            return self._operators.value(n.Operation(operator, tuple(nodes)), expected)
        pairs = tuple(n.Operation(operator, pair) for pair in pairwise(nodes))
        return self._operators.value(n.Operation(Operator.AND, pairs), expected)

    def _ordinary(self, name: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        found = _FUNCTIONS.get(name)
        if found is not None:
            return found(self, name, nodes, expected)
        raise SimulationError(f"{name} is not known to the simulator")

    def _real(self, name: str, nodes: list[n.Expression], _: t.Type | None) -> Code:
        codes = [self._translator.value(node, t.REAL) for node in nodes]
        reals = [c.type for c in codes if isinstance(c.type, t.ScalarType) and c.type.family is t.Family.REAL]
        type_ = max(reals, key=lambda r: r.bits, default=t.LREAL)
        codes = [self._converter.converted(code, type_) for code in codes]
        result = self._call(name.lower(), codes, type_)
        return Code(f"single({result.text})", type_, acts=result.acts) if type_.bits == 32 else result

    def _move(self, _: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        return self._translator.value(nodes[0], expected)

    def _abs(self, _: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        code = settled(self._translator.value(nodes[0], expected))
        if not isinstance(code.type, t.ScalarType) or not (code.type.is_number or code.type.is_ranged):
            raise SimulationError(f"ABS of {code.type.name}")
        high = max(abs(code.low), abs(code.high))
        return Code(f"abs({code.text})", code.type, 0, high, acts=code.acts)

    def _choice(self, name: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        """MAX, MIN, LIMIT: of values of one type."""
        codes = self._one_type(self._codes(nodes, expected))
        if name == "LIMIT":
            return self._call("limit", codes, codes[0].type)
        texts = ", ".join(code.text for code in codes)
        return ranged(f"{name.lower()}({texts})", codes[0].type, acts=any(code.acts for code in codes))

    def _one_type(self, codes: list[Code]) -> list[Code]:
        type_ = codes[0].type
        for index, code in enumerate(codes[1:], 1):
            first = codes[0] if index == 1 else ranged("", type_)
            if type_ != code.type or first.loose != code.loose:
                type_ = self._operators.common(first, code)
        if not isinstance(type_, t.ScalarType):
            return codes
        return [settled(self._converter.converted(code, type_)) for code in codes]

    def _select(self, name: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        """SEL and MUX. CODESYS and TwinCAT evaluate what is chosen alone (help, "Operator: SEL"), others all.

        MUX of theirs takes the last value where its selector is greater ("Operator: MUX").
        """
        values = self._codes(nodes[1:], expected)
        if all(isinstance(value.type, t.ScalarType) for value in values):
            values = self._one_type(values)
        is_lazy = self._library.dialect in (Dialect.CODESYS, Dialect.TWINCAT)
        acts = any(value.acts for value in values)
        if name == "SEL":
            chooser = self._translator.value(nodes[0], t.BOOL)
            no, yes = (value.text for value in values)
            is_eager = acts and not is_lazy
            text = f"({no}, {yes})[{chooser.text}]" if is_eager else f"({yes} if {chooser.text} else {no})"
        else:
            chooser = settled(self._translator.value(nodes[0], t.DINT))
            which = f"{self._helper('chosen_or_last' if is_lazy else 'chosen')}({chooser.text}, {len(values)})"
            texts = [f"lambda: {value.text}" if is_lazy else value.text for value in values]
            text = f"[{', '.join(texts)}][{which}]" + ("()" if is_lazy else "")
        return ranged(text, values[0].type, acts=acts or chooser.acts)

    def _shift(self, name: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        wanted = expected if isinstance(expected, t.ScalarType) and expected.is_number else t.ELEMENTARY["DWORD"]
        code = settled(self._translator.value(nodes[0], wanted))
        count = settled(self._translator.value(nodes[1], t.INT))
        type_ = code.type
        if code.loose:
            type_ = wanted
        if not isinstance(type_, t.ScalarType) or type_.family not in (t.Family.INTEGER, t.Family.BITS):
            raise SimulationError(f"{name} of {type_.name}")
        shift = count.value if count.constant else 0
        turned = type_.bits - shift if name in ("ROL", "ROR") else shift
        self._translator.library.use.shifts.update(dict.fromkeys((shift, turned)))
        keeps_sign = name == "SHR" and type_.least < 0 and self._library.dialect is not Dialect.IEC
        helper = "shr_signed" if keeps_sign else name.lower()
        return self._call(helper, [code, count], type_, type_.least, type_.greatest)

    def _text(self, name: str, nodes: list[n.Expression], _: t.Type | None) -> Code:
        """Functions of strings."""
        strings = {"LEN": 1, "LEFT": 1, "RIGHT": 1, "MID": 1, "INSERT": 2, "DELETE": 1, "REPLACE": 2, "FIND": 2}
        count = strings.get(name, len(nodes))
        codes = [self._translator.value(node, t.string("STRING", 0)) for node in nodes[:count]]
        for code in codes:
            if not isinstance(code.type, t.ScalarType) or code.type.family not in (
                t.Family.STRING,
                t.Family.SPECIAL,
            ):
                raise SimulationError(f"{name} of {code.type.name}")
        codes += [self._as(node, t.DINT) for node in nodes[count:]]
        if name in ("LEN", "FIND"):
            return self._call({"LEN": "length"}.get(name, "find"), codes, t.INT)
        wide = any(code.type.name == "WSTRING" for code in codes)
        return self._call(name.lower(), codes, t.string("WSTRING" if wide else "STRING", 0))

    def _timed(self, name: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        """``ADD_TIME``, ``T_ADD`` and the like."""
        signs = {"ADD": Operator.ADD, "SUB": Operator.SUBTRACT, "MUL": Operator.MULTIPLY, "DIV": Operator.DIVIDE}
        word = name.partition("_")[0] if not name.startswith("T_") else name[2:].replace("DIFF", "SUB")
        return self._operators.value(n.Operation(signs[word], tuple(nodes)), expected)

    def _combined(self, name: str, nodes: list[n.Expression], _: t.Type | None) -> Code:
        """Return a date and a time of day."""
        one, other = (settled(self._translator.value(node)) for node in nodes)
        type_ = t.ELEMENTARY["LDT" if "LTOD" in name or other.type.name == "LTOD" else "DT"]
        return ranged(f"({one.text} + {other.text})", type_, acts=one.acts or other.acts)

    def _composed(self, name: str, nodes: list[n.Expression], _: t.Type | None) -> Code:
        """``CONCAT_DATE(year, month, day)`` and the like (ed. 3, table 36)."""
        codes = [self._as(node, t.LINT) for node in nodes]
        type_ = t.ELEMENTARY[name.removeprefix("CONCAT_")]
        helper = {t.Family.DATE: "date_of", t.Family.TIME_OF_DAY: "time_of"}.get(type_.family, "moment_of")
        return self._call(helper, codes, type_)

    def _weekday(self, _: str, nodes: list[n.Expression], __: t.Type | None) -> Code:
        return self._call("day_of_week", [self._translator.value(nodes[0])], t.INT)

    def _rounded(self, name: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        """TRUNC, ROUND, CEIL, FLOOR: integers (S7, CODESYS)."""
        code = self._as(nodes[0], t.LREAL)
        whole = isinstance(expected, t.ScalarType) and expected.family is t.Family.INTEGER
        type_ = expected if whole and isinstance(expected, t.ScalarType) else t.DINT
        if name == "TRUNC" and self._library.profile.truncates_to_int:
            type_ = t.INT
        found = self._call({"ROUND": "rounded", "TRUNC": "truncated"}.get(name, name.lower()), [code], t.LINT)
        return settled(self._converter.converted(found, type_))

    def _scaled(self, name: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        """NORM_X and SCALE_X of S7."""
        real = expected if isinstance(expected, t.ScalarType) and expected.family is t.Family.REAL else t.REAL
        if name == "NORM_X":
            codes = self._one_type(self._codes(nodes, None))
            return self._call("norm_x", [codes[1], codes[0], codes[2]], real)
        value = self._as(nodes[1], t.LREAL)
        low, high = (self._as(node, t.LREAL) for node in (nodes[0], nodes[2]))
        found = self._call("scale_x", [value, low, high], t.LREAL)
        target = expected if isinstance(expected, t.ScalarType) and expected.is_number else t.REAL
        return self._converter.converted(found, target)

    def _clock(self, name: str, _: list[n.Expression], __: t.Type | None) -> Code:
        """TIME() of CODESYS: the time since the start."""
        type_ = t.elementary(name, self._library.dialect) or t.LTIME
        return settled(self._converter.converted(ranged("p.now", t.LTIME), type_))

    def _endian(self, name: str, nodes: list[n.Expression], expected: t.Type | None) -> Code:
        code = settled(self._translator.value(nodes[0], expected))
        if not isinstance(code.type, t.ScalarType) or code.type.family not in (t.Family.INTEGER, t.Family.BITS):
            raise SimulationError(f"{name} of {code.type.name}")
        if "LITTLE" in name or code.type.bits == 8:
            return code
        return self._call("swapped", [code], code.type, code.type.bits // 8, code.type.least < 0)

    def _valid(self, name: str, nodes: list[n.Expression], _: t.Type | None) -> Code:
        helper = "is_valid_bcd" if name.endswith("BCD") else "is_valid"
        return self._call(helper, [self._translator.value(nodes[0], t.LREAL)], t.BOOL)

    # -- conversions

    def _conversion(self, key: str, arguments: Sequence[n.Argument]) -> Code | None:
        """``X_TO_Y``, ``TO_Y``, ``X_TRUNC_Y`` and those of BCD; None if the name is of none."""
        if len(arguments) != 1 or arguments[0].value is None or arguments[0].output:
            return None
        node = arguments[0].value
        bcd = _BCD.fullmatch(key)
        if bcd is not None:
            return self._bcd(bcd, node)
        truncation = _TRUNCATION.fullmatch(key)
        if truncation is not None:
            target = t.elementary(truncation["target"], self._library.dialect)
            if target is None:
                return None
            code = self._as(node, t.LREAL)
            whole = ranged(f"truncated({code.text})", t.LINT, acts=code.acts)
            return settled(self._converter.converted(whole, target))
        found = _CONVERSION.fullmatch(key)
        if found is None:
            return None
        target = t.elementary(found["target"], self._library.dialect)
        source = t.elementary(found["source"], self._library.dialect) if found["source"] else None
        if target is None or (found["source"] and source is None):
            return None
        code = self._translator.value(node, source or t.ELEMENTARY["DINT"])
        if source is not None and isinstance(code.type, t.ScalarType) and code.type.family is not t.Family.SPECIAL:
            code = self._converter.converted(code, source)
        return self._converted(settled(code), target)

    def _converted(self, code: Code, target: t.ScalarType) -> Code:
        source = code.type
        if not isinstance(source, t.ScalarType):
            raise SimulationError(f"{source.name} cannot become {target.name}")
        text = t.Family.STRING
        if target.name in ("CHAR", "WCHAR") and source.family in (t.Family.INTEGER, t.Family.BITS):
            return self._call("to_character", [code], target, target.bits)
        if target.family is text and source.family is not text:
            name = self._library.linker.name(source, "T")
            helper = self._helper("to_text")
            return Code(f"{helper}({code.text}, {name})[:{target.length}]", target, acts=code.acts)
        if source.family is text and target.family is not text:
            name = self._library.linker.name(target, "T")
            if target.name in ("CHAR", "WCHAR"):
                return code
            helper = self._helper("of_character" if source.name in ("CHAR", "WCHAR") else "of_text")
            return settled(ranged(f"{helper}({code.text}, {name})", target, acts=code.acts))
        raw = {source.family, target.family} == {t.Family.BITS, t.Family.REAL} and source.bits == target.bits
        takes_bits = self._library.dialect in (Dialect.IEC, Dialect.SCL) and not self._library.profile.matiec_library
        if raw and takes_bits and source.bits in (32, 64):
            # they are taken as they are (ed. 3, table 22: DWORD_TO_REAL)
            helper = "bits_of_real" if source.family is t.Family.REAL else "real_of_bits"
            return self._call(helper, [code], target, source.bits)
        if target.family is t.Family.BOOL and source.family is t.Family.BITS and self._library.dialect is Dialect.SCL:
            # S7-SCL manual, conversions of class B; CODESYS and matiec ask for all bits
            return Code(f"({code.text} & 1 == 1)", target, acts=code.acts)
        return settled(self._converter.converted(code, target))

    def _bcd(self, found: re.Match[str], node: n.Expression) -> Code | None:
        if found["target"]:
            target = t.elementary(found["target"], self._library.dialect)
            if target is None:
                return None
            code = settled(self._translator.value(node, t.ELEMENTARY["DWORD"]))
            return settled(self._converter.converted(self._call("of_bcd", [code], t.LINT), target))
        code = settled(self._translator.value(node, t.DINT))
        word = t.elementary(found["word"], self._library.dialect) if found["word"] else t.ELEMENTARY["DWORD"]
        if word is None:
            return None
        return settled(self._converter.converted(self._call("to_bcd", [code], t.ELEMENTARY["LWORD"]), word))


_Function = Callable[[StandardFunctions, str, list[n.Expression], t.Type | None], Code]
_FUNCTIONS: dict[str, _Function] = {
    **dict.fromkeys(("MOVE", "S_MOVE", "CONVERT"), StandardFunctions._move),
    "ABS": StandardFunctions._abs,
    **dict.fromkeys(("MAX", "MIN", "LIMIT"), StandardFunctions._choice),
    **dict.fromkeys(("SEL", "MUX"), StandardFunctions._select),
    **dict.fromkeys(("SHL", "SHR", "ROL", "ROR"), StandardFunctions._shift),
    **dict.fromkeys("LEN LEFT RIGHT MID CONCAT INSERT DELETE REPLACE FIND".split(), StandardFunctions._text),
    **dict.fromkeys(
        """ADD_TIME ADD_LTIME ADD_TOD_TIME ADD_LTOD_LTIME ADD_DT_TIME ADD_LDT_LTIME SUB_TIME SUB_LTIME
        SUB_DATE_DATE SUB_LDATE_LDATE SUB_TOD_TIME SUB_LTOD_LTIME SUB_TOD_TOD SUB_LTOD_LTOD SUB_DT_TIME
        SUB_LDT_LTIME SUB_DT_DT SUB_LDT_LDT MUL_TIME MUL_LTIME DIV_TIME DIV_LTIME T_ADD T_SUB T_DIFF""".split(),
        StandardFunctions._timed,
    ),
    **dict.fromkeys(("CONCAT_DATE_TOD", "CONCAT_DATE_LTOD", "T_COMBINE"), StandardFunctions._combined),
    **dict.fromkeys("CONCAT_DATE CONCAT_TOD CONCAT_LTOD CONCAT_DT CONCAT_LDT".split(), StandardFunctions._composed),
    "DAY_OF_WEEK": StandardFunctions._weekday,
    **dict.fromkeys(("TRUNC", "ROUND", "CEIL", "FLOOR"), StandardFunctions._rounded),
    **dict.fromkeys("SQRT LN LOG EXP SIN COS TAN ASIN ACOS ATAN ATAN2 SQR FRAC".split(), StandardFunctions._real),
    **dict.fromkeys(("NORM_X", "SCALE_X"), StandardFunctions._scaled),
    **dict.fromkeys(("TIME", "LTIME"), StandardFunctions._clock),
    **dict.fromkeys(
        "SWAP TO_BIG_ENDIAN TO_LITTLE_ENDIAN FROM_BIG_ENDIAN FROM_LITTLE_ENDIAN".split(), StandardFunctions._endian
    ),
    **dict.fromkeys(("IS_VALID", "IS_VALID_BCD"), StandardFunctions._valid),
}


def _size(type_: t.Type) -> int:
    """Bytes of a variable, without gaps."""
    if isinstance(type_, t.ScalarType):
        return type_.length + 1 if type_.family is t.Family.STRING else max(type_.bits // 8, 1)
    if isinstance(type_, t.ArrayOf):
        return type_.size * _size(type_.base)
    if isinstance(type_, t.StructureType):
        return sum(_size(field.type) for field in type_.layout.fields if not field.hidden)
    return 8
