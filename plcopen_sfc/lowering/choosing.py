"""Which construction a chart gets, and which options that can have."""

from __future__ import annotations

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.lowering.chains.case import one_step_at_a_time
from plcopen_sfc.lowering.chains.regions import no_regions
from plcopen_sfc.lowering.chains.rivals import firing_together
from plcopen_sfc.lowering.code.flag_places import LOCAL
from plcopen_sfc.lowering.code.targets import has_networks, shows_networks
from plcopen_sfc.lowering.forms import Construction, Language, Style
from plcopen_sfc.lowering.grafcet.case import no_case
from plcopen_sfc.lowering.graph.sequences import ON_BY_HAND, on_by_hand, one_sequence, sequences, with_hands_off
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.reading.source import ChartSource
from plcopen_sfc.lowering.rules import ActionPlace, LoweringRules, States


def choose(
    source: ChartSource,
    wanted: Construction,
    rules: LoweringRules,
    *,
    style: Style,
    language: Language | None,
) -> tuple[Construction, Language, str]:
    """The construction, its language, and why it was taken.

    Raises `LoweringError` where the construction has no such language, or none of the options that were asked for.
    """
    place = Location(path=source.pou.name)
    if isinstance(source, GraphSource):
        _check_options_of_sequencer(rules, place)
        chosen, why = _choice_for_sequencer(source, wanted, rules, language)
    elif rules.at_rest:
        raise LoweringError("only blocks of S7-GRAPH have parameters that could be at rest", location=place)
    elif source.grafcet is not None:
        chosen, why = _choice_for_grafcet(source, wanted, rules)
    else:
        chosen, why = _choice(source, wanted, rules, style=style, language=language)
    if language is None:
        drawn = chosen is Construction.FLIPFLOP and shows_networks(rules.target)
        language = Language.FBD if drawn else Language.ST
    if language is not Language.ST and not has_networks(rules.target):
        raise LoweringError(
            f"{rules.target} is structured text and has no networks of {language}",
            location=place,
            hint="Flip-flops can be written as structured text too: language ST.",
        )
    if language is not Language.ST and chosen is not Construction.FLIPFLOP:
        raise LoweringError(f"{chosen} is structured text, it cannot be drawn in {language}", location=place)
    if rules.states is not States.NUMBERS and chosen not in (Construction.CASE, Construction.REGIONS):
        raise LoweringError(
            f"{chosen} has no states that could be written as {rules.states}",
            location=place,
            hint=f"It was taken for this reason: {why}.",
        )
    if rules.actions is ActionPlace.BLOCK and style is Style.CLASSIC and chosen is Construction.CASE:
        raise LoweringError(
            "actions cannot stand in a block of their own where they are a part of a CASE", location=place
        )
    if rules.flags != LOCAL and chosen not in (Construction.FLIPFLOP, Construction.BITS):
        raise LoweringError("only flip-flops and step bits have flags that could be put elsewhere", location=place)
    return chosen, language, why


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
    objection = no_regions(source)
    if not objection:
        return Construction.REGIONS, f"in each of its parts one step is active at a time, but {several}"
    return Construction.BITS, f"no CASE can hold the chart: {objection}"


def _choice_for_grafcet(source: ChartSource, wanted: Construction, rules: LoweringRules) -> tuple[Construction, str]:
    if wanted is not Construction.AUTO:
        return wanted, "asked for"
    if rules.flags != LOCAL:
        return Construction.BITS, f"there are to be step flags at {rules.flags}"
    objection = no_case(source, rules.profile)
    if objection:
        return Construction.BITS, f"no CASE can hold the chart: {objection}"
    return Construction.CASE, "one step is active at a time"


def _choice_for_sequencer(
    source: GraphSource, wanted: Construction, rules: LoweringRules, language: Language | None
) -> tuple[Construction, str]:
    if wanted is not Construction.AUTO:
        return wanted, "asked for"
    if language not in (None, Language.ST):
        return Construction.FLIPFLOP, f"flip-flops are what {language} can hold"
    if rules.flags != LOCAL:
        return Construction.BITS, f"there are to be step flags at {rules.flags}"
    several = one_sequence(source, rules.profile)
    if not isinstance(several, str):
        return Construction.CASE, "at most one step is active at a time"
    objection = sequences(source, rules.profile)
    if not isinstance(objection, str):
        return Construction.REGIONS, f"in each of its parts at most one step is active at a time, but {several}"
    why = f"no CASE can hold the chart: {objection}"
    if on_by_hand(source) and not isinstance(sequences(with_hands_off(source), rules.profile), str):
        why += f"; with {ON_BY_HAND} at rest one could"
    return Construction.BITS, why


def _check_options_of_sequencer(rules: LoweringRules, place: Location) -> None:
    """Refuse options that sequencers do not have."""
    hint = ""
    if rules.modes:
        objection = "sequencers of S7-GRAPH have operating modes of their own"
        hint = "Declare SW_AUTO, SW_MAN, SW_TAP, SW_TOP, T_PUSH, S_SEL, S_ON or S_OFF in the block instead."
    elif rules.actions is not ActionPlace.INLINE:
        objection = "actions of a sequencer of S7-GRAPH cannot stand in a block of their own"
    elif rules.reset_actions:
        objection = "S in S7-GRAPH sets an operand that anything may reset: only R of the chart ends it"
    else:
        return
    raise LoweringError(objection, location=place, hint=hint)
