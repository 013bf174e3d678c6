"""Calls between POUs: functions, function blocks, methods, actions, programs."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import SimulationError, UnknownFunctionError
from plcopen_sfc.languages.declarations import read_declarations, read_interface
from plcopen_sfc.model import Action, Method, Project, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs import Controller, Instance
from tests.semantics.programs.running import main, project_of, start

DIVIDE = """
FUNCTION Split : INT
VAR_INPUT a : INT; b : INT := 10; END_VAR
VAR_OUTPUT rest : INT; END_VAR
VAR_IN_OUT calls : DINT; END_VAR
VAR n : INT; END_VAR
n := n + 1; calls := calls + n; rest := a MOD b; Split := a / b;
END_FUNCTION
"""


def test_functions() -> None:
    instance = main(
        "q, r, s : INT; c : DINT; xs : ARRAY[1..2] OF DINT; i : INT := 2;",
        "q := Split(a := 47, b := 5, rest => r, calls := c) + 1; s := Split(35, calls := c); Split(1, 1, xs[i]);",
        more=DIVIDE,
    )
    assert [instance[n] for n in ("q", "r", "s", "c", "xs[2]")] == [10, 2, 3, 2, 1]


def test_arguments_are_converted_to_the_type_of_the_parameter() -> None:
    more = "FUNCTION Half : REAL\nVAR_INPUT x : REAL; END_VAR\nHalf := x / 2.0;\nEND_FUNCTION"
    assert main("r : REAL; i : INT := 5;", "r := Half(i) + Half(x := 3);", more=more)["r"] == 4.0


def test_functions_may_return_structures() -> None:
    more = """TYPE P : STRUCT x, y : INT; END_STRUCT; END_TYPE
    FUNCTION Swap : P
    VAR_INPUT p : P; END_VAR
    Swap.x := p.y; Swap.y := p.x; p.x := 99;
    END_FUNCTION"""
    instance = main("a : P := (x := 1, y := 2); b : P; n : INT;", "b := Swap(a); n := Swap(b).x;", more=more)
    assert [instance[n] for n in ("a.x", "b.x", "b.y", "n")] == [1, 2, 1, 1]


def test_recursion_without_an_end_is_an_error() -> None:
    more = "FUNCTION F : INT\nVAR_INPUT x : INT; END_VAR\nF := F(x + 1);\nEND_FUNCTION"
    with pytest.raises(SimulationError, match="recursion") as caught:
        main("x : INT;", "x := F(1);", more=more)
    assert caught.value.pou == "F"


def test_recursion_with_an_end_is_fine() -> None:
    more = (
        "FUNCTION F : DINT\nVAR_INPUT x : DINT; END_VAR\n"
        "IF x < 2 THEN F := 1; ELSE F := x * F(x - 1); END_IF\nEND_FUNCTION"
    )
    assert main("x : DINT;", "x := F(10);", more=more)["x"] == 3628800


BLOCK = """
FUNCTION_BLOCK Adder
VAR_INPUT step : INT := 1; END_VAR
VAR_OUTPUT sum : INT; END_VAR
VAR_IN_OUT shared : INT; END_VAR
VAR t : TON; END_VAR
sum := sum + step; shared := shared + step;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Outer
VAR a, b : Adder; all : INT; END_VAR
a(shared := all); b(step := 10, shared := all);
END_FUNCTION_BLOCK
"""


def test_function_blocks_keep_their_state_and_may_be_nested() -> None:
    instance = main("o, p : Outer; q : INT;", "o(); p(); o(); q := o.b.sum;", more=BLOCK)
    assert [instance[n] for n in ("o.a.sum", "o.b.sum", "o.all", "p.all", "q")] == [2, 20, 22, 11, 20]


def test_an_input_that_is_not_given_keeps_its_value() -> None:
    instance = main("a : Adder; n : INT;", "a(step := 5, shared := n); a(shared := n);", more=BLOCK)
    assert instance["a.sum"] == 10


def test_arrays_of_function_blocks() -> None:
    instance = main(
        "a : ARRAY[1..3] OF Adder; i, n : INT;", "FOR i := 1 TO 3 DO a[i](step := i, shared := n); END_FOR", more=BLOCK
    )
    assert [instance[f"a[{i}].sum"] for i in (1, 2, 3)] == [1, 2, 3]


def test_structures_and_arrays_are_passed_by_reference_to_in_outs() -> None:
    more = """TYPE P : STRUCT x : INT; END_STRUCT; END_TYPE
    FUNCTION_BLOCK Set
    VAR_IN_OUT p : P; a : ARRAY[1..2] OF INT; n : INT; END_VAR
    p.x := 5; a[2] := 6; n := 7;
    END_FUNCTION_BLOCK"""
    instance = main("s : Set; q : P; b : ARRAY[1..2] OF INT;", "s(p := q, a := b, n := b[1]);", more=more)
    assert (instance["q.x"], instance["b[1]"], instance["b[2]"]) == (5, 7, 6)


def test_in_outs_without_a_variable_are_errors() -> None:
    with pytest.raises(SimulationError, match="VAR_IN_OUT that leads to nothing"):
        main("a : Adder;", "a(step := 1);", more=BLOCK)


def test_outputs_and_enable() -> None:
    instance = main(
        "t : TON; on : BOOL; q, e : BOOL; et : TIME; c : CTU; n : INT;",
        "t(EN := NOT on, IN := TRUE, PT := T#0s, Q => q, ET => et, ENO => e); c(CU := TRUE, PV := 1, Q => q, CV => n);",
    )
    assert (instance["e"], instance["t.Q"], instance["q"], instance["n"]) == (True, True, True, 1)


def test_programs_call_each_other() -> None:
    text = """PROGRAM Sub
    VAR_INPUT x : INT; END_VAR VAR n : INT; END_VAR
    n := n + x;
    END_PROGRAM
    PROGRAM Main
    VAR m : INT; END_VAR
    Sub(x := 3); m := Sub.n;
    END_PROGRAM"""
    instance = start(text)
    instance.scan()
    instance.scan()
    assert (instance["m"], instance["Sub.n"]) == (6, 6)


def with_actions() -> Project:
    project = project_of(
        """FUNCTION_BLOCK Base
        VAR n : INT; END_VAR
        n := n + 1; Fill(); Fill;
        END_FUNCTION_BLOCK
        PROGRAM Main
        VAR b : Base; d : Derived; x : INT; END_VAR
        b(); b.Fill(); x := b.Twice(value := 4); d(); x := x + d.Twice(1);
        END_PROGRAM
        FUNCTION_BLOCK Derived
        VAR m : INT; END_VAR
        m := m + 1;
        END_FUNCTION_BLOCK""",
        Dialect.CODESYS,
    )
    base, derived = project.pou("Base"), project.pou("Derived")
    base.actions.append(Action(name="Fill", body=StBody(text="n := n + 10;")))
    head = "METHOD Twice : INT\nVAR_INPUT value : INT; END_VAR\nVAR local : INT; END_VAR"
    interface = read_interface(read_declarations(head, Dialect.CODESYS))
    base.methods.append(
        Method(
            name="Twice",
            interface=interface,
            body=StBody(text="local := local + 1; n := n + local; Twice := value * 2;"),
        )
    )
    assert derived.interface is not None
    derived.interface.declaration = "FUNCTION_BLOCK Derived EXTENDS Base\nVAR m : INT; END_VAR"
    derived.bodies = [StBody(text="SUPER^(); THIS^.Fill(); m := m + n;")]
    return project


def test_actions_methods_and_inheritance() -> None:
    controller = Controller(with_actions())
    instance = controller.instance("Main")
    assert not controller.problems
    instance.scan()
    assert [instance[n] for n in ("b.n", "x", "d.n", "d.m")] == [1 + 20 + 10 + 1, 8 + 2, 32, 31]


def test_what_is_not_known_is_an_error_where_it_is_reached() -> None:
    controller = Controller(
        project_of("PROGRAM Main\nVAR x, y : INT; END_VAR\n\nIF x > 0 THEN\ny := Magic(x);\nEND_IF\nEND_PROGRAM")
    )
    instance = controller.instance("Main")
    assert controller.missing == ("Magic",)
    instance.scan()
    instance["x"] = 1
    with pytest.raises(UnknownFunctionError, match="Magic is not known to the simulator") as caught:
        instance.scan()
    assert (caught.value.name, caught.value.scan, caught.value.pou, caught.value.location.line) == (
        "Magic",
        2,
        "Main",
        2,
    )
    assert "Supply it: a function by --functions FILE.py" in str(caught.value)


def test_functions_can_be_supplied() -> None:
    def magic(a: int, *, factor: int = 1) -> int:
        return a * factor

    instance = main(
        "x : INT := 5; y, z : INT; b : BOOL;",
        "y := Magic(x) + 1; z := MAGIC(x, factor := 10000); b := Magic(3) > 2;",
        functions={"magic": magic},
    )
    assert (instance["y"], instance["z"], instance["b"]) == (6, 50000 - 65536, True)


def test_a_supplied_function_is_called_by_names_in_any_case_and_its_errors_are_told() -> None:
    def count(Station: int = 0, **others: int) -> int:  # noqa: N803  # as it is in the project
        return Station // others.get("parts", 0)

    text = "y := Count(station := 8, Parts := 2);"
    assert main("y : INT;", text, functions={"Count": lambda Station, Parts: Station // Parts})["y"] == 4  # noqa: N803
    with pytest.raises(SimulationError, match="supplied function count ends with an error: ZeroDivisionError"):
        main("y : INT;", "y := Count(STATION := 8);", functions={"Count": count})
    with pytest.raises(SimulationError, match="unexpected keyword argument 'place'"):
        main("y : INT;", "y := Count(place := 8);", functions={"Count": lambda Station: Station})  # noqa: N803


def test_a_supplied_value_of_another_type_is_an_error() -> None:
    with pytest.raises(SimulationError, match="'no' is no INT"):
        main("x : INT;", "x := Magic();", functions={"Magic": lambda: "no"})


def test_function_blocks_that_nobody_knows() -> None:
    controller = Controller(project_of("PROGRAM Main\nVAR a : Axis; x : BOOL; END_VAR\nx := a.Done;\nEND_PROGRAM"))
    instance = controller.instance("Main")
    instance["Main.a.Done"] = True
    instance.scan()
    assert instance["x"] is True
    assert controller.missing == ("Axis",)
    controller = Controller(project_of("PROGRAM Main\nVAR a : Axis; END_VAR\na(Enable := TRUE);\nEND_PROGRAM"))
    with pytest.raises(UnknownFunctionError, match="Axis is not known"):
        controller.instance("Main").scan()


def test_an_instance_that_contains_itself_is_an_error() -> None:
    block = "FUNCTION_BLOCK {0}\nVAR x : {1}; END_VAR\nEND_FUNCTION_BLOCK\n"
    text = block.format("A", "B") + block.format("B", "A")
    with pytest.raises(SimulationError, match="A contains itself through B"):
        Controller(project_of(text)).instance("A")


def test_functions_are_instances_too() -> None:
    instance: Instance = start(
        DIVIDE.replace("VAR_IN_OUT calls : DINT; END_VAR", "VAR calls : DINT; END_VAR"), pou="Split"
    )
    instance["a"] = 47
    instance.scan()
    instance.scan()
    assert (instance["Split"], instance["rest"], instance["calls"]) == (4, 7, 1)


def test_enable_of_functions_and_eno() -> None:
    more = "FUNCTION F : INT\nVAR_IN_OUT n : INT; END_VAR\nn := n + 1;\nEND_FUNCTION"
    instance = main(
        "x, y : INT; on, a, b, c : BOOL; t : TON;",
        "F(EN := on, n := x, ENO => a); F(n := y, ENO => b); t(IN := TRUE, ENO => c);",
        more=more,
    )
    assert [instance[n] for n in ("x", "y", "a", "b", "c")] == [0, 1, False, True, True]


def test_only_inputs_are_given() -> None:
    for call in ("t(Q := TRUE);", "t(START := 1);"):
        with pytest.raises(SimulationError, match="has no input"):
            Controller(project_of(f"PROGRAM Main\nVAR t : TON; END_VAR\n{call}\nEND_PROGRAM")).instance("Main").scan()


def test_a_supplied_function_must_give_a_value() -> None:
    with pytest.raises(SimulationError, match="gives None, which is no value"):
        main("x : INT;", "x := Magic() + 1;", functions={"Magic": lambda: None})


def test_in_outs_of_the_outermost_instance_are_variables_of_their_own() -> None:
    text = """TYPE P : STRUCT x : INT; END_STRUCT; END_TYPE
    FUNCTION_BLOCK Main
    VAR_IN_OUT n : INT; p : P; END_VAR
    n := n + 1; p.x := n;
    END_FUNCTION_BLOCK"""
    instance = start(text)
    instance["n"] = 5
    before = instance.snapshot()
    instance.scan()
    assert (instance["n"], instance["p.x"]) == (6, 6)
    instance.restore(before)
    instance.scan()
    assert (instance["n"], set(instance.variables())) == (6, {"n", "p.x"})


def test_names_of_a_project_are_never_code() -> None:
    project = project_of("PROGRAM Main\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM", Dialect.SCL)
    given: dict[str, object] = {}

    def magic(**arguments: object) -> int:
        given.update(arguments)
        return 7

    project.pou("Main").bodies = [
        StBody(text='#x := Magic("class" := 1, "a=1), __import__(\'os\') #" := 2); "__import__(\'os\')" := #x;')
    ]
    instance = Controller(project, functions={"Magic": magic}).instance("Main")
    instance.scan()
    assert instance["x"] == 7
    assert given == {"class": 1, "a=1), __import__('os') #": 2}
    assert instance["__import__('os')"] == 7


@pytest.mark.parametrize(
    ("variables", "call"),
    [
        ("x : REAL;", "F(n := x);"),
        ("x : DINT;", "F(n := x);"),
        ("x : TON;", "F(n := x);"),
        ("x : ARRAY[1..2] OF INT;", "F(n := x);"),
        ("x : INT; t : TON;", "t S= x > 1;"),
        ("x : INT; t : TON;", "t(IN := TRUE, ET => t);"),
        ("x : INT; t : TON;", "FOR x := 1 TO 3 BY t DO ; END_FOR"),
    ],
)
def test_variables_of_other_types_are_refused(variables: str, call: str) -> None:
    more = "FUNCTION F : INT\nVAR_IN_OUT n : INT; END_VAR\nn := n + 1;\nEND_FUNCTION"
    text = f"{more}\nPROGRAM Main\nVAR {variables} END_VAR\n{call}\nEND_PROGRAM"
    with pytest.raises(SimulationError, match=r"is passed to|is assigned to|cannot become"):
        Controller(project_of(text, Dialect.CODESYS)).instance("Main").scan()


def test_arguments_of_an_action_are_those_of_its_instance() -> None:
    source = """
    FUNCTION_BLOCK Tank VAR_INPUT amount : INT := 1; END_VAR VAR n : INT; END_VAR ; END_FUNCTION_BLOCK
    PROGRAM Main VAR tank : Tank; END_VAR tank.Fill(amount := 5); END_PROGRAM
    """
    project = project_of(source, Dialect.CODESYS)
    project.pou("Tank").actions.append(Action(name="Fill", body=StBody(text="n := n + amount;")))
    instance = Controller(project).instance("Main")
    instance.scan()
    instance.scan()
    assert (instance["tank.n"], instance["tank.amount"]) == (10, 5)


METHODS = """FUNCTION_BLOCK Base
VAR_INPUT x : INT; END_VAR
VAR n : INT; END_VAR
METHOD Init : BOOL
VAR_INPUT a : INT; b : INT := 3; END_VAR
n := a + b; Init := TRUE;
END_METHOD
METHOD Reset
n := 0;
END_METHOD
METHOD Pass : BOOL
VAR_INPUT a : INT; END_VAR VAR_OUTPUT b : INT; END_VAR VAR_IN_OUT c : INT; END_VAR
b := a * 2; c := c + 1; Pass := a > 0;
END_METHOD
METHOD Both
Reset(); THIS^.Init(a := 1); THIS^.Init(n, b := 5);
END_METHOD
n := n + x;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Derived EXTENDS Base
VAR m : INT; p : POINTER TO Derived; END_VAR
METHOD Init : BOOL
VAR local : INT; END_VAR VAR_INPUT a : INT; b : INT := 4; END_VAR
SUPER^.Init(a := a * 10, b := b); Init := FALSE;
END_METHOD
METHOD Mine
SUPER^.Reset(); THIS^.m := THIS^.m + 7; n := n + 1; p := THIS; p^.m := p^.m + 1;
END_METHOD
SUPER^(x := 1); m := m + 1; THIS^.Mine();
END_FUNCTION_BLOCK
FUNCTION_BLOCK User
VAR_IN_OUT c : Base; END_VAR
c.Init(a := 2);
END_FUNCTION_BLOCK
TYPE Group : STRUCT fb : Base; END_STRUCT; END_TYPE
"""


@pytest.mark.parametrize("dialect", [Dialect.CODESYS, Dialect.IEC])
@pytest.mark.parametrize(
    ("variables", "body", "path", "expected"),
    [
        ("fb : Base;", "fb.Init(a := 5);", "fb.n", 8),
        ("fb : Base;", "fb.Init(5, 6);", "fb.n", 11),
        ("fb : Base;", "fb.Init(a := 5); fb.Reset();", "fb.n", 0),
        ("fb : Base; x, y : INT;", "fb.Pass(a := 5, b => x, c := y); x := x + y;", "x", 11),
        ("fb : Base;", "fb.Both();", "fb.n", 9),
        ("fb : ARRAY [1..3] OF Base; i : INT;", "FOR i := 1 TO 3 DO fb[i].Init(a := i); END_FOR;", "fb[3].n", 6),
        ("g : Group;", "g.fb.Init(a := 5);", "g.fb.n", 8),
        ("fb : Base; u : User;", "u(c := fb);", "fb.n", 5),
        ("fb : Derived;", "fb.Init(a := 5);", "fb.n", 54),
        ("fb : Derived;", "fb();", "fb.m", 9),
        # which method is called, the instance decides; the inputs left out are those that the caller knows
        ("fb : Derived;", "fb.Both();", "fb.n", 135),
        ("fb : Derived; u : User;", "u(c := fb);", "fb.n", 23),
        ("fb : Derived; p : POINTER TO Base;", "p := ADR(fb); p^.Init(a := 5);", "fb.n", 53),
        ("fb : Derived; ok : BOOL := TRUE; p : POINTER TO Base;", "p := ADR(fb); ok := p^.Init(a := 5);", "ok", False),
    ],
)
def test_methods_are_called(variables: str, body: str, path: str, expected: int, dialect: Dialect) -> None:
    if "POINTER" in variables and dialect is Dialect.IEC:
        body = body.replace("ADR", "REF")
    assert main(variables, body, dialect, more=METHODS)[path] == expected


HIDING = """CONFIGURATION c VAR_GLOBAL {name} : UDINT; END_VAR END_CONFIGURATION
FUNCTION_BLOCK Base
VAR n : INT; END_VAR
METHOD Count : INT
n := n + 1; Count := n;
END_METHOD
{body}
END_FUNCTION_BLOCK
FUNCTION Twice : INT VAR_INPUT x : INT; END_VAR Twice := 2 * x; END_FUNCTION
"""


@pytest.mark.parametrize("dialect", [Dialect.CODESYS, Dialect.IEC])
@pytest.mark.parametrize("name", ["Count", "COUNT", "other"])
@pytest.mark.parametrize(
    ("body", "expected"), [("Count();", 1), ("n := Count() + 1;", 2), ("n := Twice(x := Count());", 2)]
)
def test_a_method_of_the_block_hides_a_global_variable_of_its_name(
    body: str, expected: int, name: str, dialect: Dialect
) -> None:
    assert main("fb : Base;", "fb();", dialect, more=HIDING.format(name=name, body=body))["fb.n"] == expected


def test_a_variable_of_the_block_is_still_no_method_of_it() -> None:
    more = (
        HIDING.format(name="Twice", body="n := 4;")
        + "FUNCTION_BLOCK Own VAR Count : Base; END_VAR Count(); END_FUNCTION_BLOCK"
    )
    assert main("fb : Own;", "fb();", more=more)["fb.Count.n"] == 4


@pytest.mark.parametrize("use", ["c := c + 1;", "s.a := 1;", "b.Reset();", "b(x := 1);", "a[1] := a[0];", "s := s;"])
def test_an_in_out_that_a_call_leaves_out_is_an_error(use: str) -> None:
    more = f"""{METHODS} TYPE Pair : STRUCT a : INT; END_STRUCT; END_TYPE
    FUNCTION_BLOCK Block
    VAR_IN_OUT c : INT; s : Pair; b : Base; a : ARRAY [0..3] OF INT; END_VAR
    {use}
    END_FUNCTION_BLOCK"""
    with pytest.raises(SimulationError, match="VAR_IN_OUT that leads to nothing"):
        main("fb : Block;", "fb();", more=more)


STARTING = """FUNCTION_BLOCK Base
VAR n : INT := 1; END_VAR
METHOD FB_Init : BOOL
VAR_INPUT bInitRetains, bInCopyCode : BOOL; END_VAR
IF bInitRetains AND NOT bInCopyCode THEN n := n * 10 + 2; END_IF;
END_METHOD
END_FUNCTION_BLOCK
{attribute 'call_after_init'}
FUNCTION_BLOCK Derived EXTENDS Base
METHOD FB_Init : BOOL
n := n * 10 + 3;
END_METHOD
{attribute 'call_after_init'}
METHOD Ready : BOOL
n := n * 10 + 4;
END_METHOD
METHOD Later : BOOL
n := 0;
END_METHOD
END_FUNCTION_BLOCK
TYPE Group : STRUCT fb : ARRAY [0..1] OF Derived; END_STRUCT; END_TYPE
"""


@pytest.mark.parametrize(
    ("dialect", "declared", "path", "expected"),
    [
        (Dialect.CODESYS, "a : Base;", "a.n", 12),
        (Dialect.TWINCAT, "a : Derived;", "a.n", 1234),
        (Dialect.CODESYS, "g : Group;", "g.fb[1].n", 1234),
        (Dialect.IEC, "a : Derived;", "a.n", 1),
    ],
)
def test_codesys_calls_methods_when_an_instance_is_made(
    dialect: Dialect, declared: str, path: str, expected: int
) -> None:
    assert main(declared, "", dialect, STARTING)[path] == expected


@pytest.mark.parametrize(
    ("declared", "more", "why"),
    [
        ("a : Base := (n := 7);", STARTING, "the simulator does not know which remain"),
        ("a : Base;", STARTING.replace("bInCopyCode : BOOL", "bInCopyCode : BOOL; x : INT"), "gives FB_Init its x"),
    ],
)
def test_what_a_declaration_gives_beside_fb_init_is_refused(declared: str, more: str, why: str) -> None:
    with pytest.raises(SimulationError, match=why):
        main(declared, "", Dialect.CODESYS, more)


WITH_PROPERTY = b"""{plcopen_sfc project.dialect := 'codesys'}
FUNCTION_BLOCK Motor
VAR now : INT; END_VAR
PROPERTY Speed : INT
GET
Speed := now;
END_GET
END_PROPERTY
END_FUNCTION_BLOCK
PROGRAM Main
VAR m : Motor; n : INT; END_VAR
n := m.speed;
END_PROGRAM
"""


def test_a_property_is_told_by_its_name_and_not_executed_in_other_tools() -> None:
    project = sfc.loads(WITH_PROPERTY, format="iec-text")
    with pytest.raises(SimulationError, match="speed is a property of Motor"):
        sfc.simulate(project, pou="Main", scans=1)
    report = sfc.convert(project, "plcopen", partial=True).report
    assert [item.path for item in report.items if item.outcome.value == "not executed"] == [
        "POU Motor / property Speed"
    ]


def test_a_variable_that_is_one_for_all_instances_is_not_one_for_each() -> None:
    """VAR_STAT of a block was executed as VAR, and called equal to it."""
    text = (
        "FUNCTION_BLOCK Mot VAR_STAT s : INT; END_VAR VAR_OUTPUT o : INT; END_VAR s := s + 1; o := s; "
        "END_FUNCTION_BLOCK PROGRAM Main VAR m1, m2 : Mot; END_VAR m1(); m2(); END_PROGRAM"
    )
    with pytest.raises(SimulationError, match="s is one for all instances"):
        sfc.simulate(sfc.loads(text.encode(), format="iec-text").pou("Main"), scans=1)
    alone = text.replace("FUNCTION_BLOCK Mot", "PROGRAM Mot").replace(
        "END_FUNCTION_BLOCK PROGRAM Main", "END_PROGRAM --"
    )
    alone = alone.partition(" --")[0]
    trace = sfc.simulate(sfc.loads(alone.encode(), format="iec-text").pou("Mot"), scans=2)
    assert [row["o"] for row in trace.to_records()] == [1, 2]
