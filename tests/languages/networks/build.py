"""Small networks for the tests, without places."""

from __future__ import annotations

from typing import Any

from plcopen_sfc.languages.networks import DrawnExpression, NetworkExpression, condition_expression
from plcopen_sfc.languages.networks.network_reading import network_statements
from plcopen_sfc.languages.networks.results import NetworkStatements
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import (
    Block,
    BlockParameters,
    BlockVariable,
    Coil,
    Connection,
    Contact,
    InputPin,
    InputVariable,
    LeftPowerRail,
    LogicNetwork,
    Node,
    OutputPin,
    OutputVariable,
)
from plcopen_sfc.model.sfc import SfcNetwork, Transition

Wire = int | tuple[int, str]


def pin(*wires: Wire) -> InputPin:
    """An input with wires from elements, or from an output of them."""
    ends = [wire if isinstance(wire, tuple) else (wire, None) for wire in wires]
    return InputPin(connections=[Connection(source=source, pin=name) for source, name in ends])


def rail(number: int = 0) -> Node:
    return LeftPowerRail(id=number, outputs=[OutputPin()])


def variable(number: int, expression: str, **more: Any) -> Node:
    return InputVariable(id=number, expression=expression, output=OutputPin(), **more)


def output(number: int, expression: str, *wires: Wire, **more: Any) -> Node:
    return OutputVariable(id=number, expression=expression, input=pin(*wires), **more)


def contact(number: int, name: str, *wires: Wire, **more: Any) -> Node:
    return Contact(id=number, variable=name, input=pin(*wires), output=OutputPin(), **more)


def coil(number: int, name: str, *wires: Wire, **more: Any) -> Node:
    return Coil(id=number, variable=name, input=pin(*wires), output=OutputPin(), **more)


def block(
    number: int,
    type_name: str,
    inputs: dict[str, Wire | InputPin | None],
    *outputs: str | BlockVariable,
    instance: str | None = None,
    in_outs: dict[str, Wire] | None = None,
    **more: Any,
) -> Node:
    """A block; inputs by name, each with the wire to it."""

    def fed(name: str, wire: Wire | InputPin | None) -> BlockVariable:
        end = wire if isinstance(wire, InputPin) else pin(*([] if wire is None else [wire]))
        return BlockVariable(name=name, input=end)

    parameters = BlockParameters(
        inputs=[fed(name, wire) for name, wire in inputs.items()],
        in_outs=[
            BlockVariable(name=name, input=pin(wire), output=OutputPin()) for name, wire in (in_outs or {}).items()
        ],
        outputs=[BlockVariable(name=o, output=OutputPin()) if isinstance(o, str) else o for o in outputs],
    )
    return Block(id=number, type_name=type_name, instance=instance, parameters=parameters, **more)


def read(*nodes: Node, dialect: Dialect = Dialect.IEC, **options: Any) -> NetworkStatements:
    """A network as statements."""
    return network_statements([LogicNetwork(nodes=list(nodes))], dialect, **options)


def lines(result: NetworkStatements, dialect: Dialect = Dialect.IEC) -> list[str]:
    """The text of the statements."""
    return print_node(result.tree).splitlines()


def told(result: NetworkStatements) -> list[str]:
    """The problems, each with its severity and element."""
    return [str(problem) for problem in result.problems]


def read_drawn(drawn: DrawnExpression, dialect: Dialect = Dialect.IEC) -> NetworkExpression:
    """Return a drawn expression as it reads where it is the condition of a transition."""
    condition = WiredCondition(input=InputPin(connections=[*drawn.outputs]), negated=drawn.negated)
    chart = SfcNetwork(logic=[*drawn.network.nodes], transitions=[Transition(id=100_000, condition=condition)])
    return condition_expression(chart, chart.transitions[0], dialect)
