"""Elements of function block diagrams for values and statements, before they get positions.

`plcopen_sfc.languages.networks.network_drawing` draws the same as ladder diagrams.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.effects import Path, conditional_assignment, is_impure, is_repeatable, path_of, reads
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules, by_name, constant_of, is_harmless, is_power
from plcopen_sfc.languages.networks.element_places import (
    GRID,
    ROW,
    Area,
    BlockDraft,
    DrawnItem,
    Slot,
    WireStart,
    connect,
    input_pin,
    output_pin,
    placed,
    text_width,
)
from plcopen_sfc.languages.networks.network_graph import MEMORY_PINS
from plcopen_sfc.languages.networks.results import NetworkProblem
from plcopen_sfc.languages.networks.wires import TRUE, joined
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import AssignmentKind, Expression, Operator, Statement
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.languages.st.walking import transform
from plcopen_sfc.languages.standard_blocks import StandardBlock, Tool, operator_block, standard_block
from plcopen_sfc.model import network as net
from plcopen_sfc.model.checked import unchecked
from plcopen_sfc.model.dialect import Dialect

_MAX_WAITING = 8
"""Number of calls of function blocks that may wait to be drawn together with the statement that uses them."""


class Rung(NamedTuple):
    """A rung that waits for its place, and its elements."""

    item: DrawnItem
    nodes: Sequence[net.Node]


class Drafter:
    """Makes the elements of one network, or of all of a body."""

    def __init__(self, rules: DrawingRules, first_id: int) -> None:
        self.rules = rules
        self.nodes: list[net.Node] = []
        self.problems: list[NetworkProblem] = []
        self._next_id = first_id
        self._next_order = 1
        self._types = rules.block_types
        self._operands = rules.operand_paths
        self._pending_calls: dict[Path, n.Call] = {}
        """Calls of function blocks that are drawn with the statement that uses their outputs, by instance."""
        self._drawn_calls: list[Path] = []
        """Those that are drawn, in the order of their execution."""
        self._started_calls: set[Path] = set()
        """Those that are drawn or being drawn."""
        self._order_violated = False
        """True if the rung would read a variable of a call before the call is executed."""

    # -- statements

    def statements(self, statements: Iterable[Statement]) -> list[Rung]:
        """Return the rungs of statements. A function block whose output is used next is in the rung that uses it."""
        rungs: list[Rung] = []
        waiting: list[Statement] = []
        for statement in self._flat(statements):
            waiting.append(statement)
            if not self._can_wait(statement, waiting[:-1]) or len(waiting) > _MAX_WAITING:
                rungs += self._rungs(waiting)
                waiting = []
        return rungs + self._rungs(waiting)

    def _flat(self, statements: Iterable[Statement]) -> Iterator[Statement]:
        """Yield the statements without those that do nothing: regions and lone semicolons."""
        for statement in statements:
            if isinstance(statement, n.RegionBlock):
                text = f"the region {statement.title!r} is not drawn, only what is in it"
                self.problems.append(NetworkProblem(text, None, Severity.INFO))
                yield from self._flat(statement.statements)
            elif not isinstance(statement, n.Empty):
                yield statement

    def _rungs(self, statements: Sequence[Statement]) -> list[Rung]:
        """Draw statements in as few rungs as possible; all but the last are calls that may be drawn later.

        Which calls fit into one rung is found out by drawing it: what does not fit is taken back.
        """
        if not statements:
            return []
        *calls, last = statements
        whole = self._fitting(calls, last)
        if whole is not None:  # most do: they are drawn once
            return [whole]
        first = 1
        while first < len(calls):
            state = self._state()
            if self._fitting(calls[first:], last) is not None:
                self._go_back(state)  # those before it are drawn first
                break
            first += 1
        return [*self._rungs(calls[:first]), self._rung(calls[first:], last)]

    def _fitting(self, calls: Sequence[Statement], last: Statement) -> Rung | None:
        """Return the rung of `last` with the function blocks of `calls`.

        None, with nothing drawn, if these would be executed in another order.
        """
        state = self._state()
        rung = self._rung(calls, last)
        if not calls or (self._drawn_calls == list(self._pending_calls) and not self._order_violated):
            return rung
        self._go_back(state)
        return None

    def _state(self) -> tuple[int, int, int, int]:
        return len(self.nodes), len(self.problems), self._next_id, self._next_order

    def _go_back(self, state: tuple[int, int, int, int]) -> None:
        nodes, problems, self._next_id, self._next_order = state
        del self.nodes[nodes:], self.problems[problems:]

    def _rung(self, calls: Sequence[Statement], last: Statement) -> Rung:
        first = len(self.nodes)
        self._pending_calls = {path_of(call.callee): call for call in _calls(calls)}
        self._drawn_calls, self._started_calls, self._order_violated = [], set(), False
        item = self.statement(last)
        return Rung(item, self.nodes[first:])

    def _can_wait(self, statement: Statement, waiting: Sequence[Statement]) -> bool:
        """True if it is the call of a standard function block of which none waits yet."""
        call = statement.call if isinstance(statement, n.CallStatement) else None
        if not isinstance(call, n.Call):
            return False
        if path_of(call.callee) in {path_of(waiting_call.callee) for waiting_call in _calls(waiting)}:
            return False
        type_name = self._types.get(path_of(call.callee))
        block = standard_block(type_name) if type_name is not None else None
        return block is not None and block.stateful and by_name(call)

    def statement(self, statement: Statement) -> DrawnItem:
        """Return the rung of a statement."""
        if isinstance(statement, n.Assignment):
            item = self._assignment(statement)
        elif isinstance(statement, n.CallStatement):
            item = self._call(statement, None)
        elif isinstance(statement, n.If):
            item = self._conditional(statement)
        elif isinstance(statement, n.Goto | n.ReturnStatement):
            item = self._leave(statement, TRUE)
        elif isinstance(statement, n.LabelStatement):
            name = statement.label.identifier
            node = net.Label(id=self.new_id(), label=name, execution_order=self.new_order())
            self.nodes.append(node)
            item = placed(node, (text_width(name), ROW), [], [], ROW / 2)
        else:
            item = None
        return item if item is not None else self._text_box(statement, None, (statement,))

    def _assignment(self, statement: n.Assignment) -> DrawnItem | None:
        storage = _STORAGES.get(statement.kind)
        if storage is None or isinstance(statement.value, n.AssignmentExpression):
            return None
        return self.sink(statement.target, statement.value, storage)

    def _conditional(self, statement: n.If) -> DrawnItem | None:
        """IF with one branch of one statement: a stored variable, a jump, or a block with EN."""
        if len(statement.branches) != 1 or statement.otherwise is not None:
            return None
        branch = statement.branches[0]
        inner = branch.statements[0] if len(branch.statements) == 1 else None
        item = None
        if isinstance(inner, n.Assignment) and inner.kind is AssignmentKind.ASSIGN:
            constant = constant_of(inner.value)
            if constant is None and self._is_bit(inner.target):
                constant = {"0": False, "1": True}.get(self._text(n.bare(inner.value)))
            if constant is not None:
                storage = net.Storage.SET if constant else net.Storage.RESET
                return self.sink(inner.target, branch.condition, storage)
            item = self._enabled_assignment(inner, branch.condition)
        elif isinstance(inner, n.Goto | n.ReturnStatement):
            item = self._leave(inner, branch.condition)
        elif isinstance(inner, n.CallStatement):
            item = self._call(inner, branch.condition)
        return item if item is not None else self._text_box(statement, branch.condition, branch.statements)

    def _enabled_assignment(self, assignment: n.Assignment, condition: Expression) -> DrawnItem | None:
        value = n.bare(assignment.value)
        if not is_harmless(value):
            return None
        if self.rules.tool is Tool.S7 and self._is_bit(assignment.target) and is_repeatable(condition):
            return self._kept_bit(assignment.target, value, condition)
        draft = self._operation_draft(value, enable=condition)
        if draft is None:
            draft = BlockDraft("MOVE", call=self._call_kind(net.BlockCall.OPERATOR))
            block = standard_block("MOVE")
            assert block is not None  # noqa: S101
            draft.inputs = [("EN", self.power(condition)), (self._pin(block, "IN"), self.value(value))]
            draft.outputs = ["ENO", self._pin(block, "OUT")]
        item = self._block(draft, draft.outputs[-1], acting=False)
        return self._output(assignment.target, item, net.Storage.NONE)

    def _is_bit(self, target: Expression) -> bool:
        return self.rules.booleans.get(self._text(target).lower(), False)

    def _kept_bit(self, bit: Expression, value: Expression, condition: Expression) -> DrawnItem:
        """Draw ``bit := condition AND value OR NOT condition AND bit``: boxes of S7 with EN cannot write a BOOL."""
        passed = n.Operation(Operator.AND, (condition, value))
        held = n.Operation(Operator.AND, (n.Unary(Operator.NOT, condition), bit))
        return self.sink(bit, n.Operation(Operator.OR, (passed, held)), net.Storage.NONE)

    def _leave(self, statement: n.Goto | n.ReturnStatement, condition: Expression) -> DrawnItem | None:
        if isinstance(statement, n.ReturnStatement) and statement.value is not None:
            return None
        item = self._not_negated(self.power(condition))
        pin = input_pin(ROW / 2)
        number, order = self.new_id(), self.new_order()
        node: net.Node
        if isinstance(statement, n.Goto):
            text = statement.label.identifier
            node = net.Jump(id=number, label=text, input=pin, execution_order=order)
        else:
            text = "RETURN"
            node = net.Return(id=number, input=pin, execution_order=order)
        self.nodes.append(node)
        return placed(node, (text_width(text), ROW), [Slot(pin, ROW / 2, item)], [], ROW / 2)

    def _text_box(self, statement: Statement, enable: Expression | None, code: Sequence[Statement]) -> DrawnItem:
        """Return a statement that has no graphical form, as the text of an EXECUTE box."""
        tree = n.Statements(tuple(code))
        if self.rules.dialect not in (Dialect.CODESYS, Dialect.TWINCAT):
            tree = transform(tree, _without_storing)
        text = print_node(tree)
        draft = BlockDraft("EXECUTE", call=net.BlockCall.EXECUTE, code=text, outputs=["ENO"])
        draft.inputs = [("EN", self.power(enable) if enable is not None else None)]
        item = self._block(draft, None, acting=True)
        kind = type(statement).__name__
        message = f"a statement ({kind}) has no graphical form: kept as the text of an EXECUTE box of CODESYS"
        self.problems.append(NetworkProblem(message, self.nodes[-1].id, Severity.WARNING))
        return item

    # -- sinks

    def sink(self, target: Expression, value: Expression, storage: net.Storage) -> DrawnItem:
        """Return a value that is written to a variable."""
        return self._output(target, self.value(value), storage)

    def _output(self, target: Expression, item: DrawnItem, storage: net.Storage) -> DrawnItem:
        text = self._text(target)
        pin = input_pin(ROW / 2)
        node = unchecked(
            net.OutputVariable,
            id=self.new_id(),
            expression=text,
            input=pin,
            negated=item.negated,
            storage=storage,
            execution_order=self.new_order(),
        )
        self.nodes.append(node)
        return placed(node, (text_width(text), ROW), [Slot(pin, ROW / 2, item)], [], ROW / 2)

    # -- values

    def power(self, expression: Expression) -> DrawnItem:
        """Return a Boolean value that enables something: in a ladder it comes from the left power rail."""
        return self.value(expression)

    def value(self, expression: Expression) -> DrawnItem:
        """Return the elements of an expression."""
        expression = n.bare(expression)
        if isinstance(expression, n.Unary) and expression.operator is Operator.NOT:
            item = self.value(expression.operand)
            return item._replace(negated=not item.negated)
        if isinstance(expression, n.Member):
            call = self._pending_calls.get(path_of(expression.base))
            if call is not None and path_of(expression.base) not in self._started_calls:
                item = self._function_block(call, expression.name.identifier, None)
                self._drawn_calls.append(path_of(expression.base))
                return item
        # a call with effects would be executed before the function blocks that are not drawn yet
        if is_impure(expression) and len(self._drawn_calls) < len(self._pending_calls):
            self._order_violated = True
        draft = self._operation_draft(expression, enable=None)
        if draft is not None:
            return self._block(draft, draft.outputs[-1], acting=False)
        return self._input(expression)

    def _note_reading(self, expression: Expression) -> None:
        """Note that an element reads variables: it must not read those of a call that is not drawn yet."""
        waiting = self._pending_calls.keys() - self._started_calls
        if waiting and any(path[: len(p)] == p for path in reads(expression) for p in waiting):
            self._order_violated = True

    def _input(self, expression: Expression) -> DrawnItem:
        self._note_reading(expression)
        if isinstance(expression, n.Unreadable):
            self.problems.append(
                NetworkProblem(f"{expression.text!r} cannot be read; it is kept as the text of an input")
            )
        is_assignment = isinstance(expression, n.AssignmentExpression)
        text = self._text(n.Parenthesized(expression) if is_assignment else expression)
        width = text_width(text)
        pin = output_pin(width, ROW / 2)
        node = unchecked(net.InputVariable, id=self.new_id(), expression=text, output=pin)
        self.nodes.append(node)
        return placed(node, (width, ROW), [], [WireStart(node.id, None, (width, ROW / 2))], ROW / 2)

    def _not_negated(self, item: DrawnItem) -> DrawnItem:
        """Return an item whose value need not be inverted by the one who takes it: with a NOT block if it must be."""
        if not item.negated:
            return item
        block = standard_block("NOT")
        assert block is not None  # noqa: S101
        draft = BlockDraft("NOT", call=self._call_kind(net.BlockCall.OPERATOR))
        draft.inputs = [(self._pin(block, "IN"), item._replace(negated=False))]
        draft.outputs = [self._pin(block, "OUT")]
        return self._block(draft, draft.outputs[0], acting=False)

    def _operation_draft(self, expression: Expression, enable: Expression | None) -> BlockDraft | None:
        """Return the block of an operation or of the call of a function; None where it has none."""
        operands: list[tuple[str, Expression]]
        if isinstance(expression, n.Operation):
            block = operator_block(expression.operator)
            if block is None:
                return None
            if expression.operator in _FLAT:
                expression = joined(expression.operator, expression.operands)
            values = expression.operands if isinstance(expression, n.Operation) else (expression,)
            operands = [
                (self._pin(block, p.name), v) for p, v in zip(block.input_pins(len(values)), values, strict=True)
            ]
            draft = BlockDraft(block.name, call=self._call_kind(net.BlockCall.OPERATOR))
            draft.outputs = [self._pin(block, block.result.name)]
        elif isinstance(expression, n.Call):
            found = self._function(expression)
            if found is None:
                return None
            draft, operands = found
        else:
            return None
        if enable is not None:
            draft.inputs.append(("EN", self.power(enable)))
            draft.outputs.insert(0, "ENO")
        draft.inputs += [(name, self.value(value)) for name, value in operands]
        return draft

    def _function(self, call: n.Call) -> tuple[BlockDraft, list[tuple[str, Expression]]] | None:
        if not isinstance(call.callee, n.Name) or call.callee.quoting is not n.Quoting.NONE or not call.arguments:
            return None
        if any(a.output or a.value is None for a in call.arguments) or path_of(call.callee) in self._types:
            return None
        name = call.callee.identifier
        block = standard_block(name)
        given = [
            (a.name.identifier if a.name is not None else "", a.value) for a in call.arguments if a.value is not None
        ]
        names = [pin.casefold() for pin, _ in given if pin]
        # a block with a state needs an instance; EN and ENO are pins of the box, not of the function
        if (block is not None and block.stateful) or len(set(names)) < len(names) or {"en", "eno"} & {*names}:
            return None
        if block is not None:
            if not all(pin for pin, _ in given):
                pins = block.input_pins(len(given))
                if any(pin for pin, _ in given) or len(pins) != len(given):
                    return None
                given = [(p.name, value) for p, (_, value) in zip(pins, given, strict=True)]
            given = [(self._pin(block, block.input_name(pin) or pin), value) for pin, value in given]
            kind = net.BlockCall.OPERATOR if block.operator is not None else net.BlockCall.FUNCTION
            draft = BlockDraft(block.name, call=self._call_kind(kind), outputs=[self._pin(block, block.result.name)])
        else:
            draft = BlockDraft(
                name, call=self._call_kind(net.BlockCall.FUNCTION), outputs=[name if self.rules.tool else "OUT"]
            )
        return draft, given

    # -- calls

    def _call(self, statement: n.CallStatement, enable: Expression | None) -> DrawnItem | None:
        call = statement.call
        if isinstance(call, n.Call) and path_of(call.callee) in self._types and by_name(call, outputs=True):
            safe = enable is None or all(a.value is not None and is_harmless(a.value) for a in call.arguments)
            return self._with_sinks(call, self._function_block(call, None, enable)) if safe else None
        if isinstance(call, n.Call) and not call.arguments and self.rules.tool is Tool.CODESYS:
            return self._action(call, enable)
        return None

    def _action(self, call: n.Call, enable: Expression | None) -> DrawnItem:
        """Return a call of an action: a box without pins that is marked as one."""
        draft = BlockDraft(self._text(call.callee), call=net.BlockCall.ACTION)
        draft.inputs.append(("EN", self.power(enable) if enable is not None else None))
        draft.outputs.append("ENO")
        return self._block(draft, None, acting=True)

    def _with_sinks(self, call: n.Call, item: DrawnItem) -> DrawnItem:
        """Return the call of an instance with the variables that get its outputs (``Q => x``), each beside its pin."""
        block = self.nodes[-1]
        outputs = [a for a in call.arguments if a.output and a.name is not None and a.value is not None]
        if not outputs or not isinstance(block, net.Block):
            return item
        sinks: list[tuple[net.OutputVariable, str, float]] = []
        for argument in outputs:
            assert argument.name is not None and argument.value is not None  # noqa: PT018, S101
            name, text = argument.name.identifier, self._text(argument.value)
            places = {v.name: v.output.position for v in block.parameters.outputs if v.output is not None}
            row = (places.get(name) or (0, 0))[1]
            pin = input_pin(ROW / 2)
            sink = net.OutputVariable(id=self.new_id(), expression=text, input=pin, execution_order=self.new_order())
            self.nodes.append(sink)
            sinks.append((sink, name, row))

        def place(x: float, y: float) -> Area:
            area = item.place(x, y)
            right = bottom = 0.0
            edge = block.position[0] + (block.width or 0)
            for sink, name, row in sinks:
                line = block.position[1] + row
                sink.position = (edge + 2 * GRID, line - ROW / 2)
                sink.width, sink.height = text_width(sink.expression), ROW
                connect(
                    sink.input or net.InputPin(),
                    (edge + 2 * GRID, line),
                    [WireStart(block.id, name, (edge, line))],
                    edge,
                )
                right, bottom = max(right, sink.position[0] + sink.width), max(bottom, line + ROW / 2)
            return Area((), max(area.right, right), max(area.bottom, bottom))

        return DrawnItem(item.line, place)

    def _function_block(self, call: n.Call, output: str | None, enable: Expression | None) -> DrawnItem:
        """Return a call of an instance; `output`: which of its values is used."""
        path = path_of(call.callee)
        type_name = self._types[path]
        block = standard_block(type_name)
        is_operand = path in self._operands
        instance = self._text(call.callee)
        draft = BlockDraft(type_name, None if is_operand else instance, self._call_kind(net.BlockCall.FUNCTION_BLOCK))
        self._started_calls.add(path)  # an argument that reads the instance means its last value
        if enable is not None:
            draft.inputs.append(("EN", self.power(enable)))
            draft.outputs.append("ENO")
        for argument in call.arguments:
            if argument.output and argument.name is not None:
                draft.outputs.append(argument.name.identifier)
            elif argument.name is not None and argument.value is not None:
                name = argument.name.identifier
                powered = block is not None and is_power(block, name)
                item = self.power(argument.value) if powered else self.value(argument.value)
                draft.inputs.append((name, item))
        if is_operand:
            draft.operand = (MEMORY_PINS[type_name.upper()], instance)
            draft.outputs += [output] if output is not None else []
        elif block is not None:
            given = {block.input_name(name) for name, _ in draft.inputs}
            draft.inputs += [(self._pin(block, p.name), None) for p in block.inputs if p.name not in given]
            used = block.output_name(output) if output is not None else None
            named = {block.output_name(name) for name in draft.outputs}
            others = [p for p in block.outputs if p.name not in named]
            draft.outputs += [output or "" if p.name == used else self._pin(block, p.name) for p in others]
        if output is not None and output not in draft.outputs:
            draft.outputs.append(output)
        return self._block(draft, output, acting=True)

    # -- small things

    def _block(self, draft: BlockDraft, value: str | None, *, acting: bool) -> DrawnItem:
        node, item = draft.draw(self.new_id(), self.new_order() if acting else None, value)
        self.nodes.append(node)
        return item

    def _pin(self, block: StandardBlock, pin: str) -> str:
        return block.tool_pin(pin, self.rules.tool) if self.rules.tool is not None else pin

    def _call_kind(self, kind: net.BlockCall) -> net.BlockCall | None:
        """Return the kind of a call, which only CODESYS writes at each block."""
        return kind if self.rules.tool is Tool.CODESYS else None

    def _text(self, expression: Expression) -> str:
        if isinstance(expression, n.Member) and path_of(expression.base) in self._operands:
            expression = expression.base  # the output of such a box is what it keeps
        return print_node(expression)

    def new_id(self) -> int:
        """Return an id that no element has."""
        self._next_id += 1
        return self._next_id - 1

    def new_order(self) -> int:
        """Return the next place in the order of execution."""
        self._next_order += 1
        return self._next_order - 1


_STORAGES = {
    AssignmentKind.ASSIGN: net.Storage.NONE,
    AssignmentKind.SET: net.Storage.SET,
    AssignmentKind.RESET: net.Storage.RESET,
}
_FLAT = frozenset({Operator.AND, Operator.OR, Operator.XOR})


def _calls(statements: Iterable[Statement]) -> list[n.Call]:
    """Return the calls among statements."""
    called = (statement.call for statement in statements if isinstance(statement, n.CallStatement))
    return [call for call in called if isinstance(call, n.Call)]


def _without_storing(node: n.Node) -> n.Node:
    """Return ``x S= c`` as an IF, for dialects that have no ``S=``."""
    return (conditional_assignment(node) if isinstance(node, n.Assignment) else None) or node
