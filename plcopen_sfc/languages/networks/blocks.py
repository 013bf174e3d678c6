"""Blocks to text: operators, functions, function blocks and whatever else is called in a network."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.effects import conditional_assignment, is_variable
from plcopen_sfc.languages.networks.network_graph import (
    EDGE_COILS,
    EDGE_CONTACTS,
    EDGES,
    Graph,
    Source,
    block_inputs,
    is_enable,
    is_memory_pin,
)
from plcopen_sfc.languages.networks.wires import (
    EXTENSIBLE_COMPARISONS,
    TRUE,
    Factor,
    Product,
    Wires,
    compared,
    expression_of,
    inverted,
    joined,
    meeting,
    operation,
    product_of,
)
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import AssignmentKind, Expression, Operator, Statement
from plcopen_sfc.languages.standard_blocks import StandardBlock, standard_block
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import (
    Block,
    BlockCall,
    BlockVariable,
    Contact,
    Edge,
    LeftPowerRail,
    Node,
    OutputVariable,
    Storage,
)


@dataclass(slots=True)
class _Argument:
    """An input of a block with what comes to it; `product` only where it comes unmodified."""

    variable: BlockVariable
    value: Expression | None
    product: Product | None


class BlockReader:
    """Executes the blocks of a network symbolically."""

    def __init__(self, graph: Graph, wires: Wires) -> None:
        self._graph = graph
        self._is_ladder = any(isinstance(node, LeftPowerRail) for node in graph.nodes.values())
        self._wires = wires
        self._written: set[int] = set()
        for node in graph.nodes.values():
            if isinstance(node, Block) and node.instance and node.call not in (BlockCall.ACTION, BlockCall.METHOD):
                wires.instance(node.instance, node.type_name)

    def acts(self, block: Block) -> bool:
        """True if executing it does something even if its outputs are not used."""
        if block.call in _ACTING or block.instance or block.code is not None:
            return True
        standard = _standard(block)
        return standard is None or standard.stateful or any(map(_target, block.parameters.outputs))

    def is_written(self, node: Node) -> bool:
        """True if the element was written together with the block that feeds it."""
        return node.id in self._written

    def last_output(self, block: Block, pin: str) -> Expression | None:
        """Return the value of an output before the block is executed: that of the last cycle; None: it keeps none."""
        variable = next((v for v in block.parameters.outputs if v.name == pin), None)
        if not block.instance or variable is None or is_enable(variable) or variable.edge is not Edge.NONE:
            return None
        value = n.Member(self._wires.expression(block.instance, block.id), n.Name(pin))
        return inverted(value) if variable.negated else value

    def execute(self, block: Block, value_of: Callable[[Node, int], Product | None]) -> None:
        """Execute a block: give its outputs their values."""
        arguments = []
        for index, variable in enumerate(block_inputs(block)):
            arguments.append(self._argument(block, variable, value_of(block, index)))
            if variable.negated:
                self._check_negation(block, variable, self._graph.sources(block)[index])
        enable = next((a for a in arguments if _is(a.variable, "en")), None)
        guard = enable.value if enable is not None and enable.value != TRUE else None
        arguments = [a for a in arguments if a is not enable]
        for variable in block.parameters.outputs:
            if _is(variable, "eno"):
                # the power before the box: executing it may change what this is calculated from
                if guard is not None and self._is_used(block, variable) and not is_variable(guard):
                    guard = self._kept(block, guard)
                self._give(block, variable, guard or TRUE)
        self._call(block, arguments, guard)
        # in-outs, which `block_inputs` has last, pass their variables on
        for argument in arguments[len(arguments) - len(block.parameters.in_outs) :]:
            source = (block.id, argument.variable.name)
            product = (Factor(source, argument.value),) if argument.value is not None else None
            self._wires.store(source, product, lazy=True)

    def _call(self, block: Block, arguments: list[_Argument], guard: Expression | None) -> None:
        outputs = [variable for variable in block.parameters.outputs if not _is(variable, "eno")]
        if block.code is not None or block.call is BlockCall.EXECUTE:
            self._execute(guard, *self._wires.code(block.code or "", block.id))
            return
        if block.type_name.upper() in EDGE_CONTACTS | EDGE_COILS and not block.instance:
            self._edge_element(block, arguments, outputs)
            return
        counted = next((a.value for a in arguments if _is(a.variable, "operand")), None)
        step = _COUNTING.get(block.type_name.upper())
        if counted is not None and step is not None and not block.instance:
            more = n.Assignment(counted, n.Operation(step, (counted, n.Literal("1"))))
            self._execute(guard, more)
            return
        standard = _standard(block)
        self._check_pins(block, standard, arguments)
        memory = next((a for a in arguments if is_memory_pin(block, a.variable)), None)
        if memory is not None and memory.value is not None:
            self._with_memory(block, memory.value, [a for a in arguments if a is not memory], outputs)
            return
        called_on = block.instance if block.call not in (BlockCall.ACTION, BlockCall.METHOD) else None
        if called_on or (standard is not None and standard.stateful) or block.call is BlockCall.PROGRAM:
            self._function_block(block, arguments, outputs, guard)
        elif block.call is BlockCall.ACTION:
            self._execute(guard, n.CallStatement(n.Call(self._callee(block))))
        else:
            self._function(block, standard, arguments, outputs, guard)

    def _kept(self, block: Block, value: Expression) -> n.Name:
        helper = self._wires.helper("value", (block.id, None), "BOOL", retained=False)
        self._wires.execute(n.Assignment(helper, value))
        return helper

    # -- inputs and outputs

    def _argument(self, block: Block, variable: BlockVariable, product: Product | None) -> _Argument:
        if variable.storage is not Storage.NONE and variable.input is not None:
            self._wires.problem(f"its input {variable.name} cannot {variable.storage.value} anything", block.id)
        if product is None:
            self._missing(block, variable)
            return _Argument(variable, None, None)
        if not variable.negated and variable.edge is Edge.NONE:
            return _Argument(variable, expression_of(product), product)
        if variable.negated and variable.edge is not Edge.NONE:
            text = (
                f"its input {variable.name} is negated and watches for an edge: taken as the edge of the negated value"
            )
            self._wires.problem(text, block.id, Severity.WARNING)
        value = expression_of(product)
        value = self._wires.edge(variable.edge, inverted(value) if variable.negated else value, (block.id, None))
        return _Argument(variable, value, None)

    def _check_negation(self, block: Block, variable: BlockVariable, sources: Sequence[Source]) -> None:
        """A ladder of CODESYS with one negation at a box was seen exported with it at the contact and at the pin."""
        before = self._graph.nodes.get(sources[0][0]) if len(sources) == 1 else None
        if isinstance(before, Contact) and before.negated:
            text = f"its input {variable.name!r} is negated, and so is contact {before.id} before it; both are counted"
            self._wires.problem(text, block.id, Severity.WARNING)

    def _missing(self, block: Block, variable: BlockVariable) -> None:
        if _is(variable, "en") or variable.hidden:
            return
        if variable.input is not None and variable.input.connections:
            self._wires.problem(f"its input {variable.name!r} gets no value", block.id)
        elif self.acts(block):
            text = f"its input {variable.name!r} is not connected and keeps its value"
            self._wires.problem(text, block.id, Severity.INFO)
        else:
            self._wires.problem(f"its input {variable.name!r} is not connected", block.id)

    def _give(self, block: Block, variable: BlockVariable, value: Expression | None) -> None:
        """Give an output its value, and write it to the variable at the pin."""
        source = (block.id, variable.name)
        if value is not None:
            value = self._wires.edge(variable.edge, inverted(value) if variable.negated else value, (block.id, None))
            if _target(variable):
                value = self._write_at_pin(block, variable, value)
            elif variable.storage is not Storage.NONE:
                self._wires.problem(f"its output {variable.name} has nothing to {variable.storage.value}", block.id)
        self._wires.store(source, (Factor(source, value),) if value is not None else None)

    def _write_at_pin(self, block: Block, variable: BlockVariable, value: Expression) -> Expression:
        """Write an output to the variable at its pin; return the variable that has its value from now on."""
        target = self._wires.expression(_target(variable), block.id)
        if variable.storage is not Storage.NONE and self._graph.uses[block.id, variable.name]:
            value = self._kept(block, value)
        self._wires.execute(self.assignment(target, value, variable.storage))
        return target if variable.storage is Storage.NONE else value

    def assignment(self, target: Expression, value: Expression, storage: Storage) -> Statement:
        """Write `value` to `target`, or set or reset it while `value` is TRUE."""
        if storage is Storage.NONE:
            return n.Assignment(target, value)
        stored = n.Assignment(target, value, AssignmentKind.SET if storage is Storage.SET else AssignmentKind.RESET)
        is_known = self._wires.dialect in (Dialect.CODESYS, Dialect.TWINCAT)
        return stored if is_known else conditional_assignment(stored) or stored

    def _execute(self, guard: Expression | None, *statements: Statement) -> None:
        """Append statements that are executed while `guard`, the input EN, is TRUE."""
        guarded = statements if guard is None else (n.If((n.Branch(guard, statements),)),)
        for statement in guarded:
            self._wires.execute(statement)

    def _check_pins(self, block: Block, standard: StandardBlock | None, arguments: list[_Argument]) -> None:
        """Report pins that a standard block does not have: text would lose them or get them wrong."""
        for variable in [a.variable for a in arguments if standard is not None and a.variable.name]:
            known = standard is not None and standard.input_name(variable.name) is not None
            if not known and not _is(variable, "pre") and not is_memory_pin(block, variable):
                self._wires.problem(f"{block.type_name} has no input {variable.name!r}", block.id)

    # -- calls

    def _callee(self, block: Block) -> Expression:
        names = [name for name in (block.instance, block.type_name) if name]
        return self._wires.expression(".".join(names), block.id)

    def _function_block(
        self, block: Block, arguments: list[_Argument], outputs: list[BlockVariable], guard: Expression | None
    ) -> None:
        callee: Expression
        if block.call is BlockCall.PROGRAM:
            callee = self._wires.expression(block.type_name, block.id)
        elif block.instance:
            callee = self._wires.expression(block.instance, block.id)
        else:
            name = self._wires.helper(block.type_name.lower(), (block.id, None), block.type_name, retained=True)
            callee = name
            self._wires.instance(name.identifier, block.type_name)
            text = f"{block.type_name} has no instance here; {name.identifier} is one"
            self._wires.problem(text, block.id, Severity.WARNING)
        if any(not a.variable.name for a in arguments):
            self._wires.problem(f"an input of {block.type_name} has no name", block.id)
        given = tuple(n.Argument(a.value, n.Name(a.variable.name)) for a in arguments if a.value is not None)
        self._execute(guard, n.CallStatement(n.Call(callee, given)))
        for variable in outputs:
            self._give(block, variable, n.Member(callee, n.Name(variable.name)))

    def _with_memory(
        self, block: Block, memory: Expression, arguments: list[_Argument], outputs: list[BlockVariable]
    ) -> None:
        """A flip-flop or an edge of S7, which keeps its state in a variable instead of an instance.

        One assignment each, so that all inputs are taken as they are before it (TIA Portal help: SR, RS, P_TRIG).
        """
        block_of = standard_block(block.type_name)
        named = (((block_of and block_of.input_name(a.variable.name)) or a.variable.name, a.value) for a in arguments)
        inputs = {name.upper().rstrip("1"): value for name, value in named}
        result = memory
        if block.type_name.upper() in EDGES:
            clock = inputs.get("CLK") or n.Literal("FALSE")
            rising = block.type_name.upper() == "R_TRIG"
            result = self._wires.edge_since(memory, clock, (block.id, None), rising=rising)
        else:
            sets, resets = inputs.get("S"), inputs.get("R")
            stays = [inverted(resets)] if resets is not None else []
            if block.type_name.upper() == "RS":  # resetting wins
                on = [joined(Operator.OR, [sets, memory]) if sets is not None else memory]
                value = joined(Operator.AND, [*on, *stays])
            else:
                held = joined(Operator.AND, [memory, *stays])
                value = joined(Operator.OR, [sets, held]) if sets is not None else held
            self._wires.execute(n.Assignment(memory, value))
        for variable in outputs:
            self._give(block, variable, result)

    def _edge_element(self, block: Block, arguments: list[_Argument], outputs: list[BlockVariable]) -> None:
        """An edge contact or coil of S7 (TIA Portal help: scan operand, set operand on positive signal edge).

        The operand of a contact is watched in every cycle, whether power reaches the contact or not. Behind a coil
        goes on what came to it.
        """
        given = {a.variable.name.casefold(): a for a in arguments}
        unknown = given.keys() - {"pre", "in", "operand", "bit"}
        for name in sorted(unknown):
            self._wires.problem(f"{block.type_name} has no input {name!r}", block.id)
        operand, memory = (given[name].value if name in given else None for name in ("operand", "bit"))
        if operand is None or memory is None:
            self._wires.problem(f"{block.type_name} has no operand, or none for its edge", block.id)
            return
        power = given.get("in") or given.get("pre")
        flow = power.value if power is not None and power.value is not None else TRUE
        name = block.type_name.upper()
        if name in EDGE_CONTACTS:
            edge = self._wires.edge_since(memory, operand, (block.id, None), rising=EDGE_CONTACTS[name])
            products = (
                [power.product or (Factor((block.id, "pre"), flow),)] if power is not None and flow != TRUE else []
            )
            for variable in outputs:
                self._give_product(block, variable, product_of([*products, (Factor((block.id, "edge"), edge),)]))
            return
        flow = flow if is_variable(flow) else self._kept(block, flow)
        edge = self._wires.edge_since(memory, flow, (block.id, None), rising=EDGE_COILS[name])
        self._wires.execute(n.Assignment(operand, edge))
        for variable in outputs:
            self._give(block, variable, flow)

    def _function(
        self,
        block: Block,
        standard: StandardBlock | None,
        arguments: list[_Argument],
        outputs: list[BlockVariable],
        guard: Expression | None,
    ) -> None:
        moves = standard is not None and standard.name == "MOVE"
        extra = [
            (variable, self._wires.helper("value", (block.id, None), None, retained=False))
            for variable in outputs[1:]
            if not moves and self._is_used(block, variable)
        ]
        before = [a for a in arguments if _is(a.variable, "pre")]
        rest = [a for a in arguments if a not in before]
        product = self._result(block, standard, rest, [(v.name, h) for v, h in extra])
        if product is not None:  # a comparison in a ladder of S7 is a contact: power must reach it
            powers = [a.product or (Factor((block.id, "pre"), a.value),) for a in before if a.value not in (None, TRUE)]
            product = product_of([*powers, product])
        if not outputs or (standard is None and not self._is_used(block, outputs[0])):
            if product is not None:
                self._execute(guard, n.CallStatement(expression_of(product)))
                product = None
        elif product is not None and guard is not None and not extra and self._writes_at_pin_only(outputs, moves=moves):
            target = self._wires.expression(_target(outputs[0]), block.id)
            self._execute(guard, n.Assignment(target, expression_of(product)))
            source = (block.id, outputs[0].name)
            self._wires.store(source, (Factor(source, target),))
            return
        elif product is not None and (guard is not None or extra):
            product = self._conditional(block, outputs[0], expression_of(product), guard)
        for variable in outputs if moves else outputs[:1]:
            self._give_product(block, variable, product)
        for variable, helper in extra:
            self._give(block, variable, helper)

    def _writes_at_pin_only(self, outputs: list[BlockVariable], *, moves: bool) -> bool:
        """True if the result goes to one variable, at the pin, as it is: that keeps its value while nothing is done."""
        result = outputs[0]
        plain = result.storage is Storage.NONE and not result.negated and result.edge is Edge.NONE
        return bool(_target(result)) and plain and (len(outputs) == 1 or not moves)

    def _is_used(self, block: Block, variable: BlockVariable) -> bool:
        return bool(self._graph.uses[block.id, variable.name] or _target(variable))

    def _give_product(self, block: Block, variable: BlockVariable, product: Product | None) -> None:
        if product is None or variable.negated or variable.edge is not Edge.NONE or _target(variable):
            self._give(block, variable, expression_of(product) if product is not None else None)
        else:
            self._wires.store((block.id, variable.name), product)

    def _conditional(
        self, block: Block, result: BlockVariable, value: Expression, guard: Expression | None
    ) -> Product | None:
        """The result of a function that is executed under a condition: it is written while the condition is TRUE."""
        sink = self._only_sink(block, result)
        if guard is not None and sink is not None and not _target(result) and not result.negated:
            target = self._wires.expression(sink.expression, sink.id)
            self._execute(guard, n.Assignment(target, value))
            self._written.add(sink.id)
            return None
        type_name = self._graph.type_of((block.id, result.name))
        # retained: while the box is not executed, its wire has the value of the last time
        helper = self._wires.helper("value", (block.id, None), type_name, retained=guard is not None)
        self._execute(guard, n.Assignment(helper, value))
        return (Factor((block.id, result.name), helper),)

    def _only_sink(self, block: Block, result: BlockVariable) -> OutputVariable | None:
        """Return the variable that a result goes to, if that is all it does."""
        source: Source = (block.id, result.name)
        if self._graph.uses[source] != 1 or result.edge is not Edge.NONE:
            return None
        sink = next((node for node in self._graph.nodes.values() if [source] in self._graph.sources(node)), None)
        if not isinstance(sink, OutputVariable) or sink.negated:
            return None
        return sink if sink.storage is Storage.NONE and sink.edge is Edge.NONE else None

    # -- functions and operators

    def _result(
        self,
        block: Block,
        standard: StandardBlock | None,
        arguments: list[_Argument],
        outputs: list[tuple[str, n.Name]],
    ) -> Product | None:
        if standard is not None:
            arguments = _in_order(standard, arguments)
        there = [a for a in arguments if a.value is not None]
        values = [a.value for a in there if a.value is not None]
        source = (block.id, "result")
        if standard is not None and there and (standard.name == "AND" or (standard.name == "OR" and self._is_ladder)):
            products = [
                a.product if a.product is not None else (Factor((*source, i), values[i]),) for i, a in enumerate(there)
            ]
            # in LAD of TIA Portal an OR is where branches meet, which may have parted behind the same contacts
            return product_of(products) if standard.name == "AND" else meeting(products, self._wires.meetings)
        if standard is not None and standard.name == "MOVE" and there:
            return there[0].product or (Factor(source, values[0]),)
        value = _operation(standard, values) if standard is not None and not outputs else None
        if value is None:
            if standard is not None and not values:
                return None
            value = n.Call(self._callee(block), self._call_arguments(standard, arguments, outputs))
        return (Factor(source, value),)

    def _call_arguments(
        self, standard: StandardBlock | None, arguments: list[_Argument], outputs: list[tuple[str, n.Name]]
    ) -> tuple[n.Argument, ...]:
        given = [(a.variable.name, a.value) for a in arguments]
        if standard is not None:
            given = [(standard.input_name(name) or name, value) for name, value in given]
            order = [pin.name for pin in standard.input_pins(len(given))]
            if [name for name, _ in given] == order or not all(name for name, _ in given):
                given = [("", value) for _, value in given]
        named = tuple(n.Argument(value, n.Name(name) if name else None) for name, value in given if value is not None)
        return (*named, *(n.Argument(helper, n.Name(name), output=True) for name, helper in outputs))


_ACTING = frozenset(
    {BlockCall.FUNCTION_BLOCK, BlockCall.PROGRAM, BlockCall.ACTION, BlockCall.METHOD, BlockCall.EXECUTE}
)
_COUNTING = {"INC": Operator.ADD, "DEC": Operator.SUBTRACT}
"""Boxes of S7 that change their operand (TIA Portal help: INC, DEC)."""


def _standard(block: Block) -> StandardBlock | None:
    """The standard function or block of a box; None for an instance of a block that has the name of a function."""
    found = standard_block(block.type_name)
    return None if found is not None and block.instance and not found.stateful else found


def _is(variable: BlockVariable, name: str) -> bool:
    """True if a pin has this name, which is given in lower case."""
    return variable.name.casefold() == name


def _target(variable: BlockVariable) -> str:
    """Return the variable at an output pin."""
    return (variable.output.expression or "").strip() if variable.output is not None else ""


def _in_order(standard: StandardBlock, arguments: list[_Argument]) -> list[_Argument]:
    """Return the inputs in the order of IEC 61131-3, where their names tell it."""
    names = [standard.input_name(argument.variable.name) for argument in arguments]
    order = {pin.name: place for place, pin in enumerate(standard.input_pins(len(arguments)))}
    if len(set(names)) < len(names) or not set(names) <= order.keys():
        return arguments
    return [
        argument for _, argument in sorted(zip(names, arguments, strict=True), key=lambda pair: order[pair[0] or ""])
    ]


def _operation(standard: StandardBlock, values: list[Expression]) -> Expression | None:
    """Return an operator block as an operation; None where it must be written as a call."""
    operator = standard.operator
    if operator is None or not values:
        return None
    if operator is Operator.NOT:
        return inverted(values[0]) if len(values) == 1 else None
    if operator in (Operator.OR, Operator.XOR):
        return joined(operator, values)
    if len(values) < 2:
        return None
    if operator in EXTENSIBLE_COMPARISONS and len(values) > 2:
        return compared(operator, values)
    return operation(operator, values) if len(values) == 2 or operator in (Operator.ADD, Operator.MULTIPLY) else None
