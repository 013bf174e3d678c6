"""Anchors and cross references of a page: where each object of a project is in it, and what names it.

Program text becomes HTML in which every name that means an object of the page is a link to it, and each object knows
the places that name it.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from plcopen_sfc.drawing.pictures import ChartPart, charts_in, part_prefix
from plcopen_sfc.drawing.wording import Told, english
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.binding.text_sites import SiteKind
from plcopen_sfc.languages.networks.network_graph import wires_of
from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.network import Node
from plcopen_sfc.model.pou import Method, NamedBody, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork, Step, Transition
from plcopen_sfc.model.types import StructType, Variable
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.pages.html_text import Html, joined, link


class DrawnPart(NamedTuple):
    """A chart of a picture, and what the ids of its elements begin with. `path` is that of the whole chart.

    `anchor` is that of its frame in the picture, empty for the whole chart; `drawn` has the text of the frame.
    """

    chart: SfcNetwork
    prefix: str
    path: str
    anchor: str
    drawn: ChartPart


class PlacedBody(NamedTuple):
    """A body of a POU, its anchor, and its place in the words of reports: ``POU Main / action Fill``."""

    found: NamedBody
    anchor: str
    path: str


_OF_ACTIONS = ("target", "value", "duration", "indicator", "entry_action", "main_action", "exit_action")
_TEXTS = ("text", "name", "expression", "instance", *_OF_ACTIONS)
"""The fields of conditions and what is drawn before them, associations, steps and bodies that pictures show."""


def row_anchor(anchor: str) -> str:
    """Return the anchor of where a table tells of the step or transition at an anchor of a picture."""
    return f"{anchor}-row"


def _before(transition: Transition, nodes: Mapping[int, Node]) -> list[Node]:
    """Return the elements drawn in a chart that the condition of a transition depends on."""
    condition = transition.condition
    wires = list(condition.input.connections) if isinstance(condition, WiredCondition) else []
    found: dict[int, Node] = {}
    for wire in wires:  # grows
        node = nodes.get(wire.source)
        if node is not None and node.id not in found:
            found[node.id] = node
            wires += wires_of(node)
    return list(found.values())


class PageIndex:
    """Anchors of the objects of a project. `prefix` begins them where a page has several projects.

    `called`: paths of objects that are looked for under another one, as they have been renamed. `told` gives the words
    of headings.
    """

    def __init__(
        self,
        project: Project,
        prefix: str = "",
        *,
        called: Mapping[str, str] = MappingProxyType({}),
        references: bool = True,
        told: Told = english,
    ) -> None:
        project.read_all()
        self.project = project
        self.prefix = prefix
        self._called, self._told = called, told
        self.bodies: dict[int, list[PlacedBody]] = {}
        self.parts: dict[str, list[DrawnPart]] = {}
        self._executed: dict[str, dict[tuple[str, str], list[str]]] = {}
        self._anchors: dict[int, str] = {}
        self._paths: dict[str, str] = {}
        self._links: dict[tuple[int, str | int], list[tuple[int, int, str]]] = {}
        self._uses: dict[str, dict[str, None]] = {}
        self._before: dict[int, list[Node]] = {}
        """The elements that are drawn before the condition of each transition."""
        self._fed: dict[int, list[str]] = {}
        """The paths of the transitions whose conditions each of these elements feeds."""
        for number, pou in enumerate(project.pous):
            self._place_pou(pou, f"{prefix}pou-{number}")
        self._place_others()
        if references:
            self._find_references()

    def anchor(self, thing: Any) -> str:
        """Return the anchor of an object; empty where the page does not show it."""
        return self._anchors.get(id(thing), "")

    def anchor_at(self, path: str) -> str:
        """Return the anchor of the object at a path of a report, or of the nearest one around it; empty: none."""
        outwards = ObjectPath.of(path).outwards()
        return next((self._paths[each] for each in outwards if each in self._paths), "")

    def as_called(self, path: str) -> str:
        """Return the path under which an object is looked for."""
        if not self._called:
            return path
        around, result = "", ""
        for part in ObjectPath.of(path).parts:
            around = f"{around} / {part}" if around else part
            result = self._called.get(around, f"{result} / {part}" if result else part)
        return result

    def step_anchor(self, chart: str, path: str) -> str:
        """Return the anchor of a step by its path in a trace of the POU or action called `chart`; empty: none."""
        return next(iter(self.anchors_of(chart, "step", path)), "")

    def anchors_of(self, chart: str, kind: str, name: str) -> list[str]:
        """Return the anchors of the steps, or transitions, of a POU or action that a verdict calls `name`."""
        known = self._executed.get(chart.casefold(), {})
        words = name.split(".")  # G1.M1.E1: of a macro-step in a partial chart
        shorter = ((kind, ".".join(words[start:])) for start in range(len(words)))
        return next((known[each] for each in shorter if each in known), [])

    def chart_anchors(self, step: Step) -> list[str]:
        """Return the anchors of the charts inside a macro-step and an enclosing step; empty ones for missing charts."""
        own = step.macro.body if step.macro is not None else None
        names = [] if step.macro is None or isinstance(own, SfcBody) else [step.macro.expansion or ""]
        names += [each.chart for each in step.encloses or ()]
        inside = [self.anchor(own.chart)] if isinstance(own, SfcBody) else []
        here = self.anchor(step) if names else ""
        parts = [part for prefix, parts in self.parts.items() if here.startswith(prefix) for part in parts]
        by_name = {part.drawn.name.casefold(): part.anchor for part in reversed(parts)}
        return inside + [by_name.get(name.casefold(), "") for name in names]

    def linked(self, holder: Any, key: str) -> Html:
        """Return the text in the field `key` of `holder`, with links for the names in it."""
        text: str = getattr(holder, key) or ""
        pieces: list[str] = []
        done = 0
        for start, end, anchor in sorted(self._links.get((id(holder), key), ())):
            if start >= done:
                pieces += [text[done:start], link(anchor, text[start:end])]
                done = end
        return joined(*pieces, text[done:])

    def names(self, prefix: str) -> dict[str, dict[str, str]]:
        """Return the names in the texts of each step and transition of a chart, in lower case, with their anchors.

        Their own names, which are empty there, lead to where tables tell of them.
        """
        found: dict[str, dict[str, str]] = {}
        for part in self.parts[prefix]:
            for transition in part.chart.transitions:
                found[self.anchor(transition)] = self._named(transition) | self._names_in(
                    transition.condition, *self._before[id(transition)]
                )
            for step in part.chart.steps:
                told = [each for row in step.actions for each in (row, row.condition, row.body)]
                actions = step.step_actions.values()
                found[self.anchor(step)] = self._named(step) | self._names_in(
                    step, *told, *actions, *step.conditions.values()
                )
        return found

    def _named(self, thing: Step | Transition) -> dict[str, str]:
        return {"": row_anchor(self.anchor(thing))}

    def _names_in(self, *holders: Any) -> dict[str, str]:
        found: dict[str, str] = {}
        for holder in holders:
            for key in _TEXTS:
                for start, end, anchor in self._links.get((id(holder), key), ()):
                    found.setdefault(getattr(holder, key)[start:end].strip('"#').casefold(), anchor)
        return found

    def uses(self, anchor: str) -> list[str]:
        """Return the paths of the places that name the object at an anchor."""
        return list(self._uses.get(anchor, ()))

    def _place(self, thing: Any, anchor: str, path: str) -> None:
        self._anchors[id(thing)] = anchor
        self._paths.setdefault(self.as_called(path), anchor)

    def _place_pou(self, pou: Pou, anchor: str) -> None:
        self._place(pou, anchor, pou.report_path)
        self._place_variables(pou.variables(), anchor, pou.report_path)
        owners = {f"{pou.name}.{part.name}": part for part in pou.parts}
        placed = self.bodies.setdefault(id(pou), [])
        for number, found in enumerate(pou.named_bodies()):
            place, path = f"{anchor}-body-{number}", pou.report_path_of(found.name)
            placed.append(PlacedBody(found, place, path))
            self._place(found.body, place, path)
            owner = owners.get(found.name)
            if owner is not None:
                self._anchors[id(owner)] = place
            if isinstance(owner, Method) and owner.interface is not None:
                self._place_variables(owner.interface.variables(), place, path)
            if isinstance(found.body, SfcBody):
                self._place_chart(found.body.chart, f"{place}-", path)
                self._executed.setdefault(found.name.casefold(), self._called_when_executed(self.parts[f"{place}-"]))

    def _place_chart(self, chart: SfcNetwork, prefix: str, path: str) -> None:
        drawn = self.parts.setdefault(prefix, [])
        for number, part in enumerate(charts_in(chart, self._told)):
            begin = prefix + part_prefix(number)
            anchor, around = (begin.removesuffix("-") if number else ""), ObjectPath(path, *part.place.parts)
            drawn.append(DrawnPart(part.chart, begin, path, anchor, part))
            if number:
                self._anchors[id(part.chart)] = anchor
            if part.partial is not None:
                self._place(part.partial, anchor, around)
            steps = {step.id: self.as_called(f"{around} / step {step.name}") for step in part.chart.steps}
            labels = part.chart.labels({number: name.rpartition(" / step ")[2] for number, name in steps.items()})
            for step in part.chart.steps:
                self._place(step, f"{begin}step-{step.id}", f"{around} / step {step.name}")
            nodes = {node.id: node for node in part.chart.logic}
            for transition in part.chart.transitions:
                place = f"{around} / transition {labels[transition.id]}"
                self._place(transition, f"{begin}transition-{transition.id}", place)
                self._before[id(transition)] = _before(transition, nodes)
                for node in self._before[id(transition)]:
                    self._fed.setdefault(id(node), []).append(place)

    def _called_when_executed(self, parts: list[DrawnPart]) -> dict[tuple[str, str], list[str]]:
        """Return the anchors of steps and transitions by kind and name in traces and verdicts.

        There the name of a partial chart, or of a macro-step, is before them: ``G1.1``, ``M1.E1``.
        """
        macros = grouped(
            ((step.macro.expansion or "").casefold(), step.name)
            for step in (step for part in parts for step in part.chart.steps)
            if step.macro is not None
        )
        found: dict[tuple[str, str], list[str]] = {}
        alone: dict[tuple[str, str], list[str]] = {}
        for part in parts:
            own = part.drawn.around.name if part.drawn.around is not None else part.drawn.name
            owners = dict.fromkeys([own, *macros.get(part.drawn.name.casefold(), ())]) if own else {}
            labels = part.chart.labels()
            names: list[tuple[Step | Transition, tuple[str, str]]] = [(s, ("step", s.name)) for s in part.chart.steps]
            names += [(each, ("transition", labels[each.id])) for each in part.chart.transitions]
            for thing, (kind, name) in names:
                for key in [(kind, f"{owner}.{name}") for owner in owners] or [(kind, name)]:
                    found.setdefault(key, []).append(self.anchor(thing))
                alone.setdefault((kind, name), [self.anchor(thing)])
        return alone | found

    def _place_variables(self, variables: list[Variable], anchor: str, path: str) -> None:
        for number, variable in enumerate(variables):
            self._place(variable, f"{anchor}-variable-{number}", f"{path} / {variable.name}")

    def _place_others(self) -> None:
        project = self.project
        for number, section in enumerate(project.global_sections()):
            anchor, path = f"{self.prefix}globals-{number}", section.name or ""
            self._place(section, anchor, path)
            self._place_variables(section.variables, anchor, path)
        for number, declaration in enumerate(project.data_types):
            self._place(declaration, f"{self.prefix}type-{number}", declaration.report_path)
            if isinstance(declaration.type, StructType):
                for member in declaration.type.members:
                    self._anchors[id(member)] = f"{self.prefix}type-{number}"
        for number, block in enumerate(project.data_blocks):
            anchor = f"{self.prefix}block-{number}"
            self._place(block, anchor, block.report_path)
            self._place_variables(block.interface.variables() if block.interface else [], anchor, block.report_path)
        for number, table in enumerate(project.tag_tables):
            anchor = f"{self.prefix}tags-{number}"
            self._place(table, anchor, table.report_path)
            self._place_variables(table.constants, anchor, table.report_path)
            for position, tag in enumerate(table.tags):
                self._place(tag, f"{anchor}-tag-{position}", f"{table.report_path} / {tag.name}")

    def _find_references(self) -> None:
        names = Names(self.project)
        for occurrence in names.everything:
            site, declaration = occurrence.text_site, occurrence.meaning.declaration
            if declaration is None or site.reading in (SiteKind.FOREIGN, SiteKind.DECLARATIONS):
                continue
            anchor = next(filter(None, map(self.anchor, names.resolver.original(declaration).holders)), "")
            if anchor and site.path != "project tree":
                start, end = occurrence.reference.span
                self._links.setdefault((id(site.holder), site.key), []).append((start, end, anchor))
                fed = self._fed.get(id(site.owner)) or self._fed.get(id(site.holder)) or [site.report_path or site.path]
                self._uses.setdefault(anchor, {}).update(dict.fromkeys(fed))
