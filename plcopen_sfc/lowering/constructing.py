"""Making the code of a chart, as a POU."""

from __future__ import annotations

from dataclasses import dataclass

from plcopen_sfc.errors import LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import print_node, transform
from plcopen_sfc.languages.st.nodes import Expression, Name, Node
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.assembling import assemble, drive_block
from plcopen_sfc.lowering.chains.bits import StepBits
from plcopen_sfc.lowering.chains.case import CaseChain
from plcopen_sfc.lowering.chains.chain import Chain
from plcopen_sfc.lowering.chains.flipflops import FlipFlopChain
from plcopen_sfc.lowering.chains.regions import RegionChain
from plcopen_sfc.lowering.chains.restart import names_in_conditions, with_usual_input
from plcopen_sfc.lowering.chains.states import step_numbers
from plcopen_sfc.lowering.choosing import choose
from plcopen_sfc.lowering.code.flag_places import LOCAL, FlagPlaces
from plcopen_sfc.lowering.code.flattening import flatten
from plcopen_sfc.lowering.code.memory import BitMemory, BlockMemory, Memory
from plcopen_sfc.lowering.code.naming import Naming
from plcopen_sfc.lowering.code.program import Code
from plcopen_sfc.lowering.code.s7_memory import OperandMemory
from plcopen_sfc.lowering.code.surroundings import names_of
from plcopen_sfc.lowering.code.targets import has_networks, has_one_sheet, tool_of
from plcopen_sfc.lowering.forms import Construction, Language, Style
from plcopen_sfc.lowering.grafcet.case import GrafcetCase
from plcopen_sfc.lowering.grafcet.classic import plain_chart
from plcopen_sfc.lowering.grafcet.flipflops import GrafcetFlipFlops
from plcopen_sfc.lowering.grafcet.reading import is_grafcet, read_grafcet
from plcopen_sfc.lowering.grafcet.scan import add_grafcet
from plcopen_sfc.lowering.graph.bits import BitSequencer
from plcopen_sfc.lowering.graph.cases import CaseSequencer, RegionSequencer
from plcopen_sfc.lowering.graph.flipflops import FlipFlopSequencer
from plcopen_sfc.lowering.graph.interface import without_step_data
from plcopen_sfc.lowering.graph.reading import read_sequencer
from plcopen_sfc.lowering.graph.sequencer import Sequencer
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.reading.chart import read_chart
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.rules import LoweringRules, OperatingMode
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.types import DataTypeDeclaration


@dataclass(frozen=True)
class Constructed:
    """A POU made of a chart. `why` says why this construction was taken, `rules` what it obeys.

    `step_flags` is what tells in its code that a step is active, by the path of the step; `situation` what does between
    two scans, where that is not the same. `at_rest` and `left_out` say when it does what the chart does: while inputs
    that were added have these values, and the variable is FALSE. `data_types` are what the project needs besides.
    `step_numbers` are the numbers that steps have in the code, by their paths, where it knows them by numbers.
    """

    pou: Pou
    construction: Construction
    rules: LoweringRules
    why: str
    step_flags: dict[str, str]
    situation: dict[str, str]
    at_rest: dict[str, bool]
    left_out: str | None
    data_types: tuple[DataTypeDeclaration, ...]
    step_numbers: dict[str, int]
    flags: FlagPlaces | None = None
    blocks: tuple[Pou, ...] = ()


def construct(
    pou: Pou,
    chart: SfcNetwork,
    dialect: Dialect,
    rules: LoweringRules,
    *,
    construction: Construction = Construction.AUTO,
    style: Style = Style.EXACT,
    language: Language | None = None,
    project: Project | None = None,
) -> Constructed:
    """Lower `chart`, which is the body of `pou`, a part of `project`.

    Raises `LoweringError` for what cannot be said in the target.
    """
    project = project or Project(dialect=dialect)
    surroundings = names_of(project)
    source = _read(pou, chart, dialect, rules, project)
    rules = with_usual_input(rules, style, source, surroundings)
    if isinstance(source, GraphSource):
        pou = without_step_data(pou)
    chosen, language, why = choose(source, construction, rules, style=style, language=language)
    code = _code(source, dialect, rules, language, project)
    if rules.flags != LOCAL:
        code.flags = FlagPlaces(rules, pou.name, project, code.tool)
    maker: Sequencer | Chain
    if isinstance(source, GraphSource):
        maker = _SEQUENCERS[chosen](source, code, _memory(code, language), rules, surroundings)
        _fill(maker, chosen, style)
    else:
        plain = plain_chart(source) if style is Style.CLASSIC else source
        kinds = _CHAINS if plain.grafcet is None else _CHAINS | _GRAFCET_CHAINS
        maker = kinds[chosen](plain, code, _memory(code, language), rules, surroundings)
        if plain.grafcet is not None:
            add_grafcet(maker)
        else:
            _fill(maker, chosen, style)
    # most of a sequencer would be the text of boxes in CODESYS
    if code.needs_flat_statements or (code.drawn and isinstance(source, GraphSource)):
        flatten(code, pou.variables())
    drives = maker.drives if isinstance(maker, Chain) else []
    return Constructed(
        assemble(pou, code, dialect, language),
        chosen,
        rules,
        why,
        {path: _told(expression, dialect) for path, expression in maker.tells().items()},
        {step.path: _told(maker.active(step.index), dialect) for step in source.net.steps},
        code.at_rest,
        code.left_out.identifier if code.left_out is not None else None,
        tuple(code.data_types),
        _numbers(source, chosen, rules),
        code.flags,
        tuple(drive_block(drive, dialect, language) for drive in drives),
    )


_SEQUENCERS: dict[Construction, type[Sequencer]] = {
    Construction.FLIPFLOP: FlipFlopSequencer,
    Construction.CASE: CaseSequencer,
    Construction.REGIONS: RegionSequencer,
    Construction.BITS: BitSequencer,
}
_CHAINS: dict[Construction, type[FlipFlopChain | RegionChain | StepBits]] = {
    Construction.FLIPFLOP: FlipFlopChain,
    Construction.CASE: CaseChain,
    Construction.REGIONS: RegionChain,
    Construction.BITS: StepBits,
}
_GRAFCET_CHAINS: dict[Construction, type[FlipFlopChain | RegionChain | StepBits]] = {
    Construction.FLIPFLOP: GrafcetFlipFlops,
    Construction.CASE: GrafcetCase,
}


def _read(pou: Pou, chart: SfcNetwork, dialect: Dialect, rules: LoweringRules, project: Project) -> ChartSource:
    if rules.profile.graph_parameters:
        return read_sequencer(pou, chart, dialect, rules, project)
    if is_grafcet(chart, rules.profile):
        return read_grafcet(pou, dialect, rules.profile, names_of(project), project=project)
    return read_chart(pou, chart, dialect, rules.profile, names_of(project), project=project)


def _code(source: ChartSource, dialect: Dialect, rules: LoweringRules, language: Language, project: Project) -> Code:
    """Nothing yet, but all that is known of what it is for."""
    code = Code(Naming(dialect, [*source.names(), *names_in_conditions(rules, dialect)]))
    code.tool = tool_of(rules.target, dialect)
    code.known_types = {kind.name.casefold() for kind in project.data_types}
    code.texts = rules.texts
    code.instances = source.instances
    code.culture = rules.texts.culture if code.tool is Tool.S7 and has_networks(rules.target) else ""
    code.drawn, code.one_sheet = language is not Language.ST, has_one_sheet(rules.target)
    return code


def _memory(code: Code, language: Language) -> Memory:
    if language is Language.ST:
        return BitMemory(code)
    return OperandMemory(code) if code.tool is Tool.S7 else BlockMemory(code)


def _fill(maker: Sequencer | Chain, construction: Construction, style: Style) -> None:
    if style is Style.EXACT:
        maker.exact()
    elif isinstance(maker, FlipFlopChain | CaseChain):
        maker.classic()
    else:
        raise LoweringError(f"{construction} has no classic style")


def _numbers(source: ChartSource, construction: Construction, rules: LoweringRules) -> dict[str, int]:
    """The numbers of steps where they are states, or are selected by them."""
    if construction not in (Construction.CASE, Construction.REGIONS) and OperatingMode.SELECT not in rules.modes:
        return {}
    return dict(zip((step.path for step in source.net.steps), step_numbers(source.net), strict=True))


def _told(expression: Expression, dialect: Dialect) -> str:
    """What tells of a step, by bare names of variables, which are the same in files of other dialects."""

    def bare(node: Node) -> Node:
        return Name(node.identifier) if isinstance(node, Name) else node

    return print_node(transform(expression, bare), dialect)
