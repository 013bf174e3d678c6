"""Edits of what a project declares: variables, actions, named conditions; `plcopen_sfc.refactor.editor` has them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import count
from typing import Any
from uuid import NAMESPACE_URL, uuid5

from plcopen_sfc.errors import ModelError, shown
from plcopen_sfc.languages.binding import Declaration, Kind, Names, bind
from plcopen_sfc.languages.binding.name_resolution import Untyped
from plcopen_sfc.languages.binding.name_uses import Occurrence, dialect_of, unique_declaration
from plcopen_sfc.languages.binding.text_sites import Role, Site, SiteKind, TextSite, text_sites_in
from plcopen_sfc.languages.declarations import write_type
from plcopen_sfc.languages.executed_names import sharing
from plcopen_sfc.languages.networks import condition_reader
from plcopen_sfc.languages.st import bare_condition, parse_condition, parse_statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.layout import layout_edits
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.languages.words import needs_quotes
from plcopen_sfc.model import sfc
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.base import Element, Model
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import models_in
from plcopen_sfc.model.network import Connection, InputPin, OutputPin
from plcopen_sfc.model.pou import Action, NamedTransition, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.variables import SectionKind, VariableSection
from plcopen_sfc.refactor.chart_edits import refused
from plcopen_sfc.refactor.journal import Journal
from plcopen_sfc.refactor.queries import dialect_in, owners, pou_of
from plcopen_sfc.refactor.rename import edit_markup, is_tokens, rename_many
from plcopen_sfc.refactor.surroundings import declarations_in, other_meanings
from plcopen_sfc.report import Use

STEP_ACTIONS = ("entry_action", "main_action", "exit_action")


# -- variables


def replace_variable(journal: Journal, project: Project, old: str, new: str) -> list[str]:
    """Replace every use of a variable by one of another, which must be of the same type and visible there.

    Gives the paths of the changed texts.
    """
    names = Names(project)
    was, will = (names.resolver.original(unique_declaration(names, path)) for path in (old, new))
    what = f"{was.path} cannot be replaced by {will.path}"
    for each in (was, will):
        if each.kind is not Kind.VARIABLE:
            raise refused(what, f"{each} is no variable")
    types = [names.resolver.type_of_declaration(each) for each in (was, will)]
    written = [_written_type(each, names.dialect) for each in (was, will)]
    is_unknown = isinstance(types[0], Untyped)  # blocks of libraries are known by their names only
    if types[0] != types[1] or (is_unknown and written[0].casefold() != written[1].casefold()):
        raise refused(what, f"their types differ: {' and '.join(written)}")
    found = names.uses(was)
    inside = [use.use for use in found if use.reference.declares or use.reference.role in (Role.HEAD, Role.OBJECT)]
    texts: dict[tuple[int, str | int], list[tuple[TextSite, Edit]]] = {}
    problems: list[str] = []
    for use in (each for each in found if each.use not in inside):
        edit = _named_there(names, use, will)
        if edit is None:
            problems.append(f"{use.use} does not see {will.path}")
        else:
            site = use.text_site
            texts.setdefault((id(site.holder), site.key), []).append((site, edit))
    replaced = [use for use in found if use.use not in inside]
    problems = problems or [*_wrong_writes(names, was, will, replaced), *_wrong_places(names, was, will, replaced)]
    if problems:
        raise refused(what, problems)
    changed: list[str] = []
    for edits in texts.values():
        site = edits[0][0]
        changed.append(site.path)
        _edit_text(journal, site, [edit for _, edit in edits])
    return changed


def _wrong_writes(names: Names, was: Declaration, will: Declaration, uses: Iterable[Occurrence]) -> Iterator[str]:
    """Yield the bodies that write a variable, and could not write another in its place.

    No code writes a constant, a POU none of its inputs, and others nothing of a program but these (IEC 61131-3 ed. 3,
    6.6.1.2.2).
    """
    before, after = _section_of(names.project, was), _section_of(names.project, will)
    is_constant = id(will.holder) in names.resolver.constants
    is_input = after is not None and after.kind is SectionKind.INPUT
    was_input = before is not None and before.kind is SectionKind.INPUT
    concerned = {id(use.text_site.site.pou) for use in uses}
    name = was.name.casefold()
    for place, pou, body in names.project.bodies():
        writes = bind(body, names.dialect).effects.writes if id(pou) in concerned else ()
        if not any(name in path[:2] for path in writes):
            continue
        if is_constant:
            yield f"{place} writes it, and {will.path} is a constant"
        elif will.pou is not None and will.pou is not pou and not is_input:
            yield f"{place} writes it, and {will.path} belongs to another program"
        elif will.pou is pou and is_input and not was_input:
            yield f"{place} writes it, and {will.path} is an input"


def _wrong_places(names: Names, was: Declaration, will: Declaration, uses: Iterable[Occurrence]) -> Iterator[str]:
    """Yield the places of a constant in which no variable can be, and those in the declaration of the other one."""
    sites = text_sites_in(will.holder) if isinstance(will.holder, Model) else ()
    own = {(id(each.holder), each.key) for each in sites}
    needed = id(was.holder) in names.resolver.constants and id(will.holder) not in names.resolver.constants
    for use in uses:
        site = use.text_site
        if (id(site.holder), site.key) in own:
            yield f"{use.use} is in the declaration of {will.path}"
        elif needed and (site.language == "declaration" or _is_label(use, names.dialect)):
            yield f"{use.use} needs a constant, and {will.path} is none"


def _is_label(use: Occurrence, dialect: Dialect) -> bool:
    """True if a name is in a label of a CASE."""
    if use.text_site.reading is not SiteKind.STATEMENTS:
        return False
    branches = (each for each in walk(use.text_site.parsed(dialect).tree) if isinstance(each, n.CaseBranch))
    spans = (label.span for branch in branches for label in branch.labels)
    return any(span is not None and span[0] <= use.reference.span[0] < span[1] for span in spans)


def _section_of(project: Project, declaration: Declaration) -> VariableSection | None:
    """Return the section that declares a variable; None for one of another kind, such as a tag."""
    interface = declaration.pou.interface if declaration.pou is not None else None
    sections = interface.sections if interface is not None else project.global_sections()
    return next((each for each in sections if any(v is declaration.holder for v in each.variables)), None)


def _written_type(declaration: Declaration, dialect: Dialect) -> str:
    """Return the type of a variable or a tag as it is declared."""
    kind = getattr(declaration.holder, "type", "")
    return kind if isinstance(kind, str) else write_type(kind, dialect)


def _edit_text(journal: Journal, site: TextSite, edits: list[Edit]) -> None:
    """Edit a text, and its markup with it."""
    markup: str | None = getattr(site.holder, "markup", None)
    if markup is not None:
        # tokens of TIA Portal are made from the text when the file is written
        journal.put(site.holder, "markup", None if is_tokens(markup) else edit_markup(markup, site.text, edits))
    journal.put(site.holder, site.key, apply_edits(site.text, edits))


def lay_out_texts(journal: Journal, project: Project) -> list[str]:
    """Lay out the statements and conditions of a project; give the paths of the texts that change.

    Texts that cannot be read stay, and so do those of a GRAFCET, whose blanks can have a meaning.
    """
    names = Names(project)
    changed: list[str] = []
    for site in names.text_sites():
        if site.is_program_text and not names.is_in_grafcet(site.site):
            is_condition = site.reading is SiteKind.EXPRESSION
            edits = layout_edits(site.text, names.dialect, is_condition=is_condition)
            if edits:
                changed.append(site.report_path)
                _edit_text(journal, site, edits)
    return changed


def _named_there(names: Names, use: Occurrence, declaration: Declaration) -> Edit | None:
    """Return the edit that names another variable in a place; None where no name of it means it there."""
    reference, dialect = use.reference, names.project.dialect
    start = reference.span[0]
    if reference.callee is not None:
        return None  # a parameter belongs to what is called
    if reference.base is not None:
        if not isinstance(reference.base, n.Name) or reference.base.span is None:
            return None
        start = reference.base.span[0]
    for text in (declaration.name, declaration.path):
        bare = parse_condition(text, names.dialect).tree
        alone = replace(reference, name=declaration.name, base=None)
        if isinstance(bare, n.Member):
            owner = names.resolver.type_of(bare.base, use.text_site.site)
            outside = isinstance(owner, Pou) and owner is not use.text_site.site.pou
            if isinstance(owner, Pou) and (
                owner.kind is PouKind.FUNCTION_BLOCK or (outside and family(dialect) is not Dialect.CODESYS)
            ):
                continue  # its instances have the variable; only CODESYS and TwinCAT read one of another program
            meaning = names.resolver.member(owner, declaration.name)
        else:
            meaning = names.resolver.lookup(alone, use.text_site.site)
        if meaning.declaration is not None and names.resolver.original(meaning.declaration) == declaration:
            quoted = dialect is Dialect.SCL and isinstance(bare, n.Name)
            if quoted and reference.quoting:
                return Edit(*reference.span, text)
            return Edit(start, reference.span[1], f'"{text}"' if quoted and needs_quotes(text) else text)
    return None


# -- steps


def check_new_steps(
    names: Names, pou: Pou, steps: Iterable[sfc.Step], texts: Mapping[tuple[int, str | int], str]
) -> None:
    """Raise `ModelError` where new steps of a POU have names that are taken, or that its `texts` name already.

    `texts`, by their object and field, are those from before: what is new may name the steps.
    """
    made = list(steps)
    if any(not step.name for step in made):
        raise ModelError("a step needs a name: it is empty")
    added = {step.name.casefold(): names.declaration_of(step) for step in made}
    for step in added.values():
        problem = names.objection_to(step, step.name)
        if problem:
            raise ModelError(f"{step.name!r} cannot be a name: {problem}")
        beside = [each for each in names.resolver.scopes.pou(pou).named(step.name) if each != step]
        if beside:
            raise ModelError(
                f"{step.name!r} is taken: the {beside[0]} has this name already", hint="Take another name."
            )
    for text_site in text_sites_in(pou) if added else ():
        if texts.get((id(text_site.holder), text_site.key)) != text_site.text:
            continue
        for each in names.occurrences_in(text_site):
            meant = added.get(each.reference.name.casefold())
            if meant is None or not each.refers_to(meant):
                continue
            levels = names.resolver.levels(each.reference, text_site)
            if any(found != meant for level in levels for found in level.named(meant.name)):
                raise ModelError(
                    f"{meant.name!r} would mean the new step in {each.use}, and means something else there",
                    hint="Take another name.",
                )


# -- conditions


def check_free(names: Names, pou: Pou, name: str, condition: sfc.Condition | None = None) -> None:
    """Raise `ModelError` where a POU cannot declare something of this name; `condition` may give it its value."""
    problem = names.objection(name)
    if problem:
        raise ModelError(f"{name!r} cannot be a name: {problem}")
    beside = names.resolver.scopes.pou(pou).named(name)
    if beside:
        raise ModelError(f"{name!r} is taken: the {beside[0]} has this name already")
    if any(condition is None or each.text_site.site.transition is not condition for each in names.occurrences(name)):
        raise ModelError(f"{name!r} is named already, and would mean something else", hint="Take another name.")


def extract_condition(journal: Journal, chart: sfc.SfcNetwork, link: sfc.Transition, name: str) -> NamedTransition:
    """Make the condition of a transition a named transition of the POU, which other conditions can name too.

    One of this name with the same body is used as it is.
    """
    what, pou = f"the condition of {chart.label(link)} cannot be extracted", owners(chart)[1]
    if dialect_in(chart) is Dialect.SCL:
        raise refused(what, "blocks of S7-GRAPH have no named transitions")
    if Names(owners(chart)[0]).is_in_grafcet(Site(pou, charts=(chart,))):
        raise refused(what, "a GRAFCET has no named transitions")
    condition = link.condition
    body: sfc.Body | None = None
    if isinstance(condition, Expression):
        body = StBody(text=condition.text)
    elif isinstance(condition, sfc.BodyCondition):
        body = condition.body
    if condition is None or body is None:
        raise refused(what, "it is named already, drawn in the chart, or there is none")
    known = next((each for each in pou.transitions if each.name.casefold() == name.casefold()), None)
    if known is None or known.body != body:
        check_free(Names(owners(chart)[0]), pou, name, condition)
        known = NamedTransition(name=name, body=body)
        journal.put(pou, "transitions", [*pou.transitions, known])
    named = NamedCondition(name=known.name, negated=condition.negated)
    read = condition_reader(chart, dialect_in(chart), transitions=pou.transitions)
    if read(condition).complete and not read(named).complete:
        own = condition.name if isinstance(condition, sfc.BodyCondition) else ""
        raise refused(what, f"its code gives a value to {own or 'something else'}, not to {name}", f'name="{own}"')
    journal.put(link, "condition", named)
    return known


def inline_condition(journal: Journal, chart: sfc.SfcNetwork, link: sfc.Transition) -> sfc.Condition:
    """Put what a named condition names in its place."""
    what = f"the condition of {chart.label(link)} cannot be inlined"
    condition = link.condition
    if not isinstance(condition, NamedCondition):
        raise refused(what, "it names no transition of the POU")
    found = [t for t in owners(chart)[1].transitions if t.name.casefold() == condition.name.casefold()]
    if not found or found[0].body is None:
        raise refused(what, f"the POU has no transition {condition.name!r} with a body")
    body, made = found[0].body, None
    if isinstance(body, StBody):
        text = _value(body.text, condition.name, dialect_in(chart))
        made = Expression(text=text, negated=condition.negated) if text is not None else None
    put = made or sfc.BodyCondition(body=body.model_copy(deep=True), name=found[0].name, negated=condition.negated)
    journal.put(link, "condition", put)
    return put


def _value(text: str, name: str, dialect: Dialect) -> str | None:
    """Return the expression that the body of a named transition is: alone, or assigned to its name."""
    if not parse_condition(text, dialect).problems:
        return bare_condition(text, dialect)
    parsed = parse_statements(text, dialect)
    match parsed.tree.statements:
        case [n.Assignment(target=n.Name(identifier=target), value=value)] if value.span is not None:
            return text[slice(*value.span)].strip() if target.casefold() == name.casefold() else None
    return None


# -- actions


def extract_action(journal: Journal, step: sfc.Step, name: str, at: str | int) -> Action:
    """Make code in place of a step an action of the POU: of an association by its number, or of a step action."""
    chart = step.chart
    what = f"the action of the step {step.name!r} cannot be extracted"
    if chart is None:
        raise refused(what, "the step is in no chart")
    pou = owners(chart)[1]
    holder, field = _code_of(step, at, what)
    body = getattr(holder, field)
    if body is None or isinstance(body, str):
        raise refused(what, "there is no code in place")
    if isinstance(holder, sfc.ActionAssociation) and holder.target:
        raise refused(what, f"it names {holder.target!r} too")
    check_free(Names(owners(chart)[0]), pou, name)
    action = Action(name=name, body=body)
    journal.put(pou, "actions", [*pou.actions, action])
    journal.put(holder, field, None)
    journal.put(holder, "target" if isinstance(holder, sfc.ActionAssociation) else field, name)
    _refuse_other_order(what, pou, action, owners(chart)[0].dialect)
    return action


def _refuse_other_order(what: str, pou: Pou, action: Action, dialect: Dialect) -> None:
    """Raise `ModelError` where an action has its place among others by its name, which code in place does not have."""
    others = ", ".join(each.name for each in sharing(pou, action, dialect))
    if others:
        why = f"actions are executed in the order of their names, and {others} share variables with it"
        raise refused(what, why, "In place it has no name, and would be executed before them.")


def _code_of(step: sfc.Step, at: str | int, what: str) -> tuple[Any, str]:
    if isinstance(at, str):
        if at not in STEP_ACTIONS:
            raise refused(what, f"{at!r} is none of {', '.join(STEP_ACTIONS)}")
        return step, at
    if not 0 <= at < len(step.actions):
        raise refused(what, f"it has no action number {shown(at)}", "The first is 0.")
    return step.actions[at], "body"


def inline_action(journal: Journal, project: Project, action: Action) -> None:
    """Put the code of an action into the one step that executes it, and remove the action.

    Refused where several associations name it, as they share one action control (IEC 61131-3, 6.7.4.6), where
    other code calls it, or where a tool executes it in the order of names, with others that share variables with it.
    """
    what = f"the action {action.name!r} cannot be inlined"
    pou = pou_of(action)
    if pou is None or action.body is None:
        raise refused(what, "it has no code, or is in no POU")
    if isinstance(action.body, sfc.SfcBody):
        raise refused(what, "it is a chart, which tools execute in actions of a POU alone")
    names = Names(project)
    uses = [use for use in names.uses(names.declaration_of(action)) if use.reference.role is not Role.OBJECT]
    holders = [use.text_site.holder for use in uses]
    others = [str(use.use) for use in uses if not isinstance(use.text_site.holder, sfc.ActionAssociation | sfc.Step)]
    if others:
        raise refused(what, (f"{each} calls it" for each in others))
    if len(holders) != 1:
        raise refused(what, f"{len(holders)} places name it")
    holder, key = holders[0], uses[0].text_site.key
    if uses[0].text_site.site.pou is not pou:
        raise refused(what, f"{uses[0].use} is in another POU, where its names mean something else")
    body = action.body.model_copy(deep=True)
    if isinstance(holder, sfc.ActionAssociation):
        if holder.body is not None:
            raise refused(what, "the association has code in place too")
        if family(project.dialect) is Dialect.CODESYS and not isinstance(body, StBody | IlBody):
            raise refused(what, "code in place of CODESYS is structured text")
        _refuse_other_order(what, pou, action, project.dialect)
        journal.put(holder, "target", None)
        journal.put(holder, "body", body)
    else:
        journal.put(holder, str(key), body)
    remove_declared(journal, project, [names.declaration_of(action)])


def change_association(journal: Journal, association: sfc.ActionAssociation, fields: Mapping[str, Any]) -> None:
    """Give an association another qualifier, duration, target ..; a timed qualifier needs a duration."""
    for name, value in fields.items():
        if name not in type(association).model_fields:
            setattr(association, name, value)  # raises the error for it
        journal.put(association, name, value)
    qualifier = Qualifier(association.qualifier)
    if qualifier.needs_duration and not association.duration and association.kind is None:
        raise refused(f"{association.text!r} cannot be an action", f"{qualifier} needs a duration", 'duration="T#2s"')


# -- what nothing uses


def undeclared(names: Names, words: Iterable[str]) -> list[Use]:
    """Return the places of some names that mean nothing that the project declares, and where that is certain."""
    found = (each for each in names.occurrences(*words) if each.reference.role is not Role.OBJECT)
    return [each.use for each in found if each.meaning.declaration is None and not each.meaning.doubt]


def remove_declared(journal: Journal, project: Project, declared: Iterable[Declaration]) -> None:
    """Take actions, named transitions and variables out of what declares them, and out of the tree of the tool."""
    gone = {*declared}
    if project.tree:
        found = Names(project).occurrences(*(each.name for each in gone))
        nodes = [o.text_site.holder for o in found if o.reference.role is Role.OBJECT and o.meaning.declaration in gone]
        waiting: list[tuple[Any, str]] = [(project, "tree")]
        while nodes and waiting:
            owner, field = waiting.pop()
            children = getattr(owner, field)
            if any(child is node for child in children for node in nodes):
                journal.put(owner, field, [c for c in children if not any(c is node for node in nodes)])
            waiting += [(child, "children") for child in children]
    remove_objects(journal, project, [each.holder for each in gone])


def remove_objects(journal: Journal, project: Project, objects: Iterable[object]) -> None:
    """Take objects out of the lists of POUs and interfaces."""
    gone = {id(each) for each in objects}
    lists: list[tuple[Any, str]] = [(pou, field) for pou in project.pous for field in ("actions", "transitions")]
    interfaces = [pou.interface for pou in project.pous] + [block.interface for block in project.data_blocks]
    lists += [(section, "variables") for each in interfaces if each is not None for section in each.sections]
    for owner, field in lists if gone else ():
        own = getattr(owner, field)
        if any(id(each) in gone for each in own):
            journal.put(owner, field, [each for each in own if id(each) not in gone])


# -- copies


def copy_pou(journal: Journal, project: Project, name: str, target: Project, names: Mapping[str, str]) -> Pou:
    """Put a copy of a POU into another project, with other names for what it and its project declare.

    Everything that it names must be there under its (new) name already, and be declared alike. Gives the copy, with
    identities of its own where the objects of the project have some.
    """
    what = f"{name!r} cannot be copied"
    if dialect_of(project) is not dialect_of(target):
        raise refused(what, "the projects are in different dialects", "Convert the source first.")
    known = [each.tool_format.startswith("grafcet") for each in (project, target) if each.tool_format]
    if len(set(known)) > 1:  # a dot is AND in one of them, and all transitions that can fire do
        raise refused(
            what, "only one of the projects is of GRAFCETs", "Convert the source, and load that with as_tool=True."
        )
    copy = project.model_copy(deep=True)
    source = Names(copy)
    table = {source.resolver.original(unique_declaration(source, path)): new for path, new in names.items()}
    pou = copy.pou(name)
    rename_many(copy, table)  # type: ignore[arg-type]  # declarations are keys too
    if any(each.name.casefold() == pou.name.casefold() for each in target.pous):
        raise refused(what, f"the project has a POU {pou.name!r} already", 'Give it another name: {"Main": "Main2"}.')
    here = Names(copy)
    before = declarations_in(here, pou)
    journal.keep(copy, "pous")
    copy.pous = [each for each in copy.pous if each is not pou]
    pou.place = target.pous[0].place if target.pous else ""
    _give_identities(pou, target)
    journal.put(target, "pous", [*target.pous, pou])
    there = Names(target)
    found = zip(before, declarations_in(there, pou), strict=True)
    pairs = [(was, now) for was, now in found if was is not None and was.pou is not pou and was.holder is not pou]
    missing = [f"the project has no {was}" for was, now in pairs if now is None or now.kind is not was.kind]
    if missing:
        raise refused(what, missing, "Copy what is missing first, or give it the name of what is there.")
    meant = {was: now for was, now in pairs if now is not None}
    others = other_meanings(here, there, pou, meant, table)
    if others:
        hint = 'Make both alike, or give it the name of something that is: {"Speed": "Speed2"}.'
        raise refused(what, others, hint)
    return pou


def _give_identities(pou: Pou, target: Project) -> None:
    """Replace what tools and files know a copied POU by, and take out a number of a block that is there already."""
    for each in models_in(pou):
        if isinstance(each, Element | Connection | InputPin | OutputPin):
            each.global_id = None
    taken = {each.object_id for other in target.pous for each in (other, *other.parts)} - {None}
    for each in (pou, *pou.parts):
        # where objects have none, writers make them of the names; but what had this name once may have that identity
        path = "/".join(("copy", *dict.fromkeys((pou.name, each.name))))
        made = (str(uuid5(NAMESPACE_URL, f"{path}/{number}")) for number in count())
        each.object_id = next(identity for identity in made if identity not in taken) if taken else None
    if any(each.kind is pou.kind and each.number == pou.number for each in target.pous):
        pou.number = None
