"""The other bodies of a POU whose chart is lowered.

Charts of its actions are lowered too, step variables in bodies are replaced, actions that a target does not have are
written where they are called, and those that only the chart used are left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.binding import called_actions, names_in
from plcopen_sfc.languages.binding.name_uses import Names
from plcopen_sfc.languages.binding.text_sites import SiteKind
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.lowering.construction import Constructed, construct, errors_of
from plcopen_sfc.lowering.lowering_options import LOCAL, Construction, LoweringRules, Style
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import models_in
from plcopen_sfc.model.network import Contact
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, SfcBody
from plcopen_sfc.model.variables import SectionKind

_OPERAND = re.compile(r"[\w.]+")
_STEP_DATA = frozenset({"x", "t", "_x", "_t"})


def with_step_data(pou: Pou, flags: Mapping[str, str], dialect: Dialect) -> Pou:
    """Return a copy of `pou` with `flags` (by the names of steps) in the place of step variables in its bodies.

    There are no steps any more: their names would be those of variables that nothing declares. Raises `LoweringError`
    where the code does not keep what is asked for, or a contact cannot ask for it.
    """
    declared = {variable.name.casefold() for variable in pou.variables()}
    replacing = {name: flag for name, flag in flags.items() if name not in declared}
    changed = pou.model_copy(deep=True)
    for name, _, body in changed.named_bodies():
        _Replacing(replacing, dialect, changed.report_path_of(name)).replace_in(body)
    return changed


class _Replacing:
    """Replacement of step variables in one body, whose place is `path`."""

    def __init__(self, flags: Mapping[str, str], dialect: Dialect, path: str) -> None:
        self._flags, self._dialect, self._path = flags, dialect, path

    def replace_in(self, body: Body) -> None:
        """Replace them in all texts of a body."""
        for thing in models_in(body):
            for name in ("text",) if isinstance(thing, StBody | Expression) else ("variable", "expression"):
                value = getattr(thing, name, None)
                if not isinstance(value, str) or (replaced := self._replaced(value)) == value:
                    continue
                if isinstance(thing, Contact) and not _OPERAND.fullmatch(replaced):
                    raise LoweringError(
                        f"a contact cannot ask for {value}, which is {replaced} in the code",
                        location=Location(path=self._path),
                        hint="Step bits and flip-flops can be asked for.",
                    )
                setattr(thing, name, replaced)

    def _replaced(self, text: str) -> str:
        if "." not in text:
            return text
        tokens = tokenize(text, self._dialect).tokens
        parts, end = [], 0
        for index in range(len(tokens) - 2):
            step, dot, asked = tokens[index : index + 3]
            flag = self._flags.get(step.value.casefold())
            before = tokens[index - 1].value if index else ""
            if flag is None or dot.value != "." or before == "." or asked.value.casefold() not in _STEP_DATA:
                continue
            if asked.value.casefold() != "x":
                raise LoweringError(
                    f"{step.value}.{asked.value} is not lowered yet: the code does not keep it",
                    location=Location(path=self._path),
                    hint="Take the time of a TON that the step starts.",
                )
            # a comparison such as ``step_number = 2`` needs parentheses among other operators
            alone = _OPERAND.fullmatch(flag) is not None or len(tokens) == 3
            parts += [text[end : step.span[0]], flag if alone else f"({flag})"]
            end = asked.span[1]
        return "".join([*parts, text[end:]])


def with_actions(made: Constructed, dialect: Dialect, rules: LoweringRules, project: Project) -> Constructed:
    """Return the same with code in the place of the charts of those actions that its code calls, and that these call.

    They have the construction of the chart where it can hold them. Restart and operating modes concern the chart
    itself. Step variables in other bodies are replaced by the flags of the charts.
    """
    # a chart of an action may need more than one CASE although the outer one needs one
    parts = made.construction in (Construction.CASE, Construction.REGIONS)
    construction = Construction.AUTO if parts else made.construction
    inner = replace(rules, construction=construction, style=Style.EXACT, flags=LOCAL, modes=frozenset())
    inner = replace(inner, init=None, stop=None, reset_actions=False)
    pou, data_types, body = made.pou, list(made.data_types), made.pou.body
    flags = _by_name(made.step_flags)
    done: set[str] = set()
    calling = [body]
    # a chart that is called by the code of another chart, and so on; charts that nothing calls stay as they are
    while calling:
        called = called_actions(calling.pop(), pou, dialect)
        for action in list(pou.actions):
            key = action.name.casefold()
            if key in done or key not in called:
                continue
            done.add(key)
            if isinstance(action.body, SfcBody):
                # `construct` lowers the body of a POU
                alone = pou.model_copy(update={"bodies": [action.body]})  # as if it were the body
                chart = action.body.chart
                # types that are new have their names already
                around = project.model_copy(update={"data_types": [*project.data_types, *data_types]})
                with errors_of(project, pou, f"{pou.name}.{action.name}"):
                    found = construct(alone, chart, dialect, replace(inner, part=action.name), around)
                data_types += found.data_types
                pou = found.pou.model_copy(update={"bodies": pou.bodies})
                pou.action(action.name).body = found.pou.body
                for step, flag in _by_name(found.step_flags).items():
                    flags.setdefault(step, flag)
            calling.append(pou.action(action.name).body)
    # the code of the chart itself has its flags; blocks of S7-GRAPH have one body
    if not rules.profile.graph_parameters and len(list(pou.named_bodies())) > len(pou.bodies):
        pou = with_step_data(pou, flags, dialect)
    return replace(made, pou=pou, data_types=tuple(data_types))


def _by_name(flags: Mapping[str, str]) -> dict[str, str]:
    """Return the same by the names of steps instead of their paths."""
    return {path.rpartition(".")[2].casefold(): flag for path, flag in flags.items()}


_LEAVING = (n.ReturnStatement, n.Goto, n.LabelStatement)
"""Statements that would leave the text around them."""


def with_actions_inside(pou: Pou, dialect: Dialect) -> Pou:
    """Return `pou` with the statements of its actions in the place of their calls, each behind a comment with its name.

    Calls stay of actions that are drawn, that return or jump, and that call themselves. Actions that nothing calls any
    more have no calls either: some dialects keep them, and the target compiles none.
    """
    texts = {a.name.casefold(): a.body.text for a in pou.actions if isinstance(a.body, StBody)}
    texts = {name: text for name, text in texts.items() if _can_stand_elsewhere(text, dialect)}
    if not texts or not any(isinstance(body, StBody) for body in pou.bodies):
        return pou
    inlining = _Inlining(pou, dialect)

    def inside(body: Body, around: str = "") -> Body:
        if not isinstance(body, StBody):
            return body
        others = {name: text for name, text in texts.items() if name != around}
        return body.model_copy(update={"text": inlining.inlined(body.text, others), "markup": None})

    actions = [
        each.model_copy(update={"body": inside(each.body, each.name.casefold())}) if each.body is not None else each
        for each in pou.actions
    ]
    return pou.model_copy(update={"bodies": [inside(body) for body in pou.bodies], "actions": actions})


def _can_stand_elsewhere(text: str, dialect: Dialect) -> bool:
    parsed = parse_statements(text, dialect)
    return not parsed.problems and not any(isinstance(node, _LEAVING) for node in walk(parsed.tree))


class _Inlining:
    """Statements of the actions of one POU in the place of their calls."""

    def __init__(self, pou: Pou, dialect: Dialect) -> None:
        self._own = {"this", *([pou.name.casefold()] if pou.kind is PouKind.PROGRAM else [])}
        self._dialect = dialect

    def inlined(self, text: str, texts: Mapping[str, str]) -> str:
        """Return `text` with the statements in `texts`, by the names of actions in lower case."""
        edits: list[Edit] = []
        for node in walk(parse_statements(text, self._dialect).tree):
            name = self._called_alone(node)
            if name is None or name.casefold() not in texts or node.span is None:
                continue
            others = {each: inside for each, inside in texts.items() if each != name.casefold()}
            inside = self.inlined(texts[name.casefold()], others).strip("\n")
            end = re.compile(r"\s*;").match(text, node.span[1])
            stop = end.end() if end is not None else node.span[1]
            start = text.rfind("\n", 0, node.span[0]) + 1
            before = text[start : node.span[0]]
            indent = before[: len(before) - len(before.lstrip())]
            put = "\n".join([f"// {name}", *(f"{indent}{line}".rstrip() for line in inside.split("\n"))])
            if before.strip():
                put = f"\n{indent}{put}"
            behind = text[stop : (text + "\n").index("\n", stop)]
            edits.append(Edit(node.span[0], stop, put if not behind.strip() else f"{put}\n{indent}"))
        return apply_edits(text, edits)

    def _called_alone(self, node: n.Node) -> str | None:
        """Return the name of the action that a statement calls without arguments: ``A``, ``Main.A``, ``THIS^.A``."""
        call = node.call if isinstance(node, n.CallStatement) else None
        if isinstance(call, n.Call) and not call.arguments:
            call = call.callee
        if isinstance(call, n.Member):
            base = call.base.base if isinstance(call.base, n.Dereference) else call.base
            if not isinstance(base, n.Name) or base.identifier.casefold() not in self._own:
                return None
            call = call.name
        return call.identifier if isinstance(call, n.Name) else None


def without_external_declarations(pou: Pou, project: Project) -> Pou:
    """Return `pou` without declarations of what is a global variable of its project: S7 has only that itself."""
    if pou.interface is None or all(each.kind is not SectionKind.EXTERNAL for each in pou.interface.sections):
        return pou
    declared = {variable.name.casefold() for section in project.global_sections() for variable in section.variables}
    sections = []
    for section in pou.interface.sections:
        if section.kind is SectionKind.EXTERNAL:
            left = [variable for variable in section.variables if variable.name.casefold() not in declared]
            section = section.model_copy(update={"variables": left})  # noqa: PLW2901
        if section.kind is not SectionKind.EXTERNAL or section.variables:
            sections.append(section)
    interface = pou.interface.model_copy(update={"sections": sections, "declaration": None})
    return pou.model_copy(update={"interface": interface})


def without_uncalled_actions(pou: Pou, project: Project) -> Pou:
    """Return `pou` without the actions that nothing in `project` names: the target has none, they would be comments."""
    others = (each for each in project.pous if each.name != pou.name)
    named = {name for each in others for _, _, body in each.named_bodies() for name in names_in(body, project.dialect)}
    called = _actions_called(pou, project.dialect).keys()
    names = [each.name for each in pou.actions if each.name.casefold() in named - called]
    outside = _called_outside(pou.name, names, project) if names else set()
    kept = [each for each in pou.actions if each.name.casefold() in called or each.name in outside]
    return pou.model_copy(update={"actions": kept})


_NO_CODE = (SiteKind.FOREIGN, SiteKind.NAME)


def _called_outside(pou: str, actions: Iterable[str], project: Project) -> set[str]:
    """Return those `actions` of a POU that others call, or may call: actions of theirs can have the same names."""
    own = next((each for each in project.pous if each.name == pou), None)
    found, names = set[str](), Names(project)
    for name in actions:
        action = own.find_action(name) if own is not None else None
        declared = names.declaration_of(action) if action is not None else None
        for use in names.occurrences(name):
            # the project tree and data of the tool of the source call nothing
            is_other = use.text_site.site.pou is not own and use.text_site.reading not in _NO_CODE
            if is_other and (declared is None or use.refers_to(declared) or use.may_refer_to(declared)):
                found.add(name)
    return found


def without_unused_parts(original: Pou, lowered: Pou, dialect: Dialect) -> Pou:
    """Return `lowered` without the actions and transitions that only the charts of `original` used.

    In IEC 61131-3 they are a part of a chart (6.7.4.2, 6.7.3): nothing else can call them, and textual declarations
    with a body of statements have no place for them. In other dialects an action is called from anywhere, and stays.
    """
    called = _actions_called(lowered, dialect)
    charts = [body for body in (*lowered.bodies, *(called.values())) if isinstance(body, SfcBody)]
    if dialect is not Dialect.IEC or charts:
        return lowered
    actions, transitions = _used(original)
    lowered.actions = [
        each for each in lowered.actions if each.name.casefold() in called or each.name.casefold() not in actions
    ]
    lowered.transitions = [each for each in lowered.transitions if each.name.casefold() not in transitions]
    return lowered


def _used(pou: Pou) -> tuple[set[str], set[str]]:
    """Return the names of actions and of transition objects in the charts of a POU."""
    actions: set[str] = set()
    transitions: set[str] = set()
    for body in (*pou.bodies, *(action.body for action in pou.actions)):
        if isinstance(body, SfcBody):
            actions |= {each.target.casefold() for _, each in body.chart.associations() if each.target is not None}
            conditions = (transition.condition for transition in body.chart.transitions)
            transitions |= {each.name.casefold() for each in conditions if isinstance(each, NamedCondition)}
    return actions, transitions


def _actions_called(pou: Pou, dialect: Dialect) -> dict[str, Body | None]:
    """Return the actions that the code calls, and those that these call: their bodies by name."""
    by_name = {action.name.casefold(): action.body for action in pou.actions}
    called: dict[str, Body | None] = {}
    bodies: list[Body | None] = [*pou.bodies]
    while bodies:
        for name in sorted(called_actions(bodies.pop(), pou, dialect) - called.keys()):
            called[name] = by_name[name]
            bodies.append(by_name[name])
    return called
