"""Terms of GRAFCETs in program text: flags and times of steps, edges, and the memories that these need.

``X3`` is the flag of a step, ``3s/X3`` its time, ``↑a`` an edge. An edge needs a memory, which somebody has to write in
every scan: see `GrafcetTexts.memories`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from enum import Enum

from plcopen_sfc.conversion.adaptation.chart_rewriting import local_section, taken_names
from plcopen_sfc.conversion.adaptation.grafcet_hierarchy import step_flag
from plcopen_sfc.conversion.adaptation.grafcet_scans import first_names
from plcopen_sfc.languages.binding.name_sites import in_tree
from plcopen_sfc.languages.expression_types import CALCULATING
from plcopen_sfc.languages.grafcet_conditions import ConditionError, to_structured_text
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node, transform, walk
from plcopen_sfc.languages.words import identifier, take_name
from plcopen_sfc.lowering.code.boolean_logic import FALSE, disjunction
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import SfcNetwork, Step
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import SectionKind, VariableSection, sections_of
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.profile import Profile, ScanOrder

Note = Callable[[Outcome, str, str, str], None]
"""Takes what became of something, what it is, where and why."""


class MissingTermError(ValueError):
    """A term that program text has no words for."""


class EventEvolution(Enum):
    """The evolution of a scan in which an event comes: the first, or the one behind that, as actions see both."""

    FIRST = 1
    SECOND = 2


class TextTerms:
    """Times of steps and edges of variables as program text has them.

    `leaves`: the steps that a transition leaves. `event`: they are of an event, and this is its evolution.
    """

    def __init__(
        self,
        chart: GrafcetTexts,
        leaves: Sequence[int] = (),
        *,
        in_action: bool = False,
        event: EventEvolution | None = None,
    ) -> None:
        self._chart, self._leaves, self._in_action, self._event = chart, leaves, in_action, event
        self.has_edge = self.has_edge_of_step = self.has_edge_of_time = False

    def edge(self, operand: str, *, rising: bool) -> str:
        """Return the expression of an edge. Raises `MissingTermError` where there is none."""
        self.has_edge = True
        in_time = self._chart.is_step_time(operand)
        self.has_edge_of_time |= in_time
        self.has_edge_of_step |= bool(self._chart.steps_in(operand, rising=rising)) and not in_time
        if self._in_action:
            raise MissingTermError("an edge lasts for no time that an output could be seen (IEC 60848:2013, 4.8.2)")
        if self._event is not None:
            return self._chart.edge_in_event(operand, self._event, rising=rising)
        return self._chart.edge(operand, rising=rising)

    def delay(self, operand: str, first: str | None, last: str | None) -> str:
        """Return the expression of ``first/operand/last``."""
        bare = operand.strip("()")
        step = self._chart.steps.get(bare[1:].casefold()) if bare[:1] in "Xx" else None
        if step is None or first is None:
            return self._chart.time(operand, first, last, is_late=step is not None)
        passed = f"{step.name}.T >= {first}"
        if last is not None:
            return self._chart.time(f"({bare} AND {passed})", None, last, is_late=True)
        # a step that was left keeps its last time; where a transition leaves it, it is active
        return passed if step.id in self._leaves else f"({bare} AND {passed})"


class GrafcetTexts:
    """The texts of one chart: its names, and the variables that they need besides.

    `steps` by their names in lower case and `groups`, the steps of macro-steps and charts, are for the caller to give.
    `memories`: statements that every scan executes behind the conditions, `times` such before events, of times that
    begin when actions see a step; `edges`: what is read for an edge; `over`:
    what edges of inputs are when nothing changes any more; `was_active`: by the id of a step the variable with its last
    flag; `numbers`: tags that are not Boolean.
    """

    def __init__(self, project: Project, pou: Pou, chart: SfcNetwork, note: Note, target: Profile) -> None:
        self._pou, self._chart, self._note = pou, chart, note
        self._of_graph = target.graph_parameters
        self._actions_first = target.order is ScanOrder.ACTIONS_FIRST
        tags = [tag for table in project.tag_tables for tag in table.tags]
        self._tags = {tag.name.casefold() for tag in tags}
        self.numbers = {tag.name.casefold() for tag in tags if tag.type.casefold() != "bool"}
        lists = [*project.global_sections()]
        self._globals = {v.name.casefold() for section in lists for v in section.variables}
        self._globals |= {section.name.casefold() for section in lists if section.name}
        self._taken = taken_names(project, Chart(pou.name, pou, chart))
        self.steps: dict[str, Step] = {}
        self.groups: dict[str, list[Step]] = {}
        self.edges: dict[tuple[str, bool], str] = {}
        self.memories: list[str] = []
        self.times: list[str] = []
        self.over: dict[str, n.Expression] = {}
        self.was_active: dict[int, str] = {}
        self._seen: dict[str, str] = {}
        self._inputs = {
            variable.name.casefold()
            for section in sections_of(pou.interface)
            for variable in section.variables
            if section.kind is SectionKind.INPUT or (variable.address or "").upper().startswith("%I")
        }
        self._times: dict[tuple[str, str | None, str | None], str] = {}
        self._section: VariableSection | None = None

    # -- edges and times

    def edge(self, operand: str, *, rising: bool) -> str:
        """Return the expression of an edge; its memory is a variable that every scan writes: see `memories`."""
        steps = self.steps_in(operand, rising=rising)
        starts = len(self._chart.initial_steps) > 1 and self._actions_first
        if starts and any(step.initial for step in steps):
            raise MissingTermError("its step becomes active one scan after the start, which would be an edge")
        found = self.edges.get((operand, rising))
        if found is None:
            found = self.edges[operand, rising] = self._memory(operand, steps, rising=rising)
        return found

    def steps_in(self, operand: str, *, rising: bool) -> list[Step]:
        """Return the steps whose flags are in the operand of an edge. Raises `MissingTermError` for no name."""
        names = first_names(self._opened(operand))
        timed = self._timed(operand)
        undeclared = [name for name in names if not self._declares(name) and name not in timed]
        unknown = [name for name in undeclared if self.step_of(name) is None and name.casefold() not in self._globals]
        if unknown:
            what = shown_edge(operand, rising=rising)
            raise MissingTermError(f"{what} is an edge of something that is no variable and no step: {unknown[0]}")
        return [step for name in undeclared if (step := self.step_of(name)) is not None]

    def _opened(self, operand: str) -> n.Expression:
        """Return an operand with the flags of the steps inside instead of those of macro-steps and charts."""
        return transform(parse_expression(operand).tree, self._open)

    def _open(self, node: n.Node) -> n.Node:
        inside = self._inside(node)
        if inside is None:
            return node
        return n.Parenthesized(disjunction(n.Name(f"X{step.name}") for step in inside))

    def _inside(self, node: n.Node) -> Sequence[Step] | None:
        """Return the steps of a macro-step or chart, of which a node is the flag; None for any other node."""
        if not isinstance(node, n.Name) or node.identifier[:1] not in "Xx" or self._declares(node.identifier):
            return None
        return self.groups.get(node.identifier[1:].casefold())

    def _timed(self, operand: str) -> set[str]:
        """Return the names of the steps whose times are in an operand."""
        tree = parse_expression(operand).tree
        members = [each for each in walk(tree) if isinstance(each, n.Member)] if tree is not None else []
        return {print_node(each.base) for each in members} & {step.name for step in self._chart.steps}

    def is_step_time(self, operand: str) -> bool:
        """True for the time of a step, and nothing else: ``3s/X2`` as text."""
        timed = self._timed(operand)
        steps = [self.step_of(name) for name in first_names(parse_expression(operand).tree) if name not in timed]
        return len(timed) == 1 and timed == {step.name if step is not None else "" for step in steps}

    def step_of(self, name: str) -> Step | None:
        """Return the step whose flag `name` is, as ``X5``."""
        return self.steps.get(name[1:].casefold()) if name[:1] in "Xx" else None

    def _memory(self, operand: str, steps: Sequence[Step], *, rising: bool) -> str:
        wish = _as_name(operand)
        tree = parse_expression(operand).tree
        # what is TRUE at the start had no edge, but the flags of initial steps
        is_flag = isinstance(tree, n.Name) and bool(steps)
        before = self.new_variable(f"{wish}_before", initial="TRUE" if rising and not is_flag else None)
        happens = _edge(operand, before, rising=rising)
        of_inputs = tree is not None and self._inputs.issuperset(name.casefold() for name in first_names(tree))
        if not self._actions_first and not self._of_graph:
            # the transitions of this scan have changed the flags of steps already
            earlier = {step.name.casefold(): self.activity_before(step) for step in steps}
            now = transform(self._opened(operand), lambda node: self._earlier(node, earlier))
            # as the transitions have seen it: before timers go on, and before memories that it reads
            self.memories.insert(0, f"{before} := {print_node(now)};")
            if tree is not None and of_inputs:
                self.over[before] = tree
            return happens
        edge = self.new_variable(f"{wish}_{'rises' if rising else 'falls'}")
        memories = self.times if self._actions_first and self.is_step_time(operand) else self.memories
        memories += [f"{edge} := {self.flagged(happens)};", f"{before} := {self.flagged(operand)};"]
        if of_inputs:
            self.over[edge] = FALSE
        return edge

    def edge_in_event(self, operand: str, event: EventEvolution, *, rising: bool) -> str:
        """Return the expression of an edge as actions behind the transitions see it, in one evolution of the scan.

        An edge of an input is in the first. In the second a flag has changed, which was as it is behind the
        transitions of the scan before.
        """
        if not self.steps_in(operand, rising=rising):
            return self.edge(operand, rising=rising) if event is EventEvolution.FIRST else "FALSE"
        tree = parse_expression(operand).tree
        first = self.flagged(operand, self.flag_before)
        if event is EventEvolution.SECOND:
            return _edge(self.flagged(operand), first, rising=rising)
        if isinstance(tree, n.Name):
            return "FALSE"  # a flag alone
        seen = self._seen.get(operand)
        if seen is None:
            seen = self._seen[operand] = self.new_variable(f"{_as_name(operand)}_seen", initial="TRUE")
            self.memories.append(f"{seen} := {self.flagged(operand)};")
        return _edge(first, seen, rising=rising)

    def _earlier(self, node: n.Node, earlier: dict[str, str]) -> n.Node:
        step = self.step_of(node.identifier) if isinstance(node, n.Name) else None
        return n.Name(earlier[step.name.casefold()]) if step is not None and step.name.casefold() in earlier else node

    def activity_before(self, step: Step) -> str:
        """Return the variable that tells whether a step was active before the transitions of the scan."""
        found = self.was_active.get(step.id)
        if found is None:
            initial = "TRUE" if step.initial else None
            found = self.was_active[step.id] = self.new_variable(f"{step.name}_was_active", initial=initial)
        return found

    def time(self, operand: str, first: str | None, last: str | None, *, is_late: bool) -> str:
        """Return the expression of a time of anything: the output of a timer that every scan calls with the edges.

        `is_late`: the operand is the flag of a step, which the timer sees when its transitions have fired.
        """
        found = self._times.get((operand, first, last))
        if found is None:
            found = self.flagged(operand)
            wish = _as_name(operand)
            for block, delay in (("TON", first), ("TOF", last)):
                if delay is not None:
                    name = self.new_variable(f"{block}_{wish}", block=block)
                    self.memories.append(f"{name}(IN := {found}, PT := {delay});")
                    found = f"{name}.Q"
            self._times[operand, first, last] = found
            parts = [part.removeprefix("T#") for part in (first, operand, last) if part is not None]
            path = f"POU {self._pou.name} / {'/'.join(parts)}"
            if is_late:
                self._note(Outcome.APPROXIMATED, "time", path, "a timer, which sees that a step ends one scan later")
            elif self._actions_first or self._of_graph:
                self._note(Outcome.TRANSLATED, "time", path, "a timer")
            else:
                why = "a timer, which actions call behind the transitions: these see it one scan later"
                self._note(Outcome.APPROXIMATED, "time", path, why)
        return found

    def new_variable(self, wish: str, *, initial: str | None = None, block: str = "") -> str:
        """Declare a Boolean variable, or an instance of a function block; return its name."""
        if self._section is None:
            self._section = local_section(self._pou)
        name = self.new_name(wish)
        kind = DerivedType(name=block) if block else ElementaryType(name=Elementary.BOOL)
        self._section.variables.append(Variable(name=name, type=kind, initial=initial))
        return name

    def new_name(self, wish: str) -> str:
        """Return a name that nothing in the POU or around it has."""
        return take_name(identifier(wish), self._taken)

    def text(self, text: str, terms: TextTerms) -> str:
        """Return a condition of a GRAFCET as structured text. Raises `ConditionError`, `MissingTermError`."""
        return self.flagged(to_structured_text(text, terms))

    def flagged(self, text: str, flag: Callable[[n.Node], n.Node] | None = None) -> str:
        """Return structured text with the flags of steps as the tool has them."""
        parsed = parse_expression(text)
        if parsed.problems:  # a variable whose name is a keyword of structured text
            raise ConditionError(parsed.problems[0].message, parsed.problems[0].span)
        self._check_uses(parsed.tree, text)
        return print_node(transform(parsed.tree, flag or self.flag))

    def _check_uses(self, tree: n.Expression, text: str) -> None:
        """Refuse steps as values, and Booleans as numbers: structured text would mean something else, or nothing."""
        for each in in_tree(tree, Dialect.IEC):
            is_value = each.base is None and each.callee is None and not each.access
            if is_value and each.name.casefold() in self.steps and not self.is_known(each.name):
                raise MissingTermError(f"{each.name} is a step and no value: its flag is X{each.name}")
            if each.base is None and each.access and self._is_bool(each.name):
                raise MissingTermError(
                    f"{each.name} is a BOOL: it has no {each.access}; AND is written * or . between blanks"
                )
        operations = [each for each in walk(tree) if isinstance(each, n.Operation) and each.operator in CALCULATING]
        for operand in (n.bare(operand) for each in operations for operand in each.operands):
            if isinstance(operand, n.Name) and self._is_bool(operand.identifier):
                raise MissingTermError(
                    f"{operand.identifier} is BOOL, and {text} calculates with it: write [..] around a comparison"
                )

    def is_known(self, name: str) -> bool:
        """True for what the GRAFCET or a list of global variables declares."""
        return self._declares(name) or name.casefold() in self._globals

    def flag(self, node: n.Node) -> n.Node:
        """Return for ``X3`` the flag of step 3, for ``XM1`` and ``XG1`` those inside; any other node as it is."""
        if isinstance(node, n.Name) and node.identifier[:1] in "Xx":
            name = node.identifier[1:].casefold()
            step = self.steps.get(name)
            if step is not None and not self._declares(node.identifier):
                return step_flag(step)
            inside = self._inside(node)
            if inside is not None:
                return n.Parenthesized(disjunction(map(step_flag, inside)))
        return node

    def flag_before(self, node: n.Node) -> n.Node:
        """Return for the flag of a step whether it was active before the transitions of the scan."""
        flagged = self.flag(node)
        if flagged is node:
            return node

        named = {step.name: step for step in self._chart.steps}

        def before(member: n.Node) -> n.Node:
            if isinstance(member, n.Member) and isinstance(member.base, n.Name):
                return n.Name(self.activity_before(named[member.base.identifier]))
            return member

        return transform(flagged, before)

    def _declares(self, name: str) -> bool:
        """True for what a GRAFCET declares, which its steps do not hide; inputs with an address are tags by now."""
        wanted = name.casefold()
        return wanted in self._tags or any(variable.name.casefold() == wanted for variable in self._pou.variables())

    def _is_bool(self, name: str) -> bool:
        """True for a declared BOOL, and for the flag of a step."""
        wanted = name.casefold()
        if wanted in self._tags:
            return wanted not in self.numbers
        found = next((each for each in self._pou.variables() if each.name.casefold() == wanted), None)
        if found is None:
            return wanted[:1] == "x" and wanted[1:] in self.steps and wanted not in self._globals
        return isinstance(found.type, ElementaryType) and found.type.name is Elementary.BOOL


def _as_name(operand: str) -> str:
    return re.sub(r"\W+", "_", operand).strip("_")


def _edge(operand: str, before: str, *, rising: bool) -> str:
    """Return an edge in structured text; `before`: what has the value before."""
    now, was = (each if re.fullmatch(r"[\w.]+|\([^()]*\)", each) else f"({each})" for each in (operand, before))
    return f"({now} AND NOT {was})" if rising else f"(NOT {now} AND {was})"


def shown_edge(operand: str, *, rising: bool) -> str:
    """Return an edge as a GRAFCET has it."""
    return f"{'↑' if rising else '↓'}{operand}"
