"""Functions in SCL and blocks in GRAPH for actions: a row of S7-GRAPH has room for one assignment or call.

A function of S7 keeps nothing and sees no variable of the block that calls it. So it gets each local variable that its
statements name under the same name: as input if they only read it, else as in-out parameter. A row that calls it
passes the variables. The statements stay as they are, but for data of steps, which are inputs too: `#Clamp_T` in the
place of `#Clamp.T`.

Instances of function blocks are in-out parameters: TIA Portal documents them as parameter instances, from V14 on, for
the S7-1500 and the S7-1200. No sample shows how it exports them.

The chart of an action is a function block with the same parameters. The block that has the action has one instance of
it, as CODESYS has one chart: it goes on from where it was when it was last executed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, field

from plcopen_sfc.formats.xml.extension_data import Markup, exchange_markup
from plcopen_sfc.languages.binding.text_sites import SiteKind, TextSite, text_sites, text_sites_in
from plcopen_sfc.languages.effects import ANYTHING, Effects, Path, effects, path_of
from plcopen_sfc.languages.library_blocks import library_blocks
from plcopen_sfc.languages.method_calls import MethodFunction, function_of_method, passed_in_out, without_function
from plcopen_sfc.languages.networks import Helper, body_statements
from plcopen_sfc.languages.s7_actions import ActionCalls
from plcopen_sfc.languages.s7_globals import global_names
from plcopen_sfc.languages.s7_programs import renamed_local, s7_programs
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node, walk
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.standard_blocks import BLOCKS_OF_S7, S7_VERSION, StandardBlock, standard_block
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.words import identifier, take_name, underscored_name
from plcopen_sfc.model import types as t
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.conditions import NamedCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import BlockVariable, Coil, OutputPin, OutputVariable
from plcopen_sfc.model.pou import Action, Method, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, SfcBody, SfcNetwork
from plcopen_sfc.model.text import without_signs
from plcopen_sfc.model.variables import PASSED, Interface, SectionKind, VariableSection, sections_of

_OF_EDGES = frozenset({"R_TRIG", "F_TRIG", "BOOL"})
"""Types of the variables that networks with edges need."""
_LONGEST = 120
"""Most characters of a name: TIA Portal takes 125, and a number may follow."""
_LOCAL = (n.Quoting.LOCAL, n.Quoting.LOCAL_QUOTED)
_NO_TEXT = "its network is no list of statements"
_OF_FOLDER = "the function for it is a file of its own, which an edit of the folder does not write"
_ANY_WRITTEN = "it calls what may write variables that its text does not name"
_STEP_DATA = {"X": t.Elementary.BOOL, "T": t.Elementary.TIME}
"""The data of steps that calls pass, with their types."""


@dataclass(frozen=True, slots=True)
class ControlNetwork:
    """A network of an action control; `label` names the action."""

    label: str
    body: LdBody


@dataclass
class ActionControls:
    """The action controls of a chart: added variables and networks, and the associations that need no row."""

    variables: list[t.Variable] = field(default_factory=list)
    networks: list[ControlNetwork] = field(default_factory=list)
    controlled: dict[tuple[int, int], str] = field(default_factory=dict)
    """Facts told of each association, by the ids of its step and its own."""
    going_on: list[str] = field(default_factory=list)
    """The actions that no network lets obey the SFC flags of the chart, as people call them."""


@dataclass(frozen=True)
class ActionChart:
    """The block for the chart of an action of `owner`, and the variable of `owner` that is the instance of it."""

    owner: Pou
    action: Action
    block: Pou
    instance: t.Variable

    @property
    def call(self) -> str:
        """The statement that executes the chart once."""
        names = [variable.name for variable in self.block.variables()]
        return f"#{self.instance.name}({', '.join(f'{name} := #{name}' for name in names)});"


@dataclass(frozen=True)
class _DrawnText:
    """A network as statements, None where it is none, and the variables that are temporary in them."""

    text: str | None
    temporary: Sequence[t.Variable]


class ActionFunctions:
    """The functions of the actions of a project; they have the same names whenever they are made in the same order."""

    def __init__(self, project: Project, calls: ActionCalls) -> None:
        self.made: list[Pou] = []
        self.calls = calls
        calls.call_of_chart = self._call_of_chart
        calls.function_of_method = self.method
        self.told: set[int] = set()
        """Ids of the actions that rows execute, or that a step is told not to execute."""
        self.charts: dict[str, ActionChart] = {}
        """Blocks for charts of actions, by their names in lower case."""
        self._of_actions: dict[int, ActionChart | str] = {}
        self._of_methods: dict[int, MethodFunction | str] = {}
        self._edges: dict[str, list[t.Variable]] = {}
        self._drawn: dict[tuple[str, str, int], _DrawnText] = {}
        self._found: dict[tuple[str, str, str], Pou | str] = {}
        self._step_data: dict[str, dict[str, str]] = {}
        self._is_of_folder = (
            project.source is not None and project.source.format == "simaticml" and project.source.is_folder
        )
        programs = s7_programs(project)
        self._taken = {*global_names(project), *(block.name.casefold() for block in programs.blocks)}
        self._taken |= {caller.block.name.casefold() for caller in programs.callers}
        self._types = {declaration.name.casefold() for declaration in project.data_types}
        self._pous = {pou.name.casefold(): pou for pou in (*project.pous, *library_blocks(project))}
        self._passed = frozenset(_passed_inputs(project))
        self._kept_inside: dict[str, frozenset[str]] = {}
        types = (each.type for other in project.pous for each in other.variables())
        self._instanced = {type_.name.strip('"').casefold() for type_ in types if isinstance(type_, t.DerivedType)}

    def function(self, pou: Pou, label: str, body: Body) -> Pou | str:
        """Return the function for the body of an action of `pou`; a reason where there is none."""
        drawn = self._drawn_text(pou, label, body) if isinstance(body, FbdBody | LdBody) else None
        text = drawn.text if drawn is not None else _text(body)
        if text is None:
            return _NO_TEXT if isinstance(body, FbdBody | LdBody) else f"it is a body in {body.language}"
        calls = self.calls.inlined(text, pou)
        if calls.problems:
            return f"it calls what nothing replaces: {calls.problems[0]}"
        body = StBody(text=calls.text)
        if self._is_of_folder:
            return _OF_FOLDER
        key = (pou.name, label, body.text)
        found = self._found.get(key)
        if found is None:
            found = self._found[key] = self._make(pou, label, body, drawn.temporary if drawn is not None else ())
            if isinstance(found, Pou):
                self.made.append(found)
        return found

    def chart(self, pou: Pou, action: Action) -> ActionChart | str:
        """Return the block for the chart of an action of `pou`; a reason where there is none."""
        around = self.charts.get(pou.name.casefold())
        owner = around.owner if around is not None else pou
        found = self._of_actions.get(id(action))
        if found is None:
            # found while its block is made, by a call in its own chart
            self._of_actions[id(action)] = "it executes itself"
            found = self._of_actions[id(action)] = self._make_chart(owner, action)
            if isinstance(found, ActionChart):
                self.made.append(found.block)
                self.charts[found.block.name.casefold()] = found
        return found

    def method(self, owner: Pou, method: Method, _path: str = "") -> MethodFunction | str:
        """Return the function for a method of `owner`; a reason where there is none."""
        if id(method) not in self._of_methods:
            # found while its function is made
            self._of_methods[id(method)] = "it calls itself"
            self._of_methods[id(method)] = self._make_method(owner, method)
        return self._of_methods[id(method)]

    def arguments(self, called: Pou) -> dict[str, str]:
        """Return the arguments of a call of a function, or of the block for a chart, by their names."""
        parameters = [
            v for section in sections_of(called.interface) if section.kind in PASSED for v in section.variables
        ]
        passed = {variable.name: f"#{variable.name}" for variable in parameters}
        return passed | self._step_data.get(called.name, {})

    def call(self, function: Pou) -> str:
        """Return the statement of a row that calls a function with the variables of the block."""
        passed = ", ".join(f"{name} := {value}" for name, value in self.arguments(function).items())
        return f'"{function.name}"({passed});'

    def instances(self, pou: Pou) -> list[t.Variable]:
        """Return the variables that `pou` gets: instances of blocks for charts of its actions, and of drawn edges."""
        charts = [chart.instance for chart in self.charts.values() if chart.owner.name == pou.name]
        return charts + self._edges.get(pou.name, [])

    def _drawn_text(self, pou: Pou, label: str, body: FbdBody | LdBody) -> _DrawnText:
        """Return a network as statements; what its edges keep are variables of `pou`."""
        key = (pou.name, label, id(body))
        if key not in self._drawn:
            taken = {variable.name for variable in (*pou.variables(), *self.instances(pou))}
            taken |= {step.name for other in pou.bodies if isinstance(other, SfcBody) for step in other.chart.steps}
            drawn = body_statements(body, Dialect.SCL, taken=taken)
            is_text = not drawn.obstacles and not drawn.open_ends
            is_text = is_text and all(helper.type_name in _OF_EDGES for helper in drawn.helpers)
            made = [(helper, _helper(helper)) for helper in (drawn.helpers if is_text else ())]
            temporary = [variable for helper, variable in made if not helper.retained]
            self._drawn[key] = _DrawnText(print_node(drawn.tree) if is_text else None, temporary)
            self._edges.setdefault(pou.name, []).extend(variable for helper, variable in made if helper.retained)
        return self._drawn[key]

    def kept_inside(self, pou: Pou) -> frozenset[str]:
        """Return the inputs of a block that no call passes, and that are instances or written by the block itself.

        CODESYS has such inputs. In S7 they are static variables, which others write and read as well. An input of a
        block without an instance in the project may be passed elsewhere; one of a program is not.
        """
        around = self.charts.get(pou.name.casefold())
        pou = around.owner if around is not None else pou
        if pou.name.casefold() not in self._instanced and pou.kind is not PouKind.PROGRAM:
            return frozenset()
        if pou.name not in self._kept_inside:
            inputs = {v.name.casefold(): self._block(v.type) for v in pou.variables(SectionKind.INPUT)}
            written = self._written(pou) if inputs.keys() - self._passed else set()
            found = {name for name, block in inputs.items() if block is not None or name in written}
            self._kept_inside[pou.name] = frozenset(found - self._passed)
        return self._kept_inside[pou.name]

    def _written(self, pou: Pou) -> set[str]:
        """Return the variables that the bodies of a block and of its actions write in texts and as targets."""
        uses = _Uses(pou, self, follows=False)
        for body in (*pou.bodies, *(action.body for action in pou.actions)):
            if isinstance(body, SfcBody):
                uses.add(body.chart)
            elif isinstance(body, StBody):
                uses.add_statements(body.text)
        return uses.writes

    def _call_of_chart(self, owner: Pou, action: Action) -> str | None:
        found = self.chart(owner, action)
        return found.call if isinstance(found, ActionChart) else None

    def _make_chart(self, owner: Pou, action: Action) -> ActionChart | str:
        if self._is_of_folder:
            return _OF_FOLDER.replace("function", "block")
        if not isinstance(action.body, SfcBody):
            return "it is no chart"
        chart = action.body.chart
        if not chart.steps:
            return "it has no steps"
        uses = _Uses(owner, self)
        uses.add(chart)
        if uses.problem:
            return uses.problem
        taken = {variable.name.casefold() for variable in owner.variables()}
        interface = self._parameters(owner, uses.names - {step.name.casefold() for step in chart.steps}, uses.writes)
        if isinstance(interface, str):
            return interface
        name = underscored_name(f"{action.name}_chart", taken)
        block = Pou(
            name=take_name(f"{owner.name}_{action.name}"[:_LONGEST], self._taken),
            kind=PouKind.FUNCTION_BLOCK,
            interface=interface,
            bodies=[action.body],
            actions=owner.actions,
            transitions=owner.transitions,
        )
        return ActionChart(owner, action, block, t.Variable(name=name, type=t.DerivedType(name=block.name)))

    def _make_method(self, owner: Pou, method: Method) -> MethodFunction | str:
        """Make the function for a method, with the parameters of that and the variables of the block that it uses."""
        if self._is_of_folder:
            return _OF_FOLDER
        if why_not := without_function(owner, method, self._pous, _declared):
            return why_not
        text = _text(method.body) if method.body is not None else ""
        if text is None:
            return "its body is no list of statements"
        calls = self.calls.inlined(text, owner, method)
        parsed = parse_statements(calls.text, Dialect.SCL)
        if calls.problems or parsed.problems:
            return calls.problems[0] if calls.problems else "its text cannot be read"
        interface = method.interface or Interface()
        own = {variable.name.casefold() for variable in interface.variables()} | {method.name.casefold()}
        found = self.effects(owner, parsed.tree)
        if ANYTHING in found.writes:
            return _ANY_WRITTEN
        used = _local_names(parsed.tree)
        filled = self._parameters(owner, used - own, {path[0] for path in found.writes if path} - own)
        if isinstance(filled, str):
            return filled
        name = take_name(f"{owner.name}_{method.name}"[:_LONGEST], self._taken)
        text = renamed_local(calls.text, method.name, name)
        interface, call = function_of_method(name, method, filled.sections)
        self.made.append(Pou(name=name, kind=PouKind.FUNCTION, interface=interface, bodies=[StBody(text=text)]))
        return call

    def _parameters(self, pou: Pou, used: Set[str], written: Set[str]) -> Interface | str:
        """Return the parameters of a block that uses variables of `pou`; a reason where they cannot be parameters."""
        known = {v.name.casefold(): (s, v) for s in sections_of(pou.interface) for v in s.variables}
        known |= {v.name.casefold(): (VariableSection(kind=SectionKind.LOCAL), v) for v in self.instances(pou)}
        blocks = {name: block for name, (_, v) in known.items() if (block := self._block(v.type)) is not None}
        charts = [body.chart for body in pou.bodies if isinstance(body, SfcBody)]
        steps = {step.name.casefold(): step.name for chart in charts for step in chart.steps}
        for name in sorted(used - known.keys()):
            if name in steps:
                why = f"it uses data of the step {steps[name]}, which no call passes"
                return f"{why}; let the step set a variable (N), and use that in its place"
            return f"it uses {name}, which is no variable of the block"
        sections = {kind: VariableSection(kind=kind) for kind in (SectionKind.INPUT, SectionKind.IN_OUT)}
        for name, (section, variable) in known.items():
            if name not in used:
                continue
            if name not in blocks and not self._is_passed(variable.type):
                return f"its variable {variable.name} has a type that no parameter of a function may have"
            is_inside = section.kind in (SectionKind.LOCAL, SectionKind.IN_OUT) or name in self.kept_inside(pou)
            if name in blocks and not is_inside:
                return f"{variable.name} is an instance that is no static variable"
            is_input = section.constant or section.kind in (SectionKind.INPUT, SectionKind.CONSTANT)
            is_input = is_input and name not in blocks and name not in self.kept_inside(pou)
            if is_input and name in written:
                return f"it writes the input {variable.name}"
            kind = SectionKind.INPUT if is_input else SectionKind.IN_OUT
            sections[kind].variables.append(t.Variable(name=variable.name, type=variable.type))
        return Interface(sections=[section for section in sections.values() if section.variables])

    def effects(self, pou: Pou, tree: n.Statements) -> Effects:
        """Return the variables that statements of `pou` read and write, but for a block's own."""
        called = self._called(pou, tree)
        found = effects(tree.statements, set(called))
        return Effects(found.reads, found.writes | {(name,) for name in passed_in_out(tree, called)}, found.calls)

    def _called(self, pou: Pou, tree: n.Statements) -> dict[Path, Pou | StandardBlock]:
        """Return the functions and the instances that statements of `pou` call, by their paths."""
        found: dict[Path, Pou | StandardBlock] = {
            (each.name.casefold(),): each
            for each in (*self._pous.values(), *self.made)
            if each.kind is PouKind.FUNCTION
        }
        for call in walk(tree):
            path = path_of(call.callee) if isinstance(call, n.Call) else None
            block: Pou | StandardBlock | None = pou
            for name in path or ():
                inside = (*block.variables(), *self.instances(block)) if isinstance(block, Pou) else ()
                variable = next((each for each in inside if each.name.casefold() == name.casefold()), None)
                block = self._block(variable.type) if variable is not None else None
            if path and block is not None:
                found[path] = block
        return found

    def _make(self, pou: Pou, label: str, body: StBody, temporary: Sequence[t.Variable]) -> Pou | str:
        parsed = parse_statements(body.text, Dialect.SCL)
        if parsed.problems:
            return "its text cannot be read"
        text, data = self._with_step_data(pou, body.text, parsed.tree)
        if data:
            body, parsed = StBody(text=text), parse_statements(text, Dialect.SCL)
        tree, inputs = parsed.tree, {variable.name.casefold() for variable, _ in data}
        inside = {variable.name.casefold() for variable in temporary}
        used = _local_names(tree)
        found = self.effects(pou, tree)
        written = {path[0] for path in found.writes if path}
        if ANYTHING in found.writes:
            return _ANY_WRITTEN
        if not written.isdisjoint(inputs):
            return "it writes data of a step"
        filled = self._parameters(pou, used - inputs - inside, written)
        if isinstance(filled, str):
            return filled
        if temporary:
            filled.sections.append(VariableSection(kind=SectionKind.TEMP, variables=[*temporary]))
        if data:
            of_steps = VariableSection(kind=SectionKind.INPUT, variables=[variable for variable, _ in data])
            filled.sections.insert(0, of_steps)
        function = Pou(
            name=take_name(f"{pou.name}_{label}"[:_LONGEST], self._taken),
            kind=PouKind.FUNCTION,
            interface=filled,
            bodies=[body],
        )
        self._step_data[function.name] = {variable.name: value for variable, value in data}
        return function

    def _steps_inside(self, pou: Pou, tree: n.Node, own: Set[str]) -> dict[str, tuple[str, str]]:
        """Return the steps of charts of actions that statements name, by their names in lower case.

        Each with its name and the instance of the block for its chart. `own`: the steps of the chart of `pou`.
        """
        members = [each for each in walk(tree) if isinstance(each, n.Member) and isinstance(each.base, n.Name)]
        named = {each.base.identifier.casefold() for each in members if isinstance(each.base, n.Name)} - own
        found: dict[str, tuple[str, str]] = {}
        for action in pou.actions if pou.name.casefold() not in self.charts else ():
            steps = action.body.chart.steps if isinstance(action.body, SfcBody) else ()
            names = [step.name for step in steps if step.name.casefold() in named]
            chart = self.chart(pou, action) if names else ""
            if isinstance(chart, ActionChart):
                found |= {name.casefold(): (name, f"#{chart.instance.name}") for name in names}
        return found

    def _with_step_data(self, pou: Pou, text: str, tree: n.Statements) -> tuple[str, list[tuple[t.Variable, str]]]:
        """Return a text with variables in place of data of steps, and each of them with the data that it replaces."""
        charts = [body.chart for body in pou.bodies if isinstance(body, SfcBody)]
        steps = {step.name.casefold(): step.name for chart in charts for step in chart.steps}
        inside = self._steps_inside(pou, tree, steps.keys())
        steps |= {name: step for name, (step, _) in inside.items()}
        taken = {variable.name.casefold() for variable in pou.variables()} | steps.keys()
        found: dict[tuple[str, str], tuple[t.Variable, str]] = {}
        edits: list[Edit] = []
        for node in walk(tree):
            if not isinstance(node, n.Member) or not isinstance(node.base, n.Name) or node.span is None:
                continue
            step, member = steps.get(node.base.identifier.casefold()), node.name.identifier.upper()
            if step is None or node.base.quoting not in _LOCAL or member not in _STEP_DATA:
                continue
            if (step, member) not in found:
                name = underscored_name(identifier(f"{step}_{member}"), taken)
                variable = t.Variable(name=name, type=t.ElementaryType(name=_STEP_DATA[member]))
                of_step = text[slice(*node.span)]
                _, instance = inside.get(step.casefold(), ("", ""))
                found[step, member] = (variable, f"{instance}.{of_step.removeprefix('#')}" if instance else of_step)
            edits.append(Edit(*node.span, f"#{found[step, member][0].name}"))
        return apply_edits(text, edits), list(found.values())

    def _block(self, type_: t.DataType) -> Pou | StandardBlock | None:
        """Return the function block that a variable of this type is an instance of; None for other types."""
        if not isinstance(type_, t.DerivedType):
            return None
        name = type_.name.strip('"')
        made = next((each for each in self.made if each.name.casefold() == name.casefold()), None)
        own, standard = self._pous.get(name.casefold(), made), standard_block(BLOCKS_OF_S7.get(name.upper(), name))
        if own is not None:
            return own if own.kind is PouKind.FUNCTION_BLOCK else None
        return standard if standard is not None and standard.stateful else None

    def _is_passed(self, type_: t.DataType) -> bool:
        """True for types of parameters. A type that nothing declares is taken for one: the block has it by name too."""
        if isinstance(type_, t.ArrayType):
            return self._is_passed(type_.base)
        return isinstance(type_, t.ElementaryType | t.StringType) or (
            isinstance(type_, t.DerivedType)
            and (type_.name.casefold() in self._types or type_.name.casefold() not in self._pous)
        )


class _Uses:
    """Names of local variables in a chart, and in all that it executes of its POU: all of them, and those it writes."""

    def __init__(self, owner: Pou, functions: ActionFunctions, *, follows: bool = True) -> None:
        self._owner, self._functions, self._follows = owner, functions, follows
        self.names: set[str] = set()
        self.writes: set[str] = set()
        self.problem = ""
        self._followed: set[int] = set()

    def add(self, chart: SfcNetwork) -> None:
        """Add a chart of the POU."""
        for text_site in text_sites_in(chart):
            if isinstance(text_site.holder, NamedCondition):
                name = without_signs(text_site.text).casefold()
                for transition in (each for each in self._owner.transitions if each.name.casefold() == name):
                    for inner in text_sites_in(transition):
                        self._add_text(inner)
            else:
                self._add_text(text_site)
        for _, row in chart.associations():
            if row.target is not None and not self._follow(row.target) and (path := _path(row.target)):
                self.writes.add(path)
        for step in chart.steps:
            for code in step.step_actions.values():
                if isinstance(code, str):
                    self._follow(code)

    def _follow(self, name: str) -> bool:
        """Add the action that a name is. Returns True if it is one."""
        action = self._owner.find_action(without_signs(name))
        if action is None:
            call = f"{name}();"  # the action of an instance
            if not self._follows:
                return "." in name
            if not name.count(".") or not self._functions.calls.inlined(call, self._owner).called:
                return False
            self.add_statements(call)
            return True
        if self._follows and id(action) not in self._followed:
            self._followed.add(id(action))
            if isinstance(action.body, SfcBody):
                found = self._functions.chart(self._owner, action)
                if isinstance(found, str):
                    self.problem = self.problem or f"{action.name}: {found}"
                else:
                    self.add_statements(found.call)
            elif action.body is not None:
                for text_site in text_sites_in(action.body):
                    self._add_text(text_site)
        return True

    def _add_text(self, text_site: TextSite) -> None:
        if text_site.reading is SiteKind.STATEMENTS:
            self.add_statements(text_site.text)
        elif text_site.reading is SiteKind.EXPRESSION:
            self._add_names(text_site.text)
            if isinstance(text_site.holder, Coil | OutputVariable | OutputPin) and (path := _path(text_site.text)):
                self.writes.add(path)

    def add_statements(self, text: str) -> None:
        text = self._functions.calls.inlined(text, self._owner).text if self._follows else text
        self._add_names(text)
        tree = parse_statements(text, Dialect.SCL).tree
        self.writes |= {path[0] for path in self._functions.effects(self._owner, tree).writes if path}

    def _add_names(self, text: str) -> None:
        actions = {action.name.casefold() for action in self._owner.actions}
        for token in tokenize(text, Dialect.SCL).tokens:
            if token.value.startswith("#"):
                name = token.value[1:].strip('"').casefold()
                self.names |= {name} - actions


def _helper(helper: Helper) -> t.Variable:
    """Return the variable for one that a network needs."""
    if helper.type_name == t.Elementary.BOOL.value:
        return t.Variable(name=helper.name, type=t.ElementaryType(name=t.Elementary.BOOL))
    type_ = t.DerivedType(name=helper.type_name or "")
    return t.Variable(name=helper.name, type=type_, attributes={"Version": S7_VERSION})


def _text(body: Body) -> str | None:
    """Return a body as statements; None where it is none."""
    if isinstance(body, FbdBody | LdBody):
        drawn = body_statements(body, Dialect.SCL)
        return None if drawn.obstacles or drawn.helpers or drawn.open_ends else print_node(drawn.tree)
    return body.text if isinstance(body, StBody) else None


def _local_names(tree: n.Node) -> set[str]:
    """Return the variables of the block (lower case) that a text names."""
    return {each.identifier.casefold() for each in walk(tree) if isinstance(each, n.Name) and each.quoting in _LOCAL}


def _declared(pou: Pou) -> Pou:
    """Return a block as its tool declares it: the copy that is written keeps that as markup of another tool."""
    copy = pou.model_copy(update={"bodies": [], "actions": [], "transitions": []}).model_copy(deep=True)
    exchange_markup(copy, Markup.SIMATICML, Markup.TC6)
    return copy


def _passed_inputs(project: Project) -> Iterator[str]:
    """Yield the names, in lower case, of all arguments and connected pins in a project."""
    for text_site in text_sites(project):
        if text_site.is_program_text:
            yield from (match.casefold() for match in _ARGUMENT.findall(text_site.text))
        elif isinstance(text_site.holder, BlockVariable):
            yield text_site.text.strip('"').casefold()


_ARGUMENT = re.compile(r'[(,]\s*"?(\w+)"?\s*:=')


def _path(text: str) -> str:
    """Return the variable that an operand is or is a part of, in lower case."""
    tree = parse_expression(text, Dialect.SCL).tree
    path = path_of(tree) if tree is not None else None
    return path[0].casefold() if path else ""
