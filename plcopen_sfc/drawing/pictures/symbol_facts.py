"""Common facts of the symbols of one chart: its style, its words, the names of what symbols refer to."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from plcopen_sfc.drawing.pictures.svg_canvas import wrap
from plcopen_sfc.drawing.wording import Wording
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition

NAME_WIDTH = 210
_TEXT_WIDTH, _NARROW = 230, 170
"""Texts of actions and conditions are wrapped at this width; in a narrow picture at the second."""


class PictureStyle(StrEnum):
    """Style of symbols: as in IEC 61131-3, as in IEC 60848 (GRAFCET), or as in TIA Portal (S7-GRAPH)."""

    IEC = "iec"
    GRAFCET = "grafcet"
    S7GRAPH = "s7graph"


@dataclass(frozen=True, slots=True)
class LinkEnd:
    """The other end of a link that is not drawn as a wire: its name, and the id of its element in the picture."""

    name: str
    element: str

    @property
    def lines(self) -> list[str]:
        """Its name, wrapped."""
        return wrap(self.name, 11, NAME_WIDTH) or [""]


@dataclass(slots=True)
class PictureSheet:
    """Common facts of symbols of one chart.

    `prefix` begins the ids of its elements, `activated` are starred steps. `narrow`: the picture is set beside another
    one. `in_turn`: competing transitions are tried one after the other. `room`: how much longer the wire above a step
    is, by its id. `frames` are the ids of the frames of partial charts, by their names in lower case.
    """

    chart: SfcNetwork
    style: PictureStyle
    words: Wording
    prefix: str = ""
    activated: frozenset[str] = frozenset()
    narrow: bool = False
    in_turn: bool = False
    room: Mapping[int, int] = field(default_factory=dict)
    frames: Mapping[str, str] = field(default_factory=dict)
    _drawn: Counter[str] = field(default_factory=Counter, init=False)
    steps: dict[int, Step] = field(init=False)
    transitions: dict[int, Transition] = field(init=False)
    labels: dict[int, str] = field(init=False)

    def __post_init__(self) -> None:
        self.steps = {step.id: step for step in self.chart.steps}
        self.transitions = {transition.id: transition for transition in self.chart.transitions}
        self.labels = self.chart.labels()

    def next_id(self, kind: str) -> str:
        """Return the id of an element that the model does not number: a jump, or a reference of one."""
        self._drawn[kind] += 1
        return f"{self.prefix}{kind}-{self._drawn[kind]}"

    @property
    def stars(self) -> bool:
        """True if an asterisk tells that competing transitions without priorities are tried from left to right."""
        return self.in_turn and self.style is not PictureStyle.S7GRAPH

    @property
    def text_width(self) -> int:
        """The width at which texts of actions and conditions are wrapped."""
        return _NARROW if self.narrow else _TEXT_WIDTH

    def frame(self, name: str | None) -> str:
        """Return the id of the frame of a partial chart; empty where the picture has none."""
        return self.frames.get((name or "").casefold(), "")

    def name_inside(self, step: Step) -> str:
        """Return the name in the box of a step: in GRAFCET its number, where it has one."""
        return str(step.number) if self.style is PictureStyle.GRAFCET and step.number is not None else step.name

    def step_reference(self, number: int) -> LinkEnd:
        """Return the reference to a step: its name, in GRAFCET and S7-GRAPH its number."""
        step = self.steps[number]
        name = self.name_inside(step)
        if step.number is not None and self.style is PictureStyle.S7GRAPH:
            name = f"S{step.number} {step.name}"
        return LinkEnd(name, f"{self.prefix}step-{number}")

    def transition_reference(self, number: int) -> LinkEnd:
        """Return the reference to a transition: its name or number, else the names of the steps before it."""
        transition = self.transitions[number]
        name = transition.name
        if transition.number is not None and (self.style is PictureStyle.S7GRAPH or not name):
            name = f"({transition.number})" if self.style is PictureStyle.GRAFCET else f"T{transition.number}"
        elif name and self.style is PictureStyle.GRAFCET:
            name = f"({name})"
        elif not name:
            name = " & ".join(self.step_reference(i).name for i in transition.sources if i in self.steps)
            name = name or self.words.label(self.labels[number])  # a source transition
        return LinkEnd(name, f"{self.prefix}transition-{number}")
