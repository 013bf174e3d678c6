"""Files of other tools are recognised and refused with what to do; pieces of programs with what is missing."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.cli import main
from plcopen_sfc.errors import UnknownFormatError, UnreadFormatError
from plcopen_sfc.formats.file_recognition import UNREAD
from tests.corpus import ROOT, corpus_files, require_corpus

HEADER = "(* @NESTEDCOMMENTS := 'Yes' *)\n(* @PATH := '' *)\n(* @OBJECTFLAGS := '0, 8' *)\n"
UNIT = "PROGRAM Main\nVAR\n  x : INT;\nEND_VAR\nx := 1;\nEND_PROGRAM\n"
STL = 'FUNCTION_BLOCK "Pump"\nTITLE =\nVERSION : 0.1\n\nBEGIN\nNETWORK\nTITLE =Start\n      U     E 0.0;\n'

FILES = {
    "Plant.tsproj": ("<TcSmProject/>", "Export PLCopenXML"),
    "Old.pro": ("\0\1\2", "V2.3 Converter"),
    "Plant.project": ("PK\3\4\0\0", "Project > Export PLCopenXML"),
    "Plant.projectarchive": ("PK\3\4\0\0", "Extract Archive"),
    "Routine.L5X": ('<?xml version="1.0"?>\n<RSLogix5000Content SchemaRevision="1.0"/>', "L5X and L5K only"),
    "Plant.L5K": ("IE_VER := 2.19;\n\nCONTROLLER Plant\n", "L5X and L5K only"),
    "Plant.ACD": ("\0\1", "L5X and L5K only"),
    "Main.xsf": ("<SFCExchangeFile><chartSource/></SFCExchangeFile>", "no export to PLCopen XML"),
    "Plant.xef": ("<FEFExchangeFile/>", "no export to PLCopen XML"),
    "Plant.zef": ("PK\3\4\0\0", "no export to PLCopen XML"),
    "Plant.stu": ("\0\1", "no export to PLCopen XML"),
    "Phase.fhx": ('/* Version: 14.3.1 */\n/* "01-Jan-2024" */\n\nSCHEMA\n user="A"\n{\n}\n', "DeltaV"),
    "Main.s7dcl": ('\ufeff{\n    S7_Version := "0.1"\n}\nFUNCTION_BLOCK "Main"\nEND_FUNCTION_BLOCK\n', "Openness"),
    "Type.s7dcl": ("TYPE\n    T : STRUCT\n        x : Int;\n    END_STRUCT;\nEND_TYPE\n", "Openness"),
    "Main.s7res": ("MultiLingualTexts:\n  - id: MLC_1\n", "Openness"),
    "Pump.awl": (STL, "Migrate Project|Migrate project"),
    "Chain.gr7": ("FUNCTION_BLOCK FB1\nVAR\nEND_VAR\n", "Migrate project"),
    "Source.txt": ("INITIAL_STEP S1 (*$_NUM 1*):\nEND_STEP\n", "Migrate project"),
    "grafcet.ecore": ('<ecore:EPackage xmlns:ecore="http://www.eclipse.org/emf/2002/Ecore"/>', "AGRAFE"),
    "Plant.ap17": ("\0\1", "Generate source from blocks"),
    "Plant.zap19": ("7z\xbc", "Project > Retrieve"),
    "Plant.s7p": ("\0\1", "Migrate project"),
    "Main.xml": ('<Project xmlns="www.iec.ch/public/TC65SC65BWG7TF10"/>', "PLCopen XML"),
    "beremiz.xml": ('<BeremizRoot URI_location="LOCAL://"/>', "plc.xml"),
    "Press.clp": ("_FILES_CLASSICLADDER\n_FILE-timers.csv\n", "ClassicLadder"),
}


@pytest.mark.parametrize("name", FILES)
def test_files_of_other_tools_are_refused_with_what_to_do(name: str, tmp_path: Path) -> None:
    content, advice = FILES[name]
    path = tmp_path / name
    path.write_bytes(content.encode())
    with pytest.raises(UnreadFormatError, match="which is not read") as caught:
        sfc.load(path)
    assert re.search(advice, caught.value.hint)
    assert caught.value.location.file == str(path)
    assert main(["convert", str(path), "--to", "json"]) == 2
    assert list(tmp_path.iterdir()) == [path]


def test_every_row_of_the_table_is_tried() -> None:
    refused = set()
    for name, (content, _) in FILES.items():
        with pytest.raises(UnreadFormatError) as caught:
            sfc.loads(content.encode(), path=name)
        refused.add(caught.value.message)
    assert refused == {f"this is {kind.title}, which is not read" for kind in UNREAD}


def test_a_format_that_is_named_is_tried_all_the_same() -> None:
    assert sfc.loads(b"FUNCTION_BLOCK x\nEND_FUNCTION_BLOCK", path="x.gr7", format="iec-text").pous[0].name == "x"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("Main.EXP", f"\n{HEADER}{UNIT}"),
        ("renamed.txt", f"{HEADER}{UNIT}"),
        ("step7_names.EXP", f"{HEADER}FUNCTION_BLOCK FB12\nVAR\nEND_VAR\nEND_FUNCTION_BLOCK\n"),
        ("without_pragmas.exp", UNIT),
        ("", UNIT.replace("x := 1", "(* @END_DECLARATION := '0' *)\r\nx := 1")),
        ("", "FUNCTION_BLOCK a\r\nVAR\r\nEND_VAR\r\n_LD_BODY\r\n_NETWORKS : 0\r\nEND_FUNCTION_BLOCK\r\n"),
        ("a.txt", "PROGRAM a\nVAR\nEND_VAR\nINITIAL_STEP b:\nEND_STEP\n(* @SFCMAXTIME := '' *)\nEND_PROGRAM\n"),
        ("libraries.EXP", "\nLIBRARY\nStandard.lib 5.12.05 12:20:58\nEND_LIBRARY\n"),
    ],
)
def test_exports_of_codesys_2_3_are_no_iec_text(name: str, text: str) -> None:
    source = sfc.loads(text.encode(), path=name or None).source
    assert source is not None
    assert source.format == "codesys23"


def test_a_pragma_of_an_export_in_a_text_is_no_export() -> None:
    quoted = UNIT.replace("x := 1", "(* such as (* @END_DECLARATION := '0' *) *)\n  x := 1")
    source = sfc.loads(quoted.encode()).source
    assert source is not None
    assert source.format == "iec-text"


def test_a_folder_of_another_tool_is_refused_as_its_files_are(tmp_path: Path) -> None:
    (tmp_path / "Plant.tsproj").write_text(FILES["Plant.tsproj"][0])
    with pytest.raises(UnreadFormatError, match="a project of TwinCAT"):
        sfc.load(tmp_path)


@pytest.mark.parametrize(
    ("name", "text", "message", "missing"),
    [
        ("part.scl", "IF #Start THEN\n  #Run := TRUE;\nEND_IF;\n", "SCL without its block", "BEGIN"),
        ("part.txt", 'REGION A\n"Data".x := #y + 1;\nEND_REGION\n', "SCL without its block", "Generate source"),
        (
            "part.txt",
            "VAR_INPUT\n  x : Bool;\nEND_VAR\nBEGIN\n#y := 1;\n",
            "begins with declarations",
            "END_FUNCTION_BLOCK",
        ),
        ("part.st", "x := 1;\ny := x;\n", "structured text without its block", "FUNCTION_BLOCK Name before"),
        ("part.txt", "VAR\n  x : INT;\nEND_VAR\nx := 1;\n", "structured text without its block", "behind it"),
        ("empty.scl", "// nothing yet\n", "no block begins", "whole blocks"),
    ],
)
def test_pieces_of_programs_are_told_as_such(name: str, text: str, message: str, missing: str) -> None:
    with pytest.raises(UnknownFormatError, match=message) as caught:
        sfc.loads(text.encode(), path=name)
    assert missing in caught.value.hint
    assert "XML" not in str(caught.value)


def test_what_is_no_program_is_not_taken_for_one() -> None:
    for text in ("a;b;c\n1;2;3\n", "hello := world, this; is a text: with; and (( more;"):
        with pytest.raises(sfc.FormatError, match="plain text, not XML"):
            sfc.loads(text.encode(), path="notes.txt")


def test_our_own_fixtures_are_read() -> None:
    """No row of the table takes a file of a format that is read."""
    for path in (ROOT / "fixtures").rglob("*"):
        if (
            path.is_file()
            and "broken" not in path.parts
            and path.suffix in (".xml", ".st", ".scl", ".sfc", ".json", ".EXP")
        ):
            sfc.load(path)


@pytest.mark.corpus
def test_real_files_of_tools_that_are_not_read() -> None:
    require_corpus()
    kinds = {"l5x": ".l5x", "deltav": ".fhx", "schneider": ".xml"}
    kinds |= {"simaticml": ".s7dcl"}
    for kind, extension in kinds.items():
        files = [path for path in corpus_files(kind) if path.suffix.lower() == extension]
        assert files
        for path in files:
            with pytest.raises(UnreadFormatError):
                sfc.loads(path.read_bytes(), path=f"file{extension}" if extension == ".s7dcl" else "file")
