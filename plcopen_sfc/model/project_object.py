"""The objects of a project that have files of their own in some tools: POUs, data blocks, data types, tag tables."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import PrivateAttr, SerializationInfo, SerializerFunctionWrapHandler, model_serializer

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.model.base import FINGERPRINT, OWN_FINGERPRINT, Element


class ProjectObject(Element):
    """Common to the objects of a project.

    `folder` is where the object stands among the files of its project, relative to the project's own folder, with ``/``
    between names (``Program blocks/Station 1``); empty for that folder itself, None where the project is one file.

    A reader may leave an object unread but for its name until somebody looks at it (`deferred`): scripts mostly look at
    a few blocks of a project. An unread object cannot have been edited but in the fields that it has, which makes
    saving quick too.
    """

    name: str
    folder: str | None = None

    kind_in_reports: ClassVar[str] = ""
    """What messages and reports call such an object."""

    _home: tuple[str, int] | None = PrivateAttr(default=None)
    """The document of the folder that the object was read from, and its place in it. Belongs to `formats.folders`."""
    _own_folder: str | None = PrivateAttr(default=None)
    """The folder that the file itself names; it mostly leaves that to its own place."""
    _early: tuple[str, ...] = PrivateAttr(default=())
    """The fields that were there before the object was read."""
    _unread: Callable[[], Self] | None = PrivateAttr(default=None)
    _digest: bytes | None = PrivateAttr(default=None)

    @classmethod
    def deferred(cls, fields: dict[str, Any], read: Callable[[], Self]) -> Self:
        """An object with `fields`; `read` gives the whole object when somebody asks for more of it."""
        thing: Self = _bare(cls).model_copy(update=fields)
        thing._early = tuple(fields)
        thing._unread = read
        return thing

    @property
    def report_path(self) -> str:
        """The object in the words of messages and reports: ``POU Main``, ``data block Settings``."""
        return f"{self.kind_in_reports} {self.name}"

    @property
    def is_unread(self) -> bool:
        """Whether nobody has looked at the object yet, but for its name."""
        return self._unread is not None

    def read(self) -> None:
        """Read the object now if it was not yet."""
        unread = self._unread
        if unread is None:
            return
        with collector_paused():
            whole = unread()
            self._unread = None
            self._digest = _digest(whole)
            self._own_folder = whole.folder
            present = dict(self.__dict__)
            self.__dict__.clear()  # its order is that of the fields in JSON
            self.__dict__.update(whole.__dict__ | present)
            self.__pydantic_fields_set__.update(whole.__pydantic_fields_set__)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            # Python calls this for what is not in the instance: the fields that are unread
            if name in type(self).__pydantic_fields__ and self.__pydantic_private__ and self._unread is not None:
                self.read()
                return getattr(self, name)
            return super().__getattr__(name)

        def __setattr__(self, name: str, value: Any) -> None:
            if name in type(self).__pydantic_fields__ and name not in self.__dict__ and self.__pydantic_private__:
                self.read()
            super().__setattr__(name, value)

    def __eq__(self, other: object) -> bool:
        """Equal content, read or not; where the objects were read from does not matter."""
        if not isinstance(other, ProjectObject) or type(self) is not type(other):
            return False
        self.read()
        other.read()
        return self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]  # mutable, as every pydantic model

    def __getstate__(self) -> dict[Any, Any]:
        """What is pickled: the object, not the file it may still stand in."""
        self.read()
        return super().__getstate__()

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler, info: SerializationInfo) -> dict[str, Any]:
        if info.context == FINGERPRINT and self._is_untouched():
            return {"untouched": {name: self.__dict__[name] for name in self._early}}
        self.read()
        content: dict[str, Any] = handler(self)
        return content

    def settle(self, home: tuple[str, int], folder: str) -> None:
        """The object was read as `home`, from a document in `folder`."""
        self._home = home
        self.__dict__["folder"] = folder  # an assignment would read the object

    def as_in_file(self) -> Self:
        """A copy without what the place of its document says of it."""
        copy = self.model_copy()
        if self._unread is not None and "folder" not in self._early:
            copy.__dict__.pop("folder", None)
        else:
            copy.__dict__["folder"] = self._own_folder
        return copy

    def settle_as(self, saved: ProjectObject) -> None:
        """The object was saved, and `saved` is what was read of its file: from here on, edits count from this."""
        self._home = saved._home
        self._early = saved._early
        self.__dict__["folder"] = saved.folder
        if self._unread is None:
            self._digest = _digest(self.as_in_file())

    def _is_untouched(self) -> bool:
        """Whether the object is as it was read, but perhaps for the fields that are read at once."""
        return self._unread is not None or (self._digest is not None and self._digest == _digest(self))


@cache
def _bare(model: type[ProjectObject]) -> Any:
    """An object without any field, to be copied: pydantic takes long to make one."""
    thing: Any = model.model_construct(name="")
    thing.__dict__.clear()
    thing.__pydantic_fields_set__.clear()
    return thing


def _digest(thing: ProjectObject) -> bytes:
    content = thing.__pydantic_serializer__.to_json(thing, exclude_none=True, context=OWN_FINGERPRINT)
    return hashlib.blake2b(content).digest()
