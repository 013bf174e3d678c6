"""Renaming: what is declared gets another name, and every use of it in every body follows.

The uses are those that `languages.binding` finds: in program text, and in fields of the model that name something
(the table `NAMING` of `text_sites`). Only the name itself is changed in a text: layout and comments stay. A name
whose meaning is not known stays, and is listed.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from typing import Any

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import Location, ModelError, check_argument
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding.name_resolution import fitting
from plcopen_sfc.languages.binding.name_sites import Reference
from plcopen_sfc.languages.binding.name_uses import Names, Occurrence, by_text, unique_declaration
from plcopen_sfc.languages.binding.text_sites import Role, SiteKind, TextSite
from plcopen_sfc.languages.executed_names import SHOWING_FLAGS, reordered, texts_with_name
from plcopen_sfc.languages.grafcet_conditions import OVERLINE
from plcopen_sfc.languages.st.nodes import Quoting
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.languages.words import is_plain, needs_quotes
from plcopen_sfc.model.actions import STEP_ACTION_ENDINGS
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.chart_settings import GRAPH_INPUTS, GRAPH_OUTPUTS, SfcFlag
from plcopen_sfc.model.declaration import Declaration, Kind, check_kind
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcBody, SfcNetwork, Step
from plcopen_sfc.model.variables import SectionKind, sections_of
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.operations import provided
from plcopen_sfc.refactor.journal import EDITS, Journal
from plcopen_sfc.report import RenameResult, Undecided, Use

Wanted = Mapping[Declaration, str]
"""The new names of declarations that are renamed together."""


def visible_clashes(
    names: Names,
    declaration: Declaration,
    uses: Sequence[Occurrence],
    wanted: Wanted,
    by_name: Mapping[str, Sequence[Declaration]],
) -> Iterator[str]:
    """Yield the things that have the new name of `declaration` too: in its scope, or where it is used.

    `by_name` are the keys of `wanted` by their new names in lower case.
    """
    new = wanted[declaration]
    alike = [other for other in by_name[new.casefold()] if other != declaration]
    beside = list(_beside(names, declaration, wanted, alike))
    yield from beside
    for use in uses if not beside else ():
        meaning = names.resolver.meaning(replace(use.reference, name=new), use.text_site)
        candidates = (meaning.declaration,) if meaning.declaration is not None else meaning.candidates or ()
        for other in candidates:
            if other != declaration and not _gives_up_name(other, wanted) and not _is_hidden(declaration, other):
                yield f"{use.use} would mean the {other}"


def changed_meanings(
    wanted: Wanted, before: Sequence[Occurrence], after: Sequence[Occurrence]
) -> Iterator[tuple[Declaration, str]]:
    """Yield the names that mean something else after the rename, each with the renamed thing that is to blame.

    `before` and `after` are the same places of a project. Those that could not be decided before may be so now, but
    for a renamed thing.
    """
    first = next(iter(wanted))
    if len(before) != len(after):
        yield first, "a text that names it would be read in another way"
        return
    for old, new in zip(before, after, strict=True):
        was, now = old.meaning.declaration, new.meaning.declaration
        if now == was if not old.meaning.doubt else now is None or now not in wanted:
            continue
        if was is not None and was in wanted:
            others = (now,) if now is not None else new.meaning.candidates or ()
            yield was, f"{old.use} would mean {_described(next((d for d in others if d not in (None, was)), None))}"
        else:
            yield now if now is not None and now in wanted else first, f"{old.use} means {_described(was)} now"


def _hidden_by(names: Names, occurrence: Occurrence) -> Declaration | None:
    """Return what hides the list, type or variable that is named before a dot, for a tool that takes the nearest."""
    meaning = occurrence.meaning.declaration
    if not occurrence.reference.access or meaning is None:
        return None
    for level in names.resolver.levels(occurrence.reference, occurrence.text_site):
        found = fitting(level.named(occurrence.reference.name), occurrence.reference.role)
        if found:
            return None if meaning in found else found[0]
    return None


def _described(declaration: Declaration | None) -> str:
    return f"the {declaration}" if declaration is not None else "something that the project does not declare"


def _beside(names: Names, declaration: Declaration, wanted: Wanted, alike: Sequence[Declaration]) -> Iterator[str]:
    """Yield the declarations that have the new name in the same scope, or are `alike` and get it there."""
    key = wanted[declaration].casefold()
    transition = declaration.kind is Kind.TRANSITION
    for level in names.levels_with(declaration):
        if declaration in level:
            for other in level.named(key):
                stays = other != declaration and other not in alike and not _gives_up_name(other, wanted)
                if stays and (other.kind is Kind.TRANSITION) == transition:
                    yield f"the {other} has this name already"
            for other in alike:
                if other in level and (other.kind is Kind.TRANSITION) == transition:
                    yield f"the {other} gets this name too"


def _executed_names(names: Names, declaration: Declaration, wanted: Wanted, *, is_shown: bool) -> Iterator[Undecided]:
    """Yield what a tool does otherwise because of the new name of a step or an action.

    `is_shown`: something reads the name of a step in an SFC flag.
    """
    if declaration.kind is Kind.STEP:
        for use in texts_with_name(names, declaration.name) if is_shown else ():
            yield Undecided(use, "a text, which an SFC flag may be compared with: it keeps the old name of the step")
    elif declaration.kind is Kind.ACTION and declaration.pou is not None:
        actions = {each.name: new for each, new in wanted.items() if each.pou is declaration.pou}
        passed = reordered(declaration.pou, actions, names.project.dialect).get(declaration.name)
        if passed:
            place = Use(declaration.path, "SFC", (0, 0), 1, 1, declaration.name)
            order = f"actions are executed in the order of their names: as {wanted[declaration]} it changes places with"
            yield Undecided(place, f"{order} {', '.join(passed)}")


def _gives_up_name(declaration: Declaration, wanted: Wanted) -> bool:
    """True if a declaration gives up its name in the same pass, so that another may have it."""
    return wanted.get(declaration, declaration.name).casefold() != declaration.name.casefold()


def _is_hidden(declaration: Declaration, other: Declaration) -> bool:
    """True if `declaration` may have the name of `other`, which its scope then hides.

    People call steps after values of enumerations and instances after their type, and tools take it.
    """
    return (
        other.kind in (Kind.ENUM_VALUE, Kind.POU, Kind.DATA_TYPE) and other.pou is None and declaration.pou is not None
    )


_SHOWN = 10


@collecting_rarely()
def rename(project: Project, what: Declaration | Model | str, new: str, journal: Journal | None = None) -> RenameResult:
    """Give what is declared as `what` the name `new`, wherever the project names it.

    `what` is a path such as ``Main.S3``, ``Main``, ``GVL.x``, ``Type.member``, or an object of the model. Raises
    `ModelError` where there is no such thing, `new` is no name, or it would mean something else in a place that it
    comes to or is in already; then nothing is changed. A `journal` can take the rename back.
    """
    check_argument(project, Project, "rename needs a project")
    check_argument(what, (str, Model, Declaration), 'what to rename is a path ("Main.S3") or an object of the model')
    check_argument(new, str, "the new name is a text")
    names = Names(project)
    if isinstance(what, Model):
        what = names.declaration_of(what)
    return _rename(names, {_original(names, what): new}, journal)[0]


@collecting_rarely()
def rename_many(
    project: Project, table: Mapping[Declaration | str, str], journal: Journal | None = None
) -> list[RenameResult]:
    """Give several things new names in one pass; all of them, or none.

    `table` has the new name for each path or declaration, such as those of `names_by_pattern`. Names may be exchanged:
    a name is free if its owner gets another one in the same pass. Gives a result for each entry, in their order.
    Raises `ModelError` as `rename` does, and where two entries name one thing; then nothing is changed.
    """
    check_argument(project, Project, "rename_many needs a project")
    check_argument(table, Mapping, 'rename_many needs a table of new names: {"Main.S1": "Fill"}')
    names = Names(project)
    around = {id(what.pou) for what in table if isinstance(what, Declaration)}
    declared = set(names.declarations(lambda pou: id(pou) in around)) if around else set()
    wanted: dict[Declaration, str] = {}
    for what, new in table.items():
        check_argument(what, (str, Declaration), 'what to rename is a path ("Main.S3") or a declaration')
        check_argument(new, str, "the new name is a text")
        if isinstance(what, Declaration) and what not in declared:
            raise ModelError(f"the project does not declare the {what}", hint="Make the table of the same project.")
        declaration = _original(names, what)
        if declaration in wanted:
            raise ModelError(f"the {declaration} is in the table twice", hint="Give each thing one new name.")
        wanted[declaration] = new
    return _rename(names, wanted, journal)


def names_by_pattern(project: Project, kind: Kind | str, pattern: str, new: str) -> dict[Declaration, str]:
    r"""Return the table for `rename_many` of all things of a kind whose whole path matches a regular expression.

    `new` is the new name, with groups of the pattern: ``Main\.S(\d+)`` and ``N\1``. Case does not matter. Raises
    `ModelError` where the pattern is no regular expression, `new` asks for a group that it does not have, and for a
    kind that there is not.
    """
    check_kind(kind)
    names = Names(project)
    table: dict[Declaration, str] = {}
    try:
        expression = re.compile(pattern, re.IGNORECASE)
        for declaration in names.declarations():
            found = expression.fullmatch(declaration.path) if declaration.kind == kind else None
            if found is not None:
                table.setdefault(names.resolver.original(declaration), found.expand(new))
    except (re.error, IndexError) as error:
        raise ModelError(
            f"{pattern!r} and {new!r} are no pattern and new name: {error}",
            hint=r"Write a regular expression for the path, as Main\.S(\d+), and a name with its groups, as N\1.",
        ) from None
    return table


def _original(names: Names, what: Declaration | str) -> Declaration:
    return names.resolver.original(unique_declaration(names, what) if isinstance(what, str) else what)


def rename_step(chart: SfcNetwork, old: str, new: str) -> RenameResult:
    """Rename a step of `chart` in the project that the chart is in; in the chart alone if it is in none."""
    step = chart.step(old)
    project = chart.project
    if project is None:
        alone = Pou(name="", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])
        project = Project(pous=[alone])
    return rename(project, step, new)


def restore_names(project: Project, table: Wanted) -> list[RenameResult]:
    """Give declarations the names of their source; variables may be called as steps: IEC 61131-3 tells both apart.

    What was read under a keyword of IEC 61131-3, such as ``Abstract``, gets it again.

    Raises `ModelError` where a text would mean something else then.
    """
    return _rename(Names(project), table, None, is_shared=True)


def _rename(names: Names, table: Wanted, journal: Journal | None, *, is_shared: bool = False) -> list[RenameResult]:
    """Rename the keys of `table`, which are originals, or raise `ModelError` and change nothing.

    `is_shared`: something beside them may have the new name, and a keyword may be one, as in the source that had it.
    """
    overrides = {each: [*names.resolver.scopes.overrides(each)] for each in table}
    whole = dict(table)
    for declaration, others in overrides.items():
        for other in others:
            if whole.setdefault(other, table[declaration]) != table[declaration]:
                _refuse(declaration, table[declaration], [f"the {other} overrides it, and gets another name"])
    for declaration, new in table.items():
        for action, name in _named_after(names, declaration, new):
            if action not in whole:
                whole[action] = name
                overrides[declaration].append(action)
    wanted = {declaration: new for declaration, new in whole.items() if new != declaration.name}
    for declaration, new in wanted.items():
        _check_name(names, declaration, new, is_of_source=is_shared)
    is_shown = family(names.dialect) is Dialect.CODESYS and any(each.kind is Kind.STEP for each in wanted)
    flags = {name.casefold() for name in SHOWING_FLAGS} if is_shown else set()
    flags -= {name.casefold() for each, new in wanted.items() for name in (each.name, new)}
    words = (*(each.name for each in wanted), *wanted.values(), *flags)
    found = list(names.occurrences(*words, of=wanted))  # in one pass
    is_shown = any(each.reference.name.casefold() in flags and not each.reference.declares for each in found)
    found = [each for each in found if each.reference.name.casefold() not in flags]
    by_name = grouped((occurrence.reference.name.casefold(), occurrence) for occurrence in found)
    by_new_name = grouped((new.casefold(), declaration) for declaration, new in wanted.items())
    results: dict[Declaration, RenameResult] = {}
    changes: list[Change] = []
    for declaration, new in whole.items():
        own = by_name.get(declaration.name.casefold(), []) if declaration in wanted else []
        uses = [occurrence for occurrence in own if occurrence.refers_to(declaration)]
        if _gives_up_name(declaration, wanted) and not is_shared:
            _refuse(declaration, new, visible_clashes(names, declaration, uses, wanted, by_new_name))
        # the places are described as they are before the rename
        undecided = tuple(Undecided(o.use, o.meaning.doubt) for o in own if o.may_refer_to(declaration))
        if declaration in wanted:
            undecided += tuple(_executed_names(names, declaration, wanted, is_shown=is_shown))
            undecided += tuple(_unread_places(names.project, declaration))
        changed = tuple(occurrence.use for occurrence in uses)
        results[declaration] = RenameResult(declaration.path, declaration.name, new, changed, undecided)
        if declaration in wanted:
            holders = (*declaration.holders, *names.resolver.repeated(declaration))
            changes += [(holder, "name", new) for holder in holders]
    old_names = {declaration.name.casefold() for declaration in wanted}
    for text in by_text(o for o in found if o.reference.name.casefold() in old_names):
        if any(occurrence.meaning.declaration in wanted for occurrence in text):
            changes += _text_changes(text, wanted, names.dialect)
    if journal is None:
        journal, names.project.last_edit = Journal(), next(EDITS)
    start = len(journal)
    for change in changes:
        journal.put(*change)
    again = names.after_edits()
    after = list(again.occurrences(*words, of=wanted))  # the same words: the texts with them are known
    after = [each for each in after if each.reference.name.casefold() not in flags]
    hidden = [(each, other) for each in after for other in [_hidden_by(again, each)] if other in wanted]
    if wanted and (hidden or any(changed_meanings(wanted, found, after))):
        journal.take_back(start)
        # after undo: messages show the old names
        reasons = [(other, f"{each.use} names something else before a dot") for each, other in hidden if other]
        reasons += changed_meanings(wanted, found, after)
        culprit = reasons[0][0]
        _refuse(culprit, wanted[culprit], (reason for _, reason in reasons))
    return [_with_overrides(results[each], [results[other] for other in overrides[each]]) for each in table]


def _unread_places(project: Project, declaration: Declaration) -> Iterator[Undecided]:
    """Yield the errors that kept the reader from a text in which a declaration is visible: it may have the name."""
    # of the charts, those that mention the name have been read by now; the findings of the project would read all
    for finding in project.source.diagnostics if project.source is not None else ():
        path = ObjectPath.of(finding.location.path)
        is_visible = declaration.pou is None or not path or path.owner == declaration.pou.report_path
        if finding.severity is Severity.ERROR and is_visible:
            place = Use(path, "text", (0, 0), finding.location.line or 1, 1, finding.message)
            yield Undecided(place, "it was not read, and may have the name")


def _named_after(names: Names, declaration: Declaration, new: str) -> Iterator[tuple[Declaration, str]]:
    """Yield the entry and exit actions that CoDeSys 2.3 finds by the name of their step, with their new names."""
    step = declaration.holders[0] if declaration.holders else None
    if not isinstance(step, Step) or declaration.pou is None:
        return
    for field, ending in STEP_ACTION_ENDINGS.items():
        called = getattr(step, field)
        is_own = isinstance(called, str) and called.casefold() == f"{step.name}{ending}".casefold()
        action = declaration.pou.find_action(called) if is_own else None
        # asked last: to find the tool, all charts may be read
        if action is not None and provided("default_profile")(names.project).name == "codesys23":
            yield names.declaration_of(action), f"{new}{ending}"


def _with_overrides(own: RenameResult, others: Iterable[RenameResult]) -> RenameResult:
    """Return the result for a declaration and those that follow it: that override it, or are named after it."""
    for other in others:
        place = Use(other.path.rpartition(".")[0], "declaration", (0, 0), 1, 1, other.old)
        own = replace(own, changed=(*own.changed, place, *other.changed), undecided=own.undecided + other.undecided)
    return own


def _check_name(names: Names, declaration: Declaration, new: str, *, is_of_source: bool) -> None:
    """Raise `ModelError` where a declaration cannot have this name wherever it is."""
    if declaration.kind is Kind.NAMESPACE:
        raise ModelError(
            "applications, resources and configurations cannot be renamed", location=Location(path=declaration.path)
        )
    problem = names.objection_to(declaration, new)
    if problem and not (is_of_source and is_plain(new)):
        raise ModelError(f"{new!r} cannot be a name: {problem}", location=Location(path=str(declaration)))
    if declaration.kind in (Kind.VARIABLE, Kind.STEP):
        _refuse(declaration, new, _known_to_charts(declaration, (declaration.name, new), names.project.dialect))


def _known_to_charts(declaration: Declaration, names: Iterable[str], dialect: Dialect) -> Iterator[str]:
    """Yield names that charts know: flags of CODESYS and TwinCAT, parameters of S7-GRAPH. With others they are none."""
    known: tuple[str, ...] = ()
    if dialect in (Dialect.CODESYS, Dialect.TWINCAT):
        known = tuple(flag.variable for flag in SfcFlag)
    elif dialect is Dialect.SCL and declaration.pou is not None and declaration.pou.chart is not None:
        sections = sections_of(declaration.pou.interface)
        kinds = {section.kind for section in sections if any(each is declaration.holder for each in section.variables)}
        known = GRAPH_INPUTS * (SectionKind.INPUT in kinds) + GRAPH_OUTPUTS * (SectionKind.OUTPUT in kinds)
    kind = "parameter" if dialect is Dialect.SCL else "flag"
    folded = {name.casefold() for name in known}
    yield from (f"charts know {name} as their {kind}" for name in names if name.casefold() in folded)


def _refuse(declaration: Declaration, new: str, reasons: Iterable[str]) -> None:
    """Raise `ModelError` if there are reasons."""
    objections = list(dict.fromkeys(reasons))
    if objections:
        shown = objections[:_SHOWN] + [f".. and {len(objections) - _SHOWN} more"] * (len(objections) > _SHOWN)
        raise ModelError(
            f"{declaration.name!r} cannot be called {new!r}: {objections[0]}",
            location=Location(path=str(declaration)),
            hint="\n  ".join(shown[1:]),
        )


Change = tuple[Any, str | int, str | None]
"""Another text in a field of an object, or at an index of a list."""


def _text_changes(found: list[Occurrence], wanted: Wanted, dialect: Dialect) -> Iterator[Change]:
    """Yield the changes of a text in which `found` are all places that have one of the old names."""
    text_site = found[0].text_site
    new_names = [wanted.get(o.meaning.declaration) if o.meaning.declaration else None for o in found]
    edits = [
        Edit(*o.reference.span, _spelt(new, o.reference, text_site, dialect))
        for o, new in zip(found, new_names, strict=True)
        if new is not None
    ]
    yield text_site.holder, text_site.key, apply_edits(text_site.text, edits)
    markup: str | None = getattr(text_site.holder, "markup", None)
    if markup is not None and is_tokens(markup):
        old_names = {declaration.name.casefold() for declaration in wanted}
        yield text_site.holder, "markup", edit_tokens(markup, old_names, new_names)
    elif markup is not None:
        yield text_site.holder, "markup", edit_markup(markup, text_site.text, edits)


def _spelt(new: str, reference: Reference, text_site: TextSite, dialect: Dialect) -> str:
    """Return the new name as it is written in a place: in SCL some need quotes, where it is in program text."""
    if reference.overlined:
        return "".join(character + OVERLINE for character in new)
    alone = text_site.reading is SiteKind.NAME or reference.role is Role.TYPE
    if dialect is not Dialect.SCL or alone or reference.quoting in (Quoting.GLOBAL, Quoting.LOCAL_QUOTED):
        return new
    return f'"{new}"' if needs_quotes(new) else new


_MARKUP = re.compile(
    r"<!\[CDATA\[(?P<raw>.*?)\]\]>|<!--.*?-->|<[^>]*>|(?P<reference>&[^;]*;)|(?P<plain>[^<&])", re.DOTALL
)


def edit_markup(markup: str, text: str, edits: Iterable[Edit]) -> str | None:
    """`markup` with the edits of `text`, which is what a person reads of it; None if it is not.

    Blanks at both ends do not count. Of an edit that reaches over tags, the new text is before them, and they stay.
    """
    characters: list[str] = []
    places: list[tuple[int, int]] = []
    for found in _MARKUP.finditer(markup):
        if found["raw"] is not None:
            characters += found["raw"]
            places += [(i, i + 1) for i in range(*found.span("raw"))]
        elif found["reference"] is not None or found["plain"] is not None:
            character = html.unescape(found.group())
            characters += character
            places += [found.span()] * len(character)
    shown = "".join(characters)
    if shown.strip() != text.strip():
        return None
    shift = len(shown) - len(shown.lstrip()) - (len(text) - len(text.lstrip()))
    moved: list[Edit] = []
    for start, end, new in edits:
        if start == end:
            at = places[start + shift][0] if start + shift < len(places) else len(markup)
            moved.append(Edit(at, at, new))
        for number, (first, last) in enumerate(_joined(places[start + shift : end + shift])):
            moved.append(Edit(first, last, "" if number else new))
    return apply_edits(markup, moved)


def _joined(places: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return places in a text with those that follow each other joined."""
    found: list[tuple[int, int]] = []
    for start, end in places:
        if found and start <= found[-1][1]:
            found[-1] = found[-1][0], end
        else:
            found.append((start, end))
    return found


def edit_tokens(markup: str, names: Set[str], new: list[str | None]) -> str | None:
    """Return the ``StructuredText`` of TIA Portal with other names at some of the places that have one of `names`.

    `names` are in lower case. `new` has an item for each place of the text that has one of them, in their order: None
    where it stays. Gives None if the tokens do not have as many.
    """
    places = [found for found in _NAME.finditer(markup) if html.unescape(found[1]).casefold() in names]
    if len(places) != len(new):
        return None
    edits = [
        Edit(*place.span(1), html.escape(text)) for place, text in zip(places, new, strict=True) if text is not None
    ]
    return apply_edits(markup, edits)


_NAME = re.compile(r'<(?!BooleanAttribute)\w+\b[^<>]*?\bName="([^"]*)"')


def is_tokens(markup: str) -> bool:
    """True if a markup is the ``StructuredText`` of TIA Portal."""
    return markup.lstrip().startswith("<StructuredText")
