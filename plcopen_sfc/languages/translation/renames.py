"""Names that are legal in one dialect only, and what they are called in the others."""

from __future__ import annotations

import json
import re
import unicodedata
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from plcopen_sfc.languages.standard_blocks import standard_blocks
from plcopen_sfc.languages.words import CODESYS_KEYWORDS, TRANSLATED_KEYWORDS
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


def is_identifier(name: str) -> bool:
    """True if a name is an identifier of IEC 61131-3 (6.1.2): letters, digits, and single underscores."""
    return re.fullmatch(r"(?!.*__)[A-Za-z_][A-Za-z0-9_]*", name) is not None


def identifier(name: str) -> str:
    """Return an identifier like `name`: ``Füllstand 1`` is ``Fuellstand_1``."""
    text = unicodedata.normalize("NFC", name).translate(_UMLAUTS)
    text = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    text = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_")
    if not text:  # nothing left, as of a name in another script
        text = "_".join(f"u{ord(character):04X}" for character in name) or "unnamed"
    return f"_{text}" if text[0].isdigit() else text


def is_reserved(name: str, target: Dialect) -> bool:
    """True if `target` reads a name as something else, so that no variable and no member can have it."""
    word = name.upper()
    return word in TRANSLATED_KEYWORDS or word in (_IEC_WORDS if target is Dialect.IEC else _CODESYS_WORDS)


_UMLAUTS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ß": "ss", "ẞ": "SS"})
_IEC_WORDS = frozenset(block.name for block in standard_blocks()) | frozenset(
    """STEP INITIAL_STEP END_STEP TRANSITION END_TRANSITION ACTION END_ACTION FROM WITH ON CONFIGURATION RESOURCE TASK
    PRIORITY READ_ONLY READ_WRITE R_EDGE F_EDGE""".split()
)
"""Standard functions and blocks, and words of textual charts and configurations; many tools take these as names."""
_CODESYS_WORDS = CODESYS_KEYWORDS | frozenset(
    """ADD MUL SUB DIV MOVE NOT SHL SHR ROL ROR SEL MAX MIN LIMIT MUX GT LT LE GE EQ NE ADR BITADR INI SIZEOF XSIZEOF
    INDEXOF ABS SQRT LN LOG EXP SIN COS TAN ASIN ACOS ATAN EXPT TRUNC TRUNC_INT""".split()
)


NAMES_DATA = "urn:plcopen-sfc:names"
"""The data of a project that keeps them."""
DECLARED_DATA = "urn:plcopen-sfc:declared"
"""The data of a project that keeps the names in its source of what it declares; files of all tools have it."""
PROGRAMS_DATA = "urn:plcopen-sfc:programs"
"""The data of a project that keeps the names of programs of CODESYS, of blocks in their place, and of their callers."""


def keep_names(project: Project, renames: Renames) -> None:
    """Keep the renames with the project instead of those that it has kept before."""
    keep_table(project, NAMES_DATA, sorted((rename.scope.value, rename.old, rename.new) for rename in renames))


def keep_table(project: Project, name: str, rows: Sequence[tuple[str, str, str]]) -> None:
    """Keep rows of names with the project instead of those that it has kept as `name` before; none: keep nothing."""
    extension_data = project.extension_data or ExtensionData()
    data = [one for one in extension_data.data if one.name != name]
    if rows:
        text = json.dumps(rows).replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
        data.append(ForeignData(name=name, content=f'<names xmlns="{name}">{text}</names>'))
    extension_data = extension_data.model_copy(update={"data": data})
    project.extension_data = extension_data if extension_data != ExtensionData() else None


def kept_names(project: Project) -> Renames:
    """The renames that a project has kept since its texts were translated from SCL; none where they are damaged."""
    try:
        return Renames(Rename(NameScope(scope), old, new) for scope, old, new in kept_table(project, NAMES_DATA))
    except ValueError:
        return Renames()


def kept_table(project: Project, name: str) -> list[tuple[str, str, str]]:
    """Return the rows of names that a project has kept as `name`; none where they are damaged."""
    for data in project.extension_data.data if project.extension_data is not None else ():
        if data.name == name:
            try:
                rows = json.loads(data.content.partition(">")[2].rpartition("</")[0])
                return [(str(first), str(second), str(third)) for first, second, third in rows]
            except (TypeError, ValueError):
                break
    return []
