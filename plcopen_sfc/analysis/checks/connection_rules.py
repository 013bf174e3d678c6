"""How symbols are joined: what the drawing of a chart says, and references to steps that do not exist."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, FindingPlace, Sheet
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.model.drawing import STEPS, Drawing, Symbol, SymbolKind
from plcopen_sfc.model.sfc import Step, Transition

_ENDS = STEPS | {SymbolKind.TRANSITION}
_BARS = {
    SymbolKind.SELECTION_DIVERGENCE: "selection divergence",
    SymbolKind.SELECTION_CONVERGENCE: "selection convergence",
    SymbolKind.SIMULTANEOUS_DIVERGENCE: "simultaneous divergence",
    SymbolKind.SIMULTANEOUS_CONVERGENCE: "simultaneous convergence",
}


class _Wires:
    """The wires of a drawing, followed through bars."""

    def __init__(self, drawing: Drawing) -> None:
        self.symbols = {symbol.id: symbol for symbol in drawing.symbols}
        self._above: dict[int, list[int]] = {}
        self._below: dict[int, list[int]] = {}
        for symbol in drawing.symbols:
            for source in {wire.source for pin in symbol.inputs for wire in pin.connections}:
                if source in self.symbols:
                    self._above.setdefault(symbol.id, []).append(source)
                    self._below.setdefault(source, []).append(symbol.id)

    def direct(self, symbol: Symbol) -> Iterator[Symbol]:
        """The symbols that a wire leads from to this one."""
        return (self.symbols[i] for i in self._above.get(symbol.id, ()))

    def above(self, symbol: Symbol) -> list[Symbol]:
        """The steps and transitions above a symbol."""
        return self._reach(symbol, self._above)

    def below(self, symbol: Symbol) -> list[Symbol]:
        """The steps, jumps and transitions below a symbol."""
        return self._reach(symbol, self._below)

    def _reach(self, symbol: Symbol, beside: dict[int, list[int]]) -> list[Symbol]:
        found: dict[int, Symbol] = {}
        seen = {symbol.id}
        waiting = list(beside.get(symbol.id, ()))
        while waiting:
            number = waiting.pop()
            if number in seen:
                continue
            seen.add(number)
            at = self.symbols[number]
            if at.kind in _BARS:
                waiting += beside.get(number, ())
            elif at.kind in _ENDS or at.kind is SymbolKind.JUMP:
                found[number] = at
        return list(found.values())


def _drawings(chart: CheckedChart) -> Iterator[tuple[Sheet, _Wires]]:
    for sheet in chart.sheets:
        if sheet.chart.drawing is not None:
            yield sheet, _Wires(sheet.chart.drawing)


def _label(sheet: Sheet, symbol: Symbol) -> str:
    """What people call a symbol."""
    if symbol.kind is SymbolKind.TRANSITION:
        transition = next((t for t in sheet.chart.transitions if t.id == symbol.id), None)
        return f"transition {sheet.label(transition)}" if transition is not None else "a transition"
    if symbol.kind is SymbolKind.JUMP:
        target = sheet.names.get(symbol.target, symbol.name) if symbol.target is not None else symbol.name
        return f"the jump to {target or 'nowhere'}"
    return f"step {sheet.names[symbol.id]}" if symbol.id in sheet.names else "a step"


def _place(sheet: Sheet, symbol: Symbol) -> FindingPlace:
    """The place of the step or transition that a symbol stands for; else that of its chart."""
    elements: list[Step | Transition] = [*sheet.chart.steps, *sheet.chart.transitions]
    found = next((element for element in elements if element.id == symbol.id), None)
    return sheet.at(found) if found is not None else sheet.place


def _alternation(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, wires in _drawings(chart):
        for symbol in wires.symbols.values():
            if symbol.kind not in _ENDS and symbol.kind is not SymbolKind.JUMP:
                continue
            for source in wires.direct(symbol):
                both = symbol.kind is SymbolKind.TRANSITION and source.kind is SymbolKind.TRANSITION
                if both or (symbol.kind is not SymbolKind.TRANSITION and source.kind in STEPS):
                    what = "step" if both else "transition"
                    message = f"{_label(sheet, source)} leads to {_label(sheet, symbol)} without a {what} between"
                    yield Finding(_place(sheet, source), message, f"Insert a {what}.")


def _bars(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, wires in _drawings(chart):
        for symbol in wires.symbols.values():
            if symbol.kind in _BARS:
                # a leg above may have ended in a jump: CODESYS draws a wire from it
                above = [at for at in wires.above(symbol) if at.kind is not SymbolKind.JUMP]
                for side, found, steps in _sides(symbol, above, wires.below(symbol)):
                    wanted = "steps" if steps else "transitions"
                    for wrong in found:
                        if (wrong.kind is not SymbolKind.TRANSITION) is not steps:
                            what = f"{_label(sheet, wrong)} stands {side} a {_BARS[symbol.kind]}, where {wanted} belong"
                            yield Finding(_place(sheet, wrong), what)


def _sides(bar: Symbol, above: list[Symbol], below: list[Symbol]) -> Iterator[tuple[str, list[Symbol], bool]]:
    """What stands above and below a bar, and whether steps belong there (else transitions)."""
    if bar.kind is SymbolKind.SIMULTANEOUS_DIVERGENCE or bar.kind is SymbolKind.SIMULTANEOUS_CONVERGENCE:
        steps_above = bar.kind is SymbolKind.SIMULTANEOUS_CONVERGENCE
        yield "above", above, steps_above
    else:
        # CODESYS ends a selection whose other legs jump in a convergence between a step and its transition
        steps_above = bool(above) and above[0].kind is not SymbolKind.TRANSITION
        yield "above", above, steps_above
    yield "below", below, not steps_above


def _references(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for transition in sheet.transitions:
            for side, ids in (("from", transition.sources), ("to", transition.targets)):
                if any(number not in sheet.names for number in ids):
                    yield Finding(sheet.at(transition), f"the transition leads {side} a step that does not exist")
    for sheet, wires in _drawings(chart):
        for symbol in wires.symbols.values():
            if symbol.kind is SymbolKind.JUMP and symbol.target is None and not symbol.exclude:
                above = wires.above(symbol)
                place = _place(sheet, above[0]) if above else sheet.place
                yield Finding(place, f"a jump leads to {symbol.name or 'nothing'!r}, which is no step of this chart")


def jumping_nowhere(sheet: Sheet) -> set[int]:
    """The transitions (ids) above a jump to something that does not exist."""
    if sheet.chart.drawing is None:
        return set()
    wires = _Wires(sheet.chart.drawing)
    jumps = [s for s in wires.symbols.values() if s.kind is SymbolKind.JUMP and s.target is None]
    return {above.id for jump in jumps for above in wires.above(jump)}


STR01 = Rule(
    code="STR01",
    title="Steps and transitions alternate",
    why="A step that leads to a step, or a transition that leads to a transition, has no meaning: tools refuse the "
    "chart or guess (IEC 61131-3 ed. 3, 6.7.5; IEC 60848:2013, 4).",
    hint="Insert what is missing between them.",
    example="a wire drawn from step S1 to step S2",
    check=_alternation,
    severity=Severity.ERROR,
)

STR04 = Rule(
    code="STR04",
    title="Branches begin and end with the right element",
    why="Branches of a selection begin and end with transitions, branches of simultaneous sequences with steps (IEC "
    "61131-3 ed. 3, 6.7.5; S7-GRAPH refuses to connect anything else). A bar of the wrong kind is read as the other "
    "kind by some tools, which changes the chart.",
    hint="Use the other kind of bar, or insert a step or a transition before or behind it.",
    example="a simultaneous divergence (double line) below a step, with transitions below it",
    check=_bars,
    severity=Severity.ERROR,
)

STR05 = Rule(
    code="STR05",
    title="Jumps and transitions lead to steps that exist",
    why="A token that goes to a step which does not exist is lost: the branch ends there for good. Often the step was "
    "renamed or removed by hand.",
    hint="Correct the target.",
    example="a jump to Sx in a chart that has no step Sx",
    check=_references,
    severity=Severity.ERROR,
)
