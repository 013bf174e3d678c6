"""Damaged files of every format: loaded, written, converted, checked, simulated, lowered, edited and saved."""

from __future__ import annotations

import pytest

from tests.fuzz.mutation import FORMATS, mutant
from tests.fuzz.trial import faults
from tests.sweeps import WHOLE

MUTANTS = 300 if WHOLE else 8
"""Of each format. `python -m tests.fuzz` tries others, as many as are wanted."""


@pytest.mark.slow
@pytest.mark.parametrize("kind", FORMATS)
def test_nothing_but_own_errors_comes_of_damaged_files_and_nothing_is_lost(kind: str) -> None:
    found = {seed: faults(mutant(kind, seed), seed) for seed in range(MUTANTS)}
    assert {seed: some for seed, some in found.items() if some} == {}
