"""Charts as texts for programs that draw graphs: Mermaid and Graphviz.

Steps and transitions are nodes, as in a Petri net: so simultaneous branches, which have no symbol of their own there,
are several edges of a transition. The places are those of the program that draws.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from plcopen_sfc.drawing.pictures.chart_picture import ChartPart, charts_in
from plcopen_sfc.drawing.wording import EXCLUDED, Wording
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition


def mermaid_text(chart: SfcNetwork) -> str:
    """Return `chart` as a flowchart of Mermaid. Initial steps have double sides, transitions are round.

    Elements excluded from the program are marked by a text and dashed.
    """
    lines = ["flowchart TD"]
    for graph in _graphs(chart):
        inside = bool(graph.part.heading)
        if inside:
            lines.append(f'    subgraph {graph.prefix}chart["{_mermaid(graph.headings())}"]')
            lines.append("    direction TB")
        for node, texts, thing in graph.nodes():
            begin, end = (
                ("([", "])") if isinstance(thing, Transition) else ("[[", "]]") if thing.initial else ("[", "]")
            )
            lines.append(f'    {node}{begin}"{_mermaid(texts)}"{end}')
            if thing.exclude:
                lines.append(f"    style {node} stroke-dasharray:4")
        lines += [f"    {source} --> {target}" for source, target in graph.edges()]
        lines += ["    end"] * inside
    return "\n".join(lines) + "\n"


def dot_text(chart: SfcNetwork) -> str:
    """Return `chart` as a graph of Graphviz (``dot``). Initial steps have two frames, transitions none."""
    lines = ["digraph chart {", '    graph [fontname="Arial", fontsize=12]']
    lines += ['    node [fontname="Arial", fontsize=11]', "    edge [arrowsize=0.6]"]
    for graph in _graphs(chart):
        inside = bool(graph.part.heading)
        if inside:
            lines.append(f"    subgraph cluster_{graph.prefix} {{ label={_dot(graph.headings())}; style=dashed")
        for node, texts, thing in graph.nodes():
            shape = "plaintext" if isinstance(thing, Transition) else "box, peripheries=2" if thing.initial else "box"
            dashed = ", style=dashed" if thing.exclude else ""
            lines.append(f"    {node} [label={_dot(texts)}, shape={shape}{dashed}]")
        lines += [f"    {source} -> {target}" for source, target in graph.edges()]
        lines += ["    }"] * inside
    return "\n".join([*lines, "}"]) + "\n"


@dataclass(frozen=True, slots=True)
class _Graph:
    """One of the charts of a picture. `prefix` begins the names of its nodes."""

    part: ChartPart
    prefix: str
    words: Wording

    def headings(self) -> list[str]:
        """Return the heading of the chart, and the comment of a partial chart."""
        return [self.part.heading, *([self.part.comment] if self.part.comment else [])]

    def nodes(self) -> Iterator[tuple[str, list[str], Step | Transition]]:
        """Yield the nodes: the name, lines of text, and the step or transition."""
        for step in self.part.chart.steps:
            name = f"{step.name} {EXCLUDED}" if step.exclude else step.name
            yield self._step(step.id), [name, *map(str, self.words.actions(step))], step
        for transition in self.part.chart.transitions:
            condition = self.words.condition(transition.condition) or "(no condition)"
            texts = [condition]
            if transition.name:
                texts.insert(0, transition.name)
            if transition.priority is not None:
                texts[0] = f"{transition.priority}: {texts[0]}"
            if transition.exclude:
                texts.append(EXCLUDED)
            yield self._transition(transition), texts, transition

    def edges(self) -> Iterator[tuple[str, str]]:
        """Yield the nodes that are joined."""
        known = {step.id for step in self.part.chart.steps}
        for transition in self.part.chart.transitions:
            node = self._transition(transition)
            yield from ((self._step(i), node) for i in dict.fromkeys(transition.sources) if i in known)
            yield from ((node, self._step(i)) for i in dict.fromkeys(transition.targets) if i in known)

    def _step(self, number: int) -> str:
        return f"{self.prefix}step{number}"

    def _transition(self, transition: Transition) -> str:
        return f"{self.prefix}transition{transition.id}"


def _graphs(chart: SfcNetwork) -> Iterator[_Graph]:
    dialect = chart.project.dialect if chart.project is not None else Dialect.IEC
    for number, part in enumerate(charts_in(chart)):
        yield _Graph(part, f"part{number}_" if number else "", Wording(part.chart, dialect))


_PLAIN_TO_MERMAID = re.compile(r"[^\w :=(),]|(?<=\d)\.(?= )", re.ASCII)


def _mermaid(texts: list[str]) -> str:
    """Return lines of a label: what Mermaid takes for markup, and all that could be, are its codes of characters."""
    return "<br>".join(_PLAIN_TO_MERMAID.sub(lambda sign: f"#{ord(sign[0])};", " ".join(t.split())) for t in texts)


def _dot(texts: list[str]) -> str:
    """Return a quoted label of lines."""
    lines = [" ".join(text.split()).replace("\\", "\\\\").replace('"', '\\"') for text in texts]
    lines = [line.replace("&", "&amp;") for line in lines]  # Graphviz reads the entities of HTML
    return '"' + "\\n".join(re.sub("[\x00-\x1f\x7f\ud800-\udfff]", "\ufffd", line) for line in lines) + '"'
