"""Lowered code before it is a body: networks of statements, and the variables that they need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.lowering.naming import Naming
from plcopen_sfc.model.types import DataType, Elementary, ElementaryType, SimpleValue, Variable

BOOL = ElementaryType(name=Elementary.BOOL)


@dataclass(frozen=True)
class CodeNetwork:
    """Statements that belong together: a network of FBD and LD, a paragraph of ST."""

    title: str
    statements: tuple[n.Statement, ...]
    comment: str = ""


@dataclass(frozen=True)
class TextNetwork:
    """Structured text with comments inside, which statements do not have. Only a body in ST can hold it."""

    title: str
    text: str
    comment: str = ""


@dataclass
class Code:
    """What a lowering has made so far. `variables` are local, `inputs` come from outside.

    `at_rest`: the values of inputs with which the code does what the chart does; of `left_out`, if there is one, that
    is FALSE.
    """

    naming: Naming
    networks: list[CodeNetwork | TextNetwork] = field(default_factory=list)
    variables: list[Variable] = field(default_factory=list)
    inputs: list[Variable] = field(default_factory=list)
    at_rest: dict[str, bool] = field(default_factory=dict)
    left_out: n.Name | None = None

    def declare(self, wanted: str, kind: DataType = BOOL, *, initial: str | None = None, comment: str = "") -> n.Name:
        """Declare a local variable that is called `wanted`, if that is free, and give its name."""
        name = self.naming.fresh(wanted)
        value = SimpleValue(text=initial) if initial is not None else None
        self.variables.append(Variable(name=name, type=kind, initial=value, comment=comment or None))
        return self.naming.local(name)

    def declare_as(self, name: str, kind: DataType) -> None:
        """Declare a local variable of this very name."""
        self.variables.append(Variable(name=name, type=kind))

    def declare_input(self, name: str, comment: str, kind: DataType = BOOL, *, at_rest: bool | None = None) -> n.Name:
        """Declare an input of this very name; `at_rest` is its value while it is not used."""
        self.inputs.append(Variable(name=name, type=kind, comment=comment))
        if at_rest is not None:
            self.at_rest[name] = at_rest
        return self.naming.local(name)

    def add(self, title: str, statements: Sequence[n.Statement], comment: str = "") -> None:
        """Append a network, if there is something in it."""
        if statements:
            self.networks.append(CodeNetwork(title, tuple(statements), comment))
