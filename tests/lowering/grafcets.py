"""Common parts of the tests of lowering a GRAFCET."""

from __future__ import annotations

from plcopen_sfc import model as m


def pou_with(chart: m.SfcNetwork, inputs: str, outputs: str) -> m.Pou:
    """A function block with a chart; its variables are given as ``a n:INT``."""

    def section(kind: m.SectionKind, names: str) -> m.VariableSection:
        words = (name.partition(":") for name in names.split())
        return m.VariableSection(kind=kind, variables=[m.Variable(name=n, type=t or "BOOL") for n, _, t in words])

    sections = [section(m.SectionKind.INPUT, inputs), section(m.SectionKind.OUTPUT, outputs)]
    return m.Pou(
        name="Ablauf",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=sections),
        bodies=[m.SfcBody(chart=chart)],
    )
