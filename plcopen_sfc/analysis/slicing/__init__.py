"""What of a program the value of a variable depends on, as a program of its own."""

from plcopen_sfc.analysis.slicing.charts import ChartParts
from plcopen_sfc.analysis.slicing.parts import NotDivisibleError, Parts, cone
from plcopen_sfc.analysis.slicing.programs import ProgramParts
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.semantics.programs.instances import Instance

__all__ = ["NotDivisibleError", "Parts", "cone", "parts_of"]


def parts_of(instance: Instance) -> Parts:
    """The parts of the POU that an instance is of. Raises `NotDivisibleError`."""
    pou = instance.unit.pou
    if len(pou.bodies) != 1 or pou.methods or instance.unit.base is not None:
        raise NotDivisibleError(f"{pou.name} is more than one body")
    if instance.controller.problems:
        raise NotDivisibleError(f"{pou.name} cannot be executed everywhere")
    return ChartParts(instance) if isinstance(pou.bodies[0], SfcBody) else ProgramParts(instance)
