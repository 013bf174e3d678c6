"""The items of a conversion report on its page: losses by their reasons, all others by the kind of thing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import PurePath

from plcopen_sfc.grouping import grouped
from plcopen_sfc.pages.html_text import Html, element, joined, link, with_code
from plcopen_sfc.pages.page_index import PageIndex
from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.report import LOSSES, ConversionReport, Item, Outcome, grouped_by_reason

MEANINGS = {
    Outcome.KEPT: "written as it is, in the terms of the target",
    Outcome.TRANSLATED: "written in other terms that do the same",
    Outcome.APPROXIMATED: "executed otherwise in the target: the reason names the difference",
    Outcome.NOT_EXECUTED: "executed in the source, and not in the target",
    Outcome.EXTENSION_DATA: "kept in the file for the way back: no machine executes it",
    Outcome.DROPPED: "not in the written file",
}
"""What an outcome means for the machine, in words of a page."""
_MOST_ITEMS = 500
_FEWEST_GROUPED = 3
"""Number of items with one reason that are behind one line."""


class ItemLists:
    """The items of a report as lists, with links to the charts of the source, and anchors for links to items."""

    def __init__(self, report: ConversionReport, index: PageIndex, words: Words) -> None:
        self._report, self._index, self._words = report, index, words
        self._anchors: dict[int, str] = {}
        for outcome in Outcome:
            for item in report.with_outcome(outcome)[:_MOST_ITEMS]:
                self._anchors[id(item)] = f"item-{len(self._anchors)}"

    def links(self, items: Iterable[Item], most: int) -> Html:
        """Return the places of items, each as a link to the first item of that place."""
        first: dict[str, Item] = {}
        for item in items:
            first.setdefault(self._words.place(item.path), item)
        shown = [link(self._anchors.get(id(item), ""), place) for place, item in list(first.items())[:most]]
        parts = [part for each in shown for part in ("; ", each)][1:]
        return joined(*parts, f"; +{len(first) - most}" if len(first) > most else "")

    def section(self, outcome: Outcome) -> Html:
        """Return the section of the items with an outcome."""
        items, words = self._report.with_outcome(outcome), self._words
        heading = element(
            "h2",
            f"{words.heading(outcome.value)} ({len(items)}) ",
            element("small", words(MEANINGS[outcome])),
        )
        listed = self._by_reason if outcome in LOSSES else self._by_kind
        shown = list(listed(items[:_MOST_ITEMS]))
        if len(items) > _MOST_ITEMS:
            shown.append(element("p", words("and {} more", len(items) - _MOST_ITEMS)))
        return element("section", heading, *shown, id=outcome.name.lower())

    def _by_reason(self, items: list[Item]) -> Iterator[Html]:
        """Yield items of one reason together, each alone where they are few."""
        alone: list[Html] = []
        for group in grouped_by_reason(items, self._words.message):
            lines = [self._item(item) for item in group.items]
            if len(lines) < _FEWEST_GROUPED:
                alone += lines
                continue
            if alone:
                yield element("ul", *alone, class_="items")
                alone = []
            caption = f"{len(lines)} \u00d7 {self._words.message(group.items[0].what)}: {group.reason}"
            yield _folded(with_code(caption), lines)
        if alone:
            yield element("ul", *alone, class_="items")

    def _by_kind(self, items: list[Item]) -> Iterator[Html]:
        """Yield items of one kind together; those of one reason are only their places."""
        for kind, those in grouped((item.what, item) for item in items).items():
            name = _capital(self._words.message(kind))
            reasons = grouped((item.why, item) for item in those)
            others: list[Item] = []
            for reason, alike in reasons.items():
                if reason and (len(alike) >= _FEWEST_GROUPED or len(reasons) == 1):
                    caption = with_code(f"{name} ({len(alike)}): {self._words.message(reason)}")
                    named = [element("span", self._place(each), id=self._anchors.get(id(each), "")) for each in alike]
                    places = [part for each in named for part in ("; ", each)][1:]
                    yield element("details", element("summary", caption), element("p", *places, class_="places"))
                else:
                    others += alike
            if others:
                yield _folded(joined(f"{name} ({len(others)})"), [self._item(item) for item in others])

    def _item(self, item: Item) -> Html:
        words = self._words
        kind = "" if item.place == item.path else words.message(item.what)
        parts: list[str] = [self._place(item, bold=True)]
        if kind:
            parts.append(f" \u2013 {kind}" if item.path else _capital(kind))
        if item.why:
            parts += [": ", with_code(words.message(item.why))]
        return element("li", *parts, id=self._anchors.get(id(item), ""))

    def _place(self, item: Item, *, bold: bool = False) -> Html:
        """Return the place of an item with its line, as a link to it where it is drawn."""
        words = self._words
        anchor = self._index.anchor_at(item.path)
        is_drawn = any(anchor.startswith(prefix) for prefix in self._index.parts)
        place = words.place(item.path)
        named = link(anchor if is_drawn else "", element("b", place) if bold else place) if place else Html("")
        if not item.line:
            return named
        file = f"{PurePath(item.file).name}, " if item.file else ""
        return joined(named, " ", element("small", f"({file}{words('line {}', item.line)})"))


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _folded(caption: Html, lines: list[Html]) -> Html:
    return element("details", element("summary", caption), element("ul", *lines, class_="items"))
