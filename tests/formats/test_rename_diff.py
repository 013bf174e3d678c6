"""One edit of the model is one edit of the file: the diff stays in the element that was edited."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Hashable, Iterator
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.drawing import fits
from plcopen_sfc.languages.binding import Use
from plcopen_sfc.model import (
    ActionAssociation,
    BodyCondition,
    Expression,
    IlBody,
    Project,
    Qualifier,
    SfcNetwork,
    StBody,
    Step,
    Symbol,
    SymbolKind,
    Transition,
)
from tests.samples import (
    CORPUS_PARAMS,
    FIXTURE_PARAMS,
    NEW,
    Hunk,
    Span,
    assert_only_names_changed,
    assert_same,
    assert_within,
    charts_in,
    decoded,
    difference,
    fixture_files,
    label,
    name_places,
    outline,
    params,
    real_files,
)
from tests.sweeps import WHOLE, one_of_each, some_files

SMALL = 200_000
"""Files up to this size have every step renamed that has no like; of bigger ones a sample."""
SEED = 60848


def chosen(size: int, steps: list[tuple[int, int]]) -> list[tuple[int, int]]:
    if size <= SMALL:
        return steps
    number = max(3, 2_000_000 // size)
    return random.Random(SEED).sample(steps, min(number, len(steps)))  # noqa: S311


@pytest.mark.slow
@pytest.mark.parametrize("path", params(3))
def test_renaming_a_step_changes_the_lines_that_name_it(path: Path) -> None:
    """Of steps that look alike one is renamed, unless everything is to be run."""
    data = path.read_bytes()
    project = sfc.loads(data)
    spans = charts_in(outline(data))
    charts = [chart.chart for chart in project.charts()]
    assert len(spans) == len(charts)
    steps = [(i, k) for i, chart in enumerate(charts) for k, step in enumerate(chart.steps) if step.name]
    text = decoded(data)

    def looks(place: tuple[int, int]) -> Hashable:
        """Traits that may matter: first of its name, content of the step, where it is named and how often."""
        chart, number = place
        step = charts[chart].steps[number]
        has = tuple(sorted(name for name in type(step).model_fields if getattr(step, name)))
        named = tuple(span.tag for span in name_places(spans[chart], number))
        more = min(text.count(step.name) - len(named), 2)
        return charts[chart].step(step.name) is step, step.name.isascii(), has, named, more

    for chart, number in chosen(len(data), one_of_each(steps, looks)):
        step = charts[chart].steps[number]
        old = step.name
        uses: tuple[Use, ...] = ()
        if charts[chart].step(old) is step:
            uses = charts[chart].rename_step(old, NEW).changed
        else:  # a second step of this name
            step.name = NEW
        edited = sfc.dumps(project)
        note = f"{old} in chart {chart}"
        assert_only_names_changed(data, edited, old, name_places(spans[chart], number), uses=len(uses), note=note)
        again = sfc.loads(edited)
        # a reformatted file keeps the blanks around the name: what is kept for that says the new name now
        assert again == project or (step.extension_data is not None and step.extension_data.data)
        assert [net(c.chart) for c in again.charts()] == [net(c) for c in charts]
        if uses:
            charts[chart].rename_step(NEW, old)
        step.name = old
    assert sfc.dumps(project) == data


BIG = [path for path in some_files([*fixture_files(), *real_files()], 4) if path.stat().st_size > SMALL]


@pytest.mark.slow
@pytest.mark.corpus
@pytest.mark.parametrize("path", BIG, ids=label)
def test_more_steps_of_the_bigger_files(path: Path) -> None:
    """Every 60th of them, of the biggest files every 150th: each costs as much as the whole file.

    The lines alone are looked at, which takes a third of the time of the test above; that has one of each look.
    """
    data = path.read_bytes()
    stride = 1 if WHOLE else 150 if len(data) > 1_000_000 else 60
    project = sfc.loads(data)
    spans = charts_in(outline(data))
    for number, chart in enumerate(chart.chart for chart in project.charts()):
        for position, step in list(enumerate(chart.steps))[number % stride :: stride]:
            old = step.name
            step.name = NEW
            assert_only_names_changed(data, sfc.dumps(project), old, name_places(spans[number], position), note=old)
            step.name = old
    assert sfc.dumps(project) == data


# -- edits of other kinds ---------------------------------------------------------------------------------------------


class EditedProject:
    """A project that is edited, and the file that it was loaded from."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.project: Project = sfc.loads(data)
        self.root = outline(data)
        self.spans = charts_in(self.root)
        self.fewer: int | None = None
        self.charts: list[SfcNetwork] = [chart.chart for chart in self.project.charts()]

    def steps(self) -> Iterator[tuple[int, SfcNetwork, Step]]:
        for number, chart in enumerate(self.charts):
            for step in chart.steps:
                yield number, chart, step

    def transitions(self) -> Iterator[tuple[int, SfcNetwork, Transition]]:
        for number, chart in enumerate(self.charts):
            for transition in chart.transitions:
                yield number, chart, transition

    def associations(self) -> Iterator[tuple[int, SfcNetwork, Step, ActionAssociation]]:
        for number, chart, step in self.steps():
            for association in step.actions:
                yield number, chart, step, association

    def symbol(self, chart: SfcNetwork, wanted: Callable[[Symbol], bool]) -> Symbol:
        assert chart.drawing is not None
        return next(symbol for symbol in chart.drawing.symbols if wanted(symbol))

    def span(self, chart: int, number: int) -> Span:
        """The element with this ``localId``."""
        return next(s for s in self.spans[chart].children if s.attributes.get("localId") == str(number))

    def block(self, number: int, chart: SfcNetwork, association: ActionAssociation) -> tuple[Span, Span]:
        """The action block of an association, and its line in it."""
        symbol = self.symbol(
            chart,
            lambda s: s.kind is SymbolKind.ACTION_BLOCK and association.id in [e.association for e in s.entries or ()],
        )
        block = self.span(number, symbol.id)
        lines = [child for child in block.children if child.tag == "action"]
        return block, lines[[e.association for e in symbol.entries or ()].index(association.id)]


Edit = Callable[[EditedProject], list[Span]]
"""Edits a project; returns the elements of the file in which the diff may lie."""


def found(things: Iterator[object]) -> object:
    thing = next(things, None)
    if thing is None:
        pytest.skip("nothing of this kind in the file")
    return thing


def condition_text(subject: EditedProject) -> list[Span]:
    places = (
        (n, c, t)
        for n, c, t in subject.transitions()
        if isinstance(t.condition, Expression) and len(t.sources) == 1 and "\n" not in t.condition.text
    )
    number, chart, transition = found(places)  # type: ignore[misc]
    transition.condition = "bStart AND NOT bStörung OR x < 5"
    symbol = subject.symbol(chart, lambda s: s.id == transition.id or transition.id in (s.transitions or ()))
    spans = [subject.span(number, symbol.id)]
    if symbol.condition is not None:
        spans.append(subject.span(number, symbol.condition.connections[0].source))
    return spans


def inline_condition(subject: EditedProject) -> list[Span]:
    places = (
        (n, t)
        for n, _, t in subject.transitions()
        if isinstance(t.condition, BodyCondition)
        and isinstance(t.condition.body, IlBody)
        and not t.condition.body.markup
    )
    number, transition = found(places)  # type: ignore[misc]
    transition.condition.body.text = "LDN bFertig"
    return [subject.span(number, transition.id)]


def qualifier(subject: EditedProject) -> list[Span]:
    number, chart, _, association = found(subject.associations())  # type: ignore[misc]
    association.qualifier = Qualifier.R if association.qualifier is not Qualifier.R else Qualifier.S
    return [subject.block(number, chart, association)[1]]


def duration(subject: EditedProject) -> list[Span]:
    timed = (a for a in subject.associations() if a[3].duration)
    number, chart, _, association = found(timed)  # type: ignore[misc]
    association.duration = "T#1h2m3s"
    return [subject.block(number, chart, association)[1]]


def new_comment(subject: EditedProject) -> list[Span]:
    number, _, step = found(s for s in subject.steps() if s[2].comment is None)  # type: ignore[misc]
    step.comment = "Füllen < Leeren & „Übergang“"
    return [subject.span(number, step.id)]


def other_comment(subject: EditedProject) -> list[Span]:
    number, _, step = found(s for s in subject.steps() if isinstance(s[2].comment, str))  # type: ignore[misc]
    step.comment = "kurz"
    return [subject.span(number, step.id)]


def max_time(subject: EditedProject) -> list[Span]:
    number, _, step = found(s for s in subject.steps() if s[2].max_time is None and s[2].macro is None)  # type: ignore[misc]
    step.max_time = "T#12s"
    return [subject.span(number, step.id)]


def min_time_removed(subject: EditedProject) -> list[Span]:
    number, _, step = found(s for s in subject.steps() if s[2].min_time)  # type: ignore[misc]
    step.min_time = None
    return [subject.span(number, step.id)]


def initial_moved(subject: EditedProject) -> list[Span]:
    for number, chart in enumerate(subject.charts):
        others = [s for s in chart.steps if not s.initial and s.macro is None]
        if chart.initial_steps and others:
            first = chart.initial_steps[0]
            first.initial, others[0].initial = False, True
            return [subject.span(number, first.id), subject.span(number, others[0].id)]
    pytest.skip("no chart with two steps")


def variable_renamed(subject: EditedProject) -> list[Span]:
    # a declaration text that no longer says what is declared is left out: see test_dialect_translation
    pous = [p for p in subject.project.pous if p.interface is not None and p.interface.declaration is None]
    pous = [p for p in pous if p.interface is not None and p.interface.variables()]
    pou = found(iter(pous))
    variable = pou.interface.variables()[0]  # type: ignore[attr-defined]
    old, variable.name = variable.name, NEW
    span = next(s for s in subject.root.inside("pou") if s.attributes["name"] == pou.name)  # type: ignore[attr-defined]
    element = next(v for v in span.inside("variable") if v.attributes.get("name") == old)
    return [Span("variable", {}, None, element.start, element.start)]


def st_line(subject: EditedProject) -> list[Span]:
    bodies = [b for _, _, b in subject.project.bodies() if isinstance(b, StBody) and b.text.count("\n") > 1]
    body = found(b for b in bodies if not b.markup)
    assert isinstance(body, StBody)
    lines = body.text.split("\n")
    lines[1] = "  (* neu: a < b *) nZähler := nZähler + 1;"
    old, body.text = body.text, "\n".join(lines)
    element = next(s for s in subject.root.inside("ST") if "".join(c.text for c in s.children) == old)
    inner = element.children[0]
    return [Span("line", {}, None, inner.start + 1, inner.start + 1)]


def association_added(subject: EditedProject) -> list[Span]:
    number, chart, step, association = found(subject.associations())  # type: ignore[misc]
    new = ActionAssociation(id=chart.new_id(), qualifier=Qualifier.D, target="bNeu", duration="T#3s")
    step.actions.append(new)
    return [subject.block(number, chart, association)[0]]


def association_removed(subject: EditedProject) -> list[Span]:
    number, chart, step, association = found(a for a in subject.associations() if len(a[2].actions) > 1)  # type: ignore[misc]
    block, line = subject.block(number, chart, association)
    step.actions.remove(association)
    # lines of neighbours may be alike: the diff may show the end of one and the start of the other as removed
    subject.fewer = line.end - line.start + 1
    return [block]


def all_associations_removed(subject: EditedProject) -> list[Span]:
    number, chart, step, _ = found(subject.associations())  # type: ignore[misc]
    blocks = [subject.block(number, chart, a)[0] for a in step.actions]
    step.actions.clear()
    return [*blocks, subject.span(number, step.id)]


def step_added(subject: EditedProject) -> list[Span]:
    for number, chart in enumerate(subject.charts):
        single = [t for t in chart.transitions if len(t.sources) == len(t.targets) == 1]
        if single and len({s for t in chart.transitions for s in t.sources}) == len(chart.transitions):
            step = chart.add_step(NEW)
            transition = single[-1]
            before = chart.step(transition.targets[0])
            transition.targets = [step.id]
            chart.add_transition(step, before, "TRUE")
            return [subject.spans[number]]
    pytest.skip("no simple chart")


EDITS: tuple[Edit, ...] = (
    condition_text,
    inline_condition,
    qualifier,
    duration,
    new_comment,
    other_comment,
    max_time,
    min_time_removed,
    initial_moved,
    variable_renamed,
    st_line,
    association_removed,
)
STRUCTURAL: tuple[Edit, ...] = (association_added, all_associations_removed, step_added)

ONE_LINE = {"variable_renamed", "st_line"}


def edited(path: Path, edit: Edit) -> tuple[EditedProject, list[Span], bytes, list[Hunk]]:
    subject = EditedProject(path.read_bytes())
    spans = edit(subject)
    # CODESYS has nested branches only, which another initial step may end
    after = sfc.dumps(subject.project, partial=edit is initial_moved)
    return subject, spans, after, difference(subject.data, after)


@pytest.mark.slow
@pytest.mark.parametrize("edit", EDITS, ids=lambda e: e.__name__)
@pytest.mark.parametrize("path", FIXTURE_PARAMS)
def test_an_edit_stays_in_its_element(path: Path, edit: Edit) -> None:
    subject, spans, after, hunks = edited(path, edit)
    assert hunks
    assert_within(hunks, *spans)
    assert_same(subject.project, sfc.loads(after))
    if subject.fewer is not None:
        assert sum(len(h.old) - len(h.new) for h in hunks) == subject.fewer
    if edit.__name__ in ONE_LINE:
        assert [(len(h.old), len(h.new)) for h in hunks] == [(1, 1)]


SMALL_PARAMS = [p for p in CORPUS_PARAMS if p.values[0] is None or p.values[0].stat().st_size <= SMALL]  # type: ignore[union-attr]


@pytest.mark.slow
@pytest.mark.parametrize("edit", EDITS, ids=lambda e: e.__name__)
@pytest.mark.parametrize("path", SMALL_PARAMS)
def test_an_edit_of_a_real_file_stays_in_its_element(path: Path, edit: Edit) -> None:
    """Small files are enough for this."""
    test_an_edit_stays_in_its_element(path, edit)


@pytest.mark.slow
@pytest.mark.parametrize("edit", STRUCTURAL, ids=lambda e: e.__name__)
@pytest.mark.parametrize("path", FIXTURE_PARAMS)
def test_an_edit_of_the_structure_stays_in_its_chart(path: Path, edit: Edit) -> None:
    subject, spans, after, hunks = edited(path, edit)
    assert hunks
    chart = spans[0] if spans[0].tag == "SFC" else spans[0].up("SFC")
    assert_within(hunks, chart)
    again = sfc.loads(after)
    for mine, theirs in zip(subject.project.charts(), again.charts(), strict=True):
        assert net(mine.chart) == net(theirs.chart)
        assert fits(theirs.chart)
    # what does not concern the edit is where it was: no element is moved or written again
    moved = re.compile(r"localId|refLocalId|/?connection|addData|[pP]osition ")
    removed = [line for hunk in hunks for line in hunk.old if not moved.search(line)]
    inserted = [line for hunk in hunks for line in hunk.new if not moved.search(line)]
    if edit is not all_associations_removed:
        assert len(removed) <= 6, removed
        assert len(inserted) < 50, inserted
    assert not [line for line in inserted if re.search(r"<\w+:(step|transition|action)", line)]


def net(chart: SfcNetwork) -> object:
    """The behaviour of a chart, by names."""
    names = {step.id: step.name for step in chart.steps}
    return (
        sorted((s.name, s.initial, [(a.qualifier, a.target, a.duration) for a in s.actions]) for s in chart.steps),
        sorted(
            (sorted(names[i] for i in t.sources), sorted(names[i] for i in t.targets), str(t.condition))
            for t in chart.transitions
        ),
    )
