"""Charts of CoDeSys 2.3 in simple steps and in IEC steps (manual of CoDeSys V2.3, "Simplified steps", "IEC steps").

A simple step has one action, which may be code in place, and a flag called like the step. An IEC step has associations,
which execute an action once more when their step was left, and members (``Wait.x``). Both may have an entry and an exit
action. The initial step takes no association (textbook on CoDeSys 2.3), so it stays simple where it has an action.
Which kind a chart has decides the notation, so charts are switched as a whole. The last execution matters where an
action counts or adds, say: code that asks for the step first does nothing then.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import combinations
from textwrap import dedent, indent

from plcopen_sfc.languages.binding.name_uses import Names, Occurrence, by_text, dialect_of
from plcopen_sfc.languages.binding.shared_scans import (
    Place,
    Row,
    SharedScans,
    changed_places,
    place_of_name,
    place_of_step,
)
from plcopen_sfc.languages.binding.text_sites import SiteKind
from plcopen_sfc.languages.il import statements
from plcopen_sfc.languages.networks import shown_body
from plcopen_sfc.languages.st import parse_statements, print_node
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.words import free_name
from plcopen_sfc.model.actions import SWITCHES, Qualifier
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.declaration import Kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step, simple_steps
from plcopen_sfc.operations import provided
from plcopen_sfc.refactor.chart_edits import refused
from plcopen_sfc.refactor.journal import Journal
from plcopen_sfc.refactor.name_edits import extract_action
from plcopen_sfc.refactor.queries import owners
from plcopen_sfc.refactor.rename import edit_markup

_TIME = re.compile(r"\s*\.\s*(?!x\b)\w+", re.IGNORECASE)
_MOST_ASSOCIATIONS = 9
"""So many CoDeSys 2.3 takes at a step."""


def use_iec_steps(journal: Journal, chart: SfcNetwork, *, guarded: bool = False) -> list[str]:
    """Make the action of each step an association with N; return the paths of texts with another notation now.

    The initial step keeps its action, and is a simple step then: CoDeSys 2.3 takes no association at it.
    `guarded`: the code asks if the step is active, so that it is not executed once more.
    """
    what = "the steps cannot become IEC steps"
    project, pou = owners(chart)
    _check_tool(project, what)
    with_action = [step for step in chart.steps if step.main_action is not None]
    becoming = [step for step in with_action if not step.initial]
    reasons = [
        f"{step.name} has {_MOST_ASSOCIATIONS} associations: CoDeSys 2.3 takes no more"
        for step in becoming
        if len(step.actions) >= _MOST_ASSOCIATIONS
    ]
    if not becoming:
        reasons.append(_nothing_to_do(chart, with_action))

    def by_name(row: Row) -> Place | None:
        step, association = row
        is_main = any(step is each for each in becoming) and all(each is not association for each in step.actions)
        is_code = guarded or not isinstance(step.main_action, str)
        return place_of_name(f"{step.name}_active" if is_code else f"{step.main_action}") if is_main else None

    reasons += changed_places(chart, pou, dialect_of(project), by_name)
    if not guarded:
        own = [(step, step.main_action) for step in becoming if isinstance(step.main_action, str)]
        reasons += _executed_once(chart, pou, dialect_of(project), own)
    if reasons:
        raise refused(what, reasons)
    switched = [step for step in simple_steps(chart.steps) if step.main_action is None or not step.initial]
    changed = write_notation(project, switched, journal, members=True)
    for step in becoming:
        action = step.main_action
        if guarded:
            journal.put(step, "main_action", StBody(text=_guarded(step, dialect_of(project))))
        if guarded or not isinstance(action, str):
            action = extract_action(journal, step, _free_name(pou, f"{step.name}_active"), "main_action").name
        journal.put(step, "main_action", None)
        association = ActionAssociation(id=chart.new_id(), qualifier=Qualifier.N, target=action)
        journal.put(step, "actions", [association, *step.actions])
    return changed


def _nothing_to_do(chart: SfcNetwork, with_action: list[Step]) -> str:
    """Return why no step of a chart becomes an IEC step."""
    if with_action:
        return f"only {with_action[0].name} has an action, and the initial step takes no association"
    return "they are IEC steps already" if any(step.actions for step in chart.steps) else "no step has an action"


def _executed_once(chart: SfcNetwork, pou: Pou, dialect: Dialect, called: list[tuple[Step, str]]) -> list[str]:
    """Return which steps are active together and execute one action: IEC steps once in a scan, simple ones each."""
    scans = SharedScans(chart, pou, dialect)
    return [
        f"{one.name} and {other.name} execute {name}, IEC steps once in a scan and simple steps each"
        for (one, name), (other, again) in combinations(called, 2)
        if name.casefold() == again.casefold() and scans.are_together(one, other)
    ]


def _check_tool(project: Project, what: str) -> None:
    """Raise `ModelError` where the tool of a project has no steps with a main and an exit action."""
    profile = provided("default_profile")(project)
    if profile.order != "actions_first":
        raise refused(what, f"{profile.name} has no simple steps: they are of CoDeSys 2.3 and CODESYS")


def _guarded(step: Step, dialect: Dialect) -> str:
    """Return the action of a step as statements that do nothing while the step is not active."""
    match step.main_action:
        case str() as called:
            text: str | None = f"{called}();"
        case StBody(text=text):
            pass
        case IlBody(text=listed):
            tree = statements(listed, dialect, among_others=True)
            text = print_node(tree) if tree is not None else None
        case FbdBody() | LdBody() as drawn:
            text = shown_body(drawn, dialect)
        case _:
            text = None
    if text is None:
        raise refused("the steps cannot become IEC steps", [f"no statements do what the action of {step.name} does"])
    return f"IF {step.name}.x THEN\n{indent(text.rstrip(), '    ')}\nEND_IF;"


def use_simple_steps(journal: Journal, chart: SfcNetwork) -> list[str]:
    """Make the associations of each step its main action; return the paths of texts with another notation now.

    A variable with N is set in the main action, and reset in the exit action. Refused where an association stores,
    delays or pulses, and where a text asks for the time of a step, which simple steps have not.
    """
    what = "the steps cannot become simple steps"
    project, pou = owners(chart)
    _check_tool(project, what)
    executing = _executing(project, chart)
    done: list[tuple[Step, list[str], list[str], str]] = []
    reasons = [
        f"{each.use} asks for more than its flag"
        for each in step_occurrences(project, chart.steps)
        if _TIME.match(each.text_site.text, each.reference.span[1])
    ]
    for step in chart.steps:
        lines: list[str] = []
        ends: list[str] = []
        called = ""
        # by name, as CODESYS executes associations; a main action executes its lines in their order
        for each in sorted(step.actions, key=lambda each: (each.target or "").casefold()):
            is_action = id(each) in executing
            if not each.target or each.qualifier not in _SIMPLE or (is_action and each.qualifier is not Qualifier.N):
                reasons.append(f"{step.name} has {each.qualifier.value} {each.target or 'code in place'}")
            elif is_action:
                lines.append(f"{each.target}();")
                called = each.target
            else:
                lines.append(f"{each.target} := {_SIMPLE[each.qualifier]};")
                ends += [f"{each.target} := FALSE;"] if each.qualifier is Qualifier.N else []
        taken = [
            name for name in ("main_action", *(["exit_action"] if ends else [])) if getattr(step, name) is not None
        ]
        reasons += [f"{step.name} has its {name.replace('_', ' ')} already" for name in taken if lines]
        if lines:
            done.append((step, lines, ends, called if len(lines) == 1 else ""))
    numbers = {step.id: number for number, step in enumerate(chart.steps)}

    def by_step(row: Row) -> Place | None:
        is_row = any(each is row[1] for each in row[0].actions)
        return place_of_step(numbers[row[0].id]) if is_row else None

    reasons += changed_places(chart, pou, dialect_of(project), by_step)
    own = [(step, each.target or "") for step in chart.steps for each in step.actions if id(each) in executing]
    reasons += _executed_once(chart, pou, dialect_of(project), own)
    if reasons:
        raise refused(what, reasons)
    if not done:
        raise refused(what, "no step has an association")
    changed = write_notation(project, chart.steps, journal, members=False)
    for step, lines, ends, called in done:
        journal.put(step, "actions", [])
        inside = _inside_guard(pou, step, called)
        alone = _CALL.fullmatch(inside)
        action = pou.find_action(alone[1]) if alone is not None else None
        guarded = action.name if action is not None else StBody(text=inside or "\n".join(lines))
        journal.put(step, "main_action", called if called and not inside else guarded)
        if ends:
            name = _free_name(pou, f"{step.name}_exit")
            journal.put(pou, "actions", [*pou.actions, Action(name=name, body=StBody(text="\n".join(ends)))])
            journal.put(step, "exit_action", name)
    return changed


_SIMPLE = {Qualifier.N: "TRUE", Qualifier.S: "TRUE", Qualifier.R: "FALSE"}
"""The value that a variable gets in the main action for these qualifiers."""


def _inside_guard(pou: Pou, step: Step, called: str) -> str:
    """Return the statements of an action that asks for the step and does nothing else; empty where it is none."""
    action = next((each for each in pou.actions if each.name.casefold() == called.casefold()), None)
    text = action.body.text if action is not None and isinstance(action.body, StBody) else ""
    found = re.fullmatch(rf"\s*IF\s+{re.escape(step.name)}(?:\s*\.\s*x)?\s+THEN\b(.*)\bEND_IF\s*;?\s*", text, _LOOSE)
    if found is None or parse_statements(found[1], Dialect.CODESYS).problems:  # such as ELSE, or the IF of another
        return ""
    return dedent(found[1].strip("\r\n")).rstrip()


_LOOSE = re.IGNORECASE | re.DOTALL
_CALL = re.compile(r"\s*(\w+)\s*\(\s*\)\s*;?\s*")


def _executing(project: Project, chart: SfcNetwork) -> set[int]:
    """Return the associations, by their identities, that execute an action and drive no variable."""
    targets = {(each.target or "").rpartition(".")[2] for _, each in chart.associations()} - {""}
    found = Names(project).occurrences(*targets) if targets else ()
    return {
        id(each.text_site.holder)
        for each in found
        if each.meaning.declaration is not None and each.meaning.declaration.kind is Kind.ACTION
    }


def _free_name(pou: Pou, wish: str) -> str:
    """Return a name that no part and no variable of a POU has."""
    return free_name(wish, {each.name.casefold() for each in (*pou.parts, *pou.variables())})


_MEMBER = re.compile(r"\s*\.\s*x\b", re.IGNORECASE)


def name_steps_by_flags(project: Project) -> list[str]:
    """Write ``Wait`` for ``Wait.x`` of simple steps, ``Wait.x`` of others; return the paths of the changed texts."""
    journal, simple = Journal(), _simple_steps_of(project)
    known = {id(step) for step in simple}
    others = [step for chart in project.charts() for step in chart.chart.steps if id(step) not in known]
    changed = write_notation(project, simple, journal, members=False)
    return list(dict.fromkeys([*changed, *write_notation(project, others, journal, members=True)]))


def name_steps_by_members(project: Project) -> list[str]:
    """Write ``Wait.x`` for ``Wait`` in `project`, and return the paths of the changed texts."""
    return write_notation(project, _simple_steps_of(project), Journal(), members=True)


def step_times_asked(project: Project) -> list[str]:
    """Return the paths of the texts that ask for the time of a simple step, which has none."""
    asked = (
        each.text_site.report_path
        for each in step_occurrences(project, _simple_steps_of(project))
        if _TIME.match(each.text_site.text, each.reference.span[1])
    )
    return list(dict.fromkeys(asked))


def _simple_steps_of(project: Project) -> list[Step]:
    return [step for chart in project.charts() for step in simple_steps(chart.chart.steps)]


def step_occurrences(project: Project, asked: Iterable[Step]) -> Iterator[Occurrence]:
    """Yield the places of program text that ask for some steps."""
    steps = {id(step): step for step in asked}
    names = Names(project) if steps else None
    for occurrence in names.occurrences(*{step.name for step in steps.values()}) if names is not None else ():
        declaration = occurrence.meaning.declaration
        is_step = declaration is not None and declaration.kind is Kind.STEP and isinstance(declaration.holder, Step)
        if is_step and declaration is not None and id(declaration.holder) in steps and _is_text(occurrence):
            yield occurrence


def write_notation(project: Project, asked: Iterable[Step], journal: Journal, *, members: bool) -> list[str]:
    """Change the notation in texts that ask for some steps, and return the paths of these texts."""
    changed: dict[str, None] = {}
    for occurrences in by_text(step_occurrences(project, asked)):
        site, text = occurrences[0].text_site, occurrences[0].text_site.text
        edits = sorted(set(_edits(occurrences, text, members=members)))
        if not edits:
            continue
        journal.keep(site.holder, site.key)
        if getattr(site.holder, "markup", None) is not None:
            journal.keep(site.holder, "markup")
            site.holder.markup = edit_markup(site.holder.markup, text, edits)
        site.put(apply_edits(text, edits))
        changed[site.report_path] = None
    return list(changed)


def _is_text(occurrence: Occurrence) -> bool:
    holder = occurrence.text_site.holder
    if isinstance(holder, ActionAssociation) and holder.qualifier in SWITCHES:
        return occurrence.text_site.key != "target"  # which names the step to switch, and asks for nothing
    return occurrence.text_site.is_program_text or occurrence.text_site.reading is SiteKind.INSTRUCTIONS


def _edits(occurrences: list[Occurrence], text: str, *, members: bool) -> Iterator[Edit]:
    for occurrence in occurrences:
        end = occurrence.reference.span[1]
        member = _MEMBER.match(text, end)
        if members and not text[end:].lstrip().startswith("."):
            yield Edit(end, end, ".x")
        elif not members and member is not None:
            yield Edit(end, member.end(), "")
