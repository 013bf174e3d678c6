"""The command line ``plcopen-sfc``: calls the library and prints.

`app` declares the commands, `options` their options, `commands` has modules for what they do.
`command_files` loads files, `many_files` finds them and works on each, `screen` prints and turns errors into
messages and exit codes, `summary` is about files and their charts, `report_items` shows what a conversion lists.
Exit codes: 0 fine, 1 findings or differences, 2 wrong usage or unreadable input.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from plcopen_sfc.version import __version__

__all__ = ["main"]


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line with `argv` (without the program's name) and return its exit code."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if arguments in (["--version"], ["-V"]):  # asked by scripts and installers: costs no import
        sys.stdout.write(f"plcopen-sfc {__version__}\n")
        return 0
    from plcopen_sfc.cli.app import run  # noqa: PLC0415  # typer is not needed above

    return run(arguments)
