"""The rows of GRAPH actions: what they mean, their tokens, and what no rule fits."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.formats.simaticml.element_reader import VERBATIM
from plcopen_sfc.formats.simaticml.row_tokens import GRAPH_QUALIFIERS, read_action, write_row
from plcopen_sfc.model import ActionAssociation, ActionEvent, Qualifier, StBody
from tests.formats.simaticml.documents import FIXTURES, parsed, real_documents


def row(*tokens: str, **attributes: str) -> etree._Element:
    element = etree.Element("Action", attributes)
    for token in (*tokens, "\n"):
        etree.SubElement(element, "Token", {"Text": token})
    return element


ROWS = (
    (row('"Tag"', Qualifier="N"), {"qualifier": Qualifier.N, "target": '"Tag"'}),
    (row("#a.b[1]", Qualifier="S", Event="S1"), {"event": ActionEvent.S1, "target": "#a.b[1]"}),
    (row("#x", Qualifier="N", Interlock="true"), {"interlock": True, "target": "#x"}),
    (row("#x", ",", "T#5S", Qualifier="D"), {"target": "#x", "duration": "T#5S"}),
    (row("#x[1,2]", ",", "T#5S", Qualifier="D"), {"target": "#x[1,2]", "duration": "T#5S"}),
    (row("#x", ",", '"DB".time', Qualifier="L"), {"target": "#x", "duration": '"DB".time'}),
    (row("#x", ":=", "1", Qualifier="N"), {"target": "#x", "value": "1"}),
    (row('"C1"', ",", "C#10", Qualifier="CS", Event="S1"), {"target": '"C1"', "value": "C#10"}),
    (row("Step5", Qualifier="OFF", Event="S1"), {"qualifier": Qualifier.OFF, "target": "Step5"}),
    (row("#x", " ", ":=", " ", "1", Qualifier="N"), {"target": "#x", "value": "1"}),
    (row("#x", ":=", "  ", "#y", " ", "+", " ", "1", Qualifier="N"), {"target": "#x", "value": "#y + 1"}),
    (row('"T1"', ",", "S5T#5s", Qualifier="TL", Event="S1"), {"qualifier": Qualifier.TL, "duration": "S5T#5s"}),
    (row('"T1"', Qualifier="TR", Event="V1", Interlock="true"), {"event": ActionEvent.V1, "interlock": True}),
    (row('"C1"', Qualifier="CU", Event="L1"), {"qualifier": Qualifier.CU, "event": ActionEvent.L1}),
    (row("S_ALL", Qualifier="OFF", Event="A1"), {"qualifier": Qualifier.OFF, "target": "S_ALL"}),
)


@pytest.mark.parametrize(("element", "expected"), ROWS)
def test_rows_of_actions(element: etree._Element, expected: dict[str, object]) -> None:
    fields = read_action(element)
    action = ActionAssociation.model_validate({"id": 1, **fields})
    assert {name: getattr(action, name) for name in expected} == expected
    assert action.extension_data is None or not action.extension_data.data
    again = etree.Element("Action")
    write_row(again, action)
    assert etree.tostring(again, method="c14n") == etree.tostring(element, method="c14n")


def test_a_call_is_a_statement() -> None:
    tokens = ["CALL", " ", '"FC_1"', " ", "\n", "    ", "(", "a", " ", ":=", " ", "1", "\n"]
    tokens += ["     ", "b", " ", ":=", " ", "#c", "\n", "    ", ")"]
    action = ActionAssociation.model_validate({"id": 1, **read_action(row(*tokens, Qualifier="N"))})
    assert action.qualifier is Qualifier.CALL
    assert action.body == StBody(text='"FC_1"(a := 1, b := #c);')
    assert action.extension_data is None


def test_a_row_that_no_rule_fits_is_kept() -> None:
    element = row("IF", " ", "#a", Qualifier="N")
    assert read_action(element)["body"] == {"language": "ST", "text": "IF #a"}
    unknown = etree.fromstring('<Action Qualifier="N"><Access Scope="Unnamed" /></Action>')
    assert read_action(unknown)["body"]["content"] == (
        '<Action xmlns="" Qualifier="N"><Access Scope="Unnamed"></Access></Action>'
    )


def test_a_call_of_a_function_block_names_its_instance() -> None:
    element = row(
        "CALL", " ", '"FB_1"', ",", '"DB_1"', " ", "\n", "    ", "(", "a", " ", ":=", " ", "1", "\n", "    ", ")"
    )
    element.set("Qualifier", "N")
    action = ActionAssociation.model_validate({"id": 1, **read_action(element)})
    assert action.qualifier is Qualifier.CALL
    assert action.body == StBody(text='"DB_1"(a := 1);')
    again = etree.Element("Action")
    write_row(again, action)
    assert etree.tostring(again, method="c14n") == etree.tostring(element, method="c14n")
    fresh = ActionAssociation(id=1, qualifier=Qualifier.CALL, body=StBody(text='"DB_1"(a := 1);'))
    write_row(again := etree.Element("Action"), fresh, {"db_1": '"FB_1"'})
    assert etree.tostring(again, method="c14n") == etree.tostring(element, method="c14n")


def test_renaming_the_operand_of_a_row_keeps_its_blanks() -> None:
    element = row("#x", " ", ":=", "   ", "1", Qualifier="N")
    action = ActionAssociation.model_validate({"id": 1, **read_action(element)})
    action.target = "#other"
    write_row(again := etree.Element("Action"), action)
    assert [token.get("Text") for token in again] == ["#other", " ", ":=", "   ", "1", "\n"]


OPERANDS = st.sampled_from(('"Tag"', "#x", '"DB".a[1].b', "#a.%X3", '#"with blank".c', "%M0.1"))
TIMES = st.sampled_from(("T#5s", '"DB".time', "#t"))
EVENTS = st.none() | st.sampled_from([event for event in ActionEvent if event is not ActionEvent.C])
PLAIN = sorted(GRAPH_QUALIFIERS - {Qualifier.CALL})


@st.composite
def rows(draw: st.DrawFn) -> ActionAssociation:
    """An association that S7-GRAPH can say."""
    qualifier = draw(st.sampled_from(PLAIN))
    fields: dict[str, object] = {"id": 1, "qualifier": qualifier, "target": draw(OPERANDS)}
    fields["event"], fields["interlock"] = draw(EVENTS), draw(st.booleans())
    timed = qualifier in (Qualifier.L, Qualifier.D, Qualifier.TL, Qualifier.TD, Qualifier.TR, Qualifier.TF)
    if timed and draw(st.booleans()):
        fields["duration"] = draw(TIMES)
    elif qualifier is Qualifier.CS or (not timed and draw(st.booleans())):
        fields["value"] = draw(st.sampled_from(("C#10", "1", "#y", '"DB".n')))
    return ActionAssociation.model_validate(fields)


@settings(deadline=None)
@given(action=rows())
def test_any_row_comes_back(action: ActionAssociation) -> None:
    element = etree.Element("Action")
    write_row(element, action)
    assert ActionAssociation.model_validate({"id": 1, **read_action(element)}) == action


@pytest.mark.corpus
def test_rows_of_the_corpus_are_in_the_model() -> None:
    outcomes: Counter[str] = Counter()
    for path in [*real_documents(), *sorted(FIXTURES.glob("*.xml"))]:
        for element in parsed(path.read_bytes()).iter("{*}Action"):
            if len(element) or element.attrib:
                fields = read_action(element)
                kept = any(data["name"] == VERBATIM for data in fields.get("extension_data", {}).get("data", []))
                body = fields.get("body", {"language": "ST"})
                outcomes["kept beside" if kept else "not read" if body["language"] == "opaque" else "in the model"] += 1
    if not real_documents():
        pytest.skip("no corpus beside the repository")
    assert outcomes.keys() == {"in the model"}


def test_a_row_that_is_not_understood_is_written_as_it_was() -> None:
    data = (FIXTURES / "FB_Drill.xml").read_bytes()
    unknown = b'<Action Qualifier="ZZ" Other="1"><Token Text="#x" /><Comment /></Action><Action />'
    changed = data.replace(b"<Action />", unknown, 1)
    assert changed != data
    fresh = sfc.dumps(sfc.loads(changed), fresh=True)
    assert b'<Action Other="1" Qualifier="ZZ">' in fresh
    assert b"<Comment />" in fresh


@pytest.mark.parametrize(("step", "target"), [("Drill", "#Spindle"), ("Dwell", "#Lamp"), ("Clamp part", "#Clamp")])
def test_a_time_with_which_a_row_does_nothing_stays_out_of_it(step: str, target: str) -> None:
    """It was written as `#Spindle , T#7s`, which is no row of TIA Portal, and saving was refused."""
    project = sfc.load(FIXTURES / "FB_Drill.xml")
    chart = project.pous[0].chart
    assert chart is not None
    place, action = next((at, each) for at, each in enumerate(chart.step(step).actions) if each.target == target)
    action.duration = "T#7s"
    done = sfc.convert(project, "simaticml")
    assert [item.what for item in done.report.with_outcome(sfc.Outcome.EXTENSION_DATA)] == ["duration"]
    again = sfc.loads(done.data).pous[0].chart
    assert again is not None
    found = again.step(step).actions[place]
    assert (found.qualifier, found.target, found.event, found.duration) == (*_row_of(action), "T#7s")
    assert b'Text=","' not in done.data.partition(f'Text="{target}"'.encode())[2][:40]


def _row_of(action: ActionAssociation) -> tuple[object, ...]:
    return action.qualifier, action.target, action.event
