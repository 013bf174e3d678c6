"""Networks to text: an FBD or LD network as statements of structured text."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.effects import path_of
from plcopen_sfc.languages.networks.blocks import BlockReader
from plcopen_sfc.languages.networks.network_graph import Graph, Source, apart, block_outputs, is_fed
from plcopen_sfc.languages.networks.results import NetworkExpression, NetworkProblem, NetworkStatements
from plcopen_sfc.languages.networks.wires import TRUE, Factor, Product, Wires, expression_of, inverted, meeting
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.model import network as net
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.text import Text, plain


def body_statements(
    body: FbdBody | LdBody,
    dialect: Dialect = Dialect.IEC,
    *,
    taken: Iterable[str] = (),
    keeps: bool = False,
) -> NetworkStatements:
    """Return an FBD or LD body as statements, in the order of execution.

    `taken` are names that helpers must not have. `keeps`: what boxes give is kept in variables, from one cycle to the
    next.
    """
    return network_statements(body.networks, dialect, taken=taken, keeps=keeps)


def network_statements(
    networks: Iterable[net.LogicNetwork],
    dialect: Dialect = Dialect.IEC,
    *,
    taken: Iterable[str] = (),
    keeps: bool = False,
) -> NetworkStatements:
    """Networks as statements; see `body_statements`."""
    networks, original = apart(list(networks))
    reader = NetworkReader([network.nodes for network in networks], dialect, taken=taken, keeps=keeps)
    for network in networks:
        reader.comment(None, network.title, network.comment)
    reader.run()
    return reader.result() if not original else _with_ids(reader.result(), original)


def _with_ids(result: NetworkStatements, original: Mapping[int, int]) -> NetworkStatements:
    """Return the result with the ids that the elements have in their networks, in messages too."""

    def named(problem: NetworkProblem) -> NetworkProblem:
        message = _MENTION.sub(lambda m: f"{m[1]} {original.get(int(m[2]), m[2])}", problem.message)
        node = original.get(problem.node, problem.node) if problem.node is not None else None
        return replace(problem, message=message, node=node)

    return replace(
        result,
        problems=tuple(map(named, result.problems)),
        comments=tuple(
            (original.get(node, node) if node is not None else None, text) for node, text in result.comments
        ),
        open_ends=tuple((original.get(node, node), value) for node, value in result.open_ends),
    )


_MENTION = re.compile(r"\b(element|contact) (\d+)")


def reader_of_chart(
    chart: SfcNetwork,
    nodes: Sequence[net.Node],
    dialect: Dialect,
    *,
    taken: Iterable[str] = (),
    also_used: Iterable[net.InputPin] = (),
    keeps: bool = False,
) -> NetworkReader:
    """Return a reader of `nodes`, some of the elements drawn in a chart."""
    steps = {step.id: step.name for step in chart.steps}
    return NetworkReader([nodes], dialect, steps=steps, taken=taken, also_used=also_used, keeps=keeps)


class NetworkReader:
    """Executes the elements of a network symbolically, in their order, and writes down what happens."""

    def __init__(
        self,
        networks: Iterable[Sequence[net.Node]],
        dialect: Dialect,
        *,
        steps: Mapping[int, str] | None = None,
        taken: Iterable[str] = (),
        also_used: Iterable[net.InputPin] = (),
        keeps: bool = False,
    ) -> None:
        self._keeps = keeps
        self.graph = Graph(networks, steps)
        self._outer = [self.graph.resolve(None, pin) for pin in also_used]
        self.graph.uses.update(source for sources in self._outer for source in sources)
        self.wires = Wires(self.graph, dialect, lambda: [*taken, *_names(self.graph), *self.graph.steps.values()])
        self.comments: list[tuple[int | None, str]] = []
        self.open_ends: list[tuple[int, Expression]] = []
        self._blocks = BlockReader(self.graph, self.wires)
        self._step_flag = "X" if dialect in (Dialect.IEC, Dialect.SCL) else "x"

    def run(self) -> None:
        """Execute every element; if values are kept, in the order in which the pins `also_used` need them."""
        with collecting_rarely():
            pins = [source for sources in self._outer for source in sources]
            for node in self.graph.execution_for(pins) if self._keeps and pins else self.graph.execution():
                self._execute(node)
            self._find_open_ends()

    def result(self) -> NetworkStatements:
        """Return the executed elements as statements."""
        for number, _ in self.open_ends:
            self.wires.problem("its value leads nowhere", number)
        return NetworkStatements(
            helpers=tuple(self.wires.helpers),
            instances=self.wires.instances,
            comments=tuple(self.comments),
            problems=(*self.graph.problems, *self.wires.problems),
            tree=n.Statements(tuple(self.wires.statements)),
            open_ends=tuple(self.open_ends),
        )

    def run_for_value(self) -> NetworkExpression:
        """Execute every element; the result is the value at the first of the pins `also_used`."""
        self.run()
        product = self._meet(self._outer[0])
        read = self.result()
        problems = read.problems
        if product is None:
            problems = (*problems, NetworkProblem("there is no value"))
        return NetworkExpression(
            read.helpers,
            read.instances,
            read.comments,
            problems,
            tree=expression_of(product) if product is not None else None,
            before=read.tree.statements,
        )

    def outer_values(self) -> list[Expression | None]:
        """Return the values at the pins `also_used`, when every element was executed."""
        products = [self._meet(sources) for sources in self._outer]
        return [expression_of(product) if product is not None else None for product in products]

    def acts(self, node: net.Node) -> bool:
        """True if executing an element does something, whoever uses its value."""
        if isinstance(node, net.Block):
            return self._blocks.acts(node)
        return not isinstance(
            node,
            net.InputVariable | net.Contact | net.LeftPowerRail | net.RightPowerRail | net.Continuation | net.Connector,
        )

    # -- values

    def _value(self, node: net.Node, pin: int = 0) -> Product | None:
        """Return the value at an input; None where there is none."""
        given = self.graph.pins(node)[pin]
        if not given.connections and given.expression is not None:
            expression = self.wires.expression(given.expression, node.id)
            return (Factor((node.id, "pin", pin), expression),)
        return self._meet(self.graph.sources(node)[pin])

    def _meet(self, sources: Sequence[Source]) -> Product | None:
        products = [self._take(source) for source in sources]
        there = [product for product in products if product is not None]
        return meeting(there, self.wires.meetings) if there else None

    def _take(self, source: Source) -> Product | None:
        step = self.graph.steps.get(source[0])
        if step is not None and source[0] not in self.graph.nodes:
            return (Factor(source, n.Member(n.Name(step), n.Name(self._step_flag))),)
        if not self.wires.is_stored(source):
            node = self.graph.nodes[source[0]]
            if isinstance(node, net.InOutVariable):
                return (Factor(("last", source), self._passed_on(node)),)
            if isinstance(node, net.Block):
                last = self._blocks.last_output(node, source[1] or "")
                if last is not None:
                    return (Factor(("last", source), last),)
        return self.wires.take(source)

    def _modified(self, node: net.Node, value: Expression, *, negated: bool, edge: net.Edge) -> Expression:
        """Return a value as it leaves an element that inverts it or watches for its edge."""
        if negated and edge is not net.Edge.NONE:
            text = "it is negated and watches for an edge: taken as the edge of the negated value"
            self.wires.problem(text, node.id, Severity.WARNING)
        return self.wires.edge(edge, inverted(value) if negated else value, (node.id, None))

    # -- elements

    def _execute(self, node: net.Node) -> None:
        """Add what an element does to the statements, in its turn, and put its value on the wires that leave it."""
        self.comment(node.id, node.comment)
        if isinstance(node, net.Block):
            parameters = node.parameters
            pins = (*parameters.inputs, *parameters.in_outs, *parameters.outputs)
            self.comment(node.id, *(variable.comment for variable in pins))
        if isinstance(node, net.Block):
            self._blocks.execute(node, self._value)
            for variable in block_outputs(node) if self._keeps else ():
                self.wires.keep((node.id, variable.name))
        elif isinstance(node, net.InputVariable):
            self._input(node)
        elif isinstance(node, net.Contact):
            self._contact(node)
        elif isinstance(node, net.OutputVariable):
            self._assign(node, node.expression, negated=node.negated, edge=node.edge, storage=node.storage)
        elif isinstance(node, net.Coil):
            flow = (node.id, None)
            self._assign(
                node, node.variable, negated=node.negated, edge=node.edge, storage=node.storage, passes_on=flow
            )
        elif isinstance(node, net.InOutVariable):
            if is_fed(node.input) or not self.graph.uses[node.id, None]:
                self._assign(node, node.expression, negated=node.negated_in, edge=node.edge_in, storage=node.storage_in)
            elif node.input is not None:
                self.wires.problem(f"nothing leads here, so {node.expression} is only read", node.id, Severity.INFO)
            self.wires.store((node.id, None), (Factor((node.id, None), self._passed_on(node)),), lazy=True)
        elif isinstance(node, net.LeftPowerRail):
            self.wires.store((node.id, None), ())
        elif isinstance(node, net.Continuation):
            product = self._value(node) if self.graph.pins(node) else None
            self.wires.store((node.id, None), product)
        elif isinstance(node, net.Jump | net.Return):
            self._leave(node)
        elif isinstance(node, net.Label):
            self.wires.execute(n.LabelStatement(n.Name(node.label)))
        elif isinstance(node, net.CommentBox):
            self.comment(node.id, node.content)
        elif isinstance(node, net.ErrorBox):
            self.wires.problem(f"an error of the tool that made the file: {plain(node.content)}", node.id)
        elif isinstance(node, net.VendorElement):
            self._vendor_element(node)
        else:
            # the wire of a connector goes on at its continuation, and the right power rail does nothing
            assert isinstance(node, net.Connector | net.RightPowerRail)  # noqa: S101

    def _input(self, node: net.InputVariable) -> None:
        if node.storage is not net.Storage.NONE:
            self.wires.problem(f"an input cannot {node.storage.value} anything", node.id)
        expression = self.wires.expression(node.expression, node.id)
        value = self._modified(node, expression, negated=node.negated, edge=node.edge)
        source = (node.id, None)
        self.wires.store(source, (Factor(source, value),), lazy=value is expression)

    def _contact(self, node: net.Contact) -> None:
        if node.storage is not net.Storage.NONE:
            self.wires.problem(f"a contact cannot {node.storage.value} anything", node.id)
        before = self._value(node)
        if before is None:
            self.wires.problem("nothing leads to this contact; taken as connected to the left power rail", node.id)
            before = ()
        variable = self.wires.expression(node.variable, node.id)
        value = self._modified(node, variable, negated=node.negated, edge=node.edge)
        source = (node.id, None)
        self.wires.store(source, (*before, Factor(source, value)))

    def _assign(
        self,
        node: net.Node,
        target: str,
        *,
        negated: bool,
        edge: net.Edge,
        storage: net.Storage,
        passes_on: Source | None = None,
    ) -> None:
        """Write the input of an element to its variable. The input of a coil is also its output, at `passes_on`."""
        variable = self.wires.expression(target, node.id)
        written = frozenset({path_of(variable)})
        self.wires.prepare(written, self.graph.sources(node)[0])
        product = self._value(node)
        if passes_on is not None:
            # what it passes on is what came before it, also where that reads the variable: then it is kept before
            self.wires.store(passes_on, product)
            self.wires.prepare(written)
            product = self.wires.value(passes_on)
        if product is None:
            if not self._blocks.is_written(node):
                self.wires.problem(f"nothing leads here, so {target} is not written", node.id)
            return
        value = self._modified(node, expression_of(product), negated=negated, edge=edge)
        self.wires.execute(self._blocks.assignment(variable, value, storage))

    def _passed_on(self, node: net.InOutVariable) -> Expression:
        if node.storage_out is not net.Storage.NONE or node.edge_out is not net.Edge.NONE:
            self.wires.problem("its output cannot store or watch for an edge", node.id)
        variable = self.wires.expression(node.expression, node.id)
        return inverted(variable) if node.negated_out else variable

    def _leave(self, node: net.Jump | net.Return) -> None:
        statement: Statement = n.ReturnStatement()
        if isinstance(node, net.Jump):
            is_codesys = self.wires.dialect in (Dialect.CODESYS, Dialect.TWINCAT)
            statement = n.Goto(n.Name(node.label), "JMP" if is_codesys else "GOTO")
            if self.wires.dialect is Dialect.IEC:
                text = "structured text of IEC 61131-3 has no jumps; GOTO is of SCL"
                self.wires.problem(text, node.id, Severity.WARNING)
        product = self._value(node)
        if product is None:
            self.wires.problem("nothing leads here; taken as unconditional", node.id, Severity.WARNING)
        condition = expression_of(product) if product is not None else TRUE
        if condition != TRUE:
            statement = n.If((n.Branch(condition, (statement,)),))
        self.wires.execute(statement)

    def comment(self, number: int | None, *texts: Text | None) -> None:
        """Keep what people have written."""
        plain_texts = (plain(text) for text in texts if text is not None)
        self.comments += [(number, text) for text in plain_texts if text.strip()]

    def _vendor_element(self, node: net.VendorElement) -> None:
        if node.element_type == "networktitle":
            self.comment(node.id, node.alternative_text)
        elif node.parameters is not None or node.attributes.keys() - {"BoxInputFlagsSupported"} or not node.attributes:
            text = plain(node.alternative_text)
            self.wires.problem(f"an element that only its tool understands: {text}", node.id)

    # -- what leads nowhere

    def _find_open_ends(self) -> None:
        for node in self.graph.nodes.values():
            sources: list[Source] = []
            if isinstance(node, net.InputVariable | net.Contact | net.Continuation):
                sources = [(node.id, None)]
            elif isinstance(node, net.Block) and not self._blocks.acts(node):
                sources = [(node.id, variable.name) for variable in block_outputs(node)]
                sources = [] if any(self.graph.uses[source] for source in sources) else sources[:1]
            for source in sources:
                if not self.graph.uses[source] and self.wires.is_stored(source):
                    product = self.wires.take(source)
                    if product is None:
                        self.wires.problem("it has no value, and leads nowhere", node.id)
                    else:
                        self.open_ends.append((node.id, expression_of(product)))


_WORD = re.compile(r"[^\W\d]\w*")


def _names(graph: Graph) -> set[str]:
    """Return all words in the texts of a network."""
    texts: set[str | None] = set()
    for node in graph.nodes.values():
        fields = node.__dict__  # of a model, and without what pydantic does for a field that is missing
        texts.update(map(fields.get, ("expression", "variable", "instance", "label", "code")))
        texts.update(pin.expression for pin in graph.pins(node))
        if isinstance(node, net.Block):
            texts.update(v.output.expression for v in node.parameters.outputs if v.output is not None)
    return {word for text in texts if text for word in _WORD.findall(text)}
