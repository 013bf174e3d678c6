"""``plcopen-sfc formats``: what is read and written."""

from __future__ import annotations

from typing import Any

from plcopen_sfc.cli.screen import Screen, Table
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.registry import all_formats


def run(screen: Screen) -> int:
    """Print the table of formats."""
    formats = [_data(kind) for kind in all_formats()]
    screen.result({"formats": formats})
    if screen.as_json:
        return 0
    table = Table(["format", "extensions", "what it is", "charts keep"])
    for kind in formats:
        table.rows.append(
            (
                kind["name"],
                " ".join(kind["extensions"]),
                kind["title"],
                ", ".join(kind["capabilities"]),
            )
        )
    screen.table(table)
    screen.line()
    for kind in formats:
        if kind["versions"]:
            insist = ", ".join(f"{kind['name']}-{version}" for version in kind["versions"])
            screen.line(f"{kind['title']}: --to {insist} insists on a version.")
        for flavour in kind["flavours"]:
            screen.line(f"{kind['title']}: --for {flavour} writes what {flavour} can read.")
    return 0


def _data(kind: Format) -> dict[str, Any]:
    return {
        "name": kind.name,
        "title": kind.title,
        "extensions": list(kind.extensions),
        "versions": list(kind.versions),
        "flavours": list(kind.flavours),
        "capabilities": list(kind.capabilities),
    }
