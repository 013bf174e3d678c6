"""RETAIN and CONSTANT of each variable in a list of CODESYS whose sections differ in them."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from tests.conversion.test_configurations import TARGETS
from tests.samples import FIXTURES

EXPORT = (FIXTURES / "codesys" / "sorting_conveyor.xml").read_bytes()
LIST = [("GVL_HMI", False, False, 3), ("GVL_HMI", True, False, 1), ("GVL_HMI", False, True, 1)]


def sections(project: m.Project) -> Iterator[m.VariableSection]:
    yield from project.global_variables
    for configuration in project.configurations:
        yield from configuration.global_variables
    for block in project.data_blocks:
        yield from block.interface.sections if block.interface is not None else ()


def attributes(project: m.Project, name: str) -> tuple[bool, bool]:
    """True if a variable is retained, and whether it is constant."""
    if any(constant.name == name for table in project.tag_tables for constant in table.constants):
        return False, True
    ((section, variable),) = [(s, v) for s in sections(project) for v in s.variables if v.name == name]
    return section.retain or variable.attributes.get("Remanence") == "Retain", section.constant


def test_a_list_has_the_sections_that_its_tool_compiles() -> None:
    project = sfc.loads(EXPORT)
    assert [(s.name, s.retain, s.constant, len(s.variables)) for s in project.global_variables[:3]] == LIST
    assert sfc.dumps(project) == EXPORT


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS[1:])
def test_a_target_retains_and_protects_the_same_variables_or_the_report_says_so(target: str) -> None:
    format_, _, flavour = target.partition(" ")
    data, report = sfc.convert(sfc.loads(EXPORT), format_, flavour=flavour, partial=True)
    seen = sfc.loads(data, as_tool=True)
    lost = {(item.what, item.path.rpartition(".")[2]) for item in report.losses}
    values = (item.path for item in report.items if "its value is in the texts" in item.why)
    written_as_values = set(values) if target == "scl" else set()
    for name, is_retained, is_constant in (
        ("bAutoMode", False, False),
        ("udiTotal", True, False),
        ("SLIDE_CAPACITY", False, True),
    ):
        if name in written_as_values:
            continue
        retained, constant = attributes(seen, name)
        assert retained is is_retained or ("retain", name) in lost
        assert constant is is_constant or ("constant", name) in lost


@pytest.mark.slow
@pytest.mark.parametrize("target", ["plcopen-1.01", "plcopen-2.01", "iec-text", "simaticml", "scl"])
def test_the_list_comes_back(target: str) -> None:
    data, _ = sfc.convert(sfc.loads(EXPORT), target, partial=True)
    back, _ = sfc.convert(sfc.loads(data), "codesys", partial=True)
    seen = sfc.loads(back, as_tool=True)
    assert [(s.name, s.retain, s.constant, len(s.variables)) for s in seen.global_variables[:3]] == LIST
    assert seen.global_variables[:3] == sfc.loads(EXPORT, as_tool=True).global_variables[:3]


def test_an_edit_is_made_in_both_copies_of_the_list() -> None:
    project = sfc.loads(EXPORT)
    project.global_variables[1].variables[0].name = "udiAll"
    data = sfc.dumps(project)
    assert data == EXPORT.replace(b'variable name="udiTotal"', b'variable name="udiAll"')


@pytest.mark.slow
def test_a_list_whose_copies_differ_is_not_executed_elsewhere() -> None:
    start = EXPORT.index(b"<MixedAttrsVarList>")
    edited = EXPORT[:start] + EXPORT[start:].replace(b'name="udiTotal"', b'name="udiOther"', 1)
    project = sfc.loads(edited)
    assert sfc.dumps(project) == edited
    _, report = sfc.convert(project, "plcopen-2.01", partial=True)
    assert any("mixedattrsvarlist" in item.path + item.why for item in report.losses)


def test_a_source_of_scl_has_the_value_of_a_constant_where_a_text_uses_it() -> None:
    project = sfc.loads(EXPORT)
    function = next(pou for pou in project.pous if isinstance(pou.body, m.StBody))
    function.bodies = [m.StBody(text=f"{function.name} := GVL_HMI.SLIDE_CAPACITY;")]
    data, _ = sfc.convert(project, "scl", partial=True)
    assert re.search(rb":= .*\b6\b.*;\s+END_FUNCTION", data)
