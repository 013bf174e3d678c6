"""Putting lowered code into a POU: its body, and what that declares."""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.lowering.actions.drive import DriveBlock
from plcopen_sfc.lowering.code.emitting import function_block_diagram, ladder_diagram, structured_text
from plcopen_sfc.lowering.code.program import Code
from plcopen_sfc.lowering.forms import Language
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection


def assemble(original: Pou, code: Code, dialect: Dialect, language: Language) -> Pou:
    """A copy of `original` with `code` as its body instead of the chart."""
    interface = original.interface.model_copy(deep=True) if original.interface is not None else Interface()
    interface.declaration = None
    _declare(interface, SectionKind.INPUT, code.inputs)
    _declare(interface, SectionKind.OUTPUT, code.outputs)
    _declare(interface, SectionKind.LOCAL, code.variables)
    _declare(interface, SectionKind.LOCAL, code.constants, constant=True)  # behind the variables, as in TIA Portal
    _declare(interface, SectionKind.EXTERNAL, code.flags.external if code.flags is not None else [])
    body = _body(code, dialect, language, interface.variables(), original.name)
    lowered = original.model_copy(deep=True, update={"bodies": [], "object_id": None})
    lowered.interface = interface
    lowered.bodies = [body, *(b for b in original.bodies if not isinstance(b, SfcBody))]
    return lowered


def _body(code: Code, dialect: Dialect, language: Language, declared: list[Variable], pou: str) -> Body:
    if language is Language.ST:
        return structured_text(code, dialect)
    if language is Language.FBD:
        return function_block_diagram(code, dialect, declared, pou)
    return ladder_diagram(code, dialect, declared, pou)


def drive_block(drive: DriveBlock, dialect: Dialect, language: Language) -> Pou:
    """The function block that drives the actions."""
    body = _body(drive.code, dialect, language, drive.interface.variables(), drive.name)
    return Pou(name=drive.name, kind=PouKind.FUNCTION_BLOCK, interface=drive.interface, bodies=[body])


def _declare(interface: Interface, kind: SectionKind, variables: list[Variable], *, constant: bool = False) -> None:
    """Declare variables where others of their kind are: a block of TIA Portal has each section once."""
    if not variables:
        return
    plain = VariableSection(kind=kind, constant=constant)
    for section in interface.sections:
        if all(getattr(section, name) == getattr(plain, name) for name in _ATTRIBUTES):
            section.variables += variables
            section.declaration = None
            return
    plain.variables = variables
    interface.sections.append(plain)


_ATTRIBUTES = ("kind", "name", "constant", "retain", "nonretain", "persistent", "nonpersistent")
