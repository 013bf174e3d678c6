"""What CODESYS V3 has and CoDeSys 2.3 has not: operators, statements, conversions and types.

CoDeSys 2.3 manual, "Operators", "Data types" and "Statements"; it names none of these. Values of enumerations get the
name that they have there; all else is reported, as a program with it does not compile.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator
from functools import partial

from plcopen_sfc.languages.binding.text_sites import SiteKind, text_sites
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, parse_statements, print_node, transform, walk
from plcopen_sfc.languages.st.rendering import render
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import (
    ArrayType,
    DataType,
    Elementary,
    ElementaryType,
    EnumType,
    PointerType,
    StringType,
    StructType,
)
from plcopen_sfc.report import ConversionReport, Outcome

_TYPES = frozenset({Elementary.LINT, Elementary.ULINT, Elementary.LWORD, Elementary.LTIME})
_TYPED = re.compile(r'(?:LTIME|LINT|ULINT|LWORD)#|"', re.IGNORECASE)
_CONVERSION = re.compile(r"TO_[A-Z]+", re.IGNORECASE)


def replace_later_language(project: Project, report: ConversionReport) -> None:
    """Write values of enumerations in `project` as CoDeSys 2.3 does, and report what it does not compile."""
    enumerations = {each.name.casefold() for each in project.data_types if isinstance(each.type, EnumType)}
    plain = partial(_plain, _unique_values(project))
    for site in text_sites(project):
        if not site.is_program_text or site.reading not in (SiteKind.STATEMENTS, SiteKind.EXPRESSION):
            continue
        parse = parse_statements if site.reading is SiteKind.STATEMENTS else parse_condition
        parsed = parse(site.text, project.dialect)
        tree = transform(parsed.tree, plain)
        if tree is not parsed.tree and tree != parsed.tree:
            site.put(render(parsed, tree))
            why = "values of enumerations without the name of their type, which CoDeSys 2.3 does not write"
            report.add(Outcome.TRANSLATED, "text", site.report_path, why)
        for word in dict.fromkeys(word for node in walk(tree) for word in _words(node, enumerations)):
            report.add(
                Outcome.NOT_EXECUTED, "text", site.report_path, f"CoDeSys 2.3 has no {word}: it does not compile"
            )
    declared = [(f"{pou.report_path} / {v.name}", v.type) for pou in project.pous for v in pou.variables()]
    for section in project.global_sections():
        declared += [(f"global variable {section.name}.{v.name}", v.type) for v in section.variables]
    declared += [(each.report_path, each.type) for each in project.data_types]
    for path, kind in declared:
        for name in dict.fromkeys(_later_types(kind)):
            report.add(Outcome.NOT_EXECUTED, "data type", path, f"CoDeSys 2.3 has no {name}: it does not compile")


def _unique_values(project: Project) -> set[tuple[str, str]]:
    """Return the values that nothing else in the project is called as, each with its type, in lower case."""
    types = [(each.name, each.type.values) for each in project.data_types if isinstance(each.type, EnumType)]
    names = Counter(value.name.casefold() for _, values in types for value in values)
    names.update(thing.name.casefold() for thing in project.objects())
    names.update(v.name.casefold() for section in project.global_sections() for v in section.variables)
    for pou in project.pous:
        names.update(variable.name.casefold() for variable in pou.variables())
        names.update(action.name.casefold() for action in pou.actions)
        names.update(transition.name.casefold() for transition in pou.transitions)
        charts = (body.chart for body in pou.bodies if isinstance(body, SfcBody))
        names.update(step.name.casefold() for chart in charts for step in chart.steps)
    found = ((name.casefold(), value.name.casefold()) for name, values in types for value in values)
    return {each for each in found if names[each[1]] == 1}


def _plain(unique: Collection[tuple[str, str]], node: n.Node) -> n.Node:
    match node:
        case n.Member(base=n.Name(identifier=base), name=n.Name(identifier=name)):
            return node.name if (base.casefold(), name.casefold()) in unique else node
    return node


def _words(node: n.Node, enumerations: Collection[str]) -> Iterator[str]:
    match node:
        case n.Operation(operator=n.Operator.AND_THEN | n.Operator.OR_ELSE as operator):
            yield operator.value
        case n.Assignment(kind=kind) if kind is not n.AssignmentKind.ASSIGN:
            yield kind.value
        case n.AssignmentExpression():
            yield f"assignment in an expression (`{print_node(node)}`)"
        case n.Continue():
            yield "CONTINUE"
        case n.Call(callee=n.Name(identifier=name)) if _CONVERSION.fullmatch(name):
            yield f"function {name}, which names the type it converts to only"
        case n.Member(base=n.Name(identifier=base), name=n.Name(identifier=name)):
            if base.casefold() in enumerations:
                yield f"value of an enumeration by its type (`{base}.{name}`)"
            elif name.startswith("%"):
                yield f"part of a word (`.{name}`)"
        case n.Literal(text=text) if _TYPED.match(text):
            yield f"literal {text}"


def _later_types(kind: DataType | None) -> Iterator[str]:
    match kind:
        case ElementaryType(name=name) if name in _TYPES:
            yield name.value
        case StringType(wide=True):
            yield "WSTRING"
        case EnumType(base=base) if base is not None:
            yield "enumeration with a type of its values"
        case ArrayType(base=base) | PointerType(base=base):
            yield from _later_types(base)
        case StructType(members=members):
            for member in members:
                yield from _later_types(member.type)
        case _:
            pass
