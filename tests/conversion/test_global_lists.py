"""Lists of global variables of CODESYS where other tools have none."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.conversion import compare, executed
from plcopen_sfc.documents.lowered import lower_to_file
from plcopen_sfc.report import Outcome

PROGRAM = """FUNCTION_BLOCK Main
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT n : INT; END_VAR
VAR {local} : INT; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO {step} := GVL1.x AND a; END_TRANSITION
STEP {step}: Act(N); END_STEP
TRANSITION FROM {step} TO S0 := GVL1.y > 3; END_TRANSITION
ACTION Act: n := n + GVL1.y + z; END_ACTION
END_FUNCTION_BLOCK
"""


def listed(local: str = "k", step: str = "S1", lists: tuple[str, ...] = ("GVL1",)) -> m.Project:
    """A CODESYS application whose chart names variables of a list with and without it."""
    project = sfc.loads(PROGRAM.format(local=local, step=step).encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    types = {"x": "BOOL", "y": "INT", "z": "INT"}
    variables = [m.Variable.model_validate({"name": name, "type": kind}) for name, kind in types.items()]
    sections = [
        m.VariableSection(
            kind=m.SectionKind.GLOBAL, name=name, variables=variables if name == "GVL1" else variables[1:2]
        )
        for name in lists
    ]
    project.applications = [m.Resource(name="Application", global_variables=sections)]
    return sfc.loads(sfc.dumps(project, format="codesys"), format="codesys")


def test_tc6_names_the_variables_without_their_list() -> None:
    data, report = sfc.convert(listed(), "plcopen")
    assert [item.what for item in report.losses] == ["inputs of actions"]
    action = sfc.loads(data, as_tool=True).pou("Main").action("Act")
    assert action is not None
    assert action.body == m.StBody(text="n := n + y + z;")


def test_codesys23_names_the_variables_without_their_list_and_gives_it_back() -> None:
    """CoDeSys 2.3 has lists, with names that mean nothing in texts."""
    project = listed()
    chart = project.pou("Main").sfc
    assert chart is not None
    chart.step("S1").max_time = "GVL1.t"
    project.applications[0].global_variables[0].variables += [
        m.Variable.model_validate({"name": "t", "type": "TIME", "initial": {"kind": "simple", "text": "T#3s"}})
    ]
    data, report = sfc.convert(project, "codesys23")
    assert "global variables" in {item.what for item in report.with_outcome(Outcome.TRANSLATED)}
    text = sfc.convert(sfc.loads(data, as_tool=True), "codesys23")[0].decode()
    assert "GVL1." not in text
    assert "(* @SFCMAXTIME := 't' *)" in text
    back = sfc.loads(sfc.convert(sfc.loads(data), "codesys")[0])
    assert sfc.diff(project, back).changes == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("target", "flavour"), [("plcopen", ""), ("plcopen", "beremiz"), ("simaticml", ""), ("codesys23", "")]
)
def test_variables_of_lists_and_their_members_are_the_same_in_a_run(target: str, flavour: str) -> None:
    """TIA Portal has tags for addresses: the same word has another number there than in CODESYS."""
    text = PROGRAM.format(local="k", step="S1").replace("GVL1.y > 3", "job.count > 3 AND GVL1.w > 2")
    text = text.replace("n + GVL1.y + z", "n + 1")  # a tool that executes actions first sees other inputs in them
    members = [m.Variable.model_validate({"name": "count", "type": "INT"})]
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    project.data_types = [m.DataTypeDeclaration(name="JobType", type=m.StructType(members=members))]
    types = {"x": "BOOL", "y": "INT", "z": "INT", "job": m.DerivedType(name="JobType"), "w": "INT"}
    variables = [m.Variable.model_validate({"name": name, "type": kind}) for name, kind in types.items()]
    variables[-1].address = "%IW8"
    section = m.VariableSection(kind=m.SectionKind.GLOBAL, name="GVL1", variables=variables)
    project.applications = [m.Resource(name="Application", global_variables=[section])]
    report = sfc.save(project, io.BytesIO(), format=target, flavour=flavour, partial=True, limit=8)
    assert "chart" not in {item.what for item in report.losses}
    assert report.compared["POU Main"].startswith(("equal", "not all was reached")), report.compared


@pytest.mark.parametrize("target", ["plcopen", "codesys23"])
@pytest.mark.parametrize("source", [{"local": "y"}, {"step": "y"}, {"lists": ("GVL1", "GVL2")}])
def test_a_variable_that_another_name_hides_keeps_its_list_and_is_told(source: dict[str, object], target: str) -> None:
    data, report = sfc.convert(listed(**source), target, partial=True)  # type: ignore[arg-type]
    told = [item.path for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "text"]
    assert "POU Main / action Act" in told
    assert len(told) == 2
    action = sfc.loads(data, as_tool=True).pou("Main").action("Act")
    assert action is not None
    assert isinstance(action.body, m.StBody)
    assert "GVL1.y" in action.body.text


@pytest.mark.parametrize("target", ["plcopen", "iec-text"])
def test_variables_beside_an_application_are_read(target: str) -> None:
    data = sfc.convert(listed(), target, partial=True)[0].decode()
    if target == "plcopen":
        more = '<globalVars><variable name="extra"><type><INT/></type></variable></globalVars>'
        data = data.replace("</resource>", f"</resource>{more}")
    else:
        head = "CONFIGURATION Application\n"
        data = data.replace(head, f"{head}    VAR_GLOBAL\n        extra : INT;\n    END_VAR\n")
    project = sfc.loads(data.encode(), format=target)
    sections = [section for each in project.configurations for section in each.global_variables]
    assert [variable.name for section in sections for variable in section.variables] == ["extra"]
    assert sfc.dumps(project) == data.encode()


def test_declarations_in_scl_have_the_values_of_constants() -> None:
    text = """VAR_GLOBAL CONSTANT
    K1 : INT := 5;
END_VAR
FUNCTION_BLOCK Main
VAR n : INT := K1; a : ARRAY[0..K1] OF INT; s : STRING[K1]; c : ARRAY[1..2] OF INT := [K1, 3]; END_VAR
n := a[K1] + c[2];
END_FUNCTION_BLOCK
"""
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "scl")
    assert [item.outcome for item in report.items if item.path.endswith("K1")] == [Outcome.TRANSLATED]
    written = data.decode("utf-8-sig").partition("// {")[0]
    assert "K1" not in written
    assert "n : Int := 5;" in written
    assert "a : Array[0..5] of Int;" in written
    assert "s : String[5];" in written
    assert "c : Array[1..2] of Int := [5, 3];" in written


def test_expressions_of_constants_come_home_from_tia_portal_as_their_values() -> None:
    text = """VAR_GLOBAL CONSTANT
    K1 : INT := 5;
    K2 : INT := K1 * 2 + 1;
END_VAR
FUNCTION_BLOCK Main
VAR n : INT := K1 + 1; f : ARRAY[0..K2 - 1] OF INT; s : STRING[K1 * 4]; END_VAR
n := f[K1] + K2;
END_FUNCTION_BLOCK
"""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    data, report = sfc.convert(project, "simaticml")
    assert report.losses == []
    back, report = sfc.convert(sfc.loads(data), "codesys")
    assert report.losses == []
    home = sfc.loads(sfc.convert(sfc.loads(back), "iec-text")[0])
    found = {variable.name: variable for variable in home.pou("Main").variables()}
    assert found["n"].initial == m.SimpleValue(text="6")
    assert isinstance(found["f"].type, m.ArrayType)
    assert [(each.lower, each.upper) for each in found["f"].type.dimensions] == [("0", "10")]
    assert isinstance(found["s"].type, m.StringType)
    assert found["s"].type.length == "20"


@pytest.mark.parametrize("target", ["simaticml", "scl"])
def test_s7_names_the_data_block_of_a_variable_that_codesys_names_alone(target: str) -> None:
    project = sfc.loads(b"PROGRAM Main\nVAR k : INT; END_VAR\nk := y + z;\nEND_PROGRAM\n", format="iec-text")
    project.dialect = m.Dialect.CODESYS
    project.global_variables = listed().applications[0].global_variables
    data, report = sfc.convert(project, target, partial=True)
    assert [item for item in report.losses if item.what != "program"] == []
    body = sfc.loads(data, format=target).pou("Main").bodies[0]
    assert isinstance(body, m.StBody)
    assert body.text.strip() == '#k := "GVL1".y + "GVL1".z;'


def test_every_name_that_nothing_declares_is_told() -> None:
    _, report = sfc.convert(listed(), "iec-text", partial=True)
    told = [item.why for item in report.losses if item.what == "undeclared name"]
    assert told == ["the name `GVL1` is not declared in tools that read the text"]


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_a_name_in_several_lists_is_compared_list_by_list(target: str) -> None:
    """Machine.Stations is an array of a data block, STATIONS a constant."""
    project = sfc.load(Path(__file__).parents[2] / "fixtures" / "simaticml")
    _, report = sfc.convert(project, target, partial=True, at_rest=["all"])
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    assert not [item.path for item in report.losses if item.path.startswith("global variable")]


TESTED = """FUNCTION_BLOCK Main
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := GVL1.x; END_TRANSITION
STEP S1: q(N); END_STEP
TRANSITION FROM S1 TO S0 := NOT {other}; END_TRANSITION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("other", ["x", "GVL1.x", "GVL1.w"])
@pytest.mark.parametrize(("target", "flavour"), [("plcopen-2.01", ""), ("plcopen-2.01", "beremiz"), ("simaticml", "")])
def test_a_run_gives_variables_of_lists_the_same_values(other: str, target: str, flavour: str) -> None:
    """They were two inputs, `GVL1.x` and `x`, where one tool knows no lists: charts were called different."""
    project = sfc.loads(TESTED.format(other=other).encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    variables = [m.Variable.model_validate({"name": name, "type": "BOOL"}) for name in ("x", "w")]
    section = m.VariableSection(kind=m.SectionKind.GLOBAL, name="GVL1", variables=variables)
    project.applications = [m.Resource(name="Application", global_variables=[section])]
    source = sfc.loads(sfc.dumps(project, format="codesys"), format="codesys")
    report = sfc.convert(source, target, flavour=flavour, limit=10)[1]
    (verdict,) = report.compared.values()
    assert verdict.startswith("equal"), verdict
    assert "proof" in verdict


CONSTANTS = """
{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}
{plcopen_sfc name := 'GVL1'}
VAR_GLOBAL CONSTANT
  K1 : INT := 3;
  K2 : INT := K1 * 2 + 1;
END_VAR
FUNCTION_BLOCK Main
VAR_INPUT s : INT; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
VAR v : INT := GVL1.K2 + 1; row : ARRAY[0..GVL1.K1] OF INT; END_VAR
VAR name : STRING(GVL1.K1 + 4); text : STRING := 'GVL1.K1'; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := s > GVL1.K2; END_TRANSITION
STEP S1: q(N); END_STEP
TRANSITION FROM S1 TO S0 := s < v; END_TRANSITION
END_FUNCTION_BLOCK
"""


def test_declarations_in_tc6_name_constants_without_their_list() -> None:
    data, report = sfc.convert(sfc.loads(CONSTANTS.encode(), format="iec-text"), "plcopen-2.01", limit=8)
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []
    assert not any(verdict.startswith("different") for verdict in report.compared.values())
    variables = {each.name: each for each in sfc.loads(data, as_tool=True).pou("Main").variables()}
    assert variables["v"].initial == m.SimpleValue(text="K2 + 1")
    assert isinstance(variables["row"].type, m.ArrayType)
    assert variables["row"].type.dimensions[0].upper == "K1"
    assert variables["name"].type == m.StringType(length="K1 + 4")
    assert variables["text"].initial == m.SimpleValue(text="'GVL1.K1'")


def test_code_in_scl_has_the_values_of_constants(tmp_path: Path) -> None:
    text = CONSTANTS.replace("[0..GVL1.K1]", "[0..3]")
    target = tmp_path / "main.scl"
    lowered = lower_to_file(sfc.loads(text.encode(), format="iec-text"), str(target))
    assert lowered.report.with_outcome(Outcome.NOT_EXECUTED) == []
    assert "#s > 7" in target.read_text("utf-8-sig")


@pytest.mark.parametrize(
    ("one", "other", "is_same"),
    [
        ("x := G1.K;", "x := G2.K;", False),  # lists that have constants of one name
        ("x := G1.K;", "x := 1;", True),
        ("x := own;", "x := 5;", False),  # a variable that hides a constant
        ("x := G3.own;", "x := own;", False),
        ("x := G1.v;", "x := G2.v;", False),
    ],
)
def test_constants_are_told_apart_by_their_lists_and_where_a_variable_hides_them(
    one: str, other: str, is_same: bool
) -> None:
    def reading(body: str) -> m.Project:
        text = f"PROGRAM Main\nVAR x, own : INT; END_VAR\n{body}\nEND_PROGRAM\n"
        project = sfc.loads(text.encode(), format="iec-text")
        project.dialect = m.Dialect.CODESYS
        for name, constant, values in (
            ("G1", True, {"K": "1"}),
            ("G2", True, {"K": "2"}),
            ("G3", True, {"own": "5"}),
            ("G1", False, {"v": "0"}),
            ("G2", False, {"v": "0"}),
        ):
            variables = [m.Variable.model_validate({"name": n, "type": "INT", "initial": v}) for n, v in values.items()]
            section = m.VariableSection(kind=m.SectionKind.GLOBAL, name=name, constant=constant, variables=variables)
            project.global_variables.append(section)
        return project

    source = executed(reading(one))
    found = list(compare(source, executed(reading(other), compared_with=source)))
    assert ([difference.aspect for difference in found] == []) is is_same, found
