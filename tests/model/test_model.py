"""The model by itself: validation, looking things up, edits, its schema, and what wires mean."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import ModelError
from plcopen_sfc.model.drawing import SymbolKind as K
from plcopen_sfc.model.wiring import Link, trace
from tests.samples import FIXTURE_PARAMS, accepting


def small() -> m.SfcNetwork:
    chart = m.SfcNetwork()
    one, two = chart.add_step("Eins", initial=True), chart.add_step("Zwei")
    chart.add_transition(one, two, "a")
    chart.add_transition(two, one, "b", priority=1)
    return chart


def test_values_are_checked_when_they_are_assigned() -> None:
    step = small().step("Eins")
    with pytest.raises(ModelError):
        step.initial = "vielleicht"  # type: ignore[assignment]
    with pytest.raises(ModelError):
        step.max_time = 5  # type: ignore[assignment]
    with pytest.raises(ModelError):
        step.id = -1
    with pytest.raises(ModelError):
        m.Step(id=1, name="x", colour="red")  # type: ignore[call-arg]
    with pytest.raises(ModelError):
        m.ActionAssociation(id=1, qualifier="Q")  # type: ignore[arg-type]


def test_strings_are_taken_for_conditions_types_and_values() -> None:
    transition = small().transitions[0]
    transition.condition = "x > 3"  # type: ignore[assignment]
    assert transition.condition == m.Expression(text="x > 3")
    assert m.Variable(name="v", type="bool").type == m.ElementaryType(name=m.Elementary.BOOL)  # type: ignore[arg-type]
    assert m.Variable(name="v", type="WSTRING").type == m.StringType(wide=True)  # type: ignore[arg-type]
    assert m.Variable(name="v", type="T_Ofen").type == m.DerivedType(name="T_Ofen")  # type: ignore[arg-type]
    assert m.Variable(name="v", type="INT", initial="7").initial == m.SimpleValue(text="7")  # type: ignore[arg-type]


def test_looking_things_up() -> None:
    chart = small()
    assert chart.step("eins") is chart.step("EINS") is chart.step(chart.steps[0].id)
    assert chart.transition(chart.transitions[1].id) is chart.transitions[1]
    assert chart.initial_steps == [chart.step("Eins")]
    assert chart.outgoing(chart.step("Eins")) == [chart.transitions[0]]
    assert chart.incoming(chart.step("Eins")) == [chart.transitions[1]]
    with pytest.raises(ModelError, match="no step 'Drei'") as caught:
        chart.step("Drei")
    assert "Eins, Zwei" in caught.value.hint
    with pytest.raises(ModelError):
        chart.transition("")
    with pytest.raises(ModelError):
        m.Project().pou("Main")


def test_competing_transitions_are_tried_by_priority_and_then_from_left_to_right() -> None:
    chart = small()
    one, two = chart.steps
    late, early = chart.add_transition(one, two, "c", priority=7), chart.add_transition(one, two, "d", priority=2)
    assert chart.outgoing(one) == [early, late, chart.transitions[0]]


def test_renaming() -> None:
    chart = small()
    assert chart.rename_step("eins", "EINS").new == "EINS"
    assert chart.steps[0].name == "EINS"
    with pytest.raises(ModelError, match="already"):
        chart.rename_step("EINS", "zwei")
    with pytest.raises(ModelError):
        chart.rename_step("Drei", "Vier")
    with pytest.raises(ModelError, match="already"):
        chart.add_step("ZWEI")


def test_new_ids_are_new() -> None:
    chart = small()
    step = chart.add_step("Drei")
    step.actions.append(m.ActionAssociation(id=chart.new_id(), target="q"))
    used = [s.id for s in chart.steps] + [t.id for t in chart.transitions] + [step.actions[0].id]
    assert len(set(used)) == len(used)
    assert chart.new_id() not in used


@pytest.mark.slow
@pytest.mark.parametrize("path", FIXTURE_PARAMS)
def test_json_is_exact(path: object) -> None:
    project = accepting(sfc.load(path))  # type: ignore[arg-type]
    again = sfc.loads(sfc.dumps(project, format="json"))
    assert again == project
    assert sfc.dumps(again, format="json") == sfc.dumps(project, format="json")


def test_json_schema_is_made() -> None:
    schema = m.Project.model_json_schema()
    assert {"Step", "Transition", "SfcNetwork", "ActionAssociation"} <= schema["$defs"].keys()


def test_new_ids_are_not_those_of_step_actions_that_are_drawn() -> None:
    chart = small()
    chart.drawing = m.Drawing(
        symbols=[m.Symbol(id=9, kind=K.ACTION_BLOCK, entries=[m.ActionEntry(association=42, step_action="main")])]  # type: ignore[arg-type]
    )
    assert chart.new_id() == 43


# -- wires ------------------------------------------------------------------------------------------------------------


def links(
    kinds: str, wires: dict[int, list[int]], jumps: dict[int, int | None] | None = None
) -> tuple[object, list[str]]:
    """`kinds`: a letter for each symbol: s(tep) m(acro) t(ransition) j(ump), < > of a selection, { } of branches."""
    letters = {
        "s": K.STEP,
        "m": K.MACRO_STEP,
        "t": K.TRANSITION,
        "j": K.JUMP,
        "<": K.SELECTION_DIVERGENCE,
        ">": K.SELECTION_CONVERGENCE,
        "{": K.SIMULTANEOUS_DIVERGENCE,
        "}": K.SIMULTANEOUS_CONVERGENCE,
    }
    wiring = trace({i: letters[k] for i, k in enumerate(kinds)}, wires, jumps or {})
    return wiring.links, [problem.code for problem in wiring.problems]


def test_wires_of_a_sequence_and_a_loop() -> None:
    assert links("stmt", {1: [0], 2: [1], 3: [2], 0: [3]}) == ({1: [Link((0,), (2,))], 3: [Link((2,), (0,))]}, [])


def test_wires_through_nested_bars_of_one_kind() -> None:
    found, _ = links("s<<tt>>s", {1: [0], 2: [1], 3: [2], 4: [2], 5: [3, 4], 6: [5], 7: [6]})
    assert found == {3: [Link((0,), (7,))], 4: [Link((0,), (7,))]}


def test_wires_of_simultaneous_legs() -> None:
    found, _ = links("st{ss}ts", {1: [0], 2: [1], 3: [2], 4: [2], 5: [3, 4], 6: [5], 7: [6]})
    assert found == {1: [Link((0,), (3, 4))], 6: [Link((3, 4), (7,))]}


def test_steps_that_meet_before_a_transition_are_alternatives() -> None:
    found, _ = links("ss>ts", {2: [0, 1], 3: [2], 4: [3]})
    assert found == {3: [Link((0,), (4,)), Link((1,), (4,))]}


def test_alternatives_before_a_simultaneous_convergence_multiply() -> None:
    found, _ = links("sss>}ts", {3: [0, 1], 4: [3, 2], 5: [4], 6: [5]})
    assert found == {5: [Link((0, 2), (6,)), Link((1, 2), (6,))]}


def test_a_jump_wired_into_a_convergence_leads_nowhere_else() -> None:
    found, codes = links("sttj>s", {1: [0], 2: [0], 3: [2], 4: [1, 3], 5: [4]}, {3: 0})
    assert found == {1: [Link((0,), (5,))], 2: [Link((0,), (0,))]}
    assert codes == []


def test_a_jump_to_a_divergence_leads_to_all_its_steps() -> None:
    found, _ = links("st{sstj", {1: [0], 2: [1], 3: [2], 4: [2], 5: [3], 6: [5]}, {6: 2})
    assert found == {1: [Link((0,), (3, 4))], 5: [Link((3,), (3, 4))]}


def test_what_is_wrong_is_told() -> None:
    assert links("t", {}) == ({0: [Link((), ())]}, ["SFC104"])
    assert links("ss", {1: [0]})[1] == ["SFC106"]
    assert links("stj", {1: [0], 2: [1]}, {2: None})[0] == {1: [Link((0,), ())]}


def test_bars_in_a_circle_come_to_an_end() -> None:
    assert links(">>t", {0: [1], 1: [0], 2: [0]})[1] == ["SFC104"]
    assert links("st<<", {1: [0], 2: [1, 3], 3: [2]})[0] == {1: [Link((0,), ())]}


def test_too_many_alternatives_are_an_error_and_no_hang() -> None:
    width = 13
    kinds = "ss>" * width + "}ts"
    wires = {3 * i + 2: [3 * i, 3 * i + 1] for i in range(width)}
    bar = 3 * width
    wires |= {bar: [3 * i + 2 for i in range(width)], bar + 1: [bar], bar + 2: [bar + 1]}
    assert "SFC105" in links(kinds, wires)[1]
