"""Bodies and other texts as their names tell: trees, name sites, effects, and what is not known of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any

from plcopen_sfc.languages.binding.name_scopes import charts_inside
from plcopen_sfc.languages.binding.name_sites import Reference
from plcopen_sfc.languages.binding.name_uses import Names, references
from plcopen_sfc.languages.binding.text_sites import SiteKind, TextSite, text_sites_in
from plcopen_sfc.languages.effects import Effects, Path, calls, effects, path_of, targets
from plcopen_sfc.languages.il import CALLS, JUMPS, STORING, instructions
from plcopen_sfc.languages.networks import Helper, body_statements, chart_statements, condition_reader
from plcopen_sfc.languages.networks.exported_networks import SOURCES, network_statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_body, parse_expression
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import LateElement
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import Action, Method, NamedTransition, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork, Step


@dataclass(frozen=True, slots=True)
class UnknownPart:
    """A part of a body that cannot be bound: its effects are not known. `reason` tells why."""

    reason: str


@dataclass(frozen=True)
class BoundBody:
    """A body, and what can be told of it without declarations.

    `statements` are those of ST, FBD and LD in their order; `trees` are all expressions and statements of the body, of
    charts and instruction list in no order, and without the values that instructions store. `helpers` and `instances`
    are those of networks, as in `NetworkText`. `charts` are the chart of the body and those inside it.
    Where `unknown` is empty, nothing of the body is missing in all this.
    """

    body: Body
    dialect: Dialect
    statements: Sequence[n.Statement] = ()
    trees: Sequence[n.Expression | n.Statement] = ()
    unknown: tuple[UnknownPart, ...] = ()
    helpers: tuple[Helper, ...] = ()
    instances: Mapping[str, str] = field(default_factory=dict)
    charts: tuple[ChartTexts, ...] = ()

    @property
    def program(self) -> Sequence[n.Statement] | None:
        """The statements if they are all that the body does; None where they are not, or need variables of their own.

        So it is for instruction list, charts, and an expression in the place of statements.
        """
        has_statements = isinstance(self.body, FbdBody | LdBody) or (
            isinstance(self.body, StBody) and len(self.trees) == len(self.statements)
        )
        return self.statements if has_statements and not self.unknown and not self.helpers else None

    @cached_property
    def uses(self) -> tuple[Reference, ...]:
        """The name sites of the body, those in text that cannot be read too; none is in a comment or a string."""
        return tuple(each for text_site in text_sites_in(self.body) for each in references(text_site, self.dialect))

    @cached_property
    def effects(self) -> Effects:
        """Reads, writes and calls of the body.

        The target of an action association is written and called: only declarations tell a variable from an action.
        """
        return Effects.all([self.code, *(chart.acting for chart in self.charts)])

    @cached_property
    def code(self) -> Effects:
        """The effects of the code in the body, without those of naming an action in a step."""
        found = [self._effects_of_trees()]
        found += (bind(inner, self.dialect).code for chart in self.charts for inner in chart.bodies)
        if isinstance(self.body, FbdBody | LdBody) and self.unknown:  # a box that has no statement is called too
            boxes = [node for network in self.body.networks for node in network.nodes if isinstance(node, Block)]
            names = [name for box in boxes for name in (box.instance, box.type_name) if name]
            trees = [n.CallStatement(parse_expression(name, self.dialect).tree) for name in names]
            found += (Effects(calls=calls(tree)) for tree in trees)
        return Effects.all(found)

    def _effects_of_trees(self) -> Effects:
        instances = (name for name, type_ in self.instances.items() if standard_block(type_) is not None)
        return effects(self.trees, {path_of(parse_expression(name, self.dialect).tree) for name in instances})

    def targets(self) -> Iterator[n.Expression]:
        """Return the variables that statements and instructions write, as they are written there."""
        return (target for tree in self.trees for target in targets(tree))


def bind(body: Body, dialect: Dialect) -> BoundBody:
    """Return the bound view of a body, made once for as long as the body stays as it is."""
    state = (dialect, _content(body))
    kept: tuple[Any, BoundBody] | None = body._bound
    if kept is None or kept[0] != state or kept[1].body is not body:  # a shallow copy has what its original has
        kept = body._bound = (state, _bound(body, dialect))
    return kept[1]


_DRAWN = frozenset({"drawing", "position", "points", "width", "height", "comment", "global_id"})
"""Fields that change no binding."""


def _content(value: Any) -> Any:
    """Return the present content of a body: it can be changed without notice."""
    if isinstance(value, LateElement):
        value.read()
    if isinstance(value, Model):
        return tuple(
            [
                each if type(each) is str else _content(each)
                for name, each in value.__dict__.items()
                if each and name not in _DRAWN
            ]
        )
    return tuple(map(_content, value)) if isinstance(value, list) else value


def _bound(body: Body, dialect: Dialect) -> BoundBody:
    if isinstance(body, StBody):
        parsed = parse_body(body.text, dialect)
        if not isinstance(parsed.tree, n.Statements):  # of a transition, with nothing around it
            return BoundBody(body, dialect, trees=(parsed.tree,))
        unknown = tuple(UnknownPart(problem.message) for problem in parsed.problems)
        return BoundBody(body, dialect, parsed.tree.statements, parsed.tree.statements, unknown)
    if isinstance(body, FbdBody | LdBody):
        read = body_statements(body, dialect)
        unknown = tuple(UnknownPart(problem.message) for problem in read.obstacles)
        trees = (*read.tree.statements, *(value for _, value in read.open_ends))
        return BoundBody(body, dialect, read.tree.statements, trees, unknown, read.helpers, read.instances)
    if isinstance(body, IlBody):
        trees = tuple(instruction_trees(body.text, dialect))
        operands = (operand for each in instructions(body.text, dialect) for operand in each.operands)
        unknown = tuple(UnknownPart(problem.message) for operand in operands for problem in operand.parsed.problems)
        return BoundBody(body, dialect, trees=trees, unknown=unknown)
    if isinstance(body, SfcBody):
        charts = tuple(ChartTexts(chart, dialect) for chart in charts_inside(body))
        trees = tuple(tree for chart in charts for tree in chart.trees)
        unknown = tuple(UnknownPart(reason) for chart in charts for reason in chart.unknown)
        helpers = tuple(helper for chart in charts for helper in chart.helpers)
        return BoundBody(body, dialect, (), trees, unknown, helpers, charts=charts)
    text = network_statements(body.content) if body.source in SOURCES else None
    if text is not None:
        return replace(_bound(StBody(text=text), dialect), body=body)
    return BoundBody(body, dialect, unknown=(UnknownPart(f"a body in the form of {body.source} cannot be read"),))


def called_actions(body: Body | None, pou: Pou, dialect: Dialect) -> set[str]:
    """The actions of a POU (names in lower case) that a body in it calls, or may call where it cannot be read."""
    if body is None or not pou.actions:  # to read networks takes as long as to draw them
        return set()
    bound = bind(body, dialect)
    own = {"this", "super", pou.name.casefold()}
    called = {path[-1] for path in bound.effects.calls if len(path) == 1 or path[-2] in own}
    called |= {each.name.casefold() for each in bound.uses if each.unread}
    return called & {action.name.casefold() for action in pou.actions}


@cache
def _blank() -> tuple[SfcNetwork, SfcBody]:
    """Return an empty chart and its body, to be copied: `model_construct` takes a hundred times as long."""
    chart = SfcNetwork()
    return chart, SfcBody(chart=chart)


def actions_by_name(pou: Pou | None) -> dict[str, Action]:
    """Return the actions of a POU by their names in small letters."""
    return {action.name.casefold(): action for action in pou.actions} if pou is not None else {}


def step_effects(steps: Sequence[Step], actions: Mapping[str, Action], dialect: Dialect) -> Effects:
    """Effects of all that some steps do, and of the `actions` of their POU that they name or that these call.

    The name in an association is written; an action of the POU is called.
    """
    chart, body = _blank()
    alone = body.model_copy(update={"chart": chart.model_copy(update={"steps": list(steps)})})
    found = [bind(alone, dialect).effects]
    followed: set[str] = set()
    for effects_so_far in found:  # it grows
        for path in sorted(effects_so_far.calls):
            action = actions.get(path[0]) if len(path) == 1 and path[0] not in followed else None
            if action is not None and action.body is not None:
                followed.add(path[0])
                found.append(bind(action.body, dialect).effects)
    every = Effects.all(found)

    def without_actions(paths: frozenset[Path]) -> frozenset[Path]:
        return frozenset(path for path in paths if len(path) != 1 or path[0] not in actions)

    return Effects(without_actions(every.reads), without_actions(every.writes), every.calls)


_RESULT = n.Literal("0")


def instruction_trees(text: str, dialect: Dialect) -> list[n.Expression | n.Statement]:
    """Return a tree for each operand: what writes it, calls it or reads it. Values that are written are not known."""
    trees: list[n.Expression | n.Statement] = []
    for instruction in instructions(text, dialect):
        operator = instruction.operator.upper()
        operands = [operand.parsed.tree for operand in instruction.operands]
        if operator in STORING:
            trees += [n.Assignment(operand, _RESULT) for operand in operands]
        elif operator in CALLS:
            trees += [n.CallStatement(operand) for operand in operands]
        elif instruction.is_function:
            trees.append(n.Call(n.Name(instruction.operator), tuple(n.Argument(operand) for operand in operands)))
        elif operator not in JUMPS:
            trees += operands
    return trees


class ChartTexts:
    """The texts of one chart, without those of the charts in it.

    `trees` are its expressions and statements in no order, `bodies` the actions that are programmed in place.
    `acting` is what naming something as an action does: it is written, or called.
    """

    def __init__(self, chart: SfcNetwork, dialect: Dialect) -> None:
        self.chart = chart
        self._dialect = dialect
        self.trees: list[n.Expression | n.Statement] = []
        self.bodies: list[Body] = []
        self.unknown: list[str] = []
        self.helpers: list[Helper] = []
        self._named_actions: set[Path] = set()
        self._called: set[Path] = set()
        logic = chart_statements(chart, dialect)
        self.trees += logic.tree.statements
        self.unknown += [problem.message for problem in logic.obstacles]
        self.helpers += logic.helpers
        self._conditions(chart)
        self._actions(chart)
        self.acting = Effects(writes=frozenset(self._named_actions), calls=frozenset(self._called))

    def _conditions(self, chart: SfcNetwork) -> None:
        read = condition_reader(chart, self._dialect)
        for condition in chart.conditions():
            found = read(condition)
            self.trees += found.before if found.tree is None else (*found.before, found.tree)
            self.unknown += [problem.message for problem in found.obstacles]
            self.helpers += found.helpers

    def _actions(self, chart: SfcNetwork) -> None:
        for step in chart.steps:
            for action in step.step_actions.values():
                self._action(action)
            self._values(step.min_time, step.max_time, step.warning_time)
            if step.macro is not None and step.macro.body is not None and not isinstance(step.macro.body, SfcBody):
                self.bodies.append(step.macro.body)
        for _, association in chart.associations():
            self._action(association.target)
            self._action(association.body)
            self._values(association.value, association.duration)
            self._action(association.indicator)
        for operation in chart.permanent:
            self._action(operation.body)

    def _action(self, action: str | Body | None) -> None:
        if isinstance(action, str) and action:
            tree = parse_expression(action, self._dialect).tree
            self.trees.append(tree)
            self._named_actions.add(path_of(tree))
            self._called |= calls(n.CallStatement(tree))
        elif action is not None and not isinstance(action, str):
            self.bodies.append(action)

    def _values(self, *texts: str | None) -> None:
        self.trees += [parse_expression(text, self._dialect).tree for text in texts if text]


@dataclass(frozen=True)
class BoundText:
    """A text of the model."""

    text_site: TextSite
    dialect: Dialect

    @cached_property
    def trees(self) -> Sequence[n.Expression | n.Statement]:
        """The expressions and statements of a program text; what cannot be read is `Unreadable` among them."""
        text_site = self.text_site
        if isinstance(text_site.holder, StBody | IlBody | OpaqueBody):
            return bind(text_site.holder, self.dialect).trees
        if text_site.reading not in (SiteKind.STATEMENTS, SiteKind.EXPRESSION):
            return ()
        tree = text_site.parsed(self.dialect).tree
        return tree.statements if isinstance(tree, n.Statements) else (tree,)

    @cached_property
    def uses(self) -> Sequence[Reference]:
        """The name sites of the text."""
        return tuple(references(self.text_site, self.dialect))


def texts_in(thing: Model, dialect: Dialect) -> Iterator[BoundText]:
    """Yield every text in an object of the model that may name something."""
    return (BoundText(text_site, dialect) for text_site in text_sites_in(thing))


def names_in(thing: Model, dialect: Dialect) -> set[str]:
    """Return the names (lower case) in the texts of an object of the model."""
    return {use.name.casefold() for text in texts_in(thing, dialect) for use in text.uses}


def with_called(
    names: Iterable[str], things: Iterable[Action | Method | NamedTransition], dialect: Dialect
) -> set[str]:
    """Return names (lower case) and those in the texts of the things that they name, of what these name, and so on."""
    named, waiting = set(names), list(things)
    while called := [each for each in waiting if each.name.casefold() in named]:
        waiting = [each for each in waiting if each not in called]
        named.update(name for each in called for name in names_in(each, dialect))
    return named


def uncalled_actions(pou: Pou, project: Project) -> list[Action]:
    """Return the actions of a POU that no text names which its bodies or other POUs of the project can execute."""
    dialect = project.dialect
    others = [each for each in project.pous if each.name != pou.name]
    owners = (*pou.bodies, *pou.methods, *pou.transitions, *others) if pou.actions else ()
    named = with_called((name for each in owners for name in names_in(each, dialect)), pou.actions, dialect)
    return [action for action in pou.actions if action.name.casefold() not in named]


def is_named_elsewhere(pou: Pou, project: Project) -> bool:
    """True if the text of another POU names this one, or may do so: ``Main.x``."""
    declared = Declaration(Kind.POU, pou.name, (pou,))
    return any(
        (found.refers_to(declared) or found.may_refer_to(declared))
        for found in Names(project).occurrences(pou.name)
        if found.text_site.site.pou is not None and found.text_site.site.pou.name != pou.name
    )
