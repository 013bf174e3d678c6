"""Lists of global variables of CODESYS in TC6, whose global variables belong to a configuration and to no list.

Programs of CODESYS name a variable with its list, ``GVL_IO.x``, or without. In TC6 it is ``x``: the name of the list is
taken out of every text, and the texts of the source are kept for the way back.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from plcopen_sfc.formats.plcopen.rewritten import ADDED_FIELD, TEXTS_FIELD, Marks, added_section, digest
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names.pieces import Piece, Reading, Site, pieces
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, parse_statements, print_node
from plcopen_sfc.languages.st.rendering import render
from plcopen_sfc.languages.st.walking import transform
from plcopen_sfc.model.body import FbdBody, LdBody, SfcBody, StBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Configuration, Project, Resource
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome


def has_lists(project: Project) -> bool:
    """True if a project has lists of global variables whose names stand in texts."""
    return any(True for _ in _lists(project))


def _lists(project: Project) -> Iterator[VariableSection]:
    yield from project.global_variables
    for section in (section for resource in project.applications for section in resource.global_variables):
        if section.name:
            yield section
    for section in (s for c in project.configurations for r in c.resources for s in r.global_variables):
        if section.name and section.object_id is not None:  # in IEC 61131-3 the name of a list says nothing
            yield section


def list_names(project: Project) -> frozenset[str]:
    """The names of all lists of global variables, in lower case."""
    return frozenset(section.name.casefold() for section in project.global_sections() if section.name)


def declare_lists(project: Project, report: ConversionReport, marks: Marks) -> None:
    """Move the lists of `project`, a copy, into a configuration, and take their names out of its texts."""
    counts = Counter(v.name.casefold() for section in _lists(project) for v in section.variables)
    members: dict[str, set[str]] = {}
    for section in _lists(project):
        members.setdefault((section.name or "").casefold(), set()).update(v.name.casefold() for v in section.variables)
    shared = {name for name, count in counts.items() if count > 1}
    for name in sorted(shared):
        why = "several lists have a variable of this name, and TC6 knows no lists: what names it does not compile"
        report.add(Outcome.NOT_EXECUTED, "global variable", f"global variable {name}", why)
    unqualifier = _Unqualifier(project, members, shared, marks)
    unqualifier.run()
    for path in dict.fromkeys(unqualifier.left):
        why = "it names a variable with its list, which TC6 does not know: it does not compile"
        report.add(Outcome.NOT_EXECUTED, "text", path, why)
    for path, name in dict.fromkeys(unqualifier.hidden):
        why = f"{name} keeps its list, which TC6 does not know, as another {name.rpartition('.')[2]} hides it"
        report.add(Outcome.NOT_EXECUTED, "text", path, f"{why}: it does not compile")
    moved: list[VariableSection] = []
    for section in project.global_variables:
        source = section.model_dump(mode="json", exclude_none=True)
        plain = section.model_copy(update={"declaration": None, "object_id": None, "carried": None})
        marks[id(plain)] = added_section(plain) | {"list": source}
        moved.append(plain)
    for listed in dict.fromkeys(section.name for section in moved):  # a list may have several sections
        report.add(Outcome.TRANSLATED, "global variables", f"global variables {listed}", "of the configuration")
    project.global_variables = []
    if moved:
        if not project.configurations and not project.applications:
            project.configurations = [Configuration(name="Configuration", resources=[Resource(name="Resource")])]
            marks[id(project.configurations[0])] = {ADDED_FIELD: []}
        target = project.configurations[0] if project.configurations else project.applications[0]
        target.global_variables = [*target.global_variables, *moved]


class _Unqualifier:
    """Takes the names of lists out of texts.

    `left` are the paths of texts that keep them, `hidden` those in which a variable keeps its list, each with its name.
    """

    def __init__(self, project: Project, members: dict[str, set[str]], shared: set[str], marks: Marks) -> None:
        self._project = project
        self._members = members
        self._marks = marks
        self._objects = shared | {thing.name.casefold() for thing in project.objects()}
        self._locals: dict[int, set[str]] = {}
        self.left: list[str] = []
        self.hidden: list[tuple[str, str]] = []

    def run(self) -> None:
        """Change the texts of all bodies."""
        bodies = [body for _, _, body in self._project.bodies()]
        drawn = [body for body in bodies if isinstance(body, FbdBody | LdBody)]
        before = {id(body): body.model_dump(mode="json", exclude_none=True)["networks"] for body in drawn}
        texts = {id(body): body.text for body in bodies if isinstance(body, StBody)}
        for piece in list(pieces(self._project)):
            is_text = piece.is_program_text or piece.reading is Reading.INSTRUCTIONS
            if not is_text or not self._mentions(piece.text):
                continue
            if piece.language == "declaration" or piece.reading is Reading.INSTRUCTIONS:
                self.left.append(piece.report_path)
            elif (new := self._unqualified(piece)) != piece.text:
                piece.put(new)
        for body in bodies:
            if isinstance(body, StBody) and body.text != texts[id(body)]:
                kept = {"text": [texts[id(body)], digest(body.text)]}
                self._marks[id(body)] = {TEXTS_FIELD: kept}
        for body in drawn:
            if body.model_dump(mode="json", exclude_none=True)["networks"] != before[id(body)]:
                self._marks[id(body)] = {"networks": before[id(body)]}

    def _mentions(self, text: str) -> bool:
        folded = text.casefold()
        return any(f"{name}." in folded for name in self._members)

    def _unqualified(self, piece: Piece) -> str:
        hidden = self._names_in(piece.site)

        def change(node: n.Node) -> n.Node:
            if not isinstance(node, n.Member) or not isinstance(node.base, n.Name):
                return node
            name, member = node.base.identifier.casefold(), node.name.identifier.casefold()
            if member not in self._members.get(name, ()) or name in hidden:
                return node
            if member in hidden or member in self._objects:
                self.hidden.append((piece.report_path, print_node(node)))
                return node
            return node.name

        if piece.reading is Reading.STATEMENTS:
            statements = parse_statements(piece.text, Dialect.CODESYS)
            if not statements.problems:
                return render(statements, transform(statements.tree, change))
        condition = parse_condition(piece.text, Dialect.CODESYS)
        return piece.text if condition.problems else render(condition, transform(condition.tree, change))

    def _names_in(self, site: Site) -> set[str]:
        """The names that hide global ones."""
        pou = site.pou
        if pou is None:
            return set()
        if id(pou) not in self._locals:
            self._locals[id(pou)] = {name.casefold() for name in _own_names(pou)}
        return self._locals[id(pou)]


def _own_names(pou: Pou) -> Iterator[str]:
    external = SectionKind.EXTERNAL  # which names the global variable itself
    sections = pou.interface.sections if pou.interface is not None else ()
    yield from (variable.name for section in sections if section.kind is not external for variable in section.variables)
    yield from (action.name for action in pou.actions)
    yield from (transition.name for transition in pou.transitions)
    for _, _, body in pou.named_bodies():
        yield from (step.name for step in body.chart.steps) if isinstance(body, SfcBody) else ()
    for method in pou.methods:
        if method.interface is not None:
            yield from (variable.name for variable in method.interface.variables())
