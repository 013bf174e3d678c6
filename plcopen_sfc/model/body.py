"""Bodies: the implementation of a POU, action, transition or macro-step in one of the languages of IEC 61131-3."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr, SerializationInfo, SerializerFunctionWrapHandler, model_serializer

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.model.base import FINGERPRINT, OWN_FINGERPRINT, Element
from plcopen_sfc.model.network import LogicNetwork
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.text import Text


class BodyBase(Element):
    """Common to all bodies. `worksheet` names the sheet where a POU has several bodies (TC6 2.0).

    `title` is that of a network of TIA Portal in a textual language; of graphical ones, see `LogicNetwork.title`.
    """

    worksheet: str | None = None
    title: Text | None = None


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


class FbdBody(BodyBase):
    """Function block diagram (FUP)."""

    language: Literal["FBD"] = "FBD"
    networks: list[LogicNetwork] = Field(default_factory=list)


class LdBody(BodyBase):
    """Ladder diagram (KOP)."""

    language: Literal["LD"] = "LD"
    networks: list[LogicNetwork] = Field(default_factory=list)


class SfcBody(BodyBase):
    """Sequential function chart (AS).

    A reader may leave the chart unread until it is first looked at (`deferred`): scripts mostly look at a few charts of
    a project. An unread chart cannot have been edited, which makes saving quick too.
    """

    language: Literal["SFC"] = "SFC"
    chart: SfcNetwork = Field(default_factory=SfcNetwork)

    _unread: Callable[[], SfcNetwork] | None = PrivateAttr(default=None)
    _digest: bytes | None = PrivateAttr(default=None)
    _home: tuple[str, bytes] | None = PrivateAttr(default=None)

    @classmethod
    def deferred(cls, fields: dict[str, Any], read: Callable[[], SfcNetwork]) -> SfcBody:
        """A body with `fields` whose chart `read` gives when somebody asks for it."""
        body = cls.model_validate(fields)
        body._unread = read
        del body.__dict__["chart"]
        return body

    @property
    def is_untouched(self) -> bool:
        """Whether the chart is as it was read: not looked at, or looked at and not changed. False if built by hand."""
        if "chart" not in self.__dict__:
            return True
        return self._digest is not None and self._digest == _digest(self.chart)

    def settle(self, name: str, content: bytes) -> None:
        """Remember that the body was read as `name` from the file `content`."""
        self._home = (name, content)

    def is_as_in(self, content: bytes, name: str) -> bool:
        """Whether the body was read as `name` from this very `content` and is untouched."""
        return self._home is not None and self._home[0] == name and self._home[1] is content and self.is_untouched

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            # Python calls this for what is not in the instance: the chart, as long as it is unread
            unread = self.__pydantic_private__["_unread"] if name == "chart" and self.__pydantic_private__ else None
            if unread is None:
                return super().__getattr__(name)
            with collector_paused():
                chart = self.__dict__["chart"] = unread()
                self._unread = None
                self._digest = _digest(chart)
            return chart

    def __eq__(self, other: object) -> bool:
        """Equal content, read or not; where the bodies were read from does not matter."""
        return isinstance(other, SfcBody) and self.chart == other.chart and self.__dict__ == other.__dict__

    __hash__ = None  # type: ignore[assignment]  # mutable, as every pydantic model

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        """A copy with a chart of its own."""
        self.read()
        return super().__deepcopy__(memo)

    def __getstate__(self) -> dict[Any, Any]:
        """What is pickled: the chart, not the file it may still stand in."""
        self.read()
        return super().__getstate__()

    def charts_read(self) -> Iterator[SfcNetwork]:
        """The chart and those of macro-steps and partial charts in it, but for charts that nobody has looked at."""
        waiting = [self.__dict__["chart"]] if "chart" in self.__dict__ else []
        while waiting:
            chart: SfcNetwork = waiting.pop()
            yield chart
            waiting += [partial.network for partial in chart.partial_charts]
            macros = [step.macro.body for step in chart.steps if step.macro is not None]
            waiting += [macro.__dict__["chart"] for macro in macros if macro and "chart" in macro.__dict__]

    def read(self) -> SfcNetwork:
        """The chart, read now if it was not yet."""
        return self.chart

    @model_serializer(mode="wrap")
    def _serialize(self, handler: SerializerFunctionWrapHandler, info: SerializationInfo) -> dict[str, Any]:
        if info.context in (FINGERPRINT, OWN_FINGERPRINT) and self.is_untouched:
            return {"untouched": self._home[0] if self._home is not None else True}
        self.read()
        content: dict[str, Any] = handler(self)
        return content


def _digest(chart: SfcNetwork) -> bytes:
    return hashlib.blake2b(chart.__pydantic_serializer__.to_json(chart, exclude_none=True)).digest()


class OpaqueBody(BodyBase):
    """A body in a form that the model does not know, kept as it came: `content` in the format named `source`."""

    language: Literal["opaque"] = "opaque"
    source: str
    content: str


Body = Annotated[StBody | IlBody | FbdBody | LdBody | SfcBody | OpaqueBody, Field(discriminator="language")]
"""A body in any language."""
