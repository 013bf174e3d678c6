"""Two projects on one page: the charts of both beside each other, with what changed, or what a conversion did."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import date

from plcopen_sfc.comparison import Change, ChangeKind, ProjectDiff, Proof
from plcopen_sfc.drawing.pictures import chart_figure
from plcopen_sfc.errors import check_argument
from plcopen_sfc.model.project import Project
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.pages.conversion_overview import provenance, tasks, tool_of, verdicts
from plcopen_sfc.pages.html_text import Html, document, element, link, picture_figure
from plcopen_sfc.pages.page_index import PageIndex
from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.pages.project_page import file_name_of, title_of
from plcopen_sfc.report import LOSSES, ConversionReport, Item, Outcome, grouped

_SIGNS = {"+": "added", "-": "removed", "@": "moved"}
_MARKS = {
    Outcome.NOT_EXECUTED: "found-error",
    Outcome.APPROXIMATED: "found-warning",
    Outcome.DROPPED: "found-warning",
    Outcome.TRANSLATED: "found-info",
}
"""Styles of steps and transitions that an item of a report is about; the worst first."""
_MOST_ITEMS = 500
_FEWEST_GROUPED = 3
"""Number of items with one reason that are behind one line."""


def diff_page(a: Project, b: Project, changes: ProjectDiff, *, lang: str = "en") -> str:
    """Return the differences of two projects, as `diff` gives them, as the text of one HTML file.

    The changes are listed; charts in which something changed are beside each other, with what was added, removed,
    changed or renamed in colours. `lang` is ``en`` or ``de``; the rest is as in `page`.
    """
    for project in (a, b):
        check_argument(project, Project, "diff_page needs two projects", "Load the files first.")
    words = Words(lang)
    first = PageIndex(a, "a-", called=_called(changes), references=False)
    captions = [
        f"{name}: {file_name_of(project) or title_of(project)}" for name, project in zip("AB", (a, b), strict=True)
    ]
    sides = _Side(first, captions[0]), _Side(_index(b, "b-"), captions[1])
    for change in changes.changes:
        for side, absent in zip(sides, (ChangeKind.ADDED, ChangeKind.REMOVED), strict=True):
            if change.kind is not absent:
                side.mark_change(change)
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
    return document(_title(a, b), words, _tree(pairs, words, words("Differences")), overview, *charts)


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
    words = Words(lang)
    left = _Side(_index(source, "a-"), report.source_format)
    for outcome, mark in _MARKS.items():
        for item in report.with_outcome(outcome):
            left.marks.setdefault(left.index.anchor_at(item.path), {mark: None})
    right = _Side(_index(target if target is not None else Project(), "b-"), report.target_format)
    pairs = list(_pairs(left, right))
    tools = " \u2192 ".join(words.message(tool_of(name)) for name in (report.source_format, report.target_format))
    title = f"{title_of(source)}: {tools}"
    rows = [
        element(
            "tr", element("th", words.heading(outcome.value)), element("td", str(len(report.with_outcome(outcome))))
        )
        for outcome in Outcome
        if report.with_outcome(outcome)
    ]
    overview = element(
        "section",
        element("h1", title),
        element("p", words("nothing was written")) if target is None else Html(""),
        verdicts(source, report, words),
        tasks(report, words, written=target is not None),
        element("h2", words("Report")),
        element("table", element("tbody", *rows)),
        provenance(source, report, target, words, made_on),
        id="project",
    )
    charts = list(_charts(pairs, words))
    outcomes = [outcome for outcome in (*_MARKS, Outcome.EXTENSION_DATA) if report.with_outcome(outcome)]
    lists = {outcome: _items(report.with_outcome(outcome), outcome, left, words) for outcome in outcomes}
    tree = _tree(
        pairs, words, words("Report"), [(outcome.name.lower(), words.heading(outcome.value)) for outcome in outcomes]
    )
    first = [lists.pop(outcome) for outcome in outcomes if outcome in (*LOSSES, Outcome.DROPPED)]
    return document(title, words, tree, overview, *first, *charts, *lists.values())


@dataclass(slots=True)
class _Side:
    """One of the projects, what is written over its charts, and further classes of their elements, by their anchors."""

    index: PageIndex
    caption: str
    marks: dict[str, dict[str, None]] = field(default_factory=dict)

    def mark_change(self, change: Change) -> None:
        """Mark what a change is about; what has a change inside of it is changed."""
        anchor = self.index.anchor_at(change.path)
        inside = anchor == self.index.anchor_at(ObjectPath.of(change.path).around)
        kind = ChangeKind.CHANGED if inside and change.kind is not ChangeKind.LAYOUT else change.kind
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


def _index(project: Project, prefix: str) -> PageIndex:
    return PageIndex(project, prefix, references=False)


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
    """Yield the charts of both sides that have the same path, then those that only one has."""
    others = {parts[0].path: prefix for prefix, parts in right.index.parts.items()}
    alone: list[_Pair] = []
    for prefix, parts in left.index.parts.items():
        other = others.pop(left.index.as_called(parts[0].path), "")
        pair = (left, prefix), (right, other)
        if other:
            yield pair
        else:
            alone.append(pair)
    yield from alone
    yield from (((left, ""), (right, prefix)) for prefix in others.values())


def _charts(pairs: Iterable[_Pair], words: Words) -> Iterator[Html]:
    for number, pair in enumerate(pairs):
        figures = [_figure(side, prefix, words) for side, prefix in pair]
        path = words.place(_path(pair))
        parts = element("h2", path), element("div", *figures, class_="pair")
        yield element("section", *parts, id=f"chart-{number}", data_name=path)


def _path(pair: _Pair) -> str:
    return next(side.index.parts[prefix][0].path for side, prefix in reversed(pair) if prefix)


def _figure(side: _Side, prefix: str, words: Words) -> Html:
    if not prefix:
        title = element("figcaption", side.caption)
        return element("figure", title, element("p", words("no such chart"), class_="comment"))
    marks: Mapping[str, str] = {anchor: " ".join(sorted(kinds)) for anchor, kinds in side.marks.items()}
    picture = chart_figure(side.index.parts[prefix][0].chart, prefix, marks, told=words)
    return picture_figure(picture, words, side.caption)


def _tree(pairs: Iterable[_Pair], words: Words, first: str, links: Iterable[tuple[str, str]] = ()) -> Html:
    charts = [element("li", link(f"chart-{number}", words.place(_path(pair)))) for number, pair in enumerate(pairs)]
    lists = [element("li", link(anchor, name)) for anchor, name in links]
    return element("ul", element("li", link("project", first)), *lists, *charts)


def _title(a: Project, b: Project) -> str:
    names = [title_of(a), title_of(b)]
    if names[0] == names[1]:
        names = [file_name_of(project) or name for project, name in zip((a, b), names, strict=True)]
    return " \u2192 ".join(names)


def _change(change: Change, sides: tuple[_Side, _Side], shown: tuple[str, ...], words: Words) -> Iterator[str]:
    """Yield the words of a change, with links to what it is about in the charts of the prefixes `shown`."""
    news = change.told(lambda text: words.place(words.message(text)))
    yield from (element("b", words.place(change.place)), ": ", news)
    for side, name in zip(sides, "AB", strict=True):
        anchor = side.index.anchor_at(change.path)
        if anchor in side.marks and anchor.startswith(shown):
            yield from (" ", link(anchor, name))
    if change.lines:
        lines = [element("span", line, "\n", class_=f"is-{_SIGNS.get(line[:1], 'same')}") for line in change.lines]
        yield element("pre", element("code", *lines))


def _items(items: list[Item], outcome: Outcome, side: _Side, words: Words) -> Html:
    shown: list[Html] = []
    for group in grouped(items[:_MOST_ITEMS], words.message):
        lines = [element("li", *_item(item, side, words)) for item in group.items]
        if len(lines) < _FEWEST_GROUPED:
            shown.append(element("ul", *lines))
            continue
        caption = f"{len(lines)} \u00d7 {words.message(group.items[0].what)}: {group.reason}"
        shown.append(element("details", element("summary", caption), element("ul", *lines)))
    if len(items) > _MOST_ITEMS:
        shown.append(element("p", words("and {} more", len(items) - _MOST_ITEMS)))
    heading = element("h2", f"{words.heading(outcome.value)} ({len(items)})")
    return element("section", heading, *shown, id=outcome.name.lower())


def _item(item: Item, side: _Side, words: Words) -> Iterator[str]:
    anchor = side.index.anchor_at(item.path)
    is_drawn = any(anchor.startswith(prefix) for prefix in side.index.parts)
    yield link(anchor if is_drawn else "", element("b", _place(item, words)))
    if item.why:
        yield f": {words.message(item.why)}"
    if item.line:
        yield from (" ", element("small", words("line {}", item.line)))


def _place(item: Item, words: Words) -> str:
    path = words.place(item.path)
    return path if item.place == item.path else f"{words.message(item.what)} {path}".strip()


def _proof(proof: Proof, words: Words) -> str:
    path, told = proof.path, str(proof).removeprefix(f"{proof.path}: ")
    return f"{words.place(path)}: " + "\n".join(map(words.verdict, told.splitlines()))
