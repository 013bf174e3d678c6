"""GRAFCETs as text (``grafcet-text``): read, write, and put edits into the text. `grafcet_text_reader` reads them.

What the text cannot express is in comments that the reader takes back: the text is read as it was written, and the rest
of the model is put behind it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain

from plcopen_sfc.errors import Location, ModelError, StructureError
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.grafcet.condition_notation import expression_of, flags_of, in_notation, with_condition
from plcopen_sfc.formats.grafcet.grafcet_text_reader import (
    CHARTS,
    SITUATIONS,
    STORED,
    TABLES,
    GrafcetText,
    is_address,
    read_text,
)
from plcopen_sfc.formats.grafcet.other_notations import translated
from plcopen_sfc.formats.grafcet.sfc_losses import action_of_sfc, report_unexpressed, tags_of
from plcopen_sfc.formats.remainder_comments import lacking
from plcopen_sfc.formats.text_codec import TextCodec
from plcopen_sfc.formats.text_encoding import SourceText
from plcopen_sfc.formats.text_patch import BlockSpan, WrittenBlock, numbered_blocks
from plcopen_sfc.languages.declarations import write_type, write_value
from plcopen_sfc.model import sfc
from plcopen_sfc.model.actions import ActionKind, ForcedSituation, ForcingOrder, Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.text import Text, plain
from plcopen_sfc.model.types import Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import sections_of
from plcopen_sfc.report import ConversionReport, Outcome

_TABLE_WORDS = {kind: word for word, kind in TABLES.items()}
_CHART_WORDS = {kind: word for word, kind in CHARTS.items()}
_SITUATION_WORDS = {situation: word for word, situation in SITUATIONS.items()}
_STORED_WORDS = {kind: word for word, kind in STORED.items()}


def write_blocks(project: Project, report: ConversionReport) -> WrittenBlock:
    """Return the text of a project, in the blocks that an edit replaces."""
    writers = (_Writer(project, pou, report) for pou in project.pous if pou.chart is not None)
    blocks = [*numbered_blocks(writer.grafcet() for writer in writers)]
    if not blocks:  # a text has a head, to be recognised
        blocks.append(WrittenBlock(("grafcet", ""), f"GRAFCET {project.name or 'empty'}"))
    written = WrittenBlock(("file", ""), blocks=tuple(blocks))
    left = [*lacking(read_text(SourceText(written.whole() + "\n", "utf-8")).project, project)]
    for change, path in left:
        report.add(Outcome.EXTENSION_DATA, change.field, path, "a GRAFCET has no word for it; it is in a comment")
    if left:
        rest = "\n".join(f"// {{plcopen_sfc {change}}}" for change, _ in left)
        blocks.append(WrittenBlock(("rest", ""), rest, apart=True))
    return WrittenBlock(("file", ""), blocks=tuple(blocks))


_QUOTES = "a comment begins with the quotation mark in the text of a GRAFCET"


class _Writer:
    def __init__(self, project: Project, pou: Pou, report: ConversionReport) -> None:
        self._pou = pou
        self._report = report
        self._tags = tags_of(project, pou)
        # conditions of a tool's chart, which a GRAFCET writes in its own notation
        of_tool = project.origin is not None and pou.chart is not None
        declared = {each.name.casefold() for each in (*pou.variables(), *chain(*self._tags.values()))}
        self._flags = flags_of(pou.chart, declared) if of_tool and pou.chart is not None else None

    def grafcet(self) -> WrittenBlock:
        pou = self._pou
        self._report.add(Outcome.KEPT, "POU", f"POU {pou.name}")
        chart = pou.chart or sfc.SfcNetwork()
        block = " AS FUNCTION_BLOCK" if pou.kind is PouKind.FUNCTION_BLOCK else ""
        blocks = [_line(("head", ""), f"GRAFCET {_named(pou.name, f'POU {pou.name}')}{block}", pou.comment, "")]
        tables = [(each.kind, each.comment, each.variables) for each in sections_of(pou.interface)]
        for kind, comment, declared in (*tables, *((kind, None, tags) for kind, tags in self._tags.items())):
            word = _TABLE_WORDS.get(kind)
            if word is not None:
                head = _line(("head", ""), word, comment, "")
                variables = numbered_blocks(self._variable(variable) for variable in declared)
                blocks.append(WrittenBlock(("table", word), blocks=(head, *variables), apart=True))
        blocks += self._elements(chart, f"POU {pou.name}", "")
        blocks += [self._partial(partial) for partial in chart.partial_charts]
        return WrittenBlock(("grafcet", pou.name), blocks=numbered_blocks(blocks), apart=True)

    def _partial(self, partial: sfc.PartialChart) -> WrittenBlock:
        head = f"{_CHART_WORDS[partial.kind]} {_named(partial.name, f'chart {partial.name}')}"
        if partial.kind is sfc.PartialChartKind.EXPANSION:
            head += f" FROM {partial.entry_step}" if partial.entry_step else ""
            head += f" TO {partial.exit_step}" if partial.exit_step else ""
        blocks = [_line(("head", ""), head, partial.comment, "")]
        blocks += self._elements(partial.chart, f"POU {self._pou.name} / {partial.name}", "    ")
        return WrittenBlock(("chart", partial.name), blocks=numbered_blocks(blocks), apart=True)

    def _elements(self, chart: sfc.SfcNetwork, path: str, indent: str) -> Iterator[WrittenBlock]:
        """Yield the steps, and below each the transitions whose steps are all above them, in the order of the model."""
        waiting = list(chart.transitions)
        written: set[int] = set()
        labels = chart.labels()

        def transitions(every: bool) -> Iterator[WrittenBlock]:
            while waiting and (every or written.issuperset(waiting[0].sources)):
                transition = waiting.pop(0)
                yield self._transition(chart, transition, f"{path} / transition {labels[transition.id]}", indent)

        for number, step in enumerate(chart.steps):
            yield self._step(chart, step, f"{path} / step {step.name}", indent, apart=not number and not indent)
            written.add(step.id)
            yield from transitions(False)
        yield from transitions(True)

    def _step(self, chart: sfc.SfcNetwork, step: sfc.Step, path: str, indent: str, *, apart: bool) -> WrittenBlock:
        text = ("INITIAL " if step.initial else "") + ("MACRO" if _expansion(step) else "STEP")
        text += f" {_named(step.name, path)}"
        text += f" #{step.number}" if step.number is not None else ""
        if _expansion(step) not in (None, step.name):
            text += f" EXPANDS {_expansion(step)}"
        if step.encloses:
            text += " ENCLOSES " + ", ".join(
                each.chart + (f"{{{', '.join(each.activated_steps)}}}" if each.activated_steps else "")
                for each in step.encloses
            )
        blocks = [_line(("head", ""), text, step.comment, indent)]
        for action in (with_condition(chart, step, each, self._pou.transitions) for each in step.actions):
            blocks += self._action_line(action, f"{path} / action {action.target or 'in place'}", indent, step.name)
        for name, qualifier in _OF_STEPS.items():
            done: str | sfc.Body | None = getattr(step, f"{name}_action")
            if done is not None:
                named, body = (done, None) if isinstance(done, str) else (None, done)
                action = sfc.ActionAssociation(id=0, qualifier=qualifier, target=named, body=body)
                blocks += self._action_line(action, f"{path} / {name} action", indent, step.name)
        return WrittenBlock(("step", step.name), blocks=numbered_blocks(blocks), apart=apart)

    def _action_line(self, action: sfc.ActionAssociation, path: str, indent: str, step: str) -> list[WrittenBlock]:
        line = self._action(action, path, step)
        return [] if line is None else [_line(("action", ""), line, action.comment, indent + "    ")]

    def _action(self, action: sfc.ActionAssociation, path: str, step: str) -> str | None:
        """Return the line of an action; None where GRAFCET has none that does the same."""
        if action.forcing is not None:
            return f"FORCE {_forced(action.forcing)}"
        kind, value = action.kind, action.value
        body = action.body
        named = self._pou.find_action(action.target) if action.target is not None else None
        if named is not None and body is None:
            body = named.body
        if kind is None:
            translated = action_of_sfc(action, path, self._report, is_program=body is not None)
            if translated is None:
                return None
            kind, value = translated
        if isinstance(body, StBody) and "//" not in body.text:
            done = f"{{ {' '.join(body.text.split())} }}"
        elif action.target is None or named is not None:
            self._lost("action", path, "the body of the action is no structured text in one line")
            return None
        else:
            done = action.target + (f" := {' '.join(value.split())}" if value is not None else "")
        condition = self._expression(action.condition, [step])
        if '"' in condition or (body is None and '"' in done):
            self._lost("action", path, _QUOTES)
            return None
        if kind in _STORED_WORDS:
            return f"ON {_STORED_WORDS[kind]} {done}"
        if kind is ActionKind.ON_EVENT:
            return f"ON EVENT {condition or 'FALSE'} : {done}"
        if condition:
            done += f" IF {condition}"
        if kind in (ActionKind.DELAYED, ActionKind.LIMITED):
            done += f" {'AFTER' if kind is ActionKind.DELAYED else 'FOR'} {_time(action.duration or '0s')}"
        return done

    def _transition(self, chart: sfc.SfcNetwork, transition: sfc.Transition, path: str, indent: str) -> WrittenBlock:
        names = {step.id: step.name for step in chart.steps}
        sources, targets = (
            [names[each] for each in side if each in names] for side in (transition.sources, transition.targets)
        )
        designation = transition.name or ("" if transition.number is None else str(transition.number))
        text = f"({designation}) " if designation and not re.search(r"[()\n]", designation) else ""
        text += f"{', '.join(sources)} -> {', '.join(targets)}".strip()
        expression = expression_of(chart, transition.condition, self._pou.transitions)
        condition = self._expression(expression, sources)
        if transition.condition is not None and not condition:
            self._lost("condition", path, "no text expresses it")
            condition = "FALSE"
        if '"' in condition:
            self._lost("condition", path, _QUOTES)
            condition = "FALSE"
        if condition:
            text = f"{text.rstrip()} : {condition}"
        key = ("transition", f"{','.join(sources)} -> {','.join(targets)}")
        return _line(key, text, transition.comment, indent)

    def _expression(self, condition: sfc.Condition | None, active: Sequence[str]) -> str:
        """Return the text of a condition that is asked for while the steps `active` are; empty where it has none."""
        if not isinstance(condition, Expression):
            return ""
        own = {step.casefold() for step in active}
        if self._flags is not None and (written := in_notation(condition, self._flags, own)) is not None:
            return written
        text = " ".join(condition.text.split())
        return f"NOT ({text})" if condition.negated else text

    def _variable(self, variable: Variable) -> WrittenBlock:
        text = _named(variable.name, f"variable {variable.name}")
        if variable.address is not None and is_address(variable.address):
            text += f" {variable.address}"
        elif variable.address is not None:
            why = f"{variable.address} is no address of a GRAFCET"
            self._lost("address", f"POU {self._pou.name} / {variable.name}", why)
        initial = write_value(variable.initial) if variable.initial is not None else ""
        if '"' in initial:
            self._lost("initial value", f"POU {self._pou.name} / {variable.name}", _QUOTES)
            initial = ""
        if initial or variable.type != ElementaryType(name=Elementary.BOOL):
            text += f" : {' '.join(write_type(variable.type).split())}" + (f" := {initial}" if initial else "")
        return _line(("variable", variable.name), text, variable.comment, "    ")

    def _lost(self, what: str, path: str, why: str) -> None:
        self._report.add(Outcome.NOT_EXECUTED, what, path, why)


_OF_STEPS = {"entry": Qualifier.P1, "main": Qualifier.N, "exit": Qualifier.P0}
"""The actions of CODESYS that a step itself has, by what they are in IEC 61131-3."""


def _expansion(step: sfc.Step) -> str | None:
    return step.macro.expansion if step.macro is not None else None


def _forced(order: ForcingOrder) -> str:
    inside = _SITUATION_WORDS.get(order.situation, ", ".join(order.steps))
    if order.situation is ForcedSituation.EXPLICIT and not order.steps:
        inside = ""
    return f"{order.chart}{{{inside}}}"


def _named(name: str, path: str) -> str:
    """Return a name that can be in a line. Raises `ModelError` for one that would be read as something else."""
    if not re.fullmatch(r'[^\s,:{}()"]+', name) or "->" in name:
        hint = "Rename it: blanks, commas, colons, parentheses and quotation marks divide the parts of a line."
        raise ModelError(f"{name!r} cannot be a name in the text of a GRAFCET", location=Location(path=path), hint=hint)
    return name


def _time(text: str) -> str:
    found = re.fullmatch(r"L?T(?:IME)?#((?:\d+(?:\.\d+)?(?:ms|d|h|m|s))+)", text, re.IGNORECASE)
    return text if found is None else re.sub(r"(?<=\d)m$", "min", found[1].lower())


def _line(key: tuple[str, str], text: str, comment: Text | None, indent: str) -> WrittenBlock:
    first, *others = map(_quoted, plain(comment).split("\n")) if comment is not None else [""]
    lines = [f"{indent}{text} {first}" if first else indent + text, *(f"{indent}    {each}" for each in others)]
    return WrittenBlock(key, "\n".join(lines))


def _quoted(text: str) -> str:
    doubled = text.replace('"', '""')
    return f'"{doubled}"'


_OWN_LINES = re.compile(r"^[ \t]*// *\{plcopen_sfc[^\r\n]*(?:\r\n|\r|\n)?", re.MULTILINE)


def _read(source: SourceText, file: str | None) -> tuple[GrafcetText, SourceText, list[int] | None]:
    """Return the project, the text, and for one in the notation of another tool the lines in the file."""
    other = translated(source.text, file)
    if other is None:
        return read_text(source, file), source, None
    text = source._replace(text=other.text)
    try:
        return read_text(text, file), text, other.lines
    except StructureError as error:
        at = replace(error.location, line=other.lines[(error.location.line or 1) - 1])
        raise StructureError(error.message, location=at, hint=error.hint) from error


class GrafcetTextCodec(TextCodec):
    """GRAFCETs as text."""

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a text. Raises `StructureError` at a line that is not valid in a GRAFCET."""
        found = _read(self.decode(data), file)[0]
        return ReadResult(found.project, found.diagnostics)

    def without_own_comments(self, text: str) -> str:
        return _OWN_LINES.sub("", text)

    def lines(self, content: bytes, project: Project) -> dict[str, int]:
        found, _, lines = _read(self.decode(content), None)
        return found.lines if lines is None else {path: lines[line - 1] for path, line in found.lines.items()}

    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        if options.source and translated(self.decode(options.source).text) is not None:
            why = "it was in the notation of another tool; an edit writes it as the text of a GRAFCET"
            report.add(Outcome.TRANSLATED, "notation", f"POU {project.name or ''}".strip(), why)
        return write_blocks(project, report)

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Report the behaviour of charts of tools that a GRAFCET does not have."""
        report_unexpressed(project, report)

    def located(self, content: bytes) -> tuple[Project, SourceText, BlockSpan]:
        found, source, _ = _read(self.decode(content), None)
        return found.project, source, found.spans


CODEC = GrafcetTextCodec()
