"""Texts of any object of the model: the trees in them and the names, without comments and strings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from plcopen_sfc.languages.binding.bodies import bind
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names.declarations import Declaration, Kind
from plcopen_sfc.languages.names.pieces import Piece, Reading, pieces_in
from plcopen_sfc.languages.names.references import Reference, references
from plcopen_sfc.languages.names.uses import Names
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, parse_statements
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project


@dataclass(frozen=True)
class BoundText:
    """A text of the model."""

    piece: Piece
    dialect: Dialect

    @cached_property
    def trees(self) -> Sequence[n.Expression | n.Statement]:
        """The expressions and statements of a program text; what cannot be read is `Unreadable` among them."""
        piece = self.piece
        if isinstance(piece.holder, StBody | IlBody):
            return bind(piece.holder, self.dialect).trees
        if piece.reading is Reading.STATEMENTS:
            return parse_statements(piece.text, self.dialect).tree.statements
        return (parse_condition(piece.text, self.dialect).tree,) if piece.reading is Reading.EXPRESSION else ()

    @cached_property
    def uses(self) -> Sequence[Reference]:
        """The name sites of the text."""
        return tuple(references(self.piece, self.dialect))


def texts_in(thing: Model, dialect: Dialect) -> Iterator[BoundText]:
    """Yield every text in an object of the model that may name something."""
    return (BoundText(piece, dialect) for piece in pieces_in(thing))


def names_in(thing: Model, dialect: Dialect) -> set[str]:
    """Return the names (lower case) in the texts of an object of the model."""
    return {use.name.casefold() for text in texts_in(thing, dialect) for use in text.uses}


def is_named_elsewhere(pou: Pou, project: Project) -> bool:
    """True if the text of another POU names this one, or may do so: ``Main.x``."""
    declared = Declaration(Kind.POU, pou.name, (pou,))
    return any(
        (found.refers_to(declared) or found.may_refer_to(declared))
        for found in Names(project).occurrences(pou.name)
        if found.piece.site.pou is not None and found.piece.site.pou.name != pou.name
    )
