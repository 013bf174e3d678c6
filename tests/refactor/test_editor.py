"""Edits: what they do, what they refuse, and that all or nothing of them happens."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import jump, selection, simultaneous, step
from plcopen_sfc import model as m
from plcopen_sfc.errors import ArgumentError, ModelError
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.model import Dialect
from plcopen_sfc.model.late import models_in
from plcopen_sfc.refactor.editor import Editor
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from tests.samples import FIXTURES


def plant() -> sfc.Project:
    project = sfc.Project(name="Plant")
    pou = project.add_program(
        "Main",
        step("Wait", initial=True),
        "Start",
        step("Fill", actions=["N Valve", ("N Pour", "Pump := NOT Empty;")]),
        selection(
            [
                "Full OR Stop",
                simultaneous([step("Heat"), "Hot", step("Keep")], [step("Mix", actions=["N Mixer"])]),
                "Done",
            ],
            ["Fault", step("Alarm", actions=["N Horn"]), "Ack"],
        ),
        step("Drain", actions=["N Outlet"]),
        "Empty AND Drain.T > T#2s",
        jump("Wait"),
    )
    for name in ("Pump", "Spare"):
        pou.add_variable(name)
    return project


def labels(project: sfc.Project) -> list[str]:
    chart = project.pou("Main").chart
    assert chart is not None
    texts = {t.id: getattr(t.condition, "text", getattr(t.condition, "name", "?")) for t in chart.transitions}
    return [f"{label}: {texts[number]}" for number, label in chart.labels().items()]


def link(project: sfc.Project, label: str) -> sfc.Transition:
    chart = project.pou("Main").chart
    assert chart is not None
    return chart.transition(label)


def find(project: sfc.Project, name: str) -> sfc.Step:
    return next(each for each in project.steps(name=name))


WHOLE = [
    "Wait -> Fill: Start",
    "Fill -> Heat+Mix: Full OR Stop",
    "Heat -> Keep: Hot",
    "Keep+Mix -> Drain: Done",
    "Fill -> Alarm: Fault",
    "Alarm -> Drain: Ack",
    "Drain -> Wait: Empty AND Drain.T > T#2s",
]

EDITS: dict[str, tuple[Callable[[Editor, sfc.Project], Any], dict[str, list[str]]]] = {
    "insert behind": (
        lambda e, p: e.insert_step("Rest", link(p, "Wait -> Fill"), "Go", actions=["N Lamp"]),
        {"Wait -> Fill: Start": ["Wait -> Rest: Start", "Rest -> Fill: Go"]},
    ),
    "insert before": (
        lambda e, p: e.insert_step("Rest", link(p, "Fill -> Alarm"), before=True),
        {"Fill -> Alarm: Fault": ["Fill -> Rest: TRUE", "Rest -> Alarm: Fault"]},
    ),
    "insert behind a divergence": (
        lambda e, p: e.insert_step("Rest", link(p, "Fill -> Heat+Mix"), "Go"),
        {"Fill -> Heat+Mix: Full OR Stop": ["Fill -> Rest: Full OR Stop", "Rest -> Heat+Mix: Go"]},
    ),
    "delete, incoming": (
        lambda e, p: e.delete_step("Main.Alarm", "incoming"),
        {"Fill -> Alarm: Fault": ["Fill -> Drain: Fault"], "Alarm -> Drain: Ack": []},
    ),
    "delete, both": (
        lambda e, p: e.delete_step("Main.Heat", "both"),
        {"Fill -> Heat+Mix: Full OR Stop": ["Fill -> Keep+Mix: (Full OR Stop) AND Hot"], "Heat -> Keep: Hot": []},
    ),
    "delete before a join": (
        lambda e, p: e.delete_step("Main.Keep", "outgoing"),
        {"Heat -> Keep: Hot": [], "Keep+Mix -> Drain: Done": ["Heat+Mix -> Drain: Done"]},
    ),
    "split": (
        lambda e, p: e.split_transition(link(p, "Fill -> Heat+Mix")),
        {"Fill -> Heat+Mix: Full OR Stop": ["Fill -> Heat+Mix: Full", "Fill -> Heat+Mix (2): Stop"]},
    ),
    "retarget": (
        lambda e, p: e.retarget("Main.Drain", "Main.Wait", [link(p, "Alarm -> Drain")]),
        {"Alarm -> Drain: Ack": ["Alarm -> Wait: Ack"]},
    ),
    "remove a branch of a selection": (
        lambda e, p: e.remove_branch(link(p, "Fill -> Alarm")),
        {"Fill -> Alarm: Fault": [], "Alarm -> Drain: Ack": []},
    ),
    "remove simultaneous sequences": (
        lambda e, p: e.remove_branch(link(p, "Fill -> Heat+Mix")),
        {"Fill -> Heat+Mix: Full OR Stop": [], "Heat -> Keep: Hot": [], "Keep+Mix -> Drain: Done": []},
    ),
    "remove a simultaneous branch": (
        lambda e, p: e.remove_branch("Main.Heat"),
        {
            "Fill -> Heat+Mix: Full OR Stop": ["Fill -> Mix: Full OR Stop"],
            "Heat -> Keep: Hot": [],
            "Keep+Mix -> Drain: Done": ["Mix -> Drain: Done"],
        },
    ),
    "extract a condition": (
        lambda e, p: e.extract_condition(link(p, "Drain -> Wait"), "IsEmpty"),
        {"Drain -> Wait: Empty AND Drain.T > T#2s": ["Drain -> Wait: IsEmpty"]},
    ),
    "rename": (
        lambda e, p: e.rename("Main.Drain", "Out"),
        {
            "Keep+Mix -> Drain: Done": ["Keep+Mix -> Out: Done"],
            "Alarm -> Drain: Ack": ["Alarm -> Out: Ack"],
            "Drain -> Wait: Empty AND Drain.T > T#2s": ["Out -> Wait: Empty AND Out.T > T#2s"],
        },
    ),
    "replace a variable": (
        lambda e, p: e.replace_variable("Main.Full", "Main.Hot"),
        {"Fill -> Heat+Mix: Full OR Stop": ["Fill -> Heat+Mix: Hot OR Stop"]},
    ),
    "move to a macro-step": (
        lambda e, p: e.move_to_macro([find(p, "Heat"), find(p, "Keep")], "Warm"),
        {
            "Fill -> Heat+Mix: Full OR Stop": ["Fill -> Warm+Mix: Full OR Stop"],
            "Heat -> Keep: Hot": [],
            "Keep+Mix -> Drain: Done": ["Warm+Mix -> Drain: Done"],
        },
    ),
    "number the names": (lambda e, p: e.renumber(10, 10, names="S{number}"), {}),
    "set times": (lambda e, p: e.set(p.steps(drives="*Valve*"), max_time="T#30s"), {}),
}


@pytest.mark.parametrize("name", EDITS)
def test_an_edit_changes_what_it_is_for_and_can_be_undone(name: str) -> None:
    project = plant()
    assert labels(project) == WHOLE
    before, steps = project.model_dump(), list(project.steps())
    edit = project.edit()
    do, changed = EDITS[name]
    do(edit, project)
    if changed:
        assert labels(project) == [line for old in WHOLE for line in changed.get(old, [old])]
    assert project.model_dump() != before
    edit.undo()
    assert project.model_dump() == before
    assert all(one is other for one, other in zip(project.steps(), steps, strict=True))
    assert all(each.chart is project.pou("Main").chart for each in steps)
    with pytest.raises(ModelError, match="nothing to undo"):
        edit.undo()


REFUSED: list[tuple[Callable[[Editor, sfc.Project], Any], str]] = [
    (lambda e, p: e.insert_step("fill", link(p, "Wait -> Fill")), "has a step 'fill' already"),
    (lambda e, p: e.insert_step("Rest", link(p, "Wait -> Fill"), maxtime="T#1s"), "did you mean 'max_time'"),
    (lambda e, p: e.delete_step("Main.Alarm"), "is between other steps"),
    (lambda e, p: e.delete_step("Main.Wait", "both"), "it is the initial step"),
    (lambda e, p: e.delete_step("Main.Drain", "both"), "named in Main / transition .*Drain.T"),
    (lambda e, p: e.delete_step("Main.Alarm", "all"), "none of incoming, outgoing and both"),
    (lambda e, p: e.delete_step("Main.Keep", "incoming"), "waits for other steps too"),
    (lambda e, p: e.delete_step("Main.Alrm", "both"), "declares no 'Main.Alrm'"),
    (lambda e, p: e.split_transition(link(p, "Wait -> Fill")), "has no OR"),
    (lambda e, p: e.join_transitions([link(p, "Wait -> Fill"), link(p, "Fill -> Alarm")]), "between the same steps"),
    (lambda e, p: e.retarget("Main.Drain", "Main.Wait", [link(p, "Wait -> Fill")]), "does not lead to 'Drain'"),
    (lambda e, p: e.remove_branch(link(p, "Wait -> Fill")), "no other transition leaves"),
    (lambda e, p: e.remove_branch("Main.Drain"), "does not begin simultaneous sequences"),
    (
        lambda e, p: e.extract_condition(link(p, "Wait -> Fill"), "Valve"),
        "variable Main.Valve has this name already",
    ),
    (lambda e, p: e.extract_condition(link(p, "Wait -> Fill"), "IF"), "cannot be a name"),
    (lambda e, p: e.inline_condition(link(p, "Wait -> Fill")), "names no transition"),
    (lambda e, p: e.extract_action("Main.Fill", "Do", 0), "no code in place"),
    (lambda e, p: e.replace_variable("Main.Full", "Main.Fill"), "step Main.Fill is no variable"),
    (lambda e, p: e.set(p.steps(), name="X"), "Use rename"),
    (lambda e, p: e.set(p.steps(), max_time="5 s"), "cannot be '5 s'"),
    (lambda e, p: e.set(p.steps(), maxtime="T#5s"), "did you mean 'max_time'"),
    (lambda e, p: e.set(find(p, "Fill").actions, qualifier="D"), "D needs a duration"),
    (lambda e, p: e.move_to_macro([find(p, "Wait"), find(p, "Fill")], "M"), "initial step is among them"),
    (lambda e, p: e.move_to_macro([find(p, "Heat"), find(p, "Alarm")], "M"), "entered at 2 steps"),
    (lambda e, p: e.move_to_macro([find(p, "Fill"), find(p, "Alarm")], "M"), "left at 2"),
    (lambda e, p: e.dissolve_macro("Main.Fill"), "no chart of its own"),
    (lambda e, p: e.renumber(charts=[p.pou("Main").chart]), "have no numbers"),  # type: ignore[list-item]
    (lambda e, p: e.renumber(names="S"), "gets this name too"),
    (lambda e, p: e.renumber(names="S{no}"), "is no form of names"),
    (lambda e, p: e.renumber(names="S{number:0999999999}"), "is no form of names"),
    (lambda e, p: e.add_branch(find(p, "Fill"), "x", step("New"), "y"), "ends with a step or a jump"),
    (lambda e, p: e.copy_pou(plant(), "Main"), "has a POU 'Main' already"),
    (lambda e, p: e.set(sfc.Step(id=1, name="A"), targets=[1]), "Use retarget"),
    (lambda e, p: e.delete_step(sfc.Step(id=1, name="A")), "is not in this project"),
    (lambda e, p: e.renumber(), "no step has a number"),
    (lambda e, p: e.insert_step("", link(p, "Wait -> Fill"), "Full"), "a step needs a name"),
    (lambda e, p: e.join_transitions([]), "no transitions to join"),
]


@pytest.mark.parametrize("number", range(len(REFUSED)))
def test_a_refused_edit_changes_nothing(number: int) -> None:
    do, message = REFUSED[number]
    project = plant()
    before = project.model_dump()
    with pytest.raises(ModelError, match=message):
        do(project.edit(), project)
    assert project.model_dump() == before


@pytest.mark.parametrize(
    ("edit", "given"),
    [
        *(("rename", 2), ("replace_variable", 2), ("set", 1), ("insert_step", 2), ("delete_step", 1), ("renumber", 1)),
        *(("split_transition", 1), ("join_transitions", 1), ("retarget", 2), ("add_branch", 1), ("remove_branch", 1)),
        *(
            ("extract_condition", 2),
            ("inline_condition", 1),
            ("extract_action", 2),
            ("inline_action", 1),
            ("redraw", 1),
        ),
        *(("use_iec_steps", 1), ("use_simple_steps", 1), ("move_to_macro", 2), ("dissolve_macro", 1), ("copy_pou", 2)),
        *(("move_to_action", 3), ("move_to_block", 3), ("dissolve_chart", 1)),
        *(("rename_many", 1), ("redraw", 1)),
    ],
)
@pytest.mark.parametrize("value", [None, 5.5, object()], ids=["None", "number", "object"])
def test_arguments_of_other_types_are_refused(edit: str, given: int, value: object) -> None:
    project = plant()
    with pytest.raises(ArgumentError, match=f"{edit} needs as "):
        getattr(project.edit(), edit)(*[value] * given)


@pytest.mark.parametrize(
    ("do", "message"),
    [
        (lambda e, p: e.renumber(charts=p.pou("Main").chart), "renumber needs as charts: Iterable of SfcNetwork"),
        (lambda e, p: e.renumber(charts="Main"), "renumber needs as charts: "),  # type: ignore[arg-type]
        (lambda e, p: e.renumber(charts=[None]), "renumber needs as charts: "),  # type: ignore[list-item]
        (lambda e, p: e.set([5], max_time="T#5s"), "set needs as things: "),  # type: ignore[list-item]
        (lambda e, p: e.retarget("Main.Wait", "Main.Fill", link(p, "Wait -> Fill")), "retarget needs as links: "),  # type: ignore[arg-type]
    ],
)
def test_lists_of_other_things_are_refused(do: Callable[[Any, sfc.Project], object], message: str) -> None:
    project = plant()
    with pytest.raises(ArgumentError, match=message):
        do(project.edit(), project)


@pytest.mark.parametrize("options", [{"limit": ["5s"]}, {"clean": "x"}, {"prove": "x"}], ids=str)
def test_editors_refuse_options_of_other_types(options: dict[str, Any]) -> None:
    with pytest.raises(ArgumentError):
        plant().edit(**options)


def test_steps_are_set_and_moved_by_their_paths() -> None:
    project = plant()
    project.edit().set("Main.Heat", max_time="T#9s")
    assert find(project, "Heat").max_time == "T#9s"
    by_path, by_object = plant(), plant()
    by_path.edit().move_to_macro(["Main.Heat"], "Warm")
    by_object.edit().move_to_macro([find(by_object, "Heat")], "Warm")
    assert by_path.model_dump() == by_object.model_dump()


@pytest.mark.parametrize(
    "edit", [lambda e: e.remove_branch("Main.Heat"), lambda e: e.move_to_macro(["Main.Heat"], "M")], ids=["cut", "move"]
)
def test_steps_that_feed_drawn_logic_stay(edit: Callable[[sfc.Editor], object]) -> None:
    project = plant()
    chart = project.pou("Main").chart
    assert chart is not None
    wire = m.InputPin(connections=[m.Connection(source=find(project, "Heat").id)])
    chart.logic = [m.OutputVariable(id=chart.new_id(), expression="Valve", input=wire)]
    before = project.model_dump()
    with pytest.raises(ModelError, match="logic that is drawn"):
        edit(project.edit())
    assert project.model_dump() == before


def test_a_block_of_edits_is_one_transaction() -> None:
    project = plant()
    before = project.model_dump()
    with project.edit() as edit:
        edit.rename("Main.Fill", "Pouring")
        edit.insert_step("Rest", link(project, "Wait -> Pouring"))
        with pytest.raises(ModelError):
            edit.delete_step("Main.Wait")
    assert "Rest -> Pouring: TRUE" in labels(project)
    edit.undo()
    assert project.model_dump() == before

    def fail() -> None:
        with project.edit() as edit:
            edit.rename("Main.Fill", "Pouring")
            edit.delete_step("Main.Wait")

    with pytest.raises(ModelError, match="it is the initial step"):
        fail()
    assert project.model_dump() == before


def test_transactions_are_undone_one_by_one() -> None:
    project = plant()
    edit = project.edit()
    states = [project.model_dump()]
    for do in (EDITS["insert behind"][0], EDITS["split"][0], EDITS["rename"][0]):
        do(edit, project)
        states.append(project.model_dump())
    for state in reversed(states[:-1]):
        edit.undo()
        assert project.model_dump() == state


def test_only_the_last_edit_of_a_project_can_be_undone() -> None:
    """Two editors took their edits back out of order: a condition named a step that was not there any more."""
    project = plant()
    first, second = project.edit(), project.edit()
    states = [project.model_dump()]
    first.rename("Main.Drain", "Empty_it")
    states.append(project.model_dump())
    second.extract_condition(link(project, "Empty_it -> Wait"), "TooLate")
    states.append(project.model_dump())
    with pytest.raises(ModelError, match="edited in another way since"):
        first.undo()
    assert project.model_dump() == states[2]
    for edit, state in ((second, states[1]), (first, states[0])):
        edit.undo()
        assert project.model_dump() == state
    with first:
        first.rename("Main.Drain", "Empty_it")
        second.rename("Main.Empty_it", "Drain_2")
    first.rename("Main.Drain_2", "Drain_3")
    project.rename("Main.Drain_3", "Drain_4")
    for edit in (first, second):
        with pytest.raises(ModelError, match="edited in another way since"):
            edit.undo()


def test_what_an_edit_orphans_is_removed_on_request() -> None:
    project = plant()
    edit = project.edit(clean=True)
    edit.set(find(project, "Fill"), actions=[])
    pou = project.pou("Main")
    assert edit.removed == ["Main.Pour", "Main.Pump"]  # Spare was not used before
    assert [action.name for action in pou.actions] == []
    assert "Spare" in [variable.name for variable in pou.variables()]
    assert edit.remove_unused() == ["Main.Spare"]
    edit.undo()
    edit.undo()
    assert [action.name for action in pou.actions] == ["Pour"]


def equal(project: sfc.Project, other: sfc.Project) -> bool:
    return sfc.equivalent(project.pou("Main"), other.pou("Main"), free_inputs=ALL_FREE).equal


@pytest.mark.slow
def test_edits_that_keep_behaviour_are_proven() -> None:
    project = plant()
    edit = project.edit(prove=True)
    edit.split_transition(link(project, "Fill -> Heat+Mix"))
    assert [proof.verdict.equal for proof in edit.proofs] == [True]
    edit.extract_condition(link(project, "Drain -> Wait"), "IsEmpty")
    edit.move_to_macro([find(project, "Heat"), find(project, "Keep")], "Warm")
    edit.rename("Main.Mix", "Stir")
    assert equal(plant(), project)
    before = project.model_dump()
    with pytest.raises(ModelError, match="would change what the charts do") as caught:
        edit.insert_step("Rest", link(project, "Wait -> Fill"))
    assert "POU Main: different after 1 scan" in caught.value.message
    assert project.model_dump() == before


def test_split_and_join_are_inverse() -> None:
    project = plant()
    edit = project.edit(prove=True)
    links = edit.split_transition(link(project, "Fill -> Heat+Mix"))
    edit.join_transitions(links[::-1])
    assert labels(project) == WHOLE


COMMENTED = b"""{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}
PROGRAM Main
VAR a, b : BOOL; END_VAR
INITIAL_STEP Wait: END_STEP
STEP Fill: END_STEP
TRANSITION FROM Wait TO Fill := a = TRUE // (* a
; END_TRANSITION
TRANSITION FROM Fill TO Wait := b (* b *); END_TRANSITION
END_PROGRAM
"""


def test_comments_of_conditions_end_before_what_is_joined_behind_them() -> None:
    project = sfc.loads(COMMENTED, format="iec-text")
    project.edit().delete_step("Main.Fill", keep="both")
    project.edit().extract_condition(link(project, "Wait -> Wait"), "Both")
    assert project.pou("Main").transitions[0].body.text == "(a = TRUE (* ( * a *)) AND b (* b *)"  # type: ignore[union-attr]
    assert sfc.check_syntax(project) == []


@pytest.mark.parametrize("text", [":= Start AND NOT Stop;", "Start AND NOT Stop;", " :=Start AND NOT Stop"])
def test_a_condition_in_its_place_is_an_expression(text: str) -> None:
    project = plant()
    pou = project.pou("Main")
    project.edit().extract_condition(link(project, "Wait -> Fill"), "Go")
    pou.transitions[-1].body.text = text  # type: ignore[union-attr]  # as tools that follow IEC 61131-3 write it
    for format in ("codesys", "codesys-export"):
        converted = sfc.loads(sfc.dumps(project, format=format, partial=True))
        assert ":=" not in converted.pou("Main").transitions[-1].body.text  # type: ignore[union-attr]  # not compiled there
        assert equal(project, converted)
    project.edit().inline_condition(link(project, "Wait -> Fill"))
    assert link(project, "Wait -> Fill").condition == sfc.Expression(text="Start AND NOT Stop")


def test_priorities_stay_in_order_when_a_transition_is_split() -> None:
    project = plant()
    chart = project.pou("Main").chart
    assert chart is not None
    for number, each in enumerate(chart.outgoing(chart.step("Fill")), 1):
        each.priority = number
    project.edit().split_transition(link(project, "Fill -> Heat+Mix"))
    assert [(each.condition.text, each.priority) for each in chart.outgoing(chart.step("Fill"))] == [  # type: ignore[union-attr]
        ("Full", 1),
        ("Stop", 2),
        ("Fault", 3),
    ]


def test_a_transition_that_is_tried_between_them_keeps_others_apart() -> None:
    project = sfc.Project()
    chart = project.add_program("Main", step("A", initial=True), "x", step("B"), "u", step("C")).chart
    assert chart is not None
    chart.add_transition("A", "C", "y")
    chart.add_transition("A", "B", "z")
    links = [chart.transitions[0], chart.transitions[3]]
    with pytest.raises(ModelError, match="tried between them"):
        project.edit().join_transitions(links)


def test_a_macro_step_and_back() -> None:
    project = plant()
    edit = project.edit()
    macro = edit.move_to_macro([find(project, "Heat"), find(project, "Keep")], "Warm")
    inner = macro.macro.body.chart  # type: ignore[union-attr]
    assert [each.name for each in inner.steps] == ["Heat", "Keep"]
    assert find(project, "Heat").chart is inner
    assert equal(plant(), project)
    edit.dissolve_macro(macro)
    assert sorted(labels(project)) == sorted(WHOLE)
    assert find(project, "Heat").chart is project.pou("Main").chart
    edit.undo()
    edit.undo()
    assert find(project, "Heat").chart is project.pou("Main").chart
    assert labels(project) == WHOLE


@pytest.mark.parametrize("form", ["twincat", "codesys-export"])
@pytest.mark.parametrize(("name", "value"), [("number", 7), ("title", "full"), ("warning_time", "T#5s")])
def test_what_a_file_has_no_place_for_is_told_when_it_is_saved(form: str, name: str, value: object) -> None:
    project = sfc.loads(sfc.convert(plant(), form, partial=True).data)
    assert not sfc.convert(project).report.with_outcome(sfc.Outcome.DROPPED)
    project.edit().set("Main.Fill", **{name: value})
    (told,) = sfc.convert(project).report.with_outcome(sfc.Outcome.DROPPED)
    assert told.path == f"POU Main / step Fill / {name.replace('_', ' ')}"
    project.edit().set("Main.Fill", **{name: None})
    project.edit().set("Main.Fill", max_time="T#9s")
    assert not sfc.convert(project).report.with_outcome(sfc.Outcome.DROPPED)


RULED = """GRAFCET R
INPUTS
    a
    b
OUTPUTS
    Q2
    Q3
CHART G1
    INITIAL STEP 1
    1 -> 2 : a
    STEP 2
        Q2
    2 -> 3 : b
    STEP 3
        Q3
    3 -> 1 : /a
CHART G2
    INITIAL STEP 10
    10 -> 11 : a * b * X3
    STEP 11
        FORCE G1{INIT}
    11 -> 10 : /b
"""


@pytest.mark.parametrize("form", ["grafcet-text", "grafcet", "json"])
def test_a_macro_step_of_a_grafcet_has_an_expansion(form: str) -> None:
    before = sfc.dumps(sfc.loads(RULED.encode(), format="grafcet-text"), format=form)
    project = sfc.loads(before)
    project.edit(prove=True).move_to_macro(["R.2", "R.3"], "M5")
    saved = sfc.loads(sfc.dumps(project))
    (chart,) = (each.chart for each in saved.charts())
    (expansion,) = (each for each in chart.partial_charts if each.kind == "expansion")
    assert ([each.name for each in expansion.chart.steps], expansion.entry_step, expansion.exit_step) == (
        ["2", "3"],
        "2",
        "3",
    )
    assert sfc.equivalent(sfc.loads(before).pou("R"), saved.pou("R")).proven
    saved.edit().dissolve_macro("R.M5")
    assert sfc.diff(sfc.loads(before), saved).equal


@pytest.mark.parametrize(
    ("text", "do", "message"),
    [
        (RULED, lambda e: e.move_to_macro(["R.2"], "M5"), "begins with one step and ends with another"),
        (RULED, lambda e: e.move_to_macro(["R.2", "R.3"], "G2"), "has a partial chart 'G2' already"),
        (
            RULED.replace("{INIT}", "{3}"),
            lambda e: e.move_to_macro(["R.2", "R.3"], "M5"),
            "is named in R / G2 / step 11",
        ),
        (RULED, lambda e: e.delete_step("R.3", "incoming"), "3 cannot be removed: it is named in R / G2 / transition"),
        (
            RULED.replace("    10 ", "    MACRO M5\n    10 -> M5 : /a\n    10 ", 1).replace("X3", "XM5")
            + "EXPANSION M5\n    STEP E5\n    STEP S5\n    E5 -> S5 : a\n",
            lambda e: e.dissolve_macro("R.M5"),
            "M5 cannot be dissolved: it is named in",
        ),
        (
            RULED.replace("    10 ", "    MACRO M5\n    MACRO M6 EXPANDS M5\n    10 -> M5 : /a\n    10 ", 1)
            + "EXPANSION M5\n    STEP E5\n    STEP S5\n    E5 -> S5 : a\n",
            lambda e: e.dissolve_macro("R.M5"),
            "M6 has the same expansion",
        ),
    ],
    ids=["one step", "name of a chart", "forced", "flag of a step", "flag", "shared"],
)
def test_what_a_grafcet_cannot_have_is_refused(text: str, do: Callable[[sfc.Editor], object], message: str) -> None:
    project = sfc.loads(text.encode(), format="grafcet-text")
    assert not project.diagnostics
    with pytest.raises(ModelError, match=re.escape(message)):
        do(project.edit())
    assert sfc.dumps(project) == text.encode()


def test_conditions_are_extracted_once_and_inlined() -> None:
    project = plant()
    edit = project.edit(clean=True)
    edit.set(link(project, "Alarm -> Drain"), condition="Fault")
    for label in ("Alarm -> Drain", "Fill -> Alarm"):
        edit.extract_condition(link(project, label), "IsFaulty")
    pou = project.pou("Main")
    assert [(each.name, each.body) for each in pou.transitions] == [("IsFaulty", sfc.StBody(text="Fault"))]
    edit.inline_condition(link(project, "Alarm -> Drain"))
    assert len(pou.transitions) == 1
    edit.inline_condition(link(project, "Fill -> Alarm"))
    assert pou.transitions == []
    assert edit.removed == ["Main.IsFaulty"]


def test_actions_are_inlined_and_extracted() -> None:
    project = plant()
    edit = project.edit()
    pou, fill = project.pou("Main"), find(project, "Fill")
    edit.inline_action(pou.action("Pour"))
    assert (fill.actions[1].target, fill.actions[1].body) == (None, sfc.StBody(text="Pump := NOT Empty;"))
    assert pou.actions == []
    edit.extract_action(fill, "Dose", 1)
    assert (fill.actions[1].target, pou.action("Dose").body) == ("Dose", sfc.StBody(text="Pump := NOT Empty;"))
    find(project, "Drain").actions.append(sfc.ActionAssociation.parse("N Dose", 900))
    with pytest.raises(ModelError, match="2 places name it"):
        edit.inline_action(pou.action("Dose"))


def test_the_order_of_actions_by_their_names_is_kept() -> None:
    """CODESYS executes actions of associations in the order of their names; entry actions belong to their step."""
    project = plant()
    project.dialect = Dialect.CODESYS
    pou, fill = project.pou("Main"), find(project, "Fill")
    drain = find(project, "Drain")
    drain.entry_action = pou.add_action("Drain_entry", "Pump := FALSE;").name
    edit = project.edit()
    assert not edit.rename("Main.Drain_entry", "Zero").undecided
    edit.inline_action(pou.action("Pour"))  # alone in the order of names
    edit.undo()
    drain.actions.append(sfc.ActionAssociation.parse("N Stop_Pump", 900))
    pou.add_action("Stop_Pump", "Pump := FALSE;")
    [told] = edit.rename("Main.Pour", "Tip").undecided
    assert "it changes places with Stop_Pump" in told.reason
    with pytest.raises(ModelError, match="Stop_Pump share variables with it"):
        edit.inline_action(pou.action("Tip"))
    project.dialect = Dialect.IEC
    edit.inline_action(pou.action("Tip"))
    edit.undo()
    project.dialect = Dialect.CODESYS
    fill.actions[0].target, fill.actions[0].body = None, sfc.StBody(text="Pump := TRUE;")
    with pytest.raises(ModelError, match="Tip, Stop_Pump share variables with it"):
        edit.extract_action(fill, "Last", 0)
    assert pou.find_action("Last") is None


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("g", "means something else there"),
        ("Idle", "means something else there"),
        ("n", "is taken: the variable Main.n"),
        ("Work", "is taken: the action Main.Work"),
        ("IF", "it is a keyword"),
        ("x y", "a name consists of"),
    ],
)
def test_new_steps_have_names_of_their_own(name: str, why: str) -> None:
    text = b"""{plcopen_sfc project.dialect := 'codesys'}
TYPE Mode : (Idle, Run); END_TYPE
VAR_GLOBAL g : INT; END_VAR
PROGRAM Main
VAR n : INT; m : Mode; END_VAR
INITIAL_STEP S1: Work(N); END_STEP
TRANSITION FROM S1 TO S1 := m = Idle; END_TRANSITION
ACTION Work:
g := g + n; S9 := 1;
END_ACTION
END_PROGRAM
"""
    project = sfc.loads(text, format="iec-text")
    edit, chart = project.edit(), project.pou("Main").chart
    assert chart is not None
    for add in (
        lambda: edit.insert_step(name, chart.transitions[0]),
        lambda: edit.add_branch("Main.S1", "TRUE", step(name), "TRUE", jump("S1")),
    ):
        with pytest.raises(ModelError, match=why):
            add()
        assert sfc.dumps(project) == text
    edit.insert_step("S9", chart.transitions[0], "S9.X")  # named nothing before, and new texts may name it


def test_a_chart_is_not_inlined_into_a_step() -> None:
    project = plant()
    project.pou("Main").action("Pour").body = sfc.SfcBody(
        chart=sfc.SfcNetwork(steps=[sfc.Step(id=1, name="In", initial=True)])
    )
    with pytest.raises(ModelError, match="it is a chart"):
        project.edit().inline_action(project.pou("Main").action("Pour"))
    assert find(project, "Fill").actions[1].target == "Pour"


def test_branches_are_added() -> None:
    project = plant()
    edit = project.edit()
    edit.add_branch("Main.Fill", "Abort", step("Flush", actions=["N Rinse"]), "Clean", jump("Wait"))
    assert labels(project)[-2:] == ["Fill -> Flush: Abort", "Flush -> Wait: Clean"]
    assert "Rinse" in [variable.name for variable in project.pou("Main").variables()]
    edit.add_branch(link(project, "Fill -> Heat+Mix"), step("Record"), end=link(project, "Keep+Mix -> Drain"))
    assert labels(project)[1] == "Fill -> Heat+Mix+Record: Full OR Stop"
    assert labels(project)[3] == "Keep+Mix+Record -> Drain: Done"
    edit.remove_branch("Main.Record")
    assert edit.remove_branch(link(project, "Fill -> Flush")) == ["Flush"]
    assert labels(project) == WHOLE


def test_steps_are_numbered_along_the_flow() -> None:
    project = plant()
    chart = project.pou("Main").chart
    assert chart is not None
    for each in chart.steps:
        each.number = 1
    chart.steps.reverse()
    project.edit().renumber(10, 10)
    ordered = sorted(chart.steps, key=lambda each: each.number or 0)
    assert [each.name for each in ordered] == ["Wait", "Fill", "Heat", "Keep", "Mix", "Alarm", "Drain"]
    assert [each.number for each in ordered] == list(range(10, 80, 10))
    project.edit().renumber(1, names="S{number:02}_{name}")
    assert labels(project)[-1] == "S07_Drain -> S01_Wait: Empty AND S07_Drain.T > T#2s"


def test_a_variable_is_replaced_in_all_bodies() -> None:
    project = plant()
    variables = [sfc.Variable(name="Go", type="BOOL"), sfc.Variable(name="N", type="INT")]
    project.global_variables.append(sfc.VariableSection(name="GVL", variables=variables))
    edit = project.edit(clean=True)
    edit.replace_variable("Main.Pump", "GVL.Go")
    assert project.pou("Main").action("Pour").body.text == "Go := NOT Empty;"  # type: ignore[union-attr]
    assert edit.removed == ["Main.Pump"]
    edit.replace_variable("GVL.Go", "Main.Spare")
    assert project.pou("Main").action("Pour").body.text == "Spare := NOT Empty;"  # type: ignore[union-attr]
    with pytest.raises(ModelError, match="their types differ"):
        edit.replace_variable("Main.Spare", "GVL.N")
    project.pous.append(
        sfc.Pou(name="Other", kind=sfc.PouKind.PROGRAM, bodies=[sfc.StBody(text="GVL.Go := Main.Spare;")])
    )
    edit.replace_variable("Main.Spare", "GVL.Go")
    assert project.pou("Other").body.text == "GVL.Go := Go;"  # type: ignore[union-attr]
    block = project.add_function_block("Block", step("S", initial=True, actions=["N Inner"]))
    assert block.chart is not None
    with pytest.raises(ModelError, match=r"does not see Block\.Inner"):
        edit.replace_variable("GVL.Go", "Block.Inner")


@pytest.mark.parametrize(("new", "types"), [("e", "TON and R_TRIG"), ("f", "TON and Blk"), ("a", "TON and BOOL")])
def test_an_instance_is_replaced_by_one_of_the_same_block(new: str, types: str) -> None:
    text = (
        "PROGRAM Main\nVAR t1, t2 : TON; e : R_TRIG; f : Blk; a : BOOL; END_VAR\nt1(IN := a, PT := T#5s);\nEND_PROGRAM"
    )
    project = sfc.loads(text.encode(), format="iec-text")
    with pytest.raises(ModelError, match=f"their types differ: {types}$"):
        project.edit().replace_variable("Main.t1", f"Main.{new}")
    project.edit().replace_variable("Main.t1", "Main.t2")
    assert project.pou("Main").body.text.strip() == "t2(IN := a, PT := T#5s);"  # type: ignore[union-attr]


CONSTANTS = """TYPE Row : ARRAY[0..G] OF INT; END_TYPE
VAR_GLOBAL CONSTANT G : INT := 3; H : INT := 3; END_VAR
VAR_GLOBAL v : INT; END_VAR
PROGRAM Main
VAR CONSTANT k : INT := 5; l : INT := 5; END_VAR
VAR m : INT := k; o : INT; arr : ARRAY[0..l] OF INT; s : STRING[l]; END_VAR
CASE o OF G: o := k; END_CASE;
END_PROGRAM
"""


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("Main.k", "Main.m", "is in the declaration of Main.m"),
        ("Main.k", "Main.o", "needs a constant, and Main.o is none"),
        ("Main.l", "Main.o", "needs a constant, and Main.o is none"),
        ("G", "v", "needs a constant, and v is none"),
        ("Main.k", "Main.l", ""),
        ("Main.l", "Main.k", ""),
        ("G", "H", ""),
        ("Main.o", "Main.m", ""),
    ],
)
def test_a_constant_is_replaced_by_a_constant_where_one_is_needed(old: str, new: str, reason: str) -> None:
    """Bounds of arrays, lengths of strings and start values named a variable, one of them itself."""
    project = sfc.loads(CONSTANTS.encode(), format="iec-text")
    if not reason:
        assert project.edit().replace_variable(old, new)
        assert sfc.loads(sfc.dumps(project)).uses(old) == []
        return
    with pytest.raises(ModelError, match=reason):
        project.edit().replace_variable(old, new)
    assert sfc.dumps(project).decode() == CONSTANTS


def test_a_label_of_case_stays_a_constant() -> None:
    project = sfc.loads(CONSTANTS.replace("0..G", "0..H").encode(), format="iec-text")
    with pytest.raises(ModelError, match=r"Main:1:11: .* needs a constant, and v is none"):
        project.edit().replace_variable("G", "v")


TWO_PROGRAMS = """PROGRAM Main
VAR a, b : BOOL; END_VAR
VAR_INPUT i : BOOL; END_VAR
VAR CONSTANT k : BOOL := TRUE; END_VAR
a := NOT a OR b;
END_PROGRAM
PROGRAM Other
VAR x : BOOL; END_VAR
VAR_INPUT xi : BOOL; END_VAR
END_PROGRAM
"""


@pytest.mark.parametrize(
    ("dialect", "old", "new", "reason"),
    [
        (Dialect.IEC, "Main.a", "Main.k", "Main writes it, and Main.k is a constant"),
        (Dialect.IEC, "Main.a", "Main.i", "Main writes it, and Main.i is an input"),
        (Dialect.CODESYS, "Main.a", "Other.x", "Main writes it, and Other.x belongs to another program"),
        (Dialect.IEC, "Main.b", "Other.x", "does not see Other.x"),
        (Dialect.IEC, "Main.b", "Main.k", "a := NOT a OR k;"),
        (Dialect.IEC, "Main.b", "Main.i", "a := NOT a OR i;"),
        (Dialect.CODESYS, "Main.b", "Other.x", "a := NOT a OR Other.x;"),
        (Dialect.CODESYS, "Main.a", "Other.xi", "Other.xi := NOT Other.xi OR b;"),
    ],
)
def test_a_variable_is_replaced_by_what_code_may_write_there(dialect: Dialect, old: str, new: str, reason: str) -> None:
    project = sfc.loads(TWO_PROGRAMS.encode(), format="iec-text")
    project.dialect = dialect
    if reason.endswith(";"):
        project.edit().replace_variable(old, new)
        assert project.pou("Main").body.text.strip() == reason  # type: ignore[union-attr]
    else:
        with pytest.raises(ModelError, match=reason):
            project.edit().replace_variable(old, new)


def test_a_pou_is_copied_into_another_project() -> None:
    target = sfc.Project(name="Other")
    edit = target.edit()
    copy = edit.copy_pou(plant(), "Main", {"Main": "Line2", "Main.Valve": "Valve2"})
    assert copy is target.pou("Line2")
    assert copy.chart is not None
    assert copy.chart.step("Fill").actions[0].target == "Valve2"
    edit.undo()
    assert target.pous == []
    source = plant()
    source.global_variables.append(sfc.VariableSection(variables=[sfc.Variable(name="Light", type="BOOL")]))
    find(source, "Fill").actions.append(sfc.ActionAssociation.parse("N Light", 900))
    with pytest.raises(ModelError, match="the project has no variable Light"):
        edit.copy_pou(source, "Main")
    assert target.pous == []
    target.global_variables.append(sfc.VariableSection(variables=[sfc.Variable(name="Lamp2", type="BOOL")]))
    assert edit.copy_pou(source, "Main", {"Light": "Lamp2"}).chart is not None


@pytest.mark.parametrize(
    "do",
    [
        lambda e, p: e.set(link(p, "Wait -> Fill"), condition="Start AND"),
        lambda e, p: e.insert_step("Rest", link(p, "Wait -> Fill"), "Start AND"),
        lambda e, p: e.add_branch("Main.Wait", "Start AND", jump("Fill")),
    ],
    ids=["set", "step", "branch"],
)
def test_conditions_that_cannot_be_read_are_refused(do: Callable[[sfc.Editor, sfc.Project], object]) -> None:
    project = plant()
    before = project.model_dump()
    with pytest.raises(ModelError, match="cannot be 'Start AND': found the end of the text"):
        do(project.edit(), project)
    assert project.model_dump() == before


@pytest.mark.parametrize("name", ["interlock", "supervision"])
def test_interlocks_and_supervisions_that_cannot_be_read_are_refused(name: str) -> None:
    project = sfc.load(FIXTURES / "simaticml-training-chain" / "Ablauf.xml")
    before = sfc.dumps(project)
    with pytest.raises(ModelError, match=f"the {name} of S2 cannot be '#B1 AND'"):
        project.edit().set("Ablauf.S2", **{name: "#B1 AND"})
    assert sfc.dumps(project) == before
    project.edit().set("Ablauf.S2", **{name: None})


def test_fields_of_actions_are_checked_as_those_of_steps() -> None:
    project = plant()
    action = find(project, "Fill").actions[0]
    for fields, message in (({"condition": "Start OR"}, "cannot be 'Start OR'"), ({"speed": 5}, "no field 'speed'")):
        before = project.model_dump()
        with pytest.raises(ModelError, match=message):
            project.edit().set(action, **fields)
        assert project.model_dump() == before


def test_conditions_of_grafcets_are_read_as_such() -> None:
    project = sfc.load(FIXTURES / "grafcet" / "selection.gct")
    chart = project.pou("Auswahl").chart
    assert chart is not None
    project.edit().set(chart.transitions[0], condition="/I1 * 2s/X2")
    with pytest.raises(ModelError, match="the condition of 1 -> 2 cannot be"):
        project.edit().set(chart.transitions[0], condition="/I1 *")
    assert chart.transitions[0].condition == sfc.Expression(text="/I1 * 2s/X2")


def test_two_steps_of_a_chart_get_no_common_number() -> None:
    project = sfc.load(FIXTURES / "simaticml-training-chain" / "Ablauf.xml")
    before = sfc.dumps(project)
    with pytest.raises(ModelError, match="the step 'S2' cannot have the number 1: the step 'S1' has it"):
        project.edit().set("Ablauf.S2", number=1)
    assert sfc.dumps(project) == before
    project.edit().set("Ablauf.S2", number=12)
    assert sfc.loads(sfc.dumps(project)).pou("Ablauf").chart.step("S2").number == 12  # type: ignore[union-attr]


def test_charts_of_grafcets_are_copied_between_grafcets_alone() -> None:
    belt, grafcet = (sfc.load(FIXTURES / each) for each in ("codesys/sorting_conveyor.xml", "grafcet/selection.gct"))
    for source, name, target in ((belt, "FB_Pusher", grafcet), (grafcet, "Auswahl", belt)):
        before = sfc.dumps(target)
        with pytest.raises(ModelError, match="only one of the projects is of GRAFCETs"):
            target.edit().copy_pou(source, name)
        assert sfc.dumps(target) == before
    converted = sfc.loads(sfc.dumps(belt, format="grafcet-text", partial=True), format="grafcet-text", as_tool=True)
    assert grafcet.edit().copy_pou(converted, "FB_Pusher").name == "FB_Pusher"
    assert sfc.Project().edit().copy_pou(grafcet, "Auswahl").name == "Auswahl"  # of no file yet


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("codesys-export/mixer.export", "Mischer"),
        ("codesys/sorting_conveyor.xml", "FB_Pusher"),
        ("twincat/press_station.xml", "FB_Cylinder"),
        ("plcopen/every_element_2.01.xml", "Mixer"),
        ("simaticml/FC_Count.xml", "FC_Count"),
    ],
)
def test_a_copy_in_the_same_project_has_identities_of_its_own(file: str, name: str) -> None:
    project = sfc.load(FIXTURES / file)
    found = [each.code for each in project.diagnostics]
    project.edit().copy_pou(project, name, {name: "ZCopy"})
    project.rename("ZCopy", "Earlier")  # keeps what the name gave it
    project = sfc.loads(sfc.dumps(project))
    project.edit().copy_pou(project, name, {name: "ZCopy"})
    again = sfc.loads(sfc.dumps(project))
    assert [each.code for each in again.diagnostics] == found
    assert str(sfc.diff(project, again)) == "no differences"
    for of_project in (project, again):
        identities = [
            value
            for pou in of_project.pous
            for each in models_in(pou)
            for field, value in each.__dict__.items()
            if field in {"object_id", "global_id"} and value is not None
        ]
        assert len(set(identities)) == len(identities)
        numbers = [(pou.kind, pou.number) for pou in of_project.pous if pou.number is not None]
        assert len(set(numbers)) == len(numbers)


SURROUNDINGS = """TYPE Sort : STRUCT weight : INT := 3; END_STRUCT END_TYPE
VAR_GLOBAL Light AT %QX0.0 : BOOL; n : INT; m : INT; END_VAR
VAR_GLOBAL CONSTANT MOST : INT := 5; END_VAR
FUNCTION Half : INT
VAR_INPUT x : INT; END_VAR
Half := x / 2;
END_FUNCTION
FUNCTION_BLOCK Count
VAR_OUTPUT o : INT; END_VAR
o := o + Half(x := m);
END_FUNCTION_BLOCK
"""
LINE = """PROGRAM Line
VAR c : Count; s : Sort; END_VAR
INITIAL_STEP S1: Light(N); END_STEP
TRANSITION FROM S1 TO S2 := c.o > MOST; END_TRANSITION
STEP S2: Work(N); END_STEP
TRANSITION FROM S2 TO S1 := s.weight > n; END_TRANSITION
ACTION Work: c(); n := n / 2; END_ACTION
END_PROGRAM
"""


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("n : INT", "n : REAL", "another global variable n: type INT -> REAL"),
        ("n : INT", "k : INT", "no variable n"),
        ("%QX0.0", "%QX7.0", "another global variable Light: address"),
        ("n : INT; m : INT;", "m : INT; END_VAR VAR_GLOBAL CONSTANT n : INT;", "another global variable n: CONSTANT"),
        ("MOST : INT := 5", "MOST : INT := 6", "another global variable MOST: start value 5 -> 6"),
        ("weight : INT", "weight : DINT", "another type Sort / member weight: type INT -> DINT"),
        ("o := o + Half", "o := o + 100 * Half", "another POU Count: code"),
        ("x / 2", "x / 4", "another POU Half: code"),  # only the other block calls it
        ("m : INT", "m : SINT", "another global variable m: type INT -> SINT"),
        ("n : INT", "n : INT := 4", ""),
        ("x / 2;", "x/2;  // half of it", ""),
    ],
)
def test_a_pou_is_copied_only_where_its_names_mean_the_same(old: str, new: str, why: str) -> None:
    source = sfc.loads((SURROUNDINGS + LINE).encode(), format="iec-text")
    target = sfc.loads(SURROUNDINGS.replace(old, new, 1).encode(), format="iec-text")
    edit = target.edit()
    if not why:
        assert edit.copy_pou(source, "Line") is target.pou("Line")
        return
    with pytest.raises(ModelError, match=re.escape(f"cannot be copied: the project has {why}")):
        edit.copy_pou(source, "Line")
    assert [pou.name for pou in target.pous] == ["Half", "Count"]


@pytest.mark.parametrize(
    ("address", "value", "why"),
    [
        ("%I0.0", "5", ""),
        ("%I0.1", "5", "Start: address %I0.0 -> %I0.1"),
        ("%I0.0", "6", "MOST: start value 5 -> 6"),
    ],
)
def test_tags_and_user_constants_of_a_copied_block_are_the_same(address: str, value: str, why: str) -> None:
    def plc(address: str, value: str) -> sfc.Project:
        constant = m.Variable(name="MOST", type="INT", initial=m.SimpleValue(text=value))
        table = m.TagTable(name="Tags", tags=[m.Tag(name="Start", type="Bool", address=address)], constants=[constant])
        return sfc.Project(dialect=Dialect.SCL, tag_tables=[table])

    source, target = plc("%I0.0", "5"), plc(address, value)
    body = sfc.StBody(text='IF "Start" THEN #n := "MOST"; END_IF;')
    block = sfc.Pou(name="Line", kind=sfc.PouKind.FUNCTION_BLOCK, bodies=[body])
    block.interface = m.Interface(sections=[m.VariableSection(variables=[m.Variable(name="n", type="INT")])])
    source.pous.append(block)
    if not why:
        assert target.edit().copy_pou(source, "Line").name == "Line"
        return
    with pytest.raises(ModelError, match=re.escape(why)):
        target.edit().copy_pou(source, "Line")


def test_a_variable_that_is_chosen_for_a_copied_pou_has_its_own_address() -> None:
    source = sfc.loads((SURROUNDINGS + LINE).encode(), format="iec-text")
    target = sfc.loads(SURROUNDINGS.replace("END_VAR", "Lamp AT %QX7.0 : BOOL; r : REAL; END_VAR", 1).encode())
    with pytest.raises(ModelError, match="another global variable r: type INT -> REAL"):
        target.edit().copy_pou(source, "Line", {"n": "r"})
    assert target.edit().copy_pou(source, "Line", {"Light": "Lamp"}).name == "Line"


def test_an_action_of_another_pou_is_not_inlined() -> None:
    project = sfc.load(FIXTURES / "twincat" / "press_station.xml")
    edit = project.edit()
    with pytest.raises(ModelError, match="is in another POU"):
        edit.inline_action(project.pou("FB_Press").action("ACT_Open"))


def test_a_condition_that_gives_its_value_to_a_name_is_extracted_under_that_name() -> None:
    project = sfc.load(FIXTURES / "plcopen" / "filling_station_2.0.xml")
    chart = project.pou("FillingStation").chart
    assert chart is not None
    edit = project.edit(clean=True)
    link = chart.transition("Init -> Idle")
    edit.inline_condition(link)
    assert edit.removed == ["FillingStation.TankReady"]
    with pytest.raises(ModelError, match="gives a value to TankReady"):
        edit.extract_condition(link, "Other")
    assert edit.extract_condition(link, "TankReady").name == "TankReady"
    assert [str(each.use) for each in Names(project).undeclared()] == []
