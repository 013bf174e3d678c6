"""Header of lowered code in a file: what it was made of, how to read it, and what is proven of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import PurePath
from textwrap import wrap

from plcopen_sfc.analysis.verdict import Verdict
from plcopen_sfc.formats.matiec.matiec_statements import compilable_comments
from plcopen_sfc.lowering.chart_lowering import LoweredPou
from plcopen_sfc.lowering.code.code_bodies import comment_lines
from plcopen_sfc.lowering.code_texts import Texts
from plcopen_sfc.lowering.lowering_options import Construction, Style, tool_of
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.project import Project
from plcopen_sfc.semantics.profile import ScanOrder
from plcopen_sfc.version import __version__

_WIDTH = 110


def with_headers(project: Project, lowered: Iterable[LoweredPou]) -> Project:
    """Return a copy of `project` in which exact code in structured text begins with a header.

    Textbook code stays as textbooks have it. There is no date: the same chart gives the same file.
    """
    copy = project.model_copy(deep=True)
    for each in lowered:
        pou = next(pou for pou in copy.pous if pou.name == each.pou.name)
        body = pou.body if each.name == pou.name else pou.action(each.name.rpartition(".")[2]).body
        if each.style is Style.EXACT and isinstance(body, StBody):
            body.text = f"{_header(each, copy)}\n\n{body.text}"
            body.markup = None
    return copy


def _header(lowered: LoweredPou, project: Project) -> str:
    lines = (part for line in _lines(lowered) for part in wrap(line, _WIDTH, break_long_words=False))
    text = "\n".join(comment_lines("\n".join(lines)))
    target = lowered.rules.target
    # edition 2 of IEC 61131-3 has no other comments
    portable = target is not None and tool_of(target, project.dialect) is None
    return compilable_comments(text, project.dialect) if portable else text


def _lines(lowered: LoweredPou) -> Iterator[str]:
    texts = lowered.rules.texts
    yield texts.made_of(lowered.name, _source(lowered.chart.project), __version__)
    yield " ".join(_reading(lowered, texts))
    if lowered.proof is None:
        yield texts.not_compared
        return
    resting = [name for name, value in lowered.at_rest.items() if not value]
    yield texts.compared(lowered.profile.name, _verdict(lowered.proof, texts), resting)
    for coverage in lowered.proof.coverage:
        if coverage.has_chart:
            yield texts.reached(coverage.counts)


def _source(project: Project) -> str:
    """Return the file and the tool of a project, as far as they are known."""
    source, header = project.source, project.header
    name = PurePath(source.path).name if source is not None and source.path else ""
    tool = " ".join(filter(None, [header.product, header.version])) if header is not None else ""
    return ", ".join(filter(None, [name, tool]))


def _reading(lowered: LoweredPou, texts: Texts) -> Iterator[str]:
    if lowered.construction in (Construction.CASE, Construction.REGIONS):
        states = dict.fromkeys(expression.partition(" ")[0] for expression in lowered.situation.values())
        yield texts.read_states(list(states))
        yield texts.read_branches(actions=lowered.profile.order is ScanOrder.ACTIONS_FIRST)
    else:
        yield texts.read_flags


def _verdict(proof: Verdict, texts: Texts) -> str:
    if proof.proven:
        return texts.proven(proof.states)
    return texts.tested(proof.runs, proof.scans)
