"""The flavour of TC6 2.01 for Beremiz, OpenPLC and the readers that share their code.

Their charts are drawn plainly (`plcopen_sfc.drawing`): wires with points, no dead jump legs, no nested bars of one
kind, conditions inline, POUs in ``types``. What they do not understand, by what their code generator and matiec accept:
"""

from __future__ import annotations

from plcopen_sfc.formats.plcopen.versions import V2_01
from plcopen_sfc.formats.plcopen.writing import Dialect

BEREMIZ = Dialect(
    version=V2_01,
    names_instances=True,
    lacks={
        "macro-step": "Beremiz does not read macro-steps",
        "chart in an action": "Beremiz reads charts as bodies of POUs only",
        "negated condition": "Beremiz does not see the negation",
        "negated step output": "Beremiz does not see the negation",
        "negated action block": "Beremiz does not see the negation",
        "qualifier DL": "matiec rejects the qualifier DL, which IEC 61131-3 does not have",
    },
)
