"""Elements in namespaces whose names are relative have no canonical form; they are kept all the same."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.formats.xml.extension_data import canonical_form, markup
from tests.corpus import ROOT

FIXTURES = ROOT / "fixtures"
STRANGE = b'<x:strange xmlns:x="relative" x:a="1"><x:inner>text</x:inner></x:strange>'


def test_the_form_of_relative_namespaces() -> None:
    element = etree.fromstring(STRANGE)
    assert etree.tostring(etree.fromstring(canonical_form(element))) == STRANGE
    assert etree.tostring(etree.fromstring(markup(element))) == STRANGE
    plain = etree.fromstring(b"<a  b='1'><!--c--></a>")
    assert canonical_form(plain, comments=False) == b'<a b="1"></a>'


@pytest.mark.parametrize(
    ("file", "before"),
    [
        ("simaticml/FB_Motor.xml", b"</AttributeList>"),
        ("simaticml/FB_Drill.xml", b"</AttributeList>"),
        ("simaticml/FC_Release.xml", b"<Parts>"),
        ("plcopen/filling_station_2.01.xml", b"</contentHeader>"),
    ],
)
def test_files_with_relative_namespaces(file: str, before: bytes, tmp_path: Path) -> None:
    data = (FIXTURES / file).read_bytes()
    assert before in data
    strange = data.replace(before, STRANGE + before if before.startswith(b"</") else before + STRANGE, 1)
    path = tmp_path / "strange.xml"
    path.write_bytes(strange)
    project = sfc.load(path)
    project.read_all()
    assert sfc.dumps(project) == strange
    project.pous[0].name += "_2"
    assert b'xmlns:x="relative"' in sfc.dumps(project)
    assert b"relative" in sfc.dumps(project, fresh=True)
