"""What a translation must know beside the text."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from plcopen_sfc.languages.s7_types import S7Types
from plcopen_sfc.languages.translation.renames import Renames


class StepNotation(StrEnum):
    """How a text says that a step is active, and for how long.

    IEC: ``Step3.X``, ``Step3.T`` (IEC 61131-3, 6.7.2). CODESYS: ``Step3.x``, ``Step3.t``. FLAG: ``Step3``, the BOOL of
    simple steps in CoDeSys V2.3. S7_GRAPH: ``#Step3.X`` in its own block, ``"GraphDB".Step3.X`` elsewhere, times ``.T``
    and ``.U`` (without disturbances). GRAFCET: ``X3`` (IEC 60848, 4.5), by the number of the step.
    """

    IEC = "iec"
    CODESYS = "codesys"
    FLAG = "flag"
    S7_GRAPH = "s7-graph"
    GRAFCET = "grafcet"


@dataclass(frozen=True, slots=True)
class StepReferences:
    """The steps that a text may refer to, and how it does.

    `names`: from the name in the source text (its number in GRAFCET) to that in the target. `source_block`,
    `target_block`: the instance or POU that has the steps, where the text stands outside of it.
    """

    names: Mapping[str, str]
    source: StepNotation
    target: StepNotation
    source_block: str = ""
    target_block: str = ""


@dataclass(frozen=True, slots=True)
class TranslationContext:
    """What the names in a text mean. Names of the source text, case does not matter.

    `locals`: all that the POU declares, its instances too; None: not known, and then names get no ``#`` and no quotes
    in SCL. `types`: types of variables and instances by name, by path for members (``station.timer``): needed for the
    pins of instances (``TON``, ``CTU``) and for conversions whose name tells the source type. `enumerations`: names of
    enumeration types: ``Color.red`` of CODESYS is ``Color#red`` in IEC 61131-3. `renames`: known ones, and the place of
    new ones. `steps`: without, step variables are not told from others. `s7_types`: the enumerations, whose values are
    user constants in SCL; `hidden` are names that are no values of them, whatever these are called. `actions`: the
    actions and methods of the POU, which S7 cannot call. `functions`: the inputs of the functions of the project by the
    name of the function in lower case: they are called instead of standard functions of the same name, and S7 wants the
    names of their inputs. `blocks`: the data blocks of S7 that have the variables of lists, by the name of the variable
    in lower case: CODESYS also names them without their list.
    """

    locals: Collection[str] | None = None
    types: Mapping[str, str] = field(default_factory=dict)
    enumerations: Collection[str] = ()
    renames: Renames = field(default_factory=Renames)
    steps: StepReferences | None = None
    s7_types: S7Types | None = None
    hidden: Collection[str] = ()
    actions: Collection[str] = ()
    functions: Mapping[str, Sequence[str]] = field(default_factory=dict)
    blocks: Mapping[str, str] = field(default_factory=dict)
