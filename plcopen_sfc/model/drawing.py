"""Drawing of a chart: symbols, bars, jumps and wires. `plcopen_sfc.model.sfc` has what the chart does."""

from __future__ import annotations

from enum import StrEnum

from pydantic import Field

from plcopen_sfc.model.base import Element, ElementId, Model
from plcopen_sfc.model.late import Late
from plcopen_sfc.model.network import InputPin, OutputPin, Point


class SymbolKind(StrEnum):
    """The symbols of a chart (TC6 2.01 ``sfcObjects``)."""

    STEP = "step"
    MACRO_STEP = "macroStep"
    TRANSITION = "transition"
    JUMP = "jumpStep"
    SELECTION_DIVERGENCE = "selectionDivergence"
    SELECTION_CONVERGENCE = "selectionConvergence"
    SIMULTANEOUS_DIVERGENCE = "simultaneousDivergence"
    SIMULTANEOUS_CONVERGENCE = "simultaneousConvergence"
    ACTION_BLOCK = "actionBlock"
    EXPRESSION = "inVariable"


STEPS = frozenset({SymbolKind.STEP, SymbolKind.MACRO_STEP})
DIVERGENCES = frozenset({SymbolKind.SELECTION_DIVERGENCE, SymbolKind.SIMULTANEOUS_DIVERGENCE})
CONVERGENCES = frozenset({SymbolKind.SELECTION_CONVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE})
BARS = DIVERGENCES | CONVERGENCES


class StepActionKind(StrEnum):
    """The step actions of CODESYS."""

    ENTRY = "entry"
    MAIN = "main"
    EXIT = "exit"


class ActionEntry(Model):
    """A line of an action block: an association, or a step action where the format has no other place for it.

    `association` is the id of the association, or an id of the line's own where it is a step action. `local_id` where
    the file gives it another id than the model.
    """

    association: ElementId
    step_action: StepActionKind | None = None
    local_id: int | None = None
    position: Point | None = None
    width: float | None = None
    height: float | None = None
    execution_order: int | None = None
    output: OutputPin | None = None


class Symbol(Element):
    """One drawn symbol.

    Symbols of steps and transitions have the id of what they show; one transition symbol below a convergence of
    steps shows several transitions, listed in `transitions`. `target` is the step or simultaneous divergence
    that a jump leads to, `name` the text of a jump to something that does not exist, or the name of a bar.
    `condition` is the pin at which a transition takes its condition, `action_output` the pin at which a step drives
    its action blocks, `entries` the lines of an action block. `local_id` is the id in the file where another element
    has it too.
    """

    id: ElementId
    kind: SymbolKind
    position: Point = (0, 0)
    width: float | None = None
    height: float | None = None
    inputs: list[InputPin] = Field(default_factory=list)
    outputs: list[OutputPin] = Field(default_factory=list)
    action_output: OutputPin | None = None
    condition: InputPin | None = None
    transitions: list[ElementId] | None = None
    target: ElementId | None = None
    name: str | None = None
    entries: list[ActionEntry] | None = None
    execution_order: int | None = None
    exclude: bool = False
    local_id: int | None = None


class Places(StrEnum):
    """Origin of the places of symbols: none, a file, or `plcopen_sfc.drawing.symbol_layout`.

    Computed places are no work of a person; a format without places may forget them.
    """

    NONE = "none"
    GIVEN = "given"
    COMPUTED = "computed"


class Drawing(Late):
    """The drawing of one chart, which a reader may leave unread.

    `order` is the order of the file's elements by id where graphical logic is between the symbols; else the
    symbols come first, in the order of `symbols`. `places`: True if the positions mean anything.
    """

    symbols: list[Symbol] = Field(default_factory=list)
    order: list[ElementId] | None = None
    places: Places = Places.NONE
