"""Moves of a run of steps into an action or a function block of its own, which a step executes, and back."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding import Declaration, Effects, Names, bind
from plcopen_sfc.languages.binding.name_uses import Occurrence, dialect_of
from plcopen_sfc.languages.binding.shared_scans import changed_places, place_of_name, place_of_use
from plcopen_sfc.languages.binding.text_sites import Role
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, print_node
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.late import models_in
from plcopen_sfc.model.pou import Action, NamedTransition, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, SfcBody, SfcNetwork, Step
from plcopen_sfc.model.types import DerivedType, Variable
from plcopen_sfc.model.variables import PASSED, Interface, SectionKind, VariableSection, sections_of
from plcopen_sfc.refactor.chart_edits import refused
from plcopen_sfc.refactor.enclosed_charts import Enclosing, Form, check_associations, disclose, enclose, form_of
from plcopen_sfc.refactor.journal import Journal
from plcopen_sfc.refactor.name_edits import check_free, remove_declared, remove_objects
from plcopen_sfc.refactor.queries import owners
from plcopen_sfc.refactor.runs_of_steps import Run, run_of

_ACTIVE, _AT_END = "Active", "AtEnd"


def move_to_action(journal: Journal, chart: SfcNetwork, steps: Sequence[Step], name: str, action: str) -> Step:
    """Move a run of steps into the chart of a new action, which a new step called `name` executes."""
    what = f"the action {action!r} cannot be made"
    project, pou = owners(chart)
    run, form = _run(chart, steps, name, what)
    names = Names(project)
    check_free(names, pou, action)
    asked = _asked_outside(names, run, {id(model) for part in _parts_of(run, form) for model in models_in(part)})
    if asked:
        raise refused(what, asked, "Move the steps into a macro-step, whose steps other texts see.")
    _check_order(chart, run.steps, action, form, what)
    taken = _names_of(names, pou) | {action.casefold(), name.casefold()}
    step, inner = enclose(journal, chart, run, _of_action(name, form), taken)
    journal.put(pou, "actions", [*pou.actions, Action(name=action, body=SfcBody(chart=inner))])
    step.actions = [ActionAssociation(id=chart.new_id(), target=action)]
    return step


def _run(chart: SfcNetwork, steps: Sequence[Step], name: str, what: str) -> tuple[Run, Form]:
    project, pou = owners(chart)
    form = form_of(project, chart, steps, what)
    run = run_of(chart, steps, name, what, left_anywhere=form is Form.ENDING)
    check_associations(project, pou, run, what)
    return run, form


def _check_order(chart: SfcNetwork, steps: Sequence[Step], action: str, form: Form, what: str) -> None:
    """Raise `ModelError` where an action that executes what steps do changes places with actions of other steps."""
    project, pou = owners(chart)
    by_name, inside = form is Form.ENDING, {step.id for step in steps}
    begin = next(number for number, step in enumerate(chart.steps) if step.id in inside)
    place = place_of_name(action) if by_name else place_of_use(sum(len(step.actions) for step in chart.steps[:begin]))
    reasons = changed_places(
        chart, pou, dialect_of(project), lambda row: place if row[0].id in inside else None, by_name=by_name
    )
    if reasons:
        raise refused(what, reasons, "Another name may have its place." if by_name else "")


def _of_action(step: str, form: Form) -> Enclosing:
    return Enclosing(step, f"{step}.{form.flag}", f"{{}}.{form.asked}", form)


def _names_of(names: Names, pou: Pou) -> set[str]:
    """Return the names that a POU declares, and those that its texts name, in small letters."""
    declared = {each.name.casefold() for each in names.resolver.scopes.pou(pou)}
    return declared | {each.reference.name.casefold() for each in names.everything if each.text_site.site.pou is pou}


# -- function blocks


def move_to_block(journal: Journal, chart: SfcNetwork, steps: Sequence[Step], name: str, block: str) -> Step:
    """Move a run of steps into the chart of a new function block, an instance of which a new step executes.

    What only the run uses moves with it. Other variables of the POU are passed: those that it writes, and instances, as
    VAR_IN_OUT, those that it reads as VAR_INPUT.
    """
    what = f"the function block {block!r} cannot be made"
    project, pou = owners(chart)
    run, form = _run(chart, steps, name, what)
    names = Names(project)
    problem = names.objection(block)
    known = [f"the {each} has this name already" for each in names.find(block)]
    if problem or known:
        raise refused(what, problem or known)
    needs = _Needs.of(names, pou, run, form, what)
    unknown = {each.reference.name.casefold() for each in names.undeclared(pou)}
    taken = _names_of(names, pou) | {name.casefold()}
    instance, action = (take_name(f"{name}_{each}", taken) for each in ("chart", "run"))
    _check_order(chart, run.steps, action, form, what)
    active, at_end = (take_name(each, taken) for each in (_ACTIVE, _AT_END))
    flag = f"{instance}.{at_end}" if form is Form.RESTING else f"{instance}.{{}}.{form.asked}"
    step, inner = enclose(journal, chart, run, Enclosing(name, active, flag, form), taken)
    if form is Form.RESTING and run.last is not None:
        journal.put(run.last, "actions", [*run.last.actions, ActionAssociation(id=inner.new_id(), target=at_end)])

    _take_from(journal, pou, needs.moved)
    made = Pou(
        name=block, kind=PouKind.FUNCTION_BLOCK, bodies=[SfcBody(chart=inner)], place=pou.place, folder=pou.folder
    )
    made.actions = [each for each in needs.moved if isinstance(each, Action)]
    made.transitions = [each for each in needs.moved if isinstance(each, NamedTransition)]
    passed = _interface(made, names, needs, active, at_end if form is Form.RESTING else "")
    remove_objects(journal, project, needs.own)
    index = next(index for index, each in enumerate(project.pous) if each is pou)
    journal.put(project, "pous", [*project.pous[:index], made, *project.pous[index:]])  # declared before it is used
    journal.keep_declarations(pou)
    pou.add_variable(instance, block)
    arguments = ", ".join([f"{active} := {name}.{form.flag}", *(f"{each} := {each}" for each in passed)])
    pou.actions.append(Action(name=action, body=StBody(text=f"{instance}({arguments});")))
    step.actions = [ActionAssociation(id=chart.new_id(), target=action)]
    dangling = [
        f"{each.use} would name nothing"
        for after in [Names(project)]
        for owner in (pou, made)
        for each in after.undeclared(owner)
        if each.reference.name.casefold() not in unknown
    ]
    if dangling:
        raise refused(what, dangling)
    return step


@dataclass
class _Needs:
    """What a run uses of its POU: variables that only it uses (`own`), others, and actions and conditions to move."""

    own: list[Variable] = field(default_factory=list)
    others: list[Variable] = field(default_factory=list)
    moved: list[Action | NamedTransition] = field(default_factory=list)

    def has(self, thing: Action | NamedTransition) -> bool:
        return any(each is thing for each in self.moved)

    @classmethod
    def of(cls, names: Names, pou: Pou, run: Run, form: Form, what: str) -> _Needs:
        """Raises `ModelError` where the run names what a block cannot have, or others name what would move."""
        inside = {id(model) for part in _parts_of(run, form) for model in models_in(part)}
        texts = [each for each in names.everything if each.text_site.site.pou is pou and not each.reference.declares]
        found = cls()
        reasons: list[str] = []
        used: dict[Declaration, Occurrence] = {}
        waiting = True
        while waiting:
            waiting = False
            for each in texts:
                meant = each.meaning.declaration
                declared = names.resolver.original(meant) if meant is not None else None
                if id(each.text_site.holder) in inside and declared is not None and declared.pou is pou:
                    used.setdefault(declared, each)
                    thing = declared.holder
                    if isinstance(thing, Action | NamedTransition) and not found.has(thing):
                        found.moved.append(thing)
                        inside |= {id(model) for model in models_in(thing)}
                        waiting = True
        moving = {id(step) for step in run.steps} | {id(each) for each in found.moved}
        for declared, each in used.items():
            outside = [use for use in names.uses(declared) if id(use.text_site.holder) not in inside]
            outside = [use for use in outside if not use.reference.declares and use.reference.role is not Role.OBJECT]
            if id(declared.holder) in moving:
                reasons += [f"the {declared} would move, and {use.use} names it" for use in outside]
            elif not isinstance(declared.holder, Variable):
                reasons.append(f"{each.use} names the {declared}, which a block does not have")
        # a variable of the POU counts in the order of its declaration
        variables = {id(each.holder): each for each in used if isinstance(each.holder, Variable)}
        for section in sections_of(pou.interface):
            for variable in section.variables:
                declared_one = variables.get(id(variable))
                if declared_one is None:
                    continue
                uses = [use for use in names.uses(declared_one) if not use.reference.declares]
                alone = all(id(use.text_site.holder) in inside for use in uses)
                moves = alone and section.kind in (SectionKind.LOCAL, SectionKind.TEMP) and not variable.address
                (found.own if moves else found.others).append(variable)
        reasons += _asked_outside(names, run, inside)
        if reasons:
            raise refused(what, reasons)
        return found


def _parts_of(run: Run, form: Form) -> list[Any]:
    """Return the steps, transitions and conditions that go into the new chart."""
    leaving = [each.condition for each in run.leaving if form is Form.ENDING and each.condition is not None]
    return [*run.steps, *run.inner, *leaving]


def _asked_outside(names: Names, run: Run, inside: Collection[int]) -> list[str]:
    """Return the uses of moved steps in other texts than those `inside`: they would see no step of that name."""
    return [
        f"{use.use} asks for the step {step.name}"
        for step in run.steps
        for use in names.uses(names.declaration_of(step))
        if id(use.text_site.holder) not in inside and use.reference.role is not Role.OBJECT
    ]


def _interface(block: Pou, names: Names, needs: _Needs, active: str, at_end: str) -> list[str]:
    """Give a block the interface that its texts need, and return the names of the variables that are passed."""
    effects = Effects.all(bind(body, names.dialect).effects for _, _, body in block.named_bodies())
    changed = {path[0].casefold() for path in (*effects.writes, *effects.calls) if path}
    boolean: Any = "BOOL"
    inputs, shared = [Variable(name=active, type=boolean)], list[Variable]()
    own = [(variable.owner, variable) for variable in needs.own]
    for variable in needs.others:
        if isinstance(variable.owner, VariableSection) and variable.owner.kind is SectionKind.EXTERNAL:
            own.append((variable.owner, variable))
            continue
        copy = variable.model_copy(deep=True, update={"address": None, "initial": None})
        (shared if variable.name.casefold() in changed else inputs).append(copy)
    passed = {
        SectionKind.INPUT: inputs,
        SectionKind.OUTPUT: [Variable(name=at_end, type=boolean)] if at_end else [],
        SectionKind.IN_OUT: shared,
    }
    sections = [VariableSection(kind=kind, variables=variables) for kind, variables in passed.items() if variables]
    for _, found in grouped((id(section), (section, variable)) for section, variable in own).items():
        section = found[0][0]
        assert isinstance(section, VariableSection)  # noqa: S101  # what a POU declares is in one
        sections.append(section.with_variables([variable.model_copy(deep=True) for _, variable in found]))
    block.interface = Interface(sections=sections)
    return [each.name for each in (*inputs[1:], *shared)]


# -- and back


def dissolve_chart(journal: Journal, chart: SfcNetwork, step: Step) -> list[Step]:
    """Put the steps of the chart that a step executes, in an action or a function block, into the place of the step."""
    what = f"the chart of {step.name!r} cannot be put in its place"
    project, pou = owners(chart)
    names = Names(project)
    form = form_of(project, chart, [step], what)
    action = pou.find_action(step.actions[0].target or "") if len(step.actions) == 1 else None
    alone = Step(id=step.id, name=step.name, initial=step.initial, actions=step.actions)
    if action is None or step.actions[0] != ActionAssociation(id=step.actions[0].id, target=action.name):
        raise refused(what, "it executes no action of the POU with N, or others too")
    if alone.model_copy(update=dict.fromkeys(_FOR_PEOPLE)) != step.model_copy(update=dict.fromkeys(_FOR_PEOPLE)):
        raise refused(what, "it has step actions, times or conditions of its own")
    declared = names.declaration_of(action)
    _refuse_other_uses(names, declared, step.actions[0], what)
    if isinstance(action.body, SfcBody):
        steps = disclose(journal, chart, step, action.body.chart, _of_action(step.name, form))
        remove_declared(journal, project, [declared])
        _check_order(chart, steps, action.name, form, what)
        return steps
    instance, block = _called(pou, project, action, what)
    inner = block.chart
    if inner is None or len(block.bodies) > 1 or block.methods:
        raise refused(what, f"{block.name} is no chart alone: it has other bodies or methods, or none")
    type_uses = [use for use in names.uses(names.declaration_of(block)) if use.reference.role is not Role.OBJECT]
    if len(type_uses) != 1:
        raise refused(what, f"{block.name} is used in {len(type_uses)} places", "Copy it for this step.")
    active = _passed(block, action, step, form, what)
    ends = [each.name for each in block.variables(SectionKind.OUTPUT)]
    at_end = ends[0] if form is Form.RESTING and len(ends) == 1 else ""
    moved = [each for each in block.variables() if each.name not in (active, at_end) and _is_own(block, pou, each)]
    level = names.resolver.scopes.pou(pou)
    things: list[Variable | Action | NamedTransition] = [*moved, *block.actions, *block.transitions]
    clashes = [each.name for each in things if level.named(each.name)]
    if clashes:
        raise refused(what, f"{pou.name} has a {clashes[0]!r} already")
    gone = [(each, row) for each, row in inner.associations() if at_end and row.target == at_end]
    for each, row in gone:
        journal.put(each, "actions", [other for other in each.actions if other is not row])
    flag = f"{instance.name}.{at_end}" if form is Form.RESTING else f"{instance.name}.{{}}.{form.asked}"
    steps = disclose(journal, chart, step, inner, Enclosing(step.name, active, flag, form))
    remove_declared(journal, project, [declared, names.declaration_of(instance), names.declaration_of(block)])
    journal.put(project, "pous", [each for each in project.pous if each is not block])
    _take_over(journal, pou, block, moved)
    _check_order(chart, steps, action.name, form, what)
    return steps


_FOR_PEOPLE = ("comment", "title", "number", "global_id", "extension_data")


def _refuse_other_uses(names: Names, declared: Declaration, holder: ActionAssociation, what: str) -> None:
    uses = [each for each in names.uses(declared) if each.reference.role is not Role.OBJECT]
    others = [f"{each.use} names the {declared} too" for each in uses if each.text_site.holder is not holder]
    if others:
        raise refused(what, others)


def _call(action: Action) -> n.Call | None:
    """Return the call that an action consists of."""
    body = action.body
    statements = parse_statements(body.text).tree.statements if isinstance(body, StBody) else ()
    match statements:
        case [n.CallStatement(call=n.Call(callee=n.Name()) as call)]:
            return call
    return None


def _called(pou: Pou, project: Project, action: Action, what: str) -> tuple[Variable, Pou]:
    """Return the variable whose block an action calls, and that block. Raises `ModelError`."""
    call = _call(action)
    name = call.called.casefold() if call is not None else ""
    for variable in pou.variables():
        if variable.name.casefold() == name and isinstance(variable.type, DerivedType):
            wanted = variable.type.name.casefold()
            found = next((each for each in project.pous if each.name.casefold() == wanted), None)
            if found is not None and found.kind is PouKind.FUNCTION_BLOCK:
                return variable, found
    raise refused(what, f"{action.name} is no chart, and calls no block of the project alone")


def _passed(block: Pou, action: Action, step: Step, form: Form, what: str) -> str:
    """Return the input that tells the block that its step is active; all others must be passed under their names."""
    call = _call(action)
    active = ""
    others = []
    for each in call.arguments if call is not None else ():
        name = each.name.identifier if each.name is not None else ""
        if isinstance(each.value, n.Name) and each.value.identifier.casefold() == name.casefold() and not each.output:
            continue
        text = print_node(each.value) if each.value is not None else ""
        if text.casefold() == f"{step.name}.{form.flag}".casefold() and not active:
            active = name
        else:
            others.append(f"{name or text} of {block.name} gets something else than what is called so")
    if others or not active:
        raise refused(what, others or f"{block.name} does not know if the step is active")
    return active


def _is_own(block: Pou, pou: Pou, variable: Variable) -> bool:
    """True if a variable belongs to a block itself: one that is passed is there already."""
    passed = any(variable is each for kind in PASSED for each in block.variables(kind))
    is_there = any(each.name.casefold() == variable.name.casefold() for each in pou.variables(SectionKind.EXTERNAL))
    return not passed and not is_there


def _take_over(journal: Journal, pou: Pou, block: Pou, moved: Sequence[Variable]) -> None:
    """Declare in a POU what a block has declared for itself."""
    journal.keep_declarations(pou)
    if pou.interface is None:
        pou.interface = Interface()
    for section in sections_of(block.interface):
        own = [each.model_copy(deep=True) for each in section.variables if any(each is other for other in moved)]
        if own:
            pou.interface.section_like(section).variables.extend(own)
    actions, transitions = list(block.actions), list(block.transitions)
    _take_from(journal, block, [*actions, *transitions])
    pou.actions.extend(actions)
    pou.transitions.extend(transitions)


def _take_from(journal: Journal, pou: Pou, parts: Sequence[Action | NamedTransition]) -> None:
    """Take actions and conditions out of a POU. Tools know them by an identity, which they have in that POU alone."""
    gone = {id(each) for each in parts}
    journal.put(pou, "actions", [each for each in pou.actions if id(each) not in gone])
    journal.put(pou, "transitions", [each for each in pou.transitions if id(each) not in gone])
    for each in parts:
        journal.put(each, "object_id", None)
