"""Everything in a project that a controller executes, as a tree of parts and their aspects.

What people and tools look at (titles, positions, ids, comments, vendor data) is left out, so that two trees differ only
where two machines may. Parts are found again by what they are called and where they stand: steps by name, transitions
by the steps that they connect, actions by what they execute, variables by name.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from plcopen_sfc.conversion.meaning import (
    Meaning,
    address_meaning,
    code_meaning,
    condition_meaning,
    plain,
    type_meaning,
    value_meaning,
)
from plcopen_sfc.formats.durations import duration_literal
from plcopen_sfc.formats.iectext.source import unwrapped
from plcopen_sfc.languages.declarations.kept import kept
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names import Names
from plcopen_sfc.languages.networks import NetworkExpression, condition_reader
from plcopen_sfc.languages.s7_types import S7Types
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, transform
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model.actions import ActionAssociation, ActionEvent, Qualifier
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.conditions import Condition, Expression
from plcopen_sfc.model.pou import DataBlockKind, Pou, PouKind
from plcopen_sfc.model.project import PouInstance, Project, Task
from plcopen_sfc.model.sfc import PermanentOperation, SfcFlag, SfcNetwork, Step, Transition
from plcopen_sfc.model.types import (
    ArrayType,
    ArrayValue,
    DataType,
    DerivedType,
    Elementary,
    ElementaryType,
    EnumType,
    SimpleValue,
    StructType,
    StructValue,
    Value,
    Variable,
)
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.semantics.charts.flags import flags_in_use
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.system_inputs import system_inputs

__all__ = ["Part", "executed"]


class Key(NamedTuple):
    """What a part is found by among its neighbours: its kind and its name, and which of several that are alike."""

    kind: str
    name: str
    number: int = 0


@dataclass(slots=True)
class Part:
    """A part of a project that is executed. `path` is the place in the words of reports (``POU Main / step Fill``).

    Of a transition, `leaves` are the names of the steps that it leaves, as in their keys, and `waiting` is its
    condition together with their minimum times. Of a project, `lists` are the names of its lists of global variables.
    """

    path: str
    aspects: dict[str, Meaning] = field(default_factory=dict)
    parts: dict[Key, Part] = field(default_factory=dict)
    leaves: tuple[str, ...] = ()
    waiting: Meaning | None = None
    lists: frozenset[str] = frozenset()

    def tell(self, aspect: str, meaning: Meaning | None) -> None:
        """Note an aspect; None is nothing to note."""
        if meaning is not None:
            self.aspects[aspect] = meaning

    def add(self, kind: str, name: str, path: str) -> Part:
        """A new part inside this one."""
        number, plain = 0, plain_name(name)
        while Key(kind, plain, number) in self.parts:
            number += 1
        part = self.parts[Key(kind, plain, number)] = Part(path)
        return part


def plain_name(name: str) -> str:
    """A name as all tools could spell it: they know different quotes and signs in names."""
    return _SIGNS.sub("_", name.replace('"', "").removeprefix("#")).casefold()


_SIGNS = re.compile(r"[^\w.>+ -]| (?=\w)")


def executed(
    project: Project,
    profile: Profile | None = None,
    *,
    addresses: Dialect | None = None,
    lists: frozenset[str] = frozenset(),
) -> Part:
    """Everything that a controller executes of a project, under the rules of `profile`.

    `addresses` is the dialect of direct addresses, where it is not that of the program text. `lists` are names of lists
    of global variables that the source of a conversion has: the project may have structures in their place.
    """
    return _Reader(project, profile or default_profile(project), addresses or project.dialect, lists).read()


class _Reader:
    def __init__(self, project: Project, profile: Profile, addresses: Dialect, lists: frozenset[str]) -> None:
        self.project = project
        self.profile = profile
        self.dialect = project.dialect
        self.addresses = addresses
        self.whole = Part("")
        self.lists = {s.name.casefold() for s in self._global_sections() if s.name}
        self.lists |= {block.name.casefold() for block in project.data_blocks}
        self.whole.lists = frozenset(self.lists)
        self.lists |= lists
        self.values = _values(project)
        self.types = S7Types(project.data_types)
        self.declared = {declaration.name.casefold(): declaration.type for declaration in project.data_types}
        self.global_names = {v.name.casefold() for section in self._global_sections() for v in section.variables}

    def read(self) -> Part:
        for declaration in self.project.data_types:
            if not isinstance(declaration.type, StructType):
                continue  # other types are compared where they are used, by what they stand for
            part = self.whole.add("type", declaration.name, declaration.report_path)
            part.tell("type", type_meaning(self._plain_type(declaration.type), self.dialect))
            part.tell("initial value", value_meaning(self._number(declaration.initial), declaration.type))
        self._globals()
        self._tasks()
        for pou in self.project.pous:
            self._pou(pou)
        for occurrence in Names(self.project).undeclared():
            name = occurrence.reference.name
            if name.casefold() in _RESULTS | self.global_names or standard_block(name) is not None:
                continue
            self.whole.add(UNDECLARED, name, occurrence.piece.report_path).tell("name", Meaning.of(name))
        return self.whole

    def named(self, node: n.Node, result: str = "") -> n.Node:
        """A name as all tools could have it: without the list of a global variable; a result is ``Ret_Val``."""
        if (
            isinstance(node, n.Member)
            and isinstance(node.base, n.Name)
            and node.base.identifier.casefold() in self.lists
        ):
            return node.name
        if isinstance(node, n.Member) and isinstance(node.base, n.Name):
            number = self.values.get(f"{node.base.identifier}.{node.name.identifier}".casefold())
            return n.Literal(number) if number is not None else node
        if isinstance(node, n.Name) and node.identifier.casefold() in self.values:
            return n.Literal(self.values[node.identifier.casefold()])
        is_result = result and isinstance(node, n.Name) and node.identifier.casefold() in (result.casefold(), "ret_val")
        if is_result:
            return n.Name("Ret_Val")
        return n.Name(node.identifier) if isinstance(node, n.Name) and node.quoting is not n.Quoting.NONE else node

    def _number(self, value: Value | None) -> Value | None:
        """An initial value, in numbers where it names a value of an enumeration or a constant."""
        if isinstance(value, ArrayValue):
            items = [item.model_copy(update={"value": self._number(item.value)}) for item in value.items]
            return ArrayValue(items=items)
        if isinstance(value, StructValue):
            members = [each.model_copy(update={"value": self._number(each.value)}) for each in value.members]
            return StructValue(members=members)
        if not isinstance(value, SimpleValue) or value.text is None:
            return value
        number = self.values.get(value.text.replace('"', "").replace("#", ".").casefold())
        return value if number is None else SimpleValue(text=number)

    def _plain_type(self, kind: DataType, depth: int = 0) -> DataType:
        """A type without other names for types, with the numbers of enumerations, and with all initial values."""
        if isinstance(kind, DerivedType):
            declared = self.declared.get(kind.name.replace('"', "").casefold())
            stays = declared is None or isinstance(declared, StructType) or depth > _DEEPEST
            return kind if declared is None or stays else self._plain_type(declared, depth + 1)
        if isinstance(kind, EnumType):
            return kind.base or ElementaryType(name=Elementary.INT)
        if isinstance(kind, ArrayType):
            return ArrayType(dimensions=kind.dimensions, base=self._plain_type(kind.base))
        if isinstance(kind, StructType):
            return StructType(members=[self._plain_member(member) for member in kind.members])
        return kind

    def _plain_member(self, member: Variable) -> Variable:
        initial, kind = self._initial(member), self._plain_type(member.type)
        if value_meaning(initial, kind) is None:
            initial = None
        return Variable(name=member.name, type=kind, initial=initial)

    def _initial(self, variable: Variable) -> Value | None:
        """The initial value of a variable, its own or that of its type, in numbers."""
        return self._number(variable.initial) if variable.initial is not None else self.types.start(variable)

    def code(self, body: Body | None, result: str = "") -> Meaning | None:
        """The meaning of a body."""
        return code_meaning(body, self.dialect, lambda node: self.named(node, result))

    def target(self, name: str) -> str:
        """The name of a variable without that of its list."""
        around, dot, rest = name.replace('"', "").partition(".")
        return rest if dot and around.casefold() in self.lists else name

    # -- variables

    def _globals(self) -> None:
        for section in self._global_sections():
            for variable in section.variables:
                self._variable(self.whole, "global variable", variable, section, section.name or "")
        for block in self.project.data_blocks:
            if block.kind is DataBlockKind.INSTANCE:
                part = self.whole.add("instance", block.name, block.report_path)
                part.tell("type", Meaning.of((block.type_name or "").casefold(), block.type_name))
                continue
            for section in block.interface.sections if block.interface is not None else ():
                for variable in section.variables:
                    self._variable(self.whole, "global variable", variable, section, block.name)
        for table in self.project.tag_tables:
            for tag in table.tags:
                variable = Variable.model_validate({"name": tag.name, "type": tag.type, "address": tag.address})
                self._variable(self.whole, "global variable", variable, VariableSection(), "")
            for constant in table.constants:
                self._variable(self.whole, "global variable", constant, VariableSection(constant=True), "")

    def _global_sections(self) -> Iterator[VariableSection]:
        yield from self.project.global_variables
        for configuration in self.project.configurations:
            yield from configuration.global_variables
        for resource in (*self.project.applications, *(r for c in self.project.configurations for r in c.resources)):
            yield from resource.global_variables

    def _variable(self, owner: Part, kind: str, variable: Variable, section: VariableSection, around: str) -> None:
        place = f"{around}.{variable.name}" if around and owner is self.whole else variable.name
        path = f"{kind} {place}" if owner is self.whole else f"{owner.path} / {variable.name}"
        part = owner.add(kind.removesuffix(" of a function"), variable.name, path)
        part.tell("type", type_meaning(self._plain_type(variable.type), self.dialect))
        part.tell("initial value", value_meaning(self._initial(variable), self._plain_type(variable.type)))
        part.tell("address", address_meaning(variable.address, self.addresses))
        if section.retain or section.persistent or variable.attributes.get("Remanence") == "Retain":
            part.tell("retain", Meaning.of(True, "RETAIN"))
        if section.constant or section.kind is SectionKind.CONSTANT:
            part.tell("constant", Meaning.of(True, "CONSTANT"))
        edge = kept(variable.carried).get("edge")
        part.tell("edge", Meaning.of(edge) if edge else None)
        if owner is not self.whole:
            section_kind = SectionKind.LOCAL if section.kind is SectionKind.CONSTANT else section.kind
            if section_kind is SectionKind.LOCAL and kind == "variable of a function":
                section_kind = SectionKind.TEMP  # a function keeps nothing
            part.tell("section", Meaning.of(section_kind.value))
            if kept(section.carried).get("keyword") == "VAR_STAT":
                part.tell("static", Meaning.of(True, "VAR_STAT"))

    # -- tasks

    def _tasks(self) -> None:
        for resource in (*self.project.applications, *(r for c in self.project.configurations for r in c.resources)):
            for task in resource.tasks:
                self._task(task)
            for instance in resource.instances:
                part = self.whole.add("program instance", instance.name, f"program instance {instance.name}")
                _tell_instance(part, instance)

    def _task(self, task: Task) -> None:
        part = self.whole.add("task", task.name, f"task {task.name}")
        part.tell("interval", _time(duration_literal(task.interval)))
        if task.single:
            part.tell("trigger", Meaning.of(task.single.strip().casefold(), task.single))
        part.tell("priority", Meaning.of(task.priority))
        for instance in task.instances:
            inner = part.add("program instance", instance.name, f"task {task.name} / {instance.name}")
            _tell_instance(inner, instance)

    # -- POUs

    def _pou(self, pou: Pou) -> None:
        part = self.whole.add("POU", pou.name, pou.report_path)
        part.tell("kind", Meaning.of(pou.kind.value))
        if pou.interface is not None:
            self._result(part, pou.interface.return_type)
            for section in pou.interface.sections:
                # VAR_EXTERNAL declares nothing: a global variable that is missing is told as such
                for variable in section.variables if section.kind is not SectionKind.EXTERNAL else ():
                    if section.kind is SectionKind.RETURN:
                        self._result(part, variable.type)
                    else:
                        kind = "variable of a function" if pou.kind is PouKind.FUNCTION else "variable"
                        self._variable(part, kind, variable, section, "")
        called: set[str] = set()
        for body in pou.bodies:
            self._body(part, pou, body, pou.report_path, called)
        for method in pou.methods:
            inner = part.add("method", method.name, f"{pou.report_path} / method {method.name}")
            inner.tell("code", self.code(method.body))
        for action in pou.actions:
            if action.name.casefold() not in called or isinstance(action.body, SfcBody):
                inner = part.add("action of the POU", action.name, f"{pou.report_path} / action {action.name}")
                if action.body is not None:
                    self._body(inner, pou, action.body, inner.path, called)

    def _result(self, part: Part, kind: DataType | None) -> None:
        if not (isinstance(kind, DerivedType) and kind.name.casefold() == "void"):  # S7 says so of functions without
            part.tell("result", type_meaning(kind, self.dialect))

    def _body(self, part: Part, pou: Pou, body: Body, path: str, called: set[str]) -> None:
        if isinstance(body, SfcBody):
            if body.chart.steps or body.chart.transitions:
                _ChartReader(self, pou, body.chart, path, called).read(part.add("chart", "", path))
        else:
            number = sum(aspect.startswith("code") for aspect in part.aspects)
            result = pou.name if pou.kind is PouKind.FUNCTION else ""
            meaning = self.code(body, result)
            part.tell(f"code {number + 1}" if number else "code", meaning)


class _ChartReader:
    """Reads one chart: steps, transitions, actions, permanent instructions, partial charts."""

    def __init__(self, owner: _Reader, pou: Pou, chart: SfcNetwork, path: str, called: set[str]) -> None:
        self.owner = owner
        self.pou = pou
        self.chart = chart
        self.path = path
        self.called = called
        self.names = {step.id: step.name for step in chart.steps if not step.exclude}
        self.excluded = {step.id for step in chart.steps if step.exclude}
        declared = {variable.name.casefold() for variable in pou.variables()} | owner.global_names
        self.flags = flags_in_use(chart, owner.profile, lambda name: name.casefold() in declared)
        self.used = Counter(name for step in chart.steps for name in _executed_by(step))
        self._read_condition = condition_reader(chart, owner.dialect, transitions=pou.transitions)

    def condition_of(self, condition: Condition) -> NetworkExpression:
        """A condition as an expression in which names of lists of global variables are left out."""
        found = self._read_condition(condition)
        named = self.owner.named
        tree = transform(found.tree, named) if found.tree is not None else None
        return replace(found, tree=tree, before=tuple(transform(each, named) for each in found.before))

    def read(self, part: Part) -> None:
        for step in self.chart.steps:
            if not step.exclude:
                self._step(part, step)
        keys: dict[int, str] = {}
        for transition in self.chart.transitions:
            if not _is_never(transition) and self.excluded.isdisjoint((*transition.sources, *transition.targets)):
                keys[transition.id] = self._transition(part, transition)
        self._priorities(part, keys)
        self._settings(part)
        operations = (("before", self.chart.permanent_pre), ("after", self.chart.permanent_post))
        for when, permanent in operations:
            for operation in permanent:
                self._permanent(part, operation, when)
        for partial in self.chart.partial_charts:
            path = f"{self.path} / chart {partial.name}"
            inner = part.add("partial chart", partial.name, path)
            _ChartReader(self.owner, self.pou, partial.network, path, self.called).read(inner)

    # -- steps

    def _step(self, chart: Part, step: Step) -> None:
        path = f"{self.path} / step {step.name}"
        part = chart.add("step", step.name, path)
        part.tell("initial", Meaning.of(step.initial, "initial step" if step.initial else "no initial step"))
        if step.negated:
            part.tell("negation", Meaning.of(True, "negated"))
        part.tell("min time", _time(step.min_time))
        if self._uses_maximum_times():
            part.tell("max time", _time(step.max_time))
        for aspect, supervised in (("interlock", step.interlock), ("supervision", step.supervision)):
            if supervised is not None and supervised.condition is not None:
                part.tell(aspect, self._condition(supervised.condition))
        for event, action in (("S1", step.entry_action), ("", step.main_action), ("S0", step.exit_action)):
            if action is not None:
                self._step_action(part, event, action)
        for association in step.actions:
            if not association.exclude:
                self._association(part, step, association)
        if step.macro is not None:
            inner = part.add("macro-step", step.name, path)
            if step.macro.expansion is not None:
                inner.tell("expansion", Meaning.of(step.macro.expansion.casefold(), step.macro.expansion))
            if isinstance(step.macro.body, SfcBody):
                _ChartReader(self.owner, self.pou, step.macro.body.chart, path, self.called).read(inner)
        for enclosure in step.encloses or ():
            inner = part.add("enclosed chart", enclosure.chart, path)
            inner.tell("activated steps", Meaning.of(tuple(map(str.casefold, enclosure.activated_steps))))

    def _uses_maximum_times(self) -> bool:
        """True if exceeding a maximum time does something: S7-GRAPH reports it, CODESYS sets SFCError."""
        if self.owner.profile.graph_parameters:
            return False  # an alarm for people; `.T_MAX` is a variable like others
        return self.owner.profile.maximum_times and SfcFlag.ERROR in self.flags

    def _step_action(self, step: Part, event: str, action: str | Body) -> None:
        """An entry (S1), main or exit (S0) action of CODESYS."""
        name, code = self._code_of(action)
        part = step.add("action", name, f"{step.path} / action {name}")
        when = {"S1": "on activation", "S0": "on deactivation", "": "while active"}[event]
        control = "each" if isinstance(action, str) and self.used[plain_name(action)] > 1 else ""
        part.tell("trigger", Meaning.of((when, control), _STEP_ACTIONS[event]))
        part.tell("code", code)

    def _association(self, step: Part, of: Step, association: ActionAssociation) -> None:
        name, code = self._code_of(association.target, association.body)
        if association.forcing is not None:
            name = f"force {association.forcing.chart}"
        part = step.add("action", name, f"{step.path} / action {name}")
        part.tell("trigger", self._trigger(association, is_code=code is not None))
        pulse = association.qualifier in (Qualifier.P, Qualifier.P1, Qualifier.P0)
        if code is not None and self.owner.profile.final_scan and not pulse:
            part.tell("final scan", Meaning.of(True))
        part.tell("code", code)
        if association.target is not None and association.body is not None:
            part.tell("target", Meaning.of(association.target.casefold(), association.target))
        part.tell("time", _time(association.duration))
        if association.value is not None:
            value = association.value
            part.tell("value", condition_meaning(lambda: self.condition_of(Expression(text=value)), value.strip()))
        if association.condition is not None:
            part.tell("condition", self._condition(association.condition))
        if association.interlock and of.interlock is not None and of.interlock.condition is not None:
            part.tell("interlock", self._condition(of.interlock.condition))
        if association.negated:
            part.tell("negation", Meaning.of(True, "negated"))
        if association.forcing is not None:
            order = association.forcing
            part.tell("forcing", Meaning.of((order.chart, order.situation.value, *order.steps), str(order.situation)))

    def _code_of(self, action: str | Body | None, body: Body | None = None) -> tuple[str, Meaning | None]:
        """What an action is called, and its program; none for a variable."""
        if isinstance(action, str):
            found = self.pou.action(action.removeprefix("#"))
            if found is None:
                return self.owner.target(action), self.owner.code(body)
            self.called.add(found.name.casefold())
            if isinstance(found.body, SfcBody):
                order = self.owner.profile.order.value.replace("_", " ")
                return found.name, Meaning.of(("chart", found.name.casefold(), order), f"a chart, {order}")
            return found.name, self.owner.code(found.body) or Meaning.of("", "an empty action")
        return "in place", self.owner.code(action or body)

    def _trigger(self, association: ActionAssociation, *, is_code: bool) -> Meaning:
        """When an action is executed, the same for all tools: qualifier, event and kind."""
        qualifier, event = association.qualifier, association.event
        if event in (ActionEvent.C, None):
            event = None
        shown = " ".join(filter(None, (qualifier.value, event and f"event {event.value}", association.kind)))
        control = self._control(association, is_code=is_code)
        if association.kind is not None:
            return Meaning.of((association.kind.value, qualifier.value), shown)
        plain = qualifier in (Qualifier.N, Qualifier.NONE, Qualifier.CALL)
        if event is not None and not plain:
            return Meaning.of((event.value, qualifier.value), shown)
        if event is not None:
            when = {ActionEvent.S1: "on activation", ActionEvent.S0: "on deactivation"}.get(event, event.value)
            return Meaning.of((when, control), shown)
        twice = qualifier is Qualifier.P and is_code and self.owner.profile.final_scan
        if qualifier in (Qualifier.P1, Qualifier.P) and not twice:
            return Meaning.of(("on activation", control), shown)
        if qualifier is Qualifier.P0:
            return Meaning.of(("on deactivation", control), shown)
        if plain:
            return Meaning.of(("while active", control), shown)
        return Meaning.of(("R" if qualifier is Qualifier.R0 else qualifier.value, control), shown)

    def _control(self, association: ActionAssociation, *, is_code: bool) -> str:
        """Who controls an action that several associations have: one control for all, or each step for itself.

        It makes a difference for programs, and for what has a time or a pulse.
        """
        name = plain_name(association.target) if association.target is not None else ""
        matters = is_code or association.qualifier.needs_duration or association.qualifier is Qualifier.P
        if not matters or self.used[name] < 2:
            return ""
        return "each" if self.owner.profile.graph_parameters else "one for all"

    # -- transitions

    def _transition(self, chart: Part, transition: Transition) -> str:
        sources = "+".join(sorted(plain_name(self.names.get(i, "?")) for i in transition.sources))
        targets = "+".join(sorted(plain_name(self.names.get(i, "?")) for i in transition.targets))
        name = f"{sources} -> {targets}"
        part = chart.add("transition", name, f"{self.path} / transition {self.chart.label(transition)}")
        part.leaves = tuple(plain_name(self.names.get(i, "?")) for i in transition.sources)
        if transition.condition is not None:
            part.tell("condition", self._condition(transition.condition))
            part.waiting = self._waiting(transition)
        elif self.owner.profile.graph_parameters:
            part.tell("condition", Meaning.of(("TRUE",), "TRUE"))
        return name

    def _waiting(self, transition: Transition) -> Meaning | None:
        """The condition together with the minimum times of the steps that a transition leaves."""
        condition = transition.condition
        sources = [step for step in self.chart.steps if step.id in transition.sources and step.min_time]
        if condition is None or not sources:
            return None
        local = "#" if self.owner.dialect is Dialect.SCL else ""
        times = [f"{local}{step.name}.T >= {step.min_time}" for step in sources]

        def read() -> NetworkExpression:
            found = self.condition_of(condition)
            parsed = [parse_expression(text, self.owner.dialect).tree for text in times]
            trees = [tree for tree in (found.tree, *parsed) if tree is not None]
            return replace(found, tree=n.Operation(n.Operator.AND, tuple(trees)))

        return condition_meaning(_once(read), (plain(condition), *times))

    def _priorities(self, chart: Part, keys: dict[int, str]) -> None:
        """The order in which competing transitions of each step are tried."""
        leaving: dict[int, list[str]] = {}
        for transition in sorted(self.chart.transitions, key=lambda t: (t.priority is None, t.priority or 0)):
            for source in transition.sources if transition.id in keys else ():
                leaving.setdefault(source, []).append(keys[transition.id])
        for source, order in leaving.items():
            if source in self.names and len(order) > 1:
                step = next(p for k, p in chart.parts.items() if k[:2] == ("step", plain_name(self.names[source])))
                step.tell("order of transitions", Meaning.of(tuple(order), ", ".join(order)))

    def _condition(self, condition: Condition) -> Meaning:
        # names and wires say the same in both, whatever they lead to
        raw = plain(condition) if condition.kind in ("expression", "body") else object()
        return condition_meaning(_once(lambda: self.condition_of(condition)), raw)

    # -- around the steps

    def _settings(self, chart: Part) -> None:
        for flag in sorted(self.flags):
            chart.tell(flag.variable, Meaning.of(True, flag.variable))
        inputs = [variable.name for variable in self.pou.variables(SectionKind.INPUT)]
        flags = {flag.variable.casefold() for flag in self.flags}
        operating = system_inputs(self.pou, self.owner.profile, inputs)
        operating -= {name for name in operating if name.rpartition(".")[2].casefold() in flags}
        if operating and self.owner.profile.graph_parameters:
            chart.tell(
                "operating inputs", Meaning.of(frozenset(map(str.casefold, operating)), ", ".join(sorted(operating)))
            )
        graph = self.chart.graph_settings
        if graph is not None and self.owner.profile.graph_parameters:
            for name, needs in _GRAPH_SETTINGS.items():
                matters = not needs or any(getattr(step, needs) is not None for step in self.chart.steps)
                if matters and getattr(graph, name):
                    chart.tell(name.replace("_", " "), Meaning.of(True, "on"))

    def _permanent(self, chart: Part, operation: PermanentOperation, when: str) -> None:
        code = self.owner.code(operation.body)
        if code is not None:
            part = chart.add(f"permanent instruction {when} the sequence", "", self.path)
            part.tell("code", code)


_DEEPEST = 32
"""No type is another name for another name .. more often: these name each other."""
UNDECLARED = "undeclared name"
"""The kind of parts that are names which nothing declares."""


def _executed_by(step: Step) -> Iterator[str]:
    """The names of what a step executes, in every association and step action."""
    for action in (*(row.target for row in step.actions), step.entry_action, step.main_action, step.exit_action):
        if isinstance(action, str):
            yield plain_name(action)


_STEP_ACTIONS = {"S1": "entry action", "": "main action", "S0": "exit action"}
_GRAPH_SETTINGS = {
    "acknowledge_errors_required": "supervision",
    "lock_operating_mode": "",
    "permanent_interlock_processing_in_manual_mode": "interlock",
    "skip_steps": "",
}
"""Settings of S7-GRAPH that change what is executed, and what a step must have for that."""


_RESULTS = frozenset({"trcoil", "ilcoil", "svcoil"})
"""What the results of the networks of S7-GRAPH are called."""


def _values(project: Project) -> dict[str, str]:
    """The numbers of values of enumerations and of user constants, by their names in lower case."""
    found: dict[str, str] = {}
    for declaration in project.data_types:
        number = -1
        for value in declaration.type.values if isinstance(declaration.type, EnumType) else ():
            given = (value.value or "").strip()
            number = int(given) if given.lstrip("-").isdigit() else number + 1
            for name in (f"{declaration.name}.{value.name}", f"{declaration.name}_{value.name}"):
                found[name.casefold()] = str(number)
    for table in project.tag_tables:
        for constant in table.constants:
            if isinstance(constant.initial, SimpleValue) and constant.initial.text is not None:
                found[constant.name.casefold()] = constant.initial.text
    return found


def _is_never(transition: Transition) -> bool:
    """True for a transition that never fires: it is excluded, or its condition is FALSE."""
    condition = transition.condition
    is_false = isinstance(condition, Expression) and condition.text.strip().upper() == "FALSE"
    return transition.exclude or (is_false and not condition.negated)  # type: ignore[union-attr]


def _once(read: Callable[[], NetworkExpression]) -> Callable[[], NetworkExpression]:
    found: list[NetworkExpression] = []

    def again() -> NetworkExpression:
        if not found:
            found.append(read())
        return found[0]

    return again


def _tell_instance(part: Part, instance: PouInstance) -> None:
    name = instance.type_name or instance.name  # an instance without a program is named as its program
    part.tell("type", Meaning.of(name.casefold(), name))
    for data in instance.carried.data if instance.carried is not None else ():
        place, text = unwrapped(data.content) or ("", "")
        if place == "arguments":
            part.tell("arguments", Meaning.of(" ".join(text.split()).casefold(), text))


def _time(text: str | None) -> Meaning | None:
    return value_meaning(SimpleValue(text=text), None) if text and text.strip() else None
