"""Networks in exports of CoDeSys 2.3 become structured text, and stay as they are in their file."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.languages.binding.name_uses import find_uses
from plcopen_sfc.languages.networks.exported_networks import network_statements
from plcopen_sfc.model.body import OpaqueBody, StBody

HEAD = "_NETWORK\n\n_COMMENT\n'Motor'\n_END_COMMENT\n"
CONTACT = "_LD_CONTACT\n{}\n_EXPRESSION\n{}\n"
START, MOTOR = (CONTACT.format(name, "_POSITIV") for name in ("Start", "Motor"))
STOP = CONTACT.format("Stop", "_NEGATIV")
LATCH = (
    f"{HEAD}_LD_ASSIGN\n_LD_AND\n_LD_OPERATOR : 2\n_LD_OR\n_LD_OPERATOR : 2\n{START}{MOTOR}"
    f"_EXPRESSION\n_POSITIV\n{STOP}_EXPRESSION\n_POSITIV\n_EXPRESSION\n_POSITIV\n\n\nENABLELIST : 0\nENABLELIST_END\n"
    "_OUTPUTS : 1\n_OUTPUT\n_POSITIV\n_NO_SET\nMotor\n"
)
ALARM = (
    f"{HEAD}_LD_ASSIGN\n{CONTACT.format('Fault', '_POSITIV')}_EXPRESSION\n_POSITIV\nENABLELIST : 0\nENABLELIST_END\n"
    "_OUTPUTS : 2\n_OUTPUT\n_POSITIV\n_SET\nAlarm\n_OUTPUT\n_NEGATIV\n_SET\nReady\n"
)
LD = f"_LD_BODY\n_NETWORKS : 2\n{LATCH}{ALARM}"
FBD = (
    f"_FBD_BODY\n_NETWORKS : 1\n{HEAD}_ASSIGN\n_FUNCTIONBLOCK\nDelay\n_BOX_EXPR : 2\n"
    "_OPERAND\n_EXPRESSION\n_NEGATIV\nStart\n_OPERAND\n_EXPRESSION\n_POSITIV\nt#2s\n_EXPRESSION\n_POSITIV\nTON\n"
    "_OUTPUTS : 1\n_OUTPUT\n_POSITIV\n_NO_SET\nElapsed\n_EXPRESSION\n_POSITIV\n"
    "_OUTPUTS : 1\n_OUTPUT\n_NEGATIV\n_NO_SET\nMotor\n"
)


def test_contacts_and_coils() -> None:
    assert network_statements(LD) == (
        "Motor := (Start OR Motor) AND NOT Stop;\n"
        "IF Fault THEN\n    Alarm := TRUE;\nEND_IF\nIF Fault THEN\n    Ready := FALSE;\nEND_IF"
    ).replace("END_IF", "END_IF;")


def test_function_blocks() -> None:
    assert network_statements(FBD) == "Delay(IN := NOT Start, PT := t#2s);\nElapsed := Delay.ET;\nMotor := NOT Delay.Q;"
    assert network_statements(FBD.replace("t#2s", "???")) == (
        "Delay(IN := NOT Start);\nElapsed := Delay.ET;\nMotor := NOT Delay.Q;"
    )


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("_LD_OR", "_LD_XOR"),
        ("_NETWORKS : 2", "_NETWORKS : 1"),
        ("ENABLELIST : 0", "ENABLELIST : 1"),
        ("_LD_OPERATOR : 2", "_LD_OPERATOR : 3"),
        ("_SET\nAlarm", "_SET\nFault"),  # the second coil gets the value from before
        ("Stop\n", "???\n"),
    ],
)
def test_what_is_not_understood_is_no_text(old: str, new: str) -> None:
    assert old in LD
    assert network_statements(LD.replace(old, new)) is None
    assert network_statements(LD[: len(LD) // 2]) is None


EXPORT = (
    "(* @NESTEDCOMMENTS := 'Yes' *)\n(* @PATH := '' *)\nPROGRAM Main\nVAR\n\tStart, Stop, Fault: BOOL;\n"
    f"\tMotor, Alarm, Ready: BOOL;\nEND_VAR\n(* @END_DECLARATION := '0' *)\n{LD}END_PROGRAM\n"
)


def test_a_program_in_ladder_runs_and_is_written_for_other_tools() -> None:
    data = EXPORT.replace("\n", "\r\n").encode()
    project = sfc.loads(data)
    assert isinstance(project.pous[0].body, OpaqueBody)
    assert sfc.dumps(project) == data
    inputs = {"Start": [True, False, False], "Stop": [False, False, True], "Fault": [False, True, False]}
    trace = sfc.simulate(project, pou="Main", inputs=lambda scan, _: {k: v[scan] for k, v in inputs.items()}, scans=3)
    assert [trace["Motor"][scan] for scan in range(3)] == [True, True, False]
    assert [trace["Alarm"][scan] for scan in range(3)] == [False, True, True]
    converted, report = sfc.convert(project, "codesys")
    body = sfc.loads(converted).pous[0].body
    assert isinstance(body, StBody)
    assert body.text.startswith("Motor := (Start OR Motor) AND NOT Stop;")
    assert [item.why for item in report.items if item.what == "body"] == [
        "from networks of CoDeSys 2.3 into structured text"
    ]


@pytest.mark.parametrize(("body", "count"), [(LD, 1), (FBD, 1)])
def test_a_rename_reaches_into_networks_of_an_export(body: str, count: int) -> None:
    declared = EXPORT.replace(LD, body).replace("Ready: BOOL", "Ready: BOOL; Delay: TON; Elapsed: TIME")
    declared = declared.replace("Start, Stop", "Start: BOOL;\n\tStop")
    project = sfc.loads(declared.encode())
    assert [use.language for use in find_uses(project, "Main.Start")] == ["opaque"] * count
    result = project.rename("Main.Start", "Los")
    assert not result.undecided
    before, after = declared.split("\n"), sfc.dumps(project).decode().split("\n")
    changed = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
    assert changed == [("\tStart: BOOL;", "\tLos: BOOL;"), *[("Start", "Los")] * count]


def test_networks_that_are_not_understood_are_told_in_a_rename() -> None:
    project = sfc.loads(EXPORT.replace("_LD_OR", "_LD_XOR").encode())
    assert [each.use.path for each in project.rename("Main.Start", "Los").undecided] == ["Main"]
