"""CASE on one variable: for charts of which one step is active at a time.

*Exact*: the transitions first, each branch of the CASE tries those that leave its step; the outputs behind, as
functions of the state, so that no neighbour leaves a gap or an overlap. *Classic* is the textbook form: each branch
executes the actions of its step and then tries its transition, which ends them.
"""

from __future__ import annotations

from plcopen_sfc.analysis.regions import Regions
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.lowering.chains.chain import refuse_classic
from plcopen_sfc.lowering.chains.machines import INDENT, one_region
from plcopen_sfc.lowering.chains.regions import RegionChain
from plcopen_sfc.lowering.code.emitting import comment_lines
from plcopen_sfc.lowering.code.logic import TRUE, is_constant
from plcopen_sfc.lowering.code.program import TextNetwork
from plcopen_sfc.lowering.reading.source import ActionSource, ChartSource, Use
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.semantics.net import NetStep, indexes

_STORED = (Qualifier.S, Qualifier.R, Qualifier.R0)


def one_step_at_a_time(source: ChartSource) -> str:
    """Why a chart can have several steps active, or none at the start; empty if it is one, until the chart ends."""
    initial = [source.net.steps[i].path for i in indexes(source.net.initial)]
    if len(initial) != 1:
        return f"it has {len(initial)} initial steps"
    for transition in source.net.transitions:
        if len(transition.sources) != 1 or len(transition.targets) > 1:
            return f"transition {transition.path} does not lead from one step to one step"
    return ""


class CaseChain(RegionChain):
    """Lowers one chart into `code`. Raises `LoweringError` where several steps can be active."""

    def structure(self, source: ChartSource) -> Regions:
        """All steps in one region, also those that are never active."""
        objection = one_step_at_a_time(source)
        if objection:
            raise LoweringError(f"one CASE cannot hold the chart: {objection}", location=Location(path=source.pou.name))
        return one_region(source.net)

    def classic(self) -> None:
        """Each branch: the actions of the step, then its transitions. `LoweringError` for what it cannot hold."""
        self._check_classic()
        self.begin_classic()
        self._initialise(*self._stored())
        lines = [f"CASE {self.text(self.machines[0].state)} OF"]
        for step in self.net.steps:
            lines += self._classic_branch(step)
        self.code.networks.append(TextNetwork(self.texts.chain, "\n".join([*lines, "END_CASE;"])))

    def _initialise(self, *ending: str) -> None:
        if self.init is None:
            return
        lines = [f"IF {self.text(self.init)} THEN", INDENT + self.states.entered(self.machines[0].first)]
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
        used = [(action, use) for action in self.source.actions for use in action.uses if step.index in use.steps]
        acts = [self.text(each) for code in self.source.step_code if code.step == step.index for each in code.main]
        done = [*acts]
        lines = [f"{self.text(self.names.step(step.index))}: // {self.states.heading(step)}"]
        lines += [INDENT + remark for remark in self.states.remarks(step.step)]
        for action, use in used:
            acting = self._acting(action, use)
            acts += acting
            done += [*comment_lines(self.texts.said(action.comment, use.comment)), *acting]
        if done:
            lines.append(f"{INDENT}// {self.texts.actions}")
            lines += [INDENT + line for text in done for line in text.splitlines()]
            lines.append("")
        ending = [line for action, use in used for line in self._ending(action, use)]
        transitions = self._classic_transitions(step, ending)
        if not (acts or transitions):  # some tools want a statement in every branch
            transitions = [";"]
        lines += [INDENT + line for line in transitions]
        return [*lines, ""]

    def _classic_transitions(self, step: NetStep, ending: list[str]) -> list[str]:
        """The transitions behind a step, in the order in which they are tried; each ends the actions of the step."""
        leaving = [self.net.transitions[i] for i in self.net.leaving[step.index]]
        before = [self.text(each) for t in leaving for each in self.source.preparations[t.index]]
        lines = [line for text in before for line in text.splitlines()]
        word = "IF"
        for transition in leaving:
            target = self.net.steps[transition.targets[0]]
            initial = bool(self.net.initial & target.bit)
            jump = self.texts.jump(target.step, initial=initial, back=target.index <= step.index)
            lines += [f"// {self.texts.transition}", *self.states.remarks(transition.transition)]
            lines.append(f"{word} {self.text(self.source.conditions[transition.index])} THEN")
            lines += [INDENT + line for line in ending]
            lines.append(f"{INDENT}{self.states.entered(target.index)} // {jump}")
            word = "ELSIF"
        return [*lines, "END_IF;"] if leaving else lines

    def _check_classic(self) -> None:
        """Refuse what the branches of a textbook CASE cannot hold."""
        if self.modes.selecting is not None:
            refuse_classic(self.source, "selecting steps")
        for transition in self.net.transitions:
            if not transition.targets:
                refuse_classic(self.source, "the end of a chart", f"transition {transition.path}")
        for code in self.source.step_code:
            if code.entry or code.exit:
                path = self.net.steps[code.step].path
                refuse_classic(self.source, "entry and exit actions", f"step {path}")
        for action in self.source.actions:
            for use in action.uses:
                if use.preparation:
                    refuse_classic(self.source, "blocks with a state in conditions", f"action {action.name}")
                plain = use.qualifier in (Qualifier.N, Qualifier.NONE)
                if use.inverted or not (plain or (action.target is not None and use.qualifier in _STORED)):
                    what = "an action of all other steps" if use.inverted else f"qualifier {use.qualifier}"
                    refuse_classic(self.source, what, f"action {action.name}")

    def _acting(self, action: ActionSource, use: Use) -> list[str]:
        conditional = not is_constant(use.condition, TRUE)
        value = self.text(use.condition)
        if action.target is None:
            lines = [self.text(statement) for statement in action.statements]
            if conditional:
                return [f"IF {value} THEN", *(INDENT + x for text in lines for x in text.splitlines()), "END_IF;"]
            return lines
        target = self.text(action.target)
        if use.qualifier in _STORED:
            new = f"{target} := {'true' if use.qualifier is Qualifier.S else 'false'};"
            if use.qualifier is not Qualifier.S:
                new += f" // {self.texts.reset_action}"
            return [f"IF {value} THEN", INDENT + new, "END_IF;"] if conditional else [new]
        if conditional:
            return [f"{target} := {value}; // {self.texts.set_while(value)}"]
        return [f"{target} := true; // {self.texts.set_action}"]

    def _ending(self, action: ActionSource, use: Use) -> list[str]:
        if action.target is None or use.qualifier in _STORED:
            return []
        return [f"{self.text(action.target)} := false; // {self.texts.reset_actions}"]
