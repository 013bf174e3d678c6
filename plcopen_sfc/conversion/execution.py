"""Everything in a project that a controller executes, as a tree of parts and their aspects.

What people and tools look at (titles, positions, ids, comments, vendor data) is left out, so that two trees differ only
where two machines may.
"""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.conversion.charts import ChartReader
from plcopen_sfc.conversion.meaning import (
    Meaning,
    address_meaning,
    code_meaning,
    type_meaning,
    value_meaning,
)
from plcopen_sfc.conversion.parts import UNDECLARED, Part, duration_meaning, plain_name
from plcopen_sfc.formats.durations import duration_literal
from plcopen_sfc.formats.iectext.source import unwrapped
from plcopen_sfc.languages.declarations.kept import kept
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names import Names
from plcopen_sfc.languages.names.pieces import pieces
from plcopen_sfc.languages.s7_types import S7Types
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.network import Block
from plcopen_sfc.model.pou import DataBlockKind, Pou, PouKind
from plcopen_sfc.model.project import PouInstance, Project, Task
from plcopen_sfc.model.types import (
    ArrayType,
    ArrayValue,
    DataType,
    DerivedType,
    Elementary,
    ElementaryType,
    EnumType,
    SimpleValue,
    StructType,
    StructValue,
    Value,
    Variable,
)
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.semantics.profile import Profile, default_profile

__all__ = ["executed"]


def executed(
    project: Project,
    profile: Profile | None = None,
    *,
    addresses: Dialect | None = None,
    lists: frozenset[str] = frozenset(),
) -> Part:
    """Everything that a controller executes of a project, under the rules of `profile`.

    `addresses` is the dialect of direct addresses, where it is not that of the program text. `lists` are names of lists
    of global variables that the source of a conversion has: the project may have structures in their place.
    """
    return _Reader(project, profile or default_profile(project), addresses or project.dialect, lists).read()


class _Reader:
    def __init__(self, project: Project, profile: Profile, addresses: Dialect, lists: frozenset[str]) -> None:
        self.project = project
        self.profile = profile
        self.dialect = project.dialect
        self.addresses = addresses
        self.whole = Part("")
        self.lists = {s.name.casefold() for s in self._global_sections() if s.name}
        self.lists |= {block.name.casefold() for block in project.data_blocks}
        self.whole.lists = frozenset(self.lists)
        self.lists |= lists
        self.values = _values(project)
        self.types = S7Types(project.data_types)
        self.declared = {declaration.name.casefold(): declaration.type for declaration in project.data_types}
        self.global_names = {v.name.casefold() for section in self._global_sections() for v in section.variables}

    def read(self) -> Part:
        for declaration in self.project.data_types:
            if not isinstance(declaration.type, StructType):
                continue  # other types are compared where they are used, by what they stand for
            part = self.whole.add("type", declaration.name, declaration.report_path)
            part.tell("type", type_meaning(self._plain_type(declaration.type), self.dialect))
            part.tell("initial value", value_meaning(self._number(declaration.initial), declaration.type))
        self._globals()
        self._tasks()
        for pou in self.project.pous:
            self._pou(pou)
        drawn = [piece.text for piece in pieces(self.project) if isinstance(piece.holder, Block)]
        self.whole.boxes = frozenset(map(plain_name, drawn))
        for occurrence in Names(self.project).undeclared():
            name = occurrence.reference.name
            if name.casefold() in _RESULTS | self.global_names or standard_block(name) is not None:
                continue
            self.whole.add(UNDECLARED, name, occurrence.piece.report_path).tell("name", Meaning.of(name))
        return self.whole

    def named(self, node: n.Node, result: str = "") -> n.Node:
        """A name as all tools could have it: without the list of a global variable; a result is ``Ret_Val``."""
        if (
            isinstance(node, n.Member)
            and isinstance(node.base, n.Name)
            and node.base.identifier.casefold() in self.lists
        ):
            return node.name
        if isinstance(node, n.Member) and isinstance(node.base, n.Name):
            number = self.values.get(f"{node.base.identifier}.{node.name.identifier}".casefold())
            return n.Literal(number) if number is not None else node
        if isinstance(node, n.Name) and node.identifier.casefold() in self.values:
            return n.Literal(self.values[node.identifier.casefold()])
        is_result = result and isinstance(node, n.Name) and node.identifier.casefold() in (result.casefold(), "ret_val")
        if is_result:
            return n.Name("Ret_Val")
        return n.Name(node.identifier) if isinstance(node, n.Name) and node.quoting is not n.Quoting.NONE else node

    def _number(self, value: Value | None) -> Value | None:
        """An initial value, in numbers where it names a value of an enumeration or a constant."""
        if isinstance(value, ArrayValue):
            items = [item.model_copy(update={"value": self._number(item.value)}) for item in value.items]
            return ArrayValue(items=items)
        if isinstance(value, StructValue):
            members = [each.model_copy(update={"value": self._number(each.value)}) for each in value.members]
            return StructValue(members=members)
        if not isinstance(value, SimpleValue) or value.text is None:
            return value
        number = self.values.get(value.text.replace('"', "").replace("#", ".").casefold())
        return value if number is None else SimpleValue(text=number)

    def _plain_type(self, kind: DataType, depth: int = 0) -> DataType:
        """A type without other names for types, with the numbers of enumerations, and with all initial values."""
        if isinstance(kind, DerivedType):
            declared = self.declared.get(kind.name.replace('"', "").casefold())
            stays = declared is None or isinstance(declared, StructType) or depth > _DEEPEST
            return kind if declared is None or stays else self._plain_type(declared, depth + 1)
        if isinstance(kind, EnumType):
            return kind.base or ElementaryType(name=Elementary.INT)
        if isinstance(kind, ArrayType):
            return ArrayType(dimensions=kind.dimensions, base=self._plain_type(kind.base))
        if isinstance(kind, StructType):
            return StructType(members=[self._plain_member(member) for member in kind.members])
        return kind

    def _plain_member(self, member: Variable) -> Variable:
        initial, kind = self._initial(member), self._plain_type(member.type)
        if value_meaning(initial, kind) is None:
            initial = None
        return Variable(name=member.name, type=kind, initial=initial)

    def _initial(self, variable: Variable) -> Value | None:
        """The initial value of a variable, its own or that of its type, in numbers."""
        return self._number(variable.initial) if variable.initial is not None else self.types.start(variable)

    def code(self, body: Body | None, result: str = "") -> Meaning | None:
        """The meaning of a body."""
        return code_meaning(body, self.dialect, lambda node: self.named(node, result))

    def target(self, name: str) -> str:
        """The name of a variable without that of its list."""
        around, dot, rest = name.replace('"', "").partition(".")
        return rest if dot and around.casefold() in self.lists else name

    # -- variables

    def _globals(self) -> None:
        for section in self._global_sections():
            for variable in section.variables:
                self._variable(self.whole, "global variable", variable, section, section.name or "")
        for block in self.project.data_blocks:
            if block.kind is DataBlockKind.INSTANCE:
                part = self.whole.add("instance", block.name, block.report_path)
                part.tell("type", Meaning.of((block.type_name or "").casefold(), block.type_name))
                continue
            for section in block.interface.sections if block.interface is not None else ():
                for variable in section.variables:
                    self._variable(self.whole, "global variable", variable, section, block.name)
        for table in self.project.tag_tables:
            for tag in table.tags:
                variable = Variable.model_validate({"name": tag.name, "type": tag.type, "address": tag.address})
                self._variable(self.whole, "global variable", variable, VariableSection(), "")
            for constant in table.constants:
                self._variable(self.whole, "global variable", constant, VariableSection(constant=True), "")

    def _global_sections(self) -> Iterator[VariableSection]:
        yield from self.project.global_variables
        for configuration in self.project.configurations:
            yield from configuration.global_variables
        for resource in (*self.project.applications, *(r for c in self.project.configurations for r in c.resources)):
            yield from resource.global_variables

    def _variable(self, owner: Part, kind: str, variable: Variable, section: VariableSection, around: str) -> None:
        place = f"{around}.{variable.name}" if around and owner is self.whole else variable.name
        path = f"{kind} {place}" if owner is self.whole else f"{owner.path} / {variable.name}"
        part = owner.add(kind.removesuffix(" of a function"), variable.name, path)
        part.tell("type", type_meaning(self._plain_type(variable.type), self.dialect))
        part.tell("initial value", value_meaning(self._initial(variable), self._plain_type(variable.type)))
        part.tell("address", address_meaning(variable.address, self.addresses))
        if section.retain or section.persistent or variable.attributes.get("Remanence") == "Retain":
            part.tell("retain", Meaning.of(True, "RETAIN"))
        if section.constant or section.kind is SectionKind.CONSTANT:
            part.tell("constant", Meaning.of(True, "CONSTANT"))
        edge = kept(variable.carried).get("edge")
        part.tell("edge", Meaning.of(edge) if edge else None)
        if owner is not self.whole:
            section_kind = SectionKind.LOCAL if section.kind is SectionKind.CONSTANT else section.kind
            if section_kind is SectionKind.LOCAL and kind == "variable of a function":
                section_kind = SectionKind.TEMP  # a function keeps nothing
            part.tell("section", Meaning.of(section_kind.value))
            if kept(section.carried).get("keyword") == "VAR_STAT":
                part.tell("static", Meaning.of(True, "VAR_STAT"))

    # -- tasks

    def _tasks(self) -> None:
        for resource in (*self.project.applications, *(r for c in self.project.configurations for r in c.resources)):
            for task in resource.tasks:
                self._task(task)
            for instance in resource.instances:
                part = self.whole.add("program instance", instance.name, f"program instance {instance.name}")
                _tell_instance(part, instance)

    def _task(self, task: Task) -> None:
        part = self.whole.add("task", task.name, f"task {task.name}")
        part.tell("interval", duration_meaning(duration_literal(task.interval)))
        if task.single:
            part.tell("trigger", Meaning.of(task.single.strip().casefold(), task.single))
        part.tell("priority", Meaning.of(task.priority))
        for instance in task.instances:
            inner = part.add("program instance", instance.name, f"task {task.name} / {instance.name}")
            _tell_instance(inner, instance)

    # -- POUs

    def _pou(self, pou: Pou) -> None:
        part = self.whole.add("POU", pou.name, pou.report_path)
        part.tell("kind", Meaning.of(pou.kind.value))
        if pou.interface is not None:
            self._result(part, pou.interface.return_type)
            for section in pou.interface.sections:
                # VAR_EXTERNAL declares nothing: a global variable that is missing is told as such
                for variable in section.variables if section.kind is not SectionKind.EXTERNAL else ():
                    if section.kind is SectionKind.RETURN:
                        self._result(part, variable.type)
                    else:
                        kind = "variable of a function" if pou.kind is PouKind.FUNCTION else "variable"
                        self._variable(part, kind, variable, section, "")
        called: set[str] = set()
        for body in pou.bodies:
            self._body(part, pou, body, pou.report_path, called)
        for method in pou.methods:
            inner = part.add("method", method.name, f"{pou.report_path} / method {method.name}")
            inner.tell("code", self.code(method.body))
        for action in pou.actions:
            if action.name.casefold() not in called or isinstance(action.body, SfcBody):
                inner = part.add("action of the POU", action.name, f"{pou.report_path} / action {action.name}")
                if action.body is not None:
                    self._body(inner, pou, action.body, inner.path, called)

    def _result(self, part: Part, kind: DataType | None) -> None:
        if not (isinstance(kind, DerivedType) and kind.name.casefold() == "void"):  # S7 says so of functions without
            part.tell("result", type_meaning(kind, self.dialect))

    def _body(self, part: Part, pou: Pou, body: Body, path: str, called: set[str]) -> None:
        if isinstance(body, SfcBody):
            if body.chart.steps or body.chart.transitions:
                ChartReader(self, pou, body.chart, path, called).read(part.add("chart", "", path))
        else:
            number = sum(aspect.startswith("code") for aspect in part.aspects)
            result = pou.name if pou.kind is PouKind.FUNCTION else ""
            meaning = self.code(body, result)
            part.tell(f"code {number + 1}" if number else "code", meaning)


_DEEPEST = 32
"""No type is another name for another name .. more often: these name each other."""
_RESULTS = frozenset({"trcoil", "ilcoil", "svcoil"})
"""What the results of the networks of S7-GRAPH are called."""


def _values(project: Project) -> dict[str, str]:
    """The numbers of values of enumerations and of user constants, by their names in lower case."""
    found: dict[str, str] = {}
    for declaration in project.data_types:
        number = -1
        for value in declaration.type.values if isinstance(declaration.type, EnumType) else ():
            given = (value.value or "").strip()
            number = int(given) if given.lstrip("-").isdigit() else number + 1
            for name in (f"{declaration.name}.{value.name}", f"{declaration.name}_{value.name}"):
                found[name.casefold()] = str(number)
    for table in project.tag_tables:
        for constant in table.constants:
            if isinstance(constant.initial, SimpleValue) and constant.initial.text is not None:
                found[constant.name.casefold()] = constant.initial.text
    return found


def _tell_instance(part: Part, instance: PouInstance) -> None:
    name = instance.type_name or instance.name  # an instance without a program is named as its program
    part.tell("type", Meaning.of(name.casefold(), name))
    for data in instance.carried.data if instance.carried is not None else ():
        place, text = unwrapped(data.content) or ("", "")
        if place == "arguments":
            part.tell("arguments", Meaning.of(" ".join(text.split()).casefold(), text))
