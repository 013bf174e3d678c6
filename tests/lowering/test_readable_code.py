"""Lowered code as people read it: nothing that is decided elsewhere, no chain of IFs, no helper that equals another."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import equivalent
from plcopen_sfc.documents.lowered import lower_to_file
from plcopen_sfc.languages.st import parse_statements, print_node
from plcopen_sfc.languages.st.nodes import Name, Statement
from plcopen_sfc.lowering.code.boolean_logic import one_of_values, with_distinct
from plcopen_sfc.lowering.code.code_bodies import wrapped

FIXTURES = Path(__file__).parents[2] / "fixtures"
RING = """PROGRAM Main
VAR_INPUT a : BOOL; b : BOOL; END_VAR
VAR_OUTPUT {outputs} END_VAR
INITIAL_STEP S1: {first} END_STEP
STEP S2: {second} END_STEP
STEP S3: {third} END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S3 := b; END_TRANSITION
TRANSITION FROM S3 TO S1 := a AND b; END_TRANSITION
{actions}
END_PROGRAM"""


def lowered(construction: str = "case", profile: str = "iec", **parts: str) -> str:
    defaults = {"outputs": "q : BOOL; p : BOOL; n : INT;", "first": "", "second": "", "third": "", "actions": ""}
    text = RING.format(**{**defaults, **parts})
    made = sfc.lower(sfc.loads(text.encode(), format="iec-text"), construction, profile=profile)
    assert made.proof is not None
    assert made.proof.proven, str(made.proof)
    assert isinstance(made.pou.body, m.StBody)
    return made.pou.body.text


def without(text: str) -> str:
    """The statement without comparisons of s with A, B and C that others decide."""
    (statement,) = parse_statements(text, m.Dialect.IEC).tree.statements
    found: Statement = with_distinct(statement, one_of_values({Name(each) for each in "ABC"}))
    return print_node(found)


def test_comparisons_that_another_one_decides_are_left_out() -> None:
    assert without("q := s = A AND s <> B;") == "q := s = A;"
    assert without("q := s = A AND x AND NOT (s = B OR s = C);") == "q := s = A AND x;"
    assert without("q := s = A AND NOT (s = B OR y);") == "q := s = A AND NOT y;"
    assert without("q := s = A AND s = B OR x;") == "q := x;"
    assert without("q := s = A AND s <> A;") == "q := FALSE;"


def test_what_one_of_several_values_excludes_is_left_out() -> None:
    assert without("q := (s = A OR s = B) AND s <> C;") == "q := s = A OR s = B;"
    assert without("q := (s = A OR s = B) AND s <> A;") == "q := (s = A OR s = B) AND s <> A;"
    assert without("q := (s = A OR s = B) AND s = C;") == "q := FALSE;"
    assert without("q := (s = A OR t = B) AND s <> C;") == "q := (s = A OR t = B) AND s <> C;"
    assert without("q := (s = A OR s = B) AND s <> C OR y;") == "q := s = A OR s = B OR y;"


def test_comparisons_of_others_stay() -> None:
    for text in ("q := s = A AND t <> B;", "q := s = A OR s = B;", "q := s = D AND s <> B;", "q := s <> A AND s <> B;"):
        assert without(text) == text


def test_an_output_of_matiec_is_one_if() -> None:
    text = lowered(profile="matiec", first="q(R);", second="q(S);", third="p(N);")
    expected = "IF step_number = 2 THEN", "q := TRUE;", "ELSIF step_number = 1 THEN", "q := FALSE;", "END_IF;"
    assert [line.strip() for line in text.split("// Action q\n")[1].splitlines()[:5]] == list(expected)


def test_step_bits_are_one_line_for_each_step() -> None:
    text = lowered("bits", second="q;")
    assert "\n".join(text.split("\n\n")[1].splitlines()) == (
        "// Steps that become active\n"
        "X1 := T3_1 OR X1 AND NOT T1_2;\n"
        "X2 := T1_2 OR X2 AND NOT T2_3;\n"
        "X3 := T2_3 OR X3 AND NOT T3_1;"
    )


@pytest.mark.slow
def test_only_actions_that_see_each_other_are_decided_on_before_all() -> None:
    """`Count` sees p, which another action writes; q has nothing to do with them."""
    count = "ACTION Count: IF p THEN n := n + 1; END_IF; END_ACTION"
    text = lowered("case", "codesys", first="q(N);", second="p(N);", third="Count(N); p(N);", actions=count)
    assert "q := FALSE;" in text.partition("CASE")[0]
    assert "q := TRUE;" in text.partition("CASE")[2]


def test_a_state_that_nothing_reads_is_not_kept() -> None:
    text = RING.format(outputs="q : BOOL;", first="", second="q(S);", third="q(R);", actions="")
    project = sfc.loads(text.encode(), format="iec-text")
    made = sfc.lower(project, profile="matiec", target="iec-text", verify=False)
    assert [v.name for v in made.pou.variables() if v.name not in ("a", "b", "q")] == ["active_step"]


def test_all_inactive_inputs_of_a_chart_without_such_inputs_are_none() -> None:
    text = RING.format(outputs="q : BOOL;", first="", second="q;", third="", actions="")
    project = sfc.loads(text.encode(), format="iec-text")
    assert sfc.lower(project, at_rest="all", verify=False).at_rest == {}


def written(tmp_path: Path, format: str, **options: str) -> str:
    text = RING.format(outputs="q : BOOL;", first="", second="q;", third="", actions="")
    (tmp_path / "ring.st").write_text(text, encoding="utf-8")
    target = tmp_path / "out"
    lower_to_file(sfc.load(tmp_path / "ring.st"), str(target), format=format, **options)  # type: ignore[arg-type]
    return target.read_text(encoding="utf-8-sig")


HEADER = (
    "// Chart Main of ring.st, as code by plcopen-sfc",
    "// Compared with the chart under the profile iec: equal, proven in",
    "// Reached: 3 of 3 steps, 3 of 3 transitions, 1 of 1 actions.",
)


def test_a_file_tells_what_its_code_was_made_of_and_what_is_proven(tmp_path: Path) -> None:
    for format in ("scl", "codesys"):
        text = written(tmp_path, format)
        assert [line in text for line in HEADER] == [True, True, True], format
    text = written(tmp_path, "iec-text")
    assert [line.replace("//", "(*") in text for line in HEADER] == [True, True, True]
    assert "//" not in text


def test_a_file_tells_it_in_german_and_where_nothing_is_proven(tmp_path: Path) -> None:
    assert "// Erreicht: 3 von 3 Schritten, 3 von 3 Transitionen, 1 von 1 Aktionen." in written(
        tmp_path, "scl", lang="de"
    )
    text = RING.format(outputs="q : BOOL;", first="", second="q;", third="", actions="")
    lower_to_file(sfc.loads(text.encode()), str(tmp_path / "other"), format="scl", verify=False)
    assert "// Not compared with the chart." in (tmp_path / "other").read_text(encoding="utf-8-sig")


@pytest.mark.slow
def test_the_code_of_a_file_with_its_header_is_proven_as_it_is_read(tmp_path: Path) -> None:
    for format in ("scl", "codesys", "plcopen-2.01", "iec-text", "simaticml"):
        written(tmp_path, format)
        again = sfc.load(tmp_path / "out", as_tool=True)
        found = equivalent(sfc.load(tmp_path / "ring.st"), again, "iec")
        assert found.proven, f"{format}: {found}"


def test_textbook_code_in_a_file_is_that_of_the_textbook(tmp_path: Path) -> None:
    assert "plcopen-sfc" not in written(tmp_path, "scl", style="classic")


def test_steps_are_regions_in_tia_portal(tmp_path: Path) -> None:
    assert [line.strip() for line in written(tmp_path, "scl").splitlines() if line.strip().startswith("REGION ")] == [
        "REGION Step sequence",
        "REGION Step 1 – initial step",
        "REGION Step 2",
        "REGION Step 3",
    ]
    assert "region" not in written(tmp_path, "codesys").lower()


def test_flags_of_steps_of_which_one_is_active_exclude_each_other() -> None:
    chart = """FUNCTION_BLOCK F VAR_INPUT go, back : BOOL; END_VAR VAR_OUTPUT q, r : BOOL; END_VAR
    INITIAL_STEP A: q(R); END_STEP
    STEP B: q(N); r(N); END_STEP
    STEP C: r(R); END_STEP
    TRANSITION FROM A TO %s := go; END_TRANSITION
    TRANSITION FROM %s TO A := back; END_TRANSITION
    END_FUNCTION_BLOCK"""
    for targets, expected in (("B", "q := X_B;"), ("(B, C)", "r := X_B AND NOT X_C;")):
        made = sfc.lower(sfc.loads((chart % (targets, targets)).encode(), format="iec-text"), "bits", profile="iec")
        assert made.proof is not None
        assert made.proof.proven, str(made.proof)
        assert expected in made.pou.body.text  # type: ignore[union-attr]


BESIDE_A_CALL = """FUNCTION_BLOCK Horn
VAR_INPUT Run : BOOL; END_VAR
VAR_OUTPUT On : BOOL; END_VAR
On := Run;
END_FUNCTION_BLOCK
PROGRAM Main
VAR_INPUT a : BOOL; b : BOOL; END_VAR
VAR_OUTPUT q : BOOL; p : BOOL; END_VAR
VAR h : Horn; END_VAR
INITIAL_STEP S1: Sound(N); END_STEP
STEP S2: q(N); p(L, T#2s); END_STEP
STEP S3: h.Run(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S3 := b; END_TRANSITION
TRANSITION FROM S3 TO S1 := a AND b; END_TRANSITION
ACTION Sound: h(); END_ACTION
END_PROGRAM"""


def test_outputs_are_one_line_beside_a_call_that_cannot_touch_them() -> None:
    """The block that Sound calls sees neither q nor p, which only actions write; its own input it does see."""
    made = sfc.lower(sfc.loads(BESIDE_A_CALL.encode(), format="iec-text"), "case", profile="iec")
    assert made.proof is not None
    assert made.proof.proven, str(made.proof)
    assert isinstance(made.pou.body, m.StBody)
    text = made.pou.body.text
    assert "q := step_number = 2;" in text
    assert "p := step_number = 2 AND NOT p_L.Q;" in text
    assert "// Actions that have ended\nIF step_number <> 3 THEN\n    h.Run := FALSE;" in text


def test_a_method_may_write_all_of_its_instance() -> None:
    """Motor.ACT_TurnRight may write Motor.bRight, so both are decided on before one is executed."""
    project = sfc.load(FIXTURES / "twincat/press_station.xml")
    made = sfc.lower(project, "bits", pou="MAIN", verify=False)
    assert isinstance(made.pou.body, m.StBody)
    ended = made.pou.body.text.partition("// Actions that have ended")[2].partition("\n\n")[0]
    assert "Motor.ACT_TurnRight();" in ended
    assert "Motor.bRight := FALSE;" in ended


def test_what_is_short_and_stays_the_same_has_no_helper() -> None:
    project = sfc.load(FIXTURES / "codesys-export/mixer.export")
    made = sfc.lower(project, "case", pou="Mischer", verify=False)
    assert isinstance(made.pou.body, m.StBody)
    text = made.pou.body.text
    assert "IF Pumpe_Q AND (step_number <> STEP_Pumpen OR Pumpe_L.Q) THEN" in text
    assert "Pumpe_before" not in {variable.name for variable in made.pou.variables()}
    # the end of the scan of SFCInit is in the IF that ends all else
    assert "    last_step_number := NO_STEP;\n    RETURN;\nEND_IF;" in text


def test_a_time_is_restarted_only_where_the_step_may_have_changed() -> None:
    long = "TRANSITION FROM S2 TO S1 := S2.T > T#5s; END_TRANSITION"
    text = lowered(second="q(D, T#2s);", third="p(L, T#3s);", actions=long)
    assert text.startswith("// Step times\nstep_time(IN := TRUE, PT := T#24d);\n\n// Step sequence")
    assert text.count("step_time(IN := FALSE, PT := T#24d);") == 1
    assert "p := step_number = 3 AND step_time.ET < T#3s;" in text


def test_a_time_that_only_actions_read_is_called_behind_the_transitions_only() -> None:
    text = lowered(second="q(D, T#2s);", third="p(L, T#3s);")
    assert text.startswith("// Step sequence")
    assert text.count("step_time(IN := TRUE, PT := T#24d);") == 1


@pytest.mark.slow
def test_actions_of_single_steps_are_one_case_behind_the_transitions() -> None:
    """An action of two steps between them stays where it is, and so does what comes behind it."""
    bodies = ["ACTION One: n := n + 1; END_ACTION", "ACTION Two: n := n + 2; // twice\nEND_ACTION"]
    bodies += ["ACTION Both: n := n * 2; END_ACTION", "ACTION Once: n := 0; END_ACTION"]
    text = lowered(first="One(N);", second="Two(N); Both(N);", third="Once(P1); Both(N);", actions="\n".join(bodies))
    assert "CASE step_number OF\n    1: // Step 1 – initial step\n        // Action One\n        n := n + 1;" in text
    assert "\n    2: // Step 2\n        // Action Two\n        n := n + 2; // twice\nEND_CASE;" in text
    assert "IF step_number = 2 OR step_number = 3 THEN" in text
    assert text.count("CASE step_number OF") == 2
    apart = lowered(first="One(N);", second="Both(N);", third="Once(P1);", actions="\n".join(bodies))
    assert apart.count("IF step_number") == 1
    assert "    3: // Step 3\n        // Action Once\n        IF step_number <> last_step_number THEN" in apart


def test_a_branch_does_not_ask_for_its_own_step() -> None:
    project = sfc.load(FIXTURES / "codesys23/distribution_belt.EXP")
    made = sfc.lower(project, "case", pou="Ablauf", verify=False)
    assert isinstance(made.pou.body, m.StBody)
    branch = made.pou.body.text.partition("STEP_Warten: (* Step Warten *)\n")[2].partition("\n\n")[0]
    assert branch.splitlines()[:2] == ["        Band_Rechts := FALSE;", "        Wartezeit(IN := TRUE, PT := t#3s);"]


def test_conditions_that_never_change_are_no_branches() -> None:
    """A transition that never fires has no branch; what comes behind one that always does has none either."""
    text = RING.format(outputs="q : BOOL;", first="", second="q;", third="", actions="")
    text = text.replace("S1 TO S2 := a;", "S1 TO S2 := FALSE;").replace("S2 TO S3 := b;", "S2 TO S3 := TRUE;")
    more = "TRANSITION FROM S1 TO S3 := a AND NOT S2.X; END_TRANSITION TRANSITION FROM S2 TO S1 := b; END_TRANSITION"
    project = sfc.loads(text.replace("END_PROGRAM", f"{more}\nEND_PROGRAM").encode(), format="iec-text")
    made = sfc.lower(project, "case", profile="iec")
    assert made.proof is not None
    assert made.proof.proven
    assert isinstance(made.pou.body, m.StBody)
    first, second = made.pou.body.text.split("// Step 1 – initial step\n")[1].split("    2: // Step 2\n")
    assert first.split() == "IF a THEN step_number := 3; END_IF;".split()
    assert second.partition("    3:")[0].split() == ["step_number", ":=", "3;"]


def test_long_lines_are_broken_before_or_and_and() -> None:
    """Neither inside of a text nor of parentheses, where it can be outside."""
    names = [f"SomeLongInputName_{i}" for i in range(9)]
    condition = " OR ".join(f"({a} AND {b})" for a, b in pairwise(names))
    text = RING.format(outputs="q : BOOL;", first="", second="q;", third="", actions="")
    text = text.replace(":= a;", f":= {condition};")
    for form, start in (("case", "IF (SomeLong"), ("bits", "T1_2 := X1")):
        made = sfc.lower(sfc.loads(text.encode(), format="iec-text"), form, verify=False)
        assert isinstance(made.pou.body, m.StBody)
        lines = made.pou.body.text.splitlines()
        assert max(map(len, lines)) <= 120
        (first,) = (place for place, line in enumerate(lines) if line.strip().startswith(start))
        assert lines[first + 1].strip().startswith(("OR ", "AND "))
    quoted = "'Inputs.Place1 OR a very long text with AND (and more)');"
    call = f"ErrorAnalyzation := CONCAT(CONCAT(ErrorAnalyzation, SEL(a, 'b OR c', '')), {quoted}"
    assert wrapped(call, "    ").splitlines()[1].strip() == quoted
    # an ELSIF has its indentation in front of it: it counts as room, whatever the length is
    for length in range(60, 140):
        line = f"        ELSIF {'a' * 30} AND {'b' * (length - 48)} AND {'c' * 60}"
        assert " ".join(wrapped(line, "        ", deeper="        ", ends=5).split()) == line.strip()


def test_a_restart_is_one_paragraph_and_variables_of_a_chart_in_an_action_have_its_name() -> None:
    press = sfc.lower(sfc.load(FIXTURES / "twincat" / "press_station.xml"), pou="FB_Press", verify=False)
    assert isinstance(press.pou.body, m.StBody)
    assert press.pou.body.text.count("IF SFCInit THEN") == 1
    names = {variable.name for variable in press.pou.variables()}
    assert names >= {"step_number", "step_number_ACT_Home", "step_number_ACT_Jog"}


def test_reasons_of_an_error_are_put_together_with_one_call_each() -> None:
    belt = sfc.lower(sfc.load(FIXTURES / "codesys" / "distribution_belt.xml"), pou="Ablauf_Band", verify=False)
    assert isinstance(belt.pou.body, m.StBody)
    text = belt.pou.body.text
    assert "SFCErrorAnalyzation := CONCAT(SFCErrorAnalyzation, '|iAnzahl = 0');" in text
    assert "SEL(" not in text
    # the maximum time is watched in the branch of its step
    branch = text.partition("STEP_Zu_Platz3: // Step Zu_Platz3\n")[2].partition("STEP_Warten:")[0]
    assert "// Maximum time\n        IF NOT SFCError AND SFCEnableLimit AND step_time.ET > T#12s THEN" in branch


def test_steps_that_do_the_same_are_one_branch_unless_their_comments_tell_them_apart() -> None:
    pumps = sfc.lower(sfc.load(FIXTURES / "codesys" / "device_export.xml"), pou="PRG_Pumps", verify=False)
    assert isinstance(pumps.pou.body, m.StBody)
    text = pumps.pou.body.text
    assert "STEP_StartPump1, STEP_StartPump2, STEP_Pumping: // Step StartPump1, Step StartPump2, Step Pumping" in text
    chart = m.SfcNetwork()
    steps = [chart.add_step(name, initial=name == "S1") for name in ("S1", "S2", "S3")]
    for number, step in enumerate(steps):
        chart.add_transition(step, steps[(number + 1) % 3], "a")
        step.main_action = m.StBody(text="IF a THEN n := n + 1; END_IF; // the first" if number == 0 else "n := q;")
    variables = [m.Variable(name="a", type=m.ElementaryType(name="BOOL"))]
    variables += [m.Variable(name=name, type=m.ElementaryType(name="INT")) for name in ("n", "q")]
    interface = m.Interface(sections=[m.VariableSection(variables=variables)])
    pou = m.Pou(name="Main", kind=m.PouKind.PROGRAM, interface=interface, bodies=[m.SfcBody(chart=chart)])
    for comment, label in (("// why", "STEP_2: "), ("", "STEP_2, STEP_3: ")):
        steps[2].main_action = m.StBody(text=f"n := q; {comment}".rstrip())
        project = m.Project(dialect=m.Dialect.CODESYS, pous=[pou])
        made = sfc.lower(project, "case", states="constants", profile="iec", verify=False)
        assert isinstance(made.pou.body, m.StBody)
        main = made.pou.body.text.partition("// Actions of the active steps")[2]
        assert label in main
        assert comment in main


@pytest.mark.parametrize("asked", [{}, {"style": "classic", "construction": "flipflop", "language": "ST"}])
@pytest.mark.parametrize("through", ["lower", "lower_to_file"])
def test_exports_of_codesys_23_have_no_comments_up_to_the_end_of_a_line(
    through: str, asked: dict[str, Any], tmp_path: Path
) -> None:
    # only code without SFC flags has a classic form
    project = sfc.load(FIXTURES / "codesys23/distribution_belt.EXP")
    interface = project.pou("Ablauf").interface
    assert interface is not None
    interface.sections = [each for each in interface.sections if each.kind is not m.SectionKind.INPUT]
    file = tmp_path / "belt.EXP"
    if through == "lower":
        sfc.save(sfc.lower(project, pou="Ablauf", verify=False, **asked).project, file, partial=True)
    else:
        sfc.lower_to_file(project, str(file), pou="Ablauf", format="codesys23", verify=False, partial=True, **asked)
    text = file.read_text("cp1252")
    body = text[text.index("PROGRAM Ablauf") : text.index("PROGRAM Eingabe")]
    assert "CASE" in body or "Warten" in body
    assert "//" not in body
    assert "(* " in body


BOTH = """PROGRAM Main
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT q : BOOL; r : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
STEP S2: q(N); q({}); r(S); END_STEP
TRANSITION FROM S2 TO S3 := NOT a; END_TRANSITION
STEP S3: q(R); r(R); END_STEP
TRANSITION FROM S3 TO S1 := NOT a; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.parametrize("other", ["L, T#30ms", "D, T#30ms", "P"])
@pytest.mark.parametrize("form", ["bits", "case", "regions", "flipflop"])
def test_what_another_association_executes_anyway_is_not_written(form: str, other: str) -> None:
    """An output that N and L drive in one step was ``X2 OR X2 AND NOT q_L.Q``, with a timer that decides nothing."""
    project = sfc.loads(BOTH.format(other).encode(), format="iec-text")
    made = sfc.lower(project, form, pou="Main")
    text = sfc.dumps(sfc.Project(pous=[made.pou]), format="iec-text", partial=True).decode()
    assert made.proof is not None
    assert made.proof.proven
    assert "q_" not in text
    assert ".Q" not in text.replace("r_S", "") or form == "flipflop"
