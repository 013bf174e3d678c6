"""Variables that steps write: operands of action associations, and assignments in the code of actions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, CheckedSheet
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding import bind
from plcopen_sfc.languages.binding.text_sites import Site
from plcopen_sfc.languages.effects import Path, path_of, target_of
from plcopen_sfc.languages.il import statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, print_node, walk
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.body import IlBody
from plcopen_sfc.model.sfc import ActionAssociation, Body, Step
from plcopen_sfc.model.variables import SectionKind


class Manner(StrEnum):
    """Manner in which an action acts on its operand.

    CONTINUOUS: as long as the step is active, or for a part of that time. SET, RESET: until something else is done.
    STORED: a value is assigned. OTHER: pulses, calls, counters and timers.
    """

    CONTINUOUS = "continuously"
    SET = "set"
    RESET = "reset"
    STORED = "stored"
    OTHER = "other"


_OF_KIND = {
    ActionKind.CONTINUOUS: Manner.CONTINUOUS,
    ActionKind.CONDITIONAL: Manner.CONTINUOUS,
    ActionKind.DELAYED: Manner.CONTINUOUS,
    ActionKind.LIMITED: Manner.CONTINUOUS,
    ActionKind.ON_ACTIVATION: Manner.STORED,
    ActionKind.ON_DEACTIVATION: Manner.STORED,
    ActionKind.ON_EVENT: Manner.STORED,
    ActionKind.FORCING: Manner.OTHER,
}
_OF_QUALIFIER = {
    **dict.fromkeys((Qualifier.NONE, Qualifier.N, Qualifier.L, Qualifier.D), Manner.CONTINUOUS),
    **dict.fromkeys((Qualifier.S, Qualifier.SD, Qualifier.DS, Qualifier.SL), Manner.SET),
    **dict.fromkeys((Qualifier.R, Qualifier.R0), Manner.RESET),
}


@dataclass(frozen=True, eq=False)
class TargetUse:
    """Use of an operand by an action association. `path` are the names that lead to it, in lower case."""

    sheet: CheckedSheet
    step: Step
    association: ActionAssociation
    path: Path
    manner: Manner

    @property
    def name(self) -> str:
        """The operand as people write it."""
        return self.association.target or ""


def manner_of(association: ActionAssociation) -> Manner:
    """Return how an association acts on its operand."""
    if association.kind is not None:
        return _OF_KIND[association.kind]
    manner = _OF_QUALIFIER.get(association.qualifier, Manner.OTHER)
    return Manner.STORED if association.value is not None and manner is not Manner.OTHER else manner


def how(use: TargetUse) -> str:
    """Return the kind or the qualifier of an action in words."""
    kind = use.association.kind
    return kind.words if kind is not None else use.association.qualifier.value


def operand(text: str, chart: CheckedChart) -> Path:
    """Return the names that lead to a variable; empty for what is no variable."""
    parsed = parse_condition(text, chart.dialect)
    return path_of(parsed.tree) if not parsed.problems else ()


def uses(chart: CheckedChart) -> Iterator[TargetUse]:
    """Return the uses of operands by all associations of a chart."""
    for sheet, step, association in chart.actions():
        if association.target:
            path = operand(association.target, chart)
            if path:
                yield TargetUse(sheet, step, association, path, manner_of(association))


def by_operand(chart: CheckedChart) -> dict[Path, list[TargetUse]]:
    """Return the same by operand."""
    return grouped((use.path, use) for use in uses(chart))


def continuous_operands(chart: CheckedChart) -> set[Path]:
    """Return the operands of continuous actions."""
    return {use.path for use in uses(chart) if use.manner is Manner.CONTINUOUS}


def output_operands(chart: CheckedChart) -> set[Path]:
    """Return the variables that the POU declares as outputs."""
    if chart.pou is None:
        return set()
    return {(variable.name.casefold(),) for variable in chart.pou.variables(SectionKind.OUTPUT)}


# -- code of actions


def assignments(body: Body | None, chart: CheckedChart) -> list[n.Assignment]:
    """Return the assignments of the code of an action, as far as it can be read."""
    return [node for tree in _statements(body, chart) for node in walk(tree) if isinstance(node, n.Assignment)]


def _statements(body: Body | None, chart: CheckedChart) -> Sequence[n.Statement]:
    """Return the code of an action; of an instruction list what does the same, if structured text has words for it."""
    if isinstance(body, IlBody):
        tree = statements(body.text, chart.dialect)
        return tree.statements if tree is not None else ()
    return bind(body, chart.dialect).statements if body is not None else ()


def written(body: Body | None, chart: CheckedChart) -> Iterator[tuple[n.Expression, Path, str]]:
    """Yield the variables that code writes, the names that lead there, and the literal; "" where it is not one.

    Also those that loops and outputs of calls write, and standard blocks that are called, with the call as the literal.
    """
    site = Site(chart.pou, place=chart.pou.place if chart.pou is not None else "")
    for node in (node for tree in _statements(body, chart) for node in walk(tree)):
        target, value = target_of(node), ""
        if isinstance(node, n.Assignment):
            value = constant(node.value)
        elif isinstance(node, n.Call) and chart.around.named.resolver.standard_block_of(node.callee, site) is not None:
            target, value = node.callee, print_node(node)
        path = path_of_part(target) if target is not None else ()
        if target is not None and path:
            yield target, path, value


def path_of_part(target: n.Expression) -> Path:
    """Return the names that lead to a variable, with its indices: the same text is taken for the same element."""
    if any(isinstance(node, n.Index) for node in walk(target)):
        return (print_node(target).casefold(),)
    return path_of(target) if isinstance(n.bare(target), n.Name | n.Member | n.Address) else ()


def body_named(name: str | None, chart: CheckedChart) -> Body | None:
    """Return the body of the action of this name in the POU."""
    if not name or chart.pou is None:
        return None
    action = chart.pou.find_action(name.strip('#"'))
    return action.body if action is not None else None


def constant(tree: n.Expression) -> str:
    """Return the literal that an expression is, in capitals; empty where it is more."""
    bare = n.bare(tree)
    return bare.text.upper() if isinstance(bare, n.Literal) else ""


def written_elsewhere(chart: CheckedChart, path: Path) -> bool:
    """Return True if code, or an association in another chart, writes a variable of this name."""
    around = chart.around
    charts = {id(sheet.chart) for sheet in chart.sheets}
    return path[-1] in around.written or bool(around.associated.get(path[-1], set()) - charts)
