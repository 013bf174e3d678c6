"""Bodies in instruction list, drawn ones, and networks of exports as structured text, for tools that have no others."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import partial
from typing import TypeGuard

from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.name_uses import dialect_of
from plcopen_sfc.languages.binding.text_sites import Site
from plcopen_sfc.languages.expression_types import ExpressionTypes
from plcopen_sfc.languages.il import result_expression, statements
from plcopen_sfc.languages.networks import NetworkText, body_statements, shown_body, shown_named_condition
from plcopen_sfc.languages.networks.exported_networks import network_statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block, BlockCall
from plcopen_sfc.model.pou import Action, Method, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, BodyCondition, SfcBody
from plcopen_sfc.model.types import DataType, DerivedType, Elementary, ElementaryType, StringType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind


def write_conditions_as_expressions(project: Project) -> Iterator[str]:
    """Write the conditions in IL that only compute a value as expressions, and yield the paths of the transitions."""
    dialect = dialect_of(project)
    for chart in project.charts():
        for transition in chart.chart.transitions:
            condition = transition.condition
            if not isinstance(condition, BodyCondition) or not isinstance(condition.body, IlBody):
                continue
            tree = result_expression(condition.body.text, dialect, stored_in=condition.name)
            if tree is not None:
                transition.condition = Expression(text=print_node(tree), negated=condition.negated)
                yield f"{chart.report_path} / transition {chart.chart.label(transition)}"


def write_bodies_as_statements(project: Project) -> Iterator[str]:
    """Write the bodies in IL without jumps as structured text, and yield the paths of what they are the bodies of."""
    return _written(project, _of_instructions)


def write_exported_networks_as_statements(project: Project, source: str) -> Iterator[str]:
    """Write the networks in the form of files of a format as structured text, and yield the paths of their owners."""
    yield from _written(project, partial(_of_exported_networks, source=source))
    dialect = dialect_of(project)
    for pou in project.pous:
        for part in pou.transitions:
            shown = shown_named_condition(part, dialect) if _is_of(part.body, source) else None
            if shown is not None and not shown[1]:
                part.body = StBody(text=shown[0])
                yield pou.report_path_of(f"{pou.name}.{part.name}")


def _written(project: Project, as_statements: Callable[[Body | str | None, Dialect], StBody | None]) -> Iterator[str]:
    """Replace the bodies for which there are statements, and yield the paths of what they are the bodies of."""
    dialect = dialect_of(project)
    for pou in project.pous:
        for place, body in enumerate(pou.bodies):
            if (found := as_statements(body, dialect)) is not None:
                pou.bodies[place] = found
                yield pou.report_path
        parts: list[Action | Method] = [*pou.actions, *pou.methods]
        for part in parts:
            if (found := as_statements(part.body, dialect)) is not None:
                part.body = found
                yield pou.report_path_of(f"{pou.name}.{part.name}")
    for chart in project.charts():
        for step, association in chart.chart.associations():
            if (found := as_statements(association.body, dialect)) is not None:
                association.body = found
                yield f"{chart.report_path} / step {step.name}"
        for step in chart.chart.steps:
            for name in ("entry_action", "main_action", "exit_action"):
                if (found := as_statements(getattr(step, name), dialect)) is not None:
                    setattr(step, name, found)
                    yield f"{chart.report_path} / step {step.name}"


def write_drawn_bodies_as_statements(project: Project, calls: Collection[BlockCall] | None = None) -> Iterator[str]:
    """Write drawn bodies of POUs, actions and methods as structured text, and yield the paths of their owners.

    With `calls` only those with boxes that call something so. Variables that they need are declared. A function keeps
    no variables: a body of one that needs such stays drawn.
    """
    dialect = dialect_of(project)
    resolver = Resolver(project, dialect)
    for pou in project.pous:
        owners: list[Pou | Action | Method] = [pou, *pou.actions, *pou.methods]
        for owner in owners:
            bodies = [owner.body] if isinstance(owner, Action | Method) else owner.bodies
            for place, body in enumerate(bodies):
                text = None
                if isinstance(body, FbdBody | LdBody) and (calls is None or _has_calls(body, calls)):
                    text = _with_variables(pou, owner, body, resolver)
                    if text is None:
                        text = shown_body(body, dialect)
                if text is None or body is None:
                    continue
                statements = StBody(text=text, worksheet=body.worksheet)
                if isinstance(owner, Action | Method):
                    owner.body = statements
                    yield pou.report_path_of(f"{pou.name}.{owner.name}")
                else:
                    owner.bodies[place] = statements
                    yield pou.report_path


def _has_calls(body: FbdBody | LdBody, calls: Collection[BlockCall]) -> bool:
    nodes = (node for network in body.networks for node in network.nodes)
    return any(isinstance(node, Block) and node.call in calls for node in nodes)


def _with_variables(pou: Pou, owner: Pou | Action | Method, body: FbdBody | LdBody, resolver: Resolver) -> str | None:
    """Return a drawn body as statements, and declare the variables in them; None where it needs none, or has no such.

    Variables of a method are temporary: what it keeps is declared in its block.
    """
    method = owner if isinstance(owner, Method) else None
    names = [each.name for each in (*pou.parts, *pou.variables())]
    names += [each.name for section in resolver.project.global_sections() for each in section.variables]
    names += [step.name for each in pou.bodies if isinstance(each, SfcBody) for step in each.chart.steps]
    names += [each.name for each in method.interface.variables()] if method is not None and method.interface else []
    found = body_statements(body, resolver.dialect, taken=names)
    if not found.helpers or found.obstacles:
        return None
    if pou.kind is PouKind.FUNCTION and any(helper.retained for helper in found.helpers):
        return None
    variables = _helper_variables(found, found.tree, resolver, Site(pou=pou, method=method))
    for variable, helper in zip(variables or (), found.helpers, strict=True) if variables is not None else ():
        holder = method if method is not None and not helper.retained else pou
        if holder.interface is None:
            holder.interface = Interface()
        holder.interface.section(SectionKind.LOCAL).variables.append(variable)
    return print_node(found.tree) if variables is not None else None


def _is_of(body: Body | str | None, source: str) -> TypeGuard[OpaqueBody]:
    return isinstance(body, OpaqueBody) and body.source == source


def _of_exported_networks(body: Body | str | None, _: Dialect, *, source: str) -> StBody | None:
    text = network_statements(body.content) if _is_of(body, source) else None
    return StBody(text=text) if text is not None else None


def _of_instructions(body: Body | str | None, dialect: Dialect) -> StBody | None:
    if not isinstance(body, IlBody) or (tree := statements(body.text, dialect)) is None:
        return None
    return StBody(text=print_node(tree), worksheet=body.worksheet)


def _helper_variables(found: NetworkText, tree: n.Node, resolver: Resolver, site: Site) -> list[Variable] | None:
    """Return declarations for the helpers of a network, in their order; None where the type of one is not known.

    `tree` are the statements of the network: a value has the type of the expression that is assigned to it, and what is
    calculated that of the first variable that gets it, as tools differ in the type of ``n + 1``.
    """
    types: dict[str, DataType] = {
        helper.name.casefold(): _named(helper.type_name) for helper in found.helpers if helper.type_name is not None
    }
    wanted = {helper.name.casefold() for helper in found.helpers} - types.keys()
    assigned = [each for each in walk(tree) if isinstance(each, n.Assignment)] if wanted else []

    def type_of(value: n.Expression) -> DataType | None:
        known = types.get(value.identifier.casefold()) if isinstance(value, n.Name) else None
        if known is not None:
            return known
        type_ = resolver.type_of(value, site)
        return type_ if isinstance(type_, ElementaryType | StringType) else None

    expressions = ExpressionTypes(resolver.dialect, lambda value: _elementary(type_of(value)))
    for each in assigned:
        key = _name(each.target)
        if key in wanted - types.keys():
            calculated = expressions.value(each.value)
            taken = [target for use in assigned if _name(use.value) == key and (target := type_of(use.target))]
            of_target = taken[0] if taken and (calculated.is_whole or not calculated.type) else None
            value = type_of(n.bare(each.value)) or of_target or _known(calculated.type)
            if value is not None:
                types[key] = value
    if wanted - types.keys():
        return None
    return [Variable(name=helper.name, type=types[helper.name.casefold()]) for helper in found.helpers]


def _name(node: n.Node) -> str:
    return node.identifier.casefold() if isinstance(node, n.Name) else ""


def _named(name: str) -> DataType:
    return _known(name) or DerivedType(name=name)


def _known(name: str) -> DataType | None:
    elementary = Elementary.__members__.get(name.upper())
    return ElementaryType(name=elementary) if elementary is not None else None


def _elementary(type_: DataType | None) -> str:
    return type_.name.value if isinstance(type_, ElementaryType) else ""
