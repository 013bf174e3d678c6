"""Objects that check their fields, name in words what is wrong, and show themselves in one line."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from plcopen_sfc.errors import ArgumentError, ModelError, nearest, shown
from plcopen_sfc.grouping import grouped
from plcopen_sfc.model import times

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)  # pydantic has no public name for it

M = TypeVar("M", bound=BaseModel)


def deep_copy(thing: M, memo: dict[int, Any]) -> M:
    """Return a deep copy; `memo` as for `copy.deepcopy`. It is what pydantic does in a third of the time."""
    kind = type(thing)
    made = kind.__new__(kind)
    memo[id(thing)] = made
    _put(made, "__pydantic_private__", None)  # what is copied meanwhile may look at it: extension data lead to charts
    _put(made, "__dict__", _copies_in(thing.__dict__, memo))
    _put(made, "__pydantic_extra__", None)
    _put(made, "__pydantic_fields_set__", {*thing.__pydantic_fields_set__})
    private = thing.__pydantic_private__
    _put(made, "__pydantic_private__", private and _copies_in(private, memo))
    return made


def unchecked(kind: type[M], /, **fields: Any) -> M:
    """Return an object of values that are known to be right. Checks would take five times as long.

    Fields that hold lists must be given: those of one object are not those of another. All fields count as set.
    """
    defaults, names = _fields_of(kind)
    made = kind.__new__(kind)
    _put_dict(made, defaults | fields)
    _put_extra(made, None)
    _put_fields_set(made, names)
    _put_private(made, None)
    return made


@cache
def _fields_of(kind: type[BaseModel]) -> tuple[dict[str, Any], set[str]]:
    """Return the defaults of fields in their order, None for those without one, and the names of all fields.

    There is one set of names for all objects: sets of their own would be a third of all that a drawing is made of.
    """
    fields = kind.model_fields.items()
    return {name: field.get_default() if not field.is_required() else None for name, field in fields}, {
        *kind.model_fields
    }


_put = object.__setattr__
# a drawing has a hundred thousand objects, and looking for each of these by its name took a third of making one
_put_dict, _put_extra, _put_fields_set, _put_private = (
    vars(BaseModel)[name].__set__
    for name in ("__dict__", "__pydantic_extra__", "__pydantic_fields_set__", "__pydantic_private__")
)
_ATOMS: set[type] = {type(None), str, int, float, bool, bytes}
"""Types whose values are shared by copies; those of enumerations are added when they are met."""


def _copies_in(table: dict[Any, Any], memo: dict[int, Any]) -> dict[Any, Any]:
    # nine of ten values are atoms: a call for each of them would take twice as long
    return {key: value if type(value) in _ATOMS else _copy_of(value, memo) for key, value in table.items()}


def _copy_of(value: Any, memo: dict[int, Any]) -> Any:
    """Return a deep copy of the value of a field."""
    kind = type(value)
    if id(value) in memo:
        return memo[id(value)]
    if isinstance(value, BaseModel):
        return value.__deepcopy__(memo)
    if isinstance(value, list):  # the list of an owner too: who gets the copy adopts what is in it
        things: list[Any] = []
        memo[id(value)] = things
        things += [each if type(each) in _ATOMS else _copy_of(each, memo) for each in value]
        return things
    if kind is dict:
        table: dict[Any, Any] = {}
        memo[id(value)] = table
        table.update(_copies_in(value, memo))
        return table
    if isinstance(value, Enum):
        _ATOMS.add(kind)
        return value
    if isinstance(value, tuple) and all(type(each) in _ATOMS for each in value):
        return value  # a position
    return copy.deepcopy(value, memo)


class _Constructor(ModelMetaclass):
    """Lets constructors raise errors of this package: pydantic makes its own of all that a validator raises."""

    if not TYPE_CHECKING:

        def __call__(cls, *values: Any, **fields: Any) -> Any:  # noqa: N805  # the object is a class
            if values:
                wanted = ", ".join(f"{name}=.." for name, field in cls.model_fields.items() if field.is_required())
                raise ArgumentError(f"{cls.__name__} takes fields by their names: {cls.__name__}({wanted})")
            try:
                # what BaseModel.__init__ does, in two thirds of the time: files and drawings have many small objects
                made = cls.__new__(cls)
                cls.__pydantic_validator__.validate_python(fields, self_instance=made)
                return made
            except ValidationError as error:
                raise misfit(cls, cls.__name__, error) from None


class Checked(BaseModel, metaclass=_Constructor):
    """An object that can be changed; its fields are checked in the constructor and on every assignment."""

    model_config = ConfigDict(validate_assignment=True, extra="forbid", defer_build=True)

    TIMES: ClassVar[tuple[str, ...]] = ()
    """Fields that hold durations or expressions. Files may hold other text there; nothing else can be assigned."""

    INTERVALS: ClassVar[tuple[str, ...]] = ()
    """Fields like `TIMES` that also hold durations in the forms of files."""

    if not TYPE_CHECKING:

        def __setattr__(self, name: str, value: Any) -> None:
            why = ""
            if name in self.TIMES and isinstance(value, str):
                why = times.objection(value)
            elif name in self.INTERVALS and isinstance(value, str):
                why = times.interval_objection(value)
            if why:
                raise ModelError(f"{name} of {_called(self)} cannot be {value!r}: {why}")
            try:
                super().__setattr__(name, value)
            except ValidationError as error:
                raise misfit(type(self), _called(self), error) from None
            except AttributeError:
                found = getattr(type(self), name, None)
                if not isinstance(found, property):
                    raise
                message = f"{name} of {_called(self)} cannot be assigned: it follows from the fields"
                raise ModelError(message, hint=(found.__doc__ or "").partition("\n")[0]) from None

    def __eq__(self, other: object) -> bool:
        """Equal content, wherever the objects are; pydantic asks for more, and takes twice the time."""
        return type(self) is type(other) and self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]  # mutable, as every pydantic model

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy; fields in `update` get those values, and their own are not copied."""
        if deep and update:  # pydantic would copy private attributes too: the owner, and so the whole project
            return super().model_copy(update=update).model_copy(deep=True)
        return super().model_copy(update=update, deep=deep)

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        """Return a deep copy."""
        return deep_copy(self, {} if memo is None else memo)

    def __repr__(self) -> str:
        """The class and what differs from the defaults: texts cut off, of lists the number of items."""
        text = ", ".join(f"{name}={_short(value)}" for name, value in _stated(self))
        return f"{type(self).__name__}({_cut(text, _LINE)})"

    __str__ = __repr__


_LINE = 160
_TEXT = 40
_SHOWN = 8
_FIRST = ("name", "id", "kind", "text", "type")


def _stated(thing: Checked) -> Iterator[tuple[str, Any]]:
    """Yield the fields that were read already and differ from their defaults; names and ids come first."""
    fields = type(thing).model_fields
    present = thing.__dict__
    for name in sorted(fields, key=lambda name: _FIRST.index(name) if name in _FIRST else len(_FIRST)):
        value = present.get(name)
        if name in present and value not in (None, "", [], {}) and value is not fields[name].default:
            yield name, value


def _short(value: Any) -> str:
    match value:
        case Enum():
            return str(value.value)
        case str():
            return repr(_cut(value, _TEXT))
        case list() if all(isinstance(each, int) for each in value[:_SHOWN]) and len(value) <= _SHOWN:
            return repr(value)
        case Mapping() | Sequence():
            return f"[{len(value)} item{'' if len(value) == 1 else 's'}]"
        case Checked():
            inner = repr(value)
            return inner if len(inner) <= _TEXT * 2 else f"{type(value).__name__}(..)"
        case _:
            return repr(value)


def _cut(text: str, length: int) -> str:
    return text if len(text) <= length else f"{text[:length]}.."


def _called(thing: Checked) -> str:
    name = thing.__dict__.get("name")
    return f"{type(thing).__name__} {name!r}" if isinstance(name, str) and name else type(thing).__name__


def misfit(model: type[BaseModel], owner: str, error: ValidationError) -> ModelError:
    """Return the error of this package for what does not fit in the fields of `owner`."""
    fields = grouped((each["loc"][: _choice(each["loc"])], each) for each in error.errors(include_url=False))
    told = [each for loc, errors in fields.items() for each in _of_choices(model, owner, loc, errors)]
    more = f"; and {len(told) - _NAMED} more" if len(told) > _NAMED else ""
    return ModelError("; ".join(told[:_NAMED]) + more)


def _choice(loc: Sequence[int | str]) -> int | None:
    """Return where a place names one of several classes that a field may have, of which pydantic tries each."""
    return next((i for i, part in enumerate(loc) if i and isinstance(part, str) and _CHOICE.match(part)), None)


def _of_choices(
    model: type[BaseModel], owner: str, loc: Sequence[int | str], errors: Sequence[Mapping[str, Any]]
) -> Iterator[str]:
    """Yield the faults of a field by the errors of its classes: of the one that was meant, else that it is none."""
    tried = dict.fromkeys(str(each["loc"][len(loc)]) for each in errors if len(each["loc"]) > len(loc))
    # the language of a body tells which class was meant
    inside = [each for each in errors if len(each["loc"]) > len(loc) + 2 and "[" in str(each["loc"][len(loc)])]
    if len(tried) > 1 and not inside:
        names = ", ".join(
            _PLAIN.get(each, each.removeprefix("tagged-union[").rstrip("]").replace(",", ", ")) for each in tried
        )
        given = next((each["input"] for each in errors if len(each["loc"]) == len(loc) + 1), None)
        told = f"{shown(given, _TEXT)} ({type(given).__name__})"
        yield f"{'.'.join(map(str, loc))} of {owner} is none of {names}: {told}"
        return
    for each in inside or errors:
        place = [part for part in each["loc"] if "[" not in str(part)]
        yield _problem(model, owner, each["type"], place, each)


_NAMED = 3

_CHOICE = re.compile(r"(?:str|int|float|bool|[A-Z]\w*|tagged-union\[.*\])$")
_PLAIN = {"str": "a text", "int": "a whole number", "float": "a number", "bool": "True or False"}

_WANTED = {
    "string_type": "a text",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "float_parsing": "a number",
    "bool_type": "True or False",
    "bool_parsing": "True or False",
    "list_type": "a list",
    "dict_type": "a mapping",
    "tuple_type": "a list of values",
    "string_unicode": "a text without half characters",
    "finite_number": "a finite number",
    "int_parsing_size": "a whole number of at most 4,300 digits",
}
"""Needs of a field in words, by the type of pydantic's error."""


def _problem(model: type[BaseModel], owner: str, kind: str, loc: Sequence[int | str], error: Mapping[str, Any]) -> str:
    """Return the fault of the field at `loc` of `owner`, in words."""
    field = ".".join(map(str, loc))
    if kind == "missing":
        return f"{owner} needs {field}"
    if kind in ("extra_forbidden", "no_such_attribute"):
        return f"{owner} has no field {field!r}{nearest(field, model.model_fields)}"
    return f"{field} of {owner} {_field_problem(error)}"


def first_misfit(error: ValidationError) -> str:
    """Return the first field that does not fit, and why: ``pous.0.name is not a text: 5 (int)``."""
    first = error.errors(include_url=False)[0]
    return f"{'.'.join(map(str, first['loc']))} {_field_problem(first)}"


def _field_problem(error: Mapping[str, Any]) -> str:
    """Return an error of pydantic about a field as the end of a sentence: ``is not a text: 5 (int)``."""
    kind, given = error["type"], shown(error["input"], _TEXT)
    if kind == "missing":
        return "is missing"
    if kind in ("extra_forbidden", "no_such_attribute"):
        return "is no field of the model"
    if kind in ("enum", "literal_error"):
        known = str(error["ctx"]["expected"]).replace(" or ", ", ").replace("'", "").split(", ")
        return f"is none of {', '.join(known)}: {given}{nearest(error['input'], known)}"
    if kind in _WANTED:
        return f"is not {_WANTED[kind]}: {given} ({type(error['input']).__name__})"
    if kind in ("model_type", "model_attributes_type", "dataclass_type"):
        wanted = error.get("ctx", {}).get("class_name", "object of the model")
        return f"is no {wanted}: {given} ({type(error['input']).__name__})"
    told = f"{given} ({type(error['input']).__name__})"
    context = error.get("ctx", {})
    if kind in _BOUNDS:
        word, bound = _BOUNDS[kind]
        return f"is {word} {context[bound]}: {told}"
    if kind in ("too_short", "too_long"):
        wanted = context["min_length" if kind == "too_short" else "max_length"]
        return f"has {context['actual_length']} items, not {wanted}: {told}"
    if kind == "union_tag_not_found":
        field = context["discriminator"].strip("'")
        return f"does not tell its {field}: {told}"
    if kind == "union_tag_invalid":
        known = context["expected_tags"].replace("'", "")
        return f"has none of the kinds {known}: {told}"
    return f"cannot be {told}"


_BOUNDS = {
    "greater_than_equal": ("less than", "ge"),
    "less_than_equal": ("more than", "le"),
    "greater_than": ("not more than", "gt"),
    "less_than": ("not less than", "lt"),
}
"""Bounds of a field in words, and the name of the bound, by the type of pydantic's error."""
