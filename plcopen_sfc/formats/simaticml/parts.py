"""What TIA Portal calls the elements of LAD and FBD networks."""

from __future__ import annotations

from functools import lru_cache

from plcopen_sfc.languages.standard_blocks import S7_CONVERTED, StandardBlock, Tool, standard_block

RAIL = 0
"""The id of the power rail; those of other elements are their ``UId``, which begin at 21."""
RESULTS = ("TrCoil", "IlCoil", "SvCoil")
"""The coils in which the networks of transitions, interlocks and supervisions end."""
COILS = {"Coil": "none", "SCoil": "set", "RCoil": "reset"}
CARDINALITIES = ("Card", "card")
CONVERT = "Convert"
"""The box of all conversions: its types tell which."""
COUNTED = ("A", "O", "X")
"""Boxes that say nothing of themselves but how many inputs they have."""
LISTS = ("AutomaticTyped", "Invisible")
"""Lists of names in a ``Part``: types that follow from the operands, pins that are not shown. Carried with commas."""
PART_NAME = "Part"
"""Carried attribute of a block: the name of its part, where that is another than TIA Portal has for the block."""
INVERTED = "Negated"
"""Carried attribute of a NOT that stands for the negated input of the coil behind it, as FBD draws it."""
CALL_MARKS = {"BlockNumber": "IntegerAttribute", "ParameterModifiedTS": "DateAttribute"}
"""What ``CallInfo`` says about the called block for information."""
CALLS = {"FB": "functionblock", "FC": "function"}


@lru_cache(maxsize=1024)
def part_block(name: str) -> StandardBlock | None:
    """The standard block that TIA Portal calls `name`, spelled just so."""
    block = standard_block(name, Tool.S7)
    if block is None or s7_name(block) != name:
        return None
    return block


def converting_block(source: str, target: str) -> StandardBlock | None:
    """The conversion that a ``Convert`` is between these types, which it spells just so; None where it is another."""
    if S7_CONVERTED.get(source.upper()) != source or S7_CONVERTED.get(target.upper()) != target or source == target:
        return None
    return standard_block(f"{source}_TO_{target}".upper())


def s7_name(block: StandardBlock) -> str:
    """What TIA Portal calls a standard block."""
    names = block.tools.get(Tool.S7)
    return names.name if names is not None else block.name


def model_pin(block: StandardBlock | None, pin: str) -> str:
    """The name of a pin in the model: that of IEC 61131-3 for a standard block."""
    if pin in ("en", "eno"):
        return pin.upper()
    return _standard_pin(block.name, pin) if block is not None else pin


@lru_cache(maxsize=4096)
def _standard_pin(block_name: str, pin: str) -> str:
    block = standard_block(block_name)
    if block is None:
        return pin
    name = block.input_name(pin) or block.output_name(pin)
    return name if name is not None and block.tool_pin(name, Tool.S7) == pin else pin


def template_type(name: str) -> str:
    """The type of a ``TemplateValue`` of this name."""
    return "Cardinality" if name in CARDINALITIES else "Type"
