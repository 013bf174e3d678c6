"""Which rules are asked for: by their codes, or by how their codes begin."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from plcopen_sfc.analysis.checks.rules import Rule
from plcopen_sfc.errors import ModelError


def selected(rules: Sequence[Rule], select: Iterable[str], ignore: Iterable[str]) -> list[Rule]:
    """The rules that begin with one of `select` (all, where nothing is selected) and with none of `ignore`.

    Raises `ModelError` for a code that no rule begins with.
    """
    wanted = known(rules, select)
    unwanted = known(rules, ignore)
    return [
        rule for rule in rules if (not wanted or rule.code.startswith(wanted)) and not rule.code.startswith(unwanted)
    ]


def known(rules: Sequence[Rule], codes: Iterable[str]) -> tuple[str, ...]:
    """The codes in capitals. Raises `ModelError` where no rule begins with one of them."""
    found = tuple(code.strip().upper() for code in ([codes] if isinstance(codes, str) else codes))
    for code in found:
        if not code or not any(rule.code.startswith(code) for rule in rules):
            groups = sorted({rule.code[:3] for rule in rules})
            raise ModelError(
                f"there is no rule {code!r}", hint=f"Rules begin with {', '.join(groups)}; see docs/checks.md."
            )
    return found
