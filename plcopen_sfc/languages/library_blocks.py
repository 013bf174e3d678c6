"""Function blocks of the libraries of CODESYS in structured text, for tools that do not have them.

BLINK is of the library Util, which projects use for lamps. It does what the simulation does for it
(`semantics.programs.standard_blocks`); a test runs both.
"""

from __future__ import annotations

from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataType, DerivedType, Elementary, ElementaryType, Variable, used_types
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection

_HAVE_UTIL = frozenset({"codesys", "codesys-export", "codesys23"})
"""Formats whose tool has the library Util."""
_BLINK = """(* BLINK of the library Util of CODESYS: OUT is TRUE for TIMEHIGH, FALSE for TIMELOW, and so on *)
IF NOT #ENABLE THEN
    #Running := FALSE;
ELSE
    IF #OUT THEN
        #Phase := #TIMEHIGH;
    ELSE
        #Phase := #TIMELOW;
    END_IF;
    #Elapsed(IN := #Running, PT := #Phase);
    IF NOT #Running OR #Elapsed.Q THEN
        #OUT := NOT #Running OR NOT #OUT;
        #Running := TRUE;
        (* the next phase begins now *)
        IF #OUT THEN
            #Phase := #TIMEHIGH;
        ELSE
            #Phase := #TIMELOW;
        END_IF;
        #Elapsed(IN := FALSE, PT := #Phase);
        #Elapsed(IN := TRUE, PT := #Phase);
    END_IF;
END_IF;"""


def library_blocks(project: Project) -> list[Pou]:
    """Return the blocks of libraries that a project of CODESYS uses, in its dialect."""
    if project.tool_format not in _HAVE_UTIL or any(pou.name.casefold() == "blink" for pou in project.pous):
        return []
    variables = [variable for pou in project.pous for variable in pou.variables()]
    variables += [variable for section in project.global_sections() for variable in section.variables]
    variables += [Variable(name=each.name, type=each.type) for each in project.data_types]
    is_used = any(name.casefold() == "blink" for variable in variables for name in used_types(variable.type))
    return [_blink(project.dialect)] if is_used else []


def _blink(dialect: Dialect) -> Pou:
    """Return BLINK as a function block."""
    boolean, time = ElementaryType(name=Elementary.BOOL), ElementaryType(name=Elementary.TIME)
    timer = DerivedType(name="TON_TIME" if dialect is Dialect.SCL else "TON")
    sections: dict[SectionKind, list[tuple[str, DataType]]] = {
        SectionKind.INPUT: [("ENABLE", boolean), ("TIMELOW", time), ("TIMEHIGH", time)],
        SectionKind.OUTPUT: [("OUT", boolean)],
        SectionKind.LOCAL: [("Running", boolean), ("Phase", time), ("Elapsed", timer)],
    }
    interface = Interface(
        sections=[
            VariableSection(kind=kind, variables=[Variable(name=name, type=type_) for name, type_ in declared])
            for kind, declared in sections.items()
        ]
    )
    text = _BLINK if dialect is Dialect.SCL else _BLINK.replace("#", "")
    return Pou(name="BLINK", kind=PouKind.FUNCTION_BLOCK, interface=interface, bodies=[StBody(text=text)])
