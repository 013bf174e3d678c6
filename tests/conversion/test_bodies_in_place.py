"""Bodies in place, drawn and as text, in every tool: actions of the POU, expressions, and the same behaviour."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.networks import draw_fbd
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.model import (
    Action,
    ActionAssociation,
    Block,
    Body,
    BodyCondition,
    Connection,
    Edge,
    FbdBody,
    IlBody,
    InputPin,
    Interface,
    OutputVariable,
    Pou,
    PouKind,
    Project,
    Qualifier,
    SfcBody,
    SfcNetwork,
    StBody,
    Variable,
    VariableSection,
)
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import Outcome

CODESYS_FAMILY = ["codesys", "codesys-export", "twincat", "codesys23"]
BODIES: dict[str, Body] = {
    "FBD": draw_fbd(parse_statements("n := n + 1;").tree.statements).body,
    "IL": IlBody(text="LD n\nADD 1\nST n"),
    "ST": StBody(text="n := n + 1;"),
}


def program(body: Body, condition: str) -> Project:
    """A program of two steps: `body` in place at the second, and conditions that are bodies of one expression."""
    chart = SfcNetwork()
    first, second = chart.add_step("S1", initial=True), chart.add_step("S2")
    second.actions = [ActionAssociation(id=50, qualifier=Qualifier.N, body=body.model_copy(deep=True))]
    for left, entered, text in ((first, second, condition), (second, first, f"NOT {condition}")):
        chart.add_transition(left, entered, "TRUE").condition = BodyCondition(body=StBody(text=text))
    sections = [
        VariableSection(kind=SectionKind.INPUT, variables=[Variable(name="c", type="BOOL")]),
        VariableSection(kind=SectionKind.OUTPUT, variables=[Variable(name="n", type="INT")]),
    ]
    interface = Interface(sections=sections)
    pou = Pou(name="Main", kind=PouKind.PROGRAM, interface=interface, bodies=[SfcBody(chart=chart)])
    return Project(name="p", pous=[pou], dialect=Dialect.IEC)


def keeping_network() -> FbdBody:
    """``n`` counted, with what it was before added to `m`, while the edge of `c` toggles `r`: both need variables."""
    body = draw_fbd(parse_statements("n := n + 1; m := n - 1; r := c;").tree.statements, divided=True).body
    counting, rest, toggling = body.networks
    (sum_,) = (node.id for node in counting.nodes if isinstance(node, Block))
    wire = InputPin(connections=[Connection(source=sum_, pin="OUT")])
    counting.nodes.append(OutputVariable(id=99, expression="m", input=wire))
    (result,) = (node for node in toggling.nodes if isinstance(node, OutputVariable))
    result.edge = Edge.RISING
    body.networks.remove(rest)
    return body


CASES = [(target, language) for target in [*CODESYS_FAMILY, "iec-text"] for language in BODIES]
CASES.remove(("iec-text", "IL"))


@pytest.mark.slow
@pytest.mark.parametrize(("target", "language"), CASES)
def test_bodies_in_place_are_executed(target: str, language: str, tmp_path: Path) -> None:
    """Networks went inline into CODESYS XML, `: NOT c` into text, and the report called itself a mistake."""
    path = tmp_path / "main"
    report = sfc.save(program(BODIES[language], "c"), path, format=target, limit=5)
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []
    assert not any("may not read" in item.why or "report this" in item.why for item in report.items)
    assert report.untested == {}
    assert "equal" in report.compared["POU Main"]
    seen = sfc.load(path, format=target, as_tool=True)
    assert not seen.diagnostics
    assert [transition.condition.kind for _, _, chart in seen.charts() for transition in chart.transitions] == [
        "expression",
        "expression",
    ]
    if target in CODESYS_FAMILY:
        (pou,) = seen.pous
        assert all(row.body is None for _, _, chart in seen.charts() for _, row in chart.associations())
        assert [action.body.language for action in pou.actions if action.body is not None] != ["FBD"]


def test_a_block_called_before_a_condition_is_refused_once_in_text(tmp_path: Path) -> None:
    """It was translated, into the undeclared name `Condition`, and not executed at once."""
    project = program(BODIES["ST"], "c")
    (chart,) = project.charts()
    drawn = draw_fbd(parse_statements("t1(IN := c, PT := T#50ms); x := t1.Q;").tree.statements).body
    network = drawn.networks[0]
    network.nodes = [node for node in network.nodes if getattr(node, "expression", "") != "x"]
    chart.chart.transitions[0].condition = BodyCondition(body=drawn)
    assert project.pous[0].interface is not None
    timer = Variable(name="t1", type={"kind": "derived", "name": "TON"})
    project.pous[0].interface.sections.append(VariableSection(kind=SectionKind.LOCAL, variables=[timer]))
    report = sfc.save(project, tmp_path / "main.st", format="iec-text", partial=True)
    assert [item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)] == ["condition"]
    assert not any(item.what == "condition" for item in report.with_outcome(Outcome.TRANSLATED))


@pytest.mark.slow
@pytest.mark.parametrize("target", CODESYS_FAMILY[1:])
@pytest.mark.parametrize("where", ["action", "pou"])
def test_drawn_bodies_that_keep_something_get_variables_in_text(target: str, where: str, tmp_path: Path) -> None:
    """Their text was left out with `cannot be written`, as the variable of a wire or an edge is not declared."""
    project = program(BODIES["ST"], "c")
    project.dialect = Dialect.CODESYS  # the same final scans
    (pou,) = project.pous
    assert pou.interface is not None
    outputs = [Variable(name="m", type="INT"), Variable(name="r", type="BOOL")]
    pou.interface.sections[1].variables += outputs
    drawn = keeping_network()
    if where == "action":
        pou.actions.append(Action(name="Count", body=drawn))
        pou.chart.step("S2").actions = [ActionAssociation(id=50, target="Count", qualifier=Qualifier.N)]
    else:
        pou.bodies = [drawn]
    path = tmp_path / "main"
    report = sfc.save(project, path, format=target, limit=3 if where == "action" else 0)
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []
    assert all("equal" in verdict for verdict in report.compared.values())
    (seen,) = sfc.load(path, format=target, as_tool=True).pous
    added = {getattr(each.type, "name", "") for each in seen.variables(SectionKind.LOCAL)}
    assert added == {"INT", "R_TRIG"}
