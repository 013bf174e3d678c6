"""Bodies of every language as their names tell: what they read, write and call, and what is no name."""

from __future__ import annotations

import gc
import pickle

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.languages.binding import ANYTHING, BoundBody, bind, called_actions, is_named_elsewhere
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import Body


def st(text: str) -> m.StBody:
    return m.StBody(text=text)


def il(text: str) -> m.IlBody:
    return m.IlBody(text=text)


def wire(source: int) -> m.InputPin:
    return m.InputPin(connections=[m.Connection(source=source)])


def box(type_name: str, enable: str = "go", **more: str) -> m.FbdBody:
    """A box with an enabling input."""
    enabled = m.BlockVariable(name="EN", input=wire(1))
    block = m.Block(id=2, type_name=type_name, parameters=m.BlockParameters(inputs=[enabled]), **more)  # type: ignore[arg-type]
    return m.FbdBody(networks=[m.LogicNetwork(nodes=[m.InputVariable(id=1, expression=enable), block])])


def rung(contact: str, coil: str) -> m.LdBody:
    nodes: list[m.network.Node] = [
        m.LeftPowerRail(id=1),
        m.Contact(id=2, variable=contact, input=wire(1)),
        m.Coil(id=3, variable=coil, input=wire(2)),
    ]
    return m.LdBody(networks=[m.LogicNetwork(title="Fill the tank", nodes=nodes)])


def bound(body: Body) -> BoundBody:
    return bind(body, Dialect.CODESYS)


def named(body: Body) -> set[str]:
    return {each.name for each in bound(body).uses}


def owner(*actions: str) -> m.Pou:
    return m.Pou(name="Main", kind=m.PouKind.PROGRAM, actions=[m.Action(name=name, body=st("")) for name in actions])


@pytest.mark.parametrize(
    ("body", "reads", "writes"),
    [
        (st("IF a THEN b := c.d; END_IF"), {("a",), ("c", "d")}, {("b",)}),
        (st("list[i].x := y;"), {("i",), ("y",)}, {("list",)}),
        (il("LD a\nAND c.d\nST b\nR e"), {("a",), ("c", "d")}, {("b",), ("e",)}),
        (il("again: LD a\nJMPC again"), {("a",)}, set()),
        (il("CAL t(IN := a,\n Q => b)"), {("a",)}, {("t",), ("b",), ANYTHING}),
        (st("FOR i := 1 TO k DO b := (c := d); END_FOR"), {("i",), ("k",), ("d",)}, {("i",), ("b",), ("c",)}),
        (rung("a", "b"), {("a",)}, {("b",)}),
        (box("TON", instance="a"), {("go",)}, {("a",)}),
        (box("Motor", instance="a"), {("go",)}, {("a",), ANYTHING}),
    ],
)
def test_reads_and_writes(body: Body, reads: set[tuple[str, ...]], writes: set[tuple[str, ...]]) -> None:
    assert bound(body).effects.reads == reads
    assert bound(body).effects.writes == writes
    assert not bound(body).unknown


CALLING = [
    st("Fill();"),
    st("Fill;"),
    st("IF full THEN THIS^.Fill(); END_IF"),
    st("Main.Fill();"),
    st("x := Main.Fill(a := 1);"),
    il("CAL Fill"),
    il("LD full\nCALCN Fill"),
    il("LD 1\nFill 2\nST x"),
    box("Fill"),
    box("Main.Fill"),
    box("Fill", call="action", instance="Main"),
]
NOT_CALLING = [
    st("x := 1; (* Fill() *)"),
    st("x := 'Fill()';"),
    st("x := Tank.Fill;"),
    st("Tank.Fill := TRUE;"),
    st("Tank.Fill();"),
    st("Tank(Fill := TRUE);"),
    il("LD x (* CAL Fill *)\nST y"),
    il("LD 'Fill()'\nST y"),
    il("CAL Tank.Fill"),
    il("CAL Tank(Fill := TRUE)"),
    rung("x", "Tank.Fill"),
    box("Tank.Fill"),
]


@pytest.mark.parametrize("body", CALLING)
def test_calls_of_an_action_are_found_in_every_language(body: Body) -> None:
    assert called_actions(body, owner("Fill", "Empty"), Dialect.CODESYS) == {"fill"}


@pytest.mark.parametrize("body", NOT_CALLING)
def test_comments_strings_and_members_of_the_same_name_are_no_calls(body: Body) -> None:
    assert called_actions(body, owner("Fill", "Empty"), Dialect.CODESYS) == set()


@pytest.mark.parametrize("body", [st("x := := Fill();"), m.OpaqueBody(source="x", content="<call>Fill</call>")])
def test_what_cannot_be_read_may_call_what_it_names(body: Body) -> None:
    assert bound(body).unknown
    assert called_actions(body, owner("Fill", "Empty"), Dialect.CODESYS) == {"fill"}


def test_charts_name_actions_in_associations_and_steps() -> None:
    chart = sfc.SfcNetwork()
    first, second = chart.add_step("Fill", initial=True), chart.add_step("B")
    chart.add_transition(first, second, "full AND NOT (* Drain *) Tank.Pour")
    second.actions.append(m.ActionAssociation(id=7, target="Empty", duration="delay"))
    second.actions.append(m.ActionAssociation(id=8, body=il("CAL Rinse")))
    first.exit_action = "Stir"
    body = m.SfcBody(chart=chart)
    pou = owner("Fill", "Empty", "Rinse", "Stir", "Drain", "Pour")
    assert called_actions(body, pou, Dialect.CODESYS) == {"empty", "rinse", "stir"}
    assert {("full",), ("tank", "pour"), ("delay",)} <= bound(body).effects.reads
    assert ("empty",) in bound(body).effects.writes


@pytest.mark.parametrize("body", [*CALLING, il("LD Fill\nST x"), rung("Fill", "x"), st("Fill.x := 1;")])
def test_name_sites(body: Body) -> None:
    assert "Fill" in named(body)
    assert not {"(* Fill() *)", "tank"} & named(body)


@pytest.mark.parametrize("body", [st("x := 'Fill'; // Fill"), il("LD x (* Fill *)\nST y"), rung("x", "y")])
def test_comments_strings_and_titles_hold_no_name_sites(body: Body) -> None:
    assert "Fill" not in named(body)


def test_targets_are_given_as_they_are_written() -> None:
    for body in (st("Tank.Level[1] := x;"), il("LD x\nST Tank.Level[1]"), rung("x", "Tank.Level[1]")):
        assert [print_node(target) for target in bound(body).targets()] == ["Tank.Level[1]"]


def test_a_view_is_made_once_and_follows_the_body() -> None:
    text, ladder = st("a := b;"), rung("a", "b")
    assert bound(text) is bound(text)
    assert bound(ladder) is bound(ladder)
    text.text = "c := d;"
    ladder.networks[0].nodes[1].variable = "c"  # type: ignore[union-attr]  # a contact
    assert bound(text).effects.writes == {("c",)}
    assert bound(ladder).effects.reads == {("c",)}
    del text, ladder
    gc.collect()
    assert bound(st("e := 1;")).effects.writes == {("e",)}


def test_a_view_belongs_to_its_body_alone() -> None:
    text = st("a := b;")
    bound(text)
    copies = [text.model_copy(), text.model_copy(deep=True), pickle.loads(pickle.dumps(text))]  # noqa: S301  # ours
    assert [bound(each).body is each for each in copies] == [True] * 3
    assert bound(text).body is text


PLAN = b"""PROGRAM Main VAR x : BOOL; END_VAR
INITIAL_STEP A: Act(N); END_STEP TRANSITION FROM A TO B := x; END_TRANSITION
STEP B: x(N); END_STEP TRANSITION FROM B TO A := NOT x; END_TRANSITION
ACTION Act: x := NOT x; END_ACTION
END_PROGRAM"""


@pytest.mark.slow
def test_projects_are_freed_after_their_bodies_were_bound() -> None:
    def alive() -> int:
        gc.collect()
        return sum(type(each) is sfc.Project for each in gc.get_objects())

    before = alive()
    for format_ in ("codesys", "plcopen", "scl"):
        project = sfc.loads(PLAN)
        sfc.check(project)
        sfc.convert(project, format=format_, partial=True)
    del project
    assert alive() == before


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (st("Main();"), True),
        (st("x := Main.level;"), True),
        (il("CAL Main"), True),
        (rung("Main.level", "x"), True),
        (box("Main"), True),
        (st("x := := Main;"), True),
        (st("x := 1; // Main"), False),
        (st("x := 'Main';"), False),
        (st("x := Pump.Main;"), False),
        (il("LD x (* Main *)\nST y"), False),
    ],
)
def test_programs_are_named_by_the_texts_of_other_pous(body: Body, *, expected: bool) -> None:
    main, other = owner(), m.Pou(name="Other", kind=m.PouKind.PROGRAM, bodies=[body])
    pump = m.StructType(members=[m.Variable(name="Main", type=m.ElementaryType(name="BOOL"))])
    pumps = m.VariableSection(kind=m.SectionKind.LOCAL, variables=[m.Variable(name="Pump", type=pump)])
    other.interface = m.Interface(sections=[pumps])
    main.bodies = [st("x := Main.level;")]
    assert is_named_elsewhere(main, m.Project(pous=[main, other])) is expected
