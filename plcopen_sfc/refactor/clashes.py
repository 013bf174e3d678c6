"""What a new name would break."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from plcopen_sfc.languages.names.declarations import Declaration, Kind
from plcopen_sfc.languages.names.resolving import fitting
from plcopen_sfc.languages.names.uses import Names, Occurrence


def clashes(names: Names, declaration: Declaration, uses: Sequence[Occurrence], new: str) -> Iterator[str]:
    """Why `declaration`, which has these uses, cannot be called `new`; nothing if it can."""
    beside = list(_beside(names, declaration, new))
    if beside:
        yield from (f"there is a {other} already" for other in beside)
        return
    for use in uses:
        meaning = names.resolver.meaning(replace(use.reference, name=new), use.piece)
        candidates = (meaning.declaration,) if meaning.declaration is not None else meaning.candidates or ()
        for other in candidates:
            if other != declaration and not _is_hidden(declaration, other):
                yield f"{use.use} would mean the {other}"
    for occurrence in names.occurrences(new):
        if not occurrence.refers_to(declaration) and _captures(names, declaration, occurrence):
            now = occurrence.meaning.declaration
            what = f"the {now}" if now is not None else "something that the project does not declare"
            yield f"{occurrence.use} means {what} now"


def _beside(names: Names, declaration: Declaration, new: str) -> Iterator[Declaration]:
    """Declarations of the new name in the same scope."""
    transition = declaration.kind is Kind.TRANSITION
    for level in names.levels():
        if declaration in level:
            for other in level.named(new):
                if other != declaration and (other.kind is Kind.TRANSITION) == transition:
                    yield other


def _is_hidden(declaration: Declaration, other: Declaration) -> bool:
    """Whether `declaration` may have the name of `other`, an enumeration value that its scope hides.

    Values are visible everywhere in most tools, and people do call steps after them.
    """
    return other.kind is Kind.ENUM_VALUE and other.pou is None and declaration.pou is not None


def _captures(names: Names, declaration: Declaration, occurrence: Occurrence) -> bool:
    """Whether a name that means something else now would mean `declaration` if that were called so."""
    reference = occurrence.reference
    if not fitting([declaration], reference.role):
        return False
    for level in names.resolver.levels(reference, occurrence.piece):
        if declaration in level:
            return True
        if occurrence.meaning.declaration in level:
            return False
    return False
