"""Declarations of the variables that a network needs as text, with the types of the wires that they stand for."""

from __future__ import annotations

from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.text_sites import Site
from plcopen_sfc.languages.expression_types import ExpressionTypes
from plcopen_sfc.languages.networks import Helper, NetworkText
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.model.types import DataType, DerivedType, Elementary, ElementaryType, StringType, Variable


def helper_variables(found: NetworkText, tree: n.Node, resolver: Resolver, site: Site) -> list[Variable] | None:
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
    return [_variable(helper, types[helper.name.casefold()]) for helper in found.helpers]


def _variable(helper: Helper, type_: DataType) -> Variable:
    return Variable(name=helper.name, type=type_)


def _name(node: n.Node) -> str:
    return node.identifier.casefold() if isinstance(node, n.Name) else ""


def _named(name: str) -> DataType:
    return _known(name) or DerivedType(name=name)


def _known(name: str) -> DataType | None:
    elementary = Elementary.__members__.get(name.upper())
    return ElementaryType(name=elementary) if elementary is not None else None


def _elementary(type_: DataType | None) -> str:
    return type_.name.value if isinstance(type_, ElementaryType) else ""
