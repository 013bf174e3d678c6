"""Conditions: of transitions, interlocks, supervisions and conditional actions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from plcopen_sfc.model.base import ExtensionData, Model
from plcopen_sfc.model.network import InputPin

if TYPE_CHECKING:
    from plcopen_sfc.model.body import Body


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


class BodyCondition(Model):
    """A condition programmed in place as a body: LD, FBD, IL, or ST that is more than an expression."""

    kind: Literal["body"] = "body"
    body: Body
    name: str = ""
    negated: bool = False


class WiredCondition(Model):
    """A wire from the logic that is drawn in the chart (`SfcNetwork.logic`), or from a step."""

    kind: Literal["wired"] = "wired"
    input: InputPin
    negated: bool = False


def _expression(value: Any) -> Any:
    return {"kind": "expression", "text": value} if isinstance(value, str) else value


Condition = Annotated[
    Annotated[Expression | NamedCondition | BodyCondition | WiredCondition, Field(discriminator="kind")],
    BeforeValidator(_expression),
]
"""Any condition. In Python a plain string is an expression: ``transition.condition = "Start AND NOT Fault"``."""
