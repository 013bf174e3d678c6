"""Names of variables that are keywords of SCL."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc

TEXT = """FUNCTION_BLOCK Main
VAR_INPUT {name} : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := {name}; END_TRANSITION
STEP S1: q(N); END_STEP
TRANSITION FROM S1 TO S0 := NOT {name}; END_TRANSITION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(
    ("name", "quoted"), [(n, True) for n in ("Begin", "Region", "Label", "Any", "DB")] + [("a", False)]
)
def test_a_keyword_is_in_quotes_where_it_is_declared_and_used(name: str, quoted: bool) -> None:
    project = sfc.loads(TEXT.format(name=name).encode(), format="iec-text")
    text = sfc.dumps(sfc.lower(project, "flipflop", pou="Main", target="scl", verify=False).project, format="scl")
    found = re.findall(rf'#?"?\b{name}\b"?', "\n".join(x for x in text.decode().splitlines() if "//" not in x))
    shown = f'"{name}"' if quoted else name
    assert len(found) > 1
    assert set(found) == {shown, f"#{shown}"}
