"""Conditions of every kind as Boolean expressions: texts, names, bodies, and logic that is wired to a transition.

Formats that hold no drawings have the structured text of drawn conditions and bodies.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import replace

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.il import instructions, result_expression, statements_with_result
from plcopen_sfc.languages.il_problems import instruction_problems
from plcopen_sfc.languages.networks.exported_networks import SOURCES, network_statements
from plcopen_sfc.languages.networks.network_graph import Graph, is_fed
from plcopen_sfc.languages.networks.network_reading import NetworkReader, body_statements, reader_of_chart
from plcopen_sfc.languages.networks.results import NetworkExpression, NetworkProblem, NetworkStatements
from plcopen_sfc.languages.networks.wires import inverted
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Assignment, Name, Statements
from plcopen_sfc.languages.st.parsing import parse_expression, parse_statements
from plcopen_sfc.languages.words import is_plain
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Coil, Node
from plcopen_sfc.model.pou import NamedTransition
from plcopen_sfc.model.sfc import Body, BodyCondition, Condition, SfcNetwork, Transition
from plcopen_sfc.reachability import reached


def shown_condition(
    chart: SfcNetwork, transition: Transition, dialect: Dialect, objects: Iterable[NamedTransition]
) -> tuple[str, bool] | None:
    """Return the condition as an expression, or, where blocks are called before it, as statements (True).

    None where no text expresses it: it needs undeclared variables, such as for edges.
    """
    found = condition_expression(chart, transition, dialect, transitions=objects)
    if found.tree is None or found.helpers or found.obstacles:
        return None
    if not found.before:
        return print_node(found.tree), False
    if any(isinstance(statement, Assignment) for statement in found.before):
        return None  # the assignment that gives the condition could not be found among several
    name = transition.name if is_plain(transition.name) else "Condition"
    statements = Statements((*found.before, Assignment(Name(name), found.tree)))
    return print_node(statements), True


def shown_named_condition(transition: NamedTransition, dialect: Dialect) -> tuple[str, bool] | None:
    """Return the condition of a transition object that is drawn."""
    chart = SfcNetwork(transitions=[Transition(id=0, name=transition.name)])
    chart.transitions[0].condition = NamedCondition(name=transition.name)
    return shown_condition(chart, chart.transitions[0], dialect, [transition])


def shown_body(body: FbdBody | LdBody, dialect: Dialect) -> str | None:
    """Return the body as statements; None where they cannot express it, or need undeclared variables."""
    found = body_statements(body, dialect)
    if found.helpers or found.obstacles:
        return None
    return print_node(found.tree) or None


def condition_expression(
    chart: SfcNetwork,
    transition: Transition,
    dialect: Dialect = Dialect.IEC,
    *,
    transitions: Iterable[NamedTransition] = (),
    taken: Iterable[str] = (),
) -> NetworkExpression:
    """Return the condition of a transition as an expression, whatever it is given as.

    `transitions` are the transition objects of the POU (`Pou.transitions`): the expression of one that the condition
    names is taken; one that is not among them is in the expression by its name. `NetworkExpression.before` has what
    must be executed before the expression (function blocks, edges). `taken` as in `body_statements`.
    """
    if transition.condition is None:
        return _failed("the transition has no condition")
    return condition_reader(chart, dialect, transitions=transitions, taken=[*taken])(transition.condition)


def condition_reader(
    chart: SfcNetwork,
    dialect: Dialect = Dialect.IEC,
    *,
    transitions: Iterable[NamedTransition] = (),
    taken: Collection[str] = (),
) -> Callable[[Condition], NetworkExpression]:
    """Return `condition_expression` as a function, for many conditions of a chart that does not change meanwhile.

    The logic drawn in the chart is looked through once, not for each of them. `taken` may grow
    meanwhile: each reading looks at it again.
    """
    return _ConditionReader(chart, dialect, {t.name.casefold(): t for t in transitions}, taken).read


def chart_statements(
    chart: SfcNetwork, dialect: Dialect = Dialect.IEC, *, taken: Iterable[str] = ()
) -> NetworkStatements:
    """Return the effects of the logic drawn in a chart besides feeding conditions: it is executed in every cycle.

    Function blocks and edges that feed conditions only are left to `condition_expression`.
    """
    pins = [t.condition.input for t in chart.transitions if isinstance(t.condition, WiredCondition)]
    whole = reader_of_chart(chart, chart.logic, dialect, taken=taken)
    feeding = _feeding(whole, [whole.graph.resolve(None, pin) for pin in pins])
    acting = [node for node in chart.logic if node.id not in feeding and whole.acts(node)]
    needed = {node.id for node in acting} | _feeding(whole, [s for node in acting for s in whole.graph.sources(node)])
    left = [node for node in chart.logic if node.id in needed or node.id not in feeding]
    reader = reader_of_chart(chart, left, dialect, taken=taken)
    reader.run()
    return reader.result()


def feeding_nodes(chart: SfcNetwork, condition: Condition | None, dialect: Dialect = Dialect.IEC) -> list[Node]:
    """Return the elements of the logic drawn in a chart that a condition depends on."""
    if not isinstance(condition, WiredCondition):
        return []
    whole = reader_of_chart(chart, chart.logic, dialect)
    needed = _feeding(whole, [whole.graph.resolve(None, condition.input)])
    return [node for node in chart.logic if node.id in needed]


def kept_conditions(
    chart: SfcNetwork,
    dialect: Dialect = Dialect.IEC,
    *,
    transitions: Iterable[NamedTransition] = (),
    taken: Iterable[str],
) -> tuple[NetworkStatements, dict[int, n.Expression]]:
    """The boxes that are drawn before conditions as statements, and each such condition by the id of its transition.

    Outputs of boxes are kept in variables, so that the statements can be executed at another time than the conditions
    are evaluated; contacts and variables that are wired directly are part of the conditions. A box that feeds several
    conditions is executed once. Conditions that cannot be read completely are left out.
    """
    names = {each.name.casefold(): each for each in transitions}
    known = set(taken)
    found: dict[int, n.Expression] = {}
    parts: list[NetworkStatements] = []
    wired = [(t, t.condition) for t in chart.transitions if isinstance(t.condition, WiredCondition)]
    wired = [(t, condition) for t, condition in wired if condition.input.connections]
    pins = [condition.input for _, condition in wired]
    # Read twice: the whole logic tells which elements the conditions need, and only these are executed. A box that
    # feeds an action must not run again here.
    whole = reader_of_chart(chart, chart.logic, dialect)
    needed = _feeding(whole, [whole.graph.resolve(None, pin) for pin in pins])
    nodes = [node for node in chart.logic if node.id in needed]
    reader = reader_of_chart(chart, nodes, dialect, taken=known, also_used=pins, keeps=True)
    reader.run()
    values = reader.outer_values()
    if reader.result().complete:
        parts.append(reader.result())
        for (transition, wire), tree in zip(wired, values, strict=True):
            if tree is not None:
                found[transition.id] = inverted(tree) if wire.negated else tree
    bodies: dict[int, n.Expression | None] = {}
    for transition in chart.transitions:
        condition = transition.condition
        if not isinstance(condition, NamedCondition | BodyCondition):
            continue
        name, body = condition.name, condition.body if isinstance(condition, BodyCondition) else None
        if isinstance(condition, NamedCondition) and name.casefold() in names:
            body = names[name.casefold()].body
        if not isinstance(body, FbdBody | LdBody):
            continue
        # conditions that share a transition object share the state of its boxes: it is executed once
        if id(body) not in bodies:
            known.update(helper.name for part in parts for helper in part.helpers)
            read = body_statements(body, dialect, taken=known, keeps=True)
            result = _result_of(read, name)
            bodies[id(body)] = result.tree if result.complete else None
            if result.tree is not None and result.complete:
                parts.append(replace(read, tree=n.Statements(result.before)))
        tree = bodies[id(body)]
        if tree is not None:
            found[transition.id] = inverted(tree) if condition.negated else tree
    statements = tuple(statement for part in parts for statement in part.tree.statements)
    helpers = tuple(helper for part in parts for helper in part.helpers)
    instances = {name: type_ for part in parts for name, type_ in part.instances.items()}
    return NetworkStatements(helpers, instances, tree=n.Statements(statements)), found


def wired_steps(chart: SfcNetwork) -> set[int]:
    """Return the ids of the elements from which wires lead into the logic drawn in a chart, or to a condition."""
    graph = Graph([chart.logic])
    wires = {wire.source for node in chart.logic for pin in graph.pins(node) for wire in pin.connections}
    conditions = [each.condition for each in chart.transitions] + [each.condition for _, each in chart.associations()]
    pins = [condition.input for condition in conditions if isinstance(condition, WiredCondition)]
    return wires | {wire.source for pin in pins for wire in pin.connections}


def _feeding(reader: NetworkReader, pins: Iterable[Iterable[tuple[int, str | None]]]) -> set[int]:
    """Return the ids of all elements upstream of `pins`."""
    nodes, sources_of = reader.graph.nodes, reader.graph.sources

    def among(pins: Iterable[Iterable[tuple[int, str | None]]]) -> list[int]:
        return [source for sources in pins for source, _ in sources if source in nodes]

    return reached(among(pins), lambda number: among(sources_of(nodes[number])))


class _ConditionReader:
    def __init__(
        self,
        chart: SfcNetwork,
        dialect: Dialect,
        transitions: dict[str, NamedTransition],
        taken: Collection[str],
    ) -> None:
        self._chart = chart
        self._dialect = dialect
        self._transitions = transitions
        self._taken = taken
        self._being_read: set[str] = set()
        self._whole: NetworkReader | None = None
        self._places: dict[int, list[int]] = {}

    def read(self, condition: Condition) -> NetworkExpression:
        """Any condition as an expression."""
        if isinstance(condition, Expression):
            found = self._text(condition.text)
        elif isinstance(condition, NamedCondition):
            found = self._named(condition.name)
        elif isinstance(condition, BodyCondition):
            found = self._body(condition.body, condition.name)
        else:
            found = self._wired(condition)
        if condition.negated and found.tree is not None:
            found = replace(found, tree=inverted(found.tree))
        return found

    def _text(self, text: str) -> NetworkExpression:
        # CODESYS exports the semicolon behind a condition if the user has typed one
        parsed = parse_expression(text.rstrip().removesuffix(";"), self._dialect)
        return NetworkExpression(
            tree=parsed.tree, problems=tuple(NetworkProblem(f"{text!r}: {p.message}") for p in parsed.problems)
        )

    def _named(self, name: str) -> NetworkExpression:
        known = self._transitions.get(name.casefold())
        if known is None or known.body is None:
            return self._text(name)
        if name.casefold() in self._being_read:
            return _failed(f"the condition {name!r} depends on itself")
        self._being_read.add(name.casefold())
        found = self._body(known.body, name)
        self._being_read.remove(name.casefold())
        return found

    def _body(self, body: Body, name: str) -> NetworkExpression:
        if isinstance(body, StBody):
            return self._statements(body.text, name)
        if isinstance(body, FbdBody | LdBody):
            read = body_statements(body, self._dialect, taken=self._taken)
            return _result_of(read, name)
        tree = result_expression(body.text, self._dialect, stored_in=name) if isinstance(body, IlBody) else None
        if tree is not None:
            return NetworkExpression(tree=tree)
        calling = statements_with_result(body.text, self._dialect, stored_in=name) if isinstance(body, IlBody) else None
        if calling is not None:
            before, tree = calling
            return NetworkExpression(tree=tree, before=before)
        drawn = network_statements(body.content) if isinstance(body, OpaqueBody) and body.source in SOURCES else None
        if drawn is not None:
            return self._statements(drawn, name)
        more = ""
        faults = instruction_problems(body.text, self._dialect) if isinstance(body, IlBody) else []
        if faults:
            more = f": {faults[0].message}"
        elif isinstance(body, IlBody) and any(each.label for each in instructions(body.text, self._dialect)):
            more = ": jumps have to lead forward, and a value is loaded behind each label: tools do not agree without"
        return _failed(f"a condition in {body.language} cannot be read as an expression{more}")

    def _statements(self, text: str, name: str) -> NetworkExpression:
        """ST: an expression, with ``:=`` before it or a semicolon behind it as tools write it, or statements."""
        stripped = text.strip().removeprefix(":=")
        as_expression = self._text(stripped)
        if as_expression.complete:
            return as_expression
        parsed = parse_statements(text, self._dialect)
        problems = tuple(NetworkProblem(f"{text!r}: {p.message}") for p in parsed.problems)
        return _result_of(NetworkStatements(tree=parsed.tree, problems=problems), name)

    def _wired(self, condition: WiredCondition) -> NetworkExpression:
        pin = condition.input
        if not pin.connections:
            return self._text(pin.expression) if pin.expression else _failed("the condition is wired to nothing")
        if self._whole is None:
            self._whole = reader_of_chart(self._chart, self._chart.logic, self._dialect)
            self._places = grouped((node.id, place) for place, node in enumerate(self._chart.logic))
        needed = _feeding(self._whole, [self._whole.graph.resolve(None, pin)])
        reader = reader_of_chart(
            self._chart,
            [self._chart.logic[place] for place in sorted(p for number in needed for p in self._places[number])],
            self._dialect,
            taken=self._taken,
            also_used=[pin],
        )
        return reader.run_for_value()


def _result_of(read: NetworkStatements, name: str) -> NetworkExpression:
    """Return the condition that a body computes: what it writes to `name` last, else the value that leads nowhere."""
    statements = list(read.tree.statements)
    problems = list(read.problems)
    tree: n.Expression | None = None
    writing = [s for s in statements if isinstance(s, n.Assignment) and s.kind is n.AssignmentKind.ASSIGN]
    named = [s for s in writing if isinstance(s.target, n.Name) and s.target.identifier.casefold() == name.casefold()]
    if named or (not name and len(writing) == 1 and not read.open_ends):
        last = (named or writing)[-1]
        if last is statements[-1]:
            statements.pop()
            tree = last.value
        else:
            tree = last.target
    elif len(read.open_ends) == 1:
        tree = read.open_ends[0][1]
        problems = [p for p in problems if p.node != read.open_ends[0][0]]
    elif statements and isinstance(call := statements[-1], n.CallStatement) and isinstance(call.call, n.Call):
        tree = call.call
        statements.pop()
        text = "the value of the last call is taken as the condition"
        problems.append(NetworkProblem(text, None, Severity.WARNING))
    if tree is None:
        problems.append(NetworkProblem(f"the body does not tell which value is the condition {name}".strip()))
    return NetworkExpression(
        read.helpers, read.instances, read.comments, tuple(problems), tree=tree, before=tuple(statements)
    )


def _failed(message: str) -> NetworkExpression:
    return NetworkExpression(problems=(NetworkProblem(message),))


def is_empty_network(condition: Condition | None) -> bool:
    """True if a condition is a coil alone, which nothing leads to: S7-GRAPH takes it as satisfied."""
    if not isinstance(condition, BodyCondition) or not isinstance(condition.body, FbdBody | LdBody):
        return False
    nodes = [node for network in condition.body.networks for node in network.nodes]
    return all(isinstance(node, Coil) and not is_fed(node.input) for node in nodes)
