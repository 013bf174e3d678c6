"""``plcopen-sfc schema``: the JSON Schema of the model."""

from __future__ import annotations

from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.model import Project


def run(screen: Screen) -> int:
    """Print the schema."""
    screen.json({"$schema": "https://json-schema.org/draft/2020-12/schema", **Project.model_json_schema()})
    return 0
