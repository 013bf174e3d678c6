"""The commands with their options. `plcopen_sfc.cli.commands` has what they do, imported on use.

Commands bring the parser and the interpreter, which help and version do without.
"""

# No `from __future__ import annotations`: typer reads the annotations at run time.

import inspect
import sys
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Annotated, Any

import typer

from plcopen_sfc.cli import options as o
from plcopen_sfc.cli.screen import Screen, guarded, is_terminal, prepare_streams
from plcopen_sfc.version import __version__


def run(arguments: list[str]) -> int:
    """Run the command line; return the exit code."""
    prepare_streams()
    try:
        _app()(arguments, prog_name="plcopen-sfc")
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 2
    return 0


def _app() -> typer.Typer:
    app = typer.Typer(
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode="rich" if is_terminal(sys.stdout) else None,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_common)
    for command in (
        _formats,
        _info,
        _validate,
        _check,
        _rules,
        _convert,
        _diff,
        _rename,
        _renumber,
        _merge,
        _apply,
        _simulate,
        _lower,
        _draw,
        _page,
        _normalize,
        _git_setup,
        _schema,
    ):
        app.command(command.__name__.removeprefix("_").replace("_", "-"))(command)
    app.command("git-merge", hidden=True)(_git_merge)  # called by git alone
    return app


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"plcopen-sfc {__version__}")
        raise typer.Exit


def _common(
    version: Annotated[
        bool, typer.Option("--version", "-V", callback=_show_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Read, check, change and convert sequential function charts in the files of PLC tools.

    Exit codes: 0 fine; 1 findings or differences; 2 wrong usage or unreadable input.
    """


def _command(function: Callable[..., int]) -> Callable[..., None]:
    """Make a command of a function, whose parameters behind the screen are its arguments and options.

    It returns the exit code. A record among the parameters stands for its fields, which are options. Those that all
    commands share are added here, and those of commands that take many files (`files`).
    """
    _, *parameters = inspect.signature(function).parameters.values()
    records: dict[str, Any] = {each.name: each.annotation for each in parameters if is_dataclass(each.annotation)}
    own = [option for each in parameters for option in _options(each)]
    names = {each.name for each in own}
    shared = _SHARED | (_OF_MANY_FILES if "files" in names else {})

    def command(**given: Any) -> None:
        options = {name: given[name] if name in names else given.pop(name) for name in _SHARED}
        if "files" in names:
            from plcopen_sfc.cli.many_files import ManyFiles

            given["files"] = ManyFiles(tuple(given["files"]), given.pop("jobs"))
        for name, record in records.items():
            given[name] = record(**{each.name: given.pop(each.name) for each in fields(record)})
        with guarded(**options) as screen:
            screen.exit_code = function(screen, **given)

    # typer reads the signature of what it calls: the options that all commands share are put into it
    declared = [
        # what typer makes a `ManyFiles` of
        each.replace(annotation=Annotated[list[str], *each.annotation.__metadata__]) if each.name == "files" else each
        for each in own
    ] + [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
        for name, (annotation, default) in shared.items()
        if name not in names
    ]
    command.__name__, command.__doc__ = function.__name__, function.__doc__
    command.__signature__ = inspect.Signature(declared)  # type: ignore[attr-defined]  # what typer reads
    command.__annotations__ = {each.name: each.annotation for each in declared}
    return command


def _options(parameter: inspect.Parameter) -> list[inspect.Parameter]:
    """Return the options of a parameter: the fields of a record, else itself."""
    if not is_dataclass(parameter.annotation):
        return [parameter]
    kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
    return [
        inspect.Parameter(each.name, kind, default=each.default, annotation=each.type)
        for each in fields(parameter.annotation)
    ]


_SHARED: dict[str, tuple[Any, Any]] = {
    "report": (o.Report, None),
    "as_json": (o.AsJson, False),
    "quiet": (o.Quiet, False),
    "verbose": (o.Verbose, 0),
}
"""Options of every command, with their declarations and defaults."""

_OF_MANY_FILES: dict[str, tuple[Any, Any]] = {"jobs": (o.FileJobs, 1)}
"""Options of commands that take many files."""

# The first line of each docstring is its help in the list of commands: one sentence of at most 62 characters, so that
# it fits on a line of a terminal of 80.


@_command
def _formats(screen: Screen) -> int:
    """List the formats and what of a chart each one preserves."""
    from plcopen_sfc.cli.commands import catalogues

    return catalogues.formats(screen)


@_command
def _info(screen: Screen, files: o.Files, charts: o.Charts = None) -> int:
    """Show what files hold, with an outline of each chart.

    Shows tool and version, POUs, steps, transitions and actions. Problems of the charts go to standard error.
    """
    from plcopen_sfc.cli.commands import info

    return info.run(screen, files, charts=charts)


@_command
def _validate(screen: Screen, files: o.Files, tool: o.Importer = "") -> int:
    """Check files against the schema of their format.

    Also reports charts that cannot be executed and program text that cannot be parsed; with --for what a tool would not
    do of them.
    """
    from plcopen_sfc.cli.commands import validate

    return validate.run(screen, files, tool)


@_command
def _check(
    screen: Screen,
    files: o.Files,
    select: o.Select = None,
    ignore: o.Ignore = None,
    profile: o.Profile = None,
    fail_on: o.FailOn = None,
    form: o.Form = "text",
) -> int:
    """Check charts against the numbered rules.

    `plcopen-sfc rules` lists the rules.
    """
    from plcopen_sfc.cli.commands import check

    return check.run(screen, files, check.CheckOptions(select, ignore, profile, fail_on, form))


@_command
def _rules(screen: Screen, codes: o.Codes = None, markdown: o.Markdown = False) -> int:
    """List the rules of `check`, or explain some of them."""
    from plcopen_sfc.cli.commands import catalogues

    return catalogues.rules(screen, codes, markdown=markdown)


@_command
def _convert(screen: Screen, files: o.Sources, how: o.ConvertOptions) -> int:
    """Write files in another format and report every item."""
    from plcopen_sfc.cli.commands import convert

    return convert.run(screen, files, how)


@_command
def _diff(screen: Screen, before: o.Before, after: o.After, how: o.DiffOptions) -> int:
    """Show what changed between two files, in the words of charts.

    Compares what they mean: the files may have different formats. Layout and ids do not count.
    """
    from plcopen_sfc.cli.commands import diff

    return diff.run(screen, before, after, how)


@_command
def _rename(
    screen: Screen,
    files: o.RenamedFiles,
    table: o.NameTable = None,
    dry_run: o.DryRun = False,
    diff: o.Patch = None,
    resume: o.Journal = None,
) -> int:
    """Rename a step, a variable or a POU wherever files name it.

    Changes files in place. With - a file is read from standard input and written to standard output.
    """
    from plcopen_sfc.cli.commands import edits

    return edits.rename(screen, files, table, edits.EditOptions(dry_run, diff=diff, resume=resume))


@_command
def _renumber(
    screen: Screen,
    files: o.Files,
    start: o.Start = 1,
    increment: o.Increment = 1,
    names: o.NamesOfSteps = "",
    pou: o.PouName = None,
    dry_run: o.DryRun = False,
    diff: o.Patch = None,
    resume: o.Journal = None,
) -> int:
    """Number steps along the flow, and name them by their numbers.

    Changes files in place. With - a file is read from standard input and written to standard output.
    """
    from plcopen_sfc.cli.commands import edits

    how = edits.EditOptions(dry_run, diff=diff, resume=resume)
    return edits.renumber(screen, files, how, start=start, increment=increment, names=names, pou=pou)


@_command
def _merge(screen: Screen, source: o.StepList, file: o.ListedFile, dry_run: o.DryRun = False) -> int:
    """Put what was edited in a step list into its file.

    The list is one that `convert FILE list.xlsx` wrote, with your changes. Rows that are the same change nothing.
    """
    from plcopen_sfc.cli.commands import edits

    return edits.merge(screen, source, file, edits.EditOptions(dry_run))


@_command
def _apply(
    screen: Screen,
    script: o.Script,
    files: o.Files,
    settings: o.ScriptSettings = None,
    write: o.Write = False,
    diff: o.Patch = None,
    scheduler: o.Scheduler = "",
    prove: o.ProveSame = False,
    limit: o.ProveLimit = "30s",
    resume: o.Journal = None,
) -> int:
    """Run a script on many files, and show what it changes.

    The script is a Python file with a function refactor(project), or a plugin. Files are changed with --write only;
    with it, - is read from standard input and written to standard output.
    """
    from plcopen_sfc.cli.commands import edits

    how = edits.EditOptions(write=write, diff=diff, scheduler=scheduler, prove=prove, resume=resume, limit=limit)
    return edits.run_script(screen, script, files, settings, how)


@_command
def _simulate(screen: Screen, file: o.File, how: o.SimulateOptions) -> int:
    """Run a chart or a program scan by scan and show what it does."""
    from plcopen_sfc.cli.commands import simulate

    return simulate.run(screen, file, how)


@_command
def _lower(screen: Screen, file: o.File, how: o.LowerOptions, target: o.Target = None) -> int:
    """Make program code of charts and prove that it does the same."""
    from plcopen_sfc.cli.commands import lower

    return lower.run(screen, file, target, how)


@_command
def _draw(
    screen: Screen,
    files: o.Sources,
    pou: o.PouName = None,
    style: o.PictureStyle = None,
    theme: o.Theme = "light",
    paper: o.Paper = None,
    to: o.PictureFormat = None,
    fresh: o.FreshLayout = False,
) -> int:
    """Draw charts as pictures: SVG, PNG or PDF.

    A file with several charts needs a folder for them, or --pou.
    """
    from plcopen_sfc.cli.commands import drawings

    return drawings.pictures(screen, files, to=to, pou=pou, style=style, theme=theme, paper=paper, fresh=fresh)


@_command
def _page(screen: Screen, files: o.Sources, how: o.PageOptions) -> int:
    """Write a project as one HTML page: charts, texts, findings.

    The page needs no network: charts, declarations, cross references and the findings of `check` are in it.
    """
    from plcopen_sfc.cli.commands import drawings

    return drawings.pages(screen, files, how)


@_command
def _normalize(screen: Screen, files: o.Files, dry_run: o.OnlyList = False) -> int:
    """Remove what the tool of a file ignores, for clean diffs in git.

    Changes files of TIA Portal in place: the time of an export and the like go. The exit code is 1 where one changed.
    With - a file is read from standard input and written to standard output, with exit code 0.
    """
    from plcopen_sfc.cli.commands import edits

    return edits.normalize(screen, files, dry_run=dry_run)


@_command
def _git_setup(screen: Screen, patterns: o.Patterns = None, undo: o.Undo = False) -> int:
    """Make git show changes in the words of charts, and check merges.

    Writes lines to .gitattributes and to the configuration of the repository that you are in.
    """
    from plcopen_sfc.cli.commands import git_use

    return git_use.setup(screen, patterns, undo=undo)


@_command
def _git_merge(screen: Screen, base: o.Merged, ours: o.Merged, theirs: o.Merged, name: o.Merged) -> int:
    """Merge three versions of a file, as git calls it."""
    from plcopen_sfc.cli.commands import git_use

    return git_use.merge(screen, base, ours, theirs, name)


@_command
def _schema(screen: Screen) -> int:
    """Print the JSON Schema of the model, for other languages."""
    from plcopen_sfc.cli.commands import catalogues

    return catalogues.schema(screen)
