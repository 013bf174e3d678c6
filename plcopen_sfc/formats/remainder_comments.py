"""Comments of this package in text formats: what the text cannot express, and its way back into the model.

The reader takes all of the text first; then each comment puts a value where it belongs, as long as the text has there
what it had when the comment was written.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from typing import Any, TypeAlias

from pydantic import ValidationError

from plcopen_sfc.languages.pragmas import (
    Append,
    Fields,
    Named,
    NotationError,
    PathError,
    RemainderEntry,
    Segment,
    StaleError,
    apply,
    changes,
    format_value,
    parse_change,
    plain_fields,
    value_at,
)
from plcopen_sfc.languages.st.lexer import Comment
from plcopen_sfc.model.checked import first_misfit
from plcopen_sfc.model.compare import path_of
from plcopen_sfc.model.numbering import take_ids
from plcopen_sfc.model.project import Project

DAMAGED = "damaged"
OUTDATED = "outdated"
Note: TypeAlias = Callable[[str, str, int], None]
"""Takes a finding: `DAMAGED` or `OUTDATED`, what is wrong, and the offset of the comment."""
Entry: TypeAlias = tuple[RemainderEntry, Comment]


def read_entries(comments: Iterable[Comment], pattern: re.Pattern[str], note: Note) -> list[Entry]:
    """Return the content of the `comments` of this package, which are those that match `pattern`."""
    entries = []
    for comment in comments:
        found = pattern.match(comment.text)
        if found is None:
            continue
        try:
            entries.append((parse_change(found[1].strip()[1:-1].strip().removeprefix("plcopen_sfc")), comment))
        except NotationError as error:
            note(DAMAGED, f"this comment of plcopen_sfc is damaged: {error}", comment.span[0])
    return entries


def put_back(project: Project, entries: Sequence[Entry], note: Note) -> Project:
    """Return `project`, which was read from the text, with what the comments state."""
    fields, text = plain_fields(project), plain_fields(project)
    # without a start value, a variable of the kept type would start with that of the type
    outdated = {(*c.path[:-1], "type") for c, _ in entries if _is_taken_out(text, c)}
    made: set[tuple[Segment, ...]] = set()
    bodies = {entry.path: entry.instead for entry, _ in reversed(entries) if entry.path[-1] == "text"}
    for change, comment in entries:
        if _is_in(change.path, outdated):
            continue
        try:
            if not _is_in(change.path, made):
                _check_text(text, change, bodies.get((*change.path[:-1], "text"), ""))
            apply(fields, change)
            made.add(change.path)
        except StaleError as error:
            *around, last = change.path
            if last in ("kind", "language"):
                outdated.add(tuple(around))
            elif last == "type":  # a start value is one of the type
                outdated.add((*around, "initial"))
            elif around == ["pous"] and isinstance(change.instead, dict) and change.instead.get("kind") == "program":
                # it was added in place of the tasks
                outdated |= {("configurations",), ("origin",)}
            message = f"this comment of plcopen_sfc is for another text and left out: {error}"
            note(OUTDATED, message, comment.span[0])
        except PathError as error:
            note(DAMAGED, f"this comment of plcopen_sfc does not fit: {error}", comment.span[0])
    try:
        return Project.model_validate(fields)
    except ValidationError as error:
        message = f"the comments of plcopen_sfc are left out: {first_misfit(error)}"
        note(DAMAGED, message, entries[0][1].span[0])
        return project


def lacking(back: Project, meant: Project) -> Iterator[tuple[RemainderEntry, str]]:
    """Yield the content of `meant` that a file lacks of which `back` was read, and the path of what that belongs to.

    No list of what a format lacks could be as complete. Ids in charts are those of `back`.
    """
    meant = meant.model_copy(deep=True)
    take_ids(meant, back)
    labels: dict[int, dict[int, str]] = {}
    for change in changes(plain_fields(back), plain_fields(meant), guarded=True):
        yield change, path_of(meant, keys_of(meant, change), labels)


def keys_of(project: Project, change: RemainderEntry) -> Iterator[str | int]:
    """Yield the fields and indices that lead to what `change` is about, for `model.compare.path_of`."""
    thing: Any = project
    for segment in change.path:
        if isinstance(segment, str):
            thing = thing.get(segment) if isinstance(thing, dict) else getattr(thing, segment, None)
            yield segment
            continue
        name = segment.name if isinstance(segment, Named) else None
        if isinstance(segment, Append) and isinstance(change.value, dict):
            name = change.value.get("name")
        named = (index for index, item in enumerate(thing) if name is not None and getattr(item, "name", None) == name)
        index = segment if isinstance(segment, int) else next(named, None)
        if index is None or index >= len(thing):  # what is taken out is not there any more
            return
        thing = thing[index]
        yield index


def _is_in(path: tuple[Segment, ...], places: Container[tuple[Segment, ...]]) -> bool:
    return any(path[:length] in places for length in range(len(path) + 1))


def _is_taken_out(text: Fields, change: RemainderEntry) -> bool:
    return change.path[-1] == "initial" and change.instead is not None and value_at(text, change.path) is None


def _check_text(text: Fields, change: RemainderEntry, written: Any) -> None:
    """Raise `StaleError` if `text` itself has by now what it left to a comment when that was written.

    `written` are the statements that were in the text then.
    """
    *around, last = change.path
    holder = value_at(text, tuple(around))
    if not isinstance(holder, dict):
        return
    if last == "language" and str(holder.get("text", "")).strip() not in ("", str(written).strip()):
        raise StaleError("the block has statements now")
    present = holder.get(last) if isinstance(last, str) else None
    if change.instead is None and present is not None and present != change.value:
        raise StaleError(f"the text has {format_value(present)} now")
