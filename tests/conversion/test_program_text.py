"""Program text that tools spell differently."""

from __future__ import annotations

import plcopen_sfc as sfc
from plcopen_sfc.analysis.equivalence import equivalent

POWERS = """FUNCTION_BLOCK Main
VAR_INPUT a : BOOL; i : INT; END_VAR
VAR_OUTPUT n : REAL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a AND 2 ** 3 = 8; END_TRANSITION
STEP S1: Act(P1); END_STEP
TRANSITION FROM S1 TO S0 := NOT a; END_TRANSITION
ACTION Act: n := -2.0 ** 2.0 * (n + 1.0) ** 0.5; // ** is a power
END_ACTION
END_FUNCTION_BLOCK
"""


def test_a_power_is_a_function_in_codesys() -> None:
    project = sfc.loads(POWERS.encode(), format="iec-text")
    data, report = sfc.convert(project, "codesys")
    assert report.losses == []
    assert b"EXPT(-2.0, 2.0) * EXPT(n + 1.0, 0.5); // ** is a power" in data
    result = sfc.loads(data, as_tool=True)
    chart = next(result.charts()).network
    assert getattr(chart.transitions[0].condition, "text", "") == "a AND EXPT(2, 3) = 8"
    assert equivalent(project.pou("Main"), result.pou("Main"), ("iec", "codesys"), delay="auto", outputs=["n"], cap=50)
