"""Parts of the charts of a POU that nothing can reach, whatever the inputs are: proven without running anything.

A transition never fires whose condition can never be TRUE. In it variables count with their first value that only
texts write which are never executed: those of actions that no step calls which can be entered. So steps, actions and
transitions are looked at in turn until nothing more is found to be possible.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from functools import cache, cached_property, reduce
from operator import and_, or_

from plcopen_sfc.analysis.assigned_values import assigning_texts
from plcopen_sfc.analysis.exclusivity import condition_of
from plcopen_sfc.analysis.formulas import Formula, JudgedCondition
from plcopen_sfc.analysis.knowledge import ProjectKnowledge, constant_of
from plcopen_sfc.analysis.marking import MarkingGraph
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.binding import bind, names_in, texts_in, with_called
from plcopen_sfc.languages.binding.name_scopes import given, parameters_of
from plcopen_sfc.languages.binding.symbols import inside
from plcopen_sfc.languages.networks.wires import inverted
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, print_node, walk
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork, Step
from plcopen_sfc.model.types import PointerType
from plcopen_sfc.model.variables import SectionKind, sections_of
from plcopen_sfc.semantics.net import Competing, Net, NetStep, NetTransition, indexes
from plcopen_sfc.semantics.profile import ActionControl, Evolution
from plcopen_sfc.semantics.programs.marks import may_act

_MARKINGS = 20_000
_MOST_SETTINGS = 64
"""Combinations of step flags that are looked at one by one."""

_WHILE_ACTIVE = frozenset({Qualifier.N, Qualifier.P, Qualifier.P0, Qualifier.P1, Qualifier.L, Qualifier.D})
_POINTING = frozenset({"adr", "ref"})
_FLAGS = frozenset(flag.variable.casefold() for flag in SfcFlag)


@dataclass(frozen=True)
class _Situations:
    """Situations of a chart: the steps that are active and those that are not (bits); of others nothing is known."""

    net: Net
    known: tuple[tuple[int, int], ...]

    def flags(self, names: Iterable[str]) -> list[dict[str, bool]]:
        """Return the values that the flags of steps among some names have together."""
        bits = {f"{step.path}.x".casefold(): step.bit for step in self.net.steps}
        asked = {name: bits[name.casefold()] for name in names if name.casefold() in bits}
        every = reduce(or_, asked.values(), 0)
        found = {(active & every, idle & every) for active, idle in self.known}
        if len(found) > _MOST_SETTINGS:
            found = {(reduce(and_, (each[0] for each in found)), reduce(and_, (each[1] for each in found)))}
        return [
            {name: bool(active & bit) for name, bit in asked.items() if (active | idle) & bit} for active, idle in found
        ]


class Unreachable:
    """Looks at the charts of a system; `nets` are those that are looked at, by name, `fired` what fired somewhere.

    Code that does the same as a `chart` executes no text of it that the chart never executes; `never`: conditions that
    are then never TRUE in the code. `operated`: inputs may leave steps, and let transitions fire or not, whatever
    their conditions are; `entered`: they may enter any step. `is_late` tells that there is no time to prove more.
    """

    def __init__(
        self,
        system: ProgramSystem,
        nets: Mapping[str, Net],
        fired: Mapping[str, int],
        chart: Unreachable | None = None,
        never: Sequence[Expression] = (),
        *,
        operated: bool = False,
        entered: bool = False,
        is_late: Callable[[], bool] = lambda: False,
    ) -> None:
        self._system = system
        self._operated, self._entered = operated, entered
        self._is_late = is_late
        self._pou = system.subject.pou
        self._nets = nets
        self._fired = fired
        self._chart = chart
        self._known = tuple(map(inverted, never))
        self._knowledge = ProjectKnowledge(system.subject.project)
        self.steps: dict[str, set[int]] = {}
        self.transitions: dict[str, set[int]] = {}
        self.fixed: set[str] = set()
        """Names (lower case) of variables that keep their first value: nothing that is executed writes them."""
        self._graph = cache(self._marking_graph)
        self._executed_in = cache(self._situations_of)
        self._given = cache(self._constant_inputs)
        self._never_said: set[str] = set()
        main = [body for body in self._pou.bodies if isinstance(body, SfcBody)]
        if nets and len(main) == len(self._pou.bodies) == 1:
            self._find()
        elif chart is not None:
            self.fixed = {name for name in chart.fixed if not self._changed_by_code.intersection(("", name))}

    @cached_property
    def _changed_by_code(self) -> set[str]:
        """The names that the bodies of code write or call, "" for anything; its actions are those of the chart."""
        effects = [bind(body, self._system.subject.project.dialect).effects for body in self._pou.bodies]
        return {path[0] if path else "" for found in effects for path in (*found.writes, *found.calls)}

    def is_never_executed(self, owner: str) -> bool:
        """True if nothing executes a text: ``Main.Fill``, ``Main / step A``."""
        own = self._pou.name
        if owner.removeprefix(f"{own}.").casefold() in self._never_said:
            return True
        if self._chart is not None and self._chart.is_never_executed(owner):
            return True
        return owner.removeprefix(f"{own} / step ") in self.dead_paths()

    def dead_paths(self) -> set[str]:
        """Return the paths of the steps of the POU's own chart that are never entered."""
        own = self._pou.name
        return {self._nets[own].steps[index].path for index in self.steps.get(own, ())}

    def is_impossible(
        self, trees: Sequence[Expression], chart: SfcNetwork | None, called: str | None = None, owner: str = ""
    ) -> bool:
        """True if conditions in a chart, or in a called POU of a name, are never TRUE together.

        `owner` is the text that they are in, such as ``Main.Fill``.
        """
        if self._is_late():
            return False
        if called is None:
            situations = self._executed_in(owner.removeprefix(f"{self._pou.name}.").casefold())  # where they are known
            return self._is_impossible(trees, chart, self.fixed, situations)
        pou = self._system.called_pous()[called]
        formula = Formula(self._system.subject.project.dialect, self._knowledge.at(pou))
        terms = formula.terms([JudgedCondition(tree) for tree in trees])
        given = self._given(called) if pou.kind is PouKind.FUNCTION else {}
        return formula.is_impossible(terms, {text: given.get(text.lstrip("#").casefold()) for text in formula.names()})

    def _constant_inputs(self, called: str) -> dict[str, bool | int | float | str | date]:
        """Return the inputs (lower case) to which all calls of a function give the same literal, with their values."""
        project, function = self._system.subject.project, self._system.called_pous()[called]
        name = function.name.casefold()
        texts = [text for pou in project.pous if pou is not function for text in texts_in(pou, project.dialect)]
        nodes = [node for text in texts for tree in text.trees for node in walk(tree)]
        order = [variable.name.casefold() for variable in parameters_of(function.interface)]
        found_calls = (node for node in nodes if isinstance(node, n.Call))
        calls = [given(call, order) for call in found_calls if print_node(call.callee).casefold() == name]
        if len(calls) != sum(use.name.casefold() == name for text in texts for use in text.uses):
            return {}  # a box calls it, too, or a text that cannot be read
        changed = [path for body in function.bodies for path in bind(body, project.dialect).effects.writes]
        found = {}
        for variable in function.variables(SectionKind.INPUT):
            key = variable.name.casefold()
            constants = [constant_of(passed[key], project.dialect, None) if key in passed else None for passed in calls]
            values = {constant.value if constant is not None else None for constant in constants}
            if len(values) == 1 and not any(not path or path[0].casefold() == key for path in changed):
                found[key] = values.pop()
        return {key: value for key, value in found.items() if value is not None}

    def is_never_tested(self, name: str, transition: NetTransition, tree: Expression) -> bool:
        """True if `tree` is FALSE wherever a chart of this name tests the condition of a transition."""
        # of a sequencer that inputs hold, competing transitions may be TRUE and not fire
        before = self._false_before(name, transition) if not self._operated else []
        return self._is_impossible([tree, *before], transition.chart, self.fixed, self._tested_in(name, transition))

    def frozen_by(self, trees: Sequence[Expression], chart: SfcNetwork | None) -> list[str]:
        """The variables whose values keep conditions from being TRUE together, as nothing writes or gives them."""
        frozen = {name.casefold(): name for name in self._system.frozen()}
        nodes = (node for tree in trees for node in walk(tree) if isinstance(node, n.Name | n.Member))
        names = {print_node(node).casefold() for node in nodes} & frozen.keys()
        if not names or not self._is_impossible(trees, chart, self.fixed | names):
            return []
        return sorted((frozen[name] for name in names), key=str.casefold)

    def _tested_in(self, name: str, transition: NetTransition) -> _Situations | None:
        """Return the situations in which a chart tests the condition of a transition; None: not known."""
        net = self._nets.get(name)
        is_known = net is not None and not self._operated and self._system.profile.evolution is Evolution.SINGLE
        if net is None or not is_known or not self._graph(name).complete:
            return None
        pre = transition.pre
        return _Situations(net, tuple((marking, ~marking) for marking in self._graph(name) if not pre & ~marking))

    def _marking_graph(self, name: str) -> MarkingGraph:
        return MarkingGraph(self._nets[name], competing=self._system.profile.competing, cap=_MARKINGS)

    def is_left_before(self, name: str, step: NetStep, time: str) -> bool:
        """True if a step of a chart is always left before a time has passed: a condition behind it is TRUE then."""
        dialect = self._system.subject.project.dialect
        limit = parse_condition(f"{step.path}.T >= {time}", dialect)
        if name not in self._nets or self._operated or step.step.min_time or limit.problems:
            return False
        for transition in self._nets[name].transitions:
            condition = self._condition(transition) if transition.sources == (step.index,) else None
            if condition is not None and self.is_impossible([inverted(condition), limit.tree], transition.chart):
                return True
        return False

    def is_no_time(self, time: str, chart: SfcNetwork | None) -> bool:
        """True if a time is never more than none."""
        some = parse_condition(f"{time} > T#0s", self._system.subject.project.dialect)
        return not some.problems and self.is_impossible([some.tree], chart)

    def _condition(self, transition: NetTransition) -> Expression | None:
        """Return the condition of a transition; None: it is not known, or evaluating it does something."""
        if transition.transition.condition is None:
            return None
        dialect = self._system.subject.project.dialect
        read = condition_of(transition.chart, transition.transition, dialect, transitions=self._pou.transitions)
        return None if not read.complete or read.before else read.tree

    def _false_before(self, name: str, transition: NetTransition) -> list[Expression]:
        """Return the expressions that are TRUE where a condition is tested: no transition with priority fires."""
        net, profile = self._nets.get(name), self._system.profile
        if net is None or profile.competing is not Competing.PRIORITY:
            return []
        first = [t for t in net.transitions[: transition.index] if t.pre and not t.pre & ~transition.pre]
        conditions = [tree for tree in map(self._condition, first) if tree is not None]
        return [inverted(tree) for tree in conditions if not any(map(may_act, walk(tree)))]

    def _find(self) -> None:
        pou = self._pou
        bodies = {action.name.casefold(): action.body for action in pou.actions}
        texts = {
            name: self._changing_names(body)
            for name, body in bodies.items()
            if not isinstance(body, SfcBody) and body is not None
        }
        charts = {name.partition(".")[2].casefold() or "": name for name in self._nets}
        own = self._own_variables()
        steps = (step.step for net in self._nets.values() for step in net.steps)
        written = self._names(*bodies.values(), *steps)
        methods = {method.name.casefold(): self._changing_names(method) for method in pou.methods}
        calling = self._names(*pou.transitions, *(t.transition for net in self._nets.values() for t in net.transitions))
        others = [each for each in self._system.subject.project.pous if each.name != pou.name]
        calling |= self._names(*others) if methods else set()
        possible: dict[str, set[int]] = {name: set() for name in self._nets}
        never: dict[str, set[int]] = {}
        executed = {""}
        said = self._always_said()
        never_set = self._never_set(own)
        # Each round only adds: an action that is executed names further ones and writes further variables, so fewer are
        # fixed and fewer conditions are never TRUE. It starts with nothing executed: two actions that only call each
        # other must not keep each other alive.
        while True:
            before = (len(executed), len(said), sum(map(len, possible.values())))
            fixed = ((own & written) - said) | never_set
            for key in executed & charts.keys():
                name = charts[key]
                net = self._nets[name]
                asked = net.transitions if name not in never else [net.transitions[i] for i in sorted(never[name])]
                never[name] = {t.index for t in asked if self._is_never(name, t, fixed)}
                possible[name] = {s.index for s in net.steps} if self._entered else _entered(net, never[name])
                for index in possible[name]:
                    said |= self._changing_names(self._acting(net.steps[index].step))
                for macro in net.macros:
                    said |= self._changing_names(macro.step)
            for key in executed & texts.keys():
                said |= texts[key]
            for key in (said | calling) & methods.keys():
                said |= methods[key]
            executed |= {name for name in bodies if name in said}
            if (len(executed), len(said), sum(map(len, possible.values()))) == before:
                break
        self.fixed = fixed
        self._never_said = (bodies.keys() - executed) | self._never_called(
            possible, [texts[k] for k in executed & texts.keys()]
        )
        for name, net in self._nets.items():
            dead = {step.index for step in net.steps} - possible[name]
            is_executed = name in {charts[key] for key in executed & charts.keys()}
            if is_executed and not self._operated and len(dead) < len(net.steps):
                dead |= {step.index for step in self._graph(name).unreachable_steps or ()}
            self.steps[name] = dead
            self.transitions[name] = never.get(name, set()) | {
                t.index for t in net.transitions if set(t.sources) & dead
            }

    def _never_set(self, own: set[str]) -> set[str]:
        """Return those of the POU's own variables that are FALSE at first, and FALSE whenever they are computed."""
        texts = assigning_texts(self._pou, self._system.subject.project.dialect)
        computed = [(name, value) for text in texts for name, value in text.computed.items() if name in own]
        return {
            name
            for name, value in computed
            if self._first_value(name) is False and self._is_impossible([value], self._pou.chart, set())
        }

    def _acting(self, step: Step) -> Step:
        """Return a step without associations that never act, as their time is over at once."""
        if self._system.profile.action_control is not ActionControl.PER_ACTION:
            return step  # a time of zero never ends in the code of matiec
        limited = [each for each in step.actions if each.qualifier in (Qualifier.L, Qualifier.SL) and not each.negated]
        idle = [each for each in limited if each.duration and self.is_no_time(each.duration, None)]
        if not idle:
            return step
        return step.model_copy(update={"actions": [each for each in step.actions if each not in idle]})

    def _always_said(self) -> set[str]:
        """Return the names in what every scan may execute: permanent instructions, and conditions that do something."""
        chart = self._pou.chart
        owners: list[Model] = [*chart.permanent] if chart is not None else []
        for net in self._nets.values():
            owners += [each.transition for each in net.transitions if self._condition(each) is None]
        owners += self._pou.transitions if owners else []
        return set().union(*map(self._changing_names, owners))

    def _situations_of(self, action: str) -> _Situations | None:
        step = self._only_step.get(action)
        own = self._pou.name
        if step is None or self._operated or self._system.profile.evolution is not Evolution.SINGLE:
            return None
        net = self._nets[own]
        firing = [t for t in net.transitions if t.index not in self.transitions.get(own, ())]
        if not any(step.index in transition.sources for transition in firing):
            return _Situations(net, ((step.bit, 0),))  # it is not executed once more behind the step either
        if not self._graph(own).complete:
            return None
        # Behind the step it is executed once more, when its transitions have fired: what is active then was so before,
        # or is entered from there.
        found = []
        for marking in self._graph(own):
            if marking & step.bit:
                later = reduce(or_, (t.post for t in firing if not t.pre & ~marking), marking)
                found += [(marking, ~marking), (0, ~later | step.bit)]
        return _Situations(net, tuple(found))

    @cached_property
    def _only_step(self) -> Mapping[str, NetStep]:
        """The step of the POU's own chart that alone executes an action while it is active, by the action's name."""
        net = self._nets.get(self._pou.name)
        if net is None or net.hierarchy or net.chart.flags_in_use(lambda flag: flag.casefold() in self._declared_flags):
            return {}
        named = Counter(self._named_once())
        found: dict[str, NetStep] = {}
        for step in net.steps:
            own = step.step
            rows = [each for each in own.actions if each.qualifier in _WHILE_ACTIVE and not each.negated]
            names = [*(each.target for each in rows), *own.step_actions.values()]
            found |= {
                name.casefold(): step
                for name in names
                if isinstance(name, str) and named[name.casefold()] == 1 and not own.negated
            }
        return found

    def _named_once(self) -> Iterator[str]:
        """Yield each name in the texts of the project, as often as it is there, in lower case."""
        project = self._system.subject.project
        for text in texts_in(project, project.dialect):
            yield from (use.name.casefold() for use in text.uses)

    @cached_property
    def _declared_flags(self) -> set[str]:
        interface = self._pou.interface
        declared = interface.variables() if interface is not None else []
        everywhere = [v for section in self._system.subject.project.global_sections() for v in section.variables]
        return {variable.name.casefold() for variable in (*declared, *everywhere)} & _FLAGS

    def _names(self, *owners: Model | None) -> set[str]:
        dialect = self._system.subject.project.dialect
        return {name for owner in owners if owner is not None for name in names_in(owner, dialect)}

    def _changing_names(self, owner: Model) -> set[str]:
        """Return the names in a text, without variables that it only gives their first value."""
        found: set[str] = set()
        for text in texts_in(owner, self._system.subject.project.dialect):
            kept = {self._kept(node) for tree in text.trees for node in walk(tree)}
            found |= {use.name.casefold() for use in text.uses if use.span not in kept}
        return found

    def _kept(self, node: n.Node) -> n.Span | None:
        """Return where a variable is given its first value; None: a node does something else."""
        if not isinstance(node, n.Assignment) or node.kind is not n.AssignmentKind.ASSIGN:
            return None
        if not isinstance(node.target, n.Name) or not isinstance(node.value, n.Literal):
            return None
        value = node.value.text.upper()
        first = self._first_value(node.target.identifier)
        return node.target.span if value in ("TRUE", "FALSE") and first is (value == "TRUE") else None

    def _never_called(self, possible: Mapping[str, set[int]], texts: Iterable[set[str]]) -> set[str]:
        """Return the methods that nothing names which can be executed."""
        said = set().union(*texts, self._names(*self._pou.transitions))
        for name, net in self._nets.items():
            said |= self._names(*(each.transition for each in net.transitions))
            said |= self._names(*(net.steps[index].step for index in possible[name]))
        named = with_called(said, self._pou.methods, self._system.subject.project.dialect)
        return {method.name.casefold() for method in self._pou.methods} - named

    def _own_variables(self) -> set[str]:
        """Local variables that only texts of the POU can write."""
        if self._has_references():
            return set()
        interface = self._pou.interface
        sections = sections_of(interface)
        local = {
            v.name.casefold() for s in sections if s.kind is SectionKind.LOCAL for v in s.variables if not v.address
        }
        return local - {name.casefold() for name in self._system.inputs} - _FLAGS

    def _has_references(self) -> bool:
        """True if variables of the POU can be reached by other means than their names."""
        pou, dialect = self._pou, self._system.subject.project.dialect
        interfaces = [pou.interface, *(method.interface for method in pou.methods)]
        variables = [v for interface in interfaces if interface is not None for v in interface.variables()]
        if any(isinstance(each, PointerType) for v in variables for each in inside(v.type)):
            return True
        texts = [*texts_in(pou, dialect)]
        if any(use.name.casefold() in _POINTING for text in texts for use in text.uses):
            return True
        nodes = (node for text in texts for tree in text.trees for node in walk(tree))
        return any(isinstance(node, n.Assignment) and node.kind is n.AssignmentKind.REFERENCE for node in nodes)

    def _is_never(self, name: str, transition: NetTransition, fixed: set[str]) -> bool:
        """Return True if the condition of an unfired transition is FALSE while some variables are not written."""
        if self._fired[name] & transition.bit:
            return False
        condition, before = self._condition(transition), self._false_before(name, transition)
        if condition is None or (self._operated and not before):  # T_PUSH lets the first one fire, if it is FALSE, too
            return False
        return self._is_impossible([condition, *before], transition.chart, fixed)

    def _is_impossible(
        self,
        trees: Sequence[Expression],
        chart: SfcNetwork | None,
        fixed: set[str],
        situations: _Situations | None = None,
    ) -> bool:
        """Return True if one of some conditions is FALSE, in each situation, while some variables are not written."""
        if self._is_late():
            return False
        formula = Formula(self._system.subject.project.dialect, self._knowledge.at(self._pou, chart))
        terms = formula.terms([JudgedCondition(tree) for tree in (*trees, *self._known)])
        known: dict[str, bool | int | float | str | date | None] = {}
        names = formula.names()
        for text in names:
            root = text.casefold().partition(".")[0]
            if root in fixed or text.casefold() in fixed:
                known[text] = self._first_value(text)
        flags = situations.flags(name for name in names if name not in known) if situations is not None else [{}]
        return all(formula.is_impossible(terms, known | each) for each in flags)

    def _first_value(self, text: str) -> bool | int | float | None:
        self._system.reset()
        try:
            with self._system.instance.adding_nothing():
                value = self._system.instance[text]
        except (SfcError, AttributeError):
            return None
        return value if isinstance(value, bool | int | float) else None


def _entered(net: Net, never: set[int]) -> set[int]:
    """Return the steps that can be entered if all other transitions may fire."""
    sourceless = (net.transitions[i].post for i in net.sourceless if i not in never)
    return set(indexes(net.reachable(reduce(or_, sourceless, net.initial), never)))
