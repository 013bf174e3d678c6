"""Reads programs, function blocks, functions, and the actions and methods in them. The writer is `pou_text_writer`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from pydantic import ValidationError

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.formats.iectext.chart_text_reader import (
    ChartReferences,
    ChartText,
    apply_change,
    body_fields,
    chart_fields,
    condition_fields,
    number,
    read_step,
    read_transition,
)
from plcopen_sfc.formats.iectext.text_declarations import (
    are_plain,
    late_interface,
    read_return_type,
    read_section,
)
from plcopen_sfc.formats.iectext.text_outline import PartKind, TextPart
from plcopen_sfc.formats.iectext.text_printing import put_drawing
from plcopen_sfc.formats.iectext.text_source import (
    Annotations,
    TextBlock,
    TextSource,
    is_own,
    keep_text,
    taken,
)
from plcopen_sfc.formats.text_patch import plain_lines
from plcopen_sfc.languages.declarations.kept_texts import Inheritance, unwrapped
from plcopen_sfc.languages.pragmas import Fields, RemainderEntry, plain_fields
from plcopen_sfc.model.checked import first_misfit
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.variables import VariableSection

_KINDS = {PartKind.PROGRAM: "program", PartKind.FUNCTION_BLOCK: "functionBlock", PartKind.FUNCTION: "function"}


@dataclass(slots=True)
class UnitText:
    """Content of a POU, a method or an action: `fields` of its own, its parts, and its body."""

    path: str
    fields: Fields
    annotations: Annotations
    chart: ChartText = field(default_factory=ChartText)
    body: Fields | None = None
    sections: list[VariableSection] = field(default_factory=list)
    unread: list[tuple[TextPart, tuple[int, int]]] = field(default_factory=list)
    is_late: bool = False
    actions: list[Fields] = field(default_factory=list)
    transitions: list[Fields] = field(default_factory=list)
    methods: list[Fields] = field(default_factory=list)
    in_place: dict[str, Fields] = field(default_factory=dict)
    rest: list[str] = field(default_factory=list)
    declared: tuple[int, int] = (0, 0)
    start: int = 0


def read_pou(src: TextSource, part: TextPart, gap: tuple[int, int]) -> Pou:
    """Read a program, function block or function; `gap` is the text before it."""
    while True:
        fields = _pou_fields(src, part, gap)
        try:
            return Pou.model_validate(fields)
        except ValidationError as error:
            if not _leave_out(src, part, gap, error):
                raise


def _pou_fields(src: TextSource, part: TextPart, gap: tuple[int, int]) -> Fields:
    src.named = frozenset(_object_names(src, part))
    container = _container(src, part, gap, "POU ")
    container.fields["kind"] = _KINDS.get(part.kind, part.kind)  # a pragma may have a finer kind
    fields = _finished(src, container)
    body = _body(fields.pop("body", None), fields.pop("chart", None))
    fields["bodies"] = ([body] if body is not None else []) + fields.get("bodies", [])
    return fields


def _body(body: Fields | None, chart: Fields | None) -> Fields | None:
    if body is None:
        return None
    return body if chart is None else body | {"chart": chart}


def _leave_out(src: TextSource, part: TextPart, gap: tuple[int, int], error: ValidationError) -> bool:
    """Find the pragma that does not fit the model and leave it out from now on; False where there is none."""
    before = set(src.ignored)
    offsets = [c.span[0] for c in src.outline.comments(gap[0], part.end) if is_own(c)]
    message = f"this pragma does not fit: {first_misfit(error)}"
    for offset in offsets:
        if offset in before:
            continue
        src.ignored = {*before, offset}
        try:
            Pou.model_validate(_pou_fields(src, part, gap))
        except ValidationError as again:
            if again.error_count() >= error.error_count():
                continue
        src.note("IEC212", message, offset, f"POU {part.name}")
        return True
    src.ignored = before | set(offsets)
    for offset in offsets[:1]:
        src.note(
            "IEC212", f"{message}; all pragmas of plcopen_sfc in this unit are left out", offset, f"POU {part.name}"
        )
    return src.ignored != before


# -- containers -------------------------------------------------------------------------------------------------------


def _container(src: TextSource, part: TextPart, gap: tuple[int, int], prefix: str) -> UnitText:
    """Read the content of `part`, up to its END."""
    path = f"{prefix}{part.name}"
    annotations = src.annotations(*gap, path)
    container = UnitText(path, {"name": part.name}, annotations, start=part.start)
    _take_declaration(src, part, gap, container)
    if part.kind is not PartKind.ACTION:
        container.fields["interface"] = {}
    if part.return_type is not None:
        container.fields["interface"]["return_type"] = read_return_type(src, part.return_type, path)
    if not _is_as_typed(container.annotations):
        _keep_header_rest(src, part, container)
    declaring = (part, *(inner for inner in part.parts if inner.kind is PartKind.ACTION))
    sections = [[inner for inner in each.parts if inner.kind is PartKind.VAR] for each in declaring]
    container.is_late = part.kind is not PartKind.ACTION and not any(sections[1:]) and are_plain(src, sections[0])
    has_chart = any(
        p.kind is PartKind.STEP or (p.kind is PartKind.TRANSITION and src.outline.leads(p)) for p in part.parts
    )
    position, loose = part.inside[0], False
    for inner in part.parts:
        if inner.kind is PartKind.LOOSE:
            loose = True
            continue
        above = _body_region(src, container, (position, inner.start), inner, loose=loose, chart=has_chart)
        _read_part(src, inner, (above, inner.start), container)
        position, loose = inner.end, False
    above = _body_region(src, container, (position, part.inside[1]), None, loose=loose, chart=has_chart)
    container.annotations.extend(src.annotations(above, part.inside[1], path))
    if has_chart:
        container.body = {"language": "SFC"}
    return container


def _take_declaration(src: TextSource, part: TextPart, gap: tuple[int, int], container: UnitText) -> None:
    """Keep the range of the text of the declaration, if it is to be kept as it was typed."""
    own = [c.span[1] for c in src.outline.comments(*gap) if is_own(c)]
    start = own[-1] if own else gap[0]
    while start < part.start and src.text[start].isspace():
        start += 1
    end = part.inside[0]
    for inner in part.parts:
        if inner.kind is not PartKind.VAR:
            break
        end = inner.end
    container.declared = (start, end)
    if _is_as_typed(container.annotations):
        container.annotations.comments, container.annotations.pragmas = [], []
        for comment in src.outline.comments(gap[0], own[0] if own else gap[0]):
            container.annotations.extend(
                src.annotations(*comment.span, container.path) if not is_own(comment) else Annotations()
            )


def _is_as_typed(annotations: Annotations) -> bool:
    return any(c.path[-1] == "declaration_ends" for c, _ in annotations.changes)


def _keep_header_rest(src: TextSource, part: TextPart, container: UnitText) -> None:
    """Keep words of the header that the model has no field for: EXTENDS, IMPLEMENTS, and those before the name."""
    tokens = src.outline.tokens(part.head)
    if part.kind is not PartKind.ACTION:
        extends, implements = _behind(tokens, "EXTENDS"), _behind(tokens, "IMPLEMENTS")
        extension_data = Inheritance(extends, implements).keep()
        if extension_data is not None:
            container.fields["interface"]["extension_data"] = extension_data.model_dump()
    modifiers = [t.value for t in tokens[1:] if t.span[1] <= _name_start(tokens, part)]
    if modifiers:
        keep_text(container.fields, "modifiers", " ".join(modifiers))


def _behind(tokens: list[Any], word: str) -> tuple[str, ...]:
    """Return the names behind EXTENDS or IMPLEMENTS in a header."""
    values = [token.value for token in tokens]
    start = next((index + 1 for index, value in enumerate(values) if value.upper() == word), len(values))
    ends = (index for index in range(start, len(values)) if values[index].upper() in ("IMPLEMENTS", ";", ":"))
    return tuple(filter(None, "".join(values[start : next(ends, len(values))]).split(",")))


def _name_start(tokens: list[Any], part: TextPart) -> int:
    first = part.name.split(".")[0]
    return int(next((t.span[0] for t in tokens[1:] if t.value == first), 0))


def _object_names(src: TextSource, part: TextPart) -> Iterator[str]:
    """Yield the names of the transition objects of a POU."""
    for inner in part.parts:
        if inner.kind is PartKind.TRANSITION and not src.outline.leads(inner):
            yield from (token.value.casefold() for token in src.outline.tokens(inner.tokens)[:1])


def _body_region(
    src: TextSource, container: UnitText, gap: tuple[int, int], following: TextPart | None, *, loose: bool, chart: bool
) -> int:
    """Take the body from the gap before a part or before the END, and return where the rest of the gap begins."""
    start, end = gap
    above = src.attached(start, end) if following is not None else src.core(start, end)[1]
    comments = [c for c in src.outline.comments(start, above) if not is_own(c)]
    if not loose and (chart or not comments or (following is not None and following.kind is PartKind.VAR)):
        return start
    begin = src.core(start, above)[0]
    container.annotations.extend(src.annotations(start, begin, container.path))
    start = begin
    text = taken(src.text[start:above])
    if chart or container.body is not None:
        src.note("IEC104", "these statements belong to no step, action or transition", start, container.path)
        container.rest.append(text)
    else:
        container.body = body_fields(text, src.outline.tokens_within(start, above))
        src.check_code(container.body, start, above, container.path)
    return above


def _read_part(src: TextSource, part: TextPart, gap: tuple[int, int], container: UnitText) -> None:
    """Read a part of a unit into `container`; `gap` is the text before it, whose comments and pragmas belong to it."""
    place = container.path
    if part.kind is PartKind.VAR and container.is_late:
        container.unread.append((part, gap))
    elif part.kind is PartKind.VAR:
        sections = read_section(src, part, gap, place)
        if not sections:
            src.note("IEC108", f"{part.keyword} is not allowed in a POU", part.start, place)
            keep_text(container.fields, "section", plain_lines(src.text[part.start : part.end]))
        container.sections += sections
    elif part.kind is PartKind.STEP:
        container.chart.steps.append(read_step(src, part, src.annotations(*gap, place), place))
    elif part.kind is PartKind.TRANSITION and (src.outline.leads(part) or not part.closed):
        container.chart.transitions.append(read_transition(src, part, src.annotations(*gap, place), place))
    elif part.kind is PartKind.TRANSITION:
        container.transitions.append(_read_transition_object(src, part, gap, place))
    elif part.kind is PartKind.PROPERTY:
        container.annotations.extend(src.annotations(*gap, place))
        keep_text(container.fields, "property", plain_lines(src.text[part.start : part.end]))
    else:
        inner = _container(src, part, gap, f"{place} / {part.kind.lower()} ")
        in_place = [c for c, _ in inner.annotations.changes if c.path == ("in_place",)]
        inner.annotations.changes = [found for found in inner.annotations.changes if found[0] not in in_place]
        if part.kind is PartKind.ACTION and inner.sections:
            src.note("IEC108", "variables in an action: they are those of the POU now", part.start, inner.path)
            container.sections += inner.sections
            inner.sections = []
        fields = _finished(src, inner)
        body = _body(fields.pop("body", None), fields.pop("chart", None))
        if body is not None:
            fields["body"] = body
        # only a POU has parts of its own; where an END is missing, those of its neighbours are inside
        for name in ("actions", "transitions", "methods"):
            getattr(container, name).extend(fields.pop(name, []))
        if in_place:
            container.in_place[part.name.casefold()] = fields.get("body", {})
        elif part.kind is PartKind.METHOD:
            container.methods.append(fields)
        else:
            container.actions.append(fields)


def _read_transition_object(src: TextSource, part: TextPart, gap: tuple[int, int], place: str) -> Fields:
    """``TRANSITION name := expression; END_TRANSITION``: a condition with a name, which charts refer to."""
    tokens = src.outline.tokens(part.tokens)
    name = tokens[0].value if tokens and tokens[0].type == "NAME" else ""
    path = f"{place} / transition {name}"
    annotations = src.annotations(*gap, path)
    fields: Fields = {"name": name}
    rest = tokens[1:] if name else tokens
    begin, end = src.core(rest[0].span[1] if rest else part.inside[0], part.inside[1])
    annotations.extend(src.annotations(part.inside[0], begin, path))
    annotations.extend(src.annotations(end, part.inside[1], path))
    condition = condition_fields(src.text, rest[0].type, rest[1:], begin, end) if rest else {}
    if condition is None or (rest and rest[0].type not in ("ASSIGN", "COLON")):
        src.note("IEC103", "a condition is := expression; or : a body", part.start, path)
        start = rest[0].span[0] if rest and rest[0].type not in ("ASSIGN", "COLON") else begin
        fields["body"] = {"language": "ST", "text": taken(src.text[start:end])}
    elif condition.get("kind") == "expression":
        src.check_code(condition, begin, end, path)
        fields["body"] = {"language": "ST", "text": condition["text"]}
    else:
        fields["body"] = condition.get("body", {"language": "ST"})
    annotations.put_into(fields)
    fields = _with_changes(src, annotations, fields, path)
    if not put_drawing(fields, "body"):
        message = "the text of this condition was changed; the drawing that it was made from is left out"
        src.note("IEC213", message, part.start, path, Severity.WARNING)
    body = _body(fields.pop("body", None), fields.pop("chart", None))
    return fields | ({"body": body} if body is not None else {})


# -- putting it together ----------------------------------------------------------------------------------------------


def _finished(src: TextSource, container: UnitText) -> Fields:
    """Return the fields of a container; its main body under `body`, the chart of that under `chart`."""
    fields = container.fields
    container.annotations.put_into(fields)
    if "extension_data" in fields:
        fields["extension_data"].get("data", []).sort(key=_place_in_head)
    around = ChartReferences(container.in_place, src.named)
    if container.body is not None and container.body["language"] == "SFC":
        fields["chart"] = chart_fields(src, container.chart, around, container.path)
    fields["body"] = container.body if container.body is not None else {"language": "ST"}
    for name in ("actions", "transitions", "methods"):
        if getattr(container, name):
            fields[name] = getattr(container, name)
    if _is_as_typed(container.annotations):  # tools list no sections without variables
        container.sections = [section for section in container.sections if section.variables]
    if container.sections:
        # to make them again of plain data takes as long as to read them: only pragmas change that
        parts = map(plain_fields, container.sections) if src.has_changes else container.sections
        fields.setdefault("interface", {})["sections"] = list(parts)
    if container.unread:
        fields["interface"] = late_interface(src, fields["interface"], container.unread)
    for text in container.rest:
        keep_text(fields, "statements", text)
    fields = _with_changes(src, container.annotations, fields, container.path, container.declared)
    for thing, name in [(fields, "body"), *((t, "condition") for t in fields.get("chart", {}).get("transitions", []))]:
        if not put_drawing(thing, name):
            message = f"the text of this {name} was changed; the drawing that it was made from is left out"
            src.note("IEC213", message, container.start, container.path, Severity.WARNING)
    if fields.get("chart") is not None:
        number(src, container.chart, fields["chart"])
    # declarations name no bodies, and are most of many units
    return {key: each if key == "interface" else _resolved(each, container.in_place) for key, each in fields.items()}


def _place_in_head(data: Fields) -> int:
    """Return the rank of what is kept of a unit: pragmas are before its words, and these before its parts."""
    kept = unwrapped(data.get("content", ""))
    return _IN_HEAD.get(kept[0], len(_IN_HEAD)) if kept is not None else len(_IN_HEAD)


_IN_HEAD = {"pragma": 0, "modifiers": 1}
_EDGES = {("layout", edge) for edge in ("margin", "before", "after")}


def _with_changes(
    src: TextSource, annotations: Annotations, fields: Fields, path: str, declared: tuple[int, int] = (0, 0)
) -> Fields:
    """Make the changes of pragmas; the edges of bodies and declarations are written apart from their text."""
    layout = TextBlock("")
    for found, offset in annotations.changes:
        if found.path[-1] == "declaration_ends" and found.path[0] == "interface":
            text = plain_lines(src.text[declared[0] : declared[1]]) + str(found.value)
            apply_change(src, fields, (RemainderEntry(("interface", "declaration"), text), offset), path)
        elif found.path in _EDGES:
            layout = layout._replace(**{str(found.path[1]): str(found.value)})
        else:
            apply_change(src, fields, (found, offset), path)
    body = fields.get("body")
    if isinstance(body, dict) and layout != TextBlock(""):
        body["text"] = layout._replace(text=body.get("text", "")).whole()
    return fields


def _resolved(value: Any, in_place: dict[str, Fields]) -> Any:
    """`value` with the bodies that it refers to by name."""
    if isinstance(value, dict):
        if isinstance(value.get("body_of"), str) and len(value) == 1:
            return in_place.get(value["body_of"].casefold(), {"language": "ST"})
        return {key: _resolved(item, in_place) for key, item in value.items()}
    return [_resolved(item, in_place) for item in value] if isinstance(value, list) else value
