"""Functions that use global variables, as matiec has them, and calls that it does not link or not make.

It compiles no function that uses global variables, so that calls pass them.

A function gets them as parameters of their names: as inputs, or as in-out parameters where it writes them or what it
calls does::

    n := Count(part);      n := Count(part, Machine);
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.languages.binding import ANYTHING, bind
from plcopen_sfc.languages.binding.name_scopes import is_instance
from plcopen_sfc.languages.binding.text_sites import SiteKind, TextSite, text_sites
from plcopen_sfc.languages.effects import effects
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, walk
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression as ConditionText
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import PASSED, Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.report import ConversionReport, Outcome


def pass_globals(
    project: Project, variables: Mapping[str, Variable], used: dict[str, dict[str, None]], report: ConversionReport
) -> frozenset[str]:
    """Let calls of the functions of `project` pass the global variables that these use; the names of such functions.

    `variables` are the global ones by their names in lower case, `used` those that each POU uses: callers use them too.
    A function that a network or an instruction list calls stays as it is, and so does one whose caller hides a name.
    """
    functions = {pou.name.casefold(): pou for pou in project.pous if pou.kind is PouKind.FUNCTION}
    sites = [each for each in text_sites(project) if each.site.pou is not None]
    calls = [(each, _called(each, functions, project)) for each in sites if each.is_program_text]
    needed = {key: dict(used.get(pou.name, {})) for key, pou in functions.items()}
    for _ in functions:  # a function passes what those that it calls need
        for text_site, called in calls:
            caller = _name(text_site)
            for name in called & needed.keys():
                needed.get(caller, {}).update(needed[name])
    needed = {key: names for key, names in needed.items() if names}
    passing = _Passing(project, functions, needed)
    lost = {name for each in sites for name in needed if _is_drawn(each, name)}
    instances = {name for name, variable in variables.items() if is_instance(variable.type, project)}
    lost |= {key for key, names in needed.items() if not instances.isdisjoint(names)}  # no function gets one
    for text_site, called in calls:
        hidden = _own_names(text_site)
        lost |= {name for name in called & needed.keys() if not hidden.isdisjoint(needed[name])}
        lost |= passing.text(text_site)[1] if called else set()
    for _ in functions:  # a function that does not get them passes none
        for text_site, called in calls:
            lost |= called if _name(text_site) in lost else set()
    passing.needed = needed = {key: names for key, names in needed.items() if key not in lost}
    for key, names in needed.items():
        passing.added[key] = _add_parameters(functions[key], names, variables, needed, project)
    for text_site, called in calls:
        if called & needed.keys():
            text_site.put(passing.text(text_site)[0])
            if _name(text_site) not in functions and text_site.site.pou is not None:
                own = {variable.name.casefold() for variable in text_site.site.pou.variables()}
                more = (each for name in called & needed.keys() for each in needed[name] if each not in own)
                used.setdefault(text_site.site.pou.name, {}).update(dict.fromkeys(more))
    for key, names in needed.items():
        why = f"calls pass {', '.join(variables[name].name for name in names)}: functions have no global ones in matiec"
        report.add(Outcome.TRANSLATED, "global variables", functions[key].report_path, why)
    return frozenset(needed)


def _name(text_site: TextSite) -> str:
    return text_site.site.pou.name.casefold() if text_site.site.pou is not None else ""


def _own_names(text_site: TextSite) -> set[str]:
    """Return the names that hide global variables in a text."""
    pou = text_site.site.pou
    sections = pou.interface.sections if pou is not None and pou.interface is not None else ()
    own = (each for each in sections if each.kind is not SectionKind.EXTERNAL)
    return {variable.name.casefold() for section in own for variable in section.variables}


def _called(text_site: TextSite, functions: Mapping[str, Pou], project: Project) -> set[str]:
    """Return the functions that a text calls, in lower case."""
    if not any(name in text_site.text.casefold() for name in functions):
        return set()
    return _called_in(text_site.parsed(project.dialect).tree, functions)


def _called_in(tree: n.Node, functions: Mapping[str, Pou]) -> set[str]:
    return {each.called.casefold() for each in walk(tree) if isinstance(each, n.Call)} & functions.keys()


def _is_drawn(text_site: TextSite, name: str) -> bool:
    """True for a box that calls a function, and for instructions that may."""
    text = text_site.text.casefold()
    if text_site.reading is SiteKind.INSTRUCTIONS:
        return name in text
    return isinstance(text_site.holder, Block) and text_site.key == "type_name" and text == name


def _add_parameters(
    function: Pou,
    names: Mapping[str, None],
    variables: Mapping[str, Variable],
    needed: Mapping[str, Mapping[str, None]],
    project: Project,
) -> list[str]:
    """Give a function its global variables as parameters; their names in the order of these."""
    trees = [parse_statements(body.text, project.dialect).tree for body in function.bodies if isinstance(body, StBody)]
    written = {path[0] for tree in trees for path in effects(tree.statements).writes if path}
    written |= {
        name
        for tree in trees
        for call in walk(tree)
        if isinstance(call, n.Call)
        for name in needed.get(call.called.casefold(), ())
    }
    sections = [VariableSection(kind=kind) for kind in (SectionKind.INPUT, SectionKind.IN_OUT)]
    for name in names:
        section = sections[name in written]
        section.variables.append(Variable(name=variables[name].name, type=variables[name].type.model_copy(deep=True)))
    function.interface = function.interface or Interface()
    function.interface.sections = [*function.interface.sections, *(each for each in sections if each.variables)]
    return [variable.name for section in sections for variable in section.variables]


def _parameters(function: Pou) -> Iterator[str]:
    sections = sections_of(function.interface)
    yield from (variable.name for each in sections if each.kind in PASSED for variable in each.variables)


@dataclass(slots=True)
class _Passing:
    """The global variables that functions need, in lower case, and the parameters that they have got for them."""

    project: Project
    functions: Mapping[str, Pou]
    needed: dict[str, dict[str, None]]
    added: dict[str, list[str]] = field(default_factory=dict)

    def text(self, text_site: TextSite) -> tuple[str, set[str]]:
        """Return a text whose calls pass global variables, and the functions of which a call lacks arguments."""
        lacking: set[str] = set()

        def change(node: n.Node) -> n.Node:
            key = node.called.casefold() if isinstance(node, n.Call) else ""
            if not isinstance(node, n.Call) or key not in self.needed:
                return node
            names = self.added.get(key, [])
            is_named = all(each.name is not None for each in node.arguments)
            if not is_named and len(node.arguments) + len(names) != len([*_parameters(self.functions[key])]):
                lacking.add(key)
                return node
            passed = (n.Argument(n.Name(name), n.Name(name) if is_named else None) for name in names)
            return n.Call(node.callee, (*node.arguments, *passed))

        return text_site.rewritten(self.project.dialect, change), lacking


def note_calls(project: Project, report: ConversionReport, *, own: bool) -> None:
    """Report calls of functions that write what is outside of them, where matiec does not link or not make them.

    `own`: the texts are of a project for matiec, which does not make them either.
    """
    passing = {pou.name.casefold(): pou for pou in project.pous if _passed(pou)}
    acting = {name: pou for name, pou in passing.items() if _changes(pou, passing, project.dialect)}
    for text_site in text_sites(project) if passing else ():
        if not text_site.is_program_text or not (called := _called(text_site, passing, project)):
            continue
        is_condition = isinstance(text_site.holder, ConditionText) or text_site.site.transition is not None
        for name in sorted(called) if is_condition else ():
            why = f"matiec does not link `{passing[name].name}` in a condition: it has VAR_IN_OUT or VAR_OUTPUT"
            report.add(Outcome.NOT_EXECUTED, "condition", text_site.report_path, why)
        behind = [
            operand
            for node in walk(text_site.parsed(project.dialect).tree)
            if isinstance(node, n.Operation) and node.operator in (n.Operator.AND, n.Operator.OR)
            for operand in node.operands[1:]
        ]
        for name in () if own else sorted(set().union(*(_called_in(each, acting) for each in behind))):
            told = acting[name].name
            why = f"matiec does not call `{told}` behind an operand of AND or OR that decides: assign its result before"
            report.add(Outcome.APPROXIMATED, "operation", text_site.report_path, why)


def _passed(pou: Pou) -> set[str]:
    """Variables of a function that are others outside of it, in lower case."""
    kinds = (SectionKind.IN_OUT, SectionKind.OUTPUT, SectionKind.EXTERNAL)
    sections = sections_of(pou.interface) if pou.kind is PouKind.FUNCTION else ()
    return {one.name.casefold() for section in sections if section.kind in kinds for one in section.variables}


def _changes(pou: Pou, passing: Mapping[str, Pou], dialect: Dialect) -> bool:
    """True if a function may write what is outside of it, by itself or by a call of others that can."""
    found = [bind(body, dialect) for body in pou.bodies]
    writes = {path for each in found for path in each.effects.writes}
    called = {path[-1] for each in found for path in each.effects.calls if path}
    written = {path[0] for path in writes if path}
    return ANYTHING in writes or not written.isdisjoint(_passed(pou)) or not called.isdisjoint(passing)
