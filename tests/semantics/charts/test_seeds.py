"""Statements of textbooks about sequences, each as a test."""

from __future__ import annotations

import pytest

from plcopen_sfc.model import (
    Action,
    ActionAssociation,
    Dialect,
    Interface,
    Pou,
    PouKind,
    Project,
    Qualifier,
    SectionKind,
    SfcBody,
    SfcNetwork,
    StBody,
    Variable,
    VariableSection,
)
from plcopen_sfc.semantics.charts import compile_chart
from plcopen_sfc.semantics.profile import PROFILES
from plcopen_sfc.semantics.programs import Controller
from tests.semantics.charts.rig import MS, Rig, chain

IEC_LIKE = ("iec", "codesys", "grafcet", "matiec")


def body(text: str) -> StBody:
    return StBody(text=text)


@pytest.mark.parametrize("profile", PROFILES)
def test_only_the_initial_step_is_set_when_a_chain_is_activated(profile: str) -> None:
    assert Rig(chain("A", "B", "C"), profile, variables="c1 c2 c3").scan().active == "A"


@pytest.mark.parametrize("profile", PROFILES)
def test_the_initial_step_may_stand_anywhere_in_the_chain(profile: str) -> None:
    chart = chain("A", "B", "C")
    chart.step("A").initial, chart.step("C").initial = False, True
    rig = Rig(chart, profile, variables="c1 c2 c3").scan()
    assert rig.active == "C"
    assert rig.scan(c3=True).scan().active == "A"


@pytest.mark.parametrize("profile", [name for name in PROFILES if name != "grafcet"])
def test_a_step_is_reset_when_its_successor_is_set(profile: str) -> None:
    """Never two neighbours at once, and no gap either, also when all conditions are true."""
    rig = Rig(chain("A", "B", "C", conditions="TRUE c2 TRUE"), profile, variables="c2").scan(2)
    for scan in range(8):
        rig.scan(c2=scan % 2 == 0)
        assert len(rig.active.split()) == 1


@pytest.mark.parametrize("profile", IEC_LIKE)
def test_a_chain_may_stop_at_its_end(profile: str) -> None:
    rig = Rig(chain("A", "B", ring=False), profile, variables="c1").scan(c1=True).scan(5)
    assert rig.active == "B"


def test_the_end_of_a_sequence_deactivates_it() -> None:
    chart = chain("S1", "S2", ring=False, conditions="#c1")
    chart.add_transition(chart.step("S2"), [], "#c2")
    rig = Rig(chart, "s7graph", variables="c1 c2", dialect=Dialect.SCL).scan(2, c1=True)
    assert rig.active == "S2"
    assert rig.scan(c2=True).scan(3).active == ""


def test_a_jump_leads_to_any_step_also_of_another_sequence() -> None:
    chart = chain("S1", "S2", ring=False, conditions="#c1")
    other = chart.add_step("S10")
    chart.add_transition(chart.step("S2"), other, "#c2")
    chart.add_transition(other, chart.step("S1"), "#c3")
    rig = Rig(chart, "s7graph", variables="c1 c2 c3", dialect=Dialect.SCL).scan(2, c1=True)
    assert rig.scan(c1=False, c2=True).active == "S10"
    assert rig.scan(c3=True).active == "S1"


def test_several_steps_of_a_linear_chain_may_be_active() -> None:
    chart = chain("A", "B", "C", "D", conditions="c1 c2 c3 c4")
    chart.step("C").initial = True
    rig = Rig(chart, "grafcet", variables="c1 c2 c3 c4").scan()
    assert rig.active == "A C"
    assert rig.scan(c1=True, c3=True).active == "B D"


def test_filling_a_tank() -> None:
    """The entry action opens the valve, the main action looks at the level, the exit action closes the valve."""
    chart = chain("Wait", "Fill", "Done", conditions="start full FALSE")
    fill = chart.step("Fill")
    fill.entry_action = body("valve := TRUE; opened := opened + 1;")
    fill.main_action = body("full := level >= 80;")
    fill.exit_action = body("valve := FALSE; closed := closed + 1;")
    variables = "start full valve level:INT opened:INT closed:INT"
    rig = Rig(chart, "codesys", variables=variables, dialect=Dialect.CODESYS).scan(start=True)
    assert rig["valve"] is False
    for level in range(10, 80, 10):
        assert rig.scan(level=level)["valve"] is True
    rig.scan(level=85)
    assert (rig.active, rig["valve"]) == ("Fill", True)
    rig.scan(3)
    assert (rig.active, rig["valve"], rig["opened"], rig["closed"]) == ("Done", False, 1, 1)


def test_a_timer_in_a_step_ends_it() -> None:
    """The step starts the timer, whose output is the transition: the step is active for the time of the timer."""
    chart = chain("Start", "Waiting", "Onward", conditions="TRUE Pause.Q FALSE")
    chart.step("Waiting").main_action = body("Pause(IN := TRUE, PT := T#2s);")
    rig = Rig(chart, "codesys", variables="Pause:TON", dialect=Dialect.CODESYS, step=100).scan()
    lasted = 0
    while rig.scan().active == "Waiting":
        lasted += 1
    assert (rig.active, lasted) == ("Onward", 21), "from 0 s to 2 s, both ends included"


def test_a_valve_for_two_seconds_with_a_limited_action() -> None:
    chart = chain("Start", "Open", conditions="c1 FALSE")
    chart.step("Open").actions = [ActionAssociation(id=1, qualifier=Qualifier.L, target="Valve", duration="T#2s")]
    rig = Rig(chart, "codesys", variables="c1 Valve", dialect=Dialect.CODESYS, step=500).scan(c1=True)
    assert rig.log("Valve", 7) == "1111000"


def test_a_waiting_time_by_the_qualifier_d() -> None:
    """No timer needs to be programmed: the delayed action is the transition's condition."""
    chart = chain("Start", "Waiting", "Back", conditions="c1 Over FALSE")
    chart.step("Waiting").actions = [ActionAssociation(id=1, qualifier=Qualifier.D, target="Over", duration="T#3s")]
    rig = Rig(chart, "codesys", variables="c1 Over", dialect=Dialect.CODESYS, step=1000).scan(c1=True)
    assert [rig.scan().active for _ in range(5)] == ["Waiting"] * 4 + ["Back"]


def test_the_initial_step_without_actions_leads_to_one_that_shows_readiness() -> None:
    chart = chain("Init", "Ready", conditions="TRUE FALSE")
    chart.step("Ready").actions = [ActionAssociation(id=1, target="H1")]
    rig = Rig(chart, "codesys", variables="H1", dialect=Dialect.CODESYS).scan()
    assert (rig.active, rig["H1"]) == ("Init", False)
    assert rig.scan()["H1"] is True


@pytest.mark.parametrize("profile", ["iec", "codesys", "matiec", "grafcet"])
def test_a_counter_counts_once_at_each_activation(profile: str) -> None:
    """P where no final scan follows, P1 where one does."""
    chart = chain("A", "B", conditions="go;NOT go")
    qualifier = Qualifier.P if profile == "matiec" else Qualifier.P1
    chart.step("B").actions = [ActionAssociation(id=1, qualifier=qualifier, target="Count")]
    dialect = Dialect.CODESYS if profile == "codesys" else Dialect.IEC
    rig = Rig(chart, profile, variables="go n:INT", actions={"Count": "n := n + 1;"}, dialect=dialect)
    for count in range(1, 4):
        rig.scan(3, go=True).scan(3, go=False)
        assert rig["n"] == count


def machine(chart: SfcNetwork, *inputs: str) -> Pou:
    sections = [
        VariableSection(kind=SectionKind.INPUT, variables=[Variable(name=name, type="BOOL") for name in inputs]),
        VariableSection(kind=SectionKind.OUTPUT, variables=[Variable(name="n", type="INT")]),
    ]
    return Pou(
        name="Machine",
        kind=PouKind.FUNCTION_BLOCK,
        interface=Interface(sections=sections),
        actions=[Action(name="Count", body=body("n := n + 1;"))],
        bodies=[SfcBody(chart=chart)],
    )


def run(project: Project, profile: str = "codesys") -> Controller:
    return Controller(project, PROFILES[profile], chart_compiler=compile_chart)


def test_flags_as_inputs_of_the_block_that_a_program_calls() -> None:
    """SFCInit, SFCReset and SFCPause declared as VAR_INPUT get signals of the process at the call."""
    chart = chain("A", "B", conditions="go FALSE")
    chart.step("B").actions = [ActionAssociation(id=1, target="Count")]
    main = Pou(
        name="PLC_PRG",
        kind=PouKind.PROGRAM,
        interface=Interface(
            sections=[
                VariableSection(
                    variables=[
                        Variable(name="belt", type="Machine"),
                        *(Variable(name=name, type="BOOL") for name in ("S1", "S2", "S3")),
                    ]
                )
            ]
        ),
        bodies=[body("belt(go := S1, SFCInit := S2, SFCPause := S3);")],
    )
    blocks = [machine(chart, "go", "SFCInit", "SFCPause"), main]
    controller = run(Project(name="p", pous=blocks, dialect=Dialect.CODESYS))
    program = controller.instance("PLC_PRG")

    def scan(times: int = 1, **values: bool) -> tuple[bool, int]:
        for name, value in values.items():
            program[name] = value
        for _ in range(times):
            controller.now += 10 * MS
            program.scan()
        return program["belt.B.x"], program["belt.n"]

    assert scan(S1=True) == (False, 0)
    assert scan(2) == (True, 2)
    assert scan(3, S3=True) == (True, 2)
    assert scan(S3=False) == (True, 3)
    assert scan(3, S2=True, S1=False) == (False, 3)
    assert scan(2, S2=False) == (False, 3)


def test_instances_of_a_block_with_a_chart_are_independent() -> None:
    chart = chain("A", "B", conditions="go FALSE")
    chart.step("B").actions = [ActionAssociation(id=1, target="Count")]
    sections = [VariableSection(variables=[Variable(name=name, type="Machine") for name in ("left", "right")])]
    main = Pou(
        name="Main",
        kind=PouKind.PROGRAM,
        interface=Interface(sections=sections),
        bodies=[body("left(go := TRUE); right(go := FALSE);")],
    )
    controller = run(Project(name="p", pous=[machine(chart, "go"), main]), "iec")
    program = controller.instance("Main")
    for _ in range(3):
        program.scan()
    assert (program["left.B.X"], program["right.B.X"]) == (True, False)
    assert (program["left.n"], program["right.n"]) == (3, 0)


def test_an_action_may_be_a_chart_itself() -> None:
    inner = chain("X1", "X2", conditions="TRUE TRUE")
    inner.step("X2").actions = [ActionAssociation(id=1, qualifier=Qualifier.P1, target="Count")]
    outer = chain("A", "B", conditions="go FALSE")
    outer.step("B").actions = [ActionAssociation(id=1, target="Nested")]
    pou = machine(outer, "go")
    pou.actions.append(Action(name="Nested", body=SfcBody(chart=inner)))
    controller = run(Project(name="p", pous=[pou]), "iec")
    block = controller.instance("Machine")
    for _ in range(3):
        block.scan()
    assert block["X1.X"] is False, "it is not executed before its action is"
    block["go"] = True
    seen = []
    for _ in range(4):
        block.scan()
        seen.append((block["X1.X"], block["X2.X"], block["n"]))
    assert seen == [(False, True, 1), (True, False, 1), (False, True, 2), (True, False, 2)]
