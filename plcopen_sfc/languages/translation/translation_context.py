"""Context of a translation: names, types and steps beside the text."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Self

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.s7_types import S7Types
from plcopen_sfc.languages.st.nodes import Call, Expression, Node, Span
from plcopen_sfc.languages.translation.renames import Renames
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.report import Cause, CauseKind


class StepNotation(StrEnum):
    """Notation for a step being active, and for how long.

    IEC: ``Step3.X``, ``Step3.T`` (IEC 61131-3, 6.7.2). CODESYS: ``Step3.x``, ``Step3.t``. FLAG: ``Step3``, the BOOL of
    simple steps in CoDeSys V2.3. S7_GRAPH: ``#Step3.X`` in its own block, ``"GraphDB".Step3.X`` elsewhere, times ``.T``
    and ``.U`` (without disturbances). GRAFCET: ``X3`` (IEC 60848, 4.5), by the number of the step.
    """

    IEC = "iec"
    CODESYS = "codesys"
    FLAG = "flag"
    S7_GRAPH = "s7-graph"
    GRAFCET = "grafcet"


class NameTable(dict[str, str]):
    """What belongs to names, by these in lower case: case does not matter in them.

    A context may have plain names. The texts of one POU share a table: to make it takes as long as the POU is large.
    """

    @classmethod
    def of(cls, names: Mapping[str, str] | Iterable[str]) -> Self:
        """Return a table as it is; of a mapping its values by the names, of other names themselves."""
        if isinstance(names, cls):
            return names
        pairs = names.items() if isinstance(names, Mapping) else ((name, name) for name in names)
        return cls((name.casefold(), value) for name, value in pairs)


@dataclass(frozen=True, slots=True)
class StepReferences:
    """The steps that a text may refer to, and how it does.

    `names`: from the name in the source text (its number in GRAFCET) to that in the target. `source_block`,
    `target_block`: the instance or POU that has the steps, where the text is outside of it. `disturbed`: the steps
    with an interlock or a supervision, by their names in lower case; None: any may have one.
    """

    names: Mapping[str, str]
    source: StepNotation
    target: StepNotation
    source_block: str = ""
    target_block: str = ""
    disturbed: Collection[str] | None = None


@dataclass(frozen=True, slots=True)
class TranslationContext:
    """Meanings of the names in a text. Names of the source text, case does not matter.

    `locals`: all that the POU declares, its instances too; None: not known, and then names get no ``#`` and no quotes
    in SCL. `hiding`: what they are called in the target, where that has been looked for. `types`: types of variables
    and instances by name, by path for members (``station.timer``): needed for the pins of instances (``TON``, ``CTU``)
    and for conversions whose name tells the source type. `enumerations`: names of
    enumeration types: ``Color.red`` of CODESYS is ``Color#red`` in IEC 61131-3. `renames`: known ones, and the place of
    new ones. `steps`: without, step variables are not told from others. `s7_types`: the enumerations, whose values are
    user constants in SCL; `hidden` are names that are no values of them, whatever these are called. `actions`: the
    actions and methods of the POU, which S7 cannot call. `functions`: the inputs of the functions of the project by the
    name of the function in lower case: they are called instead of standard functions of the same name, and S7 wants the
    names of their inputs. `listed`: global names that are others in the target, part by part, by the name in lower
    case: ``x`` is ``"GVL".x`` and ``gvl.y`` is ``"y"`` in SCL. `type_of`: the elementary type of a variable or of the
    result of a function of the project, in capitals, empty where it has another; without, arithmetic stays as it is.
    `parameter_type`: the same of the parameter for an argument of a call, by its place. `is_instance`: whether a callee
    is known to be something that S7 calls. `wanted`: the type of the
    variable that gets the value of an expression. `addresses`: the dialects of direct addresses before and after, where
    they are not those of the text.
    """

    locals: Collection[str] | None = None
    hiding: Collection[str] | None = None
    types: Mapping[str, str] = field(default_factory=dict)
    enumerations: Collection[str] = ()
    renames: Renames = field(default_factory=Renames)
    steps: StepReferences | None = None
    s7_types: S7Types | None = None
    hidden: Collection[str] = ()
    actions: Collection[str] = ()
    functions: Mapping[str, Sequence[str]] = field(default_factory=dict)
    listed: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    type_of: Callable[[Expression], str] | None = None
    parameter_type: Callable[[Call, int], str] | None = None
    wanted: str = ""
    is_instance: Callable[[Expression], bool] | None = None
    addresses: tuple[Dialect, Dialect] | None = None


def family(dialect: Dialect) -> Dialect:
    """Return the dialect itself, but CODESYS for TwinCAT, which is the same language."""
    return Dialect.CODESYS if dialect is Dialect.TWINCAT else dialect


TITLES = {
    Dialect.IEC: "IEC 61131-3",
    Dialect.CODESYS: "CODESYS",
    Dialect.TWINCAT: "TwinCAT",
    Dialect.SCL: "SCL",
}
"""Names of dialects in messages."""


@dataclass(frozen=True, slots=True)
class Note:
    """A note on a place in the source text.

    `severity`: ERROR: it has no counterpart in the target dialect and stays unchanged. WARNING: it was
    translated, or left, but may mean something else there. INFO: it means the same but is worth knowing, such as a new
    name. `span`: offsets into the source text; `line` and `column` of its start, from 1. `cause`: that in a report.
    """

    severity: Severity
    reason: str
    span: Span
    line: int
    column: int
    cause: Cause | None = None


@dataclass(frozen=True, slots=True)
class PartText:
    """The text of something in the target dialect. `severity` None: it means the same, and there is no note."""

    text: str
    severity: Severity | None = None
    reason: str = ""


class Notes:
    """Collects the notes on a text."""

    def __init__(self, text: str) -> None:
        self._end = len(text)
        self._lines = Lines(text)
        self._found: dict[Note, None] = {}

    def add(self, severity: Severity, reason: str, place: Node | Span, cause: Cause | None = None) -> None:
        """Note something about a node of the source text, or about a place in it."""
        span = place.span if isinstance(place, Node) else place
        start, end = span or (0, self._end)
        line, column = self._lines.place(start)
        self._found[Note(severity, reason, (start, end), line, column, cause)] = None

    def add_lacking(self, reason: str, name: str, place: Node | Span) -> None:
        """Note that the target dialect has nothing of a `name`, which is left unchanged."""
        self.add(Severity.ERROR, f"{reason}; left unchanged", place, Cause(CauseKind.LACKING, name))

    def take(self, outcome: PartText, place: Node | Span) -> str:
        """Return the text of an outcome, after its note is added."""
        if outcome.severity is not None:
            self.add(outcome.severity, outcome.reason, place)
        return outcome.text

    @property
    def has_errors(self) -> bool:
        """True if something has no counterpart."""
        return any(note.severity is Severity.ERROR for note in self._found)

    def in_order(self) -> tuple[Note, ...]:
        """Return the notes in the order of the text."""
        return tuple(sorted(self._found, key=lambda note: note.span))
