"""The arguments and options of the commands, each declared once: what a name means is the same in every command."""

# No `from __future__ import annotations`: typer reads the annotations at run time.

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from plcopen_sfc.cli.many_files import ManyFiles


def _formats() -> list[str]:
    from plcopen_sfc.formats.registry import all_formats  # noqa: PLC0415  # only for shells that complete a word

    return [kind.name for kind in all_formats()]


def _flavours() -> list[str]:
    from plcopen_sfc.formats.registry import all_formats  # noqa: PLC0415

    return [flavour for kind in all_formats() for flavour in kind.flavours]


def _profiles() -> list[str]:
    from plcopen_sfc.semantics.profile import PROFILES  # noqa: PLC0415

    return list(PROFILES)


def _option(name: str, help: str, metavar: str | None = None, **more: Any) -> Any:
    return typer.Option(name, help=help, metavar=metavar, **more)


# -- files ------------------------------------------------------------------------------------------------------------

_FILE = "A file, a folder of a TIA export, or - for standard input."

Files = Annotated[
    "ManyFiles",
    typer.Argument(metavar="FILE...", help="Files, folders, patterns, @list.txt (@-: standard input), or -."),
]
File = Annotated[str, typer.Argument(metavar="FILE", help=_FILE)]
Sources = Annotated[
    "ManyFiles",
    typer.Argument(
        metavar="SRC... [DST]",
        help="Files, folders, patterns, @list.txt, or -; then a file, a folder (out/), or - to write to. "
        "The default is next to each source.",
    ),
]
Target = Annotated[
    str | None,
    typer.Argument(
        metavar="[DST]", help="A file, a folder (out/), or - for standard output. The default is next to the source."
    ),
]
To = Annotated[
    str,
    _option(
        "--to",
        "The format to write, of `plcopen-sfc formats`. Not needed where the extension of DST tells it.",
        "FORMAT",
        autocompletion=_formats,
    ),
]
ToFormats = Annotated[
    list[str] | None,
    _option(
        "--to",
        "The format to write, of `plcopen-sfc formats`. Several with commas are written into the folder DST. "
        "Not needed where the extension of DST tells it.",
        "FORMAT",
        autocompletion=_formats,
    ),
]
For = Annotated[
    str, _option("--for", "Write for a tool that reads less: beremiz or matiec.", "TOOL", autocompletion=_flavours)
]
Importer = Annotated[
    str,
    _option("--for", "Also tell what this tool would not do of the file: codesys, twincat, beremiz, tia-V16.", "TOOL"),
]
Tia = Annotated[str, _option("--tia", "Write for this version of TIA Portal, such as V16.", "VERSION")]
AcceptErrors = Annotated[
    bool, _option("--accept-errors", "Write what could be read of a file in which reading finds errors.")
]
AsTool = Annotated[bool, _option("--as-tool", "Read the file as its tool does, without data that only we read.")]
Partial = Annotated[bool, _option("--partial", "Write a file that does not execute everything; the report lists what.")]
Strict = Annotated[bool, _option("--strict", "Refuse all that changes behaviour, not only what is not executed.")]
Fresh = Annotated[bool, _option("--fresh", "Write from the model alone and not into the old text.")]
Normalize = Annotated[bool, _option("--normalize", "Leave out what TIA Portal ignores, such as the time of export.")]
OnlyList = Annotated[bool, _option("--dry-run", "List what would change and write nothing.")]
DryRun = Annotated[bool, _option("--dry-run", "Show the changes as a diff and write nothing.")]

# -- what every command prints ----------------------------------------------------------------------------------------

AsJson = Annotated[bool, _option("--json", "Print the result as JSON.")]
Report = Annotated[Path | None, _option("--report", "Write to this file what --json prints.", "FILE.json")]
Quiet = Annotated[
    bool, typer.Option("--quiet", "-q", help="Print nothing but errors and the result that was asked for.")
]
Verbose = Annotated[
    int, typer.Option("--verbose", "-v", count=True, help="Print more messages; given twice, also tracebacks.")
]

# -- charts and how they are executed ---------------------------------------------------------------------------------

PouName = Annotated[
    str | None, _option("--pou", "Take this POU only; Main.Fill is the chart of its action Fill.", "NAME")
]
Profile = Annotated[
    str | None,
    _option("--profile", "Execute charts as this tool does. The default is the tool of the file.", "NAME",
            autocompletion=_profiles),
]  # fmt: skip
Functions = Annotated[
    str | None,
    _option(
        "--functions", "Take the functions of this Python file for those that programs call and nothing has.", "FILE.py"
    ),
]
Free = Annotated[
    list[str] | None,
    _option("--free", "Take a variable that nothing writes as an input, or all of them. Repeatable.", "NAME"),
]
AcceptUntested = Annotated[
    bool, _option("--accept-untested", "Accept charts of which not all was reached in the comparison.")
]
Limit = Annotated[str | None, _option("--limit", "Compare a chart for no longer than this: 5, 60s, 2m30s.", "TIME")]
Jobs = Annotated[int, _option("--jobs", "Compare so many charts at a time, each in a process.", "N", min=1)]
ConvertReport = Annotated[
    Path | None, _option("--report", "Also write the result as JSON, or as a page with both charts.", "FILE.json|.html")
]
ConvertVerify = Annotated[bool, _option("--verify/--no-verify", "Simulate the charts for both tools, or do not.")]
ConvertLimit = Annotated[
    str,
    _option("--limit", "Simulate the charts for both tools for so long; auto: 0.1 s a step, at least 20 s.", "TIME"),
]
Charts = Annotated[
    bool | None, _option("--charts/--no-charts", "Outline each chart. The default is to do so for few charts.")
]

# -- pictures ---------------------------------------------------------------------------------------------------------

PictureStyle = Annotated[
    str | None,
    _option("--style", "Draw as in iec, grafcet or s7graph. The default is what the chart is of.", "STYLE"),
]
PictureFormat = Annotated[
    str | None,
    _option("--to", "Write svg, png, pdf, mermaid or dot. The default is the extension of DST, else svg.", "FORMAT"),
]
Against = Annotated[
    str | None, _option("--against", "Run the chart against that of this file, and mark what was not reached.", "FILE")
]
AgainstLimit = Annotated[str, _option("--limit", "With --against, run the chart for no longer than this.", "TIME")]
PageLanguage = Annotated[str, _option("--lang", "Write headings of the page in en or de.", "LANG")]
FreshLayout = Annotated[bool, _option("--fresh", "Lay charts out, also where the file has places for them.")]
Paper = Annotated[
    str | None,
    _option("--paper", "Divide large pictures into sheets of A4, A3 or letter: pages of a PDF, else files.", "PAPER"),
]
Theme = Annotated[str, _option("--theme", "Draw in light or dark colours, or in black on white: print.", "THEME")]

# -- rules ------------------------------------------------------------------------------------------------------------

Codes = Annotated[list[str] | None, typer.Argument(metavar="[CODE]...", help="Explain these rules: STR, SEL01 ..")]
Select = Annotated[list[str] | None, _option("--select", "Apply these rules only: STR, SEL01 ..", "CODES")]
Ignore = Annotated[list[str] | None, _option("--ignore", "Leave out these rules.", "CODES")]
FailOn = Annotated[
    str | None,
    _option("--fail-on", "End with exit code 1 from this severity on: error, warning (default), info, never.",
            "SEVERITY"),
]  # fmt: skip
Form = Annotated[
    str, _option("--format", "Print the result as text, json, sarif (2.1.0), or github (annotations).", "FORMAT")
]
Markdown = Annotated[bool, _option("--markdown", "Print the page docs/checks.md.")]

# -- comparing --------------------------------------------------------------------------------------------------------

Before = Annotated[str, typer.Argument(metavar="A", help="A file, a folder, or - for standard input.")]
After = Annotated[str, typer.Argument(metavar="B", help="The same, later.")]
Layout = Annotated[
    bool, _option("--layout", "Also list what is not executed: positions, other text of the same meaning.")
]
Prove = Annotated[bool, _option("--prove", "Compare changed charts by running them.")]
ProveLimit = Annotated[str, _option("--limit", "With --prove, run a chart for no longer than this.", "TIME")]
DiffHtml = Annotated[Path | None, _option("--html", "Save a page with the changed charts beside each other.", "FILE")]
ExitCode = Annotated[bool, _option("--exit-code", "End with exit code 1 if there are differences.")]

Patterns = Annotated[
    list[str] | None,
    typer.Argument(metavar="[PATTERN]...", help="The files to compare so. The default are those of all formats."),
]
Merged = Annotated[str, typer.Argument(help="The four names from git: %O %A %B %P.")]
Undo = Annotated[bool, _option("--undo", "Take out again what was written.")]

# -- renaming ---------------------------------------------------------------------------------------------------------

RenamedFiles = Annotated[
    "ManyFiles",
    typer.Argument(
        metavar="FILE... [OLD NEW]",
        help="Files, folders, patterns, @list.txt (@-: standard input), or -; then the object (Main, Main.S3, GVL.x, "
        "Type.member) and its new name, if no table has them.",
    ),
]
NameTable = Annotated[
    Path | None,
    _option("--table", "Rename what this table has: a path and a new name in each row.", "FILE.csv|.xlsx"),
]

Start = Annotated[int, _option("--start", "The number of the first step.")]
Increment = Annotated[int, _option("--increment", "The difference between two steps.")]
NamesOfSteps = Annotated[str, _option("--names", "Name the steps too: S{number}, S{number:03}_{name}.")]

# -- step lists -------------------------------------------------------------------------------------------------------

StepList = Annotated[str, typer.Argument(metavar="LIST", help="A step list, .xlsx or .csv.")]
ListedFile = Annotated[str, typer.Argument(metavar="FILE", help="The file or folder that it is a list of.")]

# -- scripts ----------------------------------------------------------------------------------------------------------

Script = Annotated[
    str,
    typer.Argument(metavar="SCRIPT", help="A Python file with a function refactor(project), or the name of a plugin."),
]
ScriptSettings = Annotated[list[str] | None, _option("--set", "Give the script a setting. Repeatable.", "NAME=VALUE")]
Write = Annotated[bool, _option("--write", "Change the files; without it only show what would change.")]
Patch = Annotated[Path | None, _option("--diff", "Write the changes as a unified diff without context.", "FILE")]
Scheduler = Annotated[str, _option("--scheduler", "Use the workers of a Dask scheduler.", "tcp://HOST:PORT")]
ProveSame = Annotated[
    bool, _option("--prove", "Change only files that do the same: proven, or run through all that changed.")
]
Journal = Annotated[
    Path | None, _option("--resume", "Keep what is done in this file, and leave it out when run again.", "FILE")
]
FileJobs = Annotated[int, _option("--jobs", "Work on so many files at a time, each in a process.", "N", min=1)]

# -- simulating -------------------------------------------------------------------------------------------------------

Inputs = Annotated[
    str | None, _option("--inputs", "Take inputs from this file: a column each, a row for each scan.", "FILE.csv")
]
Seed = Annotated[int | None, _option("--seed", "Make random inputs, the same for the same number.", "N")]
SystemInputs = Annotated[
    bool, _option("--system-inputs", "With --seed, also change inputs that operate the chart (INIT_SQ, SFCInit).")
]
Scans = Annotated[
    int | None, _option("--scans", "Run so many scans. The default is as many as there are inputs, or 100.", "N", min=0)
]
ScanTime = Annotated[str, _option("--scan-time", "The time from scan to scan.", "TIME")]
Settings = Annotated[
    list[str] | None, _option("--set", "Give a variable a value before the first scan. Repeatable.", "NAME=VALUE")
]
Record = Annotated[list[str] | None, _option("--record", "Record only this variable. Repeatable.", "NAME")]
Csv = Annotated[Path | None, _option("--csv", "Save every scan as CSV.", "FILE")]
TraceSvg = Annotated[Path | None, _option("--svg", "Save a timing diagram of steps, inputs and outputs.", "FILE")]
TraceHtml = Annotated[
    Path | None, _option("--html", "Save a page of the project on which the run can be played.", "FILE")
]
Vcd = Annotated[Path | None, _option("--vcd", "Save a wave file for GTKWave.", "FILE")]

# -- lowering ---------------------------------------------------------------------------------------------------------

Construction = Annotated[str, _option("--as", "Make flipflop (fup), case, regions, bits, or what fits: auto.", "FORM")]
Style = Annotated[str, _option("--style", "Make exact code, or classic as in textbooks.", "STYLE")]
Language = Annotated[
    str | None, _option("--language", "Write ST, FBD, LD or IL. The default is FBD for flip-flops, ST in text.", "LANG")
]
Init = Annotated[
    str | None, _option("--init", "Add an input of this name that restarts the sequence; classic has Init.", "NAME")
]
NoInit = Annotated[bool, _option("--no-init", "Add no such input to classic forms; they start in the first scan.")]
Stop = Annotated[
    str | None,
    _option("--stop", "On this condition (emergency stop) activate only the initial step.", "CONDITION"),
]
ResetActions = Annotated[bool, _option("--reset-actions", "Make --init and --stop end stored actions too.")]
States = Annotated[
    str | None,
    _option("--states", "Write states of a CASE as numbers, constants or enumeration; usual are names.", "KIND"),
]
Actions = Annotated[str, _option("--actions", "Write actions inline, or in a block of their own: block.", "PLACE")]
FlagNames = Annotated[str, _option("--flag-names", "Call step flags like that of step 1, such as SR01.", "NAME")]
Flags = Annotated[
    str, _option("--flags", "Put step flags local, to M20.0 (charts: G1=M20.0,G2=M24.0), or in a data block.", "PLACE")
]
Modes = Annotated[
    list[str] | None, _option("--mode", "Add inputs for enable, single-step, advance or select. Repeatable.", "MODE")
]
AtRest = Annotated[
    list[str] | None,
    _option("--at-rest", "Write no code for these inputs of S7-GRAPH (S_ON,S_OFF), or for all. Repeatable.", "NAME"),
]
ConvertAtRest = Annotated[
    list[str] | None,
    _option("--at-rest", "Nobody operates these inputs of S7-GRAPH (S_ON,S_OFF), or all. Repeatable.", "NAME"),
]
TextLanguage = Annotated[str, _option("--lang", "Write titles and comments in en or de.", "LANG")]
Verify = Annotated[bool, _option("--verify/--no-verify", "Compare the code with the chart, or do not.")]
SkipRefused = Annotated[bool, _option("--skip-refused", "Leave charts that cannot be lowered as they are.")]

# -- the options of commands with many of them, in the order in which help lists them ---------------------------------


@dataclass(frozen=True)
class ConvertOptions:
    """Options of `convert`; the first are those of `plcopen_sfc.save`."""

    to: ToFormats = None
    flavour: For = ""
    tia: Tia = ""
    partial: Partial = False
    strict: Strict = False
    fresh: Fresh = False
    normalize: Normalize = False
    verify: ConvertVerify = True
    limit: ConvertLimit = "auto"
    at_rest: ConvertAtRest = None
    as_tool: AsTool = False
    accept_errors: AcceptErrors = False
    accept_untested: AcceptUntested = False
    report: ConvertReport = None
    lang: PageLanguage = "en"
    resume: Journal = None

    @property
    def page(self) -> Path | None:
        """The page that is asked for in place of a report in JSON."""
        return self.report if self.report is not None and self.report.suffix.casefold() in {".html", ".htm"} else None


@dataclass(frozen=True)
class DiffOptions:
    """Options of `diff`."""

    layout: Layout = False
    prove: Prove = False
    limit: ProveLimit = "30s"
    exit_code: ExitCode = False
    html: DiffHtml = None
    lang: PageLanguage = "en"
    jobs: FileJobs = 1


@dataclass(frozen=True)
class PageOptions:
    """Options of `page`: its language, and the file that the chart or program `pou` is compared with."""

    lang: PageLanguage = "en"
    against: Against = None
    pou: PouName = None
    limit: AgainstLimit = "30s"


@dataclass(frozen=True)
class SimulateOptions:
    """Options of `simulate`. The last ones are the files to save the trace in, and the language of the page."""

    pou: PouName = None
    inputs: Inputs = None
    seed: Seed = None
    system_inputs: SystemInputs = False
    scans: Scans = None
    scan_time: ScanTime = "10ms"
    profile: Profile = None
    settings: Settings = None
    record: Record = None
    free: Free = None
    functions: Functions = None
    as_tool: AsTool = False
    csv: Csv = None
    vcd: Vcd = None
    svg: TraceSvg = None
    html: TraceHtml = None
    lang: PageLanguage = "en"

    @property
    def written(self) -> list[Path]:
        """The files that are asked for."""
        return [path for path in (self.csv, self.vcd, self.svg, self.html) if path is not None]


@dataclass(frozen=True)
class LowerOptions:
    """Options of `lower`."""

    to: To = ""
    flavour: For = ""
    pou: PouName = None
    construction: Construction = "auto"
    style: Style = "exact"
    language: Language = None
    profile: Profile = None
    init: Init = None
    no_init: NoInit = False
    stop: Stop = None
    reset_actions: ResetActions = False
    states: States = None
    actions: Actions = "inline"
    flags: Flags = "local"
    flag_names: FlagNames = ""
    modes: Modes = None
    at_rest: AtRest = None
    free: Free = None
    functions: Functions = None
    lang: TextLanguage = "en"
    verify: Verify = True
    accept_untested: AcceptUntested = False
    limit: Limit = None
    jobs: Jobs = 1
    skip_refused: SkipRefused = False
    partial: Partial = False
    tia: Tia = ""
    accept_errors: AcceptErrors = False
