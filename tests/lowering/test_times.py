"""Times of actions: variables, and several for one qualifier."""

from __future__ import annotations

import pytest

from plcopen_sfc import model as m
from tests.lowering.charts import act, boolean, pou_with
from tests.lowering.test_exact import FORMS, verdict

TIMED = [m.Qualifier(name) for name in ("L", "D", "SD", "DS", "SL")]


def two_times(qualifier: m.Qualifier, first: str, second: str) -> m.Pou:
    """Two neighbours with the same action for different times, then a step that resets it."""
    chart = m.SfcNetwork()
    a, b, c = (chart.add_step(name, initial=name == "A") for name in "ABC")
    for number, (source, target) in enumerate([(a, b), (b, c), (c, a)], 1):
        chart.add_transition(source, target, f"c{number}")
    act(chart, a, "Q", qualifier, duration=first)
    act(chart, b, "Q", qualifier, duration=second)
    act(chart, c, "Q", m.Qualifier.R)
    pou = pou_with(chart)
    assert pou.interface is not None
    kind = m.ElementaryType(name=m.Elementary.TIME)
    inner = m.VariableSection(kind=m.SectionKind.LOCAL)
    inner.variables = [m.Variable(name="Long", type=kind, initial=m.SimpleValue(text="T#30ms")), boolean("unused")]
    pou.interface.sections.append(inner)
    return pou


@pytest.mark.parametrize("qualifier", TIMED)
@pytest.mark.parametrize(("first", "second"), [("T#10ms", "T#20ms"), ("T#20ms", "T#10ms"), ("Long", "Long")])
def test_times_of_neighbours(qualifier: m.Qualifier, first: str, second: str) -> None:
    for construction, language in FORMS[1::2]:
        found = verdict(two_times(qualifier, first, second), construction, language, "iec")
        assert found.equal, f"{construction} {language}: {found}"


@pytest.mark.parametrize("qualifier", TIMED)
def test_a_time_that_changes_meanwhile(qualifier: m.Qualifier) -> None:
    pou = two_times(qualifier, "Long", "Long")
    chart = pou.sfc
    assert chart is not None
    chart.steps[0].main_action = m.StBody(text="IF c2 THEN Long := T#10ms; ELSE Long := T#20ms; END_IF;")
    for construction, language in FORMS[::3]:
        found = verdict(pou, construction, language, "codesys")
        assert found.equal, f"{construction} {language}: {found}"
