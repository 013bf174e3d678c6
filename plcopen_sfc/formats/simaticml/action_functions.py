"""Functions in SCL that hold the statements of actions: a row of S7-GRAPH has room for one assignment or call.

A function of S7 keeps nothing and sees no variable of the block that calls it. So it gets each local variable that its
statements name under the same name: as input if they only read it, else as in-out parameter. A row that calls it
passes the variables. The statements stay as they are.

Instances of function blocks are in-out parameters: TIA Portal documents them as parameter instances, from V14 on, for
the S7-1500 and the S7-1200. No sample shows how it exports them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.languages.networks import body_statements
from plcopen_sfc.languages.s7_actions import ActionCalls
from plcopen_sfc.languages.s7_globals import global_names
from plcopen_sfc.languages.s7_programs import s7_programs
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, print_node, walk
from plcopen_sfc.languages.st.effects import ANYTHING, effects, path_of
from plcopen_sfc.languages.standard_blocks import S7_INSTANCES, StandardBlock, standard_block
from plcopen_sfc.model.body import Body, FbdBody, LdBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import ArrayType, DataType, DerivedType, ElementaryType, StringType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection

_LONGEST = 120
"""Most characters of a name: TIA Portal takes 125, and a number may follow."""
_INSTANCES = {own: block for block, own in S7_INSTANCES.items()}
_LOCAL = (n.Quoting.LOCAL, n.Quoting.LOCAL_QUOTED)


@dataclass(frozen=True, slots=True)
class ControlNetwork:
    """A network of an action control; `label` names the action."""

    label: str
    body: LdBody


@dataclass
class ActionControls:
    """The action controls of a chart: added variables and networks, and the associations that need no row."""

    variables: list[Variable] = field(default_factory=list)
    networks: list[ControlNetwork] = field(default_factory=list)
    controlled: dict[tuple[int, int], str] = field(default_factory=dict)
    """What is told of each association, by the ids of its step and its own."""


class ActionFunctions:
    """The functions of the actions of a project; they have the same names whenever they are made in the same order."""

    def __init__(self, project: Project, calls: ActionCalls) -> None:
        self.made: list[Pou] = []
        self.calls = calls
        self._found: dict[tuple[str, str, str], Pou | str] = {}
        self._is_of_folder = (
            project.source is not None and project.source.format == "simaticml" and project.source.is_folder
        )
        programs = s7_programs(project)
        self._taken = {*global_names(project), *(block.name.casefold() for block in programs.blocks)}
        self._taken |= {caller.block.name.casefold() for caller in programs.callers}
        self._types = {declaration.name.casefold() for declaration in project.data_types}
        self._pous = {pou.name.casefold(): pou for pou in project.pous}

    def function(self, pou: Pou, label: str, body: Body) -> Pou | str:
        """Return the function for the body of an action of `pou`; a reason where there is none."""
        if isinstance(body, FbdBody | LdBody):
            drawn = body_statements(body, Dialect.SCL)
            if drawn.obstacles or drawn.helpers or drawn.open_ends:
                return "its network is no list of statements"
            body = StBody(text=print_node(drawn.tree, Dialect.SCL))
        if not isinstance(body, StBody):
            return f"it is a body in {body.language}"
        calls = self.calls.inlined(body.text, pou)
        if calls.problems:
            return f"it calls an action that no statements replace: {calls.problems[0]}"
        body = StBody(text=calls.text)
        if self._is_of_folder:
            return "the function for it is a file of its own, which an edit of the folder does not write"
        key = (pou.name, label, body.text)
        found = self._found.get(key)
        if found is None:
            found = self._found[key] = self._make(pou, label, body)
            if isinstance(found, Pou):
                self.made.append(found)
        return found

    def _make(self, pou: Pou, label: str, body: StBody) -> Pou | str:
        parsed = parse_statements(body.text, Dialect.SCL)
        if parsed.problems:
            return "its text cannot be read"
        tree = parsed.tree
        used = {
            each.identifier.casefold() for each in walk(tree) if isinstance(each, n.Name) and each.quoting in _LOCAL
        }
        interface = pou.interface or Interface()
        known = {v.name.casefold(): (section, v) for section in interface.sections for v in section.variables}
        blocks = {name: block for name, (_, v) in known.items() if (block := self._block(v.type)) is not None}
        functions = {name: each for name, each in self._pous.items() if each.kind is PouKind.FUNCTION}
        # what a block or a function of the project does beside its parameters it does wherever it is called
        found = effects(tree.statements, {(name,) for name in (*blocks, *functions)})
        written = {path[0] for path in found.writes if path} | set(_passed_in_out(tree, {**functions, **blocks}))
        own = {method.name.casefold() for method in pou.methods}
        if not own.isdisjoint(path[0] for path in found.calls if path):
            return "it calls a method"
        if ANYTHING in found.writes:
            return "it writes what its text does not name"
        for name in sorted(used - known.keys()):
            return f"it uses {name}, which is no variable of the block"
        sections = {kind: VariableSection(kind=kind) for kind in (SectionKind.INPUT, SectionKind.IN_OUT)}
        for name, (section, variable) in known.items():
            if name not in used:
                continue
            if name not in blocks and not self._is_passed(variable.type):
                return f"{variable.name} has a type that no parameter has"
            if name in blocks and section.kind not in (SectionKind.LOCAL, SectionKind.IN_OUT):
                return f"{variable.name} is an instance that is no static variable"
            is_input = section.constant or section.kind in (SectionKind.INPUT, SectionKind.CONSTANT)
            if is_input and name in written:
                return f"it writes the input {variable.name}"
            kind = SectionKind.INPUT if is_input and name not in blocks else SectionKind.IN_OUT
            sections[kind].variables.append(Variable(name=variable.name, type=variable.type))
        filled = Interface(sections=[section for section in sections.values() if section.variables])
        return Pou(
            name=self._free(f"{pou.name}_{label}"[:_LONGEST]), kind=PouKind.FUNCTION, interface=filled, bodies=[body]
        )

    def _block(self, type_: DataType) -> Pou | StandardBlock | None:
        """Return the function block that a variable of this type is an instance of; None for other types."""
        if not isinstance(type_, DerivedType):
            return None
        name = type_.name.strip('"')
        own, standard = self._pous.get(name.casefold()), standard_block(_INSTANCES.get(name.upper(), name))
        if own is not None:
            return own if own.kind is PouKind.FUNCTION_BLOCK else None
        return standard if standard is not None and standard.stateful else None

    def _is_passed(self, type_: DataType) -> bool:
        """True for types of parameters."""
        if isinstance(type_, ArrayType):
            return self._is_passed(type_.base)
        return isinstance(type_, ElementaryType | StringType) or (
            isinstance(type_, DerivedType) and type_.name.casefold() in self._types
        )

    def _free(self, wish: str) -> str:
        name, number = wish, 1
        while name.casefold() in self._taken:
            number += 1
            name = f"{wish}_{number}"
        self._taken.add(name.casefold())
        return name


def _passed_in_out(tree: n.Node, called: Mapping[str, Pou | StandardBlock]) -> Iterator[str]:
    """Yield the variables that a tree passes to in-out parameters of what it calls."""
    for call in walk(tree):
        block = (
            called.get(call.callee.identifier.casefold())
            if isinstance(call, n.Call) and isinstance(call.callee, n.Name)
            else None
        )
        if not isinstance(call, n.Call) or not isinstance(block, Pou):
            continue
        changed = {variable.name.casefold() for variable in block.variables(SectionKind.IN_OUT)}
        for argument in call.arguments:
            is_changed = argument.name is None or argument.name.identifier.casefold() in changed
            if changed and is_changed and argument.value is not None and (path := path_of(argument.value)):
                yield path[0]


def call_of(function: Pou) -> str:
    """Return the statement of a row that calls a function with the variables of the block."""
    names = [variable.name for variable in function.variables()]
    passed = ", ".join(f"{name} := #{name}" for name in names)
    return f'"{function.name}"({passed});'
