"""Reads the rows of GRAPH actions: tokens, into what they do. The writer is `actions_writer`."""

from __future__ import annotations

import re

from lxml import etree

from plcopen_sfc.formats.simaticml.actions_writer import CALLEE, LAYOUT, write_row
from plcopen_sfc.formats.simaticml.operands import parse_operand
from plcopen_sfc.formats.simaticml.reading import (
    TRUTHS,
    Fields,
    attributes,
    carry_attribute,
    children,
    keep_verbatim,
    local,
    opaque,
    same,
)
from plcopen_sfc.languages.st.parsing import parse_expression
from plcopen_sfc.model.actions import ActionAssociation, ActionEvent, Qualifier
from plcopen_sfc.model.dialect import Dialect

_CALL = re.compile(r'CALL\s+("[^"]+"|#?[^\s,(]+)(?:\s*,\s*("[^"]+"|#?[^\s,(]+))?\s*(?:\((.*)\))?\s*', re.DOTALL)
_PARAMETER = re.compile(r"\s*([^\W\d]\w*)\s*(:=|=>)\s*(.*\S)\s*")
_QUALIFIERS = frozenset(q.value for q in Qualifier) - {"None", "CALL"}
_EVENTS = frozenset(e.value for e in ActionEvent) - {"C"}
TIMED = frozenset({"L", "D", "TL", "TD", "TR", "TF"})
"""Qualifiers behind whose operand a time stands."""


def read_action(element: etree._Element) -> Fields:
    """Read ``Action``, without an id. A row that no rule fits is a body that is kept as it is."""
    fields = row_fields(element)
    if fields.get("body", {}).get("language") == "opaque":
        return fields
    copy = etree.Element("Action")
    write_row(copy, ActionAssociation.model_validate({"id": 0, **fields}))
    if same(element, copy):
        return fields
    layout = layout_of(element)
    if layout is not None and layout != layout_of(copy):
        carry_attribute(fields, LAYOUT, layout)
        write_row(copy := etree.Element("Action"), ActionAssociation.model_validate({"id": 0, **fields}))
    if not same(element, copy):
        keep_verbatim(fields, element)
        fields["carried"]["attributes"].pop(LAYOUT, None)
    return fields


def layout_of(row: etree._Element) -> str | None:
    """The blanks between the tokens of a row, each behind its token; None for a row of several lines."""
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


def row_fields(element: etree._Element) -> Fields:
    """What a row does."""
    left = attributes(element)
    qualifier, event = left.pop("Qualifier", ""), left.pop("Event", "")
    interlock = TRUTHS.get(left.pop("Interlock", "false"))
    tokens = children(element)
    plain = all(local(token) == "Token" and set(token.attrib) == {"Text"} and not len(token) for token in tokens)
    known = qualifier in ("", *_QUALIFIERS) and event in ("", *_EVENTS) and interlock is not None and not left
    fields: Fields = {"qualifier": Qualifier(qualifier) if qualifier in _QUALIFIERS else Qualifier.NONE}
    if not plain or not known:
        return {**fields, "body": opaque(element)}
    if event:
        fields["event"] = ActionEvent(event)
    if interlock:
        fields["interlock"] = True
    text = "".join(token.get("Text", "") for token in tokens).strip()
    if text:
        fields.update(_meaning(text, qualifier))
    return fields


def _meaning(text: str, qualifier: str) -> Fields:
    if qualifier == "N" and (found := _CALL.fullmatch(text)) is not None:
        called = _call(found)
        if called is not None:
            return called
    if "\n" not in text:
        target, assigns, value = text.partition(":=")
        if assigns and parse_operand(target) is not None and _is_value(value):
            return {"target": target.strip(), "value": value.strip()}
        target, comma, rest = text.partition(",")
        if comma and parse_operand(target) is not None and parse_operand(rest) is not None:
            if qualifier in TIMED:
                return {"target": target.strip(), "duration": rest.strip()}
            if qualifier == "CS":
                return {"target": target.strip(), "value": rest.strip()}
        if parse_operand(text) is not None:
            return {"target": text}
    return {"body": {"language": "ST", "text": text}}


def _is_value(text: str) -> bool:
    """Whether this is what an assignment assigns: an operand, or an expression of them."""
    if parse_operand(text) is not None:
        return True
    parsed = parse_expression(text, Dialect.SCL)
    return parsed.tree is not None and not parsed.problems


def _call(found: re.Match[str]) -> Fields | None:
    """A call row as a statement of SCL, which calls a function block by its instance."""
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
        carry_attribute(fields, CALLEE, callee)
    return fields
