"""What stands inside bodies: structured text, instruction lists, networks, and the names that they use."""

from plcopen_sfc.languages.dialects import Dialect

__all__ = ["Dialect"]
