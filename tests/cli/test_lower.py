"""``plcopen-sfc lower``."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import ArgumentError, LoweringError
from plcopen_sfc.formats.simaticml import lad_fbd_networks
from plcopen_sfc.formats.simaticml.element_reader import NotUnderstoodError
from plcopen_sfc.lowering import lower_project
from plcopen_sfc.lowering.lowering_options import LoweringOptions, LoweringRules
from tests.cli.conftest import CommandRun
from tests.lowering.charts import training_chain

Cli = Callable[..., CommandRun]


@pytest.fixture
def plant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    sfc.save(m.Project(name="Anlage", pous=[training_chain()]), "plant.xml", format="plcopen-2.01")
    return tmp_path


def test_writes_code_that_is_proven(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "out.st", "--to", "iec-text", "--as", "case", "--lang", "de")
    assert done.code == 0
    assert "equal (proof" in done.out
    text = (plant / "out.st").read_text(encoding="utf-8")
    assert "CASE aktiver_schritt OF" in text
    assert "Ablauf_Schritt : (S1, S2, S3, S4);" in text
    assert sfc.load("out.st").pou("Ablauf").sfc is None


@pytest.mark.slow
def test_a_classic_chain_is_written_and_its_faults_are_shown(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "--to", "plcopen", "--as", "fup", "--style", "classic")
    assert done.code == 1
    lines = done.out.splitlines()
    assert lines[0] == "Ablauf: classic flipflop in FBD: asked for"
    assert lines[1] == "under the profile iec: different after 1 scan (shortest input trace)"
    at = lines.index("LOW101: two steps that follow each other are active in one scan: S1, S2")
    assert lines[at + 2 : at + 6] == [
        "  Likewise: S2, S3; S3, S4",
        "  scan | inputs | chart | code",
        "  1    | Init   | S1    | S1",
        "  2    | B1     | S2    | S1 S2",
    ]
    assert lines[-1] == "written: plant-lowered.xml"
    assert (plant / "plant-lowered.xml").is_file()


def test_a_classic_chain_starts_in_the_first_scan_where_it_is_to_have_no_input_for_that(cli: Cli, plant: Path) -> None:
    textbook = ("lower", "plant.xml", "out.st", "--to", "iec-text", "--as", "fup", "--style", "classic", "--no-init")
    done = cli(*textbook)
    assert (done.code, "LOW101" in done.out, "LOW104" in done.out) == (1, True, False)
    assert "Init" not in (plant / "out.st").read_text(encoding="utf-8")
    done = cli(*textbook, "--init", "Start")
    assert (done.code, "--init and --no-init exclude each other" in done.err) == (2, True)


def test_as_json(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "out.xml", "--to", "codesys", "--as", "bits", "--profile", "iec", "--json")
    data = json.loads(done.out)
    (pou,) = data["pous"]
    assert (pou["construction"], pou["profile"], data["file"]) == ("bits", "iec", "out.xml")
    assert pou["proof"]["kind"] == "equal (proof)"
    assert {"Q1", "S1.X", "S4.X"} <= set(pou["proof"]["compared"])
    assert pou["faults"] == []


@pytest.mark.slow
def test_all_charts_of_a_project_are_lowered(cli: Cli, tmp_path: Path, fixtures: Path) -> None:
    conveyor = fixtures / "codesys" / "sorting_conveyor.xml"
    done = cli("lower", conveyor, tmp_path / "out.xml", "--to", "codesys", "--no-verify", "--json")
    assert done.code == 0
    assert {pou["pou"] for pou in json.loads(done.out)["pous"]} >= {"PLC_PRG", "FB_Pusher"}
    assert not list(sfc.load(tmp_path / "out.xml").charts())
    done = cli("lower", conveyor, tmp_path / "one.xml", "--to", "codesys", "--pou", "FB_Pusher", "--as", "bits")
    assert "FB_Pusher: exact bits" in done.out
    assert [chart.name for chart in sfc.load(tmp_path / "one.xml").charts()] == ["PLC_PRG", "PLC_PRG.ACT_Home"]


def test_a_sequencer_becomes_a_case_where_nobody_switches_steps_by_hand(
    cli: Cli, tmp_path: Path, fixtures: Path
) -> None:
    chain, code = fixtures / "simaticml-training-chain" / "Ablauf.xml", tmp_path / "chain.scl"
    done = cli("lower", chain, code, "--to", "scl", "--as", "case")
    assert (done.code, code.exists()) == (2, False)
    assert "S_ON can switch on a step while another one is active" in done.err
    assert "--at-rest" in done.err
    done = cli("lower", chain, code, "--to", "scl", "--as", "case", "--at-rest", "all", "--json")
    (pou,) = json.loads(done.out)["pous"]
    assert (done.code, pou["proof"]["kind"], pou["at_rest"]["S_ON"]) == (0, "equal (proof)", False)
    assert "CASE #step_number OF" in code.read_text(encoding="utf-8-sig")
    done = cli("lower", chain, code, "--to", "scl", "--at-rest", "B1")
    assert (done.code, "B1 does not operate sequencers" in done.err) == (2, True)


def test_the_report_has_the_faults_and_what_the_format_cannot_say(cli: Cli, plant: Path) -> None:
    done = cli(
        "lower", "plant.xml", "out.xml", "--to", "simaticml", "--tia", "V16", "--as", "case", "--report", "r.json"
    )
    assert done.code == 0
    assert "V16" in (plant / "out.xml").read_text(encoding="utf-8-sig")
    data = json.loads((plant / "r.json").read_text(encoding="utf-8"))
    assert (data["pous"][0]["language"], data["conversion"]["target_format"]) == ("ST", "simaticml-V16")
    assert data["conversion"]["written"] == ["out.xml"]
    done = cli("lower", "plant.xml", "out.xml", "--to", "codesys", "--as", "case", "--style", "classic", "--json")
    assert json.loads(done.out)["pous"][0]["faults"][0]["code"] == "LOW202"


@pytest.mark.slow
def test_a_folder_becomes_a_folder(cli: Cli, tmp_path: Path, fixtures: Path) -> None:
    done = cli("lower", fixtures / "simaticml-plc", tmp_path / "plc", "--to", "simaticml", "--no-verify")
    assert (done.code, done.out.splitlines()[1]) == (0, "not compared with the chart")
    source, written = (
        {path.relative_to(folder) for path in folder.rglob("*.xml")}
        for folder in (fixtures / "simaticml-plc", tmp_path / "plc")
    )
    assert written == source
    assert sfc.load(tmp_path / "plc").pou("FB_Drilling").sfc is None


def test_what_cannot_be_said_is_refused_and_nothing_is_written(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "out.xml", "--to", "codesys", "--as", "case", "--language", "LD")
    assert done.code == 2
    assert "cannot be drawn in LD" in done.err
    assert not (plant / "out.xml").exists()


def test_scl_has_no_networks(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "out.scl", "--to", "scl", "--as", "fup")
    assert (done.code, done.out.splitlines()[0]) == (0, "Ablauf: exact flipflop in ST: asked for")
    (plant / "out.scl").unlink()
    done = cli("lower", "plant.xml", "out.scl", "--to", "scl", "--as", "fup", "--language", "LD")
    assert done.code == 2
    assert "has no networks of LD" in done.err
    assert not (plant / "out.scl").exists()


def test_what_is_wrong_with_the_chart_is_told(cli: Cli, tmp_path: Path, fixtures: Path) -> None:
    done = cli("lower", fixtures / "broken" / "jump_to_nowhere.xml", tmp_path / "out.xml", "--to", "plcopen")
    assert done.code == 1
    assert "SFC103" in done.err


@pytest.mark.slow
def test_networks_for_a_version_of_tia_portal_are_its_own_and_lose_nothing(cli: Cli, plant: Path) -> None:
    for number, to in enumerate((["simaticml-V17"], ["simaticml", "--tia", "V17"])):
        done = cli("lower", "plant.xml", f"out{number}.xml", "--as", "fup", "--to", *to)
        assert done.code == 0
        assert done.out.splitlines()[3:] == [f"written: out{number}.xml"]
        assert '<Part Name="Sr"' in (plant / f"out{number}.xml").read_text(encoding="utf-8-sig")


@pytest.mark.slow
@pytest.mark.parametrize("form", ["codesys", "plcopen-2.01", "iec-text", "scl"])
@pytest.mark.parametrize(
    ("flags", "places"),
    [("M20.6", ["20.6", "20.7", "21.0", "21.1", "21.2", "21.3", "21.4", "21.5"]), ("Bits", [])],
)
def test_flags_of_several_charts_do_not_meet(plant: Path, cli: Cli, form: str, flags: str, places: list[str]) -> None:
    other = training_chain()
    other.name = "Presse"
    sfc.save(m.Project(name="Anlage", pous=[training_chain(), other]), "two.xml", format="plcopen-2.01")
    done = cli("lower", "two.xml", "out", "--to", form, "--as", "bits", "--flags", flags)
    assert done.code == 0, done.err
    assert done.out.count("equal (proof") == 2
    text = (plant / "out").read_text(encoding="utf-8")
    if places and form != "scl":  # a source has no tags
        assert re.findall(r"%MX?(\d+\.\d)", text) == places
    if not places and form in ("codesys", "scl"):
        assert "Bits_Ablauf" in text
        assert "Bits_Presse" in text


def test_charts_of_actions_are_called_by_those_that_use_them(plant: Path, cli: Cli) -> None:
    """Also where they stand before them: their code would else be a part of the outer one, twice."""
    inner, outer = training_chain(), training_chain()
    chart, around = inner.sfc, outer.sfc
    assert chart is not None
    assert around is not None
    around.steps[1].main_action = "Inner"
    machine = inner.model_copy(update={"name": "Machine", "bodies": [m.StBody(text="Outer();")]})
    machine.actions = [
        m.Action(name=name, body=m.SfcBody(chart=c)) for name, c in (("Inner", chart), ("Outer", around))
    ]
    project = m.Project(name="Anlage", pous=[machine], dialect=m.Dialect.CODESYS)
    sfc.save(project, "two.xml", format="codesys")
    done = cli("lower", "two.xml", "out.xml", "--to", "codesys", "--as", "case", "--no-verify")
    assert done.code == 0, done.err
    code = {action.name: action.body for action in sfc.load("out.xml").pou("Machine").actions}
    assert isinstance(code["Inner"], m.StBody)
    assert isinstance(code["Outer"], m.StBody)
    assert code["Outer"].text.count("Inner();") == 1
    assert code["Outer"].text.count("CASE ") == code["Inner"].text.count("CASE ") == 1


def test_a_folder_for_tia_portal_is_asked_for_by_a_slash(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "tia/", "--to", "simaticml", "--as", "fup", "--flags", "M20.0")
    assert done.code == 0, done.err
    files = {path.relative_to(plant / "tia").as_posix() for path in (plant / "tia").rglob("*.xml")}
    assert files >= {"PLC tags/StepFlags_Ablauf.xml", "Program blocks/Ablauf.xml"}
    assert "equal (proof" in done.out


def test_code_in_a_comment_is_no_code(cli: Cli, plant: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(*_: object) -> None:
        raise NotUnderstoodError("an output variable")

    monkeypatch.setattr(lad_fbd_networks, "write_flgnet", nothing)
    done = cli("lower", "plant.xml", "out.xml", "--to", "simaticml", "--as", "fup")
    assert done.code == 2
    assert "would only be in a comment: TIA Portal has no such element: an output variable" in done.err
    assert not (plant / "out.xml").exists()


def test_a_source_of_scl_has_no_blocks_for_charts_that_were_not_asked_for(cli: Cli, line: Path) -> None:
    """They would be function blocks that do nothing."""
    done = cli("lower", "line.xml", "out.scl", "--to", "scl", "--pou", "Ablauf", "--as", "case", "--report", "r.json")
    assert done.code in (0, 1)
    seen = sfc.load(line / "out.scl", as_tool=True)
    assert [pou.name for pou in seen.pous if pou.kind is not m.PouKind.FUNCTION] == ["Ablauf"]
    assert "not asked for" in (line / "r.json").read_text("utf-8")
    assert "not executed: POU " in done.out
    assert "POU POU" not in done.out


def test_a_project_without_charts_says_so(cli: Cli, tmp_path: Path, fixtures: Path) -> None:
    done = cli("lower", fixtures / "scl" / "filling_line.scl", tmp_path / "out.xml", "--to", "codesys")
    assert (done.code, "there is no chart to be lowered" in done.err) == (2, True)


@pytest.fixture
def line(plant: Path) -> Path:
    """A plant with four charts: one is fine, two cannot be lowered, of the last one nothing can be proven."""
    pous = {name: training_chain() for name in ("Ablauf", "Presse", "Zange", "Band")}
    for name, pou in pous.items():
        pou.name = name
    charts = {name: pou.sfc for name, pou in pous.items()}
    press, tongs, belt = charts["Presse"], charts["Zange"], charts["Band"]
    assert press is not None
    assert tongs is not None
    assert belt is not None
    press.steps[1].actions[0].qualifier = m.Qualifier.D
    tongs.transitions[0].condition = m.Expression(text="B1 AND (")
    belt.transitions[0].condition = m.Expression(text="B1 + 1")
    sfc.save(m.Project(name="Anlage", pous=list(pous.values())), "line.xml", format="plcopen-2.01")
    return plant


@pytest.mark.slow
def test_all_refusals_are_listed_and_nothing_is_written(cli: Cli, line: Path) -> None:
    done = cli("lower", "line.xml", "out.xml", "--to", "plcopen", "--as", "bits", "--report", "r.json")
    assert (done.code, done.out) == (2, "")
    errors = [text for text in done.err.splitlines() if text.startswith("error: ")]
    assert re.fullmatch(r"error: line\.xml:\d+ \(POU Presse / step S2 / action Q2\): D needs a time", errors[0])
    assert " (POU Zange / transition S1 -> " in errors[1]
    assert " (POU Band): neither the chart nor the code can be run: not all was compared" in errors[2]
    assert errors[3:] == ["error: nothing is written: 3 of 4 charts are refused"]
    assert "both end with an error: Band / transition S1 -> S2: + of BOOL and BOOL" in errors[2]
    assert "  Mend what is wrong in the chart: check tells more." in done.err
    assert "--skip-refused" in done.err.splitlines()[-1]
    assert not (line / "out.xml").exists()
    data = json.loads((line / "r.json").read_text(encoding="utf-8"))
    assert [each["pou"] for each in data["refused"]] == ["Presse", "Zange", "Band"]
    assert data["refused"][0]["path"] == "POU Presse / step S2 / action Q2"
    assert (data["file"], data["conversion"], [each["pou"] for each in data["pous"]]) == (None, None, ["Ablauf"])
    assert data["pous"][0]["proof"]["kind"] == "equal (proof)"
    done = cli("lower", "line.xml", "out.xml", "--to", "plcopen", "--as", "bits", "--json")
    assert (done.code, json.loads(done.out)) == (2, data)


@pytest.mark.slow
def test_refused_charts_can_be_left_as_they_are(cli: Cli, line: Path) -> None:
    done = cli("lower", "line.xml", "out.xml", "--to", "plcopen", "--as", "bits", "--skip-refused")
    assert done.code == 1
    assert done.out.splitlines() == [
        "Ablauf: exact bits in ST: asked for",
        "under the profile iec: equal (proof: 5 states, all inputs)",
        "covered: 4 of 4 steps, 4 of 4 transitions, 3 of 3 actions; 11 of 11 assignments",
        "written: out.xml",
    ]
    assert "(POU Presse / step S2 / action Q2): D needs a time" in done.err
    assert done.err.splitlines()[-1] == "3 of 4 charts are refused, and left as they are"
    written, before = sfc.load("out.xml"), sfc.load("line.xml")
    assert [chart.name for chart in written.charts()] == ["Presse", "Zange", "Band"]
    for name in ("Presse", "Zange", "Band"):
        left, original = (each.pou(name).sfc for each in (written, before))
        assert left is not None
        assert left == original
    assert isinstance(written.pou("Ablauf").body, m.StBody)
    done = cli("lower", "line.xml", "more.xml", "--to", "plcopen", "--skip-refused", "--no-verify", "--json")
    data = json.loads(done.out)
    assert (done.code, data["file"]) == (1, "more.xml")
    assert [each["pou"] for each in data["pous"]] == ["Ablauf", "Band"]
    assert [each["pou"] for each in data["refused"]] == ["Presse", "Zange"]


def test_what_a_refused_chart_calls_is_lowered_for_itself(cli: Cli, plant: Path) -> None:
    inner, outer = training_chain(), training_chain()
    chart, around = inner.sfc, outer.sfc
    assert chart is not None
    assert around is not None
    around.steps[0].main_action = "Inner"
    around.transitions[0].condition = m.Expression(text="B1 AND (")
    outer.actions = [m.Action(name="Inner", body=m.SfcBody(chart=chart))]
    sfc.save(m.Project(name="Anlage", pous=[outer], dialect=m.Dialect.CODESYS), "both.xml", format="codesys")
    done = cli("lower", "both.xml", "out.xml", "--to", "codesys", "--skip-refused")
    assert (done.code, done.out.splitlines()[0].split(":")[0]) == (1, "Ablauf.Inner")
    assert "(POU Ablauf / transition S1 -> S2): " in done.err
    assert [each.name for each in sfc.load("out.xml").charts()] == ["Ablauf"]


def test_where_all_charts_are_refused_nothing_is_written(cli: Cli, line: Path) -> None:
    done = cli("lower", "line.xml", "out.xml", "--to", "plcopen", "--flags", "nowhere!", "--skip-refused")
    assert (done.code, done.err.splitlines()[-1]) == (2, "error: nothing is written: 4 of 4 charts are refused")
    one = cli("lower", "line.xml", "out.xml", "--to", "plcopen", "--pou", "Presse", "--skip-refused")
    assert (one.code, one.err.splitlines()[0].partition("(")[2]) == (
        2,
        "POU Presse / step S2 / action Q2): D needs a time",
    )
    assert "nothing is written" not in one.err
    assert not (line / "out.xml").exists()


def test_every_option_of_the_code_is_an_option_of_the_command(cli: Cli) -> None:
    options = set(LoweringOptions.__annotations__)
    assert options - {"lang", "flag_names"} < {each.name for each in fields(LoweringRules)}
    shown = cli("lower", "--help").out
    assert [name for name in options if f"--{name.replace('_', '-').removesuffix('s')}" not in shown] == []


@pytest.mark.parametrize("lowering", [sfc.lower, lower_project])
def test_options_are_checked_before_any_chart_is_lowered(lowering: Callable[..., object]) -> None:
    project = m.Project(pous=[training_chain()])
    with pytest.raises(ArgumentError, match=r"no option 'stile' \(did you mean 'style'\?\)"):
        lowering(project, stile="classic")
    with pytest.raises(LoweringError, match=r"no style 'clasic' \(did you mean 'classic'\?\)") as found:
        lowering(project, style="clasic")
    assert found.value.location.path is None  # a mistake of the call, not of a chart


def test_an_option_that_is_wrong_is_told_once(cli: Cli, line: Path) -> None:
    done = cli("lower", "line.xml", "out.xml", "--to", "plcopen", "--as", "petri")
    assert (done.code, done.err.count("error: ")) == (2, 1)
    assert "there is no construction 'petri'" in done.err


@pytest.mark.slow
def test_a_file_that_was_read_with_errors_is_not_lowered_into_another_format(
    cli: Cli, fixtures: Path, tmp_path: Path
) -> None:
    arguments = (
        "lower",
        "twincat/press_station.xml",
        tmp_path / "x.st",
        "--to",
        "iec-text",
        "--pou",
        "MAIN",
        "--no-verify",
    )
    refused = cli(*arguments)
    assert refused.code == 2
    assert "an error was found in reading" in refused.err
    assert list(tmp_path.iterdir()) == []
    accepted = cli(*arguments, "--accept-errors")
    assert accepted.code == 1
    assert "approximated: error POU FB_Press" in accepted.out
    assert (tmp_path / "x.st").exists()


def test_a_wrong_limit_is_told_before_anything_is_compared(cli: Cli, plant: Path) -> None:
    done = cli("lower", "plant.xml", "--to", "scl", "--limit", "ten")
    assert done.code == 2
    assert "'ten' is no time limit" in done.err
    assert "--no-verify" not in done.err


def test_a_comparison_that_is_interrupted_ends_as_interrupted(
    cli: Cli, plant: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("plcopen_sfc.analysis.equivalence.search", interrupt)
    done = cli("lower", "plant.xml", "out.st", "--to", "iec-text")
    assert done.code == 130
    assert "the comparison was interrupted, so not all was reached" in done.err
    assert not (plant / "out.st").exists()


def test_functions_of_a_python_file_are_called(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("main.st").write_text(
        "PROGRAM Main VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR "
        "INITIAL_STEP S1: END_STEP STEP S2: Work(N); END_STEP TRANSITION FROM S1 TO S2 := a; END_TRANSITION "
        "TRANSITION FROM S2 TO S1 := NOT a; END_TRANSITION ACTION Work: n := Vendor(n); END_ACTION END_PROGRAM",
        encoding="utf-8",
    )
    Path("vendor.py").write_text("def Vendor(n):\n    print('noise')\n    return (n + 1) % 5\n", encoding="utf-8")
    asked = ("lower", "main.st", "out.scl", "--to", "scl")
    assert "unknown, taken as functions of what they are given: Vendor" in cli(*asked).out
    done = cli(*asked, "--functions", "vendor.py")
    assert (done.code, "unknown" in done.out) == (0, False)
    assert "equal (proof: 10 states, all inputs)" in done.out
    run = cli("simulate", "main.st", "--functions", "vendor.py", "--set", "a=TRUE", "--scans", "7", "--json")
    (column,) = [each for each in json.loads(run.out)["columns"] if each["name"] == "n"]
    assert [value for _, value in column["changes"]] == [1, 2, 3, 4, 0, 1, 2]
    assert cli(*asked, "--functions", "missing.py").code == 2


def test_items_with_one_reason_are_in_one_line(cli: Cli, fixtures: Path, tmp_path: Path) -> None:
    arguments = ["lower", fixtures / "steplist/mixer.csv", tmp_path / "mixer.scl", "--to", "scl", "--no-verify"]
    told = [line for line in cli(*arguments).out.splitlines() if line.startswith("not executed")]
    assert len(told) == 1
    assert "global variable Start, Fault" in told[0]
    assert "and 5 more: " in told[0]
    each = [line for line in cli(*arguments, "--verbose").out.splitlines() if line.startswith("not executed")]
    assert len(each) == 11
