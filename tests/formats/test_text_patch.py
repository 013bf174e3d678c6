"""Common parts of text formats: encodings, and edits put into a text in its own layout."""

from __future__ import annotations

import pytest

from plcopen_sfc.formats.text_encoding import SourceText, decode_text
from plcopen_sfc.formats.text_patch import BlockSpan, WrittenBlock, numbered, patch_text


@pytest.mark.parametrize(
    ("data", "encoding", "guessed"),
    [
        (b"", "utf-8", False),
        ("Grüße\r\n".encode(), "utf-8", False),
        ("Grüße".encode("utf-8-sig"), "utf-8-sig", False),
        (b"\xff\xfe" + "Grüße".encode("utf-16-le"), "utf-16-le", False),
        (b"\xfe\xff" + "Grüße".encode("utf-16-be"), "utf-16-be", False),
        ("Grüße €".encode("cp1252"), "cp1252", True),
        (b"\x81\xff\x00", "latin-1", True),
        (b"\xef\xbb\xbf\xff", "cp1252", True),
    ],
)
def test_every_file_has_a_text(data: bytes, encoding: str, guessed: bool) -> None:
    source = decode_text(data)
    assert (source.encoding, source.guessed) == (encoding, guessed)
    assert source.encode(source.text) == (data, False)


def test_what_the_code_page_lacks_is_written_in_utf_8() -> None:
    assert SourceText("ä", "cp1252").encode("→") == ("→".encode("utf-8-sig"), True)


def test_equal_keys_are_numbered() -> None:
    keys = [("a", "x"), ("a", "y"), ("a", "x"), ("b", "x"), ("a", "x")]
    assert numbered(keys) == [("a", "x"), ("a", "y"), ("a", "x#2"), ("b", "x"), ("a", "x#3")]


# -- patches ----------------------------------------------------------------------------------------------------------

LINES = "LIST // of things\r\n\tone   : Int;  (* first *)\r\n\r\n\ttwo:Int;\r\n\tthree : Int;\r\nEND // of the list\r\n"


def slices() -> BlockSpan:
    """Where head, things and end stand in `LINES`."""

    def at(text: str, *keys: tuple[str, str]) -> BlockSpan:
        start = LINES.index(text)
        return BlockSpan(keys, (start, start + len(text)))

    inner = (
        at("LIST", ("head", "")),
        at("one   : Int;  (* first *)", ("thing", "one")),
        at("two:Int;", ("thing", "two")),
        at("three : Int;", ("thing", "three")),
        at("END", ("end", "")),
    )
    return BlockSpan((("list", ""),), (0, len(LINES)), inner)


def piece(*things: tuple[str, str]) -> WrittenBlock:
    made = [WrittenBlock(("thing", name), f"    {text}") for name, text in things]
    return WrittenBlock(
        ("list", ""), blocks=(WrittenBlock(("head", ""), "LIST"), *made, WrittenBlock(("end", ""), "END"))
    )


ONE, TWO, THREE = ("one", "one : Int; // first"), ("two", "two : Int;"), ("three", "three : Int;")
BEFORE = piece(ONE, TWO, THREE)


def patched(*things: tuple[str, str]) -> str:
    return patch_text(SourceText(LINES, "utf-8"), slices(), BEFORE, piece(*things))


def test_without_an_edit_nothing_changes() -> None:
    assert patched(ONE, TWO, THREE) == LINES


@pytest.mark.parametrize(
    ("things", "old", "new"),
    [
        ((ONE, ("two", "two : Real;"), THREE), "two:Int;", "two:Real;"),
        ((ONE, ("zwei", "zwei : Int;"), THREE), "two:Int;", "zwei:Int;"),
        ((("one", "one : Real; // first"), TWO, THREE), "one   : Int;", "one   : Real;"),
        ((("one", "one : Int; // 1st"), TWO, THREE), "(* first *)", "// 1st"),
        ((("one", "one : Int := 5; // first"), TWO, THREE), "one   : Int;", "one   : Int := 5;"),
        ((("one", "one : Int;"), TWO, THREE), "Int;  (* first *)", "Int;"),
        ((ONE, THREE), "\ttwo:Int;\r\n", ""),
        ((ONE, TWO), "\tthree : Int;\r\n", ""),
        ((ONE, ("x", "x : Int;"), TWO, THREE), "(* first *)\r\n", "(* first *)\r\n\tx : Int;\r\n"),
        ((("x", "x : Int;"), ONE, TWO, THREE), "things\r\n", "things\r\n\tx : Int;\r\n"),
        ((ONE, TWO, THREE, ("x", "x :\n        Int;")), "three : Int;\r\n", "three : Int;\r\n\tx :\r\n\t    Int;\r\n"),
        ((ONE, ("two", "two : Struct\n        x;"), THREE), "two:Int;", "two:Struct\r\n        x;"),
    ],
)
def test_an_edit_changes_its_place(things: tuple[tuple[str, str], ...], old: str, new: str) -> None:
    assert patched(*things) == LINES.replace(old, new)


def test_what_has_no_place_is_written_with_all_that_is_around_it() -> None:
    whole = BlockSpan((("list", ""),), (0, LINES.index(" // of the list")))
    text = patch_text(SourceText(LINES, "utf-8"), whole, BEFORE, piece(TWO))
    assert text == "LIST\r\n    two : Int;\r\nEND // of the list\r\n"


def test_verbatim_texts_are_not_laid_out() -> None:
    text = "BEGIN\n\tx := 1;\nEND"
    before = WrittenBlock(("body", ""), "\tx := 1;", verbatim=True)
    after = WrittenBlock(("body", ""), "  y := 1;\n\n", verbatim=True)
    place = BlockSpan((("body", ""),), (6, 14))
    assert patch_text(SourceText(text, "utf-8"), place, before, after) == "BEGIN\n  y := 1;\n\n\nEND"
