"""A copy of lowered code that tells what its transitions want, by Boolean variables before and behind all else."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from plcopen_sfc.errors import LoweringError
from plcopen_sfc.languages.networks.numbering import apart
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, transform, walk
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.lowering.code.emitting import function_block_diagram, ladder_diagram, structured_text
from plcopen_sfc.lowering.code.logic import assignment, conjunction
from plcopen_sfc.lowering.code.naming import Naming
from plcopen_sfc.lowering.code.program import Code
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.model.body import Body, FbdBody, LdBody, StBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import VariableSection


class WatchedPou(NamedTuple):
    """The copy, and the variables by the index of their transitions: those before all else, and those behind."""

    pou: Pou
    before: dict[int, str]
    behind: dict[int, str]


def watched_pou(code: Pou, source: ChartSource, situation: Mapping[str, str], *, behind: bool) -> WatchedPou:
    """The copy of `code`.

    A variable is TRUE while the steps before its transition are active and its condition is TRUE. `situation` says what
    tells in the code that a step is active, by the path of the step. Transitions whose condition can be evaluated
    nowhere but in its place, because it asks for the time of a step, have no variable. `behind`: there are variables
    that tell what transitions want at the end of a scan, too.
    """
    flags = {path.casefold(): parse_expression(text, source.dialect).tree for path, text in situation.items()}
    declared = {v.name.casefold() for v in code.variables()}
    first = Code(Naming(source.dialect, declared | source.names()))
    last = Code(first.naming)
    names: list[dict[int, str]] = []
    for place, wanted in ((first, "wanted"), (last, "waits")):
        names.append(_watch(place, source, flags, wanted) if place is first or behind else {})
    if not names[0]:
        return WatchedPou(code, {}, {})
    copy = code.model_copy(deep=True)
    if copy.interface is not None:
        copy.interface.sections.append(VariableSection(variables=[*first.variables, *last.variables]))
    bodies = list(copy.bodies)
    bodies[0] = _around(bodies[0], first, last, source, copy.variables())
    copy.bodies = bodies
    return WatchedPou(copy, *names)


def _watch(code: Code, source: ChartSource, flags: Mapping[str, Expression], wanted: str) -> dict[int, str]:
    """Append what is assigned to the variables."""
    statements: list[n.Statement] = []
    names: dict[int, str] = {}
    for transition in source.net.transitions:
        condition = _told(source.conditions[transition.index], flags)
        if condition is None:
            continue
        enabled = [flags[source.net.steps[i].path.casefold()] for i in transition.sources]
        variable = code.declare(f"{wanted}_{transition.index + 1}")
        statements.append(assignment(variable, conjunction([*enabled, condition])))
        names[transition.index] = variable.identifier
    code.add("", statements)
    return names


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


def _around(body: Body, first: Code, last: Code, source: ChartSource, declared: list[Variable]) -> Body:
    """The body with code before and behind it."""
    if isinstance(body, StBody):
        texts = (structured_text(code, source.dialect).text for code in (first, last))
        return StBody(text=body.text.join(texts))
    if isinstance(body, FbdBody):
        drawn = [
            function_block_diagram(code, source.dialect, declared, source.pou.name).networks for code in (first, last)
        ]
        return FbdBody(networks=apart([*drawn[0], *body.networks, *drawn[1]])[0])
    if isinstance(body, LdBody):
        drawn = [ladder_diagram(code, source.dialect, declared, source.pou.name).networks for code in (first, last)]
        return LdBody(networks=apart([*drawn[0], *body.networks, *drawn[1]])[0])
    raise LoweringError(f"nothing can be put around a body in {body.language}")
