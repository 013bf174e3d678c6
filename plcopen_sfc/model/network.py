"""Graphical logic: networks of FBD and LD elements.

IEC 61131-3 ed. 3, 8.2 and 8.3; the common, fbd and ld objects of TC6 2.01.
Wires belong to their consumer: an input pin lists the outputs it is connected to.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Field

from plcopen_sfc.model.base import Element, ElementId, ExtensionData, Model
from plcopen_sfc.model.text import Text

Point = tuple[float, float]
"""A place in a drawing: x to the right, y down, in the units of the project's scaling."""


class Connection(Model):
    """A wire from output `pin` of element `source`, which may be a step, to the input that holds this connection.

    `pin` None means the element's only output; `points` run from the input to the output and include both ends.
    """

    source: ElementId
    pin: str | None = None
    points: list[Point] = Field(default_factory=list)
    global_id: str | None = None
    extension_data: ExtensionData | None = None


class InputPin(Model):
    """End of wires. `position` is relative to the element; `expression` may replace wires."""

    connections: list[Connection] = Field(default_factory=list)
    expression: str | None = None
    position: Point | None = None
    global_id: str | None = None
    extension_data: ExtensionData | None = None


class OutputPin(Model):
    """Start of wires. `name` distinguishes several outputs of an element."""

    name: str | None = None
    expression: str | None = None
    position: Point | None = None
    global_id: str | None = None
    extension_data: ExtensionData | None = None


class Edge(StrEnum):
    """Edge detection at a pin or contact."""

    NONE = "none"
    RISING = "rising"
    FALLING = "falling"


class Storage(StrEnum):
    """Set or reset behaviour of a coil or pin."""

    NONE = "none"
    SET = "set"
    RESET = "reset"


class NodeBase(Element):
    """An element of a network. `position` is that of its top left corner.

    `local_id` is the id in the file where another element has it too.
    """

    id: ElementId
    local_id: int | None = None
    position: Point = (0, 0)
    width: float | None = None
    height: float | None = None
    execution_order: int | None = None


class BlockVariable(Element):
    """A parameter of a block call: an input, an output or an in-out with both pins."""

    name: str
    input: InputPin | None = None
    output: OutputPin | None = None
    negated: bool = False
    edge: Edge = Edge.NONE
    storage: Storage = Storage.NONE
    hidden: bool = False


class BlockParameters(Model):
    """The parameters of a block by direction, in the order drawn."""

    inputs: list[BlockVariable] = Field(default_factory=list)
    in_outs: list[BlockVariable] = Field(default_factory=list)
    outputs: list[BlockVariable] = Field(default_factory=list)


class BlockCall(StrEnum):
    """Kind of what a block calls, where the file states it (CODESYS ``fbdcalltype``)."""

    OPERATOR = "operator"
    FUNCTION = "function"
    FUNCTION_BLOCK = "functionblock"
    PROGRAM = "program"
    ACTION = "action"
    METHOD = "method"
    EXECUTE = "execute"


class Block(NodeBase):
    """A call of a function, an operator or a function block instance. `code` is the text of a CODESYS EXECUTE box."""

    kind: Literal["block"] = "block"
    type_name: str
    instance: str | None = None
    parameters: BlockParameters = Field(default_factory=BlockParameters)
    call: BlockCall | None = None
    code: str | None = None


class ModifiedNode(NodeBase):
    """An element that can invert, watch for an edge of, or store what passes through it."""

    negated: bool = False
    edge: Edge = Edge.NONE
    storage: Storage = Storage.NONE


class InputVariable(ModifiedNode):
    """An expression that feeds a wire (TC6 ``inVariable``)."""

    kind: Literal["input"] = "input"
    expression: str
    output: OutputPin | None = None


class OutputVariable(ModifiedNode):
    """A variable that a wire is written to (TC6 ``outVariable``)."""

    kind: Literal["output"] = "output"
    expression: str
    input: InputPin | None = None


class InOutVariable(NodeBase):
    """A variable that is written and passed on (TC6 ``inOutVariable``)."""

    kind: Literal["inOut"] = "inOut"
    expression: str
    input: InputPin | None = None
    output: OutputPin | None = None
    negated_in: bool = False
    edge_in: Edge = Edge.NONE
    storage_in: Storage = Storage.NONE
    negated_out: bool = False
    edge_out: Edge = Edge.NONE
    storage_out: Storage = Storage.NONE


class Contact(ModifiedNode):
    """A contact of a ladder diagram."""

    kind: Literal["contact"] = "contact"
    variable: str
    input: InputPin | None = None
    output: OutputPin | None = None


class Coil(ModifiedNode):
    """A coil of a ladder diagram."""

    kind: Literal["coil"] = "coil"
    variable: str
    input: InputPin | None = None
    output: OutputPin | None = None


class LeftPowerRail(NodeBase):
    """The left power rail, always TRUE."""

    kind: Literal["leftPowerRail"] = "leftPowerRail"
    outputs: list[OutputPin] = Field(default_factory=list)


class RightPowerRail(NodeBase):
    """The right power rail."""

    kind: Literal["rightPowerRail"] = "rightPowerRail"
    inputs: list[InputPin] = Field(default_factory=list)


class Jump(NodeBase):
    """A jump to a label of the same body, taken when its input is TRUE."""

    kind: Literal["jump"] = "jump"
    label: str
    input: InputPin | None = None


class Label(NodeBase):
    """The target of jumps."""

    kind: Literal["label"] = "label"
    label: str


class Return(NodeBase):
    """A conditional return from the POU."""

    kind: Literal["return"] = "return"
    input: InputPin | None = None


class Connector(NodeBase):
    """The end of a wire that goes on at the `Continuation` of the same name."""

    kind: Literal["connector"] = "connector"
    name: str
    input: InputPin | None = None


class Continuation(NodeBase):
    """The start of a wire that ended at the `Connector` of the same name."""

    kind: Literal["continuation"] = "continuation"
    name: str
    output: OutputPin | None = None


class CommentBox(NodeBase):
    """A text in the drawing."""

    kind: Literal["comment"] = "comment"
    content: Text


class ErrorBox(NodeBase):
    """A text that an importing tool left where it could not convert something."""

    kind: Literal["error"] = "error"
    content: Text


class VendorElement(NodeBase):
    """An element that only its tool understands (TC6 2.0). CODESYS marks the start of a network with one.

    `element_type` and `attributes` are the CODESYS meaning of it (``networktitle``).
    """

    kind: Literal["vendorElement"] = "vendorElement"
    alternative_text: Text
    parameters: BlockParameters | None = None
    element_type: str | None = None
    attributes: dict[str, str] = Field(default_factory=dict)


Node = Annotated[
    Block
    | InputVariable
    | OutputVariable
    | InOutVariable
    | Contact
    | Coil
    | LeftPowerRail
    | RightPowerRail
    | Jump
    | Label
    | Return
    | Connector
    | Continuation
    | CommentBox
    | ErrorBox
    | VendorElement,
    Field(discriminator="kind"),
]
"""Any element of an FBD or LD network."""


class LogicNetwork(Element):
    """A network: a rung, a TIA network, or the whole sheet of a TC6 body (TC6 does not divide a body into networks)."""

    title: Text | None = None
    nodes: list[Node] = Field(default_factory=list)
