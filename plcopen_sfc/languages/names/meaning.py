"""What a name refers to, or why nobody can tell."""

from __future__ import annotations

from dataclasses import dataclass

from plcopen_sfc.languages.names.declarations import Declaration


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a name refers to. Without declaration: nothing of the project, or, with `doubt`, nobody can tell.

    `candidates` are the declarations that are in doubt; None: it can be any that has members or parameters.
    """

    declaration: Declaration | None = None
    doubt: str = ""
    candidates: tuple[Declaration, ...] | None = None


NOTHING = Meaning()
"""Nothing of the project: a standard function, a library, a name that is declared nowhere."""
