"""Results of translations between networks and text, and their problems."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st.nodes import Expression, Statement, Statements


@dataclass(frozen=True, slots=True)
class NetworkProblem:
    """Something that a translation could not express (ERROR), assumed (WARNING) or lets the user know (INFO).

    `node` is the id of the element of the network; None: of none in particular.
    """

    message: str
    node: int | None = None
    severity: Severity = Severity.ERROR

    def __str__(self) -> str:
        place = f"element {self.node}: " if self.node is not None else ""
        return f"{self.severity}: {place}{self.message}"


@dataclass(frozen=True, slots=True)
class Helper:
    """A variable that a translation needs and that is not declared yet.

    `type_name` is None where the type is that of a wire that does not tell it. `retained`: it must keep its value from
    one cycle to the next (an instance of ``R_TRIG``, the value of a feedback wire); others may be temporary.
    """

    name: str
    type_name: str | None
    retained: bool


@dataclass(frozen=True, slots=True)
class NetworkText:
    """Result of a translation of a network to text.

    `instances` are the types of all function block instances in the network by name, `helpers` included; `comments`
    the comments and titles in it, each with the id of its element (None: of the network).
    """

    helpers: tuple[Helper, ...] = ()
    instances: Mapping[str, str] = field(default_factory=dict)
    comments: tuple[tuple[int | None, str], ...] = ()
    problems: tuple[NetworkProblem, ...] = ()

    @property
    def complete(self) -> bool:
        """True if the result expresses all of the network: no problem is an error."""
        return all(problem.severity is not Severity.ERROR for problem in self.problems)

    @property
    def obstacles(self) -> tuple[NetworkProblem, ...]:
        """The errors that keep the network from being executed: a value that leads nowhere does not."""
        errors = (problem for problem in self.problems if problem.severity is Severity.ERROR)
        return tuple(problem for problem in errors if "leads nowhere" not in problem.message)


@dataclass(frozen=True, slots=True)
class NetworkStatements(NetworkText):
    """A network as statements, in the order of execution.

    `open_ends` are values that lead nowhere: in CODESYS the result of a transition drawn in FBD.
    """

    tree: Statements = field(default_factory=lambda: Statements(()))
    open_ends: tuple[tuple[int, Expression], ...] = ()


@dataclass(frozen=True, slots=True)
class NetworkExpression(NetworkText):
    """A network as an expression, None where there is none; `before` must be executed right before it is evaluated.

    An expression cannot call function blocks: their calls, edges included, are in `before`.
    """

    tree: Expression | None = None
    before: tuple[Statement, ...] = ()
