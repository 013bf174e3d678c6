"""What a new name would break."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from plcopen_sfc.languages.binding.name_uses import Names, Occurrence
from plcopen_sfc.languages.binding.symbols import Declaration, Kind


def visible_clashes(names: Names, declaration: Declaration, uses: Sequence[Occurrence], new: str) -> Iterator[str]:
    """What is called `new` already: in the scope of `declaration`, or where it is used."""
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
    """Whether `declaration` may have the name of `other`, which its scope then hides.

    People call steps after values of enumerations and instances after their type, and tools take it.
    """
    return (
        other.kind in (Kind.ENUM_VALUE, Kind.POU, Kind.DATA_TYPE) and other.pou is None and declaration.pou is not None
    )
