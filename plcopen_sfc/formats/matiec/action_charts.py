"""Charts in actions as function blocks: matiec has charts in POUs alone.

The block has the variables that the chart uses as parameters, and the POU one instance of it, which the action calls.
So the chart goes on from where it was when it was last executed, as in CODESYS. Flags of its steps that others ask for
are outputs of the block, which the steps drive.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from plcopen_sfc.languages.binding import ANYTHING, Effects, Path, bind, called_actions, is_named_elsewhere
from plcopen_sfc.languages.binding.text_sites import text_sites_in
from plcopen_sfc.languages.effects import effects
from plcopen_sfc.languages.method_calls import passed_in_out
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import NamedCondition
from plcopen_sfc.model.pou import Action, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcBody, SfcNetwork, Step
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.report import CHART_OF_ACTION, ConversionReport, Outcome

_LATER = (
    "charts in actions show a new step one call later in CODESYS: where such an action ends just then, the step acts "
    "before it ends here, and when it begins again in CODESYS"
)


def make_blocks(project: Project, report: ConversionReport, *, of_codesys: bool) -> None:
    """Let actions of `project`, a copy, call function blocks in place of their charts; others stay as they are."""
    taken = {thing.name.casefold() for thing in project.objects()}
    for pou in list(project.pous):
        made = 0
        for action in [each for each in pou.actions if isinstance(each.body, SfcBody)]:
            place = f"{pou.report_path} / action {action.name}"
            found = _ActionChart(project, pou, action).block(taken)
            if isinstance(found, str):
                report.add(Outcome.NOT_EXECUTED, "chart", place, f"no function block can have its chart: {found}")
                continue
            made += 1
            report.add(
                Outcome.TRANSLATED, "body", place, f"it calls the function block {found.name}, which has its chart"
            )
        if made and of_codesys:
            report.add(Outcome.APPROXIMATED, CHART_OF_ACTION, pou.report_path, _LATER)


class _ActionChart:
    """The chart of an action of a POU, with the actions and named transitions that it alone executes."""

    def __init__(self, project: Project, pou: Pou, action: Action) -> None:
        self._project, self._pou, self._action = project, pou, action
        assert isinstance(action.body, SfcBody)  # noqa: S101  # the caller has looked
        self._chart = action.body.chart
        self._dialect = project.dialect
        self._names = {each.name.casefold() for each in self._chart.steps}
        self._actions = self._executed()
        conditions = [each.condition for each in self._chart.transitions]
        named = {each.name.casefold() for each in conditions if isinstance(each, NamedCondition)}
        self._transitions = [each.model_copy(deep=True) for each in pou.transitions if each.name.casefold() in named]
        inside = [action.body, *(each.body for each in self._actions), *(each.body for each in self._transitions)]
        own = [action, *self._actions]
        outside = [*pou.bodies, *(each.body for each in pou.actions if not any(each is other for other in own))]
        outside += [each.body for each in pou.transitions]
        self._inside, self._outside = _bodies(inside), _bodies(outside)
        self._called = self._blocks()
        self._flags: dict[str, Step] = {}
        self._arguments: dict[str, str] = {}
        self._moved: list[Variable] = []
        self._effects = Effects.all(map(self._effects_of, self._inside))
        self._around = Effects.all(map(self._effects_of, self._outside))
        self._known_around = _names(self._around)
        if is_named_elsewhere(pou, project):
            self._known_around |= {variable.name.casefold() for variable in pou.variables()}

    def block(self, taken: set[str]) -> Pou | str:
        """Give the chart to a new function block, which the action calls; a reason where there is none."""
        if why := self._refusal():
            return why
        sections = self._sections()
        if isinstance(sections, str):
            return sections
        pou = self._pou
        block = Pou(
            name=take_name(f"{pou.name}_{self._action.name}", taken),
            kind=PouKind.FUNCTION_BLOCK,
            interface=Interface(sections=[*sections.values()]),
            bodies=[self._inside[0]],
            actions=self._actions,
            transitions=self._transitions,
        )
        used = {each.name.casefold() for each in pou.variables()} | {each.name.casefold() for each in pou.actions}
        used |= {each.name.casefold() for each in pou.transitions}
        used |= {step.name.casefold() for chart in _charts(self._outside) for step in chart.steps}
        instance = take_name(f"{self._action.name}_chart", used)
        self._lead_out(instance, sections[SectionKind.OUTPUT], used | {v.name.casefold() for v in block.variables()})
        block.interface = Interface(sections=[section for section in sections.values() if section.variables])
        passed = ", ".join(f"{name} := {value}" for name, value in self._arguments.items())
        self._action.body = StBody(text=f"{instance}({passed});")
        for section in sections_of(pou.interface):
            section.variables = [each for each in section.variables if not any(each is other for other in self._moved)]
        pou.actions = [each for each in pou.actions if not any(each is other for other in self._actions)]
        local = VariableSection(
            kind=SectionKind.LOCAL, variables=[Variable(name=instance, type=DerivedType(name=block.name))]
        )
        pou.interface = pou.interface or Interface()
        pou.interface.sections = [*pou.interface.sections, local]
        self._project.pous = [*self._project.pous, block]
        return block

    def _executed(self) -> list[Action]:
        """Return the actions of the POU that the chart executes, and those that these call."""
        found: list[Action] = []
        waiting: list[Body | None] = [self._action.body]
        while waiting:
            called = called_actions(waiting.pop(), self._pou, self._dialect)
            new = [each for each in self._pou.actions if each.name.casefold() in called and each not in found]
            found += new
            waiting += [each.body for each in new]
        return found

    def _blocks(self) -> dict[Path, Pou]:
        """Return what of the project texts of the POU can call: functions, and instances of function blocks."""
        pous = {each.name.casefold(): each for each in self._project.pous}
        found: dict[Path, Pou] = {(name,): each for name, each in pous.items() if each.kind is PouKind.FUNCTION}
        for variable in self._pou.variables():
            block = pous.get(variable.type.name.casefold()) if isinstance(variable.type, DerivedType) else None
            if block is not None:
                found[variable.name.casefold(),] = block
        return found

    def _effects_of(self, body: Body) -> Effects:
        """Return what a body reads, writes and calls; blocks of the project write what they are passed, and globals."""
        bound = bind(body, self._dialect)
        instances = (
            (each.name.casefold(),) for each in self._pou.variables() if self._instance_members(each) is not None
        )
        found = [effects(bound.trees, self._called.keys() | {*instances})]
        found += [
            Effects(writes=frozenset((name,) for name in passed_in_out(tree, self._called))) for tree in bound.trees
        ]
        for chart in bound.charts:
            found += [chart.acting, *map(self._effects_of, chart.bodies)]
        return Effects.all(found)

    def _refusal(self) -> str:
        if any(bind(body, self._dialect).unknown for body in self._inside) or ANYTHING in self._effects.writes:
            return "not all that it executes can be read"
        if any(bind(body, self._dialect).unknown for body in self._outside):
            return "not all of the block around it can be read"
        if any(isinstance(each.body, SfcBody) for each in self._actions):
            return "it executes the chart of an action"
        shared = {each.name.casefold() for each in self._actions} & _names(self._around)
        if shared:
            return f"the action {min(shared)} is executed by others, too"
        variables = {each.name.casefold() for each in self._pou.variables()}
        inside = _names(self._effects) - self._names - variables
        steps = {step.name.casefold() for chart in _charts(self._outside) for step in chart.steps}
        methods = {each.name.casefold() for each in self._pou.methods}
        if asked := inside & (steps | methods):
            return f"it names {min(asked)} of the block around it"
        outside = _names(self._around) & self._names - steps - variables
        plain = self._names - {each.name.casefold() for each in self._chart.initial_steps}
        paths = [[*map(str.casefold, path)] for path in self._around.reads | self._around.writes | self._around.calls]
        for name, *member in (path for path in paths if path and path[0] in outside):
            if member != ["x"] or name not in plain:  # an initial step is active before the first call
                return f"more than the flag of its step {name} is asked for outside of it"
        self._flags = {each.name: each for each in self._chart.steps if each.name.casefold() in outside}
        return ""

    def _lead_out(self, instance: str, section: VariableSection, taken: set[str]) -> None:
        """Let steps whose flags others ask for drive outputs of the block, and the others ask these."""
        outputs: dict[str, str] = {}
        for name, step in self._flags.items():
            output = outputs[name.casefold()] = take_name(f"{name}_X", taken)
            section.variables.append(Variable(name=output, type=ElementaryType(name=Elementary.BOOL)))
            step.actions.append(ActionAssociation(id=self._chart.new_id(), target=output))

        flags = {(step, "x"): n.Member(n.Name(instance), n.Name(output)) for step, output in outputs.items()}
        self._replace(self._outside, flags)

    def _replace(self, bodies: Iterable[Body], members: Mapping[tuple[str, str], n.Expression]) -> None:
        """Put other terms in the place of members in the texts of bodies."""

        def other(node: n.Node) -> n.Node:
            if isinstance(node, n.Member) and isinstance(node.base, n.Name):
                return members.get((node.base.identifier.casefold(), node.name.identifier.casefold()), node)
            return node

        sites = (site for body in bodies for site in text_sites_in(body) if site.is_program_text)
        for text_site in sites if members else ():
            text_site.put(text_site.rewritten(self._dialect, other))

    def _sections(self) -> dict[SectionKind, VariableSection] | str:
        """Return the interface of the block: the variables of the POU that the chart uses."""
        made = {kind: VariableSection(kind=kind) for kind in _KINDS}
        constants = VariableSection(kind=SectionKind.LOCAL, constant=True)
        used = _names(self._effects) - self._names
        written = {path[0].casefold() for path in self._effects.writes if path}
        taken = used | {each.name.casefold() for each in self._pou.variables()} | self._names
        inputs: dict[tuple[str, str], n.Expression] = {}
        for section in sections_of(self._pou.interface):
            for variable in (each for each in section.variables if each.name.casefold() in used):
                name, copy = variable.name.casefold(), variable.model_copy(deep=True)
                if section.constant:
                    constants.variables.append(copy)
                elif section.kind is SectionKind.EXTERNAL:
                    made[SectionKind.EXTERNAL].variables.append(copy)
                elif (members := self._instance_members(variable)) is not None:
                    asked = self._asked(name)
                    if section.kind is SectionKind.LOCAL and name not in self._known_around:
                        made[SectionKind.LOCAL].variables.append(copy)
                        self._moved.append(variable)
                    elif asked is not None and asked <= members.keys():  # matiec has no instances as in-out parameters
                        for member in sorted(asked):
                            input_ = take_name(f"{variable.name}_{members[member].name}", taken)
                            made[SectionKind.INPUT].variables.append(Variable(name=input_, type=members[member].type))
                            self._arguments[input_] = f"{variable.name}.{members[member].name}"
                            inputs[name, member] = n.Name(input_)
                    else:
                        return f"the instance {variable.name} is called in it, and used by others, too"
                elif section.kind is SectionKind.TEMP:
                    return f"{variable.name} is temporary"
                elif name in written and (section.kind is SectionKind.INPUT or variable.address is not None):
                    what = "an input" if variable.address is None else "at an address"
                    return f"it writes {variable.name}, which is {what}"
                else:
                    copy.initial = copy.address = None
                    made[SectionKind.IN_OUT if name in written else SectionKind.INPUT].variables.append(copy)
                    self._arguments[copy.name] = copy.name
        made[SectionKind.CONSTANT] = constants
        self._replace(self._inside, inputs)
        return made

    def _asked(self, name: str) -> set[str] | None:
        """Return the members that the chart reads of an instance; None where it does more."""
        paths = self._effects.reads | self._effects.writes | self._effects.calls
        found = [[*map(str.casefold, path)] for path in paths if path and path[0].casefold() == name]
        is_changed = any(path and path[0].casefold() == name for path in self._effects.writes | self._effects.calls)
        return {path[1] for path in found} if not is_changed and all(len(path) == 2 for path in found) else None

    def _instance_members(self, variable: Variable) -> dict[str, Variable] | None:
        """Return the parameters of the block of an instance by their names in lower case; None: it is no instance."""
        name = variable.type.name.casefold() if isinstance(variable.type, DerivedType) else ""
        block = standard_block(name) if name else None
        if block is not None and block.stateful:
            pins = (
                Variable.model_validate({"name": pin.name, "type": pin.type}) for pin in (*block.inputs, *block.outputs)
            )
            return {each.name.casefold(): each for each in pins}
        own = next((each for each in self._project.pous if each.name.casefold() == name), None)
        return {each.name.casefold(): each for each in own.variables()} if own is not None else None


_KINDS = (SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.EXTERNAL, SectionKind.LOCAL)


def _bodies(found: Iterable[Body | None]) -> list[Body]:
    return [body for body in found if body is not None]


def _charts(bodies: Iterable[Body]) -> list[SfcNetwork]:
    return [body.chart for body in bodies if isinstance(body, SfcBody)]


def _names(found: Effects) -> set[str]:
    """Return the names at the beginnings of all that is read, written and called, in lower case."""
    return {path[0].casefold() for path in found.reads | found.writes | found.calls if path}
