"""The commands with their options. `plcopen_sfc.cli.commands` has what they do, imported on use."""

# No `from __future__ import annotations`: typer reads the annotations at run time.

import inspect
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Annotated, Any

import typer

from plcopen_sfc.cli import options as o
from plcopen_sfc.cli.screen import Screen, guarded, is_terminal, prepare_streams
from plcopen_sfc.version import __version__


def run(arguments: list[str]) -> int:
    """Run the command line; returns the exit code."""
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


def _command(work: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Make a command of a declaration, whose parameters are its arguments and options.

    The options that all commands share are added here, and those of commands that take many files (`files`). `work` is
    the function of `plcopen_sfc.cli.commands` that does it, such as ``info.run``.
    """

    def declared(function: Callable[..., None]) -> Callable[..., None]:
        own = inspect.signature(function).parameters
        shared = _SHARED | (_OF_MANY_FILES if "files" in own else {})

        def command(**given: Any) -> None:
            options = {name: given[name] if name in own else given.pop(name) for name in _SHARED}
            if "files" in own:
                from plcopen_sfc.cli.many_files import ManyFiles

                given["files"] = ManyFiles(tuple(given["files"]), given.pop("jobs"))
            with guarded(**options) as screen:
                screen.exit_code = _done(work, screen, given)

        # typer reads the signature of what it calls: the options that all commands share are put into it
        added = {
            name: inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
            for name, (annotation, default) in shared.items()
            if name not in own
        }
        parameters = [*own.values(), *added.values()]
        for place, each in enumerate(parameters):
            if each.name == "files":  # what typer makes a `ManyFiles` of
                parameters[place] = each.replace(annotation=Annotated[list[str], *each.annotation.__metadata__])
        command.__name__, command.__doc__ = function.__name__, function.__doc__
        command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]  # what typer reads
        command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        return command

    return declared


def _done(work: str, screen: Screen, given: dict[str, Any]) -> int:
    """Call what does a command; returns the exit code. Options that it has no parameter for are fields of its `how`."""
    name, _, function = work.partition(".")
    # imported now: commands bring the parser and the interpreter, which help and version do without
    module = import_module(f"plcopen_sfc.cli.commands.{name}")
    called = getattr(module, function)
    parameters = inspect.signature(called).parameters
    if "how" in parameters:
        fields = {option: given.pop(option) for option in [*given] if option not in parameters}
        given["how"] = getattr(module, parameters["how"].annotation)(**fields)
    code: int = called(screen, **given)
    return code


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


@_command("catalogues.formats")
def _formats() -> None:
    """List the formats and what of a chart each one preserves."""


@_command("info.run")
def _info(files: o.Files, charts: o.Charts = None) -> None:
    """Show what files hold, with an outline of each chart.

    Shows tool and version, POUs, steps, transitions and actions. Problems of the charts go to standard error.
    """


@_command("validate.run")
def _validate(files: o.Files, tool: o.Importer = "") -> None:
    """Check files against the schema of their format.

    Also reports charts that cannot be executed and program text that cannot be parsed; with --for what a tool would not
    do of them.
    """


@_command("check.run")
def _check(
    files: o.Files,
    select: o.Select = None,
    ignore: o.Ignore = None,
    profile: o.Profile = None,
    fail_on: o.FailOn = None,
    form: o.Form = "text",
) -> None:
    """Check charts against the numbered rules.

    `plcopen-sfc rules` lists the rules.
    """


@_command("catalogues.rules")
def _rules(codes: o.Codes = None, markdown: o.Markdown = False) -> None:
    """List the rules of `check`, or explain some of them."""


@_command("convert.run")
def _convert(
    files: o.Sources,
    to: o.ToFormats = None,
    flavour: o.For = "",
    tia: o.Tia = "",
    partial: o.Partial = False,
    strict: o.Strict = False,
    fresh: o.Fresh = False,
    normalize: o.Normalize = False,
    verify: o.ConvertVerify = True,
    limit: o.ConvertLimit = "auto",
    at_rest: o.ConvertAtRest = None,
    as_tool: o.AsTool = False,
    accept_errors: o.AcceptErrors = False,
    accept_untested: o.AcceptUntested = False,
    report: o.ConvertReport = None,
    lang: o.PageLanguage = "en",
    resume: o.Journal = None,
) -> None:
    """Write files in another format and report every item."""


@_command("diff.run")
def _diff(
    before: o.Before,
    after: o.After,
    layout: o.Layout = False,
    prove: o.Prove = False,
    limit: o.ProveLimit = "30s",
    exit_code: o.ExitCode = False,
    html: o.DiffHtml = None,
    lang: o.PageLanguage = "en",
    jobs: o.FileJobs = 1,
) -> None:
    """Show what changed between two files, in the words of charts.

    Compares what they mean: the files may have different formats. Layout and ids do not count.
    """


@_command("edits.rename")
def _rename(
    files: o.Files,
    old: o.OldName,
    new: o.NewName,
    dry_run: o.DryRun = False,
    diff: o.Patch = None,
    resume: o.Journal = None,
) -> None:
    """Rename a step, a variable or a POU wherever files name it.

    Changes files in place. With - a file is read from standard input and written to standard output.
    """


@_command("edits.renumber")
def _renumber(
    files: o.Files,
    start: o.Start = 1,
    increment: o.Increment = 1,
    names: o.NamesOfSteps = "",
    pou: o.PouName = None,
    dry_run: o.DryRun = False,
    diff: o.Patch = None,
    resume: o.Journal = None,
) -> None:
    """Number steps along the flow, and name them by their numbers.

    Changes files in place. With - a file is read from standard input and written to standard output.
    """


@_command("edits.merge")
def _merge(source: o.StepList, file: o.ListedFile, dry_run: o.DryRun = False) -> None:
    """Put what was edited in a step list into its file.

    The list is one that `convert FILE list.xlsx` wrote, with your changes. Rows that are the same change nothing.
    """


@_command("edits.run_script")
def _apply(
    script: o.Script,
    files: o.Files,
    settings: o.ScriptSettings = None,
    write: o.Write = False,
    diff: o.Patch = None,
    scheduler: o.Scheduler = "",
    prove: o.ProveSame = False,
    limit: o.ProveLimit = "30s",
    resume: o.Journal = None,
) -> None:
    """Run a script on many files, and show what it changes.

    The script is a Python file with a function refactor(project), or a plugin. Files are changed with --write only;
    with it, - is read from standard input and written to standard output.
    """


@_command("simulate.run")
def _simulate(
    file: o.File,
    pou: o.PouName = None,
    inputs: o.Inputs = None,
    seed: o.Seed = None,
    system_inputs: o.SystemInputs = False,
    scans: o.Scans = None,
    scan_time: o.ScanTime = "10ms",
    profile: o.Profile = None,
    settings: o.Settings = None,
    record: o.Record = None,
    free: o.Free = None,
    functions: o.Functions = None,
    as_tool: o.AsTool = False,
    csv: o.Csv = None,
    vcd: o.Vcd = None,
    svg: o.TraceSvg = None,
    html: o.TraceHtml = None,
    lang: o.PageLanguage = "en",
) -> None:
    """Run a chart or a program scan by scan and show what it does."""


@_command("lower.run")
def _lower(
    file: o.File,
    to: o.To = "",
    flavour: o.For = "",
    target: o.Target = None,
    pou: o.PouName = None,
    construction: o.Construction = "auto",
    style: o.Style = "exact",
    language: o.Language = None,
    profile: o.Profile = None,
    init: o.Init = None,
    no_init: o.NoInit = False,
    stop: o.Stop = None,
    reset_actions: o.ResetActions = False,
    states: o.States = None,
    actions: o.Actions = "inline",
    flags: o.Flags = "local",
    flag_names: o.FlagNames = "",
    modes: o.Modes = None,
    at_rest: o.AtRest = None,
    free: o.Free = None,
    functions: o.Functions = None,
    lang: o.TextLanguage = "en",
    verify: o.Verify = True,
    accept_untested: o.AcceptUntested = False,
    limit: o.Limit = None,
    jobs: o.Jobs = 1,
    skip_refused: o.SkipRefused = False,
    partial: o.Partial = False,
    tia: o.Tia = "",
    accept_errors: o.AcceptErrors = False,
) -> None:
    """Make program code of charts and prove that it does the same."""


@_command("drawings.pictures")
def _draw(
    files: o.Sources,
    pou: o.PouName = None,
    style: o.PictureStyle = None,
    theme: o.Theme = "light",
    paper: o.Paper = None,
    to: o.PictureFormat = None,
    fresh: o.FreshLayout = False,
) -> None:
    """Draw charts as pictures: SVG, PNG or PDF.

    A file with several charts needs a folder for them, or --pou.
    """


@_command("drawings.pages")
def _page(
    files: o.Sources,
    lang: o.PageLanguage = "en",
    against: o.Against = None,
    pou: o.PouName = None,
    limit: o.AgainstLimit = "30s",
) -> None:
    """Write a project as one HTML page: charts, texts, findings.

    The page needs no network: charts, declarations, cross references and the findings of `check` are in it.
    """


@_command("edits.normalize")
def _normalize(files: o.Files, dry_run: o.OnlyList = False) -> None:
    """Remove what the tool of a file ignores, for clean diffs in git.

    Changes files of TIA Portal in place: the time of an export and the like go. The exit code is 1 where one changed.
    With - a file is read from standard input and written to standard output, with exit code 0.
    """


@_command("git_use.setup")
def _git_setup(patterns: o.Patterns = None, undo: o.Undo = False) -> None:
    """Make git show changes in the words of charts, and check merges.

    Writes lines to .gitattributes and to the configuration of the repository that you are in.
    """


@_command("git_use.merge")
def _git_merge(base: o.Merged, ours: o.Merged, theirs: o.Merged, name: o.Merged) -> None:
    """Merge three versions of a file, as git calls it."""


@_command("catalogues.schema")
def _schema() -> None:
    """Print the JSON Schema of the model, for other languages."""
