"""Errors and the places they point at.

Every error a user can meet is an `SfcError` that names what is wrong, where (file, line, column, object path) and what
to do about it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from plcopen_sfc.object_path import ObjectPath

if TYPE_CHECKING:
    from plcopen_sfc.report import ConversionReport


def nearest(name: object, known: Iterable[str]) -> str:
    """Return `` (did you mean 'Fill'?)`` with the known name that is most like `name`; empty if none is like it."""
    from difflib import get_close_matches  # noqa: PLC0415  # only for messages

    by_folded = {each.casefold(): each for each in known}
    found = get_close_matches((name if isinstance(name, str) else shown(name)).casefold(), by_folded, 1)
    return f" (did you mean {str(by_folded[found[0]])!r}?)" if found else ""


@dataclass(frozen=True, slots=True)
class Location:
    """A place in a file or in a model.

    `line` and `column` count from 1. `path` names the object the way a person would: ``POU Main / step S3``, or, for
    XML that has no model object, the element path ``/project/types/pous/pou[2]``.
    """

    file: str | None = None
    line: int | None = None
    column: int | None = None
    path: str | None = None

    def __str__(self) -> str:
        place = self.file or ""
        if self.line is not None:
            place += f":{self.line}" if place else f"line {self.line}"
            if self.column is not None:
                place += f":{self.column}"
        if self.path:
            place += f" ({self.path})" if place else self.path
        return place


class SfcError(Exception):
    """Base of all errors of this package.

    `message` is the fault, `location` its place, `hint` how to mend it (may be empty).
    """

    def __init__(self, message: str, *, location: Location | None = None, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.location = location or Location()
        self.hint = hint

    def __str__(self) -> str:
        place = str(self.location)
        text = f"{place}: {self.message}" if place else self.message
        return f"{text}\n  {self.hint}" if self.hint else text

    def __reduce__(self) -> tuple[Any, ...]:
        # Exceptions are rebuilt by calling their class with `args`, which loses or misses what classes require besides:
        # an error of a worker process would end the pool instead of reaching its user.
        return _without_init, (type(self), self.args), self.__dict__


def _without_init(kind: type[SfcError], args: tuple[object, ...]) -> SfcError:
    return kind.__new__(kind, *args)


class ExhaustionError(SfcError):
    """A file takes more memory than there is, or is nested more deeply than the stack of Python allows."""


@contextmanager
def told_when_exhausted(file: str | None = None) -> Iterator[None]:
    """Raise `ExhaustionError` where Python raises errors of its own for the lack of memory or depth."""
    try:
        yield
    except (MemoryError, RecursionError) as error:
        lacks_memory = isinstance(error, MemoryError)
        message = "not enough memory for this file" if lacks_memory else "the content is nested too deeply"
        hint = "Loading and saving take 20 to 70 times the size of an XML file. Divide it." if lacks_memory else ""
        raise ExhaustionError(message, location=Location(file), hint=hint) from None


class FileAccessError(SfcError, OSError):
    """A file cannot be read or written: missing, a directory, no rights, disk full."""

    __str__ = SfcError.__str__

    def __reduce__(self) -> tuple[Any, ...]:
        rebuild, arguments, state = super().__reduce__()
        return rebuild, arguments, {**state, "errno": self.errno}  # which OSError keeps outside its dictionary


class FormatError(SfcError, ValueError):
    """The content does not fit its format: the base of all reading errors."""


class UnknownFormatError(FormatError):
    """No known format recognises the content, or the requested format does not exist."""


class UnreadFormatError(UnknownFormatError):
    """The file of a tool whose format is recognised and not read; `hint` names an export of the tool that is."""


class XmlSyntaxError(FormatError):
    """Not well-formed XML: not XML at all, truncated, or damaged."""


class UnsafeXmlError(FormatError):
    """XML refused for safety: document type declarations with entities, external references, nesting without end."""


class EncodingError(FormatError):
    """The bytes are not in the encoding that the file declares."""


class UnknownVersionError(FormatError):
    """The format is known but this version of it is not."""


class StructureError(FormatError):
    """Well-formed, of a known format, but what is required is missing or in the wrong place."""


class LossError(SfcError):
    """A file would not do what its source does, and that was not accepted. Nothing was written.

    `report` is the `ConversionReport` of what would have been written, `summary` the message without its items.
    """

    def __init__(self, summary: str, report: ConversionReport, *, items: str = "", hint: str = "") -> None:
        super().__init__(f"{summary}: {items}" if items else summary, hint=hint)
        self.report = report
        self.summary = summary


class ComparisonInterrupt(KeyboardInterrupt):
    """Ctrl-C while charts were compared, in a conversion. Nothing was written.

    `report` is the `ConversionReport` of what would have been written, with the verdicts that were known by then.
    """

    def __init__(self, report: ConversionReport) -> None:
        super().__init__("interrupted")
        self.report = report


class VersionNeed(NamedTuple):
    """Need for a newer version of a format: the object, what it has, and the first version that can express it."""

    path: str
    feature: str
    version: str


class OldVersionError(SfcError):
    """A file was to be written for an older version of its tool than its content needs. Nothing was written.

    `needs` lists what in a file written for `version` needs which newer one.
    """

    def __init__(self, version: str, needs: Iterable[VersionNeed]) -> None:
        self.version = version
        self.needs = tuple(needs)
        lines = [f"{need.path}: {need.feature} needs {need.version}" for need in self.needs[:_SHOWN]]
        if len(self.needs) > len(lines):
            lines.append(f".. and {len(self.needs) - len(lines)} more")
        message = f"{version} cannot say all of it: " + "; ".join(lines)
        super().__init__(message, hint="Nothing was written. Write for a newer version, or take it out.")


_SHOWN = 10


class ModelError(SfcError, ValueError):
    """An operation on the model that its content does not allow: a name that does not exist, or exists already."""


class ArgumentError(SfcError, TypeError):
    """A function was given an object of a type that it does not take."""


class ScriptError(SfcError, ValueError):
    """A script that cannot be run on files, or is run with settings that it does not have."""


class PluginError(SfcError):
    """A plugin of another package cannot be imported, or is not what its entry point is for."""


def check_argument(value: object, types: type | tuple[type, ...], need: str, hint: str = "") -> None:
    """Raise `ArgumentError` if `value` is not of `types`; `need` is the requirement: ``loads needs bytes``."""
    if not isinstance(value, types):
        raise ArgumentError(f"{need}, not {shown(value, _REPR)} ({type(value).__name__})", hint=hint)


_REPR = 40


def shown(value: object, most: int | None = None) -> str:
    """Return a value as messages show it: as Python writes it, of more than `most` characters the first.

    A number of thousands of digits, which Python does not write, is shown by its type, and so is an object whose
    ``__repr__`` fails.
    """
    try:
        text = repr(value)
    except Exception:  # any class may be passed, and the message is about another error
        return f"<{type(value).__name__}>"
    return text if most is None or len(text) <= most else f"{text[:most]}.."


def check_names(values: object, need: str) -> None:
    """Raise `ArgumentError` for something else than a mapping whose keys are texts."""
    check_argument(values, Mapping, need)
    for name in values if isinstance(values, Mapping) else ():
        check_argument(name, str, need)


def refuse_unknown_options(function: str, options: Iterable[str], known: Collection[str]) -> None:
    """Raise `ArgumentError` for an option that a function does not have."""
    for name in options:
        if name not in known:
            raise ArgumentError(f"{function} has no option {name!r}{nearest(name, known)}")


def listed_names(values: Iterable[str] | str, need: str) -> list[str]:
    """Return several names, or the one that a text is. Raises `ArgumentError` for anything else."""
    if isinstance(values, str):
        return [values]
    check_argument(values, Iterable, need)
    found = list(values)
    for value in found:
        check_argument(value, str, need)
    return found


class InputError(SfcError, ValueError):
    """Inputs of a simulation that do not fit: an unknown variable, a value that its type cannot have, a bad file."""


class CompetingTransitionsError(SfcError):
    """Competing transitions are true at once where that is forbidden. `transitions`: their paths."""

    def __init__(self, message: str, *, transitions: tuple[str, ...]) -> None:
        super().__init__(message, hint="Make their conditions exclude each other, or give them priorities.")
        self.transitions = transitions


class SimulationError(SfcError):
    """A simulated controller cannot go on.

    There is a division by zero, an index out of bounds, an endless loop, a text with syntax errors, or a construct that
    the simulator does not know.

    `location.path` is the body (``Main.Fill``), `location.line` the line in its text, `scan` the number of the scan
    from 1; None: it was found before the first scan.
    """

    def __init__(self, message: str, *, location: Location | None = None, hint: str = "") -> None:
        super().__init__(message, location=location, hint=hint)
        self.scan: int | None = None

    @property
    def pou(self) -> str:
        """The POU in which it happened."""
        return ObjectPath.of(self.location.path).owner.partition(".")[0]

    def __str__(self) -> str:
        return super().__str__() if self.scan is None else f"scan {self.scan}: {super().__str__()}"


class UnknownFunctionError(SimulationError):
    """A function, function block or type called `name` is neither of the project nor known to the simulator."""

    def __init__(self, name: str, message: str, *, location: Location | None = None, hint: str = "") -> None:
        super().__init__(message, location=location, hint=hint)
        self.name = name


class LoweringError(SfcError):
    """A chart, or something in it, cannot be lowered as asked. Nothing was written, nothing was approximated."""


class UnknownBehaviourError(SimulationError):
    """A chart has something of which the profile does not say what it does. It is not guessed.

    A qualifier of another tool, for example, or an event of S7-GRAPH in a chart of CODESYS.
    """


class UnstableChartError(SimulationError):
    """The search for stability does not end: the situation goes on changing with the same inputs."""


class ForcingConflictError(SimulationError):
    """Two forcing orders want a partial chart of a GRAFCET to be in different situations at the same time."""
