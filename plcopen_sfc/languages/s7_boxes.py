"""Boxes of LAD and FBD of TIA Portal in tools that have the functions of IEC 61131-3 only.

One table maps blocks to the functions that do the same; any other block has no counterpart and does not compile.
Evidence: TIA Portal V19 help, basic instructions of S7-1500.

The state of a flip-flop of S7 is the variable at the box; in other tools flip-flops are instances. The box becomes
logic that assigns the variable: whatever else sets or reads it sees the same as before. SR of IEC 61131-3 is dominated
by its set input S1, RS by its reset input R1. The logic carries the box, which comes back as long as the logic is as it
was written.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from plcopen_sfc.languages.networks.network_graph import (
    MEMORY_PINS,
    function_box,
    is_memory_pin,
    wires_from,
    wires_of,
    written_by,
)
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.translation.call_translation import HALVES, is_lacking, translated_truncation
from plcopen_sfc.model import network as net
from plcopen_sfc.model.base import ExtensionData
from plcopen_sfc.model.body import networks_of
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import BodyCondition, placed_conditions
from plcopen_sfc.report import ConversionReport, Outcome

BOX = "flip-flop"
"""Extension attribute of logic in place of a flip-flop: the box, as JSON."""
_PINS = {"RS": ("s", "r1"), "SR": ("s1", "r")}
"""The set and the reset input of each."""
_INNER = {"RS": "OR", "SR": "AND"}
_OUTER = {"RS": "AND", "SR": "OR"}


def put_logic(project: Project, report: ConversionReport) -> None:
    """Write the flip-flops with an operand in bodies of POUs as logic that assigns the operand."""
    for name, pou, body in project.bodies():
        for network in networks_of(body):
            for box in [node for node in network.nodes if isinstance(node, net.Block) and _operand(node)]:
                _replace(network, box, max(node.id for other in networks_of(body) for node in other.nodes) + 1)
                why = f"AND and OR that assign {_operand(box)}: flip-flops of other tools keep no state in a variable"
                report.add(Outcome.TRANSLATED, "box", pou.report_path_of(name), why)


def put_boxes(project: Project) -> None:
    """Put the flip-flops back that `put_logic` has written otherwise, where the logic was not changed."""
    for _, _, body in project.bodies():
        for network in networks_of(body):
            for node in list(network.nodes):
                marks = node.extension_data.attributes if node.extension_data is not None else {}
                if isinstance(node, net.Block) and BOX in marks:
                    _put_back(network, node, marks.pop(BOX))


def _operand(box: net.Block) -> str:
    """Return the variable of a flip-flop of S7; empty for another box."""
    if box.type_name.upper() not in _PINS:
        return ""
    pins = (pin.input for pin in box.parameters.inputs if is_memory_pin(box, pin) and pin.input is not None)
    return next((pin.expression or "" for pin in pins), "")


def _replace(network: net.LogicNetwork, box: net.Block, number: int) -> None:
    kind = box.type_name.upper()
    sets, reset = (_pin(box, name) for name in _PINS[kind])
    # RS is (S OR state) AND NOT R1, SR is S1 OR (state AND NOT R): the inner operator has the number that is new
    reset.negated = not reset.negated
    state = net.BlockVariable(name="", input=net.InputPin(expression=_operand(box)))
    if kind == "RS":
        inner, outer = function_box(number, "OR", [sets, state]), function_box(box.id, "AND", [_wired(number), reset])
    else:
        inner, outer = function_box(number, "AND", [state, reset]), function_box(box.id, "OR", [sets, _wired(number)])
    outer.extension_data = ExtensionData(attributes={BOX: json.dumps(box.model_dump(mode="json", exclude_none=True))})
    wire = net.InputPin(connections=[net.Connection(source=box.id, pin="OUT")])
    nodes: list[net.Node] = [inner, outer, net.OutputVariable(id=number + 1, expression=_operand(box), input=wire)]
    _rename_wires(network, box.id, "OUT")
    place = network.nodes.index(box)
    network.nodes[place : place + 1] = nodes


def _pin(box: net.Block, name: str) -> net.BlockVariable:
    """Return a copy of a pin of a box; one that is FALSE where the box has none."""
    found = next((pin for pin in box.parameters.inputs if pin.name.casefold() == name), None)
    if found is None or found.input is None:
        return net.BlockVariable(name="", input=net.InputPin(expression="FALSE"))
    return found.model_copy(update={"extension_data": None}, deep=True)


def _wired(source: int) -> net.BlockVariable:
    return net.BlockVariable(name="", input=net.InputPin(connections=[net.Connection(source=source, pin="OUT")]))


def _rename_wires(network: net.LogicNetwork, source: int, pin: str | None) -> None:
    for wire in wires_from(network, source):
        wire.pin = pin


def _put_back(network: net.LogicNetwork, outer: net.Block, kept: str) -> None:
    try:
        box = net.Block.model_validate_json(kept)
    except ValueError:
        return
    # All that the writer has made of the box must be there still. Where someone has edited a part of it in the tool,
    # the edit counts, and the box is not put back.
    kind = box.type_name.upper()
    if outer.type_name != _OUTER.get(kind) or len(outer.parameters.inputs) != len(_PINS[kind]):
        return
    wired = outer.parameters.inputs[0 if kind == "RS" else 1].input
    sources = {wire.source for wire in wired.connections} if wired is not None else set()
    inner = next((node for node in network.nodes if isinstance(node, net.Block) and node.id in sources), None)
    if inner is None or inner.type_name != _INNER[kind] or len(inner.parameters.inputs) != len(_PINS[kind]):
        return
    pins = inner.parameters.inputs, outer.parameters.inputs
    state = pins[0][1 if kind == "RS" else 0].input
    operand = state.expression if state is not None else None
    fed = (node for node in network.nodes if any(wire.source == outer.id for wire in wires_of(node)))
    assigned = next((node for node in fed if operand and written_by(node) == operand), None)
    if assigned is None:
        return
    now = (pins[0][0], pins[1][1]) if kind == "RS" else (pins[1][0], pins[0][1])
    for name, pin in zip(_PINS[kind], now, strict=True):
        own = next((each for each in box.parameters.inputs if each.name.casefold() == name), None)
        if own is not None:
            own.input, own.negated = pin.input, pin.negated is (name == _PINS[kind][0])
    for own in box.parameters.inputs:
        if own.name.casefold() == MEMORY_PINS[kind]:
            own.input = net.InputPin(expression=operand)
    box.id = outer.id
    network.nodes = [box if n is outer else n for n in network.nodes if n is not inner and n is not assigned]
    _rename_wires(network, box.id, box.parameters.outputs[0].name if box.parameters.outputs else None)


_TYPES = {
    "Time_Of_Day": "TOD",
    "LTime_Of_Day": "LTOD",
    "Date_And_Time": "DT",
} | {
    name: name.upper()
    for name in """Bool Byte Word DWord LWord SInt Int DInt LInt USInt UInt UDInt ULInt Real LReal Time LTime Date LDT
    """.split()
}
"""The types of IEC 61131-3 that a conversion of S7 may have, as TIA Portal spells them; texts it converts otherwise."""
_REALS = ("REAL", "LREAL")
_SET_ENO = frozenset("ADD SUB MUL DIV MOD NEG INC DEC CONVERT ROUND TRUNC CEIL FLOOR SQRT SQR EXPT LN EXP".split())
"""Boxes whose ENO is FALSE where the result does not fit its type."""


@dataclass(frozen=True, slots=True)
class _Place:
    """A network, and where it is in the words of reports."""

    network: net.LogicNetwork
    path: str


def translate_boxes(project: Project, target: Dialect, tool: str, report: ConversionReport) -> None:
    """Give boxes of TIA Portal in `project` the names that `tool` has for them, and report those it has not."""
    own = {thing.name.casefold() for thing in project.pous}
    for place in _networks(project):
        for node in place.network.nodes:
            if isinstance(node, net.Block) and node.call is None and node.type_name.casefold() not in own:
                _Box(place, node, target, tool, report).translate()


def _networks(project: Project) -> Iterator[_Place]:
    for name, pou, body in project.bodies():
        yield from (_Place(network, pou.report_path_of(name)) for network in networks_of(body))
    for chart in project.charts():
        for place, condition in placed_conditions(chart.chart):
            if isinstance(condition, BodyCondition):
                path = f"{chart.report_path} / {place}"
                yield from (_Place(network, path) for network in networks_of(condition.body))


class _Box:
    """One box of a network."""

    def __init__(self, place: _Place, block: net.Block, target: Dialect, tool: str, report: ConversionReport) -> None:
        self.place = place
        self.block = block
        self.target = target
        self.tool = tool
        self.report = report
        self.types = dict(block.extension_data.attributes) if block.extension_data is not None else {}

    def translate(self) -> None:
        """Make it one of IEC 61131-3, or report that there is none."""
        name = self.block.type_name
        if any(is_memory_pin(self.block, pin) for pin in self.block.parameters.inputs):
            return  # reported where it is: flip-flops and edges
        self._report_eno()
        if self.target is Dialect.CODESYS and standard_block(name) is not None:
            source, _, result = name.upper().partition("_TO_")
            if source in _REALS and result and result not in _REALS:
                self._note(Outcome.APPROXIMATED, HALVES)
        rule = _RULES.get(name.upper())
        standard = standard_block(name)
        if rule is not None:
            done = rule(self)
        else:
            done = standard is not None and not is_lacking(standard.name, self.target)
            if done and standard is not None and standard.name != name:
                pins = {pin: standard.input_name(pin) or standard.output_name(pin) or pin for pin in self._pins()}
                self.rename(standard.name, pins)
        if not done:
            self._note(Outcome.NOT_EXECUTED, f"{self.tool} has no {name}: it does not compile")

    def _note(self, outcome: Outcome, why: str) -> None:
        self.report.add(outcome, "box", self.place.path, why)

    def _pins(self) -> list[str]:
        found = self.block.parameters
        return [pin.name for pin in (*found.inputs, *found.in_outs, *found.outputs)]

    def rename(self, name: str, pins: dict[str, str]) -> None:
        """Call the box and its pins otherwise."""
        if self.block.type_name.casefold() != name.casefold():
            self._note(Outcome.TRANSLATED, f"{self.block.type_name} is {name}")
        self.block.type_name = name
        found = self.block.parameters
        for pin in (*found.inputs, *found.in_outs, *found.outputs):
            pin.name = pins.get(pin.name, pin.name)
        for wire in wires_from(self.place.network, self.block.id):
            if wire.pin is not None:
                wire.pin = pins.get(wire.pin, wire.pin)

    def _report_eno(self) -> None:
        is_used = any(wire.pin == "ENO" for wire in wires_from(self.place.network, self.block.id))
        disabled = self.types.get("DisabledENO") == "true"
        if is_used and not disabled and self.block.type_name.upper() in _SET_ENO:
            why = f"its ENO is FALSE in S7 where the result of {self.block.type_name} does not fit its type,"
            self._note(Outcome.APPROXIMATED, f"{why} in {self.tool} it is EN")

    def convert(self) -> bool:
        """``Convert`` and ``Round`` as X_TO_Y."""
        source, result = _TYPES.get(self.types.get("SrcType", "")), _TYPES.get(self.types.get("DestType", ""))
        if source is None or result is None:
            return False
        if source in _REALS and result not in _REALS and self.target is Dialect.CODESYS:
            self._note(Outcome.APPROXIMATED, HALVES)
        name = "MOVE" if source == result else f"{source}_TO_{result}"
        if standard_block(name) is None:
            return False
        self.rename(name, {"in": "IN", "out": "OUT"})
        return True

    def truncate(self) -> bool:
        """``Trunc``."""
        source, result = _TYPES.get(self.types.get("SrcType", "")), _TYPES.get(self.types.get("DestType", ""))
        name = translated_truncation(f"{source}_TRUNC_{result}", self.target, source or "") if source else None
        if name is None or result is None or source not in _REALS:
            return False
        self.rename(name, {"in": "IN", "out": "OUT"})
        return True

    def step(self, name: str) -> bool:
        """``Inc`` and ``Dec``: an operand that is read and written."""
        targets = [
            node.expression
            for node in self.place.network.nodes
            if isinstance(node, net.OutputVariable)
            and any(wire.source == self.block.id and wire.pin == "operand" for wire in wires_of(node))
        ]
        for pin in self.block.parameters.outputs:
            if pin.name == "operand" and pin.output is not None and pin.output.expression is not None:
                targets.append(pin.output.expression)
        if len(targets) != 1 or self.types.get("DestType") in ("Real", "LReal"):
            return False
        self.rename(name, {"operand": "OUT"})
        operand = net.InputPin(expression=targets[0])
        one = net.InputPin(expression="1")
        self.block.parameters.inputs += [
            net.BlockVariable(name="IN1", input=operand),
            net.BlockVariable(name="IN2", input=one),
        ]
        return True

    def negate(self) -> bool:
        """``Neg``: the difference to zero."""
        zero = {"Real": "0.0", "LReal": "0.0", "Time": "T#0s", "LTime": "LTIME#0s"}.get(
            self.types.get("SrcType", ""), "0"
        )
        inputs = self.block.parameters.inputs
        if not any(pin.name == "in" for pin in inputs):
            return False
        self.rename("SUB", {"in": "IN2", "out": "OUT"})
        place = next(index for index, pin in enumerate(inputs) if pin.name == "IN2")
        inputs.insert(place, net.BlockVariable(name="IN1", input=net.InputPin(expression=zero)))
        return True

    def square(self) -> bool:
        """``Sqr``: the product with itself."""
        inputs = self.block.parameters.inputs
        if not any(pin.name == "in" for pin in inputs):
            return False
        self.rename("MUL", {"in": "IN1", "out": "OUT"})
        place = next(index for index, pin in enumerate(inputs) if pin.name == "IN1")
        inputs.insert(place + 1, inputs[place].model_copy(update={"name": "IN2"}, deep=True))
        return True


_RULES: dict[str, Callable[[_Box], bool]] = {
    "CONVERT": _Box.convert,
    "ROUND": _Box.convert,
    "TRUNC": _Box.truncate,
    "INC": lambda box: box.step("ADD"),
    "DEC": lambda box: box.step("SUB"),
    "NEG": _Box.negate,
    "SQR": _Box.square,
}
"""Boxes that are written otherwise."""
