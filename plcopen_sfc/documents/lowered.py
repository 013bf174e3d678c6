"""Lowered code in files: written as a draft, read back as its tool reads it, proven, and only then put in place.

A proof of the code in memory proves nothing of the file: a format may have no place for a part of it, and our readers
restore from comments what the tool never sees.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Unpack

from plcopen_sfc.analysis.equivalence import Searching
from plcopen_sfc.analysis.search_limits import SearchProgress
from plcopen_sfc.analysis.verdict import UntestedError
from plcopen_sfc.conversion.adaptation.grafcet_variables import with_declarable_variables
from plcopen_sfc.conversion.executed_parts import UNDECLARED, UNDECLARED_TYPE
from plcopen_sfc.documents.file_documents import refuse_losses
from plcopen_sfc.documents.legal_names import with_legal_names
from plcopen_sfc.documents.storage import (
    SaveOptions,
    Source,
    format_to_write,
    is_folder,
    load_project,
    save_project,
)
from plcopen_sfc.errors import LossError, LoweringError, check_argument
from plcopen_sfc.files import refuse_empty, resolved, write_atomic
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.languages.binding import names_in
from plcopen_sfc.languages.binding.name_uses import dialect_of
from plcopen_sfc.languages.s7_globals import tag_tables_of
from plcopen_sfc.languages.translation.renames import KeptNames, kept_names
from plcopen_sfc.lowering import LoweredPou, lower_project
from plcopen_sfc.lowering.chart_lowering import faults_of
from plcopen_sfc.lowering.construction import errors_of
from plcopen_sfc.lowering.enumeration_constants import with_enumeration_constants
from plcopen_sfc.lowering.lowering_options import LoweringOptions
from plcopen_sfc.lowering.proof import ProofOptions, refuse_untested
from plcopen_sfc.lowering.written_code import (
    prove_written,
    refuse_comments,
    refuse_uncompiled,
    uncompiled,
    with_headers,
)
from plcopen_sfc.model.pou import DataBlock, Pou
from plcopen_sfc.model.project import PouInstance, Project
from plcopen_sfc.model.types import DataTypeDeclaration, Variable
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.processes import results
from plcopen_sfc.reachability import reached
from plcopen_sfc.report import ARITHMETIC, FALLING_EDGE, ConversionReport, Outcome


@dataclass(frozen=True)
class LoweredFile:
    """A file with code of charts, or why there is none.

    `path`: the file or folder; None where nothing was written. `pous`: the charts that were lowered, with the proofs of
    the code in the file. `refused`: the errors of all others by the names of the charts. `report`: what became of the
    items of the project in the format.
    """

    path: str | None
    pous: tuple[LoweredPou, ...]
    refused: dict[str, LoweringError]
    report: ConversionReport

    def __repr__(self) -> str:
        names = ", ".join(each.name for each in self.pous[:_SHOWN]) + (" .." if len(self.pous) > _SHOWN else "")
        return f"LoweredFile({self.path!r}: {names or 'nothing'} lowered, {len(self.refused)} refused)"


_SHOWN = 8
_REMEDIES = {
    FALLING_EDGE: "R_TRIG with the negated input does the same in both.",
    ARITHMETIC: "Operands that are converted before (`INT_TO_DINT(n) + 1`) give the same in both.",
}
"""What makes the code of a chart do the same in another tool, by the kind of the difference in the report."""


def save_lowered(lowered: LoweredPou, target: Source, **options: Unpack[SaveOptions]) -> ConversionReport:
    """Save a project with lowered code, which is compared with its chart as the tool of the file reads it.

    Nothing is written where it is not proven. Code that was lowered with ``verify=False`` is saved as it is.

    Raises what `save_project` raises, `LoweringError` where exact code is different or not in the file as code, and
    `UntestedError` where not all of it was reached.
    """
    if lowered.proof_options is None:
        return save_project(lowered.project, target, **options)
    with tempfile.TemporaryDirectory() as folder:
        draft = _Draft(lowered.project, target, Path(folder), options)
        proven = draft.proven(lowered, lowered.proof_options)
        report = draft.put_in_place([proven])
    report.compared[lowered.pou.report_path_of(lowered.name)] = str(proven.proof)
    return report


def lower_to_file(
    project: Project,
    target: str,
    construction: str = "auto",
    *,
    format: str | None = None,
    flavour: str = "",
    tia: str = "",
    pou: str | None = None,
    skip_refused: bool = False,
    verify: bool = True,
    accept_untested: bool = False,
    free_inputs: Iterable[str] | str = (),
    functions: Mapping[str, Callable[..., Any]] | None = None,
    limit: float | str | None = None,
    progress: Callable[[SearchProgress], None] | None = None,
    jobs: int = 1,
    partial: bool = False,
    **options: Unpack[LoweringOptions],
) -> LoweredFile:
    """Lower all charts of a project, or the one called `pou`, save the project, and prove the file.

    `construction`, `verify` to `progress` and `options` as in `lower`, `format`, `flavour` and `tia` as in `save`. With
    a `flavour`, as in SCL, a file of one `pou` has that and what it needs. What the format does not hold is reported.
    Nothing is written where a chart is refused, in lowering or because its code in the file is not proven; with
    `skip_refused` such charts stay charts and the others are written. `jobs` charts are compared at a time, each in a
    process of its own; then there is no `progress`. Verdicts and their order do not depend on it.

    Raises `LossError` where the target does not execute something else of the project, unless `partial`.
    """
    check_argument(project, Project, "lower_to_file needs a project")
    check_argument(target, (str, os.PathLike), "lower_to_file needs the path to write to")
    check_argument(flavour, str, "a flavour is named by a text")
    check_argument(pou, (str, type(None)), "a POU is named by a text")
    check_argument(jobs, int, "jobs is a number of processes")
    name = format_to_write(project, format, tia, target)
    project, declared = with_declarable_variables(project, format_named(name)[0])
    project, renamed, legal = with_legal_names(project, format_named(name)[0], flavour)
    declared.items += legal.items
    if pou is not None:
        owner, dot, inner = pou.partition(".")
        pou = f"{renamed.get(owner.casefold(), owner)}{dot}{inner}"
    searching: Searching = {
        "free_inputs": free_inputs,
        "functions": functions or {},
        "limit": limit,
        "progress": progress,
    }
    proof_options = ProofOptions(accept_untested, searching) if verify else None
    refused: dict[str, LoweringError] = {}
    with tempfile.TemporaryDirectory() as folder:
        while True:
            lowered = lower_project(
                project, construction, pou=pou, without=refused, target=name, flavour=flavour, **options
            )
            refused |= lowered.refused
            if not lowered.pous:
                return LoweredFile(None, (), refused, ConversionReport())
            place = Path(folder) / str(len(refused))
            place.mkdir()
            alone = pou if name == "scl" or flavour else None
            asked_for, left_out = _asked_for(lowered.project, alone)
            draft = _Draft(asked_for, target, place, {"format": name, "flavour": flavour, "partial": True})
            draft.report.items += declared.items
            if not refused or skip_refused:
                draft.refuse_losses(lowered.pous, refused, partial=partial)
            for each in left_out:
                why = "it was not asked for, and nothing in the file needs it: the file has no such block"
                draft.report.add(Outcome.NOT_EXECUTED, "POU", each.report_path, why)
            pous, late = draft.all_proven(lowered.pous, proof_options, jobs)
            refused |= late
            stopped = any(isinstance(error, UntestedError) and error.verdict.interrupted for error in late.values())
            if late and skip_refused and not stopped:
                continue  # code of a refused chart is in the draft: all is lowered again without it
            if not pous or stopped or (refused and not skip_refused):
                return LoweredFile(None, pous, refused, draft.report)
            return LoweredFile(target, pous, refused, draft.put_in_place(pous))


class _Draft:
    """A project as it would be written to `target`, in a temporary `place`."""

    def __init__(self, project: Project, target: Source, place: Path, options: SaveOptions) -> None:
        self._target, self._options = target, options
        path = os.fspath(target) if isinstance(target, str | os.PathLike) else None
        if path is not None:
            refuse_empty(path)
        name = format_to_write(project, options.get("format"), options.get("tia", ""), path)
        self._format = format_named(name)[0].name
        self._project = with_enumeration_constants(project) if self._format == "scl" else project
        self._is_folder = path is not None and is_folder(path, project, name)
        self._path = place / (resolved(path).name if path is not None else "draft")
        self.report = save_project(self._project, f"{self._path}/" if self._is_folder else self._path, **options)

    def refuse_losses(
        self, lowered: Iterable[LoweredPou], refused: Mapping[str, LoweringError], *, partial: bool
    ) -> None:
        """Raise `LossError` where the target does not execute something, unless `partial`.

        Code that the target does not compile is refused with its chart. Names that the file does not declare may be in
        the project that it is for: they are only listed. Compilers of text (`flavour`) have nothing but the file.
        """
        own = {each.pou.report_path for each in lowered if uncompiled(self.report, each)}
        found = [item for item in self.report.items if ObjectPath.of(item.path).owner not in own]
        whole = {UNDECLARED, UNDECLARED_TYPE} if self._options.get("flavour") else set()
        items = [item for item in found if item.what in whole or item.what not in _DECLARED_ELSEWHERE]
        rest = replace(self.report, items=items)
        try:
            refuse_losses(rest, strict=False, partial=partial)
        except LossError as loss:
            loss.hint += "".join(f" {name} was not lowered: {error.message}." for name, error in refused.items())
            raise

    def all_proven(
        self, lowered: Iterable[LoweredPou], options: ProofOptions | None, jobs: int = 1
    ) -> tuple[tuple[LoweredPou, ...], dict[str, LoweringError]]:
        """Return the same with the proofs of their code in the draft, and errors by the names of charts.

        None as `options`: there are no proofs. After an interruption all others are returned as they were given.
        """
        seen = self._seen()
        if jobs > 1 and options is not None:  # nothing can be shown from another process
            options = options._replace(searching={**options.searching, "progress": None})
        found: dict[str, LoweredPou] = {each.name: each for each in lowered}
        refused: dict[str, LoweringError] = {}
        proven = partial(self._proven_or_refused, options, seen)
        for name, made in zip(list(found), results(proven, list(found.values()), jobs), strict=False):
            if isinstance(made, LoweredPou):
                found[name] = made
                continue
            refused[name] = made
            del found[name]
            if isinstance(made, UntestedError) and made.verdict.interrupted:
                break
        return tuple(found.values()), refused

    def _proven_or_refused(
        self, options: ProofOptions | None, seen: Project | None, lowered: LoweredPou
    ) -> LoweredPou | LoweringError:
        try:
            return self.proven(lowered, options, seen)
        except LoweringError as error:
            return error

    def proven(self, lowered: LoweredPou, options: ProofOptions | None, seen: Project | None = None) -> LoweredPou:
        """Return the same with the proof of its code in the draft, which `seen` is as its tool reads it."""
        chart = lowered.chart
        with errors_of(chart.project, chart.pou, chart.name):
            refuse_comments(self.report, lowered.name)
            seen = seen or self._seen()
            self._refuse_other_name(lowered)
            refuse_uncompiled(self.report, seen, lowered)
            if options is None:
                return lowered
            try:
                proof = prove_written(chart, lowered, seen, self._loaded, **options.searching)
            except LoweringError as error:
                place = chart.pou.report_path
                for item in self.report.with_outcome(Outcome.APPROXIMATED):
                    if item.what in _REMEDIES and (item.path == place or item.path.startswith(f"{place} / ")):
                        error.hint = f"A cause: {item.why}. {_REMEDIES[item.what]}"
                raise
            refuse_untested(lowered.name, proof, accepted=options.accept_untested)
        return replace(lowered, proof=proof, faults=faults_of(chart, lowered))

    def _refuse_other_name(self, lowered: LoweredPou) -> None:
        """Raise `LoweringError` for a program that is a block in the draft: its variables are inputs of that."""
        rows = kept_names(self._loaded(), KeptNames.PROGRAMS)
        block = next((block for name, block, _ in rows if block and name == lowered.pou.name), "")
        if block:
            raise LoweringError(
                f"others call the program or name its variables, so that it is the function block {block} in the file: "
                "that cannot be compared with the chart",
                hint="Make it a function block with inputs and outputs before, or take a format of its own tool.",
            )

    def _seen(self) -> Project:
        return self._loaded(as_tool=True)

    def _loaded(self, *, as_tool: bool = False) -> Project:
        found = load_project(self._path, format=self._format, as_tool=as_tool)
        if self._format == "scl":  # declares no tags: they are in the project that the source is for
            found.tag_tables = [table.model_copy(deep=True) for table in tag_tables_of(self._project)]
        return found

    def put_in_place(self, lowered: Iterable[LoweredPou]) -> ConversionReport:
        """Write what the draft holds to the target, with a header at the code of each of `lowered`."""
        headed = with_headers(self._project, lowered)
        if self._is_folder:  # a folder that exists keeps the files that are none of the project's
            return save_project(headed, self._target, **self._options)
        save_project(headed, self._path, **self._options)
        content = self._path.read_bytes()
        if isinstance(self._target, str | os.PathLike):
            write_atomic(self._target, content)
            self.report.written = [os.fspath(self._target)]
        else:
            self._target.write(content)
            self.report.written = []
        return self.report


_DECLARED_ELSEWHERE = frozenset({UNDECLARED, UNDECLARED_TYPE, "global variable", "tag_tables", "tags"})


def _asked_for(project: Project, pou: str | None) -> tuple[Project, list[Pou]]:
    """Return the project without the POUs that were not asked for, and these; None: all are.

    Only what the POU called `pou` names stays, and what that names in turn: POUs, types and global variables. Facts
    about the project it came from are none of the code.
    """
    if pou is None:
        return project, []
    copy = project.model_copy(deep=True)
    needed = _needed(copy, pou.partition(".")[0])
    left_out = [each for each in project.pous if each.name.casefold() not in needed]
    copy.pous = [each for each in copy.pous if each.name.casefold() in needed]
    copy.data_types = [each for each in copy.data_types if each.name.casefold() in needed]
    for field in _FACTS:
        setattr(copy, field, Project.model_fields[field].get_default(call_default_factory=True))
    for section in copy.global_sections():
        section.variables = [each for each in section.variables if each.name.replace('"', "").casefold() in needed]
    for resource in copy.resources():
        resource.instances = _instances_of(needed, resource.instances)
        running = [task for task in resource.tasks if task.instances]
        for task in running:
            task.instances = _instances_of(needed, task.instances)
        # a task without instances of its own may be what those of the resource are run by
        resource.tasks = [t for t in resource.tasks if t.instances or (t not in running and resource.instances)]
    copy.global_variables = [each for each in copy.global_variables if each.variables]
    return copy, left_out


_FACTS = "name header version modified organization author language content_comment content_extension_data tree".split()


def _instances_of(needed: set[str], instances: Iterable[PouInstance]) -> list[PouInstance]:
    return [each for each in instances if (each.type_name or each.name).casefold() in needed]


def _needed(project: Project, pou: str) -> set[str]:
    """Return the declarations that a POU needs, itself included: in lower case, by the names in its texts."""
    variables = [each for section in project.global_sections() for each in section.variables]
    things: list[Pou | DataTypeDeclaration | DataBlock | Variable]
    things = [*project.pous, *project.data_types, *project.data_blocks, *variables]
    by_name = {each.name.replace('"', "").casefold(): each for each in things}
    dialect = dialect_of(project)

    def named_in(name: str) -> set[str]:
        return {each.replace('"', "").casefold() for each in names_in(by_name[name], dialect)} & by_name.keys()

    return reached([pou.casefold()], named_in)
