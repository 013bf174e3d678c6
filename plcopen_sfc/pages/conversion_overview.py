"""Overview of a conversion for the file of a machine: verdicts, what a person has to do, tools and digests of files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from datetime import date
from enum import StrEnum
from hashlib import sha256

from plcopen_sfc.conversion.chart_runs import SHIFTED
from plcopen_sfc.conversion.executed_parts import OPERATING_KINDS
from plcopen_sfc.documents.sources import FileSource, FolderSource
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.model.project import Project
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.pages.conversion_items import MEANINGS, ItemLists
from plcopen_sfc.pages.html_text import Html, element, joined, link, with_code
from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.pages.project_page import file_name_of
from plcopen_sfc.report import SEQUENCE, ConversionReport, Item, Outcome
from plcopen_sfc.version import __version__


class ChartVerdict(StrEnum):
    """Result of comparing a chart as the tools of both sides execute it."""

    SAME = "the same"
    DELAYED = "the same, a scan later"
    SHIFTED = "the same but for the scan of inputs"
    DIFFERENT = "differs"
    UNTESTED = "not all was reached"
    NOT_RUN = "not compared"


_CLASSES = {
    ChartVerdict.SAME: "is-added",
    ChartVerdict.DELAYED: "is-added",
    ChartVerdict.DIFFERENT: "is-removed",
}


def verdict_of(report: ConversionReport, path: str) -> ChartVerdict:
    """Return the verdict on the chart at a path, from the words of the report."""
    found = report.compared.get(path)
    if found is None or found.startswith(("not run", "not compared")):
        return ChartVerdict.NOT_RUN
    if SHIFTED in found.partition("\n")[0]:
        return ChartVerdict.SHIFTED
    if found.startswith(("different", "it does something else")):
        return ChartVerdict.DIFFERENT
    if path in report.untested or not found.startswith("equal"):
        return ChartVerdict.UNTESTED
    return ChartVerdict.DELAYED if " later" in found.partition("(")[0] else ChartVerdict.SAME


def pous_to_lower(report: ConversionReport) -> list[str]:
    """Return the names of the POUs with charts that the target has no exact chart for, as far as they were compared.

    Something of the chart is not executed, or it does something else in a run with the same inputs. Code may do it.
    """
    if not format_named(report.target_format)[0].tool:
        return []
    lost = [(ObjectPath.of(item.path), item.what) for item in report.with_outcome(Outcome.NOT_EXECUTED)]
    found = [
        path
        for path in report.compared
        if verdict_of(report, path) is ChartVerdict.DIFFERENT
        or any(each.is_in(path) and _is_of_chart(each.inside(path), what) for each, what in lost)
    ]
    return list(dict.fromkeys(ObjectPath.of(path).owner.removeprefix("POU ") for path in found))


def _is_of_chart(place: ObjectPath, what: str) -> bool:
    """True for a place in a POU that is a step, a transition or an input of its chart, or the chart itself."""
    return not place or place.startswith(("step ", "transition ")) or what in OPERATING_KINDS


def verdicts(source: Project, report: ConversionReport, words: Words, charts: Mapping[str, str]) -> Html:
    """Return the table of the charts: the verdict, how many losses, and what was seen when both were simulated.

    `charts` has the anchors of their pictures, by their paths.
    """
    paths = dict.fromkeys([*(chart.report_path for chart in source.charts()), *report.compared])
    rows: list[Html] = []
    for path in paths:
        verdict = verdict_of(report, path)
        losses = sum(ObjectPath.of(item.path).is_in(path) for item in report.losses)
        seen = [*report.compared.get(path, "").splitlines(), *report.untested.get(path, ())]
        told = [words.verdict(line) for line in seen if line] or [words("no comparison was asked for")]
        first, *more = (element("div", with_code(line)) for line in "\n".join(told).splitlines())
        rest = element("details", element("summary", words("Details")), *more) if more else Html("")
        rows.append(
            element(
                "tr",
                element("th", link(charts.get(path, ""), words.place(path))),
                element("td", words(verdict.value), class_=_CLASSES.get(verdict, "")),
                element("td", str(losses)),
                element("td", first, rest, class_="comment"),
            )
        )
    if not rows:
        return Html("")
    names = ("chart", "Verdict", "Losses", "Simulated as both tools execute it")
    head = element("thead", element("tr", *(element("th", words.heading(name)) for name in names)))
    table = element("table", head, element("tbody", *rows))
    return joined(element("h2", words("Charts")), element("div", table, class_="scroll"))


_OPERATED = "Decide who operates these inputs"
_TASKS = {
    **dict.fromkeys(OPERATING_KINDS, _OPERATED),
    "undeclared name": "Add what declares these names",
    "undeclared type": "Add these data types",
    "data type": "Replace this data type",
    "address": "Connect these variables to inputs and outputs",
    "task": "Create the task and call its programs",
    "interval": "Set the cycle time of the task",
    "program": "Create a task that calls this program",
    "initial": "Set these start values",
    "initial value": "Set these start values",
    "start values": "Set these start values",
    "constant expression": "Set these start values",
    "retain": "Make these variables retentive",
    "method": "Program these methods as blocks",
    "POU action": "Program these actions as blocks, and call them",
    "flag": "Program what these SFC flags control",
    "max time": "Program the supervision of these times",
    "text": "Correct these program texts",
    "condition": "Program these conditions",
    "condition of the transition": "Program these conditions",
}
"""Tasks for a person after the losses of a kind, by their subject."""


def tasks(
    report: ConversionReport, lists: ItemLists, words: Words, charts: Mapping[str, str], *, written: bool
) -> Html:
    """Return the tasks of a person in the target tool, from losses and from parts not seen to be the same.

    `charts` as in `verdicts`.
    """
    found: dict[str, list[Item]] = {}
    for item in report.losses:
        usual = "Program what is not executed" if item.outcome is Outcome.NOT_EXECUTED else "Look at what differs"
        found.setdefault(_TASKS.get(item.what, usual), []).append(item)
    found.setdefault(_OPERATED, []).extend(item for item in report.items if item.what == SEQUENCE)
    lines = [_task(words(text), lists.links(items, _MOST_PLACES)) for text, items in found.items() if items]
    if written:
        lines.append(_task(words("Import into {} and compile: not tried yet", tool_of(report.target_format))))
    unseen = [path for path in report.compared if verdict_of(report, path) is not ChartVerdict.SAME]
    unseen = [path for path in unseen if verdict_of(report, path) is not ChartVerdict.DELAYED]
    if unseen or not report.compared:
        places = [part for path in unseen for part in (", ", link(charts.get(path, ""), words.place(path)))][1:]
        lines.append(_task(words("Test the charts that were not shown to do the same"), joined(*places)))
    if lowered := pous_to_lower(report):
        told = words("Or take code instead of the charts that are not the same (`plcopen-sfc lower --pou NAME`)")
        lines.append(_task(told, ", ".join(lowered)))
    lines.append(_task(words("Test the machine")))
    return joined(element("h2", words("To do")), element("ul", *lines, class_="tasks"))


def _task(text: str, places: str = "") -> Html:
    return element("li", f"\u2610 {text}", element("div", places, class_="comment") if places else Html(""))


_MOST_PLACES = 8


def counts(report: ConversionReport, words: Words) -> Html:
    """Return the table of outcomes: how many items, and what that means for the machine."""
    rows = [
        element(
            "tr",
            element(
                "th", link(outcome.name.lower() if outcome is not Outcome.KEPT else "", words.heading(outcome.value))
            ),
            element("td", str(number)),
            element("td", words(MEANINGS[outcome]), class_="meaning"),
        )
        for outcome in Outcome
        if (number := len(report.with_outcome(outcome)))
    ]
    return joined(element("h2", words("Report")), element("table", element("tbody", *rows)))


def provenance(
    source: Project, report: ConversionReport, target: Project | None, words: Words, made_on: date | None
) -> Html:
    """Return the table of both files: tool, format, digest; the version of this package, and the day of the report."""
    rows = list(_file("Source", source, report.source_format, source.header.tool, words))
    if target is not None:
        # what goes to standard output was read again from a file that is gone now
        is_named = report.written != ["-"]
        # the header of what is written still names the tool of the source, which is not what will open it
        tool = tool_of(report.target_format)
        rows += _file("Target", target, report.target_format, tool, words, is_named=is_named)
    rows.append((words("Converted by"), f"plcopen_sfc {__version__}"))
    if made_on is not None:
        rows.append((words("Date"), made_on.isoformat()))
    cells = [element("tr", element("th", name), element("td", value)) for name, value in rows]
    return joined(element("h2", words("Files")), element("table", element("tbody", *cells)))


def tool_of(format_name: str) -> str:
    """Return the tool that a format belongs to, or the name of a format that belongs to none."""
    return format_named(format_name)[0].tool or format_name


def _file(
    side: str, project: Project, format_name: str, tool: str, words: Words, *, is_named: bool = True
) -> Iterator[tuple[str, str]]:
    source = project.source
    version = source.version if source is not None else ""
    name = file_name_of(project) if is_named else ""
    name = f"{name}/" if isinstance(source, FolderSource) else name
    form = f"{words('format')} {format_name} {version}".rstrip()
    yield words(side), ", ".join(filter(None, (name, tool, form)))
    if isinstance(source, FolderSource):
        files = {name: document.source.content for name, document in source.documents.items()}
        digests = [element("div", _digest(files[name]), f" {name}") for name in files]
        yield "SHA-256", joined(*digests)
    elif isinstance(source, FileSource):
        yield "SHA-256", _digest(source.content)


def _digest(content: bytes) -> Html:
    return element("small", element("code", sha256(content).hexdigest()))
