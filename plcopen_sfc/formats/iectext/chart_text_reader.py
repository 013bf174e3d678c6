"""Reads the parts of a chart: steps with their associations, and transitions. The writer is `pou_text_writer`."""

from __future__ import annotations

import re
from collections.abc import Container, Iterator
from contextlib import suppress
from copy import deepcopy
from dataclasses import dataclass, field
from itertools import count
from typing import Any

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.iectext.text_outline import TextPart
from plcopen_sfc.formats.iectext.text_source import (
    Annotations,
    TextSource,
    between_semicolons,
    keep_text,
    taken,
)
from plcopen_sfc.formats.text_patch import plain_lines
from plcopen_sfc.languages.declarations.kept_texts import wrapped
from plcopen_sfc.languages.il import is_il
from plcopen_sfc.languages.pragmas import Fields, PathError, RemainderEntry, StaleError, apply, format_path
from plcopen_sfc.languages.st.lexer import Token
from plcopen_sfc.model.actions import STEP_ACTIONS, Qualifier
from plcopen_sfc.whole_numbers import whole_number

_QUALIFIERS = {q.value.upper(): q.value for q in Qualifier if q is not Qualifier.NONE}
_DURATION = re.compile(r"(?:L?TIME|L?T|S5T|S5TIME)#", re.IGNORECASE)
_NEGATION = re.compile(r"NOT\s*\(\s*(.*?)\s*\)|NOT\s+([^\W\d]\w*)", re.IGNORECASE | re.DOTALL)


@dataclass(slots=True)
class ElementText:
    """Fields of an element from its text, the annotations beside it, and its place.

    `name` is the name as written, `sides` the names in FROM (`sources`) and TO (`targets`).
    """

    fields: Fields
    annotations: Annotations
    start: int
    path: str
    name: str = ""
    associations: list[ElementText] = field(default_factory=list)
    sides: dict[str, list[str]] = field(default_factory=dict)


@dataclass(slots=True)
class ChartText:
    """Steps and transitions of a chart in the order of the text."""

    steps: list[ElementText] = field(default_factory=list)
    transitions: list[ElementText] = field(default_factory=list)


# -- steps ------------------------------------------------------------------------------------------------------------


def read_step(src: TextSource, part: TextPart, annotations: Annotations, place: str) -> ElementText:
    """``STEP name: associations END_STEP``."""
    path = f"{place} / step {part.name}"
    fields: Fields = {"name": part.name}
    if part.keyword == "INITIAL_STEP":
        fields["initial"] = True
    step = ElementText(fields, annotations, part.start, path, part.name)
    groups = list(between_semicolons(src.outline.tokens(part.tokens)))
    starts = [group[0].span[0] for group in groups]
    annotations.extend(src.annotations(part.inside[0], starts[0] if starts else part.inside[1], path))
    for group, start, end in zip(groups, starts, [*starts[1:], part.inside[1]], strict=False):
        step.associations.append(_read_association(src, group, src.annotations(start, end, path), path))
    return step


def _read_association(src: TextSource, tokens: list[Token], annotations: Annotations, path: str) -> ElementText:
    fields = association_fields(src.text, tokens)
    start = tokens[0].span[0]
    if fields is None:
        text = src.text[start : tokens[-1].span[1]]
        src.note(
            "IEC102", f"{text[:40]!r} is no association of an action: name(qualifier, time, indicator)", start, path
        )
        fields = {
            "qualifier": Qualifier.NONE.value,
            "extension_data": {"data": [wrapped("association", plain_lines(text))]},
        }
    return ElementText(fields, annotations, start, path)


def association_fields(text: str, tokens: list[Token]) -> Fields | None:
    """Return the fields of ``target(qualifier, time, indicator)``; None for any other text."""

    def slice_of(part: list[Token]) -> str:
        return plain_lines(text[part[0].span[0] : part[-1].span[1]])

    opening = _last_parenthesis(tokens)
    target = tokens if opening is None else tokens[:opening]
    if not target or any(t.type in ("BAD", "ASSIGN", "COLON") for t in tokens):
        return None
    if sum((t.type == "LPAR") - (t.type == "RPAR") for t in tokens) != 0:
        return None
    fields: Fields = {"target": slice_of(target), "qualifier": Qualifier.NONE.value}
    arguments = _arguments(tokens[opening + 1 : -1]) if opening is not None else []
    if arguments is None:
        return None
    if arguments:
        qualifier = _QUALIFIERS.get(slice_of(arguments[0]).upper())
        if qualifier is None:
            return None
        del fields["qualifier"]
        if qualifier != Qualifier.N.value:
            fields["qualifier"] = qualifier
        rest = arguments[1:]
        if rest and (Qualifier(qualifier).needs_duration or _DURATION.match(slice_of(rest[0]))):
            fields["duration"] = slice_of(rest.pop(0))
        if rest:
            fields["indicator"] = plain_lines(text[rest[0][0].span[0] : rest[-1][-1].span[1]])
    return fields


def _last_parenthesis(tokens: list[Token]) -> int | None:
    """Return the index of the parenthesis that the last token closes."""
    depth = 0
    for index in range(len(tokens) - 1, -1, -1):
        depth += (tokens[index].type == "RPAR") - (tokens[index].type == "LPAR")
        if depth <= 0:
            return index if tokens[index].type == "LPAR" and index > 0 else None
    return None


def _arguments(tokens: list[Token]) -> list[list[Token]] | None:
    """Split at the commas outside of brackets; None where an argument is empty."""
    if not tokens:
        return []
    arguments: list[list[Token]] = [[]]
    depth = 0
    for token in tokens:
        depth += (token.type in ("LPAR", "LSQB")) - (token.type in ("RPAR", "RSQB"))
        if token.type == "COMMA" and depth == 0:
            arguments.append([])
        else:
            arguments[-1].append(token)
    return arguments if all(arguments) else None


# -- transitions ------------------------------------------------------------------------------------------------------


def read_transition(src: TextSource, part: TextPart, annotations: Annotations, place: str) -> ElementText:
    """``TRANSITION name (PRIORITY := n) FROM (..) TO (..) := condition; END_TRANSITION``."""
    tokens = src.outline.tokens(part.tokens)
    header = _Header(src, tokens, part, place)
    transition = ElementText(header.fields, annotations, part.start, header.path, sides=header.sides)
    rest = tokens[header.at :]
    begin, end = src.core(rest[0].span[1] if rest else part.inside[0], part.inside[1])
    annotations.extend(src.annotations(part.inside[0], begin, header.path))
    annotations.extend(src.annotations(end, part.inside[1], header.path))
    if rest:
        condition = condition_fields(src.text, rest[0].type, rest[1:], begin, end)
        if condition is None:
            src.note("IEC103", "a condition is := expression; or : a body", rest[0].span[0], header.path)
            condition = {"kind": "expression", "text": taken(src.text[begin:end])}
        if condition:
            header.fields["condition"] = condition
        src.check_code(condition.get("body", condition), begin, end, header.path)
        if condition.get("kind") == "expression":
            annotations.extend(src.annotations(rest[-1].span[1], end, header.path))
    return transition


class _Header:
    """Header of a transition, up to its condition."""

    def __init__(self, src: TextSource, tokens: list[Token], part: TextPart, place: str) -> None:
        self.src = src
        self.tokens = tokens
        self.at = 0
        self.fields: Fields = {}
        self.sides: dict[str, list[str]] = {}
        self.start = part.start
        self.path = f"{place} / transition"
        if not self._is("FROM") and self._word():
            self.fields["name"] = self._take()
        if self._is("LPAR") and self._is("PRIORITY", 1):
            self._priority()
        for key, keyword in (("sources", "FROM"), ("targets", "TO")):
            if self._is(keyword):
                self.at += 1
                self.sides[key] = self._names()
        name = self.fields.get("name") or " -> ".join("+".join(names) for names in self.sides.values())
        self.path = f"{place} / transition {name}"
        self._skip_to_condition()

    def _type(self, ahead: int = 0) -> str:
        index = self.at + ahead
        return self.tokens[index].type if index < len(self.tokens) else ""

    def _is(self, what: str, ahead: int = 0) -> bool:
        index = self.at + ahead
        return index < len(self.tokens) and what in (self.tokens[index].type, self.tokens[index].value.upper())

    def _word(self) -> bool:
        return self.at < len(self.tokens) and self.tokens[self.at].value[:1].replace("_", "a").isalpha()

    def _take(self) -> str:
        self.at += 1
        return self.tokens[self.at - 1].value

    def _priority(self) -> None:
        if self._type(2) == "ASSIGN" and self._type(4) == "RPAR":
            number = whole_number(self.tokens[self.at + 3].value)
            if number is not None:
                self.fields["priority"] = number
                self.at += 5

    def _names(self) -> list[str]:
        if not self._is("LPAR"):
            return [self._take()] if self._word() else []
        self.at += 1
        names: list[str] = []
        while self._word():
            names.append(self._take())
            self.at += self._is("COMMA")
        self.at += self._is("RPAR")
        return names

    def _skip_to_condition(self) -> None:
        if self.at < len(self.tokens) and self._type() not in ("ASSIGN", "COLON"):
            token = self.tokens[self.at]
            message = f"{token.value[:30]!r} is not allowed here: TRANSITION name (PRIORITY := n) FROM steps TO steps"
            self.src.note("IEC103", message, token.span[0], self.path)
            while self.at < len(self.tokens) and self._type() not in ("ASSIGN", "COLON"):
                self.at += 1
            text = plain_lines(self.src.text[token.span[0] : self.tokens[self.at - 1].span[1]])
            self.fields["extension_data"] = {"data": [wrapped("transition", text)]}


def condition_fields(text: str, mark: str, tokens: list[Token], begin: int, end: int) -> Fields | None:
    """Fields of ``:= expression;`` (`mark` ASSIGN) or ``: body``; {} without any text, None if it is neither."""
    if mark == "COLON":
        return {"kind": "body", "body": body_fields(taken(text[begin:end]), tokens)}
    if not tokens or tokens[-1].type != "SEMICOLON":
        if is_il(tokens):  # ed. 2 writes := before instructions too
            return {"kind": "body", "body": body_fields(taken(text[begin:end]), tokens)}
        return None if tokens else {}
    if any(token.type == "SEMICOLON" for token in tokens[:-1]):
        return None
    expression = plain_lines(text[begin : tokens[-1].span[0]]).strip()
    return {"kind": "expression", "text": expression} if expression else {}


def body_fields(text: str, tokens: list[Token]) -> Fields:
    """Return the body of this text: instructions or statements."""
    return {"language": "IL" if is_il(tokens) else "ST"} | ({"text": text} if text else {})


def unnegated(fields: Fields) -> None:
    """Take ``NOT (..)`` off an expression whose negation is in a pragma."""
    found = _NEGATION.fullmatch(fields.get("text", ""))
    if found is not None:
        fields["text"] = found.group(1) if found.group(1) is not None else found.group(2)


def named_condition(text: str, named: Container[str]) -> Fields | None:
    """Return the condition that is, or negates, one of the transition objects `named`, in lower case."""
    plain: Fields = {"text": text}
    unnegated(plain)
    if plain["text"].casefold() not in named:
        return None
    negation = {"negated": True} if plain["text"] != text else {}
    return {"kind": "named", "name": plain["text"], **negation}


# -- the chart --------------------------------------------------------------------------------------------------------


@dataclass(slots=True)
class ChartReferences:
    """Objects that a chart refers to: bodies in place, by their names, and the transition objects of the POU."""

    in_place: dict[str, Fields]
    named_transitions: frozenset[str]


def chart_fields(src: TextSource, chart: ChartText, around: ChartReferences, place: str) -> Fields:
    """Return the fields of the chart, its names resolved; without the changes of pragmas at the end of the unit."""
    known = {step.name.casefold() for step in chart.steps}
    for transition in chart.transitions:
        transition.annotations.put_into(transition.fields)
        _keep_unknown(src, transition, known)
    steps = [_finished_step(src, step, around) for step in chart.steps]
    transitions = [_finished_transition(src, transition, around) for transition in chart.transitions]
    fields: Fields = {}
    if steps:
        fields["steps"] = steps
    if transitions:
        fields["transitions"] = transitions
    if steps and not any(step.get("initial") for step in steps):
        src.note("SFC111", "the chart has no initial step", chart.steps[0].start, place, Severity.WARNING)
    return fields


def number(src: TextSource, chart: ChartText, fields: Fields) -> None:
    """Give an id to every step, association and transition without one, and resolve the names in FROM and TO.

    They get the numbers that are free, in the order of the text; ``unused_ids`` are not.
    """
    steps, transitions = fields.get("steps", []), fields.get("transitions", [])
    numbered = [thing for step in steps for thing in (step, *step.get("actions", []))] + transitions
    taken = {*ids_within(fields), *fields.pop("unused_ids", [])}
    free = (number for number in count() if number not in taken)
    for thing in numbered:
        if "id" not in thing:
            thing["id"] = next(free)
    by_name: dict[str, int] = {}
    for element, step in zip(chart.steps, steps, strict=False):  # a pragma may have added some
        if element.name.casefold() in by_name:
            src.note("SFC109", f"two steps have the name {element.name!r}", element.start, element.path)
        by_name.setdefault(element.name.casefold(), step["id"])
    for element, transition in zip(chart.transitions, transitions, strict=False):
        for side, names in element.sides.items():
            if side not in transition:
                found = [by_name[name.casefold()] for name in names if name.casefold() in by_name]
                transition.update({side: found} if found else {})


def ids_within(value: Any) -> Iterator[int]:
    """Yield every id in a chart, those that its drawing gives too."""
    if isinstance(value, dict):
        for key, item in value.items():
            if key in ("id", "local_id", "association") and isinstance(item, int):
                yield item
            else:
                yield from ids_within(item)
    elif isinstance(value, list):
        for item in value:
            yield from ids_within(item)


def _keep_unknown(src: TextSource, element: ElementText, known: set[str]) -> None:
    """Keep the names in FROM and TO that no step of the chart has."""
    for side, names in element.sides.items():
        keyword = "FROM" if side == "sources" else "TO"
        for name in names:
            if name.casefold() not in known:
                src.note(
                    "SFC103", f"{keyword} names {name!r}, which is no step of this chart", element.start, element.path
                )
                keep_text(element.fields, keyword.lower(), name)


def apply_change(src: TextSource, fields: Fields, found: tuple[RemainderEntry, int], path: str) -> None:
    """Make the change of a pragma, or report that it leads nowhere."""
    try:
        apply(fields, found[0])
    except StaleError as error:
        message = f"{error}: the pragma {format_path(found[0].path)} was for another text and is left out"
        src.note("IEC213", message, found[1], path, Severity.INFO)
    except PathError as error:
        src.note("IEC211", f"this pragma does not fit: {error}", found[1], path)


def _finished_step(src: TextSource, element: ElementText, around: ChartReferences) -> Fields:
    fields = element.fields
    element.annotations.put_into(fields)
    actions: list[Fields] = []
    for association in element.associations:
        done, step_action = _finished_association(src, association, around, {element.name, fields.get("name", "")})
        if step_action in STEP_ACTIONS:
            fields[f"{step_action}_action"] = done.get("body") or done.get("target", "")
        else:
            actions.append(done)
    if actions:
        fields["actions"] = actions
    for found in element.annotations.changes:
        apply_change(src, fields, found, element.path)
    return fields


def _finished_association(
    src: TextSource, element: ElementText, around: ChartReferences, step_names: set[str]
) -> tuple[Fields, str | None]:
    fields, changes = element.fields, element.annotations.changes
    element.annotations.put_into(fields)
    if (name := str(fields.get("target", "")).casefold()) in around.in_place:
        fields["body"] = {"body_of": fields.pop("target")}
        with_changes = deepcopy(fields)
        for found in changes:
            with suppress(PathError, StaleError):
                apply(with_changes, found[0])
        if _is_edited(str(around.in_place[name].get("text", "")), with_changes, step_names):
            message = "the statements were changed; what is beside them of a condition or a call is left out"
            src.note("IEC213", message, element.start, element.path, Severity.WARNING)
            changes = [found for found in changes if found[0].path[0] not in _IN_STATEMENTS]
    for found in changes:
        apply_change(src, fields, found, element.path)
    return fields, fields.pop("step_action", None)


_IN_STATEMENTS = frozenset({"target", "qualifier", "condition", "body"})
"""Parts of an association that are statements in an action in place, where the text has no words for them."""


def guarded_statement(target: str, step: str, condition: str, *, negated: bool) -> str:
    """Return what does the same as the qualifier N with a variable under a condition."""
    return f"{target} := {step}.X AND {'NOT ' if negated else ''}({condition.strip()});"


def guarded_call(step: str, statements: str) -> str:
    """Return statements that are executed in each cycle in which a step is active."""
    return f"IF {step}.X THEN\n    {statements}\nEND_IF;"


def _is_edited(text: str, association: Fields, step_names: set[str]) -> bool:
    """True if statements in the place of an association with a condition, or of a call, do something else now."""
    condition, body = association.get("condition"), association.get("body")
    if body is None and isinstance(condition, dict):
        made = [
            guarded_statement(
                str(association.get("target")), name, str(condition.get("text")), negated=bool(condition.get("negated"))
            )
            for name in step_names
        ]
    elif isinstance(body, dict) and "text" in body:
        made = [guarded_call(name, str(body["text"])) for name in step_names]
    else:
        return False
    return "".join(text.split()) not in {"".join(each.split()) for each in made}


def _finished_transition(src: TextSource, element: ElementText, around: ChartReferences) -> Fields:
    fields = element.fields
    condition = fields.get("condition")
    if condition is not None and condition["kind"] == "expression":
        if any(c.path == ("condition", "negated") for c, _ in element.annotations.changes):
            unnegated(condition)
        fields["condition"] = named_condition(condition["text"], around.named_transitions) or condition
    if condition is None and not any(c.path[0] == "condition" for c, _ in element.annotations.changes):
        src.note("SFC112", "a transition has no condition", element.start, element.path)
    for found in element.annotations.changes:
        apply_change(src, fields, found, element.path)
    return fields
