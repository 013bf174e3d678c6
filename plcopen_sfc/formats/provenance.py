"""Provenance of the objects and charts that were read, to tell later what was edited."""

from __future__ import annotations

import hashlib
import re
import secrets
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from contextvars import ContextVar
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeVar

from pydantic_core import PydanticSerializationError, to_json

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.drawing import Drawing
from plcopen_sfc.model.late import Late, Mention, ProjectObject
from plcopen_sfc.model.pou import Method, Pou
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork
from plcopen_sfc.model.variables import Interface

L = TypeVar("L", bound=Late)
P = TypeVar("P", bound=ProjectObject)


class Origin(NamedTuple):
    """The name of the body that a chart was read from, or the number of an object in its list; the file, its mark."""

    name: str | int
    content: bytes
    digest: str


def file_digest(content: bytes) -> str:
    """Return the mark that an `Origin` has of its file, in a fifth of the time of a cryptographic digest."""
    return f"{len(content)} {zlib.crc32(content):08x}"


@dataclass(frozen=True, slots=True)
class _Provenance:
    """Provenance of an object, a chart or a drawing.

    `known` are the fields that were there before it was read; `digest` is that of its content as it was read, None
    before that. `place` is the document of a folder and the place of the object in it, `folder` the one that the file
    itself has for the object. `origin` is where in a file it was read. Only copies have the same `mark`. `is_replaced`:
    the file has other sequences in the place of those of a chart.
    """

    known: tuple[str, ...] = ()
    digest: bytes | None = None
    place: tuple[str, int] | None = None
    folder: str | None = None
    origin: Origin | None = None
    mark: str = ""
    is_replaced: bool = False

    def __deepcopy__(self, memo: dict[int, Any]) -> _Provenance:
        """Copies come from where the original comes from."""
        return self


_NOWHERE = _Provenance()


def _provenance(thing: Late) -> _Provenance:
    found = (thing.__pydantic_private__ or {}).get("_provenance")  # as the attribute it would take ten times as long
    return found if isinstance(found, _Provenance) else _NOWHERE


def read_later(
    model: type[L], fields: dict[str, Any], read: Callable[[], L], mentions: Callable[[Mention], bool] | None = None
) -> L:
    """Return an object with `fields` that `read` reads when a script looks at more of it. `mentions`: `Late.late`."""
    is_compared = _COMPARED_ONLY.get()

    def supply(thing: L) -> L:
        with collecting_rarely(), compared_only() if is_compared else nullcontext():
            whole = read()
        folder = whole.folder if isinstance(whole, ProjectObject) else None
        own, replaced = None if is_compared else _own_digest(whole), _provenance(whole).is_replaced
        thing._provenance = replace(_provenance(thing), digest=own, folder=folder, is_replaced=replaced)
        return whole

    thing = model.late(fields, supply, mentions)
    thing._provenance = _Provenance(tuple(fields), mark=secrets.token_hex(8))
    return thing


_COMPARED_ONLY: ContextVar[bool] = ContextVar("compared_only", default=False)


@contextmanager
def compared_only() -> Iterator[None]:
    """Read projects that are compared and then forgotten: without the digests that tell edits, late parts too."""
    token = _COMPARED_ONLY.set(True)
    try:
        yield
    finally:
        _COMPARED_ONLY.reset(token)


_KNOWN: ContextVar[dict[int, tuple[Late, bool]] | None] = ContextVar("untouched", default=None)
"""Objects known to be untouched or not while nothing edits them, by `id()`, with the object, which keeps its id."""


@contextmanager
def without_edits() -> Iterator[None]:
    """Ask each object once if it is untouched, as long as this is open: nothing is edited inside."""
    token = _KNOWN.set({} if (known := _KNOWN.get()) is None else known)
    try:
        yield
    finally:
        _KNOWN.reset(token)


def is_untouched(thing: ProjectObject | Interface | SfcNetwork | Drawing) -> bool:
    """True if the content is as it was read. False for what was not read, such as objects made by scripts."""
    if thing.is_unread:
        return True
    known = _KNOWN.get()
    if known is not None and id(thing) in known:
        return known[id(thing)][1]
    found = is_as_read(thing)
    if known is not None:
        known[id(thing)] = (thing, found)
    return found


def is_as_read(thing: ProjectObject | Interface | SfcNetwork | Drawing) -> bool:
    """True if the content of an object that was read is still the same, whatever `without_edits` knows of it."""
    digest = _provenance(thing).digest
    return digest is not None and digest == _own_digest(thing)


def is_edited(thing: ProjectObject) -> bool:
    """True if the content is another than was read. False for what was not read, such as objects made by scripts."""
    return _provenance(thing).digest is not None and not is_untouched(thing)


def content_digest(thing: ProjectObject) -> bytes:
    """Return a digest of the content of an object: the same for an unread one and the same one read and not edited."""
    if not is_untouched(thing):
        return _own_digest(thing)
    found = _provenance(thing)
    if found.digest is not None and not found.known:
        return found.digest  # it was read at once
    known = {name: thing.__dict__[name] for name in found.known}
    file = found.origin.digest if found.origin is not None else ""
    return hashlib.blake2b(repr(("untouched", known, file)).encode()).digest()


def may_have_controls(thing: ProjectObject) -> bool:
    """True if texts of an object may have control characters or surrogates; untouched charts of files are left out."""
    things: list[Late] = [thing, *(thing.interfaces() if isinstance(thing, Pou) else ())]
    try:
        return any(_CONTROL.search(_content(each)[0]) is not None for each in things)
    except PydanticSerializationError:
        return True  # a surrogate, which UTF-8 does not have


_CONTROL = re.compile(rb"\\(?:u00|b|f)|\xef\xbf[\xbe\xbf]")


def texts_of(thing: Model, exclude: set[str] | None = None) -> Iterator[str]:
    """Yield all texts of an object, but for some of its fields, in their order."""
    pending: list[Any] = [thing.__pydantic_serializer__.to_python(thing, exclude_none=True, exclude=exclude)]
    while pending:
        content = pending.pop()
        if isinstance(content, str):
            yield content
        elif isinstance(content, dict):
            pending += reversed(content.values())
        elif isinstance(content, list | tuple):
            pending += reversed(content)


def _own_digest(thing: Late) -> bytes:
    """Return a digest of the fields of an object; untouched charts, drawings and interfaces count by their source."""
    try:
        content, names = _content(thing)
    except PydanticSerializationError:
        content, names = b"surrogates", []  # no file has them: the object is another than it was
    digest = hashlib.blake2b(content)
    digest.update("\0".join(names).encode())
    return digest.digest()


def _content(thing: Late) -> tuple[bytes, list[str]]:
    """Return the fields of an object as JSON without untouched charts, interfaces and drawings, and their sources."""
    exclude: dict[str, Any] = {}
    names: list[str] = []
    charts: list[bytes] = []
    thing.read()
    if isinstance(thing, Pou):
        for path, name, body in _charts_in(thing):
            if is_untouched(body.chart):
                origin = _provenance(body.chart).origin
                names.append(f"{origin.name} {origin.digest}" if origin is not None else name)
            else:
                content, inside = _content(body.chart)
                charts.append(content)
                names += inside
            field, index, *rest = path
            below: dict[Any, Any] = exclude.setdefault(str(field), {})
            below[index] = {"body": {"chart"}} if rest else {"chart"}
        parts: list[Pou | Method] = [thing, *thing.methods]
        for index, interface in enumerate((part.interface for part in parts), -1):
            mark = _provenance(interface).mark if interface is not None else ""
            if interface is not None and mark and is_untouched(interface):
                names.append(mark)
                holder = exclude if index < 0 else exclude.setdefault("methods", {}).setdefault(index, {})
                holder["interface"] = True
    elif isinstance(thing, SfcNetwork) and thing.drawing is not None:
        mark = _provenance(thing.drawing).mark
        if mark and is_untouched(thing.drawing):
            names.append(mark)
            exclude["drawing"] = True
    # their own serialiser reads objects first: with it all would become Python objects before it becomes JSON
    own = to_json(thing.__dict__, exclude_none=True, exclude=exclude or None)
    return b"\0".join([own, *charts]), names


def _charts_in(pou: Pou) -> Iterator[tuple[tuple[str | int, ...], str, SfcBody]]:
    """Yield the SFC bodies of a POU, each with its path in the fields, and its name."""
    for index, body in enumerate(pou.bodies):
        if isinstance(body, SfcBody):
            yield ("bodies", index), pou.name, body
    for field in ("actions", "transitions", "methods"):
        for index, part in enumerate(getattr(pou, field)):
            if isinstance(part.body, SfcBody):
                yield (field, index, "body"), f"{pou.name}.{part.name}", part.body


def remember_body(body: SfcBody, origin: Origin) -> None:
    """Remember where the chart of a body was read."""
    body.chart._provenance = replace(_provenance(body.chart), origin=origin)


def remember_replaced(chart: SfcNetwork) -> None:
    """Remember that the file of a chart has other sequences in the place of its own, as `added_element` marks them."""
    chart._provenance = replace(_provenance(chart), is_replaced=True)


def is_replaced(chart: SfcNetwork) -> bool:
    """True if the file that a chart was read from has other sequences in its place."""
    chart.read()
    return _provenance(chart).is_replaced


def remember_object(thing: ProjectObject, origin: Origin) -> None:
    """Remember where an object was read; the charts in it are remembered before."""
    thing._provenance = replace(_provenance(thing), origin=origin)
    if not thing.is_unread:
        thing._provenance = replace(_provenance(thing), digest=_own_digest(thing))
        known = _KNOWN.get()
        if known is not None:
            known[id(thing)] = (thing, True)


def is_from(thing: ProjectObject | SfcNetwork, name: str | int, content: bytes) -> bool:
    """True if a chart or an object was read as `name` from this very `content` and is untouched."""
    origin = _provenance(thing).origin
    return origin is not None and origin.name == name and origin.content is content and is_untouched(thing)


def is_of_file(thing: ProjectObject | SfcNetwork, content: bytes, name: str | int | None = None) -> bool:
    """True if a chart or an object was read from this very `content`, as `name`, whatever was edited since."""
    origin = _provenance(thing).origin
    return origin is not None and origin.content is content and name in (None, origin.name)


def put_in_folder(thing: ProjectObject, document: str, place: int, folder: str | None) -> None:
    """Remember that an object was read from a document of a folder: its `place` in it, and the `folder` around it.

    None for the folder leaves that of the object.
    """
    thing._provenance = replace(_provenance(thing), place=(document, place))
    if folder is not None:
        thing.__dict__["folder"] = folder  # an assignment would read the object


def place_in_folder(thing: ProjectObject) -> tuple[str, int] | None:
    """Return the document of a folder that an object was read from, and its place in it."""
    return _provenance(thing).place


def as_in_file(thing: P) -> P:
    """Return a copy without what follows from the place of its document in the folder."""
    copy = thing.model_copy()
    if thing.is_unread and "folder" not in _provenance(thing).known:
        copy.__dict__.pop("folder", None)
    else:
        copy.__dict__["folder"] = _provenance(thing).folder
    return copy


def take_provenance(thing: ProjectObject, saved: ProjectObject) -> None:
    """The object was saved, and `saved` is what was read of its file: from here on, edits count from this."""
    found = _provenance(saved)
    thing.__dict__["folder"] = saved.folder
    thing._provenance = replace(_provenance(thing), known=found.known, place=found.place, origin=found.origin)
    if not thing.is_unread:
        thing._provenance = replace(_provenance(thing), digest=_own_digest(as_in_file(thing)))
