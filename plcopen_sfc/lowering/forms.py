"""What a chart can be lowered to: constructions, their styles, and the languages of the body."""

from __future__ import annotations

from enum import StrEnum


class Construction(StrEnum):
    """What a chart is lowered to.

    FLIPFLOP: a reset-dominant flip-flop for each step. CASE: one CASE on a state variable. REGIONS: one CASE
    for each part in which one step is active at a time. BITS: step bits in structured text. AUTO: the most readable of
    structured text that is exact.
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
