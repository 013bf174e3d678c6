"""Steps of a chart as cells of tables: times, supervision, actions with their program text, transitions that leave."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from plcopen_sfc.drawing.pictures import body_figure
from plcopen_sfc.drawing.wording import Wording
from plcopen_sfc.languages.networks import shown_body
from plcopen_sfc.model import sfc
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.text import plain
from plcopen_sfc.pages.html_text import Html, element, joined, link, picture_figure
from plcopen_sfc.pages.page_index import PageIndex, row_anchor
from plcopen_sfc.pages.page_words import Words


class Bodies:
    """Bodies of a project: program text with links, networks as pictures."""

    def __init__(self, index: PageIndex, words: Words) -> None:
        self._index, self._words = index, words
        self._drawn = 0

    def content(self, body: sfc.Body | None) -> Html:
        """Return a body; nothing for a chart, which has a section of its own."""
        if isinstance(body, StBody | IlBody):
            return element("pre", element("code", self._index.linked(body, "text"))) if body.text else Html("")
        if isinstance(body, FbdBody | LdBody):
            text = shown_body(body, self._index.project.dialect)
            as_text = element("details", element("summary", "ST"), element("pre", element("code", text or "")))
            figure = self.networks(body)
            return joined(figure, as_text) if text else figure
        if isinstance(body, OpaqueBody):
            note = self._words("a body in a form that is kept but not read")
            return element("details", element("summary", note), element("pre", body.content))
        return Html("")

    def networks(self, body: FbdBody | LdBody) -> Html:
        """Return the picture of networks."""
        self._drawn += 1
        picture = body_figure(body, f"{self._index.prefix}drawn-{self._drawn}-", self._words)
        return picture_figure(picture, self._words)


class StepCells:
    """The steps of one chart; `heading` is that of its frame, empty for a whole chart.

    `told` is what is told about the element at an anchor, such as findings. `pou`: the table is beside another one, and
    all that can be compared is text: drawn conditions too, and the actions of this POU at the steps that name them.
    """

    def __init__(
        self,
        chart: sfc.SfcNetwork,
        index: PageIndex,
        bodies: Bodies,
        words: Words,
        *,
        told: Callable[[str], Html] = lambda _: Html(""),
        pou: Pou | None = None,
        heading: str = "",
    ) -> None:
        self.chart, self.words, self.heading = chart, words, heading
        self._index, self._bodies, self._told, self._pou = index, bodies, told, pou
        self._wording = Wording(chart, index.project.dialect, words)
        self._steps = {step.id: step for step in chart.steps}
        self._leaving = sfc.leaving_steps(chart.transitions)

    def name(self, step: sfc.Step) -> Iterator[Html]:
        """Yield the name of a step as a link to its picture, its times, and its conditions that supervise it."""
        number = [element("small", str(step.number)), " "] if step.number is not None else []
        yield link(self._index.anchor(step), *number, step.name)
        yield self._excluded(step)
        times = (("minimum time", "min_time"), ("maximum time", "max_time"), ("warning time", "warning_time"))
        for label, key in times:
            if getattr(step, key):
                yield element("div", f"{self.words(label)} ", self._index.linked(step, key))
        for label, part in (("interlock", step.interlock), ("supervision", step.supervision)):
            if part is not None and part.condition is not None:
                told = element("div", f"{self.words(label)} ", self._condition(part.condition))
                yield joined(told, comment_lines(part.title, part.alarm))
        yield comment_lines(step.title, step.comment)

    def actions(self, step: sfc.Step) -> Html:
        """Return the list of the actions of a step."""
        items = [element("li", each) for each in self._actions(step)]
        return element("ul", *items) if items else Html("")

    def leaving(self, step: sfc.Step | None) -> Html:
        """Return the list of the transitions that leave a step; None: of those that have no source."""
        if step is not None:
            leaving: Sequence[sfc.Transition] = self._leaving.get(step.id, [])
        else:
            leaving = [each for each in self.chart.transitions if self._steps.keys().isdisjoint(each.sources)]
        ordered = sfc.by_priority(leaving)
        many = len(leaving) > 1 and step is not None
        items = [
            element("li", self._transition(each, step, many=many), id=self._row(each, step), data_name=each.name)
            for each in ordered
        ]
        return element("ul", *items) if items else Html("")

    def row(self, step: sfc.Step) -> str:
        """Return the anchor of the row of a step."""
        return row_anchor(self._index.anchor(step))

    def _row(self, transition: sfc.Transition, step: sfc.Step | None) -> str:
        """Return the anchor of a transition where it is told of first: at the first step that it waits for."""
        first = next((each for each in transition.sources if each in self._steps), None)
        return row_anchor(self._index.anchor(transition)) if first == (step.id if step is not None else None) else ""

    def permanent(self) -> Html:
        """Return the permanent instructions of the chart."""
        permanent = self.chart.permanent
        items = [element("li", comment_lines(each.title), self._bodies.content(each.body)) for each in permanent]
        return joined(element("h4", self.words("Permanent instructions")), element("ul", *items)) if items else Html("")

    def _excluded(self, thing: sfc.Step | sfc.Transition | sfc.ActionAssociation) -> Html:
        return joined(" ", element("em", self.words("excluded"))) if thing.exclude else Html("")

    def _actions(self, step: sfc.Step) -> Iterator[Html]:
        for label, action in step.step_actions.items():
            if isinstance(action, str) and action:
                text, linked = self._text_of(action), self._index.linked(step, f"{label}_action")
                yield joined(element("b", self.words(label)), " ", linked, text)
            elif action:
                yield joined(element("b", self.words(label)), " ", self._bodies.content(action))
        for association in step.actions:
            yield self._association(association)
        names = (self.words("macro"), self.words("encloses"))
        inside = [line for line in self._wording.actions(step) if line.qualifier in names]
        for line, anchor in zip(inside, self._index.chart_anchors(step), strict=True):
            name = line.what or self.words("chart")
            yield joined(element("b", line.qualifier), " ", link(anchor, name) if anchor else name)

    def _association(self, association: sfc.ActionAssociation) -> Html:
        line = self._wording.association(association)
        when = " ".join(filter(None, (line.interlock, line.event, line.qualifier, line.duration)))
        parts: list[str] = [element("b", when), " "] if when else []
        if association.target and association.forcing is None:
            parts += ["NOT " if association.negated else "", self._index.linked(association, "target")]
            if association.value is not None:
                parts += [" := ", self._index.linked(association, "value")]
        elif association.body is not None and not isinstance(association.body, sfc.SfcBody):
            parts.append(self._bodies.content(association.body))
        else:
            parts.append(line.what)
        if association.condition is not None:
            parts += [" [", self._condition(association.condition), "]"]
        if association.indicator:
            parts += [" (", self._index.linked(association, "indicator"), ")"]
        text = self._text_of(association.target or "")
        return joined(*parts, self._excluded(association), comment_lines(association.comment), text)

    def _text_of(self, name: str) -> Html:
        action = self._pou.find_action(name) if self._pou is not None and name else None
        return self._bodies.content(action.body) if action is not None else Html("")

    def _transition(self, transition: sfc.Transition, step: sfc.Step | None, *, many: bool) -> Html:
        anchor, names = self._index.anchor(transition), self._steps
        condition = self._condition(transition.condition)
        others = [names[each].name for each in transition.sources if each in names and names[each] is not step]
        together = f" ({self.words('after {} too', ', '.join(dict.fromkeys(others)))})" if others else ""
        targets: list[str] = []
        for target in transition.targets:
            step = names.get(target)
            if step is not None:
                targets += [" \u2192 " if not targets else ", ", link(self._index.anchor(step), step.name)]
        number = f"{transition.number} " if transition.number is not None else ""
        head = link(anchor, f"{number}{transition.name}".strip() or "\u22a2")
        order = f" ({self.words('priority {}', transition.priority)})" if many and transition.priority else ""
        return joined(
            *(head, self._excluded(transition), f"{order}{together} ", condition, *targets),
            *(comment_lines(transition.comment), self._told(anchor)),
        )

    def _condition(self, condition: sfc.Condition | None) -> Html:
        if isinstance(condition, Expression | NamedCondition):
            text = self._index.linked(condition, "text" if isinstance(condition, Expression) else "name")
            return element("code", *(["NOT (", text, ")"] if condition.negated else [text]))
        told = self._wording.condition(condition)
        text = element("code", told) if told else element("em", self.words("condition missing"))
        body = condition.body if isinstance(condition, sfc.BodyCondition) else None
        if isinstance(body, FbdBody | LdBody) and self._pou is None:
            drawn = element("details", element("summary", body.language), self._bodies.networks(body))
            return joined(text, drawn)
        return text


def steps_side_by_side(
    one: Sequence[StepCells], other: Sequence[StepCells], same: Mapping[int, sfc.Step], captions: Sequence[str]
) -> Html:
    """Return the table of the steps of two pictures, each with its actions and the transitions that leave it.

    `one` and `other` are the charts of each picture, the whole chart first. `same` has the steps of the second picture
    for those of the first, by their `id`; those that only it has are the last.
    """
    rest = {id(step): (cells, step) for cells in other for step in cells.chart.steps}
    rows = [element("tr", *(element("td", each.permanent()) for each in (one[0], other[0])))]
    rows = rows if any(each.permanent() for each in (one[0], other[0])) else []
    for cells in one:
        if cells.heading:
            rows.append(element("tr", element("th", cells.heading, colspan="2")))
        for step in cells.chart.steps:
            found = rest.pop(id(same.get(id(step))), None)
            rows.append(element("tr", _step_cell((cells, step)), _step_cell(found)))
        if sources := cells.leaving(None):
            told = element("div", cells.words("Source transitions"), class_="name")
            rows.append(element("tr", element("td", told, sources), _step_cell(None)))
    rows += [element("tr", _step_cell(None), _step_cell(found)) for found in rest.values()]
    head = element("thead", element("tr", *(element("th", caption) for caption in captions)))
    return element("div", element("table", head, element("tbody", *rows), class_="side"), class_="scroll")


def _step_cell(found: tuple[StepCells, sfc.Step] | None) -> Html:
    if found is None:
        return element("td", "\u2013", class_="comment")
    cells, step = found
    name = element("div", *cells.name(step), class_="name")
    return element("td", name, cells.actions(step), cells.leaving(step), id=cells.row(step))


def comment_lines(*texts: object) -> Html:
    """Return titles and comments, each as a line of its own."""
    told = [plain(text) for text in texts]  # type: ignore[arg-type]  # titles and comments, which may be None
    return joined(*(element("div", text, class_="comment") for text in told if text))
