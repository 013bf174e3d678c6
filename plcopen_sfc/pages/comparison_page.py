"""Two projects on one page: the charts of both beside each other, with what changed, or what a conversion did."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import date

from plcopen_sfc.comparison import Change, ChangeKind, ProjectDiff, Proof
from plcopen_sfc.drawing.pictures import PairedChart, chart_figure, paired_figures
from plcopen_sfc.errors import check_argument
from plcopen_sfc.languages.words import identifier
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Step
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.pages.conversion_items import ItemLists
from plcopen_sfc.pages.conversion_overview import counts, provenance, tasks, tool_of, verdicts
from plcopen_sfc.pages.html_text import Html, document, element, joined, link, picture_figure
from plcopen_sfc.pages.page_index import PageIndex
from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.pages.project_page import file_name_of, title_of
from plcopen_sfc.pages.step_cells import Bodies, StepCells, steps_side_by_side
from plcopen_sfc.report import LOSSES, ConversionReport, Outcome

_SIGNS = {"+": "added", "-": "removed", "@": "moved"}
_MARKS = {
    Outcome.NOT_EXECUTED: "found-error",
    Outcome.APPROXIMATED: "found-warning",
    Outcome.DROPPED: "found-warning",
    Outcome.TRANSLATED: "found-info",
}
"""Styles of steps and transitions that an item of a report is about; the worst first."""


def diff_page(a: Project, b: Project, changes: ProjectDiff, *, lang: str = "en") -> str:
    """Return the differences of two projects, as `diff` gives them, as the text of one HTML file.

    The changes are listed; charts in which something changed are beside each other, with what was added, removed,
    changed or renamed in colours. `lang` is ``en`` or ``de``; the rest is as in `page`.
    """
    for project in (a, b):
        check_argument(project, Project, "diff_page needs two projects", "Load the files first.")
    check_argument(changes, ProjectDiff, "diff_page needs the changes that diff gave", "diff(a, b)")
    words = Words(lang)
    first = PageIndex(a, "a-", called=_called(changes), references=False, told=words)
    captions = [
        f"{name}: {file_name_of(project) or title_of(project)}" for name, project in zip("AB", (a, b), strict=True)
    ]
    sides = _Side(first, captions[0]), _Side(_index(b, "b-", words), captions[1])
    for change in changes.changes:
        paths = _paths(change)
        there = 1 if change.kind is ChangeKind.ADDED else 0
        inside = sides[there].shows_only_around(paths[there])
        for side, path, absent in zip(sides, paths, (ChangeKind.ADDED, ChangeKind.REMOVED), strict=True):
            if inside or change.kind is not absent:  # a step that gains an action has changed on both sides
                side.mark_change(change.kind, path, inside=inside)
    pairs = [pair for pair in _pairs(*sides) if any(side.has_marks(prefix) for side, prefix in pair)]
    charts = list(_charts(pairs, words))
    shown = tuple(prefix for pair in pairs for _, prefix in pair if prefix)
    items = [
        element("li", *_change(change, sides, shown, words), class_=f"change is-{change.kind}")
        for change in changes.changes
    ]
    listed = element("ul", *items) if items else element("p", words("no differences"))
    proofs = [element("li", _proof(proof, words), class_="comment") for proof in changes.proofs]
    overview = element(
        "section",
        element("h1", _title(a, b)),
        listed,
        element("ul", *proofs) if proofs else Html(""),
        id="project",
    )
    return document(_title(a, b), words, _tree(pairs, words, words("Differences")), overview, *charts, wide=True)


def conversion_page(
    source: Project,
    report: ConversionReport,
    target: Project | None = None,
    *,
    lang: str = "en",
    made_on: date | None = None,
) -> str:
    """Return the overview of a conversion as the text of one HTML file.

    `report` is what `save` or `convert` returned, or that of a `LossError`. First are the verdict on each chart and
    what a person has to do in the target tool; then the items, those of one reason together, not executed ones first.
    Each chart of the source is beside that of the `target`, the written file as it was read again, with the steps and
    transitions in colours that items are about. `made_on` is a day that the page names as that of the conversion.
    `lang` is ``en`` or ``de``; the rest is as in `page`.
    """
    check_argument(source, Project, "conversion_page needs a project", "Load the file first.")
    check_argument(report, ConversionReport, "conversion_page needs the report that save or convert returned")
    check_argument(target, (Project, type(None)), "the target of a conversion is a project")
    check_argument(made_on, (date, type(None)), "made_on is a day")
    words = Words(lang)
    left = _Side(_index(source, "a-", words), _caption("Source", source, report.source_format, words))
    for outcome, mark in _MARKS.items():
        for item in report.with_outcome(outcome):
            left.marks.setdefault(left.index.anchor_at(item.path), {mark: None})
    is_written = target is not None
    right = _Side(_index(target if target is not None else Project(), "b-", words), "")
    if target is not None:
        right.caption = _caption("Target", None if report.written == ["-"] else target, report.target_format, words)
    pairs = list(_pairs(left, right))
    places = ((side.index.parts[prefix][0].path, n) for n, pair in enumerate(pairs) for side, prefix in pair if prefix)
    pictures = {path: f"chart-{number}" for path, number in places}
    tools = " \u2192 ".join(words(tool_of(name)) for name in (report.source_format, report.target_format))
    title = f"{title_of(source)}: {tools}"
    lists = ItemLists(report, left.index, words)
    outcomes = [outcome for outcome in (*_MARKS, Outcome.EXTENSION_DATA) if report.with_outcome(outcome)]
    overview = element(
        "section",
        element("h1", title),
        element("p", element("b", words("nothing was written"))) if target is None else Html(""),
        provenance(source, report, target, words, made_on),
        verdicts(source, report, words, pictures),
        tasks(report, lists, words, pictures, written=is_written),
        counts(report, words),
        id="project",
    )
    charts = list(_charts(pairs, words, converted=True))
    names = [(outcome.name.lower(), words.heading(outcome.value)) for outcome in outcomes]
    tree = _tree(pairs, words, words("Report"), names)
    sections = {outcome: lists.section(outcome) for outcome in outcomes}
    first = [sections.pop(outcome) for outcome in outcomes if outcome in (*LOSSES, Outcome.DROPPED)]
    return document(title, words, tree, overview, *first, *charts, *sections.values(), wide=True)


def _caption(side: str, project: Project | None, format_name: str, words: Words) -> str:
    told = f"{words(side)}: {words(tool_of(format_name))}"
    name = file_name_of(project) if project is not None else ""
    return f"{told}, {name}" if name else told


@dataclass(slots=True)
class _Side:
    """One of the projects, what is written over its charts, and further classes of their elements, by their anchors."""

    index: PageIndex
    caption: str
    marks: dict[str, dict[str, None]] = field(default_factory=dict)

    def shows_only_around(self, path: str) -> bool:
        """True if the object at a path has no place of its own here, but one around it has: an action of a step."""
        return self.index.anchor_at(path) == self.index.anchor_at(ObjectPath.of(path).around)

    def mark_change(self, kind: ChangeKind, path: str, *, inside: bool) -> None:
        """Mark what a change at a path is about; what has a change `inside` of it is changed."""
        anchor = self.index.anchor_at(path)
        kind = ChangeKind.CHANGED if inside and kind is not ChangeKind.LAYOUT else kind
        self.marks.setdefault(anchor, {})[f"diff-{kind}"] = None

    def has_marks(self, prefix: str) -> bool:
        """True if something in the chart of this prefix is marked, or the POU or the action that it is of."""
        if not prefix:
            return False
        whole = [anchor for anchor in self.marks if anchor and prefix.startswith(f"{anchor}-")]
        of_whole = any(mark in ("diff-added", "diff-removed") for anchor in whole for mark in self.marks[anchor])
        return of_whole or any(anchor.startswith(prefix) for anchor in self.marks)


_Pair = tuple[tuple[_Side, str], tuple[_Side, str]]
"""The charts that are beside each other, each with its side and prefix; an empty prefix: there is none."""


def _index(project: Project, prefix: str, words: Words) -> PageIndex:
    return PageIndex(project, prefix, references=False, told=words)


def _called(changes: ProjectDiff) -> dict[str, str]:
    """Return paths of the first project as the second one calls them, for what was renamed."""
    before: dict[str, str] = {}
    renamed = [change for change in changes.changes if change.kind is ChangeKind.RENAMED and change.before]
    for change in sorted(renamed, key=lambda each: len(ObjectPath.of(each.path).parts)):
        path = ObjectPath.of(change.path)
        around = next(
            (before[each] + path[len(each) :] for each in path.around.outwards() if each in before), str(path)
        )
        first, _, last = around.rpartition(" / ")
        old = last.removesuffix(change.after or "") + (change.before or "")
        before[path] = f"{first} / {old}" if first else old
    return {old: new for new, old in before.items()}


def _pairs(left: _Side, right: _Side) -> Iterator[_Pair]:
    """Yield the charts of both sides that have the same path, then those that only one has.

    Of names that a tool does not take, targets have identifiers: ``_1_Press`` for ``1 Press``.
    """
    others = {parts[0].path: prefix for prefix, parts in right.index.parts.items()}
    paths = {prefix: left.index.as_called(parts[0].path) for prefix, parts in left.index.parts.items()}
    same = {prefix: others.pop(path) for prefix, path in paths.items() if path in others}
    alike = {identifier(path).casefold(): path for path in others}
    for prefix, path in paths.items():
        if prefix not in same and (other := alike.pop(identifier(path).casefold(), None)) is not None:
            same[prefix] = others.pop(other)
    yield from (((left, prefix), (right, same[prefix])) for prefix in paths if prefix in same)
    yield from (((left, prefix), (right, "")) for prefix in paths if prefix not in same)
    yield from (((left, ""), (right, prefix)) for prefix in others.values())


def _charts(pairs: Iterable[_Pair], words: Words, *, converted: bool = False) -> Iterator[Html]:
    """Yield the sections of the charts.

    `converted`: both get a new layout, so that their steps can be at one height, and a table has them side by side.
    """
    bodies = {id(side): Bodies(side.index, words) for pair in pairs for side, _ in pair}
    for number, pair in enumerate(pairs):
        path = words.place(_path(pair))
        parts = [element("h2", path), element("div", *_figures(pair, words, converted=converted), class_="pair")]
        if converted and all(prefix for _, prefix in pair):
            one, other = (
                [
                    StepCells(
                        part.chart,
                        side.index,
                        bodies[id(side)],
                        words,
                        pou=_pou_of(side, prefix),
                        heading=part.drawn.heading,
                    )
                    for part in side.index.parts[prefix]
                ]
                for side, prefix in pair
            )
            captions = [side.caption for side, _ in pair]
            parts.insert(1, _legend(pair[0], words))
            parts += [
                element("h3", words("Step by step")),
                steps_side_by_side(one, other, _same_steps(pair), captions),
            ]
        yield element("section", *parts, id=f"chart-{number}", data_name=path)


def _legend(half: tuple[_Side, str], words: Words) -> Html:
    """Return the meaning of the colours in the picture of the source."""
    side, prefix = half
    found = {mark for anchor, marks in side.marks.items() if anchor.startswith(prefix) for mark in marks}
    told = dict.fromkeys(mark for mark in _MARKS.values() if mark in found)
    kinds = [[words(outcome.value) for outcome, own in _MARKS.items() if own == mark] for mark in told]
    coloured = [
        element("span", element("b", ", ".join(kind)), class_=mark.replace("found", "is"))
        for mark, kind in zip(told, kinds, strict=True)
    ]
    if not coloured:
        return Html("")
    return element("p", words("Colours"), ": ", *(joined(each, " ") for each in coloured), class_="colours")


def _pou_of(side: _Side, prefix: str) -> Pou | None:
    placed = (each for those in side.index.bodies.values() for each in those)
    return next((each.found.pou for each in placed if f"{each.anchor}-" == prefix), None)


def _path(pair: _Pair) -> str:
    return next(side.index.parts[prefix][0].path for side, prefix in reversed(pair) if prefix)


def _figures(pair: _Pair, words: Words, *, converted: bool) -> Iterator[Html]:
    has_table = converted and all(prefix for _, prefix in pair)
    drawn = [_paired(side, prefix, side.index.names(prefix) if has_table else {}) for side, prefix in pair if prefix]
    if len(drawn) == len(pair):
        one, other = drawn
        same = _same_steps(pair)
        there = {id(step): step.id for step in other.chart.steps}
        pairs = [(step.id, id(same[id(step)])) for step in one.chart.steps if id(step) in same]
        pairs = [(number, there[step]) for number, step in pairs if step in there]
        pictures = list(paired_figures((one, other), pairs, words, fresh=converted))
    else:
        pictures = [chart_figure(each.chart, each.prefix, each.marks, told=words) for each in drawn]
    for side, prefix in pair:
        if prefix:
            yield picture_figure(pictures.pop(0), words, side.caption)
        elif side.caption:
            title = element("figcaption", side.caption)
            yield element("figure", title, element("p", words("no such chart"), class_="comment"), class_="missing")


def _paired(side: _Side, prefix: str, names: Mapping[str, Mapping[str, str]]) -> PairedChart:
    marks = {anchor: " ".join(sorted(kinds)) for anchor, kinds in side.marks.items()}
    return PairedChart(side.index.parts[prefix][0].chart, prefix, marks, names)


def _same_steps(pair: _Pair) -> dict[int, Step]:
    """Return the steps of the second picture for those of one name in the first, by their `id`.

    Tools write other letters in the place of blanks and the like, and `Step1` for the step 1 of a GRAFCET. One chart
    may have the steps of all partial charts.
    """
    (one, first), (other, second) = pair
    found: dict[tuple[str, str], Step] = {}
    for part in other.index.parts[second]:
        for step in part.chart.steps:
            for place in (str(part.drawn.place), ""):
                found.setdefault((place, _plain(step.name)), step)
    same: dict[int, Step] = {}
    for part in one.index.parts[first]:
        place = str(part.drawn.place)
        for step in part.chart.steps:
            path = one.index.as_called(f"{ObjectPath(part.path, *part.drawn.place.parts)} / step {step.name}")
            name = _plain(path.rpartition(" / step ")[2])
            keys = [(place, name), ("", name), *([("", f"step{name}")] if name.isdecimal() else [])]
            same |= {id(step): found[key] for key in keys[::-1] if key in found}
    return same


def _plain(name: str) -> str:
    return _NO_LETTERS.sub("_", name).casefold()


_NO_LETTERS = re.compile(r"\W")


def _tree(pairs: Iterable[_Pair], words: Words, first: str, links: Iterable[tuple[str, str]] = ()) -> Html:
    charts = [element("li", link(f"chart-{number}", words.place(_path(pair)))) for number, pair in enumerate(pairs)]
    lists = [element("li", link(anchor, name)) for anchor, name in links]
    return element("ul", element("li", link("project", first)), *lists, *charts)


def _title(a: Project, b: Project) -> str:
    names = [title_of(a), title_of(b)]
    if names[0] == names[1]:
        names = [file_name_of(project) or name for project, name in zip((a, b), names, strict=True)]
    return " \u2192 ".join(names)


def _paths(change: Change) -> tuple[str, str]:
    """Return the places of a change in the first and in the second project."""
    return change.path_before or change.path, change.path_after or change.path


def _change(change: Change, sides: tuple[_Side, _Side], shown: tuple[str, ...], words: Words) -> Iterator[str]:
    """Yield the words of a change, with links to what it is about in the charts of the prefixes `shown`."""
    news = change.told(lambda text: words.place(words.message(text)))
    yield from (element("b", words.place(change.place)), ": ", news)
    for side, path, name in zip(sides, _paths(change), "AB", strict=True):
        anchor = side.index.anchor_at(path)
        if anchor in side.marks and anchor.startswith(shown):
            yield from (" ", link(anchor, name))
    if change.lines:
        lines = [element("span", line, "\n", class_=f"is-{_SIGNS.get(line[:1], 'same')}") for line in change.lines]
        yield element("pre", element("code", *lines))


def _proof(proof: Proof, words: Words) -> str:
    path, told = proof.path, str(proof).removeprefix(f"{proof.path}: ")
    return f"{words.place(path)}: " + "\n".join(map(words.verdict, told.splitlines()))
