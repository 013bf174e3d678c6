"""Finds the pieces that `project_writer` writes in the text of a file, so that an edit changes only its place."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from plcopen_sfc.formats.iectext.outline import POUS, Kind, Part
from plcopen_sfc.formats.iectext.source import Source, is_own
from plcopen_sfc.formats.text import Key, Piece, Slice, numbered
from plcopen_sfc.languages.pragmas import NotationError, parse_change
from plcopen_sfc.languages.st.lexer import Comment
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.pou import Action, Method, NamedTransition, Pou
from plcopen_sfc.model.project import Project

Found: TypeAlias = tuple[tuple[Key, ...], tuple[int, int], "Part | None"]
"""The keys of a piece, where it stands, and the container it is, if its inside is looked into."""


def file_slices(project: Project, src: Source, before: Piece) -> Slice:
    """Where the pieces of `before`, which says what `project` holds, stand in the text that it was read from."""
    found = list(_units(src))
    pous = iter(project.pous)
    inside = {id(part): next(pous) for _, _, part in found if part is not None}
    return _matched(src, ("project", ""), (0, len(src.text)), found, before, inside=inside)


def _units(src: Source) -> Iterator[Found]:
    position = _project_pragmas(src)
    yield (("head", ""),), (0, position), None
    for part in src.outline.parts:
        start = _above(src, position, part.start)
        span = (start, part.end)
        position = part.end
        if part.kind in POUS:
            yield ((part.kind.lower(), part.name),), span, part
        elif part.kind is Kind.TYPE:
            tokens = src.outline.tokens(part.tokens)
            yield (("type", tokens[0].value if tokens else ""),), span, None
        elif part.kind is Kind.VAR:
            yield (("global variables", ""),), span, None
        elif part.kind is Kind.CONFIGURATION:
            yield (("configuration", part.name),), span, None
    start, end = _own_run(src, position, len(src.text))
    yield (("late", ""),), (start, end), None


def _project_pragmas(src: Source) -> int:
    """Where the pragmas at the start of the file end that speak of the project."""
    end = 0
    limit = src.outline.parts[0].start if src.outline.parts else len(src.text)
    for comment in src.outline.comments(0, limit):
        if not is_own(comment) or _first_word(comment) not in ("project", "format"):
            break
        end = comment.span[1]
    return end


def _first_word(comment: Comment) -> str:
    try:
        change = parse_change(comment.text[:-1], comment.text.index("plcopen_sfc") + len("plcopen_sfc"))
    except NotationError:
        return ""
    return str(change.path[0])


def _above(src: Source, position: int, start: int) -> int:
    """Where the comments and pragmas begin that belong to the part at `start`."""
    first = next((c.span[0] for c in src.outline.comments(position, start)), start)
    return first if not src.text[position:first].strip() else src.attached(position, start)


def _own_run(src: Source, start: int, end: int) -> tuple[int, int]:
    """The pragmas of ours at the end of a place, without the blanks around them."""
    begin = src.core(start, end)[1]
    own = [c.span for c in src.outline.comments(begin, end) if is_own(c)]
    return (own[0][0], own[-1][1]) if own else (begin, begin)


# -- inside units -----------------------------------------------------------------------------------------------------


def _parts(src: Source, part: Part, start: int, thing: Pou | Action | Method | NamedTransition) -> Iterator[Found]:
    """The pieces of a POU, an action or a method."""
    bodies = thing.bodies if isinstance(thing, Pou) else [thing.body]
    chart = next((body.chart for body in bodies if isinstance(body, SfcBody)), None)
    steps = iter(chart.steps if chart is not None else ())
    transitions = iter(chart.transitions if chart is not None else ())
    typed = getattr(getattr(thing, "interface", None), "declaration", None) is not None
    position = part.inside[0]
    sections = [inner for inner in part.parts if inner.kind is Kind.VAR]
    if typed and sections:
        position = sections[-1].end
    yield (("head", ""),), (start, position), None
    last: list[Found] = []
    for inner in part.parts:
        if inner.end <= position:
            continue
        above = _above(src, position, inner.start) if inner.kind is not Kind.LOOSE else inner.start
        position = inner.end
        kind = inner.kind
        if kind is Kind.ACTION and last and _is_in_place(src, above, inner):
            keys, span, _ = last.pop()
            last.append((keys, (span[0], inner.end), None))
            continue
        yield from last
        last = []
        key: Key | None = None
        if kind is Kind.STEP:
            step = next(steps, None)
            key = ("step", str(step.id)) if step is not None else None
        elif kind is Kind.TRANSITION and _leads(src, inner):
            transition = next(transitions, None)
            key = ("transition", str(transition.id)) if transition is not None else None
        elif kind is Kind.TRANSITION:
            name = next((t.value for t in src.outline.tokens(inner.tokens)), "")
            key = ("transition", name)
        elif kind is Kind.VAR:
            key = ("section", "")
        elif kind is Kind.LOOSE:
            key = ("body", "")
        elif kind in (Kind.ACTION, Kind.METHOD):
            key = (kind.lower(), inner.name)
        if key is not None:
            container = inner if kind in (Kind.ACTION, Kind.METHOD) else None
            last = [((key,), (above, inner.end), container)]
            if kind is not Kind.STEP and key[0] != "transition":
                yield from last
                last = []
    yield from last
    late = _own_run(src, position, part.inside[1])
    yield (("late", ""),), late, None
    yield (("end", ""),), (part.inside[1], part.end), None


def _leads(src: Source, part: Part) -> bool:
    return any(token.value.upper() in ("FROM", "TO") for token in src.outline.tokens(part.tokens))


def _is_in_place(src: Source, start: int, part: Part) -> bool:
    return any(is_own(c) and _first_word(c) == "in_place" for c in src.outline.comments(start, part.start))


def _matched(
    src: Source,
    key: Key,
    span: tuple[int, int],
    found: list[Found],
    before: Piece,
    *,
    inside: dict[int, Pou],
) -> Slice:
    """A slice for each piece of `before`: where it was found, or an empty one behind that of the piece before it."""
    keys = numbered([keys[0] for keys, _, _ in found if keys])
    places = dict(zip(keys, [(place, part) for keys_, place, part in found if keys_], strict=True))
    slices: list[Slice] = []
    position = span[0]
    for piece in before.pieces:
        if piece.key not in places:
            slices.append(Slice((piece.key,), (position, position)))
            continue
        place, part = places[piece.key]
        position = place[1]
        thing = inside.get(id(part)) if part is not None else None
        if part is not None and thing is not None:
            slices.append(_container(src, piece, place, part, thing))
        else:
            slices.append(Slice((piece.key,), place))
    return Slice((key,), span, tuple(sorted(slices, key=lambda one: one.span)))


def _container(
    src: Source, piece: Piece, place: tuple[int, int], part: Part, thing: Pou | Action | Method | NamedTransition
) -> Slice:
    found = list(_parts(src, part, place[0], thing))
    actions = iter(getattr(thing, "actions", ()))
    methods = iter(getattr(thing, "methods", ()))
    slices = _matched(src, piece.key, place, found, piece, inside={})
    inner: list[Slice] = []
    parts = {keys[0]: one for keys, _, one in found if keys and one is not None}
    by_key = {p.key: p for p in piece.pieces}
    for one in slices.slices:
        child = parts.get(one.keys[0])
        if child is None:
            inner.append(one)
            continue
        owner = next(actions if child.kind is Kind.ACTION else methods, None)
        inner.append(one if owner is None else _container(src, by_key[one.keys[0]], one.span, child, owner))
    return Slice(slices.keys, slices.span, tuple(inner))
