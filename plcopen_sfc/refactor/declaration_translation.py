"""Declarations in another dialect: names, types of instances, lengths of strings, first values, constants."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.binding.constant_values import ConstantValues
from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.symbols import inside
from plcopen_sfc.languages.binding.text_sites import text_sites
from plcopen_sfc.languages.st.literals import LiteralKind, known_literal, string_literal
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, S7_COUNTERS_OF_CODESYS, S7_INSTANCES, S7_VERSION
from plcopen_sfc.languages.translation import (
    NameScope,
    Note,
    Renames,
)
from plcopen_sfc.languages.translation.renames import KeptNames, keep_names
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model import (
    Interface,
    PouKind,
    Project,
    Variable,
)
from plcopen_sfc.model import types as t
from plcopen_sfc.model.actions import SWITCHES
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import STRING_LENGTHS, Dialect
from plcopen_sfc.model.sfc import Body
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.whole_numbers import whole_number


@dataclass(frozen=True, slots=True)
class TranslatedText:
    """Result of the translation of one text: its path, in the words of reports, and the notes on it.

    `what` it is: a text, a constant expression, or the address of a variable.
    """

    path: str
    changed: bool
    notes: tuple[Note, ...]
    what: str = "text"


def translate_declarations(project: Project, renames: Renames, target: Dialect) -> list[TranslatedText]:
    """Put what a project declares into the terms of `target`, with the names that its texts have there."""
    source = project.dialect
    found = _rename_steps(project, renames, target)
    _rename_declarations(project, renames, target)
    if Dialect.SCL in (source, target) and source is not target:
        keep_names(project, KeptNames.TRANSLATED, renames.rows() if source is Dialect.SCL else ())
    _rename_instances(project, source, target)
    _say_lengths(project, source, target)
    return [*found, *_say_starts(project, source, target), *_say_views(project, source, target)]


def compute_constants(project: Project) -> list[TranslatedText]:
    """Write the values of calculated start values, bounds and lengths, where S7 takes one literal or constant."""
    values = ConstantValues(Resolver(project, project.dialect))
    calculated = [text_site for text_site in text_sites(project) if values.is_calculated(text_site)]
    literals = [values.literal(text_site) for text_site in calculated]
    found: list[TranslatedText] = []
    for text_site, literal in zip(calculated, literals, strict=True):
        if literal is None:
            severity = Severity.ERROR
            why = f"TIA Portal takes a literal or one constant here, and the value of `{text_site.text}` is not known"
        else:
            severity, why = Severity.INFO, f"the value of `{text_site.text}`: TIA Portal takes no calculation here"
            text_site.put(literal)
        note = Note(severity, why, (0, 0), 1, 1)
        found.append(TranslatedText(text_site.report_path, literal is not None, (note,), "constant expression"))
    return found


def start_by_statements(project: Project) -> list[str]:
    """Give variables of functions and temporary ones their start values in statements; return the paths of these.

    In S7 they have none. Statements stand at the beginning of a body of structured text; other bodies get none.
    """
    found: list[str] = []
    for path, interface, body, kinds in _started(project):
        if not isinstance(body, StBody) or interface is None:
            continue
        statements = ""
        for variable in (v for each in interface.sections if each.kind in kinds for v in _variables(each)):
            if isinstance(variable.initial, t.SimpleValue):
                statements += f"{variable.name} := {variable.initial.text};\n"
                variable.initial = None
                found.append(f"{path} / variable {variable.name}")
        body.text = statements + body.text
    return found


def _started(project: Project) -> Iterator[tuple[str, Interface | None, Body | None, tuple[SectionKind, ...]]]:
    """Yield the path, the interface and the body of each POU and method, and the variables that each call starts."""
    for pou in project.pous:
        kinds = _BEGUN_BY_CALLS if pou.kind is PouKind.FUNCTION else (SectionKind.TEMP,)
        yield pou.report_path, pou.interface, pou.bodies[0] if pou.bodies else None, kinds
        for method in pou.methods:
            yield f"{pou.report_path} / method {method.name}", method.interface, method.body, _BEGUN_BY_CALLS


_BEGUN_BY_CALLS = (SectionKind.LOCAL, SectionKind.TEMP, SectionKind.OUTPUT)


def _variables(section: VariableSection) -> list[Variable]:
    return [] if section.constant else section.variables


def _renaming(renames: Renames, target: Dialect) -> Callable[[NameScope, str], str | None]:
    return renames.old_name if target is Dialect.SCL else renames.new_name


def _rename_steps(project: Project, renames: Renames, target: Dialect) -> list[TranslatedText]:
    """Give steps the names that the texts use now; return those that have another."""
    found: list[TranslatedText] = []
    renamed = _renaming(renames, target)
    for chart in project.charts():
        for step in chart.chart.steps:
            new = renamed(NameScope.LOCAL, step.name)
            if new is not None and new != step.name:
                why = "it was called so before" if target is Dialect.SCL else "the name that it has is none there"
                note = Note(Severity.INFO, f"the step is called {new}: {why}", (0, 0), 1, 1)
                found.append(TranslatedText(f"{chart.report_path} / step {step.name}", True, (note,)))
                step.name = new
        for _, association in chart.chart.associations():
            if association.qualifier in SWITCHES and association.target is not None:
                name = association.target
                association.target = renamed(NameScope.LOCAL, name) or name
    return found


def _rename_instances(project: Project, source: Dialect, target: Dialect) -> None:
    """Give instances of standard function blocks the types that they have there: TON is TON_TIME in SCL."""
    if (source is Dialect.SCL) is (target is Dialect.SCL):
        return
    counters = S7_COUNTERS_OF_CODESYS if family(source) is Dialect.CODESYS else {}
    names = S7_INSTANCES | counters if target is Dialect.SCL else BLOCKS_OF_S7
    declared = {pou.name.upper() for pou in project.pous} | {kind.name.upper() for kind in project.data_types}
    names = {name: other for name, other in names.items() if name not in declared}
    sections = [section for interface in project.interfaces() for section in interface.sections]
    sections += project.global_sections()
    for variable in (variable for section in sections for variable in section.variables):
        if isinstance(variable.type, t.DerivedType) and variable.type.name.upper() in names:
            variable.type = t.DerivedType(name=names[variable.type.name.upper()])
            if variable.attributes.get("Version") == S7_VERSION:
                variable.attributes = {key: text for key, text in variable.attributes.items() if key != "Version"}


def _rename_declarations(project: Project, renames: Renames, target: Dialect) -> None:
    """Give what is declared the names that the texts use now."""
    if not len(renames):
        return
    renamed = _renaming(renames, target)

    def rename(variables: list[Variable], scope: NameScope) -> None:
        for variable in variables:
            variable.name = renamed(scope, variable.name) or variable.name
            if isinstance(variable.type, t.StructType):
                rename(variable.type.members, NameScope.MEMBER)

    def rename_sections(sections: list[VariableSection], scope: NameScope) -> None:
        for section in sections:
            rename(section.variables, scope)

    for pou in project.pous:
        pou.name = renamed(NameScope.GLOBAL, pou.name) or pou.name
        for interface in pou.interfaces():
            rename_sections(interface.sections, NameScope.LOCAL)
    for declaration in project.data_types:
        if isinstance(declaration.type, t.StructType):
            rename(declaration.type.members, NameScope.MEMBER)
    resources = [*project.resources()]
    globals_ = [project.global_variables, *(c.global_variables for c in project.configurations)]
    for sections in (*globals_, *(resource.global_variables for resource in resources)):
        rename_sections(sections, NameScope.GLOBAL)


def _say_lengths(project: Project, source: Dialect, target: Dialect) -> None:
    """Write the length of strings without one, where the tools of both dialects have different defaults."""
    length = STRING_LENGTHS.get(source)
    if length is None or Dialect.SCL not in (source, target) or source is target:
        return
    sections = [section for interface in _all_interfaces(project) for section in interface.sections]
    variables = [variable for section in (*sections, *project.global_sections()) for variable in section.variables]
    types = [variable.type for variable in variables] + [each.type for each in project.data_types]
    types += [interface.return_type for interface in _all_interfaces(project) if interface.return_type is not None]
    while types:
        for type_ in inside(types.pop()):
            if isinstance(type_, t.StringType) and type_.length is None:
                type_.length = length
            elif isinstance(type_, t.StructType):
                types += [member.type for member in type_.members]


def _say_starts(project: Project, source: Dialect, target: Dialect) -> Iterator[TranslatedText]:
    """Write the start values of dates, which tools have at other days, and cut off texts that S7 does not take."""
    if (source is Dialect.SCL) is (target is Dialect.SCL):
        return
    for path, variable in _kept_variables(project):
        type_, start = t.element_type(variable.type), variable.initial
        name = type_.name.value if isinstance(type_, t.ElementaryType) else ""
        why, severity = "", Severity.INFO
        if name in _FIRST_DAYS and start is None:
            if source is Dialect.SCL and not isinstance(variable.type, t.ArrayType):
                variable.initial = t.SimpleValue(text=_FIRST_DAYS[name])
                why = f"it starts as {_FIRST_DAYS[name]}, as in S7"
            else:
                why = f"{name} starts as {_FIRST_DAYS[name]} in S7, and as 1970-01-01 in CODESYS"
                severity = Severity.WARNING
        if target is Dialect.SCL and isinstance(type_, t.StringType) and isinstance(start, t.SimpleValue):
            length = whole_number(type_.length or STRING_LENGTHS.get(source))
            cut = _cut_text(start.text or "", length, target) if length is not None else None
            if cut is not None:
                start.text = cut
                why = f"its first value was cut off to {length} characters, as it is when it is assigned"
        if why:
            note = Note(severity, why, (0, 0), 1, 1)
            yield TranslatedText(f"{path} / {variable.name}", changed=True, notes=(note,))


def _say_views(project: Project, source: Dialect, target: Dialect) -> Iterator[TranslatedText]:
    """Tell of variables that lie over others (``b AT d : ..``), which S7 alone has."""
    if source is not Dialect.SCL or target is Dialect.SCL:
        return
    for pou in project.pous:
        for variable in pou.variables():
            if variable.address and not variable.address.startswith("%"):
                why = f"it lies over `{variable.address}`, and only direct addresses are behind AT in other tools"
                note = Note(Severity.ERROR, why, (0, 0), 1, 1)
                yield TranslatedText(
                    f"{pou.report_path} / {variable.name}", changed=False, notes=(note,), what="address"
                )


_FIRST_DAYS = {"DATE": "D#1990-01-01", "DT": "DT#1990-01-01-00:00:00"}
"""The first values of dates in S7; those of LDT and DTL are in 1970 as in CODESYS."""


def _kept_variables(project: Project) -> Iterator[tuple[str, Variable]]:
    """Yield the variables and members that have a first value, with the path of what declares them."""
    waiting: list[tuple[str, Variable]] = []
    for pou in project.pous:
        for section in pou.interface.sections if pou.interface is not None and pou.kind is not PouKind.FUNCTION else ():
            if section.kind not in (SectionKind.IN_OUT, SectionKind.EXTERNAL, SectionKind.TEMP, SectionKind.RETURN):
                waiting += [(pou.report_path, variable) for variable in section.variables]
    for section in project.global_sections():
        waiting += [("global variables", variable) for variable in section.variables]
    for block in project.data_blocks:
        sections = block.interface.sections if block.interface is not None and block.type_name is None else []
        waiting += [(block.report_path, variable) for section in sections for variable in section.variables]
    for declared in project.data_types:
        if isinstance(declared.type, t.StructType):
            waiting += [(declared.report_path, member) for member in declared.type.members]
    while waiting:
        path, variable = waiting.pop(0)
        if isinstance(variable.type, t.StructType):
            waiting += [(f"{path} / {variable.name}", member) for member in variable.type.members]
        yield path, variable


def _cut_text(text: str, length: int, dialect: Dialect) -> str | None:
    """Return the literal of a text without what goes beyond `length`; None where it fits, or is no literal."""
    found = known_literal(text, dialect)
    if (
        found is None
        or found.kind is not LiteralKind.STRING
        or not isinstance(found.value, str)
        or len(found.value) <= length
    ):
        return None
    return string_literal(found.value[:length], dialect, wide=found.type.startswith("W"))


def _all_interfaces(project: Project) -> list[Interface]:
    blocks = (block.interface for block in project.data_blocks if block.interface is not None)
    return [*project.interfaces(), *blocks]
