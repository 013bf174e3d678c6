"""What a lowered sequencer shows outside: its interface, and the options that make sense for it."""

from __future__ import annotations

import re

from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering.rules import ActionPlace, LoweringRules, States
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.types import DerivedType

_SYSTEM_TYPE = re.compile(r"G7_\w+", re.IGNORECASE)


def without_step_data(pou: Pou) -> Pou:
    """The POU without the variables that TIA Portal declares for steps and transitions, which no other block has."""
    if pou.interface is None:
        return pou
    interface = pou.interface.model_copy(deep=True)
    for section in interface.sections:
        section.variables = [
            v
            for v in section.variables
            if not (isinstance(v.type, DerivedType) and _SYSTEM_TYPE.fullmatch(v.type.name))
        ]
    return pou.model_copy(update={"interface": interface})


def check_rules(rules: LoweringRules) -> None:
    """Refuse options that sequencers do not have. Raises `LoweringError`."""
    if rules.modes:
        hint = "Declare SW_AUTO, SW_MAN, SW_TAP, SW_TOP, T_PUSH, S_SEL, S_ON or S_OFF in the block instead."
        raise LoweringError("sequencers of S7-GRAPH have operating modes of their own", hint=hint)
    if rules.actions is not ActionPlace.INLINE:
        raise LoweringError("actions of a sequencer of S7-GRAPH cannot stand in a block of their own")
    if rules.flags != "local":
        raise LoweringError("the step flags of a sequencer of S7-GRAPH are local variables")
    if rules.states is not States.NUMBERS:
        raise LoweringError("a sequencer of S7-GRAPH is lowered to bits, which have no states to be named")
    if rules.reset_actions:
        raise LoweringError("S in S7-GRAPH sets an operand that anything may reset: only R of the chart ends it")
