"""Boxes of LAD and FBD of TIA Portal in tools that have the functions of IEC 61131-3 only.

What does the same there is such a function, by one table; anything else has no counterpart and does not compile.
Evidence: TIA Portal V19 help, basic instructions of S7-1500.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.networks.network_graph import is_memory_pin, wires_of
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.translation.call_translation import HALVES
from plcopen_sfc.languages.translation.function_translation import is_lacking, translated_truncation
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.conditions import BodyCondition
from plcopen_sfc.model.network import Block, BlockVariable, InputPin, LogicNetwork, OutputVariable
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome

__all__ = ["translate_boxes"]

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

    network: LogicNetwork
    path: str


def translate_boxes(project: Project, target: Dialect, tool: str, report: ConversionReport) -> None:
    """Give boxes of TIA Portal in `project` the names that `tool` has for them, and report those it has not."""
    own = {thing.name.casefold() for thing in project.pous}
    for place in _networks(project):
        for node in place.network.nodes:
            if isinstance(node, Block) and node.call is None and node.type_name.casefold() not in own:
                _Box(place, node, target, tool, report).translate()


def _networks(project: Project) -> Iterator[_Place]:
    for name, pou, body in project.bodies():
        if isinstance(body, FbdBody | LdBody):
            yield from (_Place(network, pou.report_path_of(name)) for network in body.networks)
    for chart in project.charts():
        for transition in chart.chart.transitions:
            condition = transition.condition
            if isinstance(condition, BodyCondition) and isinstance(condition.body, FbdBody | LdBody):
                path = f"{chart.report_path} / transition {chart.chart.label(transition)}"
                yield from (_Place(network, path) for network in condition.body.networks)
        for step in chart.chart.steps:
            for kind, supervised in (("interlock", step.interlock), ("supervision", step.supervision)):
                condition = supervised.condition if supervised is not None else None
                if isinstance(condition, BodyCondition) and isinstance(condition.body, FbdBody | LdBody):
                    path = f"{chart.report_path} / step {step.name} / {kind}"
                    yield from (_Place(network, path) for network in condition.body.networks)


class _Box:
    """One box of a network."""

    def __init__(self, place: _Place, block: Block, target: Dialect, tool: str, report: ConversionReport) -> None:
        self.place = place
        self.block = block
        self.target = target
        self.tool = tool
        self.report = report
        self.types = dict(block.carried.attributes) if block.carried is not None else {}

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
                pins = {
                    pin: _standard_pin(standard.input_name(pin) or standard.output_name(pin), pin)
                    for pin in self._pins()
                }
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
        for wire in (wire for node in self.place.network.nodes for wire in wires_of(node)):
            if wire.source == self.block.id and wire.pin is not None:
                wire.pin = pins.get(wire.pin, wire.pin)

    def _report_eno(self) -> None:
        is_used = any(
            wire.source == self.block.id and wire.pin == "ENO"
            for node in self.place.network.nodes
            for wire in wires_of(node)
        )
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
            if isinstance(node, OutputVariable)
            and any(wire.source == self.block.id and wire.pin == "operand" for wire in wires_of(node))
        ]
        for pin in self.block.parameters.outputs:
            if pin.name == "operand" and pin.output is not None and pin.output.expression is not None:
                targets.append(pin.output.expression)
        if len(targets) != 1 or self.types.get("DestType") in ("Real", "LReal"):
            return False
        self.rename(name, {"operand": "OUT"})
        operand = InputPin(expression=targets[0])
        one = InputPin(expression="1")
        self.block.parameters.inputs += [
            BlockVariable(name="IN1", input=operand),
            BlockVariable(name="IN2", input=one),
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
        inputs.insert(place, BlockVariable(name="IN1", input=InputPin(expression=zero)))
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


def _standard_pin(found: str | None, pin: str) -> str:
    return pin if found is None else found


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
