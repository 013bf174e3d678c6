"""Programs of real projects: every body is translated or refused with a reason, and runs without an own error."""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import SfcError, SimulationError
from plcopen_sfc.model import OpaqueBody, Project, SfcBody
from plcopen_sfc.semantics.programs import Controller, Direction, Instance
from plcopen_sfc.semantics.programs import runtime_types as t
from tests.corpus import corpus_files, require_corpus

pytestmark = pytest.mark.corpus

SCANS = 50
SAMPLE = 3
"""One of so many files is tried: all take a minute."""
REASONS = {
    "not in the project": r"is not known to the simulator|is not declared, so its elements|which nothing here declares",
    "a constant that the project does not have": r"is no constant|is a label of CASE, but",
    "a body in a language without a meaning here": r"a body in",
    "a network with an open end": r"the network cannot be executed",
    "a text with syntax errors": r"found '|expected",
    "a type that does not fit, because what it belongs to is not declared": (
        r"is assigned to|cannot be compared|is where a BOOL|do not go together|is passed to|cannot become"
        r"|is no array|has no |is called without|is a type: only|a value in brackets| of (INT|BOOL|STRING|reference)"
    ),
    "a variable over another one": r"lies over|overlaps|at once",
    "a pointer of a kind of its own": r"pointers of this kind|is no reference|is a reference|has no address",
    "not done by the simulator": (
        r"inside an expression|VAR_IN_OUT only|cannot be passed|is no variable|watches for an edge"
    ),
}
"""Why a place of a text is refused."""


class NoChart:
    """Charts do nothing here: they have tests of their own."""

    def __init__(self, *_: Any) -> None:
        pass

    def translate(self) -> None:
        pass

    def initialise(self, frame: Any) -> None:
        pass

    def execute(self, frame: Any) -> None:
        pass


def projects() -> Iterator[tuple[str, Project]]:
    for kind in ("plcopen", "codesys", "codesys23", "iectext", "simaticml"):
        for path in corpus_files(kind)[::SAMPLE]:
            try:
                project = sfc.load(path)
                project.read_all()
            except SfcError:
                continue  # files that are wrong on purpose have tests of their own
            yield path.name, project


def reason(problem: SimulationError) -> str:
    return next((name for name, pattern in REASONS.items() if re.search(pattern, problem.message)), problem.message)


def vary(instance: Instance, chance: random.Random) -> None:
    for variable in instance.variables().values():
        type_ = variable.type
        if not isinstance(type_, t.ScalarType) or variable.direction not in (Direction.INPUT, Direction.EXTERNAL):
            continue
        if type_.family is t.Family.BOOL:
            instance[variable.path] = chance.random() < 0.5
        elif type_.is_number and type_.narrowed is None:
            instance[variable.path] = chance.randint(0, 100)


def run(instance: Instance, chance: random.Random) -> SimulationError | None:
    """Random scans, up to the first error that the program makes."""
    for scan in range(SCANS):
        if scan % 10 == 0:
            vary(instance, chance)
        try:
            instance.scan()
        except SimulationError as error:
            return error
        instance.controller.now += 10_000_000
    return None


@pytest.mark.slow
def test_every_body_of_the_corpus_is_translated_or_refused_with_a_reason() -> None:
    require_corpus()
    bodies = 0
    refused: set[tuple[str, str]] = set()
    reasons: Counter[str] = Counter()
    chance = random.Random(20)  # noqa: S311  # chance for a test
    for name, project in projects():
        controller = Controller(project, chart_compiler=NoChart, max_steps=2000)
        for pou in project.pous:
            bodies += sum(1 for _, _, body in pou.named_bodies() if not isinstance(body, SfcBody))
            refused |= {(name, path) for path, _, body in pou.named_bodies() if isinstance(body, OpaqueBody)}
            error = run(controller.instance(pou), chance)
            assert error is None or (error.scan and error.pou), error
        for problem in controller.problems:
            reasons[reason(problem)] += 1
            refused.add((name, problem.location.path or ""))
    assert bodies > 100
    assert not set(reasons) - set(REASONS), reasons
    share = 1 - len(refused) / bodies
    assert share > 0.85, (share, reasons)
