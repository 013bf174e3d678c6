"""Choosing a construction, making the code of a chart, and putting it into a POU."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import print_node, transform
from plcopen_sfc.languages.st.nodes import Expression, Name, Node, Quoting
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.lowering.actions.drive import DriveBlock
from plcopen_sfc.lowering.chains.bits import StepBits
from plcopen_sfc.lowering.chains.case import CaseChain, one_step_at_a_time
from plcopen_sfc.lowering.chains.chain import Chain
from plcopen_sfc.lowering.chains.flipflops import FlipFlopChain
from plcopen_sfc.lowering.chains.regions import RegionChain, no_regions
from plcopen_sfc.lowering.chains.restart import names_in_conditions
from plcopen_sfc.lowering.chains.rivals import firing_together
from plcopen_sfc.lowering.code.emitting import function_block_diagram, ladder_diagram, structured_text
from plcopen_sfc.lowering.code.flag_places import LOCAL, FlagPlaces
from plcopen_sfc.lowering.code.flattening import flatten
from plcopen_sfc.lowering.code.memory import BitMemory, BlockMemory, Memory
from plcopen_sfc.lowering.code.naming import Naming
from plcopen_sfc.lowering.code.program import Code
from plcopen_sfc.lowering.code.s7_memory import OperandMemory
from plcopen_sfc.lowering.code.surroundings import names_of
from plcopen_sfc.lowering.code.targets import has_networks, has_one_sheet, tool_of
from plcopen_sfc.lowering.grafcet.case import GrafcetCase, no_case
from plcopen_sfc.lowering.grafcet.classic import plain_chart
from plcopen_sfc.lowering.grafcet.flipflops import GrafcetFlipFlops
from plcopen_sfc.lowering.grafcet.reading import is_grafcet, read_grafcet
from plcopen_sfc.lowering.grafcet.scan import add_grafcet
from plcopen_sfc.lowering.graph.flipflops import FlipFlopSequencer
from plcopen_sfc.lowering.graph.reading import read_sequencer
from plcopen_sfc.lowering.graph.sequencer import Sequencer
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.graph.surface import without_step_data
from plcopen_sfc.lowering.reading.chart import read_chart
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.rules import ActionPlace, LoweringRules, OperatingMode, States
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.types import DataTypeDeclaration, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.semantics.profile import Profile


class Construction(StrEnum):
    """What a chart is lowered to.

    FLIPFLOP: a reset-dominant flip-flop for each step. CASE: one CASE on a state variable. REGIONS: one
    CASE for each part in which one step is active at a time. BITS: step bits in
    structured text. AUTO: the most readable of structured text that is exact.
    """

    FLIPFLOP = "flipflop"
    CASE = "case"
    REGIONS = "regions"
    BITS = "bits"
    AUTO = "auto"


class Style(StrEnum):
    """EXACT: does what the chart does. CLASSIC: the textbook form, which does not quite."""

    EXACT = "exact"
    CLASSIC = "classic"


class Language(StrEnum):
    """The language of the body that is made."""

    ST = "ST"
    FBD = "FBD"
    LD = "LD"


@dataclass(frozen=True)
class Constructed:
    """A POU made of a chart. `why` says why this construction was taken.

    `step_flags` is what tells in its code that a step is active, by the path of the step; `situation` what does between
    two scans, where that is not the same. `at_rest` and `left_out` say when it does what the chart does: while inputs
    that were added have these values, and the variable is FALSE. `data_types` are what the project needs besides.
    """

    pou: Pou
    construction: Construction
    why: str
    step_flags: dict[str, str]
    situation: dict[str, str]
    at_rest: dict[str, bool]
    left_out: str | None
    data_types: tuple[DataTypeDeclaration, ...]
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
    surroundings = names_of(project) if project is not None else set()
    source: ChartSource | GraphSource
    if rules.profile.graph_parameters:
        source = read_sequencer(pou, chart, dialect, rules, project)
        chosen, why = _choice_for_sequencer(construction)
        pou = without_step_data(pou)
    elif is_grafcet(chart, rules.profile):
        source = read_grafcet(pou, dialect, rules.profile, surroundings, project=project)
        chosen, why = _choice_for_grafcet(source, construction, rules.profile)
    else:
        source = read_chart(pou, chart, dialect, rules.profile, surroundings, project=project)
        chosen, why = _choice(source, construction, rules, style=style, language=language)
    if language is None:
        drawn = chosen is Construction.FLIPFLOP and has_networks(rules.target)
        language = Language.FBD if drawn else Language.ST
    if language is not Language.ST and not has_networks(rules.target):
        raise LoweringError(
            f"{rules.target} is structured text and has no networks of {language}",
            location=Location(path=pou.name),
            hint="Flip-flops can be written as structured text too: language ST.",
        )
    if language is not Language.ST and chosen is not Construction.FLIPFLOP:
        raise LoweringError(f"{chosen} is structured text, it cannot be drawn in {language}")
    if rules.states is not States.NUMBERS and chosen not in (Construction.CASE, Construction.REGIONS):
        raise LoweringError(
            f"{chosen} has no states that could be written as {rules.states}",
            location=Location(path=pou.name),
            hint=f"It was taken for this reason: {why}.",
        )
    code = Code(Naming(dialect, [*source.names(), *names_in_conditions(rules, dialect)]))
    code.tool = tool_of(rules.target, dialect)
    code.known_types = {kind.name.casefold() for kind in project.data_types} if project is not None else ()
    code.pulse = rules.texts.pulse
    code.culture = rules.texts.culture if code.tool is Tool.S7 and has_networks(rules.target) else ""
    code.drawn, code.one_sheet = language is not Language.ST, has_one_sheet(rules.target)
    memory = _memory(code, language)
    if rules.actions is ActionPlace.BLOCK and (
        is_grafcet(chart, rules.profile) or (style is Style.CLASSIC and chosen is Construction.CASE)
    ):
        raise LoweringError(
            "actions cannot stand in a block of their own where they are a part of each evolution, or of a CASE",
            location=Location(path=pou.name),
        )
    if rules.flags != LOCAL:
        if chosen not in (Construction.FLIPFLOP, Construction.BITS):
            raise LoweringError(
                "only flip-flops and step bits have flags that could be put elsewhere",
                location=Location(path=pou.name),
            )
        code.flags = FlagPlaces(rules, pou.name, project or Project(dialect=dialect), code.tool)
    makers: dict[Construction, type[FlipFlopChain | RegionChain | StepBits]] = {
        Construction.FLIPFLOP: FlipFlopChain,
        Construction.CASE: CaseChain,
        Construction.REGIONS: RegionChain,
        Construction.BITS: StepBits,
    }
    maker: Sequencer | Chain
    if isinstance(source, GraphSource):
        sequencer = FlipFlopSequencer if chosen is Construction.FLIPFLOP else Sequencer
        maker = sequencer(source, code, memory, rules, surroundings)
    else:
        if style is Style.CLASSIC:
            source = plain_chart(source)
        if source.grafcet is not None:
            makers[Construction.FLIPFLOP], makers[Construction.CASE] = GrafcetFlipFlops, GrafcetCase
        maker = makers[chosen](source, code, memory, rules, surroundings)
    if isinstance(maker, Chain) and maker.source.grafcet is not None:
        add_grafcet(maker, drawn=language is not Language.ST)
    elif style is Style.EXACT:
        maker.exact()
    elif isinstance(maker, FlipFlopChain | CaseChain):
        maker.classic()
    else:
        raise LoweringError(f"{chosen} has no classic style")
    if code.needs_flat_statements:
        flatten(code, pou.interface.variables() if pou.interface is not None else ())
    tells = {path: _told(expression, dialect) for path, expression in maker.tells().items()}
    situation = {step.path: _told(maker.active(step.index), dialect) for step in source.net.steps}
    left_out = code.left_out.identifier if code.left_out is not None else None
    made = _pou(pou, code, dialect, language)
    drive = maker.drive if isinstance(maker, Chain) else None
    blocks = (_drive_block(drive, dialect, language),) if drive is not None else ()
    return Constructed(
        made, chosen, why, tells, situation, code.at_rest, left_out, tuple(code.data_types), code.flags, blocks
    )


def _told(expression: Expression, dialect: Dialect) -> str:
    """What tells of a step, by bare names of variables, which are the same in files of other dialects."""

    def bare(node: Node) -> Node:
        return Name(node.identifier) if isinstance(node, Name) and node.quoting is Quoting.LOCAL else node

    return print_node(transform(expression, bare), dialect)


def _memory(code: Code, language: Language) -> Memory:
    if language is Language.ST:
        return BitMemory(code)
    return OperandMemory(code) if code.tool is Tool.S7 else BlockMemory(code)


def _choice(
    source: ChartSource, wanted: Construction, rules: LoweringRules, *, style: Style, language: Language | None
) -> tuple[Construction, str]:
    if wanted is not Construction.AUTO:
        return wanted, "asked for"
    if language not in (None, Language.ST):
        return Construction.FLIPFLOP, f"flip-flops are what {language} can hold"
    several = one_step_at_a_time(source)
    if style is Style.CLASSIC and several:
        return Construction.FLIPFLOP, f"textbooks have flip-flops for it: {several}"
    if rules.flags != LOCAL and style is Style.EXACT:
        return Construction.BITS, f"there are to be step flags at {rules.flags}"
    if firing_together(source.net, rules.profile) is not None:
        why = f"rivals fire together under the profile {rules.profile.name}"
        return Construction.BITS, f"no CASE can hold the chart: {why}"
    if not several:
        ends = any(not transition.targets for transition in source.net.transitions)
        return Construction.CASE, f"{'at most' if ends else 'exactly'} one step is active at a time"
    if OperatingMode.SELECT in rules.modes:
        return Construction.BITS, f"steps are to be selected, and several can be active: {several}"
    objection = no_regions(source)
    if not objection:
        return Construction.REGIONS, f"in each of its parts one step is active at a time, but {several}"
    return Construction.BITS, f"no CASE can hold the chart: {objection}"


def _choice_for_grafcet(source: ChartSource, wanted: Construction, profile: Profile) -> tuple[Construction, str]:
    if wanted is not Construction.AUTO:
        return wanted, "asked for"
    objection = no_case(source, profile)
    if objection:
        return Construction.BITS, f"no CASE can hold the chart: {objection}"
    return Construction.CASE, "one step is active at a time"


def _choice_for_sequencer(wanted: Construction) -> tuple[Construction, str]:
    if wanted is Construction.AUTO:
        return Construction.BITS, "the chart is a sequencer of S7-GRAPH, whose steps can be switched by hand"
    if wanted not in (Construction.BITS, Construction.FLIPFLOP):
        raise LoweringError(f"{wanted} cannot hold sequencers of S7-GRAPH: several steps can be active, or none")
    return wanted, "asked for"


def _pou(original: Pou, code: Code, dialect: Dialect, language: Language) -> Pou:
    interface = original.interface.model_copy(deep=True) if original.interface is not None else Interface()
    interface.declaration = None
    _declare(interface, SectionKind.INPUT, code.inputs)
    _declare(interface, SectionKind.OUTPUT, code.outputs)
    _declare(interface, SectionKind.LOCAL, code.variables)
    _declare(interface, SectionKind.LOCAL, code.constants, constant=True)  # behind the variables, as in TIA Portal
    _declare(interface, SectionKind.EXTERNAL, code.flags.external if code.flags is not None else [])
    body = _body(code, dialect, language, interface.variables())
    lowered = original.model_copy(deep=True, update={"bodies": [], "object_id": None})
    lowered.interface = interface
    lowered.bodies = [body, *(b for b in original.bodies if not isinstance(b, SfcBody))]
    return lowered


def _body(code: Code, dialect: Dialect, language: Language, declared: list[Variable]) -> Body:
    if language is Language.ST:
        return structured_text(code, dialect)
    if language is Language.FBD:
        return function_block_diagram(code, dialect, declared)
    return ladder_diagram(code, dialect, declared)


def _drive_block(drive: DriveBlock, dialect: Dialect, language: Language) -> Pou:
    body = _body(drive.code, dialect, language, drive.interface.variables())
    return Pou(name=drive.name, kind=PouKind.FUNCTION_BLOCK, interface=drive.interface, bodies=[body])


def _declare(interface: Interface, kind: SectionKind, variables: list[Variable], *, constant: bool = False) -> None:
    """Declare variables where others of their kind are: a block of TIA Portal has each section once."""
    if not variables:
        return
    plain = VariableSection(kind=kind, constant=constant)
    for section in interface.sections:
        if all(getattr(section, name) == getattr(plain, name) for name in _ATTRIBUTES):
            section.variables += variables
            section.declaration = None
            return
    plain.variables = variables
    interface.sections.append(plain)


_ATTRIBUTES = ("kind", "name", "constant", "retain", "nonretain", "persistent", "nonpersistent")
