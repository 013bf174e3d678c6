"""A project as one HTML page: tree, charts, declarations, program text, cross references and findings."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from pathlib import PurePath

from plcopen_sfc.analysis.coverage import Coverage, Unreached
from plcopen_sfc.analysis.verdict import Verdict
from plcopen_sfc.checking import check
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.drawing.pictures import chart_figure
from plcopen_sfc.errors import check_argument
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.declarations.declaration_writing import write_data_type, write_type, write_value
from plcopen_sfc.languages.st.parsing import sharing_trees
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project, Task
from plcopen_sfc.model.sfc import Body, SfcBody, Step
from plcopen_sfc.model.text import plain
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import VariableSection, sections_of
from plcopen_sfc.pages.html_text import Html, document, element, joined, link, picture_figure, with_code
from plcopen_sfc.pages.page_index import DrawnPart, PageIndex, PlacedBody
from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.pages.step_cells import Bodies, StepCells, comment_lines
from plcopen_sfc.pages.timing_diagram import trace_section
from plcopen_sfc.semantics.trace import Trace

_MOST_USES = 60
_SEVERITIES = (Severity.ERROR, Severity.WARNING, Severity.INFO)
_CAMEL = re.compile("(?<=[a-z])(?=[A-Z])")


@sharing_trees()
def page(
    project: Project, *, lang: str = "en", trace: Trace | None = None, verdict: Verdict | None = None, side: int = 0
) -> str:
    """Return a project as the text of one HTML file in ASCII, which loads nothing from elsewhere.

    It has the tree of the project, a picture of each chart with a table of its steps, declarations, program text whose
    names are links, the places that use each object, and the findings of `check` and of the reader at their places.
    A `trace` of it is shown with its timing diagram and can be played on the chart. Of a `verdict` of `equivalent`
    the steps and transitions that it did not reach are marked and listed; `side` 1: the project is the second of the
    two. `lang` is the language of its
    headings, ``en`` or ``de``. The same project gives the same text in every run. What
    is in the project is text there: nothing of it is executed. Raises `ModelError` for another language.
    """
    check_argument(project, Project, "page needs a project", "Load the file first.")
    words = Words(lang)
    index, coverage = PageIndex(project, told=words), None
    if verdict is not None:
        check_argument(verdict, Verdict, "the verdict of a page is what equivalent returned")
        coverage = verdict.coverage[side] if side in range(len(verdict.coverage)) else None
    content = _ProjectContent(index, words, coverage)
    overview, *sections = content.sections()
    if verdict is not None and coverage is not None:
        sections.insert(0, content.coverage_section(verdict, coverage))
    if trace is not None:
        check_argument(trace, Trace, "the trace of a page is what simulate returned")
        sections.insert(0, trace_section(trace, content.index, words))
    return document(title_of(project), words, content.tree(), overview, *sections)


def project_table(project: Project) -> str:
    """Return a table of the objects of a project, for notebooks: kinds, languages, and how large charts are."""
    rows = [
        element(
            "tr",
            element("td", thing.name),
            element("td", str(getattr(thing, "kind", "") or type(thing).__name__)),
            element("td", ", ".join(body.language for body in getattr(thing, "bodies", ()))),
            element("td", _size_of(getattr(thing, "bodies", ()))),
        )
        for thing in project.objects()
    ]
    return joined(element("p", title_of(project)), _table(("name", "kind", "languages", "charts"), rows, "objects"))


def pou_table(pou: Pou) -> str:
    """Return tables of the variables and the bodies of a POU, for notebooks."""
    dialect = pou.project.dialect if pou.project is not None else Dialect.IEC
    variables = [
        (section.kind, each.name, write_type(each.type, dialect), each.address or "", plain(each.comment))
        for section in sections_of(pou.interface)
        for each in section.variables
    ]
    bodies = [(each.name, each.body.language, _size_of([each.body])) for each in pou.named_bodies()]

    def rows(cells: Iterable[tuple[str, ...]]) -> list[Html]:
        return [element("tr", *(element("td", cell) for cell in row)) for row in cells]

    return joined(
        element("p", f"{pou.kind} {pou.name}"),
        _table(("section", "name", "type", "address", "comment"), rows(variables), "variables"),
        _table(("body", "language", "charts"), rows(bodies), "bodies"),
    )


def _size_of(bodies: Iterable[Body]) -> str:
    """Return how many steps and transitions the charts among `bodies` have, in words."""
    own = (body.chart for body in bodies if isinstance(body, SfcBody))
    return ", ".join(f"{len(chart.steps)} steps, {len(chart.transitions)} transitions" for chart in own)


def title_of(project: Project) -> str:
    """Return the title of a project on a page: its name, or that of its file."""
    return project.name or file_name_of(project) or "plcopen-sfc"


def file_name_of(project: Project) -> str:
    """Return the name of the file of a project; empty where it has none."""
    path = project.source.path if project.source is not None else None
    return PurePath(path).name if path else ""


class _ProjectContent:
    """The parts of the page of one project."""

    def __init__(self, index: PageIndex, words: Words, coverage: Coverage | None) -> None:
        self.index = index
        self._unreached: list[tuple[Unreached, list[str]]] = []
        for each in coverage.unreached if coverage is not None else ():
            drawn = each.kind in ("step", "transition")
            anchors = index.anchors_of(coverage.name, each.kind, each.name) if drawn and coverage is not None else []
            self._unreached.append((each, anchors))
        self.project = index.project
        self.words = words
        found = [*index.project.diagnostics, *check(index.project)]
        order = {severity: number for number, severity in enumerate(_SEVERITIES)}
        self.findings = sorted(dict.fromkeys(found), key=lambda finding: order[finding.severity])
        self._bodies = Bodies(index, words)
        self._found_at: dict[str, list[Diagnostic]] = {}
        for finding in self.findings:
            self._found_at.setdefault(index.anchor_at(finding.location.path or ""), []).append(finding)

    def coverage_section(self, verdict: Verdict, coverage: Coverage) -> Html:
        """Return the verdict of a comparison with what it did not reach."""
        items: list[Html] = []
        behind: list[Html] = []
        for each, anchors in self._unreached:
            told = with_code(self.words.verdict(each.name) if each.kind == "action" else self.words.label(each.name))
            told = element("code", each.name) if each.kind in ("assignment", "outcome of comparison") else told
            name = joined(f"{self.words(each.kind)} ", link(anchors[0], told) if anchors else told)
            if each.follows:
                behind.append(joined(", " if behind else "", name))
                continue
            kind = self.words("never possible" if each.impossible else "not reached")
            items.append(element("li", element("b", kind), " ", name, ": ", with_code(self.words.verdict(each.why))))
        if behind:  # the verdict does not count it
            items.append(element("li", element("b", self.words("not reached behind these steps")), ": ", *behind))
        return element(
            "section",
            element("h2", self.words("Verdict")),
            element("p", with_code(self.words.verdict(str(verdict).splitlines()[0]))),
            element("p", f"{coverage.name}: {self.words.verdict(str(coverage))}"),
            element("ul", *items) if items else Html(""),
            id="coverage",
        )

    # -- the tree

    def tree(self) -> Html:
        """Return the tree of the project as links to the sections."""
        words, index, project = self.words, self.index, self.project
        sections = [section for section in project.global_sections() if section.variables]
        groups = [
            (words("Data types"), [link(index.anchor(each), each.name) for each in project.data_types]),
            (words("Global variables"), [link(index.anchor(each), self._section_name(each)) for each in sections]),
            (words("Tag tables"), [link(index.anchor(each), each.name) for each in project.tag_tables]),
            (words.heading("data blocks"), [link(index.anchor(each), each.name) for each in project.data_blocks]),
        ]
        items = [element("li", link("project", words("Project")))]
        if self.findings:
            items.append(element("li", link("findings", f"{words('Findings')} ({len(self.findings)})")))
        items += [element("li", self._pou_branch(pou)) for pou in project.pous]
        for name, links in groups:
            if links:
                inner = element("ul", *(element("li", each) for each in links))
                items.append(element("li", element("details", element("summary", name), inner)))
        return element("ul", *items)

    def _pou_branch(self, pou: Pou) -> Html:
        parts = [each for each in self.index.bodies[id(pou)] if each.found.name != pou.name]
        name = link(self.index.anchor(pou), pou.name)
        below = [element("li", link(each.anchor, each.found.name.rpartition(".")[2])) for each in parts]
        return joined(name, element("ul", *below)) if below else name

    # -- the sections

    def sections(self) -> Iterator[Html]:
        """Yield the sections of the page."""
        yield self._overview()
        if self.findings:
            items = element("ul", *(self._finding(each, linked=True) for each in self.findings), class_="findings")
            yield element("section", element("h2", self.words("Findings")), items, id="findings")
        for pou in self.project.pous:
            yield self._pou(pou)
        yield from self._others()

    def _overview(self) -> Html:
        words, project = self.words, self.project
        charts = [part.chart for parts in self.index.parts.values() for part in parts]
        # a GRAFCET that has all its steps in partial charts is none itself
        charts = [each for each in charts if each.steps or each.transitions or not each.partial_charts]
        facts = [
            (words.heading("format"), f"{project.source.format} {project.source.version}" if project.source else ""),
            (words("Tool"), project.header.tool),
            (words("Charts"), str(len(charts))),
            (words("Steps"), str(sum(len(chart.steps) for chart in charts))),
            (words("Transitions"), str(sum(len(chart.transitions) for chart in charts))),
        ]
        rows = [element("tr", element("th", name), element("td", text)) for name, text in facts if text.strip()]
        tasks = [self._task(task, number) for number, task in enumerate(project.tasks())]
        if tasks:
            listed = element("ul", *tasks)
            rows.append(element("tr", element("th", words("Tasks")), element("td", listed)))
        comment = plain(project.content_comment or project.comment)
        remark = element("p", comment, class_="comment") if comment else Html("")
        return element("section", element("h1", title_of(project)), remark, element("table", *rows), id="project")

    def _task(self, task: Task, number: int) -> Html:
        cycle = self.words("every {}", task.interval) if task.interval else ""
        programs = ", ".join(instance.name for instance in task.instances)
        told = " ".join(filter(None, (task.name, cycle, programs)))
        return element("li", told, id=f"task-{number}", data_name=task.name)

    def _pou(self, pou: Pou) -> Html:
        kind = self.words(_CAMEL.sub(" ", pou.kind.value).lower())
        anchor = self.index.anchor(pou)
        parts = [
            element("h2", element("small", kind), " ", pou.name),
            comment_lines(pou.title, pou.comment),
            self._findings_at(anchor),
            self._declarations(sections_of(pou.interface)),
            *(self._body(placed, is_own=placed.found.name == pou.name) for placed in self.index.bodies[id(pou)]),
            self._uses(anchor),
        ]
        return element("section", *parts, id=anchor, data_name=pou.name, class_="pou")

    def _body(self, placed: PlacedBody, *, is_own: bool) -> Html:
        body, name = placed.found.body, placed.found.name
        heading = Html("") if is_own else element("h3", *self._part_name(placed))
        title = plain(body.title)
        methods = (each for each in placed.found.pou.methods if self.index.anchor(each) == placed.anchor)
        sections = [section for each in methods if each.interface is not None for section in each.interface.sections]
        parts = [heading, element("h4", title) if title else Html(""), self._declarations(sections)]
        parts.append(self._content(body, placed.anchor))
        if not is_own:
            parts += [self._findings_at(placed.anchor), self._uses(placed.anchor)]
        return element("div", *parts, id=placed.anchor, data_name="" if is_own else name)

    def _part_name(self, placed: PlacedBody) -> Iterator[str]:
        kind, _, name = placed.path.rpartition(" / ")[2].partition(" ")
        yield from (element("small", self.words(kind)), " ", name) if name else (kind,)

    def _content(self, body: Body | None, anchor: str) -> Html:
        if isinstance(body, SfcBody) and anchor:
            return self._chart(body, f"{anchor}-")
        return self._bodies.content(body)

    # -- charts

    def _chart(self, body: SfcBody, prefix: str) -> Html:
        marks = {anchor: f"found-{found[0].severity}" for anchor, found in self._found_at.items()}
        for each, anchors in self._unreached:
            kind = "impossible" if each.impossible else "unreached"
            marks |= {anchor: f"{marks.get(anchor, '')} {kind}".strip() for anchor in anchors}
        frames = [part.anchor for part in self.index.parts[prefix] if part.anchor]
        names = self.index.names(prefix) | {anchor: {"": f"{anchor}-heading"} for anchor in frames}
        picture = chart_figure(body.chart, prefix, marks, names, self.words)
        figure = picture_figure(picture, self.words)
        common, parts = (self.index, self._bodies, self.words), self.index.parts[prefix]
        tables = [(part, StepCells(part.chart, *common, told=self._findings_at)) for part in parts]
        permanent = (cells.permanent() for _, cells in tables)
        return joined(figure, *permanent, *(self._steps(part, cells) for part, cells in tables))

    def _steps(self, part: DrawnPart, cells: StepCells) -> Html:
        rows = [self._step(step, cells) for step in part.chart.steps]
        if first := cells.leaving(None):
            label = element("th", self.words("Source transitions"))
            rows.append(element("tr", label, element("td"), element("td", first)))
        titles = (self.words("Step"), self.words("Actions"), self.words("Transitions"))
        table = _table(titles, rows, "steps") if rows else Html("")
        return joined(self._heading(part), table) if rows else self._heading(part)

    def _heading(self, part: DrawnPart) -> Html:
        """Return the name of a partial chart, or of a chart inside a step, with what is told about it."""
        if not part.anchor:
            return Html("")
        name = link(part.anchor, part.drawn.heading)
        heading = element("h4", name, id=f"{part.anchor}-heading", data_name=part.drawn.name)
        return joined(heading, comment_lines(part.drawn.comment), self._findings_at(part.anchor))

    def _step(self, step: Step, cells: StepCells) -> Html:
        anchor = self.index.anchor(step)
        head = element("th", *cells.name(step), self._findings_at(anchor), self._uses(anchor))
        done, going = element("td", cells.actions(step)), element("td", cells.leaving(step))
        return element("tr", head, done, going, id=cells.row(step), data_name=step.name)

    # -- declarations

    def _declarations(self, sections: Iterable[VariableSection]) -> Html:
        rows = [row for section in sections for row in self._variables(section.variables, self._section_name(section))]
        return self._variable_table(rows)

    def _variable_table(self, rows: list[Html]) -> Html:
        titles = ("Section", "Name", "Type", "Initial value", "Address", "Comment", "Used in")
        return _table([self.words(title) for title in titles], rows, "variables") if rows else Html("")

    def _variables(self, variables: Iterable[Variable], section: str) -> Iterator[Html]:
        dialect = self.project.dialect
        for variable in variables:
            anchor = self.index.anchor(variable)
            type_ = write_type(variable.type, dialect)
            owners = self._type_owners.get(type_.strip('"').casefold())
            target = self.index.anchor(owners[0]) if owners else ""
            cells = [
                element("td", section),
                element("th", variable.name),
                element("td", element("code", link(target, type_))),
                element(
                    "td", element("code", write_value(variable.initial, dialect)) if variable.initial else Html("")
                ),
                element("td", variable.address or ""),
                element("td", plain(variable.comment)),
                element("td", self._uses(anchor)),
            ]
            yield element("tr", *cells, id=anchor, data_name=variable.name)

    @cached_property
    def _type_owners(self) -> dict[str, list[object]]:
        """The types and blocks of the project by their names in lower case."""
        return grouped((each.name.casefold(), each) for each in (*self.project.data_types, *self.project.pous))

    @staticmethod
    def _section_name(section: VariableSection) -> str:
        flags = ("constant", "retain", "persistent")
        names = [section.name or f"VAR_{_CAMEL.sub('_', section.kind.value)}".upper()]
        names = ["VAR" if name == "VAR_LOCAL" else name for name in names]
        return " ".join([*names, *(flag.upper() for flag in flags if getattr(section, flag))])

    def _others(self) -> Iterator[Html]:
        project, index = self.project, self.index
        for section in project.global_sections():
            if section.variables:
                yield self._other(section, self._section_name(section), self._declarations([section]))
        for declaration in project.data_types:
            text = element("pre", element("code", write_data_type(declaration, project.dialect)))
            yield self._other(declaration, declaration.name, joined(text, self._uses(index.anchor(declaration))))
        for block in project.data_blocks:
            content = self._declarations(sections_of(block.interface))
            kind = element("p", block.type_name) if block.type_name else Html("")
            yield self._other(block, block.name, joined(kind, content, self._uses(index.anchor(block))))
        for table in project.tag_tables:
            rows = [*self._variables(table.constants, "VAR_CONSTANT")]
            for tag in table.tags:
                anchor = index.anchor(tag)
                texts = ("", tag.name, tag.type, "", tag.address or "", plain(tag.comment))
                cells = [*(element("td", text) for text in texts), element("td", self._uses(anchor))]
                rows.append(element("tr", *cells, id=anchor, data_name=tag.name))
            yield self._other(table, table.name, self._variable_table(rows))

    def _other(self, thing: object, name: str, content: Html) -> Html:
        anchor = self.index.anchor(thing)
        return element("section", element("h2", name), self._findings_at(anchor), content, id=anchor, data_name=name)

    # -- what is said about objects

    def _uses(self, anchor: str) -> Html:
        paths = self.index.uses(anchor)
        if not paths:
            return Html("")
        shown = [element("li", link(self.index.anchor_at(path), self.words.place(path))) for path in paths[:_MOST_USES]]
        if len(paths) > _MOST_USES:
            shown.append(element("li", self.words("and {} more", len(paths) - _MOST_USES)))
        summary = element("summary", f"{self.words('Used in')} {len(paths)}")
        return element("details", summary, element("ul", *shown), class_="uses")

    def _findings_at(self, anchor: str) -> Html:
        found = self._found_at.get(anchor, ())
        items = [self._finding(each, linked=False) for each in found]
        return element("ul", *items, class_="findings") if items else Html("")

    def _finding(self, finding: Diagnostic, *, linked: bool) -> Html:
        place = finding.location
        title = element("b", f"{self.words(finding.severity.value)} {finding.code}")
        parts: list[str] = [title, " ", with_code(self.words.message(finding.message))]
        if linked and place.path:
            parts += [" ", link(self.index.anchor_at(place.path), self.words.place(place.path))]
        if place.line:
            parts += [" ", element("small", self.words("line {}", place.line))]
        if finding.hint:
            parts.append(element("div", with_code(self.words.message(finding.hint)), class_="comment"))
        return element("li", *parts, class_=f"is-{finding.severity}")


def _table(titles: Sequence[str], rows: Sequence[Html], kind: str) -> Html:
    head = element("thead", element("tr", *(element("th", title) for title in titles)))
    return element("div", element("table", head, element("tbody", *rows), class_=kind), class_="scroll")
