"""Variables that a program writes in every scan before it reads them: their old values are no part of its state.

Lowered charts compute transition bits again in every scan, and give timers and flip-flops their inputs with every call.
Without this a search would tell states apart that differ in such values only.

Bodies that alone see the variables of their POU: what their statements do to these is all that is done to them.

`sole_statements` are those of a single body in their order, `all_nodes` the nodes of any body of a POU, in no order.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

from plcopen_sfc.languages.binding import bind, is_named_elsewhere
from plcopen_sfc.languages.effects import plain_path
from plcopen_sfc.languages.il import statements as statements_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.walking import children, walk
from plcopen_sfc.model.body import IlBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.programs.controller import Instance
from plcopen_sfc.semantics.programs.runtime_types import (
    Direction,
    Family,
    Layout,
    ScalarType,
    StructureType,
    default,
    leaves,
)
from plcopen_sfc.semantics.signals import Value

_ALIASES = (n.Dereference, n.Peripheral)
_JUMPS = (n.Goto, n.LabelStatement, n.Try, n.EmbeddedCode, n.Unreadable)


@lru_cache(maxsize=2)  # both sides of a comparison ask more than once
def sole_statements(instance: Instance) -> Sequence[n.Statement] | None:
    """Return the statements of the only body of a POU, if it alone sees the variables, and by their names only.

    None for what is not one body of text, FBD or LD without actions and methods, which see the variables too, or where
    references or jumps are used.
    """
    pou, project = instance.unit.pou, instance.controller.project
    if len(pou.bodies) != 1 or pou.actions or pou.methods or pou.transitions or instance.unit.base is not None:
        return None
    if pou.kind is PouKind.PROGRAM and is_named_elsewhere(pou, project):
        return None
    body = pou.bodies[0]
    statements = _listed(body, project.dialect) if isinstance(body, IlBody) else bind(body, project.dialect).program
    if statements is None:
        return None
    for node in (node for statement in statements for node in walk(statement)):
        if isinstance(node, _ALIASES + _JUMPS):
            return None
        if isinstance(node, n.Assignment) and node.kind in (n.AssignmentKind.REFERENCE, n.AssignmentKind.ATTEMPT):
            return None
        if isinstance(node, n.Call) and node.called.upper() == "ADR":
            return None
    return statements


@lru_cache(maxsize=2)
def all_nodes(instance: Instance) -> list[n.Node] | None:
    """The statements and expressions of all bodies of a POU, its actions and charts, if they alone see the variables.

    Variables may also be reached by references. None where not all is known.
    """
    sole = sole_statements(instance)
    if sole is not None:
        return [*sole]
    pou, project = instance.unit.pou, instance.controller.project
    if pou.methods or instance.unit.base is not None:
        return None
    if pou.kind is PouKind.PROGRAM and is_named_elsewhere(pou, project):
        return None
    named = [*(action.body for action in pou.actions), *(transition.body for transition in pou.transitions)]
    bodies = [*pou.bodies, *(body for body in named if body is not None)]
    found: list[n.Node] = []
    while bodies:
        bound = bind(bodies.pop(), project.dialect)
        nodes = _listed(bound.body, project.dialect) if isinstance(bound.body, IlBody) else bound.trees
        if nodes is None or bound.unknown or bound.helpers:
            return None
        if any(_is_divided(texts.chart) for texts in bound.charts):
            return None
        found += nodes
        bodies += [body for texts in bound.charts for body in texts.bodies]
    return found


def _listed(body: IlBody, dialect: Dialect) -> Sequence[n.Statement] | None:
    """Return what an instruction list does as statements; None where structured text has no words for its jumps."""
    tree = statements_of(body.text, dialect)
    return tree.statements if tree is not None else None


def _is_divided(chart: SfcNetwork) -> bool:
    """True if a chart has parts that are executed in another way than its steps."""
    return bool(chart.partial_charts or chart.permanent or any(step.macro for step in chart.steps))


_WRITTEN = {"R_TRIG": ("q",), "F_TRIG": ("q",), "CTU": ("q",), "CTD": ("q",), "CTUD": ("qu", "qd")}
"""Members that a call of a standard block writes in any case, without looking at the old value.

Not Q of a timer, which tells it that its time is over already, and not CV, from which a counter goes on.
"""

_NOT_READ = {"TON": ("et",), "TOF": ("et",), "TP": ("et",)}
"""Members that a call may write, but does not look at."""


def dead_cells(instance: Instance, observed: Collection[str]) -> list[tuple[list[Any], int, Value | None]]:
    """Return the cells of variables of a POU that no scan reads before it writes them, and any value for each.

    `observed` (paths) are those that are looked at when a scan has ended. Members of structures and of instances of
    standard function blocks are variables too. None where other bodies may see them (`sole_statements`).
    """
    statements = sole_statements(instance)
    if statements is None:
        return []
    reading = _Reading(instance)
    reading.body(statements, observed)
    frame = instance.frame
    found: list[tuple[list[Any], int, Value | None]] = []
    for path, variable, cells, slot in leaves(frame):
        root = frame.layout.find(path.partition(".")[0])
        if root is None or root.direction not in (Direction.LOCAL, Direction.OUTPUT):
            continue
        if not isinstance(variable.type, ScalarType) or variable.type.family is Family.SPECIAL:
            continue
        if not reading.is_exposed(path.casefold()):
            found.append((cells, slot, default(variable.type)))
    return found


@dataclass
class _Reading:
    """Goes through statements in the order of their execution, and finds what is read before it is written.

    `exposed` are the paths of that, in lower case; a set `written` goes along: what has been written on every way.
    `ends` are those sets where the body ends.
    """

    instance: Instance
    exposed: set[str] = field(default_factory=set)
    ends: list[set[str]] = field(default_factory=list)

    def body(self, statements: Sequence[n.Statement], observed: Collection[str]) -> None:
        """All of it; whoever observes variables reads them where it ends."""
        written: set[str] = set()
        if self.all(statements, written):
            self.ends.append(written)
        for path in observed:
            for written in self.ends:
                self._read_path(path.casefold().replace('"', "").replace("#", "").split("."), written)

    def is_exposed(self, path: str) -> bool:
        """Return True if a variable, a part of it, or all that it is a part of is read before it is written."""
        return path in self._around or any(each in self.exposed for each in _upwards(path))

    @cached_property
    def _around(self) -> set[str]:
        """Return the variables with a part that is read before it is written."""
        return {around for path in self.exposed for around in _upwards(path)}

    # -- statements

    def all(self, statements: Sequence[n.Statement], written: set[str]) -> bool:
        """Follow statements in their order; return True if their end is reached."""
        return all(self.one(statement, written) for statement in statements)

    def one(self, statement: n.Statement, written: set[str]) -> bool:
        """Follow one statement; return False if the next one is not reached."""
        match statement:
            case n.Assignment(target=target, value=value, kind=kind):
                self.read(value, written)
                path = plain_path(target)
                if kind is n.AssignmentKind.ASSIGN and path is not None:
                    written.add(self._canonical(path))
                else:
                    self.read(target, written)
            case n.CallStatement(call=call):
                self._call(call, written)
            case n.If(branches=branches, otherwise=otherwise):
                ways = []
                for branch in branches:
                    self.read(branch.condition, written)
                    ways.append(branch.statements)
                return self._ways([*ways, otherwise or ()], written)
            case n.Case(selector=selector, branches=cases, otherwise=otherwise):
                self.read(selector, written)
                return self._ways([*(case.statements for case in cases), otherwise or ()], written)
            case n.RegionBlock(statements=statements):
                return self.all(statements, written)
            case n.ReturnStatement():
                self.ends.append(written)
                return False
            case n.Exit() | n.Continue():
                return False  # to the end of a loop, behind which counts what was written before it anyway
            case n.For() | n.While() | n.Repeat():
                for part in children(statement):
                    if part not in statement.statements:
                        self.read(part, written)
                # a loop may make no turn at all, so nothing that it writes is sure to be written behind it
                self.all(statement.statements, set(written))
            case n.Empty():
                pass
            case _:
                self.read(statement, written)
        return True

    def _ways(self, ways: Sequence[Sequence[n.Statement]], written: set[str]) -> bool:
        """Of what one of several ways writes, only that counts which all write from which one comes back."""
        ends = []
        for statements in ways:
            own = set(written)
            if self.all(statements, own):
                ends.append(own)
        if not ends:
            return False
        written |= set.intersection(*ends)
        return True

    # -- expressions

    def read(self, node: n.Node, written: set[str]) -> None:
        """Count everything in an expression as read."""
        if isinstance(node, n.Call):
            self._expose(_root(node.callee), written)
        path = plain_path(node)
        if path is not None:
            self._read_path(path, written)
            return
        for part in children(node):
            self.read(part, written)

    def _read_path(self, path: Sequence[str], written: set[str]) -> None:
        for start in range(len(path)):  # the first names may be those of a namespace, or of the POU itself
            self._expose(self._canonical(path[start:]), written)

    def _expose(self, path: str, written: set[str]) -> None:
        # what is written as a whole is written in its parts: ``a := b`` writes ``a.x`` too
        if not any(each in written for each in _upwards(path)):
            self.exposed.add(path)

    def _canonical(self, path: Sequence[str]) -> str:
        """Return the path of a variable by the names that layouts have for pins."""
        layout: Layout | None = self.instance.frame.layout
        parts = []
        for name in path:
            variable = layout.find(name) if layout is not None else None
            parts.append(variable.name.casefold() if variable is not None else name)
            layout = variable.type.layout if variable and isinstance(variable.type, StructureType) else None
        return ".".join(parts)

    def _call(self, node: n.Expression, written: set[str]) -> None:
        """A call as a statement: of a standard block its pins are known, of anything else all is read."""
        layout = self._standard_block(node)
        if layout is None or not isinstance(node, n.Call):
            self.read(node, written)
            self._expose(_root(node), written)
            return
        name = _root(node)
        given = set()
        for argument in node.arguments:
            if argument.value is None or argument.name is None:
                continue
            self.read(argument.value, written)
            pin = layout.find(argument.name.identifier)
            if pin is not None and not argument.output:
                given.add(f"{name}.{pin.name.casefold()}")
        written |= given
        kind = layout.name.upper()
        always = _WRITTEN.get(kind, ())
        for pin in layout.fields:
            key = pin.name.casefold()
            if not pin.hidden and key not in always and key not in _NOT_READ.get(kind, ()):
                self._expose(f"{name}.{key}", written)
        written.update(f"{name}.{key}" for key in always)

    def _standard_block(self, node: n.Expression) -> Layout | None:
        """Return the layout of a standard function block whose instance is called with named arguments only."""
        if not isinstance(node, n.Call) or not node.called:
            return None
        variable = self.instance.frame.layout.find(node.called)
        if variable is None or not isinstance(variable.type, StructureType):
            return None
        layout = variable.type.layout
        block = self.instance.controller.library.block_of(layout)
        if block is None or block.run is None:
            return None
        known = all(a.name is not None and layout.find(a.name.identifier) is not None for a in node.arguments)
        return layout if known else None


def _root(node: n.Node) -> str:
    """Return the name in front of a path, in lower case; empty: there is none."""
    while not isinstance(node, n.Name):
        inner = next(iter(children(node)), None)
        if inner is None:
            return ""
        node = inner
    return node.identifier.casefold()


def _upwards(path: str) -> Iterator[str]:
    """``a.b.c``, ``a.b``, ``a``."""
    while path:
        yield path
        path = path.rpartition(".")[0]
