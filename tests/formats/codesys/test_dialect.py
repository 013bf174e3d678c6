"""Additions of CODESYS and TwinCAT to TC6 XML: read into the model, and written from it as each version writes it."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.formats.codesys import codesys_names as names
from tests.samples import FIXTURES, difference
from tests.snippets import CODESYS, action, block, chart, codes, codesys, jump, pou, round_trip, step
from tests.snippets import drawn_transition as transition

NS = 'xmlns="http://www.plcopen.org/xml/tc6_0200"'
ST = '<body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">x := 1;</xhtml></ST></body>'


def data(name: str, content: str, rule: str = "implementation") -> str:
    return f'<data name="{CODESYS}{name}" handleUnknown="{rule}">{content}</data>'


def add(*parts: str) -> str:
    return f"<addData>{''.join(parts)}</addData>"


def table(**values: str) -> str:
    """``sfc/element`` data; keys are names of `names`."""
    rows = "".join(f'<attribute guid="{getattr(names, key)}">{value}</attribute>' for key, value in values.items())
    return add(data("sfc/element", f'<attributes xmlns="">{rows}</attributes>'))


def loaded_from(*elements: str, release: str = "CODESYS V3.5 SP18", more: str = "") -> m.Project:
    one = chart(*elements).replace("</pou>", f"{more}</pou>")
    return round_trip(codesys(one, release=release))


def network_of(loaded: m.Project) -> m.SfcNetwork:
    found = loaded.pou("Main").sfc
    assert found is not None
    return found


CIRCLE = (transition(1, 0), jump(2, "A", 1))

# -- attributes of chart elements -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("guid", "text", "field", "value"),
    [
        ("COMMENT", "erste\nzweite Zeile", "comment", "erste\nzweite Zeile"),
        ("COMMENT", "  eingerückt", "comment", "  eingerückt"),
        ("EXCLUDE", "TRUE", "exclude", True),
        ("EXCLUDE", "FALSE", "exclude", False),
        ("SYMBOL", "0", "symbol", m.SymbolAccess.UNSPECIFIED),
        ("SYMBOL", "1", "symbol", m.SymbolAccess.NONE),
        ("SYMBOL", "2", "symbol", m.SymbolAccess.READ),
        ("SYMBOL", "3", "symbol", m.SymbolAccess.WRITE),
        ("SYMBOL", "4", "symbol", m.SymbolAccess.READ_WRITE),
        ("DUPLICATION", "TRUE", "duplicate", True),
        ("MIN_TIME", "T#5s", "min_time", "T#5s"),
        ("MAX_TIME", "tMax + T#1s", "max_time", "tMax + T#1s"),
        ("MAIN_ACTION", "A_active", "main_action", "A_active"),
        ("ENTRY_ACTION", "A_entry", "entry_action", "A_entry"),
        ("EXIT_ACTION", "Motor.ACT_Stop", "exit_action", "Motor.ACT_Stop"),
    ],
)
def test_each_attribute_of_a_step_both_ways(guid: str, text: str, field: str, value: object) -> None:
    loaded = loaded_from(step(0, "A", initial=True, more=table(NAME="A", **{guid: text})), *CIRCLE)
    assert getattr(network_of(loaded).steps[0], field) == value
    assert not [d for d in loaded.diagnostics if d.code.startswith("CDS")]
    fresh = sfc.dumps(loaded, fresh=True).decode()
    assert f'<attribute guid="{getattr(names, guid)}">{text}</attribute>'.replace("\n", "\r\n") in fresh


@pytest.mark.parametrize(("number", "monitoring"), list(enumerate(m.Monitoring)))
def test_attributes_of_a_transition(number: int, monitoring: m.Monitoring) -> None:
    more = table(NAME="TRUE", COMMENT="c", EXCLUDE="TRUE", SYMBOL="2", DUPLICATION="FALSE", MONITORING=str(number))
    loaded = loaded_from(step(0, "A", initial=True), transition(1, 0, more=more), jump(2, "A", 1))
    one = network_of(loaded).transitions[0]
    assert (one.comment, one.exclude, one.symbol, one.duplicate) == ("c", True, m.SymbolAccess.READ, False)
    assert one.monitoring is monitoring


def test_attributes_of_an_association() -> None:
    more = table(NAME="q", COMMENT="c", EXCLUDE="TRUE", SYMBOL="4", QUALIFIER="D T#2s")
    line = action(9, "q", ' qualifier="D" duration="T#2s" indicator=""', more)
    loaded = loaded_from(step(0, "A", initial=True), block(8, 0, line), *CIRCLE)
    (one,) = network_of(loaded).steps[0].actions
    assert (one.comment, one.exclude, one.symbol) == ("c", True, m.SymbolAccess.READ_WRITE)
    assert one.extension_data is None
    one.duration = "T#3s"
    assert sfc.dumps(loaded).count(b"T#3s") == 2


def test_attributes_of_jumps_and_branches() -> None:
    loaded = sfc.load(FIXTURES / "codesys/sorting_conveyor.xml")
    symbols = [s for c in loaded.charts() for s in c.chart.drawing.symbols]  # type: ignore[union-attr]
    branches = [s for s in symbols if s.kind.value.endswith("Divergence")]
    assert all(s.name is not None and s.name.startswith("Branch") for s in branches)
    assert all(s.exclude is False for s in branches)
    assert all(s.exclude is False for s in symbols if s.kind is m.SymbolKind.JUMP)


def test_unknown_attributes_are_carried() -> None:
    guid = "11111111-2222-3333-4444-555555555555"
    more = table(NAME="A").replace("</attributes>", f'<attribute guid="{guid}">neu</attribute></attributes>')
    loaded = loaded_from(step(0, "A", initial=True, more=more), *CIRCLE)
    extension_data = network_of(loaded).steps[0].extension_data
    assert extension_data is not None
    assert guid in extension_data.data[0].content
    assert f'<attribute guid="{guid}">neu</attribute>'.encode() in sfc.dumps(loaded, fresh=True)
    network_of(loaded).steps[0].max_time = "T#1s"
    assert f'<attribute guid="{guid}">neu</attribute>'.encode() in sfc.dumps(loaded)


@pytest.mark.parametrize("value", ["maybe", "7", "-1"])
def test_values_that_nobody_knows_are_carried(value: str) -> None:
    loaded = loaded_from(step(0, "A", initial=True, more=table(NAME="A", SYMBOL=value)), *CIRCLE)
    assert network_of(loaded).steps[0].symbol in (None, m.SymbolAccess.UNSPECIFIED)
    assert f">{value}<".encode() in sfc.dumps(loaded, fresh=True)


def test_a_name_attribute_that_disagrees_is_reported_and_stays_in_the_file() -> None:
    content = codesys(chart(step(0, "A", initial=True, more=table(NAME="B")), *CIRCLE))
    loaded = sfc.loads(content)
    assert codes(loaded) == ["CDS101"]
    assert network_of(loaded).steps[0].name == "A"
    network_of(loaded).transitions[0].condition = "FALSE"  # type: ignore[assignment]
    assert sfc.dumps(loaded) == content.replace(b">TRUE<", b">FALSE<")
    # written from the model alone, the element is right
    assert codes(sfc.loads(sfc.dumps(loaded, fresh=True))) == []


def test_a_name_attribute_with_the_blanks_of_a_formatter_follows_a_rename() -> None:
    text = (FIXTURES / "training-chain" / "codesys.xml").read_bytes().decode("utf-8-sig")
    text = re.sub(rf"(\n +)(<attribute guid=\"{names.NAME}\">[^<]+)", r"\1\2\1", text)
    loaded = sfc.loads(text.encode())
    assert codes(loaded) == []
    assert sfc.dumps(loaded) == text.encode()
    loaded.rename("Ablauf.S2", "Wait")
    loaded.pou("Ablauf").chart.transitions[0].condition = "B5"  # type: ignore[assignment, union-attr]
    changed = [line.strip() for hunk in difference(text.encode(), sfc.dumps(loaded)) for line in hunk.new]
    name = f'<attribute guid="{names.NAME}">'
    assert changed == ["<expression>B5</expression>", f"{name}B5", '<step localId="1" name="Wait">', f"{name}Wait"]


@pytest.mark.parametrize(
    ("release", "step_has", "transition_has"),
    [
        ("CODESYS V3.5 SP4", "NAME EXCLUDE SYMBOL INITIAL", "NAME EXCLUDE SYMBOL"),
        ("CODESYS V3.5 SP8 Patch 2", "NAME EXCLUDE SYMBOL INITIAL", "NAME EXCLUDE SYMBOL"),
        ("3.5.6.0", "NAME EXCLUDE SYMBOL INITIAL", "NAME EXCLUDE SYMBOL"),
        ("3.5.8.10", "NAME EXCLUDE SYMBOL INITIAL", "NAME EXCLUDE SYMBOL"),
        ("3.5.10.30", "NAME EXCLUDE SYMBOL INITIAL DUPLICATION", "NAME EXCLUDE SYMBOL DUPLICATION"),
        ("3.5.13.20", "NAME EXCLUDE SYMBOL INITIAL DUPLICATION", "NAME EXCLUDE SYMBOL DUPLICATION MONITORING"),
        ("CODESYS V3.5 SP14", "NAME EXCLUDE SYMBOL INITIAL DUPLICATION", "NAME EXCLUDE SYMBOL DUPLICATION MONITORING"),
        ("CODESYS V3.5 SP18", "NAME EXCLUDE SYMBOL INITIAL DUPLICATION", "NAME EXCLUDE SYMBOL DUPLICATION MONITORING"),
        ("CODESYS V3.5 SP21", "NAME EXCLUDE SYMBOL INITIAL DUPLICATION", "NAME EXCLUDE SYMBOL DUPLICATION MONITORING"),
    ],
)
def test_a_new_step_gets_the_attributes_of_the_files_version(release: str, step_has: str, transition_has: str) -> None:
    loaded = loaded_from(step(0, "A", initial=True, more=table(NAME="A")), *CIRCLE, release=release)
    network = network_of(loaded)
    new = network.add_step("Neu")
    old = network.transitions[0]
    old.targets = [new.id]
    network.add_transition(new, network.step("A"), "bGo")
    text = sfc.dumps(loaded).decode()
    by_guid = {guid: name for name, guid in vars(names).items() if isinstance(guid, str) and len(guid) == 36}
    element = text[text.index('name="Neu"') :]
    assert [by_guid[g] for g in re.findall(r'guid="([^"]*)"', element[: element.index("</step>")])] == step_has.split()
    element = next(e for e in re.findall(r"<transition .*?</transition>", text, re.DOTALL) if ">bGo<" in e)
    assert [by_guid[g] for g in re.findall(r'guid="([^"]*)"', element)] == transition_has.split()


# -- settings ---------------------------------------------------------------------------------------------------------


def settings(flags: str) -> str:
    return data(
        "sfcsettings",
        "<SFCSettings><LibTitle>IecSfc</LibTitle><LibCompany>System</LibCompany><LibVersion>3.4.2.0</LibVersion>"
        "<LibNamespace/><CalcActiveTransOnly>true</CalcActiveTransOnly><UseDefaults>false</UseDefaults>"
        f"<Flags>{flags}</Flags></SFCSettings>",
    )


@pytest.mark.parametrize("flag", list(m.SfcFlag))
@pytest.mark.parametrize("use", [True, False])
@pytest.mark.parametrize("declare", [True, False])
def test_each_flag(flag: m.SfcFlag, *, use: bool, declare: bool) -> None:
    text = f'<{flag.value} Declare="{str(declare).lower()}" Use="{str(use).lower()}"/>'
    loaded = loaded_from(step(0, "A", initial=True), *CIRCLE, more=add(settings(text)))
    found = network_of(loaded).settings
    assert found is not None
    assert found.flags == {flag: m.FlagUse(use=use, declare=declare)}
    assert found.library == m.RuntimeLibrary(title="IecSfc", company="System", version="3.4.2.0")
    assert (found.active_transitions_only, found.use_defaults) == (True, False)


def test_flags_that_nobody_knows_are_flags_too() -> None:
    loaded = loaded_from(step(0, "A"), *CIRCLE, more=add(settings('<Future Declare="true" Use="true"/>')))
    found = network_of(loaded).settings
    assert found is not None
    assert found.other_flags == {"Future": m.FlagUse(use=True, declare=True)}


def test_one_flag_switched_is_one_line() -> None:
    path = FIXTURES / "codesys/device_export.xml"
    loaded = sfc.load(path)
    chart_ = next(c.chart for c in loaded.charts() if c.chart.settings is not None)
    assert {m.SfcFlag.CURRENT_STEPS, m.SfcFlag.META_STEPS} <= chart_.settings.flags.keys()  # type: ignore[union-attr]
    use = chart_.settings.flags[m.SfcFlag.TIP]  # type: ignore[union-attr]
    use.use = not use.use
    (hunk,) = difference(path.read_bytes(), sfc.dumps(loaded))
    assert len(hunk.old) == len(hunk.new) == 1
    assert "<Tip " in hunk.old[0]


def test_settings_in_an_action() -> None:
    body = f"<body><SFC>{step(0, 'A_Go', initial=True)}</SFC></body>"
    one = pou(f'<actions><action name="Go">{body}{add(settings(""))}</action></actions>{ST}')
    loaded = round_trip(codesys(one))
    (found,) = [c.chart for c in loaded.charts()]
    assert found.settings is not None


# -- objects ----------------------------------------------------------------------------------------------------------


def test_objects_of_a_pou() -> None:
    declaration = "PROGRAM Main&#10;VAR // {attribute 'x'}&#10;END_VAR&#10;"
    plain = data(
        "interfaceasplaintext",
        f'<InterfaceAsPlainText><xhtml xmlns="http://www.w3.org/1999/xhtml">{declaration}</xhtml></InterfaceAsPlainText>',
    )
    method = data(
        "method",
        '<Method name="Start" ObjectId="m-1"><interface><returnType><BOOL/></returnType></interface>'
        f"{ST}{add(plain)}</Method>",
    )
    object_id = data("objectid", "<ObjectId>p-1</ObjectId>", "discard")
    loaded = round_trip(codesys(pou(f"<interface/>{ST}{add(method, plain, object_id)}")))
    one = loaded.pou("Main")
    assert one.object_id == "p-1"
    assert one.interface is not None
    assert one.interface.declaration == "PROGRAM Main\nVAR // {attribute 'x'}\nEND_VAR\n"
    assert [(x.name, x.object_id) for x in one.methods] == [("Start", "m-1")]
    assert one.methods[0].interface.declaration is not None  # type: ignore[union-attr]
    assert [name for name, _, _ in one.named_bodies()] == ["Main", "Main.Start"]


def test_pous_in_the_three_places() -> None:
    def hidden(name: str) -> str:
        return data("pou", pou(ST, name=name))

    application = data("application", f'<resource name="App">{add(hidden("P2"))}</resource>')
    device = f'<configuration name="Dev"><resource name="Plc">{add(hidden("P3"))}</resource></configuration>'
    loaded = round_trip(codesys(pou(ST, name="P1"), instances=device, end=add(application)))
    assert {p.name: p.place for p in loaded.pous} == {
        "P1": "",
        "P2": "application/App",
        "P3": "configuration/Dev/resource/Plc",
    }
    loaded.pou("P2").place = ""
    fresh = sfc.loads(sfc.dumps(loaded, fresh=True))
    assert {p.name: p.place for p in fresh.pous}["P2"] == ""


def test_project_structure() -> None:
    tree = (
        '<ProjectStructure><Folder Name="F"><Object Name="Main" ObjectId="1"><Object Name="Go" ObjectId="2"/></Object>'
        "</Folder></ProjectStructure>"
    )
    loaded = round_trip(codesys(pou(ST), end=add(data("projectstructure", tree, "discard"))))
    assert loaded.tree is not None
    (folder,) = loaded.tree
    assert (folder.folder, folder.children[0].object_id, folder.children[0].children[0].name) == (True, "1", "Go")


def test_task_settings() -> None:
    task = (
        '<configuration name="D"><resource name="R"><task name="T" priority="1">'
        + add(
            data(
                "tasksettings",
                '<TaskSettings KindOfTask="Cyclic" Interval="20" IntervalUnit="ms" Event="">'
                '<Watchdog Enabled="true" Time="5" TimeUnit="ms" Sensitivity="1"/></TaskSettings>',
            ),
            data("objectid", "<ObjectId>t-1</ObjectId>", "discard"),
        )
        + "</task></resource></configuration>"
    )
    loaded = round_trip(codesys(instances=task))
    one = loaded.configurations[0].resources[0].tasks[0]
    assert one.object_id == "t-1"
    assert one.settings is not None
    assert (one.settings.kind, one.settings.interval, one.settings.interval_unit) == ("Cyclic", "20", "ms")
    assert one.settings.watchdog == m.TaskWatchdog(enabled=True, time="5", time_unit="ms", sensitivity="1")


def test_execute_block_and_call_types() -> None:
    block_ = (
        '<block localId="1" typeName="EXECUTE"><position x="0" y="0"/><inputVariables/><inOutVariables/>'
        "<outputVariables/>"
        + add(
            data("fbdcalltype", '<CallType xmlns="">execute</CallType>'),
            data("stcode", '<STCode xmlns="">a := b &lt; 3;</STCode>'),
        )
        + "</block>"
    )
    loaded = round_trip(codesys(pou(f"<body><FBD>{block_}</FBD></body>")))
    body = loaded.pou("Main").body
    assert isinstance(body, m.FbdBody)
    node = body.networks[0].nodes[0]
    assert isinstance(node, m.Block)
    assert (node.call, node.code) == (m.BlockCall.EXECUTE, "a := b < 3;")


@pytest.mark.parametrize("name", ["sorting_conveyor", "distribution_belt", "device_export"])
def test_fixtures_are_written_with_the_tools_handwriting(name: str) -> None:
    fresh = sfc.dumps(sfc.load(FIXTURES / f"codesys/{name}.xml"), fresh=True)
    assert fresh.startswith(b'\xef\xbb\xbf<?xml version="1.0" encoding="utf-8"?>\r\n<project xmlns=')
    assert fresh.count(b"\n") == fresh.count(b"\r\n")
    assert not re.search(rb"[^ ]/>", fresh)
    assert fresh.endswith(b"</project>")
    assert b"xmlns:" not in fresh
