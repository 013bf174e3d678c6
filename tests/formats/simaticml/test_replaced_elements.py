"""Edits of a converted file count; without an edit the source comes back."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.conversion import executed
from plcopen_sfc.model.compare import differences

CHART = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR_OUTPUT q, r : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a AND NOT b; END_TRANSITION
STEP S1: q(P1); Both(N); END_STEP
TRANSITION FROM S1 TO S0 := b; END_TRANSITION
ACTION Both: q := a; r := b; END_ACTION
END_FUNCTION_BLOCK
"""


def converted() -> str:
    return sfc.dumps(sfc.loads(CHART.encode(), format="iec-text"), format="simaticml", partial=True).decode("utf-8-sig")


def chart_of(text: str) -> m.SfcNetwork:
    chart = sfc.loads(text.encode(), format="simaticml").pou("Main").sfc
    assert chart is not None
    return chart


def row_targets(text: str) -> list[tuple[str | None, str | None]]:
    return [(row.target, row.value) for row in chart_of(text).step("S1").actions]


def renumbered(text: str) -> str:
    """The file with other numbers, and the comments where they were."""
    return re.sub(r'UId="(\d+)"', lambda found: f'UId="{int(found[1]) + 100}"', text)


@pytest.mark.parametrize("change", [str, renumbered])
def test_the_source_comes_back_where_nothing_was_edited(change: Callable[[str], str]) -> None:
    chart = chart_of(change(converted()))
    assert [t.condition for t in chart.transitions] == [
        m.Expression(text="#a AND NOT #b"),
        m.Expression(text="#b"),
    ]
    assert [(row.qualifier, row.target) for row in chart.step("S1").actions] == [("P1", "#q"), ("N", "#Both")]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('<Component Name="a" />', '<Component Name="r" />'),
        ('<Negated Name="operand" />', ""),
    ],
)
def test_an_edited_condition_counts(old: str, new: str) -> None:
    text = converted()
    assert old in text
    first, second = chart_of(text.replace(old, new)).transitions
    assert isinstance(first.condition, m.BodyCondition)
    assert second.condition == m.Expression(text="#b")


@pytest.mark.parametrize(
    ("pattern", "new", "expected"),
    [
        ('Text="#q" />', 'Text="#r" />', [("#r", None), ("#r", "#a"), ("#r", "#b")]),
        ('Text="#b" />', 'Text="#q" />', [("#q", None), ("#q", "#a"), ("#r", "#q")]),
        ('Event="S1"', 'Event="S0"', [("#q", None), ("#q", "#a"), ("#r", "#b")]),
    ],
)
def test_edited_rows_count(pattern: str, new: str, expected: list[tuple[str, str | None]]) -> None:
    text = converted()
    assert pattern in text
    final_scan = expected[1:]  # rows with S0 do once more what the action does
    assert row_targets(text.replace(pattern, new)) == expected + final_scan


@pytest.mark.slow
def test_a_deleted_row_is_gone() -> None:
    rows = re.findall(r"<Action [^/>]*>.*?</Action>", converted(), re.DOTALL)
    for row in rows:
        assert len(row_targets(converted().replace(row, "", 1))) == len(rows) - 1


def test_a_condition_without_its_minimum_time_needs_none() -> None:
    source = sfc.loads(CHART.encode(), format="iec-text")
    chart = source.pou("Main").sfc
    assert chart is not None
    chart.step("S1").min_time = "T#5s"
    text = sfc.dumps(source, format="simaticml", partial=True).decode("utf-8-sig")
    assert chart_of(text).step("S1").min_time == "T#5s"
    assert "T#5s" in text
    edited = chart_of(re.sub(r"(<ConstantValue[^>]*>)T#5s", r"\1T#9s", text))
    assert edited.step("S1").min_time is None
    assert isinstance(edited.transitions[1].condition, m.BodyCondition)


def test_files_without_digests_are_read_as_before() -> None:
    text = re.sub(r', "written": "\w+"', "", converted())
    old = re.sub(r'<!--plcopen_sfc \{"written".*?-->', "", text)
    assert "written" not in old
    assert not list(differences(sfc.loads(converted().encode()), sfc.loads(old.encode())))


def test_what_is_programmed_in_an_empty_block_counts() -> None:
    """TIA Portal has no IL, and SCL no jumps into loops: the block is empty until somebody programs it."""
    jump = m.IlBody(text="LD b\nJMPC x\nm:\nLD a\nST q\nx:\nLD b\nST r\nJMPC m")  # into a loop
    block = m.Pou(name="List", kind=m.PouKind.FUNCTION_BLOCK, bodies=[jump])
    text = sfc.dumps(m.Project(pous=[block]), format="simaticml", partial=True).decode("utf-8-sig")
    assert isinstance(sfc.loads(text.encode()).pou("List").bodies[0], m.IlBody)
    network = re.search(r"<FlgNet.*?</FlgNet>", converted(), re.DOTALL)
    assert network is not None
    flgnet = network[0].replace(
        "<FlgNet>", '<FlgNet xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/FlgNet/v4">'
    )
    programmed = text.replace("<NetworkSource />", f"<NetworkSource>{flgnet}</NetworkSource>")
    assert programmed != text
    assert isinstance(sfc.loads(programmed.encode()).pou("List").bodies[0], m.LdBody)


DECLARED = """TYPE Color : (red, green, blue); END_TYPE
FUNCTION Twice : INT
VAR_INPUT n : INT; END_VAR
Twice := n * 2;
END_FUNCTION
FUNCTION_BLOCK Main
VAR_INPUT lamp : Color; a : BOOL; END_VAR
VAR kept : Color := Color#green; level : INT(1..9) := 3; END_VAR
VAR RETAIN count : INT; END_VAR
a := TRUE;
END_FUNCTION_BLOCK
"""


def declared() -> str:
    project = sfc.loads(DECLARED.encode(), format="iec-text")
    return sfc.dumps(project, format="simaticml", partial=True).decode("utf-8-sig")


def variable(text: str, name: str) -> m.Variable:
    return next(v for v in sfc.loads(text.encode()).pou("Main").variables() if v.name == name)


def outdated(text: str) -> list[str]:
    """Warnings about content that the comments of a file keep in vain, with their places."""
    project = sfc.loads(text.encode())
    for chart in project.charts():
        assert chart.chart.steps is not None
    for pou in project.pous:
        pou.variables()
    assert project.data_types is not None
    found = [d for d in project.diagnostics if d.code == "XML214"]
    assert all(d.severity is sfc.Severity.WARNING and d.location is not None and d.location.line for d in found)
    return [f"{d.location.path}: {d.message.partition(' is outdated')[0]}" for d in found if d.location is not None]


def changed(text: str, pattern: str, new: str) -> str:
    edited, count = re.subn(pattern, new, text, count=1, flags=re.DOTALL)
    assert count == 1
    assert edited != text
    return edited


class TestVariables:
    def test_types_and_start_values_come_back_where_nothing_was_edited(self) -> None:
        kept = variable(declared(), "kept")
        assert kept.type == m.DerivedType(name="Color")
        assert kept.initial is not None
        assert outdated(declared()) == []

    def test_an_edited_type_counts_with_its_start_value(self) -> None:
        text = changed(declared(), r'(Name="kept" Datatype=)"Int"', r'\1"DInt"')
        kept = variable(text, "kept")
        assert (kept.type, kept.initial) == (m.ElementaryType(name=m.Elementary.DINT), m.SimpleValue(text="1"))
        assert outdated(text) == [
            "FB Main: what a comment keeps of the type of kept",
            "FB Main: what a comment keeps of the start value of kept",
        ]

    def test_an_edited_start_value_counts_and_the_type_stays(self) -> None:
        text = changed(declared(), r'(Name="kept".*?<StartValue>)1<', r"\g<1>2<")
        kept = variable(text, "kept")
        assert (kept.type, kept.initial) == (m.DerivedType(name="Color"), m.SimpleValue(text="2"))
        assert outdated(text) == ["FB Main: what a comment keeps of the start value of kept"]

    def test_a_start_value_that_was_taken_out_is_gone(self) -> None:
        text = changed(declared(), r'(Name="kept"[^>]*>\s*)<StartValue>1</StartValue>', r"\1")
        assert variable(text, "kept").initial is None

    def test_a_start_value_that_was_added_counts(self) -> None:
        text = changed(declared(), r'(Name="lamp"[^>]*>)', r"\1<StartValue>2</StartValue>")
        assert variable(text, "lamp").initial == m.SimpleValue(text="2")

    def test_a_variable_stays_in_the_section_to_which_it_was_moved(self) -> None:
        member = re.search(r'<Member Name="a" Datatype="Bool" />', declared())
        assert member is not None
        moved = changed(declared().replace(member[0], "", 1), r'(<Section Name="Static">)', rf"\1{member[0]}")
        interface = sfc.loads(moved.encode()).pou("Main").interface
        assert interface is not None
        section = next(s for s in interface.sections if any(v.name == "a" for v in s.variables))
        assert section.kind is m.SectionKind.LOCAL

    def test_an_edited_declaration_of_a_type_counts(self) -> None:
        text = changed(declared(), r'(<Member Name="Value" Datatype=)"Int"', r'\1"DInt"')
        (color,) = sfc.loads(text.encode()).data_types
        assert isinstance(color.type, m.StructType)
        assert outdated(text) == ["PlcStruct Color: what a comment keeps of the type of the data type"]

    def test_an_edited_result_of_a_function_counts(self) -> None:
        text = changed(declared(), r'(<Member Name="Ret_Val" Datatype=)"Int"', r'\1"DInt"')
        interface = sfc.loads(text.encode()).pou("Twice").interface
        assert interface is not None
        assert interface.return_type is None
        assert [s.kind for s in interface.sections] == [m.SectionKind.INPUT, m.SectionKind.RETURN]
        assert outdated(text) == ["FC Twice: what a comment keeps of the result of the function"]


class TestExcludedSteps:
    @staticmethod
    def converted() -> str:
        source = sfc.loads(CHART.encode(), format="iec-text")
        chart = source.pou("Main").sfc
        assert chart is not None
        chart.step("S1").exclude = True
        return sfc.dumps(source, format="simaticml", partial=True).decode("utf-8-sig")

    def test_a_step_stays_excluded_where_nothing_was_edited(self) -> None:
        chart = chart_of(self.converted())
        assert chart.step("S1").exclude
        assert len(chart.step("S1").actions) == 2
        assert chart.transitions[1].condition == m.Expression(text="#b")
        assert outdated(self.converted()) == []

    @pytest.mark.parametrize(
        ("pattern", "new", "rows"),
        [
            (
                r'(<Step Number="2".*?)<Action />',
                r'\1<Action Qualifier="N"><Token Text="#r" /><Token Text="&#xA;" /></Action><Action />',
                ["#r"],
            ),
            (r'(<Transition .*<Transition .*?)(<Access Scope="LiteralConstant".*?</Access>)', None, []),
        ],
    )
    def test_a_step_that_was_programmed_does_what_the_file_says(
        self, pattern: str, new: str | None, rows: list[str]
    ) -> None:
        text = self.converted()
        if new is None:
            text = changed(text, r"(.*<ConstantValue[^>]*>)FALSE<", r"\1TRUE<")
        else:
            text = changed(text, pattern, new)
        chart = chart_of(text)
        step = chart.step("S1")
        assert not step.exclude
        assert [row.target for row in step.actions] == rows
        assert isinstance(chart.transitions[1].condition, m.BodyCondition)
        assert "FB Main / step S1: what a comment keeps of the exclusion of the step" in outdated(text)


@pytest.mark.parametrize(
    ("pattern", "new", "message"),
    [
        (
            '<Component Name="a" />',
            '<Component Name="r" />',
            "transition Trans1: what a comment keeps of the condition of the transition",
        ),
        ('Text="#q" />', 'Text="#r" />', "step S1: what a comment keeps of the actions"),
    ],
)
def test_a_warning_says_what_a_comment_keeps_in_vain(pattern: str, new: str, message: str) -> None:
    assert outdated(converted()) == []
    assert outdated(converted().replace(pattern, new)) == [f"FB Main / {message}"]


ENUMERATIONS = """TYPE Mode : (Off, Auto, Manual) := Auto; END_TYPE
FUNCTION_BLOCK Main
VAR_INPUT a : BOOL; END_VAR
VAR m : Mode; all : ARRAY[0..1] OF Mode; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a AND m = Auto; END_TRANSITION
STEP S1: END_STEP
TRANSITION FROM S1 TO S0 := NOT a; END_TRANSITION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("<Value>1</Value>", "<Value>5</Value>"),
        (r'(Name="m" [^>]*>.*?)<StartValue>1', r"\1<StartValue>2"),
        (r'(Name="m" [^>]*>.*?)<StartValue>1</StartValue>', r"\1"),
        (r'(Path="0"[^>]*>\s*)<StartValue>1', r"\1<StartValue>2"),
    ],
)
def test_edited_values_of_enumerations_are_those_of_tia_portal(old: str, new: str) -> None:
    project = sfc.loads(ENUMERATIONS.encode(), format="iec-text")
    text = sfc.dumps(project, format="simaticml", partial=True).decode("utf-8-sig")
    edited = re.sub(old, new, text, count=1, flags=re.DOTALL)
    assert edited != text
    read, seen = (sfc.loads(edited.encode(), as_tool=each) for each in (False, True))
    assert _starts(read) == _starts(seen)
    assert "XML214" in {finding.code for finding in read.diagnostics}


def _starts(project: m.Project) -> dict[str, object]:
    """The initial values of the variables as they are executed."""
    chart = next(part for key, part in executed(project).parts.items() if key.kind == "POU")
    return {
        key.name: part.aspects["initial value"].form()
        for key, part in chart.parts.items()
        if key.kind == "variable" and "initial value" in part.aspects
    }
