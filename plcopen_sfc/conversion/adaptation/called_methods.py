"""Methods of CODESYS as functions, where no tool has methods.

A function gets the variables of the block that the method uses: in-out parameters where it writes them or they are
instances, else inputs. Other blocks that call the method pass variables of the instance; local ones become inputs or
outputs, as those of called programs do. The project keeps the methods, and has them again in CODESYS.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.conversion.adaptation.called_programs import (
    hide_variables,
    make_blocks_of_programs,
    make_programs_of_blocks,
    show_variables,
)
from plcopen_sfc.formats.plcopen.source_marks import pou_digest
from plcopen_sfc.languages.binding.name_scopes import is_instance
from plcopen_sfc.languages.binding.text_sites import Site, SiteKind, TextSite, text_sites
from plcopen_sfc.languages.declarations.attributes import acting_attributes, typed_attributes
from plcopen_sfc.languages.effects import Path, effects
from plcopen_sfc.languages.method_calls import (
    InlinedText,
    MethodCalls,
    MethodFunction,
    function_of_method,
    passed_in_out,
    without_function,
)
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, render, transform, walk
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.translation.renames import KeptNames, keep_names, kept_names
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import BlockVariable
from plcopen_sfc.model.pou import Method, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.report import ConversionReport, Outcome


def adapt_calls(
    project: Project, dialect: Dialect | None, tool: str, report: ConversionReport, *, with_instances: bool
) -> None:
    """Change the methods and the called programs of `project`, a copy, for a tool of a dialect, or such changes back.

    `with_instances`: functions of the tool take instances of blocks as parameters.
    """
    own = family(project.dialect)
    if dialect is Dialect.IEC:
        if own is not Dialect.SCL and any(pou.methods for pou in project.pous):
            _Functions(project, tool, report, with_instances=with_instances).make()
        if own is Dialect.CODESYS:
            make_blocks_of_programs(project, tool, report)
    elif dialect is not None and family(dialect) is Dialect.CODESYS and own is not Dialect.CODESYS:
        make_programs_of_blocks(project, report)
        _make_methods(project, report)


@dataclass(slots=True)
class _Made:
    """The function `block` for a method, which writes the variables `written` of its owner."""

    block: Pou
    owner: Pou
    method: Method
    call: MethodFunction
    written: frozenset[str]
    at: int = 0


@dataclass(slots=True)
class _Functions:
    """The functions for the methods of a project."""

    project: Project
    tool: str
    report: ConversionReport
    with_instances: bool
    calls: MethodCalls = field(init=False)
    _found: dict[int, _Made | str] = field(default_factory=dict)
    _taken: set[str] = field(init=False)
    _outside: dict[str, set[str]] = field(default_factory=dict)
    """Variables of blocks that calls in other blocks pass, in lower case, by the names of the blocks."""
    _outputs: set[str] = field(init=False)
    """Names of outputs in calls and of pins of boxes, which stay outputs."""

    def __post_init__(self) -> None:
        """Collect the names of the project."""
        self.calls = MethodCalls(self.project, self.project.dialect)
        self.calls.function_of_method = self._called
        self._outputs = set(_outputs_of_calls(self.project))
        self._taken = {thing.name.casefold() for thing in self.project.objects()}
        self._taken |= {v.name.casefold() for section in self.project.global_sections() for v in section.variables}

    def make(self) -> None:
        """Write functions in the place of methods, and calls of them."""
        methods = [(pou, method) for pou in self.project.pous for method in pou.methods]
        why_not = {id(method): why for pou, method in methods if isinstance(why := self._function(pou, method), str)}
        for text_site in list(text_sites(self.project)):
            if text_site.is_program_text and text_site.site.method is None:
                self._call_functions(text_site)
        for pou, method in methods:
            path = f"{pou.report_path} / method {method.name}"
            made = self._found[id(method)]
            if isinstance(made, str):
                why = f"blocks of {self.tool} have no methods, and no function holds it: {why_not[id(method)]}"
                self.report.add(Outcome.NOT_EXECUTED, "method", path, why)
                continue
            made.at = pou.methods.index(method)
            why = f"it is the function {made.block.name}, with the variables of the block that it uses"
            self.report.add(Outcome.TRANSLATED, "method", path, why)
        made_all = [made for made in self._found.values() if isinstance(made, _Made)]
        rows = [(made.block.name, made.owner.name, _kept(made)) for made in made_all]
        for made in made_all:
            made.owner.methods = [each for each in made.owner.methods if each is not made.method]
        for pou in self.project.pous:
            if used := self._outside.get(pou.name.casefold()):
                written = {name for made in made_all if made.owner is pou for name in made.written}
                rows += [(pou.name, "", row) for row in show_variables(pou, used, used & written)]
        self.project.pous = [*self.project.pous, *(made.block for made in made_all)]
        keep_names(self.project, KeptNames.METHODS, rows)

    def _call_functions(self, text_site: TextSite) -> None:
        is_condition = text_site.reading is SiteKind.EXPRESSION
        found = self.calls.without_methods(text_site.text, text_site.site, is_condition=is_condition)
        if found.methods:
            text_site.put(found.text)
        for problem in found.problems:
            why = f"blocks of {self.tool} have no methods, and this calls one: {problem}"
            self.report.add(Outcome.NOT_EXECUTED, "text", text_site.report_path, why)

    def _called(self, owner: Pou, method: Method, path: str) -> MethodFunction | str:
        made = self._function(owner, method)
        if isinstance(made, str):
            return made
        if path:
            for section in sections_of(owner.interface):
                names = {v.name.casefold() for v in section.variables} & set(map(str.casefold, made.call.around))
                if section.kind is SectionKind.OUTPUT and (asked := names & made.written & self._outputs):
                    return f"it writes {' and '.join(sorted(asked))}, an output of {owner.name}, which others only read"
                if names and section.kind not in (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.LOCAL):
                    return f"it uses {' and '.join(sorted(names))} of {owner.name}, which no other block reaches"
            if owner.kind is not PouKind.PROGRAM:  # the variables of programs are shown where these become blocks
                self._outside.setdefault(owner.name.casefold(), set()).update(map(str.casefold, made.call.around))
        return made.call

    def _function(self, owner: Pou, method: Method) -> _Made | str:
        """Return the function for a method of `owner`; a reason where there is none."""
        if id(method) not in self._found:
            self._found[id(method)] = "it calls itself"
            made = self._make(owner, method)
            del self._found[id(method)]  # behind those that it calls
            self._found[id(method)] = made
        return self._found[id(method)]

    def _make(self, owner: Pou, method: Method) -> _Made | str:
        if why_not := without_function(owner, method, {each.name.casefold(): each for each in self.project.pous}):
            return why_not
        if not isinstance(method.body, StBody | None):
            return "its body is no list of statements"
        interface = method.interface or Interface()
        if acting := acting_attributes(method, typed_attributes(interface.declaration).get("", ())):
            return f"it has attributes that no function has: {', '.join(acting)}"
        own = {variable.name.casefold() for variable in interface.variables()} | {method.name.casefold()}
        text = self._of_itself(method.body.text if method.body is not None else "", own)
        site = Site(pou=owner, place=owner.place, method=method)
        found = self.calls.without_methods(text, site) if text is not None else InlinedText("")
        parsed = parse_statements(found.text, self.project.dialect)
        if text is None or parsed.problems or found.problems:
            return found.problems[0] if found.problems else "its text cannot be read"
        names = {each.identifier.upper() for each in walk(parsed.tree) if isinstance(each, n.Name)}
        if whole := sorted(names & {"THIS", "SUPER"}):
            return f"it uses {' and '.join(whole)}, the block itself, which no function has"
        made = (each.block for each in self._found.values() if isinstance(each, _Made))
        functions: dict[Path, Pou] = {(each.name.casefold(),): each for each in (*self.project.pous, *made)}
        effect = effects(parsed.tree.statements)
        used = {path[0] for path in effect.reads | effect.writes | effect.calls if path} - own
        written = {path[0] for path in effect.writes if path} | set(passed_in_out(parsed.tree, functions))
        for name in (step.name for body in owner.bodies if isinstance(body, SfcBody) for step in body.chart.steps):
            if name.casefold() in used:
                return f"it uses data of the step {name}, which no call passes"
        for action in owner.actions:
            if action.name.casefold() in used:
                return f"it calls the action {action.name}, which only its block executes"
        around = self._around(owner, used, written)
        if isinstance(around, str):
            return around
        name = take_name(f"{owner.name}_{method.name}", self._taken)
        filled, call = function_of_method(name, method, around)
        block = Pou(
            name=name,
            kind=PouKind.FUNCTION,
            interface=filled,
            bodies=[StBody(text=_renamed(found.text, method.name, name, self.project.dialect))],
        )
        return _Made(block, owner, method, call, frozenset(written & used))

    def _around(self, owner: Pou, used: set[str], written: set[str]) -> list[VariableSection] | str:
        """Return the sections for the variables of a block that a method uses."""
        constants = VariableSection(kind=SectionKind.LOCAL, constant=True)
        in_outs, inputs = (VariableSection(kind=kind) for kind in (SectionKind.IN_OUT, SectionKind.INPUT))
        for section in sections_of(owner.interface):
            for variable in section.variables:
                name = variable.name.casefold()
                if name not in used:
                    continue
                if section.kind is SectionKind.TEMP or section.kind is SectionKind.EXTERNAL:
                    return f"it uses {variable.name}, which no call passes"
                is_constant = section.constant or section.kind is SectionKind.CONSTANT
                if is_constant:
                    constants.variables.append(variable.model_copy(deep=True))
                    continue
                is_block = is_instance(variable.type, self.project)
                if is_block and not self.with_instances:
                    return f"{variable.name} is an instance, which functions do not get in {self.tool}"
                place = in_outs if is_block or name in written else inputs
                place.variables.append(Variable(name=variable.name, type=variable.type.model_copy(deep=True)))
        return [section for section in (constants, in_outs, inputs) if section.variables]

    def _of_itself(self, text: str, own: set[str]) -> str | None:
        """Return the text of a method without ``THIS^.``; None where a variable of the method hides what that names."""
        parsed = parse_statements(text, self.project.dialect)
        hidden = False

        def change(node: n.Node) -> n.Node:
            nonlocal hidden
            if not isinstance(node, n.Member) or not isinstance(node.base, n.Dereference):
                return node
            if not isinstance(node.base.base, n.Name) or node.base.base.identifier.upper() != "THIS":
                return node
            hidden = hidden or node.name.identifier.casefold() in own
            return node.name

        if parsed.problems:
            return None
        new = render(parsed, transform(parsed.tree, change))
        return None if hidden else new


def _outputs_of_calls(project: Project) -> Iterator[str]:
    """Yield the names, in lower case, of outputs in calls (``Q => x``) and of all pins of boxes."""
    for text_site in text_sites(project):
        if isinstance(text_site.holder, BlockVariable):
            yield text_site.text.casefold()
        elif text_site.reading is SiteKind.STATEMENTS:
            for each in walk(parse_statements(text_site.text, project.dialect).tree):
                if isinstance(each, n.Argument) and each.output and each.name is not None:
                    yield each.name.identifier.casefold()


def _renamed(text: str, old: str, new: str, dialect: Dialect) -> str:
    """Return statements in which a name that is no member and no parameter is another one."""
    tree = parse_statements(text, dialect).tree
    names = [each for each in walk(tree) if isinstance(each, n.Name) and each.identifier.casefold() == old.casefold()]
    others = {
        each.name.span for each in walk(tree) if isinstance(each, n.Member | n.Argument) and each.name is not None
    }
    return apply_edits(text, [Edit(*each.span, new) for each in names if each.span and each.span not in others])


def _kept(made: _Made) -> str:
    """Return what brings a method back, as a text."""
    source = made.method.model_dump(mode="json", exclude_none=True)
    return json.dumps({"method": source, "at": made.at, "around": made.call.around, "is": pou_digest(made.block)})


@dataclass(frozen=True, slots=True)
class _Kept:
    """The method in whose place there is a function: its owner, its place there, and the variables that calls pass."""

    owner: Pou
    method: Method
    at: int
    around: frozenset[str]


def _make_methods(project: Project, report: ConversionReport) -> None:
    """Let functions be methods again that were made of such, where they and all calls of them are as they were."""
    pous = {pou.name: pou for pou in project.pous}
    rows = kept_names(project, KeptNames.METHODS)
    found: dict[str, _Kept] = {}
    for function, owner, text in rows:
        method = _read(text, pous[function], pous[owner]) if owner and {function, owner} <= pous.keys() else None
        if method is not None:
            found[function.casefold()] = method
    sites = [each for each in text_sites(project) if each.is_program_text] if found else []
    texts: list[tuple[TextSite, str]] = []
    others = {""}
    while others and found:
        texts, others = [], set()
        gone = [function.casefold() for function, owner, _ in rows if owner and function.casefold() not in found]
        for text_site in sites:
            own = text_site.site.pou.name.casefold() if text_site.site.pou is not None else ""
            text = text_site.text.casefold()
            if own in found:  # the text of its method calls methods
                others |= {own} if any(name in text for name in gone) else set()
            elif any(name in text for name in found):
                new, left = _with_methods(text_site, found, project.dialect)
                texts.append((text_site, new))
                others |= left
        found = {name: each for name, each in found.items() if name not in others}
    for text_site, new in texts:
        text_site.put(new)
    for name, each in sorted(found.items(), key=lambda item: item[1].at):
        each.owner.methods.insert(each.at, each.method)
        why = f"the method {each.method.name} of {each.owner.name}"
        report.add(Outcome.TRANSLATED, "POU", f"POU {name}", why)
    project.pous = [pou for pou in project.pous if pou.name.casefold() not in found]
    still = {owner for function, owner, _ in rows if function.casefold() not in found}
    shown: dict[str, dict[str, str]] = {}
    for pou_name, _, text in (row for row in rows if not row[1]):
        shown.setdefault(pou_name, {})[text.split()[-1]] = text
    for pou_name, variables in shown.items():
        if pou_name in pous and pou_name not in still:
            hide_variables(pous[pou_name], variables)
    keep_names(project, KeptNames.METHODS, [])


def _read(text: str, function: Pou, owner: Pou) -> _Kept | None:
    """Return the method in whose place there is a function; None where that was changed, or the text is damaged."""
    try:
        fields = json.loads(text)
        method = Method.model_validate(fields["method"])
        at, around, digest = int(fields["at"]), frozenset(map(str.casefold, fields["around"])), fields["is"]
    except (KeyError, TypeError, ValueError):
        return None
    has_it = any(each.name.casefold() == method.name.casefold() for each in owner.methods)
    return None if has_it or digest != pou_digest(function) else _Kept(owner, method, at, around)


def _with_methods(text_site: TextSite, found: Mapping[str, _Kept], dialect: Dialect) -> tuple[str, set[str]]:
    """Return a text with calls of methods instead of functions, and the functions that it names otherwise."""
    left: set[str] = set()

    def change(node: n.Node) -> n.Node:
        kept_method = found.get(node.called.casefold()) if isinstance(node, n.Call) else None
        if not isinstance(node, n.Call) or kept_method is None:
            return node
        names = {each.name.identifier.casefold(): each for each in node.arguments if each.name is not None}
        instance: n.Expression | None = None
        for name in kept_method.around:
            value = names[name].value if name in names else None
            instance = value.base if isinstance(value, n.Member) else None
        is_own = instance is not None or text_site.site.pou is kept_method.owner
        is_known = is_own and kept_method.around <= names.keys()
        if not is_known:
            left.add(node.called.casefold())
            return node
        method = n.Name(kept_method.method.name)
        callee = method if instance is None else n.Member(instance, method)
        rest = (
            each
            for each in node.arguments
            if each.name is None or each.name.identifier.casefold() not in kept_method.around
        )
        return n.Call(callee, tuple(rest))

    new = text_site.rewritten(dialect, change)
    left |= {name for name in found if name in new.casefold()}
    return new, left
