"""Networks have no IF and CASE: actions with them are drawn by bits, and proven to do the same."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import lower
from tests.lowering.charts import act, boolean, pou_with, training_chain
from tests.sweeps import examples

NUMBER = m.ElementaryType(name=m.Elementary.INT)


def with_action(text: str) -> m.Project:
    """The chain with an action in text, which is executed in its second step."""
    chart = training_chain().sfc
    assert chart is not None
    pou = pou_with(chart)
    assert pou.interface is not None
    pou.interface.sections[1].variables += [boolean("p"), boolean("q"), m.Variable(name="n", type=NUMBER)]
    pou.actions.append(m.Action(name="Look", body=m.StBody(text=text)))
    act(chart, chart.steps[1], "Look")
    return m.Project(pous=[pou])


TEXTS = [
    "IF B5 THEN p := TRUE; q := B1; ELSE p := FALSE; END_IF;",
    "IF B5 THEN p := NOT p; ELSIF p THEN q := TRUE; n := 3; ELSE q := FALSE; END_IF;",
    "IF p THEN p := FALSE; END_IF; IF NOT p AND B5 THEN IF q THEN q := FALSE; ELSE q := B1; p := TRUE; END_IF; END_IF;",
    "CASE n OF 0: n := 1; 1, 2: n := n + 1; p := B5; 3..5: n := 0; ELSE n := 0; END_CASE;",
]


@pytest.mark.slow
@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize("target", ["plcopen-2.01", "simaticml"])
@pytest.mark.parametrize("text", TEXTS)
def test_actions_with_branches_are_drawn(text: str, target: str, language: str) -> None:
    lowered = lower(with_action(text), "flipflop", language=language, target=target)
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN


ASSIGNMENTS = st.sampled_from(["p := TRUE;", "p := FALSE;", "q := NOT q;", "p := q AND B5;", "q := B1 OR p;", ";"])
CONDITIONS = st.sampled_from(["B5", "p", "NOT q", "p AND NOT B1", "B5 OR q"])


def _branched(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    blocks = st.lists(inner, min_size=1, max_size=2).map(" ".join)
    return st.one_of(
        st.builds("IF {} THEN {} END_IF;".format, CONDITIONS, blocks),
        st.builds("IF {} THEN {} ELSE {} END_IF;".format, CONDITIONS, blocks, blocks),
        st.builds("IF {} THEN {} ELSIF {} THEN {} END_IF;".format, CONDITIONS, blocks, CONDITIONS, blocks),
    )


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(20))
@given(st.recursive(ASSIGNMENTS, _branched, max_leaves=6), st.sampled_from(["FBD", "LD"]))
def test_whatever_the_branches_are(text: str, language: str) -> None:
    original = with_action(text)
    lowered = lower(original, "flipflop", language=language, target="plcopen-2.01", verify=False)
    found = equivalent(original, lowered.project, "iec", cap=5_000)
    assert found.kind is VerdictKind.PROVEN, f"{text}: {found}"


def test_what_must_not_be_asked_in_vain_is_refused() -> None:
    """A division by what the condition before has checked."""
    text = "IF n = 0 THEN p := TRUE; q := TRUE; ELSIF 10 / n > 3 THEN p := FALSE; END_IF;"
    with pytest.raises(LoweringError, match="cannot be drawn: IF n = 0 THEN"):
        lower(with_action(text), "flipflop", target="simaticml")
    assert lower(with_action(text), "flipflop", target="codesys").proof is not None
