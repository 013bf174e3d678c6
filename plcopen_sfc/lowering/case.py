"""CASE on one variable: for charts of which one step is active at a time.

*Exact*: the transitions first, each branch of the CASE tries those that leave its step; the outputs behind, as
functions of the state, so that no neighbour leaves a gap or an overlap. *Classic* is the textbook form: each branch
executes the actions of its step and then tries its transition, which ends them.
"""

from __future__ import annotations

from collections.abc import Mapping

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Expression, Operator
from plcopen_sfc.lowering.chain import Chain
from plcopen_sfc.lowering.code import TextNetwork
from plcopen_sfc.lowering.logic import TRUE, is_constant
from plcopen_sfc.lowering.source import ActionSource, ChartSource, Use
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.types import Elementary, ElementaryType
from plcopen_sfc.semantics.net import Net, NetStep, Rivals, indexes
from plcopen_sfc.semantics.profile import ScanOrder

_INDENT = "    "


def one_step_at_a_time(source: ChartSource) -> str:
    """Why a chart can have several steps active, or none; empty if always exactly one is."""
    initial = [source.net.steps[i].path for i in indexes(source.net.initial)]
    if len(initial) != 1:
        return f"it has {len(initial)} initial steps"
    for transition in source.net.transitions:
        if len(transition.sources) != 1 or len(transition.targets) != 1:
            return f"transition {transition.path} does not lead from one step to one step"
    return ""


def _numbered(net: Net) -> list[int]:
    """The state of each step: its number where all steps have one of their own, else counted from 1."""
    own = [step.step.number for step in net.steps]
    if None not in own and len(set(own)) == len(own):
        return [number for number in own if number is not None]
    return list(range(1, len(own) + 1))


class CaseChain(Chain):
    """Lowers one chart into `code`. Raises `LoweringError` where several steps can be active."""

    def declare_states(self, source: ChartSource) -> None:
        """The number of the active step, that of the initial step at the start."""
        objection = one_step_at_a_time(source)
        if objection:
            raise LoweringError(f"one CASE cannot hold the chart: {objection}", location=Location(path=source.pou.name))
        self._numbers = _numbered(source.net)
        self._initial = str(self._numbers[next(indexes(source.net.initial))])
        kind = ElementaryType(name=Elementary.INT)
        comment = self.texts.state_comment
        self._state = self.code.declare(self.texts.state, kind, initial=self._initial, comment=comment)

    def active(self, step: int) -> Expression:
        """A comparison of the state."""
        return n.Operation(Operator.EQUAL, (self._state, n.Literal(str(self._numbers[step]))))

    def move(self) -> None:
        """Nothing: the CASE has moved already."""

    def reentered(self) -> Mapping[int, Expression]:
        """Nothing tells: where it matters the chart is refused."""
        return {}

    def tells(self) -> dict[str, Expression]:
        """The state, unless the CASE stands behind the actions: then it is that of the next scan already."""
        return super().tells() if self.profile.order is ScanOrder.TRANSITIONS_FIRST else {}

    def choose(self) -> None:
        """Append the CASE with the transitions of each step."""
        lines = [f"CASE {self._text(self._state)} OF"]
        for step in self.net.steps:
            lines.append(f"{_INDENT}{self._numbers[step.index]}: // {self._heading(step)}")
            lines += [_INDENT * 2 + line for line in self._choice(step)]
        lines.append("END_CASE;")
        if self.init is not None:
            lines = [
                *(f"IF {self._text(self.init)} THEN", _INDENT + self._assigned(self._initial), "ELSE"),
                *(_INDENT + line for line in lines),
                "END_IF;",
            ]
        self.code.networks.append(TextNetwork(self.texts.chain, "\n".join(lines)))

    def classic(self) -> None:
        """Each branch: the actions of the step, then its transition."""
        self._initialise()
        lines = [f"CASE {self._text(self._state)} OF"]
        for step in self.net.steps:
            lines += self._classic_branch(step)
        self.code.networks.append(TextNetwork(self.texts.chain, "\n".join([*lines, "END_CASE;"])))

    def _text(self, node: n.Node) -> str:
        return print_node(node, self.source.dialect)

    def _assigned(self, state: str) -> str:
        return f"{self._text(self._state)} := {state};"

    def _choice(self, step: NetStep) -> list[str]:
        """The transitions that leave a step, as IF and ELSIF in the order in which they are tried."""
        leaving = [self.net.transitions[i] for i in self.net.leaving[step.index]]
        if not leaving:
            return [";"]
        if self.profile.rivals is not Rivals.PRIORITY and len(leaving) > 1:
            raise LoweringError(
                f"one CASE cannot hold rivals that fire together under the profile {self.profile.name}",
                location=Location(path=f"step {step.path}"),
            )
        lines: list[str] = []
        for transition in leaving:
            word = "ELSIF" if lines else "IF"
            lines.append(f"{word} {self._text(self.source.conditions[transition.index])} THEN")
            lines.append(_INDENT + self._assigned(str(self._numbers[transition.targets[0]])))
        return [*lines, "END_IF;"]

    def _heading(self, step: NetStep) -> str:
        return self.texts.step(step.step, step.path, initial=bool(self.net.initial & step.bit))

    # -- classic

    def _initialise(self) -> None:
        if self.init is None:
            return
        lines = [f"IF {self._text(self.init)} THEN", _INDENT + self._assigned(self._initial), "END_IF;"]
        self.code.networks.append(TextNetwork(self.texts.init, "\n".join(lines)))

    def _classic_branch(self, step: NetStep) -> list[str]:
        used = [
            (action, use)
            for action in self.source.actions
            for use in action.uses
            if use.steps == (step.index,) and not use.inverted
        ]
        lines = [f"{self._numbers[step.index]}: // {self._heading(step)}"]
        if used:
            lines.append(f"{_INDENT}// {self.texts.actions}")
            lines += [_INDENT + line for action, use in used for line in self._acting(action, use)]
            lines.append("")
        ending = [line for action, use in used for line in self._ending(action, use)]
        for transition in (self.net.transitions[i] for i in self.net.leaving[step.index]):
            lines.append(f"{_INDENT}// {self.texts.transition}")
            lines.append(f"{_INDENT}IF {self._text(self.source.conditions[transition.index])} THEN")
            lines += [_INDENT * 2 + line for line in ending]
            target = self.net.steps[transition.targets[0]]
            jump = self.texts.jump(
                target.step, initial=bool(self.net.initial & target.bit), back=target.index <= step.index
            )
            lines.append(f"{_INDENT * 2}{self._assigned(str(self._numbers[target.index]))} // {jump}")
            lines.append(f"{_INDENT}END_IF;")
        if len(lines) == 1:
            lines.append(f"{_INDENT};")
        return [*lines, ""]

    def _acting(self, action: ActionSource, use: Use) -> list[str]:
        if action.target is None:
            return [self._text(statement) for statement in action.statements]
        target = self._text(action.target)
        conditional = not is_constant(use.condition, TRUE)
        value = self._text(use.condition)
        match use.qualifier:
            case Qualifier.N if conditional:
                return [f"{target} := {value}; // {self.texts.set_while(value)}"]
            case Qualifier.N:
                return [f"{target} := true; // {self.texts.set_action}"]
            case Qualifier.S | Qualifier.R | Qualifier.R0:
                new = f"{target} := {'true' if use.qualifier is Qualifier.S else 'false'};"
                if use.qualifier is not Qualifier.S:
                    new += f" // {self.texts.reset_action}"
                return [f"IF {value} THEN", _INDENT + new, "END_IF;"] if conditional else [new]
            case _:
                raise LoweringError(
                    f"the classic form has no place for qualifier {use.qualifier}",
                    location=Location(path=f"action {action.name}"),
                    hint="The exact form has.",
                )

    def _ending(self, action: ActionSource, use: Use) -> list[str]:
        if action.target is None or use.qualifier is not Qualifier.N:
            return []
        return [f"{self._text(action.target)} := false; // {self.texts.reset_actions}"]
