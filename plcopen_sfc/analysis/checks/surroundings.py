"""What rules ask about the project around a chart: declared variables, and what else writes them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.il import instructions
from plcopen_sfc.languages.names.scopes import charts_inside
from plcopen_sfc.languages.names.uses import dialect_of
from plcopen_sfc.languages.networks import body_statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, parse_statements, walk
from plcopen_sfc.languages.st.effects import path_of
from plcopen_sfc.model.body import Body, FbdBody, IlBody, LdBody, SfcBody, StBody
from plcopen_sfc.model.network import Coil, Node, OutputVariable
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.types import DataType, DerivedType

_STORING = frozenset({"ST", "STN", "STQ", "S", "R"})


class Surroundings:
    """A project as the rules on its charts see it. Nothing is worked out before it is asked for."""

    def __init__(self, project: Project) -> None:
        self.project = project

    @cached_property
    def dialect(self) -> Dialect:
        """The dialect in which texts are read."""
        return dialect_of(self.project)

    @cached_property
    def globals(self) -> dict[str, DataType]:
        """The types of global variables and tags by their names in lower case."""
        found: dict[str, DataType] = {}
        for section in self.project.global_sections():
            for variable in section.variables:
                found[variable.name.casefold()] = variable.type
        for table in self.project.tag_tables:
            for tag in table.tags:
                found[tag.name.casefold()] = DerivedType(name=tag.type)
        return found

    @cached_property
    def names(self) -> frozenset[str]:
        """The names, in lower case, of everything global that has members: POUs, types, blocks, lists, instances."""
        project = self.project
        resources = [*project.resources()]
        found = [thing.name for thing in project.objects()]
        found += [section.name or "" for section in self.project.global_sections()]
        found += [configuration.name for configuration in project.configurations]
        found += [resource.name for resource in resources]
        found += [i.name for r in resources for i in (*r.instances, *(j for task in r.tasks for j in task.instances))]
        return frozenset(name.casefold() for name in found)

    def charts_of(self, pou: Pou) -> Iterator[SfcNetwork]:
        """The charts of a POU, those of macro-steps and partial charts too."""
        for _, _, body in pou.named_bodies():
            yield from charts_inside(body)

    @cached_property
    def written(self) -> frozenset[str]:
        """The last names, in lower case, of everything that code writes anywhere in the project."""
        return frozenset(self._written())

    @cached_property
    def associated(self) -> dict[str, set[int]]:
        """The charts (by `id`) that have associations with an operand of this last name, in lower case."""
        found: dict[str, set[int]] = {}
        for chart in self._charts():
            for _, association in chart.associations():
                name = self._last_name(association.target or "")
                if name:
                    found.setdefault(name, set()).add(id(chart))
        return found

    def _last_name(self, text: str) -> str:
        tree = parse_condition(text, self.dialect).tree if text else None
        path = path_of(tree) if isinstance(tree, n.Name | n.Member | n.Index | n.Address) else ()
        return path[-1] if path else ""

    def _charts(self) -> Iterator[SfcNetwork]:
        for pou in self.project.pous:
            yield from self.charts_of(pou)

    def _bodies(self) -> Iterator[Body]:
        for _, _, body in self.project.bodies():
            if not isinstance(body, SfcBody):
                yield body
        for chart in self._charts():
            for step in chart.steps:
                parts = (step.entry_action, step.main_action, step.exit_action, *(a.body for a in step.actions))
                yield from (part for part in parts if part is not None and not isinstance(part, str))
            operations = (*chart.permanent_pre, *chart.permanent_post)
            yield from (operation.body for operation in operations if operation.body is not None)

    def _written(self) -> Iterator[str]:
        for body in self._bodies():
            for node in code(body, self.dialect):
                target = written_by(node)
                path = path_of(target) if target is not None else ()
                if path:
                    yield path[-1]
            if isinstance(body, IlBody):
                yield from (tree_name for tree_name in self._stored_in(body))
        for chart in self._charts():
            yield from (self._last_name(text) for text in _drawn(chart.logic))

    def _stored_in(self, body: IlBody) -> Iterator[str]:
        for operand in stored(body, self.dialect):
            path = path_of(operand)
            if path:
                yield path[-1]


def written_by(node: n.Node) -> n.Expression | None:
    """What a node of a tree writes; None: nothing."""
    if isinstance(node, n.Assignment | n.AssignmentExpression):
        return node.target
    return node.value if isinstance(node, n.Argument) and node.output else None


def code(body: Body | None, dialect: Dialect) -> Iterator[n.Node]:
    """Every node of a body in ST, FBD or LD."""
    if isinstance(body, StBody):
        yield from walk(parse_statements(body.text, dialect).tree)
    elif isinstance(body, FbdBody | LdBody):
        yield from walk(body_statements(body, dialect).tree)


def stored(body: IlBody, dialect: Dialect) -> Iterator[n.Expression]:
    """What a body in instruction list stores, sets and resets."""
    for instruction in instructions(body.text, dialect):
        if instruction.operator.upper() in _STORING:
            for operand in instruction.operands:
                tree = operand.parsed.tree
                if isinstance(tree, n.Name | n.Member | n.Index | n.Address):
                    yield tree


def _drawn(nodes: list[Node]) -> Iterator[str]:
    """The variables that logic in a chart writes."""
    for node in nodes:
        if isinstance(node, Coil):
            yield node.variable
        elif isinstance(node, OutputVariable):
            yield node.expression
