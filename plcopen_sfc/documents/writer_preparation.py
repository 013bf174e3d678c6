"""Preparation of a project for the writer of a format: a copy in the dialect and the terms of the target, drawn."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.conversion import Part, executed
from plcopen_sfc.conversion.adaptation import rewrite_project
from plcopen_sfc.conversion.adaptation.called_methods import adapt_calls
from plcopen_sfc.conversion.adaptation.extended_types import include_bases
from plcopen_sfc.conversion.adaptation.main_programs import give_task, take_task
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.documents.legal_names import give_legal_names
from plcopen_sfc.documents.target_differences import has_task_configuration, note_differences, note_final_scans
from plcopen_sfc.formats.format_interface import Codec, DrawingNeed, Format, NetworkForm, WriteOptions
from plcopen_sfc.formats.matiec.matiec_library import count_in_seconds
from plcopen_sfc.formats.registry import TIA_FORMAT, format_named
from plcopen_sfc.languages.library_blocks import library_blocks, put_flip_flops
from plcopen_sfc.languages.networks.exported_networks import EXPORTS
from plcopen_sfc.languages.s7_boxes import translate_boxes
from plcopen_sfc.languages.s7_programs import has_results, name_results
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import COUNTING_BYTES, Dialect, address_dialect
from plcopen_sfc.model.network import BlockCall
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.text import is_direct
from plcopen_sfc.report import ConversionReport, Item, Outcome
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import (
    PROFILES,
    Profile,
    StepVariables,
    default_profile,
    format_of_profile,
    have_equal_rules,
    profile_as,
    profile_of_format,
)

if TYPE_CHECKING:
    from plcopen_sfc.refactor.declaration_translation import TranslatedText


class Prepared(NamedTuple):
    """A project for a writer: a copy with its texts in the dialect of the target, and with the drawings it needs.

    `meant` is the meaning of the written file when this package reads it: the copy itself, unless the format writes
    some things in other terms; `options` are those to write with. `behaviour` is everything that is executed of the
    project, before anything but the dialect was adapted to the target; None where no tool executes such files.
    """

    project: Project
    meant: Project
    options: WriteOptions
    behaviour: Part | None


def prepared(project: Project, kind: Format, options: WriteOptions, report: ConversionReport) -> Prepared:
    """Return a copy of `project` for the writer of the format `kind`."""
    dialect = _dialect(project, kind, options)
    addresses = _address_dialect(project, kind, dialect)
    if kind.tool and not options.same:
        note_differences(project, kind, options, dialect, report)
    if not options.same and profile_of_format(kind.name).grafcet_terms:
        note_final_scans(project, report)
    of_grafcet = not options.same and is_put_into_sfc(project, kind)
    origin = _origin(project, kind, options, of_grafcet=of_grafcet)
    same_words = dialect in (None, project.dialect) and addresses is project.address_dialect
    if same_words and not of_grafcet and _stays(project, kind, options):
        behaviour = executed(project, at_rest=options.at_rest) if kind.tool else None
        same = project if origin == project.origin else project.model_copy(update={"origin": origin})
        return Prepared(same, same, options, behaviour)
    copy = project.model_copy(deep=True)
    copy.origin = origin
    if _names_results(project, kind):
        name_results(copy, report)
    if project.tool_format == EXPORTS != kind.name and kind.tool:
        if not has_task_configuration(project):
            give_task(copy, report)
        from plcopen_sfc.formats.codesys23.exp_language import name_truncations  # noqa: PLC0415  # of CoDeSys 2.3 alone

        name_truncations(copy, report)
    if kind.name == EXPORTS and not options.same:
        take_task(copy, report)
    if kind.tool and not options.same:
        # letters of a GRAFCET follow rules of their own
        give_legal_names(copy, kind, report, with_letters=not of_grafcet)
        _write_calls_as_statements(copy, kind, dialect, options, report)
        if not kind.extends:
            include_bases(copy, report)
        adapt_calls(copy, dialect, kind.tool, report, with_instances=not options.flavour)
    if dialect is Dialect.SCL and project.dialect is not Dialect.SCL and not options.same:
        _add_flip_flops(copy, report)
    if kind.xml and kind.name != TIA_FORMAT and project.dialect is Dialect.SCL and dialect not in (None, Dialect.SCL):
        translate_boxes(copy, dialect, kind.tool, report)
    if of_grafcet:
        _put_into_sfc(copy, kind, report)
    profile = PROFILES["iec"] if of_grafcet else default_profile(project)  # the words of the copy
    options = replace(for_source(options, profile), of_grafcet=of_grafcet)
    if profile.graph_parameters and kind.name != TIA_FORMAT:
        _mark_first_steps(copy, kind, report)
    if _has_flags(kind) is not _has_flags(project):
        _put_into_notation(copy, kind, report)
    _put_texts_into_words(copy, kind, options, report, dialect=dialect, addresses=addresses)
    if kind.tool and not options.same:
        give_legal_names(copy, kind, report, with_letters=False, of_s7=project.dialect is Dialect.SCL)
    _renumber_addresses(copy, project.address_dialect, addresses, report)
    if options.flavour:
        copy, profile = _fitted(project, copy, kind, profile=profile, options=options, report=report)
        options = for_source(options, profile)
    if not options.same:
        kind.codec().replace_missing(copy, report)
    # the writer changes its copy, and what is executed is looked at when source and result are compared
    unchanged = copy.model_copy(deep=True)
    behaviour = None
    if kind.tool:
        behaviour = executed(unchanged, profile, source=project, at_rest=options.at_rest, addresses=addresses)
    if kind.drawing is not DrawingNeed.NONE:
        written, options = _drawn(project, copy, kind, options, report)
        return Prepared(written, copy, options, behaviour)
    written, marks = rewrite_project(copy, kind, options, report)
    if kind.charts is not None and kind.charts.is_codesys and not options.same:
        note_limits(written.charts(), kind, report)
    if written is not copy and _has_flags(kind):
        _put_into_notation(written, kind, report)
    if _has_flags(kind) and not _has_flags(project):
        _note_step_times(written, kind, report)
    return Prepared(written, copy, replace(options, marks=marks, rewritten=copy), behaviour)


def _add_flip_flops(copy: Project, report: ConversionReport) -> None:
    from plcopen_sfc.refactor.dialect_translation import rename_pins  # noqa: PLC0415  # brings the parser

    rename_pins(copy, copy.dialect)  # the blocks have the names of one tool, and texts may mix those
    for path, block in put_flip_flops(copy):
        why = f"SCL calls no flip-flops: it is an instance of {block}, whose statements are in the file"
        report.add(Outcome.TRANSLATED, "instance", path, why)


def _stays(project: Project, kind: Format, options: WriteOptions) -> bool:
    """True if a format has a place for all of a project as it is, dialect and names aside."""
    if kind.drawing is not DrawingNeed.NONE or kind.charts is not None or options.flavour:
        return False
    if _names_results(project, kind):
        return False
    if options.same:
        return True
    if kind.tool and _has_flags(kind) is not _has_flags(project):
        return False
    draws = not _writes_statements(kind) or not _has_drawn_bodies(project)
    return draws and type(kind.codec()).replace_missing is Codec.replace_missing


def _names_results(project: Project, kind: Format) -> bool:
    """True if results of functions, which S7 declares as variables, get the names of their functions."""
    return bool(kind.tool) and kind.name != TIA_FORMAT and has_results(project)


def _put_texts_into_words(
    copy: Project,
    kind: Format,
    options: WriteOptions,
    report: ConversionReport,
    *,
    dialect: Dialect | None,
    addresses: Dialect,
) -> None:
    """Put all program text of a copy into the languages and the dialect of the target."""
    is_scl = copy.dialect is Dialect.SCL
    if kind.xml and not options.same:
        _forget_direct_text(copy)
    if not options.same:
        _in_structured_text(copy, kind, report)
        if options.of_matiec and kind.dialect is not None and not profile_as(copy, kind.name).matiec_library:
            count_in_seconds(copy, report, kind.tool)
    if dialect is Dialect.SCL and not is_scl:
        from plcopen_sfc.refactor.declaration_translation import start_by_statements  # noqa: PLC0415  # for S7 alone

        for path in start_by_statements(copy):
            report.add(Outcome.TRANSLATED, "initial value", path, "a statement at the beginning: S7 has none of these")
    if dialect is not None:
        calls_actions = kind.name == TIA_FORMAT  # its writer puts statements in the place of the calls
        wholly = bool(options.flavour)
        _put_into_dialect(copy, dialect, addresses, report, wholly=wholly, calls_actions=calls_actions)
    if kind.name == TIA_FORMAT and is_scl and not options.same:
        from plcopen_sfc.refactor.declaration_translation import compute_constants  # noqa: PLC0415  # rarely needed

        _note_texts(compute_constants(copy), report)


def _fitted(
    project: Project, copy: Project, kind: Format, *, profile: Profile, options: WriteOptions, report: ConversionReport
) -> tuple[Project, Profile]:
    """Return a copy in what a flavour of TC6 has, and the rules that its texts are for then."""
    if options.of_graph:
        # matiec has less than TC6: what S7-GRAPH has more than that becomes statements first
        copy, _ = rewrite_project(copy, format_named("plcopen")[0], options, report)
        _forget_replaced(copy)
        profile = PROFILES["iec"]
    if options.of_codesys:
        from plcopen_sfc.conversion.adaptation.chart_rules import obey_flags  # noqa: PLC0415  # of CODESYS alone

        obey_flags(copy, project, options, report)
        if kind.text:  # the writer of a TC6 file adds them, and the way back leaves them out
            for block in library_blocks(copy):
                copy.pous = [*copy.pous, block]
                why = "matiec has no library with it: its statements are in the file"
                report.add(Outcome.TRANSLATED, "POU", block.report_path, why)
    kind.codec().fit(copy, options, report)
    # what its rules would do otherwise is written out, or reported
    rules = PROFILES[options.flavour]
    return copy, replace(
        profile,
        final_scan=rules.final_scan,
        action_control=rules.action_control,
        boolean_targets=rules.boolean_targets,
    )


def _forget_replaced(project: Project) -> None:
    """Take out what charts keep for the way back beside the statements in its place, and blocks of S7 beside lists."""
    for chart in (each.chart for each in project.charts()):
        chart.permanent_pre, chart.permanent_post, chart.graph_settings = [], [], None
        for step in chart.steps:
            step.interlock = step.supervision = step.max_time = step.warning_time = None
    project.tag_tables, project.data_blocks = [], []


def _drawn(
    project: Project, meant: Project, kind: Format, options: WriteOptions, report: ConversionReport
) -> tuple[Project, WriteOptions]:
    """Return `meant` in the words of a format whose charts are drawings, and the options for its writer."""
    from plcopen_sfc.drawing import DrawingStyle, prepare  # noqa: PLC0415  # not needed to load and look

    style = DrawingStyle.STRUCTURED if kind.drawing is DrawingNeed.STRUCTURED else DrawingStyle.PLAIN
    copy, marks = rewrite_project(meant, kind, options, report)
    options = replace(options, marks=marks, rewritten=meant)
    other = project.source is None or project.source.format != kind.name
    if style.structured and other:
        note_limits(copy.charts(), kind, report)
    # a format without ids has branches of its own instead of the bars of others
    replaced = bool(options.flavour) or (not kind.ids and other)
    prepare(copy, style, positions=kind.positions, replace=replaced, foreign=True)
    kind.codec().adapt(copy, options, report)
    if kind.charts is None and meant is not copy:  # the source of a chart has the numbers and names of the others
        kind.codec().adapt(meant, options, ConversionReport())
    return copy, options


def _dialect(project: Project, kind: Format, options: WriteOptions) -> Dialect | None:
    """Return the dialect of the texts in a file; None: that of the project.

    The texts that a converted file keeps are in its words. Where the format has all dialects, they are put back into
    that of their tool.
    """
    if kind.dialect is None and options.flavour:
        return Dialect.IEC
    if kind.dialect is None and kind.tool and project.is_converted and not options.same:
        return format_named(project.tool_format)[0].dialect or Dialect.IEC
    return kind.dialect


def _origin(project: Project, kind: Format, options: WriteOptions, *, of_grafcet: bool) -> str | None:
    """Return the format whose tool executes the charts that a file keeps; None where the file itself tells that.

    Without it, what is read back would be the charts of the source under the rules of the target.
    """
    own = project.tool_format
    if options.same:
        return own if project.is_converted else None
    if kind.name == "json":
        return own if project.source is not None and own != kind.name else project.origin
    if options.flavour or not kind.extension_data or not any(True for _ in project.charts()):
        return None
    if of_grafcet or not project.tool_format:  # put into the words of the target, or made by a script for it
        return None
    rules = default_profile(project)
    profile = rules.name
    written = project.model_copy(update={"dialect": kind.dialect or project.dialect, "origin": own})
    if have_equal_rules(profile_as(written, kind.name), rules):  # texts are in the notation of the file
        return None
    return own if profile_as(written, own).name == profile else format_of_profile(profile)


def for_source(options: WriteOptions, profile: Profile) -> WriteOptions:
    """Return the options for a source that is executed under a profile."""
    return replace(
        options,
        of_graph=profile.graph_parameters,
        of_codesys=bool(profile.flags),
        of_matiec=profile.for_asks_ahead,
        final_scan=profile.final_scan,
    )


def is_put_into_sfc(project: Project, kind: Format) -> bool:
    """Return True if the GRAFCETs of a project become charts of IEC 61131-3 in files of a format.

    Textual IEC 61131-3 keeps in pragmas what charts have of IEC 60848, unless they are of a tool for GRAFCET.
    """
    if not kind.tool or not default_profile(project).grafcet_terms:
        return False
    keeps = kind.drawing is DrawingNeed.NONE and kind.dialect is None
    return not keeps or (project.source is not None and project.source.format.startswith("grafcet"))


def _put_into_sfc(project: Project, kind: Format, report: ConversionReport) -> None:
    """Put GRAFCETs into the words of charts of IEC 61131-3; a run compares both then."""
    from plcopen_sfc.conversion.adaptation.grafcet_charts import put_into_sfc  # noqa: PLC0415  # for GRAFCETs only

    def note(outcome: Outcome, what: str, path: str, why: str) -> None:
        report.add(outcome, what, path, why)

    put_into_sfc(project, note, profile_of_format(kind.name))


def _mark_first_steps(project: Project, kind: Format, report: ConversionReport) -> None:
    """Mark the steps in which only S7-GRAPH starts by itself: the first of a sequence without an initial step."""
    for name, pou, chart in project.charts():
        net = Net.of_sequencer(chart)
        for step in net.steps:
            if net.initial & step.bit and not step.step.initial:
                step.step.initial = True
                why = f"S7-GRAPH starts with the first step of a sequence, {kind.tool or kind.title} with initial ones"
                report.add(Outcome.TRANSLATED, "initial step", f"{pou.report_path_of(name)} / step {step.path}", why)


def _forget_direct_text(project: Project) -> None:
    """Forget that program text is directly in ``ST``: every format writes its text as its tool does."""
    for _, _, body in project.bodies():
        if isinstance(body, StBody | IlBody) and is_direct(body.markup):
            body.markup = None
    for chart in project.charts():
        for transition in chart.chart.transitions:
            if isinstance(transition.condition, Expression):
                transition.condition.markup = None


def _has_flags(of: Format | Project) -> bool:
    """True if programs of a project or in files of a format see steps as flags of their names."""
    profile = default_profile(of) if isinstance(of, Project) else PROFILES.get(of.name)
    return profile is not None and profile.step_variables is StepVariables.FLAG


def _put_into_notation(project: Project, kind: Format, report: ConversionReport) -> None:
    """Write active steps in texts as programs of the target see them."""
    from plcopen_sfc.refactor.step_kinds import name_steps_by_flags, name_steps_by_members  # noqa: PLC0415

    flags = _has_flags(kind)
    tool = kind.tool or kind.name
    for path in name_steps_by_flags(project) if flags else name_steps_by_members(project):
        why = f"`Step` in {tool} for `Step.x`" if flags else f"`Step.x` in {tool} for the flag `Step`"
        report.add(Outcome.TRANSLATED, "step flag", path, why)


def _note_step_times(project: Project, kind: Format, report: ConversionReport) -> None:
    from plcopen_sfc.refactor.step_kinds import step_times_asked  # noqa: PLC0415

    for path in step_times_asked(project):
        why = f"a simple step of {kind.tool} has no time: IEC steps have, and timers that its action calls"
        report.add(Outcome.NOT_EXECUTED, "step time", path, why)


def _writes_statements(kind: Format) -> bool:
    """True if statements stand for networks that the format cannot draw; text keeps the drawing of these beside it."""
    is_text = kind.networks is NetworkForm.STATEMENTS and kind.charts is None
    return bool(kind.tool) and kind.networks is not NetworkForm.DRAWN and not is_text


def _has_drawn_bodies(project: Project) -> bool:
    return any(isinstance(body, FbdBody | LdBody) for pou in project.pous for _, _, body in pou.named_bodies())


def _in_structured_text(project: Project, kind: Format, report: ConversionReport) -> None:
    """Write instruction list and networks as structured text, where the target has none."""
    from plcopen_sfc.languages.networks.exported_networks import SOURCES  # noqa: PLC0415
    from plcopen_sfc.refactor.il_texts import (  # noqa: PLC0415
        write_bodies_as_statements,
        write_conditions_as_expressions,
        write_drawn_bodies_as_statements,
        write_exported_networks_as_statements,
    )

    for path in write_conditions_as_expressions(project) if not kind.il_conditions else ():
        report.add(Outcome.TRANSLATED, "condition", path, "from instruction list into an expression")
    for path in write_bodies_as_statements(project) if not kind.il_bodies else ():
        report.add(Outcome.TRANSLATED, "body", path, "from instruction list into structured text")
    for source, tool in SOURCES.items():
        for path in write_exported_networks_as_statements(project, source) if kind.name != source else ():
            report.add(Outcome.TRANSLATED, "body", path, f"from networks of {tool} into structured text")
    for path in write_drawn_bodies_as_statements(project) if _writes_statements(kind) else ():
        report.add(Outcome.TRANSLATED, "body", path, "from a drawing into structured text")


def _write_calls_as_statements(
    project: Project, kind: Format, dialect: Dialect | None, options: WriteOptions, report: ConversionReport
) -> None:
    """Write drawn bodies with boxes that a tool does not have as structured text: calls of methods, and of actions."""
    from plcopen_sfc.refactor.il_texts import write_drawn_bodies_as_statements  # noqa: PLC0415

    if dialect is None or family(dialect) is Dialect.CODESYS:
        return
    calls = {BlockCall.METHOD, BlockCall.EXECUTE}
    if kind.name == TIA_FORMAT or options.flavour:  # other tools have boxes of actions
        calls.add(BlockCall.ACTION)
    for path in write_drawn_bodies_as_statements(project, calls):
        report.add(Outcome.TRANSLATED, "body", path, "from a drawing into structured text")


def _put_into_dialect(
    project: Project,
    dialect: Dialect,
    addresses: Dialect,
    report: ConversionReport,
    *,
    wholly: bool,
    calls_actions: bool,
) -> None:
    """Translate the program text between SCL and the others.

    IEC 61131-3 and CODESYS are left as they are unless `wholly`: their tools read most of each other's text, and
    files of one often hold what is of the other. A text with something that only its own dialect has is translated.
    """
    own = project.dialect
    if dialect is own:
        return
    from plcopen_sfc.refactor.dialect_translation import (  # noqa: PLC0415  # rarely needed
        rename_pins,
        translate_foreign,
        translate_project,
    )

    renamed = rename_pins(project, dialect) if {family(own), family(dialect)} == {Dialect.IEC, Dialect.CODESYS} else []
    if Dialect.SCL not in (own, dialect) and not wholly:
        texts = translate_foreign(project, dialect) if family(own) is not family(dialect) else []
        project.dialect = dialect
    else:
        texts = translate_project(project, dialect, calls_actions=calls_actions, addresses=addresses)
    _note_texts(texts, report)
    for text in (*renamed, *texts):
        if text.changed and not text.notes:
            report.add(Outcome.TRANSLATED, "text", text.path, f"from {own.label} into {dialect.label}")


def _note_texts(texts: Iterable[TranslatedText], report: ConversionReport) -> None:
    """Report what the translation of texts noted."""
    for text in texts:
        for note in text.notes:
            outcome = _OUTCOMES[note.severity]
            line = note.line if text.what == "text" else None
            why = note.reason if line is None else f"line {line}: {note.reason}"
            report.items.append(Item(outcome, text.what, text.path, why, text_line=line, cause=note.cause))


_OUTCOMES = {
    Severity.INFO: Outcome.TRANSLATED,
    Severity.WARNING: Outcome.APPROXIMATED,
    Severity.ERROR: Outcome.NOT_EXECUTED,
}
"""Outcome of a text by the severity of the notes of its translation: without a counterpart it is left as it is."""


def _renumber_addresses(project: Project, source: Dialect, target: Dialect, report: ConversionReport) -> None:
    """Give addresses the same places where one tool is TwinCAT and none S7, whose texts are translated."""
    from plcopen_sfc.refactor.direct_addresses import renumber_declared, renumber_in_texts  # noqa: PLC0415

    if (source in COUNTING_BYTES) is (target in COUNTING_BYTES) or Dialect.SCL in (source, target):
        return
    for renumber in (renumber_declared, renumber_in_texts):
        for path, severity, why in renumber(project, source, target):
            report.add(_OUTCOMES[severity], "address", path, why)


def _address_dialect(project: Project, kind: Format, dialect: Dialect | None) -> Dialect:
    """Return the dialect of direct addresses in a file; a script writes those of the tool that it writes for."""
    if kind.name == "json":
        return project.address_dialect
    target = address_dialect(kind.name, dialect or project.dialect, project.header.product)
    is_own = project.source is None and Dialect.SCL not in (project.dialect, target)
    return project.address_dialect if is_own else target


def note_limits(charts: Iterable[Chart], kind: Format, report: ConversionReport) -> None:
    """Report charts that tools which know nested branches only may not take, and that they begin with one step."""
    from plcopen_sfc.drawing import limits  # noqa: PLC0415

    for chart in charts:
        names = {step.id: f"step {step.name}" for step in chart.chart.steps}
        names |= {id_: f"transition {label}" for id_, label in chart.chart.labels().items()}
        initial = {step.id for step in chart.chart.steps if step.initial}
        for problem in limits(chart.chart):
            path = f"{chart.report_path} / {names.get(problem.symbol, problem.symbol)}"
            if problem.code == "SFC132" and problem.symbol in initial:
                why = f"a chart of {kind.tool} begins with one step: it is not active there from the start"
                report.add(Outcome.NOT_EXECUTED, "initial step", path, why)
            elif problem.code == "SFC130":
                why = f"{problem.code}: {problem.detail}, and charts of {kind.tool} are nested branches: restructure it"
                report.add(Outcome.NOT_EXECUTED, "chart", path, why)
            else:
                report.add(Outcome.APPROXIMATED, "chart", path, f"{problem.code}: {problem.detail}")
