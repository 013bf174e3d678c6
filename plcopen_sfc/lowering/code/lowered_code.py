"""Lowered code before it is a body: networks of statements, and the variables that they need."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from plcopen_sfc.languages.networks import Helper
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.code.boolean_logic import FALSE, assignment
from plcopen_sfc.lowering.code.code_declarations import BOOL, FlagPlaces, Naming
from plcopen_sfc.lowering.code_texts import Texts
from plcopen_sfc.model.text import MultilingualText, Text
from plcopen_sfc.model.types import (
    DataType,
    DataTypeDeclaration,
    DerivedType,
    Elementary,
    ElementaryType,
    SimpleValue,
    Variable,
)

StepValue: TypeAlias = Callable[[int], n.Expression]
"""Expression for something of a step, given by its index in the net."""


@dataclass(frozen=True)
class CodeNetwork:
    """Statements that belong together: a network of FBD and LD, a paragraph of ST.

    `remarks` are comments inside a paragraph, by the index of the statement behind them.
    """

    title: str
    statements: tuple[n.Statement, ...]
    comment: str = ""
    remarks: Mapping[int, str] = field(default_factory=dict)


@dataclass(frozen=True)
class TextNetwork:
    """Structured text with comments inside, which statements do not have. Only a body in ST can hold it."""

    title: str
    text: str
    comment: str = ""
    guarded: GuardedText | None = None


@dataclass(frozen=True)
class GuardedText:
    """Text of a `TextNetwork` without its IF: it is executed under a condition, and does what the statements do."""

    condition: n.Expression
    text: str
    statements: tuple[n.Statement, ...]


@dataclass
class LoweredCode:
    """Code that a lowering has made so far. `variables` and `constants` are local, `inputs` come from outside.

    `data_types` are new ones of the project. `drawn`: it becomes networks, all on `one_sheet` or each for itself;
    `tool`: the tool that it is for, where that matters. `for_others`: exact code for a format, not for the project.
    `is_textbook`: code in the classic style.
    `culture` (``de-DE``): the language of comments, where the target has another usual one.
    `operands`: variables in which boxes of S7 keep their state, with these boxes.
    `texts`: names of variables. `at_rest`: the values of inputs with which the code does what the chart does, in scans
    in which `left_out`, if there is one, is FALSE. `flags`: the place of step flags; None: among the local variables.
    `known_types`: the data types of the project, in lower case.
    """

    naming: Naming
    networks: list[CodeNetwork | TextNetwork] = field(default_factory=list)
    variables: list[Variable] = field(default_factory=list)
    inputs: list[Variable] = field(default_factory=list)
    outputs: list[Variable] = field(default_factory=list)
    constants: list[Variable] = field(default_factory=list)
    data_types: list[DataTypeDeclaration] = field(default_factory=list)
    at_rest: dict[str, bool] = field(default_factory=dict)
    left_out: n.Name | None = None
    drawn: bool = False
    one_sheet: bool = False
    tool: Tool | None = None
    for_others: bool = False
    is_textbook: bool = False
    culture: str = ""
    operands: dict[n.Expression, str] = field(default_factory=dict)
    instances: Mapping[str, str] = field(default_factory=dict)
    flags: FlagPlaces | None = None
    first_scan: n.Name | None = None
    texts: Texts = field(default_factory=Texts)
    known_types: Collection[str] = ()

    def declare(self, wanted: str, kind: DataType = BOOL, *, initial: str | None = None, comment: str = "") -> n.Name:
        """Declare a local variable that is called `wanted`, if that is free, and return its name."""
        name = self.naming.fresh(wanted)
        if isinstance(kind, DerivedType):
            kind = self.naming.system_type(kind)
        value = SimpleValue(text=initial) if initial is not None else None
        self.variables.append(Variable(name=name, type=kind, initial=value, comment=self.caption(comment)))
        return self.naming.local(name)

    def caption(self, text: str) -> Text | None:
        """Return a title or comment as text of the model, if there is any."""
        return MultilingualText(texts={self.culture: text}) if text and self.culture else text or None

    def declare_constant(self, wanted: str, kind: DataType, value: str, comment: str) -> n.Name:
        """Declare a local constant that is called `wanted`, if that is free, and return its name."""
        name = self.naming.fresh(wanted)
        text = self.caption(comment)
        self.constants.append(Variable(name=name, type=kind, initial=SimpleValue(text=value), comment=text))
        return self.naming.local(name)

    @property
    def is_portable(self) -> bool:
        """True if it is for every tool of IEC 61131-3: edition 2, as in matiec, has no ``//``, no empty statement."""
        return self.for_others and self.tool is None

    @property
    def has_regions(self) -> bool:
        """True if it is for TIA Portal, whose editor folds regions and lists them."""
        return self.for_others and self.tool is Tool.S7

    @property
    def own_names(self) -> set[str]:
        """Names of the variables that it has declared, in lower case: no other code writes them."""
        return {variable.name.casefold() for variable in (*self.variables, *self.constants)}

    @property
    def needs_flat_statements(self) -> bool:
        """True if it becomes networks that hold no IF and CASE; those of CODESYS do, as the text of a box."""
        return self.drawn and self.tool is not Tool.CODESYS

    def beside(self) -> LoweredCode:
        """Return code for another block of the same target, with variables of its own."""
        return replace(
            self, networks=[], variables=[], inputs=[], constants=[], data_types=[], operands={}, first_scan=None
        )

    def declare_flag(self, wanted: str, *, initial: bool, comment: str) -> n.Expression:
        """Declare the flag of a step in its place, and return the expression that reads it."""
        if self.flags is not None:
            return self.flags.declare(wanted, self.naming, initial=initial, comment=self.caption(comment))
        return self.declare(wanted, initial="TRUE" if initial else None, comment=comment)

    def first_scan_pulse(self) -> n.Name:
        """Return a variable that is TRUE until the end of the first scan; `Memory.finish` ends it."""
        if self.first_scan is None:
            self.first_scan = self.declare(self.texts.pulse, initial="TRUE")
        return self.first_scan

    def end_first_scan(self, title: str) -> None:
        """Append the end of that pulse, if it is used."""
        if self.first_scan is not None:
            self.add(title, [assignment(self.first_scan, FALSE)])

    def declare_as(self, name: str, kind: DataType) -> None:
        """Declare a local variable of this very name."""
        self.variables.append(Variable(name=name, type=kind))

    def declare_helpers(self, helpers: Iterable[Helper]) -> None:
        """Declare the variables that drawings need when they are read as text."""
        for helper in helpers:
            wanted = helper.type_name or "BOOL"
            known = Elementary.__members__.get(wanted)
            self.declare_as(helper.name, ElementaryType(name=known) if known else DerivedType(name=wanted))

    def declare_input(self, name: str, comment: str, kind: DataType = BOOL, *, at_rest: bool | None = None) -> n.Name:
        """Declare an input of this very name; `at_rest` is its value while it is not used."""
        self.inputs.append(Variable(name=name, type=kind, comment=self.caption(comment)))
        if at_rest is not None:
            self.at_rest[name] = at_rest
        return self.naming.local(name)

    def declare_output(self, wanted: str, comment: str) -> n.Name:
        """Declare a Boolean output that is called `wanted`, if that is free, and return its name."""
        name = self.naming.fresh(wanted)
        self.outputs.append(Variable(name=name, type=BOOL, comment=self.caption(comment)))
        return self.naming.local(name)

    def add(
        self, title: str, statements: Sequence[n.Statement], comment: str = "", *, place: int | None = None
    ) -> None:
        """Append a network, or put it at a place, if there is something in it."""
        if statements:
            network = CodeNetwork(title, tuple(statements), comment)
            self.networks.insert(len(self.networks) if place is None else place, network)

    def add_each(self, title: str, parts: Sequence[CodeNetwork]) -> None:
        """Append parts that belong together: as networks of their own where they are drawn, else as one paragraph."""
        if self.drawn:
            self.networks += [part for part in parts if part.statements]
            return
        statements: list[n.Statement] = []
        remarks: dict[int, str] = {}
        for part in parts:
            if part.comment:
                remarks[len(statements)] = part.comment
            statements += part.statements
        if statements:
            self.networks.append(CodeNetwork(title, tuple(statements), remarks=remarks))
