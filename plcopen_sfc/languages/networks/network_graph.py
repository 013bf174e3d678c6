"""The elements of a network as a graph: what feeds what, and in which order they are executed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.networks.results import NetworkProblem
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model import network as net
from plcopen_sfc.reachability import needed_first

Source = tuple[int, str | None]
"""An output: the id of an element, and the name of the pin where the element is a block."""


def block_outputs(block: net.Block) -> list[net.BlockVariable]:
    """Return the parameters of a block that wires can start from."""
    return [*block.parameters.outputs, *block.parameters.in_outs]


def block_inputs(block: net.Block) -> list[net.BlockVariable]:
    """Return the parameters of a block that wires can end at."""
    return [*block.parameters.inputs, *block.parameters.in_outs]


def is_enable(variable: net.BlockVariable) -> bool:
    """True if it is EN or ENO."""
    return variable.name.casefold() in ("en", "eno")


def is_fed(pin: net.InputPin | None) -> bool:
    """True if an input has a wire or an expression."""
    return pin is not None and bool(pin.connections or pin.expression)


class Graph:
    """The elements of a network, or of all networks of a body.

    `steps` are the ids of steps, which may feed the logic drawn in a chart.
    """

    def __init__(self, networks: Iterable[Sequence[net.Node]], steps: Mapping[int, str] | None = None) -> None:
        self.networks = list(networks)
        self.steps = steps or {}
        self.nodes: dict[int, net.Node] = {}
        self.problems: list[NetworkProblem] = []
        for node in (node for network in self.networks for node in network):
            if node.id in self.nodes:
                self.problems.append(NetworkProblem("another element has this id too", node.id))
            self.nodes.setdefault(node.id, node)
        self._connectors = self._by_name()
        self._pins: dict[int, list[net.InputPin]] = {}
        self._sources: dict[int, list[list[Source]]] = {}
        self.uses: Counter[Source] = Counter()
        for node in self.nodes.values():
            self._pins[node.id] = self._inputs(node)
            resolved = [self.resolve(node, pin) for pin in self._pins[node.id]]
            self._sources[node.id] = resolved
            # a wire to the right power rail does nothing, and that of a connector goes on at its continuation
            if not isinstance(node, net.Connector | net.RightPowerRail):
                self.uses.update(source for sources in resolved for source in sources)

    def pins(self, node: net.Node) -> list[net.InputPin]:
        """Return the inputs of an element; of a continuation, that of its connector."""
        return self._pins[node.id]

    def _inputs(self, node: net.Node) -> list[net.InputPin]:
        if isinstance(node, net.Block):
            return [variable.input or net.InputPin() for variable in block_inputs(node)]
        if isinstance(node, net.RightPowerRail):
            return node.inputs
        if isinstance(node, net.Continuation):
            connector = self._connectors.get(node.name.casefold())
            return [connector.input or net.InputPin()] if connector is not None else []
        if isinstance(
            node,
            net.OutputVariable | net.InOutVariable | net.Contact | net.Coil | net.Jump | net.Return | net.Connector,
        ):
            return [node.input or net.InputPin()]
        return []

    def sources(self, node: net.Node) -> list[list[Source]]:
        """Return where the wires at each of `pins` start; one that starts nowhere is a problem and left out."""
        return self._sources[node.id]

    def resolve(self, holder: net.Node | None, pin: net.InputPin) -> list[Source]:
        """Return where the wires start at a pin of an element; None: it belongs to none, as that of a transition."""
        found = (self._source(holder.id if holder is not None else None, wire) for wire in pin.connections)
        return [source for source in found if source is not None]

    def _source(self, holder: int | None, wire: net.Connection) -> Source | None:
        node = self.nodes.get(wire.source)
        if node is None:
            if wire.source in self.steps:
                return wire.source, None
            self.problems.append(NetworkProblem(f"a wire starts at element {wire.source}, which is not there", holder))
            return None
        if isinstance(node, net.Block):
            return self._block_source(holder, wire, node)
        if isinstance(
            node, net.InputVariable | net.InOutVariable | net.Contact | net.Coil | net.LeftPowerRail | net.Continuation
        ):
            return node.id, None
        self.problems.append(NetworkProblem(f"a wire starts at element {node.id}, which has no output", holder))
        return None

    def _block_source(self, holder: int | None, wire: net.Connection, block: net.Block) -> Source | None:
        outputs = block_outputs(block)
        for variable in outputs:
            if wire.pin is not None and variable.name.casefold() == wire.pin.casefold():
                return block.id, variable.name
        if not outputs:
            self.problems.append(NetworkProblem(f"a wire starts at element {block.id}, which has no output", holder))
            return None
        if wire.pin:
            # CODESYS names the assigned variable here when it exports the second wire from a box of a ladder
            self.problems.append(
                NetworkProblem(
                    f"a wire starts at the output {wire.pin!r} of element {block.id}, which {block.type_name} does not"
                    f" have; taken as {outputs[0].name!r}",
                    holder,
                    Severity.WARNING,
                )
            )
        return block.id, outputs[0].name

    def _by_name(self) -> dict[str, net.Connector]:
        found: dict[str, net.Connector] = {}
        continuations = [node for node in self.nodes.values() if isinstance(node, net.Continuation)]
        continued = {node.name.casefold() for node in continuations}
        for node in self.nodes.values():
            if isinstance(node, net.Connector):
                key = node.name.casefold()
                if key in found:
                    self._say(f"there are two connectors {node.name!r}", node)
                if key not in continued:
                    self._say(f"connector {node.name!r} goes on nowhere", node)
                if not is_fed(node.input):
                    self._say(f"nothing leads to connector {node.name!r}", node)
                found.setdefault(key, node)
        for node in continuations:
            if node.name.casefold() not in found:
                self._say(f"continuation {node.name!r} comes from nowhere", node)
        return found

    def _say(self, message: str, node: net.Node) -> None:
        self.problems.append(NetworkProblem(message, node.id))

    def type_of(self, source: Source) -> str | None:
        """Return the type of an output where the network tells it."""
        waiting, seen = [source], {source}
        while waiting:
            number, pin = waiting.pop()
            node = self.nodes.get(number)
            if node is None or isinstance(node, net.Contact | net.Coil | net.LeftPowerRail):
                return "BOOL"  # what is no element is a step
            known = _pin_type(node, pin) if isinstance(node, net.Block) else None
            if known is not None and not known.startswith("ANY"):
                return known
            if known in ("ANY_BIT", "ANY"):
                feeding = [s for sources in self._sources[number] for s in sources if s not in seen]
                waiting += feeding
                seen.update(feeding)
        return None

    def execution(self) -> Iterator[net.Node]:
        """Yield every element once, in the order of execution.

        Networks one after another; in a network first the elements with an order of execution, then the others from
        top to bottom and from left to right (in the order of the file where nothing has a place). An element that feeds
        another comes before it, but for feedback.
        """
        for_each = ((*filter(self._is_root, sorted(each, key=_sort_key(each))), *each) for each in self.networks)
        return self._fed_first(node.id for nodes in for_each for node in nodes)

    def roots(self) -> Iterator[net.Node]:
        """Yield the elements that are executed when their turn comes, in the order of execution."""
        for network in self.networks:
            yield from (root for root in sorted(network, key=_sort_key(network)) if self._is_root(root))

    def execution_for(self, sources: Iterable[Source]) -> Iterator[net.Node]:
        """The elements that these outputs need, once each: what feeds an element comes before it, but for feedback."""
        return self._fed_first(number for number, _ in sources if number in self.nodes)

    def _is_root(self, node: net.Node) -> bool:
        """True if it is executed when its turn comes, not only when something needs its value."""
        if (node.execution_order or 0) > 0:
            return True
        if isinstance(node, net.Block):
            outputs = block_outputs(node)
            if any(v.output is not None and v.output.expression for v in outputs):
                return True
            used = any(self.uses[node.id, variable.name] for variable in outputs)
            acts = node.instance is not None or node.call in _ACTING
            acts = acts or any(is_memory_pin(node, variable) for variable in node.parameters.inputs)
            return acts or (not used and standard_block(node.type_name) is None)
        return isinstance(node, net.OutputVariable | net.Coil | net.Jump | net.Return | net.Label) or (
            isinstance(node, net.InOutVariable) and is_fed(node.input)
        )

    def _fed_first(self, starts: Iterable[int]) -> Iterator[net.Node]:
        def feeding(number: int) -> list[int]:
            return [source for sources in self._sources[number] for source, _ in sources if source in self.nodes]

        return (self.nodes[number] for number in needed_first(starts, feeding))


def _pin_type(block: net.Block, pin: str | None) -> str | None:
    if pin is not None and pin.casefold() == "eno":
        return "BOOL"
    if block.type_name.upper() in EDGE_CONTACTS | EDGE_COILS:
        return "BOOL"
    standard = standard_block(block.type_name)
    name = standard.output_name(pin) if standard is not None and pin else None
    # SEL and MUX give one of several values, so what feeds them first need not be of their type
    if standard is None or (standard.result.type == "ANY" and standard.name != "MOVE"):
        return None
    return next((p.type for p in standard.outputs if p.name == name), standard.result.type)


EDGES = frozenset({"R_TRIG", "F_TRIG"})
EDGE_CONTACTS = {"PCONTACT": True, "NCONTACT": False}
"""Contacts of S7 that conduct while their operand has an edge, by their names in capitals; True: a rising one."""
EDGE_COILS = {"PCOIL": True, "NCOIL": False}
"""Coils of S7 that are TRUE while the value before them has an edge."""
MEMORY_PINS = dict.fromkeys(("RS", "SR"), "operand") | dict.fromkeys((*EDGES, *EDGE_CONTACTS, *EDGE_COILS), "bit")
"""The pin of a block of S7 for the variable that holds its state."""


def is_memory_pin(block: net.Block, variable: net.BlockVariable) -> bool:
    """True if this pin has the variable that holds the state of a block of S7."""
    return not block.instance and variable.name.casefold() == MEMORY_PINS.get(block.type_name.upper())


_ACTING = frozenset(
    {
        net.BlockCall.FUNCTION_BLOCK,
        net.BlockCall.PROGRAM,
        net.BlockCall.ACTION,
        net.BlockCall.METHOD,
        net.BlockCall.EXECUTE,
    }
)


def _sort_key(network: Sequence[net.Node]) -> Callable[[net.Node], tuple[bool, int, float, float, int]]:
    placed = len({node.position for node in network}) > 1
    number = {node.id: index for index, node in enumerate(network)}

    def key(node: net.Node) -> tuple[bool, int, float, float, int]:
        order = node.execution_order or 0
        x, y = node.position if placed else (0, 0)
        return order <= 0, order, y, x, number[node.id]

    return key


def without_places(nodes: Iterable[net.Node]) -> list[net.Node]:
    """Return the elements of a network as a tool sees them that does not look at places."""
    return [node.model_copy(update={"position": (0.0, 0.0)}) for node in nodes]


def wires_of(node: net.Node) -> Iterator[net.Connection]:
    """Yield the wires that end at an element."""
    if isinstance(node, net.Block):
        pins = [variable.input for variable in block_inputs(node)]
    else:
        pins = [getattr(node, "input", None), *getattr(node, "inputs", ())]
    for pin in pins:
        if isinstance(pin, net.InputPin):
            yield from pin.connections


def wires_from(network: net.LogicNetwork, source: int) -> Iterator[net.Connection]:
    """Yield the wires that start at an element, by its id."""
    return (wire for node in network.nodes for wire in wires_of(node) if wire.source == source)


def written_by(node: net.Node) -> str | None:
    """Return the operand of a coil or an output variable; None for all others."""
    if isinstance(node, net.Coil):
        return node.variable
    return node.expression if isinstance(node, net.OutputVariable) else None


def function_box(number: int, name: str, pins: Iterable[net.BlockVariable]) -> net.Block:
    """Return a box of a function with numbered inputs: AND, OR, NOT."""
    inputs = [pin.model_copy(update={"name": f"IN{place}"}) for place, pin in enumerate(pins, 1)]
    outputs = [net.BlockVariable(name="OUT", output=net.OutputPin())]
    return net.Block(id=number, type_name=name, parameters=net.BlockParameters(inputs=inputs, outputs=outputs))


def apart(networks: Sequence[net.LogicNetwork]) -> tuple[list[net.LogicNetwork], dict[int, int]]:
    """Return the networks with ids that no two of them share, and the old id of each new one.

    Networks that share none are returned unchanged. An id that a single network has twice stays.
    """
    used = [{node.id for node in network.nodes} for network in networks]
    if len(set(chain.from_iterable(used))) == sum(len(ids) for ids in used):
        return list(networks), {}
    old: dict[int, int] = {}
    renumbered: list[net.LogicNetwork] = []
    for network in networks:
        copy = network.model_copy(deep=True)
        # a wire may start at an id that no element has: it gets a new one as well, which no element has either
        wires = [wire for node in copy.nodes for wire in wires_of(node)]
        numbers = sorted({node.id for node in copy.nodes} | {wire.source for wire in wires})
        new = {number: len(old) + index for index, number in enumerate(numbers)}
        old |= {value: key for key, value in new.items()}
        for node in copy.nodes:
            node.id = new[node.id]
        for wire in wires:
            wire.source = new[wire.source]
        renumbered.append(copy)
    return renumbered, old
