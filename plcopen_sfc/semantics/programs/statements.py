"""Translation of statements (ed. 3, 7.3.3), and the conditions that are TRUE at each statement."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.languages.networks.wires import inverted, joined
from plcopen_sfc.languages.problems import Lines
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import AssignmentKind, Expression, Operator, Statement
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.semantics.programs import runtime_types as t
from plcopen_sfc.semantics.programs.calls import Calls
from plcopen_sfc.semantics.programs.expressions import Translator
from plcopen_sfc.semantics.programs.marks import Decision, decided_arguments, decisions, may_act, parts_that_decide
from plcopen_sfc.semantics.programs.places import Place, Unknown
from plcopen_sfc.semantics.programs.runtime_types import MOST_ELEMENTS, Direction, StructureType
from plcopen_sfc.semantics.programs.value_code import Code, constant, settled, truth

_LEAVING = (n.ReturnStatement, n.Exit, n.Continue, n.Goto)


class Guards:
    """The conditions that hold at the statement which is being translated.

    A condition is forgotten behind a statement that may write one of its variables. What a statement writes is
    known of assignments and of calls of standard blocks; any other call may write everything. Where they are not
    `wanted`, there are none.
    """

    def __init__(self, translator: Translator, *, wanted: bool) -> None:
        self._translator = translator
        self._wanted = wanted
        self.holding: tuple[Expression, ...] = ()
        self._found: dict[int, tuple[Expression, frozenset[str] | None]] = {}

    def enter(self, conditions: Sequence[Expression]) -> tuple[Expression, ...]:
        """Assume conditions from here on, evaluated in this order; return those that are TRUE at first.

        A condition that may write something is TRUE at first, but may be FALSE as soon as it is evaluated again.
        """
        found = self.holding
        for condition in conditions if self._wanted else ():
            self.forget(condition)
            found = (*self.holding, condition)
            if self._written(condition) == frozenset():
                self.holding = found
        return found

    def forget(self, node: n.Node) -> None:
        """Forget what a statement may change."""
        if not self.holding:
            return
        written = self._written(node)
        if written is None:
            self.holding = ()
        elif written:
            roots = [self._roots(each) for each in self.holding]
            kept = [known is not None and not known & written for known in roots]
            self.holding = tuple(each for each, stays in zip(self.holding, kept, strict=True) if stays)

    def pass_by(self, statement: n.Statement) -> None:
        """Go on behind a statement: a branch that does not come back leaves the opposite of its condition."""
        self.forget(statement)
        if isinstance(statement, n.If):
            for branch in statement.branches:
                if not branch.statements or not isinstance(branch.statements[-1], _LEAVING):
                    break
                self.enter([inverted(branch.condition)])

    def _written(self, node: n.Node) -> frozenset[str] | None:
        """Return the roots of the variables that something writes; None: it may write any."""
        found: set[str] = set()
        for target in self._targets(node):
            root = self._root(target) if target is not None else ""
            if not root:
                return None
            found.add(root)
        return frozenset(found)

    def _roots(self, condition: Expression) -> frozenset[str] | None:
        """Return the roots of the variables in a condition; None: not all of them are known."""
        if id(condition) not in self._found:  # a long CASE asks for each of its conditions in each of its branches
            self._found[id(condition)] = condition, self._roots_in(condition)
        return self._found[id(condition)][1]

    def _roots_in(self, condition: Expression) -> frozenset[str] | None:
        members = {id(node.name) for node in walk(condition) if isinstance(node, n.Member)}
        callees = {id(node.callee) for node in walk(condition) if isinstance(node, n.Call)}
        found: set[str] = set()
        for node in walk(condition):
            if isinstance(node, n.Address | n.Dereference):
                return None
            if isinstance(node, n.Name) and id(node) not in members | callees:
                root = self._root(node)
                if root is None:
                    continue
                if not root:
                    return None
                found.add(root)
        return frozenset(found)

    def _root(self, target: Expression) -> str | None:
        """Key of the variable at the beginning of a path; empty: it may be several; None: it is no variable."""
        while isinstance(target, n.Member | n.Index | n.Parenthesized):
            target = target.inner if isinstance(target, n.Parenthesized) else target.base
        if not isinstance(target, n.Name):
            return ""
        try:
            found = self._translator.meaning(target)
        except SimulationError:
            return ""
        if not isinstance(found, Place):
            return None
        if found.field is not None and found.field.direction is Direction.IN_OUT:
            return ""
        return "g" if found.root.startswith("g") else found.root  # addresses of global variables may overlap

    def _targets(self, node: n.Node) -> Iterator[Expression | None]:
        """Keys of the variables that something writes; None: it may write anything."""
        for each in walk(node):
            match each:
                case n.Assignment(kind=AssignmentKind.REFERENCE | AssignmentKind.ATTEMPT):
                    yield None
                case n.Assignment(target=target) | n.AssignmentExpression(target=target) | n.For(variable=target):
                    yield target
                case n.Call():
                    yield from self._written_by_call(each)
                case n.EmbeddedCode() | n.Try():
                    yield None
                case n.CallStatement(call=call) if not isinstance(call, n.Call):
                    yield None

    def _written_by_call(self, call: n.Call) -> Iterator[Expression | None]:
        yield from (each.value for each in call.arguments if each.output and each.value is not None)
        block = standard_block(call.called)
        if block is not None and not block.stateful:
            return
        try:
            called = self._translator.meaning(call.callee, called=True)
        except SimulationError:
            called = None
        is_timer = isinstance(called, Place) and isinstance(called.type, StructureType)
        if is_timer and self._translator.library.block_of(called.type.layout) is not None:
            yield call.callee
        else:
            yield None


def case_condition(selector: Expression, branch: n.CaseBranch) -> Expression:
    """Conditions that are TRUE in a branch of CASE."""
    selector = n.Parenthesized(selector)
    labels: list[Expression] = []
    for label in branch.labels:
        if isinstance(label, n.Range):
            lower = n.Operation(Operator.GREATER_OR_EQUAL, (selector, label.lower))
            upper = n.Operation(Operator.LESS_OR_EQUAL, (selector, label.upper))
            labels.append(n.Operation(Operator.AND, (lower, upper)))
        else:
            labels.append(n.Operation(Operator.EQUAL, (selector, label)))
    return joined(Operator.OR, labels)


_MANY_LABELS = 6
_MOST_LABELS = 64
_Branch = tuple[str, Sequence[n.Expression], Sequence[Statement]]
"""A branch of CASE: what leads to it, as text and as what is TRUE in it, and its statements."""
_SHOWN = 60


class StatementTranslator:
    """Writes the statements of a body. An untranslatable one becomes an error where it is reached."""

    def __init__(self, translator: Translator, path: str, text: str | None = None) -> None:
        self._translator = translator
        self._writer = translator.writer
        self._library = translator.library
        self._calls = Calls(translator)
        self._path = path
        self._lines = Lines(text) if text is not None else None
        self._labels: dict[str, int] = {}
        self._loops: list[str] = []
        self._marks = translator.library.marks
        self._branch = -1
        self._guards = Guards(translator, wanted=self._marks is not None)

    def body(self, statements: Sequence[Statement]) -> None:
        """Translate a whole body: labels may be between its statements."""
        if statements:
            self.enter("")
        labels = [s.label.identifier for s in statements if isinstance(s, n.LabelStatement)]
        parts: list[list[Statement]] = [[]]
        for statement in statements:
            if isinstance(statement, n.LabelStatement):
                parts.append([])
            else:
                parts[-1].append(statement)
        self.parts(labels, [partial(self.all, part) for part in parts])

    def parts(self, labels: Sequence[str], parts: Sequence[Callable[[], None]]) -> None:
        """Parts of a body between its labels."""
        if not labels:
            parts[0]()
            return
        self._labels = {label.casefold(): index + 1 for index, label in enumerate(labels)}
        # a jump goes back to the head of this loop and passes by all parts before its label
        self._writer.write("_to = 0")
        with self._writer.block("while True:"):
            self._count_turn()
            for index, part in enumerate(parts):
                self._guards.holding = ()  # a jump may lead here
                with self._writer.block(f"if _to <= {index}:"):
                    part()
            self._writer.write("break")

    def all(self, statements: Sequence[Statement]) -> None:
        """Statements behind each other."""
        for statement in statements:
            self.one(statement)
            self._guards.pass_by(statement)

    def one(self, statement: Statement) -> None:
        """Translate a statement."""
        if self._lines is not None and statement.span is not None:
            self._writer.origin = self._lines.place(statement.span[0])[0]
        mark = self._writer.mark()
        try:
            self._translate(statement)
        except SimulationError as error:
            self._writer.rollback(mark)
            self.fail(error)

    def fail(self, error: SimulationError, *, at_line: bool = False) -> None:
        """Translate a statement; one that cannot be translated is an error where it is reached."""
        if error.location.path is None:
            known = at_line or self._lines is not None
            error.location = Location(path=self._path, line=self._writer.origin if known else None)
        self._library.problems.append(error)
        self._writer.write(f"fail({self._library.linker.name(error, 'e')})")

    def _translate(self, statement: Statement) -> None:
        match statement:
            case n.Assignment():
                self._assignment(statement)
            case n.CallStatement(call=call):
                self.call(call)
            case n.If(branches=branches, otherwise=otherwise):
                self._if(branches, otherwise)
            case n.Case():
                self._case(statement)
            case n.For():
                self._for(statement)
            case n.While(condition=condition, statements=statements):
                self._guards.forget(statement)
                with self._writer.block("while True:"):
                    self._count_turn()
                    self._watch_conditions([condition], [statements])
                    with self._writer.block(f"if not {self._truth(condition).text}:"):
                        self._writer.write("break")
                    with self._within(condition, [condition]):
                        self._inside("", statements)
            case n.Repeat(statements=statements, condition=condition):
                self._guards.forget(statement)
                self._repeat(statements, condition)
            case n.RegionBlock(statements=statements):
                self.all(statements)
            case n.Exit() | n.Continue():
                self._leave_loop(statement)
            case n.ReturnStatement(value=value):
                if value is not None:
                    raise SimulationError("RETURN with a value is not known to the simulator")
                self._writer.write("return")
            case n.Goto(label=label):
                self.goto(label.identifier)
            case n.Empty():
                pass
            case n.LabelStatement():
                raise SimulationError("a label inside of other statements is not known to the simulator")
            case n.Try():
                raise SimulationError("__TRY is not known to the simulator")
            case n.EmbeddedCode(text=text):
                shown = " ".join(text.split())
                shown = shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}.."
                raise SimulationError(f"code in C is not known to the simulator: {shown}")
            case _:
                raise SimulationError("this is no statement")

    def call(self, node: n.Expression) -> None:
        """Write a call."""
        self._watch_arguments(node)
        self._calls.statement(node)

    def _truth(self, node: n.Expression) -> Code:
        return truth(self._translator.value(node, t.BOOL))

    # -- assignments

    def _assignment(self, node: n.Assignment) -> None:
        translator = self._translator
        if node.kind is AssignmentKind.REFERENCE:
            self._refer(node)
            return
        if node.kind is AssignmentKind.ATTEMPT:
            raise SimulationError("?= is not known to the simulator")
        if node.kind in (AssignmentKind.SET, AssignmentKind.RESET):
            self._watch_conditions([node.value])
            with self._writer.block(f"if {self._truth(node.value).text}:"), self._within(node.value, [node.value]):
                self.note(_told(node))
                place = translator.place(node.target, t.BOOL)
                translator.note_write(place)
                value = constant(node.kind is AssignmentKind.SET, t.BOOL)
                translator.write(place, translator.fitted(value, place.type))
            return
        assigned = node.value
        if node.kind in n.CALCULATING_ASSIGNMENTS:
            assigned = n.Operation(n.CALCULATING_ASSIGNMENTS[node.kind], (node.target, n.Parenthesized(assigned)))
        known = translator.meaning(node.target)
        wanted: t.Type | None = None
        if isinstance(known, Place):
            wanted = known.type
        elif isinstance(known, Unknown):
            wanted = self._library.implicit_type(known.path)
        if wanted is None:
            wanted = translator.guessed(assigned)
        place = translator.place(node.target, wanted)
        if isinstance(known, Place) and isinstance(known.type, t.ReferenceType) and known.type.automatic:
            place = translator.followed(known, None)
        translator.note_write(place)
        self._watch_arguments(node)
        before = translator.comparisons
        code = settled(translator.fitted(translator.value(assigned, place.type), place.type))
        if self._marks is not None and code.type is t.BOOL and not code.constant and translator.comparisons > before:
            self._watch([(print_node(node.value), parts_that_decide(assigned))])
            held = self._writer.temporary()
            first = self._marks.outcomes(self._branch, _told(node), assigned, self._guards.holding)
            self._writer.write(f"{held} = {code.text}; m[{first} + (1 if {held} else 0)] = True")
            code = replace(code, text=held)
        translator.write(place, code)
        self.note(_told(node))

    def _refer(self, node: n.Assignment) -> None:
        """``reference REF= variable``."""
        held = self._translator.meaning(node.target)
        if isinstance(held, Unknown) or (isinstance(held, Place) and isinstance(held.type, t.OpaqueType)):
            name = print_node(node.target)
            raise SimulationError(f"REF= needs the type of {name}, which nothing here declares: load the whole project")
        if not isinstance(held, Place) or not isinstance(held.type, t.ReferenceType):
            raise SimulationError(f"{print_node(node.target)} is no reference")
        if isinstance(node.value, n.Literal):
            self._writer.write(f"{held.text} = None")
            return
        target = self._translator.place(node.value)
        self._library.use.written.add(held.root)
        self._translator.note_pointed(target)
        self._writer.write(f"{held.text} = Pointer({target.cells}, {target.index})")

    # -- branches

    def enter(self, condition: n.Node | str, known: Sequence[n.Expression] = ()) -> None:
        """Mark what follows as a branch that `condition` leads to, where somebody wants to know what is reached.

        `known` is what is TRUE at its beginning.
        """
        guards = self._guards.enter(known)
        if self._marks is not None:
            text = condition if isinstance(condition, str) else print_node(condition)
            self._branch = self._marks.branch(self._path, text, guards)
            self._writer.write(f"m[{self._branch}] = True")

    @contextmanager
    def _within(self, condition: n.Node | str, known: Sequence[n.Expression] = ()) -> Iterator[None]:
        outer, holding = self._branch, self._guards.holding
        self.enter(condition, known)
        yield
        self._branch, self._guards.holding = outer, holding

    # -- what conditions come to

    def _watch_conditions(self, conditions: Sequence[n.Expression], inside: Sequence[Sequence[Statement]] = ()) -> None:
        """Look at the outcomes and parts of conditions, of which each is tested where those before it are FALSE.

        `inside`: what they lead to; assignments there tell by themselves that they were executed.
        """
        found: list[tuple[str, Iterable[Decision]]] = []
        before: list[n.Expression] = []
        for number, condition in enumerate(conditions):
            if self._marks is not None:
                self._marks.divides(self._branch, condition, (*self._guards.holding, *before))
            assigns = any(isinstance(each, n.Assignment) for each in (inside[number] if inside else ()))
            found.append((print_node(condition), list(decisions(condition, before))[assigns:]))
            found += [(print_node(each), list(decisions(each, before))) for each in decided_arguments(condition)]
            if any(map(may_act, walk(condition))):
                break  # what follows is only known to be tested when it has been
            before.append(inverted(condition))
        self._watch(found)

    def _watch_arguments(self, node: n.Node) -> None:
        """Look at the arguments of calls that compare, and at indexes that are inputs."""
        if self._marks is not None:
            self._marks.divides(self._branch, node, self._guards.holding)
        found = [(print_node(each), decisions(each)) for each in decided_arguments(node)]
        self._watch([*found, *self._indexes(node)] if self._marks is not None else ())

    def _indexes(self, node: n.Node) -> Iterator[tuple[str, Iterable[Decision]]]:
        """Yield the indexes that are inputs, with the values that they can have."""
        for each in walk(node):
            if not isinstance(each, n.Index) or not isinstance(n.bare(each.indices[0]), n.Name):
                continue
            array, index = self._translator.meaning(each.base), self._translator.meaning(each.indices[0])
            known = index.known if isinstance(index, Place) else None
            if (
                known is None
                or not known.input
                or not isinstance(array, Place)
                or not isinstance(array.type, t.ArrayOf)
            ):
                continue
            lower, upper = array.type.dimensions[0] if array.type.dimensions else (0, 0)
            values = range(lower, upper + 1) if upper - lower < MOST_ELEMENTS else (lower, upper)
            equal = [n.Operation(Operator.EQUAL, (each.indices[0], n.Literal(str(value)))) for value in values]
            yield print_node(each), [(print_node(tree), True, tree) for tree in equal]

    def _watch_selector(self, node: n.Case) -> None:
        """Watch the labels of CASE, where several lead to a branch; and if no label fits, unless it selects a state."""
        conditions = [case_condition(node.selector, branch) for branch in node.branches]
        found: list[tuple[str, Iterable[Decision]]] = []
        if len(conditions) <= _MOST_LABELS:
            for condition in conditions:
                found.append(
                    (print_node(condition), [("", True, condition), *parts_that_decide(condition)][:_MOST_LABELS])
                )
        if not isinstance(n.bare(node.selector), n.Name | n.Member):
            whole = joined(Operator.OR, conditions)
            found.append((print_node(node.selector), [("any label", False, inverted(n.Parenthesized(whole)))]))
        self._watch(found)

    def _watch(self, conditions: Sequence[tuple[str, Iterable[Decision]]]) -> None:
        """Write what looks at conditions, as long as something was not seen; those that may act are left alone."""
        known = [
            (shown, each)
            for shown, decisions in conditions
            for each in decisions
            if not any(map(may_act, walk(each[2])))
        ]
        if self._marks is None or not known:
            return
        mark, first = self._writer.mark(), len(self._marks.branches)
        group = self._marks.group()
        try:
            with self._translator.remembering(), self._writer.block(f"if w[{group}]:"):
                for shown, (part, value, deciding) in known:
                    code = self._truth(deciding)
                    if code.constant:
                        continue
                    guards = (*self._guards.holding, deciding)
                    number = self._marks.decision(self._branch, shown, part, value, guards)
                    with self._writer.block(f"if not m[{number}]:"):
                        with self._writer.block("try:"):
                            self._writer.write(f"m[{number}] = bool({code.text})")
                        with self._writer.block("except Unseen:"):
                            self._writer.write("pass")
                self._writer.write(f"w[{group}] = not all(m[{first}:{len(self._marks.branches)}])")
        except SimulationError:  # the statement itself tells what is wrong
            self._writer.rollback(mark)
            self._marks.forget(first)

    def note(self, assignment: str) -> None:
        """Note an assignment of the present branch."""
        if self._marks is not None:
            self._marks.branches[self._branch].assignments.append(assignment)

    def _if(self, branches: Sequence[n.Branch], otherwise: Sequence[Statement] | None) -> None:
        """IF. Preparations of a condition are part of the expression, so ELSIF stays one statement."""
        others: list[n.Expression] = []
        self._watch_conditions([each.condition for each in branches], [each.statements for each in branches])
        for index, branch in enumerate(branches):
            word = "elif" if index else "if"
            known = [*others, branch.condition]
            others.append(inverted(branch.condition))
            with self._writer.block(f"{word} {self._truth(branch.condition).text}:"):  # noqa: SIM117
                with self._within(branch.condition, known):
                    self.all(branch.statements)
        if otherwise:
            with self._writer.block("else:"), self._within("ELSE", others):
                self.all(otherwise)

    def _case(self, node: n.Case) -> None:
        selector = settled(self._translator.value(node.selector, t.DINT))
        self._watch_selector(node)
        held = self._writer.temporary()
        self._writer.write(f"{held} = {selector.text}")
        branches: list[tuple[list[tuple[int, int]], _Branch]] = []
        others: list[n.Expression] = []
        taken: list[tuple[int, int]] = []
        for branch in node.branches:
            labels = [self._label(label, selector.type) for label in branch.labels]
            text = f"{print_node(node.selector)} = {', '.join(map(print_node, branch.labels))}"
            condition = case_condition(node.selector, branch)
            overlaps = any(low <= end and start <= high for low, high in labels for start, end in taken)
            branches.append((labels, (text, [*others, condition] if overlaps else [condition], branch.statements)))
            taken += labels
            others.append(inverted(condition))
        single = all(low == high for labels, _ in branches for low, high in labels)
        if single and len(branches) > _MANY_LABELS:
            self._search(held, branches, node.otherwise, others)
            return
        word = "if"
        for labels, (text, known, statements) in branches:
            with self._writer.block(f"{word} {_matches(held, labels)}:"), self._within(text, known):
                self.all(statements)
            word = "elif"
        if node.otherwise:
            with self._writer.block("else:" if branches else "if True:"), self._within("ELSE", others):
                self.all(node.otherwise)

    def _label(self, label: n.Expression | n.Range, type_: t.Type) -> tuple[int, int]:
        ends = (label.lower, label.upper) if isinstance(label, n.Range) else (label, label)
        values = []
        for end in ends:
            code = self._translator.value(end, type_)
            if not code.constant or not isinstance(code.value, int):
                raise SimulationError(f"{print_node(end)} is a label of CASE, but no constant")
            values.append(int(code.value))
        return values[0], values[1]

    def _search(
        self,
        held: str,
        branches: list[tuple[list[tuple[int, int]], _Branch]],
        otherwise: Sequence[Statement] | None,
        others: Sequence[n.Expression],
    ) -> None:
        """Many labels: the number of the branch is looked up, and found by halving."""
        table: dict[int, int] = {}
        for index, (labels, _) in enumerate(branches):
            for label, _ in labels:
                table.setdefault(label, index)  # the first one that has the label is taken
        name = self._library.linker.name(table, "case")
        self._writer.write(f"{held} = {name}.get({held}, -1)")
        self._halve(held, [branch for _, branch in branches], 0)
        if otherwise:
            with self._writer.block(f"if {held} < 0:"), self._within("ELSE", others):
                self.all(otherwise)

    def _halve(self, held: str, branches: list[_Branch], first: int) -> None:
        if len(branches) == 1:
            text, known, statements = branches[0]
            with self._writer.block(f"if {held} == {first}:"), self._within(text, known):
                self.all(statements)
            return
        middle = len(branches) // 2
        with self._writer.block(f"if {held} < {first + middle}:"):
            self._halve(held, branches[:middle], first)
        with self._writer.block("else:"):
            self._halve(held, branches[middle:], first + middle)

    # -- loops

    def _count_turn(self) -> None:
        self._writer.write("p.left -= 1")
        self._writer.write("if p.left < 0: endless()")

    def _inside(self, on_continue: str, statements: Sequence[Statement]) -> None:
        self._loops.append(on_continue)
        self.all(statements)
        self._loops.pop()

    def _leave_loop(self, node: n.Exit | n.Continue) -> None:
        if not self._loops:
            raise SimulationError("EXIT and CONTINUE belong into a loop")
        if isinstance(node, n.Exit):
            self._writer.write("break")
            return
        for line in filter(None, self._loops[-1].split("\n")):
            self._writer.write(line)
        self._writer.write("continue")

    def _for(self, node: n.For) -> None:
        translator = self._translator
        place = translator.place(node.variable, t.DINT)
        translator.note_write(place)
        type_ = place.type
        if not isinstance(type_, t.ScalarType) or not type_.is_number or place.bits is not None:
            raise SimulationError(f"{place.path} is a {type_.name}, which does not count")
        start, end = (
            settled(translator.fitted(translator.value(node_, type_), type_)) for node_ in (node.start, node.end)
        )
        step = settled(translator.fitted(translator.value(node.step, type_), type_)) if node.step is not None else None
        if not (start.constant and end.constant) and (step is None or step.constant):
            order = Operator.LESS_OR_EQUAL if step is None or step.value > 0 else Operator.GREATER_OR_EQUAL
            self._watch_conditions([n.Operation(order, (node.start, node.end))])
        if self._library.profile.for_asks_ahead:
            self._writer.write(f"{place.text} = {start.text}")
            self._turns_asking_ahead(node, place.text, type_, end, step)
            return
        last, by = self._writer.temporary(), self._writer.temporary()
        self._writer.write(f"{last} = {end.text}")
        if step is not None and not step.constant:
            self._writer.write(f"{by} = {step.text}")
        variable = place.text
        self._writer.write(f"{variable} = {start.text}")
        if step is None or step.constant:
            amount = step.value if step is not None else 1
            if amount == 0:
                raise SimulationError("FOR goes on by 0: it would not end")
            condition = f"{variable} <= {last}" if amount > 0 else f"{variable} >= {last}"
            by_text, bounds = repr(amount), (amount, amount)
        else:
            condition = f"({variable} <= {last} if {by} > 0 else {variable} >= {last})"
            by_text, bounds = by, (step.low, step.high)
        moved = Code(f"({variable} + {by_text})", type_, type_.least + bounds[0], type_.greatest + bounds[1])
        # the variable is not kept in its bounds by the loop itself: the turn after the last one may leave a subrange
        following = f"{variable} = {settled(moved).text}"
        self._guards.forget(node)
        with self._writer.block(f"while {condition}:"):
            self._count_turn()
            with self._within(f"FOR {print_node(node.variable)}"):
                self._inside(following, node.statements)
            self._writer.write(following)

    def _turns_asking_ahead(
        self, node: n.For, variable: str, type_: t.ScalarType, end: Code, step: Code | None
    ) -> None:
        """Write the turns of a FOR as matiec compiles it: `Profile.for_asks_ahead`."""
        if step is not None and step.constant and step.value == 0:
            raise SimulationError("FOR goes on by 0: it would not end")
        by, bounds = ("1", (1, 1)) if step is None else (step.text, (step.low, step.high))
        moved = Code(f"({variable} + {by})", type_, type_.least + bounds[0], type_.greatest + bounds[1])
        ahead = f"{variable} + {by}"
        within = f"({ahead} <= {end.text} if {by} > 0 else {ahead} >= {end.text})"
        again = self._writer.temporary()
        self._writer.write(f"{again} = False")
        self._guards.forget(node)
        with self._writer.block(f"while {within}:"):
            with self._writer.block(f"if {again}:"):
                self._writer.write(f"{variable} = {settled(moved).text}")
            self._writer.write(f"{again} = True")
            self._count_turn()
            with self._within(f"FOR {print_node(node.variable)}"):
                self._inside("", node.statements)

    def _repeat(self, statements: Sequence[Statement], condition: n.Expression) -> None:
        again = self._writer.temporary()
        self._writer.write(f"{again} = False")
        with self._writer.block("while True:"):
            # CONTINUE goes to the condition, which therefore is at the beginning of the next turn
            with self._writer.block(f"if {again}:"):
                self._watch_conditions([condition])
                with self._writer.block(f"if {self._truth(condition).text}:"):
                    self._writer.write("break")
            self._writer.write(f"{again} = True")
            self._count_turn()
            self._inside("", statements)

    def goto(self, label: str) -> None:
        """Write a jump to a label."""
        index = self._labels.get(label.casefold())
        if index is None:
            raise SimulationError(f"the label {label} is not among the outermost statements of the body")
        if self._loops:
            raise SimulationError("a jump out of a loop is not known to the simulator")
        self._writer.write(f"_to = {index}")
        self._writer.write("continue")


def _told(statement: n.Statement) -> str:
    """Return a statement as coverage names it: without the semicolon, as a sentence goes on behind it."""
    return print_node(statement).removesuffix(";")


def _matches(held: str, labels: list[tuple[int, int]]) -> str:
    singles = [low for low, high in labels if low == high]
    tests = [f"{held} == {singles[0]}"] if len(singles) == 1 else []
    tests += [f"{held} in ({', '.join(map(str, singles))})"] if len(singles) > 1 else []
    tests += [f"{low} <= {held} <= {high}" for low, high in labels if low != high]
    return " or ".join(tests)
