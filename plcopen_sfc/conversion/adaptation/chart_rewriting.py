"""A chart that is being rewritten for another tool, and its conditions in the terms of that tool."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import chain

from plcopen_sfc.formats.format_interface import ChartHost, WriteOptions
from plcopen_sfc.formats.plcopen.source_marks import (
    REWRITTEN_FIELD,
    SourceMarks,
    added_section,
    changed_element,
    rewritten_transition,
)
from plcopen_sfc.languages.networks import Helper, condition_reader, is_empty_network
from plcopen_sfc.languages.st import parse_expression, print_node
from plcopen_sfc.languages.words import identifier, take_name
from plcopen_sfc.lowering.code.boolean_logic import reduced
from plcopen_sfc.lowering.code.lowered_code import names_of
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import BodyCondition, Condition, SfcNetwork, Step, Transition
from plcopen_sfc.model.types import DataType, DerivedType, Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import Cause, ConversionReport, Outcome

GRAPH_CHARTS = ChartHost("S7-GRAPH", is_s7=True)
"""Charts of TIA Portal, whose texts are in SCL."""


@dataclass(eq=False)
class ChartRewriting:
    """A chart that is being rewritten: where, what it was in the source, for whom, and what is known of it."""

    chart: Chart
    source: SfcNetwork
    host: ChartHost
    options: WriteOptions
    report: ConversionReport
    marks: SourceMarks
    taken: set[str]
    flags: frozenset[SfcFlag] = frozenset()
    """The SFC flags of a chart of CODESYS that something uses."""
    _interlocks: dict[int, str | None] = field(default_factory=dict)
    _added: VariableSection | None = None

    def __post_init__(self) -> None:
        """Prepare to read conditions."""
        self.source_steps = {step.id: step for step in self.source.steps}
        self.source_transitions = {transition.id: transition for transition in self.source.transitions}
        self.read = condition_reader(
            self.chart.chart, self.host.dialect, transitions=self.chart.pou.transitions, taken=self.taken
        )
        """Reads a condition as an expression and the statements before it."""

    def note(self, outcome: Outcome, what: str, place: str, why: str, cause: Cause | None = None) -> None:
        """Report the outcome of something at `place` in the chart."""
        path = self.chart.report_path
        self.report.add(outcome, what, f"{path} / {place}" if place else path, why, cause)

    def text(self, condition: Condition | None) -> str | None:
        """Return the text of a condition; None where it cannot be one expression, as with a timer."""
        if condition is None:
            return None
        if is_empty_network(condition):
            return "TRUE"
        found = self.read(condition)
        if found.tree is None or found.before or found.helpers or not found.complete:
            return None
        return print_node(found.tree)

    def change_condition(self, transition: Transition, condition: str, uses: Iterable[str]) -> None:
        """Give a transition another condition, which depends on the added variables `uses`, too."""
        transition.condition = Expression(text=condition)
        self.mark_condition(transition, uses)

    def mark_condition(self, transition: Transition, uses: Iterable[str]) -> None:
        """Keep the condition of the source for the way back, beside what is marked of the transition already."""
        mark = self.marks.get(id(transition), {})
        known = mark.get(REWRITTEN_FIELD, {})
        if "added" in known:
            self.marks[id(transition)] = changed_element(transition, mark, uses)
            return
        source, held = self.source_transitions[transition.id], known.get("held", ())
        self.marks[id(transition)] = mark = rewritten_transition(
            transition, source, [*known.get("uses", ()), *uses], held
        )
        if "logic" in known:
            mark[REWRITTEN_FIELD]["logic"] = known["logic"]

    def reduced(self, text: str) -> str:
        """Return a condition without what other parts of it decide."""
        parsed = parse_expression(text, self.host.dialect)
        return text if parsed.problems else print_node(reduced(parsed.tree))

    @property
    def of_graph(self) -> bool:
        """True for a chart of S7-GRAPH, also where another file keeps it."""
        return self.options.of_graph or self.chart.chart.graph_settings is not None

    def interlock(self, step: Step) -> str | None:
        """Return the interlock of a step: TRUE where it has none, None where it is no expression."""
        if step.id not in self._interlocks:
            condition = step.conditions.get("interlock")
            self._interlocks[step.id] = "TRUE" if condition is None else self.text(condition)
        return self._interlocks[step.id]

    def new_variable(self, wish: str, kind: DataType | None = None) -> str:
        """Declare a variable that the source does not have, Boolean unless a type is given; return its name."""
        name = self.new_name(wish)
        self.declare(name, kind or ElementaryType(name=Elementary.BOOL))
        return name

    def declare(self, name: str, kind: DataType) -> None:
        """Declare a variable of the POU that the source does not have."""
        self.taken.add(name.casefold())
        if self._added is None:
            self._added = local_section(self.chart.pou)
        self._added.variables.append(variable := Variable(name=name, type=kind))
        if self.host.is_s7:
            self.marks.setdefault(id(self.chart.pou), {}).setdefault("variables", []).append(variable)
        else:
            self.marks[id(self._added)] = added_section(self._added)

    def new_name(self, wish: str) -> str:
        """Return a name that nothing in the POU or around it has."""
        return take_name(identifier(wish), self.taken)

    def enabled(self, transition: Transition, tried: Iterable[tuple[Transition, str]]) -> str:
        """Return when a condition is tested: its steps are active, and no competing transition before it fires.

        `tried` are transitions that are tested before, with their conditions.
        """
        active = {step.id: self.host.active(step) for step in self.chart.chart.steps}
        terms = [active[source] for source in transition.sources if source in active]
        for other, text in tried:
            if not set(other.sources).isdisjoint(transition.sources):
                more = [active[source] for source in other.sources if source not in transition.sources]
                terms.append(f"NOT {as_term(' AND '.join([*more, as_term(text)]))}")
        return " AND ".join(terms)

    def declare_helpers(self, helpers: Iterable[Helper]) -> list[str]:
        """Declare the variables that boxes need and the source does not have; their names."""
        found = {helper.name: helper for helper in helpers}
        for helper in found.values():
            self.declare(helper.name, type_of_helper(helper))
        return [*found]


def type_of_helper(helper: Helper) -> DataType:
    """Return the type of a variable that a drawing needs."""
    known = Elementary.__members__.get((helper.type_name or "BOOL").upper())
    return ElementaryType(name=known) if known is not None else DerivedType(name=helper.type_name or "")


def local_section(pou: Pou) -> VariableSection:
    """Add a section of local variables to a POU."""
    pou.interface = pou.interface or Interface()
    pou.interface.sections.append(VariableSection(kind=SectionKind.LOCAL))
    return pou.interface.sections[-1]


def names_around(pou: Pou) -> set[str]:
    """Return the names of the variables of a POU, and of the global ones of its project, in lower case."""
    shared = [section.variables for section in pou.project.global_sections()] if pou.project is not None else []
    return {variable.name.casefold() for variable in chain(pou.variables(), *shared)}


def flags_in_use(place: Chart) -> frozenset[SfcFlag]:
    """Return the SFC flags of a chart that its settings or the names around it bring into use."""
    declared = names_around(place.pou)
    return place.chart.flags_in_use(lambda name: name.casefold() in declared)


def taken_names(project: Project, chart: Chart) -> set[str]:
    """Return the names that something in the POU of a chart has, or around it, in lower case."""
    pou = chart.pou
    names = [*names_of(project), *(thing.name for thing in project.objects())]
    names += [each.name for each in (*pou.parts, *pou.variables())]
    names += [step.name for other in project.charts() if other.pou is pou for step in other.chart.steps]
    return {name.casefold() for name in names}


def is_network(condition: Condition | None) -> bool:
    """True if a condition is drawn in place, in FBD or LD."""
    return isinstance(condition, BodyCondition) and isinstance(condition.body, FbdBody | LdBody)


def is_supervised(step: Step) -> bool:
    """True if a step has a supervision with a condition."""
    condition = step.conditions.get("supervision")
    return condition is not None and not is_empty_network(condition)


def as_term(text: str) -> str:
    """Return an expression as a part of another one."""
    return text if re.fullmatch(r'#?[\w."]+', text) else f"({text})"


def all_of(terms: Iterable[str]) -> str:
    """Return the conjunction of expressions; empty ones do not count."""
    found = [term for term in dict.fromkeys(terms) if term not in ("", "TRUE")]
    if "FALSE" in found or "NOT TRUE" in found:
        return "FALSE"
    simple = [each if each == f"NOT {as_term(each.removeprefix('NOT '))}" else as_term(each) for each in found]
    return " AND ".join(simple) if len(found) > 1 else (found or ["TRUE"])[0]


def any_of(terms: Iterable[str]) -> str:
    """Return the disjunction of expressions."""
    found = [term for term in dict.fromkeys(terms) if term != "FALSE"]
    if "TRUE" in found:
        return "TRUE"
    return " OR ".join(map(as_term, found)) if len(found) > 1 else (found or ["FALSE"])[0]


def conjunction(text: str, *more: str) -> str:
    """Return an expression that is TRUE where all of these are; the others than the first are terms already."""
    for each in more:
        text = each if text == "TRUE" else f"{as_term(text)} AND {each}"
    return text


def first_of(cases: Iterable[tuple[str, list[str]]]) -> list[str]:
    """Return a statement for the first of the conditions that is TRUE; an empty condition is for what is left."""
    lines: list[str] = []
    for condition, statements in cases:
        word = "ELSIF" if lines else "IF"
        lines.append(f"{word} {condition} THEN" if condition else "ELSE")
        lines += [f"    {line}" for line in statements]
    return [*lines, "END_IF;"] if lines else []


def guarded(condition: str, lines: list[str]) -> list[str]:
    """Return statements that are executed only while `condition` is TRUE."""
    if condition == "TRUE" or not lines:
        return lines
    return [f"IF {condition} THEN", *(f"    {line}" for line in lines), "END_IF;"]
