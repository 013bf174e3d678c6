"""Program text that is in ``<ST>`` itself, as old versions of Beremiz write it."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from tests.snippets import chart, project, step, transition

CODE = "x := x + 1;\nIF x < 3 AND go THEN x := 0; END_IF;"
ESCAPED = CODE.replace("<", "&lt;")
FORMS = {"CDATA": f"<![CDATA[{CODE}]]>", "escaped": ESCAPED, "between lines": f"\n<![CDATA[{CODE}]]>\n"}
VARIABLES = (
    '<interface><localVars><variable name="x"><type><INT/></type></variable>'
    '<variable name="go"><type><BOOL/></type></variable></localVars></interface>'
)


def _source(text: str) -> bytes:
    return project(f'<pou name="Main" pouType="program">{VARIABLES}<body><ST>{text}</ST></body></pou>')


@pytest.mark.parametrize("form", FORMS)
def test_the_text_is_read_and_kept(form: str) -> None:
    data = _source(FORMS[form])
    loaded = sfc.loads(data)
    body = loaded.pous[0].body
    assert isinstance(body, m.StBody)
    assert body.text.strip() == CODE
    assert sfc.dumps(loaded) == data
    assert sfc.loads(sfc.dumps(loaded, fresh=True)).pous == loaded.pous


@pytest.mark.parametrize("form", FORMS)
def test_an_edit_changes_the_text_where_it_stands(form: str) -> None:
    data = _source(FORMS[form])
    loaded = sfc.loads(data)
    loaded.rename("Main.x", "count")
    expected = FORMS[form].replace("x", "count")
    assert sfc.dumps(loaded) == data.replace(FORMS[form].encode(), expected.encode()).replace(
        b'name="x"', b'name="count"'
    )


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("target", ["plcopen-1.01", "plcopen-2.0", "codesys", "simaticml", "scl", "iec-text", "json"])
def test_other_formats_get_the_text_as_they_write_it(form: str, target: str) -> None:
    """The text is all there for the tool, in the element that the format has for it."""
    data, report = sfc.convert(sfc.loads(_source(FORMS[form])), target, partial=True)
    assert [item for item in report.losses if "markup" in item.path] == []
    body = sfc.loads(data, as_tool=True).pous[0].body
    assert isinstance(body, m.StBody)
    assert body.text.replace("#", "").split() == CODE.split()
    if target.startswith(("plcopen", "codesys")):
        assert b"<ST>x" not in data


@pytest.mark.parametrize("target", ["plcopen-1.01", "plcopen-2.0", "codesys", "iec-text", "json"])
def test_a_condition_is_an_expression_in_every_format(target: str) -> None:
    """In its own file it stays where it is."""
    plain = chart(step(1, "S1", 2, initial=True), transition(2, 1, condition="go"))
    declared = plain.replace("<body>", f"{VARIABLES}<body>", 1)
    data = project(declared.replace("<xhtml:p>go</xhtml:p>", "go"))
    loaded = sfc.loads(data)
    assert _condition(loaded) == "go"
    assert sfc.dumps(loaded) == data
    assert b"<ST>go</ST>" in sfc.dumps(loaded, fresh=True)
    written, report = sfc.convert(loaded, target)
    assert report.losses == []
    assert _condition(sfc.loads(written, as_tool=True)) == "go"


def _condition(loaded: m.Project) -> str:
    chart = loaded.pous[0].sfc
    assert chart is not None
    condition = chart.transitions[0].condition
    assert isinstance(condition, m.Expression)
    return condition.text
