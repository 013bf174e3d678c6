"""``plcopen-sfc rename``, ``renumber``, ``merge``, ``apply``, ``normalize``: commands that change files in place.

All but `normalize` are edits of projects, which `plcopen_sfc.batch.apply` makes in many files.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any

from plcopen_sfc.api import save
from plcopen_sfc.batch import AppliedFile, FileChange, apply, difference, documents_in, patch_of, script_edit
from plcopen_sfc.cli.command_files import STANDARD_STREAM, load_and_tell, load_input, read_input, written_to_stdout
from plcopen_sfc.cli.many_files import ManyFiles, PrintedLine, RecordedScreen, for_each, replay, show_counts
from plcopen_sfc.cli.screen import UNREADABLE, Screen, Table
from plcopen_sfc.documents.folder_projects import edited_files
from plcopen_sfc.documents.list_merging import merge_list
from plcopen_sfc.documents.name_tables import read_names
from plcopen_sfc.documents.sources import FolderSource
from plcopen_sfc.errors import InputError, ModelError, ScriptError
from plcopen_sfc.files import folder_exists, read_bytes, write_atomic
from plcopen_sfc.formats.file_recognition import recognise
from plcopen_sfc.languages.binding import Names, Use
from plcopen_sfc.languages.binding.name_scopes import with_inner_charts
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import LOSSES, Item, Outcome, RenameResult
from plcopen_sfc.whole_numbers import counted

_FINDINGS = 1
_SHOWN = 20
_UNREAD_DOCUMENT = "DIR101"
DIFF_STYLES = {"+": "green", "-": "red", "@": "cyan"}


@dataclass(frozen=True)
class EditOptions:
    """Options of a run: those of `plcopen_sfc.batch.apply`. `diff` gets a unified diff of all changes.

    Commands that have `dry_run` write without it, the others with `write`.
    """

    dry_run: bool | None = None
    write: bool = False
    diff: Path | None = None
    scheduler: str = ""
    prove: bool = False
    resume: Path | None = None
    limit: str | None = None

    @property
    def writes(self) -> bool:
        """True if files are changed."""
        return self.write if self.dry_run is None else not self.dry_run


@dataclass(frozen=True)
class _Edit(ABC):
    """A change of a project by a command. Called for each file, in a process of its own if there are several."""

    def __call__(self, project: Project) -> tuple[dict[str, Any], RecordedScreen]:
        """Edit a project; return the report on it, and what is printed."""
        screen = RecordedScreen(verbose=1)
        return self.on(screen, project), screen

    @abstractmethod
    def on(self, screen: Screen, project: Project) -> dict[str, Any]:
        """Edit a project, tell it on the screen, and return the report; findings set the exit code."""


@dataclass(frozen=True)
class _Rename(_Edit):
    old: str
    new: str

    def on(self, screen: Screen, project: Project) -> dict[str, Any]:
        _tell_unread(screen, project)
        return _tell_renamed(screen, project.rename(self.old, self.new), self.old)


@dataclass(frozen=True)
class _RenameMany(_Edit):
    """The new names of `table` by the paths of what gets them; those that a project does not have are told."""

    table: Mapping[str, str]

    def on(self, screen: Screen, project: Project) -> dict[str, Any]:
        _tell_unread(screen, project)
        names = Names(project)
        known = {path: new for path, new in self.table.items() if names.find(path)}
        missing = [path for path in self.table if path not in known]
        results = project.rename_many(known)
        renamed = [_tell_renamed(screen, result, path) for path, result in zip(known, results, strict=True)]
        if missing:
            screen.note(f"{len(missing)} of {len(self.table)} names of the table are not declared here:")
            for path in missing:
                screen.note(f"  {path}")
        if not known:
            screen.exit_code = _FINDINGS
        return {"renamed": renamed, "missing": missing}


def _tell_renamed(screen: Screen, result: RenameResult, old: str) -> dict[str, Any]:
    """Tell a renaming of the path `old` on the screen, and return the report on it."""
    count = len(result.changed)
    places = f"{counted(count, 'place')} that name{'s' if count == 1 else ''} it changed too"
    screen.line((result.path, "bold"), " is called ", (result.new, "bold"), f" now, {places}")
    for use in result.changed:
        screen.line(f"  {use}")
    if result.undecided:
        screen.exit_code = _FINDINGS
        screen.note(f"these places have the name {old} too; look whether they mean {result.path}:")
        for undecided in result.undecided:
            screen.note(f"  {undecided}")
    return {
        "path": result.path,
        "old": result.old,
        "new": result.new,
        "changed": [_use(use) for use in result.changed],
        "undecided": [_use(undecided.use) | {"reason": undecided.reason} for undecided in result.undecided],
    }


def _use(use: Use) -> dict[str, Any]:
    return {name: getattr(use, name) for name in ("path", "language", "line", "column", "text")}


@dataclass(frozen=True)
class _Renumber(_Edit):
    """Arguments of `Editor.renumber`, and the POU whose charts are numbered (empty: all)."""

    start: int
    increment: int
    names: str
    pou: str

    def on(self, screen: Screen, project: Project) -> dict[str, Any]:
        _tell_unread(screen, project)
        found, wanted = [*project.charts()], self.pou.casefold()
        meant = [each.chart for each in found if wanted in ("", each.name.casefold(), each.pou.name.casefold())]
        charts = [inner for each in meant for inner in with_inner_charts(each)]
        if not charts:
            known = ", ".join(each.name for each in found)
            raise ModelError(
                f"there is no chart {self.pou!r}", hint=f"There are: {known}" if known else "There is none."
            )
        if not self.names and not project.tool_format.startswith("grafcet"):  # whose numbers are names
            charts = [each for each in charts if any(step.number is not None for step in each.steps)]
        if not charts:
            raise ModelError("there is no chart with numbers", hint='Give names: --names "S{number}".')
        before = [(step, step.name, step.number) for chart in charts for step in chart.steps]
        numbered = [(chart, each, each.number) for chart in charts for each in chart.transitions if each.number]
        project.edit().renumber(self.start, self.increment, charts=charts, names=self.names)
        changed = [(step, name) for step, name, number in before if (step.name, step.number) != (name, number)]
        screen.line(f"{len(changed)} of {len(before)} steps have other numbers or names")
        for step, name in changed:
            screen.line(f"  {name} -> {step.name}" + (f", number {step.number}" if step.number is not None else ""))
        others = [(chart.label(each), number, each.number) for chart, each, number in numbered if number != each.number]
        if others:
            screen.line(f"{len(others)} of {len(numbered)} transitions have other numbers, along the flow as the steps")
            for label, old, new in others:
                screen.line(f"  {label}, number {old} -> {new}")
        return {
            "changed": [{"old": name, "name": step.name, "number": step.number} for step, name in changed],
            "transitions": [{"name": label, "old": old, "number": new} for label, old, new in others],
        }


@dataclass(frozen=True)
class _Merge(_Edit):
    """Edits of a step list, the path of which is `source`."""

    source: str

    def on(self, screen: Screen, project: Project) -> dict[str, Any]:
        edited = load_and_tell(screen, self.source)
        changes = merge_list(project, edited)
        for change in changes or ["the list changes nothing"]:
            screen.line(change)
        return {"list": self.source, "changes": changes}


@dataclass(frozen=True)
class _Scripted(_Edit):
    """A script, or the plugin of this name, with its settings."""

    script: str
    settings: Mapping[str, str]

    def on(self, screen: Screen, project: Project) -> dict[str, Any]:  # noqa: ARG002
        script_edit(self.script, self.settings)(project)
        return {}


def _tell_unread(screen: Screen, project: Project) -> None:
    """Tell of documents of a folder that could not be read: what is edited may be named in them too."""
    if isinstance(project.source, FolderSource):
        for finding in project.diagnostics:
            if finding.code == _UNREAD_DOCUMENT:
                screen.finding(finding, result=False)


def rename(screen: Screen, files: ManyFiles, table: Path | None, how: EditOptions) -> int:
    """Rename what the last two of `files` tell, or a `table`, in files; with `dry_run` only show what would change."""
    if table is not None:
        return _edit(screen, files, _RenameMany(read_names(table)), how)
    if len(files.named) < len(("FILE", "OLD", "NEW")):
        hint = "Write FILE... OLD NEW, or FILE... --table names.csv with OLD and NEW in each row."
        raise InputError("a file, an object and its new name are needed", hint=hint)
    *named, old, new = files.named
    return _edit(screen, ManyFiles(tuple(named), files.jobs), _Rename(old, new), how)


def renumber(
    screen: Screen, files: ManyFiles, how: EditOptions, *, start: int, increment: int, names: str, pou: str | None
) -> int:
    """Renumber the charts in files."""
    return _edit(screen, files, _Renumber(start, increment, names, pou or ""), how)


def merge(screen: Screen, source: str, file: str, how: EditOptions) -> int:
    """Merge the step list `source` into `file`."""
    return _edit(screen, ManyFiles((file,)), _Merge(source), how)


def run_script(screen: Screen, script: str, files: ManyFiles, settings: Sequence[str] | None, how: EditOptions) -> int:
    """Run a script, or the plugin of this name, on files."""
    given = dict(map(_setting, settings or ()))
    if files.named == (STANDARD_STREAM,):
        if how.prove:
            raise InputError("--prove needs a file: what is read from standard input has no other version")
        return _edit_stream(screen, _Scripted(script, given), how)
    return _edit_many(screen, files, script, given, how)


def _setting(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise ScriptError(f"a setting is NAME=VALUE, not {text!r}")
    return name, value


# -- one file ---------------------------------------------------------------------------------------------------------


def _edit(screen: Screen, files: ManyFiles, edit: _Edit, how: EditOptions) -> int:
    """Edit files. Of one alone all is told, or with a dry run the diff; ``-`` goes to standard output."""
    if not files.alone or how.resume is not None:
        return _edit_many(screen, files, edit, {}, how)
    (file,) = files.named
    if file == STANDARD_STREAM:
        return _edit_stream(screen, edit, how)
    (done,) = apply(edit, [file], write=how.writes)
    if done.error:
        screen.complain(done.error)
        return UNREADABLE
    data, told = done.returned
    diff = [line for change in done.changes for line in difference(change)] if not how.writes else []
    written = [change.path for change in done.changes if change.after] if how.writes else []
    _tell_alone(screen, told, diff, written, done.lost)
    screen.result({"file": file} | data | _outcome(diff, written, done.lost, how))
    screen.exit_code = max(screen.exit_code, told.exit_code)
    return screen.exit_code


def _edit_stream(screen: Screen, edit: _Edit, how: EditOptions) -> int:
    project = load_input(screen, STANDARD_STREAM)
    data, told = edit(project)
    diff, written, lost = [], [], []
    if how.writes:
        with written_to_stdout(screen, STANDARD_STREAM, "") as target:
            report = save(project, target, format=project.source.format if project.source is not None else None)
        written, lost = [STANDARD_STREAM], report.with_outcome(*LOSSES, Outcome.DROPPED)
    else:
        diff = [line for each in edited_files(project, STANDARD_STREAM) for line in difference(FileChange(*each))]
    _tell_alone(screen, told, diff, written, lost)
    screen.result({"file": STANDARD_STREAM} | data | _outcome(diff, written, lost, how))
    screen.exit_code = max(screen.exit_code, told.exit_code)
    return screen.exit_code


def _outcome(diff: list[str], written: list[str], lost: Sequence[Item], how: EditOptions) -> dict[str, Any]:
    if not how.writes:
        return {"diff": diff}
    return {"written": written, "losses": [f"{item.place}: {item.why}" for item in lost if item.outcome in LOSSES]}


def _tell_alone(
    screen: Screen, told: RecordedScreen, diff: list[str], written: list[str], lost: Sequence[Item]
) -> None:
    """Print the diff of a dry run, or what was changed and written."""
    is_shown = not screen.as_json and not screen.quiet
    shown = told.printed
    results = [each for each in shown if isinstance(each, Table) or not each.message]
    if len(results) > _SHOWN and not screen.verbose:
        shown = [each for each in shown if each not in results[_SHOWN:]]
        shown.append(PrintedLine([(f"  .. and {len(results) - _SHOWN} more: --verbose shows all", "")]))
    replay(screen, shown, results=is_shown and not diff)
    for line in diff if not screen.as_json else ():
        screen.line((line, DIFF_STYLES.get(line[:1], "")))
    for name in written if is_shown else ():
        screen.line("written: ", (name, "bold"))
    for item in lost:
        screen.note(f"{item.place}: {item.why}")


# -- many files -------------------------------------------------------------------------------------------------------


def _edit_many(screen: Screen, files: ManyFiles, edit: str | _Edit, settings: dict[str, str], how: EditOptions) -> int:
    paths = [*files.found]
    if STANDARD_STREAM in paths:
        raise InputError("standard input cannot be one of many files", hint="A list of files is @-.")
    outcomes: Counter[str] = Counter()
    errors: dict[str, str] = {}
    data: list[dict[str, Any]] = []
    patches: list[bytes] = []
    done = apply(
        edit,
        paths,
        settings=settings,
        write=how.writes,
        jobs=files.jobs,
        scheduler=how.scheduler,
        prove=how.prove,
        limit=how.limit,
        journal=str(how.resume) if how.resume is not None else None,
    )
    for each in screen.progress(done, "Editing", len(paths)):
        outcome = (
            "failed" if each.error else "done before" if each.resumed else "changed" if each.changes else "unchanged"
        )
        outcomes[outcome] += 1
        if each.error:
            errors[each.path] = each.error
            screen.exit_code = max(screen.exit_code, _FINDINGS if each.proofs else UNREADABLE)
        diff = [line for change in each.changes for line in difference(change)]
        patches += map(patch_of, each.changes) if how.diff is not None else ()
        own, told = each.returned if each.returned is not None and not isinstance(edit, str) else ({}, None)
        proofs = {"proofs": [proof.as_dict() for proof in each.proofs]} if how.prove else {}
        data.append({"file": each.path, "outcome": outcome, "error": each.error, "diff": diff, **own, **proofs})
        if told is not None:
            screen.exit_code = max(screen.exit_code, told.exit_code)
        _tell_one_of_many(screen, each, told, diff)
    if how.diff is not None:
        write_atomic(str(how.diff), b"".join(patches))
    names = ["changed", "unchanged", "failed", *(["done before"] if outcomes["done before"] else [])]
    unwritten = (
        ""
        if how.writes or not outcomes["changed"]
        else "; nothing is written " + ("without --write" if isinstance(edit, str) else "with --dry-run")
    )
    show_counts(screen, {name: outcomes[name] for name in names}, errors, unwritten)
    screen.result({"files": data, "counts": dict(outcomes), "written": how.writes})
    return screen.exit_code


def _counts(diff: Sequence[str]) -> tuple[int, int]:
    """Return how many lines of a difference are new or changed, and how many are removed, with none in their place."""
    new, gone = 0, 0
    for is_hunk, lines in groupby(diff, key=lambda line: line.startswith(("+", "-")) and line[:4] not in _HEADS):
        signs = Counter(line[0] for line in lines if is_hunk)
        new += signs["+"]
        gone += max(0, signs["-"] - signs["+"])
    return new, gone


_HEADS = ("+++ ", "--- ")


def _tell_one_of_many(screen: Screen, done: AppliedFile, told: RecordedScreen | None, diff: list[str]) -> None:
    if done.error:
        screen.note(
            f"failed: {done.error}" if done.error.startswith(done.path) else f"failed: {done.path}: {done.error}"
        )
    is_shown = not screen.as_json and not screen.quiet
    if is_shown and done.changes:
        new, gone = _counts(diff)
        removed = f", {counted(gone, 'line')} removed" if gone else ""
        screen.line("changed: ", (done.path, "bold"), f", {counted(new, 'line')}{removed}")
    if told is not None:
        replay(screen, told.printed, results=is_shown and screen.verbose > 0)
    for proof in done.proofs if is_shown else ():
        screen.line(f"  {str(proof).splitlines()[0]}")
    for line in diff if is_shown and screen.verbose else ():
        screen.line((f"  {line}", DIFF_STYLES.get(line[:1], "")))
    for item in done.lost:
        screen.note(f"{done.path}: {item.place}: {item.why}")


# -- normalize --------------------------------------------------------------------------------------------------------


def normalize(screen: Screen, files: ManyFiles, *, dry_run: bool) -> int:
    """Remove what the tool of a file ignores, or with `dry_run` only list the files of which something would go."""
    if files.named == (STANDARD_STREAM,):
        return _normalize_stream(screen, dry_run=dry_run)
    work = partial(_normalize, dry_run)
    names = [each for path in files.found for each in (documents_in(path) if folder_exists(path) else [path])]
    outcomes = for_each(screen, names, work, "Normalising", jobs=files.jobs, told=False)
    screen.result({"files": [each.as_dict() for each in outcomes], "written": not dry_run})
    return screen.exit_code


def _normalize_stream(screen: Screen, *, dry_run: bool) -> int:
    """Write standard input without what its tool ignores to standard output; the exit code is 0, as filters need."""
    data = read_input()
    normalised = _normalised(data, STANDARD_STREAM)
    if dry_run:
        result = {"file": STANDARD_STREAM, "changed": normalised != data}
        screen.result({"files": [result], "written": False})
        return _tell_normalised(screen, result, dry_run=True)
    with written_to_stdout(screen, STANDARD_STREAM, "") as target:
        write_atomic(target, normalised)
    return screen.exit_code


def _normalize(dry_run: bool, screen: Screen, name: str) -> dict[str, Any]:
    data = read_bytes(name)
    normalised = _normalised(data, name)
    if normalised != data and not dry_run:
        write_atomic(name, normalised)
    result = {"file": name, "changed": normalised != data}
    _tell_normalised(screen, result, dry_run=dry_run)
    return result


def _normalised(data: bytes, name: str) -> bytes:
    """Return a file without what its tool ignores; the same where its format has no such parts."""
    normalised = recognise(data, file=name).codec().normalize(data)
    return data if normalised is None else normalised


def _tell_normalised(screen: Screen, result: Mapping[str, Any], *, dry_run: bool) -> int:
    if result["changed"]:
        screen.exit_code = _FINDINGS
        if not screen.as_json and not screen.quiet:
            screen.line("would be normalised: " if dry_run else "normalised: ", (result["file"], "bold"))
    return screen.exit_code
