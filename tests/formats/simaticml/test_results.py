"""Results of functions: in SimaticML they are a member of their own."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.semantics.programs import Controller

TEXT = """
FUNCTION Scale : REAL
VAR_INPUT raw : INT; top : REAL; END_VAR
Scale := INT_TO_REAL(raw) * 2.0;
IF Scale > top THEN Scale := top; END_IF;
END_FUNCTION
FUNCTION_BLOCK Main
VAR_INPUT w : INT; END_VAR
VAR_OUTPUT r : REAL; END_VAR
r := Scale(w, 30.0) + 1.0;
END_FUNCTION_BLOCK
"""


def results(project: m.Project) -> list[object]:
    """The output of the block for two inputs."""
    instance = Controller(project).instance("Main")
    found = []
    for raw in (7, 70):
        instance["w"] = raw
        instance.scan()
        found.append(instance["r"])
    return found


def test_tia_portal_sees_the_result_and_its_type() -> None:
    project = sfc.loads(TEXT.encode(), format="iec-text")
    content, report = sfc.convert(project, "simaticml")
    assert not [item for item in report.items if "return" in item.what]
    text = content.decode("utf-8-sig")
    assert '<Member Name="Ret_Val" Datatype="Real"' in text
    assert re.search(r'<Component Name="Scale"', text) is None
    seen = sfc.loads(content, as_tool=True)
    assert results(seen) == results(project) == [15.0, 31.0]
    back = sfc.loads(content)
    assert back.pous[0].interface is not None
    assert back.pous[0].interface.return_type == m.ElementaryType(name=m.Elementary.REAL)
    assert [s.kind for s in back.pous[0].interface.sections] == [m.SectionKind.INPUT]
    assert "#Scale := " in back.pous[0].bodies[0].text  # type: ignore[union-attr]
    there = sfc.loads(sfc.dumps(back, format="codesys"))
    texts = [pou.bodies[0].text for pou in project.pous]  # type: ignore[union-attr]
    named = [text.replace("Scale(w, 30.0)", "Scale(raw := w, top := 30.0)") for text in texts]  # as S7 wants it
    assert [pou.bodies[0].text for pou in there.pous] == named  # type: ignore[union-attr]


def box_of_scale() -> m.FbdBody:
    """A network that calls the function; nobody has named its pins."""
    inputs = [
        m.BlockVariable(name="", input=m.InputPin(connections=[m.Connection(source=number)])) for number in (1, 2)
    ]
    box = m.Block(
        id=3, type_name="Scale", parameters=m.BlockParameters(inputs=inputs, outputs=[m.BlockVariable(name="OUT")])
    )
    wire = m.InputPin(connections=[m.Connection(source=3, pin="OUT")])
    nodes = [
        m.InputVariable(id=1, expression="w"),
        m.InputVariable(id=2, expression="30.0"),
        box,
        m.OutputVariable(id=4, expression="r", input=wire),
    ]
    return m.FbdBody(networks=[m.LogicNetwork(nodes=nodes)])


def test_boxes_that_call_a_function_have_the_pins_that_it_declares() -> None:
    project = sfc.loads(TEXT.encode(), format="iec-text")
    project.pous[1].bodies = [box_of_scale()]
    content = sfc.dumps(project, format="simaticml", partial=True)
    text = content.decode("utf-8-sig")
    parameters = re.findall(r'<Parameter Name="(\w*)" Section="(\w+)" Type="(\w+)"', text)
    assert parameters == [("raw", "Input", "Int"), ("top", "Input", "Real"), ("Ret_Val", "Return", "Real")]
    assert results(sfc.loads(content, as_tool=True)) == [14.0, 30.0]


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01", "iec-text", "scl"])
def test_a_function_of_tia_portal_has_its_result_in_other_tools(target: str) -> None:
    content = sfc.dumps(sfc.loads(TEXT.encode(), format="iec-text"), format="simaticml")
    project = sfc.loads(content, as_tool=True)
    assert "#Ret_Val := " in project.pous[0].bodies[0].text  # type: ignore[union-attr]
    data, report = sfc.convert(project, target)
    assert report.losses == []
    seen = sfc.loads(data, format=target, as_tool=True)
    interface = seen.pou("Scale").interface
    assert interface is not None
    assert interface.return_type == m.ElementaryType(name=m.Elementary.REAL)
    assert [variable.name for variable in interface.variables()] == ["raw", "top"]
    assert results(seen) == [15.0, 31.0]


def test_a_box_of_a_function_of_tia_portal_has_its_result_in_other_tools() -> None:
    project = sfc.loads(TEXT.encode(), format="iec-text")
    project.pou("Main").bodies = [box_of_scale()]
    tia = sfc.loads(sfc.dumps(project, format="simaticml", partial=True), as_tool=True)
    seen = sfc.loads(sfc.dumps(tia, format="codesys"), format="codesys", as_tool=True)
    body = seen.pou("Main").bodies[0]
    assert isinstance(body, m.FbdBody)
    (box,) = [node for node in body.networks[0].nodes if isinstance(node, m.Block)]
    assert [pin.name for pin in box.parameters.outputs if pin.name != "ENO"] == ["Scale"]
    assert results(seen) == results(project)
