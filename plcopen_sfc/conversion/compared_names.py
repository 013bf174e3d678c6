"""Names of the same steps, inputs and variables in the source of a conversion and in its result, for runs of both."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from plcopen_sfc.conversion.executed_parts import HIDDEN_FLAG, OPERATING_INPUT
from plcopen_sfc.conversion.reporting import in_the_source
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.net import Net


def hidden_flags(report: ConversionReport, chart: Chart) -> set[str]:
    """Return the steps whose flags are FALSE in the result where others are active in their place."""
    paths = [ObjectPath.of(item.path) for item in report.items if item.what == HIDDEN_FLAG]
    return {path.last.removeprefix("step ") for path in paths if path.around == chart.report_path}


def step_names(there: Chart, here: Chart, called: Mapping[str, str], hidden: Collection[str]) -> dict[str, str] | None:
    """Return the steps of the result by those of the source but for `hidden` ones; None where all have their names."""
    net, other = Net.of(there.chart), Net.of(here.chart)
    paths = zip(other.steps, other.report_paths(here.report_path)[0], strict=True)
    result = {in_the_source(path, called): step.path for step, path in paths}
    own = zip(net.steps, net.report_paths(there.report_path)[0], strict=True)
    found = {step.path: (step.step.name, result[path]) for step, path in own if path in result}
    if not hidden and all(path == step for path, (_, step) in found.items()):
        return None
    return {path: step for path, (name, step) in found.items() if name not in hidden}


def renamed_variables(here: Pou, called: Mapping[str, str]) -> dict[str, str]:
    """Return the names in the source of variables that a POU of the result sees and that have others there."""
    own, shared = f"{here.report_path} / ", "global variable "
    found = {
        new.removeprefix(shared): old.removeprefix(shared) for new, old in called.items() if new.startswith(shared)
    }
    plain = [path.removeprefix(own) for path in called if path.startswith(own) and "step " not in path]
    external = {variable.name for variable in here.variables(SectionKind.EXTERNAL)}
    for variable in here.variables():  # which hides a tag
        if variable.name not in external:
            found.pop(variable.name, None)
    return found | {name: ObjectPath.of(called[own + name]).last for name in plain if " / " not in name}


def listed_variables(source: Project, result: Project) -> dict[str, str]:
    """Return the names in the source of global variables and data blocks in no list there, and in one of the result."""
    here, there = (
        [(each.name, variable.name) for each in project.global_sections() for variable in each.variables]
        for project in (source, result)
    )
    unlisted = {name.casefold(): name for of_list, name in here if not of_list}
    unlisted |= {block.name.casefold(): block.name for block in source.data_blocks}
    return {f"{of}.{name}": unlisted[name.casefold()] for of, name in there if of and name.casefold() in unlisted}


def kept_inside(pairs: Sequence[tuple[Chart, Chart | None]], called: Mapping[str, str]) -> dict[str, set[str]]:
    """Return the inputs of the source that are static variables in the result, by POUs of it: S7 writes no inputs.

    Nothing passes them: in both tools others write them between calls.
    """
    found: dict[str, set[str]] = {}
    for there, here in pairs:
        if here is not None:
            renamed = renamed_variables(here.pou, called)
            inputs = {each.name.casefold() for each in there.pou.variables(SectionKind.INPUT)}
            inside = {each.name for each in here.pou.variables(SectionKind.LOCAL)}
            found[here.pou.name] = {name for name in inside if renamed.get(name, name).casefold() in inputs}
    return {pou: names for pou, names in found.items() if names}


def executed_inputs(report: ConversionReport, chart: Chart) -> dict[str, str]:
    """Return the inputs that operate a chart of S7-GRAPH and are executed in the target; all others rest."""
    executed = [item for item in report.with_outcome(Outcome.TRANSLATED) if item.what == OPERATING_INPUT]
    paths = [ObjectPath.of(item.path) for item in executed]
    found = {path.last: path.last for path in paths if path.around == chart.report_path}
    enables = SfcFlag.ENABLE_LIMIT.variable
    is_asked = any((each.what, each.path) == (enables, chart.report_path) for each in report.items)
    if is_asked and any(each.name == enables for each in chart.pou.variables(SectionKind.INPUT)):
        found[enables] = enables
    return found
