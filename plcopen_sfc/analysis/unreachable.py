"""What of the charts of a POU nothing can reach, whatever the inputs are: proven without running anything.

A transition never fires whose condition can never be TRUE. In it variables count with their first value that only
texts write which are never executed: those of actions that no step calls which can be entered. So steps, actions and
transitions are looked at in turn until nothing more is found to be possible.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from plcopen_sfc.analysis.exclusivity import condition_of
from plcopen_sfc.analysis.formulas import Formula, Reading
from plcopen_sfc.analysis.knowledge import ProjectKnowledge
from plcopen_sfc.analysis.marking import MarkingGraph
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.networks import normal_form
from plcopen_sfc.languages.st import parse_condition
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.sfc import SfcFlag, SfcNetwork
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.semantics.net import Net, NetTransition, indexes

__all__ = ["Unreachable"]

_MARKINGS = 20_000
_POINTERS = re.compile(r"\bADR\b|\bREF\b|REF=|REFERENCE|POINTER", re.IGNORECASE)
_FLAGS = frozenset(flag.variable.casefold() for flag in SfcFlag)


class Unreachable:
    """Looks at the charts of a system; `nets` are those that are looked at, by name, `fired` what fired somewhere."""

    def __init__(self, system: ProgramSystem, nets: Mapping[str, Net], fired: Mapping[str, int]) -> None:
        self._system = system
        self._pou = system.subject.pou
        self._nets = nets
        self._fired = fired
        self._knowledge = ProjectKnowledge(system.subject.project)
        self.steps: dict[str, set[int]] = {}
        self.transitions: dict[str, set[int]] = {}
        self._fixed: set[str] = set()
        self._never_said: set[str] = set()
        main = [body for body in self._pou.bodies if isinstance(body, SfcBody)]
        if nets and len(main) == len(self._pou.bodies) == 1:
            self._find()

    def is_never_executed(self, owner: str) -> bool:
        """True if nothing executes a text: ``Main.Fill``, ``Main / step A``."""
        own = self._pou.name
        if owner.removeprefix(f"{own}.").casefold() in self._never_said:
            return True
        place = owner.removeprefix(f"{own} / step ")
        steps = self._nets[own].steps if own in self._nets else ()
        return any(step.path == place and step.index in self.steps.get(own, ()) for step in steps)

    def is_never_true(self, condition: str) -> bool:
        """True if nothing makes the condition of a branch TRUE."""
        parsed = parse_condition(condition, self._system.subject.project.dialect)
        return not parsed.problems and self.is_impossible(normal_form(parsed.tree), self._pou.sfc)

    def is_impossible(self, tree: Expression, chart: SfcNetwork | None) -> bool:
        """True if a condition that stands in a chart is never TRUE."""
        return self._is_impossible(tree, chart, self._fixed)

    def _find(self) -> None:
        pou = self._pou
        bodies = {action.name.casefold(): action.body for action in pou.actions}
        texts = {
            name: _words(body.model_dump_json())
            for name, body in bodies.items()
            if not isinstance(body, SfcBody) and body is not None
        }
        charts = {name.partition(".")[2].casefold() or "": name for name in self._nets}
        own = self._own_variables()
        steps = (step.step for net in self._nets.values() for step in net.steps)
        written = set().union(*texts.values(), *(_words(step.model_dump_json()) for step in steps))
        methods = {word for method in pou.methods for word in _words(method.model_dump_json())}
        possible: dict[str, set[int]] = {name: set() for name in self._nets}
        never: dict[str, set[int]] = {name: set() for name in self._nets}
        executed = {""}
        said = set(methods)
        while True:
            before = (len(executed), len(said), sum(map(len, possible.values())))
            fixed = (own & written) - said
            for key in executed & charts.keys():
                name = charts[key]
                net = self._nets[name]
                never[name] = {t.index for t in net.transitions if self._is_never(name, t, fixed)}
                possible[name] = _entered(net, never[name])
                for index in possible[name]:
                    said |= _words(net.steps[index].step.model_dump_json())
                for macro in net.macros:
                    said |= _words(macro.step.model_dump_json())
            for key in executed & texts.keys():
                said |= texts[key]
            executed |= {name for name in bodies if name in said}
            if (len(executed), len(said), sum(map(len, possible.values()))) == before:
                break
        self._fixed = fixed
        self._never_said = (bodies.keys() - executed) | self._never_called(
            possible, [texts[k] for k in executed & texts.keys()]
        )
        for name, net in self._nets.items():
            dead = {step.index for step in net.steps} - possible[name]
            if name in {charts[key] for key in executed & charts.keys()} and len(dead) < len(net.steps):
                graph = MarkingGraph(net, rivals=self._system.profile.rivals, cap=_MARKINGS)
                dead |= {step.index for step in graph.unreachable_steps or ()}
            self.steps[name] = dead
            self.transitions[name] = never[name] | {t.index for t in net.transitions if set(t.sources) & dead}

    def _never_called(self, possible: Mapping[str, set[int]], texts: Iterable[set[str]]) -> set[str]:
        """The methods that nothing names which can be executed."""
        methods = {method.name.casefold(): _words(method.model_dump_json()) for method in self._pou.methods}
        said = set().union(*texts, *(_words(each.model_dump_json()) for each in self._pou.transitions))
        for name, net in self._nets.items():
            said |= {word for each in net.transitions for word in _words(each.transition.model_dump_json())}
            said |= {word for index in possible[name] for word in _words(net.steps[index].step.model_dump_json())}
        waiting = True
        called: set[str] = set()
        while waiting:
            found = {name for name in methods if name in said} - called
            said |= set().union(*(methods[name] for name in found))
            called |= found
            waiting = bool(found)
        return methods.keys() - called

    def _own_variables(self) -> set[str]:
        """Local variables that only texts of the POU can write."""
        if _POINTERS.search(self._pou.model_dump_json()):
            return set()
        interface = self._pou.interface
        sections = interface.sections if interface is not None else []
        local = {
            v.name.casefold() for s in sections if s.kind is SectionKind.LOCAL for v in s.variables if not v.address
        }
        return local - {name.casefold() for name in self._system.inputs} - _FLAGS

    def _is_never(self, name: str, transition: NetTransition, fixed: set[str]) -> bool:
        """Whether the condition of a transition that did not fire is FALSE while some variables are not written."""
        if self._fired[name] & transition.bit or transition.transition.condition is None:
            return False
        project = self._system.subject.project
        read = condition_of(transition.chart, transition.transition, project.dialect, transitions=self._pou.transitions)
        if read.tree is None or not read.complete or read.before:
            return False
        return self._is_impossible(read.tree, transition.chart, fixed)

    def _is_impossible(self, tree: Expression, chart: SfcNetwork | None, fixed: set[str]) -> bool:
        """Whether a condition is FALSE while some variables are not written."""
        formula = Formula(self._system.subject.project.dialect, self._knowledge.at(self._pou, chart))
        terms = formula.terms([Reading(tree)])
        known = {}
        for text in formula.names():
            root = text.casefold().partition(".")[0]
            if root in fixed:
                known[text] = self._first_value(text)
        return formula.is_impossible(terms, known)

    def _first_value(self, text: str) -> bool | int | float | None:
        self._system.reset()
        try:
            value = self._system.instance[text]
        except (SfcError, AttributeError):
            return None
        return value if isinstance(value, bool | int | float) else None


def _entered(net: Net, never: set[int]) -> set[int]:
    """The steps that can be entered if all other transitions may fire."""
    possible = set(indexes(net.initial))
    growing = True
    while growing:
        before = len(possible)
        for transition in net.transitions:
            if transition.index not in never and possible.issuperset(transition.sources):
                possible.update(transition.targets)
        growing = len(possible) > before
    return possible


def _words(text: str) -> set[str]:
    return set(re.findall(r"\w+", text.casefold()))
