"""Convert a GRAFCET to a chart that a program calls until it is stable, and prove that it does the same.

python until_stable.py PLAN.gct FILE

A tool fires the transitions of a chart once in a call. So the chart becomes a function block, and the program with the
name of the GRAFCET calls it until no step has changed: that is the search for stability of IEC 60848. FILE is XML for
CODESYS, or textual IEC 61131-3 (.st).
"""

from __future__ import annotations

import sys
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc.model import (
    DerivedType,
    Elementary,
    ElementaryType,
    Interface,
    Pou,
    PouKind,
    SectionKind,
    StBody,
    Variable,
    VariableSection,
)

MOST_CALLS = 1000
"""Calls in one scan: a GRAFCET that fires transitions for ever with the same inputs does not stop the controller."""
FORMATS = {".xml": "codesys", ".st": "iec-text"}


def until_stable(grafcet: sfc.Project, format: str) -> sfc.Project:
    """Return the project of a converted GRAFCET in which a program calls the chart until no step changes."""
    project = sfc.loads(sfc.convert(grafcet, format, limit=0).data)
    (block,) = project.pous
    name, chart, interface = block.name, block.chart, block.interface
    if chart is None or interface is None:
        raise SystemExit("it has no chart with variables")
    steps = [step.name for step in chart.steps]
    parts: dict[SectionKind, list[Variable]] = {SectionKind.INPUT: [], SectionKind.OUTPUT: [], SectionKind.LOCAL: []}
    for section in interface.sections:
        for variable in section.variables:  # one with an address is no parameter: its place is in the program
            areas = {"%I": SectionKind.INPUT, "%Q": SectionKind.OUTPUT}
            parts[areas.get((variable.address or "")[:2], section.kind)].append(variable)
    given, found, kept = parts.values()
    sections = interface.model_copy(deep=True).sections
    for section in sections:
        section.variables = [each for each in section.variables if each.name not in {v.name for v in kept}]
    kind = block.kind
    project.rename(name, f"{name}_Chart")
    block.kind = PouKind.FUNCTION_BLOCK
    block.interface = Interface(
        sections=[
            VariableSection(kind=kind, variables=[v.model_copy(update={"address": None}) for v in variables])
            for kind, variables in parts.items()
            if variables
        ]
    )
    own = [Variable(name="Chart", type=DerivedType(name=block.name))]
    own += [Variable(name=f"{step}_before", type=ElementaryType(name=Elementary.BOOL)) for step in steps]
    own += [Variable(name="calls", type=ElementaryType(name=Elementary.INT))]
    sections.append(VariableSection(kind=SectionKind.LOCAL, variables=own))
    active = "_X" if format == "codesys" else "X"  # in CODESYS X is what it was when the actions were executed
    lines = ["calls := 0;", "REPEAT"]
    lines += [f"    {step}_before := Chart.{step}.{active};" for step in steps]
    lines += [f"    Chart({', '.join(f'{v.name} := {v.name}' for v in given)});", "    calls := calls + 1;"]
    same = " AND ".join(f"{step}_before = Chart.{step}.{active}" for step in steps)
    lines += [f"UNTIL {same} OR calls >= {MOST_CALLS} END_REPEAT;"]
    lines += [f"{variable.name} := Chart.{variable.name};" for variable in found]
    body = StBody(text="\n".join(lines))
    caller = Pou(name=name, kind=kind, interface=Interface(sections=sections), bodies=[body])
    project.pous = [*project.pous, caller]
    return project


def main(plan: str, file: str) -> None:
    """Write the file, and print how the program compares with the GRAFCET."""
    grafcet, path = sfc.load(plan), Path(file)
    form = FORMATS[path.suffix.lower()]
    sfc.save(until_stable(grafcet, form), path, format=form)
    written = sfc.load(path)
    program = written.pous[-1]
    profiles = "grafcet", {"codesys": "codesys"}.get(form, "iec")
    names = {f"_{v.name}" if v.name[0].isdigit() else v.name: v.name for v in grafcet.pous[0].variables()}
    driven = {v.name for v in grafcet.pous[0].variables(SectionKind.OUTPUT)}
    outputs = {old: new for new, old in names.items() if old in driven}
    print(sfc.equivalent(grafcet, program, profiles, inputs=names, outputs=outputs, step_flags={}, limit=60))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
