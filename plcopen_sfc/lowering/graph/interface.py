"""What a lowered sequencer shows outside: its interface."""

from __future__ import annotations

import re

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
