"""Items of a report as a person reads them: what is not executed first, items with one reason in one line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from plcopen_sfc.cli.screen import Screen, Table
from plcopen_sfc.conversion.executed_parts import OPERATING_INPUT
from plcopen_sfc.grouping import grouped
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import ConversionReport, Item, ItemGroup, Outcome, grouped_by_reason

_LINES = 20
"""Lines for items without --verbose."""
_NAMES = 6
"""Names in a line for several items."""
_STYLES = {
    Outcome.NOT_EXECUTED: "bold red",
    Outcome.APPROXIMATED: "yellow",
    Outcome.DROPPED: "red",
    Outcome.EXTENSION_DATA: "cyan",
    Outcome.TRANSLATED: "green",
}
"""Every outcome but `kept`, the worst first."""


def show_not_executed(screen: Screen, items: Sequence[Item]) -> None:
    """Print all that the target will not execute: by chart or object, then by step or transition."""
    if not items:
        return
    screen.line((f"NOT EXECUTED in the target: {len(items)}", _STYLES[Outcome.NOT_EXECUTED]))
    operated = [item for item in items if item.what == OPERATING_INPUT]
    for around, those in grouped((ObjectPath.of(item.path).around, item) for item in operated).items():
        names = [ObjectPath.of(item.path).last for item in those]
        screen.line(f"  {around}{_position(those[0])}")
        screen.line(f"    operating inputs without effect: {', '.join(names)}")
        for name, item in zip(names, those, strict=True):
            if reason := item.why.partition(": ")[2]:  # of SFC flags: what in this chart is in the way
                screen.line(f"      {name}: {reason}")
        they = "they are" if names[1:] else "it is"
        screen.line(f"    If {they} never operated, convert again with --at-rest {','.join(names)}.")
    others = [item for item in items if item not in operated]
    for group in [] if screen.verbose else grouped_by_reason(item for item in others if not _inside(item)):
        if group.items[1:]:  # such as 24 addresses of one list
            screen.line(f"  {group.items[0].what}: {group.reason}")
            for place in _places(group):
                screen.line(f"    {place}")
            others = [item for item in others if item not in group.items]
    for owner, those in grouped((_owner(item), item) for item in others).items():
        screen.line(f"  {owner or 'the project'}")
        for place, these in grouped((_inside(item), item) for item in those).items():
            indent = "    "
            if place:
                screen.line(f"    {place}{_position(these[0])}")
                indent = "      "
            for item in these:
                screen.line(f"{indent}{item.what}: {item.why}{'' if place else _position(item)}")
    screen.line()


def show_items(screen: Screen, items: Iterable[Item]) -> None:
    """Print items, the worst outcome first. Without --verbose those with one reason are in one line, in a few lines."""
    ranked = [*_STYLES, Outcome.KEPT]
    ordered = sorted(items, key=lambda item: ranked.index(item.outcome))
    parts = [[item] for item in ordered] if screen.verbose else [ordered]
    groups = [group for part in parts for group in grouped_by_reason(part)]
    shown = groups if screen.verbose else groups[:_LINES]
    for group in shown:
        item = group.items[0]
        listed = _listed(_places(group))
        kind = "" if listed.startswith(f"{item.what} ") else f"{item.what} "  # POU Main, and not POU POU Main
        place = f"{kind}{listed}" if group.items[1:] else item.place + _position(item)
        screen.line(
            (item.outcome.value, _STYLES.get(item.outcome, "")),
            f": {place}{f': {group.reason if group.items[1:] else item.why}' if item.why else ''}",
        )
    more = sum(len(group.items) for group in groups[len(shown) :])
    if more:
        screen.line(f".. and {more} more: --verbose shows all, --report writes all")


def show_counts(screen: Screen, report: ConversionReport) -> None:
    """Print how many items there are of each outcome; with --verbose a table of the kinds of things."""
    counts = report.counts()
    outcomes = [outcome for outcome in Outcome if any(outcome is known for _, known in counts)]
    if not outcomes:
        return
    if screen.verbose:
        table = Table(["what", *(outcome.value for outcome in outcomes)])
        for what in sorted({what for what, _ in counts}):
            table.rows.append([what, *(counts.get((what, outcome), 0) for outcome in outcomes)])
        screen.table(table)
    else:
        totals = [
            (outcome, sum(count for (_, known), count in counts.items() if known is outcome)) for outcome in outcomes
        ]
        told = ", ".join(f"{total} {outcome.value}" for outcome, total in totals)
        screen.line(f"items: {told} (--verbose lists them)")
    screen.line()


def _places(group: ItemGroup) -> list[str]:
    """The places of items with one reason, a text for each POU or the like: ``POU Mixer: action Fill (lines 3, 7)``."""
    found: dict[str, dict[str, tuple[list[str], list[int]]]] = {}
    for item, names, line in zip(group.items, group.differing, group.lines, strict=True):
        path = ObjectPath.of(item.path)
        details = found.setdefault(path.owner, {}).setdefault(path.inside(path.owner), ([], []))
        details[0].extend(names)
        details[1].extend([line] if line is not None else [])
    texts: list[str] = []
    for owner, inner in found.items():
        own = _details(*inner.pop("", ([], [])))
        places = ", ".join(place + _details(*details) for place, details in inner.items())
        texts.append(f"{owner}{own}{': ' if places else ''}{places}")
    return texts


def _details(names: list[str], lines: list[int]) -> str:
    """Return names in the items of one place, and the lines of its text that they are about."""
    numbers = [*dict.fromkeys(map(str, lines))]
    told = [*dict.fromkeys(names)]
    told += [f"line{'s' if numbers[1:] else ''} {', '.join(numbers)}"] if numbers else []
    return f" ({', '.join(told)})" if told else ""


def _listed(places: Sequence[str]) -> str:
    named = ", ".join(places[:_NAMES])
    return named if len(places) <= _NAMES else f"{named} and {len(places) - _NAMES} more"


def _owner(item: Item) -> str:
    """Return the chart or the object that an item belongs to: its path up to a step or a transition."""
    found = (each for each in ObjectPath.of(item.path).outwards() if each.last.startswith(("step ", "transition ")))
    inside = [*found]
    return inside[-1].around if inside else item.path


def _inside(item: Item) -> str:
    """Return the step or transition that an item belongs to; empty: it concerns the whole object."""
    return ObjectPath.of(item.path).inside(_owner(item)).owner


def _position(item: Item) -> str:
    if not item.line:
        return ""
    return f" ({item.file}:{item.line})" if item.file else f" (line {item.line})"
