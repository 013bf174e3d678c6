"""``.grafcet`` files: read, written, edited, refused, and checked beside the verdicts of their editor."""

from __future__ import annotations

import difflib
import itertools
import re
from collections import Counter
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.marking import MarkingGraph
from plcopen_sfc.errors import StructureError
from plcopen_sfc.model import Expression, Project
from plcopen_sfc.model.numbering import numbered_in_order
from plcopen_sfc.report import Outcome
from plcopen_sfc.semantics.net import Net
from tests.corpus import corpus_files
from tests.lowering.random_grafcets import random_hierarchy

FILES = corpus_files("grafcet")
SAMPLES = [path for path in FILES if path.suffix == ".grafcet"]
REACHED = [path for path in FILES if path.name.startswith("Result_Concurrency_")]
VERDICTS = [path for path in FILES if path.name.startswith("Result_AI_veri_")]


def fresh(project: Project) -> bytes:
    return sfc.dumps(sfc.loads(sfc.dumps(project, format="json")), format="grafcet")


@pytest.mark.corpus
@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_a_sample_comes_back_and_goes_through_text_and_xmi(path: Path) -> None:
    project = sfc.load(path)
    assert project.source is not None
    assert project.source.format == "grafcet"
    assert sfc.dumps(project, format="grafcet") == path.read_bytes()
    for form in ("grafcet", "grafcet-text"):
        written = sfc.loads(sfc.dumps(sfc.loads(sfc.dumps(project, format="json")), format=form))
        assert numbered_in_order(written).pous == numbered_in_order(project).pous


@pytest.mark.parametrize("name", ["four_steps", "two_cylinders", "press", "forcing"])
def test_a_text_becomes_a_file_of_the_editor(name: str) -> None:
    project = sfc.load(Path("fixtures/grafcet") / f"{name}.gct")
    data, report = sfc.convert(project, "grafcet")
    assert numbered_in_order(sfc.loads(data)).pous == numbered_in_order(project).pous
    assert {item.outcome for item in report.items} <= {"kept", "extension data"}


@pytest.mark.parametrize("seed", range(10))
def test_random_grafcets_go_through_files(seed: int) -> None:
    project = Project(name="p", pous=[random_hierarchy(seed)])
    report = sfc.convert(project, "grafcet", partial=True).report
    lost = [item for item in report.items if item.outcome == "not executed"]
    # a variable stands for a time in a term, but for none of an edge or of a time
    assert all("no variable is one" in item.why or "no term" in item.why for item in lost)
    data = sfc.convert(project, "grafcet", partial=True).data
    assert numbered_in_order(sfc.loads(data)).pous == numbered_in_order(project).pous


TIMES = """GRAFCET T
INPUTS
    a
    b
OUTPUTS
    Q1
CHART G1
    INITIAL STEP 1
    1 -> 2 : a * 300ms/X1
    STEP 2
        Q1 IF b + 100ms/(a * b)/200ms
    2 -> 3 : b̅ * /(50ms/a/20ms)
    STEP 3
    3 -> 1 : 200ms/X3
"""


@pytest.mark.slow
def test_times_in_terms_are_inputs_of_their_names() -> None:
    project = sfc.loads(TIMES.encode())
    data, report = sfc.convert(project, "grafcet")
    told = [item.path for item in report.items if item.what == "time" and item.outcome == "approximated"]
    assert [path.rpartition(" / ")[2] for path in told] == ["transition 1 -> 2", "transition 2 -> 3", "action Q1"]
    names = re.findall(r'<variableDeclarations name="([^"]*ms[^"]*)">', data.decode())
    assert names == ["300ms/X1", "50ms/a/20ms", "100ms/(a AND b)/200ms"]
    assert numbered_in_order(sfc.loads(data)).pous == numbered_in_order(project).pous
    seen = sfc.loads(re.sub(rb"<!--.*?-->", b"", data))
    verdict = sfc.equivalent(project, seen, "grafcet", delay="auto", cap=300, runs=5, scans=100)
    assert verdict.counterexample is None, verdict
    edge = sfc.convert(sfc.loads(TIMES.replace("300ms/X1", "300ms/↑b").encode()), "grafcet", partial=True).report
    assert [item.why[:8] for item in edge.items if item.outcome == "not executed"] == ["300ms/↑b"]


def changed(before: str, after: str) -> list[str]:
    lines = difflib.ndiff(before.splitlines(), after.splitlines())
    return [
        line[0] + " ".join(re.findall(r'<\w+|name="[^"]*"|@\w+\.\d+"', line))
        for line in lines
        if line[0] in "+-" and "plcopen_sfc" not in line
    ]


@pytest.mark.parametrize(("start", "told"), [("n : INT := 7", ["POU G / n"]), ("n : INT := 0", []), ("n : INT", [])])
def test_start_values_that_files_do_not_have_are_told(start: str, told: list[str]) -> None:
    """They were extension data, and the verdict was equal: the file keeps them in comments that no editor reads."""
    text = f"GRAFCET G\nINPUTS\n    a\nINTERNALS\n    {start}\nINITIAL STEP 1\n1 -> 1 : [n=7] * a\n"
    report = sfc.convert(sfc.loads(text.encode()), "grafcet", partial=True)[1]
    assert [item.path for item in report.with_outcome(Outcome.NOT_EXECUTED)] == told


OF_SFC = """PROGRAM Main
VAR_INPUT go : BOOL; END_VAR
VAR_OUTPUT q1, q2, q3, q4 : BOOL; END_VAR
INITIAL_STEP S0: q2(R); END_STEP
TRANSITION FROM S0 TO S1 := go; END_TRANSITION
STEP S1: q1(N); q2(S); q3(L, T#2s); q4(D, T#1s); {more} END_STEP
TRANSITION FROM S1 TO S0 := NOT go; END_TRANSITION
ACTION Act: q1 := FALSE; END_ACTION
END_PROGRAM
"""


@pytest.mark.parametrize("form", ["grafcet", "grafcet-text"])
def test_actions_of_other_tools_are_those_of_iec_60848(form: str) -> None:
    """The text had them and the file of the editor refused each output of a chart of CODESYS, TC6 or TIA Portal."""
    source = sfc.loads(OF_SFC.format(more="").encode(), format="iec-text")
    data, report = sfc.convert(source, form, limit=20, strict=True)
    chart = sfc.loads(data, as_tool=True).pous[0].chart
    kinds = [(row.target, row.kind, row.value) for _, row in chart.associations()]
    assert kinds == [
        ("q2", "onActivation", "FALSE"),
        ("q1", "continuous", None),
        ("q2", "onActivation", "TRUE"),
        ("q3", "limited", None),
        ("q4", "delayed", None),
    ]
    assert report.compared["POU Main"].startswith("equal")
    again = sfc.convert(sfc.loads(data), "grafcet").data
    assert len(list(sfc.loads(again, as_tool=True).pous[0].chart.associations())) == len(kinds)


@pytest.mark.parametrize("more", ["q1(P1);", "Act(N);", "q1(SD, T#1s);"])
def test_actions_that_no_file_of_the_editor_has_are_told(more: str) -> None:
    source = sfc.loads(OF_SFC.format(more=more).encode(), format="iec-text")
    with pytest.raises(sfc.LossError):
        sfc.convert(source, "grafcet", limit=0)


@pytest.mark.parametrize("kind", ["entry_action", "main_action", "exit_action"])
def test_actions_of_steps_are_not_left_out_in_silence(kind: str) -> None:
    source = sfc.loads(OF_SFC.format(more="").encode(), format="iec-text")
    setattr(source.pou("Main").chart.step("S1"), kind, "Act")
    with pytest.raises(sfc.LossError, match="none with statements"):
        sfc.convert(source, "grafcet", limit=0)


@pytest.mark.parametrize(
    "place", ["http://www.example.org/%s", "platform:/plugin/org.eclipse.gmf.grafcet/model/%s.ecore"]
)
def test_an_edit_is_put_into_the_file_with_its_references(place: str) -> None:
    data = fresh(sfc.load("fixtures/grafcet/two_cylinders.gct"))
    for name in ("grafcet", "terms"):
        data = data.replace(f"http://www.example.org/{name}".encode(), (place % name).encode())
    project = sfc.loads(data)
    project.rename("Zylinder.2M1", "Vor")
    text = sfc.dumps(project, format="grafcet").decode()
    assert changed(data.decode(), text) == [
        '-<variableDeclarations name="2M1"',
        '+<variableDeclarations name="Vor"',
    ]
    assert project.pous[0].chart is not None
    chart = project.pous[0].chart.partial_charts[0].chart
    condition = chart.transitions[0].condition
    assert isinstance(condition, Expression)
    condition.text = "NOT 1B2"
    assert (place % "terms").encode() in sfc.dumps(project, format="grafcet")
    edited = sfc.loads(sfc.dumps(project, format="grafcet"))
    assert numbered_in_order(edited).pous == numbered_in_order(project).pous
    chart.transitions = [t for t in chart.transitions if chart.step("3").id not in (*t.sources, *t.targets)]
    chart.steps.remove(chart.step("3"))
    removed = sfc.loads(sfc.convert(project, "grafcet").data)
    assert numbered_in_order(removed).pous == numbered_in_order(project).pous


def with_arcs_in_another_order(data: bytes) -> bytes:
    """The file as the editor writes it: arcs in the order in which a person has drawn them."""
    groups = itertools.groupby(data.decode().splitlines(keepends=True), lambda line: "<arcs " in line)
    return "".join(line for arcs, lines in groups for line in (reversed([*lines]) if arcs else lines)).encode()


def lines_gone(before: bytes, after: bytes) -> list[str]:
    old, new = (each.decode().splitlines() for each in (before, after))
    return [line for line in difflib.unified_diff(old, new, n=0) if line[:1] == "-" and line[:3] != "---"]


@pytest.mark.parametrize("name", ["selection", "two_cylinders", "belt"])
def test_an_inserted_step_moves_nothing_that_others_refer_to(name: str) -> None:
    """Arcs in another order than ours had the whole file written again; a transition in the middle moved all others."""
    data = with_arcs_in_another_order(fresh(sfc.load(f"fixtures/grafcet/{name}.gct")))
    links = 0
    for number in range(len(sfc.loads(data).find_transitions())):
        project = sfc.loads(data)
        link = project.find_transitions()[number]
        joined = len(link.sources) > 1 or len(link.targets) > 1
        edit = project.edit()
        step = edit.insert_step("977", link, "TRUE")
        saved = sfc.dumps(project)
        assert len(lines_gone(data, saved)) <= (4 if joined else 1)
        assert numbered_in_order(sfc.loads(saved)).pous == numbered_in_order(project).pous
        edit.delete_step(step, "incoming")
        again = sfc.dumps(project)
        assert numbered_in_order(sfc.loads(again)).pous == numbered_in_order(project).pous
        edit.undo()
        edit.undo()
        assert sfc.dumps(project) == data
        links += 1
    assert links > 3


@pytest.mark.corpus
@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_an_inserted_step_in_a_file_of_the_editor_moves_nothing(path: Path) -> None:
    data = path.read_bytes()
    for link in sfc.loads(data).find_transitions()[:1]:
        project = sfc.loads(data)
        project.edit().insert_step("977", project.find_transitions()[0], "TRUE")
        assert len(lines_gone(data, sfc.dumps(project))) <= 1 + len(link.sources) + len(link.targets)


HEAD = (
    '<grafcet:Grafcet xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
    'xmlns:grafcet="http://www.example.org/grafcet" xmlns:terms="http://www.example.org/terms">'
    '\n<steps xsi:type="grafcet:Step" id="1"/><steps xsi:type="grafcet:Step" id="2"/>\n<transitions id="1">%s'
    "</transitions>\n%s</grafcet:Grafcet>"
)
STEPS = '<arcs source="//@steps.0" target="//@steps.1"/>'


@pytest.mark.parametrize(
    ("term", "rest", "message", "line"),
    [
        ("", '<arcs source="//@steps.7" target="//@steps.0"/>', "the reference '//@steps.7' leads nowhere", 4),
        ("", '<arcs source="//@steps.x" target="//@steps.0"/>', "the reference '//@steps.x' leads nowhere", 4),
        ("", '<arcs source="//%.0" target="//@steps.0"/>', "the reference '//%.0' leads nowhere", 4),
        ("", STEPS, "an arc joins two steps", 4),
        ("", '<arcs source="//@transitions.0" target="//@transitions.0"/>', "an arc joins two transitions", 4),
        ('<term xsi:type="terms:Variable"/>', "", "the reference '' leads nowhere", 3),
        ('<term xsi:type="terms:And"/>', "", "the term And has 0 operands", 3),
        ('<term xsi:type="terms:Until"/>', "", "the term cannot be read: 'Until'", 3),
    ],
)
def test_a_defective_file_is_refused_with_its_line(term: str, rest: str, message: str, line: int) -> None:
    with pytest.raises(StructureError, match=re.escape(message)) as caught:
        sfc.loads((HEAD % (term, rest)).encode())
    assert caught.value.location.line == line


@pytest.mark.corpus
@pytest.mark.skipif(not VERDICTS, reason="no corpus")
def test_checks_agree_with_the_verdicts_of_the_editor() -> None:
    both: dict[str, set[str]] = {"race": set(), "hierarchy": set()}
    ours: dict[str, set[str]] = {"race": set(), "hierarchy": set()}
    constant: Counter[str] = Counter()
    for path in VERDICTS:
        name = path.stem.removeprefix("Result_AI_veri_")
        sample = next((each for each in SAMPLES if each.stem == name), None)
        assert sample is not None
        verdict = path.read_text(encoding="utf-8")
        project = sfc.load(sample)
        findings = sfc.check(project)
        found = {finding.code for finding in findings}
        for kind, code, words in (
            ("race", "ACT04", "The following race conditions were detected"),
            ("hierarchy", "HIE06", "conflicts between hierarchies were detected"),
        ):
            if words in verdict:
                both[kind].add(name)
            if code in found:
                ours[kind].add(name)
        if verdict.startswith("Error"):
            continue
        told = set(re.findall(r"Transition (\d+) (always|never) fires", verdict))
        chart = project.pous[0].chart
        assert chart is not None
        numbers = {
            f"{partial.name} / transition {partial.chart.label(transition)}": str(transition.number)
            for partial in chart.partial_charts
            for transition in partial.chart.transitions
        }
        mine = set()
        for finding in findings:
            if finding.code in ("CND02", "CND03"):
                place = str(finding.location.path).partition(" / ")[2]
                mine.add((numbers[place], "always" if finding.code == "CND02" else "never"))
        constant.update({"both": len(mine & told), "only ours": len(mine - told), "only the editor": len(told - mine)})
    assert both["hierarchy"] == ours["hierarchy"] == {"hierarchicalConflict1"}
    # 1: the editor ends with an error; 6: it follows the values of variables
    assert len(both["race"]) == 7
    assert ours["race"] - both["race"] == {"conflictingActions1", "conflictingActions6"}
    # 7: the transitions before the two actions ask for `b` and for `a AND NOT b`, and no evolution has both
    assert both["race"] - ours["race"] == {"conflictingActions7"}
    assert constant == CONSTANT


@pytest.mark.corpus
@pytest.mark.skipif(not REACHED, reason="no corpus")
def test_steps_that_are_reached_and_active_together_are_those_of_the_editor() -> None:
    """Of each chart of its own; a forced chart has the situations of the order, which the editor takes for none."""
    same = 0
    for path in REACHED:
        sample = next((each for each in SAMPLES if each.stem == path.stem.removeprefix("Result_Concurrency_")), None)
        if sample is None:
            continue
        whole = sfc.load(sample).pous[0].chart
        assert whole is not None
        for part in path.read_text(encoding="utf-8").partition("global Conc")[0].split("Partial Grafcet ")[1:]:
            name, kind = re.findall(r"Dependency: (\S+) - with initialization type (\w+)", part)[0]
            if kind == "forced":
                continue
            chart = next(each.chart for each in whole.partial_charts if each.name == name).model_copy(deep=True)
            links = [
                linked
                for partial in whole.partial_charts
                for step in partial.chart.steps
                for enclosure in step.encloses or ()
                if enclosure.chart == name
                for linked in enclosure.activated_steps
            ]
            for step in chart.steps if kind == "enclosed" else ():
                step.initial = step.name in links
            net = Net.of(chart)
            of_steps = part.partition("concurrent statements")[0]
            lists = re.findall(r"(?m)^s?(\d+|reachable steps): \[(.*)\]", of_steps)
            told = {key: set(re.findall(r"\d+", steps)) for key, steps in lists}
            together: dict[str, set[str]] = {}
            for marking in MarkingGraph(net):
                active = [step.step.name for step in net.steps if marking & step.bit]
                for each in active:
                    together.setdefault(each, set()).update({*active} - {each})
            assert told.pop("reachable steps") == together.keys(), path
            assert [(key, steps) for key, steps in sorted(told.items()) if steps] == [
                (key, steps) for key, steps in sorted(together.items()) if steps
            ]
            same += 1
    assert same == 31


@pytest.mark.corpus
@pytest.mark.skipif(not VERDICTS, reason="no corpus")
def test_steps_that_are_passed_are_those_of_the_editor() -> None:
    same, other = 0, []
    for path in VERDICTS:
        told = re.search(r"steps might be transient: \[(.*)\]|No transient steps", path.read_text(encoding="utf-8"))
        name = path.stem.removeprefix("Result_AI_veri_")
        if told is None:
            continue
        project = sfc.load(next(each for each in SAMPLES if each.stem == name))
        items = sfc.convert(project, "plcopen", partial=True, limit=0).report.items
        why = next((each.why for each in items if "may be active where a GRAFCET only passes" in each.why), "")
        if set(re.findall(r"Step(\d+)", why)) == set(re.findall(r"\d+", told[1] or "")):
            same += 1
        else:
            other.append(name)
    assert same == 13
    # a condition that is never true, a value that the chart writes, a step that is enclosed, more than are listed
    assert sorted(other) == ["flawedTransitions1", "flawedTransitions2", "hierarchicalConflict1", "plant"]


CONSTANT = {"both": 24, "only ours": 2, "only the editor": 10}
"""Constant conditions. Two are the same: their terms have the ids of another transition, after which the editor calls
them (conflictingActions3 and 6). The other 8 are constant by the values that internal variables can have."""
