"""Code in files is proven as the tool sees it that the file is for, not as our readers restore it."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import Verdict, VerdictKind
from plcopen_sfc.documents.lowered import lower_to_file
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import LoweredPou, lower
from plcopen_sfc.lowering.other_bodies import with_actions_inside
from plcopen_sfc.lowering.written_code import prove_written, refuse_uncompiled
from plcopen_sfc.report import ConversionReport
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.charts import boolean, training_chain


def proved(project: m.Project, lowered: LoweredPou, target: str) -> Verdict:
    content = sfc.dumps(lowered.project, format=target, partial=True)
    seen = sfc.loads(content, format=target, as_tool=True)
    return prove_written(resolve(project, lowered.name), lowered, seen, lambda: sfc.loads(content, format=target))


def chain_in_actions(text: str) -> m.Project:
    """A chain of CODESYS whose second step calls an action."""
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.steps[1].main_action = "Blink"
    pou.actions = [
        m.Action(name="Blink", body=m.StBody(text=text)),
        m.Action(name="Toggle", body=m.StBody(text="Q4 := NOT Q4; // each scan")),
    ]
    assert pou.interface is not None
    pou.interface.sections[1].variables += [boolean("Q4"), boolean("Q5")]
    return m.Project(name="Plant", pous=[pou], dialect=m.Dialect.CODESYS)


def test_actions_that_stand_in_comments_are_no_code() -> None:
    project = chain_in_actions("IF NOT B5 THEN RETURN; END_IF\nQ5 := NOT Q5;")
    lowered = lower(project, "case", target="codesys", verify=False)
    assert proved(project, lowered, "codesys").kind is VerdictKind.PROVEN
    for target in ("scl", "simaticml"):
        lowered = lower(project, "case", target=target, verify=False)
        with pytest.raises(LoweringError, match=r"comments or extension data.*POU Ablauf / actions") as caught:
            proved(project, lowered, target)
        assert caught.value.location.path == "Ablauf"


NESTED = "Toggle();\nIF B5 THEN Toggle; END_IF; Toggle(); Q5 := Q4;"


@pytest.mark.parametrize("target", ["scl", "simaticml"])
@pytest.mark.parametrize("construction", ["case", "bits"])
def test_tia_portal_gets_the_statements_of_actions_instead_of_calls(target: str, construction: str) -> None:
    project = chain_in_actions(NESTED)
    lowered = lower(project, construction, target=target, verify=False)
    assert isinstance(lowered.pou.body, m.StBody)
    assert "Toggle;" not in lowered.pou.body.text.replace("()", "")
    assert lowered.pou.body.text.count("    // Toggle\n") == 3
    assert proved(project, lowered, target).kind is VerdictKind.PROVEN
    elsewhere = lower(project, construction, target="codesys", verify=False)
    assert isinstance(elsewhere.pou.body, m.StBody)
    assert elsewhere.pou.body.text.count("Toggle();") == 2


@pytest.mark.parametrize("call", ["Toggle();", "Toggle;", "Ablauf.Toggle();", "Ablauf.Toggle;", "THIS^.Toggle();"])
@pytest.mark.parametrize("target", ["scl", "simaticml"])
def test_actions_that_nothing_calls_any_more_are_no_reason_to_refuse(call: str, target: str, tmp_path: Path) -> None:
    """Dialects in which an action is called from anywhere keep it; TIA Portal compiles no call of one."""
    project = chain_in_actions(call)
    project.pous[0].kind = m.PouKind.FUNCTION_BLOCK if "THIS" in call else m.PouKind.PROGRAM
    made = sfc.lower_to_file(project, str(tmp_path / "chain"), "case", format=target, partial=True)
    assert not made.refused
    (pou,) = made.pous
    assert pou.proof is not None
    assert pou.proof.proven
    assert isinstance(pou.pou.body, m.StBody)
    assert "// Toggle\n" in pou.pou.body.text
    assert [item.why for item in made.report.items if "no actions and methods" in item.why] == []


def test_actions_that_call_themselves_stay_calls() -> None:
    pou = m.Pou(name="A", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.StBody(text="One(); Two();")])
    texts = {"One": "Two(); x := 1;", "Two": "IF x > 3 THEN One(); END_IF;"}
    pou.actions = [m.Action(name=name, body=m.StBody(text=text)) for name, text in texts.items()]
    body = with_actions_inside(pou, m.Dialect.CODESYS).bodies[0]
    assert isinstance(body, m.StBody)
    assert body.text.count("One();") == body.text.count("Two();") == 1


@pytest.mark.parametrize("style", ["exact", "classic"])
def test_what_only_we_read_proves_nothing(style: str) -> None:
    """The file says one thing, a comment of this package another: the chart is that of the comment."""
    project = m.Project(name="Plant", pous=[training_chain()])
    lowered = lower(project, "case", style=style, target="iec-text", verify=False)
    changed = lowered.project.model_copy(deep=True)
    body = changed.pous[0].body
    assert isinstance(body, m.StBody)
    body.text = body.text.replace("B3", "NOT B3")
    text = sfc.dumps(changed, format="iec-text").decode()
    meant = lowered.pou.body
    assert isinstance(meant, m.StBody)
    pragma = "{plcopen_sfc body.text := '" + meant.text.replace("\n", "$N") + "'}"
    whole = text.replace("FUNCTION_BLOCK Ablauf", f"{pragma}\nFUNCTION_BLOCK Ablauf")
    assert sfc.loads(whole.encode()).pous[0].body == meant
    seen = sfc.loads(whole.encode(), as_tool=True)
    with pytest.raises(LoweringError, match=r"comments or extension data.*POU Ablauf / text"):
        prove_written(resolve(project), lowered, seen, lambda: sfc.loads(whole.encode()))


def test_code_that_is_simply_wrong_is_told_as_such() -> None:
    project = m.Project(name="Plant", pous=[training_chain()])
    lowered = lower(project, "case", target="plcopen", verify=False)
    wrong = sfc.dumps(lowered.project, format="plcopen-2.01").replace(b"IF B3", b"IF NOT B3")
    with pytest.raises(LoweringError, match="read back, the code does not do what the chart does"):
        prove_written(resolve(project), lowered, sfc.loads(wrong, as_tool=True), lambda: sfc.loads(wrong))


TIMED_CHAIN = """FUNCTION_BLOCK Ablauf
VAR_INPUT B1 : BOOL; End1 : BOOL; END_VAR
VAR_OUTPUT Q1 : BOOL; n : INT; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: Q1(D, T#2s); Count(P); END_STEP
TRANSITION FROM S1 TO S2 := B1; END_TRANSITION
TRANSITION FROM S2 TO S1 := End1; END_TRANSITION
ACTION Count: n := n + 1; END_ACTION
END_FUNCTION_BLOCK"""


@pytest.mark.parametrize(
    ("construction", "language", "wrong", "why"),
    [
        ("case", "ST", {"INT": "BOOL"}, "a CASE asks for BOOL"),
        ("case", "ST", {"INT": "REAL"}, "a CASE asks for REAL"),
        ("bits", "ST", {"BOOL": "TIME"}, "BOOL is assigned to TIME: T1_2 := X1 AND B1;"),
        ("flipflop", "IL", {"BOOL": ""}, "nothing declares X1"),
        ("flipflop", "IL", {"BOOL": "INT"}, "BOOL is assigned to a number"),
        ("flipflop", "FBD", {"TON": "BOOL"}, "BOOL cannot be called"),
        ("flipflop", "LD", {"TON": "CTU"}, "CTU .*has no"),
        ("flipflop", "LD", {"BOOL": ""}, "declare"),
    ],
)
def test_wrong_types_and_missing_declarations_do_not_compile(
    construction: str, language: str, wrong: dict[str, str], why: str
) -> None:
    project = sfc.loads(TIMED_CHAIN.encode(), format="iec-text")
    target = "codesys" if language != "ST" or "INT" in wrong else "plcopen"
    lowered = lower(project, construction, language=language, target=target, verify=False)
    spoiled = lowered.project.model_copy(deep=True)
    given = {variable.name for variable in project.pous[0].variables()}
    interface = spoiled.pous[0].interface
    assert interface is not None
    for section in interface.sections:
        for variable in [each for each in section.variables if each.name not in given and not section.constant]:
            new = wrong.get(str(getattr(variable.type, "name", "")))
            if new is not None:
                section.variables.remove(variable)
            if new:
                kind = m.DerivedType(name=new) if new == "CTU" else m.ElementaryType(name=m.Elementary(new))
                section.variables.append(m.Variable(name=variable.name, type=kind))
    refuse_uncompiled(ConversionReport(), lowered.project, lowered)
    with pytest.raises(LoweringError, match=f"does not compile the code: .*{why}"):
        refuse_uncompiled(ConversionReport(), spoiled, lowered)


def test_labels_have_no_name_of_a_variable() -> None:
    project = sfc.loads(TIMED_CHAIN.encode(), format="iec-text")
    body = lower(project, "flipflop", language="IL", verify=False).pou.body
    assert isinstance(body, m.IlBody)
    assert "End2:" in body.text
    assert "End1:" not in body.text


def test_a_chart_of_an_action_is_checked_where_the_target_has_actions(tmp_path: Path) -> None:
    project = chain_in_actions("Q5 := B1;")
    project.pous[0].actions[0].body = m.SfcBody(chart=training_chain().sfc)
    for target in ("codesys", "scl"):
        file = str(tmp_path / f"chain.{target}")
        made = sfc.lower_to_file(project, file, format=target, pou="Ablauf.Blink", verify=False, partial=True)
        assert [each.name for each in made.pous] == ["Ablauf.Blink"]


GERMAN = """PROGRAM Maßstab
VAR_INPUT drück, stop : BOOL; END_VAR
VAR_OUTPUT Rührer : BOOL; n : INT; END_VAR
INITIAL_STEP Grundstellung: END_STEP
TRANSITION FROM Grundstellung TO Füllen := drück; END_TRANSITION
STEP Füllen: Rührer(N); Zählen(P1); END_STEP
TRANSITION FROM Füllen TO Grundstellung := stop; END_TRANSITION
ACTION Zählen: n := (n + 1) MOD 3; END_ACTION
END_PROGRAM
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("asked", "of_s7", "target"),
    [
        ({}, False, "codesys"),
        ({"states": "enumeration"}, False, "plcopen"),
        ({"construction": "flipflop"}, False, "beremiz"),
        ({}, True, "codesys23"),
        ({}, True, "beremiz"),
        ({"construction": "flipflop", "language": "ST"}, True, "codesys"),
    ],
)
def test_code_is_proven_under_the_names_that_the_target_takes(
    asked: dict[str, str], of_s7: bool, target: str, tmp_path: Path
) -> None:
    project = sfc.loads(GERMAN.encode(), format="iec-text")
    if of_s7:
        project = sfc.loads(sfc.dumps(project, format="simaticml"), as_tool=True)
    file = str(tmp_path / "plant")
    form = {"format": "plcopen", "flavour": "beremiz"} if target == "beremiz" else {"format": target}
    made = sfc.lower_to_file(project, file, pou="Maßstab", at_rest="all", **form, **asked)
    assert not made.refused
    assert made.pous[0].proof is not None
    assert made.pous[0].proof.proven


ADDING = """FUNCTION_BLOCK Ov
VAR_INPUT a : BOOL; n : INT; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
STEP S2: Work(N); END_STEP
TRANSITION FROM S2 TO S1 := NOT a; END_TRANSITION
ACTION Work: q := {sum} > 3; END_ACTION
END_FUNCTION_BLOCK"""


@pytest.mark.parametrize("target", ["codesys", "codesys23"])
def test_code_that_another_tool_calculates_otherwise_is_refused_with_the_cause(target: str, tmp_path: Path) -> None:
    file = str(tmp_path / "adding")
    project = sfc.loads(ADDING.format(sum="n + 1").encode(), format="iec-text")
    (error,) = sfc.lower_to_file(project, file, format=target).refused.values()
    assert "read back, the code does not do what the chart does" in str(error)
    assert "calculates with 32 bits" in error.hint
    assert not Path(file).exists()
    # and what the hint says to do helps
    mended = sfc.loads(ADDING.format(sum="INT_TO_DINT(n) + 1").encode(), format="iec-text")
    (made,) = sfc.lower_to_file(mended, file, format=target).pous
    assert made.proof is not None
    assert made.proof.equal


ADDRESSED = """{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}
{plcopen_sfc name := 'GVL_IO'}
VAR_GLOBAL
    raw AT %IW2 : INT;
    wide AT %ID4 : DINT;
    go AT %IX0.0 : BOOL;
END_VAR
PROGRAM Main
VAR
    q : BOOL;
END_VAR
INITIAL_STEP One: END_STEP
TRANSITION FROM One TO Two := GVL_IO.raw > 500; END_TRANSITION
STEP Two: q(N); END_STEP
TRANSITION FROM Two TO One := GVL_IO.go OR GVL_IO.wide < 0; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.parametrize("target", ["simaticml", "codesys", "twincat"])
def test_words_at_addresses_are_the_same_inputs_however_the_tool_numbers_them(target: str, tmp_path: Path) -> None:
    """%IW2 of CODESYS is the tag raw at %IW4 in TIA Portal and %IW4 in TwinCAT."""
    project = sfc.loads(sfc.dumps(sfc.loads(ADDRESSED.encode(), format="iec-text"), format="codesys"))
    place = tmp_path / "code.xml" if target == "codesys" else f"{tmp_path}/code/"
    made = lower_to_file(project, place, "case", format=target)
    assert [each.proof.kind for each in made.pous if each.proof is not None] == [VerdictKind.PROVEN]
