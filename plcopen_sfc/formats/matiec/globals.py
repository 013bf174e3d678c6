"""Global variables as matiec has them: in a configuration, and declared as external wherever they are used."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from plcopen_sfc.languages.names.pieces import Piece, Reading, pieces
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, render, transform, walk
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Configuration, Project, Resource
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome


def declare_globals(project: Project, report: ConversionReport) -> None:
    """Move lists that stand in the project alone into a configuration, and declare in POUs what they use of globals."""
    lists = project.global_variables
    owners: list[Configuration | Resource] = [*project.applications, *project.configurations]
    owners += [resource for configuration in project.configurations for resource in configuration.resources]
    if lists and not owners:
        owners = [Configuration(name="Config0")]
        project.configurations = [one for one in owners if isinstance(one, Configuration)]
    if lists:
        owners[0].global_variables += lists
        project.global_variables = []
    sections = [section for owner in owners for section in owner.global_variables]
    globals_ = _Globals(sections)
    if not globals_.by_name:
        return
    for piece in list(pieces(project)):
        if piece.is_program_text and piece.site.pou is not None:
            _use(piece, globals_, project)
    for pou in project.pous:
        added = globals_.used.get(pou.name, {})
        if added and pou.kind is not PouKind.FUNCTION:
            _declare(pou, [globals_.by_name[name] for name in added])
            report.add(Outcome.TRANSLATED, "global variables", pou.report_path, f"{len(added)} declared as external")
    for section in sections:
        if section.persistent:
            section.persistent, section.retain = False, True
            report.add(Outcome.TRANSLATED, "section", "global variables", "PERSISTENT is RETAIN in matiec")
        section.declaration = None
        section.name = None
        section.carried = None


class _Globals:
    """The global variables by name, those of a list by its name, and which of them each POU uses."""

    def __init__(self, sections: list[VariableSection]) -> None:
        self.lists: dict[str, set[str]] = {}
        self.by_name: dict[str, tuple[Variable, VariableSection]] = {}
        self.used: dict[str, dict[str, None]] = {}
        for section in sections:
            for variable in section.variables:
                self.by_name.setdefault(variable.name.casefold(), (variable, section))
                if section.name:
                    self.lists.setdefault(section.name.casefold(), set()).add(variable.name.casefold())


@dataclass(slots=True)
class _Resolver:
    """Replaces ``List.x`` by ``x`` and notes what is used."""

    globals: _Globals
    own: frozenset[str]
    used: dict[str, None]

    def __call__(self, node: n.Node) -> n.Node:
        if isinstance(node, n.Member) and isinstance(node.base, n.Name):
            members = self.globals.lists.get(node.base.identifier.casefold(), set())
            name = node.name.identifier.casefold()
            if name in members and node.base.identifier.casefold() not in self.own and name not in self.own:
                self.used[name] = None
                return node.name
        return node


def _use(piece: Piece, globals_: _Globals, project: Project) -> None:
    pou = piece.site.pou
    if pou is None:
        return
    own = frozenset(v.name.casefold() for v in pou.variables()) | frozenset(_steps(pou))
    used = globals_.used.setdefault(pou.name, {})
    read = parse_statements if piece.reading is Reading.STATEMENTS else parse_expression
    parsed = read(piece.text, project.dialect)
    if parsed.problems:
        return
    tree = transform(parsed.tree, _Resolver(globals_, own, used))
    if tree is not parsed.tree:
        piece.put(render(parsed, tree))
    for node in walk(tree):
        if isinstance(node, n.Name) and node.identifier.casefold() in globals_.by_name.keys() - own:
            used[node.identifier.casefold()] = None


def _steps(pou: Pou) -> Iterator[str]:
    if pou.chart is not None:
        yield from (step.name.casefold() for step in pou.chart.steps)


def _declare(pou: Pou, found: list[tuple[Variable, VariableSection]]) -> None:
    if pou.interface is None:
        pou.interface = Interface()
    for constant in (False, True):
        variables = [
            Variable(name=variable.name, type=variable.type)
            for variable, section in found
            if section.constant is constant
        ]
        if variables:
            section = VariableSection(kind=SectionKind.EXTERNAL, constant=constant, variables=variables)
            pou.interface.sections.append(section)
