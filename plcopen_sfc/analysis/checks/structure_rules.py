"""Rules about the structure of charts: where they start and end, how symbols are joined, names and numbers.

Among them are steps that nothing leaves or enters, and references to steps that do not exist.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, CheckedSheet, Finding, FindingPlace, Rule
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model.drawing import STEPS, Drawing, Symbol, SymbolKind
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.sfc import PartialChartKind, Step, Transition, connected_parts
from plcopen_sfc.model.types import DerivedType

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
        """Return the symbols that a wire leads from to this one."""
        return (self.symbols[i] for i in self._above.get(symbol.id, ()))

    def above(self, symbol: Symbol) -> list[Symbol]:
        """Return the steps and transitions above a symbol."""
        return self._reach(symbol, self._above)

    def below(self, symbol: Symbol) -> list[Symbol]:
        """Return the steps, jumps and transitions below a symbol."""
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


def _drawings(chart: CheckedChart) -> Iterator[tuple[CheckedSheet, _Wires]]:
    for sheet in chart.sheets:
        if sheet.chart.drawing is not None:
            yield sheet, _Wires(sheet.chart.drawing)


def _label(sheet: CheckedSheet, symbol: Symbol) -> str:
    """Return the label of a symbol."""
    if symbol.kind is SymbolKind.TRANSITION:
        transition = next((t for t in sheet.chart.transitions if t.id == symbol.id), None)
        return f"transition {sheet.label(transition)}" if transition is not None else "a transition"
    if symbol.kind is SymbolKind.JUMP:
        target = sheet.names.get(symbol.target, symbol.name) if symbol.target is not None else symbol.name
        return f"the jump to {target or 'nowhere'}"
    return f"step {sheet.names[symbol.id]}" if symbol.id in sheet.names else "a step"


def _place(sheet: CheckedSheet, symbol: Symbol) -> FindingPlace:
    """Return the place of the step or transition of a symbol; else that of its chart."""
    elements: list[Step | Transition] = [*sheet.chart.steps, *sheet.chart.transitions]
    found = next((element for element in elements if element.id == symbol.id), None)
    return sheet.at(found) if found is not None else sheet.place


def _alternation(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, transition in chart.transitions() if chart.family == "grafcet" else ():  # else STR11 and STR14 find it
        if not transition.sources and not transition.targets:
            yield Finding(sheet.at(transition), "the transition leads from no step to no step", "Connect or remove it.")
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
                # a branch above may have ended in a jump: CODESYS draws a wire from it
                above = [at for at in wires.above(symbol) if at.kind is not SymbolKind.JUMP]
                for side, found, steps in _sides(symbol, above, wires.below(symbol)):
                    wanted = "steps" if steps else "transitions"
                    for wrong in found:
                        if (wrong.kind is not SymbolKind.TRANSITION) is not steps:
                            what = f"{_label(sheet, wrong)} stands {side} a {_BARS[symbol.kind]}, where {wanted} belong"
                            yield Finding(_place(sheet, wrong), what)


def _sides(bar: Symbol, above: list[Symbol], below: list[Symbol]) -> Iterator[tuple[str, list[Symbol], bool]]:
    """Yield the symbols above and those below a bar, with True if steps belong there (else transitions)."""
    if bar.kind is SymbolKind.SIMULTANEOUS_DIVERGENCE or bar.kind is SymbolKind.SIMULTANEOUS_CONVERGENCE:
        steps_above = bar.kind is SymbolKind.SIMULTANEOUS_CONVERGENCE
        yield "above", above, steps_above
    else:
        # CODESYS ends a selection whose other branches jump in a convergence between a step and its transition
        steps_above = bool(above) and above[0].kind is not SymbolKind.TRANSITION
        yield "above", above, steps_above
    yield "below", below, not steps_above


def _references(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, transition in chart.transitions():
        for side, ids in (("from", transition.sources), ("to", transition.targets)):
            if any(number not in sheet.names for number in ids):
                yield Finding(sheet.at(transition), f"the transition leads {side} a step that does not exist")
    for sheet, wires in _drawings(chart):
        for symbol in wires.symbols.values():
            if symbol.kind is SymbolKind.JUMP and symbol.target is None and not symbol.exclude:
                above = wires.above(symbol)
                place = _place(sheet, above[0]) if above else sheet.place
                yield Finding(place, f"a jump leads to {symbol.name or 'nothing'!r}, which is no step of this chart")


def jumping_nowhere(sheet: CheckedSheet) -> set[int]:
    """Return the transitions (ids) above a jump to something that does not exist."""
    if sheet.chart.drawing is None:
        return set()
    wires = _Wires(sheet.chart.drawing)
    jumps = [s for s in wires.symbols.values() if s.kind is SymbolKind.JUMP and s.target is None]
    return {above.id for jump in jumps for above in wires.above(jump)}


STR01 = Rule(
    code="STR01",
    title="Steps and transitions alternate",
    why="A step that leads to a step, or a transition that leads to a transition, has no meaning: tools refuse the "
    "chart or guess (IEC 61131-3 ed. 3, 6.7.5; IEC 60848:2013, 4). A GRAFCET as text cannot have it, as each of its "
    "arrows is a transition; a .grafcet file with such an arc is refused when it is read.",
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


def _duplicates(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        seen: dict[str, str] = {}
        for step in sheet.steps:
            key = step.name.casefold()
            if key in seen and key:
                yield Finding(sheet.at(step), f"another step of the chart is called {seen[key]!r}, too")
            seen.setdefault(key, step.name)
    yield from _flags_of_two(chart) if chart.family == "grafcet" else ()


def _flags_of_two(chart: CheckedChart) -> Iterator[Finding]:
    """Find steps of two charts of a GRAFCET with one name: their flag is that of both."""
    charts: dict[str, CheckedSheet] = {}
    for sheet, step in chart.steps():
        first = charts.setdefault(step.name.casefold(), sheet)
        if first is not sheet and step.name:
            place = first.partial.name if first.partial is not None else "the first chart"
            message = f"{place} has a step {step.name!r}, too: X{step.name} is the flag of both"
            yield Finding(sheet.at(step), message)


def _identifiers(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step in chart.steps():
        if not _is_identifier(step.name, chart):
            message = f"the name {step.name!r} is no identifier" if step.name.strip() else "the step has no name"
            yield Finding(sheet.at(step), message)


def _is_identifier(name: str, chart: CheckedChart) -> bool:
    """Return True if a text is a name on its own: no keyword, no blanks, nothing around it."""
    parsed = parse_expression(name, chart.dialect)
    return not parsed.problems and isinstance(parsed.tree, n.Name) and parsed.tree.identifier == name


def _clashes(chart: CheckedChart) -> Iterator[Finding]:
    if chart.pou is None:
        return
    taken: dict[str, str] = {action.name.casefold(): "an action" for action in chart.pou.actions}
    taken |= {named.name.casefold(): "a transition" for named in chart.pou.transitions}
    for variable in chart.pou.variables():
        type_ = variable.type
        if not (isinstance(type_, DerivedType) and type_.name.upper().startswith(_OF_STEPS)):
            taken[variable.name.casefold()] = "a variable"
    for sheet, step in chart.steps():
        if step.name.casefold() in taken:
            yield Finding(sheet.at(step), f"the POU has {taken[step.name.casefold()]} of the same name")


_OF_STEPS = ("G7_", "SFCSTEPTYPE")
"""The types of variables that tools declare for steps and transitions."""


def _numbers(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        yield from _repeated(sheet, "step", sheet.steps)
        yield from _repeated(sheet, "transition", sheet.transitions)


def _repeated(sheet: CheckedSheet, kind: str, elements: Iterable[Step | Transition]) -> Iterator[Finding]:
    seen: set[int] = set()
    for element in elements:
        if element.number in seen:
            yield Finding(sheet.at(element), f"another {kind} has the number {element.number}, too")
        elif element.number is not None:
            seen.add(element.number)


def _together(chart: CheckedChart) -> Iterator[Finding]:
    """S7-GRAPH declares a variable for each step and transition."""
    for sheet in chart.sheets:
        seen = {step.name.casefold(): "a step" for step in sheet.steps}
        for transition in sheet.transitions:
            key = transition.name.casefold()
            if key in seen:
                yield Finding(sheet.at(transition), f"{seen[key]} of the block has the name {transition.name!r}, too")
            elif key:
                seen[key] = "a transition"


NAM01 = Rule(
    code="NAM01",
    title="Step names are unique in a chart",
    why="Jumps and step variables mean the first of them; tools refuse the chart. Case does not matter. In a GRAFCET "
    "names of steps are unique in all its partial charts (IEC 60848:2013, 4.3): X2 could be the flag of two steps.",
    hint="Rename one of them.",
    example="""
INITIAL_STEP S1: END_STEP
STEP Wait: END_STEP
STEP WAIT: END_STEP
TRANSITION FROM S1 TO Wait := a; END_TRANSITION
TRANSITION FROM Wait TO S1 := b; END_TRANSITION
""",
    check=_duplicates,
    severity=Severity.ERROR,
)

NAM02 = Rule(
    code="NAM02",
    title="Step names are identifiers",
    why="A step declares variables of its name (S3.X, S3.T), so that it must be an identifier of IEC 61131-3 and no "
    "keyword. S7-GRAPH allows blanks and parentheses, GRAFCET has numbers.",
    hint="Use letters, digits and underscores, a letter first.",
    example="a step called Wait for part",
    check=_identifiers,
    severity=Severity.ERROR,
    severities={"s7graph": None, "grafcet": None},
)

NAM03 = Rule(
    code="NAM03",
    title="Steps share their names with nothing in the POU",
    why="The step declares a variable of its name; a declared variable, an action or a transition of the same name "
    "hides it, or is hidden by it.",
    hint="Rename one of them.",
    example="""
VAR Fill : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
STEP Fill: END_STEP
TRANSITION FROM S1 TO Fill := a; END_TRANSITION
TRANSITION FROM Fill TO S1 := b; END_TRANSITION
""",
    check=_clashes,
    severity=Severity.ERROR,
    severities={"grafcet": None},
)

NAM04 = Rule(
    code="NAM04",
    title="Numbers are unique",
    why="S7-GRAPH knows steps and transitions by their numbers, and GRAFCET draws steps by them.",
    hint="Renumber one of them.",
    example="two steps with the number 3",
    check=_numbers,
    severity=Severity.WARNING,
    severities={"s7graph": Severity.ERROR},
)

NAM05 = Rule(
    code="NAM05",
    title="Steps and transitions of S7-GRAPH have names of their own",
    why="The block declares a static variable for each of them, in one scope.",
    hint="Rename one of them.",
    example="a transition called Step1 in a block with a step Step1",
    check=_together,
    severity=None,
    severities={"s7graph": Severity.ERROR},
)


def _start_by_themselves(chart: CheckedChart) -> Iterator[CheckedSheet]:
    """The networks that are started with the program, not by a macro-step, an enclosing step or a forcing order."""
    forced = {
        association.forcing.chart.casefold() for _, _, association in chart.actions() if association.forcing is not None
    }
    for sheet in chart.sheets:
        if sheet.macro is None and sheet.steps:
            partial = sheet.partial
            if partial is None or (partial.kind is PartialChartKind.GLOBAL and partial.name.casefold() not in forced):
                yield sheet


def _none(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in _start_by_themselves(chart):
        if not any(step.initial for step in sheet.steps):
            if any(not transition.sources for transition in sheet.transitions):
                continue  # a source transition is always enabled (IEC 60848:2013, 4.5)
            starts = "it starts with its first step" if chart.family == "s7graph" else "the chart never starts"
            yield Finding(sheet.place, f"no step is initial: {starts}")
            continue
        for number, sequence in enumerate(sheet.chart.sequences, start=1):
            inside = [step for step in sheet.steps if step.id in set(sequence.steps)]
            if inside and not any(step.initial for step in inside):
                message = f"no step of sequence {number} is initial: it starts with its first step"
                yield Finding(sheet.at(inside[0]), message)


def _several(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for steps in connected_parts(sheet.steps, sheet.transitions):
            initial = [step for step in steps if step.initial]
            for step in initial[1:]:
                message = f"a second initial step in one connected chart, besides {initial[0].name}"
                yield Finding(sheet.at(step), message)


STR02 = Rule(
    code="STR02",
    title="A chart has an initial step",
    why="Without one no step is ever active (IEC 61131-3 ed. 3, 6.7.2; IEC 60848:2013, 4). S7-GRAPH then starts with "
    "the first step of the sequence.",
    hint="Mark the step in which the chart starts.",
    example="""
STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
""",
    check=_none,
    severity=Severity.ERROR,
    severities={"s7graph": Severity.WARNING},
)

STR12 = Rule(
    code="STR12",
    title="A connected chart has one initial step",
    why="IEC 61131-3 (ed. 3, 6.7.2) wants exactly one in each network; tools refuse the chart, or start with one of "
    "them. GRAFCET and S7-GRAPH allow several.",
    hint="Make the others ordinary steps, and reach them by a simultaneous divergence.",
    example="""
INITIAL_STEP S1: END_STEP
INITIAL_STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
""",
    check=_several,
    severity=Severity.ERROR,
    severities={"s7graph": None, "grafcet": None},
)


def _dead_ends(chart: CheckedChart) -> Iterator[Finding]:
    exits = {macro.exit for macro in chart.net.macros}
    for step in chart.net.steps:
        if not chart.net.leaving[step.index] and step.index not in exits:
            alone = len(chart.sheet_of(step).steps) == 1
            if not alone:
                yield Finding(chart.place_of(step), "no transition leaves the step: the chart stays in it")


def _sinks(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        lost = jumping_nowhere(sheet)
        for transition in sheet.transitions:
            if transition.sources and not transition.targets and transition.id not in lost:
                yield Finding(sheet.at(transition), "the transition leads nowhere: what was active before it just ends")


def _sources(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, transition in chart.transitions():
        if not transition.sources:
            yield Finding(sheet.at(transition), "no step leads to the transition")


def _in_functions(chart: CheckedChart) -> Iterator[Finding]:
    if chart.pou is not None and chart.pou.kind is PouKind.FUNCTION:
        yield Finding(chart.root.place, f"{chart.pou.name} is a function, and keeps no step from call to call")


STR09 = Rule(
    code="STR09",
    title="Every step is left",
    why="A chart that comes to a step without a transition stays in it. That may be meant (a chart that runs once); "
    "CODESYS cannot draw it, and S7-GRAPH wants a transition with a sequence end behind every last step.",
    hint="Add the transition that leads on, or a jump to the start.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
""",
    check=_dead_ends,
    severity=Severity.WARNING,
    severities={
        "codesys": Severity.ERROR,
        "codesys23": Severity.ERROR,
        "s7graph": Severity.ERROR,
        "grafcet": Severity.INFO,
    },
)

STR11 = Rule(
    code="STR11",
    title="A step leads to every transition",
    why="Without one a transition is never enabled; CODESYS leaves such remains behind divergences whose branches all "
    "end in jumps. In GRAFCET it is a source transition, which is always enabled, and legal.",
    hint="Connect it to a step, or remove it with what follows it.",
    example="a transition with no wire above it",
    check=_sources,
    severity=Severity.WARNING,
    severities={"s7graph": Severity.ERROR, "grafcet": None},
)

STR14 = Rule(
    code="STR14",
    title="Every transition leads to a step",
    why="When it fires, the chart just ends: no step is active any more. S7-GRAPH (sequence end) and GRAFCET (sink "
    "transition) have that; IEC 61131-3 and CODESYS do not.",
    hint="Add a step or a jump behind it.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 := b; END_TRANSITION
""",
    check=_sinks,
    severity=Severity.ERROR,
    severities={"s7graph": None, "grafcet": None},
)

STR16 = Rule(
    code="STR16",
    title="A chart is in a program or a function block",
    why="A function has no memory, so that no step would be active in the next scan. IEC 61131-3 (ed. 3, 6.7.1) allows "
    "charts in programs and function blocks only, as CODESYS does; S7-GRAPH has function blocks only.",
    hint="Make it a function block or a program.",
    example="a function with a chart",
    check=_in_functions,
    severity=Severity.ERROR,
)
