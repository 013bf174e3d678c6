"""When programs run, with which variables, and what VAR_CONFIG gives them: kept in each target, or named as lost."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import Outcome
from tests.samples import FIXTURES

TARGETS = (
    "codesys",
    "plcopen-1.01",
    "plcopen-2.01",
    "plcopen-2.01 beremiz",
    "iec-text",
    "iec-text matiec",
    "simaticml",
    "scl",
)
PROGRAM = "PROGRAM Counter VAR_OUTPUT n : INT; END_VAR n := n + 1; END_PROGRAM\n"
EXPORT = (FIXTURES / "codesys" / "distribution_belt.xml").read_bytes()
CYCLIC = b'KindOfTask="Cyclic" Interval="t#20ms" IntervalUnit="ms" WithinSPSTimeSlicing="true"'
IN_CODESYS = b"{plcopen_sfc format := 1}\n{plcopen_sfc project.dialect := 'codesys'}\n"


def configured(inside: str, after: str = "") -> bytes:
    """A program in a configuration with one resource."""
    text = (
        f"{PROGRAM}CONFIGURATION Plant\nVAR_GLOBAL start : BOOL; END_VAR\nRESOURCE R ON PLC\n{inside}\nEND_RESOURCE\n"
    )
    return f"{text}{after}END_CONFIGURATION\n".encode()


def exported(settings: str) -> bytes:
    """An export of CODESYS whose main task has these settings; what TC6 says of it is of no use."""
    assert CYCLIC in EXPORT
    return EXPORT.replace(CYCLIC, settings.encode()).replace(
        b'name="MainTask" interval="PT0.02S"', b'name="MainTask" interval="PT0S"'
    )


def tasks_of(project: m.Project) -> Iterator[m.Task]:
    for resource in (*project.applications, *(r for c in project.configurations for r in c.resources)):
        yield from resource.tasks


def calls(project: m.Project) -> dict[str, list[str]]:
    """The programs that each task calls, as the tool of the file finds them."""
    is_codesys = project.source is not None and project.source.format == "codesys"
    return {
        task.name.removesuffix("_1"): [i.name if is_codesys else i.type_name or i.name for i in task.instances]
        for task in tasks_of(project)
    }


def cycle(project: m.Project, name: str) -> object:
    """The cycle of a task: where CODESYS has one, in its settings."""
    task = next((task for task in tasks_of(project) if task.name.removesuffix("_1") == name), None)
    if task is None:
        return None
    if project.source is not None and project.source.format == "codesys":
        settings = task.settings
        return None if settings is None or settings.kind != "Cyclic" else (settings.interval, settings.interval_unit)
    return task.interval


def edge(project: m.Project, name: str) -> str | None:
    task = next((task for task in tasks_of(project) if task.name.removesuffix("_1") == name), None)
    if task is None:
        return None
    if project.source is not None and project.source.format == "codesys":
        settings = task.settings
        return settings.event if settings is not None and settings.kind == "Event" else None
    return (task.single or "").rpartition(".")[2] or None


def called_blocks(project: m.Project) -> dict[str, list[str]]:
    """The data blocks that each organization block of S7 calls."""
    found: dict[str, list[str]] = {}
    for pou in (pou for pou in project.pous if pou.kind is m.PouKind.ORGANIZATION_BLOCK):
        if isinstance(pou.body, m.StBody):
            calls = [call.partition("(")[0] for call in pou.body.text.split(";")]
        else:
            assert isinstance(pou.body, m.FbdBody)
            nodes = [node for network in pou.body.networks for node in network.nodes]
            calls = [node.instance or "" for node in nodes if isinstance(node, m.Block)]
        found[pou.name] = [call.strip().strip('"') for call in calls if call.strip()]
    return found


@dataclass(frozen=True)
class ConfigurationCase:
    """A source, whether the target does the same, and words of which one is in the report where it does not."""

    source: bytes
    holds: Callable[[m.Project], bool]
    words: tuple[str, ...]
    format: str = "iec-text"


NO_BLOCK = "no organization block"
SET_CYCLE = "set the cycle time"
CASES = {
    "cycles": ConfigurationCase(
        configured("TASK Fast(INTERVAL := T#10ms, PRIORITY := 1); PROGRAM Left1 WITH Fast : Counter;"),
        lambda p: (
            cycle(p, "Fast") in ("T#10ms", "PT0.01S", "00:00:00.01", ("t#10ms", "ms"))
            and calls(p)["Fast"] == ["Counter"]
        ),
        (SET_CYCLE,),
    ),
    "cycles of microseconds": ConfigurationCase(
        configured("TASK Fast(INTERVAL := T#1500us, PRIORITY := 1); PROGRAM Left1 WITH Fast : Counter;"),
        lambda p: cycle(p, "Fast") in ("T#1500us", "T#1ms500us", "00:00:00.0015", ("1500", "us")),
        (SET_CYCLE,),
    ),
    "edges": ConfigurationCase(
        configured("TASK T1(SINGLE := start, PRIORITY := 1); PROGRAM Left1 WITH T1 : Counter;"),
        lambda p: edge(p, "T1") == "start",
        (NO_BLOCK,),
    ),
    "priorities": ConfigurationCase(
        configured("TASK Fast(INTERVAL := T#10ms, PRIORITY := 7); PROGRAM Left1 WITH Fast : Counter;"),
        lambda p: [task.priority for task in tasks_of(p)] == [7] or len(called_blocks(p)) == 1,
        (NO_BLOCK,),
    ),
    "instances of one program": ConfigurationCase(
        configured(
            "TASK Fast(INTERVAL := T#10ms, PRIORITY := 1); TASK Slow(INTERVAL := T#1s, PRIORITY := 5);"
            "PROGRAM Left1 WITH Fast : Counter; PROGRAM Right1 WITH Slow : Counter;"
        ),
        lambda p: (
            {i.name for task in tasks_of(p) for i in task.instances} == {"Left1", "Right1"}
            or called_blocks(p) == {"Fast": ["Counter_DB"], "Slow": ["Counter_DB_1"]}
        ),
        (NO_BLOCK, "no variables of its own"),
    ),
    "programs without a task": ConfigurationCase(
        configured("PROGRAM Idle1 : Counter;"),
        lambda p: (
            [i.name for c in p.configurations for r in c.resources for i in r.instances if p.source.format != "codesys"]
            == ["Idle1"]
            or called_blocks(p) == {"Programs": ["Counter_DB"]}
        ),
        (NO_BLOCK, "`Idle1` is NOT executed"),
    ),
    "VAR_CONFIG": ConfigurationCase(
        configured(
            "TASK Fast(INTERVAL := T#10ms, PRIORITY := 1); PROGRAM Left1 WITH Fast : Counter;",
            "VAR_CONFIG R.Left1.n : INT := 77; END_VAR\n",
        ),
        lambda p: p.source.format != "codesys" and any(c.config_variables is not None for c in p.configurations),
        ("`R.Left1.n` is NOT executed", "gives variables no values", "S7 has no such section"),
    ),
    "VAR_CONFIG outside": ConfigurationCase(
        IN_CODESYS + b"PROGRAM Main VAR v AT %I* : INT; END_VAR END_PROGRAM VAR_CONFIG Main.v AT %IW0 : INT; END_VAR\n",
        lambda p: p.config_variables is not None,
        ("`Main.v` is NOT executed", "gives variables no values"),
    ),
    "calls of programs": ConfigurationCase(
        IN_CODESYS
        + b"PROGRAM Main VAR n : INT; END_VAR Pump(x := 3); n := Pump.y; END_PROGRAM\n"
        + b"PROGRAM Pump VAR_INPUT x : INT; END_VAR VAR y : INT; END_VAR y := y + x; END_PROGRAM\n",
        lambda p: (
            p.dialect is m.Dialect.CODESYS
            or "Pump_DB" in {block.name for block in p.data_blocks}
            or "Pump_block" in {pou.name for pou in p.pous}
        ),
        ("`Pump` is a program",),
    ),
    "cycles in settings": ConfigurationCase(
        exported('KindOfTask="Cyclic" Interval="30000" IntervalUnit="us"'),
        lambda p: cycle(p, "MainTask") in ("T#30ms", "00:00:00.03", ("30000", "us")),
        (SET_CYCLE,),
        "codesys",
    ),
    "a variable as cycle": ConfigurationCase(
        exported('KindOfTask="Cyclic" Interval="GVL_EA.tCycle" IntervalUnit="ms"'),
        lambda p: cycle(p, "MainTask") in ("tCycle", "GVL_EA.tCycle", ("GVL_EA.tCycle", "ms")),
        (NO_BLOCK, "MainTask does not run every GVL_EA.tCycle", "the variable tCycle", "the variable GVL_EA.tCycle"),
        "codesys",
    ),
    "edges in settings": ConfigurationCase(
        exported('KindOfTask="Event" Event="GVL_EA.S1_Start"'),
        lambda p: edge(p, "MainTask") in ("S1_Start", "GVL_EA.S1_Start"),
        (NO_BLOCK,),
        "codesys",
    ),
    "levels in settings": ConfigurationCase(
        exported('KindOfTask="Status" Event="GVL_EA.S1_Start"'),
        lambda p: p.source.format == "codesys",
        (NO_BLOCK, "of the kind Status"),
        "codesys",
    ),
    "freewheeling": ConfigurationCase(
        exported('KindOfTask="Freewheeling"'),
        lambda p: p.source.format == "codesys" or called_blocks(p).get("MainTask") == ["PLC_PRG_DB"],
        (NO_BLOCK, "of the kind Freewheeling"),
        "codesys",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", CASES)
def test_a_target_does_the_same_or_the_report_says_so(name: str, target: str) -> None:
    case = CASES[name]
    format_, _, flavour = target.partition(" ")
    project = sfc.loads(case.source, format=case.format)
    if format_ == case.format and not flavour:
        project.name = "Edited"
    data, report = sfc.convert(project, format_, flavour=flavour, partial=True)
    seen = sfc.loads(data, as_tool=True)
    told = [item for item in report.losses if any(word in item.why for word in case.words)]
    assert case.holds(seen) is not bool(told), [(item.path, item.why) for item in report.losses]


@pytest.mark.slow
@pytest.mark.parametrize("target", ["codesys", "plcopen-1.01", "plcopen-2.01", "iec-text"])
@pytest.mark.parametrize("name", CASES)
def test_the_source_comes_back(name: str, target: str) -> None:
    case = CASES[name]
    project = sfc.loads(case.source, format=case.format)
    back = sfc.loads(sfc.convert(project, target, partial=True)[0])
    for mine, theirs in zip(tasks_of(project), tasks_of(back), strict=True):
        assert theirs == mine
    assert back.config_variables == project.config_variables
    assert [c.config_variables for c in back.configurations] == [c.config_variables for c in project.configurations]


@pytest.mark.parametrize(
    ("target", "old", "new"),
    [
        ("plcopen-2.01", b'"T#30ms"', b'"T#40ms"'),
        ("plcopen-1.01", b'interval="00:00:00.03"', b'interval="00:00:00.04"'),
        ("iec-text", b"INTERVAL := T#30ms", b"INTERVAL := T#40ms"),
    ],
)
def test_an_edited_cycle_wins_over_the_settings_kept_beside_it(target: str, old: bytes, new: bytes) -> None:
    data, _ = sfc.convert(sfc.loads(CASES["cycles in settings"].source), target, partial=True)
    assert data.count(old) == 1
    back, _ = sfc.convert(sfc.loads(data.replace(old, new)), "codesys", partial=True)
    assert cycle(sfc.loads(back, as_tool=True), "MainTask") == ("t#40ms", "ms")


def test_an_edited_cycle_wins_in_a_file_of_codesys_too() -> None:
    data, _ = sfc.convert(sfc.loads(CASES["cycles"].source), "codesys", partial=True)
    edited = sfc.loads(data.replace(b"t#10ms", b"t#50ms"))
    text, _ = sfc.convert(edited, "iec-text", partial=True)
    assert b"INTERVAL := t#50ms" in text


@pytest.mark.parametrize("source", [PROGRAM, "TYPE T : STRUCT a : INT; END_STRUCT END_TYPE\n"])
def test_what_is_written_for_codesys_is_recognised_as_its_file(source: str) -> None:
    data, _ = sfc.convert(sfc.loads(IN_CODESYS + source.encode()), "codesys")
    for as_tool in (False, True):
        back = sfc.loads(data, as_tool=as_tool)
        assert (back.source.format, back.dialect) == ("codesys", m.Dialect.CODESYS)


@pytest.mark.parametrize("target", ["plcopen-1.01", "plcopen-2.0", "plcopen-2.01"])
def test_an_instance_names_its_program_in_tc6(target: str) -> None:
    data, _ = sfc.convert(sfc.loads(EXPORT), target, partial=True)
    seen = sfc.loads(data, as_tool=True)
    assert {i.type_name for task in tasks_of(seen) for i in task.instances} == {"PLC_PRG", "Eingabe_Anzahl"}


@pytest.mark.parametrize(("target", "attribute"), [("plcopen-2.01", "typeName"), ("plcopen-1.01", "type")])
def test_an_instance_is_called_after_its_program(target: str, attribute: str) -> None:
    data = sfc.dumps(sfc.loads(EXPORT), format=target, partial=True)
    assert f'<pouInstance name="PLC_PRG_instance" {attribute}="PLC_PRG">'.encode() in data


def test_var_config_outside_of_a_configuration_is_edited_and_renamed() -> None:
    source = IN_CODESYS + (
        b"\nPROGRAM Main\n    VAR\n        v AT %I* : INT;\n    END_VAR\n\n    v := 1;\nEND_PROGRAM\n\n"
        b"(* places *)\nVAR_CONFIG\n    Main.v AT %IW0 : INT; // here\nEND_VAR\n"
    )
    project = sfc.loads(source)
    assert sfc.loads(sfc.dumps(project, fresh=True)) == project
    assert project.config_variables is not None
    project.config_variables.variables[0].address = "%IW2"
    assert sfc.dumps(project) == source.replace(b"%IW0", b"%IW2")
    project.rename("Main.v", "w")
    assert b"Main.w AT %IW2" in sfc.dumps(project)


def test_an_instance_with_the_attribute_of_tc6_1_01_stays_as_it_is() -> None:
    data, _ = sfc.convert(sfc.loads(configured("PROGRAM P1 : Counter;")), "plcopen-2.01", partial=True)
    old = data.replace(b'<pouInstance name="P1" typeName="Counter"', b'<pouInstance name="P1" type="Counter"')
    assert old != data
    assert b'name="P1" typeName="" type="Counter"' in sfc.dumps(sfc.loads(old), fresh=True)


TWO_PROGRAMS = """PROGRAM Line VAR_INPUT go : BOOL; END_VAR VAR n : INT; END_VAR n := n + 1; END_PROGRAM
PROGRAM Other VAR n : INT; END_VAR n := n + 2; END_PROGRAM
CONFIGURATION C RESOURCE R ON PLC TASK T1(INTERVAL := T#20ms, PRIORITY := 1);
PROGRAM I1 WITH T1 : Line{arguments}; PROGRAM I2 WITH T1 : Other; END_RESOURCE END_CONFIGURATION
"""


@pytest.mark.parametrize("target", ["codesys", "iec-text", "plcopen-2.01"])
def test_an_edit_of_the_program_in_place_of_a_task_counts_on_the_way_back(target: str) -> None:
    source = sfc.loads(TWO_PROGRAMS.format(arguments="").encode(), format="iec-text")
    export = sfc.dumps(source, format="codesys23")
    assert called_programs(sfc.dumps(sfc.loads(export), format=target)) == {"Line", "Other"}
    edited = export.replace(b"Line();\r\nOther();", b"Line();\r\nIF Line.n > 3 THEN\r\nOther();\r\nEND_IF;")
    assert edited != export
    assert called_programs(sfc.dumps(sfc.loads(edited), format=target)) == {"PLC_PRG"}


def called_programs(data: bytes) -> set[str]:
    instances = (each for task in tasks_of(sfc.loads(data, as_tool=True)) for each in task.instances)
    return {each.type_name or each.name for each in instances}


def test_a_program_with_arguments_is_not_called_without_them() -> None:
    source = sfc.loads(TWO_PROGRAMS.format(arguments="(go := TRUE)").encode(), format="iec-text")
    _, report = sfc.convert(source, "codesys23", partial=True)
    assert [(item.outcome, item.what) for item in report.losses] == [(Outcome.NOT_EXECUTED, "task")]
