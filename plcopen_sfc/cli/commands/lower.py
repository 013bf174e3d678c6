"""``plcopen-sfc lower``: program code instead of a chart, with the proof that it does the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from plcopen_sfc.analysis.search_limits import seconds
from plcopen_sfc.analysis.verdict import UntestedError
from plcopen_sfc.batch import functions_of, is_folder_in
from plcopen_sfc.cli.command_files import (
    STANDARD_STREAM,
    error_data,
    exit_code_for,
    format_of_target,
    load_and_tell,
    names_in,
    written_to_stdout,
)
from plcopen_sfc.cli.options import LowerOptions
from plcopen_sfc.cli.report_items import show_items
from plcopen_sfc.cli.screen import INTERRUPTED, UNREADABLE, Screen
from plcopen_sfc.documents.lowered import LoweredFile, lower_to_file
from plcopen_sfc.errors import InputError, LossError, LoweringError
from plcopen_sfc.files import folder_exists
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.lowering import LoweredPou
from plcopen_sfc.report import ConversionReport

_FINDINGS = 1
_NOT_OF_THE_LIBRARY = frozenset({"to", "no_init", "free", "functions", "accept_errors"})
"""Options that `lower_to_file` has by other names or in other forms, or not at all."""


def run(screen: Screen, file: str, target: str | None, how: LowerOptions) -> int:
    """Lower the charts of `file`, or one of them, into `target` (None: a file next to it), and show what was made.

    ``-`` is standard input and standard output.
    """
    if how.no_init and how.init is not None:
        raise InputError("--init and --no-init exclude each other")
    seconds(how.limit)  # a wrong one is a mistake of the command line, not of a chart
    to = format_of_target(how.to, target, how.tia)
    if target is None:
        target = STANDARD_STREAM if file == STANDARD_STREAM else _beside(Path(file), to)
    project = load_and_tell(screen, file)
    if how.accept_errors:
        project.accept_errors()
    extension = format_named(to)[0].extensions[0]
    options: dict[str, Any] = vars(how) | {"modes": how.modes or (), "at_rest": names_in(how.at_rest)}
    options |= {"init": ""} if how.no_init else {}
    with written_to_stdout(screen, target, extension) as place, screen.searching() as progress:
        try:
            made = lower_to_file(
                project,
                place,
                format=to,
                free_inputs=how.free or (),
                functions=functions_of(how.functions) if how.functions is not None else {},
                progress=progress,
                **{name: value for name, value in options.items() if name not in _NOT_OF_THE_LIBRARY},
            )
        except LossError as loss:
            if not screen.as_json and not screen.quiet:
                show_items(screen, loss.report.losses)
            screen.result({"file": None, "pous": [], "refused": [], "conversion": loss.report.as_dict()})
            screen.error(loss)
            return _FINDINGS
    if target == STANDARD_STREAM and made.path is not None:
        made = replace(made, path=target)
        made.report.written = [target]
    untested = all(isinstance(error, UntestedError) for error in made.refused.values())
    if len(made.refused) == 1 and not made.pous and not untested:
        raise next(iter(made.refused.values()))
    screen.result(_as_data(made))
    if made.path is not None and not screen.as_json and not screen.quiet:
        _show(screen, made.path, made.pous, made.report)
    for error in made.refused.values():
        screen.error(error)
    charts = len(made.pous) + len(made.refused)
    if made.path is None:
        screen.complain(f"nothing is written: {len(made.refused)} of {charts} charts are refused")
        if made.pous and not how.skip_refused:
            screen.advise("--skip-refused leaves them as they are and lowers the others.")
        if any(isinstance(each, UntestedError) and each.verdict.interrupted for each in made.refused.values()):
            return INTERRUPTED
        return _FINDINGS if untested else UNREADABLE
    if made.refused:
        screen.note(f"{len(made.refused)} of {charts} charts are refused, and left as they are")
    different = any(each.proof is not None and each.proof.different for each in made.pous)
    return _FINDINGS if different or made.refused else exit_code_for(screen, project.diagnostics)


def _as_data(made: LoweredFile) -> dict[str, object]:
    """Return the result as plain data, for JSON."""
    return {
        "file": made.path,
        "pous": [each.as_dict() for each in made.pous],
        "refused": [{"pou": pou, **_refusal(error)} for pou, error in made.refused.items()],
        "conversion": made.report.as_dict() if made.path is not None else None,
    }


def _refusal(error: LoweringError) -> dict[str, object]:
    """Return a refusal as plain data, with the comparison that has led to it."""
    data: dict[str, object] = dict(error_data(error))
    return data | ({"proof": error.verdict.as_dict()} if isinstance(error, UntestedError) else {})


def _show(screen: Screen, target: str, lowered: Sequence[LoweredPou], report: ConversionReport) -> None:
    for each in lowered:
        head, *rest = str(each).splitlines()
        screen.line((each.name, "bold"), head.removeprefix(each.name))
        for line in rest if each.proof is not None else [*rest, "not compared with the chart"]:
            screen.line(line)
    show_items(screen, [*(item for each in lowered for item in each.losses), *report.losses])
    screen.line("written: ", (target, "bold"))


def _beside(source: Path, to: str) -> str:
    """Return a name next to `source`: a folder for tools that import one object a file."""
    kind = format_named(to)[0]
    place = source.resolve() if folder_exists(source) else source
    return str(place.with_name(f"{place.stem}-lowered")) + ("/" if is_folder_in(kind, source) else kind.extensions[0])
