"""The rules of the patch, one by one: what an edit does to the bytes around it."""

from __future__ import annotations

import codecs
import copy
import difflib

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.errors import EncodingError
from plcopen_sfc.formats.xml.source_patch import patch_xml
from plcopen_sfc.formats.xml.source_tree import PatchError
from plcopen_sfc.formats.xml.xml_parsing import parse_xml
from tests.samples import FIXTURES


def edit(source: str, before: str, after: str) -> str:
    """The source after the edit, for XML given without caring for line ends."""
    return patch_xml(source.encode(), etree.fromstring(before), etree.fromstring(after)).decode()


# Attributes


@pytest.mark.parametrize(
    ("source", "before", "after", "expected"),
    [
        ("<a x = 'old' y=\"1\"  />", '<a x="old"/>', '<a x="new"/>', "<a x = 'new' y=\"1\"  />"),
        ("<a x='1'/>", '<a x="1"/>', """<a x="it's &lt;&amp;&quot;"/>""", "<a x='it&apos;s &lt;&amp;\"'/>"),
        ('<a x="1"/>', '<a x="1"/>', "<a x='a&#10;b&#9;c'/>", '<a x="a&#10;b&#9;c"/>'),
        ('<a x="&#97;&gt; 1"/>', '<a x="a> 1"/>', '<a x="a> 2>"/>', '<a x="&#97;&gt; 2&gt;"/>'),
        ('<a x="1" y="2" z="3" />', '<a x="1" y="2"/>', '<a x="1"/>', '<a x="1" z="3" />'),
        ('<a\n   x="1"\n   y="2">t</a>', '<a x="1" y="2">t</a>', '<a y="2">t</a>', '<a\n   y="2">t</a>'),
        ('<a\n   x="1"\n   z="3"/>', '<a x="1"/>', '<a x="1" y="2"/>', '<a\n   x="1"\n   y="2"\n   z="3"/>'),
        ("<a/>", "<a/>", '<a y="2" z="3"/>', '<a y="2" z="3"/>'),
        ("<a z='1'/>", '<a z="1"/>', '<a y="2" z="1"/>', "<a y='2' z='1'/>"),
        ('<a xmlns="u" z="1"/>', '<a xmlns="u" z="1"/>', '<a xmlns="u" y="2" z="1"/>', '<a xmlns="u" y="2" z="1"/>'),
        # stated only by the writer, not by the source: unchanged, changed, removed
        ("<a/>", '<a d="0"/>', '<a d="0"/>', "<a/>"),
        ("<a/>", '<a d="0"/>', '<a d="1"/>', '<a d="1"/>'),
        ("<a/>", '<a d="0"/>', "<a/>", "<a/>"),
        # stated only by the source
        ('<a d="0" x="1"/>', '<a x="1"/>', '<a x="2"/>', '<a d="0" x="2"/>'),
        ('<a d="0"/>', "<a/>", '<a d="1"/>', '<a d="1"/>'),
        # prefixes of the source
        (
            '<a xmlns:q="u" q:x="1"/>',
            '<a xmlns:p="u" p:x="1"/>',
            '<a xmlns:p="u" p:x="2" p:y="3"/>',
            '<a xmlns:q="u" q:x="2" q:y="3"/>',
        ),
        ("<a/>", "<a/>", '<a xmlns:p="u" p:x="2"/>', '<a xmlns:p="u" p:x="2"/>'),
        ('<a xmlns:p="other"/>', "<a/>", '<a xmlns:p="u" p:x="2"/>', '<a xmlns:p="other" xmlns:p1="u" p1:x="2"/>'),
        (
            '<a xmlns="u"/>',
            '<a xmlns="u"/>',
            '<a xmlns="u" xmlns:p="u" p:x="2"/>',
            '<a xmlns="u" xmlns:p="u" p:x="2"/>',
        ),
        ("<a/>", "<a/>", '<a xml:space="preserve"/>', '<a xml:space="preserve"/>'),
    ],
)
def test_attributes(source: str, before: str, after: str, expected: str) -> None:
    assert edit(source, before, after) == expected


# Text


@pytest.mark.parametrize(
    ("source", "before", "after", "expected"),
    [
        ("<a>old</a>", "<a>old</a>", "<a>n&lt;&amp;ew</a>", "<a>n&lt;&amp;ew</a>"),
        ("<a>&quot;x&quot; := &#65;</a>", '<a>"x" := A</a>', '<a>"y" := A</a>', "<a>&quot;y&quot; := &#65;</a>"),
        ("<a>&quot;x&quot;</a>", '<a>"x"</a>', '<a>"x" + "z"</a>', "<a>&quot;x&quot; + &quot;z&quot;</a>"),
        ("<a>x > y</a>", "<a>x &gt; y</a>", "<a>x &gt; z &gt; 1</a>", "<a>x > z > 1</a>"),
        ("<a>x y</a>", "<a>x y</a>", "<a>x &gt; y</a>", "<a>x &gt; y</a>"),
        ("<a>]]</a>", "<a>]]</a>", "<a>]]&gt;</a>", "<a>]]&gt;</a>"),
        ("<a>]] > ></a>", "<a>]] > ></a>", "<a>]]&gt; ></a>", "<a>]]&gt; ></a>"),
        ("<a><![CDATA[x < y]]></a>", "<a>x &lt; y</a>", "<a>x &lt; z &amp; 1</a>", "<a><![CDATA[x < z & 1]]></a>"),
        ("<a><![CDATA[x]]></a>", "<a>x</a>", "<a>x]]&gt;</a>", "<a>x]]&gt;</a>"),
        ("<a>\n<![CDATA[x]]>\n</a>", "<a>x</a>", "<a>yx</a>", "<a>\n<![CDATA[yx]]>\n</a>"),
        ("<a><![CDATA[x]]><!-- c --> y</a>", "<a>x y</a>", "<a>x z</a>", "<a><![CDATA[x]]><!-- c --> z</a>"),
        ("<a>one<!-- c -->two</a>", "<a>onetwo</a>", "<a>one</a>", "<a>one<!-- c --></a>"),
        ("<a>one<!-- c -->two</a>", "<a>onetwo</a>", "<a>ontwo</a>", "<a>on<!-- c -->two</a>"),
        ("<a>one<!-- c -->two</a>", "<a>onetwo</a>", "<a>onXwo</a>", "<a>onX<!-- c -->wo</a>"),
        ("<a></a>", "<a/>", "<a>x</a>", "<a>x</a>"),
        ("<a y='1' />", "<a y='1'/>", "<a y='1'>x</a>", "<a y='1'>x</a>"),
        ("<r><a>x</a><b /></r>", "<r><a>x</a><b/></r>", "<r><a/><b/></r>", "<r><a /><b /></r>"),
        ("<r><a>x</a><b></b></r>", "<r><a>x</a><b/></r>", "<r><a/><b/></r>", "<r><a></a><b></b></r>"),
        ("<a>\n   x := 1;\n</a>", "<a>x := 1;</a>", "<a>x := 2;</a>", "<a>\n   x := 2;\n</a>"),
        ("<a>x</a>", "<a>x</a>", "<a>x&#13;y</a>", "<a>x&#13;y</a>"),
        ("<a>a\r\nb\r\n</a>", "<a>a\nb\n</a>", "<a>a\nc\nd\n</a>", "<a>a\r\nc\r\nd\r\n</a>"),
        ("<a><![CDATA[a\r\nb]]></a>", "<a>a\nb</a>", "<a>a\nb\nc</a>", "<a><![CDATA[a\r\nb\r\nc]]></a>"),
        ("<r>\r\n<a>b</a>\r\n</r>", "<r><a>b</a></r>", "<r><a>b\nc</a></r>", "<r>\r\n<a>b\r\nc</a>\r\n</r>"),
        (
            "<a>&#65;1\n&#65;2\n&#65;3\n&#65;4</a>",
            "<a>A1\nA2\nA3\nA4</a>",
            "<a>B1\nA2\nA3\nA5</a>",
            "<a>B1\n&#65;2\n&#65;3\n&#65;5</a>",
        ),
        ("<a>x <i>y</i> z</a>", "<a>x <i>y</i> z</a>", "<a>x <i>Y</i> Z</a>", "<a>x <i>Y</i> Z</a>"),
        ("<a>x <i>y</i><b/></a>", "<a>x <i>y</i><b/></a>", "<a>x <i>y</i> + <b/></a>", "<a>x <i>y</i> + <b/></a>"),
        (
            "<a>&#65; <i u='1'>y</i><!-- c --> z</a>",
            "<a>A <i>y</i> z</a>",
            "<a>A <b>n</b><i>y</i> z</a>",
            "<a>&#65; <b>n</b><i u='1'>y</i><!-- c --> z</a>",
        ),
        ("<a>\n  <b/>\n</a>", "<a><b/></a>", "<a>text</a>", "<a>text</a>"),
        ("<a>text</a>", "<a>text</a>", "<a><b/></a>", "<a><b /></a>"),
    ],
)
def test_text(source: str, before: str, after: str, expected: str) -> None:
    assert edit(source, before, after) == expected


def test_new_text_is_cdata_if_the_writer_says_so() -> None:
    before = etree.fromstring("<a><b/></a>")
    after = copy.deepcopy(before)
    after[0].text = etree.CDATA("x < 1\ny")
    etree.SubElement(after, "c").text = etree.CDATA("&")
    source = b"<a>\r\n  <b/>\r\n</a>"
    expected = b"<a>\r\n  <b><![CDATA[x < 1\r\ny]]></b>\r\n  <c><![CDATA[&]]></c>\r\n</a>"
    assert patch_xml(source, before, after) == expected


# Children

_SOURCE = """\
<?xml version="1.0"?>
<!-- head -->
<chart>
\t<step localId="1" name="S1" vendor="x"/>  <!-- the first -->

\t<!-- about S2 -->
\t<step localId="2" name="S2">
\t\t<position x="1" y="2" />
\t\t<unknown>
\t\t\t<deep/>
\t\t</unknown>
\t</step>
\t<other/>
\t<step localId="3" name="S3"></step>
</chart>
<!-- tail -->
"""
_BEFORE = (
    '<chart><step localId="1" name="S1"/><step localId="2" name="S2"><position x="1" y="2"/></step>'
    '<step localId="3" name="S3"/></chart>'
)
_S1, _S2, _S3 = (
    '<step localId="1" name="S1"/>',
    '<step localId="2" name="S2"><position x="1" y="2"/></step>',
    '<step localId="3" name="S3"/>',
)
_NEW = '<step localId="9" name="N"><position x="0" y="0"/></step>'
_NEW_LINES = '\t<step localId="9" name="N">\n\t\t<position x="0" y="0"/>\n\t</step>\n'


def chart(*children: str) -> str:
    return f"<chart>{''.join(children)}</chart>"


def lines_changed(after: str) -> tuple[list[str], list[str]]:
    """Lines that the edit removes and adds; all others are the same, in the same order."""
    old = _SOURCE.splitlines(keepends=True)
    new = edit(_SOURCE, _BEFORE, after).splitlines(keepends=True)
    head = 0
    while head < min(len(old), len(new)) and old[head] == new[head]:
        head += 1
    tail = 0
    while tail < min(len(old), len(new)) - head and old[-1 - tail] == new[-1 - tail]:
        tail += 1
    return old[head : len(old) - tail], new[head : len(new) - tail]


def test_nothing_changes_without_an_edit() -> None:
    assert edit(_SOURCE, _BEFORE, _BEFORE) == _SOURCE
    tree = etree.fromstring(_BEFORE)
    assert patch_xml(b"not looked at", tree, tree) == b"not looked at"


def test_a_rename_is_one_line() -> None:
    removed, added = lines_changed(chart(_S1, _S2.replace("S2", "Warten"), _S3))
    assert removed == ['\t<step localId="2" name="S2">\n']
    assert added == ['\t<step localId="2" name="Warten">\n']


@pytest.mark.parametrize(
    ("children", "line"),
    [((_NEW, _S1, _S2, _S3), 4), ((_S1, _NEW, _S2, _S3), 5), ((_S1, _S2, _NEW, _S3), 13), ((_S1, _S2, _S3, _NEW), 15)],
)
def test_a_new_child_is_new_lines_behind_its_neighbour(children: tuple[str, ...], line: int) -> None:
    lines = _SOURCE.splitlines(keepends=True)
    new = edit(_SOURCE, _BEFORE, chart(*children)).splitlines(keepends=True)
    assert new[: line - 1] == lines[: line - 1]
    assert new[line + 2 :] == lines[line - 1 :]
    assert "".join(new[line - 1 : line + 2]) == _NEW_LINES


def test_a_removed_child_takes_its_lines_along() -> None:
    removed, added = lines_changed(chart(_S1, _S3))
    assert len(removed) == 6
    assert added == []
    removed, added = lines_changed(chart(_S1, _S2))
    assert removed == ['\t<step localId="3" name="S3"></step>\n']
    assert added == []


def test_a_removed_child_that_shares_its_line_leaves_the_rest() -> None:
    removed, added = lines_changed(chart(_S2, _S3))
    assert removed == ['\t<step localId="1" name="S1" vendor="x"/>  <!-- the first -->\n']
    assert added == ["\t  <!-- the first -->\n"]


def test_a_replaced_child_stands_in_the_place_of_the_old_one() -> None:
    removed, added = lines_changed(chart(_S1, _S2, '<step localId="7" name="X"><a/><b/></step>'))
    assert removed == ['\t<step localId="3" name="S3"></step>\n']
    assert added == ['\t<step localId="7" name="X">\n', "\t\t<a/>\n", "\t\t<b/>\n", "\t</step>\n"]


def test_a_moved_child_keeps_what_only_the_source_knows() -> None:
    result = edit(_SOURCE, _BEFORE, chart(_S2, _S3, _S1.replace("S1", "First")))
    assert '\t<step localId="3" name="S3"></step>\n\t<step localId="1" name="First" vendor="x"/>\n</chart>' in result
    assert "the first" in result


def test_a_child_moved_into_another_parent_is_indented_anew() -> None:
    group = f"<group>{_S2}</group>"
    result = edit(_SOURCE, _BEFORE, chart(_S1, group, _S3))
    moved = (
        "\t<group>\n"
        '\t\t<step localId="2" name="S2">\n'
        '\t\t\t<position x="1" y="2" />\n'
        "\t\t\t<unknown>\n"
        "\t\t\t\t<deep/>\n"
        "\t\t\t</unknown>\n"
        "\t\t</step>\n"
        "\t</group>\n"
    )
    assert moved in result
    back = patch_xml(result.encode(), etree.fromstring(chart(_S1, group, _S3)), etree.fromstring(_BEFORE))
    assert back.decode() == _SOURCE


def test_a_moved_child_takes_its_namespaces_along() -> None:
    source = '<r><a xmlns:p="u"><p:x p:y="1" own="&#65;"/></a><b xmlns:p="v"/></r>'
    before = '<r xmlns:q="u"><a><q:x q:y="1"/></a><b/></r>'
    after = '<r xmlns:q="u"><a/><b><q:x q:y="1"/></b></r>'
    result = edit(source, before, after)
    assert result == '<r><a xmlns:p="u"/><b xmlns:p="v"><p:x xmlns:p="u" p:y="1" own="&#65;"/></b></r>'


def test_renumbering_keeps_what_only_the_source_knows() -> None:
    after = chart(_S1.replace('"1"', '"10"'), _S2.replace('"2" n', '"20" n'), _S3.replace('"3"', '"30"'))
    result = edit(_SOURCE, _BEFORE, after)
    assert result == _SOURCE.replace('Id="1"', 'Id="10"').replace('Id="2"', 'Id="20"').replace('Id="3"', 'Id="30"')


def test_swapped_names_stay_with_their_ids() -> None:
    after = chart(_S1.replace("S1", "S2"), _S2.replace("S2", "S1"), _S3)
    assert edit(_SOURCE, _BEFORE, after) == _SOURCE.replace('"S1"', '"?"').replace('"S2"', '"S1"').replace(
        '"?"', '"S2"'
    )


def test_a_changed_only_key_is_a_rename() -> None:
    source = '<r>\n  <v name="a" own="1"/>\n  <v name="b"/>\n</r>'
    before = '<r><v name="a"/><v name="b"/></r>'
    assert edit(source, before, before.replace('"a"', '"c"')) == source.replace('"a"', '"c"')


def test_a_copy_of_a_neighbour_is_new() -> None:
    source = '<r>\n  <v own="1"/>\n  <w/>\n</r>'
    result = edit(source, "<r><v/><w/></r>", "<r><v/><w/><v/></r>")
    assert result == '<r>\n  <v own="1"/>\n  <w/>\n  <v/>\n</r>'


def test_comments_of_the_writer_are_written_with_the_line_ends_of_the_file() -> None:
    result = edit("<r>\r\n  <a/>\r\n</r>", "<r><a/></r>", "<r><a/><!--x\ny--></r>")
    assert result == "<r>\r\n  <a/>\r\n  <!--x\r\ny-->\r\n</r>"


def test_many_moves_between_parents() -> None:
    rows = "".join(f'<s localId="{n}"><t/></s>' for n in range(2000))
    own = rows.replace("<t/>", '<t own="1"/>')
    result = edit(f"<r><a>{own}</a><b/></r>", f"<r><a>{rows}</a><b/></r>", f"<r><a/><b>{rows}</b></r>")
    assert result == f"<r><a/><b>{own}</b></r>"


@pytest.mark.parametrize(
    ("source", "before", "after", "expected"),
    [
        ("<a>\n  <b />\n</a>", "<a><b/></a>", "<a/>", "<a />"),
        ("<a><b></b></a>", "<a><b/></a>", "<a/>", "<a></a>"),
        ("<a>\n  <b/>\n  <!-- c -->\n</a>", "<a><b/></a>", "<a/>", "<a>\n  <!-- c -->\n</a>"),
        ("<r>\n  <a />\n</r>", "<r><a/></r>", "<r><a><b/></a></r>", "<r>\n  <a>\n    <b />\n  </a>\n</r>"),
        ("<r>\n\t<a></a>\n</r>", "<r><a/></r>", "<r><a><b/></a></r>", "<r>\n\t<a>\n\t\t<b></b>\n\t</a>\n</r>"),
        ("<r>\n  <a>\n  </a>\n</r>", "<r><a/></r>", "<r><a><b/></a></r>", None),
        ("<r><a/></r>", "<r><a/></r>", "<r><a><b><c/></b></a></r>", "<r><a><b><c/></b></a></r>"),
        ("<r><a/><b/></r>", "<r><a/><b/></r>", "<r><a/><n/><b/></r>", "<r><a/><n/><b/></r>"),
        ("<r><a/><b/></r>", "<r><a/><b/></r>", "<r><b/></r>", "<r><b/></r>"),
        ("<r>\r\n <a/>\r\n</r>", "<r><a/></r>", "<r><a/><n/></r>", "<r>\r\n <a/>\r\n <n/>\r\n</r>"),
        ("<t><BOOL/></t>", "<t><BOOL/></t>", "<t><INT/></t>", "<t><INT/></t>"),
        ("<r>\n  <x/>\n</r>", "<r/>", "<r><n/></r>", "<r>\n  <n/>\n  <x/>\n</r>"),
        ("<r>\n  <a/> <b/>\n  <c/>\n</r>", "<r><a/><b/><c/></r>", "<r><c/></r>", "<r>\n  <c/>\n</r>"),
        # an element that only the writer writes
        ("<r>\n  <a/>\n</r>", "<r><a/><d/></r>", "<r><a/><d/></r>", "<r>\n  <a/>\n</r>"),
        ("<r>\n  <a/>\n</r>", "<r><a/><d/></r>", '<r><a/><d x="1"/></r>', '<r>\n  <a/>\n  <d x="1"/>\n</r>'),
        # the writer's order is not the source's
        (
            "<r>\n  <b/>\n  <a/>\n  <c/>\n</r>",
            "<r><a/><b/><c/></r>",
            '<r><a x="1"/><b/><c/></r>',
            '<r>\n  <b/>\n  <a x="1"/>\n  <c/>\n</r>',
        ),
        # comments that the trees know
        ("<r>\n  <!--a-->\n</r>", "<r><!--a--></r>", "<r><!--b--></r>", "<r>\n  <!--b-->\n</r>"),
        ("<r>\n  <!--a-->\n  <!--x-->\n</r>", "<r><!--a--></r>", "<r/>", "<r>\n  <!--x-->\n</r>"),
        # white space in the trees says nothing
        ("<r>\n  <a/>\n</r>", "<r>\n<a/>\n</r>", "<r>  <a/>  </r>", "<r>\n  <a/>\n</r>"),
        # equal children
        ("<r><a/> <a/><a /></r>", "<r><a/><a/><a/></r>", "<r><a/><a/></r>", None),
        ('<r><a u="1"/><a x="1" u="2"/></r>', '<r><a/><a x="1"/></r>', '<r><a x="1"/></r>', '<r><a x="1" u="2"/></r>'),
        # namespaces
        ('<p:r xmlns:p="u"><p:a/></p:r>', '<r xmlns="u"><a/></r>', '<r xmlns="u"><a/><b/></r>', None),
        ('<r xmlns="u"/>', '<p:r xmlns:p="u"/>', '<p:r xmlns:p="u"><b/></p:r>', '<r xmlns="u"><b xmlns=""/></r>'),
        ('<r xmlns="u"/>', '<r xmlns="u"/>', '<r xmlns="u"><b xmlns="v"><c/></b></r>', None),
    ],
)
def test_children(source: str, before: str, after: str, expected: str | None) -> None:
    result = edit(source, before, after)
    if expected is not None:
        assert result == expected

    def plain(element: etree._Element) -> list[str]:
        return [node.tag for node in element.iter(etree.Element)]

    ours = [tag for tag in plain(etree.fromstring(result.encode())) if tag not in {"x", "d"}]
    assert sorted(ours) == sorted(tag for tag in plain(etree.fromstring(after)) if tag not in {"x", "d"})


# Encodings


def test_the_encoding_and_its_mark_stay() -> None:
    before, after = etree.fromstring('<a x="ä"/>'), etree.fromstring('<a x="€"/>')
    for codec, bom in (
        ("utf-16-le", codecs.BOM_UTF16_LE),
        ("utf-16-be", codecs.BOM_UTF16_BE),
        ("utf-8", codecs.BOM_UTF8),
    ):
        source = bom + "<a\r\nx='ä'/>\r\n".encode(codec)
        assert patch_xml(source, before, after) == bom + "<a\r\nx='€'/>\r\n".encode(codec)


def test_characters_that_the_code_page_lacks_become_references() -> None:
    source = '<?xml version="1.0" encoding="iso-8859-1"?><a x="ä"><b>ä</b><c><![CDATA[<ä]]></c></a>'.encode("latin-1")
    before = etree.fromstring('<a x="ä"><b>ä</b><c>&lt;ä</c></a>')
    after = etree.fromstring('<a x="€"><b>ä€</b><c>&lt;€</c></a>')
    result = patch_xml(source, before, after)
    assert result.endswith('<a x="&#8364;"><b>ä&#8364;</b><c>&lt;&#8364;</c></a>'.encode("latin-1"))
    assert parse_xml(result)[1].text == "<€"


def test_a_name_that_the_code_page_lacks_is_refused() -> None:
    source = b'<?xml version="1.0" encoding="us-ascii"?><a/>'
    with pytest.raises(EncodingError, match="cannot be written in ascii"):
        patch_xml(source, etree.fromstring("<a/>"), etree.fromstring("<a><ä/></a>"))


# What must not happen


def test_another_root_is_refused() -> None:
    with pytest.raises(PatchError, match="root element"):
        edit("<a/>", "<b/>", '<b x="1"/>')
    with pytest.raises(PatchError, match="root element"):
        edit("<a/>", "<a/>", "<b/>")


def test_damage_is_never_returned(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("plcopen_sfc.formats.xml.source_patch.escape_text", lambda text, _habits: text)
    with pytest.raises(PatchError, match="would be damaged"):
        edit("<a/>", "<a><b/></a>", "<a>&lt;<b/></a>")


def test_the_deepest_nesting() -> None:
    deep = "<a>" * 255 + "{}" + "</a>" * 255
    assert edit(deep.format("<a/>"), deep.format("<a/>"), deep.format('<a x="1"/>')) == deep.format('<a x="1"/>')
    inner = "<a>" * 254 + "</a>" * 254
    assert edit("<a></a>", "<a/>", f"<a>{inner}</a>").startswith("<a><a><a>")


@pytest.mark.slow
def test_large_flat_lists() -> None:
    rows = [f'<s localId="{n}" name="S{n}"><t/></s>' for n in range(20_000)]
    source = "<r>\n" + "\n".join(rows) + "\n</r>"
    before = "<r>" + "".join(rows) + "</r>"
    changed = [row.replace('name="S', 'name="T') if n % 100 == 0 else row for n, row in enumerate(rows) if n % 99]
    result = edit(source, before, "<r>" + "".join(changed) + "</r>")
    assert result == "<r>\n" + "\n".join(changed) + "\n</r>"


@pytest.mark.parametrize(
    ("codec", "mark", "declared"),
    [
        ("utf-8", b"", "utf-8"),
        ("utf-8", codecs.BOM_UTF8, "utf-8"),
        ("utf-16-le", codecs.BOM_UTF16_LE, "utf-16"),
        ("cp1252", b"", "windows-1252"),
    ],
)
def test_an_edit_of_one_pou_leaves_the_bytes_of_others_in_every_encoding(
    codec: str, mark: bytes, declared: str
) -> None:
    text = (FIXTURES / "codesys" / "sorting_conveyor.xml").read_bytes().decode("utf-8-sig")
    text = text.replace('encoding="utf-8"', f'encoding="{declared}"').replace("<pous>", "<pous><!-- für Öl -->", 1)
    text = text.replace("bBeltRun", "bLäuft")  # of a POU that is not edited
    project = sfc.loads(mark + text.encode(codec))
    project.pou("FB_Pusher").chart.steps[0].comment = "grün"
    after = sfc.dumps(project)[len(mark) :].decode(codec)
    changed = [*difflib.unified_diff(text.splitlines(), after.splitlines(), n=0, lineterm="")][3:]
    assert [line[0] for line in changed] == ["+"]
    assert changed[0].endswith(">grün</attribute>")
