"""Steps that S7-GRAPH skips, as transitions that lead past them.

With the setting SkipSteps a step does not become active if a transition behind it is satisfied already. So for each
transition there are others, which are tried before it: to the steps behind those that are skipped, with all the
conditions on the way. No step is passed twice: a way may end where it has begun, and then no transition fires. The
rules are those of `plcopen_sfc.semantics.charts.graph`, and the tests compare both.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice, product
from typing import NamedTuple

from plcopen_sfc.conversion.adaptation.chart_rewriting import ChartRewriting, all_of, any_of, as_term, conjunction
from plcopen_sfc.conversion.adaptation.operating_inputs import AddedElements
from plcopen_sfc.conversion.adaptation.step_checks import StepChecks
from plcopen_sfc.languages.effects import reads
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.sfc import Transition, by_priority
from plcopen_sfc.report import Outcome

_MOST_WAYS = 100
"""The most ways of a chart past its steps for which there is a transition each."""
_TOGETHER = ".skips"
"""A name in all marks: an edit of one transition counts for all of them."""


class _Way(NamedTuple):
    """A way past steps: the conditions on it, and the steps at its end."""

    conditions: tuple[str, ...]
    ends: frozenset[int]


class SkipRewriter:
    """Adds the transitions past steps to a chart whose conditions and sequences are rewritten already."""

    def __init__(self, rewriting: ChartRewriting, checks: StepChecks) -> None:
        self._rewriting, self._checks, self._host = rewriting, checks, rewriting.host
        self._chart = rewriting.chart.chart
        self._own = [each for each in by_priority(self._chart.transitions) if each.id in rewriting.source_transitions]
        # what holds a step, and the operating mode, do not count for the ways on: the step is not active
        self._stated = {each.id: rewriting.text(each.condition) for each in rewriting.source.transitions}
        self._onward: dict[int, list[Transition]] = {}
        for each in self._own:
            if len(each.sources) == 1:
                self._onward.setdefault(each.sources[0], []).append(each)

    def rewrite(self) -> None:
        """Change the chart; a setting that no transitions can replace is in the report."""
        settings = self._rewriting.source.graph_settings
        if settings is None or not settings.skip_steps:
            return
        ways = {each.id: list(islice(self._beyond(each.targets, frozenset()), _MOST_WAYS)) for each in self._own}
        why = self._refusal(ways)
        if why is not None:
            self._rewriting.note(Outcome.NOT_EXECUTED, "skip steps", "", f"{why}: each step is active for a scan")
            return
        added = AddedElements(self._rewriting, self._checks)
        texts = {each.id: self._rewriting.text(each.condition) or "TRUE" for each in self._own}
        for number, transition in enumerate(self._own):
            before = [
                self._fires(each, texts[each.id], transition)
                for each in self._competing(self._own[:number], transition)
            ]
            stays = self._lead_past(transition, ways[transition.id], texts[transition.id], before, added)
            for other in self._competing(self._own[number:], transition) if stays else ():
                self._hold(other, self._fires(transition, stays, other))
        added.mark([_TOGETHER])
        self._rewriting.note(Outcome.TRANSLATED, "skip steps", "", "transitions lead past the steps that are skipped")

    def _beyond(self, steps: Sequence[int], passed: frozenset[int]) -> Iterator[_Way]:
        """Yield the ways on from steps that would become active; the first one whose conditions are TRUE counts."""
        for found in product(*(list(islice(self._past(step, passed), _MOST_WAYS)) for step in steps)):
            ends = frozenset[int]().union(*(way.ends for way in found))
            yield _Way(tuple(text for way in found for text in way.conditions), ends)

    def _past(self, step: int, passed: frozenset[int]) -> Iterator[_Way]:
        for transition in self._onward.get(step, ()) if step not in passed else ():
            for way in self._beyond(transition.targets, passed | {step}):
                yield way._replace(conditions=(self._stated[transition.id] or "TRUE", *way.conditions))
        yield _Way((), frozenset({step}))

    def _refusal(self, ways: Mapping[int, Sequence[_Way]]) -> str | None:
        """Return why no transitions lead past the steps; None where they do."""
        source = self._rewriting.source
        if len(self._own) < len(source.transitions):
            return "the steps of the sequence are loops"
        if None in self._stated.values():
            return "a condition is no expression"
        if sum(map(len, ways.values())) >= _MOST_WAYS:
            return f"there are more than {_MOST_WAYS} ways past the steps"
        names = {step.id: step.name.casefold() for step in source.steps}
        for transition in source.transitions:
            tree = parse_expression(self._stated[transition.id] or "TRUE", self._host.dialect).tree
            asked = {path[0] for path in reads(tree) if len(path) > 1 and path[1] != "x"}
            if asked & {names[number] for number in transition.sources}:
                return "a condition asks for the time of a step that is skipped"
        for transition in self._own:
            leaves = frozenset(transition.sources)
            for way in ways[transition.id]:
                if way.ends == leaves or way.ends == frozenset(transition.targets):
                    continue
                if way.ends & leaves or (self._host.is_codesys and len({*leaves}) * len(way.ends) != 1):
                    return "the way past a step begins or ends with several steps"
        return None

    def _lead_past(
        self, transition: Transition, ways: Sequence[_Way], text: str, before: Sequence[str], added: AddedElements
    ) -> str:
        """Add the transitions of ways; return when one leads back to where it began, empty where none does."""
        stays: list[str] = []
        tried: list[str] = []
        direct = frozenset(transition.targets)
        for way in ways[:-1]:
            condition = all_of(way.conditions)
            only = self._rewriting.reduced(
                all_of([text, condition, *(f"NOT {as_term(each)}" for each in [*before, *tried])])
            )
            tried.append(condition)
            if only == "FALSE":
                continue
            if way.ends == frozenset(transition.sources):
                stays.append(
                    condition
                    if len(tried) == 1
                    else self._rewriting.reduced(all_of([condition, *(f"NOT {as_term(each)}" for each in tried[:-1])]))
                )
                continue
            if way.ends == direct:
                continue  # the transition itself fires then: no way before it counts
            leaves = [step for step in self._chart.steps if step.id in transition.sources]
            for step in leaves:
                why = "transitions past steps are tried before the others"
                self._rewriting.note(Outcome.TRANSLATED, "order of transitions", f"step {step.name}", why)
            enters = [step for step in self._chart.steps if step.id in way.ends]
            added.transition(leaves, enters, only, "it leads past steps that are skipped", first=True)
        return any_of(all_of([text, each]) for each in stays) if stays else ""

    def _competing(self, others: Iterable[Transition], transition: Transition) -> Iterator[Transition]:
        return (each for each in others if not set(each.sources).isdisjoint(transition.sources))

    def _fires(self, transition: Transition, text: str, other: Transition) -> str:
        """Return when a transition fires, on condition of `text`, while the steps of another one are active."""
        steps = [each for each in self._chart.steps if each.id in {*transition.sources} - {*other.sources}]
        return all_of([*(self._host.active(step) for step in steps), text])

    def _hold(self, transition: Transition, stays: str) -> None:
        """Let a transition not fire where a way past steps leads back to the step that it leaves."""
        text = conjunction(self._rewriting.text(transition.condition) or "TRUE", f"NOT {as_term(stays)}")
        uses = [*self._checks.names_of_edges(), _TOGETHER]
        self._rewriting.change_condition(transition, self._rewriting.reduced(text), uses)
        why = "not where steps are skipped up to the one that it leaves"
        what = "transition" if transition.condition == Expression(text="FALSE") else "condition"
        self._rewriting.note(Outcome.TRANSLATED, what, f"transition {self._chart.label(transition)}", why)
