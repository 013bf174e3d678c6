"""The format `outline`: a line for each step, with the steps that follow it (``Fill -> Mix, Idle``)."""

from __future__ import annotations

from plcopen_sfc.formats.format_interface import Codec, FileHead, Format, ReadResult, WriteOptions
from plcopen_sfc.model import Pou, PouKind, Project, SfcBody, SfcNetwork
from plcopen_sfc.report import ConversionReport, Outcome

_HEAD = "OUTLINE OF "


class OutlineCodec(Codec):
    """Reads and writes outlines."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read an outline."""
        head, *lines = data.decode().splitlines()
        chart = SfcNetwork()
        sides = [line.partition(" -> ") for line in lines]
        for at, (name, _, _) in enumerate(sides):
            chart.add_step(name, initial=at == 0)
        for name, _, followers in sides:
            for follower in filter(None, followers.split(", ")):
                chart.add_transition(name, follower, "TRUE")
        pou = Pou(name=head.removeprefix(_HEAD), kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])
        return ReadResult(Project(pous=[pou]), [])

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write the chart of the first POU that has one; what differs when it is read again is reported as dropped."""
        pou = next(each for each in project.pous if each.chart is not None)
        chart = pou.chart or SfcNetwork()
        names = {step.id: step.name for step in chart.steps}
        lines = [_HEAD + pou.name]
        for step in chart.steps:
            report.add(Outcome.KEPT, "step", f"{pou.report_path} / step {step.name}")
            lines.append(f"{step.name} -> {', '.join(names[t] for each in chart.outgoing(step) for t in each.targets)}")
        return "\n".join([*lines, ""]).encode()


def _is_outline(head: FileHead) -> bool:
    return head.text.startswith(_HEAD)


CODEC = OutlineCodec()
FORMAT = Format(
    name="outline",
    title="outline of a chart",
    tool="",
    module="plant_rules.outline",
    extensions=(".outline",),
    recognises=_is_outline,
    ids=False,
)
