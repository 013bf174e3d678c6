"""Lowered code in the networks of TIA Portal: nothing is in our comments, bits end in coils."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.analysis import equivalent
from plcopen_sfc.languages.networks import declared_rules, draw_ld
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.model import StBody
from tests.corpus import corpus_files, require_corpus

FIXTURES = Path(__file__).parents[2] / "fixtures"
_GRAPH = FIXTURES / "simaticml-training-chain" / "Ablauf.xml"
_PLCOPEN = FIXTURES / "training-chain" / "plcopen_2.01.xml"
_BIT_BOXES = {"A", "O", "X", "PBox", "NBox", "Eq", "Ne", "Lt", "Gt", "Le", "Ge"}


def _networks(source: Path, language: str, flags: str = "local") -> list[etree._Element]:
    lowered = sfc.lower(sfc.load(source), "flipflop", language=language, target="simaticml", flags=flags, verify=False)
    root = etree.fromstring(sfc.dumps(lowered.project, format="simaticml"))
    return list(root.iter("{*}FlgNet"))


def _check(net: etree._Element) -> None:
    text = etree.tostring(net, encoding="unicode")
    assert net.findall("{*}Parts/{*}Part"), text
    assert not list(net.iter(etree.Comment)), text
    parts = {part.get("UId"): part.get("Name") for part in net.iterfind("{*}Parts/{*}Part")}
    has_rail = next(net.iter("{*}Powerrail"), None) is not None
    for wire in net.iterfind("{*}Wires/{*}Wire"):
        first, *rest = wire
        if any(etree.QName(end).localname == "IdentCon" for end in rest):
            assert parts.get(first.get("UId")) not in _BIT_BOXES, text
        if has_rail and etree.QName(first).localname == "IdentCon":
            ends = [(parts.get(end.get("UId")), end.get("Name")) for end in rest]
            assert ("Coil", "in") not in ends, text


@pytest.mark.slow
@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize(
    ("source", "flags"), [(_GRAPH, "local"), (_PLCOPEN, "local"), (_PLCOPEN, "M20.0"), (_PLCOPEN, "DB_Flags")]
)
def test_each_network_is_one_of_tia_portal(source: Path, flags: str, language: str) -> None:
    networks = _networks(source, language, flags)
    assert len(networks) > 10
    for net in networks:
        _check(net)


@pytest.mark.slow
@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_so_are_those_of_real_sequencers(language: str) -> None:
    require_corpus()
    names = ("Import__StepSequence.xml", "GraphJump.xml")
    files = [path for path in corpus_files("simaticml") if path.name in names]
    assert {path.name for path in files} == set(names)
    for path in files:
        for net in _networks(path, language):
            _check(net)


@pytest.mark.slow
@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_move_boxes_are_complete(language: str) -> None:
    found = 0
    for net in _networks(_GRAPH, language):
        for part in net.iterfind("{*}Parts/{*}Part[@Name='Move']"):
            found += 1
            uid = part.get("UId")
            assert part.get("DisabledENO") == "true"
            assert [value.text for value in part] == ["1"]
            wires = [wire for wire in net.iter("{*}Wire") if any(end.get("UId") == uid for end in wire)]
            pins = {end.get("Name"): wire[0] for wire in wires for end in wire if end.get("UId") == uid}
            assert set(pins) == {"en", "in", "out1"}
            assert language == "FBD" or etree.QName(pins["en"]).localname in ("Powerrail", "NameCon")
    assert found


@pytest.mark.slow
def test_comparisons_in_ladders_are_contacts() -> None:
    comparisons = [
        part.get("UId")
        for net in _networks(_GRAPH, "LD")
        for part in net.iterfind("{*}Parts/{*}Part")
        if part.get("Name") in ("Eq", "Ne", "Lt", "Gt")
        and not any(
            end.get("UId") == part.get("UId") and end.get("Name") == "pre" for end in net.iterfind("{*}Wires/{*}Wire/*")
        )
    ]
    assert comparisons == []


def test_a_series_does_what_the_and_box_did() -> None:
    source = """FUNCTION_BLOCK Test
VAR_INPUT a : BOOL; b : BOOL; i : INT; j : INT; END_VAR
VAR_OUTPUT q : BOOL; r : BOOL; s : BOOL; END_VAR
q := a AND i > 1 AND NOT (j = 3) AND b;
r := (i > 1 OR a) AND NOT (j < 2 AND b);
s := i > 1 AND (j = 3 OR b) AND NOT a;
END_FUNCTION_BLOCK
"""
    project = sfc.loads(source.encode(), format="iec-text")
    pou = project.pou("Test")
    assert pou.interface is not None
    assert isinstance(pou.body, StBody)
    statements = parse_statements(pou.body.text, project.dialect).tree
    drawn = draw_ld(statements.statements, declared_rules(pou.interface.variables(), project.dialect), divided=True)
    assert not drawn.problems
    other = project.model_copy(deep=True)
    other.pou("Test").bodies = [drawn.body]
    data = sfc.dumps(other, format="simaticml", partial=True)
    networks = list(etree.fromstring(data).iter("{*}FlgNet"))
    assert [len(net.findall("{*}Parts/{*}Part[@Name='A']")) for net in networks] == [0, 0, 0]
    found = equivalent(project, sfc.loads(data), "iec")
    assert not found.different, str(found)


@pytest.mark.slow
def test_not_of_several_contacts_is_at_each_of_them() -> None:
    """NOT (b OR c) was a box AND with a negated input, which LAD of TIA Portal does not have."""
    text = """PROGRAM Main VAR_INPUT a, b, c, d : BOOL; n : INT; END_VAR VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S1: END_STEP STEP S2: q(N); END_STEP
TRANSITION FROM S1 TO S2 := a AND NOT (b OR c) AND n >= 3; END_TRANSITION
TRANSITION FROM S2 TO S1 := NOT (a AND (b OR NOT (c AND TRUE))) OR d AND n < 7; END_TRANSITION END_PROGRAM"""
    source = sfc.loads(text.encode(), format="iec-text")
    lowered = sfc.lower(source, "flipflop", language="LD", target="simaticml")
    assert lowered.proof is not None
    assert lowered.proof.equal
    root = etree.fromstring(sfc.dumps(lowered.project, format="simaticml"))
    parts = [part.get("Name") for part in root.iter("{*}Part")]
    assert set(parts) == {"Contact", "Coil", "O", "Sr", "Ge", "Lt"}
    assert parts.count("O") == 1
    assert len(list(root.iter("{*}Negated"))) == 4  # b and c in one, a and b in the other network


WORDS = {
    "(w AND 16#0F) = 16#03": ["And Word", "Eq Word"],
    "(w OR v) = v AND a": ["Or Word", "Eq Word"],
    "a AND (b OR (w XOR v) > 3)": ["Xor Word", "Gt Word"],
    "(w AND v AND 16#FF) <> (v OR 1)": ["And Word", "Or Word", "Ne Word"],
    "d > 3 AND i + d < 40": ["Gt DInt", "Add DInt", "Lt DInt"],
}
_WITH_WORDS = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; w, v : WORD; d : DINT; i : INT; END_VAR VAR_OUTPUT q : BOOL; x : WORD; END_VAR
INITIAL_STEP S1: q(N); END_STEP STEP S2: Act(P); END_STEP
ACTION Act: x := {value}; END_ACTION
TRANSITION FROM S1 TO S2 := {condition}; END_TRANSITION
TRANSITION FROM S2 TO S1 := NOT a; END_TRANSITION END_FUNCTION_BLOCK"""


def _written(language: str, condition: str, value: str = "w") -> tuple[list[str], etree._Element]:
    """Boxes with a type, each with that, in the networks of a chart with a condition and an assignment of a word."""
    source = sfc.loads(_WITH_WORDS.format(condition=condition, value=value).encode(), format="iec-text")
    lowered = sfc.lower(source, "flipflop", language=language, target="simaticml")
    assert lowered.proof is not None
    assert lowered.proof.equal
    root = etree.fromstring(sfc.dumps(lowered.project, format="simaticml"))
    parts = [(part.get("Name"), part.findtext("{*}TemplateValue[@Name='SrcType']")) for part in root.iter("{*}Part")]
    return [f"{name} {kind}" for name, kind in parts if kind is not None], root


@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize("condition", WORDS)
def test_boxes_have_the_types_of_what_comes_from_other_boxes(condition: str, language: str) -> None:
    """AND of words was `A` or a series of contacts, and a comparison behind a box was of Int."""
    boxes, root = _written(language, condition)
    assert boxes == WORDS[condition]
    for net in root.iter("{*}FlgNet"):
        words = {access.get("UId") for access in net.iter("{*}Access") if access.find(".//*[@Name='w']") is not None}
        of_bits = {part.get("UId") for part in net.iter("{*}Part") if part.get("Name") in ("Contact", "A", "O", "X")}
        wired = [{end.get("UId") for end in wire} for wire in net.iter("{*}Wire")]
        assert not any(ends & words and ends & of_bits for ends in wired)


@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize(("value", "boxes"), [("w AND v", ["And Word"]), ("w XOR 16#0F", ["Xor Word"])])
def test_words_are_assigned_by_boxes_of_words(value: str, boxes: list[str], language: str) -> None:
    assert _written(language, "a", value)[0] == boxes


@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize(("condition", "value"), [("(NOT w) = v", "w"), ("a", "NOT w"), ("(w AND NOT v) = 1", "w")])
def test_not_of_a_word_is_refused_as_no_network_has_it(condition: str, value: str, language: str) -> None:
    with pytest.raises(sfc.LossError, match=r"negates no|has no box|contacts and coils are of BOOL"):
        _written(language, condition, value)


@pytest.mark.parametrize("language", ["FBD", "LD"])
@pytest.mark.parametrize(
    "condition",
    ["a = b", "a <> b", "a > b", "NOT (a <= b)", "(i > 3) = a", "b = TRUE AND a <> FALSE", "(a AND b) >= (a = b)"],
)
def test_comparisons_of_bits_are_logic(condition: str, language: str) -> None:
    """They were refused, as TIA Portal has no box that compares them; conversion made logic of them."""
    boxes, _ = _written(language, condition)
    assert set(boxes) <= {"Gt Int", "Le Int"}


@pytest.mark.parametrize("condition", ["a AND (b XOR q)", "NOT (a XOR b)", "a = b AND (a <> q)"])
def test_xor_of_two_variables_is_contacts_in_a_ladder(condition: str) -> None:
    """A box XOR in a series needs a box AND, which LAD does not have."""
    _, root = _written("LD", condition)
    assert {part.get("Name") for part in root.iter("{*}Part")}.isdisjoint({"A", "X", "Not"})


def test_a_block_that_was_graph_is_none_any_more() -> None:
    lowered = sfc.lower(sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml"), "bits", verify=False)
    for fresh in (False, True):
        data = sfc.dumps(lowered.project, format="simaticml", fresh=fresh)
        block = etree.fromstring(data).find("SW.Blocks.FB")
        assert block is not None
        assert block.findtext("AttributeList/ProgrammingLanguage") == "SCL"
        names = {value.tag for value in block.iterfind("AttributeList/*")}
        assert names.isdisjoint({"GraphVersion", "LanguageInNetworks", "SkipSteps", "WithAlarmHandling"})
        assert b"GRAPH_BASE" not in data
        assert b"G7_" not in data


_TIMED = """GRAFCET G
INPUTS
    a
OUTPUTS
    Q
    H
INITIAL STEP 1
1 -> 2 : a
STEP 2
    Q AFTER 3s
    H FOR 2s
2 -> 3 : /a
STEP 3
3 -> 1 : 1
"""


@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_timers_have_no_enable_input(language: str) -> None:
    """Boxes of timers and counters in TIA Portal have none: a jump leads around what is not to be executed."""
    lowered = sfc.lower(sfc.loads(_TIMED.encode()), "flipflop", language=language, target="simaticml")
    assert lowered.proof is not None
    assert lowered.proof.proven
    root = etree.fromstring(sfc.dumps(lowered.project, format="simaticml"))
    parts = [part for part in root.iter("{*}Part") if part.get("Name") == "TON"]
    assert len(parts) == 4, "each time is begun again, and measured"
    for net in root.iter("{*}FlgNet"):
        timers = {part.get("UId") for part in net.iter("{*}Part") if part.get("Name") == "TON"}
        pins = [end.get("Name") for end in net.iter("{*}NameCon") if end.get("UId") in timers]
        assert {"en", "eno"}.isdisjoint(pins)
        labels = list(net.iter("{*}LabelDeclaration"))
        assert len(labels) <= 1
        assert not labels or net.findall("{*}Parts/{*}Part"), "a label is that of a network with logic"
    labels = {each.get("Name") for each in root.iterfind(".//{*}LabelDeclaration/{*}Label")}
    assert labels == {each.get("Name") for each in root.iterfind(".//{*}Access/{*}Label")}
