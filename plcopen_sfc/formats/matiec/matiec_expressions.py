"""Expressions and calls as matiec takes them: operands of one type, and what it calls or calculates otherwise.

CODESYS and TIA Portal convert operands where no value can be lost (``DINT := INT``, ``REAL + 1``). matiec takes
operands of one type only, and literals of the kind of that type (tried with iec2c).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

from plcopen_sfc.formats.matiec.matiec_library import in_milliseconds
from plcopen_sfc.formats.matiec.matiec_statements import literal_number
from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.name_scopes import parameters_of
from plcopen_sfc.languages.binding.text_sites import TextSite, text_sites
from plcopen_sfc.languages.expression_types import (
    CALCULATING,
    INSTANTS,
    OF_ONE_TYPE,
    ORDER,
    REALS,
    ExpressionTypes,
    fits,
)
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node, render, transform, walk
from plcopen_sfc.languages.standard_blocks import S7_COUNTERS_OF_CODESYS
from plcopen_sfc.languages.translation.tree_translation import BOTH_SIDES
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import ElementaryType, SimpleValue, StringType
from plcopen_sfc.report import ConversionReport, Outcome


def fit_expressions(project: Project, report: ConversionReport, *, same_library: bool) -> None:
    """Write what matiec spells otherwise in all texts of a project, and report what it has no words for.

    `same_library`: standard functions are those of matiec already, in the texts of projects for it.
    """
    resolver = Resolver(project, project.dialect)
    for text_site in list(text_sites(project)):
        if not text_site.is_program_text:
            continue
        parsed = text_site.parsed(project.dialect)
        if parsed.problems:
            continue
        fitter = _ExpressionFitter(text_site, resolver, _written(parsed.tree), same_library=same_library)
        tree = transform(parsed.tree, fitter)
        if not fitter.missing:
            found = _TypeCheck(ExpressionTypes(Dialect.IEC, fitter.type_of)).mistakes(tree)
            fitter.missing += (("operation", f"matiec has no {each}") for each in found)
        others = [] if same_library else [*fitter.narrowed, *_otherwise(tree, fitter.type_of)]
        for told in dict.fromkeys(others):
            report.add(Outcome.APPROXIMATED, "operation", text_site.report_path, told)
        if tree is not parsed.tree:
            text_site.put(render(parsed, tree))
        for what, why in dict.fromkeys(fitter.missing):
            report.add(Outcome.NOT_EXECUTED, what, text_site.report_path, f"{why}; the text does not compile there")


def _written(tree: n.Node) -> frozenset[str]:
    """Return what statements write, in lower case: targets of assignments, and outputs of calls."""
    targets = [node.target for node in walk(tree) if isinstance(node, n.Assignment)]
    outputs = [node.value for node in walk(tree) if isinstance(node, n.Argument) and node.output]
    return frozenset(print_node(each).casefold() for each in (*targets, *outputs) if each is not None)


class _ExpressionFitter:
    def __init__(self, text_site: TextSite, resolver: Resolver, written: frozenset[str], *, same_library: bool) -> None:
        self.text_site = text_site
        self.written = written
        self.same_library = same_library
        self.resolver = resolver
        self.missing: list[tuple[str, str]] = []
        self.narrowed: list[str] = []
        self.converter = OperandConverter(self._type, self.missing)

    def type_of(self, value: n.Expression) -> str:
        """Return the elementary type of a variable or of the result of a function; empty where it has another."""
        if self._is_count(value):
            return "INT"
        found = self.resolver.type_of(value, self.text_site.site)
        if isinstance(found, StringType):
            return "WSTRING" if found.wide else "STRING"
        return found.name.value if isinstance(found, ElementaryType) else ""

    def __call__(self, node: n.Node) -> n.Node:
        if isinstance(node, n.Literal):
            return self._literal(node)
        if isinstance(node, n.Address):
            self.missing.append(("address", f"matiec takes {node.text} in declarations only"))
        if isinstance(node, n.Operation):
            # AND and OR of matiec end with the operand that decides, too
            return self.converter.operation(replace(node, operator=BOTH_SIDES.get(node.operator, node.operator)))
        if isinstance(node, n.Unary) and isinstance(node.operand, n.Unary):
            return replace(node, operand=n.Parenthesized(node.operand))  # IEC 61131-3 ed. 2, B.3.1: one sign or NOT
        if isinstance(node, n.Assignment):
            if self._is_count(node.target):
                return replace(node, value=self._preset(node.value))
            if self._is_count(n.bare(node.value)) and (kind := self.converter.kind(node.target)) in _COUNTS:
                return replace(node, value=_as(kind, "INT", node.value))
            return self.converter.assignment(node)
        if isinstance(node, n.For):
            self._look_at_loop(node)
        if isinstance(node, n.Member) and (bit := _BIT.fullmatch(node.name.identifier)):
            return self._bit(node, bit)
        if isinstance(node, n.Call):
            node = self._with_arguments(node)
        if isinstance(node, n.Call) and isinstance(node.callee, n.Name):
            converted = self._conversion(node, node.callee)
            if isinstance(converted, n.Call) and not self.same_library:
                return in_milliseconds(converted) or converted
            return converted
        return node

    def _look_at_loop(self, loop: n.For) -> None:
        """Tell what keeps a loop from being compiled."""
        name = print_node(loop.variable)
        if self._type(loop.variable).startswith("U") and (literal_number(loop.step) or 0) < 0:
            self.missing.append(("loop", f"matiec does not count {name} down, as it has no sign"))
        inside = [node for statement in loop.statements for node in walk(statement)]
        if any(
            isinstance(node, n.Assignment) and print_node(node.target).casefold() == name.casefold() for node in inside
        ):
            self.missing.append(("loop", f"matiec has no assignments to {name}, the variable of the loop"))

    def _is_count(self, value: n.Expression) -> bool:
        """True for the count and the preset of a counter, which are of the type INT in matiec."""
        if not isinstance(value, n.Member) or value.name.identifier.upper() not in ("CV", "PV"):
            return False
        return self._is_counter(value.base)

    def _is_counter(self, value: n.Expression) -> bool:
        block = self.resolver.standard_block_of(value, self.text_site.site)
        return block is not None and block.name in S7_COUNTERS_OF_CODESYS

    def _preset(self, value: n.Expression) -> n.Expression:
        """Return the preset of a counter, which is a WORD in CODESYS."""
        kind, inner = self.converter.kind(value), n.bare(value)
        if kind not in _COUNTS:
            return self.converter.as_type("INT", value)
        self.narrowed.append(f"a counter ends at 32767 in matiec: {print_node(value)} may be more")
        if isinstance(inner, n.Call) and inner.called.upper() == f"INT_TO_{kind}" and inner.arguments[0].value:
            return inner.arguments[0].value
        return _as("INT", kind, value)

    def _with_arguments(self, call: n.Call) -> n.Call:
        """Return a call with arguments of the types of its parameters, which matiec does not convert."""
        is_counter, arguments = self._is_counter(call.callee), []
        conversion = _NUMBER_CONVERSION.fullmatch(call.called)
        for position, argument in enumerate(call.arguments):
            value, pin = argument.value, argument.name.identifier.upper() if argument.name is not None else ""
            if value is not None and not argument.output:
                if is_counter and pin == "PV":
                    value = self._preset(value)
                elif conversion is not None:
                    value = self.converter.as_type(conversion[1].upper(), value, same_bits=True)
                else:
                    found = self.resolver.parameter_type(call, position, self.text_site.site)
                    target = found.name.value if isinstance(found, ElementaryType) else ""
                    value = self.converter.as_type(target, value) if target in _NUMBERS else value
            arguments.append(argument if value is argument.value else replace(argument, value=value))
        if len({argument.name is None for argument in arguments}) > 1:  # matiec takes all by name, or all by position
            arguments = [
                argument if argument.name is not None else replace(argument, name=self._parameter(call, position))
                for position, argument in enumerate(arguments)
            ]
        changed = any(new is not old for new, old in zip(arguments, call.arguments, strict=True))
        call = replace(call, arguments=tuple(arguments)) if changed else call
        return call if self._is_declared(call) else self.converter.standard_call(call)

    def _is_declared(self, call: n.Call) -> bool:
        return isinstance(self.resolver.called_type(call.callee, self.text_site.site), Pou)

    def _parameter(self, call: n.Call, position: int) -> n.Name | None:
        """Return the name of the parameter that an argument without one gives."""
        called = self.resolver.called_type(call.callee, self.text_site.site)
        parameters = parameters_of(called.interface) if isinstance(called, Pou) and called.interface is not None else []
        if position < len(parameters):
            return n.Name(parameters[position].name)
        self.missing.append(("call", f"matiec takes the arguments of {call.called} all by name or all by position"))
        return None

    def _bit(self, node: n.Member, found: re.Match[str]) -> n.Node:
        """``w.3`` as ``(w AND WORD#16#8) <> WORD#16#0``, where it is read only."""
        kind = self._type(node.base)
        bits = kind if kind in _BITS else _BITS_OF.get(kind, "")
        if not bits or found["number"] is None or int(found["number"]) >= 2 ** (_BITS.index(bits) + 3):
            self.missing.append(("bit access", f"matiec has no bits of variables, here .{node.name.identifier}"))
            return node
        if print_node(node).casefold() in self.written:
            self.missing.append(("bit access", f"matiec writes no bits of variables, here .{node.name.identifier}"))
            return node
        word = print_node(node.base)
        word = word if bits == kind else f"{kind}_TO_{bits}({word})"
        text = f"(({word} AND {bits}#16#{1 << int(found['number']):X}) <> {bits}#16#0)"
        return parse_expression(text).tree

    def _literal(self, node: n.Literal) -> n.Node:
        text = node.text
        if _LONG.match(text) and not isinstance(self.text_site.holder, SimpleValue):  # its type is reported
            self.missing.append(("literal", f"matiec has no {text}"))
        if text.startswith("'"):
            text = _LINE_FEED.sub(lambda found: "$0A" if found[1] in "Ll" else found[0], text)  # its C code is wrong
        if text.startswith("'") and not text.isascii():
            if any(ord(character) > _LATIN_1 for character in text):
                self.missing.append(("literal", f"matiec has no {text}"))
            else:
                text = "".join(c if c.isascii() else f"${ord(c):02X}" for c in text)
        elif not text.startswith("'"):
            text = _POINTLESS.sub(r"\g<0>.0", text)
        return node if text == node.text else replace(node, text=text)

    def _conversion(self, call: n.Call, callee: n.Name) -> n.Node:
        """``TO_INT(x)`` as ``REAL_TO_INT(x)``: matiec has the type of the argument in the name."""
        name = callee.identifier.upper()
        truncated = _TRUNCATION.fullmatch(name)
        if truncated is not None:
            # the result of its TRUNC is whatever is wanted: of LINT here, so that nothing is cut off before
            inner = n.Call(n.Name("TRUNC"), call.arguments)
            return inner if truncated[1] == "LINT" else n.Call(n.Name(f"LINT_TO_{truncated[1]}"), (n.Argument(inner),))
        if not _CONVERSION.fullmatch(name) or len(call.arguments) != 1 or call.arguments[0].value is None:
            return call
        kind = self._type(call.arguments[0].value)
        if not kind:
            self.missing.append(("function", f"matiec has no {name}, and the type of its argument is not known"))
            return call
        if f"TO_{kind}" == name:
            return n.Parenthesized(call.arguments[0].value)
        return n.Call(n.Name(f"{kind}_{name}"), call.arguments)

    def _type(self, value: n.Expression) -> str:
        if isinstance(value, n.Literal):
            return "REAL" if REAL_LITERAL.fullmatch(value.text) else "DINT" if value.text.isdigit() else ""
        return self.type_of(value)


_POINTLESS = re.compile(r"^(?:L?REAL#)?[+-]?\d[\d_]*(?=[eE][+-]?\d)|^L?REAL#[+-]?\d[\d_]*$", re.IGNORECASE)
_LINE_FEED = re.compile(r"\$(.)")
_LATIN_1 = 255
_LONG = re.compile(r"(?:LTIME|LT|LD|LDATE|LTOD|LDT|LTIME_OF_DAY|LDATE_AND_TIME|W?CHAR|WSTRING)#|\"", re.IGNORECASE)
_BIT = re.compile(r"%?(?:X?(?P<number>\d+)|[BWDL]\d+)", re.IGNORECASE)
_TRUNCATION = re.compile(r"L?REAL_TRUNC_(\w+)")
_CONVERSION = re.compile(r"TO_(?:[SDL]?INT|U[SDL]?INT|L?REAL|BOOL|BYTE|[DL]?WORD|TIME|STRING)")


_SIGNED = ("SINT", "INT", "DINT", "LINT")
_UNSIGNED = ("USINT", "UINT", "UDINT", "ULINT")
_BITS = ("BYTE", "WORD", "DWORD", "LWORD")
_BITS_OF = dict(zip((*_SIGNED, *_UNSIGNED), (*_BITS, *_BITS), strict=True))
"""Bit strings of the size of integers."""
_NUMBERS = frozenset({*_SIGNED, *_UNSIGNED, *_BITS, *REALS})
_TYPED = re.compile(r"([A-Z]+)#", re.IGNORECASE)
REAL_LITERAL = re.compile(r"[\d_]+\.[\d_]+(?:[eE][+-]?\d+)?")
_WHOLE = re.compile(r"\d[\d_]*")
_FUNCTION = re.compile(r"[A-Z]+_TO_([A-Z]+)", re.IGNORECASE)
_NUMBER_CONVERSION = re.compile(rf"({'|'.join(sorted(_NUMBERS, key=len, reverse=True))})_TO_[A-Z]+", re.IGNORECASE)
_COUNTS = frozenset({"WORD", "UINT"})
"""The types of the numbers that counters of CODESYS have."""


TypeOf = Callable[[n.Expression], str]
"""Gives the name of the elementary type of a variable, empty where it has another or is not known."""


class OperandConverter:
    """Gives operands and assigned values the type that matiec wants; `missing` gets what cannot be converted."""

    def __init__(self, type_of: TypeOf, missing: list[tuple[str, str]]) -> None:
        self._type_of = type_of
        self._missing = missing

    def kind(self, value: n.Expression) -> str:
        """Return the numeric or bit type of an expression, empty for literals that take any and for unknown ones."""
        if isinstance(value, n.Parenthesized):
            return self.kind(value.inner)
        if isinstance(value, n.Unary):
            return self.kind(value.operand)
        if isinstance(value, n.Literal):
            typed = _TYPED.match(value.text)
            found = typed[1].upper() if typed is not None else ""
        elif isinstance(value, n.Operation):
            is_number = value.operator in CALCULATING | n.CONNECTIVES
            found = next(filter(None, map(self.kind, value.operands)), "") if is_number else ""
        elif isinstance(value, n.Call):
            converted = _FUNCTION.fullmatch(value.called)
            found = converted[1].upper() if converted is not None else self._type_of(value)
            if not found and value.called.upper() in OF_ONE_TYPE:
                found = next(filter(None, map(self.kind, chosen_values(value))), "")
        else:
            found = self._type_of(value)
        return found if found in _NUMBERS else ""

    def operation(self, node: n.Operation) -> n.Node:
        """Return an operation with operands of one type."""
        if node.operator not in CALCULATING | n.CONNECTIVES | n.COMPARISONS:
            return node
        kinds = [self.kind(operand) for operand in node.operands]
        known = {kind for kind in kinds if kind}
        if known and known.isdisjoint(REALS) and any(map(_is_real, node.operands)):
            known.add("REAL")
        if node.operator in n.CONNECTIVES and not known <= set(_BITS):
            self._missing.append(("operation", f"matiec has no {node.operator.value} of {' and '.join(sorted(known))}"))
            return node
        common = next((kind for kind in sorted(known) if all(_widens(other, kind) for other in known)), "")
        if not known:
            return node
        if not common:
            self._missing.append(("operation", f"matiec does not take {' and '.join(sorted(known))} together"))
            return node
        operands = tuple(_as(common, kind, each) for kind, each in zip(kinds, node.operands, strict=True))
        changed = any(a is not b for a, b in zip(operands, node.operands, strict=True))
        return replace(node, operands=operands) if changed else node

    def standard_call(self, call: n.Call) -> n.Call:
        """Return a call of a standard function with arguments of one type, REAL where it calculates with that."""
        name = call.called.upper()
        values = chosen_values(call)
        kinds = [self.kind(each) for each in values]
        known = {kind for kind in kinds if kind}
        if name in _SHIFTS and kinds[1:] and kinds[1] in _BITS:
            return _with_values(call, {id(values[1]): _as("INT", kinds[1], values[1])})
        if name in _OF_REALS or name == "EXPT":
            if kinds and (kinds[0] in {*_SIGNED, *_UNSIGNED} or not kinds[0]):
                return _with_values(call, {id(values[0]): _as("REAL", kinds[0], values[0])})
            return call
        if name not in OF_ONE_TYPE:
            return call
        if known.isdisjoint(REALS) and any(map(_is_real, values)):
            known.add("REAL")
        common = next((kind for kind in sorted(known) if all(_widens(other, kind) for other in known)), "")
        if not common:
            return call
        pairs = zip(kinds, values, strict=True)
        return _with_values(call, {id(each): _as(common, kind, each) for kind, each in pairs})

    def assignment(self, node: n.Assignment) -> n.Node:
        """Return an assignment of a value of the type of its target."""
        target = self.kind(node.target)
        if not target or node.kind is not n.AssignmentKind.ASSIGN:
            return node
        value = self.as_type(target, node.value)
        return node if value is node.value else replace(node, value=value)

    def as_type(self, target: str, value: n.Expression, *, same_bits: bool = False) -> n.Expression:
        """Return a value as one of a type of numbers; `same_bits`: also one of the same size in another family."""
        kind = self.kind(value)
        if not kind and target not in REALS and _is_real(value):
            kind = "REAL"
        is_same = same_bits and kind != target and _BITS_OF.get(kind, kind) == _BITS_OF.get(target, target)
        if kind and not is_same and not _widens(kind, target):
            self._missing.append(("assignment", f"matiec does not assign {kind} to {target}"))
            return value
        return _as(target, kind, value)


def chosen_values(call: n.Call) -> list[n.Expression]:
    """Return the arguments of a standard function that decide on the type of its result, and all of other ones."""
    values = [argument.value for argument in call.arguments if argument.value is not None and not argument.output]
    return values[OF_ONE_TYPE.get(call.called.upper(), 0) :]


def _with_values(call: n.Call, changed: Mapping[int, n.Expression]) -> n.Call:
    """Return a call with other arguments, by the ids of those before."""
    arguments = tuple(
        argument
        if (new := changed.get(id(argument.value), argument.value)) is argument.value
        else replace(argument, value=new)
        for argument in call.arguments
    )
    same = all(new is old for new, old in zip(arguments, call.arguments, strict=True))
    return call if same else replace(call, arguments=arguments)


_OF_REALS = frozenset("SQRT LN LOG EXP SIN COS TAN ASIN ACOS ATAN".split())
_SHIFTS = frozenset("SHL SHR ROL ROR".split())
_TIMES = frozenset({"TIME"})


class _TypeCheck:
    """Finds operations, assignments and calls of standard functions with types that matiec does not take.

    matiec wants equal types, where `compile_mistakes` finds what no tool takes: values of another kind. Unknown types
    are never errors: the values of enumerations, generic parameters, parts of structures.
    """

    def __init__(self, types: ExpressionTypes) -> None:
        self._types = types

    def mistakes(self, tree: n.Node) -> Iterator[str]:
        """Yield the parts of a tree that matiec does not have: ``+ of BYTE``."""
        for node in walk(tree):
            if isinstance(node, n.Operation):
                yield from self._operation(node)
            elif isinstance(node, n.Unary):
                kind, is_not = self._types.value(node.operand).type, node.operator is n.Operator.NOT
                if kind and (kind in {"BOOL", *_BITS}) is not is_not:
                    yield f"{node.operator.value} of {kind}"
            elif isinstance(node, n.Assignment) and node.kind is n.AssignmentKind.ASSIGN:
                yield from self._assignment(node)
            elif isinstance(node, n.Call) and node.called:
                yield from self._call(node.called.upper(), [a.value for a in node.arguments if a.value])

    def _operation(self, node: n.Operation) -> Iterator[str]:
        values = [self._types.value(operand) for operand in node.operands]
        kinds = [value.type for value in values if not value.loose]
        if not all(kinds) or not kinds:
            return
        known, is_mixed = set(kinds), len(kinds) < len(values)
        for value in values if len(known) == 1 and known <= set(ORDER) else ():
            if value.loose and not fits(value, kinds[0]):
                yield f"{node.operator.value} of {kinds[0]} and {value.low}"
                return
        if node.operator in CALCULATING:
            scaled = node.operator in (n.Operator.MULTIPLY, n.Operator.DIVIDE)
            if known <= _NUMBERS - set(_BITS) or (known & INSTANTS and not is_mixed):
                wrong = False  # operands of several types have been converted
            else:
                wrong = (
                    "TIME" not in known or (is_mixed and not scaled) or not known <= _TIMES | (_NUMBERS - set(_BITS))
                )
        elif node.operator in n.CONNECTIVES:
            wrong = not known <= {"BOOL", *_BITS} or len(known) > 1
        else:
            wrong = len(known) > 1 or (is_mixed and not known <= _NUMBERS)
        if wrong:
            shown = [*sorted(known), *(["a number"] if is_mixed else [])]
            yield f"{node.operator.value} of {' and '.join(shown)}"

    def _assignment(self, node: n.Assignment) -> Iterator[str]:
        target, value = self._types.value(node.target).type, self._types.value(node.value)
        call = n.bare(node.value)
        if target in _NUMBERS and isinstance(call, n.Call) and call.called.upper() == "TRUNC":
            # which gives any integer in matiec
            return
        if not target or not (value.type or value.loose):
            return
        if value.loose:
            wrong = target not in _NUMBERS | {"BOOL"} or (target in ORDER and not fits(value, target))
            wrong = wrong or (target == "BOOL" and not 0 <= value.low <= value.high <= 1)
            kind = f"the number {value.low}" if value.low == value.high else "a number"
        else:
            wrong, kind = value.type != target and not {value.type, target} <= set(REALS), value.type
        if wrong:
            yield f"assignment of {kind} to {target}"

    def _call(self, name: str, arguments: list[n.Expression]) -> Iterator[str]:
        values = [self._types.value(each) for each in arguments]
        kinds = [value.type for value in values if value.type]
        if name in _OF_REALS and kinds and kinds[0] not in REALS:
            yield f"{name} of {kinds[0]}"
        elif name in _SHIFTS and values and values[0].type and values[0].type not in {"BOOL", *_BITS}:
            yield f"{name} of {values[0].type}"
        elif name in OF_ONE_TYPE:
            chosen = {value.type for value in values[OF_ONE_TYPE[name] :] if not value.loose}
            if "" not in chosen and (len(chosen) > 1 or (name == "ABS" and chosen & {"BOOL", *_BITS})):
                yield f"{name} of {' and '.join(sorted(chosen))}"


def _otherwise(tree: n.Node, type_of: TypeOf) -> Iterator[str]:
    """Yield what matiec calculates otherwise: with times, and NOT of a part of an int of C."""
    types = ExpressionTypes(Dialect.IEC, type_of)
    stored = {id(n.bare(node.value)) for node in walk(tree) if isinstance(node, n.Assignment)}
    for node in walk(tree):
        if isinstance(node, n.Unary) and node.operator is n.Operator.NOT and id(node) not in stored:
            kind = types.value(node.operand).type
            if kind in ("BYTE", "WORD"):
                yield f"NOT of a {kind} has 32 bits in matiec where it is no value that is assigned: assign it before"
        if not isinstance(node, n.Operation) or node.operator not in CALCULATING:
            continue
        kinds = {types.value(operand).type for operand in node.operands}
        if "TOD" in kinds and "TIME" in kinds:
            yield "matiec does not begin a time of day again behind midnight"
        if node.operator is n.Operator.MULTIPLY and "TIME" in kinds:
            yield "the product of a duration is wrong in matiec where its part below a second becomes more than 2.1 s"


def _is_real(value: n.Expression) -> bool:
    """True for a literal with a point and without a type."""
    if isinstance(value, n.Unary):
        return _is_real(value.operand)
    return isinstance(value, n.Literal) and REAL_LITERAL.fullmatch(value.text) is not None


def _widens(kind: str, to: str) -> bool:
    """True if every value of a type is one of another, or CODESYS takes it for one (integers as REAL)."""
    if kind == to:
        return True
    for family in (_SIGNED, _UNSIGNED, _BITS, REALS):
        if kind in family and to in family:
            return family.index(kind) < family.index(to)
    if to in REALS:
        return kind in _SIGNED or kind in _UNSIGNED
    return kind in _UNSIGNED and to in _SIGNED and _UNSIGNED.index(kind) < _SIGNED.index(to)


def _as(common: str, kind: str, value: n.Expression) -> n.Expression:
    """Return an operand as one of the type `common`; literals without a type take any, whole ones but those of REAL."""
    if kind and kind != common:
        inner = value.inner if isinstance(value, n.Parenthesized) else value
        return n.Call(n.Name(f"{kind}_TO_{common}"), (n.Argument(inner),))
    if kind or common not in REALS:
        return value
    if isinstance(value, n.Literal) and _WHOLE.fullmatch(value.text):
        return replace(value, text=f"{value.text}.0")
    if isinstance(value, n.Operation) and value.operator in CALCULATING:
        operands = tuple(_as(common, kind, each) for each in value.operands)
        changed = any(a is not b for a, b in zip(operands, value.operands, strict=True))
        return replace(value, operands=operands) if changed else value
    if isinstance(value, n.Call) and value.called.upper() in OF_ONE_TYPE:
        return _with_values(value, {id(each): _as(common, kind, each) for each in chosen_values(value)})
    if isinstance(value, n.Unary):
        operand = _as(common, kind, value.operand)
        return value if operand is value.operand else replace(value, operand=operand)
    if isinstance(value, n.Parenthesized):
        inner = _as(common, kind, value.inner)
        return value if inner is value.inner else replace(value, inner=inner)
    return value
