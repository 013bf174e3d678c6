"""Versions of TIA Portal, and which schema versions each of them writes.

Sources: the schemas that TIA Portal installs (each lists its includes), and exports of V14 SP1 to V21.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache

NAMESPACE = "http://www.siemens.com/automation/Openness/SW/"
_VERSIONED = re.compile(re.escape(NAMESPACE) + r"(?:NetworkSource/)?(\w+)/v(\d+)")
_NEUTRAL = re.compile(r"urn:simaticml:(\w+)")
LANGUAGES = ("Graph", "FlgNet", "StructuredText", "StatementList")
"""Roots of programs; their namespaces are below ``NetworkSource``."""


@dataclass(frozen=True)
class TiaVersion:
    """One version of TIA Portal: its name in ``Engineering/@version``, and the numbers of its schemas; 0 for none."""

    name: str
    schemas: tuple[int, ...]

    def schema(self, kind: str) -> int:
        """Return the number of the schema of `kind`: ``Interface``, or one of `LANGUAGES`."""
        return dict(zip(KINDS, self.schemas, strict=True)).get(kind, 1)


KINDS = ("Interface", *LANGUAGES)
VERSIONS = (
    TiaVersion("V14 SP1", (2, 1, 1, 0, 1)),
    TiaVersion("V15", (3, 2, 2, 1, 2)),
    TiaVersion("V15.1", (3, 4, 3, 2, 3)),
    TiaVersion("V16", (4, 5, 4, 3, 4)),
    TiaVersion("V17", (5, 5, 4, 3, 4)),
    TiaVersion("V18", (5, 5, 4, 3, 4)),
    TiaVersion("V19", (5, 5, 5, 4, 5)),
    TiaVersion("V20", (5, 5, 5, 4, 5)),
    TiaVersion("V21", (5, 6, 5, 4, 5)),
)
"""Of V14 SP1 and V15 the program schemas without a sample are those that share their grammar of operands with the GRAPH
schema of the version. The first schema of SCL shares that of V15: V14 SP1 has no SCL in XML.
"""

SCHEMAS = {kind: frozenset(v.schema(kind) for v in VERSIONS) - {0} for kind in KINDS}
"""Numbers of the schemas of each kind. There is no version 3 of GRAPH, and no version 1 of interfaces."""

DEFAULT = VERSIONS[-2]
"""Version to write if none is given: V20, which V20 and everything newer imports."""


def version_named(name: str) -> TiaVersion | None:
    """Return the version of this name, as ``Engineering/@version`` spells it."""
    return next((version for version in VERSIONS if version.name == name), None)


@lru_cache(maxsize=256)
def version_like(name: str) -> TiaVersion | None:
    """Return the version of this name; one that came later, or between two that are known, is as the one before it.

    None for a name that is no version of TIA Portal, and for those before V14 SP1, whose format was another.
    """
    exact = version_named(name)
    wanted = _place_in_time(name)
    if exact is not None or wanted is None:
        return exact
    earlier = [version for version in VERSIONS if (_place_in_time(version.name) or wanted) < wanted]
    return replace(earlier[-1], name=name) if earlier else None


def _place_in_time(name: str) -> tuple[int, int, int] | None:
    found = re.fullmatch(r"V(\d{2})(?:\.(\d))?(?: SP(\d))?", name)
    return (int(found[1]), int(found[2] or 0), int(found[3] or 0)) if found else None


def namespace(kind: str, number: int) -> str:
    """Return the namespace of `kind` in schema version `number`."""
    below = "NetworkSource/" if kind in LANGUAGES else ""
    return f"{NAMESPACE}{below}{kind}/v{number}"


def schema_of(uri: str) -> tuple[str, int] | None:
    """Kind and number of a namespace; None where it is none of Openness."""
    found = _VERSIONED.fullmatch(uri)
    return (found[1], int(found[2])) if found else None


def neutral(markup: str) -> str:
    """Markup that fits every version: ``urn:simaticml:KIND`` is the namespace of a kind in any version."""
    return _VERSIONED.sub(lambda found: f"urn:simaticml:{found[1]}", markup)


def concrete(markup: str, schemas: dict[str, int]) -> str:
    """Return the reverse of `neutral`; `schemas` are the numbers to write."""
    return _NEUTRAL.sub(lambda found: namespace(found[1], schemas.get(found[1], 1)), markup)
