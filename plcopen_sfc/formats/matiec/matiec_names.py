"""Names that matiec accepts: ASCII letters, digits and single underscores, nothing that it knows already, all declared.

matiec compiles nothing but the text: what it uses and does not declare (blocks of libraries, above all) is reported.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from itertools import chain, count

from plcopen_sfc.errors import ModelError
from plcopen_sfc.formats.matiec.matiec_pou import UNDECLARED_PREFIX
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.words import IEC_KEYWORDS
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import ArrayType, DataType, DerivedType, Elementary, PointerType
from plcopen_sfc.report import ConversionReport, Outcome

_NAME = re.compile(r"(?!.*__)(?!.*_$)[A-Za-z_][A-Za-z0-9_]*")
_LETTERS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ß": "ss"})
_KEYWORDS = IEC_KEYWORDS | {"ON", "R_EDGE", "F_EDGE", "EN", "ENO"}
_LIBRARY = frozenset({"RTC", "SEMA", "INTEGRAL", "DERIVATIVE", "PID", "RAMP", "HYSTERESIS"})
_TYPED = re.compile(r"([A-Z_]+)_(?:[SDL]?INT|U[SDL]?INT|L?REAL|BOOL|BYTE|[DL]?WORD)")


def give_plain_names(project: Project, report: ConversionReport) -> None:
    """Rename what has a name that matiec does not take; all references follow.

    Where a variable is declared, matiec reads the name of a type, a POU or a standard block as such (``Motor : Motor``,
    ``LEN : INT``). Steps, actions, transitions and members of structures may have it.
    """
    for pou in project.pous:
        if not pou.name:  # seen in a file of TIA Portal; nothing can call it
            pou.name = "Unnamed"
            report.add(Outcome.TRANSLATED, "name", pou.report_path, "the POU has none; it gets one for matiec")
    units = {one.name.casefold() for one in (*project.pous, *project.data_types)}
    used = units | {name.casefold() for _, name in (*_placed(project), *_declared(project), *_units(project))}
    for path, name in _placed(project):
        if not is_matiec_name(name):
            _rename(project, path, name, used, report)
    for path, name, others in _steps(project):
        if name.casefold() in others:
            _rename(project, path, name, used, report)
    for path, name in _declared(project):
        if not is_matiec_name(name) or name.casefold() in units or is_of_library(name):
            _rename(project, path, name, used, report)
    for path, name in _units(project):
        if not is_matiec_name(name) or is_of_library(name):
            _rename(project, path, name, used, report)


def _rename(project: Project, path: str, name: str, used: set[str], report: ConversionReport) -> None:
    plain = matiec_name(name)
    tries = chain([plain], (f"{plain}_{number}" for number in count(1)))
    new = next(each for each in tries if each.casefold() not in used and not is_of_library(each))
    try:
        project.rename(path, new)
    except ModelError as error:
        report.add(Outcome.NOT_EXECUTED, "name", path, f"matiec does not take the name {name!r}: {error.message}")
        return
    used.add(new.casefold())
    why = f"it takes {name} for something else" if is_matiec_name(name) else f"it does not take {name!r}"
    report.add(Outcome.TRANSLATED, "name", path, f"renamed to {new} for matiec: {why}")


def is_of_library(name: str) -> bool:
    """True if matiec has a function or a function block of this name, such as ``LEN``, ``ADD_INT`` or ``PID``."""
    typed = _TYPED.fullmatch(name.upper())
    return name.upper() in _LIBRARY or any(standard_block(each) for each in (name, *(typed.groups() if typed else ())))


def is_matiec_name(name: str) -> bool:
    """True if matiec takes `name` for a step or an action; for a variable it must not be that of something else."""
    return _NAME.fullmatch(name) is not None and name.upper() not in _KEYWORDS


def matiec_name(name: str) -> str:
    """Return a name near `name` that matiec takes."""
    plain = unicodedata.normalize("NFKD", name.translate(_LETTERS)).encode("ascii", "ignore").decode()
    plain = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", plain)).rstrip("_") or "x"
    return plain if is_matiec_name(plain) else f"x_{plain.lstrip('_')}"


# Paths for `Project.rename` with names. Each POU and each type is looked at when the names before it are settled.


def _placed(project: Project) -> Iterator[tuple[str, str]]:
    """Yield the names with a scope of their own: actions, transitions, steps, members of structures."""
    for pou in project.pous:
        inner = [action.name for action in pou.actions] + [transition.name for transition in pou.transitions]
        inner += [step.name for step in pou.chart.steps] if pou.chart is not None else []
        yield from [(f"{pou.name}.{name}", name) for name in inner]
    for declaration in project.data_types:
        yield from [(f"{declaration.name}.{one.name}", one.name) for one in getattr(declaration.type, "members", [])]


def _steps(project: Project) -> Iterator[tuple[str, str, set[str]]]:
    """Steps, with the names that theirs would change in the C code: a step becomes a macro of its name.

    These are the members of all steps, variables of the POU, and the members of its structures and blocks.
    """
    members = {pou.name.casefold(): {one.name.casefold() for one in pou.variables()} for pou in project.pous}
    for declaration in project.data_types:
        inner = getattr(declaration.type, "members", [])
        members[declaration.name.casefold()] = {one.name.casefold() for one in inner}
    for pou in project.pous:
        if pou.chart is None:
            continue
        others = {"x", "t"} | members[pou.name.casefold()]
        for variable in pou.variables():
            for kind in used_types(variable.type):
                block = standard_block(kind)
                pins = (*block.inputs, *block.outputs) if block is not None else ()
                others |= members.get(kind.casefold(), set()) | {pin.name.casefold() for pin in pins}
        yield from [(f"{pou.name}.{step.name}", step.name, others) for step in pou.chart.steps]


def used_types(kind: DataType) -> list[str]:
    """Return the names of the types that a type names."""
    if isinstance(kind, DerivedType):
        return [kind.name]
    if isinstance(kind, ArrayType | PointerType):
        return used_types(kind.base)
    return [name for member in getattr(kind, "members", []) for name in used_types(member.type)]


def _declared(project: Project) -> Iterator[tuple[str, str]]:
    """Yield variables and values of enumerations; global variables first, for a POU may declare them as external."""
    for section in project.global_variables:
        around = f"{section.name}." if section.name else ""
        yield from [(f"{around}{one.name}", one.name) for one in section.variables]
    for pou in project.pous:
        yield from [(f"{pou.name}.{variable.name}", variable.name) for variable in pou.variables()]
    for declaration in project.data_types:
        yield from [(f"{declaration.name}.{one.name}", one.name) for one in getattr(declaration.type, "values", [])]


def _units(project: Project) -> Iterator[tuple[str, str]]:
    yield from [(one.name, one.name) for one in (*project.pous, *project.data_types)]


def note_undeclared(project: Project, report: ConversionReport) -> None:
    """Report each name that nothing declares, at the first place where it is used."""
    found: dict[str, tuple[str, str]] = {}
    for name, path in (*_types(project), *_programs(project), *_names(project)):
        if not name.upper().startswith(UNDECLARED_PREFIX):
            found.setdefault(name.casefold(), (name, path))
    for name, path in found.values():
        report.add(Outcome.NOT_EXECUTED, "undeclared name", path, f"nothing in the project declares `{name}`")


def _types(project: Project) -> Iterator[tuple[str, str]]:
    known = {one.name.casefold() for one in (*project.pous, *project.data_types)}
    places = [(one.report_path, one.type) for one in project.data_types]
    for pou in project.pous:
        places += [(f"{pou.report_path} / variable {one.name}", one.type) for one in pou.variables()]
    for path, kind in places:
        yield from (
            (name, path) for name in used_types(kind) if name.casefold() not in known and not is_of_library(name)
        )


def _programs(project: Project) -> Iterator[tuple[str, str]]:
    known = {pou.name.casefold() for pou in project.pous if pou.kind is PouKind.PROGRAM}
    for configuration in project.configurations:
        for resource in configuration.resources:
            for task in resource.tasks:
                instances = [one for one in task.instances if one.type_name.casefold() not in known]
                yield from ((one.type_name, f"task {task.name} / {one.name}") for one in instances)


def _names(project: Project) -> Iterator[tuple[str, str]]:
    for occurrence in Names(project).undeclared():
        name = occurrence.reference.name
        if not is_of_library(name) and name.upper() not in Elementary.__members__:  # BOOL#TRUE
            yield name, occurrence.text_site.report_path
