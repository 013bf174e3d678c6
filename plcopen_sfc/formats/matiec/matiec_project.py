"""A project as matiec compiles it: each POU with a body in text or a chart, and a configuration that runs them."""

from __future__ import annotations

import re
from graphlib import CycleError, TopologicalSorter

from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.matiec.action_charts import make_blocks
from plcopen_sfc.formats.matiec.matiec_charts import ChartFitter
from plcopen_sfc.formats.matiec.matiec_declarations import (
    TypeFitter,
    declare_globals,
    give_plain_names,
    is_matiec_name,
    matiec_name,
    name_structures,
    note_undeclared,
    quote_strings,
    variable_names,
)
from plcopen_sfc.formats.matiec.matiec_expressions import fit_expressions
from plcopen_sfc.formats.matiec.matiec_functions import note_calls
from plcopen_sfc.formats.matiec.matiec_library import note_functions
from plcopen_sfc.formats.matiec.matiec_pou import FittedPou
from plcopen_sfc.formats.matiec.matiec_statements import (
    compilable_instructions,
    compilable_statements,
    gives_to_operators,
    without_for,
)
from plcopen_sfc.languages.binding import Names, called_actions
from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.name_scopes import is_instance
from plcopen_sfc.languages.binding.text_sites import SiteKind, TextSite, text_sites
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.s7_types import Constant, constants_of
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.st.nodes import Assignment
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.task_schedules import duration_literal, iec_form, nanoseconds, schedule_of
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Configuration, PouInstance, Project, Resource, Task
from plcopen_sfc.model.sfc import Body, SfcBody
from plcopen_sfc.model.types import (
    ArrayType,
    DataType,
    DataTypeDeclaration,
    DerivedType,
    Elementary,
    ElementaryType,
    EnumType,
    SimpleValue,
    StructType,
    StructValue,
    element_type,
    used_types,
)
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.report import ConversionReport, Outcome

_ORDER = (PouKind.FUNCTION, PouKind.FUNCTION_BLOCK, PouKind.PROGRAM)

_QUALIFIER = re.compile(r"\w+\s*[.#]\s*\Z")


def fit_project(
    project: Project, options: WriteOptions, report: ConversionReport, *, keeps_drawings: bool = False
) -> None:
    """Change `project`, a copy, into what matiec executes in the same way; `report` gets what it cannot execute.

    `options` tell the tool of the project.
    `keeps_drawings`: for the converters of Beremiz and OpenPLC, which translate FBD, LD and drawn conditions for it.
    """
    own = options.of_matiec
    final_scan = None if own else options.of_codesys
    _note_steps_of_instances(project, report)
    _note_instances_in_types(project, report)
    name_structures(project, report)
    _number_enumerations(project, report)
    give_plain_names(project, report)
    types = TypeFitter(project.data_types, report, own=own)
    constants = types.sections(project.global_sections(), "", {})
    lists = frozenset(section.name.casefold() for section in project.global_sections() if section.name)
    make_blocks(project, report, of_codesys=options.of_codesys)
    _note_calls_of_actions(project, report)
    _note_uses_of_programs(project, report)
    declare_globals(project, report)
    for declaration in project.data_types:
        types.declaration(declaration)
    project.data_types = _types_in_order(project)
    quote_strings(project, frozenset(variable_names(project)))
    functions = _typed_functions(project)
    names = frozenset(declaration.name.casefold() for declaration in project.data_types)
    globals_ = frozenset(v.name.casefold() for section in project.global_sections() for v in section.variables)
    for pou in project.pous:
        if pou.interface is not None:
            types.interface(pou.interface, pou.report_path, constants)
        unit = FittedPou(pou, project.dialect, report, own, names, globals_, functions, keeps_drawings)
        starts = _start_values(unit, project) if keeps_drawings and not own else []
        _fit_pou(unit, final_scan, starts, same_loops=options.of_matiec, relies=options.of_graph or options.of_grafcet)
    _configure(project, report, lists)
    note_calls(project, report, own=own)
    fit_expressions(project, report, same_library=own)
    if not own:
        note_functions(project, report, "the source")
    if keeps_drawings:
        _note_structures(project, report)
    else:
        note_undeclared(project, report)


def _note_steps_of_instances(project: Project, report: ConversionReport) -> None:
    """Report texts that ask an instance for its steps: matiec takes them, and its C code does not compile."""
    blocks = {chart.pou.name: chart for chart in project.charts() if chart.pou.kind is PouKind.FUNCTION_BLOCK}
    names = Names(project)
    for chart in blocks.values():
        steps = [names.declaration_of(step) for step in chart.chart.steps]
        for each in names.occurrences(*(step.name for step in chart.chart.steps), of=steps):
            if each.text_site.site.pou is not chart.pou and each.meaning.declaration in steps:
                why = f"`{each.reference.name}` is a step of {chart.pou.name}, and matiec knows steps in their POU only"
                report.add(Outcome.NOT_EXECUTED, "text", each.text_site.report_path, f"{why}: give it an output")


def _note_calls_of_actions(project: Project, report: ConversionReport) -> None:
    """Report texts that call an action: matiec executes actions by their associations alone."""
    for pou in project.pous:
        names = {action.name.casefold(): action.name for action in pou.actions}
        for place, _, body in pou.named_bodies():
            for called in [] if isinstance(body, SfcBody) else sorted(called_actions(body, pou, project.dialect)):
                why = f"matiec has no calls of actions: put the statements of `{names[called]}` there"
                report.add(Outcome.NOT_EXECUTED, "call of an action", pou.report_path_of(place), why)


def _note_uses_of_programs(project: Project, report: ConversionReport) -> None:
    """Report POUs that call a program or name its variables: matiec executes programs by tasks alone."""
    programs = {id(pou): pou.name for pou in project.pous if pou.kind is PouKind.PROGRAM}
    found: dict[tuple[str, str], None] = {}
    for each in Names(project).occurrences(*programs.values()) if programs else ():
        declaration, user = each.meaning.declaration, each.text_site.site.pou
        program = declaration.holder if declaration is not None else None
        if id(program) in programs and user is not None and user is not program:
            found[user.report_path, programs[id(program)]] = None
    for path, name in found:
        why = f"matiec has no calls of programs: make {name} a function block, and an instance of it"
        report.add(Outcome.NOT_EXECUTED, "call of a program", path, why)


def _note_instances_in_types(project: Project, report: ConversionReport) -> None:
    """Report function blocks in arrays and structures, which matiec does not compile."""
    for pou in project.pous:
        for variable in pou.variables():
            base = variable.type.base if isinstance(variable.type, ArrayType) else None
            if isinstance(base, DerivedType) and is_instance(base, project):
                path = f"{pou.report_path} / variable {variable.name}"
                why = f"matiec has no arrays of function blocks: declare instances of {base.name}"
                report.add(Outcome.NOT_EXECUTED, "variable", path, why)
    for declaration in project.data_types:
        for member in declaration.type.members if isinstance(declaration.type, StructType) else ():
            kind = element_type(member.type)
            if isinstance(kind, DerivedType) and is_instance(kind, project):
                path = f"{declaration.report_path} / {member.name}"
                why = f"matiec has no function blocks in structures: declare an instance of {kind.name} in the POU"
                report.add(Outcome.NOT_EXECUTED, "type", path, why)


def _note_structures(project: Project, report: ConversionReport) -> None:
    """Report uses of structures that OpenPLC refuses: its converter makes function blocks of them."""
    resolver = Resolver(project, project.dialect)
    structures = {one.name.casefold() for one in project.data_types if isinstance(one.type, StructType)}
    found: dict[str, dict[str, None]] = {}

    def note(path: str, what: str) -> None:
        found.setdefault(path, {})[what] = None

    def is_structure(kind: DataType | None) -> bool:
        return isinstance(kind, DerivedType) and kind.name.casefold() in structures

    for one in project.data_types:
        kinds = [one.type, *(member.type for member in getattr(one.type, "members", []))]
        if any(isinstance(kind, ArrayType) and is_structure(kind.base) for kind in kinds):
            note(f"data type {one.name}", one.name)
    for pou in project.pous:
        is_function = pou.kind is PouKind.FUNCTION
        if is_function and pou.interface is not None and is_structure(pou.interface.return_type):
            note(pou.report_path, pou.name)
        for section in sections_of(pou.interface):
            passed = is_function or section.kind in (SectionKind.INPUT, SectionKind.IN_OUT)
            for variable in section.variables:
                is_array = isinstance(variable.type, ArrayType) and is_structure(variable.type.base)
                if is_array or (passed and is_structure(variable.type)):
                    note(pou.report_path, variable.name)
    for text_site in text_sites(project):
        owner = text_site.site.pou
        if owner is None or text_site.reading is not SiteKind.STATEMENTS or not text_site.is_program_text:
            continue
        for node in walk(text_site.parsed(project.dialect).tree):
            if isinstance(node, Assignment) and isinstance(resolver.type_of(node.target, text_site.site), StructType):
                note(owner.report_path, print_node(node.target))
    for path, uses in found.items():
        why = (
            "Beremiz compiles it, and OpenPLC does not, which makes function blocks of structures: no arrays, "
            f"parameters and assignments of them: {', '.join(uses)}"
        )
        report.add(Outcome.APPROXIMATED, "structure", path, why)


def _typed_functions(project: Project) -> dict[str, DataType]:
    """Return the types of the results of functions; those without a result get one, which matiec wants."""
    kinds: dict[str, DataType] = {}
    for pou in project.pous:
        if pou.kind is not PouKind.FUNCTION:
            continue
        if pou.interface is None:
            pou.interface = Interface()
        if pou.interface.return_type is None:
            pou.interface.return_type = ElementaryType(name=Elementary.BOOL)
            pou.bodies = [*pou.bodies, StBody(text=f"{pou.name} := FALSE;")]
        kinds[pou.name.casefold()] = pou.interface.return_type
    return kinds


# -- enumerations -----------------------------------------------------------------------------------------------------


def _number_enumerations(project: Project, report: ConversionReport) -> None:
    """Change enumerations of `project`, a copy, that do not count from 0 into types of numbers: matiec counts so.

    Numbers take the places of the values: ``State := 99;`` for ``State := E_State.Fault;``.
    """
    numbered = [(each, found) for each in project.data_types if (found := _numbers(each))]
    numbers = {
        id(value): constant.number
        for declaration, found in numbered
        if isinstance(declaration.type, EnumType)
        for value, constant in zip(declaration.type.values, found, strict=True)
    }
    words = {constant.value for _, found in numbered for constant in found}
    edits: dict[tuple[int, str | int], tuple[TextSite, list[Edit]]] = {}
    for occurrence in Names(project).occurrences(*words) if words else ():
        declared, text_site = occurrence.meaning.declaration, occurrence.text_site
        number = numbers.get(id(declared.holder)) if declared is not None else None
        if number is not None:
            start, end = occurrence.reference.span
            qualifier = _QUALIFIER.search(text_site.text[:start])
            edit = Edit(qualifier.start() if qualifier is not None else start, end, str(number))
            edits.setdefault((id(text_site.holder), text_site.key), (text_site, []))[1].append(edit)
    for text_site, changes in edits.values():
        text_site.put(apply_edits(text_site.text, sorted(changes, key=lambda edit: edit.start)))
    for declaration, constants in numbered:
        if declaration.initial is None:
            declaration.initial = SimpleValue(text=str(constants[0].number))
        base = declaration.type.base if isinstance(declaration.type, EnumType) else None
        declaration.type = base or ElementaryType(name=Elementary.INT)
        why = "a type of numbers, which take the places of its values: matiec numbers enumerations from 0"
        report.add(Outcome.TRANSLATED, "enumeration", f"data type {declaration.name}", why)


def _numbers(declaration: DataTypeDeclaration) -> list[Constant]:
    """Return the values of an enumeration that does not count from 0; none for others."""
    found = constants_of(declaration)
    return found if any(each.number != number for number, each in enumerate(found)) else []


# -- POUs -------------------------------------------------------------------------------------------------------------


def _fit_pou(unit: FittedPou, final_scan: bool | None, starts: list[str], *, same_loops: bool, relies: bool) -> None:
    """Change a POU into one that matiec compiles: one body, actions of its chart only, statements in its spelling.

    `starts` are the assignments of start values, which the first scan executes.
    """
    pou = unit.pou
    if pou.kind is PouKind.ORGANIZATION_BLOCK:
        pou.kind = PouKind.PROGRAM
    pou.methods = []  # those that are no functions are told
    if pou.interface is not None:
        pou.interface.declaration = None
        _check_addresses(unit)
        for section in pou.interface.sections:
            if kept(section.extension_data).get("keyword") == "VAR_STAT":
                unit.note(Outcome.NOT_EXECUTED, "section", unit.path, "matiec has no VAR_STAT, one for all instances")
            if section.persistent:
                section.persistent, section.retain = False, True
                unit.note(Outcome.TRANSLATED, "section", unit.path, "PERSISTENT is RETAIN in matiec")
        pou.interface.sections = [part for section in pou.interface.sections for part in _by_location(section)]
    body = _one_body(unit)
    started = starts if isinstance(body, SfcBody | StBody) else []
    if starts and not started:
        why = f"the converters leave out start values of instances, and no statement gives them: {'; '.join(starts)}"
        unit.note(Outcome.NOT_EXECUTED, "initial", unit.path, why)
    elif starts:
        once = unit.declare("values_given")
        started = [
            f"IF NOT {once} THEN\n" + "\n".join(f"    {each};" for each in starts) + f"\n    {once} := TRUE;\nEND_IF;"
        ]
    if isinstance(body, StBody) and started:
        body = StBody(text=f"{started[0]}\n{body.text}")
    for action in pou.actions:
        action.body = unit.action(action.body or StBody(), f"{unit.path} / action {action.name}", action.name)
    if isinstance(body, SfcBody) and not body.chart.initial_steps:
        unit.note(Outcome.NOT_EXECUTED, "chart", unit.path, "it has no initial step; the text does not compile there")
        body = StBody(text=unit.uncompilable("chart"))
    if isinstance(body, SfcBody):
        ChartFitter(unit, body.chart, final_scan, relies, started).fit()
        executed = {(a.target or "").casefold() for _, a in body.chart.associations()}
        pou.actions = [action for action in pou.actions if action.name.casefold() in executed]
    else:
        for action in pou.actions:
            why = "matiec has actions of charts only"
            unit.note(Outcome.NOT_EXECUTED, "action", f"{unit.path} / action {action.name}", why)
        pou.actions = []
        pou.transitions = []
    pou.bodies = [body]
    written = [body, *(action.body for action in pou.actions)]
    for text in written:
        if isinstance(text, StBody):
            looping, obstacles = (text.text, []) if same_loops else without_for(text.text, unit.dialect)
            for obstacle in obstacles:
                unit.note(Outcome.APPROXIMATED, "loop", unit.path, obstacle)
            shown = compilable_statements(looping, unit.dialect, unit.idle, unit.result)
            text.text, text.markup = shown.strip("\n"), None
        elif isinstance(text, IlBody):
            text.text, text.markup = compilable_instructions(text.text, unit.dialect).strip("\n"), None
    if not pou.variables():
        unit.idle()  # the converters of Beremiz and OpenPLC refuse a POU without variables


def _start_values(unit: FittedPou, project: Project) -> list[str]:
    """Return assignments for the start values of instances, which the converters before matiec leave out."""
    blocks = {pou.name.casefold(): pou for pou in project.pous if pou.kind is PouKind.FUNCTION_BLOCK}
    found: list[str] = []
    for section in sections_of(unit.pou.interface):
        for variable in section.variables:
            kind, value = variable.type, variable.initial
            if value is None or not isinstance(kind, DerivedType) or kind.name.casefold() in unit.types:
                continue
            variable.initial = None
            block, standard = blocks.get(kind.name.casefold()), standard_block(kind.name)
            inputs = {pin.name.casefold() for pin in standard.inputs} if standard is not None else set()
            for inner in sections_of(block.interface) if block is not None else ():
                inputs |= {each.name.casefold() for each in inner.variables if inner.kind is SectionKind.INPUT}
            members = value.members if isinstance(value, StructValue) else []
            given = [(one.member, one.value.text) for one in members if isinstance(one.value, SimpleValue)]
            if not members or len(given) < len(members) or section.retain or {m.casefold() for m, _ in given} - inputs:
                path = f"{unit.path} / variable {variable.name}"
                why = "the converters leave out start values of instances, and no statement gives them"
                unit.note(Outcome.NOT_EXECUTED, "initial", path, why)
            else:
                found += [f"{variable.name}.{member} := {text}" for member, text in given]
                path = f"{unit.path} / variable {variable.name}"
                unit.note(
                    Outcome.TRANSLATED, "initial", path, "statements of the first scan: the converters leave it out"
                )
    return found


def _check_addresses(unit: FittedPou) -> None:
    """Take off addresses that matiec does not take: it has them at local variables of programs."""
    for section in sections_of(unit.pou.interface):
        for variable in section.variables:
            address = variable.address
            if address is None:
                continue
            local = section.kind is SectionKind.LOCAL
            wrong = not address.startswith("%") or not local
            if wrong or (unit.pou.kind is not PouKind.PROGRAM and "*" not in address):
                place = f"{unit.path} / variable {variable.name}"
                unit.note(Outcome.NOT_EXECUTED, "address", place, f"matiec does not take {address} there")
                variable.address = None


def _by_location(section: VariableSection) -> list[VariableSection]:
    """Return variables with and without an address: matiec does not take them in one section."""
    parts = []
    for located in (False, True):
        variables = [v for v in section.variables if (v.address is not None) is located]
        if variables:
            parts.append(section.model_copy(update={"variables": variables}))
    return parts


def _one_body(unit: FittedPou) -> Body:
    """Return the body of a POU: a chart, instructions, or all its statements."""
    bodies = unit.pou.bodies
    charts = [body for body in bodies if isinstance(body, SfcBody) and body.chart.steps]
    alone: list[Body] = [*charts] or [body for body in bodies if isinstance(body, IlBody)]
    if len(bodies) == 1 and isinstance(bodies[0], FbdBody | LdBody):
        return unit.fitted(bodies[0], unit.path, "body")
    if alone and len(bodies) > 1:
        unit.note(Outcome.NOT_EXECUTED, "body", unit.path, "matiec has one body for each POU")
    if alone and len(bodies) == 1:
        return _compilable_calls(unit, alone[0]) if isinstance(alone[0], IlBody) else alone[0]
    texts: list[str] = []
    for body in bodies:
        if isinstance(body, SfcBody) and not body.chart.steps:
            continue
        text = unit.statements(body, unit.path)
        texts.append(unit.uncompilable("body") if text is None else text)
    return StBody(text="\n".join(texts))


def _compilable_calls(unit: FittedPou, body: IlBody) -> Body:
    """Return instructions without calls that give R or S a value: matiec reads these as operators there."""
    if not gives_to_operators(body.text, unit.dialect):
        return body
    text = unit.statements(body, unit.path)
    return StBody(text=unit.uncompilable("body") if text is None else text)


# -- types ------------------------------------------------------------------------------------------------------------


def _types_in_order(project: Project) -> list[DataTypeDeclaration]:
    """Return the data types, each behind those that it uses: matiec knows what it has read."""
    types = {one.name.casefold(): one for one in project.data_types}
    uses = {name: {u.casefold() for u in used_types(one.type)} & types.keys() for name, one in types.items()}
    return [types[name] for name in _ordered(uses)]


def pous_in_order(project: Project) -> list[Pou]:
    """Return the POUs, each behind those that it calls."""
    pous = {pou.name.casefold(): pou for pou in project.pous}
    kinds = sorted(pous, key=lambda name: _ORDER.index(pous[name].kind))
    functions = {name for name in kinds if pous[name].kind is PouKind.FUNCTION}
    calls = {name: _called(pous[name], functions, project.dialect) & (pous.keys() - {name}) for name in kinds}
    return [pous[name] for name in _ordered(calls)]


def _ordered(uses: dict[str, set[str]]) -> list[str]:
    try:
        return list(TopologicalSorter(uses).static_order())
    except CycleError:
        return list(uses)


def _called(pou: Pou, functions: set[str], dialect: Dialect) -> set[str]:
    """Return the names of types and functions that a POU uses, in lower case; members may have the names of blocks."""
    names = {name.casefold() for variable in pou.variables() for name in used_types(variable.type)}
    for _, _, body in pou.named_bodies():
        texts = [body.text] if isinstance(body, StBody | IlBody) else []
        if isinstance(body, SfcBody):
            texts = [getattr(t.condition, "text", "") for t in body.chart.transitions]
        for text in texts:
            words = {token.value.casefold() for token in tokenize(text, dialect).tokens if token.type == "NAME"}
            names |= words & functions
    return names


# -- configurations ---------------------------------------------------------------------------------------------------


def _configure(project: Project, report: ConversionReport, lists: frozenset[str]) -> None:
    """One configuration for all: programs that nothing runs get a task of 20 ms.

    `lists` are the names of the lists of global variables, which matiec does not know.
    """
    for application in project.applications:
        around = Configuration(name=application.name, resources=[application])
        # matiec takes an instance of a block that a resource declares for another variable than the external one
        around.global_variables, application.global_variables = application.global_variables, []
        project.configurations.append(around)
    project.applications = []
    _leave_out_config_variables(project, report)
    _leave_out_idle_resources(project)
    programs = [pou.name for pou in project.pous if pou.kind is PouKind.PROGRAM]
    if programs and not any(_instances(one) for one in project.configurations):
        instances = [PouInstance(name=f"Inst{i}", type_name=name) for i, name in enumerate(programs)]
        found = next((r for c in project.configurations for r in c.resources), None)
        if found is None:
            found = Resource(name="Res0")
            if not project.configurations:
                project.configurations.append(Configuration(name="Config0"))
            project.configurations[0].resources.append(found)
        _add_task(found, Task(name="Task0", interval="T#20ms", instances=instances), report)
    elif programs and not any(resource.tasks for one in project.configurations for resource in one.resources):
        # instances without a task run as often as they can, and matiec takes the time of that from the tasks there are
        resource = next(each for one in project.configurations for each in one.resources if each.instances)
        _add_task(resource, Task(name="Task0", interval="T#20ms"), report)
    used = {pou.name.casefold() for pou in project.pous} | {one.name.casefold() for one in project.data_types}
    used.add("plc")  # each resource is written as one on a PLC, where Beremiz calls the compiler with -p
    for configuration in project.configurations:
        configuration.name = _free(configuration.name, used, f"configuration {configuration.name}", report)
        for resource in configuration.resources:
            resource.name = _free(resource.name, used, f"resource {resource.name}", report)
            for task in resource.tasks:
                _fit_task(task, report, lists)
                task.name = _free(task.name, used, f"task {task.name}", report)
            for instance in resource.every_instance():
                if not instance.type_name:
                    instance.type_name = instance.name
                instance.name = _free(instance.name, used, f"instance {instance.name}", report)


def _add_task(resource: Resource, task: Task, report: ConversionReport) -> None:
    resource.tasks.append(task)
    why = "no task ran the programs; they get one of 20 ms"
    report.add(Outcome.TRANSLATED, "task", f"task {task.name}", why)


def _leave_out_idle_resources(project: Project) -> None:
    """Leave out resources that run nothing, where another one does or no program is there: matiec reads none."""
    runs = any(map(_instances, project.configurations))
    if not runs and any(pou.kind is PouKind.PROGRAM for pou in project.pous):
        return  # the programs get a task in one of them
    for configuration in project.configurations:
        for resource in configuration.resources:
            if not resource.every_instance():
                configuration.global_variables += resource.global_variables
        configuration.resources = [each for each in configuration.resources if each.every_instance()]
    project.configurations = [each for each in project.configurations if each.resources]


def _leave_out_config_variables(project: Project, report: ConversionReport) -> None:
    """Leave out VAR_CONFIG, which matiec reads, and of which nothing is in the C code that it writes."""
    owners: list[Project | Configuration] = [project, *project.configurations]
    for owner in owners:
        for variable in owner.config_variables.variables if owner.config_variables is not None else ():
            why = "matiec gives variables no values and addresses by VAR_CONFIG"
            report.add(Outcome.NOT_EXECUTED, "VAR_CONFIG", f"VAR_CONFIG {variable.path}", why)
        owner.config_variables = None


def _fit_task(task: Task, report: ConversionReport, lists: frozenset[str]) -> None:
    """Give a task the terms of IEC 61131-3, and one without a period some: matiec computes the time of a scan of it."""
    form, schedule = iec_form(task, lists), schedule_of(task)
    task.interval, task.single, task.settings = duration_literal(form["interval"]), form["single"], None
    if schedule.interval is not None and nanoseconds(schedule.interval) is None:
        why = f"the cycle is that of the variable {schedule.interval}, which matiec does not take: 20 ms"
        report.add(Outcome.NOT_EXECUTED, "interval", f"task {task.name}", why)
    elif schedule.event is not None or schedule.interval is not None:
        return
    else:
        why = "none is set, and matiec wants one: 20 ms"
        report.add(Outcome.APPROXIMATED, "interval", f"task {task.name}", why)
    task.interval = "T#20ms"


def _instances(configuration: Configuration) -> list[PouInstance]:
    return [instance for resource in configuration.resources for instance in resource.every_instance()]


def _free(name: str, used: set[str], path: str, report: ConversionReport) -> str:
    """Return a name that nothing else has: matiec and the converters before it take each of them once."""
    new = take_name(name if is_matiec_name(name) else matiec_name(name), used, first=1)
    if new != name:
        why = "matiec takes each name once" if is_matiec_name(name) else f"matiec does not take {name!r}"
        report.add(Outcome.TRANSLATED, "name", path, f"renamed to {new}: {why}")
    return new
