"""The commands with their arguments and options. What they do stands in `plcopen_sfc.cli.commands`, imported on use."""

# No `from __future__ import annotations`: typer reads the annotations at run time.

import sys
from pathlib import Path
from typing import Annotated

import typer

from plcopen_sfc.cli.guard import guarded
from plcopen_sfc.cli.streams import is_terminal, prepare_streams
from plcopen_sfc.version import __version__

Files = Annotated[list[str], typer.Argument(metavar="FILE", help="Files, folders of TIA exports, patterns (*.xml).")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
AcceptErrors = Annotated[
    bool, typer.Option("--accept-errors", help="Write what could be read of a file whose reading finds errors.")
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No messages but errors.")]
Verbose = Annotated[int, typer.Option("--verbose", "-v", count=True, help="More messages; twice: tracebacks.")]


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
        add_completion=False,
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode="rich" if is_terminal(sys.stdout) else None,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_common)
    for command in (_formats, _info, _validate, _check, _rules, _convert, _rename, _simulate, _lower, _schema):
        app.command(command.__name__.removeprefix("_"))(command)
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
    """Sequential function charts: read, check and convert the files of PLC tools.

    Exit codes: 0 fine; 1 findings or differences; 2 wrong usage or unreadable input.
    """


def _formats(as_json: AsJson = False, quiet: Quiet = False, verbose: Verbose = 0) -> None:
    """List what can be read and written, and what charts keep in each format."""
    with guarded(as_json=as_json, quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import formats  # noqa: PLC0415

        screen.exit_code = formats.run(screen)


def _info(
    files: Files,
    charts: Annotated[
        bool | None, typer.Option("--charts/--no-charts", help="Outline each chart (usual for few charts).")
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    verbose: Verbose = 0,
) -> None:
    """Say what files hold: tool and version, charts, steps, transitions, actions; and what is wrong with them."""
    with guarded(as_json=as_json, quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import info  # noqa: PLC0415

        screen.exit_code = info.run(screen, files, outlines=charts)


def _validate(files: Files, as_json: AsJson = False, quiet: Quiet = False, verbose: Verbose = 0) -> None:
    """Check files against the schema of their format, and their charts for what cannot be executed."""
    with guarded(as_json=as_json, quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import validate  # noqa: PLC0415

        screen.exit_code = validate.run(screen, files)


def _check(  # noqa: PLR0917  # typer calls it by name
    files: Files,
    select: Annotated[
        list[str] | None, typer.Option("--select", metavar="CODES", help="Apply these rules: STR, SEL01 ..; all else.")
    ] = None,
    ignore: Annotated[list[str] | None, typer.Option("--ignore", metavar="CODES", help="Do not apply these.")] = None,
    profile: Annotated[
        str | None,
        typer.Option("--profile", metavar="NAME", help="How charts are executed: iec, codesys, s7graph, grafcet .."),
    ] = None,
    fail_on: Annotated[
        str | None,
        typer.Option(
            "--fail-on", metavar="SEVERITY", help="Exit code 1 from here: error, warning (usual), info, never."
        ),
    ] = None,
    form: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help="How to print the result: text, json, sarif (2.1.0).")
    ] = "text",
    as_json: AsJson = False,
    quiet: Quiet = False,
    verbose: Verbose = 0,
) -> None:
    """Check the charts of files against the numbered rules. `plcopen-sfc rules` lists them."""
    with guarded(as_json=as_json or form != "text", quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import check  # noqa: PLC0415

        chosen = "json" if as_json else form
        how = check.How(check.codes(select), check.codes(ignore), profile, fail_on, chosen)
        screen.exit_code = check.run(screen, files, how)


def _rules(
    codes: Annotated[list[str] | None, typer.Argument(metavar="[CODE]...", help="Explain these: STR, SEL01 ..")] = None,
    markdown: Annotated[bool, typer.Option("--markdown", help="Print the page docs/checks.md.")] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    verbose: Verbose = 0,
) -> None:
    """List the rules of `check`, or explain some of them."""
    with guarded(as_json=as_json, quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import rules  # noqa: PLC0415

        screen.exit_code = rules.run(screen, codes or [], markdown=markdown)


def _convert(  # noqa: PLR0917  # typer calls it by name
    source: Annotated[str, typer.Argument(metavar="SRC", help="The file, or folder of a TIA export, to convert.")],
    to: Annotated[str, typer.Option("--to", metavar="FORMAT", help="The format; `plcopen-sfc formats` lists them.")],
    target: Annotated[
        str | None,
        typer.Argument(metavar="[DST]", help="A file, a folder (out/), - for standard output. Usual: next to SRC."),
    ] = None,
    flavour: Annotated[str, typer.Option("--for", metavar="TOOL", help="Write for a tool: beremiz, matiec.")] = "",
    tia: Annotated[str, typer.Option("--tia", metavar="VERSION", help="Write for a version of TIA Portal: V16.")] = "",
    partial: Annotated[
        bool, typer.Option("--partial", help="Write also where the target does not execute all; the report says what.")
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Refuse what the target executes otherwise, not only what it does not.")
    ] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Write from the model alone, not into the old text.")] = False,
    normalize: Annotated[
        bool, typer.Option("--normalize", help="Leave out what TIA Portal ignores, such as the time of an export.")
    ] = False,
    limit: Annotated[
        float,
        typer.Option("--limit", min=0, metavar="SECONDS", help="Time to run charts in both tools; 0: not at all."),
    ] = 5,
    as_tool: Annotated[
        bool, typer.Option("--as-tool", help="Read as the tool of the file does, without what only this package reads.")
    ] = False,
    accept_errors: AcceptErrors = False,
    accept_untested: Annotated[
        bool, typer.Option("--accept-untested", help="No finding where not all of a chart was run in both tools.")
    ] = False,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="FILE.json", help="Write what became of every item.")
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    verbose: Verbose = 0,
) -> None:
    """Write a file in another format, and say what became of every item."""
    with guarded(as_json=as_json, quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import convert  # noqa: PLC0415

        how = convert.How(to, flavour, tia, strict, partial, fresh, normalize, limit)
        screen.exit_code = convert.run(
            screen,
            source,
            target,
            how,
            as_tool=as_tool,
            accept_errors=accept_errors,
            accept_untested=accept_untested,
            report_to=report,
        )


def _rename(  # noqa: PLR0917  # typer calls it by name
    file: Annotated[str, typer.Argument(metavar="FILE", help="The file, or folder of a TIA export, to change.")],
    old: Annotated[str, typer.Argument(metavar="OLD", help="What to rename: Main, Main.S3, GVL.x, Type.member.")],
    new: Annotated[str, typer.Argument(metavar="NEW", help="Its new name.")],
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Show the changes of the file; write nothing.")] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
    verbose: Verbose = 0,
) -> None:
    """Rename a step, a variable, an action, a POU, a type wherever the file names it."""
    with guarded(as_json=as_json, quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import rename  # noqa: PLC0415

        screen.exit_code = rename.run(screen, file, old, new, dry_run=dry_run)


def _simulate(  # noqa: PLR0917  # typer calls it by name
    file: Annotated[str, typer.Argument(metavar="FILE", help="The file with the chart or program.")],
    pou: Annotated[
        str | None, typer.Option("--pou", metavar="NAME", help="Which of its POUs: Main, or Main.Fill for an action.")
    ] = None,
    inputs: Annotated[
        str | None, typer.Option("--inputs", metavar="FILE.csv", help="Inputs: a column each, a row for each scan.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option("--seed", metavar="N", help="Random inputs, the same for the same N.")
    ] = None,
    system_inputs: Annotated[
        bool,
        typer.Option(
            "--system-inputs",
            help="With --seed: what operates the chart too (INIT_SQ, SW_MAN, SFCInit); usual: it rests.",
        ),
    ] = False,
    scans: Annotated[
        int | None,
        typer.Option("--scans", metavar="N", min=0, help="How many scans; usual: as many as inputs, or 100."),
    ] = None,
    scan_time: Annotated[str, typer.Option("--scan-time", metavar="TIME", help="The time from scan to scan.")] = "10ms",
    profile: Annotated[
        str | None,
        typer.Option("--profile", metavar="NAME", help="iec, codesys, codesys23, s7graph, grafcet, matiec or beremiz."),
    ] = None,
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="A value before the first scan; repeatable.")
    ] = None,
    record: Annotated[
        list[str] | None, typer.Option("--record", metavar="NAME", help="Record only this variable; repeatable.")
    ] = None,
    free: Annotated[
        list[str] | None,
        typer.Option("--free", metavar="NAME", help="An input that is declared as none, or all. Repeatable."),
    ] = None,
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Save every scan as CSV.")] = None,
    vcd: Annotated[Path | None, typer.Option("--vcd", metavar="FILE", help="Save a wave file, for GTKWave.")] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    verbose: Verbose = 0,
) -> None:
    """Run a chart or a program scan by scan, and show what it does."""
    with guarded(as_json=as_json, quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import simulate  # noqa: PLC0415

        how = simulate.How(
            pou, inputs, seed, system_inputs, scans, profile, scan_time, settings or (), record or (), free or ()
        )
        screen.exit_code = simulate.run(screen, file, how, csv=csv, vcd=vcd)


ChartFile = Annotated[str, typer.Argument(metavar="FILE", help="The file, or folder of a TIA export, with the chart.")]
CodeFormat = Annotated[
    str, typer.Option("--to", metavar="FORMAT", help="The format; `plcopen-sfc formats` lists them.")
]
CodeFile = Annotated[str | None, typer.Argument(metavar="[DST]", help="The file to write. Usual: next to FILE.")]
ChartName = Annotated[
    str | None, typer.Option("--pou", metavar="NAME", help="Which of its charts: Main, or Main.Fill for an action.")
]
ConstructionName = Annotated[
    str, typer.Option("--as", metavar="FORM", help="flipflop (or fup), case, regions, bits, or auto.")
]
StyleName = Annotated[str, typer.Option("--style", metavar="STYLE", help="exact, or classic as in textbooks.")]
BodyLanguage = Annotated[
    str | None,
    typer.Option("--language", metavar="LANG", help="ST, FBD or LD; usual: FBD for flip-flops, in text ST."),
]
ChartProfile = Annotated[
    str | None, typer.Option("--profile", metavar="NAME", help="What the chart does: iec, codesys, codesys23 ..")
]
RestartInput = Annotated[
    str | None,
    typer.Option("--init", metavar="NAME", help="Add an input that restarts the sequence; classic: Init."),
]
NoRestartInput = Annotated[
    bool, typer.Option("--no-init", help="Of classic forms: no such input; the first scan starts.")
]
StopCondition = Annotated[
    str | None,
    typer.Option("--stop", metavar="CONDITION", help="Emergency stop: sets the initial step, resets all others."),
]
ResetActions = Annotated[bool, typer.Option("--reset-actions", help="--init and --stop end stored actions too.")]
StateKind = Annotated[
    str, typer.Option("--states", metavar="KIND", help="Of a CASE: numbers, constants or enumeration.")
]
ActionsPlace = Annotated[
    str, typer.Option("--actions", metavar="PLACE", help="inline, or block: in a block of their own.")
]
FlagsPlace = Annotated[
    str, typer.Option("--flags", metavar="PLACE", help="Of steps: local, an address (M20.0), or a data block.")
]
Modes = Annotated[
    list[str] | None,
    typer.Option("--mode", metavar="MODE", help="Add inputs: enable, single-step, advance, select. Repeatable."),
]
InactiveInputs = Annotated[
    list[str] | None,
    typer.Option(
        "--at-rest", metavar="NAME", help="Of S7-GRAPH: inputs that are never operated (S_ON, all). Repeatable."
    ),
]
FreeInputs = Annotated[
    list[str] | None,
    typer.Option("--free", metavar="NAME", help="An input that is declared as none, or all. Repeatable."),
]
CommentLanguage = Annotated[str, typer.Option("--lang", metavar="LANG", help="Of titles and comments: en or de.")]
Verify = Annotated[bool, typer.Option("--verify/--no-verify", help="Compare the code with the chart.")]
AcceptUntestedCode = Annotated[
    bool, typer.Option("--accept-untested", help="Write code too of which not all was reached in the comparison.")
]
ProofLimit = Annotated[
    str | None, typer.Option("--limit", metavar="TIME", help="How long a comparison may take: 60s, 5m.")
]
SkipRefused = Annotated[
    bool, typer.Option("--skip-refused", help="Leave charts that cannot be lowered as they are, lower the others.")
]
TiaVersion = Annotated[str, typer.Option("--tia", metavar="V16", help="Write simaticml for this version of TIA.")]
LoweringReport = Annotated[
    Path | None, typer.Option("--report", metavar="FILE", help="Write the proof, the faults and the conversion.")
]


def _lower(  # noqa: PLR0917  # typer calls it by name
    file: ChartFile,
    to: CodeFormat,
    target: CodeFile = None,
    pou: ChartName = None,
    construction: ConstructionName = "auto",
    style: StyleName = "exact",
    language: BodyLanguage = None,
    profile: ChartProfile = None,
    init: RestartInput = None,
    no_init: NoRestartInput = False,
    stop: StopCondition = None,
    reset_actions: ResetActions = False,
    states: StateKind = "numbers",
    actions: ActionsPlace = "inline",
    flags: FlagsPlace = "local",
    modes: Modes = None,
    at_rest: InactiveInputs = None,
    free: FreeInputs = None,
    lang: CommentLanguage = "en",
    verify: Verify = True,
    accept_untested: AcceptUntestedCode = False,
    limit: ProofLimit = None,
    skip_refused: SkipRefused = False,
    tia: TiaVersion = "",
    accept_errors: AcceptErrors = False,
    report: LoweringReport = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
    verbose: Verbose = 0,
) -> None:
    """Make program code of a chart, and prove that it does the same."""
    if no_init and init is not None:
        raise typer.BadParameter("--init and --no-init exclude each other")
    with guarded(as_json=as_json, quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import lower  # noqa: PLC0415

        how = lower.How(
            to,
            tia,
            pou,
            construction,
            {
                "style": style,
                "language": language,
                "profile": profile,
                "init": "" if no_init else init,
                "stop": stop,
                "reset_actions": reset_actions,
                "states": states,
                "actions": actions,
                "flags": flags,
                "modes": modes or (),
                "at_rest": at_rest or (),
                "lang": lang,
            },
            skip_refused,
            verify,
            accept_untested,
            tuple(free or ()),
            limit,
            accept_errors,
        )
        screen.exit_code = lower.run(screen, file, target, how, report_to=report)


def _schema(quiet: Quiet = False, verbose: Verbose = 0) -> None:
    """Print the JSON Schema of the model, for programs in other languages."""
    with guarded(as_json=True, quiet=quiet, verbose=verbose) as screen:
        from plcopen_sfc.cli.commands import schema  # noqa: PLC0415

        screen.exit_code = schema.run(screen)
