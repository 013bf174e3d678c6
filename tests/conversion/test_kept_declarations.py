"""Declarations that other tools do not have, and what nothing in the written file declares: never lost unsaid."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Dialect, FlagUse, NamedCondition, NamedTransition, OpaqueBody, SfcFlag, SfcSettings
from plcopen_sfc.report import ConversionReport, Outcome

TARGETS = ("codesys", "plcopen-1.01", "plcopen-2.01", "simaticml", "scl")
HEAD = "{plcopen_sfc format := 1}\n{plcopen_sfc project.dialect := 'codesys'}\n"
MAIN = "PROGRAM Main\nVAR n : INT; %s END_VAR\n%s\nEND_PROGRAM\n"


def losses(text: str, target: str, flavour: str = "") -> dict[tuple[str, str], str]:
    _, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target, flavour=flavour, partial=True)
    return {(i.path, i.what): i.why for i in report.with_outcome(Outcome.NOT_EXECUTED) if i.what != "program"}


BASES = """TYPE Base : STRUCT x : INT := 2; END_STRUCT; END_TYPE
TYPE Der EXTENDS Base : STRUCT y : INT := 4; END_STRUCT; END_TYPE
FUNCTION_BLOCK FbBase
VAR_OUTPUT o : INT; END_VAR
o := o + 1;
END_FUNCTION_BLOCK
FUNCTION_BLOCK FbDer EXTENDS FbBase IMPLEMENTS IThing
VAR n : INT; END_VAR
n := n + 1;
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("target", ["plcopen-1.01", "plcopen-2.01", "simaticml", "scl"])
def test_what_types_and_blocks_extend_is_named_where_the_target_has_no_such(target: str) -> None:
    foreign = "TYPE Own EXTENDS Library.Part : STRUCT y : INT; END_STRUCT; END_TYPE\n"
    found = losses(HEAD + BASES + foreign + MAIN % ("d : Der; f : FbDer;", "n := d.x + f.o;"), target)
    assert "does not extend `Library.Part`" in found["type Own", "extends"]
    assert ("type Der", "extends") not in found  # has the members of its base
    assert "does not extend `FbBase`" in found["POU FbDer", "extends"]
    assert "does not implement `IThing`" in found["POU FbDer", "implements"]
    assert not any("please report" in why for why in found.values())


def test_codesys_has_what_types_and_blocks_extend() -> None:
    project = sfc.loads((HEAD + BASES + MAIN % ("d : Der; f : FbDer;", "n := d.x + f.o;")).encode(), format="iec-text")
    data, report = sfc.convert(project, "codesys")
    assert [item for item in report.items if item.outcome not in (Outcome.KEPT, Outcome.EXTENSION_DATA)] == []
    text = data.decode("utf-8-sig")
    assert text.count("<Extends>Base</Extends>") == text.count("<Extends>FbBase</Extends>") == 1
    assert "<Implements>IThing</Implements>" in text
    assert "urn:plcopen-sfc:declaration" not in text
    result = sfc.loads(data, as_tool=True)
    assert sfc.simulate(result, pou="FbDer", scans=2)["n"] == [1, 2]
    back, _ = sfc.convert(result, "iec-text")
    assert "FUNCTION_BLOCK FbDer EXTENDS FbBase IMPLEMENTS IThing\n" in back.decode()
    assert "Der EXTENDS Base : STRUCT" in " ".join(back.decode().split())


def test_what_codesys_extends_is_read_edited_and_written_back() -> None:
    project = sfc.loads((HEAD + BASES + MAIN % ("d : Der; f : FbDer;", "n := d.x + f.o;")).encode(), format="iec-text")
    data, _ = sfc.convert(project, "codesys")
    edited = data.replace(b"<Extends>FbBase</Extends>", b"<Extends>Other</Extends>")
    again = sfc.loads(edited)
    again.pou("Main").variables()[0].name = "number"
    saved = sfc.dumps(again)
    assert saved.count(b"<Extends>Other</Extends>") == 1
    assert len(saved.splitlines()) == len(edited.splitlines())


@pytest.mark.parametrize("target", TARGETS)
def test_a_union_is_named_where_the_target_writes_a_structure(target: str) -> None:
    union = "TYPE U : UNION a : DWORD; b : ARRAY[0..3] OF BYTE; END_UNION; END_TYPE\n"
    found = losses(HEAD + union + MAIN % ("u : U;", "u.a := 1;"), target)
    assert "do not share their memory" in found["type U", "union"]


@pytest.mark.parametrize("target", TARGETS)
def test_properties_are_named(target: str) -> None:
    block = """FUNCTION_BLOCK Fb
VAR v : INT; END_VAR
PROPERTY PUBLIC Val : INT
GET
Val := v * 2;
END_GET
END_PROPERTY
END_FUNCTION_BLOCK
"""
    found = losses(HEAD + block + MAIN % ("f : Fb;", "n := f.Val;"), target)
    assert "property `Val` is not declared in" in found["POU Fb / property Val", "property"]


UNITS = """INTERFACE IThing
METHOD M : BOOL END_METHOD
END_INTERFACE
CLASS Motor
VAR PUBLIC speed : INT; END_VAR
METHOD PUBLIC Run speed := speed + 1; END_METHOD
END_CLASS
NAMESPACE Plant
FUNCTION_BLOCK Inner
VAR_OUTPUT q : BOOL; END_VAR
q := NOT q;
END_FUNCTION_BLOCK
END_NAMESPACE
"""


@pytest.mark.parametrize("target", TARGETS)
def test_units_that_are_kept_as_text_are_named_and_so_are_the_types_that_they_declare(target: str) -> None:
    text = UNITS + MAIN % ("m : Motor; i : Plant.Inner;", "m.Run(); i(); n := m.speed;")
    found = losses(text, target)
    assert {"INTERFACE IThing", "CLASS Motor", "NAMESPACE Plant"} == {path for path, what in found if what == "unit"}
    types = [why for (_, what), why in found.items() if what == "undeclared type"]
    assert len(types) == 2
    assert "the type `Motor` is not declared" in types[0]


@pytest.mark.parametrize(("target", "flavour"), [("iec-text", "matiec"), ("plcopen-2.01", "beremiz")])
def test_a_type_that_nothing_declares_is_told_once(target: str, flavour: str) -> None:
    found = losses(UNITS + MAIN % ("m : Motor; i : Plant.Inner;", "i();"), target, flavour)
    assert len([why for why in found.values() if "`Motor`" in why]) == 1
    assert len([why for why in found.values() if "`Plant.Inner`" in why]) == 1


@pytest.mark.parametrize("first", ["CLASS Motor\nEND_CLASS\n", UNITS, "NAMESPACE N\nEND_NAMESPACE\n"])
def test_a_text_that_begins_with_such_a_unit_is_recognised(first: str) -> None:
    project = sfc.loads((first + MAIN % ("", "n := 1;")).encode())
    assert project.source is not None
    assert project.source.format == "iec-text"
    assert [pou.name for pou in project.pous] == ["Main"]


@pytest.mark.parametrize("target", TARGETS)
def test_library_blocks_of_another_tool_are_not_declared(target: str) -> None:
    text = HEAD + MAIN % ("b : HYSTERESIS; t : TON;", "b(IN := n); t(IN := TRUE); n := MyLibrary(n);")
    found = losses(text, target)
    if target == "codesys":  # the tool of the source, which has the library
        assert not found
        return
    why = next(why for (_, what), why in found.items() if what == "undeclared type")
    assert "the type `HYSTERESIS` is declared neither in the source nor in" in why
    assert any("MyLibrary" in why for why in found.values())
    assert not any("`TON`" in why for why in found.values())


LIBRARIES_OF = {"codesys": "CODESYS", "codesys-export": "CODESYS", "twincat": "TwinCAT", "codesys23": "CoDeSys 2.3"}


@pytest.mark.parametrize("source", LIBRARIES_OF)
@pytest.mark.parametrize("target", LIBRARIES_OF)
def test_tools_with_one_language_have_libraries_of_their_own(source: str, target: str) -> None:
    # all have what is standard; Util, with BLINK, is a library of CODESYS V3 and CoDeSys 2.3
    blink = "" if "twincat" in (source, target) else "k : BLINK;"
    declared = f"b : HYSTERESIS; s : STRING; t : TON; c : CTU; e : R_TRIG; r : RTC; {blink}"
    called = "b(IN := n); t(IN := TRUE); c(CU := t.Q); e(CLK := t.Q); r(EN := TRUE); n := LEN(s) + SIZEOF(s)"
    text = HEAD + MAIN % (declared, f"{called} + MyLibrary(n) + elsewhere;")
    written, _ = sfc.convert(sfc.loads(text.encode(), format="iec-text"), source, partial=True)
    _, report = sfc.convert(sfc.loads(written, as_tool=True), target, partial=True)
    found = {item.why.split("`")[1]: item.outcome for item in report.losses if item.what.startswith("undeclared ")}
    of_libraries = dict.fromkeys(("HYSTERESIS", "MyLibrary"), Outcome.NOT_EXECUTED)
    is_other = LIBRARIES_OF[source] != LIBRARIES_OF[target]
    assert found == (of_libraries | {"elsewhere": Outcome.APPROXIMATED} if is_other else {})


BLINKING = """PROGRAM Main
VAR_INPUT x : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
VAR b : BLINK; END_VAR
b(ENABLE := x, TIMELOW := T#20ms, TIMEHIGH := T#30ms);
q := b.OUT;
END_PROGRAM"""


@pytest.mark.parametrize("target", ["simaticml", "plcopen-2.01", "plcopen-1.01"])
def test_blink_of_codesys_is_written_out(target: str) -> None:
    text = sfc.convert(sfc.loads(BLINKING.encode(), format="iec-text"), "codesys")[0]
    project = sfc.loads(text)
    data, report = sfc.convert(project, target)
    assert not report.losses
    assert [pou.name for pou in sfc.loads(data).pous] == ["Main"]
    tool = sfc.loads(data, as_tool=True)
    assert {pou.name for pou in tool.pous} == {"Main", "BLINK"}
    for seed in range(3):
        source = sfc.simulate(project, pou="Main", inputs=sfc.RandomInputs(seed), scans=200)
        written = sfc.simulate(tool, pou="Main", inputs=source)
        assert [*source["q"]] == [*written["q"]]
        assert {*source["q"]} == {True, False}


@pytest.mark.parametrize("target", ["simaticml", "plcopen-2.01"])
def test_blink_comes_home_to_the_library_of_codesys(target: str) -> None:
    chart = "INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S1 := x; END_TRANSITION STEP S1: q(N); END_STEP\n"
    chart += "TRANSITION FROM S1 TO S0 := NOT x; END_TRANSITION\n"
    text = BLINKING + "\n" + BLINKING.replace("Main", "Chart").partition("b(ENABLE")[0] + chart + "END_PROGRAM"
    exported = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "codesys", partial=True)[0]
    data, _ = sfc.convert(sfc.loads(exported, as_tool=True), target)
    assert not [item for item in sfc.convert(sfc.loads(data), "codesys").report.losses if "BLINK" in item.why]


@pytest.mark.parametrize(
    ("target", "old"), [("plcopen-2.01", "NOT Running OR"), ("plcopen-2.01", '"Phase"'), ("simaticml", '"Phase"')]
)
def test_an_edit_of_a_block_that_was_written_out_is_kept(target: str, old: str) -> None:
    text = sfc.convert(sfc.loads(BLINKING.encode(), format="iec-text"), "codesys")[0]
    data = sfc.convert(sfc.loads(text), target)[0].decode()
    new = old.replace("Phase", "Stage").replace("NOT Running", "Running AND NOT OUT AND")
    assert old not in data.replace(old, new)
    assert "BLINK" in [pou.name for pou in sfc.loads(data.replace(old, new).encode()).pous]


@pytest.mark.parametrize("target", ["codesys", "simaticml", "scl"])
def test_what_the_source_does_not_declare_either_needs_a_library(target: str) -> None:
    project = sfc.loads((MAIN % ("b : BLINK;", "b(ENABLE := TRUE);")).encode(), format="iec-text")
    _, report = sfc.convert(project, target, partial=True)
    (item,) = [item for item in report.losses if item.what == "undeclared type"]
    assert item.outcome is Outcome.APPROXIMATED
    assert "`BLINK` is declared neither in the source nor in" in item.why


def test_own_data_of_codesys_is_executed_by_no_other_tool() -> None:
    project = sfc.loads(BLOCKS_WITH_DATA.encode())
    names = {"property Val", "inputassignments", "newerthanthis"}
    for target in ("plcopen-2.01", "simaticml", "scl", "iec-text"):
        _, report = sfc.convert(project, target, partial=True)
        assert {name for name in names if _is_named(report, name)} == names, target
    _, report = sfc.convert(project, "codesys")
    assert report.losses == []


def _is_named(report: ConversionReport, name: str) -> bool:
    return any(item.path.endswith(name) for item in report.with_outcome(Outcome.NOT_EXECUTED))


_DATA = "http://www.3s-software.com/plcopenxml/"
BLOCKS_WITH_DATA = f"""<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0200">
  <fileHeader companyName="" productName="CODESYS" productVersion="CODESYS V3.5 SP16"
    creationDateTime="2024-01-01T00:00:00" />
  <contentHeader name="p.project"><coordinateInfo><fbd><scaling x="1" y="1" /></fbd><ld><scaling x="1" y="1" /></ld>
    <sfc><scaling x="1" y="1" /></sfc></coordinateInfo></contentHeader>
  <types><dataTypes /><pous>
    <pou name="Fb" pouType="functionBlock">
      <interface><localVars><variable name="v"><type><INT /></type></variable></localVars></interface>
      <body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">v := v + 1;</xhtml></ST></body>
      <addData>
        <data name="{_DATA}property" handleUnknown="implementation">
          <Property name="Val" ObjectId="1"><interface><returnType><INT /></returnType></interface>
            <GetAccessor><interface /><body>
              <ST><xhtml xmlns="http://www.w3.org/1999/xhtml">Val := v;</xhtml></ST></body>
            </GetAccessor><addData /></Property>
        </data>
        <data name="{_DATA}newerthanthis" handleUnknown="implementation"><Something /></data>
        <data name="{_DATA}objectid" handleUnknown="discard"><ObjectId>2</ObjectId></data>
      </addData>
    </pou>
    <pou name="Main" pouType="program">
      <interface><localVars><variable name="f"><type><derived name="Fb" /></type>
        <addData><data name="{_DATA}inputassignments" handleUnknown="implementation"><InputAssignments>
          <InputAssignment><Name>v</Name><Value>3</Value></InputAssignment></InputAssignments></data></addData>
      </variable></localVars></interface>
      <body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">f();</xhtml></ST></body>
      <addData><data name="{_DATA}objectid" handleUnknown="discard"><ObjectId>3</ObjectId></data></addData>
    </pou>
  </pous></types>
  <instances><configurations /></instances>
</project>
"""


@pytest.mark.parametrize("target", TARGETS)
def test_no_message_shows_objects_of_python(target: str) -> None:
    union = "TYPE U : UNION a : DWORD; b : ARRAY[0..3] OF BYTE; END_UNION; END_TYPE\n"
    text = HEAD + union + BASES + UNITS + MAIN % ("u : U;", "u.a := 1;")
    _, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target, partial=True)
    for item in report.items:
        assert "ExtensionData(" not in item.why
        assert "=[" not in item.why


def test_a_function_that_the_source_does_not_declare_either_is_told_in_words() -> None:
    source = b"FUNCTION_BLOCK Main VAR_OUTPUT q : BOOL; END_VAR q := Mystery(TRUE); END_FUNCTION_BLOCK"
    (item,) = sfc.convert(sfc.loads(source), "codesys")[1].losses
    assert item.outcome is Outcome.APPROXIMATED
    assert item.why.startswith("the name `Mystery` is declared neither in the source nor in CODESYS")


FLAGGED = """FUNCTION_BLOCK Fb
VAR_OUTPUT n : INT; END_VAR
VAR SFCInit : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := n > 3; END_TRANSITION
TRANSITION FROM S2 TO S1 := TRUE; END_TRANSITION
ACTION Again:
SFCInit := TRUE;
END_ACTION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("target", ["twincat", "iec-text"])
def test_the_variable_of_a_flag_that_codesys_declares_itself_is_declared_in_other_tools(
    target: str, tmp_path: Path
) -> None:
    """Exports of CODESYS list such variables, and the text that was typed does not have them."""
    project = sfc.loads((HEAD + FLAGGED).encode(), format="iec-text")
    (pou,) = project.pous
    assert pou.interface is not None
    assert pou.chart is not None
    pou.interface.declaration = "FUNCTION_BLOCK Fb\nVAR_OUTPUT\n\tn : INT;\nEND_VAR\n"
    pou.chart.settings = SfcSettings(flags={SfcFlag.INIT: FlagUse(use=True, declare=True)})
    source = sfc.loads(sfc.dumps(project, format="codesys"))
    assert [v.name for v in source.pous[0].variables()] == ["n", "SFCInit"]
    path = tmp_path / "result" if target == "twincat" else tmp_path / "result.st"
    report = sfc.save(source, path, format=target)
    assert not [item for item in report.losses if item.path.endswith("SFCInit")]
    text = "".join(each.read_text("utf-8-sig") for each in (path.rglob("*.TcPOU") if path.is_dir() else [path]))
    assert ("SFCInit : BOOL" in text.partition("END_FUNCTION_BLOCK")[0].partition("SFCInit :=")[0]) is (
        target != "twincat"
    )


def test_an_action_that_another_step_would_execute_by_its_name_is_named_in_codesys_2_3() -> None:
    source = sfc.loads((HEAD + FLAGGED.replace("Again", "S1_entry")).encode(), format="iec-text")
    (pou,) = source.pous
    assert pou.chart is not None
    pou.chart.step("S2").entry_action = "S1_entry"
    _, report = sfc.convert(source, "codesys23", partial=True)
    (item,) = [each for each in report.losses if each.path == "POU Fb / step S1 / action S1_entry"]
    assert item.outcome is Outcome.NOT_EXECUTED
    assert "rename the action or the step" in item.why
    assert not any("please report" in each.why for each in report.losses)


def test_a_condition_in_a_form_of_its_tool_is_named_in_all_others() -> None:
    project = sfc.loads((HEAD + FLAGGED.replace("n > 3", "Done")).encode(), format="iec-text")
    (pou,) = project.pous
    assert pou.chart is not None
    pou.transitions.append(NamedTransition(name="Done", body=OpaqueBody(source="twincat", content="<NWL/>")))
    pou.chart.transitions[0].condition = NamedCondition(name="Done")
    _, report = sfc.convert(project, "codesys", partial=True)
    (item,) = [each for each in report.losses if each.what == "condition"]
    assert item.why == "the condition is in a form of its tool that is not read: CODESYS does not execute it"


def test_libraries_of_twincat_are_none_of_codesys() -> None:
    """Both have one language, so that calls of a library of the other were called kept."""
    text = b"FUNCTION_BLOCK Main\nVAR m : FB_MBReadRegs; w : WORD; END_VAR\nm(); w := BE16_TO_HOST(w);\n"
    source = sfc.loads(text + b"END_FUNCTION_BLOCK\n", format="iec-text")
    source.dialect = Dialect.CODESYS
    of_codesys = sfc.loads(sfc.convert(source, "codesys", partial=True)[0])
    of_twincat = sfc.loads(sfc.convert(source, "twincat", partial=True)[0], format="twincat")
    for project, target in ((of_twincat, "codesys"), (of_codesys, "twincat")):
        found = sfc.convert(project, target, partial=True).report.losses
        assert {item.what for item in found} == {"undeclared name", "undeclared type"}, target
    for project, target in ((of_twincat, "iec-text"), (of_codesys, "codesys-export")):
        assert sfc.convert(project, target, partial=True).report.losses == [], target


PRAGMAS = HEAD + (
    "{attribute 'qualified_only'}\n{attribute 'strict'}\nTYPE Mode : (Idle, Run); END_TYPE\n"
    "FUNCTION_BLOCK Drive\nVAR\n    {attribute 'no_init'}\n    n : INT;\n"
    "    {attribute 'monitoring' := 'call'}\n    k : INT;\nEND_VAR\nn := n + 1;\n"
    "{attribute 'call_after_init'}\nMETHOD Setup\n n := 5;\nEND_METHOD\nEND_FUNCTION_BLOCK\n"
    "{attribute 'qualified_only'}\nVAR_GLOBAL\n    x : BOOL;\nEND_VAR\n{attribute 'pack_mode' := '1'}\n"
    "TYPE Job : STRUCT a : BYTE; b : INT; END_STRUCT; END_TYPE\n"
)


def test_attributes_of_declarations_go_to_codesys_and_to_twincat_and_back(tmp_path: Path) -> None:
    project = sfc.loads(PRAGMAS.encode(), format="iec-text")
    project.global_variables[0].name = "Io"
    data, _ = sfc.convert(project, "codesys", partial=True)
    text = " ".join(data.decode("utf-8-sig").split())
    assert text.count('<Attribute Name="qualified_only" Value="" />') == 2
    assert text.count('<Attribute Name="monitoring" Value="call" />') == 1
    assert "urn:plcopen-sfc:declaration" not in text
    (tmp_path / "plc").mkdir()
    sfc.save(sfc.loads(data, as_tool=True), tmp_path / "plc", format="twincat", limit=0)
    for name, line in {"Io.TcGVL": "qualified_only", "Mode.TcDUT": "strict", "Drive.TcPOU": "no_init"}.items():
        [file] = tmp_path.rglob(name)
        assert f"{{attribute '{line}'}}" in file.read_text(encoding="utf-8")
    back, _ = sfc.convert(sfc.load(tmp_path / "plc"), "codesys")
    diff = sfc.diff(sfc.loads(data, as_tool=True), sfc.loads(back, as_tool=True))
    assert [change for change in diff.changes if change.aspect in ("attributes", "")] == []


def test_attributes_that_change_what_a_machine_does_are_told_where_they_have_no_effect() -> None:
    asked = {("POU Drive / method Setup", "attributes")}
    assert losses(PRAGMAS, "codesys").keys() == asked
    found = losses(PRAGMAS, "plcopen-2.01")
    assert "call_after_init" in found["POU Drive / method Setup", "method"]
    assert found["POU Drive / n", "attributes"].endswith(": no_init")
    assert found["type Job", "attributes"].endswith(": pack_mode := 1")
    assert not any("please report" in why for why in found.values())


@pytest.mark.parametrize("target", ["plcopen-2.01", "simaticml", "scl"])
def test_attributes_that_act_are_told_where_a_declaration_has_them_as_typed(target: str) -> None:
    """A translation leaves the typed declaration out, and with it what no source project told any more."""
    project = sfc.loads((HEAD + MAIN % ("", "n := n + 1;")).encode(), format="iec-text")
    interface = project.pou("Main").interface
    assert interface is not None
    interface.declaration = "PROGRAM Main\nVAR\n{attribute 'no_init'}\n{attribute 'hide'}\nn : INT;\nEND_VAR\n"
    items = sfc.convert(project, target, partial=True).report.with_outcome(Outcome.NOT_EXECUTED)
    (told,) = [item for item in items if item.what == "attributes"]
    assert told.path == "POU Main / n"
    assert "no_init" in told.why
    assert "hide" not in told.why
