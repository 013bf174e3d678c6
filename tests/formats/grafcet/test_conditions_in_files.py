"""Every form in which people write conditions, in every file in which a GRAFCET can be."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import LossError, ModelError
from plcopen_sfc.model import Expression, Project

FORMS = [
    *(
        "1B1 * 2B1 * START",
        "a . b",
        "a · b",
        "a ∙ b • START",
        "a + b",
        "/a",
        "a̅",
        "!a",
        "¬a",
        "↑a",
        "↓a",
        "[C1>3]",
        "1",
        "3s/X1",
        "X2/5s",
    ),
    *(
        "2s/a/3s",
        "3s//a/2s",
        "a * 3s//START",
        "1̅B̅1̅ * a",
        "↑1B1 + ↓START",
        "a AND NOT (b OR 1B1)",
        "/(a · b) + [C1≥2] * START",
        "TRUE",
        "=1",
    ),
    "a ∧ b ∨ a",
]
WRONG = ["1B1 a", "a *", "3s", "[C1>]", "a(", "2"]
HEAD = "GRAFCET Plan\nINPUTS\n    a\n    b\n    1B1\n    2B1\n    START\nINTERNALS\n    C1 : INT\n"
CHART = """CHART G{0}
    INITIAL STEP {0}
    {0} -> {1} : START * ↑b
    STEP {1}
        {2}
    {1} -> {0} : {3}
"""
FILES = ["grafcet-text", "grafcet", "json", "iec-text"]


@cache
def plan(*conditions: str) -> Project:
    counting = "ON ACTIVATION C1 := C1 + 1"
    charts = [
        CHART.format(n, n + 1, "" if n > 1 else counting, each)
        for n, each in zip(range(1, 99, 2), conditions, strict=False)
    ]
    return sfc.loads((HEAD + "".join(charts)).encode())


def written(project: Project, form: str) -> Project:
    """Return a plan as it is read from a file; textual IEC 61131-3 keeps one that was made in Python, in pragmas."""
    made = project.model_copy(deep=True)
    made.source = None
    data, report = sfc.convert(made, form, partial=True)
    lost = {item.what for item in report.losses if item.outcome != "dropped"}
    assert form == "iec-text" or lost <= {"time"}  # terms of .grafcet files have none
    return sfc.loads(data)


def texts_of(project: Project) -> list[str]:
    chart = project.pous[0].chart
    assert chart is not None
    conditions = [partial.chart.transitions[1].condition for partial in chart.partial_charts]
    return [each.text for each in conditions if isinstance(each, Expression)]


@pytest.mark.slow
@pytest.mark.parametrize("form", FILES)
def test_conditions_mean_the_same_in_every_file(form: str) -> None:
    again = written(plan(*FORMS), form)
    assert not sfc.check(again, profile="grafcet", select=["CND09", "CND08", "VAR01"])
    if form != "grafcet":
        assert texts_of(again) == FORMS
        return
    # its terms are trees
    verdict = sfc.equivalent(plan(*FORMS), again, "grafcet", delay="auto", cap=5, runs=1, scans=40)
    assert verdict.counterexample is None, verdict


@pytest.mark.parametrize("form", ["grafcet-text", "json", "iec-text"])
def test_conditions_that_cannot_be_read_are_told_in_every_file(form: str) -> None:
    again = written(plan(*WRONG), form)
    assert texts_of(again) == WRONG
    found = sfc.check(again, profile="grafcet", select=["CND09"])
    assert [finding.code for finding in found] == ["CND09"] * len(WRONG)


@pytest.mark.parametrize("form", ["json", "iec-text"])
def test_a_dot_between_bools_is_told_where_it_is_that_of_a_member(form: str) -> None:
    """`grafcet-text` reads it as AND; in other files it was a member that nothing has, and no rule told it."""
    again = written(plan("a * b", "X1 * 1B1 * a", "C1 * b"), form)
    chart = again.pous[0].chart
    assert chart is not None
    for partial, text in zip(chart.partial_charts, ("a.b", "X1.1B1 + a", "C1.b"), strict=True):
        partial.chart.transitions[1].condition = Expression(text=text)
    found = sfc.check(again, profile="grafcet", select=["CND09"])
    assert [finding.message for finding in found] == [
        f"a dot in '{text}' is that of a member, and a BOOL and a flag have none" for text in ("a.b", "X1.1B1 + a")
    ]


@pytest.mark.parametrize("text", ["a.b", "/X1.a + b", "START * X2.1B1"])
def test_no_tool_gets_a_member_of_a_bool(text: str) -> None:
    """Terms of ``.grafcet`` files have no dots, but an edit may put one into a condition."""
    project = written(plan("a * b"), "grafcet")
    chart = project.pous[0].chart
    assert chart is not None
    chart.partial_charts[0].chart.transitions[1].condition = Expression(text=text)
    for form in ("codesys", "plcopen", "simaticml", "iec-text"):
        with pytest.raises(LossError, match=r"is a BOOL: it has no \w+; AND is written"):
            sfc.convert(project, form)


@pytest.mark.parametrize("form", ["codesys", "plcopen", "simaticml", "iec-text"])
@pytest.mark.parametrize("name", ["a.b", "a-b", "a b"])
def test_a_declared_name_that_a_condition_reads_as_more_is_refused(form: str, name: str) -> None:
    """Files of AGRAFE may declare it. The tool had a variable `a_b`, and a condition on the member `b` of an `a`."""
    content = sfc.dumps(plan("/START"), format="grafcet").decode()
    project = sfc.loads(content.replace('"START"', f'"{name}"').encode())
    with pytest.raises(LossError) as caught:
        sfc.convert(project, form)
    assert f"a condition does not read {name!r} as one name" in {item.why for item in caught.value.report.losses}


@pytest.mark.parametrize(
    "condition",
    ["START . {}", "START .{}", "START. {}", "{} . START", "X2 . {} . a", "a . {} + /START", "(START . /{})"],
)
def test_a_dot_between_blanks_is_no_path_to_a_member(condition: str) -> None:
    """The second name was a member of the first: it kept its name in a rename, and in a tool that has no `1B1`."""
    head = "GRAFCET P\nINPUTS\n    START\n    1B1\n    a\nCHART G1\n    INITIAL STEP 1\n    STEP 2\n    2 -> 1 : /a\n"
    project = sfc.loads(f"{head}    1 -> 2 : {condition.format('1B1')}\n".encode())
    data, report = sfc.convert(project, "codesys")
    assert "undeclared name" not in {item.what for item in report.losses}
    assert b"_1B1" in data.partition(b"<condition>")[2]
    project.rename("P.1B1", "Hinten")
    assert condition.format("Hinten") in sfc.dumps(project, format="grafcet-text").decode()


def test_a_dot_between_bools_and_flags_is_and_in_text_with_tables() -> None:
    """Other names with a dot are members, and the file keeps its dots."""
    text = """GRAFCET G
INPUTS
    a
    1B1
INTERNALS
    T1 : TON
INITIAL STEP 1
    Q IF X1.1B1
1 -> 2 : a.1B1./X2 + a̅.1B1
STEP 2
    ON EVENT ↑X1.a : R := TRUE
2 -> 1 : T1.Q * c.a
"""
    project = sfc.loads(text.encode())
    assert sfc.dumps(project) == text.encode()
    chart = project.pous[0].chart
    assert chart is not None
    holders = [*(t.condition for t in chart.transitions), *(a.condition for _, a in chart.associations())]
    found = [each.text for each in holders if isinstance(each, Expression)]
    assert found == ["a . 1B1./X2 + a̅ . 1B1", "T1.Q * c.a", "X1 . 1B1", "↑X1 . a"]
    project.rename("G.a", "b")
    renamed = text.replace("    a\n", "    b\n").replace("X1.a", "X1.b")
    assert sfc.dumps(project).decode() == renamed.replace("a.1B1./X2 + a̅.1B1", "b.1B1./X2 + b̅.1B1")


def test_flags_follow_the_numbers_of_their_steps() -> None:
    text = """GRAFCET G
INPUTS
    a
INTERNALS
    X3
CHART G1
    INITIAL STEP 1
        Q IF X̅2̅ . X3
    1 -> 2 : a . /X2
    STEP 2
    2 -> 1 : 3s/X2 + X2/5s . X̅2̅
CHART G2
    INITIAL STEP 10
        FORCE G1{2}
    10 -> 10 : X2
"""
    project = sfc.loads(text.encode())
    result = project.rename("G.2", "12")
    assert result.undecided == ()
    expected = text.replace("X2", "X12").replace("X̅2̅", "X̅1̅2̅").replace("1 -> 2 ", "1 -> 12 ")
    expected = expected.replace("STEP 2", "STEP 12").replace("2 -> 1 :", "12 -> 1 :").replace("G1{2}", "G1{12}")
    assert sfc.dumps(project).decode() == expected
    with pytest.raises(ModelError, match="another way"):
        project.rename("G.12", "3")


@pytest.mark.parametrize("form", FILES)
def test_a_variable_that_only_overlined_names_name_is_renamed_in_them(form: str) -> None:
    again = written(plan("a + S̅T̅A̅R̅T̅"), form)
    again.rename(f"{again.pous[0].name}.START", "Go")
    assert not sfc.check(sfc.loads(sfc.dumps(again)), profile="grafcet", select=["VAR01"])
    assert texts_of(again) == ["a + G̅o̅"]


def test_a_variable_that_only_overlined_names_name_has_its_name_of_the_tool_in_them() -> None:
    source = sfc.loads(b"GRAFCET T\nINPUTS\n    1B1\nINITIAL STEP 1\n1 -> 2 : 1\xcc\x85B\xcc\x851\xcc\x85\nSTEP 2")
    data, report = sfc.convert(source, "plcopen")
    assert b"<xhtml:p>NOT _1B1</xhtml:p>" in data
    assert not [item for item in report.items if item.what == "undeclared name"]


@pytest.mark.parametrize("form", FILES[:3])
def test_the_overlined_flag_of_a_step_is_declared_in_the_file(form: str) -> None:
    data, report = sfc.convert(plan("a * X̅1̅"), form)
    assert not report.losses
    assert not sfc.check(sfc.loads(data, format=form), profile="grafcet", select=["VAR01", "CND09"])


def test_steps_get_numbers_as_names_in_a_grafcet_only() -> None:
    project = sfc.loads(
        b"PROGRAM P\nINITIAL_STEP S1: END_STEP\nTRANSITION FROM S1 TO S1 := TRUE; END_TRANSITION\nEND_PROGRAM\n"
    )
    with pytest.raises(ModelError, match="digit"):
        project.rename("P.S1", "12")


PLAIN = "GRAFCET N\nINPUTS\n    a\n    b\n    n : INT\nINITIAL STEP 1\n1 -> 2 : {}\nSTEP 2\n2 -> 1 : ↓a\n"


@pytest.mark.parametrize(
    "condition",
    [
        "n<5 + b",
        "[n + a > 3]",
        "1E5 * a",
        "1_1 * a",
        "X1.X * a",
        "[X1.T > T#3s]",
        "a // c",
        "a (* c *)",
        "a/b",
        "[n==0]",
        "1m30s/a",
    ],
)
def test_a_condition_that_check_refuses_is_refused_by_all(condition: str, tmp_path: Path) -> None:
    """Some were run and lowered as structured text, or written, since neither side could be run."""
    (tmp_path / "n.gct").write_text(PLAIN.format(condition), encoding="utf-8")
    project = sfc.load(tmp_path / "n.gct")
    found = sfc.check(project, select=["CND"])
    assert [each.location.line for each in found if each.severity is sfc.Severity.ERROR] == [7]
    with pytest.raises(sfc.SfcError) as caught:
        sfc.simulate(project, scans=2)
    assert "transition 1 -> 2" in str(caught.value)
    with pytest.raises(sfc.SfcError) as caught:
        sfc.save(sfc.lower(project), tmp_path / "n.st", format="iec-text")
    assert "is equal" not in str(caught.value)
    with pytest.raises(sfc.SfcError):
        sfc.save(project, tmp_path / "n.xml", format="plcopen")
    assert [each.name for each in tmp_path.iterdir()] == ["n.gct"]
