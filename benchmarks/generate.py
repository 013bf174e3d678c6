"""Writes the files that are measured: projects of many charts, of any size, always the same.

    python -m benchmarks.generate big.xml                       10 MB: 50 charts of 200 steps, TC6 2.01
    python -m benchmarks.generate big.xml --size 100            100 MB: 500 of these charts
    python -m benchmarks.generate big.xml --dialect codesys     10 MB as CODESYS exports them

A chart repeats a station of eight steps: two in a row, a selection of two, one, and two simultaneous branches of two
and one. Four of the eight have an action block. Conditions are inline ST and wires from variables.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

STEPS = 200
STATION = 8
NAMES = ("Infeed", "Clamp", "FillFast", "FillSlow", "Settle", "Cap", "Torque", "Print")
Action = tuple[str, str, str]
"""Qualifier, duration and what: a variable, or ST where it ends with a semicolon."""


class FileStyle(Protocol):
    """How a tool writes the elements of a chart. Each method gives the text of one, with its line end."""

    def head(self, charts: int) -> str:
        """Return the text before the first chart."""

    def tail(self, charts: int) -> str:
        """Return the text behind the last chart."""

    def open(self, chart: int, names: list[str]) -> str:
        """The POU and its variables."""

    def close(self, chart: int) -> str:
        """The end of the POU."""

    def step(self, number: int, name: str, source: str, at: tuple[int, int], *, acts: bool) -> str:
        """A step. `source` is its wire; empty for the initial step."""

    def block(self, number: int, step: int, actions: list[Action], at: tuple[int, int]) -> str:
        """An action block."""

    def transition(self, number: int, source: str, condition: str, order: int, at: tuple[int, int]) -> str:
        """A transition with an inline condition, or one that begins with ``<`` for a wire."""

    def variable(self, number: int, name: str, at: tuple[int, int]) -> str:
        """A variable as the source of a wire."""

    def bar(self, number: int, kind: str, sources: list[str], legs: int, at: tuple[int, int]) -> str:
        """A divergence or convergence."""

    def jump(self, number: int, source: str, target: str, at: tuple[int, int]) -> str:
        """A jump."""


class Standard:
    """TC6 2.01 with positions and without extensions, not indented: about 1 kB a step."""

    wired_only = False
    charts_per_megabyte = 5.0
    _formal = ' formalParameter=""'  # the schema demands it where an element may have several outputs

    def head(self, charts: int) -> str:
        """The head of a project."""
        return f"""<?xml version='1.0' encoding='utf-8'?>
<project xmlns="http://www.plcopen.org/xml/tc6_0201" xmlns:xhtml="http://www.w3.org/1999/xhtml">
<fileHeader companyName="Bench" productName="Bench" productVersion="1" creationDateTime="2026-01-05T08:00:00"/>
<contentHeader name="{charts} lines" modificationDateTime="2026-01-05T08:00:00">
<coordinateInfo>
<fbd><scaling x="0" y="0"/></fbd>
<ld><scaling x="0" y="0"/></ld>
<sfc><scaling x="0" y="0"/></sfc>
</coordinateInfo>
</contentHeader>
<types>
<dataTypes/>
<pous>
"""

    def tail(self, charts: int) -> str:
        """The end of a project."""
        instances = "".join(f'<pouInstance name="Run{chart}" typeName="Line{chart:03}"/>\n' for chart in range(charts))
        return f"""</pous>
</types>
<instances>
<configurations>
<configuration name="Plant">
<resource name="Cpu1">
<task name="Main" interval="T#20ms" priority="1"/>
{instances}</resource>
</configuration>
</configurations>
</instances>
</project>
"""

    def open(self, chart: int, names: list[str]) -> str:
        """The head of a program."""
        variables = "".join(f'<variable name="{name}"><type><BOOL/></type></variable>\n' for name in names)
        return f"""<pou name="Line{chart:03}" pouType="program">
<interface>
<localVars>
{variables}</localVars>
</interface>
<body>
<SFC>
"""

    def close(self, chart: int) -> str:  # noqa: ARG002  # one of a kind
        """The end of a program."""
        return "</SFC>\n</body>\n</pou>\n"

    @staticmethod
    def _element(tag: str, attributes: str, at: tuple[int, int], *content: str) -> str:
        lines = "".join(f"{line}\n" for line in content)
        return f'<{tag} {attributes}>\n<position x="{at[0]}" y="{at[1]}"/>\n{lines}</{tag}>\n'

    @staticmethod
    def _input(source: str, x: int | None = None) -> str:
        place = "" if x is None else f'<relPosition x="{x}" y="0"/>'
        return f'<connectionPointIn>{place}<connection refLocalId="{source}"/></connectionPointIn>'

    @staticmethod
    def _output(x: int, y: int, tag: str = "connectionPointOut", formal: str = "") -> str:
        return f'<{tag}{formal}><relPosition x="{x}" y="{y}"/></{tag}>'

    def step(self, number: int, name: str, source: str, at: tuple[int, int], *, acts: bool) -> str:
        """``step``."""
        content = [self._input(source)] if source else []
        content.append(self._output(40, 30, formal=self._formal))
        if acts:
            content.append(self._output(80, 15, "connectionPointOutAction", self._formal))
        initial = "" if source else ' initialStep="true"'
        return self._element("step", f'localId="{number}" name="{name}"{initial} height="30" width="80"', at, *content)

    def block(self, number: int, step: int, actions: list[Action], at: tuple[int, int]) -> str:
        """``actionBlock``."""
        entries = []
        for qualifier, duration, what in actions:
            time = f' duration="{duration}"' if duration else ""
            content = f'<reference name="{what}"/>'
            if what.endswith(";"):
                content = f"<inline><ST><xhtml:p><![CDATA[{what}]]></xhtml:p></ST></inline>"
            start = f'<action localId="0" qualifier="{qualifier}"{time}>'
            entries.append(f'{start}<relPosition x="0" y="0"/>{content}</action>')
        size = f'height="{30 * len(actions)}" width="200"'
        return self._element("actionBlock", f'localId="{number}" {size}', at, self._input(str(step)), *entries)

    def transition(self, number: int, source: str, condition: str, order: int, at: tuple[int, int]) -> str:
        """``transition``."""
        priority = f' priority="{order}"' if order else ""
        content = f'<inline name=""><ST><xhtml:p><![CDATA[{condition}]]></xhtml:p></ST></inline>'
        if condition.startswith("<"):
            content = f'<connectionPointIn><connection refLocalId="{condition[1:]}"/></connectionPointIn>'
        return self._element(
            "transition",
            f'localId="{number}"{priority} height="2" width="20"',
            (at[0] + 30, at[1]),
            self._input(source),
            self._output(10, 2),
            f"<condition>{content}</condition>",
        )

    def variable(self, number: int, name: str, at: tuple[int, int]) -> str:
        """``inVariable``."""
        return self._element(
            "inVariable",
            f'localId="{number}" height="25" width="60"',
            (at[0] - 100, at[1]),
            self._output(60, 12),
            f"<expression>{name}</expression>",
        )

    def bar(self, number: int, kind: str, sources: list[str], legs: int, at: tuple[int, int]) -> str:
        """One of the four kinds of divergences and convergences."""
        inputs = [self._input(source, 200 * leg) for leg, source in enumerate(sources)]
        outputs = [self._output(200 * leg, 3, formal="" if legs == 1 else self._formal) for leg in range(legs)]
        return self._element(kind, f'localId="{number}" height="3" width="200"', at, *inputs, *outputs)

    def jump(self, number: int, source: str, target: str, at: tuple[int, int]) -> str:
        """``jumpStep``."""
        attributes = f'localId="{number}" targetName="{target}" height="13" width="12"'
        return self._element("jumpStep", attributes, at, self._input(source))


class Codesys:
    """As CODESYS V3 exports: no positions, the properties of each element in foreign data, conditions as variables."""

    wired_only = True
    charts_per_megabyte = 1.35
    _flags = (
        "EnableLimit Init Reset QuitError Pause Error Trans ErrorStep ErrorPOU CurrentStep Tip TipMode MaxFlags "
        "SFCErrorAnalyzation SFCErrorAnalyzationTable CurrentSteps"
    ).split()
    _name, _comment, _symbol, _duplicate, _initial, _excluded, _qualifier, _order, _parallel, _maximum, _entry = (
        "38391c6d-6d4a-42f8-8ee7-9f45e5adafa8",
        "7d894980-aeea-405c-a0f6-e2b26429c58f",
        "01580b27-6378-448b-8ecb-0e4b795b58d6",
        "bc882c11-1e91-4dd8-a6b8-2075724ed18b",
        "6844a48e-46c2-4cc8-a185-a478f3b99cc0",
        "62e1754b-7629-4e63-9cec-10ae0c536f1f",
        "e174fc0d-80b0-4a9e-a530-ca239c249a50",
        "8294df19-5962-4dee-a874-1051dabb0e3e",
        "23bdaa98-72ec-41f7-817b-9dede5697086",
        "b693554c-1b01-4a8d-afde-9e3a46f7465d",
        "a6b08bd8-b696-47e3-9cbf-7408b61c9ff8",
    )
    _data = "http://www.3s-software.com/plcopenxml/"

    def head(self, charts: int) -> str:
        """The head of a project."""
        return f"""\ufeff<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0200">
  <fileHeader companyName="" productName="CODESYS" productVersion="CODESYS V3.5 SP18 Patch 3" \
creationDateTime="2026-01-05T08:00:00.5129077" />
  <contentHeader name="{charts}_stations.project" modificationDateTime="2026-01-05T08:00:00.2071134">
    <coordinateInfo>
      <fbd>
        <scaling x="1" y="1" />
      </fbd>
      <ld>
        <scaling x="1" y="1" />
      </ld>
      <sfc>
        <scaling x="1" y="1" />
      </sfc>
    </coordinateInfo>
    <addData>
      <data name="{self._data}projectinformation" handleUnknown="implementation">
        <ProjectInformation />
      </data>
    </addData>
  </contentHeader>
  <types>
    <dataTypes />
    <pous>
"""

    def tail(self, charts: int) -> str:
        """The end of a project."""
        objects = "".join(
            f'        <Object Name="Line{chart:03}" ObjectId="{self._object(chart)}" />\n' for chart in range(charts)
        )
        return f"""    </pous>
  </types>
  <instances>
    <configurations />
  </instances>
  <addData>
    <data name="{self._data}projectstructure" handleUnknown="discard">
      <ProjectStructure>
{objects}      </ProjectStructure>
    </data>
  </addData>
</project>"""

    @staticmethod
    def _object(chart: int) -> str:
        return f"5f0c1a2e-7b3d-4c58-9a61-{chart:012x}"

    def open(self, chart: int, names: list[str]) -> str:
        """The head of a program."""
        variables = "".join(
            f"""            <variable name="{name}">
              <type>
                <BOOL />
              </type>
            </variable>
"""
            for name in names
        )
        return f"""      <pou name="Line{chart:03}" pouType="program">
        <interface>
          <localVars>
{variables}          </localVars>
        </interface>
        <body>
          <SFC>
"""

    def close(self, chart: int) -> str:
        """The settings and the end of a program."""
        flags = "".join(f'                <{flag} Declare="true" Use="false" />\n' for flag in self._flags)
        return f"""          </SFC>
        </body>
        <addData>
          <data name="{self._data}sfcsettings" handleUnknown="implementation">
            <SFCSettings>
              <LibTitle>IecSfc</LibTitle>
              <LibCompany>System</LibCompany>
              <LibVersion>4.1.0.0</LibVersion>
              <LibNamespace>IecSfc</LibNamespace>
              <CalcActiveTransOnly>true</CalcActiveTransOnly>
              <UseDefaults>false</UseDefaults>
              <Flags>
{flags}              </Flags>
            </SFCSettings>
          </data>
          <data name="{self._data}objectid" handleUnknown="discard">
            <ObjectId>{self._object(chart)}</ObjectId>
          </data>
        </addData>
      </pou>
"""

    def _attributes(self, indent: str, *values: tuple[str, str]) -> str:
        lines = "".join(f'{indent}      <attribute guid="{guid}">{value}</attribute>\n' for guid, value in values)
        return f"""{indent}<addData>
{indent}  <data name="{self._data}sfc/element" handleUnknown="implementation">
{indent}    <attributes xmlns="">
{lines}{indent}    </attributes>
{indent}  </data>
{indent}</addData>
"""

    @staticmethod
    def _inputs(sources: list[str], formal: str = "") -> str:
        return "".join(
            f"""              <connectionPointIn>
                <connection refLocalId="{source}"{formal} />
              </connectionPointIn>
"""
            for source in sources
        )

    def step(self, number: int, name: str, source: str, at: tuple[int, int], *, acts: bool) -> str:  # noqa: ARG002
        """``step``; every fourth has a maximum time, every seventh an entry action."""
        initial = "" if source else ' initialStep="true"'
        inputs = self._inputs([source]) if source else "              <connectionPointIn />\n"
        values = [
            (self._name, name),
            (self._symbol, "FALSE"),
            (self._duplicate, "0"),
            (self._initial, "FALSE" if source else "TRUE"),
            (self._excluded, "FALSE"),
        ]
        if number % 5 == 0:
            values.insert(1, (self._comment, f"Waits for {name.lower()}"))
        if number % 4 == 0:
            values.append((self._maximum, f"T#{number % 50 + 1}s"))
        action_output = '              <connectionPointOutAction formalParameter="x" />\n' if acts else ""
        return f"""            <step localId="{number}"{initial} name="{name}">
              <position x="0" y="0" />
{inputs}              <connectionPointOut formalParameter="sfc" />
{action_output}{self._attributes("              ", *values)}            </step>
"""

    def block(self, number: int, step: int, actions: list[Action], at: tuple[int, int]) -> str:  # noqa: ARG002
        """``actionBlock``."""
        entries = []
        for qualifier, duration, what in actions:
            data = self._attributes(
                "                ",
                (self._name, what),
                (self._symbol, "FALSE"),
                (self._duplicate, "0"),
                (self._qualifier, f"{qualifier} {duration}".strip()),
            )
            start = f'<action localId="0" qualifier="{qualifier}" duration="{duration}" indicator="">'
            entries.append(f"""              {start}
                <relPosition x="0" y="0" />
                <reference name="{what}" />
                <connectionPointOut />
{data}              </action>
""")
        return f"""            <actionBlock localId="{number}">
              <position x="0" y="0" />
{self._inputs([str(step)])}{"".join(entries)}            </actionBlock>
"""

    def transition(self, number: int, source: str, condition: str, order: int, at: tuple[int, int]) -> str:  # noqa: ARG002
        """``transition``, always wired: `condition` is the wire and behind a blank what it carries."""
        wire, _, text = condition[1:].partition(" ")
        data = self._attributes(
            "              ",
            (self._name, text),
            (self._symbol, "FALSE"),
            (self._duplicate, "0"),
            (self._excluded, "FALSE"),
            (self._order, "0"),
        )
        return f"""            <transition localId="{number}">
              <position x="0" y="0" />
{self._inputs([source], ' formalParameter="sfc"')}              <condition>
                <connectionPointIn>
                  <connection refLocalId="{wire}" />
                </connectionPointIn>
              </condition>
{data}            </transition>
"""

    def variable(self, number: int, name: str, at: tuple[int, int]) -> str:  # noqa: ARG002
        """``inVariable``."""
        return f"""            <inVariable localId="{number}">
              <position x="0" y="0" />
              <connectionPointOut />
              <expression>{name}</expression>
            </inVariable>
"""

    def bar(self, number: int, kind: str, sources: list[str], legs: int, at: tuple[int, int]) -> str:  # noqa: ARG002
        """One of the four kinds of divergences and convergences."""
        if legs == 1:
            inputs = self._inputs(sources, ' formalParameter="sfc"')
            return f"""            <{kind} localId="{number}">
              <position x="0" y="0" />
{inputs}              <connectionPointOut />
            </{kind}>
"""
        parallel = kind.startswith("sim")
        name = f' name="Branch{number}"' if parallel else ""
        data = self._attributes(
            "              ",
            (self._name, f"Branch{number}"),
            (self._symbol, "FALSE"),
            (self._parallel, "TRUE" if parallel else "FALSE"),
        )
        outputs = '              <connectionPointOut formalParameter="sfc" />\n' * legs
        return f"""            <{kind}{name} localId="{number}">
              <position x="0" y="0" />
{self._inputs(sources)}{outputs}{data}            </{kind}>
"""

    def jump(self, number: int, source: str, target: str, at: tuple[int, int]) -> str:  # noqa: ARG002
        """``jumpStep``."""
        return f"""            <jumpStep localId="{number}" targetName="{target}">
              <position x="0" y="0" />
{self._inputs([source])}{self._attributes("              ", (self._name, target), (self._symbol, "FALSE"))}\
            </jumpStep>
"""


class _Chart:
    """Builds one chart, element after element, in a dialect."""

    def __init__(self, dialect: Standard | Codesys) -> None:
        self.write: FileStyle = dialect
        self.wired_only = dialect.wired_only
        self.parts: list[str] = []
        self.count = 0
        self.steps = 0
        self.y = 0

    def number(self) -> int:
        self.count += 1
        return self.count

    def step(self, name: str, source: str, x: int = 400, actions: list[Action] | None = None) -> str:
        self.y += 70
        self.steps += 1
        number = self.number()
        self.parts.append(self.write.step(number, name, source, (x, self.y), acts=bool(actions)))
        if actions:
            self.parts.append(self.write.block(self.number(), number, actions, (x + 140, self.y)))
        return str(number)

    def transition(self, source: str, condition: str, x: int = 400, order: int = 0, *, wired: bool = False) -> str:
        self.y += 60
        if wired or self.wired_only:
            variable = self.number()
            self.parts.append(self.write.variable(variable, condition, (x, self.y)))
            condition = f"<{variable} {condition}" if self.wired_only else f"<{variable}"
        number = self.number()
        self.parts.append(self.write.transition(number, source, condition, order, (x, self.y)))
        return str(number)

    def bar(self, kind: str, sources: list[str], legs: int) -> str:
        self.y += 40
        number = self.number()
        self.parts.append(self.write.bar(number, kind, sources, legs, (440, self.y)))
        return str(number)

    def station(self, index: int, source: str) -> str:
        """Eight steps; gives the id of the transition that leaves the last."""
        name = [f"{each}{index}" for each in NAMES]
        first = self.step(name[0], source, actions=[("N", "", f"Belt{index}"), self._pulse(index)])
        there = self.transition(first, f"InPlace{index} AND NOT Door")
        clamp = self.step(name[1], there, actions=[("S", "", f"Clamp{index}")])
        split = self.bar("selectionDivergence", [clamp], 2)
        fast = self.transition(split, f"Large{index}", 400, 1, wired=True)
        fast = self.step(name[2], fast, 400, [("L", "T#5s", f"Valve{index}"), ("N", "", "Pump")])
        fast = self.transition(fast, f"{name[2]}.T &gt; T#4s" if self.wired_only else f"{name[2]}.T > T#4s")
        slow = self.transition(split, f"NOT Large{index}", 600, 2)
        slow = self.step(name[3], slow, 600)
        slow = self.transition(slow, f"Level{index}", 600, wired=True)
        joined = self.bar("selectionConvergence", [fast, slow], 1)
        settle = self.step(name[4], joined)
        done = self.transition(settle, f"Settled{index} OR Door")
        fork = self.bar("simultaneousDivergence", [done], 2)
        left = self.step(name[5], fork, 400, [("D", "T#200ms", f"Cap{index}")])
        left = self.transition(left, f"Capped{index}")
        left = self.step(name[6], left, 400)
        right = self.step(name[7], fork, 600)
        both = self.bar("simultaneousConvergence", [left, right], 1)
        return self.transition(both, f"Printed{index}")

    def _pulse(self, index: int) -> Action:
        """Return the text of an action that is executed once; CODESYS has no P1."""
        return ("P", "", f"Count{index}") if self.wired_only else ("P1", "", f"Count{index} := NOT Count{index};")


VARIABLES = "Belt Clamp Count Valve Cap".split()
"""The variables that a station declares; its inputs count as global."""


def chart_text(index: int, dialect: Standard | Codesys, steps: int = STEPS) -> str:
    """One POU with a chart of so many steps."""
    chart = _Chart(dialect)
    source, station = "", 0
    while steps - chart.steps >= STATION:
        source = chart.station(station, source)
        station += 1
    while chart.steps < steps:  # what is left when the steps are no multiple of eight
        source = chart.transition(chart.step(f"Rest{chart.steps}", source), "NOT Door")
    first = f"{NAMES[0]}0" if station else "Rest0"
    chart.parts.append(dialect.jump(chart.number(), source, first, (400, chart.y + 60)))
    names = ["Door", "Pump"] + [f"{name}{number}" for number in range(station) for name in VARIABLES]
    return dialect.open(index, names) + "".join(chart.parts) + dialect.close(index)


def project_parts(charts: int, dialect: Standard | Codesys, steps: int = STEPS) -> Iterator[str]:
    """A project, POU after POU."""
    yield dialect.head(charts)
    for index in range(charts):
        yield chart_text(index, dialect, steps)
    yield dialect.tail(charts)


def generate(path: Path, *, megabytes: float = 10, codesys: bool = False, steps: int = STEPS) -> int:
    """Write a project of about `megabytes` to `path`, charts of `steps` steps, at least one; returns how many.

    The size is that with `STEPS` steps.
    """
    dialect = Codesys() if codesys else Standard()
    charts = max(1, round(megabytes * dialect.charts_per_megabyte))
    with path.open("w", encoding="utf-8", newline="\r\n" if codesys else "\n") as file:
        file.writelines(project_parts(charts, dialect, steps))
    return charts


def main() -> None:
    """Write one file."""
    parser = argparse.ArgumentParser(description="Write a project of many charts to measure with.")
    parser.add_argument("file", type=Path)
    parser.add_argument("--size", type=float, default=10, metavar="MB", help="about so many megabytes (default 10)")
    parser.add_argument("--dialect", choices=("plcopen", "codesys"), default="plcopen")
    options = parser.parse_args()
    charts = generate(options.file, megabytes=options.size, codesys=options.dialect == "codesys")
    size = options.file.stat().st_size / 1e6
    print(f"{options.file}: {size:.1f} MB, {charts} charts of {STEPS} steps, {charts * STEPS} steps")


if __name__ == "__main__":
    main()
