"""Code in files is proven as the tool sees it that the file is for, not as our readers restore it."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import Outcome, Verdict
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering.lower import LoweredPou, lower
from plcopen_sfc.lowering.written import prove_written
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.charts import training_chain


def proved(project: m.Project, lowered: LoweredPou, target: str) -> Verdict:
    content = sfc.dumps(lowered.project, format=target)
    seen = sfc.loads(content, format=target, as_tool=True)
    return prove_written(resolve(project, lowered.name), lowered, seen, lambda: sfc.loads(content, format=target))


def chain_in_actions(dialect: m.Dialect) -> m.Project:
    """A chain whose second step calls an action of CODESYS."""
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.steps[1].main_action = "Blink"
    pou.actions = [m.Action(name="Blink", body=m.StBody(text="IF NOT B5 THEN RETURN; END_IF\nQ3 := NOT Q3;"))]
    return m.Project(name="Plant", pous=[pou], dialect=dialect)


def test_actions_that_stand_in_comments_are_no_code() -> None:
    project = chain_in_actions(m.Dialect.CODESYS)
    lowered = lower(project, "case", target="codesys", verify=False)
    assert proved(project, lowered, "codesys").outcome is Outcome.PROVEN
    for target in ("scl", "simaticml"):
        with pytest.raises(LoweringError, match=r"comments or data of ours only.*pous\[Ablauf\]\.actions") as caught:
            proved(project, lowered, target)
        assert caught.value.location.path == "Ablauf"


@pytest.mark.parametrize("style", ["exact", "classic"])
def test_what_only_we_read_proves_nothing(style: str) -> None:
    """The file says one thing, a comment of ours another: the chart is that of the comment."""
    project = m.Project(name="Plant", pous=[training_chain()])
    lowered = lower(project, "case", style=style, target="iec-text", verify=False)
    said = lowered.project.model_copy(deep=True)
    body = said.pous[0].body
    assert isinstance(body, m.StBody)
    body.text = body.text.replace("B3", "NOT B3")
    text = sfc.dumps(said, format="iec-text").decode()
    meant = lowered.pou.body
    assert isinstance(meant, m.StBody)
    pragma = "{plcopen_sfc body.text := '" + meant.text.replace("\n", "$N") + "'}"
    whole = text.replace("FUNCTION_BLOCK Ablauf", f"{pragma}\nFUNCTION_BLOCK Ablauf")
    assert sfc.loads(whole.encode()).pous[0].body == meant
    seen = sfc.loads(whole.encode(), as_tool=True)
    with pytest.raises(LoweringError, match=r"comments or data of ours only.*bodies\[0\]\.text"):
        prove_written(resolve(project), lowered, seen, lambda: sfc.loads(whole.encode()))


def test_code_that_is_simply_wrong_is_told_as_such() -> None:
    project = m.Project(name="Plant", pous=[training_chain()])
    lowered = lower(project, "case", target="plcopen", verify=False)
    wrong = sfc.dumps(lowered.project, format="plcopen-2.01").replace(b"IF B3", b"IF NOT B3")
    with pytest.raises(LoweringError, match="read back, the code does not do what the chart does"):
        prove_written(resolve(project), lowered, sfc.loads(wrong, as_tool=True), lambda: sfc.loads(wrong))
