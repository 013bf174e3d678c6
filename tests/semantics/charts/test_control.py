"""The action control against the function block ACTION_CONTROL of IEC 61131-3, written in structured text.

Two independent ways: the qualifiers of a chart on one side, the block of the standard with its flip-flops and timers on
the other, both driven by the same random steps.
"""

from __future__ import annotations

from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.model import (
    Action,
    ActionAssociation,
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
from plcopen_sfc.semantics.charts import ChartProgram, compile_chart
from plcopen_sfc.semantics.profile import PROFILES
from plcopen_sfc.semantics.programs import Controller, Instance
from tests.sweeps import examples

MS = 1_000_000
QUALIFIERS = ("N", "R", "S", "L", "D", "P", "P1", "P0", "SD", "DS", "SL")
TIMED = ("L", "D", "SD", "DS", "SL")
BLOCK = """
S_FF(S := S, R1 := R);
L_TMR(IN := L, PT := T);
D_TMR(IN := D, PT := T);
P_TRIG(CLK := P);
P1_TRIG(CLK := P1);
P0_TRIG(CLK := P0);
SD_FF(S := SD, R1 := R);
SD_TMR(IN := SD_FF.Q1, PT := T);
DS_TMR(IN := DS, PT := T);
DS_FF(S := DS_TMR.Q, R1 := R);
SL_FF(S := SL, R1 := R);
SL_TMR(IN := SL_FF.Q1, PT := T);
Q := NOT R AND (N OR S_FF.Q1 OR (L AND NOT L_TMR.Q) OR D_TMR.Q OR P_TRIG.Q
     OR SD_TMR.Q OR DS_FF.Q1 OR (SL_FF.Q1 AND NOT SL_TMR.Q));
Q_TRIG(CLK := Q);
PULSE := NOT R AND (P1_TRIG.Q OR P0_TRIG.Q);
A := Q OR Q_TRIG.Q OR PULSE;
"""
INSIDE = {
    "S_FF SD_FF DS_FF SL_FF": "RS",
    "L_TMR D_TMR SD_TMR DS_TMR SL_TMR": "TON",
    "P_TRIG P1_TRIG": "R_TRIG",
    "P0_TRIG Q_TRIG": "F_TRIG",
}


def declared(**names: str) -> list[Variable]:
    return [Variable(name=name, type=type_) for type_, words in names.items() for name in words.split()]


def standard_block() -> Pou:
    inside = [Variable(name=name, type=type_) for names, type_ in INSIDE.items() for name in names.split()]
    sections = [
        VariableSection(kind=SectionKind.INPUT, variables=declared(BOOL=" ".join(QUALIFIERS), TIME="T")),
        VariableSection(kind=SectionKind.OUTPUT, variables=declared(BOOL="Q A PULSE")),
        VariableSection(variables=inside),
    ]
    return Pou(
        name="ACTION_CONTROL",
        kind=PouKind.FUNCTION_BLOCK,
        interface=Interface(sections=sections),
        bodies=[StBody(text=BLOCK)],
    )


def chart_of(qualifiers: list[str], time: str) -> SfcNetwork:
    """A pair of steps for each association: the step `on` is active while the input of the same number is TRUE."""
    chart = SfcNetwork()
    for index, qualifier in enumerate(qualifiers):
        off = chart.add_step(f"off{index}", initial=True)
        on = chart.add_step(f"on{index}")
        chart.add_transition(off, on, f"i{index}")
        chart.add_transition(on, off, f"NOT i{index}")
        duration = time if qualifier in TIMED else None
        on.actions = [
            ActionAssociation(id=2 * index, qualifier=Qualifier(qualifier), target="Flag", duration=duration),
            ActionAssociation(id=2 * index + 1, qualifier=Qualifier(qualifier), target="Count", duration=duration),
        ]
    return chart


def bench(chart: SfcNetwork, profile: str, inputs: int) -> tuple[Controller, Instance]:
    names = " ".join(f"i{index}" for index in range(inputs))
    section = VariableSection(variables=declared(BOOL=f"{names} Flag", INT="n"))
    pou = Pou(
        name="Main",
        kind=PouKind.PROGRAM,
        interface=Interface(sections=[section]),
        actions=[Action(name="Count", body=StBody(text="n := n + 1;"))],
        bodies=[SfcBody(chart=chart)],
    )
    controller = Controller(Project(name="p", pous=[pou]), PROFILES[profile], chart_compiler=compile_chart)
    return controller, controller.instance("Main")


@settings(deadline=None, max_examples=examples(60))
@given(seed=st.integers(0, 10**9))
def test_the_control_does_what_the_block_of_the_standard_does(seed: int) -> None:
    random = Random(seed)  # noqa: S311
    qualifiers = [random.choice(QUALIFIERS) for _ in range(random.randint(1, 4))]
    time = random.choice((0, 10, 20, 25, 40))
    controller, instance = bench(chart_of(qualifiers, f"T#{time}ms"), "iec", len(qualifiers))
    block_project = Project(name="b", pous=[standard_block()])
    block_controller = Controller(block_project, PROFILES["iec"], chart_compiler=compile_chart)
    block = block_controller.instance("ACTION_CONTROL")
    block["T"] = time * MS
    block.scan()  # F_TRIG says TRUE in its first call, which nothing has preceded
    levels = [False] * len(qualifiers)
    runs = 0
    for scan in range(40):
        controller.now = block_controller.now = scan * 10 * MS
        levels = [random.random() < 0.5 if random.random() < 0.35 else level for level in levels]
        for index, level in enumerate(levels):
            instance[f"i{index}"] = level
        for qualifier in QUALIFIERS:
            block[qualifier] = any(level for q, level in zip(qualifiers, levels, strict=True) if q == qualifier)
        instance.scan()
        block.scan()
        runs += block["A"]
        assert instance["Flag"] is (block["Q"] or block["PULSE"]), (qualifiers, time, scan)
        assert instance["n"] == runs, (qualifiers, time, scan)


@settings(deadline=None, max_examples=examples(25))
@given(seed=st.integers(0, 10**9), profile=st.sampled_from(["iec", "codesys", "grafcet"]))
def test_a_snapshot_is_all_that_a_chart_knows(seed: int, profile: str) -> None:
    """Going on from a snapshot, also at another time, gives the same as before."""
    random = Random(seed)  # noqa: S311
    qualifiers = [random.choice(QUALIFIERS) for _ in range(random.randint(1, 4))]
    controller, instance = bench(chart_of(qualifiers, "T#30ms"), profile, len(qualifiers))

    def go(inputs: list[list[bool]]) -> list[tuple[object, ...]]:
        found = []
        for values in inputs:
            controller.now += 10 * MS
            for index, value in enumerate(values):
                instance[f"i{index}"] = value
            instance.scan()
            ((_, chart, frame),) = instance.charts()
            assert isinstance(chart, ChartProgram)
            times = tuple(instance[f"on{index}.T"] for index in range(len(values)))
            found.append((chart.active(frame), instance["Flag"], instance["n"], *times))
        return found

    inputs = [[random.random() < 0.5 for _ in qualifiers] for _ in range(24)]
    go(inputs[: random.randint(0, 12)])
    kept = instance.snapshot()
    first = go(inputs[12:])
    controller.now += random.randint(0, 10**12)
    instance.restore(kept)
    assert instance.snapshot() == kept
    assert go(inputs[12:]) == first
