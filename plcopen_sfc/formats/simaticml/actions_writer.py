"""Writes the rows of GRAPH actions as tokens. The reader is `actions_reader`."""

from __future__ import annotations

import re
from collections.abc import Mapping

from lxml import etree

from plcopen_sfc.formats.simaticml.writing import sub
from plcopen_sfc.formats.xml.extension_data import legal_text
from plcopen_sfc.model.actions import ActionAssociation, ActionEvent, Qualifier
from plcopen_sfc.model.body import StBody

_CALL = re.compile(r'("[^"]+"|#?\w+(?:\.\w+)*)\((.*)\);?', re.DOTALL)
_ARGUMENT = re.compile(r"([^\W\d]\w*) (:=|=>) (.*)", re.DOTALL)
_INDENT = 4
LAYOUT = "blanks"
"""Carried attribute of an association: the blanks behind each token of its row, where they are not the usual ones."""
CALLEE = "callee"
"""Carried attribute of an association: the function block whose instance it calls."""
SAYABLE = frozenset(
    {Qualifier.NONE, Qualifier.N, Qualifier.S, Qualifier.R, Qualifier.D, Qualifier.L, Qualifier.CALL}
    | {Qualifier.ON, Qualifier.OFF, Qualifier.CS, Qualifier.CU, Qualifier.CD, Qualifier.CR}
    | {Qualifier.TL, Qualifier.TD, Qualifier.TR, Qualifier.TF}
)
"""The qualifiers that GRAPH has."""
NEAREST = {
    Qualifier.R0: Qualifier.R,
    Qualifier.SD: Qualifier.D,
    Qualifier.DS: Qualifier.D,
    Qualifier.DL: Qualifier.D,
    Qualifier.SL: Qualifier.L,
}
"""What is written for qualifiers that GRAPH does not have; only R0 means the same."""
AS_EVENTS = {Qualifier.P1: ActionEvent.S1, Qualifier.P: ActionEvent.S1, Qualifier.P0: ActionEvent.S0}
"""Qualifiers of IEC 61131-3 that GRAPH says with an event: once at activation (P1, P), or at deactivation (P0)."""


def write_row(element: etree._Element, action: ActionAssociation, blocks: Mapping[str, str] | None = None) -> None:
    """Fill ``Action`` with what an association does. `blocks` are the function blocks of instance data blocks."""
    kept = action.carried.attributes if action.carried is not None else {}
    event, qualifier = action.event, action.qualifier
    if qualifier in AS_EVENTS and event is None:
        event, qualifier = AS_EVENTS[qualifier], Qualifier.N
    if event is not None and event is not ActionEvent.C:
        element.set("Event", event.value)
    if action.interlock or event is ActionEvent.C:
        element.set("Interlock", "true")
    qualifier = NEAREST.get(qualifier, qualifier)
    name = {Qualifier.CALL: "N", Qualifier.NONE: ""}.get(qualifier, qualifier.value)
    if name:
        element.set("Qualifier", name)
    called = action.body.text.partition("(")[0].strip() if isinstance(action.body, StBody) else ""
    tokens = _tokens(action, kept.get(CALLEE) or (blocks or {}).get(called.strip('"').casefold(), ""))
    for token in [*_laid_out(tokens, kept.get(LAYOUT, "")), "\n"] if tokens else []:
        sub(element, "Token", {"Text": legal_text(token)})


def _laid_out(tokens: list[str], layout: str) -> list[str]:
    """Tokens with the blanks between them that the row had, if it has the same number of tokens."""
    words = [token for token in tokens if token.strip()]
    widths = layout.split()
    if len(widths) != len(words) or not all(width.isdigit() and len(width) < _WIDE for width in widths):
        return tokens
    return [part for word, width in zip(words, widths, strict=True) for part in (word, " " * int(width)) if part]


_WIDE = 4
_LEXEMES = re.compile(
    r"""\n|[ \t]+|'(?:[^'$]|\$.)*'|:=|=>|<=|>=|<>|\*\*
    |(?:\#?"[^"]*"|\#?[^\W\d]\w*(?:\#[\w.+-]+)?)(?:\.(?:"[^"]*"|%?\w+)|\[[^\[\]\n]*\])*|\d[\w.\#]*|%\w+(?:\.\d)?|.""",
    re.VERBOSE | re.DOTALL,
)
"""The tokens of a row: an operand is one token, however long its path is."""


def _tokens(action: ActionAssociation, callee: str) -> list[str]:
    if isinstance(action.body, StBody):
        called = _CALL.fullmatch(action.body.text.strip()) if action.qualifier is Qualifier.CALL else None
        return _call(called[1], called[2], callee) if called is not None else _LEXEMES.findall(action.body.text)
    if action.target is None:
        return []
    if action.duration is not None:
        return [action.target, ",", action.duration]
    if action.value is not None:
        return [action.target, "," if action.qualifier is Qualifier.CS else ":=", *_LEXEMES.findall(action.value)]
    return [action.target]


def _call(called: str, arguments: str, callee: str) -> list[str]:
    """The tokens of a call, laid out as the editor does: a parameter on each line."""
    named = [callee, ",", called] if callee else [called]
    tokens = ["CALL", " ", *named, " ", "\n", " " * _INDENT, "("]
    for number, argument in enumerate(_split(arguments)):
        found = _ARGUMENT.fullmatch(argument)
        words = [found[1], " ", found[2], " ", found[3]] if found is not None else [argument]
        tokens += words if number == 0 else [" " * (_INDENT + 1), *words]
        tokens.append("\n")
    if tokens[-1] == "\n":
        tokens.append(" " * _INDENT)
    return [*tokens, ")"]


def _split(arguments: str) -> list[str]:
    """The arguments of a call: parted at commas that stand in no string and no brackets."""
    parts, depth, quote, start = [], 0, "", 0
    for place, letter in enumerate(arguments):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        elif letter in "([":
            depth += 1
        elif letter in ")]":
            depth -= 1
        elif letter == "," and depth == 0:
            parts.append(arguments[start:place].strip())
            start = place + 1
    last = arguments[start:].strip()
    return [*parts, last] if last else parts
