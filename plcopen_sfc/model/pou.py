"""Program organisation units and what belongs to them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import StrEnum
from typing import Any, ClassVar, NamedTuple

from pydantic import Field

from plcopen_sfc.errors import ModelError, check_argument, nearest, shown
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.owners import OwnedName
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork
from plcopen_sfc.model.text import Text, local_name
from plcopen_sfc.model.types import DataType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind
from plcopen_sfc.operations import provided


class PouKind(StrEnum):
    """Kinds of POUs (IEC 61131-3 ed. 3, 6.6)."""

    PROGRAM = "program"
    FUNCTION_BLOCK = "functionBlock"
    FUNCTION = "function"
    ORGANIZATION_BLOCK = "organizationBlock"


class Action(OwnedName, Element):
    """An action of a POU: code that steps execute by its name."""

    name: str
    body: Body | None = None
    object_id: str | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("body",)


class NamedTransition(OwnedName, Element):
    """A transition object of a POU: a condition with a name that charts refer to."""

    name: str
    body: Body | None = None
    object_id: str | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("body",)


class Method(OwnedName, Element):
    """A method of a function block."""

    name: str
    interface: Interface | None = None
    body: Body | None = None
    object_id: str | None = None

    OWNS: ClassVar[tuple[str, ...]] = ("interface", "body")


class NamedBody(NamedTuple):
    """A body and what it belongs to: ``Main`` or, of an action, ``Main.Fill``."""

    name: str
    pou: Pou
    body: Body


class Pou(ProjectObject):
    """A program, function block or function.

    `place` is where in the project the POU is: empty for the pool of types, ``application/NAME`` for a CODESYS or
    TwinCAT application, ``configuration/NAME/resource/NAME`` for a device export. `bodies` holds more than one where
    the tool knows worksheets, and in TIA Portal, whose blocks mix languages: one for each run of networks in one
    language. `number` is that of the block in the controller (``FB 12``).
    """

    kind_in_reports: ClassVar[str] = "POU"
    OWNS: ClassVar[tuple[str, ...]] = ("interface", "bodies", "actions", "transitions", "methods")

    number: int | None = None
    title: Text | None = None
    kind: PouKind
    interface: Interface | None = None
    actions: list[Action] = Field(default_factory=list)
    transitions: list[NamedTransition] = Field(default_factory=list)
    methods: list[Method] = Field(default_factory=list)
    bodies: list[Body] = Field(default_factory=list)
    place: str = ""
    object_id: str | None = None

    @property
    def body(self) -> Body | None:
        """The first body, which in most files is the only one."""
        return self.bodies[0] if self.bodies else None

    @property
    def chart(self) -> SfcNetwork | None:
        """The chart of the first SFC body."""
        return next((body.chart for body in self.bodies if isinstance(body, SfcBody)), None)

    @property
    def sfc(self) -> SfcNetwork | None:
        """The same as `chart`."""
        return self.chart

    def implicit_flags(self) -> set[str]:
        """The names of the SFC flags whose variables the tool declares for its charts, as their settings state it."""
        bodies = (*self.bodies, *(action.body for action in self.actions))
        charts = [body.chart for body in bodies if isinstance(body, SfcBody)]
        flags = [flag for chart in charts if chart.settings is not None for flag in chart.settings.flags.items()]
        return {flag.variable for flag, stated in flags if stated.use and stated.declare}

    def variables(self, kind: SectionKind | None = None) -> list[Variable]:
        """Return the variables of its interface, or those of one kind of section, in the order of their declaration."""
        return self.interface.variables(kind) if self.interface is not None else []

    @property
    def parts(self) -> list[Action | NamedTransition | Method]:
        """Its actions, named transitions and methods."""
        return [*self.actions, *self.transitions, *self.methods]

    def interfaces(self) -> list[Interface]:
        """Return its interface and those of its methods."""
        parts: list[Pou | Method] = [self, *self.methods]
        return [part.interface for part in parts if part.interface is not None]

    def add_variable(
        self, name: str, type: DataType | str = "BOOL", kind: SectionKind | str = SectionKind.LOCAL
    ) -> Variable:
        """Declare a variable: ``pou.add_variable("Level", "INT", "input")``.

        Raises `ModelError` where the name is taken, or there is no such kind.
        """
        self._claim(name)
        if kind not in [*SectionKind]:
            raise ModelError(
                f"{shown(kind)} is no kind of variable{nearest(kind, SectionKind)}",
                hint=f"There are: {', '.join(SectionKind)}",
            )
        fields: dict[str, Any] = {"type": type}
        variable = Variable(name=name, **fields)
        if self.interface is None:
            self.interface = Interface()
        self.interface.section(SectionKind(kind)).variables.append(variable)
        return variable

    def add_action(self, name: str, text: str = "") -> Action:
        """Append an action in ST. Raises `ModelError` where the name is taken."""
        self._claim(name)
        action = Action(name=name, body=StBody(text=text))
        self.actions.append(action)
        return action

    def _claim(self, name: str) -> None:
        check_argument(name, str, "the name is a text")
        if any(each.name.casefold() == name.casefold() for each in (*self.parts, *self.variables())):
            raise ModelError(f"{self.report_path} has a {name!r} already")

    def action(self, name: str) -> Action:
        """Return the action of this name; case does not matter. Raises `ModelError`."""
        check_argument(name, str, "the name of an action is needed")
        found = self.find_action(name)
        if found is None:
            names = [action.name for action in self.actions]
            raise ModelError(
                f"{self.report_path} has no action {name!r}{nearest(name, names)}",
                hint="It has: " + (", ".join(names[:20]) or "none"),
            )
        return found

    def declared_twice(self) -> Iterator[tuple[str, Variable | Action | Method | NamedTransition, str]]:
        """Yield each variable, action, method and named condition whose name another of its kind has before it.

        As a word for what it is, the thing, and the name of the first, which may differ in upper and lower case.
        """
        kinds: dict[str, Iterable[Variable | Action | Method | NamedTransition]] = {
            "variable": self.variables(),
            "action": self.actions,
            "method": self.methods,
            "named condition": self.transitions,
        }
        for word, things in kinds.items():
            known: dict[str, Variable | Action | Method | NamedTransition] = {}
            for thing in things:
                first = known.setdefault(thing.name.casefold(), thing)
                if first is not thing:
                    yield word, thing, first.name

    def find_action(self, name: str) -> Action | None:
        """Return the action of this name, or None; case does not matter, nor do the signs of S7."""
        check_argument(name, str, "an action is found by its name")
        wanted = local_name(name).casefold()
        return next((a for a in self.actions if a.name.casefold() == wanted), None)

    def _repr_html_(self) -> str:
        """Show the variables and the bodies in Jupyter."""
        table: str = provided("pou_table")(self)
        return table

    def named_bodies(self) -> Iterator[NamedBody]:
        """Yield every body of the POU with the name of what it belongs to: ``Main``, ``Main.Fill`` (of an action)."""
        for body in self.bodies:
            yield NamedBody(self.name, self, body)
        for part in self.parts:
            if part.body is not None:
                yield NamedBody(f"{self.name}.{part.name}", self, part.body)

    def report_path_of(self, name: str) -> str:
        """Place of the body that `named_bodies` calls `name`, in the words of messages and reports.

        ``POU Main``, ``POU Main / action Fill``.
        """
        groups = (("action", self.actions), ("transition", self.transitions), ("method", self.methods))
        for kind, parts in groups:
            for part in parts:
                if name == f"{self.name}.{part.name}":
                    return f"{self.report_path} / {kind} {part.name}"
        return self.report_path


class DataBlockKind(StrEnum):
    """Contents of a data block of TIA Portal: variables of its own, an instance, or one array."""

    GLOBAL = "global"
    INSTANCE = "instance"
    ARRAY = "array"


class DataBlock(ProjectObject):
    """A data block of TIA Portal: variables that keep their values.

    `type_name` is the function block or data type of which an instance data block is one; its `interface` repeats that
    of the type, with the start values of this instance. `number` as in `Pou`.
    """

    kind_in_reports: ClassVar[str] = "data block"
    OWNS: ClassVar[tuple[str, ...]] = ("interface",)

    number: int | None = None
    title: Text | None = None
    kind: DataBlockKind = DataBlockKind.GLOBAL
    type_name: str | None = None
    interface: Interface | None = None
