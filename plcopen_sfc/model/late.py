"""Objects whose content is supplied when a script first looks at it.

A project can have thousands of blocks, charts and drawings, and most scripts look at a few. The model only knows that
content can come later and from whom; what a reader supplies, and what it remembers of that, is the reader's affair
(`plcopen_sfc.formats.provenance`). The type of an element is the same before and after: code that asks for it, such as
renaming, must not miss an element because it has not been read. See docs/decisions/0003.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import PrivateAttr, SerializerFunctionWrapHandler, model_serializer
from pydantic_core import PydanticSerializationError, to_json

from plcopen_sfc.errors import SfcError
from plcopen_sfc.model.base import Element, Model
from plcopen_sfc.model.owners import Owned, OwnedName


@dataclass(frozen=True, slots=True)
class Mention:
    """A search of texts for words, in small letters; `as_members`: for those behind a dot only."""

    words: frozenset[str]
    as_members: bool = False

    def is_in(self, text: str) -> bool:
        """True if one of the words occurs in `text`, in upper or lower case."""
        text = _folded(text)
        for start, overlines in _OVERLINES.items():  # a GRAFCET negates b1 by a line over each of its characters
            for overline in overlines if start in text else ():
                text = text.replace(overline, "")
        if not self.as_members:
            return any(word in text for word in self.words)
        return re.search(f"{_DOT}(?:{'|'.join(map(re.escape, sorted(self.words)))})", text, re.DOTALL) is not None


def _folded(text: str) -> str:
    """Return `text.casefold()`, part by part: with one letter like ``ü`` in it, the whole takes ten times as long."""
    return "".join([text[start : start + _PART].casefold() for start in range(0, len(text), _PART)])


_PART = 65_536


class Late(Owned):
    """An object that may be unread: then it has the fields that `late` got, and asks for the rest."""

    _supply: Callable[[Any], Any] | None = PrivateAttr(default=None)
    _unread_mentions: Callable[[Mention], bool] | None = PrivateAttr(default=None)
    _provenance: Any = PrivateAttr(default=None)
    """Data that its reader keeps with it. No method of the model looks at it, and equal elements may differ in it."""

    @classmethod
    def late(
        cls,
        fields: dict[str, Any],
        supply: Callable[[Self], Self],
        mentions: Callable[[Mention], bool] | None = None,
    ) -> Self:
        """Return an unread element with `fields`; `supply` gets it and returns the whole when a script asks for more.

        `mentions` returns False where no text of the whole has what is searched for.
        """
        thing: Self = _bare(cls).model_copy(update=fields)
        thing._supply = supply
        thing._unread_mentions = mentions
        return thing

    def may_mention(self, words: Collection[str], *, as_members: bool = False) -> bool:
        """False if none of `words`, in small letters, occurs in the object; `as_members`: none behind a dot.

        An unread object stays so. True where that cannot be told without reading it.
        """
        if any(_ELSEWHERE_WRITTEN.search(word) for word in words):
            return True
        try:
            return self._may_have(Mention(frozenset(words), as_members))
        except PydanticSerializationError:  # surrogates
            return True

    def _may_have(self, mention: Mention) -> bool:
        if self.is_unread:
            return self._unread_mentions is None or self._unread_mentions(mention)
        parts = {name: part for name, part in self.__dict__.items() if isinstance(part, Late)}
        if any(part._may_have(mention) for part in parts.values()):
            return True
        # the serialiser of the class makes Python objects of all before it makes JSON: that takes twelve times as long
        return mention.is_in(to_json(self.__dict__, exclude_none=True, exclude=set(parts)).decode())

    @property
    def is_unread(self) -> bool:
        """True until a script looks at more than the fields that are known from the start."""
        return self._supplier() is not None

    def _supplier(self) -> Callable[[Any], Any] | None:
        """Return who supplies the content: as the attribute it would take ten times as long."""
        private = self.__pydantic_private__
        return private["_supply"] if private else None

    def read(self) -> None:
        """Read the element if it is unread."""
        supply = self._supplier()
        if supply is None:
            return
        whole: Self = supply(self)
        self._supply = self._unread_mentions = None
        known = dict(self.__dict__)
        self.__dict__.clear()  # its order is that of the fields in JSON
        self.__dict__.update(whole.__dict__ | known)  # a script may have changed what is known
        self.__pydantic_fields_set__.update(whole.__pydantic_fields_set__)
        self.adopt()

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            # Python calls this for what is not in the instance: the fields that are unread
            if name in type(self).__pydantic_fields__ and self._supplier() is not None:
                self.read()
                return getattr(self, name)
            return super().__getattr__(name)

        def __setattr__(self, name: str, value: Any) -> None:
            if name in type(self).__pydantic_fields__ and name not in self.__dict__ and self.__pydantic_private__:
                self.read()
            super().__setattr__(name, value)

    def __eq__(self, other: object) -> bool:
        """Equal content, read or not, wherever it was read from."""
        if not isinstance(other, Late) or type(self) is not type(other):
            return False
        self.read()
        other.read()
        return self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]  # mutable, as every pydantic model

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        """A copy that is read: two that are not would share what their reader has prepared."""
        self.read()
        return super().__deepcopy__(memo)

    def __getstate__(self) -> dict[Any, Any]:
        """Return the content for a pickle, not the file that it may still be in."""
        self.read()
        return super().__getstate__()

    def __repr__(self) -> str:
        """The object as any other; one that cannot be read shows what is known of it."""
        with suppress(SfcError):
            self.read()
        return super().__repr__()

    __str__ = __repr__

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        self.read()
        content: dict[str, Any] = handler(self)
        return content


class LateElement(Late, Element):
    """An element that may be unread."""


class ProjectObject(OwnedName, LateElement):
    """Common to the objects of a project that have files of their own in some tools: POUs, data blocks, data types ..

    `folder` is where the object is among the files of its project, relative to the project's own folder, with ``/``
    between names (``Program blocks/Station 1``); empty for that folder itself, None where the project is one file.
    """

    name: str
    folder: str | None = None

    kind_in_reports: ClassVar[str] = ""
    """Word for such an object in messages and reports."""

    @property
    def report_path(self) -> str:
        """The object in the words of messages and reports: ``POU Main``, ``data block Settings``."""
        return f"{self.kind_in_reports} {self.name}"


_ELSEWHERE_WRITTEN = re.compile(r"""[^\x20-\x7e]|["'&<>\\]""")
"""Characters of names that XML or JSON may write in another way."""


_OVERLINES = {"\u0305": ("\u0305",), "\\": ("\\u0305",), "&#": ("&#773;", "&#x305;")}
"""A line over the character before it, as text, in JSON and in XML."""
_DOT = r"\.(?:\s|\\[nrt]|\\?\"|#|&quot;|&\#\w+;|\(\*.*?\*\)|/\*.*?\*/|//.*?(?:\n|\\n|&\#\w+;))*+"
"""A dot, with the blanks, quotes and comments behind it, in XML or JSON."""


@cache
def _bare(model: type[Late]) -> Any:
    """Return an object without any field, to be copied: pydantic takes long to make one."""
    thing: Any = model.model_construct()
    thing.__dict__.clear()
    thing.__pydantic_fields_set__.clear()
    return thing


def models_in(thing: Any) -> Iterator[Model]:
    """Yield an object of the model and all that is in it."""
    if isinstance(thing, Model):
        if isinstance(thing, LateElement):
            thing.read()
        yield thing
        for value in [*thing.__dict__.values()]:
            if isinstance(value, Model | list):
                yield from models_in(value)
    elif isinstance(thing, list):
        for item in thing:
            yield from models_in(item)
