"""What TC6 makes of a project of another tool, before it is written."""

from __future__ import annotations

from plcopen_sfc.formats.base import WriteOptions
from plcopen_sfc.model.body import FbdBody
from plcopen_sfc.model.conditions import BodyCondition
from plcopen_sfc.model.network import Coil, Node, OutputVariable
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Fate


def adapt(project: Project, options: WriteOptions, report: ConversionReport) -> None:
    """Write coils of FBD, which TIA Portal draws there, as output variables: TC6 knows coils in LD only."""
    if options.same:
        return
    bodies = [(pou.report_path_of(name), body) for name, pou, body in project.bodies()]
    for chart in project.charts():
        conditions = (transition.condition for transition in chart.network.transitions)
        bodies += [
            (chart.report_path, condition.body) for condition in conditions if isinstance(condition, BodyCondition)
        ]
    for place, body in bodies:
        if not isinstance(body, FbdBody):
            continue
        for network in body.networks:
            coils = sum(isinstance(node, Coil) for node in network.nodes)
            if coils:
                network.nodes = [_output(node) for node in network.nodes]
                report.add(Fate.TRANSLATED, "coil", place, "an output variable: FBD of TC6 has no coils")


def _output(node: Node) -> Node:
    if not isinstance(node, Coil):
        return node
    shared = {field: getattr(node, field) for field in Coil.model_fields if field in OutputVariable.model_fields}
    return OutputVariable.model_validate({**shared, "kind": "output", "expression": node.variable})
