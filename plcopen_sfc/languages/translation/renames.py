"""Names that are legal in one dialect only, and what they are called in the others."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from plcopen_sfc.languages.words import identifier, is_identifier, is_reserved
from plcopen_sfc.model.base import ExtensionData, ForeignData
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project


class NameScope(StrEnum):
    """Scope in which a name is declared.

    LOCAL: in the interface of the POU (``#name`` in SCL). GLOBAL: outside (``"name"``). MEMBER: in a structure, or in
    the interface of another POU: what is behind a dot or before ``:=`` in a call.
    """

    LOCAL = "local"
    GLOBAL = "global"
    MEMBER = "member"


@dataclass(frozen=True, slots=True)
class Rename:
    """`old`, a name that only SCL can write, is called `new` in the other dialects."""

    scope: NameScope
    old: str
    new: str


_Key: TypeAlias = tuple[bool, str]


def _key(scope: NameScope, name: str) -> _Key:
    # what is local to a POU is a member of its instances: these need one name
    return scope is NameScope.GLOBAL, name.casefold()


class Renames:
    """The renames of a project, in both directions: one name gets one new name, in whatever text it occurs.

    Grows while texts are translated to other dialects than SCL. Where bodies of a project share one, translate them
    until it no longer grows (`len`): a name may have to be changed because of one in a later body.
    """

    def __init__(self, renames: Iterable[Rename] = ()) -> None:
        self._new: dict[_Key, Rename] = {}
        self._old: dict[_Key, Rename] = {}
        for rename in renames:
            self._add(rename)

    def __iter__(self) -> Iterator[Rename]:
        return iter(self._new.values())

    def __len__(self) -> int:
        """Return how many new names were ever given, those that had to be given up again too."""
        return len(self._old)

    def rows(self) -> list[tuple[str, str, str]]:
        """Return the renames as the rows that a project keeps (`KeptNames.TRANSLATED`)."""
        return sorted((rename.scope.value, rename.old, rename.new) for rename in self)

    def new_name(self, scope: NameScope, old: str) -> str | None:
        """Return the name of `old` outside of SCL; None: no rename is known."""
        found = self._new.get(_key(scope, old))
        return found.new if found is not None else None

    def old_name(self, scope: NameScope, new: str) -> str | None:
        """Return the name of `new` in SCL; None: no rename is known."""
        found = self._old.get(_key(scope, new))
        return found.old if found is not None else None

    def legal_name(
        self, scope: NameScope, name: str, taken: Collection[str] = (), target: Dialect = Dialect.IEC
    ) -> str:
        """Return the name of `name` in `target`: itself, if it is legal there and not `taken`.

        `taken`: the names that others have there, casefolded; for LOCAL and MEMBER all, the name itself among them.
        """
        known = self.new_name(scope, name)
        if known is not None and known.casefold() not in taken:
            return known
        hidden = scope is NameScope.GLOBAL and name.casefold() in taken
        if known is None and not hidden and _is_legal(name, target):
            return name
        stem = identifier(name)
        new, number = stem, 1
        while self._is_given(new) or new.casefold() in taken or not _is_legal(new, target):
            number += 1
            new = f"{stem}_{number}"
        self._add(Rename(scope, name, new))
        return new

    def _is_given(self, new: str) -> bool:
        return any(_key(scope, new) in self._old for scope in (NameScope.LOCAL, NameScope.GLOBAL))

    def _add(self, rename: Rename) -> None:
        self._new[_key(rename.scope, rename.old)] = rename
        self._old[_key(rename.scope, rename.new)] = rename


def _is_legal(name: str, target: Dialect) -> bool:
    return is_identifier(name) and not is_reserved(name, target)


NAMES_DATA = "urn:plcopen-sfc:names"
"""The data of a project that keeps names of its source; files of all tools have it."""


class KeptNames(StrEnum):
    """Names of a source that a project keeps, each a row of three texts.

    TRANSLATED: the `Renames` of texts from SCL: scope, old and new name. DECLARED: declarations that got names which
    the tool can have: path, old and new name. LATER: those in exports of CoDeSys 2.3 that are keywords of CODESYS V3,
    in the same way. PROGRAMS: programs of CODESYS, the blocks in their place, and the callers of these. METHODS:
    functions, the blocks whose methods they were, and these methods.
    """

    TRANSLATED = "translated"
    DECLARED = "declared"
    LATER = "later"
    PROGRAMS = "programs"
    METHODS = "methods"


_Row: TypeAlias = tuple[str, str, str]


def keep_names(project: Project, kind: KeptNames, rows: Iterable[_Row]) -> None:
    """Keep names with the project instead of those of the kind that it has kept before."""
    table = [row for row in _kept_table(project) if row[0] != kind] + [[kind.value, *row] for row in rows]
    extension_data = project.extension_data or ExtensionData()
    data = [one for one in extension_data.data if one.name != NAMES_DATA]
    if table:
        text = json.dumps(table).replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
        data.append(ForeignData(name=NAMES_DATA, content=f'<names xmlns="{NAMES_DATA}">{text}</names>'))
    extension_data = extension_data.model_copy(update={"data": data})
    project.extension_data = extension_data if extension_data != ExtensionData() else None


def kept_names(project: Project, kind: KeptNames) -> list[_Row]:
    """Return the names of a kind that a project has kept; none where they are damaged."""
    return [(first, second, third) for own, first, second, third in _kept_table(project) if own == kind]


def kept_renames(project: Project) -> Renames:
    """Return the renames that a project has kept since its texts were translated from SCL; none if damaged."""
    try:
        rows = kept_names(project, KeptNames.TRANSLATED)
        return Renames(Rename(NameScope(scope), old, new) for scope, old, new in rows)
    except ValueError:
        return Renames()


def _kept_table(project: Project) -> list[list[str]]:
    for data in project.extension_data.data if project.extension_data is not None else ():
        if data.name == NAMES_DATA:
            try:
                rows = json.loads(data.content.partition(">")[2].rpartition("</")[0])
                return [[str(kind), str(first), str(second), str(third)] for kind, first, second, third in rows]
            except (TypeError, ValueError):
                break
    return []
