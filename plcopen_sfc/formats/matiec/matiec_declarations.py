"""Declarations and names that matiec accepts.

Declarations: types and initial values, named structures, quoted strings, and global variables. matiec wants global
variables in a configuration, and declared as external wherever they are used. Beremiz and OpenPLC write the initial
values of strings without quotes in their files.

Names: ASCII letters, digits and single underscores, nothing that it knows already, all declared. matiec compiles
nothing but the text: what it uses and does not declare (blocks of libraries, above all) is reported.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import chain, count

from plcopen_sfc.errors import ModelError
from plcopen_sfc.formats.matiec.matiec_functions import pass_globals
from plcopen_sfc.formats.matiec.matiec_pou import UNDECLARED_PREFIX
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.binding.text_sites import SiteKind, TextSite, text_sites
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import render, transform, walk
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.words import EDGES, IEC_KEYWORDS, without_accents
from plcopen_sfc.model import types as t
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Configuration, Project, Resource
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import Cause, CauseKind, ConversionReport, Outcome

_NAME = re.compile(r"(?!.*__)(?!.*_$)[A-Za-z_][A-Za-z0-9_]*")
_KEYWORDS = IEC_KEYWORDS | EDGES | {"ON", "EN", "ENO"}
_LIBRARY = frozenset({"RTC", "SEMA", "INTEGRAL", "DERIVATIVE", "PID", "RAMP", "HYSTERESIS"})
_PARAMETERS = frozenset(
    """AUTO BUSY CD CDT CLAIM CU CV CYCLE DTERM ERROR ET G IN IN1 IN2 ITERM K KP L LD M MN MX N OFFSET OUT P PDT PT PV Q
    Q1 QD QU R R1 RELEASE RUN S S1 SP T TD TR X0 XIN XOUT""".split()
)
"""Parameters in the library of matiec, in which a type of such a name is no name of a variable any more."""
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
            _rename(partial(project.rename, path), path, name, used, report)
    for path, name, chart, others in _steps_with_others(project):
        if name.casefold() in others:  # a variable may have the path of the step, too
            _rename(partial(chart.rename_step, name), path, name, used, report)
    for path, name in _declared(project):
        if not is_matiec_name(name) or name.casefold() in units or is_of_library(name):
            _rename(partial(project.rename, path), path, name, used, report)
    types = {one.name for one in project.data_types}
    for path, name in _units(project):
        is_hidden = name in types and name.upper() in _PARAMETERS
        if not is_matiec_name(name) or is_of_library(name) or is_hidden:
            _rename(partial(project.rename, path), path, name, used, report)


def _rename(rename: Callable[[str], object], path: str, name: str, used: set[str], report: ConversionReport) -> None:
    plain = matiec_name(name)
    tries = chain([plain], (f"{plain}_{number}" for number in count(1)))
    free = (each for each in tries if each.casefold() not in used and each.upper() not in _PARAMETERS)
    new = next(each for each in free if not is_of_library(each))
    try:
        rename(new)
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
    plain = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", without_accents(name))).rstrip("_") or "x"
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


def _steps_with_others(project: Project) -> Iterator[tuple[str, str, SfcNetwork, set[str]]]:
    """Steps of charts, with the names that theirs would change in the C code: a step becomes a macro of its name.

    These are the POUs, the members of all steps, variables of the POU, and the members of its structures and blocks.
    """
    members = {pou.name.casefold(): {one.name.casefold() for one in pou.variables()} for pou in project.pous}
    for declaration in project.data_types:
        inner = getattr(declaration.type, "members", [])
        members[declaration.name.casefold()] = {one.name.casefold() for one in inner}
    for pou in project.pous:
        if pou.chart is None:
            continue
        others = {"x", "t"} | members.keys() | members[pou.name.casefold()]
        for variable in pou.variables():
            for kind in t.used_types(variable.type):
                block = standard_block(kind)
                pins = (*block.inputs, *block.outputs) if block is not None else ()
                others |= members.get(kind.casefold(), set()) | {pin.name.casefold() for pin in pins}
        yield from [(f"{pou.name}.{step.name}", step.name, pou.chart, others) for step in pou.chart.steps]


def _declared(project: Project) -> Iterator[tuple[str, str]]:
    """Yield variables and values of enumerations; global variables first, for a POU may declare them as external."""
    for section in project.global_sections():
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
        why = f"nothing in the project declares `{name}`"
        report.add(Outcome.NOT_EXECUTED, "undeclared name", path, why, Cause(CauseKind.LACKING, name))


def _types(project: Project) -> Iterator[tuple[str, str]]:
    known = {one.name.casefold() for one in (*project.pous, *project.data_types)}
    places = [(one.report_path, one.type) for one in project.data_types]
    for pou in project.pous:
        places += [(f"{pou.report_path} / variable {one.name}", one.type) for one in pou.variables()]
    for path, kind in places:
        yield from (
            (name, path) for name in t.used_types(kind) if name.casefold() not in known and not is_of_library(name)
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
        name, pou = occurrence.reference.name, occurrence.text_site.site.pou
        if pou is not None and pou.find_action(name) is not None:
            continue  # it is told that matiec calls no actions
        if not is_of_library(name) and name.upper() not in t.Elementary.__members__:  # BOOL#TRUE
            yield name, occurrence.text_site.report_path


_UNKNOWN = frozenset({"LTIME", "LDATE", "LTOD", "LDT", "CHAR", "WCHAR"})
_REALS = frozenset({t.Elementary.REAL, t.Elementary.LREAL})
_WHOLE = re.compile(r"[+-]?\d[\d_]*")


class TypeFitter:
    """Changes types and values of variables; what matiec has not is reported.

    `declared` are the data types by name; `own`: those of a project for matiec, whose strings have its length.
    """

    def __init__(self, declared: Iterable[t.DataTypeDeclaration], report: ConversionReport, *, own: bool) -> None:
        self._own = own
        self._declared = {one.name.casefold(): one.type for one in declared}
        self._report = report

    def declaration(self, one: t.DataTypeDeclaration) -> None:
        """Fit a data type."""
        path = f"type {one.name}"
        for word in ("extends", "union"):
            if word in kept(one.extension_data) or word in kept(getattr(one.type, "extension_data", None)):
                self._lost("type", path, f"matiec has no {word.upper()}")
        if isinstance(one.type, t.EnumType):
            numbers = [value.value for value in one.type.values]
            if any(number is not None and number.strip() != str(index) for index, number in enumerate(numbers)):
                self._lost("enumeration", f"data type {one.name}", "matiec numbers enumerations from 0")
            for value in one.type.values:
                value.value = None
            one.type.base = None
        one.declaration = None
        if isinstance(one.type, t.DerivedType) and isinstance(self._plain(one.type), t.StructType):
            self._lost(
                "type", path, f"matiec compiles no second name of a structure: declare variables as {one.type.name}"
            )
        one.type = self._type(one.type, path, {})
        one.initial = self._value(one.type, one.initial, path)

    def interface(self, interface: Interface, path: str, known: Mapping[str, str]) -> None:
        """Fit the variables of a POU, and the result of a function."""
        constants = self.sections(interface.sections, path, known)
        if interface.return_type is not None:
            interface.return_type = self._type(interface.return_type, f"{path} / result", constants)

    def sections(self, sections: Iterable[VariableSection], path: str, known: Mapping[str, str]) -> dict[str, str]:
        """Fit variables; return the values of constants, with those that are `known`, by names in lower case."""
        sections = list(sections)
        constants = {**known, **_constants(sections)}
        for section in sections:
            for variable in section.variables:
                place = f"{path} / variable {variable.name}" if path else f"variable {variable.name}"
                if section.kind is SectionKind.TEMP and variable.initial is not None:
                    self._lost("initial value", place, "matiec has no start values in VAR_TEMP: assign it")
                    variable.initial = None
                self._variable(variable, place, constants)
        return constants

    def _variable(self, variable: t.Variable, path: str, constants: Mapping[str, str]) -> None:
        if edge := kept(variable.extension_data).get("edge"):
            block = "F_TRIG" if edge.upper() == "F_EDGE" else "R_TRIG"
            self._lost("variable", path, f"matiec does not compile {edge}: declare an instance of {block}")
        variable.type = self._type(variable.type, path, constants)
        variable.initial = self._value(variable.type, variable.initial, path)

    def _type(self, kind: t.DataType, path: str, constants: Mapping[str, str]) -> t.DataType:
        """Return a type without lengths of strings, of which matiec finds no variables, and with numbers for limits."""
        if isinstance(kind, t.ArrayType):
            if isinstance(kind.base, t.ArrayType):
                self._lost("type", path, "matiec has no arrays of arrays; write one of two dimensions")
            for dimension in kind.dimensions:
                dimension.lower, dimension.upper = (
                    self._limit(text, path, constants) for text in (dimension.lower, dimension.upper)
                )
            kind.base = self._type(kind.base, path, constants)
        elif isinstance(kind, t.ElementaryType) and kind.name.value in _UNKNOWN:
            self._lost("type", path, f"matiec has no {kind.name.value}")
        elif isinstance(kind, t.StringType) and kind.wide:
            self._lost("type", path, "matiec has no WSTRING")
        elif isinstance(kind, t.PointerType) and not kind.reference:
            self._lost("type", path, "matiec has no pointers")
        elif isinstance(kind, t.StructType):
            for member in kind.members:
                self._variable(member, f"{path} / {member.name}", constants)
        elif isinstance(kind, t.StringType) and (kind.length is not None or not self._own):
            self._report.add(Outcome.APPROXIMATED, "string", path, "matiec has strings of its own length")
            return t.StringType(wide=kind.wide)
        return kind

    def _limit(self, text: str, path: str, constants: Mapping[str, str]) -> str:
        number = constants.get(text.strip().rpartition(".")[2].casefold(), text.strip())
        if _WHOLE.fullmatch(number) is None:
            self._lost("type", path, f"matiec takes numbers as limits of arrays, not {text}")
        return number

    def _value(self, kind: t.DataType, value: t.Value | None, path: str) -> t.Value | None:
        """Return an initial value; None for one that matiec does not take."""
        kind = self._plain(kind)
        wrong = ""
        if isinstance(kind, t.ElementaryType) and isinstance(value, t.ArrayValue | t.StructValue):
            wrong = "a list is no value of an elementary type"
        elif isinstance(value, t.ArrayValue) and any(isinstance(item.value, t.StructValue) for item in value.items):
            wrong = "matiec has no values of structures in values of arrays"
        if wrong:
            self._lost("initial value", path, wrong)
            return None
        if isinstance(value, t.SimpleValue) and isinstance(kind, t.ElementaryType) and kind.name in _REALS:
            is_whole = value.text is not None and _WHOLE.fullmatch(value.text.strip()) is not None
            return t.SimpleValue(text=f"{value.text}.0") if is_whole else value
        if isinstance(value, t.ArrayValue) and isinstance(kind, t.ArrayType):
            for item in value.items:
                item.value = self._value(kind.base, item.value, path) or item.value
        if isinstance(value, t.StructValue) and isinstance(kind, t.StructType):
            types = {member.name.casefold(): member.type for member in kind.members}
            for one in value.members:
                if one.member.casefold() in types:
                    one.value = self._value(types[one.member.casefold()], one.value, path) or one.value
        return value

    def _plain(self, kind: t.DataType) -> t.DataType:
        """Return the type that a name means."""
        for _ in self._declared:
            found = self._declared.get(kind.name.casefold()) if isinstance(kind, t.DerivedType) else None
            if found is None:
                break
            kind = found
        return kind

    def _lost(self, what: str, path: str, why: str) -> None:
        self._report.add(Outcome.NOT_EXECUTED, what, path, why)


def _constants(sections: Iterable[VariableSection]) -> dict[str, str]:
    constants = [variable for section in sections if section.constant for variable in section.variables]
    texts = {one.name.casefold(): one.initial.text for one in constants if isinstance(one.initial, t.SimpleValue)}
    return {name: text.strip() for name, text in texts.items() if text is not None and _WHOLE.fullmatch(text.strip())}


def name_structures(project: Project, report: ConversionReport) -> None:
    """Give a name to the structures, enumerations and subranges in declarations of variables and other structures."""
    namer = _Namer(project)
    for declaration in list(project.data_types):
        if isinstance(declaration.type, t.StructType):
            namer.fit(declaration.type.members, declaration.name)
        elif isinstance(declaration.type, t.ArrayType):
            declaration.type.base = namer.named(declaration.type.base, f"{declaration.name}_element")
    for pou in project.pous:
        namer.fit(pou.variables(), pou.name)
    for section in project.global_sections():
        for variable in section.variables:
            wish = f"{section.name or 'global'}_{variable.name}"
            variable.type = namer.named(variable.type, wish)
            if isinstance(variable.type, t.ArrayType):  # VAR_EXTERNAL must name the same type
                variable.type = namer.declared(variable.type, wish)
    for name in namer.given:
        report.add(Outcome.TRANSLATED, "data type", f"type {name}", "a type without a name got one")


class _Namer:
    def __init__(self, project: Project) -> None:
        self.project = project
        self.used = {one.name.casefold() for one in (*project.data_types, *project.pous)}
        self.given: list[str] = []

    def fit(self, variables: Iterable[t.Variable], owner: str) -> None:
        """Give names to what the types of `variables` hold."""
        for variable in variables:
            variable.type = self.named(variable.type, f"{owner}_{variable.name}")

    def named(self, kind: t.DataType, wish: str) -> t.DataType:
        """Return the type, or the new name of one that has none."""
        if isinstance(kind, t.ArrayType):
            kind.base = self.named(kind.base, f"{wish}_element")
            return kind
        if not isinstance(kind, t.StructType | t.EnumType | t.SubrangeType):
            return kind
        if isinstance(kind, t.StructType):
            self.fit(kind.members, wish)
        return self.declared(kind, wish)

    def declared(self, kind: t.DataType, wish: str) -> t.DerivedType:
        """Return a new data type for `kind`."""
        name, number = matiec_name(f"T_{wish}"), 1
        while name.casefold() in self.used:
            number += 1
            name = matiec_name(f"T_{wish}_{number}")
        self.used.add(name.casefold())
        self.given.append(name)
        self.project.data_types.append(t.DataTypeDeclaration(name=name, type=kind))
        return t.DerivedType(name=name)


def declare_globals(project: Project, report: ConversionReport) -> None:
    """Move lists of the project alone into a configuration, and declare in POUs the global variables that they use."""
    lists = project.global_variables
    owners: list[Configuration | Resource] = [*project.applications, *project.configurations]
    owners += [resource for configuration in project.configurations for resource in configuration.resources]
    if lists and not owners:
        owners = [Configuration(name="Config0")]
        project.configurations = [one for one in owners if isinstance(one, Configuration)]
    if lists:
        owners[0].global_variables += lists
        project.global_variables = []
    sections = [section for owner in owners for section in owner.global_variables]
    globals_ = _Globals(sections)
    if not globals_.by_name:
        return
    for text_site in list(text_sites(project)):
        if text_site.is_program_text and text_site.site.pou is not None:
            _use(text_site, globals_, project)
    for occurrence in Names(project).occurrences(*globals_.by_name):
        pou, site = occurrence.text_site.site.pou, occurrence.text_site
        declared, name = occurrence.meaning.declaration, occurrence.reference.name.casefold()
        is_global = declared is not None and declared.pou is None and site.reading is SiteKind.INSTRUCTIONS
        if pou is not None and is_global and all(each.name.casefold() != name for each in pou.variables()):
            globals_.used.setdefault(pou.name, {})[name] = None
    variables = {name: variable for name, (variable, _) in globals_.by_name.items()}
    passed = pass_globals(project, variables, globals_.used, report)
    for pou in project.pous:
        added = globals_.used.get(pou.name, {})
        if pou.name.casefold() in passed:
            continue
        if added and pou.kind is not PouKind.FUNCTION:
            _declare(pou, [globals_.by_name[name] for name in added])
            report.add(Outcome.TRANSLATED, "global variables", pou.report_path, f"{len(added)} declared as external")
        elif added:
            names = ", ".join(globals_.by_name[name][0].name for name in added)
            why = f"functions have no global variables in matiec: {names}; it does not compile"
            report.add(Outcome.NOT_EXECUTED, "global variables", pou.report_path, why)
    for section in sections:
        if section.persistent:
            section.persistent, section.retain = False, True
            report.add(Outcome.TRANSLATED, "section", "global variables", "PERSISTENT is RETAIN in matiec")
        for instance in (each for each in section.variables if each.initial is not None and _is_block(each, project)):
            instance.initial = None
            why = "matiec has no start values of its own for a global instance: it starts with those of its type"
            report.add(Outcome.NOT_EXECUTED, "initial", f"global variable {instance.name}", why)
        section.declaration = None
        section.name = None
        section.extension_data = None


def _is_block(variable: t.Variable, project: Project) -> bool:
    """True for an instance of a function block of the project."""
    name = variable.type.name.casefold() if isinstance(variable.type, t.DerivedType) else ""
    return any(pou.name.casefold() == name for pou in project.pous)


class _Globals:
    """The global variables by name, those of a list by its name, and which of them each POU uses."""

    def __init__(self, sections: list[VariableSection]) -> None:
        self.lists: dict[str, set[str]] = {}
        self.by_name: dict[str, tuple[t.Variable, VariableSection]] = {}
        self.used: dict[str, dict[str, None]] = {}
        for section in sections:
            for variable in section.variables:
                self.by_name.setdefault(variable.name.casefold(), (variable, section))
                if section.name:
                    self.lists.setdefault(section.name.casefold(), set()).add(variable.name.casefold())


@dataclass(slots=True)
class _Resolver:
    """Replaces ``List.x`` by ``x`` and notes what is used."""

    globals: _Globals
    own: frozenset[str]
    used: dict[str, None]

    def __call__(self, node: n.Node) -> n.Node:
        if isinstance(node, n.Member) and isinstance(node.base, n.Name):
            members = self.globals.lists.get(node.base.identifier.casefold(), set())
            name = node.name.identifier.casefold()
            if name in members and node.base.identifier.casefold() not in self.own and name not in self.own:
                self.used[name] = None
                return node.name
        return node


def _use(text_site: TextSite, globals_: _Globals, project: Project) -> None:
    pou = text_site.site.pou
    if pou is None:
        return
    own = frozenset(v.name.casefold() for v in pou.variables()) | frozenset(_steps(pou))
    used = globals_.used.setdefault(pou.name, {})
    parsed = text_site.parsed(project.dialect)
    if parsed.problems:
        return
    tree = transform(parsed.tree, _Resolver(globals_, own, used))
    if tree is not parsed.tree:
        text_site.put(render(parsed, tree))
    for node in walk(tree):
        if isinstance(node, n.Name) and node.identifier.casefold() in globals_.by_name.keys() - own:
            used[node.identifier.casefold()] = None


def _steps(pou: Pou) -> Iterator[str]:
    if pou.chart is not None:
        yield from (step.name.casefold() for step in pou.chart.steps)


def _declare(pou: Pou, found: list[tuple[t.Variable, VariableSection]]) -> None:
    if pou.interface is None:
        pou.interface = Interface()
    for constant in (False, True):
        variables = [
            t.Variable(name=variable.name, type=variable.type)
            for variable, section in found
            if section.constant is constant
        ]
        if variables:
            section = VariableSection(kind=SectionKind.EXTERNAL, constant=constant, variables=variables)
            pou.interface.sections.append(section)


def variable_names(project: Project) -> Iterator[str]:
    """Yield the names of all variables of a project, in lower case."""
    for section in project.global_sections():
        yield from (variable.name.casefold() for variable in section.variables)
    for pou in project.pous:
        yield from (variable.name.casefold() for variable in pou.variables())


def with_quotes(variable: t.Variable, names: Container[str], wide: bool | None = None) -> t.Variable:
    """Return the variable with its value as a literal, if it is a string; a value of `names` is that of a constant.

    `wide` is that of the type of strings that the type of the variable names.
    """
    value = variable.initial
    if isinstance(variable.type, t.StringType):
        wide = variable.type.wide
    if wide is None or not isinstance(value, t.SimpleValue) or value.text is None:
        return variable
    quote = '"' if wide else "'"
    text = value.text.strip()
    if text[:1] in ("'", '"') or _TYPED.match(text) or text.casefold() in names:
        return variable
    inner = _ESCAPES.sub(lambda found: found[0] if found[0] not in ("$", quote) else f"${found[0]}", text)
    return variable.model_copy(update={"initial": t.SimpleValue(text=f"{quote}{inner}{quote}")})


_TYPED = re.compile(r"W?STRING(?:\[\d+\])?#", re.IGNORECASE)
_ESCAPES = re.compile(r"\$(?:[$'\"LlNnPpRrTt]|[0-9A-Fa-f]{2})|[$'\"]")
"""Escapes of literals, and signs that need one."""


def quote_strings(project: Project, names: Container[str]) -> None:
    """Put the values of all variables and structures whose type is a string in quotes, but for those of `names`."""
    wide = {
        declaration.name.casefold(): declaration.type.wide
        for declaration in project.data_types
        if isinstance(declaration.type, t.StringType)
    }

    def quoted(variable: t.Variable) -> t.Variable:
        named = variable.type.name.casefold() if isinstance(variable.type, t.DerivedType) else ""
        return with_quotes(variable, names, wide.get(named))

    lists = [pou.interface.sections for pou in project.pous if pou.interface is not None]
    for section in (section for sections in (*lists, project.global_sections()) for section in sections):
        section.variables = [quoted(variable) for variable in section.variables]
    for declaration in project.data_types:
        if isinstance(declaration.type, t.StructType):
            declaration.type.members = [quoted(member) for member in declaration.type.members]
        elif isinstance(declaration.type, t.StringType):
            of_type = t.Variable(name=declaration.name, type=declaration.type, initial=declaration.initial)
            declaration.initial = with_quotes(of_type, names).initial
