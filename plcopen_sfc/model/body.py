"""Bodies in ST, IL, FBD and LD: the implementation of a POU, action, transition or macro-step.

Those with a chart, and the type of any body, are in `plcopen_sfc.model.sfc`: charts hold bodies too.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Literal, Self

from pydantic import Field, PrivateAttr

from plcopen_sfc.model.base import Element
from plcopen_sfc.model.network import LogicNetwork
from plcopen_sfc.model.owners import Owned
from plcopen_sfc.model.text import Text
from plcopen_sfc.operations import provided


class BodyBase(Owned, Element):
    """Common to all bodies. `worksheet` names the sheet where a POU has several bodies (TC6 2.0).

    `title` is that of a network of TIA Portal in a textual language; of graphical ones, see `LogicNetwork.title`.
    """

    worksheet: str | None = None
    title: Text | None = None

    _bound: Any = PrivateAttr(default=None)
    """The bound names of the body (`languages.binding.bind`). They live as long as the body, and are not copied."""

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        """Return a copy that has no bound names yet."""
        with self._without_bound():
            return super().__deepcopy__(memo)

    def __getstate__(self) -> dict[Any, Any]:
        """Return the body for a pickle."""
        with self._without_bound():
            return super().__getstate__()

    @contextmanager
    def _without_bound(self) -> Iterator[None]:
        bound, self._bound = self._bound, None
        try:
            yield
        finally:
            self._bound = bound


class StBody(BodyBase):
    """Structured text. `markup` is the XHTML of the file where it is more than the text in its usual element."""

    language: Literal["ST"] = "ST"
    text: str = ""
    markup: str | None = None


class IlBody(BodyBase):
    """Instruction list, as text; `markup` as in `StBody`."""

    language: Literal["IL"] = "IL"
    text: str = ""
    markup: str | None = None


class _Drawable:
    """A body that is a drawing."""

    def to_svg(self, *, theme: str = "light") -> str:
        """Draw the networks: the text of an SVG file.

        `theme` is ``light``, ``dark`` or ``print`` (black on white). Raises `ModelError` for any other.
        """
        picture: str = provided("body_svg")(self, theme)
        return picture

    def _repr_svg_(self) -> str:
        """Show the networks in Jupyter."""
        return self.to_svg()


class FbdBody(BodyBase, _Drawable):
    """Function block diagram (FUP)."""

    language: Literal["FBD"] = "FBD"
    networks: list[LogicNetwork] = Field(default_factory=list)


class LdBody(BodyBase, _Drawable):
    """Ladder diagram (KOP)."""

    language: Literal["LD"] = "LD"
    networks: list[LogicNetwork] = Field(default_factory=list)


class OpaqueBody(BodyBase):
    """A body in a form that the model does not know, kept as it came: `content` in the format named `source`."""

    language: Literal["opaque"] = "opaque"
    source: str
    content: str


def networks_of(body: object) -> list[LogicNetwork]:
    """Return the networks of a body in FBD or LD; none of anything else."""
    return body.networks if isinstance(body, FbdBody | LdBody) else []


def has_program(body: BodyBase | None) -> bool:
    """True unless a body is empty, as those of permanent instructions without a program."""
    if isinstance(body, FbdBody | LdBody):
        return any(network.nodes for network in body.networks)
    # a body of any other kind has no text: a chart, or what no reader understands, which is executed all the same
    return body is not None and bool(getattr(body, "text", "?").strip())
