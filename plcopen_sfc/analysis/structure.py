"""State machines in a net: sets of steps of which exactly one is active in every situation.

They are the place invariants of the net with weights of 0 and 1 and one token (Murata 1989, section VI). Where they
cover all steps, the chart is safe, whatever its size, and however it is built.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.net import Net, NetStep, indexes, mask

_EFFORT = 20_000_000
"""z3's own measure of work for one component: some seconds."""


@dataclass(frozen=True)
class StateMachines:
    """Sets of steps (bits), each with exactly one active step at any time, and the steps that are in none of them."""

    components: tuple[int, ...]
    uncovered: tuple[NetStep, ...]

    @property
    def safe(self) -> bool:
        """Whether this proves that no step gets a second token. If not, the chart may still be safe."""
        return not self.uncovered


def state_machines(chart: SfcNetwork | Net) -> StateMachines:
    """Find state machines that cover as many steps of a chart as possible.

    Rules beyond the net (`Net.hierarchy`) are not obeyed.
    """
    net = chart if isinstance(chart, Net) else Net.of(chart)
    components: list[int] = []
    covered = 0
    uncovered: list[NetStep] = []
    solver, members = _equations(net)
    for step in net.steps:
        if not covered & step.bit:
            found = _component(solver, members, step)
            if found is None:
                uncovered.append(step)
            else:
                components.append(found)
                covered |= found
    return StateMachines(tuple(components), tuple(uncovered))


def _equations(net: Net) -> tuple[Any, list[Any]]:
    """What holds for the steps of a component: each transition gives as many of its tokens as it takes."""
    import z3  # noqa: PLC0415  # takes a tenth of a second

    context = z3.Context()
    solver = z3.Solver(ctx=context)
    solver.set("rlimit", _EFFORT)
    members = [z3.Bool(f"{step.index}", ctx=context) for step in net.steps]
    for transition in net.transitions:
        taken = [members[i] for i in transition.sources if i not in transition.targets]
        given = [members[i] for i in transition.targets if i not in transition.sources]
        if len(taken) == len(given) == 1:
            solver.add(taken[0] == given[0])
        elif taken or given:
            solver.add(z3.PbEq([(m, 1) for m in taken] + [(m, -1) for m in given], 0))
    initial = [members[i] for i in indexes(net.initial)]
    if initial:
        solver.add(z3.PbEq([(m, 1) for m in initial], 1))
    else:
        solver.add(z3.BoolVal(False, ctx=context))
    return solver, members


def _component(solver: Any, members: list[Any], step: NetStep) -> int | None:
    if str(solver.check(members[step.index])) != "sat":
        return None
    model = solver.model()
    return mask(i for i, member in enumerate(members) if str(model.eval(member)) == "True")
