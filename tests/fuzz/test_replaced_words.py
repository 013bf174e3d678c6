"""A word of a file replaced by one that does not fit: whatever is done with it, only errors of this package come."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from random import Random

import pytest

import plcopen_sfc as sfc
from tests.samples import FIXTURES
from tests.sweeps import WHOLE

MUTANTS = 3_000 if WHOLE else 24
FORMATS = {".st": "iec-text", ".sfc": "iec-text", ".scl": "scl", ".json": "json", ".xml": None}
SMALL = 60_000
FILES = sorted(
    path
    for path in FIXTURES.rglob("*")
    if path.suffix in FORMATS and path.stat().st_size < SMALL and "broken" not in path.parts
)
TARGETS = ("codesys", "plcopen-1.01", "plcopen-2.01", "simaticml", "iec-text", "scl", "json")
IN_XML = re.compile(rb'(?<![A-Za-z0-9_])\d+(?![A-Za-z0-9_])|(?<==")[^"]*(?=")|(?<=>)[^<>]+(?=<)')
IN_TEXT = re.compile(rb"\w+|[^\w\s]")
WRONG = [
    *(b"1" * 5000, b"1E999", b"-7", "²".encode(), b"", b"9" * 20, b"0x1", b"#", b'"', b"'", b"$", b"1.5.6", b"\x0c"),
    *(b"T#99999999999999999d", b"((((", b"END_IF", b"\xff", b"_", b"a" * 300),
]


def mutant(seed: int) -> tuple[Path, bytes, Random]:
    chance = Random(seed)  # noqa: S311  # no secret
    path = chance.choice(FILES)
    data = path.read_bytes()
    place = chance.choice(list((IN_XML if path.suffix == ".xml" else IN_TEXT).finditer(data)))
    return path, data[: place.start()] + chance.choice(WRONG) + data[place.end() :], chance


def deeds(project: sfc.Project, chance: Random) -> list[Callable[[], object]]:
    found: list[Callable[[], object]] = [
        lambda: sfc.dumps(project),
        lambda: sfc.dumps(project, fresh=True),
        lambda: sfc.check(project),
    ]
    found += [partial(sfc.convert, project, target, partial=True) for target in chance.sample(TARGETS, 2)]
    for chart in list(project.charts())[:1]:
        found.append(partial(sfc.simulate, project, pou=chart.pou.name, scans=3))
        found.append(partial(sfc.lower, project, pou=chart.pou.name, verify=False))
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(MUTANTS))
def test_only_own_errors_come_of_a_word_that_does_not_fit(seed: int) -> None:
    path, data, chance = mutant(seed)
    with suppress(sfc.SfcError):
        project = sfc.loads(data, format=FORMATS[path.suffix])
        project.accept_errors()
        for deed in deeds(project, chance):
            with suppress(sfc.SfcError):
                deed()
