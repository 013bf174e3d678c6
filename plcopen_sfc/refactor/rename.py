"""Renaming: what is declared gets another name, and every use of it in every body follows.

Only the name itself is changed in a text: layout and comments stay. Where it is not known what a name means, it stays
as it is and is listed.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from plcopen_sfc.errors import Location, ModelError, check_argument
from plcopen_sfc.languages.binding.name_sites import Reference
from plcopen_sfc.languages.binding.name_uses import Names, Occurrence, the_one
from plcopen_sfc.languages.binding.symbols import Declaration, Kind
from plcopen_sfc.languages.binding.text_sites import Role, SiteKind, TextSite
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.edits import Edit, apply_edits
from plcopen_sfc.languages.st.nodes import Quoting
from plcopen_sfc.languages.words import needs_quotes, objection
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcFlag, SfcNetwork
from plcopen_sfc.report import RenameResult, Undecided


def visible_clashes(names: Names, declaration: Declaration, uses: Sequence[Occurrence], new: str) -> Iterator[str]:
    """Yield the declarations that are called `new` already: in the scope of `declaration`, or where it is used."""
    beside = list(_beside(names, declaration, new))
    yield from (f"there is a {other} already" for other in beside)
    for use in uses if not beside else ():
        meaning = names.resolver.meaning(replace(use.reference, name=new), use.text_site)
        candidates = (meaning.declaration,) if meaning.declaration is not None else meaning.candidates or ()
        for other in candidates:
            if other != declaration and not _is_hidden(declaration, other):
                yield f"{use.use} would mean the {other}"


def changed_meanings(
    declaration: Declaration, before: Sequence[Occurrence], after: Sequence[Occurrence]
) -> Iterator[str]:
    """The names that mean something else after the rename; `before` and `after` are the same places of a project.

    Those that could not be decided before may be so now, but for the renamed thing.
    """
    if len(before) != len(after):
        yield "a text that names it would be read in another way"
        return
    for old, new in zip(before, after, strict=True):
        was, now = old.meaning.declaration, new.meaning.declaration
        if now == was if not old.meaning.doubt else now != declaration:
            continue
        if was == declaration:
            others = (now,) if now is not None else new.meaning.candidates or ()
            yield f"{old.use} would mean {_said(next((d for d in others if d not in (None, declaration)), None))}"
        else:
            yield f"{old.use} means {_said(was)} now"


def _said(declaration: Declaration | None) -> str:
    return f"the {declaration}" if declaration is not None else "something that the project does not declare"


def _beside(names: Names, declaration: Declaration, new: str) -> Iterator[Declaration]:
    """Declarations of the new name in the same scope."""
    transition = declaration.kind is Kind.TRANSITION
    for level in names.levels():
        if declaration in level:
            for other in level.named(new):
                if other != declaration and (other.kind is Kind.TRANSITION) == transition:
                    yield other


def _is_hidden(declaration: Declaration, other: Declaration) -> bool:
    """True if `declaration` may have the name of `other`, which its scope then hides.

    People call steps after values of enumerations and instances after their type, and tools take it.
    """
    return (
        other.kind in (Kind.ENUM_VALUE, Kind.POU, Kind.DATA_TYPE) and other.pou is None and declaration.pou is not None
    )


_SHOWN = 10


def rename(project: Project, what: Declaration | Model | str, new: str) -> RenameResult:
    """Give what is declared as `what` the name `new`, wherever the project names it.

    `what` is a path such as ``Main.S3``, ``Main``, ``GVL.x``, ``Type.member``, or an object of the model. Raises
    `ModelError` where there is no such thing, `new` is no name, or it would mean something else in a place that it
    comes to or is in already; then nothing is changed.
    """
    check_argument(project, Project, "rename needs a project")
    check_argument(what, (str, Model, Declaration), 'what to rename is a path ("Main.S3") or an object of the model')
    check_argument(new, str, "the new name is a text")
    names = Names(project)
    if isinstance(what, str):
        what = the_one(names, what)
    elif isinstance(what, Model):
        what = names.declaration_of(what)
    return _rename(names, names.resolver.original(what), new)


def rename_step(chart: SfcNetwork, old: str, new: str) -> RenameResult:
    """Rename a step of `chart` in the project that the chart is in; in the chart alone if it is in none."""
    step = chart.step(old)
    project = chart.project
    if project is None:
        alone = Pou(name="", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])
        project = Project(pous=[alone])
    return rename(project, step, new)


def _rename(names: Names, declaration: Declaration, new: str) -> RenameResult:
    old, path = declaration.name, declaration.path
    if new == old:
        return RenameResult(path, old, new)
    if declaration.kind is Kind.NAMESPACE:
        raise ModelError("applications, resources and configurations cannot be renamed", location=Location(path=path))
    problem = objection(new, names.project.dialect)
    if problem:
        raise ModelError(f"{new!r} cannot be a name: {problem}", location=Location(path=str(declaration)))
    if declaration.kind is Kind.VARIABLE and names.project.dialect in (Dialect.CODESYS, Dialect.TWINCAT):
        _refuse(declaration, new, _flags(old, new))
    found = list(names.occurrences(old, new))
    uses = [occurrence for occurrence in found if occurrence.refers_to(declaration)]
    if new.casefold() != old.casefold():
        _refuse(declaration, new, visible_clashes(names, declaration, uses, new))
    # what is said of the places is how they are before the rename
    undecided = tuple(
        Undecided(o.use, o.meaning.doubt)
        for o in found
        if o.may_refer_to(declaration) and o.reference.name.casefold() == old.casefold()
    )
    result = RenameResult(path, old, new, tuple(occurrence.use for occurrence in uses), undecided)
    holders = (*declaration.holders, *names.resolver.repeated(declaration))
    changes = [_Change(holder, "name", holder.name, new) for holder in holders]
    for own in _by_piece(o for o in found if o.reference.name.casefold() == old.casefold()):
        if any(occurrence.refers_to(declaration) for occurrence in own):
            changes += _text_changes(own, declaration, new, names.dialect)
    for change in changes:
        change.make()
    after = list(names.after_edits().occurrences(old, new))
    objections = list(changed_meanings(declaration, found, after))
    if objections:
        for change in changes:
            change.take_back()
        before = list(changed_meanings(declaration, found, after))  # worded with the names as they are again
        _refuse(declaration, new, before)
    return result


def _flags(*names: str) -> Iterator[str]:
    """The names that charts of CODESYS and TwinCAT know their flags by: with another they are flags no more."""
    flags = {flag.variable.casefold() for flag in SfcFlag}
    yield from (f"charts know {name} as their flag" for name in names if name.casefold() in flags)


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


@dataclass(frozen=True, slots=True)
class _Change:
    """Another text in a field, or at an index of a list."""

    holder: Any
    key: str | int
    old: str | None
    new: str | None

    def make(self) -> None:
        self._put(self.new)

    def take_back(self) -> None:
        self._put(self.old)

    def _put(self, text: str | None) -> None:
        if isinstance(self.key, int):
            self.holder[self.key] = text
        else:
            setattr(self.holder, self.key, text)


def _by_piece(found: Iterable[Occurrence]) -> list[list[Occurrence]]:
    """The occurrences of each text, in the order of the text."""
    text_sites: dict[tuple[int, str | int], list[Occurrence]] = {}
    for occurrence in found:
        text_sites.setdefault((id(occurrence.text_site.holder), occurrence.text_site.key), []).append(occurrence)
    return [sorted(own, key=lambda occurrence: occurrence.reference.span) for own in text_sites.values()]


def _text_changes(found: list[Occurrence], declaration: Declaration, new: str, dialect: Dialect) -> Iterator[_Change]:
    """The changes of a text in which `found` are all places that have the old name."""
    text_site = found[0].text_site
    edits = [
        Edit(*o.reference.span, _spelt(new, o.reference, text_site, dialect)) for o in found if o.refers_to(declaration)
    ]
    yield _Change(text_site.holder, text_site.key, text_site.text, apply_edits(text_site.text, edits))
    markup: str | None = getattr(text_site.holder, "markup", None)
    if markup is not None and is_tokens(markup):
        names = [new if occurrence.refers_to(declaration) else None for occurrence in found]
        yield _Change(text_site.holder, "markup", markup, edit_tokens(markup, declaration.name, names))
    elif markup is not None:
        yield _Change(text_site.holder, "markup", markup, edit_markup(markup, text_site.text, edits))


def _spelt(new: str, reference: Reference, text_site: TextSite, dialect: Dialect) -> str:
    """The new name as it is written in a place: in SCL some need quotes, where it is in program text."""
    alone = text_site.reading is SiteKind.NAME or reference.role is Role.TYPE
    if dialect is not Dialect.SCL or alone or reference.quoting in (Quoting.GLOBAL, Quoting.LOCAL_QUOTED):
        return new
    return f'"{new}"' if needs_quotes(new) else new


_MARKUP = re.compile(
    r"<!\[CDATA\[(?P<raw>.*?)\]\]>|<!--.*?-->|<[^>]*>|(?P<reference>&[^;]*;)|(?P<plain>[^<&])", re.DOTALL
)


def edit_markup(markup: str, text: str, edits: Iterable[Edit]) -> str | None:
    """`markup` with the edits of `text`, which is what a person reads of it; None if it is not.

    Blanks at both ends do not count. An edit that reaches over a tag goes to what is before it.
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
    moved = [Edit(places[start + shift][0], places[end + shift - 1][1], new) for start, end, new in edits]
    return apply_edits(markup, moved)


def edit_tokens(markup: str, name: str, new: list[str | None]) -> str | None:
    """The ``StructuredText`` of TIA Portal with another name at some of the places that have `name`.

    `new` has an item for each place of the text that has it, in their order: None where it stays. Gives None if the
    tokens do not have as many.
    """
    places = [found for found in _NAME.finditer(markup) if html.unescape(found[1]).casefold() == name.casefold()]
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
