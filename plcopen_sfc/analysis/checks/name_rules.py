"""Rules on the names in charts and in the code of their POUs: undeclared ones, and what nothing names."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator
from difflib import get_close_matches
from typing import Protocol, TypeVar

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, CheckedProject, Finding, FindingPlace, Rule, ring
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.binding.name_resolution import circle_text
from plcopen_sfc.languages.binding.name_uses import Occurrence
from plcopen_sfc.languages.binding.text_sites import Role, TextSite
from plcopen_sfc.languages.grafcet_conditions import is_operand
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.words import IEC_KEYWORDS
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import DataBlockKind, Pou
from plcopen_sfc.model.sfc import Step
from plcopen_sfc.model.types import DataTypeDeclaration, StructType, Variable

_ALIKE = 0.84
_FLAG = re.compile(r"[Xx](?P<step>[EMSems]?\d+)")
"""The flag of a step in a GRAFCET (IEC 60848:2013, 4.3 and 7.4)."""
_LISTED = 12


def is_partial(around: CheckedProject, pou: Pou) -> bool:
    """True if the file of a POU may leave out what is declared elsewhere: it declares nothing global.

    In IEC 61131-3 a POU names what is global itself, in VAR_EXTERNAL: there a POU is partial that declares nothing. No
    file is partial of which it is known what is declared elsewhere.
    """
    if around.externals:
        return False
    project = around.project
    sections = any(section.variables for section in project.global_sections())
    blocks = any(block.kind is DataBlockKind.GLOBAL for block in project.data_blocks)
    if sections or blocks or any(table.tags or table.constants for table in project.tag_tables):
        return False
    return project.dialect is not Dialect.IEC or not pou.variables()


class _InText(Protocol):
    """Something that was found in a text."""

    @property
    def text_site(self) -> TextSite: ...


_T = TypeVar("_T", bound=_InText)


def _place(chart: CheckedChart, found: _InText) -> FindingPlace:
    site = found.text_site
    known = chart.holders.get(id(site.holder))
    return known if known is not None else FindingPlace(site.report_path, chart.root.place.elements)


def _own(chart: CheckedChart, found: Iterable[_T]) -> Iterator[_T]:
    """Yield findings in a chart; with the first one of a POU, or of the project, also those of it in no chart."""
    if chart.pou is None or not chart.pou.name:
        return
    charts = {id(sheet.chart) for sheet in chart.sheets}
    is_first = chart.around.is_first(chart, chart.pou)
    of_project = chart.around.is_first(chart)
    for each in found:
        site = each.text_site.site
        inside = [each for each in site.charts if id(each) in charts]
        if site.pou is None:
            belongs = of_project
        else:
            belongs = site.pou is chart.pou and (bool(inside) or (is_first and not site.charts))
        if belongs:
            yield each


def _like(chart: CheckedChart, occurrence: Occurrence) -> str:
    """Return another declared name that is nearly the same, and visible where this one is."""
    around, name = chart.around, occurrence.reference.name
    levels = around.named.resolver.levels(occurrence.reference, occurrence.text_site)
    visible = {each.name.casefold(): each.name for level in levels for each in level}
    visible.pop(name.casefold(), None)  # of a transition, which is no variable
    found = get_close_matches(name.casefold(), visible, 1, _ALIKE)
    return visible[found[0]] if found else ""


def _is_slip(name: str, like: str) -> bool:
    """True if one letter, or two that are exchanged, make the difference.

    Not a digit, which counts things that are alike, nor the first letter: `ePart` is the type of `Part`.
    """
    one, other = name.casefold(), like.casefold()
    if one[:1] != other[:1] or re.sub(r"\d+", "", one) == re.sub(r"\d+", "", other):
        return False
    start = next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))
    rest, others = one[start:], other[start:]
    exchanged = rest[:2] == others[1::-1] and rest[2:] == others[2:]
    return exchanged or rest[1:] == others[1:] or rest[1:] == others or rest == others[1:]


def _in_libraries(chart: CheckedChart) -> bool:
    """True if a type may be one of a library, which no file of the tool has."""
    project = chart.around.project
    has_libraries = project.dialect in (Dialect.CODESYS, Dialect.TWINCAT) or project.header.is_of_beremiz
    return has_libraries and not chart.around.externals


def _undeclared(chart: CheckedChart) -> Iterator[Finding]:
    partial = chart.pou is not None and is_partial(chart.around, chart.pou)
    is_grafcet = chart.family == "grafcet" and chart.pou is not None
    found = chart.around.undeclared_in(chart.pou) if is_grafcet and chart.pou is not None else chart.around.undeclared
    for each in _own(chart, found):
        name, like = each.reference.name, _like(chart, each)
        if name.casefold() in chart.flags:
            continue
        if is_grafcet and (flag := _FLAG.fullmatch(name)) is not None:
            message = f"{name!r} is the flag of a step {flag['step']}, and there is no such step"
            yield Finding(_place(chart, each), message, "Correct the number, or declare a variable of this name.")
            continue
        if each.meaning.declaration is not None:
            yield Finding(_place(chart, each), f"{name!r} is the name of the POU, which is no value")
            continue
        if (partial and not _is_slip(name, like)) or _has_its_rule(each):
            continue  # VAR02 lists it
        what = "no step" if each.reference.access.casefold() in _OF_STEPS else "nothing"
        hint = f"Did you mean {like!r}?" if like else ""
        if is_grafcet and (bare := _without_macrons(name)) != name and bare.casefold() in chart.types:
            hint = f"Write the negation of {bare} as /{bare}: a macron is part of a letter, and no line over it."
        yield Finding(_place(chart, each), f"{name!r} names {what} that the project declares", hint)
    for each in _own(chart, chart.around.undeclared_types):
        like = _like(chart, each)
        if _is_slip(each.reference.name, like) or not (partial or _in_libraries(chart)):
            hint = f"Did you mean {like!r}?" if like else ""
            yield Finding(_place(chart, each), f"{each.reference.name!r} names no type that the project declares", hint)
    for each in _own(chart, chart.around.undeclared_members):
        like, name, callee = _like(chart, each), each.reference.name, each.reference.callee
        hint = f"Did you mean {like!r}?" if like else ""
        why = "is no member of what is before it" if callee is None else f"is no parameter of {print_node(callee)}"
        yield Finding(_place(chart, each), f"{name!r} {why}", hint)


def _without_macrons(name: str) -> str:
    """Return a name without the lines over letters that keyboards have: ``ā`` is one letter."""
    parts = unicodedata.normalize("NFD", name).replace("\u0304", "")
    return unicodedata.normalize("NFC", parts)


def _has_its_rule(occurrence: Occurrence) -> bool:
    """True for what CND07, CND08 and ACT09 find: named conditions, steps in conditions, actions of steps."""
    reference, holder = occurrence.reference, occurrence.text_site.holder
    asks = isinstance(holder, Expression) and reference.access.casefold() in _OF_STEPS
    return asks or reference.role is Role.TRANSITION or isinstance(holder, Step)


_OF_STEPS = frozenset({"x", "t"})


def _externals(chart: CheckedChart) -> Iterator[Finding]:
    partial = chart.pou is not None and is_partial(chart.around, chart.pou)
    undeclared = [*chart.around.undeclared] if partial else []
    if partial or _in_libraries(chart):
        undeclared += chart.around.undeclared_types
    names: dict[str, str] = {}
    for each in _own(chart, undeclared):
        name = each.reference.name
        if not _is_slip(name, _like(chart, each)):
            names.setdefault(name.casefold(), name)
    if names:
        shown = ", ".join(names[key] for key in sorted(names)[:_LISTED])
        shown += f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
        yield Finding(chart.root.place, f"declared elsewhere: {shown}")


def _unused(chart: CheckedChart) -> Iterator[Finding]:
    pou = chart.pou
    if pou is None or not chart.around.is_first(chart, pou):
        return
    for each in chart.around.unused:
        if each.pou is pou:
            kind = "" if each.kind is Kind.VARIABLE else f"{each.kind} "
            path = f"{pou.report_path} / {kind}{each.name}"
            yield Finding(FindingPlace(path, (*_elements(each), pou)), f"nothing uses the {each.kind} {each.name!r}")


def _declared_twice(chart: CheckedChart) -> Iterator[Finding]:
    pou, project = chart.pou, chart.around.project
    if chart.around.is_first(chart):
        for again, first in _repeated(project.pous):
            yield Finding(FindingPlace(again.report_path, (again,)), f"the project has a POU {first!r} already")
        for type_, first in _repeated(project.data_types):
            yield Finding(FindingPlace(type_.report_path, (type_,)), f"the project has a data type {first!r} already")
        for section in project.global_sections():
            for variable, first in _repeated(section.variables):
                place = FindingPlace(f"global variable {variable.name}", (variable, section))
                yield Finding(place, f"the list has a variable {first!r} already")
        for declared in project.data_types:
            for member, first in _repeated(declared.type.members if isinstance(declared.type, StructType) else ()):
                place = FindingPlace(f"{declared.report_path} / {member.name}", (member, declared))
                yield Finding(place, f"{declared.name} has a member {first!r} already")
    if pou is None or not chart.around.is_first(chart, pou):
        return
    for word, thing, first in pou.declared_twice():
        kind = "" if isinstance(thing, Variable) else f"{word} "
        place = FindingPlace(f"{pou.report_path} / {kind}{thing.name}", (thing, pou))
        yield Finding(place, f"{pou.name} has {'an' if word == 'action' else 'a'} {word} {first!r} already")


_Named = TypeVar("_Named", Pou, DataTypeDeclaration, Variable)


def _repeated(things: Iterable[_Named]) -> Iterator[tuple[_Named, str]]:
    """Yield what has the name of another before it, in the same namespace or application, and that name."""
    known: dict[tuple[str, str], _Named] = {}
    for thing in things:
        place = "" if isinstance(thing, Variable) else thing.place
        first = known.setdefault((place, thing.name.casefold()), thing)
        if first is not thing and thing.name:
            yield thing, first.name


def _endless(chart: CheckedChart) -> Iterator[Finding]:
    if chart.around.is_first(chart):
        for circle in chart.around.endless_types:
            yield Finding(FindingPlace(circle[0].report_path, (circle[0],)), circle_text(circle))


def _unreadable_names(chart: CheckedChart) -> Iterator[Finding]:
    pou = chart.pou
    if pou is None or not chart.around.is_first(chart, pou):
        return
    if pou.name.upper() in IEC_KEYWORDS:
        yield Finding(
            FindingPlace(pou.report_path, (pou,)), f"{pou.name!r} is a keyword, which no tool takes as a name"
        )
    for variable in pou.variables():
        place = FindingPlace(f"{pou.report_path} / {variable.name}", (variable, pou))
        if variable.name.upper() in IEC_KEYWORDS:
            yield Finding(place, f"{variable.name!r} is a keyword, which a condition reads as such")
        elif variable.name and not is_operand(variable.name):
            yield Finding(place, f"a condition does not read {variable.name!r} as one name")


def _misfitting(chart: CheckedChart) -> Iterator[Finding]:
    of_grafcet = chart.family == "grafcet"
    for each in _own(chart, chart.around.misfits):
        if not (of_grafcet and isinstance(each.text_site.holder, Expression)):  # a term with * and +: CND10 reads it
            yield Finding(_place(chart, each), each.message, _IN_ACTIONS if of_grafcet else "")


_IN_ACTIONS = "Values are structured text: a AND b, a OR b, NOT a, n + 1, n <> 0, BOOL_TO_INT(a)."


def _elements(declaration: Declaration) -> tuple[Element, ...]:
    return (declaration.holder,) if isinstance(declaration.holder, Element) else ()


VAR01 = Rule(
    code="VAR01",
    title="Names are declared",
    why="A name that nothing declares does not compile: a typing error, or the rest of what was renamed or deleted by "
    "hand. Each name is found once, in a chart or in other code (what is global, with the first chart); types, "
    "members of types and blocks, and parameters in calls too, but for what a library may declare: types by a path, "
    "what a block has that extends one. Names of a file that declares nothing global are VAR02, but for those that are "
    "nearly the same as a declared one. In a GRAFCET without tables of variables only the flags of steps are looked "
    "for (X99 without a step 99).",
    hint="Declare it, or correct the name.",
    example="VAR_INPUT Start, b : BOOL; END_VAR" + ring(forth="Strat"),
    check=_undeclared,
    severity=Severity.WARNING,
    on_code=True,
)

VAR02 = Rule(
    code="VAR02",
    title="Undeclared names of a partial export are declared elsewhere",
    why="An export of some blocks lacks the global variables, tags, data blocks and types that these name, and each "
    "export of CODESYS, TwinCAT and Beremiz the blocks and types of libraries. One finding lists them for each chart, "
    "and each POU without charts: the names that must be there where the file is imported.",
    hint="Export them too, where names shall be checked and renamed with the chart.",
    example="a block in CODESYS that names GVL.Start, in an export without lists of global variables",
    check=_externals,
    severity=Severity.INFO,
    severities={"grafcet": None},
    on_code=True,
)

VAR03 = Rule(
    code="VAR03",
    title="Actions, named conditions and local variables are used",
    why="An unused object is left over, or was meant to be used. Not found are variables with an address, and those "
    "that tools use themselves: SFC flags, and data of S7-GRAPH; nor actions in a file without tasks, which is a part "
    "of a project that may call them.",
    hint="Remove it: `project.edit().remove_unused()` removes all of them.",
    example="a program with a local variable that no step, no condition and no code names",
    check=_unused,
    severity=Severity.INFO,
    severities={"grafcet": None},
    on_code=True,
)

VAR04 = Rule(
    code="VAR04",
    title="Values have the kind of what they are assigned to and compared with",
    why="No compiler takes a number where a BOOL is wanted, or a duration where a number is. Numbers, BOOL, durations, "
    "strings, dates, structures, arrays and instances are told apart in structured text, also in arguments of calls, "
    "in indices, in durations of steps and associations, and in initial values; whether one number fits into another "
    "is a matter of each tool, and what has an unknown type is left alone. A write to a constant, a call of a BOOL, "
    "a number or a type, more arguments than a standard function has, and an index that is not in its array are found "
    "with them. No tool calculates with BOOL: values of stored actions in a GRAFCET are structured text, whose * and + "
    "are no AND and OR.",
    hint="Convert the value (REAL_TO_INT, TIME_TO_DINT), or compare it: n <> 0.",
    example="VAR_INPUT Start, b : BOOL; n : INT; END_VAR"
    + ring("Count(P1);", forth="Start")
    + "ACTION Count: n := Start; END_ACTION\n",
    check=_misfitting,
    severity=Severity.WARNING,
    severities={"grafcet": Severity.ERROR},
    on_code=True,
)

VAR05 = Rule(
    code="VAR05",
    title="Variables, actions, methods and named conditions of a POU have different names, and so have POUs and types",
    why="No tool compiles two variables of one name, or two actions, which differ in no other way than in upper and "
    "lower case letters (IEC 61131-3 ed. 3, 6.1.2); which of them a text means is unknown. POUs, data types, members "
    "of a structure, and the variables of one list of global variables are looked at too, once, with the first chart.",
    hint="Remove one of them, or rename it.",
    example="VAR_INPUT Start, b, start : BOOL; END_VAR" + ring(forth="Start"),
    check=_declared_twice,
    severity=Severity.ERROR,
    on_code=True,
)

VAR06 = Rule(
    code="VAR06",
    title="Conditions of a GRAFCET can name its variables",
    why="A keyword in a condition is none of a variable (Not), a dot is that of a member or AND (a.b), a blank ends "
    "the name. No tool takes such names, nor a GRAFCET with such a name (IEC 61131-3 ed. 3, 6.1.2).",
    hint="Give it a name of letters, digits and underscores that is no keyword.",
    example="""
GRAFCET Example
INPUTS
    Start
    While
INITIAL STEP 1
1 -> 2 : Start * /While
STEP 2
2 -> 1 : /Start
""",
    check=_unreadable_names,
    severity=None,
    severities={"grafcet": Severity.ERROR},
)

VAR07 = Rule(
    code="VAR07",
    title="No type contains itself",
    why="A structure or block with a member of its own type, directly or through other types, has no end and no size: "
    "no tool compiles it, and it cannot be simulated (IEC 61131-3 ed. 3, 6.4.4.6). Each circle is found once, with the "
    "first chart. Pointers and references to the own type are fine.",
    hint="Remove the member, or make it a pointer or a reference.",
    example="a structure ST_Part with a member of type ST_Part",
    check=_endless,
    severity=Severity.ERROR,
    on_code=True,
)
