"""Step flags outside of the POU: with addresses that count on, or in a data block."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, lower, lower_project
from plcopen_sfc.semantics.simulation import simulate
from tests.lowering.charts import boolean, pou_with, training_chain
from tests.sweeps import examples

FORMS = [("flipflop", "FBD"), ("flipflop", "LD"), ("flipflop", "ST"), ("bits", "ST")]
TARGETS = ["plcopen-2.01", "codesys", "simaticml", "scl", "iec-text"]


def project(steps: int = 4) -> m.Project:
    if steps == 4:
        return m.Project(name="Anlage", pous=[training_chain()])
    chart = m.SfcNetwork()
    made = [chart.add_step(f"S{number}", initial=number == 1) for number in range(1, steps + 1)]
    for number, step in enumerate(made):
        chart.add_transition(step, made[(number + 1) % steps], "a")
    return m.Project(pous=[pou_with(chart)])


@pytest.mark.slow
@pytest.mark.parametrize("flags", ["M20.6", "Steps"])
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_it_does_what_the_chart_does(construction: str, language: str, target: str, flags: str) -> None:
    if language != "ST" and target in ("scl", "iec-text"):
        pytest.skip("text has no networks")
    lowered = lower(project(), construction, language=language, flags=flags, target=target)
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    assert {f"S{n}.X" for n in range(1, 5)} <= set(lowered.proof.compared)
    again = sfc.loads(sfc.dumps(lowered.project, format=target, partial=True))
    found = equivalent(project(), again, "iec")
    assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(25))
@given(st.integers(0, 40), st.integers(0, 7), st.integers(1, 12), st.sampled_from(["simaticml", "codesys", None]))
def test_addresses_count_on_with_a_carry(byte: int, bit: int, steps: int, target: str | None) -> None:
    for spelled in (f"M{byte}.{bit}", f"%mx{byte}.{bit}"):
        lowered = lower(project(steps), "bits", flags=spelled, target=target, verify=False).project
        if target == "simaticml":
            (table,) = lowered.tag_tables
            found = [(tag.name, tag.address) for tag in table.tags]
        else:
            lists = lowered.global_variables if target else lowered.configurations[0].global_variables
            found = [(variable.name, variable.address) for variable in lists[0].variables]
        places = [byte * 8 + bit + number for number in range(steps)]
        mark = "%M" if target == "simaticml" else "%MX"
        assert found == [(f"X{n}", f"{mark}{place // 8}.{place % 8}") for n, place in enumerate(places, 1)]


def test_tia_portal_gets_a_table_of_tags_with_comments() -> None:
    lowered = lower(project(), "flipflop", flags="M20.0", target="simaticml", lang="de").project
    (table,) = lowered.tag_tables
    assert table.name == "Schrittmerker_Ablauf"
    assert [tag.address for tag in table.tags] == ["%M20.0", "%M20.1", "%M20.2", "%M20.3"]
    assert m.plain(table.tags[1].comment) == "Schritt S2 ist aktiv"
    content = sfc.dumps(lowered, format="simaticml").decode("utf-8-sig")
    assert "<LogicalAddress>%M20.3</LogicalAddress>" in content
    assert 'Scope="GlobalVariable"' in content


def test_networks_of_flags_with_addresses_have_the_titles_of_textbooks() -> None:
    for lang, title in (("de", "Schrittmerker X1 (M20.0)"), ("en", "Step flag X1 (M20.0)")):
        lowered = lower(
            project(), "flipflop", flags="M20.0", target="simaticml", lang=lang, style="classic", verify=False
        )
        assert isinstance(lowered.pou.body, m.FbdBody)
        network = next(each for each in lowered.pou.body.networks if m.plain(each.title) == title)
        assert "Initialschritt" in m.plain(network.comment) if lang == "de" else network.comment
    named = lower(project(), "flipflop", flags="M20.0", target="codesys", flag_names="SR01", lang="de", verify=False)
    assert "Schrittmerker SR02 (M20.1)" in sfc.dumps(named.project, format="codesys", partial=True).decode()


PLANS = """GRAFCET Anlage
INPUTS
    a
CHART G1
    INITIAL STEP 1
    1 -> 2 : a
    STEP 2
    2 -> 1 : /a
CHART G2
    INITIAL STEP 10
    10 -> 11 : a
    STEP 11
    11 -> 10 : /a
"""


@pytest.mark.parametrize(("construction", "target"), [("flipflop", "simaticml"), ("bits", "scl"), ("bits", "codesys")])
def test_partial_charts_have_ranges_of_their_own(construction: str, target: str) -> None:
    plan = sfc.loads(PLANS.encode())
    lowered = lower(plan, construction, flags="G1=M20.0, G2=M24.0", target=target)
    assert lowered.proof is not None
    assert lowered.proof.equal
    tags = [(t.name, t.address) for table in lowered.project.tag_tables for t in table.tags]
    tags += [(v.name, v.address) for section in lowered.project.global_sections() for v in section.variables]
    found = [(name, (address or "").replace("%MX", "%M")) for name, address in tags]
    assert found == [("X1", "%M20.0"), ("X2", "%M20.1"), ("X10", "%M24.0"), ("X11", "%M24.1")]


@pytest.mark.parametrize("flags", ["M20.0", "G1=M20.0", "G1=M20.0,G2=M24.0"])
def test_the_chart_beside_an_emergency_stop_has_its_range(flags: str) -> None:
    """Its chart has no steps in the textbook form, so that a range for it is not used."""
    plan = sfc.load("fixtures/grafcet/two_cylinders.gct")
    lowered = lower(plan, "fup", style="classic", flags=flags, target="simaticml", lang="de", verify=False)
    found = [(tag.name, tag.address) for tag in lowered.project.tag_tables[-1].tags]
    assert found == [(f"X{step}", f"%M20.{step - 1}") for step in range(1, 6)]


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ("G1=M20.0", "the flag X10 has no address"),
        ("G1=M20.0,G3=M24.0", "no chart 'g3' for flags"),
        ("G1=M20.0,G2=M20.1", "the address of the flag X10 belongs to X2 already"),
        ("G1=M20.0,M24.0", "is no place for flags"),
        ("M16383.7", "bit memory ends with M16383.7"),
        ("M99999999.0", "bit memory ends with M16383.7"),
    ],
)
def test_a_range_that_does_not_fit_is_refused(flags: str, message: str) -> None:
    with pytest.raises(LoweringError, match=message):
        lower(sfc.loads(PLANS.encode()), "bits", flags=flags, target="scl", verify=False)


def test_charts_of_a_project_have_ranges_by_name() -> None:
    other = training_chain()
    other.name = "Presse"
    plant = m.Project(name="Anlage", pous=[training_chain(), other], dialect=m.Dialect.SCL)
    lowered = lower_project(plant, "bits", flags="Ablauf=M20.0,Presse=M30.0", target="scl", profile="iec")
    first = [table.tags[0].address for table in lowered.project.tag_tables]
    assert first == ["%M20.0", "%M30.0"]


def test_comments_of_tags_are_in_the_language_asked_for() -> None:
    """Not in that of the project, as its own texts are."""
    lowered = lower(project(), "flipflop", flags="M20.0", target="simaticml", lang="de", verify=False)
    tag = lowered.project.tag_tables[0].tags[0]
    assert tag.comment == m.MultilingualText(texts={"de-DE": "Schritt S1 ist aktiv"})
    data = sfc.dumps(lowered.project, format="simaticml").decode("utf-8-sig")
    assert re.findall(r"<Culture>([\w-]+)</Culture>\s*<Text>Schritt S1 ist aktiv<", data) == ["de-DE"]


@pytest.mark.parametrize(("lang", "culture"), [("de", "de-DE"), ("en", "en-US")])
def test_comments_of_tags_have_the_language_of_the_code(lang: str, culture: str, tmp_path: Path) -> None:
    """Those of inputs and outputs, which a GRAFCET has in one language, were English beside German flags."""
    plan = sfc.load("fixtures/grafcet/two_cylinders.gct")
    lowered = lower(plan, "flipflop", target="simaticml", flags="M20.0", lang=lang, verify=False)
    (tmp_path / "tags").mkdir()
    sfc.save(lowered, tmp_path / "tags", format="simaticml")
    tables = [path.read_text(encoding="utf-8") for path in tmp_path.glob("tags/PLC tags/*.xml")]
    assert {found for each in tables for found in re.findall(r"<Culture>([\w-]+)<", each)} == {culture}


def test_flags_that_kept_their_values_are_set_back_in_the_first_scan() -> None:
    """Memory bits of S7 have no start values, and some of them keep what they had."""
    for construction, language in FORMS:
        lowered = lower(project(), construction, language=language, flags="M20.0", target="simaticml").project
        old = simulate(lowered, pou="Ablauf", scans=2, initial={"X3": True}, record=["Q1", "Q3", "X1", "X3"])
        for scan in range(2):
            assert old["X1"][scan] is True
            assert old["X3"][scan] is False


def test_a_data_block_has_the_flags_with_their_start_values() -> None:
    lowered = lower(project(), "flipflop", flags="Steps", target="simaticml").project
    (block,) = lowered.data_blocks
    assert block.interface is not None
    values = [
        (v.name, v.initial.text if isinstance(v.initial, m.SimpleValue) else None) for v in block.interface.variables()
    ]
    assert values == [("X1", "TRUE"), ("X2", None), ("X3", None), ("X4", None)]


def test_iec_declares_them_as_external() -> None:
    lowered = lower(project(), "bits", flags="Steps", target="plcopen-2.01")
    assert lowered.pou.interface is not None
    (external,) = [s for s in lowered.pou.interface.sections if s.kind is m.SectionKind.EXTERNAL]
    assert [variable.name for variable in external.variables] == ["X1", "X2", "X3", "X4"]
    bare = sfc.dumps(lowered.project, format="plcopen-2.01")
    assert b"<globalVars" in bare
    assert b"<externalVars" in bare


def test_names_of_the_project_are_kept_out_of_the_way() -> None:
    original = project()
    taken = m.VariableSection(kind=m.SectionKind.GLOBAL, name="GVL", variables=[boolean("X2")])
    original.global_variables.append(taken)
    lowered = lower(original, "bits", flags="M20.0", target="codesys").project
    assert [variable.name for variable in lowered.global_variables[1].variables] == ["X1", "X2_2", "X3", "X4"]
    with pytest.raises(LoweringError, match="something called Ablauf"):
        lower(original, "bits", flags="Ablauf")


@pytest.mark.parametrize(
    ("address", "dialect", "clash"),
    [
        ("%M20.2", m.Dialect.SCL, True),
        ("%MB20", m.Dialect.SCL, True),
        ("%MW19", m.Dialect.SCL, True),
        ("%MD17", m.Dialect.SCL, True),
        ("%MD16", m.Dialect.SCL, False),
        ("%MW10", m.Dialect.CODESYS, True),
        ("%MW20", m.Dialect.CODESYS, False),
        ("%MD5", m.Dialect.CODESYS, True),
        ("%QW20", m.Dialect.SCL, False),
    ],
)
def test_addresses_of_others_are_not_touched(address: str, dialect: m.Dialect, clash: bool) -> None:
    original = m.Project(pous=[training_chain()], dialect=dialect)
    if dialect is m.Dialect.SCL:
        original.tag_tables.append(m.TagTable(name="Tags", tags=[m.Tag(name="Other", type="Bool", address=address)]))
    else:
        other = boolean("Other")
        other.address = address
        original.global_variables.append(m.VariableSection(kind=m.SectionKind.GLOBAL, name="G", variables=[other]))
    if clash:
        with pytest.raises(LoweringError, match="belongs to Other"):
            lower(original, "bits", flags="M20.0", profile="iec", verify=False)
    else:
        lower(original, "bits", flags="M20.0", profile="iec", verify=False)


@pytest.mark.parametrize("flags", ["20.0", "M20.8", "M20", "a b", "", "1x"])
def test_what_is_no_place_is_refused(flags: str) -> None:
    with pytest.raises(LoweringError, match="is no place for flags"):
        lower(project(), "bits", flags=flags)


def test_a_case_has_no_flags() -> None:
    with pytest.raises(LoweringError, match="flags that could be put elsewhere"):
        lower(project(), "case", flags="M20.0")
    assert lower(project(), "auto", flags="M20.0").construction is Construction.BITS


def test_a_list_of_flags_is_not_there_twice() -> None:
    other = training_chain()
    other.name = "Presse"
    plant = m.Project(name="Anlage", pous=[training_chain(), other], dialect=m.Dialect.CODESYS)
    first = lower(plant, "bits", pou="Ablauf", flags="Bits", target="codesys", verify=False)
    with pytest.raises(LoweringError, match="there is something called Bits already"):
        lower(first.project, "bits", pou="Presse", flags="Bits", target="codesys", verify=False)


@pytest.mark.slow
@pytest.mark.parametrize("flags", ["M20.6", "Steps"])
@pytest.mark.parametrize(
    ("construction", "language", "target"),
    [("auto", "ST", "scl"), ("flipflop", "FBD", "simaticml"), ("flipflop", "LD", "codesys"), ("bits", "ST", "codesys")],
)
def test_flags_of_sequencers_stand_there_too(construction: str, language: str, target: str, flags: str) -> None:
    sequencer = sfc.load("fixtures/simaticml-training-chain/Ablauf.xml")
    lowered = lower(sequencer, construction, language=language, flags=flags, target=target, at_rest=["all"])
    assert lowered.construction in (Construction.BITS, Construction.FLIPFLOP)
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)
    assert not {variable.name for variable in lowered.pou.variables()} & {"X1", "X2", "X3", "X4"}
    again = sfc.loads(sfc.dumps(lowered.project, format=target, partial=True), format=target)
    fixed = lowered.at_rest
    found = equivalent(sequencer, again, "s7graph", step_flags=lowered.step_flags, fixed=fixed)
    assert found.kind is VerdictKind.PROVEN, str(found)
