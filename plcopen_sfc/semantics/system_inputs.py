"""Parameters that operate a chart or tell its state, and are no signals of the machine: commands, modes, SFC flags."""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcFlag
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.semantics.charts.graph.graph_parameters import ALL_INPUTS, ALL_OUTPUTS, PARAMETERS
from plcopen_sfc.semantics.profile import Profile

__all__ = ["MEMBER_NAMES", "OUTPUT_NAMES", "PARAMETER_NAMES", "system_inputs"]

_FLAGS = frozenset(flag.variable.casefold() for flag in SfcFlag)
_SEQUENCER = frozenset(name.casefold() for name in ALL_INPUTS)
OUTPUT_NAMES = frozenset(name.casefold() for name in ALL_OUTPUTS)
"""Casefolded names of the outputs by which S7-GRAPH tells the state of a sequence."""
PARAMETER_NAMES = _SEQUENCER | OUTPUT_NAMES
"""Casefolded names of the inputs and outputs by which S7-GRAPH is told what to do with a sequence, and tells its state.
"""
MEMBER_NAMES = frozenset(name.casefold() for name in (*PARAMETERS, "RT_DATA"))
"""Casefolded names of what a block of S7-GRAPH usually has, so that no other variable of the block has such a name."""
_SIGNS = frozenset({"off_sq", "init_sq"})
"""A block without a chart that has one of these is a sequencer that was lowered."""


def system_inputs(pou: Pou, profile: Profile, inputs: Iterable[str]) -> frozenset[str]:
    """Those of `inputs` that operate the chart of `pou`, as they are written there.

    They are the SFC flags of CODESYS (``SFCInit``, ``SFCPause``), wherever they are declared, and under a profile with
    the parameters of S7-GRAPH those parameters of the block (``OFF_SQ``, ``SW_MAN``, ``T_PUSH``). A chart does its work
    while they keep their initial values.
    """
    own = {variable.name.casefold() for variable in pou.variables(SectionKind.INPUT)}
    parameters = (
        own & _SEQUENCER if profile.graph_parameters and (pou.chart is not None or own & _SIGNS) else frozenset()
    )
    return frozenset(
        name for name in inputs if name.casefold() in parameters or name.rpartition(".")[2].casefold() in _FLAGS
    )
