"""An example of each rule of the adaptation, converted: what the target tool reads in place of what the source has.

``python -m tests.conversion.rule_examples`` prints the examples of docs/conversion.md.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.comparison import Change, ChangeKind, diff
from plcopen_sfc.conversion.adaptation.chart_rules import CHART_RULES
from plcopen_sfc.conversion.adaptation.project_rewriting import RULES
from plcopen_sfc.report import ConversionReport, Outcome
from tests.conversion.features import FEATURES, Feature, FeatureChart, drawn, feature_project, settings, variable

_FIXTURES = Path(__file__).parents[2] / "fixtures"
_TOOLS = {"codesys": "CODESYS", "plcopen-2.01": "TC6", "codesys23": "CoDeSys 2.3"}


@dataclass(frozen=True)
class RuleExample:
    """A rule, by what it is about, with a small source and a target in which the rule acts."""

    rule: str
    load: Callable[[], m.Project]
    target: str
    shown: str = ""
    """What the lines of the source contain that are shown although they stay."""

    def converted(self) -> tuple[m.Project, m.Project, ConversionReport]:
        """Return the source, what the target tool reads of the converted file, and the report."""
        source = self.load()
        data, report = sfc.convert(source, self.target, partial=True, limit=0)
        return source, sfc.loads(data, format=self.target, as_tool=True), report

    def lines(self) -> list[str]:
        """Return what the target tool reads (``+``) in place of what the source has (``-``), and what the report tells.

        Where nothing but the outcome tells of the rule, the report does it alone.
        """
        source, result, report = self.converted()
        changes = [line for change in diff(source, result).changes for line in _change_lines(change)]
        before, after = list(_listing(source)), list(_listing(result))
        spelled = [{_plain(line) for line in lines} for lines in (before, after)]
        changes += [f"- {line}" for line in before if _plain(line) not in spelled[1]]
        changes += [f"+ {line}" for line in after if _plain(line) not in spelled[0]]
        told = [item for item in report.items if item.outcome in _TOLD and item.what != "text"]
        told = [item for item in told if item.outcome is not Outcome.TRANSLATED or not changes]
        stays = [f"  {line}" for line in before if self.shown and self.shown in line]
        if len(changes) > _LENGTH:
            changes = [*changes[:_LENGTH], "  .."]
        return stays + changes + [f"  {item.outcome}: {item.what}: {item.why}" for item in told]


def _feature(name: str, source: str = "simaticml") -> Callable[[], m.Project]:
    return lambda: _in_file(next(each for each in FEATURES if each.name == name), source)


def _chart(build: Callable[[FeatureChart], None], source: str) -> Callable[[], m.Project]:
    return lambda: _in_file(Feature("", (source,), build), source)


def _in_file(feature: Feature, source: str) -> m.Project:
    """Return the chart as a file of its tool has it."""
    data = sfc.dumps(feature_project(feature, source), format=source, partial=True, limit=0)
    return sfc.loads(data, format=source)


def _text(text: str, kind: str) -> Callable[[], m.Project]:
    return lambda: sfc.loads(text.encode(), format=kind)


def _code_in_c(rig: FeatureChart) -> None:
    rig.action("Beep", m.StBody(text="{{ beep(); }}"))
    rig.act("Work", "Beep")


def _drawn(text: str, language: str, dialect: m.Dialect = m.Dialect.SCL) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        block = m.Pou(name="FB_Lamp", kind=m.PouKind.FUNCTION_BLOCK, bodies=[drawn(text, language, dialect)])
        sections = [
            m.VariableSection(kind=m.SectionKind.INPUT, variables=[variable("run")]),
            m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[variable("lamp")]),
            m.VariableSection(kind=m.SectionKind.LOCAL, variables=[variable("before")]),
        ]
        block.interface = m.Interface(sections=sections)
        rig.project.pous.append(block)

    return build


def _declares(name: str, type_: str, initial: str | None = None) -> Callable[[FeatureChart], None]:
    return lambda rig: rig.declare(m.SectionKind.LOCAL, variable(name, type_, initial=initial))


def _shared_variable(rig: FeatureChart) -> None:
    for name, text in (("Twice", "n := n * 2;"), ("AddOne", "n := n + 1;")):
        rig.action(name, m.StBody(text=text))
        rig.act("Work", name)


def _globals(rig: FeatureChart) -> None:
    section = m.VariableSection(kind=m.SectionKind.GLOBAL, name="GVL_IO", variables=[variable("lamp")])
    rig.project.global_variables.append(section)
    rig.action("Show", m.StBody(text="GVL_IO.lamp := a;"))
    rig.act("Work", "Show")


def _analysed(rig: FeatureChart) -> None:
    rig.chart.settings = settings(m.SfcFlag.ERROR, m.SfcFlag.ERROR_ANALYZATION)
    rig.declare(m.SectionKind.LOCAL, variable("SFCErrorAnalyzation", "STRING"), variable("told", "STRING"))
    rig.action("Tell", m.StBody(text="told := SFCErrorAnalyzation;"))
    rig.act("Work", "Tell")


def _edge_contact(rig: FeatureChart) -> None:
    box = {
        "id": 4,
        "kind": "block",
        "type_name": "PContact",
        "parameters": {
            "inputs": [
                {"name": "pre", "input": {"connections": [{"source": 0}]}},
                {"name": "operand", "input": {"expression": "#run"}},
                {"name": "bit", "input": {"expression": "#before"}},
            ],
            "outputs": [{"name": "out", "output": {}}],
        },
    }
    rail = {"id": 0, "kind": "leftPowerRail", "outputs": [{}]}
    coil = {"id": 9, "kind": "coil", "variable": "#lamp", "input": {"connections": [{"source": 4, "pin": "out"}]}}
    _drawn("#lamp := #run;", "LD")(rig)
    rig.project.pous[-1].bodies = [m.LdBody.model_validate({"networks": [{"nodes": [rail, box, coil]}]})]


def _in_other_order(rig: FeatureChart) -> None:
    _drawn("lamp := run; before := lamp;", "FBD", m.Dialect.IEC)(rig)
    body = rig.project.pous[-1].bodies[0]
    assert isinstance(body, m.FbdBody)
    nodes = [node for network in body.networks for node in network.nodes]
    for top, node in enumerate(nodes):
        node.position = (0, top * 40)
    body.networks = [m.LogicNetwork(nodes=nodes[::-1])]


_OPERANDS = """\
FUNCTION_BLOCK Main
VAR_INPUT
    t1 : TIMER;
    c1 : COUNTER;
END_VAR
BEGIN
END_FUNCTION_BLOCK
"""
_TASK = """\
PROGRAM Main
VAR
    n : INT;
END_VAR
n := n + 1;
END_PROGRAM

CONFIGURATION C
RESOURCE R ON PLC
TASK t(INTERVAL := T#20ms, PRIORITY := 1);
PROGRAM Main WITH t : Main;
END_RESOURCE
END_CONFIGURATION
"""


def _system_data(rig: FeatureChart) -> None:
    rig.declare(m.SectionKind.LOCAL, variable("Work", "G7_StepPlus_V6"), variable("mine", "INT"))


def _void() -> m.Project:
    return sfc.load(_FIXTURES / "simaticml" / "FC_Count.xml")


EXAMPLES = (
    RuleExample(RULES[0].of, _chart(_code_in_c, "plcopen"), "codesys", "beep"),
    RuleExample(RULES[1].of, _chart(_drawn("#lamp := #run;", "FBD"), "simaticml"), "codesys"),
    RuleExample(RULES[2].of, _chart(_in_other_order, "plcopen"), "codesys"),
    RuleExample(RULES[3].of, _chart(_declares("hold", "S5TIME", "S5T#1s5ms"), "simaticml"), "codesys"),
    RuleExample(RULES[4].of, _chart(_declares("when", "DTL"), "simaticml"), "plcopen-2.01", "DTL"),
    RuleExample(RULES[5].of, _chart(_edge_contact, "simaticml"), "plcopen-2.01"),
    RuleExample(RULES[6].of, _chart(_declares("SFCReset", "BOOL"), "plcopen"), "codesys", "SFCReset"),
    RuleExample(RULES[7].of, _chart(_shared_variable, "plcopen"), "codesys", "ACTION"),
    RuleExample(RULES[8].of, _chart(_globals, "codesys"), "plcopen-2.01"),
    RuleExample(RULES[9].of, _feature("event S1"), "codesys"),
    RuleExample(RULES[10].of, _text(_OPERANDS, "scl"), "codesys"),
    RuleExample(RULES[11].of, _text(_TASK, "iec-text"), "codesys23"),
    RuleExample(RULES[12].of, _feature("address"), "codesys"),
    RuleExample(RULES[13].of, _chart(_declares("flash", "BLINK"), "codesys"), "plcopen-2.01", "BLINK"),
    RuleExample(RULES[14].of, _void, "codesys"),
    RuleExample(RULES[15].of, _chart(_system_data, "simaticml"), "codesys"),
    RuleExample(RULES[16].of, _feature("retained member"), "plcopen-2.01"),
    RuleExample(CHART_RULES[0].of, _feature("supervision"), "codesys"),
    RuleExample(CHART_RULES[1].of, _feature("interlock with N"), "codesys"),
    RuleExample(CHART_RULES[2].of, _feature("INIT_SQ"), "codesys"),
    RuleExample(CHART_RULES[3].of, _feature("SkipSteps"), "codesys"),
    RuleExample(CHART_RULES[4].of, _feature("permanent instruction after"), "codesys"),
    RuleExample(CHART_RULES[5].of, _feature("drawn logic", "plcopen"), "codesys"),
    RuleExample(CHART_RULES[6].of, _feature("ON"), "codesys"),
    RuleExample(CHART_RULES[7].of, _feature("SFCReset", "codesys"), "plcopen-2.01"),
    RuleExample(CHART_RULES[8].of, _feature("permanent instruction after"), "plcopen-2.01"),
    RuleExample(CHART_RULES[9].of, _chart(_analysed, "codesys"), "plcopen-2.01", "Analyzation"),
)


_TOLD = (Outcome.NOT_EXECUTED, Outcome.APPROXIMATED, Outcome.TRANSLATED)
_LENGTH = 12
"""The changed lines that are shown of an example."""
_AROUND = ("CONFIGURATION", "RESOURCE")
_PRAGMA = re.compile(r"\s*\{plcopen_sfc[^}]*\}")


def _change_lines(change: Change) -> Iterator[str]:
    """Yield a change of a chart as lines of a difference; declarations and bodies are those of the listing."""
    place = change.place.removeprefix("POU Main / ")
    if change.kind is ChangeKind.MOVED or not place.startswith(("step", "transition", "chart")):
        return
    for sign, told in (("-", change.before), ("+", change.after)):
        if told is not None:
            yield " ".join(f"{sign} {place}: {change.aspect} {told}".split())


def _listing(project: m.Project) -> Iterator[str]:
    """Yield the declarations and statements outside of charts as lines of textual SFC."""
    data = sfc.dumps(project, format="iec-text", partial=True, limit=0)
    around, is_chart = "", False
    for raw in data.decode().splitlines():
        line = " ".join(_PRAGMA.sub("", raw).split())
        word = line.partition(" ")[0].rstrip(":")
        if word in ("STEP", "INITIAL_STEP", "TRANSITION"):
            is_chart = True
        if line and not is_chart and word.removeprefix("END_") not in _AROUND:
            if word in ("END_VAR", "END_ACTION", "END_PROGRAM", "END_FUNCTION"):
                around = ""
            elif word.startswith("VAR") or word == "ACTION":
                around = f"{line.rstrip(':')} "
            else:
                yield f"{around}{line}"
        if word in ("END_STEP", "END_TRANSITION"):
            is_chart = False


def _plain(line: str) -> str:
    return line.replace("#", "").replace('"', "").casefold()


def examples_text() -> str:
    """Return the examples in Markdown."""
    parts = []
    for example in EXAMPLES:
        head = f"{example.rule[0].upper()}{example.rule[1:]}; the example is written for {_TOOLS[example.target]}:"
        parts.append("\n".join([head, "", "```diff", *example.lines(), "```"]))
    return "\n\n".join(parts)


if __name__ == "__main__":
    import sys

    sys.stdout.write(examples_text() + "\n")
