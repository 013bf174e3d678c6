"""Symbol tables of STEP 7 V5: tags and back, both mnemonics, edits, and what has no place in them."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import LossError
from plcopen_sfc.model import MultilingualText, Tag, plain

FILE = Path("fixtures/sdf/two_cylinders.sdf")


def lines(data: bytes) -> list[list[str]]:
    return [[cell.strip(' "') for cell in line.split('","')] for line in data.decode("cp1252").splitlines()]


def test_symbols_are_tags_and_the_file_comes_back() -> None:
    data = FILE.read_bytes()
    project = sfc.loads(data)
    assert project.source is not None
    assert (project.source.format, project.source.version) == ("sdf", "german")
    (table,) = project.tag_tables
    tags = {tag.name: (tag.type, tag.address, tag.comment) for tag in table.tags}
    assert tags["1M1"] == ("Bool", "%Q4.0", "1A1 fährt aus")
    assert tags["Takte"] == ("Int", "%MW30", None)
    assert tags["Wartezeit"] == ("Timer", "%T5", None)
    assert not {"Ablauf", "Analog", "Zyklus"} & tags.keys()
    assert sfc.dumps(project) == data
    assert sfc.dumps(sfc.loads(data, format="sdf")) == data


def test_an_edit_changes_the_lines_of_its_symbols() -> None:
    data = FILE.read_bytes()
    project = sfc.loads(data)
    table = project.tag_tables[0]
    table.tags[0].comment = "hinten"
    del table.tags[1]
    table.tags.append(Tag(name="X6", type="Bool", address="%M20.5", comment="neu"))
    before, after = lines(data), lines(sfc.dumps(project))
    assert [line for line in after if line not in before] == [
        ["1B1", "E 0.1", "BOOL", "hinten"],
        ["X6", "M 20.5", "BOOL", "neu"],
    ]
    assert [line[0] for line in before if line not in after] == ["1B1", "1B2"]
    assert sfc.loads(sfc.dumps(project)).tag_tables == project.tag_tables


def test_mnemonics_are_changed_by_a_conversion() -> None:
    data, report = sfc.convert(sfc.load(FILE), "sdf-international")
    assert not report.losses
    found = {line[0]: line[1] for line in lines(data)}
    assert (found["1M1"], found["START"], found["X1"], found["Ablauf"]) == ("Q 4.0", "I 0.0", "M 20.0", "FB      1")
    assert found["Analog"] == "PIW   256"
    assert {len(line) for line in data.decode("cp1252").splitlines()} == {24 + 12 + 10 + 80 + len('"",' * 4) - 1}
    back = sfc.loads(sfc.convert(sfc.loads(data), "sdf-german").data)
    assert back.tag_tables[0].tags == sfc.load(FILE).tag_tables[0].tags


def test_tags_of_tia_portal_are_symbols_and_symbols_are_tags() -> None:
    data, report = sfc.convert(sfc.load(FILE), "simaticml")
    assert not report.losses
    tags = sfc.loads(data)
    found, wanted = (project.tag_tables[0].tags for project in (tags, sfc.load(FILE)))
    assert [(t.name, t.type, t.address, plain(t.comment)) for t in found] == [
        (t.name, t.type, t.address, plain(t.comment)) for t in wanted
    ]
    symbols = lines(sfc.convert(tags, "sdf").data)
    assert ["2M1", "Q 4.1", "BOOL", "2A1 fährt aus"] in symbols


def test_addresses_of_a_plan_and_flags_of_its_code_are_symbols() -> None:
    plan = sfc.load("fixtures/grafcet/two_cylinders.gct")
    lowered = sfc.lower(plan, "flipflop", flags="M20.0", target="simaticml", lang="de", verify=False)
    with pytest.raises(LossError) as caught:
        sfc.dumps(lowered.project, format="sdf-german")
    why = "a symbol table has symbols with an address, and no program"
    assert [i.why for i in caught.value.report.with_outcome("not executed")] == [why]
    with pytest.raises(LossError) as caught:  # not that its texts are no structured text: they are not written
        sfc.dumps(plan, format="sdf")
    assert [i.why for i in caught.value.report.with_outcome("not executed")] == [why]
    found = lines(sfc.dumps(lowered.project, format="sdf-german", partial=True))
    assert ["START", "E 0.0", "BOOL", "Taster (Schließer)"] in found
    assert ["X1", "M 20.0", "BOOL", "Schritt G1.1 ist aktiv"] in found
    assert len(found) == 8 + 7


def test_a_comment_in_another_alphabet_is_told() -> None:
    project = sfc.load(FILE)
    project.tag_tables[0].tags.append(Tag(name="a", type="Bool", address="%M9.0", comment="Ω und Ж"))
    data, report = sfc.convert(project, "sdf", partial=True, fresh=True)
    assert ["a", "M 9.0", "BOOL", "? und ?"] in lines(data)
    (told,) = (item.why for item in report.items if item.what == "comment")
    assert told.startswith("a question mark replaces ΩЖ")


def test_a_symbol_has_the_comment_of_one_language() -> None:
    tags = sfc.load("fixtures/simaticml/tags.xml")
    for form, comment in (("sdf", "Taster"), ("sdf-german", "Taster")):
        data, report = sfc.convert(tags, form, partial=True)
        assert lines(data)[0][3] == comment
        assert [i.why.rpartition(" ")[2] for i in report.items if i.what == "comment"] == ["en-US"]
    texts = tags.tag_tables[0].tags[0].comment
    assert isinstance(texts, MultilingualText)
    texts.texts = dict(reversed(texts.texts.items()))
    assert [lines(sfc.convert(tags, form, partial=True).data)[0][3] for form in ("sdf", "sdf-german")] == [
        "Button",
        "Taster",
    ]


def test_words_are_at_the_bytes_that_s7_counts() -> None:
    text = b"PROGRAM Pump VAR Level AT %IW2 : INT; Start AT %IX0.1 : BOOL; END_VAR END_PROGRAM"
    project = sfc.loads(text, format="iec-text")
    assert [line[:2] for line in lines(sfc.dumps(project, format="sdf", partial=True))] == [
        ["Level", "IW 4"],
        ["Start", "I 0.1"],
    ]


@pytest.mark.parametrize(
    ("tag", "why"),
    [
        (Tag(name="a", type="Bool", address="%IW4:P"), "%IW4:P is no address of a symbol in STEP 7 V5"),
        (Tag(name="a", type="Bool"), "no address is no address of a symbol in STEP 7 V5"),
        (Tag(name="a", type="LReal", address="%MD8"), "STEP 7 V5 has no type LReal"),
        (Tag(name="START", type="Bool", address="%M9.0"), "the symbol START is E 0.0 already"),
        (Tag(name="a" * 25, type="Bool", address="%M9.0"), "has up to 24 characters"),
        (Tag(name="Ω1", type="Bool", address="%M9.0"), "the code page of STEP 7 V5 has no Ω"),
    ],
)
def test_what_is_no_symbol_is_told(tag: Tag, why: str) -> None:
    project = sfc.load(FILE)
    project.tag_tables[0].tags.append(tag)
    report = sfc.convert(project, "sdf-german", partial=True, fresh=True).report
    assert [item.why for item in report.losses if item.outcome != "dropped"][-1].endswith(why)


def test_a_line_that_is_no_symbol_is_found_and_kept() -> None:
    text = '"a","M 0.0","BOOL",""\r\nM 0.1 b\r\n"c","M 0.8","BOOL",""\r\n" "," "," "," made by hand "\r\n'
    project = sfc.loads(text.encode())
    assert [(d.code, d.location.line) for d in project.diagnostics] == [("SDF101", 2), ("SDF101", 3)]
    project.tag_tables[0].tags[0].name = "A1"
    assert sfc.dumps(project).decode().splitlines()[1:] == text.splitlines()[1:]


def test_an_example_of_the_manual_is_read() -> None:
    text = '"green_phase", "T 2", TIMER","Duration of green"\r\n"red_ped.", "Q 0.0", "BOOL","Red"\r\n'
    (table,) = sfc.loads(text.encode()).tag_tables
    assert [(t.name, t.type, t.address) for t in table.tags] == [
        ("green_phase", "Timer", "%T2"),
        ("red_ped.", "Bool", "%Q0.0"),
    ]
