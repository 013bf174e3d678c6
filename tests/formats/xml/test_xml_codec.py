"""Trees written in the handwriting of a tool."""

from __future__ import annotations

import codecs

import pytest
from lxml import etree

from plcopen_sfc.errors import EncodingError
from plcopen_sfc.formats.xml.xml_codec import XmlStyle, write_xml
from plcopen_sfc.formats.xml.xml_parsing import parse_xml

TREE = '<a x="1"><b/><c>text<!-- c --></c><d> <e y="&gt;"/></d></a>'


def tree(text: str = TREE) -> etree._Element:
    return etree.fromstring(text)


def test_the_usual_style() -> None:
    assert write_xml(tree()).decode() == (
        '<?xml version="1.0" encoding="utf-8"?>\n'
        '<a x="1">\n  <b />\n  <c>text<!-- c --></c>\n  <d>\n    <e y="&gt;" />\n  </d>\n</a>'
    )


def test_every_choice() -> None:
    style = XmlStyle(
        encoding="UTF-16",
        bom=True,
        newline="\r\n",
        indent="\t",
        self_closing="/>",
        declaration="'",
        standalone=True,
        final_newline=True,
    )
    data = write_xml(tree(), style)
    assert data.startswith(codecs.BOM_UTF16_LE)
    assert data.decode("utf-16") == (
        "<?xml version='1.0' encoding='UTF-16' standalone='yes'?>\r\n"
        '<a x="1">\r\n\t<b/>\r\n\t<c>text<!-- c --></c>\r\n\t<d>\r\n\t\t<e y="&gt;"/>\r\n\t</d>\r\n</a>\r\n'
    )
    assert parse_xml(data)[0].tag == "b"


def test_without_declaration_and_indentation() -> None:
    assert write_xml(tree(), XmlStyle(declaration="", indent=None)).decode() == TREE.replace("/>", " />")
    assert write_xml(tree(), XmlStyle(bom=True)).startswith(codecs.BOM_UTF8 + b"<?xml")
    assert b"standalone='no'" in write_xml(tree(), XmlStyle(standalone=False, declaration="'"))


@pytest.mark.parametrize(
    "text",
    [
        "<a><b>x <i>y</i> <i>z</i></b></a>",
        "<a><b><i>y</i> <i>z</i> x</b></a>",
        "<a><b>x <i><j/> <k/></i></b></a>",
        "<a><b>x<!-- c --> <!-- d --></b></a>",
        '<a><b xml:space="preserve"> <i/> <i/></b></a>',
        "<a><b>  </b></a>",
        "<a><b>\n</b></a>",
    ],
)
def test_text_is_never_reformatted(text: str) -> None:
    inner = text[3:-4]
    expected = f"<a>\n  {inner}\n</a>"
    assert write_xml(tree(text), XmlStyle(declaration="", self_closing="/>")).decode() == expected


def test_a_space_before_the_end_of_empty_elements_only() -> None:
    text = '<a x="/&gt;"><!-- a/> --><?p b/>?><b><![CDATA[c/>]]></b>d/&gt;<e/></a>'
    root = parse_xml(text.encode())
    assert write_xml(root, XmlStyle(declaration="")).decode() == text.replace("<e/>", "<e />")


def test_line_ends_in_text_follow_the_style() -> None:
    root = tree("<a>x\ny</a>")
    root.text = "x\ny\r"
    root.set("k", "1\n2")
    assert write_xml(root, XmlStyle(declaration="", newline="\r\n")) == b'<a k="1&#10;2">x\r\ny&#13;</a>'


def test_comments_around_the_root() -> None:
    root = parse_xml(b"<!-- 1 --><?p?><a/><!-- 2 -->")
    assert write_xml(root, XmlStyle(declaration="")) == b"<!-- 1 -->\n<?p?>\n<a />\n<!-- 2 -->"


def test_characters_beyond_the_code_page() -> None:
    root = tree('<a x="€ä">€<b>ä</b></a>')
    style = XmlStyle(encoding="ISO-8859-1", indent=None)
    assert write_xml(root, style) == (
        '<?xml version="1.0" encoding="ISO-8859-1"?>\n<a x="&#8364;ä">&#8364;<b>ä</b></a>'.encode("latin-1")
    )
    root.text = None
    root[0].text = etree.CDATA("<€>")
    assert parse_xml(write_xml(root, style))[0].text == "<€>"


@pytest.mark.parametrize("text", ["<a><€/></a>", '<a €="1"/>', "<a><!-- € --></a>", "<a><?p €?></a>"])
def test_names_beyond_the_code_page_are_refused(text: str) -> None:
    root = tree(text.replace("€", "ж"))
    with pytest.raises(EncodingError, match="'ж' in a name, comment or instruction cannot be written"):
        write_xml(root, XmlStyle(encoding="windows-1252"))


def test_a_subtree_is_written_without_what_follows_it() -> None:
    assert write_xml(tree()[1], XmlStyle(declaration="")) == b"<c>text<!-- c --></c>"


def test_cdata_stays() -> None:
    root = parse_xml(b"<a><b><![CDATA[<]]></b></a>")
    assert write_xml(root, XmlStyle(declaration="")) == b"<a>\n  <b><![CDATA[<]]></b>\n</a>"
