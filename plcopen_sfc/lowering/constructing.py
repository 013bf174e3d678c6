"""Choosing a construction, making the code of a chart, and putting it into a POU."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from plcopen_sfc.errors import LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.lowering.bits import StepBits
from plcopen_sfc.lowering.case import CaseChain, one_step_at_a_time
from plcopen_sfc.lowering.chain import Chain
from plcopen_sfc.lowering.code import Code
from plcopen_sfc.lowering.emitting import function_block_diagram, ladder_diagram, structured_text
from plcopen_sfc.lowering.flipflops import FlipFlopChain
from plcopen_sfc.lowering.graph.reading import read_sequencer
from plcopen_sfc.lowering.graph.sequencer import Sequencer
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.graph.surface import without_step_data
from plcopen_sfc.lowering.memory import BitMemory, BlockMemory, Memory
from plcopen_sfc.lowering.naming import Naming
from plcopen_sfc.lowering.reading import read_chart
from plcopen_sfc.lowering.regions import RegionChain, no_regions
from plcopen_sfc.lowering.restart import names_in_conditions
from plcopen_sfc.lowering.rules import LoweringRules
from plcopen_sfc.lowering.source import ChartSource
from plcopen_sfc.lowering.surroundings import names_of
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection


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
    that were added have these values, and the variable is FALSE.
    """

    pou: Pou
    construction: Construction
    why: str
    step_flags: dict[str, str]
    situation: dict[str, str]
    at_rest: dict[str, bool]
    left_out: str | None


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
    source: ChartSource | GraphSource
    if rules.profile.graph_parameters:
        source = read_sequencer(pou, chart, dialect, rules)
        chosen, why = _choice_for_sequencer(construction)
        pou = without_step_data(pou)
    else:
        source = read_chart(pou, chart, dialect, rules.profile)
        chosen, why = _choice(source, construction)
    if language is None:
        language = Language.FBD if chosen is Construction.FLIPFLOP else Language.ST
    if language is not Language.ST and chosen is not Construction.FLIPFLOP:
        raise LoweringError(f"{chosen} is structured text, it cannot be drawn in {language}")
    surroundings = names_of(project) if project is not None else set()
    code = Code(Naming(dialect, [*source.names(), *names_in_conditions(rules, dialect)]))
    memory: Memory = BitMemory(code) if language is Language.ST else BlockMemory(code)
    makers: dict[Construction, type[FlipFlopChain | RegionChain | StepBits]] = {
        Construction.FLIPFLOP: FlipFlopChain,
        Construction.CASE: CaseChain,
        Construction.REGIONS: RegionChain,
        Construction.BITS: StepBits,
    }
    maker: Sequencer | Chain
    if isinstance(source, GraphSource):
        maker = Sequencer(source, code, memory, rules, surroundings)
    else:
        maker = makers[chosen](source, code, memory, rules, surroundings)
    if style is Style.EXACT:
        maker.exact()
    elif isinstance(maker, FlipFlopChain | CaseChain):
        maker.classic()
    else:
        raise LoweringError(f"{chosen} has no classic style")
    tells = {path: print_node(expression, dialect) for path, expression in maker.tells().items()}
    situation = {step.path: print_node(maker.active(step.index), dialect) for step in source.net.steps}
    left_out = code.left_out.identifier if code.left_out is not None else None
    return Constructed(_pou(pou, code, dialect, language), chosen, why, tells, situation, code.at_rest, left_out)


def _choice(source: ChartSource, wanted: Construction) -> tuple[Construction, str]:
    if wanted is not Construction.AUTO:
        return wanted, "asked for"
    several = one_step_at_a_time(source)
    if not several:
        return Construction.CASE, "exactly one step is active at a time"
    objection = no_regions(source)
    if not objection:
        return Construction.REGIONS, f"in each of its parts one step is active at a time, but {several}"
    return Construction.BITS, f"no CASE can hold the chart: {objection}"


def _choice_for_sequencer(wanted: Construction) -> tuple[Construction, str]:
    if wanted not in (Construction.AUTO, Construction.BITS):
        raise LoweringError(f"sequencers of S7-GRAPH are lowered to {Construction.BITS} only")
    return Construction.BITS, "asked for" if wanted is Construction.BITS else "the chart is a sequencer of S7-GRAPH"


def _pou(original: Pou, code: Code, dialect: Dialect, language: Language) -> Pou:
    interface = original.interface.model_copy(deep=True) if original.interface is not None else Interface()
    interface.declaration = None
    if code.inputs:
        interface.sections.append(VariableSection(kind=SectionKind.INPUT, variables=code.inputs))
    if code.variables:
        interface.sections.append(VariableSection(kind=SectionKind.LOCAL, variables=code.variables))
    declared = interface.variables()
    body: Body
    if language is Language.ST:
        body = structured_text(code, dialect)
    elif language is Language.FBD:
        body = function_block_diagram(code, dialect, declared)
    else:
        body = ladder_diagram(code, dialect, declared)
    lowered = original.model_copy(deep=True, update={"bodies": [], "object_id": None})
    lowered.interface = interface
    lowered.bodies = [body, *(b for b in original.bodies if not isinstance(b, SfcBody))]
    return lowered
