"""Program text that tools spell differently."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.programs import Controller

POWERS = """FUNCTION_BLOCK Main
VAR_INPUT a : BOOL; i : INT; END_VAR
VAR_OUTPUT n : REAL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a AND 2 ** 3 = 8; END_TRANSITION
STEP S1: Act(P1); END_STEP
TRANSITION FROM S1 TO S0 := NOT a; END_TRANSITION
ACTION Act: n := -2.0 ** 2.0 * (n + 1.0) ** 0.5; // ** is a power
END_ACTION
END_FUNCTION_BLOCK
"""


@pytest.mark.slow
def test_a_power_is_a_function_in_codesys() -> None:
    project = sfc.loads(POWERS.encode(), format="iec-text")
    data, report = sfc.convert(project, "codesys")
    assert report.losses == []
    assert b"EXPT(-2.0, 2.0) * EXPT(n + 1.0, 0.5); // ** is a power" in data
    result = sfc.loads(data, as_tool=True)
    chart = next(result.charts()).chart
    assert getattr(chart.transitions[0].condition, "text", "") == "a AND EXPT(2, 3) = 8"
    assert equivalent(project.pou("Main"), result.pou("Main"), ("iec", "codesys"), delay="auto", outputs=["n"], cap=50)


def network(*pins: str) -> m.LdBody:
    """A network of S7 with an edge contact or a flip-flop: type of the box, names of its pins, its output."""
    kind, power, operand, memory, out = pins
    rail = {"id": 0, "kind": "leftPowerRail", "outputs": [{}]}
    inputs = [{"name": power, "input": {"connections": [{"source": 0}]}}]
    inputs += [{"name": name, "input": {"expression": text}} for name, text in ((operand, "#a"), (memory, "#m"))]
    box = {"id": 4, "kind": "block", "type_name": kind}
    box["parameters"] = {"inputs": inputs, "outputs": [{"name": out, "output": {}}]}
    coil = {"id": 9, "kind": "coil", "variable": "#y", "input": {"connections": [{"source": 4, "pin": out}]}}
    return m.LdBody.model_validate({"networks": [{"nodes": [rail, box, coil]}]})


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
@pytest.mark.parametrize(
    "box", [("PContact", "pre", "operand", "bit", "out"), ("NContact", "pre", "operand", "bit", "out")]
)
def test_a_box_with_its_memory_at_a_pin_is_told(box: tuple[str, ...], target: str) -> None:
    variables = [m.Variable.model_validate({"name": name, "type": "BOOL"}) for name in "amy"]
    interface = m.Interface(sections=[m.VariableSection(kind=m.SectionKind.LOCAL, variables=variables)])
    pou = m.Pou(name="Main", kind=m.PouKind.FUNCTION_BLOCK, interface=interface, bodies=[network(*box)])
    project = m.Project(name="P", dialect=m.Dialect.SCL, pous=[pou])
    source = sfc.loads(sfc.dumps(project, format="simaticml"), format="simaticml")
    _, report = sfc.convert(source, target, partial=True)
    assert [(item.outcome, item.what, item.path) for item in report.losses] == [
        (Outcome.NOT_EXECUTED, "box", "POU Main")
    ]


OTHER_TOOLS = [
    ("plcopen-1.01", ""),
    ("plcopen-2.01", ""),
    ("plcopen-2.01", "beremiz"),
    ("iec-text", "matiec"),
    ("scl", ""),
    ("simaticml", ""),
]
ONLY_CODESYS = {
    "n := SIZEOF(n);": "SIZEOF",
    "n := __NEW(INT);": "__NEW",
    "p := ADR(n);": "ADR",
    "t := TIME();": "TIME",
    "r REF= n;": "REF=",
    "{IF defined (variable:Foo)}\nn := 99;\n{END_IF}": "no pragmas that leave statements out",
}


@pytest.mark.parametrize(("target", "flavour"), OTHER_TOOLS)
@pytest.mark.parametrize("text", ONLY_CODESYS)
def test_what_only_codesys_has_is_not_executed_by_other_tools(text: str, target: str, flavour: str) -> None:
    _, report = sfc.convert(codesys_text(text), target, flavour=flavour, partial=True)
    told = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)]
    assert any(ONLY_CODESYS[text] in why for why in told), told


@pytest.mark.parametrize(("target", "flavour"), OTHER_TOOLS)
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("q S= a;", ("S=",)),
        ("q R= a;", ("R=",)),
        ("q := a AND_THEN n > 3;", ("AND_THEN",)),
        ("q := a OR_ELSE n > 3;", ("OR_ELSE",)),
        ("q := b := a;", (":= b :=",)),
        ("ton(IN := , PT := T#1s);", ("IN := ,",)),
        ("n += 1;", ("+=",)),
    ],
)
def test_what_codesys_writes_otherwise_is_translated(text: str, words: tuple[str], target: str, flavour: str) -> None:
    project = codesys_text(text)
    data, report = sfc.convert(project, target, flavour=flavour, partial=True)
    about_text = [item for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what in ("text", "code")]
    assert about_text == []
    result = sfc.loads(data, as_tool=True)
    (written,) = [body.text for _, pou, body in result.bodies() if isinstance(body, m.StBody) and pou.name == "Body"]
    assert not any(word in written for word in words)


def codesys_text(text: str) -> m.Project:
    declarations = "a, b, q : BOOL; n : INT; t : TIME; p : POINTER TO INT; r : REFERENCE TO INT; ton : TON;"
    head = "{plcopen_sfc format := 1}\n{plcopen_sfc project.dialect := 'codesys'}\n"
    block = f"FUNCTION_BLOCK Body\nVAR {declarations} END_VAR\n{text}\nEND_FUNCTION_BLOCK\n"
    return sfc.loads((head + block).encode(), format="iec-text")


def test_values_of_enumerations_are_named_as_the_target_names_them() -> None:
    text = b"""{plcopen_sfc project.dialect := 'codesys'}
    TYPE Mode : (Off, Auto); END_TYPE
    PROGRAM Main
    VAR m : Mode; en : BOOL; END_VAR
    INITIAL_STEP Idle: END_STEP
    STEP Work: Set(N); END_STEP
    TRANSITION FROM Idle TO Work := en AND m = Mode.Off; END_TRANSITION
    TRANSITION FROM Work TO Idle := NOT en; END_TRANSITION
    ACTION Set: m := Mode.Auto; END_ACTION
    END_PROGRAM"""
    data = sfc.dumps(sfc.loads(text, format="iec-text"), format="plcopen", strict=True)
    assert b"m = Mode#Off" in data
    assert b"m := Mode#Auto" in data
    back = sfc.dumps(sfc.loads(data, as_tool=True), format="codesys", strict=True)
    assert b"m = Mode.Off" in back
    assert b"m := Mode.Auto" in back


IL_CONDITION = """PROGRAM Main
    VAR_INPUT a : BOOL; b : BOOL; END_VAR
    VAR tm : TON; END_VAR
    INITIAL_STEP Idle: END_STEP
    STEP Work: END_STEP
    TRANSITION FROM Idle TO Work :
    {text}
    END_TRANSITION
    TRANSITION FROM Work TO Idle := NOT a; END_TRANSITION
    END_PROGRAM"""
CALLING = "CAL tm(IN := a, PT := T#30ms)\nLD tm.Q\nANDN b"


@pytest.mark.parametrize(
    ("text", "condition"),
    [
        ("LD a\nANDN b", b"a AND NOT b"),
        (CALLING, b"tm.Q AND NOT b"),
        ("again:\nLD a\nJMPC again\nLD b", b"Condition_of_Idle_Work_is_missing"),
    ],
)
def test_a_condition_in_instruction_list_is_an_expression_in_codesys_or_refused(text: str, condition: bytes) -> None:
    source = sfc.loads(IL_CONDITION.format(text=text).encode(), format="iec-text")
    data, report = sfc.convert(source, "codesys", partial=True)
    assert condition in data
    assert b"<IL>" not in data
    assert bool(report.with_outcome(Outcome.NOT_EXECUTED)) is (b"missing" in condition)


@pytest.mark.parametrize("target", ["codesys", "codesys23", "plcopen-2.01"])
def test_a_call_in_a_condition_in_instruction_list_runs_the_same(target: str) -> None:
    source = sfc.loads(IL_CONDITION.format(text=CALLING).encode(), format="iec-text")
    _, report = sfc.convert(source, target, limit=10)
    assert report.compared["POU Main"].startswith("equal")
    assert not report.losses


def test_actions_in_instruction_list_are_statements_for_matiec() -> None:
    text = """PROGRAM Main
    VAR_INPUT a : BOOL; END_VAR
    VAR_OUTPUT n : INT; END_VAR
    INITIAL_STEP Idle: Count(N); END_STEP
    TRANSITION FROM Idle TO Idle := a; END_TRANSITION
    ACTION Count:
    LD n
    ADD 1
    ST n
    END_ACTION
    END_PROGRAM"""
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "iec-text", flavour="matiec")
    assert b"n := n + 1;" in data
    assert not report.with_outcome(Outcome.NOT_EXECUTED)


COUNTER = """FUNCTION_BLOCK Counter
    VAR_INPUT reset : BOOL; END_VAR
    VAR_OUTPUT value : INT; END_VAR
    VAR count : INT; END_VAR
    LD reset
    JMPC clear
    LD count
    ADD 1
    JMP done
    clear:
    LD 0
    done:
    ST count
    ST value
    END_FUNCTION_BLOCK"""


@pytest.mark.parametrize("target", ["twincat", "simaticml"])
def test_ways_that_leave_a_result_for_what_follows_are_statements(target: str) -> None:
    project = sfc.loads(COUNTER.encode(), format="iec-text")
    data, report = sfc.convert(project, target)
    assert not report.losses
    controller = Controller(sfc.loads(data, format=target, as_tool=True))
    assert not controller.problems
    block = controller.instance("Counter")
    found = []
    for reset in (False, False, True, False, False, False, True):
        block["reset"] = reset
        block.scan()
        found.append(block["value"])
    assert found == [1, 2, 0, 1, 2, 3, 0]


@pytest.mark.parametrize(
    ("statement", "written"),
    [
        ("t := ADD_TIME(T#2s, T#1s);", "t := T#2s + T#1s;"),
        ("s := CONCAT(s, u, s);", "s := CONCAT(CONCAT(s, u), s);"),
        ("s := MID(IN := s, L := 2, P := 3);", "s := MID(s, 2, 3);"),
        ("i := TRUNC(r);", "i := TRUNC_INT(r);"),
        ("d := TRUNC(r);", "d := TRUNC(r);"),
        ("b := TRUNC(r);", "b := DINT_TO_SINT(TRUNC(r));"),
        ("i := REAL_TRUNC_INT(r);", "i := TRUNC_INT(r);"),
        ("d := MAX(d, 3);", "d := MAX(d, 3);"),
        ("i := CONCATENATED(s, u, s);", "i := CONCATENATED(s, u, s);"),
    ],
)
def test_functions_that_codesys_writes_otherwise_are_put_into_its_words(statement: str, written: str) -> None:
    """They were kept, and did not compile: it reads most of what IEC 61131-3 has."""
    text = f"""FUNCTION CONCATENATED : INT VAR_INPUT a, b, c : STRING; END_VAR CONCATENATED := 1; END_FUNCTION
    PROGRAM Main VAR r : REAL; i : INT; d : DINT; b : SINT; t : TIME; s, u : STRING; END_VAR {statement} END_PROGRAM"""
    project = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(project, "codesys")
    assert report.losses == []
    body = sfc.loads(data, as_tool=True).pou("Main").body
    assert isinstance(body, m.StBody)
    assert body.text.strip() == written


@pytest.mark.parametrize(
    ("statement", "written"),
    [
        ("s := MID(STR := s, LEN := 2, POS := 3);", "s := MID(IN := s, L := 2, P := 3);"),
        ("i := TRUNC_INT(r);", "i := REAL_TRUNC_INT(r);"),
        ("i := TRUNC(r);", "i := TRUNC(r);"),
    ],
)
def test_functions_that_codesys_alone_writes_so_are_put_into_the_words_of_the_standard(
    statement: str, written: str
) -> None:
    text = f"PROGRAM Main VAR r : REAL; i : INT; s : STRING; END_VAR {statement} END_PROGRAM"
    project = sfc.loads(sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="codesys"), as_tool=True)
    body = project.pou("Main").body
    assert isinstance(body, m.StBody)
    body.text = statement
    seen = sfc.loads(sfc.convert(project, "plcopen-2.01")[0], as_tool=True).pou("Main").body
    assert isinstance(seen, m.StBody)
    assert seen.text.strip() == written


@pytest.mark.parametrize(
    ("target", "written"),
    [
        ("codesys23", "Clamp(x := r, hi := 2.0, lo := -1.0)"),
        ("iec-text for matiec", "Clamp(x := r, hi := 2.0)"),
        ("scl", 'Clamp"(x := #r, hi := 2.0)'),
    ],
)
def test_a_call_with_arguments_by_position_and_by_name_is_one_of_codesys_alone(target: str, written: str) -> None:
    text = """FUNCTION Clamp : REAL
VAR_INPUT x : REAL; lo : REAL := -1.0; hi : REAL := 1.0; END_VAR
Clamp := LIMIT(lo, x, hi);
END_FUNCTION
PROGRAM Main
VAR r : REAL; END_VAR
r := Clamp(r, hi := 2.0);
END_PROGRAM
"""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    form, _, flavour = target.partition(" for ")
    data, _ = sfc.convert(project, form, flavour=flavour, partial=True)
    assert written in data.decode()


def test_statements_that_a_pragma_leaves_out_are_executed_in_codesys_2_3() -> None:
    text = "PROGRAM Main VAR u : INT; END_VAR {IF defined (SIM)} u := u + 1; {ELSE} u := u + 2; {END_IF} END_PROGRAM"
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    _, report = sfc.convert(project, "codesys23", partial=True)
    (item,) = report.with_outcome(Outcome.NOT_EXECUTED)
    assert "no pragmas that leave statements out" in item.why


OWN = """FUNCTION {name} : REAL VAR_INPUT x : REAL; END_VAR {name} := x + 3.0; END_FUNCTION
PROGRAM Main VAR_INPUT x : REAL; END_VAR VAR_OUTPUT r : REAL; END_VAR r := {name}(x); END_PROGRAM
"""


@pytest.mark.parametrize("target", ["codesys", "codesys23", "codesys-export", "plcopen-2.01", "simaticml", "scl"])
@pytest.mark.parametrize(
    "name", ["Ratio", "ATAN2", "ADD_TIME", "CONCAT_DATE", "SUB_TIME", "REAL_TO_TIME", "REAL_TO_INT", "TO_LREAL"]
)
def test_a_function_of_the_project_is_called_and_no_standard_one(name: str, target: str) -> None:
    project = sfc.loads(OWN.format(name=name).encode(), format="iec-text")
    data, report = sfc.convert(project, target)
    assert not report.losses
    result = sfc.loads(data, format=target, as_tool=True)
    runs = [
        sfc.simulate(each, pou="Main", scans=1, inputs=lambda *_: {"x": 2.25})["r"][0] for each in (project, result)
    ]
    assert runs == [5.25, 5.25]


@pytest.mark.parametrize("target", ["codesys", "codesys-export"])
@pytest.mark.parametrize(
    "operand", ["STRING", "wstring", "DINT", "DATE_AND_TIME", "POINTER TO INT", "ARRAY[0..n] OF BYTE"]
)
@pytest.mark.parametrize("operator", ["__NEW", "SIZEOF"])
def test_types_that_operators_of_codesys_take_are_no_undeclared_names(operator: str, operand: str, target: str) -> None:
    text = f"PROGRAM Main VAR p : POINTER TO BYTE; n : INT; END_VAR p := {operator}({operand}); n := INTT; END_PROGRAM"
    losses = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target, partial=True).report.losses
    assert [item.why.split("`")[1] for item in losses if item.what == "undeclared name"] == ["INTT"]
