"""What a chart says and its code does not: nothing of it is lost in silence."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.lowering.code.surroundings import names_of
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.network import CommentBox
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcFlag, SfcNetwork, Step
from plcopen_sfc.model.text import Text, plain
from plcopen_sfc.report import Fate, Item
from plcopen_sfc.semantics.charts.flags import flags_in_use
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.subjects import Subject


def losses(subject: Subject, lowered: Pou, profile: Profile) -> tuple[Item, ...]:
    """What charts hold that has no place in the code of `lowered`, or means nothing under the profile.

    They are the chart of `subject` and those of actions that were lowered with it.
    """
    found: list[Item] = []
    left = {action.name for action in lowered.actions if isinstance(action.body, SfcBody)}
    charts = {f"{subject.pou.name}.{a.name}": a.body for a in subject.pou.actions if a.name not in left}
    for name, body in (charts | {subject.name: subject.pou.body}).items():
        if isinstance(body, SfcBody):
            found += _Losses(subject, name, body.chart, profile).found()
    kept = {variable.name.casefold() for variable in lowered.variables()}
    for variable in subject.pou.variables():
        if variable.name.casefold() not in kept:
            path = f"POU {subject.pou.name} / variable {variable.name}"
            found.append(Item(Fate.DROPPED, "variable", path, "only a chart can have one of this type"))
    return tuple(found)


class _Losses:
    def __init__(self, subject: Subject, name: str, chart: SfcNetwork, profile: Profile) -> None:
        self._chart, self._profile = chart, profile
        self._place = subject.pou.report_path_of(name)
        net = Net.of(chart)
        self._paths = {id(each.step): each.path for each in net.steps} | {id(m.step): m.path for m in net.macros}
        declared = {*names_of(subject.project), *(variable.name.casefold() for variable in subject.pou.variables())}
        flags = flags_in_use(chart, profile, lambda name: name.casefold() in declared)
        self._watched = profile.maximum_times and SfcFlag.ERROR in flags

    def found(self) -> Iterator[Item]:
        """The losses of the chart and of those in it."""
        for chart in _charts(self._chart):
            for step in chart.steps:
                yield from self._of_step(step)
            for transition in chart.transitions:
                if transition.exclude:
                    path = f"transition {chart.label(transition)}"
                    yield self._dropped("transition", path, "it is excluded from the build")
            yield from self._of_drawing(chart)

    def _of_step(self, step: Step) -> Iterator[Item]:
        path = f"step {self._paths.get(id(step), step.name)}"
        if step.exclude:
            yield self._dropped("step", path, "it is excluded from the build")
            return
        unknown = f"the profile {self._profile.name} has no such times"
        if step.min_time and not self._profile.minimum_times:
            yield self._dropped("minimum time", path, f"{step.min_time}: {unknown}")
        if step.max_time and not (
            self._watched or self._profile.graph_parameters
        ):  # in S7-GRAPH it is data of the step
            why = "nothing asks for it: the chart does not use SFCError" if self._profile.maximum_times else unknown
            yield self._dropped("maximum time", path, f"{step.max_time}: {why}")
        for number, association in enumerate(step.actions, 1):
            action = f"{path} / action {association.target or number}"
            if association.exclude:
                yield self._dropped("action", action, "it is excluded from the build")
            elif association.indicator:
                yield self._dropped("indicator", action, f"{association.indicator} does not act on the chart")

    def _of_drawing(self, chart: SfcNetwork) -> Iterator[Item]:
        """Comments that stand in the drawing only."""
        boxes: list[Text | None] = [node.content for node in chart.logic if isinstance(node, CommentBox)]
        symbols = [symbol.comment for symbol in chart.drawing.symbols] if chart.drawing is not None else []
        for text in (chart.comment, *boxes, *symbols):
            said = " ".join(plain(text).split())
            if said:
                yield self._dropped("comment", "", f"{said!r} belongs to the drawing of the chart")

    def _dropped(self, what: str, path: str, why: str) -> Item:
        return Item(Fate.DROPPED, what, " / ".join(filter(None, [self._place, path])), why)


def _charts(chart: SfcNetwork) -> Iterator[SfcNetwork]:
    """A chart, those of its macro-steps, and its partial charts."""
    yield chart
    for partial in chart.partial_charts:
        yield from _charts(partial.network)
    for step in chart.steps:
        body = step.macro.body if step.macro is not None else None
        if isinstance(body, SfcBody):
            yield from _charts(body.chart)
