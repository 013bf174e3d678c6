"""The search where no proof is possible: it enters what can be entered, and finds what is wrong there."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.analysis.search_limits import SearchProgress
from plcopen_sfc.analysis.verdict import UntestedError
from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, walk
from plcopen_sfc.languages.st.nodes import Operator
from plcopen_sfc.lowering import LoweredPou
from plcopen_sfc.model import Project, StBody
from plcopen_sfc.semantics.subjects import resolve
from tests.sweeps import WHOLE, some_of


def project(transitions: str, actions: str = "") -> Project:
    text = f"""PROGRAM Main
VAR_INPUT Go, Sensor, Stop : BOOL; Raw : INT; END_VAR
VAR_OUTPUT Q : BOOL; END_VAR
VAR n : INT; level : REAL; edge : R_TRIG; END_VAR
INITIAL_STEP A: END_STEP
STEP B: Act(N); Q(N); END_STEP
STEP C: END_STEP
{transitions}
ACTION Act: {actions} END_ACTION
END_PROGRAM
"""
    return sfc.loads(text.encode(), format="iec-text")


BACK = "TRANSITION FROM C TO A := Stop; END_TRANSITION"
REACHED = {
    "a counter of edges": (
        "TRANSITION FROM A TO B := Go; END_TRANSITION TRANSITION FROM B TO C := n >= 60; END_TRANSITION",
        "edge(CLK := Sensor); IF edge.Q THEN n := n + 1; END_IF;",
    ),
    "a counter of rounds": (
        "TRANSITION FROM A TO B := Go; END_TRANSITION TRANSITION FROM B TO C := n = 300 AND Sensor; END_TRANSITION "
        "TRANSITION FROM B TO A := Stop; END_TRANSITION",
        "n := n + 1;",
    ),
    "an hour": (
        "TRANSITION FROM A TO B := Go; END_TRANSITION TRANSITION FROM B TO C := B.T >= T#1h AND Sensor; END_TRANSITION "
        "TRANSITION FROM A TO C := A.T > T#100ms AND Stop AND Sensor; END_TRANSITION",
        "n := n;",
    ),
    "a number of many": (
        "TRANSITION FROM A TO B := Raw = 12345; END_TRANSITION TRANSITION FROM B TO C := Raw = -777; END_TRANSITION",
        "level := INT_TO_REAL(Raw) * 0.25;",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", REACHED)
def test_what_is_waited_for_is_reached(kind: str) -> None:
    transitions, actions = REACHED[kind]
    chart = project(f"{transitions} {BACK}", actions)
    lowered = sfc.lower(chart, "bits", verify=False)
    verdict = equivalent(chart, lowered, cap=1, runs=50)
    assert verdict.kind is VerdictKind.TESTED, str(verdict)
    assert verdict.coverage[0].counts["step"] == (3, 3)


@pytest.mark.slow
def test_the_same_arguments_give_the_same_search() -> None:
    transitions, actions = REACHED["a counter of edges"]
    chart = project(f"{transitions} {BACK}", actions)
    lowered = sfc.lower(chart, "bits", verify=False)
    verdicts = [equivalent(chart, lowered, cap=1, runs=20).as_dict() for _ in range(2)]
    assert verdicts[0] == verdicts[1]


@pytest.mark.slow
def test_a_chart_that_cannot_go_on_is_proven_to_be_stuck() -> None:
    """The timer that a step waits for is only called by a step behind it."""
    chart = project(
        f"TRANSITION FROM A TO B := edge.Q AND Go; END_TRANSITION TRANSITION FROM B TO C := Go; END_TRANSITION {BACK}",
        "edge(CLK := Sensor);",
    )
    verdict = equivalent(chart, sfc.lower(chart, "bits", verify=False), cap=1, runs=20)
    assert verdict.coverage[0].counts["step"] == (1, 3)
    assert {each.impossible for each in verdict.coverage[0].unreached if each.kind == "step"} == {True}


@pytest.mark.slow
def test_every_step_of_a_chart_of_a_plant_is_entered() -> None:
    """It homes, starts by an edge, sorts, and goes to its fault and back."""
    conveyor = sfc.load("fixtures/codesys/sorting_conveyor.xml")
    lowered = sfc.lower(conveyor, "bits", pou="PLC_PRG", verify=False)
    verdict = equivalent(resolve(conveyor, "PLC_PRG"), lowered, cap=1)
    counts = verdict.coverage[0].counts
    assert [counts[kind] for kind in ("step", "transition", "action")] == [(25, 25), (27, 27), (29, 29)], str(verdict)


DRAFT = {"Eject_ACT_Eject_Draft"}  # not finished: a jump is behind a step, and nothing calls it
NOT_ENTERED = {
    "twincat/press_station.xml: FB_Press.ACT_Eject_Draft": DRAFT,
    "twincat/press_station.xml: FB_Press": {
        f"FB_Press.ACT_Eject_Draft: {each}" for each in DRAFT | {"Init_ACT_Eject_Draft"}
    },
    "codesys/sorting_conveyor.xml: PLC_PRG.ACT_Home": {"Done_ACT_Home"},  # another action of the POU calls its timer
}
WITH_CHARTS = [
    *("codesys/device_export.xml", "codesys/distribution_belt.xml", "codesys/sorting_conveyor.xml"),
    *("iectext/distribution_belt.st", "iectext/mixing_plant.st", "simaticml/FB_Drill.xml", "simaticml-plc"),
    *("twincat/press_station.xml", "training-chain/codesys.xml", "simaticml-training-chain/Ablauf.xml"),
]


LONG = ("codesys/sorting_conveyor.xml", "twincat/press_station.xml")
"""The chart of the conveyor is searched above too."""


@pytest.mark.slow
@pytest.mark.parametrize("file", some_of([file for file in WITH_CHARTS if WHOLE or file not in LONG], 2))
def test_every_step_of_a_fixture_can_be_entered(file: str) -> None:
    """A chart that cannot run shows nothing of what this package does."""
    loaded = sfc.load(f"fixtures/{file}")
    for name, _, _ in loaded.charts():
        chart = resolve(loaded, name)
        verdict = equivalent(chart, chart, cap=500)
        missing = {each.name for each in verdict.coverage[0].unreached if each.kind == "step"}
        assert missing == NOT_ENTERED.get(f"{file}: {name}", set()), str(verdict)


def test_what_the_tool_gives_an_input_address_is_an_input() -> None:
    text = """PROGRAM Main
VAR Part AT %I* : BOOL; Count AT %Q* : INT; END_VAR
INITIAL_STEP A: END_STEP
STEP B: Act(N); END_STEP
TRANSITION FROM A TO B := Part; END_TRANSITION
TRANSITION FROM B TO A := NOT Part; END_TRANSITION
ACTION Act: Count := 1; END_ACTION
END_PROGRAM
"""
    chart = sfc.loads(text.encode(), format="iec-text")
    verdict = equivalent(chart, chart, "codesys")
    assert (verdict.proven, verdict.inputs, verdict.frozen) == (True, ("Part",), ()), str(verdict)
    assert verdict.coverage[0].counts["step"] == (2, 2)


CYLINDERS = """FUNCTION_BLOCK Cylinder
VAR Out AT %I* : BOOL; In AT %I* : BOOL; Valve AT %Q* : BOOL; END_VAR
VAR_INPUT Go : BOOL; END_VAR
VAR_OUTPUT Moved : BOOL; END_VAR
Valve := Go AND NOT Out; Moved := In;
END_FUNCTION_BLOCK
{around}
PROGRAM Main
{one} VAR Two : Cylinder; END_VAR
INITIAL_STEP A: Act(N); END_STEP
STEP B: Act(N); END_STEP
STEP C: Act(N); END_STEP
TRANSITION FROM A TO B := One.Out; END_TRANSITION
TRANSITION FROM B TO C := Two.Moved AND NOT One.Moved; END_TRANSITION
TRANSITION FROM C TO A := Two.Valve; END_TRANSITION
ACTION Act: One(Go := B.X); Two(Go := C.X); END_ACTION
END_PROGRAM
"""


@pytest.mark.parametrize(
    ("around", "one"), [("", "VAR One : Cylinder; END_VAR"), ("VAR_GLOBAL One : Cylinder; END_VAR", "")]
)
def test_each_instance_has_inputs_of_its_own(around: str, one: str) -> None:
    """A variable of a block at `%I*` is a sensor, whoever calls the block."""
    chart = resolve(sfc.loads(CYLINDERS.format(around=around, one=one).encode(), format="iec-text"), "Main")
    verdict = equivalent(chart, chart, "codesys")
    assert verdict.proven, str(verdict)
    assert sorted(verdict.inputs) == ["One.In", "One.Out", "Two.In", "Two.Out"]
    assert verdict.coverage[0].counts["transition"] == (3, 3)


def test_an_error_of_one_side_tells_the_scan_of_its_own_run() -> None:
    def failing(value: str) -> Project:
        text = f"IF Go AND Raw = 321 THEN n := n + 1; END_IF; IF n > 3 THEN Q := 1 / ({value}) > 0; END_IF;"
        return project(f"TRANSITION FROM A TO B := Sensor; END_TRANSITION {BACK}", text)

    verdict = equivalent(failing("n"), failing("n - n"), "iec", cap=1, runs=20)
    assert verdict.counterexample is not None
    (error,) = {each.error for each in verdict.counterexample.differences}
    count = len(verdict.counterexample.inputs)
    assert error.startswith(f"only the second fails: scan {count}: "), error


# -- mutants


def mutants(text: str) -> Iterator[tuple[str, str]]:
    """Code with one mistake: a transition that goes nowhere, a condition negated or always TRUE, counting by two."""

    def put(node: n.Node, new: str) -> str:
        assert node.span is not None
        return text[: node.span[0]] + new + text[node.span[1] :]

    tree = parse_statements(text).tree
    for node in walk(tree):
        match node:
            # bits of transitions and steps; an action may be set back in vain, as it is written again
            case n.Assignment(target=n.Name(identifier=name), value=value) if name.startswith(("T", "X")):
                assert value.span is not None
                yield "negated", put(value, f"NOT ({text[slice(*value.span)]})")
                yield "always", put(value, "TRUE")
                yield "nowhere", put(value, "FALSE")
            case n.Assignment(value=n.Operation(Operator.ADD, (_, n.Literal() as one))):
                yield "by two", put(one, "2")


def compared(chart: Project, name: str, lowered: LoweredPou) -> Verdict:
    return equivalent(resolve(chart, name), lowered, cap=1, runs=25)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "name"),
    [("training-chain/codesys.xml", "Ablauf"), ("codesys/sorting_conveyor.xml", "FB_Pusher"), ("", "Main")],
)
def test_mutants_of_lowered_code_are_found(file: str, name: str) -> None:
    counting = project(f"{REACHED['a counter of edges'][0]} {BACK}", REACHED["a counter of edges"][1])
    chart = sfc.load(f"fixtures/{file}") if file else counting
    lowered = sfc.lower(chart, "bits", pou=name, verify=False)
    code = lowered.code
    assert isinstance(code, StBody)
    assert compared(chart, name, lowered).equal
    made = list(mutants(code.text))
    assert {"negated", "always", "nowhere"} <= {kind for kind, _ in made}
    for kind, text in made[:: max(len(made) // 8, 1)]:
        code.text = text
        assert compared(chart, name, lowered).different, f"{kind}:\n{text}"


# -- what is not enough

STUCK = project(
    "TRANSITION FROM A TO B := Go; END_TRANSITION TRANSITION FROM B TO C := INT_TO_REAL(Raw) * level > 7.0; "
    f"END_TRANSITION {BACK}"
)


@pytest.mark.slow
def test_what_was_not_reached_is_not_called_equal() -> None:
    with pytest.raises(UntestedError, match="not all was reached") as raised:
        sfc.lower(STUCK, "bits")
    verdict = raised.value.verdict
    assert (verdict.kind, verdict.equal, verdict.different) == (VerdictKind.UNTESTED, False, False)
    assert "step C: needs `INT_TO_REAL(Raw) * level > 7.0`, never reached" in str(verdict)
    assert sfc.lower(STUCK, "bits", accept_untested=True).proof is not None


@pytest.mark.parametrize(
    "body",
    [
        "s := s + 1; q := 10 / (2 - s);",
        "q := 10 / n;",
        "IF c THEN q := 10 / n; END_IF;",
        "q := 10 / (n - 2345);",
        "s := 3 * n; IF c THEN q := 10 MOD (s - 7035); END_IF;",
    ],
)
@pytest.mark.parametrize("cap", [2000, 1])
def test_errors_of_both_are_no_proof(body: str, cap: int) -> None:
    text = "PROGRAM Main\nVAR_INPUT c : BOOL; n : INT; END_VAR\nVAR_OUTPUT q : INT; END_VAR\nVAR s : INT; END_VAR\n"
    programs = [sfc.loads(f"{text}{body}\nEND_PROGRAM\n".encode(), format="iec-text") for _ in range(2)]
    verdict = equivalent(*programs, "iec", cap=cap, runs=20)
    assert (verdict.kind, verdict.equal) == (VerdictKind.UNTESTED, False), str(verdict)
    assert "both end with an error: line 1 (Main): division by zero" in verdict.reason
    assert str(verdict).startswith("not all was compared")
    assert verdict.as_dict()["gap"] == "both end with an error: line 1 (Main): division by zero"


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ("q := 10 / s;", "division by zero"),
        ("q := list[s + 9];", "the index 9 is outside of 0..3"),
        ("q := 10 / ;", "found ';', expected an expression"),
    ],
)
def test_errors_of_both_in_each_first_scan_are_a_verdict(body: str, why: str) -> None:
    variables = "VAR_OUTPUT q : INT; END_VAR VAR s : INT; list : ARRAY [0..3] OF INT; END_VAR"
    program = sfc.loads(f"PROGRAM Main\n{variables}\n{body}\nEND_PROGRAM\n".encode(), format="iec-text")
    verdict = equivalent(program, program)
    assert (verdict.kind, verdict.gap) == (VerdictKind.UNTESTED, f"both end with an error: line 1 (Main): {why}")
    assert str(verdict).startswith("not all was compared, no scan was finished (no proof: ")


def test_a_limit_ends_a_comparison_and_progress_is_told() -> None:
    transitions, actions = REACHED["a counter of rounds"]
    chart = project(f"{transitions} {BACK}", f"{actions} level := level + 0.1;")
    told: list[SearchProgress] = []
    lowered = sfc.lower(chart, "bits", verify=False)
    verdict = equivalent(chart, lowered, runs=1_000_000, limit="0.5s", progress=told.append)
    assert "the time limit of 0.5 s was reached" in verdict.reason
    assert told
    assert told[-1].all == 3


def test_an_interruption_ends_with_what_is_known() -> None:
    def interrupt(_: SearchProgress) -> None:
        raise KeyboardInterrupt

    transitions, actions = REACHED["a counter of rounds"]
    chart = project(f"{transitions} {BACK}", f"{actions} level := level + 0.1;")
    lowered = sfc.lower(chart, "bits", verify=False)
    verdict = equivalent(chart, lowered, runs=1_000_000, progress=interrupt)
    assert (verdict.interrupted, verdict.equal) == (True, False)
    assert verdict.coverage[0].counts["step"][0] >= 1


@pytest.mark.parametrize("other", ["b", "b OR FALSE", "b OR S.T > T#90m"])
def test_a_time_behind_an_alternative_is_waited_for(other: str) -> None:
    """Nothing but the time makes the condition TRUE while the alternative stays FALSE."""
    text = """PROGRAM Main VAR_INPUT a, b : BOOL; m : DINT; END_VAR VAR n : DINT; END_VAR
        INITIAL_STEP Rest: END_STEP STEP S: Count(N); END_STEP
        TRANSITION FROM Rest TO S := a; END_TRANSITION TRANSITION FROM S TO Rest := {}; END_TRANSITION
        ACTION Count: n := n + m / 3; END_ACTION END_PROGRAM"""
    timed, changed = (
        sfc.loads(text.format(condition).encode(), format="iec-text") for condition in ("b OR S.T > T#1h", other)
    )
    assert equivalent(timed, changed, "iec", cap=50, runs=5, scan_time="100ms").different


UNKNOWN = """FUNCTION_BLOCK Fill
VAR_INPUT Go : BOOL; Level : REAL; END_VAR
VAR_OUTPUT Valve : BOOL; END_VAR
VAR Bus : ModbusRead; Answer, Last : ModbusAnswer; END_VAR
METHOD Limit : BOOL
VAR_INPUT Enable : BOOL; END_VAR
VAR half : REAL; END_VAR
half := Level / 2.0;
IF Enable AND half > 40.0 THEN Limit := TRUE; ELSE Limit := FALSE; END_IF
END_METHOD
{call}
Last := Answer;
Valve := Limit(Enable := Go) AND Bus.Done;
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("call", ["Bus(Start := Go);", "Bus(Start := Go, Data => Answer);"])
def test_branches_of_methods_and_values_of_unknown_types_are_run(call: str) -> None:
    """The names of a method are no variables of the program; values of an unknown type can be copied."""
    one, other = (sfc.loads(UNKNOWN.format(call=call).encode(), format="iec-text").pou("Fill") for _ in range(2))
    verdict = equivalent(one, other, runs=2, scans=200)
    assert (verdict.equal, verdict.different) == (True, False), str(verdict)


def test_an_index_that_a_method_alone_knows_adds_no_variable() -> None:
    """It was added to the program in the middle of the search, whose states were too short from then on."""
    text = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR Errors : ARRAY[1..2] OF FB_Error; x : BOOL; n : INT; END_VAR
METHOD Add
VAR_INPUT w_Index : INT; END_VAR
Errors[w_Index](In := a);
IF Errors[w_Index].b_out AND n > 41234 THEN x := TRUE; END_IF
n := n + w_Index;
END_METHOD
INITIAL_STEP S1: END_STEP
STEP S2: Act(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b AND x; END_TRANSITION
ACTION Act: Add(w_Index := 1); END_ACTION
END_FUNCTION_BLOCK
"""
    project = sfc.loads(text.encode(), format="iec-text")
    assert not equivalent(project, project, "codesys", limit=0.6).different


@pytest.mark.slow
def test_a_situation_is_held_for_branches_that_wait_for_a_time_in_it() -> None:
    """A step exceeds its maximum time only while it is held, the limits are enabled and no error is shown yet."""
    project = sfc.load("fixtures/codesys/distribution_belt.xml")
    proof = sfc.lower(project, "case", pou="Ablauf_Band").proof
    assert proof is not None
    assert proof.equal, str(proof)
    reached, of_all = proof.coverage[1].counts["assignment"]
    assert reached == of_all > 90


EDGES = """PROGRAM Main VAR_INPUT go, man, auto, back : BOOL; sel : INT; END_VAR
VAR go_edge, go_before, man_edge, man_before, auto_edge, auto_before, is_man : BOOL; END_VAR
INITIAL_STEP S1: Edges(S); END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := (is_man AND sel = 7 AND go_edge) OR (NOT is_man AND back); END_TRANSITION
TRANSITION FROM S2 TO S1 := is_man AND sel = 8 AND go_edge; END_TRANSITION
ACTION Edges:
go_edge := go AND NOT go_before; go_before := go;
man_edge := man AND NOT man_before; man_before := man;
auto_edge := auto AND NOT auto_before; auto_before := auto;
is_man := man_edge OR (is_man AND NOT auto_edge);
END_ACTION
END_PROGRAM"""


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_edges_and_modes_of_permanent_statements_are_reached(profile: str) -> None:
    chart = sfc.loads(EDGES.encode(), format="iec-text")
    found = equivalent(chart, chart, profile, cap=1, runs=10, scans=50)
    assert found.kind is VerdictKind.TESTED, str(found)


@pytest.mark.slow
@pytest.mark.parametrize("cap", [30, 59])
def test_a_long_chart_is_walked_though_the_search_for_a_proof_was_there_before(cap: int) -> None:
    """Conditions are looked at on the way: what a search for a proof has entered already is entered once more."""
    count = 60
    names = ", ".join(f"a{i}, b{i}" for i in range(count))
    steps = "\n".join(f"STEP S{i}: q(N); END_STEP" for i in range(1, count))
    transitions = "\n".join(
        f"TRANSITION FROM S{i} TO S{(i + 1) % count} := a{i} AND NOT b{i}; END_TRANSITION" for i in range(count)
    )
    text = f"""PROGRAM Ring VAR_INPUT {names} : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
{steps}
{transitions}
END_PROGRAM
"""
    ring = sfc.loads(text.encode(), format="iec-text")
    verdict = equivalent(ring, ring, cap=cap, runs=5, scans=100)
    assert verdict.kind is VerdictKind.TESTED, str(verdict)
    assert verdict.coverage[0].counts["part of condition"] == (4 * count, 4 * count)


def line_of_stations(stations: int) -> Project:
    """Return a chart of ten steps a station, of which each fifth counts rounds, the first to 10 and others further."""
    inputs = "".join(f"go{k}, a{k}, b{k}, c{k} : BOOL; " for k in range(stations))
    outputs = "".join(f"v{k}, l{k}, m{k}, h{k} : BOOL; " for k in range(stations))
    lines = [f"PROGRAM Main VAR_INPUT {inputs}END_VAR VAR {outputs}n : INT; END_VAR"]
    for k in range(stations):
        counts = k % 5 == 0
        held = (
            f"v{k}(N);",
            f"l{k}(S);",
            f"m{k}(D, T#2s);",
            "",
            f"h{k}(N);",
            "",
            "",
            "Count(P);" * counts,
            f"l{k}(R);",
            "",
        )
        for number, action in enumerate(held):
            lines.append(f"{'INITIAL_' * (k + number == 0)}STEP S{k}_{number}: {action} END_STEP")
        done, again = (f"n >= {10 + k}", f"n < {10 + k}") if counts else (f"c{k}", f"a{k} AND NOT c{k}")
        following = f"S{(k + 1) % stations}_0"
        conditions = {
            ("0", "1, 4"): f"go{k}",
            ("1", "2"): f"a{k}",
            ("2", "3"): f"m{k}",
            ("4", "5"): f"b{k}",
            ("5", "6"): f"S{k}_5.T >= T#5s",
            ("3, 6", "7"): "TRUE",
            ("7", "8"): f"{done} AND c{k}" if counts else done,
            ("7", "9"): f"{again} AND c{k}" if counts else again,
            ("8", following): f"NOT go{k}",
            ("9", f"S{k}_0" if counts else following): f"NOT go{k}",
        }
        for (sources, targets), condition in conditions.items():
            ends = [
                ", ".join(each if each[0] == "S" else f"S{k}_{each}" for each in end.split(", "))
                for end in (sources, targets)
            ]
            lines.append(f"TRANSITION FROM ({ends[0]}) TO ({ends[1]}) := {condition}; END_TRANSITION")
    return sfc.loads(
        "\n".join([*lines, "ACTION Count: n := n + 1; END_ACTION END_PROGRAM"]).encode(), format="iec-text"
    )


def test_a_long_chart_is_entered_to_its_end_though_counters_hold_it() -> None:
    """What was near to an old aim is not looked at again before what is near to the present one."""
    chart = line_of_stations(6)
    assert equivalent(chart, chart, cap=1, runs=25, scans=100).kind is VerdictKind.TESTED


def test_a_difference_behind_days_of_short_scans_is_an_error_and_fills_no_memory() -> None:
    text = """PROGRAM Main VAR_INPUT x : BOOL; i, j : DINT; END_VAR VAR_OUTPUT q : BOOL; END_VAR
        VAR t : TON; m : DINT; END_VAR t(IN := x, PT := T#24d); m := i * j; q := t.Q AND {}; END_PROGRAM"""
    one, other = (sfc.loads(text.format(value).encode(), format="iec-text") for value in ("TRUE", "FALSE"))
    with pytest.raises(ModelError, match="scans, which are too many to be shown"):
        equivalent(one, other, "iec", scan_time="T#10ms", cap=10)
