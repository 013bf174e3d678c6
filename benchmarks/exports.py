"""Exports of a PLC as folders of documents of TIA Portal Openness, of any size."""

from __future__ import annotations

import re
from pathlib import Path

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures" / "simaticml"
PATTERN = ("FC_Release", "FB_Motor", "FC_Release", "Machine", "FB_Drill", "FB_Drill_DB", "FB_Motor", "Station")
"""The examples of which blocks are copies, in turn: one of eight is in GRAPH, two SCL, two FBD, three data."""
FOLDERS = 20
"""How many blocks stand in one folder."""


def generate_export(folder: Path, blocks: int) -> int:
    """Write `blocks` documents below `folder`, with names and numbers of their own; returns their size in bytes."""
    templates = {name: (FIXTURES / f"{name}.xml").read_bytes() for name in PATTERN}
    size = 0
    for index in range(blocks):
        kind = PATTERN[index % len(PATTERN)]
        group = f"Program blocks/Station {index // FOLDERS}" if kind != "Station" else "PLC data types"
        target = folder / group
        target.mkdir(parents=True, exist_ok=True)
        content = templates[kind]
        for name in (*PATTERN, "FC_Count"):
            number = index // len(PATTERN)
            content = content.replace(f">{name}<".encode(), f">{name}_{number}<".encode())
            content = content.replace(f'"{name}"'.encode(), f'"{name}_{number}"'.encode())
        name = f"{kind}_{index // len(PATTERN)}_{index % len(PATTERN)}"
        content = content.replace(f"<Name>{kind}_{index // len(PATTERN)}<".encode(), f"<Name>{name}<".encode())
        content = re.sub(rb"<Number>\d+<", f"<Number>{index + 1}<".encode(), content)
        (target / f"{name}.xml").write_bytes(content)
        size += len(content)
    return size
