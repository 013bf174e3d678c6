"""diff: known edits are found again, and nothing else is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import ChangeKind
from plcopen_sfc.errors import ArgumentError
from plcopen_sfc.model import BodyCondition, FbdBody, LdBody, StructType
from plcopen_sfc.model.dialect import Dialect
from tests.corpus import corpus_files
from tests.samples import FIXTURES
from tests.sweeps import some_of


@dataclass(frozen=True)
class EditedPlaces:
    """Where a fixture is edited. `row` is an action of a step, `condition` a transition with its expression."""

    file: str
    pou: str
    renamed: str
    timed: str
    row: tuple[str, str] | None
    selection: str
    variable: str
    code: str
    condition: tuple[str, str]


PLACES = [
    EditedPlaces("plcopen/filling_station_1.01.xml", "FillingStation", "Clamp", "Drip", ("Fill", "K2_DosingPump"),
           "CheckBatch", "S1_Start", "FillingStation.ACT_CountBottle",
           ("Fill -> Drip", "LevelOk AND NOT B4_Overflow")),
    EditedPlaces("plcopen/filling_station_2.0.xml", "FillingStation", "Unclamp", "Cap", ("Drip", "Y3_DripTray"),
           "Infeed", "B5_Torque", "FillingStation.ACT_PrintLabel", ("Init -> Idle", "TankReady")),
    EditedPlaces("plcopen/filling_station_2.01.xml", "FillingStation", "FillDone", "Idle", ("Clamp", "H2_Horn"),
           "CheckBatch", "B2_Clamped", "LimitRate", ("BatchDone -> Idle", "S4_Reset")),
    EditedPlaces("codesys/sorting_conveyor.xml", "PLC_PRG", "WaitPart", "Homing", ("Measure", "bMeasure"),
           "Measure", "bFault", "PLC_PRG.ACT_Classify", ("CycleEnd -> Idle", "GVL_IO.S2_Stop")),
    EditedPlaces("twincat/press_station.xml", "FB_Press", "Close", "Jog", ("HoldForce", "bDone"),
           "Init_Press", "bSetup", "FB_Press.ACT_Open", ("Finish -> Init_Press", "NOT bExecute")),
    EditedPlaces("codesys23/distribution_belt.EXP", "Ablauf", "Warten", "Zu_Platz3", None,
           "Pruefen", "Gependelt", "Ablauf.Zaehlen", ("Bereit -> Zu_Platz3", "S1_Start AND Platz1")),
    EditedPlaces("iectext/mixing_plant.st", "Mixer", "Done", "Drain", ("Stir", "M1_Rührer"),
           "Fill", "LevelLow", "Mixer.CountBatch", ("Stir+Signal -> Drain", "Stir.T >= tStir")),
    EditedPlaces("simaticml-plc", "FB_Drilling", "Lift", "Clamp", ("Cool", "#coolant"),
           "Dwell", "guard", "FB_Chips", ("T_Deep", "#atBottom")),
]  # fmt: skip


def loaded(file: str) -> sfc.Project:
    return sfc.load(FIXTURES / file)


def told(diff: sfc.ProjectDiff) -> list[str]:
    """Every change in one line, without the lines of program text."""
    return sorted(f"{change.place}: {change.news}" for change in diff.changes)


def edits(project: sfc.Project, at: EditedPlaces) -> Iterator[str]:
    """Edit a project in every way; yield the line that tells each edit."""
    pou = project.pou(at.pou)
    chart, main = pou.chart, pou.report_path
    label, condition = at.condition
    chart.transition(label).condition = "1 = 61"
    yield f"{main} / transition {label}: condition {condition} -> 1 = 61"
    chart.rename_step(at.renamed, "Zz9_Step")
    yield f"{main} / step Zz9_Step: renamed, was {at.renamed}"
    timed = chart.step(at.timed)
    before, timed.max_time = timed.max_time, "T#17s"
    yield f"{main} / step {at.timed}: maximum time " + (f"{before} -> T#17s" if before else "T#17s added")
    if at.row is not None:
        step, target = at.row
        row = next(row for row in chart.step(step).actions if row.target == target)
        action = f"{main} / step {step} / action {target.strip('#')}"
        yield f"{action}: time {row.duration} -> T#61s"
        yield f"{action}: qualifier {row.qualifier} -> SD"
        row.duration, row.qualifier = "T#61s", "SD"
    competing = chart.outgoing(chart.step(at.selection))
    targets = [each.name or "+".join(chart.step(i).name for i in each.targets) for each in competing]
    for priority, transition in enumerate(reversed(competing), start=1):
        transition.priority = priority
    order = f"{', '.join(targets)} -> {', '.join(reversed(targets))}"
    yield f"{main} / step {at.selection}: order of transitions to {order}"
    chart.add_step("Zz9_Extra")
    yield f"{main} / step Zz9_Extra: added"
    chart.add_transition(at.timed, "Zz9_Extra", "2 = 61")
    yield f"{main} / transition {at.timed} -> Zz9_Extra: added (2 = 61)"
    project.rename(f"{at.pou}.{at.variable}", "Zz9_Variable")
    yield f"{main} / variable Zz9_Variable: renamed, was {at.variable}"
    next(variable for variable in pou.variables() if variable.name == "Zz9_Variable").initial = "TRUE"
    yield f"{main} / variable Zz9_Variable: start value TRUE added"
    owner, body = next((owner, body) for name, owner, body in project.bodies() if name == at.code)
    body.text = f"{body.text.rstrip()}\nZz9_Added := 61;\n"
    yield f"{owner.report_path_of(at.code)}: code"
    project.pous.append(sfc.Pou(name="Zz9_Pou", kind="program"))
    yield "POU Zz9_Pou: added (program)"


QUICK = ("iectext/mixing_plant.st", "codesys23/distribution_belt.EXP")


@pytest.mark.parametrize(
    "at", [pytest.param(at, id=at.file, marks=() if at.file in QUICK else pytest.mark.slow) for at in PLACES]
)
def test_every_edit_is_found_and_nothing_else(at):
    before, after = loaded(at.file), loaded(at.file)
    expected = sorted(edits(after, at))
    diff = sfc.diff(before, after)
    assert told(diff) == expected
    code = next(change for change in diff.changes if change.aspect == "code")
    assert [line for line in code.lines if line[0] in "+-"] == ["+Zz9_Added := 61;"]
    # the other way round the same things are told with what was before and after exchanged
    back = sfc.diff(after, before)
    assert len(back.changes) == len(expected)
    assert {change.kind for change in back.changes} == {ChangeKind.RENAMED, ChangeKind.CHANGED, ChangeKind.REMOVED}
    assert sfc.diff(before, loaded(at.file)).changes == ()  # diff changes neither project


class TestChart:
    @pytest.fixture
    def sides(self):
        return loaded("training-chain/model.json"), loaded("training-chain/model.json")

    def test_all_steps_can_be_renamed(self, sides):
        before, after = sides
        after.rename_many({f"Ablauf.S{number}": f"N{number}0" for number in range(1, 5)})
        assert told(sfc.diff(before, after)) == [
            f"POU Ablauf / step N{number}0: renamed, was S{number}" for number in range(1, 5)
        ]

    def test_renumbered_steps_of_a_selection_are_not_confused(self):
        def built(name):
            chart = sfc.SfcNetwork()
            first, last = chart.add_step(name(0), initial=True), chart.add_step(name(99))
            for branch in range(1, 13):
                step = chart.add_step(name(branch))
                step.actions.append(sfc.ActionAssociation(id=chart.new_id(), target=f"q{branch % 3}"))
                chart.add_transition(first, step, f"x = {branch}")
                chart.add_transition(step, last, f"y = {branch % 5}")
            chart.add_transition(last, first, "TRUE")
            return sfc.Project(pous=[sfc.Pou(name="Main", kind="program", bodies=[sfc.SfcBody(chart=chart)])])

        before, after = built(lambda number: f"S{number}"), built(lambda number: f"N{number * 10}")
        after.pou("Main").chart.step("N70").max_time = "T#7s"
        diff = sfc.diff(before, after)
        renamed = {change.before: change.after for change in diff.changes if change.kind is ChangeKind.RENAMED}
        assert renamed == {f"S{number}": f"N{number * 10}" for number in (*range(13), 99)}
        assert [str(change) for change in diff.changes if change.kind is not ChangeKind.RENAMED] == [
            "POU Main / step N70: maximum time T#7s added"
        ]

    def test_names_that_were_exchanged_are_two_renames(self, sides):
        before, after = sides
        after.rename_many({"Ablauf.S2": "S4", "Ablauf.S4": "S2"})
        assert told(sfc.diff(before, after)) == [
            "POU Ablauf / step S2: renamed, was S4",
            "POU Ablauf / step S4: renamed, was S2",
        ]

    def test_steps_that_are_numbered_by_tens_are_renamed(self):
        """The first one gets the name that the tenth had, and is it not: all were removed and added."""

        def built(names):
            chart = sfc.SfcNetwork()
            steps = [chart.add_step(name, initial=not number) for number, name in enumerate(names)]
            for number, (step, following) in enumerate(zip(steps, [*steps[1:], steps[0]], strict=True)):
                step.actions.append(sfc.ActionAssociation(id=chart.new_id(), target=f"q{number % 3}"))
                chart.add_transition(step, following, f"x = {number}")
            return sfc.Project(pous=[sfc.Pou(name="Main", kind="program", bodies=[sfc.SfcBody(chart=chart)])])

        before = built([f"S{number}" for number in range(1, 15)])
        after = built([f"S{number}0" for number in range(1, 15)])
        after.pou("Main").chart.step("S70").max_time = "T#7s"
        assert sorted(told(sfc.diff(before, after))) == sorted(
            [
                *(f"POU Main / step S{number}0: renamed, was S{number}" for number in range(1, 15)),
                "POU Main / step S70: maximum time T#7s added",
            ]
        )

    def test_another_step_at_the_same_place_is_no_rename(self, sides):
        before, after = sides
        chart = after.pou("Ablauf").chart
        step = chart.step("S2")
        step.name = "Other"
        step.actions[:] = [sfc.ActionAssociation(id=77, target="Q1", qualifier="N")]
        step.max_time = "T#9s"
        lines = told(sfc.diff(before, after))
        assert "POU Ablauf / step Other: added" in lines
        assert "POU Ablauf / step S2: removed" in lines

    def test_a_transition_that_leads_elsewhere(self, sides):
        before, after = sides
        chart = after.pou("Ablauf").chart
        chart.transition("S4 -> S1").targets = [chart.step("S2").id]
        assert told(sfc.diff(before, after)) == ["POU Ablauf / transition S4 -> S1: target S1 -> S2"]

    def test_a_transition_with_a_name_that_leads_elsewhere(self):
        before, after = loaded("simaticml/FB_Drill.xml"), loaded("simaticml/FB_Drill.xml")
        chart = after.pou("FB_Drill").chart
        rest = chart.add_step("Rest", number=20)
        up = chart.transition("T_Up")
        chart.add_transition("Rest", "Release", "#DrillUp").name = "T_New"
        up.targets = [rest.id]
        lines = told(sfc.diff(before, after))
        assert "POU FB_Drill / transition T_Up: target Release -> Rest" in lines

    def test_a_step_that_is_elsewhere_in_the_flow_is_moved(self, sides):
        before, after = sides
        chart = after.pou("Ablauf").chart
        first, second, third, fourth = (chart.step(f"S{number}").id for number in range(1, 5))
        ways = [(first, third), (third, second), (second, fourth), (fourth, first)]
        for transition, (source, target) in zip(chart.transitions, ways, strict=True):
            transition.sources, transition.targets = [source], [target]
        diff = sfc.diff(before, after)
        moved = [str(change) for change in diff.changes if change.kind is ChangeKind.MOVED]
        assert moved == ["POU Ablauf / step S3: moved after S2 -> after S1"]
        assert all(change.what == "transition" for change in diff.changes if change.kind is not ChangeKind.MOVED)

    def test_an_action_of_another_step_now_is_moved(self, sides):
        before, after = sides
        chart = after.pou("Ablauf").chart
        chart.step("S1").actions.append(chart.step("S3").actions.pop())
        assert told(sfc.diff(before, after)) == ["POU Ablauf / step S1 / action Q3: moved step S3 -> step S1"]

    def test_a_deleted_step(self, sides):
        before, after = sides
        chart = after.pou("Ablauf").chart
        gone = chart.step("S3")
        chart.steps.remove(gone)
        chart.transitions.remove(chart.outgoing(gone)[0])
        chart.incoming(gone)[0].targets = [chart.step("S4").id]
        assert told(sfc.diff(before, after)) == [
            "POU Ablauf / step S3: removed",
            "POU Ablauf / transition S2 -> S3: target S3 -> S4",
            "POU Ablauf / transition S3 -> S4: removed (B3)",
        ]

    def test_order_of_actions_excluded_and_comments(self, sides):
        before, after = sides
        for project in sides:
            step = project.pou("Ablauf").chart.step("S1")
            step.actions.append(sfc.ActionAssociation(id=78, target="Q2", qualifier="R"))
        step.actions.reverse()
        step.exclude = True
        step.comment = "Wait for the\n operator"
        assert told(sfc.diff(before, after)) == [
            "POU Ablauf / step S1: comment Wait for the operator added",
            "POU Ablauf / step S1: excluded from the program",
            "POU Ablauf / step S1: order of actions Q1, Q2 -> Q2, Q1",
        ]

    def test_conditions_in_instruction_list(self, sides):
        def put(project, text):
            condition = {"kind": "body", "body": {"language": "IL", "text": text}}
            project.pou("Ablauf").chart.transitions[0].condition = condition

        before, after = sides
        put(after, "LD B1\nAND B2")  # an expression
        assert told(sfc.diff(before, after)) == ["POU Ablauf / transition S1 -> S2: condition B1 -> B1 AND B2"]
        put(before, "Again:\nLD B1\nJMPC Again\nLD B2")  # no expression
        put(after, "Again:\nLD B1\nJMPC Again\nLD B3")
        (change,) = sfc.diff(before, after).changes
        assert [line for line in change.lines if line[0] in "+-"] == ["-LD B2", "+LD B3"]

    def test_what_means_the_same_is_layout(self, sides):
        before, after = sides
        for project, text in zip(sides, ("B1 AND NOT B5", "(NOT (B5)) and B1"), strict=True):
            project.pou("Ablauf").chart.transitions[0].condition = text
        assert sfc.diff(before, after).changes == ()
        (change,) = sfc.diff(before, after, layout=True).changes
        assert change.kind is ChangeKind.LAYOUT
        assert sfc.diff(before, after, layout=True).equal


class TestProject:
    @pytest.fixture
    def sides(self):
        return loaded("codesys/sorting_conveyor.xml"), loaded("codesys/sorting_conveyor.xml")

    @pytest.mark.slow
    def test_renamed_pous_actions_types_and_variables(self, sides):
        before, after = sides
        after.rename("FB_Pusher.qValve", "Valve")
        after.rename("PLC_PRG.ACT_Home", "Home")
        after.rename("FB_Pusher", "Pusher")
        after.rename("GVL_IO.S2_Stop", "S2_Halt")
        after.rename("E_Material", "Material")
        assert told(sfc.diff(before, after)) == [
            "POU PLC_PRG / action Home: renamed, was ACT_Home",
            "POU Pusher / variable Valve: renamed, was qValve",
            "POU Pusher: renamed, was FB_Pusher",
            "global variable GVL_IO.S2_Halt: renamed, was S2_Stop",
            "type Material: renamed, was E_Material",
        ]

    def test_declarations(self, sides):
        before, after = sides
        pou = after.pou("FB_Pusher")
        variables = {variable.name: variable for variable in pou.variables()}
        variables["uiJams"].type = "UDINT"
        variables["qJam"].comment = "jammed"
        variables["xQuit"].address = "%IX4.1"
        pou.interface.sections[-1].retain = True
        pou.interface.sections[-1].variables.append(sfc.Variable(name="Zz9", type="TIME", initial="T#5s"))
        next(each for each in after.data_types if each.name == "ST_Part").type.members.pop()
        assert told(sfc.diff(before, after)) == [
            "POU FB_Pusher / variable Zz9: added (TIME)",
            "POU FB_Pusher / variable qJam: comment jammed added",
            "POU FB_Pusher / variable uiJams: RETAIN",
            "POU FB_Pusher / variable uiJams: type UINT -> UDINT",
            "POU FB_Pusher / variable xQuit: address %IX4.1 added",
            "type ST_Part / member iColour: removed (INT)",
        ]

    def test_structures_that_are_declared_in_place(self, sides):
        for project in sides:
            one, other = (
                StructType(members=[sfc.Variable(name=name, type="INT") for name in ("x", "y")]) for _ in range(2)
            )
            array = {"kind": "array", "dimensions": [{"lower": "0", "upper": "3"}], "base": other}
            kinds = {"Point": one, "Line": array}
            section = project.pou("FB_Pusher").interface.sections[-1]
            section.variables += [sfc.Variable(name=name, type=kind) for name, kind in kinds.items()]
        before, after = sides
        point, line = section.variables[-2:]
        point.type.members[0].initial = "7"
        line.type.base.members[1].type = "DINT"
        lines = [str(change) for change in sfc.diff(before, after).changes]
        assert lines[0] == "POU FB_Pusher / Point / member x: start value 7 added"
        assert lines[1].startswith("POU FB_Pusher / variable Line: type\n")
        assert [line for line in lines[1].splitlines() if "y :" in line] == ["    -    y : INT;", "    +    y : DINT;"]
        del section.variables[-2:]
        assert told(sfc.diff(before, after)) == [
            "POU FB_Pusher / variable Line: removed (ARRAY [0..3] OF STRUCT ..)",
            "POU FB_Pusher / variable Point: removed (STRUCT)",
        ]

    def test_tasks(self):
        before, after = (loaded("plcopen/filling_station_2.01.xml") for _ in range(2))
        task = next(task for resource in after.resources() for task in resource.tasks)
        task.priority += 3
        task.interval = "T#50ms"
        assert told(sfc.diff(before, after)) == [
            "task Cyclic20ms: interval T#20ms -> T#50ms",
            "task Cyclic20ms: priority 1 -> 4",
        ]

    def test_lists_of_global_variables(self, sides):
        before, after = sides
        after.rename("GVL_IO", "IO")
        sections = {section.name: section for section in after.global_sections()}
        sections["GVL_HMI"].variables.append(sections["IO"].variables.pop(0))
        assert told(sfc.diff(before, after)) == [
            "global variable IO.B1_InfeedOccupied: CONSTANT",
            "global variable IO.B1_InfeedOccupied: list IO -> GVL_HMI",
            "list of global variables IO: renamed, was GVL_IO",
        ]

    def test_the_order_of_parameters_and_members(self, sides):
        before, after = sides
        inputs = after.pou("FB_Pusher").interface.sections[0].variables
        inputs[1], inputs[2] = inputs[2], inputs[1]
        after.pou("FB_Pusher").interface.sections[-1].variables.reverse()  # nobody passes these in order
        next(each for each in after.data_types if each.name == "ST_PartCount").type.members.reverse()
        lines = told(sfc.diff(before, after))
        assert lines[0] == ("POU FB_Pusher: order of input variables xInterlock, xQuit -> xQuit, xInterlock")
        assert [line.partition(": ")[2][:17] for line in lines[1:]] == ["order of members "]

    def test_settings_transitions_and_numbers_of_tia(self):
        before, after = loaded("simaticml-plc"), loaded("simaticml-plc")
        pou = after.pou("FB_Drilling")
        after.rename("FB_Drilling.T_Deep", "T_Down")
        after.rename("Production", "Data")
        pou.chart.graph_settings.with_alarm_handling = False
        pou.number = 77
        assert told(sfc.diff(before, after)) == [
            "POU FB_Drilling / chart: with alarm handling on -> off",
            "POU FB_Drilling / transition T_Down: renamed, was T_Deep",
            "POU FB_Drilling: number 20 -> 77",
            "data block Data: renamed, was Production",
        ]

    @pytest.mark.parametrize(
        ("file", "old", "new", "line"),
        [
            (
                "simaticml/FB_Drill.xml", "Pressure too low", "Pressure too high",
                "alarm of the supervision in en-US Pressure too low -> Pressure too high",
            ),
            ("simaticml/FB_Drill.xml", ">Meldung<", ">Zz9<", "title Meldung -> Zz9"),
            ("simaticml/FB_Drill.xml", ">Druck<", ">Zz9<", "title of the supervision Druck -> Zz9"),
            ("simaticml/FB_Drill.xml", ">Schutztür<", ">Zz9<", "title of the interlock Schutztür -> Zz9"),
            ("simaticml/FB_Drill.xml", ">Bohren<", ">Zz9<", "title of sequence 1 Bohren -> Zz9"),
            ("codesys/sorting_conveyor.xml", ">Belt</xhtml>", ">Zz9</xhtml>", "comments of networks"),
        ],
    )  # fmt: skip
    def test_texts_that_people_read(self, file, old, new, line):
        """Alarms of the second language and titles were no difference."""
        before = FIXTURES.joinpath(file).read_text(encoding="utf-8")
        assert old in before
        sides = [sfc.loads(text.encode(), path=file) for text in (before, before.replace(old, new))]
        changed = sfc.diff(*sides, prove=True)
        assert not changed.proofs, "nothing executes it"
        (change,) = changed.changes
        assert change.news.startswith(line)
        assert new.strip("<>/xhtml") in change.news

    def test_the_title_of_a_text_of_tia(self):
        before, after = (loaded("simaticml-plc") for _ in range(2))
        body = after.pou("FB_Chips").body
        assert isinstance(body, sfc.StBody)
        body.title = "Zz9"
        assert told(sfc.diff(before, after)) == ["POU FB_Chips: title of the code Zz9 added"]

    def test_logic_that_is_drawn_in_a_chart(self):
        before, after = (loaded("plcopen/filling_station_2.01.xml") for _ in range(2))
        logic = after.pou("FillingStation").chart.logic
        target = next(node for node in logic if node.kind == "output")
        target.expression = "Zz9"
        (change,) = sfc.diff(before, after).changes
        assert (change.place, change.aspect) == ("POU FillingStation / chart", "drawn logic")
        assert any("Zz9" in line for line in change.lines)

    def test_a_global_variable_that_a_pou_repeats_is_renamed_once(self):
        before, after = (loaded("plcopen/every_element_2.01.xml") for _ in range(2))
        after.rename("Constants.PowderTarget", "Zz9")
        assert told(sfc.diff(before, after)) == ["global variable Constants.Zz9: renamed, was PowderTarget"]

    def test_properties_that_tia_gives_a_variable(self):
        before, after = loaded("simaticml-plc"), loaded("simaticml-plc")
        for project, value in ((before, "true"), (after, "false")):
            project.pou("FB_Drilling").variables()[3].attributes["ExternalAccessible"] = value
        assert told(sfc.diff(before, after)) == ["POU FB_Drilling / variable start: ExternalAccessible true -> false"]

    def test_a_comparison_without_changes_is_false_and_has_none(self, sides):
        before, after = sides
        assert not sfc.diff(before, before)
        after.pou("PLC_PRG").chart.step("Idle").max_time = "T#9s"
        found = sfc.diff(before, after)
        assert found
        assert len(found) == 1
        assert [change.aspect for change in found] == ["maximum time"]

    def test_two_projects_are_needed(self, sides):
        with pytest.raises(ArgumentError, match="two projects"):
            sfc.diff(sides[0], "codesys/sorting_conveyor.xml")


class TestFormats:
    @pytest.mark.parametrize(
        ("one", "other"),
        [
            ("plcopen_1.01.xml", "plcopen_2.01.xml"),
            ("plcopen_2.01.xml", "codesys.xml"),
            ("codesys.xml", "iec-text.st"),
            ("iec-text.st", "model.json"),
        ],
    )
    def test_the_same_chart_in_two_formats(self, one, other):
        assert sfc.diff(loaded(f"training-chain/{one}"), loaded(f"training-chain/{other}")).changes == ()

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("file", "target", "drawn"),
        [
            ("twincat/press_station.xml", "codesys", []),
            ("codesys/distribution_belt.xml", "codesys23", []),
            ("plcopen/every_element_2.01.xml", "plcopen-1.01", []),
            ("simaticml-plc", "scl", ["POU FC_Release", "POU Main"]),
        ],
    )
    def test_a_converted_file_is_the_same_project(self, file, target, drawn):
        """Extension data is read, too: what the target cannot express is no difference. SCL has no drawn bodies."""
        before = loaded(file)
        before.accept_errors()
        after = sfc.loads(sfc.dumps(before, format=target, partial=True))
        changes = [(each.path, each.news) for each in sfc.diff(before, after).changes]
        assert changes == [(path, "language FBD -> ST") for path in drawn]

    def test_an_edit_is_found_in_another_format_too(self):
        before, after = loaded("training-chain/plcopen_2.01.xml"), loaded("training-chain/codesys.xml")
        after.rename("Ablauf.S2", "Zz9")
        chart = after.pou("Ablauf").chart
        chart.transition("S1 -> Zz9").condition = "B1 AND B4"
        assert told(sfc.diff(before, after)) == [
            "POU Ablauf / step Zz9: renamed, was S2",
            "POU Ablauf / transition S1 -> Zz9: condition B1 -> B1 AND B4",
        ]

    def test_a_project_of_codesys_and_of_twincat(self):
        """TwinCAT has no watchdog in its tasks and no BLINK, and these lists have no attribute."""
        before, after = loaded("codesys/distribution_belt.xml"), loaded("twincat-belt")
        assert told(sfc.diff(before, after)) == [
            "POU BLINK: added (functionBlock)",
            "list of global variables GVL_EA: attributes {attribute 'qualified_only'} removed",
            "list of global variables GVL_Statistik: attributes {attribute 'qualified_only'} removed",
            "task MainTask: watchdog on t#100ms 1 removed",
            "task Visu: watchdog off 1 removed",
        ]

    def test_tools_differ_in_interlocks_only(self):
        """S7-GRAPH has an interlock of the step where CODESYS has a condition of the action."""
        before, after = loaded("training-chain/codesys.xml"), loaded("simaticml-training-chain/Ablauf.xml")
        assert told(sfc.diff(before, after)) == [
            "POU Ablauf / step S3 / action Q3: condition B5 removed",
            "POU Ablauf / step S3 / action Q3: interlock B5 added",
            "POU Ablauf / step S3: interlock B5 added",
        ]


def test_positions_are_layout():
    before, after = (loaded("plcopen/filling_station_2.01.xml") for _ in range(2))
    symbol = next(s for s in after.pou("FillingStation").chart.drawing.symbols if s.kind == "step")
    x, y = symbol.position
    symbol.position = (x + 40, y)
    assert sfc.diff(before, after).changes == ()
    (change,) = sfc.diff(before, after, layout=True).changes
    assert change.news == f"position {x:g}, {y:g} -> {x + 40:g}, {y:g}"


def test_priorities_that_leave_the_order_are_layout():
    """A changed number was told nowhere, not even with the layout."""
    before, after = (loaded("simaticml/FB_Drill.xml") for _ in range(2))
    flat = next(each for each in after.pou("FB_Drill").chart.transitions if each.name == "T_Flat")
    flat.priority = 7
    assert sfc.diff(before, after).changes == ()
    assert told(sfc.diff(before, after, layout=True)) == ["POU FB_Drill / transition T_Flat: priority 2 -> 7"]


class TestProofs:
    def test_a_changed_chart_does_the_same_or_not(self):
        before, after = loaded("training-chain/model.json"), loaded("training-chain/model.json")
        after.rename("Ablauf.S2", "Zz9")
        chart = after.pou("Ablauf").chart
        chart.add_step("Never")
        chart.add_transition("Zz9", "Never", "FALSE", priority=9)
        (proof,) = sfc.diff(before, after, prove=True).proofs
        assert proof.verdict.proven
        chart.transitions[0].condition = "B2"
        (proof,) = sfc.diff(before, after, prove=True).proofs
        assert proof.verdict.different
        assert len(proof.verdict.counterexample.inputs) == 1
        assert str(proof).startswith("POU Ablauf: different after 1 scan (shortest input trace")

    def test_nothing_is_run_for_comments(self):
        before, after = loaded("training-chain/model.json"), loaded("training-chain/model.json")
        after.pou("Ablauf").comment = "a comment"
        assert sfc.diff(before, after, prove=True).proofs == ()

    @pytest.mark.parametrize(
        ("path", "new", "equal"),
        [("Main.Aaa", "Zzz", [False]), ("Main.Fill", "Filling", [False]), ("Main.Aaa", "Abc", []), ("Main.m", "k", [])],
    )
    def test_other_names_are_run_where_codesys_executes_them(self, path, new, equal):
        text = """{plcopen_sfc project.dialect := 'codesys'}
PROGRAM Main
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT n, m : INT; END_VAR
VAR SFCCurrentStep : STRING; END_VAR
INITIAL_STEP Init: Aaa(N); Bbb(N); END_STEP
TRANSITION FROM Init TO Fill := a; END_TRANSITION
STEP Fill: Aaa(N); END_STEP
TRANSITION FROM Fill TO Init := NOT a; END_TRANSITION
ACTION Aaa: n := n * 2 + 1; IF SFCCurrentStep = 'Fill' THEN m := 5; END_IF END_ACTION
ACTION Bbb: n := n + 3; END_ACTION
END_PROGRAM
"""
        before, after = (sfc.loads(text.encode(), format="iec-text") for _ in range(2))
        result = after.rename(path, new)
        assert [each.equal for each in sfc.diff(before, after, prove=True).proofs] == equal
        assert len(result.undecided) == len(equal)
        edit = before.edit(prove=True)
        if equal:
            with pytest.raises(sfc.SfcError, match="change what the charts do"):
                edit.rename(path, new)
        else:
            edit.rename(path, new)

    def test_names_that_keep_the_order_of_actions_are_not_run(self):
        text = """{plcopen_sfc project.dialect := 'codesys'}
PROGRAM Main
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT n : INT; t : BOOL; END_VAR
VAR SFCCurrentStep : STRING; END_VAR
INITIAL_STEP Init: Bbb(N); Ccc(N); END_STEP
TRANSITION FROM Init TO Init := SFCCurrentStep = 'Init'; END_TRANSITION
ACTION Bbb: n := n * 2 + 1; END_ACTION
ACTION Ccc: n := n + 3; END_ACTION
ACTION Other: t := a; END_ACTION
END_PROGRAM
"""
        before, after = (sfc.loads(text.encode(), format="iec-text") for _ in range(2))
        results = after.rename_many({"Main.Bbb": "Z_Bbb", "Main.Ccc": "Z_Ccc"})  # behind Other, which shares nothing
        assert [each.undecided for each in results] == [(), ()]
        assert sfc.diff(before, after, prove=True).proofs == ()

    def test_a_renamed_step_of_a_chart_in_an_action_is_run_where_its_name_is_shown(self):
        text = """{plcopen_sfc project.dialect := 'codesys'}
PROGRAM Main
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT t : BOOL; END_VAR
VAR SFCCurrentStep : STRING; END_VAR
INITIAL_STEP Init: Sub(N); END_STEP
TRANSITION FROM Init TO Init := a; END_TRANSITION
ACTION Sub:
INITIAL_STEP One: END_STEP
TRANSITION FROM One TO Two := a; END_TRANSITION
STEP Two: t(N); END_STEP
TRANSITION FROM Two TO One := SFCCurrentStep = 'One'; END_TRANSITION
END_ACTION
END_PROGRAM
"""
        before, after = (sfc.loads(text.encode(), format="iec-text") for _ in range(2))
        (result,) = after.rename_many({"Main.Sub.One": "First"})
        assert len(result.undecided) == 1
        assert {each.path for each in sfc.diff(before, after, prove=True, limit=5).proofs} >= {"POU Main"}

    def test_another_order_of_simultaneous_steps_is_a_change_and_is_run(self):
        text = """PROGRAM Main
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT n : INT; END_VAR
INITIAL_STEP Init: END_STEP
TRANSITION FROM Init TO (A1, B1) := a; END_TRANSITION
STEP A1: Add(N); END_STEP
STEP B1: Twice(N); END_STEP
STEP C1: Add(N); END_STEP
TRANSITION FROM (A1, B1) TO C1 := NOT a; END_TRANSITION
TRANSITION FROM C1 TO Init := a; END_TRANSITION
ACTION Add: n := n + 3; END_ACTION
ACTION Twice: n := n * 2 + 1; END_ACTION
END_PROGRAM
"""
        first, second, third = text.splitlines()[5:8]
        for order, change in (
            ([second, first, third], "order of simultaneous steps A1, B1 -> B1, A1"),
            ([third, first, second], None),  # C1 is never active together with them
        ):
            other = text.replace("\n".join([first, second, third]), "\n".join(order))
            found = sfc.diff(*(sfc.loads(each.encode(), format="iec-text") for each in (text, other)), prove=True)
            assert [each.news for each in found.changes] == ([change] if change else [])
            assert [each.verdict.different for each in found.proofs] == ([True] if change else [])

    @pytest.mark.parametrize(
        ("old", "new", "changes"),
        [
            ("s = 'Auto'", "s = 'AUTO'", 1),
            ("s = 'Auto'", "S = 'Auto'", 0),
            ("v <> 'Auto'", "v <> 'AUTO'", 1),
            ('w = "Auto"', 'w = "AUTO"', 1),
            (":= 'x'", ":= 'X'", 1),
            ("FIND(v, 'a') > 0", "FIND(v, 'A') > 0", 1),
            ("r <> r", "FALSE", 1),  # r may be no number
            ("r <> r", "R <> R", 0),
        ],
    )
    def test_the_case_of_strings_counts_and_that_of_names_does_not(self, old, new, changes):
        text = """PROGRAM Main
VAR_INPUT s : STRING; w : WSTRING; r : REAL; END_VAR
VAR v : STRING := 'x'; END_VAR
VAR_OUTPUT q, o : BOOL; END_VAR
INITIAL_STEP Init: q(N); END_STEP
TRANSITION FROM Init TO Fill := s = 'Auto'; END_TRANSITION
STEP Fill: Act(N); END_STEP
TRANSITION FROM Fill TO Init := w = "Auto"; END_TRANSITION
TRANSITION FROM Fill TO Fill := FIND(v, 'a') > 0 OR r <> r; END_TRANSITION
ACTION Act: o := v <> 'Auto'; END_ACTION
END_PROGRAM
"""
        before, after = (sfc.loads(each.encode(), format="iec-text") for each in (text, text.replace(old, new)))
        assert len(sfc.diff(before, after).changes) == changes

    def test_another_order_of_the_programs_of_a_task_is_a_change(self):
        programs = "".join(f"PROGRAM P{i}\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM\n" for i in (1, 2))
        lines = ["PROGRAM i1 WITH T : P1;", "PROGRAM i2 WITH T : P2;"]
        projects = [
            sfc.loads(
                f"{programs}CONFIGURATION C\nRESOURCE R ON PLC\nTASK T(INTERVAL := T#10ms, PRIORITY := 1);\n"
                f"{chr(10).join(each)}\nEND_RESOURCE\nEND_CONFIGURATION\n".encode(),
                format="iec-text",
            )
            for each in (lines, lines[::-1])
        ]
        (change,) = sfc.diff(*projects).changes
        assert (change.path, change.news) == ("task T", "order of programs i1, i2 -> i2, i1")

    def test_what_no_run_shows_is_not_compared(self):
        text = """PROGRAM Main
VAR_INPUT Go : BOOL; END_VAR
VAR inp AT %IX0.3 : BOOL; END_VAR
VAR RETAIN n : INT; END_VAR
INITIAL_STEP A: END_STEP
TRANSITION FROM A TO B := Go AND inp; END_TRANSITION
STEP B: Act(P1); END_STEP
TRANSITION FROM B TO A := NOT Go; END_TRANSITION
ACTION Act: n := n + 1; END_ACTION
END_PROGRAM
"""
        for old, new, reason in (
            ("%IX0.3", "%IX0.4", "at which terminal"),
            ("RETAIN ", "", "starts again"),
            (
                "END_PROGRAM\n",
                "END_PROGRAM\nPROGRAM More\nVAR y : INT; END_VAR\ny := 1;\nEND_PROGRAM\n",
                "one of the two",
            ),
            ("END_PROGRAM\n", "END_PROGRAM\nFUNCTION F : INT\nF := 1;\nEND_FUNCTION\n", "nothing calls it"),
        ):
            before, after = (sfc.loads(each.encode(), format="iec-text") for each in (text, text.replace(old, new)))
            proofs = sfc.diff(before, after, prove=True).proofs
            assert [each.equal for each in proofs if not each.verdict] == [False], old
            assert reason in str(proofs[0])

    @pytest.mark.parametrize(
        "text",
        [
            "CLASS C VAR k : INT; END_VAR METHOD Up : INT k := k + 1; Up := k; END_METHOD END_CLASS",
            "NAMESPACE Ns FUNCTION F : INT F := 1; END_FUNCTION END_NAMESPACE",
            "INTERFACE IRun METHOD Run : INT VAR_INPUT x : INT := 1; END_VAR END_METHOD END_INTERFACE",
            "FUNCTION_BLOCK Mo VAR k : INT; END_VAR PROPERTY Speed : INT GET Speed := k; END_GET "
            "SET k := Speed + 1; END_SET END_PROPERTY END_FUNCTION_BLOCK",
        ],
    )
    def test_what_is_kept_as_text_is_compared_and_not_run(self, text: str):
        """Another text of a class, a namespace or an interface was no difference."""
        before, after = (sfc.loads(each.encode(), format="iec-text") for each in (text, text.replace("1;", "2;")))
        found = sfc.diff(before, after, prove=True)
        assert [change.aspect for change in found.changes] == ["code"]
        (proof, *_) = found.proofs
        assert str(proof).endswith("not compared: it is kept as text, and no run executes it")

    @pytest.mark.slow
    def test_programs_without_charts_are_run_too(self):
        text = "PROGRAM Calc\nVAR_INPUT x : INT; END_VAR\nVAR_OUTPUT y : INT; END_VAR\ny := x + 1;\nEND_PROGRAM\n"
        before = sfc.loads(text.encode(), format="iec-text")
        for code, equal in (("y := x - 1;", False), ("y := x + 2 - 1;", True)):
            after = sfc.loads(text.replace("y := x + 1;", code).encode(), format="iec-text")
            assert [each.equal for each in sfc.diff(before, after, prove=True).proofs] in (
                [equal],
                [] if equal else None,
            )

    def test_functions_that_are_called_are_run_where_they_are(self):
        text = """FUNCTION F : INT
VAR_INPUT x : INT; END_VAR
F := x + 1;
END_FUNCTION
PROGRAM Calc
VAR_INPUT x : INT; END_VAR
VAR_OUTPUT y : INT; END_VAR
y := F(x);
END_PROGRAM
"""
        before, after = (sfc.loads(each.encode(), format="iec-text") for each in (text, text.replace("+ 1", "+ 2")))
        (proof,) = sfc.diff(before, after, prove=True).proofs
        assert (proof.path, proof.verdict.different) == ("POU Calc", True)

    def test_a_difference_only_by_what_nothing_writes_says_so(self):
        text = "PROGRAM Main\nVAR s1 : INT := 2; END_VAR\nVAR_OUTPUT y : INT; END_VAR\ny := s1;\nEND_PROGRAM\n"
        before, after = (
            sfc.loads(each.encode(), format="iec-text") for each in (text, text.replace("y := s1", "y := 2"))
        )
        (proof,) = sfc.diff(before, after, prove=True).proofs
        assert not proof.equal
        assert str(proof).endswith(
            "only if something outside writes s1; while they keep their start values, both do the same"
        )


@pytest.mark.corpus
@pytest.mark.slow
def test_files_of_the_corpus_do_not_differ_from_themselves():
    """A sample of the smaller files; the plain fixtures are all in the tests above."""
    kinds = ("plcopen", "codesys", "simaticml", "scl", "iectext")
    files = [path for kind in kinds for path in corpus_files(kind) if path.stat().st_size < 200_000]
    if not files:
        pytest.skip("no corpus beside the repository (see tests/corpus.py)")
    for path in some_of(files, 20):
        try:
            before, after = sfc.load(path), sfc.load(path)
        except sfc.SfcError:
            continue
        assert sfc.diff(before, after, layout=True).changes == (), path


def test_comments_are_compared_in_all_their_languages():
    before, after = loaded("simaticml/FB_Drill.xml"), loaded("simaticml/FB_Drill.xml")
    comment = after.pou("FB_Drill").chart.step("Ready").comment
    comment.texts["en-US"] = "Waits for a part"
    assert told(sfc.diff(before, after)) == [
        "POU FB_Drill / step Ready: comment in en-US Home position -> Waits for a part"
    ]


@pytest.mark.slow
def test_case_of_names_and_names_of_instances_are_no_changes():
    source = loaded("plcopen/filling_station_2.01.xml")
    written = sfc.loads(sfc.convert(source, "codesys", partial=True).data)
    changes = [line for line in told(sfc.diff(source, written)) if "qualifier P" not in line]
    assert changes == ["POU FillingStation / step Fault_step: renamed, was Fault"]  # a variable has its name, too


def test_a_text_of_another_type_is_another_value() -> None:
    text = "PROGRAM Main VAR w : WSTRING := %s; END_VAR INITIAL_STEP A: END_STEP STEP B: END_STEP\n"
    text += (
        "TRANSITION FROM A TO B := w = %s; END_TRANSITION TRANSITION FROM B TO A := TRUE; END_TRANSITION END_PROGRAM"
    )
    wide = sfc.loads((text % ('"on"', '"on"')).encode())
    for first, second, told in (("'on'", '"on"', "Main / w"), ('"on"', "'on'", "transition A -> B")):
        (change,) = sfc.diff(wide, sfc.loads((text % (first, second)).encode())).changes
        assert told in change.path


def test_the_steps_in_which_an_expansion_begins_and_ends_are_executed() -> None:
    text = """GRAFCET X
CHART G1
INITIAL STEP 1
1 -> M1 : a
MACRO M1
M1 -> 1 : b
EXPANSION M1 FROM E1 TO S1
STEP E1
    q1
E1 -> S1 : c
STEP S1
    q2
"""
    before, after = (sfc.loads(each.encode()) for each in (text, text.replace("FROM E1 TO S1", "FROM S1 TO E1")))
    assert str(sfc.diff(before, after, prove=True)).splitlines()[1:4] == [
        "  partial chart M1: entry step E1 -> S1",
        "  partial chart M1: exit step S1 -> E1",
        "POU X: different after 1 scan (shortest input trace)",
    ]
    other = sfc.loads(text.replace("E1", "E2").encode())
    assert str(sfc.diff(before, other)).splitlines()[1:] == ["  M1 / step E2: renamed, was E1"]


def test_changes_in_partial_charts_of_a_grafcet_are_found() -> None:
    before = """GRAFCET X
CHART G1
INITIAL STEP 1
    q AFTER 3s
    FORCE G2{}
1 -> 2 : a
STEP 2
2 -> 1 : b
CHART G2
INITIAL STEP 10
10 -> 10 : c
"""
    after = before.replace(": a", ": /a").replace("AFTER", "FOR").replace("G2{}", "G2{*}").replace(": c", ": a * c")
    texts = [sfc.loads(text.encode(), format="grafcet-text") for text in (before, after)]
    assert str(sfc.diff(*texts)).splitlines()[1:] == [
        "  G1 / step 1 / action q: qualifier delayed -> limited",
        "  G1 / step 1 / action force G2: forcing G2{} -> G2{*}",
        "  G1 / transition 1 -> 2: condition a -> /a",
        "  G2 / transition 10 -> 10: condition c -> a * c",
    ]


@pytest.mark.parametrize("field", ["title", "comment"])
def test_comments_of_networks_are_compared(field: str) -> None:
    """Those of bodies and of drawn conditions were no difference, with `layout` neither."""
    before, after = loaded("simaticml-plc"), loaded("simaticml-plc")
    chart = after.pou("FB_Drilling").chart
    assert chart is not None
    condition = chart.transition("T_Start").condition
    body = after.pou("FC_Release").body
    assert isinstance(condition, BodyCondition)
    assert isinstance(condition.body, FbdBody | LdBody)
    assert isinstance(body, FbdBody | LdBody)
    for network in (condition.body.networks[0], body.networks[0]):
        setattr(network, field, "Zz9")
    assert [(change.path, change.aspect, change.after) for change in sfc.diff(before, after).changes] == [
        ("POU FB_Drilling / transition T_Start", "comments of the condition", "1: Zz9"),
        ("POU FC_Release", "comments of networks", "1: Zz9" if field == "title" else "1: Freigabe Release Zz9"),
    ]


DECLARED = """<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <POU Name="FB_X" Id="{{11111111-2222-3333-4444-555555555555}}">
    <Declaration><![CDATA[{head}
VAR_INPUT
	{linked}
	a AT %I* : BOOL;
END_VAR]]></Declaration>
    <Implementation><ST><![CDATA[;]]></ST></Implementation>
    <Method Name="M" Id="{{11111111-2222-3333-4444-555555555556}}">
      <Declaration><![CDATA[{method}]]></Declaration>
      <Implementation><ST><![CDATA[;]]></ST></Implementation>
    </Method>
  </POU>
</TcPlcObject>
"""
LINKED = "{attribute 'TcLinkTo' := 'TIID^Box 1'}"
HEAD, METHOD = "{attribute 'hide'}\nFUNCTION_BLOCK PUBLIC FINAL FB_X", "METHOD PRIVATE M : BOOL"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("PUBLIC FINAL ", "ABSTRACT ", "POU FB_X: modifiers PUBLIC FINAL -> ABSTRACT"),
        ("PUBLIC FINAL ", "", "POU FB_X: modifiers PUBLIC FINAL removed"),
        ("{attribute 'hide'}\n", "", "POU FB_X: attributes {attribute 'hide'} removed"),
        ("Box 1", "Box 2", f"POU FB_X / variable a: attributes {LINKED} -> {LINKED.replace('Box 1', 'Box 2')}"),
        ("PRIVATE ", "", "POU FB_X / method M: modifiers PRIVATE removed"),
        ("M : BOOL", "M : INT", "POU FB_X / method M: result BOOL -> INT"),
        ("METHOD", "{attribute 'call_after_init'}\nMETHOD", "attributes {attribute 'call_after_init'} added"),
    ],
)
def test_modifiers_and_attributes_are_compared(old: str, new: str, expected: str) -> None:
    """What links a variable to its terminal, and who may call or extend what, was no difference."""

    def read(change: Callable[[str], str]) -> sfc.Project:
        text = DECLARED.format(head=change(HEAD), linked=change(LINKED), method=change(METHOD))
        return sfc.loads(text.encode(), path="FB_X.TcPOU")

    before, after = read(str), read(lambda text: text.replace(old, new))
    (found,) = told(sfc.diff(before, after))
    assert found.endswith(expected)
    again = sfc.loads(sfc.convert(before, "codesys", partial=True)[0])
    assert not [line for line in told(sfc.diff(before, again)) if "attribute" in line or "modifiers" in line]


@pytest.mark.parametrize("new", ["", "{attribute 'qualified_only' := 'x'}\n"])
def test_attributes_in_the_text_of_a_declaration_are_compared(new: str) -> None:
    """Exports of CODESYS have them in the text that was typed."""
    before, after = (loaded("codesys/device_export.xml") for _ in range(2))
    listed = next(section for section in after.global_sections() if "{attribute" in (section.declaration or ""))
    listed.declaration = (listed.declaration or "").replace("{attribute 'qualified_only'}\n", new)
    assert any("attributes {attribute 'qualified_only'}" in line for line in told(sfc.diff(before, after))) is bool(new)


def test_the_text_of_a_property_is_shown() -> None:
    text = """FUNCTION_BLOCK Mix
VAR _x : INT; END_VAR
PROPERTY Level : INT
GET
Level := _x;
END_GET
END_PROPERTY
END_FUNCTION_BLOCK
"""
    old, new = (sfc.loads(each.encode(), format="iec-text") for each in (text, text.replace(":= _x", ":= _x + 1")))
    (change,) = sfc.diff(old, new).changes
    assert (change.path, change.aspect) == ("POU Mix / property Level", "code")
    assert {line for line in change.lines if line[0] in "+-"} == {"-Level := _x;", "+Level := _x + 1;"}
    assert not sfc.diff(
        old, sfc.loads(text.replace("Level := _x", "Level  :=  _x").encode(), format="iec-text")
    ).changes


@pytest.mark.parametrize(
    ("one", "other", "is_equal"),
    [
        ('#"S2".U > T#5s AND #B1', '#S2.U > T#5s AND #"b1"', True),
        ('#"S2".U > "DB".limit', '#S2.U > "DB".limit', True),
        ("#S2.X AND #B1", '#S2.X AND "B1"', False),  # a tag, and no parameter
    ],
)
def test_quotes_that_a_local_name_does_not_need_are_no_difference(one: str, other: str, is_equal: bool) -> None:
    projects = [sfc.load(FIXTURES / "simaticml-training-chain" / "Ablauf.xml") for _ in range(2)]
    for project, text in zip(projects, (one, other), strict=True):
        chart = project.pou("Ablauf").chart
        assert chart is not None
        chart.transitions[0].condition = sfc.Expression(text=text)
    assert sfc.diff(*projects).equal is is_equal


SWITCHED = b"""{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}
PROGRAM Main
VAR Start, Stop : BOOL; END_VAR
INITIAL_STEP Wait: END_STEP
STEP Run: END_STEP
TRANSITION FROM Wait TO Run := Start; END_TRANSITION
TRANSITION FROM Run TO Wait := Stop; END_TRANSITION
END_PROGRAM
"""


def test_a_variable_is_recognised_where_its_condition_got_a_name_too() -> None:
    project = sfc.loads(SWITCHED, format="iec-text")
    chart = project.pou("Main").chart
    assert chart is not None
    with project.edit(prove=True, limit=5) as edit:  # it would be another free input of the chart
        edit.extract_condition(chart.transition("Run -> Wait"), "Ready")
        edit.rename("Main.Stop", "Enough")
    diff = sfc.diff(sfc.loads(SWITCHED, format="iec-text"), project)
    assert [str(change) for change in diff.changes] == [
        "POU Main / variable Enough: renamed, was Stop",
        "POU Main / transition Run -> Wait: condition Enough -> Ready",
        "POU Main / named transition Ready: added",
    ]


COUNTING = """{{plcopen_sfc format := 1}}
{{plcopen_sfc project.dialect := '{dialect}'}}
PROGRAM Main
VAR Parts : CTU; Latch : SR; Part, Full, Quit : BOOL; END_VAR
Parts(CU := Part, {reset} := Quit, PV := {most});
Latch({set} := Parts.Q, {latch_reset} := Quit);
Full := Latch.Q1;
END_PROGRAM
"""


@pytest.mark.parametrize(("most", "shown"), [(5, ["POU Main: code"]), (3, [])])
def test_pins_that_tools_name_otherwise_are_no_difference(most: int, shown: list[str]) -> None:
    iec = COUNTING.format(dialect="iec", reset="R", set="S1", latch_reset="R", most=3)
    codesys = COUNTING.format(dialect="codesys", reset="RESET", set="SET1", latch_reset="RESET", most=most)
    projects = [sfc.loads(text.encode(), format="iec-text") for text in (iec, codesys)]
    for pair in (projects, projects[::-1]):
        diff = sfc.diff(*pair)
        assert [str(change).splitlines()[0] for change in diff.changes] == shown
        changed = [line for change in diff.changes for line in change.lines if line[:1] in "+-"]
        assert len(changed) == 2 * len(shown)
    assert b"CU := Part, R := Quit" in sfc.dumps(projects[0], format="iec-text")  # not the compared one


BLOCK = """FUNCTION_BLOCK Sub
    VAR_INPUT i, j : INT; gain : INT := 2; END_VAR VAR_OUTPUT o : INT := 1; END_VAR
    o := (i - j) * gain;
END_FUNCTION_BLOCK"""
USER = """PROGRAM Main
    VAR_INPUT n : INT; go : BOOL; END_VAR VAR_OUTPUT k, m : INT; END_VAR VAR s : Sub; END_VAR
    k := s.o; IF go THEN s(n, 3); END_IF; m := s.o + s.i;
END_PROGRAM"""


@pytest.mark.parametrize(
    ("before", "after"),
    [
        *(("gain : INT := 2", "gain : INT := 3"), ("o : INT := 1", "o : INT"), ("i, j : INT", "j, i : INT")),
        ("gain;", "gain; i := 0;"),
    ],
)
def test_what_uses_a_block_is_run_where_that_is_equal_in_itself(before: str, after: str) -> None:
    """Runs of a block begin with any inputs, in any order; its users see start values, order and what it leaves."""
    texts = BLOCK, BLOCK.replace(before, after)
    one, other = (sfc.loads(f"{text}\n{USER}".encode(), format="iec-text") for text in texts)
    proofs = {proof.path: proof for proof in sfc.diff(one, other, prove=True).proofs}
    assert proofs["POU Sub"].equal
    assert proofs["POU Main"].verdict is not None
    assert proofs["POU Main"].verdict.different
    alone = [sfc.loads(text.encode(), format="iec-text") for text in texts]
    (proof,) = sfc.diff(*alone, prove=True).proofs
    assert ("nothing uses the block" in proof.reason) is ("i := 0" not in after)


def test_start_values_that_nothing_changes_are_those_of_the_run() -> None:
    text = """VAR_GLOBAL limit : INT := 4; END_VAR
    PROGRAM Main VAR_INPUT n : INT; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR_EXTERNAL limit : INT; END_VAR
    q := n > limit; END_PROGRAM"""
    one, other = (sfc.loads(each.encode(), format="iec-text") for each in (text, text.replace(":= 4", ":= 40")))
    (proof,) = sfc.diff(one, other, prove=True).proofs
    assert proof.verdict is not None
    assert proof.verdict.different
    assert proof.reason == "while variables that nothing in the project writes keep their start values"


def test_pragmas_that_leave_statements_out_are_compared_and_not_run() -> None:
    text = """PROGRAM Main VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR
    {IF defined (SIMULATION)} q := TRUE; {ELSE} q := a; {END_IF} END_PROGRAM"""
    others = [
        text.replace("{IF defined", "{IF NOT defined"),
        text.replace("{IF defined (SIMULATION)} ", "").replace("{ELSE} ", "").replace("{END_IF} ", ""),
        text.replace(" q := a; {END_IF}", " {END_IF} q := a;"),
    ]
    projects = [sfc.loads(each.encode(), format="iec-text") for each in (text, *others)]
    for project in projects:
        project.dialect = Dialect.CODESYS
    for other in projects[1:]:
        found = sfc.diff(projects[0], other, prove=True)
        assert [(change.path, change.aspect) for change in found.changes] == [("POU Main", "code")]
        (proof,) = found.proofs
        assert not proof.equal
        assert "{IF defined (SIMULATION)} are compiled is not known" in str(proof)
    respaced = sfc.loads(text.replace(" q := TRUE", "\n\n  q := TRUE").encode(), format="iec-text")
    respaced.dialect = Dialect.CODESYS
    assert sfc.diff(projects[0], respaced).equal
