"""Encodings and the safe parser: what is read, and what is refused with which words."""

from __future__ import annotations

import codecs
import re

import pytest
from lxml import etree

from plcopen_sfc.errors import EncodingError, FormatError, UnsafeXmlError, XmlSyntaxError
from plcopen_sfc.formats.xml.xml_parsing import (
    MAX_ATTRIBUTES,
    MAX_DEPTH,
    SourceLines,
    decode_xml,
    detect_encoding,
    parse_xml,
)

TEXT = "<a>Förderer <b/></a>"


@pytest.mark.parametrize(
    ("codec", "bom", "label"),
    [
        ("utf-8", b"", None),
        ("utf-8", b"", "utf-8"),
        ("utf-8", b"", "UTF8"),
        ("utf-8", codecs.BOM_UTF8, None),
        ("utf-8", codecs.BOM_UTF8, "UTF-8"),
        ("utf-16-le", codecs.BOM_UTF16_LE, "utf-16"),
        ("utf-16-le", codecs.BOM_UTF16_LE, None),
        ("utf-16-be", codecs.BOM_UTF16_BE, "UTF-16"),
        ("utf-16-le", b"", "utf-16"),
        ("utf-16-be", b"", "UTF-16BE"),
        ("utf-32-le", codecs.BOM_UTF32_LE, "utf-32"),
        ("utf-32-be", codecs.BOM_UTF32_BE, None),
        ("iso8859-1", b"", "ISO-8859-1"),
        ("iso8859-15", b"", "iso-8859-15"),
        ("cp1252", b"", "windows-1252"),
        ("cp437", b"", "cp437"),
        ("gbk", b"", "GBK"),
    ],
)
def test_encodings(codec: str, bom: bytes, label: str | None) -> None:
    text = (f'<?xml version="1.0" encoding="{label}"?>\r\n' if label else "") + TEXT
    if codec == "gbk":
        text = text.replace("ö", "中")
    data = bom + text.encode(codec)
    decoded, encoding = decode_xml(data)
    assert decoded == text
    assert (encoding.codec, encoding.bom, encoding.declared) == (codec, bom, label)
    assert encoding.encode(decoded) == data
    root = parse_xml(data)
    assert root.text == ("F中rderer " if codec == "gbk" else "Förderer ")
    assert root[0].tag == "b"


def test_ascii_that_is_ascii() -> None:
    assert parse_xml(b'<?xml version="1.0" encoding="us-ascii"?><a>&#246;</a>').text == "ö"


def test_quotes_and_blanks_of_the_declaration() -> None:
    assert (
        detect_encoding(b"<?xml  version = '1.0'\n encoding = 'latin-1' standalone='yes' ?><a/>").codec == "iso8859-1"
    )


@pytest.mark.parametrize(
    ("data", "line", "column", "words"),
    [
        (b"<a>\n  <b>F\xf6n</b></a>", 2, 7, "byte offset 10 (f6)"),
        (b'\xef\xbb\xbf<?xml version="1.0"?>\n<a>\xff</a>', 2, 4, "byte offset 28 (ff)"),
        (
            b'<?xml version="1.0" encoding="us-ascii"?><a>\xc3\xb6</a>',
            1,
            45,
            'encoding="us-ascii", but at byte offset 44',
        ),
        (b'<?xml version="1.0" encoding="windows-1252"?>\n<a>\x81</a>', 2, 4, "byte offset 49 (81)"),
        (codecs.BOM_UTF16_LE + "<a>x</a>".encode("utf-16-le") + b"\x20", 1, 9, "truncated data"),
        (codecs.BOM_UTF16_LE + "<a>".encode("utf-16-le") + b"\x00\xd8" + "</a>".encode("utf-16-le"), 1, 4, "UTF-16"),
    ],
)
def test_bytes_that_are_not_in_the_encoding(data: bytes, line: int, column: int, words: str) -> None:
    with pytest.raises(EncodingError, match=re.escape(words)) as caught:
        parse_xml(data, file="x.xml")
    location = caught.value.location
    assert (location.file, location.line, location.column) == ("x.xml", line, column)
    with pytest.raises(EncodingError):
        decode_xml(data)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b'<?xml version="1.0" encoding="utf-16"?><a/>', "bytes are not UTF-16"),
        (codecs.BOM_UTF8 + b'<?xml version="1.0" encoding="iso-8859-1"?><a/>', "byte order mark it is UTF-8"),
        (codecs.BOM_UTF16_LE + '<?xml version="1.0" encoding="utf-8"?><a/>'.encode("utf-16-le"), "UTF-16-LE"),
        ('<?xml version="1.0" encoding="utf-8"?><a/>'.encode("utf-16-be"), "bytes it is UTF-16-BE"),
        (b'<?xml version="1.0" encoding="klingon"?><a/>', "not known"),
        (b'<?xml version="1.0" encoding=""?><a/>', "not known"),
        (b'<?xml version="1.0" encoding="a\0b"?><a/>', "not known"),
    ],
)
def test_encodings_that_lie(data: bytes, words: str) -> None:
    with pytest.raises(EncodingError, match=words):
        parse_xml(data)


@pytest.mark.parametrize(
    "codec", ["base64", "zlib", "rot13", "idna", "punycode", "utf-7", "unicode_escape", "undefined"]
)
def test_codecs_that_are_no_encodings_of_files(codec: str) -> None:
    with pytest.raises(EncodingError, match="not known"):
        parse_xml(f'<?xml version="1.0" encoding="{codec}"?><a/>'.encode())


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "is empty"),
        (codecs.BOM_UTF8, "nothing but blanks"),
        (b" \r\n\t" * 2000, "nothing but blanks"),
        (b"PK\x03\x04\x14\x00", "ZIP archive"),
        (b"\x1f\x8b\x08\x00", "gzip"),
        (b"\x89PNG\r\n\x1a\n\x00", "PNG picture"),
        (b"\xff\xd8\xff\xe0", "JPEG"),
        (b"%PDF-1.7\n", "PDF"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1\0\0", "OLE"),
        (b"MZ\x90\0\x03", "Windows program"),
        (b'{"steps": [1]}', "JSON"),
        (b"[\n  1, 2]", "JSON"),
        (codecs.BOM_UTF16_LE + '{"a": 1}'.encode("utf-16-le"), "JSON"),
        (b"PROGRAM Main\r\nVAR", "plain text, not XML: it begins with 'PROGRAM Main'"),
        ("Förderer".encode("cp1252"), "it begins with 'Förderer'"),
        (b"[Section]\nkey=1", "plain text"),
        (b"MZ is a name", "plain text"),
        (b"x" * 100, r"it begins with 'x{37}\.\.\.'"),
        (b"\x00\x01\x02\x03", "binary data"),
        (b"<!DOCTYPE html>\n<html><body></body></html>", "HTML page"),
        (b"<HTML><p></HTML>", "HTML page"),
    ],
)
def test_what_is_not_xml_is_named(data: bytes, words: str) -> None:
    with pytest.raises(XmlSyntaxError, match=words) as caught:
        parse_xml(data, file="f")
    assert caught.value.location.line == 1
    assert caught.value.hint


@pytest.mark.parametrize(
    ("data", "place", "words"),
    [
        (b"<a>\n<b>\n<c/>", (3, 5), "ends in the middle of element <b>, opened at line 2"),
        (b"<a>\n<b>\ntext", (3, 5), "ends in the middle of element <b>, opened at line 2"),
        (b'<a>\n<b x="1', (2, 8), "ends inside a tag begun at line 2, in the middle of element <a>, opened at line 1"),
        (b"<a>\n<b", (2, 3), "inside a tag"),
        (b"<a><!-- half", (1, 13), "inside a comment"),
        (b"<a><![CDATA[ <b>", (1, 17), "inside a CDATA section"),
        (b"<a>\n</a", (2, 4), "inside a tag"),
        (b'<?xml version="1.0"?>\n', (2, 1), "no element"),
        (b"<a>\n<b>\n</c></a>", (3, 1), "element <b>, opened at line 2, is closed by </c>"),
        (b'\n<?xml version="1.0"?><a/>', (2, None), "before the XML declaration"),
        (b'<a>\n<b x="1" x="2"/></a>', (2, None), "redefined"),
        (b"<a>\n<b x=1/></a>", (2, None), "AttValue"),
        (b"<a>&nbsp;</a>", (1, None), "nbsp"),
        (b"<a>\n&</a>", (2, None), "not well-formed"),
        (b"<a/>\n<b/>", (2, None), "[Ee]xtra content"),
        (b"<a>\x01</a>", (1, None), "Char"),
        (b"<x:a/>", (1, None), "prefix x"),
    ],
)
def test_syntax_errors(data: bytes, place: tuple[int, int | None], words: str) -> None:
    with pytest.raises(XmlSyntaxError, match=words) as caught:
        parse_xml(data, file="f.xml")
    location = caught.value.location
    assert location.file == "f.xml"
    assert location.line == place[0]
    assert place[1] is None or location.column == place[1]
    assert caught.value.hint


def test_a_truncated_utf16_file_is_explained_too() -> None:
    data = codecs.BOM_UTF16_LE + "<a>\r\n<bär>".encode("utf-16-le")
    with pytest.raises(XmlSyntaxError, match="in the middle of element <bär>, opened at line 2"):
        parse_xml(data)


@pytest.mark.parametrize(
    ("doctype", "words"),
    [
        ('<!DOCTYPE a [<!ENTITY x "y">]>', "declares entities"),
        ('<!DOCTYPE a [ <!ELEMENT a ANY> <!-- > --> <!ENTITY x "y">]>', "declares entities"),
        ('<!DOCTYPE a [<!ENTITY % x "y"> %x;]>', "declares entities"),
        ('<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>', "declares entities"),
        ('<!DOCTYPE a SYSTEM "http://127.0.0.1:9/a.dtd">', "another file"),
        ('<!DOCTYPE a PUBLIC "-//X" "a.dtd">', "another file"),
        ('<?x <!DOCTYPE a> ?><!-- <!DOCTYPE a> -->\n<!DOCTYPE a SYSTEM "b">', "another file"),
    ],
)
@pytest.mark.parametrize("codec", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_unsafe_declarations(doctype: str, words: str, codec: str) -> None:
    text = f"{doctype}<a>&x;</a>"
    if codec == "cp1252":
        text = f'<?xml version="1.0" encoding="windows-1252"?>{text}'
    with pytest.raises(UnsafeXmlError, match=words):
        parse_xml(text.encode(codec))


@pytest.mark.parametrize(
    "data",
    [
        b"<!DOCTYPE a><a/>",
        b"<!DOCTYPE a [<!ELEMENT a ANY>]><a/>",
        b"<a><!-- <!DOCTYPE a SYSTEM 'x'> --></a>",
        b"<!-- <!ENTITY --><a/>",
        b"<a><![CDATA[<!DOCTYPE a SYSTEM 'x'>]]></a>",
    ],
)
def test_harmless_declarations(data: bytes) -> None:
    assert parse_xml(data).tag == "a"


def test_depth() -> None:
    deepest = b"<a>" * MAX_DEPTH + b"</a>" * MAX_DEPTH
    assert sum(1 for _ in parse_xml(deepest).iter()) == MAX_DEPTH
    with pytest.raises(UnsafeXmlError, match="nested deeper than 256"):
        parse_xml(b"<a>" + deepest + b"</a>")


def test_number_of_attributes() -> None:
    def element(count: int) -> bytes:
        return b"<b " + b" ".join(b"a%d=''" % number for number in range(count)) + b"/>"

    many = b"<a>\n<b>" + b'"x" ' * 2000 + b"</b>" + element(MAX_ATTRIBUTES) + b"</a>"
    assert len(parse_xml(many)[1].attrib) == MAX_ATTRIBUTES
    for text in (b"<a>\n" + element(MAX_ATTRIBUTES + 1) + b"</a>", b"\n" + element(MAX_ATTRIBUTES + 1)):
        with pytest.raises(UnsafeXmlError, match="more than 1000 attributes") as caught:
            parse_xml(text)
        assert caught.value.location is not None
        assert caught.value.location.line == 2


@pytest.mark.slow
def test_a_large_text_is_read_and_depth_still_counts() -> None:
    text = b"x" * 10_000_100
    assert len(parse_xml(b"<a><b>" + text + b"</b></a>")[0].text or "") == len(text)
    with pytest.raises(UnsafeXmlError, match="nested deeper"):
        parse_xml(b"<a>" + text + b"<b>" * 300)
    with pytest.raises(XmlSyntaxError, match="in the middle of element <b>"):
        parse_xml(b"<a>" + text + b"<b>")


def test_comments_cdata_and_instructions_are_kept() -> None:
    data = b"<a><!--c--><?p x?><b><![CDATA[<]]></b></a>"
    assert etree.tostring(parse_xml(data)) == data


def test_no_file_name_is_needed() -> None:
    with pytest.raises(FormatError, match=r"^line 1:1: the file is empty"):
        parse_xml(b"")


def test_lines_beyond_the_16_bits_of_libxml2() -> None:
    rows = [f'<s n="{n}"' + ("\n  x='>'" if n % 3 == 0 else "") + ">\n\n</s>" for n in range(40_000)]
    data = ("<r>\r\n<!--\n<s>-->\n" + "\n".join(rows) + "\n<last/></r>").encode()
    root = parse_xml(data)
    lines = SourceLines(root, data)
    expected = 4
    for element in root.iter("s"):
        expected += int(element.get("n") or 0) % 3 == 0
        assert lines.line(element) == expected
        expected += 3
    assert lines.line(root[-1]) == expected
    assert lines.line(etree.Element("new")) is None


def test_lines_beyond_16_bits_in_other_encodings() -> None:
    text = "<r>" + "\n" * 70_000 + "<ä>\n</ä></r>"
    for data in (text.encode("utf-16"), codecs.BOM_UTF8 + text.encode()):
        root = parse_xml(data)
        assert SourceLines(root, data).line(root[0]) == 70_001
