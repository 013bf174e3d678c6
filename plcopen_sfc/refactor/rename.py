"""Renaming: what is declared gets another name, and every use of it in every body follows.

Only the name itself is changed in a text: layout and comments stay. Where nobody can tell what a name means, it stays
as it is and is listed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from plcopen_sfc.errors import Location, ModelError
from plcopen_sfc.languages.edits import Edit, apply_edits
from plcopen_sfc.languages.names.declarations import Declaration
from plcopen_sfc.languages.names.markup import edit_markup
from plcopen_sfc.languages.names.pieces import Piece
from plcopen_sfc.languages.names.uses import Names, Occurrence, Use, the_one
from plcopen_sfc.languages.names.words import objection
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project, projects_with
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.refactor.clashes import clashes

_SHOWN = 10


@dataclass(frozen=True, slots=True)
class Undecided:
    """A place that has the old name, and why nobody can tell whether it means what was renamed."""

    use: Use
    reason: str

    def __str__(self) -> str:
        return f"{self.use} ({self.reason})"


@dataclass(frozen=True, slots=True)
class RenameResult:
    """What a rename did.

    `path` is that of the declaration before it (``Main.S3``). `changed` are the places that named it, with their text
    as it was, the declaration itself not among them. `undecided` are places that have the old name and were left as
    they are: look at them.
    """

    path: str
    old: str
    new: str
    changed: tuple[Use, ...] = ()
    undecided: tuple[Undecided, ...] = ()


def rename(project: Project, what: Declaration | Model | str, new: str) -> RenameResult:
    """Give what is declared as `what` the name `new`, wherever the project names it.

    `what` is a path such as ``Main.S3``, ``Main``, ``GVL.x``, ``Type.member``, or an object of the model. Raises
    `ModelError` where there is no such thing, `new` is no name, or it would mean something else in a place that it
    comes to or is in already; then nothing is changed.
    """
    names = Names(project)
    if isinstance(what, str):
        what = the_one(names, what)
    elif isinstance(what, Model):
        what = names.declaration_of(what)
    return _rename(names, names.resolver.original(what), new)


def rename_step(chart: SfcNetwork, old: str, new: str) -> RenameResult:
    """Rename a step of `chart` in the project that the chart is in; in the chart alone if it is in none."""
    step = chart.step(old)
    project = next(projects_with(chart), None)
    if project is None:
        alone = Pou(name="", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])
        project = Project(pous=[alone])
    return rename(project, step, new)


def _rename(names: Names, declaration: Declaration, new: str) -> RenameResult:
    old, path = declaration.name, declaration.path
    if new == old:
        return RenameResult(path, old, new)
    problem = objection(new, names.project.dialect)
    if problem:
        raise ModelError(f"{new!r} cannot be a name: {problem}", location=Location(path=str(declaration)))
    found = list(names.occurrences(old))
    uses = [occurrence for occurrence in found if occurrence.refers_to(declaration)]
    if new.casefold() != old.casefold():
        objections = list(dict.fromkeys(clashes(names, declaration, uses, new)))
        if objections:
            shown = objections[:_SHOWN] + [f".. and {len(objections) - _SHOWN} more"] * (len(objections) > _SHOWN)
            raise ModelError(
                f"{old!r} cannot be called {new!r}: {objections[0]}",
                location=Location(path=str(declaration)),
                hint="\n  ".join(shown[1:]),
            )
    undecided = tuple(Undecided(o.use, o.meaning.doubt) for o in found if o.may_refer_to(declaration))
    changed = tuple(occurrence.use for occurrence in uses)
    repeated = list(names.resolver.repeated(declaration))
    _edit(uses, new)
    for holder in (*declaration.holders, *repeated):
        holder.name = new
    return RenameResult(path, old, new, changed, undecided)


def _edit(uses: list[Occurrence], new: str) -> None:
    """Put the new name where the old one stands."""
    edits: dict[tuple[int, str | int], tuple[Piece, list[Edit]]] = {}
    for occurrence in uses:
        piece, span = occurrence.piece, occurrence.reference.span
        _, changes = edits.setdefault((id(piece.holder), piece.key), (piece, []))
        changes.append(Edit(*span, new))
    for piece, changes in edits.values():
        text = piece.text
        markup: Any = getattr(piece.holder, "markup", None)
        if markup is not None:
            piece.holder.markup = edit_markup(markup, text, changes)
        piece.put(apply_edits(text, changes))
