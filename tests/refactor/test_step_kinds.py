"""Charts of CoDeSys 2.3 are switched between simple steps and IEC steps."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model.body import StBody
from tests.samples import FIXTURES

SIMPLE = """(* @NESTEDCOMMENTS := 'Yes' *)
(* @PATH := '' *)
PROGRAM Main
VAR
	go, done: BOOL;
	lamp: BOOL;
	odd: BOOL;
END_VAR
(* @END_DECLARATION := '0' *)
INITIAL_STEP Wait:
lamp := FALSE;
END_STEP
TRANSITION FROM Wait TO Fill:=
go
END_TRANSITION
STEP Fill:
odd := NOT odd;
lamp := TRUE;
END_STEP
TRANSITION FROM Fill TO Wait:=
done AND Fill
END_TRANSITION
END_PROGRAM
"""


def project_of(text: str) -> sfc.Project:
    return sfc.loads(text.replace("\n", "\r\n").encode())


def chart_of(project: sfc.Project) -> sfc.SfcNetwork:
    chart = project.pous[0].chart
    assert chart is not None
    return chart


def test_an_action_that_counts_is_executed_once_more_which_the_proof_tells() -> None:
    project = project_of(SIMPLE)
    with pytest.raises(sfc.SfcError, match="would change what the charts do"):
        project.edit(prove=True).use_iec_steps(chart_of(project))
    assert sfc.dumps(project) == SIMPLE.replace("\n", "\r\n").encode()


def test_code_that_asks_for_its_step_does_the_same() -> None:
    project = project_of(SIMPLE)
    editor = project.edit(prove=True)
    assert editor.use_iec_steps(chart_of(project), guarded=True) == ["POU Main / transition Fill -> Wait"]
    assert all(proof.equal for proof in editor.proofs)
    text = sfc.dumps(project).decode()
    assert "STEP Fill:\r\nFill_active(N);\r\nEND_STEP" in text
    assert "done AND Fill.x" in text
    assert "ACTION Fill_active:\r\nIF Fill.x THEN\r\n    odd := NOT odd;" in text
    assert "Iecsfc.lib" in " ".join(item.why for item in sfc.convert(project, "codesys23")[1].items)


@pytest.mark.parametrize("last", ["FALSE", "done"])
def test_code_of_a_step_that_is_never_left_need_not_find_it_inactive(last: str) -> None:
    """The code asked for its step, which was never found FALSE: the edit was refused, or not finished in minutes."""
    text = SIMPLE.replace("done AND Fill", last).replace("odd := NOT odd", "Show(Read(go))")
    project = project_of(text)
    editor = project.edit(prove=True)
    editor.use_iec_steps(chart_of(project), guarded=True)
    (proof,) = editor.proofs
    assert proof.equal
    assert ("condition `Fill.x` is never FALSE (proven)" in str(proof)) is (last == "FALSE"), str(proof)


CALLING = (
    SIMPLE.replace("odd := NOT odd;\nlamp := TRUE;", "Toggle();") + "ACTION Toggle:\nodd := NOT odd;\nEND_ACTION\n"
)
"""A step with an action of the POU."""


@pytest.mark.parametrize("text", [SIMPLE, CALLING], ids=["in place", "of the POU"])
def test_it_comes_back_as_it_was(text: str) -> None:
    project = project_of(text)
    project.edit().use_iec_steps(chart_of(project), guarded=True)
    back = sfc.loads(sfc.dumps(project))
    editor = back.edit(clean=True, prove=True)
    editor.use_simple_steps(chart_of(back))
    assert [str(proof) for proof in editor.proofs if not proof.equal] == []
    assert re.sub(r"\s*\n", "\n", sfc.dumps(back).decode()).rstrip() == text.rstrip()
    editor.undo()
    assert sfc.dumps(back) == sfc.dumps(project)


IEC = """(* @NESTEDCOMMENTS := 'Yes' *)
(* @PATH := '' *)
PROGRAM Main
VAR
	go, done: BOOL;
	lamp, pump, alarm: BOOL;
END_VAR
(* @END_DECLARATION := '0' *)
INITIAL_STEP Wait:
alarm(R);
END_STEP
TRANSITION FROM Wait TO Fill:=
go
END_TRANSITION
STEP Fill:
pump(N);
Blink(N);
alarm(S);
END_STEP
TRANSITION FROM Fill TO Wait:=
done AND Fill.x
END_TRANSITION
END_PROGRAM
ACTION Blink:
lamp := TRUE;
END_ACTION
"""


def test_variables_with_n_are_reset_at_the_exit() -> None:
    project = project_of(IEC)
    editor = project.edit(prove=True)
    editor.use_simple_steps(chart_of(project))
    assert all(proof.equal for proof in editor.proofs)
    step = chart_of(project).step("Fill")
    assert isinstance(step.main_action, StBody)
    assert step.main_action.text == "alarm := TRUE;\nBlink();\npump := TRUE;"
    assert step.exit_action == "Fill_exit"
    back = sfc.loads(sfc.dumps(project))
    assert chart_of(back).step("Fill").exit_action == "Fill_exit"
    assert "done AND Fill\r\n" in sfc.dumps(project).decode()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("Blink(N)", "Blink(D,t#2s)", "Fill has D Blink"),
        ("Blink(N)", "Blink(S)", "Fill has S Blink"),
        ("Fill.x", "(Fill.t > t#2s)", "asks for more than its flag"),
    ],
)
def test_what_simple_steps_have_not_is_refused(old: str, new: str, words: str) -> None:
    project = project_of(IEC.replace(old, new))
    before = sfc.dumps(project)
    with pytest.raises(sfc.SfcError, match=words):
        project.edit().use_simple_steps(chart_of(project))
    assert sfc.dumps(project) == before


BESIDE = """(* @NESTEDCOMMENTS := 'Yes' *)
(* @PATH := '' *)
PROGRAM Main
VAR
	go, done: BOOL;
	n: INT;
END_VAR
(* @END_DECLARATION := '0' *)
INITIAL_STEP Wait:
n := 0;
END_STEP
TRANSITION FROM Wait TO (Zeta,Alpha):=
go
END_TRANSITION
STEP Zeta:
n := (n + 1) MOD 7;
END_STEP
STEP Alpha:
n := n * 2 MOD 7;
END_STEP
TRANSITION FROM (Zeta,Alpha) TO Wait:=
done
END_TRANSITION
END_PROGRAM
"""


def test_steps_that_are_active_together_keep_the_order_of_their_actions() -> None:
    """Simple steps are executed in the order of the chart, IEC steps in that of the names of their actions."""
    project = project_of(BESIDE)
    before = sfc.dumps(project)
    with pytest.raises(sfc.ModelError, match=r"Zeta and an action of Alpha would change places in a scan \(n\)"):
        project.edit().use_iec_steps(chart_of(project), guarded=True)
    assert sfc.dumps(project) == before
    ordered = project_of(BESIDE.replace("Zeta", "Able"))
    edit = ordered.edit(prove=True)
    edit.use_iec_steps(chart_of(ordered), guarded=True)
    ordered.rename("Main.Able_active", "Zeta_active")
    with pytest.raises(sfc.ModelError, match="Zeta_active and Alpha_active would change places"):
        ordered.edit().use_simple_steps(chart_of(ordered))


def test_steps_that_are_active_together_execute_an_action_twice_or_once() -> None:
    project = project_of(BESIDE.replace("n := n * 2 MOD 7;", "Add();").replace("n := (n + 1) MOD 7;", "Add();"))
    chart = chart_of(project)
    project.pou("Main").add_action("Add", "n := (n + 1) MOD 7;")
    for each in chart.steps[1:]:
        each.main_action = "Add"
    with pytest.raises(sfc.ModelError, match="Zeta and Alpha execute Add, IEC steps once in a scan and simple steps"):
        project.edit().use_iec_steps(chart)
    edit = project.edit(prove=True)
    edit.use_iec_steps(chart, guarded=True)
    assert all(proof.equal for proof in edit.proofs)
    for each in chart.steps[1:]:
        each.actions[0].target = "Add"
    with pytest.raises(sfc.ModelError, match="Zeta and Alpha execute Add"):
        project.edit().use_simple_steps(chart)


def test_steps_behind_each_other_become_iec_steps_and_simple_ones_whatever_their_names() -> None:
    project = project_of(SIMPLE.replace("odd := NOT odd;", "odd := NOT odd AND NOT lamp;"))
    edit = project.edit(prove=True)
    edit.use_iec_steps(chart_of(project), guarded=True)
    edit.use_simple_steps(chart_of(project))
    assert all(proof.equal for proof in edit.proofs)


@pytest.mark.parametrize(
    ("path", "tool"),
    [
        ("grafcet/selection.gct", "grafcet"),
        ("simaticml-training-chain/Ablauf.xml", "s7graph"),
        ("training-chain/iec-text.st", "iec"),
        ("training-chain/plcopen_2.01.xml", "iec"),
    ],
)
@pytest.mark.parametrize("edit", ["use_simple_steps", "use_iec_steps"])
def test_tools_without_step_actions_have_no_simple_steps(path: str, tool: str, edit: str) -> None:
    project = sfc.load(FIXTURES / path)
    before = sfc.dumps(project)
    with pytest.raises(sfc.ModelError, match=f"{tool} has no simple steps"):
        getattr(project.edit(), edit)(chart_of(project))
    assert sfc.dumps(project) == before


ENTERED = SIMPLE.replace("lamp := TRUE;\n", "") + (
    "ACTION Fill_entry:\nlamp := TRUE;\nEND_ACTION\nACTION Fill_exit:\nlamp := FALSE;\nEND_ACTION\n"
)
"""A step with an entry and an exit action."""


def test_iec_steps_have_entry_and_exit_actions_too() -> None:
    """The textbook, 11.5.2: they are possible in addition, as at simple steps."""
    project = project_of(ENTERED)
    editor = project.edit(prove=True)
    editor.use_iec_steps(chart_of(project), guarded=True)
    assert all(proof.equal for proof in editor.proofs)
    back = sfc.loads(sfc.dumps(project))
    step = chart_of(back).step("Fill")
    assert (step.entry_action, step.exit_action) == ("Fill_entry", "Fill_exit")
    assert [row.target for row in step.actions] == ["Fill_active"]
    for target in ("codesys", "twincat", "plcopen", "simaticml"):
        report = sfc.convert(back, target, limit=20).report
        assert not report.losses, target
        assert [kind.split(" ")[0].rstrip(",") for kind in report.compared.values()] == ["equal"], target
    editor = back.edit(clean=True, prove=True)
    editor.use_simple_steps(chart_of(back))
    assert all(proof.equal for proof in editor.proofs)
    assert re.sub(r"\s*\n", "\n", sfc.dumps(back).decode()).rstrip() == ENTERED.rstrip()


def test_the_initial_step_takes_no_association() -> None:
    """The textbook, 11.5.2: it cannot be associated with actions, so that it stays a simple step."""
    project = project_of(SIMPLE.replace("done AND Fill", "done AND Fill AND NOT Wait"))
    editor = project.edit(prove=True)
    editor.use_iec_steps(chart_of(project), guarded=True)
    assert all(proof.equal for proof in editor.proofs)
    text = sfc.dumps(project).decode()
    assert "INITIAL_STEP Wait:\r\nlamp := FALSE;\r\nEND_STEP" in text
    assert "done AND Fill.x AND NOT Wait\r\n" in text
    assert not [each for each in sfc.check(project) if each.code == "ACT15"]
    with pytest.raises(sfc.ModelError, match="only Wait has an action, and the initial step takes no association"):
        project.edit().use_iec_steps(chart_of(project))
    lone = project_of(IEC.replace("alarm(R);\n", ""))
    with pytest.raises(sfc.ModelError, match="they are IEC steps already"):
        lone.edit().use_iec_steps(chart_of(lone))


def test_entry_and_exit_actions_follow_the_name_of_their_step() -> None:
    """Two actions that call those with the old name were added, which stayed."""
    project = project_of(ENTERED + "ACTION Other:\nFill_exit();\nEND_ACTION\n")
    before = sfc.dumps(project).decode()
    chart_of(project).rename_step("Fill", "Pour")
    assert sfc.dumps(project).decode() == before.replace("Fill", "Pour")
