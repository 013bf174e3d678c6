"""CASE on one variable: for charts of which one step is active at a time.

*Exact*: the transitions first, each branch of the CASE tries those that leave its step; the outputs behind, as
functions of the state, so that no neighbour leaves a gap or an overlap. *Classic* is the textbook form: each branch
executes the actions of its step and then tries its transition, which ends them.
"""

from __future__ import annotations

from plcopen_sfc.analysis.regions import Region, Regions
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.lowering.code import TextNetwork
from plcopen_sfc.lowering.logic import TRUE, is_constant
from plcopen_sfc.lowering.regions import INDENT, RegionChain
from plcopen_sfc.lowering.source import ActionSource, ChartSource, Use
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.semantics.net import NetStep, indexes


def one_step_at_a_time(source: ChartSource) -> str:
    """Why a chart can have several steps active, or none; empty if always exactly one is."""
    initial = [source.net.steps[i].path for i in indexes(source.net.initial)]
    if len(initial) != 1:
        return f"it has {len(initial)} initial steps"
    for transition in source.net.transitions:
        if len(transition.sources) != 1 or len(transition.targets) != 1:
            return f"transition {transition.path} does not lead from one step to one step"
    return ""


class CaseChain(RegionChain):
    """Lowers one chart into `code`. Raises `LoweringError` where several steps can be active."""

    def structure(self, source: ChartSource) -> Regions:
        """All steps in one region, also those that are never active."""
        objection = one_step_at_a_time(source)
        if objection:
            raise LoweringError(f"one CASE cannot hold the chart: {objection}", location=Location(path=source.pou.name))
        net = source.net
        steps, transitions = (tuple(range(len(each))) for each in (net.steps, net.transitions))
        region = Region(0, steps, transitions, block=None, blocks=(), initial=next(indexes(net.initial)))
        return Regions(net, (region,), (), tuple(0 for _ in steps))

    def classic(self) -> None:
        """Each branch: the actions of the step, then its transition."""
        self._initialise(*self._stored())
        lines = [f"CASE {self.text(self.machines[0].state)} OF"]
        for step in self.net.steps:
            lines += self._classic_branch(step)
        self.code.networks.append(TextNetwork(self.texts.chain, "\n".join([*lines, "END_CASE;"])))

    def _initialise(self, *ending: str) -> None:
        if self.init is None:
            return
        lines = [f"IF {self.text(self.init)} THEN", INDENT + self.entered(self.machines[0].first)]
        lines += [INDENT + line for line in ending]
        lines.append("END_IF;")
        self.code.networks.append(TextNetwork(self.texts.init, "\n".join(lines)))

    def _stored(self) -> list[str]:
        """What ends the actions that steps have stored, if starting anew is to end them."""
        if not self.rules.reset_actions:
            return []
        stored = [a for a in self.source.actions if any(use.qualifier is Qualifier.S for use in a.uses)]
        return [f"{self.text(a.target)} := false; // {self.texts.reset_action}" for a in stored if a.target is not None]

    def _classic_branch(self, step: NetStep) -> list[str]:
        used = [
            (action, use)
            for action in self.source.actions
            for use in action.uses
            if use.steps == (step.index,) and not use.inverted
        ]
        lines = [f"{self.text(self.names.step(step.index))}: // {self.heading(step)}"]
        if used:
            lines.append(f"{INDENT}// {self.texts.actions}")
            lines += [INDENT + line for action, use in used for line in self._acting(action, use)]
            lines.append("")
        ending = [line for action, use in used for line in self._ending(action, use)]
        for transition in (self.net.transitions[i] for i in self.net.leaving[step.index]):
            lines.append(f"{INDENT}// {self.texts.transition}")
            lines.append(f"{INDENT}IF {self.text(self.source.conditions[transition.index])} THEN")
            lines += [INDENT * 2 + line for line in ending]
            target = self.net.steps[transition.targets[0]]
            jump = self.texts.jump(
                target.step, initial=bool(self.net.initial & target.bit), back=target.index <= step.index
            )
            lines.append(f"{INDENT * 2}{self.entered(target.index)} // {jump}")
            lines.append(f"{INDENT}END_IF;")
        if len(lines) == 1:
            lines.append(f"{INDENT};")
        return [*lines, ""]

    def _acting(self, action: ActionSource, use: Use) -> list[str]:
        if action.target is None:
            return [self.text(statement) for statement in action.statements]
        target = self.text(action.target)
        conditional = not is_constant(use.condition, TRUE)
        value = self.text(use.condition)
        match use.qualifier:
            case Qualifier.N if conditional:
                return [f"{target} := {value}; // {self.texts.set_while(value)}"]
            case Qualifier.N:
                return [f"{target} := true; // {self.texts.set_action}"]
            case Qualifier.S | Qualifier.R | Qualifier.R0:
                new = f"{target} := {'true' if use.qualifier is Qualifier.S else 'false'};"
                if use.qualifier is not Qualifier.S:
                    new += f" // {self.texts.reset_action}"
                return [f"IF {value} THEN", INDENT + new, "END_IF;"] if conditional else [new]
            case _:
                raise LoweringError(
                    f"the classic form has no place for qualifier {use.qualifier}",
                    location=Location(path=f"action {action.name}"),
                    hint="The exact form has.",
                )

    def _ending(self, action: ActionSource, use: Use) -> list[str]:
        if action.target is None or use.qualifier is not Qualifier.N:
            return []
        return [f"{self.text(action.target)} := false; // {self.texts.reset_actions}"]
