"""A copy of lowered code that tells what its transitions want: Boolean variables that are assigned before all else."""

from __future__ import annotations

from collections.abc import Mapping

from plcopen_sfc.errors import LoweringError
from plcopen_sfc.languages.networks.numbering import apart
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, transform, walk
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.lowering.code import Code
from plcopen_sfc.lowering.emitting import function_block_diagram, ladder_diagram, structured_text
from plcopen_sfc.lowering.logic import assignment, conjunction
from plcopen_sfc.lowering.naming import Naming
from plcopen_sfc.lowering.source import ChartSource
from plcopen_sfc.model.body import Body, FbdBody, LdBody, StBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import SectionKind, VariableSection


def watched_pou(code: Pou, source: ChartSource, situation: Mapping[str, str]) -> tuple[Pou, dict[int, str]]:
    """The copy, and the variables by the index of their transitions.

    A variable is TRUE while the steps before its transition are active and its condition is TRUE. `situation` says what
    tells in the code that a step is active, by the path of the step. Transitions whose condition can be evaluated
    nowhere but in its place, because it asks for the time of a step, have no variable.
    """
    flags = {path.casefold(): parse_expression(text, source.dialect).tree for path, text in situation.items()}
    declared = {v.name.casefold() for v in code.interface.variables()} if code.interface is not None else set()
    watching = Code(Naming(source.dialect, declared | source.names()))
    statements: list[n.Statement] = []
    names: dict[int, str] = {}
    for transition in source.net.transitions:
        condition = _told(source.conditions[transition.index], flags)
        if condition is None:
            continue
        enabled = [flags[source.net.steps[i].path.casefold()] for i in transition.sources]
        variable = watching.declare(f"wanted_{transition.index + 1}")
        statements.append(assignment(variable, conjunction([*enabled, condition])))
        names[transition.index] = variable.identifier
    watching.add("", statements)
    if not statements:
        return code, {}
    copy = code.model_copy(deep=True)
    if copy.interface is not None:
        copy.interface.sections.append(VariableSection(kind=SectionKind.LOCAL, variables=watching.variables))
    bodies = list(copy.bodies)
    bodies[0] = _before(bodies[0], watching, source, copy.interface.variables() if copy.interface is not None else [])
    copy.bodies = bodies
    return copy, names


def _told(condition: Expression, flags: Mapping[str, Expression]) -> Expression | None:
    """The condition with flags for the step variables in it; None where it asks for anything else of a step."""

    def flag(node: n.Node) -> n.Node:
        match node:
            case n.Member(n.Name(step), n.Name(quantity)) if quantity.casefold() == "x":
                return flags.get(step.casefold(), node)
        return node

    told = transform(condition, flag)
    asks = (node.base for node in walk(told) if isinstance(node, n.Member))
    if any(isinstance(base, n.Name) and base.identifier.casefold() in flags for base in asks):
        return None
    return told


def _before(body: Body, watching: Code, source: ChartSource, declared: list[Variable]) -> Body:
    """The body with the assignments before it."""
    match body:
        case StBody(text=text):
            return StBody(text=structured_text(watching, source.dialect).text + text)
        case FbdBody(networks=networks):
            first = function_block_diagram(watching, source.dialect, declared).networks
            return FbdBody(networks=apart([*first, *networks])[0])
        case LdBody(networks=networks):
            first = ladder_diagram(watching, source.dialect, declared).networks
            return LdBody(networks=apart([*first, *networks])[0])
    raise LoweringError(f"nothing can be put before a body in {body.language}")
