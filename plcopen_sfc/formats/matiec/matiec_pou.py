"""A POU while it is adapted to matiec: the names in it, the variables it gets, its bodies, and the report of them.

The converters of Beremiz and OpenPLC, which run before matiec, translate drawn logic. They know blocks, variables,
contacts, coils, rails and connectors, and see the negation, storage and edge of a contact, a coil and a pin, but not
those of a variable. A pin is known by its name in IEC 61131-3 as it is spelled there, and an operand that is written at
a pin instead of a wire is left out without a word (read from the converter of OpenPLC, and tried).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.languages.il import statements as il_statements
from plcopen_sfc.languages.networks import Helper, body_statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node, render, transform
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.words import IEC_KEYWORDS, is_plain, take_name
from plcopen_sfc.model import network as net
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import Body, SfcBody
from plcopen_sfc.model.types import DataType, SimpleValue, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome

UNDECLARED_PREFIX = "NOT_EXECUTED"
"""Start of names that are declared nowhere: matiec refuses a text for which there is no right one."""


@dataclass(slots=True)
class FittedPou:
    """A POU of the copy that is fitted. `own`: the project is of a tool that compiles with matiec.

    `types` are the names of the data types of the project, `globals` those of its global variables, in lower case;
    `functions` are the types of the results of its functions. `keeps_drawings`: what the converters before matiec
    translate rightly stays drawn.
    """

    pou: Pou
    dialect: Dialect
    report: ConversionReport
    own: bool
    types: frozenset[str] = frozenset()
    globals: frozenset[str] = frozenset()
    functions: Mapping[str, DataType] = field(default_factory=dict)
    keeps_drawings: bool = False
    used: set[str] = field(init=False)
    _idle: str = ""
    _results: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Collect the names of the POU."""
        self.used = {name.casefold() for name in _names(self.pou)}

    @property
    def path(self) -> str:
        """Path of the POU in reports."""
        return self.pou.report_path

    def note(self, outcome: Outcome, what: str, path: str, why: str) -> None:
        """Report an item."""
        self.report.add(outcome, what, path, why)

    def new_name(self, wish: str) -> str:
        """Return a name near `wish` that nothing in the POU has."""
        base = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", wish)).strip("_") or "x"
        base = f"x_{base}" if base[0].isdigit() or base.upper() in IEC_KEYWORDS else base
        return take_name(base, self.used)

    def declare(self, wish: str, kind: str | DataType = "BOOL", initial: SimpleValue | None = None) -> str:
        """Add a local variable; return its name."""
        name = self.new_name(wish)
        if self.pou.interface is None:
            self.pou.interface = Interface()
        sections = self.pou.interface.sections
        local = next((s for s in sections if s.kind is SectionKind.LOCAL and s.comment == ADDED), None)
        if local is None:
            local = VariableSection(kind=SectionKind.LOCAL, comment=ADDED)
            sections.append(local)
        local.variables.append(Variable.model_validate({"name": name, "type": kind, "initial": initial}))
        return name

    def idle(self) -> str:
        """Return the variable that is written where a statement is required and nothing is to be done."""
        self._idle = self._idle or self.declare("idle")
        return self._idle

    def result(self, function: str) -> str | None:
        """Return the variable for the result of a function that nothing else takes."""
        key = function.casefold()
        if key not in self.functions:
            return None
        if key not in self._results:
            self._results[key] = self.declare(f"{function}_result", self.functions[key])
        return self._results[key]

    def uncompilable(self, what: str) -> str:
        """Return a statement that does not compile, for what matiec lacks."""
        return f"{self.missing(what)} := TRUE;"

    def missing(self, what: str) -> str:
        """Return a name that is declared nowhere."""
        return self.new_name(f"{UNDECLARED_PREFIX}_{what}")

    def declare_helpers(self, helpers: Iterable[Helper]) -> list[str]:
        """Declare what a translated network needs; return what is wrong with it."""
        wrong: list[str] = []
        for helper in helpers:
            if helper.type_name is None:
                wrong.append(f"the type of {helper.name} is not known")
                continue
            self.used.discard(helper.name.casefold())
            name = self.declare(helper.name, helper.type_name)
            if name != helper.name:
                wrong.append(f"{helper.name} is the name of something else")
        return wrong

    def fitted(self, body: Body, path: str, wish: str) -> Body:
        """Return a body of a POU or an action in a form that is executed: as it is drawn, or as statements."""
        if self.keeps_drawings and isinstance(body, FbdBody | LdBody):
            nodes = [node for network in body.networks for node in network.nodes]
            if is_taken(nodes, self.dialect):
                self.note_negations(write_negations_out(nodes), path)
                return body
        text = self.statements(body, path)
        return StBody(text=self.uncompilable(wish) if text is None else text)

    def action(self, body: Body, path: str, wish: str) -> Body:
        """Return the body of an action: RETURN in it would end the whole POU, which matiec compiles without a word."""
        fitted = self.fitted(body, path, wish)
        if isinstance(fitted, StBody):
            parsed = parse_statements(fitted.text, self.dialect)
            refused = n.Assignment(n.Name(self.missing("RETURN")), n.Literal("TRUE"))
            tree = transform(parsed.tree, lambda node: refused if isinstance(node, n.ReturnStatement) else node)
            if not parsed.problems and tree is not parsed.tree:
                why = "RETURN ends the whole POU in matiec; the text does not compile there"
                self.note(Outcome.NOT_EXECUTED, "RETURN", path, why)
                fitted.text = render(parsed, tree)
        return fitted

    def note_negations(self, number: int, path: str) -> None:
        """Report negated variables that were written out."""
        if number:
            why = f"{number} written as NOT: the converters do not see the mark"
            self.note(Outcome.TRANSLATED, "negated variable", path, why)

    def statements(self, body: Body, path: str) -> str | None:
        """Return a body as statements; None where that is not possible, which is reported."""
        if isinstance(body, StBody):
            return body.text
        if isinstance(body, FbdBody | LdBody):
            read = body_statements(body, self.dialect, taken=self.used)
            wrong = [*map(str, read.obstacles), *self.declare_helpers(read.helpers)]
            blocks = sum(isinstance(node, net.Block) for network in body.networks for node in network.nodes)
            if not wrong and self.own and blocks > 1:
                why = "statements follow the wires, the converter of its tool goes by the places of the blocks"
                self.note(Outcome.APPROXIMATED, "body", path, why)
            elif not wrong:
                self.note(Outcome.TRANSLATED, "body", path, f"{body.language} became statements")
            if not wrong:
                return print_node(read.tree)
        elif isinstance(body, IlBody):
            tree = il_statements(body.text, self.dialect)
            if tree is not None:
                self.note(Outcome.TRANSLATED, "body", path, "instruction list became statements")
                return print_node(tree)
            wrong = ["matiec has instructions in bodies of POUs only, and no statements are known for these"]
        elif isinstance(body, SfcBody):
            wrong = ["matiec has no charts in actions"]
        else:
            wrong = ["it is in no language of IEC 61131-3"]
        self.note(Outcome.NOT_EXECUTED, "body", path, "; ".join(wrong))
        return None


ADDED = "for what is drawn or what matiec does not execute by itself"


def _names(pou: Pou) -> list[str]:
    names = [action.name for action in pou.actions] + [transition.name for transition in pou.transitions]
    names += [variable.name for variable in pou.variables()]
    for _, _, body in pou.named_bodies():
        if isinstance(body, SfcBody):
            names += [step.name for step in body.chart.steps]
            names += [a.target for _, a in body.chart.associations() if a.target is not None]
    return [pou.name, *names]


_TAKEN = (
    net.Block
    | net.Coil
    | net.CommentBox
    | net.Connector
    | net.Contact
    | net.Continuation
    | net.InOutVariable
    | net.InputVariable
    | net.LeftPowerRail
    | net.OutputVariable
    | net.RightPowerRail
)


def is_taken(nodes: Iterable[net.Node], dialect: Dialect) -> bool:
    """True if the converters translate these elements to what they mean."""
    return all(_is_taken(node, dialect) for node in nodes)


def _is_taken(node: net.Node, dialect: Dialect) -> bool:
    if isinstance(node, net.Block) and (node.code is not None or not _has_known_pins(node)):
        return False
    if any(pin.expression is not None for pin in _pins(node)):
        return False
    if isinstance(node, net.InOutVariable):
        return not (node.negated_in or node.negated_out)
    if isinstance(node, net.InputVariable):
        return node.edge is net.Edge.NONE and not parse_expression(node.expression, dialect).problems
    if isinstance(node, net.OutputVariable):
        return not node.negated and node.edge is net.Edge.NONE and node.storage is net.Storage.NONE
    return isinstance(node, _TAKEN)


def _variables(block: net.Block) -> list[net.BlockVariable]:
    return [*block.parameters.inputs, *block.parameters.in_outs, *block.parameters.outputs]


def _has_known_pins(block: net.Block) -> bool:
    """True unless the pins of a standard block are named as another tool does: ``In1`` for ``IN1``."""
    standard = standard_block(block.type_name)
    names = {variable.name for variable in _variables(block)} - {"EN", "ENO", ""}
    return standard is None or all(standard.pin_in(name, None) == name for name in names)


def _pins(node: net.Node) -> Iterator[net.InputPin | net.OutputPin]:
    parts = _variables(node) if isinstance(node, net.Block) else [node]
    pins = [getattr(part, name, None) for part in parts for name in ("input", "output")]
    yield from (pin for pin in (*pins, *getattr(node, "inputs", ()), *getattr(node, "outputs", ())) if pin is not None)


def write_negations_out(nodes: Iterable[net.Node]) -> int:
    """Write ``NOT x`` for a negated variable ``x`` that is read; return how many there were."""
    negated = [node for node in nodes if isinstance(node, net.InputVariable) and node.negated]
    for node in negated:
        node.expression = f"NOT {node.expression}" if is_plain(node.expression) else f"NOT ({node.expression})"
        node.negated = False
    return len(negated)
