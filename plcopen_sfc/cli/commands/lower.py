"""``plcopen-sfc lower``: program code instead of a chart, with the proof that it does the same."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from plcopen_sfc.analysis.equivalence import Outcome, equivalent
from plcopen_sfc.api import dumps, load, loads
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.files import write_atomic
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.lowering.constructing import Style
from plcopen_sfc.lowering.lower import LoweredPou, faults_of, lower
from plcopen_sfc.semantics.subjects import resolve

_FINDINGS = 1


@dataclass(frozen=True)
class How:
    """What to lower and how: the options of the command."""

    to: str
    pou: str | None
    construction: str
    style: str
    language: str | None
    profile: str | None
    init: str | None
    stop: str | None
    reset_actions: bool
    states: str
    actions: str
    flags: str
    modes: tuple[str, ...]
    lang: str
    verify: bool


def run(screen: Screen, source: str, target: str | None, how: How) -> int:
    """Lower a chart of `source` and write the project with the code to `target` (None: next to it).

    What is written has been read back and compared with the chart. Where exact code is different nothing is written.
    """
    project = load(source, progress=lambda files: screen.progress(files, "Loading"))
    lowered = lower(
        project,
        how.construction,
        pou=how.pou,
        style=how.style,
        language=how.language,
        profile=how.profile,
        init=how.init,
        stop=how.stop,
        reset_actions=how.reset_actions,
        states=how.states,
        actions=how.actions,
        flags=how.flags,
        modes=how.modes,
        target=how.to,
        lang=how.lang,
        verify=False,
    )
    data = dumps(lowered.project, format=how.to)
    proof = None
    if how.verify:
        subject = resolve(project, how.pou)
        again = resolve(loads(data, format=how.to), subject.pou.name)
        proof = equivalent(subject, again, lowered.profile, fixed=lowered.at_rest, left_out=lowered.left_out)
        if proof.outcome is Outcome.DIFFERENT and lowered.style is Style.EXACT:
            raise LoweringError(
                f"nothing is written: read back, the code does not do what the chart does: {proof}",
                hint="Please report it with the chart.",
            )
        lowered = replace(lowered, proof=proof, faults=faults_of(subject, lowered))
    name = target or _beside(Path(source), how.to)
    write_atomic(Path(name), data)
    if screen.as_json:
        screen.json({"file": name} | lowered.as_dict())
    else:
        _show(screen, name, lowered)
    return _FINDINGS if proof is not None and proof.outcome is Outcome.DIFFERENT else 0


def _show(screen: Screen, target: str, lowered: LoweredPou) -> None:
    head, *rest = str(lowered).splitlines()
    screen.line((lowered.pou.name, "bold"), head.removeprefix(lowered.pou.name))
    for line in rest if lowered.proof is not None else ["not compared with the chart"]:
        screen.line(line)
    screen.line("written: ", (target, "bold"))


def _beside(source: Path, to: str) -> str:
    extension = format_named(to)[0].extensions[0]
    return str(source.with_name(f"{source.stem}-lowered{extension}"))
