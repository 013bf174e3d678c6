"""SCL sources: what a reader takes from them, and that they come back."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import FormatError
from plcopen_sfc.model.compare import in_order_of
from tests.corpus import corpus_files, require_corpus

FIXTURES = Path(__file__).resolve().parents[3] / "fixtures" / "scl"
TIA = FIXTURES / "filling_line.scl"
CLASSIC = FIXTURES / "conveyor_step7.scl"


def corpus_sources() -> list[Path]:
    """The sources of the corpus, without one that holds comments only."""
    return [path for path in corpus_files("simaticml") if path.suffix == ".scl" and path.stem != "StateMachine"]


def test_blocks_types_and_data_blocks_of_tia() -> None:
    project = sfc.load(TIA)
    assert project.diagnostics == ()
    assert project.dialect is m.Dialect.SCL
    kinds = {pou.name: pou.kind for pou in project.pous}
    assert kinds == {
        "FB_Fill": m.PouKind.FUNCTION_BLOCK,
        "FC_Scale": m.PouKind.FUNCTION,
        "Main": m.PouKind.ORGANIZATION_BLOCK,
    }
    block = project.pou("FB_Fill")
    assert block.title == "Filling with two valves (it's slow)"
    assert block.comment == 'Fills a tank: coarse first, then fine.\nNeeds "FB_Valve".'
    assert block.interface is not None
    assert [(s.kind, s.retain, s.constant) for s in block.interface.sections[3:]] == [
        (m.SectionKind.LOCAL, True, False),
        (m.SectionKind.LOCAL, False, False),
        (m.SectionKind.TEMP, False, False),
        (m.SectionKind.LOCAL, False, True),
    ]
    start = block.interface.sections[0].variables[0]
    assert (start.name, start.comment) == ("start", "button")
    assert start.attributes == {"S7_HMI_Visible": "true", "ExternalAccessible": "True"}
    assert isinstance(block.body, m.StBody)
    assert block.body.text.startswith("\tREGION Steps\n")
    assert block.body.text.endswith("#busy := #step <> 0;")
    scale = project.pou("FC_Scale").interface
    assert scale is not None
    assert scale.return_type == m.ElementaryType(name="REAL")
    (udt,) = project.data_types
    assert isinstance(udt.type, m.StructType)
    assert [member.name for member in udt.type.members] == ["open", "feedback", "stroke"]


def test_data_blocks() -> None:
    recipe, table, instance = sfc.load(TIA).data_blocks
    assert (recipe.kind, recipe.comment) == (m.DataBlockKind.GLOBAL, "Amounts of the recipe in use")
    assert recipe.interface is not None
    values = {v.name: v.initial for v in recipe.interface.variables()}
    assert values == {
        "amount": m.SimpleValue(text="2.5"),
        "name": m.SimpleValue(text="'Grüße'"),
        "valve": m.StructValue(members=[m.MemberValue(member="open", value="TRUE")]),
        "counter": None,
    }
    assert table.interface is not None
    assert isinstance(table.interface.variables()[0].initial, m.ArrayValue)
    assert (instance.kind, instance.type_name) == (m.DataBlockKind.INSTANCE, "FB_Fill")


def test_a_source_of_step_7_in_its_code_page() -> None:
    project = sfc.load(CLASSIC)
    assert [(d.code, d.location.line) for d in project.diagnostics] == [("SCL201", 1)]
    block = project.pou("FB10")
    assert block.comment == "Förderband für Gepäckstücke"
    assert [block.name for block in project.data_blocks] == ["DB10", "DB11"]
    assert project.data_blocks[0].type_name == "FB10"
    assert isinstance(block.body, m.StBody)
    assert "Größe" in block.body.text


@pytest.mark.parametrize("path", [TIA, CLASSIC], ids=lambda path: path.stem)
def test_fixtures_come_back_byte_for_byte_and_anew_as_an_equal_model(path: Path) -> None:
    project = sfc.load(path)
    assert project.source is not None
    assert project.source.format == "scl"
    assert sfc.dumps(project) == path.read_bytes()
    fresh = sfc.dumps(project, fresh=True)
    assert b"plcopen_sfc" not in fresh
    back = sfc.loads(fresh)
    assert back == in_order_of(project, back)  # what a block names comes before it
    assert sfc.dumps(sfc.loads(fresh), fresh=True) == fresh


@pytest.mark.corpus
def test_the_sources_of_the_corpus_come_back() -> None:
    require_corpus()
    paths = corpus_sources()
    assert len(paths) == 9
    for path in paths:
        project = sfc.load(path)
        assert project.diagnostics == (), path
        assert len(project.pous) == 1, path
        assert sfc.check_syntax(project) == [], path
        assert sfc.dumps(project) == path.read_bytes(), path
        fresh = sfc.dumps(project, fresh=True)
        assert b"plcopen_sfc" not in fresh, path
        assert sfc.loads(fresh) == project, path


@pytest.mark.parametrize(
    ("source", "known"),
    [
        ('FUNCTION "f" : Void\nBEGIN\nEND_FUNCTION', True),
        ("\ufeff// comment\n(* more *)\nDATA_BLOCK DB1 STRUCT END_STRUCT; BEGIN END_DATA_BLOCK", True),
        ("FUNCTION_BLOCK FB12\nBEGIN\nEND_FUNCTION_BLOCK", True),
        ('TYPE "t" STRUCT a : Int; END_STRUCT; END_TYPE', True),
        ("organization_block OB1 BEGIN END_ORGANIZATION_BLOCK", True),
        ("FUNCTION FC1 : VOID\nEND_FUNCTION", True),
        ("FUNCTION_BLOCK FB1 VAR x : INT; END_VAR #x := 1; END_FUNCTION_BLOCK", True),
        ("FUNCTION_BLOCK f VAR x : INT; END_VAR END_FUNCTION_BLOCK", False),
        ("FUNCTION_BLOCK FB1 VAR t : TIME; END_VAR t := T#5s; END_FUNCTION_BLOCK", False),
        ("FUNCTION FC1 : INT VAR_INPUT x : INT; END_VAR FC1 := x + 16#A; END_FUNCTION", False),
        ("// only a comment", False),
    ],
)
def test_sources_are_recognised_by_their_content(source: str, known: bool) -> None:
    data = source.encode()
    if known:
        project = sfc.loads(data)
        assert project.source is not None
        assert project.source.format == "scl"
    else:
        try:
            project = sfc.loads(data)
        except FormatError:
            return
        assert project.source is not None
        assert project.source.format != "scl"


def test_a_source_of_comments_only_is_kept() -> None:
    data = b"// one\n(* two *)\n"
    project = sfc.loads(data, format="scl")
    assert project.comment == "one\ntwo"
    assert sfc.dumps(project) == data
    assert sfc.loads(sfc.dumps(project, fresh=True), format="scl") == project


# -- what is wrong in a source ----------------------------------------------------------------------------------------


BROKEN = b"""FUNCTION_BLOCK "a"
   VAR
      x : Int;
      y ! Int;
   END_VAR
BEGIN
   ;
END_FUNCTION_BLOCK
what is this?
METHOD m
END_METHOD
TYPE "t" : Int; END_TYPE
FUNCTION "b" : Void
BEGIN
"""


def test_what_cannot_be_read_is_kept_and_reported() -> None:
    project = sfc.loads(BROKEN)
    assert [(d.code, d.location.line) for d in project.diagnostics] == [
        ("SCL102", 4),
        ("SCL101", 9),
        ("SCL103", 10),
        ("SCL101", 14),
    ]
    assert [pou.name for pou in project.pous] == ["a", "b"]
    assert sfc.dumps(project) == BROKEN
    fresh = sfc.loads(sfc.dumps(project, fresh=True, partial=True))
    for text in ("y ! Int;", "what is this?", "METHOD m"):
        assert text in sfc.dumps(project, fresh=True, partial=True).decode("utf-8-sig")
    assert [pou.name for pou in fresh.pous] == ["a", "b"]


@pytest.mark.parametrize("count", range(1, 60))
def test_a_source_that_ends_early_is_read_as_far_as_it_goes(count: int) -> None:
    data = TIA.read_bytes()
    data = data[: len(data) * count // 60]
    project = sfc.loads(data, format="scl")
    assert sfc.dumps(project) == data


HOSTILE = {
    "NUL": b'FUNCTION "a" : Void\x00\nBEGIN\n\x00;\nEND_FUNCTION\n',
    "open comment": b'FUNCTION "a" : Void\nBEGIN\n(* open\nEND_FUNCTION\n',
    "open quote": b'FUNCTION "a : Void\nVAR x : Int; END_VAR\nBEGIN\nEND_FUNCTION\n',
    "open brace": b'FUNCTION "a" : Void\n' + b"{ x" * 2000,
    "structures in structures": b'DATA_BLOCK "x"\n' + b"STRUCT a : " * 1000 + b"Int;" + b"END_STRUCT;" * 1000,
    "arrays of arrays": b'TYPE "x" STRUCT a : ' + b"Array[0..1] of " * 1000 + b"Int; END_STRUCT; END_TYPE",
    "one long line": b'FUNCTION "a" : Void VAR ' + b"v : Int; " * 1000 + b"END_VAR BEGIN END_FUNCTION",
    "errors only": b'FUNCTION "a" : Void\nVAR\n' + b"x ! Int;\n" * 1000 + b"END_VAR\nBEGIN\nEND_FUNCTION\n",
    "ends only": b"END_FUNCTION\n" * 1000,
    "heads only": b'FUNCTION "a" : Void\n' * 1000,
}


@pytest.mark.slow
@pytest.mark.parametrize("what", HOSTILE)
def test_whatever_a_source_holds_it_is_kept(what: str) -> None:
    data = HOSTILE[what]
    project = sfc.loads(data, format="scl")
    assert (project.diagnostics == ()) is (what == "one long line")
    assert sfc.dumps(project) == data
    fresh = sfc.dumps(project, fresh=True)
    assert sfc.loads(fresh, format="scl") == project


ORDERED = """PROGRAM Main
VAR f : FB_A; x : INT; END_VAR
f();
x := Twice(1);
END_PROGRAM
FUNCTION_BLOCK FB_A
VAR b : FB_B; s : Outer; END_VAR
b();
END_FUNCTION_BLOCK
FUNCTION_BLOCK FB_B
VAR n : INT; END_VAR
n := Twice(n) + start;
END_FUNCTION_BLOCK
FUNCTION Twice : INT
VAR_INPUT a : INT; END_VAR
Twice := a + a;
END_FUNCTION
VAR_GLOBAL start : INT := 4; END_VAR
TYPE Outer : STRUCT i : Inner; END_STRUCT; END_TYPE
TYPE Inner : STRUCT i : INT; END_STRUCT; END_TYPE
"""


def test_a_source_has_each_block_behind_those_that_it_names() -> None:
    """TIA Portal generates blocks from the beginning of a source to its end."""
    project = sfc.loads(ORDERED.encode(), format="iec-text")
    data, report = sfc.convert(project, "scl")
    heads = [line.split('"')[1] for line in data.decode("utf-8-sig").splitlines() if re.match('[A-Z_]+ "', line)]
    places = {name: place for place, name in enumerate(heads)}
    assert list(places) == ["Inner", "Outer", *[name for name in places if name not in ("Inner", "Outer")]]
    for first, then in [("Twice", "FB_B"), ("FB_B", "FB_A"), ("FB_A", "Main"), ("Main", "Main_DB")]:
        assert places[first] < places[then], heads
    assert not report.with_outcome(sfc.Outcome.DROPPED)
    back = sfc.loads(data)
    assert {pou.name: pou.body for pou in back.pous} == {
        pou.name: pou.body for pou in sfc.loads(data, as_tool=True).pous
    }
