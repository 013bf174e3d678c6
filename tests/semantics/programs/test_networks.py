"""Networks: FBD and LD run as they are drawn."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.networks import declared_rules, draw_fbd, draw_ld
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.model import FbdBody, LdBody, NamedCondition
from plcopen_sfc.semantics.programs import Controller, Instance
from plcopen_sfc.semantics.programs.routines import Routines
from tests.semantics.programs.running import MS, project_of

VARIABLES = (
    "VAR_INPUT a, b, c : BOOL; n : INT; END_VAR\n"
    "VAR q, s, r : BOOL; m : INT; t : TON; f : RS; u : CTU; e : R_TRIG; END_VAR"
)
BODY = """q := (a OR q) AND NOT b;
t(IN := q, PT := T#20ms);
f(S := t.Q, R1 := c);
s := f.Q1;
e(CLK := a);
u(CU := e.Q, R := b, PV := 3);
m := n * 2 + u.CV;
r := m > 5;
"""
INPUTS = [(True, False, False, 1), (False, False, False, 2), (False, True, True, 3), (True, False, False, 4)] * 3


def run(project: sfc.Project) -> list[tuple[object, ...]]:
    controller = Controller(project)
    instance: Instance = controller.instance("Main")
    assert not controller.problems, [str(problem) for problem in controller.problems]
    seen = []
    read = instance.reader(["q", "s", "r", "m", "u.CV"])
    for a, b, c, n in INPUTS:
        for name, value in (("a", a), ("b", b), ("c", c), ("n", n)):
            instance[name] = value
        instance.scan()
        controller.now += 15 * MS
        seen.append(read())
    return seen


@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_a_drawn_program_does_what_its_text_does(language: str) -> None:
    text = f"PROGRAM Main\n{VARIABLES}\n{BODY}END_PROGRAM"
    project = project_of(text)
    expected = run(project_of(text))
    assert len(set(expected)) > 4
    pou = project.pou("Main")
    assert pou.interface is not None
    rules = declared_rules(pou.interface.variables())
    statements = parse_statements(BODY).tree.statements
    drawn = draw_fbd(statements, rules) if language == "FBD" else draw_ld(statements, rules)
    assert isinstance(drawn.body, FbdBody | LdBody)
    pou.bodies = [drawn.body]
    assert run(project) == expected


def test_drawn_conditions_and_edges_of_a_fixture() -> None:
    project = sfc.load("fixtures/plcopen/filling_station_2.01.xml")
    pou = project.pou("FillingStation")
    controller = Controller(project)
    unit = controller.library.unit(pou)
    scope = unit.scope
    condition = Routines(scope).condition(NamedCondition(name="EmergencyOff"), "FillingStation.EmergencyOff")
    instance = controller.instance(pou)
    for door, expected in ((False, False), (True, True), (True, False)):
        instance["S3_Door"] = door
        instance["S5_EStopOk"] = True
        assert condition(instance.frame) is expected


def test_a_network_with_an_open_pin_is_an_error_where_it_is_executed() -> None:
    project = project_of(f"PROGRAM Main\n{VARIABLES}\nq := a;\nEND_PROGRAM")
    pou = project.pou("Main")
    drawn = draw_ld(parse_statements("q := a AND b;").tree.statements)
    network = drawn.body.networks[0]
    network.nodes = [node for node in network.nodes if node.kind != "contact"]
    pou.bodies = [drawn.body]
    controller = Controller(project)
    instance = controller.instance("Main")
    with pytest.raises(SimulationError, match="the network cannot be executed: element") as caught:
        instance.scan()
    assert caught.value.pou == "Main"
