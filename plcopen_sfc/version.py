"""The version of the package, in one place: pyproject.toml and ``plcopen-sfc --version`` read it here."""

__version__ = "0.1.0"
