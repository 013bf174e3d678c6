"""Things of the same name: renames and the interpreter take a name for the same thing."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.languages.binding import Kind, Names
from plcopen_sfc.model.dialect import Dialect

POUS = """
FUNCTION_BLOCK Pump VAR_OUTPUT n : INT; END_VAR n := n + 1; END_FUNCTION_BLOCK
FUNCTION Scale : INT VAR_INPUT v : INT; END_VAR Scale := 10 * v; END_FUNCTION
PROGRAM Count VAR_OUTPUT n : INT; END_VAR n := n + 100; END_PROGRAM
PROGRAM Main VAR x : INT; END_VAR %s END_PROGRAM
"""


def project(text: str) -> m.Project:
    made = sfc.loads((POUS % text).encode(), format="iec-text")
    made.dialect = Dialect.CODESYS
    variables = [m.Variable(name="Pump", type="Pump"), m.Variable(name="Scale", type="INT")]
    made.global_variables.append(m.VariableSection(name="GVL", kind=m.SectionKind.GLOBAL, variables=variables))
    task = m.Task(name="Cyclic", instances=[m.PouInstance(name="Count", type_name="Count")])
    made.configurations.append(m.Configuration(name="Plant", resources=[m.Resource(name="Cell", tasks=[task])]))
    return made


@pytest.mark.parametrize(
    ("text", "name", "kind", "value"),
    [
        ("Pump(); x := GVL.Pump.n;", "Pump", Kind.VARIABLE, "2"),  # a type cannot be called
        ("x := Scale(2);", "Scale", Kind.POU, "20"),  # a number cannot be called
        ("Scale := 7; x := GVL.Scale;", "Scale", Kind.VARIABLE, "7"),
        ("Count(); x := Count.n;", "Count", Kind.POU, None),
    ],
)
def test_a_name_is_the_same_thing_for_all(text: str, name: str, kind: Kind, value: str | None) -> None:
    made = project(text)
    main = made.pou("Main")
    first = next(
        found.meaning.declaration
        for found in Names(made).occurrences(name)
        if found.text_site.site.pou is main and found.text_site.language == "ST" and found.reference.base is None
    )
    assert first is not None
    assert first.kind is kind
    trace = str(sfc.simulate(made, pou="Main", scans=2))
    assert value is None or trace.rsplit(maxsplit=1)[-1] == value
