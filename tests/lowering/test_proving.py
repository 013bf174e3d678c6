"""Where there can be no proof, the error says why, and what to do about it."""

from __future__ import annotations

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering.lower import lower
from tests.lowering.charts import training_chain


def test_texts_that_are_wrong_in_their_types_are_no_error_of_the_lowering() -> None:
    pou = training_chain()
    assert pou.interface is not None
    number = next(variable for variable in pou.interface.variables() if variable.name == "B1")
    number.type = m.ElementaryType(name=m.Elementary.DINT)
    chart = pou.sfc
    assert chart is not None
    chart.transitions[0].condition = m.Expression(text="B1 + 1")
    with pytest.raises(LoweringError, match=r"cannot be compared with the chart: .*BOOL") as caught:
        lower(pou, "bits", profile="iec")
    assert "--no-verify" in str(caught.value)
    assert lower(pou, "bits", profile="iec", verify=False).proof is None


def test_functions_that_nobody_knows_prevent_the_proof_only() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.transitions[0].condition = m.Expression(text="Weigh(B1) > 3")
    with pytest.raises(LoweringError, match=r"cannot be compared with the chart: .*Weigh"):
        lower(pou, "case", profile="iec")
    body = lower(pou, "case", profile="iec", verify=False).pou.body
    assert isinstance(body, m.StBody)
    assert "Weigh(B1) > 3" in body.text
