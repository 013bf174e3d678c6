"""Functions in SCL that hold the statements of actions: a row of S7-GRAPH has room for one assignment or call.

A function of S7 keeps nothing and sees no variable of the block that calls it. So it gets each local variable that its
statements name under the same name: as input if they only read it, else as in-out parameter. A row that calls it
passes the variables. The statements stay as they are.
"""

from __future__ import annotations

from plcopen_sfc.languages.networks import body_statements
from plcopen_sfc.languages.s7_globals import global_names
from plcopen_sfc.languages.s7_programs import s7_programs
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, print_node, walk
from plcopen_sfc.languages.st.effects import ANYTHING, effects
from plcopen_sfc.model.body import Body, FbdBody, LdBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import ArrayType, DataType, DerivedType, ElementaryType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection

_LONGEST = 120
"""Most characters of a name: TIA Portal takes 125, and a number may follow."""
_LOCAL = (n.Quoting.LOCAL, n.Quoting.LOCAL_QUOTED)


class ActionFunctions:
    """The functions of the actions of a project; they have the same names whenever they are made in the same order."""

    def __init__(self, project: Project) -> None:
        self.made: list[Pou] = []
        self._found: dict[tuple[str, str, str], Pou | str] = {}
        self._is_of_folder = (
            project.source is not None and project.source.format == "simaticml" and project.source.is_folder
        )
        programs = s7_programs(project)
        self._taken = {*global_names(project), *(block.name.casefold() for block in programs.blocks)}
        self._taken |= {caller.block.name.casefold() for caller in programs.callers}
        self._types = {declaration.name.casefold() for declaration in project.data_types}

    def function(self, pou: Pou, label: str, body: Body) -> Pou | str:
        """Return the function for the body of an action of `pou`; a reason where there is none."""
        if isinstance(body, FbdBody | LdBody):
            drawn = body_statements(body, Dialect.SCL)
            if drawn.obstacles or drawn.helpers or drawn.open_ends:
                return "its network is no list of statements"
            body = StBody(text=print_node(drawn.tree, Dialect.SCL))
        if not isinstance(body, StBody):
            return f"it is a body in {body.language}"
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
        found = effects(tree.statements)
        written = {path[0] for path in found.writes if path}
        if ANYTHING in found.writes:
            return "it writes what its text does not name"
        interface = pou.interface or Interface()
        known = {v.name.casefold(): (section, v) for section in interface.sections for v in section.variables}
        for name in sorted(used - known.keys()):
            return f"it uses {name}, which is no variable of the block"
        own = {action.name.casefold() for action in pou.actions} | {method.name.casefold() for method in pou.methods}
        if not own.isdisjoint(path[0] for path in found.calls if path):
            return "it calls an action or a method"
        sections = {kind: VariableSection(kind=kind) for kind in (SectionKind.INPUT, SectionKind.IN_OUT)}
        for name, (section, variable) in known.items():
            if name not in used:
                continue
            if not self._is_passed(variable.type):
                return f"{variable.name} is a string or an instance, which it does not get as parameter"
            is_input = section.constant or section.kind in (SectionKind.INPUT, SectionKind.CONSTANT)
            if is_input and name in written:
                return f"it writes the input {variable.name}"
            kind = SectionKind.INPUT if is_input else SectionKind.IN_OUT
            sections[kind].variables.append(Variable(name=variable.name, type=variable.type))
        filled = Interface(sections=[section for section in sections.values() if section.variables])
        return Pou(
            name=self._free(f"{pou.name}_{label}"[:_LONGEST]), kind=PouKind.FUNCTION, interface=filled, bodies=[body]
        )

    def _is_passed(self, type_: DataType) -> bool:
        """True for types of parameters; how TIA Portal declares those of strings and instances is not known."""
        if isinstance(type_, ArrayType):
            return self._is_passed(type_.base)
        return isinstance(type_, ElementaryType) or (
            isinstance(type_, DerivedType) and type_.name.casefold() in self._types
        )

    def _free(self, wish: str) -> str:
        name, number = wish, 1
        while name.casefold() in self._taken:
            number += 1
            name = f"{wish}_{number}"
        self._taken.add(name.casefold())
        return name


def call_of(function: Pou) -> str:
    """Return the statement of a row that calls a function with the variables of the block."""
    names = [variable.name for variable in function.variables()]
    passed = ", ".join(f"{name} := #{name}" for name in names)
    return f'"{function.name}"({passed});'
