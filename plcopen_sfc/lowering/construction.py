"""Construction of the code of a chart as a POU: the choice of its encoding, language and options, and the making."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from plcopen_sfc.errors import LoweringError
from plcopen_sfc.formats.format_interface import NetworkForm
from plcopen_sfc.languages.st import print_node, transform
from plcopen_sfc.languages.st.nodes import Expression, Name, Node
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.actions.drive_block import drive_block
from plcopen_sfc.lowering.case_objections import fits_without_switching, objection, refuse_cases
from plcopen_sfc.lowering.code.code_bodies import assemble
from plcopen_sfc.lowering.code.code_memory import BitMemory, BlockMemory, Memory, OperandMemory
from plcopen_sfc.lowering.code.flat_statements import flatten, name_inputs, put_logic
from plcopen_sfc.lowering.code.lowered_code import FlagPlaces, LoweredCode, Naming, names_of
from plcopen_sfc.lowering.code.single_use import inline_single_uses, remove_unread
from plcopen_sfc.lowering.code.statement_lists import join_conditionals
from plcopen_sfc.lowering.encodings.case_encodings import CaseEncoding, RegionEncoding
from plcopen_sfc.lowering.encodings.step_flags import FlipFlopEncoding, StepBitEncoding
from plcopen_sfc.lowering.grafcet.grafcet_reading import is_grafcet, plain_chart, read_grafcet
from plcopen_sfc.lowering.grafcet.grafcet_scan import GrafcetScan
from plcopen_sfc.lowering.graph.sequencer_reading import read_sequencer, without_step_data
from plcopen_sfc.lowering.graph.sequencer_scan import GraphCycle
from plcopen_sfc.lowering.graph.sequencer_source import GraphSource
from plcopen_sfc.lowering.lowering_options import (
    LOCAL,
    ActionPlace,
    Construction,
    Language,
    LoweringRules,
    OperatingMode,
    States,
    has_line_comments,
    tool_of,
    usual_states,
)
from plcopen_sfc.lowering.reading.chart_reading import read_chart
from plcopen_sfc.lowering.reading.chart_source import ChartSource, step_numbers
from plcopen_sfc.lowering.schedule.added_inputs import names_in_conditions, with_usual_input
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.types import DataTypeDeclaration


@contextmanager
def errors_of(project: Project, pou: Pou, name: str) -> Iterator[None]:
    """Give errors of lowering the chart called `name`, that of the POU or of an action, the place of that chart.

    The code that raises them has a POU with a chart, and knows nothing of actions and files.
    """
    try:
        yield
    except LoweringError as error:
        path = error.location.path or pou.name
        if not path.startswith("POU "):  # else it is the error of a chart that this one brings along
            inside = "" if path in (pou.name, name) else path.removeprefix(f"{pou.name} / ")
            path = " / ".join(filter(None, [pou.report_path_of(name), inside]))
            (error.location,) = project.locations_of([path])
        raise


def choose(source: ChartSource, rules: LoweringRules) -> tuple[Construction, Language, str]:
    """Return the construction, its language, and the reason for it.

    Raises `LoweringError` where the construction has no such language, or none of the options that were asked for.
    """
    chosen, why = _choice(source, rules)
    language = rules.language
    if language is None:
        drawn = chosen is Construction.FLIPFLOP and rules.networks is NetworkForm.DRAWN
        language = Language.FBD if drawn else Language.ST
    wrong = [*_wrong_options(source, rules), *_wrong_language(source, rules, chosen, language)]
    for message, hint in [*wrong, *_wrong_places(rules, chosen, why)]:
        source.refuse(message, hint)
    return chosen, language, why


def _wrong_options(source: ChartSource, rules: LoweringRules) -> Iterator[tuple[str, str]]:
    """Yield options that sequencers of S7-GRAPH do not have, or only they have, and what to do."""
    if not isinstance(source, GraphSource):
        if {name.upper() for name in rules.at_rest} - {"ALL"}:  # all of no inputs is nothing
            message = "only blocks of S7-GRAPH have parameters that could be inactive inputs"
            yield message, "Leave out at_rest, --at-rest."
        return
    if rules.modes:
        hint = "Declare SW_AUTO, SW_MAN, SW_TAP, SW_TOP, T_PUSH, S_SEL, S_ON or S_OFF in the block instead."
        yield "sequencers of S7-GRAPH have operating modes of their own", hint
    if rules.actions is not ActionPlace.INLINE:
        yield "actions of a sequencer of S7-GRAPH cannot be in a block of their own", ""
    if rules.reset_actions:
        yield "S in S7-GRAPH sets an operand that anything may reset: only R of the chart ends it", ""


def _wrong_language(
    source: ChartSource, rules: LoweringRules, chosen: Construction, language: Language
) -> Iterator[tuple[str, str]]:
    """Yield why the construction or the target has nothing in a language, and what to do."""
    has_instructions = rules.format.il_bodies if rules.format is not None else source.dialect is not Dialect.SCL
    if language is Language.IL and not has_instructions:
        yield f"{rules.target or 'SCL'} has no bodies in instruction list", "Take --language ST."
    if language.is_drawn and rules.networks is NetworkForm.COMMENTS:
        hint = "Flip-flops can be written as structured text too: language ST."
        yield f"{rules.target} is structured text and has no networks of {language}", hint
    if language.is_drawn and chosen is not Construction.FLIPFLOP:
        yield f"{chosen} is structured text, it cannot be drawn in {language}", "Take flip-flops, or --language ST."
    if language is Language.IL and chosen not in _WITH_FLAGS:
        hint = "Take flip-flops or bits, or --language ST."
        yield f"{chosen} is structured text, it cannot be in instruction list", hint


_WITH_FLAGS = (Construction.FLIPFLOP, Construction.BITS)


def _wrong_places(rules: LoweringRules, chosen: Construction, why: str) -> Iterator[tuple[str, str]]:
    """Yield states, actions and flags that the construction does not have so, and what to do."""
    if rules.states not in (None, States.NUMBERS) and chosen in _WITH_FLAGS:
        hint = f"It was taken for this reason: {why}."
        yield f"{chosen} has no states that could be written as {rules.states}", hint
    if rules.actions is ActionPlace.BLOCK and rules.is_classic and chosen is Construction.CASE:
        message = "actions cannot be in a block of their own where they are a part of a CASE"
        yield message, "Leave actions inline, or take flip-flops."
    if rules.flags != LOCAL and chosen not in _WITH_FLAGS:
        message = "only flip-flops and step bits have flags that could be put elsewhere"
        yield message, "Take --as flipflop or bits."


def _choice(source: ChartSource, rules: LoweringRules) -> tuple[Construction, str]:
    if rules.construction is not Construction.AUTO:
        return rules.construction, "asked for"
    if rules.language not in (None, Language.ST):
        return Construction.FLIPFLOP, f"flip-flops are what {rules.language} can hold"
    several = objection(source, rules.profile, Construction.CASE)
    if rules.is_classic and several:
        return Construction.FLIPFLOP, f"textbooks have flip-flops for it: {several}"
    if rules.flags != LOCAL and not rules.is_classic:
        return Construction.BITS, f"there are to be step flags at {rules.flags}"
    most = "at most one step is active at a time"
    if not several:
        ends = source.starts_off or any(not transition.targets for transition in source.net.transitions)
        return Construction.CASE, most if ends else most.replace("at most", "exactly")
    found = objection(source, rules.profile, Construction.REGIONS)
    if not found:
        return Construction.REGIONS, f"in each of its parts {most}, but {several}"
    why = f"no CASE can hold the chart: {found}"
    why += "; with S_ON inactive one could" if fits_without_switching(source, rules.profile) else ""
    return Construction.BITS, why


@dataclass(frozen=True)
class Constructed:
    """POU made of a chart. `rules` are those that it keeps, with the construction that was chosen for the reason `why`.

    `step_flags` are the expressions that are TRUE while a step is active, by the path of the step; `situation` those
    that hold between two scans, where that is not the same. The code does what the chart does while inputs that were
    added have the values of `at_rest` and `left_out`, a variable or ``NOT`` one, is FALSE. `data_types` and `blocks`
    are new in the project. `step_numbers` are the numbers of steps in the code by their paths, where steps are states
    of a CASE or are selected by number. `flags`: the place of step flags outside of the POU.
    """

    pou: Pou
    rules: LoweringRules
    why: str
    step_flags: Mapping[str, str]
    situation: Mapping[str, str]
    at_rest: Mapping[str, bool]
    left_out: str | None
    data_types: tuple[DataTypeDeclaration, ...]
    step_numbers: Mapping[str, int]
    flags: FlagPlaces | None = field(default=None, repr=False)
    blocks: tuple[Pou, ...] = ()

    @property
    def construction(self) -> Construction:
        """Construction that was chosen."""
        return self.rules.construction

    @property
    def following(self) -> str:
        """Address behind its flags; empty where they have none."""
        return self.flags.following if self.flags is not None else ""


def construct(
    pou: Pou, chart: SfcNetwork, dialect: Dialect, rules: LoweringRules, project: Project | None = None
) -> Constructed:
    """Lower `chart`, which is the body of `pou`, a part of `project`.

    Raises `LoweringError` for what the target cannot express.
    """
    project = project or Project(dialect=dialect)
    # a new name must not hide a global one, and a user's name must be known to be free
    surroundings = names_of(project)
    # reading refuses what is not understood, so that all below lowers a chart that is known completely
    source = _read(pou, chart, dialect, rules, project)
    rules = with_usual_input(rules, source, surroundings)
    if isinstance(source, GraphSource):
        # variables of G7_StepPlus and the like are types that only a GRAPH block can declare
        pou = without_step_data(pou)
    chosen, language, why = choose(source, rules)
    states = rules.states or usual_states(rules, dialect)
    rules = replace(rules, construction=chosen, language=language, states=states)
    code = _code(source, dialect, rules, language, project)
    code.has_line_comments = has_line_comments(rules, dialect, project)
    code.is_textbook = rules.is_classic
    code.for_others = rules.target is not None and not rules.is_classic
    if rules.flags != LOCAL:
        code.flags = FlagPlaces(rules, pou.name, project, code.tool)
    maker = _filled(source, _memory(code, language), rules, surroundings)
    if code.drawn and code.tool is Tool.S7:
        name_inputs(code, project)
        put_logic(code, pou.variables(), contacts=language is Language.LD)
    # most of a sequencer would be the text of boxes in CODESYS
    if code.needs_flat_statements or (code.drawn and isinstance(source, GraphSource)):
        flatten(code, pou.variables())
    steps = [*maker.active_steps().values(), *(maker.active(step.index) for step in source.net.steps)]
    asked = [*steps, *([code.left_out] if code.left_out is not None else [])]
    if not code.drawn:
        inline_single_uses(code, asked)
    remove_unread(code, asked)
    if not code.drawn and not code.is_textbook:
        join_conditionals(code)
    return Constructed(
        pou=assemble(pou, code, dialect, language),
        rules=rules,
        why=why,
        step_flags={path: _bare_names(expression) for path, expression in maker.active_steps().items()},
        situation={step.path: _bare_names(maker.active(step.index)) for step in source.net.steps},
        at_rest=code.at_rest,
        left_out=_bare_names(code.left_out) if code.left_out is not None else None,
        data_types=tuple(code.data_types),
        step_numbers=_numbers(source, maker, rules),
        flags=code.flags,
        blocks=tuple(drive_block(drive, dialect, language) for drive in maker.drives),
    )


Encoding: TypeAlias = "FlipFlopEncoding | RegionEncoding | StepBitEncoding"
_ENCODINGS: dict[Construction, type[Encoding]] = {
    Construction.FLIPFLOP: FlipFlopEncoding,
    Construction.CASE: CaseEncoding,
    Construction.REGIONS: RegionEncoding,
    Construction.BITS: StepBitEncoding,
}


def _filled(source: ChartSource, memory: Memory, rules: LoweringRules, surroundings: Collection[str]) -> Encoding:
    """Return the encoding of a chart whose schedule has filled the code of `memory`."""
    chosen = rules.construction
    source = plain_chart(source) if rules.is_classic else source
    if isinstance(source, GraphSource):
        memory.code.at_rest |= dict.fromkeys(source.at_rest, False)
    refuse_cases(source, rules.profile, chosen)
    encoding = _ENCODINGS[chosen](source, memory, rules, surroundings)
    if rules.is_classic:
        if isinstance(source, GraphSource) or not isinstance(encoding, FlipFlopEncoding | CaseEncoding):
            raise LoweringError(f"{chosen} has no classic style", hint="Take flip-flops or case, or the exact style.")
        encoding.classic()
    elif isinstance(source, GraphSource):
        GraphCycle(encoding, source).append()
    elif source.grafcet is not None:
        GrafcetScan(encoding).append()
    else:
        encoding.exact()
    return encoding


def _read(pou: Pou, chart: SfcNetwork, dialect: Dialect, rules: LoweringRules, project: Project) -> ChartSource:
    if rules.profile.graph_parameters:
        return read_sequencer(pou, chart, dialect, rules, project)
    if is_grafcet(chart, rules.profile):
        return read_grafcet(pou, dialect, rules.profile, names_of(project), project=project)
    return read_chart(pou, chart, dialect, rules.profile, names_of(project), project=project)


def _code(
    source: ChartSource, dialect: Dialect, rules: LoweringRules, language: Language, project: Project
) -> LoweredCode:
    """Return empty code that knows its target and the names that are taken."""
    tool = tool_of(rules.target, dialect)
    taken = [*source.names(), *names_in_conditions(rules, dialect)]
    code = LoweredCode(Naming(dialect, taken, rules.part, ascii=rules.target is not None and tool is not Tool.S7))
    code.tool = tool
    code.known_types = {kind.name.casefold() for kind in project.data_types}
    code.texts = rules.texts
    code.instances = source.instances
    code.culture = rules.texts.culture if code.tool is Tool.S7 and rules.networks is not NetworkForm.COMMENTS else ""
    code.drawn = language is not Language.ST
    code.one_sheet = rules.format is not None and rules.format.one_sheet
    return code


def _memory(code: LoweredCode, language: Language) -> Memory:
    if not language.is_drawn:
        return BitMemory(code)
    return OperandMemory(code) if code.tool is Tool.S7 else BlockMemory(code)


def _numbers(source: ChartSource, maker: Encoding, rules: LoweringRules) -> dict[str, int]:
    """Return the numbers of steps where they are states, or are selected by them."""
    if rules.construction in _WITH_FLAGS and OperatingMode.SELECT not in rules.modes:
        return {}
    merged = maker.states.is_merged if isinstance(maker, RegionEncoding) else lambda _: False
    numbers = zip(source.net.steps, step_numbers(source.net), strict=True)
    return {step.path: number for step, number in numbers if not merged(step.index)}


def _bare_names(expression: Expression) -> str:
    """Return an expression with bare names of variables, which are the same in files of other dialects."""

    def bare(node: Node) -> Node:
        return Name(node.identifier) if isinstance(node, Name) else node

    return print_node(transform(expression, bare))
