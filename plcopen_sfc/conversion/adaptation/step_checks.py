"""Interlocks, supervisions and events of the steps of S7-GRAPH, as variables that statements compute.

A step looks at its conditions in an action of its own while it is active, before its other actions: `Clamp_L1` is TRUE
in the scan in which the interlock of Clamp opens, `Clamp_VA` from a fault on until it is acknowledged. The names are
those of S7-GRAPH. The rules are those of `plcopen_sfc.semantics.charts.graph.interlock_conditions`, and the tests
compare both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from plcopen_sfc.conversion.adaptation.chart_rewriting import ChartRewriting, as_term, is_supervised
from plcopen_sfc.model.actions import ActionEvent, Qualifier
from plcopen_sfc.model.sfc import ActionAssociation, Step
from plcopen_sfc.model.types import DataType
from plcopen_sfc.model.variables import SectionKind

COMPUTED = frozenset(ActionEvent) - {ActionEvent.S0, ActionEvent.C}
"""Events that become variables. One that ends with its step would need an action after that."""
_INTERLOCK = frozenset({ActionEvent.L1, ActionEvent.L0})
_SUPERVISION = frozenset({ActionEvent.V1, ActionEvent.V0, ActionEvent.A1})
_COMMANDS = {ActionEvent.A1: ("ACK_EF",), ActionEvent.R1: ("REG_EF", "REG_S")}
"""The inputs whose rising edges acknowledge and register."""


ACKNOWLEDGING = frozenset(name for names in _COMMANDS.values() for name in names)
"""Inputs whose rising edges do nothing but acknowledge and register."""


class StepChecks:
    """Conditions that the steps of a chart look at in every scan in which they are active."""

    def __init__(self, rewriting: ChartRewriting) -> None:
        self._rewriting, self._host = rewriting, rewriting.host
        settings = rewriting.source.graph_settings
        self.acknowledged = settings is not None and bool(settings.acknowledge_errors_required)
        """True if a fault holds its step until it is acknowledged."""
        self._inputs = {v.name.upper(): v.name for v in rewriting.chart.pou.variables(SectionKind.INPUT)}
        self._names: dict[tuple[int | str, str], str] = {}
        self._wanted: dict[int, set[ActionEvent]] = {}
        for step in rewriting.source.steps:
            wanted = {row.event for row in step.actions if row.event is not None and not row.exclude}
            self._wanted[step.id] = {event for event in wanted & COMPUTED if self._can_happen(step, event)}
        self.operated: set[str] = set()
        """The inputs whose edges are computed."""
        self.modes: Callable[[], list[str]] = list
        """Returns statements that switch the operating modes by the edges of inputs."""
        self.start: Step | None = None
        """The step that leads to all sequences, where OFF_SQ keeps it."""
        self.firings: dict[str, str] = {}
        """Expressions that tell which transitions of loops fire, by the variables that get them after all actions."""
        self.switched: dict[int, set[str]] = {}
        """The steps that actions switch, by their ids: "on" and "off"."""

    def _can_happen(self, step: Step, event: ActionEvent) -> bool:
        if event in _INTERLOCK and (step.interlock is None or self._rewriting.interlock(step) == "TRUE"):
            return False
        if event in _SUPERVISION and not is_supervised(step):
            return False
        return event not in _COMMANDS or any(name in self._inputs for name in _COMMANDS[event])

    def happens(self, step: Step, event: ActionEvent) -> bool:
        """True unless a step never has this event, because it has no such condition, or its block no such input."""
        return event in self._wanted[step.id]

    def can_tell(self, step: Step, event: ActionEvent) -> bool:
        """True if expressions can compute an event of a step."""
        if event in _INTERLOCK:
            return self._rewriting.interlock(step) is not None
        return event not in _SUPERVISION or self.fault(step) is not None

    def variable(self, owner: Step | str, quantity: str, kind: DataType | None = None) -> str:
        """Return the variable of a step, of an input or of the block for a quantity, such as ``L1``."""
        key: int | str = owner if isinstance(owner, str) else owner.id
        name = owner if isinstance(owner, str) else owner.name
        if (key, quantity) not in self._names:
            self._names[key, quantity] = self._rewriting.new_variable(f"{name}_{quantity}", kind)
        return self._names[key, quantity]

    def names(self, step: int) -> list[str]:
        """Return the variables that are computed for a step, by its id, and those of edges."""
        return [name for (owner, _), name in self._names.items() if owner == step or isinstance(owner, str)]

    def names_of_edges(self) -> list[str]:
        """Return the variables that are computed for the edges of inputs."""
        return [name for (owner, _), name in self._names.items() if isinstance(owner, str)]

    def edge(self, name: str) -> str:
        """Return the variable that is TRUE behind the computed edges in the scan in which an input rises."""
        self.operated.add(name)
        return self.variable(name, "edge")

    def rising(self, name: str) -> str:
        """Return an expression for transitions that is TRUE in the scan in which an input of the block rises."""
        self.operated.add(name)
        edge, before = self.variable(name, "edge"), self.variable(name, "before")
        # elsewhere transitions come before the actions that compute the edge
        return edge if self._host.is_codesys else f"{self._inputs[name]} AND NOT {before}"

    # -- steps that actions switch

    def switched_by(self, row: ActionAssociation, owner: Step) -> list[Step]:
        """Return the steps that a row ON or OFF of the step `owner` switches: by name, by number, or all others."""
        name = (row.target or "").strip('"#').casefold()
        steps = self._rewriting.chart.chart.steps
        if name == "s_all":
            return [step for step in steps if row.qualifier is Qualifier.ON or len(steps) == 1 or step is not owner]
        return [step for step in steps if name in (step.name.casefold(), f"s{step.number}")][:1]

    def switch(self, step: Step, word: str) -> str:
        """Return the variable by which an action switches a step "on" or "off" before the next transitions."""
        self.switched.setdefault(step.id, set()).add(word)
        return self.variable(step.name, word)

    def is_switched(self, step: Step, word: str) -> str | None:
        """Return the variable that is TRUE while transitions see that an action switches a step; None: none does."""
        if word not in self.switched.get(step.id, ()):
            return None
        return self.variable(step.name, f"switched_{word}" if self._host.is_codesys else word)

    def switches(self) -> Iterator[str]:
        """Yield the end of the commands of actions: behind all actions in CODESYS, elsewhere before them."""
        for step in self._rewriting.chart.chart.steps:
            for word in sorted(self.switched.get(step.id, ())):
                command, seen = self.variable(step.name, word), self.is_switched(step, word)
                if seen != command:
                    yield f"{seen} := {command};"
                yield f"{command} := FALSE;"

    # -- conditions

    def fault(self, step: Step) -> str | None:
        """Return the supervision of a step; None where it is no expression."""
        return self._rewriting.text(step.supervision.condition) if step.supervision is not None else "FALSE"

    def held(self, step: Step) -> str | None:
        """Return an expression that is TRUE if the supervision holds a step; None where there is no such expression."""
        fault = self.fault(step)
        if fault is None or not self.acknowledged:
            return fault
        self._wanted[step.id].add(ActionEvent.V1)
        # an acknowledgement counts in the scan of its edge, before the actions of the step see it
        edges = [f" AND NOT {edge}" for edge in self._edges(ActionEvent.A1)]
        return f"{as_term(fault)} OR ({self.variable(step, 'VA')}{''.join(edges)})"

    def disturbed(self, step: Step) -> str | None:
        """Return an expression, for behind the step change, that is TRUE if an active step has an error."""
        fault = self.fault(step) if is_supervised(step) else "FALSE"
        if fault in (None, "FALSE") or not self.acknowledged:
            return fault
        # right whether the step has computed its variable in this scan already or not
        edge = self._rising(ActionEvent.A1)
        known = "" if edge == "FALSE" else f" AND NOT {as_term(edge)}"
        return f"{as_term(fault)} OR ({self.variable(step, 'VA')}{known})"

    def _edges(self, event: ActionEvent) -> Iterator[str]:
        for name in _COMMANDS[event]:
            if name in self._inputs:
                self.operated.add(name)
                yield f"({self._inputs[name]} AND NOT {self.variable(name, 'before')})"

    def waits(self, start: Step) -> str:
        """Return the variable that is TRUE where OFF_SQ rises in the first scan, that of the step `start`."""
        self.start = start
        return self.variable(start.name, "waits")

    # -- statements

    def edges(self) -> list[str]:
        """Return the edges of inputs, for an action that is executed before those of the steps."""
        modes, found = self.modes(), list[str]()
        for name in sorted(self.operated):
            own, before = self._inputs[name], self.variable(name, "before")
            found += [f"{self.variable(name, 'edge')} := {own} AND NOT {before};", f"{before} := {own};"]
        found += modes
        if self.start is not None:
            rises = f"{self._host.active(self.start)} AND {self.variable('OFF_SQ', 'edge')}"
            found.append(f"{self.waits(self.start)} := {self.waits(self.start)} OR ({rises});")
        return found

    def _rising(self, event: ActionEvent) -> str:
        inputs = [name for name in _COMMANDS[event] if name in self._inputs]
        self.operated.update(inputs)
        names = [self.variable(name, "edge") for name in inputs]
        return " OR ".join(names) if names else "FALSE"

    def statements(self, step: Step) -> list[str]:
        """Return the statements of an active step; empty where one of its conditions is no expression."""
        wanted = self._wanted[step.id]
        found: list[str] = []
        if wanted & _INTERLOCK:
            interlock = self._rewriting.interlock(step)
            if interlock is None:
                return []
            found += self._interlock(step, as_term(interlock), wanted)
        if wanted & _SUPERVISION:
            fault = self.fault(step)
            if fault is None:
                return []
            found += self._supervision(step, as_term(fault), wanted)
        if ActionEvent.R1 in wanted:
            found.append(f"{self.variable(step, 'R1')} := {self._rising(ActionEvent.R1)};")
        if (step.id, "S1") in self._names:
            found.append(f"{self.variable(step, 'S1')} := NOT {self.variable(step, 'active')};")
        if (step.id, "active") in self._names:
            found.append(f"{self.variable(step, 'active')} := TRUE;")
        return found

    def _interlock(self, step: Step, satisfied: str, wanted: set[ActionEvent]) -> Iterator[str]:
        error = self.variable(step, "LA")
        if ActionEvent.L1 in wanted:
            yield f"{self.variable(step, 'L1')} := NOT {satisfied} AND NOT {error};"
        if ActionEvent.L0 in wanted:
            yield f"{self.variable(step, 'L0')} := {satisfied} AND {error};"
        yield f"{error} := NOT {satisfied};"

    def _supervision(self, step: Step, fault: str, wanted: set[ActionEvent]) -> Iterator[str]:
        before = self.variable(step, "VS")
        remembers = ActionEvent.A1 in wanted or (step.id, "VA") in self._names
        if ActionEvent.V1 in wanted or remembers:
            yield f"{self.variable(step, 'V1')} := {fault} AND NOT {before};"
        if ActionEvent.V0 in wanted:
            yield f"{self.variable(step, 'V0')} := NOT {fault} AND {before};"
        yield f"{before} := {fault};"
        if not remembers:
            return
        # VA of S7-GRAPH without what is acknowledged: that part of it is TRUE exactly while the fault is there
        error = self.variable(step, "VA")
        yield f"{error} := {error} OR {self.variable(step, 'V1')};"
        acknowledges = self._rising(ActionEvent.A1)
        if acknowledges != "FALSE":
            # a step that was entered in this scan has not been there to be acknowledged
            known = f"{self.variable(step, 'active')} AND {as_term(acknowledges)}"
            if ActionEvent.A1 in wanted:
                yield f"{self.variable(step, 'A1')} := {error} AND {known};"
            yield f"{error} := {error} AND NOT ({known});"
        if not self.acknowledged:
            yield f"{error} := {error} AND {fault};"

    def forgotten(self, step: Step) -> list[str]:
        """Return the end of what is computed for a step, after it was left."""
        return [f"{name} := FALSE;" for (owner, _), name in self._names.items() if owner == step.id]
