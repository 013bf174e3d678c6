"""Actions of a chart that matiec executes otherwise than the tool of the project, as statements of every scan.

Of several associations that drive one thing matiec lets the last have its way, the start is no activation of the
initial steps, SL starts again without R, and only a variable with a simple name can be driven. So the ACTION_CONTROL of
IEC 61131-3 (6.7.4.6) is written out where one of these matters, and then all bodies of the chart run in the order in
which the tool of the project executes them.

The converters before matiec write actions before the steps that they name, but matiec knows ``Step.X`` and ``Step.T``
behind the step only. `StepFlagsAndTimes` puts variables in the place of such flags and times.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.formats.matiec.matiec_pou import FittedPou
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, render, transform
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.words import is_plain
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.network import InputVariable
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step, Transition
from plcopen_sfc.model.types import SimpleValue
from plcopen_sfc.report import Outcome

WHENEVER = frozenset({Qualifier.N, Qualifier.NONE})
_RESETS = frozenset({Qualifier.R, Qualifier.R0})
_RISING = frozenset({Qualifier.P, Qualifier.P1})
_PULSES = frozenset({Qualifier.P1, Qualifier.P0})
_EDGES = _RISING | _PULSES
_DELAYED = frozenset({Qualifier.SD, Qualifier.DS, Qualifier.SL})
_ALONE = frozenset({*WHENEVER, *_RISING, Qualifier.P0, Qualifier.L, Qualifier.D})
"""Those of which matiec takes the last of several that drive one thing, instead of one that is active."""
_LONG = "T#1000d"
"""The preset of timers of which only the elapsed time is read."""


_User = tuple[Step, ActionAssociation]


@dataclass(slots=True)
class _Item:
    """A target that associations have in common: `text` are the statements of an action, None for a variable.

    `written`: bodies name it, so that it matters when it is written among them. `on` is TRUE while it is executed,
    `pulse` in scans after which nothing follows (P1 and P0). `ends`: it may be on in one scan, and off in the next.
    """

    target: str
    users: list[_User] = field(default_factory=list)
    text: str | None = None
    written: bool = False
    on: str = ""
    pulse: str = ""
    ends: bool = False

    @property
    def root(self) -> str:
        """The name of the variable or action, in lower case."""
        return self.target.partition(".")[0].casefold()

    @property
    def now(self) -> str:
        """An expression that is TRUE in the scans in which it is executed."""
        return " OR ".join(part for part in (self.on, self.pulse) if part) or "FALSE"


@dataclass(slots=True)
class ActionFitter:
    """Puts the actions of a chart into `logic` where matiec would execute them otherwise.

    `final_scan` and `relies` are those of `ChartFitter`. `places` are the places of the steps in the source, `calls`
    has the kinds of the associations that replace step actions, `in_place` the names of actions that have none in the
    source.
    """

    unit: FittedPou
    chart: SfcNetwork
    logic: list[str]
    final_scan: bool | None
    relies: bool
    places: Mapping[int, int]
    calls: Mapping[int, str]
    in_place: set[str]

    def fit(self) -> None:
        """Change the associations of the chart."""
        items = list(self._items())
        bodies = [item for item in items if item.text is not None]
        calls = [(step, line) for step in self._steps() for line in step.actions if line.id in self.calls]
        texts = {(line.target or "").casefold(): self._text(line.target or "") or "" for _, line in calls}
        named = self._named([*(item.text or "" for item in bodies), *texts.values()])
        for item in items:
            item.written = item.root in named
        controlled = [item for item in items if item.written or self._is_controlled(item)]
        ordered = any(item.text is not None or item.written for item in controlled)
        ordered |= bool(calls) and (bool(self.final_scan) or self._is_entangled(calls, items))
        if self.unit.own:
            ordered = False
        elif self.final_scan is not None:
            kept = self._kept_bodies()  # what is in other languages stays as it is
            known = self.final_scan or self.relies
            self._note_final_scans(kept if known else [*kept, *(item.target for item in bodies)])
        if ordered:
            self._calls(calls)
            controlled = [item for item in items if item in bodies or item in controlled]
        for item in controlled:
            self._control(item)
        self._execute(controlled)

    def _steps(self) -> list[Step]:
        """Return the steps in the order of the source."""
        return sorted(self.chart.steps, key=lambda step: self.places.get(step.id, len(self.places)))

    def _items(self) -> Iterator[_Item]:
        """Yield the targets of associations, but for step actions, in the order of first use."""
        found: dict[str, _Item] = {}
        for step in self._steps():
            for line in step.actions:
                if line.id not in self.calls:
                    target = line.target or ""
                    found.setdefault(target.casefold(), _Item(target)).users.append((step, line))
        for item in found.values():
            if self.unit.pou.find_action(item.target) is not None:
                item.text = self._text(item.target)
                if item.text is None:
                    continue
            yield item

    def _kept_bodies(self) -> list[str]:
        """Return the actions that associations execute and that are in another language than ST."""
        targets = dict.fromkeys(line.target or "" for step in self._steps() for line in step.actions)
        return [each for each in targets if self.unit.pou.find_action(each) is not None and self._text(each) is None]

    def _text(self, target: str) -> str | None:
        action = self.unit.pou.find_action(target)
        if action is None or action.body is None:
            return None if action is None else ""
        if isinstance(action.body, StBody):
            return action.body.text
        return None  # drawn for the converters before matiec, which translate it

    def _named(self, texts: list[str]) -> set[str]:
        """Return the names in the texts of actions that make a difference to when a variable is driven.

        CODESYS documents when it writes a variable among the actions; IEC 61131-3 has only its value after the scan.
        """
        if self.unit.own:
            return set()
        found: set[str] = set()
        for text in texts:
            tokens = tokenize(text, self.unit.dialect).tokens
            for token, following in zip(tokens, [*tokens[1:], None], strict=False):
                is_written = following is not None and following.value in (":=", ".", "[")
                if token.type == "NAME" and (self.final_scan or is_written):
                    found.add(token.value.casefold())
        return found

    def _is_controlled(self, item: _Item) -> bool:
        """True if matiec would not execute it as the associations do."""
        if item.text is None and not is_plain(item.target):
            return True
        if any(line.condition is not None or line.negated for _, line in item.users):
            return True
        if self.unit.own:
            return False
        qualifiers = [line.qualifier for _, line in item.users]
        shared = len(qualifiers) > 1 and not _ALONE.isdisjoint(qualifiers)
        started = any(step.initial and line.qualifier in _EDGES for step, line in item.users)
        if item.text is not None and (self.final_scan or self.relies):
            return True
        return shared or started or not _DELAYED.isdisjoint(qualifiers)

    def _is_entangled(self, calls: list[_User], items: list[_Item]) -> bool:
        """True if a step action is executed at the start, or by several steps or associations."""
        names = [(line.target or "").casefold() for _, line in calls] + [item.target.casefold() for item in items]
        return len(set(names)) < len(names) or any(
            step.initial and self.calls[line.id] != "main" for step, line in calls
        )

    def _note_final_scans(self, targets: list[str]) -> None:
        pulsed = {line.target for step in self._steps() for line in step.actions if line.qualifier in _PULSES}
        others = {line.target for step in self._steps() for line in step.actions if line.qualifier not in _PULSES}
        left_open = "" if self.final_scan else ", which IEC 61131-3 leaves to the tool"
        for target in targets:
            if target in pulsed - others:
                continue  # P1 and P0 have no end
            why = f"matiec does not execute it once more after its end{left_open}"
            self.unit.note(Outcome.APPROXIMATED, "action", f"{self.unit.path} / action {target}", why)

    # -- step actions --------------------------------------------------------------------------------------------------

    def _calls(self, calls: list[_User]) -> None:
        """Execute exit, entry and main actions, each kind in the order of the steps."""
        before: dict[int, str] = {}
        for kind in ("exit", "entry", "main"):
            for step, line in calls:
                text = self._text(line.target or "")
                if self.calls[line.id] != kind or text is None:
                    continue
                active = f"{step.name}.X"
                if kind != "main":
                    was = before[step.id] = before.get(step.id) or self.unit.declare(f"{step.name}_was")
                    active = f"{active} AND NOT {was}" if kind == "entry" else f"{was} AND NOT {active}"
                step.actions.remove(line)
                self.logic.append(f"IF {active} THEN\n{text}\nEND_IF;")
        self.logic += [f"{before[step.id]} := {step.name}.X;" for step in self._steps() if step.id in before]

    # -- action control ------------------------------------------------------------------------------------------------

    def _control(self, item: _Item) -> None:
        """Decide in every scan if an item is executed, as ACTION_CONTROL does; its associations are taken off."""
        by_qualifier: dict[Qualifier, list[_User]] = {}
        for step, line in item.users:
            step.actions.remove(line)
            qualifier = Qualifier.N if line.qualifier in WHENEVER else line.qualifier
            by_qualifier.setdefault(Qualifier.R if qualifier in _RESETS else qualifier, []).append((step, line))
        reset = _any(by_qualifier.pop(Qualifier.R, []))
        item.ends = bool(reset) or not by_qualifier.keys() <= {*_PULSES, Qualifier.S}
        on: list[str] = []
        pulses: list[str] = []
        for qualifier, users in by_qualifier.items():
            term = self._term(item.target, qualifier, users, reset)
            (pulses if qualifier in _PULSES else on).append(term)
        item.on, item.pulse = _without(on, reset), _without(pulses, reset)

    def _term(self, target: str, qualifier: Qualifier, users: list[_User], reset: str) -> str:
        """Return the term that one qualifier adds to a control."""
        active, declare, logic = _any(users), self.unit.declare, self.logic
        if qualifier is Qualifier.N:
            return active
        if qualifier in _RISING or qualifier is Qualifier.P0:
            kind = "falling" if qualifier is Qualifier.P0 else "rising"
            edge, before = declare(f"{target}_{kind}"), declare(f"{target}_before")
            rule = f"{before} AND NOT {_term(active)}" if kind == "falling" else f"{_term(active)} AND NOT {before}"
            logic += [f"{edge} := {rule};", f"{before} := {active};"]
            return edge
        if qualifier is Qualifier.S:
            return self._stored(target, active, reset)
        if qualifier in (Qualifier.SD, Qualifier.SL):
            runs = declare(f"{target}_{qualifier.value}")
            logic.append(f"{runs} := {_without([runs, active], reset)};")
            active = runs
        over = self._over(target, users, active)
        if qualifier is Qualifier.DS:
            return self._stored(target, over, reset)
        return over if qualifier in (Qualifier.D, Qualifier.SD) else f"{_term(active)} AND NOT {over}"

    def _stored(self, target: str, sets: str, reset: str) -> str:
        stored = self.unit.declare(f"{target}_stored")
        first = f"IF {reset} THEN\n    {stored} := FALSE;\nELSIF" if reset else "IF"
        self.logic.append(f"{first} {sets} THEN\n    {stored} := TRUE;\nEND_IF;")
        return stored

    def _over(self, target: str, users: list[_User], active: str) -> str:
        """Return a variable that is TRUE from when `active` has been TRUE for the time until it ends."""
        timer, over = self.unit.declare(f"{target}_timer", "TON"), self.unit.declare(f"{target}_over")
        times = {line.duration or "" for _, line in users}
        time = times.pop()
        if times or "#" not in time:
            time = self.unit.declare(f"{target}_time", "TIME")
            parts = [f"IF {_flag(*user)} THEN\n    {time} := {user[1].duration};" for user in users]
            self.logic.append("\nELS".join(parts) + "\nEND_IF;")
        self.logic.append(f"{timer}(IN := {active}, PT := {_LONG});")
        self.logic.append(f"{over} := {_term(active)} AND ({over} OR {timer}.ET >= {time});")
        return over

    # -- executing -----------------------------------------------------------------------------------------------------

    def _execute(self, items: list[_Item]) -> None:
        """Execute items as the tool does: CODESYS first what has ended, others write FALSE before bodies."""
        for item in items:
            conditions = any(line.condition is not None for _, line in item.users)
            if conditions or (self.final_scan and " " in item.now):  # decided once, before any body is executed
                for name in [name for name in ("on", "pulse") if getattr(item, name)]:
                    variable = self.unit.declare(f"{item.target}_{name}")
                    self.logic.append(f"{variable} := {getattr(item, name)};")
                    setattr(item, name, variable)
        if self.final_scan:
            self._execute_in_turns(items)
            return
        for item in items:
            if item.text is None and self.final_scan is None:
                was = self.unit.declare(f"{item.target}_was")
                self.logic += [_switched(item.target, item.now, f"{was} AND NOT {_term(item.now)}")]
                self.logic.append(f"{was} := {item.now};")
            elif item.text is None and item.written:
                self.logic.append(f"IF NOT {_term(item.now)} THEN\n    {item.target} := FALSE;\nEND_IF;")
            elif item.text is None:
                self.logic.append(f"{item.target} := {item.now};")
        after: list[str] = []
        for item in items:
            if item.text is not None and self.relies and item.ends:
                was = self.unit.declare(f"{item.target}_was")
                self.logic.append(f"IF {item.now} OR {was} THEN\n{item.text}\nEND_IF;")
                after.append(f"{was} := {item.on};")
            elif item.text is not None:
                self.logic.append(f"IF {item.now} THEN\n{item.text}\nEND_IF;")
            elif item.written:
                self.logic.append(f"IF {item.now} THEN\n    {item.target} := TRUE;\nEND_IF;")
        self.logic += after

    def _execute_in_turns(self, items: list[_Item]) -> None:
        """Execute items in the order of their names: in a first turn those that have ended, then the active ones."""
        items = sorted(items, key=lambda i: "" if i.target.casefold() in self.in_place else i.target.casefold())
        turn = self.unit.declare("Turn", "INT") if len(items) > 1 else ""
        lines: list[str] = []
        after: list[str] = []
        for item in items:
            was = self.unit.declare(f"{item.target}_was")
            lines.append(_turns(item, was, turn))
            after.append(f"{was} := {item.now if item.text is None else item.on or 'FALSE'};")
        if turn:
            lines = [f"FOR {turn} := 1 TO 2 DO\n" + "\n".join(lines) + "\nEND_FOR;"]
        self.logic += [*lines, *after]


def _turns(item: _Item, was: str, turn: str) -> str:
    """Return the statements of an item in the turns; without turns it is the only one."""
    ended = f"{was} AND NOT {_term(item.now)}"
    if item.text is not None:
        active = f"{turn} = 1 AND {ended} OR {turn} = 2 AND {_term(item.now)}" if turn else f"{item.now} OR {was}"
        return f"IF {active} THEN\n{item.text}\nEND_IF;"
    if not turn:
        return _switched(item.target, item.now, ended)
    return _switched(item.target, f"{turn} = 2 AND {_term(item.now)}", f"{turn} = 1 AND {ended}")


def _switched(target: str, on: str, off: str) -> str:
    return f"IF {on} THEN\n    {target} := TRUE;\nELSIF {off} THEN\n    {target} := FALSE;\nEND_IF;"


def _flag(step: Step, line: ActionAssociation) -> str:
    """Return an expression that is TRUE while an association acts."""
    flag = f"NOT {step.name}.X" if line.negated else f"{step.name}.X"
    condition = line.condition
    return f"{flag} AND ({condition.text})" if isinstance(condition, Expression) else flag


def _any(users: list[_User]) -> str:
    return " OR ".join(dict.fromkeys(_flag(*user) for user in users))


def _without(terms: list[str], reset: str) -> str:
    """Return the OR of the terms, and not the reset."""
    found = " OR ".join(terms)
    return f"{_term(found)} AND NOT {_term(reset)}" if found and reset else found


def _term(text: str) -> str:
    """Return an expression as an operand."""
    return f"({text})" if " " in text else text


class StepFlagsAndTimes:
    """Puts variables in the place of the flags and times of steps of a chart; what is added gets `ids`.

    `logic` are the statements of every scan, which are executed before all actions.
    """

    def __init__(self, unit: FittedPou, chart: SfcNetwork, ids: Iterator[int], logic: list[str]) -> None:
        self._unit = unit
        self._chart = chart
        self._ids = ids
        self._logic = logic
        self._steps = {step.name.casefold(): step for step in chart.steps}
        self._flags: dict[str, str] = {}
        self._times: dict[str, str] = {}
        self._is_timed = False

    def put(self) -> None:
        """Change actions, drawn logic and conditions; a condition keeps flag and time of the one step that it leaves.

        The end of simultaneous sequences is written behind the first of them, before the last steps of the others.
        """
        names = {step.id: step.name.casefold() for step in self._chart.steps}
        for action in self._unit.pou.actions:
            if isinstance(action.body, StBody):
                action.body.text = self._put(action.body.text, statements=True)
        for node in self._chart.logic:
            if isinstance(node, InputVariable):
                node.expression = self._put(node.expression)
        if self._logic:
            self._logic[:] = [self._put("\n".join(self._logic), statements=True)]
        # of transitions that have numbers, one resets the flag that the next one reads in the tool of the source
        for transition in self._chart.transitions if not self._unit.own else ():
            if isinstance(transition.condition, Expression):
                left = [names[source] for source in transition.sources if source in names]
                left = left if len(left) == 1 else []
                self._is_timed = False
                transition.condition.text = self._put(transition.condition.text, keep=left)
                if self._is_timed:
                    self._note(transition, "it sees the time of another step one scan later")
        self._measure()

    def _put(self, text: str, *, statements: bool = False, keep: Iterable[str] = ()) -> str:
        parsed = (parse_statements if statements else parse_expression)(text, self._unit.dialect)
        if parsed.problems:
            return text
        kept = frozenset(keep)

        def change(node: n.Node) -> n.Node:
            if not isinstance(node, n.Member) or not isinstance(node.base, n.Name):
                return node
            name, member = node.base.identifier.casefold(), node.name.identifier.upper()
            if name in kept or name not in self._steps:
                return node
            if member == "T" and not self._unit.own:
                return n.Name(self._time(self._steps[name]))
            return n.Name(self._flag(self._steps[name])) if member == "X" else node

        tree = transform(parsed.tree, change)
        return text if tree is parsed.tree else render(parsed, tree)

    def _flag(self, step: Step) -> str:
        name = self._flags.get(step.name.casefold())
        if name is None:
            # transitions of the first scan ask for the flag before the step has written it
            initial = SimpleValue(text="TRUE") if step.initial else None
            name = self._flags[step.name.casefold()] = self._unit.declare(f"{step.name}_flag", initial=initial)
            step.actions.insert(0, ActionAssociation(id=next(self._ids), qualifier=Qualifier.N, target=name))
        return name

    def _time(self, step: Step) -> str:
        self._is_timed = True
        name = self._times.get(step.name.casefold())
        if name is None:
            name = self._times[step.name.casefold()] = self._unit.declare(f"{step.name}_time", "TIME")
        return name

    def _measure(self) -> None:
        """Measure the times before all else: that of a step goes on in the scan that leaves it, and then stays."""
        if not self._times:
            return
        lines: list[str] = []
        for key, time in self._times.items():
            step = self._steps[key]
            flag, was = self._flag(step), self._unit.declare(f"{step.name}_timed")
            timer = self._unit.declare(f"{step.name}_timer", "TON")  # one for all would end while the machine runs
            lines += [
                f"IF {flag} AND NOT {was} THEN\n    {timer}(IN := FALSE, PT := {_LONG});\nEND_IF;",
                f"{timer}(IN := {flag} OR {was}, PT := {_LONG});",
                f"IF {flag} OR {was} THEN\n    {time} := {timer}.ET;\nEND_IF;",
                f"{was} := {flag};",
            ]
            for transition in self._chart.transitions:
                if step.id in transition.sources and step.id in transition.targets:
                    self._note(transition, f"the time of {step.name} goes on where it is entered as it is left")
        self._logic.insert(0, "\n".join(lines))

    def _note(self, transition: Transition, why: str) -> None:
        path = f"{self._unit.path} / transition {self._chart.label(transition)}"
        self._unit.note(Outcome.APPROXIMATED, "transition", path, why)
