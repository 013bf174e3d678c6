"""Networks of TwinCAT: executed, converted and renamed as far as a real file shows them, else kept as they are."""

from __future__ import annotations

import io

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import OpaqueBody, StBody

FLAGS = '<o n="Flags" t="Flags"><v n="Flags">0</v></o>'


def operand(text: str) -> str:
    return f'<v n="Operand">"{text}"</v>{FLAGS}'


def leaf(text: str) -> str:
    return f'<o t="BoxTreeOperand"><o n="Operand" t="Operand">{operand(text)}</o></o>'


def box(kind: str, *inputs: str, named: str = "") -> str:
    return (
        f'<o {named}t="BoxTreeBox"><v n="BoxType">"{kind}"</v><o n="Instance" t="Operand"><n n="Operand" /></o>'
        f'<o n="OutputItems" t="OutputItemList"><l2 n="OutputItems"><n /></l2></o>{FLAGS}<n n="InputFlags" />'
        f'<l2 n="InputItems">{"".join(inputs)}</l2><v n="EN">false</v><v n="ENO">false</v><n n="STSnippet" /></o>'
    )


def network(target: str, value: str, *, out_commented: str = "false") -> str:
    return (
        '<o><v n="ILActive">false</v><v n="Label">""</v>'
        f'<v n="OutCommented">{out_commented}</v><l2 n="NetworkItems" cet="BoxTreeAssign"><o>'
        f'<o n="OutputItems" t="OutputItemList"><l2 n="OutputItems" cet="Operand"><o>{operand(target)}</o></l2></o>'
        f'{FLAGS}{value}</o></l2><l2 n="Connectors" /></o>'
    )


def pou(*networks: str) -> bytes:
    declared = "PROGRAM Main\r\nVAR a, b, c, q, r : BOOL; n : INT; END_VAR"
    return (
        '<?xml version="1.0" encoding="utf-8"?>\r\n<TcPlcObject Version="1.1.0.1" ProductVersion="3.1.4024.12">\r\n'
        '<POU Name="Main" Id="{11111111-1111-1111-1111-111111111111}" SpecialFunc="None">'
        f"<Declaration><![CDATA[{declared}]]></Declaration>"
        '<Implementation><NWL><XmlArchive><Data><o xml:space="preserve" t="NWLImplementationObject">'
        f'<l2 n="NetworkList" cet="Network">{"".join(networks)}</l2></o></Data><TypeList>'
        '<Type n="BoxTreeBox">{acfc6f68-8e3a-4af5-bf81-3dd512095a46}</Type></TypeList></XmlArchive></NWL>'
        "</Implementation>\r\n</POU>\r\n</TcPlcObject>\r\n"
    ).encode()


OR = box("OR", leaf("a"), leaf("n = 3"), named='n="RValue" ')
AND = box("AND", leaf("a"), box("OR", leaf("b"), leaf("c")), box("NOT", leaf("q")), named='n="RValue" ')
FILE = pou(network("q", OR), network("c", OR, out_commented="true"), network("r", AND))


def test_networks_of_operators_are_executed_converted_and_renamed() -> None:
    project = sfc.loads(FILE)
    assert project.diagnostics == ()
    assert sfc.dumps(project) == FILE
    signals = [{"a": True}, {"a": False, "n": 3}]
    trace = sfc.simulate(project, scans=2, inputs=lambda scan, _: signals[scan], record=["q", "c"])
    assert [trace["q"][scan] for scan in range(2)] == [True, True]
    assert trace["c"][1] is False
    body = sfc.loads(sfc.convert(project, "codesys").data).pous[0].body
    assert isinstance(body, StBody)
    assert body.text.split("\n") == ["q := a OR n = 3;", "r := a AND (b OR c) AND NOT q;"]
    project.rename("Main.a", "Start")
    assert sfc.dumps(project) == FILE.replace(b"VAR a,", b"VAR Start,").replace(b'"a"', b'"Start"')


def test_a_drawn_condition_that_became_text_is_no_difference() -> None:
    """`diff` showed the archive and the expression, as if the condition were another one."""
    start, end = FILE.index(b"<Implementation>"), FILE.index(b"</Implementation>") + len(b"</Implementation>")
    archive = pou(network("Go", OR))
    drawn = archive[archive.index(b"<Implementation>") : archive.index(b"</Implementation>")] + b"</Implementation>"
    whole = b"<Implementation><ST><![CDATA[]]></ST></Implementation>"
    guid = b'"{22222222-2222-2222-2222-222222222222}"'
    data = FILE[:start] + whole + b'<Transition Name="Go" Id=' + guid + b">" + drawn + b"</Transition>" + FILE[end:]
    project = sfc.loads(data)
    assert project.diagnostics == ()
    assert isinstance(project.pous[0].transitions[0].body, OpaqueBody)
    back = sfc.loads(sfc.dumps(sfc.loads(sfc.dumps(project, format="codesys")), format="twincat"))
    assert str(sfc.diff(project, back)) == "no differences"
    other = sfc.loads(data.replace(b"n = 3", b"n = 4"))
    assert "-a OR n = 3" in str(sfc.diff(project, other))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"Flags">0', '"Flags">1'),
        ('"OR"', '"TON"'),
        ('<n n="Operand" />', '<v n="Operand">"T1"</v>'),
        ('"ILActive">false', '"ILActive">true'),
        ('"BoxTreeAssign"', '"BoxTreeJump"'),
        ('"Label">""', '"Label">"Ende"'),
    ],
)
def test_other_networks_are_kept_as_they_are_and_told(old: str, new: str) -> None:
    data = FILE.replace(old.encode(), new.encode())
    assert data != FILE
    project = sfc.loads(data)
    assert [each.code for each in project.diagnostics] == ["TWC104"]
    assert isinstance(project.pous[0].body, OpaqueBody)
    assert sfc.dumps(project) == data
    report = sfc.save(project, io.BytesIO(), format="codesys", partial=True)
    assert report.with_outcome("not executed")
