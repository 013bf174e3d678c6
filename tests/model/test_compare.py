"""The places that differences between models are named by."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.compare import differences

SOURCE = """
FUNCTION_BLOCK Tank
VAR_INPUT go : BOOL; END_VAR
VAR level : INT := 3; open : BOOL; END_VAR
INITIAL_STEP Wait:
  Valve(N);
END_STEP
STEP Fill:
  open(N);
END_STEP
TRANSITION FROM Wait TO Fill := go; END_TRANSITION
TRANSITION FROM Fill TO Wait := NOT go; END_TRANSITION
ACTION Valve:
  open := go;
END_ACTION
END_FUNCTION_BLOCK
"""


def _edited(number: int) -> m.Project:
    project = sfc.loads(SOURCE.encode())
    pou = project.pous[0]
    assert pou.sfc is not None
    assert pou.interface is not None
    if number == 0:
        pou.sfc.steps[1].max_time = "T#5s"
    elif number == 1:
        pou.sfc.transitions[0].condition = m.Expression(text="TRUE")
    elif number == 2:
        pou.sfc.steps[1].actions[0].qualifier = m.Qualifier.S
    elif number == 3:
        pou.actions[0].body = m.StBody(text="open := TRUE;")
    elif number == 4:
        pou.interface.variables()[1].initial = m.SimpleValue(text="4")
    elif number == 5:
        pou.interface.sections[0].retain = True
    elif number == 6:
        pou.actions.clear()
    return project


@pytest.mark.parametrize(
    ("number", "path"),
    [
        (0, "POU Tank / step Fill / max time"),
        (1, "POU Tank / transition Wait -> Fill / condition / text"),
        (2, "POU Tank / step Fill / action open / qualifier"),
        (3, "POU Tank / action Valve / text"),
        (4, "POU Tank / level / initial / text"),
        (5, "POU Tank / section 1 / retain"),
        (6, "POU Tank / actions"),
    ],
)
def test_differences_are_named_as_in_reports(number: int, path: str) -> None:
    """Objects stand in the path with their kind and name, never with a field of the model and an index."""
    assert [found.path for found in differences(sfc.loads(SOURCE.encode()), _edited(number))] == [path]


def test_differences_of_keys_are_in_the_order_of_the_keys() -> None:
    left, right = dict.fromkeys("qwertzuiop", "before"), dict.fromkeys("asdfqwert", "after")
    assert "".join(each.path for each in differences(left, right)) == "qwertzuiopasdf"


@pytest.mark.slow
@pytest.mark.parametrize("target", ["simaticml", "scl", "iec-text", "codesys"])
def test_no_report_names_a_place_by_the_fields_of_the_model(target: str) -> None:
    """Every item of a report says which object it is about."""
    for file in ("plcopen/every_element_2.01.xml", "codesys/sorting_conveyor.xml", "simaticml/FB_Drill.xml"):
        report = sfc.convert(sfc.load(f"fixtures/{file}"), target, partial=True)[1]
        assert [item.path for item in report.items if re.search(r"\[\w*\]|\w\.(?:data|type|bodies)\b", item.path)] == []


def test_the_order_of_transitions_differs_whatever_they_lead_to_and_other_ids_are_no_order() -> None:
    """Two that lead to one step were in no order, once it was told by names."""
    text = SOURCE.replace(
        "TRANSITION FROM Fill", "TRANSITION FROM Wait TO Fill := open; END_TRANSITION TRANSITION FROM Fill"
    )
    one, other = (sfc.loads(text.encode(), format="iec-text") for _ in range(2))
    first, second, _ = transitions = other.pous[0].chart.transitions
    transitions[:2] = [second, first]
    assert {each.path.rpartition(" / ")[0] for each in differences(one, other)} == {
        "POU Tank / order of transitions / Wait"
    }
    transitions[:2] = [first, second]
    for each in transitions:
        each.id += 100
    assert not [each for each in differences(one, other) if "order" in each.path]
