"""Code in a file: its header, and its comparison with the chart as the tool of the file reads it.

Writers of this package keep what a format has no place for in comments and extension data, and its readers restore it
from there. So code can be complete when it is read back, although no other tool would find it in the file.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import PurePath
from textwrap import wrap
from typing import Unpack

from plcopen_sfc.analysis.equivalence import Searching
from plcopen_sfc.analysis.verdict import Verdict, VerdictKind
from plcopen_sfc.errors import Location, LoweringError, ModelError
from plcopen_sfc.formats.matiec.matiec_statements import compilable_comments
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.binding.compile_mistakes import compile_mistakes
from plcopen_sfc.lowering.chart_lowering import LoweredPou, prove_code
from plcopen_sfc.lowering.code_texts import Texts
from plcopen_sfc.lowering.lowering_options import Construction, Style, has_line_comments
from plcopen_sfc.lowering.proof import prove
from plcopen_sfc.model.base import Model
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body
from plcopen_sfc.model.variables import SectionKind, sections_of
from plcopen_sfc.report import ConversionReport, Item, Outcome
from plcopen_sfc.semantics.profile import ScanOrder
from plcopen_sfc.semantics.subjects import Subject, resolve
from plcopen_sfc.version import __version__

_NO_CODE = frozenset(
    """drawing comment title extension_data content_extension_data header name modified tree place attributes object_id
    global_id foreign_data_infos scales folder number markup worksheet""".split()
)
"""Fields that no program is made of."""
_MOST_LIKELY = (
    *("networks", "bodies", "body", "actions", "methods"),
    *("return type", "sections", "variables", "type", "initial"),
)
"""Order in which a message names the others."""
_NAMED = 3
_SHOWN = 100


def prove_written(
    chart: Subject,
    lowered: LoweredPou,
    seen: Project,
    whole: Callable[[], Project],
    **searching: Unpack[Searching],
) -> Verdict:
    """Compare the code in a file with `chart`. `seen`: the file as its tool reads it (`load(as_tool=)`).

    `whole` loads the same file with the extension data of this package. Raises `LoweringError` where `seen` lacks what
    the code needs, where it cannot be executed, and where exact code is different from the chart.
    """
    try:
        found = prove_code(chart, resolve(seen, lowered.name), lowered, **searching)
    # the code cannot be resolved or executed as the tool reads it: is that so with our extension data too?
    except (LoweringError, ModelError) as error:
        if _is_equal(chart, carrying := whole(), lowered, **searching):
            raise _extension_data(lowered, seen, carrying, error.message) from error
        raise
    if found.kind is not VerdictKind.DIFFERENT:
        return found
    exact, carrying = lowered.style is Style.EXACT, whole()
    if _is_equal(chart, carrying, lowered, **searching) if exact else not _is_same_code(carrying, seen, lowered):
        raise _extension_data(lowered, seen, carrying, str(found).partition("\n")[0])
    if exact:
        raise LoweringError(
            f"read back, the code does not do what the chart does: {found}", hint="Please report it with the chart."
        )
    return found


def refuse_uncompiled(report: ConversionReport, seen: Project, lowered: LoweredPou) -> None:
    """Raise `LoweringError` where the target does not compile the code: the proof knows more than its compiler.

    Refused are statements that the target does not have, bodies that are written as something else, variables of the
    code that the file (`seen` as its tool reads it) does not declare, and types of them that do not fit. Global
    variables and library types may be elsewhere in the project of the user: the report lists them.
    """
    for item in uncompiled(report, lowered):
        raise _not_compiled(item.why, item.path, lowered)
    inner = [each for each in sections_of(lowered.pou.interface) if each.kind is not SectionKind.EXTERNAL]
    # S7 has variables with addresses in its tables of tags
    own = {each.name.casefold() for section in inner for each in section.variables if not each.address}
    pou, given = resolve(seen, lowered.pou.name).pou, lowered.chart.pou.variables()
    made = own - {each.name.casefold() for each in given}
    for why in compile_mistakes(_body(lowered, pou), pou, seen.dialect, made):
        raise _not_compiled(why, pou.report_path, lowered)
    for each in Names(seen).undeclared(pou):
        if each.reference.name.casefold() in own:
            why = f"the file does not declare {each.reference.name}"
            raise _not_compiled(why, each.text_site.report_path, lowered)


def _not_compiled(why: str, path: str, lowered: LoweredPou) -> LoweringError:
    # calls stay of actions whose statements could not be in their place
    left = next((each.name for each in lowered.pou.actions if re.search(rf"\b{re.escape(each.name)}\b", why)), "")
    hint = f"Write {left} in structured text without RETURN, jumps and calls of itself." if left else ""
    return LoweringError(f"the target does not compile the code: {why}", location=Location(path=path), hint=hint)


def uncompiled(report: ConversionReport, lowered: LoweredPou) -> list[Item]:
    """Return the items of the code of a chart that the target does not compile."""
    place = lowered.pou.report_path
    return [
        item
        for item in report.with_outcome(Outcome.NOT_EXECUTED)
        if item.what in ("text", "body", "network")
        and (item.path == place or item.path.startswith(f"{place} / action "))
    ]


def refuse_comments(report: ConversionReport, pou: str) -> None:
    """Raise `LoweringError` where a network of `pou` would be in a comment: the proof finds that too, but not why."""
    for item in report.with_outcome(Outcome.EXTENSION_DATA, Outcome.NOT_EXECUTED):
        if item.what in ("network", "body") and item.path == f"POU {pou}":
            raise LoweringError(
                f"a network would only be in a comment: {item.why}",
                location=Location(path=item.path),
                hint="Structured text can hold it: --language ST.",
            )


def _is_equal(chart: Subject, written: Project, lowered: LoweredPou, **searching: Unpack[Searching]) -> bool:
    try:
        return prove_code(chart, resolve(written, lowered.name), lowered, **searching).kind is not VerdictKind.DIFFERENT
    except (LoweringError, ModelError):
        return False


def _is_same_code(whole: Project, seen: Project, lowered: LoweredPou) -> bool:
    one, other = (resolve(project, lowered.name) for project in (whole, seen))
    found = prove(one, other, lowered.profile, fixed={}, left_out=None, step_flags=None)
    return found.kind is not VerdictKind.DIFFERENT


def _extension_data(lowered: LoweredPou, seen: Project, whole: Project, why: str) -> LoweringError:
    places = list(_places(seen, whole, lowered.pou.name))
    shown = "; ".join(places[:_NAMED]) + (f"; and {len(places) - _NAMED} more" if len(places) > _NAMED else "")
    to_text = lowered.language != "ST"
    return LoweringError(
        f"a part of the code would only be in comments or extension data, which its tool does not read: {why}. "
        f"It would not see {shown}",
        location=Location(path=lowered.name),
        hint="Structured text can hold it: --language ST."
        if to_text
        else "Formats of other tools may have a place for it.",
    )


def _places(seen: Project, whole: Project, pou: str) -> Iterator[str]:
    """Yield the parts of a file that its tool does not see: those in the POU first, and the most likely ones."""
    found = differences(seen, whole, ignore=_NO_CODE)
    for each in sorted(found, key=lambda each: (each.path.partition(" / ")[0] != f"POU {pou}", _rank(each.path))):
        yield f"{each.path} ({_short(each.right)})"


def _rank(path: str) -> int:
    last = path.rpartition(" / ")[2]
    return next(
        (place for place, word in enumerate(_MOST_LIKELY) if f"{last} ".startswith(f"{word} ")), len(_MOST_LIKELY)
    )


def _short(value: object) -> str:
    text = type(value).__name__ if isinstance(value, Model) else str(value)
    return text if len(text) <= _SHOWN else text[:_SHOWN] + ".."


_WIDTH = 110


def with_headers(project: Project, lowered: Iterable[LoweredPou]) -> Project:
    """Return a copy of `project` in which exact code in structured text begins with a header.

    Textbook code stays as textbooks have it. There is no date: the same chart gives the same file.
    """
    copy = project.model_copy(deep=True)
    for each in lowered:
        pou = next(pou for pou in copy.pous if pou.name == each.pou.name)
        body = _body(each, pou)
        if each.style is Style.EXACT and isinstance(body, StBody):
            body.text = f"{_header(each, copy)}\n\n{body.text}"
            body.markup = None
    return copy


def _body(lowered: LoweredPou, pou: Pou) -> Body | None:
    """Return the body in a POU, or in its action, that a chart has become; None where the target has no actions."""
    action = lowered.name.rpartition(".")[2].casefold()
    bodies = (each.body for each in pou.actions if each.name.casefold() == action)
    return pou.body if lowered.name == pou.name else next(bodies, None)


def _header(lowered: LoweredPou, project: Project) -> str:
    lines = (part for line in _lines(lowered) for part in wrap(line, _WIDTH, break_long_words=False))
    text = "\n".join(f"// {line}" for line in lines)
    dialect = project.dialect
    return text if has_line_comments(lowered.rules, dialect, project) else compilable_comments(text, dialect)


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
    source = project.source
    name = PurePath(source.path).name if source is not None and source.path else ""
    return ", ".join(filter(None, [name, project.header.tool]))


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
