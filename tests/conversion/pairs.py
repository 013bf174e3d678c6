"""Charts of two features each: what a report leaves out where one feature changes what another one does.

``python -m tests.conversion.pairs --pairs 300 --seed 1`` converts so many and prints the cells to look at.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from random import Random

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.formats.registry import format_named
from tests.conversion.features import FEATURES, Feature, FeatureChart, feature_project
from tests.conversion.matrix import CAUTIOUS, TARGETS, Cell, is_other, judge

_NAMES = re.compile(
    r"(?:\b|(?<=\\n))(Count|Clear|Inner|Ready|Wait|Note|Raise|One|Two|Other|Left|Right|Side|Last|Test|Sum|FB_Odd|counter|timer|"
    r'S5|text|limit|LIMIT|level|total|lamp|Lamp|E_Level|Low|High|GVL|Tags)\b(?!":)'
)
"""Names that features give: those of the first one get an A behind, but for keys of JSON."""


def paired(first: Feature, second: Feature) -> Feature:
    """The two features in one chart, in the formats that have both."""

    def build(rig: FeatureChart) -> None:
        first.build(rig)
        renamed = m.Project.model_validate_json(_NAMES.sub(r"\1A", rig.project.model_dump_json()))
        pou = renamed.pou("Main")
        _put(rig.chart, pou.chart)
        _put(rig.pou, pou)
        rig.pou.bodies = [m.SfcBody(chart=rig.chart)]
        _put(rig.project, renamed)
        rig.project.pous = [rig.pou if each.name == "Main" else each for each in renamed.pous]
        second.build(rig)
        assert rig.pou.interface is not None
        seen: set[str] = set()
        for section in rig.pou.interface.sections:
            section.variables = [v for v in section.variables if not (v.name in seen or seen.add(v.name))]  # type: ignore[func-returns-value]
        rig.pou.interface.sections = [section for section in rig.pou.interface.sections if section.variables]

    sources = tuple(source for source in first.sources if source in second.sources)
    return Feature(f"{first.name} + {second.name}", sources, build)


def _put(old: m.Element | m.Project, new: m.Element | m.Project) -> None:
    for name in type(new).model_fields:
        setattr(old, name, getattr(new, name))


def named(name: str) -> Feature:
    """A pair by its name."""
    by_name = {feature.name: feature for feature in FEATURES}
    first, second = name.split(" + ")
    return paired(by_name[first], by_name[second])


def cells(seed: int, count: int) -> Iterator[Cell]:
    """The cells of so many pairs, each of one of its formats, to all targets but SCL."""
    random = Random(seed)  # noqa: S311
    while count:
        pair = paired(*random.sample(FEATURES, 2))
        if not pair.sources or _contradict(pair):
            continue
        count -= 1
        source = random.choice(pair.sources)
        for target in (each for each in TARGETS if each != "scl" and is_other(source, each)):
            try:
                yield judge(pair, source, target)
            except sfc.SfcError:
                break  # the two contradict each other


def _contradict(pair: Feature) -> bool:
    """True if one feature takes away a step that a transition of the other one has."""
    try:
        chart = feature_project(pair, pair.sources[0]).pou("Main").chart
    except sfc.SfcError:  # a step that it needs is gone
        return True
    steps = {step.id for step in chart.steps}
    return any(not steps.issuperset((*each.sources, *each.targets)) for each in chart.transitions)


def is_silent(cell: Cell) -> bool:
    """True if the report says that all is executed, and running both shows that it is not."""
    return cell.reported == "executed" and not cell.runs_the_same


def is_told_by_a_run(cell: Cell) -> bool:
    """True if the report of a conversion that runs the chart, as those of the command do, tells a loss."""
    original = feature_project(named(cell.feature), cell.source)
    read = sfc.loads(sfc.dumps(original, format=cell.source, partial=True), format=cell.source)
    target = "codesys" if cell.target == "twincat" else cell.target  # whose files hold one object
    return bool(sfc.convert(read, target, partial=True, limit=10).report.losses)


def is_cautious(cell: Cell) -> bool:
    """True if both run the same, and the report says less."""
    known = any((name, format_named(cell.target)[0].name) in CAUTIOUS for name in cell.feature.split(" + "))
    return cell.runs_the_same and cell.reported not in ("executed", "refused") and not known


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    every = list(cells(given.seed, given.pairs))
    silent = [cell for cell in every if is_silent(cell)]
    cautious = [f"cautious: {c.feature}, {c.source} to {c.target}: {c.why}" for c in every if is_cautious(c)]
    told = [f"{'told by a run' if is_told_by_a_run(cell) else 'SILENT'}: {cell}" for cell in silent]
    sys.stdout.write("\n".join([*told, *cautious, f"{len(every)} cells, {len(silent)} silent without a run", ""]))
    sys.stdout.write(f"{len(cautious)} reported as lost or approximated, and the same in the run\n")
