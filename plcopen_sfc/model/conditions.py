"""Conditions of transitions, interlocks, supervisions and conditional actions, but for those that are bodies."""

from __future__ import annotations

from typing import Literal

from plcopen_sfc.model.base import ExtensionData, Model
from plcopen_sfc.model.network import InputPin


class Expression(Model):
    """A Boolean expression as text, in the ST dialect of its project; `markup` as in `StBody`."""

    kind: Literal["expression"] = "expression"
    text: str
    negated: bool = False
    markup: str | None = None
    extension_data: ExtensionData | None = None


class NamedCondition(Model):
    """A reference to a transition object of the POU (`Pou.transitions`) by its name."""

    kind: Literal["named"] = "named"
    name: str
    negated: bool = False


class WiredCondition(Model):
    """A wire from the logic that is drawn in the chart (`SfcNetwork.logic`), or from a step."""

    kind: Literal["wired"] = "wired"
    input: InputPin
    negated: bool = False
