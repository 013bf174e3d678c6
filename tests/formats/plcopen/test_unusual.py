"""Deviations from TC6 that some tools write."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.formats.codesys.codesys_codec import validate_codesys
from tests.samples import FIXTURES
from tests.snippets import codes, pou, project

DEVICE = """<data name="http://www.3s-software.com/plcopenxml/device" handleUnknown="implementation"><Device xmlns="">
<DeviceType><Connector moduleType="256"><HostParameterSet><Parameter ParameterId="1" type="std:BOOL">
<Attributes download="true" functional="false" onlineaccess="readwrite" offlineaccess="read" channel="input"/>
<Value>1</Value></Parameter></HostParameterSet></Connector></DeviceType></Device></data>"""


def test_descriptions_of_devices_are_no_errors() -> None:
    """They are data of the vendor: a schema of this package can only warn."""
    text = (FIXTURES / "codesys" / "device_export.xml").read_bytes().decode("utf-8-sig")
    place = text.index("<addData>", text.index("<resource")) + len("<addData>")
    data = (text[:place] + DEVICE + text[place:]).encode()
    assert [str(found) for found in validate_codesys(data) if found.severity == "error"] == []
    loaded = sfc.loads(data)
    assert loaded.diagnostics == ()
    assert sfc.dumps(loaded) == data


@pytest.mark.parametrize("version", ["1.01", "2.0", "2.01"])
@pytest.mark.parametrize(
    ("spelled", "kind"),
    [("PROGRAM", m.PouKind.PROGRAM), ("FUNCTIONBLOCK", m.PouKind.FUNCTION_BLOCK), ("Function", m.PouKind.FUNCTION)],
)
def test_kinds_of_pous_in_another_case(version: str, spelled: str, kind: m.PouKind) -> None:
    data = project(pou("<body><ST><xhtml:p>x := 1;</xhtml:p></ST></body>", kind=spelled), version=version)
    loaded = sfc.loads(data)
    assert loaded.pous[0].kind is kind
    assert codes(loaded) == ["XML202"]
    assert sfc.dumps(loaded) == data
    assert sfc.loads(sfc.dumps(loaded, fresh=True)) == loaded


@pytest.mark.parametrize("version", ["1.01", "2.0", "2.01"])
@pytest.mark.parametrize("content", ["<text>x := 1;</text>", "", '<CFC xmlns="urn:v"><box/></CFC>'])
def test_a_body_in_no_language_is_written_anew_as_it_was(version: str, content: str) -> None:
    data = project(pou(f"<body>{content}</body>"), version=version)
    loaded = sfc.loads(data)
    assert isinstance(loaded.pous[0].body, m.OpaqueBody)
    assert "XML206" in codes(loaded)
    fresh = sfc.dumps(loaded, fresh=True)
    assert sfc.loads(fresh) == loaded
    assert b"<ST" not in fresh
