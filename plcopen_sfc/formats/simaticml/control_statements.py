"""Statements of an action control, in SCL: what the flags of its steps, its qualifiers and its times come to.

There are two ways to compute it. In IEC 61131-3 all associations of an action act together (ACTION_CONTROL, ed. 3,
6.7.4.6): `ControlDraft.together`. In the C code of matiec they act one after the other, and the last one that decides
counts: `ControlDraft.in_turn`. A variable is written only where one of them decides. ``K2`` with L in Fill and R in
Fault::

    #K2_on := #Fill.X AND NOT #K2_late;
    IF #K2_on THEN #K2 := TRUE; END_IF;
    IF #Fault.X OR ((#Fill.X OR #K2_acted) AND NOT #K2_on) THEN #K2 := FALSE; END_IF;
    #K2_acted := #Fill.X;
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from plcopen_sfc.languages.networks import NetworkExpression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node
from plcopen_sfc.languages.st.literals import duration_of
from plcopen_sfc.languages.words import needs_quotes, take_name
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import ActionAssociation, Condition, Step
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, Variable

Q = Qualifier
RESETS = (Q.R, Q.R0)
PLAIN = (Q.N, Q.NONE)

Rows = Sequence[tuple[Step, ActionAssociation]]


class ImpossibleError(Exception):
    """No network expresses a control."""


@dataclass(frozen=True)
class FlagTexts:
    """What networks need for the SFC flags of a chart, as texts in SCL.

    `lines`: their statements. `ends`: the flags that end steps, and what these store. `stops`: the variable that is
    TRUE while the chart stops, and all operands keep their values.
    """

    lines: Sequence[str] = ()
    ends: Sequence[str] = ()
    stops: str = ""


NO_FLAGS = FlagTexts()


@dataclass
class ControlDraft:
    """The control of one action while it is planned: added variables, and statements.

    `operand`: the Boolean variable that it is, if it is no code. `read`: translates conditions. `taken`: names of the
    block, which grow. `flags`: those of the chart.
    """

    label: str
    operand: str
    read: Callable[[Condition], NetworkExpression]
    taken: set[str]
    flags: FlagTexts
    variables: list[Variable] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)

    def together(self, rows: Rows) -> tuple[str, str]:
        """Return the conditions of the output with a final scan, and of that without; empty for never."""
        reset = self.plain("reset", self._on(rows, *RESETS))
        lasting = self._masked(list(self._parts(rows, reset)), reset)
        return lasting, self._masked(list(self._pulses(rows)), reset)

    def _parts(self, rows: Rows, reset: str) -> Iterator[str]:
        """Yield the conditions of the output with a final scan."""

        def timed(qualifier: Qualifier, role: str, start: str) -> str:
            name = self.timer(role)
            time = self._time(role, [(step, row) for step, row in rows if row.qualifier is qualifier])
            self.lines.append(f"{name}(IN := {self.plain(role, start)}, PT := {time});")
            return self.assigned(role, f"{name}.Q")

        def stored(role: str, start: str) -> str:
            bit = self.bit(role)
            kept = or_([self._masked([bit], or_(self.flags.ends)), start])
            self.lines.append(f"{bit} := {self._masked([kept], reset)};")
            return bit

        if plain := self._on(rows, *PLAIN):
            yield plain
        if start := self._on(rows, Q.S):
            yield stored("stored", start)
        if start := self._on(rows, Q.L):
            yield and_([start, not_(timed(Q.L, "limit", start))])
        if start := self._on(rows, Q.D):
            yield timed(Q.D, "delay", start)
        if start := self._on(rows, Q.P):
            yield self._edge("pulse", start)
        if start := self._on(rows, Q.SD):
            yield timed(Q.SD, "late", stored("waits", start))
        if start := self._on(rows, Q.DS):
            # a delay that ends while the chart stops stores nothing yet: its step may be left when the chart goes on
            yield stored("kept", self._masked([timed(Q.DS, "wait", start)], self.flags.stops))
        if start := self._on(rows, Q.SL):
            bit = stored("begun", start)
            yield and_([bit, not_(timed(Q.SL, "end", bit))])

    def _time(self, role: str, rows: Rows) -> str:
        """Return the time of a timer: where the associations have different ones, that of the active step."""
        times = {row.duration for _, row in rows}
        if None in times:
            raise ImpossibleError
        if len(times) == 1:
            return str(times.pop())
        time = self.preset(role)
        self.lines += [f"IF {self._acts(step, row)} THEN {time} := {row.duration}; END_IF;" for step, row in rows[::-1]]
        return time

    def _pulses(self, rows: Rows) -> Iterator[str]:
        """Yield the conditions that make the output TRUE for one scan, without a final one."""
        if start := self._on(rows, Q.P1):
            yield self._edge("start", start)
        if start := self._on(rows, Q.P0):
            yield self._edge("stop", start, falling=True)

    def _edge(self, role: str, start: str, *, falling: bool = False) -> str:
        start = self.plain(f"{role}_begins", start)
        bit, before = self.bit(role), self.bit(f"{role}_before")
        now = [self._masked([not_(start)], or_(self.flags.ends)), before] if falling else [start, not_(before)]
        self.lines += [f"{bit} := {and_(now)};", f"{before} := {start};"]
        return bit

    def in_turn(self, rows: Rows) -> str:
        """Return the condition of the output of matiec; a Boolean variable is written by the statements themselves."""
        return _InTurn(self, rows).output()

    # -- texts

    def _on(self, rows: Rows, *qualifiers: Qualifier) -> str:
        """TRUE while an association with one of the qualifiers acts; empty without one."""
        return or_(self._acts(step, row) for step, row in rows if row.qualifier in qualifiers)

    def _acts(self, step: Step, row: ActionAssociation) -> str:
        return and_([acting(step, row), self.condition(row)])

    def condition(self, row: ActionAssociation) -> str:
        """Return the condition of an association; empty without one."""
        if row.condition is None:
            return ""
        found = self.read(row.condition)
        if found.tree is None or found.before or found.helpers or not found.complete:
            raise ImpossibleError
        return print_node(found.tree)

    def plain(self, role: str, text: str) -> str:
        """Return an expression that a contact can negate: it becomes a bit, unless it is one."""
        return self.assigned(f"{role}_input", text) if " " in text else text

    def assigned(self, role: str, text: str) -> str:
        """Return a new bit with the value of an expression."""
        bit = self.bit(role)
        self.lines.append(f"{bit} := {text};")
        return bit

    def _masked(self, parts: list[str], reset: str) -> str:
        wanted = or_(parts)
        return and_([wanted, not_(reset)]) if wanted and reset else wanted

    def kept(self, name: str, wanted: str) -> str:
        """Return the assignment to a variable that keeps its value while a flag stops the chart."""
        if stops := self.flags.stops:
            wanted = or_([and_([stops, name]), self._masked([wanted], stops)])
        return f"{name} := {wanted};"

    def executed(self, active: str, ended: str, pulses: str) -> str:
        """Return the condition on which code is executed: while it is active, in its final scan, and by pulses."""
        wanted = or_([active, self._masked([ended], or_(self.flags.ends)), pulses])
        return self._masked([wanted], self.flags.stops)

    def bit(self, role: str, *, initial: bool = False) -> str:
        """Return a new Boolean variable."""
        return self._variable(role, ElementaryType(name=Elementary.BOOL), "TRUE" if initial else None)

    def timer(self, role: str) -> str:
        """Return a new on-delay timer."""
        return self._variable(f"{role}_time", DerivedType(name="TON_TIME"))

    def preset(self, role: str) -> str:
        """Return a new variable for the time of a timer."""
        return self._variable(f"{role}_preset", ElementaryType(name=Elementary.TIME))

    def _variable(self, role: str, type_: ElementaryType | DerivedType, initial: str | None = None) -> str:
        stem = "".join(each if each.isalnum() else "_" for each in self.label)
        name = take_name(f"{stem}_{role}", self.taken)
        self.variables.append(Variable(name=name, type=type_, initial=initial))
        return f"#{name}"


class _Delay:
    """A time of matiec that runs on when its step has been left: at its end an action is set, or reset.

    The timer is called at the start of the statements, for what ends in this scan, and twice at their end: one that
    begins again while it runs, and one that begins, count from this scan on.
    """

    def __init__(self, draft: ControlDraft, role: str, rows: Iterable[ActionAssociation]) -> None:
        times = {row.duration for row in rows}
        self._draft, self._role = draft, role
        self._begins: list[str] = []
        self.over = ""
        if not times:
            return
        if None in times or any(duration_of(time or "", Dialect.SCL) == 0 for time in times):
            raise ImpossibleError  # one of zero never ends in the code of matiec
        literal = times.pop() if len(times) == 1 else None
        self._has_preset = literal is None or duration_of(literal, Dialect.SCL) is None
        self._preset = draft.preset(role) if self._has_preset else str(literal)
        self._timer, self._runs = draft.timer(role), draft.bit(f"{role}_runs")
        self._call(self._runs)
        self.over = draft.assigned(role, f"{self._timer}.Q")

    def start(self, begins: str, row: ActionAssociation) -> None:
        """Start it where a condition, a bit, holds."""
        self._begins.append(begins)
        if not self._has_preset:
            self._draft.lines.append(f"IF {begins} THEN {self._runs} := TRUE; END_IF;")
            return
        lasts = or_([and_([self._runs, not_(begins)]), and_([begins, f"{self._preset} > T#0S"])])
        self._draft.lines += [
            f"IF {begins} THEN {self._preset} := {row.duration}; END_IF;",
            f"{self._runs} := {lasts};",
        ]

    def stop(self, when: str) -> None:
        """Stop it where a condition holds."""
        if self.over and when:
            self._draft.lines.append(f"IF {when} THEN {self._runs} := FALSE; END_IF;")

    def finish(self) -> None:
        """Let it count from this scan on where it begins in it."""
        if self.over:
            self._call(self._draft.plain(f"{self._role}_goes_on", and_([self._runs, *map(not_, self._begins)])))
            self._call(self._runs)

    def _call(self, runs: str) -> None:
        self._draft.lines.append(f"{self._timer}(IN := {runs}, PT := {self._preset});")


class _InTurn:
    """The control of matiec as statements: what the associations decide one after the other, and what they store.

    `_on`: the bit that tells what the last one wants that decides; empty where none ever does. `_decided`: on which
    conditions one does. `_acted`: the bits that tell which steps were active before this scan.
    """

    def __init__(self, draft: ControlDraft, rows: Rows) -> None:
        self._draft, self._rows = draft, rows
        self._on = ""
        self._decided: list[str] = []
        self._acted: dict[tuple[int, bool], str] = {}
        self._late = _Delay(draft, "late", (row for _, row in rows if row.qualifier in (Q.SD, Q.DS)))
        self._end = _Delay(draft, "end", (row for _, row in rows if row.qualifier is Q.SL))
        self._sets, self._resets = [self._late.over], [self._end.over]

    def output(self) -> str:
        """Append the statements; return the condition on which code is executed."""
        draft, after = self._draft, list[str]()
        for step, row in self._rows:
            acts = draft.plain("acts", acting(step, row))
            active = draft.plain("active", and_([acts, draft.condition(row)]))
            if row.qualifier is Q.S:
                self._sets.append(active)
            elif row.qualifier in RESETS:
                self._resets.append(active)
            else:
                is_new = (step.id, row.negated) not in self._acted
                self._decide(step, row, acts, active)
                after += [f"{self._acted[step.id, row.negated]} := {acts};"] if is_new else []
        stored, reset = draft.plain("set", or_(self._sets)), draft.plain("reset", or_(self._resets))
        self._late.stop(stored)
        self._end.stop(reset)
        for delay in (self._late, self._end):
            delay.finish()
        output = self._written(stored, reset) if draft.operand else self._code(stored, reset)
        draft.lines += after
        return output

    def _decide(self, step: Step, row: ActionAssociation, acts: str, active: str) -> None:
        """Add what an association decides, and the time that it starts."""
        draft = self._draft
        acted = self._acted.get((step.id, row.negated))
        if acted is None:
            # the start is no activation of the initial steps
            acted = draft.bit("acted", initial=step.initial is (step.negated is row.negated))
            self._acted[step.id, row.negated] = acted
        begins, ends = and_([active, not_(acted)]), and_([acted, not_(acts)])
        match row.qualifier:
            case Q.N | Q.NONE:
                self._want(active, or_([acts, acted]), and_([not_(acts), not_(acted)]))
            case Q.L:
                wanted = and_([active, not_(draft.assigned("over", _has_lasted(step, row)))])
                self._want(wanted, or_([acts, acted]), and_([not_(acts), not_(acted)]))
            case Q.D:
                late = draft.assigned("over", _has_lasted(step, row))
                still = [acts, or_([not_(active), late])] if active != acts else [acts, late]
                decides = draft.assigned("decides", or_([ends, and_(still)]))
                self._want(and_([active, late]), decides, not_(decides))
            case Q.P | Q.P1:
                self._want(begins, "TRUE", "")
            case Q.P0:
                self._want(ends, "TRUE", "")
            case Q.SD | Q.DS:
                self._late.start(draft.assigned("begins", begins), row)
                if row.qualifier is Q.DS:  # it needs its step until the delay is over
                    self._late.stop(ends)
            case Q.SL:
                begins = draft.assigned("begins", begins)
                self._sets.append(begins)
                self._end.start(begins, row)
            case _:
                raise ImpossibleError

    def _want(self, wanted: str, decides: str, otherwise: str) -> None:
        """Let an association decide: what it wants counts where it `decides`, and `otherwise` what others wanted."""
        self._decided.append(decides)
        if self._on:
            wanted = or_([wanted, and_([self._on, otherwise]) if otherwise else ""])
        else:
            self._on = self._draft.bit("on")
        self._draft.lines.append(f"{self._on} := {wanted};")

    def _written(self, stored: str, reset: str) -> str:
        """Write a Boolean variable where an association decides on it, or sets or resets it; reset comes last."""
        name = self._draft.operand
        decided = [] if "TRUE" in self._decided else [or_(self._decided)]
        ends = and_([*decided, not_(self._on), *map(not_, filter(None, [stored]))]) if self._on else ""
        for when, value in ((or_([stored, self._on]), "TRUE"), (or_([reset, ends]), "FALSE")):
            if when:
                self._draft.lines.append(f"IF {when} THEN {name} := {value}; END_IF;")
        return ""

    def _code(self, stored: str, reset: str) -> str:
        """Return when code is executed: while an association wants it, and while it is stored."""
        if not stored:
            return self._on or "FALSE"
        bit = self._draft.bit("stored")
        kept = or_([stored, bit])
        self._draft.lines.append(f"{bit} := {and_([kept, not_(reset)]) if reset else kept};")
        return or_([self._on, bit])


def acting(step: Step, row: ActionAssociation) -> str:
    """Return the condition on which the step of an association acts."""
    return not_(flag_of(step)) if step.negated is not row.negated else flag_of(step)


def _has_lasted(step: Step, row: ActionAssociation) -> str:
    if row.duration is None:
        raise ImpossibleError
    return f"{flag_of(step).removesuffix('X')}T >= {row.duration}"


def flag_of(step: Step) -> str:
    """Return the flag of a step, which is TRUE while it is active."""
    name = f'"{step.name}"' if needs_quotes(step.name) else step.name
    return f"#{name}.X"


def or_(parts: Iterable[str]) -> str:
    """Return expressions as one with OR; empty ones do not count."""
    return _joined(" OR ", parts)


def and_(parts: Iterable[str]) -> str:
    """Return expressions as one with AND; empty ones do not count."""
    return _joined(" AND ", parts)


def not_(text: str) -> str:
    """Return an expression negated."""
    return f"NOT {_term(text)}"


def _joined(word: str, parts: Iterable[str]) -> str:
    found = [part for part in parts if part]
    return word.join(map(_term, found)) if len(found) > 1 else "".join(found)


def _term(text: str) -> str:
    """Return an expression as a part of another one."""
    tree = parse_expression(text, Dialect.SCL).tree
    return f"({text})" if isinstance(tree, n.Operation | n.Unary) else text
