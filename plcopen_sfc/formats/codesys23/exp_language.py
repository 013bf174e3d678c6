"""Program text as CoDeSys 2.3 compiles it: what its successor has more is written otherwise, or reported."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from functools import partial

from plcopen_sfc.languages.binding.text_sites import text_sites
from plcopen_sfc.languages.declarations.conditional_declarations import starts_condition
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.effects import conditional_assignment
from plcopen_sfc.languages.networks.exported_networks import EXPORTS
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node, transform, walk
from plcopen_sfc.languages.st.lexer import CommentKind
from plcopen_sfc.languages.st.printing import render
from plcopen_sfc.languages.translation.call_translation import is_mixed
from plcopen_sfc.languages.translation.text_translation import with_block_comments
from plcopen_sfc.model import types as t
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, BodyCondition, SfcBody
from plcopen_sfc.model.variables import SectionKind, sections_of
from plcopen_sfc.report import ConversionReport, Outcome


def replace_line_comments(project: Project, report: ConversionReport) -> None:
    """Write the comments up to the end of a line in program text of `project` as others, which CoDeSys 2.3 has."""
    for name, pou, body in project.bodies():
        before = len(report.items)
        for text in _texts(body):
            replaced = with_block_comments(text.text, Dialect.CODESYS)
            if replaced != text.text:
                text.text = replaced
                if len(report.items) == before:
                    why = "// is no comment in CoDeSys 2.3, (* *) is"
                    report.add(Outcome.TRANSLATED, "comments", pou.report_path_of(name), why)


def _texts(body: Body) -> Iterator[StBody | IlBody | Expression]:
    if isinstance(body, StBody | IlBody):
        yield body
    if not isinstance(body, SfcBody):
        return
    for step in body.chart.steps:
        for action in (*step.step_actions.values(), *(each.body for each in step.actions)):
            if action is not None and not isinstance(action, str):
                yield from _texts(action)
    for transition in body.chart.transitions:
        if isinstance(transition.condition, Expression):
            yield transition.condition
        elif isinstance(transition.condition, BodyCondition):
            yield from _texts(transition.condition.body)


_TYPES = frozenset({t.Elementary.LINT, t.Elementary.ULINT, t.Elementary.LWORD, t.Elementary.LTIME})
_TYPED = re.compile(r'(?:LTIME|LINT|ULINT|LWORD)#|"', re.IGNORECASE)
_CONVERSION = re.compile(r"TO_[A-Z]+", re.IGNORECASE)
_LATER_FUNCTION = re.compile(r"(?:UPPER|LOWER)_BOUND|XSIZEOF|__[A-Z]+", re.IGNORECASE)


def name_truncations(project: Project, report: ConversionReport) -> None:
    """Call TRUNC_INT in `project`, a copy that comes from CoDeSys 2.3, in which TRUNC gives an INT."""
    why = "TRUNC gives an INT in CoDeSys 2.3: it is TRUNC_INT"
    _rename_function(project, "TRUNC", "TRUNC_INT", why, report)


def _rename_function(project: Project, old: str, new: str, why: str, report: ConversionReport) -> None:
    """Call a standard function by another name, where no function of the project has its name."""
    if any(pou.name.upper() == old for pou in project.pous):
        return

    def renamed(node: n.Node) -> n.Node:
        match node:
            case n.Call(callee=n.Name(identifier=name) as callee) if name.upper() == old:
                return replace(node, callee=replace(callee, identifier=new))
        return node

    for site in text_sites(project):
        if site.is_program_text and old in site.text.upper():
            parsed = site.parsed(project.dialect)
            tree = transform(parsed.tree, renamed)
            if tree != parsed.tree:
                site.put(render(parsed, tree))
                report.add(Outcome.TRANSLATED, "text", site.report_path, why)


def replace_later_language(project: Project, report: ConversionReport) -> None:
    """Write enumerations and set statements in `project` as CoDeSys 2.3 does, and report what it does not compile."""
    enumerations = {each.name.casefold() for each in project.data_types if isinstance(each.type, t.EnumType)}
    plain = partial(_plain, _unique_values(project))
    functions = {pou.name.casefold(): pou for pou in project.pous if pou.kind is PouKind.FUNCTION}
    for pou in functions.values():
        for variable in pou.variables(SectionKind.OUTPUT):
            why = "an output of a function: it is not known whether CoDeSys 2.3 compiles that"
            report.add(Outcome.APPROXIMATED, "variable", f"{pou.report_path} / {variable.name}", why)
    for pou in project.pous:
        for section in sections_of(pou.interface):
            for variable in section.variables if kept(section.extension_data).get("keyword") == "VAR_STAT" else ():
                why = "VAR_STAT, one for all instances: it is not known whether CoDeSys 2.3 compiles that"
                report.add(Outcome.APPROXIMATED, "variable", f"{pou.report_path} / {variable.name}", why)
    truncating = {"trunc"} - functions.keys() if project.tool_format != EXPORTS else set()
    for site in text_sites(project):
        if not site.is_program_text:
            continue
        parsed = site.parsed(project.dialect)
        if truncating.intersection(node.called.casefold() for node in walk(parsed.tree) if isinstance(node, n.Call)):
            why = "TRUNC gives an INT in CoDeSys 2.3, and a DINT in the source"
            report.add(Outcome.APPROXIMATED, "text", site.report_path, why)
        if any(starts_condition(each.text) for each in parsed.comments if each.kind is CommentKind.PRAGMA):
            why = "CoDeSys 2.3 has no pragmas that leave statements out: they are always executed there"
            report.add(Outcome.NOT_EXECUTED, "text", site.report_path, why)
        passed = transform(parsed.tree, partial(_with_all_inputs, functions))
        if passed is not parsed.tree and passed != parsed.tree:
            why = "calls of functions pass all inputs, also those with a start value: CoDeSys 2.3 may take no fewer"
            report.add(Outcome.TRANSLATED, "text", site.report_path, why)
            site.put(render(parsed, passed))
            parsed = site.parsed(project.dialect)
        tree = transform(parsed.tree, plain)
        if tree is not parsed.tree and tree != parsed.tree:
            site.put(render(parsed, tree))
            why = "CoDeSys 2.3 has neither S= and R= nor values of enumerations with the name of their type"
            report.add(Outcome.TRANSLATED, "text", site.report_path, why)
        for word in dict.fromkeys(word for node in walk(tree) for word in _words(node, enumerations, functions)):
            report.add(
                Outcome.NOT_EXECUTED, "text", site.report_path, f"CoDeSys 2.3 has no {word}: it does not compile"
            )
    _rename_function(project, "TRUNC_INT", "TRUNC", "TRUNC_INT is TRUNC in CoDeSys 2.3", report)
    declared = [(f"{pou.report_path} / {v.name}", v.type) for pou in project.pous for v in pou.variables()]
    for section in project.global_sections():
        declared += [(f"global variable {section.name}.{v.name}", v.type) for v in section.variables]
    declared += [(each.report_path, each.type) for each in project.data_types]
    for path, kind in declared:
        for name in dict.fromkeys(_later_types(kind)):
            report.add(Outcome.NOT_EXECUTED, "data type", path, f"CoDeSys 2.3 has no {name}: it does not compile")


def _unique_values(project: Project) -> set[tuple[str, str]]:
    """Return the values that nothing else in the project is called as, each with its type, in lower case."""
    types = [(each.name, each.type.values) for each in project.data_types if isinstance(each.type, t.EnumType)]
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
        case n.Assignment():
            return conditional_assignment(node) or node
    return node


def _with_all_inputs(functions: Mapping[str, Pou], node: n.Node) -> n.Node:
    """Return the call of a function of the project with the start values of inputs that it leaves out.

    Inputs by position get names where others have some: only CODESYS V3 takes both in one call.
    """
    if not isinstance(node, n.Call) or not isinstance(node.callee, n.Name):
        return node
    function = functions.get(node.callee.identifier.casefold())
    inputs = function.variables(SectionKind.INPUT) if function is not None else []
    if is_mixed(node) and sum(argument.name is None for argument in node.arguments) <= len(inputs):
        names_of_inputs = (n.Name(variable.name) for variable in inputs)
        named = (a if a.name is not None else replace(a, name=next(names_of_inputs)) for a in node.arguments)
        node = replace(node, arguments=tuple(named))
    given = [argument for argument in node.arguments if not argument.output]
    if any(argument.name is None for argument in given):
        left = inputs[len(given) :]
    else:
        names = {argument.name.identifier.casefold() for argument in given if argument.name is not None}
        left = [variable for variable in inputs if variable.name.casefold() not in names]
    values = [variable.initial for variable in left]
    if not left or not all(isinstance(value, t.SimpleValue) and value.text for value in values):
        return node
    by_name = not given or given[0].name is not None
    added = tuple(
        n.Argument(parse_expression(value.text).tree, n.Name(variable.name) if by_name else None)
        for variable, value in zip(left, values, strict=True)
        if isinstance(value, t.SimpleValue) and value.text is not None
    )
    return replace(node, arguments=(*node.arguments, *added))


def _words(node: n.Node, enumerations: Collection[str], functions: Collection[str]) -> Iterator[str]:
    """Yield what CoDeSys 2.3 does not have; `functions` are those of the project, in lower case."""
    match node:
        case n.Call(callee=n.Name(identifier=name)) if name.casefold() in functions:
            pass
        case n.Operation(operator=n.Operator.AND_THEN | n.Operator.OR_ELSE as operator):
            yield operator.value
        case n.Assignment(kind=kind) if kind is not n.AssignmentKind.ASSIGN:
            yield kind.value
        case n.AssignmentExpression():
            yield f"assignment in an expression (`{print_node(node)}`)"
        case n.Continue():
            yield "CONTINUE"
        case n.Goto(keyword=keyword):
            yield f"jump {keyword}"
        case n.Call(callee=n.Name(identifier=name)) if _CONVERSION.fullmatch(name):
            yield f"function {name}, which names the type it converts to only"
        case n.Call(callee=n.Name(identifier=name)) if _LATER_FUNCTION.fullmatch(name):
            yield f"function {name}"
        case n.Member(base=n.Name(identifier=base), name=n.Name(identifier=name)):
            if base.casefold() in enumerations:
                yield f"value of an enumeration by its type (`{base}.{name}`)"
            elif name.startswith("%"):
                yield f"part of a word (`.{name}`)"
        case n.Literal(text=text) if _TYPED.match(text):
            yield f"literal {text}"


def _later_types(kind: t.DataType | None) -> Iterator[str]:
    match kind:
        case t.ElementaryType(name=name) if name in _TYPES:
            yield name.value
        case t.StringType(wide=True):
            yield "WSTRING"
        case t.PointerType(reference=True):
            yield "REFERENCE TO"
        case t.EnumType(base=base) if base is not None:
            yield "enumeration with a type of its values"
        case t.ArrayType(base=base) | t.PointerType(base=base):
            yield from _later_types(base)
        case t.StructType(members=members):
            if "union" in kept(kind.extension_data):
                yield "UNION"
            for member in members:
                yield from _later_types(member.type)
        case _:
            pass
