"""Rows of GRAPH actions as tokens, read into the action they are and written."""

from __future__ import annotations

import re
from collections.abc import Mapping

from lxml import etree

from plcopen_sfc.formats.simaticml.element_reader import (
    TRUTHS,
    Fields,
    children,
    keep_attribute,
    keep_verbatim,
    local,
    opaque_body,
    same_content,
)
from plcopen_sfc.formats.simaticml.element_writer import sub
from plcopen_sfc.formats.simaticml.network_operands import parse_operand
from plcopen_sfc.formats.xml.extension_data import attributes, attributes_of, legal_text
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.model.actions import COILS, COUNTERS, SWITCHES, TIMERS, ActionEvent, Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import ActionAssociation
from plcopen_sfc.whole_numbers import whole_number

_CALL_STATEMENT = re.compile(r'("[^"]+"|#?\w+(?:\.\w+)*)\((.*)\);?', re.DOTALL)
_ARGUMENT = re.compile(r"([^\W\d]\w*) (:=|=>) (.*)", re.DOTALL)
_INDENT = 4
LAYOUT = "blanks"
"""Extension attribute of an association: the blanks behind each token of its row, where they are not the usual ones."""
CALLEE = "callee"
"""Extension attribute of an association: the function block whose instance it calls."""
GRAPH_QUALIFIERS = (
    frozenset({Qualifier.NONE, Qualifier.S, Qualifier.R, Qualifier.CALL}) | COILS | SWITCHES | COUNTERS | TIMERS
)
"""Qualifiers that GRAPH has."""
NEAREST = {
    Qualifier.R0: Qualifier.R,
    Qualifier.SD: Qualifier.D,
    Qualifier.DS: Qualifier.D,
    Qualifier.DL: Qualifier.D,
    Qualifier.SL: Qualifier.L,
}
"""Substitutes for qualifiers that GRAPH does not have; only R0 means the same."""
AS_EVENTS = {Qualifier.P1: ActionEvent.S1, Qualifier.P: ActionEvent.S1, Qualifier.P0: ActionEvent.S0}
"""Qualifiers of IEC 61131-3 that GRAPH expresses with an event: once at activation (P1, P), or at deactivation (P0)."""
_WIDEST = 999
_LEXEMES = re.compile(
    r"""\n|[ \t]+|'[^'$]*+(?:\$.[^'$]*+)*+'|:=|=>|<=|>=|<>|\*\*
    |(?:\#?"[^"]*"|\#?[^\W\d]\w*(?:\#[\w.+-]+)?)(?:\.(?:"[^"]*"|%?\w+)|\[[^\[\]\n]*\])*|\d[\w.\#]*|%\w+(?:\.\d)?|.""",
    re.VERBOSE | re.DOTALL,
)
"""Tokens of a row: an operand is one token, however long its path is."""
_CALL_ROW = re.compile(r'CALL\s+("[^"]+"|#?[^\s,(]+)(?:\s*,\s*("[^"]+"|#?[^\s,(]+))?\s*(?:\((.*)\))?\s*', re.DOTALL)
_PARAMETER = re.compile(r"\s*([^\W\d]\w*)\s*(:=|=>)\s*(.*\S)\s*")
_QUALIFIERS = frozenset(q.value for q in Qualifier) - {"None", "CALL"}
_EVENTS = frozenset(e.value for e in ActionEvent) - {"C"}
_TARGET_AND_OPERAND = 2
TIMED = frozenset({"L", "D", "TL", "TD", "TR", "TF"})
"""Qualifiers whose operand is followed by a time."""


def read_action(element: etree._Element) -> Fields:
    """Read ``Action``, without an id. A row that no rule fits is a body that is kept as it is."""
    fields = row_fields(element)
    if fields.get("body", {}).get("language") == "opaque":
        return fields
    copy = etree.Element("Action")
    write_row(copy, ActionAssociation.model_validate({"id": 0, **fields}))
    if same_content(element, copy):
        return fields
    layout = layout_of(element)
    if layout is not None and layout != layout_of(copy):
        keep_attribute(fields, LAYOUT, layout)
        write_row(copy := etree.Element("Action"), ActionAssociation.model_validate({"id": 0, **fields}))
    if not same_content(element, copy):
        keep_verbatim(fields, element)
        fields["extension_data"]["attributes"].pop(LAYOUT, None)
    return fields


def write_row(element: etree._Element, action: ActionAssociation, blocks: Mapping[str, str] | None = None) -> None:
    """Fill ``Action`` with the tokens of an association. `blocks` are the function blocks of instance data blocks."""
    kept = attributes_of(action.extension_data)
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


def layout_of(row: etree._Element) -> str | None:
    """Return the blanks between the tokens of a row, each behind its token; None for a row of several lines."""
    found: list[int] = []
    tokens = [token.get("Text", "") for token in children(row)]
    for token in tokens[:-1]:
        if token.strip():
            found.append(0)
        elif "\n" in token or not found or found[-1] or token.strip(" "):
            return None
        else:
            found[-1] = len(token)
    return " ".join(map(str, found)) if tokens[-1:] == ["\n"] else None


def _laid_out(tokens: list[str], layout: str) -> list[str]:
    """Tokens with the blanks between them that the row had, if it has the same number of tokens."""
    words = [token for token in tokens if token.strip()]
    widths = [width for text in layout.split() if (width := whole_number(text)) is not None and width <= _WIDEST]
    if len(widths) != len(words):
        return tokens
    return [part for word, width in zip(words, widths, strict=True) for part in (word, " " * width) if part]


def row_fields(element: etree._Element) -> Fields:
    """Return the fields of an association for a row."""
    left = attributes(element)
    qualifier, event = left.pop("Qualifier", ""), left.pop("Event", "")
    interlock = TRUTHS.get(left.pop("Interlock", "false"))
    tokens = children(element)
    plain = all(local(token) == "Token" and set(token.attrib) == {"Text"} and not len(token) for token in tokens)
    known = qualifier in ("", *_QUALIFIERS) and event in ("", *_EVENTS) and interlock is not None and not left
    fields: Fields = {"qualifier": Qualifier(qualifier) if qualifier in _QUALIFIERS else Qualifier.NONE}
    if not plain or not known:
        return {**fields, "body": opaque_body(element)}
    if event:
        fields["event"] = ActionEvent(event)
    if interlock:
        fields["interlock"] = True
    text = "".join(token.get("Text", "") for token in tokens).strip()
    if text:
        fields.update(_meaning(text, qualifier))
    return fields


def _meaning(text: str, qualifier: str) -> Fields:
    if qualifier == "N" and (found := _CALL_ROW.fullmatch(text)) is not None:
        called = _call_statement(found)
        if called is not None:
            return called
    if "\n" not in text:
        target, assigns, value = text.partition(":=")
        if assigns and parse_operand(target) is not None and _is_value(value):
            return {"target": target.strip(), "value": value.strip()}
        parts = _split(text)
        if len(parts) == _TARGET_AND_OPERAND and all(parse_operand(part) is not None for part in parts):
            target, rest = parts
            if qualifier in TIMED:
                return {"target": target, "duration": rest}
            if qualifier == "CS":
                return {"target": target, "value": rest}
        if parse_operand(text) is not None:
            return {"target": text}
    return {"body": {"language": "ST", "text": text}}


def _is_value(text: str) -> bool:
    """True if an assignment can have this text as its value: an operand, or an expression of them."""
    if parse_operand(text) is not None:
        return True
    parsed = parse_expression(text, Dialect.SCL)
    return parsed.tree is not None and not parsed.problems


def _tokens(action: ActionAssociation, callee: str) -> list[str]:
    if isinstance(action.body, StBody):
        called = _CALL_STATEMENT.fullmatch(action.body.text.strip()) if action.qualifier is Qualifier.CALL else None
        return _call_tokens(called[1], called[2], callee) if called is not None else _LEXEMES.findall(action.body.text)
    if action.target is None:
        return []
    if action.duration is not None and NEAREST.get(action.qualifier, action.qualifier) in TIMED:
        return [action.target, ",", action.duration]
    if action.value is not None:
        return [action.target, "," if action.qualifier is Qualifier.CS else ":=", *_LEXEMES.findall(action.value)]
    return [action.target]


def _call_statement(found: re.Match[str]) -> Fields | None:
    """Return a call row as a statement of SCL, which calls a function block by its instance."""
    callee, instance, listed = found[1], found[2], found[3]
    parameters = []
    for line in (listed or "").splitlines():
        parameter = _PARAMETER.fullmatch(line.strip().removesuffix(","))
        if parameter is None and line.strip():
            return None
        if parameter is not None:
            parameters.append(f"{parameter[1]} {parameter[2]} {parameter[3]}")
    text = f"{instance or callee}({', '.join(parameters)});"
    fields: Fields = {"qualifier": Qualifier.CALL, "body": {"language": "ST", "text": text}}
    if instance is not None:
        keep_attribute(fields, CALLEE, callee)
    return fields


def _call_tokens(called: str, arguments: str, callee: str) -> list[str]:
    """Return the tokens of a call, laid out as the editor does: a parameter on each line."""
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
    """Return the arguments of a call: split at commas outside of strings and brackets."""
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
