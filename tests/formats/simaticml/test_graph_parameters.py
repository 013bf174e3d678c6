"""Parameters that a block with a chart needs in its interface, and no model has."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m

STANDARD = (
    "OFF_SQ INIT_SQ ACK_EF S_PREV S_NEXT SW_AUTO SW_TAP SW_TOP SW_MAN S_SEL S_ON S_OFF T_PUSH "
    "S_NO S_MORE S_ACTIVE ERR_FLT AUTO_ON TAP_ON TOP_ON MAN_ON"
).split()


def project(*names: str, interface: bool = True) -> m.Project:
    chart = m.SfcNetwork()
    first, second = chart.add_step("A", initial=True), chart.add_step("B")
    chart.add_transition(first, second, "Start")
    chart.add_transition(second, first, "TRUE")
    variables = [m.Variable(name=name, type=m.ElementaryType(name=m.Elementary.BOOL)) for name in names]
    sections = [m.VariableSection(kind=m.SectionKind.INPUT, variables=variables)] if names else []
    pou = m.Pou(
        name="Chain",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=sections) if interface else None,
        bodies=[m.SfcBody(chart=chart)],
    )
    return m.Project(pous=[pou], dialect=m.Dialect.SCL)


def members(data: bytes) -> list[str]:
    return re.findall(r'<Member Name="(\w+)"', data.decode("utf-8-sig"))


@pytest.mark.parametrize("version", ["V14 SP1", "V16", "V21"])
@pytest.mark.parametrize("interface", [True, False])
def test_a_chart_of_a_script_gets_the_standard_parameters(version: str, interface: bool) -> None:
    original = project(*(["Start"] if interface else []), interface=interface)
    data = sfc.dumps(original, format="simaticml", tia=version)
    assert [name for name in members(data) if name != "Start"] == STANDARD
    assert data.count(b'Datatype="GRAPH_BASE"') == 1
    again = sfc.loads(data)
    assert again.pous[0].interface == original.pous[0].interface
    assert sfc.dumps(again, fresh=True) == data


def test_a_block_keeps_the_parameter_set_that_it_has() -> None:
    assert members(sfc.dumps(project("INIT_SQ", "Start"), format="simaticml")) == ["INIT_SQ", "Start"]


def test_a_variable_that_is_called_like_a_parameter_stays_what_it_is() -> None:
    names = members(sfc.dumps(project("s_no", "Start"), format="simaticml"))
    assert set(names) == {*STANDARD, "s_no", "Start"} - {"S_NO"}
    assert len(names) == len(set(names))


def test_what_somebody_adds_to_what_was_added_is_kept() -> None:
    data = sfc.dumps(project(interface=False), format="simaticml")
    at = data.index(b"</Section>", data.index(b"T_PUSH"))
    more = data[:at] + b'  <Member Name="Mine" Datatype="Bool" />\r\n          ' + data[at:]
    interface = sfc.loads(more).pous[0].interface
    assert interface is not None
    assert [variable.name for variable in interface.variables()] == ["Mine"]


def test_an_edit_of_such_a_file_is_that_edit() -> None:
    data = sfc.dumps(project("Start"), format="simaticml")
    loaded = sfc.loads(data)
    loaded.pous[0].comment = m.MultilingualText(texts={"en-US": "A chain"})
    saved = sfc.dumps(loaded)
    assert members(saved) == members(data)
    assert sfc.loads(saved).pous[0].interface == loaded.pous[0].interface


def test_a_project_of_a_script_loses_nothing() -> None:
    assert sfc.convert(project("Start"), "simaticml")[1].losses == []
