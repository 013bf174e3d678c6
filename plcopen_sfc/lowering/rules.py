"""How a chart is lowered: what the user chooses besides the construction."""

from __future__ import annotations

from dataclasses import dataclass

from plcopen_sfc.lowering.texts import Texts
from plcopen_sfc.semantics.profile import Profile


@dataclass(frozen=True)
class LoweringRules:
    """`profile`: what the chart does. `init`: the name of an input that starts the chain anew, None: there is none."""

    profile: Profile
    texts: Texts
    init: str | None = None
