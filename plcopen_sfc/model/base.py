"""Base classes of the objects of the model."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from plcopen_sfc.model.checked import Checked
from plcopen_sfc.model.text import Text


class Model(Checked):
    """Base of all model objects.

    Structure that is broken (a transition to nowhere, two initial steps) can be built and looked at; a value of the
    wrong type cannot: that is a `ModelError`.
    """


class UnknownDataRule(StrEnum):
    """Handling of foreign data by a tool that does not know it (TC6 2.0 ``handleUnknown``)."""

    PRESERVE = "preserve"
    DISCARD = "discard"
    IMPLEMENTATION = "implementation"


class ForeignData(Model):
    """A piece of data of another tool, kept unchanged (TC6 ``addData/data``).

    `name` is the URI of its owner, `content` the markup as text.
    """

    name: str
    rule: UnknownDataRule = UnknownDataRule.PRESERVE
    content: str = ""


class ExtensionData(Model):
    """Content of an object's element in its file that the model has no field for. Never dropped silently."""

    data: list[ForeignData] = Field(default_factory=list)
    attributes: dict[str, str] = Field(default_factory=dict)
    elements: list[str] = Field(default_factory=list)


class Element(Model):
    """An object that a person can comment and a tool can attach data to."""

    comment: Text | None = None
    global_id: str | None = None
    extension_data: ExtensionData | None = None


ElementId = Annotated[int, Field(ge=0)]
"""Identifies a step, a transition, an association or a drawn element within one network. Never shown to people."""
