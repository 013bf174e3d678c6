"""Standard functions that the library of matiec has otherwise than other tools (`Profile.matiec_library`).

``TIME_TO_DINT(T#250ms)`` is 0 in matiec, and ``DINT_TO_TIME(250)`` lasts 250 seconds: it counts seconds. These
conversions are rewritten; of all others a report tells.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from plcopen_sfc.languages.binding.text_sites import SiteKind, text_sites
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node, transform
from plcopen_sfc.languages.translation.call_translation import TAKING_BITS, number_of_bits
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome

_FROM_TIME = re.compile(r"(TIME|TOD|TIME_OF_DAY)_TO_(U?[SDL]?INT|BYTE|[DL]?WORD|L?REAL)", re.IGNORECASE)
_TO_TIME = re.compile(r"(U?[SDL]?INT|BYTE|[DL]?WORD|L?REAL)_TO_(TIME|TOD|TIME_OF_DAY)", re.IGNORECASE)
_SHORT = {"TIME_OF_DAY": "TOD"}

Form = Callable[[str, str, str], str]


def in_milliseconds(call: n.Call) -> n.Expression | None:
    """Return a conversion that counts milliseconds in matiec; None for a call that is none.

    It calculates in LREAL: where a ``long`` has 32 bits, products with a duration overflow in the C code of matiec from
    two seconds on. A time may lack a nanosecond then, as its literals do (``T#1ms`` has 999,999).
    """
    return _rewritten(call, _number_for_matiec, _time_for_matiec)


def in_seconds(call: n.Call) -> n.Expression | None:
    """Return a conversion that counts seconds in other tools, as it does in matiec; None for a call that is none."""
    return _rewritten(call, _number_of_matiec, _time_of_matiec)


def _rewritten(call: n.Call, number: Form, time: Form) -> n.Expression | None:
    value = call.arguments[0].value if len(call.arguments) == 1 else None
    if value is None:
        return None
    for pattern, form in ((_FROM_TIME, number), (_TO_TIME, time)):
        found = pattern.fullmatch(call.called)
        if found is None:
            continue
        source, target = (_SHORT.get(each.upper(), each.upper()) for each in found.groups())
        tree = transform(parse_expression(form(source, target, print_node(value))).tree, _plain)
        return n.Parenthesized(tree) if isinstance(tree, n.Operation) else tree
    return None


def _plain(node: n.Node) -> n.Node:
    """Return a name or a literal without the parentheses around it."""
    if isinstance(node, n.Parenthesized) and isinstance(node.inner, n.Name | n.Literal):
        return node.inner
    return node


def _number_for_matiec(time: str, number: str, value: str) -> str:
    counted = f"{time}_TO_LREAL({value}) * 1000.0"
    return counted if number == "LREAL" else f"LREAL_TO_{number}({counted})"


def _time_for_matiec(number: str, time: str, value: str) -> str:
    counted = value if number == "LREAL" else f"{number}_TO_LREAL({value})"
    return f"LREAL_TO_{time}({counted} / 1000.0)"


def _number_of_matiec(time: str, number: str, value: str) -> str:
    if number in ("REAL", "LREAL"):
        return f"{time}_TO_{number}({value}) / 1000.0"
    counted = f"{time}_TO_DINT({value}) / 1000"  # boxes of S7 know no quotient of a duration
    return counted if number == "DINT" else f"DINT_TO_{number}({counted})"


def _time_of_matiec(number: str, time: str, value: str) -> str:
    if number in ("REAL", "LREAL"):
        return f"{number}_TO_{time}(({value}) * 1000.0)"
    return f"DINT_TO_{time}({f'({value})' if number == 'DINT' else f'{number}_TO_DINT({value})'} * 1000)"


def _as_number(call: n.Call) -> n.Expression | None:
    """Return a conversion of matiec that takes a bit string for a number; None for a call that is none."""
    found, value = _RAW.fullmatch(call.called), call.arguments[0].value if len(call.arguments) == 1 else None
    if found is None or value is None:
        return None
    source, _, result = call.called.upper().partition("_TO_")
    return number_of_bits(source, result, value, call)


def count_in_seconds(project: Project, report: ConversionReport, tool: str) -> None:
    """Let a copy of a project for matiec count its times in seconds in a `tool` that counts milliseconds."""

    def change(node: n.Node) -> n.Node:
        return (in_seconds(node) if isinstance(node, n.Call) else None) or node

    for text_site in text_sites(project):
        if text_site.is_program_text and _CONVERSION.search(text_site.text):
            text = text_site.rewritten(project.dialect, change)
            if text != text_site.text:
                text_site.put(text)
                why = f"matiec counts seconds where {tool} counts milliseconds"
                report.add(Outcome.TRANSLATED, "time", text_site.report_path, why)
        if text_site.is_program_text and _RAW.search(text_site.text):
            text = text_site.rewritten(
                project.dialect, lambda node: (_as_number(node) if isinstance(node, n.Call) else None) or node
            )
            if text != text_site.text:
                text_site.put(text)
                why = f"matiec converts the number where {tool} takes its bits as they are"
                report.add(Outcome.TRANSLATED, "function", text_site.report_path, why)
    note_functions(project, report, tool)


def note_functions(project: Project, report: ConversionReport, tool: str, *, with_texts: bool = False) -> None:
    """Report functions that give other results in matiec than in `tool`, and are not rewritten.

    These are conversions of times in boxes, in instructions and, `with_texts`, in others, and functions of strings.
    """
    for text_site in text_sites(project):
        is_box = isinstance(text_site.holder, Block) and text_site.key == "type_name"
        if not (is_box or text_site.is_program_text or text_site.reading is SiteKind.INSTRUCTIONS):
            continue
        if with_texts or not text_site.is_program_text:
            for found in dict.fromkeys(each[0].upper() for each in _CONVERSION.finditer(text_site.text)):
                why = f"{found}: matiec counts seconds, {tool} milliseconds"
                report.add(Outcome.NOT_EXECUTED, "time", text_site.report_path, why)
        for found in dict.fromkeys(each[0].upper() for each in _RAW.finditer(text_site.text)):
            why = f"{found}: matiec converts the number, {tool} takes its bits as they are"
            report.add(Outcome.NOT_EXECUTED, "function", text_site.report_path, why)
        for found in dict.fromkeys(each[0].upper() for each in _OTHERWISE.finditer(text_site.text)):
            why = f"{found} gives something else in matiec than in {tool} for some values"
            report.add(Outcome.APPROXIMATED, "function", text_site.report_path, why)


_RAW = re.compile(rf"\b(?:{'|'.join(sorted(map('_TO_'.join, TAKING_BITS)))})\b", re.IGNORECASE)
"""Conversions that take the bits as they are in IEC 61131-3, and the number in matiec."""
_CONVERSION = re.compile(rf"\b(?:{_FROM_TIME.pattern}|{_TO_TIME.pattern})\b", re.IGNORECASE)
_OTHERWISE = re.compile(
    r"\b(?:FIND|REPLACE|(?:BYTE|[DL]?WORD|L?REAL|TIME)_TO_STRING|STRING_TO_(?!CHAR|STRING)[A-Z]+)\b",
    re.IGNORECASE,
)
