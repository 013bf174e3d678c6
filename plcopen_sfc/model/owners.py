"""Links from the parts of a project to what they are in: from a step to its chart, from that to its POU, and up.

A link is set where an object is put in: by a constructor, an assignment, or a change of a list. It never contradicts
the lists: an object that was taken out has no owner, and one that two objects have is owned by the first of them.

Links keep what they lead to. With weak ones, ``sfc.load(path).pou("Main")`` is a POU whose project is gone before
anyone looks at it, and a comparison then takes its function blocks for unknown ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Self, SupportsIndex, get_args

from pydantic import BaseModel, PrivateAttr

from plcopen_sfc.errors import check_argument
from plcopen_sfc.model.base import Model
from plcopen_sfc.operations import provided

if TYPE_CHECKING:
    import plcopen_sfc as sfc  # its public names have the project, which knows this module: decision 0010
    from plcopen_sfc.report import Use


class Owned(Model):
    """An object that knows what it is in, and lets those in its fields `OWNS` know it."""

    OWNS: ClassVar[tuple[str, ...]] = ()
    """Fields with parts of the object. Their lists refuse what is none; parts that are `Owned` get to know it."""

    _owner: Owned | None = PrivateAttr(default=None)

    @property
    def owner(self) -> Owned | None:
        """The object that this one is in; None where it is in none."""
        owner: Owned | None = (self.__pydantic_private__ or {}).get("_owner")  # the attribute takes ten times as long
        return owner if owner is not None and owner._holds(self) else None

    @property
    def project(self) -> sfc.Project | None:
        """The project that the object is in, however deep."""
        owner = self.owner
        return owner.project if owner is not None else None

    def adopt(self) -> None:
        """Take over the objects in this one, whatever they were in: for an object that replaces another."""
        for name in self.OWNS:
            self._adopt_field(name, take=True)

    def _adopt_field(self, name: str, *, take: bool = False) -> None:
        value = self.__dict__.get(name)
        if isinstance(value, list):
            self.__dict__[name] = _OwnedList(self, name, value)
            for thing in value:
                _adopt(self, thing, take=take)
        elif value is not None:
            _adopt(self, value, take=take)

    def _holds(self, thing: object) -> bool:
        values = (self.__dict__.get(name) for name in self.OWNS)
        # `any` would take ten times as long: the chart of a step is asked for often
        return any(value is thing or (isinstance(value, list) and id(thing) in map(id, value)) for value in values)

    def model_post_init(self, _context: Any, /) -> None:
        """Adopt what the object was made of."""
        object.__setattr__(self, "__pydantic_private__", dict.fromkeys(self.__private_attributes__))  # all are None
        for name in self.OWNS:
            self._adopt_field(name)

    @classmethod
    def __pydantic_init_subclass__(cls, **_options: Any) -> None:
        """Let all subclasses begin alike: pydantic puts a layer around the inherited method for each of them."""
        cls.model_post_init = _begin  # type: ignore[method-assign]

    if not TYPE_CHECKING:

        def __setattr__(self, name: str, value: Any) -> None:
            super().__setattr__(name, value)
            if name in self.OWNS:
                self._adopt_field(name)

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        """A copy that is in nothing, and has copies of its own."""
        private = self.__pydantic_private__ or {}
        owner, private["_owner"] = private.get("_owner"), None
        try:
            copy = super().__deepcopy__(memo)
        finally:
            private["_owner"] = owner
        copy.adopt()
        return copy

    def __getstate__(self) -> dict[Any, Any]:
        """Return the object for a pickle, without its owner."""
        owner, self._owner = self._owner, None
        try:
            state = super().__getstate__()
            return {**state, "__pydantic_private__": dict(state["__pydantic_private__"])}
        finally:
            self._owner = owner

    def __setstate__(self, state: dict[Any, Any]) -> None:
        super().__setstate__(state)
        self.adopt()


_begin = Owned.model_post_init.__wrapped__  # type: ignore[attr-defined]


class OwnedName(Owned):
    """An object with a name that program text can use."""

    def uses(self) -> list[Use]:
        """Return every place of the project that names it, but for its declaration; see `Project.uses`."""
        project = self.project
        return project.uses(self) if project is not None else []


def _adopt(owner: Owned, thing: object, *, take: bool = False) -> None:
    private = thing.__pydantic_private__ if isinstance(thing, Owned) else None
    if private is None:
        return
    before = private["_owner"]
    if before is not owner and (take or before is None or not before._holds(thing)):
        private["_owner"] = owner  # an assignment would take ten times as long


@cache
def _classes(owner: type[Owned], field: str) -> tuple[type[BaseModel], ...]:
    """Return the classes of objects that a field has, alone or in a list."""

    def in_annotation(annotation: Any) -> tuple[type[BaseModel], ...]:
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            return (annotation,)
        return tuple(each for part in get_args(annotation) for each in in_annotation(part))

    return in_annotation(owner.model_fields[field].annotation)


class _OwnedList(list[Any]):
    """The list `field` of an owner: what is put in must be of its classes, and gets to know the owner."""

    __slots__ = ("_field", "_owner")

    def __init__(self, owner: Owned, field: str, things: Iterable[Any]) -> None:
        super().__init__(things)
        self._owner = owner
        self._field = field

    def _check(self, things: Iterable[Any]) -> None:
        owner = type(self._owner)
        wanted = _classes(owner, self._field)
        for thing in things:
            names = " or ".join(each.__name__ for each in wanted)
            check_argument(thing, wanted, f"`{self._field}` of {owner.__name__} is a list of {names}")

    def _adopt(self, things: Iterable[Any]) -> None:
        for thing in things:
            _adopt(self._owner, thing)

    def where(self, predicate: Callable[[Any], bool] | None = None, **conditions: Any) -> list[Any]:
        """Return those that satisfy all conditions: ``chart.steps.where(drives="*Valve*")``, as `SfcNetwork.find`.

        In other lists `conditions` are fields: patterns for texts (``project.pous.where(name="FB_*")``), or the value.
        """
        found: list[Any] = provided("where")(self._owner, self._field, self, predicate, conditions)
        return found

    def __contains__(self, thing: Any, /) -> bool:
        if isinstance(thing, str):
            self._check((thing,))  # a name is never in it, which looks like an answer
        return super().__contains__(thing)

    def append(self, thing: Any, /) -> None:
        self._check((thing,))
        super().append(thing)
        self._adopt((thing,))

    def extend(self, things: Iterable[Any], /) -> None:
        added = list(things)
        self._check(added)
        super().extend(added)
        self._adopt(added)

    def insert(self, index: SupportsIndex, thing: Any, /) -> None:
        self._check((thing,))
        super().insert(index, thing)
        self._adopt((thing,))

    def __setitem__(self, index: Any, value: Any, /) -> None:
        added = list(value) if isinstance(index, slice) else [value]
        self._check(added)
        super().__setitem__(index, added if isinstance(index, slice) else value)
        self._adopt(added)

    def __iadd__(self, things: Iterable[Any], /) -> Self:  # type: ignore[misc]  # list.__add__ takes lists alone
        self.extend(things)
        return self

    def __reduce__(self) -> tuple[type[list[Any]], tuple[list[Any]]]:
        """A copy or a pickle is a plain list: who gets it adopts what is in it."""
        return list, (list(self),)
