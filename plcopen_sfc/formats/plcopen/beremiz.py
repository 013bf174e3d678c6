"""The flavour of TC6 2.01 for Beremiz, OpenPLC and the readers that share their code.

Their charts are drawn plainly (`plcopen_sfc.drawing`): wires with points, no dead jump legs, no nested bars of one
kind, conditions inline, POUs in ``types``. What their converter and matiec do not execute `formats.matiec` has put into
other terms, or refused, before it is written.
"""

from __future__ import annotations

from plcopen_sfc.formats.plcopen.versions import V2_01
from plcopen_sfc.formats.plcopen.writing import Dialect

BEREMIZ = Dialect(version=V2_01)
