"""Programs, tasks and addresses of other tools in TIA Portal: instance data blocks, organization blocks and tags."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import Outcome
from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.model.compare import differences
from plcopen_sfc.semantics.profile import default_profile
from plcopen_sfc.semantics.programs import Controller
from plcopen_sfc.semantics.subjects import resolve
from tests.samples import FIXTURES

TARGETS = ["simaticml", "scl"]
STATION = """
VAR_GLOBAL
    Start AT %IX0.3 : BOOL;
    Valve AT %QX1.0 : BOOL;
END_VAR
PROGRAM Main
VAR_EXTERNAL Start : BOOL; Valve : BOOL; END_VAR
Valve := Start;
END_PROGRAM
CONFIGURATION Plc
    RESOURCE Cpu ON Plc
        {}
    END_RESOURCE
END_CONFIGURATION
"""


def codesys(
    *pous: str, schedule: m.TaskSettings | None = None, lists: list[m.VariableSection] | None = None
) -> m.Project:
    """A project of CODESYS with these POUs, whose task calls the first."""
    project = sfc.loads("\n".join(pous).encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    called = [m.PouInstance(name=project.pous[0].name)]
    tasks = [m.Task(name="MainTask", instances=called, settings=schedule or m.TaskSettings(kind="Freewheeling"))]
    project.applications = [m.Resource(name="App", tasks=tasks, global_variables=lists or [])]
    return project


def io_list(*variables: tuple[str, str, str]) -> m.VariableSection:
    """A list of global variables at addresses: name, type, address."""
    made = [
        m.Variable(name=name, type=m.ElementaryType(name=m.Elementary(kind)), address=address)
        for name, kind, address in variables
    ]
    return m.VariableSection(kind=m.SectionKind.GLOBAL, name="GVL_IO", variables=made)


def told(report: sfc.ConversionReport, outcome: Outcome) -> list[tuple[str, str]]:
    return [(item.what, item.path) for item in report.with_outcome(outcome)]


@pytest.mark.parametrize("target", TARGETS)
def test_a_task_without_interval_is_a_program_cycle(target: str) -> None:
    source = codesys("PROGRAM PLC_PRG VAR n : INT; END_VAR n := n + 1; END_PROGRAM")
    data, report = sfc.convert(source, target, strict=True)
    assert not report.losses
    seen = sfc.loads(data, format=target, as_tool=True)
    (instance,) = seen.data_blocks
    assert (instance.name, instance.kind, instance.type_name) == ("PLC_PRG_DB", m.DataBlockKind.INSTANCE, "PLC_PRG")
    caller = seen.pou("MainTask")
    assert (caller.kind, caller.number) == (m.PouKind.ORGANIZATION_BLOCK, 123 if target == "simaticml" else None)
    running = Controller(seen).instance("MainTask")
    running.scan()
    running.scan()
    assert running["PLC_PRG_DB.n"] == 2
    assert "<SecondaryType>ProgramCycle</SecondaryType>" in data.decode() or target == "scl"


def test_an_organization_block_runs_what_the_task_ran() -> None:
    source = sfc.loads(STATION.format("PROGRAM Line : Main;").encode(), format="iec-text")
    data, report = sfc.convert(source, "simaticml", strict=True)
    assert not report.losses
    seen = sfc.loads(data, as_tool=True)
    assert [(tag.name, tag.address) for table in seen.tag_tables for tag in table.tags] == [
        ("Start", "%I0.3"),
        ("Valve", "%Q1.0"),
    ]
    caller = Controller(seen).instance("Programs")
    outputs = []
    for start in (False, True, True, False, False):
        caller["Start"] = start
        caller.scan()
        outputs.append(caller["Valve"])
    assert outputs == [False, True, True, False, False]


@pytest.mark.slow
@pytest.mark.parametrize(("target", "caller"), [("codesys", "MainTask"), ("plcopen", "Programs")])
def test_the_machine_of_a_plc_runs_as_a_whole_there_and_back(target: str, caller: str) -> None:
    """OB1 calls the blocks, with inputs and outputs at addresses: no scan of the whole differs in either direction.

    OB1 gives the sequencer no inputs, so that most of its steps are not reached: these runs are no proof of it.
    """
    source = sfc.load(FIXTURES / "simaticml-plc")
    there = sfc.loads(sfc.convert(source, target, partial=True)[0], as_tool=True)
    back = sfc.loads(sfc.convert(there, "simaticml", partial=True)[0], as_tool=True)
    renamed = {"Production_data.Production": "Production", "GlobalVariables.Production": "Production_data.Production"}
    for one, other, program in ((source, there, "Main"), (there, back, caller)):
        verdict = equivalent(
            resolve(one, "Main"),
            resolve(other, program),
            profile=(default_profile(one), default_profile(other)),
            inputs=renamed,
            free_inputs="all",
            delay="auto",
            cap=200,
            runs=5,
            scans=60,
        )
        assert not verdict.different, verdict
        assert {name.rpartition(".")[2] for name in verdict.inputs} == {"Start", "Stop", "GuardClosed", "done"}


def test_the_cycle_time_of_an_interrupt_is_left_to_the_user() -> None:
    settings = m.TaskSettings(kind="Cyclic", interval="t#20ms")
    source = codesys("PROGRAM PLC_PRG VAR n : INT; END_VAR n := n + 1; END_PROGRAM", schedule=settings)
    data, report = sfc.convert(source, "simaticml")
    assert told(report, Outcome.NOT_EXECUTED) == []
    (item,) = report.with_outcome(Outcome.APPROXIMATED)
    assert (item.what, item.path) == ("interval", "task MainTask")
    assert "set the cycle time of MainTask to t#20ms" in item.why
    assert "<SecondaryType>CyclicInterrupt</SecondaryType>" in data.decode()
    with pytest.raises(sfc.LossError):
        sfc.convert(source, "simaticml", strict=True)


@pytest.mark.parametrize("target", TARGETS)
def test_a_task_at_an_event_has_no_organization_block(target: str) -> None:
    settings = m.TaskSettings(kind="Event", event="xStart")
    source = codesys("PROGRAM PLC_PRG VAR n : INT; END_VAR n := n + 1; END_PROGRAM", schedule=settings)
    data, report = sfc.convert(source, target, partial=True)
    assert told(report, Outcome.NOT_EXECUTED) == [("task", "task MainTask")]
    seen = sfc.loads(data, format=target, as_tool=True)
    assert [pou.name for pou in seen.pous] == ["PLC_PRG"]


@pytest.mark.parametrize("target", TARGETS)
def test_a_program_that_no_task_calls_has_its_data_only(target: str) -> None:
    source = sfc.loads(b"PROGRAM Alone VAR n : INT; END_VAR n := n + 1; END_PROGRAM", format="iec-text")
    data, report = sfc.convert(source, target, strict=True)
    assert any("no task calls it" in item.why for item in report.with_outcome(Outcome.TRANSLATED))
    seen = sfc.loads(data, format=target, as_tool=True)
    assert ([pou.name for pou in seen.pous], [block.name for block in seen.data_blocks]) == (["Alone"], ["Alone_DB"])


@pytest.mark.parametrize("target", TARGETS)
def test_a_program_is_called_and_read_by_its_data_block(target: str) -> None:
    source = codesys(
        "PROGRAM PLC_PRG VAR total : INT; END_VAR Counting(); Counting(); total := Counting.n; END_PROGRAM",
        "PROGRAM Counting VAR n : INT; END_VAR n := n + 1; END_PROGRAM",
    )
    data, report = sfc.convert(source, target, strict=True)
    assert not report.losses
    seen = sfc.loads(data, format=target, as_tool=True)
    caller = Controller(seen).instance("MainTask")
    caller.scan()
    caller.scan()
    assert caller["PLC_PRG_DB.total"] == 4
    back = again(data, target, "codesys")
    # a source in SCL has what is called before what calls it
    pairs = [(each, back.pou(each.name)) for each in source.pous]
    assert [next(differences(*pair), None) for pair in pairs] == [None, None]
    assert len(back.pous) == len(pairs)


def again(data: bytes, target: str, back: str) -> m.Project:
    """A converted project, converted back."""
    return sfc.loads(sfc.convert(sfc.loads(data, format=target), back, partial=True)[0])


def test_each_instance_of_a_program_has_data_of_its_own() -> None:
    tasks = "TASK Fast(PRIORITY := 1); PROGRAM A WITH Fast : Main; PROGRAM B WITH Fast : Main;"
    source = sfc.loads(STATION.format(tasks).encode(), format="iec-text")
    data, report = sfc.convert(source, "simaticml", partial=True)
    assert told(report, Outcome.NOT_EXECUTED) == []
    seen = sfc.loads(data, as_tool=True)
    assert [block.name for block in seen.data_blocks] == ["Main_DB", "Main_DB_1"]
    caller = seen.pou("Fast").body
    assert isinstance(caller, m.FbdBody)
    boxes = [node for network in caller.networks for node in network.nodes if isinstance(node, m.Block)]
    assert [box.instance for box in boxes] == ['"Main_DB"', '"Main_DB_1"']


def test_a_version_without_program_text_calls_programs_too() -> None:
    """Only a chart: the versions before V15 export no SCL."""
    source = sfc.loads(CHART.replace("Start", "Go").encode(), format="iec-text")
    source.configurations = [
        m.Configuration(
            name="Plc", resources=[m.Resource(name="R", instances=[m.PouInstance(name="I", type_name="Main")])]
        )
    ]
    data, report = sfc.convert(source, "simaticml-V14 SP1", strict=True)
    assert not report.losses
    assert [pou.name for pou in sfc.loads(data, as_tool=True).pous] == ["Main", "Programs"]


def test_the_name_of_a_data_block_is_free() -> None:
    source = codesys(
        "PROGRAM PLC_PRG VAR n : INT; END_VAR n := n + 1; END_PROGRAM",
        "FUNCTION_BLOCK PLC_PRG_DB VAR n : INT; END_VAR END_FUNCTION_BLOCK",
        "FUNCTION_BLOCK MainTask VAR n : INT; END_VAR END_FUNCTION_BLOCK",
    )
    data, report = sfc.convert(source, "simaticml", strict=True)
    assert not report.losses
    seen = sfc.loads(data, as_tool=True)
    assert [block.name for block in seen.data_blocks] == ["PLC_PRG_DB_1"]
    assert [pou.name for pou in seen.pous] == ["PLC_PRG", "PLC_PRG_DB", "MainTask", "MainTask_1"]


def test_addresses_of_a_list_are_tags() -> None:
    lists = [io_list(("Start", "BOOL", "%IX0.3"), ("Level", "INT", "%IW2"), ("Valve", "BOOL", "%QX1.0"))]
    text = "PROGRAM PLC_PRG VAR n : INT; END_VAR Valve := GVL_IO.Start; n := GVL_IO.Level; END_PROGRAM"
    source = codesys(text, lists=lists)
    data, report = sfc.convert(source, "simaticml", strict=True)
    assert not report.losses
    seen = sfc.loads(data, as_tool=True)
    (table,) = seen.tag_tables
    assert (table.name, [(tag.name, tag.address) for tag in table.tags]) == (
        "GVL_IO",
        [("Start", "%I0.3"), ("Level", "%IW4"), ("Valve", "%Q1.0")],
    )
    body = seen.pou("PLC_PRG").body
    assert isinstance(body, m.StBody)
    assert body.text.split(";")[:2] == ['"Valve" := "Start"', ' #n := "Level"']
    back = again(data, "simaticml", "codesys").pou("PLC_PRG").body
    assert isinstance(back, m.StBody)
    assert back.text == "GVL_IO.Valve := GVL_IO.Start; n := GVL_IO.Level;"


def test_variables_of_no_list_are_in_a_data_block() -> None:
    text = """
    CONFIGURATION Plc
    VAR_GLOBAL Total : INT := 5; Start AT %IX0.3 : BOOL; END_VAR
    VAR_GLOBAL RETAIN Kept : INT; END_VAR
    END_CONFIGURATION
    PROGRAM Main
    VAR_EXTERNAL Total : INT; Kept : INT; Start : BOOL; END_VAR
    IF Start THEN Total := Total + 1; Kept := Total; END_IF;
    END_PROGRAM
    """
    source = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(source, "simaticml", strict=True)
    assert not report.losses
    seen = sfc.loads(data, as_tool=True)
    block = next(block for block in seen.data_blocks if block.name == "GlobalVariables")
    assert block.interface is not None
    assert [(v.name, v.attributes.get("Remanence")) for v in block.interface.variables()] == [
        ("Total", None),
        ("Kept", "Retain"),
    ]
    body = seen.pou("Main").body
    assert isinstance(body, m.StBody)
    assert '"GlobalVariables".Kept := "GlobalVariables".Total;' in body.text
    back = again(data, "simaticml", "plcopen-2.01").pou("Main").body
    assert isinstance(back, m.StBody)
    assert "Kept := Total;" in back.text


def test_a_text_drawn_in_a_network_does_not_empty_it() -> None:
    text = m.CommentBox(id=9, content="look here")
    nodes = [m.InputVariable(id=1, expression="a"), text]
    nodes.append(m.OutputVariable(id=2, expression="q", input=m.InputPin(connections=[m.Connection(source=1)])))
    source = sfc.loads(b"FUNCTION_BLOCK F VAR a : BOOL; q : BOOL; END_VAR END_FUNCTION_BLOCK", format="iec-text")
    source.pous[0].bodies = [m.FbdBody(networks=[m.LogicNetwork(nodes=nodes)])]
    data, report = sfc.convert(source, "simaticml", strict=True)
    assert (report.losses, report.with_outcome(Outcome.DROPPED)) == ([], [])
    (network,) = sfc.loads(data, as_tool=True).pous[0].bodies[0].networks  # type: ignore[union-attr]
    assert [node.kind for node in network.nodes] == ["coil"]
    (network,) = sfc.loads(data).pous[0].bodies[0].networks  # type: ignore[union-attr]
    assert [node.kind for node in network.nodes if node.kind == "comment"] == ["comment"]


def test_constants_of_a_list_are_user_constants() -> None:
    limit = m.Variable(name="LIMIT", type=m.ElementaryType(name=m.Elementary.INT), initial=m.SimpleValue(text="12"))
    lists = [m.VariableSection(kind=m.SectionKind.GLOBAL, name="GVL", constant=True, variables=[limit])]
    source = codesys("PROGRAM PLC_PRG VAR n : INT; END_VAR n := GVL.LIMIT + LIMIT; END_PROGRAM", lists=lists)
    data, report = sfc.convert(source, "simaticml", strict=True)
    assert not report.losses
    seen = sfc.loads(data, as_tool=True)
    (constant,) = seen.tag_tables[0].constants
    assert (constant.name, constant.initial, seen.data_blocks[0].name) == ("LIMIT", limit.initial, "PLC_PRG_DB")
    caller = Controller(seen).instance("MainTask")
    caller.scan()
    assert caller["PLC_PRG_DB.n"] == 24
    back = again(data, "simaticml", "codesys").pou("PLC_PRG").body
    assert isinstance(back, m.StBody)
    assert back.text == "n := GVL.LIMIT_2 + GVL.LIMIT_2;"  # CODESYS has an operator of this name


@pytest.mark.parametrize(
    ("called", "outcome"), [([], Outcome.TRANSLATED), ([m.PouInstance(name="Elsewhere")], Outcome.NOT_EXECUTED)]
)
def test_a_task_that_calls_nothing_here_has_no_organization_block(
    called: list[m.PouInstance], outcome: Outcome
) -> None:
    source = codesys("PROGRAM PLC_PRG VAR n : INT; END_VAR n := n + 1; END_PROGRAM")
    source.applications[0].tasks[0].instances = called
    data, report = sfc.convert(source, "simaticml", partial=True)
    assert ("task", "task MainTask") in told(report, outcome)
    assert [pou.name for pou in sfc.loads(data, as_tool=True).pous] == ["PLC_PRG"]


BLOCKS = """
FUNCTION_BLOCK Axis
VAR Lamp AT %QX2.0 : BOOL; Own AT %QX2.1 : BOOL; END_VAR
Lamp := NOT Lamp; Own := Lamp;
END_FUNCTION_BLOCK
PROGRAM PLC_PRG
VAR Lamp AT %QX1.0 : BOOL; Start AT %IX0.0 : BOOL; Level AT %IW1 : INT; first : Axis; n : INT; END_VAR
Lamp := Start; n := Level; first();
END_PROGRAM
"""


def test_addresses_in_blocks_are_tags() -> None:
    source = sfc.loads(BLOCKS.encode(), format="iec-text")
    data, report = sfc.convert(source, "simaticml", strict=True)
    assert not report.losses
    seen = sfc.loads(data, as_tool=True)
    tags = [(tag.name, tag.address) for table in seen.tag_tables for tag in table.tags]
    assert tags == [
        ("Axis_Lamp", "%Q2.0"),
        ("Own", "%Q2.1"),
        ("PLC_PRG_Lamp", "%Q1.0"),
        ("Start", "%I0.0"),
        ("Level", "%IW2"),
    ]
    body = seen.pou("PLC_PRG").body
    assert isinstance(body, m.StBody)
    assert body.text == '"PLC_PRG_Lamp" := "Start"; #n := "Level"; #first();'
    back = again(data, "simaticml", "plcopen-2.01")
    assert [pou.body.text for pou in back.pous if isinstance(pou.body, m.StBody)] == [
        "Lamp := NOT Lamp; Own := Lamp;",
        "Lamp := Start; n := Level; first();",
    ]
    assert [v.address for v in back.pou("PLC_PRG").variables()] == ["%QX1.0", "%IX0.0", "%IW1", None, None]


CHART = """
PROGRAM Main
VAR Start AT %IX0.3 : BOOL; Valve AT %QX1.0 : BOOL; END_VAR
INITIAL_STEP Ready: END_STEP
TRANSITION FROM Ready TO Filling := Start; END_TRANSITION
STEP Filling: Valve(N); END_STEP
TRANSITION FROM Filling TO Ready := NOT Start; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.parametrize("target", ["simaticml", "scl"])
@pytest.mark.parametrize(("configured", "outcome"), [("", "approximated"), ("Main.f.v AT %IW0 : INT;", "not executed")])
def test_an_address_that_the_source_leaves_open_is_no_loss(target: str, configured: str, outcome: str) -> None:
    block = "FUNCTION_BLOCK F VAR v AT %I* : INT; n : INT; END_VAR n := v; END_FUNCTION_BLOCK\n"
    main = "PROGRAM Main VAR f : F; END_VAR f(); END_PROGRAM\n"
    config = f"VAR_CONFIG {configured} END_VAR\n" if configured else ""
    project = sfc.loads(
        f"{{plcopen_sfc format := 1}}\n{{plcopen_sfc project.dialect := 'codesys'}}\n{block}{main}{config}".encode(),
        format="iec-text",
    )
    report = sfc.convert(project, target, partial=True).report
    assert {item.outcome.value for item in report.losses if item.what == "address"} == {outcome}


def test_a_chart_drives_the_tag_at_the_address() -> None:
    source = sfc.loads(CHART.encode(), format="iec-text")
    data, report = sfc.convert(source, "simaticml", strict=True, limit=20)
    assert not report.losses
    chart = sfc.loads(data, as_tool=True).pou("Main").chart
    assert chart is not None
    assert chart.step("Filling").actions[0].target == '"Valve"'
    assert report.compared["POU Main"].startswith("equal")


@pytest.mark.parametrize(
    ("declared", "what"), [("AT %QX0.0 : BOOL := TRUE", "start value"), ("AT %QW0 : ARRAY[0..1] OF INT", "no address")]
)
def test_what_a_tag_does_not_say_of_a_variable_is_told(declared: str, what: str) -> None:
    source = sfc.loads(f"PROGRAM P VAR x {declared}; END_VAR ; END_PROGRAM".encode(), format="iec-text")
    report = sfc.convert(source, "simaticml", partial=True).report
    assert any(what in item.why for item in report.with_outcome(Outcome.NOT_EXECUTED))


@pytest.mark.parametrize(
    ("variable", "why"),
    [
        (("PLC_PRG", "BOOL", "%IX0.3"), "not connected to %I0.3"),  # the name of a block
        (("Start", "BOOL", "%IX0.9"), "not connected to %IX0.9"),  # S7 has eight bits in a byte
    ],
)
def test_what_no_tag_can_be_stays_in_the_data_block(variable: tuple[str, str, str], why: str) -> None:
    lists = [io_list(variable)]
    source = codesys(f"PROGRAM PLC_PRG VAR b : BOOL; END_VAR b := GVL_IO.{variable[0]}; END_PROGRAM", lists=lists)
    data, report = sfc.convert(source, "simaticml", partial=True)
    assert any(why in item.why for item in report.with_outcome(Outcome.NOT_EXECUTED))
    assert [block.name for block in sfc.loads(data, as_tool=True).data_blocks] == ["GVL_IO", "PLC_PRG_DB"]


def test_a_folder_has_a_file_for_each_block(tmp_path: Path) -> None:
    lists = [io_list(("Start", "BOOL", "%IX0.3"))]
    source = codesys("PROGRAM PLC_PRG VAR b : BOOL; END_VAR b := GVL_IO.Start; END_PROGRAM", lists=lists)
    report = sfc.save(source, f"{tmp_path}/out/", format="simaticml", strict=True)
    assert not report.losses
    files = {path.relative_to(tmp_path / "out").as_posix() for path in (tmp_path / "out").rglob("*.xml")}
    blocks = {f"Program blocks/{name}.xml" for name in ("PLC_PRG", "PLC_PRG_DB", "MainTask")}
    assert blocks | {"PLC tags/GVL_IO.xml"} <= files


@pytest.mark.parametrize(
    "declared",
    [
        "VAR_EXTERNAL Total : INT; END_VAR VAR_INPUT Start : BOOL; END_VAR VAR n : INT; END_VAR",
        "VAR_INPUT Start : BOOL; END_VAR VAR k : INT; a AT %QX0.0 : BOOL; n : INT; END_VAR",
    ],
)
def test_variables_that_are_elsewhere_in_s7_are_no_loss_of_the_others(declared: str, tmp_path: Path) -> None:
    """Neither a block in SCL declares: external variables are the global ones, those at an address are tags."""
    text = f"""VAR_GLOBAL Total : INT; END_VAR
    PROGRAM Main {declared} VAR CONSTANT c : INT := 3; END_VAR
    IF Start THEN n := n + c; END_IF; END_PROGRAM"""
    source = sfc.loads(text.encode(), format="iec-text")
    report = sfc.save(source, tmp_path / "main.scl", partial=True)
    lost = {(item.what, item.path) for item in report.with_outcome(Outcome.NOT_EXECUTED)}
    assert lost == ({("global variable", "a")} if "%QX" in declared else set())
    back = sfc.load(tmp_path / "main.scl")
    kinds = [[(s.kind, [v.name for v in s.variables]) for s in p.pous[0].interface.sections] for p in (source, back)]  # type: ignore[union-attr]
    assert kinds[0] == kinds[1]


_BITS = {"X": 1, "B": 8, "W": 16, "D": 32}


def places(project: m.Project) -> dict[str, tuple[str, int, int]]:
    """Area, first bit and width of everything at an address, by name; those in the text by their number."""
    by_bytes = project.address_dialect in (m.Dialect.SCL, m.Dialect.TWINCAT)
    held = [*project.global_sections(), *(section for pou in project.pous for section in pou.interface.sections)]
    found = [(v.name, v.address) for section in held for v in section.variables if v.address]
    found += [(tag.name, tag.address) for table in project.tag_tables for tag in table.tags]
    texts = [pou.body.text for pou in project.pous if isinstance(pou.body, m.StBody)]
    found += [(str(at), text) for at, text in enumerate(re.findall(r"%[IQM][WX]?[\d.]+", " ".join(texts)))]
    assert len(dict(found)) == len(found), "something is there twice"
    return {name: _place(address, by_bytes) for name, address in found}


def _place(address: str, by_bytes: bool) -> tuple[str, int, int]:
    parts = re.fullmatch(r"%(.)([XBWD]?)(\d+)\.?(\d?)", address)
    assert parts is not None
    width = _BITS[parts[2] or "X"]
    unit = 8 if by_bytes or width == 1 else width
    return parts[1], int(parts[3]) * unit + int(parts[4] or 0), width


@pytest.mark.parametrize("source", ["codesys", "plcopen", "twincat", "simaticml"])
@pytest.mark.parametrize("target", ["codesys", "twincat", "simaticml", "json"])
def test_words_are_at_the_same_bytes_in_every_tool(source: str, target: str) -> None:
    types = {"X3.5": "BOOL", "B5": "BYTE", "W6": "INT", "D3": "DWORD"}
    declared = " ".join(f"{area}{at[0]} AT %{area}{at} : {kind};" for area in "IQM" for at, kind in types.items())
    text = f"PROGRAM Main VAR {declared} n : INT; END_VAR n := %MW7; %QW9 := %IW2; END_PROGRAM"
    written = sfc.loads(text.encode(), format="iec-text")
    expected = places(written)
    assert expected["QW"] == ("Q", 96, 16)
    first, _ = sfc.convert(written, source, partial=True)
    data, report = sfc.convert(sfc.loads(first, format=source), target, partial=True)
    # bytes in words are told where one tool has the high one first
    assert not [item for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "address"]
    for as_tool in (False, True):
        assert places(sfc.loads(data, format=target, as_tool=as_tool)) == expected


def test_words_of_twincat_at_odd_bytes_have_no_place_in_codesys() -> None:
    text = "PROGRAM Main VAR a AT %MW4 : INT; n : INT; END_VAR n := %MW4; END_PROGRAM"
    data, _ = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "twincat")
    assert data.count(b"%MW8") == 2
    odd = sfc.loads(data.replace(b"%MW8", b"%MW3"), format="twincat")
    _, report = sfc.convert(odd, "codesys", partial=True)
    assert told(report, Outcome.NOT_EXECUTED) == [("address", "POU Main / a"), ("address", "POU Main")]
    again, report = sfc.convert(odd, "simaticml")
    assert places(sfc.loads(again, as_tool=True))["a"] == ("M", 24, 16)
