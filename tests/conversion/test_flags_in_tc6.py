"""SFC flags of CODESYS in charts of TC6 and of matiec: what obeys them there, proven by running both."""

from __future__ import annotations

import io

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.report import ConversionReport, Outcome
from tests.conversion.features import feature_project
from tests.conversion.pairs import named
from tests.conversion.test_flags_in_tia import BRANCHES, FLAGS, beside, chart_with, losses

LONG_BRANCHES = """
INITIAL_STEP Idle: END_STEP
STEP Left: q(S); END_STEP
STEP Left_2: q(R); END_STEP
STEP Right: END_STEP
STEP Right_2: r(N); END_STEP
TRANSITION FROM Idle TO (Left, Right) := a; END_TRANSITION
TRANSITION FROM Left TO Left_2 := b; END_TRANSITION
TRANSITION FROM Right TO Right_2 := g; END_TRANSITION
TRANSITION FROM (Left_2, Right_2) TO Idle := b; END_TRANSITION
"""
COUNT = "ACTION Count: n := 1 - n; END_ACTION"


def compared(source: m.Project, *, flavour: str = "") -> tuple[bytes, ConversionReport]:
    out = io.BytesIO()
    report = sfc.save(source, out, format="plcopen-2.01", flavour=flavour, partial=True, limit=16)
    return out.getvalue(), report


@pytest.mark.parametrize(
    ("flags", "fields"),
    [
        pytest.param(("SFCReset",), {}, marks=pytest.mark.slow),
        (("SFCReset",), {"work": "q(S);"}),
        (("SFCReset",), {"chart": LONG_BRANCHES}),
        pytest.param(FLAGS, {"chart": BRANCHES}, marks=pytest.mark.slow),
        (("SFCReset",), {"work": "q(SD, T#20ms);"}),
        (("SFCInit", "SFCPause"), {"idle": "q(N);", "work": ""}),
        pytest.param(("SFCPause",), {"chart": BRANCHES}, marks=pytest.mark.slow),
        pytest.param(("SFCTip", "SFCTipMode"), {}, marks=pytest.mark.slow),
        pytest.param(FLAGS, {"work": "q(S);"}, marks=pytest.mark.slow),
        pytest.param(("SFCTip", *FLAGS), {}, marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize("flavour", ["", pytest.param("beremiz", marks=pytest.mark.slow)])
def test_flags_are_obeyed(flags: tuple[str, ...], fields: dict[str, str], flavour: str) -> None:
    source = chart_with(*flags, **fields)
    data, report = compared(source, flavour=flavour)
    assert losses(report) == beside(source)
    assert ["equal" in verdict and "proof:" in verdict for verdict in report.compared.values()] == [True], (
        report.compared
    )
    assert flags[0].encode() in data


@pytest.mark.slow
@pytest.mark.parametrize("flavour", ["", "beremiz"])
def test_no_flag_waits_for_a_minimum_time(flavour: str) -> None:
    source = chart_with("SFCReset", "SFCPause")
    source.pou("Main").chart.step("Work").min_time = "T#40ms"
    data, report = compared(source, flavour=flavour)
    assert b"T#40ms" in data
    if flavour:  # where it matters that a step lasts a scan longer, which the report tells
        told = [("approximated", what, "POU Main") for what in ("order of actions", "chart")]
        assert losses(report) == [*beside(source), *told]
        return
    assert losses(report) == beside(source)
    assert all("equal" in verdict and "proof:" in verdict for verdict in report.compared.values()), report.compared


@pytest.mark.parametrize("qualifier", ["N", *(pytest.param(each, marks=pytest.mark.slow) for each in ("P0", "P1"))])
def test_statements_run_no_more_where_a_flag_ends_their_step(qualifier: str) -> None:
    source = chart_with(*FLAGS, work=f"Count({qualifier});", actions=COUNT)
    data, report = compared(source)
    assert losses(report) == beside(source)
    assert all("equal" in verdict for verdict in report.compared.values()), report.compared
    seen = sfc.loads(data, format="plcopen-2.01", as_tool=True).pou("Main")
    is_guarded = seen.actions[0].body.text.startswith("IF (NOT SFCPause OR SFCReset) AND (")
    assert is_guarded is (qualifier != "P1")
    assert sfc.loads(data, format="plcopen-2.01").pou("Main").actions[0].body.text == "n := 1 - n;"


def chart_with_times(*flags: str) -> m.Project:
    source = chart_with(*flags)
    pou = source.pou("Main")
    pou.chart.step("Work").max_time = "T#30ms"
    assert pou.interface is not None
    (outputs,) = (each for each in pou.interface.sections if each.kind is m.SectionKind.OUTPUT)
    texts = [m.Variable(name=name, type="STRING") for name in ("SFCErrorStep", "SFCCurrentStep")]
    outputs.variables += [m.Variable(name="SFCError", type="BOOL"), *texts]
    pou.actions.append(m.Action(name="Tell", body=m.StBody(text="n := LEN(SFCErrorStep) + LEN(SFCCurrentStep);")))
    pou.chart.step("Done").actions.append(m.ActionAssociation(id=pou.chart.new_id(), target="Tell"))
    return sfc.loads(sfc.dumps(source, format="codesys", partial=True), format="codesys")


@pytest.mark.parametrize("flavour", ["", pytest.param("beremiz", marks=pytest.mark.slow)])
@pytest.mark.parametrize("flag", ["SFCEnableLimit", "SFCQuitError", pytest.param("SFCPause", marks=pytest.mark.slow)])
def test_statements_report_on_the_chart(flag: str, flavour: str) -> None:
    source = chart_with_times(flag)
    data, report = compared(source, flavour=flavour)
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    # at 10 ms the maximum time ends in the scan in which Work is left, which CODESYS does a scan later
    told = "which the report names" if flavour else "equal"
    verdicts = report.compared.values()
    assert beside(source) or all("equal" in verdict or told in verdict for verdict in verdicts), report.compared
    assert not flavour or flag.encode() in data


@pytest.mark.parametrize(
    ("flag", "fields", "path"),
    [
        ("SFCReset", {"work": "Count(S);", "actions": COUNT}, "POU Main / step Work"),
        ("SFCPause", {"work": "q(D, T#1s);"}, "POU Main / step Work / action q"),
    ],
)
def test_what_differs_is_told(flag: str, fields: dict[str, str], path: str) -> None:
    source = chart_with(flag, **fields)
    report = sfc.convert(source, "plcopen-2.01", partial=True)[1]
    found = [(item.outcome, item.path) for item in report.losses]
    assert found == [*((Outcome(outcome), where) for outcome, _, where in beside(source)), (Outcome.APPROXIMATED, path)]


def test_no_transition_leaves_a_situation_that_is_part_of_another() -> None:
    source = chart_with("SFCReset", chart=BRANCHES + "TRANSITION FROM Idle TO Left := b; END_TRANSITION")
    report = sfc.convert(source, "plcopen-2.01", partial=True)[1]
    assert losses(report) == [("not executed", "operating input", "POU Main / SFCReset")]
    assert not sfc.convert(source, "plcopen-2.01", at_rest=["SFCReset"])[1].losses


def test_the_source_comes_back_and_an_edit_is_written_in_its_terms() -> None:
    data, _ = sfc.convert(chart_with(*FLAGS, work="q(S); Count(N);", actions=COUNT), "plcopen-2.01")
    back = sfc.loads(data, format="plcopen-2.01")
    chart = back.pou("Main").chart
    assert [step.name for step in chart.steps] == ["Idle", "Work", "Done"]
    assert len(chart.transitions) == 4
    assert chart.graph_settings is None
    assert "SFC_stops" not in {variable.name for variable in back.pou("Main").variables()}
    chart.rename_step("Work", "Fill")
    edited = io.BytesIO()
    assert not sfc.save(back, edited, format="plcopen-2.01").losses
    seen = sfc.loads(edited.getvalue(), format="plcopen-2.01", as_tool=True).pou("Main").chart
    assert [step.name for step in seen.steps] == ["Idle", "Fill", "SFCReset_begins", "Done", "SFCInit_holds"]
    assert len(sfc.loads(edited.getvalue(), format="plcopen-2.01").pou("Main").chart.transitions) == 4


def test_an_edit_of_the_written_chart_counts() -> None:
    data, _ = sfc.convert(chart_with("SFCTip", *FLAGS), "plcopen-2.01")
    edited = data.replace(b"NOT SFCReset</expression>", b"NOT SFCReset AND TRUE</expression>")
    assert edited != data
    back = sfc.loads(edited, format="plcopen-2.01")
    chart = back.pou("Main").chart
    assert len(chart.transitions) == 6  # two of them for the flags
    assert chart.settings is not None
    assert not chart.settings.flags[m.SfcFlag.TIP].use  # whose edge would fire those
    assert "XML214" in {found.code for found in back.diagnostics}


@pytest.mark.parametrize("flags", [("SFCReset",), FLAGS])
def test_the_step_of_sfcreset_does_what_the_initial_step_does(flags: tuple[str, ...]) -> None:
    """It has a stored action and an exit action that another step has too, as in a corpus chart of TwinCAT."""
    source = chart_with(*flags, idle="Count(S);", actions=f"{COUNT} ACTION Leave: n := 2; END_ACTION")
    for name in ("Idle", "Work"):
        source.pou("Main").chart.step(name).exit_action = "Leave"
    data, report = sfc.convert(source, "plcopen-2.01", partial=True)
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    steps = sfc.loads(data, as_tool=True).pou("Main").chart.steps
    does = {step.name: len(step.actions) for step in steps}
    assert does["SFCReset_begins"] >= does["Work"] == 2
    back = sfc.loads(data).pou("Main").chart
    assert [(step.name, step.exit_action) for step in back.steps] == [
        ("Idle", "Leave"),
        ("Work", "Leave"),
        ("Done", None),
    ]


def test_what_goes_on_during_a_pause_is_one_item_of_the_chart() -> None:
    source = chart_with("SFCPause", idle="r(L, T#1s);", work="q(D, T#1s);")
    report = sfc.convert(source, "plcopen-2.01", partial=True)[1]
    together, item = report.losses
    assert together.why.endswith("; CODESYS tests none in that scan")
    assert Words("de").message(together.why).endswith("; CODESYS prüft in diesem Zyklus keine")
    assert (item.outcome, item.path) == (Outcome.APPROXIMATED, "POU Main")
    assert item.why.startswith("the times of r, q go on during SFCPause; ")
    assert Words("de").message(item.why).startswith("die Zeiten von r, q laufen während SFCPause weiter; ")


def test_a_memory_that_holds_nothing_during_a_pause_is_told_as_such() -> None:
    report = sfc.convert(feature_project(named("action in LD + SFCTip"), "codesys"), "plcopen-2.01")[1]
    (item,) = [each for each in report.losses if each.what == "operating inputs"]
    assert item.why == "what is kept of SFC flags may be computed before actions that the conditions read"
    assert Words("de").message(item.why).startswith("was von SFC-Flags aufbewahrt wird, ")


def test_transitions_that_sfctip_alone_fires_are_told_with_it() -> None:
    """Each was an item of its own, without a reason, or called a mistake of this package."""
    source = chart_with("SFCTip", "SFCInit", chart=f"{LONG_BRANCHES.replace(':= g', ':= FALSE')}", work="")
    source.pou("Main").sfc.step("Left").entry_action = m.StBody(text="SFCTip := b;")
    report = sfc.convert(source, "plcopen", partial=True).report
    assert ("not executed", "operating input", "POU Main / SFCTip") in losses(report)
    assert "transition" not in {item.what for item in report.losses}
    assert all("please report this" not in item.why for item in report.losses)
