"""Names in networks of FBD and LD, and in instruction list."""

from __future__ import annotations

import pytest

import plcopen_sfc.model as m
from plcopen_sfc.languages.binding import find_uses
from plcopen_sfc.languages.il import instructions
from plcopen_sfc.languages.text_edits import Edit
from plcopen_sfc.refactor.rename import edit_markup
from tests.languages.binding.projects import block, interface, pou, project, struct


def pin(name: str, *sources: tuple[int, str | None], expression: str | None = None) -> m.BlockVariable:
    wires = [m.Connection(source=source, pin=output) for source, output in sources]
    return m.BlockVariable(name=name, input=m.InputPin(connections=wires, expression=expression))


def network(*nodes: object) -> m.FbdBody:
    return m.FbdBody(networks=[m.LogicNetwork(nodes=list(nodes))])


def call(number: int, type_name: str, instance: str | None, *inputs: m.BlockVariable, **more: object) -> m.Block:
    outputs = [m.BlockVariable(name="done", output=m.OutputPin())]
    parameters = m.BlockParameters(inputs=list(inputs), outputs=outputs)
    return m.Block.model_validate(
        {"id": number, "type_name": type_name, "instance": instance, "parameters": parameters, **more}
    )


def count(made: m.Project, what: str) -> int:
    return len(find_uses(made, what))


def test_pins_are_members_of_what_is_called() -> None:
    fb = block("FB", input="run: BOOL", output="done: BOOL")
    main = pou("Main", "", "fb: FB; run: BOOL; t: TON")
    main.bodies = [
        network(
            m.InputVariable(id=1, expression="run OR fb.done"),
            call(2, "FB", "fb", pin("run", (1, None))),
            call(3, "TON", "t", pin("run", (2, "done"))),
            call(4, "FB", "unknown[1].fb", pin("run", expression="run")),
            m.OutputVariable(
                id=5, expression="run", input=m.InputPin(connections=[m.Connection(source=2, pin="done")])
            ),
        )
    ]
    made = project(fb, main)
    assert count(made, "FB") == 3  # the type of the variable, and two blocks
    assert count(made, "FB.run") == 2
    assert count(made, "FB.done") == 1 + 2 + 2  # the expression, two pins, two ends of wires
    assert count(made, "Main.run") == 3
    assert count(made, "Main.fb") == 2


def test_functions_and_actions_in_blocks() -> None:
    scale = pou("Scale", kind=m.PouKind.FUNCTION, input="raw: INT")
    main = pou("Main", "", "fb: FB; raw: INT", actions={"Act": ""})
    main.bodies = [
        network(
            call(1, "Scale", None, pin("raw", expression="raw")),
            call(2, "Act", None),
            call(3, "fb.Do", None, pin("raw", expression="raw")),
            call(4, "EXECUTE", None, code="raw := Scale(raw := raw);"),
            call(5, "AND", None, pin("raw")),
        )
    ]
    outputs = main.bodies[0].networks[0].nodes[0].parameters.outputs  # type: ignore[union-attr]
    outputs[0].name = "Scale"  # its result
    fb = block("FB")
    fb.methods = [m.Method(name="Do", interface=interface(input="raw: INT"))]
    made = project(scale, main, fb)
    assert count(made, "Scale.raw") == 2
    assert count(made, "Main.raw") == 4
    assert count(made, "FB.Do.raw") == 1
    assert count(made, "FB.Do") == count(made, "Main.Act") == 1
    assert count(made, "Scale") == 3


def test_ladder_diagrams() -> None:
    main = pou("Main", "", "a: BOOL; p: Point")
    main.bodies = [
        m.LdBody(
            networks=[
                m.LogicNetwork(
                    nodes=[
                        m.Contact(id=1, variable="A"),
                        m.Contact(id=2, variable="p.a"),
                        m.Coil(id=3, variable="a"),
                        m.Jump(id=4, label="a"),
                        m.Label(id=5, label="a"),
                        m.Connector(id=6, name="a"),
                        m.InOutVariable(id=7, expression="p.a"),
                        m.CommentBox(id=8, content="a"),
                    ]
                )
            ]
        )
    ]
    made = project(main, struct("Point", "a: BOOL"))
    assert count(made, "Main.a") == 2
    assert count(made, "Point.a") == 2


# -- instruction list -------------------------------------------------------------------------------------------------

IL = """LD a (* a *)
AND( b
OR c
)
ST p.a
a: CAL t(IN := a,
  PT := T#5s,
  Q => b)
JMPC a
Limit 0, a, 10
ANDN a
&N a
NOT
RET
"""


def test_instructions() -> None:
    found = [(i.label, i.operator, len(i.operands)) for i in instructions(IL)]
    assert found == [
        ("", "LD", 1),
        ("", "AND", 1),
        ("", "OR", 1),
        ("", ")", 0),
        ("", "ST", 1),
        ("a", "CAL", 1),
        ("", "JMPC", 1),
        ("", "Limit", 3),
        ("", "ANDN", 1),
        ("", "&N", 1),
        ("", "NOT", 0),
        ("", "RET", 0),
    ]
    assert [i.is_function for i in instructions(IL)].count(True) == 1


def test_names_in_instruction_list() -> None:
    main = pou("Main", "", "a: BOOL; b: BOOL; t: TON; p: Point")
    main.bodies = [m.IlBody(text=IL)]
    made = project(main, struct("Point", "a: BOOL"))
    uses = find_uses(made, "Main.a")
    assert [(use.line, use.column) for use in uses] == [(1, 4), (6, 16), (10, 10), (11, 6), (12, 4)]
    assert all(IL[slice(*use.span)] == "a" for use in uses)
    assert [(use.line, use.column) for use in find_uses(made, "Point.a")] == [(5, 6)]
    assert count(made, "Main.t") == 1
    assert count(made, "Main.b") == 2


@pytest.mark.parametrize(
    "text", ["", "\n\n", ":", "LD", ")", "(((", "LD (", "CAL f(", "'", "CAL f(\n\nLD x", "a:\nb:", "1 2 3"]
)
def test_any_text_is_read(text: str) -> None:
    list(instructions(text))


# -- markup -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("markup", "text", "expected"),
    [
        ("<p>x := 1;</p>", "x := 1;", "<p>new := 1;</p>"),
        ("<p><b>x</b> &lt; 1</p>", "x < 1", "<p><b>new</b> &lt; 1</p>"),
        ("<p> <![CDATA[x < 1]]> </p>", "x < 1", "<p> <![CDATA[new < 1]]> </p>"),
        ("<p>\n<!-- x -->x</p>", "x", "<p>\n<!-- x -->new</p>"),
        ("<p>&#120; + 1</p>", "x + 1", "<p>new + 1</p>"),
        ("<p>y</p>", "x", None),
    ],
)
def test_markup_keeps_its_tags(markup: str, text: str, expected: str | None) -> None:
    assert edit_markup(markup, text, [Edit(0, 1, "new")]) == expected
