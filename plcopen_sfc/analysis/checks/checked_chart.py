"""Rules, and charts and their project as rules see them, with the places that findings can point at."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from fnmatch import fnmatchcase
from functools import cached_property
from itertools import combinations
from typing import NamedTuple

from plcopen_sfc.analysis.checks.flag_values import FlagValues
from plcopen_sfc.analysis.checks.judged_terms import JudgedTerms
from plcopen_sfc.analysis.exclusivity import Exclusivity, Truth, exclusive, overlapping, truth
from plcopen_sfc.analysis.formulas import Formula
from plcopen_sfc.analysis.joint_firings import ConditionedSituations, JointFirings
from plcopen_sfc.analysis.knowledge import Knowledge, ProjectKnowledge
from plcopen_sfc.analysis.marking import MarkingGraph, marking_graph
from plcopen_sfc.analysis.ruled_situations import RuledSituations
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.binding import Declaration, Names, bind, texts_in
from plcopen_sfc.languages.binding.compile_mistakes import constant_written, type_mistakes, value_kind, value_mistake
from plcopen_sfc.languages.binding.name_scopes import every_chart
from plcopen_sfc.languages.binding.name_uses import Occurrence, dialect_of
from plcopen_sfc.languages.binding.text_sites import SiteKind, TextSite
from plcopen_sfc.languages.effects import path_of
from plcopen_sfc.languages.networks import NetworkExpression, condition_expression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, parse_statements, walk
from plcopen_sfc.languages.translation.call_translation import has_function
from plcopen_sfc.model import sfc
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import (
    DataType,
    DataTypeDeclaration,
    DerivedType,
    SimpleValue,
)
from plcopen_sfc.semantics.net import Net, NetStep, NetTransition
from plcopen_sfc.semantics.profile import PROFILES, Profile

FAMILIES = tuple(PROFILES)
"""The profiles that severities are given for."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A breach of a rule: where, and what is wrong there. `hint`: a more exact one than that of the rule."""

    place: FindingPlace
    message: str
    hint: str = ""


@dataclass(frozen=True)
class Rule:
    """A numbered rule on charts, and on POUs without charts where it is `on_code`.

    `why` tells what goes wrong with charts that break it, and its source; `hint` what to do. `severity` is
    that of a breach, but for the profiles in `severities`; None: the rule is not for them. `grafcet_hint` is the hint
    in the words of IEC 60848, which has no qualifiers and priorities. `example` is a chart that breaks it: in textual
    SFC, or a GRAFCET as text, where these can express it.
    """

    code: str
    title: str
    why: str
    hint: str
    example: str
    check: Callable[[CheckedChart], Iterator[Finding]]
    severity: Severity | None
    severities: Mapping[str, Severity | None] = field(default_factory=dict)
    grafcet_hint: str = ""
    on_code: bool = False

    def severity_for(self, family: str) -> Severity | None:
        """Return how bad a breach is under a profile of `FAMILIES`; None: the rule does not apply."""
        return self.severities.get(family, self.severity)

    def hint_for(self, family: str) -> str:
        """Return what to do about a breach under a profile of `FAMILIES`."""
        return self.grafcet_hint if family == "grafcet" and self.grafcet_hint else self.hint

    @property
    def hints(self) -> str:
        """What to do about a breach, and what in a GRAFCET where that has other words."""
        return f"{self.hint} In a GRAFCET: {self.grafcet_hint}" if self.grafcet_hint else self.hint


def ring(first: str = "", second: str = "", forth: str = "a", back: str = "b") -> str:
    """Return an example: two steps in a circle, with their actions and the conditions between them."""
    return f"""
INITIAL_STEP S1: {first} END_STEP
STEP S2: {second} END_STEP
TRANSITION FROM S1 TO S2 := {forth}; END_TRANSITION
TRANSITION FROM S2 TO S1 := {back}; END_TRANSITION
""".replace(":  END", ": END")


MOST_MARKINGS = 5_000
"""Markings that are visited for each chart before questions about all of them are left unanswered."""
_MOST_FIRINGS = 2_000_000
"""The same for markings times transitions: a second or so."""
_MOST_QUESTIONS = 1_000
"""Questions to the solver about what conditions let happen together: a second or so."""


@dataclass(frozen=True, eq=False)
class FindingPlace:
    """Place of a finding.

    `path` names it for people; `elements` are the object itself and those around it, the innermost first.
    """

    path: str
    elements: tuple[Element, ...]

    @property
    def excluded(self) -> bool:
        """True if it is excluded from the program, by itself or with an object around it."""
        return any(getattr(element, "exclude", False) for element in self.elements)


@dataclass(frozen=True, eq=False)
class CheckedSheet:
    """One network of steps and transitions: the chart itself, a partial chart of it, or the expansion of a macro-step.

    `partial` is the partial chart, `macro` the macro-step that it belongs to.
    """

    chart: sfc.SfcNetwork
    place: FindingPlace
    partial: sfc.PartialChart | None = None
    macro: sfc.Step | None = None

    @cached_property
    def steps(self) -> tuple[sfc.Step, ...]:
        """The steps that are in the program."""
        return tuple(step for step in self.chart.steps if not step.exclude)

    @cached_property
    def transitions(self) -> tuple[sfc.Transition, ...]:
        """The transitions that are in the program."""
        return tuple(transition for transition in self.chart.transitions if not transition.exclude)

    @cached_property
    def names(self) -> dict[int, str]:
        """The names of all steps by their id."""
        return {step.id: step.name for step in self.chart.steps}

    @cached_property
    def leaving(self) -> dict[int, list[sfc.Transition]]:
        """The transitions that leave each step (by its id), in the order in which they are tried."""
        return sfc.leaving_steps(self.transitions)

    def label(self, transition: sfc.Transition) -> str:
        """Return the label of a transition, as `SfcNetwork.label`."""
        return self._transition_labels[id(transition)]

    @cached_property
    def _transition_labels(self) -> dict[int, str]:
        """The labels of transitions (by `id`)."""
        labels = self.chart.labels()
        return {id(transition): labels[transition.id] for transition in self.chart.transitions}

    def actions(self) -> Iterator[tuple[sfc.Step, sfc.ActionAssociation]]:
        """Yield the action associations that are in the program, with their steps."""
        for step in self.steps:
            for association in step.actions:
                if not association.exclude:
                    yield step, association

    def at(self, element: sfc.Step | sfc.Transition, association: sfc.ActionAssociation | None = None) -> FindingPlace:
        """Return the place of a step, of an association of it, or of a transition."""
        if isinstance(element, sfc.Transition):
            return self._below(f"transition {self.label(element)}", element)
        if association is None:
            return self._below(f"step {element.name}", element)
        return self._below(f"step {element.name} / action {self._labels[id(association)]}", association, element)

    @cached_property
    def _labels(self) -> dict[int, str]:
        """The labels of actions (by `id`)."""
        return {
            id(association): label
            for step in self.chart.steps
            for association, label in zip(step.actions, step.action_labels(), strict=True)
        }

    def _below(self, name: str, *elements: Element) -> FindingPlace:
        path = f"{self.place.path} / {name}" if self.place.path else name
        return FindingPlace(path, (*elements, *self.place.elements))


def family(profile: Profile) -> str:
    """Return the name of the profile of `PROFILES` that this one is, or that it shares most of its choices with."""
    if profile.name in PROFILES:
        return profile.name

    def alike(name: str) -> int:
        return sum(getattr(profile, each.name) == getattr(PROFILES[name], each.name) for each in fields(Profile))

    return max(PROFILES, key=alike)


def is_of_the_tool(occurrence: Occurrence, dialect: Dialect) -> bool:
    """True for names that no project declares: standard blocks, operators of CODESYS, coils that TIA Portal names."""
    name = occurrence.reference.name
    return has_function(dialect, name) or name in _COILS


_COILS = frozenset({"TrCoil", "IlCoil", "SvCoil"})
"""Coils in the networks of a transition, an interlock and a supervision of S7-GRAPH (seen in exports)."""


_FLAGS = {flag.variable.casefold(): flag for flag in SfcFlag}


class Misfit(NamedTuple):
    """Something in a text that does not fit, such as a number that is assigned to a BOOL."""

    text_site: TextSite
    message: str


class CheckedProject:
    """A project as the rules on its charts see it: declared variables, and what writes them.

    `externals` are patterns for names that are declared elsewhere; where there are some, all others are declared here.
    """

    def __init__(self, project: Project, externals: Iterable[str] = ()) -> None:
        self.project = project
        self.externals = tuple(pattern.casefold() for pattern in externals)

    @cached_property
    def dialect(self) -> Dialect:
        """The dialect in which texts are read."""
        return dialect_of(self.project)

    @cached_property
    def named(self) -> Names:
        """Declarations, and the places that name them."""
        return Names(self.project)

    @cached_property
    def undeclared(self) -> tuple[Occurrence, ...]:
        """The names that nothing declares, each where it is first."""
        return self._here(self.named.undeclared())

    def undeclared_in(self, pou: Pou) -> tuple[Occurrence, ...]:
        """Return the same of one POU: where others have the name too, it may be the flag of a step there."""
        return self._here(self.named.undeclared(pou))

    def _here(self, found: Iterable[Occurrence]) -> tuple[Occurrence, ...]:
        """Return the names that are not declared elsewhere."""
        return tuple(
            each
            for each in found
            if not is_of_the_tool(each, self.dialect)
            and not self._is_flag(each)
            and not any(fnmatchcase(each.reference.name.casefold(), pattern) for pattern in self.externals)
        )

    def _is_flag(self, occurrence: Occurrence) -> bool:
        """True for an SFC flag that the tool declares: CODESYS does where the settings of the chart do not refuse."""
        reference, site = occurrence.reference, occurrence.text_site.site
        flag = _FLAGS.get(reference.name.casefold())
        if flag is None or self.project.dialect not in (Dialect.CODESYS, Dialect.TWINCAT):
            return False
        base = self.named.resolver.type_of(reference.base, site) if reference.base is not None else site.pou
        charts = every_chart(base) if isinstance(base, Pou) else ()
        stated = [chart.settings.flags.get(flag) if chart.settings is not None else None for chart in charts]
        return any(each is None or (each.use and each.declare) for each in stated)

    @cached_property
    def undeclared_types(self) -> tuple[Occurrence, ...]:
        """The names of types that nothing declares, each where it is first."""
        return self._here(self.named.undeclared_types())

    @cached_property
    def undeclared_members(self) -> tuple[Occurrence, ...]:
        """The members that their types do not have."""
        return tuple(each for each in self.named.undeclared_members() if not self._is_flag(each))

    @cached_property
    def unused(self) -> tuple[Declaration, ...]:
        """Declarations that only text of the project could use, and none does."""
        return tuple(self.named.unused())

    @cached_property
    def endless_types(self) -> tuple[tuple[DataTypeDeclaration | Pou, ...], ...]:
        """The types and function blocks that contain themselves, with those that they do it through."""
        return tuple(self.named.resolver.endless_types())

    @cached_property
    def misfits(self) -> tuple[Misfit, ...]:
        """Assignments and comparisons in structured text whose types do not fit."""
        return tuple(self._misfits())

    def _misfits(self) -> Iterator[Misfit]:
        for each in self.named.text_sites():
            if isinstance(each.holder, sfc.ActionAssociation) and each.key in ("target", "indicator"):
                tree = parse_condition(each.text, self.dialect).tree
                constant = constant_written(tree, self.named.resolver, each.site)
                if constant:
                    yield Misfit(each, f"{constant} is a constant, and written: {each.text}")
            if each.is_program_text:
                yield from (Misfit(each, message) for message in self._mistakes(each))

    def _mistakes(self, text_site: TextSite) -> Iterator[str]:
        """Yield what does not fit in a text; one that cannot be read is a mistake of another rule."""
        text, holder, resolver = text_site.text, text_site.holder, self.named.resolver
        target = holder.target if isinstance(holder, sfc.ActionAssociation) and text_site.key == "value" else None
        if target or text_site.reading is not SiteKind.EXPRESSION:
            # the value of a row must fit its target: it is read as the assignment that it stands for
            statements = parse_statements(f"{target} := {text};" if target else text, self.dialect)
            if not statements.problems:
                yield from type_mistakes(statements.tree, resolver, text_site.site)
            return
        value = parse_condition(text, self.dialect)
        if value.problems:
            return
        yield from type_mistakes(value.tree, resolver, text_site.site)
        if text_site.key in _DURATIONS:
            kind = value_kind(value.tree, resolver, text_site.site)
            if kind not in ("", "TIME"):
                yield f"a duration is {kind}: {text}"
        message = value_mistake(value.tree, resolver, text_site) if isinstance(holder, SimpleValue) else ""
        if message:
            yield message

    @cached_property
    def knowledge(self) -> ProjectKnowledge:
        """Declarations of the names in conditions."""
        return ProjectKnowledge(self.project)

    @cached_property
    def globals(self) -> dict[str, DataType]:
        """The types of global variables and tags by their names in lower case."""
        found: dict[str, DataType] = {}
        for section in self.project.global_sections():
            for variable in section.variables:
                found[variable.name.casefold()] = variable.type
        for table in self.project.tag_tables:
            for tag in table.tags:
                found[tag.name.casefold()] = DerivedType(name=tag.type)
        return found

    @cached_property
    def names(self) -> frozenset[str]:
        """The names, in lower case, of everything global that has members: POUs, types, blocks, lists, instances."""
        project = self.project
        resources = [*project.resources()]
        found = [thing.name for thing in project.objects()]
        found += [section.name or "" for section in self.project.global_sections()]
        found += [configuration.name for configuration in project.configurations]
        found += [resource.name for resource in resources]
        found += [i.name for r in resources for i in r.every_instance()]
        return frozenset(name.casefold() for name in found)

    def is_first(self, checked: CheckedChart, pou: Pou | None = None) -> bool:
        """True for the first chart of a POU, or of the project, with which rules find what is in none.

        Where there is no chart, that is the POU itself, or the first POU of the project.
        """
        first = self._first_chart if pou is None else next(every_chart(pou), None)
        return first is checked.chart if first is not None else (pou or self.project.pous[0]) is checked.pou

    @cached_property
    def _first_chart(self) -> sfc.SfcNetwork | None:
        # Each POU asks, and where there is no chart the search goes through all of them.
        return next(self._charts(), None)

    @cached_property
    def written(self) -> frozenset[str]:
        """The last names, in lower case, of everything that code writes anywhere in the project."""
        bound = (bind(body, self.dialect) for _, _, body in self.project.bodies())
        return frozenset(path[-1] for each in bound for path in each.code.writes if path)

    @cached_property
    def associated(self) -> dict[str, set[int]]:
        """The charts (by `id`) that have associations with an operand of this last name, in lower case."""
        found: dict[str, set[int]] = {}
        for chart in self._charts():
            for _, association in chart.associations():
                name = self._last_name(association.target or "")
                if name:
                    found.setdefault(name, set()).add(id(chart))
        return found

    def _last_name(self, text: str) -> str:
        tree = parse_condition(text, self.dialect).tree if text else None
        path = path_of(tree) if isinstance(tree, n.Operand) else ()
        return path[-1] if path else ""

    def _charts(self) -> Iterator[sfc.SfcNetwork]:
        return (chart for pou in self.project.pous for chart in every_chart(pou))


MOST_TOGETHER = 8
"""Transitions that are told for each one that is true together with them: every pair of 250 would take minutes."""
_FEW = 3
"""Competing transitions that are compared two by two at once: most selections have no more."""


class CheckedChart:
    """A chart with all that rules ask about it. Nothing is worked out before it is asked for."""

    def __init__(
        self, around: CheckedProject, pou: Pou | None, place: FindingPlace, chart: sfc.SfcNetwork, profile: Profile
    ) -> None:
        self.around = around
        self.dialect = around.dialect
        self.pou = pou
        self.chart = chart
        self.profile = profile
        self.family = family(profile)
        self.is_code = chart is _NO_CHART
        """True for a POU without charts, which has only code that rules look at."""
        self.root = CheckedSheet(chart, place)
        self._conditions: dict[int, NetworkExpression] = {}
        self._truths: dict[int, Truth] = {}
        self._overlaps: dict[tuple[int, ...], list[tuple[int, int]]] = {}
        self._exclusive: dict[tuple[int, int], Exclusivity] = {}

    @cached_property
    def sheets(self) -> tuple[CheckedSheet, ...]:
        """The networks that the chart consists of; the chart itself is the first."""
        return tuple(_sheets(self.root, frozenset()))

    def steps(self) -> Iterator[tuple[CheckedSheet, sfc.Step]]:
        """Yield the steps of all networks that are in the program."""
        return ((sheet, step) for sheet in self.sheets for step in sheet.steps)

    def transitions(self) -> Iterator[tuple[CheckedSheet, sfc.Transition]]:
        """Yield the transitions of all networks that are in the program."""
        return ((sheet, transition) for sheet in self.sheets for transition in sheet.transitions)

    def actions(self) -> Iterator[tuple[CheckedSheet, sfc.Step, sfc.ActionAssociation]]:
        """Yield the action associations of all networks that are in the program, with their steps."""
        return ((sheet, step, association) for sheet in self.sheets for step, association in sheet.actions())

    def enclosures(self) -> Iterator[tuple[CheckedSheet, sfc.Step, sfc.Enclosure]]:
        """Yield what steps enclose."""
        return ((sheet, step, each) for sheet, step in self.steps() for each in step.encloses or ())

    @cached_property
    def net(self) -> Net:
        """The net of the chart, with macro-steps expanded and all partial charts."""
        return (Net.of_sequencer if self.family == "s7graph" else Net.of)(self.chart)

    @cached_property
    def graph(self) -> MarkingGraph:
        """Reachable situations of the net. Competing transitions never fire together here: SEL01 is about those."""
        affordable = _MOST_FIRINGS // (len(self.net.transitions) + 1)
        return marking_graph(self.net, cap=min(MOST_MARKINGS, affordable))

    @cached_property
    def situations(self) -> RuledSituations:
        """Situations of a GRAFCET in which charts rule others."""
        return RuledSituations(self.net, min(MOST_MARKINGS, _MOST_FIRINGS // (10 * (len(self.net.transitions) + 1))))

    def concurrent(self, a: NetStep, b: NetStep) -> bool:
        """Return True if two steps can be active together; False where that is not known.

        In a GRAFCET conditions count: charts that look at each other's flags may keep each other out.
        """
        if self.net.hierarchy:
            found = self.situations.concurrent(a, b)
        else:
            found = self.graph.complete and self.graph.concurrent(a, b) is Answer.YES
        return found and not (self.family == "grafcet" and self._conditioned.apart(a, b))

    @cached_property
    def _conditioned(self) -> ConditionedSituations:
        conditions = [self.condition(self.sheet_of(each), each.transition) for each in self.net.transitions]
        firings = JointFirings(
            Formula(self.dialect, self.knowledge), conditions, self._flag_values.bits, _MOST_QUESTIONS
        )
        return ConditionedSituations(self.net, firings, _MOST_QUESTIONS)

    def apart(self, a: NetStep, b: NetStep) -> bool:
        """Return True if two steps can never be active together; False where that is not known."""
        if self.net.hierarchy:
            return self.situations.complete and not self.situations.concurrent(a, b)
        return self.graph.concurrent(a, b) is Answer.NO

    @cached_property
    def types(self) -> dict[str, DataType]:
        """The types of the variables that the chart can name, by their names in lower case."""
        own = {v.name.casefold(): v.type for v in self.pou.variables()} if self.pou is not None else {}
        return self.around.globals | own

    @cached_property
    def knowledge(self) -> Knowledge:
        """Types with their bounds, and constants, of the names in conditions."""
        return self.around.knowledge.at(self.pou, self.chart)

    @cached_property
    def holders(self) -> dict[int, FindingPlace]:
        """The places of steps and transitions by the objects (`id`) that hold their texts."""
        found: dict[int, FindingPlace] = {}
        for sheet in self.sheets:
            elements: list[sfc.Step | sfc.Transition] = [*sheet.chart.steps, *sheet.chart.transitions]
            for step, association in sheet.actions():
                for text in texts_in(association, self.dialect):
                    found.setdefault(id(text.text_site.holder), sheet.at(step, association))
            for element in elements:
                for text in texts_in(element, self.dialect):
                    found.setdefault(id(text.text_site.holder), sheet.at(element))
        return found

    @cached_property
    def flags(self) -> frozenset[str]:
        """The names of the flags of a GRAFCET (``X12``, ``XM1``, ``XG1``), in lower case; none in other charts."""
        return frozenset(map(str.casefold, self.net.flags)) if self.family == "grafcet" else frozenset()

    @cached_property
    def _flag_values(self) -> FlagValues:
        """The flags of a GRAFCET and their values."""

        def situations() -> Iterable[int] | None:
            found = self.situations if self.net.hierarchy else self.graph
            return found if found.complete else None

        return FlagValues(self.net, self.types.keys(), situations, self.apart)

    @cached_property
    def steps_of_pou(self) -> frozenset[str]:
        """The names of all steps in the POU, in lower case."""
        charts = every_chart(self.pou) if self.pou is not None else ()
        return frozenset(step.name.casefold() for chart in charts for step in chart.steps)

    @cached_property
    def _terms(self) -> JudgedTerms:
        """The edges and times in the conditions of a GRAFCET."""
        conditions = (transition.condition for _, transition in self.transitions())
        is_grafcet = self.family == "grafcet"
        return JudgedTerms(each.text for each in conditions if is_grafcet and isinstance(each, Expression))

    def condition(self, sheet: CheckedSheet, transition: sfc.Transition) -> NetworkExpression:
        """Return the condition of a transition as an expression."""
        found = self._conditions.get(id(transition))
        if found is None:
            named = self.pou.transitions if self.pou is not None else ()
            if self.family == "grafcet" and isinstance(transition.condition, Expression):
                text = self._terms.read(transition.condition.text)
                read = transition.condition.model_copy(update={"text": text})
                transition = transition.model_copy(update={"condition": read})
            found = condition_expression(sheet.chart, transition, self.dialect, transitions=named)
            if self.family == "grafcet" and found.tree is not None:
                sources = (sheet.names.get(source, "") for source in transition.sources)
                found = replace(found, tree=self._flag_values.while_active(sources, found.tree))
            self._conditions[id(transition)] = found
        return found

    def term(self, condition: Expression) -> n.Expression | None:
        """Return the condition or the event of an action of a GRAFCET; None where it cannot be read."""
        parsed = parse_condition(self._terms.read(condition.text), self.dialect)
        return None if parsed.problems else parsed.tree

    def as_written(self, text: str) -> str:
        """Return a text about conditions with edges and times as a GRAFCET has them."""
        return self._terms.shown(text)

    def truth(self, sheet: CheckedSheet, transition: sfc.Transition) -> Truth:
        """Return the answer to whether a condition is always or never true."""
        found = self._truths.get(id(transition))
        if found is None:
            condition = self.condition(sheet, transition)
            # deciding costs time, and most conditions vary: no constant in them, and no variable twice
            simple = condition.tree is not None and not condition.before and is_plain(condition.tree)
            found = Truth.VARIES if simple else truth(condition, dialect=self.dialect, knowledge=self.knowledge)
            if self.family == "grafcet" and found is Truth.VARIES:
                [known] = self._flag_values.possible([condition], [transition])
                never = known is not condition and truth(known, dialect=self.dialect, knowledge=self.knowledge)
                found = Truth.NEVER if never is Truth.NEVER else found
            self._truths[id(transition)] = found
        return found

    def overlaps(self, sheet: CheckedSheet, leaving: Sequence[sfc.Transition]) -> list[tuple[int, int]]:
        """Return the places of two competing transitions that are not known to exclude each other, in order.

        With each later one at most `MOST_TOGETHER` others are paired.
        """
        if len(leaving) <= _FEW:
            return [*combinations(range(len(leaving)), 2)]
        key = tuple(id(transition) for transition in leaving)
        if key not in self._overlaps:
            conditions = [self.condition(sheet, transition) for transition in leaving]
            found = overlapping(conditions, most=MOST_TOGETHER, dialect=self.dialect, knowledge=self.knowledge)
            self._overlaps[key] = sorted(found)
        return self._overlaps[key]

    def exclusive(self, sheet: CheckedSheet, first: sfc.Transition, second: sfc.Transition) -> Exclusivity:
        """Return whether the conditions of two competing transitions exclude each other."""
        key = id(first), id(second)
        if key not in self._exclusive:
            conditions = [self.condition(sheet, each) for each in (first, second)]
            if self.family == "grafcet":
                conditions = self._flag_values.possible(conditions, (first, second))
            self._exclusive[key] = exclusive(*conditions, dialect=self.dialect, knowledge=self.knowledge)
        return self._exclusive[key]

    def fires_with(self, one: NetTransition, other: NetTransition) -> bool:
        """Return True if two transitions of a GRAFCET may fire in one evolution, as far as their conditions tell."""
        return not self.exclusive(self.sheet_of(one), one.transition, other.transition)

    def place_of(self, element: NetStep | NetTransition) -> FindingPlace:
        """Return the place of a step or transition of the net."""
        return self.sheet_of(element).at(element.step if isinstance(element, NetStep) else element.transition)

    def sheet_of(self, element: NetStep | NetTransition) -> CheckedSheet:
        """Return the network that has a step or transition of the net."""
        return self._sheet_of[id(element.chart)]

    @cached_property
    def _sheet_of(self) -> dict[int, CheckedSheet]:
        return {id(sheet.chart): sheet for sheet in reversed(self.sheets)}


def _sheets(sheet: CheckedSheet, around: frozenset[int]) -> Iterator[CheckedSheet]:
    """Yield a network and those inside it."""
    if id(sheet.chart) in around:
        return
    around = around | {id(sheet.chart)}
    yield sheet
    for step in sheet.steps:
        if step.macro is not None and isinstance(step.macro.body, sfc.SfcBody):
            yield from _sheets(CheckedSheet(step.macro.body.chart, sheet.at(step), macro=step), around)
    for partial in sheet.chart.partial_charts:
        place = sheet._below(partial.name, partial)
        yield from _sheets(CheckedSheet(partial.chart, place, partial=partial), around)


def is_plain(tree: n.Node) -> bool:
    """Return True if an expression joins Boolean variables by AND, OR and NOT, each of them once: then it varies."""
    seen: set[str] = set()
    for node in walk(tree):
        if isinstance(node, n.Operation) and node.operator not in n.CONNECTIVES:
            return False
        if isinstance(node, n.Name | n.Address):
            name = (node.identifier if isinstance(node, n.Name) else node.text).casefold()
            if name in seen:
                return False
            seen.add(name)
        elif not isinstance(node, n.Operation | n.Unary | n.Parenthesized | n.Member):
            return False
    return True


_DURATIONS = frozenset({"duration", "min_time", "max_time", "warning_time"})
_NO_CHART = sfc.SfcNetwork()


def code_of(around: CheckedProject, pou: Pou, profile: Profile) -> CheckedChart:
    """Return what rules on code look at in a POU without charts."""
    return CheckedChart(around, pou, FindingPlace(pou.report_path, (pou,)), _NO_CHART, profile)


def charts_of(around: CheckedProject, pou: Pou, profile: Profile) -> Iterator[CheckedChart]:
    """Yield every chart of a POU: its body, those of its actions, and charts inside of steps."""
    path = f"POU {pou.name}"
    parts: list[tuple[str, Element, sfc.Body | None]] = [
        *((f"{path} / action {a.name}", a, a.body) for a in pou.actions),
        *((f"{path} / transition {t.name}", t, t.body) for t in pou.transitions),
        *((f"{path} / method {m.name}", m, m.body) for m in pou.methods),
    ]
    for body in pou.bodies:
        yield from _charts_in(body, FindingPlace(path, (pou,)), around, pou, profile)
    for name, part, inner in parts:
        yield from _charts_in(inner, FindingPlace(name, (part, pou)), around, pou, profile)


def _charts_in(
    body: sfc.Body | str | None, place: FindingPlace, around: CheckedProject, pou: Pou, profile: Profile
) -> Iterator[CheckedChart]:
    if not isinstance(body, sfc.SfcBody):
        return
    chart = body.chart
    checked = CheckedChart(around, pou, FindingPlace(place.path, (chart, body, *place.elements)), chart, profile)
    yield checked
    for sheet in checked.sheets:
        for at, inner in _bodies_in(sheet):
            yield from _charts_in(inner, at, around, pou, profile)


def _bodies_in(sheet: CheckedSheet) -> Iterator[tuple[FindingPlace, sfc.Body | str | None]]:
    """Return the bodies that steps have in place."""
    for step in sheet.steps:
        yield from ((sheet.at(step), action) for action in step.step_actions.values())
    for step, association in sheet.actions():
        yield sheet.at(step, association), association.body
