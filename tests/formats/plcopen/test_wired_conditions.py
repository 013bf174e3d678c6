"""A condition that is wired to nothing is no condition: it is said, and never taken for TRUE."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc

FILLING = Path(__file__).parents[3] / "fixtures" / "plcopen" / "filling_station_2.01.xml"
WIRED = re.compile(
    r"(<condition>\s*<connectionPointIn>(?:\s*<relPosition[^>]*/>)?)\s*<connection .*?</connection>", re.DOTALL
)


@pytest.mark.parametrize(
    ("instead", "code"),
    [(r'\1<connection refLocalId="9901"/>', "SFC102"), (r"\1", "SFC112")],
    ids=["to an element that does not exist", "without a wire"],
)
def test_it_is_an_error(instead: str, code: str) -> None:
    text = FILLING.read_text("utf-8")
    changed, count = WIRED.subn(instead, text, count=1)
    assert count == 1
    assert not [d for d in sfc.load(FILLING).diagnostics if d.code == code]
    [found] = [d for d in sfc.loads(changed.encode()).diagnostics if d.code == code]
    assert found.severity == "error"
    assert found.location.line is not None
    assert "transition" in str(found)
