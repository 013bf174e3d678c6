"""Lowered code is proven as it is in the file, in Python as on the command line."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind
from plcopen_sfc.analysis.verdict import UntestedError
from plcopen_sfc.errors import ArgumentError, LossError, LoweringError, SfcError
from plcopen_sfc.languages.networks import draw_fbd
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.lowering import lower_project
from plcopen_sfc.lowering.written_code import refuse_uncompiled
from plcopen_sfc.report import ConversionReport, Outcome
from tests.lowering.charts import boolean, training_chain


def plant(*names: str) -> m.Project:
    """A project of CODESYS with a training chain under each of these names."""
    return m.Project(
        name="Plant",
        pous=[training_chain().model_copy(deep=True, update={"name": name}) for name in names],
        dialect=m.Dialect.CODESYS,
    )


def with_action(text: str) -> m.Project:
    project = plant("Ablauf")
    (pou,) = project.pous
    assert pou.sfc is not None
    assert pou.interface is not None
    pou.sfc.steps[1].main_action = "Blink"
    pou.actions = [m.Action(name="Blink", body=m.StBody(text=text))]
    pou.interface.sections[1].variables += [boolean("Q5")]
    return project


def test_saved_code_is_proven_as_its_tool_reads_it(tmp_path: Path) -> None:
    lowered = sfc.lower(plant("Ablauf"), "case", target="scl")
    report = sfc.save(lowered, tmp_path / "chain.scl", format="scl", partial=True)
    assert list(report.compared) == ["POU Ablauf"]
    assert report.compared["POU Ablauf"].startswith("equal (proof: ")
    assert report.written == [str(tmp_path / "chain.scl")]
    assert "CASE" in (tmp_path / "chain.scl").read_text(encoding="utf-8-sig")


@pytest.mark.slow
def test_verdicts_and_their_order_are_the_same_in_several_processes(tmp_path: Path) -> None:
    project = plant("Second", "Broken", "First")
    stuck = project.pous[1]
    assert stuck.sfc is not None
    assert stuck.interface is not None
    stuck.interface.sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=[boolean("Never")]))
    stuck.sfc.transitions[0].condition = m.Expression(text="Never")
    made = [
        sfc.lower_to_file(project, str(tmp_path / f"{jobs}.scl"), "case", skip_refused=skip, jobs=jobs, partial=True)
        for jobs in (1, 2)
        for skip in (False, True)
    ]
    for one, two in ((made[0], made[2]), (made[1], made[3])):
        assert [(each.name, str(each.proof)) for each in one.pous] == [(e.name, str(e.proof)) for e in two.pous]
        assert [(name, str(e)) for name, e in one.refused.items()] == [
            (name, str(e)) for name, e in two.refused.items()
        ]
    assert [each.name for each in made[3].pous] == ["Second", "First"]
    assert (tmp_path / "1.scl").read_bytes() == (tmp_path / "2.scl").read_bytes()


def test_functions_that_no_other_process_can_get_are_an_error(tmp_path: Path) -> None:
    """It waited for ever: a pool whose work cannot be pickled does not end."""
    functions = {"Twice": lambda value: 2 * value}
    with pytest.raises(SfcError, match="cannot be sent to another process"):
        sfc.lower_to_file(plant("A", "B"), str(tmp_path / "a.scl"), "case", functions=functions, jobs=2)


def test_jobs_are_a_number_of_processes(tmp_path: Path) -> None:
    with pytest.raises(ArgumentError, match="jobs needs a number of processes, not 0"):
        sfc.lower_to_file(plant("Ablauf"), str(tmp_path / "a.scl"), "case", jobs=0)


def test_code_that_only_we_read_is_not_saved(tmp_path: Path) -> None:
    """SCL has no actions: the one that returns stays a call and is refused, else it would be in a comment."""
    project = with_action("IF NOT B5 THEN RETURN; END_IF\nQ5 := NOT Q5;")
    lowered = sfc.lower(project, "case", target="scl")
    assert lowered.proof is not None
    assert lowered.proof.proven
    with pytest.raises(LoweringError, match="no actions and methods to call: Blink") as caught:
        sfc.save(lowered, tmp_path / "chain.scl", format="scl", partial=True)
    assert caught.value.location.path == "POU Ablauf"
    assert list(tmp_path.iterdir()) == []
    sfc.save(lowered, tmp_path / "chain.xml", format="codesys")
    assert sfc.load(tmp_path / "chain.xml").pou("Ablauf").actions


def test_networks_are_structured_text_in_scl(tmp_path: Path) -> None:
    """They were in comments only, and the program empty."""
    lowered = sfc.lower(plant("Ablauf"), "case", target="scl")
    selection = draw_fbd(parse_statements("Q := SEL(a, 1, 17);").tree.statements).body
    lowered.project.pous.append(m.Pou(name="Main", kind=m.PouKind.PROGRAM, bodies=[selection]))
    report = sfc.save(lowered, tmp_path / "chain.scl", format="scl", partial=True)
    assert report.compared["POU Ablauf"].startswith("equal (proof: ")
    assert "Q := SEL(G := a, IN0 := 1, IN1 := 17);" in (tmp_path / "chain.scl").read_text("utf-8-sig").replace('"', "")


def test_what_was_not_to_be_verified_is_saved_as_it_is() -> None:
    lowered = sfc.lower(with_action("IF NOT B5 THEN RETURN; END_IF\nQ5 := NOT Q5;"), "case", target="scl", verify=False)
    content = io.BytesIO()
    report = sfc.save(lowered, content, format="scl", partial=True)
    assert b"CASE" in content.getvalue()
    assert report.compared == {}


def test_saving_accepts_untested_code_as_lowering_did(tmp_path: Path) -> None:
    """The second step needs a variable that nothing writes and that is no input."""
    project = plant("Ablauf")
    (pou,) = project.pous
    assert pou.interface is not None
    inputs = next(s for s in pou.interface.sections if s.kind is m.SectionKind.INPUT)
    frozen = [v for v in inputs.variables if v.name == "B1"]
    inputs.variables = [v for v in inputs.variables if v.name != "B1"]
    pou.interface.sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=frozen))
    with pytest.raises(UntestedError):
        sfc.lower(project, "case")
    content = io.BytesIO()
    report = sfc.save(sfc.lower(project, "case", accept_untested=True), content, format="codesys")
    assert "not all was reached" in report.compared["POU Ablauf"] or "not reached" in report.compared["POU Ablauf"]
    free = sfc.lower(project, "case", free_inputs=["B1"])
    assert "proof" in sfc.save(free, io.BytesIO(), format="codesys").compared["POU Ablauf"]


def test_all_charts_of_a_project_go_into_one_file(tmp_path: Path) -> None:
    target = tmp_path / "plant.xml"
    made = sfc.lower_to_file(plant("One", "Two"), str(target), "case", format="codesys")
    assert made.path == str(target)
    assert made.refused == {}
    assert [each.name for each in made.pous] == ["One", "Two"]
    assert all(each.proof is not None and each.proof.kind is VerdictKind.PROVEN for each in made.pous)
    assert list(sfc.load(target).charts()) == []


@pytest.mark.slow
def test_a_chart_whose_code_is_not_in_the_file_is_refused_and_can_be_skipped(tmp_path: Path) -> None:
    project = with_action("IF NOT B5 THEN RETURN; END_IF\nQ5 := NOT Q5;")
    project.pous += plant("Other").pous
    target = tmp_path / "plant.scl"
    made = sfc.lower_to_file(project, str(target), "case", format="scl")
    assert made.path is None
    assert list(made.refused) == ["Ablauf"]
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(LossError, match="chart POU Ablauf: the block is empty") as caught:
        sfc.lower_to_file(project, str(target), "case", format="scl", skip_refused=True)
    assert "Ablauf was not lowered: " in str(caught.value.hint)
    assert list(tmp_path.iterdir()) == []
    made = sfc.lower_to_file(project, str(target), "case", format="scl", skip_refused=True, partial=True)
    assert made.path == str(target)
    assert [each.name for each in made.pous] == ["Other"]
    assert list(made.refused) == ["Ablauf"]


def test_code_that_the_target_does_not_compile_is_not_saved(tmp_path: Path) -> None:
    text = b"""PROGRAM Main
    VAR_INPUT a : BOOL; b : BOOL; END_VAR
    VAR q : BOOL; day : INT; END_VAR
    INITIAL_STEP S0: Run(N); END_STEP
    STEP S1: q(N); END_STEP
    TRANSITION FROM S0 TO S1 := b; END_TRANSITION
    TRANSITION FROM S1 TO S0 := NOT a; END_TRANSITION
    ACTION Run: day := DAY_OF_WEEK(D#2024-02-29); END_ACTION
    END_PROGRAM"""
    lowered = sfc.lower(sfc.loads(text, format="iec-text"), "case", target="scl")
    with pytest.raises(LoweringError, match="SCL has no function DAY_OF_WEEK"):
        sfc.save(lowered, tmp_path / "main.scl", format="scl", partial=True)
    assert list(tmp_path.iterdir()) == []


def test_a_call_of_an_action_that_returns_is_refused_for_scl_with_what_to_do(tmp_path: Path) -> None:
    project = with_action("IF B2 THEN RETURN; END_IF;\nQ5 := TRUE;")
    made = sfc.lower_to_file(project, str(tmp_path / "main.scl"), "case", format="scl", verify=False)
    assert "S7 has no actions and methods to call: Blink" in made.refused["Ablauf"].message
    assert made.refused["Ablauf"].hint == "Write Blink in structured text without RETURN, jumps and calls of itself."
    assert list(tmp_path.iterdir()) == []


def test_a_program_that_others_call_is_refused_where_it_becomes_a_block(tmp_path: Path) -> None:
    project = plant("Ablauf")
    project.pous[0].kind = m.PouKind.PROGRAM
    project.pous.append(m.Pou(name="Main", kind=m.PouKind.PROGRAM, bodies=[m.StBody(text="Ablauf(B1 := TRUE);")]))
    made = sfc.lower_to_file(project, str(tmp_path / "main.xml"), "case", format="plcopen", partial=True)
    assert "it is the function block Ablauf_block in the file" in made.refused["Ablauf"].message
    assert "Make it a function block" in made.refused["Ablauf"].hint


def test_charts_of_pous_with_one_name_are_refused() -> None:
    """Else the code of one would be put in the place of the other, or one would stay a chart in silence."""
    project = plant("Ablauf", "ABLAUF")
    for pou in project.pous:
        with pytest.raises(LoweringError, match="the project has 2 POUs called") as caught:
            sfc.lower(pou, "case", verify=False)
        assert caught.value.hint == "Rename or delete all but one."
    made = lower_project(project, "case")
    assert made.pous == ()
    assert set(made.refused) == {"Ablauf", "ABLAUF"}


@pytest.mark.slow
def test_drawn_actions_that_a_text_cannot_hold_are_not_saved(tmp_path: Path) -> None:
    """The file had an undeclared name in the place of the body, and the code was proven without it."""
    project = sfc.load(Path("fixtures/codesys/sorting_conveyor.xml"))
    made = sfc.lower_to_file(project, str(tmp_path / "main.st"), format="iec-text", pou="PLC_PRG", verify=False)
    assert "NOT_EXECUTED_ACT_Belt is in its place" in str(made.refused["PLC_PRG"])
    assert made.path is None


def test_a_project_is_not_written_without_the_programs_that_its_target_does_not_execute(tmp_path: Path) -> None:
    """The chart was proven, and the program beside it, which calls it, was empty."""
    project = plant("Ablauf")
    project.pous.append(m.Pou(name="Main", kind=m.PouKind.PROGRAM, bodies=[m.OpaqueBody(source="x", content="")]))
    with pytest.raises(LossError, match="body POU Main: the block is empty"):
        sfc.lower_to_file(project, str(tmp_path / "a.scl"), "case", verify=False)
    assert list(tmp_path.iterdir()) == []
    made = sfc.lower_to_file(project, str(tmp_path / "a.scl"), "case", verify=False, partial=True)
    assert [item.path for item in made.report.with_outcome(Outcome.NOT_EXECUTED)] == ["POU Main"]


def test_variables_of_the_code_are_declared_in_the_file() -> None:
    lowered = sfc.lower(plant("Ablauf"), "bits")
    seen = lowered.project.model_copy(deep=True)
    refuse_uncompiled(ConversionReport(), seen, lowered)
    (pou,) = seen.pous
    assert pou.interface is not None
    for section in pou.interface.sections:
        section.variables = [each for each in section.variables if each.name != "X3"]
    with pytest.raises(LoweringError, match="the file does not declare X3"):
        refuse_uncompiled(ConversionReport(), seen, lowered)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "name", "needed"),
    [
        ("device_export.xml", "PRG_Pumps", ["F_Bar", "FB_Runtime", "PRG_Pumps"]),
        ("distribution_belt.xml", "Ablauf_Band", ["Ablauf_Band"]),
    ],
)
def test_a_source_of_scl_has_the_pou_that_was_asked_for_and_what_it_needs(
    file: str, name: str, needed: list[str], tmp_path: Path
) -> None:
    project, path = sfc.load(Path("fixtures/codesys") / file), tmp_path / "main.scl"
    made = sfc.lower_to_file(project, str(path), format="scl", pou=name, verify=False, partial=True)
    blocks = [pou.name for pou in sfc.load(path).pous if pou.kind is not m.PouKind.ORGANIZATION_BLOCK]
    assert blocks == needed
    left_out = {item.path for item in made.report.items if "not asked for" in item.why}
    assert left_out == {f"POU {pou.name}" for pou in project.pous} - {f"POU {each}" for each in needed}


def test_a_source_of_scl_has_nothing_of_the_rest_of_the_project(tmp_path: Path) -> None:
    project, path = sfc.load("fixtures/codesys/sorting_conveyor.xml"), tmp_path / "pusher.scl"
    made = sfc.lower_to_file(project, str(path), format="scl", pou="FB_Pusher", verify=False)
    text = path.read_text(encoding="utf-8-sig")
    assert "GVL_" not in text
    assert "ACT_Classify" not in text
    assert "// Chart FB_Pusher of sorting_conveyor.xml, CODESYS V3.5 SP18 Patch 3, as code" in text
    assert not [item for item in made.report.items if item.what == "global variable"]


def test_a_text_for_matiec_has_the_pou_that_was_asked_for_and_what_it_needs(tmp_path: Path) -> None:
    """The program beside it does not compile, and a resource that runs nothing does not either."""
    text = """CONFIGURATION Config
VAR_GLOBAL
    Lamp : BOOL;
END_VAR
RESOURCE Res ON PLC
    PROGRAM Inst : Other;
END_RESOURCE
END_CONFIGURATION
PROGRAM Other
VAR x : Unknown; END_VAR
x := 'text';
END_PROGRAM
FUNCTION_BLOCK Main
VAR_EXTERNAL Lamp : BOOL; END_VAR
VAR_INPUT Start : BOOL; END_VAR
INITIAL_STEP Wait: END_STEP
STEP Run: Lamp(N); END_STEP
TRANSITION FROM Wait TO Run := Start; END_TRANSITION
TRANSITION FROM Run TO Wait := NOT Start; END_TRANSITION
END_FUNCTION_BLOCK
"""
    project, path = sfc.loads(text.encode(), format="iec-text"), tmp_path / "main.st"
    made = sfc.lower_to_file(project, str(path), pou="Main", flavour="matiec")
    assert made.pous[0].proof is not None
    assert made.pous[0].proof.proven
    written = path.read_text()
    assert "Other" not in written
    assert "RESOURCE" not in written
    assert "//" not in written
    assert [item.path for item in made.report.with_outcome(Outcome.NOT_EXECUTED)] == ["POU Other"]


@pytest.mark.parametrize("form", ["iec-text", "plcopen"])
def test_actions_are_where_they_are_called_for_compilers_that_have_those_of_charts_only(
    form: str, tmp_path: Path
) -> None:
    flavour = {"iec-text": "matiec", "plcopen": "beremiz"}[form]
    project, path = with_action("Q5 := NOT NOT B2; // twice"), tmp_path / "main"
    made = sfc.lower_to_file(project, str(path), "case", format=form, flavour=flavour)
    assert made.pous[0].proof is not None
    assert made.pous[0].proof.proven
    (pou,) = sfc.load(path, format=form).pous
    assert pou.actions == []
    assert isinstance(pou.body, m.StBody)
    assert "Q5 := NOT (NOT B2);" in pou.body.text


@pytest.mark.parametrize(("call", "stays"), [("", False), ("Blink();", False), ("chain.Blink();", True)])
def test_an_action_stays_where_other_blocks_call_it(call: str, stays: bool, tmp_path: Path) -> None:
    """An action of theirs with the same name is not meant."""
    project = with_action("Q5 := NOT Q5;")
    kind = m.DerivedType(name="Ablauf")
    locals_ = m.VariableSection(
        kind=m.SectionKind.LOCAL, variables=[m.Variable(name="chain", type=kind), boolean("Q5")]
    )
    actions = [m.Action(name="Blink", body=m.StBody(text="Q5 := TRUE;"))]
    body, interface = m.StBody(text=f"chain(); {call}"), m.Interface(sections=[locals_])
    project.pous.append(m.Pou(name="Main", kind=m.PouKind.PROGRAM, interface=interface, bodies=[body], actions=actions))
    made = lower_project(project, "case", pou="Ablauf", target="iec-text", flavour="matiec")
    assert [each.name for each in made.project.pou("Ablauf").actions] == (["Blink"] if stays else [])


def test_names_that_nothing_declares_are_refused_for_compilers_of_a_text(tmp_path: Path) -> None:
    """Other tools may declare them in the project that the code is for."""
    project, path = with_action("Blinks := Blinks + 1;"), tmp_path / "main.st"
    with pytest.raises(LossError, match="nothing in the project declares `Blinks`"):
        sfc.lower_to_file(project, str(path), "case", flavour="matiec", verify=False)
    assert not path.exists()
    made = sfc.lower_to_file(project, str(path), "case", flavour="matiec", verify=False, partial=True)
    assert [item.what for item in made.report.losses if "Blinks" in item.why] == ["undeclared name"]
    assert sfc.lower_to_file(project, str(path), "case", verify=False).path is not None


@pytest.mark.parametrize("task", ["", "TASK Fast(INTERVAL := T#100ms, PRIORITY := 0);"])
def test_a_program_that_no_task_names_is_run_in_matiec_as_before(task: str, tmp_path: Path) -> None:
    text = f"""PROGRAM Main
VAR_OUTPUT Lamp : BOOL; END_VAR
INITIAL_STEP Wait: END_STEP
STEP Run: Lamp(N); END_STEP
TRANSITION FROM Wait TO Run := TRUE; END_TRANSITION
TRANSITION FROM Run TO Wait := TRUE; END_TRANSITION
END_PROGRAM
CONFIGURATION Config
RESOURCE Res ON PLC
    {task}
    PROGRAM Inst : Main;
END_RESOURCE
END_CONFIGURATION
"""
    project = sfc.loads(text.encode(), format="iec-text")
    _, report = sfc.convert(project, "iec-text", flavour="matiec")
    made = sfc.lower_to_file(project, str(tmp_path / "main.st"), pou="Main", flavour="matiec", verify=False)
    for each in (report, made.report):
        assert not each.with_outcome(Outcome.NOT_EXECUTED)
        assert [item.what for item in each.with_outcome(Outcome.TRANSLATED)].count("task") == (not task)


def test_a_case_without_branches_is_not_compiled() -> None:
    lowered = sfc.lower(plant("Ablauf"), "case")
    assert isinstance(lowered.pou.body, m.StBody)
    lowered.pou.body.text += "CASE step_number OF\nEND_CASE;\n"
    with pytest.raises(LoweringError, match="a CASE has no branches: step_number"):
        refuse_uncompiled(ConversionReport(), lowered.project, lowered)


def test_global_variables_that_the_code_names_must_be_in_the_project(tmp_path: Path) -> None:
    project, path = sfc.load("fixtures/steplist/mixer.csv"), tmp_path / "mixer.scl"
    project.global_variables[0].variables.append(boolean("Spare"))
    made = sfc.lower_to_file(project, str(path), format="scl", pou="Mixer", verify=False)
    named = [item.path for item in made.report.items if item.what == "global variable"]
    assert "Start" in named
    assert "Spare" not in named


def test_tags_in_the_place_of_a_list_are_those_of_the_chart(tmp_path: Path) -> None:
    """A source of SCL declares no tags: ``GVL.Start`` is the tag ``Start`` of the project that the source is for."""
    variables = [
        boolean("Start").model_copy(update={"address": "%IX0.0"}),
        boolean("Lamp").model_copy(update={"address": "%QX0.0"}),
    ]
    project = m.Project(
        dialect=m.Dialect.CODESYS,
        global_variables=[m.VariableSection(kind=m.SectionKind.GLOBAL, name="GVL", variables=variables)],
    )
    idle, work = sfc.step("Idle", initial=True), sfc.step("Work", actions=["N GVL.Lamp"])
    project.add_program("Main", idle, "GVL.Start", work, "NOT GVL.Start", sfc.jump("Idle"))
    (made,) = sfc.lower_to_file(project, str(tmp_path / "main.scl"), format="scl").pous
    assert made.proof is not None
    assert made.proof.proven
    assert 'IF "Start" THEN' in (tmp_path / "main.scl").read_text(encoding="utf-8-sig")


_WITH_GLOBAL = """
VAR_GLOBAL Valve, Ready : BOOL; END_VAR
PROGRAM Main
VAR_INPUT Start : BOOL; END_VAR
VAR_OUTPUT Q : BOOL; END_VAR
INITIAL_STEP Init: END_STEP
TRANSITION FROM Init TO Run := Start AND Ready; END_TRANSITION
STEP Run: Q(N); Valve(S); END_STEP
TRANSITION FROM Run TO Init := NOT Start; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.parametrize("target", ["scl", "simaticml"])
@pytest.mark.parametrize("name", [None, "GVL"])
def test_global_variables_that_a_chart_writes_are_those_in_data_blocks(
    name: str | None, target: str, tmp_path: Path
) -> None:
    project = sfc.loads(_WITH_GLOBAL.encode(), format="iec-text")
    project.global_variables[0].name = name
    made = sfc.lower_to_file(project, str(tmp_path / "main"), "case", format=target, free_inputs="all")
    assert made.pous[0].proof is not None
    assert made.pous[0].proof.proven
    assert f"{name}.Valve" if name else "Valve" in made.pous[0].proof.compared

    def written(text: str) -> m.Project:
        """The project in the data block of whose file is what a chart with `text` writes."""
        other = sfc.loads(_WITH_GLOBAL.replace("Valve(S)", text).encode(), format="iec-text")
        other.global_variables[0].name = name
        path = str(tmp_path / "other")
        sfc.lower_to_file(other, path, "case", format=target, accept_untested=True)
        return sfc.load(path, format=target, as_tool=True)

    found = sfc.equivalent(project, written("Valve(N)"), "iec", free_inputs="all")
    assert found.different, str(found)
    assert sfc.equivalent(written("Valve(S)"), project, "iec", free_inputs="all").proven


@pytest.mark.parametrize("target", ["scl", "simaticml"])
def test_external_variables_are_the_global_ones_alone(target: str, tmp_path: Path) -> None:
    """The list of sections was compared with that of the text, in which VAR_EXTERNAL is not: all others were lost."""
    external = "VAR_EXTERNAL Valve, Ready : BOOL; END_VAR"
    text = _WITH_GLOBAL.replace("VAR_OUTPUT", f"{external} VAR_OUTPUT")
    path = tmp_path / "main"
    made = sfc.lower_to_file(sfc.loads(text.encode(), format="iec-text"), str(path), format=target, free_inputs="all")
    assert made.pous[0].proof is not None
    assert made.pous[0].proof.proven
    assert [item for item in made.report.items if item.what in ("sections", "variables", "section")] == []
    assert "external" not in path.read_text(encoding="utf-8-sig").casefold()
    assert not made.pous[0].losses


_WITH_ENUMERATION = """
TYPE Mode : (Off, Fast := 5, Broken); END_TYPE
VAR_GLOBAL Last : Mode; END_VAR
FUNCTION_BLOCK Main
VAR_INPUT Start : BOOL; END_VAR
VAR_OUTPUT Now : Mode := Fast; Mode_Off : BOOL; END_VAR
INITIAL_STEP Init: Rest(N); END_STEP
TRANSITION FROM Init TO Run := Start AND Now <> Mode#Broken; END_TRANSITION
STEP Run: Work(N); END_STEP
TRANSITION FROM Run TO Init := NOT Start; END_TRANSITION
ACTION Rest: Now := Off; Mode_Off := TRUE; END_ACTION
ACTION Work: Last := Now; Now := Mode#Fast; Mode_Off := FALSE; END_ACTION
END_FUNCTION_BLOCK
"""


def test_values_of_enumerations_are_constants_of_the_block_in_scl(tmp_path: Path) -> None:
    path = tmp_path / "main.scl"
    made = sfc.lower_to_file(sfc.loads(_WITH_ENUMERATION.encode(), format="iec-text"), str(path), "case")
    assert not made.refused
    proof = made.pous[0].proof
    assert proof is not None
    assert proof.proven
    assert {"Now", "Last"} <= set(proof.compared)
    text = path.read_text(encoding="utf-8-sig")
    constants = {"Mode_Off_2": "0", "Mode_Fast": "5", "Mode_Broken": "6"}  # `Mode_Off` is a variable
    assert {name for name in constants if f"{name} : Int := {constants[name]};" in text} == set(constants)
    for each in ("#Now := #Mode_Off_2;", "#Now := #Mode_Fast;", "#Now <> #Mode_Broken", "Now : Int := 5;"):
        assert each in text
    assert "TYPE" not in text
    assert ".text :=" not in text  # no comment has the text of the block once more


def test_a_refusal_tells_the_cause_that_the_report_knows(tmp_path: Path) -> None:
    text = """FUNCTION_BLOCK Main
VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR VAR edge : F_TRIG; END_VAR
INITIAL_STEP S0: Act(N); END_STEP
TRANSITION FROM S0 TO S0 := a; END_TRANSITION
ACTION Act: edge(CLK := a); IF edge.Q THEN n := 1; END_IF; END_ACTION
END_FUNCTION_BLOCK
"""
    (error,) = sfc.lower_to_file(sfc.loads(text.encode()), str(tmp_path / "main.scl")).refused.values()
    assert "the first call of edge with FALSE is a falling edge in the source" in error.hint
