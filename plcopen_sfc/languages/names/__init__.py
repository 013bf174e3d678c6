"""Names: what a project declares, what is visible where, and every use of it in bodies of every language."""

from plcopen_sfc.languages.names.declarations import Declaration, Kind
from plcopen_sfc.languages.names.uses import Names, Use, find_uses

__all__ = ["Declaration", "Kind", "Names", "Use", "find_uses"]
